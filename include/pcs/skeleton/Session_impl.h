// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Session.h.

#ifndef PCS_SKELETON_SESSION_IMPL_H
#define PCS_SKELETON_SESSION_IMPL_H

#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_stages.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

template <class ConcurrencyTag>
Session<ConcurrencyTag>::Session(std::vector<Vec3> input,
                                 std::vector<std::uint8_t> is_wood,
                                 Session_hints hints)
  : m_stages(std::make_unique<Session_stages<ConcurrencyTag>>(std::move(input),
                                                              std::move(is_wood),
                                                              Session_options(std::move(hints))))
{
}

template <class ConcurrencyTag>
Session<ConcurrencyTag>::~Session() = default;

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::find_neighbors(pcs::internal::Progress& progress)
{
  return m_stages->find_neighbors(progress);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::find_paths(pcs::internal::Progress& progress)
{
  return m_stages->find_paths(progress);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::fit_axes(pcs::internal::Progress& progress)
{
  return m_stages->fit_axes(progress);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::join(pcs::internal::Progress& progress)
{
  return m_stages->join(progress);
}

template <class ConcurrencyTag>
const Scan& Session<ConcurrencyTag>::scan() const
{
  return m_stages->scan();
}

template <class ConcurrencyTag>
const Layer_tree& Session<ConcurrencyTag>::layers() const
{
  return m_stages->layers();
}

template <class ConcurrencyTag>
const Axis_set& Session<ConcurrencyTag>::axes() const
{
  return m_stages->axes();
}

template <class ConcurrencyTag>
const std::vector<Joint>& Session<ConcurrencyTag>::joints() const
{
  return m_stages->joints();
}

template <class ConcurrencyTag>
const Branch_tree& Session<ConcurrencyTag>::tree() const
{
  return m_stages->tree();
}

template <class ConcurrencyTag>
const Skeleton_report& Session<ConcurrencyTag>::report() const
{
  return m_stages->report();
}

template <class ConcurrencyTag>
Index Session<ConcurrencyTag>::node_of_input(std::size_t i) const
{
  return m_stages->node_of_input(i);
}

template <class ConcurrencyTag>
Vec3 Session<ConcurrencyTag>::normal_of_input(std::size_t i) const
{
  return m_stages->normal_of_input(i);
}

template <class ConcurrencyTag>
double Session<ConcurrencyTag>::residual_of_input(std::size_t i) const
{
  return m_stages->residual_of_input(i);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_leaf_of_input(std::size_t i) const
{
  return m_stages->is_leaf_of_input(i);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_IMPL_H

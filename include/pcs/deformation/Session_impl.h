// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Session.h.

#ifndef PCS_DEFORMATION_SESSION_IMPL_H
#define PCS_DEFORMATION_SESSION_IMPL_H

#include <pcs/core/Deformation_options.h>
#include <pcs/deformation/Session.h>
#include <pcs/deformation/Session_core.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

template <class ConcurrencyTag>
Session<ConcurrencyTag>::Session(std::vector<Vec3> points,
                                 const Sampling_options& options,
                                 const std::vector<std::uint32_t>* region,
                                 pcs::internal::Progress& progress)
  : m_core(std::make_unique<Session_core<ConcurrencyTag>>(std::move(points),
                                                          options,
                                                          region,
                                                          progress))
{
}

template <class ConcurrencyTag>
Session<ConcurrencyTag>::~Session() = default;

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_ready() const
{
  return m_core->is_ready();
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::number_of_points() const
{
  return m_core->number_of_points();
}

template <class ConcurrencyTag>
const Similarity& Session<ConcurrencyTag>::transform(std::size_t handle) const
{
  return m_core->transform(handle);
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::number_of_samples() const
{
  return m_core->number_of_samples();
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::add_handle(const std::vector<std::uint32_t>& indices,
                                                double weight,
                                                const char* function)
{
  return m_core->add_handle(indices, weight, function);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::remove_handle(std::size_t handle)
{
  m_core->remove_handle(handle);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_handle(std::size_t handle) const
{
  return m_core->is_handle(handle);
}

template <class ConcurrencyTag>
const Vec3& Session<ConcurrencyTag>::centroid(std::size_t handle) const
{
  return m_core->centroid(handle);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::set_transform(std::size_t handle, const Similarity& transform)
{
  m_core->set_transform(handle, transform);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::constrain(double stiffness)
{
  return m_core->constrain(stiffness);
}

template <class ConcurrencyTag>
Deformation_report Session<ConcurrencyTag>::solve(const Elastic_options& options,
                                                  Solver_start start,
                                                  pcs::internal::Progress& progress)
{
  return m_core->solve(options, start, progress);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::has_shape_of_handles() const
{
  return m_core->has_shape_of_handles();
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_ahead_of_shape() const
{
  return m_core->is_ahead_of_shape();
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_of_setting(const Session_snapshot& s) const
{
  return m_core->is_of_setting(s);
}

template <class ConcurrencyTag>
Session_snapshot Session<ConcurrencyTag>::snapshot() const
{
  return m_core->snapshot();
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::restore(const Session_snapshot& s)
{
  m_core->restore(s);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::reset()
{
  m_core->reset();
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::carry(Vec3& point, Vec3& normal) const
{
  m_core->carry(point, normal);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::prepare_carrying()
{
  m_core->prepare_carrying();
}

template <class ConcurrencyTag>
const Deformation_report& Session<ConcurrencyTag>::report() const
{
  return m_core->report();
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::set_normals(const std::function<Vec3(std::size_t)>& normal)
{
  m_core->set_normals(normal);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::accept(const std::function<Vec3(std::size_t)>& position)
{
  m_core->accept(position);
}

template <class ConcurrencyTag>
Writing<ConcurrencyTag> Session<ConcurrencyTag>::start_writing()
{
  return m_core->start_writing();
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::end_writing(double seconds)
{
  m_core->end_writing(seconds);
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SESSION_IMPL_H

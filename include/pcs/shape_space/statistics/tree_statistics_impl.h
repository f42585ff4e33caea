// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of tree_statistics.h.

#ifndef PCS_SHAPE_SPACE_STATISTICS_TREE_STATISTICS_IMPL_H
#define PCS_SHAPE_SPACE_STATISTICS_TREE_STATISTICS_IMPL_H

#include <pcs/shape_space/path/apply_pipe_model.h>
#include <pcs/shape_space/statistics/Tree_distribution.h>
#include <pcs/shape_space/statistics/find_modes.h>
#include <pcs/shape_space/statistics/mean_tree.h>
#include <pcs/shape_space/statistics/project_to_range.h>
#include <pcs/shape_space/statistics/tree_statistics.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

inline std::vector<const Orl_coordinates*> pointers(const std::vector<Orl_coordinates>& trees)
{
  std::vector<const Orl_coordinates*> result;
  for (const Orl_coordinates& x : trees)
    result.push_back(&x);
  return result;
}

} // namespace internal

template <class ConcurrencyTag>
Orl_coordinates
mean_of_family(const Tree_family& family, const std::vector<double>& weights, Tree_mean kind)
{
  return mean_tree<ConcurrencyTag>(family.layout, internal::pointers(family.x), weights, kind);
}

template <class ConcurrencyTag>
Modes_of_variation
modes_of_family(const Tree_family& family, std::size_t most, Mode_inner_product inner_product)
{
  const std::vector<double> ones(family.x.size(), 1);
  return find_modes<ConcurrencyTag>(
      family.layout,
      internal::pointers(family.x),
      family.weights,
      family.orientation,
      mean_of_family<ConcurrencyTag>(family, ones, Tree_mean::frechet),
      most,
      inner_product);
}

template <class ConcurrencyTag>
Mode_coordinates project_on_modes(const Tree_family& family,
                                  const Modes_of_variation& modes,
                                  const Orl_coordinates& x,
                                  std::size_t most)
{
  return project_on_modes(family.layout, family.weights, family.orientation, modes, x, most);
}

template <class ConcurrencyTag>
std::shared_ptr<const Tree_distribution> distribution_of_family(const Tree_family& family)
{
  return std::make_shared<const Tree_distribution>(family.layout,
                                                   internal::pointers(family.x),
                                                   family.has,
                                                   family.orientation,
                                                   family.up,
                                                   ConcurrencyTag());
}

template <class ConcurrencyTag>
bool is_distribution_of(const Tree_family& family, const Tree_distribution& distribution)
{
  return distribution.is_of(family.layout, family.has);
}

template <class ConcurrencyTag>
Orl_coordinates draw_tree(const Tree_family& family,
                          const Tree_distribution& distribution,
                          const std::vector<Tree_descriptors>& descriptors,
                          std::uint64_t seed,
                          std::uint64_t index,
                          const Tree_sampling_options& options,
                          bool do_limit_lengths)
{
  Orl_coordinates x = distribution.draw(seed, index, options);
  if (options.do_keep_in_range)
    limit_angles(family.layout, family.orientation, descriptors, x);
  if (options.do_keep_in_range && do_limit_lengths)
    limit_lengths(family.layout, family.orientation, family.up, descriptors, x);
  if (options.pipe_exponent > 0)
    apply_pipe_model(family.layout, options.pipe_exponent, x);
  if (options.do_limit_radii)
    limit_radii(family.layout, x);
  return x;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_TREE_STATISTICS_IMPL_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Statistics of a family: means, modes of variation, distributions and random trees.

#ifndef PCS_SHAPE_SPACE_STATISTICS_TREE_STATISTICS_H
#define PCS_SHAPE_SPACE_STATISTICS_TREE_STATISTICS_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/statistics/Modes_of_variation.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcs {
namespace shape_space {

class Tree_distribution;

template <class ConcurrencyTag>
Orl_coordinates
mean_of_family(const Tree_family& family, const std::vector<double>& weights, Tree_mean kind);

/// Computes the modes of variation about the Frechet mean.
template <class ConcurrencyTag>
Modes_of_variation
modes_of_family(const Tree_family& family, std::size_t most, Mode_inner_product inner_product);

template <class ConcurrencyTag>
Mode_coordinates project_on_modes(const Tree_family& family,
                                  const Modes_of_variation& modes,
                                  const Orl_coordinates& x,
                                  std::size_t most);

template <class ConcurrencyTag>
std::shared_ptr<const Tree_distribution> distribution_of_family(const Tree_family& family);

/// Returns whether the trees of the distribution have the branches and edges of the family.
template <class ConcurrencyTag>
bool is_distribution_of(const Tree_family& family, const Tree_distribution& distribution);

/// Draws a random tree and brings its descriptors into the range of `descriptors` as far as
/// `options` require it. `do_limit_lengths`: whether lengths are changed, too.
template <class ConcurrencyTag>
Orl_coordinates draw_tree(const Tree_family& family,
                          const Tree_distribution& distribution,
                          const std::vector<Tree_descriptors>& descriptors,
                          std::uint64_t seed,
                          std::uint64_t index,
                          const Tree_sampling_options& options,
                          bool do_limit_lengths);

} // namespace shape_space
} // namespace pcs

#ifndef PCS_COMPILED_SHAPE_SPACE
#include <pcs/shape_space/statistics/tree_statistics_impl.h>
#endif

#endif // PCS_SHAPE_SPACE_STATISTICS_TREE_STATISTICS_H

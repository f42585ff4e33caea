// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random trees like those of a shape space.

#ifndef PCS_SAMPLE_TREE_H
#define PCS_SAMPLE_TREE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/shape_space/Orl_tree.h>
#include <pcs/shape_space/input/check_space.h>
#include <pcs/shape_space/input/read_options.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>
#include <pcs/shape_space/statistics/make_tree.h>
#include <pcs/shape_space/statistics/tree_statistics.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! a distribution of trees, with the descriptors of the trees from which it was estimated
struct Orl_distribution
{
  std::shared_ptr<const shape_space::Tree_distribution> distribution; ///< null: not estimated
  std::vector<Tree_descriptors> descriptors;                          ///< of the added trees
};

//! \ingroup PkgPcsShapeSpaceRef
//! how a random tree was found
struct Sample_report
{
  std::size_t number_of_trials = 0; ///< [count]
  /// Relative distance of its descriptors from the range of the inputs; 0 if they are within [-].
  double range_violation = 0;
};

namespace internal {

/// Draws weights of the scans by exponential variates. After division by their sum, they are
/// uniformly distributed over all non-negative weights that add up to 1.
inline std::vector<double>
draw_scan_weights(std::size_t number_of_trees, std::uint64_t seed, std::uint64_t index)
{
  Random_stream random(mix_bits(~seed), index);
  std::vector<double> result(number_of_trees);
  for (double& w : result)
    w = -std::log(1 - random.uniform());
  return result;
}

} // namespace internal

//! \ingroup PkgPcsShapeSpaceRef
//! estimates the distribution of the added trees; the result can be used for many `sample_tree()`
template <class Kernel, class ConcurrencyTag>
Orl_distribution learn_distribution(const Orl_shape_space<Kernel, ConcurrencyTag>& space)
{
  shape_space::check_built(space.family(), "pcs::learn_distribution()");
  Orl_distribution result{shape_space::distribution_of_family<ConcurrencyTag>(space.family()), {}};
  for (std::size_t t = 0; t < space.number_of_trees(); ++t)
    result.descriptors.push_back(measure_shape(space, space.tree(t)));
  return result;
}

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief draws a random tree from the distribution of the added trees.

  Section 5.2 of \cite aiteanu2022 proposes such a function as future work. Lengths and radii are
  positive. All trees have the same topology and the same order of points.

  \param space a space that was built
  \param from result of `learn_distribution()` for `space`
  \param seed seed of a sequence of trees
  \param index index of the tree in its sequence; trees do not depend on which others are drawn
  \param np
  \npbegin
    \np{sampling_options} limits and constraints of the random trees
      \nptype `Tree_sampling_options`
  \npend
  \param report if not null, how the tree was found
  \throws pcs::Invalid_input for a distribution of another space, or options out of range
  \par Complexity
  \f$O(n e)\f$ for each of at most `number_of_trials` trials, `n` trees of `e` edges.
*/
template <class Kernel,
          class ConcurrencyTag,
          class NamedParameters = parameters::Default_named_parameters>
Orl_tree sample_tree(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                     const Orl_distribution& from,
                     std::uint64_t seed,
                     std::uint64_t index,
                     const NamedParameters& np = NamedParameters(),
                     Sample_report* report = nullptr)
{
  const char* const caller = "pcs::sample_tree()";
  const Tree_sampling_options options = shape_space::read_sampling_options(np, caller);
  const shape_space::Tree_family& family = space.family();
  shape_space::check_built(family, caller);
  pcs::internal::check(
      from.distribution && from.descriptors.size() == space.number_of_trees() &&
          shape_space::is_distribution_of<ConcurrencyTag>(family, *from.distribution),
      caller,
      "the distribution is of another space");
  const std::vector<double> scan_weights =
      internal::draw_scan_weights(space.number_of_trees(), seed, index);
  const std::size_t trials = options.do_keep_in_range ? options.number_of_trials : 1;
  Orl_tree best;
  Sample_report found;
  double least = 0; // violation by descriptors of the whole tree, without descriptors by order
  Tree_sampling_options nearer = options;
  for (std::size_t k = 0; k < trials; ++k) {
    // the second half of the trials approaches the median tree, and lengths remain in range
    nearer.spread =
        options.spread * std::min(1.0, 1.5 - static_cast<double>(k) / static_cast<double>(trials));
    Orl_tree candidate(shape_space::make_tree(
        family,
        shape_space::draw_tree<ConcurrencyTag>(family,
                                               *from.distribution,
                                               from.descriptors,
                                               // each trial has a separate random stream
                                               pcs::internal::mix_bits(seed) + k,
                                               index,
                                               nearer,
                                               2 * k >= trials),
        -1,
        scan_weights));
    double violation = 0, violation_as_a_whole = 0;
    if (options.do_keep_in_range) {
      const Tree_descriptors d = measure_shape(space, candidate);
      violation = shape_space::range_violation(d, from.descriptors, true);
      violation_as_a_whole = shape_space::range_violation(d, from.descriptors, false);
    }
    if (k == 0 || violation_as_a_whole < least ||
        (violation_as_a_whole == least && violation < found.range_violation)) {
      best = std::move(candidate);
      found.range_violation = violation;
      least = violation_as_a_whole;
    }
    found.number_of_trials = k + 1;
    if (found.range_violation == 0)
      break;
  }
  if (report)
    *report = found;
  return best;
}

//! \ingroup PkgPcsShapeSpaceRef
//! draws one tree; for more trees, reuse the result of `learn_distribution()`
template <class Kernel,
          class ConcurrencyTag,
          class NamedParameters = parameters::Default_named_parameters>
Orl_tree sample_tree(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                     std::uint64_t seed,
                     const NamedParameters& np = NamedParameters())
{
  return sample_tree(space, learn_distribution(space), seed, 0, np);
}

} // namespace pcs

#endif // PCS_SAMPLE_TREE_H

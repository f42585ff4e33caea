// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Mean and weighted mean of the trees of a shape space, and displacements of trees.

#ifndef PCS_MEAN_TREE_H
#define PCS_MEAN_TREE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/shape_space/Orl_tree.h>
#include <pcs/shape_space/input/check_sampling.h>
#include <pcs/shape_space/input/check_space.h>
#include <pcs/shape_space/input/read_options.h>
#include <pcs/shape_space/statistics/make_tree.h>
#include <pcs/shape_space/statistics/tree_statistics.h>

#include <cmath>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief returns the mean of the added trees of a space, (4.16) and (4.17) of \cite aiteanu2022.

  `Tree_mean::median` minimises the sum of distances `Orl_metric::sum`. It consists of the medians
  of lengths, radii and attachments, and the L1 means of orientations (Weiszfeld's algorithm). A
  branch of fewer than half of the trees has the length 0. The median of an even number of values is
  the middle of the two in between, so a branch of exactly half of the trees, as of one of two, has
  half its length. `Tree_mean::frechet` minimises
  the sum of squared distances. Every branch is present, with its mean length.

  \param space a space that was built
  \param np
  \npbegin
    \np{tree_mean} what is minimised
      \nptype `Tree_mean`
      \npdefault `median`
    \np{tree_weights} weights of the trees, `>= 0`, not all 0
      \nptype `std::vector<double>` of `number_of_trees()` elements
      \npdefault all 1
  \npend
  \throws pcs::Invalid_input for wrong weights, or a space that was not built
  \par Complexity
  \f$O(n e)\f$ for `n` trees and `e` edges; `median` of up to 128 trees also computes
  \f$O(n^2 e)\f$ angles.
*/
template <class Kernel,
          class ConcurrencyTag,
          class NamedParameters = parameters::Default_named_parameters>
Orl_tree mean_tree(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                   const NamedParameters& np = NamedParameters())
{
  const char* const caller = "pcs::mean_tree()";
  shape_space::check_built(space.family(), caller);
  shape_space::Mean_options options =
      shape_space::read_mean_options(np, space.number_of_trees(), caller);
  return Orl_tree(shape_space::make_tree(
      space.family(),
      shape_space::mean_of_family<ConcurrencyTag>(space.family(), options.weights, options.kind),
      -1,
      options.weights));
}

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief returns the weighted Frechet mean of the added trees.

  The mean of two trees lies on their geodesic. If all weights are `>= 0`, the mean lies between the
  inputs. Negative weights extrapolate; in this case, lengths are bounded from below by 0, and
  radii by a hundredth of the least positive radius among the inputs.

  \param space a space that was built
  \param weights one per tree [-]; they are divided by their sum, which must be positive
  \throws pcs::Invalid_input for wrong weights, or a space that was not built
*/
template <class Kernel, class ConcurrencyTag>
Orl_tree weighted_mean(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                       const std::vector<double>& weights)
{
  const char* const caller = "pcs::weighted_mean()";
  shape_space::check_built(space.family(), caller);
  shape_space::check_tree_weights(weights, space.number_of_trees(), true, caller);
  double total = 0;
  for (const double w : weights)
    total += w;
  return Orl_tree(shape_space::make_tree(
      space.family(),
      shape_space::mean_of_family<ConcurrencyTag>(space.family(), weights, Tree_mean::frechet),
      space.number_of_trees() == 2 ? weights[1] / total : 0,
      weights));
}

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief returns `t` displaced by `step` times the tangent vector from `a` to `b`.

  Lengths are bounded from below by 0, and radii and lengths of the trunk by a hundredth of their
  values in `t`.
  \param space a space that was built
  \param t, a, b trees of the space
  \param step finite [-]
  \throws pcs::Invalid_input for a tree with another number of branches or edges, or a step that is
          not finite
*/
template <class Kernel, class ConcurrencyTag>
Orl_tree parallel_displacement(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                               const Orl_tree& t,
                               const Orl_tree& a,
                               const Orl_tree& b,
                               double step)
{
  const char* const caller = "pcs::parallel_displacement()";
  for (const Orl_tree* x : {&t, &a, &b})
    shape_space::check_tree(space.family(), x->coordinates(), x->state().scan_weights, caller);
  pcs::internal::check(std::isfinite(step), caller, "`step` is not finite");
  return Orl_tree(shape_space::make_tree(space.family(),
                                         shape_space::parallel_displacement(space.family(),
                                                                            t.coordinates(),
                                                                            a.coordinates(),
                                                                            b.coordinates(),
                                                                            step),
                                         -1,
                                         t.state().scan_weights));
}

} // namespace pcs

#endif // PCS_MEAN_TREE_H

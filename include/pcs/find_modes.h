// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Modes of variation of the trees of a shape space: scores, reconstruction, outliers.

#ifndef PCS_FIND_MODES_H
#define PCS_FIND_MODES_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/shape_space/Orl_tree.h>
#include <pcs/shape_space/input/check_space.h>
#include <pcs/shape_space/input/read_options.h>
#include <pcs/shape_space/statistics/Modes_of_variation.h>
#include <pcs/shape_space/statistics/make_tree.h>
#include <pcs/shape_space/statistics/tree_statistics.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! principal directions in the tangent space at the mean, with the scores of the added trees
using Modes_of_variation = shape_space::Modes_of_variation;

//! \ingroup PkgPcsShapeSpaceRef
//! scores of a tree, and its distance from the space of the modes
using Mode_coordinates = shape_space::Mode_coordinates;

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief finds the directions in which the added trees differ most from their Frechet mean.

  This is a principal geodesic analysis in the tangent space at the mean, without the position of
  the root. All `number_of_trees() - 1` modes together reproduce the inputs. The default inner
  product gives all branches the same weight, and compares each branch among the trees that have it
  (Tyler's estimator, expectation maximisation for absent branches). `Mode_inner_product::metric` is
  the metric `Orl_metric::square`, in which absent branches and long edges dominate.

  \param space a space that was built
  \param most maximal number of modes; there are fewer if the trees vary in fewer dimensions
  \param np
  \npbegin
    \np{mode_inner_product} inner product in which variance is measured
      \nptype `Mode_inner_product`
      \npdefault `branches`
  \npend
  \throws pcs::Invalid_input for a space that was not built
  \par Complexity
  \f$O(n^4 b + n^2 e)\f$ for `n` trees, `b` branches and `e` edges, mostly for leave-one-out errors;
  memory \f$O(n e)\f$ per thread.
*/
template <class Kernel,
          class ConcurrencyTag,
          class NamedParameters = parameters::Default_named_parameters>
Modes_of_variation find_modes(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                              std::size_t most,
                              const NamedParameters& np = NamedParameters())
{
  const Mode_inner_product product = shape_space::read_mode_inner_product(np);
  shape_space::check_built(space.family(), "pcs::find_modes()");
  return shape_space::modes_of_family<ConcurrencyTag>(space.family(), most, product);
}

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief returns the tree with given scores, in standard deviations of the modes.

  For any scores, edge lengths of the trunk, and radii of edges of positive length, remain at least
  a hundredth of their values in the mean.

  \param space, modes a space and the result of `find_modes()` for it
  \param scores at most one per mode, finite; missing scores are 0 [-]
  \throws pcs::Invalid_input for modes of another space, too many scores, or a score that is not
          finite
*/
template <class Kernel, class ConcurrencyTag>
Orl_tree tree_of_modes(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                       const Modes_of_variation& modes,
                       const std::vector<double>& scores)
{
  const char* const caller = "pcs::tree_of_modes()";
  shape_space::check_coordinates(space.family(),
                                 modes.mean,
                                 caller,
                                 "the modes are of another space");
  pcs::internal::check(scores.size() <= modes.size(),
                       caller,
                       std::to_string(scores.size()) + " scores for " +
                           std::to_string(modes.size()) + " modes");
  for (const double s : scores)
    pcs::internal::check(std::isfinite(s), caller, "a score is not finite");
  return Orl_tree(shape_space::make_tree(
      space.family(),
      shape_space::tree_of_modes(space.family().layout, space.family().weights, modes, scores)));
}

//! \ingroup PkgPcsShapeSpaceRef
//! projects a tree on the space of the first `most` modes; branches that the tree lacks are ignored
template <class Kernel, class ConcurrencyTag>
Mode_coordinates project_on_modes(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                                  const Modes_of_variation& modes,
                                  const Orl_tree& t,
                                  std::size_t most = npos)
{
  const char* const caller = "pcs::project_on_modes()";
  shape_space::check_coordinates(space.family(),
                                 modes.mean,
                                 caller,
                                 "the modes are of another space");
  shape_space::check_tree(space.family(), t.coordinates(), t.state().scan_weights, caller);
  return shape_space::project_on_modes<ConcurrencyTag>(space.family(),
                                                       modes,
                                                       t.coordinates(),
                                                       std::min(most, modes.size()));
}

//! \ingroup PkgPcsShapeSpaceRef
//! returns the tree in the space of the first `most` modes that is nearest to `t`
template <class Kernel, class ConcurrencyTag>
Orl_tree reconstruct_tree(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                          const Modes_of_variation& modes,
                          const Orl_tree& t,
                          std::size_t most)
{
  const Mode_coordinates at = project_on_modes(space, modes, t, most);
  const std::vector<double> scores(at.scores.data(), at.scores.data() + at.scores.size());
  shape_space::Tree_state result = tree_of_modes(space, modes, scores).state();
  result.x.root = t.coordinates().root;
  return Orl_tree(shape_space::make_tree(space.family(),
                                         std::move(result.x),
                                         result.lambda,
                                         t.state().scan_weights));
}

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief returns the dissimilarity of a tree from the added trees [-].

  It is the root mean square of two terms: the root mean square score of the tree, and its distance
  from the space of the modes in units of the median leave-one-out distance. It is about 1 for a
  tree of the same kind.

  \param space, modes a space and the result of `find_modes()` for it
  \param t a tree of the space
  \throws pcs::Invalid_input for modes or a tree of another space
*/
template <class Kernel, class ConcurrencyTag>
double outlier_score(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                     const Modes_of_variation& modes,
                     const Orl_tree& t)
{
  return shape_space::outlier_score(modes, project_on_modes(space, modes, t));
}

} // namespace pcs

#endif // PCS_FIND_MODES_H

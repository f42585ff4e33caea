// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Comparison of trees of a shape space: distances, shape descriptors and changes of branches.

#ifndef PCS_COMPARE_TREES_H
#define PCS_COMPARE_TREES_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/Orl_tree.h>
#include <pcs/shape_space/input/check_space.h>
#include <pcs/shape_space/input/read_options.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>
#include <pcs/shape_space/measures/change_table.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <cstddef>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! length, height, width, branches and angles of a tree
using Tree_descriptors = shape_space::Tree_descriptors;

//! \ingroup PkgPcsShapeSpaceRef
//! a branch in two trees: whether it is new, lost, longer, thicker, rotated
using Branch_change = shape_space::Branch_change;

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief returns the distances of all pairs of added trees, row by row [L].

  The distance of `a` and `b` has the index `a * number_of_trees() + b`.
  \param space a space that was built
  \param np
  \npbegin
    \np{metric} how differences of coordinates are combined
      \nptype `Orl_metric`
      \npdefault `sum`
  \npend
  \throws pcs::Invalid_input for a space that was not built
  \par Complexity
  \f$O(n^2 e)\f$ for `n` trees of `e` edges.
*/
template <class Kernel,
          class ConcurrencyTag,
          class NamedParameters = parameters::Default_named_parameters>
std::vector<double> distance_matrix(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                                    const NamedParameters& np = NamedParameters())
{
  const Orl_metric metric = shape_space::read_metric(np);
  const shape_space::Tree_family& family = space.family();
  shape_space::check_built(family, "pcs::distance_matrix()");
  const std::size_t n = space.number_of_trees();
  std::vector<double> result(n * n, 0);
  pcs::internal::for_each_index<ConcurrencyTag>(
      n,
      [&](std::size_t a) {
        for (std::size_t b = 0; b < a; ++b)
          result[a * n + b] =
              shape_space::distance(family.x[a], family.x[b], family.weights, metric);
      },
      1);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < a; ++b)
      result[b * n + a] = result[a * n + b];
  return result;
}

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief classifies the change of each branch from tree `a` to tree `b`: new, lost, longer, thicker,
      rotated.

  \param space a space that was built
  \param a, b handles of added trees
  \param np
  \npbegin
    \np{change_limits} smallest differences that count as changes
      \nptype `Change_limits`
  \npend
  \return the changes of all branches that at least one of the trees has, parents first
  \throws pcs::Invalid_input for a wrong handle, or a limit below 0
  \par Complexity
  Linear in the number of edges.
*/
template <class Kernel,
          class ConcurrencyTag,
          class NamedParameters = parameters::Default_named_parameters>
std::vector<Branch_change>
find_branch_changes(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                    typename Orl_shape_space<Kernel, ConcurrencyTag>::Handle a,
                    typename Orl_shape_space<Kernel, ConcurrencyTag>::Handle b,
                    const NamedParameters& np = NamedParameters())
{
  const char* const caller = "pcs::find_branch_changes()";
  const Change_limits limits = shape_space::read_change_limits(np, caller);
  const shape_space::Tree_family& family = space.family();
  shape_space::check_handle(family, a, caller);
  shape_space::check_handle(family, b, caller);
  return shape_space::find_changes(family.layout,
                                   family.x[a],
                                   family.x[b],
                                   family.orientation,
                                   limits);
}

//! \ingroup PkgPcsShapeSpaceRef
//! measures the shape of a tree; its height is along the mean direction of growth, `family().up`
template <class Kernel, class ConcurrencyTag>
Tree_descriptors measure_shape(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                               const Orl_tree& t)
{
  const shape_space::Tree_family& family = space.family();
  shape_space::check_tree(family, t.coordinates(), t.state().scan_weights, "pcs::measure_shape()");
  return shape_space::measure(family.layout, t.coordinates(), t.state().geometry, family.up);
}

} // namespace pcs

#endif // PCS_COMPARE_TREES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Grows a virtual tree: axes, radii and sections by a few rules and a seed.

#ifndef PCS_GENERATORS_GROW_TREE_H
#define PCS_GENERATORS_GROW_TREE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/internal/Tree_growth.h>

#include <cstdint>

namespace pcs {
namespace internal {

/// The named parameters of `grow_tree()`.
struct Growth_options
{
  std::uint64_t seed = 0;
};

template <class NamedParameters>
Growth_options read_growth_options(const NamedParameters& np)
{
  check_names<CGAL::internal_np::random_seed_t>(np);
  static_assert(is_integer_parameter_v<NamedParameters, CGAL::internal_np::random_seed_t>,
                "pcs::grow_tree(): named parameter `random_seed` must be an integer");
  return {read_random_seed(np)};
}

} // namespace internal

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief grows a virtual tree upwards from the origin.

  Axes are random walks of direction with a tropism; radii taper from base to tip. Successive
  branches are rotated about their parent by the golden angle. A branch begins with a random
  fraction of the radius of its parent; branches end at a crown of given shape. Cross-sections are
  ellipses with a random phase for each branch. The first node of a branch is separate, but
  coincides with a node of the parent.

  Every branch uses a separate random stream, so the number of its twigs does not affect the next
  branch. `Tree_branch::id` is the number of the branch; `tree_at_age()`, `prune_branch()`,
  `turn_branch()` and `lengthen_branch()` keep it.

  \tparam Kernel a class with `FT`, `Point_3` and `Vector_3`, such as a kernel of CGAL
  \tparam NamedParameters a sequence of named parameters
  \param tree is replaced; unchanged when an exception is thrown
  \param habit growth parameters; lengths in any unit [L]
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{random_seed} seed of the random streams
      \nptype integer
      \npdefault `0`
  \npend
  \throws pcs::Invalid_input when a value of `habit` is invalid, or the tree would have more than
          ten million nodes
  \par Complexity
  Linear in the number of nodes.
  \par Determinism
  The same habit and seed give the same tree.
*/
template <class Kernel, class NamedParameters = parameters::Default_named_parameters>
void grow_tree(Tree_skeleton<Kernel>& tree,
               const Tree_habit& habit = broadleaf_habit(),
               const NamedParameters& np = parameters::default_values())
{
  const internal::Growth_options options = internal::read_growth_options(np);
  internal::check_habit(habit);
  generators::internal::Tree_growth growth(habit, options.seed);
  growth.run();
  tree = growth.template skeleton<Kernel>();
}

} // namespace pcs

#endif // PCS_GENERATORS_GROW_TREE_H

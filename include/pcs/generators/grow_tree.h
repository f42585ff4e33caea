// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Grows a virtual tree: axes, radii and sections by a few rules and a seed.

#ifndef PCS_GENERATORS_GROW_TREE_H
#define PCS_GENERATORS_GROW_TREE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/internal/Tree_growth.h>

#include <cstdint>
#include <type_traits>

namespace pcs {

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief grows a virtual tree upwards from the origin.

  Axes are random walks of direction with a pull upwards; radii taper from base to tip; branches
  leave their parent at the golden angle, with a random share of its radius, and end at a crown of
  given shape; sections are ellipses with a random phase for each branch. A branch begins on the
  axis of its parent, with a node of its own at the place of the parent's node.

  Every branch draws from a random stream of its own, so the number of its twigs does not change
  the next branch. `Tree_branch::id` is the number of the branch; `tree_at_age()`, `prune_branch()`,
  `turn_branch()` and `lengthen_branch()` keep it.

  \tparam Kernel a class with `FT`, `Point_3` and `Vector_3`, such as a kernel of CGAL
  \tparam NamedParameters a sequence of named parameters
  \param tree is replaced; unchanged when an exception is thrown
  \param habit how the tree grows; lengths in any unit [L]
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{random_seed} another seed gives another tree of the same habit
      \nptype integer
      \npdefault `0`
  \npend
  \throws pcs::Invalid_input when a value of `habit` makes no sense, or the tree would have more
          than ten million nodes
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
  const auto seed = internal::choose(np, CGAL::internal_np::random_seed, 0);
  constexpr bool seed_ok = std::is_integral_v<std::decay_t<decltype(seed)>>;
  static_assert(seed_ok, "pcs::grow_tree(): named parameter `random_seed` must be an integer");
  internal::check_habit(habit);
  if constexpr (seed_ok) {
    generators::internal::Tree_growth growth(habit, static_cast<std::uint64_t>(seed));
    growth.run();
    tree = growth.template skeleton<Kernel>();
  }
}

} // namespace pcs

#endif // PCS_GENERATORS_GROW_TREE_H

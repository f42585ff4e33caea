// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds the growth parameters of measured trees (inverse procedural modelling).

#ifndef PCS_GENERATORS_FIT_TREE_HABIT_H
#define PCS_GENERATORS_FIT_TREE_HABIT_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/habit/Habit_parameters.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/check_tree.h>
#include <pcs/generators/habit/fit_samples.h>

#include <CGAL/tags.h>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <vector>

namespace pcs {
namespace internal {

/// The named parameters of `fit_tree_habit()`.
struct Habit_options
{
  std::uint64_t seed = 0;
  std::size_t number_of_simulations = 100;
  double smallest_radius = 0;
};

template <class NamedParameters>
Habit_options read_habit_options(const NamedParameters& np)
{
  namespace tags = internal_np;
  const std::string caller = "pcs::fit_tree_habit()";
  check_names<CGAL::internal_np::random_seed_t,
              tags::number_of_simulations_t,
              tags::smallest_radius_t>(np);
  static_assert(is_integer_parameter_v<NamedParameters, CGAL::internal_np::random_seed_t>,
                "pcs::fit_tree_habit(): named parameter `random_seed` must be an integer");
  constexpr bool is_number = is_integer_parameter_v<NamedParameters, tags::number_of_simulations_t>;
  static_assert(
      is_number,
      "pcs::fit_tree_habit(): named parameter `number_of_simulations` must be an integer");
  static_assert(is_parameter_v<double, NamedParameters, tags::smallest_radius_t>,
                "pcs::fit_tree_habit(): named parameter `smallest_radius` must be a number");
  Habit_options options;
  options.seed = read_random_seed(np);
  if constexpr (is_number)
    options.number_of_simulations = check_count(
        caller,
        "number_of_simulations",
        choose(np, tags::number_of_simulations, static_cast<int>(options.number_of_simulations)),
        20,
        100'000);
  read_parameter(np, tags::smallest_radius, options.smallest_radius);
  check_at_least(caller, "smallest_radius", options.smallest_radius, 0);
  return options;
}

/// Marks the values that the trees determine.
inline void mark_identified(Tree_habit_fit& fit)
{
  constexpr std::size_t fewest_branches = 5;
  for (Habit_value& v : fit.values) {
    const bool is_of_trunk = v.number_of_samples == fit.number_of_trees;
    v.is_identified = v.number_of_samples >= (is_of_trunk ? 1 : fewest_branches);
    if (v.name == "fork")
      v.is_identified = v.number_of_samples > 0;
    if (v.name == "smallest_branch" || v.name == "tip_radius") // otherwise the resolution
      v.is_identified = v.is_identified && v.value > 1.2 * fit.smallest_radius;
    if (v.name == "flare_height")
      v.is_identified = v.is_identified && fit.habit.flare > 0.03;
    if (v.name == "lean") // a larger one is cut
      v.is_identified = v.is_identified && v.value < generators::habit::largest_lean;
    if (v.name.rfind("bend[", 0) == 0)
      v.is_identified = v.is_identified && v.value < generators::habit::largest_bend;
  }
}

} // namespace internal

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief finds the growth parameters of measured trees, so that `grow_tree()` grows similar ones.

  Each parameter has a direct estimate from the branches of all trees: least squares for taper and
  flare, regression of the changes of direction for tropism, sag and bends, and maximum likelihood
  for ranges and the crown, with the standard errors of the radii, lower bounds of cut branches, and
  a limit of detection. Trees are grown by the estimate, their radii get the stated errors, and
  parts below `smallest_radius` are removed; the same estimate of these trees shows the bias, which
  is removed (indirect inference, Gourieroux, Monfort and Renault 1993), and the spread, which gives
  standard errors and intervals.

  Not every parameter can be determined; `Habit_value::is_identified` and `number_of_samples` tell.
  A single trunk has one lean. The range of the fork angle needs six forked trees. What is thinner
  than the resolution is unknown: `tip_radius` and `smallest_branch` are bounds then. Counts
  (orders, leaders, stubs, branches per whorl) and the steps are those of the skeletons; the shape
  of the crown is the most likely one (see `Tree_habit_fit::crown_margin`). Errors of positions are
  not modelled. Several trees are assumed to be of the same habit; their heights may differ.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`
  \tparam TreeRange a range of `Tree_skeleton<Kernel>`
  \tparam NamedParameters a sequence of named parameters
  \param trees skeletons with branches, z upwards, lengths in one unit [L]; `n` trees. `warnings()`
         of the result names trees that seem to have another vertical
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{smallest_radius} the resolution: thinner parts of the trees are left out [L]
      \nptype number, `>= 0`
      \npdefault `0`, for complete skeletons
    \np{number_of_simulations} sets of trees that are grown for the intervals [count]
      \nptype integer, `20` or more
      \npdefault `100`
    \np{random_seed} seed of the grown trees
      \nptype integer
      \npdefault `0`
  \npend
  \return the habit, its parameters with intervals, and distributions by order
  \throws pcs::Invalid_input when there is no tree, a tree has no trunk or fewer than four branches
          besides it, is not a tree with valid branches, a coordinate or radius is not finite, or a
          named parameter is out of range
  \par Complexity
  About two trees are grown for each simulation, and at least 40 for each measured tree.
  \par Determinism
  Same bits for every number of threads and for the sequential tag.
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class TreeRange,
          class NamedParameters = parameters::Default_named_parameters>
Tree_habit_fit fit_tree_habit(const TreeRange& trees,
                              const NamedParameters& np = parameters::default_values())
{
  using Tree = std::decay_t<decltype(*std::begin(trees))>;
  constexpr bool are_skeletons = internal::Is_tree_skeleton<Tree>::value;
  static_assert(are_skeletons,
                "pcs::fit_tree_habit(): `trees` must be a range of pcs::Tree_skeleton<Kernel>");
  Tree_habit_fit fit;
  if constexpr (are_skeletons) {
    namespace habit = generators::habit;
    const internal::Habit_options options = internal::read_habit_options(np);
    std::vector<habit::Tree_sample> samples;
    for (const Tree& tree : trees)
      samples.push_back(
          habit::checked_sample(tree,
                                options.smallest_radius,
                                "pcs::fit_tree_habit(): tree " + std::to_string(samples.size())));
    internal::check(!samples.empty(), "pcs::fit_tree_habit()", "`trees` is empty; pass a tree");
    fit = habit::fit_samples<ConcurrencyTag>(samples,
                                             options.smallest_radius,
                                             options.seed,
                                             options.number_of_simulations);
    internal::mark_identified(fit);
    for (const habit::Tree_sample& sample : samples)
      fit.trunk_tilts.push_back(habit::trunk_tilt(sample));
  }
  return fit;
}

} // namespace pcs

#endif // PCS_GENERATORS_FIT_TREE_HABIT_H

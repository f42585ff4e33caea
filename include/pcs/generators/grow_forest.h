// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Grows a forest of any size by the habit of measured trees.

#ifndef PCS_GENERATORS_GROW_FOREST_H
#define PCS_GENERATORS_GROW_FOREST_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/habit/Habit_simulation.h>
#include <pcs/generators/habit/forest_places.h>
#include <pcs/generators/tree_at_age.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/parallel.h>

#include <CGAL/tags.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsGeneratorsRef
//! the options of `grow_forest()`
struct Forest_options
{
  std::size_t number_of_trees = 20; //!< [count]
  double height = 0;                //!< geometric mean of the trunks; 0: that of the fit [L]
  double height_spread = -1;        //!< of the natural logarithms; negative: that of the fit [-]
  Value_range age = {1, 1};         //!< ages are uniform in this range, see `tree_at_age()` [-]
  double stem_distance = -1;        //!< least distance of trunks; 0: all at the origin;
                                    //!< negative: 1.2 times the radius of the crown [L]
  std::uint64_t random_seed = 0;
};

//! \ingroup PkgPcsGeneratorsRef
//! a tree of `grow_forest()`
template <class Kernel>
struct Forest_tree
{
  Tree_skeleton<Kernel> tree; //!< at its place; its root has z = 0
  double height = 0;          //!< length of the trunk at the age 1 [L]
  double age = 1;             //!< [-]
};

namespace internal {

inline void check_forest_options(const Forest_options& options)
{
  const std::string caller = "pcs::grow_forest()";
  check_count(caller, "number_of_trees", options.number_of_trees, 1, 1'000'000);
  check_at_least(caller, "height", options.height, 0);
  check(std::isfinite(options.height_spread) && options.height_spread <= 1,
        caller,
        "`height_spread` must be at most 1, a factor of e");
  check(options.age.least > 0 && options.age.largest <= 1 &&
            options.age.least <= options.age.largest,
        caller,
        "`age` must be a range in (0, 1], from the least to the largest value");
  check(std::isfinite(options.stem_distance), caller, "`stem_distance` must be finite");
}

/// Moves a tree horizontally.
template <class Kernel>
void move_tree(Tree_skeleton<Kernel>& tree, double x, double y)
{
  using FT = typename Kernel::FT;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    const auto p = tree[v].point;
    tree[v].point = typename Kernel::Point_3(p.x() + FT(x), p.y() + FT(y), p.z());
  }
}

} // namespace internal

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief grows trees by a fitted habit.

  Heights are log-normal about the mean height; the trunk and the crown follow the allometry of the
  fit (`habit_at_height()`). Each tree has its own random streams, so the first trees of a larger
  forest are those of a smaller one, except for their places. Trunks stand at random in a square, no
  closer than `Forest_options::stem_distance`. A tree of an age below 1 is a younger shape of the
  tree that the habit grows. Older trees are higher ones (`Forest_options::height`).

  \tparam Kernel a class with `FT`, `Point_3` and `Vector_3`, such as a kernel of CGAL
  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`
  \param fit a result of `fit_tree_habit()`
  \param options number, heights, ages and distances of the trees
  \throws pcs::Invalid_input when an option or a value of the habit is out of range
  \par Complexity
  Linear in the number of nodes.
  \par Determinism
  Same bits for every number of threads and for the sequential tag.
*/
template <class Kernel, class ConcurrencyTag = CGAL::Parallel_if_available_tag>
std::vector<Forest_tree<Kernel>> grow_forest(const Tree_habit_fit& fit,
                                             const Forest_options& options = Forest_options())
{
  namespace habit = generators::habit;
  internal::check_forest_options(options);
  const double mean = options.height > 0 ? options.height : fit.habit.height;
  const double spread =
      options.height_spread < 0 ? fit.allometry.height_spread : options.height_spread;
  const Tree_habit mean_habit = habit_at_height(fit, mean);
  internal::check_habit(mean_habit);
  const double distance =
      options.stem_distance < 0 ? 1.2 * mean_habit.crown_radius : options.stem_distance;
  const std::vector<std::array<double, 2>> places =
      habit::forest_places(options.number_of_trees,
                           distance,
                           habit::stream_seed(options.random_seed, habit::Stream::place));
  std::vector<Forest_tree<Kernel>> forest(options.number_of_trees);
  internal::for_each_index<ConcurrencyTag>(
      forest.size(),
      [&](std::size_t i) {
        Forest_tree<Kernel>& t = forest[i];
        internal::Random_stream random(
            habit::stream_seed(options.random_seed, habit::Stream::height, i));
        t.height = mean * std::exp(spread * random.normal());
        t.age = random.uniform(options.age.least, options.age.largest);
        const std::uint64_t seed =
            habit::stream_seed(options.random_seed, habit::Stream::growth, i);
        grow_tree(t.tree, habit_at_height(fit, t.height), parameters::random_seed(seed));
        if (t.age < 1)
          t.tree = tree_at_age<Kernel>(t.tree, t.age);
        internal::move_tree<Kernel>(t.tree, places[i][0], places[i][1]);
      },
      1);
  return forest;
}

} // namespace pcs

#endif // PCS_GENERATORS_GROW_FOREST_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Results of the generators.

#include "Results.h"
#include <pcs/generators/edit_branches.h>
#include <pcs/generators/fit_tree_habit.h>
#include <pcs/generators/grow_forest.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/sample_mesh.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/score_tree.h>
#include <pcs/generators/tree_at_age.h>
#include <pcs/make_branch_surface.h>

#include <iterator>

namespace pcs_test {
namespace generators {

namespace np = pcs::parameters;

void grow(Results& results)
{
  results("grow_tree");
  for (const auto& [name, habit] : pcs::tree_habits()) {
    Tree tree;
    pcs::grow_tree(tree, habit, np::random_seed(3));
    results << tree;
  }
  const Tree tree = small_tree(7);
  results("tree_at_age") << pcs::tree_at_age(tree, 0.6);
  Tree edited = pcs::prune_branch(tree, 3);
  pcs::turn_branch(edited, 5, Vector(0, 0, 1), 0.5);
  pcs::lengthen_branch(edited, 6, 1.3);
  results("prune_branch, turn_branch, lengthen_branch") << edited;
}

template <class Tag>
void scan(Results& results)
{
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = 2;
  scanner.angular_step = 0.003;
  scanner.leaves_per_length = 20;
  scanner.wind = 0.01;
  scanner.ground_radius = 2;
  scanner.posts = {{1, 1, 0.1, 2}};
  for (const double voxel_size : {0.0, 0.02}) {
    scanner.voxel_size = voxel_size;
    pcs::Virtual_scan<Kernel> result;
    pcs::scan_tree<Tag>(small_tree(7), result, scanner, np::random_seed(7));
    results(voxel_size > 0 ? "scan_tree, voxels" : "scan_tree")
        << result.points << result.node << result.station << result.hits << result.stations;
  }
}

void sample(Results& results)
{
  std::vector<Point> corners;
  std::vector<std::array<std::size_t, 3>> triangles;
  pcs::make_branch_surface(small_tree(7), corners, triangles);
  std::vector<std::pair<Point, Vector>> samples;
  pcs::sample_mesh(corners, triangles, 0.02, std::back_inserter(samples));
  results("sample_mesh") << samples;
}

template <class Tag>
void fit(Results& results)
{
  std::vector<Tree> trees;
  for (const std::uint64_t seed : {1u, 2u, 3u})
    trees.push_back(small_tree(seed));
  const pcs::Tree_habit_fit fit = pcs::fit_tree_habit<Tag>(trees, np::number_of_simulations(20));
  results("fit_tree_habit") << fit.crown_margin << fit.smallest_radius;
  for (const pcs::Habit_value& v : fit.values)
    results << v.value << v.standard_error << v.least << v.largest << v.number_of_samples;
  pcs::Forest_options options;
  options.number_of_trees = 5;
  options.age = {0.5, 1};
  results("grow_forest");
  for (const auto& tree : pcs::grow_forest<Kernel, Tag>(fit, options))
    results << tree.height << tree.age << tree.tree;
  const pcs::Tree_score score = pcs::score_tree<Tag>(trees[0], fit, np::number_of_simulations(30));
  results("score_tree") << score.distance << score.share;
  for (const pcs::Tree_deviation& d : score.deviations)
    results << d.deviation;
}

template <class Tag>
void record(Results& results)
{
  grow(results);
  scan<Tag>(results);
  sample(results);
  fit<Tag>(results);
}

} // namespace generators

Tree small_tree(std::uint64_t seed)
{
  pcs::Tree_habit habit = pcs::fruit_habit();
  habit.number_of_orders = 2;
  Tree tree;
  pcs::grow_tree(tree, habit, pcs::parameters::random_seed(seed));
  return tree;
}

void record_generators(bool is_sequential, Results& results)
{
  if (is_sequential)
    generators::record<Sequential>(results);
  else
    generators::record<CGAL::Parallel_if_available_tag>(results);
}

} // namespace pcs_test

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Results of the space of trees.

#include "Results.h"
#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/find_modes.h>
#include <pcs/fit_growth_path.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_at_age.h>
#include <pcs/mean_tree.h>
#include <pcs/orl_geodesic.h>
#include <pcs/sample_tree.h>

namespace pcs_test {
namespace shape_spaces {

namespace np = pcs::parameters;

std::vector<Point> scan(const Tree& tree, std::uint64_t seed)
{
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = 2;
  scanner.angular_step = 0.003;
  pcs::Virtual_scan<Kernel> result;
  pcs::scan_tree(tree, result, scanner, np::random_seed(seed));
  return std::move(result.points);
}

void add(const pcs::Orl_report& r, Results& results)
{
  results << r.number_of_common_branches << r.fraction_of_changed_matches << r.number_of_edges
          << r.matching_energy << r.unexplained_fraction << r.yaw << r.distance
          << r.number_of_point_pairs << r.number_of_unmatched_points << r.mean_marginal_violation;
}

template <class Space>
void add(const Space& space, const pcs::Orl_tree& tree, Results& results)
{
  Tree skeleton;
  std::vector<Point> points;
  space.skeleton(tree, skeleton);
  space.points(tree, points);
  results << skeleton << points;
}

template <class Tag>
void geodesic(Results& results)
{
  const Tree a = small_tree(1), b = small_tree(2);
  for (const bool is_sinkhorn : {false, true}) {
    pcs::Transport_options options;
    if (is_sinkhorn)
      options.method = pcs::Point_transport::sinkhorn;
    Tree tree;
    std::vector<Point> points;
    const auto report = pcs::orl_geodesic<Tag>(a,
                                               scan(a, 1),
                                               b,
                                               scan(b, 2),
                                               0.3,
                                               tree,
                                               points,
                                               np::transport_options(options));
    add(report, results(is_sinkhorn ? "orl_geodesic, sinkhorn" : "orl_geodesic"));
    results << tree << points;
  }
}

template <class Tag>
void pair(Results& results)
{
  pcs::Orl_shape_space<Kernel, Tag> space;
  space.add_skeleton(small_tree(1));
  space.add_skeleton(small_tree(2));
  add(space.build(), results("Orl_shape_space::matches"));
  for (const pcs::Branch_match& match : space.matches())
    results << match.parent << match.tip << match.confidence;
}

template <class Tag>
void family(Results& results)
{
  pcs::Orl_shape_space<Kernel, Tag> space;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const Tree tree = small_tree(seed);
    space.add(tree, scan(tree, seed));
  }
  add(space.build(), results("Orl_shape_space, four trees"));
  for (std::size_t h = 0; h < 4; ++h)
    add(space, space.tree(h), results);
  for (const double lambda : {-0.2, 0.5, 1.3})
    add(space, space.geodesic(0, 1, lambda), results);
  results("distance_matrix") << pcs::distance_matrix(space);
  for (const auto metric :
       {pcs::Orl_metric::square, pcs::Orl_metric::cone, pcs::Orl_metric::published})
    results << pcs::distance_matrix(space, np::metric(metric));
  results("find_branch_changes");
  for (const pcs::Branch_change& c : pcs::find_branch_changes(space, 0, 1))
    results << c.branch << c.parent << c.is_new << c.is_lost << c.length[0] << c.length[1]
            << c.radius[0] << c.radius[1] << c.angle;
  const pcs::Orl_tree median = pcs::mean_tree(space);
  add(space, median, results("mean_tree, median"));
  const pcs::Orl_tree mean = pcs::mean_tree(space, np::tree_mean(pcs::Tree_mean::frechet));
  add(space, mean, results("mean_tree, least squares"));
  add(space, pcs::weighted_mean(space, {1, 2, 3, 4}), results("weighted_mean"));
  add(space,
      pcs::parallel_displacement(space, space.tree(2), space.tree(0), space.tree(1), 0.5),
      results("parallel_displacement"));
  const auto shape = pcs::measure_shape(space, mean);
  results("measure_shape") << shape.length << shape.height << shape.crown_width << shape.lean
                           << shape.mean_angle << shape.angle_deviation;

  const auto modes = pcs::find_modes(space, 3);
  results("find_modes") << modes.shares << modes.deviations << modes.scores << modes.directions;
  add(space, pcs::tree_of_modes(space, modes, {1, -1}), results("tree_of_modes"));
  const auto at = pcs::project_on_modes(space, modes, median);
  results("project_on_modes, outlier_score")
      << at.scores << at.distance << pcs::outlier_score(space, modes, median);
  add(space, pcs::reconstruct_tree(space, modes, median, 2), results("reconstruct_tree"));
  const auto distribution = pcs::learn_distribution(space);
  results("sample_tree");
  for (const std::uint64_t index : {0u, 1u, 2u})
    add(space, pcs::sample_tree(space, distribution, 42, index), results);
}

template <class Tag>
void grow(Results& results)
{
  pcs::Orl_shape_space<Kernel, Tag> space;
  const Tree tree = small_tree(7);
  for (const double age : {0.5, 0.75, 1.0})
    space.add_skeleton(pcs::tree_at_age(tree, age));
  space.build();
  results("fit_growth_path");
  for (const bool is_monotone : {false, true}) {
    const auto path =
        pcs::fit_growth_path(space, {0, 1, 2}, {0.5, 0.75, 1}, np::is_monotone(is_monotone));
    for (const double time : {0.6, 0.9}) {
      Tree skeleton;
      space.skeleton(pcs::tree_at_time(space, path, time), skeleton);
      results << skeleton;
    }
  }
}

template <class Tag>
void record(Results& results)
{
  geodesic<Tag>(results);
  pair<Tag>(results);
  family<Tag>(results);
  grow<Tag>(results);
}

} // namespace shape_spaces

void record_shape_spaces(bool is_sequential, Results& results)
{
  if (is_sequential)
    shape_spaces::record<Sequential>(results);
  else
    shape_spaces::record<CGAL::Parallel_if_available_tag>(results);
}

} // namespace pcs_test

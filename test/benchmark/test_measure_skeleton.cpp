// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the measures of skeletons with values computed by hand.

#include "quality/measure_skeleton.h"
#include <pcs/IO/read_tree_csv.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using pcs_test::Row;
using namespace pcs_bench;

namespace {

constexpr double pi = 3.14159265358979323846;
const auto near = boost::test_tools::tolerance(1e-9);

/// A trunk of radius 0.1 from z = 0 to 2, with a branch of radius 0.03 and length 1 along x at z =
/// 1.
Tree make_cross()
{
  return pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.1},
                                      {0, 0, 0, 0, 1, 0.1},
                                      {1, 0, 0, 0, 2, 0.1},
                                      {1, 1, 0, 0, 1, 0.03},
                                      {3, 1, 0.5, 0, 1, 0.03},
                                      {4, 1, 1, 0, 1, 0.03}});
}

Tree shifted(Tree tree, const Kernel::Vector_3& by)
{
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].point = tree[v].point + by;
  return tree;
}

void check_is_perfect(const Skeleton_accuracy& a)
{
  for (const auto* list : {&a.at_distance, &a.at_radius})
    for (const Agreement& g : *list) {
      BOOST_TEST(g.precision == 1);
      BOOST_TEST(g.recall == 1);
      BOOST_TEST(g.f1() == 1);
    }
  BOOST_TEST(a.to_truth.quantile_95 < 1e-12);
  BOOST_TEST(a.to_result.rms < 1e-12);
  for (const Size_class& c : a.size_classes) {
    BOOST_TEST(c.true_length == c.length);
    BOOST_TEST(c.true_volume == c.volume);
    if (c.seen_length > 0) {
      BOOST_TEST(c.radius_error < 1e-12);
      BOOST_TEST(c.matched_share == 1, near);
    }
  }
  for (const Order_class& c : a.order_classes) {
    BOOST_TEST(c.number_of_missed_branches == 0u);
    BOOST_TEST(c.number_of_false_branches == 0u);
    BOOST_TEST(c.number_of_correct_parents == c.number_of_branches);
  }
  BOOST_TEST(a.correct_parent_share() == 1);
  BOOST_TEST(a.dbh_error() == 0);
  BOOST_TEST(a.length_error() == 0);
  BOOST_TEST(a.volume_error() == 0);
}

} // namespace

BOOST_AUTO_TEST_SUITE(measure_skeleton)

BOOST_AUTO_TEST_CASE(truth_agrees_with_itself)
{
  const Tree tree = make_cross();
  const Skeleton_accuracy a = pcs_bench::measure_skeleton<Kernel>(tree, {}, tree);
  check_is_perfect(a);
  BOOST_TEST(a.true_length == 3, near);
  BOOST_TEST(a.true_volume == pi * (0.01 * 2 + 0.0009), near);
  BOOST_TEST(a.dbh == 0.2, near);
  BOOST_TEST(a.height == 2, near);
  BOOST_TEST(a.size_classes[0].length == 2, near);
  BOOST_TEST(a.size_classes[1].length == 1, near);
}

BOOST_AUTO_TEST_CASE(thinning_straight_branches_changes_nothing_but_the_nodes)
{
  const Tree truth = make_cross();
  const Tree thin = pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.1},
                                                 {0, 0, 0, 0, 1, 0.1},
                                                 {1, 0, 0, 0, 2, 0.1},
                                                 {1, 1, 1, 0, 1, 0.03}});
  check_is_perfect(pcs_bench::measure_skeleton<Kernel>(truth, {}, thin));
}

BOOST_AUTO_TEST_CASE(a_shift_is_measured_both_ways)
{
  const Tree truth = make_cross();
  // Across both axes: every sample is 15 mm away.
  const auto a =
      pcs_bench::measure_skeleton<Kernel>(truth, {}, shifted(truth, Kernel::Vector_3(0, 0.015, 0)));
  BOOST_TEST(a.at_distance[0].f1() == 0);
  BOOST_TEST(a.at_distance[1].f1() == 1);
  BOOST_TEST(a.to_truth.mean == 0.015, near);
  BOOST_TEST(a.to_result.median == 0.015, near);
  BOOST_TEST(a.to_result.rms == 0.015, near);
  // A quarter of the radius is 25 mm on the trunk, and 7.5 mm on the branch.
  BOOST_TEST(a.at_radius[0].recall == 2.0 / 3, near);
  BOOST_TEST(a.at_radius[0].precision == 2.0 / 3, near);
  BOOST_TEST(a.at_radius[1].recall == 1, near); // 15 mm is half the radius of the branch
  BOOST_TEST(a.size_classes[1].matched_share == 1, near);
}

BOOST_AUTO_TEST_CASE(a_removed_branch_costs_recall_and_an_added_one_precision)
{
  const Tree truth = make_cross();
  const Tree trunk = pcs_test::make_tree<Kernel>(
      {{pcs::npos, 0, 0, 0, 0, 0.1}, {0, 0, 0, 0, 1, 0.1}, {1, 0, 0, 0, 2, 0.1}});
  const auto a = pcs_bench::measure_skeleton<Kernel>(truth, {}, trunk);
  // Of the 100 samples of the branch, at 5, 15, 25 ... mm, one or two are near the trunk's axis.
  BOOST_TEST(a.at_distance[0].precision == 1);
  BOOST_TEST(a.at_distance[0].recall == 2.01 / 3, near);
  BOOST_TEST(a.at_distance[1].recall == 2.03 / 3, near); // the third lies at 25 mm
  BOOST_TEST(a.length_error() == -1.0 / 3, near);
  BOOST_TEST(a.volume_error() == -0.0009 / 0.0209, near);
  BOOST_TEST_REQUIRE(a.order_classes.size() == 2u);
  BOOST_TEST(a.order_classes[0].number_of_missed_branches == 0u);
  BOOST_TEST(a.order_classes[1].number_of_true_branches == 1u);
  BOOST_TEST(a.order_classes[1].number_of_missed_branches == 1u);
  // The mean distance of the branch's samples to the trunk is 0.5.
  BOOST_TEST(a.to_result.mean == 0.5 / 3, near);

  const auto b = pcs_bench::measure_skeleton<Kernel>(trunk, {}, truth);
  BOOST_TEST(b.at_distance[0].precision == 2.01 / 3, near);
  BOOST_TEST(b.at_distance[0].recall == 1);
  BOOST_TEST(b.order_classes[1].number_of_false_branches == 1u);
  BOOST_TEST(b.order_classes[1].number_of_branches == 1u);
}

BOOST_AUTO_TEST_CASE(what_was_not_seen_need_not_be_found_but_may_be)
{
  const Tree truth = make_cross();
  const std::vector<std::size_t> hits = {1, 1, 1, 0, 0, 0};
  const auto a = pcs_bench::measure_skeleton<Kernel>(truth, hits, truth);
  BOOST_TEST(a.at_distance[0].f1() == 1);
  BOOST_TEST(a.seen_length == 2, near); // no node of the branch has points
  BOOST_TEST(a.true_length == 3, near);
  BOOST_TEST(a.order_classes[1].number_of_true_branches == 0u);
  const Tree trunk = pcs_test::make_tree<Kernel>(
      {{pcs::npos, 0, 0, 0, 0, 0.1}, {0, 0, 0, 0, 1, 0.1}, {1, 0, 0, 0, 2, 0.1}});
  BOOST_TEST((pcs_bench::measure_skeleton<Kernel>(truth, hits, trunk).at_distance[0].recall) == 1);
}

BOOST_AUTO_TEST_CASE(radii_are_compared_by_class)
{
  const Tree truth = make_cross();
  Tree result = truth;
  for (std::size_t v = 0; v < 3; ++v)
    result[v].radius = 0.11; // 10 % too thick
  for (std::size_t v = 3; v < 6; ++v)
    result[v].radius = 0.024; // 20 % too thin
  const auto a = pcs_bench::measure_skeleton<Kernel>(truth, {}, result);
  BOOST_TEST(a.size_classes[0].radius_error == 0.1, near);
  BOOST_TEST(a.size_classes[0].radius_bias == 0.1, near);
  BOOST_TEST(a.size_classes[1].radius_error == 0.2, near);
  BOOST_TEST(a.size_classes[1].radius_bias == -0.2, near);
  BOOST_TEST(a.radius_error == 0.1, near); // two thirds of the length
  BOOST_TEST(a.dbh_error() == 0.02, near);
  BOOST_TEST(a.size_classes[0].volume == pi * 2 * 0.0121, near);
}

BOOST_AUTO_TEST_CASE(the_volume_is_that_of_frusta)
{
  const Tree cone = pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.3}, {0, 0, 0, 0, 2, 0}});
  const auto a = pcs_bench::measure_skeleton<Kernel>(cone, {}, cone);
  BOOST_TEST(a.true_volume == pi * 0.09 * 2 / 3, near);
  BOOST_TEST(a.true_dbh == 2 * 0.3 * 0.35, near);
}

BOOST_AUTO_TEST_CASE(a_wrong_parent_is_found)
{
  // Two adjacent branches, and a twig that is a child of the wrong one.
  const std::vector<Row> rows = {{pcs::npos, 0, 0, 0, 0, 0.1},
                                 {0, 0, 0, 0, 1, 0.1},
                                 {1, 0, 0, 0, 2, 0.1},
                                 {1, 1, 0, 0, 1, 0.03},
                                 {3, 1, 1, 0, 1, 0.03},
                                 {2, 2, 0, 0, 2, 0.03},
                                 {5, 2, 1, 0, 2, 0.03},
                                 {4, 3, 1, 0, 1, 0.01},
                                 {7, 3, 1, 0.5, 1.5, 0.01}};
  const Tree truth = pcs_test::make_tree<Kernel>(rows);
  std::vector<Row> wrong = rows;
  wrong[7] = {6, 3, 1, 0.25, 1.25, 0.01};
  const auto a = pcs_bench::measure_skeleton<Kernel>(truth, {}, pcs_test::make_tree<Kernel>(wrong));
  BOOST_TEST_REQUIRE(a.order_classes.size() == 3u);
  BOOST_TEST(a.order_classes[2].number_of_matched_branches == 0u); // mostly the wrong link
  wrong[7] = {6, 3, 1, 0.05, 1.9, 0.01};
  wrong[8] = {7, 3, 1, 0.5, 1.5, 0.01};
  wrong.push_back({8, 3, 1, 0.02, 1.02, 0.01});
  const auto b = pcs_bench::measure_skeleton<Kernel>(truth, {}, pcs_test::make_tree<Kernel>(wrong));
  BOOST_TEST(b.order_classes[2].number_of_matched_branches == 1u);
  BOOST_TEST(b.order_classes[2].number_of_correct_parents == 0u);
  BOOST_TEST(b.order_classes[1].number_of_correct_parents == 2u);
  BOOST_TEST(b.correct_parent_share() == 0.75);
}

BOOST_AUTO_TEST_CASE(points_on_a_tube_are_at_their_distance_from_its_surface)
{
  const Tree tree = make_cross();
  std::vector<Kernel::Point_3> points;
  for (const double z : {0.2, 0.5, 1.7})
    points.emplace_back(0, 0.103, z); // 3 mm outside
  points.emplace_back(0.5, 0.028, 1); // 2 mm inside the branch
  const Distances d = point_to_surface_distances<Kernel>(tree, points);
  BOOST_TEST(d.mean == 0.011 / 4, near);
  BOOST_TEST(d.median == 0.003, near);
}

BOOST_AUTO_TEST_CASE(far_from_the_origin_nothing_changes)
{
  const Tree truth = make_cross();
  const Kernel::Vector_3 far(4.8e5, 5.3e6, 321);
  const auto a = pcs_bench::measure_skeleton<Kernel>(
      shifted(truth, far),
      {},
      shifted(shifted(truth, Kernel::Vector_3(0, 0.015, 0)), far));
  BOOST_TEST(a.to_truth.mean == 0.015, boost::test_tools::tolerance(1e-6));
  BOOST_TEST(a.dbh == 0.2, near);
}

BOOST_AUTO_TEST_CASE(trees_without_axes_are_refused)
{
  const Tree tree = make_cross();
  const Tree point = pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.1}});
  BOOST_CHECK_THROW((pcs_bench::measure_skeleton<Kernel>(tree, {}, point)), pcs::Invalid_input);
  BOOST_CHECK_THROW((pcs_bench::measure_skeleton<Kernel>(Tree(), {}, tree)), pcs::Invalid_input);
  BOOST_CHECK_THROW((pcs_bench::measure_skeleton<Kernel>(tree, {1}, tree)), pcs::Invalid_input);
  for (const double step : {0.0, 1e-9, std::nan("")}) {
    Accuracy_rules rules;
    rules.sampling_step = step;
    BOOST_CHECK_THROW((pcs_bench::measure_skeleton<Kernel>(tree, {}, tree, rules)),
                      pcs::Invalid_input);
  }
}

BOOST_AUTO_TEST_CASE(the_nearest_axis_and_surface_agree_with_a_search_of_all)
{
  std::vector<Axis_segment> segments;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 300; ++i) {
    const double a = 2.39996 * i;
    Axis_segment s;
    s.from = {std::cos(a), std::sin(a), 0.01 * i};
    s.to = s.from + Eigen::Vector3d(0.1 * std::sin(7.0 * i), 0.1 * std::cos(5.0 * i), 0.05);
    s.radius_from = 0.01 + 0.001 * (i % 7);
    s.radius_to = 0.012;
    segments.push_back(s);
    points.emplace_back(1.5 * std::cos(3.1 * i), std::sin(2.7 * i), 3 * std::abs(std::sin(i)));
  }
  const Segment_tree tree(segments);
  for (const Eigen::Vector3d& p : points) {
    double axis = 1e9, surface = 1e9;
    for (const Axis_segment& s : segments) {
      const double t = s.parameter(p), d = (s.from + t * (s.to - s.from) - p).norm();
      axis = std::min(axis, d);
      surface = std::min(surface, std::abs(d - s.radius(t)));
    }
    BOOST_TEST(tree.nearest_axis(p).distance == axis);
    BOOST_TEST(tree.nearest_surface(p).distance == surface);
  }
}

BOOST_AUTO_TEST_CASE(the_totals_of_the_virtual_scans_come_out)
{
  const char* data = std::getenv("PCS_TEST_DATA");
  if (data == nullptr) {
    BOOST_TEST_MESSAGE("skipped: PCS_TEST_DATA is not set");
    return;
  }
  struct Expected
  {
    const char* name;
    double volume, length, seen, dbh;
  };
  // Values of the README of the files.
  for (const Expected& e : {Expected{"beech", 1.9634, 1348.2, 1336.9, 0.417},
                            Expected{"sparse", 0.2706, 176.1, 169.8, 0.219}}) {
    Tree tree;
    std::vector<std::size_t> hits;
    pcs::IO::read_tree_csv<Kernel>(std::string(data) + "/trees/synth_" + e.name + "_truth.csv",
                                   tree,
                                   hits);
    const auto a = pcs_bench::measure_skeleton<Kernel>(tree, hits, tree);
    BOOST_TEST(std::abs(a.true_volume - e.volume) < 1e-4);
    BOOST_TEST(std::abs(a.true_length - e.length) < 0.06);
    BOOST_TEST(std::abs(a.seen_length - e.seen) < 0.06);
    BOOST_TEST(std::abs(a.true_dbh - e.dbh) < 6e-4);
    check_is_perfect(a);
  }
}

BOOST_AUTO_TEST_SUITE_END()

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Diameter at breast height: that of the tapered trunk at this height, with smoothed bark.

#include <pcs/skeleton/result/report_sizes.h>
#include <pcs/skeleton/result/skeleton_warnings.h>
#include <support/axes.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <string>

namespace test_report_sizes {

using namespace pcs::skeleton;

namespace {

double diameter_of(const Branch_tree& tree, double unit = 1)
{
  pcs::Skeleton_report report;
  report_sizes(tree, unit, Vec3::UnitZ(), 1.3 / unit, report);
  BOOST_TEST(report.breast_height == 1.3);
  return report.diameter_at_breast_height;
}

Branch_tree trunk_to(const Vec3& tip, std::size_t steps, double first, double last)
{
  Branch_tree tree;
  pcs_test::add_branch(tree, none, pcs_test::straight_axis(Vec3::Zero(), tip, steps, first, last));
  return tree;
}

} // namespace

BOOST_AUTO_TEST_SUITE(sizes_of_trees)

BOOST_AUTO_TEST_CASE(a_taper_has_the_diameter_of_the_place)
{
  // Trunks of many nodes, of two nodes, leaning, and with the tip just above breast height.
  for (const std::size_t steps : {200u, 7u, 1u})
    for (const Vec3& tip : {Vec3(0, 0, 4), Vec3(3, 0, 4), Vec3(0, 0, 1.35), Vec3(0, 0, 1.31)}) {
      const double share = 1.3 / tip.z();
      const double d = diameter_of(trunk_to(tip, steps, 0.2, 0.1));
      BOOST_TEST(std::abs(d - 2 * (0.2 - 0.1 * share)) < 1e-9, steps << " steps to " << tip.z());
    }
  const double d = diameter_of(trunk_to(Vec3(0, 0, 4000), 50, 200, 100), 0.001);
  BOOST_TEST(std::abs(d - 2 * (0.2 - 0.1 * 1.3 / 4)) < 1e-9);
}

BOOST_AUTO_TEST_CASE(bark_is_smoothed_and_what_is_far_does_not_count)
{
  Branch_tree tree = trunk_to(Vec3(0, 0, 4), 400, 0.1, 0.1);
  for (std::size_t k = 0; k <= 400; ++k)
    tree.nodes[k].radius += 0.01 * std::cos(3.14159265358979323846 * double(k) / 5); // 10 cm
  BOOST_TEST(std::abs(tree.nodes[130].radius - 0.11) < 1e-9);
  const double d = diameter_of(tree);
  BOOST_TEST(std::abs(d - 0.2) < 0.001);
  for (std::size_t k = 0; k <= 400; ++k)
    if (k < 110 || k > 150)
      tree.nodes[k].radius = 1;
  BOOST_TEST(std::abs(diameter_of(tree) - d) < 1e-9);
  for (std::size_t k = 110; k <= 150; ++k)
    tree.nodes[k].radius = k < 125 ? 1 : 0.01; // extrapolation of a line would be negative
  BOOST_TEST(diameter_of(tree) >= 0.02);
}

BOOST_AUTO_TEST_CASE(branches_of_the_trunk_do_not_count)
{
  Branch_tree tree = trunk_to(Vec3(0, 0, 4), 40, 0.1, 0.1);
  pcs_test::add_branch(tree,
                       12,
                       pcs_test::straight_axis(Vec3(0.2, 0, 1.2), Vec3(1, 0, 1.6), 8, 0.3, 0.3));
  BOOST_TEST(std::abs(diameter_of(tree) - 0.2) < 1e-9);
  // A trunk that is missing below: the thickest branch at this height is used.
  Branch_tree low = trunk_to(Vec3(0, 0, 1), 10, 0.1, 0.1);
  for (const double r : {0.03, 0.05, 0.04})
    pcs_test::add_branch(low,
                         10,
                         pcs_test::straight_axis(Vec3(r, 0, 1), Vec3(10 * r, 0, 2), 10, r, r));
  BOOST_TEST(std::abs(diameter_of(low) - 0.1) < 1e-9);
  BOOST_TEST(diameter_of(trunk_to(Vec3(0, 0, 1), 10, 0.1, 0.1)) == 0);
}

BOOST_AUTO_TEST_CASE(a_tree_that_forks_below_breast_height_has_several_stems)
{
  Branch_tree tree = trunk_to(Vec3(0, 0, 0.8), 8, 0.15, 0.15);
  const double radii[] = {0.08, 0.1, 0.09, 0.05};
  for (const double r : radii) // the last one is a limb
    pcs_test::add_branch(tree,
                         8,
                         pcs_test::straight_axis(Vec3(r, 0, 0.8), Vec3(10 * r, 0, 6), 20, r, r));
  pcs::Skeleton_report report;
  report_sizes(tree, 1, Vec3::UnitZ(), 1.3, report);
  BOOST_REQUIRE(report.stem_diameters.size() == 3u);
  BOOST_TEST(std::abs(report.stem_diameters[0] - 0.2) < 1e-9);
  BOOST_TEST(std::abs(report.stem_diameters[1] - 0.18) < 1e-9);
  BOOST_TEST(std::abs(report.stem_diameters[2] - 0.16) < 1e-9);
  BOOST_TEST(report.diameter_at_breast_height == report.stem_diameters[0]);
  // A single trunk has one stem, even if a thick branch hangs down to breast height.
  pcs::Skeleton_report single;
  report_sizes(trunk_to(Vec3(0, 0, 4), 40, 0.1, 0.1), 1, Vec3::UnitZ(), 1.3, single);
  BOOST_TEST(single.stem_diameters.size() == 1u);
}

/// A plausible tree of 10 m, without any warning.
pcs::Skeleton_report plausible_tree()
{
  pcs::Skeleton_report report;
  report.status = pcs::Status::converged;
  report.height = report.max_root_distance = 10;
  report.breast_height = 1.3;
  report.spacing = 0.01;
  report.noise = report.residual = 0.001;
  report.by_order.resize(1);
  report.by_order[0].length = 10;
  report.by_order[0].volume = report.total.volume = 10 * 3.14159265358979323846 * 0.1 * 0.1;
  report.stem_diameters = {0.2};
  return report;
}

bool warns_of(const pcs::Skeleton_report& report, const std::string& words)
{
  for (const std::string& sentence : pcs::warnings(report))
    if (sentence.find(words) != std::string::npos)
      return true;
  return false;
}

BOOST_AUTO_TEST_CASE(implausible_results_say_so)
{
  pcs::Skeleton_report report = plausible_tree();
  BOOST_TEST(pcs::warnings(report).empty());
  report.root_elevation = 1;
  BOOST_TEST(pcs::warnings(report).empty()); // occlusion of a tenth is usual on slopes
  report.root_elevation = 4.6;
  BOOST_TEST(warns_of(report, "the root is 4.6 above the lowest points: the foot"));
  report.is_root_given = true;
  BOOST_TEST(warns_of(report, "points below the given root are not part"));
  report = plausible_tree();
  report.height = 0.05; // a stem on the ground
  report.root_elevation = 0.15;
  BOOST_TEST(!warns_of(report, "the root is"));
  report.root_elevation = 0.25;
  BOOST_TEST(warns_of(report, "the foot of the tree may be missing"));
  report = plausible_tree();
  report.stem_diameters = {0.2, 0.15};
  BOOST_TEST(warns_of(report, "2 stems with diameters of 0.2, 0.15"));
  report = plausible_tree();
  BOOST_TEST(!warns_of(report, "another unit"));
  report.height = 0.02; // it lies
  BOOST_TEST(!warns_of(report, "another unit"));
  report.max_root_distance = 0.02;
  BOOST_TEST(warns_of(report, "the tree is 0.0154 times as high as breast height"));
  report.max_root_distance = 200;
  BOOST_TEST(warns_of(report, "the tree is 154 times as high as breast height"));
  report = plausible_tree();
  report.coordinate_step = 0.004;
  BOOST_TEST(pcs::warnings(report).empty());
  report.coordinate_step = 0.5;
  BOOST_TEST(warns_of(report, "rounded to steps of 0.5; branches"));
  report.is_single_precision = true;
  BOOST_TEST(warns_of(report, "32-bit floating-point"));
  report.voxel_size = 0.5; // reported as the cause
  BOOST_TEST(!warns_of(report, "32-bit floating-point"));
}

BOOST_AUTO_TEST_CASE(warnings_name_a_way_that_is_open)
{
  pcs::Skeleton_report report = plausible_tree();
  report.rejected_station_shift = 0.1;
  BOOST_TEST(warns_of(report, "check that the labels denote scanner stations"));
  report.is_rejected_station_detected = true; // there are no labels
  BOOST_TEST(!warns_of(report, "labels"));
  BOOST_TEST(warns_of(report, "check the unit of breast_height, or use do_register_stations"));
  report = plausible_tree();
  report.residual = 0.1;
  BOOST_TEST(warns_of(report, "this may be no tree (skeleton_method(level_sets)"));
  report.is_skeleton_given = true; // which only the method `chains` takes
  BOOST_TEST(!warns_of(report, "skeleton_method"));
  BOOST_TEST(warns_of(report, "check that the given skeleton is of this scan"));
}

BOOST_AUTO_TEST_CASE(reach_is_the_way_to_the_farthest_node)
{
  for (const Vec3& tip : {Vec3(0, 0, 4), Vec3(3, 0, 0), Vec3(0, 2, -1)}) {
    pcs::Skeleton_report report;
    report_sizes(trunk_to(tip, 7, 0.1, 0.1), 10, Vec3::UnitZ(), 1.3, report);
    BOOST_TEST(std::abs(report.max_root_distance - 10 * tip.norm()) < 1e-9);
  }
}

// A trunk that winds over a ball is too long for its diameter, as is a path that fills the ball.
BOOST_AUTO_TEST_CASE(wood_that_fills_the_space_is_doubted_and_no_tree)
{
  pcs::Skeleton_report report;
  report.status = pcs::Status::converged;
  report.noise = report.residual = 0.001;
  report.spacing = 0.01;
  report.height = report.max_root_distance = 2;
  report.by_order.resize(1);
  report.by_order[0].length = 13;
  report.by_order[0].volume = report.total.volume = 0.35; // a diameter of 0.19
  BOOST_TEST(pcs::warnings(report).size() == 1u);
  report.height = report.max_root_distance = report.by_order[0].length = 13;
  BOOST_TEST(pcs::warnings(report).empty());
  report.height = 1; // it lies on the ground
  BOOST_TEST(pcs::warnings(report).empty());
}

BOOST_AUTO_TEST_CASE(points_as_far_apart_as_the_trunk_is_thick_are_doubted)
{
  pcs::Skeleton_report report;
  report.status = pcs::Status::converged;
  report.height = report.max_root_distance = 4;
  report.by_order.resize(1);
  report.by_order[0].length = 4;
  report.by_order[0].volume = report.total.volume = 4 * 3.14159265358979323846 * 0.05 * 0.05;
  report.noise = report.residual = 0.001;
  report.spacing = 0.03;
  BOOST_TEST(pcs::warnings(report).empty());
  report.spacing = 0.05;
  BOOST_TEST(pcs::warnings(report).size() == 1u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_report_sizes

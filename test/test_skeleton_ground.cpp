// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// extract_tree_skeleton() finds the tree on ground, among plants, and in a pot.

#include <pcs/extract_tree_skeleton.h>
#include <support/tree_clouds.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_skeleton_ground {

using pcs_test::append;
using pcs_test::check_is_a_tree;
using pcs_test::cylinder;
using pcs_test::sheet;
using pcs_test::Tree;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using Cloud = std::vector<Point>;

BOOST_AUTO_TEST_SUITE(tree_skeleton_ground)

BOOST_AUTO_TEST_CASE(ground_is_left_out)
{
  Cloud points = cylinder(8000, 0.1, 3);
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j)
      points.emplace_back(-1 + 0.02 * i + 0.001 * (j % 3), -1 + 0.02 * j, 0.01 * std::sin(0.3 * i));
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_GT(report.number_of_ground_points, 7000u);
  BOOST_CHECK_LE(report.number_of_branches, 5u);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.2, 3.0);
}

// Relief and slopes rise above the foot, and ground points have a larger spacing than tree points.
BOOST_AUTO_TEST_CASE(ground_is_followed_up_slopes)
{
  Tree bare, tree;
  const Cloud& wood = pcs_test::small_scan().scan.points;
  const auto expected = pcs::extract_tree_skeleton(wood, bare);
  for (const double slope : {0.0, 0.15, 0.6}) {
    Cloud points = wood;
    for (int i = -90; i <= 90; ++i)
      for (int j = -90; j <= 90; ++j) {
        const double x = 0.03 * i, y = 0.03 * j;
        points.emplace_back(x, y, slope * x + 0.15 * std::sin(2 * x) * std::sin(2 * y));
      }
    const auto report = pcs::extract_tree_skeleton(points, tree);
    BOOST_TEST(double(report.number_of_ground_points) > 0.97 * double(points.size() - wood.size()));
    BOOST_CHECK_CLOSE(report.total.length, expected.total.length, 10.0);
    BOOST_CHECK_CLOSE(report.total.volume, expected.total.volume, 15.0);
    BOOST_CHECK_CLOSE(report.spacing, expected.spacing, 5.0);
  }
}

// Scans are cut along roads, and trees of a stand with some ground around each of them.
BOOST_AUTO_TEST_CASE(ground_may_be_a_strip_or_patches)
{
  Tree bare, tree;
  const Cloud& wood = pcs_test::small_scan().scan.points;
  const auto expected = pcs::extract_tree_skeleton(wood, bare);
  const auto check = [&](const auto& is_inside) {
    Cloud points = wood;
    for (int i = -300; i <= 300; ++i)
      for (int j = -90; j <= 90; ++j)
        if (is_inside(0.03 * i, 0.03 * j))
          points.emplace_back(0.03 * i, 0.03 * j, 0.002 * std::sin(7.0 * i * j));
    const auto report = pcs::extract_tree_skeleton(points, tree);
    BOOST_TEST(double(report.number_of_ground_points) > 0.97 * double(points.size() - wood.size()));
    BOOST_TEST((report.method == pcs::Skeleton_method::chains));
    BOOST_CHECK_CLOSE(report.total.volume, expected.total.volume, 15.0);
  };
  check([](double, double y) { return std::abs(y) < 0.8; });
  check([](double x, double y) { return std::hypot(std::abs(x - 3.5) - 3.5, y) < 1.5; });
}

BOOST_AUTO_TEST_CASE(grass_goes_with_the_ground)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-2, 2), share(0, 1);
  Cloud points = cylinder(8000, 0.05, 4);
  append(points, sheet(40000, 4, Vector(1, 0, 0), Vector(0, 1, 0), 0.01));
  for (int blade = 0; blade < 1500; ++blade) {
    const double x = place(random), y = place(random), height = 0.1 + 0.2 * share(random);
    for (int k = 0; k < 12; ++k)
      points.emplace_back(x, y, height * share(random));
  }
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  BOOST_TEST(report.number_of_ground_points > 54000u);
  BOOST_TEST(report.total.length < 5);
  BOOST_CHECK_CLOSE(report.height, 4, 3.0);
}

BOOST_AUTO_TEST_CASE(a_log_on_the_ground_is_told_from_it)
{
  Cloud points;
  for (const Point& p : cylinder(12000, 0.2, 5, Point(-2.5, 0, 0.15), Vector(1, 0, 0)))
    if (p.z() > 0)
      points.push_back(p);
  for (const Point& p : sheet(40000, 8, Vector(1, 0, 0), Vector(0, 1, 0), 0.005))
    if (std::abs(p.x()) > 2.5 || std::abs(p.y()) > 0.15)
      points.push_back(p);
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_EQUAL(report.status, pcs::Status::converged);
  BOOST_TEST(report.number_of_ground_points > 38000u);
  BOOST_CHECK_CLOSE(report.total.length, 5, 5.0);
  BOOST_CHECK_CLOSE(report.total.volume, CGAL_PI * 0.04 * 5, 15.0);
}

// Nearly all of the points lie in a thin sheet.
BOOST_AUTO_TEST_CASE(a_tree_on_wide_ground_is_no_sheet)
{
  Cloud points = cylinder(300, 0.15, 9);
  append(points, sheet(60000, 40, Vector(1, 0, 0), Vector(0, 1, 0), 0.01));
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_EQUAL(report.status, pcs::Status::converged);
  BOOST_TEST(report.number_of_ground_points > 55000u);
  BOOST_CHECK_CLOSE(report.height, 9, 5.0);
}

BOOST_AUTO_TEST_CASE(shrubs_on_the_ground_are_no_trunk)
{
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-1.8, 1.8), share(0, 1);
  Cloud points = cylinder(8000, 0.1, 3);
  append(points, sheet(20000, 4, Vector(1, 0, 0), Vector(0, 1, 0), 0.01));
  for (int k = 0; k < 15; ++k) {
    const Point foot(place(random), place(random), 0);
    if ((foot - CGAL::ORIGIN).squared_length() < 0.25)
      continue;
    for (int stem = 0; stem < 6; ++stem) {
      const double azimuth = 2 * CGAL_PI * share(random), tilt = 0.1 + 0.6 * share(random);
      append(points,
             cylinder(120,
                      0.004,
                      0.5,
                      foot,
                      Vector(std::sin(tilt) * std::cos(azimuth),
                             std::sin(tilt) * std::sin(azimuth),
                             std::cos(tilt))));
    }
  }
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  check_is_a_tree(tree);
  BOOST_CHECK_GT(report.number_of_ground_points, 15000u);
  BOOST_CHECK_CLOSE(report.height, 3.0, 3.0);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.2, 3.0);
}

// A fence, stakes and a box are not connected with the tree; a branch that hangs down to the ground
// is near the tree. A second stem is too tall for an object.
BOOST_AUTO_TEST_CASE(objects_that_stand_on_the_ground_are_removed)
{
  const Vector x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  Cloud points = cylinder(12000, 0.1, 6);
  append(points, sheet(30000, 6, x, y, 0.01));
  append(points, cylinder(3000, 0.02, 1.2, Point(0.05, 0, 1.25), Vector(1, 0, 0)));
  append(points, cylinder(3000, 0.02, 1.2, Point(1.3, 0, 0.02), z)); // hangs from the branch
  Tree tree;
  const auto expected = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_EQUAL(expected.number_of_object_points, 0u);
  const std::size_t alone = points.size();
  for (double at = -2; at <= 2; at += 1)
    append(points, cylinder(2500, 0.04, 1.2, Point(at, 0.7, 0), z));
  append(points, cylinder(8000, 0.03, 4, Point(-2, 0.7, 0.9), x));
  append(points, cylinder(3000, 0.04, 2, Point(-0.5, -0.5, 0), z));
  const std::size_t added = points.size() - alone;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  check_is_a_tree(tree);
  BOOST_TEST(double(report.number_of_object_points) > 0.9 * double(added)); // others are ground
  BOOST_TEST(report.number_of_object_points <= added);
  BOOST_CHECK_CLOSE(report.total.volume, expected.total.volume, 5.0);
  BOOST_CHECK_CLOSE(report.total.length, expected.total.length, 10.0);
  const auto post = pcs::extract_tree_skeleton(
      points,
      tree,
      pcs::parameters::root_position(Point(-2, 0.7, 0))); // a post is named as the tree
  BOOST_TEST(post.height < 1.5);
  append(points, cylinder(9000, 0.08, 5, Point(-1, -1.5, 0), z));
  const auto other = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_CLOSE(other.height, 6, 1.0);
  BOOST_CHECK_EQUAL(other.number_of_other_stems, 1u);
}

// A post and a fence that the branches of the tree touch are no branches of it.
BOOST_AUTO_TEST_CASE(objects_that_the_tree_touches_are_removed)
{
  const Vector x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  Cloud points = cylinder(12000, 0.1, 6);
  append(points, sheet(30000, 6, x, y, 0.01));
  for (const double height : {1.5, 2.5, 3.5}) {
    append(points, cylinder(3000, 0.02, 1.5, Point(0.05, 0, height), Vector(1, 0, 0)));
    append(points, cylinder(3000, 0.02, 1.5, Point(0, 0.05, height), Vector(0, 1, 0)));
  }
  Tree tree;
  const auto expected = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_EQUAL(expected.number_of_standing_branches, 0u);
  append(points, cylinder(8000, 0.05, 4, Point(1.5, 0.02, 0), z)); // at the tips of branches
  for (double at = -2; at <= 2; at += 1)
    append(points, cylinder(3000, 0.04, 1.6, Point(at, 1.45, 0), z));
  append(points, cylinder(9000, 0.03, 4, Point(-2, 1.45, 1.52), x)); // below a branch
  const auto report = pcs::extract_tree_skeleton(points, tree);
  check_is_a_tree(tree);
  BOOST_TEST(report.number_of_standing_branches > 3u);
  BOOST_TEST(!pcs::warnings(report).empty());
  BOOST_CHECK_CLOSE(report.total.volume, expected.total.volume, 10.0);
  BOOST_CHECK_CLOSE(report.total.length, expected.total.length, 15.0);
}

// The tank has more points than the tree, and more links to the crown than the stem.
BOOST_AUTO_TEST_CASE(a_tank_that_the_crown_touches_is_not_the_foot)
{
  const Vector x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  Cloud points = cylinder(9000, 0.06, 4);
  append(points, sheet(30000, 6, x, y, 0.01));
  for (double height = 1.4; height < 3.6; height += 0.2)
    for (const double side : {-0.4, 0.0, 0.4})
      append(points, cylinder(2000, 0.012, 1, Point(0, 0.05, height), Vector(side, 1, 0)));
  Tree tree;
  const auto expected = pcs::extract_tree_skeleton(points, tree);
  append(points, cylinder(40000, 0.35, 1.8, Point(0, 1.2, 0), z));
  const auto report = pcs::extract_tree_skeleton(points, tree);
  check_is_a_tree(tree);
  const Point root = tree[tree[boost::graph_bundle].root].point;
  BOOST_TEST(std::hypot(root.x(), root.y()) < 0.06);
  BOOST_CHECK_CLOSE(report.height, 4, 3.0);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.12, 5.0);
  BOOST_CHECK_CLOSE(report.total.volume, expected.total.volume, 20.0);
  BOOST_TEST(!pcs::warnings(report).empty());
}

// A roof alone has the shape of a terrain, with a short piece of the stem below it.
BOOST_AUTO_TEST_CASE(a_roof_is_no_ground)
{
  Cloud points = cylinder(6000, 0.15, 9, Point(-1.5, 0, 0));
  const Vector y(0, 1, 0);
  for (const Point& p : sheet(60000, 6, Vector(1, 0, 0), 1.5 * y, 0.003))
    points.push_back(p + Vector(3, 0, 3));
  for (const Point& p : sheet(40000, 3, Vector(0, 0, 1), 3 * y, 0.003))
    points.push_back(p + Vector(0, 0, 1.5));
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_EQUAL(report.number_of_ground_points, 0u);
  BOOST_TEST(report.number_of_wall_points > 99000u);
  BOOST_CHECK_CLOSE(report.height, 9, 1.0);
}

// The pot is thicker and has more points near the ground than the plant.
BOOST_AUTO_TEST_CASE(the_root_of_a_potted_plant_is_on_the_soil)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise(0, 0.0005);
  Cloud points;
  for (int i = 0; i < 9000; ++i) { // a mound of soil
    const double angle = 2 * CGAL_PI * share(random), r = 0.14 * std::sqrt(share(random));
    points.emplace_back(r * std::cos(angle),
                        r * std::sin(angle),
                        0.01 + 0.03 * std::exp(-r * r / 0.0025) + noise(random));
  }
  for (const double begin : {2.0, -0.8}) // two pieces of the wall of the pot
    for (int i = 0; i < 6000; ++i) {
      const double angle = begin + 2 * share(random), z = 0.06 * share(random);
      const double r = 0.13 + 0.02 * z / 0.13;
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  append(points, cylinder(2500, 0.008, 0.35, Point(0, 0, 0.035)));
  append(points, cylinder(900, 0.005, 0.2, Point(0.005, 0, 0.15), Vector(1, 0, 0.6)));
  append(points, cylinder(900, 0.005, 0.2, Point(-0.005, 0, 0.2), Vector(-1, 0, 0.6)));
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  check_is_a_tree(tree);
  const Point root = tree[tree[boost::graph_bundle].root].point;
  BOOST_TEST(std::hypot(root.x(), root.y()) < 0.01);
  BOOST_TEST(root.z() < 0.06);
  BOOST_CHECK_CLOSE(report.height, 0.35, 5.0);
  BOOST_TEST(report.by_order.front().length > 0.3);
  BOOST_TEST(report.number_of_branches < 30u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_skeleton_ground

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the simple trees, and of scans of them against closed-form equations.

#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_fixtures.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace test_tree_fixtures {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point_3 = Kernel::Point_3;
using Vector_3 = Kernel::Vector_3;

namespace {

/// A scanner without errors.
pcs::Virtual_scanner perfect()
{
  pcs::Virtual_scanner s;
  s.number_of_stations = 6;
  s.distance = 6;
  s.angular_step = 0.003;
  s.beam_width = s.range_noise = s.registration_error = s.outlier_share = s.bark_depth = 0;
  return s;
}

/// Checks that nearly all points lie within `tolerance` of the zero set of `distance`, with a
/// smaller mean distance and without bias.
void check_surface(const Tree& tree,
                   double tolerance,
                   const std::function<double(const Point_3&)>& distance)
{
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, perfect());
  BOOST_TEST_REQUIRE(scan.points.size() > 2000u);
  double sum = 0;
  std::size_t far = 0;
  for (const Point_3& p : scan.points) {
    sum += distance(p);
    far += std::abs(distance(p)) > tolerance ? 1 : 0;
  }
  BOOST_TEST(far == 0u);
  BOOST_TEST(std::abs(sum / double(scan.points.size())) < tolerance / 4);
}

} // namespace

BOOST_AUTO_TEST_SUITE(tree_fixtures)

BOOST_AUTO_TEST_CASE(a_cylinder_is_scanned_as_a_cylinder)
{
  // 96 sides: the polygon deviates by 0.027 % outside and inside.
  check_surface(pcs::make_cylinder_tree<Kernel>(3, 0.2), 0.2 * 6e-4, [](const Point_3& p) {
    if (p.z() > 3 - 1e-4)
      return 0.0; // closed end
    return std::hypot(p.x(), p.y()) - 0.2;
  });
}

BOOST_AUTO_TEST_CASE(a_cone_is_scanned_as_a_cone)
{
  check_surface(pcs::make_cone_tree<Kernel>(3, 0.2, 0.05), 0.2 * 6e-4, [](const Point_3& p) {
    return p.z() > 3 - 1e-4 ? 0.0 : std::hypot(p.x(), p.y()) - (0.2 - 0.05 * p.z());
  });
}

BOOST_AUTO_TEST_CASE(a_torus_arc_is_scanned_as_a_torus)
{
  const double bend = 1.5, angle = 1.2;
  // The chords of 64 steps deviate by 0.066 mm from the circle.
  check_surface(pcs::make_torus_arc_tree<Kernel>(bend, 0.1, angle), 0.2e-3, [&](const Point_3& p) {
    if (std::atan2(p.z(), bend - p.x()) > angle - 1e-3)
      return 0.0;
    return std::hypot(std::hypot(p.x() - bend, p.z()) - bend, p.y()) - 0.1;
  });
}

BOOST_AUTO_TEST_CASE(an_oblique_ellipse_is_scanned_as_one)
{
  const double tilt = 0.6, flatness = 0.7, radius = 0.15;
  const double a = radius / std::sqrt(flatness), b = radius * std::sqrt(flatness);
  const Vector_3 axis(std::sin(tilt), 0, std::cos(tilt)),
      short_axis(std::cos(tilt), 0, -std::sin(tilt));
  check_surface(pcs::make_oblique_ellipse_tree<Kernel>(3, radius, tilt, flatness),
                0.15 * 12e-4,
                [&](const Point_3& p) {
                  const Vector_3 v = p - Point_3(0, 0, 0);
                  if (v * axis > 3 - 1e-4)
                    return 0.0;
                  return (std::hypot(v.y() / a, (v * short_axis) / b) - 1) * radius;
                });
}

BOOST_AUTO_TEST_CASE(the_fork_has_two_arms_at_its_angle)
{
  const Tree tree = pcs::make_fork_tree<Kernel>(1, 0.1, 0.06, 1.0);
  const auto nodes = pcs::nodes_by_branch(tree);
  BOOST_TEST_REQUIRE(nodes.size() == 2u);
  const Vector_3 left = tree[nodes[0].back()].point - Point_3(0, 0, 1);
  const Vector_3 right = tree[nodes[1].back()].point - Point_3(0, 0, 1);
  BOOST_TEST(left * right == std::cos(1.0), boost::test_tools::tolerance(1e-9));
  BOOST_TEST((tree[nodes[1].front()].point == Point_3(0, 0, 1)));
}

BOOST_AUTO_TEST_CASE(twigs_stand_at_their_distance)
{
  const Tree tree = pcs::make_parallel_twigs_tree<Kernel>(1, 0.01, 0.03);
  const auto nodes = pcs::nodes_by_branch(tree);
  BOOST_TEST_REQUIRE(nodes.size() == 3u);
  for (std::size_t i = 0; i < nodes[1].size(); ++i)
    BOOST_TEST(CGAL::squared_distance(tree[nodes[1][i]].point, tree[nodes[2][i]].point) == 9e-4,
               boost::test_tools::tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(crossing_branches_leave_the_gap)
{
  const double radius = 0.03, gap = 0.01;
  const Tree tree = pcs::make_crossing_branches_tree<Kernel>(4, radius, gap);
  const auto nodes = pcs::nodes_by_branch(tree);
  const Kernel::Segment_3 low(tree[nodes[1].front()].point, tree[nodes[1].back()].point);
  const Kernel::Segment_3 high(tree[nodes[2].front()].point, tree[nodes[2].back()].point);
  const double distance = std::sqrt(CGAL::squared_distance(low, high));
  BOOST_TEST(distance == 2 * radius + gap, boost::test_tools::tolerance(0.02));
}

BOOST_AUTO_TEST_CASE(lengths_that_make_no_sense_are_refused)
{
  BOOST_CHECK_THROW(pcs::make_cylinder_tree<Kernel>(0, 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::make_cone_tree<Kernel>(1, -1, 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::make_torus_arc_tree<Kernel>(0.1, 0.2, 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::make_torus_arc_tree<Kernel>(1, 0.2, 4), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::make_oblique_ellipse_tree<Kernel>(1, 0.1, 1.6, 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::make_fork_tree<Kernel>(1, 0.1, 0, 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::make_parallel_twigs_tree<Kernel>(1, 0.1, 0), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::make_crossing_branches_tree<Kernel>(1, 0.1, 0), pcs::Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_tree_fixtures

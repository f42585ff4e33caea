// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Axes with bounded radii are recentered on their points.

#include <pcs/skeleton/radii/recenter_bounded_nodes.h>
#include <support/axes.h>

#include <CGAL/number_utils.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_follow_bounds {

using namespace pcs::skeleton;

namespace {

constexpr double radius = 0.01, fitted = 0.03, noise = 0.001;

/*!
  A branch along x about the line z = 0, seen from below over an arc of +-`half_arc` radians. Its
  axis lies higher, at the center of a circle of radius `fitted` through the lowest points, and its
  radius was bounded. A twig is attached to it.
*/
struct Bounded_branch
{
  Scan scan;
  Branch_tree tree;
  std::vector<double> before;

  explicit Bounded_branch(double half_arc)
  {
    const Vec3 up(0, 0, fitted - radius);
    pcs_test::add_branch(tree,
                         none,
                         pcs_test::straight_axis(up, up + Vec3(0.4, 0, 0), 20, radius, radius));
    const Index seat = 10;
    const Vec3 base = tree.nodes[seat].point;
    pcs_test::add_branch(tree,
                         seat,
                         pcs_test::straight_axis(base, base + Vec3(0, 0.1, 0), 4, 0.004, 0.004));
    for (const Branch_node& node : tree.nodes)
      before.push_back(node.branch == 0 ? fitted : node.radius);
    for (Index v = 1; v <= 20; ++v)
      for (int k = -5; k <= 5; ++k) {
        const double angle = half_arc * k / 5;
        const double x = tree.nodes[v].point.x() - 0.01;
        scan.points.push_back(Vec3(x, radius * std::sin(angle), -radius * std::cos(angle)));
        tree.node_of_point.push_back(v);
      }
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(recentered_nodes)

BOOST_AUTO_TEST_CASE(an_axis_behind_its_points_goes_to_them)
{
  Bounded_branch b(CGAL_PI / 3);
  const std::size_t moved =
      recenter_bounded_nodes(b.scan, b.before, noise, Recentering_options(), b.tree);
  BOOST_TEST(moved == 20u);         // all but the root
  for (Index v = 4; v <= 20; ++v) { // the fixed root changes the direction of the first nodes
    BOOST_TEST(std::abs(b.tree.nodes[v].point.z()) < 0.1 * radius);
    BOOST_TEST(std::abs(b.tree.nodes[v].point.y()) < 1e-9);
    BOOST_TEST(b.tree.nodes[v].radius == radius);
  }
}

BOOST_AUTO_TEST_CASE(bases_of_branches_stay_on_their_parents)
{
  Bounded_branch b(CGAL_PI / 3);
  recenter_bounded_nodes(b.scan, b.before, noise, Recentering_options(), b.tree);
  const Index base = b.tree.branches[1].nodes.front();
  BOOST_TEST((b.tree.nodes[base].point - b.tree.nodes[10].point).norm() < 1e-12);
  BOOST_TEST(b.tree.nodes[base + 1].point.z() == fitted - radius); // has no points
}

BOOST_AUTO_TEST_CASE(axes_whose_radii_stayed_do_not_move)
{
  Bounded_branch b(CGAL_PI / 3);
  b.before.assign(b.before.size(), radius);
  BOOST_TEST(recenter_bounded_nodes(b.scan, b.before, noise, Recentering_options(), b.tree) == 0u);
  BOOST_TEST(b.tree.nodes[10].point.z() == fitted - radius);
}

BOOST_AUTO_TEST_CASE(axes_with_points_all_around_do_not_move)
{
  Bounded_branch b(CGAL_PI);
  for (Branch_node& node : b.tree.nodes)
    node.point.z() = 0;
  for (Vec3& p : b.scan.points)
    p = Vec3(p.x(), 2 * p.y(), 2 * p.z());
  BOOST_TEST(recenter_bounded_nodes(b.scan, b.before, noise, Recentering_options(), b.tree) == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_follow_bounds

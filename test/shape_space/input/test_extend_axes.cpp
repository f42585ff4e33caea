// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shortened axes are extended to the end of their points; complete axes remain unchanged.

#include <pcs/shape_space/input/extend_axes.h>
#include <support/orl_trees.h>

#include <boost/test/unit_test.hpp>

#include <limits>

namespace test_extend_axes {

using namespace orl_test;
using pcs::shape_space::extend_axes;

namespace {

/// Shortens the last edge of every tip by a fraction.
Tree shortened(Tree tree, double share)
{
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (out_degree(v, tree) == 0) {
      const Vec3 from = to_eigen(tree[pcs::parent_node<Kernel>(v, tree)].point);
      tree[v].point = to_cgal(from + (1 - share) * (to_eigen(tree[v].point) - from));
    }
  return tree;
}

double worst_tip(const Tree& a, const Tree& b)
{
  double worst = 0;
  for (std::size_t v = 0; v < num_vertices(a); ++v)
    worst = std::max(worst, (to_eigen(a[v].point) - to_eigen(b[v].point)).norm());
  return worst;
}

} // namespace

BOOST_AUTO_TEST_SUITE(axes_and_points)

BOOST_AUTO_TEST_CASE(shortened_axes_find_back)
{
  for (unsigned seed = 1; seed < 4; ++seed) {
    const Tree whole = random_tree(seed, 3, 2);
    const Vec3 shift(5e6, -3e6, 0);
    const std::vector<Point> scan = tube_points(whole, 40000, seed);
    Tree tree = shortened(whole, 0.7);
    const double before = worst_tip(tree, whole);
    BOOST_TEST(extend_axes(tree, scan) >= 4u);
    BOOST_TEST(worst_tip(tree, whole) < 0.15 * before);
    // far from the origin
    Tree far = moved(shortened(whole, 0.7), Eigen::Matrix3d::Identity(), shift);
    std::vector<Point> far_scan;
    for (const Point& p : scan)
      far_scan.push_back(to_cgal(to_eigen(p) + shift));
    extend_axes(far, far_scan);
    BOOST_TEST(worst_tip(far, moved(tree, Eigen::Matrix3d::Identity(), shift)) < 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(whole_axes_stay)
{
  const Tree whole = random_tree(4, 3, 2);
  Tree tree = whole;
  BOOST_TEST(extend_axes(tree, tube_points(whole, 40000, 4)) == 0u);
  BOOST_TEST(worst_tip(tree, whole) == 0);
}

BOOST_AUTO_TEST_CASE(nothing_to_say)
{
  Tree empty;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Point> bad(100, Point(nan, 0, 0)), one(1, Point(0, 0, 50));
  BOOST_TEST(extend_axes(empty, one) == 0u);
  const Tree whole = random_tree(5, 3, 2);
  Tree tree = whole;
  BOOST_TEST(extend_axes(tree, std::vector<Point>()) == 0u);
  BOOST_TEST(extend_axes(tree, bad) == 0u);
  BOOST_TEST(extend_axes(tree, one) == 0u);
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].point = Point(1, 2, 3);
  BOOST_TEST(extend_axes(tree, std::vector<Point>(100, Point(1, 2, 4))) == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_extend_axes

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Radii along a given skeleton: its positions remain, radii are estimated from points and found
// axes.

#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Given_skeleton.h>
#include <pcs/skeleton/radii/measure_given.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/axes.h>

#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace test_measure_given {

using namespace pcs::skeleton;

namespace {

constexpr double stem_radius = 0.1, branch_radius = 0.03;

/// Adds random points on a tube without ends.
void add_tube(const Vec3& from, const Vec3& to, double radius, std::vector<Vec3>& points)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 along = to - from, e1 = along.unitOrthogonal();
  const Vec3 e2 = along.normalized().cross(e1);
  const int count = static_cast<int>(2 * CGAL_PI * radius * along.norm() / (0.012 * 0.012));
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * CGAL_PI * uniform(random), at = uniform(random);
    points.push_back(from + at * along + radius * (std::cos(angle) * e1 + std::sin(angle) * e2));
  }
}

/// A vertical stem and a branch to one side, with given nodes on their axes.
struct Measured
{
  Scan scan;
  Given_skeleton given;
  std::vector<std::uint8_t> is_used;
  Branch_tree tree;

  explicit Measured(const std::vector<Vec3>& points)
  {
    prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
    is_used.assign(scan.size(), 1);
    Index before = none;
    for (int k = 0; k <= 10; ++k)
      before = add(Vec3(0, 0, 0.2 * k), before);
    before = 5;                                                  // at a height of 1
    for (const double x : {0.06, 0.12, 0.2, 0.4, 0.6, 0.8, 1.0}) // two of them in the stem
      before = add(Vec3(x, 0, 1), before);
  }

  void run(const Branch_tree& found = Branch_tree())
  {
    tree = measure_given(scan, is_used, given, found, Given_skeleton_options());
  }

  /// Position in the coordinates of the input.
  Vec3 place(const Vec3& local) const { return scan.frame.to_input(local); }
  double radius(const Branch_node& node) const { return scan.frame.unit * node.radius; }

  /// A tree of one straight branch between two points.
  Branch_tree found_branch(const Vec3& from, const Vec3& to, double radius_of_branch) const
  {
    Branch_tree found;
    const double r = radius_of_branch / scan.frame.unit;
    pcs_test::add_branch(
        found,
        none,
        pcs_test::straight_axis(scan.frame.to_local(from), scan.frame.to_local(to), 20, r, r));
    return found;
  }

  /// The largest relative deviation of the radii of the stem from `wanted`.
  double worst_of_stem(double wanted) const
  {
    double worst = 0;
    for (const Index v : tree.branches[0].nodes)
      worst = std::max(worst, std::abs(radius(tree.nodes[v]) / wanted - 1));
    return worst;
  }

private:
  Index add(const Vec3& p, Index parent)
  {
    given.points.push_back(p);
    given.parent.push_back(parent);
    return static_cast<Index>(given.points.size() - 1);
  }
};

std::vector<Vec3> stem_and_branch()
{
  std::vector<Vec3> points;
  add_tube(Vec3(0, 0, 0), Vec3(0, 0, 2), stem_radius, points);
  add_tube(Vec3(stem_radius, 0, 1), Vec3(1, 0, 1), branch_radius, points);
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(radii_of_given_skeletons)

BOOST_AUTO_TEST_CASE(places_stay_and_radii_are_those_of_the_points_around)
{
  Measured m(stem_and_branch());
  m.run();
  BOOST_TEST_REQUIRE(m.tree.branches.size() == 2u);
  BOOST_TEST(m.worst_of_stem(stem_radius) < 0.03);
  for (const Index v : m.tree.branches[1].nodes)
    BOOST_TEST(std::abs(m.radius(m.tree.nodes[v]) / branch_radius - 1) < 0.05);
  for (const Vec3& p : m.given.points)
    BOOST_TEST(std::any_of(m.tree.nodes.begin(), m.tree.nodes.end(), [&](const Branch_node& node) {
      return (m.place(node.point) - p).norm() < 1e-6;
    }));
  for (std::size_t i = 0; i < m.scan.size(); ++i) { // points belong to their nearest edge
    const Vec3 p = m.place(m.scan.points[i]);
    if (std::abs(p.x()) > 0.2) {
      BOOST_TEST_REQUIRE(m.tree.node_of_point[i] != none);
      const Branch_node& node = m.tree.nodes[m.tree.node_of_point[i]];
      BOOST_TEST(node.branch == 1u);
      BOOST_TEST(p.x() < m.place(node.point).x() + 0.01);
      BOOST_TEST(p.x() > m.place(m.tree.nodes[node.parent].point).x() - 0.01);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_base_of_a_branch_is_as_thick_as_what_leaves_the_parent)
{
  Measured m(stem_and_branch());
  m.run();
  BOOST_TEST_REQUIRE(m.tree.branches.size() == 2u);
  const std::vector<Index>& nodes = m.tree.branches[1].nodes;
  BOOST_TEST_REQUIRE(nodes.size() == 8u);
  BOOST_TEST((m.place(m.tree.nodes[nodes[0]].point) - Vec3(0, 0, 1)).norm() < 1e-6);
  const Branch_node& first = m.tree.nodes[nodes[3]]; // outside
  BOOST_TEST(first.is_measured);
  for (std::size_t k = 0; k < 3; ++k) { // their nearest points belong to the stem
    BOOST_TEST(m.tree.nodes[nodes[k]].radius == first.radius);
    BOOST_TEST(!m.tree.nodes[nodes[k]].is_measured);
  }
}

BOOST_AUTO_TEST_CASE(points_that_are_not_used_count_nothing)
{
  std::vector<Vec3> points = stem_and_branch();
  add_tube(Vec3(0, 0, 0), Vec3(0, 0, 2), 1.3 * stem_radius, points); // ivy around it
  Measured m(points);
  const auto is_ivy = [&](std::size_t i) {
    const Vec3 p = m.place(m.scan.points[i]);
    return std::abs(std::hypot(p.x(), p.y()) / stem_radius - 1.3) < 1e-3;
  };
  m.run();
  BOOST_TEST(m.worst_of_stem(stem_radius) > 0.1);
  for (std::size_t i = 0; i < m.scan.size(); ++i)
    m.is_used[i] = !is_ivy(i);
  m.run();
  BOOST_TEST(m.worst_of_stem(stem_radius) < 0.03);
  for (std::size_t i = 0; i < m.scan.size(); ++i)
    if (is_ivy(i))
      BOOST_TEST(m.tree.node_of_point[i] == none);
}

BOOST_AUTO_TEST_CASE(where_no_points_are_branches_become_thinner_to_their_tips)
{
  Measured m(stem_and_branch());
  for (std::size_t i = 0; i < m.scan.size(); ++i)
    m.is_used[i] = m.place(m.scan.points[i]).z() < 1.1;
  m.run();
  const std::vector<Index>& nodes = m.tree.branches[0].nodes;
  double last = stem_radius;
  for (const Index v : nodes)
    if (m.place(m.tree.nodes[v].point).z() > 1.3) {
      BOOST_TEST(!m.tree.nodes[v].is_measured);
      BOOST_TEST(m.radius(m.tree.nodes[v]) < last);
      last = m.radius(m.tree.nodes[v]);
    }
  BOOST_TEST(last > 0);
  BOOST_TEST(last < 0.5 * stem_radius);

  std::fill(m.is_used.begin(), m.is_used.end(), 0); // no points at all
  m.run();
  for (const Branch_node& node : m.tree.nodes) {
    BOOST_TEST(node.radius == m.scan.spacing);
    BOOST_TEST(!node.is_measured);
  }
  for (const Index v : m.tree.node_of_point)
    BOOST_TEST(v == none);
}

BOOST_AUTO_TEST_CASE(
    a_branch_that_is_found_along_the_skeleton_tells_its_radius_unless_far_too_thick)
{
  Measured m(stem_and_branch());
  const Vec3 low(0, 0, -0.1), high(0, 0, 2.1);
  m.run(m.found_branch(low, high, 1.1 * stem_radius));
  BOOST_TEST(m.worst_of_stem(1.1 * stem_radius) < 1e-9);
  for (const double factor : {1.4, 2.0}) {
    m.run(m.found_branch(low, high, factor * stem_radius));
    BOOST_TEST(m.worst_of_stem(stem_radius) < 0.03);
  }
  m.run(m.found_branch(Vec3(-0.1, 0, 0.4), Vec3(0.1, 0, 0.4), 1.2 * stem_radius)); // across
  BOOST_TEST(m.worst_of_stem(stem_radius) < 0.03);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_measure_given

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Steps of the published method: given normals, slices, filter, and branches of sparse regions.

#include <pcs/skeleton/scan/prepare_scan.h>
#include <pcs/skeleton/slices/section_skeleton.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace test_detect_sections {

namespace {

using pcs::skeleton::Branch_node;
using pcs::skeleton::Cross_section_tree;
using pcs::skeleton::Found_section;
using pcs::skeleton::Index;
using pcs::skeleton::none;
using pcs::skeleton::Scan;
using pcs::skeleton::Surface_frame;
using pcs::skeleton::Vec3;
using Tag = CGAL::Parallel_if_available_tag;

void add_tube(std::vector<Vec3>& points, double radius, double noise, std::size_t n)
{
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, noise);
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.39996322972865332 * double(i),
                 r = radius + (noise > 0 ? normal(random) : 0);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), (double(i) + 0.5) / double(n));
  }
}

/// A scan in its own coordinates.
void make_scan(const std::vector<Vec3>& points, Scan& scan)
{
  scan.points = points;
  for (Index i = 0; i < points.size(); ++i)
    scan.point_of_input.push_back(i);
  pcs::skeleton::measure_points<CGAL::Sequential_tag>(scan);
}

std::vector<Found_section> detect(const Scan& scan,
                                  const std::vector<Surface_frame>& frames,
                                  const pcs::Slice_options& rules = {})
{
  return pcs::skeleton::detect_sections<Tag>(scan,
                                             std::vector<std::uint8_t>(scan.size(), 1),
                                             frames,
                                             rules,
                                             [](double) { return true; });
}

/// A twig beside a dense stem, which ends at the origin: from there in direction x at a height.
struct Twig
{
  static constexpr double step = 0.01;
  Scan scan;
  std::vector<Branch_node> nodes{1};
  std::vector<Index> node_of_point;

  Twig(double radius, double height, const std::vector<Vec3>& others = {})
  {
    std::vector<Vec3> points;
    for (int i = 0; i < 100; ++i) // of the stem
      points.emplace_back(0, 0, step * (i - 99));
    for (int i = 1; i <= 100; ++i)
      points.emplace_back(step * i, 0, height);
    points.insert(points.end(), others.begin(), others.end());
    make_scan(points, scan);
    node_of_point.assign(points.size(), none);
    std::fill_n(node_of_point.begin(), 100, 0);
    nodes[0].radius = radius;
  }

  void add(double allometry)
  {
    const std::vector<std::uint8_t> is_used(scan.size(), 1);
    pcs::skeleton::add_sparse_trees<Tag>(scan, is_used, {0}, allometry, nodes, node_of_point);
  }

  std::size_t number_of_tips() const
  {
    std::vector<std::uint8_t> is_parent(nodes.size(), 0);
    for (const Branch_node& node : nodes)
      if (node.parent != none)
        is_parent[node.parent] = 1;
    return static_cast<std::size_t>(std::count(is_parent.begin(), is_parent.end(), 0));
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(given_normals)

BOOST_AUTO_TEST_CASE(curvatures_follow_from_given_normals)
{
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) { // a plane with the normals of a cylinder along y
      points.emplace_back(0.01 * (i - 15), 0.01 * (j - 15), 0);
      normals.push_back(Vec3(points.back().x(), 0, 0.5).normalized());
    }
  normals[0] = Vec3::Zero(); // is estimated
  Scan scan;
  make_scan(points, scan);
  const auto given = pcs::skeleton::principal_curvatures<Tag>(scan, normals);
  const auto estimated = pcs::skeleton::principal_curvatures<Tag>(scan);
  const Index middle = 15 * 30 + 15;
  BOOST_CHECK_CLOSE(std::abs(given[middle].k1), 2.0, 2.0);
  BOOST_CHECK_GT(std::abs(given[middle].e2.y()), 0.999);
  BOOST_CHECK_SMALL(estimated[middle].k1, 1e-6);
  BOOST_CHECK_GT(std::abs(given[0].normal.z()), 0.999);
}

BOOST_AUTO_TEST_CASE(normals_of_merged_points_are_averaged_without_their_signs)
{
  Scan scan;
  scan.points = {Vec3(0, 0, 0), Vec3(1, 0, 0)};
  scan.point_of_input = {0, 0, 1, 1};
  scan.frame.axes << 0, 1, 0, -1, 0, 0, 0, 0, 1; // a quarter turn
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto normals = pcs::skeleton::normals_of_scan(
      scan,
      {Vec3(7, 0, 0), Vec3(-1e-200, 0, 0), Vec3(nan, 0, 0), Vec3::Zero()});
  BOOST_TEST_REQUIRE(normals.size() == 2u);
  BOOST_CHECK_SMALL((normals[0] - Vec3(0, -1, 0)).norm(), 1e-12);
  BOOST_CHECK(normals[1] == Vec3::Zero());
  BOOST_CHECK(pcs::skeleton::normals_of_scan(scan, {}).empty());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(detected_sections)

// A second tube around the first one is outside of slices with the radius of curvature.
BOOST_AUTO_TEST_CASE(a_slice_has_the_radius_of_curvature)
{
  std::vector<Vec3> points;
  add_tube(points, 0.1, 0, 4000);
  const std::size_t inner = points.size();
  add_tube(points, 0.12, 0, 4000);
  Scan scan;
  make_scan(points, scan);
  std::vector<Surface_frame> frames(points.size()); // flat: no candidates
  for (std::size_t i = 0; i < inner; ++i) {
    frames[i].normal = -Vec3(points[i].x(), points[i].y(), 0).normalized();
    frames[i].e2 = Vec3::UnitZ();
    frames[i].k1 = 10;
  }
  const auto largest = [&](const pcs::Slice_options& rules) {
    const auto sections = detect(scan, frames, rules);
    BOOST_TEST_REQUIRE(!sections.empty());
    double radius = 0;
    for (const Found_section& s : sections)
      radius = std::max(radius, s.radius());
    return radius;
  };
  BOOST_CHECK_CLOSE(largest({}), 0.1, 0.1);
  pcs::Slice_options wide;
  wide.radius = 1.3;
  BOOST_CHECK_GT(largest(wide), 0.103);
  pcs::Slice_options moved;
  moved.radius_offset = 0.03 / scan.spacing;
  BOOST_CHECK_GT(largest(moved), 0.103);
}

BOOST_AUTO_TEST_CASE(threads_do_not_change_a_section)
{
  std::vector<Vec3> points;
  add_tube(points, 0.05, 0.002, 6000);
  Scan scan;
  make_scan(points, scan);
  const auto frames = pcs::skeleton::principal_curvatures<Tag>(scan);
  const std::vector<std::uint8_t> is_used(scan.size(), 1);
  const auto expected =
      pcs::skeleton::detect_sections<CGAL::Sequential_tag>(scan, is_used, frames, {}, [](double) {
        return true;
      });
  BOOST_TEST_REQUIRE(expected.size() > 50u);
  for (const int count : pcs_test::thread_counts)
    pcs_test::with_threads(count, [&] {
      const auto sections = detect(scan, frames);
      BOOST_TEST_REQUIRE(sections.size() == expected.size());
      for (std::size_t k = 0; k < sections.size(); ++k)
        BOOST_REQUIRE(sections[k].point == expected[k].point &&
                      sections[k].center == expected[k].center &&
                      sections[k].major == expected[k].major);
    });
  pcs::Slice_options all;
  all.do_mark_support = false;
  BOOST_TEST(detect(scan, frames, all).size() > expected.size());
}

BOOST_AUTO_TEST_CASE(a_line_has_no_sections)
{
  std::vector<Vec3> points;
  for (int i = 0; i < 50; ++i)
    points.emplace_back(0, 0, 0.01 * i);
  Scan scan;
  make_scan(points, scan);
  BOOST_TEST(detect(scan, pcs::skeleton::principal_curvatures<Tag>(scan)).empty());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(cross_section_tree)

BOOST_AUTO_TEST_CASE(wide_sections_and_tips_inside_their_parents_are_removed)
{
  Cross_section_tree tree;
  //                 0 root, 1, 2 wide, 3 above it, 4 and 5 inside 1, 6 tip
  tree.center = {Vec3(0, 0, 0),
                 Vec3(0, 0, 3),
                 Vec3(0, 0, 6),
                 Vec3(0, 0, 9),
                 Vec3(0.05, 0, 3),
                 Vec3(0.1, 0, 3),
                 Vec3(0, 0, 9.5)};
  tree.radius = {1, 1, 1.6, 1, 0.9, 0.5, 1};
  tree.parent = {none, 0, 1, 2, 1, 4, 3};
  tree.order = {0, 1, 2, 3, 4, 5, 6};
  Cross_section_tree fixed = tree;
  fixed.number_of_fixed = 7;
  tree.filter();
  BOOST_TEST(tree.is_kept == (std::vector<std::uint8_t>{1, 1, 0, 1, 0, 0, 1}));
  BOOST_TEST(tree.parent[3] == 1u);
  fixed.filter();
  BOOST_TEST(fixed.is_kept == std::vector<std::uint8_t>(7, 1));
}

BOOST_AUTO_TEST_CASE(kept_sections_are_a_diameter_apart)
{
  Cross_section_tree tree;
  for (Index i = 0; i < 21; ++i) {
    tree.center.emplace_back(0, 0, 0.7 * i); // the center of the tip is inside its parent
    tree.radius.push_back(1);
    tree.parent.push_back(i == 0 ? none : i - 1);
    tree.order.push_back(i);
  }
  tree.filter();
  const std::vector<Index> kept = tree.thin();
  for (Index i = 1; i < 20; ++i) {
    BOOST_TEST(tree.is_kept[i] == (i % 3 == 0));
    BOOST_TEST(kept[i] == 3 * (i / 3));
  }
  BOOST_TEST(tree.is_kept[20] == 1); // the tip
  BOOST_TEST(tree.parent[20] == 18u);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(trees_of_sections)

// Three sections of an arc: a joint of the ends is shorter than the arc, but across their axes.
BOOST_AUTO_TEST_CASE(the_cost_of_turns_follows_a_bend)
{
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i)
    points.emplace_back(0, 0, 0.005 * i);
  Scan scan;
  make_scan(points, scan);
  scan.spacing = 0.1;
  std::vector<Found_section> sections(3);
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = 0.25 * double(k) * 3.14159265358979;
    sections[k].center = Vec3(1 - std::cos(angle), 0, std::sin(angle));
    sections[k].along = Vec3(std::sin(angle), 0, std::cos(angle));
    sections[k].major = sections[k].minor = 0.05;
  }
  const auto point_before_the_tip = [&](double turn_cost) {
    pcs::Slice_options rules;
    rules.turn_cost = turn_cost;
    const auto tree = pcs::skeleton::section_skeleton<Tag>(scan,
                                                           std::vector<std::uint8_t>(20, 1),
                                                           sections,
                                                           {0},
                                                           rules);
    for (const Branch_node& node : tree.nodes)
      if (node.point == sections[2].center)
        return tree.nodes[node.parent].point;
    return Vec3(9, 9, 9);
  };
  BOOST_CHECK(point_before_the_tip(0) == sections[0].center);
  BOOST_CHECK(point_before_the_tip(1) == sections[1].center);
}

// Points on a tube with sections, and on a second tube around it.
BOOST_AUTO_TEST_CASE(dense_points_are_near_the_surface)
{
  std::vector<Vec3> points;
  add_tube(points, 0.1, 0, 3000);
  add_tube(points, 0.13, 0, 3000);
  Scan scan;
  make_scan(points, scan);
  std::vector<Found_section> sections(6);
  for (std::size_t k = 0; k < 6; ++k) {
    sections[k].center = Vec3(0, 0, 0.2 * double(k));
    sections[k].major = sections[k].minor = 0.1;
  }
  const auto number_of_dense = [&](double radius, double offset) {
    pcs::Slice_options rules;
    rules.dense_radius = radius;
    rules.dense_offset = offset / scan.spacing;
    const auto tree = pcs::skeleton::section_skeleton<Tag>(scan,
                                                           std::vector<std::uint8_t>(6000, 1),
                                                           sections,
                                                           {0},
                                                           rules);
    std::size_t count = 0;
    for (const Index v : tree.node_of_point)
      count += v != none && tree.nodes[v].is_measured;
    return count;
  };
  BOOST_TEST(number_of_dense(0, 0.001) == 3000u);
  BOOST_TEST(number_of_dense(0.25, 0.001) == 3000u);
  BOOST_TEST(number_of_dense(0.35, 0) == 6000u);
  BOOST_TEST(number_of_dense(0, 0.035) == 6000u);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(sparse_trees)

BOOST_AUTO_TEST_CASE(the_exponent_determines_the_radii)
{
  constexpr double radius = 0.008;
  for (const double exponent : {0.0, 0.5, 1.0}) {
    Twig twig(radius, 0);
    twig.add(exponent);
    BOOST_TEST_REQUIRE(twig.nodes.size() > 20u);
    for (const Branch_node& node : twig.nodes)
      if (node.point.x() > 0.3 && node.point.x() < 0.7) // of 1 m
        BOOST_CHECK_SMALL(node.radius - radius * std::pow(1 - node.point.x(), exponent),
                          0.05 * radius);
  }
}

BOOST_AUTO_TEST_CASE(the_node_at_a_joint_is_smoothed)
{
  constexpr double height = 0.04;
  Twig twig(0.002, height);
  twig.add(0.4);
  BOOST_TEST_REQUIRE(twig.nodes.size() > 4u);
  BOOST_TEST(twig.nodes[1].parent == 0u);
  BOOST_CHECK_CLOSE(twig.nodes[1].point.z(), 0.75 * height, 1e-6); // 1/2 + 1/4 of the next
  BOOST_CHECK_CLOSE(twig.nodes[3].point.z(), height, 1e-6);
}

// Some points beside the twig, which are nearer than its radius.
BOOST_AUTO_TEST_CASE(sparse_outliers_are_filtered)
{
  std::vector<Vec3> others;
  for (int i = 0; i < 5; ++i)
    others.emplace_back(0.3, 0.02 + 0.01 * i, 0);
  Twig thick(0.2, 0, others), thin(0.002, 0, others);
  thick.add(0.4);
  thin.add(0.4);
  BOOST_TEST(thick.number_of_tips() == 1u);
  BOOST_TEST(thin.number_of_tips() == 2u); // a twig of its own
  for (const Index v : thick.node_of_point)
    BOOST_TEST_REQUIRE(v < thick.nodes.size());
}

BOOST_AUTO_TEST_CASE(sparse_nodes_are_about_a_diameter_apart)
{
  Twig thick(0.06, 0), thin(0.002, 0);
  thick.add(0.4);
  thin.add(0.4);
  BOOST_TEST(thin.nodes.size() > 30u); // one per level set of 1 m
  BOOST_TEST(thick.nodes.size() > 8u);
  BOOST_TEST(thick.nodes.size() < 20u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_detect_sections

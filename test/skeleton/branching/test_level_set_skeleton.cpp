// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeleton of a plant with leaf blades by the centers of geodesic level sets.

#include <pcs/Tree_skeletonization.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/skeleton/branching/level_set_skeleton.h>
#include <support/blade_plant.h>
#include <support/threads.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_level_set_skeleton {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Tree = pcs::Tree_skeleton<Kernel>;
namespace np = pcs::parameters;
namespace sk = pcs::skeleton;

namespace {

using pcs_test::blade_length;
using pcs_test::blade_width;
using pcs_test::midrib;
using pcs_test::plant;
using pcs_test::stem_radius;

std::size_t number_of_branches(const Tree& tree)
{
  std::size_t last = 0;
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    last = std::max<std::size_t>(last, tree[v].branch);
  return last + 1;
}

/// Distance of a position from the polyline of all edges.
double distance_from(const Tree& tree, const Point& p)
{
  double least = 1e9;
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const Point a = tree[source(e, tree)].point;
    const Kernel::Vector_3 d = tree[target(e, tree)].point - a;
    const double length2 = d.squared_length();
    const double t = length2 > 0 ? std::clamp((p - a) * d / length2, 0.0, 1.0) : 0;
    least = std::min(least, std::sqrt((p - (a + t * d)).squared_length()));
  }
  return least;
}

} // namespace

BOOST_AUTO_TEST_SUITE(level_set_skeleton)

BOOST_AUTO_TEST_CASE(each_blade_has_one_axis_along_its_midrib)
{
  constexpr std::size_t blades = 7;
  Tree tree;
  const auto report =
      pcs::extract_tree_skeleton(plant(blades),
                                 tree,
                                 np::skeleton_method(pcs::Skeleton_method::level_sets));
  BOOST_TEST(report.status == pcs::Status::converged);
  BOOST_TEST(number_of_branches(tree) >= blades + 1);
  BOOST_TEST(number_of_branches(tree) <= 2 * blades);
  for (std::size_t b = 0; b < blades; ++b)
    for (double s = 0.1; s < 0.65; s += 0.05) {
      const Point p = midrib(CGAL_PI * double(b) + 0.3 * double(b), 0.2 + 0.1 * double(b), s);
      BOOST_TEST(distance_from(tree, p) < 0.25 * blade_width, "blade " << b << ", " << s << " m");
    }
  for (double z = 0.05; z < 0.95; z += 0.05)
    BOOST_TEST(distance_from(tree, Point(0, 0, z)) < stem_radius, "stem at " << z << " m");
}

BOOST_AUTO_TEST_CASE(the_sections_of_a_blade_are_flat)
{
  Tree tree;
  pcs::extract_tree_skeleton(plant(1), tree, np::skeleton_method(pcs::Skeleton_method::level_sets));
  std::vector<double> major, minor;
  for (const auto v : boost::make_iterator_range(vertices(tree))) {
    const double out = std::hypot(tree[v].point.x(), tree[v].point.y());
    if (out < 0.2 || out > 0.35)
      continue;
    major.push_back(tree[v].major_radius);
    minor.push_back(tree[v].minor_radius);
  }
  BOOST_TEST_REQUIRE(major.size() > 5);
  std::sort(major.begin(), major.end());
  std::sort(minor.begin(), minor.end());
  // of a strip of half width a: sqrt(2/3) a
  const double expected = std::sqrt(2.0 / 3) * 0.5 * blade_width;
  BOOST_TEST(major[major.size() / 2] > 0.7 * expected);
  BOOST_TEST(major[major.size() / 2] < 1.1 * expected);
  BOOST_TEST(minor[minor.size() / 2] < 0.2 * expected);
}

BOOST_AUTO_TEST_CASE(all_points_of_the_plant_belong_to_branches)
{
  const std::vector<Point> points = plant(3);
  pcs::Tree_skeletonization stages(points, np::skeleton_method(pcs::Skeleton_method::level_sets));
  Tree tree;
  stages.extract(tree);
  const auto& nodes = stages.branches().node_of_point;
  const auto count = std::count(nodes.begin(), nodes.end(), sk::none);
  BOOST_TEST(double(count) < 0.1 * double(nodes.size()));
}

BOOST_AUTO_TEST_CASE(the_result_is_the_same_for_all_numbers_of_threads)
{
  const std::vector<Point> points = plant(4);
  const auto result = [&](auto tag) {
    Tree tree;
    pcs::extract_tree_skeleton<decltype(tag)>(
        points,
        tree,
        np::skeleton_method(pcs::Skeleton_method::level_sets));
    std::vector<double> values;
    for (const auto v : boost::make_iterator_range(vertices(tree)))
      values.insert(values.end(),
                    {tree[v].point.x(), tree[v].point.y(), tree[v].point.z(), tree[v].radius});
    return values;
  };
  const std::vector<double> expected = result(CGAL::Sequential_tag());
  BOOST_TEST_REQUIRE(!expected.empty());
  for (const int count : pcs_test::thread_counts)
    pcs_test::with_threads(count, [&] {
      BOOST_TEST(result(CGAL::Parallel_if_available_tag()) == expected);
    });
}

BOOST_AUTO_TEST_CASE(a_single_component_gives_no_tree)
{
  sk::Scan scan;
  scan.points = {sk::Vec3(0, 0, 0), sk::Vec3(1, 0, 0)};
  scan.spacing = 1;
  sk::Layer_tree layers;
  layers.node_of_point = {0, 0};
  layers.parent = {sk::none};
  layers.center = {sk::Vec3(0.5, 0, 0)};
  layers.spread = {0.5};
  layers.first = {0, 2};
  layers.point = {0, 1};
  BOOST_TEST(sk::level_set_skeleton(scan, layers, {0}).nodes.empty());
  BOOST_TEST(sk::level_set_skeleton(scan, layers, {}).nodes.empty());
}

BOOST_AUTO_TEST_CASE(the_skeleton_begins_with_the_longest_path_from_the_root)
{
  sk::Scan scan;
  sk::Layer_tree layers;
  scan.spacing = 1;
  for (sk::Index i = 0; i < 5; ++i) {
    scan.points.emplace_back(i == 0 ? 10 : 0, 0, i); // the first component is a stray point
    layers.node_of_point.push_back(i);
    layers.parent.push_back(i < 2 ? sk::none : i - 1);
    layers.center.push_back(scan.points.back());
    layers.spread.push_back(0);
    layers.first.push_back(i);
    layers.point.push_back(i);
  }
  layers.first.push_back(5);
  const sk::Branch_tree tree = sk::level_set_skeleton(scan, layers, {0, 1});
  BOOST_TEST_REQUIRE(tree.nodes.size() == 4u);
  BOOST_TEST((tree.nodes.front().point == scan.points[1]));
  BOOST_TEST((tree.nodes.back().point == scan.points[4]));
  BOOST_TEST(tree.node_of_point[0] == sk::none);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_level_set_skeleton

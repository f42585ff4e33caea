// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeleton of a tube and a twig by slices.

#include <pcs/Tree_skeletonization.h>
#include <pcs/extract_tree_skeleton.h>
#include <support/sections.h>
#include <support/threads.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/tags.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <random>
#include <vector>

namespace test_section_skeleton {

using pcs::skeleton::Vec3;
using pcs_test::tube;

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

std::vector<Kernel::Point_3> noisy_tube()
{
  std::mt19937 random(4);
  std::normal_distribution<double> normal(0, 0.002);
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : tube(0.1, 2, 4000))
    points.emplace_back(p.x() + normal(random), p.y() + normal(random), p.z());
  return points;
}

std::size_t number_of_measured(const std::vector<Kernel::Point_3>& points,
                               const pcs::Slice_options& rules,
                               const Vec3& normal)
{
  std::map<Kernel::Point_3, Kernel::Vector_3> normals;
  for (const Kernel::Point_3& p : points)
    normals[p] = normal == Vec3::Zero() ? Kernel::Vector_3(p.x(), p.y(), 0)
                                        : Kernel::Vector_3(normal.x(), normal.y(), normal.z());
  pcs::Tree_skeletonization stages(points,
                                   pcs::parameters::skeleton_method(pcs::Skeleton_method::sections)
                                       .slice_options(rules)
                                       .normal_map(boost::make_assoc_property_map(normals)));
  Tree tree;
  stages.extract(tree);
  std::size_t count = 0;
  for (const auto& node : stages.branches().nodes)
    count += node.is_measured;
  return count;
}

} // namespace

BOOST_AUTO_TEST_SUITE(section_skeleton)

BOOST_AUTO_TEST_CASE(the_way_of_the_dissertation_runs_from_end_to_end)
{
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : tube(0.1, 2, 8000))
    points.emplace_back(p.x(), p.y(), p.z());
  for (int i = 0; i < 40; ++i) // a twig that is too thin for slices
    points.emplace_back(0.11 + 0.015 * i, 0, 1 + 0.015 * i);
  pcs::Tree_skeleton<Kernel> tree;
  pcs::Tree_skeletonization stages(
      points,
      pcs::parameters::skeleton_method(pcs::Skeleton_method::sections));
  const auto report = stages.extract(tree);
  BOOST_CHECK_EQUAL(report.status, pcs::Status::converged);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.2, 5.0);
  BOOST_CHECK_EQUAL(num_edges(tree) + 1, num_vertices(tree));
  double farthest = 0, thinnest = 1;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    farthest = std::max(farthest, tree[v].point.x());
    thinnest = std::min(thinnest, tree[v].radius);
  }
  BOOST_CHECK_GT(farthest, 0.5); // the sparse part is included
  BOOST_CHECK_LT(thinnest, 0.05);
}

BOOST_AUTO_TEST_CASE(threads_do_not_change_the_published_method)
{
  const std::vector<Kernel::Point_3> points = noisy_tube();
  const auto np = pcs::parameters::skeleton_method(pcs::Skeleton_method::sections);
  Tree expected;
  pcs::extract_tree_skeleton<CGAL::Sequential_tag>(points, expected, np);
  BOOST_TEST_REQUIRE(num_vertices(expected) > 2u);
  for (const int count : pcs_test::thread_counts)
    pcs_test::with_threads(count, [&] {
      Tree tree;
      pcs::extract_tree_skeleton(points, tree, np);
      BOOST_TEST_REQUIRE(num_vertices(tree) == num_vertices(expected));
      for (std::size_t v = 0; v < num_vertices(tree); ++v)
        BOOST_REQUIRE(tree[v].point == expected[v].point && tree[v].radius == expected[v].radius);
    });
}

BOOST_AUTO_TEST_CASE(normals_of_the_input_are_used_if_there_are_any)
{
  const std::vector<Kernel::Point_3> points = noisy_tube();
  pcs::Slice_options rules;
  const Vec3 radial = Vec3::Zero(), wrong(0, 0, 1);
  BOOST_TEST(number_of_measured(points, rules, wrong) > 1u); // they are only written
  rules.has_normals = true;
  BOOST_TEST(number_of_measured(points, rules, radial) > 1u);
  BOOST_TEST(number_of_measured(points, rules, wrong) == 0u); // no curvature, no candidate
}

// The spanning tree is the result where no section is found [Aiteanu 2022, section 3.8].
BOOST_AUTO_TEST_CASE(a_scan_without_sections_is_a_spanning_tree)
{
  const auto np = pcs::parameters::skeleton_method(pcs::Skeleton_method::sections);
  std::vector<Kernel::Point_3> line, few;
  for (int i = 0; i < 60; ++i)
    line.emplace_back(0, 0, 0.02 * i);
  pcs::Tree_skeletonization stages(line, np);
  Tree tree;
  BOOST_CHECK_EQUAL(stages.extract(tree).status, pcs::Status::converged);
  BOOST_TEST(num_vertices(tree) > 10u);
  for (const auto& node : stages.branches().nodes)
    BOOST_TEST(!node.is_measured);
  // all points are in one level set
  for (const Vec3& p : tube(0.1, 0.1, 10))
    few.emplace_back(p.x(), p.y(), p.z());
  Tree other(3);
  BOOST_CHECK_EQUAL(pcs::extract_tree_skeleton(few, other, np).status, pcs::Status::nothing_to_do);
  BOOST_CHECK_EQUAL(num_vertices(other), 3u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_section_skeleton

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Voxel-center points are detected, and the radii of branches are corrected for them.

#include <pcs/core/Skeleton_report.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/skeleton/radii/correct_voxel_size.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/tree_clouds.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace test_correct_grid {

using namespace pcs::skeleton;
using pcs_test::append;
using pcs_test::cylinder;
using pcs_test::Tree;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using Cloud = std::vector<Point>;

namespace {

/// A leaning trunk with two limbs of half its radius, densely sampled.
Cloud small_tree(double radius)
{
  const Vector trunk(0.2, 0.1, 1);
  Cloud points = cylinder(60000, radius, 2, Point(0.3, 0.2, 0), trunk);
  const Point fork = Point(0.3, 0.2, 0) + 1.2 / std::sqrt(trunk.squared_length()) * trunk;
  append(points, cylinder(20000, radius / 2, 1, fork, Vector(1, 0.2, 0.5)));
  append(points, cylinder(20000, radius / 2, 1, fork, Vector(-0.7, 0.8, 0.6)));
  return points;
}

/// The centers of all voxels with points.
Cloud centers_of_voxels(const Cloud& points, double size)
{
  const auto center = [&](double x) { return size * (std::floor(x / size) + 0.5); };
  Cloud centers;
  for (const Point& p : points)
    centers.emplace_back(center(p.x()), center(p.y()), center(p.z()));
  std::sort(centers.begin(), centers.end());
  centers.erase(std::unique(centers.begin(), centers.end()), centers.end());
  return centers;
}

Cloud turned(const Cloud& points, double angle)
{
  const double c = std::cos(angle), s = std::sin(angle);
  Cloud result;
  for (const Point& p : points)
    result.emplace_back(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z());
  return result;
}

double step_of(const Cloud& points)
{
  std::vector<Vec3> input;
  for (const Point& p : points)
    input.emplace_back(p.x(), p.y(), p.z());
  Scan scan;
  prepare_scan<CGAL::Sequential_tag>(input, Vec3::UnitZ(), scan);
  return scan.frame.unit * voxel_size(scan, Voxel_size_options());
}

/// `count` points on each of many rings, one above the other.
Cloud rings(double radius, double height, double step)
{
  const double pi = CGAL_PI;
  const int count = static_cast<int>(2 * pi * radius / step);
  const double chord = 2 * radius * std::sin(pi / count); // equal to the distance of the rings
  Cloud points;
  for (double z = 0; z < height; z += chord)
    for (int k = 0; k < count; ++k)
      points.emplace_back(radius * std::cos(2 * pi * k / count),
                          radius * std::sin(2 * pi * k / count),
                          z);
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(voxel_size_correction)

BOOST_AUTO_TEST_CASE(centers_of_voxels_lie_on_a_grid_however_it_is_turned)
{
  for (const double size : {0.01, 0.02}) {
    const Cloud points = centers_of_voxels(small_tree(0.05), size);
    for (const double angle : {0.0, 0.3, 1.1})
      BOOST_CHECK_CLOSE(step_of(turned(points, angle)), size, 0.01);
  }
}

BOOST_AUTO_TEST_CASE(other_points_lie_on_no_grid)
{
  const Cloud points = small_tree(0.05);
  BOOST_CHECK_EQUAL(step_of(points), 0);
  BOOST_CHECK_EQUAL(step_of(rings(0.05, 1, 0.005)), 0);            // regular, but on the surface
  BOOST_CHECK_EQUAL(step_of(centers_of_voxels(points, 0.001)), 0); // finer than their spacing
  BOOST_CHECK_EQUAL(step_of(pcs_test::small_scan().scan.points), 0);
  BOOST_CHECK_EQUAL(step_of(Cloud(3, Point(1, 2, 3))), 0);
  Cloud line;
  for (int k = 0; k < 200; ++k)
    line.emplace_back(0, 0, k);
  BOOST_CHECK_EQUAL(step_of(line), 0); // one direction only
}

BOOST_AUTO_TEST_CASE(radii_are_smaller_by_what_voxels_add)
{
  Branch_tree tree;
  for (const double radius : {0.0, 0.2, 1.0, 10.0}) {
    Branch_node node;
    node.radius = std::sqrt(radius * radius + 0.3);
    node.major_radius = 1.25 * node.radius;
    node.minor_radius = 0.8 * node.radius;
    tree.nodes.push_back(node);
  }
  const Branch_tree found = tree;
  correct_voxel_size(0, Voxel_size_options(), tree);
  for (std::size_t k = 0; k < 4; ++k)
    BOOST_CHECK_EQUAL(tree.nodes[k].radius, found.nodes[k].radius);
  correct_voxel_size(1, Voxel_size_options(), tree);
  BOOST_CHECK_CLOSE(tree.nodes[2].radius, 1.0, 1e-9);
  BOOST_CHECK_CLOSE(tree.nodes[3].radius, 10.0, 1e-9);
  for (std::size_t k = 0; k < 2; ++k) // limited to a factor of 0.6
    BOOST_CHECK_CLOSE(tree.nodes[k].radius, 0.6 * found.nodes[k].radius, 1e-9);
  for (const Branch_node& node : tree.nodes)
    BOOST_CHECK_CLOSE(node.major_radius * node.minor_radius, node.radius * node.radius, 1e-9);
}

BOOST_AUTO_TEST_CASE(a_tree_of_voxels_has_the_volume_of_its_scan)
{
  const Cloud points = small_tree(0.04);
  Tree tree;
  const double volume = pcs::extract_tree_skeleton(points, tree).total.volume;
  for (const double size : {0.01, 0.02}) {
    const auto report = pcs::extract_tree_skeleton(centers_of_voxels(points, size), tree);
    BOOST_TEST_CONTEXT("voxels of " << size)
    {
      pcs_test::check_is_a_tree(tree);
      BOOST_CHECK_CLOSE(report.voxel_size, size, 0.01);
      BOOST_CHECK_LT(std::abs(report.total.volume / volume - 1), 0.03); // uncorrected: 14 % at 2 cm
      const auto sentences = pcs::warnings(report);
      BOOST_REQUIRE_EQUAL(sentences.size(), 1u);
      BOOST_CHECK_NE(sentences[0].find("voxel centers of size"), std::string::npos);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_correct_grid

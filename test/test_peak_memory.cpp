// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Memory of all algorithms per point, as the documentation states it.

#include <pcs/Point_set_deformation.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/orl_geodesic.h>
#include <pcs/registration/Point_set_fitting.h>
#include <support/allocations.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace test_peak_memory {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Tree = pcs::Tree_skeleton<Kernel>;

/// A pillar of height 10 and radius 1.
std::vector<Point> pillar(std::size_t n)
{
  std::vector<Point> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.39996 * double(i);
    points.emplace_back(std::cos(angle), std::sin(angle), 10 * double(i) / double(n));
  }
  return points;
}

std::vector<Point> scan_of(const Tree& tree, double degrees)
{
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = 3;
  scanner.angular_step = degrees * CGAL_PI / 180;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(3));
  return scan.points;
}

/// A trunk of radius 1.
Tree post(double height)
{
  Tree tree(3);
  for (std::size_t i = 0; i < 3; ++i) {
    tree[i].point = Point(0, 0, height * double(i) / 2);
    tree[i].radius = 1;
  }
  add_edge(0, 1, tree);
  add_edge(1, 2, tree);
  return tree;
}

Tree tree_of(std::uint64_t seed)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::broadleaf_habit(), pcs::parameters::random_seed(seed));
  return tree;
}

/// Bytes per point of a pillar whose points are all samples.
constexpr double most_without_sampling = 1600;

/// Returns the largest number of bytes per point that `work()` allocates at a time.
template <class Work>
double peak(std::size_t number_of_points, const Work& work)
{
  const long before = pcs_test::allocated_bytes;
  pcs_test::peak_of_bytes = before;
  work();
  const double bytes = double(pcs_test::peak_of_bytes - before) / double(number_of_points);
  BOOST_TEST_MESSAGE("peak: " << bytes << " bytes per point");
  return bytes;
}

} // namespace

// Sequential, since a thread scheduler allocates memory as well.
BOOST_AUTO_TEST_SUITE(peak_memory)

BOOST_AUTO_TEST_CASE(memory_of_a_deformation)
{
  constexpr std::size_t n = 200000;
  using Element = std::pair<Point, Kernel::Vector_3>;
  std::vector<Element> points;
  for (const Point& p : pillar(n))
    points.emplace_back(p, Kernel::Vector_3(p.x(), p.y(), 0));
  const std::vector<std::size_t> foot = {0, 1, 2, 3};
  const auto np = pcs::parameters::point_map(CGAL::First_of_pair_property_map<Element>())
                      .normal_map(CGAL::Second_of_pair_property_map<Element>());
  const long before = pcs_test::allocated_bytes;
  double kept = 0;
  const double most = peak(n, [&] {
    pcs::Point_set_deformation<std::vector<Element>, decltype(np), CGAL::Sequential_tag> session(
        points,
        np);
    kept = double(pcs_test::allocated_bytes - before) / double(n);
    session.add_handle(foot);
    session.deform();
  });
  BOOST_TEST_MESSAGE("kept: " << kept << " bytes per point");
  BOOST_TEST(kept < 175);
  BOOST_TEST(most < 325);
}

BOOST_AUTO_TEST_CASE(memory_of_a_deformation_without_sampling)
{
  constexpr std::size_t n = 100000;
  std::vector<Point> points = pillar(n);
  std::vector<std::size_t> foot, head;
  for (std::size_t i = 0; i < n / 20; ++i) {
    foot.push_back(i);
    head.push_back(n - 1 - i);
  }
  const double most = peak(n, [&] {
    const auto np = pcs::parameters::number_of_samples(n);
    pcs::Point_set_deformation<std::vector<Point>, decltype(np), CGAL::Sequential_tag> session(
        points,
        np);
    session.add_handle(foot);
    session.set_rotation(session.add_handle(head), Kernel::Vector_3(0, 0, 1), 0.5);
    session.deform();
  });
  BOOST_TEST(most < most_without_sampling);
}

BOOST_AUTO_TEST_CASE(memory_of_a_skeleton)
{
  const std::vector<Point> scan = scan_of(tree_of(1), 0.08);
  BOOST_TEST_REQUIRE(scan.size() > 100000u);
  BOOST_TEST(peak(scan.size(), [&] {
               Tree skeleton;
               pcs::extract_tree_skeleton<CGAL::Sequential_tag>(scan, skeleton);
             }) < 350);
}

BOOST_AUTO_TEST_CASE(memory_of_a_registration)
{
  const std::vector<Point> rest = pillar(50000);
  std::vector<Point> target;
  for (const Point& p : rest)
    target.emplace_back(p.x() + 0.01 * p.z() * p.z(), p.y(), p.z());
  BOOST_TEST(peak(rest.size(), [&] {
               std::vector<Point> points = rest;
               pcs::Point_set_fitting<std::vector<Point>,
                                      pcs::parameters::Default_named_parameters,
                                      CGAL::Sequential_tag>
                   session(points);
               session.fit(target);
             }) < 700);
}

// Trees of one branch, so that nearly all memory is that of points.
BOOST_AUTO_TEST_CASE(memory_of_a_geodesic)
{
  constexpr std::size_t n = 50000;
  const std::vector<Point> one = pillar(n);
  std::vector<Point> two;
  for (const Point& p : one)
    two.emplace_back(p.x(), p.y(), 1.2 * p.z());
  BOOST_TEST(
      peak(2 * n, [&] {
        Tree between;
        std::vector<Point> points;
        pcs::orl_geodesic<CGAL::Sequential_tag>(post(10), one, post(12), two, 0.5, between, points);
      }) < 120);
}

BOOST_AUTO_TEST_CASE(memory_of_a_matching)
{
  const Tree a = tree_of(1), b = tree_of(2);
  pcs::Orl_shape_space<Kernel, CGAL::Sequential_tag> space;
  pcs::Orl_report report;
  const double bytes = peak(1, [&] {
    space.add_skeleton(a);
    space.add_skeleton(b);
    report = space.build();
  });
  BOOST_TEST_MESSAGE(report.number_of_branches[0] << ", " << report.number_of_branches[1]
                                                  << " branches");
  BOOST_TEST(bytes < 80e6);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_peak_memory

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Merging of points of dense scans: the number of points does not grow with the density, the radius
// is preserved, and every input point keeps its position and label.

#include <pcs/skeleton/scan/prepare_scan.h>
#include <pcs/skeleton/scan/thin_dense_points.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace test_thin_dense_points {

using namespace pcs::skeleton;

namespace {

constexpr double noise = 0.002, radius = 0.1;

/// `n` points of an upright cylinder of height 1 with noise along its normals.
std::vector<Vec3> cylinder(std::size_t n)
{
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, noise);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = 6.283185307179586 * uniform(random), r = radius + normal(random);
    points.emplace_back(r * std::cos(a), r * std::sin(a), uniform(random));
  }
  return points;
}

bool thin(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& is_wood, Scan& scan)
{
  take_points<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
  return thin_dense_points<CGAL::Sequential_tag>(is_wood, Thinning_options(), scan);
}

/// Mean distance of the points of the scan from the axis of the cylinder, without sparse cells.
double mean_radius(const Scan& scan)
{
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < scan.size(); ++k)
    if (!scan.is_sparse[k]) {
      const Vec3 p = scan.frame.to_input(scan.points[k]);
      sum += std::hypot(p.x(), p.y());
      ++count;
    }
  return sum / count;
}

} // namespace

BOOST_AUTO_TEST_SUITE(dense_points)

// The spacing is 0.8 and 0.4 times the noise.
BOOST_AUTO_TEST_CASE(denser_scans_have_the_same_points_and_the_same_radius)
{
  Scan dense, denser;
  BOOST_REQUIRE(thin(cylinder(200000), {}, dense));
  BOOST_REQUIRE(thin(cylinder(800000), {}, denser));
  BOOST_CHECK_CLOSE(dense.cell_side * dense.frame.unit, 3.6 * noise, 15);
  BOOST_TEST(2 * denser.size() < 3 * dense.size());
  BOOST_TEST(std::abs(mean_radius(dense) - radius) < 0.1 * noise);
  BOOST_TEST(std::abs(mean_radius(denser) - radius) < 0.1 * noise);
}

BOOST_AUTO_TEST_CASE(coarse_scans_are_not_thinned)
{
  Scan scan;
  BOOST_TEST(!thin(cylinder(4000), {}, scan)); // spacing of six times the noise
  BOOST_TEST(scan.size() == 4000u);
  BOOST_TEST(scan.cell_side == 0);
}

// A coarse scan twice, the second time with different rounding.
BOOST_AUTO_TEST_CASE(copies_do_not_make_a_scan_dense)
{
  std::vector<Vec3> points = cylinder(4000);
  for (std::size_t i = 0; i < 4000; ++i)
    points.push_back(points[i] + Vec3::Constant(1e-6));
  Scan scan;
  BOOST_TEST(!thin(points, {}, scan));
}

BOOST_AUTO_TEST_CASE(every_input_point_keeps_its_position_and_label)
{
  const std::vector<Vec3> points = cylinder(200000);
  std::vector<std::uint8_t> is_wood;
  for (const Vec3& p : points)
    is_wood.push_back(p.x() > 0.03);
  Scan scan;
  BOOST_REQUIRE(thin(points, is_wood, scan));
  std::vector<int> label(scan.size(), -1);
  std::size_t differ = 0, moved = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    int& merged = label[scan.point_of_input[i]];
    differ += merged >= 0 && merged != is_wood[i];
    merged = is_wood[i];
    moved += (scan.frame.to_input(scan.position_of_input(i)) - points[i]).norm() > 1e-6;
    // A cell is merged at most with the fullest of its neighbours, and this one with its own.
    moved += (scan.position_of_input(i) - scan.points[scan.point_of_input[i]]).norm() >
             6 * scan.cell_side;
  }
  BOOST_TEST(differ == 0u);
  BOOST_TEST(moved == 0u);
}

// A single point within a dense cloud is not wood, and is kept as an outlier.
BOOST_AUTO_TEST_CASE(single_points_beside_dense_wood_are_outliers)
{
  std::vector<Vec3> points = cylinder(200000);
  points.emplace_back(0, 0, 0.5);
  Scan scan;
  BOOST_REQUIRE(thin(points, {}, scan));
  measure_points<CGAL::Sequential_tag>(scan);
  BOOST_TEST(scan.is_outlier[scan.point_of_input.back()] == 1);
  const auto outliers = std::count(scan.is_outlier.begin(), scan.is_outlier.end(), 1);
  BOOST_TEST(100 * static_cast<std::size_t>(outliers) < scan.size());
}

BOOST_AUTO_TEST_CASE(the_order_of_the_points_does_not_matter)
{
  std::vector<Vec3> points = cylinder(100000);
  Scan forward, backward;
  BOOST_REQUIRE(thin(points, {}, forward));
  std::reverse(points.begin(), points.end());
  BOOST_REQUIRE(thin(points, {}, backward));
  BOOST_TEST((forward.points == backward.points));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_thin_dense_points

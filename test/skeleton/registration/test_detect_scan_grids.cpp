// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stations are located from their angular beam grids, and only if grids exist.

#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/internal/fast_atan2.h>
#include <pcs/skeleton/registration/detect_scan_grids.h>
#include <pcs/skeleton/scan/find_scan_frame.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/tree_clouds.h>

#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace test_beam_grids {

using namespace pcs::skeleton;
using pcs_test::Tree;
using Kernel = pcs_test::Tree_kernel;
using Tag = CGAL::Sequential_tag;

namespace {

struct Found
{
  Scan_frame frame;
  std::vector<Vec3> places;
  std::vector<Scan_grid> grids;

  explicit Found(const std::vector<Vec3>& points)
    : frame(find_scan_frame<Tag>(points, Vec3::UnitZ())),
      places(pcs::skeleton::internal::distinct_places<Tag>(points, frame).places),
      grids(detect_scan_grids<Tag>(places, Scan_grid_options()))
  {
  }

  /// Distance of the station from the nearest detected one [m].
  double away(const Vec3& station) const
  {
    double best = std::numeric_limits<double>::infinity();
    for (const Scan_grid& grid : grids)
      best = std::min(best, (frame.to_input(grid.position) - station).norm());
    return best;
  }
};

Vec3 vec3(const Kernel::Point_3& p)
{
  return Vec3(p.x(), p.y(), p.z());
}

std::vector<Vec3> positions(const pcs::Virtual_scan<Kernel>& scan)
{
  std::vector<Vec3> points;
  for (const Kernel::Point_3& p : scan.points)
    points.push_back(vec3(p));
  return points;
}

pcs::Virtual_scan<Kernel> scan_from(std::size_t number_of_stations, double step)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(5));
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = number_of_stations;
  scanner.angular_step = step;
  scanner.registration_error = 0;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(6));
  return scan;
}

constexpr double degree = CGAL_PI / 180;

} // namespace

BOOST_AUTO_TEST_SUITE(scan_grids)

BOOST_AUTO_TEST_CASE(quick_angles_are_those_of_the_c_library)
{
  double worst = 0;
  for (const double size : {1e-200, 1e-3, 1.0, 1e200})
    for (int k = -2000; k <= 2000; ++k) {
      const double angle = 3.14159265358979323846 * k / 2000;
      const double y = size * std::sin(angle), x = size * std::cos(angle);
      worst = std::max(worst, std::abs(pcs::skeleton::fast_atan2(y, x) - std::atan2(y, x)));
    }
  BOOST_TEST(worst < 1e-11);
  BOOST_TEST(pcs::skeleton::fast_atan2(0, 0) == 0);
}

BOOST_AUTO_TEST_CASE(stations_are_found_where_they_stood)
{
  for (const std::size_t number : {2u, 4u}) {
    const auto scan = scan_from(number, 0.1 * degree);
    const Found found(positions(scan));
    BOOST_REQUIRE_EQUAL(found.grids.size(), number);
    for (const Kernel::Point_3& station : scan.stations)
      BOOST_CHECK_LT(found.away(vec3(station)), 0.03);
    for (const Scan_grid& grid : found.grids) {
      BOOST_CHECK_CLOSE(grid.rate[0], 1 / (0.1 * degree), 0.1);
      BOOST_CHECK_CLOSE(grid.rate[1], 1 / (0.1 * degree), 0.1);
    }
  }
}

BOOST_AUTO_TEST_CASE(nearly_all_points_are_on_the_grid_of_their_own_station)
{
  const auto scan = scan_from(3, 0.1 * degree);
  const Found found(positions(scan));
  BOOST_REQUIRE_EQUAL(found.grids.size(), 3u);
  std::size_t right = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Vec3 p = found.frame.to_local(vec3(scan.points[i]));
    const auto misfit = [&](const Scan_grid& a, const Scan_grid& b) {
      return a.misfit(p) < b.misfit(p);
    };
    const Scan_grid& grid = *std::min_element(found.grids.begin(), found.grids.end(), misfit);
    const Vec3 station = vec3(scan.stations[std::size_t(scan.station[i])]);
    right += grid.misfit(p) < grid.tolerance &&
             (found.frame.to_input(grid.position) - station).norm() < 0.5;
  }
  BOOST_CHECK_GT(double(right), 0.99 * double(scan.points.size()));
}

BOOST_AUTO_TEST_CASE(a_scanner_may_be_tilted)
{
  const auto scan = scan_from(1, 0.1 * degree);
  const Vec3 station = vec3(scan.stations.front());
  const double tilt = 1.5 * degree;
  const Eigen::AngleAxisd turn(tilt, Vec3(0.6, 0.8, 0));
  std::vector<Vec3> points;
  for (const Vec3& p : positions(scan))
    points.push_back(station + turn * (p - station));
  const Found found(points);
  BOOST_REQUIRE_EQUAL(found.grids.size(), 1u);
  BOOST_CHECK_LT(found.away(station), 0.05);
  const Vec3 vertical = found.frame.direction_to_input(found.grids.front().axes.row(2).transpose());
  BOOST_CHECK_SMALL((vertical - turn * Vec3::UnitZ()).norm(), 0.1 * tilt);
}

BOOST_AUTO_TEST_CASE(thinned_and_rounded_scans_keep_their_grids)
{
  const auto scan = scan_from(2, 0.06 * degree);
  std::vector<Vec3> points;
  std::mt19937 random(1);
  for (const Vec3& p : positions(scan))
    if (random() % 3 == 0) {
      const Vec3 q = 2000 * p; // in half millimetres
      points.push_back(Vec3(std::round(q.x()), std::round(q.y()), std::round(q.z())) / 2000);
    }
  BOOST_CHECK_EQUAL(Found(points).grids.size(), 2u);
}

BOOST_AUTO_TEST_CASE(other_clouds_have_no_stations)
{
  pcs_test::Jitter jitter(0.002);
  std::vector<Vec3> stem, jittered, voxels, few;
  for (const auto& p : jitter(pcs_test::cylinder(20000, 0.1, 3)))
    stem.push_back(vec3(p));
  pcs_test::Jitter wide(0.02); // in all directions: no beam grid remains
  for (const auto& p : wide(scan_from(4, 0.1 * degree).points))
    jittered.push_back(vec3(p));
  for (const Vec3& p : stem)
    voxels.push_back(
        0.01 * Vec3(std::floor(100 * p.x()), std::floor(100 * p.y()), std::floor(100 * p.z())));
  few.assign(stem.begin(), stem.begin() + 500);
  BOOST_CHECK(Found(stem).grids.empty());
  BOOST_CHECK(Found(jittered).grids.empty());
  BOOST_CHECK_LT(Found(voxels).grids.size(), 2u);
  BOOST_CHECK(Found(few).grids.empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_beam_grids

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the statistics of the virtual scanner against its documentation.

#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_fixtures.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_scan_statistics {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Scan = pcs::Virtual_scan<Kernel>;
using Point_3 = Kernel::Point_3;
namespace np = pcs::parameters;

namespace {

/// A scanner without errors; tests set single errors.
pcs::Virtual_scanner perfect()
{
  pcs::Virtual_scanner s;
  s.angular_step = 0.001;
  s.distance_spread = 0;
  s.beam_width = s.range_noise = s.registration_error = s.outlier_share = s.bark_depth = 0;
  return s;
}

Eigen::Vector3d vector(const Point_3& p)
{
  return {p.x(), p.y(), p.z()};
}

struct Moments
{
  double mean = 0, deviation = 0;
  std::size_t n = 0;
};

/// Moments of the distance from the z-axis minus `radius`.
Moments radial_error(const Scan& scan, double radius, double top)
{
  Moments m;
  double square = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Point_3& p = scan.points[i];
    if (scan.node[i] < 0 || p.z() < 0.05 || p.z() > top - 0.05)
      continue;
    const double error = std::hypot(p.x(), p.y()) - radius;
    m.mean += error;
    square += error * error;
    ++m.n;
  }
  m.mean /= double(m.n);
  m.deviation = std::sqrt(square / double(m.n) - m.mean * m.mean);
  return m;
}

std::size_t number_of_hidden_branches(const Tree& tree, const Scan& scan)
{
  std::size_t hidden = 0;
  for (const auto& nodes : pcs::nodes_by_branch(tree))
    hidden +=
        std::all_of(nodes.begin(), nodes.end(), [&](std::size_t v) { return scan.hits[v] == 0; })
            ? 1
            : 0;
  return hidden;
}

} // namespace

BOOST_AUTO_TEST_SUITE(scan_statistics)

BOOST_AUTO_TEST_CASE(noise_on_the_trunk_is_as_specified_and_the_radius_has_no_bias)
{
  const Tree trunk = pcs::make_cylinder_tree<Kernel>(3, 0.2);
  pcs::Virtual_scanner scanner = perfect();
  Scan scan;
  pcs::scan_tree(trunk, scan, scanner);
  const Moments exact = radial_error(scan, 0.2, 3);
  BOOST_TEST(exact.n > 20000u);
  BOOST_TEST(std::abs(exact.mean) < 0.2 * 2e-4);

  scanner.range_noise = 0.003;
  pcs::scan_tree(trunk, scan, scanner, np::random_seed(5));
  const Moments noisy = radial_error(scan, 0.2, 3);
  // Across the stem, the cosine of the angle of incidence is 1 - s^2 with s uniform in [0, 1],
  // whose mean square is 2/3. At 10 m the noise is 1.2 times as large. Displacement along the
  // surface adds (noise sin)^2 / 2r outwards.
  const double sigma = 0.003 * (1 + 9.8 / 50);
  BOOST_TEST(noisy.deviation == sigma * std::sqrt(2.0 / 3), boost::test_tools::tolerance(0.03));
  const double expected = sigma * sigma / 3 / (2 * 0.2);
  BOOST_TEST(std::abs(noisy.mean - expected) <
             4 * noisy.deviation / std::sqrt(double(noisy.n)) + 0.2 * 2e-4);
}

BOOST_AUTO_TEST_CASE(bark_changes_the_surface_and_not_the_mean_radius)
{
  const Tree trunk = pcs::make_cylinder_tree<Kernel>(3, 0.2);
  pcs::Virtual_scanner scanner = perfect();
  scanner.number_of_stations = 8;
  scanner.bark_depth = 0.004;
  Scan scan;
  pcs::scan_tree(trunk, scan, scanner);
  const Moments bark = radial_error(scan, 0.2, 3);
  // Three sines of a third of the depth each; bumps occlude some of the hollows.
  BOOST_TEST(bark.deviation > 0.0012);
  BOOST_TEST(bark.deviation < 0.0018);
  BOOST_TEST(std::abs(bark.mean) < 0.0004);
}

BOOST_AUTO_TEST_CASE(stations_are_shifted_by_the_error_of_registration)
{
  const Tree trunk = pcs::make_cylinder_tree<Kernel>(2, 0.2);
  pcs::Virtual_scanner scanner = perfect();
  scanner.number_of_stations = 40;
  scanner.angular_step = 0.004;
  Scan exact, shifted;
  pcs::scan_tree(trunk, exact, scanner);
  scanner.registration_error = 0.005;
  pcs::scan_tree(trunk, shifted, scanner);
  BOOST_TEST_REQUIRE(exact.points.size() == shifted.points.size());
  std::vector<Eigen::Vector3d> shift(40, Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    const Eigen::Vector3d d = vector(shifted.points[i]) - vector(exact.points[i]);
    Eigen::Vector3d& of_station = shift[std::size_t(exact.station[i])];
    if (!of_station.isZero(0))
      BOOST_TEST((d - of_station).norm() < 1e-12); // one shift for each station
    of_station = d;
  }
  double square = 0;
  for (const auto& s : shift)
    square += s.squaredNorm();
  BOOST_TEST(std::sqrt(square / 120) == 0.005, boost::test_tools::tolerance(0.3));
}

BOOST_AUTO_TEST_CASE(the_share_of_outliers_is_exact_and_they_fill_the_box)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit());
  pcs::Virtual_scanner scanner = perfect();
  scanner.outlier_share = 0.01;
  Scan scan;
  const auto report = pcs::scan_tree(tree, scan, scanner);
  BOOST_TEST(report.number_of_ghosts == 0u); // beams have no width
  BOOST_TEST(double(report.number_of_outliers) ==
             std::round(0.01 * double(report.number_of_wood_points)));
  double low = 1e9, high = -1e9, mean = 0;
  for (const Point_3& p : scan.points) {
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (scan.node[i] == pcs::scan_label_ghost)
      mean += scan.points[i].z() / double(report.number_of_outliers);
  const double deviation = (high - low) / std::sqrt(12.0 * double(report.number_of_outliers));
  BOOST_TEST(std::abs(mean - (low + high) / 2) < 4 * deviation);
}

BOOST_AUTO_TEST_CASE(density_falls_with_the_square_of_the_distance)
{
  const Tree trunk = pcs::make_cylinder_tree<Kernel>(1, 0.1);
  std::size_t n[2];
  for (const int i : {0, 1}) {
    pcs::Virtual_scanner scanner = perfect();
    scanner.positions = {{i == 0 ? 5.0 : 10.0, 0, 0.5}};
    Scan scan;
    pcs::scan_tree(trunk, scan, scanner);
    n[i] = scan.points.size();
  }
  // Width and height in beams at 5 m: 0.2 / 5 / 0.001 and 1 / 5 / 0.001.
  BOOST_TEST(double(n[0]) == 40.0 * 200, boost::test_tools::tolerance(0.03));
  BOOST_TEST(double(n[0]) / double(n[1]) == 4, boost::test_tools::tolerance(0.04));
}

BOOST_AUTO_TEST_CASE(no_point_lies_behind_a_nearer_surface)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit());
  pcs::Virtual_scanner scanner = perfect();
  scanner.angular_step = 0.004;
  Scan scan;
  pcs::scan_tree(tree, scan, scanner);
  BOOST_TEST(scan.points.size() > 1000u);
  std::size_t behind = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d p = vector(scan.points[i]);
    const Eigen::Vector3d o = vector(scan.stations[std::size_t(scan.station[i])]);
    const Eigen::Vector3d ray = p - o;
    const double length = ray.norm();
    for (std::size_t v = 1; v < num_vertices(tree); ++v) {
      // The point of the ray nearest to the middle of an edge, and the point of the edge nearest to
      // it. A core of half the radius is certainly inside the wood.
      const std::size_t parent = pcs::parent_node(v, tree);
      const Eigen::Vector3d a = vector(tree[parent].point), b = vector(tree[v].point);
      const Eigen::Vector3d middle = 0.5 * (a + b);
      const double t = (middle - o).dot(ray) / ray.squaredNorm();
      const double core = 0.5 * tree[v].minor_radius;
      const bool is_before = t > 0 && t * length < length - 3 * tree[parent].radius;
      if (is_before && (o + t * ray - middle).norm() < core)
        ++behind;
    }
  }
  BOOST_TEST(behind == 0u);
}

BOOST_AUTO_TEST_CASE(a_nearer_stem_casts_a_shadow)
{
  const Tree trunk = pcs::make_cylinder_tree<Kernel>(2, 0.1);
  pcs::Virtual_scanner scanner = perfect();
  scanner.positions = {{8, 0, 1}};
  scanner.posts = {{4, 0, 0.1, 5}}; // half the distance, so twice the apparent width of the trunk
  Scan scan;
  const auto report = pcs::scan_tree(trunk, scan, scanner);
  BOOST_TEST(report.number_of_wood_points == 0u);
  BOOST_TEST(report.number_of_post_points > 1000u);
}

BOOST_AUTO_TEST_CASE(fewer_stations_hide_more_branches)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::broadleaf_habit());
  std::size_t last = tree[boost::graph_bundle].branches.size(), last_nodes = num_vertices(tree);
  for (const std::size_t n : {1u, 2u, 4u, 8u}) {
    pcs::Virtual_scanner scanner;
    scanner.number_of_stations = n;
    scanner.angular_step = 0.0025;
    Scan scan;
    const auto report = pcs::scan_tree(tree, scan, scanner);
    BOOST_TEST(report.number_of_hidden_nodes < last_nodes, n << " stations");
    if (n <= 4) // few branches are hidden from 8 stations, and their number is random
      BOOST_TEST(number_of_hidden_branches(tree, scan) < last, n << " stations");
    last = number_of_hidden_branches(tree, scan);
    last_nodes = report.number_of_hidden_nodes;
  }
}

BOOST_AUTO_TEST_CASE(wide_beams_thicken_twigs_and_make_ghosts)
{
  const Tree twig = pcs::make_cylinder_tree<Kernel>(2, 0.004);
  double radius[2];
  for (const int is_wide : {0, 1}) {
    pcs::Virtual_scanner scanner = perfect();
    scanner.number_of_stations = 8;
    scanner.angular_step = 0.0001; // many beams on a width of 8 mm
    scanner.beam_width = is_wide == 1 ? 0.0006 : 0;
    Scan scan;
    pcs::scan_tree(twig, scan, scanner);
    radius[is_wide] = radial_error(scan, 0, 2).mean;
  }
  BOOST_TEST(radius[0] == 0.004, boost::test_tools::tolerance(0.02));
  // Rays beside the middle are w = 3 mm |cos(roll)| off, at 10 m. A beam whose middle passes the
  // axis at the distance y, r < y < r + w, gives a point with the probability 1/2. Its distance is
  // sqrt(y^2 + r^2 - (y - w)^2), which is 4.36 mm on average over y and roll.
  BOOST_TEST(radius[1] == 0.00436, boost::test_tools::tolerance(0.01));

  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit());
  pcs::Virtual_scanner scanner = perfect();
  scanner.beam_width = 0.0004;
  Scan scan;
  scanner.ghost_share = 1;
  const auto all = pcs::scan_tree(tree, scan, scanner);
  scanner.ghost_share = 0.25;
  const auto some = pcs::scan_tree(tree, scan, scanner);
  BOOST_TEST(all.number_of_ghosts > 500u);
  BOOST_TEST(double(some.number_of_ghosts) / double(all.number_of_ghosts) == 0.25,
             boost::test_tools::tolerance(0.25));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_scan_statistics

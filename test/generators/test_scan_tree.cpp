// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the virtual scanner: determinism, laws, parameters, surroundings.

#include <pcs/core/errors.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_fixtures.h>
#include <support/exceptions.h>
#include <support/threads.h>
#include <support/trees.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace test_scan_tree {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Scan = pcs::Virtual_scan<Kernel>;
using Point_3 = Kernel::Point_3;
using Vector_3 = Kernel::Vector_3;
namespace np = pcs::parameters;

namespace {

Tree fruit_tree()
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), np::random_seed(3));
  return tree;
}

pcs::Virtual_scanner coarse()
{
  pcs::Virtual_scanner s;
  s.angular_step = 0.004;
  s.distance = 6;
  return s;
}

template <class Tag = CGAL::Parallel_if_available_tag>
Scan scanned(const Tree& tree, const pcs::Virtual_scanner& scanner, int seed = 1)
{
  Scan scan;
  pcs::scan_tree<Tag>(tree, scan, scanner, np::random_seed(seed));
  return scan;
}

bool are_equal(const Scan& a, const Scan& b)
{
  return a.points == b.points && a.node == b.node && a.station == b.station && a.hits == b.hits &&
         a.stations == b.stations;
}

std::size_t count(const Scan& scan, int label)
{
  return std::size_t(std::count(scan.node.begin(), scan.node.end(), label));
}

} // namespace

BOOST_AUTO_TEST_SUITE(scan_tree)

BOOST_AUTO_TEST_CASE(a_seed_gives_the_same_bits_on_any_number_of_threads)
{
  const Tree tree = fruit_tree();
  pcs::Virtual_scanner scanner = coarse();
  scanner.wind = 0.02;
  scanner.leaves_per_length = 5;
  scanner.ground_radius = 2;
  scanner.voxel_size = 0.01;
  const Scan expected = scanned<CGAL::Sequential_tag>(tree, scanner);
  BOOST_TEST(expected.points.size() > 3000u);
  for (const int n : pcs_test::thread_counts)
    pcs_test::with_threads(n, [&] {
      BOOST_TEST(are_equal(scanned(tree, scanner), expected), n << " threads");
    });
  BOOST_TEST(!are_equal(scanned(tree, scanner, 2), expected));
}

BOOST_AUTO_TEST_CASE(labels_and_hits_agree)
{
  const Tree tree = fruit_tree();
  Scan scan;
  const auto report = pcs::scan_tree(tree, scan, coarse());
  BOOST_TEST(report.status == pcs::Status::converged);
  BOOST_TEST(report.number_of_points == scan.points.size());
  BOOST_TEST(scan.node.size() == scan.points.size());
  BOOST_TEST(scan.station.size() == scan.points.size());
  BOOST_TEST(scan.stations.size() == 4u);
  std::vector<std::size_t> hits(num_vertices(tree), 0);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    BOOST_TEST_REQUIRE(scan.node[i] < int(num_vertices(tree)));
    if (scan.node[i] >= 0)
      ++hits[std::size_t(scan.node[i])];
    BOOST_TEST((scan.station[i] >= 0 && scan.station[i] < 4));
  }
  BOOST_TEST(hits == scan.hits);
  BOOST_TEST(report.number_of_wood_points + report.number_of_ghosts + report.number_of_outliers ==
             report.number_of_points);
  BOOST_TEST(report.number_of_hidden_nodes ==
             std::size_t(std::count(hits.begin(), hits.end(), 0u)));
}

BOOST_AUTO_TEST_CASE(a_point_lies_on_the_node_of_its_label)
{
  const Tree tree = fruit_tree();
  pcs::Virtual_scanner scanner = coarse();
  scanner.range_noise = scanner.registration_error = scanner.beam_width = 0;
  const Scan scan = scanned(tree, scanner);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.node[i] < 0)
      continue;
    const auto& node = tree[std::size_t(scan.node[i])];
    // Half a step along the branch, and its thickness.
    const double reach = std::hypot(0.5 * 0.07, 1.3 * node.major_radius) + 0.01;
    BOOST_TEST(std::sqrt(CGAL::squared_distance(scan.points[i], node.point)) < reach);
  }
}

BOOST_AUTO_TEST_CASE(in_another_unit_the_scan_is_the_same)
{
  Tree tree = fruit_tree(), large;
  pcs::grow_tree(large, pcs::fruit_habit().scaled(1024), np::random_seed(3));
  const Scan a = scanned(tree, coarse());
  const Scan b = scanned(large, coarse().scaled(1024));
  BOOST_TEST_REQUIRE(a.points.size() == b.points.size());
  BOOST_TEST(a.node == b.node);
  for (std::size_t i = 0; i < a.points.size(); ++i)
    BOOST_TEST(b.points[i].x() == 1024 * a.points[i].x());
}

BOOST_AUTO_TEST_CASE(far_from_the_origin_the_scan_is_the_same)
{
  const Tree tree = fruit_tree();
  Tree far = tree;
  const Vector_3 shift(487000, 5320000, 300);
  for (std::size_t v = 0; v < num_vertices(far); ++v)
    far[v].point = far[v].point + shift;
  const Scan a = scanned(tree, coarse());
  const Scan b = scanned(far, coarse());
  // Coordinates of the far tree are rounded to 1e-9. One ray in thousands may miss an edge by that.
  const double n = double(a.points.size());
  BOOST_TEST(std::abs(double(b.points.size()) - n) < 0.002 * n);
  BOOST_TEST(double(b.hits[0]) == double(a.hits[0]), boost::test_tools::tolerance(0.05));
  const Vector_3 d = b.stations[2] - a.stations[2] - shift;
  BOOST_TEST(d.squared_length() < 1e-16);
}

BOOST_AUTO_TEST_CASE(stations_stand_where_they_were_asked_to)
{
  const Tree tree = fruit_tree();
  pcs::Virtual_scanner scanner = coarse();
  scanner.number_of_stations = 3;
  scanner.azimuth_range = 1.0; // one-sided
  scanner.first_azimuth = 0.5;
  Scan scan = scanned(tree, scanner);
  for (const Point_3& s : scan.stations) {
    const double azimuth = std::atan2(s.y(), s.x());
    BOOST_TEST((azimuth > 0.5 && azimuth < 1.5));
    BOOST_TEST(std::hypot(s.x(), s.y()) == 6, boost::test_tools::tolerance(0.151));
    BOOST_TEST(s.z() == 1.6);
  }
  // The rear side of the trunk is not visible from any station.
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (scan.node[i] >= 0 && tree[std::size_t(scan.node[i])].branch == 0) {
      const Vector_3 out = scan.points[i] - tree[std::size_t(scan.node[i])].point;
      BOOST_TEST(out.x() * std::cos(1.0) + out.y() * std::sin(1.0) > -0.05);
    }

  scanner.positions = {{5, 0, 1}, {0, 7, 2}};
  scan = scanned(tree, scanner);
  BOOST_TEST_REQUIRE(scan.stations.size() == 2u);
  BOOST_TEST((scan.stations[1] == Point_3(0, 7, 2)));
}

BOOST_AUTO_TEST_CASE(ground_leaves_and_posts_are_labelled)
{
  const Tree tree = fruit_tree();
  pcs::Virtual_scanner scanner = coarse();
  scanner.outlier_share = scanner.range_noise = scanner.registration_error = 0;
  scanner.beam_width = 0;
  scanner.ground_radius = 3;
  scanner.leaves_per_length = 10;
  scanner.posts = {{1.5, 1.0, 0.05, 3}};
  Scan scan;
  const auto report = pcs::scan_tree(tree, scan, scanner);
  BOOST_TEST(count(scan, pcs::scan_label_ground) == report.number_of_ground_points);
  BOOST_TEST(report.number_of_ground_points > 500u);
  BOOST_TEST(report.number_of_leaf_points > 500u);
  BOOST_TEST(report.number_of_post_points > 100u);
  BOOST_TEST(report.number_of_ghosts == 0u);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Point_3& p = scan.points[i];
    if (scan.node[i] == pcs::scan_label_post)
      BOOST_TEST(std::hypot(p.x() - 1.5, p.y() - 1) < 0.0505);
    if (scan.node[i] == pcs::scan_label_ground) {
      BOOST_TEST(std::hypot(p.x(), p.y()) < 3.001);
      BOOST_TEST(std::abs(p.z()) < 0.0401);
    }
  }
  for (const double number : {1e18, 1e308})
    BOOST_CHECK_EXCEPTION((scanner.leaves_per_length = number, scanned(tree, scanner)),
                          pcs::Invalid_input,
                          pcs_test::message_has("more than 1e7 leaves"));
  // Leaves occlude wood.
  scanner.leaves_per_length = 0;
  Scan bare;
  BOOST_TEST(pcs::scan_tree(tree, bare, scanner).number_of_wood_points >
             report.number_of_wood_points);
}

BOOST_AUTO_TEST_CASE(wind_moves_twigs_and_leaves_the_trunk)
{
  const Tree tree = fruit_tree();
  pcs::Virtual_scanner scanner = coarse();
  scanner.range_noise = scanner.registration_error = scanner.beam_width = 0;
  scanner.outlier_share = scanner.bark_depth = 0;
  const auto& branches = tree[boost::graph_bundle].branches;
  double trunk[2], twigs[2];
  for (const int is_windy : {0, 1}) {
    scanner.wind = 0.03 * is_windy;
    const Scan scan = scanned(tree, scanner);
    trunk[is_windy] = twigs[is_windy] = 0;
    for (std::size_t i = 0; i < scan.points.size(); ++i)
      if (scan.node[i] >= 0) {
        const auto& node = tree[std::size_t(scan.node[i])];
        const double d = std::sqrt(CGAL::squared_distance(scan.points[i], node.point));
        double& largest = branches[node.branch].order >= 2 ? twigs[is_windy] : trunk[is_windy];
        if (branches[node.branch].order != 1)
          largest = std::max(largest, d - node.radius);
      }
  }
  BOOST_TEST(twigs[1] > twigs[0] + 0.01);
  BOOST_TEST(trunk[1] < trunk[0] + 0.01);
}

BOOST_AUTO_TEST_CASE(thinning_leaves_one_point_in_a_cube)
{
  const Tree tree = fruit_tree();
  pcs::Virtual_scanner scanner = coarse();
  scanner.voxel_size = 0.05;
  Scan scan;
  const auto report = pcs::scan_tree(tree, scan, scanner);
  std::set<std::tuple<double, double, double>> cells;
  for (const Point_3& p : scan.points)
    cells.emplace(std::floor(p.x() / 0.05), std::floor(p.y() / 0.05), std::floor(p.z() / 0.05));
  BOOST_TEST(cells.size() == scan.points.size());
  BOOST_TEST(report.number_of_thinned_points + report.number_of_points ==
             scanned(tree, coarse(), 0).points.size());
}

BOOST_AUTO_TEST_CASE(progress_rises_to_one_and_cancelling_leaves_the_scan_alone)
{
  const Tree tree = fruit_tree();
  Scan scan;
  std::vector<double> values;
  pcs::scan_tree(tree, scan, coarse(), np::callback([&](double x) {
                   values.push_back(x);
                   return true;
                 }));
  BOOST_TEST(values.size() > 8u);
  BOOST_TEST(std::is_sorted(values.begin(), values.end()));
  BOOST_TEST(values.back() == 1);
  const Scan before = scan;
  const auto report =
      pcs::scan_tree(tree, scan, coarse(), np::random_seed(9).callback([](double x) {
        return x < 0.4;
      }));
  BOOST_TEST(report.status == pcs::Status::cancelled);
  BOOST_TEST(are_equal(scan, before));
}

BOOST_AUTO_TEST_CASE(any_kernel_will_do)
{
  using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto a = pcs::make_cylinder_tree<pcs_test::Kernel_archetype>(2, 0.2);
  const auto b = pcs::make_cylinder_tree<Exact>(2, 0.2);
  pcs::Virtual_scan<pcs_test::Kernel_archetype> scan_a;
  pcs::Virtual_scan<Exact> scan_b;
  pcs::scan_tree(a, scan_a, coarse());
  pcs::scan_tree(b, scan_b, coarse());
  BOOST_TEST(scan_a.node == scan_b.node);
}

BOOST_AUTO_TEST_CASE(a_tree_without_nodes_at_the_joints_is_whole)
{
  // The branch begins 0.6 away from its parent node. A point half way has the label of the first
  // node of the branch.
  const Tree tree = pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.1},
                                                 {0, 0, 0, 0, 1, 0.1},
                                                 {1, 0, 0, 0, 2, 0.1},
                                                 {1, 1, 0.6, 0, 1, 0.05},
                                                 {3, 1, 1.2, 0, 1, 0.05}});
  pcs::Virtual_scanner scanner = coarse();
  scanner.outlier_share = 0;
  const Scan scan = scanned(tree, scanner);
  std::size_t between = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const bool is_between = scan.points[i].x() > 0.2 && scan.points[i].x() < 0.5;
    between += is_between ? 1 : 0;
    if (is_between && scan.node[i] >= 0)
      BOOST_TEST(scan.node[i] == 3);
  }
  BOOST_TEST(between > 20u);
}

BOOST_AUTO_TEST_CASE(bad_trees_are_refused)
{
  Scan scan;
  BOOST_CHECK_THROW(pcs::scan_tree(Tree(), scan), pcs::Invalid_input);
  Tree tree = pcs_test::make_small_tree<Kernel>();
  tree[4].point = Point_3(0, std::numeric_limits<double>::infinity(), 0);
  BOOST_CHECK_THROW(pcs::scan_tree(tree, scan), pcs::Invalid_input);
  tree = pcs_test::make_small_tree<Kernel>();
  tree[4].radius = -1;
  BOOST_CHECK_THROW(pcs::scan_tree(tree, scan), pcs::Invalid_input);
  tree = pcs_test::make_small_tree<Kernel>();
  tree[4].branch = 12;
  BOOST_CHECK_THROW(pcs::scan_tree(tree, scan), pcs::Invalid_input);
  tree = pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1}});
  tree[0].radius = tree[1].radius = tree[0].major_radius = tree[1].major_radius = 0;
  BOOST_CHECK_THROW(pcs::scan_tree(tree, scan), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(a_tree_without_thickness_gives_no_points)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].radius = tree[v].major_radius = tree[v].minor_radius = 0;
  Scan scan;
  const auto report = pcs::scan_tree(tree, scan);
  BOOST_TEST(report.status == pcs::Status::nothing_to_do);
  BOOST_TEST(scan.points.empty());
  BOOST_TEST(scan.hits.size() == 8u);
}

BOOST_AUTO_TEST_CASE(senseless_scanners_are_refused_and_name_the_value)
{
  const Tree tree = pcs_test::make_small_tree<Kernel>();
  const auto refuses = [&](auto change, const std::string& name) {
    pcs::Virtual_scanner scanner;
    change(scanner);
    Scan scan;
    std::string message = "no error";
    try {
      pcs::scan_tree(tree, scan, scanner);
    } catch (const pcs::Invalid_input& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(name) != std::string::npos, name << " in " << message);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses([&](auto& s) { s.number_of_stations = 0; }, "number_of_stations");
  refuses([&](auto& s) { s.distance = nan; }, "distance");
  refuses([&](auto& s) { s.distance_spread = 1; }, "distance_spread");
  refuses([&](auto& s) { s.angular_step = 0; }, "angular_step");
  refuses([&](auto& s) { s.angular_step = nan; }, "angular_step");
  refuses([&](auto& s) { s.azimuth_range = 7; }, "azimuth_range");
  refuses([&](auto& s) { s.ghost_share = 1.5; }, "ghost_share");
  refuses([&](auto& s) { s.range_noise = -1; }, "range_noise");
  refuses([&](auto& s) { s.outlier_share = nan; }, "outlier_share");
  refuses([&](auto& s) { s.voxel_size = -1; }, "voxel_size");
  refuses([&](auto& s) { s.voxel_size = 1e-17; }, "`voxel_size` is too small for this tree");
  refuses([&](auto& s) { s.wind = nan; }, "wind");
  refuses([&](auto& s) { s.positions = {{0, nan, 0}}; }, "positions");
  refuses([&](auto& s) { s.posts = {{0, 0, 0, 1}}; }, "posts");
  refuses(
      [&](auto& s) {
        s.distance = 0.01; // of a tree in another unit
        s.station_height = 0.5;
      },
      "is inside the trunk");
  refuses(
      [&](auto& s) {
        s.angular_step = 1e-6;
        s.distance = 1.5;
      },
      "beams");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_scan_tree

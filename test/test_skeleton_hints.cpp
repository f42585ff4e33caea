// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Hints to extract_tree_skeleton(), namely scanner positions and a given skeleton, and cancellation
// at every stage.

#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_fixtures.h>
#include <support/exceptions.h>
#include <support/tree_clouds.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

namespace test_skeleton_hints {

using pcs_test::append;
using pcs_test::cylinder;
using pcs_test::Tree;
using Kernel = pcs_test::Tree_kernel;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using Cloud = std::vector<Point>;

BOOST_AUTO_TEST_SUITE(tree_skeleton_hints)

BOOST_AUTO_TEST_CASE(scanner_positions_take_the_beam_out_of_thin_radii)
{
  const Tree truth = pcs::make_cylinder_tree<Kernel>(1.5, 0.006);
  pcs::Virtual_scanner scanner;
  scanner.beam_width = 0.0015;
  scanner.angular_step = 0.03 * CGAL_PI / 180;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(truth, scan, scanner, pcs::parameters::random_seed(2));
  Tree plain, corrected, none;
  pcs::extract_tree_skeleton(scan.points, plain);
  const auto np = pcs::parameters::scanner_positions(scan.stations);
  pcs::extract_tree_skeleton(scan.points, corrected, np.beam_width(scanner.beam_width));
  pcs::extract_tree_skeleton(scan.points, none, np.beam_width(0.0));
  const std::size_t v = num_vertices(plain) / 2;
  const double before = plain[v].radius - 0.006, after = corrected[v].radius - 0.006;
  BOOST_TEST(before > 0.001);
  BOOST_TEST(std::abs(after) < 0.6 * before);
  BOOST_TEST(none[v].radius == plain[v].radius);
  // A thick branch hardly changes.
  Tree trunk, same;
  const Cloud thick = cylinder(4000, 0.2, 2);
  pcs::extract_tree_skeleton(thick, trunk);
  const std::vector<Point> station{Point(10, 0, 1)};
  pcs::extract_tree_skeleton(thick, same, pcs::parameters::scanner_positions(station));
  BOOST_CHECK_CLOSE(same[5].radius, trunk[5].radius, 0.1);
  BOOST_TEST(same[5].radius < trunk[5].radius);
}

BOOST_AUTO_TEST_CASE(a_given_skeleton_is_measured_where_it_is)
{
  // A stem and a branch, and an external graph along them with a small offset from the axis.
  Cloud points = cylinder(6000, 0.1, 2);
  append(points, cylinder(1500, 0.03, 1, Point(0.1, 0, 1.2), Vector(1, 0, 0)));
  struct Vertex
  {
    Point place;
    float width = 0;
  };
  using Graph = boost::adjacency_list<boost::listS, boost::listS, boost::directedS, Vertex>;
  Graph given;
  const auto add = [&](double x, double z, auto parent) {
    const auto v = add_vertex(given);
    given[v].place = Point(x, 0.01, z);
    add_edge(parent, v, given);
    return v;
  };
  const auto root = add_vertex(given);
  given[root].place = Point(0, 0.01, 0);
  auto v = root, fork = root;
  for (int k = 1; k <= 20; ++k) {
    v = add(0, 0.1 * k, v);
    if (k == 12)
      fork = v;
  }
  for (int k = 1; k <= 10; ++k)
    fork = add(0.11 * k, 1.2, fork);

  Tree tree;
  std::map<Point, std::size_t> branch;
  const auto report =
      pcs::extract_tree_skeleton(points,
                                 tree,
                                 pcs::parameters::given_skeleton(std::cref(given))
                                     .given_point_map(get(&Vertex::place, given))
                                     .point_branch_map(boost::make_assoc_property_map(branch)));
  pcs_test::check_is_a_tree(tree);
  BOOST_TEST(report.status == pcs::Status::converged);
  BOOST_TEST(report.number_of_branches == 2u);
  BOOST_CHECK_CLOSE(report.total.length, 2 + 1.1, 1e-6);
  for (std::size_t w = 0; w < num_vertices(tree); ++w) {
    BOOST_CHECK_SMALL(tree[w].point.y() - 0.01, 1e-12); // positions remain
    BOOST_CHECK_CLOSE(tree[w].radius, tree[w].branch == 0 ? 0.1 : 0.03, 12.0);
  }
  std::size_t right = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    right += branch.at(points[i]) == (i < 6000 ? 0u : 1u);
  BOOST_TEST(right > points.size() * 95 / 100);

  // A Tree_skeleton needs no map; its own result gives the same radii again.
  Tree found, again;
  pcs::extract_tree_skeleton(points, found);
  pcs::extract_tree_skeleton(points, again, pcs::parameters::given_skeleton(found));
  BOOST_TEST_REQUIRE(num_vertices(again) == num_vertices(found));
  BOOST_CHECK_CLOSE(again[num_vertices(again) / 4].radius, 0.1, 2.0);
}

BOOST_AUTO_TEST_CASE(a_given_skeleton_measures_neither_ground_nor_noise)
{
  // The skeleton of a tree with ground around it, given as input again.
  const auto& scan = pcs_test::small_scan().scan;
  Cloud points = scan.points;
  const std::size_t number_of_tree = points.size();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> side(-2, 2);
  std::normal_distribution<double> height(0, 0.003);
  for (int i = 0; i < 20000; ++i)
    points.emplace_back(side(random), side(random), height(random));
  Tree found, again;
  std::map<Point, std::size_t> branch;
  const auto alone = pcs::extract_tree_skeleton(points, found);
  const auto report =
      pcs::extract_tree_skeleton(points,
                                 again,
                                 pcs::parameters::given_skeleton(found).point_branch_map(
                                     boost::make_assoc_property_map(branch)));
  BOOST_TEST(alone.number_of_ground_points > 15000u);
  BOOST_TEST(report.number_of_ground_points == alone.number_of_ground_points);
  std::size_t number_on_ground = 0;
  for (std::size_t i = number_of_tree; i < points.size(); ++i)
    number_on_ground += branch.at(points[i]) != pcs::npos;
  BOOST_TEST(number_on_ground < 200u);
  BOOST_CHECK_CLOSE(report.noise, alone.noise, 20.0);
  BOOST_CHECK_CLOSE(report.total.volume, alone.total.volume, 5.0);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, alone.diameter_at_breast_height, 2.0);
  BOOST_TEST(report.residual < 1.5 * report.noise);
}

BOOST_AUTO_TEST_CASE(a_true_skeleton_gives_the_volume_of_dense_and_sparse_scans)
{
  const Tree& truth = pcs_test::small_scan().truth;
  double volume = 0;
  for (const auto e : boost::make_iterator_range(edges(truth))) {
    const auto &a = truth[source(e, truth)], &b = truth[target(e, truth)];
    const double r = a.branch == b.branch ? a.radius : b.radius;
    volume += CGAL_PI / 3 * std::sqrt(CGAL::squared_distance(a.point, b.point)) *
              (r * r + r * b.radius + b.radius * b.radius);
  }
  // Estimates from the points of each edge alone are too large by a sixth and by a half.
  for (const auto& [degrees, most] : {std::make_pair(0.1, 0.05), std::make_pair(0.3, 0.12)}) {
    pcs::Virtual_scanner scanner;
    scanner.angular_step = degrees * CGAL_PI / 180;
    scanner.range_noise = 0.003;
    pcs::Virtual_scan<Kernel> scan;
    pcs::scan_tree(truth, scan, scanner, pcs::parameters::random_seed(6));
    Tree tree;
    const auto report =
        pcs::extract_tree_skeleton(scan.points, tree, pcs::parameters::given_skeleton(truth));
    BOOST_TEST_CONTEXT(degrees << " degrees, volume " << report.total.volume << " of " << volume)
    BOOST_TEST(std::abs(report.total.volume / volume - 1) < most);
  }
}

BOOST_AUTO_TEST_CASE(given_branches_without_points_taper)
{
  // A stem of 2 m, and an arm of 1 m without points.
  const Cloud points = cylinder(6000, 0.1, 2);
  Tree given, tree;
  for (int k = 0; k <= 10; ++k) {
    pcs::Tree_node<pcs_test::Tree_kernel> node;
    node.point = Point(0, 0, 0.2 * k);
    add_vertex(node, given);
    if (k > 0)
      add_edge(std::size_t(k - 1), std::size_t(k), given);
  }
  for (int k = 1; k <= 10; ++k) {
    pcs::Tree_node<pcs_test::Tree_kernel> node;
    node.point = Point(0.1 * k, 0, 1);
    const std::size_t v = add_vertex(node, given);
    add_edge(k == 1 ? std::size_t(5) : v - 1, v, given);
  }
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::given_skeleton(given));
  const auto out = [&](std::size_t v) { return CGAL::to_double(tree[v].point.x()); };
  std::size_t count = 0;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (out(v) > 0.35) {
      ++count;
      BOOST_TEST(!tree[v].is_measured);
      BOOST_TEST(tree[v].radius <= 0.1 * (1.051 - out(v)));
    } else if (out(v) == 0 && tree[v].point.z() > 0.1 && tree[v].branch == 0)
      BOOST_CHECK_CLOSE(tree[v].radius, 0.1, 5.0);
  BOOST_TEST(count == 7u);
}

BOOST_AUTO_TEST_CASE(a_root_on_the_bark_gives_the_tree_of_its_foot)
{
  Cloud points = cylinder(6000, 0.1, 3);
  append(points, cylinder(1500, 0.03, 1, Point(0.1, 0, 2), Vector(1, 0, 0.3)));
  Tree found, hinted;
  const auto plain = pcs::extract_tree_skeleton(points, found);
  const auto np = pcs::parameters::root_position(Point(0.1, 0, 0.01));
  const auto report = pcs::extract_tree_skeleton(points, hinted, np);
  BOOST_TEST(report.number_of_branches == plain.number_of_branches);
  BOOST_CHECK_CLOSE(report.total.volume, plain.total.volume, 2.0);
  BOOST_TEST(CGAL::squared_distance(found[0].point, hinted[0].point) < 0.02 * 0.02);
}

BOOST_AUTO_TEST_CASE(hints_that_make_no_sense_are_refused)
{
  const Cloud points = cylinder(2000, 0.1, 2);
  Tree tree, empty, forest(2), ring(2);
  add_edge(0, 1, ring);
  add_edge(1, 0, ring);
  const double bad = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Point> nowhere{Point(bad, 0, 0)}, station{Point(9, 0, 0)};
  using namespace pcs::parameters;
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, given_skeleton(empty)),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, given_skeleton(forest)),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, given_skeleton(ring)),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, scanner_positions(nowhere)),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(
      pcs::extract_tree_skeleton(points, tree, scanner_positions(station).beam_width(-0.1)),
      pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, root_position(Point(0, bad, 0))),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, up_direction(Vector(0, bad, 1))),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, breast_height(bad)),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(
      pcs::extract_tree_skeleton(points, tree, scanner_positions(station).beam_width(bad)),
      pcs::Invalid_input);
  Tree broken;
  pcs::extract_tree_skeleton(points, broken);
  broken[1].point = Point(0, 0, bad);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, given_skeleton(broken)),
                    pcs::Invalid_input);
  // The positions belong to another scan.
  const std::vector<Point> elsewhere{Point(448576, 5411234, 312)};
  BOOST_CHECK_EXCEPTION(pcs::extract_tree_skeleton(points, tree, scanner_positions(elsewhere)),
                        pcs::Invalid_input,
                        pcs_test::message_has("in the coordinates and unit of the points"));
  BOOST_CHECK_EXCEPTION(pcs::extract_tree_skeleton(points, tree, root_position(Point(0, 0, -3))),
                        pcs::Invalid_input,
                        pcs_test::message_has("in the coordinates and unit of the points"));
  broken[1].point = Point(0, 0, 1e101);
  BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, given_skeleton(broken)),
                    pcs::Invalid_input);
  for (const double scale : {0.0, 1.0}) { // zero length; distant
    Tree moved = broken;
    for (std::size_t v = 0; v < num_vertices(moved); ++v)
      moved[v].point = Point(50 * scale, 0, scale * double(v));
    BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, given_skeleton(moved)),
                      pcs::Invalid_input);
  }
  for (const auto& spoil : std::vector<std::function<void(pcs::Slice_options&)>>{
           [](auto& r) { r.height = 0; },
           [&](auto& r) { r.height = bad; },
           [](auto& r) { r.highest_count = 5; },
           [](auto& r) { r.lowest_count = 5; },
           [](auto& r) { r.largest_radius = -1; },
           [](auto& r) { r.upright = 1.1; },
           [](auto& r) { r.tilts = -1; },
           [](auto& r) { r.radius = 0; },
           [&](auto& r) { r.radius_offset = bad; },
           [](auto& r) { r.turn_cost = -1; },
           [](auto& r) { r.dense_radius = -0.1; },
           [&](auto& r) { r.dense_offset = bad; },
           [](auto& r) { r.allometry = -0.4; },
           [](auto& r) { r.has_normals = true; }, // without a normal map
           [](auto& r) { r.support_cosine = 2; }}) {
    pcs::Slice_options rules;
    spoil(rules);
    BOOST_CHECK_EXCEPTION(pcs::extract_tree_skeleton(points, tree, slice_options(rules)),
                          pcs::Invalid_input,
                          pcs_test::message_has("slice_options"));
  }
  BOOST_TEST(num_vertices(tree) == 0u);
  // A position slightly below the lowest points is valid.
  pcs::extract_tree_skeleton(points, tree, root_position(Point(0, 0, -0.5)));
  BOOST_TEST(num_vertices(tree) > 1u);
}

// Stops at every call of the callback, for every method.
BOOST_AUTO_TEST_CASE(stopping_anywhere_leaves_nothing_half_done)
{
  const Cloud points = cylinder(1500, 0.1, 2);
  Tree given;
  pcs::extract_tree_skeleton(points, given);
  const auto check = [&](const auto& np) {
    Tree full;
    std::size_t calls = 0;
    const std::function<bool(double)> count = [&](double) { return ++calls > 0; };
    pcs::extract_tree_skeleton(points, full, np.callback(count));
    BOOST_TEST(calls >= 5u);
    for (std::size_t at = 1; at < calls; ++at) {
      std::size_t left = at;
      const std::function<bool(double)> stop = [&](double) { return --left > 0; };
      Tree tree(3);
      std::map<Point, std::size_t> branches;
      for (const Point& p : points)
        branches[p] = 77;
      const auto report = pcs::extract_tree_skeleton(
          points,
          tree,
          np.callback(stop).point_branch_map(boost::make_assoc_property_map(branches)));
      BOOST_TEST(report.status == pcs::Status::cancelled);
      BOOST_TEST(num_vertices(tree) == 3u);
      for (const auto& [p, b] : branches)
        BOOST_REQUIRE(b == 77u);
    }
  };
  using namespace pcs::parameters;
  check(breast_height(1.3));
  check(skeleton_method(pcs::Skeleton_method::sections));
  check(given_skeleton(given));
}

// One session is stopped before each step that changes the input of the next steps.
BOOST_AUTO_TEST_CASE(a_stopped_session_goes_on_as_if_it_had_not_been)
{
  Cloud points = pcs_test::small_scan().scan.points;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j)
      for (const bool is_wall : {false, true}) {
        const double x = -2 + 0.04 * i, y = -2 + 0.04 * j, z = 0.003 * ((7 * i + 5 * j) % 3);
        points.push_back(is_wall ? Point(2.2 + z, x, y + 2.1) : Point(x, y, z));
      }
  Tree full;
  const auto expected = pcs::extract_tree_skeleton(points, full);
  BOOST_TEST(expected.number_of_ground_points > 5000u);
  BOOST_TEST(expected.number_of_wall_points > 9000u);
  const std::vector<double> stops = {0, 0.1, 0.42, 0.43, 0.6, 0.7, 0.9, 0.91, 0.95, 0.96, 0.97};
  std::size_t stopped = 0;
  const std::function<bool(double)> callback = [&](double f) {
    const bool is_stop = stopped < stops.size() && f >= stops[stopped];
    stopped += is_stop;
    return !is_stop;
  };
  const auto np = pcs::parameters::callback(callback);
  pcs::Tree_skeletonization<Cloud, std::decay_t<decltype(np)>> session(points, np);
  Tree tree;
  pcs::Skeleton_report report;
  for (std::size_t k = 0; k <= stops.size(); ++k)
    report = session.extract(tree);
  BOOST_TEST(stopped == stops.size());
  BOOST_TEST(report.status == pcs::Status::converged);
  BOOST_TEST(report.number_of_ground_points == expected.number_of_ground_points);
  BOOST_TEST(report.number_of_wall_points == expected.number_of_wall_points);
  BOOST_TEST(report.total.length == expected.total.length);
  BOOST_REQUIRE(num_vertices(tree) == num_vertices(full));
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    BOOST_TEST(tree[v].point == full[v].point);
    BOOST_TEST(tree[v].radius == full[v].radius);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_skeleton_hints

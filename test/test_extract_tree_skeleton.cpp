// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Accuracy and laws of extract_tree_skeleton() on virtual scans.

#include <pcs/Tree_skeletonization.h>
#include <pcs/extract_tree_skeleton.h>
#include <support/archetypes.h>
#include <support/threads.h>
#include <support/tree_clouds.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace test_extract_tree_skeleton {

namespace {

using pcs_test::check_is_a_tree;
using pcs_test::cylinder;
using pcs_test::small_scan;
using pcs_test::Small_scan;
using pcs_test::Tree;
using Kernel = pcs_test::Tree_kernel;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;

double length_of(const Tree& tree)
{
  double sum = 0;
  for (const auto e : boost::make_iterator_range(edges(tree)))
    sum += std::sqrt((tree[target(e, tree)].point - tree[source(e, tree)].point).squared_length());
  return sum;
}

bool are_equal(const Tree& a, const Tree& b)
{
  if (num_vertices(a) != num_vertices(b))
    return false;
  for (std::size_t v = 0; v < num_vertices(a); ++v)
    if (a[v].point != b[v].point || a[v].radius != b[v].radius ||
        a[v].radius_error != b[v].radius_error || a[v].branch != b[v].branch ||
        pcs::parent_node<Kernel>(v, a) != pcs::parent_node<Kernel>(v, b))
      return false;
  return true;
}

/// Largest distance in position and radius from a node of `a` to the nearest node of `b`, for the
/// fraction `share` of the nodes.
double distance_between(const Tree& a, const Tree& b, double share)
{
  std::vector<double> distances;
  for (std::size_t v = 0; v < num_vertices(a); ++v) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t w = 0; w < num_vertices(b); ++w)
      best = std::min(best,
                      (a[v].point - b[w].point).squared_length() +
                          (a[v].radius - b[w].radius) * (a[v].radius - b[w].radius));
    distances.push_back(std::sqrt(best));
  }
  std::sort(distances.begin(), distances.end());
  return distances[static_cast<std::size_t>(share * double(distances.size() - 1))];
}

/// Length of the pieces of `tree` whose midpoint is further than 2.5 cm from all pieces of `truth`.
double astray(const Tree& tree, const Tree& truth)
{
  double sum = 0;
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const Kernel::Segment_3 piece(tree[source(e, tree)].point, tree[target(e, tree)].point);
    const Point middle = CGAL::midpoint(piece.source(), piece.target());
    const auto all = edges(truth);
    if (std::none_of(all.first, all.second, [&](auto f) {
          const Kernel::Segment_3 other(truth[source(f, truth)].point,
                                        truth[target(f, truth)].point);
          return CGAL::squared_distance(other, middle) < 0.025 * 0.025;
        }))
      sum += std::sqrt(piece.squared_length());
  }
  return sum;
}

template <class Transform>
std::vector<Point> transformed(const std::vector<Point>& points, const Transform& f)
{
  std::vector<Point> result;
  for (const Point& p : points)
    result.push_back(f(p));
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(extract_tree_skeleton)

BOOST_AUTO_TEST_CASE(a_cylinder_gives_one_branch_of_its_radius)
{
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(cylinder(8000, 0.1, 2), tree);
  BOOST_CHECK_EQUAL(report.status, pcs::Status::converged);
  check_is_a_tree(tree);
  BOOST_CHECK_EQUAL(report.number_of_branches, 1u);
  BOOST_CHECK_CLOSE(report.height, 2.0, 5.0);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.2, 2.0);
  BOOST_CHECK_CLOSE(report.total.volume, CGAL_PI * 0.01 * 2, 6.0);
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    BOOST_CHECK_SMALL(std::hypot(tree[v].point.x(), tree[v].point.y()), 0.003);
}

BOOST_AUTO_TEST_CASE(half_a_cylinder_has_the_same_axis_and_radius)
{
  std::vector<Point> points;
  for (const Point& p : cylinder(16000, 0.1, 2))
    if (p.x() > 0)
      points.push_back(p);
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  BOOST_CHECK_EQUAL(report.number_of_branches, 1u);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.2, 3.0);
}

BOOST_AUTO_TEST_CASE(the_branches_of_a_virtual_tree_are_found)
{
  const Small_scan& s = small_scan();
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(s.scan.points, tree);
  check_is_a_tree(tree);
  std::size_t seen = 0; // branches with points
  double seen_length = 0;
  const auto lists = pcs::nodes_by_branch<Kernel>(s.truth);
  for (const auto& nodes : lists) {
    bool is_seen = false;
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      const bool has_hits = s.scan.hits[nodes[k]] + s.scan.hits[nodes[k - 1]] > 0;
      is_seen = is_seen || has_hits;
      if (has_hits)
        seen_length +=
            std::sqrt((s.truth[nodes[k]].point - s.truth[nodes[k - 1]].point).squared_length());
    }
    seen += is_seen;
  }
  BOOST_CHECK_CLOSE(double(report.number_of_branches), double(seen), 20.0);
  BOOST_CHECK_CLOSE(report.total.length, seen_length, 15.0);
  BOOST_CHECK_CLOSE(length_of(tree), report.total.length, 0.1);
  BOOST_CHECK_EQUAL(report.by_order.at(0).number_of_branches, 1u);
  // Nearly all nodes lie within 1 cm of a true axis.
  std::vector<double> distances;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto e : boost::make_iterator_range(edges(s.truth)))
      best = std::min(best,
                      CGAL::squared_distance(tree[v].point,
                                             Kernel::Segment_3(s.truth[source(e, s.truth)].point,
                                                               s.truth[target(e, s.truth)].point)));
    distances.push_back(std::sqrt(best));
  }
  std::sort(distances.begin(), distances.end());
  BOOST_CHECK_LT(distances[distances.size() / 2], 0.004);
  BOOST_CHECK_LT(distances[distances.size() * 9 / 10], 0.012);
}

BOOST_AUTO_TEST_CASE(points_know_their_branch_and_distance)
{
  const std::vector<Point> points = cylinder(4000, 0.1, 1);
  std::map<Point, std::size_t> branch;
  std::map<Point, double> residual;
  std::map<Point, bool> dense, leaf;
  std::map<Point, Kernel::Vector_3> normal;
  Tree tree;
  pcs::extract_tree_skeleton(
      points,
      tree,
      pcs::parameters::point_branch_map(boost::make_assoc_property_map(branch))
          .point_residual_map(boost::make_assoc_property_map(residual))
          .point_is_dense_map(boost::make_assoc_property_map(dense))
          .point_is_leaf_map(boost::make_assoc_property_map(leaf))
          .normal_map(boost::make_assoc_property_map(normal)));
  std::size_t explained = 0, measured = 0;
  for (const Point& p : points)
    if (branch.at(p) != pcs::npos) {
      ++explained;
      measured += dense.at(p);
      BOOST_CHECK_SMALL(residual.at(p), 0.03);
      BOOST_CHECK(!leaf.at(p));
      // The axis of the cylinder is the z-axis.
      const Kernel::Vector_3 across(p.x(), p.y(), 0);
      BOOST_CHECK_GT(normal.at(p) * across, 0.95 * std::sqrt(across.squared_length()));
      BOOST_CHECK_CLOSE(normal.at(p).squared_length(), 1.0, 1e-9);
    } else
      BOOST_CHECK_EQUAL(normal.at(p).squared_length(), 0.0);
  BOOST_CHECK_GT(explained, points.size() * 9 / 10);
  BOOST_CHECK_GT(measured, explained * 9 / 10);
}

BOOST_AUTO_TEST_CASE(leaves_are_found_where_there_are_any)
{
  const Small_scan& s = small_scan();
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.1 * CGAL_PI / 180;
  scanner.leaves_per_length = 20;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(s.truth, scan, scanner, pcs::parameters::random_seed(6));
  std::map<Point, bool> leaf;
  Tree with, without;
  const auto found = pcs::extract_tree_skeleton(
      scan.points,
      with,
      pcs::parameters::point_is_leaf_map(boost::make_assoc_property_map(leaf)));
  const auto kept =
      pcs::extract_tree_skeleton(scan.points, without, pcs::parameters::do_remove_leaves(false));
  check_is_a_tree(with);
  std::size_t leaves = 0, right = 0, wood = 0, wrong = 0, all = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const bool is_found = leaf.at(scan.points[i]);
    all += is_found;
    if (scan.node[i] == -3) {
      ++leaves;
      right += is_found;
    } else if (scan.node[i] >= 0) {
      ++wood;
      wrong += is_found;
    }
  }
  BOOST_CHECK_EQUAL(all, found.number_of_leaf_points);
  BOOST_CHECK_GT(10 * right, 7 * leaves);
  BOOST_CHECK_LT(5 * wrong, wood);
  BOOST_CHECK_CLOSE(found.height, kept.height, 5.0); // upper end of the leaves
  BOOST_CHECK_EQUAL(kept.number_of_leaf_points, 0u);
  BOOST_CHECK_LT(found.number_of_branches, kept.number_of_branches / 2);
  const double truth = length_of(s.truth);
  BOOST_CHECK_LT(std::abs(length_of(with) - truth), 0.5 * std::abs(length_of(without) - truth));
  // Scans of wood only are unchanged, unless the caller requests removal.
  Tree bare;
  BOOST_CHECK_EQUAL(pcs::extract_tree_skeleton(s.scan.points, bare).number_of_leaf_points, 0u);
  const auto always = pcs::parameters::do_remove_leaves(true);
  const auto insisted = pcs::extract_tree_skeleton(s.scan.points, bare, always);
  BOOST_CHECK_GT(insisted.number_of_leaf_points, 0u);
  BOOST_CHECK_LT(insisted.number_of_leaf_points, s.scan.points.size() / 5);
}

BOOST_AUTO_TEST_CASE(residuals_are_those_of_the_surface_that_is_written)
{
  // With leaves, radii are bounded after the fit.
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.15 * CGAL_PI / 180;
  scanner.leaves_per_length = 20;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(small_scan().truth, scan, scanner, pcs::parameters::random_seed(6));
  std::map<Point, std::size_t> branch;
  std::map<Point, double> residual;
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(
      scan.points,
      tree,
      pcs::parameters::point_branch_map(boost::make_assoc_property_map(branch))
          .point_residual_map(boost::make_assoc_property_map(residual))
          .do_register_stations(false)); // otherwise the residuals refer to registered points
  struct Edge
  {
    Point from, to;
    double from_radius, to_radius;
  };
  std::vector<std::vector<Edge>> edges_of(report.number_of_branches);
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const auto &a = tree[source(e, tree)], &b = tree[target(e, tree)];
    edges_of[b.branch].push_back(
        {a.point, b.point, a.branch == b.branch ? a.radius : b.radius, b.radius});
  }
  std::size_t number = 0, number_equal = 0;
  std::vector<double> deviations;
  for (const Point& p : scan.points) {
    if (branch.at(p) == pcs::npos)
      continue;
    double nearest = std::numeric_limits<double>::infinity(), expected = 0;
    for (const Edge& e : edges_of[branch.at(p)]) {
      const Vector d = e.to - e.from;
      const double t =
          std::min(1.0, std::max(0.0, ((p - e.from) * d) / std::max(1e-30, d.squared_length())));
      const double away = std::sqrt(((p - e.from) - t * d).squared_length());
      if (away < nearest) {
        nearest = away;
        expected = away - (1 - t) * e.from_radius - t * e.to_radius;
      }
    }
    ++number;
    number_equal += std::abs(residual.at(p) - expected) < 1e-6;
    deviations.push_back(std::abs(expected));
  }
  BOOST_TEST(number > 4000u);
  BOOST_TEST(number_equal > number * 95 / 100); // for the others, an edge farther on is nearer
  std::nth_element(deviations.begin(), deviations.begin() + long(number / 2), deviations.end());
  BOOST_CHECK_CLOSE(report.residual, deviations[number / 2], 2.0);
}

BOOST_AUTO_TEST_CASE(a_scan_without_noise_has_right_radii)
{
  pcs::Tree_habit habit = pcs::fruit_habit();
  habit.flattest_section = 1;
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.1 * CGAL_PI / 180;
  scanner.range_noise = scanner.registration_error = scanner.bark_depth = scanner.beam_width = 0;
  scanner.outlier_share = 0;
  Tree truth, tree;
  pcs::grow_tree(truth, habit, pcs::parameters::random_seed(1));
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(truth, scan, scanner, pcs::parameters::random_seed(1));
  pcs::extract_tree_skeleton(scan.points, tree);
  // Radii of 5 to 10 mm. Without a noise model, nine in ten were within 90 %.
  std::vector<double> errors;
  for (const auto v : boost::make_iterator_range(vertices(truth))) {
    const double radius = truth[v].radius;
    if (radius < 0.005 || radius > 0.01 || scan.hits[v] == 0)
      continue;
    double nearest = 1e-4, error = -1; // over nodes within a centimetre
    for (const auto w : boost::make_iterator_range(vertices(tree))) {
      const double d = CGAL::squared_distance(tree[w].point, truth[v].point);
      if (d < nearest) {
        nearest = d;
        error = std::abs(tree[w].radius - radius) / radius;
      }
    }
    if (error >= 0)
      errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  BOOST_TEST_REQUIRE(errors.size() > 500u);
  BOOST_TEST(errors[errors.size() / 2] < 0.02);
  BOOST_TEST(errors[errors.size() * 9 / 10] < 0.4);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(tree_skeleton_strays)

BOOST_AUTO_TEST_CASE(what_strays_from_wood_is_no_branch_and_no_leaf)
{
  double away = 0, away_with_stray = 0, length = 0, length_with_stray = 0;
  // In single trees the length may increase by chance.
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    Tree truth;
    pcs::grow_tree(truth, pcs::fruit_habit(), pcs::parameters::random_seed(seed));
    pcs::Virtual_scanner scanner;
    scanner.angular_step = 0.2 * CGAL_PI / 180;
    scanner.range_noise = 0.004;
    pcs::Virtual_scan<Kernel> scan;
    pcs::scan_tree(truth, scan, scanner, pcs::parameters::random_seed(seed));
    std::map<Point, bool> leaf;
    std::map<Point, std::size_t> branch;
    Tree tree, with_stray;
    const auto found = pcs::extract_tree_skeleton(
        scan.points,
        tree,
        pcs::parameters::point_is_leaf_map(boost::make_assoc_property_map(leaf))
            .point_branch_map(boost::make_assoc_property_map(branch)));
    const auto kept = pcs::extract_tree_skeleton(scan.points,
                                                 with_stray,
                                                 pcs::parameters::do_remove_leaves(false));
    check_is_a_tree(tree);
    const double left = astray(tree, truth), all = astray(with_stray, truth);
    BOOST_TEST_MESSAGE("seed " << seed << ": " << left << " of " << length_of(tree) << ", with all "
                               << all << " of " << length_of(with_stray));
    away += left;
    away_with_stray += all;
    BOOST_CHECK_CLOSE(found.height, kept.height, 2.0);
    length += length_of(tree);
    length_with_stray += length_of(with_stray);
    // There are no leaves: all points are used, but may belong to no branch.
    BOOST_CHECK_EQUAL(found.number_of_leaf_points, 0u);
    BOOST_CHECK_EQUAL(found.number_of_outliers, kept.number_of_outliers);
    std::size_t without_branch = 0;
    for (const Point& p : scan.points) {
      BOOST_CHECK(!leaf.at(p));
      without_branch += branch.at(p) == pcs::npos;
    }
    BOOST_CHECK_EQUAL(without_branch,
                      found.number_of_unexplained_points + found.number_of_unreached_points +
                          found.number_of_outliers);
  }
  BOOST_TEST_MESSAGE("astray " << away << " of " << length << ", with all " << away_with_stray
                               << " of " << length_with_stray);
  BOOST_CHECK_LT(away, 0.9 * away_with_stray);
  BOOST_CHECK_GT(length, 0.9 * length_with_stray);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(extract_tree_skeleton)

BOOST_AUTO_TEST_CASE(trees_in_rows_keep_their_wood)
{
  const Small_scan& s = small_scan();
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.04 * CGAL_PI / 180;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(s.truth, scan, scanner, pcs::parameters::random_seed(7));
  std::vector<Point> rows; // 7 mm wide, similar to a scanner that moves by 6 cm between profiles
  for (const Point& p : scan.points) {
    const double place = (p.z() + 0.3 * p.x()) / 0.06;
    if (std::abs(place - std::round(place)) * 0.06 < 0.0035)
      rows.push_back(p);
  }
  Tree tree, bare;
  const auto report = pcs::extract_tree_skeleton(rows, tree);
  const auto kept =
      pcs::extract_tree_skeleton(rows, bare, pcs::parameters::do_remove_leaves(false));
  BOOST_CHECK(report.is_in_rows);
  BOOST_CHECK_EQUAL(pcs::warnings(report).size(), pcs::warnings(kept).size() + 1);
  BOOST_CHECK_EQUAL(report.number_of_leaf_points, 0u);
  BOOST_CHECK(are_equal(tree, bare));
  // Forced leaf removal removes most of the tree.
  Tree lost;
  const auto always =
      pcs::extract_tree_skeleton(rows, lost, pcs::parameters::do_remove_leaves(true));
  BOOST_CHECK(!always.is_in_rows);
  BOOST_CHECK_LT(2 * always.total.length, kept.total.length);
}

BOOST_AUTO_TEST_CASE(points_that_the_caller_calls_wood_are_no_leaves)
{
  const Small_scan& s = small_scan();
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.1 * CGAL_PI / 180;
  scanner.leaves_per_length = 20;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(s.truth, scan, scanner, pcs::parameters::random_seed(6));
  std::map<Point, bool> is_wood;
  std::size_t leaves = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    is_wood[scan.points[i]] = i % 10 != 0;
    leaves += i % 10 == 0;
  }
  Tree tree;
  const auto map = boost::make_assoc_property_map(is_wood);
  BOOST_CHECK_EQUAL(pcs::extract_tree_skeleton(scan.points, tree, pcs::parameters::wood_map(map))
                        .number_of_leaf_points,
                    leaves);
  // Unless the caller requests additional leaf detection.
  const auto np = pcs::parameters::wood_map(map).do_remove_leaves(pcs::Leaf_removal::where_found);
  BOOST_CHECK_GT(pcs::extract_tree_skeleton(scan.points, tree, np).number_of_leaf_points,
                 2 * leaves);
}

BOOST_AUTO_TEST_CASE(leaves_are_the_same_for_any_number_of_threads)
{
  const Small_scan& s = small_scan();
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.2 * CGAL_PI / 180;
  scanner.leaves_per_length = 20;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(s.truth, scan, scanner, pcs::parameters::random_seed(7));
  Tree sequential, parallel;
  std::map<Point, bool> one, many;
  const auto report = pcs::extract_tree_skeleton<CGAL::Sequential_tag>(
      scan.points,
      sequential,
      pcs::parameters::point_is_leaf_map(boost::make_assoc_property_map(one)));
  pcs::extract_tree_skeleton(
      scan.points,
      parallel,
      pcs::parameters::point_is_leaf_map(boost::make_assoc_property_map(many)));
  BOOST_CHECK_GT(report.number_of_leaf_points, 0u);
  BOOST_CHECK(one == many);
  BOOST_REQUIRE_EQUAL(num_vertices(sequential), num_vertices(parallel));
  for (std::size_t v = 0; v < num_vertices(sequential); ++v) {
    BOOST_CHECK_EQUAL(sequential[v].point, parallel[v].point);
    BOOST_CHECK_EQUAL(sequential[v].radius, parallel[v].radius);
  }
}

BOOST_AUTO_TEST_CASE(any_mutable_graph_takes_the_result)
{
  struct Vertex
  {
    std::array<float, 3> unused{};
    Point position = Point(0, 0, 0);
    float width = 0, width_error = -1;
    int branch = -1;
  };
  using Graph = boost::adjacency_list<boost::listS, boost::listS, boost::directedS, Vertex>;
  Graph graph;
  add_vertex(graph); // replaced by the result
  const auto report =
      pcs::extract_tree_skeleton(cylinder(4000, 0.1, 1),
                                 graph,
                                 pcs::parameters::node_point_map(get(&Vertex::position, graph))
                                     .node_radius_map(get(&Vertex::width, graph))
                                     .node_radius_error_map(get(&Vertex::width_error, graph))
                                     .node_branch_map(get(&Vertex::branch, graph)));
  BOOST_CHECK_EQUAL(num_vertices(graph), report.number_of_nodes);
  for (const auto v : boost::make_iterator_range(vertices(graph))) {
    BOOST_CHECK_EQUAL(graph[v].branch, 0);
    BOOST_TEST(graph[v].width_error >= 0);
    BOOST_TEST(graph[v].width_error < graph[v].width);
  }
  BOOST_CHECK_EQUAL(num_edges(graph) + 1, report.number_of_nodes);
  BOOST_CHECK_CLOSE(double(graph[*std::next(vertices(graph).first, 5)].width), 0.1, 3.0);
}

BOOST_AUTO_TEST_CASE(the_least_that_a_range_and_a_map_offer_is_enough)
{
  std::vector<pcs_test::Triple_archetype<double>> values;
  for (const Point& p : cylinder(2000, 0.1, 1))
    values.emplace_back(p.x(), p.y(), p.z());
  pcs_test::Range_archetype range(values.size());
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(
      range,
      tree,
      pcs::parameters::point_map(
          pcs_test::Map_archetype<pcs_test::Triple_archetype<double>>(values)));
  BOOST_CHECK_EQUAL(report.number_of_branches, 1u);
}

BOOST_AUTO_TEST_CASE(the_callback_sees_progress_and_may_stop)
{
  const auto& points = small_scan().scan.points;
  Tree full;
  std::vector<double> values;
  const std::function<bool(double)> watch = [&](double f) {
    values.push_back(f);
    return true;
  };
  pcs::extract_tree_skeleton(points, full, pcs::parameters::callback(watch));
  BOOST_CHECK(std::is_sorted(values.begin(), values.end()));
  BOOST_REQUIRE_GT(values.size(), 8u);
  BOOST_CHECK_EQUAL(values.back(), 1.0);
  for (std::size_t calls = 1; calls < values.size(); calls += 11) {
    std::size_t left = calls;
    const std::function<bool(double)> stop = [&](double) { return --left > 0; };
    Tree tree;
    const auto report = pcs::extract_tree_skeleton(points, tree, pcs::parameters::callback(stop));
    BOOST_CHECK_EQUAL(report.status, pcs::Status::cancelled);
    BOOST_CHECK_EQUAL(num_vertices(tree), 0u);
  }
}

BOOST_AUTO_TEST_CASE(an_exception_of_the_callback_leaves_the_graph_alone)
{
  const auto points = cylinder(500, 0.1, 2);
  Tree full;
  std::size_t all = 0;
  const std::function<bool(double)> count = [&](double) { return ++all > 0; };
  pcs::extract_tree_skeleton(points, full, pcs::parameters::callback(count));
  for (std::size_t at = all; at > 0; at -= std::min<std::size_t>(at, 7)) { // also the last one
    std::size_t left = at;
    const std::function<bool(double)> fail = [&](double) -> bool {
      if (--left == 0)
        throw std::range_error("enough");
      return true;
    };
    Tree tree(3);
    BOOST_CHECK_THROW(pcs::extract_tree_skeleton(points, tree, pcs::parameters::callback(fail)),
                      std::range_error);
    BOOST_CHECK_EQUAL(num_vertices(tree), 3u);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(tree_skeleton_laws)

BOOST_AUTO_TEST_CASE(threads_do_not_change_a_bit)
{
  const auto& points = small_scan().scan.points;
  Tree sequential;
  pcs::extract_tree_skeleton<CGAL::Sequential_tag>(points, sequential);
  for (const int count : pcs_test::thread_counts)
    pcs_test::with_threads(count, [&] {
      Tree parallel;
      pcs::extract_tree_skeleton(points, parallel);
      BOOST_CHECK(are_equal(sequential, parallel));
    });
}

BOOST_AUTO_TEST_CASE(calls_in_two_threads_give_the_bits_of_calls_alone)
{
  std::vector<Point> inputs[2];
  inputs[1] = cylinder(1000, 0.1, 2);
  const auto& scan = small_scan().scan.points;
  for (std::size_t i = 0; i < scan.size(); i += 6)
    inputs[0].push_back(scan[i]);
  Tree alone[2];
  for (int k = 0; k < 2; ++k)
    pcs::extract_tree_skeleton(inputs[k], alone[k]);
  BOOST_REQUIRE(num_vertices(alone[0]) > num_vertices(alone[1]));
  for (const bool is_same_input : {false, true}) {
    Tree found[2];
    pcs_test::in_two_threads(
        [&](int k) { pcs::extract_tree_skeleton(inputs[is_same_input ? 0 : k], found[k]); });
    for (int k = 0; k < 2; ++k)
      BOOST_CHECK(are_equal(found[k], alone[is_same_input ? 0 : k]));
  }
}

BOOST_AUTO_TEST_CASE(the_order_of_the_points_does_not_matter)
{
  const auto& points = small_scan().scan.points;
  std::vector<Point> shuffled = points;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(3));
  Tree a, b;
  pcs::extract_tree_skeleton(points, a);
  pcs::extract_tree_skeleton(shuffled, b);
  BOOST_CHECK(are_equal(a, b));
}

// Rotated, scaled or shuffled scans are equivalent.
constexpr double rounding = 1e-9;

// Coordinates far from the origin are rounded. Positions along an axis are poorly constrained, so
// rounding moves nodes along it and sometimes changes a twig. Of 100 nodes, 98 must match a node of
// the other tree with equal radius within two thirds of the point spacing, 1.4 cm here.
constexpr double share_of_nodes = 0.98, largest_distance = 0.009;

BOOST_AUTO_TEST_CASE(a_translation_moves_the_tree)
{
  const auto& points = small_scan().scan.points;
  const Kernel::Vector_3 far(5e5, 5e6, 100);
  const auto moved = transformed(points, [&](const Point& p) { return p + far; });
  const auto check = [&](bool does_register, double share, double distance) {
    const auto np = pcs::parameters::do_register_stations(does_register);
    Tree a, b;
    pcs::extract_tree_skeleton(points, a, np);
    pcs::extract_tree_skeleton(moved, b, np);
    for (std::size_t v = 0; v < num_vertices(b); ++v)
      b[v].point = b[v].point - far;
    BOOST_CHECK_SMALL(distance_between(a, b, share), distance);
    BOOST_CHECK_SMALL(distance_between(b, a, share), distance);
  };
  check(false, share_of_nodes, largest_distance);
  // Registrations of stations differ by a few hundredths of a millimetre, which moves nodes along
  // their axes.
  check(true, 0.9, 0.014);
}

BOOST_AUTO_TEST_CASE(a_scale_scales_the_tree)
{
  const auto& points = small_scan().scan.points;
  Tree a;
  pcs::extract_tree_skeleton(points, a);
  for (const double scale : {1e-9, 1e9}) {
    Tree b;
    pcs::extract_tree_skeleton(
        transformed(
            points,
            [&](const Point& p) { return Point(scale * p.x(), scale * p.y(), scale * p.z()); }),
        b,
        pcs::parameters::breast_height(scale * 1.3));
    for (std::size_t v = 0; v < num_vertices(b); ++v) {
      const Point p = b[v].point;
      b[v].point = Point(p.x() / scale, p.y() / scale, p.z() / scale);
      b[v].radius /= scale;
    }
    BOOST_TEST_CONTEXT("scale " << scale)
    {
      BOOST_CHECK_SMALL(distance_between(a, b, 1), rounding);
      BOOST_CHECK_SMALL(distance_between(b, a, 1), rounding);
    }
  }
}

namespace {

Point turned(const Point& p, double angle)
{
  const double c = std::cos(angle), s = std::sin(angle);
  return Point(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z());
}

std::vector<Point> turned(const std::vector<Point>& points, double angle)
{
  return transformed(points, [&](const Point& p) { return turned(p, angle); });
}

Tree turned_back(Tree tree, double angle)
{
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].point = turned(tree[v].point, -angle);
  return tree;
}

} // namespace

BOOST_AUTO_TEST_CASE(a_turn_about_the_up_axis_turns_the_tree)
{
  const auto& points = small_scan().scan.points;
  Tree a, b;
  pcs::extract_tree_skeleton(points, a);
  pcs::extract_tree_skeleton(turned(points, 1), b);
  const Tree back = turned_back(b, 1);
  BOOST_CHECK_SMALL(distance_between(a, back, 1), rounding);
  BOOST_CHECK_SMALL(distance_between(back, a, 1), rounding);
}

BOOST_AUTO_TEST_CASE(a_turn_of_quantised_points_turns_the_tree)
{
  const auto grid = [](double x) { return 0.005 * std::round(200 * x); };
  const std::vector<Point> points = transformed(small_scan().scan.points, [&](const Point& p) {
    return Point(grid(p.x()), grid(p.y()), grid(p.z()));
  });
  Tree a, b;
  pcs::extract_tree_skeleton(points, a);
  pcs::extract_tree_skeleton(turned(points, 0.3), b);
  BOOST_REQUIRE_EQUAL(num_vertices(a), num_vertices(b));
  BOOST_CHECK_SMALL(distance_between(a, turned_back(b, 0.3), 1), rounding);
}

BOOST_AUTO_TEST_CASE(up_may_be_any_axis)
{
  const auto& points = small_scan().scan.points;
  Tree a, b;
  pcs::extract_tree_skeleton(points, a);
  pcs::extract_tree_skeleton(
      transformed(points, [](const Point& p) { return Point(p.y(), p.z(), p.x()); }),
      b,
      pcs::parameters::up_direction(Kernel::Vector_3(0, 2e200, 0)));
  for (std::size_t v = 0; v < num_vertices(b); ++v)
    b[v].point = Point(b[v].point.z(), b[v].point.x(), b[v].point.y());
  BOOST_CHECK_SMALL(distance_between(a, b, 1), rounding);
}

BOOST_AUTO_TEST_CASE(outliers_hardly_change_the_result)
{
  std::vector<Point> points = small_scan().scan.points;
  Tree clean, noisy;
  const auto before = pcs::extract_tree_skeleton(points, clean);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-2, 2), z(0, 4);
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n / 100; ++i)
    points.emplace_back(x(random), x(random), z(random));
  points.emplace_back(1000, 0, 50);
  const auto after = pcs::extract_tree_skeleton(points, noisy);
  check_is_a_tree(noisy);
  BOOST_CHECK_CLOSE(after.total.volume, before.total.volume, 3.0);
  BOOST_CHECK_CLOSE(after.total.length, before.total.length, 5.0);
  BOOST_CHECK_LT(after.height, 1.2 * before.height);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_extract_tree_skeleton

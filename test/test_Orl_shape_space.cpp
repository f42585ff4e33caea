// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Laws of the shape space of trees: axioms, midpoints, ends, invariance, extrapolation,
// determinism, errors.

#include <pcs/IO/read_correspondences.h>
#include <pcs/IO/write_correspondences.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/orl_geodesic.h>
#include <support/archetypes.h>
#include <support/drawn.h>
#include <support/exceptions.h>
#include <support/orl_spaces.h>
#include <support/orl_trees.h>
#include <support/threads.h>
#include <support/trees.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>
#include <unistd.h>

namespace test_Orl_shape_space {

using pcs::Branch_emergence;
using pcs::Branch_growth;
using pcs::Matching_weights;
using pcs::Orl_metric;
using pcs::Orl_orientation;
using pcs::Point_path;
using pcs::Transport_options;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;
using pcs_test::message_has;

namespace {

/// Random coordinates on the layout of the space.
Orl_coordinates random_coordinates(const Orl_layout& layout, std::mt19937& random)
{
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  Orl_coordinates x;
  x.root = pcs_test::drawn<Vec3>([&] { return normal(random); });
  for (std::size_t e = 0; e < layout.number_of_edges(); ++e) {
    pcs::Quaternion q(normal(random), normal(random), normal(random), normal(random));
    q.normalize(); // the sign is arbitrary
    x.orientation.push_back(q);
    x.length.push_back(uniform(random) < 0.1 ? 0 : uniform(random));
    x.radius.push_back(0.1 * uniform(random));
  }
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    x.base_radius.push_back(0.1 * uniform(random));
    const std::size_t p = layout.branches[b].parent;
    x.attachment.push_back(
        p == none ? 0 : uniform(random) * static_cast<double>(layout.branches[p].number_of_edges));
  }
  return x;
}

struct Small_space : Space
{
  Small_space() : Space(make_space(random_tree(1, 3, 2), random_tree(2, 3, 2))) {}
};

/// Distance to the sixth neighbour, in units of its median: the 95th percentile.
double unevenness(const std::vector<Point>& points)
{
  std::vector<Vec3> places;
  for (const Point& p : points)
    places.push_back(to_eigen(p));
  const pcs::neighborhood::Nearest_neighbors search(places);
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
  std::vector<double> spacing;
  for (const Vec3& p : places) {
    search(p, 7, found);
    spacing.push_back(std::sqrt(found.back().squared_distance));
  }
  std::sort(spacing.begin(), spacing.end());
  return spacing[spacing.size() * 95 / 100] / spacing[spacing.size() / 2];
}

double worst_end_error(const Space& space,
                       const pcs::Orl_tree& tree,
                       int end,
                       const std::vector<Point>& scan,
                       std::size_t& number_seen)
{
  std::vector<Point> points;
  space.points(tree, points);
  std::vector<std::size_t> source(points.size(), pcs::npos); // several points may have the same
  std::vector<double> error(points.size(), 0);
  space.for_each_point(tree, [&](std::size_t i, std::size_t a, std::size_t b, double) {
    const std::size_t k = end == 0 ? a : b;
    if (k != pcs::npos)
      error[i] = std::sqrt(CGAL::squared_distance(points[i], scan[k]));
  });
  space.for_each_point(tree, [&](std::size_t i, std::size_t a, std::size_t b, double) {
    source[i] = end == 0 ? a : b;
  });
  std::vector<char> is_seen(scan.size(), 0);
  for (const std::size_t k : source)
    if (k != pcs::npos)
      is_seen[k] = 1;
  number_seen = static_cast<std::size_t>(std::count(is_seen.begin(), is_seen.end(), 1));
  return *std::max_element(error.begin(), error.end());
}

} // namespace

BOOST_AUTO_TEST_SUITE(orl_laws)

BOOST_AUTO_TEST_CASE(distances_are_symmetric_and_obey_the_triangle)
{
  const Small_space space;
  std::mt19937 random(1);
  std::size_t number_of_defects = 0;
  for (const Orl_metric metric : {Orl_metric::sum, Orl_metric::square, Orl_metric::cone})
    for (int i = 0; i < 3334; ++i) {
      const auto x = random_coordinates(space.family().layout, random);
      const auto y = random_coordinates(space.family().layout, random);
      const auto z = random_coordinates(space.family().layout, random);
      const double xy = distance(x, y, space.family().weights, metric);
      const double yz = distance(y, z, space.family().weights, metric);
      const double xz = distance(x, z, space.family().weights, metric);
      if (distance(x, x, space.family().weights, metric) != 0 || xy <= 0 ||
          std::abs(xy - distance(y, x, space.family().weights, metric)) > 1e-12 * xy ||
          xz > (xy + yz) * (1 + 1e-12))
        ++number_of_defects;
    }
  BOOST_TEST(number_of_defects == 0u);
}

BOOST_AUTO_TEST_CASE(the_path_has_constant_speed_whatever_the_signs_of_quaternions)
{
  const Small_space space;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Orl_metric metric : {Orl_metric::sum, Orl_metric::square})
    for (int i = 0; i < 20; ++i) {
      const auto x = random_coordinates(space.family().layout, random);
      const auto y = random_coordinates(space.family().layout, random);
      const double d = distance(x, y, space.family().weights, metric);
      Orl_coordinates p, q;
      const double s = uniform(random), t = i == 0 ? 0.5 : uniform(random);
      coordinates_at(space.family().layout, x, y, s, 1, p);
      coordinates_at(space.family().layout, x, y, t, 1, q);
      BOOST_TEST(std::abs(distance(p, q, space.family().weights, metric) - std::abs(s - t) * d) <=
                 1e-12 * d);
      BOOST_TEST(std::abs(distance(x, q, space.family().weights, metric) - t * d) <= 1e-12 * d);
    }
}

BOOST_AUTO_TEST_CASE(branches_born_in_order_make_a_shortest_path_of_constant_speed)
{
  const Small_space space;
  const auto in_order = np::branch_emergence(Branch_emergence::sequential);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double d = space.distance(Space::Handle(0), Space::Handle(1));
  for (int i = 0; i < 20; ++i) {
    const double s = uniform(random), t = i == 0 ? 0.5 : uniform(random);
    const auto p = space.geodesic(0, 1, s, in_order), q = space.geodesic(0, 1, t, in_order);
    BOOST_TEST(std::abs(space.distance(p, q) - std::abs(s - t) * d) <= 1e-12 * d);
    BOOST_TEST(std::abs(space.distance(space.tree(0), q) - t * d) <= 1e-12 * d);
  }
  for (const double end : {0., 1.})
    BOOST_TEST(space.distance(space.tree(end == 0 ? 0 : 1), space.geodesic(0, 1, end, in_order)) ==
               0);
  // The reverse path is equal.
  BOOST_TEST(space.distance(space.geodesic(0, 1, 0.3, in_order),
                            space.geodesic(1, 0, 0.7, in_order)) <= 1e-12 * d);
}

BOOST_AUTO_TEST_CASE(wood_that_is_born_in_order_stays_and_branches_wait_for_their_parent)
{
  // The trunk grows from 1 to 3, with a branch of 0.8 at 2, and a twig of 0.3 at the middle of the
  // branch.
  const auto rows = [](bool is_old) {
    std::vector<pcs_test::Row> r{{pcs::npos, 0, 0, 0, 0, 0.1}, {0, 0, 0, 0, 1, 0.1}};
    if (is_old)
      r.insert(r.end(),
               {{1, 0, 0, 0, 2, 0.1},
                {2, 0, 0, 0, 3, 0.1},
                {2, 1, 0.4, 0, 2, 0.05},
                {4, 1, 0.8, 0, 2, 0.05},
                {4, 2, 0.4, 0.3, 2, 0.02}});
    return pcs_test::make_tree<Kernel>(r);
  };
  Matching_weights weights;
  weights.growth = Branch_growth::at_tips;
  Space space;
  space.add_skeleton(rows(false));
  space.add_skeleton(rows(true));
  space.build(np::matching_weights(weights));
  const double born = 3.1;
  double number_of_branches = 0;
  for (int k = 1; k < 40; ++k) {
    const double lambda = k / 40.;
    pcs::Tree_skeleton<Kernel> tree;
    space.skeleton(space.geodesic(0, 1, lambda, np::branch_emergence(Branch_emergence::sequential)),
                   tree);
    double length = 0, top = 0, side = 0, twig = 0;
    for (const auto e : boost::make_iterator_range(edges(tree)))
      length +=
          (to_eigen(tree[target(e, tree)].point) - to_eigen(tree[source(e, tree)].point)).norm();
    for (const auto v : boost::make_iterator_range(vertices(tree))) {
      const Vec3 p = to_eigen(tree[v].point);
      top = std::max(top, p.z());
      side = std::max(side, p.x());
      twig = std::max(twig, p.y());
      // All nodes lie on the axes of the old tree.
      BOOST_TEST(std::min({p.head<2>().norm(),
                           std::hypot(p.y(), p.z() - 2),
                           std::hypot(p.x() - 0.4, p.z() - 2)}) < 1e-9);
    }
    BOOST_TEST(std::abs(length - (1 + lambda * born)) < 1e-9);
    BOOST_TEST((side > 0) == (top > 2 + 1e-12));
    BOOST_TEST((twig > 0) == (side > 0.4 + 1e-12));
    if (top > 2)
      BOOST_TEST(std::abs(side - 0.8 * (top - 2)) < 1e-9); // grows while the trunk grows by 1
    const double now = 1 + (side > 0 ? 1 : 0) + (twig > 0 ? 1 : 0);
    BOOST_TEST(now >= number_of_branches);
    number_of_branches = now;
  }
  BOOST_TEST(number_of_branches == 3);
  // Simultaneous growth: the branch exists from the beginning.
  pcs::Tree_skeleton<Kernel> tree;
  space.skeleton(space.geodesic(0, 1, 0.1), tree);
  double side = 0;
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    side = std::max(side, to_eigen(tree[v].point).x());
  BOOST_TEST(std::abs(side - 0.08) < 1e-9);
}

BOOST_AUTO_TEST_CASE(the_ends_of_the_path_are_the_inputs)
{
  const Tree a = random_tree(3),
             b = moved(random_tree(4), Eigen::Matrix3d::Identity(), {1e3, 2, 3});
  const std::vector<Point> scans[2] = {tube_points(a, 6000, 5), tube_points(b, 4000, 6)};
  Space space;
  space.add(a, scans[0]);
  space.add(b, scans[1]);
  const auto report = space.build();
  BOOST_TEST((report.status == pcs::Status::converged));
  BOOST_TEST(report.worst_marginal_violation < 1e-9);
  for (int end = 0; end < 2; ++end) {
    const pcs::Orl_tree tree = space.tree(static_cast<std::size_t>(end));
    std::size_t number_seen = 0;
    BOOST_TEST(worst_end_error(space, tree, end, scans[end], number_seen) < 1e-12 * 1e3);
    BOOST_TEST(number_seen == scans[end].size());
    // Every node of the input is a node of the output.
    Tree out;
    space.skeleton(tree, out);
    const Tree& in = end == 0 ? a : b;
    for (const auto v : boost::make_iterator_range(vertices(in))) {
      double least = 1e300;
      for (const auto w : boost::make_iterator_range(vertices(out)))
        least = std::min(least, CGAL::squared_distance(in[v].point, out[w].point));
      BOOST_TEST(std::sqrt(least) < 1e-12 * 1e3);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_skeleton_is_written_to_any_mutable_graph)
{
  // Vertices of a list have no index.
  struct Place
  {
    Point point;
    float radius = 0;
    int branch = -1;
  };
  using Graph = boost::adjacency_list<boost::listS, boost::listS, boost::bidirectionalS, Place>;
  const Tree a = random_tree(71, 4, 2), b = random_tree(72, 4, 2);
  Space space;
  space.add_skeleton(a);
  space.add_skeleton(b);
  space.build();
  const pcs::Orl_tree middle = space.geodesic(0, 1, 0.5);
  Tree expected;
  space.skeleton(middle, expected);
  const auto check = [&](const Graph& graph) {
    BOOST_TEST_REQUIRE(num_vertices(graph) == num_vertices(expected));
    BOOST_TEST(num_edges(graph) == num_edges(expected));
    std::vector<Graph::vertex_descriptor> vertex;
    for (auto [v, end] = vertices(graph); v != end; ++v)
      vertex.push_back(*v);
    for (std::size_t k = 0; k < vertex.size(); ++k) {
      BOOST_TEST((graph[vertex[k]].point == expected[k].point));
      BOOST_TEST(graph[vertex[k]].radius == static_cast<float>(expected[k].radius));
      BOOST_TEST(graph[vertex[k]].branch == static_cast<int>(expected[k].branch));
    }
    for (auto [e, end] = edges(expected); e != end; ++e)
      BOOST_TEST(edge(vertex[source(*e, expected)], vertex[target(*e, expected)], graph).second);
  };
  Graph graph(3); // its contents are replaced
  const auto maps = [](Graph& g) {
    return np::node_point_map(get(&Place::point, g))
        .node_radius_map(get(&Place::radius, g))
        .node_branch_map(get(&Place::branch, g));
  };
  space.skeleton(middle, graph, maps(graph));
  check(graph);
  Graph other;
  std::vector<Point> points;
  pcs::orl_geodesic(a,
                    std::vector<Point>(),
                    b,
                    std::vector<Point>(),
                    0.5,
                    other,
                    points,
                    maps(other));
  check(other);
}

BOOST_AUTO_TEST_CASE(the_report_tells_what_had_no_room_in_the_other_scan)
{
  const Tree tree = random_tree(3);
  const std::vector<Point> scan = tube_points(tree, 6000, 5);
  std::vector<Point> side; // points that are visible from one side
  for (const Point& p : tube_points(tree, 6000, 6))
    if (p.x() > 0)
      side.push_back(p);
  const auto remaining = [&](const std::vector<Point>& other, double reach) {
    Space space;
    space.add(tree, scan);
    space.add(tree, other);
    Transport_options transport;
    transport.reach = reach;
    const auto report = space.build(np::transport_options(transport));
    BOOST_TEST(report.worst_marginal_violation < 1e-9);
    BOOST_TEST(report.number_of_failed_windows == 0u);
    return report.untransported_mass_share;
  };
  BOOST_TEST(remaining(scan, 3) < 1e-12);
  BOOST_TEST(remaining(side, 3) > 0.05);
  BOOST_TEST(remaining(side, 3) < 0.9);
  BOOST_TEST(remaining(side, std::numeric_limits<double>::infinity()) == 0);
}

BOOST_AUTO_TEST_CASE(at_the_origin_the_ends_are_exact_to_the_last_digits)
{
  const Tree a = random_tree(63), b = random_tree(64); // 10 units high
  const std::vector<Point> scans[2] = {tube_points(a, 3000, 5), tube_points(b, 4000, 6)};
  Space space;
  space.add(a, scans[0]);
  space.add(b, scans[1]);
  space.build();
  for (int end = 0; end < 2; ++end) {
    std::size_t number_seen = 0; // the largest error bounds the root mean square
    BOOST_TEST(worst_end_error(space, space.geodesic(0, 1, end), end, scans[end], number_seen) <=
               1e-12 * 10);
    BOOST_TEST(number_seen == scans[end].size());
  }
}

BOOST_AUTO_TEST_CASE(turning_and_moving_both_trees_turns_and_moves_the_path)
{
  std::mt19937 random(77);
  std::normal_distribution<double> normal;
  for (unsigned seed = 7; seed < 11; ++seed) {
    const Tree a = random_tree(seed), b = random_tree(seed + 100);
    const std::vector<Point> scan_a = tube_points(a, 1000, 1), scan_b = tube_points(b, 1500, 2);
    const Vec3 axis = pcs_test::drawn<Vec3>([&] { return normal(random); });
    const Eigen::Matrix3d r =
        Eigen::AngleAxisd(2 * normal(random), axis.normalized()).toRotationMatrix();
    const double scale = seed % 2 == 0 ? 1 : 100;
    const Vec3 shift = seed < 9 ? Vec3(5, -3, 2) : Vec3(5e6, -3e6, 0);
    const auto move = [&](const Point& p) { return to_cgal(scale * (r * to_eigen(p)) + shift); };
    std::vector<Point> moved_a, moved_b;
    std::transform(scan_a.begin(), scan_a.end(), std::back_inserter(moved_a), move);
    std::transform(scan_b.begin(), scan_b.end(), std::back_inserter(moved_b), move);
    Space space, other;
    space.add(a, scan_a);
    space.add(b, scan_b);
    other.add(moved(a, r, shift, scale), moved_a);
    other.add(moved(b, r, shift, scale), moved_b);
    space.build();
    other.build();
    BOOST_TEST_CONTEXT("seed " << seed)
    {
      const auto one = space.matches(), two = other.matches();
      BOOST_TEST_REQUIRE(one.size() == two.size());
      bool is_same = true;
      for (std::size_t k = 0; k < one.size(); ++k)
        is_same = is_same && one[k].tip == two[k].tip;
      BOOST_TEST(is_same);
      // coordinates near 5e6 are rounded to 1e-9; the directions of short edges amplify rounding
      const double tolerance = seed < 9 ? 1e-9 : 1e-7, d = space.distance(0, 1);
      BOOST_TEST(std::abs(other.distance(0, 1) - scale * d) <= tolerance * scale * d);
      std::vector<Point> points, moved_points;
      space.points(space.geodesic(0, 1, 0.3), points);
      other.points(other.geodesic(0, 1, 0.3), moved_points);
      BOOST_TEST_REQUIRE(points.size() == moved_points.size());
      std::size_t number_off = 0;
      for (std::size_t k = 0; k < points.size(); ++k)
        if (!(std::sqrt(CGAL::squared_distance(move(points[k]), moved_points[k])) <=
              10 * tolerance * scale))
          ++number_off;
      // Rounding of the input may change the partner of a point if two partners have equal costs.
      BOOST_TEST(number_off <= (seed < 9 ? 0 : points.size() / 500));
    }
  }
}

BOOST_AUTO_TEST_CASE(a_shift_without_rounding_changes_nothing)
{
  const Vec3 shift(5e6, -3e6, 7e5);
  const auto rounded = [](const Point& p) {
    constexpr double unit = 1.0 / (1 << 20); // differences and sums with `shift` are exact
    return Point(unit * std::round(p.x() / unit),
                 unit * std::round(p.y() / unit),
                 unit * std::round(p.z() / unit));
  };
  const auto move = [&](const Point& p) { return to_cgal(to_eigen(p) + shift); };
  for (unsigned seed = 7; seed < 11; ++seed) {
    Space space, other;
    std::array<std::vector<Point>, 2> scans;
    for (const unsigned t : {0u, 1u}) {
      Tree tree = random_tree(seed + 100 * t);
      std::vector<Point> moved_scan, &scan = scans[t];
      for (const Point& p : tube_points(tree, 1000 + 500 * t, t)) {
        scan.push_back(rounded(p));
        moved_scan.push_back(move(scan.back()));
      }
      for (std::size_t v = 0; v < num_vertices(tree); ++v)
        tree[v].point = rounded(tree[v].point);
      space.add(tree, scan);
      other.add(moved(tree, Eigen::Matrix3d::Identity(), shift), moved_scan);
    }
    space.build();
    other.build();
    BOOST_TEST(space.distance(0, 1) == other.distance(0, 1));
    const auto one = space.correspondences(), two = other.correspondences();
    BOOST_TEST_REQUIRE(one.pairs.size() == two.pairs.size());
    BOOST_TEST(one.pairs.size() >= scans[1].size());
    bool is_same = true;
    for (std::size_t k = 0; k < one.pairs.size(); ++k)
      is_same = is_same && one.pairs[k].edge == two.pairs[k].edge &&
                one.pairs[k].point == two.pairs[k].point;
    BOOST_TEST(is_same);
    std::vector<Point> points, moved_points;
    space.points(space.geodesic(0, 1, 0.3), points);
    other.points(other.geodesic(0, 1, 0.3), moved_points);
    for (std::size_t k = 0; k < points.size(); ++k)
      is_same = is_same && move(points[k]) == moved_points[k];
    BOOST_TEST(is_same);
  }
}

BOOST_AUTO_TEST_CASE(a_tree_turned_as_a_whole_is_as_far_away_as_it_was_turned)
{
  const Tree a = random_tree(9);
  const double angle = CGAL_PI / 3;
  const Tree b = moved(a, Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix(), {0, 0, 0});
  Space space;
  space.add_skeleton(a);
  space.add_skeleton(b);
  space.build(np::do_use_unit_weights(true));
  BOOST_TEST(std::abs(space.distance(0, 1) - angle) < 1e-6);
  // Control: relative to the axes of the input, nearly every edge contributes.
  Space world;
  world.add_skeleton(a);
  world.add_skeleton(b);
  world.build(np::do_use_unit_weights(true).orientation(Orl_orientation::world_axes));
  BOOST_TEST(world.distance(0, 1) > 10 * angle);
}

BOOST_AUTO_TEST_CASE(a_branch_that_is_turned_keeps_its_lengths_and_costs_its_angle)
{
  const std::vector<Branch> branches = random_branches(10, 4, 3);
  const std::vector<char> all(branches.size(), 1);
  Turns turns(branches.size(), Eigen::Matrix3d::Identity());
  std::vector<std::size_t> tip_a, tip_b;
  const Tree a = make_tree(branches, turns, all, tip_a);
  for (const double degrees : {10., 30., 60., 90., 120., 150., 170.}) {
    const double angle = degrees * CGAL_PI / 180;
    turns[2] = Eigen::AngleAxisd(angle, Vec3(1, 0.3, 0.2).normalized()).toRotationMatrix();
    const Tree b = make_tree(branches, turns, all, tip_b);
    // The correspondence is known, and is not computed.
    Space space = make_space(a, a);
    pcs::Orl_correspondences known = space.correspondences();
    Space turned;
    turned.add_skeleton(a);
    turned.add_skeleton(b);
    turned.build();
    known.fingerprint = turned.correspondences().fingerprint;
    turned.build_from(known, np::do_use_unit_weights(true));
    BOOST_TEST_CONTEXT(degrees << " degrees")
    {
      BOOST_TEST(std::abs(turned.distance(0, 1) - angle) < 1e-6);
      const auto end = turned.tree(0), middle = turned.geodesic(0, 1, 0.5);
      double worst = 0;
      std::size_t number_turned =
          0; // angles between all other edges and their parents are unchanged
      for (std::size_t e = 0; e < turned.family().layout.number_of_edges(); ++e) {
        worst =
            std::max(worst, std::abs(end.coordinates().length[e] - middle.coordinates().length[e]));
        const double half =
            angle_between(end.coordinates().orientation[e], middle.coordinates().orientation[e]);
        number_turned += half > 1e-7 ? 1 : 0;
        BOOST_TEST((half <= 1e-7 || std::abs(half - 0.5 * angle) < 1e-6));
      }
      BOOST_TEST(worst < 1e-12);
      BOOST_TEST(number_turned == 1u);
      // Control: linear interpolation of a vector across the axis would shorten it to cos(angle /
      // 2).
      const Vec3 across = turns[2].transpose() * Vec3(0.3, -1, 0);
      BOOST_TEST(std::abs((0.5 * (across + turns[2] * across)).norm() / across.norm() -
                          std::cos(0.5 * angle)) < 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(noise_of_an_axis_does_not_turn_what_is_behind_it)
{
  // Unrelated perturbations, followed by the same straight end. Half-way, the end is upright, too.
  const auto wiggly = [](unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Vec3> nodes{Vec3::Zero()};
    for (int k = 0; k < 24; ++k)
      nodes.push_back(nodes.back() + (Vec3::UnitZ() +
                                      0.7 * pcs_test::drawn<Vec3>([&] {
                                        return normal(random);
                                      })).normalized());
    for (int k = 0; k < 4; ++k)
      nodes.push_back(nodes.back() + 5 * Vec3::UnitZ());
    Tree tree;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      pcs::Tree_node<Kernel> node;
      node.point = to_cgal(nodes[k]);
      node.radius = 0.1;
      const auto v = add_vertex(node, tree);
      if (k > 0)
        add_edge(v - 1, v, tree);
    }
    return tree;
  };
  const auto mean_tilt = [&](Orl_orientation orientation) {
    double result = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
      Space space;
      space.add_skeleton(wiggly(2 * seed));
      space.add_skeleton(wiggly(2 * seed + 1));
      space.build(np::orientation(orientation));
      Tree middle;
      space.skeleton(space.geodesic(0, 1, 0.5), middle);
      const std::size_t n = num_vertices(middle);
      const Vec3 end = to_eigen(middle[n - 1].point) - to_eigen(middle[n - 2].point);
      result += 0.1 * std::acos(std::min(1.0, end.normalized().z()));
    }
    return result;
  };
  BOOST_TEST(mean_tilt(Orl_orientation::gauge_fixed) <
             0.15); // 0.10; 0.54 if each edge referred to the previous one
  // Control: edges refer to the previous one.
  BOOST_TEST(mean_tilt(Orl_orientation::transported) > 0.4);
}

BOOST_AUTO_TEST_CASE(beyond_the_ends_lengths_and_radii_stay_positive)
{
  const Space space = make_space(random_tree(11), random_tree(12));
  for (double lambda = -0.5; lambda <= 1.5; lambda += 0.05) {
    const auto tree = space.geodesic(0, 1, lambda, np::do_limit_radii(true));
    const auto& x = tree.coordinates();
    bool is_right = true;
    for (std::size_t e = 0; e < x.length.size(); ++e)
      is_right = is_right && x.length[e] >= 0 && x.radius[e] >= 0 && std::isfinite(x.length[e]) &&
                 std::isfinite(x.radius[e]) && x.orientation[e].coeffs().allFinite();
    BOOST_TEST(is_right);
    Tree out;
    space.skeleton(tree, out);
    for (const auto e : boost::make_iterator_range(edges(out))) {
      const auto u = source(e, out), v = target(e, out);
      // The first node of a branch lies on the axis behind u, where the parent may be thinner than
      // at u.
      if (out[v].radius > out[u].radius * (1 + 1e-12))
        is_right = false;
    }
    BOOST_TEST(is_right);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_matching)

BOOST_AUTO_TEST_CASE(a_pruned_and_turned_tree_is_matched_to_itself)
{
  double mean = 0, published = 0;
  const int number = 5;
  for (unsigned seed = 0; seed < number; ++seed) {
    const std::vector<Branch> branches = random_branches(100 + seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    Turns turns(branches.size(), Eigen::Matrix3d::Identity());
    const Turns still = turns;
    std::vector<char> all(branches.size(), 1), kept = all;
    for (std::size_t b = 1; b < branches.size(); ++b) {
      turns[b] =
          Eigen::AngleAxisd(0.3 * normal(random),
                            pcs_test::drawn<Vec3>([&] { return normal(random); }).normalized())
              .toRotationMatrix();
      kept[b] = uniform(random) > 0.3;
    }
    std::vector<std::size_t> tip_a, tip_b;
    const Tree a = make_tree(branches, still, all, tip_a);
    const Tree b = make_tree(branches, turns, kept, tip_b);
    for (const bool is_published : {false, true}) {
      Space space;
      space.add_skeleton(a);
      space.add_skeleton(b);
      Matching_weights weights;
      weights.is_published = is_published;
      space.build(np::matching_weights(weights));
      double right = 0, total = 0;
      for (const auto& match : space.matches())
        if (match.tip[1] != pcs::npos) {
          total += 1;
          for (std::size_t k = 0; k < branches.size(); ++k)
            if (tip_b[k] == match.tip[1] && tip_a[k] == match.tip[0])
              right += 1;
        }
      (is_published ? published : mean) += right / total / number;
    }
  }
  BOOST_TEST_MESSAGE("right: " << mean << ", published energy: " << published);
  BOOST_TEST(mean > 0.95);
  BOOST_TEST(mean >= published);
}

BOOST_AUTO_TEST_CASE(growth_at_tips_is_believed_where_it_explains_clearly_more)
{
  int number_of_close_calls = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const auto share = [&](Branch_growth growth, bool& is_at_tips) {
      Matching_weights weights;
      weights.growth = growth;
      Space space;
      space.add_skeleton(random_tree(seed, 4, 3));
      space.add_skeleton(random_tree(seed + 1, 5, 3));
      const pcs::Orl_report report = space.build(np::matching_weights(weights));
      is_at_tips = report.is_grown_at_tips;
      return report.unexplained_fraction;
    };
    bool is_at_tips = true;
    const double along = share(Branch_growth::along_branches, is_at_tips);
    BOOST_TEST(!is_at_tips);
    const double tips = share(Branch_growth::at_tips, is_at_tips);
    BOOST_TEST(is_at_tips);
    const double any = share(Branch_growth::any, is_at_tips);
    BOOST_TEST(is_at_tips == (tips < 2. / 3 * along));
    BOOST_TEST(any == (is_at_tips ? tips : along));
    number_of_close_calls += tips < along && !is_at_tips ? 1 : 0;
  }
  BOOST_TEST(number_of_close_calls > 0);
}

BOOST_AUTO_TEST_CASE(a_bud_that_grew_to_four_times_its_length_is_still_the_same)
{
  // Its position and direction are unchanged, and no other match is possible.
  const std::vector<Branch> grown = random_branches(5, 3, 2);
  std::vector<Branch> young = grown;
  for (Vec3& p : young[2].points)
    p *= 0.22;
  const auto all = [&](const std::vector<Branch>& of, std::vector<std::size_t>& tip) {
    return make_tree(of,
                     Turns(of.size(), Eigen::Matrix3d::Identity()),
                     std::vector<char>(of.size(), 1),
                     tip);
  };
  std::vector<std::size_t> tip_a, tip_b;
  const Tree a = all(young, tip_a), b = all(grown, tip_b);
  for (const bool is_growing : {true, false}) {
    const Space space = is_growing ? make_space(a, b) : make_space(b, a);
    std::size_t right = 0;
    for (const pcs::Branch_match& match : space.matches())
      for (std::size_t k = 0; k < grown.size(); ++k)
        right +=
            match.tip[is_growing ? 0 : 1] == tip_a[k] && match.tip[is_growing ? 1 : 0] == tip_b[k]
                ? 1
                : 0;
    BOOST_TEST(right == grown.size());
  }
}

BOOST_AUTO_TEST_CASE(a_fork_whose_longer_side_changes_keeps_its_branches)
{
  const auto fork = [](double left, double right) {
    std::vector<Branch> branches(3);
    for (int k = 0; k <= 4; ++k) {
      branches[0].points.push_back(Vec3(0, 0, 0.5 * k));
      branches[0].radii.push_back(0.1);
    }
    for (int side = 0; side < 2; ++side) {
      Branch& b = branches[static_cast<std::size_t>(1 + side)];
      b.parent = 0;
      b.at = 4;
      const Vec3 direction = Vec3(side == 0 ? -1 : 1, 0.2 * side, 1.5).normalized();
      for (int k = 0; k <= 4; ++k) {
        b.points.push_back(0.25 * k * (side == 0 ? left : right) * direction);
        b.radii.push_back(0.05);
      }
    }
    return branches;
  };
  std::vector<std::size_t> tip_a, tip_b;
  const Turns still(3, Eigen::Matrix3d::Identity());
  const auto number_kept = [&](double more, std::size_t number_of_paths) {
    const Tree a = make_tree(fork(1, more), still, {1, 1, 1}, tip_a);
    const Tree b = make_tree(fork(more, 1), still, {1, 1, 1}, tip_b);
    Space space;
    space.add_skeleton(a);
    space.add_skeleton(b);
    Matching_weights weights;
    weights.number_of_paths = number_of_paths;
    space.build(np::matching_weights(weights));
    int result = 0;
    for (const auto& match : space.matches())
      result += (match.tip[0] == tip_a[1] && match.tip[1] == tip_b[1]) ||
                        (match.tip[0] == tip_a[2] && match.tip[1] == tip_b[2])
                    ? 1
                    : 0;
    return result;
  };
  for (const double more : {1.02, 1.7}) { // nearly as long, and much shorter
    BOOST_TEST(number_kept(more, 6) == 2);
    BOOST_TEST(number_kept(more, 1) == 0); // control: the longest paths are the trunks
  }
}

BOOST_AUTO_TEST_CASE(the_order_of_vertices_does_not_matter)
{
  const Tree a = random_tree(13), b = random_tree(14);
  const auto reversed = [](const Tree& tree) {
    const std::size_t n = num_vertices(tree);
    Tree result(n);
    for (std::size_t v = 0; v < n; ++v)
      result[n - 1 - v] = tree[v];
    std::vector<std::pair<std::size_t, std::size_t>> list;
    for (const auto e : boost::make_iterator_range(edges(tree)))
      list.emplace_back(n - 1 - source(e, tree), n - 1 - target(e, tree));
    std::reverse(list.begin(), list.end());
    for (const auto& [u, v] : list)
      add_edge(u, v, result);
    return result;
  };
  const auto matches = make_space(a, b).matches();
  const auto others = make_space(reversed(a), reversed(b)).matches();
  const auto as_set =
      [](const std::vector<pcs::Branch_match>& list, std::size_t n, std::size_t m, bool flip) {
        std::set<std::pair<std::size_t, std::size_t>> result;
        for (const auto& match : list)
          result.emplace(flip && match.tip[0] != pcs::npos ? n - 1 - match.tip[0] : match.tip[0],
                         flip && match.tip[1] != pcs::npos ? m - 1 - match.tip[1] : match.tip[1]);
        return result;
      };
  BOOST_TEST(
      (as_set(matches, 0, 0, false) == as_set(others, num_vertices(a), num_vertices(b), true)));
}

BOOST_AUTO_TEST_CASE(the_way_back_has_the_same_branches_and_is_as_long)
{
  for (const unsigned seed : {13u, 23u, 33u}) {
    const Tree a = random_tree(seed), b = random_tree(seed + 1);
    Space there = make_space(a, b), back = make_space(b, a);
    std::set<std::array<std::size_t, 2>> one, two;
    for (const pcs::Branch_match& m : there.matches())
      one.insert(m.tip);
    for (const pcs::Branch_match& m : back.matches())
      two.insert({m.tip[1], m.tip[0]});
    BOOST_TEST((one == two));
    for (const pcs::Branch_match& m : there.matches())
      for (const pcs::Branch_match& n : back.matches())
        if (m.tip[0] == n.tip[1] && m.tip[1] == n.tip[0] && m.tip[0] != pcs::npos &&
            m.tip[1] != pcs::npos)
          BOOST_TEST(std::abs(m.confidence - n.confidence) < 1e-6);
    const double distance = there.distance(0, 1);
    BOOST_TEST(std::abs(back.distance(0, 1) - distance) < 1e-6 * distance);
  }
}

BOOST_AUTO_TEST_CASE(the_way_back_between_trees_of_the_same_lengths_is_as_long)
{
  for (const unsigned seed : {1u, 11u, 17u}) {
    const std::vector<Branch> branches = random_branches(seed, 5, 3);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Turns turns;
    for (std::size_t b = 0; b < branches.size(); ++b) {
      const double angle = 0.5 * normal(random), x = normal(random), y = normal(random);
      turns.push_back(
          Eigen::AngleAxisd(b == 0 ? 0 : angle, Vec3(x, y, 1).normalized()).toRotationMatrix());
    }
    std::vector<std::size_t> tip;
    const Tree a = make_tree(branches);
    const Tree b = make_tree(branches, turns, std::vector<char>(branches.size(), 1), tip);
    const double there = make_space(a, b).distance(0, 1), back = make_space(b, a).distance(0, 1);
    BOOST_TEST(std::abs(there - back) < 1e-9 * there);
  }
}

BOOST_AUTO_TEST_CASE(the_way_back_between_copies_that_stand_differently_is_as_long)
{
  // Lengths do not determine the order.
  Tree star;
  add_vertex(star);
  for (const Vec3& p : {Vec3(0, 0, 1),
                        Vec3(0.6, 0.1, 0.8),
                        Vec3(-0.3, 0.7, 0.4),
                        Vec3(0.2, -0.9, 0.3),
                        Vec3(0.9, 0.2, 0.1),
                        Vec3(-0.8, -0.2, 0.5),
                        Vec3(-0.5, 0.4, 0.9)}) {
    const auto v = add_vertex(star);
    star[v].point = to_cgal(p.normalized());
    add_edge(0, v, star);
  }
  for (const Tree& a : {star, random_tree(3, 4, 3), random_tree(8, 4, 3)})
    for (const Vec3& side : {Vec3(-1, 1, 1), Vec3(-1, -1, 1)}) {
      const Tree b = moved(a, side.asDiagonal().toDenseMatrix(), Vec3::Zero());
      const double there = make_space(a, b).distance(0, 1), back = make_space(b, a).distance(0, 1);
      BOOST_TEST(std::abs(there - back) < 1e-6 * there);
    }
}

BOOST_AUTO_TEST_CASE(a_tree_in_another_unit_is_the_same)
{
  const Tree a = random_tree(15);
  for (const double scale : {1e-6, 0.001, 0.02, 50., 1000., 1e6}) {
    const Tree b = moved(a, Eigen::Matrix3d::Identity(), Vec3::Zero(), scale);
    Space space;
    space.add_skeleton(a);
    space.add_skeleton(b);
    const auto report = space.build();
    BOOST_TEST_CONTEXT("scale " << scale)
    {
      BOOST_TEST(report.unexplained_fraction < 1e-3);
      for (const pcs::Branch_match& m : space.matches())
        BOOST_TEST(m.tip[0] == m.tip[1]);
    }
  }
}

BOOST_AUTO_TEST_CASE(two_trees_in_any_unit_are_the_same)
{
  const Tree a = random_tree(15), b = random_tree(16);
  const Space space = make_space(a, b);
  for (const int power : {-300, -40, 40, 250, 320}) { // 320: about 1e96
    const double scale = std::ldexp(1.0, power);
    const auto scaled = [&](const Tree& tree) {
      return moved(tree, Eigen::Matrix3d::Identity(), Vec3::Zero(), scale);
    };
    const Space other = make_space(scaled(a), scaled(b));
    BOOST_TEST_CONTEXT("2^" << power)
    {
      BOOST_TEST(std::abs(other.distance(0, 1) / scale - space.distance(0, 1)) <
                 1e-6 * space.distance(0, 1));
      const auto one = space.matches(), two = other.matches();
      BOOST_TEST_REQUIRE(one.size() == two.size());
      for (std::size_t k = 0; k < one.size(); ++k)
        BOOST_TEST((one[k].tip == two[k].tip));
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_determinism)

BOOST_AUTO_TEST_CASE(results_do_not_depend_on_the_number_of_threads)
{
  const Tree a = random_tree(15), b = random_tree(16);
  const auto scan_a = tube_points(a, 5000, 1), scan_b = tube_points(b, 7000, 2);
  std::vector<Point> expected;
  {
    pcs::Orl_shape_space<Kernel, CGAL::Sequential_tag> space;
    space.add(a, scan_a);
    space.add(b, scan_b);
    space.build();
    space.points(space.geodesic(0, 1, 0.4), expected);
  }
  for (const int n : pcs_test::thread_counts)
    pcs_test::with_threads(n, [&] {
      Tree tree;
      std::vector<Point> points;
      pcs::orl_geodesic(a, scan_a, b, scan_b, 0.4, tree, points);
      BOOST_TEST((points == expected));
    });
}

BOOST_AUTO_TEST_CASE(calls_in_two_threads_give_the_bits_of_calls_alone)
{
  const Tree a = random_tree(15), b[2] = {random_tree(16), random_tree(17, 3, 2)};
  const auto scan_a = tube_points(a, 3000, 1);
  const std::vector<Point> scan_b[2] = {tube_points(b[0], 3000, 2), tube_points(b[1], 2000, 3)};
  const auto morph = [&](int k) {
    Tree tree;
    std::vector<Point> points;
    pcs::orl_geodesic(a, scan_a, b[k], scan_b[k], 0.4, tree, points);
    for (std::size_t v = 0; v < num_vertices(tree); ++v)
      points.push_back(tree[v].point);
    return points;
  };
  const std::vector<Point> alone[2] = {morph(0), morph(1)};
  BOOST_TEST((alone[0] != alone[1]));
  Space space;
  space.add(a, scan_a);
  space.add(b[0], scan_b[0]);
  space.build();
  std::vector<Point> between;
  space.points(space.geodesic(0, 1, 0.4), between);
  const double distance = space.distance(0, 1);
  for (const bool is_same_input : {false, true}) {
    std::vector<Point> found[2], of_space[2];
    double distances[2] = {0, 0};
    pcs_test::in_two_threads([&](int k) {
      found[k] = morph(is_same_input ? 0 : k);
      space.points(space.geodesic(0, 1, 0.4), of_space[k]);
      distances[k] = space.distance(0, 1);
    });
    for (int k = 0; k < 2; ++k) {
      BOOST_TEST((found[k] == alone[is_same_input ? 0 : k]));
      BOOST_TEST((of_space[k] == between));
      BOOST_TEST(distances[k] == distance);
    }
  }
}

BOOST_AUTO_TEST_CASE(correspondences_of_the_previous_version_have_no_confidence)
{
  const std::string path =
      (std::filesystem::temp_directory_path() / ("pcs_old_" + std::to_string(::getpid()) + ".txt"))
          .string();
  const auto read = [&](const std::string& version, const std::string& confidence) {
    std::ofstream(path) << "pcs_correspondences " << version << "\nnote 0\ntrees 1 2 3 4\n"
                        << "turn 1 0 0 0\nbranches 1\n- " << confidence
                        << "0 1 0 0 2 0 1 0 1 0 0 2 0 1\npairs 0\n";
    return pcs::IO::read_correspondences(path).branches.at(0);
  };
  BOOST_TEST(std::isnan(read("3", "").confidence));
  BOOST_TEST(read("4", "0.25 ").confidence == 0.25);
  BOOST_TEST(read("4", "0.25 ").nodes[1].back() == 1);
  BOOST_CHECK_EXCEPTION(read("5", "0.25 "), pcs::IO_error, message_has("expected '3' or '4'"));
  std::filesystem::remove(path);
}

BOOST_AUTO_TEST_CASE(correspondences_survive_a_file)
{
  const Tree a = random_tree(17), b = random_tree(18);
  const auto scan_a = tube_points(a, 3000, 1), scan_b = tube_points(b, 2000, 2);
  Space space;
  space.add(a, scan_a);
  space.add(b, scan_b);
  space.build();
  const std::string path =
      (std::filesystem::temp_directory_path() / ("pcs_orl_" + std::to_string(::getpid()) + ".txt"))
          .string();
  pcs::Orl_correspondences noted = space.correspondences();
  noted.note = " matched  by\nnight ";
  pcs::IO::write_correspondences(path, noted);
  BOOST_TEST(pcs::IO::read_correspondences(path).note == "matched by night");
  Space again;
  again.add(a, scan_a);
  again.add(b, scan_b);
  again.build_from(pcs::IO::read_correspondences(path));
  std::filesystem::remove(path);
  const auto matches = space.matches(), stored_matches = again.matches();
  BOOST_TEST_REQUIRE(stored_matches.size() == matches.size());
  std::size_t number_of_confidences = 0;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    BOOST_TEST((stored_matches[m].confidence == matches[m].confidence ||
                (std::isnan(stored_matches[m].confidence) && std::isnan(matches[m].confidence))));
    number_of_confidences += std::isfinite(matches[m].confidence) ? 1 : 0;
  }
  BOOST_TEST(number_of_confidences > 0u);
  std::vector<Point> one, two;
  space.points(space.geodesic(0, 1, 0.7), one);
  again.points(again.geodesic(0, 1, 0.7), two);
  BOOST_TEST((one == two));

  Space other;
  other.add(b, scan_b);
  other.add(a, scan_a);
  BOOST_CHECK_EXCEPTION(other.build_from(space.correspondences()),
                        pcs::Invalid_input,
                        message_has("other trees"));
  Space bare, mixed;
  bare.add_skeleton(a);
  bare.add_skeleton(b);
  bare.build_from(space.correspondences());
  BOOST_TEST(bare.distance(0, 1) == space.distance(0, 1));
  BOOST_TEST(!bare.has_points());
  mixed.add(a, scan_a);
  mixed.add(b, scan_a);
  BOOST_CHECK_EXCEPTION(mixed.build_from(space.correspondences()),
                        pcs::Invalid_input,
                        message_has("other points"));
  auto broken = space.correspondences();
  broken.pairs.back().point[0] = 1000000;
  BOOST_CHECK_THROW(again.build_from(broken), pcs::Invalid_input);
  broken = space.correspondences();
  broken.branches[0].confidence = 1.5;
  BOOST_CHECK_THROW(again.build_from(broken), pcs::Invalid_input);
  broken = space.correspondences();
  broken.branches.back().parent = broken.branches.size();
  BOOST_CHECK_THROW(again.build_from(broken), pcs::Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_points)

BOOST_AUTO_TEST_CASE(points_stay_at_the_surface_and_evenly_spread)
{
  const Tree a = random_tree(19, 4, 2), b = random_tree(20, 4, 2);
  const auto scan_a = tube_points(a, 20000, 1), scan_b = tube_points(b, 20000, 2);
  Space space;
  space.add(a, scan_a);
  space.add(b, scan_b);
  space.build();
  for (const double lambda : {0.25, 0.5, 0.75}) {
    const auto tree = space.geodesic(0, 1, lambda);
    std::vector<Point> points;
    space.points(tree, points);
    Tree skeleton;
    space.skeleton(tree, skeleton);
    std::size_t number_far = 0;
    for (const Point& p : points) {
      double least = 1e300; // distance from the axis in radii
      for (const auto e : boost::make_iterator_range(edges(skeleton))) {
        const auto &u = skeleton[source(e, skeleton)], &v = skeleton[target(e, skeleton)];
        const Vec3 from = to_eigen(u.point), axis = to_eigen(v.point) - from;
        if (axis.squaredNorm() == 0)
          continue;
        const double t = std::clamp((to_eigen(p) - from).dot(axis) / axis.squaredNorm(), 0., 1.);
        const double r = (1 - t) * u.radius + t * v.radius;
        least = std::min(least, (to_eigen(p) - from - t * axis).norm() / r);
      }
      number_far += least > 1.2 ? 1 : 0;
    }
    BOOST_TEST(number_far == 0u);
    BOOST_TEST(unevenness(points) <= 2 * std::max(unevenness(scan_a), unevenness(scan_b)));
  }
}

BOOST_AUTO_TEST_CASE(sections_keep_their_size_where_virtual_edges_shrink_them)
{
  // A straight branch, and the same branch rotated about its axis by a quarter turn in the pairing
  // of its points.
  std::vector<Branch> branches(1);
  for (int k = 0; k <= 1; ++k) {
    branches[0].points.push_back(Vec3(0, 0, 10 * k));
    branches[0].radii.push_back(1);
  }
  const Tree tree = make_tree(branches);
  const std::vector<Point> one{Point(1, 0, 9)}, two{Point(0, 1, 9)};
  Space space;
  space.add(tree, one);
  space.add(tree, two);
  space.build();
  std::vector<Point> points;
  const auto middle = space.geodesic(0, 1, 0.5);
  space.points(middle, points);
  BOOST_TEST_REQUIRE(points.size() == 1u);
  BOOST_TEST(std::abs(std::hypot(points[0].x(), points[0].y()) - 1) < 1e-12);
  space.points(middle, points, np::point_path(Point_path::virtual_edges));
  BOOST_TEST(std::hypot(points[0].x(), points[0].y()) < 0.75);
}

BOOST_AUTO_TEST_CASE(normals_without_a_direction_are_refused)
{
  using Oriented = std::pair<Point, Kernel::Vector_3>;
  const auto maps = pcs::parameters::point_map(CGAL::First_of_pair_property_map<Oriented>())
                        .normal_map(CGAL::Second_of_pair_property_map<Oriented>());
  const auto tree = pcs_test::make_small_tree<Kernel>();
  std::vector<Oriented> scan(3, Oriented(Point(0, 0, 1), Kernel::Vector_3(0, 0, 1)));
  for (const double z : {0.0, std::numeric_limits<double>::infinity()}) {
    scan[1].second = Kernel::Vector_3(0, 0, z);
    pcs::Orl_shape_space<> space;
    BOOST_CHECK_EXCEPTION(space.add(tree, scan, maps),
                          pcs::Invalid_input,
                          pcs_test::message_has("the normal of point 1 is null or not finite"));
  }
}

BOOST_AUTO_TEST_CASE(normals_follow_their_edges)
{
  const Tree a = random_tree(21, 3, 2);
  const Eigen::Matrix3d r = Eigen::AngleAxisd(0.8, Vec3::UnitX()).toRotationMatrix();
  const Tree b = moved(a, r, {0, 0, 0});
  using Oriented = std::pair<Point, Kernel::Vector_3>;
  std::vector<Oriented> scan_a, scan_b;
  for (const Point& p : tube_points(a, 2000, 3)) {
    scan_a.emplace_back(p, Kernel::Vector_3(p.x() + 1, p.y(), 1));
    const Vec3 q = r * to_eigen(p), n = r * Vec3(p.x() + 1, p.y(), 1);
    scan_b.emplace_back(to_cgal(q), Kernel::Vector_3(n.x(), n.y(), n.z()));
  }
  const auto maps = np::point_map(CGAL::First_of_pair_property_map<Oriented>())
                        .normal_map(CGAL::Second_of_pair_property_map<Oriented>());
  Space space;
  space.add(a, scan_a, maps);
  space.add(b, scan_b, maps);
  space.build();
  std::vector<Oriented> points;
  const auto end = space.tree(1);
  space.points(end, points, maps);
  std::vector<double> error(points.size());
  space.for_each_point(end, [&](std::size_t i, std::size_t, std::size_t k, double) {
    const Kernel::Vector_3 n = scan_b[k].second;
    error[i] = std::sqrt((points[i].second - n / std::sqrt(n.squared_length())).squared_length());
  });
  BOOST_TEST(*std::max_element(error.begin(), error.end()) < 1e-12);

  // Published virtual edges [Aiteanu 2022], and a scan without points.
  Space half;
  half.add(a, scan_a, maps);
  half.add(b, std::vector<Oriented>(), maps);
  half.build();
  BOOST_TEST(half.has_normals());
  for (const Space* s : {&space, &half})
    for (const Point_path path : {Point_path::cylindrical, Point_path::virtual_edges}) {
      const auto middle = s->geodesic(0, 1, 0.5);
      s->points(middle, points, maps.point_path(path));
      const Eigen::Matrix3d half_way = Eigen::AngleAxisd(0.4, Vec3::UnitX()).toRotationMatrix();
      std::vector<double> away(points.size(), 0);
      s->for_each_point(middle, [&](std::size_t i, std::size_t k, std::size_t, double) {
        const Kernel::Vector_3 from = scan_a[k].second, to = points[i].second;
        const Vec3 n = half_way * Vec3(from.x(), from.y(), from.z()).normalized();
        away[i] = (n - Vec3(to.x(), to.y(), to.z())).norm();
      });
      BOOST_TEST(*std::max_element(away.begin(), away.end()) < 1e-6);
    }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_errors)

BOOST_AUTO_TEST_CASE(a_refused_tree_leaves_a_built_space_unchanged)
{
  Space space = make_space(random_tree(22, 2, 2), random_tree(23, 2, 2));
  const double before = space.distance(0, 1);
  BOOST_CHECK_THROW(space.add_skeleton(Tree(1)), pcs::Invalid_input);
  BOOST_TEST_REQUIRE(space.number_of_trees() == 2u);
  BOOST_TEST(space.distance(0, 1) == before);
  BOOST_TEST(before > 0);
}

BOOST_AUTO_TEST_CASE(broken_trees_are_refused_with_a_reason)
{
  Space space;
  const auto refuse = [&](const Tree& tree, const char* word) {
    BOOST_CHECK_EXCEPTION(space.add_skeleton(tree), pcs::Invalid_input, message_has(word));
  };
  refuse(Tree(), "0 nodes");
  refuse(Tree(1), "1 nodes");
  Tree two_roots(3);
  add_edge(0, 1, two_roots);
  refuse(two_roots, "without parent");
  Tree cycle(3);
  add_edge(0, 1, cycle);
  add_edge(1, 2, cycle);
  add_edge(2, 0, cycle);
  refuse(cycle, "no root");
  Tree two_parents(3);
  add_edge(0, 1, two_parents);
  add_edge(0, 2, two_parents);
  add_edge(2, 1, two_parents);
  refuse(two_parents, "two parents");
  Tree in_one_place(2);
  add_edge(0, 1, in_one_place);
  refuse(in_one_place, "span");
  Tree good = random_tree(22, 2, 2), bad = good;
  bad[3].point = Point(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  refuse(bad, "node 3");
  bad = good;
  bad[2].radius = -1;
  refuse(bad, "radius of node 2");
  // finite, but their squares are not
  bad = good;
  bad[2].radius = 1e300;
  refuse(bad, "radius of node 2");
  bad = good;
  bad[3].point = Point(1e200, 0, 0);
  refuse(bad, "span");
  BOOST_CHECK_EXCEPTION(space.add(good, std::vector<Point>{Point(0, 0, -1e200)}),
                        pcs::Invalid_input,
                        message_has("point 0"));
  BOOST_CHECK_EXCEPTION(
      space.add(good, std::vector<Point>{Point(0, 0, std::numeric_limits<double>::infinity())}),
      pcs::Invalid_input,
      message_has("point 0"));
  BOOST_CHECK_EXCEPTION(space.build(), pcs::Invalid_input, message_has("0 trees"));
  space.add_skeleton(good);
  BOOST_CHECK_EXCEPTION(space.build(), pcs::Invalid_input, message_has("1 trees"));
  space.add_skeleton(good);
  BOOST_CHECK_EXCEPTION(space.tree(0), pcs::Invalid_input, message_has("build()"));
  space.build();
  BOOST_CHECK_THROW(space.geodesic(0, 2, 0.5), pcs::Invalid_input);
  BOOST_CHECK_THROW(space.geodesic(0, 1, std::numeric_limits<double>::quiet_NaN()),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(space.geodesic(0, 0, std::numeric_limits<double>::quiet_NaN()),
                    pcs::Invalid_input);
  BOOST_TEST(space.distance(0, 1) < 1e-9);
  Matching_weights weights;
  weights.half_cost_distance = std::numeric_limits<double>::infinity(); // cannot be saved
  BOOST_CHECK_EXCEPTION(space.build(np::matching_weights(weights)),
                        pcs::Invalid_input,
                        message_has("half_cost_distance"));
  for (const double reach : {0., -1., std::numeric_limits<double>::quiet_NaN()}) {
    Transport_options transport;
    transport.reach = reach;
    BOOST_CHECK_EXCEPTION(space.build(np::transport_options(transport)),
                          pcs::Invalid_input,
                          message_has("reach"));
  }
}

BOOST_AUTO_TEST_CASE(trees_of_other_spaces_and_spaces_that_were_moved_are_refused)
{
  const auto same = [](std::size_t n) {
    Space space;
    for (std::size_t k = 0; k < n; ++k)
      space.add_skeleton(random_tree(22, 2, 2));
    space.build();
    return space;
  };
  const Space other = make_space(random_tree(23, 3, 2), random_tree(24, 3, 2)), four = same(4);
  Space three = same(3);
  BOOST_TEST(three.family().layout.number_of_edges() == four.family().layout.number_of_edges());
  const auto own = three.tree(0);
  for (const pcs::Orl_tree& strange : {other.tree(0), four.tree(3), pcs::Orl_tree()}) {
    BOOST_CHECK_EXCEPTION(three.geodesic(own, strange, 0.5),
                          pcs::Invalid_input,
                          message_has("another space"));
    BOOST_CHECK_EXCEPTION(three.geodesic(strange, own, 0.5),
                          pcs::Invalid_input,
                          message_has("another space"));
  }
  const Space to = std::move(three);
  BOOST_CHECK_EXCEPTION(three.embed(random_tree(22, 2, 2)),
                        pcs::Invalid_input,
                        message_has("build()"));
  BOOST_CHECK_EXCEPTION(three.data(), pcs::Invalid_input, message_has("build()"));
  BOOST_TEST(to.distance(0, 2) < 1e-9);
}

BOOST_AUTO_TEST_CASE(a_tree_of_one_edge_and_points_far_away_are_no_trouble)
{
  Tree edge(2);
  edge[1].point = Point(0, 0, 1);
  add_edge(0, 1, edge);
  const std::vector<Point> scan{Point(0, 0, 0), Point(0, 0, 0), Point(100, 0, 0), Point(0, 0, 0.5)};
  Tree out;
  std::vector<Point> points;
  const Tree other = random_tree(23);
  const auto report =
      pcs::orl_geodesic(edge, scan, other, tube_points(other, 100, 1), 0.5, out, points);
  BOOST_TEST((report.status == pcs::Status::converged));
  for (const Point& p : points)
    BOOST_TEST(to_eigen(p).allFinite());
}

BOOST_AUTO_TEST_CASE(stems_may_part_at_the_root)
{
  Tree bush(5);
  const double x[] = {0, 1, 2, -1, 0}, z[] = {0, 2, 4, 2, 3};
  for (std::size_t v = 0; v < 5; ++v) {
    bush[v].point = Point(x[v], 0, z[v]);
    bush[v].radius = 0.1;
  }
  add_edge(0, 1, bush);
  add_edge(1, 2, bush);
  add_edge(0, 3, bush);
  add_edge(0, 4, bush);
  const Tree other = random_tree(26, 3, 2);
  for (const bool is_first : {true, false}) {
    const Space space = is_first ? make_space(bush, other) : make_space(other, bush);
    std::size_t number = 0;
    for (const auto& m : space.matches())
      number += m.tip[is_first ? 0 : 1] != pcs::npos ? 1 : 0;
    BOOST_TEST(number == 3u);
    Tree out;
    space.skeleton(space.tree(is_first ? 0 : 1), out);
    BOOST_TEST(out[boost::graph_bundle].branches.size() == 3u);
    Space again;
    again.add_skeleton(is_first ? bush : other);
    again.add_skeleton(is_first ? other : bush);
    again.build_from(space.correspondences());
    BOOST_TEST(again.distance(0, 1) == space.distance(0, 1));
  }
}

BOOST_AUTO_TEST_CASE(cancelling_leaves_outputs_and_the_space_as_they_were)
{
  const Tree a = random_tree(24), b = random_tree(25);
  const auto scan = tube_points(a, 1000, 1);
  int calls = 0;
  Tree ignored;
  std::vector<Point> ignored_points;
  pcs::orl_geodesic(a, scan, b, scan, 0.5, ignored, ignored_points, np::callback([&](double) {
                      return ++calls > 0;
                    }));
  BOOST_TEST(calls > 3);
  for (int stop = 1; stop <= calls; ++stop) {
    int count = 0;
    double last = 0;
    bool is_monotone = true;
    Tree out(1);
    std::vector<Point> points{Point(7, 7, 7)};
    const auto report =
        pcs::orl_geodesic(a, scan, b, scan, 0.5, out, points, np::callback([&](double f) {
                            is_monotone = is_monotone && f >= last && f <= 1;
                            last = f;
                            return ++count < stop;
                          }));
    BOOST_TEST(is_monotone);
    if (report.status == pcs::Status::cancelled) {
      BOOST_TEST(num_vertices(out) == 1u);
      BOOST_TEST((points == std::vector<Point>{Point(7, 7, 7)}));
    } else
      BOOST_TEST(stop == calls); // the last call is at completion
  }
}

BOOST_AUTO_TEST_CASE(an_exception_of_the_callback_leaves_the_outputs_alone)
{
  const Tree a = random_tree(24, 3, 2), b = random_tree(25, 3, 2);
  const auto scan = tube_points(a, 300, 1);
  int calls = 0;
  Tree ignored;
  std::vector<Point> ignored_points;
  pcs::orl_geodesic(a, scan, b, scan, 0.5, ignored, ignored_points, np::callback([&](double) {
                      return ++calls > 0;
                    }));
  for (int stop = calls; stop > 0; stop -= 1 + calls / 8) { // also the last one
    int count = 0;
    Tree out(1);
    std::vector<Point> points{Point(7, 7, 7)};
    const auto fail = [&](double) -> bool {
      if (++count == stop)
        throw std::range_error("enough");
      return true;
    };
    BOOST_CHECK_THROW(pcs::orl_geodesic(a, scan, b, scan, 0.5, out, points, np::callback(fail)),
                      std::range_error);
    BOOST_TEST(num_vertices(out) == 1u);
    BOOST_TEST((points == std::vector<Point>{Point(7, 7, 7)}));
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Orl_shape_space

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The steps of chapter 4 of [Aiteanu 2022] as published, by named parameters, with known answers.

#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/orl_geodesic.h>
#include <support/exceptions.h>
#include <support/orl_trees.h>

#include <CGAL/property_map.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace test_orl_published {

using namespace orl_test;
using pcs::Orl_extrapolation;
using pcs::Orl_metric;
using pcs::Orl_orientation;
using pcs::Transport_options;
using Space = pcs::Orl_shape_space<Kernel>;
namespace np = pcs::parameters;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A polyline with one radius.
Tree polyline(const std::vector<Vec3>& points, double radius)
{
  std::vector<Branch> branches(1);
  branches[0].points = points;
  branches[0].radii.assign(points.size(), radius);
  return make_tree(branches);
}

/// A vertical edge, and one that is bent by `angle`. [rad]
Tree bent(double angle, double radius = 0.1)
{
  return polyline({Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(std::sin(angle), 0, 1 + std::cos(angle))},
                  radius);
}

/// A vertical trunk with one branch at an angle to it, of unit length before scaling. [rad]
Tree with_branch(double angle, double scale = 1, double radius = 0.1)
{
  std::vector<Branch> branches(2);
  branches[0].points = {Vec3(0, 0, 0), Vec3(0, 0, 2 * scale), Vec3(0, 0, 4 * scale)};
  branches[1].points = {Vec3(0, 0, 0), scale * Vec3(std::sin(angle), 0, std::cos(angle))};
  for (Branch& b : branches)
    b.radii.assign(b.points.size(), radius);
  branches[1].parent = 0;
  branches[1].at = 1;
  return make_tree(branches);
}

/// The first edge of the branch in a tree of the space.
Vec3 branch_of(const Space& space, const pcs::Orl_tree& tree)
{
  const auto& layout = space.family().layout;
  BOOST_TEST_REQUIRE(layout.branches.size() == 2u);
  const auto& node = tree.state().geometry.node;
  return node[layout.first_node(1) + 1] - node[layout.first_node(1)];
}

double angle_of(const Vec3& v)
{
  return std::atan2(v.x(), v.z());
}

/// The sums of the lengths and of the radii at the ends of all edges with a positive length.
std::pair<double, double> sums(const Tree& tree)
{
  std::pair<double, double> sum(0, 0);
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const auto u = source(e, tree), v = target(e, tree);
    const double length = std::sqrt(CGAL::squared_distance(tree[u].point, tree[v].point));
    sum.first += length;
    sum.second += length > 0 ? tree[v].radius : 0;
  }
  return sum;
}

template <class Change>
Tree changed(Tree tree, const Change& change)
{
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    change(tree[v]);
  return tree;
}

double published(const Tree& a, const Tree& b, Orl_orientation kind = Orl_orientation::gauge_fixed)
{
  Space space;
  space.add_skeleton(a);
  space.add_skeleton(b);
  space.build(np::orientation(kind));
  const double d =
      space.distance(Space::Handle(0), Space::Handle(1), np::metric(Orl_metric::published));
  BOOST_TEST(space.distance(space.tree(0), space.tree(1), np::metric(Orl_metric::published)) == d);
  BOOST_TEST(pcs::distance_matrix(space, np::metric(Orl_metric::published))[1] == d);
  return d;
}

/// Pairs of points of two scans, by their numbers.
std::vector<std::pair<std::size_t, std::size_t>> pairs_of_points(const Tree& a,
                                                                 const std::vector<Point>& scan_a,
                                                                 const Tree& b,
                                                                 const std::vector<Point>& scan_b,
                                                                 const Transport_options& transport)
{
  Space space;
  space.add(a, scan_a);
  space.add(b, scan_b);
  space.build(np::transport_options(transport));
  const pcs::Orl_tree middle = space.geodesic(0, 1, 0.5);
  std::vector<std::pair<std::size_t, std::size_t>> result(middle.number_of_points());
  space.for_each_point(middle, [&](std::size_t i, std::size_t k, std::size_t l, double) {
    result[i] = {k, l};
  });
  return result;
}

using Oriented_point = std::pair<Point, Kernel::Vector_3>;
using Oriented_points = std::vector<Oriented_point>;

auto maps_of_points()
{
  return np::point_map(CGAL::First_of_pair_property_map<Oriented_point>())
      .normal_map(CGAL::Second_of_pair_property_map<Oriented_point>());
}

Oriented_points oriented_points(const Space& space, const pcs::Orl_tree& tree)
{
  Oriented_points points;
  space.points(tree, points, maps_of_points());
  return points;
}

/// Calls `f(k, from, axis)` for each point and the edge that it belongs to.
template <class F>
void for_each_edge_point(const Space& space, const pcs::Orl_tree& tree, const F& f)
{
  const auto& layout = space.family().layout;
  const auto& state = tree.state();
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j) {
      const std::size_t e = layout.branches[b].first_edge + j, v = layout.first_node(b) + j;
      const Vec3 from = state.geometry.node[v], axis = state.geometry.node[v + 1] - from;
      for (std::size_t k = state.first_point[e]; k < state.first_point[e + 1]; ++k)
        f(k, from, Vec3(axis.normalized()));
    }
}

Vec3 to_eigen(const Kernel::Vector_3& v)
{
  return Vec3(v.x(), v.y(), v.z());
}

/// The largest cosine of a normal, of unit length, and the direction of its edge.
double worst_slant(const Space& space, const pcs::Orl_tree& tree, const Oriented_points& points)
{
  double worst = 0;
  for_each_edge_point(space, tree, [&](std::size_t k, const Vec3&, const Vec3& axis) {
    const Vec3 normal = to_eigen(points[k].second);
    worst = std::max({worst, std::abs(normal.norm() - 1), std::abs(normal.dot(axis))});
  });
  return worst;
}

std::size_t
number_of_inward(const Space& space, const pcs::Orl_tree& tree, const Oriented_points& points)
{
  std::size_t number = 0;
  const Vec3 origin = space.family().origin;
  for_each_edge_point(space, tree, [&](std::size_t k, const Vec3& from, const Vec3& axis) {
    const Vec3 off = orl_test::to_eigen(points[k].first) - origin - from;
    const Vec3 radial = off - off.dot(axis) * axis;
    number += radial.dot(to_eigen(points[k].second)) < 0.999 * radial.norm() ? 1 : 0;
  });
  return number;
}

} // namespace

BOOST_AUTO_TEST_SUITE(orl_published)

BOOST_AUTO_TEST_CASE(the_published_distance_is_the_sum_over_edges)
{
  for (const Orl_orientation kind : {Orl_orientation::gauge_fixed, Orl_orientation::world_axes}) {
    const Tree tree = random_tree(3);
    const auto [length, radius] = sums(tree);
    const Tree moved =
        changed(tree, [](auto& v) { v.point = v.point + Kernel::Vector_3(1, 0, 0); });
    const Tree thick = changed(tree, [](auto& v) { v.radius *= 2; });
    const Tree large = changed(tree, [](auto& v) {
      v.point = Point(2 * v.point.x(), 2 * v.point.y(), 2 * v.point.z());
    });
    BOOST_TEST(published(tree, moved, kind) < 1e-9);
    BOOST_TEST(std::abs(published(tree, thick, kind) - radius) < 1e-9 * radius);
    BOOST_TEST(std::abs(published(tree, large, kind) - length) < 1e-7 * length);
    // an edge that is bent by another angle about the same axis
    BOOST_TEST(std::abs(published(bent(0.3), bent(1.1), kind) - 0.8) < 1e-9);
    BOOST_TEST(std::abs(published(bent(0.3), bent(1.1, 0.15), kind) - 0.9) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(the_published_distance_has_the_mean_tree_at_one_half)
{
  Space space;
  space.add_skeleton(random_tree(5));
  space.add_skeleton(random_tree(6));
  space.build(np::orientation(Orl_orientation::world_axes));
  const auto d = [&](const pcs::Orl_tree& x, const pcs::Orl_tree& y) {
    return space.distance(x, y, np::metric(Orl_metric::published));
  };
  const double whole = d(space.tree(0), space.tree(1));
  for (const double lambda : {0.2, 0.5, 0.8}) {
    const pcs::Orl_tree between = space.geodesic(0, 1, lambda);
    BOOST_TEST(std::abs(d(space.tree(0), between) - lambda * whole) < 1e-9 * whole);
    BOOST_TEST(std::abs(d(between, space.tree(1)) - (1 - lambda) * whole) < 1e-9 * whole);
  }
}

BOOST_AUTO_TEST_CASE(a_new_branch_bends_away_from_its_parent_as_in_figure_4_11)
{
  const auto slant = [&](pcs::Virtual_direction direction, double lambda) {
    Space space;
    space.add_skeleton(polyline({Vec3(0, 0, 0), Vec3(0, 0, 2), Vec3(0, 0, 4)}, 0.1));
    space.add_skeleton(with_branch(CGAL_PI / 2));
    space.build(np::virtual_direction(direction));
    const Vec3 edge = branch_of(space, space.geodesic(0, 1, lambda));
    BOOST_TEST(std::abs(edge.norm() - lambda) < 1e-9); // it also becomes longer
    return angle_of(edge) * 180 / CGAL_PI;
  };
  for (const double lambda : {0.1, 0.5, 1.})
    BOOST_TEST_CONTEXT("lambda " << lambda)
    {
      BOOST_TEST(std::abs(slant(pcs::Virtual_direction::along_parent, lambda) - 90 * lambda) <
                 1e-6);
      BOOST_TEST(std::abs(slant(pcs::Virtual_direction::of_partner, lambda) - 90) < 1e-6);
    }
}

BOOST_AUTO_TEST_CASE(lengths_radii_and_turns_continue_linearly)
{
  Space space;
  space.add_skeleton(with_branch(0.7, 1, 0.2));
  space.add_skeleton(with_branch(1.4, 3, 0.1));
  space.build();
  const auto linear = np::extrapolation(Orl_extrapolation::linear);
  for (const double lambda : {-0.4, 0.5, 1.5, 1.9, 2.5}) {
    const auto tree = space.geodesic(0, 1, lambda, linear.max_extrapolation_angle(CGAL_PI));
    const Vec3 edge = branch_of(space, tree);
    BOOST_TEST_CONTEXT("lambda " << lambda)
    {
      BOOST_TEST(std::abs(edge.norm() - (1 + 2 * lambda)) < 1e-9);
      BOOST_TEST(std::abs(angle_of(edge) - (0.7 + 0.7 * lambda)) < 1e-9);
      for (const double r : tree.coordinates().radius)
        BOOST_TEST(std::abs(r - std::max(0.0, 0.2 - 0.1 * lambda)) < 1e-9);
    }
  }
  // the remedy of the text: the rotation is limited, and only lengths and radii continue
  const Vec3 limited =
      branch_of(space, space.geodesic(0, 1, 1.9, linear.max_extrapolation_angle(0.1)));
  BOOST_TEST(std::abs(angle_of(limited) - (1.4 + 0.1)) < 1e-9);
  BOOST_TEST(std::abs(limited.norm() - 4.8) < 1e-9);
  // no length is below 0; by default, half of the value at the end remains
  BOOST_TEST(branch_of(space, space.geodesic(0, 1, -0.6, linear)).norm() == 0);
  BOOST_TEST(branch_of(space, space.geodesic(0, 1, -0.6)).norm() > 0.5);
  BOOST_TEST(space.geodesic(0, 1, 2.5).coordinates().radius[0] > 0.05);
}

BOOST_AUTO_TEST_CASE(the_plain_distance_crosses_where_its_square_does_not)
{
  // points on a tube: |a - c| + |b - d| = 1 + 1.12 is more than |a - d| + |b - c| = 2.06 + 0, but
  // the sums of squares are 2.2 and 4.2
  const Tree tree = polyline({Vec3(0, 0, 0), Vec3(0, 0, 10)}, 1);
  const std::vector<Point> one{Point(1, 0, 4), Point(1, 0, 5)};
  const std::vector<Point> two{Point(1, 0, 5), Point(std::cos(0.5), std::sin(0.5), 6)};
  Transport_options transport;
  transport.weights = pcs::Point_weights::equal;
  transport.reach = infinite;
  const auto partner = [&](bool is_squared) {
    transport.is_squared = is_squared;
    for (const auto& [k, l] : pairs_of_points(tree, one, tree, two, transport))
      if (k == 0)
        return l;
    return pcs::npos;
  };
  BOOST_TEST(partner(true) == 0u);
  BOOST_TEST(partner(false) == 1u);
}

BOOST_AUTO_TEST_CASE(equal_masses_are_moved_from_dense_to_sparse_parts)
{
  // Both scans are helices on one tube. The second has four fifths of its points in the lower half,
  // so equal masses are moved by 0.15 of the length in the mean; areas stay where they are.
  const Tree tree = polyline({Vec3(0, 0, 0), Vec3(0, 0, 20)}, 1);
  std::vector<Point> scans[2];
  constexpr int n = 400;
  for (int i = 0; i < n; ++i) {
    const double u = (i + 0.5) / n;
    const double heights[2] = {u, u < 0.8 ? 0.5 * u / 0.8 : 0.5 + 0.5 * (u - 0.8) / 0.2};
    for (int t = 0; t < 2; ++t)
      scans[t].push_back(Point(std::cos(2.4 * i), std::sin(2.4 * i), 20 * heights[t]));
  }
  Transport_options transport;
  transport.number_of_neighbors = n;
  transport.reach = infinite;
  const auto shift = [&](pcs::Point_weights weights) {
    transport.weights = weights;
    double sum = 0;
    const auto pairs = pairs_of_points(tree, scans[0], tree, scans[1], transport);
    for (const auto& [k, l] : pairs)
      sum += std::abs(scans[0][k].z() - scans[1][l].z()) / 20;
    return sum / static_cast<double>(pairs.size());
  };
  const double equal = shift(pcs::Point_weights::equal), area = shift(pcs::Point_weights::area);
  BOOST_TEST_MESSAGE("mean shift: equal " << equal << ", area " << area);
  BOOST_TEST(std::abs(equal - 0.15) < 0.03);
  BOOST_TEST(area < 0.05);
}

BOOST_AUTO_TEST_CASE(a_smaller_epsilon_comes_nearer_to_the_exact_pairs)
{
  const Tree tree = random_tree(9, 2, 2);
  const std::vector<Point> one = tube_points(tree, 600, 1), two = tube_points(tree, 700, 2);
  Transport_options transport;
  const auto exact = pairs_of_points(tree, one, tree, two, transport);
  transport.method = pcs::Point_transport::sinkhorn;
  const auto common = [&](double epsilon) {
    transport.sinkhorn.regularization = epsilon;
    const auto pairs = pairs_of_points(tree, one, tree, two, transport);
    std::size_t number = 0;
    for (const auto& p : pairs)
      number += std::find(exact.begin(), exact.end(), p) != exact.end() ? 1 : 0;
    return static_cast<double>(number) / static_cast<double>(exact.size());
  };
  const double coarse = common(1), fine = common(0.01);
  BOOST_TEST_MESSAGE("pairs in common: epsilon 1 " << coarse << ", 0.01 " << fine);
  BOOST_TEST(fine > 0.9);
  BOOST_TEST(fine > coarse + 0.1);
}

BOOST_AUTO_TEST_CASE(opposite_branches_stay_opposite)
{
  const auto opposite_tree = [](unsigned seed, std::size_t whorl) {
    pcs::Tree_habit habit = pcs::broadleaf_habit().scaled(0.4);
    habit.number_of_orders = 2;
    habit.whorl = whorl;
    Tree tree;
    pcs::grow_tree(tree, habit, np::random_seed(seed));
    return tree;
  };
  const auto build = [](Space& space, const Tree& a, const Tree& b, bool do_keep) {
    space.add_skeleton(a);
    space.add_skeleton(b);
    pcs::Matching_weights weights;
    weights.do_keep_whorls = do_keep;
    return space.build(np::matching_weights(weights));
  };
  const Tree a = opposite_tree(1, 2), b = opposite_tree(2, 2);
  Space space, free, middle;
  pcs::Orl_report report = build(space, a, b, true);
  BOOST_TEST(report.number_of_whorls[0] > 20u);
  BOOST_TEST(report.number_of_whorls[1] > 20u);
  BOOST_TEST(report.number_of_broken_whorls[0] <= 1u);
  BOOST_TEST(report.number_of_broken_whorls[1] <= 1u);
  BOOST_TEST(build(free, a, b, false).number_of_broken_whorls[0] > 10u);
  // also in the tree half-way, where branches without a partner stand between them
  Tree half;
  space.skeleton(space.geodesic(0, 1, 0.5), half);
  BOOST_TEST(10 * build(middle, half, half, true).number_of_whorls[0] >=
             8 * report.number_of_whorls[0]);
  // opposite branches of one tree have partners that are alternate: the report says so
  Space mixed;
  report = build(mixed, a, opposite_tree(3, 1), true);
  BOOST_TEST(report.number_of_whorls[1] == 0u);
  BOOST_TEST(report.number_of_broken_whorls[0] > 5u);

  // families are counted in the same way, for each tree
  const auto family = [](const std::vector<Tree>& trees) {
    Space built;
    for (const Tree& tree : trees)
      built.add_skeleton(tree);
    return built.build();
  };
  const pcs::Orl_report kept = family({a, a, a});
  BOOST_TEST_REQUIRE(kept.number_of_whorls.size() == 3u);
  BOOST_TEST((kept.number_of_broken_whorls == std::vector<std::size_t>{0, 0, 0}));
  for (const std::size_t number : kept.number_of_whorls)
    BOOST_TEST(number > 20u);
  const pcs::Orl_report separate = family({a, opposite_tree(3, 1), a});
  BOOST_TEST(separate.number_of_whorls[1] == 0u);
  BOOST_TEST(separate.number_of_whorls[0] == kept.number_of_whorls[0]);
  BOOST_TEST(separate.number_of_broken_whorls[0] > 5u);
  BOOST_TEST(separate.number_of_broken_whorls[1] == 0u);
  BOOST_TEST(separate.number_of_broken_whorls[2] == separate.number_of_broken_whorls[0]);
}

BOOST_AUTO_TEST_CASE(the_status_tells_that_transports_did_not_converge)
{
  const Tree tree = random_tree(9, 2, 2);
  Space space;
  space.add(tree, tube_points(tree, 600, 1));
  space.add(tree, tube_points(tree, 700, 2));
  Transport_options transport;
  pcs::Orl_report report = space.build(np::transport_options(transport));
  BOOST_TEST(report.number_of_failed_windows == 0u);
  BOOST_TEST((report.status == pcs::Status::converged));
  transport.method = pcs::Point_transport::sinkhorn;
  transport.sinkhorn.iterations = 1;
  report = space.build(np::transport_options(transport));
  BOOST_TEST(report.number_of_failed_windows > 0u);
  BOOST_TEST((report.status == pcs::Status::iteration_limit));
  Tree middle; // the result is written
  std::vector<Point> points;
  const std::vector<Point> one = tube_points(tree, 600, 1), two = tube_points(tree, 700, 2);
  pcs::orl_geodesic(tree, one, tree, two, 0.5, middle, points, np::transport_options(transport));
  BOOST_TEST(num_vertices(middle) > 0u);
  BOOST_TEST(points.size() >= 700u);
}

BOOST_AUTO_TEST_CASE(normals_are_orthogonal_to_branches_where_scans_have_none)
{
  for (const unsigned number_of_trees : {2u, 3u}) {
    Space space;
    for (unsigned h = 0; h < number_of_trees; ++h) {
      const Tree tree = random_tree(21 + h, 3, 2);
      space.add(tree, tube_points(tree, 2000 + 100 * h, h));
    }
    space.build();
    for (const double lambda : {0., 0.3, 1., 1.4})
      BOOST_TEST_CONTEXT(number_of_trees << " trees, lambda " << lambda)
      {
        const pcs::Orl_tree tree = space.geodesic(0, 1, lambda);
        const Oriented_points points = oriented_points(space, tree);
        BOOST_TEST_REQUIRE(points.size() > 1000u);
        BOOST_TEST(worst_slant(space, tree, points) < 1e-12);
        // away from the axis: a step along the normal leads farther from it
        BOOST_TEST(number_of_inward(space, tree, points) == 0u);
      }
  }
}

BOOST_AUTO_TEST_CASE(normals_of_a_blade_are_across_it)
{
  // A blade along z, wide along x in one tree, and along y in the other.
  const Tree tree = polyline({Vec3(0, 0, 0), Vec3(0, 0, 10)}, 0);
  std::vector<Point> scans[2];
  for (int i = 0; i < 2000; ++i) {
    const double across = std::remainder(0.618034 * i, 1.), along = 10 * (i + 0.5) / 2000;
    scans[0].push_back(Point(across, 0.01, along));
    scans[1].push_back(Point(0.01, across, along));
  }
  Space space;
  space.add(tree, scans[0]);
  space.add(tree, scans[1]);
  space.build();
  for (const double lambda : {0., 0.5, 1.}) {
    const pcs::Orl_tree at = space.geodesic(0, 1, lambda);
    const Oriented_points points = oriented_points(space, at);
    BOOST_TEST(worst_slant(space, at, points) < 1e-12);
    for (const auto& [p, n] : points) {
      const double blade = std::abs(lambda == 0 ? n.y() : lambda == 1 ? n.x() : 1);
      BOOST_TEST_REQUIRE(blade > 0.99);
    }
  }
}

BOOST_AUTO_TEST_CASE(normals_of_scans_are_kept_unless_others_are_wanted)
{
  const Tree tree = polyline({Vec3(0, 0, 0), Vec3(0, 0, 10)}, 1);
  Oriented_points scan;
  for (int i = 0; i < 500; ++i)
    scan.emplace_back(Point(std::cos(2.4 * i), std::sin(2.4 * i), 0.02 * i),
                      Kernel::Vector_3(std::cos(2.4 * i), std::sin(2.4 * i), 1) / std::sqrt(2.));
  Space space;
  space.add(tree, scan, maps_of_points());
  space.add(tree, scan, maps_of_points());
  space.build();
  const pcs::Orl_tree middle = space.geodesic(0, 1, 0.5);
  BOOST_TEST(std::abs(worst_slant(space, middle, oriented_points(space, middle)) - std::sqrt(0.5)) <
             1e-9);
  Oriented_points points;
  space.points(middle, points, maps_of_points().point_normals(pcs::Point_normals::across_branches));
  BOOST_TEST(worst_slant(space, middle, points) < 1e-12);

  Space half; // only one scan has normals
  half.add(tree, scan, maps_of_points());
  half.add(tree, scan, np::point_map(CGAL::First_of_pair_property_map<Oriented_point>()));
  half.build();
  const pcs::Orl_tree between = half.geodesic(0, 1, 0.5);
  BOOST_TEST(worst_slant(half, between, oriented_points(half, between)) < 1e-12);
  BOOST_CHECK_EXCEPTION(
      half.points(between, points, maps_of_points().point_normals(pcs::Point_normals::of_scans)),
      pcs::Invalid_input,
      pcs_test::message_has("`point_normals`"));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_published

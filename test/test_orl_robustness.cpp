// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees and scans of odd shapes: long, wide, flat, without radii, in one place.

#include <pcs/orl_geodesic.h>
#include <support/archetypes.h>
#include <support/exceptions.h>
#include <support/graph_archetypes.h>
#include <support/orl_trees.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

using namespace orl_test;
using pcs_test::message_has;

namespace {

std::size_t add_node(Tree& tree, std::size_t parent, const Vec3& p, double radius)
{
  pcs::Tree_node<Kernel> node;
  node.point = to_cgal(p);
  node.radius = radius;
  const std::size_t v = add_vertex(node, tree);
  if (parent != pcs::npos)
    add_edge(parent, v, tree);
  return v;
}

/// A trunk of `n` nodes, with a bend.
Tree path(std::size_t n, double bend)
{
  Tree tree;
  std::size_t last = pcs::npos;
  for (std::size_t k = 0; k < n; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(n - 1);
    last = add_node(tree, last, Vec3(bend * t * t, 0, 5 * t), 0.1);
  }
  return tree;
}

/// `n` branches from the middle of a trunk.
Tree star(std::size_t n, double turn)
{
  Tree tree = path(3, 0);
  for (std::size_t k = 0; k < n; ++k) {
    const double angle = 2.399963 * static_cast<double>(k) + turn;
    const double z = static_cast<double>(k) / static_cast<double>(n);
    const std::size_t v =
        add_node(tree, 1, Vec3(0.5 * std::cos(angle), 0.5 * std::sin(angle), 2.5 + z), 0.02);
    add_node(tree, v, Vec3(std::cos(angle), std::sin(angle), 2.5 + 2 * z), 0.01);
  }
  return tree;
}

/// A tube of six edges, each bent by `bend` against the one before.
Tree bent_tube(double bend, double radius)
{
  Tree tree;
  Vec3 p = Vec3::Zero();
  std::size_t last = add_node(tree, pcs::npos, p, radius);
  for (int k = 0; k < 6; ++k) {
    p += Vec3(std::sin(bend * k), 0, std::cos(bend * k));
    last = add_node(tree, last, p, radius);
  }
  return tree;
}

/// A trunk with a side branch near its end; `rest` and `side` are the lengths beyond the fork.
Tree forked_end(double rest, double side)
{
  Tree tree = path(2, 0);
  const std::size_t fork = add_node(tree, 1, Vec3(0, 0, 10), 0.1);
  add_node(tree, fork, Vec3(0, 0, 10 + rest), 0.05);
  add_node(tree, fork, Vec3(side, 0, 10), 0.05);
  for (int k = 1; k < 4; ++k)
    add_node(tree, 1, Vec3(k == 1, k == 2, 5 + (k == 3)), 0.02);
  return tree;
}

/// Builds, and looks at a few places on the path.
pcs::Orl_report morph(const Tree& a,
                      const std::vector<Point>& scan_a,
                      const Tree& b,
                      const std::vector<Point>& scan_b)
{
  pcs::Orl_shape_space<Kernel> space;
  space.add(a, scan_a);
  space.add(b, scan_b);
  const auto report = space.build();
  BOOST_TEST((report.status == pcs::Status::converged));
  for (const double lambda : {-0.5, 0., 0.5, 1., 1.5}) {
    const auto tree = space.geodesic(0, 1, lambda);
    std::vector<Point> points;
    space.points(tree, points);
    bool is_finite = true;
    for (const Point& p : points)
      is_finite = is_finite && to_eigen(p).allFinite();
    Tree skeleton;
    space.skeleton(tree, skeleton);
    for (std::size_t v = 0; v < num_vertices(skeleton); ++v)
      is_finite = is_finite && to_eigen(skeleton[v].point).allFinite() &&
                  std::isfinite(skeleton[v].radius) && skeleton[v].radius >= 0;
    BOOST_TEST(is_finite);
    if (lambda == 0)
      BOOST_TEST(points.size() >= scan_a.size());
  }
  return report;
}

} // namespace

BOOST_AUTO_TEST_SUITE(orl_robustness)

BOOST_AUTO_TEST_CASE(a_path_of_fifty_thousand_nodes)
{
  const Tree a = path(50000, 1), b = path(20000, 2);
  const auto report = morph(a, tube_points(a, 2000, 1), b, tube_points(b, 2000, 2));
  BOOST_TEST(report.number_of_matched_branches == 1u);
}

BOOST_AUTO_TEST_CASE(a_branch_on_every_node_of_a_chain_of_branches)
{
  // every branch leaves its parent after the first edge: orders as deep as the tree has branches
  const auto chain = [](std::size_t n) {
    Tree tree;
    std::size_t last = add_node(tree, pcs::npos, Vec3(0, 0, 0), 0.1);
    Vec3 p = Vec3::Zero();
    double length = 1;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 side(k % 2 == 0 ? 1 : 0, k % 2 == 0 ? 0 : 1, 0.2);
      const std::size_t v = add_node(tree, last, p + length * side, 0.05);
      add_node(tree, v, p + 3 * length * side, 0.02);
      p += length * side;
      length *= 0.99;
      last = v;
    }
    return tree;
  };
  morph(chain(300), {}, chain(250), {});
}

BOOST_AUTO_TEST_CASE(a_star_of_five_hundred_branches)
{
  const Tree a = star(500, 0), b = star(480, 0.05);
  const auto report = morph(a, tube_points(a, 5000, 1), b, tube_points(b, 5000, 2));
  BOOST_TEST(report.number_of_matched_branches > 400u);
}

BOOST_AUTO_TEST_CASE(equal_trees_are_in_one_place)
{
  const Tree a = random_tree(51);
  const auto scan = tube_points(a, 2000, 1);
  const auto report = morph(a, scan, a, scan);
  BOOST_TEST(report.distance < 1e-9);
  BOOST_TEST(report.number_of_matched_branches == report.number_of_branches[0]);
  BOOST_TEST(report.number_of_single_points == 0u);
}

BOOST_AUTO_TEST_CASE(thousands_of_points_in_one_place)
{
  const Tree a = random_tree(52, 3, 2), b = random_tree(53, 3, 2);
  std::vector<Point> same(5000, tube_points(a, 1, 1)[0]);
  morph(a, same, b, tube_points(b, 1000, 2));
  morph(a, same, b, std::vector<Point>(3000, tube_points(b, 1, 2)[0]));
}

BOOST_AUTO_TEST_CASE(all_points_of_a_large_scan_on_one_branch)
{
  const Tree a = path(2, 0), b = random_tree(54, 3, 2);
  const auto report = morph(a, tube_points(a, 200000, 1), b, tube_points(b, 10000, 2));
  BOOST_TEST(report.number_of_points[0] == 200000u);
  BOOST_TEST(report.worst_marginal_violation < 1e-9);
}

BOOST_AUTO_TEST_CASE(trees_without_radii)
{
  Tree a = random_tree(55, 3, 2), b = random_tree(56, 3, 2);
  const auto scan_a = tube_points(a, 2000, 1), scan_b = tube_points(b, 2000, 2);
  for (Tree* tree : {&a, &b})
    for (std::size_t v = 0; v < num_vertices(*tree); ++v)
      (*tree)[v].radius = 0;
  morph(a, scan_a, b, scan_b);
}

BOOST_AUTO_TEST_CASE(edges_without_length_change_nothing)
{
  const Tree a = random_tree(57, 3, 2), b = random_tree(58, 3, 2);
  // every node twice, one behind the other
  Tree doubled(2 * num_vertices(a));
  for (std::size_t v = 0; v < num_vertices(a); ++v) {
    doubled[2 * v] = doubled[2 * v + 1] = a[v];
    add_edge(2 * v, 2 * v + 1, doubled);
  }
  for (const auto e : boost::make_iterator_range(edges(a)))
    add_edge(2 * source(e, a) + 1, 2 * target(e, a), doubled);
  const auto one = morph(a, {}, b, {}), two = morph(doubled, {}, b, {});
  BOOST_TEST(one.number_of_matched_branches == two.number_of_matched_branches);
  BOOST_TEST(std::abs(one.distance - two.distance) < 1e-9 * one.distance);
}

BOOST_AUTO_TEST_CASE(a_cycle_beside_the_root_is_refused)
{
  Tree tree(5);
  add_edge(0, 1, tree);
  add_edge(2, 3, tree);
  add_edge(3, 4, tree);
  add_edge(4, 2, tree);
  for (std::size_t v = 0; v < 5; ++v)
    tree[v].point = Point(0, 0, static_cast<double>(v));
  pcs::Orl_shape_space<Kernel> space;
  BOOST_CHECK_EXCEPTION(space.add_skeleton(tree), pcs::Invalid_input, message_has("cycle"));
}

BOOST_AUTO_TEST_CASE(archetypes_of_graph_maps_range_and_key)
{
  using Triple = pcs_test::Triple_archetype<double>;
  const auto triples = [](const std::vector<Point>& points) {
    std::vector<Triple> result;
    for (const Point& p : points)
      result.emplace_back(p.x(), p.y(), p.z());
    return result;
  };
  const Tree trees[] = {random_tree(59, 3, 2), random_tree(60, 3, 2)};
  const std::vector<Point> scans[] = {tube_points(trees[0], 500, 1), tube_points(trees[1], 600, 2)};
  pcs::Orl_shape_space<Kernel> space, plain;
  std::vector<Triple> normals;
  for (int t = 0; t < 2; ++t) {
    const Tree& tree = trees[t];
    std::vector<std::pair<std::size_t, std::size_t>> list;
    for (const auto e : boost::make_iterator_range(edges(tree)))
      list.emplace_back(source(e, tree), target(e, tree));
    std::vector<Point> node_points;
    std::vector<float> radii; // as precise as here
    std::vector<std::size_t> indices;
    Tree rounded = tree;
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      node_points.push_back(tree[v].point);
      radii.push_back(static_cast<float>(tree[v].radius));
      rounded[v].radius = static_cast<double>(radii.back());
      indices.push_back(v);
    }
    const std::vector<Triple> nodes = triples(node_points);
    std::vector<Triple> points = triples(scans[t]);
    normals.assign(points.size(), Triple(0, 0, 1));
    space.add(pcs_test::Tree_archetype(indices.size(), list),
              pcs_test::Range_archetype(points.size()),
              pcs::parameters::node_point_map(pcs_test::Vertex_map_archetype<Triple>(nodes))
                  .node_radius_map(pcs_test::Vertex_map_archetype<float>(radii))
                  .node_index_map(pcs_test::Vertex_map_archetype<std::size_t>(indices))
                  .point_map(pcs_test::Map_archetype<Triple>(points))
                  .normal_map(pcs_test::Map_archetype<Triple>(normals)));
    std::vector<std::pair<Point, Kernel::Vector_3>> oriented;
    for (const Point& p : scans[t])
      oriented.emplace_back(p, Kernel::Vector_3(0, 0, 1));
    using Oriented = std::pair<Point, Kernel::Vector_3>;
    plain.add(rounded,
              oriented,
              pcs::parameters::point_map(CGAL::First_of_pair_property_map<Oriented>())
                  .normal_map(CGAL::Second_of_pair_property_map<Oriented>()));
  }
  space.build();
  plain.build();
  const auto tree = space.geodesic(0, 1, 0.3);
  std::vector<Triple> out(tree.number_of_points(), Triple(7, 7, 7));
  normals = out;
  pcs_test::Range_archetype range(out.size());
  const auto maps = pcs::parameters::point_map(pcs_test::Map_archetype<Triple>(out))
                        .normal_map(pcs_test::Map_archetype<Triple>(normals));
  BOOST_TEST(space.points(tree, range, maps) == out.size());
  std::vector<Point> expected;
  plain.points(plain.geodesic(0, 1, 0.3), expected);
  BOOST_TEST_REQUIRE(expected.size() == out.size());
  bool is_same = true;
  for (std::size_t i = 0; i < out.size(); ++i)
    is_same = is_same && Point(out[i].x(), out[i].y(), out[i].z()) == expected[i];
  BOOST_TEST(is_same);
  pcs_test::Range_archetype small(out.size() - 1);
  BOOST_CHECK_THROW(space.points(tree, small, maps), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(the_end_of_a_trunk_is_the_end_whatever_twig_is_longest)
{
  pcs::Orl_shape_space<Kernel> space;
  const Tree a = forked_end(0.5, 0.3), b = forked_end(0.3, 0.5);
  space.add_skeleton(a);
  space.add_skeleton(b);
  space.build();
  int number_found = 0;
  for (const pcs::Branch_match& m : space.matches())
    if (m.tip[0] == 3 || m.tip[1] == 3) { // the node straight above the fork
      BOOST_TEST(m.tip[0] == m.tip[1]);
      ++number_found;
    }
  BOOST_TEST(number_found == 1);
}

BOOST_AUTO_TEST_CASE(surfaces_do_not_tear_where_bends_grow)
{
  const double radius = 0.3, bend = 0.5;
  const Tree straight = bent_tube(0, radius), bent = bent_tube(bend, radius);
  pcs::Orl_shape_space<Kernel> space;
  space.add(straight, whole_tube_points(straight, 20000, 1));
  space.add(bent, whole_tube_points(bent, 20000, 2));
  space.build();
  const double spacing = std::sqrt(2 * CGAL_PI * radius * 6 / 20000);
  for (double lambda = -0.5; lambda <= 1.5; lambda += 0.25) {
    const pcs::Orl_tree tree = space.geodesic(0, 1, lambda);
    std::vector<Point> points;
    space.points(tree, points);
    Tree skeleton;
    space.skeleton(tree, skeleton);
    std::vector<Vec3> axis{to_eigen(skeleton[skeleton[boost::graph_bundle].root].point)};
    for (std::size_t v = skeleton[boost::graph_bundle].root; out_degree(v, skeleton) > 0;) {
      v = target(*out_edges(v, skeleton).first, skeleton);
      axis.push_back(to_eigen(skeleton[v].point));
    }
    BOOST_TEST_REQUIRE(axis.size() >= 7u);
    // sections keep their size: the distance from the line of some edge is about the radius
    double worst = 0;
    for (const Point& p : points) {
      double least = 1;
      for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
        const Vec3 d = (axis[k + 1] - axis[k]).normalized();
        least = std::min(least, std::abs((to_eigen(p) - axis[k]).cross(d).norm() - radius));
      }
      worst = std::max(worst, least);
    }
    BOOST_TEST(worst < 0.1 * radius);
    // no gap on the outer side of bends, where both tubes meet
    for (std::size_t k = 1; k + 1 < axis.size(); ++k) {
      const Vec3 d = (axis[k] - axis[k - 1]).normalized(), e = (axis[k + 1] - axis[k]).normalized();
      if ((d - e).norm() < 0.1)
        continue;
      const Vec3 outermost =
          axis[k] + radius / std::sqrt(0.5 * (1 + d.dot(e))) * (d - e).normalized();
      double nearest = 1;
      for (const Point& p : points)
        nearest = std::min(nearest, (to_eigen(p) - outermost).norm());
      BOOST_TEST(nearest < 3 * spacing);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rooted trees: bases of branches on other axes.

#include <pcs/shape_space/model/Rooted_tree.h>
#include <support/drawn.h>
#include <support/orl_trees.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_Rooted_tree {

using namespace orl_test;

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

} // namespace

BOOST_AUTO_TEST_SUITE(rooted_trees)

BOOST_AUTO_TEST_CASE(bases_on_axes_are_found_among_twenty_thousand_children)
{
  constexpr std::size_t number = 20000, number_on_axes = 100;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  pcs::shape_space::Rooted_tree star;
  star.extent = 4;
  const auto add = [&](const Vec3& point, std::size_t parent) {
    star.points.push_back(point);
    star.radii.push_back(0.001);
    star.parents.push_back(parent);
    star.sources.push_back(star.points.size() - 1);
  };
  add(Vec3::Zero(), pcs::npos);
  for (std::size_t k = 0; k < number; ++k)
    add((1 + 0.1 * double(k % 7)) *
            pcs_test::drawn<Vec3>([&] { return normal(random); }).normalized(),
        0);
  for (std::size_t k = 0; k < number_on_axes; ++k)
    add(0.3 * star.points[1 + 13 * k], 0);
  const pcs::shape_space::Rooted_tree found = pcs::shape_space::internal::with_nodes_at_bases(star);
  BOOST_TEST(found.size() == 1 + number + 2 * number_on_axes);
  std::size_t number_on_their_axis = 0;
  for (std::size_t v = 0; v < found.size(); ++v)
    if (found.sources[v] != pcs::npos && found.sources[v] > number) { // at the new node of the axis
      const std::size_t base = found.parents[v];
      number_on_their_axis +=
          found.sources[base] == pcs::npos && found.points[base] == found.points[v];
      const std::size_t axis = 1 + 13 * (found.sources[v] - number - 1);
      BOOST_TEST(std::count_if(found.parents.begin(), found.parents.end(), [&](std::size_t p) {
                   return p == base;
                 }) == 2);
      const auto end = std::find(found.sources.begin(), found.sources.end(), axis);
      BOOST_TEST(found.parents[std::size_t(end - found.sources.begin())] == base);
    }
  BOOST_TEST(number_on_their_axis == number_on_axes);
}

BOOST_AUTO_TEST_CASE(branches_may_begin_on_an_axis_that_lies_on_another_one)
{
  // The third begins near the second, which begins near the first, but the third does not begin
  // near the first.
  Tree tree;
  const std::size_t root = add_node(tree, pcs::npos, Vec3(0, 0, 0), 0.1);
  add_node(tree, root, Vec3(0, 0, 3), 0.1);
  const std::size_t second = add_node(tree, root, Vec3(0.9e-4, 0, 2), 0.1);
  add_node(tree, second, Vec3(1, 0, 2.5), 0.05);
  const std::size_t third = add_node(tree, root, Vec3(1.35e-4, 0, 1), 0.1);
  add_node(tree, third, Vec3(-1, 0, 1.5), 0.05);
  const pcs::shape_space::Rooted_tree rooted =
      pcs::shape_space::make_rooted_tree(tree,
                                         get(&pcs::Tree_node<Kernel>::point, tree),
                                         get(&pcs::Tree_node<Kernel>::radius, tree),
                                         get(boost::vertex_index, tree),
                                         "test");
  double length = 0;
  for (std::size_t v = 1; v < rooted.size(); ++v) {
    BOOST_TEST_REQUIRE(rooted.parents[v] < v);
    length += rooted.edge_length(v);
  }
  BOOST_TEST(std::abs(length - 3 - 2 * std::hypot(1, 0.5)) < 1e-3);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Rooted_tree

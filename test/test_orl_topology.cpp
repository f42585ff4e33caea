// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shared topology of a family of trees: correspondence of branches, distances, further trees.

#include <pcs/Orl_shape_space.h>
#include <pcs/find_modes.h>
#include <pcs/mean_tree.h>
#include <pcs/sample_tree.h>
#include <support/archetypes.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_orl_topology {

using pcs::Orl_metric;
using pcs::Tree_mean;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

BOOST_AUTO_TEST_SUITE(orl_topology)

BOOST_AUTO_TEST_CASE(branches_of_relatives_are_the_same_branches)
{
  // The original tree has 1 + 5 + 25 branches; wrong matches would add more.
  const Family space(8);
  const std::size_t n = space.family().layout.branches.size();
  BOOST_TEST(n >= 31u);
  BOOST_TEST(n <= 33u);
  for (std::size_t h = 0; h < 8; ++h)
    BOOST_TEST(space.has_branch(h, 0));
}

BOOST_AUTO_TEST_CASE(trees_of_the_space_are_the_inputs)
{
  const std::vector<Tree> trees = relatives(5, 4);
  const Space space = make_space(trees);
  for (std::size_t h = 0; h < trees.size(); ++h) {
    Tree back;
    space.skeleton(space.tree(h), back);
    const auto length = [](const Tree& tree) {
      double sum = 0;
      for (const auto e : boost::make_iterator_range(edges(tree)))
        sum += std::sqrt(
            CGAL::squared_distance(tree[source(e, tree)].point, tree[target(e, tree)].point));
      return sum;
    };
    // Axes are straight between nodes, and branches begin on them.
    BOOST_TEST(std::abs(total_length(space.tree(h).coordinates()) / length(trees[h]) - 1) < 0.03);
    for (std::size_t b = 0; b < space.family().layout.branches.size(); ++b)
      if (space.has_branch(h, b)) {
        // Tips are at their original positions, up to the shift by the straight axes of the
        // parents.
        const Point tip = trees[h][space.tip_of_branch(h, b)].point;
        double least = 1e300;
        for (std::size_t v = 0; v < num_vertices(back); ++v)
          least = std::min(least, CGAL::squared_distance(back[v].point, tip));
        BOOST_TEST(std::sqrt(least) < 0.03 * 10);
      }
  }
}

BOOST_AUTO_TEST_CASE(the_axioms_hold_on_the_shared_topology)
{
  const Family space;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    std::vector<double> w(space.number_of_trees());
    for (double& x : w)
      x = std::abs(normal(random));
    return pcs::weighted_mean(space, w);
  };
  for (int i = 0; i < 200; ++i) {
    const pcs::Orl_tree x = draw(), y = draw(), z = draw();
    for (const Orl_metric metric : {Orl_metric::sum, Orl_metric::square, Orl_metric::cone}) {
      const auto d = [&](const pcs::Orl_tree& a, const pcs::Orl_tree& b) {
        return space.distance(a, b, np::metric(metric));
      };
      BOOST_TEST(d(x, x) == 0);
      BOOST_TEST(d(x, y) > 0);
      BOOST_TEST(std::abs(d(x, y) - d(y, x)) <= 1e-12 * d(x, y));
      BOOST_TEST(d(x, z) <= (d(x, y) + d(y, z)) * (1 + 1e-12));
    }
  }
  const std::vector<double> all = pcs::distance_matrix(space);
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b) {
      BOOST_TEST(all[a * 6 + b] == all[b * 6 + a]);
      BOOST_TEST((a == b) == (all[a * 6 + b] == 0));
    }
}

BOOST_AUTO_TEST_CASE(the_order_of_the_trees_does_not_matter)
{
  const std::vector<Tree> trees = relatives(7, 5, 0.3, 0.3);
  const Space space = make_space(trees);
  std::mt19937 random(2);
  for (int i = 0; i < 3; ++i) {
    std::vector<std::size_t> order{0, 1, 2, 3, 4, 5, 6};
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Tree> other;
    for (const std::size_t k : order)
      other.push_back(trees[k]);
    const Space permuted = make_space(other);
    BOOST_REQUIRE(permuted.family().layout.branches.size() ==
                  space.family().layout.branches.size());
    for (std::size_t a = 0; a < 7; ++a)
      for (std::size_t b = 0; b < a; ++b)
        BOOST_TEST(std::abs(permuted.distance(a, b) - space.distance(order[a], order[b])) <
                   1e-6 * space.distance(order[a], order[b]));
    for (const Tree_mean kind : {Tree_mean::median, Tree_mean::frechet}) {
      const pcs::Orl_tree m = pcs::mean_tree(space, np::tree_mean(kind)),
                          p = pcs::mean_tree(permuted, np::tree_mean(kind));
      // Roots of both means are in the axes of their first tree, which has the same position here.
      BOOST_TEST(
          distance(m.coordinates(), p.coordinates(), space.family().weights, Orl_metric::sum) <
          1e-6 * total_length(m.coordinates()));
    }
  }
}

BOOST_AUTO_TEST_CASE(odd_groups_have_a_topology)
{
  Tree line;
  const auto a = add_vertex(pcs::Tree_node<Kernel>(), line);
  const auto b = add_vertex(pcs::Tree_node<Kernel>(), line);
  line[b].point = Point(0, 0, 2);
  add_edge(a, b, line);
  // Equal trees, trees of a single branch, and trees with only the trunk in common.
  for (const std::vector<Tree>& trees :
       {std::vector<Tree>(4, line),
        std::vector<Tree>(3, relatives(1, 8)[0]),
        std::vector<Tree>{line, relatives(1, 8)[0], relatives(1, 99)[0]}}) {
    const Space space = make_space(trees);
    const pcs::Orl_tree mean = pcs::mean_tree(space);
    BOOST_TEST(std::isfinite(total_length(mean.coordinates())));
    const auto modes = pcs::find_modes(space, 5);
    BOOST_TEST(modes.size() < trees.size());
    const auto tree = pcs::sample_tree(space, 1);
    BOOST_TEST(std::isfinite(total_length(tree.coordinates())));
    BOOST_TEST(total_length(tree.coordinates()) > 0);
    if (trees[0][0].point == trees[1][0].point &&
        num_vertices(trees[0]) == num_vertices(trees[2])) {
      BOOST_TEST(modes.size() == 0u);
      BOOST_TEST(space.distance(tree, space.tree(0)) < 1e-9);
    }
  }
}

BOOST_AUTO_TEST_CASE(a_further_tree_finds_its_place)
{
  std::vector<Tree> trees = relatives(7, 6);
  const Tree last = trees.back();
  trees.pop_back();
  const Space space = make_space(trees);
  double share = 0;
  const pcs::Orl_tree placed = space.embed(last, np::default_values(), &share);
  BOOST_TEST(share > 0.95);
  BOOST_TEST(share <= 1 + 1e-9);
  // An added tree is reproduced.
  const pcs::Orl_tree own = space.embed(trees[2]);
  BOOST_TEST(space.distance(own, space.tree(2)) < 0.1 * space.distance(own, space.tree(3)));
  const auto modes = pcs::find_modes(space, 3);
  const double usual = pcs::outlier_score(space, modes, placed);
  BOOST_TEST(usual > 0.3);
  BOOST_TEST(usual < 2);
  const pcs::Orl_tree strange = space.embed(relatives(1, 77)[0]);
  BOOST_TEST(pcs::outlier_score(space, modes, strange) > 1.5 * usual);
}

BOOST_AUTO_TEST_CASE(archetypes_of_graph_range_key_map_and_value)
{
  // Minimal requirements: a graph without properties, a scan of generated keys, maps that read by
  // value.
  using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;
  using Bare_point = pcs_test::Triple_archetype<double>;
  std::vector<std::vector<Bare_point>> nodes(3), scans(3);
  std::vector<std::vector<float>> radii(3);
  Space space;
  for (std::size_t t = 0; t < 3; ++t) {
    const Tree tree = relatives(3, 81)[t];
    Graph graph(num_vertices(tree));
    for (const auto e : boost::make_iterator_range(edges(tree)))
      add_edge(source(e, tree), target(e, tree), graph);
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      nodes[t].emplace_back(tree[v].point.x(), tree[v].point.y(), tree[v].point.z());
      radii[t].push_back(static_cast<float>(tree[v].radius));
    }
    for (const Point& p : rings(tree))
      scans[t].emplace_back(p.x(), p.y(), p.z());
    const auto maps = [&](std::size_t i) {
      return np::node_point_map(boost::make_iterator_property_map(nodes[i].begin(),
                                                                  get(boost::vertex_index, graph)))
          .node_radius_map(
              boost::make_iterator_property_map(radii[i].begin(), get(boost::vertex_index, graph)));
    };
    space.add(graph,
              pcs_test::Range_archetype(scans[t].size()),
              maps(t).point_map(pcs_test::Map_archetype<Bare_point>(scans[t])));
    if (t == 2) {
      space.build();
      BOOST_TEST(space.distance(space.embed(graph, maps(2)), space.tree(2)) <
                 0.2 * space.distance(0, 2));
    }
  }
  const pcs::Orl_tree tree = pcs::mean_tree(space);
  std::vector<Bare_point> out(tree.number_of_points(), Bare_point(0, 0, 0));
  pcs_test::Range_archetype range(out.size());
  BOOST_TEST(space.points(tree, range, np::point_map(pcs_test::Map_archetype<Bare_point>(out))) ==
             out.size());
  double high = 0;
  for (const Bare_point& p : out)
    high = std::max(high, p.z());
  BOOST_TEST(high > 5);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_topology

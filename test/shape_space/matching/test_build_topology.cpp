// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The common topology of two trees contains each of their branches once, with counterparts of all
// nodes.

#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/build_topology.h>
#include <support/rooted_trees.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

namespace test_build_topology {

using namespace pcs::shape_space;
using namespace pcs::shape_space::internal;
using pcs::Matching_weights;
using pcs_test::rooted;
using pcs_test::Stick;

namespace {

/// Two trees and their common topology.
struct Matched_trees
{
  std::array<Rooted_tree, 2> tree;
  Common_topology common;

  Matched_trees(Rooted_tree one, Rooted_tree two) : tree{std::move(one), std::move(two)}
  {
    using Matching = Branch_matching<CGAL::Sequential_tag>;
    const Matching_weights weights;
    common.paths = {Matching::find_paths(tree[0], weights), Matching::find_paths(tree[1], weights)};
    Matching matching(tree[0], tree[1], weights, common.paths);
    pcs::internal::Progress progress;
    const auto trunk = matching.run(progress);
    common.branches = Topology_builder(tree[0], tree[1], common.paths).run(*trunk);
  }

  const Branch_path& path(const Common_branch& branch, std::size_t t) const
  {
    return common.paths[t].paths[branch.path[t]];
  }
  /// Total length of the existing branches of a tree.
  double length(std::size_t t) const
  {
    double sum = 0;
    for (const Common_branch& branch : common.branches)
      sum += branch.is_virtual(int(t)) ? 0 : path(branch, t).length();
    return sum;
  }
};

bool increases(const std::vector<double>& values)
{
  return std::adjacent_find(values.begin(), values.end(), [](double a, double b) {
           return !(a < b);
         }) == values.end();
}

/// A correspondence that is faster at first.
std::vector<double> bent_gamma()
{
  std::vector<double> gamma;
  for (int k = 0; k <= 64; ++k)
    gamma.push_back(std::sqrt(k / 64.0 * (0.5 + 0.5 * k / 64.0)));
  return gamma;
}

const Stick trunk{pcs::npos, 0, Vec3(0, 0, 4), 8};
const Stick low{0, 3, Vec3(1, 0, 0.5)}, high{0, 6, Vec3(0, 0.8, 0.3)};

} // namespace

BOOST_AUTO_TEST_SUITE(common_topologies)

BOOST_AUTO_TEST_CASE(branches_of_equal_trees_are_common_at_the_same_places)
{
  const Matched_trees m(rooted(orl_test::random_tree(1)), rooted(orl_test::random_tree(1)));
  BOOST_TEST(m.common.branches.size() == 1u + 6 + 36);
  for (const Common_branch& branch : m.common.branches) {
    BOOST_TEST(branch.path[0] == branch.path[1]);
    BOOST_TEST(std::abs(branch.attachment[0] - branch.attachment[1]) < 1e-9);
    BOOST_TEST_REQUIRE(branch.node[0].size() == branch.node[1].size());
    for (std::size_t k = 0; k < branch.node[0].size(); ++k)
      BOOST_TEST(std::abs(branch.node[0][k] - branch.node[1][k]) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(each_tree_is_there_as_a_whole_and_once)
{
  const Matched_trees m(rooted(orl_test::random_tree(2, 5)), rooted(orl_test::random_tree(3, 6)));
  std::size_t number_of_common = 0;
  for (std::size_t b = 0; b < m.common.branches.size(); ++b) {
    const Common_branch& branch = m.common.branches[b];
    BOOST_TEST((b == 0 ? branch.parent == none : branch.parent < b));
    number_of_common += !branch.is_virtual(0) && !branch.is_virtual(1);
    for (std::size_t t = 0; t < 2; ++t) {
      if (branch.is_virtual(int(t)))
        continue;
      const std::vector<double>& node = branch.node[t];
      BOOST_TEST_REQUIRE(node.size() == branch.number_of_nodes());
      BOOST_TEST(node.front() == 0);
      BOOST_TEST(node.back() == 1);
      BOOST_TEST(increases(node));
      // Its parent is an existing branch, at the original position.
      if (b == 0)
        continue;
      const Common_branch& parent = m.common.branches[branch.parent];
      BOOST_TEST_REQUIRE(!parent.is_virtual(int(t)));
      const auto k =
          std::min(static_cast<std::size_t>(branch.attachment[t]), parent.node[t].size() - 2);
      const double s = parent.node[t][k] + (branch.attachment[t] - double(k)) *
                                               (parent.node[t][k + 1] - parent.node[t][k]);
      const Vec3 seat = point_at(m.tree[t], m.path(parent, t), s * m.path(parent, t).length());
      BOOST_TEST((seat - m.tree[t].points[m.path(branch, t).nodes[0]]).norm() <
                 1e-6 * m.tree[t].extent);
    }
  }
  BOOST_TEST(number_of_common > 5u);
  for (std::size_t t = 0; t < 2; ++t)
    BOOST_TEST(std::abs(m.length(t) / m.tree[t].weights[0] - 1) < 1e-9);
}

BOOST_AUTO_TEST_CASE(a_branch_of_one_tree_is_virtual_in_the_other)
{
  const auto check = [](const Matched_trees& m, int without, const Stick& missing) {
    BOOST_TEST_REQUIRE(m.common.branches.size() == 3u);
    int number_of_virtual = 0;
    for (const Common_branch& branch : m.common.branches) {
      BOOST_TEST(!branch.is_virtual(1 - without));
      if (!branch.is_virtual(without))
        continue;
      ++number_of_virtual;
      BOOST_TEST(branch.parent == 0u);
      BOOST_TEST(branch.attachment[0] == branch.attachment[1]);
      BOOST_TEST(branch.node[std::size_t(without)].empty());
      BOOST_TEST(std::abs(m.path(branch, std::size_t(1 - without)).length() - missing.way.norm()) <
                 1e-9);
    }
    BOOST_TEST(number_of_virtual == 1);
  };
  check(Matched_trees(rooted({trunk, low, high}), rooted({trunk, low})), 1, high);
  check(Matched_trees(rooted({trunk, low}), rooted({trunk, low, high})), 0, high);
  check(Matched_trees(rooted({trunk, low, high}), rooted({trunk, high})), 1, low);
}

BOOST_AUTO_TEST_CASE(close_nodes_of_two_branches_are_one_node)
{
  std::vector<double> straight;
  for (int k = 0; k <= 64; ++k)
    straight.push_back(k / 64.0);
  const Warp warp(straight, {{0, 0}, {0.5, 0.5}, {1, 1}});
  Branch_path one, two;
  one.arc = {0, 3, 5, 6, 10};
  two.arc = {0, 1.525, 2.9875, 3.5, 5}; // in halves
  const Place_pair expected[] =
      {{0, 0}, {0.3, 0.305}, {0.5, 0.5}, {0.6, 0.5975}, {0.7, 0.7}, {1, 1}};
  const std::vector<Place_pair> nodes = common_nodes(one, two, warp);
  BOOST_TEST_REQUIRE(nodes.size() == std::size(expected));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    BOOST_TEST(std::abs(nodes[k].a - expected[k].a) < 1e-9);
    BOOST_TEST(std::abs(nodes[k].b - expected[k].b) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(of_forks_that_cross_the_heavier_ones_correspond)
{
  const auto places = [](const std::vector<Place_pair>& chain) {
    std::vector<double> values;
    for (const Place_pair& p : chain)
      values.insert(values.end(), {p.a, p.b});
    return values;
  };
  using Values = std::vector<double>;
  BOOST_TEST(places(heaviest_chain({})) == (Values{0, 0, 1, 1}));
  BOOST_TEST(places(heaviest_chain({{{0.7, 0.8}, 1}, {{0.3, 0.2}, 1}})) ==
             (Values{0, 0, 0.3, 0.2, 0.7, 0.8, 1, 1}));
  for (const double first : {1.0, 3.0}) // the order of the two differs between the trees
    BOOST_TEST(places(heaviest_chain({{{0.4, 0.6}, first}, {{0.6, 0.4}, 2}})) ==
               (first > 2 ? Values{0, 0, 0.4, 0.6, 1, 1} : Values{0, 0, 0.6, 0.4, 1, 1}));
  // Many small weights exceed one that crosses all of them.
  BOOST_TEST(places(heaviest_chain({{{0.3, 0.3}, 1}, {{0.5, 0.5}, 1}, {{0.25, 0.55}, 1.5}})) ==
             (Values{0, 0, 0.3, 0.3, 0.5, 0.5, 1, 1}));
  BOOST_TEST(places(heaviest_chain({{{0.1, 0.9}, 9}})) == (Values{0, 0, 1, 1})); // too steep
}

BOOST_AUTO_TEST_CASE(a_warp_leads_there_and_back_through_its_anchors)
{
  const std::vector<Place_pair> anchors{{0, 0}, {0.3, 0.5}, {0.8, 0.7}, {1, 1}};
  const Warp warp(bent_gamma(), anchors);
  for (const Place_pair& p : anchors) {
    BOOST_TEST(std::abs(warp.forward(p.a) - p.b) < 1e-12);
    BOOST_TEST(std::abs(warp.backward(p.b) - p.a) < 1e-9);
  }
  double last = -1;
  for (int k = 0; k <= 100; ++k) {
    const double b = warp.forward(k / 100.0);
    BOOST_TEST(b > last);
    BOOST_TEST(std::abs(warp.backward(b) - k / 100.0) < 1e-9);
    last = b;
  }
  // Parameters of nodes are fractions of the intervals between anchors.
  const std::vector<double> node{0, 0.2, 0.6, 1};
  for (const auto& [s, number] : std::vector<std::pair<double, double>>{{0, 0},
                                                                        {0.1, 0.5},
                                                                        {0.2, 1},
                                                                        {0.5, 1.75},
                                                                        {1, 3},
                                                                        {1.5, 3}})
    BOOST_TEST(std::abs(node_number(node, s) - number) < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_build_topology

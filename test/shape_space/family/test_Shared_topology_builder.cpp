// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The topology of many trees contains each branch of each tree once, in every order of the trees.

#include <pcs/internal/progress.h>
#include <pcs/shape_space/family/Shared_topology_builder.h>
#include <support/rooted_trees.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace test_Shared_topology_builder {

using namespace pcs::shape_space;
using pcs::Matching_weights;
using pcs_test::rooted;
using pcs_test::Stick;

namespace {

constexpr std::size_t rounds = 3;

struct Family
{
  std::vector<Rooted_tree> trees;
  Shared_topology_builder<CGAL::Sequential_tag> builder;

  explicit Family(std::vector<Rooted_tree> all)
    : trees(std::move(all)), builder(pointers(), Matching_weights(), rounds)
  {
    pcs::internal::Progress progress;
    BOOST_TEST(builder.run(progress));
  }

  const std::vector<Shared_branch>& branches() { return builder.branches(); }
  const Branch_path& path(const Shared_branch& branch, std::size_t t)
  {
    return builder.paths()[t].paths[branch.path[t]];
  }
  /// Total length of all branches of a tree.
  double length(std::size_t t)
  {
    double sum = 0;
    for (const Shared_branch& branch : branches())
      sum += branch.has(t) ? path(branch, t).length() : 0;
    return sum;
  }

private:
  std::vector<const Rooted_tree*> pointers() const
  {
    std::vector<const Rooted_tree*> result;
    for (const Rooted_tree& tree : trees)
      result.push_back(&tree);
    return result;
  }
};

const Stick trunk{pcs::npos, 0, Vec3(0, 0, 4), 8};
const Stick low{0, 3, Vec3(1, 0, 0.5)}, high{0, 6, Vec3(0, 0.8, 0.3)};

/// Trees of one kind, each without some of the branches.
std::vector<Rooted_tree> random_family()
{
  std::vector<Rooted_tree> trees;
  const std::vector<orl_test::Branch> branches = orl_test::random_branches(4, 4);
  const orl_test::Turns turns(branches.size(), Eigen::Matrix3d::Identity());
  for (std::size_t t = 0; t < 4; ++t) {
    std::vector<char> is_kept(branches.size(), 1);
    for (std::size_t b = 1 + t; b < branches.size(); b += 5)
      is_kept[b] = 0;
    std::vector<std::size_t> tip;
    trees.push_back(rooted(orl_test::make_tree(branches, turns, is_kept, tip)));
  }
  return trees;
}

} // namespace

BOOST_AUTO_TEST_SUITE(shared_topologies)

BOOST_AUTO_TEST_CASE(copies_of_a_tree_share_all_branches)
{
  const Rooted_tree tree = rooted(orl_test::random_tree(1));
  Family family({tree, tree, tree});
  BOOST_TEST(family.branches().size() == 1u + 6 + 36);
  for (const Shared_branch& branch : family.branches()) {
    BOOST_TEST(branch.number_of_members() == 3u);
    BOOST_TEST(branch.path[1] == branch.path[0]);
    BOOST_TEST(branch.path[2] == branch.path[0]);
  }
  BOOST_TEST(family.builder.fraction_of_changed_matches() == 0);
}

BOOST_AUTO_TEST_CASE(a_branch_of_one_tree_has_one_member)
{
  Family family({rooted({trunk, low}), rooted({trunk, low, high}), rooted({trunk, low})});
  BOOST_TEST_REQUIRE(family.branches().size() == 3u);
  for (const Shared_branch& branch : family.branches()) {
    const bool is_shared = branch.has(0);
    BOOST_TEST(branch.number_of_members() == (is_shared ? 3u : 1u));
    if (is_shared)
      continue;
    BOOST_TEST(branch.has(1));
    BOOST_TEST(branch.parent == 0u);
    BOOST_TEST(std::abs(family.path(branch, 1).length() - high.way.norm()) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(each_tree_is_there_as_a_whole_and_once)
{
  Family family(random_family());
  for (std::size_t t = 0; t < family.trees.size(); ++t)
    BOOST_TEST(std::abs(family.length(t) / family.trees[t].weights[0] - 1) < 1e-9);
  std::size_t number_of_shared = 0;
  for (std::size_t b = 0; b < family.branches().size(); ++b) {
    const Shared_branch& branch = family.branches()[b];
    BOOST_TEST((b == 0 ? branch.parent == none : branch.parent < b));
    BOOST_TEST(branch.number_of_members() > 0u);
    number_of_shared += branch.number_of_members() > 1;
    for (std::size_t t = 0; t < family.trees.size(); ++t) {
      if (!branch.has(t))
        continue;
      BOOST_TEST((b == 0 || family.branches()[branch.parent].has(t)));
      const std::vector<double>& node = branch.node[t];
      BOOST_TEST_REQUIRE(node.size() == branch.number_of_edges + 1);
      BOOST_TEST(node.front() == 0);
      BOOST_TEST(node.back() == 1);
      for (std::size_t k = 1; k < node.size(); ++k)
        BOOST_TEST(node[k - 1] < node[k]);
    }
  }
  BOOST_TEST(number_of_shared > 5u);
}

BOOST_AUTO_TEST_CASE(the_order_of_trees_plays_no_part)
{
  std::vector<Rooted_tree> trees = random_family();
  Family first(trees);
  std::rotate(trees.begin(), trees.begin() + 1, trees.end());
  Family second(trees);
  const std::size_t n = trees.size();
  BOOST_TEST_REQUIRE(first.branches().size() == second.branches().size());
  for (std::size_t b = 0; b < first.branches().size(); ++b)
    for (std::size_t t = 0; t < n; ++t)
      BOOST_TEST(first.branches()[b].path[(t + 1) % n] == second.branches()[b].path[t]);
}

BOOST_AUTO_TEST_CASE(of_a_further_tree_what_the_family_has_is_found)
{
  const std::vector<Rooted_tree> trees{rooted({trunk, low}), rooted({trunk, low})};
  Family family(trees);
  const Reference_tree reference =
      make_reference(make_layout(family.branches()), family.builder.reference());
  const auto project = [&](const Rooted_tree& tree, std::vector<Shared_branch>& branches) {
    branches = family.branches();
    Branch_paths paths;
    Shared_topology_builder<CGAL::Sequential_tag> builder({&tree}, Matching_weights(), 1);
    return builder.project(tree, reference, branches, paths);
  };
  std::vector<Shared_branch> branches;
  BOOST_TEST(std::abs(project(trees[0], branches) - 1) < 1e-9);
  const Rooted_tree more = rooted({trunk, low, high});
  BOOST_TEST(std::abs(project(more, branches) - (1 - high.way.norm() / more.weights[0])) < 1e-9);
  BOOST_TEST(branches.size() == 2u); // no branch is added
  BOOST_TEST(project(rooted({trunk}), branches) == 1);
  BOOST_TEST(!branches[1].has(0));

  pcs::internal::Progress stop([](double) { return false; });
  Shared_topology_builder<CGAL::Sequential_tag> stopped({&trees[0]}, Matching_weights(), rounds);
  BOOST_TEST(!stopped.run(stop));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Shared_topology_builder

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The matching of minimal energy: equal trees have no cost, an unmatched branch costs its length.

#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/Branch_matching.h>
#include <support/rooted_trees.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_Branch_matching {

using namespace pcs::shape_space;
using pcs::Matching_weights;
using pcs_test::rooted;
using pcs_test::Stick;

namespace {

using Matching = Branch_matching<CGAL::Sequential_tag>;

Matching matching_of(const Rooted_tree& one, const Rooted_tree& two)
{
  const Matching_weights weights;
  return Matching(one,
                  two,
                  weights,
                  {Matching::find_paths(one, weights), Matching::find_paths(two, weights)});
}

double cost_of(const Rooted_tree& one, const Rooted_tree& two)
{
  pcs::internal::Progress progress;
  Matching matching = matching_of(one, two);
  return matching.run(progress)->cost;
}

/// Calls `visit` for a pair of branches and for all its descendants.
template <class Match, class Visit>
void for_each_pair(const Match& match, const Visit& visit)
{
  visit(match);
  for (const auto& pair : match.pairs)
    for_each_pair(*pair.branch, visit);
}

/// A tree with a limb that forks into an upper and a lower part of these lengths. Upper twigs point
/// to one side, and lower twigs to the other.
Rooted_tree tree_with_forked_limb(double upper, double lower)
{
  std::vector<Stick> sticks = {{pcs::npos, 0, Vec3(0, 0, 4), 8},
                               {0, 3, Vec3(1.5, 0, 0)},
                               {1, 4, upper * Vec3(0.8, 0, 0.6)},
                               {1, 4, lower * Vec3(0.8, 0, -0.6)},
                               {0, 1, Vec3(0, 2, 0.3)},
                               {0, 5, Vec3(0, -2, 0.3)},
                               {0, 6, Vec3(0, 1.5, 0.3)}};
  for (const std::size_t at : {1u, 2u, 3u}) {
    sticks.push_back({2, at, Vec3(0, 0.4, 0)});
    sticks.push_back({3, at, Vec3(0, -0.4, 0)});
  }
  return rooted(sticks);
}

const Stick trunk{pcs::npos, 0, Vec3(0, 0, 4), 8};
const Stick low{0, 3, Vec3(1, 0, 0.5)}, high{0, 6, Vec3(0, 0.8, 0.3)};

} // namespace

BOOST_AUTO_TEST_SUITE(matchings_of_branches)

BOOST_AUTO_TEST_CASE(each_branch_of_equal_trees_is_its_own_partner_at_no_cost)
{
  const Rooted_tree tree = rooted(orl_test::random_tree(1));
  Matching matching = matching_of(tree, tree);
  pcs::internal::Progress progress;
  const auto found = matching.run(progress);
  BOOST_TEST_REQUIRE(bool(found));
  BOOST_TEST(std::abs(found->cost) < 1e-9);
  std::size_t count = 0;
  for_each_pair(*found, [&](const auto& match) {
    ++count;
    BOOST_TEST(match.path_1 == match.path_2);
    BOOST_TEST((match.rotation - Eigen::Matrix3d::Identity()).norm() < 1e-6);
  });
  BOOST_TEST(count == 1u + 6 + 36); // all branches of the tree
}

BOOST_AUTO_TEST_CASE(what_has_no_partner_costs_its_length)
{
  const Rooted_tree more = rooted({trunk, low, high}), less = rooted({trunk, low});
  const double single = Matching_weights().unmatched * high.way.norm() / trunk.way.norm();
  BOOST_TEST(std::abs(cost_of(more, less) - single) < 1e-9);
  BOOST_TEST(std::abs(cost_of(less, more) - single) < 1e-9);
  BOOST_TEST(cost_of(more, more) < 1e-9);
  // No pair costs more than both branches unmatched.
  const Rooted_tree one = rooted(orl_test::random_tree(2)), two = rooted(orl_test::random_tree(3));
  Matching matching = matching_of(one, two);
  pcs::internal::Progress progress;
  const auto found = matching.run(progress);
  const Matching_energy& energy = matching.energy();
  std::size_t count = 0;
  for_each_pair(*found, [&](const auto& match) {
    ++count;
    const std::size_t a = matching.paths(0).paths[match.path_1].nodes[count > 1 ? 1 : 0];
    const std::size_t b = matching.paths(1).paths[match.path_2].nodes[count > 1 ? 1 : 0];
    BOOST_TEST(match.cost <=
               energy.single_term(energy.weight(0, a)) + energy.single_term(energy.weight(1, b)));
  });
  BOOST_TEST(count > 10u);
}

BOOST_AUTO_TEST_CASE(the_cost_does_not_change_with_place_stand_and_unit)
{
  const orl_test::Tree a = orl_test::random_tree(4), b = orl_test::random_tree(5);
  const double cost = cost_of(rooted(a), rooted(b));
  BOOST_TEST(cost > 0.1);
  const double there = cost_of(rooted(pcs_test::elsewhere(a)), rooted(pcs_test::elsewhere(b)));
  BOOST_TEST(std::abs(there - cost) < 1e-6 * cost);
  // The unit and the position of one tree do not change the result.
  const double moved =
      cost_of(rooted(a),
              rooted(orl_test::moved(b, Eigen::Matrix3d::Identity(), Vec3(1, 2, 3), 0.1)));
  BOOST_TEST(std::abs(moved - cost) < 1e-6 * cost);
}

BOOST_AUTO_TEST_CASE(a_turn_of_the_whole_tree_costs_nothing_where_it_is_told)
{
  const orl_test::Tree tree = orl_test::random_tree(6);
  const Eigen::AngleAxisd turn(1.3, Vec3::UnitZ());
  const Rooted_tree one = rooted(tree),
                    two = rooted(orl_test::moved(tree, turn.toRotationMatrix(), Vec3::Zero()));
  Matching matching = matching_of(one, two);
  pcs::internal::Progress progress;
  BOOST_TEST(matching.run(progress)->cost > 0.1);
  matching.set_turn(-1.3, Vec3::UnitZ()); // back
  BOOST_TEST(matching.look() < 1e-6);
  const auto found = matching.run(progress);
  BOOST_TEST(found->cost < 1e-6);
  BOOST_TEST((found->rotation - turn.inverse().toRotationMatrix()).norm() < 1e-6);
}

BOOST_AUTO_TEST_CASE(a_limb_follows_the_same_part_where_the_longer_one_changes)
{
  const Rooted_tree one = tree_with_forked_limb(1, 0.6), two = tree_with_forked_limb(0.6, 1);
  Matching matching = matching_of(one, two);
  pcs::internal::Progress progress;
  const auto found = matching.run(progress);
  std::size_t count = 0;
  for_each_pair(*found, [&](const auto& match) {
    const Vec3 a = one.points[matching.paths(0).paths[match.path_1].tip()];
    const Vec3 b = two.points[matching.paths(1).paths[match.path_2].tip()];
    ++count;
    BOOST_TEST((a - b).norm() < 0.5); // 1.2 between the parts, 0.8 between their twigs
  });
  BOOST_TEST(count == 12u); // a part of the limb is a child of the limb
}

BOOST_AUTO_TEST_CASE(opposite_branches_of_a_parent_with_very_many_stay_opposite)
{
  // the second members are long and short in turn, in another order in the second tree
  constexpr std::size_t pairs = 300;
  const auto tree_with_pairs = [](std::size_t phase) {
    std::vector<Stick> sticks = {{pcs::npos, 0, Vec3(0, 0, 40), 2 * pairs + 2}};
    for (std::size_t k = 0; k < pairs; ++k) {
      sticks.push_back({0, 2 * k + 1, Vec3(1, 0, 0.2), 1});
      sticks.push_back(
          {0, 2 * k + 1, (k + phase) % 2 == 0 ? Vec3(-1, 0, 0.2) : Vec3(-0.2, 0, 0), 1});
    }
    return rooted(sticks);
  };
  const Rooted_tree one = tree_with_pairs(0), two = tree_with_pairs(1);
  Matching matching = matching_of(one, two);
  pcs::internal::Progress progress;
  const auto found = matching.run(progress);
  std::vector<std::size_t> partner(one.size(), none);
  std::size_t count = 0, separate = 0;
  for (const auto& pair : found->pairs) {
    const auto& child_1 = matching.paths(0).paths[found->path_1].children[pair.child_1];
    const auto& child_2 = matching.paths(1).paths[found->path_2].children[pair.child_2];
    std::size_t& node = partner[one.parents[child_1.start]];
    separate += node != none && node != two.parents[child_2.start] ? 1 : 0;
    node = two.parents[child_2.start];
    ++count;
  }
  BOOST_TEST(count > 2 * pairs - 10);
  BOOST_TEST(separate == 0u);
}

BOOST_AUTO_TEST_CASE(nothing_is_returned_above_a_limit_or_when_asked_to_stop)
{
  const Rooted_tree one = rooted({trunk, low, high}), two = rooted({trunk, low});
  pcs::internal::Progress progress;
  Matching matching = matching_of(one, two);
  const double cost = matching.run(progress)->cost;
  BOOST_TEST(!matching.run(progress, 0.99 * cost));
  BOOST_TEST_REQUIRE(bool(matching.run(progress, 1.01 * cost)));
  BOOST_TEST(std::abs(matching.run(progress, 1.01 * cost)->cost - cost) < 1e-12);
  pcs::internal::Progress stop([](double) { return false; });
  BOOST_TEST(!matching.run(stop));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Branch_matching

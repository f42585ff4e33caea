// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the score that tells trees of a habit from others.

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/edit_branches.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/score_tree.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <string>

namespace test_score_tree {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
namespace np = pcs::parameters;

namespace {

Tree grown(const pcs::Tree_habit& habit, int seed)
{
  Tree tree;
  pcs::grow_tree(tree, habit, np::random_seed(seed));
  return tree;
}

pcs::Tree_habit_fit fruit_fit()
{
  pcs::Tree_habit_fit fit;
  fit.habit = pcs::fruit_habit();
  fit.allometry.height = fit.habit.height;
  return fit;
}

} // namespace

BOOST_AUTO_TEST_SUITE(score_tree)

BOOST_AUTO_TEST_CASE(trees_of_the_habit_have_uniform_shares)
{
  const pcs::Tree_habit_fit fit = fruit_fit();
  double mean = 0;
  int small = 0;
  constexpr int number = 40;
  for (int seed = 100; seed < 100 + number; ++seed) {
    const auto score = pcs::score_tree(grown(fit.habit, seed), fit, np::number_of_simulations(60));
    mean += score.share / number;
    small += score.share < 0.1 ? 1 : 0;
  }
  BOOST_TEST(std::abs(mean - 0.5) < 3 * std::sqrt(1 / 12.0 / number));
  BOOST_TEST(small <= 10); // 4 expected, 6 of 40 with probability 0.2
}

BOOST_AUTO_TEST_CASE(another_habit_is_an_outlier)
{
  const pcs::Tree_habit_fit fit = fruit_fit();
  const auto score = pcs::score_tree(grown(pcs::weeping_habit().scaled(0.45), 3), fit);
  BOOST_TEST(score.share < 0.02);
  BOOST_TEST(score.distance > 3);
  for (std::size_t k = 1; k < score.deviations.size(); ++k)
    BOOST_TEST(std::abs(score.deviations[k].deviation) <=
               std::abs(score.deviations[k - 1].deviation));
}

BOOST_AUTO_TEST_CASE(a_damaged_tree_is_an_outlier_and_the_damage_is_named)
{
  const pcs::Tree_habit_fit fit = fruit_fit();
  Tree tree = grown(fit.habit, 3);
  for (std::size_t id = 1; id <= 12; ++id) // more than half of the branches on the trunk
    tree = pcs::prune_branch(tree, id);
  const auto score = pcs::score_tree(tree, fit);
  BOOST_TEST(score.share < 0.05);
  double number = 0;
  for (const pcs::Tree_deviation& d : score.deviations)
    number = d.name == "order 1: number" ? d.deviation : number;
  BOOST_TEST(number < -4);
}

BOOST_AUTO_TEST_CASE(threads_do_not_change_a_bit)
{
  const pcs::Tree_habit_fit fit = fruit_fit();
  const Tree tree = grown(fit.habit, 3);
  const auto options = np::number_of_simulations(20).random_seed(5);
  const auto a = pcs::score_tree<CGAL::Sequential_tag>(tree, fit, options);
  const auto b = pcs::score_tree(tree, fit, options);
  BOOST_TEST(a.distance == b.distance);
  BOOST_TEST(a.share == b.share);
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused)
{
  const pcs::Tree_habit_fit fit = fruit_fit();
  BOOST_CHECK_THROW(pcs::score_tree(Tree(), fit), pcs::Invalid_input);
  pcs::Tree_habit_fit bad = fit;
  bad.habit.taper[1] = 0;
  BOOST_CHECK_THROW(pcs::score_tree(grown(fit.habit, 3), bad), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::score_tree(grown(fit.habit, 3), fit, np::number_of_simulations(1)),
                    pcs::Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_score_tree

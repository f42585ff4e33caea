// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of fitting a habit: known parameters of virtual trees are found.

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/fit_tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/internal/constants.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace test_fit_tree_habit {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
namespace np = pcs::parameters;
using pcs::internal::pi;

namespace {

Tree grown(const pcs::Tree_habit& habit, int seed)
{
  Tree tree;
  pcs::grow_tree(tree, habit, np::random_seed(seed));
  return tree;
}

std::vector<Tree> two_fruit_trees()
{
  return {grown(pcs::fruit_habit(), 5), grown(pcs::fruit_habit(), 6)};
}

const pcs::Habit_value& value_of(const pcs::Tree_habit_fit& fit, const std::string& name)
{
  const auto found = std::find_if(fit.values.begin(),
                                  fit.values.end(),
                                  [&](const pcs::Habit_value& v) { return v.name == name; });
  BOOST_TEST_REQUIRE((found != fit.values.end()), name);
  return *found;
}

/// Whether the true value is within 10 % of the estimate, or inside its interval.
bool is_found(const pcs::Habit_value& v, double truth)
{
  return std::abs(v.value - truth) <= 0.1 * std::abs(truth) ||
         (v.least <= truth && truth <= v.largest);
}

} // namespace

BOOST_AUTO_TEST_SUITE(fit_tree_habit)

BOOST_AUTO_TEST_CASE(known_parameters_are_found)
{
  const pcs::Tree_habit truth = pcs::fruit_habit();
  const auto fit = pcs::fit_tree_habit(two_fruit_trees(), np::number_of_simulations(40));
  const pcs::Tree_habit& h = fit.habit;
  BOOST_TEST(h.height == truth.height, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(h.trunk_radius == truth.trunk_radius, boost::test_tools::tolerance(0.01));
  BOOST_TEST(h.number_of_orders == truth.number_of_orders);
  BOOST_TEST(h.number_of_leaders == truth.number_of_leaders);
  BOOST_TEST(h.number_of_stubs == truth.number_of_stubs);
  BOOST_TEST(h.whorl == truth.whorl);
  BOOST_TEST((h.crown == truth.crown));
  BOOST_TEST(h.largest_step == truth.largest_step, boost::test_tools::tolerance(1e-6));
  BOOST_TEST(h.smallest_step == truth.smallest_step, boost::test_tools::tolerance(1e-6));
  const auto check = [&](const std::string& name, double expected) {
    const pcs::Habit_value& v = value_of(fit, name);
    BOOST_TEST(v.is_identified, name);
    BOOST_TEST(is_found(v, expected),
               name << ": " << v.value << " [" << v.least << ", " << v.largest << "], expected "
                    << expected);
    BOOST_TEST((v.least <= v.value && v.value <= v.largest), name);
    BOOST_TEST(v.largest - v.least < 0.6 * expected, name); // an interval that says something
  };
  check("flare", truth.flare);
  check("flare_height", truth.flare_height);
  check("taper[0]", truth.taper[0]);
  check("taper[1]", truth.taper[1]);
  check("tip_share[1]", truth.tip_share[1]);
  check("tip_radius", truth.tip_radius);
  check("spacing[0]", truth.spacing[0]);
  check("spacing[1]", truth.spacing[1]);
  check("bare[0]", truth.bare[0]);
  check("insertion[0].least", truth.insertion[0].least);
  check("insertion[1].largest", truth.insertion[1].largest);
  check("child_radius[1].least", truth.child_radius[1].least);
  check("child_radius[1].largest", truth.child_radius[1].largest);
  check("smallest_branch", truth.smallest_branch);
  check("slenderness.least", truth.slenderness.least);
  check("slenderness.largest", truth.slenderness.largest);
  check("crown_radius", truth.crown_radius);
  check("flattest_section", truth.flattest_section);
  check("bend[2]", truth.bend[2] * h.bend_length / truth.bend_length);
}

BOOST_AUTO_TEST_CASE(branches_below_the_resolution_leave_no_bias)
{
  // a fifth of the branches is thinner than 4 mm, and most tips are
  const pcs::Tree_habit truth = pcs::fruit_habit();
  const auto fit =
      pcs::fit_tree_habit(two_fruit_trees(), np::number_of_simulations(40).smallest_radius(0.004));
  for (const char* name : {"spacing[0]", "spacing[1]", "taper[1]"}) {
    const std::string text = name;
    const double expected = text == "spacing[0]"   ? truth.spacing[0]
                            : text == "spacing[1]" ? truth.spacing[1]
                                                   : truth.taper[1];
    const pcs::Habit_value& v = value_of(fit, name);
    BOOST_TEST(is_found(v, expected), name << ": " << v.value << ", expected " << expected);
  }
  BOOST_TEST(!value_of(fit, "tip_radius").is_identified);
  BOOST_TEST(!value_of(fit, "smallest_branch").is_identified);
  BOOST_TEST(fit.smallest_radius == 0.004);
}

BOOST_AUTO_TEST_CASE(whorls_forks_and_stubs_are_counted)
{
  const auto conifer = pcs::fit_tree_habit(std::vector<Tree>{grown(pcs::conifer_habit(), 2)},
                                           np::number_of_simulations(20));
  BOOST_TEST(conifer.habit.whorl == 5u);
  BOOST_TEST((conifer.habit.crown == pcs::Crown_shape::cone));
  BOOST_TEST(conifer.crown_margin > 2);
  BOOST_TEST(conifer.habit.number_of_orders == 3);
  BOOST_TEST(!value_of(conifer, "spacing[2]").is_identified); // there is no order 3

  const auto forked = pcs::fit_tree_habit(std::vector<Tree>{grown(pcs::forked_habit(), 2)},
                                          np::number_of_simulations(20));
  BOOST_TEST(forked.habit.number_of_leaders == 2u);
  BOOST_TEST(forked.habit.number_of_stubs == 3u);
  BOOST_TEST(is_found(value_of(forked, "fork"), pcs::forked_habit().fork));
  BOOST_TEST(!value_of(forked, "fork_angle.least").is_identified);
}

BOOST_AUTO_TEST_CASE(another_unit_scales_the_lengths)
{
  std::vector<Tree> large = {grown(pcs::fruit_habit().scaled(1024), 5),
                             grown(pcs::fruit_habit().scaled(1024), 6)};
  const auto a = pcs::fit_tree_habit(two_fruit_trees(), np::number_of_simulations(20));
  const auto b = pcs::fit_tree_habit(large, np::number_of_simulations(20));
  for (std::size_t i = 0; i < a.values.size(); ++i)
    if (a.values[i].is_identified && a.values[i].unit != "rad") {
      const double scale = a.values[i].unit == "L" ? 1024 : 1;
      BOOST_TEST(std::abs(b.values[i].value - scale * a.values[i].value) <=
                     0.02 * scale * std::abs(a.values[i].value) + 0.002,
                 a.values[i].name);
    }
}

BOOST_AUTO_TEST_CASE(trees_of_several_heights_give_an_allometry)
{
  pcs::Tree_habit_fit model;
  model.habit = pcs::fruit_habit();
  model.allometry.trunk_radius_exponent = 1.2;
  model.allometry.crown_radius_exponent = 0.8;
  std::vector<Tree> trees;
  for (const double height : {2.0, 3.0, 4.5, 6.5})
    trees.push_back(grown(pcs::habit_at_height(model, height), static_cast<int>(10 * height)));
  const auto fit = pcs::fit_tree_habit(trees, np::number_of_simulations(20));
  BOOST_TEST(fit.allometry.is_identified);
  BOOST_TEST(fit.allometry.height == std::pow(2.0 * 3.0 * 4.5 * 6.5, 0.25),
             boost::test_tools::tolerance(1e-6));
  BOOST_TEST(std::abs(fit.allometry.trunk_radius_exponent - 1.2) < 0.05);
  BOOST_TEST(std::abs(fit.allometry.crown_radius_exponent - 0.8) <
             0.1 + 3 * fit.allometry.crown_radius_error);
  const auto one = pcs::fit_tree_habit(two_fruit_trees(), np::number_of_simulations(20));
  BOOST_TEST(!one.allometry.is_identified);
  BOOST_TEST(one.allometry.trunk_radius_exponent == 1.5);
}

BOOST_AUTO_TEST_CASE(distributions_are_those_of_the_branches)
{
  const Tree tree = grown(pcs::fruit_habit(), 5);
  const auto fit = pcs::fit_tree_habit(std::vector<Tree>{tree}, np::number_of_simulations(20));
  const auto& branches = tree[boost::graph_bundle].branches;
  std::size_t number = 0;
  for (const pcs::Habit_distribution& d : fit.distributions) {
    number += d.number_of_branches;
    const auto of_order = std::count_if(branches.begin(), branches.end(), [&](const auto& b) {
      return b.order == d.order;
    });
    BOOST_TEST(d.number_of_branches == static_cast<std::size_t>(of_order));
    BOOST_TEST(std::is_sorted(d.length.begin(), d.length.end()));
    BOOST_TEST(std::is_sorted(d.insertion.begin(), d.insertion.end()));
  }
  BOOST_TEST(number == branches.size());
  BOOST_TEST(fit.distributions.front().length[2] == 3.2, boost::test_tools::tolerance(1e-9));
  const pcs::Value_range ratio = pcs::fruit_habit().child_radius[1];
  BOOST_TEST(fit.distributions[2].radius_ratio[0] >= ratio.least);
  BOOST_TEST(fit.distributions[2].radius_ratio[4] <= ratio.largest);
}

BOOST_AUTO_TEST_CASE(threads_do_not_change_a_bit)
{
  const std::vector<Tree> trees = two_fruit_trees();
  const auto options = np::number_of_simulations(20).random_seed(3);
  const auto a = pcs::fit_tree_habit<CGAL::Sequential_tag>(trees, options);
  const auto b = pcs::fit_tree_habit<CGAL::Parallel_if_available_tag>(trees, options);
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    BOOST_TEST(a.values[i].value == b.values[i].value, a.values[i].name);
    BOOST_TEST(a.values[i].least == b.values[i].least, a.values[i].name);
    BOOST_TEST(a.values[i].largest == b.values[i].largest, a.values[i].name);
  }
}

BOOST_AUTO_TEST_CASE(trees_that_lie_are_named_and_have_bounded_angles)
{
  std::vector<Tree> trees = two_fruit_trees();
  const auto upright = pcs::fit_tree_habit(trees, np::number_of_simulations(20));
  BOOST_TEST_REQUIRE(upright.trunk_tilts.size() == 2u);
  BOOST_TEST(upright.trunk_tilts[0] < 0.5);
  for (const std::string& sentence : pcs::warnings(upright))
    BOOST_TEST(sentence.find("tilted") == std::string::npos, sentence);

  for (std::size_t v = 0; v < num_vertices(trees[1]); ++v) { // y is up
    const Kernel::Point_3 p = trees[1][v].point;
    trees[1][v].point = Kernel::Point_3(p.y(), p.z(), p.x());
  }
  const auto fit = pcs::fit_tree_habit(trees, np::number_of_simulations(20));
  BOOST_TEST(fit.trunk_tilts[0] == upright.trunk_tilts[0]);
  BOOST_TEST(fit.trunk_tilts[1] > 1.0);
  BOOST_TEST(!value_of(fit, "lean").is_identified); // at its limit
  for (const pcs::Habit_value& v : fit.values) {
    BOOST_TEST((v.least <= v.value && v.value <= v.largest), v.name);
    if (v.unit == "rad")
      BOOST_TEST((v.least >= 0 && v.largest <= pi), v.name << " up to " << v.largest);
  }
  BOOST_TEST(value_of(fit, "lean").largest <= pi / 2);
  const std::vector<std::string> found = pcs::warnings(fit, {"a.swc", "b.swc"});
  BOOST_TEST_REQUIRE(!found.empty());
  BOOST_TEST(found[0].find("b.swc: the trunk is tilted by ") == 0u, found[0]);
  BOOST_TEST(pcs::warnings(fit)[0].find("tree 1: ") == 0u);
}

BOOST_AUTO_TEST_CASE(any_kernel_will_do)
{
  std::vector<pcs::Tree_skeleton<pcs_test::Kernel_archetype>> trees(1);
  pcs::grow_tree(trees[0], pcs::fruit_habit(), np::random_seed(5));
  const auto a = pcs::fit_tree_habit(trees, np::number_of_simulations(20));
  const auto b = pcs::fit_tree_habit(std::vector<Tree>{grown(pcs::fruit_habit(), 5)},
                                     np::number_of_simulations(20));
  BOOST_TEST(a.habit.taper[1] == b.habit.taper[1]);
}

BOOST_AUTO_TEST_CASE(bad_trees_and_parameters_are_refused)
{
  const auto refuses =
      [](const std::vector<Tree>& trees, auto parameters, const std::string& word) {
        std::string message = "no error";
        try {
          pcs::fit_tree_habit(trees, parameters);
        } catch (const pcs::Invalid_input& e) {
          message = e.what();
        }
        BOOST_TEST(message.find(word) != std::string::npos, word << " in " << message);
      };
  const auto defaults = np::default_values();
  refuses({}, defaults, "`trees` is empty");
  refuses({Tree()}, defaults, "tree 0 has no nodes");
  pcs::Tree_habit bare = pcs::fruit_habit();
  bare.number_of_orders = 1;
  refuses({grown(pcs::fruit_habit(), 1), grown(bare, 1)}, defaults, "tree 1 has 1 branches");
  Tree tree = grown(pcs::fruit_habit(), 1);
  tree[7].radius = std::numeric_limits<double>::quiet_NaN();
  refuses({tree}, defaults, "node 7 has a coordinate or radius that is not finite");
  tree = grown(pcs::fruit_habit(), 1);
  tree[7].branch = 1000000;
  refuses({tree}, defaults, "node 7 is of branch 1000000");
  tree = grown(pcs::fruit_habit(), 1);
  add_edge(3, 9, tree);
  refuses({tree}, defaults, "more than one parent");
  tree = grown(pcs::fruit_habit(), 1);
  add_edge(9, tree[boost::graph_bundle].root, tree);
  refuses({tree}, defaults, "its root has a parent");
  tree = grown(pcs::fruit_habit(), 1);
  refuses({tree}, np::smallest_radius(-1.0), "smallest_radius");
  refuses({tree}, np::smallest_radius(1.0), "not thinner than `smallest_radius`");
  refuses({tree}, np::number_of_simulations(5), "number_of_simulations");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_tree_habit

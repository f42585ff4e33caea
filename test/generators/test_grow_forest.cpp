// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of forests that grow by a fitted habit.

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/grow_forest.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace test_grow_forest {

using Kernel = CGAL::Simple_cartesian<double>;

namespace {

pcs::Tree_habit_fit fruit_fit()
{
  pcs::Tree_habit_fit fit;
  fit.habit = pcs::fruit_habit();
  fit.allometry.height = fit.habit.height;
  fit.allometry.height_spread = 0.2;
  fit.allometry.trunk_radius_exponent = 1.3;
  return fit;
}

pcs::Forest_options options_of(std::size_t number, std::uint64_t seed = 1)
{
  pcs::Forest_options options;
  options.number_of_trees = number;
  options.random_seed = seed;
  return options;
}

double length_of_trunk(const pcs::Tree_skeleton<Kernel>& tree)
{
  const auto nodes = pcs::nodes_by_branch<Kernel>(tree).front();
  double sum = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i)
    sum += std::sqrt(CGAL::squared_distance(tree[nodes[i]].point, tree[nodes[i - 1]].point));
  return sum;
}

} // namespace

BOOST_AUTO_TEST_SUITE(grow_forest)

BOOST_AUTO_TEST_CASE(trunks_keep_their_distance_and_height)
{
  const auto fit = fruit_fit();
  const auto forest = pcs::grow_forest<Kernel>(fit, options_of(40));
  BOOST_TEST_REQUIRE(forest.size() == 40u);
  double mean = 0, squares = 0;
  for (std::size_t i = 0; i < forest.size(); ++i) {
    const auto& a = forest[i].tree[0];
    BOOST_TEST(length_of_trunk(forest[i].tree) == forest[i].height,
               boost::test_tools::tolerance(1e-9));
    // flare included
    BOOST_TEST(a.radius == 1.25 * 0.07 * std::pow(forest[i].height / 3.2, 1.3),
               boost::test_tools::tolerance(1e-9));
    BOOST_TEST(a.point.z() == 0);
    for (std::size_t j = 0; j < i; ++j) {
      const auto& b = forest[j].tree[0];
      BOOST_TEST(std::sqrt(CGAL::squared_distance(a.point, b.point)) >= 1.2 * 2 - 1e-9);
    }
    mean += std::log(forest[i].height) / 40;
    squares += std::pow(std::log(forest[i].height / 3.2), 2) / 40;
  }
  BOOST_TEST(std::abs(mean - std::log(3.2)) < 3 * 0.2 / std::sqrt(40.0));
  BOOST_TEST(std::abs(std::sqrt(squares) - 0.2) < 3 * 0.2 / std::sqrt(80.0));
}

BOOST_AUTO_TEST_CASE(a_larger_forest_begins_with_the_same_trees)
{
  const auto fit = fruit_fit();
  const auto few = pcs::grow_forest<Kernel, CGAL::Sequential_tag>(fit, options_of(2));
  const auto many = pcs::grow_forest<Kernel>(fit, options_of(5));
  const auto others = pcs::grow_forest<Kernel>(fit, options_of(2, 9));
  for (std::size_t i = 0; i < 2; ++i) {
    BOOST_TEST_REQUIRE(num_vertices(few[i].tree) == num_vertices(many[i].tree));
    for (std::size_t v = 0; v < num_vertices(few[i].tree); ++v)
      BOOST_TEST(few[i].tree[v].radius == many[i].tree[v].radius);
    BOOST_TEST(others[i].height != few[i].height);
  }
}

BOOST_AUTO_TEST_CASE(younger_trees_are_smaller)
{
  const auto fit = fruit_fit();
  pcs::Forest_options options = options_of(4);
  options.stem_distance = 0;
  const auto old = pcs::grow_forest<Kernel>(fit, options);
  options.age = {0.5, 0.6};
  const auto young = pcs::grow_forest<Kernel>(fit, options);
  for (std::size_t i = 0; i < old.size(); ++i) {
    BOOST_TEST((young[i].age >= 0.5 && young[i].age <= 0.6));
    BOOST_TEST(length_of_trunk(young[i].tree) < 0.9 * length_of_trunk(old[i].tree));
    BOOST_TEST(young[i].tree[0].radius < 0.8 * old[i].tree[0].radius);
    BOOST_TEST(old[i].tree[0].point.x() == 0);
  }
}

BOOST_AUTO_TEST_CASE(a_habit_at_its_own_height_is_the_same)
{
  const auto fit = fruit_fit();
  const pcs::Tree_habit same = pcs::habit_at_height(fit, 3.2),
                        large = pcs::habit_at_height(fit, 6.4);
  BOOST_TEST(same.trunk_radius == fit.habit.trunk_radius);
  BOOST_TEST(large.trunk_radius == std::pow(2.0, 1.3) * 0.07, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(large.crown_radius == 4, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(large.spacing[1] == fit.habit.spacing[1]);
  BOOST_CHECK_THROW(pcs::habit_at_height(fit, 0), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(bad_options_are_refused)
{
  const auto refuses = [](auto change, const std::string& word) {
    auto fit = fruit_fit();
    pcs::Forest_options options = options_of(2);
    change(fit, options);
    std::string message = "no error";
    try {
      pcs::grow_forest<Kernel>(fit, options);
    } catch (const pcs::Invalid_input& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(word) != std::string::npos, word << " in " << message);
  };
  refuses([](auto&, auto& o) { o.number_of_trees = 0; }, "number_of_trees");
  refuses([](auto&, auto& o) { o.height = -1; }, "height");
  refuses([](auto&, auto& o) { o.height_spread = 2; }, "height_spread");
  refuses([](auto&, auto& o) { o.age = {0, 1}; }, "`age`");
  refuses([](auto&, auto& o) { o.age = {1, 0.5}; }, "`age`");
  refuses([](auto&, auto& o) { o.stem_distance = std::numeric_limits<double>::infinity(); },
          "stem_distance");
  refuses([](auto& f, auto&) { f.habit.taper[0] = -1; }, "taper");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_grow_forest

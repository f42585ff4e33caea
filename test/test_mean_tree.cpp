// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Means and combinations of trees.

#include <pcs/Orl_shape_space.h>
#include <pcs/mean_tree.h>
#include <support/drawn.h>
#include <support/exceptions.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_mean_tree {

using pcs::Orl_metric;
using pcs::Tree_mean;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

namespace {

double sum_of_distances(const Space& space, const Orl_coordinates& x, bool is_squared)
{
  double sum = 0;
  for (std::size_t h = 0; h < space.number_of_trees(); ++h) {
    const double d = distance(x,
                              space.tree(h).coordinates(),
                              space.family().weights,
                              is_squared ? Orl_metric::square : Orl_metric::sum);
    sum += is_squared ? d * d : d;
  }
  return sum;
}

} // namespace

BOOST_AUTO_TEST_SUITE(orl_means)

BOOST_AUTO_TEST_CASE(no_tree_near_the_mean_is_better)
{
  const Family space(5);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const bool is_squared : {false, true}) {
    const Orl_coordinates mean =
        pcs::mean_tree(space, np::tree_mean(is_squared ? Tree_mean::frechet : Tree_mean::median))
            .coordinates();
    const double least = sum_of_distances(space, mean, is_squared);
    std::size_t number_better = 0;
    for (int i = 0; i < 2000; ++i) {
      Orl_coordinates x = mean;
      const auto e = static_cast<std::size_t>(random()) % x.length.size();
      const auto b = static_cast<std::size_t>(random()) % x.attachment.size();
      const double scale = std::pow(10.0, -2 - 2 * (i % 2));
      x.orientation[e] =
          x.orientation[e] *
          pcs::rotation_exp(scale * pcs_test::drawn<Vec3>([&] { return normal(random); }));
      x.length[e] = std::max(0.0, x.length[e] + scale * normal(random));
      x.radius[e] = std::max(0.0, x.radius[e] + scale * normal(random));
      x.base_radius[b] += scale * normal(random);
      x.attachment[b] += scale * normal(random);
      x.root += scale * pcs_test::drawn<Vec3>([&] { return normal(random); });
      number_better += sum_of_distances(space, x, is_squared) < least * (1 - 1e-12);
    }
    BOOST_TEST(number_better == 0u);
  }
}

BOOST_AUTO_TEST_CASE(the_mean_of_two_is_a_midpoint)
{
  const Space space = make_space(relatives(2, 9));
  const double whole = space.distance(0, 1);
  for (const Tree_mean kind : {Tree_mean::median, Tree_mean::frechet}) {
    const pcs::Orl_tree mean = pcs::mean_tree(space, np::tree_mean(kind));
    BOOST_TEST(std::abs(space.distance(mean, space.tree(0)) - whole / 2) < 1e-9 * whole);
    BOOST_TEST(std::abs(space.distance(mean, space.tree(1)) - whole / 2) < 1e-9 * whole);
  }
  const pcs::Orl_tree part = pcs::weighted_mean(space, {3, 1});
  BOOST_TEST(space.distance(part, space.geodesic(0, 1, 0.25)) < 1e-9 * whole);
}

BOOST_AUTO_TEST_CASE(combinations_are_between_and_directions_are_free)
{
  const Family space(4);
  for (std::size_t h = 0; h < 4; ++h) {
    std::vector<double> w(4, 0);
    w[h] = 2;
    BOOST_TEST(space.distance(pcs::weighted_mean(space, w), space.tree(h)) < 1e-9);
  }
  const pcs::Orl_tree half = pcs::weighted_mean(space, {1, 1, 0, 0});
  BOOST_TEST(space.distance(half, space.geodesic(0, 1, 0.5)) < 1e-9 * space.distance(0, 1));
  const pcs::Orl_tree moved =
      pcs::parallel_displacement(space, space.tree(0), space.tree(0), space.tree(1), 1);
  BOOST_TEST(space.distance(moved, space.tree(1)) < 1e-9 * space.distance(0, 1));
  const pcs::Orl_tree same =
      pcs::parallel_displacement(space, space.tree(2), space.tree(0), space.tree(1), 0);
  BOOST_TEST(space.distance(same, space.tree(2)) < 1e-9);
  const pcs::Orl_tree beyond = pcs::weighted_mean(space, {2, -1, 0.5, 0});
  for (const double l : beyond.coordinates().length)
    BOOST_TEST(l >= 0);
}

BOOST_AUTO_TEST_CASE(radii_stay_positive_beyond_the_inputs)
{
  const std::vector<Branch> thick = random_branches(5, 3, 2);
  std::vector<Branch> thin = thick;
  for (Branch& b : thin)
    for (double& r : b.radii)
      r *= 0.2;
  const std::vector<char> all(thick.size(), 1);
  const Turns still(thick.size(), Eigen::Matrix3d::Identity());
  std::vector<std::size_t> tip;
  const Space space =
      make_space({make_tree(thick, still, all, tip), make_tree(thin, still, all, tip)});
  const pcs::Orl_tree beyond = pcs::weighted_mean(space, {-1, 2});
  const auto& x = beyond.coordinates();
  std::size_t number_there = 0;
  for (std::size_t e = 0; e < x.length.size(); ++e)
    if (x.length[e] > 0) {
      ++number_there;
      BOOST_TEST(x.radius[e] > 0);
    }
  BOOST_TEST(number_there > 10u);
}

BOOST_AUTO_TEST_CASE(weights_and_steps_without_a_finite_result_are_refused)
{
  const Family space(2);
  const auto refuses = [&](const std::vector<double>& weights, const char* text) {
    BOOST_CHECK_EXCEPTION(pcs::weighted_mean(space, weights),
                          pcs::Invalid_input,
                          pcs_test::message_has(text));
  };
  refuses({1}, "1 weights for 2 trees");
  refuses({1, HUGE_VAL}, "a weight is inf");
  refuses({1, -1}, "the sum of the weights must be positive");
  refuses({1.5e308, 1.5e308}, "the weights are too large: their sum is not finite");
  BOOST_CHECK_EXCEPTION(
      pcs::parallel_displacement(space, space.tree(0), space.tree(0), space.tree(1), 1e308),
      pcs::Invalid_input,
      pcs_test::message_has("lengths that are no finite numbers"));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_mean_tree

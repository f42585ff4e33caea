// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The cost of a pair of branches is zero for equal branches, and has closed forms for straight
// ones.

#include <pcs/shape_space/matching/Matching_energy.h>
#include <support/rooted_trees.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace test_Matching_energy {

using namespace pcs::shape_space;
using pcs::Matching_weights;
using pcs_test::rooted;

namespace {

const Eigen::Matrix3d as_it_stands = Eigen::Matrix3d::Identity();

Matching_energy energy_of(const Rooted_tree& one,
                          const Rooted_tree& two,
                          const Matching_weights& weights = Matching_weights(),
                          bool grows_at_tips = false)
{
  const std::array<Branch_paths, 2> paths = {find_branch_paths(one, 1, 1, 1),
                                             find_branch_paths(two, 1, 1, 1)};
  return Matching_energy(one, two, weights, paths, grows_at_tips, CGAL::Sequential_tag());
}

/// The index of the path that leaves the trunk, of a tree with one branch.
std::size_t branch_of(const Matching_energy& energy, int t)
{
  const Branch_path& trunk = energy.path(t, energy.paths(t).paths_of[0].front());
  return energy.paths(t).paths_of[trunk.children.front().start].front();
}

/// A trunk of length 2 with a branch of a given length and angle at its middle.
Rooted_tree with_branch(double length, double angle)
{
  const Vec3 way(length * std::sin(angle), 0, length * std::cos(angle));
  return rooted({{pcs::npos, 0, Vec3(0, 0, 2)}, {0, 2, way}});
}

} // namespace

BOOST_AUTO_TEST_SUITE(energy_of_matchings)

BOOST_AUTO_TEST_CASE(equal_branches_cost_nothing)
{
  for (const bool is_published : {false, true}) {
    Matching_weights weights;
    weights.is_published = is_published;
    const Rooted_tree tree = rooted(orl_test::random_tree(3));
    const Matching_energy energy = energy_of(tree, tree, weights);
    BOOST_TEST_REQUIRE(energy.paths(0).paths.size() > 20u);
    for (std::size_t p = 0; p < energy.paths(0).paths.size(); ++p) {
      const Matching_energy::Trial trial = energy.match_curves(p, p, as_it_stands);
      Matching_energy::Child_cost_cache prices;
      BOOST_TEST(trial.cost < 1e-12);
      BOOST_TEST(energy.rest_cost(p, p, trial.last) == 0);
      BOOST_TEST(energy.least_energy(p, p, as_it_stands) < 1e-12);
      BOOST_TEST(energy.turned_energy(trial, as_it_stands, as_it_stands) < 1e-12);
      BOOST_TEST(energy.quick_cost_of_paths(p,
                                            p,
                                            as_it_stands,
                                            std::numeric_limits<double>::infinity(),
                                            prices) < 1e-9);
    }
  }
}

BOOST_AUTO_TEST_CASE(straight_branches_cost_what_angle_lengths_and_turn_tell)
{
  for (const double longer : {0.5, 0.8})
    for (const double angle : {0.3, 0.9}) {
      const Rooted_tree one = with_branch(0.5, 0.8), two = with_branch(longer, 0.8 + angle);
      const double a = 0.5 / 2, b = longer / 2, mean = std::sqrt(a * b); // of the trunk's length
      Matching_weights weights;
      weights.is_published = true;
      const auto cost = [&](const Rooted_tree& x, const Rooted_tree& y) {
        const Matching_energy energy = energy_of(x, y, weights);
        return energy.match_curves(branch_of(energy, 0), branch_of(energy, 1), as_it_stands).cost;
      };
      BOOST_TEST(std::abs(cost(one, two) - (a + b - 2 * mean * std::cos(angle))) < 1e-9);
      BOOST_TEST(std::abs(cost(one, two) - cost(two, one)) < 1e-9);
      weights.is_published = false; // lengths have a separate term
      BOOST_TEST(std::abs(cost(one, two) - 2 * mean * (1 - std::cos(angle))) < 1e-9);
      BOOST_TEST(std::abs(cost(one, two) - cost(two, one)) < 1e-9);
    }
  // A branch that turns alone costs the turn and the length difference.
  for (const double angle : {0.3, 0.9}) {
    const Rooted_tree one = with_branch(0.5, 0.8), two = with_branch(0.8, 0.8 + angle);
    const double a = 0.5 / 2, b = 0.8 / 2, mean = std::sqrt(a * b);
    const Matching_weights weights;
    const Matching_energy energy = energy_of(one, two, weights);
    const Matching_energy::Trial trial =
        energy.match_curves(branch_of(energy, 0), branch_of(energy, 1), as_it_stands);
    const double length = weights.length * weights.unmatched * std::abs(a - b);
    BOOST_TEST(std::abs(energy.turned_energy(trial, as_it_stands, as_it_stands) -
                        (2 * mean * (1 - std::cos(angle)) + length)) < 1e-9);
    const Eigen::Matrix3d back =
        energy.frame().transpose() * Eigen::AngleAxisd(-angle, Vec3::UnitY()) * energy.frame();
    BOOST_TEST(std::abs(energy.turned_energy(trial, as_it_stands, back) -
                        (2 * weights.rotation * mean * (1 - std::cos(angle)) + length)) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(bounds_are_below_what_curves_cost)
{
  const Rooted_tree one = rooted(orl_test::random_tree(5)), two = rooted(orl_test::random_tree(6));
  const Matching_energy energy = energy_of(one, two);
  Matching_weights published;
  published.is_published = true;
  const Matching_energy rigid = energy_of(one, two, published);
  const Eigen::Matrix3d carried = Eigen::AngleAxisd(0.4, Vec3(0.6, 0, 0.8)).toRotationMatrix();
  for (std::size_t p = 0; p < energy.paths(0).paths.size(); ++p)
    for (std::size_t q = p % 3; q < energy.paths(1).paths.size(); q += 3) {
      const Matching_energy::Trial trial = energy.match_curves(p, q, carried);
      const Eigen::Matrix3d turned = energy.turn(trial, {}, {}, carried, 1, 1);
      BOOST_TEST(energy.least_energy(p, q, carried) <=
                 energy.turned_energy(trial, carried, turned) + 1e-12);
      BOOST_TEST(rigid.least_energy(p, q, carried) <=
                 rigid.match_curves(p, q, carried).cost + 1e-12);
    }
}

BOOST_AUTO_TEST_CASE(energies_do_not_change_with_place_stand_and_unit)
{
  const orl_test::Tree a = orl_test::random_tree(7), b = orl_test::random_tree(8);
  const Rooted_tree one = rooted(a), two = rooted(b);
  const Rooted_tree far_one = rooted(pcs_test::elsewhere(a)),
                    far_two = rooted(pcs_test::elsewhere(b));
  const Matching_energy here = energy_of(one, two), there = energy_of(far_one, far_two);
  const auto cost = [](const Matching_energy& energy, std::size_t p, std::size_t q) {
    Matching_energy::Child_cost_cache prices;
    const double any = std::numeric_limits<double>::infinity();
    // relative to the axes of tree 1, which turn with the tree
    return energy.quick_cost_of_paths(p, q, as_it_stands, any, prices);
  };
  double greatest = 0;
  for (std::size_t p = 0; p < here.paths(0).paths.size(); p += 2)
    for (std::size_t q = 0; q < here.paths(1).paths.size(); q += 3) {
      BOOST_TEST(std::abs(cost(here, p, q) - cost(there, p, q)) < 1e-6);
      greatest = std::max(greatest, cost(here, p, q));
    }
  BOOST_TEST(greatest > 0.1);
  // Attachments are compared symmetrically.
  BOOST_TEST(here.position_term(0.3, 0.5, 0.2, 0.7, 1) > 0);
  BOOST_TEST(here.position_term(0.3, 0.5, 0.2, 0.7, 1) ==
             here.position_term(0.5, 0.3, 0.7, 0.2, 1));
  BOOST_TEST(here.position_term(0.3, 0.5, 0.4, 0.4, 1) == 0);
  // The published energy has a fixed weight.
  Matching_weights published;
  published.is_published = true;
  for (const double weight : {1., 3.}) {
    published.position = weight;
    const Matching_energy energy = energy_of(one, two, published);
    BOOST_TEST(std::abs(energy.position_term(0.3, 0.5, 0.2, 0.7, 2) - 2 * 0.25) < 1e-15);
  }
}

BOOST_AUTO_TEST_CASE(what_grew_on_at_the_tip_costs_as_if_it_were_single)
{
  const Rooted_tree one = rooted({{pcs::npos, 0, Vec3(0, 0, 1)}});
  const Rooted_tree two = rooted({{pcs::npos, 0, Vec3(0, 0, 2), 8}, {0, 6, Vec3(0.3, 0, 0)}});
  const Matching_weights weights;
  const Matching_energy tips = energy_of(one, two, weights, true);
  const auto trial = tips.match_curves(0, tips.paths(1).paths_of[0].front(), as_it_stands);
  BOOST_TEST(trial.cost < 1e-12);
  BOOST_TEST(trial.last[0] == 4u);
  BOOST_TEST(trial.last[1] == 4u); // at the same distance from the base
  // Cost of the longer half of the trunk and its branch, in units of the longest path.
  BOOST_TEST(std::abs(tips.rest_cost(0, trial.path_2, trial.last) -
                      weights.unmatched * (1 + 0.3) / 2) < 1e-9);
  const Matching_energy along = energy_of(one, two, weights, false);
  const auto whole = along.match_curves(0, along.paths(1).paths_of[0].front(), as_it_stands);
  BOOST_TEST(along.rest_cost(0, whole.path_2, whole.last) == 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Matching_energy

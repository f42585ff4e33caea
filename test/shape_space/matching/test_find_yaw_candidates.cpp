// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The yaw of turned trees is found, with bounded work for many branches at one node.

#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/find_yaw_candidates.h>
#include <support/rooted_trees.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace test_find_yaw_candidates {

using namespace pcs::shape_space;
using pcs_test::Stick;

namespace {

/// A trunk with `n` long branches at its tip, turned about the vertical. [rad]
Rooted_tree rosette(std::size_t n, double turn)
{
  std::vector<Stick> sticks{{pcs::npos, 0, Vec3(0, 0, 1)}};
  for (std::size_t i = 0; i < n; ++i) {
    const double k = double(i), azimuth = 2 * std::sin(7.7 * k) + 2.4 * k + turn,
                 height = 0.4 + 0.3 * std::sin(5.3 * k), length = 1 + 0.1 * std::sin(3.1 * k);
    sticks.push_back(
        {0, 4, length * Vec3(std::cos(azimuth), std::sin(azimuth), height).normalized()});
  }
  return pcs_test::rooted(sticks);
}

Matching_energy energy_of(const Rooted_tree& one, const Rooted_tree& two)
{
  const pcs::Matching_weights weights;
  const auto paths = [&](const Rooted_tree& tree) {
    return find_branch_paths(tree,
                             weights.fork_ratio,
                             weights.number_of_paths,
                             weights.trunk_fork_ratio);
  };
  const std::array<Branch_paths, 2> both = {paths(one), paths(two)};
  return Matching_energy(one, two, weights, both, false, CGAL::Sequential_tag());
}

} // namespace

BOOST_AUTO_TEST_SUITE(yaw_candidates)

BOOST_AUTO_TEST_CASE(the_turn_of_a_rosette_is_found_with_bounded_work)
{
  for (const std::size_t n : {12u, 60u}) {
    const double turn = 1.9;
    const Rooted_tree one = rosette(n, turn), two = rosette(n, 0);
    const Matching_energy energy = energy_of(one, two);
    const double trunks =
        double(energy.paths(0).paths_of[0].size() * energy.paths(1).paths_of[0].size());
    BOOST_TEST_REQUIRE(trunks >= double(n));
    const internal::Yaw_limits limits = internal::find_yaw_limits(energy);
    BOOST_TEST(limits.are_trunks_kept == (n == 60));
    const double number = double(std::min(n, limits.number_of_children));
    BOOST_TEST(trunks * number * number < 4e6);
    std::function<bool(double)> callback;
    pcs::internal::Progress progress(callback);
    const std::vector<double> yaws =
        find_yaw_candidates<CGAL::Sequential_tag>(energy, Vec3(0, 0, 1), 8, progress);
    BOOST_TEST(std::any_of(yaws.begin(), yaws.end(), [&](double yaw) {
      return std::abs(std::remainder(yaw - turn, 6.283185307179586)) < 0.01;
    }));
  }
}

BOOST_AUTO_TEST_CASE(all_children_of_single_trunks_are_compared)
{
  const Rooted_tree tree = pcs_test::rooted(
      std::vector<Stick>{{pcs::npos, 0, Vec3(0, 0, 2)}, {0, 2, Vec3(0.3, 0, 0.3)}});
  const Matching_energy energy = energy_of(tree, tree);
  BOOST_TEST_REQUIRE(energy.paths(0).paths_of[0].size() == 1u);
  const internal::Yaw_limits limits = internal::find_yaw_limits(energy);
  BOOST_TEST(limits.number_of_children == Matching_energy::most_children);
  BOOST_TEST(!limits.are_trunks_kept);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_find_yaw_candidates

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Changes of the branches from one tree to another.

#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_compare_trees {

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

BOOST_AUTO_TEST_SUITE(orl_changes)

BOOST_AUTO_TEST_CASE(changes_are_named)
{
  const std::vector<Branch> all = random_branches(41, 4, 2);
  std::vector<Branch> later = all;
  Turns still(all.size(), Eigen::Matrix3d::Identity()), turned = still;
  std::vector<char> first(all.size(), 1);
  first[1] = 0; // new
  for (Vec3& p : later[3].points)
    p *= 1.3;
  for (double& r : later[4].radii)
    r *= 1.5;
  turned[4] = Eigen::AngleAxisd(0.4, Vec3(0, 0, 1)).toRotationMatrix();
  std::vector<std::size_t> tip_a, tip_b;
  const Tree a = make_tree(all, still, first, tip_a),
             b = make_tree(later, turned, std::vector<char>(all.size(), 1), tip_b);
  const Space space = make_space({a, b});
  const auto changes = pcs::find_branch_changes(space, 0, 1);
  BOOST_TEST(changes.size() == 5u);
  Space in_world_axes;
  in_world_axes.add_skeleton(a);
  in_world_axes.add_skeleton(b);
  in_world_axes.build(np::orientation(pcs::Orl_orientation::world_axes));
  const auto same = pcs::find_branch_changes(in_world_axes, 0, 1);
  BOOST_TEST_REQUIRE(same.size() == changes.size());
  for (std::size_t i = 0; i < same.size(); ++i) {
    BOOST_TEST(same[i].is_turned == changes[i].is_turned);
    BOOST_TEST(std::abs(same[i].angle - changes[i].angle) < 1e-9);
  }
  for (const std::size_t t : {0u, 1u})
    BOOST_TEST(in_world_axes.distance(in_world_axes.embed(t == 0 ? a : b), in_world_axes.tree(t)) <
               2 * space.distance(space.embed(t == 0 ? a : b), space.tree(t)) + 1e-3);
  for (const Branch_change& c : changes) {
    const std::size_t in_a = space.tip_of_branch(0, c.branch),
                      in_b = space.tip_of_branch(1, c.branch);
    std::size_t k = 0;
    while (k < 5 && !(in_a != pcs::npos && tip_a[k] == in_a) &&
           !(in_b != pcs::npos && tip_b[k] == in_b))
      ++k;
    BOOST_TEST_CONTEXT("branch " << k)
    {
      BOOST_TEST(c.is_new == (k == 1));
      BOOST_TEST(!c.is_lost);
      BOOST_TEST(c.is_longer == (k == 3));
      BOOST_TEST(c.is_thicker == (k == 4));
      BOOST_TEST(c.is_turned == (k == 4));
      BOOST_TEST(!c.is_shorter);
      BOOST_TEST(!c.is_thinner);
      if (k == 3)
        BOOST_TEST(std::abs(c.length[1] / c.length[0] - 1.3) < 1e-6);
      if (k == 4)
        BOOST_TEST(c.angle > 0.05);
    }
  }
  // The opposite order.
  std::size_t number_lost = 0, number_shorter = 0, number_thinner = 0, number_new = 0;
  for (const Branch_change& c : pcs::find_branch_changes(space, 1, 0)) {
    number_lost += c.is_lost;
    number_shorter += c.is_shorter;
    number_thinner += c.is_thinner;
    number_new += c.is_new;
  }
  BOOST_TEST(number_lost == 1u);
  BOOST_TEST(number_shorter == 1u);
  BOOST_TEST(number_thinner == 1u);
  BOOST_TEST(number_new == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_compare_trees

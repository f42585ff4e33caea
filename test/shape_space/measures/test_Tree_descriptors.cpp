// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Descriptors of small trees, computed by hand, and their distances from ranges.

#include <pcs/core/rotations.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>
#include <support/layouts.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_Tree_descriptors {

using namespace pcs::shape_space;

namespace {

constexpr double pi = 3.14159265358979323846;

/// An upright trunk of two unit edges, two branches of length 1 on its middle at 90 and 60 degrees
/// towards x and -x, and a branch of length 0.5 at the tip of the second, in its direction.
struct Small_tree
{
  Orl_layout layout = orl_test::layout_of({{none, 2, none}, {0, 1, 0}, {0, 1, 0}, {2, 1, 3}});
  Orl_coordinates x = orl_test::upright_tree(layout);

  Small_tree()
  {
    x.root = Vec3(5, 6, 7);
    x.attachment = {0, 1, 1, 1};
    x.orientation[2] = pcs::rotation_exp(Vec3(0, pi / 2, 0));
    x.orientation[3] = pcs::rotation_exp(Vec3(0, -pi / 3, 0));
    x.length[4] = 0.5;
  }

  Orl_geometry geometry() const
  {
    Orl_geometry result;
    build_geometry(layout, x, pcs::Orl_orientation::gauge_fixed, result);
    return result;
  }
  Tree_descriptors descriptors() const { return measure(layout, x, geometry(), Vec3::UnitZ()); }
};

} // namespace

BOOST_AUTO_TEST_SUITE(tree_descriptors)

BOOST_AUTO_TEST_CASE(descriptors_of_a_small_tree_are_those_computed_by_hand)
{
  const Tree_descriptors f = Small_tree().descriptors();
  BOOST_TEST(std::abs(f.length - 4.5) < 1e-12);
  BOOST_TEST(std::abs(f.height - 2) < 1e-12);
  BOOST_TEST(std::abs(f.depth) < 1e-12);
  // from 1 to -1.5 sin(60 degrees) along x; the mean of |cos| over all directions is 2 / pi
  BOOST_TEST(std::abs(f.crown_width - 2 / pi * (1 + 1.5 * std::sin(pi / 3))) < 5e-3);
  // moments along x, by halves of the lengths: 1/2 of the first branch, 1.5^2 / 2 sin(60 degrees)
  BOOST_TEST(std::abs(f.lean - std::abs(0.5 - 1.125 * std::sin(pi / 3)) / 4.5) < 1e-12);
  BOOST_TEST(f.number_of_branches == std::vector<std::size_t>({1, 2, 1}));
  BOOST_TEST(f.total_number_of_branches() == 4u);
  BOOST_TEST(std::abs(f.mean_angle[1] - pi / 180 * 75) < 1e-12);
  BOOST_TEST(std::abs(f.angle_deviation[1] - pi / 180 * 15) < 1e-7);
  BOOST_TEST(std::abs(f.mean_angle[2]) < 1e-7);
}

BOOST_AUTO_TEST_CASE(branches_without_length_and_their_subtrees_are_left_out)
{
  Small_tree tree;
  tree.x.length[3] = 0;
  const Tree_descriptors f = tree.descriptors();
  BOOST_TEST(std::abs(f.length - 3) < 1e-12);
  BOOST_TEST(f.number_of_branches == std::vector<std::size_t>({1, 1}));
  BOOST_TEST(std::abs(f.mean_angle[1] - pi / 2) < 1e-12);
  BOOST_TEST(std::abs(f.crown_width - 2 / pi) < 5e-3);
}

BOOST_AUTO_TEST_CASE(branches_below_the_root_have_a_depth)
{
  Small_tree tree;
  tree.x.attachment[1] = 0;
  tree.x.orientation[2] = pcs::rotation_exp(Vec3(0, pi / 180 * 150, 0));
  const Tree_descriptors f = tree.descriptors();
  BOOST_TEST(std::abs(f.depth - std::cos(pi / 6)) < 1e-12);
  BOOST_TEST(std::abs(f.height - 2 - std::cos(pi / 6)) < 1e-12);
}

BOOST_AUTO_TEST_CASE(the_direction_of_growth_points_to_the_centroid)
{
  const Small_tree tree;
  const Vec3 d = growth_direction(tree.layout, tree.x, tree.geometry());
  const double x = (0.5 - 1.125 * std::sin(pi / 3)) / 4.5;
  const double z = (2 * 1 + 1 * 1 + 1.5 + 1.125 * std::cos(pi / 3)) / 4.5;
  BOOST_TEST((d - Vec3(x, 0, z)).norm() < 1e-12);
}

BOOST_AUTO_TEST_CASE(violations_are_relative_distances_from_the_range)
{
  const Tree_descriptors f = Small_tree().descriptors();
  Tree_descriptors large = f;
  large.height *= 2;
  BOOST_TEST(range_violation(f, {f}) == 0);
  BOOST_TEST(range_violation(f, {f, large}) == 0);
  BOOST_TEST(std::abs(range_violation(large, {f}) - 1) < 1e-12);   // twice the largest
  BOOST_TEST(std::abs(range_violation(f, {large}) - 0.5) < 1e-12); // half of the least
  Tree_descriptors upright = f, leaning = f;
  upright.lean = 0; // less lean and depth are no violations
  leaning.lean = 2 * f.lean + upright_tolerance * f.crown_width;
  BOOST_TEST(range_violation(upright, {f}) == 0);
  BOOST_TEST(range_violation(leaning, {f}) > 0.9);
  Tree_descriptors other = f;
  other.mean_angle[1] *= 1.25;
  BOOST_TEST(std::abs(range_violation(other, {f}) - 0.25) < 1e-12);
  BOOST_TEST(range_violation(other, {f}, false) == 0); // without orders
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Tree_descriptors

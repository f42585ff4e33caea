// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The total area of branches is bounded by their supporting section; other stems are counted.

#include <pcs/skeleton/radii/apply_pipe_model.h>
#include <pcs/skeleton/result/count_other_stems.h>
#include <support/axes.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace test_limit_pipes {

using namespace pcs::skeleton;

namespace {

constexpr double stem_radius = 0.1;

/// Adds a branch of 20 equal steps on a node; returns its index.
Index add(Branch_tree& tree,
          Index seat,
          const Vec3& from,
          const Vec3& to,
          double first,
          double last)
{
  return pcs_test::add_branch(tree, seat, pcs_test::straight_axis(from, to, 20, first, last));
}

/// A stem of 2 m with branches of a given radius at its top.
Branch_tree crown(std::size_t number_of_branches, double radius)
{
  Branch_tree tree;
  add(tree, none, Vec3::Zero(), Vec3(0, 0, 2), stem_radius, stem_radius);
  for (std::size_t k = 0; k < number_of_branches; ++k) {
    const double angle = 2 * 3.14159265358979323846 * double(k) / double(number_of_branches);
    const Vec3 tip(std::cos(angle), std::sin(angle), 3);
    add(tree, 20, Vec3(0, 0, 2), tip, radius, radius);
  }
  return tree;
}

/// Marks all nodes as proven, or those of the stem alone.
std::vector<std::uint8_t> proof(const Branch_tree& tree, bool is_all)
{
  std::vector<std::uint8_t> is_proven(tree.nodes.size(), is_all);
  for (const Index v : tree.branches[0].nodes)
    is_proven[v] = 1;
  return is_proven;
}

} // namespace

BOOST_AUTO_TEST_SUITE(pipe_model)

BOOST_AUTO_TEST_CASE(a_crown_of_fat_branches_is_scaled_down_to_the_stem)
{
  Branch_tree tree = crown(12, stem_radius);
  const std::size_t count = apply_pipe_model(proof(tree, false), Pipe_model_options(), tree);
  BOOST_TEST(count > 12u * 15);
  const double most = Pipe_model_options().slack * stem_radius * stem_radius;
  for (std::size_t k = 2; k <= 20; ++k) { // the first nodes lie in the bin of the stem
    double area = 0;
    for (std::size_t b = 1; b < tree.branches.size(); ++b) {
      const Branch_node& node = tree.nodes[tree.branches[b].nodes[k]];
      area += node.radius * node.radius;
      BOOST_TEST(!node.is_measured);
    }
    BOOST_TEST(area <= most * 1.02);
    BOOST_TEST(area >= most * 0.9);
  }
  for (const Index v : tree.branches[0].nodes)
    BOOST_TEST(tree.nodes[v].radius == stem_radius);
}

BOOST_AUTO_TEST_CASE(branches_as_of_wood_stay)
{
  Branch_tree tree = crown(12, stem_radius / 3); // 12 / 9 of the area of the stem
  BOOST_TEST(apply_pipe_model(proof(tree, false), Pipe_model_options(), tree) == 0u);
}

BOOST_AUTO_TEST_CASE(proven_branches_stay)
{
  Branch_tree tree = crown(12, stem_radius);
  BOOST_TEST(apply_pipe_model(proof(tree, true), Pipe_model_options(), tree) == 0u);
}

BOOST_AUTO_TEST_CASE(a_proven_trunk_does_not_shrink_to_the_twig_that_it_hangs_on)
{
  Branch_tree tree;
  add(tree, none, Vec3::Zero(), Vec3(0, 0, 1), 0.01, 0.01);
  add(tree, 20, Vec3(0, 0, 1), Vec3(0, 0, 3), stem_radius, stem_radius);
  for (int k = 0; k < 6; ++k)
    add(tree, 41, Vec3(0, 0, 3), Vec3(k - 2.5, 0, 4), 0.04, 0.04);
  std::vector<std::uint8_t> is_proven = proof(tree, false);
  for (const Index v : tree.branches[1].nodes)
    is_proven[v] = 1;
  BOOST_TEST(apply_pipe_model(is_proven, Pipe_model_options(), tree) == 0u);
}

BOOST_AUTO_TEST_CASE(nothing_is_limited_without_slack_or_nodes)
{
  Branch_tree tree = crown(12, stem_radius), empty;
  Pipe_model_options rules;
  rules.slack = 0;
  BOOST_TEST(apply_pipe_model(proof(tree, false), rules, tree) == 0u);
  BOOST_TEST(apply_pipe_model({}, Pipe_model_options(), empty) == 0u);
}

BOOST_AUTO_TEST_CASE(stems_that_stand_beside_the_root_are_counted)
{
  Branch_tree tree;
  add(tree, none, Vec3::Zero(), Vec3(0, 0, 4), stem_radius, 0.02);
  Axis_set axes;
  Fitted_axis stem;
  for (const Index v : tree.branches[0].nodes)
    stem.axis.push_back(tree.nodes[v]);
  axes.axes.assign(2, stem); // the second one is out of reach
  const std::vector<Joint> joints(2);
  const auto count = [&] { return count_other_stems(axes, joints, 0, tree, Stem_options()); };
  BOOST_TEST(count() == 1u);
  axes.axes.pop_back();
  BOOST_TEST(count() == 0u);
  // A hanging twig becomes thinner downwards, the stem of another tree thicker.
  add(tree, 15, Vec3(0, 0, 3), Vec3(1, 0, 0.3), 0.02, 0.003);
  BOOST_TEST(count() == 0u);
  add(tree, 15, Vec3(0, 0, 3), Vec3(-1, 0, 0.1), 0.02, 0.08);
  BOOST_TEST(count() == 1u);
  BOOST_TEST(count_other_stems(axes, joints, 0, Branch_tree(), Stem_options()) == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_limit_pipes

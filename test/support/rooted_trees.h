// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Input trees of the shape space, for tests of its stages.

#ifndef PCS_TEST_SUPPORT_ROOTED_TREES_H
#define PCS_TEST_SUPPORT_ROOTED_TREES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/shape_space/model/Rooted_tree.h>
#include <support/orl_trees.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace pcs_test {

/// A straight branch of some nodes; `parent` is its parent branch, `at` the node there.
struct Stick
{
  std::size_t parent, at;
  Eigen::Vector3d way; ///< from base to tip
  std::size_t steps = 4;
};

inline pcs::shape_space::Rooted_tree rooted(const orl_test::Tree& tree)
{
  using Node = pcs::Tree_node<orl_test::Kernel>;
  return pcs::shape_space::make_rooted_tree(tree,
                                            get(&Node::point, tree),
                                            get(&Node::radius, tree),
                                            get(boost::vertex_index, tree),
                                            "test");
}

/// Assembles the branches, trunk first.
inline orl_test::Tree tree_of_sticks(const std::vector<Stick>& sticks)
{
  std::vector<orl_test::Branch> branches;
  for (const Stick& stick : sticks) {
    orl_test::Branch branch;
    branch.parent = stick.parent;
    branch.at = stick.at;
    for (std::size_t k = 0; k <= stick.steps; ++k) {
      branch.points.push_back(stick.way * (double(k) / double(stick.steps)));
      branch.radii.push_back(0.01);
    }
    branches.push_back(branch);
  }
  return orl_test::make_tree(branches);
}

inline pcs::shape_space::Rooted_tree rooted(const std::vector<Stick>& sticks)
{
  return rooted(tree_of_sticks(sticks));
}

/// The rotated and shifted tree in another unit.
inline orl_test::Tree elsewhere(const orl_test::Tree& tree)
{
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(0.48, 0.6, 0.64));
  return orl_test::moved(tree, turn.toRotationMatrix(), Eigen::Vector3d(3, -20, 7), 2.5);
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_ROOTED_TREES_H

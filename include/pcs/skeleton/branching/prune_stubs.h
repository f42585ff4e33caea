// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pruning of branches that are too short to be distinguished from bumps and bends.

#ifndef PCS_SKELETON_BRANCHING_PRUNE_STUBS_H
#define PCS_SKELETON_BRANCHING_PRUNE_STUBS_H

#include <pcs/skeleton/model/Branch_tree.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for stubs.
struct Stub_options
{
  double shortest =
      /// least length outside the parent of a branch without children, in spacings; 0: no limit [-]
      4;
};

/*!
  Removes branches without children whose length outside the parent is below the limit. Reassigns
  their points to the parent node. Returns the number of removed branches. O(nodes + points).
*/
inline std::size_t prune_stubs(double spacing, const Stub_options& rules, Branch_tree& tree)
{
  const std::size_t n = tree.branches.size();
  std::vector<Index> children(n, 0);
  for (const Branch& b : tree.branches)
    if (b.parent != none)
      ++children[b.parent];
  std::vector<std::uint8_t> is_stub(n, 0);
  std::size_t count = 0;
  for (std::size_t b = n; b-- > 1;) { // children come after their parents
    const Branch& branch = tree.branches[b];
    if (children[b] > 0 || branch.parent == none)
      continue;
    double length = 0;
    for (const Index v : branch.nodes)
      length += (tree.nodes[v].point - tree.nodes[tree.nodes[v].parent].point).norm();
    const Index seat = tree.nodes[branch.nodes.front()].parent;
    if (length - tree.nodes[seat].radius >= rules.shortest * spacing)
      continue;
    is_stub[b] = 1;
    --children[branch.parent];
    ++count;
  }
  if (count == 0)
    return 0;
  std::vector<Index> branch_number(n, none), node_number(tree.nodes.size(), none);
  std::vector<Branch> branches;
  for (std::size_t b = 0; b < n; ++b) {
    if (is_stub[b])
      continue;
    branch_number[b] = static_cast<Index>(branches.size());
    Branch branch = std::move(tree.branches[b]);
    if (branch.parent != none)
      branch.parent = branch_number[branch.parent];
    branch.nodes.clear();
    branches.push_back(std::move(branch));
  }
  std::vector<Branch_node> nodes;
  for (Index v = 0; v < tree.nodes.size(); ++v) {
    Branch_node node = tree.nodes[v];
    if (is_stub[node.branch]) {
      node_number[v] = node_number[node.parent];
      continue;
    }
    node.branch = branch_number[node.branch];
    if (node.parent != none)
      node.parent = node_number[node.parent];
    node_number[v] = static_cast<Index>(nodes.size());
    branches[node.branch].nodes.push_back(node_number[v]);
    nodes.push_back(node);
  }
  for (Index& v : tree.node_of_point)
    if (v != none)
      v = node_number[v];
  tree.nodes = std::move(nodes);
  tree.branches = std::move(branches);
  return count;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_PRUNE_STUBS_H

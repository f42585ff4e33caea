// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Serialisation of the common topology of two trees.

#ifndef PCS_SHAPE_SPACE_PAIR_SERIALIZE_TOPOLOGY_H
#define PCS_SHAPE_SPACE_PAIR_SERIALIZE_TOPOLOGY_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/errors.h>
#include <pcs/core/rotations.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/model/Common_topology.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Stores the numbers that `restore_topology()` needs.
inline Orl_correspondences store_topology(const Common_topology& topology,
                                          const Quaternion& rotation,
                                          const std::array<const Tree_input*, 2>& inputs,
                                          const std::vector<Orl_correspondences::Pair>& pairs)
{
  Orl_correspondences result;
  for (std::size_t t = 0; t < 2; ++t) {
    result.fingerprint[t] = inputs[t]->fingerprint;
    result.fingerprint_of_points[t] = inputs[t]->fingerprint_of_points;
  }
  result.rotation = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  for (const Common_branch& b : topology.branches) {
    Orl_correspondences::Branch branch;
    branch.parent = b.parent;
    branch.nodes = b.node;
    branch.attachment = b.attachment;
    branch.confidence = b.confidence;
    for (std::size_t t = 0; t < 2; ++t)
      if (b.path[t] != none) {
        const Branch_path& path = topology.paths[t].paths[b.path[t]];
        branch.first[t] = path.nodes[path.is_trunk ? 0 : 1];
        branch.tip[t] = path.tip();
        branch.is_continued[t] = path.is_continued;
      }
    result.branches.push_back(std::move(branch));
  }
  result.pairs = pairs;
  return result;
}

namespace internal {

/// Restores a topology branch by branch. Checks everything: correspondences may come from a file.
class Topology_restorer
{
public:
  Topology_restorer(const Orl_correspondences& stored,
                    const std::array<const Tree_input*, 2>& inputs,
                    const std::string& caller)
    : m_stored(stored), m_inputs(inputs), m_caller(caller)
  {
  }

  Common_topology operator()()
  {
    check_inputs();
    for (std::size_t i = 0; i < m_stored.branches.size(); ++i)
      add_branch(i);
    return std::move(m_result);
  }

private:
  void check(bool is_right, const char* what) const
  {
    if (!is_right)
      throw Invalid_input(m_caller + ": " + what);
  }

  void check_inputs() const
  {
    for (std::size_t t = 0; t < 2; ++t)
      check(m_stored.fingerprint[t] == m_inputs[t]->fingerprint,
            "the correspondences were computed for other trees");
    const bool has_points = !m_inputs[0]->points.empty() || !m_inputs[1]->points.empty();
    for (std::size_t t = 0; t < 2; ++t)
      check(!has_points || m_stored.fingerprint_of_points[t] == m_inputs[t]->fingerprint_of_points,
            "the correspondences were computed for the same trees with other points, or without");
    const auto& [w, x, y, z] = m_stored.rotation;
    check(std::abs(w * w + x * x + y * y + z * z - 1) < 1e-6, "the turn is no rotation");
    check(!m_stored.branches.empty(), "there are no branches");
  }

  void add_branch(std::size_t i)
  {
    const Orl_correspondences::Branch& b = m_stored.branches[i];
    Common_branch branch;
    check(i == 0 ? b.parent == none : b.parent < i, "a branch comes before its parent");
    branch.parent = b.parent;
    branch.node = b.nodes;
    branch.attachment = b.attachment;
    check(!(b.confidence < 0 || b.confidence > 1), "a confidence is not between 0 and 1");
    branch.confidence = b.confidence;
    for (std::size_t t = 0; t < 2; ++t)
      add_path(i, t, branch);
    check(branch.path[0] != none || branch.path[1] != none, "a branch is in neither tree");
    check(b.nodes[0].empty() || b.nodes[1].empty() || b.nodes[0].size() == b.nodes[1].size(),
          "a branch has different numbers of nodes in the two trees");
    for (std::size_t t = 0; t < 2 && i > 0; ++t)
      check(b.attachment[t] >= 0 &&
                b.attachment[t] <=
                    static_cast<double>(m_result.branches[b.parent].number_of_nodes() - 1),
            "a branch is attached beyond its parent");
    m_result.branches.push_back(std::move(branch));
  }

  /// Adds the path of branch `i` in tree `t`, if the tree has the branch.
  void add_path(std::size_t i, std::size_t t, Common_branch& branch)
  {
    const Orl_correspondences::Branch& b = m_stored.branches[i];
    Branch_paths& paths = m_result.paths[t];
    check(b.tip[t] == none || i == 0 || m_result.branches[b.parent].path[t] != none,
          "a tree has a branch without its parent");
    if (b.tip[t] == none) {
      check(b.nodes[t].empty() && i > 0, "a branch that a tree lacks has nodes there");
      return;
    }
    std::vector<std::size_t> nodes = find_nodes(b, t);
    check((b.first[t] == 0) == (i == 0), "a branch begins with the root");
    branch.path[t] = paths.paths.size();
    paths.paths.push_back(make_path(m_inputs[t]->tree, std::move(nodes), b.first[t] == 0));
    if (b.is_continued[t]) {
      Branch_path& path = paths.paths.back();
      check(i > 0 && paths.paths[m_result.branches[b.parent].path[t]].tip() == path.nodes.front(),
            "a branch that continues its parent does not begin at its tip");
      path.is_continued = true;
    }
    check_positions(b.nodes[t]);
  }

  /// Returns the nodes of a branch of tree `t`, from the node on the parent to the tip.
  std::vector<std::size_t> find_nodes(const Orl_correspondences::Branch& b, std::size_t t) const
  {
    const Rooted_tree& tree = m_inputs[t]->tree;
    check(b.tip[t] < tree.size() && b.first[t] < tree.size(), "there is no such node");
    std::vector<std::size_t> nodes{b.tip[t]};
    while (nodes.back() != b.first[t] && tree.parents[nodes.back()] != none)
      nodes.push_back(tree.parents[nodes.back()]);
    check(nodes.back() == b.first[t], "a branch does not lead to its tip");
    if (b.first[t] != 0)
      nodes.push_back(tree.parents[b.first[t]]);
    std::reverse(nodes.begin(), nodes.end());
    check(nodes.size() > 1, "a branch has no edge");
    return nodes;
  }

  void check_positions(const std::vector<double>& s) const
  {
    check(s.size() > 1 && s.front() == 0 && s.back() == 1, "a branch does not go from 0 to 1");
    for (std::size_t k = 1; k < s.size(); ++k)
      check(s[k] > s[k - 1], "the nodes of a branch do not increase");
  }

  const Orl_correspondences& m_stored;
  const std::array<const Tree_input*, 2>& m_inputs;
  const std::string& m_caller;
  Common_topology m_result;
};

} // namespace internal

/// Restores the topology of `store_topology()`. Throws `pcs::Invalid_input` with a message that
/// begins with `caller` if it does not fit the trees.
inline Common_topology restore_topology(const Orl_correspondences& stored,
                                        const std::array<const Tree_input*, 2>& inputs,
                                        const std::string& caller)
{
  return internal::Topology_restorer(stored, inputs, caller)();
}

inline void check_pairs(const Orl_correspondences& stored,
                        std::size_t number_of_edges,
                        const std::array<std::size_t, 2>& number_of_points,
                        const std::string& caller)
{
  std::uint32_t last = 0;
  for (const Orl_correspondences::Pair& p : stored.pairs) {
    const bool has_points =
        p.point[0] != Orl_correspondences::no_point || p.point[1] != Orl_correspondences::no_point;
    bool is_right = p.edge >= last && p.edge < number_of_edges && has_points;
    for (std::size_t t = 0; t < 2; ++t)
      is_right = is_right &&
                 (p.point[t] == Orl_correspondences::no_point || p.point[t] < number_of_points[t]);
    if (!is_right)
      throw Invalid_input(caller +
                          ": a pair of points names what does not exist, or is out of order");
    last = p.edge;
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PAIR_SERIALIZE_TOPOLOGY_H

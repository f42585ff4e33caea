// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Joined axes as one rooted tree of nodes, grouped into branches.

#ifndef PCS_SKELETON_BRANCHING_GROUP_BRANCHES_H
#define PCS_SKELETON_BRANCHING_GROUP_BRANCHES_H

#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_grouper.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Joint.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Builds the nodes of the tree and links them to their parents.
class Tree_builder
{
public:
  Tree_builder(const Axis_set& set, const std::vector<Joint>& joints, Index root, double spacing)
    : m_set(set), m_joints(joints), m_spacing(spacing)
  {
    const std::size_t n = set.axes.size();
    m_children.resize(n);
    for (Index a = 0; a < n; ++a)
      if (joints[a].parent != none)
        m_children[joints[a].parent].push_back(a);
    m_first_node.assign(n, none);
    add_axes(root);
    m_tree.number_of_unreached_axes =
        static_cast<std::size_t>(std::count(m_first_node.begin(), m_first_node.end(), none));
  }

  Branch_tree operator()()
  {
    Branch_grouper group(std::move(m_tree.nodes), m_spacing);
    const std::size_t unreached = m_tree.number_of_unreached_axes;
    m_tree = group();
    m_tree.number_of_unreached_axes = unreached;
    m_number = group.number();
    assign_points();
    return std::move(m_tree);
  }

private:
  struct Inserted
  {
    double at; ///< segment + parameter in [0, 1]
    Index axis;
  };
  /// An axis of which nodes are being copied, from the joint with its parent outwards.
  struct Copied_axis
  {
    Index index;
    const Axis& nodes;
    bool is_reversed;
    std::vector<Inserted> seats; ///< joints of the child axes, in the order of copying
    std::size_t next = 0;        ///< first joint that is not inserted
    Index before = none;         ///< last node of the tree on this axis
  };

  /// Copies the axes in depth-first order from the root, and inserts a node at each joint.
  void add_axes(Index root)
  {
    m_places_of_axis.assign(m_set.axes.size(), none);
    m_stack = {{root, none}};
    while (!m_stack.empty()) {
      const auto [axis, seat] = m_stack.back();
      m_stack.pop_back();
      add_axis(axis, seat);
    }
  }

  /// Copies axis `a`, which begins at node `seat` of its parent.
  void add_axis(Index a, Index seat)
  {
    const Axis& axis = m_set.axes[a].axis;
    const bool is_reversed = m_joints[a].is_reversed;
    Copied_axis copy{a, axis, is_reversed, seats_on(a)};
    if (seat != none) // a separate node on the axis of the parent
      copy.before = add_base(is_reversed ? axis.back() : axis.front(), seat);
    m_first_node[a] = static_cast<Index>(m_tree.nodes.size());
    m_places_of_axis[a] = static_cast<Index>(m_node_of_place.size());
    m_node_of_place.emplace_back(axis.size(), none);
    for (std::size_t i = 0; i < axis.size(); ++i) {
      const std::size_t k = is_reversed ? axis.size() - 1 - i : i;
      // a joint between the nodes comes before the next node
      if (i > 0)
        add_seats(is_reversed ? double(k) + 1e-9 : double(k) - 1e-9, copy);
      add_unless_there(axis[k], copy);
      m_node_of_place.back()[k] = copy.before;
      add_seats(double(k), copy);
    }
    add_seats(is_reversed ? -1.0 : double(axis.size()), copy);
  }

  /// Returns the joints of the children of axis `a` in the order of copying.
  std::vector<Inserted> seats_on(Index a) const
  {
    std::vector<Inserted> seats;
    for (const Index c : m_children[a]) {
      const Axis_place& p = m_joints[c].place;
      seats.push_back({double(p.segment) + std::min(1.0, std::max(0.0, p.share)), c});
    }
    std::sort(seats.begin(), seats.end(), [](const Inserted& x, const Inserted& y) {
      return x.at != y.at ? x.at < y.at : x.axis < y.axis;
    });
    if (m_joints[a].is_reversed)
      std::reverse(seats.begin(), seats.end());
    return seats;
  }

  Index add_base(const Axis_node& end, Index seat)
  {
    Branch_node base;
    static_cast<Axis_node&>(base) = end;
    base.point = m_tree.nodes[seat].point;
    base.is_measured = false;
    return add(base, seat);
  }

  /// Inserts all joints up to `until`, and puts their axes on the stack.
  void add_seats(double until, Copied_axis& copy)
  {
    for (; copy.next < copy.seats.size(); ++copy.next) {
      const auto [at, child] = copy.seats[copy.next];
      if (copy.is_reversed ? !(at >= until) : !(at <= until))
        return;
      add_unless_there(node_at(copy.nodes, at), copy);
      m_stack.emplace_back(child, copy.before);
    }
  }

  /// Adds a node unless the last node of the axis lies at its position.
  void add_unless_there(const Axis_node& at, Copied_axis& copy)
  {
    Branch_node node;
    static_cast<Axis_node&>(node) = at;
    const bool is_there = copy.before != none && copy.before >= m_first_node[copy.index] &&
                          (m_tree.nodes[copy.before].point - node.point).norm() < 1e-3 * m_spacing;
    if (!is_there)
      copy.before = add(node, copy.before);
  }

  Index add(const Branch_node& node, Index parent)
  {
    m_tree.nodes.push_back(node);
    m_tree.nodes.back().parent = parent;
    return static_cast<Index>(m_tree.nodes.size() - 1);
  }

  void assign_points()
  {
    const std::size_t n = m_set.axis_of_point.size();
    m_tree.node_of_point.assign(n, none);
    for (std::size_t i = 0; i < n; ++i) {
      const Index a = m_set.axis_of_point[i];
      if (a == none || m_places_of_axis[a] == none)
        continue;
      const auto& places = m_node_of_place[m_places_of_axis[a]];
      const std::size_t k = std::min<std::size_t>(m_set.segment_of_point[i], places.size() - 1);
      m_tree.node_of_point[i] = m_number[places[k]];
    }
  }

  const Axis_set& m_set;
  const std::vector<Joint>& m_joints;
  double m_spacing;
  Branch_tree m_tree;
  std::vector<std::vector<Index>> m_children, m_node_of_place;
  std::vector<Index> m_first_node, m_places_of_axis, m_number;
  std::vector<std::pair<Index, Index>> m_stack; ///< axes to copy, and their parent nodes
};

} // namespace internal

/// Returns the tree of all axes reachable from the root. O(nodes log nodes).
inline Branch_tree
branch_tree(const Axis_set& set, const std::vector<Joint>& joints, Index root, double spacing)
{
  return internal::Tree_builder(set, joints, root, spacing)();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_GROUP_BRANCHES_H

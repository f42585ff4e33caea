// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeleton through the centers of geodesic level-set components [Verroust, Lazarus 2000].
//
// The axis of a leaf blade is its midrib: each level set of the distance from the root crosses the
// blade in one strip, whose center lies near the midrib. No cylinder is fitted.
//
//   c_v = mean of the points of component v,   parent(v) from the shortest paths,
//   major, minor = sqrt(2 lambda_1), sqrt(2 lambda_2),
//
// where lambda are the variances of the points in the two main directions across the axis. These
// are the half axes of an elliptic tube; those of a strip of half width a are sqrt(2/3) a and the
// noise. A side axis is kept if it is longer than the components around its base are wide; a strip
// whose points have the root mean square distance s from the center has the width 2 sqrt(3) s.
// Shorter axes are teeth of the margin. The positions on a branch are averaged over one width to
// both sides, with the numbers of points as weights, since a component may be a part of a strip.

#ifndef PCS_SKELETON_BRANCHING_LEVEL_SET_SKELETON_H
#define PCS_SKELETON_BRANCHING_LEVEL_SET_SKELETON_H

#include <pcs/skeleton/model/Branch_grouper.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Thickness of level sets that are connected across a blade, also if its points are random, in
/// spacings [-].
constexpr double blade_layer_thickness = 8;

namespace internal {

/// Selects components, and turns them into nodes.
class Level_set_tree_builder
{
public:
  Level_set_tree_builder(const Scan& scan, const Layer_tree& layers)
    : m_scan(scan), m_layers(layers)
  {
  }

  /// Returns the tree that begins with the component of a point of `root` from which the longest
  /// path begins.
  Branch_tree operator()(const std::vector<Index>& root)
  {
    link();
    Index start = none;
    for (const Index i : root) {
      const Index v = m_layers.node_of_point[i];
      if (v != none && (start == none || m_reach[v] > m_reach[start]))
        start = v;
    }
    if (start == none)
      return Branch_tree();
    select(start);
    if (m_selected.size() < 2) // no edge
      return Branch_tree();
    Branch_grouper group(nodes(), m_scan.spacing);
    Branch_tree tree = group();
    tree.node_of_point.assign(m_scan.size(), none);
    std::vector<double> weights(tree.nodes.size(), 0);
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_layers.node_of_point[i] != none && m_number[m_layers.node_of_point[i]] != none) {
        tree.node_of_point[i] = group.number()[m_number[m_layers.node_of_point[i]]];
        weights[tree.node_of_point[i]] += 1;
      }
    smooth(weights, tree);
    return tree;
  }

private:
  double distance(Index v, Index w) const
  {
    return (m_layers.center[v] - m_layers.center[w]).norm();
  }

  /// Finds the children of each component, and the length of the longest path to a tip.
  void link()
  {
    const std::size_t n = m_layers.size();
    m_children.assign(n, {});
    m_reach.assign(n, 0);
    for (Index v = static_cast<Index>(n); v-- > 0;) { // parents have smaller indices
      const Index p = m_layers.parent[v];
      if (p == none)
        continue;
      m_children[p].push_back(v);
      m_reach[p] = std::max(m_reach[p], distance(v, p) + m_reach[v]);
    }
  }

  /// Numbers the kept components, parents before their children.
  void select(Index start)
  {
    m_number.assign(m_layers.size(), none);
    std::vector<Index> stack{start};
    while (!stack.empty()) {
      const Index v = stack.back();
      stack.pop_back();
      m_number[v] = static_cast<Index>(m_selected.size());
      m_selected.push_back(v);
      double spread = m_layers.spread[v];
      if (m_layers.parent[v] != none)
        spread = std::max(spread, m_layers.spread[m_layers.parent[v]]);
      for (const Index c : m_children[v])
        spread = std::max(spread, m_layers.spread[c]);
      const double width = 2 * std::sqrt(3.0) * spread;
      for (const Index c : m_children[v]) {
        const double length = distance(c, v) + m_reach[c];
        if (length == m_reach[v] || length > width)
          stack.push_back(c);
      }
    }
  }

  std::vector<Branch_node> nodes() const
  {
    std::vector<Branch_node> result;
    for (const Index v : m_selected) {
      const Index p = m_layers.parent[v];
      Branch_node node;
      node.parent = result.empty() ? none : m_number[p];
      node.point = m_layers.center[v];
      node.is_measured = true;
      const Index before = result.empty() ? v : p;
      const Index after = m_children[v].empty() ? v : m_children[v].front();
      set_section(v, m_layers.center[after] - m_layers.center[before], node);
      result.push_back(node);
    }
    return result;
  }

  /// Sets the cross-section from the variances of the points of component `v` across `along`.
  void set_section(Index v, const Vec3& along, Branch_node& node) const
  {
    const double length = along.norm();
    Eigen::Matrix3d across = Eigen::Matrix3d::Identity();
    if (length > 0)
      across -= along * along.transpose() / (length * length);
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (Index k = m_layers.first[v]; k < m_layers.first[v + 1]; ++k) {
      const Vec3 d = across * (m_scan.points[m_layers.point[k]] - m_layers.center[v]);
      moments += d * d.transpose();
    }
    moments /= double(m_layers.count(v));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
    const double least = 0.25 * m_scan.spacing; // of a component with a single point
    const double major = std::max(least, std::sqrt(2 * std::max(0.0, solver.eigenvalues()[2])));
    const double minor = std::max(least, std::sqrt(2 * std::max(0.0, solver.eigenvalues()[1])));
    node.radius = std::sqrt(major * minor);
    if (major > minor)
      node.set_ellipse(major / minor, solver.eigenvectors().col(2));
  }

  /// Averages the positions along each branch. Tips keep their positions.
  static void smooth(const std::vector<double>& weights, Branch_tree& tree)
  {
    std::vector<Vec3> smoothed(tree.nodes.size());
    for (const Branch& branch : tree.branches) {
      const std::vector<Index>& nodes = branch.nodes;
      std::vector<double> at(nodes.size(), 0); // arc lengths
      for (std::size_t k = 1; k < nodes.size(); ++k)
        at[k] = at[k - 1] + (tree.nodes[nodes[k]].point - tree.nodes[nodes[k - 1]].point).norm();
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const Branch_node& node = tree.nodes[nodes[k]];
        const double reach =
            std::min({2 * std::max(node.radius, node.major_radius), at[k], at.back() - at[k]});
        std::size_t first = k, last = k;
        while (first > 0 && at[k] - at[first - 1] <= reach)
          --first;
        while (last + 1 < nodes.size() && at[last + 1] - at[k] <= reach)
          ++last;
        Vec3 sum = Vec3::Zero();
        double weight = 0;
        for (std::size_t j = first; j <= last; ++j) {
          sum += weights[nodes[j]] * tree.nodes[nodes[j]].point;
          weight += weights[nodes[j]];
        }
        smoothed[nodes[k]] = weight > 0 ? Vec3(sum / weight) : node.point;
      }
    }
    for (const Branch& branch : tree.branches) // parents come first
      for (const Index v : branch.nodes) {
        Branch_node& node = tree.nodes[v];
        const bool is_base = tree.is_base(v) && node.parent != none;
        node.point = is_base ? tree.nodes[node.parent].point : smoothed[v];
      }
  }

  const Scan& m_scan;
  const Layer_tree& m_layers;
  std::vector<std::vector<Index>> m_children;
  std::vector<double> m_reach;             ///< length of the longest path to a tip [L]
  std::vector<Index> m_selected, m_number; ///< kept components, and their numbers
};

} // namespace internal

/*!
  Returns the skeleton through the centers of the level-set components of `layers`. It begins with
  the component at the points `root` that has the longest path to a tip, and is empty if there is no
  edge. O(n log n).
*/
inline Branch_tree
level_set_skeleton(const Scan& scan, const Layer_tree& layers, const std::vector<Index>& root)
{
  return internal::Level_set_tree_builder(scan, layers)(root);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_LEVEL_SET_SKELETON_H

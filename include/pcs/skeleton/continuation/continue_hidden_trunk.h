// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Continuation of a trunk that leaves hide to the top of the tree.

#ifndef PCS_SKELETON_CONTINUATION_CONTINUE_HIDDEN_TRUNK_H
#define PCS_SKELETON_CONTINUATION_CONTINUE_HIDDEN_TRUNK_H

#include <pcs/internal/constants.h>
#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for a hidden trunk. Lengths are in radii of the trunk unless stated otherwise [-].
struct Hidden_trunk_options
{
  double window = 6;       ///< length over which a section is compared with the wood beyond
  double before = 3;       ///< length below a section over which its radius is the median
  double direction = 20;   ///< length below a section that gives its direction
  double missing = 0.5;    ///< least fraction of the cross-section area without continuation [-]
  double thinnest = 0.2;   ///< least radius, in median radii up to breast height, or of the cone
  double spread = 0.5;     ///< tangent of the half angle of the cone that contains the top [-]
  double shortest = 12;    ///< least length of the hidden part
  double steepest = 0.8;   ///< least cosine of the last visible part and its direction [-]
  double continuing = 0.6; ///< least radius of the last visible part
  double step = 4;         ///< distance of the new nodes
  double tip = 0.05;       ///< radius of the tip
};

/// Sizes of the inferred part of a trunk; 0: none.
struct Hidden_trunk_part
{
  double length = 0; ///< [L]
  double volume = 0; ///< [L^3]
};

namespace internal {

/// The last visible section of a trunk.
struct Visible_trunk
{
  std::size_t end;        ///< index of the last visible node in the trunk
  double radius, missing; ///< where the trunk ends [L], fraction of the area that does not continue
};

/// Finds the hidden part of the trunk of a tree.
class Hidden_trunk
{
public:
  /// Keeps references to all arguments. `breast_height` [L]; z points upwards.
  Hidden_trunk(const Branch_tree& tree, double breast_height, const Hidden_trunk_options& rules)
    : m_tree(tree), m_trunk(tree.branches.front().nodes), m_rules(rules)
  {
    for (std::size_t k = 0; k < m_trunk.size(); ++k)
      m_place.push_back(k == 0 ? 0 : m_place.back() + (point(k) - point(k - 1)).norm());
    m_first = index_at(breast_height);
    std::vector<double> radii;
    for (std::size_t k = 0; k < std::min(m_first + 1, m_trunk.size()); ++k)
      radii.push_back(radius(k));
    m_stem_radius = pcs::internal::lower_median(radii);
    add_children();
  }

  /// Returns nothing if enough of the cross-section area continues everywhere.
  std::optional<Visible_trunk> find_end() const
  {
    if (m_first >= m_trunk.size())
      return std::nullopt;
    const double thinnest = m_rules.thinnest * m_stem_radius;
    std::size_t first = 0; // below breast height if the trunk is a twig there
    while (first < m_first && radius(first + 1) >= thinnest)
      ++first;
    for (std::size_t k = first; k < m_trunk.size(); ++k) {
      const double r = median_radius(k);
      if (r < thinnest)
        break;
      const double missing = 1 - continued_area(k, r) / (r * r);
      if (missing >= m_rules.missing)
        return Visible_trunk{last_visible(k, r), r, missing};
    }
    return std::nullopt;
  }

  /// Returns the direction to node `k` of the trunk from breast height, or from the root if that is
  /// near.
  Vec3 direction_to(std::size_t k) const
  {
    const double length = m_rules.direction * median_radius(k);
    const std::size_t from = m_place[k] - m_place[m_first] >= length ? m_first : 0;
    return (point(k) - point(from)).normalized();
  }

private:
  const Vec3& point(std::size_t k) const { return m_tree.nodes[m_trunk[k]].point; }
  double radius(std::size_t k) const { return m_tree.nodes[m_trunk[k]].radius; }

  double median_radius(std::size_t k) const
  {
    std::vector<double> radii;
    for (std::size_t j = k + 1; j-- > 0 && m_place[j] >= m_place[k] - m_rules.before * radius(k);)
      radii.push_back(radius(j));
    return pcs::internal::lower_median(radii);
  }

  /// Returns the index of the first node of the trunk at the arc length `s` or beyond.
  std::size_t index_at(double s) const
  {
    return static_cast<std::size_t>(std::lower_bound(m_place.begin(), m_place.end(), s) -
                                    m_place.begin());
  }

  /// Sets the areas of the branches on the trunk: the squared median radius of their first nodes.
  void add_children()
  {
    constexpr std::size_t most = 7; // nodes
    m_area.assign(m_trunk.size(), 0);
    for (std::size_t b = 1; b < m_tree.branches.size(); ++b) {
      const Branch& branch = m_tree.branches[b];
      if (branch.parent != 0)
        continue;
      const Index seat = m_tree.nodes[branch.nodes.front()].parent;
      const auto at = std::lower_bound(m_trunk.begin(), m_trunk.end(), seat);
      std::vector<double> radii;
      for (std::size_t k = 0; k < std::min(most, branch.nodes.size()); ++k)
        radii.push_back(m_tree.nodes[branch.nodes[k]].radius);
      const double r = pcs::internal::lower_median(radii);
      m_area[static_cast<std::size_t>(at - m_trunk.begin())] += r * r;
    }
  }

  /// Returns the squared radius of the wood that continues node `k` of radius `r` [L^2].
  double continued_area(std::size_t k, double r) const
  {
    const double s = m_place[k], window = m_rules.window * r;
    const Vec3 along = (point(k) - point(index_at(std::max(0.0, s - m_rules.direction * r))))
                           .normalized(); // zero for a single node
    double trunk = 0, branches = 0;
    for (std::size_t j = index_at(s - m_rules.before * r); j < m_trunk.size(); ++j) {
      if (m_place[j] > s + 3 * window)
        break;
      if (m_place[j] <= s + window)
        branches += m_area[j];
      if (m_place[j] < s + window)
        continue;
      const double cosine = std::max(0.0, along.dot((point(j) - point(k)).normalized()));
      trunk = std::max(trunk, std::pow(radius(j) * cosine, 2));
    }
    return trunk + branches;
  }

  /// Returns the last node within a window beyond node `k` that continues it.
  std::size_t last_visible(std::size_t k, double r) const
  {
    const Vec3 along = direction_to(k);
    std::size_t last = k;
    for (std::size_t j = k + 1; j < m_trunk.size() && m_place[j] <= m_place[k] + m_rules.window * r;
         ++j)
      if (radius(j) >= m_rules.continuing * r &&
          along.dot((point(j) - point(k)).normalized()) > m_rules.steepest)
        last = j;
    return last;
  }

  const Branch_tree& m_tree;
  const std::vector<Index>& m_trunk;
  const Hidden_trunk_options& m_rules;
  std::vector<double> m_place; // arc length of each node of the trunk
  std::vector<double> m_area;  // of the branches at each node, as squared radii
  std::size_t m_first = 0;     // node at breast height
  double m_stem_radius = 0;    // median up to breast height
};

/// Returns the highest point up to the height `top` [L] for which `is_tree(i)` holds in a cone
/// around the ray from `apex` along `axis`; `none` if there is none.
template <class IsTree>
Index highest_in_cone(const Scan& scan,
                      const IsTree& is_tree,
                      double top,
                      const Vec3& apex,
                      const Vec3& axis,
                      double tangent)
{
  Index highest = none;
  for (Index i = 0; i < scan.size(); ++i) {
    const double z = scan.points[i].z();
    if (z > top || (highest != none && !(z > scan.points[highest].z())) || !is_tree(i))
      continue;
    const Vec3 v = scan.points[i] - apex;
    const double t = v.dot(axis);
    if (t > 0 && (v - t * axis).norm() < tangent * t)
      highest = i;
  }
  return highest;
}

/// Returns the sum of the squared radii of the edges that rise through the plane at the distance
/// `s` from `origin` along `direction`, with unit length [L^2].
inline double area_at(const Branch_tree& tree, const Vec3& origin, const Vec3& direction, double s)
{
  double area = 0;
  for (Index v = 1; v < tree.nodes.size(); ++v) {
    const Branch_node& node = tree.nodes[v];
    if (!tree.is_base(v) && direction.dot(tree.nodes[node.parent].point - origin) < s &&
        direction.dot(node.point - origin) >= s)
      area += node.radius * node.radius;
  }
  return area;
}

/// Replaces the trunk beyond its node `end` by the nodes `tip`. What was beyond becomes a branch of
/// order 1, which begins with a node on the axis of the trunk.
inline void
replace_trunk_tip(std::size_t end, const std::vector<Branch_node>& tip, Branch_tree& tree)
{
  const std::vector<Index> trunk = tree.branches.front().nodes;
  const bool has_rest = end + 1 < trunk.size();
  const Index seat = trunk[end];
  const auto added = static_cast<Index>(tip.size() + (has_rest ? 1 : 0));
  const auto moved = [&](Index v) { return v == none || v <= seat ? v : v + added; };

  std::vector<Branch_node> nodes(tree.nodes.begin(), tree.nodes.begin() + seat + 1);
  for (const Branch_node& node : tip) {
    nodes.push_back(node);
    nodes.back().parent = static_cast<Index>(nodes.size() - 2); // first the seat
  }
  const auto base = static_cast<Index>(nodes.size());
  if (has_rest) {
    nodes.push_back(tree.nodes[trunk[end + 1]]);
    nodes.back().point = tree.nodes[seat].point;
    nodes.back().parent = seat;
  }
  for (auto v = std::size_t(seat) + 1; v < tree.nodes.size(); ++v) {
    nodes.push_back(tree.nodes[v]);
    nodes.back().parent = moved(nodes.back().parent);
  }
  if (has_rest)
    nodes[moved(trunk[end + 1])].parent = base;
  for (Index& v : tree.node_of_point)
    v = moved(v);
  for (Branch& branch : tree.branches)
    for (Index& v : branch.nodes)
      v = moved(v);

  std::vector<Branch> branches(1);
  branches[0].nodes.assign(trunk.begin(), trunk.begin() + static_cast<std::ptrdiff_t>(end) + 1);
  for (Index k = 0; k < tip.size(); ++k)
    branches[0].nodes.push_back(seat + 1 + k);
  if (has_rest) {
    Branch rest;
    rest.nodes.push_back(base);
    const std::vector<Index>& old = tree.branches.front().nodes; // moved
    rest.nodes.insert(rest.nodes.end(),
                      old.begin() + static_cast<std::ptrdiff_t>(end) + 1,
                      old.end());
    branches.push_back(std::move(rest));
  }
  for (std::size_t b = 1; b < tree.branches.size(); ++b)
    branches.push_back(std::move(tree.branches[b]));
  tree.nodes = std::move(nodes);
  tree.branches = std::move(branches);
  for (Index b = 0; b < tree.branches.size(); ++b) {
    Branch& branch = tree.branches[b];
    for (const Index v : branch.nodes)
      tree.nodes[v].branch = b;
    if (b > 0) { // parents and their nodes precede their children
      branch.parent = tree.nodes[tree.nodes[branch.nodes.front()].parent].branch;
      branch.order = tree.branches[branch.parent].order + 1;
    }
  }
}

} // namespace internal

/*!
  Continues a trunk that disappears in its crown straight to the top of the tree, as a cone. Leaves
  and branches hide the upper stem, and the trunk that was found then turns into a side branch or
  into leaves. Returns the sizes of the inferred part.

  The wood beyond a section carries its cross-section area in trees (pipe model). With the median
  radius `R_k` [L] of the trunk over `before` radii below its node `k`, at the arc length `s_k` [L],
  the missing fraction is

      m_k = 1 - (max_j (r_j cos_kj)^2 + sum_c r_c^2) / R_k^2                                  [-]

  over the nodes `j` with `w <= s_j - s_k <= 3 w` for `w = window R_k`, the cosines `cos_kj` of the
  directions to them and of the trunk below, and the branches `c` on the trunk from `before` radii
  below `k` up to `s_k + w`. Node `k` is the lowest one from breast height on for which `m_k` is at
  least `missing`, or the last thick one below. The trunk ends at the last node up to `s_k + w` with
  at least `continuing` times the radius, in the direction of the trunk. It continues to the highest
  point within a cone around this direction, if there is one farther than `shortest` radii. At the
  fraction `t` [-] of its length, the radius `r` [L] is that of the wood that the branches do not
  explain,

      r^2 = max(C^2 - sum_e r_e^2, (thinnest C)^2)   for the cone C = R_k (1 - (1 - tip) t),

  where the edges `e` of other branches rise through the plane at this distance. The former
  continuation becomes a branch.

  New nodes count as inferred. `is_tree(i)` holds for the points of wood and leaves, `top_of_tree`
  is the height of its top [L], above which points are strays. z points upwards. O(points + nodes *
  new nodes); at most 1000 nodes are new.
*/
template <class IsTree>
Hidden_trunk_part continue_hidden_trunk(const Scan& scan,
                                        const IsTree& is_tree,
                                        double top_of_tree,
                                        double breast_height,
                                        const Hidden_trunk_options& rules,
                                        Branch_tree& tree)
{
  if (tree.branches.empty())
    return {};
  const internal::Hidden_trunk trunk(tree, breast_height, rules);
  const auto found = trunk.find_end();
  if (!found)
    return {};
  const Branch_node& last = tree.nodes[tree.branches.front().nodes[found->end]];
  const Index top = internal::highest_in_cone(scan,
                                              is_tree,
                                              top_of_tree,
                                              last.point,
                                              trunk.direction_to(found->end),
                                              rules.spread);
  if (top == none)
    return {};
  const Vec3 rest = scan.points[top] - last.point;
  const double length = rest.norm();
  if (length < rules.shortest * found->radius)
    return {};
  const double count = std::ceil(length / (rules.step * found->radius));
  const auto steps = static_cast<std::size_t>(std::min(count, 1000.0));
  std::vector<Branch_node> tip(steps);
  for (std::size_t k = 1; k <= steps; ++k) {
    const double share = double(k) / double(steps);
    const double cone = found->radius * (1 - (1 - rules.tip) * share);
    const double area = internal::area_at(tree, last.point, rest / length, share * length);
    Branch_node& node = tip[k - 1];
    node.point = last.point + share * rest;
    node.radius = std::sqrt(std::max(cone * cone - area, std::pow(rules.thinnest * cone, 2)));
    node.radius_error = node.radius;
  }
  Hidden_trunk_part part;
  part.length = length;
  double below = found->radius;
  for (const Branch_node& node : tip) { // frusta
    const double r = node.radius;
    part.volume +=
        pcs::internal::pi / 3 * length / double(steps) * (below * below + below * r + r * r);
    below = r;
  }
  internal::replace_trunk_tip(found->end, tip, tree);
  return part;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_CONTINUE_HIDDEN_TRUNK_H

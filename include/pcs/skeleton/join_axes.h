// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Decides for every axis on which other one it sits, and where: one rooted tree of branches.

#ifndef PCS_SKELETON_JOIN_AXES_H
#define PCS_SKELETON_JOIN_AXES_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/Axis.h>
#include <pcs/skeleton/Axis_set.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// What a joint costs. Factors of the spacing unless said otherwise [-].
struct Joint_rules
{
  double reach = 30; ///< widest gap between the base of a branch and the surface of its parent
  double long_reach = 0.2;        ///< ... or this share of the length of the branch [-]
  double base_length = 8;         ///< length over which the direction of a base is taken
  double lateral = 4;             ///< cost of missing the parent's axis, per length [-]
  double lateral_tolerance = 0.3; ///< of it free of charge, in radii of the parent
  double tie = 0.02;     ///< of the whole distance: what costs nothing else is decided by it [-]
  double steep_gap = 12; ///< gaps longer than this cost more than their length
  double radius = 4;     ///< for each time that the base is thicker than its parent
  double backward = 3;   ///< for pointing to the root of the parent
  double reversal = 6;   ///< for using the tip as the base
  double path_bonus = 1; ///< factor where the paths to the root agree; 1: geometry alone [-]
  double bend = 6;       ///< for the angle at the tip of the parent
};

/// Where an axis sits on its parent.
struct Joint
{
  Index parent = none; ///< `none`: the root, or out of reach
  Axis_place place;
  bool is_reversed = false; ///< its tip is the base
  double cost = std::numeric_limits<double>::infinity();
};

namespace internal {

/// An end of an axis, seen from outside.
struct Axis_end
{
  Vec3 point;
  Vec3 inward; ///< unit vector into the axis
  double radius;
};

inline Axis_end end_of(const Axis& axis, bool is_tip, double length)
{
  const std::size_t n = axis.size();
  const auto node = [&](std::size_t k) -> const Axis_node& { return axis[is_tip ? n - 1 - k : k]; };
  Axis_end end{node(0).point, Vec3::Zero(), 0};
  double gone = 0, radius = node(0).radius;
  std::size_t k = 1, count = 1;
  Vec3 mean = Vec3::Zero(); // of the nodes, which damps the raggedness of a single one
  for (; k < n && (gone < length || k < 3); ++k) {
    gone += (node(k).point - node(k - 1).point).norm();
    mean += node(k).point;
    radius += node(k).radius;
    ++count;
  }
  end.radius = radius / double(count);
  const Vec3 d = mean / double(count - 1) - end.point;
  end.inward = d.norm() > 0 ? Vec3(d.normalized()) : Vec3(Vec3::UnitZ());
  return end;
}

inline Vec3 tangent(const Axis& axis, std::size_t segment)
{
  const Vec3 d = axis[segment + 1].point - axis[segment].point;
  const double length = d.norm();
  return length > 0 ? Vec3(d / length) : Vec3(Vec3::UnitZ());
}

} // namespace internal

class Axis_joiner
{
public:
  Axis_joiner(const Axis_set& set, double spacing, const Joint_rules& rules)
    : m_set(set), m_spacing(spacing), m_rules(rules)
  {
    for (Index a = 0; a < set.axes.size(); ++a)
      for (Index k = 0; k < set.axes[a].axis.size(); ++k) {
        m_nodes.push_back(set.axes[a].axis[k].point);
        m_place_of_node.emplace_back(a, k);
        m_thickest = std::max(m_thickest, set.axes[a].axis[k].radius);
      }
  }

  /// A joint for every axis but the root; no cycles. Axes that nothing is near to have no parent.
  template <class ConcurrencyTag>
  std::vector<Joint> run(Index root) const
  {
    const std::size_t n = m_set.axes.size();
    const neighborhood::Nearest_neighbors search(m_nodes);
    std::vector<std::vector<Joint>> options(n);
    pcs::internal::for_each_index<ConcurrencyTag>(
        n,
        [&](std::size_t a) {
          if (a != root)
            options[a] = options_of(static_cast<Index>(a), search);
        },
        16);
    return choose(root, options);
  }

private:
  /// The cheapest place on axis `b` near the given nodes of it.
  Joint best_place(const internal::Axis_end& end,
                   Index b,
                   const std::vector<Index>& nodes,
                   double reach) const;
  double cost(const internal::Axis_end& end, Index b, const Axis_place& place, double reach) const;
  std::vector<Joint> options_of(Index a, const neighborhood::Nearest_neighbors& search) const;
  static std::vector<std::uint8_t> reached_from(Index root, const std::vector<Joint>& joints)
  {
    const std::size_t n = joints.size();
    std::vector<std::vector<Index>> children(n);
    for (Index a = 0; a < n; ++a)
      if (joints[a].parent != none)
        children[joints[a].parent].push_back(a);
    std::vector<std::uint8_t> is_reached(n, 0);
    std::vector<Index> stack{root};
    while (!stack.empty()) {
      const Index a = stack.back();
      stack.pop_back();
      is_reached[a] = 1;
      stack.insert(stack.end(), children[a].begin(), children[a].end());
    }
    return is_reached;
  }
  static std::vector<Joint> choose(Index root, const std::vector<std::vector<Joint>>& options);

  const Axis_set& m_set;
  double m_spacing, m_thickest = 0;
  Joint_rules m_rules;
  std::vector<Vec3> m_nodes;
  std::vector<std::pair<Index, Index>> m_place_of_node;
};

inline double Axis_joiner::cost(const internal::Axis_end& end,
                                Index b,
                                const Axis_place& place,
                                double reach) const
{
  const Axis& axis = m_set.axes[b].axis;
  const double u = m_spacing, radius = radius_at(axis, place);
  const Vec3 v = point_at(axis, place) - end.point;
  const double distance = v.norm(), gap = std::max(0.0, distance - radius);
  if (gap > reach)
    return std::numeric_limits<double>::infinity();
  const double back = -v.dot(end.inward); // > 0: the parent lies behind the base
  const double lateral = (v + back * end.inward).norm();
  double sum = gap * std::max(1.0, gap / (m_rules.steep_gap * u));
  sum += m_rules.lateral * std::max(0.0, lateral - m_rules.lateral_tolerance * radius);
  sum += std::max(0.0, -back - radius);
  sum += m_rules.tie * (lateral + distance);
  sum += m_rules.radius * u * std::max(0.0, end.radius / std::max(radius, 1e-3 * u) - 1);
  const double cosine = internal::tangent(axis, place.segment).dot(end.inward);
  sum += m_rules.backward * u * std::max(0.0, -cosine);
  const bool is_tip = place.segment + 2 == axis.size() && place.share >= 1;
  if (is_tip)
    sum += m_rules.bend * u * std::max(0.0, 0.7 - cosine);
  return sum;
}

inline Joint Axis_joiner::best_place(const internal::Axis_end& end,
                                     Index b,
                                     const std::vector<Index>& nodes,
                                     double reach) const
{
  constexpr int parts = 6;
  const Axis& axis = m_set.axes[b].axis;
  Joint best;
  best.parent = b;
  Index previous = none;
  for (const Index node : nodes)
    for (const Index s : {node > 0 ? node - 1 : node, node}) {
      if (s + 1 >= axis.size() || s == previous)
        continue;
      previous = s;
      for (int k = 0; k <= parts; ++k) {
        Axis_place place;
        place.segment = s;
        place.share = double(k) / parts;
        const double c = cost(end, b, place, reach);
        if (c < best.cost) {
          best.cost = c;
          best.place = place;
        }
      }
    }
  return best;
}

inline std::vector<Joint>
Axis_joiner::options_of(Index a, const neighborhood::Nearest_neighbors& search) const
{
  std::vector<Joint> options;
  std::vector<Index> near, nodes;
  const Axis& axis = m_set.axes[a].axis;
  const double reach = std::max(m_rules.reach * m_spacing, m_rules.long_reach * length_of(axis));
  for (const bool is_tip : {false, true}) {
    const double length =
        std::min(std::max(m_rules.base_length * m_spacing, 2 * axis.front().radius),
                 0.7 * length_of(axis));
    const internal::Axis_end end = internal::end_of(axis, is_tip, length);
    near.clear();
    search.within(end.point, reach + m_thickest, near); // by axis, then by node
    for (std::size_t i = 0; i < near.size();) {
      const Index b = m_place_of_node[near[i]].first;
      nodes.clear();
      for (; i < near.size() && m_place_of_node[near[i]].first == b; ++i) {
        const Index k = m_place_of_node[near[i]].second;
        const double gap = (m_nodes[near[i]] - end.point).norm() - m_set.axes[b].axis[k].radius;
        if (gap < reach + 8 * m_spacing)
          nodes.push_back(k);
      }
      if (b == a || nodes.empty())
        continue;
      Joint joint = best_place(end, b, nodes, reach);
      joint.is_reversed = is_tip;
      if (is_tip)
        joint.cost += m_rules.reversal * m_set.axes[a].direction * m_spacing;
      if (m_set.axes[a].parent == b && !is_tip)
        joint.cost *= m_rules.path_bonus;
      if (std::isfinite(joint.cost))
        options.push_back(joint);
    }
  }
  std::stable_sort(options.begin(), options.end(), [](const Joint& x, const Joint& y) {
    return x.cost < y.cost;
  });
  constexpr std::size_t enough = 400;
  if (options.size() > enough)
    options.resize(enough);
  return options;
}

/*!
  Every axis takes its cheapest option. What then does not hang on the root, because it runs in a circle, is led back
  axis by axis where the change to an option that does costs least.
*/
inline std::vector<Joint> Axis_joiner::choose(Index root,
                                              const std::vector<std::vector<Joint>>& options)
{
  const std::size_t n = options.size();
  std::vector<Joint> joints(n);
  for (Index a = 0; a < n; ++a)
    if (a != root && !options[a].empty())
      joints[a] = options[a].front();
  while (true) {
    const std::vector<std::uint8_t> is_reached = reached_from(root, joints);
    Index who = none;
    Joint instead;
    double least = std::numeric_limits<double>::infinity();
    for (Index a = 0; a < n; ++a) {
      if (is_reached[a])
        continue;
      for (const Joint& o : options[a])
        if (is_reached[o.parent]) {
          if (o.cost - joints[a].cost < least) {
            least = o.cost - joints[a].cost;
            who = a;
            instead = o;
          }
          break; // options are sorted
        }
    }
    if (who == none) {
      for (Index a = 0; a < n; ++a)
        if (!is_reached[a])
          joints[a] = Joint();
      return joints;
    }
    joints[who] = instead;
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_JOIN_AXES_H

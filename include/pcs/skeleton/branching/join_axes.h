// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Choice of the parent of every axis by log-odds: one rooted tree of branches.
//
// For every axis except the roots, the cost of a joint is minimised over both ends of the axis, all
// other axes, and seven positions on each of their segments in reach. A cost is a sum of log-odds
// [-]; lower is more likely. The weights are those of Joint_options, estimated by a conditional
// logit from scans of virtual trees (doc/design/skeletons/parents_of_branches.md).
//
// An end of a branch has the position x [L], the unit vector d into the branch and the radius r
// [L]; its other end has the radius r' [L]. At a position x + v on an axis of radius R [L] and unit
// tangent t, with the lateral offset a = |v - (v . d) d| [L], the gap g = max(0, |v| - R) [L] and
// the spacing u [L], the joint costs
//
//   gap g / u max(1, g / (steep_gap u)) + overlap max(0, v . d - R) / u + tie (a + |v|) / u
//   + angle (1 - max(t . d, lowest_cosine))
//   + radius ln max(1, r / (free_share R))
//   + lateral ln(1 + max(0, a - lateral_tolerance R) / u)
//   - taper ln(r / r') + (reversal direction, if the end is the tip),                         [-]
//
// subject to g <= max(reach u, long_reach length). Radii in ratios are at least thinnest u;
// direction [-] is the certainty of the base of the branch.
//
// An axis beside the foot may stand on the ground instead, which costs as much as a joint with a
// vertical parent at the distance of its lower end from the ground, plus `standing`. It is then an
// object or another stem, as are all axes that are joined to it.
//
// Every axis takes its joint of least cost. Cycles are then resolved one axis at a time by the
// least additional cost, which need not minimise the sum of all costs.

#ifndef PCS_SKELETON_BRANCHING_JOIN_AXES_H
#define PCS_SKELETON_BRANCHING_JOIN_AXES_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/branching/heights_above_ground.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Joint.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Costs of a joint: log-odds, estimated from scans of virtual trees. Lengths are in spacings [-].
struct Joint_options
{
  int rounds = 2;    ///< selections of joints; all but the first join branches [count]
  double reach = 30; ///< widest gap between the base of a branch and the surface of its parent
  double long_reach = 0.2; ///< ... or this fraction of the length of the branch [-]
  double base_length = 8;  ///< length from which the direction of a base is computed
  double lateral = 1.8;    ///< cost of a lateral offset from the parent's axis, per log(1 + offset)
  double lateral_tolerance = 0.3; ///< offset without cost, in radii of the parent
  double gap = 0.044;             ///< cost of a gap, per length ...
  double steep_gap = 12;          ///< ... and beyond this length, the cost is quadratic
  double overlap = 0.115;         ///< cost of a parent ahead of the base, per length
  double tie = 0.05;  ///< cost of the whole distance, which decides between equal joints
  double angle = 3.2; ///< cost of 1 - cosine of the angle to the parent ...
  double lowest_cosine =
      -0.2;            ///< ... for at least this cosine, since the parent itself may be reversed
  double radius = 0.6; ///< cost of a thick base, per log ratio to the parent's radius ...
  double free_share = 0.37; ///< ... above this ratio
  double taper = 0.85;      ///< gain of a base thicker than the tip, per log ratio
  double reversal = 1.1;    ///< cost of the tip as the base
  double standing = 3;      ///< least gain of an axis that stands on the ground beside the tree
  double apart = 4;         ///< least distance of its lower end from the foot, in stem widths
  double thinnest = 0.1;    ///< lower bound on radii when ratios are computed
};

namespace internal {

/// An end of an axis, with its inward direction.
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
  Vec3 mean = Vec3::Zero(); // mean of several nodes, which reduces noise
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

/*!
  Selects the parent of every axis except the roots by the costs of joints, as stated at the head of
  this file.

  Every pair of an end and an axis has one option: its joint of least cost. At most O(k^2) for each
  axis of k <= 400 options, after the search for near nodes.
*/
class Axis_joiner
{
public:
  Axis_joiner(const Axis_set& set, double spacing, const Joint_options& rules)
    : m_set(set), m_spacing(spacing), m_rules(rules)
  {
    for_each_node([](Level& level, const Axis_node&, Node) { ++level.count; });
    for (Level& level : m_levels)
      level.reserve();
    for_each_node([](Level& level, const Axis_node& node, Node place) { level.add(node, place); });
    for (Level& level : m_levels)
      level.search = std::make_unique<neighborhood::Nearest_neighbors>(level.points);
  }

  /// Selects a joint for every axis except the root, without cycles. Isolated axes have no parent.
  template <class ConcurrencyTag>
  std::vector<Joint> run(Index root) const
  {
    return run<ConcurrencyTag>(std::vector<Index>{root});
  }
  /// Selects the joints for several roots, one tree each.
  template <class ConcurrencyTag>
  std::vector<Joint> run(const std::vector<Index>& roots) const
  {
    std::vector<Index> standing;
    return run<ConcurrencyTag>(roots, {}, Vec3::UnitZ(), standing);
  }
  /// Selects the joints, and adds the axes that stand on the ground to `standing`. `heights`: of
  /// both ends of every axis above the ground [L]; may be empty.
  template <class ConcurrencyTag>
  std::vector<Joint> run(const std::vector<Index>& roots,
                         const End_heights& heights,
                         const Vec3& up,
                         std::vector<Index>& standing) const
  {
    const std::size_t n = m_set.axes.size();
    std::vector<std::uint8_t> is_root(n, 0);
    for (const Index root : roots)
      is_root[root] = 1;
    std::vector<std::vector<Option>> options(n);
    pcs::internal::for_each_index<ConcurrencyTag>(
        n,
        [&](std::size_t a) {
          if (!is_root[a])
            options[a] = options_of(static_cast<Index>(a));
        },
        16);
    std::vector<Joint> joints(n);
    for (std::size_t a = 0; a < n; ++a)
      if (!options[a].empty())
        joints[a] = options[a].front().joint();
    for (Index a = 0; a < heights.size(); ++a)
      if (!is_root[a] && standing_cost(a, heights[a], up) < joints[a].cost) {
        joints[a] = Joint();
        standing.push_back(a);
      }
    Joint_tree tree(joints);
    std::vector<Index> starts = roots;
    starts.insert(starts.end(), standing.begin(), standing.end());
    for (const Index start : starts)
      for (const Index a : tree.reach(start))
        std::vector<Option>().swap(options[a]); // large
    change_joints(options, tree, joints);
    return joints;
  }

private:
  using Node = std::pair<Index, Index>; ///< axis, index on it

  /// A possible joint in 16 bytes, since there are up to 400 for each axis.
  struct Option
  {
    double cost;
    Index parent;
    Index place; ///< segment, part of the segment in three bits, whether the axis is reversed

    Option(Index b, Index segment, int part, bool is_reversed, double of_joint)
      : cost(of_joint),
        parent(b),
        place(segment << 4 | static_cast<Index>(part) << 1 | static_cast<Index>(is_reversed))
    {
    }
    Joint joint() const
    {
      Joint result;
      result.parent = parent;
      result.place.segment = place >> 4;
      result.place.share = double(place >> 1 & 7) / parts;
      result.is_reversed = (place & 1) != 0;
      result.cost = cost;
      return result;
    }
  };
  static constexpr int parts = 6; ///< of a segment, at whose ends joints are tried

  /// The axes that are connected to a root by their joints.
  class Joint_tree
  {
  public:
    explicit Joint_tree(const std::vector<Joint>& joints)
      : m_children(joints.size()), m_is_reached(joints.size(), 0)
    {
      for (Index a = 0; a < joints.size(); ++a)
        if (joints[a].parent != none)
          m_children[joints[a].parent].push_back(a);
    }

    bool is_reached(Index a) const { return m_is_reached[a] != 0; }
    /// Marks an axis and its descendants. Returns those that were not marked before.
    std::vector<Index> reach(Index from)
    {
      std::vector<Index> stack{from}, reached;
      while (!stack.empty()) {
        const Index a = stack.back();
        stack.pop_back();
        if (m_is_reached[a])
          continue;
        m_is_reached[a] = 1;
        reached.push_back(a);
        stack.insert(stack.end(), m_children[a].begin(), m_children[a].end());
      }
      return reached;
    }

  private:
    std::vector<std::vector<Index>> m_children;
    std::vector<std::uint8_t> m_is_reached;
  };

  /// Nodes of similar radii, so that only thick nodes need a large search radius.
  struct Level
  {
    double thickest = 0;
    std::size_t count = 0;
    std::vector<Vec3> points;
    std::vector<Node> nodes;
    std::unique_ptr<neighborhood::Nearest_neighbors> search;

    void reserve()
    {
      points.reserve(count);
      nodes.reserve(count);
    }
    void add(const Axis_node& node, Node place)
    {
      thickest = std::max(thickest, node.radius);
      points.push_back(node.point);
      nodes.push_back(place);
    }
  };
  Level& level_of(double radius)
  {
    const double doublings = std::log2(std::max(1.0, radius / m_spacing));
    return m_levels[std::min(m_levels.size() - 1, static_cast<std::size_t>(doublings))];
  }
  template <class F>
  void for_each_node(const F& f)
  {
    for (Index a = 0; a < m_set.axes.size(); ++a)
      for (Index k = 0; k < m_set.axes[a].axis.size(); ++k)
        f(level_of(m_set.axes[a].axis[k].radius), m_set.axes[a].axis[k], Node(a, k));
  }
  /// Returns the nodes whose surfaces are within `reach` and some slack, by axis, then by index.
  std::vector<Node> nodes_near(const Vec3& place, double reach) const;

  /// Returns the joint of least cost on axis `b` near the given nodes of this axis.
  Option best_place(const internal::Axis_end& end,
                    bool is_reversed,
                    Index b,
                    const std::vector<Index>& nodes,
                    double reach) const;
  /// Returns the cost of a joint, or infinity if it is not below `limit` or out of reach.
  double cost(const internal::Axis_end& end,
              Index b,
              const Axis_place& place,
              double reach,
              double limit) const;
  /// Returns a lower bound of the cost on a segment, from its distance and direction.
  double least_cost(const internal::Axis_end& end, const Axis& axis, Index segment) const
  {
    const Axis_node &a = axis[segment], &b = axis[segment + 1];
    const double length = (b.point - a.point).norm();
    const double distance =
        std::max(0.0, 0.5 * ((a.point - end.point).norm() + (b.point - end.point).norm() - length));
    const double gap = std::max(0.0, distance - std::max(a.radius, b.radius));
    return gap_cost(gap) + m_rules.tie * distance / m_spacing +
           angle_cost(end, internal::tangent(axis, segment));
  }
  double gap_cost(double gap) const
  {
    return m_rules.gap * gap / m_spacing * std::max(1.0, gap / (m_rules.steep_gap * m_spacing));
  }
  double angle_cost(const internal::Axis_end& end, const Vec3& tangent) const
  {
    return m_rules.angle * (1 - std::max(tangent.dot(end.inward), m_rules.lowest_cosine));
  }
  double radius_ratio(double r, double to) const
  {
    const double thinnest = m_rules.thinnest * m_spacing;
    return std::max(r, thinnest) / std::max(to, thinnest);
  }
  /// An end of an axis, and the cost of this end as the base.
  std::pair<internal::Axis_end, double> base_of(Index a, bool is_tip) const;
  /// Returns the cost of an axis that stands on the ground.
  double standing_cost(Index a, const std::array<double, 2>& heights, const Vec3& up) const;
  std::vector<Option> options_of(Index a) const;
  static void change_joints(const std::vector<std::vector<Option>>& options,
                            Joint_tree& tree,
                            std::vector<Joint>& joints);

  const Axis_set& m_set;
  double m_spacing;
  Joint_options m_rules;
  std::array<Level, 12> m_levels; // radii double between levels
};

inline double Axis_joiner::cost(const internal::Axis_end& end,
                                Index b,
                                const Axis_place& place,
                                double reach,
                                double limit) const
{
  const Axis& axis = m_set.axes[b].axis;
  const double u = m_spacing, radius = radius_at(axis, place);
  const Vec3 v = point_at(axis, place) - end.point;
  const double distance = v.norm(), gap = std::max(0.0, distance - radius);
  if (gap > reach)
    return std::numeric_limits<double>::infinity();
  const double back = -v.dot(end.inward); // > 0: the parent lies behind the base
  const double lateral = (v + back * end.inward).norm();
  const double missed = std::max(0.0, lateral - m_rules.lateral_tolerance * radius);
  double sum = gap_cost(gap);
  sum += m_rules.overlap * std::max(0.0, -back - radius) / u;
  sum += m_rules.tie * (lateral + distance) / u;
  sum += angle_cost(end, internal::tangent(axis, place.segment));
  if (!(sum < limit)) // computing logarithms dominates the time
    return std::numeric_limits<double>::infinity();
  const double share = radius_ratio(end.radius, radius) / m_rules.free_share;
  sum += m_rules.radius * std::log(std::max(1.0, share));
  sum += m_rules.lateral * std::log1p(missed / u);
  return sum;
}

inline Axis_joiner::Option Axis_joiner::best_place(const internal::Axis_end& end,
                                                   bool is_reversed,
                                                   Index b,
                                                   const std::vector<Index>& nodes,
                                                   double reach) const
{
  const Axis& axis = m_set.axes[b].axis;
  Option best(b, 0, 0, is_reversed, std::numeric_limits<double>::infinity());
  const auto try_segment = [&](Index s) {
    if (!(least_cost(end, axis, s) < best.cost))
      return;
    for (int k = 0; k <= parts; ++k) {
      Axis_place place;
      place.segment = s;
      place.share = double(k) / parts;
      const double c = cost(end, b, place, reach, best.cost);
      if (c < best.cost)
        best = Option(b, s, k, is_reversed, c);
    }
  };
  const auto try_node = [&](Index node, Index& previous) {
    for (const Index s : {node > 0 ? node - 1 : node, node})
      if (s + 1 < axis.size() && s != previous) {
        previous = s;
        try_segment(s);
      }
  };
  // a low cost at the nearest node excludes most other segments
  const Index nearest = *std::min_element(nodes.begin(), nodes.end(), [&](Index x, Index y) {
    return (axis[x].point - end.point).squaredNorm() < (axis[y].point - end.point).squaredNorm();
  });
  Index previous = none;
  try_node(nearest, previous);
  previous = none;
  for (const Index node : nodes)
    if (node != nearest)
      try_node(node, previous);
  return best;
}

inline std::vector<Axis_joiner::Node> Axis_joiner::nodes_near(const Vec3& place, double reach) const
{
  const double slack = 8 * m_spacing; // the nearest position lies between nodes
  std::vector<std::uint64_t> keys;    // of nodes, for faster sorting
  std::vector<Index> found;
  for (const Level& level : m_levels) {
    found.clear();
    level.search->append_within(place, reach + slack + level.thickest, found);
    for (const Index i : found) {
      const auto [axis, number] = level.nodes[i];
      const double gap = (level.points[i] - place).norm() - m_set.axes[axis].axis[number].radius;
      if (gap < reach + slack)
        keys.push_back(std::uint64_t(axis) << 32 | number);
    }
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Node> near;
  near.reserve(keys.size());
  for (const std::uint64_t key : keys)
    near.emplace_back(static_cast<Index>(key >> 32), static_cast<Index>(key & 0xffffffff));
  return near;
}

inline std::pair<internal::Axis_end, double> Axis_joiner::base_of(Index a, bool is_tip) const
{
  const Axis& axis = m_set.axes[a].axis;
  const double length = std::min(std::max(m_rules.base_length * m_spacing, 2 * axis.front().radius),
                                 0.7 * length_of(axis));
  const internal::Axis_end end = internal::end_of(axis, is_tip, length);
  const internal::Axis_end other = internal::end_of(axis, !is_tip, length);
  return {end,
          (is_tip ? m_rules.reversal * m_set.axes[a].direction : 0) -
              m_rules.taper * std::log(radius_ratio(end.radius, other.radius))};
}

inline double
Axis_joiner::standing_cost(Index a, const std::array<double, 2>& heights, const Vec3& up) const
{
  double least = std::numeric_limits<double>::infinity();
  for (const bool is_tip : {false, true}) {
    const double height = heights[is_tip ? 1 : 0];
    if (height > m_rules.reach * m_spacing)
      continue;
    const auto [end, cost_of_end] = base_of(a, is_tip);
    least = std::min(least,
                     gap_cost(height) + m_rules.tie * height / m_spacing + angle_cost(end, up) +
                         cost_of_end + m_rules.standing);
  }
  return least;
}

inline std::vector<Axis_joiner::Option> Axis_joiner::options_of(Index a) const
{
  std::vector<Option> options;
  std::vector<Index> nodes;
  const Axis& axis = m_set.axes[a].axis;
  const double reach = std::max(m_rules.reach * m_spacing, m_rules.long_reach * length_of(axis));
  for (const bool is_tip : {false, true}) {
    const auto [end, cost_of_end] = base_of(a, is_tip);
    const std::vector<Node> near = nodes_near(end.point, reach);
    for (std::size_t i = 0; i < near.size();) {
      const Index b = near[i].first;
      nodes.clear();
      for (; i < near.size() && near[i].first == b; ++i)
        nodes.push_back(near[i].second);
      if (b == a)
        continue;
      Option option = best_place(end, is_tip, b, nodes, reach);
      option.cost += cost_of_end;
      if (std::isfinite(option.cost))
        options.push_back(option);
    }
  }
  std::stable_sort(options.begin(), options.end(), [](const Option& x, const Option& y) {
    return x.cost < y.cost;
  });
  constexpr std::size_t enough = 400;
  const auto count = static_cast<std::ptrdiff_t>(std::min(enough, options.size()));
  return std::vector<Option>(options.begin(), options.begin() + count); // without spare memory
}

/*!
  Connects further axes with the tree. Every axis has its joint of least cost; those that are not
  reached form cycles, or descend from them. They are resolved axis by axis: the next axis is the
  one whose change to a reachable parent has the least additional cost. `options` are those of the
  axes that are not reached.
*/
inline void Axis_joiner::change_joints(const std::vector<std::vector<Option>>& options,
                                       Joint_tree& tree,
                                       std::vector<Joint>& joints)
{
  const Index n = static_cast<Index>(joints.size());
  std::vector<std::size_t> first(n + 1, 0); // in `users`
  for (const std::vector<Option>& of_axis : options)
    for (const Option& o : of_axis)
      ++first[o.parent];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Index> users(first[n]); // axes with an option on an axis
  for (Index a = 0; a < n; ++a)
    for (const Option& o : options[a])
      users[--first[o.parent]] = a;
  // additional cost of a change, axis, index of the option
  using Change = std::tuple<double, Index, Index>;
  std::priority_queue<Change, std::vector<Change>, std::greater<Change>> changes;
  std::vector<Index> best(n, none); // index of the best option that is among the changes
  const auto offer = [&](Index parent) {
    for (std::size_t u = first[parent]; u < first[parent + 1]; ++u) {
      const Index a = users[u];
      if (tree.is_reached(a))
        continue;
      // options are sorted: only those before the best so far are better
      const std::size_t end = std::min<std::size_t>(best[a], options[a].size());
      for (Index k = 0; k < end; ++k)
        if (options[a][k].parent == parent) {
          changes.emplace(options[a][k].cost - options[a].front().cost, a, k);
          best[a] = k;
          break;
        }
    }
  };
  for (Index a = 0; a < n; ++a)
    if (tree.is_reached(a))
      offer(a);
  while (!changes.empty()) {
    const auto [cost, a, k] = changes.top();
    changes.pop();
    if (tree.is_reached(a))
      continue;
    joints[a] = options[a][k].joint();
    for (const Index b : tree.reach(a))
      offer(b);
  }
  for (Index a = 0; a < n; ++a)
    if (!tree.is_reached(a))
      joints[a] = Joint();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_JOIN_AXES_H

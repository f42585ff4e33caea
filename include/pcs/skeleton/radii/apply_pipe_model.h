// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pipe model: bound on the total cross-section area of the branches beyond a section.

#ifndef PCS_SKELETON_RADII_APPLY_PIPE_MODEL_H
#define PCS_SKELETON_RADII_APPLY_PIPE_MODEL_H

#include <pcs/skeleton/model/Branch_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the pipe model, which is an upper bound.
struct Pipe_model_options
{
  double slack = 3;     ///< largest ratio of all areas beyond to the area; wood: 1 to 2 [-]
  double thicker = 1.2; ///< ratio to the parent above which confirmed branches are independent
  double proven =
      0.7; ///< least confirmed fraction of the area of a branch for any section to be confirmed [-]
  std::size_t bins = 128; ///< of the longest path from the root [count]
  int rounds = 6;
};

namespace internal {

class Pipe_model
{
public:
  Pipe_model(const std::vector<std::uint8_t>& is_proven,
             const Pipe_model_options& rules,
             Branch_tree& tree)
    : m_is_proven(is_proven), m_rules(rules), m_tree(tree)
  {
    const std::size_t n = tree.nodes.size();
    std::vector<double> way(n, 0);
    double longest = 0;
    for (std::size_t v = 1; v < n; ++v) {
      const Branch_node& node = tree.nodes[v];
      way[v] = way[node.parent] + (node.point - tree.nodes[node.parent].point).norm();
      longest = std::max(longest, way[v]);
    }
    m_bin.resize(n);
    for (std::size_t v = 0; v < n; ++v)
      m_bin[v] =
          longest > 0 ? static_cast<std::size_t>(way[v] / longest * double(rules.bins - 1)) : 0;
    m_children.resize(n);
    for (Index b = 1; b < tree.branches.size(); ++b)
      m_children[seat_of(b)].push_back(b);
    keep_proven();
    find_independent();
  }

  std::size_t run()
  {
    std::vector<std::uint8_t> is_limited(m_tree.nodes.size(), 0);
    for (int round = 0; round < m_rules.rounds; ++round)
      if (!limit(is_limited))
        break;
    return static_cast<std::size_t>(std::count(is_limited.begin(), is_limited.end(), 1));
  }

private:
  Index seat_of(Index b) const { return m_tree.nodes[m_tree.branches[b].nodes.front()].parent; }

  /// Keeps confirmed sections only in mostly confirmed branches: in leaves, single sections may be
  /// confirmed by chance.
  void keep_proven()
  {
    m_is_kept.assign(m_tree.nodes.size(), 0);
    for (const Branch& branch : m_tree.branches) {
      double all = 0, proven = 0;
      for (const Index v : branch.nodes) {
        const double area = m_tree.nodes[v].radius * m_tree.nodes[v].radius;
        all += area;
        proven += m_is_proven[v] ? area : 0;
      }
      if (proven >= m_rules.proven * all)
        for (const Index v : branch.nodes)
          m_is_kept[v] = m_is_proven[v];
    }
  }

  /// Finds branches that are confirmed to be thicker than their parent: their joints are wrong.
  void find_independent()
  {
    const std::size_t n = m_tree.branches.size();
    m_is_independent.assign(n, 0);
    m_is_independent[0] = 1;
    for (Index b = 1; b < n; ++b) {
      const double least = m_rules.thicker * m_tree.nodes[seat_of(b)].radius;
      double all = 0, thick = 0; // squared radii
      for (const Index v : m_tree.branches[b].nodes) {
        const double radius = m_tree.nodes[v].radius;
        all += radius * radius;
        if (m_is_proven[v] && radius > least)
          thick += radius * radius;
      }
      m_is_independent[b] = 2 * thick > all;
    }
  }

  /// The branches that pass a bin.
  struct Passing
  {
    double area = 0, count = 0; ///< sum of squared radii, number of branches
  };
  /// The upper bound of a bin.
  struct Limit
  {
    double factor = 1; ///< for the squared radii
    double share = 0;  ///< squared radius of equal branches, the lower bound of scaling
  };
  using Passings = std::vector<Passing>;                     // per bin
  using Limits = std::vector<Limit>;                         // per bin; empty: none
  using Node_limits = std::vector<std::pair<Index, Limits>>; // by node, from the tip

  /// Calls `visit(v, passings)` for the nodes of a branch from its tip to its base. `passings` sums
  /// up the branches above `v`.
  template <class Visit>
  Passings walk(Index b, const std::vector<Passings>& of_branch, const Visit& visit) const
  {
    Passings sums(m_rules.bins);
    const std::vector<Index>& nodes = m_tree.branches[b].nodes;
    for (std::size_t k = nodes.size(); k-- > 0;) {
      const Index v = nodes[k];
      for (const Index c : m_children[v])
        if (!m_is_independent[c])
          for (std::size_t i = m_bin[v]; i < m_rules.bins; ++i) {
            sums[i].area += of_branch[c][i].area;
            sums[i].count += of_branch[c][i].count;
          }
      visit(v, sums);
      // the edge towards the root counts for the bins that begin on it
      const std::size_t from = k > 0 ? m_bin[nodes[k - 1]] : m_bin[v];
      const double area = m_tree.nodes[v].radius * m_tree.nodes[v].radius;
      for (std::size_t i = from; i < m_bin[v]; ++i) {
        sums[i + 1].area += area;
        sums[i + 1].count += 1;
      }
    }
    return sums;
  }

  /// Limits radii once. Returns whether any radius has changed.
  bool limit(std::vector<std::uint8_t>& is_limited)
  {
    const std::size_t n = m_tree.branches.size();
    std::vector<Passings> of_branch(n);
    std::vector<Node_limits> limits(n);
    for (std::size_t b = n; b-- > 0;)
      limits[b] = find_limits(static_cast<Index>(b), of_branch);
    bool did_change = false;
    std::vector<Limits> at_seat(n);
    for (Index b = 0; b < n; ++b)
      did_change |= apply_limits(b, limits[b], at_seat, is_limited);
    return did_change;
  }

  /// Returns the limits by the nodes of a branch, from its tip. Sets the element of `of_branch` for
  /// this branch; those of its children are set already.
  Node_limits find_limits(Index b, std::vector<Passings>& of_branch) const
  {
    const std::vector<Index>& nodes = m_tree.branches[b].nodes;
    const std::vector<double> thickest = thickest_proven(nodes);
    Node_limits limits;
    std::size_t last = std::numeric_limits<std::size_t>::max();
    of_branch[b] = walk(b, of_branch, [&](Index v, const Passings& sums) {
      if (m_bin[v] == last)
        return;
      last = m_bin[v];
      double radius = thickest[last];
      if (last > m_bin[nodes.front()])
        radius = std::max(radius, thickest[last - 1]);
      if (last + 1 < m_rules.bins)
        radius = std::max(radius, thickest[last + 1]);
      Limits own = limits_beyond(last, radius, sums);
      if (!own.empty())
        limits.emplace_back(v, std::move(own));
    });
    return limits;
  }

  /// Returns the thickest confirmed radius of some nodes in each bin; 0: none.
  std::vector<double> thickest_proven(const std::vector<Index>& nodes) const
  {
    std::vector<double> thickest(m_rules.bins, 0);
    for (const Index v : nodes)
      if (m_is_proven[v])
        thickest[m_bin[v]] = std::max(thickest[m_bin[v]], m_tree.nodes[v].radius);
    return thickest;
  }

  /// Returns the limits of the bins beyond `bin` by a section of radius `radius` there.
  Limits limits_beyond(std::size_t bin, double radius, const Passings& sums) const
  {
    Limits limits;
    if (!(radius > 0))
      return limits;
    const double most = m_rules.slack * radius * radius;
    for (std::size_t i = bin + 1; i < m_rules.bins; ++i)
      if (sums[i].area > most) {
        limits.resize(m_rules.bins);
        limits[i] = {most / sums[i].area, most / sums[i].count};
      }
    return limits;
  }

  /// Limits the radii of a branch by the nodes towards the root, and passes the limits on to its
  /// children. Returns whether any radius has changed.
  bool apply_limits(Index b,
                    const Node_limits& of_nodes,
                    std::vector<Limits>& at_seat,
                    std::vector<std::uint8_t>& is_limited)
  {
    bool did_change = false;
    Limits present = m_is_independent[b] ? Limits() : std::move(at_seat[b]);
    std::size_t next = of_nodes.size();
    for (const Index v : m_tree.branches[b].nodes) {
      if (!m_is_kept[v] && !present.empty() && limit_radius(present[m_bin[v]], m_tree.nodes[v])) {
        is_limited[v] = 1;
        did_change = true;
      }
      if (next > 0 && of_nodes[next - 1].first == v)
        keep_smaller(of_nodes[--next].second, present);
      for (const Index c : m_children[v])
        at_seat[c] = present;
    }
    return did_change;
  }

  /// Reduces the radius of a node to a limit. Returns whether it has changed.
  static bool limit_radius(const Limit& limit, Branch_node& node)
  {
    const double area = node.radius * node.radius;
    if (!(limit.factor < 1 && area > 1.01 * limit.share))
      return false;
    node.radius = std::sqrt(std::max(limit.share, limit.factor * area));
    node.radius_error = std::max(node.radius_error, node.radius);
    node.is_measured = false;
    return true;
  }

  /// Replaces the limits of `present` by those with smaller factors.
  void keep_smaller(const Limits& limits, Limits& present) const
  {
    present.resize(m_rules.bins);
    for (std::size_t i = 0; i < present.size(); ++i)
      if (limits[i].factor < present[i].factor)
        present[i] = limits[i];
  }

  const std::vector<std::uint8_t>& m_is_proven;
  std::vector<std::uint8_t> m_is_kept; // exempt from limits
  const Pipe_model_options& m_rules;
  Branch_tree& m_tree;
  std::vector<std::size_t> m_bin;
  std::vector<std::vector<Index>> m_children; // child branches of a node
  std::vector<std::uint8_t> m_is_independent;
};

} // namespace internal

/*!
  Bounds the radii by the pipe model. Where leaves were classified as wood, the total area of all
  branches at one distance from the root is many times the area of the trunk; in wood, it is not.
  Scaled nodes count as inferred. Returns their number.

  Bins divide the path length from the root [L]. With the largest confirmed radius `R` [L] of a
  branch in the bin of its node `v` and both adjacent bins, the constraint for every bin `i` farther
  out is

      A_i(v) = sum_j r_j^2 <= slack R^2                                                    [L^2]

  over the edges that pass the beginning of the bin, of the `n_i` branches that `v` supports. If it
  is violated, the squares of the radii in that bin become `max(f r^2, slack R^2 / n_i)`, with
  `f = slack R^2 / A_i(v)` [-]: a branch keeps at least the area of each of `n_i` equal branches.
  The least `f` of all `v` towards the root applies. Confirmed sections of mostly confirmed branches
  keep their radii. Branches that are confirmed to be more than `thicker` times as thick as their
  parent are excluded from `A_i` of the parent and not scaled by it. Rounds are repeated until
  nothing changes, at most `rounds` times. Each round costs O((nodes + branches) * bins).
*/
inline std::size_t apply_pipe_model(const std::vector<std::uint8_t>& is_proven,
                                    const Pipe_model_options& rules,
                                    Branch_tree& tree)
{
  if (tree.nodes.size() < 2 || !(rules.slack > 0))
    return 0;
  return internal::Pipe_model(is_proven, rules, tree).run();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_APPLY_PIPE_MODEL_H

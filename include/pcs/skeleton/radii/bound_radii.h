// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Bounds of radii without point support by the nearest supported radius towards the root.

#ifndef PCS_SKELETON_RADII_BOUND_RADII_H
#define PCS_SKELETON_RADII_BOUND_RADII_H

#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/nearest_edge.h>
#include <pcs/skeleton/radii/apply_pipe_model.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for the point support of radii, and bounds for unsupported radii.
struct Support_options
{
  double depth = 0.3;          ///< least depth of inside points below the surface, in radii [-]
  double depth_noise = 2;      ///< least depth of inside points, in units of the noise [-]
  double filled = 0.2;         ///< fraction of inside points above which a section is filled [-]
  double branch_filled = 0.15; ///< the same for all sections from the base of the branch [-]
  std::size_t reach = 2;       ///< nodes included on both sides [count]
  double fewest = 12;          ///< least number of points of a supported section [count]
  double expected = 0.25;      ///< ... and relative to the expected number [-]
  double thicker = 1.5;        ///< largest ratio of a radius to the narrowest one below it, unless
                               ///< the points confirm the radius [-]
  double proof_expected = 0.5; ///< least number of surface points of a confirmed section, relative
                               ///< to the expected number [-]
  double proof_filled = 0.05;  ///< largest fraction of inside points of a confirmed section [-]
  double proof_error = 0.1;    ///< largest standard error of a confirmed radius, in radii [-]
  //! largest standard error, in radii, of a section that `expected` points confirm because a
  //! section below is as thick; one side may be occluded [-]
  double proof_precise = 0.03;
  double mostly = 0.7;     ///< confirmed fraction of its volume at which a branch is wood [-]
  double slack = 3;        ///< bound of a section without support, in allometric radii [-]
  double filled_slack = 1; ///< the same for a filled section [-]
  double foot = 8;         ///< length of the foot of a trunk, in radii [-]
  Pipe_model_options pipes;
  double thinnest = 0.16; ///< least bound, in spacings: a single row of points [-]
};

/// The numbers of points on and inside the section of each node.
struct Section_support
{
  std::vector<double> on, inside; ///< points near or outside the surface; inside it [count]

  explicit Section_support(const Branch_tree& tree)
    : on(tree.nodes.size(), 0), inside(tree.nodes.size(), 0)
  {
  }
};

/// Counts the points on and inside the surface of each node. O(points).
template <class ConcurrencyTag>
Section_support support_of_sections(const Scan& scan,
                                    const Branch_tree& tree,
                                    double noise,
                                    const Support_options& rules)
{
  const std::vector<Index> next = successors(tree);
  std::vector<std::uint8_t> is_inside(scan.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(
      scan.size(),
      [&](std::size_t i) {
        const Index v = tree.node_of_point[i];
        if (v == none)
          return;
        const auto [squared_distance, offset, radius] =
            nearest_edge(tree, next, v, scan.points[i], Base_edge::left_out);
        const double depth = std::max(rules.depth_noise * noise, rules.depth * radius);
        is_inside[i] = std::sqrt(squared_distance) < radius - depth;
      },
      4096);
  Section_support support(tree);
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (tree.node_of_point[i] != none)
      ++(is_inside[i] ? support.inside : support.on)[tree.node_of_point[i]];
  return support;
}

namespace internal {

/// The point support of the sections of one branch. A section is at least as long as it is thick.
struct Branch_support
{
  std::vector<double> on, inside, expected; ///< points of each section [count]
  std::vector<std::uint8_t> is_proven, is_precise;
  bool is_mostly_proven = false; ///< if so, confirmed sections are not leaves

  Branch_support(const Section_support& support,
                 const Branch& branch,
                 const Branch_tree& tree,
                 double density,
                 const Support_options& rules)
    : on(branch.nodes.size(), 0),
      inside(on),
      expected(on),
      is_proven(on.size(), 0),
      is_precise(on.size(), 0)
  {
    const std::size_t n = on.size();
    double all = 0, proven = 0; // sums of squared radii times lengths
    for (std::size_t k = 0; k < n; ++k) {
      const Branch_node& node = tree.nodes[branch.nodes[k]];
      const auto is_near = [&](std::size_t j) {
        return (tree.nodes[branch.nodes[j]].point - node.point).norm() <= node.radius;
      };
      std::size_t begin = k > rules.reach ? k - rules.reach : 0;
      std::size_t end = std::min(n, k + rules.reach + 1);
      while (begin > 0 && is_near(begin - 1))
        --begin;
      while (end < n && is_near(end))
        ++end;
      for (std::size_t j = begin; j < end; ++j) {
        const Index w = branch.nodes[j];
        on[k] += support.on[w];
        inside[k] += support.inside[w];
        expected[k] += 2 * pcs::internal::pi * tree.nodes[w].radius * density * length_at(tree, w);
      }
      const bool is_hollow = inside[k] <= rules.proof_filled * (on[k] + inside[k]);
      is_proven[k] = on[k] >= rules.proof_expected * expected[k] && is_hollow &&
                     node.radius_error <= rules.proof_error * node.radius;
      is_precise[k] = on[k] >= rules.expected * expected[k] && on[k] >= rules.fewest && is_hollow &&
                      node.radius_error <= rules.proof_precise * node.radius;
      const double volume = node.radius * node.radius * length_at(tree, branch.nodes[k]);
      all += volume;
      proven += is_proven[k] && node.is_measured && on[k] >= rules.fewest ? volume : 0;
    }
    is_mostly_proven = proven >= rules.mostly * all;
  }

private:
  static double length_at(const Branch_tree& tree, Index v)
  {
    return tree.is_base(v) ? 0
                           : (tree.nodes[v].point - tree.nodes[tree.nodes[v].parent].point).norm();
  }
};

/// The lowest part of the trunk, where single sections are unreliable.
struct Trunk_foot
{
  std::size_t size = 0; ///< number of its nodes; 0: not a trunk
  double radius = 0;    ///< median radius of its hollow sections, weighted by length [L]

  Trunk_foot(const Branch_tree& tree,
             const Branch& branch,
             const Branch_support& sections,
             const Support_options& rules)
  {
    if (branch.parent != none)
      return;
    const auto is_hollow = [&](std::size_t k) {
      const double all = sections.on[k] + sections.inside[k];
      return tree.nodes[branch.nodes[k]].is_measured && sections.inside[k] <= rules.filled * all;
    };
    double thickest = 0;
    for (std::size_t k = 0; k < branch.nodes.size(); ++k)
      if (is_hollow(k))
        thickest = std::max(thickest, tree.nodes[branch.nodes[k]].radius);
    std::vector<std::pair<double, double>> radii; // and lengths
    double length = 0, hollow = 0;
    for (; size < branch.nodes.size() && length <= rules.foot * thickest; ++size) {
      const Branch_node& node = tree.nodes[branch.nodes[size]];
      const double step = size > 0 ? (node.point - tree.nodes[node.parent].point).norm() : 0;
      length += step;
      if (!is_hollow(size))
        continue;
      radii.emplace_back(node.radius, step);
      hollow += step;
    }
    std::sort(radii.begin(), radii.end());
    double sum = 0;
    for (std::size_t k = 0; k < radii.size() && (k == 0 || sum < 0.5 * hollow); ++k) {
      radius = radii[k].first;
      sum += radii[k].second;
    }
  }

  /// Returns whether a node of the foot is much thinner than the others, which is implausible.
  bool is_odd(std::size_t k, double node_radius, const Support_options& rules) const
  {
    return k < size && rules.thicker * node_radius < radius;
  }
};

/// Returns the length of the longest path from each node to a tip.
inline std::vector<double> ways_to_tips(const Branch_tree& tree)
{
  std::vector<double> way(tree.nodes.size(), 0);
  for (std::size_t v = tree.nodes.size(); v-- > 1;) { // children come after their parents
    const Index p = tree.nodes[v].parent;
    way[p] = std::max(way[p], way[v] + (tree.nodes[v].point - tree.nodes[p].point).norm());
  }
  return way;
}

/// Bounds the radii of one branch after another, parents first.
class Radius_bounds
{
public:
  Radius_bounds(const Scan& scan,
                const Section_support& support,
                double density,
                const Support_options& rules,
                Branch_tree& tree)
    : m_scan(scan),
      m_support(support),
      m_density(density),
      m_rules(rules),
      m_tree(tree),
      m_way(ways_to_tips(tree)),
      m_reference(tree.nodes.size()),
      m_is_sure(tree.nodes.size(), 0)
  {
  }

  /// Returns the number of changed radii.
  std::size_t operator()()
  {
    std::size_t count = 0;
    for (const Branch& branch : m_tree.branches) {
      find_bounds(branch);
      count += apply_bounds(branch);
    }
    return count + apply_pipe_model(m_is_sure, m_rules.pipes, m_tree);
  }

private:
  /// Summary of the supported nodes between a node and the root.
  struct Reference
  {
    double radius = 0, way = 0; ///< of the nearest supported node [L]; 0: none
    double narrowest = 0;       ///< least supported radius up to the nearest confirmed node [L]
    double thickest = 0;        ///< largest of all supported radii [L]
  };
  /// The evidence for the radius of a node.
  struct Evidence
  {
    bool is_proven = false;    ///< the points confirm the radius, even if it is larger than below
    bool is_supported = false; ///< sufficient points support the radius
    bool is_leafy = false;     ///< points lie inside this section or inside sections below
  };

  /// Finds the bounds of a branch, the supported radii, and the references of its nodes.
  void find_bounds(const Branch& branch)
  {
    const Branch_support sections(m_support, branch, m_tree, m_density, m_rules);
    const Trunk_foot foot(m_tree, branch, sections, m_rules);
    double all_on = 0, all_inside = 0; // from the base to here
    const std::size_t n = branch.nodes.size();
    m_bounds.assign(n, std::numeric_limits<double>::infinity());
    m_supported.assign(n, 0);
    for (std::size_t k = 0; k < n; ++k) {
      const Index v = branch.nodes[k];
      const Branch_node& node = m_tree.nodes[v];
      all_on += m_support.on[v];
      all_inside += m_support.inside[v];
      const bool is_inside = all_inside > m_rules.branch_filled * (all_on + all_inside);
      const Reference below = node.parent == none ? Reference() : m_reference[node.parent];
      const Evidence evidence = judge(sections, k, node, below, is_inside);
      const bool is_odd = foot.is_odd(k, node.radius, m_rules);
      m_is_sure[v] = evidence.is_supported && evidence.is_proven && !is_odd;
      m_reference[v] = below;
      if (evidence.is_supported) {
        m_supported[k] = node.radius;
        m_reference[v] =
            reference_at(v, is_odd ? foot.radius : node.radius, evidence.is_proven, below);
      } else if (below.way > 0) {
        const double slack = evidence.is_leafy ? m_rules.filled_slack : m_rules.slack;
        m_bounds[k] = std::max(m_rules.thinnest * m_scan.spacing,
                               below.radius * std::min(1.0, slack * m_way[v] / below.way));
      }
    }
  }

  /// Returns the evidence for the radius of the `k`-th node of a branch. `is_inside` indicates
  /// whether the sections from the base to this one contain many inside points.
  Evidence judge(const Branch_support& sections,
                 std::size_t k,
                 const Branch_node& node,
                 const Reference& below,
                 bool is_inside) const
  {
    const double on = sections.on[k], inside = sections.inside[k];
    Evidence evidence;
    // a confirmed section may be thicker than its parent: the joint or the parent is wrong then
    evidence.is_proven = sections.is_proven[k] != 0 ||
                         (sections.is_precise[k] != 0 && node.radius <= below.thickest);
    const bool is_bush = is_inside && !(evidence.is_proven && sections.is_mostly_proven);
    const bool is_filled = inside > m_rules.filled * (on + inside);
    const bool is_too_thick =
        below.way > 0 && !evidence.is_proven && node.radius > m_rules.thicker * below.narrowest;
    evidence.is_leafy = is_filled || is_bush;
    evidence.is_supported = node.is_measured && !evidence.is_leafy && !is_too_thick &&
                            on >= m_rules.fewest && on >= m_rules.expected * sections.expected[k];
    return evidence;
  }

  /// Returns the reference of nodes beyond the supported node `v`.
  Reference reference_at(Index v, double radius, bool is_proven, const Reference& below) const
  {
    return {radius,
            m_way[v],
            is_proven || !(below.way > 0) ? radius : std::min(radius, below.narrowest),
            std::max(radius, below.thickest)};
  }

  /// Applies the bounds of a branch from its tip. Returns the number of changed radii.
  std::size_t apply_bounds(const Branch& branch)
  {
    std::size_t count = 0;
    double carried = 0; // largest supported radius farther out
    for (std::size_t k = branch.nodes.size(); k-- > 0;) {
      Branch_node& node = m_tree.nodes[branch.nodes[k]];
      carried = std::max(carried, m_supported[k]);
      const double bound = std::max(m_bounds[k], carried);
      if (node.radius <= bound)
        continue;
      node.radius = bound;
      node.radius_error = bound;
      node.is_measured = false;
      ++count;
    }
    return count;
  }

  const Scan& m_scan;
  const Section_support& m_support;
  double m_density;
  const Support_options& m_rules;
  Branch_tree& m_tree;
  std::vector<double> m_way;
  std::vector<Reference> m_reference;        ///< by node
  std::vector<std::uint8_t> m_is_sure;       ///< by node
  std::vector<double> m_bounds, m_supported; ///< of one branch [L]
};

} // namespace internal

/*!
  Bounds radii without sufficient point support. Scanners sample the surface of wood, not its
  interior: sections with many inside points are leaves, and sections with few points are
  unreliable. Bounded nodes count as inferred. Returns the number of changed radii.

  The section of a node of radius `r` [L] comprises adjacent edges of length `l` [L]. It has `n`
  points on its surface, `m` points inside [count], and, at the density `D` [1/L^2], the expected
  number `E = 2 pi D sum r l` of points on its surface. Factors are those of `Support_options`. A
  section is

  - filled if `m > filled (n + m)`, or if the fraction of inside points of all sections from the
    base of the branch to this one exceeds `branch_filled`;
  - confirmed if `n >= proof_expected E`, `m <= proof_filled (n + m)`, and the standard error of `r`
    is at most `proof_error r`;
  - supported if it is measured and not filled, `n >= max(fewest, expected E)`, and it is confirmed
    or `r <= thicker R`. `R` [L] is the least supported radius between this section and the nearest
    confirmed one towards the root.

  (`proof_precise`, `mostly` and `foot` define exceptions.) The bound of a section without support
  depends on the nearest supported section towards the root, of radius `r'` [L], and is not smaller
  than the radii `r''` [L] of the supported sections farther out on the branch:

      r <= max(r' min(1, c h / h'), thinnest u, max r''),

  with the lengths `h`, `h'` [L] of the longest paths from both nodes to a tip, the spacing `u` [L],
  and `c = slack`, or `filled_slack` if the section is filled. If no section towards the root is
  supported, there is no bound. `apply_pipe_model()` follows. O(nodes) without the pipe model.
*/
inline std::size_t bound_radii(const Scan& scan,
                               const Section_support& support,
                               double density,
                               const Support_options& rules,
                               Branch_tree& tree)
{
  if (tree.nodes.empty())
    return 0;
  return internal::Radius_bounds(scan, support, density, rules, tree)();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_BOUND_RADII_H

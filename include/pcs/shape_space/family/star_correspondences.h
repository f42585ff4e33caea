// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Point correspondences of many scans: transport from one sampling to each scan.

#ifndef PCS_SHAPE_SPACE_FAMILY_STAR_CORRESPONDENCES_H
#define PCS_SHAPE_SPACE_FAMILY_STAR_CORRESPONDENCES_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/shape_space/family/Family_points.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/points/point_correspondences.h>
#include <pcs/shape_space/points/surface_patches.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace shape_space {

/// Returns the positions of a scan in the coordinates of the family. [L]
inline std::vector<Vec3> points_in_family(const Tree_family& family, const Tree_input& input)
{
  const Vec3 shift = input.tree.origin - family.origin;
  std::vector<Vec3> result;
  result.reserve(input.points.size());
  for (const Vec3& p : input.points)
    result.push_back(p + shift);
  return result;
}

namespace internal {

/// Transports the common sampling of all trees to one scan after another.
template <class ConcurrencyTag>
class Star_correspondences
{
public:
  Star_correspondences(const Tree_family& family,
                       const std::vector<Tree_input>& inputs,
                       const std::vector<std::vector<std::size_t>>& edge,
                       const std::vector<Family_source>& sources)
    : m_family(family),
      m_layout(family.layout),
      m_inputs(inputs),
      m_edge(edge),
      m_sources(sources),
      m_geometry(inputs.size()),
      m_found(inputs.size())
  {
    for (std::size_t t = 0; t < inputs.size(); ++t) {
      build_geometry(m_layout, family.x[t], family.orientation, m_geometry[t]);
      m_points.push_back(points_in_family(family, inputs[t]));
    }
    m_branch_of.resize(m_layout.number_of_edges());
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b)
      for (std::size_t j = 0; j < m_layout.branches[b].number_of_edges; ++j)
        m_branch_of[m_layout.branches[b].first_edge + j] = b;
    compose_source_tree();
    m_is_relative = edges_with_radius(m_layout, m_geometry, [&](std::size_t t, std::size_t b) {
      return family.has[t][b] != 0;
    });
  }

  /// Finds the corresponding points in all scans. `is_stopped(done)` is called repeatedly.
  template <class IsStopped>
  void
  run(const Transport_options& options, Transport_summary& summary, const IsStopped& is_stopped)
  {
    const auto n = static_cast<double>(m_inputs.size());
    double violation = 0, remaining = 0;
    for (std::size_t t = 0; t < m_inputs.size(); ++t) {
      Transport_summary own;
      match_scan(t, options, own, [&](double f) {
        return is_stopped((static_cast<double>(t) + f) / n);
      });
      summary.number_of_windows += own.number_of_windows;
      summary.number_of_failures += own.number_of_failures;
      summary.worst_violation = std::max(summary.worst_violation, own.worst_violation);
      violation += own.mean_violation * static_cast<double>(own.number_of_windows);
      remaining += own.mean_remaining * static_cast<double>(own.number_of_windows);
    }
    if (summary.number_of_windows > 0) {
      summary.mean_violation = violation / static_cast<double>(summary.number_of_windows);
      summary.mean_remaining = remaining / static_cast<double>(summary.number_of_windows);
    }
  }

  /// Returns the corresponding points, sorted by point of the sampling, then by tree.
  std::vector<Orl_space_data::Partner> result() const
  {
    std::vector<Orl_space_data::Partner> result;
    for (std::size_t k = 0; k < m_sources.size(); ++k)
      for (std::size_t t = 0; t < m_inputs.size(); ++t)
        if (const std::uint32_t i = m_found[t][k]; i != no_point) {
          Orl_space_data::Partner p;
          p.point = static_cast<std::uint32_t>(k);
          p.tree = static_cast<std::uint32_t>(t);
          p.index = i;
          p.position = to_array(m_points[t][i]);
          if (m_inputs[t].normals.size() == m_inputs[t].points.size())
            p.normal = to_array(m_inputs[t].normals[i]);
          result.push_back(p);
        }
    return result;
  }

private:
  /// Composes a tree of branches, each from the tree whose points form the sampling there.
  void compose_source_tree()
  {
    m_source_tree.assign(m_layout.branches.size(), none);
    m_both[0] = m_geometry[0];
    for (const Family_source& s : m_sources) {
      m_source_tree[m_branch_of[s.edge]] = s.tree;
      m_positions[0].push_back(m_points[s.tree][s.point]);
    }
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b)
      if (m_source_tree[b] != none) {
        const Orl_geometry& own = m_geometry[m_source_tree[b]];
        const std::size_t first = m_layout.branches[b].first_edge, v = m_layout.first_node(b);
        for (std::size_t j = 0; j <= m_layout.branches[b].number_of_edges; ++j) {
          m_both[0].node[v + j] = own.node[v + j];
          m_both[0].radius[v + j] = own.radius[v + j];
          if (j < m_layout.branches[b].number_of_edges)
            m_both[0].frame[first + j] = own.frame[first + j];
        }
      }
  }

  /// Returns the edges of the points of the sampling and of scan `t`: `none` on branches that tree
  /// `t` lacks, and on branches where the sampling is from scan `t`.
  std::array<std::vector<std::size_t>, 2> edges_to_match(std::size_t t) const
  {
    std::array<std::vector<std::size_t>, 2> edges;
    for (const Family_source& s : m_sources) {
      const std::size_t b = m_branch_of[s.edge];
      edges[0].push_back(m_family.has[t][b] && m_source_tree[b] != t ? s.edge : none);
    }
    for (const std::size_t e : m_edge[t])
      edges[1].push_back(e != none && m_source_tree[m_branch_of[e]] != t ? e : none);
    return edges;
  }

  template <class IsStopped>
  void match_scan(std::size_t t,
                  const Transport_options& options,
                  Transport_summary& summary,
                  const IsStopped& is_stopped)
  {
    m_both[1] = m_geometry[t];
    m_positions[1] = m_points[t];
    const std::array<std::vector<std::size_t>, 2> edges = edges_to_match(t);
    const std::vector<Point_pair> pairs =
        Point_matching<ConcurrencyTag>(m_layout, m_both, m_positions, edges, m_is_relative)
            .run(options, summary, is_stopped);
    m_found[t].assign(m_sources.size(), no_point);
    for (const Point_pair& p : pairs)
      if (p.point[0] != no_point && p.point[1] != no_point && m_found[t][p.point[0]] == no_point)
        m_found[t][p.point[0]] = p.point[1];
  }

  const Tree_family& m_family;
  const Orl_layout& m_layout;
  const std::vector<Tree_input>& m_inputs;
  const std::vector<std::vector<std::size_t>>& m_edge;
  const std::vector<Family_source>& m_sources;
  std::vector<Orl_geometry> m_geometry;
  std::vector<std::vector<Vec3>> m_points;
  std::vector<std::size_t> m_branch_of, m_source_tree; // of edges; tree that gives its points
  std::array<Orl_geometry, 2> m_both;                  // of the sampling, and of one scan
  std::array<std::vector<Vec3>, 2> m_positions;        // of both
  std::vector<char> m_is_relative;
  std::vector<std::vector<std::uint32_t>> m_found; // per scan and point of the sampling
};

} // namespace internal

/*!
  Finds the corresponding points in other scans for each point of the common sampling, by tree. For
  each branch, the sampling consists of the points of one scan; it is transported to each other scan
  that has points there, branch by branch as between two trees. `edge[t][i]` as for
  `choose_points()`. `is_stopped(done)` is called repeatedly; the result is invalid if it returns
  `true`.
*/
template <class ConcurrencyTag, class IsStopped>
std::vector<Orl_space_data::Partner>
find_partners(const Tree_family& family,
              const std::vector<Tree_input>& inputs,
              const std::vector<std::vector<std::size_t>>& edge,
              const std::vector<Family_source>& sources,
              const Transport_options& options,
              Transport_summary& summary,
              const IsStopped& is_stopped)
{
  internal::Star_correspondences<ConcurrencyTag> star(family, inputs, edge, sources);
  star.run(options, summary, is_stopped);
  return star.result();
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_STAR_CORRESPONDENCES_H

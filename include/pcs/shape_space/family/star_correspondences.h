// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Point correspondences of many scans: transport from one sampling to each scan.

#ifndef PCS_SHAPE_SPACE_FAMILY_STAR_CORRESPONDENCES_H
#define PCS_SHAPE_SPACE_FAMILY_STAR_CORRESPONDENCES_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/shape_space/family/Family_points.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/points/point_correspondences.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace shape_space {

/// Positions of a scan in the coordinates of the family.
inline std::vector<Vec3> points_in_family(const Tree_family& family, const Tree_input& input)
{
  const Vec3 shift = input.tree.origin - family.origin;
  std::vector<Vec3> result;
  result.reserve(input.points.size());
  for (const Vec3& p : input.points)
    result.push_back(p + shift);
  return result;
}

/*!
  The sampling that all trees share has, of each branch, the points of one scan. It is transported
  to each other scan that has points there, branch by branch as between two trees. Partners of each
  point, by tree; `edge[t][i]` as for `choose_points()`. `is_stopped(done)` is asked now and then;
  the result means nothing if it says so.
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
  const Orl_layout& layout = family.layout;
  const std::size_t n = inputs.size(), m = layout.branches.size();
  std::vector<Orl_geometry> geometry(n);
  std::vector<std::vector<Vec3>> points;
  for (std::size_t t = 0; t < n; ++t) {
    build_geometry(layout, family.x[t], family.orientation, geometry[t]);
    points.push_back(points_in_family(family, inputs[t]));
  }
  std::vector<std::size_t> branch_of(layout.number_of_edges());
  for (std::size_t b = 0; b < m; ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
      branch_of[layout.branches[b].first_edge + j] = b;
  // a tree of branches of all trees: those whose points are taken
  std::vector<std::size_t> carrier(m, none);
  std::array<Orl_geometry, 2> both;
  both[0] = geometry[0];
  std::array<std::vector<Vec3>, 2> places;
  for (const Family_source& s : sources) {
    carrier[branch_of[s.edge]] = s.tree;
    places[0].push_back(points[s.tree][s.point]);
  }
  for (std::size_t b = 0; b < m; ++b)
    if (carrier[b] != none) {
      const Orl_geometry& own = geometry[carrier[b]];
      const std::size_t first = layout.branches[b].first_edge, v = layout.first_node(b);
      for (std::size_t j = 0; j <= layout.branches[b].number_of_edges; ++j) {
        both[0].node[v + j] = own.node[v + j];
        both[0].radius[v + j] = own.radius[v + j];
        if (j < layout.branches[b].number_of_edges)
          both[0].frame[first + j] = own.frame[first + j];
      }
    }
  const std::vector<char> is_relative =
      edges_with_radius(layout, geometry, [&](std::size_t t, std::size_t b) {
        return family.has[t][b] != 0;
      });
  std::vector<std::vector<std::uint32_t>> partner(n);
  double violation = 0, remaining = 0;
  for (std::size_t t = 0; t < n; ++t) {
    both[1] = geometry[t];
    places[1] = points[t];
    std::array<std::vector<std::size_t>, 2> edges;
    for (const Family_source& s : sources) {
      const std::size_t b = branch_of[s.edge];
      edges[0].push_back(family.has[t][b] && carrier[b] != t ? s.edge : none);
    }
    for (const std::size_t e : edge[t])
      edges[1].push_back(e != none && carrier[branch_of[e]] != t ? e : none);
    Transport_summary own;
    const auto pairs =
        Point_matching<ConcurrencyTag>(layout, both, places, edges, is_relative)
            .run(options, own, [&](double f) {
              return is_stopped((static_cast<double>(t) + f) / static_cast<double>(n));
            });
    partner[t].assign(sources.size(), no_point);
    for (const Point_pair& p : pairs)
      if (p.point[0] != no_point && p.point[1] != no_point && partner[t][p.point[0]] == no_point)
        partner[t][p.point[0]] = p.point[1];
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
  std::vector<Orl_space_data::Partner> result;
  for (std::size_t k = 0; k < sources.size(); ++k)
    for (std::size_t t = 0; t < n; ++t)
      if (const std::uint32_t i = partner[t][k]; i != no_point) {
        Orl_space_data::Partner p;
        p.point = static_cast<std::uint32_t>(k);
        p.tree = static_cast<std::uint32_t>(t);
        p.index = i;
        p.position = internal::to_array(points[t][i]);
        if (inputs[t].normals.size() == inputs[t].points.size())
          p.normal = internal::to_array(inputs[t].normals[i]);
        result.push_back(p);
      }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_STAR_CORRESPONDENCES_H

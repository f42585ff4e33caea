// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Point correspondences of two trees by transport along corresponding edges.

#ifndef PCS_SHAPE_SPACE_POINTS_POINT_CORRESPONDENCES_H
#define PCS_SHAPE_SPACE_POINTS_POINT_CORRESPONDENCES_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/points/flat_sections.h>
#include <pcs/shape_space/points/match_points.h>
#include <pcs/shape_space/points/tube_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Matches the points of both trees on the edges of the common topology.
template <class ConcurrencyTag>
class Point_matching
{
public:
  /// `edge[t][i]`: edge of point i of tree t. `geometry[t]`: of tree t.
  Point_matching(const Orl_layout& layout,
                 const std::array<Orl_geometry, 2>& geometry,
                 const std::array<std::vector<Vec3>, 2>& points,
                 const std::array<std::vector<std::size_t>, 2>& edge,
                 const std::vector<char>& is_relative)
    : m_layout(layout), m_geometry(geometry), m_points(points), m_is_relative(is_relative)
  {
    for (std::size_t t = 0; t < 2; ++t) {
      m_of_edge[t].resize(layout.number_of_edges());
      for (std::size_t i = 0; i < points[t].size(); ++i)
        if (edge[t][i] != none)
          m_of_edge[t][edge[t][i]].push_back(static_cast<std::uint32_t>(i));
    }
    m_branch_of.resize(layout.number_of_edges());
    for (std::size_t b = 0; b < layout.branches.size(); ++b)
      for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
        m_branch_of[layout.branches[b].first_edge + j] = b;
  }

  /// Finds pairs, sorted by edge. A window is a set of points of adjacent edges of a branch,
  /// matched as one transport problem. `is_stopped(done)` is called before batches of windows with
  /// the fraction of windows done; the result is empty if it returns `true`.
  template <class IsStopped>
  std::vector<Point_pair>
  run(const Transport_options& options, Transport_summary& summary, const IsStopped& is_stopped)
  {
    find_sections();
    const std::vector<Window> windows = make_windows(options);
    std::vector<std::vector<Point_pair>> pairs(windows.size());
    std::vector<Window_statistics> statistics(windows.size());
    constexpr std::size_t batch = 256;
    for (std::size_t begin = 0; begin < windows.size(); begin += batch) {
      if (is_stopped(static_cast<double>(begin) / static_cast<double>(windows.size())))
        return {};
      pcs::internal::for_each_index<ConcurrencyTag>(
          std::min(batch, windows.size() - begin),
          [&](std::size_t k) {
            const std::size_t w = begin + k;
            statistics[w] = match_window(windows[w], options, pairs[w]);
          },
          1);
    }
    std::vector<Point_pair> all;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      all.insert(all.end(), pairs[w].begin(), pairs[w].end());
      if (windows[w].point[0].empty() || windows[w].point[1].empty())
        continue;
      ++summary.number_of_windows;
      summary.number_of_failures += statistics[w].is_complete ? 0 : 1;
      summary.worst_violation = std::max(summary.worst_violation, statistics[w].violation);
      summary.mean_violation += statistics[w].violation;
      summary.mean_remaining += statistics[w].remaining;
    }
    if (summary.number_of_windows > 0) {
      summary.mean_violation /= static_cast<double>(summary.number_of_windows);
      summary.mean_remaining /= static_cast<double>(summary.number_of_windows);
    }
    std::stable_sort(all.begin(), all.end(), [](const Point_pair& a, const Point_pair& b) {
      return a.edge < b.edge;
    });
    return all;
  }

private:
  struct Placed
  {
    std::uint32_t point, edge;
  };
  struct Window
  {
    std::array<std::vector<Placed>, 2> point;
  };
  struct Window_statistics
  {
    double violation = 0, remaining = 0;
    bool is_complete = true;
  };

  /// Computes the sections of all edges without known radii.
  void find_sections()
  {
    m_section.assign(m_branch_of.size(), {});
    pcs::internal::for_each_index<ConcurrencyTag>(m_section.size(), [&](std::size_t e) {
      for (std::size_t t = 0; t < 2 && !m_is_relative[e] && !m_of_edge[1 - t][e].empty(); ++t) {
        std::vector<Vec3> points;
        for (const std::uint32_t i : m_of_edge[t][e])
          points.push_back(m_points[t][i]);
        if (!points.empty())
          m_section[e][t] =
              section_across(edge_cone(m_layout, m_geometry[t], m_branch_of[e], e), points);
      }
    });
  }

  std::vector<Window> make_windows(const Transport_options& options) const
  {
    std::vector<Window> windows;
    Window open;
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      std::size_t last = none; // last closed window of this branch
      const auto close = [&] {
        const std::size_t n = open.point[0].size(), m = open.point[1].size();
        if (n + m == 0)
          return;
        const bool is_small = std::min(n, m) < options.least_window;
        if (is_small && last != none &&
            windows[last].point[0].size() + n <= options.largest_window &&
            windows[last].point[1].size() + m <= options.largest_window)
          for (std::size_t t = 0; t < 2; ++t)
            windows[last].point[t].insert(windows[last].point[t].end(),
                                          open.point[t].begin(),
                                          open.point[t].end());
        else {
          last = windows.size();
          windows.push_back(open);
        }
        open = Window();
      };
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        const std::size_t n = m_of_edge[0][e].size(), m = m_of_edge[1][e].size();
        const bool is_too_large =
            std::max(open.point[0].size() + n, open.point[1].size() + m) > options.largest_window;
        if (is_too_large)
          close();
        if (std::max(n, m) > options.largest_window && std::min(n, m) > 0) {
          for (Window& w : cut(e, options))
            windows.push_back(std::move(w));
          last = none;
          continue;
        }
        for (std::size_t t = 0; t < 2; ++t)
          for (const std::uint32_t i : m_of_edge[t][e])
            open.point[t].push_back({i, static_cast<std::uint32_t>(e)});
        if (std::min(open.point[0].size(), open.point[1].size()) >= options.least_window)
          close();
      }
      close();
    }
    return windows;
  }

  /// Cuts an edge with many points into windows along its axis, each with about the same fraction
  /// of the points of both trees. Points at equal heights stay together.
  std::vector<Window> cut(std::size_t e, const Transport_options& options) const
  {
    struct Height
    {
      double t;
      std::uint32_t tree, point;
    };
    std::vector<Height> heights;
    for (std::uint32_t t = 0; t < 2; ++t) {
      const Edge_cone edge = edge_cone(m_layout, m_geometry[t], m_branch_of[e], e);
      for (const std::uint32_t i : m_of_edge[t][e]) {
        const Vec3 q = edge.frame.transpose() * (m_points[t][i] - edge.from);
        heights.push_back({q.z() / edge.length, t, i});
      }
    }
    std::sort(heights.begin(), heights.end(), [](const Height& a, const Height& b) {
      return a.t != b.t ? a.t < b.t : a.tree != b.tree ? a.tree < b.tree : a.point < b.point;
    });
    std::vector<Window> windows(1);
    const double fraction[2] = {1 / static_cast<double>(m_of_edge[0][e].size()),
                                1 / static_cast<double>(m_of_edge[1][e].size())};
    const std::size_t most = std::max(m_of_edge[0][e].size(), m_of_edge[1][e].size());
    const double parts =
        std::ceil(static_cast<double>(most) / static_cast<double>(options.largest_window));
    double mass = 0, last_t = 0;
    for (const Height& p : heights) {
      const Window& open = windows.back();
      const std::size_t n = open.point[0].size(), m = open.point[1].size();
      // where one tree has no points, points of the other tree must not be matched far away
      const bool is_full = std::max(n, m) >= 2 * options.largest_window;
      const bool has_fraction =
          mass >= 2 * static_cast<double>(windows.size()) / parts && std::min(n, m) > 0;
      if (p.t != last_t && (is_full || has_fraction))
        windows.emplace_back();
      windows.back().point[p.tree].push_back({p.point, static_cast<std::uint32_t>(e)});
      mass += fraction[p.tree];
      last_t = p.t;
    }
    Window& last = windows.back();
    if (windows.size() > 1 && (last.point[0].empty() || last.point[1].empty())) {
      Window& before = windows[windows.size() - 2];
      const auto number = [&](std::size_t t) {
        return before.point[t].size() + last.point[t].size();
      };
      if (std::max(number(0), number(1)) > 2 * options.largest_window)
        return windows;
      for (std::size_t t = 0; t < 2; ++t)
        before.point[t].insert(before.point[t].end(), last.point[t].begin(), last.point[t].end());
      windows.pop_back();
    }
    return windows;
  }

  Window_statistics match_window(const Window& window,
                                 const Transport_options& options,
                                 std::vector<Point_pair>& pairs) const
  {
    for (std::size_t t = 0; t < 2; ++t)
      if (window.point[1 - t].empty()) {
        for (const Placed& p : window.point[t]) {
          Point_pair pair{p.edge, {no_point, no_point}};
          pair.point[t] = p.point;
          pairs.push_back(pair);
        }
        return {};
      }
    // points of the first tree are mapped to the second by their edges: rotated, stretched along
    // and across, and moved; points of flat edges, such as leaf blades, also within their sections
    std::vector<Vec3> one, two;
    for (const Placed& p : window.point[0]) {
      const std::size_t b = m_branch_of[p.edge];
      const bool is_relative = m_is_relative[p.edge];
      Tube_coordinates c = tube_coordinates(edge_cone(m_layout, m_geometry[0], b, p.edge),
                                            m_points[0][p.point],
                                            is_relative);
      const auto& [from, to] = m_section[p.edge];
      if (from.is_flat() && to.is_flat()) {
        const Eigen::Vector2d position =
            carried_across(from,
                           to,
                           c.distance * Eigen::Vector2d(std::cos(c.angle), std::sin(c.angle)));
        c.angle = std::atan2(position.y(), position.x());
        c.distance = position.norm();
      }
      one.push_back(point_of(edge_cone(m_layout, m_geometry[1], b, p.edge), c, is_relative));
    }
    for (const Placed& p : window.point[1])
      two.push_back(m_points[1][p.point]);
    const Point_matches found = match_points(one, two, options);
    for (const auto& [i, j] : found.pairs)
      pairs.push_back(
          {window.point[0][i].edge, {window.point[0][i].point, window.point[1][j].point}});
    return {found.violation, found.remaining, found.is_complete};
  }

  const Orl_layout& m_layout;
  const std::array<Orl_geometry, 2>& m_geometry;
  const std::array<std::vector<Vec3>, 2>& m_points;
  const std::vector<char>& m_is_relative;
  std::array<std::vector<std::vector<std::uint32_t>>, 2> m_of_edge;
  std::vector<std::size_t> m_branch_of;
  std::vector<std::array<Section, 2>> m_section; // per edge
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_POINT_CORRESPONDENCES_H

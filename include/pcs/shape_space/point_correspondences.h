// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Which point of one tree becomes which of another: transport along corresponding edges.

#ifndef PCS_SHAPE_SPACE_POINT_CORRESPONDENCES_H
#define PCS_SHAPE_SPACE_POINT_CORRESPONDENCES_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/Orl_coordinates.h>
#include <pcs/shape_space/Sinkhorn.h>
#include <pcs/shape_space/Transport_simplex.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

constexpr std::uint32_t no_point = Orl_correspondences::no_point;

/// A point of tree 1 and one of tree 2, on an edge. One of them may be missing.
using Point_pair = Orl_correspondences::Pair;

/// An edge as a cone around the z axis of a frame.
struct Edge_cone
{
  Vec3 from;
  Eigen::Matrix3d frame;
  double length, from_radius, to_radius;

  double radius(double t) const { return (1 - t) * from_radius + t * to_radius; }
};

inline Edge_cone edge_cone(const Orl_layout& layout,
                           const Orl_geometry& geometry,
                           std::size_t branch,
                           std::size_t edge)
{
  const std::size_t node = layout.first_node(branch) + edge - layout.branches[branch].first_edge;
  return {geometry.node[node],
          geometry.frame[edge].toRotationMatrix(),
          (geometry.node[node + 1] - geometry.node[node]).norm(),
          geometry.radius[node],
          geometry.radius[node + 1]};
}

/// A point relative to an edge: the share of the edge, how far it lies before or behind it, angle and distance from the
/// axis. Lengths off the axis are shares of the radius if `is_relative`, so that detail grows with the branch.
struct Tube_coordinates
{
  double t, overshoot, angle, distance;
};

inline Tube_coordinates tube_coordinates(const Edge_cone& edge, const Vec3& p, bool is_relative)
{
  const Vec3 q = edge.frame.transpose() * (p - edge.from);
  const double t = edge.length > 0 ? std::min(1.0, std::max(0.0, q.z() / edge.length)) : 0;
  const double unit = is_relative ? edge.radius(t) : 1;
  return {t, (q.z() - t * edge.length) / unit, std::atan2(q.y(), q.x()), q.head<2>().norm() / unit};
}

inline Vec3 point_of(const Edge_cone& edge, const Tube_coordinates& c, bool is_relative)
{
  const double unit = is_relative ? edge.radius(c.t) : 1;
  const Vec3 q(unit * c.distance * std::cos(c.angle),
               unit * c.distance * std::sin(c.angle),
               c.t * edge.length + unit * c.overshoot);
  return edge.from + edge.frame * q;
}

enum class Point_transport {
  exact,   ///< network simplex
  sinkhorn ///< regularised, as in the text
};

enum class Point_weights {
  area, ///< a point stands for the surface around it
  equal ///< all points alike, as in the text
};

struct Transport_options
{
  Point_transport method = Point_transport::exact;
  Point_weights weights = Point_weights::area;
  bool is_squared =
      true; ///< cost is the squared distance, as a 2-Wasserstein distance wants; the text's is not
  std::size_t number_of_neighbors = 16; ///< candidates of each point in the other tree
  std::size_t largest_window = 1000;    ///< points of a tree that are transported together
  std::size_t least_window = 24;        ///< edges are joined until both trees have as many points
  Sinkhorn_options sinkhorn;
};

struct Transport_summary
{
  std::size_t number_of_windows = 0;
  std::size_t number_of_failures = 0; ///< windows whose method did not come to its end
  double worst_violation = 0;         ///< of the marginals of a window, whose mass is 1 [-]
  double mean_violation = 0;          ///< over windows
};

namespace internal {

/// Squared distance to the fifth neighbour, within limits: the surface that a point stands for, up to a factor.
inline std::vector<double> area_weights(const std::vector<Vec3>& points,
                                        const neighborhood::Nearest_neighbors& search)
{
  constexpr std::size_t neighbor = 5;
  std::vector<double> area(points.size(), 1);
  std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    search(points[i], neighbor + 1, found);
    area[i] = found.back().squared_distance;
  }
  std::vector<double> sorted(area);
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = *middle;
  for (double& a : area) // duplicates stand for little, outliers not for all
    a = median > 0 ? std::min(16 * median, std::max(median / 64, a)) : 1;
  return area;
}

inline std::vector<double> to_shares(std::vector<double> weights)
{
  double sum = 0;
  for (const double w : weights)
    sum += w;
  for (double& w : weights)
    w /= sum;
  return weights;
}

} // namespace internal

/// The arcs that carry most of what leaves a source or reaches a target: every point keeps a partner, and few have two.
inline std::vector<std::uint32_t> main_arcs(const Transport_problem& problem,
                                            const Transport_plan& plan)
{
  const std::size_t n = problem.supplies.size();
  std::vector<std::size_t> best(n + problem.demands.size(), none); // index in flows
  for (std::size_t k = 0; k < plan.flows.size(); ++k) {
    const Transport_problem::Arc& a = problem.arcs[plan.flows[k].arc];
    for (const std::size_t v : {std::size_t(a.source), n + a.target})
      if (best[v] == none || plan.flows[k].mass > plan.flows[best[v]].mass)
        best[v] = k;
  }
  std::sort(best.begin(), best.end());
  best.erase(std::unique(best.begin(), best.end()), best.end());
  std::vector<std::uint32_t> arcs;
  for (const std::size_t k : best)
    if (k != none)
      arcs.push_back(plan.flows[k].arc);
  return arcs;
}

/// Transport between two sets in the same place; every point gets a partner. Candidates are nearest neighbours both ways;
/// for points whose mass they cannot carry more are taken, until all is carried.
inline Transport_plan match_points(const std::vector<Vec3>& one,
                                   const std::vector<Vec3>& two,
                                   const Transport_options& options,
                                   Transport_problem& problem)
{
  const neighborhood::Nearest_neighbors search_1(one), search_2(two);
  const bool is_area = options.weights == Point_weights::area;
  problem.supplies = internal::to_shares(is_area ? internal::area_weights(one, search_1)
                                                 : std::vector<double>(one.size(), 1));
  problem.demands = internal::to_shares(is_area ? internal::area_weights(two, search_2)
                                                : std::vector<double>(two.size(), 1));
  const std::size_t n = one.size(), m = two.size();
  std::vector<std::size_t> wanted(n + m, options.number_of_neighbors);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> arcs;
  std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  Transport_plan plan;
  for (;;) {
    arcs.clear();
    for (std::size_t i = 0; i < n; ++i) {
      search_2(one[i], wanted[i], found);
      for (const auto& f : found)
        arcs.emplace_back(static_cast<std::uint32_t>(i), f.index);
    }
    for (std::size_t j = 0; j < m; ++j) {
      search_1(two[j], wanted[n + j], found);
      for (const auto& f : found)
        arcs.emplace_back(f.index, static_cast<std::uint32_t>(j));
    }
    std::sort(arcs.begin(), arcs.end());
    arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
    problem.arcs.clear();
    for (const auto& [i, j] : arcs)
      problem.arcs.push_back(
          {i, j, options.is_squared ? (one[i] - two[j]).squaredNorm() : (one[i] - two[j]).norm()});
    if (options.method == Point_transport::sinkhorn)
      return sinkhorn(problem, options.sinkhorn);
    plan = Transport_simplex()(problem);
    bool can_grow = false;
    for (std::size_t v = 0; v < n + m; ++v)
      if (plan.is_unmet[v] && wanted[v] < (v < n ? m : n)) {
        wanted[v] *= 4;
        can_grow = true;
      }
    if (!can_grow)
      return plan;
  }
}

/// Points of both trees on the edges of the common topology, and their partners.
template <class ConcurrencyTag>
class Point_matching
{
public:
  /// `edge[t][i]`: the edge of point i of tree t. Geometries are those of the trees themselves.
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

  /// Pairs by edge. `is_stopped(done)` is asked between batches of windows; the result is empty if it says so.
  template <class IsStopped>
  std::vector<Point_pair>
  run(const Transport_options& options, Transport_summary& summary, const IsStopped& is_stopped)
  {
    const std::vector<Window> windows = make_windows(options);
    std::vector<std::vector<Point_pair>> pairs(windows.size());
    std::vector<double> violation(windows.size(), 0);
    std::vector<char> is_complete(windows.size(), 1);
    constexpr std::size_t batch = 256;
    for (std::size_t begin = 0; begin < windows.size(); begin += batch) {
      if (is_stopped(static_cast<double>(begin) / static_cast<double>(windows.size())))
        return {};
      pcs::internal::for_each_index<ConcurrencyTag>(
          std::min(batch, windows.size() - begin),
          [&](std::size_t k) {
            const std::size_t w = begin + k;
            is_complete[w] = match_window(windows[w], options, pairs[w], violation[w]);
          },
          1);
    }
    std::vector<Point_pair> all;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      all.insert(all.end(), pairs[w].begin(), pairs[w].end());
      if (windows[w].point[0].empty() || windows[w].point[1].empty())
        continue;
      ++summary.number_of_windows;
      summary.number_of_failures += is_complete[w] ? 0 : 1;
      summary.worst_violation = std::max(summary.worst_violation, violation[w]);
      summary.mean_violation += violation[w];
    }
    if (summary.number_of_windows > 0)
      summary.mean_violation /= static_cast<double>(summary.number_of_windows);
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

  std::vector<Window> make_windows(const Transport_options& options) const
  {
    std::vector<Window> windows;
    Window open;
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      std::size_t last = none; // window of this branch that was closed last
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
        const bool is_too_much =
            std::max(open.point[0].size() + n, open.point[1].size() + m) > options.largest_window;
        if (is_too_much)
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

  /// Cuts a long edge across, at places that leave about as many points of both trees between them.
  std::vector<Window> cut(std::size_t e, const Transport_options& options) const
  {
    struct Place
    {
      double t;
      std::uint32_t tree, point;
    };
    std::vector<Place> places;
    for (std::uint32_t t = 0; t < 2; ++t) {
      const Edge_cone edge = edge_cone(m_layout, m_geometry[t], m_branch_of[e], e);
      for (const std::uint32_t i : m_of_edge[t][e]) {
        const Vec3 q = edge.frame.transpose() * (m_points[t][i] - edge.from);
        places.push_back({q.z() / edge.length, t, i});
      }
    }
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
      return a.t != b.t ? a.t < b.t : a.tree != b.tree ? a.tree < b.tree : a.point < b.point;
    });
    std::vector<Window> windows(1);
    const double share[2] = {1 / static_cast<double>(m_of_edge[0][e].size()),
                             1 / static_cast<double>(m_of_edge[1][e].size())};
    const std::size_t most = std::max(m_of_edge[0][e].size(), m_of_edge[1][e].size());
    const double parts =
        std::ceil(static_cast<double>(most) / static_cast<double>(options.largest_window));
    double mass = 0;
    for (const Place& p : places) {
      if (mass >= 2 * static_cast<double>(windows.size()) / parts &&
          !windows.back().point[0].empty() && !windows.back().point[1].empty())
        windows.emplace_back();
      windows.back().point[p.tree].push_back({p.point, static_cast<std::uint32_t>(e)});
      mass += share[p.tree];
    }
    Window& last = windows.back();
    if (windows.size() > 1 && (last.point[0].empty() || last.point[1].empty())) {
      Window& before = windows[windows.size() - 2];
      for (std::size_t t = 0; t < 2; ++t)
        before.point[t].insert(before.point[t].end(), last.point[t].begin(), last.point[t].end());
      windows.pop_back();
    }
    return windows;
  }

  bool match_window(const Window& window,
                    const Transport_options& options,
                    std::vector<Point_pair>& pairs,
                    double& violation) const
  {
    for (std::size_t t = 0; t < 2; ++t)
      if (window.point[1 - t].empty()) {
        for (const Placed& p : window.point[t]) {
          Point_pair pair{p.edge, {no_point, no_point}};
          pair.point[t] = p.point;
          pairs.push_back(pair);
        }
        return true;
      }
    // tree 1 is laid on tree 2: turned, stretched along and across, and moved, edge by edge
    std::vector<Vec3> one, two;
    for (const Placed& p : window.point[0]) {
      const std::size_t b = m_branch_of[p.edge];
      const bool is_relative = m_is_relative[p.edge];
      const Tube_coordinates c = tube_coordinates(edge_cone(m_layout, m_geometry[0], b, p.edge),
                                                  m_points[0][p.point],
                                                  is_relative);
      one.push_back(point_of(edge_cone(m_layout, m_geometry[1], b, p.edge), c, is_relative));
    }
    for (const Placed& p : window.point[1])
      two.push_back(m_points[1][p.point]);
    Transport_problem problem;
    const Transport_plan plan = match_points(one, two, options, problem);
    std::vector<char> is_paired(one.size() + two.size(), 0);
    const auto add = [&](std::size_t i, std::size_t j) {
      const Placed &p = window.point[0][i], &q = window.point[1][j];
      pairs.push_back({p.edge, {p.point, q.point}});
      is_paired[i] = is_paired[one.size() + j] = 1;
    };
    for (const std::uint32_t k : main_arcs(problem, plan))
      add(problem.arcs[k].source, problem.arcs[k].target);
    for (std::size_t v = 0; v < is_paired.size(); ++v) // only where the transport failed
      if (!is_paired[v]) {
        const bool is_one = v < one.size();
        pairs.push_back({is_one ? window.point[0][v].edge : window.point[1][v - one.size()].edge,
                         {is_one ? window.point[0][v].point : no_point,
                          is_one ? no_point : window.point[1][v - one.size()].point}});
      }
    violation = plan.violation;
    return plan.is_complete;
  }

  const Orl_layout& m_layout;
  const std::array<Orl_geometry, 2>& m_geometry;
  const std::array<std::vector<Vec3>, 2>& m_points;
  const std::vector<char>& m_is_relative;
  std::array<std::vector<std::vector<std::uint32_t>>, 2> m_of_edge;
  std::vector<std::size_t> m_branch_of;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINT_CORRESPONDENCES_H

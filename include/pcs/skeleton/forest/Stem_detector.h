// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stem detection in a stand, and assignment of axes and points to trees.

#ifndef PCS_SKELETON_FOREST_STEM_DETECTOR_H
#define PCS_SKELETON_FOREST_STEM_DETECTOR_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/axes/fit_axes.h>
#include <pcs/skeleton/branching/build_branch_tree.h>
#include <pcs/skeleton/forest/Found_stem.h>
#include <pcs/skeleton/forest/Lowest_ground.h>
#include <pcs/skeleton/forest/Sparse_ground.h>
#include <pcs/skeleton/forest/Stand_options.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/layers/trace_layers.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/result/describe_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Copies labels from the nearest labelled ancestor to unlabelled elements. `parent(i)` is `none`
/// at a root. O(n).
template <class Parent>
void inherit(std::vector<Index>& labels, const Parent& parent)
{
  std::vector<Index> way;
  for (Index i = 0; i < labels.size(); ++i) {
    way.clear();
    Index at = i;
    for (; at != none && labels[at] == none; at = parent(at))
      way.push_back(at);
    for (const Index j : way)
      labels[j] = at == none ? none : labels[at];
  }
}

/*!
  Detects stems and assigns points to trees. Axes are fitted twice: first along the paths from the
  lowest points of all connected components, to detect stems; then along the paths from the feet of
  these stems. `Axis_joiner` joins every axis of the second fit to another one, and thus to a tree.
  z points upwards.
*/
template <class ConcurrencyTag>
class Stem_detector
{
public:
  Stem_detector(const Scan& scan,
                const std::vector<std::uint8_t>& is_used,
                const std::vector<std::uint8_t>& may_be_ground,
                const std::optional<Sparse_ground>& surface,
                double breast_height,
                const Session_options& options,
                const Stand_options& rules)
    : m_scan(scan),
      m_is_used(is_used),
      m_may_be_ground(may_be_ground),
      m_surface(surface),
      m_breast_height(breast_height),
      m_options(options),
      m_rules(rules)
  {
  }

  /// Performs the first fit and detects its stems. Returns `false` if the work was cancelled.
  bool find(pcs::internal::Progress& progress)
  {
    m_stem_of_point.assign(m_scan.size(), none);
    m_is_solid = solid_points();
    const std::vector<Index> lowest = link_parts();
    if (lowest.empty())
      return progress(1);
    if (!fit_along(paths_from(lowest), progress, 0.5, 0.75))
      return false;
    find_stems();
    m_feet = points_of_feet();
    return true;
  }

  /// Performs the second fit along the paths from the stems, and assigns all points to trees. Calls
  /// `release()` as soon as neighbours and search of the scan are not needed any more. Returns
  /// `false` if the work was cancelled.
  template <class Release>
  bool label(pcs::internal::Progress& progress, const Release& release)
  {
    if (m_feet.empty()) {
      m_tree_of_point.assign(m_scan.size(), none);
      return progress(1);
    }
    m_axes = Axis_set(); // of the first fit
    Shortest_paths paths = paths_from(m_feet);
    const std::vector<Index> predecessor = paths.predecessor; // without the distances
    if (!fit_along(std::move(paths), progress, 0.75, 1))
      return false;
    m_links.reset();
    release();
    label_axes();
    label_points(predecessor);
    return true;
  }

  const std::vector<Found_stem>& stems() const { return m_stems; } ///< grouped by tree
  /// Returns the tree of each scan point, or `none`; empty before `label()`.
  const std::vector<Index>& tree_of_point() const { return m_tree_of_point; }
  /// Returns the stem of each scan point in the lowest part of a stem, or `none`.
  const std::vector<Index>& stem_of_point() const { return m_stem_of_point; }

private:
  /// Finds the links between neighbours and across gaps. Returns the points within one level-set
  /// thickness of the lowest point of each component.
  std::vector<Index> link_parts()
  {
    m_links.emplace(ConcurrencyTag(), m_scan, m_is_used, m_options.axes.links);
    m_links->append(
        links_across_gaps<ConcurrencyTag>(m_scan,
                                          m_is_used,
                                          m_options.axes.links,
                                          connected_parts<ConcurrencyTag>(m_is_used, *m_links)));
    const Point_parts parts = connected_parts<ConcurrencyTag>(m_is_used, *m_links);
    std::vector<double> low(m_scan.size(), std::numeric_limits<double>::infinity());
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_used[i])
        low[parts.part[i]] = std::min(low[parts.part[i]], m_scan.points[i].z());
    std::vector<Index> sources;
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_used[i] && parts.size[parts.part[i]] >= m_rules.solid_part &&
          m_scan.points[i].z() <= low[parts.part[i]] + layer_thickness * m_scan.spacing)
        sources.push_back(i);
    return sources;
  }

  Shortest_paths paths_from(const std::vector<Index>& sources) const
  {
    return shortest_paths(m_scan, graph_of(m_scan.size(), *m_links), sources);
  }

  Layer_tree layers_along(const Shortest_paths& paths) const
  {
    Layer_tree layers = layer_tree<ConcurrencyTag>(m_scan, *m_links, paths);
    merge_ring_arcs<ConcurrencyTag>(m_scan, m_options.layers.rings, layers);
    return layers;
  }

  bool fit_along(Shortest_paths paths, pcs::internal::Progress& progress, double from, double to)
  {
    const Layer_tree layers = layers_along(paths);
    paths = Shortest_paths();
    bool is_running = true;
    m_axes = fit_axes<ConcurrencyTag>(m_scan, layers, m_options.axes, [&](double f) {
      return is_running = progress(from + (to - from) * f);
    });
    if (is_running)
      fuse_axes<ConcurrencyTag>(m_scan.spacing, m_options.branching.fusion, m_axes);
    return is_running;
  }

  /// Marks the points of large connected components of ground or trees.
  std::vector<std::uint8_t> solid_points() const
  {
    std::vector<std::uint8_t> is_solid = m_may_be_ground;
    const Point_parts parts = connected_parts<ConcurrencyTag>(
        is_solid,
        Compact_links(ConcurrencyTag(), m_scan, is_solid, m_options.axes.links));
    for (std::size_t i = 0; i < is_solid.size(); ++i)
      is_solid[i] = is_solid[i] && parts.size[parts.part[i]] >= m_rules.solid_part;
    return is_solid;
  }

  /// Detects stems: steep axes that begin near the ground and are not much thinner there.
  void find_stems()
  {
    const Lowest_ground ground(m_scan,
                               m_surface,
                               m_rules.ground_cell * m_breast_height,
                               m_rules.ground_slope,
                               m_is_solid);
    std::vector<Found_stem> found;
    for (Index a = 0; a < m_axes.axes.size(); ++a) {
      const Axis_node* const foot = foot_of(m_axes.axes[a].axis, ground);
      if (foot != nullptr)
        found.push_back(stem_of(a, foot->point, ground));
    }
    continue_down(ground, found);
    measure_feet(found);
    for (Found_stem& stem : found)
      stem.radius_at_breast = radius_at_breast(stem, m_axes, m_breast_height, m_rules);
    std::stable_sort(found.begin(), found.end(), [](const Found_stem& a, const Found_stem& b) {
      return a.radius > b.radius;
    });
    std::vector<Found_stem> thickest; // of each tree
    for (Found_stem& stem : found) {
      const auto own = std::find_if(thickest.begin(), thickest.end(), [&](const Found_stem& other) {
        return are_of_one_tree(stem, other, m_breast_height, m_rules);
      });
      stem.tree = static_cast<Index>(own - thickest.begin());
      if (own == thickest.end())
        thickest.push_back(stem);
    }
    std::stable_sort(found.begin(), found.end(), [](const Found_stem& a, const Found_stem& b) {
      return a.tree < b.tree;
    });
    m_stems = std::move(found);
  }

  Found_stem stem_of(Index a, const Vec3& foot, const Lowest_ground& ground) const
  {
    Found_stem stem;
    stem.axis = a;
    stem.foot = foot;
    stem.radius = radius_near(m_axes.axes[a].axis, foot, m_rules.root * m_breast_height);
    stem.height = ground.height(foot);
    return stem;
  }

  /// Measures the heights of feet above the ground: above the median level of the ground points
  /// around them, relative to the surface of the ground.
  void measure_feet(std::vector<Found_stem>& stems) const
  {
    if (!m_surface || stems.empty())
      return;
    std::vector<Vec3> feet;
    for (const Found_stem& stem : stems)
      feet.emplace_back(stem.foot.x(), stem.foot.y(), 0);
    const neighborhood::Nearest_neighbors search(feet);
    std::vector<std::vector<double>> levels(stems.size());
    std::vector<Index> near;
    for (std::size_t i = 0; i < m_scan.size(); ++i) {
      if (m_is_used[i] || !m_may_be_ground[i])
        continue;
      const Vec3& p = m_scan.points[i];
      near.clear();
      search.within(Vec3(p.x(), p.y(), 0), m_rules.ground_around * m_breast_height, near);
      for (const Index s : near)
        levels[s].push_back(m_surface->height(p));
    }
    for (std::size_t s = 0; s < stems.size(); ++s) {
      if (levels[s].size() < m_rules.ground_points)
        continue;
      const double above =
          m_surface->height(stems[s].foot) - pcs::internal::lower_median(levels[s]);
      if (!std::isfinite(above)) // in a square without points, there is no surface
        continue;
      stems[s].above_ground = above;
      stems[s].height = std::max(0.0, above);
    }
  }

  /// Marks the points that may lie on a stem or below it. Empty if none is far below a foot, as in
  /// most scans, so that no links need to be listed.
  std::vector<std::uint8_t> points_below(const std::vector<Found_stem>& stems) const
  {
    if (stems.empty())
      return {};
    std::vector<Vec3> feet;
    double widest = 0;
    for (const Found_stem& stem : stems) {
      feet.emplace_back(stem.foot.x(), stem.foot.y(), 0);
      widest = std::max(widest, reach_below(stem, m_breast_height, m_rules));
    }
    const neighborhood::Nearest_neighbors search(feet);
    std::vector<std::uint8_t> is_below(m_scan.size(), 0), is_far(m_scan.size(), 0);
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_scan.size(),
        [&](std::size_t i) {
          if (!m_is_used[i])
            return;
          const Vec3& p = m_scan.points[i];
          std::vector<Index> near;
          search.within(Vec3(p.x(), p.y(), 0), widest, near);
          for (const Index s : near)
            if (may_continue(stems[s], p, m_breast_height, m_rules)) {
              is_below[i] = 1;
              is_far[i] = is_far[i] || stems[s].foot.z() - p.z() > m_rules.hidden * m_breast_height;
            }
        },
        4096);
    if (std::find(is_far.begin(), is_far.end(), 1) == is_far.end())
      is_below.clear();
    return is_below;
  }

  /// Moves stems that begin above the ground to the axes below them.
  void continue_down(const Lowest_ground& ground, std::vector<Found_stem>& stems) const
  {
    const std::vector<std::uint8_t> is_below = points_below(stems);
    if (is_below.empty())
      return;
    std::map<Index, std::vector<Index>> points; // by axis of a stem
    for (const Found_stem& stem : stems)
      points[stem.axis];
    for (Index i = 0; i < m_scan.size(); ++i)
      if (is_below[i] && m_axes.is_covered(i)) {
        const auto own = points.find(m_axes.axis_of_point[i]);
        if (own != points.end())
          own->second.push_back(i);
      }
    Links links;
    for_each_link(*m_links, [&](const Link& link) {
      if (is_below[link.first] && is_below[link.second])
        links.push_back(link);
    });
    const Neighbor_graph graph = graph_of(m_scan.size(), links);
    const Stem_continuation continuation(m_scan, graph, m_axes, m_breast_height, m_rules);
    std::vector<Found_stem> lowest;
    for (const Found_stem& stem : stems) {
      const Index a = continuation.lowest_axis(stem, points[stem.axis]);
      const Axis& axis = m_axes.axes[a].axis;
      const Vec3& foot =
          (axis.front().point.z() <= axis.back().point.z() ? axis.front() : axis.back()).point;
      const double least = m_rules.hidden * m_breast_height;
      const bool is_lower = a != stem.axis && stem.foot.z() - foot.z() > least &&
                            stem.height - ground.height(foot) > least; // also on a slope
      const Found_stem moved = is_lower ? stem_of(a, foot, ground) : stem;
      if (std::none_of(lowest.begin(), lowest.end(), [&](const Found_stem& other) {
            return other.axis == moved.axis;
          }))
        lowest.push_back(moved);
    }
    stems = std::move(lowest);
  }

  /// Returns the end from which an axis rises like a stem, or null. Nodes beyond the highest one
  /// are ignored.
  const Axis_node* foot_of(const Axis& axis, const Lowest_ground& ground) const
  {
    const Axis_node* foot = nullptr;
    double largest = 0; // radius
    for (const bool is_reversed : {false, true}) {
      const auto node_at = [&](std::size_t k) -> const Axis_node& {
        return axis[is_reversed ? axis.size() - 1 - k : k];
      };
      double length = 0;
      bool is_steep = false; // up to some node
      std::size_t top = 0;
      for (std::size_t k = 1; k < axis.size(); ++k) {
        length += (node_at(k).point - node_at(k - 1).point).norm();
        const double rise = node_at(k).point.z() - node_at(0).point.z();
        is_steep =
            is_steep || rise >= std::max(m_rules.rise * m_breast_height, m_rules.steep * length);
        top = node_at(k).point.z() > node_at(top).point.z() ? k : top;
      }
      const Axis_slope_summary part(top + 1, node_at);
      const double highest_foot =
          std::min(m_rules.foot * m_breast_height, m_rules.foot_radii * part.lower_radius);
      if (is_steep && part.rise >= m_rules.stout * part.lower_radius &&
          part.lower_radius >= m_rules.taper * part.upper_radius &&
          part.lower_radius >= m_rules.thinnest * m_breast_height && part.lower_radius > largest &&
          ground.height(node_at(0).point) <= highest_foot) {
        foot = &node_at(0);
        largest = part.lower_radius;
      }
    }
    return foot;
  }

  /// Returns the points in the lowest part of all stems, and assigns them to their stems.
  std::vector<Index> points_of_feet()
  {
    std::vector<Index> stem_of_axis(m_axes.axes.size(), none), sources;
    for (Index s = 0; s < m_stems.size(); ++s)
      stem_of_axis[m_stems[s].axis] = s;
    for (Index i = 0; i < m_scan.size(); ++i) {
      const Index s = m_axes.is_covered(i) ? stem_of_axis[m_axes.axis_of_point[i]] : none;
      if (s == none || m_scan.points[i].z() > m_stems[s].foot.z() + m_rules.root * m_breast_height)
        continue;
      m_stem_of_point[i] = s;
      sources.push_back(i);
    }
    return sources;
  }

  /// Assigns the axes to trees. The root axis of a stem is the one with the most foot points,
  /// weighted by its number of points; other axes belong to the tree of their parent.
  void label_axes()
  {
    std::map<std::pair<Index, Index>, double> votes; // of stem and axis
    for (const Index i : m_feet)
      if (m_axes.is_covered(i)) {
        const Index a = m_axes.axis_of_point[i];
        votes[{m_stem_of_point[i], a}] += double(m_axes.axes[a].number_of_points);
      }
    std::vector<Index> best(m_stems.size(), none);
    for (const auto& [pair, vote] : votes) {
      Index& b = best[pair.first];
      if (b == none || vote > votes[{pair.first, b}])
        b = pair.second;
    }
    m_tree_of_axis.assign(m_axes.axes.size(), none);
    std::vector<Index> roots;
    for (Index s = 0; s < m_stems.size(); ++s) {
      if (best[s] == none || m_tree_of_axis[best[s]] != none)
        continue;
      m_tree_of_axis[best[s]] = m_stems[s].tree;
      roots.push_back(best[s]);
    }
    const Axis_joiner joiner(m_axes, m_scan.spacing, m_options.branching.joints);
    const std::vector<Joint> joints = joiner.template run<ConcurrencyTag>(roots);
    inherit(m_tree_of_axis, [&](Index a) { return joints[a].parent; });
  }

  /// Assigns the points to trees by their axis; without an axis or its tree, by the path from the
  /// nearest foot.
  void label_points(const std::vector<Index>& predecessor)
  {
    m_tree_of_point.assign(m_scan.size(), none);
    for (const Index i : m_feet)
      m_tree_of_point[i] = m_stems[m_stem_of_point[i]].tree;
    inherit(m_tree_of_point, [&](Index i) { return predecessor[i] == i ? none : predecessor[i]; });
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_axes.is_covered(i) && m_tree_of_axis[m_axes.axis_of_point[i]] != none)
        m_tree_of_point[i] = m_tree_of_axis[m_axes.axis_of_point[i]];
    return_feet();
  }

  /// Assigns the points of stems that were removed with the ground to the stem nearest in radii. On
  /// a slope, such points also lie above the feet.
  void return_feet()
  {
    if (m_stems.empty())
      return;
    const auto reach = [&](const Found_stem& stem) {
      return m_rules.base_radii * stem.radius + m_scan.spacing;
    };
    std::vector<Vec3> feet;
    double widest = 0;
    for (const Found_stem& stem : m_stems) {
      feet.emplace_back(stem.foot.x(), stem.foot.y(), 0);
      widest = std::max(widest, reach(stem));
    }
    const neighborhood::Nearest_neighbors search(feet);
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_scan.size(),
        [&](std::size_t i) {
          if (m_is_used[i] || !m_is_solid[i])
            return;
          const Vec3& p = m_scan.points[i];
          std::vector<Index> near;
          search.within(Vec3(p.x(), p.y(), 0), widest, near);
          double best = 1; // distance as a fraction of the reach of a stem
          for (const Index s : near) {
            const Found_stem& stem = m_stems[s];
            const Vec3 d = p - stem.foot;
            const double share = std::hypot(d.x(), d.y()) / reach(stem);
            const bool is_level = d.z() <= m_rules.base_radii * stem.radius &&
                                  d.z() >= -m_rules.foot * m_breast_height;
            if (is_level && (share < best || (share == best && stem.tree < m_tree_of_point[i]))) {
              best = share;
              m_tree_of_point[i] = stem.tree;
            }
          }
        },
        4096);
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  const std::vector<std::uint8_t>& m_may_be_ground;
  const std::optional<Sparse_ground>& m_surface; ///< of the ground, if enough of it is seen
  double m_breast_height;                        ///< in the unit of the scan
  const Session_options& m_options;
  const Stand_options& m_rules;
  std::vector<std::uint8_t> m_is_solid;
  std::optional<Compact_links> m_links; ///< between neighbours, and across gaps
  Axis_set m_axes;
  std::vector<Found_stem> m_stems;
  std::vector<Index> m_stem_of_point; ///< of points at the feet
  std::vector<Index> m_feet;          ///< points at the feet
  std::vector<Index> m_tree_of_point, m_tree_of_axis;
};

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_STEM_DETECTOR_H

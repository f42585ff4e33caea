// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Straight borders of handles on irregular samplings.

#ifndef PCS_DEFORMATION_HANDLES_STRAIGHTEN_BORDERS_H
#define PCS_DEFORMATION_HANDLES_STRAIGHTEN_BORDERS_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

/// Distance and direction in which a handle extends beyond one of its nodes.
struct Border_advance
{
  Vec3 direction = Vec3::Zero(); ///< unit vector that points out of the handle
  double distance = 0;           ///< [L]
};

/// Handle nodes whose lateral distance exceeds this do not affect the border at a node. [spacings]
constexpr double widest_border_patch = 2;
/// The border leaves at least this fraction of an edge to the free node. [-]
constexpr double least_free_share = 0.2;
/// Borders nearer to their node than this are not moved. [fractions of the edge]
constexpr double negligible_advance = 1e-6;

/// Returns the distance of the border from node `j`. The border is the line through the outermost
/// nodes of the handle around `j`.
inline Border_advance
border_advance(const Elastic_network& network, const Node_constraints& constraints, std::size_t j)
{
  const Weighted_graph& graph = network.surface;
  const auto for_each_near = [&](const auto& use) {
    for (auto a = graph.begin(j); a != graph.end(j); ++a) {
      use(*a);
      for (auto b = graph.begin(*a); b != graph.end(*a); ++b)
        if (*b != j)
          use(*b);
    }
  };
  const Node_constraint handle = constraints.handle_of_node[j];
  const double reach = widest_border_patch * local_spacing(network.rest, graph, j);
  Vec3 inside = Vec3::Zero(), outside = Vec3::Zero();
  double number_inside = 1, number_outside = 0;
  for_each_near([&](std::uint32_t k) {
    const Vec3 offset = network.rest[k] - network.rest[j];
    if (constraints.handle_of_node[k] == handle) {
      inside += offset;
      number_inside += 1;
    } else if (!constraints.is_prescribed(k)) {
      outside += offset;
      number_outside += 1;
    }
  });
  Border_advance result;
  if (number_outside == 0)
    return result;
  const Vec3 out = outside / number_outside - inside / number_inside;
  const double length = out.norm();
  if (!(length > 0))
    return result;
  result.direction = out / length;
  for_each_near([&](std::uint32_t k) {
    if (constraints.handle_of_node[k] != handle)
      return;
    const Vec3 offset = network.rest[k] - network.rest[j];
    const double ahead = offset.dot(result.direction);
    if ((offset - ahead * result.direction).squaredNorm() <= reach * reach)
      result.distance = std::max(result.distance, ahead);
  });
  return result;
}

} // namespace internal

namespace internal {

/// An edge from a free node to a handle that is cut at the border.
struct Held_edge
{
  std::size_t free, held; ///< indices of the two half-edges
  std::uint32_t node, handle_node;
  double fraction; ///< fraction of the edge that lies inside the handle [-]
  double weight;   ///< of the whole edge [-]

  /// Weight of the part outside the handle.
  double new_weight() const { return representable_weight(weight / (1 - fraction)); }
};

/// Finds the edges that cross a border, sorted by the node of the handle.
inline std::vector<Held_edge> find_held_edges(const Elastic_network& network,
                                              const Node_constraints& constraints)
{
  const Weighted_graph& graph = network.surface;
  std::vector<Held_edge> edges;
  for (std::uint32_t j = 0; j < network.size(); ++j) {
    if (!constraints.is_prescribed(j))
      continue;
    Border_advance advance;
    bool is_known = false;
    for (std::size_t e = graph.first[j]; e < graph.first[j + 1]; ++e) {
      const std::uint32_t i = graph.neighbor[e];
      if (constraints.is_prescribed(i) || constraints.handle_of_node[i] == unreached_node)
        continue;
      if (!is_known)
        advance = border_advance(network, constraints, j);
      is_known = true;
      const double ahead = (network.rest[i] - network.rest[j]).dot(advance.direction);
      if (!(ahead > 0) || !(advance.distance > negligible_advance * ahead))
        continue;
      const double fraction = std::min(1 - least_free_share, advance.distance / ahead);
      const auto back = static_cast<std::size_t>(std::lower_bound(graph.begin(i), graph.end(i), j) -
                                                 graph.neighbor.data());
      edges.push_back({back, e, i, j, fraction, graph.weight[back]});
    }
  }
  return edges;
}

} // namespace internal

/// The half-edges that `straighten_borders()` removed from a graph.
class Cut_edges
{
public:
  bool empty() const { return m_removed.empty(); }

private:
  friend bool straighten_borders(Elastic_network&, Node_constraints&, Cut_edges&);
  friend void restore_borders(Elastic_network&, Cut_edges&);
  friend Weighted_graph uncut_surface(const Elastic_network&, const Cut_edges&);

  struct Half_edge
  {
    std::size_t index;
    std::uint32_t node, neighbor;
    double weight;
  };

  /// \param edges sorted by `free`
  explicit Cut_edges(const std::vector<internal::Held_edge>& edges)
  {
    m_removed.reserve(2 * edges.size());
    for (const internal::Held_edge& b : edges) {
      m_removed.push_back({b.free, b.node, b.handle_node, b.weight});
      m_removed.push_back({b.held, b.handle_node, b.node, b.weight});
    }
    std::sort(m_removed.begin(), m_removed.end(), [](const Half_edge& a, const Half_edge& b) {
      return a.index < b.index;
    });
  }

  /// Removes the half-edges, and lets the edges of the free nodes lead to new nodes, which are
  /// numbered in the order of `edges`. Allocates nothing if `first` has the capacity for them.
  void cut(const std::vector<internal::Held_edge>& edges, Weighted_graph& graph) const
  {
    const std::size_t n = graph.size();
    auto next = edges.begin();
    auto removed = m_removed.begin();
    std::size_t to = 0; // never exceeds the next half-edge that is read
    const auto put = [&](std::uint32_t neighbor, double weight) {
      graph.neighbor[to] = neighbor;
      graph.weight[to++] = weight;
    };
    for (std::size_t i = 0, e = 0; i < n; ++i) {
      for (const std::size_t end = graph.first[i + 1]; e < end; ++e)
        if (removed != m_removed.end() && removed->index == e)
          ++removed;
        else
          put(graph.neighbor[e], graph.weight[e]);
      for (; next != edges.end() && next->node == i; ++next)
        put(static_cast<std::uint32_t>(n + static_cast<std::size_t>(next - edges.begin())),
            next->new_weight());
      graph.first[i + 1] = static_cast<std::uint32_t>(to);
    }
    for (const internal::Held_edge& b : edges) {
      put(b.node, b.new_weight());
      graph.first.push_back(static_cast<std::uint32_t>(to));
    }
  }

  /// Reverses `cut()` for a graph that had `n` nodes. Allocates nothing.
  void undo(std::size_t n, Weighted_graph& graph) const
  {
    graph.first.resize(n + 1);
    auto removed = m_removed.end(); // the last one that is not yet restored comes before
    std::size_t to = graph.neighbor.size(), end = graph.first[n];
    const auto put = [&](std::uint32_t neighbor, double weight) {
      graph.neighbor[--to] = neighbor;
      graph.weight[to] = weight;
    };
    for (std::size_t i = n; i-- > 0;) {
      const std::size_t begin = graph.first[i];
      graph.first[i + 1] = static_cast<std::uint32_t>(to);
      while (end > begin && graph.neighbor[end - 1] >= n)
        --end; // an edge to a new node
      for (;;)
        if (removed != m_removed.begin() && (removed - 1)->node == i &&
            (removed - 1)->index + 1 == to) {
          --removed;
          put(removed->neighbor, removed->weight);
        } else if (end > begin) {
          --end;
          put(graph.neighbor[end], graph.weight[end]);
        } else
          break;
      end = begin;
    }
  }

  std::vector<Half_edge> m_removed; ///< by increasing index

public:
  Cut_edges() = default;
};

/*!
  Gives the edges between free nodes and exact handles their true length up to the border of the
  handle.

  If points are selected by a region of space, the outermost ones lie on average half a spacing
  inside its border. If only these points were held, the body would deform as if the handle were
  half a spacing shorter. Here the border leads through the outermost points of the handle around
  each point (on a grid: through all of them). Where it crosses an edge at the fraction `t` of its
  length, the network gets an additional node that moves with the handle. The weight of the new edge
  is the weight of the old edge divided by `1 - t`. Constraints are extended to the new nodes.

  The network is changed in place, because a copy of a large one needs much memory. `cut` remembers
  what `restore_borders()` needs. Returns `false`, and changes nothing, if no border extends beyond
  its nodes. Changes nothing if it throws. O(n).
*/
inline bool
straighten_borders(Elastic_network& network, Node_constraints& constraints, Cut_edges& cut)
{
  std::vector<internal::Held_edge> edges = internal::find_held_edges(network, constraints);
  if (edges.empty())
    return false;
  std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) {
    return a.free < b.free;
  });
  Cut_edges removed(edges);
  const std::size_t size = network.size() + edges.size();
  constraints.handle_of_node.reserve(size);
  network.rest.reserve(size);
  network.source.reserve(edges.size());
  network.surface.first.reserve(size + 1);
  if (network.links.size() > 0)
    network.links.first.resize(size + 1, network.links.first.back());
  // nothing below allocates memory
  for (const internal::Held_edge& b : edges) {
    const Vec3& held = network.rest[b.handle_node];
    network.rest.push_back(held + b.fraction * (network.rest[b.node] - held));
    network.source.push_back(b.handle_node);
    constraints.handle_of_node.push_back(constraints.handle_of_node[b.handle_node]);
  }
  removed.cut(edges, network.surface);
  cut = std::move(removed);
  return true;
}

/// Restores the network as it was before `straighten_borders()`. Does nothing if `cut` is empty; it
/// is empty afterwards. O(n).
inline void restore_borders(Elastic_network& network, Cut_edges& cut)
{
  if (cut.empty())
    return;
  const std::size_t n = network.size() - network.source.size();
  network.rest.resize(n);
  network.source.clear();
  if (network.links.size() > 0)
    network.links.first.resize(n + 1);
  cut.undo(n, network.surface);
  cut = Cut_edges();
}

/// Returns a copy of the surface as it was before. O(n).
inline Weighted_graph uncut_surface(const Elastic_network& network, const Cut_edges& cut)
{
  Weighted_graph surface = network.surface;
  if (!cut.empty())
    cut.undo(network.size() - network.source.size(), surface);
  return surface;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_STRAIGHTEN_BORDERS_H

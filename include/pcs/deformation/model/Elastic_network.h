// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Elastic network: nodes at rest, weighted surface edges, and springs through the interior.

#ifndef PCS_DEFORMATION_MODEL_ELASTIC_NETWORK_H
#define PCS_DEFORMATION_MODEL_ELASTIC_NETWORK_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/median_link.h>

#include <CGAL/tags.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pcs {
namespace deformation {

using Vec3 = Eigen::Vector3d;

/// A proximity graph with one symmetric weight per half-edge [-].
struct Weighted_graph : neighborhood::Proximity_graph
{
  std::vector<double> weight;
};

struct Elastic_network
{
  std::vector<Vec3> rest; ///< positions of the nodes [L]
  Weighted_graph surface; ///< edges along the surface
  Weighted_graph links;   ///< springs through the interior; may be empty (then `links.size() == 0`)
  /// Fractions of the surface of their components that the first nodes represent. [-]
  std::vector<double> area;
  /// Orders of elimination of the first nodes, for factors of the surface, and of surface and
  /// links. They apply to any choice of free nodes; empty if computing them does not pay.
  std::vector<std::uint32_t> surface_rank, rank;
  /// The origins of the nodes that were added after the first ones on the borders of handles:
  /// sites, or nodes of the finer network.
  std::vector<std::uint32_t> source;
  std::size_t size() const { return rest.size(); }
};

/// Least edge length that enters weights, as a fraction of the local spacing, so that two points
/// that nearly coincide do not outweigh all others. [-]
constexpr double shortest_relative_edge = 0.2;
/// Largest ratio of the spacings of two neighbours; larger ratios indicate an outlier. [-]
constexpr double widest_spacing_step = 2;

/// Limits a weight to a finite, positive range, because squares of extreme lengths underflow.
inline double representable_weight(double w)
{
  return std::isfinite(w) ? std::min(1e9, std::max(1e-30, w)) : 1;
}

/// Returns the spacing at node `i`: the median length of its edges, which is robust against a
/// single outlier. [L]
inline double local_spacing(const std::vector<Vec3>& rest,
                            const neighborhood::Proximity_graph& graph,
                            std::size_t i)
{
  return neighborhood::group_spacing(rest, graph, i);
}

/*!
  Sets `area` to the fractions `a_i / sum_k a_k` over the nodes of a component, with the weighted
  mean square `a_i = sum_j w_ij |x_j - x_i|^2 / sum_j w_ij` of the edges of a node [L^2]. Multiplied
  by the degree `sum_j w_ij`, the area is proportional to the resistance of the edges of the node
  against a rotation. If two nodes nearly coincide, they have a large degree, but a small area. \p
  component holds the component of each node.
*/
template <class ConcurrencyTag>
void set_areas(const std::vector<std::uint32_t>& component, Elastic_network& network)
{
  const std::size_t n = network.size();
  network.area.resize(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    const Weighted_graph& graph = network.surface;
    double squares = 0, degree = 0;
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      squares +=
          graph.weight[e] * (network.rest[graph.neighbor[e]] - network.rest[i]).squaredNorm();
      degree += graph.weight[e];
    }
    network.area[i] = degree > 0 ? squares / degree : 0;
  });
  std::vector<double> sum;
  for (std::size_t i = 0; i < n; ++i) {
    sum.resize(std::max<std::size_t>(sum.size(), component[i] + 1), 0);
    sum[component[i]] += network.area[i];
  }
  for (std::size_t i = 0; i < n; ++i)
    network.area[i] = sum[component[i]] > 0 ? network.area[i] / sum[component[i]] : 1;
}

/// Longest edge in `typical_edge()`; longer edges lead to outliers. [median spacings]
constexpr double longest_typical_edge = 4;

/// Returns the root mean square length of the edges, without edges to outliers. [L]
template <class ConcurrencyTag = CGAL::Sequential_tag>
double typical_edge(const std::vector<Vec3>& rest, const neighborhood::Proximity_graph& graph)
{
  const std::size_t n = graph.size();
  std::vector<double> spacing(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    spacing[i] = local_spacing(rest, graph, i);
  });
  spacing.erase(std::remove(spacing.begin(), spacing.end(), 0.0), spacing.end()); // without edges
  if (spacing.empty())
    return 0;
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  const double longest = longest_typical_edge * *middle;
  using Sum = Eigen::Vector2d; // of squared lengths, and of the edges
  const Sum sum = pcs::internal::blocked_reduce<ConcurrencyTag>(
      n,
      Sum(0, 0),
      [&](std::size_t i) {
        Sum row(0, 0);
        for (auto j = graph.begin(i); j != graph.end(i); ++j) {
          const double squared = (rest[*j] - rest[i]).squaredNorm();
          const bool is_typical = squared <= longest * longest;
          row += Sum(is_typical ? squared : 0, is_typical ? 1 : 0);
        }
        return row;
      },
      [](const Sum& a, const Sum& b) { return Sum(a + b); });
  return sum[1] > 0 ? std::sqrt(sum[0] / sum[1]) : *middle;
}

/*!
  Sets the weights `w_ij = (s_i^2 + s_j^2) / (2 |x_j - x_i|^2)`, scaled to mean 1. `s_i` is
  `local_spacing()`, and the larger spacing is limited to `widest_spacing_step` times the smaller
  one. Division by the squared distance turns differences into slopes. The factor `s^2` is the area
  of the surface per point, so that densely sampled parts do not become stiffer than sparse ones,
  and distant outliers have no effect.
*/
template <class ConcurrencyTag>
void set_edge_weights(const std::vector<Vec3>& rest, Weighted_graph& graph)
{
  const std::size_t n = graph.size();
  std::vector<double> spacing(n, 0);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    spacing[i] = local_spacing(rest, graph, i);
  });
  graph.weight.resize(graph.neighbor.size());
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const double smaller = std::min(spacing[i], spacing[j]);
      const double larger =
          std::min(std::max(spacing[i], spacing[j]), widest_spacing_step * smaller);
      const double area = 0.5 * (smaller * smaller + larger * larger);
      const double floor = shortest_relative_edge * shortest_relative_edge * area;
      const double d2 = std::max((rest[j] - rest[i]).squaredNorm(), floor);
      graph.weight[e] = d2 > 0 ? representable_weight(area / d2) : 1;
    }
  });
  const double sum = pcs::internal::blocked_reduce<ConcurrencyTag>(
      graph.weight.size(),
      0.0,
      [&](std::size_t e) { return graph.weight[e]; },
      std::plus<double>());
  const double scale = sum > 0 ? static_cast<double>(graph.weight.size()) / sum : 1;
  for (double& w : graph.weight)
    w *= scale;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_ELASTIC_NETWORK_H

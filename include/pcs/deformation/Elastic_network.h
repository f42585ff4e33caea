// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The discrete body that is deformed: nodes at rest, weighted surface edges, and links through the inside.

#ifndef PCS_DEFORMATION_ELASTIC_NETWORK_H
#define PCS_DEFORMATION_ELASTIC_NETWORK_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
  Weighted_graph links;   ///< springs through the inside; may be empty (then `links.size() == 0`)
  std::size_t size() const { return rest.size(); }
};

/// An edge is never taken for shorter than this share of the spacing around it, so that two points that nearly
/// coincide do not outweigh all others.
constexpr double shortest_relative_edge = 0.2;

/*!
  Weights `w_ij = (s_i^2 + s_j^2) / (2 |x_j - x_i|^2)`, scaled to mean 1, where `s_i` is the root mean square edge
  length at `i`. `1 / d^2` turns differences into slopes; the factor `s^2` is the area that a point stands for, so
  that densely sampled parts do not become stiffer than sparse ones. `strength(e)` multiplies half-edge `e`.
*/
template <class ConcurrencyTag, class Strength>
void set_edge_weights(const std::vector<Vec3>& rest,
                      Weighted_graph& graph,
                      const Strength& strength)
{
  const std::size_t n = graph.size();
  std::vector<double> squared_spacing(n, 0);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      squared_spacing[i] += (rest[*j] - rest[i]).squaredNorm();
    if (graph.degree(i) > 0)
      squared_spacing[i] /= static_cast<double>(graph.degree(i));
  });
  graph.weight.resize(graph.neighbor.size());
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const double area = 0.5 * (squared_spacing[i] + squared_spacing[j]);
      const double floor = shortest_relative_edge * shortest_relative_edge * area;
      const double d2 = std::max((rest[j] - rest[i]).squaredNorm(), floor);
      graph.weight[e] = d2 > 0 ? strength(e) * area / d2 : 1;
    }
  });
  const double sum = pcs::internal::blocked_reduce<ConcurrencyTag>(
      graph.weight.size(),
      0.0,
      [&](std::size_t e) { return graph.weight[e]; },
      [](double a, double b) { return a + b; });
  const double scale = sum > 0 ? static_cast<double>(graph.weight.size()) / sum : 1;
  for (double& w : graph.weight)
    w *= scale;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ELASTIC_NETWORK_H

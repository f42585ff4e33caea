// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Yaw between two trees from all common edges.

#ifndef PCS_SHAPE_SPACE_EMBEDDING_REFINE_YAW_H
#define PCS_SHAPE_SPACE_EMBEDDING_REFINE_YAW_H

#include <pcs/internal/constants.h>
#include <pcs/shape_space/embedding/embed_trees.h>
#include <pcs/shape_space/model/Common_topology.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Returns the yaw near `yaw` that aligns tree 2 with tree 1: the weighted median of the azimuth
  differences of common edges. [rad]

  Edges are weighted by their lengths and their horizontal components. Unchanged wood agrees
  exactly. Edges that bent, grew or were matched by chance do not change the median if they have
  less than half of the weight.
*/
inline double refine_yaw(const std::array<const Rooted_tree*, 2>& trees,
                         const Common_topology& topology,
                         const Vec3& up,
                         double yaw)
{
  const Orl_layout layout = make_layout(topology.branches);
  std::array<internal::Embedding, 2> tree;
  for (const int t : {0, 1}) {
    const auto i = static_cast<std::size_t>(t);
    tree[i] =
        internal::embed(layout, topology.branches, *trees[i], topology.paths[i], t, Vec3::Zero());
  }
  constexpr double pi = pcs::internal::pi;
  std::vector<std::pair<double, double>> differences; // and weights
  double total = 0;
  for (std::size_t e = 0; e < layout.number_of_edges(); ++e) {
    const Vec3 a = tree[0].direction[e] - up.dot(tree[0].direction[e]) * up,
               b = tree[1].direction[e] - up.dot(tree[1].direction[e]) * up;
    const double weight = a.norm() * b.norm() * (tree[0].x.length[e] + tree[1].x.length[e]);
    if (!(weight > 0))
      continue;
    const double angle = std::atan2(up.dot(b.cross(a)), a.dot(b));
    differences.emplace_back(std::remainder(angle - yaw, 2 * pi), weight);
    total += weight;
  }
  std::sort(differences.begin(), differences.end());
  double sum = 0;
  for (const auto& [difference, weight] : differences)
    if ((sum += weight) >= 0.5 * total)
      return std::remainder(yaw + difference, 2 * pi);
  return yaw;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_EMBEDDING_REFINE_YAW_H

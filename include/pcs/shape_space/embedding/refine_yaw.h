// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Yaw between two trees from all edges that they have in common.

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
  The angle near `turn` by which tree 2 stands like tree 1: the median of what azimuths of common
  edges differ by. [rad]

  Edges count with their length and with how far they are from upright. Wood that stays where it is
  agrees exactly; what bent, grew or was matched by chance does not move the median as long as it is
  the smaller part.
*/
inline double refine_yaw(const std::array<const Rooted_tree*, 2>& trees,
                         const Common_topology& topology,
                         const Vec3& up,
                         double turn)
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
    differences.emplace_back(std::remainder(angle - turn, 2 * pi), weight);
    total += weight;
  }
  std::sort(differences.begin(), differences.end());
  double sum = 0;
  for (const auto& [difference, weight] : differences)
    if ((sum += weight) >= 0.5 * total)
      return std::remainder(turn + difference, 2 * pi);
  return turn;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_EMBEDDING_REFINE_YAW_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees of a family from coordinates, for means, modes, samples and growth.

#ifndef PCS_SHAPE_SPACE_STATISTICS_MAKE_TREE_H
#define PCS_SHAPE_SPACE_STATISTICS_MAKE_TREE_H

#include <pcs/core/errors.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/path/Tree_state.h>
#include <pcs/shape_space/statistics/Modes_of_variation.h>
#include <pcs/shape_space/statistics/Tangent_space.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Returns the parameter of the nearest tree on the geodesic of a family of two trees, in [0, 1].
/// [-]
inline double project_on_geodesic(const Tree_family& family, const Orl_coordinates& x)
{
  const Tangent_space tangent(family.layout, family.x[0], family.weights);
  const Eigen::VectorXd path = tangent.log(family.x[1]);
  const double length = path.squaredNorm();
  return length > 0 ? std::min(1.0, std::max(0.0, tangent.log(x).dot(path) / length)) : 0;
}

/// Returns `t` moved by `step` times the tangent vector from `a` to `b`; rotations are transported
/// in the frames of the edges themselves.
inline Orl_coordinates parallel_displacement(const Tree_family& family,
                                             const Orl_coordinates& t,
                                             const Orl_coordinates& a,
                                             const Orl_coordinates& b,
                                             double step)
{
  const Tangent_space from(family.layout, a, family.weights), at(family.layout, t, family.weights);
  Orl_coordinates x = at.exp(step * from.log(b));
  x.root = t.root + step * (b.root - a.root);
  return x;
}

/// Returns the tree with given scores; missing ones are 0.
inline Orl_coordinates tree_of_modes(const Orl_layout& layout,
                                     const Orl_weights& weights,
                                     const Modes_of_variation& modes,
                                     const std::vector<double>& scores)
{
  const Tangent_space tangent(layout, modes.mean, weights);
  Eigen::VectorXd z = modes.center;
  for (std::size_t k = 0; k < scores.size() && k < modes.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    z += scores[k] * modes.deviations[i] * modes.directions.col(i);
  }
  return tangent.exp(z);
}

/// Makes the tree with coordinates `x`. If `lambda` is negative, it is found by projection on the
/// geodesic of two trees. Negative `scan_weights` become 0: details of points are not extrapolated.
inline Tree_state make_tree(const Tree_family& family,
                            Orl_coordinates x,
                            double lambda = -1,
                            std::vector<double> scan_weights = std::vector<double>())
{
  Tree_state result;
  const bool is_pair = family.x.size() == 2;
  for (double& w : scan_weights)
    w = std::max(0.0, w);
  if (!is_pair)
    result.scan_weights = std::move(scan_weights);
  result.x = std::move(x);
  result.lambda = lambda >= 0 ? lambda : is_pair ? project_on_geodesic(family, result.x) : 0;
  build_geometry(family.layout, result.x, family.orientation, result.geometry);
  for (const Vec3& p : result.geometry.node)
    if (!p.allFinite())
      throw Invalid_input("pcs::Orl_shape_space: a step, weight or score leads to lengths that are "
                          "no finite numbers");
  family.find_offsets(result.x, result.first_point);
  return result;
}

/// Sets the scan weights of a tree that is a weighted mean of others.
inline void mix_scan_weights(const Tree_family& family,
                             const std::vector<const Tree_state*>& trees,
                             const std::vector<double>& weights,
                             Tree_state& result)
{
  const std::size_t n = family.x.size();
  if (n == 2)
    return;
  result.scan_weights.assign(n, 0);
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const std::vector<double>& of_tree = trees[i]->scan_weights;
    double sum = 0;
    for (const double w : of_tree)
      sum += w;
    for (std::size_t h = 0; h < n; ++h)
      result.scan_weights[h] +=
          weights[i] * (of_tree.empty() ? 1 / static_cast<double>(n) : of_tree[h] / sum);
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_MAKE_TREE_H

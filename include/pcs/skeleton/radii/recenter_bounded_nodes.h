// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Re-centring of axis nodes whose radius was bounded.

#ifndef PCS_SKELETON_RADII_RECENTER_BOUNDED_NODES_H
#define PCS_SKELETON_RADII_RECENTER_BOUNDED_NODES_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Index_groups.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria and weights for re-centring bounded nodes.
struct Recentering_options
{
  //! least mean distance of the points outside the surface, in units of the noise [-],
  double apart = 3;
  double one_side = 0.85; ///< ... least length of the mean of their normals [-],
  double fewest = 3;      ///< ... and least sum of their weights [count]
  std::size_t reach = 3;  ///< nodes on both sides whose points count [count]
  double far = 3;         ///< distance of weight 1/2, in radii of the fit [-]
  double hold = 0.05;     ///< weight of the previous position, relative to the points [-]
  int rounds = 3;
};

namespace internal {

/// Fits the lateral position of an axis by least squares of the distances of points from its
/// surface.
class Axis_place_fit
{
public:
  Axis_place_fit(const Vec3& along, double radius, double far)
    : m_along(along), m_radius(radius), m_far(far)
  {
  }

  void add(const Vec3& offset)
  {
    const Vec3 across = offset - offset.dot(m_along) * m_along;
    const double distance = across.norm();
    if (!(distance > 0))
      return;
    const Vec3 normal = across / distance;
    const double weight = 1 / (1 + (distance / m_far) * (distance / m_far));
    m_weight += weight;
    m_normals += weight * normal;
    m_apart += weight * (distance - m_radius);
    m_matrix += weight * normal * normal.transpose();
    m_right += weight * (distance - m_radius) * normal;
  }

  bool is_far_on_one_side(double noise, const Recentering_options& rules) const
  {
    return m_weight >= rules.fewest && m_apart > rules.apart * noise * m_weight &&
           m_normals.norm() > rules.one_side * m_weight;
  }
  /// Returns the displacement of the axis. Requires at least one point.
  Vec3 move(double hold) const
  {
    const Eigen::Matrix3d matrix = m_matrix + hold * m_weight * Eigen::Matrix3d::Identity();
    Vec3 displacement;
    linear_algebra::solve_symmetric(matrix, m_right, displacement);
    return displacement;
  }

private:
  Vec3 m_along;
  double m_radius, m_far, m_weight = 0, m_apart = 0;
  Vec3 m_normals = Vec3::Zero(), m_right = Vec3::Zero();
  Eigen::Matrix3d m_matrix = Eigen::Matrix3d::Zero();
};

} // namespace internal

/*!
  Re-centres nodes whose radius was bounded. With points on one side of a branch, the fitted circle
  may be far too large, with its centre far behind the points. If its radius was bounded afterwards
  (`before` has the fitted radii), the node moves back to its points. Returns the number of moved
  nodes. O(points).
*/
inline std::size_t recenter_bounded_nodes(const Scan& scan,
                                          const std::vector<double>& before,
                                          double noise,
                                          const Recentering_options& rules,
                                          Branch_tree& tree)
{
  const std::size_t n = tree.nodes.size();
  std::vector<std::uint8_t> is_moving(n, 0);
  for (Index v = 0; v < n; ++v)
    is_moving[v] = !tree.is_base(v) && tree.nodes[v].radius < before[v];
  const auto count = [&] {
    return static_cast<std::size_t>(std::count(is_moving.begin(), is_moving.end(), 1));
  };
  if (count() == 0)
    return 0;
  const Index_groups points(tree.nodes.size(), tree.node_of_point);
  std::vector<Vec3> moves(n);
  for (int round = 0; round < rules.rounds; ++round) {
    std::fill(moves.begin(), moves.end(), Vec3::Zero());
    for (const Branch& branch : tree.branches)
      for (std::size_t k = 0; k < branch.nodes.size(); ++k) {
        const Index v = branch.nodes[k];
        if (!is_moving[v])
          continue;
        const std::size_t begin = k > rules.reach ? k - rules.reach : 0;
        const std::size_t end = std::min(branch.nodes.size(), k + rules.reach + 1);
        const Vec3 chord =
            tree.nodes[branch.nodes[end - 1]].point - tree.nodes[branch.nodes[begin]].point;
        internal::Axis_place_fit fit(chord.stableNormalized(),
                                     tree.nodes[v].radius,
                                     rules.far * before[v]);
        for (std::size_t j = begin; j < end; ++j) {
          const Index w = branch.nodes[j];
          for (const Index i : points[w])
            fit.add(scan.points[i] - tree.nodes[w].point);
        }
        if (round == 0 && !fit.is_far_on_one_side(noise, rules))
          is_moving[v] = 0;
        else
          moves[v] = fit.move(rules.hold);
      }
    for (Index v = 0; v < n; ++v) // bases of branches coincide with their parent nodes
      tree.nodes[v].point += moves[v != 0 && tree.is_base(v) ? tree.nodes[v].parent : v];
  }
  return count();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_RECENTER_BOUNDED_NODES_H

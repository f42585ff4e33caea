// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ellipse fit of cross-sections that are visible from nearly all sides.

#ifndef PCS_SKELETON_RADII_FIT_SECTION_ELLIPSES_H
#define PCS_SKELETON_RADII_FIT_SECTION_ELLIPSES_H

#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Index_groups.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for elliptical sections.
struct Section_ellipse_options
{
  std::size_t lowest_count = 20; ///< least number of points [count]
  int sectors = 10;              ///< least number of sectors, of 12, with points [count]
  double significance = 4;       ///< difference of the semi-axes, in standard deviations [-]
  double thickness = 3;          ///< smallest radius, in units of the noise [-]
};

/*!
  Fits the second harmonic of the distance from the axis: `r (1 + c cos 2a + s sin 2a)`. Open arcs
  do not determine the five parameters of an ellipse; their sections remain circles. The ellipse has
  the area of the circle with the radius of the node.
*/
template <class ConcurrencyTag>
void fit_section_ellipses(const Scan& scan,
                          double noise,
                          const Section_ellipse_options& rules,
                          Branch_tree& tree)
{
  const std::size_t n = tree.nodes.size();
  const Index_groups points(n, tree.node_of_point);
  std::vector<Index> successor(n, none);
  for (Index v = 0; v < n; ++v)
    if (!tree.is_base(v))
      successor[tree.nodes[v].parent] = v;
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t k) {
    Branch_node& node = tree.nodes[k];
    const Index v = static_cast<Index>(k), w = successor[v];
    if (w == none || tree.is_base(v) || points[v].size() < rules.lowest_count ||
        node.radius < rules.thickness * noise)
      return;
    const Vec3 step = tree.nodes[w].point - node.point;
    if (!(step.norm() > 0))
      return;
    const Vec3 along = step.normalized(), e1 = along.unitOrthogonal(), e2 = along.cross(e1);
    std::vector<Vec2> plane;
    for (const Index i : points[v]) {
      const Vec3 d = scan.points[i] - node.point;
      const Vec2 q(d.dot(e1), d.dot(e2));
      if (std::abs(q.norm() - node.radius) < std::max(4 * noise, 0.3 * node.radius))
        plane.push_back(q);
    }
    if (plane.size() < rules.lowest_count || covered_sectors(plane, Vec2::Zero()) < rules.sectors)
      return;
    // mean, first harmonic (an offset of the centre) and second harmonic (the oval)
    Eigen::Matrix<double, 5, 5> a = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> b = Eigen::Matrix<double, 5, 1>::Zero();
    double square = 0;
    for (const Vec2& q : plane) {
      const double r = q.norm(), c = q.x() / r, s = q.y() / r;
      Eigen::Matrix<double, 5, 1> f;
      f << 1, c, s, c * c - s * s, 2 * c * s;
      a += f * f.transpose();
      b += f * r;
      square += r * r;
    }
    Eigen::Matrix<double, 5, 1> x;
    if (!linear_algebra::solve_symmetric(a, b, x))
      return;
    const double count = double(plane.size());
    const double variance = std::max(0.0, square - x.dot(b)) / (count - 5);
    const double size = std::hypot(x(3), x(4)), error = std::sqrt(2 * variance / count);
    if (!std::isfinite(size) || size < rules.significance * error || size > 0.5 * node.radius)
      return;
    const double angle = 0.5 * std::atan2(x(4), x(3));
    node.set_ellipse((1 + size / node.radius) / (1 - size / node.radius),
                     std::cos(angle) * e1 + std::sin(angle) * e2);
  });
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_FIT_SECTION_ELLIPSES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Projection of a random tree to the range of the family in branch angles and size.

#ifndef PCS_SHAPE_SPACE_STATISTICS_PROJECT_TO_RANGE_H
#define PCS_SHAPE_SPACE_STATISTICS_PROJECT_TO_RANGE_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/constants.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

struct Figure_range
{
  double low = std::numeric_limits<double>::infinity(), high = 0;

  void add(double x)
  {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double nearest(double x) const { return low > high ? x : std::min(high, std::max(low, x)); }
};

/*!
  Changes angles in [0, pi] so that their mean and standard deviation are in ranges, by the shift
  and factor with the least sum of squared changes; angles are limited to [0, pi].
*/
inline void
limit_moments(const Figure_range& mean, const Figure_range& deviation, std::vector<double>& angles)
{
  constexpr double pi = pcs::internal::pi;
  constexpr int number_of_passes = 50; // one is enough, unless angles reach a limit
  const auto n = static_cast<double>(angles.size());
  for (int pass = 0; pass < number_of_passes; ++pass) {
    double m = 0, square = 0;
    for (const double a : angles)
      m += a / n;
    for (const double a : angles)
      square += (a - m) * (a - m) / n;
    const double s = std::sqrt(square), to = mean.nearest(m), wide = deviation.nearest(s);
    if (to == m && wide == s)
      return;
    for (double& a : angles)
      a = std::min(pi, std::max(0.0, to + (s > 0 ? wide / s : 1) * (a - m)));
  }
}

} // namespace internal

/// Brings mean and standard deviation of the angles of branches, by order, into the range of
/// others: rotates each branch with its subtree towards its parent or away from it.
inline void limit_angles(const Orl_layout& layout,
                         Orl_orientation kind,
                         const std::vector<Tree_descriptors>& others,
                         Orl_coordinates& x)
{
  const std::vector<std::size_t> order = orders_of_branches(layout, x);
  std::size_t orders = 0;
  for (const std::size_t k : order)
    orders = std::max(orders, k == none ? 0 : k + 1);
  Orl_geometry geometry;
  for (std::size_t k = 1; k < orders; ++k) {
    internal::Figure_range mean, deviation;
    for (const Tree_descriptors& f : others)
      if (k < f.mean_angle.size()) {
        mean.add(f.mean_angle[k]);
        deviation.add(f.angle_deviation[k]);
      }
    build_geometry(layout, x, kind, geometry);
    std::vector<std::size_t> of_order;
    std::vector<double> angles;
    const auto axis = [&](std::size_t e) { return Vec3(geometry.frame[e] * Vec3::UnitZ()); };
    for (std::size_t b = 0; b < order.size(); ++b)
      if (order[b] == k) {
        const Vec3 parent = axis(layout.branches[b].reference_edge),
                   own = axis(layout.branches[b].first_edge);
        of_order.push_back(b);
        angles.push_back(std::atan2(parent.cross(own).norm(), parent.dot(own)));
      }
    const std::vector<double> drawn = angles;
    internal::limit_moments(mean, deviation, angles);
    for (std::size_t i = 0; i < of_order.size(); ++i) {
      if (angles[i] == drawn[i])
        continue;
      const std::size_t e = layout.branches[of_order[i]].first_edge,
                        p = layout.branches[of_order[i]].reference_edge;
      const Vec3 across = axis(p).cross(axis(e));
      constexpr double straight = 1e-9; // below: rotated in an arbitrary but fixed direction
      const Vec3 about = across.norm() > straight ? Vec3(across.normalized())
                                                  : Vec3(geometry.frame[p] * Vec3::UnitX());
      const Quaternion turned =
          Quaternion(Eigen::AngleAxisd(angles[i] - drawn[i], about)) * geometry.frame[e];
      x.orientation[e] = relative(kind, geometry.frame[p], turned);
      x.orientation[e].normalize();
    }
  }
}

/// Brings height, crown width and total length into the range of other trees as far as possible.
/// Scales the trunk until the height is in range, then the branches on it for the crown width, and
/// all other branches for the total length.
inline void limit_lengths(const Orl_layout& layout,
                          Orl_orientation kind,
                          const Vec3& up,
                          const std::vector<Tree_descriptors>& others,
                          Orl_coordinates& x)
{
  constexpr int number_of_passes = 8;
  internal::Figure_range height, width, length;
  for (const Tree_descriptors& f : others) {
    height.add(f.height);
    width.add(f.crown_width);
    length.add(f.length);
  }
  const std::vector<std::size_t> order = orders_of_branches(layout, x);
  Orl_geometry geometry;
  for (int pass = 0; pass < number_of_passes; ++pass) {
    build_geometry(layout, x, kind, geometry);
    const Tree_descriptors f = measure(layout, x, geometry, up);
    double of_order[3] = {0, 0, 0}; // the trunk, branches on it, all others
    const auto kind_of = [&](std::size_t b) { return std::min<std::size_t>(2, order[b]); };
    const auto for_each_edge = [&](const auto& visit) {
      for (std::size_t b = 0; b < order.size(); ++b)
        for (std::size_t j = 0; order[b] != none && j < layout.branches[b].number_of_edges; ++j)
          visit(x.length[layout.branches[b].first_edge + j], kind_of(b));
    };
    for_each_edge([&](double& l, std::size_t k) { of_order[k] += l; });
    const auto ratio = [](double to, double is) { return is > 0 ? to / is : 1; };
    double factor[3] = {ratio(height.nearest(f.height), f.height),
                        ratio(width.nearest(f.crown_width), f.crown_width),
                        1};
    // all others take the remaining length, limited to plausible factors
    const double rest =
        length.nearest(f.length) - factor[0] * of_order[0] - factor[1] * of_order[1];
    factor[2] = std::min(1.5, std::max(0.67, ratio(rest, of_order[2])));
    if (factor[0] == 1 && factor[1] == 1 && length.nearest(f.length) == f.length)
      return;
    for_each_edge([&](double& l, std::size_t k) { l *= factor[k]; });
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_PROJECT_TO_RANGE_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One-sided visibility of sections: mean normals, and priors of center and radius.

#ifndef PCS_SKELETON_AXES_SECTION_VISIBILITY_H
#define PCS_SKELETON_AXES_SECTION_VISIBILITY_H

#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/Chain_options.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Number and means of the points near the surface, in a window of nodes about each node.
struct Section_visibility
{
  std::vector<double> count;
  std::vector<Vec3> offset; ///< mean vector from the axis to its points [L]
  std::vector<Vec3> normal; ///< mean of the outward normals of the points
  //! second moments of the offsets, near thin sections only [L^2]
  std::vector<Eigen::Matrix3d> moment;

  Section_visibility(const Chain_view& view, const Axis_fit& fit)
    : count(fit.axis().size(), 0),
      offset(count.size(), Vec3::Zero()),
      normal(count.size(), Vec3::Zero()),
      moment(count.size(), Eigen::Matrix3d::Zero())
  {
    const Axis& axis = fit.axis();
    const std::size_t n = axis.size();
    // second moments are costly, and computed only near the thin sections of `add_width_priors()`
    std::vector<char> is_thin(n, false);
    for (std::size_t k = 0; k < n; ++k)
      if (axis[k].radius < view.rules.width_radius * view.scan.spacing)
        std::fill(is_thin.begin() + std::ptrdiff_t(k >= 2 ? k - 2 : 0),
                  is_thin.begin() + std::ptrdiff_t(std::min(n, k + 3)),
                  true);
    std::vector<Sums> own(n, Sums{});
    for (std::size_t i = 0; i < fit.places().size(); i += fit.stride()) {
      const Axis_place& p = fit.places()[i];
      const double r = radius_at(axis, p);
      const double limit = tukey_constant * std::max(view.set.noise, 0.04 * r);
      if (p.share < 0 || p.share > 1 || std::abs(p.distance - r) > limit || !(p.distance > 0))
        continue;
      const Vec3 d = fit.points()[i] - point_at(axis, p), outward = d / p.distance;
      own[p.segment].add(1 - p.share, d, outward, is_thin[p.segment]);
      own[p.segment + 1].add(p.share, d, outward, is_thin[p.segment + 1]);
    }
    for (std::size_t k = 0; k < n; ++k) {
      Sums sums{};
      for (std::size_t i = k >= 2 ? k - 2 : 0; i < std::min(n, k + 3); ++i)
        for (std::size_t m = 0; m < sums.values.size(); ++m)
          sums.values[m] += own[i].values[m];
      const std::array<double, 13>& v = sums.values;
      if (!(v[0] > 0))
        continue;
      count[k] = v[0];
      offset[k] = Vec3(v[1], v[2], v[3]) / v[0];
      normal[k] = Vec3(v[4], v[5], v[6]) / v[0];
      moment[k] << v[7], v[8], v[9], v[8], v[10], v[11], v[9], v[11], v[12];
      moment[k] /= v[0];
    }
  }

  /// Returns the standard deviation of the points perpendicular to the axis and to their mean
  /// normal [L].
  double width(const Axis& axis, std::size_t k) const
  {
    const Vec3 chord = axis[std::min(axis.size() - 1, k + 1)].point - axis[k > 0 ? k - 1 : 0].point;
    const Vec3 across = chord.cross(normal[k]).normalized();
    const double mean = offset[k].dot(across);
    return std::sqrt(std::max(0.0, across.dot(moment[k] * across) - mean * mean));
  }

private:
  /// Sums of weights, offsets, normals, and the upper triangle of the products of the offsets.
  struct Sums
  {
    std::array<double, 13> values;

    void add(double w, const Vec3& d, const Vec3& n, bool has_products)
    {
      const double first[7] = {1, d.x(), d.y(), d.z(), n.x(), n.y(), n.z()};
      for (std::size_t m = 0; m < 7; ++m)
        values[m] += w * first[m];
      if (!has_products)
        return;
      const double products[6] = {d.x() * d.x(),
                                  d.x() * d.y(),
                                  d.x() * d.z(),
                                  d.y() * d.y(),
                                  d.y() * d.z(),
                                  d.z() * d.z()};
      for (std::size_t m = 0; m < 6; ++m)
        values[7 + m] += w * products[m];
    }
  };
};

/*!
  Returns priors of the centers of thin sections: their points are expected on the visible side,
  which is known from thick branches. Otherwise, the points of a thin branch with one-sided
  visibility fit axes in front of, within and behind them nearly equally well.
*/
inline std::vector<Center_prior>
center_priors(const Chain_view& view, const Axis& axis, const Section_visibility& sides)
{
  if (!view.set.facing_field.is_known())
    return {};
  std::vector<Center_prior> priors(axis.size());
  for (std::size_t k = 0; k < axis.size(); ++k)
    if (sides.count[k] >= 1 && axis[k].radius < view.rules.thick * view.scan.spacing)
      priors[k] = {axis[k].point + sides.offset[k],
                   view.set.visibility_at(axis, k),
                   view.rules.facing_share * view.set.facing_field.deviation() * axis[k].radius +
                       view.rules.facing_noise * view.set.noise};
  return priors;
}

/*!
  Adds priors of radii by the width of the points, for sections with one-sided visibility. A scanner
  samples the visible side uniformly across its beams, so that positions perpendicular to the line
  of sight are uniformly distributed over a diameter: their standard deviation is r / sqrt(3). This
  depends neither on the density, which varies, nor on the curvature, which noise hides. The result
  is combined with `priors` by precision. O(nodes).
*/
inline void add_width_priors(const Chain_view& view,
                             const Axis& axis,
                             const Section_visibility& sides,
                             std::vector<Radius_prior>& priors)
{
  const Chain_options& rules = view.rules;
  for (std::size_t k = 0; k < axis.size(); ++k) {
    if (sides.count[k] < rules.width_count || !(sides.normal[k].norm() > rules.width_one_sided) ||
        !(axis[k].radius < rules.width_radius * view.scan.spacing))
      continue;
    Radius_prior width;
    width.radius = rules.width_factor * sides.width(axis, k);
    width.deviation = rules.width_share * width.radius + rules.width_noise * view.set.noise;
    if (!(width.deviation > 0))
      continue;
    width.measured = 1 / (width.deviation * width.deviation);
    priors[k] = joined(priors[k], width);
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_SECTION_VISIBILITY_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Point counts and visible fractions of the sections of an axis.

#ifndef PCS_SKELETON_AXES_SECTION_COUNTS_H
#define PCS_SKELETON_AXES_SECTION_COUNTS_H

#include <pcs/internal/constants.h>
#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/Chain_options.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Sums over a window of nodes about each node.
struct Section_counts
{
  std::vector<double> count;          ///< points near the surface
  std::vector<double> length;         ///< of the axis [L]
  std::vector<double> visible_length; ///< the same, times the visible fraction of the section [L]

  /// Returns the radius for which the surface would have `density` points per area [L].
  double radius(std::size_t k, double density) const
  {
    return count[k] / (2 * pcs::internal::pi * density * visible_length[k]);
  }
  double density(std::size_t k, double radius) const
  {
    return count[k] / (2 * pcs::internal::pi * radius * visible_length[k]);
  }
};

/// Counts points near the surface. `visible`: visible fraction of the section at each node [-].
inline Section_counts
section_counts(const Chain_view& view, const Axis_fit& fit, const std::vector<double>& visible)
{
  const Axis& axis = fit.axis();
  const std::size_t n = axis.size();
  std::vector<double> own(n, 0), length(n, 0);
  const double limit = tukey_constant * view.set.noise;
  const double weight = double(fit.stride());
  for (std::size_t i = 0; i < fit.places().size(); i += fit.stride()) {
    const Axis_place& p = fit.places()[i];
    if (p.share < 0 || p.share > 1)
      continue;
    const double r = radius_at(axis, p);
    if (std::abs(p.distance - r) > std::max(limit, tukey_constant * 0.04 * r))
      continue;
    own[p.segment] += weight * (1 - p.share);
    own[p.segment + 1] += weight * p.share;
  }
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const double l = 0.5 * (axis[k + 1].point - axis[k].point).norm();
    length[k] += l;
    length[k + 1] += l;
  }
  Section_counts sums;
  sums.count.assign(n, 0);
  sums.length.assign(n, 0);
  sums.visible_length.assign(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t begin = k >= 2 ? k - 2 : 0, end = std::min(n, k + 3);
    for (std::size_t i = begin; i < end; ++i) {
      sums.count[k] += own[i];
      sums.length[k] += length[i];
      sums.visible_length[k] += visible[i] * length[i];
    }
  }
  return sums;
}

/*!
  Returns the visible fraction of the section at each node: the fraction outside of other axes. At
  the base of a branch, the interior of the parent has no points, and points on its surface are
  assigned to the parent. Sections with enough points count as visible. O(nodes log points).
*/
inline std::vector<double> visible_shares(const Chain_view& view, const Axis_fit& fit)
{
  const Axis& axis = fit.axis();
  const Chain_options& rules = view.rules;
  std::vector<double> shares(axis.size(), 1);
  if (view.set.axes.empty() || !(view.set.density > 0))
    return shares;
  const double u = view.scan.spacing;
  const Section_counts counts = section_counts(view, fit, shares);
  for (std::size_t k = 0; k < axis.size(); ++k) {
    const double r = axis[k].radius;
    if (counts.density(k, r) >= rules.counted_share * view.set.density_at(axis, k))
      continue;
    const double reach = rules.hiding_radius * r + rules.hiding_offset * u;
    const auto near = view.scan.search->nearest_if(axis[k].point, reach, [&](Index i) {
      return view.set.is_covered(i);
    });
    if (!(near.squared_distance < reach * reach))
      continue;
    const Axis& other = view.set.axes[view.set.axis_of_point[near.index]].axis;
    const Axis_place place =
        nearest_place(other, view.set.segment_of_point[near.index], axis[k].point);
    const double thick = radius_at(other, place);
    const double taken = thick + std::max(rules.cover_offset * u, rules.cover_factor * thick);
    // arc of the section inside of a disc of radius `taken`
    const double d = std::max(place.distance, 1e-9 * u);
    const double cosine = (d * d + r * r - taken * taken) / (2 * d * r);
    shares[k] = 1 - std::acos(std::min(1.0, std::max(-1.0, cosine))) / pcs::internal::pi;
  }
  return shares;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_SECTION_COUNTS_H

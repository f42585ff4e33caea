// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The volume that measured axes lack because a part of their surface is hidden.

#ifndef PCS_GENERATORS_HIDDEN_RADIUS_CORRECTION_H
#define PCS_GENERATORS_HIDDEN_RADIUS_CORRECTION_H

#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/hidden/Beam_visibility.h>
#include <pcs/generators/hidden/Hidden_branches.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcs {
namespace generators {
namespace hidden {

/*
  The ratio of the true and the measured volume of a piece, for its radius in steps of the beams,
  and the share of the beams that reach it. Radii that are thinner than a few steps are estimated
  from numbers of points, which are small where beams are intercepted. `is_one_sided`: a single
  station sees the axis; circles fitted to thick axes are then too large by 1 % of the radius.
  Fitted to 40 virtual scans, see doc/design/skeletons/hidden_wood.md.
*/
inline double volume_ratio(double steps, double visible, bool is_one_sided)
{
  constexpr double most = 2; // of the logarithm
  const double hidden = 2.1 * std::exp(-steps / 1.3) * (1 - visible);
  const double thin = is_one_sided ? 1.6 * std::exp(-steps / 0.16) : 0;
  const double thick = is_one_sided ? 0.025 * -std::expm1(-steps * steps / 9) : 0;
  return std::exp(std::min(most, hidden + thin - thick));
}

/// Volume that is added to measured axes, and that is taken from them; both are not negative.
struct Radius_correction
{
  double added = 0, removed = 0;
};

/// `pipe`: the tree with the least radii by the pipe model. The larger one of both changes counts.
inline Radius_correction correct_radii(const habit::Tree_sample& tree,
                                       const habit::Tree_sample& pipe,
                                       const Beam_visibility& visibility)
{
  const bool is_one_sided = visibility.number_of_stations() == 1;
  Radius_correction result;
  for (std::size_t k = 0; k < tree.axes.size(); ++k) {
    const habit::Axis &a = tree.axes[k], &thick = pipe.axes[k];
    for (std::size_t i = 1; i < a.at.size(); ++i) {
      const double r = (a.radius[i - 1] + a.radius[i]) / 2;
      const Vector3 p = (a.points[i - 1] + a.points[i]) / 2;
      const double ratio =
          volume_ratio(r / visibility.step_at(p), visibility.visible_share(p, r), is_one_sided);
      const double length = a.at[i] - a.at[i - 1];
      const double measured = frustum_volume(length, a.radius[i - 1], a.radius[i]);
      const double carrying = frustum_volume(length, thick.radius[i - 1], thick.radius[i]);
      const double change = carrying > measured
                                ? std::max((ratio - 1) * measured, carrying - measured)
                                : (ratio - 1) * measured;
      (change > 0 ? result.added : result.removed) += std::abs(change);
    }
  }
  return result;
}

} // namespace hidden
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HIDDEN_RADIUS_CORRECTION_H

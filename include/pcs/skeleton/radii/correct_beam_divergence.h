// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Correction of the radii of thin branches for beam divergence.

#ifndef PCS_SKELETON_RADII_CORRECT_BEAM_DIVERGENCE_H
#define PCS_SKELETON_RADII_CORRECT_BEAM_DIVERGENCE_H

#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options for the correction of radii for the beam width.
struct Beam_divergence_options
{
  double edge_share =
      0.5; ///< fraction of the beams with the centre outside the branch that yield a point [-]
  double shift =
      1.0 / 6; ///< mean distance of these points from the surface in the fit, in beam widths [-]
  double least = 0.25; ///< least corrected radius, as a fraction of the fitted one [-]
};

/*!
  Corrects the radii for beam divergence. A beam of width w also hits a branch of radius r if its
  centre passes outside by up to w / 2. If a fraction s of such beams yields a point, the fraction f
  = s w / (2 r + s w) of all points lies outside the branch, and the fit returns r + f w / 6. The
  function inverts this relation, with w at the distance of the nearest scanner. O(nodes *
  scanners).
*/
inline void correct_beam_divergence(const std::vector<Vec3>& scanners,
                                    double beam_width,
                                    const Beam_divergence_options& rules,
                                    Branch_tree& tree)
{
  for (Branch_node& node : tree.nodes) {
    double distance = std::numeric_limits<double>::infinity();
    for (const Vec3& s : scanners)
      distance = std::min(distance, (node.point - s).norm());
    const double w = beam_width * distance, found = node.radius;
    if (!std::isfinite(w) || !(w > 0))
      continue;
    // r + s w^2 / (6 (2 r + s w)) = found: increases with r in the relevant range, hence bisection
    double low = rules.least * found, high = found;
    for (int k = 0; k < 40; ++k) {
      const double r = 0.5 * (low + high);
      const double share = rules.edge_share * w / (2 * r + rules.edge_share * w);
      (r + rules.shift * share * w > found ? high : low) = r;
    }
    node.resize(0.5 * (low + high));
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_CORRECT_BEAM_DIVERGENCE_H

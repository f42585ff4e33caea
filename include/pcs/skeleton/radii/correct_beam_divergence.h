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

/// How much of the width of a beam is added to a radius.
struct Beam_divergence_options
{
  double edge_share =
      0.5; ///< of the beams that only their border meets, and that give a point nevertheless [-]
  double shift =
      1.0 /
      6; ///< by which such points lie outside on the average, weighted as in the fit, in widths [-]
  double least = 0.25; ///< share of the radius that is left at least [-]
};

/*!
  A beam of width w meets a branch of radius r also where its middle passes outside, up to w / 2: of
  all points the share f = s w / (2 r + s w) lies outside of the branch, where s of such beams give
  a point. The fit takes that for bark: it finds r + f w / 6. Inverts this with the distance of the
  nearest scanner. O(nodes * scanners).
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
    // r + s w^2 / (6 (2 r + s w)) = found: grows with r where it matters, so bisection
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

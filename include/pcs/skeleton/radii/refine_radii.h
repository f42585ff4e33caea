// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Radii of all nodes: bounds, trunk base, re-centring, beam divergence and voxel size.

#ifndef PCS_SKELETON_RADII_REFINE_RADII_H
#define PCS_SKELETON_RADII_REFINE_RADII_H

#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/radii/bound_radii.h>
#include <pcs/skeleton/radii/correct_beam_divergence.h>
#include <pcs/skeleton/radii/correct_voxel_size.h>
#include <pcs/skeleton/radii/fit_branch_ovals.h>
#include <pcs/skeleton/radii/fit_section_ellipses.h>
#include <pcs/skeleton/radii/measure_given.h>
#include <pcs/skeleton/radii/rebuild_trunk_base.h>
#include <pcs/skeleton/radii/recenter_bounded_nodes.h>

#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the radius refinement.
struct Radius_options
{
  Support_options support;
  Recentering_options recentering;
  Trunk_base_options trunk_base;
  Section_ellipse_options sections;
  Branch_oval_options ovals;
  Given_skeleton_options given;
  Beam_divergence_options beam;
  Voxel_size_options voxels;
};

/*!
  Bounds radii without point support, rebuilds the trunk base, and re-centres the nodes that were
  bounded. Nothing is minimised over all nodes; the stages are, in this order,

  1. `bound_radii()`: `r <= b` for every radius `r` [L], with the bound `b` [L] from the supported
     sections and the pipe model;
  2. `rebuild_trunk_base()`: below the lowest confirmed part of the trunk, `r^2` is the mean over
     equal sectors of the squared median distance [L^2] of their points from the center;
  3. `recenter_bounded_nodes()`: in each of a few rounds, a node whose radius was reduced from `r_0`
     to `r` [L], and whose points lie far outside on one side, moves by the vector `y` [L].

  With the distances `x_i` [L] of the points around the node from the axis, their outward normals
  `n_i` [-] and the sum `W` of all `w_i`, `y` minimises

      sum_i w_i (n_i . y - x_i + r)^2 + hold W |y|^2,   w_i = 1 / (1 + (x_i / (far r_0))^2).

  Bounded nodes count as inferred. O(points + nodes), without the pipe model.
*/
template <class ConcurrencyTag>
void refine_radii(const Scan& scan,
                  const std::vector<std::uint8_t>& is_used,
                  const Axis_set& axes,
                  const Radius_options& options,
                  Branch_tree& tree)
{
  const Section_support support =
      support_of_sections<ConcurrencyTag>(scan, tree, axes.noise, options.support);
  std::vector<double> fitted;
  for (const Branch_node& node : tree.nodes)
    fitted.push_back(node.radius);
  bound_radii(scan, support, axes.density, options.support, tree);
  rebuild_trunk_base(scan,
                     is_used,
                     support,
                     axes.density,
                     options.support,
                     options.trunk_base,
                     tree);
  recenter_bounded_nodes(scan, fitted, axes.noise, options.recentering, tree);
}

/*!
  Corrects the radii for beam divergence and voxel size. Returns the voxel size, or 0 [L].

  A fitted radius `F` [L] is replaced by the solution `r` [L] of

      r + s w^2 / (6 (2 r + s w)) = F   for the beam width w [L] at the nearest scanner,
      r^2 + 0.3 h^2 = F^2               for voxels of size h [L],

  one after the other, with the fraction `s` [-] of grazing beams that yield a point. The solutions
  are at least 0.25 F and 0.6 F. O(nodes * scanners).
*/
inline double correct_widening(const Scan& scan,
                               const std::vector<Vec3>& scanners,
                               double beam_width,
                               const Radius_options& options,
                               Branch_tree& tree)
{
  correct_beam_divergence(scanners, beam_width, options.beam, tree);
  const double size = voxel_size(scan, options.voxels);
  correct_voxel_size(size, options.voxels, tree);
  return size;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_REFINE_RADII_H

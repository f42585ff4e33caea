// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Changes of each branch between two dates.

#ifndef PCS_SHAPE_SPACE_MEASURES_CHANGE_TABLE_H
#define PCS_SHAPE_SPACE_MEASURES_CHANGE_TABLE_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// A branch at two dates.
struct Branch_change
{
  std::size_t branch = none; ///< of the topology
  std::size_t parent = none; ///< branch of the topology, `none` for the trunk
  std::size_t order = 0;     ///< 0 for the trunk
  bool is_new = false, is_lost = false;
  bool is_longer = false, is_shorter = false, is_thicker = false, is_thinner = false;
  bool is_turned = false;
  double length[2] = {0, 0}; ///< at either date [L]
  double radius[2] = {0, 0}; ///< mean along the branch [L]
  double angle = 0; ///< of rotation relative to the parent, at the base; 0 if new or lost [rad]
};

/// Lists every branch that at least one of two trees has, parents first. The angle of the trunk
/// refers to the axes of the input.
inline std::vector<Branch_change> find_changes(const Orl_layout& layout,
                                               const Orl_coordinates& before,
                                               const Orl_coordinates& after,
                                               Orl_orientation kind,
                                               const Change_limits& limits)
{
  std::vector<Branch_change> result;
  std::vector<std::size_t> order(layout.branches.size(), 0);
  std::array<Orl_geometry, 2> geometry;
  build_geometry(layout, before, kind, geometry[0]);
  build_geometry(layout, after, kind, geometry[1]);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    Branch_change c;
    c.branch = b;
    c.parent = branch.parent;
    c.order = order[b] = branch.parent == none ? 0 : order[branch.parent] + 1;
    const Orl_coordinates* trees[2] = {&before, &after};
    for (int t = 0; t < 2; ++t) {
      const Orl_coordinates& x = *trees[t];
      double area = 0, from = x.base_radius[b];
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        c.length[t] += x.length[e];
        area += x.length[e] * 0.5 * (from + x.radius[e]);
        from = x.radius[e];
      }
      c.radius[t] = c.length[t] > 0 ? area / c.length[t] : 0;
    }
    if (!(c.length[0] > 0) && !(c.length[1] > 0))
      continue;
    c.is_new = !(c.length[0] > 0);
    c.is_lost = !(c.length[1] > 0);
    if (!c.is_new && !c.is_lost) {
      const double longer = std::max(c.length[0], c.length[1]);
      const double thicker = std::max(c.radius[0], c.radius[1]);
      c.is_longer = c.length[1] - c.length[0] > limits.length * longer;
      c.is_shorter = c.length[0] - c.length[1] > limits.length * longer;
      c.is_thicker = c.radius[1] - c.radius[0] > limits.radius * thicker;
      c.is_thinner = c.radius[0] - c.radius[1] > limits.radius * thicker;
      const std::size_t e = branch.first_edge;
      const auto direction = [&](const Orl_geometry& g) { // in the frame of the parent
        const Vec3 z = g.frame[e] * Vec3::UnitZ();
        const std::size_t p = branch.reference_edge;
        return p == none ? z : Vec3(g.frame[p].conjugate() * z);
      };
      const Vec3 a = direction(geometry[0]), z = direction(geometry[1]);
      c.angle = std::atan2(a.cross(z).norm(), a.dot(z));
      c.is_turned = c.angle > limits.angle;
    }
    result.push_back(c);
  }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MEASURES_CHANGE_TABLE_H

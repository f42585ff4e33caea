// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Voxel thinning: one point per cube.

#ifndef PCS_SKELETON_FOREST_THINNED_POINTS_H
#define PCS_SKELETON_FOREST_THINNED_POINTS_H

#include <pcs/neighborhood/spatial_order.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Keeps one point per voxel, and maps each input point to it. The result does not depend on the
/// order of the input.
struct Thinned_points
{
  std::vector<Vec3> points;
  std::vector<Index> of_input;

  Thinned_points(const std::vector<Vec3>& input, double side) : of_input(input.size())
  {
    Vec3 low = input.front(), high = low;
    for (const Vec3& p : input) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const double cell = std::max(side, 1e-15 * (high - low).maxCoeff()); // prevents index overflow
    struct Entry
    {
      std::array<std::int64_t, 3> cube;
      Index point;
    };
    std::vector<Entry> entries(input.size());
    for (Index i = 0; i < entries.size(); ++i) {
      const Vec3 q = (input[i] - low) / cell;
      entries[i] = {{static_cast<std::int64_t>(q.x()),
                     static_cast<std::int64_t>(q.y()),
                     static_cast<std::int64_t>(q.z())},
                    i};
    }
    std::sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
      return a.cube != b.cube
                 ? a.cube < b.cube
                 : neighborhood::lexicographically_less(input[a.point], input[b.point]);
    });
    for (std::size_t k = 0; k < entries.size(); ++k) {
      if (k == 0 || entries[k].cube != entries[k - 1].cube)
        points.push_back(input[entries[k].point]);
      of_input[entries[k].point] = static_cast<Index>(points.size() - 1);
    }
  }
};

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_THINNED_POINTS_H

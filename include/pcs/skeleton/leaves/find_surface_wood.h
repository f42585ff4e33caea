// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detection of the points on thick wood, which has hollow sections.

#ifndef PCS_SKELETON_LEAVES_FIND_SURFACE_WOOD_H
#define PCS_SKELETON_LEAVES_FIND_SURFACE_WOOD_H

#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for sections of thick wood.
struct Surface_wood_options
{
  double thinnest = 1.3;  ///< least radius, in spacings [-]
  double depth = 0.3;     ///< least depth of inside points below the surface, in radii [-]
  double depth_noise = 2; ///< least depth of inside points, in units of the noise [-]
  double filled = 0.1;    ///< largest fraction of points inside a hollow section [-]
  double expected = 0.3;  ///< least number of surface points, relative to the expected number [-]
  double fewest = 12;     ///< least number of surface points [count]
  std::size_t reach = 3;  ///< nodes included on both sides [count]
  double share = 0.5; ///< least hollow fraction of a length from the base that is entirely wood [-]
};

namespace internal {

/// Classifies the segments of an axis as thick wood or not by the numbers of points on and inside
/// each segment.
inline std::vector<std::uint8_t> hollow_segments(const Axis_set& set,
                                                 const Axis& axis,
                                                 const std::vector<double>& on,
                                                 const std::vector<double>& inside,
                                                 double spacing,
                                                 const Surface_wood_options& rules)
{
  const std::size_t n = axis.size() - 1;
  std::vector<double> expected(n), length(n);
  for (std::size_t k = 0; k < n; ++k) {
    length[k] = (axis[k + 1].point - axis[k].point).norm();
    expected[k] = 2 * pcs::internal::pi * axis[k].radius * length[k] * set.density_at(axis, k);
  }
  std::vector<std::uint8_t> is_wood(n, 0);
  double all = 0, hollow = 0;
  std::size_t last = 0; // end of the predominantly hollow length
  for (std::size_t k = 0; k < n; ++k) {
    double a = 0, b = 0, e = 0;
    for (std::size_t j = k - std::min(k, rules.reach); j < std::min(n, k + rules.reach + 1); ++j) {
      a += on[j];
      b += inside[j];
      e += expected[j];
    }
    is_wood[k] = axis[k].radius >= rules.thinnest * spacing && a >= rules.fewest &&
                 b <= rules.filled * (a + b) && a >= rules.expected * e;
    all += length[k];
    hollow += is_wood[k] ? length[k] : 0;
    if (is_wood[k] && hollow >= rules.share * all)
      last = k;
  }
  std::fill(is_wood.begin(), is_wood.begin() + static_cast<std::ptrdiff_t>(last), 1);
  return is_wood;
}

/// Marks the parent of each mostly hollow axis as wood, from the base of the parent to the joint.
inline void add_carriers(const Axis_set& set,
                         const Surface_wood_options& rules,
                         std::vector<std::vector<std::uint8_t>>& is_wood)
{
  for (std::size_t a = set.axes.size(); a-- > 0;) { // parents come first
    const std::vector<std::uint8_t>& own = is_wood[a];
    const auto count = std::count(own.begin(), own.end(), std::uint8_t(1));
    const Index parent = set.axes[a].parent;
    if (parent == none || double(count) < rules.share * double(own.size()))
      continue;
    const Axis_place seat = nearest_place(set.axes[parent].axis, set.axes[a].axis.front().point);
    std::fill(is_wood[parent].begin(), is_wood[parent].begin() + seat.segment, 1);
  }
}

} // namespace internal

/// Marks the points of hollow sections and of all sections between them and the root, provided that
/// most of the length between them is hollow. O(points).
template <class ConcurrencyTag>
std::vector<std::uint8_t>
points_on_hollow_sections(const Scan& scan, const Axis_set& set, const Surface_wood_options& rules)
{
  std::vector<std::uint8_t> is_inside(scan.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(
      scan.size(),
      [&](std::size_t i) {
        if (!set.is_covered(static_cast<Index>(i)))
          return;
        const Axis& axis = set.axes[set.axis_of_point[i]].axis;
        const Axis_place place = nearest_place(axis, set.segment_of_point[i], scan.points[i]);
        const double radius = radius_at(axis, place);
        is_inside[i] =
            place.distance < radius - std::max(rules.depth_noise * set.noise, rules.depth * radius);
      },
      4096);
  std::vector<std::vector<double>> on(set.axes.size()), inside(set.axes.size());
  for (std::size_t a = 0; a < on.size(); ++a) {
    on[a].assign(set.axes[a].axis.size() - 1, 0);
    inside[a] = on[a];
  }
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (set.is_covered(static_cast<Index>(i)))
      (is_inside[i] ? inside : on)[set.axis_of_point[i]][set.segment_of_point[i]] += 1;
  std::vector<std::vector<std::uint8_t>> is_wood(set.axes.size());
  pcs::internal::for_each_index<ConcurrencyTag>(
      set.axes.size(),
      [&](std::size_t a) {
        is_wood[a] =
            internal::hollow_segments(set, set.axes[a].axis, on[a], inside[a], scan.spacing, rules);
      },
      64);
  internal::add_carriers(set, rules, is_wood);
  std::vector<std::uint8_t> result(scan.size(), 0);
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (set.is_covered(static_cast<Index>(i)))
      result[i] = is_wood[set.axis_of_point[i]][set.segment_of_point[i]];
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_FIND_SURFACE_WOOD_H

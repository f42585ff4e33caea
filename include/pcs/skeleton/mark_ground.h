// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Recognises a slice of ground below a tree, so that it is not taken for roots.

#ifndef PCS_SKELETON_MARK_GROUND_H
#define PCS_SKELETON_MARK_GROUND_H

#include <pcs/skeleton/Neighbor_graph.h>
#include <pcs/skeleton/Scan.h>
#include <pcs/skeleton/find_root.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// When low points are ground: a filled sheet, much wider than the stem above it.
struct Ground_rules
{
  double bin = 0.01;   ///< height of a bin relative to the extent upwards, at least 4 spacings [-]
  int bins = 12;       ///< that are looked at from below
  double width = 3;    ///< of the sheet relative to the stem [-]
  double keep = 2;     ///< what lies this many stem widths around the stem is kept [-]
  double filled = 0.4; ///< share of the cells of the sheet that hold points [-]
  int cells = 20;      ///< along the radius of the sheet
};

namespace internal {

/// Horizontal centre and root mean square width of one bin.
struct Bin_extent
{
  Vec3 center = Vec3::Zero();
  double width = 0;
  std::size_t count = 0;
};

/// Whether points fill a disc around `center` in the plane across `up`.
inline bool is_filled_sheet(const Scan& scan,
                            const std::vector<Index>& points,
                            const Vec3& center,
                            const Vec3& up,
                            const Ground_rules& rules)
{
  if (points.size() < 100)
    return false;
  const Vec3 e1 = up.unitOrthogonal(), e2 = up.cross(e1);
  std::vector<double> distance;
  for (const Index i : points) {
    const Vec3 d = scan.points[i] - center;
    distance.push_back(std::hypot(d.dot(e1), d.dot(e2)));
  }
  std::vector<double> sorted = distance;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.9 * double(sorted.size()));
  std::nth_element(sorted.begin(), at, sorted.end());
  const double radius = *at, cell = std::max(radius / rules.cells, 3 * scan.spacing);
  std::vector<std::pair<long, long>> cells;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (distance[k] <= radius) {
      const Vec3 d = scan.points[points[k]] - center;
      cells.emplace_back(std::lround(d.dot(e1) / cell), std::lround(d.dot(e2) / cell));
    }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const double all = 3.14159265358979323846 * radius * radius / (cell * cell);
  return all > 12 && double(cells.size()) >= rules.filled * all;
}

} // namespace internal

/*!
  Takes ground out of `is_used`: points of the lowest bins, far from the stem, if they fill a sheet that is much wider than
  the stem above. Returns their number. `links` are those between neighbours.
*/
inline std::size_t mark_ground(const Scan& scan,
                               const std::vector<Link>& links,
                               const Vec3& up,
                               const Ground_rules& rules,
                               std::vector<std::uint8_t>& is_used)
{
  const Index n = static_cast<Index>(scan.size());
  std::vector<float> heights;
  for (Index i = 0; i < n; ++i)
    if (is_used[i])
      heights.push_back(static_cast<float>(up.dot(scan.points[i])));
  if (heights.size() < 200)
    return 0;
  std::sort(heights.begin(), heights.end());
  const double low = double(heights[heights.size() / 1000]);
  const double high = double(heights[heights.size() - 1 - heights.size() / 1000]);
  const double bin = std::max(rules.bin * (high - low), 4 * scan.spacing);
  const auto bin_of = [&](Index i) { return (up.dot(scan.points[i]) - low) / bin; };
  // per bin, the largest connected part: where there is no ground that is the stem
  std::vector<internal::Bin_extent> extent(static_cast<std::size_t>(rules.bins));
  std::vector<std::vector<Index>> members(extent.size());
  for (Index i = 0; i < n; ++i)
    if (is_used[i] && bin_of(i) < double(rules.bins))
      members[static_cast<std::size_t>(std::max(0.0, bin_of(i)))].push_back(i);
  Point_sets sets(n);
  std::vector<Index> bin_number(n, none);
  for (std::size_t b = 0; b < members.size(); ++b)
    for (const Index i : members[b])
      bin_number[i] = static_cast<Index>(b);
  for (const Link& l : links)
    if (bin_number[l.first] != none && bin_number[l.first] == bin_number[l.second])
      sets.unite(l.first, l.second);
  std::vector<Index> size(n, 0);
  for (std::size_t b = 0; b < members.size(); ++b) {
    Index largest = none;
    for (const Index i : members[b])
      ++size[sets.find(i)];
    for (const Index i : members[b])
      if (largest == none || size[sets.find(i)] > size[largest])
        largest = sets.find(i);
    internal::Bin_extent& e = extent[b];
    for (const Index i : members[b])
      if (sets.find(i) == largest) {
        e.center += scan.points[i];
        ++e.count;
      }
    if (e.count == 0)
      continue;
    e.center /= double(e.count);
    double sum = 0;
    for (const Index i : members[b])
      if (sets.find(i) == largest) {
        const Vec3 d = scan.points[i] - e.center;
        sum += (d - up.dot(d) * up).squaredNorm();
      }
    e.width = std::sqrt(sum / double(e.count));
  }
  std::vector<double> widths;
  for (const internal::Bin_extent& e : extent)
    if (e.count >= 6)
      widths.push_back(e.width);
  if (widths.size() < 4)
    return 0;
  std::sort(widths.begin(), widths.end());
  const double stem = widths[widths.size() / 4];
  std::size_t first = 0; // the lowest bin that is the stem alone
  while (first < extent.size() && !(extent[first].count >= 6 && extent[first].width <= 1.5 * stem))
    ++first;
  if (first == extent.size())
    return 0;
  const Vec3 center = extent[first].center;
  std::vector<Index> far;
  const double keep = rules.keep * stem + 4 * scan.spacing;
  bool is_wide = false;
  for (Index i = 0; i < n; ++i) {
    if (!is_used[i] || !(bin_of(i) < double(first)))
      continue;
    const Vec3 d = scan.points[i] - center;
    const double across = (d - up.dot(d) * up).norm();
    is_wide = is_wide || across > rules.width * stem;
    if (across > keep)
      far.push_back(i);
  }
  if (!is_wide || !internal::is_filled_sheet(scan, far, center, up, rules))
    return 0;
  for (const Index i : far)
    is_used[i] = 0;
  return far.size();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MARK_GROUND_H

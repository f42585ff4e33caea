// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Preparation of a scan: duplicates, neighbours, spacing, outliers.

#ifndef PCS_SKELETON_SCAN_PREPARE_SCAN_H
#define PCS_SKELETON_SCAN_PREPARE_SCAN_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/neighborhood/spatial_order.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/scan/find_scan_frame.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Rank of the neighbour whose distance indicates outliers [count].
constexpr std::size_t outlier_neighbor = 2;
/// Least ratio of this distance of an outlier to the local spacing of its neighbours [-] ...
constexpr double outlier_factor = 3;
/// ... and to the median local spacing; the latter alone is sufficient above the second factor [-].
constexpr double outlier_global_factor = 2, outlier_far_factor = 20;

/// Least ratio of the median distances to consecutive neighbours for which the nearer ones are
/// copies of the point [-]. Without copies, the ratio is at most 1.6 on surfaces and 2.4 on lines
/// of random points; the second term allows for chance in small scans.
constexpr double copy_factor = 2.5, copy_chance = 15;
/// Most rounds of merging, for copies of copies [count].
constexpr int copy_rounds = 3;

namespace internal {

/// Distinct positions in the order of an octree, and the position of each point.
struct Distinct_places
{
  std::vector<Vec3> places;
  std::vector<Index> chosen;   ///< lexicographically least point at each position
  std::vector<Index> of_point; ///< position of each point
};

template <class ConcurrencyTag>
Distinct_places distinct_places(const std::vector<Vec3>& points, const Scan_frame& frame)
{
  const std::size_t n = points.size(), block = 4096, number_of_blocks = (n + block - 1) / block;
  const auto entries = neighborhood::ordered_entries<ConcurrencyTag>(n, [&](std::size_t i) {
    return frame.to_grid(points[i]);
  });
  const auto is_first = [&](std::size_t i) {
    return i == 0 || entries[i].point != entries[i - 1].point;
  };
  std::vector<std::size_t> first(number_of_blocks + 1, 0); // first position of each block
  pcs::internal::for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      first[begin / block + 1] += is_first(i);
  });
  for (std::size_t b = 0; b < number_of_blocks; ++b)
    first[b + 1] += first[b];
  Distinct_places result;
  result.places.resize(first.back());
  result.chosen.resize(first.back());
  result.of_point.resize(n);
  pcs::internal::for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    std::size_t next = first[begin / block];
    for (std::size_t i = begin; i < end; ++i) {
      if (is_first(i)) {
        Index chosen = entries[i].index;
        for (std::size_t k = i + 1; k < n && !is_first(k); ++k)
          if (neighborhood::lexicographically_less(points[entries[k].index], points[chosen]))
            chosen = entries[k].index;
        result.places[next] = entries[i].point;
        result.chosen[next++] = chosen;
      }
      result.of_point[entries[i].index] = static_cast<Index>(next - 1);
    }
  });
  return result;
}

template <class ConcurrencyTag>
void find_neighbors(Scan& scan)
{
  const std::size_t n = scan.size();
  if (!scan.search)
    scan.search = std::make_unique<neighborhood::Nearest_neighbors>(scan.points);
  scan.neighbors.resize(n);
  scan.local_spacing.resize(n);
  std::vector<double> nearest(n);
  pcs::internal::for_each_block<ConcurrencyTag>(n, 512, [&](std::size_t begin, std::size_t end) {
    std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
    for (std::size_t i = begin; i < end; ++i) {
      (*scan.search)(scan.points[i], neighbors_per_point + 1, found);
      auto& row = scan.neighbors[i];
      row.fill(none);
      std::size_t count = 0;
      double fourth = 0;
      for (const auto& f : found)
        if (f.index != i && count < neighbors_per_point) {
          row[count++] = f.index;
          if (count == 1)
            nearest[i] = std::sqrt(f.squared_distance);
          if (count <= spacing_neighbor)
            fourth = std::sqrt(f.squared_distance);
        }
      scan.local_spacing[i] = fourth;
    }
  });
  scan.spacing = pcs::internal::lower_median(nearest);
}

/// Returns the distance within which points are copies of each other, if most of the scan is
/// repeated with different rounding or noise; otherwise 0 [L]. It is estimated from at most 20000
/// points at a constant stride.
inline double reach_of_copies(const Scan& scan)
{
  constexpr std::size_t fewest = 200, enough = 20000;
  const std::size_t n = scan.size(), step = 1 + n / enough;
  const double factor = copy_factor + copy_chance / std::sqrt(double(std::min(n, enough)));
  double before = 0;
  for (std::size_t k = 0; k < neighbors_per_point && n >= fewest; ++k) {
    std::vector<double> distances;
    for (std::size_t i = 0; i < n; i += step)
      distances.push_back((scan.points[i] - scan.points[scan.neighbors[i][k]]).norm());
    const double usual = pcs::internal::lower_median(distances);
    if (k > 0 && usual > factor * before)
      return std::sqrt(before * usual);
    before = usual;
  }
  return 0;
}

/// Merges copies into one point each. Returns whether there are any; the neighbours are then
/// invalid.
inline bool merge_copies(Scan& scan)
{
  const double reach = reach_of_copies(scan);
  if (!(reach > 0))
    return false;
  const Index n = static_cast<Index>(scan.size());
  std::vector<Index> number(n, none);
  std::vector<Vec3> kept;
  for (Index i = 0; i < n; ++i) {
    if (number[i] != none)
      continue;
    number[i] = static_cast<Index>(kept.size());
    kept.push_back(scan.points[i]);
    for (const Index j : scan.neighbors[i])
      if (number[j] == none && (scan.points[i] - scan.points[j]).norm() <= reach)
        number[j] = number[i];
  }
  if (kept.size() <= neighbors_per_point)
    return false;
  for (Index& i : scan.point_of_input)
    i = number[i];
  scan.search.reset();
  scan.points = std::move(kept);
  return true;
}

/// Marks outliers among the points of `is_part`.
template <class ConcurrencyTag>
void mark_outliers(const std::vector<std::uint8_t>& is_part, Scan& scan)
{
  const std::size_t n = scan.size();
  scan.is_outlier.assign(n, 0);
  std::vector<double> spacings;
  for (std::size_t i = 0; i < n; ++i)
    if (is_part[i])
      spacings.push_back(scan.local_spacing[i]);
  const double usual = pcs::internal::lower_median(spacings);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    if (!is_part[i])
      return;
    if (!scan.is_sparse.empty() && scan.is_sparse[i]) {
      scan.is_outlier[i] = 1;
      return;
    }
    // A point of a thin twig has two near neighbours, an outlier has none.
    const Index second = scan.neighbors[i][outlier_neighbor - 1];
    const double own = second != none ? (scan.points[i] - scan.points[second]).norm()
                                      : std::numeric_limits<double>::infinity();
    if (own <= outlier_global_factor * usual)
      return;
    std::array<double, neighbors_per_point> others;
    std::size_t count = 0;
    for (const Index j : scan.neighbors[i])
      if (j != none)
        others[count++] = scan.local_spacing[j];
    const double theirs =
        pcs::internal::upper_median(others.begin(),
                                    others.begin() + static_cast<std::ptrdiff_t>(count));
    scan.is_outlier[i] = own > outlier_factor * theirs || own > outlier_far_factor * usual;
  });
}

} // namespace internal

/// Sets the distinct points of `input` in an empty scan. `input` is finite and not empty, `up` a
/// unit vector. Neither the frame nor the order depends on duplicates. O(n log n).
template <class ConcurrencyTag>
void take_points(std::vector<Vec3> input, const Vec3& up, Scan& scan)
{
  scan.frame = find_scan_frame<ConcurrencyTag>(input, up);
  internal::Distinct_places found = internal::distinct_places<ConcurrencyTag>(input, scan.frame);
  scan.point_of_input = std::move(found.of_point);
  if (found.places.size() < input.size()) {
    std::vector<Vec3> once(found.chosen.size());
    for (std::size_t k = 0; k < once.size(); ++k)
      once[k] = input[found.chosen[k]];
    scan.frame = find_scan_frame<ConcurrencyTag>(once, up);
    found = internal::distinct_places<ConcurrencyTag>(once, scan.frame);
    for (Index& i : scan.point_of_input)
      i = found.of_point[i];
  }
  scan.points = std::move(found.places);
}

/// Merges copies, and measures neighbours, spacing and outliers of a scan with points. If it is
/// dense, its points are already merged. O(n log n).
template <class ConcurrencyTag>
void measure_points(Scan& scan)
{
  internal::find_neighbors<ConcurrencyTag>(scan);
  const int rounds = scan.cell_side > 0 ? 0 : copy_rounds;
  for (int round = 0; round < rounds && internal::merge_copies(scan); ++round)
    internal::find_neighbors<ConcurrencyTag>(scan);
  internal::mark_outliers<ConcurrencyTag>(std::vector<std::uint8_t>(scan.size(), 1), scan);
}

/// Takes and measures the points of `input`. O(n log n).
template <class ConcurrencyTag>
void prepare_scan(const std::vector<Vec3>& input, const Vec3& up, Scan& scan)
{
  take_points<ConcurrencyTag>(input, up, scan);
  measure_points<ConcurrencyTag>(scan);
}

/// Measures the spacing of the points of `is_part` alone, and marks outliers among them: the ground
/// may have a different density.
template <class ConcurrencyTag>
void measure_part(const std::vector<std::uint8_t>& is_part, Scan& scan)
{
  std::vector<double> nearest;
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (is_part[i])
      nearest.push_back((scan.points[i] - scan.points[scan.neighbors[i][0]]).norm());
  scan.spacing = pcs::internal::lower_median(nearest);
  internal::mark_outliers<ConcurrencyTag>(is_part, scan);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_PREPARE_SCAN_H

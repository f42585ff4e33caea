// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Merging of points that are so close together that noise hides the structure between them.

#ifndef PCS_SKELETON_SCAN_THIN_DENSE_POINTS_H
#define PCS_SKELETON_SCAN_THIN_DENSE_POINTS_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/scan/Voxel_cells.h>
#include <pcs/skeleton/scan/measure_noise.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for dense scans, and for the cells in which their points are merged.
struct Thinning_options
{
  //! least number of points of a scan that is thinned by a session [count]. Smaller scans take
  //! seconds, and the curvature of a stem with few points resembles noise.
  std::size_t fewest = 200000;
  double flat = 0.37;   ///< least fraction of the points on flat patches, which show the noise [-]
  double side = 3.6;    ///< of the cells, in units of the noise [-]
  double steps = 8;     ///< sides per factor of two: nearly equal scans have equal cells [count]
  double growth = 1.4;  ///< least ratio of the numbers of cells of half and of full side [-]
  double margin = 0.15; ///< most points of a cell beside a surface, relative to one on it [-]
  double sparse = 0.15; ///< least density of a cell, relative to the mean in its surroundings [-]
  int surroundings = 5; ///< size of a block: `2^surroundings` cells along each axis; the
                        ///< surroundings are 27 blocks [-]
};

namespace internal {

/// Returns the side of the cells for a noise, rounded to a geometric series [L].
inline double side_of_cells(double noise, const Thinning_options& rules)
{
  return std::exp2(std::round(rules.steps * std::log2(rules.side * noise)) / rules.steps);
}

/// Returns the ratio of the numbers of cells of half and of full side. It is estimated from blocks
/// of neighbouring points [-].
template <class ConcurrencyTag>
double growth_of_cells(const std::vector<Vec3>& points, double side)
{
  constexpr std::size_t most = 200000, block = 4000; // [count]
  const std::size_t every = 1 + points.size() / most;
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (i / block % every == 0)
      some.push_back(points[i]);
  const auto count = [&](double s) {
    return double(Voxel_cells::of_points(ConcurrencyTag(), some, {}, s).size());
  };
  return count(0.5 * side) / count(side);
}

/*!
  Returns for each cell the cell with which it is merged; this may be the cell itself. With noise,
  the points of a surface fill several layers of cells. The outer layers have few points, but each
  of their cells would have the same weight as a cell on the surface, and would make thin branches
  thicker. So a cell is merged with the fullest adjacent cell if it has at most the fraction
  `margin` of the points of that cell.
*/
template <class ConcurrencyTag>
std::vector<Index> fullest_neighbors(const Voxel_cells& cells, const Thinning_options& rules)
{
  std::vector<Index> fullest(cells.size());
  for (Index c = 0; c < cells.size(); ++c)
    fullest[c] = c;
  cells.for_each_pair(ConcurrencyTag(), [&](std::size_t c, std::size_t other) {
    if (cells.count[other] > cells.count[fullest[c]])
      fullest[c] = static_cast<Index>(other);
  });
  for (Index c = 0; c < cells.size(); ++c)
    if (cells.count[c] > rules.margin * cells.count[fullest[c]])
      fullest[c] = c;
  // each step leads to a cell with several times as many points, so chains are short
  std::vector<Index> last = fullest;
  for (Index& c : last)
    while (fullest[c] != c)
      c = fullest[c];
  return last;
}

/*!
  Marks the cells that have much fewer points than the wood around them. Their points are ghosts of
  beams that were split at an edge, and other outliers. The density is the number of points in 27
  cells. In coarse scans such points are single, but in dense scans they form chains that resemble
  twigs.
*/
template <class ConcurrencyTag>
std::vector<std::uint8_t> sparse_cells(const Voxel_cells& cells, const Thinning_options& rules)
{
  std::vector<double> density(cells.size(), 0);
  cells.for_each_pair(ConcurrencyTag(),
                      [&](std::size_t c, std::size_t other) { density[c] += cells.count[other]; });
  const Voxel_cells blocks = cells.blocks(ConcurrencyTag(), rules.surroundings);
  std::vector<double> points(blocks.size(), 0), sum(points), all_points(points), all_sum(points);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    points[blocks.cell_of_point[c]] += cells.count[c];
    sum[blocks.cell_of_point[c]] += cells.count[c] * density[c];
  }
  blocks.for_each_pair(ConcurrencyTag(), [&](std::size_t b, std::size_t other) {
    all_points[b] += points[other];
    all_sum[b] += sum[other];
  });
  std::vector<std::uint8_t> is_sparse(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::size_t b = blocks.cell_of_point[c];
    is_sparse[c] = density[c] * all_points[b] < rules.sparse * all_sum[b];
  }
  return is_sparse;
}

/// Replaces the points of each group of cells by their mean. Scan points keep the order of the
/// first points of their groups.
inline void merge_points(const Voxel_cells& cells,
                         const std::vector<Index>& group,
                         const std::vector<std::uint8_t>& is_sparse,
                         Scan& scan)
{
  std::vector<Index> number(cells.size(), none), number_of_point(scan.size());
  std::vector<Vec3> sum;
  std::vector<double> count;
  scan.is_sparse.clear();
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Index g = group[cells.cell_of_point[i]];
    if (number[g] == none) {
      number[g] = static_cast<Index>(sum.size());
      sum.push_back(Vec3::Zero());
      count.push_back(0);
      scan.is_sparse.push_back(is_sparse[g]);
    }
    number_of_point[i] = number[g];
    sum[number[g]] += scan.points[i];
    ++count[number[g]];
  }
  scan.place_of_input.resize(scan.point_of_input.size());
  for (std::size_t i = 0; i < scan.point_of_input.size(); ++i) {
    scan.place_of_input[i] = scan.points[scan.point_of_input[i]];
    scan.point_of_input[i] = number_of_point[scan.point_of_input[i]];
  }
  for (std::size_t k = 0; k < sum.size(); ++k)
    sum[k] = Scan_frame::rounded(sum[k] / count[k]);
  scan.points = std::move(sum);
}

} // namespace internal

/*!
  Merges the points of a dense scan in cells, and marks sparse cells. The side of the cells is a few
  times the noise, which hides all structure within a cell. The number of points then depends on the
  surface, not on the steps of the scanner.

  Halving the side of the cells increases the number of occupied cells by a factor that indicates
  the density: 1 if the points are far apart, 4 on a densely sampled surface. A scan is dense if the
  factor is at least `growth`. Copies of points do not change it.

  On a surface with the radius of curvature `r` [L], the mean of the points of a cell of side
  `h` [L] lies about `h^2 / (24 r)` inside the surface. Only the points of `scan` are required.
  `is_wood` is empty or has one entry per input point. Returns whether points were merged;
  otherwise, only the search of `scan` is set. O(n log n).
*/
template <class ConcurrencyTag>
bool thin_dense_points(const std::vector<std::uint8_t>& is_wood,
                       const Thinning_options& rules,
                       Scan& scan)
{
  scan.search = std::make_unique<neighborhood::Nearest_neighbors>(scan.points);
  const double noise = measure_noise<ConcurrencyTag>(scan.points, *scan.search, rules.flat);
  if (!(noise > 0))
    return false;
  const double side = internal::side_of_cells(noise, rules);
  if (!(internal::growth_of_cells<ConcurrencyTag>(scan.points, side) >= rules.growth))
    return false;
  std::vector<std::uint8_t> is_wood_point(is_wood.empty() ? 0 : scan.size(), 0);
  for (std::size_t i = 0; i < is_wood.size(); ++i)
    is_wood_point[scan.point_of_input[i]] |= is_wood[i];
  const ConcurrencyTag tag{};
  const Voxel_cells cells = Voxel_cells::of_points(tag, scan.points, is_wood_point, side);
  const std::vector<Index> group = internal::fullest_neighbors<ConcurrencyTag>(cells, rules);
  const std::vector<std::uint8_t> is_sparse = internal::sparse_cells<ConcurrencyTag>(cells, rules);
  scan.search.reset();
  internal::merge_points(cells, group, is_sparse, scan);
  scan.cell_side = side;
  return true;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_THIN_DENSE_POINTS_H

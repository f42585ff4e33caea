// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Leaf blades: smooth sheets that are large compared with the plant, such as the leaves of maize.
//
// The size S of a set of points is the root mean square distance from their mean. With the size of
// the plant, R = radius * S. The points are replaced by their means in cells of side R / cells. A
// mean lies on a sheet if the means within R fill a fraction `full` of a disc of radius R, and if
// their distance from the plane of their principal axes is, in units of R,
//
//   z = c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2 + e,   rms(e) <= rough,   |k1|, |k2| <= curved,
//
// with the eigenvalues k1, k2 of the Hessian, which are the curvatures times R. Connected means on
// sheets are a blade if their size is at least `large` * S. Most branches are too thin for such
// sheets, and leaves of trees are too small for such blades. The bark of a log is also a sheet, but
// an axis of radius R or more lies behind it.

#ifndef PCS_SKELETON_LEAVES_FIND_LEAF_BLADES_H
#define PCS_SKELETON_LEAVES_FIND_LEAF_BLADES_H

#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Moments.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/scan/Voxel_cells.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for leaf blades.
struct Blade_options
{
  double radius = 0.06;  ///< of a sheet, in sizes of the plant [-]
  double cells = 5;      ///< per radius of a sheet [count]
  double full = 0.4;     ///< least fraction of the cells of a disc that are filled [-]
  double flat = 0.15;    ///< largest ratio of the variances across and along a sheet [-]
  double wide = 0.1;     ///< least ratio of the two variances along a sheet [-]
  double rough = 0.15;   ///< largest deviation from the quadric, in radii of the sheet [-]
  double curved = 0.35;  ///< largest curvature, in inverse radii of the sheet [-]
  double touching = 2.2; ///< largest distance of connected means, in sides of a cell [-]
  double large = 0.12;   ///< least size of a blade, in sizes of the plant [-]
  //! means that are tested first, at most [count]; the others are tested if ...
  std::size_t sample = 2000;
  double sheets = 0.05; ///< ... at least this fraction of them lies on sheets [-]
  double share = 0.01;  ///< least fraction of the means that lie on blades [-]
  double bark = 0.75;   ///< largest fraction of bark among the points on blades [-]
};

/// The points of a plant that lie on leaf blades.
struct Leaf_blades
{
  std::vector<Index> points; ///< in increasing order
  double share = 0;          ///< fraction of the occupied cells, a measure of area [-]
  double radius = 0;         ///< of a sheet [L]
  double cell = 0;           ///< side of the cells [L]
};

namespace internal {

/// Means of points in the cells of a grid.
class Blade_finder
{
public:
  template <class ConcurrencyTag>
  Blade_finder(ConcurrencyTag,
               const std::vector<Vec3>& points,
               double size,
               const Blade_options& rules)
    : m_rules(rules),
      m_radius(rules.radius * size),
      m_large(rules.large * size),
      m_cells(Voxel_cells::of_points(ConcurrencyTag(), points, {}, side()))
  {
    m_means.assign(m_cells.size(), Vec3::Zero());
    for (std::size_t i = 0; i < points.size(); ++i)
      m_means[m_cells.cell_of_point[i]] += points[i];
    for (std::size_t c = 0; c < m_means.size(); ++c)
      m_means[c] /= double(m_cells.count[c]);
  }

  /// Finds the points on blades; their indices are those of `points`.
  template <class ConcurrencyTag>
  Leaf_blades find(ConcurrencyTag) const
  {
    Leaf_blades blades;
    blades.radius = m_radius;
    blades.cell = side();
    const neighborhood::Nearest_neighbors neighbors(m_means);
    const std::size_t step = (m_means.size() + m_rules.sample - 1) / m_rules.sample;
    const auto share_of = [](const std::vector<std::uint8_t>& flags) {
      return double(std::count(flags.begin(), flags.end(), 1)) / double(flags.size());
    };
    if (share_of(find_sheets<ConcurrencyTag>(neighbors, step)) < m_rules.sheets)
      return blades;
    const std::vector<std::uint8_t> is_blade =
        find_blades(neighbors, find_sheets<ConcurrencyTag>(neighbors, 1));
    blades.share = share_of(is_blade);
    for (Index i = 0; i < m_cells.cell_of_point.size(); ++i)
      if (is_blade[m_cells.cell_of_point[i]])
        blades.points.push_back(i);
    return blades;
  }

private:
  double side() const { return m_radius / m_rules.cells; }

  /// Returns for every mean with an index divisible by `step` whether it lies on a sheet.
  template <class ConcurrencyTag>
  std::vector<std::uint8_t> find_sheets(const neighborhood::Nearest_neighbors& neighbors,
                                        std::size_t step) const
  {
    constexpr std::size_t block = 64; // means of a task
    std::vector<std::uint8_t> is_sheet((m_means.size() + step - 1) / step);
    const auto test = [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> around;
      for (std::size_t k = begin; k < end; ++k) {
        around.clear();
        neighbors.within(m_means[k * step], m_radius, around);
        is_sheet[k] = is_sheet_of(around);
      }
    };
    pcs::internal::for_each_block<ConcurrencyTag>(is_sheet.size(), block, test);
    return is_sheet;
  }

  /// Returns whether neighbouring means form a sheet.
  bool is_sheet_of(const std::vector<std::uint32_t>& around) const
  {
    if (double(around.size()) < m_rules.full * pcs::internal::pi * m_rules.cells * m_rules.cells)
      return false;
    Moments moments;
    for (const std::uint32_t i : around)
      moments.add(m_means[i] - m_means[around.front()]);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments.covariance());
    const Vec3 variance = axes.eigenvalues().cwiseMax(0);
    if (!(variance(1) >= m_rules.wide * variance(2)) ||
        !(variance(0) <= m_rules.flat * variance(1)))
      return false;
    using Row = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Row right = Row::Zero();
    double square = 0;
    const Vec3 center = m_means[around.front()] + moments.mean();
    for (const std::uint32_t i : around) {
      const Vec3 p = axes.eigenvectors().transpose() * (m_means[i] - center) / m_radius; // z, x, y
      Row row;
      row << 1, p(1), p(2), p(1) * p(1), p(1) * p(2), p(2) * p(2);
      normal += row * row.transpose();
      right += p(0) * row;
      square += p(0) * p(0);
    }
    const Row c = normal.ldlt().solve(right);
    const double variance_of_rest = (square - c.dot(right)) / double(around.size());
    const double curvature = std::abs(c(3) + c(5)) + std::hypot(c(3) - c(5), c(4));
    return variance_of_rest <= m_rules.rough * m_rules.rough && curvature <= m_rules.curved;
  }

  /// Returns which means lie on blades.
  std::vector<std::uint8_t> find_blades(const neighborhood::Nearest_neighbors& neighbors,
                                        const std::vector<std::uint8_t>& is_sheet) const
  {
    std::vector<std::uint8_t> is_blade(is_sheet.size(), 0), is_found(is_blade);
    std::vector<std::uint32_t> blade, around;
    for (std::uint32_t first = 0; first < is_sheet.size(); ++first) {
      if (!is_sheet[first] || is_found[first])
        continue;
      blade = {first};
      is_found[first] = 1;
      Moments moments;
      for (std::size_t k = 0; k < blade.size(); ++k) {
        const std::uint32_t i = blade[k];
        moments.add(m_means[i] - m_means[first]);
        around.clear();
        neighbors.within(m_means[i], m_rules.touching * side(), around);
        for (const std::uint32_t j : around)
          if (is_sheet[j] && !is_found[j]) {
            is_found[j] = 1;
            blade.push_back(j);
          }
      }
      if (moments.covariance().trace() >= m_large * m_large)
        for (const std::uint32_t i : blade)
          is_blade[i] = 1;
    }
    return is_blade;
  }

  Blade_options m_rules;
  double m_radius, m_large; // [L]
  Voxel_cells m_cells;
  std::vector<Vec3> m_means;
};

} // namespace internal

/// Finds the points of `is_used` that lie on leaf blades. O(n log n).
template <class ConcurrencyTag>
Leaf_blades find_leaf_blades(const Scan& scan,
                             const std::vector<std::uint8_t>& is_used,
                             const Blade_options& rules = {})
{
  std::vector<Index> used;
  std::vector<Vec3> points;
  Moments moments;
  for (Index i = 0; i < scan.size(); ++i)
    if (is_used[i]) {
      used.push_back(i);
      points.push_back(scan.points[i]);
      moments.add(scan.points[i]);
    }
  const double size = used.empty() ? 0 : std::sqrt(std::max(0.0, moments.covariance().trace()));
  if (!(size > 0))
    return {};
  Leaf_blades blades =
      internal::Blade_finder(ConcurrencyTag(), points, size, rules).find(ConcurrencyTag());
  for (Index& i : blades.points)
    i = used[i];
  return blades;
}

/// Returns the fraction of the points on blades that have a thick axis behind them, like bark [-].
/// O(points).
inline double share_of_bark(const Scan& scan,
                            const Axis_set& axes,
                            const Leaf_blades& blades,
                            const Blade_options& rules = {})
{
  const auto is_bark = [&](Index i) {
    if (!axes.is_covered(i))
      return false;
    const Axis& axis = axes.axes[axes.axis_of_point[i]].axis;
    const Axis_place place = nearest_place(axis, axes.segment_of_point[i], scan.points[i]);
    const double radius = radius_at(axis, place);
    return radius >= blades.radius &&
           std::abs(place.distance - radius) <= rules.rough * blades.radius;
  };
  const auto count = std::count_if(blades.points.begin(), blades.points.end(), is_bark);
  return blades.points.empty() ? 0 : double(count) / double(blades.points.size());
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_FIND_LEAF_BLADES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ground of a stand that is seen by few points, also on a slope.
//
// In each square of a horizontal grid, the lowest point is a candidate. It is rejected if another
// candidate is so far below it that the ground between them would be steeper than `steepest`.
// Around the center m of each square, the surface is a plane, which minimises
//
//   sum over candidates j of  g(|x_j - m|) w(r_j) r_j^2,   r_j = z_j - level - slope . (x_j - m)
//
// with g a Gaussian weight of the horizontal distance, and w(r) = 1 / (1 + (max(r, 0) / s)^2): a
// candidate above the plane may belong to a plant, a candidate below it does not. s is the median
// absolute residual of the last iteration.

#ifndef PCS_SKELETON_FOREST_SPARSE_GROUND_H
#define PCS_SKELETON_FOREST_SPARSE_GROUND_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for the sparse ground of a stand. Lengths are in breast heights unless stated otherwise
/// [-].
struct Sparse_ground_options
{
  double cell = 0.75;     ///< side of the squares
  double reach = 1.5;     ///< standard deviation of the Gaussian weight, in squares [-]
  double steepest = 1.2;  ///< steepest ground [-]
  int iterations = 5;     ///< of the robust fit [count]
  double covered = 0.4;   ///< least fraction of the squares with points that show ground [-]
  double noise = 4;       ///< thickness of the ground, in median residuals [-] ...
  double thinnest = 0.04; ///< ... but at least
  double thickest = 0.2;  ///< ... and at most
};

namespace internal {

/// The surface of the ground as a plane for each square. z points upwards.
class Sparse_ground
{
public:
  /// `breast_height` is in the unit of the scan; only points with `is_solid` are used.
  Sparse_ground(const Scan& scan,
                double breast_height,
                const Sparse_ground_options& rules,
                const std::vector<std::uint8_t>& is_solid)
    : m_rules(rules), m_cell(side_of_squares(scan, rules.cell * breast_height))
  {
    find_candidates(scan, is_solid);
    double deviation = rules.thickest * breast_height;
    for (int k = 0; k < rules.iterations && m_number_of_candidates > 0; ++k) {
      fit_planes(deviation);
      deviation = median_residual();
    }
    m_thickness = std::clamp(rules.noise * deviation,
                             rules.thinnest * breast_height,
                             rules.thickest * breast_height);
  }

  /// Returns whether enough squares show ground.
  bool is_found() const
  {
    std::size_t count = 0;
    for (const auto& entry : m_squares)
      count += entry.second.is_candidate &&
               std::abs(entry.second.residual(entry.second.lowest)) <= m_thickness;
    return !m_squares.empty() && double(count) >= m_rules.covered * double(m_squares.size());
  }

  /// Returns the height of a point of the scan above the ground [L].
  double height(const Vec3& p) const
  {
    const auto at = m_squares.find(key_of(p));
    return at == m_squares.end() ? std::numeric_limits<double>::infinity() : at->second.residual(p);
  }

  /// Returns the height up to which points are ground [L].
  double thickness() const { return m_thickness; }

private:
  using Key = std::pair<long long, long long>;

  struct Square
  {
    Vec3 lowest;
    bool is_candidate = true;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    Vec3 plane = Vec3::Zero(); ///< level at `middle`, and slopes

    double residual(const Vec3& p) const
    {
      const Eigen::Vector2d d = p.head<2>() - middle;
      return p.z() - plane(0) - plane.tail<2>().dot(d);
    }
  };

  /// Returns the wanted side of the squares, or a larger one if their indices were too large for
  /// integers [L].
  static double side_of_squares(const Scan& scan, double wanted)
  {
    double farthest = 0;
    for (const Vec3& p : scan.points)
      farthest = std::max({farthest, std::abs(p.x()), std::abs(p.y())});
    return std::max({wanted, 1e-15 * farthest, std::numeric_limits<double>::min()});
  }

  Key key_of(const Vec3& p) const
  {
    return {static_cast<long long>(std::floor(p.x() / m_cell)),
            static_cast<long long>(std::floor(p.y() / m_cell))};
  }

  /// Calls `visit(other)` for the squares within `steps` of a key.
  template <class Visitor>
  void for_near(const Key& key, long long steps, const Visitor& visit) const
  {
    for (long long i = -steps; i <= steps; ++i) {
      auto at = m_squares.lower_bound({key.first + i, key.second - steps});
      for (; at != m_squares.end() && at->first <= Key(key.first + i, key.second + steps); ++at)
        visit(at->second);
    }
  }

  void find_candidates(const Scan& scan, const std::vector<std::uint8_t>& is_solid)
  {
    for (std::size_t i = 0; i < scan.size(); ++i) {
      if (!is_solid[i])
        continue;
      const Vec3& p = scan.points[i];
      const Key key = key_of(p);
      const auto [at, is_new] = m_squares.try_emplace(key);
      Square& square = at->second;
      if (is_new || p.z() < square.lowest.z())
        square.lowest = p;
      square.middle = m_cell * Eigen::Vector2d(double(key.first) + 0.5, double(key.second) + 0.5);
    }
    constexpr long long steps = 8; // squares without ground are rarely wider
    for (auto& [key, square] : m_squares) {
      const Vec3 p = square.lowest;
      for_near(key, steps, [&, &s = square](const Square& other) {
        const double distance = (other.lowest - p).head<2>().norm();
        s.is_candidate &= p.z() - other.lowest.z() <= m_rules.steepest * (distance + 0.1 * m_cell);
      });
      m_number_of_candidates += square.is_candidate;
    }
  }

  void fit_planes(double deviation)
  {
    const double width = m_rules.reach * m_cell;
    const auto steps = static_cast<long long>(std::ceil(3 * m_rules.reach));
    std::map<Key, Vec3> planes;
    for (const auto& [key, square] : m_squares) {
      Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
      Vec3 right = Vec3::Zero();
      const Eigen::Vector2d middle = square.middle;
      for_near(key, steps, [&](const Square& other) {
        if (!other.is_candidate)
          return;
        const Eigen::Vector2d d = other.lowest.head<2>() - middle;
        const double above = std::max(0.0, other.residual(other.lowest)) / deviation;
        const double near = std::exp(-0.5 * d.squaredNorm() / (width * width));
        const double weight = m_is_fitted ? near / (1 + above * above) : near;
        const Vec3 row(1, d.x(), d.y());
        matrix += weight * row * row.transpose();
        right += weight * other.lowest.z() * row;
      });
      // slopes that few candidates determine are drawn to zero
      matrix(1, 1) += 1e-3 * width * width;
      matrix(2, 2) += 1e-3 * width * width;
      const double determinant = matrix.determinant();
      Vec3 plane = matrix.inverse() * right;
      if (!(std::abs(determinant) > 0) || !plane.allFinite())
        plane = Vec3(square.lowest.z(), 0, 0);
      planes.emplace(key, plane);
    }
    for (const auto& [key, plane] : planes)
      m_squares.find(key)->second.plane = plane;
    m_is_fitted = true;
  }

  double median_residual() const
  {
    std::vector<double> residuals;
    for (const auto& entry : m_squares)
      if (entry.second.is_candidate)
        residuals.push_back(std::abs(entry.second.residual(entry.second.lowest)));
    return std::max(pcs::internal::lower_median(residuals), 1e-9 * m_cell);
  }

  Sparse_ground_options m_rules;
  double m_cell; ///< side of the squares [L]
  double m_thickness = 0;
  bool m_is_fitted = false;
  std::size_t m_number_of_candidates = 0;
  std::map<Key, Square> m_squares;
};

} // namespace internal
} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_SPARSE_GROUND_H

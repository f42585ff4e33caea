// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The share of the beams of a scanner that pass a position, from the points that they returned.

#ifndef PCS_GENERATORS_HIDDEN_BEAM_VISIBILITY_H
#define PCS_GENERATORS_HIDDEN_BEAM_VISIBILITY_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace hidden {

using Vector3 = Eigen::Vector3d;

/// The directions from a station: azimuth relative to its first point, and elevation [rad].
struct Direction
{
  double azimuth, elevation, range;
};

/*
  Beams have equal steps s of azimuth and elevation. The directions are divided into cells of
  `cell_size` by `cell_size` beams, and each cell lists the ranges of its returns. Of the beams of a
  cell, the share 1 - n / cell_size^2 passes a position, where n is the number of returns before it.
  The side of a cell is small against the gaps of crowns, and large enough for the unknown phase of
  the grid.
*/
class Station_view
{
public:
  Station_view(const Vector3& position, const std::vector<Vector3>& points, double step)
    : m_position(position), m_step(step)
  {
    Vector3 mean = Vector3::Zero();
    for (const Vector3& p : points)
      mean += (p - position) / static_cast<double>(points.size());
    m_front = std::atan2(mean.y(), mean.x());
    m_returns.reserve(points.size());
    for (const Vector3& p : points) {
      const Direction d = direction(p);
      m_returns.emplace_back(cell(d), d.range);
    }
    std::sort(m_returns.begin(), m_returns.end());
  }

  /// The share of the beams towards `p`, on a branch of this radius, that have no return before it.
  /// Returns of the branch itself, and those nearer to it than a cell is wide, do not count.
  double visible_share(const Vector3& p, double radius) const
  {
    const double margin = std::max(3 * radius, cell_size * step_at(p));
    return std::max(0.0, 1 - number_before(p, margin) / (cell_size * cell_size));
  }

  /// The share of the beams towards `p` that have a return before it, or up to `depth` behind it.
  double blocked_share(const Vector3& p, double depth) const
  {
    return std::min(1.0, number_before(p, -depth) / (cell_size * cell_size));
  }

  /// Whether a return lies near `p`, on a branch of this radius.
  bool has_return(const Vector3& p, double radius) const
  {
    const double margin = std::max(3 * radius, cell_size * step_at(p));
    return number_before(p, -margin) > number_before(p, margin);
  }

  /// The share of the returns in cells that have more than twice as many returns as beams [-].
  double crowded_share() const
  {
    constexpr double most = 2 * cell_size * cell_size;
    std::size_t crowded = 0;
    for (std::size_t i = 0; i < m_returns.size();) {
      std::size_t end = i;
      while (end < m_returns.size() && m_returns[end].first == m_returns[i].first)
        ++end;
      crowded += static_cast<double>(end - i) > most ? end - i : 0;
      i = end;
    }
    return static_cast<double>(crowded) / static_cast<double>(m_returns.size());
  }

  double step_at(const Vector3& p) const { return m_step * (p - m_position).norm(); }

  /// The number of beams towards a piece of a branch of this length and radius, without occlusion.
  double number_of_beams(const Vector3& p, const Vector3& along, double length, double radius) const
  {
    const Vector3 ray = p - m_position;
    const double range = std::max(1e-300, ray.norm());
    const double across = along.cross(ray).norm() / range;
    const double cosine = std::max(0.05, std::hypot(ray.x(), ray.y()) / range);
    return 2 * radius * length * across / (range * range * m_step * m_step * cosine);
  }

private:
  using Return = std::pair<std::uint64_t, double>;
  static constexpr double cell_size = 5; // [count]

  /// The number of returns in the cell of `p` that are nearer than `p` by `margin` or more.
  double number_before(const Vector3& p, double margin) const
  {
    const Direction d = direction(p);
    const std::uint64_t c = cell(d);
    const auto first = std::lower_bound(m_returns.begin(), m_returns.end(), Return(c, 0.0));
    const auto last = std::lower_bound(first, m_returns.end(), Return(c, d.range - margin));
    return static_cast<double>(last - first);
  }

  Direction direction(const Vector3& p) const
  {
    const Vector3 d = p - m_position;
    const double range = d.norm();
    double azimuth = std::atan2(d.y(), d.x()) - m_front + pcs::internal::pi;
    azimuth -= 2 * pcs::internal::pi * std::floor(azimuth / (2 * pcs::internal::pi));
    const double sine = range > 0 ? std::clamp(d.z() / range, -1.0, 1.0) : 0;
    return {azimuth, std::asin(sine) + pcs::internal::pi / 2, range};
  }

  std::uint64_t cell(const Direction& d) const
  {
    const double side = cell_size * m_step;
    const auto column = static_cast<std::uint64_t>(d.azimuth / side);
    const auto row = static_cast<std::uint64_t>(d.elevation / side);
    return (row << 32) | column;
  }

  Vector3 m_position;
  double m_step, m_front = 0;
  std::vector<Return> m_returns; // sorted
};

/// All stations together.
class Beam_visibility
{
public:
  explicit Beam_visibility(std::vector<Station_view> views) : m_views(std::move(views)) {}

  std::size_t number_of_stations() const { return m_views.size(); }

  /// The share of directions that show the position: 1 minus the product of the hidden shares.
  double visible_share(const Vector3& p, double radius) const
  {
    double hidden = 1;
    for (const Station_view& view : m_views)
      hidden *= 1 - view.visible_share(p, radius);
    return 1 - hidden;
  }

  /// Whether a return of a station lies near the position.
  bool has_return(const Vector3& p, double radius) const
  {
    return std::any_of(m_views.begin(), m_views.end(), [&](const Station_view& view) {
      return view.has_return(p, radius);
    });
  }

  /// The share of directions in which the position is hidden or within `depth` of a return.
  double blocked_share(const Vector3& p, double depth) const
  {
    double blocked = 1;
    for (const Station_view& view : m_views)
      blocked *= view.blocked_share(p, depth);
    return blocked;
  }

  /// The smallest distance of beams at this position [L].
  double step_at(const Vector3& p) const
  {
    double step = std::numeric_limits<double>::infinity();
    for (const Station_view& view : m_views)
      step = std::min(step, view.step_at(p));
    return step;
  }

  double number_of_beams(const Vector3& p, const Vector3& along, double length, double radius) const
  {
    double sum = 0;
    for (const Station_view& view : m_views)
      sum += view.number_of_beams(p, along, length, radius);
    return sum;
  }

private:
  std::vector<Station_view> m_views;
};

/// Angles between neighbouring directions of a station; see `distances_of_beams()`.
struct Beam_distances
{
  std::vector<double> angles; ///< sorted [rad]

  /// The lower quartile, the distance of neighbours in a row or a column of a grid; 0: unknown.
  double step() const { return angles.empty() ? 0 : angles[angles.size() / 4]; }

  /// The share of distances that are `step` within a tenth [-].
  double share_at(double step) const
  {
    constexpr double tolerance = 0.1;
    const auto is_near = [&](double angle) { return std::abs(angle - step) <= tolerance * step; };
    const auto number = std::count_if(angles.begin(), angles.end(), is_near);
    return angles.empty() ? 0 : static_cast<double>(number) / static_cast<double>(angles.size());
  }
};

/// Finds the distance to the next direction for a sample of the directions. Beams on a grid have
/// equal distances; those of a thinned scan, or seen from another position, have not.
inline Beam_distances distances_of_beams(const Vector3& station, const std::vector<Vector3>& points)
{
  constexpr std::size_t number_of_samples = 200;
  constexpr double same = 1e-7; // [rad]
  std::vector<Eigen::Vector2d> directions;
  directions.reserve(points.size());
  for (const Vector3& p : points) {
    const Vector3 d = p - station;
    directions.emplace_back(std::atan2(d.y(), d.x()), std::atan2(d.z(), std::hypot(d.x(), d.y())));
  }
  Beam_distances result;
  for (std::size_t k = 0; k < number_of_samples && !points.empty(); ++k) {
    pcs::internal::Random_stream random(17, k);
    const Eigen::Vector2d& d = directions[random.bits() % directions.size()];
    double best = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& other : directions) {
      const double squared = (other - d).squaredNorm();
      if (squared > same * same)
        best = std::min(best, squared);
    }
    if (std::isfinite(best))
      result.angles.push_back(std::sqrt(best));
  }
  std::sort(result.angles.begin(), result.angles.end());
  return result;
}

} // namespace hidden
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HIDDEN_BEAM_VISIBILITY_H

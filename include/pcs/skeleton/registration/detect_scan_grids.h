// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detection of scanner stations by their angular grids.

#ifndef PCS_SKELETON_REGISTRATION_DETECT_SCAN_GRIDS_H
#define PCS_SKELETON_REGISTRATION_DETECT_SCAN_GRIDS_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/registration/Periodogram.h>
#include <pcs/skeleton/registration/Point_pairs.h>
#include <pcs/skeleton/registration/Registration_options.h>
#include <pcs/skeleton/registration/Scan_grid.h>
#include <pcs/skeleton/registration/fit_scan_grid.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Searches for one station among points in octree order. The third axis points upwards, and the
/// origin is the centre of the points.
template <class ConcurrencyTag>
class Scan_grid_search
{
public:
  Scan_grid_search(const std::vector<Vec3>& points, const Scan_grid_options& rules)
    : m_points(points), m_rules(rules), m_source(points)
  {
    for (double r = rules.nearest; r <= rules.farthest; r *= 1 + rules.spacing)
      m_ranges.push_back(r);
  }

  /// Returns whether a station was found.
  bool run(Scan_grid& grid) const
  {
    const double spacing = m_source.spacing();
    if (!(spacing > 0))
      return false;
    for (double shortest = m_rules.shortest * spacing; shortest < m_rules.longest * spacing;
         shortest *= widening)
      if (run(shortest, grid))
        return true;
    return false;
  }

private:
  using Vec2 = Eigen::Vector2d;
  static constexpr double widening = 1.5; ///< ratio of the steps of one search [-]

  /// The direction of a station, and the distance between its columns or rows at the origin.
  struct Guess
  {
    double angle = 0, step = 0;
  };

  bool run(double shortest, Scan_grid& grid) const
  {
    const Coordinates near(
        m_source.template draw<ConcurrencyTag>(2 * shortest, 4 * shortest, m_rules.pairs));
    if (near.size() < m_rules.fewest_pairs)
      return false;
    for (const Guess& guess : directions(near, shortest)) {
      Scan_grid found;
      double step = guess.step;
      if (place(guess, near, found, step)) {
        Scan_grid_fit<ConcurrencyTag> fit(m_points, m_source, m_rules, found);
        if (fit.run(step)) {
          grid = fit.grid();
          return true;
        }
      }
    }
    return false;
  }

  static Vec2 place_at(double range, double angle)
  {
    return Vec2(range * std::cos(angle), range * std::sin(angle));
  }

  /// The pairs by coordinate, for SIMD instructions.
  struct Coordinates
  {
    std::array<std::vector<float>, 3> middle, step;
    explicit Coordinates(const std::vector<Point_pair>& pairs)
    {
      for (const Point_pair& pair : pairs)
        for (std::size_t a = 0; a < 3; ++a) {
          middle[a].push_back(static_cast<float>(pair.middle[static_cast<Eigen::Index>(a)]));
          step[a].push_back(static_cast<float>(pair.step[static_cast<Eigen::Index>(a)]));
        }
    }
    std::size_t size() const { return middle[0].size(); }
  };

  /// Computes the spectra of the columns of stations at the given positions.
  void
  columns(const Coordinates& pairs, const std::vector<Vec2>& places, Periodogram& spectra) const
  {
    const float *mx = pairs.middle[0].data(), *my = pairs.middle[1].data();
    const float *sx = pairs.step[0].data(), *sy = pairs.step[1].data();
    spectra.compute<ConcurrencyTag>(places.size(),
                                    pairs.size(),
                                    [&, mx, my, sx, sy](std::size_t h) {
                                      const float x0 = static_cast<float>(places[h].x()),
                                                  y0 = static_cast<float>(places[h].y());
                                      const float range = static_cast<float>(places[h].norm());
                                      return [=](std::size_t k) {
                                        const float x = mx[k] - x0, y = my[k] - y0;
                                        return range * (x * sy[k] - y * sx[k]) / (x * x + y * y);
                                      };
                                    });
  }

  /// Computes the spectra of the rows of stations at the given heights above one position.
  void rows(const Coordinates& pairs,
            const Vec2& place,
            const std::vector<double>& heights,
            Periodogram& spectra) const
  {
    const float *mx = pairs.middle[0].data(), *my = pairs.middle[1].data();
    const float *sx = pairs.step[0].data(), *sy = pairs.step[1].data();
    const float *mz = pairs.middle[2].data(), *sz = pairs.step[2].data();
    const float x0 = static_cast<float>(place.x()), y0 = static_cast<float>(place.y());
    const float range = static_cast<float>(place.norm());
    spectra.compute<ConcurrencyTag>(heights.size(), pairs.size(), [=, &heights](std::size_t h) {
      const float z0 = static_cast<float>(heights[h]);
      return [=](std::size_t k) {
        const float x = mx[k] - x0, y = my[k] - y0, z = mz[k] - z0, level2 = x * x + y * y;
        const float away = (x * sx[k] + y * sy[k]) / std::sqrt(level2);
        return range * (std::sqrt(level2) * sz[k] - z * away) / (level2 + z * z);
      };
    });
  }

  /// Returns the directions in which near pairs show columns. Near pairs determine the direction of
  /// a station, but hardly its distance.
  std::vector<Guess> directions(const Coordinates& near, double shortest) const
  {
    const std::size_t around = static_cast<std::size_t>(std::ceil(two_pi / m_rules.spacing));
    std::vector<Vec2> places;
    for (std::size_t k = 0; k < m_ranges.size(); k += 3)
      for (std::size_t a = 0; a < around; ++a)
        places.push_back(place_at(m_ranges[k], two_pi * double(a) / double(around)));
    Periodogram spectra(shortest, widening * shortest, 1.05, 3, 4 * shortest);
    columns(near, places, spectra);
    const auto are_alike = [&](std::size_t g, std::size_t h) {
      const std::size_t a = (g % around + around - h % around) % around;
      return std::min(a, around - a) <= 2;
    };
    std::vector<Guess> guesses;
    for (const Step_peak& peak : spectra.outstanding(m_rules.hint, m_rules.guesses, are_alike)) {
      const Vec2& p = places[peak.hypothesis];
      guesses.push_back({std::atan2(p.y(), p.x()), peak.step});
    }
    return guesses;
  }

  /// Estimates the distance of a station from pairs that lie farther apart, then its height.
  /// Returns `false` if the contrast is too low.
  bool place(const Guess& guess, const Coordinates& near, Scan_grid& grid, double& step) const
  {
    constexpr double fine = 1.01, reach = 10; // ratio of steps; length of pairs [steps]
    constexpr std::size_t beside = 6;
    const double shortest = guess.step / 1.1, longest = guess.step * 1.1;
    const Coordinates far(m_source.template draw<ConcurrencyTag>(0.5 * reach * guess.step,
                                                                 reach * guess.step,
                                                                 2 * m_rules.pairs));
    const double least = m_rules.evidence * std::sqrt(0.75 / double(far.size() + 1));
    std::vector<Vec2> places;
    for (const double r : m_ranges)
      for (int a = -4; a <= 4; ++a)
        places.push_back(place_at(r, guess.angle + 0.25 * a * m_rules.spacing));
    Periodogram spectra(shortest, longest, fine, beside, reach * guess.step);
    columns(far, places, spectra);
    const Step_peak column = spectra.highest();
    const Vec2 at = places[column.hypothesis];
    const double range = at.norm();
    if (column.contrast < least)
      return false;
    // the step between rows may differ
    std::vector<double> heights;
    for (double z = -1.5 * range; z <= 1.5 * range; z += 0.5 * m_rules.spacing * range)
      heights.push_back(z);
    Periodogram rough(guess.step / 2, 2 * guess.step, 1.05, 3, 5 * guess.step);
    rows(near, at, heights, rough);
    const Step_peak first = rough.highest();
    if (!(first.contrast > 0))
      return false;
    const double middle = heights[first.hypothesis];
    heights.clear();
    for (int k = -16; k <= 16; ++k)
      heights.push_back(middle + 0.125 * k * m_rules.spacing * range);
    Periodogram exact(first.step / 1.1, first.step * 1.1, fine, beside, reach * guess.step);
    rows(far, at, heights, exact);
    const Step_peak row = exact.highest();
    if (row.contrast < least)
      return false;
    grid.position = Vec3(at.x(), at.y(), heights[row.hypothesis]);
    const Vec3 ahead(-at.x() / range, -at.y() / range, 0);
    grid.axes.row(0) = ahead.transpose();
    grid.axes.row(1) = Vec3::UnitZ().cross(ahead).transpose();
    grid.axes.row(2) = Vec3::UnitZ().transpose();
    grid.rate = Grid_place(range / column.step, range / row.step);
    step = std::max(column.step, row.step);
    return true;
  }

  const std::vector<Vec3>& m_points;
  const Scan_grid_options& m_rules;
  Pair_source m_source;
  std::vector<double> m_ranges;
};

} // namespace internal

/*!
  Detects the scanner stations of a scan whose points still show the grids of their beams. `points`
  are in octree order, with the third axis upwards and the origin at their centre. Stations are
  detected one after the other among the unassigned points.
*/
template <class ConcurrencyTag>
std::vector<Scan_grid> detect_scan_grids(std::vector<Vec3> points, const Scan_grid_options& rules)
{
  std::vector<Scan_grid> grids;
  while (grids.size() < rules.most && points.size() >= rules.fewest) {
    Scan_grid grid;
    if (!internal::Scan_grid_search<ConcurrencyTag>(points, rules).run(grid))
      break;
    grids.push_back(grid);
    std::vector<std::uint8_t> is_taken(points.size());
    pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
      is_taken[i] = grid.misfit(points[i], grid.tolerance) <= grid.tolerance;
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!is_taken[i])
        points[kept++] = points[i];
    points.resize(kept);
  }
  return grids;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_DETECT_SCAN_GRIDS_H

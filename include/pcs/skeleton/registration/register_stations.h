// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fine registration of scanner stations on the branches of a tree.

#ifndef PCS_SKELETON_REGISTRATION_REGISTER_STATIONS_H
#define PCS_SKELETON_REGISTRATION_REGISTER_STATIONS_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/registration/Registration_options.h>
#include <pcs/skeleton/registration/Rigid_motion.h>
#include <pcs/skeleton/registration/align_stations.h>
#include <pcs/skeleton/registration/detect_scan_grids.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  Estimates rigid motions that align the points of all scanner stations with the same branches.
  Registration errors change the radii of branches by the same amount. `draft(points, is_wood,
  progress)` fits axes to some of the points. It returns a pointer to an object with `scan()` and
  `axes()`, or null if `progress` stopped it.
*/
template <class ConcurrencyTag, class Draft>
class Station_registration
{
public:
  /// `scan` needs only its points; `is_wood` is empty or has one entry per input point.
  Station_registration(const Scan& scan,
                       const std::vector<std::uint8_t>& is_wood,
                       const Registration_options& options,
                       const Draft& draft)
    : m_scan(scan), m_is_wood(is_wood), m_options(options), m_draft(draft)
  {
  }

  /// Estimates the motions. `stations` are the labels of the input points, or empty. Returns
  /// `false` if `progress` stopped it.
  bool run(const std::vector<long long>& stations, pcs::internal::Progress& progress)
  {
    if (!progress(0))
      return false;
    read_stations(stations);
    if (m_labels.size() < 2)
      find_stations(m_options.scan_grids);
    if (m_labels.size() < 2)
      return progress(1);
    m_places = m_scan.points;
    m_moves.assign(m_labels.size(), Move::Identity());
    double size = 0; // in noise
    // large motions blur the draft from which they are estimated
    for (int pass = 0; pass < m_options.alignment.passes; ++pass) {
      if (!improve(progress, size))
        return false;
      m_is_moved = m_is_moved || size > 0;
      if (size <= m_options.alignment.much)
        break;
    }
    return progress(1);
  }

  /// Moves the points if `run()` improved them, and reports the stations. Motions above `max_shift`
  /// and stations with few points are not plausible registration errors: in these cases, no point
  /// is moved, and the report contains the largest shift.
  void move(double max_shift, Scan& scan, Skeleton_report& report)
  {
    if (!m_is_moved)
      return;
    std::vector<Scan_station> found = stations();
    double largest = 0;
    bool is_plausible = true;
    for (const Scan_station& station : found) {
      largest = std::max(largest, station.shift.norm());
      is_plausible = is_plausible && station.number_of_points >= min_points_of_station;
    }
    if (!is_plausible || largest > max_shift) {
      report.rejected_station_shift = largest;
      report.is_rejected_station_detected = !m_grids.empty();
      return;
    }
    report.stations = std::move(found);
    pcs::internal::for_each_index<ConcurrencyTag>(m_places.size(), [&](std::size_t k) {
      m_places[k] = Scan_frame::rounded(m_places[k]);
    });
    scan.points = std::move(m_places);
  }

private:
  using Move = Eigen::Isometry3d; ///< in the frame

  /// Drafts the tree and moves the points. `size` is the size of the motions in noise, or 0 if they
  /// bring no improvement. Returns `false` if stopped.
  bool improve(pcs::internal::Progress& progress, double& size)
  {
    const Station_alignment_options& rules = m_options.alignment;
    // a subset of the points suffices for thick branches; thin branches need more
    for (m_stride = 1 + m_places.size() / enough;; m_stride = (m_stride + 3) / 4) {
      const auto draft = m_draft(chosen_places(), chosen_wood(), progress);
      if (!draft)
        return false;
      const Aligned_stations aligned = align(draft->scan(), draft->axes(), rules);
      const double noise = draft->axes().noise;
      const bool is_sure =
          aligned.error < rules.agreement * aligned.size || aligned.size < rules.least * noise;
      if (!is_sure && m_stride > 1 && m_places.size() / m_stride <= 2 * enough)
        continue;
      size = aligned.error < aligned.size && noise > 0 ? aligned.size / noise : 0;
      if (size > 0)
        add(aligned.motions, draft->scan().frame);
      return true;
    }
  }

  /// Most labels. More values do not denote stations, and the work grows with the cube of their
  /// number [count].
  static constexpr std::size_t most_stations = 100;
  /// Fewest points for an estimate of a motion [count].
  static constexpr std::size_t min_points_of_station = 100;
  /// Most points of the first draft [count].
  static constexpr std::size_t enough = 40000;

  /// Returns some blocks of neighbouring points.
  std::vector<Vec3> some_places() const
  {
    constexpr std::size_t most = 200000, block = 2000;
    const std::size_t n = m_scan.size(), every = 1 + n / most;
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < n; ++k)
      if (k / block % every == 0)
        places.push_back(m_scan.points[k]);
    return places;
  }

  void find_stations(const Scan_grid_options& rules)
  {
    m_labels.clear();
    m_grids = detect_scan_grids<ConcurrencyTag>(some_places(), rules);
    m_station.assign(m_scan.size(), none);
    if (m_grids.size() < 2)
      return;
    pcs::internal::for_each_index<ConcurrencyTag>(m_station.size(), [&](std::size_t k) {
      double least = rules.loosest;
      for (std::size_t s = 0; s < m_grids.size(); ++s) {
        const double misfit = m_grids[s].misfit(m_scan.points[k], least);
        if (misfit < least) {
          least = misfit;
          m_station[k] = static_cast<Index>(s);
        }
      }
    });
    for (std::size_t s = 0; s < m_grids.size(); ++s)
      m_labels.push_back(static_cast<long long>(s));
  }

  void read_stations(const std::vector<long long>& of_input)
  {
    if (of_input.empty())
      return;
    std::map<long long, Index> number;
    for (const long long label : of_input)
      if (label >= 0)
        number.emplace(label, 0);
    if (number.size() > most_stations)
      return; // the labels do not denote stations
    for (auto& entry : number) {
      entry.second = static_cast<Index>(m_labels.size());
      m_labels.push_back(entry.first);
    }
    m_station.assign(m_scan.size(), none);
    for (std::size_t i = 0; i < of_input.size(); ++i)
      if (of_input[i] >= 0) {
        Index& station = m_station[m_scan.point_of_input[i]];
        station = std::min(station, number.at(of_input[i]));
      }
  }

  std::vector<Vec3> chosen_places() const
  {
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < m_places.size(); k += m_stride)
      places.push_back(m_places[k]);
    return places;
  }

  std::vector<std::uint8_t> chosen_wood() const
  {
    if (m_is_wood.empty())
      return {};
    std::vector<std::uint8_t> is_wood(1 + (m_places.size() - 1) / m_stride, 0);
    for (std::size_t i = 0; i < m_is_wood.size(); ++i)
      if (m_is_wood[i] && m_scan.point_of_input[i] % m_stride == 0)
        is_wood[m_scan.point_of_input[i] / m_stride] = 1;
    return is_wood;
  }

  /// Estimates the motions of all stations from the axes of the draft, in its coordinates.
  Aligned_stations
  align(const Scan& scan, const Axis_set& axes, const Station_alignment_options& rules) const
  {
    std::vector<Index> station(scan.size(), none);
    for (std::size_t k = 0; k * m_stride < m_station.size(); ++k)
      station[scan.point_of_input[k]] = m_station[k * m_stride];
    return align_stations<ConcurrencyTag>(scan, axes, station, m_labels.size(), rules);
  }

  /// Adds motions in the frame of a draft, and moves the points.
  void add(const std::vector<Rigid_motion>& motions, const Scan_frame& draft)
  {
    std::vector<Move> steps;
    for (std::size_t s = 0; s < motions.size(); ++s) {
      const Rigid_motion& motion = motions[s];
      Move step = Move::Identity();
      step.linear() = draft.axes.transpose() * motion.rotation() * draft.axes;
      step.translation() = draft.to_input(motion(draft.to_local(Vec3::Zero())));
      m_moves[s] = step * m_moves[s];
      steps.push_back(step);
    }
    pcs::internal::for_each_index<ConcurrencyTag>(m_station.size(), [&](std::size_t k) {
      if (m_station[k] != none)
        m_places[k] = steps[m_station[k]] * m_places[k];
    });
  }

  std::vector<Scan_station> stations() const
  {
    std::vector<Scan_station> stations(m_labels.size());
    std::vector<Vec3> middle(m_labels.size(), Vec3::Zero()); // of the moved points
    for (std::size_t k = 0; k < m_station.size(); ++k)
      if (m_station[k] != none) {
        ++stations[m_station[k]].number_of_points;
        middle[m_station[k]] += m_places[k];
      }
    for (std::size_t s = 0; s < stations.size(); ++s) {
      Scan_station& station = stations[s];
      station.label = m_labels[s];
      const Vec3 after = middle[s] / double(std::max<std::size_t>(1, station.number_of_points));
      const Vec3 before = m_moves[s].inverse() * after;
      station.shift = m_scan.frame.unit * m_scan.frame.direction_to_input(after - before);
      station.turn = Eigen::AngleAxisd(m_moves[s].linear()).angle();
      if (!m_grids.empty()) {
        station.position = m_scan.frame.to_input(m_grids[s].position);
        station.azimuth_step = 1 / m_grids[s].rate[0];
        station.elevation_step = 1 / m_grids[s].rate[1];
      }
    }
    return stations;
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_wood; ///< of the input
  const Registration_options& m_options;
  const Draft& m_draft;
  std::size_t m_stride = 1;
  bool m_is_moved = false;
  std::vector<Vec3> m_places;      ///< of the scan, moved
  std::vector<Scan_grid> m_grids;  ///< empty if the caller gave the stations
  std::vector<Index> m_station;    ///< of each point, or `none`
  std::vector<long long> m_labels; ///< of the stations
  std::vector<Move> m_moves;       ///< of the stations
};

/*!
  Moves the points of each scanner station by a rigid motion so that all stations see the same
  branches, if there are several stations and the motions can be estimated. The report contains
  these motions. `stations` are the labels of the input points; if it is empty, stations are
  detected by their scan grids. `scan` needs only its points; `is_wood` is empty or has one entry
  per input point. `max_shift` is the largest plausible shift of a station, in the unit of the
  input. See `Station_registration` for `draft`. Returns `false` if `progress` stopped it; in this
  case, no point is moved.
*/
template <class ConcurrencyTag, class Draft>
bool register_stations(const std::vector<std::uint8_t>& is_wood,
                       const std::vector<long long>& stations,
                       const Registration_options& options,
                       double max_shift,
                       const Draft& draft,
                       Scan& scan,
                       Skeleton_report& report,
                       pcs::internal::Progress& progress)
{
  constexpr double fraction = 0.2; // of all work
  Station_registration<ConcurrencyTag, Draft> registration(scan, is_wood, options, draft);
  progress.stage(0, fraction);
  const bool is_done = registration.run(stations, progress);
  progress.stage(0, 1);
  if (is_done)
    registration.move(max_shift, scan, report);
  return is_done;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_REGISTER_STATIONS_H

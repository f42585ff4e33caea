// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Puts the points of all stations of a scan onto the same branches.

#ifndef PCS_SKELETON_REGISTER_STATIONS_H
#define PCS_SKELETON_REGISTER_STATIONS_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Scan.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Station_motion.h>
#include <pcs/skeleton/align_stations.h>
#include <pcs/skeleton/find_beam_grids.h>
#include <pcs/skeleton/frame_of_scan.h>
#include <pcs/skeleton/prepare_scan.h>

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
  Stations that are registered with an error make branches too thick or too thin by as much. `Stages` fits axes to some of the
  points; these tell how every station must move.
*/
template <class ConcurrencyTag, class Stages>
class Station_registration
{
public:
  /// `input` is moved; `is_wood` is empty or has one entry per point. The report gets the stations.
  Station_registration(const std::vector<std::uint8_t>& is_wood,
                       const Session_options& options,
                       std::vector<Vec3>& input,
                       Skeleton_report& report)
    : m_is_wood(is_wood), m_options(options), m_input(input), m_report(report)
  {
  }

  /// `false`: `progress` stopped it, and nothing is moved.
  bool run(pcs::internal::Progress& progress)
  {
    m_frame = frame_of_scan<ConcurrencyTag>(m_input, m_options.up);
    m_distinct = internal::distinct_places<ConcurrencyTag>(m_input, m_frame);
    if (!progress(0))
      return false;
    if (m_options.stations.empty())
      find_stations();
    else
      read_stations();
    if (m_labels.size() < 2)
      return progress(1);
    Stages draft(chosen_places(), chosen_wood(), draft_options());
    if (!draft.fit_axes(progress))
      return false;
    move_input(draft);
    return progress(1);
  }

private:
  /// More points do not tell more of the motions.
  static constexpr std::size_t enough = 100000;

  void find_stations()
  {
    m_grids = find_beam_grids<ConcurrencyTag>(m_distinct.places, m_options.beam_grids);
    m_station.assign(m_distinct.places.size(), none);
    if (m_grids.size() < 2)
      return;
    pcs::internal::for_each_index<ConcurrencyTag>(m_station.size(), [&](std::size_t k) {
      double least = m_options.beam_grids.loosest;
      for (std::size_t s = 0; s < m_grids.size(); ++s) {
        const Beam_grid& grid = m_grids[s];
        const double misfit = grid.misfit(m_distinct.places[k]) / grid.tolerance;
        if (misfit < least) {
          least = misfit;
          m_station[k] = static_cast<Index>(s);
        }
      }
    });
    for (std::size_t s = 0; s < m_grids.size(); ++s)
      m_labels.push_back(static_cast<long long>(s));
  }

  void read_stations()
  {
    std::map<long long, Index> number;
    for (const Index i : m_distinct.chosen)
      if (m_options.stations[i] >= 0)
        number.emplace(m_options.stations[i], 0);
    for (auto& entry : number) {
      entry.second = static_cast<Index>(m_labels.size());
      m_labels.push_back(entry.first);
    }
    for (const Index i : m_distinct.chosen)
      m_station.push_back(m_options.stations[i] >= 0 ? number.at(m_options.stations[i]) : none);
  }

  std::size_t stride() const { return 1 + m_distinct.places.size() / enough; }

  std::vector<Vec3> chosen_places() const
  {
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < m_distinct.places.size(); k += stride())
      places.push_back(m_distinct.places[k]);
    return places;
  }

  std::vector<std::uint8_t> chosen_wood() const
  {
    std::vector<std::uint8_t> is_wood;
    for (std::size_t k = 0; k < m_distinct.places.size() && !m_is_wood.empty(); k += stride())
      is_wood.push_back(m_is_wood[m_distinct.chosen[k]]);
    return is_wood;
  }

  Session_options draft_options() const
  {
    Session_options options = m_options;
    options.do_register_stations = false;
    options.stations.clear();
    options.method = Skeleton_method::chains;
    options.given.reset();
    options.up = Vec3::UnitZ();
    options.scanners.clear();
    options.breast_height /= m_frame.unit;
    if (options.root)
      options.root = m_frame.to_local(*options.root);
    return options;
  }

  /// Moves the points by what the axes of the draft tell.
  void move_input(const Stages& draft)
  {
    const Scan& scan = draft.scan();
    if (draft.axes().axes.empty())
      return;
    std::vector<Index> station(scan.size(), none);
    for (std::size_t k = 0; k * stride() < m_station.size(); ++k)
      station[scan.point_of_input[k]] = m_station[k * stride()];
    const std::vector<Station_motion> motions = align_stations<ConcurrencyTag>(
        scan, draft.axes(), station, m_labels.size(), m_options.alignment);
    const auto moved = [&](const Vec3& p, const Station_motion& motion) {
      const Vec3 local = scan.frame.to_local(m_frame.to_local(p));
      return m_frame.to_input(scan.frame.to_input(motion(local)));
    };
    std::vector<Scan_station> stations(m_labels.size());
    std::vector<Vec3> middle(m_labels.size(), Vec3::Zero());
    for (std::size_t i = 0; i < m_input.size(); ++i) {
      const Index s = m_station[m_distinct.of_point[i]];
      if (s == none)
        continue;
      ++stations[s].number_of_points;
      middle[s] += m_input[i];
    }
    for (std::size_t s = 0; s < stations.size(); ++s) {
      Scan_station& station = stations[s];
      station.label = m_labels[s];
      const Vec3 center = middle[s] / double(std::max<std::size_t>(1, station.number_of_points));
      station.shift = moved(center, motions[s]) - center;
      station.turn = motions[s].turn.norm();
      if (!m_grids.empty()) {
        station.position = m_frame.to_input(m_grids[s].position);
        station.azimuth_step = 1 / m_grids[s].rate[0];
        station.elevation_step = 1 / m_grids[s].rate[1];
      }
    }
    pcs::internal::for_each_index<ConcurrencyTag>(m_input.size(), [&](std::size_t i) {
      const Index s = m_station[m_distinct.of_point[i]];
      if (s != none)
        m_input[i] = moved(m_input[i], motions[s]);
    });
    m_report.stations = std::move(stations);
  }

  const std::vector<std::uint8_t>& m_is_wood;
  const Session_options& m_options;
  std::vector<Vec3>& m_input;
  Skeleton_report& m_report;
  Scan_frame m_frame;
  internal::Distinct_places m_distinct;
  std::vector<Beam_grid> m_grids;   ///< empty where the caller knows the stations
  std::vector<Index> m_station;     ///< of each place, or `none`
  std::vector<long long> m_labels; ///< of the stations
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTER_STATIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Completes the hidden wood of a scanned tree, and writes it and its figures, named as inferred.

#ifndef PCS_EXAMPLES_PROGRAMS_HABIT_COMPLETE_WOOD_H
#define PCS_EXAMPLES_PROGRAMS_HABIT_COMPLETE_WOOD_H

#include "Habit_options.h"
#include "Habit_run.h"
#include "common/Report_file.h"
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/core/errors.h>
#include <pcs/generators/Hidden_wood.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/complete_hidden_wood.h>

#include <CGAL/property_map.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace program {

using Wood_kernel = Habit_kernel;

/// The inferred branches as SWC. The first comment says that they are inferred; nodes without
/// parent begin on the measured skeleton.
inline std::string swc_of(const pcs::Hidden_wood<Wood_kernel>& wood)
{
  const auto& tree = wood.branches;
  const auto& branches = tree[boost::graph_bundle].branches;
  std::string text = "# inferred hidden wood, not measured; it begins on the measured skeleton\n"
                     "# id type x y z radius parent\n";
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    pcs::IO::internal::append_number(text, v + 1);
    text += ' ';
    pcs::IO::internal::append_number(text, 5 + branches[tree[v].branch].order);
    const auto& p = tree[v].point;
    for (const double value : {p.x(), p.y(), p.z(), tree[v].radius}) {
      text += ' ';
      pcs::IO::internal::append_number(text, value);
    }
    const std::size_t parent = pcs::parent_node<Wood_kernel>(v, tree);
    text += parent == pcs::npos ? " -1\n" : " " + std::to_string(parent + 1) + "\n";
  }
  return text;
}

inline nlohmann::ordered_json json_of(const pcs::Inferred_volume& v)
{
  return {{"value", v.value},
          {"standard_error", v.standard_error},
          {"interval_95", {v.least, v.largest}}};
}

inline nlohmann::ordered_json json_of(const pcs::Hidden_wood<Wood_kernel>& wood)
{
  return {{"measured_volume", wood.measured_volume},
          {"inferred_volume", json_of(wood.inferred_volume)},
          {"inferred_hidden_branches", json_of(wood.hidden_branches)},
          {"inferred_missing_stems", json_of(wood.missing_stems)},
          {"inferred_radius_correction", json_of(wood.radius_correction)},
          {"measured_and_inferred_volume", json_of(wood.total_volume)},
          {"inferred_branches", wood.branches[boost::graph_bundle].branches.size()},
          {"inferred_stems", wood.number_of_stems},
          {"hidden_crown_share", wood.hidden_crown_share},
          {"angular_step", wood.angular_step},
          {"grid_share", wood.grid_share},
          {"scanned_share", wood.scanned_share}};
}

/// Sentences about results that are probably wrong.
inline std::vector<std::string> warnings(const pcs::Hidden_wood<Wood_kernel>& wood)
{
  constexpr double fewest = 0.5;
  const auto percent = [](double share) { return std::to_string(std::lround(100 * share)) + " %"; };
  std::vector<std::string> result;
  if (wood.scanned_share < fewest)
    result.push_back("returns lie beside " + percent(wood.scanned_share) +
                     " of the length of the skeleton; check that the skeleton is of this scan, and "
                     "in its coordinates");
  if (wood.grid_share < fewest)
    result.push_back("the next return is at the angle of --step-degrees for " +
                     percent(wood.grid_share) +
                     " of the returns; check --scanner and --step-degrees, and that the scan has "
                     "all returns");
  if (wood.inferred_volume.value > wood.measured_volume)
    result.push_back("more wood is inferred than measured; check --scanner, --step-degrees and the "
                     "habit, or scan from more stations");
  return result;
}

/// Returns the stations of the points, counted from 0.
inline std::vector<std::int64_t>
stations_of(const pcs::IO::Point_table& table, std::size_t number, const Habit_options& options)
{
  const auto at_point = [&](std::size_t i) {
    return options.scan + ": point " + std::to_string(i) + ": property '" + options.stations + "'";
  };
  std::vector<std::int64_t> result(table.points().size(), 0);
  if (!table.has_property(options.stations)) {
    if (number == 1)
      return result;
    throw pcs::Invalid_input(options.scan + " has no property '" + options.stations +
                             "' with the station of each point, counted from 0 in the order of "
                             "--scanner; name it by --stations");
  }
  const std::vector<double> stations = table.property_as_double(options.stations);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (number == 1 && stations[i] != stations[0])
      throw pcs::Invalid_input(at_point(i) + " differs from that of point 0, but --scanner names "
                                             "one station; give x y z of all stations");
    if (stations[i] != std::floor(stations[i]) || std::abs(stations[i]) > 1e9)
      throw pcs::Invalid_input(at_point(i) + " must be the number of a station, counted from 0; "
                                             "name another property by --stations");
    result[i] = number == 1 ? 0 : static_cast<std::int64_t>(stations[i]);
  }
  return result;
}

/// Reads the scan and infers the hidden wood of `tree`, whose z axis is up. The inferred branches
/// have the coordinates of the scan.
inline pcs::Hidden_wood<Wood_kernel> complete_wood(const pcs::Tree_skeleton<Wood_kernel>& tree,
                                                   const pcs::Tree_habit_fit& fit,
                                                   const Habit_run& run)
{
  const Habit_options& options = run.options;
  using Labelled = std::pair<Wood_kernel::Point_3, std::int64_t>;
  std::vector<Wood_kernel::Point_3> scanners;
  for (std::size_t i = 0; i + 2 < options.scanners.size(); i += 3)
    scanners.push_back(run.upright(Wood_kernel::Point_3(options.scanners[i],
                                                        options.scanners[i + 1],
                                                        options.scanners[i + 2])));
  const pcs::IO::Point_table table = pcs::IO::read_points(options.scan);
  const std::vector<std::int64_t> stations = stations_of(table, scanners.size(), options);
  std::vector<Labelled> points;
  points.reserve(stations.size());
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const auto& p = table.points()[i];
    points.emplace_back(run.upright(Wood_kernel::Point_3(p.x(), p.y(), p.z())), stations[i]);
  }
  auto wood = name_refusals(options.complete, [&] {
    return pcs::complete_hidden_wood(tree,
                                     points,
                                     fit,
                                     pcs::parameters::scanner_positions(scanners)
                                         .point_map(CGAL::First_of_pair_property_map<Labelled>())
                                         .station_map(CGAL::Second_of_pair_property_map<Labelled>())
                                         .angular_step(options.step_degrees * CGAL_PI / 180)
                                         .number_of_simulations(options.simulations)
                                         .random_seed(options.seed));
  });
  for (std::size_t v = 0; v < num_vertices(wood.branches); ++v)
    wood.branches[v].point = run.upright.back(wood.branches[v].point);
  return wood;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_HABIT_COMPLETE_WOOD_H

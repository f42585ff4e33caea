// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Completes the hidden wood of a scanned tree, and writes it and its figures, named as inferred.

#ifndef PCS_EXAMPLES_PROGRAMS_HABIT_COMPLETE_WOOD_H
#define PCS_EXAMPLES_PROGRAMS_HABIT_COMPLETE_WOOD_H

#include "Habit_options.h"
#include "common/Report_file.h"
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/core/errors.h>
#include <pcs/generators/Hidden_wood.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/complete_hidden_wood.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace program {

using Wood_kernel = CGAL::Simple_cartesian<double>;

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
          {"angular_step", wood.angular_step}};
}

/// Reads the scan and infers the hidden wood of `tree`.
inline pcs::Hidden_wood<Wood_kernel> complete_wood(const pcs::Tree_skeleton<Wood_kernel>& tree,
                                                   const pcs::Tree_habit_fit& fit,
                                                   const Habit_options& options)
{
  using Labelled = std::pair<Wood_kernel::Point_3, std::int64_t>;
  std::vector<Wood_kernel::Point_3> scanners;
  for (std::size_t i = 0; i + 2 < options.scanners.size(); i += 3)
    scanners.emplace_back(options.scanners[i], options.scanners[i + 1], options.scanners[i + 2]);
  const pcs::IO::Point_table table = pcs::IO::read_points(options.scan);
  std::vector<Labelled> points;
  for (const auto& p : table.points())
    points.emplace_back(Wood_kernel::Point_3(p.x(), p.y(), p.z()), 0);
  if (scanners.size() > 1) {
    if (!table.has_property(options.stations))
      throw pcs::Invalid_input(options.scan + " has no property '" + options.stations +
                               "' with the station of each point, counted from 0 in the order of "
                               "--scanner; name it by --stations");
    const std::vector<double> stations = table.property_as_double(options.stations);
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i].second = static_cast<std::int64_t>(stations[i]);
  }
  return pcs::complete_hidden_wood(tree,
                                   points,
                                   fit,
                                   pcs::parameters::scanner_positions(scanners)
                                       .point_map(CGAL::First_of_pair_property_map<Labelled>())
                                       .station_map(CGAL::Second_of_pair_property_map<Labelled>())
                                       .angular_step(options.step_degrees * CGAL_PI / 180)
                                       .number_of_simulations(options.simulations)
                                       .random_seed(options.seed));
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_HABIT_COMPLETE_WOOD_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The report of a skeletonization as JSON.

#ifndef PCS_EXAMPLES_PROGRAMS_SKELETON_SKELETON_REPORT_H
#define PCS_EXAMPLES_PROGRAMS_SKELETON_SKELETON_REPORT_H

#include <pcs/extract_tree_skeleton.h>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <utility>

namespace program {

/// Converts a warning or error of the library: replaces named parameters by options of the program.
inline std::string in_options(std::string sentence)
{
  for (const auto& [parameter, option] :
       {std::make_pair("do_remove_leaves(true)", "--remove-leaves"),
        std::make_pair("do_remove_leaves(false)", "--keep-leaves"),
        std::make_pair("do_continue_trunk(false)", "--keep-trunk"),
        std::make_pair("do_register_stations(false)", "--keep-stations"),
        std::make_pair("root_position", "--root"),
        std::make_pair("given_skeleton", "--skeleton"),
        std::make_pair("up_direction", "--up"),
        std::make_pair("unit of breast_height", "unit of --breast-height"),
        std::make_pair("skeleton_method(level_sets)", "--method level_sets"),
        std::make_pair("skeleton_method(chains)", "--method chains"),
        std::make_pair("breast height, which", "--breast-height, which")}) {
    const std::size_t at = sentence.find(parameter);
    if (at != std::string::npos)
      sentence.replace(at, std::string(parameter).size(), option);
  }
  return sentence;
}

inline nlohmann::ordered_json to_json(const pcs::Branch_totals& wood)
{
  return {{"branches", wood.number_of_branches}, {"length", wood.length}, {"volume", wood.volume}};
}

inline nlohmann::ordered_json to_json(const pcs::Scan_station& s)
{
  nlohmann::ordered_json json = {{"label", s.label},
                                 {"points", s.number_of_points},
                                 {"shift", {s.shift.x(), s.shift.y(), s.shift.z()}},
                                 {"turn", s.turn}};
  if (s.azimuth_step > 0) { // found
    json["position"] = {s.position.x(), s.position.y(), s.position.z()};
    json["steps"] = {s.azimuth_step, s.elevation_step};
  }
  return json;
}

inline nlohmann::ordered_json to_json(const pcs::Skeleton_spread& s)
{
  return {{"copies", s.number_of_copies},
          {"empty_copies", s.number_of_empty_copies},
          {"leafy_copies", s.number_of_leafy_copies},
          {"leaf_removal_changed", s.is_leaf_removal_changed},
          {"displaced", s.is_displaced},
          {"height", s.height},
          {"diameter_at_breast_height", s.diameter_at_breast_height},
          {"trunk_length", s.trunk_length},
          {"length", s.length},
          {"volume", s.volume},
          {"trunk_volume", s.trunk_volume},
          {"volume_by_size", s.volume_by_size},
          {"root", s.root}};
}

inline nlohmann::ordered_json to_json(const pcs::Tree_values& v)
{
  return {{"height", v.height},
          {"diameter_at_breast_height", v.diameter_at_breast_height},
          {"trunk_length", v.trunk_length},
          {"length", v.length},
          {"volume", v.volume},
          {"trunk_volume", v.trunk_volume},
          {"volume_by_size", v.volume_by_size}};
}

/// Returns a diameter at breast height, which is null if the tree is lower.
inline nlohmann::ordered_json diameter_json(double diameter)
{
  return diameter > 0 ? nlohmann::ordered_json(diameter) : nlohmann::ordered_json(nullptr);
}

/// Returns the value of the option `--method`.
inline const char* name_of(pcs::Skeleton_method method)
{
  switch (method) {
  case pcs::Skeleton_method::chains:
    return "chains";
  case pcs::Skeleton_method::sections:
    return "sections";
  case pcs::Skeleton_method::level_sets:
    return "level_sets";
  default:
    return "automatic";
  }
}

/// Returns all members of the report; lengths are in the unit of the input.
inline nlohmann::ordered_json to_json(const std::string& input, const pcs::Skeleton_report& r)
{
  nlohmann::ordered_json json;
  json["input"] = input;
  json["status"] = pcs::to_string(r.status);
  json["method"] = name_of(r.method);
  json["points"] = {{"all", r.number_of_points},
                    {"duplicates", r.number_of_duplicates},
                    {"scan", r.number_of_scan_points},
                    {"outliers", r.number_of_outliers},
                    {"leaves", r.number_of_leaf_points},
                    {"ground", r.number_of_ground_points},
                    {"objects", r.number_of_object_points},
                    {"walls", r.number_of_wall_points},
                    {"unexplained", r.number_of_unexplained_points},
                    {"unexplained_thick", r.number_of_unexplained_thick_points},
                    {"unreachable", r.number_of_unreached_points}};
  json["spacing"] = r.spacing;
  json["voxel_size"] = r.voxel_size;
  json["merging_cell"] = r.merging_cell;
  json["coordinate_step"] = r.coordinate_step;
  json["noise"] = r.noise;
  json["residual"] = r.residual;
  json["blade_fraction"] = r.blade_fraction;
  json["nodes"] = r.number_of_nodes;
  json["branches"] = r.number_of_branches;
  json["unreachable_branches"] = r.number_of_unreached_branches;
  json["standing_branches"] = r.number_of_standing_branches;
  json["other_stems"] = r.number_of_other_stems;
  json["in_rows"] = r.is_in_rows;
  json["stations"] = nlohmann::ordered_json::array();
  for (const pcs::Scan_station& s : r.stations)
    json["stations"].push_back(to_json(s));
  json["warnings"] = nlohmann::ordered_json::array();
  for (const std::string& sentence : pcs::warnings(r))
    json["warnings"].push_back(in_options(sentence));
  json.update(to_json(r.estimates));
  json["diameter_at_breast_height"] = diameter_json(r.estimates.diameter_at_breast_height);
  json["root_elevation"] = r.root_elevation;
  json["inclination"] = r.inclination;
  json["max_root_distance"] = r.max_root_distance;
  json["hidden_trunk_length"] = r.hidden_trunk_length;
  json["hidden_trunk_volume"] = r.hidden_trunk_volume;
  json["breast_height"] = r.breast_height;
  json["skeleton"] = {{"height", r.height},
                      {"diameter_at_breast_height", diameter_json(r.diameter_at_breast_height)}};
  json["stem_diameters"] = r.stem_diameters;
  json["total"] = to_json(r.total);
  json["by_order"] = nlohmann::ordered_json::array();
  for (const pcs::Branch_totals& wood : r.by_order)
    json["by_order"].push_back(to_json(wood));
  json["by_size"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < r.by_size.size(); ++k) {
    nlohmann::ordered_json size = to_json(r.by_size[k]);
    size.erase("branches");
    size["radius_from"] = k > 0 ? r.size_bounds[k - 1] : 0.0;
    if (k < r.size_bounds.size())
      size["radius_to"] = r.size_bounds[k];
    json["by_size"].push_back(size);
  }
  if (r.spread.number_of_copies + r.spread.number_of_empty_copies > 0)
    json["spread"] = to_json(r.spread);
  if (r.spread.number_of_copies > 1)
    json["standard_errors"] = to_json(pcs::standard_errors(r));
  json["seconds"] = {{"neighbors", r.seconds.neighbors},
                     {"paths", r.seconds.paths},
                     {"axes", r.seconds.axes},
                     {"joints", r.seconds.joints},
                     {"sections", r.seconds.sections}};
  return json;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SKELETON_SKELETON_REPORT_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The trees of a tile, as segment_trees writes them and merge_tiles reads them.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_TILE_RESULT_H
#define PCS_EXAMPLES_PROGRAMS_TILING_TILE_RESULT_H

#include "common/Json_value.h"
#include "tiling/Index_sample.h"
#include "tiling/Tile.h"
#include "tiling/Tile_manifest.h"
#include <pcs/IO/points/Point_table.h>

#include <nlohmann/json.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace program {

/// A tree that was found in a tile with its buffer.
struct Tree_of_tile
{
  std::array<double, 3> foot{};
  double radius = 0, diameter_at_breast_height = 0; ///< [L]
  std::uint64_t number_of_core_points = 0;
  bool is_foot_in_core = false;
  bool is_at_rim = false; ///< touches the outer rim of the buffer where the plot continues
  /// Indices of points of the tile and its buffer, see `Index_sample`; empty away from the core's
  /// border.
  std::vector<std::uint64_t> sample;
  std::vector<std::string> warnings; ///< reasons to doubt the tree
};

/// The result of a tile without its points.
struct Tile_result
{
  Box_2 core, buffered;
  std::uint64_t number_of_core_points = 0;
  double breast_height = 0; ///< [L]
  std::vector<Tree_of_tile> trees;
};

/// Returns the path of the core points of a tile, which have the properties of the tile except for
/// `is_core`, and `tree`.
inline std::string points_of_result(const std::string& folder, const std::string& tile)
{
  return (std::filesystem::path(folder) / tile).string();
}

/// Returns the path of the trees of a tile. This file is written last.
inline std::string trees_of_result(const std::string& folder, const std::string& tile)
{
  return (std::filesystem::path(folder) / tile).replace_extension(".json").string();
}

inline nlohmann::ordered_json to_json(const Tile_result& result)
{
  nlohmann::ordered_json trees = nlohmann::ordered_json::array();
  for (std::size_t t = 0; t < result.trees.size(); ++t) {
    const Tree_of_tile& tree = result.trees[t];
    trees.push_back({{"tree", t},
                     {"foot", tree.foot},
                     {"is_foot_in_core", tree.is_foot_in_core},
                     {"radius", tree.radius},
                     {"diameter_at_breast_height", tree.diameter_at_breast_height},
                     {"core_points", tree.number_of_core_points},
                     {"is_at_rim", tree.is_at_rim}});
    if (!tree.sample.empty())
      trees.back()["sample"] = tree.sample;
    if (!tree.warnings.empty())
      trees.back()["warnings"] = tree.warnings;
  }
  return {{"core", to_json(result.core)},
          {"buffered", to_json(result.buffered)},
          {"core_points", result.number_of_core_points},
          {"breast_height", result.breast_height},
          {"trees", trees}};
}

namespace internal {

inline bool read_flag(const Json_value& value)
{
  if (!value.json().is_boolean())
    value.fail_expected("true or false");
  return value.json().get<bool>();
}

inline Json_value member(const Json_value& value, const char* key)
{
  if (!value.json().is_object() || !value.has(key))
    value.fail_expected("an object with " + std::string(key));
  return value[key];
}

inline Tree_of_tile read_tree_of_tile(const Json_value& value)
{
  Tree_of_tile tree;
  const Eigen::Vector3d foot = member(value, "foot").vector_3();
  tree.foot = {foot.x(), foot.y(), foot.z()};
  tree.is_foot_in_core = read_flag(member(value, "is_foot_in_core"));
  tree.radius = member(value, "radius").number();
  tree.diameter_at_breast_height = member(value, "diameter_at_breast_height").number();
  tree.number_of_core_points = read_count(member(value, "core_points"));
  tree.is_at_rim = read_flag(member(value, "is_at_rim"));
  if (value.has("sample")) {
    const Json_value sample = value["sample"];
    if (!sample.json().is_array() || sample.size() > Index_sample::size)
      sample.fail_expected("an array of at most " + std::to_string(Index_sample::size) +
                           " indices");
    for (std::size_t i = 0; i < sample.size(); ++i)
      tree.sample.push_back(read_count(sample[i]));
  }
  if (value.has("warnings")) {
    const Json_value warnings = value["warnings"];
    if (!warnings.json().is_array())
      warnings.fail_expected("an array of texts");
    for (std::size_t i = 0; i < warnings.size(); ++i) {
      if (!warnings[i].json().is_string())
        warnings[i].fail_expected("a text");
      tree.warnings.push_back(warnings[i].json().get<std::string>());
    }
  }
  return tree;
}

} // namespace internal

/// Reads the trees of a tile. Throws `pcs::IO_error` if the file is missing or damaged.
inline Tile_result read_tile_result(const std::string& path)
{
  using internal::member;
  const Json json = read_json(path, "the trees of a tile");
  const Json_value top(json, path);
  Tile_result result;
  result.core = read_box(member(top, "core"));
  result.buffered = read_box(member(top, "buffered"));
  result.number_of_core_points = read_count(member(top, "core_points"));
  result.breast_height = member(top, "breast_height").number();
  if (!(result.breast_height > 0))
    top["breast_height"].fail_expected("a positive number");
  const Json_value trees = member(top, "trees");
  if (!trees.json().is_array())
    trees.fail_expected("an array of trees");
  for (std::size_t t = 0; t < trees.size(); ++t)
    result.trees.push_back(internal::read_tree_of_tile(trees[t]));
  return result;
}

/// Returns a property with indices of points. Throws `pcs::Invalid_input` if it is missing, or not
/// of type `uint32` or `uint64`.
inline std::vector<std::uint64_t> indices_of(const pcs::IO::Point_table& table,
                                             const std::string& name = "index")
{
  if (table.has_property(name) && table.property_type(name) == pcs::IO::Scalar_type::uint64)
    return table.property<std::uint64_t>(name);
  const std::vector<std::uint32_t>& index = table.property<std::uint32_t>(name);
  return {index.begin(), index.end()};
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_TILE_RESULT_H

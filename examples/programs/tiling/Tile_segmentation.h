// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes the trees of a tile and the tree of every point of its core.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_TILE_SEGMENTATION_H
#define PCS_EXAMPLES_PROGRAMS_TILING_TILE_SEGMENTATION_H

#include "common/check_output.h"
#include "tiling/Tile_manifest.h"
#include "tiling/Tile_result.h"
#include "tiling/horizontal.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>
#include <pcs/segment_trees.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace program {

/*!
  The segmentation of one tile of tile_points. The folder of the tile has tiles.json. The results
  are NAME.ply, the core points with the property `tree`, and NAME.json, which is written last.
*/
class Tile_segmentation
{
public:
  /// Points that are copied at a time.
  static constexpr std::size_t chunk_size = std::size_t(1) << 18;

  /// Checks the tile and that the results can be written. Throws `pcs::IO_error`.
  Tile_segmentation(const std::string& tile, const std::string& folder)
    : m_path(tile), m_manifest(manifest_of(tile)), m_name(name_of(tile)), m_folder(folder)
  {
    const std::size_t number = m_manifest.find(m_name);
    if (number == m_manifest.tiles().size())
      throw pcs::IO_error(manifest_of(tile), "has no tile " + m_name);
    m_tile = m_manifest.tiles()[number];
    const pcs::IO::Point_reader reader(tile);
    for (const char* name : {"index", "is_core"})
      if (!reader.schema().has(name))
        throw pcs::IO_error(tile,
                            "has no property '" + std::string(name) +
                                "', so it is no tile; make tiles by tile_points");
    if (reader.number_of_points() && *reader.number_of_points() != m_tile.number_of_points)
      throw pcs::IO_error(tile,
                          "has " + std::to_string(*reader.number_of_points()) +
                              " points, but tiles.json lists " +
                              std::to_string(m_tile.number_of_points) + "; make the tiles again");
    m_schema.properties.clear();
    for (const pcs::IO::Property_description& p : reader.schema().properties)
      if (p.name != "is_core" && p.name != "tree")
        m_schema.properties.push_back(p);
    m_schema.properties.push_back({"tree", pcs::IO::Scalar_type::int32});
    check_output(path_of_points(), m_schema);
  }

  const std::string& up() const { return m_manifest.up(); }
  std::string path_of_points() const { return points_of_result(m_folder, m_name); }
  std::string path_of_trees() const { return trees_of_result(m_folder, m_name); }

  /*!
    Computes the result from the segmented points, which are all points of the tile or a part in
    the same order, and writes the core points. `trees`: tree of each point, -1 for none. Points
    of the core that are not in the table have no tree.
  */
  Tile_result write_points(const pcs::IO::Point_table& table,
                           const std::vector<std::int32_t>& trees,
                           const pcs::Segmentation_report& report) const
  {
    Tile_result result = describe(table, trees, report);
    std::error_code error;
    std::filesystem::remove(path_of_trees(), error); // it would belong to other points
    const std::vector<std::uint64_t> index = indices_of(table);
    pcs::IO::Point_writer writer(path_of_points(), m_schema);
    pcs::IO::Point_reader reader(m_path);
    pcs::IO::Point_table chunk;
    std::size_t next = 0; // of the segmented points
    while (reader.read(chunk, chunk_size)) {
      const std::vector<std::uint64_t> place = indices_of(chunk);
      const auto& is_core = chunk.property<std::uint8_t>("is_core");
      std::vector<std::size_t> chosen;
      std::vector<std::int32_t> tree_of_chosen;
      for (std::size_t i = 0; i < place.size(); ++i) {
        const bool is_segmented = next < index.size() && index[next] == place[i];
        if (is_core[i] != 0) {
          chosen.push_back(i);
          tree_of_chosen.push_back(is_segmented ? trees[next] : -1);
        }
        next += is_segmented;
      }
      pcs::IO::Point_table part = chunk.select(chosen);
      for (const char* name : {"is_core", "tree"})
        if (part.has_property(name))
          part.remove_property(name);
      part.add_property("tree", std::move(tree_of_chosen));
      writer.append(part);
    }
    result.number_of_core_points = writer.number_of_points();
    if (next != index.size() || result.number_of_core_points != m_tile.number_of_core_points)
      throw pcs::IO_error(m_path,
                          "has other points than tiles.json lists, or was changed while it was "
                          "read; make the tiles again");
    writer.commit();
    return result;
  }

  /// Returns warnings about trees that are cut at the rim of the buffer.
  static std::vector<std::string> warnings(const Tile_result& result)
  {
    std::size_t own = 0, others = 0;
    for (const Tree_of_tile& tree : result.trees)
      if (tree.is_at_rim && tree.number_of_core_points > 0)
        ++(tree.is_foot_in_core ? own : others);
    if (own + others == 0)
      return {};
    return {std::to_string(own + others) +
            " tree(s) with points in the core touch the outer rim "
            "of the buffer (" +
            std::to_string(own) +
            " with the foot in the core), so the labels of the core may be wrong; make tiles "
            "with a larger --buffer and the same --tile-points in another folder, and segment "
            "this tile again: its core remains the same"};
  }

private:
  static std::string name_of(const std::string& tile)
  {
    return std::filesystem::path(tile).filename().string();
  }
  static std::string manifest_of(const std::string& tile)
  {
    return (std::filesystem::path(tile).parent_path() / "tiles.json").string();
  }

  Tile_result describe(const pcs::IO::Point_table& table,
                       const std::vector<std::int32_t>& trees,
                       const pcs::Segmentation_report& report) const
  {
    constexpr double rim = 0.1; // in breast heights: more than the spacing of points
    const std::size_t axis_up = m_manifest.axis_up();
    Tile_result result;
    result.core = m_tile.core;
    result.buffered = m_tile.buffered;
    result.breast_height = report.breast_height;
    const std::vector<std::vector<std::string>> reasons = pcs::warnings_of_trees(report);
    for (const pcs::Segmented_tree& found : report.trees) {
      Tree_of_tile tree;
      tree.warnings = reasons[result.trees.size()];
      tree.foot = found.foot;
      tree.radius = found.radius;
      tree.diameter_at_breast_height = found.diameter_at_breast_height;
      const pcs::IO::Point_table::Point_3 foot(found.foot[0], found.foot[1], found.foot[2]);
      tree.is_foot_in_core =
          m_manifest.owner_of(horizontal(foot, axis_up)) == m_manifest.find(m_name);
      result.trees.push_back(tree);
    }
    const auto& is_core = table.property<std::uint8_t>("is_core");
    const std::vector<std::uint64_t> index = indices_of(table);
    std::vector<Index_sample> samples(result.trees.size());
    for (std::size_t i = 0; i < trees.size(); ++i) {
      if (trees[i] < 0)
        continue;
      samples[static_cast<std::size_t>(trees[i])].add(index[i]);
      Tree_of_tile& tree = result.trees[static_cast<std::size_t>(trees[i])];
      tree.number_of_core_points += is_core[i] != 0;
      const Position_2 p = horizontal(table.points()[i], axis_up);
      tree.is_at_rim =
          tree.is_at_rim || m_manifest.is_at_rim(m_tile, p, rim * report.breast_height);
    }
    for (std::size_t k = 0; k < result.trees.size(); ++k) {
      Tree_of_tile& tree = result.trees[k];
      const pcs::IO::Point_table::Point_3 foot(tree.foot[0], tree.foot[1], tree.foot[2]);
      if (tree.is_foot_in_core &&
          is_near_border(m_tile.core, horizontal(foot, axis_up), report.breast_height))
        tree.sample = samples[k].indices();
    }
    return result;
  }

  /// Returns whether a position is less than `width` away from a side of a box, or outside.
  static bool is_near_border(const Box_2& box, const Position_2& p, double width)
  {
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (p[axis] < box.low[axis] + width || p[axis] > box.high[axis] - width)
        return true;
    return false;
  }

  std::string m_path;
  Tile_manifest m_manifest;
  std::string m_name, m_folder;
  Listed_tile m_tile;
  pcs::IO::Point_schema m_schema; ///< of the core points
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_TILE_SEGMENTATION_H

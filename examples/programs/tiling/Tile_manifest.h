// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads tiles.json, and finds the tile that owns a position.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_TILE_MANIFEST_H
#define PCS_EXAMPLES_PROGRAMS_TILING_TILE_MANIFEST_H

#include "common/Json_value.h"
#include "tiling/Tile.h"
#include <pcs/core/errors.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace program {

/// Reads a count. Throws `pcs::IO_error`.
inline std::uint64_t read_count(const Json_value& value)
{
  if (!value.json().is_number_unsigned())
    value.fail_expected("a count");
  return value.json().get<std::uint64_t>();
}

/// Reads a rectangle `{"low": [x, y], "high": [x, y]}` that is not empty. Throws `pcs::IO_error`.
inline Box_2 read_box(const Json_value& value)
{
  value.object({"low", "high"});
  Box_2 box;
  for (const char* key : {"low", "high"}) {
    if (!value.has(key))
      value.fail_expected("an object with low, high");
    const Json_value corner = value[key];
    corner.array(2, "[x, y]");
    Position_2& p = key[0] == 'l' ? box.low : box.high;
    for (std::size_t axis = 0; axis < 2; ++axis)
      p[axis] = corner[axis].number();
  }
  if (!(box.low[0] < box.high[0] && box.low[1] < box.high[1]))
    value.fail_expected("a rectangle with low < high");
  return box;
}

/// A tile of the manifest.
struct Listed_tile : Tile
{
  std::string file;                   ///< its name in the folder of the manifest
  std::uint64_t number_of_points = 0; ///< with the buffer
};

/// A file of all points of a part of a plot that was thinned.
struct Listed_block
{
  Box_2 core;                         ///< half-open
  std::string file;                   ///< its name in the folder of the manifest
  std::uint64_t number_of_points = 0; ///< before thinning
};

/// The tiles of a plot, as tile_points lists them in tiles.json.
class Tile_manifest
{
public:
  /// Throws `pcs::IO_error` if the file is not a manifest of tile_points.
  explicit Tile_manifest(const std::string& path)
    : m_folder(std::filesystem::path(path).parent_path())
  {
    const Json json = read_json(path, "the manifest of tile_points");
    const Json_value top(json, path);
    for (const char* key : {"points", "up", "tiles"})
      if (!json.is_object() || !top.has(key))
        top.fail_expected("the manifest of tile_points with the key " + std::string(key));
    m_number_of_points = read_count(top["points"]);
    read_up(top["up"]);
    if (top.has("skipped"))
      read_skipped(top["skipped"]);
    m_end_of_indices = m_number_of_points;
    if (top.has("blocks"))
      read_blocks(top);
    const Json_value tiles = top["tiles"];
    if (!tiles.json().is_array() || tiles.size() == 0)
      tiles.fail_expected("an array of tiles");
    std::set<std::string> names;
    std::uint64_t count = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      m_tiles.push_back(read_tile(tiles[t]));
      if (!names.insert(m_tiles.back().file).second)
        tiles[t].fail("the file " + m_tiles.back().file + " is listed twice");
      count += m_tiles.back().number_of_core_points;
    }
    if (count != m_number_of_points)
      top.fail("the cores have " + std::to_string(count) + " points, but `points` is " +
               std::to_string(m_number_of_points));
    m_plot = m_tiles.front().core;
    for (const Listed_tile& tile : m_tiles)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        m_plot.low[axis] = std::min(m_plot.low[axis], tile.core.low[axis]);
        m_plot.high[axis] = std::max(m_plot.high[axis], tile.core.high[axis]);
      }
  }

  const std::vector<Listed_tile>& tiles() const { return m_tiles; }
  std::uint64_t number_of_points() const { return m_number_of_points; } ///< of all cores
  /// Returns the number of points before thinning: all indices are smaller.
  std::uint64_t end_of_indices() const { return m_end_of_indices; }
  /// Returns the files of all points, in no particular order; empty if the plot was not thinned.
  const std::vector<Listed_block>& blocks() const { return m_blocks; }
  std::string path_of_block(std::size_t block) const
  {
    return (m_folder / m_blocks[block].file).string();
  }
  /// Returns the damaged scans whose points are missing in the tiles.
  const std::vector<std::string>& skipped() const { return m_skipped; }
  const std::string& up() const { return m_up; }
  std::size_t axis_up() const { return static_cast<std::size_t>(m_up.back() - 'x'); }

  /// Returns the path of the file of a tile.
  std::string path_of(std::size_t tile) const { return (m_folder / m_tiles[tile].file).string(); }

  /// Returns the tile with the name of a file, or the number of tiles.
  std::size_t find(const std::string& name) const
  {
    return static_cast<std::size_t>(
        std::find_if(m_tiles.begin(),
                     m_tiles.end(),
                     [&](const Listed_tile& tile) { return tile.file == name; }) -
        m_tiles.begin());
  }

  /// Returns the tile whose core holds the position. A position outside the plot belongs to the
  /// core that is nearest, since the foot of a tree may lie slightly outside.
  std::size_t owner_of(const Position_2& position) const
  {
    Position_2 p{};
    for (std::size_t axis = 0; axis < 2; ++axis)
      p[axis] =
          std::clamp(position[axis],
                     m_plot.low[axis],
                     std::nextafter(m_plot.high[axis], -std::numeric_limits<double>::infinity()));
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < m_tiles.size(); ++t) {
      if (is_in_core(m_tiles[t], p))
        return t;
      const Box_2& core = m_tiles[t].core;
      const auto outside = [&](std::size_t axis) {
        return std::max({core.low[axis] - p[axis], p[axis] - core.high[axis], 0.0});
      };
      const double distance = std::hypot(outside(0), outside(1));
      if (distance < least) {
        least = distance;
        nearest = t;
      }
    }
    return nearest; // a manifest with a gap between its cores
  }

  /// Returns whether the position is within `width` of a side of the buffered rectangle of a tile
  /// beyond which the plot continues.
  bool is_at_rim(const Tile& tile, const Position_2& p, double width) const
  {
    for (std::size_t axis = 0; axis < 2; ++axis)
      if ((tile.buffered.low[axis] > m_plot.low[axis] &&
           p[axis] < tile.buffered.low[axis] + width) ||
          (tile.buffered.high[axis] < m_plot.high[axis] &&
           p[axis] > tile.buffered.high[axis] - width))
        return true;
    return false;
  }

private:
  void read_up(const Json_value& value)
  {
    m_up = value.json().is_string() ? value.json().get<std::string>() : std::string();
    for (const char* name : {"x", "y", "z", "-x", "-y", "-z"})
      if (m_up == name)
        return;
    value.fail_expected("x, y, z, -x, -y or -z");
  }

  void read_skipped(const Json_value& value)
  {
    if (!value.json().is_array())
      value.fail_expected("an array of damaged scans");
    for (std::size_t i = 0; i < value.size(); ++i) {
      const Json_value scan = value[i];
      scan.object({"file", "reason"});
      if (!scan.has("file") || !scan["file"].json().is_string())
        scan.fail_expected("an object with the name of a file");
      m_skipped.push_back(scan["file"].json().get<std::string>());
    }
  }

  void read_blocks(const Json_value& top)
  {
    if (!top.has("all_points"))
      top.fail_expected("a manifest with the keys blocks and all_points");
    m_end_of_indices = read_count(top["all_points"]);
    const Json_value blocks = top["blocks"];
    if (!blocks.json().is_array())
      blocks.fail_expected("an array of blocks");
    std::uint64_t count = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const Json_value value = blocks[b];
      value.object({"file", "core", "points"});
      for (const char* key : {"file", "core", "points"})
        if (!value.has(key))
          value.fail_expected("a block with " + std::string(key));
      m_blocks.push_back(
          {read_box(value["core"]), read_file_name(value["file"]), read_count(value["points"])});
      count += m_blocks.back().number_of_points;
    }
    if (count != m_end_of_indices)
      top.fail("the blocks have " + std::to_string(count) + " points, but `all_points` is " +
               std::to_string(m_end_of_indices));
  }

  static std::string read_file_name(const Json_value& value)
  {
    std::string file;
    if (value.json().is_string())
      file = value.json().get<std::string>();
    const std::filesystem::path name(file);
    if (name.extension() != ".ply" || name.filename() != name)
      value.fail_expected("the name of a PLY file in the folder of the manifest");
    return file;
  }

  static Listed_tile read_tile(const Json_value& value)
  {
    value.object({"file", "core", "buffered", "points", "core_points"});
    for (const char* key : {"file", "core", "buffered", "points", "core_points"})
      if (!value.has(key))
        value.fail_expected("a tile with " + std::string(key));
    Listed_tile tile;
    tile.file = read_file_name(value["file"]);
    tile.core = read_box(value["core"]);
    tile.buffered = read_box(value["buffered"]);
    tile.number_of_points = read_count(value["points"]);
    tile.number_of_core_points = read_count(value["core_points"]);
    return tile;
  }

  std::filesystem::path m_folder;
  std::uint64_t m_number_of_points = 0, m_end_of_indices = 0;
  std::vector<Listed_block> m_blocks;
  std::vector<std::string> m_skipped;
  std::string m_up;
  std::vector<Listed_tile> m_tiles;
  Box_2 m_plot;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_TILE_MANIFEST_H

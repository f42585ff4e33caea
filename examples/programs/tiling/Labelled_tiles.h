// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks the core points of the results of tiles, and reads them in chunks.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_LABELLED_TILES_H
#define PCS_EXAMPLES_PROGRAMS_TILING_LABELLED_TILES_H

#include "tiling/Plot_trees.h"
#include "tiling/Tile_manifest.h"
#include "tiling/Tile_result.h"
#include "tiling/horizontal.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace program {

/// Points and height of the part of a tree in one core.
struct Part_of_core
{
  std::uint64_t number_of_points = 0;
  double highest = -std::numeric_limits<double>::infinity(); ///< along the up direction [L]
};

/*!
  The results of all tiles of a plot. A tile whose result is missing or damaged has no trees; its
  core points are read from the tile itself, without trees. If the tile is damaged, too, its points
  are missing.
*/
class Labelled_tiles
{
public:
  using Table = pcs::IO::Point_table;

  /// Where the points of a core are read from.
  enum class Source { result, tile, none };

  /// Points that are checked at a time.
  static constexpr std::size_t chunk_size = std::size_t(1) << 18;

  /// Reads all results once. `fail(tile, reason)` is called for every missing or damaged one.
  template <class Fail>
  Labelled_tiles(const Tile_manifest& manifest, std::string folder, const Fail& fail)
    : m_manifest(manifest),
      m_folder(std::move(folder)),
      m_results(manifest.tiles().size()),
      m_parts(manifest.tiles().size()),
      m_source(manifest.tiles().size(), Source::none)
  {
    for (std::size_t t = 0; t < m_source.size(); ++t)
      try {
        check_result(t);
      } catch (const std::exception& error) {
        m_results[t].reset();
        m_parts[t].clear();
        fail(t, std::string(error.what()));
      }
    for (std::size_t t = 0; t < m_source.size(); ++t)
      if (m_source[t] == Source::none)
        try {
          check_tile(t);
        } catch (const std::exception& error) {
          fail(t, std::string(error.what()) + "; its points are missing in the results");
        }
  }

  const Plot_trees::Results& results() const { return m_results; }
  Source source(std::size_t tile) const { return m_source[tile]; }

  /// Returns the part of each tree of a tile in its core.
  const std::vector<Part_of_core>& parts(std::size_t tile) const { return m_parts[tile]; }

  /// Returns the properties of the points; `tree` is the last.
  const pcs::IO::Point_schema& schema() const { return m_schema; }

  /// Returns the path that the points of a core are read from.
  std::string path_of(std::size_t tile) const
  {
    return m_source[tile] == Source::result
               ? points_of_result(m_folder, m_manifest.tiles()[tile].file)
               : m_manifest.path_of(tile);
  }

  /// Replaces a chunk of `path_of(tile)` by its core points with the property `tree` in the tile.
  void make_core(std::size_t tile, Table& chunk) const
  {
    if (m_source[tile] == Source::tile)
      chunk = core_of(chunk);
  }

private:
  static Table core_of(const Table& chunk)
  {
    const auto& is_core = chunk.property<std::uint8_t>("is_core");
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < is_core.size(); ++i)
      if (is_core[i] != 0)
        rows.push_back(i);
    Table core = chunk.select(rows);
    for (const char* name : {"is_core", "tree"})
      if (core.has_property(name))
        core.remove_property(name);
    core.add_property("tree", std::vector<std::int32_t>(rows.size(), Plot_trees::no_tree));
    return core;
  }

  /// Checks the result of a tile. Throws `pcs::IO_error` or `pcs::Invalid_input`.
  void check_result(std::size_t t)
  {
    const Listed_tile& tile = m_manifest.tiles()[t];
    const std::string path = trees_of_result(m_folder, tile.file);
    m_results[t] = read_tile_result(path);
    const Tile_result& result = *m_results[t];
    if (result.core.low != tile.core.low || result.core.high != tile.core.high ||
        result.number_of_core_points != tile.number_of_core_points)
      throw pcs::IO_error(path, "belongs to other tiles than the manifest; segment the tile again");
    std::vector<Part_of_core> parts(result.trees.size());
    check_points(t, points_of_result(m_folder, tile.file), false, parts);
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (parts[k].number_of_points != result.trees[k].number_of_core_points)
        throw pcs::IO_error(path, "does not belong to its points; segment the tile again");
    m_parts[t] = std::move(parts);
    m_source[t] = Source::result;
  }

  void check_tile(std::size_t t)
  {
    std::vector<Part_of_core> none;
    check_points(t, m_manifest.path_of(t), true, none);
    m_source[t] = Source::tile;
  }

  /// Reads all points of a core. Throws if they do not match the manifest, the properties of the
  /// tiles before, or the trees.
  void check_points(std::size_t t,
                    const std::string& path,
                    bool is_tile,
                    std::vector<Part_of_core>& parts)
  {
    const Listed_tile& tile = m_manifest.tiles()[t];
    const std::size_t axis_up = m_manifest.axis_up();
    const double sign = m_manifest.up().front() == '-' ? -1 : 1;
    pcs::IO::Point_reader reader(path);
    Table chunk, core;
    std::uint64_t count = 0, end = 0; // of the indices that may follow
    while (reader.read(chunk, chunk_size)) {
      if (is_tile)
        core = core_of(chunk);
      const Table& points = is_tile ? core : chunk;
      const std::vector<std::uint64_t> index = indices_of(points);
      const auto& trees = points.property<std::int32_t>("tree");
      if (m_has_schema && points.schema().properties != m_schema.properties)
        throw pcs::IO_error(path, "has other properties than the tiles before it");
      for (std::size_t i = 0; i < index.size(); ++i) {
        const auto& p = points.points()[i];
        const bool is_tree = trees[i] >= 0 && static_cast<std::size_t>(trees[i]) < parts.size();
        if (index[i] < end || index[i] >= m_manifest.end_of_indices() ||
            !is_in_core(tile, horizontal(p, axis_up)) ||
            !(is_tree || trees[i] == Plot_trees::no_tree))
          throw pcs::IO_error(path,
                              "point " + std::to_string(count + i) +
                                  " has an index, a position or a tree that the tile cannot have");
        end = index[i] + 1;
        if (!is_tree)
          continue;
        Part_of_core& part = parts[static_cast<std::size_t>(trees[i])];
        ++part.number_of_points;
        part.highest = std::max(part.highest, sign * p[static_cast<int>(axis_up)]);
      }
      count += index.size();
    }
    if (count != tile.number_of_core_points)
      throw pcs::IO_error(path,
                          "has " + std::to_string(count) +
                              " points of the core, but the manifest "
                              "lists " +
                              std::to_string(tile.number_of_core_points));
    m_schema.properties = (is_tile ? core : chunk).schema().properties;
    m_has_schema = true;
  }

  const Tile_manifest& m_manifest;
  std::string m_folder;
  Plot_trees::Results m_results;
  std::vector<std::vector<Part_of_core>> m_parts;
  std::vector<Source> m_source;
  pcs::IO::Point_schema m_schema;
  bool m_has_schema = false;
};

/*!
  Returns the places of the trees of a tile in a group of trees of the plot. Empty if no tree of the
  group has points in the core of the tile.
  \param place of each tree of the plot; `end` for trees outside the group
*/
inline std::vector<std::size_t> places_in_group(const Labelled_tiles& tiles,
                                                const Plot_trees& trees,
                                                std::size_t tile,
                                                const std::vector<std::size_t>& place,
                                                std::size_t end)
{
  const std::vector<std::int32_t>& tree_of = trees.trees_of_tile(tile);
  std::vector<std::size_t> result(tree_of.size(), end);
  bool is_needed = false;
  for (std::size_t k = 0; k < tree_of.size(); ++k)
    if (tree_of[k] != Plot_trees::no_tree && tiles.parts(tile)[k].number_of_points > 0) {
      result[k] = place[static_cast<std::size_t>(tree_of[k])];
      is_needed = is_needed || result[k] < end;
    }
  if (!is_needed)
    result.clear();
  return result;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_LABELLED_TILES_H

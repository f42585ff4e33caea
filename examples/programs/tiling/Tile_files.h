// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes the points of tiles to one file per tile, and removes the files if it fails.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_TILE_FILES_H
#define PCS_EXAMPLES_PROGRAMS_TILING_TILE_FILES_H

#include "common/check_output.h"
#include "tiling/Point_files.h"
#include "tiling/Tile_tree.h"
#include "tiling/horizontal.h"
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace program {

/*!
  Tiles have the shared properties of the inputs, and two more, which replace properties of the same
  name: `index`, the number of the point in all inputs from 0, and `is_core`, 1 in the core of the
  tile and 0 in the buffer. Points that have an index already may keep it. Without `keep()`, the
  destructor removes the files.
*/
class Tile_files
{
public:
  /// `do_keep_index`: the points have indices below `total`, of the type of `type_of_index(total)`.
  Tile_files(std::string folder,
             const pcs::IO::Point_schema& shared,
             std::uint64_t total,
             bool do_keep_index = false)
    : m_folder(std::move(folder)),
      m_do_keep_index(do_keep_index),
      m_has_short_index(type_of_index(total) == pcs::IO::Scalar_type::uint32)
  {
    using pcs::IO::Scalar_type;
    for (const pcs::IO::Property_description& p : shared.properties)
      if (p.name != "index" && p.name != "is_core")
        m_schema.push_back(p);
    m_schema.push_back({"index", type_of_index(total)});
    m_schema.push_back({"is_core", Scalar_type::uint8});
  }
  Tile_files(const Tile_files&) = delete;
  Tile_files& operator=(const Tile_files&) = delete;
  ~Tile_files()
  {
    std::error_code error;
    for (const std::string& path : m_written)
      std::filesystem::remove(path, error);
  }

  /// Returns the type of the indices of `total` points.
  static pcs::IO::Scalar_type type_of_index(std::uint64_t total)
  {
    const std::uint64_t most = std::uint64_t(std::numeric_limits<std::uint32_t>::max()) + 1;
    return total <= most ? pcs::IO::Scalar_type::uint32 : pcs::IO::Scalar_type::uint64;
  }

  /// Returns the name of the file of a tile in the folder; numbers begin with 1.
  static std::string name_of_file(std::size_t tile, const std::string& prefix = "tile_")
  {
    constexpr std::size_t width = 4;
    const std::string number = std::to_string(tile + 1);
    return prefix + std::string(width - std::min(width, number.size()), '0') + number + ".ply";
  }
  std::string path_of(std::size_t tile) const
  {
    return (std::filesystem::path(m_folder) / name_of_file(tile)).string();
  }

  /// Checks that tiles can be written.
  void check_writable() const { check_output(path_of(0), schema()); }

  /// Throws `pcs::IO_error` if the free space of the folder is too small for that many points.
  void check_space(double number_of_points) const
  {
    double row_size = 0;
    for (const pcs::IO::Property_description& p : m_schema)
      row_size += static_cast<double>(size_of(p.type));
    const double needed = number_of_points * row_size;
    std::error_code error;
    const auto free = static_cast<double>(std::filesystem::space(m_folder, error).available);
    if (error || needed <= free)
      return;
    const auto in_megabytes = [](double bytes) {
      return std::to_string(static_cast<std::uint64_t>(bytes / 1e6)) + " MB";
    };
    throw pcs::IO_error(m_folder,
                        "the tiles need some " + in_megabytes(needed) + ", and " +
                            in_megabytes(free) +
                            " are free; raise --tile-points, or reduce --buffer");
  }

  /// Writes all tiles. Reads the inputs once for every `max_open` tiles. Returns the number of
  /// points of each tile.
  std::vector<std::uint64_t>
  write(const Point_files& files, const Tile_tree& tree, std::size_t axis_up, std::size_t max_open)
  {
    std::vector<std::uint64_t> counts;
    const std::size_t n = tree.tiles().size();
    for (std::size_t first = 0; first < n; first += max_open)
      write_group(files, tree, axis_up, first, std::min(n, first + max_open), counts);
    return counts;
  }

  /// Keeps the files that were written.
  void keep() { m_written.clear(); }

private:
  using Table = pcs::IO::Point_table;

  pcs::IO::Point_schema schema() const
  {
    pcs::IO::Point_schema result;
    result.properties = m_schema;
    return result;
  }

  /// Writes the tiles `[first, end)` in one pass.
  void write_group(const Point_files& files,
                   const Tile_tree& tree,
                   std::size_t axis_up,
                   std::size_t first,
                   std::size_t end,
                   std::vector<std::uint64_t>& counts)
  {
    std::vector<std::unique_ptr<pcs::IO::Point_writer>> writers;
    for (std::size_t t = first; t < end; ++t)
      writers.push_back(std::make_unique<pcs::IO::Point_writer>(path_of(t), schema()));
    std::vector<std::uint64_t> number_of_core_points(end - first, 0);
    std::vector<std::vector<std::size_t>> chosen(end - first); // points of the chunk in each tile
    files.read_again("writing", [&](const Table& chunk, std::uint64_t index) {
      for (std::size_t i = 0; i < chunk.number_of_points(); ++i)
        tree.for_each_tile(horizontal(chunk.points()[i], axis_up), first, end, [&](std::size_t t) {
          chosen[t - first].push_back(i);
        });
      for (std::size_t t = first; t < end; ++t) {
        std::vector<std::size_t>& points = chosen[t - first];
        if (!points.empty())
          number_of_core_points[t - first] +=
              append(chunk, points, index, tree.tiles()[t], axis_up, *writers[t - first]);
        points.clear();
      }
    });
    for (std::size_t t = first; t < end; ++t) {
      if (number_of_core_points[t - first] != tree.tiles()[t].number_of_core_points)
        throw pcs::IO_error(path_of(t), "an input was changed by someone else while it was read");
      counts.push_back(writers[t - first]->number_of_points());
      writers[t - first]->commit();
      m_written.push_back(path_of(t));
    }
  }

  /// Appends points of a chunk to a tile. Returns how many of them are in the core.
  std::uint64_t append(const Table& chunk,
                       const std::vector<std::size_t>& points,
                       std::uint64_t index_of_chunk,
                       const Tile& tile,
                       std::size_t axis_up,
                       pcs::IO::Point_writer& writer) const
  {
    Table part = chunk.select(points);
    for (const std::string& name : part.property_names())
      if ((name == "index" && !m_do_keep_index) || name == "is_core" || !has(name))
        part.remove_property(name);
    std::vector<std::uint8_t> is_core;
    is_core.reserve(points.size());
    for (const Table::Point_3& p : part.points())
      is_core.push_back(is_in_core(tile, horizontal(p, axis_up)) ? 1 : 0);
    const auto count = std::count(is_core.begin(), is_core.end(), std::uint8_t(1));
    if (m_do_keep_index)
      ; // it is a property of the chunk
    else if (m_has_short_index)
      part.add_property("index", indices<std::uint32_t>(points, index_of_chunk));
    else
      part.add_property("index", indices<std::uint64_t>(points, index_of_chunk));
    part.add_property("is_core", std::move(is_core));
    writer.append(part);
    return static_cast<std::uint64_t>(count);
  }

  bool has(const std::string& name) const
  {
    return std::any_of(m_schema.begin(),
                       m_schema.end(),
                       [&](const pcs::IO::Property_description& p) { return p.name == name; });
  }

  template <class Index>
  static std::vector<Index> indices(const std::vector<std::size_t>& points, std::uint64_t first)
  {
    std::vector<Index> result;
    result.reserve(points.size());
    for (const std::size_t i : points)
      result.push_back(static_cast<Index>(first + i));
    return result;
  }

  std::string m_folder;
  bool m_do_keep_index, m_has_short_index;
  std::vector<pcs::IO::Property_description> m_schema;
  std::vector<std::string> m_written; ///< files that are removed unless they are kept
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_TILE_FILES_H

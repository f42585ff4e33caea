// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes one file of points per tree of a plot, with a bounded number of open files.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_TREE_FILES_H
#define PCS_EXAMPLES_PROGRAMS_TILING_TREE_FILES_H

#include "scan/tree_foot.h"
#include "tiling/Labelled_tiles.h"
#include "tiling/Plot_trees.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace program {

/*!
  The files of trees. Trees are written in groups in the order of their tiles, and only the tiles
  with points of a group are read for it. Points of a tree are in the order of the tiles, and within
  a tile in the order of their indices.
*/
class Tree_files
{
public:
  using Table = pcs::IO::Point_table;

  Tree_files(const Labelled_tiles& tiles, const Plot_trees& trees, std::string folder)
    : m_tiles(tiles), m_trees(trees), m_folder(std::move(folder)), m_schema(tiles.schema())
  {
    m_schema.properties.pop_back(); // `tree`
  }

  /// Returns the name of the file of a tree in the folder.
  static std::string name_of(std::size_t tree)
  {
    constexpr std::size_t width = 6;
    const std::string number = std::to_string(tree);
    return "tree_" + std::string(width - std::min(width, number.size()), '0') + number + ".ply";
  }

  /// Returns whether a file has the name of the file of a tree.
  static bool is_name(const std::string& name)
  {
    const std::size_t first = 5, end = name.size() - std::min<std::size_t>(4, name.size());
    return name.rfind("tree_", 0) == 0 && name.size() >= 15 && name.substr(end) == ".ply" &&
           std::all_of(name.begin() + first,
                       name.begin() + static_cast<std::ptrdiff_t>(end),
                       [](char c) { return c >= '0' && c <= '9'; });
  }

  /// Writes the files of the trees of `wanted`.
  void write(std::vector<std::size_t> wanted, std::size_t max_open) const
  {
    std::stable_sort(wanted.begin(), wanted.end(), [this](std::size_t a, std::size_t b) {
      return m_trees.trees()[a].tile < m_trees.trees()[b].tile;
    });
    for (std::size_t first = 0; first < wanted.size(); first += max_open)
      write_group(wanted, first, std::min(wanted.size(), first + max_open));
  }

private:
  void write_group(const std::vector<std::size_t>& wanted, std::size_t first, std::size_t end) const
  {
    std::vector<std::unique_ptr<pcs::IO::Point_writer>> writers;
    std::vector<std::size_t> place(m_trees.trees().size(), end); // of each tree in `wanted`
    for (std::size_t w = first; w < end; ++w) {
      place[wanted[w]] = w;
      writers.push_back(std::make_unique<pcs::IO::Point_writer>(
          (std::filesystem::path(m_folder) / name_of(wanted[w])).string(),
          schema_of(wanted[w])));
    }
    for (std::size_t t = 0; t < m_tiles.results().size(); ++t) {
      const std::vector<std::size_t> place_of = places_in_group(m_tiles, m_trees, t, place, end);
      if (!place_of.empty())
        append(t, place_of, first, end, writers);
    }
    for (const auto& writer : writers)
      writer->commit();
  }

  /// Appends the points of a tile. `place_of`: place of its trees, `end` for other trees.
  void append(std::size_t tile,
              const std::vector<std::size_t>& place_of,
              std::size_t first,
              std::size_t end,
              const std::vector<std::unique_ptr<pcs::IO::Point_writer>>& writers) const
  {
    pcs::IO::Point_reader reader(m_tiles.path_of(tile));
    Table chunk;
    std::vector<std::vector<std::size_t>> rows(end - first);
    while (reader.read(chunk, Labelled_tiles::chunk_size)) {
      const auto& trees = chunk.property<std::int32_t>("tree");
      for (std::size_t i = 0; i < trees.size(); ++i)
        if (trees[i] >= 0 && place_of[static_cast<std::size_t>(trees[i])] < end)
          rows[place_of[static_cast<std::size_t>(trees[i])] - first].push_back(i);
      for (std::size_t w = 0; w < rows.size(); ++w) {
        if (rows[w].empty())
          continue;
        Table part = chunk.select(rows[w]);
        part.remove_property("tree");
        writers[w]->append(part);
        rows[w].clear();
      }
    }
  }

  pcs::IO::Point_schema schema_of(std::size_t tree) const
  {
    Table empty(m_schema);
    write_foot(m_trees.trees()[tree].foot, empty);
    return empty.schema();
  }

  const Labelled_tiles& m_tiles;
  const Plot_trees& m_trees;
  std::string m_folder;
  pcs::IO::Point_schema m_schema;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_TREE_FILES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The tree of all points of a plot whose tiles have one point per voxel.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_LABELLED_BLOCKS_H
#define PCS_EXAMPLES_PROGRAMS_TILING_LABELLED_BLOCKS_H

#include "tiling/Labelled_tiles.h"
#include "tiling/Ordered_points.h"
#include "tiling/Plot_trees.h"
#include "tiling/Tile_manifest.h"
#include "tiling/Tile_result.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace program {

/*!
  Every point gets the tree of the kept point of its voxel. The trees of a block are written to a
  temporary file beside the result, in the order of its points. Memory: 12 bytes per kept point of
  the tiles that overlap a block.
*/
class Labelled_blocks
{
public:
  using Table = pcs::IO::Point_table;

  /// Reads all blocks once. `fail(block, reason)` is called for every missing or damaged one, whose
  /// points are left out. `result`: the file that will have all points.
  template <class Fail>
  Labelled_blocks(const Tile_manifest& manifest,
                  const Labelled_tiles& tiles,
                  const Plot_trees& trees,
                  const std::string& result,
                  const Fail& fail)
    : m_manifest(manifest), m_tiles(tiles), m_trees(trees)
  {
    for (std::size_t b = 0; b < manifest.blocks().size(); ++b) {
      const std::string labels =
          (std::filesystem::path(result).parent_path() /
           (".unfinished_labels_" + std::to_string(getpid()) + "_" + std::to_string(b)))
              .string();
      m_files.push_back(labels);
      try {
        label(b, labels);
        add_source(b, labels);
      } catch (const std::exception& error) {
        fail(b, std::string(error.what()));
      }
    }
    m_labels.clear();
  }
  Labelled_blocks(const Labelled_blocks&) = delete;
  Labelled_blocks& operator=(const Labelled_blocks&) = delete;
  ~Labelled_blocks()
  {
    std::error_code error;
    for (const std::string& file : m_files)
      std::filesystem::remove(file, error);
  }

  const std::vector<Ordered_points::Source>& sources() const { return m_sources; }
  const pcs::IO::Point_schema& schema() const { return m_schema; }
  std::uint64_t number_of_points() const { return m_number_of_points; }
  std::uint64_t number_of_unassigned_points() const { return m_number_of_unassigned_points; }

private:
  /// The kept points of a tile in the order of their indices.
  struct Labels
  {
    std::vector<std::uint64_t> index;
    std::vector<std::int32_t> tree;

    /// Returns the place of an index, or the number of points.
    std::size_t find(std::uint64_t i) const
    {
      const auto at = std::lower_bound(index.begin(), index.end(), i);
      return static_cast<std::size_t>((at != index.end() && *at == i ? at : index.end()) -
                                      index.begin());
    }
  };

  static bool do_overlap(const Box_2& a, const Box_2& b)
  {
    return a.low[0] < b.high[0] && b.low[0] < a.high[0] && a.low[1] < b.high[1] &&
           b.low[1] < a.high[1];
  }

  Labels read_labels(std::size_t tile) const
  {
    Labels labels;
    pcs::IO::Point_reader reader(m_tiles.path_of(tile));
    Table chunk;
    while (reader.read(chunk, Labelled_tiles::chunk_size)) {
      m_tiles.make_core(tile, chunk);
      const std::vector<std::uint64_t> index = indices_of(chunk);
      labels.index.insert(labels.index.end(), index.begin(), index.end());
      for (const std::int32_t k : chunk.property<std::int32_t>("tree"))
        labels.tree.push_back(k < 0 ? k : m_trees.trees_of_tile(tile)[static_cast<std::size_t>(k)]);
    }
    return labels;
  }

  /// Holds the labels of the tiles that overlap a block. Returns whether all of them can be read.
  bool hold_labels(const Listed_block& block)
  {
    bool is_complete = true;
    for (std::size_t t = 0; t < m_manifest.tiles().size(); ++t) {
      if (!do_overlap(m_manifest.tiles()[t].core, block.core))
        m_labels.erase(t);
      else if (m_tiles.source(t) == Labelled_tiles::Source::none)
        is_complete = false;
      else if (m_labels.count(t) == 0)
        m_labels.emplace(t, read_labels(t));
    }
    return is_complete;
  }

  /// Returns the tree of a kept point. Throws `pcs::IO_error` if there is no such point.
  std::int32_t tree_of(std::uint64_t kept, bool is_complete, const std::string& path) const
  {
    for (const auto& [tile, labels] : m_labels) {
      const std::size_t place = labels.find(kept);
      if (place < labels.index.size())
        return labels.tree[place];
    }
    if (is_complete)
      throw pcs::IO_error(path,
                          "the kept point " + std::to_string(kept) +
                              " is in no tile, so it belongs to another run of tile_points");
    return Plot_trees::no_tree; // a point of a tile that cannot be read
  }

  void label(std::size_t b, const std::string& labels)
  {
    const Listed_block& block = m_manifest.blocks()[b];
    const std::string path = m_manifest.path_of_block(b);
    const bool is_complete = hold_labels(block);
    pcs::IO::Point_reader reader(path);
    std::ofstream out(labels, std::ios::binary);
    Table chunk;
    std::uint64_t count = 0, unassigned = 0, end = 0; // of the indices that may follow
    while (reader.read(chunk, Labelled_tiles::chunk_size)) {
      const std::vector<std::uint64_t> index = indices_of(chunk);
      const std::vector<std::uint64_t> kept = indices_of(chunk, "kept_index");
      std::vector<std::int32_t> trees;
      for (std::size_t i = 0; i < index.size(); ++i) {
        if (index[i] < end || index[i] >= m_manifest.end_of_indices())
          throw pcs::IO_error(path,
                              "point " + std::to_string(count + i) +
                                  " has an index that the block cannot have");
        end = index[i] + 1;
        trees.push_back(tree_of(kept[i], is_complete, path));
        unassigned += trees.back() == Plot_trees::no_tree;
      }
      out.write(reinterpret_cast<const char*>(trees.data()),
                static_cast<std::streamsize>(trees.size() * sizeof(std::int32_t)));
      count += index.size();
    }
    out.close();
    if (!out)
      throw pcs::IO_error(labels, "cannot be written");
    if (count != block.number_of_points)
      throw pcs::IO_error(path,
                          "has " + std::to_string(count) + " points, but the manifest lists " +
                              std::to_string(block.number_of_points));
    pcs::IO::Point_schema schema = labelled(chunk).schema();
    if (!m_sources.empty() && schema.properties != m_schema.properties)
      throw pcs::IO_error(path, "has other properties than the blocks before it");
    m_schema.properties = schema.properties;
    m_number_of_points += count;
    m_number_of_unassigned_points += unassigned;
  }

  /// Returns the points with the property `tree`, whose values are arbitrary.
  static Table& labelled(Table& chunk)
  {
    for (const char* name : {"kept_index", "tree"})
      if (chunk.has_property(name))
        chunk.remove_property(name);
    chunk.add_property("tree", std::vector<std::int32_t>(chunk.number_of_points()));
    return chunk;
  }

  /// The file of the trees is open while its block is read.
  void add_source(std::size_t b, const std::string& labels)
  {
    const auto in = std::make_shared<std::ifstream>();
    const auto left = std::make_shared<std::uint64_t>(m_manifest.blocks()[b].number_of_points);
    m_sources.push_back({m_manifest.path_of_block(b), [in, left, labels](Table& chunk) {
                           if (!in->is_open())
                             in->open(labels, std::ios::binary);
                           auto& trees = labelled(chunk).property<std::int32_t>("tree");
                           in->read(
                               reinterpret_cast<char*>(trees.data()),
                               static_cast<std::streamsize>(trees.size() * sizeof(std::int32_t)));
                           if (!*in)
                             throw pcs::IO_error(labels, "cannot be read");
                           *left -= trees.size();
                           if (*left == 0)
                             in->close();
                         }});
  }

  const Tile_manifest& m_manifest;
  const Labelled_tiles& m_tiles;
  const Plot_trees& m_trees;
  std::map<std::size_t, Labels> m_labels; ///< by tile
  std::vector<std::string> m_files;       ///< temporary
  std::vector<Ordered_points::Source> m_sources;
  pcs::IO::Point_schema m_schema;
  std::uint64_t m_number_of_points = 0, m_number_of_unassigned_points = 0;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_LABELLED_BLOCKS_H

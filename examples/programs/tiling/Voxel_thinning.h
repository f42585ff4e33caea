// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Keeps one point per voxel of a plot of any size, and the kept point of every point.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_VOXEL_THINNING_H
#define PCS_EXAMPLES_PROGRAMS_TILING_VOXEL_THINNING_H

#include "tiling/Count_grid.h"
#include "tiling/Ordered_points.h"
#include "tiling/Point_files.h"
#include "tiling/Tile_files.h"
#include "tiling/Tile_result.h"
#include "tiling/Tile_tree.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <tuple>
#include <unistd.h>
#include <unordered_map>
#include <utility>
#include <vector>

namespace program {

/*!
  Voxels are cubes of a grid that is aligned with the origin of the coordinates. The kept point of a
  voxel is the one nearest to its center; of equal distance, the one with the smallest coordinates;
  of equal coordinates, the one with the smallest index. So it does not depend on the tiles, and its
  position does not depend on the order of the files.

  The plot is cut into blocks that consist of whole voxels. A block is a file of all points in a
  half-open rectangle, in the order of their indices, with the properties `index` and `kept_index`,
  the index of the kept point of its voxel. Memory: some 120 bytes per kept point of a block.
  Without `keep()`, the destructor removes all files.
*/
class Voxel_thinning
{
public:
  using Table = pcs::IO::Point_table;

  /// `shared`: properties of the points. `total`: the number of points.
  Voxel_thinning(const std::string& folder,
                 double voxel,
                 const pcs::IO::Point_schema& shared,
                 std::uint64_t total)
    : m_folder(folder),
      m_work(m_folder / (".unfinished_blocks_" + std::to_string(getpid()))),
      m_voxel(voxel),
      m_type(Tile_files::type_of_index(total))
  {
    m_kept_schema.properties.clear();
    for (const pcs::IO::Property_description& p : shared.properties)
      if (!is_own(p.name))
        m_kept_schema.properties.push_back(p);
    m_kept_schema.properties.push_back({"index", m_type});
    m_schema = m_kept_schema;
    m_schema.properties.push_back({"kept_index", m_type});
  }
  Voxel_thinning(const Voxel_thinning&) = delete;
  Voxel_thinning& operator=(const Voxel_thinning&) = delete;
  ~Voxel_thinning()
  {
    std::error_code error;
    std::filesystem::remove_all(m_work, error);
    for (const std::string& path : m_written)
      std::filesystem::remove(path, error);
  }

  /// Properties of the inputs that are replaced.
  static bool is_own(const std::string& name)
  {
    return name == "index" || name == "is_core" || name == "kept_index";
  }

  static std::string name_of_file(std::size_t block)
  {
    return Tile_files::name_of_file(block, "block_");
  }

  /// Writes the blocks. Returns the path of a file with the kept points in the order of their
  /// indices, which exists as long as this object. `blocks` has no buffer, and its cells consist of
  /// whole voxels.
  std::string
  thin(const Point_files& files, const Tile_tree& blocks, std::size_t axis_up, std::size_t max_open)
  {
    std::filesystem::create_directories(m_work);
    std::vector<Ordered_points::Source> kept;
    {
      Tile_files parts(m_work.string(), files.shared(), files.number_of_points());
      parts.check_space(2 * blocks.estimated_points()); // blocks and kept points
      parts.write(files, blocks, axis_up, max_open);
      for (std::size_t b = 0; b < blocks.tiles().size(); ++b) {
        kept.push_back({(m_work / name_of_file(b)).string(), [](Table&) {}});
        thin_block(parts.path_of(b), b, blocks.tiles()[b].number_of_core_points, kept.back().path);
        std::filesystem::remove(parts.path_of(b));
      }
    }
    const std::string path = (m_work / "kept.ply").string();
    const std::vector<Ordered_points::Source> sources = kept;
    Ordered_points::write(kept, m_kept_schema, std::max<std::size_t>(2, max_open), path);
    for (const Ordered_points::Source& source : sources)
      std::filesystem::remove(source.path);
    return path;
  }

  /// Keeps the blocks.
  void keep() { m_written.clear(); }

private:
  using Voxel = std::array<std::int64_t, 3>;

  struct Hash
  {
    std::size_t operator()(const Voxel& voxel) const
    {
      std::uint64_t h = 0;
      for (const std::int64_t i : voxel) {
        h = (h ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15; // 2^64 / golden ratio
        h ^= h >> 32;
      }
      return static_cast<std::size_t>(h);
    }
  };

  /// In ascending order of preference.
  struct Candidate
  {
    double squared_distance = 0; ///< from the center of the voxel [L^2]
    std::array<double, 3> position{};
    std::uint64_t index = 0;

    friend bool operator<(const Candidate& a, const Candidate& b)
    {
      return std::tie(a.squared_distance, a.position, a.index) <
             std::tie(b.squared_distance, b.position, b.index);
    }
  };
  using Voxels = std::unordered_map<Voxel, Candidate, Hash>;

  Voxel voxel_of(const Table::Point_3& p) const
  {
    return {grid_index(p.x(), m_voxel), grid_index(p.y(), m_voxel), grid_index(p.z(), m_voxel)};
  }

  Candidate candidate(const Voxel& voxel, const Table::Point_3& p, std::uint64_t index) const
  {
    Candidate result{0, {p.x(), p.y(), p.z()}, index};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double center = (static_cast<double>(voxel[axis]) + 0.5) * m_voxel;
      const double d = result.position[axis] - center;
      result.squared_distance += d * d;
    }
    return result;
  }

  /// Calls `use(chunk)` for the points of the core of a part.
  template <class Use>
  static void read_core(const std::string& path, const Use& use)
  {
    pcs::IO::Point_reader reader(path);
    Table chunk;
    while (reader.read(chunk, Point_files::chunk_size)) {
      const auto& is_core = chunk.property<std::uint8_t>("is_core");
      std::vector<std::size_t> rows;
      for (std::size_t i = 0; i < is_core.size(); ++i)
        if (is_core[i] != 0)
          rows.push_back(i);
      Table core = chunk.select(rows);
      core.remove_property("is_core");
      if (core.has_property("kept_index"))
        core.remove_property("kept_index");
      use(core);
    }
  }

  Voxels find_kept(const std::string& path) const
  {
    Voxels voxels;
    read_core(path, [&](const Table& core) {
      const std::vector<std::uint64_t> index = indices_of(core);
      for (std::size_t i = 0; i < index.size(); ++i) {
        const auto& p = core.points()[i];
        for (const double x : {p.x(), p.y(), p.z()})
          if (!(std::abs(x) <= 1e15 * m_voxel)) // was checked when the points were counted
            throw pcs::IO_error(path, "was changed by someone else while it was read");
        const Voxel voxel = voxel_of(p);
        const Candidate other = candidate(voxel, core.points()[i], index[i]);
        const auto [at, is_new] = voxels.emplace(voxel, other);
        if (!is_new && other < at->second)
          at->second = other;
      }
    });
    return voxels;
  }

  /// Writes a block and its kept points.
  void thin_block(const std::string& part,
                  std::size_t block,
                  std::uint64_t number_of_points,
                  const std::string& kept_path)
  {
    const Voxels voxels = find_kept(part);
    const std::string path = (m_folder / name_of_file(block)).string();
    pcs::IO::Point_writer all(path, m_schema), kept(kept_path, m_kept_schema);
    read_core(part, [&](Table& core) {
      const std::vector<std::uint64_t> index = indices_of(core);
      std::vector<std::uint64_t> kept_index;
      std::vector<std::size_t> rows;
      for (std::size_t i = 0; i < index.size(); ++i) {
        kept_index.push_back(voxels.at(voxel_of(core.points()[i])).index);
        if (kept_index.back() == index[i])
          rows.push_back(i);
      }
      kept.append(core.select(rows));
      if (m_type == pcs::IO::Scalar_type::uint32)
        core.add_property("kept_index",
                          std::vector<std::uint32_t>(kept_index.begin(), kept_index.end()));
      else
        core.add_property("kept_index", std::move(kept_index));
      all.append(core);
    });
    if (all.number_of_points() != number_of_points)
      throw pcs::IO_error(part, "was changed by someone else while it was read");
    all.commit();
    m_written.push_back(path);
    kept.commit();
  }

  std::filesystem::path m_folder, m_work;
  double m_voxel;
  pcs::IO::Scalar_type m_type;
  pcs::IO::Point_schema m_schema, m_kept_schema;
  std::vector<std::string> m_written; ///< blocks that are removed unless they are kept
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_VOXEL_THINNING_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Merges the points of tiles in the order of their indices, with bounded memory and files.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_ORDERED_POINTS_H
#define PCS_EXAMPLES_PROGRAMS_TILING_ORDERED_POINTS_H

#include "tiling/Tile_result.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace program {

/*!
  Each source is a file whose points have ascending indices. The points of one range of indices are
  taken from all sources and sorted at a time. More sources than `max_open` are merged in groups
  to temporary files first, beside the result.
*/
class Ordered_points
{
public:
  using Table = pcs::IO::Point_table;

  /// A file, and how a chunk of it becomes points of the result.
  struct Source
  {
    std::string path;
    std::function<void(Table&)> convert;
  };

  /// Indices that are sorted at a time.
  static constexpr std::uint64_t window = std::uint64_t(1) << 18;

  /// Writes the points of all sources, which have the properties of `schema` after their
  /// conversion. Throws `pcs::IO_error` if an index occurs twice. Returns their number.
  static std::uint64_t write(std::vector<Source> sources,
                             const pcs::IO::Point_schema& schema,
                             std::size_t max_open,
                             const std::string& path)
  {
    Temporary_files files(path);
    while (sources.size() > max_open) {
      std::vector<Source> merged;
      for (std::size_t first = 0; first < sources.size(); first += max_open) {
        const std::size_t end = std::min(sources.size(), first + max_open);
        merged.push_back({files.next(), [](Table&) {}});
        merge(sources, first, end, schema, merged.back().path);
        for (std::size_t s = first; s < end; ++s)
          files.remove(sources[s].path);
      }
      sources = std::move(merged);
    }
    return merge(sources, 0, sources.size(), schema, path);
  }

private:
  /// Temporary files of a result; the destructor removes them.
  class Temporary_files
  {
  public:
    explicit Temporary_files(const std::string& result)
      : m_folder(std::filesystem::path(result).parent_path())
    {
    }
    Temporary_files(const Temporary_files&) = delete;
    Temporary_files& operator=(const Temporary_files&) = delete;
    ~Temporary_files()
    {
      while (!m_paths.empty())
        remove(std::string(m_paths.back()));
    }

    std::string next()
    {
      m_paths.push_back((m_folder / (".unfinished_points_" + std::to_string(getpid()) + "_" +
                                     std::to_string(++m_number) + ".ply"))
                            .string());
      return m_paths.back();
    }

    /// Removes a file if it is one of the temporary ones.
    void remove(const std::string& path)
    {
      const auto at = std::find(m_paths.begin(), m_paths.end(), path);
      if (at == m_paths.end())
        return;
      std::error_code error;
      std::filesystem::remove(path, error);
      m_paths.erase(at);
    }

  private:
    std::filesystem::path m_folder;
    std::vector<std::string> m_paths;
    std::size_t m_number = 0;
  };

  /// Reads one source.
  class Stream
  {
  public:
    Stream(const Source& source, std::size_t rows)
      : m_source(source), m_reader(source.path), m_rows(rows)
    {
      fill();
    }

    /// Returns the index of the next point; the largest number at the end.
    std::uint64_t front() const
    {
      return m_next < m_index.size() ? m_index[m_next] : std::numeric_limits<std::uint64_t>::max();
    }

    /// Appends the points with indices below `end`.
    void take(std::uint64_t end, Table& points, std::vector<std::uint64_t>& index)
    {
      while (front() < end) {
        std::vector<std::size_t> rows;
        for (; m_next < m_index.size() && m_index[m_next] < end; ++m_next) {
          rows.push_back(m_next);
          index.push_back(m_index[m_next]);
        }
        points.append(m_chunk.select(rows));
        if (m_next == m_index.size())
          fill();
      }
    }

  private:
    void fill()
    {
      m_next = 0;
      m_index.clear();
      while (m_index.empty() && m_reader.read(m_chunk, m_rows)) {
        m_source.convert(m_chunk);
        m_index = indices_of(m_chunk);
      }
    }

    const Source& m_source;
    pcs::IO::Point_reader m_reader;
    std::size_t m_rows, m_next = 0;
    Table m_chunk;
    std::vector<std::uint64_t> m_index;
  };

  static std::uint64_t merge(const std::vector<Source>& sources,
                             std::size_t first,
                             std::size_t end,
                             const pcs::IO::Point_schema& schema,
                             const std::string& path)
  {
    const std::size_t rows = std::max<std::size_t>(1024, window / (end - first + 1));
    std::vector<std::unique_ptr<Stream>> streams;
    for (std::size_t s = first; s < end; ++s)
      streams.push_back(std::make_unique<Stream>(sources[s], rows));
    pcs::IO::Point_writer writer(path, schema);
    Table points(schema);
    while (true) {
      std::uint64_t front = std::numeric_limits<std::uint64_t>::max();
      for (const auto& stream : streams)
        front = std::min(front, stream->front());
      if (front == std::numeric_limits<std::uint64_t>::max())
        break;
      points.clear();
      std::vector<std::uint64_t> index;
      for (const auto& stream : streams)
        stream->take(front + window, points, index);
      writer.append(points.select(order_of(index, path)));
    }
    writer.commit();
    return writer.number_of_points();
  }

  static std::vector<std::size_t> order_of(const std::vector<std::uint64_t>& index,
                                           const std::string& path)
  {
    std::vector<std::size_t> order(index.size());
    for (std::size_t i = 0; i < order.size(); ++i)
      order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return index[a] < index[b];
    });
    for (std::size_t i = 1; i < order.size(); ++i)
      if (index[order[i]] == index[order[i - 1]])
        throw pcs::IO_error(path,
                            "cannot be written: the point with index " +
                                std::to_string(index[order[i]]) +
                                " is in two tiles, so the results are of different tilings; "
                                "segment all tiles again");
    return order;
  }
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_ORDERED_POINTS_H

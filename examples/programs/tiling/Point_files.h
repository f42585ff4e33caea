// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads several point files one behind the other, in chunks and repeatedly.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_POINT_FILES_H
#define PCS_EXAMPLES_PROGRAMS_TILING_POINT_FILES_H

#include "common/Progress_line.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Scalar_type.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace program {

class Point_files
{
public:
  /// Points that are in memory at a time.
  static constexpr std::size_t chunk_size = std::size_t(1) << 18;

  /// Opens all files once. Throws `pcs::IO_error`; with `do_skip_damaged`, only if no file can be
  /// read.
  Point_files(const std::vector<std::string>& paths, bool is_quiet, bool do_skip_damaged = false)
    : m_is_quiet(is_quiet), m_do_skip_damaged(do_skip_damaged)
  {
    for (const std::string& path : paths)
      try {
        open(path);
      } catch (const pcs::IO_error& error) {
        skip(path, error);
      }
    find_shared();
  }

  /// A file that is left out because it cannot be read.
  struct Skipped
  {
    std::string path, reason;
  };

  /// Returns the files that are left out, in the order in which they were found.
  const std::vector<Skipped>& skipped() const { return m_skipped; }

  struct File
  {
    std::string path;
    pcs::IO::Point_schema schema;
    std::uint64_t number_of_points; ///< known after `count()`
  };

  const std::vector<File>& files() const { return m_files; }
  std::uint64_t number_of_points() const { return m_total; }

  /// Returns the coordinates as `float64`, and the properties that all files have with the same
  /// name and type, in the order of the first file.
  const pcs::IO::Point_schema& shared() const { return m_shared; }

  /// Returns sentences on data that are left out.
  const std::vector<std::string>& warnings() const { return m_warnings; }

  /// Calls `use(chunk, index of its first point, file)` for all points, the first time. Returns
  /// whether no file was left out; else the points of damaged files were used, too, and the caller
  /// counts again without them.
  template <class Use>
  bool count(const Use& use)
  {
    Progress_line line(!m_is_quiet);
    m_total = 0;
    std::vector<File> whole;
    for (File& file : m_files)
      try {
        count(file, use, line);
        whole.push_back(file);
      } catch (const pcs::IO_error& error) {
        skip(file.path, error);
      }
    const bool is_complete = whole.size() == m_files.size();
    m_files = std::move(whole);
    if (!is_complete)
      find_shared();
    return is_complete;
  }

  /// Calls `use(chunk, index of its first point)` for all points again. Throws `pcs::IO_error` if
  /// the number of points or the properties of a file have changed.
  template <class Use>
  void read_again(const std::string& stage, const Use& use) const
  {
    Progress_line line(!m_is_quiet);
    std::uint64_t first = 0;
    for (const File& file : m_files) {
      const std::uint64_t end = first + file.number_of_points;
      read(file, first, [&](const pcs::IO::Point_table& chunk, std::uint64_t next) {
        first = next + chunk.number_of_points();
        if (first > end || chunk.schema().properties != file.schema.properties)
          fail_changed(file);
        use(chunk, next);
        line.show(stage, fraction(first, m_total));
      });
      if (first != end)
        fail_changed(file);
    }
  }

  [[noreturn]] static void fail_changed(const File& file)
  {
    throw pcs::IO_error(file.path, "was changed by someone else while it was read");
  }

private:
  void open(const std::string& path)
  {
    if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path) &&
        !std::filesystem::is_directory(path))
      throw pcs::IO_error(path, "is no regular file, but it is read several times");
    const pcs::IO::Point_reader reader(path);
    m_files.push_back({path, reader.schema(), 0});
    m_expected_total += reader.number_of_points().value_or(0);
  }

  template <class Use>
  void count(File& file, const Use& use, Progress_line& line)
  {
    const std::uint64_t first = m_total;
    read(file, first, [&](const pcs::IO::Point_table& chunk, std::uint64_t next) {
      use(chunk, next, file);
      m_total = next + chunk.number_of_points();
      if (m_expected_total > 0) // otherwise no file states the number of its points
        line.show("counting", fraction(m_total, m_expected_total));
    });
    file.number_of_points = m_total - first;
  }

  /// Called by the handler of an error, which is thrown again if the file is not left out.
  void skip(const std::string& path, const pcs::IO_error& error)
  {
    if (!m_do_skip_damaged)
      throw;
    m_skipped.push_back({path, error.what()});
  }

  static double fraction(std::uint64_t part, std::uint64_t total)
  {
    return std::min(1.0, static_cast<double>(part) / static_cast<double>(total));
  }

  template <class Use>
  static void read(const File& file, std::uint64_t first, const Use& use)
  {
    pcs::IO::Point_reader reader(file.path);
    pcs::IO::Point_table chunk;
    for (; reader.read(chunk, chunk_size); first += chunk.number_of_points())
      use(std::as_const(chunk), first);
  }

  void find_shared()
  {
    m_shared.properties.clear();
    m_warnings.clear();
    m_left_out.clear();
    if (m_files.empty())
      throw pcs::IO_error(m_skipped.front().path,
                          "none of the " + std::to_string(m_skipped.size()) +
                              " inputs can be read; " + m_skipped.front().reason);
    for (const File& file : m_files)
      for (const std::string& warning : file.schema.warnings)
        m_warnings.push_back(file.path + ": " + warning);
    for (pcs::IO::Property_description p : m_files.front().schema.properties) {
      if (pcs::IO::is_coordinate_name(p.name))
        p.type = pcs::IO::Scalar_type::float64;
      else if (!is_in_all(p))
        continue;
      m_shared.properties.push_back(p);
    }
    for (const File& file : m_files)
      for (const pcs::IO::Property_description& p : file.schema.properties)
        if (!m_shared.has(p.name))
          warn_once(file, p);
  }

  bool is_in_all(const pcs::IO::Property_description& p) const
  {
    return std::all_of(m_files.begin(), m_files.end(), [&](const File& file) {
      const std::size_t i = file.schema.find(p.name);
      return i < file.schema.properties.size() && file.schema.properties[i] == p;
    });
  }

  /// Warns about a property that is not shared, unless another file gave the same warning.
  void warn_once(const File& owner, const pcs::IO::Property_description& p)
  {
    if (std::find(m_left_out.begin(), m_left_out.end(), p.name) != m_left_out.end())
      return;
    m_left_out.push_back(p.name);
    for (const File& file : m_files) {
      const std::size_t i = file.schema.find(p.name);
      const bool is_there = i < file.schema.properties.size();
      if (is_there && file.schema.properties[i] == p)
        continue;
      m_warnings.push_back(
          "the property '" + p.name + "' is left out, because it is " + name_of(p.type) + " in " +
          owner.path + " and " +
          (is_there ? name_of(file.schema.properties[i].type) : std::string("missing")) + " in " +
          file.path);
      return;
    }
  }

  bool m_is_quiet, m_do_skip_damaged;
  std::vector<File> m_files;
  std::vector<Skipped> m_skipped;
  pcs::IO::Point_schema m_shared;
  std::vector<std::string> m_warnings, m_left_out;
  std::uint64_t m_expected_total = 0; ///< of the files that state their number of points
  std::uint64_t m_total = 0;          ///< known after `count()`
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_POINT_FILES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The log of a batch of extract_tree_skeleton: results, and the inputs and options that they were
// made from.

#ifndef PCS_EXAMPLES_PROGRAMS_SKELETON_BATCH_LOG_H
#define PCS_EXAMPLES_PROGRAMS_SKELETON_BATCH_LOG_H

#include "skeleton/Skeleton_options.h"
#include <pcs/core/errors.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <system_error>

namespace program {

/// Returns the current state of a scan and the options on which its results depend.
inline nlohmann::ordered_json origin_of(const std::string& input, const Skeleton_options& one)
{
  namespace fs = std::filesystem;
  std::error_code error;
  return {{"file", fs::absolute(input, error).lexically_normal().string()},
          {"bytes", fs::file_size(input, error)},
          {"modified", fs::last_write_time(input, error).time_since_epoch().count()},
          {"version", PCS_PROGRAM_VERSION},
          {"options", to_json(one)}};
}

/// FOLDER/batch.jsonl: one line per processed scan. The last success of each result is valid.
class Batch_log
{
public:
  using Json = nlohmann::ordered_json;

  /// Throws `pcs::IO_error`.
  explicit Batch_log(const std::string& folder) : m_folder(folder), m_path(m_folder / "batch.jsonl")
  {
    std::error_code error;
    std::filesystem::create_directories(m_folder, error);
    if (!std::filesystem::is_directory(m_folder))
      throw pcs::IO_error(folder, "is not a directory and cannot be made one");
    const bool is_torn = read();
    m_out.open(m_path, std::ios::app);
    if (is_torn)
      m_out << '\n';
    if (!m_out)
      throw pcs::IO_error(m_path.string(), "cannot be opened for writing");
  }

  const std::filesystem::path& path() const { return m_path; }

  /// Whether all results exist and were made from the same scan with the same options.
  bool is_done(const Skeleton_options& one, const Json& origin) const
  {
    if (!is_same(one, origin))
      return false;
    const Sizes& sizes = m_entries.at(one.swc).sizes;
    for (const std::string& name : names_of_results(one)) {
      const auto size =
          sizes.find(name); // an interrupted batch may have written other results since then
      if (size == sizes.end() || size_of(name) != size->second)
        return false;
    }
    return true;
  }

  /// Throws `pcs::Invalid_input` if the results belong to another scan that still exists.
  void check_owner(const Skeleton_options& one, const Json& origin) const
  {
    const auto entry = m_entries.find(one.swc);
    if (entry == m_entries.end() || !is_there(one.swc))
      return;
    const std::string before = entry->second.origin["file"], now = origin["file"];
    std::error_code error;
    if (before != now && is_there(before) && !std::filesystem::equivalent(before, now, error))
      throw pcs::Invalid_input(one.swc + " is the skeleton of " + before + "; use another folder");
  }

  /// Removes results of a previous state of the scan or of other options, except those in `made`.
  /// Called after the work, which may be interrupted.
  void remove_outdated(const Skeleton_options& one,
                       const Json& origin,
                       const std::set<std::string>& made = {})
  {
    const auto entry = m_entries.find(one.swc);
    if (entry == m_entries.end() || is_same(one, origin) ||
        !is_there(origin["file"].get<std::string>()))
      return;
    std::error_code error;
    for (const auto& size : entry->second.sizes) {
      const std::filesystem::path name = std::filesystem::path(size.first).filename();
      if (made.count(name.string()) == 0)
        std::filesystem::remove(m_folder / name, error);
    }
    m_entries.erase(entry);
  }

  /// Records results after they were written. Throws `pcs::IO_error`.
  void add_success(const Skeleton_options& one, const Json& origin, Json line)
  {
    const std::set<std::string> made = names_of_results(one);
    remove_outdated(one, origin, made);
    Sizes sizes;
    for (const std::string& name : made)
      sizes[name] = size_of(name);
    if (const auto entry = m_entries.find(one.swc); entry != m_entries.end())
      sizes.insert(entry->second.sizes.begin(), entry->second.sizes.end());
    line["made_from"] = origin;
    line["files"] = sizes;
    add(line);
  }

  /// Records a failure. Throws `pcs::IO_error`.
  void add_failure(const std::string& input, const std::string& what)
  {
    add({{"input", input}, {"status", "failed"}, {"error", what}});
  }

private:
  using Sizes = std::map<std::string, std::uintmax_t>; ///< of files [bytes]

  struct Entry
  {
    Json origin;
    Sizes sizes;
  };

  static bool is_there(const std::filesystem::path& path)
  {
    std::error_code error;
    return std::filesystem::exists(path, error);
  }

  /// Returns the size of a file, or the largest number if it does not exist.
  std::uintmax_t size_of(const std::string& name) const
  {
    std::error_code error;
    return std::filesystem::file_size(m_folder / name, error);
  }

  static std::set<std::string> names_of_results(const Skeleton_options& one)
  {
    std::set<std::string> names;
    for (const std::string* path : results_of(one))
      if (!path->empty())
        names.insert(std::filesystem::path(*path).filename().string());
    return names;
  }

  /// Compares the origins. Options of results that were made but are not requested are ignored.
  bool is_same(const Skeleton_options& one, const Json& origin) const
  {
    const auto entry = m_entries.find(one.swc);
    if (entry == m_entries.end())
      return false;
    const Json& before = entry->second.origin;
    for (const char* key : {"bytes", "modified", "version"})
      if (before.value(key, Json()) != origin[key])
        return false;
    for (const auto& [name, value] : origin["options"].items())
      if (before["options"].value(name, Json()) != value)
        return false;
    return true;
  }

  /// Returns whether the last line is incomplete. Lines that do not record a success of this
  /// version are ignored.
  bool read()
  {
    std::ifstream in(m_path);
    bool is_torn = false;
    for (std::string text; std::getline(in, text);) {
      is_torn = in.eof();
      try {
        const Json line = Json::parse(text);
        if (line.at("status") != "converged")
          continue;
        const std::string scan = line.at("input"), file = line.at("made_from").at("file");
        const Entry entry{line.at("made_from"), line.at("files").get<Sizes>()};
        if (entry.origin.at("options").is_object())
          m_entries[name_of_results(scan, m_folder.string()) + ".swc"] = entry;
      } catch (const Json::exception&) {
      }
    }
    return is_torn;
  }

  void add(const Json& line)
  {
    m_out << line.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!m_out)
      throw pcs::IO_error(m_path.string(), "cannot be written");
  }

  std::filesystem::path m_folder, m_path;
  std::ofstream m_out;
  std::map<std::string, Entry> m_entries; ///< by the path of the skeleton
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SKELETON_BATCH_LOG_H

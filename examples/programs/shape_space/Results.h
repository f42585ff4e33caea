// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Where results go: names of files, and whether they can be written, before anything is computed.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_RESULTS_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_RESULTS_H

#include "Options.h"
#include "common/Distinct_files.h"
#include "common/Report_file.h"
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <vector>

namespace orl_program {

inline std::string numbered(const char* name, std::size_t i)
{
  char text[64];
  std::snprintf(text, sizeof(text), "%s_%04zu", name, i);
  return text;
}

/// Returns the names of all possible files in the folder of the results; there may be fewer modes.
inline std::set<std::string> names_of_results(const Options& o)
{
  std::vector<std::string> trees;
  if (o.has_places())
    for (const double lambda : o.lambda)
      trees.push_back(name_of(lambda));
  if (o.do_mean)
    trees.push_back("mean");
  if (!o.weights.empty())
    trees.push_back("weighted_mean");
  for (std::size_t k = 1; k <= o.number_of_modes; ++k)
    for (const char* side : {"_minus", "_plus"})
      trees.push_back("mode_" + std::to_string(k) + side);
  for (std::size_t i = 0; i < o.number_of_samples; ++i)
    trees.push_back(numbered("sample", i));
  for (std::size_t i = 0; o.do_growth && i < o.number_of_frames; ++i)
    trees.push_back(numbered("growth", i));
  std::set<std::string> names;
  for (const std::string& tree : trees)
    for (const char* end : {".swc", ".ply", "_surface.ply"})
      names.insert(tree + end);
  if (o.number_of_modes > 0)
    names.insert("modes.json");
  return names;
}

/// Checks that no result is an input, another result, or a folder.
inline void check_files(const Options& o)
{
  namespace fs = std::filesystem;
  program::Distinct_files files;
  std::set<std::string> seen; // names of existing and future files
  const auto add = [&](const std::string& path, bool is_written) {
    is_written ? files.add_output(path) : files.add_input(path);
    seen.insert(fs::path(path).filename().string());
  };
  for (const auto* inputs : {&o.trees, &o.skeletons})
    for (const std::string& input : *inputs)
      add(input, false);
  add(o.load, false);
  for (const std::string* path :
       {&o.correspondences, &o.matches, &o.report, &o.changes, &o.distances, &o.save})
    add(*path, true);
  const std::set<std::string> names = names_of_results(o);
  std::error_code error;
  for (fs::directory_iterator at(o.output, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (names.count(name) > 0 && fs::is_directory(at->path(), error))
      throw pcs::IO_error(at->path().string(), "is a directory, expected a file name");
    seen.insert(name);
  }
  for (const std::string& name : seen)
    if (names.count(name) > 0)
      files.add_output((fs::path(o.output) / name).string());
}

/// The folder of the results. Folders created for it are removed if the work fails before there is
/// a result.
class Result_folder
{
public:
  explicit Result_folder(const std::string& path)
  {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::exists(status) && !fs::is_directory(status))
      throw pcs::IO_error(path, "is a file, expected a folder");
    for (fs::path at = fs::absolute(path).lexically_normal();
         at.has_relative_path() && !fs::exists(at, error);
         at = at.parent_path())
      m_made.push_back(at);
    fs::create_directories(path, error);
    if (!fs::is_directory(path))
      throw pcs::IO_error(path, "cannot be made a folder: " + error.message());
    try {
      const program::Report_file probe((fs::path(path) / "probe").string());
    } catch (const pcs::IO_error&) {
      remove_empty();
      throw pcs::IO_error(path, "no files can be written in this folder");
    }
  }
  Result_folder(const Result_folder&) = delete;
  Result_folder& operator=(const Result_folder&) = delete;
  ~Result_folder()
  {
    if (std::uncaught_exceptions() > m_number_of_exceptions)
      remove_empty();
  }

private:
  void remove_empty() const
  {
    std::error_code error;
    for (const std::filesystem::path& folder : m_made) // innermost folder first
      std::filesystem::remove(folder, error);
  }

  std::vector<std::filesystem::path> m_made;
  int m_number_of_exceptions = std::uncaught_exceptions();
};

/// Throws unless a file can be written later by other functions. Pipes are not opened, because this
/// would write to them.
inline void probe_file(const std::string& path)
{
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!path.empty() && (!std::filesystem::exists(status) || std::filesystem::is_directory(status) ||
                        std::filesystem::is_regular_file(status)))
    const program::Report_file probe(path);
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_RESULTS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The files of the trees of one scan: SCAN_1.ply, SCAN_2.ply, ... in a folder.

#ifndef PCS_EXAMPLES_PROGRAMS_SCAN_FILES_OF_TREES_H
#define PCS_EXAMPLES_PROGRAMS_SCAN_FILES_OF_TREES_H

#include "common/Distinct_files.h"
#include "scan/tree_foot.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/internal/extensions.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace program {

/// Names the files, and protects others that have such a name: a file of a tree has its foot as a
/// comment.
class Files_of_trees
{
public:
  Files_of_trees(const std::string& scan, const std::string& folder)
    : m_folder(folder),
      m_prefix(std::filesystem::path(pcs::IO::internal::without_gz(scan)).stem().string() + "_")
  {
  }

  /// Returns the path of the file of tree `tree`, counted from 0; names begin with 1.
  std::string path_of(std::size_t tree) const
  {
    return (m_folder / (m_prefix + std::to_string(tree + 1) + ".ply")).string();
  }

  /// Throws `pcs::Invalid_input` if another result has the name of a file of a tree.
  void check_result(const std::string& path) const
  {
    const auto folder_of = [](const std::filesystem::path& p) {
      return std::filesystem::path(Distinct_files::real(p.string())).parent_path();
    };
    const std::filesystem::path file(path);
    if (!path.empty() && is_name(file.filename().string()) &&
        folder_of(file) == folder_of(m_folder / "x"))
      throw pcs::Invalid_input(path + " has the name of a file of a tree in --folder; choose "
                                      "another name");
  }

  /// Throws `pcs::Invalid_input` if a tree with a file would replace a file that is none of a tree.
  void check_replaced(const std::vector<bool>& has_file) const
  {
    std::error_code error;
    for (std::size_t t = 0; t < has_file.size(); ++t)
      if (has_file[t] && std::filesystem::exists(path_of(t), error) && !is_tree(path_of(t)))
        throw pcs::Invalid_input(path_of(t) +
                                 " exists and is no file of a tree of segment_trees, which would "
                                 "replace it; choose another --folder");
  }

  /// Returns the number of files of trees in the folder that this run does not write.
  std::size_t number_of_others(const std::vector<bool>& has_file) const
  {
    std::vector<std::string> own;
    for (std::size_t t = 0; t < has_file.size(); ++t)
      if (has_file[t])
        own.push_back(std::filesystem::path(path_of(t)).filename().string());
    std::sort(own.begin(), own.end());
    std::size_t others = 0;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(m_folder, error)) {
      const std::string name = entry.path().filename().string();
      others += is_name(name) && !std::binary_search(own.begin(), own.end(), name) &&
                is_tree(entry.path().string());
    }
    return others;
  }

private:
  /// Returns whether a name is that of the file of any tree.
  bool is_name(const std::string& name) const
  {
    const std::string extension = ".ply";
    if (name.size() <= m_prefix.size() + extension.size() || name.rfind(m_prefix, 0) != 0 ||
        name.substr(name.size() - extension.size()) != extension)
      return false;
    const std::string number =
        name.substr(m_prefix.size(), name.size() - m_prefix.size() - extension.size());
    return number.front() != '0' &&
           std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
  }

  static bool is_tree(const std::string& path)
  {
    try {
      const pcs::IO::Point_reader reader(path);
      const std::vector<std::string>& comments = reader.schema().comments;
      return std::any_of(comments.begin(), comments.end(), [](const std::string& c) {
        return c.rfind(foot_keyword(), 0) == 0;
      });
    } catch (const std::exception&) { // no file of points
      return false;
    }
  }

  std::filesystem::path m_folder;
  std::string m_prefix;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SCAN_FILES_OF_TREES_H

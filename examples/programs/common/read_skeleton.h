// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a skeleton file in the format of its extension, for the programs.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_READ_SKELETON_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_READ_SKELETON_H

#include <pcs/IO/internal/extensions.h>
#include <pcs/IO/read_cylinders.h>
#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_tree_csv.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace program {

/*!
  Reads a skeleton: .txtskl, .csv, or SWC with any other extension; the extension .gz of compressed
  files is skipped. Files .csv and .txt may be tables of cylinders. `ids` receives the ids of the
  nodes, none if the format has none. Of a file with several trees, the tree `root_number` is read;
  1 is the largest. Formats of a single tree ignore the number.
*/
template <class Kernel>
pcs::IO::Tree_selection read_skeleton(const std::string& path,
                                      pcs::Tree_skeleton<Kernel>& tree,
                                      std::vector<std::int64_t>& ids,
                                      std::size_t root_number = 1)
{
  namespace files = pcs::IO::internal;
  const std::string extension = files::extension_of(files::without_gz(path));
  ids.clear();
  if (extension == "txtskl") {
    pcs::IO::read_txtskl<Kernel>(path, tree);
    return {1, num_vertices(tree), 0};
  }
  if ((extension == "csv" || extension == "txt") && pcs::IO::is_cylinder_table(path))
    return pcs::IO::read_cylinders<Kernel>(path, tree, ids, root_number);
  if (extension == "csv") {
    std::vector<std::size_t> hits;
    pcs::IO::read_tree_csv<Kernel>(path, tree, hits, ids);
    return {1, num_vertices(tree), 0};
  }
  try {
    return pcs::IO::read_swc<Kernel>(path, tree, ids, root_number);
  } catch (const pcs::IO_error& error) {
    if (extension != "txt")
      throw;
    const std::string what = error.what();
    throw pcs::IO_error(path,
                        what.substr(std::min(what.size(), path.size() + 2)) +
                            " (read as SWC; a table of cylinders needs the names of its columns in "
                            "the first line)");
  }
}

/// Returns the warning of a selection, with the option of the program instead of the parameter;
/// empty if no tree was left out.
inline std::string warning_of_selection(const pcs::IO::Tree_selection& selection,
                                        const std::string& option)
{
  const std::vector<std::string> sentences = warnings(selection);
  if (sentences.empty())
    return {};
  std::string sentence = sentences.front();
  const std::string parameter = "root_number";
  if (const std::size_t at = sentence.find(parameter); at != std::string::npos)
    sentence.replace(at, parameter.size(), option);
  return sentence;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_READ_SKELETON_H

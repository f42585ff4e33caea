// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a tree skeleton from an SWC file.

#ifndef PCS_IO_READ_SWC_H
#define PCS_IO_READ_SWC_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/assign_branches.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {

namespace internal {

//! returns for each node the child of the same type, or `npos`; the result is empty unless all
//! types are 5 plus the order of a branch
inline std::vector<std::size_t> same_type_behind(const std::vector<std::int64_t>& types,
                                                 const std::vector<std::size_t>& parents)
{
  constexpr std::int64_t of_trunk = 5;
  std::vector<std::size_t> next(types.size(), npos);
  for (std::size_t i = 0; i < types.size(); ++i) {
    const std::size_t p = parents[i];
    if (types[i] < of_trunk || (p == npos && types[i] != of_trunk) ||
        (p != npos && types[i] != types[p] && types[i] - 1 != types[p]))
      return {};
    if (p == npos || types[i] != types[p])
      continue;
    if (next[p] != npos)
      return {};
    next[p] = i;
  }
  return next;
}

/// Nodes of an SWC file, of one tree or several.
template <class Kernel>
struct Swc_rows
{
  std::vector<Tree_row> rows;
  std::vector<Tree_node<Kernel>> nodes;
  std::vector<std::int64_t> types;
};

constexpr std::size_t number_of_swc_columns = 7;

/*
  Splits a line into words. Returns their number, which may exceed the number of columns. Refuses a
  line that has twice as many words as the first one, or half as many: a line break is missing.
*/
inline std::size_t split_swc_line(const Input_file& file,
                                  std::string_view line,
                                  std::size_t number_in_first,
                                  std::array<std::string_view, number_of_swc_columns>& words)
{
  std::size_t n = 0;
  for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++n)
    if (n < words.size())
      words[n] = word;
  const std::string found = ", found " + std::to_string(n);
  if (n < words.size())
    file.fail_at_line("expected the 7 columns id, type, x, y, z, radius, parent" + found +
                      "; columns are separated by blanks");
  if (number_in_first > 0 && (n >= 2 * number_in_first || number_in_first >= 2 * n))
    file.fail_at_line("expected " + std::to_string(number_in_first) +
                      " columns as in the first row" + found + "; is a line break missing?");
  return n;
}

template <class Kernel>
Swc_rows<Kernel> read_swc_rows(const std::string& path)
{
  using FT = typename Kernel::FT;
  Input_file file(path);
  Swc_rows<Kernel> result;
  std::size_t number_in_first = 0;
  std::string_view line;
  while (file.read_line(line)) {
    if (file.line_number() == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") // byte order mark
      line.remove_prefix(3);
    line = trim(line.substr(0, line.find('#')));
    if (line.empty())
      continue;
    std::array<std::string_view, number_of_swc_columns> words;
    const std::size_t n = split_swc_line(file, line, number_in_first, words);
    if (number_in_first == 0)
      number_in_first = n;
    result.types.push_back(required_number<std::int64_t>(file, words[1], "type"));
    const auto x = required_number<double>(file, words[2], "x");
    const auto y = required_number<double>(file, words[3], "y");
    const auto z = required_number<double>(file, words[4], "z");
    Tree_node<Kernel> node;
    node.point = typename Kernel::Point_3(FT(x), FT(y), FT(z));
    node.radius = FT(required_length(file, words[5], "radius"));
    node.major_radius = node.minor_radius = node.radius;
    result.nodes.push_back(node);
    result.rows.push_back({required_number<std::int64_t>(file, words[0], "id"),
                           required_number<std::int64_t>(file, words[6], "parent"),
                           file.line_number()});
    if (result.rows.back().id < 0)
      file.fail_at_line("an id must not be negative, found " + in_quotes(words[0]));
  }
  return result;
}

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief reads a tree skeleton from an SWC file: lines `id type x y z radius parent`.

  Text after `#` is a comment, blank lines are skipped, and further columns are ignored. Parents
  may follow their children, and ids may have gaps. Nodes are numbered in the order of the file. The
  format does not contain branches. If its types are 5 plus an order, as `write_swc()` writes them,
  the branches are determined from the types, otherwise by `assign_branches()`. The format does not
  contain cross-sections, so all are circles.

  A file may contain several trees, each with a root (parent -1). One of them is read.

  \tparam Kernel a kernel of CGAL
  \param path name of the file
  \param tree is replaced; unchanged when an exception is thrown
  \param ids is replaced by the ids of the nodes in the file
  \param root_number the tree that is read: 1 is the tree with the most nodes, 2 the next; trees of
         the same size are in the order of their roots in the file [count]
  \return the numbers of trees and nodes in the file; `warnings()` makes a sentence of them if
          trees were left out
  \throws pcs::IO_error when the file cannot be read, a line does not have seven columns of finite
          numbers, an id is used twice, a parent is missing, a radius is negative, nodes descend
          from no root, or there is no tree `root_number`
  \par Complexity
  Linear in the size of the file.
*/
template <class Kernel>
Tree_selection read_swc(const std::string& path,
                        Tree_skeleton<Kernel>& tree,
                        std::vector<std::int64_t>& ids,
                        std::size_t root_number = 1)
{
  const internal::Swc_rows<Kernel> found = internal::read_swc_rows<Kernel>(path);
  const internal::Tree_links links(path, found.rows, internal::Roots::several);
  Tree_selection selection;
  const std::vector<std::size_t> kept = internal::rows_of_tree(path, links, root_number, selection);
  std::vector<std::size_t> node_of(found.rows.size(), npos), parents(kept.size(), npos);
  for (std::size_t i = 0; i < kept.size(); ++i)
    node_of[kept[i]] = i;
  Tree_skeleton<Kernel> result(kept.size());
  std::vector<std::int64_t> types, kept_ids;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    result[i] = found.nodes[kept[i]];
    types.push_back(found.types[kept[i]]);
    kept_ids.push_back(found.rows[kept[i]].id);
    if (const std::size_t parent = links.parents()[kept[i]]; parent != npos) {
      parents[i] = node_of[parent];
      add_edge(parents[i], i, result);
    } else
      result[boost::graph_bundle].root = i;
  }
  const std::vector<std::size_t> next = internal::same_type_behind(types, parents);
  if (next.empty())
    assign_branches<Kernel>(result);
  else
    pcs::internal::assign_branches<Kernel>(result, [&](std::size_t v) { return next[v]; });
  tree = result;
  ids.swap(kept_ids);
  return selection;
}

//! \ingroup PkgPcsIORef
//! overload without the ids
template <class Kernel>
Tree_selection
read_swc(const std::string& path, Tree_skeleton<Kernel>& tree, std::size_t root_number = 1)
{
  std::vector<std::int64_t> ids;
  return read_swc<Kernel>(path, tree, ids, root_number);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_SWC_H

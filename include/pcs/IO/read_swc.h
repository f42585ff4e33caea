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

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief reads a tree skeleton from an SWC file: lines `id type x y z radius parent`.

  Lines that are blank or begin with `#` are skipped; parents may follow their children. Nodes are
  numbered in the order of the file. The format does not contain branches. If its types are 5 plus
  an order, as `write_swc()` writes them, the branches are determined from the types, otherwise by
  `assign_branches()`. The format does not contain cross-sections, so all are circles.

  \tparam Kernel a kernel of CGAL
  \param path name of the file
  \param tree is replaced; unchanged when an exception is thrown
  \param ids is replaced by the ids of the nodes in the file
  \throws pcs::IO_error when the file cannot be read, a line does not have seven columns of finite
          numbers, an id is used twice, a parent is missing, a radius is negative, or the nodes do
          not form one tree with one root (parent -1)
  \par Complexity
  Linear in the size of the file.
*/
template <class Kernel>
void read_swc(const std::string& path, Tree_skeleton<Kernel>& tree, std::vector<std::int64_t>& ids)
{
  using FT = typename Kernel::FT;
  internal::Input_file file(path);
  std::vector<internal::Tree_row> rows;
  std::vector<Tree_node<Kernel>> nodes;
  std::vector<std::int64_t> types;
  std::string_view line;
  while (file.read_line(line)) {
    if (file.line_number() == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") // byte order mark
      line.remove_prefix(3);
    line = internal::trim(line);
    if (line.empty() || line[0] == '#')
      continue;
    std::array<std::string_view, 7> words;
    std::size_t n = 0;
    for (std::string_view word = internal::next_word(line); !word.empty();
         word = internal::next_word(line), ++n)
      if (n < words.size())
        words[n] = word;
    if (n != words.size())
      file.fail_at_line("expected the 7 columns id, type, x, y, z, radius, parent, found " +
                        std::to_string(n));
    types.push_back(internal::required_number<std::int64_t>(file, words[1], "type"));
    const auto x = internal::required_number<double>(file, words[2], "x");
    const auto y = internal::required_number<double>(file, words[3], "y");
    const auto z = internal::required_number<double>(file, words[4], "z");
    Tree_node<Kernel> node;
    node.point = typename Kernel::Point_3(FT(x), FT(y), FT(z));
    node.radius = FT(internal::required_length(file, words[5], "radius"));
    node.major_radius = node.minor_radius = node.radius;
    nodes.push_back(node);
    rows.push_back({internal::required_number<std::int64_t>(file, words[0], "id"),
                    internal::required_number<std::int64_t>(file, words[6], "parent"),
                    file.line_number()});
    if (rows.back().id < 0)
      file.fail_at_line("an id must not be negative, found " + internal::in_quotes(words[0]));
  }
  const internal::Tree_links links(path, rows);
  Tree_skeleton<Kernel> result(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    result[i] = nodes[i];
    if (links.parents()[i] != npos)
      add_edge(links.parents()[i], i, result);
  }
  result[boost::graph_bundle].root = links.root();
  const std::vector<std::size_t> next = internal::same_type_behind(types, links.parents());
  if (next.empty())
    assign_branches<Kernel>(result);
  else
    pcs::internal::assign_branches<Kernel>(result, [&](std::size_t v) { return next[v]; });
  tree = result;
  ids.clear();
  for (const internal::Tree_row& row : rows)
    ids.push_back(row.id);
}

//! \ingroup PkgPcsIORef
//! overload without the ids
template <class Kernel>
void read_swc(const std::string& path, Tree_skeleton<Kernel>& tree)
{
  std::vector<std::int64_t> ids;
  read_swc<Kernel>(path, tree, ids);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_SWC_H

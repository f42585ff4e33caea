// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a tree skeleton from a table of cylinders.

#ifndef PCS_IO_READ_CYLINDERS_H
#define PCS_IO_READ_CYLINDERS_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/cylinders/Cylinder_table.h>
#include <pcs/IO/internal/cylinders/Cylinder_tree.h>
#include <pcs/core/Tree_skeleton.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief returns whether a file is a table of cylinders, that is, whether its first line names a
         column of start coordinates.

  Comments (`#`) and blank lines before this line are skipped. Only lines up to this one are read.

  \throws pcs::IO_error when the file cannot be read
*/
inline bool is_cylinder_table(const std::string& path)
{
  internal::Input_file file(path);
  std::string_view line;
  if (!internal::read_table_line(file, line))
    return false;
  for (const std::string_view name : internal::split_at(internal::separator_of(line), line))
    if (const auto [first, number] = internal::columns_of_name(name);
        number > 0 && first < internal::column_start + 3)
      return true;
  return false;
}

/*!
  \ingroup PkgPcsIORef
  \brief reads a tree skeleton from a table of cylinders, as `write_cylinders()`, TreeQSM,
         SimpleForest, aRchi and rTwig write it.

  The first line names the columns, in any order, separated by tabs, semicolons, commas or blanks:

  | contents | names |
  |---|---|
  | start [L] | `sx`, `startX`, `start.x`, `start_1`, ..., or `start_point` for three columns |
  | end [L] | `endX`, `end.x`, ...; or an axis and a length |
  | axis [-] | `ax`, `axisX`, `axis.x`, `axis_1`, ..., or `axis_direction` for three columns |
  | length [L] | `length` |
  | radius [L] | `radius`, `radius_cyl` |
  | parent | `parent`, `parentID`: an id; none: -1, `NA`, or 0 if no cylinder has the id 0 |
  | id, optional | `ID`, `cyl_ID`; otherwise rows are numbered from 1 |
  | branch, optional | `branch`, `branchID`, `axis_ID` |

  Letter case, units in parentheses, quotes and other columns are ignored.

  Consecutive cylinders of a branch share a node, whose radius is the mean of theirs. The first
  cylinder of a branch begins at a node of its own, which is a child of the nearer end of the parent
  cylinder. Without branches in the table, or if they are not chains, branches are determined by
  `assign_branches()`.

  A file with several trees is read as by `read_swc()`. A cylinder without parent belongs to the
  tree of the first such cylinder if the distance of their starts is at most the radius of the
  first.

  \tparam Kernel a kernel of CGAL
  \param path name of the file
  \param tree is replaced; unchanged when an exception is thrown
  \param ids is replaced by the id of the cylinder that ends at each node, -1 for the first nodes of
         branches
  \param root_number the tree that is read: 1 is the tree with the most cylinders, 2 the next
         [count]
  \return the numbers of trees and cylinders in the file
  \throws pcs::IO_error when the file cannot be read, a column is missing or named twice, a line has
          another number of columns or a value that is not a finite number, an id is used twice, a
          parent is missing, a radius or length is negative, an axis is null, or there is no tree
          `root_number`
  \par Complexity
  Linear in the size of the file.
*/
template <class Kernel>
Tree_selection read_cylinders(const std::string& path,
                              Tree_skeleton<Kernel>& tree,
                              std::vector<std::int64_t>& ids,
                              std::size_t root_number = 1)
{
  const internal::Cylinder_rows table = internal::read_cylinder_rows(path);
  const internal::Tree_links links(path, table.rows, internal::Roots::several);
  Tree_selection selection;
  const std::vector<std::size_t> kept = internal::rows_of_tree(path, links, root_number, selection);
  std::vector<std::size_t> index(table.rows.size(), npos), parents;
  for (std::size_t i = 0; i < kept.size(); ++i)
    index[kept[i]] = i;
  std::vector<internal::Cylinder> cylinders;
  for (const std::size_t row : kept) {
    const std::size_t parent = links.parents()[row];
    parents.push_back(parent == npos ? npos : index[parent]);
    cylinders.push_back(table.cylinders[row]);
  }
  const internal::Cylinder_tree<Kernel> result(cylinders, parents, table.has_branches);
  std::vector<std::int64_t> ids_of_nodes;
  for (const std::size_t c : result.cylinder_of_node())
    ids_of_nodes.push_back(c == npos ? -1 : table.rows[kept[c]].id);
  tree = result.tree();
  ids.swap(ids_of_nodes);
  return selection;
}

//! \ingroup PkgPcsIORef
//! overload without the ids
template <class Kernel>
Tree_selection
read_cylinders(const std::string& path, Tree_skeleton<Kernel>& tree, std::size_t root_number = 1)
{
  std::vector<std::int64_t> ids;
  return read_cylinders<Kernel>(path, tree, ids, root_number);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_CYLINDERS_H

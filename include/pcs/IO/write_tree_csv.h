// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a tree skeleton with branches and sections to a CSV file.

#ifndef PCS_IO_WRITE_TREE_CSV_H
#define PCS_IO_WRITE_TREE_CSV_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Tree_skeleton.h>

#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief writes a tree skeleton to a CSV file with the columns
         `id,parent,branch,order,x,y,z,r,a,b,hits`.

  Each row is one node, and `read_tree_csv()` reads the file.
  - `id` is the index of the node in `tree`, so that labels of points by nodes remain valid.
  - `parent` is the id of the parent, -1 for the root.
  - `branch` is `Tree_branch::id`, or the index of the branch if it has no id.
  - `x`, `y`, `z`, the radius `r` and the half axes `a`, `b` of the cross-section have the length
    unit of the tree [L].

  Numbers have as many digits as required to read them back unchanged. The file is written
  completely or not at all.

  \tparam Kernel a kernel of CGAL
  \param path name of the file
  \param tree a tree with branches
  \param hits one value per node: the number of points on it [count]; empty: the column is omitted
  \throws pcs::IO_error when the file cannot be written
  \throws pcs::Invalid_input when the graph is not a tree below its root, a number is not finite,
          a branch of a node does not exist, or `hits` has another size than there are nodes
  \par Complexity
  Linear in the number of nodes.
*/
template <class Kernel>
void write_tree_csv(const std::string& path,
                    const Tree_skeleton<Kernel>& tree,
                    const std::vector<std::size_t>& hits = {})
{
  constexpr const char* caller = "write_tree_csv";
  const Tree_bundle& bundle = tree[boost::graph_bundle];
  if (!hits.empty() && hits.size() != num_vertices(tree))
    throw Invalid_input("pcs::IO::write_tree_csv(): `hits` has " + std::to_string(hits.size()) +
                        " values for " + std::to_string(num_vertices(tree)) + " nodes");
  const std::vector<std::size_t> order = internal::writing_order(tree, bundle.root, caller);

  internal::Output_file file(path);
  file.write("id,parent,branch,order,x,y,z,r,a,b");
  file.write(hits.empty() ? "\n" : ",hits\n");
  std::string line;
  for (const std::size_t v : order) {
    const Tree_node<Kernel>& node = tree[v];
    if (node.branch >= bundle.branches.size())
      throw Invalid_input("pcs::IO::write_tree_csv(): node " + std::to_string(v) +
                          " is of branch " + std::to_string(node.branch) +
                          ", which does not exist");
    const Tree_branch& branch = bundle.branches[node.branch];
    const std::size_t parent = parent_node<Kernel>(v, tree);
    line.clear();
    internal::append_number(line, v);
    line += ',';
    line += parent == npos ? "-1" : std::to_string(parent);
    line += ',';
    internal::append_number(line, branch.id == npos ? node.branch : branch.id);
    line += ',';
    internal::append_number(line, branch.order);
    for (const double value :
         {internal::finite_value(node.point.x(), "x", v, caller),
          internal::finite_value(node.point.y(), "y", v, caller),
          internal::finite_value(node.point.z(), "z", v, caller),
          internal::finite_value(node.radius, "the radius", v, caller),
          internal::finite_value(node.major_radius, "the major radius", v, caller),
          internal::finite_value(node.minor_radius, "the minor radius", v, caller)}) {
      line += ',';
      internal::append_number(line, value);
    }
    if (!hits.empty()) {
      line += ',';
      internal::append_number(line, hits[v]);
    }
    line += '\n';
    file.write(line);
  }
  file.commit();
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_TREE_CSV_H

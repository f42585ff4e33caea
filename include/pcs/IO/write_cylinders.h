// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a tree skeleton as a table of cylinders, or as a PLY file of nodes and edges.

#ifndef PCS_IO_WRITE_CYLINDERS_H
#define PCS_IO_WRITE_CYLINDERS_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Tree_skeleton.h>

#include <CGAL/number_utils.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief writes one cylinder per edge inside a branch, with the cylinder columns of TreeQSM.

  Columns: `sx, sy, sz` (start), `ax, ay, az` (axis), `length, radius, parent, branch, order,
  radius_error, is_measured`. The axis is a unit vector; `parent` is a row number from 1, or 0 if
  there is none; `branch` counts from 1. Edges of length zero have no cylinder. The file is complete
  or absent.

  \throws pcs::IO_error when the file cannot be written
  \throws pcs::Invalid_input when the graph is not a tree below its root, or a number is not finite
*/
template <class Kernel>
void write_cylinders(const std::string& path, const Tree_skeleton<Kernel>& tree)
{
  const Tree_bundle& bundle = tree[boost::graph_bundle];
  const std::vector<std::size_t> order =
      internal::writing_order(tree, bundle.root, "write_cylinders");
  std::vector<std::size_t> row(num_vertices(tree), 0); // row of the cylinder that ends at a node
  internal::Output_file file(path);
  file.write("sx,sy,sz,ax,ay,az,length,radius,parent,branch,order,"
             "radius_error,is_measured\n");
  std::size_t count = 0;
  std::string line;
  for (const std::size_t v : order) {
    const std::size_t p = parent_node<Kernel>(v, tree);
    if (p == npos)
      continue;
    const auto& a = tree[p].point;
    const auto& b = tree[v].point;
    const double d[3] = {CGAL::to_double(b.x()) - CGAL::to_double(a.x()),
                         CGAL::to_double(b.y()) - CGAL::to_double(a.y()),
                         CGAL::to_double(b.z()) - CGAL::to_double(a.z())};
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    row[v] = row[p];
    if (length == 0 || tree[v].branch != tree[p].branch)
      continue;
    line.clear();
    const double radius = 0.5 * (CGAL::to_double(tree[p].radius) + CGAL::to_double(tree[v].radius));
    for (const double value : {CGAL::to_double(a.x()),
                               CGAL::to_double(a.y()),
                               CGAL::to_double(a.z()),
                               d[0] / length,
                               d[1] / length,
                               d[2] / length,
                               length,
                               radius}) {
      internal::append_number(line, internal::finite_value(value, "a value", v, "write_cylinders"));
      line += ',';
    }
    internal::append_number(line, row[p]);
    line += ',';
    internal::append_number(line, tree[v].branch + 1);
    line += ',';
    const std::size_t branch = tree[v].branch;
    internal::append_number(line,
                            branch < bundle.branches.size() ? bundle.branches[branch].order : 0);
    line += ',';
    internal::append_number(line,
                            internal::finite_value(CGAL::to_double(tree[v].radius_error),
                                                   "the error of a radius",
                                                   v,
                                                   "write_cylinders"));
    line += tree[v].is_measured ? ",1\n" : ",0\n";
    file.write(line);
    row[v] = ++count;
  }
  file.commit();
}

/*!
  \ingroup PkgPcsIORef
  \brief writes the nodes of a tree skeleton as vertices with `radius`, `branch` and `order`, and
      its edges as edges of a PLY file.

  \throws pcs::IO_error when the file cannot be written
  \throws pcs::Invalid_input when the graph is not a tree below its root, or a number is not finite
*/
template <class Kernel>
void write_ply_edges(const std::string& path, const Tree_skeleton<Kernel>& tree)
{
  const Tree_bundle& bundle = tree[boost::graph_bundle];
  const std::vector<std::size_t> order =
      internal::writing_order(tree, bundle.root, "write_ply_edges");
  internal::Output_file file(path);
  file.write("ply\nformat binary_little_endian 1.0\nelement vertex " +
             std::to_string(order.size()) +
             "\nproperty double x\nproperty double y\nproperty double z\nproperty double radius\n"
             "property int branch\nproperty int order\nelement edge " +
             std::to_string(order.empty() ? 0 : order.size() - 1) +
             "\nproperty int vertex1\nproperty int vertex2\nend_header\n");
  std::vector<std::int32_t> number(num_vertices(tree), -1);
  std::int32_t count = 0;
  for (const std::size_t v : order) {
    const auto& node = tree[v];
    number[v] = count++;
    double values[4] = {CGAL::to_double(node.point.x()),
                        CGAL::to_double(node.point.y()),
                        CGAL::to_double(node.point.z()),
                        CGAL::to_double(node.radius)};
    for (const double value : values)
      internal::finite_value(value, "a value", v, "write_ply_edges");
    file.write(values, sizeof(values));
    const std::int32_t labels[2] = {
        static_cast<std::int32_t>(node.branch),
        node.branch < bundle.branches.size() ? bundle.branches[node.branch].order : 0};
    file.write(labels, sizeof(labels));
  }
  for (const std::size_t v : order) {
    const std::size_t p = parent_node<Kernel>(v, tree);
    if (p == npos)
      continue;
    const std::int32_t ends[2] = {number[p], number[v]};
    file.write(ends, sizeof(ends));
  }
  file.commit();
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_CYLINDERS_H

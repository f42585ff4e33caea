// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a tree skeleton as tables of cylinders, branches and sizes, or as a PLY file of its edges.

#ifndef PCS_IO_WRITE_TREE_TABLES_H
#define PCS_IO_WRITE_TREE_TABLES_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/cylinders/Branch_sizes.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Skeleton_report.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/constants.h>

#include <CGAL/number_utils.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

namespace internal {

constexpr double litres_per_cubic_metre = 1000;
constexpr double degrees_per_radian = 180 / pcs::internal::pi;

template <class Vector_3>
std::array<double, 3> to_array(const Vector_3& v)
{
  return {CGAL::to_double(v.x()), CGAL::to_double(v.y()), CGAL::to_double(v.z())};
}

//! appends numbers, separated by commas, and ends the line
inline void append_row(std::string& text, const std::vector<double>& values)
{
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0)
      text += ',';
    if (std::isnan(values[i]))
      text += "NA";
    else
      append_number(text, values[i]);
  }
  text += '\n';
}

//! returns the diameter of a branch at a path length from its base, NaN if it is shorter
template <class Kernel>
double diameter_at(const Branch_measurer<Kernel>& tree,
                   const std::vector<std::size_t>& nodes,
                   double position)
{
  double from = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const double length = tree.length(tree.between(nodes[i - 1], nodes[i]));
    if (length > 0 && from + length >= position) {
      const double a = tree.radius(nodes[i - 1]), b = tree.radius(nodes[i]);
      return 2 * (a + (position - from) / length * (b - a));
    }
    from += length;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief writes one cylinder per edge inside a branch, with the cylinder columns of TreeQSM.

  Columns: `sx, sy, sz` (start), `ax, ay, az` (axis), `length, radius, parent, branch, order,
  radius_error, is_measured`. Positions, lengths and radii are in the unit of the tree [L]. The axis
  is a unit vector. `parent` is a row number from 1, or 0 if there is none. `branch` counts from 1.
  Edges of length zero have no cylinder. The file is written completely or not at all.

  \param path name of the file
  \param tree a tree with branches
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
  \brief writes one row per branch, with the branch columns of TreeQSM.

  Columns, for a tree in metres: `order, parent, volume` [litres], `area` [m^2], `length` [m],
  `angle` [degrees], `height` [m], `azimuth` [degrees], `zenith` [degrees], `diameter` [m]. Row
  number `b` from 1 is the branch `b` in the table of `write_cylinders()`; `parent` is a row number,
  or 0 for the trunk. `height` is that of the base above the root. `angle` is the angle between the
  first piece of the branch and the piece of its parent at the base. `azimuth` is the angle of the
  first piece from the x axis, counter-clockwise (from the y axis if up is along x). `diameter` is
  that of the first piece. `area` is that of the cylinders. `volume` is that of the frusta between
  the nodes, as in `Skeleton_report::total`; it is slightly larger than that of the cylinders. In
  another unit than the metre, `volume` is 1000 times the volume, and other values are in that unit.
  The file is written completely or not at all.

  \param path name of the file
  \param tree a tree with branches
  \param up the up direction, which is not null
  \throws pcs::IO_error when the file cannot be written
  \throws pcs::Invalid_input when the graph is not a tree below its root, or a number is not finite
*/
template <class Kernel>
void write_branches(const std::string& path,
                    const Tree_skeleton<Kernel>& tree,
                    const typename Kernel::Vector_3& up = typename Kernel::Vector_3(0, 0, 1))
{
  const internal::Branch_measurer<Kernel> measurer(tree, internal::to_array(up), "write_branches");
  internal::Output_file file(path);
  file.write("order,parent,volume,area,length,angle,height,azimuth,zenith,diameter\n");
  std::string line;
  for (const internal::Branch_size& b : measurer()) {
    line.clear();
    internal::append_row(line,
                         {double(b.order),
                          b.parent == npos ? 0 : double(b.parent + 1),
                          internal::litres_per_cubic_metre * b.volume,
                          b.area,
                          b.length,
                          internal::degrees_per_radian * b.angle,
                          b.height,
                          internal::degrees_per_radian * b.azimuth,
                          internal::degrees_per_radian * b.zenith,
                          b.diameter});
    file.write(line);
  }
  file.commit();
}

/*!
  \ingroup PkgPcsIORef
  \brief writes the sizes of a tree as a table of one row, with the names of TreeQSM's `treedata`.

  Columns, for a tree in metres: `TotalVolume, TrunkVolume, BranchVolume` [litres], `TreeHeight,
  TrunkLength, BranchLength, TotalLength` [m], `NumberBranches` without the trunk, `MaxBranchOrder`,
  `TrunkArea, BranchArea, TotalArea` [m^2], `DBHqsm` [m]. Volumes and areas are those of
  `write_branches()`. `TreeHeight` is the height of the highest node above the lowest one, and
  `DBHqsm` the diameter of the trunk at the path length `breast_height` from the root, `NA` if the
  trunk is shorter. Standard errors follow in the units of their values: `TotalVolume_error,
  TrunkVolume_error, TreeHeight_error, TrunkLength_error, TotalLength_error, DBHqsm_error`; `NA` if
  unknown. The file is written completely or not at all.

  \param path name of the file
  \param tree a tree with branches
  \param up the up direction, which is not null
  \param breast_height of `DBHqsm`, `> 0` [L]
  \param errors result of `standard_errors()`; an error of 0 is unknown
  \throws pcs::IO_error when the file cannot be written
  \throws pcs::Invalid_input when the graph is not a tree below its root, or a number is not finite
*/
template <class Kernel>
void write_tree_table(const std::string& path,
                      const Tree_skeleton<Kernel>& tree,
                      const typename Kernel::Vector_3& up = typename Kernel::Vector_3(0, 0, 1),
                      double breast_height = 1.3,
                      const Tree_values& errors = Tree_values())
{
  if (!(breast_height > 0) || !std::isfinite(breast_height))
    throw Invalid_input("pcs::IO::write_tree_table(): breast_height must be finite and positive");
  const internal::Branch_measurer<Kernel> measurer(tree,
                                                   internal::to_array(up),
                                                   "write_tree_table");
  const std::size_t root = tree[boost::graph_bundle].root, trunk = tree[root].branch;
  internal::Branch_size of_trunk, of_branches; // sums
  double number_of_branches = 0, max_order = 0;
  const std::vector<internal::Branch_size> sizes = measurer();
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    internal::Branch_size& sum = b == trunk ? of_trunk : of_branches;
    sum.volume += sizes[b].volume;
    sum.area += sizes[b].area;
    sum.length += sizes[b].length;
    number_of_branches += b != trunk && !sizes[b].is_empty;
    max_order = std::max(max_order, double(sizes[b].order));
  }
  double lowest = measurer.height(root), highest = lowest;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    lowest = std::min(lowest, measurer.height(v));
    highest = std::max(highest, measurer.height(v));
  }
  internal::Output_file file(path);
  std::string text = "TotalVolume,TrunkVolume,BranchVolume,TreeHeight,TrunkLength,BranchLength,"
                     "TotalLength,NumberBranches,MaxBranchOrder,TrunkArea,BranchArea,TotalArea,"
                     "DBHqsm,TotalVolume_error,TrunkVolume_error,TreeHeight_error,"
                     "TrunkLength_error,TotalLength_error,DBHqsm_error\n";
  const auto known = [](double error) {
    return error > 0 ? error : std::numeric_limits<double>::quiet_NaN();
  };
  internal::append_row(text,
                       {internal::litres_per_cubic_metre * (of_trunk.volume + of_branches.volume),
                        internal::litres_per_cubic_metre * of_trunk.volume,
                        internal::litres_per_cubic_metre * of_branches.volume,
                        highest - lowest,
                        of_trunk.length,
                        of_branches.length,
                        of_trunk.length + of_branches.length,
                        number_of_branches,
                        max_order,
                        of_trunk.area,
                        of_branches.area,
                        of_trunk.area + of_branches.area,
                        internal::diameter_at(measurer, measurer.nodes(trunk), breast_height),
                        internal::litres_per_cubic_metre * known(errors.volume),
                        internal::litres_per_cubic_metre * known(errors.trunk_volume),
                        known(errors.height),
                        known(errors.trunk_length),
                        known(errors.length),
                        known(errors.diameter_at_breast_height)});
  file.write(text);
  file.commit();
}

/*!
  \ingroup PkgPcsIORef
  \brief writes the nodes of a tree skeleton as vertices with `radius`, `branch` and `order`, and
      its edges as edges of a PLY file.

  The file is written completely or not at all.

  \param path name of the file
  \param tree a tree with branches, positions and radii in its unit [L]
  \throws pcs::IO_error when the file cannot be written
  \throws pcs::Invalid_input when the graph is not a tree below its root, or a number is not finite
  \par Complexity
  Linear in the number of nodes.
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

#endif // PCS_IO_WRITE_TREE_TABLES_H

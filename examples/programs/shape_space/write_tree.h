// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Files of a tree of the space: skeleton, points with their properties, surface.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_WRITE_TREE_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_WRITE_TREE_H

#include "Options.h"
#include "Tree_file.h"
#include "blend_properties.h"
#include <pcs/IO/write_mesh.h>
#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/make_branch_surface.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace orl_program {

namespace np = pcs::parameters;
using Space = pcs::Orl_shape_space<Kernel>;

/// Copies properties common to the points of all trees, mixed from the corresponding points.
inline void copy_properties(const Space& space,
                            const pcs::Orl_tree& tree,
                            const std::vector<Tree_file>& files,
                            Table& out)
{
  for (const std::string& name : files[0].points.property_names()) {
    bool is_common = !is_normal(name);
    for (const Tree_file& file : files)
      is_common = is_common && file.points.has_property(name);
    if (!is_common)
      continue;
    std::vector<std::vector<double>> values;
    pcs::IO::Scalar_type type = files[0].points.property_type(name);
    for (const Tree_file& file : files) {
      values.push_back(file.points.property_as_double(name));
      type = wider_type(type, file.points.property_type(name));
    }
    std::vector<Mixed_value> mixed(out.number_of_points(), Mixed_value(type, name));
    space.for_each_source(tree, [&](std::size_t i, std::size_t h, std::size_t k, double w) {
      mixed[i].add(values[h][k], w);
    });
    std::vector<double> own;
    for (const Mixed_value& value : mixed)
      own.push_back(value.get());
    add_property(name, type, own, out);
  }
}

inline void write_scan(const Space& space,
                       const pcs::Orl_tree& tree,
                       const std::vector<Tree_file>& files,
                       const Method_options& method,
                       const std::string& path)
{
  const std::size_t n = tree.number_of_points();
  std::vector<Table::Point_3> points(n);
  std::vector<Table::Vector_3> normals;
  const bool are_across =
      method.normals == "across" || (method.normals == "scans-or-across" && !space.has_normals());
  const auto form = np::point_path(point_path(method));
  if (space.has_normals() || are_across) {
    normals.resize(n);
    std::vector<std::size_t> index(n);
    for (std::size_t i = 0; i < n; ++i)
      index[i] = i;
    space.points(tree,
                 index,
                 form.point_map(CGAL::make_property_map(points))
                     .normal_map(CGAL::make_property_map(normals))
                     .point_normals(are_across ? pcs::Point_normals::across_branches
                                               : pcs::Point_normals::of_scans));
  } else
    space.points(tree, points, form);
  Table out(std::move(points));
  if (!normals.empty())
    out.set_normals(normals);
  if (files.size() == 2)
    blend_properties(space, tree, files[0].points, files[1].points, out);
  else if (!files.empty())
    copy_properties(space, tree, files, out);
  pcs::IO::write_points(path, out);
}

/// Writes NAME.swc, NAME.ply if there are points, and NAME_surface.ply if requested, to the folder
/// of the results.
inline void write_tree(const Space& space,
                       const pcs::Orl_tree& tree,
                       const std::vector<Tree_file>& files,
                       const Options& o,
                       const std::string& name)
{
  const std::string stem = (std::filesystem::path(o.output) / name).string();
  Skeleton skeleton;
  space.skeleton(tree, skeleton, np::do_keep_absent_branches(o.do_keep_absent_branches));
  pcs::IO::write_swc(stem + ".swc", skeleton);
  if (space.has_points())
    write_scan(space, tree, files, o.method, stem + ".ply");
  if (o.do_mesh) {
    std::vector<Kernel::Point_3> points;
    std::vector<std::array<std::size_t, 3>> triangles;
    pcs::make_branch_surface(skeleton, points, triangles);
    pcs::IO::write_mesh(stem + "_surface.ply", points, triangles);
  }
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_WRITE_TREE_H

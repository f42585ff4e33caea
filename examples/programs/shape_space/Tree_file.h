// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree of the command line: its skeleton, its points, and the names of its nodes.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_TREE_FILE_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_TREE_FILE_H

#include "common/read_skeleton.h"
#include "common/up_direction.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/shape_space/input/extend_axes.h>

#if __has_include(<pcs/extract_tree_skeleton.h>)
#include <pcs/extract_tree_skeleton.h>
#define PCS_CAN_EXTRACT_SKELETONS 1
#else
#define PCS_CAN_EXTRACT_SKELETONS 0
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace orl_program {

using Kernel = pcs::IO::Point_table::Kernel;
using Skeleton = pcs::Tree_skeleton<Kernel>;

struct Tree_file
{
  Skeleton skeleton;
  pcs::IO::Point_table points;
  std::vector<std::int64_t> ids;           ///< ids of the nodes in the file
  std::size_t number_of_trees_in_file = 1; ///< of skeletons
  bool has_valid_normals = false;
  std::size_t number_of_bad_normals = 0; ///< zero or not finite
};

/// Which tree of a skeleton file is read.
struct Root_number
{
  std::size_t value = 1;  ///< 1: the largest tree
  bool is_common = false; ///< applies to all skeleton files; files with one tree ignore it
};

/// Reads one tree of a skeleton file. Returns a warning if trees were left out.
inline std::string read_skeleton(const std::string& path, Root_number root, Tree_file& tree)
{
  const auto read = [&](std::size_t number) {
    return program::read_skeleton<Kernel>(path, tree.skeleton, tree.ids, number);
  };
  pcs::IO::Tree_selection selection = read(root.is_common ? 1 : root.value);
  if (root.is_common && root.value != 1 && selection.number_of_trees > 1)
    selection = read(root.value);
  tree.number_of_trees_in_file = selection.number_of_trees;
  const std::string warning = program::warning_of_selection(selection, "--root-number");
  return warning.empty() ? warning : path + ": " + warning;
}

inline void extract_skeleton(const std::string& points, const std::string& up, Tree_file& tree)
{
#if PCS_CAN_EXTRACT_SKELETONS
  const auto report = [&] {
    try {
      return pcs::extract_tree_skeleton(
          tree.points.points(),
          tree.skeleton,
          pcs::parameters::up_direction(program::up_direction<Kernel>(up)));
    } catch (const pcs::Invalid_input& error) {
      throw pcs::Invalid_input(points + ": " + error.what() + "; give a skeleton with --skeleton");
    }
  }();
  if (report.status != pcs::Status::converged || num_vertices(tree.skeleton) < 2)
    throw pcs::Invalid_input(points + ": no skeleton can be extracted (" +
                             pcs::to_string(report.status) + "); give one with --skeleton");
#else
  static_cast<void>(tree);
  static_cast<void>(up);
  throw pcs::Invalid_input(points + ": a skeleton is needed; give one with --skeleton");
#endif
}

/// Rejects points in other coordinates than the skeleton: most of them are far from it.
inline void
check_place(const std::string& points, const std::string& skeleton, const Tree_file& tree)
{
  CGAL::Bbox_3 box;
  for (std::size_t v = 0; v < num_vertices(tree.skeleton); ++v)
    box += tree.skeleton[v].point.bbox();
  const double far =
      std::sqrt(CGAL::squared_distance(Kernel::Point_3(box.xmin(), box.ymin(), box.zmin()),
                                       Kernel::Point_3(box.xmax(), box.ymax(), box.zmax())));
  const auto& all = tree.points.points();
  const auto number_of_far = std::count_if(all.begin(), all.end(), [&](const auto& p) {
    for (int i = 0; i < 3; ++i)
      if (p[i] < box.min(i) - far || p[i] > box.max(i) + far)
        return true;
    return false;
  });
  if (2 * static_cast<std::size_t>(number_of_far) > all.size())
    throw pcs::Invalid_input(points + ": " + std::to_string(number_of_far) + " of " +
                             std::to_string(all.size()) + " points are farther from " + skeleton +
                             " than it is large; both must be in the same coordinates and unit");
}

/// Reads a tree from its files. Either path may be empty, but not both. Of a skeleton file with
/// several trees, the tree `root` is read, and `warning` counts the others.
inline Tree_file read_tree(const std::string& points,
                           const std::string& skeleton,
                           Root_number root,
                           std::string& warning)
{
  Tree_file tree;
  if (!points.empty())
    tree.points = pcs::IO::read_points(points);
  if (!skeleton.empty()) {
    warning = read_skeleton(skeleton, root, tree);
    check_place(points, skeleton, tree);
  }
  if (tree.points.has_normals()) {
    for (const auto& n : tree.points.normals()) {
      const double squared_length = n.squared_length();
      tree.number_of_bad_normals += !(squared_length > 0 && std::isfinite(squared_length));
    }
    tree.has_valid_normals = tree.number_of_bad_normals == 0;
  }
  return tree;
}

/// Computes the skeleton and the ids of nodes if they are missing. `up`: the growth axis of the
/// trees.
inline void complete_tree(Tree_file& tree,
                          const std::string& points,
                          bool do_extend_axes,
                          const std::string& up)
{
  if (num_vertices(tree.skeleton) == 0)
    extract_skeleton(points, up, tree);
  else if (do_extend_axes)
    pcs::shape_space::extend_axes(tree.skeleton, tree.points.points());
  for (std::size_t v = tree.ids.size(); v < num_vertices(tree.skeleton); ++v) // no ids in the file
    tree.ids.push_back(static_cast<std::int64_t>(v) + 1);
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_TREE_FILE_H

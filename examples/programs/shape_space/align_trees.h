// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees that were put down anew between two scans, turned back about the vertical.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_ALIGN_TREES_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_ALIGN_TREES_H

#include "Tree_file.h"
#include "common/up_direction.h"
#include <pcs/Orl_shape_space.h>

#include <CGAL/Aff_transformation_3.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace orl_program {

/// Rotates a tree by `angle` about the vertical axis through the root. [rad]
inline void turn_tree(Tree_file& tree, const std::string& up, double angle)
{
  const double c = std::cos(angle), s = up.front() == '-' ? -std::sin(angle) : std::sin(angle);
  using Turn = CGAL::Aff_transformation_3<Kernel>;
  const Turn turn = up.back() == 'x'   ? Turn(1, 0, 0, 0, c, -s, 0, s, c)
                    : up.back() == 'y' ? Turn(c, 0, s, 0, 1, 0, -s, 0, c)
                                       : Turn(c, -s, 0, s, c, 0, 0, 0, 1);
  const Kernel::Point_3 root = tree.skeleton[tree.skeleton[boost::graph_bundle].root].point;
  const auto turned = [&](const Kernel::Point_3& p) { return root + turn.transform(p - root); };
  for (std::size_t v = 0; v < num_vertices(tree.skeleton); ++v)
    tree.skeleton[v].point = turned(tree.skeleton[v].point);
  for (Kernel::Point_3& p : tree.points.points())
    p = turned(p);
  if (!tree.points.has_normals())
    return;
  std::vector<Kernel::Vector_3> normals = tree.points.normals();
  for (Kernel::Vector_3& n : normals)
    n = turn.transform(n);
  tree.points.set_normals(normals);
}

/// Rotates each tree to align it with the previous one. Returns the angles. [rad]
inline std::vector<double> align_trees(std::vector<Tree_file>& trees,
                                       const std::string& up,
                                       const pcs::Matching_weights& weights)
{
  std::vector<double> turns(trees.size(), 0);
  for (std::size_t i = 1; i < trees.size(); ++i) {
    pcs::Orl_shape_space<Kernel> space;
    space.add_skeleton(trees[i - 1].skeleton);
    space.add_skeleton(trees[i].skeleton);
    turns[i] = space
                   .build(pcs::parameters::matching_weights(weights)
                              .alignment(pcs::Orl_alignment::rotate_about_up)
                              .up_direction(program::up_direction<Kernel>(up)))
                   .yaw;
    if (turns[i] != 0)
      turn_tree(trees[i], up, turns[i]);
  }
  return turns;
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_ALIGN_TREES_H

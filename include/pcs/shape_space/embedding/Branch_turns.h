// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotations of branches from one tree to another, and the frames that these rotations define.

#ifndef PCS_SHAPE_SPACE_EMBEDDING_BRANCH_TURNS_H
#define PCS_SHAPE_SPACE_EMBEDDING_BRANCH_TURNS_H

#include <pcs/core/rotations.h>
#include <pcs/shape_space/embedding/Embedding.h>
#include <pcs/shape_space/matching/align_vectors.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {
namespace internal {

/// A pair of corresponding directions, and its weight. [L]
struct Direction_pair
{
  Vec3 one, two;
  double weight;
};

/*!
  Returns the rotation with the least sum of weighted angles to pairs of directions and to `known`,
  which has `fraction` times the weight of all pairs.

  The rotation is found by iteratively reweighted means. The weights are inverse angles, where the
  lower limit of the angles decreases. If a majority of the pairs agrees, it is met exactly, however
  much the others differ. Degrees of freedom that the pairs do not determine are as in `known`.
*/
inline Quaternion rotation_of_directions(const std::vector<Direction_pair>& pairs,
                                         const Quaternion& known,
                                         double fraction)
{
  constexpr int most_passes = 80;
  // lower limits of angles [rad], and their ratio between iterations [-]
  constexpr double first_angle = 0.3, last_angle = 1e-8, ratio = 0.5;
  constexpr double least_step = 1e-12; // [rad]
  double total = 0;
  for (const Direction_pair& p : pairs)
    total += p.weight;
  Quaternion q = known;
  double least = first_angle;
  for (int pass = 0; pass < most_passes; ++pass, least = std::max(last_angle, ratio * least)) {
    const Eigen::Matrix3d rotation = q.toRotationMatrix();
    Eigen::Matrix3d covariance =
        fraction * total / std::max(least, angle_between(q, known)) * known.toRotationMatrix();
    for (const Direction_pair& p : pairs) {
      const Vec3 turned = rotation * p.one;
      const double angle = std::atan2(turned.cross(p.two).norm(), turned.dot(p.two));
      covariance += p.weight / std::max(least, angle) * p.two * p.one.transpose();
    }
    const Quaternion next = align_vectors(covariance, q);
    const double step = angle_between(next, q);
    q = next;
    if (step < least_step && least == last_angle)
      break;
  }
  return q;
}

/*!
  Returns the rotation of each common branch from tree 1 to tree 2. It is estimated from the edges
  of the branch, its child branches, each as a whole, and the rotation of its parent. `root` is the
  rotation of the whole tree. A branch of only one tree rotates with its parent.
*/
inline std::vector<Quaternion> rotations_of_branches(const Orl_layout& layout,
                                                     const Embedding& one,
                                                     const Embedding& two,
                                                     const Quaternion& root)
{
  constexpr double fraction_of_parent = 0.05;
  const std::size_t m = layout.branches.size();
  std::vector<Direction_pair> whole(m); // each branch from end to end, weighted by its subtree
  std::vector<char> is_common(m, 0);
  for (std::size_t b = 0; b < m; ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    Vec3 a = Vec3::Zero(), z = Vec3::Zero();
    double length_1 = 0, length_2 = 0;
    for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
      a += one.x.length[e] * one.direction[e];
      z += two.x.length[e] * two.direction[e];
      length_1 += one.x.length[e];
      length_2 += two.x.length[e];
    }
    is_common[b] = length_1 > 0 && length_2 > 0;
    whole[b] = {a.stableNormalized(), z.stableNormalized(), std::sqrt(length_1 * length_2)};
  }
  for (std::size_t b = m; b-- > 1;)
    whole[layout.branches[b].parent].weight += whole[b].weight;
  std::vector<std::vector<Direction_pair>> pairs(m);
  for (std::size_t b = 0; b < m; ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    if (!is_common[b])
      continue;
    for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e)
      if (one.x.length[e] > 0 && two.x.length[e] > 0)
        pairs[b].push_back(
            {one.direction[e], two.direction[e], 0.5 * (one.x.length[e] + two.x.length[e])});
    if (branch.parent != none)
      pairs[branch.parent].push_back(whole[b]);
  }
  std::vector<Quaternion> result(m, root);
  for (std::size_t b = 0; b < m; ++b) {
    const std::size_t p = layout.branches[b].parent;
    const Quaternion known = p == none ? root : result[p];
    result[b] = is_common[b] ? rotation_of_directions(pairs[b], known, fraction_of_parent) : known;
  }
  return result;
}

/*!
  Chooses the frames of tree 2, whose twist about the edges is free. The frame of an edge in tree 1
  is rotated with the branch, and then by the shortest rotation to the direction of the edge in tree
  2. So the rotation of a whole branch counts once. Rotations of single edges, which are mainly
  noise of short edges, do not twist the edges behind them. For an edge that tree 1 lacks, the
  previous frame of tree 2 is rotated instead.
*/
inline void
turn_frames(const Orl_layout& layout, const Embedding& one, const Quaternion& root, Embedding& two)
{
  const std::vector<Quaternion> rotation = rotations_of_branches(layout, one, two, root);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
      if (!(two.x.length[e] > 0))
        continue;
      const std::size_t p = layout.edge_before[e];
      const Quaternion from = one.x.length[e] > 0 ? rotation[b] * one.frame[e]
                              : p == none         ? root
                                                  : two.frame[p];
      two.frame[e] = shortest_turn(from * Vec3::UnitZ(), two.direction[e]) * from;
      two.frame[e].normalize();
    }
  }
}

} // namespace internal
} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_EMBEDDING_BRANCH_TURNS_H

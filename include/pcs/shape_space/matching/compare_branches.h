// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Two branches on two paths: their curves, their rotation and their children.

#ifndef PCS_SHAPE_SPACE_MATCHING_COMPARE_BRANCHES_H
#define PCS_SHAPE_SPACE_MATCHING_COMPARE_BRANCHES_H

#include <pcs/shape_space/matching/Matching_energy.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <utility>

namespace pcs {
namespace shape_space {

/// Two branches on two paths, and their children.
struct Compared_branches
{
  Matching_energy::Trial trial;
  std::array<Matching_energy::Children, 2> children;
  Eigen::Matrix3d rotation; ///< aligns branch 2 with branch 1, in the axes of the energy
};

/// Matches the curves of two paths, where the rotation of the parents is `inherited`.
inline Matching_energy::Trial first_trial(const Matching_energy& energy,
                                          std::size_t p1,
                                          std::size_t p2,
                                          const Eigen::Matrix3d& inherited)
{
  // if one has no children, no attachment depends on the correspondence of the curves
  const bool is_leaf = energy.path(0, p1).children.empty() || energy.path(1, p2).children.empty();
  return energy.match_curves(p1,
                             p2,
                             inherited,
                             is_leaf ? Matching_energy::few_samples
                                     : Matching_energy::number_of_samples);
}

/// Finds the rotation and the children of two branches whose curves were matched with the rotation
/// `inherited` of the parents. If their own rotation differs much from it, the curves are matched
/// again.
inline Compared_branches compare_branches(const Matching_energy& energy,
                                          Matching_energy::Trial trial,
                                          const Eigen::Matrix3d& inherited)
{
  constexpr int number_of_passes = 3;       // of rotation from curve and children
  constexpr double rematch_threshold = 0.4; // Frobenius norm: a rotation by about 0.3 rad
  Compared_branches result{std::move(trial), {}, inherited};
  Matching_energy::Trial& best = result.trial;
  Matching_energy::Children &a = result.children[0], &b = result.children[1];
  const auto find_rotation = [&] {
    result.rotation =
        energy.turn(best, a, b, inherited, number_of_passes, energy.weights().children);
  };
  const auto find_second = [&] {
    b = energy.children_of(1, energy.path(1, best.path_2), best.last[1], &best.gamma);
  };
  a = energy.children_of(0, energy.path(0, best.path_1), best.last[0], nullptr);
  find_second();
  find_rotation();
  if (energy.is_turned() && (result.rotation - inherited).norm() > rematch_threshold) {
    // the new rotation improves the correspondence of the curves
    best = energy.match_curves(best.path_1, best.path_2, result.rotation, best.gamma.size());
    find_second();
    find_rotation();
  }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_COMPARE_BRANCHES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Families of similar random trees, and their spaces.

#ifndef PCS_TEST_SUPPORT_ORL_FAMILIES_H
#define PCS_TEST_SUPPORT_ORL_FAMILIES_H

#include <pcs/Orl_shape_space.h>
#include <support/drawn.h>
#include <support/orl_spaces.h>
#include <support/orl_trees.h>

#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace orl_test {

/// Similar trees: the branches of one tree are rotated and stretched, and some are cut. Trunks
/// differ in direction and height, too.
inline std::vector<Tree>
relatives(std::size_t n, unsigned seed, double sigma = 0.15, double cut = 0.15, int orders = 3)
{
  std::vector<Tree> result;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const std::vector<Branch> all = random_branches(seed, 5, orders);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<Branch> branches = all;
    Turns turns(all.size(), Eigen::Matrix3d::Identity());
    std::vector<char> is_kept(all.size(), 1);
    for (std::size_t b = 0; b < all.size(); ++b) {
      const Vec3 u =
          (b == 0 ? 0.3 : 1) * sigma * pcs_test::drawn<Vec3>([&] { return normal(random); });
      turns[b] = Eigen::AngleAxisd(u.norm(), u.normalized()).toRotationMatrix();
      const double stretch = std::exp(0.1 * normal(random));
      for (Vec3& p : branches[b].points)
        p *= stretch;
      is_kept[b] = b == 0 || uniform(random) >= cut;
    }
    std::vector<std::size_t> tip;
    result.push_back(make_tree(branches, turns, is_kept, tip));
  }
  return result;
}

/// The space of these trees, without points.
inline Space make_space(const std::vector<Tree>& trees)
{
  Space space;
  for (const Tree& tree : trees)
    space.add_skeleton(tree);
  space.build();
  return space;
}

/// `n` points around every node of a tree.
inline std::vector<Point> rings(const Tree& tree, int n = 8)
{
  std::vector<Point> points;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    for (int k = 0; k < n; ++k)
      points.push_back(tree[v].point +
                       tree[v].radius * Kernel::Vector_3(std::cos(2 * CGAL_PI * k / n),
                                                         std::sin(2 * CGAL_PI * k / n),
                                                         0.1));
  return points;
}

/// Sum of the lengths of all edges. [L]
inline double total_length(const pcs::shape_space::Orl_coordinates& x)
{
  double sum = 0;
  for (const double l : x.length)
    sum += l;
  return sum;
}

/// A space of `n` relatives.
struct Family : Space
{
  explicit Family(std::size_t n = 6, unsigned seed = 3) : Space(make_space(relatives(n, seed))) {}
};

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_ORL_FAMILIES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A family of trees on one topology: input of means, modes and samples.

#ifndef PCS_SHAPE_SPACE_MODEL_TREE_FAMILY_H
#define PCS_SHAPE_SPACE_MODEL_TREE_FAMILY_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/model/Matched_branch.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <array>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

struct Tree_family
{
  Orl_orientation orientation = Orl_orientation::gauge_fixed;
  Orl_layout layout;
  std::vector<Orl_coordinates> x;            ///< of each tree
  std::vector<std::vector<char>> has;        ///< per tree and branch
  std::vector<std::vector<std::size_t>> tip; ///< vertex at the tip, per tree and branch, or `none`
  std::vector<double> confidence; ///< of the matches of two trees, per branch; NaN: not known [-]
  Orl_weights weights;
  Orl_coordinates reference;  ///< reference tree: medians over the trees with each branch
  Vec3 origin = Vec3::Zero(); ///< of the coordinates, in those of the caller [L]
  Vec3 up = Vec3::UnitZ();    ///< direction of growth, mean over the trees
  Matching_weights matching;
  std::vector<std::size_t> first_point; ///< of each edge, and the number of all

  /// Finds the index in the output of the first point of each edge that exists in `tree`; the last
  /// element is the number of points.
  void find_offsets(const Orl_coordinates& tree, std::vector<std::size_t>& offset) const
  {
    offset.resize(layout.number_of_edges() + 1);
    std::size_t sum = 0;
    for (std::size_t e = 0; e < layout.number_of_edges(); ++e) {
      offset[e] = sum;
      sum += tree.length[e] > 0 ? first_point[e + 1] - first_point[e] : 0;
    }
    offset.back() = sum;
  }
};

namespace internal {

inline std::array<double, 3> to_array(const Vec3& v)
{
  return {v.x(), v.y(), v.z()};
}
inline Vec3 to_vector(const std::array<double, 3>& a)
{
  return {a[0], a[1], a[2]};
}

} // namespace internal

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_TREE_FAMILY_H

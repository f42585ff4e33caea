// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Which branches, nodes and points of two trees correspond: what is worth keeping in a file.

#ifndef PCS_CORE_ORL_CORRESPONDENCES_H
#define PCS_CORE_ORL_CORRESPONDENCES_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief The correspondences of an `Orl_shape_space`; they only make sense with the trees they were
      computed for.
*/
struct Orl_correspondences
{
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  static constexpr std::uint32_t no_point = std::numeric_limits<std::uint32_t>::max();

  //! a branch of the common topology; `none` in `first` and `tip` of a tree that does not have it
  struct Branch
  {
    std::size_t parent = none;
    std::array<std::size_t, 2> first = {none, none},
                               tip = {none, none}; ///< nodes, as numbered inside
    std::array<std::vector<double>, 2> nodes;      ///< shares of the length of the branch [-]
    std::array<double, 2> attachment = {0,
                                        0}; ///< number of a node of the parent, and share behind it
    std::array<bool, 2> is_continued = {false, false}; ///< where the parent was cut: as thick as it
  };
  //! a point of either tree on an edge of the common topology; `no_point` where there is none
  struct Pair
  {
    std::uint32_t edge;
    std::array<std::uint32_t, 2> point;
  };

  std::string note; ///< words of the caller's, kept with them; single spaces between
  std::array<std::uint64_t, 2> fingerprint = {0, 0};           ///< of the nodes of the trees
  std::array<std::uint64_t, 2> fingerprint_of_points = {0, 0}; ///< of their scans; 0: no points
  std::array<double, 4> rotation =
      {1, 0, 0, 0}; ///< quaternion w, x, y, z of the rotation that aligns tree 2 with tree 1
  std::vector<Branch> branches; ///< parents first
  std::vector<Pair>
      pairs; ///< by edge; of the partners of a point of tree 1, the main one comes first
};

} // namespace pcs

#endif // PCS_CORE_ORL_CORRESPONDENCES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Correspondences of branches, nodes and points of two trees, for storage in a file.

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
  \brief The correspondences of an `Orl_shape_space`; they are only valid for the trees for which
      they were computed.
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
                               tip = {none, none}; ///< nodes, in the internal numbering
    std::array<std::vector<double>, 2> nodes;      ///< arc lengths, as fractions of the branch [-]
    std::array<double, 2> attachment = {0,
                                        0}; ///< node of the parent plus fraction of the edge behind
    std::array<bool, 2> is_continued = {false, false}; ///< whether it continues its cut parent
    //! see `Branch_match::confidence`; NaN: not known [-]
    double confidence = std::numeric_limits<double>::quiet_NaN();
  };
  //! a point of either tree on an edge of the common topology; `no_point` where there is none
  struct Pair
  {
    std::uint32_t edge;
    std::array<std::uint32_t, 2> point;
  };

  std::string note; ///< text of the caller; words are separated by single spaces
  std::array<std::uint64_t, 2> fingerprint = {0, 0};           ///< of the nodes of the trees
  std::array<std::uint64_t, 2> fingerprint_of_points = {0, 0}; ///< of their scans; 0: no points
  std::array<double, 4> rotation =
      {1, 0, 0, 0}; ///< quaternion w, x, y, z of the rotation that aligns tree 2 with tree 1
  std::vector<Branch> branches; ///< parents first
  std::vector<Pair>
      pairs; ///< sorted by edge; the main partner of a point of tree 1 precedes its other partners
};

} // namespace pcs

#endif // PCS_CORE_ORL_CORRESPONDENCES_H

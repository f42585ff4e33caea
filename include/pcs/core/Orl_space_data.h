// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A shape space of trees as plain data, for storage in a file.

#ifndef PCS_CORE_ORL_SPACE_DATA_H
#define PCS_CORE_ORL_SPACE_DATA_H

#include <pcs/core/Orl_correspondences.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief The data of a built `Orl_shape_space`, from which `Orl_shape_space::restore()` reconstructs
      the space without the inputs.
*/
struct Orl_space_data
{
  static constexpr std::size_t none = Orl_correspondences::none;

  //! a branch of the topology, parents first
  struct Branch
  {
    std::size_t parent = none, number_of_edges = 1, reference_edge = none;
    //! of the match, see `Branch_match::confidence`; NaN: not known, or more than two trees [-]
    double confidence = std::numeric_limits<double>::quiet_NaN();
  };
  //! coordinates of a tree, per edge and per branch
  struct Tree
  {
    std::array<double, 3> root = {0, 0, 0};
    std::vector<std::array<double, 4>> orientation; ///< x, y, z, w
    std::vector<double> length, radius, base_radius, attachment;
    std::vector<std::size_t> tip; ///< vertex at the tip of each branch, or `none`
    std::vector<char> has;        ///< whether the tree has each branch
    std::vector<std::array<double, 3>> point, normal; ///< of the scan, for spaces of two trees
  };
  //! a point of the family, for spaces of more than two trees
  struct Point
  {
    std::uint32_t tree = 0, index = 0, edge = 0;
    std::array<double, 3> position = {0, 0, 0}, normal = {0, 0, 0};
  };
  //! the point of another scan that corresponds to a point of the family
  struct Partner
  {
    std::uint32_t point = 0, tree = 0, index = 0; ///< index in `points`; tree, index in its scan
    std::array<double, 3> position = {0, 0, 0}, normal = {0, 0, 0};
  };
  //! weights of the metric
  struct Weights
  {
    std::vector<double> orientation, length, radius, base_radius, attachment;
    double root = 1;
  };

  int orientation = 0; ///< as in `Orl_orientation`
  std::array<double, 3> origin = {0, 0, 0};
  std::vector<Branch> branches;
  //! edges after folds, each with the earlier edge of its branch from which its frame is
  //! transported, instead of from the previous edge
  std::vector<std::array<std::size_t, 2>> references;
  std::vector<Tree> trees;
  Tree reference;
  Weights weights;
  std::array<double, 15> matching = {}; ///< `Matching_weights`
  std::vector<Orl_correspondences::Pair> pairs;
  bool has_normals = false;
  std::vector<Point> points;
  std::vector<Partner> partners; ///< by point, then by tree
};

} // namespace pcs

#endif // PCS_CORE_ORL_SPACE_DATA_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree of a shape space, and pairs of corresponding branches.

#ifndef PCS_SHAPE_SPACE_ORL_TREE_H
#define PCS_SHAPE_SPACE_ORL_TREE_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/path/Tree_state.h>

#include <array>
#include <cstddef>
#include <utility>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief A tree of an `Orl_shape_space`: orientations, radii and lengths of the edges of its
      topology. It has value semantics.

  Functions that write to a tree reuse its memory.
*/
class Orl_tree
{
public:
  Orl_tree() = default;
  //! for functions of the shape space
  explicit Orl_tree(shape_space::Tree_state state) : m_state(std::move(state)) {}

  //! parameter of the geodesic between two trees: 0 and 1 are its ends [-]
  double lambda() const { return m_state.lambda; }
  //! number of points that `Orl_shape_space::points()` writes [count]
  std::size_t number_of_points() const
  {
    return m_state.first_point.empty() ? 0 : m_state.first_point.back();
  }
  //! orientations, radii, lengths and attachments
  const shape_space::Orl_coordinates& coordinates() const { return m_state.x; }

  //! for functions of the shape space
  const shape_space::Tree_state& state() const { return m_state; }
  //! for functions of the shape space
  shape_space::Tree_state& state() { return m_state; }

private:
  shape_space::Tree_state m_state;
};

//! \ingroup PkgPcsShapeSpaceRef
//! two corresponding branches, identified by the vertices at their tips
struct Branch_match
{
  std::size_t parent = npos; ///< index of the match of the parents, `npos` for the trunks
  /// Index of the vertex at the tip in each tree; `npos`: the tree lacks the branch.
  std::array<std::size_t, 2> tip = {npos, npos};
  //! How certain the match is, in [0, 1]: `D / (C + D)` for a pair of energy `C`, without which
  //! the energy of the matching increases at least by `D`; but at most that of the parents. 0:
  //! another match is as good, 0.5: the alternative costs twice as much as the pair. NaN if a tree
  //! lacks the branch, or it was not stored with the correspondences of `build_from()`. [-]
  double confidence = std::numeric_limits<double>::quiet_NaN();
};

} // namespace pcs

#endif // PCS_SHAPE_SPACE_ORL_TREE_H

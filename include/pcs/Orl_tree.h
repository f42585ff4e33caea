// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree of a shape space, as a value, and branches that correspond.

#ifndef PCS_ORL_TREE_H
#define PCS_ORL_TREE_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/path/Extrapolation_limits.h>
#include <pcs/shape_space/path/Sequential_births.h>

#include <array>
#include <cstddef>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief A tree of an `Orl_shape_space`: orientations, radii and lengths of the edges of its
      topology, a value.

  Kept and assigned to again, it keeps its memory.
*/
class Orl_tree
{
public:
  //! the place on the path it comes from: 0 and 1 are the ends [-]
  double lambda() const { return m_lambda; }
  //! number of points that `Orl_shape_space::points()` writes [count]
  std::size_t number_of_points() const { return m_offset.empty() ? 0 : m_offset.back(); }
  //! orientations, radii, lengths and attachments
  const shape_space::Orl_coordinates& coordinates() const { return m_x; }

private:
  template <class, class>
  friend class Orl_shape_space;
  template <class>
  friend class Orl_tree_paths;
  template <class>
  friend class Orl_tree_set;
  template <class>
  friend class Orl_tree_family;
  shape_space::Orl_coordinates m_x;
  shape_space::Orl_geometry m_geometry;
  shape_space::Extrapolation_buffers m_buffers;
  shape_space::Sequential_births_buffers m_births;
  std::vector<std::size_t> m_offset;
  double m_lambda = 0;
  std::vector<double> m_share; // of scans in the points, for more than two trees; empty: all alike
};

//! \ingroup PkgPcsShapeSpaceRef
//! two branches that correspond, named by the vertices at their tips
struct Branch_match
{
  std::size_t parent = npos; ///< index of the parents' match, `npos` for the trunks
  std::array<std::size_t, 2> tip = {npos,
                                    npos}; ///< index of a vertex; `npos`: the tree lacks the branch
};

} // namespace pcs

#endif // PCS_ORL_TREE_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Limits of extrapolation beyond the ends of a geodesic.

#ifndef PCS_SHAPE_SPACE_PATH_EXTRAPOLATION_LIMITS_H
#define PCS_SHAPE_SPACE_PATH_EXTRAPOLATION_LIMITS_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/constants.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Buffers of `Extrapolation_limits`.
struct Extrapolation_buffers
{
  Orl_geometry end, near;
  std::vector<double> low; ///< per node: lowest height of it and its subtrees
};

/*!
  Limits a tree that lies beyond the end of a path.

  Beyond an end, every rotation continues at its own rate, and the rotations of an edge and its
  ancestors accumulate about different axes. So each edge is limited twice: in its own rotation, and
  in its rotation in space relative to the end.

  Branches that become longer or lower could also reach below the base of the tree. The floor is the
  lowest height of the trees at both ends, at most the height of the base. If a branch or its
  subtree would reach below the floor, the edges of the branch are interpolated between the end and
  the extrapolation, with the largest admissible weight in [0, 1]. Heights are linear in the weight,
  so one iteration is enough. A subtree whose base comes nearer to the floor descends less steeply.

  Everything is continuous in the parameter of the path. Linear in the number of edges.
*/
class Extrapolation_limits
{
public:
  Extrapolation_limits(const Orl_layout& layout,
                       Orl_orientation kind,
                       const Vec3& up,
                       double max_extrapolation_angle,
                       Extrapolation_buffers& buffers)
    : m_layout(layout),
      m_kind(kind),
      m_up(up),
      m_max_extrapolation_angle(max_extrapolation_angle),
      m_buffers(buffers)
  {
  }

  /// `x` lies beyond `end`; `other` is the other end.
  void operator()(const Orl_coordinates& end, const Orl_coordinates& other, Orl_coordinates& x)
  {
    Orl_geometry &near = m_buffers.near, &at_end = m_buffers.end;
    build_geometry(m_layout, other, m_kind, near);
    m_floor = find_lowest(other, near);
    build_geometry(m_layout, end, m_kind, at_end);
    m_floor = std::min(m_floor, find_lowest(end, at_end));
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b)
      locate(b, end, x);
  }

private:
  double height(const Vec3& p, const Orl_coordinates& x) const { return m_up.dot(p - x.root); }
  Vec3 axis(const Quaternion& frame) const { return frame * Vec3::UnitZ(); }

  /// Finds, for each node, the lowest height of the node and of the subtrees attached next to it.
  /// Returns the lowest height of all. [L]
  double find_lowest(const Orl_coordinates& x, const Orl_geometry& geometry)
  {
    std::vector<double>& low = m_buffers.low;
    low.resize(m_layout.number_of_nodes());
    for (std::size_t v = 0; v < low.size(); ++v)
      low[v] = height(geometry.node[v], x);
    for (std::size_t b = m_layout.branches.size(); b-- > 0;) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      const double lowest = lowest_of_branch(b);
      if (branch.parent == none)
        return lowest;
      const Orl_layout::Branch& parent = m_layout.branches[branch.parent];
      const auto k =
          std::min(parent.number_of_edges - 1, static_cast<std::size_t>(x.attachment[b]));
      double* const there = &low[m_layout.first_node(branch.parent) + k];
      there[0] = std::min(there[0], lowest);
      there[1] = std::min(there[1], lowest);
    }
    return 0;
  }
  double lowest_of_branch(std::size_t b) const
  {
    const auto begin = m_buffers.low.begin() + static_cast<std::ptrdiff_t>(m_layout.first_node(b));
    return *std::min_element(
        begin,
        begin + static_cast<std::ptrdiff_t>(m_layout.branches[b].number_of_edges + 1));
  }

  /// Returns a frame rotated relative to the end by at most the limit.
  Quaternion limited(const Quaternion& frame, const Quaternion& at_end) const
  {
    constexpr double pi = pcs::internal::pi;
    if (!(m_max_extrapolation_angle < pi))
      return frame;
    const Vec3 turn = rotation_log(frame * at_end.conjugate());
    // near half a turn the axis flips, so the frame returns to the frame at the end
    const double angle = turn.norm(), most = std::min(m_max_extrapolation_angle, 4 * (pi - angle));
    if (!(angle > most))
      return frame;
    Quaternion result = rotation_exp(turn * (most / angle)) * at_end;
    result.normalize();
    return result;
  }

  void locate(std::size_t b, const Orl_coordinates& end, Orl_coordinates& x)
  {
    Orl_geometry &near = m_buffers.near, &at_end = m_buffers.end;
    const Orl_layout::Branch& branch = m_layout.branches[b];
    const std::size_t first = m_layout.first_node(b);
    near.node[first] = branch.parent == none
                           ? x.root
                           : place_on_branch(m_layout, near, branch.parent, x.attachment[b]);
    const double base = height(near.node[first], x);
    const double reach = height(at_end.node[first], end) - lowest_of_branch(b);
    const double steepness = reach > 0 ? std::min(1.0, std::max(0.0, (base - m_floor) / reach)) : 1;
    const auto edge_at_end = [&](std::size_t e) {
      Vec3 v = end.length[e] * axis(at_end.frame[e]);
      const double down = std::min(0.0, m_up.dot(v));
      v += (steepness - 1) * down * m_up;
      return v;
    };
    double share = 1, least = base, wanted = base;
    for (std::size_t j = 0; j < branch.number_of_edges; ++j) {
      const std::size_t e = branch.first_edge + j, p = m_layout.parent_edge[e], v = first + j + 1;
      near.frame[e] =
          p == none ? x.orientation[e] : compose(m_kind, near.frame[p], x.orientation[e]);
      near.frame[e].normalize();
      near.frame[e] = limited(near.frame[e], at_end.frame[e]);
      wanted += x.length[e] * m_up.dot(axis(near.frame[e]));
      least += m_up.dot(edge_at_end(e));
      const double bound = m_floor + steepness * (height(at_end.node[v], end) - m_buffers.low[v]);
      if (wanted < bound)
        share = std::min(share, least > bound ? (least - bound) / (least - wanted) : 0.0);
    }
    for (std::size_t j = 0; j < branch.number_of_edges; ++j) {
      const std::size_t e = branch.first_edge + j, p = m_layout.parent_edge[e];
      if (share < 1 && x.length[e] > 0) {
        const Vec3 old = axis(near.frame[e]);
        const Vec3 edge = (1 - share) * edge_at_end(e) + share * x.length[e] * old;
        if (const double length = edge.norm(); length > 0) {
          x.length[e] = length;
          near.frame[e] = shortest_turn(old, edge / length) * near.frame[e];
          near.frame[e].normalize();
        }
      }
      x.orientation[e] = p == none ? near.frame[e] : relative(m_kind, near.frame[p], near.frame[e]);
      x.orientation[e].normalize();
      near.node[first + j + 1] = near.node[first + j] + x.length[e] * axis(near.frame[e]);
    }
  }

  const Orl_layout& m_layout;
  Orl_orientation m_kind;
  Vec3 m_up;
  double m_max_extrapolation_angle, m_floor = 0;
  Extrapolation_buffers& m_buffers;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PATH_EXTRAPOLATION_LIMITS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Motion of the nodes and points of handles with one target per point.

#ifndef PCS_DEFORMATION_MODEL_NODE_TARGETS_H
#define PCS_DEFORMATION_MODEL_NODE_TARGETS_H

#include <pcs/core/Similarity.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Target_offset.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// The offsets of all nodes of a network; empty if no handle has targets.
class Node_targets
{
public:
  bool empty() const { return m_offset.empty(); }
  std::size_t size() const { return m_offset.size(); }
  void clear()
  {
    m_offset.clear();
    m_turn.clear();
  }
  /// Makes `size` nodes move with their handles.
  void assign(std::size_t size)
  {
    m_offset.assign(size, Target_offset());
    m_turn.assign(size, Quaternion::Identity());
  }
  /// Appends nodes that move with their handles.
  void resize(std::size_t size)
  {
    m_offset.resize(size);
    m_turn.resize(size, Quaternion::Identity());
  }
  void set(std::size_t node, const Target_offset& offset)
  {
    m_offset[node] = offset;
    m_turn[node] = Quaternion(polar_rotation(offset.linear)).normalized();
  }

  const Target_offset& operator[](std::size_t node) const { return m_offset[node]; }
  /// Returns the rotation of a node relative to its handle.
  const Quaternion& turn(std::size_t node) const { return m_turn[node]; }

  /// Returns the position of a node of a handle that moves by `t`. \param rest of the node [L]
  Vec3 position(const Similarity& t, const Vec3& rest, std::size_t node) const
  {
    return empty() ? t(rest) : Vec3(t(rest) + m_offset[node].offset);
  }

  /// Whether a node moves otherwise than its handle.
  bool is_offset(std::size_t node) const { return !empty() && !m_offset[node].is_zero(); }
  /// Returns the rotation of a node of a handle that moves by `t`, times the scale of `t`. [-]
  Eigen::Matrix3d frame(const Similarity& t, std::size_t node) const
  {
    if (empty())
      return t.scale() * t.rotation();
    return t.scale() * (m_turn[node].toRotationMatrix() * t.rotation());
  }
  /// Returns the gradient at a node of a handle that moves by `t`. [-]
  Eigen::Matrix3d linear(const Similarity& t, std::size_t node) const
  {
    return m_offset[node].linear * (t.scale() * t.rotation());
  }

private:
  std::vector<Target_offset> m_offset;
  std::vector<Quaternion> m_turn;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_NODE_TARGETS_H

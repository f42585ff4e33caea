// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of handles with one target per point, and of their surroundings, in the current shape.

#ifndef PCS_DEFORMATION_UPSAMPLING_TARGET_CORRECTIONS_H
#define PCS_DEFORMATION_UPSAMPLING_TARGET_CORRECTIONS_H

#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Local_frame.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/deformation/model/Target_offset.h>
#include <pcs/deformation/upsampling/blend_block.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  The difference between the targets of handles and their motions. Points of exact handles get their
  targets. Points that are blended towards a handle get the offset of the handle there, with the
  same weight. Empty if no handle has targets.
*/
class Target_corrections
{
public:
  bool empty() const { return m_index.empty(); }
  void clear() { *this = Target_corrections(); }

  /// Makes all points move by the motions.
  void assign(std::size_t number_of_sites) { m_index.assign(number_of_sites, none); }
  /// Adds an offset to the points of a site.
  void add(std::size_t site, const Target_offset& offset)
  {
    m_index[site] = static_cast<std::uint32_t>(m_corrections.size());
    m_corrections.push_back({offset, Vec3::Zero(), false});
  }
  /// Moves the points of a site to `target`, in the caller's coordinates.
  void add_target(std::size_t site, const Target_offset& offset, const Vec3& target)
  {
    add(site, offset);
    m_corrections.back().target = target;
    m_corrections.back().is_target = true;
  }
  /// Marks the blocks of points with corrections. `site_of_place` is that of the body. O(points).
  void mark_blocks(const std::vector<std::uint32_t>& site_of_place)
  {
    m_is_corrected.assign((site_of_place.size() + lanes - 1) / lanes, 0);
    for (std::size_t place = 0; place < site_of_place.size(); ++place)
      if (m_index[site_of_place[place]] != none)
        m_is_corrected[place / lanes] |= static_cast<std::uint8_t>(1u << place % lanes);
  }

  /// Corrects the output of a point at its position at rest. The position is in the caller's
  /// coordinates. Does nothing for other points.
  void apply(std::size_t site,
             const Local_frame& frame,
             Vec3& position,
             Vec3& normal,
             Eigen::Matrix3d& gradient) const
  {
    if (empty() || m_index[site] == none)
      return;
    const Correction& c = m_corrections[m_index[site]];
    position = c.is_target ? c.target : Vec3(position + frame.unit * c.offset.offset);
    normal = turn_normal(c.offset.linear, normal);
    gradient = c.offset.linear * gradient;
  }

  /// Corrects the output of a point whose nearest site is `site`. \param step from the site to the
  /// point at rest, in local coordinates
  void apply_near(std::size_t site,
                  const Vec3& step,
                  const Local_frame& frame,
                  Vec3& position,
                  Vec3& normal,
                  Eigen::Matrix3d& gradient) const
  {
    if (empty() || m_index[site] == none)
      return;
    const Correction& c = m_corrections[m_index[site]];
    if (c.is_target && step == Vec3::Zero())
      position = c.target;
    else
      position += frame.unit * c.offset.offset_at(gradient * step);
    normal = turn_normal(c.offset.linear, normal);
    gradient = c.offset.linear * gradient;
  }

  /// Corrects the output of the points in `mask` of a block. `site_of_place` is that of the body.
  template <Blend_outputs Outputs>
  void apply_to_block(std::size_t block,
                      std::uint8_t mask,
                      const std::uint32_t* site_of_place,
                      const Local_frame& frame,
                      bool has_normals,
                      Block_output& out) const
  {
    if (empty() || (m_is_corrected[block] & mask) == 0)
      return;
    for (std::size_t l = 0; l < lanes; ++l)
      if ((m_is_corrected[block] & mask) >> l & 1) {
        Vec3 position, normal = Vec3::Zero();
        Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
        for (int k = 0; k < 3; ++k) {
          position[k] = out.position.value[k][l];
          if (Outputs != Blend_outputs::positions && has_normals)
            normal[k] = out.normal.value[k][l];
        }
        if constexpr (Outputs == Blend_outputs::gradients)
          for (int k = 0; k < 9; ++k)
            gradient(k / 3, k % 3) = out.gradient[k][l];
        apply(site_of_place[block * lanes + l], frame, position, normal, gradient);
        for (int k = 0; k < 3; ++k) {
          out.position.value[k][l] = position[k];
          if (Outputs != Blend_outputs::positions && has_normals)
            out.normal.value[k][l] = normal[k];
        }
        if constexpr (Outputs == Blend_outputs::gradients)
          for (int k = 0; k < 9; ++k)
            out.gradient[k][l] = gradient(k / 3, k % 3);
      }
  }

private:
  struct Correction
  {
    Target_offset offset; ///< in local coordinates
    Vec3 target = Vec3::Zero();
    bool is_target = false; ///< whether the point moves to `target`, in the caller's coordinates
  };

  static constexpr std::uint32_t none = ~std::uint32_t(0);

  std::vector<std::uint32_t> m_index; ///< of each site in `m_corrections`
  std::vector<Correction> m_corrections;
  std::vector<std::uint8_t> m_is_corrected; ///< one bit per upsampling index
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_TARGET_CORRECTIONS_H

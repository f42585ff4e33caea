// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of handles with one target per point, and of their surroundings, in the current shape.

#ifndef PCS_DEFORMATION_UPSAMPLING_TARGET_CORRECTIONS_H
#define PCS_DEFORMATION_UPSAMPLING_TARGET_CORRECTIONS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/handles/Site_constraints.h>
#include <pcs/deformation/handles/Target_field.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Local_frame.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/deformation/upsampling/blend_block.h>
#include <pcs/deformation/upsampling/border_fade.h>
#include <pcs/deformation/upsampling/extend_targets.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
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

  /// O(sites) if there are targets.
  template <class ConcurrencyTag, class HandleOfSite>
  void find(const Sampled_body<ConcurrencyTag>& body,
            const Handle_set& handles,
            const std::vector<std::shared_ptr<const Handle_targets>>& targets,
            const std::vector<Similarity>& transforms,
            const Target_field& field,
            const Site_constraints& sites,
            const std::vector<Border_fade>& fades,
            const HandleOfSite& handle_of_site)
  {
    clear();
    if (field.empty())
      return;
    m_index.resize(body.number_of_sites(), none);
    for (std::size_t h = 0; h < targets.size(); ++h)
      if (targets[h])
        add_handle(handles.points()[h]->sites, targets[h]->of_sites, field, sites);
    if (body.has_fragments)
      add_followers(body, handles, field, sites);
    if (body.is_sampled)
      add_fades(body, transforms, field, fades, handle_of_site);
    m_is_corrected.resize(body.rest_points.number_of_blocks());
    for (std::size_t place = 0; place < body.number_of_points(); ++place)
      if (m_index[body.site_of_place[place]] != none)
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

  Correction& add(std::size_t site, const Target_offset& offset)
  {
    m_index[site] = static_cast<std::uint32_t>(m_corrections.size());
    m_corrections.push_back({offset, Vec3::Zero(), false});
    return m_corrections.back();
  }

  /// Adds the sites that move with the handle. The others, of soft handles, are blended.
  void add_handle(const std::vector<std::uint32_t>& of_handle,
                  const std::vector<Vec3>& targets,
                  const Target_field& field,
                  const Site_constraints& sites)
  {
    for (std::size_t k = 0; k < of_handle.size(); ++k)
      if (sites[of_handle[k]] >= 0) {
        Correction& c = add(of_handle[k], *field.of_site(of_handle[k]));
        c.target = targets[k];
        c.is_target = true;
      }
  }

  /// Adds the sites of fragments that follow a handle: they get the mean offset of its sites there.
  template <class ConcurrencyTag>
  void add_followers(const Sampled_body<ConcurrencyTag>& body,
                     const Handle_set& handles,
                     const Target_field& field,
                     const Site_constraints& sites)
  {
    std::vector<double> count(body.number_of_components(), 0);
    std::vector<Target_offset> mean(body.number_of_components());
    const auto follows = [&](std::size_t site) { return sites[site] != handles.of_site(site); };
    const auto is_in_fragment = [&](std::size_t site) {
      return body.sample_of_site[site] == no_sample && sites[site] >= 0;
    };
    for (std::size_t site = 0; site < body.number_of_sites(); ++site)
      if (is_in_fragment(site) && !follows(site) && field.of_site(site)) {
        const std::uint32_t c = body.component_of_site[site];
        count[c] += 1;
        mean[c].blend(1 / count[c], *field.of_site(site));
      }
    for (std::size_t site = 0; site < body.number_of_sites(); ++site)
      if (is_in_fragment(site) && follows(site) && count[body.component_of_site[site]] > 0)
        add(site, mean[body.component_of_site[site]]);
  }

  template <class ConcurrencyTag, class HandleOfSite>
  void add_fades(const Sampled_body<ConcurrencyTag>& body,
                 const std::vector<Similarity>& transforms,
                 const Target_field& field,
                 const std::vector<Border_fade>& fades,
                 const HandleOfSite& handle_of_site)
  {
    const auto position = [&](std::size_t site) { return body.rest_of_site(site); };
    const std::vector<Target_offset> offset =
        extend_targets(body.site_graph, fades, field, transforms, handle_of_site, position);
    for (std::size_t f = 0; f < fades.size();) {
      const std::uint32_t site = fades[f].site;
      Target_offset sum;
      for (; f < fades.size() && fades[f].site == site; ++f)
        sum.blend(fades[f].weight, offset[f]);
      if (!sum.is_zero())
        add(site, sum);
    }
  }

  static constexpr std::uint32_t none = ~std::uint32_t(0);

  std::vector<std::uint32_t> m_index; ///< of each site in `m_corrections`
  std::vector<Correction> m_corrections;
  std::vector<std::uint8_t> m_is_corrected; ///< one bit per upsampling index
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_TARGET_CORRECTIONS_H

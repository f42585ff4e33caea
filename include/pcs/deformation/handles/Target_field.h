// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Offsets of the sites of handles with one target per point, and of the samples near them.

#ifndef PCS_DEFORMATION_HANDLES_TARGET_FIELD_H
#define PCS_DEFORMATION_HANDLES_TARGET_FIELD_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/handles/fit_rigid_motion.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

/// Spread in a direction, relative to the sum of all, from which sites determine the gradient
/// along it. [-]
constexpr double least_measured_spread = 0.02;

/*!
  Returns the linear map `M` that best fits the images `u + r` of vectors `u`. Along directions in
  which the vectors hardly extend, such as the normal of a surface, it is the best-fitting rotation
  `Q`: `M = Q + (S + C - Q S) S (S^2 + l^2)^-1`, where `l` is `least_measured_spread` times the
  trace of `S`.
  \param uu the sum `S` of `u u^T`
  \param ru the sum `C` of `r u^T`
*/
inline Eigen::Matrix3d fit_linear_map(const Eigen::Matrix3d& uu, const Eigen::Matrix3d& ru)
{
  const double trace = uu.trace();
  if (!(trace > 0))
    return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d unit = uu / trace, image = unit + ru / trace;
  const Eigen::Matrix3d q = best_rotation(image).toRotationMatrix();
  const Eigen::Matrix3d damped =
      unit * unit + least_measured_spread * least_measured_spread * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d result = q + (image - q * unit) * unit * damped.inverse();
  return result.allFinite() ? result : q;
}

} // namespace internal

/*!
  The offsets `r` of the targets of a handle from its motion `T`, in local coordinates, with the
  gradient of the motion around each site. The gradient at a site is fitted to the targets of the
  adjacent sites of the handle, and then averaged over these sites.
*/
class Target_field
{
public:
  bool empty() const { return m_of_site.empty(); }
  void clear() { *this = Target_field(); }

  /// Returns the offset of a site of a handle with targets, or null for other sites.
  const Target_offset* of_site(std::size_t site) const
  {
    return empty() || m_index[site] == none ? nullptr : &m_of_site[m_index[site]];
  }

  /// O(sites of handles with targets), plus O(sites) if there are any.
  /// \param points, targets of each handle, or null
  /// \param transforms of the handles, in local coordinates
  template <class ConcurrencyTag>
  void find(const Sampled_body<ConcurrencyTag>& body,
            const std::vector<std::shared_ptr<const Handle_points>>& points,
            const std::vector<std::shared_ptr<const Handle_targets>>& targets,
            const std::vector<Similarity>& transforms)
  {
    clear();
    std::vector<std::uint32_t> slot; // of each sample in `m_regions`
    for (std::size_t h = 0; h < targets.size(); ++h)
      if (points[h] && targets[h]) {
        m_index.resize(body.number_of_sites(), none);
        slot.resize(body.number_of_samples(), none);
        add_handle(body,
                   static_cast<Node_constraint>(h),
                   points[h]->sites,
                   targets[h]->of_sites,
                   transforms[h],
                   slot);
      }
    std::sort(m_regions.begin(), m_regions.end(), [](const Region& a, const Region& b) {
      return a.sample != b.sample ? a.sample < b.sample : a.handle < b.handle;
    });
  }

  /// Sets the offsets of the samples that `constraints` assigns to handles with targets.
  template <class ConcurrencyTag>
  void set_samples(const Sampled_body<ConcurrencyTag>& body,
                   const Node_constraints& constraints,
                   const Handle_set& handles,
                   const std::vector<Similarity>& transforms,
                   Node_targets& nodes) const
  {
    for (std::size_t s = 0; s < body.number_of_samples(); ++s) {
      const Node_constraint h = constraints.handle_of_node[s];
      if (h < 0)
        continue;
      const std::size_t site = body.site_of_sample[s];
      // One target of a soft handle counts as much as its neighbours.
      const bool is_mean = handles.of_site(site) != h || handles.is_soft(h);
      const Target_offset* own = of_site(site);
      if (!is_mean && own)
        nodes.set(s, *own);
      else if (const Region* region = find_region(s, h))
        nodes.set(s, region->at(transforms[static_cast<std::size_t>(h)], body.network.rest[s]));
    }
  }

  /// Sets the offsets of the nodes from `first` on, which lie near the sites `network.source`.
  template <class ConcurrencyTag>
  void set_border(const Sampled_body<ConcurrencyTag>& body,
                  const Elastic_network& network,
                  const Node_constraints& constraints,
                  const std::vector<Similarity>& transforms,
                  std::size_t first,
                  Node_targets& nodes) const
  {
    for (std::size_t i = first; i < network.size(); ++i) {
      const std::size_t site = network.source[i - first];
      const Target_offset* own = of_site(site);
      if (!own)
        continue;
      const Similarity& t = transforms[static_cast<std::size_t>(constraints.handle_of_node[i])];
      const Vec3 step = network.rest[i] - body.rest_of_site(site);
      nodes.set(i, {own->offset_at(t.scale() * (t.rotation() * step)), own->linear});
    }
  }

private:
  /// The sites of a handle in the region of a sample.
  struct Region
  {
    std::uint32_t sample;
    Node_constraint handle;
    double count;         ///< of sites
    Vec3 center;          ///< mean position at rest
    Target_offset offset; ///< mean, at `center`

    Target_offset at(const Similarity& t, const Vec3& rest) const
    {
      const Vec3 step = t.scale() * (t.rotation() * (rest - center));
      return {offset.offset_at(step), offset.linear};
    }
  };

  const Region* find_region(std::size_t sample, Node_constraint handle) const
  {
    const auto found = std::lower_bound(m_regions.begin(),
                                        m_regions.end(),
                                        std::make_pair(sample, handle),
                                        [](const Region& a, const auto& key) {
                                          return a.sample != key.first ? a.sample < key.first
                                                                       : a.handle < key.second;
                                        });
    const bool is_found =
        found != m_regions.end() && found->sample == sample && found->handle == handle;
    return is_found ? &*found : nullptr;
  }

  /// \param slot `none` for each sample, before and after the call
  template <class ConcurrencyTag>
  void add_handle(const Sampled_body<ConcurrencyTag>& body,
                  Node_constraint handle,
                  const std::vector<std::uint32_t>& sites,
                  const std::vector<Vec3>& targets,
                  const Similarity& t,
                  std::vector<std::uint32_t>& slot)
  {
    const std::size_t first = m_of_site.size();
    m_of_site.resize(first + sites.size());
    for (std::size_t k = 0; k < sites.size(); ++k) {
      m_of_site[first + k].offset =
          body.frame.to_local(targets[k]) - t(body.rest_of_site(sites[k]));
      m_index[sites[k]] = static_cast<std::uint32_t>(first + k);
    }
    std::vector<Eigen::Matrix3d> linear(sites.size());
    pcs::internal::for_each_index<ConcurrencyTag>(sites.size(), [&](std::size_t k) {
      linear[k] = fit_site(body, sites[k], first, t);
    });
    pcs::internal::for_each_index<ConcurrencyTag>(sites.size(), [&](std::size_t k) {
      Eigen::Matrix3d sum = linear[k];
      double count = 1;
      for_each_neighbor(body, sites[k], first, [&](std::size_t, std::size_t index) {
        sum += linear[index - first];
        count += 1;
      });
      m_of_site[first + k].linear = sum / count;
    });
    add_regions(body, handle, sites, first, slot);
  }

  /// Calls `use(site, index in m_of_site)` for the sites adjacent to a site of the last handle,
  /// whose offsets begin at `first`, that belong to the same handle.
  template <class ConcurrencyTag, class Use>
  void for_each_neighbor(const Sampled_body<ConcurrencyTag>& body,
                         std::size_t site,
                         std::size_t first,
                         const Use& use) const
  {
    // Without samples, the graph of the sites is that of the network, perhaps with further nodes,
    // and without edges out of the handle.
    const neighborhood::Proximity_graph& graph =
        body.is_sampled ? body.site_graph : body.network.surface;
    for (auto j = graph.begin(site); j != graph.end(site); ++j)
      if (*j < m_index.size() && m_index[*j] != none && m_index[*j] >= first)
        use(*j, m_index[*j]);
  }

  /// Fits the map at a site to the targets of the adjacent sites.
  template <class ConcurrencyTag>
  Eigen::Matrix3d fit_site(const Sampled_body<ConcurrencyTag>& body,
                           std::size_t site,
                           std::size_t first,
                           const Similarity& t) const
  {
    const Vec3 place = body.rest_of_site(site);
    Eigen::Matrix3d uu = Eigen::Matrix3d::Zero(), ru = Eigen::Matrix3d::Zero();
    for_each_neighbor(body, site, first, [&](std::size_t other, std::size_t index) {
      const Vec3 u = t.scale() * (t.rotation() * (body.rest_of_site(other) - place));
      uu += u * u.transpose();
      ru += (m_of_site[index].offset - m_of_site[m_index[site]].offset) * u.transpose();
    });
    return internal::fit_linear_map(uu, ru);
  }

  /// Adds the means of the offsets of a handle in the regions of the samples.
  template <class ConcurrencyTag>
  void add_regions(const Sampled_body<ConcurrencyTag>& body,
                   Node_constraint handle,
                   const std::vector<std::uint32_t>& sites,
                   std::size_t first,
                   std::vector<std::uint32_t>& slot)
  {
    const std::size_t first_region = m_regions.size();
    for (std::size_t k = 0; k < sites.size(); ++k) {
      const std::uint32_t sample = body.sample_of_site[sites[k]];
      if (sample == no_sample)
        continue;
      if (slot[sample] == none) {
        slot[sample] = static_cast<std::uint32_t>(m_regions.size());
        m_regions.push_back({sample, handle, 0, Vec3::Zero(), Target_offset()});
      }
      Region& region = m_regions[slot[sample]];
      region.count += 1;
      region.center += (body.rest_of_site(sites[k]) - region.center) / region.count;
      region.offset.blend(1 / region.count, m_of_site[first + k]);
    }
    for (std::size_t r = first_region; r < m_regions.size(); ++r)
      slot[m_regions[r].sample] = none;
  }

  static constexpr std::uint32_t none = ~std::uint32_t(0);

  std::vector<std::uint32_t> m_index; ///< of each site in `m_of_site`; empty without targets
  std::vector<Target_offset> m_of_site;
  std::vector<Region> m_regions; ///< increasing by sample, then handle
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_TARGET_FIELD_H

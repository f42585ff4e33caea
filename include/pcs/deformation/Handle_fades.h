// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The points around the handles that are drawn towards the motion of the handle, ready for the blocks of the upsampling.

#ifndef PCS_DEFORMATION_HANDLE_FADES_H
#define PCS_DEFORMATION_HANDLE_FADES_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Sampled_body.h>
#include <pcs/deformation/blend_block.h>
#include <pcs/deformation/border_fade.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/// See `border_fades()`. Transformations are those of the handles, in local coordinates.
class Handle_fades
{
public:
  /// \param handle_of_site the exact handle that holds a site, or negative
  template <class ConcurrencyTag, class HandleOfSite>
  void find(const Sampled_body<ConcurrencyTag>& body, const HandleOfSite& handle_of_site)
  {
    const Weighted_graph& graph = body.network.surface;
    std::vector<double> spacing(graph.size(), 0);
    for (std::size_t s = 0; s < spacing.size(); ++s) {
      for (auto t = graph.begin(s); t != graph.end(s); ++t)
        spacing[s] += (body.network.rest[*t] - body.network.rest[s]).norm();
      spacing[s] /= std::max<double>(1, static_cast<double>(graph.degree(s)));
    }
    m_of_sites = border_fades(body.site_graph,
                              body.sample_of_site,
                              spacing,
                              handle_of_site,
                              [&](std::size_t site) { return body.rest_of_site(site); });
    m_of_places.clear();
    m_first.assign(body.upsampling.number_of_blocks() + 1, 0);
    for (const Border_fade& f : m_of_sites)
      for (std::size_t place = body.first_place(f.site);
           place < body.number_of_points() && body.site_of_place[place] == f.site;
           ++place) {
        m_of_places.push_back({static_cast<std::uint32_t>(place), f.handle, f.weight});
        ++m_first[place / lanes + 1];
      }
    for (std::size_t block = 0; block + 1 < m_first.size(); ++block)
      m_first[block + 1] += m_first[block];
  }

  /// Whether a point of the block is drawn. Never, before `find()`.
  bool touches(std::size_t block) const
  {
    return !m_of_places.empty() && m_first[block] != m_first[block + 1];
  }

  /// Draws the points of a block that the samples have moved, in the caller's coordinates.
  template <bool HasGradients, class ConcurrencyTag>
  void apply(std::size_t block,
             const std::vector<Similarity>& transforms,
             const Sampled_body<ConcurrencyTag>& body,
             Block_output& out) const
  {
    const auto& upsampling = body.upsampling;
    for (std::size_t k = m_first[block]; k < m_first[block + 1]; ++k) {
      const Place_fade& f = m_of_places[k];
      const std::size_t l = f.place % lanes;
      const Similarity& t = transforms[static_cast<std::size_t>(f.handle)];
      const Vec3 target = body.frame.to_world(t(upsampling.rest(f.place)));
      for (int c = 0; c < 3; ++c)
        out.position.value[c][l] += f.weight * (target[c] - out.position.value[c][l]);
      if (upsampling.has_normals()) {
        const Vec3 rest = upsampling.rest_normal(f.place), turned = t.rotation() * rest;
        Vec3 mixed;
        for (int c = 0; c < 3; ++c)
          mixed[c] = out.normal.value[c][l] + f.weight * (turned[c] - out.normal.value[c][l]);
        const double squared = mixed.squaredNorm();
        if (squared > 0) {
          const double scale = std::sqrt(rest.squaredNorm() / squared);
          for (int c = 0; c < 3; ++c)
            out.normal.value[c][l] = scale * mixed[c];
        }
      }
      if constexpr (HasGradients)
        for (int e = 0; e < 9; ++e)
          out.gradient[e][l] +=
              f.weight * (t.scale() * t.rotation()(e / 3, e % 3) - out.gradient[e][l]);
    }
  }

  /// The same for one point near `site`, in local coordinates.
  void apply(std::size_t site,
             const std::vector<Similarity>& transforms,
             const Vec3& rest,
             const Vec3& rest_normal,
             Vec3& p,
             Vec3& normal,
             Eigen::Matrix3d& gradient) const
  {
    const auto f = std::lower_bound(m_of_sites.begin(),
                                    m_of_sites.end(),
                                    site,
                                    [](const Border_fade& a, std::size_t s) { return a.site < s; });
    if (f == m_of_sites.end() || f->site != site)
      return;
    const Similarity& t = transforms[static_cast<std::size_t>(f->handle)];
    p += f->weight * (t(rest) - p);
    gradient += f->weight * (t.scale() * t.rotation() - gradient);
    const Vec3 mixed = normal + f->weight * (t.rotation() * rest_normal - normal);
    const double length = mixed.norm();
    if (length > 0)
      normal = rest_normal.norm() / length * mixed;
  }

private:
  struct Place_fade
  {
    std::uint32_t place;
    Node_constraint handle;
    double weight;
  };
  std::vector<Border_fade> m_of_sites; ///< increasing by site
  std::vector<Place_fade> m_of_places; ///< the same by place
  std::vector<std::uint32_t> m_first;  ///< of each block in `m_of_places`, and the end
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLE_FADES_H

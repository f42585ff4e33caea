// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Blend weights of the points around handles, in blocks of the upsampling.

#ifndef PCS_DEFORMATION_UPSAMPLING_HANDLE_FADES_H
#define PCS_DEFORMATION_UPSAMPLING_HANDLE_FADES_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/deformation/upsampling/blend_block.h>
#include <pcs/deformation/upsampling/border_fade.h>

#include <boost/sort/spreadsort/integer_sort.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/// Blend weights of `border_fades()`, by site and by block. The transformations of the handles are
/// in local coordinates.
class Handle_fades
{
public:
  /// \param handle_of_site the exact handle that holds a site, or negative
  template <class ConcurrencyTag, class HandleOfSite>
  void find(const Sampled_body<ConcurrencyTag>& body,
            const std::vector<Border_edge>& border,
            const HandleOfSite& handle_of_site)
  {
    const Weighted_graph& graph = body.network.surface;
    std::vector<double> spacing(graph.size(), 0);
    for (std::size_t s = 0; s < spacing.size(); ++s) {
      for (auto t = graph.begin(s); t != graph.end(s); ++t)
        spacing[s] += (body.network.rest[*t] - body.network.rest[s]).norm();
      spacing[s] /= std::max<double>(1, static_cast<double>(graph.degree(s)));
    }
    m_of_sites = border_fades(body.site_graph,
                              border,
                              body.sample_of_site,
                              spacing,
                              handle_of_site,
                              [&](std::size_t site) { return body.rest_of_site(site); });
    fill_blocks(body, fades_of_places(body));
  }

  /// The weights by site, increasing by site, then by handle.
  const std::vector<Border_fade>& of_sites() const { return m_of_sites; }

  /// Returns the weights for the blocks of the upsampling; empty before `find()`.
  Upsampling::Fades of_blocks() const
  {
    if (m_of_blocks.empty())
      return {};
    return {m_first.data(), m_of_blocks.data()};
  }

  /// Blends a point near `site`, already moved by the samples, towards the handles. Coordinates are
  /// local.
  void apply(std::size_t site,
             const std::vector<Similarity>& transforms,
             const Vec3& rest,
             const Vec3& rest_normal,
             Vec3& p,
             Vec3& normal,
             Eigen::Matrix3d& gradient) const
  {
    auto f = std::lower_bound(m_of_sites.begin(),
                              m_of_sites.end(),
                              site,
                              [](const Border_fade& a, std::size_t s) { return a.site < s; });
    if (f == m_of_sites.end() || f->site != site)
      return;
    for (; f != m_of_sites.end() && f->site == site; ++f) {
      const Similarity& t = transforms[static_cast<std::size_t>(f->handle)];
      p += f->weight * (t(rest) - p);
      gradient += f->weight * (t.scale() * t.rotation() - gradient);
      normal += f->weight * (t.rotation() * rest_normal - normal);
    }
    const double length = normal.norm();
    if (length > 0)
      normal *= rest_normal.norm() / length;
  }

private:
  /// Returns the upsampling index of each point with a weight, and the index of the weight, in
  /// increasing order; the upsampling index is in the upper half of the bits.
  template <class ConcurrencyTag>
  std::vector<std::uint64_t> fades_of_places(const Sampled_body<ConcurrencyTag>& body) const
  {
    std::vector<std::uint64_t> result;
    result.reserve(m_of_sites.size());
    if (body.number_of_sites() == body.number_of_points()) {
      for (std::size_t f = 0; f < m_of_sites.size(); ++f)
        result.push_back(std::uint64_t(body.first_place(m_of_sites[f].site)) << 32 | f);
      if (!body.place_of_site.empty())
        boost::sort::spreadsort::integer_sort(result.begin(), result.end());
      return result;
    }
    std::vector<std::uint32_t> first_of_site(body.number_of_sites(), none);
    for (std::size_t f = m_of_sites.size(); f-- > 0;)
      first_of_site[m_of_sites[f].site] = static_cast<std::uint32_t>(f);
    for (std::size_t place = 0; place < body.number_of_points(); ++place) {
      const std::uint32_t site = body.site_of_place[place];
      for (std::size_t f = first_of_site[site]; f < m_of_sites.size() && m_of_sites[f].site == site;
           ++f)
        result.push_back(std::uint64_t(place) << 32 | f);
    }
    return result;
  }

  /// \param of_places see `fades_of_places()`
  template <class ConcurrencyTag>
  void fill_blocks(const Sampled_body<ConcurrencyTag>& body,
                   const std::vector<std::uint64_t>& of_places)
  {
    m_of_blocks.clear();
    m_first.assign(1, 0);
    auto next = of_places.begin();
    for (std::size_t block = 0; block < body.rest_points.number_of_blocks(); ++block) {
      for (; next != of_places.end() && (*next >> 32) < (block + 1) * lanes; ++next)
        add(m_of_sites[static_cast<std::uint32_t>(*next)], (*next >> 32) % lanes);
      m_first.push_back(static_cast<std::uint32_t>(m_of_blocks.size()));
    }
  }

  /// Inserts a weight in the order of the handles, in which they are applied to a point.
  void add(const Border_fade& fade, std::size_t lane)
  {
    auto f = m_of_blocks.begin() + m_first.back();
    const auto handle = static_cast<std::uint32_t>(fade.handle);
    while (f != m_of_blocks.end() && f->handle < handle)
      ++f;
    if (f == m_of_blocks.end() || f->handle != handle)
      f = m_of_blocks.insert(f, {handle, {}});
    f->weight[lane] = fade.weight;
  }

  static constexpr std::uint32_t none = ~std::uint32_t(0);

  std::vector<Border_fade> m_of_sites; ///< increasing by site
  std::vector<Block_fade> m_of_blocks; ///< increasing by block
  std::vector<std::uint32_t> m_first;  ///< index in `m_of_blocks` of each block, and the end
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_HANDLE_FADES_H

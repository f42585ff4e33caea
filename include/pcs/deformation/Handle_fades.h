// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The points around the handles that are drawn towards the motion of the handle, ready for the blocks of the upsampling.

#ifndef PCS_DEFORMATION_HANDLE_FADES_H
#define PCS_DEFORMATION_HANDLE_FADES_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Sampled_body.h>
#include <pcs/deformation/Upsampling.h>
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
    m_of_blocks.clear();
    m_first.assign(1, 0);
    const auto& upsampling = body.upsampling;
    std::size_t begin = 0; // of the sites in the block
    for (std::size_t block = 0; block < upsampling.number_of_blocks(); ++block) {
      for (std::size_t place = block * lanes;
           place < std::min((block + 1) * lanes, body.number_of_points());
           ++place) {
        while (begin < m_of_sites.size() && m_of_sites[begin].site < body.site_of_place[place])
          ++begin;
        if (begin < m_of_sites.size() && m_of_sites[begin].site == body.site_of_place[place])
          add(m_of_sites[begin], place % lanes);
      }
      m_first.push_back(static_cast<std::uint32_t>(m_of_blocks.size()));
    }
  }

  /// The present transformations of the handles, for the points of blocks.
  void set_transforms(const std::vector<Similarity>& transforms, const Local_frame& frame)
  {
    m_targets.resize(transforms.size());
    for (std::size_t h = 0; h < transforms.size(); ++h) {
      Target& target = m_targets[h];
      target.turn = transforms[h].rotation();
      target.linear = transforms[h].scale() * target.turn;
      target.offset = frame.to_world(transforms[h].translation());
    }
    m_unit = frame.unit;
  }

  /// Whether a point of the block is drawn. Never, before `find()`.
  bool touches(std::size_t block) const
  {
    return !m_of_blocks.empty() && m_first[block] != m_first[block + 1];
  }

  /// Draws the points of a block that the samples have moved, in the caller's coordinates, to where
  /// `set_transforms()` takes them.
  template <bool HasGradients>
  void apply(std::size_t block, const Upsampling& upsampling, Block_output& out) const
  {
    const Lane_vectors& rest = upsampling.rest_of_block(block);
    for (std::size_t k = m_first[block]; k < m_first[block + 1]; ++k) {
      const Block_fade& f = m_of_blocks[k];
      const Target& target = m_targets[static_cast<std::size_t>(f.handle)];
      for (int c = 0; c < 3; ++c)
        for (std::size_t l = 0; l < lanes; ++l) {
          const double local = target.linear(c, 0) * rest.value[0][l] +
                               target.linear(c, 1) * rest.value[1][l] +
                               target.linear(c, 2) * rest.value[2][l];
          out.position.value[c][l] +=
              f.weight[l] * (local * m_unit + target.offset[c] - out.position.value[c][l]);
        }
      if (upsampling.has_normals())
        draw_normals(f, target.turn, upsampling.normals_of_block(block), out.normal);
      if constexpr (HasGradients)
        for (int e = 0; e < 9; ++e)
          for (std::size_t l = 0; l < lanes; ++l)
            out.gradient[e][l] += f.weight[l] * (target.linear(e / 3, e % 3) - out.gradient[e][l]);
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
  /// Where a handle takes a point: `unit * linear * x + offset` in the caller's coordinates.
  struct Target
  {
    Eigen::Matrix3d linear, turn;
    Vec3 offset;
  };
  /// The share of one handle in the points of a block; zero for those it does not draw.
  struct Block_fade
  {
    Node_constraint handle;
    double weight[lanes];
  };

  void add(const Border_fade& fade, std::size_t lane)
  {
    auto f = m_of_blocks.begin() + m_first.back();
    while (f != m_of_blocks.end() && f->handle != fade.handle)
      ++f;
    if (f == m_of_blocks.end())
      f = m_of_blocks.insert(f, {fade.handle, {}});
    f->weight[lane] = fade.weight;
  }

  static void draw_normals(const Block_fade& f,
                           const Eigen::Matrix3d& turn,
                           const Lane_vectors& rest,
                           Lane_vectors& normal)
  {
    Lane_vectors mixed;
    double squared[lanes] = {}, rest_squared[lanes] = {};
    for (int c = 0; c < 3; ++c)
      for (std::size_t l = 0; l < lanes; ++l) {
        const double turned = turn(c, 0) * rest.value[0][l] + turn(c, 1) * rest.value[1][l] +
                              turn(c, 2) * rest.value[2][l];
        const double present = normal.value[c][l];
        mixed.value[c][l] = present + f.weight[l] * (turned - present);
        squared[l] += mixed.value[c][l] * mixed.value[c][l];
        rest_squared[l] += rest.value[c][l] * rest.value[c][l];
      }
    for (std::size_t l = 0; l < lanes; ++l)
      if (f.weight[l] > 0 && squared[l] > 0) {
        const double scale = std::sqrt(rest_squared[l] / squared[l]);
        for (int c = 0; c < 3; ++c)
          normal.value[c][l] = scale * mixed.value[c][l];
      }
  }

  std::vector<Border_fade> m_of_sites; ///< increasing by site
  std::vector<Block_fade> m_of_blocks; ///< the same by block
  std::vector<std::uint32_t> m_first;  ///< of each block in `m_of_blocks`, and the end
  std::vector<Target> m_targets;       ///< of the handles
  double m_unit = 1;                   ///< length of one unit of the points at rest [L]
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLE_FADES_H

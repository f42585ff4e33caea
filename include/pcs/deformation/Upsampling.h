// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Carries the motion of the samples to all points: blended affine maps, eight points at a time.

#ifndef PCS_DEFORMATION_UPSAMPLING_H
#define PCS_DEFORMATION_UPSAMPLING_H

#include <pcs/deformation/Sample_links.h>
#include <pcs/internal/instruction_set.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// The affine map `x -> a x + t` of one sample, row by row: a (9), t (3).
struct Affine_map
{
  double a[9], t[3];
};

constexpr std::size_t lanes = 8;

/// Coordinates of eight points: x of all, y of all, z of all.
struct alignas(64) Lane_vectors
{
  double value[3][lanes];
};

namespace internal {

/// A sample of a block besides its base, with one weight per point in units of 1/65535.
struct Block_entry
{
  std::uint32_t sample;
  std::uint16_t weight[lanes];
};

/*!
  Equations (2.4) and (2.5) of the dissertation for one block. With `sum w = 1`,

      sum w_s (A_s p + t_s) = A_b p + t_b + sum w_s ((A_s - A_b) (p - o) + ((A_s - A_b) o + t_s - t_b))

  for any base sample `b` of the block and its position `o`. The first part is computed in double precision; the sum
  holds differences between neighbouring samples only, so that it may be blended in single precision and a rigid
  motion stays exact. Normals get the cofactor matrix of the blended map, and keep their length.
*/
template <bool HasNormals>
PCS_ALWAYS_INLINE void blend_block(const Affine_map* maps,
                                   std::uint32_t base,
                                   const double* origin,
                                   const Block_entry* entry,
                                   const Block_entry* entry_end,
                                   const Lane_vectors& rest,
                                   const Lane_vectors* normal,
                                   Lane_vectors& position_out,
                                   Lane_vectors& normal_out)
{
  constexpr float unit = 1.0f / 65535.0f;
  const Affine_map& b = maps[base];
  alignas(64) float m[12][lanes] = {};
  for (; entry != entry_end; ++entry) {
    const Affine_map& s = maps[entry->sample];
    float d[12];
    for (int r = 0; r < 3; ++r) {
      double offset = s.t[r] - b.t[r];
      for (int c = 0; c < 3; ++c) {
        const double difference = s.a[3 * r + c] - b.a[3 * r + c];
        d[3 * r + c] = static_cast<float>(difference);
        offset += difference * origin[c];
      }
      d[9 + r] = static_cast<float>(offset);
    }
    alignas(32) float w[lanes];
    for (std::size_t l = 0; l < lanes; ++l)
      w[l] = unit * static_cast<float>(entry->weight[l]);
    for (int k = 0; k < 12; ++k)
      for (std::size_t l = 0; l < lanes; ++l)
        m[k][l] += w[l] * d[k];
  }
  alignas(32) float q[3][lanes];
  for (int c = 0; c < 3; ++c)
    for (std::size_t l = 0; l < lanes; ++l)
      q[c][l] = static_cast<float>(rest.value[c][l] - origin[c]);
  for (int r = 0; r < 3; ++r)
    for (std::size_t l = 0; l < lanes; ++l) {
      const float correction = m[3 * r][l] * q[0][l] + m[3 * r + 1][l] * q[1][l] +
                               m[3 * r + 2][l] * q[2][l] + m[9 + r][l];
      position_out.value[r][l] = b.a[3 * r] * rest.value[0][l] + b.a[3 * r + 1] * rest.value[1][l] +
                                 b.a[3 * r + 2] * rest.value[2][l] + b.t[r] +
                                 static_cast<double>(correction);
    }
  if constexpr (HasNormals) {
    for (std::size_t l = 0; l < lanes; ++l) {
      double g[9];
      for (int k = 0; k < 9; ++k)
        g[k] = b.a[k] + static_cast<double>(m[k][l]);
      const double x = normal->value[0][l], y = normal->value[1][l], z = normal->value[2][l];
      const double nx = (g[4] * g[8] - g[5] * g[7]) * x + (g[5] * g[6] - g[3] * g[8]) * y +
                        (g[3] * g[7] - g[4] * g[6]) * z;
      const double ny = (g[2] * g[7] - g[1] * g[8]) * x + (g[0] * g[8] - g[2] * g[6]) * y +
                        (g[1] * g[6] - g[0] * g[7]) * z;
      const double nz = (g[1] * g[5] - g[2] * g[4]) * x + (g[2] * g[3] - g[0] * g[5]) * y +
                        (g[0] * g[4] - g[1] * g[3]) * z;
      const double before = x * x + y * y + z * z, after = nx * nx + ny * ny + nz * nz;
      // A map that crushes the surface to a line leaves no normal: keep a finite value.
      const double scale = std::sqrt(before / (after + 1e-290));
      normal_out.value[0][l] = scale * nx;
      normal_out.value[1][l] = scale * ny;
      normal_out.value[2][l] = scale * nz;
    }
  }
}

template <bool HasNormals>
void blend_block_default(const Affine_map* maps,
                         std::uint32_t base,
                         const double* origin,
                         const Block_entry* entry,
                         const Block_entry* entry_end,
                         const Lane_vectors& rest,
                         const Lane_vectors* normal,
                         Lane_vectors& position_out,
                         Lane_vectors& normal_out)
{
  blend_block<HasNormals>(maps,
                          base,
                          origin,
                          entry,
                          entry_end,
                          rest,
                          normal,
                          position_out,
                          normal_out);
}

#if PCS_HAS_RUNTIME_DISPATCH
template <bool HasNormals>
PCS_TARGET_AVX2 void blend_block_avx2(const Affine_map* maps,
                                      std::uint32_t base,
                                      const double* origin,
                                      const Block_entry* entry,
                                      const Block_entry* entry_end,
                                      const Lane_vectors& rest,
                                      const Lane_vectors* normal,
                                      Lane_vectors& position_out,
                                      Lane_vectors& normal_out)
{
  blend_block<HasNormals>(maps,
                          base,
                          origin,
                          entry,
                          entry_end,
                          rest,
                          normal,
                          position_out,
                          normal_out);
}
#endif

} // namespace internal

/*!
  Points in blocks of eight with the samples that move any of them. Memory per point: 24 bytes of position, 24 of
  normal if there are normals, and 2 bytes per sample of the block.
*/
class Upsampling
{
public:
  Upsampling() = default;

  /// \param point `point(i)` is the position of point `i` in `[0, n)`; neighbours in this order should be near
  /// \param row `row(i)` is the row of `links` that holds for point `i`
  template <class Point_at, class Row_at>
  Upsampling(std::size_t n,
             const Point_at& point,
             const Row_at& row,
             std::vector<Vec3> sample_points,
             const Sample_links& links)
    : m_size(n), m_sample_points(std::move(sample_points))
  {
    const std::size_t number_of_blocks = (m_size + lanes - 1) / lanes;
    set_rest(point);
    m_first.push_back(0);
    m_base.reserve(number_of_blocks);
    std::vector<std::pair<std::uint32_t, std::array<float, lanes>>> unions;
    for (std::size_t block = 0; block < number_of_blocks; ++block) {
      unions.clear();
      for (std::size_t l = 0; l < lanes; ++l) {
        const std::size_t i = row(std::min(block * lanes + l, m_size - 1));
        for (std::size_t b = 0; b < links.k; ++b) {
          const std::uint32_t s = links.sample[i * links.k + b];
          if (s == no_sample)
            break;
          auto found = std::find_if(unions.begin(), unions.end(), [s](const auto& u) {
            return u.first == s;
          });
          if (found == unions.end())
            found = unions.insert(found, {s, {}});
          found->second[l] += links.weight[i * links.k + b];
        }
      }
      add_block(unions);
    }
  }

  std::size_t size() const { return m_size; }
  bool has_normals() const { return !m_normal.empty(); }

  template <class Point_at>
  void set_rest(const Point_at& point)
  {
    pack(point, m_rest);
  }
  template <class Normal_at>
  void set_normals(const Normal_at& normal)
  {
    pack(normal, m_normal);
  }
  void set_sample_points(std::vector<Vec3> sample_points)
  {
    m_sample_points = std::move(sample_points);
  }
  const std::vector<Vec3>& sample_points() const { return m_sample_points; }

  Vec3 rest(std::size_t i) const { return lane(m_rest, i); }
  Vec3 rest_normal(std::size_t i) const { return lane(m_normal, i); }

  /// Calls `write(i, position, normal)` for every point, in blocks side by side; `normal` is zero without normals.
  template <class ConcurrencyTag, class Write>
  void apply(const std::vector<Affine_map>& maps, const Write& write) const
  {
    if (has_normals())
      apply_blocks<ConcurrencyTag, true>(maps, write);
    else
      apply_blocks<ConcurrencyTag, false>(maps, write);
  }

private:
  template <class Vector_at>
  void pack(const Vector_at& vector, std::vector<Lane_vectors>& packed) const
  {
    packed.resize((m_size + lanes - 1) / lanes);
    for (std::size_t i = 0; i < packed.size() * lanes; ++i) {
      const Vec3 v = vector(std::min(i, m_size - 1));
      for (int c = 0; c < 3; ++c)
        packed[i / lanes].value[c][i % lanes] = v[c];
    }
  }

  static Vec3 lane(const std::vector<Lane_vectors>& vectors, std::size_t i)
  {
    const auto& v = vectors[i / lanes].value;
    return {v[0][i % lanes], v[1][i % lanes], v[2][i % lanes]};
  }

  void add_block(std::vector<std::pair<std::uint32_t, std::array<float, lanes>>>& unions)
  {
    // The base is the sample with the largest share; its weight is what the others leave, so weights sum to one.
    std::size_t base = 0;
    float largest = -1;
    for (std::size_t u = 0; u < unions.size(); ++u) {
      float total = 0;
      for (const float w : unions[u].second)
        total += w;
      if (total > largest) {
        largest = total;
        base = u;
      }
    }
    m_base.push_back(unions.empty() ? 0 : unions[base].first);
    for (std::size_t u = 0; u < unions.size(); ++u) {
      if (u == base)
        continue;
      internal::Block_entry entry{unions[u].first, {}};
      for (std::size_t l = 0; l < lanes; ++l)
        entry.weight[l] = static_cast<std::uint16_t>(
            std::lround(65535.0 * static_cast<double>(unions[u].second[l])));
      m_entry.push_back(entry);
    }
    m_first.push_back(static_cast<std::uint32_t>(m_entry.size()));
  }

  template <class ConcurrencyTag, bool HasNormals, class Write>
  void apply_blocks(const std::vector<Affine_map>& maps, const Write& write) const
  {
    auto* blend = &internal::blend_block_default<HasNormals>;
#if PCS_HAS_RUNTIME_DISPATCH
    if (pcs::internal::has_avx2())
      blend = &internal::blend_block_avx2<HasNormals>;
#endif
    pcs::internal::for_each_block<ConcurrencyTag>(
        m_base.size(),
        256,
        [&](std::size_t begin, std::size_t end) {
          Lane_vectors position{}, normal{};
          for (std::size_t block = begin; block < end; ++block) {
            blend(maps.data(),
                  m_base[block],
                  m_sample_points[m_base[block]].data(),
                  m_entry.data() + m_first[block],
                  m_entry.data() + m_first[block + 1],
                  m_rest[block],
                  HasNormals ? &m_normal[block] : nullptr,
                  position,
                  normal);
            const std::size_t count = std::min(lanes, m_size - block * lanes);
            for (std::size_t l = 0; l < count; ++l)
              write(block * lanes + l,
                    Vec3(position.value[0][l], position.value[1][l], position.value[2][l]),
                    Vec3(normal.value[0][l], normal.value[1][l], normal.value[2][l]));
          }
        });
  }

  std::size_t m_size = 0;
  std::vector<Vec3> m_sample_points;
  std::vector<Lane_vectors> m_rest, m_normal;
  std::vector<std::uint32_t> m_base, m_first;
  std::vector<internal::Block_entry> m_entry;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_H

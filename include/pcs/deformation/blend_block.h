// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The inner kernel of upsampling: blends the affine maps of a few samples for eight points.

#ifndef PCS_DEFORMATION_BLEND_BLOCK_H
#define PCS_DEFORMATION_BLEND_BLOCK_H

#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>

#include <cstddef>
#include <cstdint>

namespace pcs {
namespace deformation {

/// The affine map `x -> a x + t` of one sample; `a` row by row.
struct Affine_map
{
  double a[9], t[3];
};

constexpr std::size_t lanes = 8;

/// Coordinates of eight points: x of all, y of all, z of all.
struct Lane_vectors
{
  double value[3][lanes];
};

/// What a kernel computes for every point.
enum class Blend_outputs {
  positions,
  normals,  ///< and normals
  gradients ///< and normals, if the input has them, and the linear part of the blended map
};

struct Block_output
{
  Lane_vectors position, normal;
  double gradient[9][lanes]; ///< row by row
};

/// How the map of a sample differs from that of the base, around the base's position: linear part row by row, then
/// offset. Small numbers, hence in single precision.
struct Map_difference
{
  float value[12];
};

/// Weights are stored in 16 bits, in steps of one over this.
constexpr double weight_steps = 65535;

/// A sample of a block besides its base: which difference, and how much of it for each point.
struct Block_entry
{
  std::uint32_t pair;
  std::uint16_t weight[lanes];
};

struct Block_input
{
  const Affine_map* base;
  const double* origin; ///< position of the base sample at rest
  const Map_difference* differences;
  const Block_entry *entry, *entry_end;
  const Lane_vectors *rest, *normal;
};

/// The difference of `sample` to `base` around `origin`, formed in double precision.
inline Map_difference
map_difference(const Affine_map& base, const Affine_map& sample, const double* origin)
{
  Map_difference result;
  for (int r = 0; r < 3; ++r) {
    double offset = sample.t[r] - base.t[r];
    for (int c = 0; c < 3; ++c) {
      const double difference = sample.a[3 * r + c] - base.a[3 * r + c];
      result.value[3 * r + c] = static_cast<float>(difference);
      offset += difference * origin[c];
    }
    result.value[9 + r] = static_cast<float>(offset);
  }
  return result;
}

namespace internal {

/*!
  Equations (2.4) and (2.5) of the dissertation for one block. With `sum w = 1`,

      sum w_s (A_s p + t_s) = A_b p + t_b + sum w_s ((A_s - A_b) (p - o) + ((A_s - A_b) o + t_s - t_b))

  for any base sample `b` of the block and its position `o`. The first part is computed in double precision; the sum
  holds differences between neighbouring samples only, so that it may be blended in single precision and a rigid
  motion stays exact. Normals get the cofactor matrix of the blended map, and keep their length.
*/
template <Blend_outputs Outputs>
PCS_ALWAYS_INLINE void blend_block(const Block_input& in, Block_output& out)
{
  using pcs::internal::Double4;
  using pcs::internal::Float8;
  using pcs::internal::load;
  using pcs::internal::unroll;
  Float8 m[12] = {};
  for (const Block_entry* entry = in.entry; entry != in.entry_end; ++entry) {
    const float* d = in.differences[entry->pair].value;
    pcs::internal::Uint16x8 steps;
    load(entry->weight, steps);
    Float8 w;
    pcs::internal::to_float(steps, w);
    unroll<12>([&](auto k) PCS_LAMBDA_INLINE { m[k] += w * d[k]; });
  }
  constexpr float unit = static_cast<float>(1 / weight_steps);
  unroll<12>([&](auto k) PCS_LAMBDA_INLINE { m[k] = m[k] * unit; });

  const double* a = in.base->a;
  const double* t = in.base->t;
  unroll<2>([&](auto part) PCS_LAMBDA_INLINE {
    constexpr std::size_t half = 4 * decltype(part)::value;
    Double4 x, y, z, g[12];
    load(in.rest->value[0] + half, x);
    load(in.rest->value[1] + half, y);
    load(in.rest->value[2] + half, z);
    unroll<12>([&](auto k) PCS_LAMBDA_INLINE {
      pcs::internal::to_double<decltype(part)::value>(m[k], g[k]);
    });
    const Double4 qx = x - in.origin[0], qy = y - in.origin[1], qz = z - in.origin[2];
    unroll<3>([&](auto row) PCS_LAMBDA_INLINE {
      constexpr std::size_t r = decltype(row)::value;
      const Double4 correction = g[3 * r] * qx + g[3 * r + 1] * qy + g[3 * r + 2] * qz + g[9 + r];
      const Double4 result = x * a[3 * r] + y * a[3 * r + 1] + z * a[3 * r + 2] + t[r] + correction;
      pcs::internal::store(result, out.position.value[r] + half);
    });
    if constexpr (Outputs != Blend_outputs::positions) {
      unroll<9>([&](auto k) PCS_LAMBDA_INLINE { g[k] = g[k] + a[k]; });
      if constexpr (Outputs == Blend_outputs::gradients) {
        unroll<9>([&](auto k)
                      PCS_LAMBDA_INLINE { pcs::internal::store(g[k], out.gradient[k] + half); });
        if (!in.normal)
          return;
      }
      load(in.normal->value[0] + half, x);
      load(in.normal->value[1] + half, y);
      load(in.normal->value[2] + half, z);
      const Double4 nx = (g[4] * g[8] - g[5] * g[7]) * x + (g[5] * g[6] - g[3] * g[8]) * y +
                         (g[3] * g[7] - g[4] * g[6]) * z;
      const Double4 ny = (g[2] * g[7] - g[1] * g[8]) * x + (g[0] * g[8] - g[2] * g[6]) * y +
                         (g[1] * g[6] - g[0] * g[7]) * z;
      const Double4 nz = (g[1] * g[5] - g[2] * g[4]) * x + (g[2] * g[3] - g[0] * g[5]) * y +
                         (g[0] * g[4] - g[1] * g[3]) * z;
      // A map that crushes the surface to a line leaves no normal: keep a finite value.
      Double4 scale = (x * x + y * y + z * z) / (nx * nx + ny * ny + nz * nz + 1e-290);
      pcs::internal::square_root(scale);
      pcs::internal::store(nx * scale, out.normal.value[0] + half);
      pcs::internal::store(ny * scale, out.normal.value[1] + half);
      pcs::internal::store(nz * scale, out.normal.value[2] + half);
    }
  });
}

template <Blend_outputs Outputs>
void blend_block_default(const Block_input& in, Block_output& out)
{
  blend_block<Outputs>(in, out);
}

#if PCS_HAS_RUNTIME_DISPATCH
template <Blend_outputs Outputs>
PCS_TARGET_AVX2 void blend_block_avx2(const Block_input& in, Block_output& out)
{
  blend_block<Outputs>(in, out);
}
#endif

} // namespace internal

using Blend_block = void (*)(const Block_input&, Block_output&);

/// The kernel for this machine. All give the same bits.
template <Blend_outputs Outputs>
Blend_block choose_blend_block()
{
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx2())
    return &internal::blend_block_avx2<Outputs>;
#endif
  return &internal::blend_block_default<Outputs>;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BLEND_BLOCK_H

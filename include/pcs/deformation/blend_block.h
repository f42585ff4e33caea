// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The inner kernel of upsampling: blends the affine maps of a few samples for eight points.

#ifndef PCS_DEFORMATION_BLEND_BLOCK_H
#define PCS_DEFORMATION_BLEND_BLOCK_H

#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>

#include <cmath>
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

/// Weights are stored in 16 bits, in steps of one over this.
constexpr double weight_steps = 65535;

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

/// How the map of a sample differs from that of the base, around the base's position, per step of weight: linear part
/// row by row, then offset. Small numbers, hence in single precision.
struct Map_difference
{
  float value[12];
};

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
  double frame_unit;          ///< positions are multiplied by it, then
  const double* frame_origin; ///< moved by this
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
      result.value[3 * r + c] = static_cast<float>(difference / weight_steps);
      offset += difference * origin[c];
    }
    result.value[9 + r] = static_cast<float>(offset / weight_steps);
  }
  return result;
}

namespace internal {

/*!
  Equations (2.4) and (2.5) of the dissertation for one block. With `sum w = 1`,

      sum w_s (A_s p + t_s) = (A_b + G) (p - o) + (A_b o + t_b) + g,
      G = sum w_s (A_s - A_b),  g = sum w_s ((A_s - A_b) o + t_s - t_b)

  for any base sample `b` of the block and its position `o`. `G` and `g` hold differences between neighbouring samples
  only, so that they may be blended in single precision and a rigid motion stays exact; the rest is in double
  precision. Normals get the cofactor matrix of the blended map, and keep their length.
*/
template <Blend_outputs Outputs, class Arithmetic>
PCS_ALWAYS_INLINE void blend_block(const Block_input& in, Block_output& out)
{
  using pcs::internal::load;
  using pcs::internal::unroll;
  using Doubles = typename Arithmetic::Doubles;
  constexpr std::size_t width = sizeof(Doubles) / sizeof(double);
  pcs::internal::Lane_sums<Arithmetic, 12> m;
  for (const Block_entry* entry = in.entry; entry != in.entry_end; ++entry)
    m.add(entry->weight, in.differences[entry->pair].value);
  m.finish();

  const double *a = in.base->a, *t = in.base->t, *o = in.origin;
  double center[3];
  for (int r = 0; r < 3; ++r)
    center[r] =
        std::fma(a[3 * r], o[0], std::fma(a[3 * r + 1], o[1], std::fma(a[3 * r + 2], o[2], t[r])));
  unroll<lanes / width>([&](auto part) PCS_LAMBDA_INLINE {
    constexpr std::size_t first = width * decltype(part)::value;
    Doubles x, y, z, g[12];
    load(in.rest->value[0] + first, x);
    load(in.rest->value[1] + first, y);
    load(in.rest->value[2] + first, z);
    x = x - o[0];
    y = y - o[1];
    z = z - o[2];
    unroll<12>([&](auto k) PCS_LAMBDA_INLINE {
      Arithmetic::template to_double<decltype(part)::value>(m.sum[k], g[k]);
      if constexpr (decltype(k)::value < 9)
        g[k] = g[k] + a[k];
    });
    unroll<3>([&](auto row) PCS_LAMBDA_INLINE {
      constexpr std::size_t r = decltype(row)::value;
      Doubles local = g[9 + r] + center[r];
      Arithmetic::fma(g[3 * r + 2], z, local);
      Arithmetic::fma(g[3 * r + 1], y, local);
      Arithmetic::fma(g[3 * r], x, local);
      Doubles unit, written;
      pcs::internal::fill(in.frame_unit, unit);
      pcs::internal::fill(in.frame_origin[r], written);
      Arithmetic::fma(local, unit, written);
      pcs::internal::store(written, out.position.value[r] + first);
    });
    if constexpr (Outputs != Blend_outputs::positions) {
      if constexpr (Outputs == Blend_outputs::gradients) {
        unroll<9>([&](auto k)
                      PCS_LAMBDA_INLINE { pcs::internal::store(g[k], out.gradient[k] + first); });
        if (!in.normal)
          return;
      }
      load(in.normal->value[0] + first, x);
      load(in.normal->value[1] + first, y);
      load(in.normal->value[2] + first, z);
      Doubles turned[3];
      unroll<3>([&](auto row) PCS_LAMBDA_INLINE { // of the cofactor matrix
        constexpr std::size_t r = 3 * ((decltype(row)::value + 1) % 3);
        constexpr std::size_t s = 3 * ((decltype(row)::value + 2) % 3);
        Doubles cx = -(g[r + 2] * g[s + 1]), cy = -(g[r] * g[s + 2]), cz = -(g[r + 1] * g[s]);
        Arithmetic::fma(g[r + 1], g[s + 2], cx);
        Arithmetic::fma(g[r + 2], g[s], cy);
        Arithmetic::fma(g[r], g[s + 1], cz);
        Doubles& n = turned[row];
        n = cx * x;
        Arithmetic::fma(cy, y, n);
        Arithmetic::fma(cz, z, n);
      });
      // Length over new length; where a map crushes the surface to a line, the normal becomes zero.
      Doubles squared = x * x, new_squared = turned[0] * turned[0], product, scale;
      Arithmetic::fma(y, y, squared);
      Arithmetic::fma(z, z, squared);
      Arithmetic::fma(turned[1], turned[1], new_squared);
      Arithmetic::fma(turned[2], turned[2], new_squared);
      pcs::internal::fill(1e-290, product);
      Arithmetic::fma(squared, new_squared, product);
      pcs::internal::reciprocal_root<Arithmetic>(product, scale);
      scale = scale * squared;
      unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
        pcs::internal::store(Doubles(turned[r] * scale), out.normal.value[r] + first);
      });
    }
  });
}

template <Blend_outputs Outputs>
void blend_block_default(const Block_input& in, Block_output& out)
{
  blend_block<Outputs, pcs::internal::Portable_arithmetic>(in, out);
}

#if PCS_HAS_RUNTIME_DISPATCH
template <Blend_outputs Outputs>
PCS_TARGET_AVX2 void blend_block_avx2(const Block_input& in, Block_output& out)
{
  blend_block<Outputs, pcs::internal::Avx2_arithmetic>(in, out);
}
#endif

#ifdef PCS_HAS_AVX_ASSEMBLY
template <Blend_outputs Outputs>
PCS_TARGET_AVX512 void blend_block_avx512(const Block_input& in, Block_output& out)
{
  blend_block<Outputs, pcs::internal::Avx512_arithmetic>(in, out);
}
#endif

} // namespace internal

using Blend_block = void (*)(const Block_input&, Block_output&);

/// The kernel for this machine. All give the same bits.
template <Blend_outputs Outputs>
Blend_block choose_blend_block()
{
#ifdef PCS_HAS_AVX_ASSEMBLY
  if (pcs::internal::has_avx512())
    return &internal::blend_block_avx512<Outputs>;
#endif
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx2())
    return &internal::blend_block_avx2<Outputs>;
#endif
  return &internal::blend_block_default<Outputs>;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BLEND_BLOCK_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of blend_block.h: the kernels for the instruction sets.

#ifndef PCS_DEFORMATION_UPSAMPLING_BLEND_BLOCK_IMPL_H
#define PCS_DEFORMATION_UPSAMPLING_BLEND_BLOCK_IMPL_H

#include <pcs/deformation/upsampling/blend_block.h>
#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>

#include <algorithm>
#include <cstddef>

namespace pcs {
namespace deformation {

namespace internal {

/// Three coordinates of the points of one register, from `first` on.
template <class Doubles>
PCS_ALWAYS_INLINE void load_vectors(const Lane_vectors& from, std::size_t first, Doubles* v)
{
  pcs::internal::unroll<3>(
      [&](auto c) PCS_LAMBDA_INLINE { pcs::internal::load(from.value[c] + first, v[c]); });
}

/// `image += row . v`, where the row is the same for all points.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void add_image(const double* row, const Doubles* v, Doubles& image)
{
  pcs::internal::unroll<3>([&](auto c) PCS_LAMBDA_INLINE { Arithmetic::fma(row[c], v[c], image); });
}

template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void squared_length(const Doubles* v, Doubles& result)
{
  result = v[0] * v[0];
  Arithmetic::fma(v[1], v[1], result);
  Arithmetic::fma(v[2], v[2], result);
}

inline constexpr double smallest_square = 1e-290;

/// Computes the factor that changes the length of `v` to the root of `squared`. The factor is
/// finite where `v` is zero.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void scale_to_length(const Doubles& squared, const Doubles* v, Doubles& scale)
{
  Doubles present, product;
  squared_length<Arithmetic>(v, present);
  Arithmetic::fill(smallest_square, product);
  Arithmetic::fma(squared, present, product);
  pcs::internal::reciprocal_root<Arithmetic>(product, scale);
  scale = scale * squared;
}

/// `result = cofactor matrix of g, times v`. With columns `a`, `b`, `c` of `g`, this is
/// `v_x (b x c) + v_y (c x a) + v_z (a x b) = b x (v_x c - v_z a) + (v_y c) x a`.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void multiply_by_cofactors(const Doubles* g, const Doubles* v, Doubles* result)
{
  Doubles left[3], right[3];
  pcs::internal::unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
    left[r] = v[0] * g[3 * r + 2];
    Arithmetic::subtract_product(v[2], g[3 * r], left[r]);
    right[r] = v[1] * g[3 * r + 2];
  });
  pcs::internal::unroll<3>([&](auto row) PCS_LAMBDA_INLINE {
    constexpr std::size_t s = (decltype(row)::value + 1) % 3, t = (decltype(row)::value + 2) % 3;
    Doubles& n = result[row];
    n = right[s] * g[3 * t];
    Arithmetic::subtract_product(right[t], g[3 * s], n);
    Arithmetic::fma(g[3 * s + 1], left[t], n);
    Arithmetic::subtract_product(g[3 * t + 1], left[s], n);
  });
}

/// Converts positions to the caller's coordinates.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void store_positions(const Block_input& in,
                                       const Doubles* position,
                                       std::size_t first,
                                       Block_output& out)
{
  pcs::internal::unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
    Doubles written;
    Arithmetic::fill(in.frame_origin[r], written);
    Arithmetic::fma(in.frame_unit, position[r], written);
    pcs::internal::store(written, out.position.value[r] + first);
  });
}

/// Moves a block with one handle.
template <Blend_outputs Outputs, class Arithmetic>
PCS_ALWAYS_INLINE void carry_block(const Block_input& in, Block_output& out)
{
  using pcs::internal::store;
  using pcs::internal::unroll;
  using Doubles = typename Arithmetic::Doubles;
  constexpr std::size_t width = sizeof(Doubles) / sizeof(double);
  const Handle_map& holder = *in.holder;
  unroll<lanes / width>([&](auto part) PCS_LAMBDA_INLINE {
    constexpr std::size_t first = width * decltype(part)::value;
    Doubles v[3], image[3];
    load_vectors(*in.rest, first, v);
    unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
      Arithmetic::fill(holder.map.t[r], image[r]);
      add_image<Arithmetic>(holder.map.a + 3 * r, v, image[r]);
    });
    store_positions<Arithmetic>(in, image, first, out);
    if constexpr (Outputs != Blend_outputs::positions) {
      if (Outputs == Blend_outputs::normals || in.normal) {
        load_vectors(*in.normal, first, v);
        unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
          Doubles turned{};
          add_image<Arithmetic>(holder.turn + 3 * r, v, turned);
          store(turned, out.normal.value[r] + first);
        });
      }
    }
    if constexpr (Outputs == Blend_outputs::gradients)
      unroll<9>([&](auto k) PCS_LAMBDA_INLINE {
        Doubles all;
        Arithmetic::fill(holder.map.a[k], all);
        store(all, out.gradient[k] + first);
      });
  });
}

/// Computes the blended map of the points of one register, about the base's position at rest:
/// linear part `g`, row by row, and `position`.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void
blend_maps(const Block_input& in, std::size_t first, Doubles* g, Doubles* position)
{
  using pcs::internal::unroll;
  unroll<9>([&](auto k) PCS_LAMBDA_INLINE { Arithmetic::fill(in.base->a[k], g[k]); });
  unroll<3>([&](auto r) PCS_LAMBDA_INLINE { Arithmetic::fill(in.base->center[r], position[r]); });
  for (const Block_entry* entry = in.entry; entry != in.entry_end; ++entry) {
    const double* difference = in.differences[entry->pair].value;
    Doubles weight;
    Arithmetic::to_doubles(entry->weight + first, weight);
    unroll<9>([&](auto k) PCS_LAMBDA_INLINE { Arithmetic::fma(difference[k], weight, g[k]); });
    unroll<3>([&](auto r)
                  PCS_LAMBDA_INLINE { Arithmetic::fma(difference[9 + r], weight, position[r]); });
  }
}

/// Adds `g` times the offset of the points from the base.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void
add_offsets(const Block_input& in, std::size_t first, const Doubles* g, Doubles* position)
{
  using pcs::internal::unroll;
  Doubles v[3];
  load_vectors(*in.rest, first, v);
  unroll<3>([&](auto c) PCS_LAMBDA_INLINE { Arithmetic::subtract(in.base->origin[c], v[c]); });
  unroll<3>([&](auto row) PCS_LAMBDA_INLINE {
    constexpr std::size_t r = decltype(row)::value;
    Arithmetic::fma(g[3 * r + 2], v[2], position[r]);
    Arithmetic::fma(g[3 * r + 1], v[1], position[r]);
    Arithmetic::fma(g[3 * r], v[0], position[r]);
  });
}

/// Blends positions towards the handles.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void fade_positions(const Block_input& in, std::size_t first, Doubles* position)
{
  Doubles v[3];
  for (const Block_fade* f = in.fade; f != in.fade_end; ++f) {
    const Affine_map& map = in.handles[f->handle].map;
    Doubles weight;
    pcs::internal::load(f->weight + first, weight);
    load_vectors(*in.rest, first, v);
    pcs::internal::unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
      Doubles target;
      Arithmetic::fill(map.t[r], target);
      add_image<Arithmetic>(map.a + 3 * r, v, target);
      Arithmetic::fma(weight, Doubles(target - position[r]), position[r]);
    });
  }
}

/// Blends the normals `turned` towards the handles; `v` are the normals at rest.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void
fade_normals(const Block_input& in, std::size_t first, const Doubles* v, Doubles* turned)
{
  for (const Block_fade* f = in.fade; f != in.fade_end; ++f) {
    Doubles weight, rest_weight;
    pcs::internal::load(f->weight + first, weight);
    rest_weight = 1.0 - weight;
    pcs::internal::unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
      Doubles target{};
      add_image<Arithmetic>(in.handles[f->handle].turn + 3 * r, v, target);
      turned[r] = turned[r] * rest_weight;
      Arithmetic::fma(weight, target, turned[r]);
    });
  }
}

/// Changes the length of `v` to the root of `squared`.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void set_length(const Doubles& squared, Doubles* v)
{
  Doubles scale;
  scale_to_length<Arithmetic>(squared, v, scale);
  pcs::internal::unroll<3>([&](auto r) PCS_LAMBDA_INLINE { v[r] = v[r] * scale; });
}

/// Maps normals by the cofactor matrix of `g` and blends them towards the handles, with unchanged
/// length.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void
blend_normals(const Block_input& in, std::size_t first, const Doubles* g, Block_output& out)
{
  Doubles v[3], turned[3], squared;
  load_vectors(*in.normal, first, v);
  squared_length<Arithmetic>(v, squared);
  multiply_by_cofactors<Arithmetic>(g, v, turned);
  set_length<Arithmetic>(squared, turned);
  if (in.fade != in.fade_end) {
    fade_normals<Arithmetic>(in, first, v, turned);
    set_length<Arithmetic>(squared, turned);
  }
  pcs::internal::unroll<3>([&](auto r) PCS_LAMBDA_INLINE {
    pcs::internal::store(turned[r], out.normal.value[r] + first);
  });
}

/// Blends the gradients `g` towards the handles, and stores them.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void
store_gradients(const Block_input& in, std::size_t first, Doubles* g, Block_output& out)
{
  pcs::internal::unroll<9>([&](auto k) PCS_LAMBDA_INLINE {
    for (const Block_fade* f = in.fade; f != in.fade_end; ++f) {
      Doubles weight, target;
      pcs::internal::load(f->weight + first, weight);
      Arithmetic::fill(in.handles[f->handle].map.a[k], target);
      Arithmetic::fma(weight, Doubles(target - g[k]), g[k]);
    }
    pcs::internal::store(g[k], out.gradient[k] + first);
  });
}

/*!
  Implements equations (2.4) and (2.5) of [Aiteanu 2022] for one block. With `sum w = 1`,

      sum w_s (A_s p + t_s) = (A_b + G) (p - o) + (A_b o + t_b) + g,
      G = sum w_s (A_s - A_b),  g = sum w_s ((A_s - A_b) o + t_s - t_b)

  for any base sample `b` of the block and its position `o`. The sum has one term less, and rigid
  motions remain exact, because all differences are zero. Normals are mapped by the cofactor matrix
  of the blended map, with unchanged length. Finally, points near handles are blended towards them.
*/
template <Blend_outputs Outputs, class Arithmetic>
PCS_ALWAYS_INLINE void blend_block(const Block_input& in, Block_output& out)
{
  using Doubles = typename Arithmetic::Doubles;
  constexpr std::size_t width = sizeof(Doubles) / sizeof(double);
  if (in.holder) {
    carry_block<Outputs, Arithmetic>(in, out);
    return;
  }
  pcs::internal::unroll<lanes / width>([&](auto part) PCS_LAMBDA_INLINE {
    constexpr std::size_t first = width * decltype(part)::value;
    Doubles g[9], position[3];
    blend_maps<Arithmetic>(in, first, g, position);
    add_offsets<Arithmetic>(in, first, g, position);
    fade_positions<Arithmetic>(in, first, position);
    store_positions<Arithmetic>(in, position, first, out);
    if constexpr (Outputs != Blend_outputs::positions) {
      if (Outputs == Blend_outputs::normals || in.normal)
        blend_normals<Arithmetic>(in, first, g, out);
    }
    if constexpr (Outputs == Blend_outputs::gradients)
      store_gradients<Arithmetic>(in, first, g, out);
  });
}

template <Blend_outputs Outputs>
void blend_block_default(const Block_input& in, Block_output& out)
{
  blend_block<Outputs, pcs::internal::Narrow_arithmetic>(in, out);
}

#if PCS_HAS_RUNTIME_DISPATCH
template <Blend_outputs Outputs>
PCS_TARGET_AVX2 void blend_block_avx2(const Block_input& in, Block_output& out)
{
  blend_block<Outputs, pcs::internal::Avx2_arithmetic>(in, out);
}

template <Blend_outputs Outputs>
PCS_TARGET_AVX512 void blend_block_avx512(const Block_input& in, Block_output& out)
{
  blend_block<Outputs, pcs::internal::Avx512_arithmetic>(in, out);
}
#endif

} // namespace internal

template <Blend_outputs Outputs>
Blend_block choose_blend_block()
{
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx512())
    return &internal::blend_block_avx512<Outputs>;
  if (pcs::internal::has_avx2())
    return &internal::blend_block_avx2<Outputs>;
#endif
  return &internal::blend_block_default<Outputs>;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_BLEND_BLOCK_IMPL_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Upsampling kernel: linear blending of the affine maps of samples, for eight points at a time.

#ifndef PCS_DEFORMATION_UPSAMPLING_BLEND_BLOCK_H
#define PCS_DEFORMATION_UPSAMPLING_BLEND_BLOCK_H

#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Point_blocks.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace pcs {
namespace deformation {

/// The output of a kernel for every point.
enum class Blend_outputs {
  positions,
  normals,  ///< positions and normals
  gradients ///< positions, normals if given, and the linear part of the blended map
};

struct Block_output
{
  Lane_vectors position, normal;
  double gradient[9][lanes]; ///< row by row
};

/// The map of a sample around its position at rest: `x -> a (x - origin) + center`.
struct Base_map
{
  double a[9], origin[3], center[3];
};

/// Difference between the maps of a sample and of the base, about the position of the base, per
/// step of weight: linear part row by row, then offset.
struct Map_difference
{
  double value[12];
};

/// A sample of a block besides its base: the index of its difference, and its weight at each point.
struct Block_entry
{
  std::uint32_t pair;
  std::uint16_t weight[lanes];
};

/// Blend weights of the points of a block towards one handle; zero for unaffected points.
struct Block_fade
{
  std::uint32_t handle;
  double weight[lanes];
};

struct Block_input
{
  const Base_map* base;
  const Map_difference* differences;
  const Block_entry *entry, *entry_end;
  const Lane_vectors *rest, *normal;
  double frame_unit;          ///< factor of positions
  const double* frame_origin; ///< added to scaled positions
  const Block_fade *fade, *fade_end;
  const Handle_map* handles;
  const Handle_map*
      holder; ///< the handle that moves all points of the block instead of the samples; or null
};

inline Base_map base_map(const Affine_map& map, const double* origin)
{
  Base_map result;
  std::copy_n(map.a, 9, result.a);
  std::copy_n(origin, 3, result.origin);
  for (int r = 0; r < 3; ++r) {
    result.center[r] = map.t[r];
    for (int c = 0; c < 3; ++c)
      result.center[r] += map.a[3 * r + c] * origin[c];
  }
  return result;
}

inline Map_difference
map_difference(const Affine_map& base, const Affine_map& sample, const double* origin)
{
  Map_difference result;
  for (int r = 0; r < 3; ++r) {
    double offset = sample.t[r] - base.t[r];
    for (int c = 0; c < 3; ++c) {
      const double difference = sample.a[3 * r + c] - base.a[3 * r + c];
      result.value[3 * r + c] = difference / weight_steps;
      offset += difference * origin[c];
    }
    result.value[9 + r] = offset / weight_steps;
  }
  return result;
}

using Blend_block = void (*)(const Block_input&, Block_output&);

/*!
  Returns the kernel for this machine. All kernels give the same bits. A point `p` moves to

      p' = sum_s w_s (A_s p + t_s),  sum_s w_s = 1,

  over the samples `s` of its block, with stored weights `w_s` in steps of `1 / weight_steps`. These
  are equations (2.4) and (2.5) of [Aiteanu 2022], with affine maps of samples instead of rotations.
  Points near a handle `h` then become `p' + f_h (A_h p + t_h - p')`, one handle after the other.
*/
template <Blend_outputs Outputs>
Blend_block choose_blend_block();

} // namespace deformation
} // namespace pcs

#ifndef PCS_COMPILED_DEFORMATION
#include <pcs/deformation/upsampling/blend_block_impl.h>
#endif

#endif // PCS_DEFORMATION_UPSAMPLING_BLEND_BLOCK_H

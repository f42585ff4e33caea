// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Layout of points in blocks of eight, one lane of a vector register per point; stored weights.

#ifndef PCS_DEFORMATION_MODEL_POINT_BLOCKS_H
#define PCS_DEFORMATION_MODEL_POINT_BLOCKS_H

#include <pcs/deformation/model/Affine_map.h>
#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/parallel.h>

#include <CGAL/tags.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace pcs {
namespace deformation {

/// Number of points in a block [count].
constexpr std::size_t lanes = 8;

/// Coordinates of the points of a block: x of all, y of all, z of all.
struct Lane_vectors
{
  double value[3][lanes];
};

/// The weights of samples are stored in 16 bits, in steps of `1 / weight_steps`.
constexpr double weight_steps = 65535;

/// Values for blocks that no single handle holds (`mixed_block`), and for blocks in which no point
/// moves (`still_block`).
constexpr std::int32_t mixed_block = -1, still_block = -2;

/// Points at rest, and normals if there are any, of 24 bytes each. The last block is filled up with
/// copies of the last point.
class Point_blocks
{
public:
  Point_blocks() = default;

  /// Points without positions, which may have normals.
  explicit Point_blocks(std::size_t n) : m_size(n) {}

  /// \param position `position(i)` is the position of point `i` in `[0, n)`
  template <class Vector_at>
  Point_blocks(std::size_t n, const Vector_at& position) : m_size(n)
  {
    set_positions(position);
  }

  /// The same, with concurrent calls of `position`.
  template <class ConcurrencyTag, class Vector_at>
  static Point_blocks of(std::size_t n, const Vector_at& position)
  {
    Point_blocks result;
    result.m_size = n;
    result.pack<ConcurrencyTag>(position, result.m_positions);
    return result;
  }

  std::size_t size() const { return m_size; }
  std::size_t number_of_blocks() const { return (m_size + lanes - 1) / lanes; }
  bool has_positions() const { return !m_positions.empty(); }
  bool has_normals() const { return !m_normals.empty(); }

  template <class Vector_at>
  void set_positions(const Vector_at& position)
  {
    pack<CGAL::Sequential_tag>(position, m_positions);
  }
  void forget_positions() { m_positions = Blocks(); }
  template <class Vector_at>
  void set_normals(const Vector_at& normal)
  {
    pack<CGAL::Sequential_tag>(normal, m_normals);
  }

  Vec3 position(std::size_t i) const { return lane(m_positions, i); }
  Vec3 normal(std::size_t i) const { return lane(m_normals, i); }

  const Lane_vectors& positions(std::size_t block) const { return m_positions[block]; }
  /// Must only be called if there are normals.
  const Lane_vectors& normals(std::size_t block) const { return m_normals[block]; }

private:
  using Blocks = pcs::internal::Huge_vector<Lane_vectors>;

  template <class ConcurrencyTag, class Vector_at>
  void pack(const Vector_at& vector, Blocks& packed) const
  {
    packed.resize(number_of_blocks());
    pcs::internal::for_each_index<ConcurrencyTag>(packed.size(), [&](std::size_t block) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const Vec3 v = vector(std::min(block * lanes + l, m_size - 1));
        for (int c = 0; c < 3; ++c)
          packed[block].value[c][l] = v[c];
      }
    });
  }

  static Vec3 lane(const Blocks& vectors, std::size_t i)
  {
    const auto& v = vectors[i / lanes].value;
    return {v[0][i % lanes], v[1][i % lanes], v[2][i % lanes]};
  }

  std::size_t m_size = 0;
  Blocks m_positions, m_normals;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_POINT_BLOCKS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Surface normals of all points, from two rings of neighbours of each.

#ifndef PCS_NEIGHBORHOOD_SURFACE_NORMALS_H
#define PCS_NEIGHBORHOOD_SURFACE_NORMALS_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/spatial_order.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace neighborhood {

/// A neighbourhood has a normal if it is flat and wide. It is flat if its smallest eigenvalue is
/// below `largest_thickness` times the middle one, and wide if the middle one exceeds
/// `smallest_width` times the largest one.
constexpr double largest_thickness = 0.7;
constexpr double smallest_width = 0.02;

namespace internal {

/// The direction of a surface normal, and its confidence in [0, 1] as the last coordinate.
using Surface_normal = pcs::internal::Float4;

/// Sum and second moments of a point and its neighbours, relative to the point. Single precision
/// suffices for differences and halves the largest array of the construction.
struct Ring_moments
{
  using Float4 = pcs::internal::Float4;

  Float4 sum{};      ///< x, y, z, and the count
  Float4 squares{};  ///< xx, yy, zz
  Float4 products{}; ///< xy, yz, zx

  /// Adds a point. The last coordinate of `e` is 1.
  PCS_ALWAYS_INLINE void add_point(const Float4& e)
  {
    sum = sum + e;
    squares = squares + e * e;
    products = products + e * pcs::internal::rotated(e);
  }

  /// Adds the moments `other`, taken about a point at `offset` from this one. The last coordinate
  /// of `offset` is 0.
  PCS_ALWAYS_INLINE void add(const Ring_moments& other, const Float4& offset)
  {
    // The mixed terms of (p + o)(p + o)^T are s o^T + o s^T + n o o^T.
    const float count = other.sum[3];
    const Float4 half = other.sum + (0.5f * count) * offset;
    const Float4 next = pcs::internal::rotated(offset);
    sum = sum + (other.sum + count * offset);
    squares = squares + (other.squares + 2.0f * half * offset);
    products = products + (other.products + half * next + offset * pcs::internal::rotated(half));
  }
};

/// The same without padding, since they are the largest array of the construction.
struct Packed_moments
{
  float value[10]; ///< sum, squares, products, count

  PCS_ALWAYS_INLINE void pack(const Ring_moments& m)
  {
    for (std::size_t k = 0; k < 3; ++k) {
      value[k] = m.sum[k];
      value[3 + k] = m.squares[k];
      value[6 + k] = m.products[k];
    }
    value[9] = m.sum[3];
  }

  PCS_ALWAYS_INLINE void unpack(Ring_moments& m) const
  {
    pcs::internal::load(value, m.sum);
    pcs::internal::load(value + 3, m.squares); // the last coordinates of these are not used
    pcs::internal::load(value + 6, m.products);
    m.sum[3] = value[9];
  }
};

/// The moments of eight points, the same coordinate of all points together.
struct Block_moments
{
  static constexpr std::size_t size = 8;
  float sum[4][size], squares[3][size], products[3][size];
};

/// Arithmetic on as many doubles as a register has.
template <class Doubles>
struct Normal_lanes
{
  static constexpr std::size_t size = sizeof(Doubles) / sizeof(double);

  static PCS_ALWAYS_INLINE void load(const float* from, Doubles& to)
  {
    for (std::size_t l = 0; l < size; ++l)
      to[l] = double(from[l]);
  }
  static PCS_ALWAYS_INLINE void root(const Doubles& x, Doubles& to)
  {
    for (std::size_t l = 0; l < size; ++l)
      to[l] = std::sqrt(x[l]);
  }
  static PCS_ALWAYS_INLINE void cross(const Doubles* a, const Doubles* b, Doubles* c)
  {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
  }
  static PCS_ALWAYS_INLINE void squared_norm(const Doubles* a, Doubles& to)
  {
    to = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  }
  /// Replaces `c` by `other`, if that is longer. `n` and `other_n` are squared lengths.
  static PCS_ALWAYS_INLINE void
  take_longer(const Doubles* other, const Doubles& other_n, Doubles* c, Doubles& n)
  {
    for (std::size_t k = 0; k < 3; ++k)
      pcs::internal::select_less(n, other_n, other[k], c[k], c[k]);
    pcs::internal::select_less(n, other_n, other_n, n, n);
  }

  /// The matrices of second moments about the mean, divided by their traces. Their rows are
  /// (d0 p0 p2), (p0 d1 p1) and (p2 p1 d2).
  struct Matrices
  {
    Doubles d[3], p[3];
  };

  static PCS_ALWAYS_INLINE void read(const Block_moments& m, std::size_t first, Matrices& a)
  {
    Doubles s[4], zero{}, one;
    pcs::internal::fill(1.0, one);
    for (std::size_t k = 0; k < 4; ++k)
      load(m.sum[k] + first, s[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      load(m.squares[k] + first, a.d[k]);
      load(m.products[k] + first, a.p[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      a.d[k] = a.d[k] - s[k] * s[k] / s[3];
      a.p[k] = a.p[k] - s[k] * s[(k + 1) % 3] / s[3];
    }
    Doubles trace = a.d[0] + a.d[1] + a.d[2];
    pcs::internal::select_less(zero, trace, trace, one, trace);
    for (std::size_t k = 0; k < 3; ++k) {
      a.d[k] = a.d[k] / trace;
      a.p[k] = a.p[k] / trace;
    }
  }

  /// Finds the eigenvalues. The smallest one is the limit of Newton's method from 0 for the
  /// characteristic polynomial, which is slow only for multiple eigenvalues, without a plane.
  static PCS_ALWAYS_INLINE void
  find_eigenvalues(const Matrices& a, Doubles& least, Doubles& middle, Doubles& largest)
  {
    const Doubles *d = a.d, *p = a.p, zero{};
    const Doubles minors =
        d[0] * d[1] - p[0] * p[0] + d[1] * d[2] - p[1] * p[1] + d[2] * d[0] - p[2] * p[2];
    const Doubles determinant = d[0] * (d[1] * d[2] - p[1] * p[1]) -
                                p[0] * (p[0] * d[2] - p[1] * p[2]) +
                                p[2] * (p[0] * p[1] - d[1] * p[2]);
    constexpr int number_of_steps = 8;
    least = zero;
    for (int step = 0; step < number_of_steps; ++step) {
      const Doubles value = ((least - 1.0) * least + minors) * least - determinant;
      const Doubles slope = (3.0 * least - 2.0) * least + minors;
      Doubles change = -value / slope;
      pcs::internal::select_less(zero, change, change, zero, change); // rounding
      least = least + change;
    }
    const Doubles sum = 1.0 - least, product = minors - least * sum;
    Doubles difference = sum * sum - 4.0 * product;
    pcs::internal::select_less(difference, zero, zero, difference, difference);
    root(difference, difference);
    largest = 0.5 * (sum + difference);
    middle = sum - largest;
  }

  /// Finds vectors perpendicular to the rows of the matrices minus an eigenvalue.
  static PCS_ALWAYS_INLINE void
  find_eigenvectors(const Matrices& a, const Doubles& value, Doubles* c, Doubles& length)
  {
    const Doubles *d = a.d, *p = a.p;
    const Doubles r0[3] = {d[0] - value, p[0], p[2]}, r1[3] = {p[0], d[1] - value, p[1]},
                  r2[3] = {p[2], p[1], d[2] - value};
    Doubles other[3], other_length;
    cross(r0, r1, c);
    squared_norm(c, length);
    cross(r1, r2, other);
    squared_norm(other, other_length);
    take_longer(other, other_length, c, length);
    cross(r2, r0, other);
    squared_norm(other, other_length);
    take_longer(other, other_length, c, length);
    root(length, length);
  }

  /// Computes the normals of the planes of points with moments `m`. The confidence of a normal is 0
  /// if the points are on no plane.
  static PCS_ALWAYS_INLINE void
  find(const Block_moments& m, std::size_t first, Surface_normal* normal)
  {
    Matrices a;
    Doubles least, middle, largest, c[3], length;
    read(m, first, a);
    find_eigenvalues(a, least, middle, largest);
    find_eigenvectors(a, least, c, length);
    for (std::size_t l = 0; l < size; ++l) {
      Surface_normal result{};
      const bool is_plane = middle[l] > smallest_width * largest[l] &&
                            least[l] < largest_thickness * middle[l] && length[l] > 0;
      if (is_plane) {
        for (std::size_t k = 0; k < 3; ++k)
          result[k] = static_cast<float>(c[k][l] / length[l]);
        result[3] = static_cast<float>(1 - least[l] / (largest_thickness * middle[l]));
      }
      normal[first + l] = result;
    }
  }
};

inline void find_normals_plain(const Block_moments& m, Surface_normal* normal)
{
  for (std::size_t first = 0; first < Block_moments::size; first += 2)
    Normal_lanes<pcs::internal::Double2>::find(m, first, normal);
}

#if PCS_HAS_RUNTIME_DISPATCH
PCS_TARGET_AVX2_UNFUSED inline void find_normals_avx2(const Block_moments& m,
                                                      Surface_normal* normal)
{
  for (std::size_t first = 0; first < Block_moments::size; first += 4)
    Normal_lanes<pcs::internal::Double4>::find(m, first, normal);
}
#endif

/// Returns the kernel for this machine. All give the same bits.
inline void (*choose_find_normals())(const Block_moments&, Surface_normal*)
{
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx2())
    return &find_normals_avx2;
#endif
  return &find_normals_plain;
}

/// Returns the inverse of the root mean square length of the edges of some points. Lengths in this
/// unit have squares in the range of a float.
inline double unit_of_edges(const std::vector<Vec3>& points, const Proximity_graph& graph)
{
  constexpr std::size_t stride = 16;
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < points.size(); i += stride)
    for (auto j = graph.begin(i); j != graph.end(i); ++j) {
      sum += (points[*j] - points[i]).squaredNorm();
      count += 1;
    }
  return sum > 0 ? std::sqrt(count / sum) : 1;
}

PCS_ALWAYS_INLINE pcs::internal::Float4
scaled_edge(const Vec3& from, const Vec3& to, double scale, float last)
{
  return pcs::internal::Float4{static_cast<float>(scale * (to[0] - from[0])),
                               static_cast<float>(scale * (to[1] - from[1])),
                               static_cast<float>(scale * (to[2] - from[2])),
                               last};
}

/// Returns the moments of each point and its neighbours, in units of `1 / scale`.
template <class ConcurrencyTag>
pcs::internal::Huge_vector<Packed_moments>
ring_moments(const std::vector<Vec3>& points, const Proximity_graph& graph, double scale)
{
  pcs::internal::Huge_vector<Packed_moments> ring(points.size());
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    Ring_moments m;
    m.sum[3] = 1;
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      m.add_point(scaled_edge(points[i], points[*j], scale, 1));
    ring[i].pack(m);
  });
  return ring;
}

/// Estimates normals from two rings of neighbours; a point counts once per path to it. Links
/// between two parallel sheets hardly change the result, because both sheets have the same normal.
template <class ConcurrencyTag>
pcs::internal::Huge_vector<Surface_normal> surface_normals(const std::vector<Vec3>& points,
                                                           const Proximity_graph& graph)
{
  const double scale = unit_of_edges(points, graph);
  const auto ring = ring_moments<ConcurrencyTag>(points, graph, scale);
  const auto find_normals = choose_find_normals();
  constexpr std::size_t block = Block_moments::size;
  const std::size_t n = points.size(), number_of_blocks = (n + block - 1) / block;
  pcs::internal::Huge_vector<Surface_normal> normal(number_of_blocks * block);
  pcs::internal::for_each_index<ConcurrencyTag>(
      number_of_blocks,
      [&](std::size_t b) {
        Block_moments moments;
        for (std::size_t l = 0; l < block; ++l) {
          const std::size_t i = std::min(b * block + l, n - 1);
          Ring_moments m, other;
          ring[i].unpack(m);
          for (auto j = graph.begin(i); j != graph.end(i); ++j) {
            ring[*j].unpack(other);
            m.add(other, scaled_edge(points[i], points[*j], scale, 0));
          }
          for (std::size_t k = 0; k < 4; ++k)
            moments.sum[k][l] = m.sum[k];
          for (std::size_t k = 0; k < 3; ++k) {
            moments.squares[k][l] = m.squares[k];
            moments.products[k][l] = m.products[k];
          }
        }
        find_normals(moments, normal.data() + b * block);
      },
      128);
  for (std::size_t i = 0; i < n; ++i) // a point and one neighbour span no plane
    if (graph.degree(i) < 2)
      normal[i] = Surface_normal{};
  return normal;
}

/// Averages the normals of each neighbourhood by confidence, up to sign. At the boundary of a
/// sheet, half of the neighbourhood is missing, and a single estimate may be tangent to the sheet.
template <class ConcurrencyTag>
pcs::internal::Huge_vector<Surface_normal>
settled_normals(const Proximity_graph& graph,
                const pcs::internal::Huge_vector<Surface_normal>& normal)
{
  pcs::internal::Huge_vector<Surface_normal> settled(normal.size());
  pcs::internal::for_each_index<ConcurrencyTag>(graph.size(), [&](std::size_t i) {
    std::size_t best = i;
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      best = normal[*j][3] > normal[best][3] ? *j : best;
    const Surface_normal reference = normal[best];
    Surface_normal sum{};
    const auto add = [&](const Surface_normal& n) PCS_LAMBDA_INLINE {
      const Surface_normal product = n * reference;
      const float cosine = product[0] + product[1] + product[2];
      sum = sum + std::copysign(n[3] * n[3], cosine) * n; // without a branch
    };
    add(normal[i]);
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      add(normal[*j]);
    const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    settled[i] = Surface_normal{};
    if (!(length > 0))
      return;
    settled[i] = sum * (1 / length);
    settled[i][3] = std::sqrt(length / static_cast<float>(graph.degree(i) + 1));
  });
  return settled;
}

} // namespace internal

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_SURFACE_NORMALS_H

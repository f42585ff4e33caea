// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removes links of a neighbour graph that jump from one sheet of a surface to another.

#ifndef PCS_NEIGHBORHOOD_DROP_SHORT_CUTS_H
#define PCS_NEIGHBORHOOD_DROP_SHORT_CUTS_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace neighborhood {

/// A link is a short-cut candidate if the sine of its angle to the tangent planes at both ends is
/// at least this value. On sheets 1.5 spacings apart with jitter up to 0.3 spacings, the value 0.5
/// removes all 2,720 links between sheets, and 0.45 and 0.6 do not. Bars and scans lose at most
/// 0.2 % of their links. [-]
constexpr double smallest_short_cut_sine = 0.5;
/// Candidate links of a point are kept if it has fewer other links than this, because such a point
/// is an outlier. [count]
constexpr std::size_t smallest_remaining_degree = 2;
/// A component of at most this many points that is separated by removed links is a group of
/// outliers, not a sheet. Its shortest removed link is restored. [count]
constexpr std::size_t largest_clump = 12;
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

  /*!
    Computes the normals of the planes of points with moments `m`. The confidence of a normal is 0
    if the points are on no plane. The smallest eigenvalue is the limit of Newton's method from 0
    for the characteristic polynomial, which is slow only for multiple eigenvalues, without a plane.
  */
  static PCS_ALWAYS_INLINE void
  find(const Block_moments& m, std::size_t first, Surface_normal* normal)
  {
    Doubles s[4], d[3], p[3], zero{}, one;
    pcs::internal::fill(1.0, one);
    for (std::size_t k = 0; k < 4; ++k)
      load(m.sum[k] + first, s[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      load(m.squares[k] + first, d[k]);
      load(m.products[k] + first, p[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      d[k] = d[k] - s[k] * s[k] / s[3];
      p[k] = p[k] - s[k] * s[(k + 1) % 3] / s[3];
    }
    Doubles trace = d[0] + d[1] + d[2];
    pcs::internal::select_less(zero, trace, trace, one, trace);
    for (std::size_t k = 0; k < 3; ++k) {
      d[k] = d[k] / trace;
      p[k] = p[k] / trace;
    }
    // rows (d0 p0 p2), (p0 d1 p1), (p2 p1 d2); the trace is 1
    const Doubles minors =
        d[0] * d[1] - p[0] * p[0] + d[1] * d[2] - p[1] * p[1] + d[2] * d[0] - p[2] * p[2];
    const Doubles determinant = d[0] * (d[1] * d[2] - p[1] * p[1]) -
                                p[0] * (p[0] * d[2] - p[1] * p[2]) +
                                p[2] * (p[0] * p[1] - d[1] * p[2]);
    constexpr int number_of_steps = 8;
    Doubles least{};
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
    const Doubles largest = 0.5 * (sum + difference), middle = sum - largest;
    // the rows of the matrix minus the eigenvalue are perpendicular to the normal
    const Doubles r0[3] = {d[0] - least, p[0], p[2]}, r1[3] = {p[0], d[1] - least, p[1]},
                  r2[3] = {p[2], p[1], d[2] - least};
    Doubles c[3], other[3], n, other_n;
    cross(r0, r1, c);
    squared_norm(c, n);
    cross(r1, r2, other);
    squared_norm(other, other_n);
    take_longer(other, other_n, c, n);
    cross(r2, r0, other);
    squared_norm(other, other_n);
    take_longer(other, other_n, c, n);
    root(n, n);
    for (std::size_t l = 0; l < size; ++l) {
      Surface_normal result{};
      const bool is_plane = middle[l] > smallest_width * largest[l] &&
                            least[l] < largest_thickness * middle[l] && n[l] > 0;
      if (is_plane) {
        for (std::size_t k = 0; k < 3; ++k)
          result[k] = static_cast<float>(c[k][l] / n[l]);
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

/// Disjoint sets of points with their sizes.
class Point_sets
{
public:
  explicit Point_sets(std::size_t n) : m_parent(n), m_size(n, 1)
  {
    for (std::size_t i = 0; i < n; ++i)
      m_parent[i] = static_cast<std::uint32_t>(i);
  }

  std::uint32_t find(std::uint32_t i)
  {
    while (m_parent[i] != i)
      i = m_parent[i] = m_parent[m_parent[i]];
    return i;
  }

  std::uint32_t size(std::uint32_t i) { return m_size[find(i)]; }

  void join(std::uint32_t i, std::uint32_t j)
  {
    i = find(i);
    j = find(j);
    if (i == j)
      return;
    if (m_size[i] < m_size[j])
      std::swap(i, j);
    m_parent[j] = i;
    m_size[i] += m_size[j];
  }

private:
  std::vector<std::uint32_t> m_parent, m_size;
};

/// Restores the shortest removed links that would separate `largest_clump` points or fewer.
/// \param suspects the points with links that may be removed, in increasing order
inline void keep_clumps(const std::vector<Vec3>& points,
                        const Proximity_graph& graph,
                        const std::vector<std::uint32_t>& suspects,
                        std::vector<char>& is_dropped)
{
  struct Drop
  {
    double squared_length;
    std::uint32_t i, j;
    bool operator<(const Drop& other) const
    {
      return std::tie(squared_length, i, j) < std::tie(other.squared_length, other.i, other.j);
    }
  };
  std::vector<Drop> drops;
  for (const std::uint32_t i : suspects)
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
      if (is_dropped[e] && graph.neighbor[e] > i)
        drops.push_back(
            {(points[graph.neighbor[e]] - points[i]).squaredNorm(), i, graph.neighbor[e]});
  if (drops.empty())
    return;
  Point_sets sets(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
      if (!is_dropped[e])
        sets.join(static_cast<std::uint32_t>(i), graph.neighbor[e]);
  std::sort(drops.begin(), drops.end());
  const auto keep = [&](std::uint32_t i, std::uint32_t j) {
    const auto found = std::lower_bound(graph.neighbor.begin() + graph.first[i],
                                        graph.neighbor.begin() + graph.first[i + 1],
                                        j);
    is_dropped[static_cast<std::size_t>(found - graph.neighbor.begin())] = 0;
  };
  for (const Drop& d : drops)
    if (sets.find(d.i) != sets.find(d.j) &&
        std::min(sets.size(d.i), sets.size(d.j)) <= largest_clump) {
      sets.join(d.i, d.j);
      keep(d.i, d.j);
      keep(d.j, d.i);
    }
}

} // namespace internal

/*!
  Removes links that leave the surface at both ends and whose ends have no common neighbour. They
  occur between sheets whose distance is close to the point spacing, because the nearest neighbours
  of a point then include points of the other sheet.

  Links in volumes, on lines and of outliers are kept, because there is no surface. No point loses
  all its links. O(n k).
  \return the number of links removed [count]
*/
template <class ConcurrencyTag>
std::size_t drop_short_cuts(const std::vector<Vec3>& points, Proximity_graph& graph)
{
  using internal::Surface_normal;
  constexpr float smallest_confidence = 0.05f;
  auto normal = internal::surface_normals<ConcurrencyTag>(points, graph);
  for (int round = 0; round < 2; ++round)
    normal = internal::settled_normals<ConcurrencyTag>(graph, normal);

  const auto leaves_surface = [&](std::size_t i, const Vec3& e, double squared) {
    const Surface_normal& n = normal[i];
    const double height = double(n[0]) * e.x() + double(n[1]) * e.y() + double(n[2]) * e.z();
    return n[3] > smallest_confidence &&
           height * height > smallest_short_cut_sine * smallest_short_cut_sine * squared;
  };
  std::vector<char> is_suspected(graph.neighbor.size(), 0);
  std::vector<std::uint32_t> trusted_degree(points.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const Vec3 edge = points[j] - points[i];
      const double squared = edge.squaredNorm();
      is_suspected[e] =
          leaves_surface(i, edge, squared) && leaves_surface(j, edge, squared) ? 1 : 0;
      trusted_degree[i] += is_suspected[e] ? 0u : 1u;
    }
  });
  std::vector<std::uint32_t> suspects; // few points, or none
  for (std::size_t i = 0; i < points.size(); ++i)
    if (trusted_degree[i] < graph.degree(i))
      suspects.push_back(static_cast<std::uint32_t>(i));
  if (suspects.empty())
    return 0;
  const auto have_common_neighbor = [&](std::size_t i, std::size_t j) {
    for (std::size_t a = graph.first[i], b = graph.first[j];
         a < graph.first[i + 1] && b < graph.first[j + 1];) {
      if (graph.neighbor[a] == graph.neighbor[b]) {
        if (!is_suspected[a] && !is_suspected[b])
          return true;
        ++a;
        ++b;
      } else if (graph.neighbor[a] < graph.neighbor[b])
        ++a;
      else
        ++b;
    }
    return false;
  };
  std::vector<char> is_dropped(graph.neighbor.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(suspects.size(), [&](std::size_t s) {
    const std::size_t i = suspects[s];
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      is_dropped[e] = is_suspected[e] && trusted_degree[i] >= smallest_remaining_degree &&
                              trusted_degree[j] >= smallest_remaining_degree &&
                              !have_common_neighbor(i, j)
                          ? 1
                          : 0;
    }
  });
  internal::keep_clumps(points, graph, suspects, is_dropped);
  std::size_t kept = graph.first[suspects.front()]; // rows before keep their place
  for (std::size_t i = suspects.front(); i < points.size(); ++i) {
    const std::size_t begin = graph.first[i], end = graph.first[i + 1];
    graph.first[i] = static_cast<std::uint32_t>(kept);
    for (std::size_t e = begin; e < end; ++e)
      if (!is_dropped[e])
        graph.neighbor[kept++] = graph.neighbor[e];
  }
  const std::size_t dropped = (graph.neighbor.size() - kept) / 2;
  graph.first[points.size()] = static_cast<std::uint32_t>(kept);
  graph.neighbor.resize(kept);
  return dropped;
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_DROP_SHORT_CUTS_H

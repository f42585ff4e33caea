// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Voronoi cells of surface points in their tangent planes.

#ifndef PCS_DEFORMATION_BODY_VORONOI_STARS_H
#define PCS_DEFORMATION_BODY_VORONOI_STARS_H

#include <pcs/deformation/body/Voronoi_cell.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/internal/compress_rows.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {
namespace internal {

/// Rows of the proximity graph that are longer do not help to fit planes.
constexpr std::size_t most_patch_edges = 64;

/// The sides of the Voronoi cells of all points: which neighbours, and length of the side over
/// their distance.
struct Voronoi_stars
{
  struct Side
  {
    std::uint32_t neighbor;
    float weight;
  };
  std::vector<std::uint32_t> first{0};
  std::vector<Side> side;
  std::vector<char> is_loose;   ///< a large or open cell, which may lack neighbours
  std::vector<char> is_changed; ///< has other neighbours than before

  std::size_t size() const { return first.size() - 1; }
  /// Whether the neighbours of point `i` are those of `[begin, end)`, in that order.
  template <class Iterator>
  bool has_neighbors(std::size_t i, Iterator begin, Iterator end) const
  {
    return std::equal(side.begin() + first[i],
                      side.begin() + first[i + 1],
                      begin,
                      end,
                      [](const Side& a, const Side& b) { return a.neighbor == b.neighbor; });
  }
  bool holds(std::uint32_t i, std::uint32_t j) const
  {
    return std::any_of(side.begin() + first[i], side.begin() + first[i + 1], [j](const Side& s) {
      return s.neighbor == j;
    });
  }
};

/// Spacing and direction of the surface at a point.
struct Tangent_plane
{
  Vec3 normal = Vec3::UnitZ(); ///< of unit length, of either sign
  double spacing = 0;          ///< [L]
};

/// The planes of all points, fitted to the neighbours of their neighbours in the proximity graph:
/// other sheets have no say.
template <class ConcurrencyTag>
std::vector<Tangent_plane> tangent_planes(const std::vector<Vec3>& points,
                                          const neighborhood::Proximity_graph& proximity)
{
  constexpr double smallest_spacing = 1e-100; // squares of relative lengths stay finite
  constexpr double widest_patch = 3;          // [spacings]
  std::vector<Tangent_plane> planes(points.size());
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    const double spacing = local_spacing(points, proximity, i);
    if (!(spacing > smallest_spacing))
      return;
    Vec3 sum = Vec3::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    double count = 1;
    const auto add = [&](std::uint32_t j) {
      const Vec3 offset = (points[j] - points[i]) / spacing;
      if (!(offset.squaredNorm() < widest_patch * widest_patch))
        return;
      sum += offset;
      moments += offset * offset.transpose();
      count += 1;
    };
    for (auto j = proximity.begin(i); j != proximity.end(i); ++j) {
      add(*j);
      if (proximity.degree(*j) <= most_patch_edges)
        std::for_each(proximity.begin(*j), proximity.end(*j), add);
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(moments - sum * sum.transpose() / count);
    planes[i] = {eigen.eigenvectors().col(0), spacing};
  });
  return planes;
}

/// Cuts the Voronoi cell of one point after the other in its tangent plane; lengths are relative to
/// its spacing.
class Voronoi_star_maker
{
public:
  Voronoi_star_maker(const std::vector<Vec3>& points, const std::vector<Tangent_plane>& planes)
    : m_points(points), m_planes(planes)
  {
  }

  /// Appends the star of point `i` to `out`; returns whether its cell is large or open. The
  /// neighbours are sought among those of `i` in `graph` and their neighbours.
  template <class Graph>
  bool operator()(std::size_t i, const Graph& graph, std::vector<Voronoi_stars::Side>& out)
  {
    m_spacing = m_planes[i].spacing;
    if (!(m_spacing > 0))
      return false;
    m_candidates.clear();
    graph.for_each_neighbor(i, [&](std::uint32_t j) { add_candidate(i, j); });
    const std::size_t number_of_direct = m_candidates.size();
    for (std::size_t c = 0; c < number_of_direct && m_candidates.size() < most_candidates; ++c)
      graph.for_each_neighbor(m_candidates[c].index, [&](std::uint32_t j) {
        if (j != i)
          add_candidate(i, j);
      });
    flatten(m_planes[i].normal);
    std::sort(m_candidates.begin(),
              m_candidates.begin() + static_cast<std::ptrdiff_t>(number_of_direct),
              [](const Candidate& a, const Candidate& b) {
                return std::make_pair(a.squared, a.index) < std::make_pair(b.squared, b.index);
              });
    m_cell.reset(half_side);
    for (std::size_t c = 0; c < m_candidates.size(); ++c)
      if (m_candidates[c].squared < m_cell.reach() * m_cell.reach() &&
          m_candidates[c].flat.squaredNorm() > 0)
        m_cell.cut(m_candidates[c].flat, static_cast<std::uint32_t>(c));
    const std::size_t first = out.size();
    m_cell.for_each_side(
        [&](std::uint32_t c) { return m_candidates[c].flat; },
        [&](std::uint32_t c, const Vec2& p, double length) {
          const double weight = length / p.norm() - negligible_weight;
          if (weight > 0)
            add_side({m_candidates[c].index, static_cast<float>(weight)}, first, out);
        });
    return m_cell.radius() > loose_radius;
  }

private:
  static constexpr double half_side = 4;      ///< of the cell that has no neighbours [spacings]
  static constexpr double longest_edge = 3;   ///< wider gaps are holes [spacings]
  static constexpr double loose_radius = 1.5; ///< of cells that may lack neighbours [spacings]
  static constexpr double least_in_plane =
      0.6; ///< steeper edges lead to another sheet [edge lengths]
  static constexpr double negligible_weight = 1e-6;
  static constexpr std::size_t most_candidates = 512;
  struct Candidate
  {
    Vec3 offset;
    double squared;
    Vec2 flat;
    std::uint32_t index;
  };

  void add_candidate(std::size_t i, std::uint32_t j)
  {
    const Vec3 offset = (m_points[j] - m_points[i]) / m_spacing;
    const double squared = offset.squaredNorm();
    if (squared < longest_edge * longest_edge)
      m_candidates.push_back({offset, squared, Vec2::Zero(), j});
  }

  /// Adds a side to the star that begins at `first`. A neighbour may have two sides, as it may be a
  /// candidate several times, and rounding in long and thin cells lets each of them cut. With two
  /// entries in one row, the matrices would not be symmetric.
  static void add_side(const Voronoi_stars::Side& side,
                       std::size_t first,
                       std::vector<Voronoi_stars::Side>& out)
  {
    for (std::size_t e = first; e < out.size(); ++e)
      if (out[e].neighbor == side.neighbor) {
        out[e].weight += side.weight;
        return;
      }
    out.push_back(side);
  }

  /// Lays the candidates into the tangent plane without shortening the edges to them, across
  /// creases above all.
  void flatten(const Vec3& normal)
  {
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    for (Candidate& c : m_candidates) {
      c.flat = Vec2(u.dot(c.offset), v.dot(c.offset));
      const double in_plane = c.flat.norm(), length = std::sqrt(c.squared);
      c.flat *= in_plane > least_in_plane * length ? length / in_plane : 0;
    }
  }

  const std::vector<Vec3>& m_points;
  const std::vector<Tangent_plane>& m_planes;
  double m_spacing = 1;
  std::vector<Candidate> m_candidates;
  Voronoi_cell m_cell;
};

/// Neighbours in the proximity graph.
struct Proximity_neighbors
{
  const neighborhood::Proximity_graph& graph;
  template <class Use>
  void for_each_neighbor(std::size_t i, const Use& use) const
  {
    std::for_each(graph.begin(i), graph.end(i), use);
  }
};

/// Neighbours across the sides of the cells, in either direction.
struct Star_neighbors
{
  neighborhood::Proximity_graph graph;
  std::vector<char>
      is_doubtful; ///< a point with a loose cell, or with a side that only one of two cells has

  template <class ConcurrencyTag>
  Star_neighbors(const Voronoi_stars& stars, ConcurrencyTag) : is_doubtful(stars.is_loose)
  {
    std::vector<char> is_mutual(stars.side.size());
    pcs::internal::for_each_index<ConcurrencyTag>(stars.size(), [&](std::size_t i) {
      for (std::size_t e = stars.first[i]; e < stars.first[i + 1]; ++e)
        is_mutual[e] = stars.holds(stars.side[e].neighbor, static_cast<std::uint32_t>(i)) ? 1 : 0;
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> links; // in both directions
    links.reserve(stars.side.size() +
                  static_cast<std::size_t>(std::count(is_mutual.begin(), is_mutual.end(), 0)));
    for (std::uint32_t i = 0; i < stars.size(); ++i)
      for (std::size_t e = stars.first[i]; e < stars.first[i + 1]; ++e) {
        const std::uint32_t j = stars.side[e].neighbor;
        links.emplace_back(i, j);
        if (!is_mutual[e]) {
          links.emplace_back(j, i);
          is_doubtful[i] = is_doubtful[j] = 1;
        }
      }
    graph.first = pcs::internal::compress_rows<std::uint32_t>(
        stars.size(),
        links.size(),
        [&](std::size_t k) { return links[k].first; },
        [&](std::size_t count) { graph.neighbor.resize(count); },
        [&](std::size_t k, std::size_t at) { graph.neighbor[at] = links[k].second; });
  }

  template <class Use>
  void for_each_neighbor(std::size_t i, const Use& use) const
  {
    std::for_each(graph.begin(i), graph.end(i), use);
  }
};

/// Makes the stars of all points for which `is_made(i)`, and copies the others from `old`. If
/// `go_on` stops, the result must not be used.
template <class ConcurrencyTag, class Graph, class Is_made>
Voronoi_stars voronoi_stars(const std::vector<Vec3>& points,
                            const std::vector<Tangent_plane>& planes,
                            const Graph& graph,
                            const Voronoi_stars& old,
                            const Is_made& is_made,
                            const pcs::internal::Go_on& go_on = {})
{
  constexpr std::size_t block_size = 512, blocks_per_slice = 64;
  const std::size_t n = points.size();
  Voronoi_stars stars;
  stars.first.resize(n + 1);
  stars.is_loose.assign(n, 0);
  stars.is_changed.assign(n, 0);
  std::vector<std::vector<Voronoi_stars::Side>> sides((n + block_size - 1) / block_size);
  const bool is_complete = pcs::internal::for_each_block_while<ConcurrencyTag>(
      n,
      block_size,
      blocks_per_slice,
      [&](std::size_t begin, std::size_t end) {
        Voronoi_star_maker make(points, planes);
        auto& out = sides[begin / block_size];
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t before = out.size();
          if (is_made(i)) {
            stars.is_loose[i] = make(i, graph, out) ? 1 : 0;
            stars.is_changed[i] =
                old.size() == 0 ||
                        !old.has_neighbors(i,
                                           out.begin() + static_cast<std::ptrdiff_t>(before),
                                           out.end())
                    ? 1
                    : 0;
          } else {
            out.insert(out.end(),
                       old.side.begin() + old.first[i],
                       old.side.begin() + old.first[i + 1]);
            stars.is_loose[i] = old.is_loose[i];
          }
          stars.first[i + 1] = static_cast<std::uint32_t>(out.size() - before);
        }
      },
      [&](double f) { return pcs::internal::goes_on(go_on, f); });
  if (!is_complete)
    return Voronoi_stars();
  for (std::size_t i = 0; i < n; ++i)
    stars.first[i + 1] += stars.first[i];
  stars.side.reserve(stars.first.back());
  for (const auto& block : sides)
    stars.side.insert(stars.side.end(), block.begin(), block.end());
  return stars;
}

} // namespace internal
} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_VORONOI_STARS_H

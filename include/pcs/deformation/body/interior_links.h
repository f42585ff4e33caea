// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Interior springs of a closed surface, which preserve volume under twist and bending.

#ifndef PCS_DEFORMATION_BODY_INTERIOR_LINKS_H
#define PCS_DEFORMATION_BODY_INTERIOR_LINKS_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Options of `interior_links()`. Lengths are relative to the spacing `h`, see `typical_edge()`.

  A link leads from a node along its inward normal to the opposite side. A link of length `d` has
  the weight `strength (h / d)^2`. As for surface edges, the energy of a relative compression then
  does not depend on the sampling.
*/
struct Interior_link_options
{
  double strength = 28;     ///< [-], measured on twisted bars: 8 loses volume, 64 stiffens bends
  double reach = 0.75;      ///< largest distance of a hit node from the ray [h]
  double shortest = 2;      ///< shortest links; shorter ones would duplicate surface edges [h]
  double longest = 2;       ///< longest links, relative to the median length [-]
  double opposition = -0.3; ///< upper bound of the cosine between the normals of the two ends
  double smallest_hit_share = 0.1;      ///< least fraction of rays that hit in a closed surface [-]
  double smallest_enclosed_share = 0.5; ///< fraction of tested links, see `is_enclosed()`
  std::size_t number_of_tested_links = 96;
  int largest_number_of_steps = 128; ///< of one ray
};

/// Largest network with links; for larger networks, only coarser levels have links. With links, the
/// factor has the fill-in of a volume instead of a surface: factorising 40,000 nodes takes fifty
/// times as long as 5,000. [count]
constexpr std::size_t largest_linked_network = 20000;

namespace internal {

/// Estimates normals by principal components of the edges, and orients them consistently along a
/// spanning tree per component.
template <class ConcurrencyTag>
std::vector<Vec3> oriented_normals(const Elastic_network& network)
{
  const auto& graph = network.surface;
  const std::size_t n = network.size();
  std::vector<Vec3> normal(n, Vec3::UnitZ());
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    Vec3 mean = Vec3::Zero();
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (auto j = graph.begin(i); j != graph.end(i); ++j) {
      const Vec3 e = network.rest[*j] - network.rest[i];
      mean += e;
      spread += e * e.transpose();
    }
    spread -= mean * mean.transpose() / (static_cast<double>(graph.degree(i)) + 1);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(spread);
    const Vec3 candidate = eigen.eigenvectors().col(0);
    if (candidate.allFinite() && candidate.squaredNorm() > 0.5)
      normal[i] = candidate.normalized();
  });
  // Prim's algorithm with the costs 1 - |cos|: flat regions come first, sharp edges last.
  using Entry = std::tuple<double, std::uint32_t, std::uint32_t>; // cost, node, parent
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  std::vector<char> is_done(n, 0);
  for (std::size_t root = 0; root < n; ++root) {
    if (is_done[root])
      continue;
    queue.emplace(0.0, static_cast<std::uint32_t>(root), static_cast<std::uint32_t>(root));
    while (!queue.empty()) {
      const auto [cost, i, parent] = queue.top();
      queue.pop();
      if (is_done[i])
        continue;
      is_done[i] = 1;
      if (normal[i].dot(normal[parent]) < 0)
        normal[i] = -normal[i];
      for (auto j = graph.begin(i); j != graph.end(i); ++j)
        if (!is_done[*j])
          queue.emplace(1 - std::abs(normal[i].dot(normal[*j])), *j, i);
    }
  }
  return normal;
}

/// Traces rays through the nodes (sphere tracing): a ray hits nodes closer to it than `reach * h`.
class Ray_caster
{
public:
  static constexpr std::uint32_t miss = ~std::uint32_t(0);

  Ray_caster(const Elastic_network& network, double h, const Interior_link_options& options)
    : m_network(network), m_nearest(network.rest), m_options(options), m_h(h)
  {
    for (const Vec3& p : network.rest)
      m_box.extend(p);
    m_box.min().array() -= h;
    m_box.max().array() += h;
  }

  /// Returns the first node within reach of the ray, at least `shortest * h` from its origin, or
  /// `miss`.
  std::uint32_t first_hit(const Vec3& origin, const Vec3& direction) const
  {
    thread_local std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
    const double first = m_options.shortest * m_h, reach = m_options.reach * m_h;
    double t = first;
    for (int step = 0; step < m_options.largest_number_of_steps; ++step) {
      const Vec3 at = origin + t * direction;
      if (!m_box.contains(at))
        return miss;
      m_nearest(at, number_of_equals, found);
      const double d = std::sqrt(found[0].squared_distance);
      const std::uint32_t hit = lowest_of_nearest(found);
      if (d <= reach && (m_network.rest[hit] - origin).norm() > first)
        return hit;
      t += std::max(d - 0.5 * reach, 0.5 * reach);
    }
    return miss;
  }

  /*!
    Whether the surface encloses the link: of the rays from its midpoint perpendicular to it, at
    least one opposite pair hits nodes. This holds inside a box or an open tube. It does not hold
    between two sheets joined along one edge, which must remain independent.
  */
  bool is_enclosed(std::uint32_t i, std::uint32_t j) const
  {
    const Vec3 middle = 0.5 * (m_network.rest[i] + m_network.rest[j]);
    const Vec3 axis = (m_network.rest[j] - m_network.rest[i]).normalized();
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    constexpr int number_of_pairs = 4;
    for (int k = 0; k < number_of_pairs; ++k) {
      const double angle = static_cast<double>(EIGEN_PI) * k / number_of_pairs;
      const Vec3 direction = std::cos(angle) * u + std::sin(angle) * v;
      if (first_hit(middle, direction) != miss && first_hit(middle, -direction) != miss)
        return true;
    }
    return false;
  }

private:
  /// Number of nearest nodes compared, because several nodes of a grid may be equally near to a ray
  /// and the choice must not depend on rounding.
  static constexpr std::size_t number_of_equals = 4;

  static std::uint32_t
  lowest_of_nearest(const std::vector<neighborhood::Nearest_neighbors::Neighbor>& found)
  {
    std::uint32_t lowest = found[0].index;
    for (const auto& f : found)
      if (f.squared_distance <= found[0].squared_distance * (1 + 1e-6))
        lowest = std::min(lowest, f.index);
    return lowest;
  }

  const Elastic_network& m_network;
  neighborhood::Nearest_neighbors m_nearest;
  const Interior_link_options& m_options;
  double m_h;
  Eigen::AlignedBox3d m_box;
};

using Link = std::pair<std::uint32_t, std::uint32_t>;

/// Numbers of nodes, hits, links and enclosed links of a component.
struct Link_votes
{
  std::size_t size = 0, hits[2] = {0, 0}, links = 0, seen = 0, tested = 0, enclosed = 0;
};

/// Removes the links of components in which most of the tested links are not enclosed.
inline void drop_open_components(const Ray_caster& rays,
                                 const std::vector<std::uint32_t>& component,
                                 const Interior_link_options& options,
                                 std::vector<Link_votes>& votes,
                                 std::vector<Link>& links)
{
  for (const Link& link : links) {
    Link_votes& v = votes[component[link.first]];
    const std::size_t stride = std::max<std::size_t>(1, v.links / options.number_of_tested_links);
    if (v.seen++ % stride != 0)
      continue;
    ++v.tested;
    v.enclosed += rays.is_enclosed(link.first, link.second) ? 1 : 0;
  }
  links.erase(std::remove_if(links.begin(),
                             links.end(),
                             [&](const Link& link) {
                               const Link_votes& v = votes[component[link.first]];
                               return static_cast<double>(v.enclosed) <
                                      options.smallest_enclosed_share *
                                          static_cast<double>(v.tested);
                             }),
              links.end());
}

/// Removes links longer than `factor` times the median, because they lead along a limb, not across.
inline void drop_long_links(const Elastic_network& network, double factor, std::vector<Link>& links)
{
  if (links.empty())
    return;
  const auto length = [&](const Link& l) {
    return (network.rest[l.first] - network.rest[l.second]).norm();
  };
  std::vector<double> lengths;
  for (const Link& l : links)
    lengths.push_back(length(l));
  const double longest = factor * pcs::internal::upper_median(lengths);
  links.erase(std::remove_if(links.begin(),
                             links.end(),
                             [&](const Link& l) { return length(l) > longest; }),
              links.end());
}

/// Casts a ray from every node against its normal and another one along it. Returns the nodes that
/// they hit on the opposite side of the same component, or `miss`.
template <class ConcurrencyTag>
std::array<std::vector<std::uint32_t>, 2>
find_opposite_nodes(const Elastic_network& network,
                    const std::vector<std::uint32_t>& component,
                    const Interior_link_options& options,
                    const Ray_caster& rays)
{
  const std::vector<Vec3> normal = oriented_normals<ConcurrencyTag>(network);
  const auto opposite = [&](std::size_t i, const Vec3& direction) {
    const std::uint32_t j = rays.first_hit(network.rest[i], direction);
    const bool is_opposite = j != Ray_caster::miss && component[j] == component[i] &&
                             normal[i].dot(normal[j]) < options.opposition;
    return is_opposite ? j : Ray_caster::miss;
  };
  std::array<std::vector<std::uint32_t>, 2> hit;
  for (auto& side : hit)
    side.resize(network.size());
  pcs::internal::for_each_index<ConcurrencyTag>(
      network.size(),
      [&](std::size_t i) {
        hit[0][i] = opposite(i, -normal[i]);
        hit[1][i] = opposite(i, normal[i]);
      },
      128);
  return hit;
}

/// Counts the nodes of each component, and the rays of each direction that hit.
inline std::vector<Link_votes> count_hits(const std::array<std::vector<std::uint32_t>, 2>& hit,
                                          const std::vector<std::uint32_t>& component)
{
  std::vector<Link_votes> votes(*std::max_element(component.begin(), component.end()) +
                                std::size_t(1));
  for (std::size_t i = 0; i < component.size(); ++i) {
    Link_votes& v = votes[component[i]];
    ++v.size;
    for (std::size_t side = 0; side < 2; ++side)
      if (hit[side][i] != Ray_caster::miss)
        ++v.hits[side];
  }
  return votes;
}

/// Returns the links through the interior of each component. The interior is on the side to which
/// more rays hit.
inline std::vector<Link> link_through_inside(const std::array<std::vector<std::uint32_t>, 2>& hit,
                                             const std::vector<std::uint32_t>& component,
                                             double smallest_hit_share,
                                             std::vector<Link_votes>& votes)
{
  std::vector<Link> links;
  for (std::size_t i = 0; i < component.size(); ++i) {
    Link_votes& v = votes[component[i]];
    const std::size_t inside = v.hits[0] >= v.hits[1] ? 0 : 1;
    if (static_cast<double>(v.hits[inside]) >= smallest_hit_share * static_cast<double>(v.size) &&
        hit[inside][i] != Ray_caster::miss) {
      links.emplace_back(static_cast<std::uint32_t>(i), hit[inside][i]);
      ++v.links;
    }
  }
  return links;
}

/// Returns the graph of the links; a link of length `d` has the weight `numerator / d^2`.
inline Weighted_graph
weighted_links(const Elastic_network& network, std::vector<Link> links, double numerator)
{
  Weighted_graph result;
  static_cast<neighborhood::Proximity_graph&>(result) =
      neighborhood::graph_from_edges(network.size(), std::move(links));
  result.weight.resize(result.neighbor.size());
  for (std::size_t i = 0; i < network.size(); ++i)
    for (std::size_t e = result.first[i]; e < result.first[i + 1]; ++e)
      result.weight[e] =
          numerator / (network.rest[result.neighbor[e]] - network.rest[i]).squaredNorm();
  return result;
}

} // namespace internal

/*!
  Links nodes of closed or nearly closed surfaces to the opposite side. Open surfaces, and parts
  whose inward rays hit no node, have no links. O(n log n).
  \param component the component of every node; links never join two components
*/
template <class ConcurrencyTag>
Weighted_graph interior_links(const Elastic_network& network,
                              const std::vector<std::uint32_t>& component,
                              const Interior_link_options& options = {})
{
  if (network.size() < 4 || network.surface.neighbor.empty())
    return {};
  const double h = typical_edge(network.rest, network.surface);
  if (!(h > 0))
    return {};
  const internal::Ray_caster rays(network, h, options);
  const auto hit = internal::find_opposite_nodes<ConcurrencyTag>(network, component, options, rays);
  std::vector<internal::Link_votes> votes = internal::count_hits(hit, component);
  std::vector<internal::Link> links =
      internal::link_through_inside(hit, component, options.smallest_hit_share, votes);
  internal::drop_open_components(rays, component, options, votes, links);
  internal::drop_long_links(network, options.longest, links);
  if (links.empty())
    return {};
  return internal::weighted_links(network, std::move(links), options.strength * h * h);
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_INTERIOR_LINKS_H

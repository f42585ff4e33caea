// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The neighbour graph of a scan for Boost.Graph, with links that close gaps of occlusion.

#ifndef PCS_SKELETON_NEIGHBOR_GRAPH_H
#define PCS_SKELETON_NEIGHBOR_GRAPH_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/Scan.h>

#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/iterator/iterator_facade.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Compressed rows of Boost.Graph, every edge in both directions; costs come from the points.
using Neighbor_graph = boost::compressed_sparse_row_graph<boost::directedS,
                                                          boost::no_property,
                                                          boost::no_property,
                                                          boost::no_property,
                                                          Index,
                                                          Index>;

/// Which neighbours are linked, in multiples of the spacing [-].
struct Link_rule
{
  double local_factor = 2.5;       ///< longest link relative to the local spacing
  double lowest = 3, highest = 12; ///< bounds of it relative to the median spacing
  double gap = 30; ///< widest gap that is closed, relative to the median spacing; 0: none

  double longest(const Scan& scan, Index i) const
  {
    return std::min(std::max(local_factor * scan.local_spacing[i], lowest * scan.spacing),
                    highest * scan.spacing);
  }
};

/// Steps longer than this many spacings cost more than their length: a path should not jump [-].
constexpr double cheap_step = 2.5;

/// The cost of going from one point to another [L].
inline double step_cost(const Scan& scan, Index i, Index j)
{
  const double d = (scan.points[i] - scan.points[j]).norm();
  return d * std::max(1.0, d / (cheap_step * scan.spacing));
}

using Link = std::pair<Index, Index>;

/// Sets of points that hang together: union by size, path halving.
class Point_sets
{
public:
  explicit Point_sets(std::size_t n) : m_size(n, 1), m_parent(n)
  {
    for (std::size_t i = 0; i < n; ++i)
      m_parent[i] = static_cast<Index>(i);
  }

  Index find(Index i)
  {
    while (m_parent[i] != i)
      i = m_parent[i] = m_parent[m_parent[i]];
    return i;
  }
  void unite(Index i, Index j)
  {
    i = find(i);
    j = find(j);
    if (i == j)
      return;
    if (m_size[i] < m_size[j] || (m_size[i] == m_size[j] && j < i))
      std::swap(i, j);
    m_parent[j] = i;
    m_size[i] += m_size[j];
  }

private:
  std::vector<Index> m_size, m_parent;
};

/// Links between the points of `is_used` that are neighbours, each once, in increasing order.
template <class ConcurrencyTag>
std::vector<Link>
neighbor_links(const Scan& scan, const std::vector<std::uint8_t>& is_used, const Link_rule& rule)
{
  const std::size_t n = scan.size(), block = 4096;
  std::vector<std::vector<Link>> parts((n + block - 1) / block);
  const auto is_link = [&](Index i, Index j) {
    const double longest = std::max(rule.longest(scan, i), rule.longest(scan, j));
    return (scan.points[i] - scan.points[j]).squaredNorm() <= longest * longest;
  };
  pcs::internal::for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    auto& part = parts[begin / block];
    for (std::size_t k = begin; k < end; ++k) {
      const Index i = static_cast<Index>(k);
      if (!is_used[i])
        continue;
      for (const Index j : scan.neighbors[i]) {
        if (j == none || !is_used[j] || !is_link(i, j))
          continue;
        // the other side stores it if both know each other
        const auto& other = scan.neighbors[j];
        if (j < i && std::find(other.begin(), other.end(), i) != other.end())
          continue;
        part.emplace_back(std::min(i, j), std::max(i, j));
      }
    }
  });
  std::vector<std::size_t> first(parts.size() + 1, 0);
  for (std::size_t b = 0; b < parts.size(); ++b)
    first[b + 1] = first[b] + parts[b].size();
  std::vector<Link> links;
  links.reserve(first.back() + first.back() / 16); // for those that close gaps
  links.resize(first.back());
  pcs::internal::for_each_index<ConcurrencyTag>(
      parts.size(),
      [&](std::size_t b) {
        std::copy(parts[b].begin(), parts[b].end(), links.begin() + std::ptrdiff_t(first[b]));
        std::vector<Link>().swap(parts[b]);
      },
      1);
  return links;
}

/*!
  The shortest links that join components, in Boruvka's rounds, up to the widest gap of the rule. The largest component
  never searches: the others find it.
*/
inline std::vector<Link> links_across_gaps(const Scan& scan,
                                           const std::vector<std::uint8_t>& is_used,
                                           const Link_rule& rule,
                                           const std::vector<Link>& links)
{
  std::vector<Link> across;
  const std::size_t n = scan.size();
  const double widest = rule.gap * scan.spacing;
  Point_sets sets(n);
  for (const Link& l : links)
    sets.unite(l.first, l.second);
  struct Best
  {
    double squared_distance;
    Link link;
  };
  std::vector<Index> label(n, none), size(n, 0);
  std::vector<Best> best;
  while (widest > 0) {
    std::fill(size.begin(), size.end(), 0);
    for (Index i = 0; i < n; ++i)
      if (is_used[i])
        ++size[label[i] = sets.find(i)];
    const Index largest =
        static_cast<Index>(std::max_element(size.begin(), size.end()) - size.begin());
    best.assign(n, {widest * widest, {none, none}});
    for (Index i = 0; i < n; ++i) {
      if (!is_used[i] || label[i] == largest)
        continue;
      Best& b = best[label[i]];
      const auto found =
          scan.search->nearest_if(scan.points[i], std::sqrt(b.squared_distance), [&](Index j) {
            return is_used[j] && label[j] != label[i];
          });
      if (found.squared_distance < b.squared_distance)
        b = {found.squared_distance, {std::min(i, found.index), std::max(i, found.index)}};
    }
    std::vector<Best> chosen;
    for (const Best& b : best)
      if (b.link.first != none)
        chosen.push_back(b);
    std::sort(chosen.begin(), chosen.end(), [](const Best& a, const Best& b) {
      return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                      : a.link < b.link;
    });
    bool is_joined = false;
    for (const Best& b : chosen)
      if (sets.find(b.link.first) != sets.find(b.link.second)) {
        sets.unite(b.link.first, b.link.second);
        across.push_back(b.link);
        is_joined = true;
      }
    if (!is_joined)
      break;
  }
  return across;
}

namespace internal {

/// Every link in both directions.
class Edge_iterator
  : public boost::iterator_facade<Edge_iterator, Link, boost::forward_traversal_tag, Link>
{
public:
  explicit Edge_iterator(const Link* link) : m_link(link) {}

private:
  friend class boost::iterator_core_access;
  void increment()
  {
    m_link += m_is_reverse;
    m_is_reverse = !m_is_reverse;
  }
  bool equal(const Edge_iterator& other) const
  {
    return m_link == other.m_link && m_is_reverse == other.m_is_reverse;
  }
  Link dereference() const { return m_is_reverse ? Link(m_link->second, m_link->first) : *m_link; }

  const Link* m_link;
  bool m_is_reverse = false;
};

} // namespace internal

/// Rows from links, each link in both directions.
inline Neighbor_graph graph_of(std::size_t n, const std::vector<Link>& links)
{
  return Neighbor_graph(boost::edges_are_unsorted_multi_pass,
                        internal::Edge_iterator(links.data()),
                        internal::Edge_iterator(links.data() + links.size()),
                        static_cast<Index>(n));
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_NEIGHBOR_GRAPH_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Neighbour graph of a scan, with links that close occlusion gaps.

#ifndef PCS_SKELETON_GRAPH_NEIGHBOR_GRAPH_H
#define PCS_SKELETON_GRAPH_NEIGHBOR_GRAPH_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/graph/Neighbor_links.h>
#include <pcs/skeleton/graph/Point_cells.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Disjoint sets of connected points: union by size, path halving.
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

/*!
  Returns the connected components of the links for which `is_wanted(link)` holds. Blocks of links
  are united in parallel if both ends belong to one block of points, which is nearly always true in
  spatial order; the remaining links follow sequentially.
*/
template <class ConcurrencyTag, class LinkRange, class IsWanted>
Point_sets united_points(std::size_t n, const LinkRange& links, const IsWanted& is_wanted)
{
  constexpr std::size_t block = std::size_t(1) << 17;
  const std::size_t number_of_blocks = (links.size() + block - 1) / block;
  // of the blocks of points
  std::vector<Index> border(number_of_blocks + 1, static_cast<Index>(n));
  for (std::size_t b = 0; b < number_of_blocks; ++b)
    for_each_link(links, b * block, b * block + 1, [&](const Link& l) {
      border[b] = b == 0 ? 0 : std::max(border[b - 1], l.first);
    });
  Point_sets sets(n);
  std::vector<std::vector<Link>> rest(number_of_blocks);
  const auto unite = [&](std::size_t begin, std::size_t end) {
    const std::size_t b = begin / block;
    for_each_link(links, begin, end, [&](const Link& l) {
      if (!is_wanted(l))
        return;
      if (l.first >= border[b] && l.second < border[b + 1])
        sets.unite(l.first, l.second);
      else
        rest[b].push_back(l);
    });
  };
  pcs::internal::for_each_block<ConcurrencyTag>(links.size(), block, unite);
  for (const std::vector<Link>& part : rest)
    for (const Link& l : part)
      sets.unite(l.first, l.second);
  return sets;
}

/// Connected components of points: the component of each point, and the size of each component.
struct Point_parts
{
  std::vector<Index> part; ///< a point of the component; `none` if not used
  std::vector<Index> size; ///< size of the component, by the same point

  std::vector<Index> points_of(Index s) const
  {
    std::vector<Index> points;
    for (Index i = 0; i < part.size(); ++i)
      if (part[i] == s)
        points.push_back(i);
    return points;
  }
};

/// Returns the connected components of the points of `is_used`.
template <class ConcurrencyTag, class LinkRange>
Point_parts connected_parts(const std::vector<std::uint8_t>& is_used, const LinkRange& links)
{
  const std::size_t n = is_used.size();
  Point_sets sets = united_points<ConcurrencyTag>(n, links, [&](const Link& l) {
    return is_used[l.first] && is_used[l.second];
  });
  Point_parts parts{std::vector<Index>(n, none), std::vector<Index>(n, 0)};
  for (Index i = 0; i < n; ++i)
    if (is_used[i])
      ++parts.size[parts.part[i] = sets.find(i)];
  return parts;
}

namespace internal {

/// Joins connected components of points by their shortest links, in rounds of the method of
/// Boruvka.
template <class ConcurrencyTag>
class Gap_closer
{
public:
  Gap_closer(const Scan& scan,
             const std::vector<std::uint8_t>& is_used,
             double widest,
             const Point_parts& parts)
    : m_scan(scan),
      m_is_used(is_used),
      m_parts(parts),
      m_widest(widest),
      m_sets(scan.size()),
      m_label(parts.part)
  {
  }

  Links operator()()
  {
    while (m_widest > 0 && label_points()) {
      find_links();
      if (!add_links())
        break;
    }
    return std::move(m_across);
  }

private:
  /// Shortest link from a component to another one.
  struct Best
  {
    double squared_distance;
    Link link;

    friend bool operator<(const Best& a, const Best& b)
    {
      return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                      : a.link < b.link;
    }
  };

  /// Labels all points by their components. Returns `false` if there is only one component.
  bool label_points()
  {
    const std::size_t n = m_scan.size();
    m_size.assign(n, 0);
    std::size_t number_of_others = 0; // points outside of the largest component
    for (Index i = 0; i < n; ++i)
      if (m_is_used[i]) {
        ++m_size[m_label[i] = m_sets.find(m_parts.part[i])];
        ++number_of_others;
      }
    m_largest = static_cast<Index>(std::max_element(m_size.begin(), m_size.end()) - m_size.begin());
    number_of_others -= m_size[m_largest];
    if (number_of_others > n / 8 && !m_cells) // otherwise the cells cost more than they save
      m_cells.emplace(m_scan.points, m_is_used, m_widest);
    return number_of_others > 0;
  }

  /// Finds the shortest link of each component except the largest; the first point decides ties.
  /// Points are processed in waves of fixed size, whose searches end at the best distances of the
  /// previous waves.
  void find_links()
  {
    constexpr std::size_t block = 256, wave = 64 * block;
    const std::size_t n = m_scan.size();
    m_best.assign(n, {m_widest * m_widest, {none, none}});
    const std::vector<Index> around =
        m_cells ? m_cells->common_label(m_label) : std::vector<Index>();
    std::vector<std::vector<std::pair<Index, Best>>> found(wave / block); // of blocks, by label
    for (std::size_t first = 0; first < n; first += wave) {
      const std::size_t count = std::min(wave, n - first);
      pcs::internal::for_each_block<ConcurrencyTag>(
          count,
          block,
          [&](std::size_t begin, std::size_t end) {
            found[begin / block] = links_of(first + begin, first + end, around);
          });
      for (auto& of_block : found) {
        for (const auto& [label, best] : of_block)
          if (best.squared_distance < m_best[label].squared_distance)
            m_best[label] = best;
        of_block.clear();
      }
    }
  }

  /// Returns links of components that are shorter than the best so far, from the points of a block.
  std::vector<std::pair<Index, Best>>
  links_of(std::size_t begin, std::size_t end, const std::vector<Index>& around) const
  {
    std::vector<std::pair<Index, Best>> links;
    for (std::size_t k = begin; k < end; ++k) {
      const Index i = static_cast<Index>(k), label = m_label[i];
      if (!m_is_used[i] || label == m_largest || (m_cells && around[m_cells->cell_of(i)] == label))
        continue;
      const auto own = std::find_if(links.begin(), links.end(), [&](const auto& link) {
        return link.first == label;
      });
      const double best = (own == links.end() ? m_best[label] : own->second).squared_distance;
      const auto near =
          m_scan.search->nearest_if(m_scan.points[i],
                                    (1 + 1e-15) * std::sqrt(best), // not less than the distance
                                    [&](Index j) { return m_is_used[j] && m_label[j] != label; });
      if (!(near.squared_distance < best))
        continue;
      const Best link{near.squared_distance, {std::min(i, near.index), std::max(i, near.index)}};
      if (own == links.end())
        links.emplace_back(label, link);
      else
        own->second = link;
    }
    return links;
  }

  /// Adds the links that join two components, shortest first. Returns `false` if there are none.
  bool add_links()
  {
    std::vector<Best> chosen;
    for (const Best& b : m_best)
      if (b.link.first != none)
        chosen.push_back(b);
    std::sort(chosen.begin(), chosen.end());
    bool is_joined = false;
    for (const Best& b : chosen) {
      const Index one = m_parts.part[b.link.first], other = m_parts.part[b.link.second];
      if (m_sets.find(one) != m_sets.find(other)) {
        m_sets.unite(one, other);
        m_across.push_back(b.link);
        is_joined = true;
      }
    }
    return is_joined;
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  const Point_parts& m_parts;
  double m_widest;
  Point_sets m_sets; ///< of components
  std::vector<Index> m_label, m_size;
  Index m_largest = none; ///< label of the largest component
  std::vector<Best> m_best;
  std::optional<Point_cells> m_cells;
  Links m_across;
};

} // namespace internal

/*!
  Returns the shortest links that join the connected components of the points of `is_used` up to the
  widest gap of the rule, by the method of Boruvka. Links are searched from the points of all
  components except the largest. If these are many, only points near other components are used.
*/
template <class ConcurrencyTag>
Links links_across_gaps(const Scan& scan,
                        const std::vector<std::uint8_t>& is_used,
                        const Link_rule& rule,
                        const Point_parts& parts)
{
  return internal::Gap_closer<ConcurrencyTag>(scan, is_used, rule.gap * scan.spacing, parts)();
}

/// The neighbours of each point in compressed rows, with every link in both directions. Costs are
/// computed from the points.
class Neighbor_graph
{
public:
  /// `for_each_link(f)` calls `f(link)` for all links, in the same order at each call.
  template <class ForEachLink>
  Neighbor_graph(std::size_t n, const ForEachLink& for_each_link) : m_first(n + 1, 0)
  {
    for_each_link([&](const Link& l) {
      ++m_first[l.first];
      ++m_first[l.second];
    });
    Index end = 0; // of the rows so far; the rows are filled from their ends
    for (Index& first : m_first)
      first = end += first;
    m_neighbor.resize(end);
    for_each_link([&](const Link& l) {
      m_neighbor[--m_first[l.first]] = l.second;
      m_neighbor[--m_first[l.second]] = l.first;
    });
    for (std::size_t v = 0; v < n; ++v)
      std::reverse(m_neighbor.begin() + m_first[v], m_neighbor.begin() + m_first[v + 1]);
  }

  std::size_t number_of_points() const { return m_first.size() - 1; }
  std::size_t number_of_edges() const { return m_neighbor.size(); }
  /// The neighbours of a point, in the order of the links.
  const Index* begin(Index v) const { return m_neighbor.data() + m_first[v]; }
  const Index* end(Index v) const { return m_neighbor.data() + m_first[v + 1]; }

private:
  std::vector<Index> m_first;
  pcs::internal::Huge_vector<Index> m_neighbor;
};

/// Builds a graph from links and those that close gaps, each in both directions.
template <class LinkRange>
Neighbor_graph graph_of(std::size_t n, const LinkRange& links, const Links& gaps = Links())
{
  return Neighbor_graph(n, [&](const auto& f) {
    for_each_link(links, f);
    for_each_link(gaps, f);
  });
}

/// Graph of all points, in which gaps between connected components are closed.
struct Linked_parts
{
  Links gaps;
  std::optional<Neighbor_graph> graph;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_GRAPH_NEIGHBOR_GRAPH_H

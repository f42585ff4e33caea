// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Links between neighbours of a scan, as a list or in two bytes per point.

#ifndef PCS_SKELETON_GRAPH_NEIGHBOR_LINKS_H
#define PCS_SKELETON_GRAPH_NEIGHBOR_LINKS_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for links between neighbours, in multiples of the spacing [-].
struct Link_rule
{
  double local_factor = 2.5;       ///< longest link relative to the local spacing
  double lowest = 3, highest = 12; ///< its bounds relative to the median spacing
  double gap = 30; ///< widest gap that is closed, relative to the median spacing; 0: none

  double longest(const Scan& scan, Index i) const
  {
    return std::min(std::max(local_factor * scan.local_spacing[i], lowest * scan.spacing),
                    highest * scan.spacing);
  }
};

/// Length in spacings above which steps cost more than their length, to penalize gaps [-].
constexpr double cheap_step = 2.5;

/// Returns the cost of a step from one point to another [L].
inline double step_cost(const Scan& scan, Index i, Index j)
{
  const double d = (scan.points[i] - scan.points[j]).norm();
  return d * std::max(1.0, d / (cheap_step * scan.spacing));
}

/// Pair of linked points, the smaller index first.
struct Link
{
  Index first, second;

  friend bool operator<(const Link& a, const Link& b)
  {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  }
};
using Links = pcs::internal::Huge_vector<Link>;

/*!
  The links between neighbours among the points of `is_used`, each once, nearly in increasing order,
  and further links. They are numbered like those of a list, but need only two bytes per point. The
  scan must remain unchanged.
*/
class Compact_links
{
public:
  template <class ConcurrencyTag>
  Compact_links(ConcurrencyTag,
                const Scan& scan,
                const std::vector<std::uint8_t>& is_used,
                const Link_rule& rule)
    : m_scan(&scan), m_flags(scan.size()), m_first((scan.size() + block - 1) / block + 1, 0)
  {
    const auto is_link = [&](Index i, Index j) {
      const double longest = std::max(rule.longest(scan, i), rule.longest(scan, j));
      return (scan.points[i] - scan.points[j]).squaredNorm() <= longest * longest;
    };
    const auto knows = [&](Index i, Index j) {
      bool does = false;
      for (const Index k : scan.neighbors[i])
        does |= k == j; // no early exit, to avoid branch misprediction
      return does;
    };
    const auto mark = [&](std::size_t begin, std::size_t end) {
      std::size_t count = 0;
      for (std::size_t k = begin; k < end; ++k) {
        const Index i = static_cast<Index>(k);
        if (!is_used[i])
          continue;
        unsigned bits = 0;
        for (std::size_t b = 0; b < neighbors_per_point; ++b) {
          const Index j = scan.neighbors[i][b];
          // two mutual neighbours list their link with the smaller index
          if (j == none || !is_used[j] || !is_link(i, j) || (j < i && knows(j, i)))
            continue;
          bits |= 1U << b;
          ++count;
        }
        m_flags[i] = static_cast<std::uint16_t>(bits);
      }
      m_first[begin / block + 1] = count;
    };
    pcs::internal::for_each_block<ConcurrencyTag>(scan.size(), block, mark);
    for (std::size_t b = 1; b < m_first.size(); ++b)
      m_first[b] += m_first[b - 1];
  }

  std::size_t size() const { return m_first.back() + m_others.size(); }

  /// Appends links.
  void append(const Links& others)
  {
    m_others.insert(m_others.end(), others.begin(), others.end());
  }

  /// Calls `f(link)` for the links with numbers in `[begin, end)`.
  template <class F>
  void for_each(std::size_t begin, std::size_t end, const F& f) const
  {
    const auto after = std::upper_bound(m_first.begin(), m_first.end(), begin);
    std::size_t number = *(after - 1);
    const auto first = static_cast<std::size_t>(after - 1 - m_first.begin()) * block;
    for (std::size_t i = first; i < m_flags.size() && number < end; ++i)
      for (std::size_t b = 0; m_flags[i] >> b != 0 && number < end; ++b)
        if ((m_flags[i] >> b & 1) != 0 && number++ >= begin) {
          const Index j = m_scan->neighbors[i][b];
          f(Link{std::min(static_cast<Index>(i), j), std::max(static_cast<Index>(i), j)});
        }
    for (std::size_t k = std::max(begin, m_first.back()); k < end; ++k)
      f(m_others[k - m_first.back()]);
  }

private:
  static_assert(neighbors_per_point <= 16, "pcs: one bit per neighbour");
  static constexpr std::size_t block = 1024;

  const Scan* m_scan;
  std::vector<std::uint16_t> m_flags; ///< bit b: the link to the b-th neighbour
  std::vector<std::size_t> m_first;   ///< number of the first link of each block of points
  Links m_others;
};

/// Calls `f(link)` for the links with numbers in `[begin, end)`.
template <class F>
void for_each_link(const Compact_links& links, std::size_t begin, std::size_t end, const F& f)
{
  links.for_each(begin, end, f);
}
template <class F>
void for_each_link(const Links& links, std::size_t begin, std::size_t end, const F& f)
{
  for (std::size_t k = begin; k < end; ++k)
    f(links[k]);
}
template <class LinkRange, class F>
void for_each_link(const LinkRange& links, const F& f)
{
  for_each_link(links, 0, links.size(), f);
}

/// Returns a list of the links between neighbours among the points of `is_used`.
template <class ConcurrencyTag>
Links neighbor_links(const Scan& scan,
                     const std::vector<std::uint8_t>& is_used,
                     const Link_rule& rule)
{
  const Compact_links compact(ConcurrencyTag(), scan, is_used, rule);
  const std::size_t n = compact.size();
  Links links;
  links.reserve(n + n / 16); // for links that close gaps
  links.resize(n);
  constexpr std::size_t block = std::size_t(1) << 15;
  pcs::internal::for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    Link* next = links.data() + begin;
    compact.for_each(begin, end, [&](const Link& l) { *next++ = l; });
  });
  return links;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_GRAPH_NEIGHBOR_LINKS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Search for the edges that leave the handles, without reading the whole graph.

#ifndef PCS_DEFORMATION_HANDLES_BORDER_FINDER_H
#define PCS_DEFORMATION_HANDLES_BORDER_FINDER_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/// An edge between a site of a handle and a site outside all handles.
struct Border_edge
{
  std::uint32_t inside, outside;
};

/*!
  Stores which blocks of consecutive sites are connected by edges. If sites are numbered in spatial
  order, most blocks and all blocks connected to them lie entirely inside or entirely outside the
  handles. The edges of these blocks need not be read.
*/
class Border_finder
{
public:
  Border_finder() = default;

  /// Takes O(n + m) time, and a few bytes per block of 256 sites.
  explicit Border_finder(const neighborhood::Proximity_graph& graph)
  {
    const std::size_t n = graph.size();
    std::vector<std::uint32_t> last_seen((n + block_size - 1) / block_size,
                                         0); // last block connected to each block, plus one
    for (std::size_t begin = 0; begin < n; begin += block_size) {
      const auto block = static_cast<std::uint32_t>(begin / block_size);
      last_seen[block] = block + 1;
      for (auto j = graph.begin(begin); j != graph.end(std::min(n, begin + block_size) - 1); ++j)
        if (last_seen[*j / block_size] != block + 1) {
          last_seen[*j / block_size] = block + 1;
          m_neighbor.push_back(static_cast<std::uint32_t>(*j / block_size));
        }
      m_first.push_back(static_cast<std::uint32_t>(m_neighbor.size()));
    }
  }

  /// Returns the edges from sites inside (`is_inside(site)`) to sites outside, in the order of the
  /// rows of `graph`, which must be the graph given to the constructor. O(n) calls of `is_inside`,
  /// and O(edges) in blocks at borders.
  template <class ConcurrencyTag, class IsInside>
  std::vector<Border_edge> find(const neighborhood::Proximity_graph& graph,
                                const IsInside& is_inside) const
  {
    const std::size_t n = graph.size(), number_of_blocks = m_first.size() - 1;
    std::vector<std::uint32_t> count(number_of_blocks); // sites inside, by block
    pcs::internal::for_each_index<ConcurrencyTag>(
        number_of_blocks,
        [&](std::size_t block) {
          std::uint32_t inside = 0;
          for (std::size_t i = block * block_size; i < std::min(n, (block + 1) * block_size); ++i)
            inside += is_inside(i) ? 1 : 0;
          count[block] = inside;
        },
        16);
    const auto has_outside = [&](std::size_t block) {
      return count[block] < std::min(n - block * block_size, block_size);
    };
    std::vector<Border_edge> edges;
    for (std::size_t block = 0; block < number_of_blocks; ++block) {
      if (count[block] == 0 ||
          !(has_outside(block) || std::any_of(m_neighbor.begin() + m_first[block],
                                              m_neighbor.begin() + m_first[block + 1],
                                              has_outside)))
        continue;
      for (std::size_t i = block * block_size; i < std::min(n, (block + 1) * block_size); ++i)
        if (is_inside(i))
          for (auto j = graph.begin(i); j != graph.end(i); ++j)
            if (!is_inside(*j))
              edges.push_back({static_cast<std::uint32_t>(i), *j});
    }
    return edges;
  }

private:
  static constexpr std::size_t block_size = 256;
  std::vector<std::uint32_t> m_first{0}, m_neighbor; ///< other blocks to which each block has edges
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_BORDER_FINDER_H

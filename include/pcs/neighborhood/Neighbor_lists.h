// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The nearest neighbours of all points of a set, ties included.

#ifndef PCS_NEIGHBORHOOD_NEIGHBOR_LISTS_H
#define PCS_NEIGHBORHOOD_NEIGHBOR_LISTS_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Box_tree.h>
#include <pcs/neighborhood/nearest_lanes.h>
#include <pcs/neighborhood/spatial_order.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace neighborhood {

/// Neighbours are added to a row if their distance is at most this factor times that of the k-th
/// neighbour. On a regular grid, exactly k neighbours would be an arbitrary, asymmetric selection
/// among equal distances.
constexpr double distance_tie_factor = 1.01;
/// The largest number of neighbours added by `distance_tie_factor`.
constexpr std::size_t maximal_number_of_ties = 4;
/// The largest `k`, because links in only one direction are marked in 64 bits.
constexpr std::size_t maximal_number_of_neighbors = 64 - maximal_number_of_ties;

namespace internal {

/// The nearest neighbours of each point in rows of the same width, in any order.
struct Neighbor_lists
{
  std::size_t width = 0;
  pcs::internal::Huge_vector<std::uint32_t> neighbor;
  std::vector<std::uint8_t> length; ///< number of neighbours in each row

  std::uint32_t at(std::size_t i, std::size_t b) const { return neighbor[i * width + b]; }
  bool holds(std::size_t i, std::size_t j) const
  {
    const auto* row = neighbor.data() + i * width;
    bool is_found = false; // all neighbours are compared, as an exit could not be predicted
    for (std::size_t b = 0; b < length[i]; ++b)
      is_found |= row[b] == j;
    return is_found;
  }
};

/*!
  Searches the neighbours of all points of a group of a `Box_tree` together. The boxes of the tree
  are compared with the box of the group only. Distances in single precision, eight points at a
  time, exclude nearly all candidates. Double precision decides among the others, so the result is
  exact.
*/
class Group_search
{
public:
  /// \param k the number of neighbours without ties, less than the number of points
  /// \param width the largest number of neighbours
  Group_search(const std::vector<Vec3>& points,
               const Box_tree& tree,
               std::size_t k,
               std::size_t width)
    : m_points(points), m_tree(tree), m_k(k), m_width(width)
  {
    const Tight_box& box = tree.nodes().front().box;
    m_least_reach = 1e-18 * (box.high - box.low).maxCoeff(); // squares stay in the range of a float
  }

  /// Finds the neighbours of the points of a group, and writes them to `lists`. Points that need a
  /// much larger reach than the others are searched alone.
  void search(const Box_tree::Node& group, Neighbor_lists& lists)
  {
    const double reach = search(group, std::min(m_next_reach, first_reach(group)), lists);
    m_pending.swap(m_alone);
    for (const std::uint32_t i : m_alone)
      search({{m_points[i], m_points[i]}, i, i + 1, 1}, reach, lists);
    m_alone.clear();
    m_next_reach = growth_of_reach * reach;
  }

private:
  static constexpr std::size_t lanes = 8;
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr double tie_factor = distance_tie_factor * distance_tie_factor;
  /// Reach of a group, in multiples of that needed by the group before. [-]
  static constexpr double growth_of_reach = 1.2;
  /// Larger growth of the reach concerns few points of a group. [-]
  static constexpr double largest_step = 2;
  /// Growth of a reach with too few points. It is small, since an outlier may be near dense parts,
  /// of which the next reach must not contain many points. [-]
  static constexpr double growth_without_neighbors = 1.3;

  struct Candidate
  {
    double squared_distance;
    std::uint32_t point;
  };
  /// Eight points of the group.
  struct Block
  {
    float query[3 * lanes];
    std::vector<float> smallest, all;
    float limit[lanes]; ///< largest squared distance of a neighbour, rounding included
  };

  /// Starts with the given reach. Returns the reach of the points that are not pending.
  double search(const Box_tree::Node& group, double reach, Neighbor_lists& lists)
  {
    reach = std::max(reach, m_least_reach);
    double reached = -1;
    start(group, reach);
    while (true) {
      gather(group, reached, reach);
      measure();
      const double needed = needed_reach(reach);
      const bool is_all = m_count == m_points.size();
      const bool is_step_large = needed > largest_step * reach;
      const bool are_few = is_step_large && 2 * number_beyond(reach) <= m_size;
      if (needed <= reach || is_all || are_few) {
        write(group, is_all ? infinity : reach, lists);
        return std::min(needed, reach);
      }
      reached = reach;
      reach = is_step_large ? growth_without_neighbors * reach : needed;
    }
  }

  /// Returns the number of points that need a larger reach.
  std::size_t number_beyond(double reach) const
  {
    std::size_t count = 0;
    for (std::size_t i = 0; i < m_size; ++i)
      count += is_within(i, reach) ? 0 : 1;
    return count;
  }

  /// Whether all neighbours of point `i` of the group are within a reach.
  bool is_within(std::size_t i, double reach) const
  {
    const double scaled = m_scale * reach;
    return double(m_blocks[i / lanes].limit[i % lanes]) <= scaled * scaled;
  }

  /// Guesses the distance from the box of the group within which there are `k` neighbours of each
  /// of its points.
  double first_reach(const Box_tree::Node& group)
  {
    const double diagonal = (group.box.high - group.box.low).norm();
    const std::size_t size = group.end - group.begin;
    if (size > m_k) // points evenly distributed over a square need less
      return 1.5 * diagonal / std::sqrt(static_cast<double>(size));
    const std::size_t beside = m_k + 1;
    const std::size_t begin = group.begin - std::min<std::size_t>(group.begin, beside);
    const std::size_t end = std::min(m_points.size(), group.end + beside);
    m_exact.clear();
    for (std::size_t i = begin; i < end; ++i)
      m_exact.push_back({group.box.squared_distance(m_points[i]), 0});
    std::nth_element(m_exact.begin(),
                     m_exact.begin() + static_cast<std::ptrdiff_t>(m_k),
                     m_exact.end(),
                     [](const Candidate& a, const Candidate& b) {
                       return a.squared_distance < b.squared_distance;
                     });
    return std::sqrt(m_exact[m_k].squared_distance);
  }

  void start(const Box_tree::Node& group, double reach)
  {
    m_count = m_number_measured = 0;
    m_center = 0.5 * (group.box.low + group.box.high);
    m_diagonal = (group.box.high - group.box.low).norm();
    m_scale = 1 / (m_diagonal + reach);
    m_size = group.end - group.begin;
    m_number_of_blocks = (m_size + lanes - 1) / lanes;
    if (m_blocks.size() < m_number_of_blocks)
      m_blocks.resize(m_number_of_blocks);
    for (std::size_t i = 0; i < m_number_of_blocks * lanes; ++i) {
      const Vec3 p = m_scale * (m_points[group.begin + std::min(i, m_size - 1)] - m_center);
      for (std::size_t c = 0; c < 3; ++c)
        m_blocks[i / lanes].query[c * lanes + i % lanes] = static_cast<float>(p[Eigen::Index(c)]);
    }
    for (std::size_t b = 0; b < m_number_of_blocks; ++b)
      m_blocks[b].smallest.assign(lanes * (m_k + 1), std::numeric_limits<float>::infinity());
  }

  /// Adds the points in the box of the group grown by `reach`, but not those in the box grown by
  /// `reached`, unless that is negative.
  void gather(const Box_tree::Node& group, double reached, double reach)
  {
    const Tight_box box = group.box.grown(reach);
    const Tight_box known = reached < 0 ? Tight_box::empty() : group.box.grown(reached);
    m_tree.visit_leaves(box, [&](const Box_tree::Node& leaf) {
      reserve(m_count + leaf.end - leaf.begin);
      std::size_t at = m_count;
      for (std::uint32_t j = leaf.begin; j < leaf.end; ++j) { // without branches
        const Vec3& p = m_points[j];
        m_index[at] = j;
        for (Eigen::Index c = 0; c < 3; ++c)
          m_candidate[c][at] = static_cast<float>(m_scale * (p[c] - m_center[c]));
        at += (int(box.contains(p)) & int(!known.contains(p))) != 0 ? 1 : 0;
      }
      m_count = at;
    });
  }

  void reserve(std::size_t count)
  {
    if (count <= m_index.size())
      return;
    m_index.resize(2 * count);
    for (auto& coordinate : m_candidate)
      coordinate.resize(2 * count);
  }

  void measure()
  {
    for (std::size_t b = 0; b < m_number_of_blocks; ++b) {
      Block& block = m_blocks[b];
      if (block.all.size() < lanes * m_count)
        block.all.resize(2 * lanes * m_count);
      lane_kernels().measure({block.query,
                              {m_candidate[0].data(), m_candidate[1].data(), m_candidate[2].data()},
                              m_number_measured,
                              m_count,
                              m_k + 1,
                              block.smallest.data(),
                              block.all.data()});
    }
    m_number_measured = m_count;
  }

  /// Sets the limits of all points. Returns the largest one, as a distance [L].
  double needed_reach(double reach)
  {
    // Coordinates are at most 1, unless the reach has grown. They are rounded to 2^-24.
    constexpr double rounding = 4e-7;
    const double error = rounding * m_scale * (m_diagonal + reach);
    double largest = 0;
    for (std::size_t b = 0; b < m_number_of_blocks; ++b)
      for (std::size_t l = 0; l < lanes; ++l) {
        const double last = double(m_blocks[b].smallest[lanes * m_k + l]);
        const double limit = distance_tie_factor * (std::sqrt(last) + error) + error;
        m_blocks[b].limit[l] = static_cast<float>((1 + 4 * rounding) * limit * limit);
        largest = std::max(largest, limit);
      }
    return (1 + 4 * rounding) * largest / m_scale; // at least the roots of the limits
  }

  /// Whether `a` is nearer than `b`. Coordinates decide ties.
  bool is_nearer(const Candidate& a, const Candidate& b) const
  {
    if (a.squared_distance != b.squared_distance)
      return a.squared_distance < b.squared_distance;
    return lexicographically_less(m_points[a.point], m_points[b.point]);
  }

  /// Writes the neighbours of all points that need no larger reach. The others are pending.
  void write(const Box_tree::Node& group, double reach, Neighbor_lists& lists)
  {
    for (std::size_t b = 0; b < m_number_of_blocks; ++b) {
      const Block& block = m_blocks[b];
      m_hits.find(block.all.data(), m_count, block.limit, m_index.data());
      for (std::size_t l = 0; l < std::min(lanes, m_size - b * lanes); ++l) {
        const std::size_t i = group.begin + b * lanes + l;
        if (is_within(b * lanes + l, reach))
          write_row(i, m_hits.of_query(l), m_hits.count(l), lists);
        else
          m_pending.push_back(static_cast<std::uint32_t>(i));
      }
    }
  }

  /// Writes the neighbours of point `i`, given points that include them and `i` itself.
  void write_row(std::size_t i, const std::uint32_t* hits, std::size_t count, Neighbor_lists& lists)
  {
    std::uint32_t* row = lists.neighbor.data() + i * lists.width;
    if (count == m_k + 1) { // no ties
      for (std::size_t h = 0; h < count; ++h)
        if (hits[h] != i)
          *row++ = hits[h];
      lists.length[i] = static_cast<std::uint8_t>(m_k);
      return;
    }
    m_exact.clear();
    for (std::size_t h = 0; h < count; ++h)
      if (hits[h] != i) {
        const Vec3 e = m_points[hits[h]] - m_points[i];
        m_exact.push_back({e.x() * e.x() + e.y() * e.y() + e.z() * e.z(), hits[h]});
      }
    std::sort(m_exact.begin(), m_exact.end(), [this](const Candidate& a, const Candidate& b) {
      return is_nearer(a, b);
    });
    const double limit = tie_factor * m_exact[m_k - 1].squared_distance;
    std::size_t length = m_k;
    while (length < std::min(m_width, m_exact.size()) && m_exact[length].squared_distance <= limit)
      ++length;
    for (std::size_t b = 0; b < length; ++b)
      row[b] = m_exact[b].point;
    lists.length[i] = static_cast<std::uint8_t>(length);
  }

  const std::vector<Vec3>& m_points;
  const Box_tree& m_tree;
  std::size_t m_k, m_width;
  double m_next_reach = infinity, m_least_reach = 0;
  // of the group
  Vec3 m_center = Vec3::Zero();
  double m_diagonal = 0, m_scale = 1;
  std::size_t m_size = 0, m_number_of_blocks = 0, m_number_measured = 0;
  std::vector<Block> m_blocks;
  std::size_t m_count = 0; ///< candidates
  std::vector<std::uint32_t> m_index;
  std::vector<float> m_candidate[3];
  Lane_hits m_hits;
  std::vector<Candidate> m_exact;
  std::vector<std::uint32_t> m_pending, m_alone; ///< points
};

/// Returns the `k` nearest neighbours of each point, ties included.
template <class ConcurrencyTag>
Neighbor_lists
find_neighbor_lists(const std::vector<Vec3>& points, const Box_tree& tree, std::size_t k)
{
  const std::size_t n = points.size();
  const std::size_t width = std::min(k + maximal_number_of_ties, n > 0 ? n - 1 : 0);
  Neighbor_lists lists{width,
                       pcs::internal::Huge_vector<std::uint32_t>(n * width),
                       std::vector<std::uint8_t>(n, 0)};
  if (width == 0)
    return lists;
  pcs::internal::for_each_block<ConcurrencyTag>(
      tree.groups().size(),
      256,
      [&](std::size_t begin, std::size_t end) {
        Group_search search(points, tree, std::min(k, width), width);
        for (std::size_t group = begin; group < end; ++group)
          search.search(tree.nodes()[tree.groups()[group]], lists);
      });
  return lists;
}

/// Returns the same for points in the order of `spatial_order()`, as fast as possible, or in any
/// other order.
template <class ConcurrencyTag>
Neighbor_lists find_neighbor_lists(const std::vector<Vec3>& points, std::size_t k)
{
  Box_tree tree;
  if (tree.build<ConcurrencyTag>(points))
    return find_neighbor_lists<ConcurrencyTag>(points, tree, k);
  const std::vector<std::uint32_t> order = spatial_order<ConcurrencyTag>(points);
  std::vector<Vec3> ordered(points.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    ordered[i] = points[order[i]];
  tree.build<ConcurrencyTag>(ordered);
  const Neighbor_lists found = find_neighbor_lists<ConcurrencyTag>(ordered, tree, k);
  Neighbor_lists lists = found;
  for (std::size_t i = 0; i < order.size(); ++i) {
    lists.length[order[i]] = found.length[i];
    for (std::size_t b = 0; b < found.length[i]; ++b)
      lists.neighbor[order[i] * lists.width + b] = order[found.at(i, b)];
  }
  return lists;
}

} // namespace internal

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_NEIGHBOR_LISTS_H

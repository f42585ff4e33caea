// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Groups of coincident points.

#ifndef PCS_SHAPE_SPACE_POINTS_DISTINCT_POSITIONS_H
#define PCS_SHAPE_SPACE_POINTS_DISTINCT_POSITIONS_H

#include <pcs/shape_space/model/Rooted_tree.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Groups coincident points. Positions are in the order of their first points.

  Coincident points have the same neighbours and the same costs. Without grouping, all pivots of a
  transport would be degenerate, and nearest-neighbour queries would return an arbitrary subset of
  the points at one position.
*/
class Distinct_positions
{
public:
  explicit Distinct_positions(const std::vector<Vec3>& points)
  {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto is_before = [&](std::uint32_t i, std::uint32_t j) {
      const Vec3 &p = points[i], &q = points[j];
      return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
    };
    std::stable_sort(order.begin(), order.end(), is_before);
    std::vector<std::uint32_t> first(points.size()); // first point at the same position
    for (std::size_t k = 0; k < order.size(); ++k)
      first[order[k]] =
          k > 0 && !is_before(order[k - 1], order[k]) ? first[order[k - 1]] : order[k];
    std::vector<std::uint32_t> position(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (first[i] == i) {
        position[i] = static_cast<std::uint32_t>(m_positions.size());
        m_positions.push_back(points[i]);
        m_begin.push_back(0);
      } else
        position[i] = position[first[i]];
      ++m_begin[position[i]];
    }
    std::size_t sum = 0;
    for (std::size_t& begin : m_begin)
      sum = begin = sum + begin;
    m_begin.push_back(sum);
    m_members.resize(points.size());
    for (std::size_t i = points.size(); i-- > 0;)
      m_members[--m_begin[position[i]]] = static_cast<std::uint32_t>(i);
  }

  const std::vector<Vec3>& positions() const { return m_positions; }
  std::size_t size(std::size_t position) const { return m_begin[position + 1] - m_begin[position]; }
  /// Returns point number `k` at a position.
  std::uint32_t member(std::size_t position, std::size_t k) const
  {
    return m_members[m_begin[position] + k];
  }

private:
  std::vector<Vec3> m_positions;
  std::vector<std::uint32_t> m_members;
  std::vector<std::size_t> m_begin; // of the members of each position, and the end
};

namespace internal {

/// Distributes the points at a position among its corresponding positions, in proportion to their
/// numbers of points, but at least one to each.
class Proportional_shares
{
public:
  explicit Proportional_shares(const Distinct_positions& places)
    : m_places(places), m_wanted(places.positions().size(), 0), m_given(m_wanted)
  {
  }

  void add_partner(std::size_t position, std::size_t number_of_points)
  {
    m_wanted[position] += number_of_points;
  }

  /// Returns the range of points for the next corresponding position: the first index, and the one
  /// after the last. Must be called after all calls of `add_partner()`, once for each of them.
  std::array<std::size_t, 2> next(std::size_t position, std::size_t number_of_points)
  {
    const auto bound = [&] {
      return m_places.size(position) * m_given[position] / m_wanted[position];
    };
    const std::size_t begin = bound();
    m_given[position] += number_of_points;
    return {begin, std::max(begin + 1, bound())};
  }

private:
  const Distinct_positions& m_places;
  std::vector<std::size_t> m_wanted, m_given;
};

} // namespace internal

/// Converts pairs of positions to pairs of points. All points of both positions are paired; points
/// at one position are distributed among the corresponding positions.
inline std::vector<std::pair<std::uint32_t, std::uint32_t>>
pairs_of_points(const Distinct_positions& one,
                const Distinct_positions& two,
                const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs)
{
  internal::Proportional_shares shares_1(one), shares_2(two);
  for (const auto& [i, j] : pairs) {
    shares_1.add_partner(i, two.size(j));
    shares_2.add_partner(j, one.size(i));
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
  for (const auto& [i, j] : pairs) {
    const auto [begin_1, end_1] = shares_1.next(i, two.size(j));
    const auto [begin_2, end_2] = shares_2.next(j, one.size(i));
    const std::size_t n = end_1 - begin_1, m = end_2 - begin_2;
    for (std::size_t k = 0; k < std::max(n, m); ++k)
      result.emplace_back(one.member(i, begin_1 + k % n), two.member(j, begin_2 + k % m));
  }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_DISTINCT_POSITIONS_H

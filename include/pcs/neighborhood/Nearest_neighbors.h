// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// k nearest neighbours of a set of distinct points, with ties decided by coordinates.

#ifndef PCS_NEIGHBORHOOD_NEAREST_NEIGHBORS_H
#define PCS_NEIGHBORHOOD_NEAREST_NEIGHBORS_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Point_tree.h>
#include <pcs/neighborhood/spatial_order.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace neighborhood {

/*!
  Searches `points`, which must stay alive and unchanged. Queries may run concurrently; equal distances are told apart by the
  coordinates of the points. Coordinates should be relative to a near origin: distances are computed in double precision.
*/
class Nearest_neighbors
{
public:
  struct Neighbor
  {
    std::uint32_t index;
    double squared_distance; ///< [L^2]
  };

  template <class ConcurrencyTag = CGAL::Sequential_tag>
  explicit Nearest_neighbors(const std::vector<Vec3>& points, ConcurrencyTag tag = ConcurrencyTag())
    : m_points(points), m_tree(points, tag)
  {
  }

  Nearest_neighbors(const Nearest_neighbors&) = delete;
  Nearest_neighbors& operator=(const Nearest_neighbors&) = delete;

  /// Writes the `k` nearest points of `query` to `result`, nearest first; fewer if there are fewer points.
  void operator()(const Vec3& query, std::size_t k, std::vector<Neighbor>& result) const
  {
    k = std::min(k, m_tree.size());
    result.resize(k);
    if (k == 0)
      return;
    Nearest nearest{m_points, result.data(), k, 0, std::numeric_limits<double>::infinity()};
    m_tree.visit(query, nearest);
  }

  /// Appends the indices of all points closer than `radius` to `query`, in increasing order.
  void within(const Vec3& query, double radius, std::vector<std::uint32_t>& result) const
  {
    const std::size_t before = result.size();
    append_within(query, radius, result);
    std::sort(result.begin() + static_cast<std::ptrdiff_t>(before), result.end());
  }

  /// The same in the order in which they are found.
  void append_within(const Vec3& query, double radius, std::vector<std::uint32_t>& result) const
  {
    Within collector{radius * radius, result};
    m_tree.visit(query, collector);
  }

  /*!
    The nearest point among those for which `is_wanted(index)` holds and that is closer than `radius`; ties by coordinates.
    `squared_distance` is not less than the square of `radius` if there is none.
  */
  template <class Predicate>
  Neighbor nearest_if(const Vec3& query, double radius, const Predicate& is_wanted) const
  {
    Nearest_wanted<Predicate> collector{m_points, is_wanted, {0, radius * radius}, false};
    m_tree.visit(query, collector);
    return collector.best;
  }

private:
  // What the tree asks of a collector.
  struct Nearest
  {
    const std::vector<Vec3>& points;
    Neighbor* found;
    std::size_t wanted, count;
    double limit;
    double worst() const { return limit; }
    bool is_less(double d, std::uint32_t i, const Neighbor& other) const
    {
      return d < other.squared_distance || (d == other.squared_distance &&
                                            lexicographically_less(points[i], points[other.index]));
    }
    void add(double d, std::uint32_t i)
    {
      std::size_t at = count;
      if (count < wanted)
        ++count;
      else if (is_less(d, i, found[count - 1]))
        --at;
      else
        return;
      for (; at > 0 && is_less(d, i, found[at - 1]); --at)
        found[at] = found[at - 1];
      found[at] = {i, d};
      if (count == wanted)
        limit = found[count - 1].squared_distance;
    }
  };
  struct Within
  {
    double squared_radius;
    std::vector<std::uint32_t>& found;
    double worst() const { return squared_radius; }
    void add(double d, std::uint32_t i)
    {
      if (d < squared_radius)
        found.push_back(i);
    }
  };
  template <class Predicate>
  struct Nearest_wanted
  {
    const std::vector<Vec3>& points;
    const Predicate& is_wanted;
    Neighbor best;
    bool is_found;
    double worst() const { return best.squared_distance; }
    void add(double d, std::uint32_t i)
    {
      const bool is_closer = d < best.squared_distance ||
                             (is_found && lexicographically_less(points[i], points[best.index]));
      if (is_closer && is_wanted(i)) {
        best = {i, d};
        is_found = true;
      }
    }
  };

  const std::vector<Vec3>& m_points;
  Point_tree m_tree;
};

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_NEAREST_NEIGHBORS_H

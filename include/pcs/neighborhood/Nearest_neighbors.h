// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// k nearest neighbours of a set of distinct points, with ties decided by coordinates.

#ifndef PCS_NEIGHBORHOOD_NEAREST_NEIGHBORS_H
#define PCS_NEIGHBORHOOD_NEAREST_NEIGHBORS_H

#include <pcs/neighborhood/spatial_order.h>

#include <nanoflann.hpp>

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
  A k-d tree over `points`, which must remain valid and unchanged. Queries may run concurrently.
  Coordinates should be relative to a nearby origin: distances are computed in double precision.
*/
class Nearest_neighbors
{
public:
  struct Neighbor
  {
    std::uint32_t index;
    double squared_distance; ///< [L^2]
  };

  explicit Nearest_neighbors(const std::vector<Vec3>& points)
    : m_adaptor{points}, m_tree(3, m_adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(12))
  {
  }

  Nearest_neighbors(const Nearest_neighbors&) = delete;
  Nearest_neighbors& operator=(const Nearest_neighbors&) = delete;

  /// Writes the `k` points nearest to `query` to `result`, nearest first; all if there are fewer.
  void operator()(const Vec3& query, std::size_t k, std::vector<Neighbor>& result) const
  {
    k = std::min(k, m_adaptor.points.size());
    result.resize(k);
    if (k == 0)
      return;
    thread_local std::vector<std::uint32_t> indices;
    thread_local std::vector<double> distances;
    indices.resize(k);
    distances.resize(k);
    const std::size_t found = m_tree.knnSearch(query.data(), k, indices.data(), distances.data());
    result.resize(found);
    for (std::size_t i = 0; i < found; ++i)
      result[i] = {indices[i], distances[i]};
    bool has_tie = false; // the neighbours are sorted by distance
    for (std::size_t i = 1; i < found; ++i)
      has_tie = has_tie || !(result[i - 1].squared_distance < result[i].squared_distance);
    if (!has_tie)
      return;
    std::sort(result.begin(), result.end(), [&](const Neighbor& a, const Neighbor& b) {
      if (a.squared_distance != b.squared_distance)
        return a.squared_distance < b.squared_distance;
      return lexicographically_less(m_adaptor.points[a.index], m_adaptor.points[b.index]);
    });
  }

  /// Appends the indices of all points closer than `radius` to `query`, in increasing order.
  void within(const Vec3& query, double radius, std::vector<std::uint32_t>& result) const
  {
    const std::size_t before = result.size();
    append_within(query, radius, result);
    std::sort(result.begin() + static_cast<std::ptrdiff_t>(before), result.end());
  }

  /// Appends the indices of all points closer than `radius` to `query`, in the order of the search.
  void append_within(const Vec3& query, double radius, std::vector<std::uint32_t>& result) const
  {
    Collector collector{radius * radius, &result};
    search(query, collector);
  }

  /*!
    Returns the nearest point that is closer than `radius` and satisfies `is_wanted(index)`.
    Coordinates decide ties. `squared_distance` is infinite if there is no such point.
  */
  template <class Predicate>
  Neighbor nearest_if(const Vec3& query, double radius, const Predicate& is_wanted) const
  {
    Filter<Predicate> filter{{0, radius * radius}, &m_adaptor.points, &is_wanted, false};
    search(query, filter);
    if (!filter.is_found)
      return {0, std::numeric_limits<double>::infinity()};
    return filter.best;
  }

private:
  // Result sets of nanoflann, with the members that versions after 1.4 require.
  struct Collector
  {
    using DistanceType = double;

    double squared_radius;
    std::vector<std::uint32_t>* result;
    bool full() const { return true; }
    std::size_t size() const { return result->size(); }
    void sort() {}
    double worstDist() const { return squared_radius; }
    bool addPoint(double d, std::uint32_t i)
    {
      if (d < squared_radius)
        result->push_back(i);
      return true;
    }
  };
  template <class Predicate>
  struct Filter
  {
    using DistanceType = double;

    Neighbor best;
    const std::vector<Vec3>* points;
    const Predicate* is_wanted;
    bool is_found;
    bool full() const { return true; }
    std::size_t size() const { return is_found ? 1 : 0; }
    void sort() {}
    double worstDist() const
    {
      // slightly larger than the best distance, so that ties are found
      return is_found ? std::nextafter(best.squared_distance, 2 * best.squared_distance + 1)
                      : best.squared_distance;
    }
    bool addPoint(double d, std::uint32_t i)
    {
      const bool is_closer = d < best.squared_distance ||
                             (is_found && d == best.squared_distance &&
                              lexicographically_less((*points)[i], (*points)[best.index]));
      if (is_closer && (*is_wanted)(i)) {
        best = {i, d};
        is_found = true;
      }
      return true;
    }
  };

  struct Adaptor
  {
    const std::vector<Vec3>& points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t d) const
    {
      return points[i][static_cast<Eigen::Index>(d)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const
    {
      return false;
    }
  };
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>,
                                                   Adaptor,
                                                   3,
                                                   std::uint32_t>;

  /// Passes points to `results`. The options are the defaults of nanoflann, whose type was renamed
  /// in version 1.5.
  template <class Results>
  void search(const Vec3& query, Results& results) const
  {
    if (!m_adaptor.points.empty())
      static_cast<void>(m_tree.radiusSearchCustomCallback(query.data(), results));
  }

  Adaptor m_adaptor;
  Tree m_tree; ///< built by its constructor
};

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_NEAREST_NEIGHBORS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Chooses the points of a large file that are kept in memory: a stratified random sample.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_KEPT_POINTS_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_KEPT_POINTS_H

#include "deformation/Normals.h"
#include "deformation/apply_edit.h"
#include <pcs/IO/points/Point_table.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace program {

/// A subset of the points with their indices in the file, ascending.
struct Kept_points
{
  std::vector<std::uint64_t> numbers;
  pcs::IO::Point_table table;         ///< positions only
  Normal_vectors normals;             ///< may be empty
  std::vector<std::uint32_t> handles; ///< `no_handle` until they are determined
};

/// Computes a bijective hash of a number.
inline std::uint64_t splitmix64(std::uint64_t x)
{
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/*!
  Keeps all points if there are at most `limit`. Otherwise the file is divided into runs of equal
  length, and one point of each run is selected by a hash: a constant step would interfere with the
  scan lines of the file. Some points are reserved for handles, so that small handles are kept. The
  selection depends only on the numbers of the points.
*/
class Keeper
{
public:
  Keeper(std::uint64_t number_of_points, std::uint64_t limit, std::size_t number_of_handles)
    : m_number_of_points(number_of_points), m_reserves(number_of_handles)
  {
    constexpr std::uint64_t enough = 64; // sufficient for a well-defined rotation of a handle
    if (number_of_points > limit && number_of_handles > 0)
      m_size_of_reserve = std::min(enough, limit / (4 * number_of_handles));
    m_number_of_runs = std::min(number_of_points, limit - m_size_of_reserve * number_of_handles);
    choose_next();
  }

  /// Adds a chunk. `normals` may be empty; `handles` contains the handle of each point or is empty.
  void add(const pcs::IO::Point_table& chunk,
           const Normal_vectors& normals,
           const std::vector<std::uint32_t>& handles,
           std::uint64_t first)
  {
    for (std::size_t i = 0; i < chunk.number_of_points(); ++i) {
      const Point point{first + i,
                        chunk.points()[i],
                        normals.empty() ? Vector_3(0, 0, 0) : normals[i],
                        handles.empty() ? no_handle : handles[i]};
      if (point.number == m_next) {
        append(m_kept, point);
        ++m_run;
        choose_next();
      } else if (m_size_of_reserve > 0 && point.handle != no_handle)
        offer(m_reserves[point.handle], point);
    }
  }

  Kept_points take(bool has_normals)
  {
    std::vector<Point> extra;
    for (const std::vector<Point>& reserve : m_reserves)
      extra.insert(extra.end(), reserve.begin(), reserve.end());
    std::sort(extra.begin(), extra.end(), [](const Point& a, const Point& b) {
      return a.number < b.number;
    });
    if (!extra.empty())
      merge(extra);
    if (!has_normals)
      m_kept.normals = Normal_vectors();
    return std::move(m_kept);
  }

private:
  using Vector_3 = pcs::IO::Point_table::Vector_3;

  struct Point
  {
    std::uint64_t number;
    pcs::IO::Point_table::Point_3 position;
    Vector_3 normal;
    std::uint32_t handle;
  };

  static bool has_lower_hash(const Point& a, const Point& b)
  {
    return splitmix64(a.number) < splitmix64(b.number);
  }

  static void append(Kept_points& to, const Point& point)
  {
    to.numbers.push_back(point.number);
    to.table.points().push_back(point.position);
    to.normals.push_back(point.normal);
    to.handles.push_back(point.handle);
  }

  /// Returns the number of points before a run; no product overflows.
  std::uint64_t begin_of(std::uint64_t run) const
  {
    return run * (m_number_of_points / m_number_of_runs) +
           run * (m_number_of_points % m_number_of_runs) / m_number_of_runs;
  }

  void choose_next()
  {
    if (m_run >= m_number_of_runs) {
      m_next = m_number_of_points; // not the number of a point
      return;
    }
    const std::uint64_t begin = begin_of(m_run), length = begin_of(m_run + 1) - begin;
    m_next = begin + splitmix64(m_run) % length;
  }

  /// Offers a point to a reserve, which is a heap of the points with the lowest hashes.
  void offer(std::vector<Point>& reserve, const Point& point) const
  {
    if (reserve.size() == m_size_of_reserve) {
      if (!has_lower_hash(point, reserve.front()))
        return;
      std::pop_heap(reserve.begin(), reserve.end(), has_lower_hash);
      reserve.pop_back();
    }
    reserve.push_back(point);
    std::push_heap(reserve.begin(), reserve.end(), has_lower_hash);
  }

  void merge(const std::vector<Point>& extra)
  {
    Kept_points merged;
    auto next = extra.begin();
    for (std::size_t i = 0; i < m_kept.numbers.size(); ++i) {
      for (; next != extra.end() && next->number < m_kept.numbers[i]; ++next)
        append(merged, *next);
      append(merged,
             {m_kept.numbers[i], m_kept.table.points()[i], m_kept.normals[i], m_kept.handles[i]});
    }
    for (; next != extra.end(); ++next)
      append(merged, *next);
    m_kept = std::move(merged);
  }

  std::uint64_t m_number_of_points, m_number_of_runs = 0;
  std::uint64_t m_run = 0, m_next = 0;
  std::uint64_t m_size_of_reserve = 0;
  std::vector<std::vector<Point>> m_reserves; // one per handle
  Kept_points m_kept;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_KEPT_POINTS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Dart throwing on triangles: random points with a least distance.

#ifndef PCS_GENERATORS_INTERNAL_DISK_SAMPLING_H
#define PCS_GENERATORS_INTERNAL_DISK_SAMPLING_H

#include <pcs/core/parameters/check_value.h>
#include <pcs/internal/Random_stream.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

using Mesh_triangle = std::array<Eigen::Vector3d, 3>;
/// A point and the unit normal of its triangle.
using Oriented_sample = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

/// Points drawn for each square of side `spacing`. With 16, few gaps are large enough for one more
/// point. [-]
constexpr double number_of_darts_per_square = 16;

/*!
  Points in cells of side `spacing`, by a hash table with open addressing. A slot has the number of
  the last point of its cell, from 1; 0: the slot is free.
*/
class Disk_grid
{
public:
  Disk_grid(const Eigen::Vector3d& origin, double spacing)
    : m_origin(origin), m_inverse(1 / spacing), m_squared(spacing * spacing), m_slots(1024, {0, 0})
  {
  }

  /// Returns whether no point is nearer than the spacing.
  bool is_free(const Eigen::Vector3d& p) const
  {
    const Cell c = cell_of(p);
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dz = -1; dz <= 1; ++dz)
          for (std::uint32_t k = m_slots[slot_of(key_of({c[0] + dx, c[1] + dy, c[2] + dz}))].last;
               k != 0;
               k = m_before[k - 1])
            if ((m_points[k - 1] - p).squaredNorm() < m_squared)
              return false;
    return true;
  }

  void add(const Eigen::Vector3d& p)
  {
    if (2 * (m_number_of_cells + 1) > m_slots.size())
      grow();
    Slot& slot = m_slots[slot_of(key_of(cell_of(p)))];
    if (slot.last == 0) {
      slot.key = key_of(cell_of(p));
      ++m_number_of_cells;
    }
    m_points.push_back(p);
    m_before.push_back(slot.last);
    slot.last = static_cast<std::uint32_t>(m_points.size());
  }

private:
  using Cell = std::array<std::int64_t, 3>;
  struct Slot
  {
    std::uint64_t key;
    std::uint32_t last;
  };

  Cell cell_of(const Eigen::Vector3d& p) const
  {
    const Eigen::Vector3d q = m_inverse * (p - m_origin);
    return {static_cast<std::int64_t>(std::floor(q.x())),
            static_cast<std::int64_t>(std::floor(q.y())),
            static_cast<std::int64_t>(std::floor(q.z()))};
  }
  /// Cells are at least -1 and at most 2^20.
  static std::uint64_t key_of(const Cell& c)
  {
    return static_cast<std::uint64_t>(c[0] + 1) << 42 | static_cast<std::uint64_t>(c[1] + 1) << 21 |
           static_cast<std::uint64_t>(c[2] + 1);
  }
  /// Returns the slot of a cell, or the free slot where it belongs.
  std::size_t slot_of(std::uint64_t key) const
  {
    const std::size_t mask = m_slots.size() - 1; // the size is a power of 2
    std::size_t s = static_cast<std::size_t>(pcs::internal::mix_bits(key)) & mask;
    while (m_slots[s].last != 0 && m_slots[s].key != key)
      s = (s + 1) & mask;
    return s;
  }
  void grow()
  {
    std::vector<Slot> old(2 * m_slots.size(), Slot{0, 0});
    old.swap(m_slots);
    for (const Slot& slot : old)
      if (slot.last != 0)
        m_slots[slot_of(slot.key)] = slot;
  }

  Eigen::Vector3d m_origin;
  double m_inverse, m_squared;
  std::vector<Slot> m_slots;
  std::size_t m_number_of_cells = 0;
  std::vector<Eigen::Vector3d> m_points;
  std::vector<std::uint32_t> m_before; ///< the next point of the same cell, from 1; 0: none
};

/// Returns the sums of the areas of the triangles up to each of them. [L^2]
inline std::vector<double> sums_of_areas(const std::vector<Mesh_triangle>& triangles)
{
  std::vector<double> sums;
  sums.reserve(triangles.size());
  double sum = 0;
  for (const Mesh_triangle& t : triangles) {
    sum += (t[1] - t[0]).cross(t[2] - t[0]).norm() / 2;
    sums.push_back(sum);
  }
  return sums;
}

/// Returns points of the triangles at least `spacing` apart, in the order in which they were drawn.
/// Messages of errors begin with `caller`.
inline std::vector<Oriented_sample> sample_disks(const std::vector<Mesh_triangle>& triangles,
                                                 double spacing,
                                                 std::uint64_t seed,
                                                 const std::string& caller)
{
  using pcs::internal::check;
  check(spacing > 0 && std::isfinite(spacing), caller, "`spacing` must be a positive number");
  const std::vector<double> sums = sums_of_areas(triangles);
  const double area = sums.empty() ? 0 : sums.back();
  check(area > 0 && std::isfinite(area), caller, "the faces have no area, or are too large");
  Eigen::Vector3d low = triangles[0][0], high = low;
  for (const Mesh_triangle& t : triangles)
    for (const Eigen::Vector3d& p : t) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  const double squares = area / spacing / spacing, extent = (high - low).maxCoeff();
  constexpr double most_cells = 1048576, most_squares = 4e9;
  if (!(extent / spacing < most_cells && squares < most_squares)) {
    std::ostringstream message;
    message << "`spacing` is " << spacing
            << ", too small for the size of the mesh; expected more than "
            << std::max(extent / most_cells, std::sqrt(area / most_squares));
    check(false, caller, message.str());
  }

  std::vector<Oriented_sample> samples;
  Disk_grid grid(low, spacing);
  pcs::internal::Random_stream random(seed);
  const auto number = // at least 1, also if the spacing is so large that `squares` is 0
      static_cast<std::uint64_t>(std::max(1.0, std::ceil(number_of_darts_per_square * squares)));
  for (std::uint64_t k = 0; k < number; ++k) {
    const double place = area * random.uniform();
    const auto at = std::upper_bound(sums.begin(), sums.end(), place) - sums.begin();
    const Mesh_triangle& t =
        triangles[std::min(static_cast<std::size_t>(at), triangles.size() - 1)];
    const double s = std::sqrt(random.uniform()), r = random.uniform();
    const Eigen::Vector3d p = (1 - s) * t[0] + s * (1 - r) * t[1] + s * r * t[2];
    if (!grid.is_free(p))
      continue;
    grid.add(p);
    samples.emplace_back(p, (t[1] - t[0]).cross(t[2] - t[0]).normalized());
  }
  return samples;
}

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_DISK_SAMPLING_H

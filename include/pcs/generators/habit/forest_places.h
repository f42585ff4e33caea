// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random places of trunks that keep a distance.

#ifndef PCS_GENERATORS_HABIT_FOREST_PLACES_H
#define PCS_GENERATORS_HABIT_FOREST_PLACES_H

#include <pcs/internal/Random_stream.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/// Returns places in a square about the origin. Its area is 2.5 squared distances for each tree, so
/// discs of half the distance cover 0.31 of it; random places cover up to 0.55.
inline std::vector<std::array<double, 2>>
forest_places(std::size_t number, double distance, std::uint64_t seed)
{
  std::vector<std::array<double, 2>> places;
  if (!(distance > 0))
    return std::vector<std::array<double, 2>>(number, {0, 0});
  if (number == 1)
    return {{0, 0}};
  using Cell = std::pair<long, long>;
  std::map<Cell, std::vector<std::size_t>> cells;
  const double half = 0.5 * distance * std::sqrt(2.5 * static_cast<double>(number)) + distance;
  const auto cell_of = [&](const std::array<double, 2>& p) {
    return Cell{std::lround(std::floor(p[0] / distance)), std::lround(std::floor(p[1] / distance))};
  };
  const auto is_free = [&](const std::array<double, 2>& p) {
    const Cell c = cell_of(p);
    for (long dx = -1; dx <= 1; ++dx)
      for (long dy = -1; dy <= 1; ++dy)
        if (const auto found = cells.find({c.first + dx, c.second + dy}); found != cells.end())
          for (const std::size_t i : found->second)
            if (std::hypot(p[0] - places[i][0], p[1] - places[i][1]) < distance)
              return false;
    return true;
  };
  pcs::internal::Random_stream random(seed);
  while (places.size() < number) {
    const double x = random.uniform(-half, half), y = random.uniform(-half, half);
    const std::array<double, 2> p = {x, y};
    if (!is_free(p))
      continue;
    cells[cell_of(p)].push_back(places.size());
    places.push_back(p);
  }
  return places;
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_FOREST_PLACES_H

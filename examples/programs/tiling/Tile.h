// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The rectangles of a tile.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_TILE_H
#define PCS_EXAMPLES_PROGRAMS_TILING_TILE_H

#include "tiling/Count_grid.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace program {

/// A rectangle: lower and upper corner.
struct Box_2
{
  Position_2 low{}, high{};
};

inline nlohmann::ordered_json to_json(const Box_2& box)
{
  return {{"low", box.low}, {"high", box.high}};
}

/// The cores of all tiles are half-open (`low <= p < high`) and do not overlap. Their union is the
/// rectangle of all cells. The buffered boxes are closed (`low <= p <= high`).
struct Tile
{
  Box_2 core, buffered;
  std::uint64_t number_of_core_points = 0;
};

inline bool is_in_core(const Tile& tile, const Position_2& p)
{
  return tile.core.low[0] <= p[0] && p[0] < tile.core.high[0] && tile.core.low[1] <= p[1] &&
         p[1] < tile.core.high[1];
}

inline bool is_in_buffered(const Tile& tile, const Position_2& p)
{
  return tile.buffered.low[0] <= p[0] && p[0] <= tile.buffered.high[0] &&
         tile.buffered.low[1] <= p[1] && p[1] <= tile.buffered.high[1];
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_TILE_H

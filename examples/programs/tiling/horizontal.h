// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The horizontal coordinates of a point.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_HORIZONTAL_H
#define PCS_EXAMPLES_PROGRAMS_TILING_HORIZONTAL_H

#include "tiling/Count_grid.h"
#include <pcs/IO/points/Point_table.h>

#include <cstddef>

namespace program {

/// Returns the two coordinates other than the one along `axis_up`, in their order.
inline Position_2 horizontal(const pcs::IO::Point_table::Point_3& p, std::size_t axis_up)
{
  return {p[axis_up == 0 ? 1 : 0], p[axis_up == 2 ? 1 : 2]};
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_HORIZONTAL_H

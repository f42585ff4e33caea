// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The height of a scan in breast heights, which tells whether both have the same unit.

#ifndef PCS_EXAMPLES_PROGRAMS_SCAN_SCAN_HEIGHT_H
#define PCS_EXAMPLES_PROGRAMS_SCAN_SCAN_HEIGHT_H

#include "common/up_direction.h"
#include <pcs/IO/points/Point_table.h>

#include <algorithm>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace program {

/// Returns the extent of a scan along `up`, a value of --up, without the lowest and the highest
/// 0.1 % of the points [L].
inline double scan_height(const pcs::IO::Point_table& table, const std::string& up)
{
  const auto direction = up_direction<pcs::IO::Point_table::Kernel>(up);
  std::vector<double> heights;
  heights.reserve(table.number_of_points());
  for (const auto& p : table.points())
    heights.push_back(p.x() * direction.x() + p.y() * direction.y() + p.z() * direction.z());
  if (heights.empty())
    return 0;
  const auto left_out = static_cast<std::ptrdiff_t>(heights.size() / 1000);
  const auto low = heights.begin() + left_out, high = heights.end() - 1 - left_out;
  std::nth_element(heights.begin(), low, heights.end());
  std::nth_element(low, high, heights.end());
  return *high - *low;
}

/// Returns a clause that says what to check if a scan shows no tree.
inline std::string advice_of_height(double height, double breast_height)
{
  std::ostringstream text;
  text.precision(3);
  text << "the scan is " << height << " high, " << height / breast_height
       << " times breast height; check the unit of --breast-height, and --up";
  return text.str();
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SCAN_SCAN_HEIGHT_H

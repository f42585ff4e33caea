// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees that seem to have different units of length.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_UNIT_WARNING_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_UNIT_WARNING_H

#include <CGAL/Bbox_3.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>

namespace program {

/// Lengths of trees that differ by a larger factor are taken for different units. Metres and
/// centimetres differ by 100, and trees in one unit seldom by 50.
constexpr double largest_size_ratio = 50;

/// Returns the diagonal of the bounding box of a skeleton. [L]
template <class Skeleton>
double extent(const Skeleton& tree)
{
  CGAL::Bbox_3 box;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    box += tree[v].point.bbox();
  return std::hypot(box.xmax() - box.xmin(), box.ymax() - box.ymin(), box.zmax() - box.zmin());
}

/// Returns a warning if the extents of two trees seem to have different units; otherwise nothing.
inline std::string unit_warning(double a, double b)
{
  std::ostringstream text;
  if (std::max(a, b) > largest_size_ratio * std::min(a, b))
    text << "the extents are " << a << " and " << b << "; check the units of both trees";
  return text.str();
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_UNIT_WARNING_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Targets are a range of points.

#include <pcs/Point_set_deformation.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
using Target = double;
#else
using Target = Point;
#endif

void compile(pcs::Point_set_deformation<std::vector<Point>>& session,
             std::size_t handle,
             const std::vector<Target>& targets)
{
  session.set_targets(handle, targets);
}

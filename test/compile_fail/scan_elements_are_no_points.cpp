// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The elements of a scan of a tree must be points, or have a map to points.

#include <pcs/orl_geodesic.h>

#include <CGAL/Simple_cartesian.h>

#include <array>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Skeleton = pcs::Tree_skeleton<Kernel>;

#ifdef PCS_BREAK_THE_RULE
using Element = std::array<double, 3>;
#else
using Element = Kernel::Point_3;
#endif

void compile(const Skeleton& a, const Skeleton& b, const std::vector<Element>& scan)
{
  Skeleton tree;
  std::vector<Kernel::Point_3> points;
  pcs::orl_geodesic(a, scan, b, scan, 0.5, tree, points);
}

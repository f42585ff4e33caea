// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Temporary points are a view of points that remain.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/range/iterator_range.hpp>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

void compile(std::vector<Point>& points, const std::vector<int>& handle)
{
#ifdef PCS_BREAK_THE_RULE
  pcs::deform_point_set(std::vector<Point>(points), handle, handle, pcs::Similarity());
#else
  pcs::deform_point_set(boost::make_iterator_range(points), handle, handle, pcs::Similarity());
#endif
}

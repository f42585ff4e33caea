// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Parallel_tag needs TBB.

#undef CGAL_LINKED_WITH_TBB
#undef PCS_WITH_TBB
#define PCS_WITH_TBB 0

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

#ifdef PCS_BREAK_THE_RULE
using Tag = CGAL::Parallel_tag;
#else
using Tag = CGAL::Parallel_if_available_tag;
#endif

void compile(std::vector<CGAL::Simple_cartesian<double>::Point_3>& points,
             const std::vector<int>& handle)
{
  pcs::deform_point_set<Tag>(points, handle, handle, pcs::Similarity());
}

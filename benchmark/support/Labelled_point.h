// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of virtual stands for benchmarks of the segmentation.

#ifndef PCS_BENCHMARK_SUPPORT_LABELLED_POINT_H
#define PCS_BENCHMARK_SUPPORT_LABELLED_POINT_H

#include <pcs/core/Tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <cstddef>

namespace pcs_bench {

/// Point of a virtual stand, with its true and its segmented tree.
struct Labelled_point
{
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  Point point;
  int truth = -1;                ///< index of the tree; -1: anything else
  std::size_t found = pcs::npos; ///< index of the segmented tree
};

/// The position of a labelled point, and its segmented tree, as property maps.
struct Position_map
{
  using key_type = Labelled_point;
  using value_type = Labelled_point::Point;
  using reference = const value_type&;
  using category = boost::readable_property_map_tag;
  friend reference get(const Position_map&, const Labelled_point& p) { return p.point; }
};
struct Found_map
{
  using key_type = Labelled_point;
  using value_type = std::size_t;
  using reference = std::size_t;
  using category = boost::writable_property_map_tag;
  friend void put(const Found_map&, Labelled_point& p, std::size_t tree) { p.found = tree; }
};

} // namespace pcs_bench

#endif // PCS_BENCHMARK_SUPPORT_LABELLED_POINT_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How points are matched to points.

#ifndef PCS_SHAPE_SPACE_TRANSPORT_OPTIONS_H
#define PCS_SHAPE_SPACE_TRANSPORT_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace shape_space {

struct Sinkhorn_options
{
  double regularization = 0.02;  ///< final epsilon, as a share of the largest cost
  std::size_t iterations = 1000; ///< at the final epsilon
  double tolerance = 1e-6;       ///< stops at this violation of the marginals
};

enum class Point_transport {
  exact,   ///< network simplex
  sinkhorn ///< regularised, as in the text
};

enum class Point_weights {
  area, ///< a point stands for the surface around it
  equal ///< all points alike, as in the text
};

struct Transport_options
{
  Point_transport method = Point_transport::exact;
  Point_weights weights = Point_weights::area;
  bool is_squared =
      true; ///< cost is the squared distance, as a 2-Wasserstein distance wants; the text's is not
  /// Mass goes at most that many times the median distance between nearest points of the two trees. What finds no room within it, as
  /// opposite of a gap of the other scan, shifts nothing: its partner is the nearest point. Infinite: all is carried, as in the text.
  double reach = 2;
  std::size_t number_of_neighbors = 16; ///< candidates of each point in the other tree
  std::size_t largest_window =
      1000; ///< points of a tree that are transported together, at most twice as many
  std::size_t least_window = 24; ///< edges are joined until both trees have as many points
  Sinkhorn_options sinkhorn;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TRANSPORT_OPTIONS_H

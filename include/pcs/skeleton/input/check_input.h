// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks of the input points and of the hints that belong to them.

#ifndef PCS_SKELETON_INPUT_CHECK_INPUT_H
#define PCS_SKELETON_INPUT_CHECK_INPUT_H

#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/internal/text.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/model/Given_skeleton.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! least number of different points of a scan [count]
constexpr std::size_t lowest_number_of_scan_points = 10;

namespace skeleton {

/// Largest coordinate; squares of volumes would overflow beyond it [L].
constexpr double largest_coordinate = 1e50;

namespace internal {

inline bool is_coordinate(const Vec3& p)
{
  return p.allFinite() && p.cwiseAbs().maxCoeff() <= largest_coordinate;
}

/// Reads the positions of a range. Throws `Invalid_input`, whose text begins with `function`, at an
/// invalid position.
template <class PointRange, class PointMap>
std::vector<Vec3>
read_input(const PointRange& points, const PointMap& point_map, const std::string& function)
{
  std::vector<Vec3> input;
  input.reserve(static_cast<std::size_t>(std::end(points) - std::begin(points)));
  for (auto it = std::begin(points); it != std::end(points); ++it) {
    const Vec3 p = to_vec3(get(point_map, *it));
    if (!is_coordinate(p))
      throw Invalid_input(function + ": point " + std::to_string(input.size()) +
                          " is not finite, or beyond 1e50");
    input.push_back(p);
  }
  return input;
}

inline void check_number_of_points(const std::vector<Vec3>& input, const std::string& function)
{
  std::vector<Vec3> some;
  for (const Vec3& p : input) {
    if (some.size() < lowest_number_of_scan_points &&
        std::find(some.begin(), some.end(), p) == some.end())
      some.push_back(p);
    if (some.size() == lowest_number_of_scan_points)
      return;
  }
  throw Invalid_input(function + ": there are only " + std::to_string(some.size()) +
                      " different points; there must be at least " +
                      std::to_string(lowest_number_of_scan_points));
}

constexpr const char* other_coordinates = "; it must be in the coordinates and unit of the points";

/// Largest distance of scanners, in diagonals of the bounding box of the points [-]. Farther
/// scanners are probably in different coordinates.
constexpr double farthest_scanner = 500;

/// Throws `Invalid_input` if a position of a given skeleton is too large or its length is zero.
inline void check_given(const Given_skeleton& given, const std::string& function)
{
  const auto at_root = [&](const Vec3& p) { return p == given.points.front(); };
  pcs::internal::check(std::all_of(given.points.begin(), given.points.end(), is_coordinate),
                       function,
                       "given_skeleton has a position beyond 1e50");
  pcs::internal::check(!std::all_of(given.points.begin(), given.points.end(), at_root),
                       function,
                       "all nodes of given_skeleton coincide; at least two must differ");
}

} // namespace internal

/*!
  Throws `Invalid_input`, whose text begins with `function`, if there are too few points, or if the
  root, the whole given skeleton or a scanner is too far away. The limit for the root and the
  skeleton is the diagonal of the bounding box of the points; that for scanners is far larger. O(n).
*/
inline void
check_input(const std::vector<Vec3>& input, const Session_hints& hints, const std::string& function)
{
  internal::check_number_of_points(input, function);
  Vec3 low = input.front(), high = low;
  for (const Vec3& p : input) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto distance = [&](const Vec3& p) { return (p - p.cwiseMax(low).cwiseMin(high)).norm(); };
  const double diagonal = (high - low).norm();
  const auto check = [&](double away, double largest, const char* what, const char* advice) {
    pcs::internal::check(away <= largest,
                         function,
                         std::string(what) + " is " + pcs::internal::to_text(away) +
                             " away from the points, which lie in a box with a diagonal of " +
                             pcs::internal::to_text(diagonal) + advice);
  };
  for (const Vec3& p : hints.scanners)
    check(distance(p),
          internal::farthest_scanner * diagonal,
          "a scanner",
          internal::other_coordinates);
  if (hints.root)
    check(distance(*hints.root), diagonal, "root_position", internal::other_coordinates);
  if (hints.given) {
    internal::check_given(*hints.given, function);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& p : hints.given->points)
      nearest = std::min(nearest, distance(p));
    check(nearest, diagonal, "given_skeleton", internal::other_coordinates);
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_INPUT_CHECK_INPUT_H

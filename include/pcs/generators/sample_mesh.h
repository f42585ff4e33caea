// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Poisson-disk sampling: random points of a mesh, none of which are nearer to each other than a
// given distance.

#ifndef PCS_GENERATORS_SAMPLE_MESH_H
#define PCS_GENERATORS_SAMPLE_MESH_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/generators/internal/Disk_sampling.h>

#include <CGAL/Kernel_traits.h>
#include <CGAL/number_utils.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

/// Whether the triangles around the first corner of a polygon cover it: none of them is inverted.
/// Errors of rounding are tolerated.
inline bool is_divided_by_first_corner(const std::vector<Eigen::Vector3d>& corners)
{
  constexpr double tolerance = 1e-6; // of the squared size
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squared_size = 0, largest = 0;
  const auto area_vector = [&](std::size_t k) -> Eigen::Vector3d {
    return (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]);
  };
  for (std::size_t k = 2; k < corners.size(); ++k) {
    sum += area_vector(k);
    largest = std::max(largest, area_vector(k).norm());
    squared_size = std::max({squared_size,
                             (corners[k - 1] - corners[0]).squaredNorm(),
                             (corners[k] - corners[0]).squaredNorm()});
  }
  const double least = tolerance * squared_size;
  if (largest > least && sum.norm() <= least)
    return false; // the polygon crosses itself
  const Eigen::Vector3d normal = sum.normalized();
  for (std::size_t k = 2; k < corners.size(); ++k)
    if (area_vector(k).dot(normal) < -least)
      return false;
  return true;
}

/// Divides the faces into triangles around their first corners. Throws `Invalid_input` if a corner
/// does not exist, is not finite, or is missing, or if the triangles of a polygon overlap.
template <class PointRange, class FaceRange>
std::vector<Mesh_triangle>
triangles_of(const PointRange& points, const FaceRange& faces, const std::string& caller)
{
  using Difference = typename std::iterator_traits<decltype(std::begin(points))>::difference_type;
  const auto n = static_cast<std::size_t>(std::distance(std::begin(points), std::end(points)));
  std::vector<Mesh_triangle> triangles;
  std::vector<Eigen::Vector3d> corners;
  std::size_t number = 0;
  for (const auto& face : faces) {
    corners.clear();
    for (const auto v : face) {
      const auto index = static_cast<std::int64_t>(v);
      const bool is_valid = index >= 0 && static_cast<std::size_t>(index) < n;
      pcs::internal::check(is_valid,
                           caller,
                           "face " + std::to_string(number) + " has the corner " +
                               std::to_string(v) + ", there are " + std::to_string(n) + " points");
      const auto& p = *(std::begin(points) + static_cast<Difference>(index));
      corners.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
      pcs::internal::check(corners.back().allFinite(),
                           caller,
                           "point " + std::to_string(v) + " of face " + std::to_string(number) +
                               " is not finite");
    }
    pcs::internal::check(corners.size() > 2,
                         caller,
                         "face " + std::to_string(number) + " has " +
                             std::to_string(corners.size()) + " corners, expected at least 3");
    pcs::internal::check(corners.size() == 3 || is_divided_by_first_corner(corners),
                         caller,
                         "face " + std::to_string(number) +
                             " is not convex, or crosses itself; divide it into triangles");
    for (std::size_t k = 2; k < corners.size(); ++k)
      triangles.push_back({corners[0], corners[k - 1], corners[k]});
    ++number;
  }
  return triangles;
}

} // namespace internal
} // namespace generators

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief samples a mesh by random points whose distances are at least `spacing` (Poisson disks), as
      in section 4.11 of \cite aiteanu2022.

  Points are drawn uniformly by area, and kept if no kept point is nearer than `spacing`, until 16
  points have been drawn for each square of side `spacing`. A surface that is flat at the scale of
  `spacing` has about 0.61 points for each such square: for one point per square centimetre,
  `spacing` is 0.78 cm. Distances are measured in space, so thin twigs have fewer points for their
  area.

  O(A / spacing^2) for a mesh of area A. The result depends on the seed only. Runs on one thread.

  \param points a random access range of points
  \param faces a range of ranges of indices of points: polygons with three corners or more, planar
      and convex. They are divided into triangles around their first corners. Faces without area get
      no points
  \param spacing least distance of two points, more than 0 [L]
  \param out an output iterator that accepts `std::pair<Point, Vector>` of the kernel of the points:
      a point of a face, and the unit normal of the face. Corners are counter-clockwise if one looks
      against the normal
  \param np named parameters

  \npbegin
    \np{random_seed} seed of the random points
      \nptype integer
      \npdefault `0`
  \npend

  \return the output iterator behind the last point
  \throws Invalid_input if `spacing` is not a positive number; a face has less than three corners,
      or a corner that does not exist or is not finite; triangles around the first corner of a face
      overlap, because the face is not convex or crosses itself; the mesh has no area; or `spacing`
      is so small that there would be more than 4e9 points, or the mesh is larger than 2^20
      spacings. Nothing has been written then
*/
template <class PointRange,
          class FaceRange,
          class OutputIterator,
          class NamedParameters = parameters::Default_named_parameters>
OutputIterator sample_mesh(const PointRange& points,
                           const FaceRange& faces,
                           double spacing,
                           OutputIterator out,
                           const NamedParameters& np = NamedParameters())
{
  const std::string caller = "pcs::sample_mesh()";
  constexpr bool has_points = is_point_range_v<PointRange>;
  static_assert(has_points, "pcs::sample_mesh(): `points` must be a range of points");
  pcs::internal::check_names<CGAL::internal_np::random_seed_t>(np);
  static_assert(
      pcs::internal::is_integer_parameter_v<NamedParameters, CGAL::internal_np::random_seed_t>,
      "pcs::sample_mesh(): named parameter `random_seed` must be an integer");
  if constexpr (has_points) {
    using Point = std::decay_t<decltype(*std::begin(points))>;
    using Kernel = typename CGAL::Kernel_traits<Point>::Kernel;
    using FT = typename Kernel::FT;
    const auto samples = generators::internal::sample_disks(
        generators::internal::triangles_of(points, faces, caller),
        spacing,
        pcs::internal::read_random_seed(np),
        caller);
    for (const auto& [p, n] : samples)
      *out++ = std::pair<Point, typename Kernel::Vector_3>(
          Point(FT(p.x()), FT(p.y()), FT(p.z())),
          typename Kernel::Vector_3(FT(n.x()), FT(n.y()), FT(n.z())));
  }
  return out;
}

} // namespace pcs

#endif // PCS_GENERATORS_SAMPLE_MESH_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads and checks the options, landmarks and targets of a registration.

#ifndef PCS_REGISTRATION_READ_FIT_INPUT_H
#define PCS_REGISTRATION_READ_FIT_INPUT_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/deformation/model/Local_frame.h>
#include <pcs/deformation/model/Sampling_options.h>
#include <pcs/internal/text.h>
#include <pcs/neighborhood/Neighbor_lists.h>
#include <pcs/registration/Fit_options.h>
#include <pcs/registration/Fit_session.h>

#include <CGAL/property_map.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace registration {

/// Least number of points of a cloud. [count]
constexpr std::size_t least_number_of_points = 4;
/// Largest distance of a target point from the median of the source. [extents]
constexpr double largest_distance = 1e6;

/// Reads the sampling of the source. Throws `Invalid_input` if a parameter is out of range.
template <class NamedParameters>
deformation::Sampling_options read_fit_sampling(const NamedParameters& np,
                                                const std::string& caller)
{
  namespace tags = pcs::internal_np;
  using pcs::internal::is_integer_parameter_v;
  constexpr bool are_integers =
      is_integer_parameter_v<NamedParameters, tags::number_of_samples_t> &&
      is_integer_parameter_v<NamedParameters, tags::number_of_neighbors_t>;
  static_assert(are_integers,
                "pcs::fit_point_set(): number_of_samples and number_of_neighbors must be integers");
  static_assert(pcs::internal::is_parameter_v<bool, NamedParameters, tags::do_preserve_volume_t>,
                "pcs::fit_point_set(): named parameter `do_preserve_volume` must be a bool");
  deformation::Sampling_options options;
  options.number_of_samples = default_number_of_fit_samples;
  options.number_of_sample_neighbors = carriers_of_point;
  options.do_preserve_volume = false;
  pcs::internal::read_parameter(np, tags::do_preserve_volume, options.do_preserve_volume);
  if constexpr (are_integers) {
    // A single sample has no edges.
    constexpr std::size_t least_samples = 2, most_samples = 100000, least_neighbors = 2;
    options.number_of_samples = pcs::internal::check_count(
        caller,
        "number_of_samples",
        pcs::internal::choose(np, tags::number_of_samples, options.number_of_samples),
        least_samples,
        most_samples);
    options.number_of_neighbors = pcs::internal::check_count(
        caller,
        "number_of_neighbors",
        pcs::internal::choose(np, tags::number_of_neighbors, options.number_of_neighbors),
        least_neighbors,
        neighborhood::maximal_number_of_neighbors);
  }
  return options;
}

/// Reads the options of the stages. Throws like `read_fit_sampling()`.
template <class NamedParameters>
Fit_options read_fit_options(const NamedParameters& np, const std::string& caller)
{
  namespace tags = pcs::internal_np;
  using pcs::internal::is_parameter_v;
  static_assert(is_parameter_v<double, NamedParameters, tags::stiffness_t> &&
                    is_parameter_v<double, NamedParameters, tags::fitting_length_t> &&
                    is_parameter_v<double, NamedParameters, tags::outlier_share_t> &&
                    is_parameter_v<double, NamedParameters, tags::tolerance_t>,
                "pcs::fit_point_set(): stiffness, fitting_length, outlier_share and tolerance must "
                "be numbers");
  static_assert(is_parameter_v<bool, NamedParameters, tags::do_align_t>,
                "pcs::fit_point_set(): named parameter `do_align` must be a bool");
  using Iterations = CGAL::internal_np::number_of_iterations_t;
  constexpr bool is_integer = pcs::internal::is_integer_parameter_v<NamedParameters, Iterations>;
  static_assert(is_integer, "pcs::fit_point_set(): number_of_iterations must be an integer");
  Fit_options options;
  pcs::internal::read_parameter(np, tags::stiffness, options.stiffness);
  pcs::internal::read_parameter(np, tags::fitting_length, options.fitting_length);
  pcs::internal::read_parameter(np, tags::outlier_share, options.outlier_share);
  pcs::internal::read_parameter(np, tags::tolerance, options.tolerance);
  pcs::internal::read_parameter(np, tags::do_align, options.do_align);
  if constexpr (is_integer)
    options.number_of_iterations = pcs::internal::check_count(
        caller,
        "number_of_iterations",
        pcs::internal::choose(np, Iterations(), options.number_of_iterations),
        1,
        1000000);
  pcs::internal::check_in_range(caller, "stiffness", options.stiffness, 1e-3, 1e3);
  pcs::internal::check_in_range(caller, "fitting_length", options.fitting_length, 1e-3, 1);
  pcs::internal::check_in_range(caller, "outlier_share", options.outlier_share, 0, 0.9);
  pcs::internal::check_at_least(caller, "tolerance", options.tolerance, 0);
  return options;
}

/// Throws `Invalid_input` unless a cloud has enough points.
inline void
check_number_of_points(std::size_t n, const std::string& cloud, const std::string& caller)
{
  if (n < least_number_of_points)
    throw Invalid_input(caller + ": the " + cloud + " has " + std::to_string(n) +
                        (n == 1 ? " point" : " points") + "; at least " +
                        std::to_string(least_number_of_points) + " are needed");
}

/*!
  Converts landmarks to local coordinates. Throws `Invalid_input` if one is out of range or not
  finite, or if a source point has two different targets.
*/
template <class ConcurrencyTag>
std::vector<Local_landmark> local_landmarks(const std::vector<Landmark>& landmarks,
                                            const Fit_session<ConcurrencyTag>& session,
                                            const std::string& caller)
{
  std::vector<Local_landmark> result;
  const std::size_t n = session.number_of_points();
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const std::string name = caller + ": landmark " + std::to_string(l);
    if (landmarks[l].index >= n)
      throw Invalid_input(name + " has source point " + std::to_string(landmarks[l].index) +
                          "; there are " + std::to_string(n) + " points, numbered from 0");
    const Vec3 target = session.frame().to_local(landmarks[l].target);
    if (!target.allFinite() || !(target.norm() <= largest_distance))
      throw Invalid_input(name + " has a target that is not finite, or more than " +
                          pcs::internal::to_text(largest_distance) +
                          " extents away from the source");
    result.push_back({static_cast<std::uint32_t>(landmarks[l].index), target});
  }
  const auto less = [&](std::size_t a, std::size_t b) {
    return landmarks[a].index != landmarks[b].index ? landmarks[a].index < landmarks[b].index
                                                    : a < b;
  };
  std::vector<std::size_t> order(landmarks.size());
  for (std::size_t l = 0; l < order.size(); ++l)
    order[l] = l;
  std::sort(order.begin(), order.end(), less);
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Landmark &a = landmarks[order[k - 1]], &b = landmarks[order[k]];
    if (a.index == b.index && a.target != b.target)
      throw Invalid_input(caller + ": landmarks " + std::to_string(order[k - 1]) + " and " +
                          std::to_string(order[k]) + " give source point " +
                          std::to_string(a.index) + " two different targets; keep one of them");
  }
  return result;
}

/// Reads the points and normals of a cloud that is not changed. Throws `Invalid_input` if it has
/// too few points, or a point or normal is not finite.
template <class PointRange, class NamedParameters>
Fit_input
read_target(const PointRange& target, const NamedParameters& np, const std::string& caller)
{
  Fit_input result;
  using Element = pcs::Element_reference<const PointRange>;
  using Value = std::decay_t<Element>;
  const auto point_map =
      pcs::internal::choose(np, CGAL::internal_np::point_map, CGAL::Identity_property_map<Value>());
  constexpr bool is_ok = is_readable_point_map_v<std::decay_t<decltype(point_map)>, Value>;
  static_assert(is_ok,
                "pcs::fit_point_set(): `point_map` of the target must be a property map of its "
                "elements with values that have x(), y(), z(), like Kernel::Point_3");
  if constexpr (is_ok) {
    for (const auto& element : target)
      result.points.push_back(pcs::internal::to_eigen(get(point_map, element)));
    using Normal = CGAL::internal_np::normal_t;
    if constexpr (pcs::internal::is_given_v<NamedParameters, Normal>) {
      const auto normal_map = CGAL::parameters::get_parameter(np, Normal());
      for (const auto& element : target)
        result.normals.push_back(pcs::internal::to_eigen(get(normal_map, element)));
    }
  }
  check_number_of_points(result.points.size(), "target", caller);
  for (std::size_t i = 0; i < result.points.size(); ++i)
    if (!result.points[i].allFinite() ||
        (!result.normals.empty() && !result.normals[i].allFinite()))
      throw Invalid_input(caller + ": point " + std::to_string(i) +
                          " of the target, or its normal, is not finite; remove it");
  return result;
}

/// Converts a target to local coordinates. Throws `Invalid_input` if a point is too far away, or
/// all points coincide.
inline void localize(const deformation::Local_frame& frame,
                     double extent,
                     const std::string& caller,
                     std::vector<Vec3>& points)
{
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = frame.to_local(points[i]);
    const double distance = points[i].norm() / extent;
    if (!(distance <= largest_distance))
      throw Invalid_input(caller + ": point " + std::to_string(i) + " of the target is " +
                          pcs::internal::to_text(distance) +
                          " extents of the source away; at most " +
                          pcs::internal::to_text(largest_distance) +
                          " are possible. Check the units and origins of both clouds");
  }
  if (std::all_of(points.begin(), points.end(), [&](const Vec3& p) { return p == points[0]; }))
    throw Invalid_input(caller +
                        ": all points of the target coincide, or extend over less than the "
                        "rounding error of the source. Check the units of both clouds");
}

/// Makes normals unit vectors; null vectors remain.
inline void normalize(std::vector<Vec3>& normals)
{
  for (Vec3& n : normals) {
    const double length = n.stableNorm();
    n = length > 0 ? Vec3(n / length) : n;
  }
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_READ_FIT_INPUT_H

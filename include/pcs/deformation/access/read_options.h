// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Converts the named parameters of a deformation to the options of its session.

#ifndef PCS_DEFORMATION_ACCESS_READ_OPTIONS_H
#define PCS_DEFORMATION_ACCESS_READ_OPTIONS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Deformation_options.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Sampling_options.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

using pcs::internal::is_parameter_v;
using pcs::internal::read_parameter;
namespace tags = pcs::internal_np;

constexpr std::size_t max_number_of_sample_neighbors = 32;
constexpr std::size_t max_number_of_iterations = 1000000;

/// Reads an integer of any type in `[lowest, highest]`.
template <class NamedParameters, class Tag>
void read_count(const NamedParameters& np,
                Tag tag,
                const std::string& caller,
                const std::string& name,
                std::size_t lowest,
                std::size_t highest,
                std::size_t& value)
{
  constexpr bool is_integer = pcs::internal::is_integer_parameter_v<NamedParameters, Tag>;
  static_assert(is_integer,
                "pcs: number_of_samples, number_of_neighbors, number_of_sample_neighbors and "
                "number_of_iterations must be integers");
  if constexpr (is_integer)
    value = pcs::internal::check_count(caller,
                                       name,
                                       pcs::internal::choose(np, tag, value),
                                       lowest,
                                       highest);
}

template <class NamedParameters, class Tag>
void read_number(const NamedParameters& np, Tag tag, double& value)
{
  static_assert(is_parameter_v<double, NamedParameters, Tag>,
                "pcs: tolerance, stiffness and poisson_ratio must be numbers");
  read_parameter(np, tag, value);
}

} // namespace internal

/// Converts indices to 32 bits. Throws `Invalid_input` if one is not below `n`.
template <class IndexRange>
std::vector<std::uint32_t>
read_indices(const IndexRange& indices, std::size_t n, const std::string& caller)
{
  static_assert(is_index_range_v<IndexRange>,
                "pcs: a handle or a region of interest must be a range of integers, the numbers of "
                "its points, or a range of keys like the elements of `points`");
  std::vector<std::uint32_t> result;
  if constexpr (is_index_range_v<IndexRange>)
    for (const auto& i : indices) {
      if (i < 0 || static_cast<std::size_t>(i) >= n)
        throw Invalid_input(caller + ": index " + std::to_string(i) +
                            " is out of range; there are " + std::to_string(n) + " points");
      result.push_back(static_cast<std::uint32_t>(i));
    }
  return result;
}

/// Converts target positions to double precision.
template <class TargetRange>
std::vector<Eigen::Vector3d> read_targets(const TargetRange& targets)
{
  static_assert(is_point_range_v<TargetRange>,
                "pcs: targets must be a range of points with x(), y(), z(), like Kernel::Point_3, "
                "one for each point of the handle");
  std::vector<Eigen::Vector3d> result;
  if constexpr (is_point_range_v<TargetRange>)
    for (const auto& target : targets)
      result.push_back(pcs::internal::to_eigen(target));
  return result;
}

/// Returns `positions_of(region)` of the region of interest, if one is given.
template <class NamedParameters, class Positions_of>
std::optional<std::vector<std::uint32_t>>
read_region([[maybe_unused]] const NamedParameters& np,
            [[maybe_unused]] const Positions_of& positions_of)
{
  using Tag = pcs::internal_np::region_of_interest_t;
  if constexpr (pcs::internal::is_given_v<NamedParameters, Tag>)
    return positions_of(CGAL::parameters::get_parameter_reference(np, Tag()));
  else
    return std::nullopt;
}

/// Throws `Invalid_input` unless the softness is 0 or between 1e-9 and 1e9.
inline void check_softness(double softness, const std::string& caller)
{
  pcs::internal::check_value(caller,
                             "softness",
                             softness,
                             softness == 0 || (softness >= 1e-9 && softness <= 1e9),
                             "0, or between 1e-9 and 1e9");
}

/// Reads the sampling options. Throws `Invalid_input`, with a message that begins with `caller`, if
/// a parameter is out of range.
template <class NamedParameters>
Sampling_options read_sampling_options(const NamedParameters& np, const std::string& caller)
{
  namespace tags = internal::tags;
  pcs::internal::check_names<CGAL::internal_np::callback_t,
                             CGAL::internal_np::number_of_iterations_t,
                             tags::vector_map_t,
                             tags::tensor_map_t,
                             tags::gradient_map_t,
                             tags::number_of_samples_t,
                             tags::number_of_neighbors_t,
                             tags::number_of_sample_neighbors_t,
                             tags::sample_search_t,
                             tags::sample_weights_t,
                             tags::rotation_field_t,
                             tags::tolerance_t,
                             tags::stiffness_t,
                             tags::poisson_ratio_t,
                             tags::do_preserve_volume_t,
                             tags::region_of_interest_t>(np);
  static_assert(internal::is_parameter_v<Sample_search, NamedParameters, tags::sample_search_t>,
                "pcs: named parameter `sample_search` must be a pcs::Sample_search");
  static_assert(internal::is_parameter_v<Sample_weights, NamedParameters, tags::sample_weights_t>,
                "pcs: named parameter `sample_weights` must be a pcs::Sample_weights");
  static_assert(internal::is_parameter_v<bool, NamedParameters, tags::do_preserve_volume_t>,
                "pcs: named parameter `do_preserve_volume` must be a bool");
  Sampling_options options;
  internal::read_parameter(np, tags::sample_search, options.sample_search);
  internal::read_parameter(np, tags::sample_weights, options.sample_weights);
  internal::read_parameter(np, tags::do_preserve_volume, options.do_preserve_volume);
  const auto count =
      [&](auto tag, const char* name, std::size_t lowest, std::size_t highest, std::size_t& value) {
        internal::read_count(np, tag, caller, name, lowest, highest, value);
      };
  if constexpr (pcs::internal::is_given_v<NamedParameters, tags::number_of_samples_t>)
    count(tags::number_of_samples,
          "number_of_samples",
          1,
          std::numeric_limits<std::uint32_t>::max(),
          options.number_of_samples);
  count(tags::number_of_neighbors,
        "number_of_neighbors",
        2,
        neighborhood::maximal_number_of_neighbors,
        options.number_of_neighbors);
  count(tags::number_of_sample_neighbors,
        "number_of_sample_neighbors",
        1,
        internal::max_number_of_sample_neighbors,
        options.number_of_sample_neighbors);
  return options;
}

/// Reads the elastic options. Throws like `read_sampling_options()`.
template <class NamedParameters>
Elastic_options read_elastic_options(const NamedParameters& np, const std::string& caller)
{
  namespace tags = internal::tags;
  static_assert(internal::is_parameter_v<Rotation_field, NamedParameters, tags::rotation_field_t>,
                "pcs: named parameter `rotation_field` must be a pcs::Rotation_field");
  Elastic_options options;
  internal::read_parameter(np, tags::rotation_field, options.rotation_field);
  auto passes = static_cast<std::size_t>(options.maximal_number_of_passes);
  internal::read_count(np,
                       CGAL::internal_np::number_of_iterations,
                       caller,
                       "number_of_iterations",
                       0,
                       internal::max_number_of_iterations,
                       passes);
  options.maximal_number_of_passes = static_cast<int>(passes);
  internal::read_number(np, tags::tolerance, options.tolerance);
  internal::read_number(np, tags::stiffness, options.stiffness);
  internal::read_number(np, tags::poisson_ratio, options.poisson_ratio);
  pcs::internal::check_at_least(caller, "tolerance", options.tolerance, 0);
  pcs::internal::check_in_range(caller, "stiffness", options.stiffness, 1e-3, 1e3);
  pcs::internal::check_in_range(caller, "poisson_ratio", options.poisson_ratio, -1, 0.5);
  return options;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_READ_OPTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The named parameters of a deformation as options of its session.

#ifndef PCS_DEFORMATION_ACCESS_READ_OPTIONS_H
#define PCS_DEFORMATION_ACCESS_READ_OPTIONS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/errors.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/internal/text.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace pcs {

namespace deformation {
namespace internal {

template <class Value>
Value checked(const char* function, const char* name, Value value, bool is_valid, const char* rule)
{
  if (!is_valid) {
    std::string text;
    if constexpr (std::is_floating_point_v<Value>)
      text = pcs::internal::to_text(static_cast<double>(value));
    else
      text = std::to_string(value);
    throw Invalid_input(std::string(function) + ": " + name + " is " + text + "; it must be " +
                        rule);
  }
  return value;
}

/// Reads a count that may have been given as any integer type; negative ones must not wrap around.
template <class NamedParameters, class Tag>
std::size_t count_parameter(const char* function,
                            const char* name,
                            const NamedParameters& np,
                            Tag tag,
                            std::size_t fallback,
                            std::size_t lowest,
                            std::size_t highest)
{
  const auto value = pcs::internal::choose(np, tag, fallback);
  static_assert(std::is_integral_v<std::decay_t<decltype(value)>>,
                "pcs: number_of_samples, number_of_neighbors, number_of_sample_neighbors and "
                "number_of_iterations must be integers");
  const bool is_valid = !(value < 0) && static_cast<std::size_t>(value) >= lowest &&
                        static_cast<std::size_t>(value) <= highest;
  const std::string rule = "between " + std::to_string(lowest) + " and " + std::to_string(highest);
  return static_cast<std::size_t>(checked(function, name, value, is_valid, rule.c_str()));
}

/// Indices as 32 bit numbers, each checked against the number of points.
template <class IndexRange>
std::vector<std::uint32_t>
checked_indices(const char* function, const IndexRange& indices, std::size_t n)
{
  static_assert(is_index_range_v<IndexRange>,
                "pcs: a handle or a region of interest must be a range of integers, the numbers of "
                "its points");
  std::vector<std::uint32_t> result;
  if constexpr (is_index_range_v<IndexRange>)
    for (const auto& i : indices) {
      if (i < 0 || static_cast<std::size_t>(i) >= n)
        throw Invalid_input(std::string(function) + ": index " + std::to_string(i) +
                            " is out of range; there are " + std::to_string(n) + " points");
      result.push_back(static_cast<std::uint32_t>(i));
    }
  return result;
}

} // namespace internal

/// How a cloud is sampled. Throws `Invalid_input`, whose text begins with `function`, if a
/// parameter is out of range.
template <class NamedParameters>
Sampling_options read_sampling_options(const NamedParameters& np, const char* function)
{
  using pcs::internal::choose;
  const auto count =
      [&](const char* name, auto tag, std::size_t& value, std::size_t lowest, std::size_t highest) {
        value = internal::count_parameter(function, name, np, tag, value, lowest, highest);
      };
  namespace tags = pcs::internal_np;
  Sampling_options options;
  count("number_of_samples",
        tags::number_of_samples,
        options.number_of_samples,
        1,
        std::numeric_limits<std::uint32_t>::max());
  count("number_of_neighbors",
        tags::number_of_neighbors,
        options.number_of_neighbors,
        2,
        neighborhood::maximal_number_of_neighbors);
  count("number_of_sample_neighbors",
        tags::number_of_sample_neighbors,
        options.number_of_sample_neighbors,
        1,
        32);
  options.sample_search = choose(np, tags::sample_search, options.sample_search);
  options.sample_weights = choose(np, tags::sample_weights, options.sample_weights);
  options.do_preserve_volume = choose(np, tags::do_preserve_volume, options.do_preserve_volume);
  return options;
}

/// How its samples resist. Throws like `read_sampling_options()`.
template <class NamedParameters>
Elastic_options read_elastic_options(const NamedParameters& np, const char* function)
{
  using pcs::internal::choose;
  const auto real = [&](const char* name,
                        auto tag,
                        double& value,
                        double lowest,
                        double highest,
                        const char* rule) {
    value = choose(np, tag, value);
    internal::checked(function, name, value, value >= lowest && value <= highest, rule);
  };
  namespace tags = pcs::internal_np;
  constexpr double finite = std::numeric_limits<double>::max();
  Elastic_options options;
  options.rotation_field = choose(np, tags::rotation_field, options.rotation_field);
  options.maximal_number_of_passes = static_cast<int>(
      internal::count_parameter(function,
                                "number_of_iterations",
                                np,
                                CGAL::internal_np::number_of_iterations,
                                static_cast<std::size_t>(options.maximal_number_of_passes),
                                0,
                                1000000));
  real("tolerance", tags::tolerance, options.tolerance, 0, finite, "finite and not negative");
  real("stiffness", tags::stiffness, options.stiffness, 1e-3, 1e3, "between 0.001 and 1000");
  real("poisson_ratio", tags::poisson_ratio, options.poisson_ratio, -1, 0.5, "between -1 and 0.5");
  return options;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_READ_OPTIONS_H

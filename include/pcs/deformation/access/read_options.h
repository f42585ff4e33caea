// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Named parameters of a deformation as options of its session.

#ifndef PCS_DEFORMATION_ACCESS_READ_OPTIONS_H
#define PCS_DEFORMATION_ACCESS_READ_OPTIONS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Deformation_options.h>
#include <pcs/core/errors.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Sampling_options.h>
#include <pcs/internal/text.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
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

/// Whether `tag` is not in the chain, or was given a value that converts to `Option`.
template <class Option, class NamedParameters, class Tag>
constexpr bool is_option_v =
    std::is_convertible_v<decltype(pcs::internal::choose(std::declval<const NamedParameters&>(),
                                                         std::declval<Tag>(),
                                                         std::declval<const Option&>())),
                          Option>;

/// Replaces `value` by the value given for `tag`, if there is one. A value of a wrong type is
/// ignored: a sentence of the caller rejects it.
template <class Option, class NamedParameters, class Tag>
void read_option(const NamedParameters& np, Tag tag, Option& value)
{
  if constexpr (is_option_v<Option, NamedParameters, Tag>)
    value = pcs::internal::choose(np, tag, value);
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
  constexpr bool is_integer = std::is_integral_v<std::decay_t<decltype(value)>>;
  static_assert(is_integer,
                "pcs: number_of_samples, number_of_neighbors, number_of_sample_neighbors and "
                "number_of_iterations must be integers");
  if constexpr (is_integer) {
    const bool is_valid = !(value < 0) && static_cast<std::size_t>(value) >= lowest &&
                          static_cast<std::size_t>(value) <= highest;
    const std::string rule =
        "between " + std::to_string(lowest) + " and " + std::to_string(highest);
    return static_cast<std::size_t>(checked(function, name, value, is_valid, rule.c_str()));
  } else
    return fallback;
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
  static_assert(internal::is_option_v<Sample_search, NamedParameters, tags::sample_search_t>,
                "pcs: named parameter `sample_search` must be a pcs::Sample_search");
  static_assert(internal::is_option_v<Sample_weights, NamedParameters, tags::sample_weights_t>,
                "pcs: named parameter `sample_weights` must be a pcs::Sample_weights");
  static_assert(internal::is_option_v<bool, NamedParameters, tags::do_preserve_volume_t>,
                "pcs: named parameter `do_preserve_volume` must be a bool");
  internal::read_option(np, tags::sample_search, options.sample_search);
  internal::read_option(np, tags::sample_weights, options.sample_weights);
  internal::read_option(np, tags::do_preserve_volume, options.do_preserve_volume);
  return options;
}

/// Sets `callback` to the one given in `np`, if there is one.
template <class NamedParameters>
void read_callback([[maybe_unused]] const NamedParameters& np,
                   [[maybe_unused]] std::function<bool(double)>& callback)
{
  using Tag = CGAL::internal_np::callback_t;
  if constexpr (pcs::internal::is_given_v<NamedParameters, Tag>) {
    using Given = std::decay_t<decltype(CGAL::parameters::get_parameter(np, Tag()))>;
    constexpr bool is_callback = is_progress_callback_v<Given>;
    static_assert(is_callback,
                  "pcs: named parameter `callback` must take a double and return a bool");
    if constexpr (is_callback)
      callback = CGAL::parameters::get_parameter(np, Tag());
  }
}

/// How its samples resist. Throws like `read_sampling_options()`.
template <class NamedParameters>
Elastic_options read_elastic_options(const NamedParameters& np, const char* function)
{
  const auto real = [&](const char* name,
                        auto tag,
                        double& value,
                        double lowest,
                        double highest,
                        const char* rule) {
    static_assert(internal::is_option_v<double, NamedParameters, decltype(tag)>,
                  "pcs: tolerance, stiffness and poisson_ratio must be numbers");
    internal::read_option(np, tag, value);
    internal::checked(function, name, value, value >= lowest && value <= highest, rule);
  };
  namespace tags = pcs::internal_np;
  constexpr double finite = std::numeric_limits<double>::max();
  Elastic_options options;
  static_assert(internal::is_option_v<Rotation_field, NamedParameters, tags::rotation_field_t>,
                "pcs: named parameter `rotation_field` must be a pcs::Rotation_field");
  internal::read_option(np, tags::rotation_field, options.rotation_field);
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

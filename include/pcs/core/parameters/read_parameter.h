// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reading of named parameters into typed options.

#ifndef PCS_CORE_PARAMETERS_READ_PARAMETER_H
#define PCS_CORE_PARAMETERS_READ_PARAMETER_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/parameters/check_value.h>

#include <CGAL/number_utils.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>

namespace pcs {
namespace internal {

/// Does not compile if the function ignores the named parameter `Tag`. The error names the tag.
template <class Tag, bool is_read>
struct Parameter_is_read
{
  static constexpr bool value = is_read;
  static_assert(is_read,
                "pcs: the function would ignore the named parameter with this tag; its "
                "documentation lists the parameters that it reads");
};

/// Checks each tag of a chain. Parameters that describe the points may be passed to every function,
/// because `CGAL::Point_set_3::parameters()` has them.
template <class... Read>
struct Read_parameters
{
  static constexpr bool check(const void*) { return true; }
  template <class T, class Tag, class Base>
  static constexpr bool check(const CGAL::Named_function_parameters<T, Tag, Base>*)
  {
    namespace tags = CGAL::internal_np;
    constexpr bool is_about_points =
        std::is_same_v<Tag, tags::all_default_t> || std::is_same_v<Tag, tags::geom_traits_t> ||
        std::is_same_v<Tag, tags::point_t> || std::is_same_v<Tag, tags::normal_t>;
    constexpr bool is_read = is_about_points || (std::is_same_v<Tag, Read> || ...);
    return Parameter_is_read<Tag, is_read>::value && check(static_cast<const Base*>(nullptr));
  }
};

/// Does not compile if `np` has a parameter that is not in `Read` and would be ignored.
template <class... Read, class NamedParameters>
constexpr void check_names(const NamedParameters&)
{
  [[maybe_unused]] constexpr bool are_read =
      Read_parameters<Read...>::check(static_cast<const NamedParameters*>(nullptr));
}

/// Whether a `Given` is accepted as an `Option`. Pointers and floating-point numbers are not
/// accepted as `bool`.
template <class Given, class Option>
constexpr bool is_option_value_v = std::is_convertible_v<Given, Option> &&
                                   !(std::is_same_v<Option, bool> &&
                                     (std::is_pointer_v<Given> || std::is_floating_point_v<Given>));

/// Whether `tag` is not in the chain, or was given a value that converts to `Option`.
template <class Option, class NamedParameters, class Tag>
constexpr bool is_parameter_v =
    is_option_value_v<std::decay_t<decltype(choose(std::declval<const NamedParameters&>(),
                                                   std::declval<Tag>(),
                                                   std::declval<const Option&>()))>,
                      Option>;

/// Whether `tag` is not in the chain, or was given an integer.
template <class NamedParameters, class Tag>
constexpr bool is_integer_parameter_v = std::is_integral_v<
    std::decay_t<decltype(choose(std::declval<const NamedParameters&>(), std::declval<Tag>(), 0))>>;

/// Replaces `value` by the value given for `tag`, if there is one. Values of a wrong type are
/// ignored, because the caller rejects them with a `static_assert` that names the parameter.
template <class Option, class NamedParameters, class Tag>
void read_parameter(const NamedParameters& np, Tag tag, Option& value)
{
  if constexpr (is_parameter_v<Option, NamedParameters, Tag>)
    value = static_cast<Option>(choose(np, tag, value));
}

/// Returns the given `random_seed`, or 0 if there is none. It is also 0 if the seed is not an
/// integer, which the caller rejects with a `static_assert`.
template <class NamedParameters>
std::uint64_t read_random_seed([[maybe_unused]] const NamedParameters& np)
{
  if constexpr (is_integer_parameter_v<NamedParameters, CGAL::internal_np::random_seed_t>)
    return static_cast<std::uint64_t>(choose(np, CGAL::internal_np::random_seed, 0));
  else
    return 0;
}

/// Sets `callback` to the callback given in `np`, if there is one.
template <class NamedParameters>
void read_callback([[maybe_unused]] const NamedParameters& np,
                   [[maybe_unused]] std::function<bool(double)>& callback)
{
  using Tag = CGAL::internal_np::callback_t;
  if constexpr (is_given_v<NamedParameters, Tag>) {
    using Given = std::decay_t<decltype(CGAL::parameters::get_parameter(np, Tag()))>;
    constexpr bool is_callback = is_progress_callback_v<Given>;
    static_assert(is_callback,
                  "pcs: named parameter `callback` must take a double and return a bool");
    if constexpr (is_callback)
      callback = CGAL::parameters::get_parameter(np, Tag());
  }
}

/// Returns the vertical as a unit vector, `(0, 0, 1)` if none is given. Throws `Invalid_input` with
/// a message that begins with `caller` if the given vector is null or not finite.
template <class NamedParameters>
std::array<double, 3> read_up_direction([[maybe_unused]] const NamedParameters& np,
                                        [[maybe_unused]] const std::string& caller)
{
  std::array<double, 3> up = {0, 0, 1};
  using Tag = internal_np::up_direction_t;
  if constexpr (is_given_v<NamedParameters, Tag>) {
    const auto& given = CGAL::parameters::get_parameter_reference(np, Tag());
    constexpr bool is_vector = is_coordinate_triple_v<std::decay_t<decltype(given)>>;
    static_assert(is_vector,
                  "pcs: named parameter `up_direction` must be a vector with x(), y(), z()");
    if constexpr (is_vector) {
      up = {CGAL::to_double(given.x()), CGAL::to_double(given.y()), CGAL::to_double(given.z())};
      const double largest = std::max({std::abs(up[0]), std::abs(up[1]), std::abs(up[2])});
      check(largest > 0 && std::isfinite(largest) && !std::isnan(up[0] + up[1] + up[2]),
            caller,
            "`up_direction` must be finite and not the null vector");
      for (double& x : up)
        x /= largest; // otherwise squares may overflow
      const double length = std::sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
      for (double& x : up)
        x /= length;
    }
  }
  return up;
}

} // namespace internal
} // namespace pcs

#endif // PCS_CORE_PARAMETERS_READ_PARAMETER_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks of values of named parameters, with messages that name the function and the rule.

#ifndef PCS_CORE_PARAMETERS_CHECK_VALUE_H
#define PCS_CORE_PARAMETERS_CHECK_VALUE_H

#include <pcs/core/errors.h>
#include <pcs/internal/text.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>

namespace pcs {
namespace internal {

/// Throws `Invalid_input` with "<caller>: <rule>" unless `is_valid`.
inline void check(bool is_valid, const std::string& caller, const std::string& rule)
{
  if (!is_valid)
    throw Invalid_input(caller + ": " + rule);
}

/// The same check, which allocates no memory unless it throws.
inline void check(bool is_valid, const char* caller, const char* rule)
{
  if (!is_valid)
    throw Invalid_input(std::string(caller) + ": " + rule);
}

/// Returns `value`, or throws `Invalid_input` with "<caller>: <name> is <value>; it must be
/// <rule>".
template <class Value>
Value check_value(const std::string& caller,
                  const std::string& name,
                  Value value,
                  bool is_valid,
                  const std::string& rule)
{
  if (is_valid)
    return value;
  std::string text;
  if constexpr (std::is_floating_point_v<Value>)
    text = to_text(static_cast<double>(value));
  else
    text = std::to_string(value);
  throw Invalid_input(caller + ": " + name + " is " + text + "; it must be " + rule);
}

/// Returns `value`, or throws like `check_value()` unless it is finite and at least `lowest`.
inline double
check_at_least(const std::string& caller, const std::string& name, double value, double lowest)
{
  return check_value(caller,
                     name,
                     value,
                     std::isfinite(value) && value >= lowest,
                     lowest == 0 ? "finite and not negative"
                                 : "finite and at least " + to_text(lowest));
}

/// Returns `value`, or throws unless it is finite and greater than 0.
inline double check_positive(const std::string& caller, const std::string& name, double value)
{
  return check_value(caller, name, value, std::isfinite(value) && value > 0, "finite and positive");
}

/// Returns `value`, or throws unless it is in `[lowest, highest]`.
inline double check_in_range(const std::string& caller,
                             const std::string& name,
                             double value,
                             double lowest,
                             double highest)
{
  return check_value(caller,
                     name,
                     value,
                     value >= lowest && value <= highest,
                     "between " + to_text(lowest) + " and " + to_text(highest));
}

/// Returns an integer of any type, or throws unless it is in `[lowest, highest]`. Negative values
/// do not wrap around.
template <class Integer>
std::size_t check_count(const std::string& caller,
                        const std::string& name,
                        Integer value,
                        std::size_t lowest,
                        std::size_t highest)
{
  static_assert(std::is_integral_v<Integer>, "a count is an integer");
  const bool is_valid = !(value < 0) && static_cast<std::size_t>(value) >= lowest &&
                        static_cast<std::size_t>(value) <= highest;
  return static_cast<std::size_t>(
      check_value(caller,
                  name,
                  value,
                  is_valid,
                  "between " + std::to_string(lowest) + " and " + std::to_string(highest)));
}

} // namespace internal
} // namespace pcs

#endif // PCS_CORE_PARAMETERS_CHECK_VALUE_H

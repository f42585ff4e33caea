// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The continuous parameters of a habit as a list of numbers, and their valid ranges.

#ifndef PCS_GENERATORS_HABIT_HABIT_PARAMETERS_H
#define PCS_GENERATORS_HABIT_HABIT_PARAMETERS_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/internal/constants.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pcs {
namespace generators {
namespace habit {

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr double half_turn = pcs::internal::pi; ///< the largest angle between two directions [rad]
constexpr double largest_lean = 1, largest_bend = 0.5; ///< of habits [rad]

/// Values that scale with others are corrected and bounded in logarithms.
enum class Scale { logarithmic, linear };

struct Habit_parameter
{
  const char *name, *unit;
  Scale scale;
  double most; ///< no value is larger; only those that are linear and `unlimited` are negative
  double& (*of)(Tree_habit&);

  double read(const Tree_habit& habit) const
  {
    Tree_habit copy = habit;
    return of(copy);
  }
  double transformed(double value) const
  {
    return scale == Scale::linear ? value : std::log(std::max(value, 1e-12));
  }
  double restored(double t) const { return scale == Scale::linear ? t : std::exp(t); }

  /// Moves an end of an interval into the range of meaningful values.
  double bounded(double value) const
  {
    const bool is_signed = scale == Scale::linear && most == unlimited;
    return std::clamp(value, is_signed ? -unlimited : 0, most);
  }
};

constexpr std::size_t number_of_parameters = 41;

// A table: one line for each parameter, in the order of `Tree_habit`.
#define PCS_LOG(unit, name, most)                                                                  \
  {                                                                                                \
#name, unit, Scale::logarithmic, most, [](Tree_habit & h) -> double& { return h.name; }        \
  }
#define PCS_LIN(unit, name, most)                                                                  \
  {                                                                                                \
#name, unit, Scale::linear, most, [](Tree_habit & h) -> double& { return h.name; }             \
  }
inline const std::array<Habit_parameter, number_of_parameters>& habit_parameters()
{
  static const std::array<Habit_parameter, number_of_parameters> list = {{
      PCS_LOG("L", height, unlimited),
      PCS_LOG("L", trunk_radius, unlimited),
      PCS_LOG("-", flare, unlimited),
      PCS_LOG("L", flare_height, unlimited),
      PCS_LOG("rad", lean, half_turn / 2),
      PCS_LOG("rad", bend[0], half_turn),
      PCS_LOG("rad", bend[1], half_turn),
      PCS_LOG("rad", bend[2], half_turn),
      PCS_LOG("-", bend_renewal, 1),
      PCS_LIN("-", tropism[0], unlimited),
      PCS_LIN("-", tropism[1], unlimited),
      PCS_LIN("-", tropism[2], unlimited),
      PCS_LIN("-", sag, unlimited),
      PCS_LOG("-", taper[0], unlimited),
      PCS_LOG("-", taper[1], unlimited),
      PCS_LOG("-", tip_share[0], 1),
      PCS_LOG("-", tip_share[1], 1),
      PCS_LOG("L", tip_radius, unlimited),
      PCS_LOG("L", spacing[0], unlimited),
      PCS_LOG("L", spacing[1], unlimited),
      PCS_LOG("L", spacing[2], unlimited),
      PCS_LIN("-", bare[0], 1),
      PCS_LIN("-", bare[1], 1),
      PCS_LIN("-", bare[2], 1),
      PCS_LIN("rad", insertion[0].least, half_turn),
      PCS_LIN("rad", insertion[0].largest, half_turn),
      PCS_LIN("rad", insertion[1].least, half_turn),
      PCS_LIN("rad", insertion[1].largest, half_turn),
      PCS_LIN("-", child_radius[0].least, 1),
      PCS_LIN("-", child_radius[0].largest, 1),
      PCS_LIN("-", child_radius[1].least, 1),
      PCS_LIN("-", child_radius[1].largest, 1),
      PCS_LOG("L", largest_branch, unlimited),
      PCS_LOG("L", smallest_branch, unlimited),
      PCS_LOG("-", slenderness.least, unlimited),
      PCS_LOG("-", slenderness.largest, unlimited),
      PCS_LOG("L", crown_radius, unlimited),
      PCS_LIN("-", fork, 1),
      PCS_LIN("rad", fork_angle.least, half_turn),
      PCS_LIN("rad", fork_angle.largest, half_turn),
      PCS_LIN("-", flattest_section, 1),
  }};
  return list;
}
#undef PCS_LOG
#undef PCS_LIN

using Parameter_values = std::array<double, number_of_parameters>;

/// The parameters, transformed by their scales.
inline Parameter_values transformed(const Tree_habit& habit)
{
  Parameter_values result{};
  for (std::size_t i = 0; i < number_of_parameters; ++i) {
    const Habit_parameter& p = habit_parameters()[i];
    result[i] = p.transformed(p.read(habit));
  }
  return result;
}

inline void make_valid(Value_range& range, double least, double most)
{
  range.least = std::clamp(range.least, least, most);
  range.largest = std::clamp(range.largest, range.least, most);
}

/// Moves values into their valid ranges, and lengths above a fraction of the height, so that a tree
/// can be grown in any case.
inline void make_valid(Tree_habit& h)
{
  const double tiny = 1e-5 * h.height;
  for (double* length : {&h.trunk_radius,
                         &h.flare_height,
                         &h.tip_radius,
                         &h.largest_branch,
                         &h.smallest_branch,
                         &h.crown_radius})
    *length = std::max(*length, tiny);
  h.flare = std::clamp(h.flare, 0.0, 5.0);
  h.lean = std::clamp(h.lean, 0.0, largest_lean);
  h.bend_renewal = std::clamp(h.bend_renewal, 0.003, 0.4);
  h.sag = std::clamp(h.sag, -1.0, 1.0);
  for (std::size_t i = 0; i < 3; ++i) {
    h.bend[i] = std::clamp(h.bend[i], 0.0, largest_bend);
    h.tropism[i] = std::clamp(h.tropism[i], -0.5, 0.5);
    h.spacing[i] = std::max({h.spacing[i], h.smallest_step / 2, 0.002 * h.height});
    h.bare[i] = std::clamp(h.bare[i], 0.0, 0.95);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    h.taper[i] = std::clamp(h.taper[i], 0.05, 5.0);
    h.tip_share[i] = std::clamp(h.tip_share[i], 1e-4, 0.95);
    make_valid(h.insertion[i], 0.01, 3.1);
    make_valid(h.child_radius[i], 0.01, 1);
  }
  make_valid(h.slenderness, 1, 1e4);
  h.fork = std::clamp(h.fork, 0.0, 0.95);
  make_valid(h.fork_angle, 0.01, 3.1);
  h.flattest_section = std::clamp(h.flattest_section, 0.1, 1.0);
}

inline Tree_habit restored(const Parameter_values& values, const Tree_habit& others)
{
  Tree_habit habit = others;
  for (std::size_t i = 0; i < number_of_parameters; ++i) {
    const Habit_parameter& p = habit_parameters()[i];
    p.of(habit) = p.restored(values[i]);
  }
  make_valid(habit);
  habit.tropism[0] = std::max(habit.tropism[0], 0.0); // otherwise a trunk would fall
  return habit;
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_HABIT_PARAMETERS_H

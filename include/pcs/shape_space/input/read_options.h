// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Named parameters of a shape space as options of its stages.

#ifndef PCS_SHAPE_SPACE_INPUT_READ_OPTIONS_H
#define PCS_SHAPE_SPACE_INPUT_READ_OPTIONS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/errors.h>
#include <pcs/shape_space/input/check_options.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/model/Alignment_options.h>
#include <pcs/shape_space/model/Build_options.h>
#include <pcs/shape_space/pair/Embedded_pair.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>

namespace pcs {
namespace shape_space {

/// Throws `pcs::Invalid_input`, with a message that begins with `caller`, if they cannot be met.
template <class NamedParameters>
Build_options
read_options(const NamedParameters& np, std::size_t number_of_trees, const std::string& caller)
{
  using pcs::internal::choose;
  Build_options options;
  options.weights = choose(np, pcs::internal_np::matching_weights, options.weights);
  options.assignment = choose(np, pcs::internal_np::assignment_options, options.assignment);
  options.transport = choose(np, pcs::internal_np::transport_options, options.transport);
  check_options(options.weights, options.assignment, options.transport, caller);
  options.standing.alignment = choose(np, pcs::internal_np::alignment, options.standing.alignment);
  if constexpr (pcs::internal::is_given_v<NamedParameters, pcs::internal_np::up_direction_t>)
    options.standing.up =
        internal::to_vector(CGAL::parameters::get_parameter(np, pcs::internal_np::up_direction));
  const double length = options.standing.up.stableNorm();
  if (!(length > 0) || !std::isfinite(length))
    throw Invalid_input(caller + ": `up_direction` must be finite and not the null vector");
  options.standing.up /= length;
  if (options.standing.alignment != Orl_alignment::as_given && number_of_trees > 2)
    throw Invalid_input(caller + ": `alignment` is for two trees, " +
                        std::to_string(number_of_trees) + " were added");
  const auto rounds = choose(np, pcs::internal_np::number_of_rounds, 3);
  static_assert(std::is_integral_v<std::decay_t<decltype(rounds)>>,
                "pcs::Orl_shape_space::build(): `number_of_rounds` must be an integer");
  if (rounds < 1)
    throw Invalid_input(caller + ": `number_of_rounds` is " + std::to_string(rounds) +
                        ", expected at least 1");
  options.number_of_rounds = static_cast<std::size_t>(rounds);
  if (number_of_trees < 2)
    throw Invalid_input(caller + ": " + std::to_string(number_of_trees) +
                        " trees were added, expected 2 at least");
  options.points_of = choose(np, pcs::internal_np::points_of, options.points_of);
  if (options.points_of != none && options.points_of >= number_of_trees)
    throw Invalid_input(caller + ": `points_of` is " + std::to_string(options.points_of) +
                        ", but there is no such tree");
  return options;
}

/// How trees are represented.
template <class NamedParameters>
void read_form(const NamedParameters& np, Embedded_pair& pair)
{
  using pcs::internal::choose;
  pair.orientation = choose(np, pcs::internal_np::orientation, pair.orientation);
  pair.direction = choose(np, pcs::internal_np::virtual_direction, pair.direction);
  pair.has_unit_weights = choose(np, pcs::internal_np::do_use_unit_weights, pair.has_unit_weights);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_READ_OPTIONS_H

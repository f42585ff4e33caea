// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Named parameters of a skeletonization as hints of its session.

#ifndef PCS_SKELETON_INPUT_READ_OPTIONS_H
#define PCS_SKELETON_INPUT_READ_OPTIONS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Skeleton_options.h>
#include <pcs/core/errors.h>
#include <pcs/internal/text.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/input/caller_types.h>

#include <cmath>
#include <string>
#include <type_traits>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! height above the root at which foresters measure the diameter of a trunk [m]
constexpr double default_breast_height = 1.3;
//! \ingroup PkgPcsSkeletonRef
//! divergence of the beam of common terrestrial scanners [rad]
constexpr double default_beam_width = 0.0003;

namespace skeleton {
namespace internal {

template <class NamedParameters>
void read_scanners(const NamedParameters& np, const std::string& function, Session_hints& hints)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, pcs::internal_np::scanner_positions_t>) {
    const auto positions = CGAL::parameters::get_parameter(np, pcs::internal_np::scanner_positions);
    constexpr bool are_points_ok = internal::is_range_of_points_v<decltype(positions)>;
    static_assert(are_points_ok,
                  "pcs::extract_tree_skeleton(): named parameter `scanner_positions` must be a "
                  "range of points with x(), y(), z()");
    if constexpr (are_points_ok)
      for (const auto& p : positions) {
        hints.scanners.push_back(internal::to_vec3(p));
        if (!hints.scanners.back().allFinite())
          throw Invalid_input(function + ": a scanner position is not finite");
      }
    hints.beam_width = static_cast<double>(
        pcs::internal::choose(np, pcs::internal_np::beam_width, default_beam_width));
    if (!std::isfinite(hints.beam_width) || hints.beam_width < 0)
      throw Invalid_input(function + ": beam_width is " + pcs::internal::to_text(hints.beam_width) +
                          "; it must not be negative");
  }
}

template <class NamedParameters>
void read_given_skeleton(const NamedParameters& np, Session_hints& hints)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, pcs::internal_np::given_skeleton_t>) {
    // a copy, or a reference in its wrapper
    const auto held = CGAL::parameters::get_parameter(np, pcs::internal_np::given_skeleton);
    const auto& given = internal::unwrapped(held);
    using Given = std::decay_t<decltype(given)>;
    constexpr bool has_map =
        pcs::internal::is_given_v<NamedParameters, pcs::internal_np::given_point_map_t>;
    static_assert(has_map || pcs::internal::Is_tree_skeleton<Given>::value,
                  "pcs::extract_tree_skeleton(): a `given_skeleton` that is no "
                  "pcs::Tree_skeleton needs the named parameter `given_point_map`");
    if constexpr (has_map)
      hints.given = internal::read_given(
          given,
          CGAL::parameters::get_parameter(np, pcs::internal_np::given_point_map));
    else if constexpr (pcs::internal::Is_tree_skeleton<Given>::value)
      hints.given = internal::read_given(given, get(&Given::vertex_bundled::point, given));
  }
}

/// Of the method `sections`.
inline void check_slices(const Slice_options& rules, const std::string& function)
{
  const auto check = [&](bool is_right, const char* what) {
    if (!is_right)
      throw Invalid_input(function + ": slice_rules: " + what);
  };
  const auto is_positive = [](double x) { return x > 0 && std::isfinite(x); };
  check(is_positive(rules.height) && is_positive(rules.largest_radius),
        "`height` and `largest_radius` must be positive and finite");
  check(rules.lowest_count >= fewest_points_of_section &&
            (rules.highest_count == 0 || rules.highest_count >= fewest_points_of_section),
        "a section is fitted to 6 points at least: `lowest_count`, and `highest_count` if not 0");
  check(rules.upright >= 0 && rules.upright <= 1 && rules.tilts >= 0,
        "`upright` must be in [0, 1], `tilts` not negative");
  check(rules.support_radius >= 0 && rules.support_cosine >= 0 && rules.support_cosine <= 1,
        "`support_radius` must not be negative, `support_cosine` in [0, 1]");
}

/// By evidence, unless the caller says yes or no, or which points are wood.
template <class NamedParameters>
void read_leaf_removal(const NamedParameters& np, Session_hints& hints)
{
  using pcs::internal::choose;
  if constexpr (pcs::internal::is_given_v<NamedParameters, pcs::internal_np::wood_map_t>)
    hints.leaf_removal = Leaf_removal::never;
  const auto wish = choose(np, pcs::internal_np::do_remove_leaves, hints.leaf_removal);
  if constexpr (std::is_same_v<std::decay_t<decltype(wish)>, Leaf_removal>)
    hints.leaf_removal = wish;
  else
    hints.leaf_removal = wish ? Leaf_removal::always : Leaf_removal::never;
}

} // namespace internal

/// A unit vector. Throws `Invalid_input`, whose text begins with `function`, if there is none.
template <class NamedParameters>
Vec3 read_up_direction(const NamedParameters& np, const std::string& function)
{
  Vec3 up = Vec3::UnitZ();
  if constexpr (pcs::internal::is_given_v<NamedParameters, pcs::internal_np::up_direction_t>)
    up = internal::to_vec3(CGAL::parameters::get_parameter(np, pcs::internal_np::up_direction));
  const double largest = up.cwiseAbs().maxCoeff();
  if (!up.allFinite() || !(largest > 0))
    throw Invalid_input(function + ": up_direction must be finite and not the null vector");
  return (up / largest).normalized(); // squares may overflow
}

/// Throws `Invalid_input`, whose text begins with `function`, if it is not positive [L].
template <class NamedParameters>
double read_breast_height(const NamedParameters& np, const std::string& function)
{
  const auto height = static_cast<double>(
      pcs::internal::choose(np, pcs::internal_np::breast_height, default_breast_height));
  if (!std::isfinite(height) || !(height > 0))
    throw Invalid_input(function + ": breast_height is " + pcs::internal::to_text(height) +
                        "; it must be positive");
  return height;
}

/// Throws `Invalid_input`, whose text begins with `function`, if a hint is out of range.
template <class NamedParameters>
Session_hints read_options(const NamedParameters& np, const std::string& function)
{
  using pcs::internal::choose;
  Session_hints hints;
  hints.up = read_up_direction(np, function);
  if constexpr (pcs::internal::is_given_v<NamedParameters, pcs::internal_np::root_position_t>) {
    hints.root =
        internal::to_vec3(CGAL::parameters::get_parameter(np, pcs::internal_np::root_position));
    if (!hints.root->allFinite())
      throw Invalid_input(function + ": root_position must be finite");
  }
  internal::read_scanners(np, function, hints);
  internal::read_given_skeleton(np, hints);
  hints.method = choose(np, pcs::internal_np::skeleton_method, Skeleton_method::chains);
  hints.slices = choose(np, pcs::internal_np::slice_options, Slice_options());
  internal::check_slices(hints.slices, function);
  hints.do_register_stations = choose(np, pcs::internal_np::do_register_stations, true);
  hints.do_mark_ground = choose(np, pcs::internal_np::do_remove_ground, true);
  internal::read_leaf_removal(np, hints);
  hints.breast_height = read_breast_height(np, function);
  return hints;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_INPUT_READ_OPTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Named parameters of a skeletonization and of a segmentation as typed options.

#ifndef PCS_SKELETON_INPUT_READ_OPTIONS_H
#define PCS_SKELETON_INPUT_READ_OPTIONS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Skeleton_options.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/input/caller_types.h>

#include <boost/graph/graph_traits.hpp>

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>

namespace pcs {

namespace skeleton {

/// The named parameters of a skeletonization or a segmentation, except for maps of points.
struct Input_options
{
  Session_hints hints;
  std::function<bool(double)> callback;
  std::size_t number_of_resamples = 0; ///< copies of the scan to estimate the spread of the result
};

namespace internal {

using pcs::internal::is_given_v;
using pcs::internal::is_parameter_v;
using pcs::internal::read_parameter;
namespace tags = pcs::internal_np;

template <class NamedParameters>
void read_root(const NamedParameters& np, const std::string& caller, Session_hints& hints)
{
  if constexpr (is_given_v<NamedParameters, tags::root_position_t>) {
    const auto& root = CGAL::parameters::get_parameter_reference(np, tags::root_position);
    constexpr bool is_point = is_coordinate_triple_v<std::decay_t<decltype(root)>>;
    static_assert(is_point,
                  "pcs::extract_tree_skeleton(): named parameter `root_position` must be a point "
                  "with x(), y(), z()");
    if constexpr (is_point)
      hints.root = to_vec3(root);
    pcs::internal::check(!hints.root || hints.root->allFinite(),
                         caller,
                         "root_position must be finite");
  }
}

/// Reads the scanner positions and, if they are given, the beam width.
template <class NamedParameters>
void read_scanners(const NamedParameters& np, const std::string& caller, Session_hints& hints)
{
  static_assert(is_parameter_v<double, NamedParameters, tags::beam_width_t>,
                "pcs::extract_tree_skeleton(): named parameter `beam_width` must be a number");
  double beam_width = default_beam_width;
  read_parameter(np, tags::beam_width, beam_width);
  pcs::internal::check_at_least(caller, "beam_width", beam_width, 0);
  if constexpr (is_given_v<NamedParameters, tags::scanner_positions_t>) {
    const auto& positions = CGAL::parameters::get_parameter_reference(np, tags::scanner_positions);
    constexpr bool are_points = is_range_of_points_v<decltype(positions)>;
    static_assert(are_points,
                  "pcs::extract_tree_skeleton(): named parameter `scanner_positions` must be a "
                  "range of points with x(), y(), z()");
    if constexpr (are_points)
      for (const auto& p : positions) {
        hints.scanners.push_back(to_vec3(p));
        pcs::internal::check(hints.scanners.back().allFinite(),
                             caller,
                             "a scanner position is not finite");
      }
    hints.beam_width = beam_width;
  }
}

template <class NamedParameters>
void read_given_skeleton(const NamedParameters& np, const std::string& caller, Session_hints& hints)
{
  if constexpr (is_given_v<NamedParameters, tags::given_skeleton_t>) {
    const auto& given = CGAL::parameters::get_parameter_reference(np, tags::given_skeleton);
    using Given = std::decay_t<decltype(given)>;
    constexpr bool is_graph = is_tree_graph_v<Given>;
    static_assert(is_graph,
                  "pcs::extract_tree_skeleton(): named parameter `given_skeleton` must be a "
                  "directed graph of Boost.Graph, for example a pcs::Tree_skeleton");
    constexpr bool has_map = is_given_v<NamedParameters, tags::given_point_map_t>;
    constexpr bool is_ready_made = pcs::internal::Is_tree_skeleton<Given>::value;
    static_assert(!is_graph || has_map || is_ready_made,
                  "pcs::extract_tree_skeleton(): a `given_skeleton` that is no "
                  "pcs::Tree_skeleton needs the named parameter `given_point_map`");
    if constexpr (is_graph && has_map) {
      const auto map = CGAL::parameters::get_parameter(np, tags::given_point_map);
      using Map = std::decay_t<decltype(map)>;
      using Vertex = typename boost::graph_traits<Given>::vertex_descriptor;
      constexpr bool is_map_ok = is_coordinate_triple_v<pcs::Map_value<Map>> &&
                                 is_readable_map_v<Map, Vertex, pcs::Map_value<Map>>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `given_point_map` must be "
                    "readable, accept a vertex of `given_skeleton` as key, and store points with "
                    "x(), y(), z()");
      if constexpr (is_map_ok)
        hints.given = read_given(given, map, caller);
    } else if constexpr (is_graph && is_ready_made)
      hints.given = read_given(given, get(&Given::vertex_bundled::point, given), caller);
  }
}

/// Checks the options of the method `sections`.
inline void check_slices(const Slice_options& rules, const std::string& caller)
{
  const auto is_positive = [](double x) { return x > 0 && std::isfinite(x); };
  const auto is_valid = [](double x) { return x >= 0 && std::isfinite(x); };
  pcs::internal::check(is_positive(rules.height) && is_positive(rules.largest_radius),
                       caller,
                       "slice_options: `height` and `largest_radius` must be positive and finite");
  pcs::internal::check(is_positive(rules.radius) && is_valid(rules.radius_offset),
                       caller,
                       "slice_options: `radius` must be positive, `radius_offset` not negative, "
                       "both finite");
  pcs::internal::check(
      rules.lowest_count >= fewest_points_of_section &&
          (rules.highest_count == 0 || rules.highest_count >= fewest_points_of_section),
      caller,
      "slice_options: `lowest_count`, and `highest_count` if not 0, must be at least 6, because a "
      "section cannot be fitted to fewer points");
  pcs::internal::check(rules.upright >= 0 && rules.upright <= 1 && rules.tilts >= 0,
                       caller,
                       "slice_options: `upright` must be in [0, 1], `tilts` not negative");
  pcs::internal::check(
      rules.support_radius >= 0 && rules.support_cosine >= 0 && rules.support_cosine <= 1,
      caller,
      "slice_options: `support_radius` must not be negative, `support_cosine` in [0, 1]");
  pcs::internal::check(
      is_valid(rules.turn_cost) && is_valid(rules.dense_radius) && is_valid(rules.dense_offset),
      caller,
      "slice_options: `turn_cost`, `dense_radius` and `dense_offset` must be finite and not "
      "negative");
  pcs::internal::check(is_valid(rules.allometry),
                       caller,
                       "slice_options: `allometry` must be finite and not negative");
}

template <class NamedParameters>
void read_method(const NamedParameters& np, const std::string& caller, Session_hints& hints)
{
  static_assert(is_parameter_v<Skeleton_method, NamedParameters, tags::skeleton_method_t>,
                "pcs::extract_tree_skeleton(): named parameter `skeleton_method` must be a "
                "pcs::Skeleton_method");
  static_assert(is_parameter_v<Slice_options, NamedParameters, tags::slice_options_t>,
                "pcs::extract_tree_skeleton(): named parameter `slice_options` must be a "
                "pcs::Slice_options");
  hints.method = Skeleton_method::automatic;
  read_parameter(np, tags::skeleton_method, hints.method);
  read_parameter(np, tags::slice_options, hints.slices);
  check_slices(hints.slices, caller);
}

/// Reads whether to remove leaves. By default, leaves are removed where they are detected, but
/// never if the caller gives the points of wood.
template <class NamedParameters>
void read_leaf_removal(const NamedParameters& np, Session_hints& hints)
{
  using Tag = tags::do_remove_leaves_t;
  if constexpr (is_given_v<NamedParameters, tags::wood_map_t>)
    hints.leaf_removal = Leaf_removal::never;
  constexpr bool is_kind = is_parameter_v<Leaf_removal, NamedParameters, Tag>;
  constexpr bool is_bool = is_parameter_v<bool, NamedParameters, Tag>;
  static_assert(is_kind || is_bool,
                "pcs::extract_tree_skeleton(): named parameter `do_remove_leaves` must be a bool "
                "or a pcs::Leaf_removal");
  if constexpr (is_kind)
    read_parameter(np, Tag(), hints.leaf_removal);
  else if constexpr (is_bool)
    hints.leaf_removal =
        pcs::internal::choose(np, Tag(), false) ? Leaf_removal::always : Leaf_removal::never;
}

/// Reads the options common to skeletonization and segmentation.
template <class NamedParameters>
Input_options read_common_options(const NamedParameters& np, const std::string& caller)
{
  static_assert(is_parameter_v<double, NamedParameters, tags::breast_height_t>,
                "pcs::extract_tree_skeleton() and pcs::segment_trees(): named parameter "
                "`breast_height` must be a number");
  static_assert(is_parameter_v<bool, NamedParameters, tags::do_remove_ground_t>,
                "pcs::extract_tree_skeleton() and pcs::segment_trees(): named parameter "
                "`do_remove_ground` must be a bool");
  Input_options options;
  Session_hints& hints = options.hints;
  const auto up = pcs::internal::read_up_direction(np, caller);
  hints.up = {up[0], up[1], up[2]};
  hints.breast_height = default_breast_height;
  read_parameter(np, tags::breast_height, hints.breast_height);
  pcs::internal::check_positive(caller, "breast_height", hints.breast_height);
  read_parameter(np, tags::do_remove_ground, hints.do_mark_ground);
  pcs::internal::read_callback(np, options.callback);
  return options;
}

} // namespace internal

/// Reads all options of a skeletonization. Throws `Invalid_input` with a message that begins with
/// `caller` if a value is out of range.
template <class NamedParameters>
Input_options read_skeleton_options(const NamedParameters& np, const std::string& caller)
{
  namespace tags = internal::tags;
  pcs::internal::check_names<CGAL::internal_np::callback_t,
                             tags::up_direction_t,
                             tags::root_position_t,
                             tags::breast_height_t,
                             tags::number_of_resamples_t,
                             tags::do_register_stations_t,
                             tags::station_map_t,
                             tags::do_remove_ground_t,
                             tags::wood_map_t,
                             tags::do_remove_leaves_t,
                             tags::do_continue_trunk_t,
                             tags::point_is_leaf_map_t,
                             tags::point_branch_map_t,
                             tags::point_residual_map_t,
                             tags::point_is_dense_map_t,
                             tags::node_point_map_t,
                             tags::node_radius_map_t,
                             tags::node_radius_error_map_t,
                             tags::node_branch_map_t,
                             tags::skeleton_method_t,
                             tags::slice_options_t,
                             tags::scanner_positions_t,
                             tags::beam_width_t,
                             tags::given_skeleton_t,
                             tags::given_point_map_t>(np);
  static_assert(
      internal::is_parameter_v<bool, NamedParameters, internal::tags::do_register_stations_t>,
      "pcs::extract_tree_skeleton(): named parameter `do_register_stations` must be a bool");
  static_assert(
      internal::is_parameter_v<bool, NamedParameters, internal::tags::do_continue_trunk_t>,
      "pcs::extract_tree_skeleton(): named parameter `do_continue_trunk` must be a bool");
  Input_options options = internal::read_common_options(np, caller);
  Session_hints& hints = options.hints;
  internal::read_root(np, caller, hints);
  internal::read_scanners(np, caller, hints);
  internal::read_given_skeleton(np, caller, hints);
  internal::read_method(np, caller, hints);
  pcs::internal::check(!hints.given || hints.method == Skeleton_method::chains ||
                           hints.method == Skeleton_method::automatic,
                       caller,
                       "`given_skeleton` can only be used with `skeleton_method(chains)`");
  hints.do_register_stations = true;
  internal::read_parameter(np, internal::tags::do_register_stations, hints.do_register_stations);
  internal::read_leaf_removal(np, hints);
  internal::read_parameter(np, internal::tags::do_continue_trunk, hints.do_continue_trunk);
  const auto resamples =
      pcs::internal::choose(np, internal::tags::number_of_resamples, options.number_of_resamples);
  constexpr bool is_integer = std::is_integral_v<std::decay_t<decltype(resamples)>>;
  static_assert(is_integer,
                "pcs::extract_tree_skeleton(): named parameter `number_of_resamples` must be an "
                "integer");
  if constexpr (is_integer)
    options.number_of_resamples =
        pcs::internal::check_count(caller, "number_of_resamples", resamples, 0, 100);
  return options;
}

/// Reads all options of a segmentation. Throws `Invalid_input` with a message that begins with
/// `caller` if a value is out of range.
template <class NamedParameters>
Input_options read_segmentation_options(const NamedParameters& np, const std::string& caller)
{
  namespace tags = internal::tags;
  pcs::internal::check_names<CGAL::internal_np::callback_t,
                             tags::up_direction_t,
                             tags::breast_height_t,
                             tags::do_remove_ground_t>(np);
  return internal::read_common_options(np, caller);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_INPUT_READ_OPTIONS_H

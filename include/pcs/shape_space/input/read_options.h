// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Named parameters of a shape space as options of its stages.

#ifndef PCS_SHAPE_SPACE_INPUT_READ_OPTIONS_H
#define PCS_SHAPE_SPACE_INPUT_READ_OPTIONS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/internal/constants.h>
#include <pcs/shape_space/input/check_options.h>
#include <pcs/shape_space/input/check_sampling.h>
#include <pcs/shape_space/model/Build_options.h>
#include <pcs/shape_space/model/Path_options.h>

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

// All of these throw `pcs::Invalid_input`, with a message that begins with `caller`, if a value is
// out of range.

namespace pcs {
namespace shape_space {

namespace internal {

/// Checks the names of parameters for a space and for what is computed from it. `orl_geodesic()`
/// passes all of them to each step.
template <class NamedParameters>
void check_space_names(const NamedParameters& np)
{
  namespace tags = pcs::internal_np;
  pcs::internal::check_names<tags::matching_weights_t,
                             tags::assignment_options_t,
                             tags::transport_options_t,
                             tags::alignment_t,
                             tags::up_direction_t,
                             tags::orientation_t,
                             tags::virtual_direction_t,
                             tags::do_use_unit_weights_t,
                             tags::number_of_rounds_t,
                             tags::points_of_t,
                             CGAL::internal_np::callback_t,
                             tags::max_extrapolation_angle_t,
                             tags::extrapolation_t,
                             tags::do_limit_radii_t,
                             tags::branch_emergence_t,
                             tags::point_path_t,
                             tags::point_normals_t,
                             tags::node_point_map_t,
                             tags::node_radius_map_t,
                             tags::node_branch_map_t>(np);
}

template <class NamedParameters>
void read_matching(const NamedParameters& np, Build_options& options)
{
  namespace tags = pcs::internal_np;
  using pcs::internal::is_parameter_v;
  using pcs::internal::read_parameter;
  static_assert(is_parameter_v<Matching_weights, NamedParameters, tags::matching_weights_t>,
                "pcs: named parameter `matching_weights` must be a pcs::Matching_weights");
  static_assert(
      is_parameter_v<Point_assignment_options, NamedParameters, tags::assignment_options_t>,
      "pcs: named parameter `assignment_options` must be a pcs::Point_assignment_options");
  static_assert(is_parameter_v<Transport_options, NamedParameters, tags::transport_options_t>,
                "pcs: named parameter `transport_options` must be a pcs::Transport_options");
  read_parameter(np, tags::matching_weights, options.weights);
  read_parameter(np, tags::assignment_options, options.assignment);
  read_parameter(np, tags::transport_options, options.transport);
}

template <class NamedParameters>
void read_representation(const NamedParameters& np, Representation_options& form)
{
  namespace tags = pcs::internal_np;
  using pcs::internal::is_parameter_v;
  using pcs::internal::read_parameter;
  static_assert(is_parameter_v<Orl_orientation, NamedParameters, tags::orientation_t>,
                "pcs: named parameter `orientation` must be a pcs::Orl_orientation");
  static_assert(is_parameter_v<Virtual_direction, NamedParameters, tags::virtual_direction_t>,
                "pcs: named parameter `virtual_direction` must be a pcs::Virtual_direction");
  static_assert(is_parameter_v<bool, NamedParameters, tags::do_use_unit_weights_t>,
                "pcs: named parameter `do_use_unit_weights` must be a bool");
  read_parameter(np, tags::orientation, form.orientation);
  read_parameter(np, tags::virtual_direction, form.direction);
  read_parameter(np, tags::do_use_unit_weights, form.has_unit_weights);
}

template <class NamedParameters>
void read_alignment(const NamedParameters& np,
                    std::size_t number_of_trees,
                    const std::string& caller,
                    Alignment_options& options)
{
  using Tag = pcs::internal_np::alignment_t;
  static_assert(pcs::internal::is_parameter_v<Orl_alignment, NamedParameters, Tag>,
                "pcs: named parameter `alignment` must be a pcs::Orl_alignment");
  pcs::internal::read_parameter(np, Tag(), options.alignment);
  pcs::internal::check(options.alignment == Orl_alignment::as_given || number_of_trees == 2,
                       caller,
                       "`alignment` is for two trees, " + std::to_string(number_of_trees) +
                           " were added");
  const std::array<double, 3> up = pcs::internal::read_up_direction(np, caller);
  options.up = Vec3(up[0], up[1], up[2]);
}

template <class NamedParameters>
void read_family_options(const NamedParameters& np,
                         std::size_t number_of_trees,
                         const std::string& caller,
                         Build_options& options)
{
  namespace tags = pcs::internal_np;
  const auto rounds = pcs::internal::choose(np, tags::number_of_rounds, options.number_of_rounds);
  constexpr bool is_integer = std::is_integral_v<std::decay_t<decltype(rounds)>>;
  static_assert(is_integer, "pcs: named parameter `number_of_rounds` must be an integer");
  if constexpr (is_integer)
    options.number_of_rounds = pcs::internal::check_count(caller,
                                                          "`number_of_rounds`",
                                                          rounds,
                                                          1,
                                                          std::numeric_limits<int>::max());
  static_assert(pcs::internal::is_parameter_v<std::size_t, NamedParameters, tags::points_of_t>,
                "pcs: named parameter `points_of` must be the handle of a tree");
  pcs::internal::read_parameter(np, tags::points_of, options.points_of);
  pcs::internal::check(options.points_of == none || options.points_of < number_of_trees,
                       caller,
                       "`points_of` is " + std::to_string(options.points_of) +
                           ", but there is no such tree");
}

} // namespace internal

template <class NamedParameters>
Build_options read_build_options(const NamedParameters& np,
                                 std::size_t number_of_trees,
                                 const std::string& caller)
{
  internal::check_space_names(np);
  pcs::internal::check(number_of_trees >= 2,
                       caller,
                       std::to_string(number_of_trees) + " trees were added, expected 2 at least");
  Build_options options;
  internal::read_matching(np, options);
  check_options(options.weights, options.assignment, options.transport, caller);
  internal::read_representation(np, options.form);
  internal::read_alignment(np, number_of_trees, caller, options.alignment);
  internal::read_family_options(np, number_of_trees, caller, options);
  return options;
}

/// Reads the options of a space with given correspondences.
template <class NamedParameters>
Build_options read_embedding_options(const NamedParameters& np, const std::string& caller)
{
  namespace tags = pcs::internal_np;
  pcs::internal::check_names<tags::matching_weights_t,
                             tags::up_direction_t,
                             tags::orientation_t,
                             tags::virtual_direction_t,
                             tags::do_use_unit_weights_t>(np);
  constexpr std::size_t number_of_trees = 2;
  return read_build_options(np, number_of_trees, caller);
}

template <class NamedParameters>
Path_options read_path_options(const NamedParameters& np, const char* caller)
{
  internal::check_space_names(np);
  namespace tags = pcs::internal_np;
  using pcs::internal::is_parameter_v;
  using pcs::internal::read_parameter;
  Path_options options;
  options.max_extrapolation_angle = pcs::internal::pi / 4;
  static_assert(is_parameter_v<double, NamedParameters, tags::max_extrapolation_angle_t>,
                "pcs: named parameter `max_extrapolation_angle` must be a number");
  static_assert(is_parameter_v<Orl_extrapolation, NamedParameters, tags::extrapolation_t>,
                "pcs: named parameter `extrapolation` must be a pcs::Orl_extrapolation");
  static_assert(is_parameter_v<bool, NamedParameters, tags::do_limit_radii_t>,
                "pcs: named parameter `do_limit_radii` must be a bool");
  static_assert(is_parameter_v<Branch_emergence, NamedParameters, tags::branch_emergence_t>,
                "pcs: named parameter `branch_emergence` must be a pcs::Branch_emergence");
  read_parameter(np, tags::max_extrapolation_angle, options.max_extrapolation_angle);
  read_parameter(np, tags::extrapolation, options.extrapolation);
  read_parameter(np, tags::do_limit_radii, options.do_limit_radii);
  read_parameter(np, tags::branch_emergence, options.emergence);
  if (!(options.max_extrapolation_angle >= 0)) // valid values must not allocate
    pcs::internal::check_value(caller,
                               "`max_extrapolation_angle`",
                               options.max_extrapolation_angle,
                               false,
                               "at least 0");
  return options;
}

/// Reads the kind of point paths. Spaces of more than two trees have no pairs of points, so their
/// points move in cylindrical coordinates.
template <class NamedParameters>
Point_path read_point_path(const NamedParameters& np, bool is_pair, const char* caller)
{
  using Tag = pcs::internal_np::point_path_t;
  internal::check_space_names(np);
  Point_path path = Point_path::cylindrical;
  static_assert(pcs::internal::is_parameter_v<Point_path, NamedParameters, Tag>,
                "pcs: named parameter `point_path` must be a pcs::Point_path");
  pcs::internal::read_parameter(np, Tag(), path);
  pcs::internal::check(is_pair || path == Point_path::cylindrical,
                       caller,
                       "`point_path` is for two trees; points of more trees move in cylindrical "
                       "coordinates");
  return path;
}

/// Reads the kind of normals: by default those of the scans, if all of them have normals.
template <class NamedParameters>
Point_normals
read_point_normals(const NamedParameters& np, bool have_scans_normals, const char* caller)
{
  using Tag = pcs::internal_np::point_normals_t;
  Point_normals normals =
      have_scans_normals ? Point_normals::of_scans : Point_normals::across_branches;
  static_assert(pcs::internal::is_parameter_v<Point_normals, NamedParameters, Tag>,
                "pcs: named parameter `point_normals` must be a pcs::Point_normals");
  constexpr bool has_map = pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>;
  static_assert(has_map || !pcs::internal::is_given_v<NamedParameters, Tag>,
                "pcs: named parameter `point_normals` needs a `normal_map`");
  pcs::internal::read_parameter(np, Tag(), normals);
  pcs::internal::check(have_scans_normals || normals != Point_normals::of_scans,
                       caller,
                       "`point_normals` are those of the scans, which needs trees that were added "
                       "with normals; use `across_branches`");
  return normals;
}

template <class NamedParameters>
Orl_metric read_metric(const NamedParameters& np)
{
  using Tag = pcs::internal_np::metric_t;
  pcs::internal::check_names<Tag>(np);
  Orl_metric metric = Orl_metric::sum;
  static_assert(pcs::internal::is_parameter_v<Orl_metric, NamedParameters, Tag>,
                "pcs: named parameter `metric` must be a pcs::Orl_metric");
  pcs::internal::read_parameter(np, Tag(), metric);
  return metric;
}

template <class NamedParameters>
Change_limits read_change_limits(const NamedParameters& np, const std::string& caller)
{
  using Tag = pcs::internal_np::change_limits_t;
  pcs::internal::check_names<Tag>(np);
  Change_limits limits;
  static_assert(pcs::internal::is_parameter_v<Change_limits, NamedParameters, Tag>,
                "pcs: named parameter `change_limits` must be a pcs::Change_limits");
  pcs::internal::read_parameter(np, Tag(), limits);
  for (const double x : {limits.length, limits.radius, limits.angle})
    pcs::internal::check_value(caller, "a limit", x, x >= 0, "at least 0");
  return limits;
}

template <class NamedParameters>
bool read_do_keep_absent_branches(const NamedParameters& np)
{
  namespace tags = pcs::internal_np;
  using Tag = tags::do_keep_absent_branches_t;
  pcs::internal::
      check_names<Tag, tags::node_point_map_t, tags::node_radius_map_t, tags::node_branch_map_t>(
          np);
  bool do_keep = false;
  static_assert(pcs::internal::is_parameter_v<bool, NamedParameters, Tag>,
                "pcs: named parameter `do_keep_absent_branches` must be a bool");
  pcs::internal::read_parameter(np, Tag(), do_keep);
  return do_keep;
}

struct Mean_options
{
  Tree_mean kind = Tree_mean::median;
  std::vector<double> weights; ///< one per tree
};

template <class NamedParameters>
Mean_options
read_mean_options(const NamedParameters& np, std::size_t number_of_trees, const std::string& caller)
{
  namespace tags = pcs::internal_np;
  pcs::internal::check_names<tags::tree_mean_t, tags::tree_weights_t>(np);
  Mean_options options;
  options.weights.assign(number_of_trees, 1);
  static_assert(pcs::internal::is_parameter_v<Tree_mean, NamedParameters, tags::tree_mean_t>,
                "pcs: named parameter `tree_mean` must be a pcs::Tree_mean");
  static_assert(
      pcs::internal::is_parameter_v<std::vector<double>, NamedParameters, tags::tree_weights_t>,
      "pcs: named parameter `tree_weights` must be a std::vector<double>");
  pcs::internal::read_parameter(np, tags::tree_mean, options.kind);
  pcs::internal::read_parameter(np, tags::tree_weights, options.weights);
  check_tree_weights(options.weights, number_of_trees, false, caller);
  return options;
}

template <class NamedParameters>
Mode_inner_product read_mode_inner_product(const NamedParameters& np)
{
  using Tag = pcs::internal_np::mode_inner_product_t;
  pcs::internal::check_names<Tag>(np);
  Mode_inner_product product = Mode_inner_product::branches;
  static_assert(pcs::internal::is_parameter_v<Mode_inner_product, NamedParameters, Tag>,
                "pcs: named parameter `mode_inner_product` must be a pcs::Mode_inner_product");
  pcs::internal::read_parameter(np, Tag(), product);
  return product;
}

template <class NamedParameters>
Tree_sampling_options read_sampling_options(const NamedParameters& np, const std::string& caller)
{
  using Tag = pcs::internal_np::sampling_options_t;
  pcs::internal::check_names<Tag>(np);
  Tree_sampling_options options;
  static_assert(pcs::internal::is_parameter_v<Tree_sampling_options, NamedParameters, Tag>,
                "pcs: named parameter `sampling_options` must be a pcs::Tree_sampling_options");
  pcs::internal::read_parameter(np, Tag(), options);
  check_sampling(options, caller);
  return options;
}

template <class NamedParameters>
bool read_is_monotone(const NamedParameters& np)
{
  using Tag = pcs::internal_np::is_monotone_t;
  pcs::internal::check_names<Tag>(np);
  bool is_monotone = false;
  static_assert(pcs::internal::is_parameter_v<bool, NamedParameters, Tag>,
                "pcs: named parameter `is_monotone` must be a bool");
  pcs::internal::read_parameter(np, Tag(), is_monotone);
  return is_monotone;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_READ_OPTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Named parameters of pcs, chained on those of CGAL so that both kinds may be passed.

#ifndef PCS_NAMED_FUNCTION_PARAMETERS_H
#define PCS_NAMED_FUNCTION_PARAMETERS_H

#include <CGAL/Named_function_parameters.h>

#include <functional>
#include <type_traits>

// All named parameters, grouped by algorithm: PCS_SHARED(tag of CGAL, name), PCS_OWN(name).
// The documentation of each function that reads a parameter gives its meaning, unit and default.
#define PCS_NAMED_PARAMETERS(PCS_SHARED, PCS_OWN)                                                  \
  /* Shared by all algorithms, with the tags of CGAL */                                            \
  PCS_SHARED(point_t, point_map)                                                                   \
  PCS_SHARED(normal_t, normal_map)                                                                 \
  PCS_SHARED(callback_t, callback)                                                                 \
  PCS_SHARED(number_of_iterations_t, number_of_iterations)                                         \
  PCS_SHARED(random_seed_t, random_seed)                                                           \
  /* deform_point_set(): sampling and neighbourhoods */                                            \
  PCS_OWN(number_of_samples)                                                                       \
  PCS_OWN(number_of_neighbors)                                                                     \
  PCS_OWN(number_of_sample_neighbors)                                                              \
  PCS_OWN(region_of_interest)                                                                      \
  PCS_OWN(sample_search)                                                                           \
  PCS_OWN(sample_weights)                                                                          \
  /* deform_point_set(): the elastic model and what is moved along */                              \
  PCS_OWN(rotation_field)                                                                          \
  PCS_OWN(tolerance)                                                                               \
  PCS_OWN(stiffness)                                                                               \
  PCS_OWN(poisson_ratio)                                                                           \
  PCS_OWN(do_preserve_volume)                                                                      \
  PCS_OWN(vector_map)                                                                              \
  PCS_OWN(tensor_map)                                                                              \
  PCS_OWN(gradient_map)                                                                            \
  /* fit_point_set(): matches of two clouds */                                                     \
  PCS_OWN(landmarks)                                                                               \
  PCS_OWN(fitting_length)                                                                          \
  PCS_OWN(outlier_share)                                                                           \
  PCS_OWN(do_align)                                                                                \
  PCS_OWN(point_is_matched_map)                                                                    \
  PCS_OWN(point_match_map)                                                                         \
  /* extract_tree_skeleton(): the scan, its ground and its leaves */                               \
  PCS_OWN(up_direction)                                                                            \
  PCS_OWN(root_position)                                                                           \
  PCS_OWN(breast_height)                                                                           \
  PCS_OWN(number_of_resamples)                                                                     \
  PCS_OWN(do_register_stations)                                                                    \
  PCS_OWN(station_map)                                                                             \
  PCS_OWN(do_remove_ground)                                                                        \
  PCS_OWN(wood_map)                                                                                \
  PCS_OWN(do_remove_leaves)                                                                        \
  PCS_OWN(do_continue_trunk)                                                                       \
  /* extract_tree_skeleton(): results at the points */                                             \
  PCS_OWN(point_is_leaf_map)                                                                       \
  PCS_OWN(point_branch_map)                                                                        \
  PCS_OWN(point_residual_map)                                                                      \
  PCS_OWN(point_is_dense_map)                                                                      \
  /* Tree graphs: positions and radii of nodes */                                                  \
  PCS_OWN(node_point_map)                                                                          \
  PCS_OWN(node_radius_map)                                                                         \
  PCS_OWN(node_radius_error_map)                                                                   \
  PCS_OWN(node_branch_map)                                                                         \
  /* extract_tree_skeleton(): method, radii, and a skeleton of the caller */                       \
  PCS_OWN(skeleton_method)                                                                         \
  PCS_OWN(slice_options)                                                                           \
  PCS_OWN(scanner_positions)                                                                       \
  PCS_OWN(beam_width)                                                                              \
  PCS_OWN(given_skeleton)                                                                          \
  PCS_OWN(given_point_map)                                                                         \
  /* make_leaf_surface() and make_branch_surface() */                                              \
  PCS_OWN(leaf_length)                                                                             \
  PCS_OWN(leaves_per_length)                                                                       \
  PCS_OWN(leaf_branch_radius)                                                                      \
  PCS_OWN(do_join)                                                                                 \
  /* orl_geodesic() and Orl_shape_space: trees and their correspondences */                        \
  PCS_OWN(node_index_map)                                                                          \
  PCS_OWN(matching_weights)                                                                        \
  PCS_OWN(assignment_options)                                                                      \
  PCS_OWN(transport_options)                                                                       \
  PCS_OWN(orientation)                                                                             \
  PCS_OWN(virtual_direction)                                                                       \
  PCS_OWN(alignment)                                                                               \
  PCS_OWN(do_use_unit_weights)                                                                     \
  /* Orl_shape_space: paths between trees */                                                       \
  PCS_OWN(max_extrapolation_angle)                                                                 \
  PCS_OWN(extrapolation)                                                                           \
  PCS_OWN(do_limit_radii)                                                                          \
  PCS_OWN(branch_emergence)                                                                        \
  PCS_OWN(point_path)                                                                              \
  PCS_OWN(point_normals)                                                                           \
  PCS_OWN(do_keep_absent_branches)                                                                 \
  /* Orl_shape_space: statistics of several trees */                                               \
  PCS_OWN(metric)                                                                                  \
  PCS_OWN(tree_mean)                                                                               \
  PCS_OWN(tree_weights)                                                                            \
  PCS_OWN(mode_inner_product)                                                                      \
  PCS_OWN(number_of_rounds)                                                                        \
  PCS_OWN(points_of)                                                                               \
  PCS_OWN(sampling_options)                                                                        \
  PCS_OWN(is_monotone)                                                                             \
  PCS_OWN(change_limits)                                                                           \
  /* fit_tree_habit() */                                                                           \
  PCS_OWN(smallest_radius)                                                                         \
  PCS_OWN(number_of_simulations)                                                                   \
  /* complete_hidden_wood() */                                                                     \
  PCS_OWN(angular_step)
namespace pcs {
namespace internal_np {

#define PCS_IGNORE(tag, name)
#define PCS_DECLARE_TAG(name) enum name##_t{name};
PCS_NAMED_PARAMETERS(PCS_IGNORE, PCS_DECLARE_TAG)
#undef PCS_DECLARE_TAG
#undef PCS_IGNORE

} // namespace internal_np

/// A chain of named parameters. It is a CGAL chain, so every function of CGAL accepts it too.
template <class T, class Tag, class Base = CGAL::internal_np::No_property>
struct Named_function_parameters : CGAL::Named_function_parameters<T, Tag, Base>
{
  using Cgal_chain = CGAL::Named_function_parameters<T, Tag, Base>;
  using Cgal_chain::Cgal_chain;

#define PCS_ADD_SHARED(tag, name)                                                                  \
  template <class K>                                                                               \
  auto name(const K& k) const                                                                      \
  {                                                                                                \
    return Named_function_parameters<K, CGAL::internal_np::tag, Cgal_chain>(k, *this);             \
  }
#define PCS_ADD_OWN(name)                                                                          \
  template <class K>                                                                               \
  auto name(const K& k) const                                                                      \
  {                                                                                                \
    return Named_function_parameters<K, internal_np::name##_t, Cgal_chain>(k, *this);              \
  }
  PCS_NAMED_PARAMETERS(PCS_ADD_SHARED, PCS_ADD_OWN)
#undef PCS_ADD_SHARED
#undef PCS_ADD_OWN
};

namespace parameters {

using Default_named_parameters = Named_function_parameters<bool, CGAL::internal_np::all_default_t>;

//! no parameter: every default applies
inline Default_named_parameters default_values()
{
  return Default_named_parameters(true);
}

#define PCS_ADD_SHARED(tag, name)                                                                  \
  template <class K>                                                                               \
  auto name(const K& k)                                                                            \
  {                                                                                                \
    return Named_function_parameters<K, CGAL::internal_np::tag>(k);                                \
  }
#define PCS_ADD_OWN(name)                                                                          \
  template <class K>                                                                               \
  auto name(const K& k)                                                                            \
  {                                                                                                \
    return Named_function_parameters<K, internal_np::name##_t>(k);                                 \
  }
PCS_NAMED_PARAMETERS(PCS_ADD_SHARED, PCS_ADD_OWN)
#undef PCS_ADD_SHARED
#undef PCS_ADD_OWN

} // namespace parameters

namespace internal {

/// The value given for `tag` in `np`, or `fallback`. A `std::reference_wrapper` is unwrapped.
template <class NamedParameters, class Tag, class Default>
auto choose(const NamedParameters& np, Tag tag, const Default& fallback)
{
  return CGAL::parameters::choose_parameter(CGAL::parameters::get_parameter(np, tag), fallback);
}

/// Whether `np` holds a value for the tag type.
template <class NamedParameters, class Tag>
constexpr bool is_given_v = !std::is_same_v<
    std::decay_t<decltype(CGAL::parameters::get_parameter(std::declval<const NamedParameters&>(),
                                                          std::declval<Tag>()))>,
    CGAL::internal_np::Param_not_found>;

} // namespace internal
} // namespace pcs

#undef PCS_NAMED_PARAMETERS

#endif // PCS_NAMED_FUNCTION_PARAMETERS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compiled part of the shape space: construction, geodesics, statistics and storage.

#ifndef PCS_SHAPE_SPACE_SPACE_ENGINE_H
#define PCS_SHAPE_SPACE_SPACE_ENGINE_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/family/Family_points.h>
#include <pcs/shape_space/family/Tree_family.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>
#include <pcs/shape_space/measures/change_table.h>
#include <pcs/shape_space/model/Build_options.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/pair/Embedded_pair.h>
#include <pcs/shape_space/path/Extrapolation_limits.h>
#include <pcs/shape_space/path/Sequential_births.h>
#include <pcs/shape_space/statistics/Modes_of_variation.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pcs {
namespace shape_space {

class Tree_distribution;

/// What a tree on a path is told.
struct Path_options
{
  double maximal_turn = 0; ///< beyond the ends [rad]
  bool do_limit_radii = false;
  Branch_emergence births = Branch_emergence::simultaneous;
};

/*!
  Each function is that of the same name, or the one named, in another header of this folder.
  `caller` begins the texts of errors.
*/
template <class ConcurrencyTag>
struct Space_engine
{
  using Inputs = std::array<const Tree_input*, 2>;

  // two trees
  /// See `find_correspondences()`.
  static bool find_correspondences(const Inputs& inputs,
                                   const Build_options& options,
                                   pcs::internal::Progress& progress,
                                   Embedded_pair& built,
                                   std::vector<Point_pair>& pairs,
                                   Orl_report& report);
  /// Topology and coordinates from correspondences that were stored; throws `Invalid_input` if they
  /// do not fit.
  static void embed_stored(const Orl_correspondences& stored,
                           const Inputs& inputs,
                           const std::string& caller,
                           Embedded_pair& built);
  /// The family of a pair, with its points.
  static Tree_family finish_pair(const Inputs& inputs,
                                 std::vector<Point_pair> pairs,
                                 const Matching_weights& weights,
                                 Embedded_pair& built,
                                 Orl_report& report);
  static Orl_correspondences store_topology(const Embedded_pair& built, const Inputs& inputs);

  // more trees
  static bool build_family(const std::vector<Tree_input>& inputs,
                           const Build_options& options,
                           Virtual_direction direction,
                           bool has_unit_weights,
                           pcs::internal::Progress& progress,
                           Built_family& built,
                           Orl_report& report);
  /// Points by edge, in the family's coordinates.
  static void set_points(const std::vector<Orl_space_data::Point>& points,
                         const std::vector<Orl_space_data::Partner>& partners,
                         bool has_normals,
                         Tree_family& family,
                         Family_points& result);
  static Orl_coordinates
  embed_tree(const Tree_family& family, const Rooted_tree& tree, double* share);

  // kept spaces
  static Orl_space_data store_family(const Tree_family& family);
  static void store_points(const Inputs& inputs, Orl_space_data& stored);
  static Tree_family restore_family(const Orl_space_data& stored, const std::string& caller);
  static std::vector<Tree_input> restore_pair(const Orl_space_data& stored,
                                              const std::string& caller,
                                              Tree_family& family,
                                              Embedded_pair& built);
  static void check_family_points(const Orl_space_data& stored,
                                  std::size_t number_of_edges,
                                  const std::string& caller);

  // trees of a space
  static void
  build_geometry(const Tree_family& family, const Orl_coordinates& x, Orl_geometry& result);
  /// The tree at `t` on the path from `a` to `b`; buffers are used again.
  static void tree_at(const Tree_family& family,
                      const Orl_coordinates& a,
                      const Orl_coordinates& b,
                      double t,
                      const Path_options& options,
                      Extrapolation_buffers& near_end,
                      Sequential_births_buffers& births,
                      Orl_coordinates& x,
                      Orl_geometry& geometry);
  static double distance(const Tree_family& family,
                         const Orl_coordinates& a,
                         const Orl_coordinates& b,
                         Orl_metric metric);
  static std::vector<Branch_change> find_changes(const Tree_family& family,
                                                 const Orl_coordinates& a,
                                                 const Orl_coordinates& b,
                                                 const Change_limits& limits);
  static Tree_descriptors
  measure(const Tree_family& family, const Orl_coordinates& x, const Orl_geometry& geometry);
  /// The place of the nearest tree on the geodesic of two trees, in [0, 1].
  static double share_of_second(const Tree_family& family, const Orl_coordinates& x);
  /// `t`, moved by `step` times what leads from `a` to `b`.
  static Orl_coordinates parallel_displacement(const Tree_family& family,
                                               const Orl_coordinates& t,
                                               const Orl_coordinates& a,
                                               const Orl_coordinates& b,
                                               double step);

  // statistics
  static Orl_coordinates
  mean_tree(const Tree_family& family, const std::vector<double>& weights, Tree_mean kind);
  static Modes_of_variation
  find_modes(const Tree_family& family, std::size_t most, Mode_inner_product measure);
  static Orl_coordinates tree_of_modes(const Tree_family& family,
                                       const Modes_of_variation& modes,
                                       const std::vector<double>& scores);
  static Mode_coordinates project_on_modes(const Tree_family& family,
                                           const Modes_of_variation& modes,
                                           const Orl_coordinates& x,
                                           std::size_t most);
  static double outlier_score(const Modes_of_variation& modes, const Mode_coordinates& at);
  static std::shared_ptr<const Tree_distribution> distribution(const Tree_family& family);
  /// A tree in the range of `figures`; `is_late`: lengths are limited, too.
  static Orl_coordinates draw(const Tree_family& family,
                              const Tree_distribution& distribution,
                              const std::vector<Tree_descriptors>& figures,
                              std::uint64_t seed,
                              std::uint64_t index,
                              const Tree_sampling_options& options,
                              bool is_late);
  static double range_violation(const Tree_descriptors& figures,
                                const std::vector<Tree_descriptors>& range,
                                bool is_of_all);
};

} // namespace shape_space
} // namespace pcs

#ifndef PCS_COMPILED_SHAPE_SPACE
#include <pcs/shape_space/Space_engine_impl.h>
#endif

#endif // PCS_SHAPE_SPACE_SPACE_ENGINE_H

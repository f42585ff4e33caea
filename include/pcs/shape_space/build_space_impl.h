// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of build_space.h.

#ifndef PCS_SHAPE_SPACE_BUILD_SPACE_IMPL_H
#define PCS_SHAPE_SPACE_BUILD_SPACE_IMPL_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/shape_space/build_space.h>
#include <pcs/shape_space/family/build_family.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/family/serialize_family.h>
#include <pcs/shape_space/model/Alignment_options.h>
#include <pcs/shape_space/model/Build_run.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/pair/build_pair.h>
#include <pcs/shape_space/pair/embed_pair.h>
#include <pcs/shape_space/pair/serialize_topology.h>
#include <pcs/shape_space/points/Point_instances_impl.h>

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Returns the inputs of a pair.
inline std::array<const Tree_input*, 2> first_two(const std::vector<Tree_input>& inputs)
{
  return {&inputs[0], &inputs[1]};
}

/// Returns a report with the sizes of the input.
inline Orl_report new_report(const std::vector<Tree_input>& inputs)
{
  Orl_report report;
  report.number_of_trees = inputs.size();
  for (std::size_t t = 0; t < 2; ++t) {
    report.number_of_nodes[t] = inputs[t].tree.node_of_source.size();
    report.number_of_points[t] = inputs[t].points.size();
  }
  return report;
}

/// Replaces the state by the built state, but keeps the inputs.
inline void replace(Space_state& state, Space_state&& built)
{
  built.inputs = std::move(state.inputs);
  built.is_built = true;
  state = std::move(built);
}

/// Brings the stored points of a family into the coordinates of its edges.
template <class ConcurrencyTag>
void set_family_points(bool has_normals, Space_state& state)
{
  Tree_family& family = state.family;
  std::vector<Orl_geometry> geometry(family.x.size());
  for (std::size_t t = 0; t < family.x.size(); ++t)
    build_geometry(family.layout, family.x[t], family.orientation, geometry[t]);
  state.family_points.set(family.layout,
                          geometry,
                          state.stored_points,
                          state.stored_partners,
                          has_normals,
                          ConcurrencyTag());
  family.first_point = state.family_points.first();
}

/// Brings the paired points of both scans into the coordinates of their edges.
template <class ConcurrencyTag>
void set_pair_points(const std::array<const Tree_input*, 2>& inputs,
                     std::vector<Point_pair> pairs,
                     Embedded_pair& pair)
{
  pair.instances.set(pair.layout,
                     pair.geometry,
                     {inputs[0]->points, points_of_second(inputs)},
                     {inputs[0]->normals, inputs[1]->normals},
                     pair.is_relative,
                     std::move(pairs),
                     ConcurrencyTag());
}

/// Makes the family of two trees from their correspondences.
template <class ConcurrencyTag>
void finish_two(const std::array<const Tree_input*, 2>& inputs,
                std::vector<Point_pair> pairs,
                const Matching_weights& weights,
                Space_state& built,
                Orl_report& report)
{
  const pcs::internal::Stage_timer timer(report.seconds.instances);
  set_pair_points<ConcurrencyTag>(inputs, std::move(pairs), built.pair);
  built.family = make_family(built.pair, inputs, weights);
  built.family.first_point =
      first_of_edges(built.pair.instances.pairs(), built.pair.layout.number_of_edges());
  describe(built.pair, report);
}

/// Makes the space of more than two trees from their family.
template <class ConcurrencyTag>
void finish_many(Built_family&& found, Space_state& built, Orl_report& report)
{
  const pcs::internal::Stage_timer timer(report.seconds.instances);
  built.family = std::move(found.family);
  built.stored_points = std::move(found.points);
  built.stored_partners = std::move(found.partners);
  set_family_points<ConcurrencyTag>(found.has_normals, built);
  report.distance =
      distance(built.family.x[0], built.family.x[1], built.family.weights, Orl_metric::sum);
  report.number_of_point_pairs = built.family_points.size();
}

/// Builds the space of two trees. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool build_two(const std::vector<Tree_input>& inputs, const Build_run& run, Space_state& built)
{
  const std::array<const Tree_input*, 2> both = first_two(inputs);
  built.pair.form = run.options.form;
  std::vector<Point_pair> pairs;
  if (!find_correspondences<ConcurrencyTag>(both, run, built.pair, pairs))
    return false;
  finish_two<ConcurrencyTag>(both, std::move(pairs), run.options.weights, built, run.report);
  return true;
}

/// Builds the space of more than two trees. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool build_many(const std::vector<Tree_input>& inputs, const Build_run& run, Space_state& built)
{
  Built_family found;
  if (!build_family<ConcurrencyTag>(inputs, run, found))
    return false;
  finish_many<ConcurrencyTag>(std::move(found), built, run.report);
  return true;
}

/// Computes topology and coordinates of both trees from stored correspondences.
inline void embed_two(const std::array<const Tree_input*, 2>& inputs,
                      const Orl_correspondences& stored,
                      const Build_options& options,
                      const std::string& caller,
                      Embedded_pair& built,
                      Orl_report& report)
{
  const pcs::internal::Stage_timer timer(report.seconds.topology);
  report.matching_energy = report.unexplained_fraction = std::numeric_limits<double>::quiet_NaN();
  built.form = options.form;
  embed_stored(stored, inputs, caller, built);
  report.yaw = angle_about(options.alignment.up, built.rotation);
}

/// Restores the points of more than two trees; throws like `restore_space()`.
template <class ConcurrencyTag>
void restore_family_points(const Orl_space_data& stored,
                           const std::string& caller,
                           Space_state& state)
{
  check_family_points(stored, state.family.layout.number_of_edges(), caller);
  state.stored_points = stored.points;
  state.stored_partners = stored.partners;
  set_family_points<ConcurrencyTag>(stored.has_normals, state);
}

/// Restores the trees and the points of two scans; throws like `restore_space()`.
template <class ConcurrencyTag>
void restore_two(const Orl_space_data& stored, const std::string& caller, Space_state& state)
{
  state.inputs = restore_pair<ConcurrencyTag>(stored, state.family, caller, state.pair);
  state.family.first_point =
      first_of_edges(state.pair.instances.pairs(), state.family.layout.number_of_edges());
}

} // namespace internal

template <class ConcurrencyTag>
Orl_report
build_space(const Build_options& options, pcs::internal::Progress& progress, Space_state& state)
{
  Orl_report report = internal::new_report(state.inputs);
  const Build_run run{options, progress, report};
  Space_state built;
  const bool is_done = state.inputs.size() == 2
                           ? internal::build_two<ConcurrencyTag>(state.inputs, run, built)
                           : internal::build_many<ConcurrencyTag>(state.inputs, run, built);
  report.status = Status::cancelled;
  if (is_done) {
    report.status =
        report.number_of_failed_windows == 0 ? Status::converged : Status::iteration_limit;
    internal::replace(state, std::move(built));
    progress.finish();
  }
  return report;
}

template <class ConcurrencyTag>
Orl_report build_space_from(const Orl_correspondences& stored,
                            const Build_options& options,
                            const std::string& caller,
                            Space_state& state)
{
  const std::array<const Tree_input*, 2> inputs = internal::first_two(state.inputs);
  const bool has_points = !inputs[0]->points.empty() || !inputs[1]->points.empty();
  Orl_report report = internal::new_report(state.inputs);
  Space_state built;
  internal::embed_two(inputs, stored, options, caller, built.pair, report);
  internal::finish_two<ConcurrencyTag>(inputs,
                                       has_points ? stored.pairs : std::vector<Point_pair>(),
                                       options.weights,
                                       built,
                                       report);
  internal::replace(state, std::move(built));
  report.status = Status::converged;
  return report;
}

template <class ConcurrencyTag>
Orl_correspondences store_correspondences(const Space_state& state)
{
  return store_topology(state.pair.topology,
                        state.pair.rotation,
                        internal::first_two(state.inputs),
                        state.pair.instances.pairs());
}

template <class ConcurrencyTag>
Orl_space_data store_space(const Space_state& state)
{
  Orl_space_data result = store_family(state.family);
  result.points = state.stored_points;
  result.partners = state.stored_partners;
  result.has_normals = state.has_normals();
  if (state.is_pair()) {
    result.pairs = state.pair.instances.pairs();
    store_points(internal::first_two(state.inputs), result);
  }
  return result;
}

template <class ConcurrencyTag>
Space_state restore_space(const Orl_space_data& stored, const std::string& caller)
{
  Space_state state;
  state.family = restore_family(stored, caller);
  if (state.is_pair())
    internal::restore_two<ConcurrencyTag>(stored, caller, state);
  else
    internal::restore_family_points<ConcurrencyTag>(stored, caller, state);
  state.is_built = state.is_restored = true;
  return state;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_BUILD_SPACE_IMPL_H

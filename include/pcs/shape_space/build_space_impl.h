// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of build_space.h.

#ifndef PCS_SHAPE_SPACE_BUILD_SPACE_IMPL_H
#define PCS_SHAPE_SPACE_BUILD_SPACE_IMPL_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/shape_space/build_space.h>
#include <pcs/shape_space/family/build_family.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/family/serialize_family.h>
#include <pcs/shape_space/model/Alignment_options.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/pair/build_pair.h>
#include <pcs/shape_space/pair/embed_pair.h>
#include <pcs/shape_space/pair/serialize_topology.h>
#include <pcs/shape_space/points/Point_instances_impl.h>

#include <array>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

inline std::array<const Tree_input*, 2> first_two(const std::vector<Tree_input>& inputs)
{
  return {&inputs[0], &inputs[1]};
}

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

/// What is built replaces the state as a whole.
inline void replace(Space_state& state, Space_state&& built)
{
  built.inputs = std::move(state.inputs);
  built.is_built = true;
  state = std::move(built);
}

/// Points of a family in the coordinates of its edges.
template <class ConcurrencyTag>
void set_family_points(std::vector<Orl_space_data::Point> points,
                       std::vector<Orl_space_data::Partner> partners,
                       bool has_normals,
                       Space_state& state)
{
  Tree_family& family = state.family;
  std::vector<Orl_geometry> geometry(family.x.size());
  for (std::size_t t = 0; t < family.x.size(); ++t)
    build_geometry(family.layout, family.x[t], family.orientation, geometry[t]);
  state.family_points.set(family.layout, geometry, points, partners, has_normals, ConcurrencyTag());
  family.first_point = state.family_points.first();
  state.stored_points = std::move(points);
  state.stored_partners = std::move(partners);
}

/// The family of two trees whose correspondences are known, with the instances of their points.
template <class ConcurrencyTag>
Tree_family finish_pair(const std::array<const Tree_input*, 2>& inputs,
                        std::vector<Point_pair> pairs,
                        const Matching_weights& weights,
                        Embedded_pair& built,
                        Orl_report& report)
{
  built.instances.set(built.layout,
                      built.geometry,
                      {inputs[0]->points, points_of_second(inputs)},
                      {inputs[0]->normals, inputs[1]->normals},
                      built.is_relative,
                      std::move(pairs),
                      ConcurrencyTag());
  Tree_family family = make_family(built, inputs, weights);
  family.first_point = first_of_edges(built.instances.pairs(), built.layout.number_of_edges());
  describe(built, report);
  return family;
}

template <class ConcurrencyTag>
bool build_two(const std::vector<Tree_input>& inputs,
               const Build_options& options,
               pcs::internal::Progress& progress,
               Space_state& built,
               Orl_report& report)
{
  built.pair.form = options.form;
  std::vector<Point_pair> pairs;
  if (!find_correspondences<ConcurrencyTag>(first_two(inputs),
                                            options,
                                            progress,
                                            built.pair,
                                            pairs,
                                            report))
    return false;
  const pcs::internal::Stage_timer timer(report.seconds.instances);
  built.family = finish_pair<ConcurrencyTag>(first_two(inputs),
                                             std::move(pairs),
                                             options.weights,
                                             built.pair,
                                             report);
  return true;
}

template <class ConcurrencyTag>
bool build_many(const std::vector<Tree_input>& inputs,
                const Build_options& options,
                pcs::internal::Progress& progress,
                Space_state& built,
                Orl_report& report)
{
  Built_family family;
  if (!build_family<ConcurrencyTag>(inputs, options, progress, family, report))
    return false;
  const pcs::internal::Stage_timer timer(report.seconds.instances);
  built.family = std::move(family.family);
  set_family_points<ConcurrencyTag>(std::move(family.points),
                                    std::move(family.partners),
                                    family.has_normals,
                                    built);
  report.distance =
      distance(built.family.x[0], built.family.x[1], built.family.weights, Orl_metric::sum);
  report.number_of_point_pairs = built.family_points.size();
  return true;
}

} // namespace internal

template <class ConcurrencyTag>
Orl_report
build_space(const Build_options& options, pcs::internal::Progress& progress, Space_state& state)
{
  Orl_report report = internal::new_report(state.inputs);
  Space_state built;
  const bool is_done =
      state.inputs.size() == 2
          ? internal::build_two<ConcurrencyTag>(state.inputs, options, progress, built, report)
          : internal::build_many<ConcurrencyTag>(state.inputs, options, progress, built, report);
  report.status = is_done ? Status::converged : Status::cancelled;
  if (is_done) {
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
  Orl_report report = internal::new_report(state.inputs);
  report.matching_energy = report.unexplained_fraction = std::numeric_limits<double>::quiet_NaN();
  pcs::internal::Stopwatch watch;
  Space_state built;
  built.pair.form = options.form;
  embed_stored(stored, inputs, caller, built.pair);
  report.yaw = angle_about(options.alignment.up, built.pair.rotation);
  report.seconds.topology = watch.lap();
  const bool has_points = !inputs[0]->points.empty() || !inputs[1]->points.empty();
  built.family =
      internal::finish_pair<ConcurrencyTag>(inputs,
                                            has_points ? stored.pairs : std::vector<Point_pair>(),
                                            options.weights,
                                            built.pair,
                                            report);
  internal::replace(state, std::move(built));
  report.status = Status::converged;
  report.seconds.instances = watch.lap();
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
  const std::size_t number_of_edges = state.family.layout.number_of_edges();
  if (state.is_pair()) {
    state.inputs = restore_pair<ConcurrencyTag>(stored, state.family, caller, state.pair);
    state.family.first_point = first_of_edges(state.pair.instances.pairs(), number_of_edges);
  } else {
    check_family_points(stored, number_of_edges, caller);
    internal::set_family_points<ConcurrencyTag>(stored.points,
                                                stored.partners,
                                                stored.has_normals,
                                                state);
  }
  state.is_built = state.is_restored = true;
  return state;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_BUILD_SPACE_IMPL_H

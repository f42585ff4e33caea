// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Steps of an editing session: construction, constraints, solving, and a new rest shape.

#ifndef PCS_DEFORMATION_SESSION_STEPS_H
#define PCS_DEFORMATION_SESSION_STEPS_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/core/Status.h>
#include <pcs/deformation/Session_state.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/handles/Target_field.h>
#include <pcs/deformation/handles/constrain_body.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/multigrid/Coarse_levels.h>
#include <pcs/deformation/solver/Elastic_solver.h>
#include <pcs/deformation/upsampling/Handle_fades.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/deformation/upsampling/find_target_corrections.h>
#include <pcs/deformation/upsampling/read_maps.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

// ---- construction

/// Fraction of the construction after which the body is complete.
constexpr double end_of_body = 0.9;

template <class Tag>
void describe_body(Session_state<Tag>& s)
{
  const Sampled_body<Tag>& body = s.body;
  s.report.number_of_points = body.number_of_points();
  s.report.number_of_duplicates = body.number_of_points() - body.number_of_sites();
  s.report.number_of_samples = body.number_of_samples();
  s.report.sample_choice = body.sample_choice;
  s.report.number_of_interior_links = body.network.links.neighbor.size() / 2;
  s.report.number_of_components = body.number_of_components();
  s.report.number_of_short_cuts = body.number_of_short_cuts;
}

/// Prepares the borders of handles and the upsampling.
template <class Tag>
void prepare_points(Session_state<Tag>& s)
{
  if (!s.body.is_sampled)
    return;
  const pcs::internal::Stage_timer timer(s.report.seconds.sampling);
  const auto row = [&](std::size_t place) { return s.body.site_of_place[place]; };
  s.border_finder = Border_finder(s.body.site_graph);
  s.upsampling = Upsampling::build<Tag>(s.body.number_of_points(), row, s.body.links_of_site);
  s.body.links_of_site = Sample_links();
}

template <class Tag>
void prepare_samples(Session_state<Tag>& s, const pcs::internal::Go_on& go_on)
{
  start_maps(s);
  s.next_maps = s.maps;
  s.coarse = Coarse_levels<Tag>(s.body.network,
                                s.body.component_of_sample(),
                                s.body.options.do_preserve_volume,
                                go_on);
}

// ---- constraints

/// Returns the network of the constraints. Without sampling, changes that of the body.
template <class Tag>
const Elastic_network& take_network(Session_state<Tag>& s, Body_constraints& found)
{
  if (s.body.is_sampled) {
    s.network = std::move(found.network);
    return s.network;
  }
  if (straighten_borders(s.body.network, found.of_nodes, s.cut))
    for (std::uint32_t& source : s.body.network.source)
      source = s.body.site_of_sample[source];
  return s.body.network;
}

/// Factorises the network of the finest level and, meanwhile, finds the points near handles.
/// Returns `false` if a matrix is singular, or if `go_on` does.
template <class Tag>
bool constrain_finest(Session_state<Tag>& s,
                      Body_constraints found,
                      const pcs::internal::Go_on& go_on)
{
  const Elastic_network& network = take_network(s, found);
  bool is_regular = false;
  const auto factorize = [&] {
    is_regular = s.solver.constrain(network, std::move(found.of_nodes), s.stiffness, go_on);
  };
  const auto find_fades = [&] {
    if (s.body.is_sampled)
      s.fades.find(s.body, found.border, exact_handles(s.handles));
  };
  if (network.size() < least_watched_rows)
    pcs::internal::invoke_both<Tag>(factorize, find_fades);
  else // the calling thread factorises, and thus calls the callback
    pcs::internal::invoke_both<Tag>(factorize, find_fades, [&] { go_on(1); });
  return is_regular;
}

// ---- targets of handles

/// Finds the offsets of the targets of all handles from their motions, and sets those of the nodes
/// of all networks.
template <class Tag>
void set_node_targets(Session_state<Tag>& s)
{
  s.next_targets.find(s.body, s.handles.points(), s.handles.targets(), s.next_transforms);
  Node_targets& nodes = s.solver.targets();
  nodes.clear();
  if (!s.next_targets.empty()) {
    const std::vector<Similarity>& t = s.next_transforms;
    const std::size_t number_of_samples = s.body.number_of_samples();
    nodes.assign(number_of_samples);
    s.next_targets.set_samples(s.body, s.of_samples, s.handles, t, nodes);
    s.coarse.set_targets(s.of_samples, nodes);
    const Elastic_network& network = s.solver.network();
    nodes.resize(network.size());
    const Node_constraints& constraints = s.solver.constraints();
    s.next_targets.set_border(s.body, network, constraints, t, number_of_samples, nodes);
  } else
    s.coarse.set_targets(s.of_samples, nodes);
}

/// Finds the corrections of the current shape.
template <class Tag>
void find_corrections(Session_state<Tag>& s, const Target_field& field)
{
  find_target_corrections(s.body,
                          s.handles,
                          s.shape_targets,
                          s.local_transforms,
                          field,
                          s.sites,
                          s.fades.of_sites(),
                          exact_handles(s.handles),
                          s.corrections);
}

// ---- solving

/// Starts the report of a solve. The first report keeps the seconds of the construction.
template <class Tag>
void start_report(Session_state<Tag>& s)
{
  if (s.was_reported)
    s.report.seconds = Deformation_report::Seconds();
  s.was_reported = true;
  s.report.number_of_iterations = 0;
  s.report.initial_energy = s.report.energy = 0;
}

/// Without handles, sets the shape to the rest shape.
template <class Tag>
Status solve_nothing(Session_state<Tag>& s)
{
  put_samples_at_rest(s);
  s.local_transforms.clear();
  return Status::nothing_to_do;
}

/// Solves on all levels, the coarsest first.
template <class Tag>
Elastic_result solve_levels(Session_state<Tag>& s,
                            const Elastic_options& options,
                            pcs::internal::Progress& progress)
{
  Deviation_guess* guess = nullptr;
  {
    const pcs::internal::Stage_timer timer(s.report.seconds.coarse_levels);
    guess = &s.coarse.solve(s.next_transforms, options, progress);
  }
  const Elastic_result result = s.solver.solve(s.next_transforms, options, progress, guess);
  s.coarse.forget_large_guess();
  return result;
}

/// Solves from the last solution if `start` is warm and this solution is near, otherwise from the
/// rest shape.
template <class Tag>
Elastic_result solve_samples(Session_state<Tag>& s,
                             const Elastic_options& options,
                             Solver_start start,
                             pcs::internal::Progress& progress)
{
  s.handles.local_transforms(s.body.frame, s.next_transforms);
  set_node_targets(s);
  Elastic_result result;
  const bool is_warm =
      start == Solver_start::warm && s.has_solution && !s.coarse.has_link_offsets();
  const double highest_energy = largest_warm_growth * s.last_energy;
  if (!is_warm ||
      !s.solver.solve_further(s.next_transforms, options, progress, highest_energy, result))
    result = solve_levels(s, options, progress);
  if (!progress(1)) // the last call: afterwards, points are written
    result.status = Status::cancelled;
  s.has_solution = result.status != Status::cancelled;
  s.last_energy = result.energy;
  return result;
}

template <class Tag>
void describe_result(Session_state<Tag>& s, const Elastic_result& result)
{
  const double unit = s.body.frame.unit;
  s.report.number_of_iterations = static_cast<std::size_t>(result.number_of_passes);
  s.report.initial_energy = result.initial_energy * unit * unit;
  s.report.energy = result.energy * unit * unit;
}

/// Makes the solution the current shape. Returns `false`, and changes nothing, if the solution is
/// not finite.
template <class Tag>
bool take_shape(Session_state<Tag>& s)
{
  if (!read_maps<Tag>(s.solver.state(),
                      s.next_transforms,
                      std::as_const(s.solver).targets(),
                      s.body.network.rest,
                      s.body.number_of_samples(),
                      s.maps,
                      s.next_maps,
                      s.are_finite))
    return false;
  s.local_transforms.swap(s.next_transforms);
  s.shape_transforms = s.handles.transforms();
  s.shape_targets = s.handles.targets();
  find_corrections(s, s.next_targets);
  s.next_targets.clear(); // its memory is large
  s.setting_of_shape = s.setting;
  s.is_at_rest = false;
  return true;
}

// ---- a stopped factorisation

/// Unless it is kept, brings back the classes of the sites for which the current shape was
/// computed. The matrices remain without factors.
template <class Tag>
class Sites_guard
{
public:
  explicit Sites_guard(Session_state<Tag>& s)
    : m_state(s), m_sites(s.sites), m_fades(s.fades), m_setting(s.setting_of_sites)
  {
  }
  ~Sites_guard()
  {
    if (m_is_kept)
      return;
    m_state.sites = std::move(m_sites);
    m_state.fades = std::move(m_fades);
    m_state.setting_of_sites = m_setting;
  }
  void keep() { m_is_kept = true; }

  Sites_guard(const Sites_guard&) = delete;
  Sites_guard& operator=(const Sites_guard&) = delete;

private:
  Session_state<Tag>& m_state;
  Site_constraints m_sites;
  Handle_fades m_fades;
  std::uint64_t m_setting;
  bool m_is_kept = false;
};

// ---- a new rest shape

/// Sets the rest positions of points and samples. `position(input index)` is in the caller's
/// coordinates.
template <class Tag>
void move_rest(Session_state<Tag>& s, const std::function<Vec3(std::size_t)>& position)
{
  Sampled_body<Tag>& body = s.body;
  const auto local = [&](std::size_t place) {
    return body.frame.to_local(position(body.input_of_place[place]));
  };
  const auto is_apart = [&](std::size_t place) {
    return local(place) != local(body.first_place(body.site_of_place[place]));
  };
  bool has_positions = body.is_sampled;
  for (std::size_t place = 0; !has_positions && place < body.number_of_points(); ++place)
    has_positions = is_apart(place);
  if (has_positions)
    body.rest_points.set_positions(local);
  else
    body.rest_points.forget_positions();
  for (std::size_t sample = 0; sample < body.number_of_samples(); ++sample)
    body.network.rest[sample] = local(body.first_place(body.site_of_sample[sample]));
  std::vector<Vec3> points(body.number_of_points());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = position(i);
  s.rest_positions.keep(body.frame, std::move(points));
  s.coarse.accept(body.network);
  s.carrier.reset();
}

} // namespace internal

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SESSION_STEPS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Handles, constraints, solving and writing of an editing session: definitions of Session.h.

#ifndef PCS_DEFORMATION_SESSION_IMPL_H
#define PCS_DEFORMATION_SESSION_IMPL_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/deformation/Session.h>
#include <pcs/deformation/Session_points.h>
#include <pcs/deformation/Session_state.h>
#include <pcs/deformation/Session_steps.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/body/Sampled_body_impl.h>
#include <pcs/deformation/handles/constrain_body.h>
#include <pcs/deformation/handles/set_targets.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/solver/Elastic_solver.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

template <class ConcurrencyTag>
Session<ConcurrencyTag>::Session(std::vector<Vec3> points,
                                 const Sampling_options& options,
                                 const std::vector<std::uint32_t>* region,
                                 pcs::internal::Progress& progress)
  : m_state(std::make_unique<Session_state<ConcurrencyTag>>())
{
  Session_state<ConcurrencyTag>& s = *m_state;
  std::vector<Vec3> rest = points;
  s.report.status = Status::cancelled;
  {
    const pcs::internal::Progress_stage stage(progress, 0, internal::end_of_body);
    if (!s.body.build(std::move(points), options, s.report.seconds, progress))
      return;
  }
  s.rest_positions.keep(s.body.frame, std::move(rest));
  internal::describe_body(s);
  internal::prepare_points(s);
  const pcs::internal::Go_on go_on = [&](double f) { return progress(f); };
  internal::prepare_samples(s, pcs::internal::part_of(go_on, internal::end_of_body, 1));
  if (!progress(1))
    return;
  s.is_ready = true;
  s.report.status = Status::nothing_to_do;
  s.handles.start(s.body, region);
  internal::begin_rest_shape(s);
}

template <class ConcurrencyTag>
Session<ConcurrencyTag>::~Session() = default;

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_ready() const
{
  return m_state->is_ready;
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::number_of_points() const
{
  return m_state->body.number_of_points();
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::number_of_samples() const
{
  return m_state->is_ready ? m_state->body.number_of_samples() : 0;
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::add_handle(const std::vector<std::uint32_t>& indices,
                                                double weight,
                                                const char* function)
{
  const std::size_t handle = m_state->handles.add(m_state->body, indices, weight, function);
  internal::begin_setting(*m_state);
  return handle;
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::remove_handle(std::size_t handle)
{
  m_state->handles.remove(handle);
  internal::begin_setting(*m_state);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_handle(std::size_t handle) const
{
  return m_state->handles.contains(handle);
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::number_of_handles() const
{
  return m_state->handles.size();
}

template <class ConcurrencyTag>
const Similarity& Session<ConcurrencyTag>::transform(std::size_t handle) const
{
  return m_state->handles.transforms()[handle];
}

template <class ConcurrencyTag>
const Vec3& Session<ConcurrencyTag>::centroid(std::size_t handle) const
{
  return m_state->handles.centroid(handle);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::set_transform(std::size_t handle, const Similarity& transform)
{
  m_state->handles.set_transform(m_state->body.frame, handle, transform);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::set_targets(std::size_t handle,
                                          const std::vector<Vec3>& targets,
                                          const char* function)
{
  deformation::set_targets(m_state->body, handle, targets, function, m_state->handles);
}

template <class ConcurrencyTag>
Status Session<ConcurrencyTag>::constrain(double stiffness, pcs::internal::Progress& progress)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  if (internal::is_factorized(s, stiffness))
    return Status::converged;
  s.report.seconds.factorization = 0;
  const pcs::internal::Stage_timer timer(s.report.seconds.factorization);
  s.has_solution = s.is_constrained = false;
  internal::Sites_guard<ConcurrencyTag> guard(s);
  s.stiffness = stiffness;
  s.setting_of_sites = s.setting;
  restore_borders(s.body.network, s.cut);
  Body_constraints found = constrain_body(s.body, s.border_finder, s.handles, s.sites, s.report);
  pcs::internal::Shared_progress shared(progress);
  const pcs::internal::Go_on go_on = [&shared](double f) { return shared(f); };
  const pcs::internal::Go_on coarse = pcs::internal::part_of(go_on, 0, 0.5);
  bool is_regular = s.coarse.constrain(s.body.network, found.of_samples, stiffness, coarse);
  s.of_samples = std::move(found.of_samples);
  if (!progress.is_cancelled()) {
    const pcs::internal::Go_on finest = pcs::internal::part_of(go_on, 0.5, 1);
    is_regular = internal::constrain_finest(s, std::move(found), finest) && is_regular;
  }
  if (progress.is_cancelled())
    return Status::cancelled;
  guard.keep();
  s.is_constrained = is_regular;
  return is_regular ? Status::converged : Status::numerical_failure;
}

template <class ConcurrencyTag>
Status Session<ConcurrencyTag>::solve(const Elastic_options& options,
                                      Solver_start start,
                                      pcs::internal::Progress& progress)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  internal::start_report(s);
  const double begin = internal::is_factorized(s, options.stiffness) ? 0 : 0.5;
  Status status = Status::converged;
  {
    const pcs::internal::Progress_stage stage(progress, 0, begin);
    status = constrain(options.stiffness, progress);
  }
  if (status == Status::cancelled)
    return s.report.status = status;
  if (s.handles.empty())
    return s.report.status = progress(1) ? internal::solve_nothing(s) : Status::cancelled;
  if (status == Status::numerical_failure)
    return s.report.status = status;
  const pcs::internal::Progress_stage stage(progress, begin, 1);
  const pcs::internal::Stage_timer timer(s.report.seconds.solving);
  const Elastic_result result = internal::solve_samples(s, options, start, progress);
  internal::describe_result(s, result);
  const bool is_kept = result.status == Status::cancelled || internal::take_shape(s);
  return s.report.status = is_kept ? result.status : Status::numerical_failure;
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::has_shape_of_handles() const
{
  return m_state->setting_of_shape == m_state->setting;
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_ahead_of_shape() const
{
  return !m_state->is_at_rest && m_state->setting_of_sites != m_state->setting_of_shape;
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_of_rest_shape(const Session_snapshot& s) const
{
  return s.rest_setting == m_state->rest_setting;
}

template <class ConcurrencyTag>
Session_snapshot Session<ConcurrencyTag>::snapshot() const
{
  const Session_state<ConcurrencyTag>& s = *m_state;
  return {s.shape_transforms,
          s.handles.points(),
          s.shape_targets,
          s.handles.centroids(),
          s.maps,
          s.rest_setting,
          s.setting,
          s.is_at_rest};
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::restore(const Session_snapshot& snapshot)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  s.handles.restore(snapshot.handles, snapshot.centroids, snapshot.transforms, snapshot.targets);
  if (s.setting != snapshot.setting)
    s.dirty_handles.replace_handles();
  s.setting = snapshot.setting;
  s.maps = snapshot.maps;
  s.shape_transforms = s.handles.transforms();
  s.shape_targets = s.handles.targets();
  s.setting_of_shape = s.setting;
  s.is_at_rest = snapshot.is_at_rest;
  s.has_solution = false;
  internal::localize_transforms(s);
  pcs::internal::Progress no_callback;
  constrain(s.stiffness, no_callback);
  Target_field field;
  field.find(s.body, s.handles.points(), s.handles.targets(), s.local_transforms);
  internal::find_corrections(s, field);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::reset()
{
  Session_state<ConcurrencyTag>& s = *m_state;
  s.handles.put_at_rest();
  internal::put_samples_at_rest(s);
  s.has_solution = false;
  internal::localize_transforms(s);
  pcs::internal::Progress no_callback;
  constrain(s.stiffness, no_callback);
}

template <class ConcurrencyTag>
Moved_points<ConcurrencyTag> Session<ConcurrencyTag>::moved_points()
{
  Session_state<ConcurrencyTag>& s = *m_state;
  double& seconds = s.report.seconds.upsampling = 0;
  const pcs::internal::Stage_timer timer(seconds);
  const std::vector<char>& is_written = internal::find_written_handles(s);
  const Upsampling::Block_motions motions = internal::block_motions(s, is_written);
  internal::complete_maps(s);
  s.outlier_maps.read(s.body, s.maps);
  return {s.body,
          s.upsampling,
          s.maps,
          s.outlier_maps,
          s.sites,
          s.corrections,
          s.local_transforms,
          is_written,
          s.rest_positions,
          s.is_at_rest,
          motions,
          seconds};
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::finish_writing()
{
  m_state->dirty_handles.finish();
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::carry(Vec3& point, Vec3& normal, Eigen::Matrix3d& gradient) const
{
  const Session_state<ConcurrencyTag>& s = *m_state;
  const Vec3 local = s.body.frame.to_local(point);
  const std::size_t site = s.carrier->nearest_site(local);
  const Node_constraint h = s.sites[site];
  if (h >= 0)
    internal::carry_with_handle(s, h, site, local, point, normal, gradient);
  else if (h == free_node || h == outlier_site)
    internal::carry_with_samples(s, site, local, point, normal, gradient);
}

template <class ConcurrencyTag>
Eigen::Matrix3d Session<ConcurrencyTag>::gradient(std::size_t i) const
{
  const Session_state<ConcurrencyTag>& s = *m_state;
  if (s.is_at_rest)
    return Eigen::Matrix3d::Identity();
  const std::size_t site = s.body.site_of_input[i];
  const Node_constraint h = s.sites[site];
  if (h >= 0)
    return internal::gradient_of_handle(s, h, site);
  if (h == outlier_site)
    return Eigen::Map<const Row_major_matrix>(s.outlier_maps.of_site(s.body, site).a);
  if (h != free_node)
    return Eigen::Matrix3d::Identity();
  if (s.body.is_sampled)
    return internal::gradient_of_samples(s, s.body.place_of_input(i));
  return Eigen::Map<const Row_major_matrix>(s.maps[site].a);
}

template <class ConcurrencyTag>
Eigen::Matrix3d Session<ConcurrencyTag>::local_rotation(std::size_t i) const
{
  return polar_rotation(gradient(i));
}

template <class ConcurrencyTag>
Vec3 Session<ConcurrencyTag>::rest_position(std::size_t i) const
{
  const Session_state<ConcurrencyTag>& s = *m_state;
  return s.rest_positions(i, [&] {
    return s.body.frame.to_world(s.body.rest_of_place(s.body.place_of_input(i)));
  });
}

template <class ConcurrencyTag>
std::size_t Session<ConcurrencyTag>::point_of_sample(std::size_t sample) const
{
  const Sampled_body<ConcurrencyTag>& body = m_state->body;
  return body.input_of_place[body.first_place(body.site_of_sample[sample])];
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::has_energies() const
{
  const Session_state<ConcurrencyTag>& s = *m_state;
  return s.is_at_rest || (s.has_solution && s.setting_of_sites == s.setting_of_shape);
}

template <class ConcurrencyTag>
double Session<ConcurrencyTag>::energy_of_sample(std::size_t sample) const
{
  const Session_state<ConcurrencyTag>& s = *m_state;
  if (s.is_at_rest || s.sites[s.body.site_of_sample[sample]] == unreached_node)
    return 0;
  const double unit = s.body.frame.unit;
  return s.solver.state().energy_of_node(sample, s.body.number_of_samples()) * unit * unit;
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::prepare_carrying()
{
  Session_state<ConcurrencyTag>& s = *m_state;
  internal::complete_transforms(s);
  internal::complete_maps(s);
  s.outlier_maps.read(s.body, s.maps);
  if (s.carrier)
    return;
  internal::build_carrier(s);
  pcs::internal::Progress no_callback;
  if (s.sites.empty())
    constrain(s.stiffness, no_callback);
}

template <class ConcurrencyTag>
const Deformation_report& Session<ConcurrencyTag>::report() const
{
  return m_state->report;
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::set_normals(const std::function<Vec3(std::size_t)>& normal)
{
  Sampled_body<ConcurrencyTag>& body = m_state->body;
  body.rest_points.set_normals(
      [&](std::size_t place) { return normal(body.input_of_place[place]); });
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::accept(const std::function<Vec3(std::size_t)>& position)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  internal::move_rest(s, position);
  s.sites.accept();
  s.dirty_handles.accept();
  s.handles.put_at_rest();
  internal::begin_rest_shape(s);
  internal::put_samples_at_rest(s);
  s.handles.update_centroids(s.body);
  internal::localize_transforms(s);
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SESSION_IMPL_H

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
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/body/Sampled_body_impl.h>
#include <pcs/deformation/handles/constrain_body.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/multigrid/Coarse_levels.h>
#include <pcs/deformation/solver/Elastic_solver.h>
#include <pcs/deformation/upsampling/Dirty_handles.h>
#include <pcs/deformation/upsampling/Handle_fades.h>
#include <pcs/deformation/upsampling/Outlier_maps.h>
#include <pcs/deformation/upsampling/Point_carrier.h>
#include <pcs/deformation/upsampling/Rest_positions.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/deformation/upsampling/read_maps.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  The data of a session. A *setting* is a number that identifies the session, its handles and its
  rest shape; it changes whenever handles or the rest shape change. A snapshot brings back the
  setting of its handles.
*/
template <class ConcurrencyTag>
struct Session_state
{
  // ---- derived from the points; unusable if the construction was cancelled
  Sampled_body<ConcurrencyTag> body;
  Border_finder border_finder; ///< for the body's site graph, if the body is sampled
  Upsampling upsampling;       ///< if the body is sampled
  Coarse_levels<ConcurrencyTag> coarse;
  bool is_ready = false;

  // ---- the handles as the caller set them; no other call changes them
  Handle_set handles;
  std::uint64_t setting = 0;      ///< of the current handles and rest shape
  std::uint64_t rest_setting = 0; ///< the first setting of the rest shape

  // ---- constraints of these handles; a cancelled solve does not change them
  Site_constraints sites;
  Elastic_network
      network; ///< the samples and the nodes on the borders of handles, if there are any
  Elastic_solver<ConcurrencyTag> solver;
  Handle_fades fades;
  double stiffness = 1;
  bool is_constrained = false;        ///< whether the matrices of this setting are factorised
  std::uint64_t setting_of_sites = 0; ///< setting for which `sites` were found

  // ---- the state of the solver; a cancelled solve invalidates it, and the next solve starts cold
  bool has_solution = false; ///< under the current constraints
  double last_energy = 0;    ///< of the solution

  // ---- the current shape; a cancelled solve does not change it
  std::vector<Affine_map> maps;             ///< of the samples
  std::vector<Similarity> local_transforms; ///< of the handles, for these maps
  std::vector<Similarity> shape_transforms; ///< of the handles, in the caller's coordinates
  std::uint64_t setting_of_shape = 0;       ///< setting for which the shape was solved
  bool is_at_rest = true;

  // ---- memory of the next shape, kept so that frames allocate nothing
  std::vector<Similarity> next_transforms;
  std::vector<Affine_map> next_maps;
  std::vector<int> are_finite;

  // ---- output, computed from the current shape
  Rest_positions rest_positions;
  Dirty_handles dirty_handles; ///< handles with points displaced by earlier writes
  Outlier_maps outlier_maps;
  std::vector<Handle_map> handle_maps;
  std::unique_ptr<Point_carrier> carrier; ///< for the current rest shape; null until it is needed

  Deformation_report report;
  bool was_reported = false; ///< the first report includes the seconds of the construction
};

namespace internal {

// ---- settings and shapes

/// Marks the shape as the rest shape, which is valid for all handles.
template <class Tag>
void keep_rest(Session_state<Tag>& s)
{
  s.shape_transforms.assign(s.handles.size(), Similarity());
  s.setting_of_shape = s.setting;
  s.is_at_rest = true;
}

/// Begins a new setting after handles or the rest shape changed.
template <class Tag>
void begin_setting(Session_state<Tag>& s)
{
  static std::atomic<std::uint64_t> last{0};
  s.setting = ++last;
  if (s.is_at_rest)
    keep_rest(s);
}

/// Begins the first setting of a rest shape. Earlier snapshots cannot be restored.
template <class Tag>
void begin_rest_shape(Session_state<Tag>& s)
{
  begin_setting(s);
  s.rest_setting = s.setting;
}

template <class Tag>
void put_samples_at_rest(Session_state<Tag>& s)
{
  s.maps.assign(s.maps.size(), identity_map());
  keep_rest(s);
}

/// Converts the transformations set by the caller to local coordinates.
template <class Tag>
void localize_transforms(Session_state<Tag>& s)
{
  s.handles.local_transforms(s.body.frame, s.local_transforms);
}

/// Adds identities for handles that were added since the last solve. The outside of the region of
/// interest remains the last handle.
template <class Tag>
void complete_transforms(Session_state<Tag>& s)
{
  const std::size_t outside_count = s.handles.has_outside() ? 1 : 0;
  if (s.local_transforms.size() == s.handles.size() + outside_count)
    return;
  if (!s.local_transforms.empty())
    s.local_transforms.resize(s.local_transforms.size() - outside_count);
  s.local_transforms.resize(s.handles.size() + outside_count);
}

// ---- construction

template <class Tag>
void describe_body(Session_state<Tag>& s)
{
  const Sampled_body<Tag>& body = s.body;
  s.report.number_of_points = body.number_of_points();
  s.report.number_of_duplicates = body.number_of_points() - body.number_of_sites();
  s.report.number_of_samples = body.network.size();
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
  s.upsampling = Upsampling(s.body.number_of_points(), row, s.body.links_of_site);
  s.body.links_of_site = Sample_links();
}

template <class Tag>
void prepare_samples(Session_state<Tag>& s)
{
  s.maps.assign(s.body.network.size(), identity_map());
  s.next_maps = s.maps;
  s.coarse = Coarse_levels<Tag>(s.body.network,
                                s.body.component_of_sample(),
                                s.body.options.do_preserve_volume);
}

// ---- constraints

/// Factorises the network of the finest level and, meanwhile, finds the points near handles.
/// Returns `false` if a matrix is singular.
template <class Tag>
bool constrain_finest(Session_state<Tag>& s, Body_constraints found)
{
  if (found.has_network)
    s.network = std::move(found.network);
  bool is_regular = false;
  pcs::internal::invoke_both<Tag>(
      [&] {
        is_regular = s.solver.constrain(found.has_network ? s.network : s.body.network,
                                        std::move(found.of_nodes),
                                        s.stiffness);
      },
      [&] {
        if (s.body.is_sampled)
          s.fades.find(s.body, found.border, exact_handles(s.handles));
      });
  return is_regular;
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
  const Deviation_guess* guess = nullptr;
  {
    const pcs::internal::Stage_timer timer(s.report.seconds.coarse_levels);
    guess = &s.coarse.solve(s.next_transforms, options, progress);
  }
  return s.solver.solve(s.next_transforms, options, progress, *guess);
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
                      s.body.network.rest,
                      s.next_maps,
                      s.are_finite))
    return false;
  s.local_transforms.swap(s.next_transforms);
  s.maps.swap(s.next_maps);
  s.shape_transforms = s.handles.transforms();
  s.setting_of_shape = s.setting;
  s.is_at_rest = false;
  return true;
}

// ---- points of the session

template <class Tag>
const std::vector<char>& find_written_handles(Session_state<Tag>& s)
{
  return s.dirty_handles.find(s.local_transforms,
                              s.handles.has_outside(),
                              s.sites.take_followed_handles(),
                              s.is_at_rest);
}

template <class Tag>
Upsampling::Block_motions block_motions(Session_state<Tag>& s, const std::vector<char>& is_written)
{
  if (!s.body.is_sampled)
    return {};
  read_handle_maps(s.local_transforms, s.handle_maps);
  return {s.sites.is_blended().data(),
          s.sites.holder().data(),
          is_written.data(),
          s.handle_maps.data(),
          s.local_transforms.empty() ? Upsampling::Fades() : s.fades.of_blocks()};
}

/// Returns the gradient of the points of a handle in the current shape.
template <class Tag>
Eigen::Matrix3d gradient_of_handle(const Session_state<Tag>& s, Node_constraint h)
{
  const Similarity& t = s.local_transforms[static_cast<std::size_t>(h)];
  return t.scale() * t.rotation();
}

/// Returns the gradient of a point of a sampled body in the current shape. The gradients of points
/// at the same position may differ by rounding, as their blocks do.
template <class Tag>
Eigen::Matrix3d gradient_of_samples(const Session_state<Tag>& s, std::size_t place)
{
  const Upsampling::Block_motions motions{s.sites.is_blended().data(),
                                          s.sites.holder().data(),
                                          nullptr,
                                          s.handle_maps.data(),
                                          s.fades.of_blocks()};
  return s.upsampling.gradient(place, s.body.rest_points, motions);
}

// ---- points outside the session

template <class Tag>
void carry_with_handle(const Session_state<Tag>& s,
                       Node_constraint h,
                       const Vec3& local,
                       Vec3& point,
                       Vec3& normal,
                       Eigen::Matrix3d& gradient)
{
  const Similarity& t = s.local_transforms[static_cast<std::size_t>(h)];
  if (t.is_identity())
    return;
  point = s.body.frame.to_world(t(local));
  normal = t.rotation() * normal;
  gradient = t.scale() * t.rotation();
}

/// Returns the map of a point whose nearest site is `site`, which is free or an outlier.
template <class Tag>
Affine_map map_near_site(const Session_state<Tag>& s, std::size_t site, const Vec3& local)
{
  if (s.sites[site] == outlier_site)
    return s.outlier_maps.of_site(s.body, site);
  return s.body.is_sampled ? s.carrier->map_at(local, site, s.maps) : s.maps[site];
}

template <class Tag>
void carry_with_samples(const Session_state<Tag>& s,
                        std::size_t site,
                        const Vec3& local,
                        Vec3& point,
                        Vec3& normal,
                        Eigen::Matrix3d& gradient)
{
  const Affine_map map = map_near_site(s, site, local);
  gradient = Eigen::Map<const Row_major_matrix>(map.a);
  Vec3 moved = gradient * local + Eigen::Map<const Vec3>(map.t);
  Vec3 turned = turn_normal(gradient, normal);
  if (s.body.is_sampled && s.sites[site] != outlier_site && !s.local_transforms.empty())
    s.fades.apply(site, s.local_transforms, local, normal, moved, turned, gradient);
  point = s.body.frame.to_world(moved);
  normal = turned;
}

template <class Tag>
void build_carrier(Session_state<Tag>& s)
{
  std::vector<Vec3> sites(s.body.number_of_sites());
  for (std::size_t place = 0; place < s.body.number_of_points(); ++place)
    sites[s.body.site_of_place[place]] = s.body.rest_points.position(place);
  s.carrier = std::make_unique<Point_carrier>(std::move(sites),
                                              s.body.network.rest,
                                              s.body.sample_of_site,
                                              s.body.network.surface,
                                              s.body.options.number_of_sample_neighbors,
                                              s.body.options.sample_weights);
}

// ---- a new rest shape

/// Sets the rest positions of points and samples. `position(input index)` is in the caller's
/// coordinates.
template <class Tag>
void move_rest(Session_state<Tag>& s, const std::function<Vec3(std::size_t)>& position)
{
  Sampled_body<Tag>& body = s.body;
  body.rest_points.set_positions(
      [&](std::size_t place) { return body.frame.to_local(position(body.input_of_place[place])); });
  std::vector<Vec3> points(body.number_of_points());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = position(i);
  s.rest_positions.keep(body.frame, std::move(points));
  for (std::size_t sample = 0; sample < body.network.size(); ++sample)
    body.network.rest[sample] = body.rest_of_site(body.site_of_sample[sample]);
  s.coarse.accept(body.network);
  s.carrier.reset();
}

} // namespace internal

template <class ConcurrencyTag>
Session<ConcurrencyTag>::Session(std::vector<Vec3> points,
                                 const Sampling_options& options,
                                 const std::vector<std::uint32_t>* region,
                                 pcs::internal::Progress& progress)
  : m_state(std::make_unique<Session_state<ConcurrencyTag>>())
{
  Session_state<ConcurrencyTag>& s = *m_state;
  std::vector<Vec3> rest = points;
  s.is_ready = s.body.build(std::move(points), options, s.report.seconds, progress);
  if (!s.is_ready) {
    s.report.status = Status::cancelled;
    return;
  }
  s.rest_positions.keep(s.body.frame, std::move(rest));
  internal::describe_body(s);
  internal::prepare_points(s);
  internal::prepare_samples(s);
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
  return m_state->maps.size();
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
bool Session<ConcurrencyTag>::constrain(double stiffness)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  if (s.is_constrained && s.setting_of_sites == s.setting && stiffness == s.stiffness)
    return true;
  s.report.seconds.factorization = 0;
  const pcs::internal::Stage_timer timer(s.report.seconds.factorization);
  s.has_solution = s.is_constrained = false;
  s.stiffness = stiffness;
  s.setting_of_sites = s.setting;
  Body_constraints found = constrain_body(s.body, s.border_finder, s.handles, s.sites, s.report);
  const bool is_regular = s.coarse.constrain(s.body.network, found.of_samples, stiffness);
  s.is_constrained = internal::constrain_finest(s, std::move(found)) && is_regular;
  return s.is_constrained;
}

template <class ConcurrencyTag>
Status Session<ConcurrencyTag>::solve(const Elastic_options& options,
                                      Solver_start start,
                                      pcs::internal::Progress& progress)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  internal::start_report(s);
  const bool is_regular = constrain(options.stiffness);
  if (s.handles.empty())
    return s.report.status = progress(1) ? internal::solve_nothing(s) : Status::cancelled;
  if (!is_regular)
    return s.report.status = Status::numerical_failure;
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
  s.handles.restore(snapshot.handles, snapshot.centroids, snapshot.transforms);
  if (s.setting != snapshot.setting)
    s.dirty_handles.replace_handles();
  s.setting = snapshot.setting;
  s.maps = snapshot.maps;
  s.shape_transforms = s.handles.transforms();
  s.setting_of_shape = s.setting;
  s.is_at_rest = snapshot.is_at_rest;
  s.has_solution = false;
  internal::localize_transforms(s);
  constrain(s.stiffness);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::reset()
{
  Session_state<ConcurrencyTag>& s = *m_state;
  s.handles.put_at_rest();
  internal::put_samples_at_rest(s);
  s.has_solution = false;
  internal::localize_transforms(s);
  constrain(s.stiffness);
}

template <class ConcurrencyTag>
Moved_points<ConcurrencyTag> Session<ConcurrencyTag>::moved_points()
{
  Session_state<ConcurrencyTag>& s = *m_state;
  double& seconds = s.report.seconds.upsampling = 0;
  const pcs::internal::Stage_timer timer(seconds);
  const std::vector<char>& is_written = internal::find_written_handles(s);
  const Upsampling::Block_motions motions = internal::block_motions(s, is_written);
  s.outlier_maps.read(s.body, s.maps);
  return {s.body,
          s.upsampling,
          s.maps,
          s.outlier_maps,
          s.sites,
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
  m_state->dirty_handles.finish(m_state->local_transforms);
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::carry(Vec3& point, Vec3& normal, Eigen::Matrix3d& gradient) const
{
  const Session_state<ConcurrencyTag>& s = *m_state;
  const Vec3 local = s.body.frame.to_local(point);
  const std::size_t site = s.carrier->nearest_site(local);
  const Node_constraint h = s.sites[site];
  if (h >= 0)
    internal::carry_with_handle(s, h, local, point, normal, gradient);
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
    return internal::gradient_of_handle(s, h);
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
void Session<ConcurrencyTag>::prepare_carrying()
{
  Session_state<ConcurrencyTag>& s = *m_state;
  internal::complete_transforms(s);
  s.outlier_maps.read(s.body, s.maps);
  if (s.carrier)
    return;
  internal::build_carrier(s);
  if (s.sites.empty())
    constrain(s.stiffness);
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

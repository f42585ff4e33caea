// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Editing session: handles, constraints, solving and writing.

#ifndef PCS_DEFORMATION_SESSION_CORE_H
#define PCS_DEFORMATION_SESSION_CORE_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/deformation/Session.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/body/Sampled_body_impl.h>
#include <pcs/deformation/handles/Dirty_handles.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/handles/Site_constraints.h>
#include <pcs/deformation/handles/add_boundary_nodes.h>
#include <pcs/deformation/handles/anchor_free_components.h>
#include <pcs/deformation/handles/straighten_borders.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/multigrid/Coarse_levels.h>
#include <pcs/deformation/solver/Elastic_solver.h>
#include <pcs/deformation/upsampling/Handle_fades.h>
#include <pcs/deformation/upsampling/Outlier_maps.h>
#include <pcs/deformation/upsampling/Point_carrier.h>
#include <pcs/deformation/upsampling/read_maps.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// See `Session`.
template <class ConcurrencyTag>
class Session_core
{
public:
  /// \param region indices of the region of interest, or null for all points
  Session_core(std::vector<Vec3> points,
               const Sampling_options& options,
               const std::vector<std::uint32_t>* region,
               pcs::internal::Progress& progress)
  {
    m_is_ready = m_body.build(std::move(points), options, m_report.seconds, progress);
    if (!m_is_ready)
      return;
    m_report.number_of_points = m_body.number_of_points();
    m_report.number_of_duplicates = m_body.number_of_points() - m_body.number_of_sites();
    m_report.number_of_samples = m_body.network.size();
    m_report.number_of_interior_links = m_body.network.links.neighbor.size() / 2;
    m_report.number_of_components = m_body.number_of_components();
    m_report.number_of_short_cuts = m_body.number_of_short_cuts;
    m_maps.assign(m_body.network.size(), identity_map());
    m_next_maps = m_maps;
    build_coarse_levels();
    m_handles.start(m_body, region);
    begin_setting();
  }

  /// `false` if the callback cancelled the construction: nothing else may be called then.
  bool is_ready() const { return m_is_ready; }
  std::size_t number_of_points() const { return m_body.number_of_points(); }
  const Similarity& transform(std::size_t handle) const { return m_handles.transforms()[handle]; }
  std::size_t number_of_samples() const { return m_maps.size(); }

  /// Adds a handle that stays where it is. \param weight 0: exact; positive: soft, see
  /// `Node_constraints`
  std::size_t
  add_handle(const std::vector<std::uint32_t>& indices, double weight, const char* function)
  {
    const std::size_t handle = m_handles.add(m_body, indices, weight, function);
    m_is_constrained = false;
    begin_setting();
    return handle;
  }

  /// Frees the points of a handle. Its number is not used again.
  void remove_handle(std::size_t handle)
  {
    m_handles.remove(handle);
    m_is_constrained = false;
    begin_setting();
  }

  bool is_handle(std::size_t handle) const { return m_handles.contains(handle); }

  /// Centroid of the handle's points at rest, in the caller's coordinates.
  const Vec3& centroid(std::size_t handle) const { return m_handles.centroid(handle); }

  /// Throws `Invalid_input` if the motion cannot be represented beside the cloud.
  void set_transform(std::size_t handle, const Similarity& transform)
  {
    m_handles.set_transform(m_body.frame, handle, transform);
  }

  /// Factorises if handles changed since the last time. Returns `false` if a matrix is singular.
  bool constrain(double stiffness)
  {
    if (m_is_constrained && stiffness == m_stiffness)
      return true;
    m_has_solution = false;
    pcs::internal::Stopwatch watch;
    Node_constraints constraints = m_sites.find(m_body, m_handles, m_report);
    m_setting_of_sites = m_setting;
    m_stiffness = stiffness;
    Node_constraints of_samples =
        constraints; // exact handles without a sample get nodes on their border below
    anchor_free_components(
        [&](std::size_t s) { return m_body.component_of_site[m_body.site_of_sample[s]]; },
        m_body.sample_of_site,
        [&](std::size_t site) { return m_handles.exact_handle(site); },
        of_samples);
    const bool is_regular = m_coarse.constrain(m_body.network, of_samples, stiffness);
    bool is_extended = m_body.is_sampled;
    std::vector<Border_edge> border;
    if (m_body.is_sampled) {
      border = m_body.border_finder.template find<ConcurrencyTag>(
          m_body.site_graph,
          [&](std::size_t site) { return m_handles.exact_handle(site) >= 0; });
      m_network = with_boundary(border, constraints);
    } else
      is_extended = straighten_borders(m_body.network, constraints, m_network);
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] {
          m_is_constrained = m_solver.constrain(is_extended ? m_network : m_body.network,
                                                std::move(constraints),
                                                stiffness);
        },
        [&] {
          if (m_body.is_sampled)
            m_fades.find(m_body, border, [&](std::size_t site) {
              return m_handles.exact_handle(site);
            });
        });
    m_is_constrained = m_is_constrained && is_regular;
    m_report.seconds.factorization = watch.lap();
    return m_is_constrained;
  }

  /// Solves for the present transformations. The points are not written: see `write()`.
  Deformation_report
  solve(const Elastic_options& options, Solver_start start, pcs::internal::Progress& progress)
  {
    const bool is_first = !m_was_reported;
    m_was_reported = true;
    if (!is_first)
      m_report.seconds = Deformation_report::Seconds();
    Deformation_report& r = m_report;
    r.number_of_iterations = 0;
    r.initial_energy = r.energy = 0;
    if (m_handles.empty()) {
      constrain(options.stiffness);
      r.status = Status::nothing_to_do;
      m_maps.assign(m_maps.size(), identity_map());
      m_local_transforms.clear();
      keep_rest();
      return r;
    }
    if (!constrain(options.stiffness)) {
      r.status = Status::numerical_failure;
      return r;
    }
    pcs::internal::Stopwatch watch;
    std::vector<Similarity>& transforms = m_next_transforms;
    m_handles.local_transforms(m_body.frame, transforms);
    Elastic_result result;
    const bool is_warm =
        start == Solver_start::warm && m_has_solution && !m_coarse.has_link_offsets();
    if (!is_warm || !m_solver.solve_further(transforms,
                                            options,
                                            progress,
                                            largest_warm_growth * m_last_energy,
                                            result)) {
      const Deviation_guess& guess = m_coarse.solve(transforms, options, progress);
      r.seconds.coarse_levels = watch.lap();
      result = m_solver.solve(transforms, options, progress, guess);
    }
    m_has_solution = result.status != Status::cancelled;
    m_last_energy = result.energy;
    r.status = result.status;
    r.number_of_iterations = static_cast<std::size_t>(result.number_of_passes);
    const double unit = m_body.frame.unit;
    r.initial_energy = result.initial_energy * unit * unit;
    r.energy = result.energy * unit * unit;
    if (result.status != Status::cancelled) {
      m_local_transforms.swap(transforms);
      if (read_maps<ConcurrencyTag>(m_solver.state(),
                                    m_local_transforms,
                                    m_body.upsampling.sample_points(),
                                    m_next_maps,
                                    m_are_finite)) {
        m_maps.swap(m_next_maps);
        m_shape_transforms = m_handles.transforms();
        m_setting_of_shape = m_setting;
        m_is_at_rest = false;
      } else {
        m_local_transforms.swap(transforms);
        r.status = Status::numerical_failure;
      }
    }
    r.seconds.solving = r.seconds.coarse_levels + watch.lap();
    return r;
  }

  /// Whether the present shape was solved with the present handles, or is the rest shape.
  bool has_shape_of_handles() const { return m_setting_of_shape == m_setting; }
  /// Whether constraints were made for other handles than those that the present shape was solved
  /// with.
  bool is_ahead_of_shape() const
  {
    return !m_is_at_rest && m_setting_of_sites != m_setting_of_shape;
  }
  /// Whether a snapshot is of this session, its rest shape and its present handles.
  bool is_of_setting(const Session_snapshot& s) const { return s.setting == m_setting; }

  /// The last shape that was solved or restored, with the motions that belong to it.
  Session_snapshot snapshot() const
  {
    return {m_shape_transforms, m_maps, m_setting, m_is_at_rest};
  }

  void restore(const Session_snapshot& s)
  {
    m_handles.restore(s.transforms);
    m_maps = s.maps;
    m_shape_transforms = m_handles.transforms();
    m_setting_of_shape = m_setting;
    m_is_at_rest = s.is_at_rest;
    m_has_solution = false;
    m_handles.local_transforms(m_body.frame, m_local_transforms);
    constrain(m_stiffness);
  }

  /// Rest shape, handles at rest.
  void reset()
  {
    m_handles.put_at_rest();
    m_maps.assign(m_maps.size(), identity_map());
    keep_rest();
    m_has_solution = false;
    m_handles.local_transforms(m_body.frame, m_local_transforms);
    constrain(m_stiffness);
  }

  /// See `Session::write()`.
  Writing<ConcurrencyTag> start_writing()
  {
    const std::vector<char>& is_written = m_written_handles.find(m_local_transforms,
                                                                 m_handles.has_outside(),
                                                                 m_sites.take_followed_handles(),
                                                                 m_is_at_rest);
    m_outlier_maps.read(m_body, m_maps);
    Upsampling::Block_motions motions;
    if (m_body.is_sampled) {
      read_handle_maps(m_local_transforms, m_handle_maps);
      motions = {m_sites.is_blended().data(),
                 m_sites.holder().data(),
                 is_written.data(),
                 m_handle_maps.data(),
                 m_local_transforms.empty() ? Upsampling::Fades() : m_fades.of_blocks()};
    }
    return {m_body, m_maps, m_sites, m_outlier_maps, m_local_transforms, is_written, motions};
  }

  void end_writing(double seconds) { m_report.seconds.upsampling = seconds; }

  /*!
    Where the present deformation takes a point that need not belong to the session, and the normal
    there: like the points around it. Points whose nearest point stays, stay bit for bit.
    `prepare_carrying()` comes first.
  */
  void carry(Vec3& point, Vec3& normal) const
  {
    const Vec3 local = m_body.frame.to_local(point);
    const std::size_t site = m_carrier->nearest_site(local);
    const Node_constraint h = m_sites[site];
    if (h >= 0) {
      const Similarity& t = m_local_transforms[static_cast<std::size_t>(h)];
      if (t.is_identity())
        return;
      point = m_body.frame.to_world(t(local));
      normal = t.rotation() * normal;
    } else if (h == free_node || h == outlier_site) {
      const Affine_map map = h == outlier_site    ? m_outlier_maps.of_site(m_body, site)
                             : !m_body.is_sampled ? m_maps[site]
                                                  : m_carrier->map_at(local, site, m_maps);
      Eigen::Matrix3d a = Eigen::Map<const Row_major_matrix>(map.a);
      Vec3 moved = a * local + Eigen::Map<const Vec3>(map.t), turned = turn_normal(a, normal);
      if (m_body.is_sampled && h != outlier_site && !m_local_transforms.empty())
        m_fades.apply(site, m_local_transforms, local, normal, moved, turned, a);
      point = m_body.frame.to_world(moved);
      normal = turned;
    }
  }

  /// Builds what `carry()` needs, unless it is there. O(n log n).
  void prepare_carrying()
  {
    complete_transforms();
    m_outlier_maps.read(m_body, m_maps);
    if (m_carrier)
      return;
    std::vector<Vec3> sites(m_body.number_of_sites());
    for (std::size_t place = 0; place < m_body.number_of_points(); ++place)
      sites[m_body.site_of_place[place]] = m_body.upsampling.rest(place);
    m_carrier = std::make_unique<Point_carrier>(std::move(sites),
                                                m_body.upsampling.sample_points(),
                                                m_body.sample_of_site,
                                                m_body.network.surface,
                                                m_body.options.number_of_sample_neighbors,
                                                m_body.options.sample_weights);
    if (m_sites.empty())
      constrain(m_stiffness);
  }

  const Deformation_report& report() const { return m_report; }

  void set_normals(const std::function<Vec3(std::size_t)>& normal)
  {
    m_body.upsampling.set_normals(
        [&](std::size_t place) { return normal(m_body.input_of_place[place]); });
  }

  void accept(const std::function<Vec3(std::size_t)>& position)
  {
    m_body.upsampling.set_rest([&](std::size_t place) {
      return m_body.frame.to_local(position(m_body.input_of_place[place]));
    });
    for (std::size_t s = 0; s < m_maps.size(); ++s)
      m_body.network.rest[s] = m_body.rest_of_site(m_body.site_of_sample[s]);
    m_body.upsampling.set_sample_points(m_body.network.rest);
    m_coarse.accept(m_body.network);
    m_maps.assign(m_maps.size(), identity_map());
    m_carrier.reset();
    m_sites.accept();
    m_written_handles.accept();
    m_is_constrained = false;
    m_handles.put_at_rest();
    begin_setting();
    keep_rest();
    m_handles.update_centroids(m_body);
    m_handles.local_transforms(m_body.frame, m_local_transforms);
  }

private:
  /// Handles or the rest shape are others: snapshots of before cannot be brought back. No two
  /// sessions share a number.
  void begin_setting()
  {
    static std::atomic<std::uint64_t> last{0};
    m_setting = ++last;
    if (m_is_at_rest)
      keep_rest();
  }

  /// The shape is the rest shape, whatever the handles.
  void keep_rest()
  {
    m_shape_transforms.assign(m_handles.size(), Similarity());
    m_setting_of_shape = m_setting;
    m_is_at_rest = true;
  }

  void build_coarse_levels()
  {
    std::vector<std::uint32_t> component;
    for (const auto site : m_body.site_of_sample)
      component.push_back(m_body.component_of_site[site]);
    m_coarse = Coarse_levels<ConcurrencyTag>(m_body.network,
                                             std::move(component),
                                             m_body.options.do_preserve_volume);
  }

  /// Handles that were added since the last solve have moved nothing yet. The outside of the region
  /// stays the last.
  void complete_transforms()
  {
    const std::size_t outside_count = m_handles.has_outside() ? 1 : 0;
    if (m_local_transforms.size() == m_handles.size() + outside_count)
      return;
    if (!m_local_transforms.empty())
      m_local_transforms.resize(m_local_transforms.size() - outside_count);
    m_local_transforms.resize(m_handles.size() + outside_count);
  }

  /// The sample network with nodes on the borders of the handles.
  Elastic_network with_boundary(const std::vector<Border_edge>& border,
                                Node_constraints& constraints) const
  {
    const auto handle_of_site = [&](std::size_t site) { return m_handles.exact_handle(site); };
    const auto position = [&](std::size_t site) { return m_body.rest_of_site(site); };
    return add_boundary_nodes(
        Boundary_input<decltype(handle_of_site), decltype(position)>{m_body.network,
                                                                     m_body.weight_unit,
                                                                     border,
                                                                     m_body.sample_of_site,
                                                                     handle_of_site,
                                                                     position},
        constraints);
  }

  Sampled_body<ConcurrencyTag> m_body;
  Elastic_network
      m_network; ///< the samples and the borders of the handles, if these are no samples
  Elastic_solver<ConcurrencyTag> m_solver;
  Coarse_levels<ConcurrencyTag> m_coarse;
  Handle_set m_handles;
  Site_constraints m_sites;
  Handle_fades m_fades;
  std::vector<Similarity> m_local_transforms; ///< those that the maps belong to
  std::vector<Similarity> m_next_transforms;
  std::vector<Similarity> m_shape_transforms; ///< motions that the present shape was solved for
  std::uint64_t m_setting = 0;                ///< of now
  std::uint64_t m_setting_of_shape = 0;       ///< when the shape was solved
  std::uint64_t m_setting_of_sites = 0;       ///< when what becomes of every site was found
  bool m_is_at_rest = true;
  Dirty_handles m_written_handles;
  std::vector<int> m_are_finite;
  std::unique_ptr<Point_carrier> m_carrier;
  std::vector<Affine_map> m_maps, m_next_maps;
  Outlier_maps m_outlier_maps;
  std::vector<Handle_map> m_handle_maps; ///< of the present shape
  Deformation_report m_report;
  double m_stiffness = 1;
  bool m_is_constrained = false, m_is_ready = false, m_was_reported = false;
  bool m_has_solution = false; ///< of the solver, under the present constraints
  double m_last_energy = 0;    ///< of that
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SESSION_CORE_H

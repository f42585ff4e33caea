// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Handles, constraints and frames of one editing session, on plain coordinates.

#ifndef PCS_DEFORMATION_SESSION_H
#define PCS_DEFORMATION_SESSION_H

#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/Coarse_level.h>
#include <pcs/deformation/Elastic_solver.h>
#include <pcs/deformation/Handle_fades.h>
#include <pcs/deformation/Point_carrier.h>
#include <pcs/deformation/Sampled_body.h>
#include <pcs/deformation/affine_maps.h>
#include <pcs/deformation/handle_boundary.h>
#include <pcs/deformation/straighten_borders.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// The samples' state at one moment: enough to bring every point back.
struct Session_snapshot
{
  std::vector<Similarity> transforms; ///< of the handles
  std::vector<Affine_map> maps;       ///< of the samples
};

/*!
  What `Point_set_deformation` does, without its point types. Indices are the caller's; transformations are in the
  caller's coordinates; errors are thrown before anything changes.
*/
template <class ConcurrencyTag>
class Session
{
public:
  /// \param region indices of the region of interest, or null for all points
  Session(std::vector<Vec3> points,
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
    build_coarse_levels();
    m_handle_of_site.assign(m_body.number_of_sites(), free_node);
    if (region) {
      m_handle_of_site.assign(m_body.number_of_sites(), outside);
      for (const auto i : *region)
        m_handle_of_site[m_body.site_of_input[i]] = free_node;
      m_has_outside = true;
    }
  }

  /// `false` if the callback cancelled the construction: nothing else may be called then.
  bool is_ready() const { return m_is_ready; }
  std::size_t number_of_points() const { return m_body.number_of_points(); }
  std::size_t number_of_handles() const { return m_transforms.size(); }
  const Local_frame& frame() const { return m_body.frame; }
  const Similarity& transform(std::size_t handle) const { return m_transforms[handle]; }
  std::size_t number_of_samples() const { return m_maps.size(); }

  /// Adds a handle that stays where it is. \param weight 0: exact; positive: soft, see `Node_constraints`
  std::size_t
  add_handle(const std::vector<std::uint32_t>& indices, double weight, const char* function)
  {
    if (indices.empty())
      throw Invalid_input(std::string(function) + ": a handle needs at least one point");
    for (const auto i : indices) {
      const Node_constraint h = m_handle_of_site[m_body.site_of_input[i]];
      if (h == outside)
        throw Invalid_input(std::string(function) + ": point " + std::to_string(i) +
                            " of the handle is outside the region of interest");
      if (h >= 0 && m_is_used[static_cast<std::size_t>(h)])
        throw Invalid_input(std::string(function) + ": point " + std::to_string(i) +
                            " (or another one at the same place) belongs to handle " +
                            std::to_string(h) + " already; a point has one target");
    }
    const std::size_t handle = m_transforms.size();
    for (const auto i : indices)
      m_handle_of_site[m_body.site_of_input[i]] = static_cast<Node_constraint>(handle);
    m_transforms.emplace_back();
    m_weight.push_back(weight);
    m_is_used.push_back(1);
    std::vector<char> is_reached(m_body.number_of_components(), 0);
    for (const auto i : indices)
      is_reached[m_body.component_of_site[m_body.site_of_input[i]]] = 1;
    m_components_of_handle.emplace_back();
    for (std::size_t c = 0; c < is_reached.size(); ++c)
      if (is_reached[c])
        m_components_of_handle.back().push_back(static_cast<std::uint32_t>(c));
    Vec3 sum = Vec3::Zero();
    for (const auto i : indices)
      sum += rest_of_site(m_body.site_of_input[i]);
    m_centroid.push_back(m_body.frame.to_world(sum / static_cast<double>(indices.size())));
    m_is_constrained = false;
    return handle;
  }

  /// Frees the points of a handle. Its number is not used again.
  void remove_handle(std::size_t handle)
  {
    for (auto& h : m_handle_of_site)
      if (h == static_cast<Node_constraint>(handle))
        h = free_node;
    m_is_used[handle] = 0;
    m_transforms[handle] = Similarity();
    m_is_constrained = false;
  }

  bool is_handle(std::size_t handle) const
  {
    return handle < m_is_used.size() && m_is_used[handle];
  }

  /// Centroid of the handle's points at rest, in the caller's coordinates.
  const Vec3& centroid(std::size_t handle) const { return m_centroid[handle]; }

  /// Throws `Invalid_input` if the motion cannot be represented beside the cloud.
  void set_transform(std::size_t handle, const Similarity& transform)
  {
    check_motion(handle, transform);
    m_transforms[handle] = transform;
  }

  /// Factorises if handles changed since the last time. Returns `false` if a matrix is singular.
  bool constrain(double stiffness)
  {
    if (m_is_constrained && stiffness == m_stiffness)
      return true;
    pcs::internal::Stopwatch watch;
    Node_constraints constraints = sample_constraints();
    m_stiffness = stiffness;
    bool is_regular = true;
    const Elastic_network* finer = &m_body.network;
    const Node_constraints* of_finer = &constraints;
    for (auto& level : m_coarse) {
      is_regular = level.constrain(*finer, *of_finer, stiffness) && is_regular;
      finer = &level.network();
      of_finer = &level.constraints();
    }
    bool is_extended = m_body.is_sampled;
    std::vector<Border_edge> border;
    if (m_body.is_sampled) {
      border = m_body.border_finder.template find<ConcurrencyTag>(
          m_body.site_graph,
          [&](std::size_t site) { return exact_handle(site) >= 0; });
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
            m_fades.find(m_body, border, [&](std::size_t site) { return exact_handle(site); });
        });
    m_is_constrained = m_is_constrained && is_regular;
    m_report.seconds.factorization = watch.lap();
    return m_is_constrained;
  }

  /// Solves for the present transformations. The points are not written: see `write()`.
  Deformation_report solve(const Elastic_options& options, pcs::internal::Progress& progress)
  {
    const bool is_first = !m_was_reported;
    m_was_reported = true;
    if (!is_first)
      m_report.seconds = Deformation_report::Seconds();
    Deformation_report& r = m_report;
    r.number_of_iterations = 0;
    r.initial_energy = r.energy = 0;
    if (std::find(m_is_used.begin(), m_is_used.end(), 1) == m_is_used.end()) {
      constrain(options.stiffness);
      r.status = Status::nothing_to_do;
      m_maps.assign(m_maps.size(), identity_map());
      m_local_transforms.clear();
      return r;
    }
    if (!constrain(options.stiffness)) {
      r.status = Status::numerical_failure;
      return r;
    }
    pcs::internal::Stopwatch watch;
    std::vector<Similarity> transforms = local_transforms();
    Deviation_guess guess;
    for (std::size_t level = m_coarse.size(); level-- > 0 && progress(0);)
      m_coarse[level].improve(transforms, options, m_maps.size(), guess);
    const Elastic_result result = m_solver.solve(transforms, options, progress, guess);
    r.status = result.status;
    r.number_of_iterations = static_cast<std::size_t>(result.number_of_passes);
    const double unit = m_body.frame.unit;
    r.initial_energy = result.initial_energy * unit * unit;
    r.energy = result.energy * unit * unit;
    if (result.status != Status::cancelled) {
      m_local_transforms.swap(transforms);
      read_maps();
      if (m_solver.is_finite() && all_finite(m_next_maps))
        m_maps.swap(m_next_maps);
      else {
        m_local_transforms.swap(transforms);
        r.status = Status::numerical_failure;
      }
    }
    r.seconds.solving = watch.lap();
    return r;
  }

  Session_snapshot snapshot() const { return {m_transforms, m_maps}; }

  void restore(const Session_snapshot& s)
  {
    m_transforms = s.transforms;
    m_transforms.resize(m_is_used.size());
    m_maps = s.maps;
    m_local_transforms = local_transforms();
    constrain(m_stiffness);
  }

  /// Rest shape, handles at rest.
  void reset()
  {
    for (Similarity& t : m_transforms)
      t = Similarity();
    m_maps.assign(m_maps.size(), identity_map());
    m_local_transforms = local_transforms();
    constrain(m_stiffness);
  }

  /*!
    Calls `write(input index, position, normal, gradient)` in the caller's coordinates for every point that the
    deformation may move, side by side: not for points outside the region of interest, nor for those that no handle
    reaches, nor for handles that have not moved. `gradient` is set if `HasGradients`: the linear part of the map of
    the point.
  */
  template <bool HasGradients, class Write>
  void write(const Write& write_point)
  {
    pcs::internal::Stopwatch watch;
    const auto& body = m_body;
    const auto put =
        [&](std::size_t place, const Vec3& p, const Vec3& normal, const Eigen::Matrix3d& gradient) {
          write_point(body.input_of_place[place], body.frame.to_world(p), normal, gradient);
        };
    const std::vector<char> is_written = moved_handles();
    read_outlier_maps();
    const auto put_other = [&](std::size_t place) {
      const Node_constraint h = m_constraint_of_site[body.site_of_place[place]];
      if (h >= 0 && is_written[static_cast<std::size_t>(h)])
        put_rigid(place, static_cast<std::size_t>(h), put);
      else if (h == outlier)
        put_mapped(place, outlier_map(body.site_of_place[place]), put);
    };
    // In the caller's coordinates already.
    const auto put_blended =
        [&](std::size_t place, const Vec3& p, const Vec3& normal, const Eigen::Matrix3d& gradient)
            PCS_LAMBDA_INLINE { write_point(body.input_of_place[place], p, normal, gradient); };
    if (body.is_sampled)
      m_body.upsampling.template apply<ConcurrencyTag, HasGradients>(
          m_maps,
          {body.frame.unit, body.frame.origin},
          m_is_blended,
          m_fades.of_blocks(m_local_transforms),
          put_blended,
          put_other);
    else
      pcs::internal::for_each_index<ConcurrencyTag>(body.number_of_points(),
                                                    [&](std::size_t place) {
                                                      const std::size_t site =
                                                          body.site_of_place[place];
                                                      if (m_constraint_of_site[site] == free_node)
                                                        put_mapped(place, m_maps[site], put);
                                                      else
                                                        put_other(place);
                                                    });
    m_report.seconds.upsampling = watch.lap();
  }

  /*!
    Where the present deformation takes a point that need not belong to the session, and the normal there: like the
    points around it. Points whose nearest point stays, stay bit for bit. `prepare_carrying()` comes first.
  */
  void carry(Vec3& point, Vec3& normal) const
  {
    const Vec3 local = m_body.frame.to_local(point);
    const std::size_t site = m_carrier->nearest_site(local);
    const Node_constraint h = m_constraint_of_site[site];
    if (h >= 0) {
      const Similarity& t = m_local_transforms[static_cast<std::size_t>(h)];
      if (t.is_identity())
        return;
      point = m_body.frame.to_world(t(local));
      normal = t.rotation() * normal;
    } else if (h == free_node || h == outlier) {
      const Affine_map map = h == outlier         ? outlier_map(site)
                             : !m_body.is_sampled ? m_maps[site]
                                                  : m_carrier->map_at(local, site, m_maps);
      Eigen::Matrix3d a = Eigen::Map<const Row_major_matrix>(map.a);
      Vec3 moved = a * local + Eigen::Map<const Vec3>(map.t), turned = turn_normal(a, normal);
      if (m_body.is_sampled && h != outlier && !m_local_transforms.empty())
        m_fades.apply(site, m_local_transforms, local, normal, moved, turned, a);
      point = m_body.frame.to_world(moved);
      normal = turned;
    }
  }

  /// Builds what `carry()` needs, unless it is there. O(n log n).
  void prepare_carrying()
  {
    complete_transforms();
    read_outlier_maps();
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
    if (m_constraint_of_site.empty())
      constrain(m_stiffness);
  }

  const Deformation_report& report() const { return m_report; }

  /// `normal(input index)` gives the normals at rest. [-]
  template <class Normal_at>
  void set_normals(const Normal_at& normal)
  {
    m_body.upsampling.set_normals(
        [&](std::size_t place) { return normal(m_body.input_of_place[place]); });
  }

  /// The present shape becomes the rest shape. `position(input index)` reads it in the caller's coordinates.
  template <class Position_at>
  void accept(const Position_at& position)
  {
    m_body.upsampling.set_rest([&](std::size_t place) {
      return m_body.frame.to_local(position(m_body.input_of_place[place]));
    });
    for (std::size_t s = 0; s < m_maps.size(); ++s) {
      const Eigen::Map<const Row_major_matrix> a(m_maps[s].a);
      m_body.network.rest[s] =
          a * m_body.network.rest[s] + Vec3(m_maps[s].t[0], m_maps[s].t[1], m_maps[s].t[2]);
    }
    m_body.upsampling.set_sample_points(m_body.network.rest);
    const Elastic_network* finer = &m_body.network;
    for (auto& level : m_coarse) {
      level.accept(*finer);
      finer = &level.network();
    }
    m_maps.assign(m_maps.size(), identity_map());
    m_carrier.reset();
    m_is_constrained = false;
    for (Similarity& t : m_transforms)
      t = Similarity();
    update_centroids();
    m_local_transforms = local_transforms();
  }

private:
  static constexpr Node_constraint outside = -3;
  static constexpr Node_constraint outlier =
      -4; ///< of a site: follows its host as if they were one rigid body
  /// Scale and distance [extents] beyond which double precision keeps nothing of the shape.
  static constexpr double largest_motion = 1e12;

  void check_motion(std::size_t handle, const Similarity& transform) const
  {
    const double distance =
        (transform(m_body.frame.origin) - m_body.frame.origin).norm() / m_body.frame.unit;
    if (!transform.is_finite() || !(distance < largest_motion) ||
        !(transform.scale() < largest_motion && transform.scale() > 1 / largest_motion))
      throw Invalid_input("pcs deformation: the motion of handle " + std::to_string(handle) +
                          " has scale " + pcs::internal::to_text(transform.scale()) +
                          " and takes the cloud " + pcs::internal::to_text(distance) +
                          " times its extent away; both must be less than " +
                          pcs::internal::to_text(largest_motion));
  }

  void build_coarse_levels()
  {
    std::vector<std::uint32_t> component;
    for (const auto site : m_body.site_of_sample)
      component.push_back(m_body.component_of_site[site]);
    const Elastic_network* finer = &m_body.network;
    const std::vector<std::uint32_t>* of_finer = &component;
    while (finer->size() >= smallest_coarsened_network) {
      m_coarse.emplace_back(*finer, *of_finer, m_body.options.do_preserve_volume);
      finer = &m_coarse.back().network();
      of_finer = &m_coarse.back().component();
    }
  }

  Vec3 rest_of_site(std::size_t site) const { return m_body.rest_of_site(site); }

  /// Handles that were added since the last solve have moved nothing yet. The outside of the region stays the last.
  void complete_transforms()
  {
    const std::size_t outside_count = m_has_outside ? 1 : 0;
    if (m_local_transforms.size() == m_transforms.size() + outside_count)
      return;
    if (!m_local_transforms.empty())
      m_local_transforms.resize(m_local_transforms.size() - outside_count);
    m_local_transforms.resize(m_transforms.size() + outside_count);
  }

  void update_centroids()
  {
    std::vector<Vec3> sum(m_centroid.size(), Vec3::Zero());
    std::vector<double> count(m_centroid.size(), 0);
    for (std::size_t place = 0; place < m_body.number_of_points(); ++place) {
      const Node_constraint h = m_handle_of_site[m_body.site_of_place[place]];
      if (h < 0)
        continue;
      sum[static_cast<std::size_t>(h)] += m_body.upsampling.rest(place);
      count[static_cast<std::size_t>(h)] += 1;
    }
    for (std::size_t h = 0; h < sum.size(); ++h)
      if (count[h] > 0)
        m_centroid[h] = m_body.frame.to_world(sum[h] / count[h]);
  }

  bool is_soft(Node_constraint h) const
  {
    return h >= 0 && m_weight[static_cast<std::size_t>(h)] > 0;
  }

  /// Handles in local coordinates: `x -> sR x + (sR c + t - c) / unit`; the outside of the region comes last.
  std::vector<Similarity> local_transforms() const
  {
    std::vector<Similarity> local;
    for (const Similarity& t : m_transforms) {
      Similarity linear = Similarity::from_scale(t.scale());
      for (const auto& turn : t.turns())
        linear = Similarity::from_turn(turn) * linear;
      const Vec3& c = m_body.frame.origin;
      const Vec3 offset = (linear(c) - c) + t.translation();
      local.push_back(Similarity::from_translation(offset / m_body.frame.unit) * linear);
    }
    if (m_has_outside)
      local.emplace_back();
    return local;
  }

  /// Which samples are held by which handle, and what becomes of every site.
  Node_constraints sample_constraints()
  {
    const auto& body = m_body;
    const auto outside_handle = static_cast<Node_constraint>(m_transforms.size());
    Node_constraints constraints;
    constraints.softness_weight = m_weight;
    if (m_has_outside)
      constraints.softness_weight.push_back(0);
    std::vector<char> is_reached(body.number_of_components(), 0);
    for (std::size_t h = 0; h < m_is_used.size(); ++h)
      if (m_is_used[h])
        for (const auto component : m_components_of_handle[h])
          is_reached[component] = 1;

    auto& of_sample = constraints.handle_of_node;
    of_sample.assign(m_maps.size(), free_node);
    std::set<std::pair<Node_constraint, std::uint32_t>> has_sample; // handle and component
    for (std::size_t s = 0; s < of_sample.size(); ++s) {
      const std::size_t site = body.site_of_sample[s];
      const Node_constraint h = m_handle_of_site[site];
      if (!is_reached[body.component_of_site[site]])
        of_sample[s] = unreached_node;
      else if (h == outside)
        of_sample[s] = outside_handle;
      else if (h >= 0) {
        of_sample[s] = h;
        has_sample.emplace(h, body.component_of_site[site]);
      }
    }
    // A soft handle between the samples draws those in whose regions its points lie; an exact one has nodes on its
    // border.
    bool has_soft_handles = false;
    for (std::size_t h = 0; h < m_is_used.size(); ++h)
      has_soft_handles = has_soft_handles || (m_is_used[h] && m_weight[h] > 0);
    for (std::size_t site = 0; has_soft_handles && site < body.number_of_sites(); ++site) {
      const Node_constraint h = m_handle_of_site[site];
      if (!is_soft(h) || body.sample_of_site[site] == no_sample ||
          has_sample.count({h, body.component_of_site[site]}) > 0)
        continue;
      Node_constraint& sample = of_sample[body.sample_of_site[site]];
      if (sample == free_node)
        sample = h;
    }
    classify_sites(is_reached);
    return constraints;
  }

  void classify_sites(const std::vector<char>& is_reached)
  {
    const auto& body = m_body;
    m_report.number_of_unreached_components = m_report.number_of_unreached_points = 0;
    for (std::size_t c = 0; c < body.number_of_components(); ++c)
      if (!is_reached[c]) {
        ++m_report.number_of_unreached_components;
        m_report.number_of_unreached_points += body.component_size[c];
      }
    // Fragments too small for a sample of their own follow the handle that touches them.
    std::vector<Node_constraint> follows(body.number_of_components(), unreached_node);
    for (std::size_t site = 0; body.has_fragments && site < body.number_of_sites(); ++site) {
      Node_constraint& f = follows[body.component_of_site[site]];
      if (m_handle_of_site[site] >= 0 && f == unreached_node)
        f = m_handle_of_site[site];
    }
    // What was written once goes back to rest when its last handle is removed.
    m_was_reached.resize(body.number_of_components(), 0);
    m_constraint_of_site.resize(body.number_of_sites());
    pcs::internal::for_each_index<ConcurrencyTag>(body.number_of_sites(), [&](std::size_t site) {
      const std::size_t component = body.component_of_site[site];
      Node_constraint h = m_handle_of_site[site];
      if (h == outside)
        h = unreached_node;
      else if (!is_reached[component])
        h = m_was_reached[component] ? free_node : unreached_node;
      else if (body.sample_of_site[site] == no_sample && h == free_node)
        h = follows[component];
      else if (is_soft(h))
        h = free_node;
      m_constraint_of_site[site] = h;
    });
    if (body.is_sampled)
      for (const neighborhood::Outlier& o : body.outliers)
        if (m_constraint_of_site[o.point] == free_node)
          m_constraint_of_site[o.point] = outlier;
    for (std::size_t c = 0; c < is_reached.size(); ++c)
      m_was_reached[c] = m_was_reached[c] || is_reached[c] ? 1 : 0;
    // Eight places share a byte, as eight points share a block of the upsampling.
    m_is_blended.resize(body.upsampling.number_of_blocks());
    pcs::internal::for_each_index<ConcurrencyTag>(m_is_blended.size(), [&](std::size_t block) {
      unsigned bits = 0;
      const std::size_t begin = block * lanes;
      for (std::size_t l = 0; l < lanes && begin + l < body.number_of_points(); ++l)
        if (m_constraint_of_site[body.site_of_place[begin + l]] == free_node)
          bits |= 1u << l;
      m_is_blended[block] = static_cast<std::uint8_t>(bits);
    });
  }

  /// The similarity nearest to the map of the sample that an outlier hangs on: far away, a stretch would be a throw.
  void read_outlier_maps()
  {
    if (!m_body.is_sampled)
      return;
    m_outlier_maps.resize(m_body.outliers.size());
    pcs::internal::for_each_index<ConcurrencyTag>(m_outlier_maps.size(), [&](std::size_t o) {
      const std::size_t s = m_body.sample_of_site[m_body.outliers[o].point];
      if (s == no_sample)
        return;
      const Affine_map& map = m_maps[s];
      const Eigen::Matrix3d a = Eigen::Map<const Row_major_matrix>(map.a);
      const Vec3 center = m_body.network.rest[s];
      const Eigen::Matrix3d similarity = std::cbrt(std::abs(a.determinant())) * nearest_rotation(a);
      Eigen::Map<Row_major_matrix>(m_outlier_maps[o].a) = similarity;
      Eigen::Map<Vec3>(m_outlier_maps[o].t) =
          a * center + Eigen::Map<const Vec3>(map.t) - similarity * center;
    });
  }

  const Affine_map& outlier_map(std::size_t site) const
  {
    const auto o =
        std::lower_bound(m_body.outliers.begin(),
                         m_body.outliers.end(),
                         site,
                         [](const neighborhood::Outlier& a, std::size_t s) { return a.point < s; });
    return m_outlier_maps[static_cast<std::size_t>(o - m_body.outliers.begin())];
  }

  /// Handles whose points are written: those that move, or did so the last time. Others keep their bits.
  std::vector<char> moved_handles()
  {
    // Points of a new handle may have been carried away before they became a handle.
    m_was_moved.resize(m_local_transforms.size(), m_is_displaced ? 1 : 0);
    std::vector<char> is_written = m_was_moved;
    for (std::size_t h = 0; h < m_local_transforms.size(); ++h) {
      m_was_moved[h] = m_local_transforms[h].is_identity() ? 0 : 1;
      is_written[h] = is_written[h] || m_was_moved[h] ? 1 : 0;
      m_is_displaced = m_is_displaced || m_was_moved[h];
    }
    return is_written;
  }

  template <class Put>
  void put_rigid(std::size_t place, std::size_t handle, const Put& put) const
  {
    const Similarity& t = m_local_transforms[handle];
    Vec3 normal = Vec3::Zero();
    if (m_body.upsampling.has_normals())
      normal = t.rotation() * m_body.upsampling.rest_normal(place);
    put(place, t(m_body.upsampling.rest(place)), normal, t.scale() * t.rotation());
  }

  template <class Put>
  void put_mapped(std::size_t place, const Affine_map& map, const Put& put) const
  {
    const Eigen::Matrix3d a = Eigen::Map<const Row_major_matrix>(map.a);
    Vec3 normal = Vec3::Zero();
    if (m_body.upsampling.has_normals())
      normal = turn_normal(a, m_body.upsampling.rest_normal(place));
    put(place, a * m_body.upsampling.rest(place) + Eigen::Map<const Vec3>(map.t), normal, a);
  }

  /// The samples' maps: the deformation gradient, which carries stretch as well, about the new position.
  void read_maps()
  {
    m_next_maps.resize(m_maps.size());
    const Elastic_state state = m_solver.state();
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_maps.size(),
        [&](std::size_t s) {
          const Node_constraint h = state.constraints.handle_of_node[s];
          if (h == unreached_node) {
            m_next_maps[s] = identity_map();
            return;
          }
          const bool is_rigid = state.constraints.is_prescribed(s);
          const Eigen::Matrix3d a = is_rigid ? state.frame[s] : state.deformation_gradient(s);
          // A prescribed map is the handle's own, to the last bit.
          const Vec3 t = is_rigid
                             ? m_local_transforms[static_cast<std::size_t>(h)].translation()
                             : Vec3(state.position[s] - a * m_body.upsampling.sample_points()[s]);
          Eigen::Map<Row_major_matrix>(m_next_maps[s].a) = a;
          Eigen::Map<Vec3>(m_next_maps[s].t) = t;
        },
        512);
  }

  /// The exact handle that holds a site; the outside of the region counts as one, after all others.
  Node_constraint exact_handle(std::size_t site) const
  {
    const Node_constraint h = m_handle_of_site[site];
    if (h == outside)
      return static_cast<Node_constraint>(m_transforms.size());
    return is_soft(h) ? free_node : h;
  }

  /// The sample network with nodes on the borders of the handles.
  Elastic_network with_boundary(const std::vector<Border_edge>& border,
                                Node_constraints& constraints) const
  {
    const auto handle_of_site = [&](std::size_t site) { return exact_handle(site); };
    const auto position = [&](std::size_t site) { return rest_of_site(site); };
    return with_boundary_nodes(
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
  std::deque<Coarse_level<ConcurrencyTag>>
      m_coarse;                                  ///< the finest first; a deque does not move them
  std::vector<Node_constraint> m_handle_of_site; ///< as the caller said
  std::vector<Node_constraint> m_constraint_of_site; ///< as it is written
  std::vector<std::uint8_t> m_is_blended;            ///< one bit per place
  Handle_fades m_fades;
  std::vector<Similarity> m_transforms, m_local_transforms;
  std::vector<double> m_weight;
  std::vector<std::vector<std::uint32_t>> m_components_of_handle;
  std::vector<char> m_is_used, m_was_moved, m_was_reached;
  std::vector<Vec3> m_centroid;
  std::unique_ptr<Point_carrier> m_carrier;
  std::vector<Affine_map> m_maps, m_next_maps, m_outlier_maps;
  Deformation_report m_report;
  double m_stiffness = 1;
  bool m_has_outside = false, m_is_constrained = false, m_is_ready = false, m_was_reported = false;
  bool m_is_displaced = false; ///< whether points were written elsewhere than at rest
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SESSION_H

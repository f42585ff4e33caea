// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Handles of an editing session: their points, softness and motion.

#ifndef PCS_DEFORMATION_HANDLES_HANDLE_SET_H
#define PCS_DEFORMATION_HANDLES_HANDLE_SET_H

#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Handle_targets.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Local_frame.h>
#include <pcs/deformation/model/Node_constraints.h>
#include <pcs/internal/text.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// A site that is not in the region of interest.
constexpr Node_constraint outside_region = -3;

/// The handles of a session: points, softness and motion. Transformations are in the caller's
/// coordinates. A number is given to one handle only, even if `restore()` removes this handle.
class Handle_set
{
public:
  /// Scale and distance [extents] beyond which double precision cannot represent the shape.
  static constexpr double largest_motion = 1e12;

  /// \param region indices of the region of interest, or null for all points. A site belongs
  /// to the region only if all of its points do
  template <class ConcurrencyTag>
  void start(const Sampled_body<ConcurrencyTag>& body, const std::vector<std::uint32_t>* region)
  {
    m_has_outside = region != nullptr;
    m_handle_of_site.assign(body.number_of_sites(), free_node);
    if (!m_has_outside)
      return;
    std::vector<char> is_inside(body.number_of_points(), 0);
    for (const auto i : *region)
      is_inside[i] = 1;
    for (std::size_t i = 0; i < is_inside.size(); ++i)
      if (!is_inside[i])
        m_handle_of_site[body.site_of_input[i]] = outside_region;
  }

  /// Returns the length of the lists of handles, which contain removed handles. `restore()` brings
  /// back the length of its time.
  std::size_t size() const { return m_transforms.size(); }
  bool contains(std::size_t handle) const { return handle < size() && m_points[handle]; }
  bool empty() const
  {
    return std::find_if(m_points.begin(), m_points.end(), is_used) == m_points.end();
  }

  /// Whether there are points outside the region of interest. An additional last handle holds them.
  bool has_outside() const { return m_has_outside; }
  Node_constraint outside_handle() const { return static_cast<Node_constraint>(size()); }

  const std::vector<Similarity>& transforms() const { return m_transforms; }
  /// Returns the centroid of the handle's points at rest.
  const Vec3& centroid(std::size_t handle) const { return m_centroid[handle]; }
  const std::vector<Vec3>& centroids() const { return m_centroid; }
  /// Returns the targets of each handle, null for those that move by their transformation.
  const std::vector<std::shared_ptr<const Handle_targets>>& targets() const { return m_targets; }
  /// Returns the points of each handle, null for removed ones.
  const std::vector<std::shared_ptr<const Handle_points>>& points() const { return m_points; }

  /// Returns the handle of a site as set by the caller, `free_node` or `outside_region`.
  Node_constraint of_site(std::size_t site) const { return m_handle_of_site[site]; }
  bool is_soft(Node_constraint h) const
  {
    return h >= 0 && m_weight[static_cast<std::size_t>(h)] > 0;
  }
  /// Returns the exact handle that holds a site; the outside of the region counts as an exact
  /// handle.
  Node_constraint exact_handle(std::size_t site) const
  {
    const Node_constraint h = m_handle_of_site[site];
    if (h == outside_region)
      return outside_handle();
    return is_soft(h) ? free_node : h;
  }
  bool has_soft_handles() const
  {
    return std::find_if(m_weight.begin(), m_weight.end(), [](double w) { return w > 0; }) !=
           m_weight.end();
  }

  /// Returns the softness weights of all handles, including the outside of the region.
  std::vector<double> softness_weights() const
  {
    std::vector<double> weights = m_weight;
    if (m_has_outside)
      weights.push_back(0);
    return weights;
  }

  /// Returns for each component whether a handle holds points of it.
  std::vector<char> reached_components(std::size_t number_of_components) const
  {
    std::vector<char> is_reached(number_of_components, 0);
    for (const auto& points : m_points)
      if (points)
        for (const auto component : points->components)
          is_reached[component] = 1;
    return is_reached;
  }

  /// Adds a handle at rest. \param weight 0: exact; positive: soft, see
  /// `Node_constraints`
  template <class ConcurrencyTag>
  std::size_t add(const Sampled_body<ConcurrencyTag>& body,
                  const std::vector<std::uint32_t>& indices,
                  double weight,
                  const char* function)
  {
    if (indices.empty())
      throw Invalid_input(std::string(function) + ": a handle needs at least one point");
    for (const auto i : indices) {
      const Node_constraint h = m_handle_of_site[body.site_of_input[i]];
      if (h == outside_region)
        throw Invalid_input(std::string(function) + ": point " + std::to_string(i) +
                            " of the handle (or another one at the same place) is outside the "
                            "region of interest");
      if (h >= 0)
        throw Invalid_input(std::string(function) + ": point " + std::to_string(i) +
                            " (or another one at the same place) belongs to handle " +
                            std::to_string(h) + " already; a point has one target");
    }
    const std::size_t handle = m_next;
    auto points = std::make_shared<Handle_points>();
    std::vector<char> is_reached(body.number_of_components(), 0);
    Vec3 sum = Vec3::Zero(); // of the sites, each counted once
    for (const auto i : indices) {
      const std::size_t site = body.site_of_input[i];
      if (m_handle_of_site[site] == static_cast<Node_constraint>(handle))
        continue; // another point at the same place
      m_handle_of_site[site] = static_cast<Node_constraint>(handle);
      is_reached[body.component_of_site[site]] = 1;
      sum += body.rest_of_site(site);
      points->sites.push_back(static_cast<std::uint32_t>(site));
    }
    for (std::size_t c = 0; c < is_reached.size(); ++c)
      if (is_reached[c])
        points->components.push_back(static_cast<std::uint32_t>(c));
    points->weight = weight;
    if (points->sites.size() < indices.size())
      number_points(body, indices, *points);
    resize(handle + 1); // numbers of handles that `restore()` removed count as removed handles
    m_weight[handle] = weight;
    m_centroid[handle] = body.frame.to_world(sum / static_cast<double>(points->sites.size()));
    m_points[handle] = std::move(points);
    return m_next++;
  }

  /// Frees the points of a handle.
  void remove(std::size_t handle)
  {
    hold_sites(*m_points[handle], free_node);
    m_points[handle].reset();
    m_weight[handle] = 0;
    m_transforms[handle] = Similarity();
    m_targets[handle].reset();
  }

  /// Replaces the targets of the handle. Throws `Invalid_input` if double precision cannot
  /// represent the motion and the cloud together.
  void set_transform(const Local_frame& frame, std::size_t handle, const Similarity& transform)
  {
    check_transform(frame, handle, transform);
    m_transforms[handle] = transform;
    m_targets[handle].reset();
  }

  /// Sets the targets of the handle, and the rigid motion that fits them best. Throws
  /// `Invalid_input`, and changes nothing, like `set_transform()`.
  void set_targets(const Local_frame& frame,
                   std::size_t handle,
                   const Similarity& transform,
                   std::shared_ptr<const Handle_targets> targets)
  {
    check_transform(frame, handle, transform);
    m_transforms[handle] = transform;
    m_targets[handle] = std::move(targets);
  }

  /// Restores earlier handles, with the results of `points()`, `centroids()`, `transforms()` and
  /// `targets()`. Only the points of handles that were added or removed since then are visited.
  void restore(std::vector<std::shared_ptr<const Handle_points>> points,
               std::vector<Vec3> centroids,
               std::vector<Similarity> transforms,
               std::vector<std::shared_ptr<const Handle_targets>> targets)
  {
    std::vector<double> weights;
    for (const auto& p : points)
      weights.push_back(p ? p->weight : 0);
    const auto visit_different = [&](const auto& from, const auto& to, const auto& visit) {
      for (std::size_t h = 0; h < from.size(); ++h)
        if (from[h] && (h >= to.size() || to[h] != from[h]))
          visit(*from[h], static_cast<Node_constraint>(h));
    };
    visit_different(m_points, points, [&](const Handle_points& p, Node_constraint) {
      hold_sites(p, free_node);
    });
    visit_different(points, m_points, [&](const Handle_points& p, Node_constraint h) {
      hold_sites(p, h);
    });
    m_points = std::move(points);
    m_centroid = std::move(centroids);
    m_transforms = std::move(transforms);
    m_targets = std::move(targets);
    m_weight = std::move(weights);
  }

  void put_at_rest()
  {
    m_transforms.assign(size(), Similarity());
    m_targets.assign(size(), nullptr);
  }

  /// Converts the transformations to local coordinates: `x -> sR x + (sR c + t - c) / unit`, with
  /// the origin `c`. The outside of the region is last.
  void local_transforms(const Local_frame& frame, std::vector<Similarity>& local) const
  {
    local.clear();
    for (const Similarity& t : m_transforms) {
      Similarity linear = Similarity::from_scale(t.scale());
      for (const auto& turn : t.turns())
        linear = Similarity::from_turn(turn) * linear;
      const Vec3& c = frame.origin;
      const Vec3 offset = (linear(c) - c) + t.translation();
      local.push_back(Similarity::from_translation(offset / frame.unit) * linear);
    }
    if (m_has_outside)
      local.emplace_back();
  }

  /// Recomputes the centroids for a new rest shape.
  template <class ConcurrencyTag>
  void update_centroids(const Sampled_body<ConcurrencyTag>& body)
  {
    std::vector<Vec3> sum(size(), Vec3::Zero());
    std::vector<double> count(size(), 0);
    for (std::size_t site = 0; site < m_handle_of_site.size(); ++site) {
      const Node_constraint h = m_handle_of_site[site];
      if (h < 0)
        continue;
      sum[static_cast<std::size_t>(h)] += body.rest_of_site(site);
      count[static_cast<std::size_t>(h)] += 1;
    }
    for (std::size_t h = 0; h < size(); ++h)
      if (count[h] > 0)
        m_centroid[h] = body.frame.to_world(sum[h] / count[h]);
  }

private:
  static bool is_used(const std::shared_ptr<const Handle_points>& points)
  {
    return points != nullptr;
  }

  /// Throws `Invalid_input` if double precision cannot represent the motion and the cloud together.
  static void
  check_transform(const Local_frame& frame, std::size_t handle, const Similarity& transform)
  {
    const double distance = (transform(frame.origin) - frame.origin).norm() / frame.unit;
    if (!transform.is_finite() || !(distance < largest_motion) ||
        !(transform.scale() < largest_motion && transform.scale() > 1 / largest_motion))
      throw Invalid_input("pcs deformation: the motion of handle " + std::to_string(handle) +
                          " has scale " + pcs::internal::to_text(transform.scale()) +
                          " and takes the cloud " + pcs::internal::to_text(distance) +
                          " times its extent away; both must be less than " +
                          pcs::internal::to_text(largest_motion));
  }

  /// Sets `place_of_point`.
  template <class ConcurrencyTag>
  static void number_points(const Sampled_body<ConcurrencyTag>& body,
                            const std::vector<std::uint32_t>& indices,
                            Handle_points& points)
  {
    std::unordered_map<std::uint32_t, std::uint32_t> place_of_site; // never iterated over
    for (std::size_t k = 0; k < points.sites.size(); ++k)
      place_of_site.emplace(points.sites[k], static_cast<std::uint32_t>(k));
    for (const auto i : indices)
      points.place_of_point.push_back(place_of_site.at(body.site_of_input[i]));
  }

  void hold_sites(const Handle_points& points, Node_constraint handle)
  {
    for (const auto site : points.sites)
      m_handle_of_site[site] = handle;
  }

  void resize(std::size_t count)
  {
    m_transforms.resize(count);
    m_weight.resize(count, 0);
    m_centroid.resize(count, Vec3::Zero());
    m_points.resize(count);
    m_targets.resize(count);
  }

  std::vector<Node_constraint> m_handle_of_site;
  bool m_has_outside = false;
  std::size_t m_next = 0; ///< number of the next handle; larger than all that were given before
  // one for each handle
  std::vector<Similarity> m_transforms;
  std::vector<double> m_weight; ///< 0: exact
  std::vector<Vec3> m_centroid;
  std::vector<std::shared_ptr<const Handle_points>> m_points; ///< null for a removed handle
  std::vector<std::shared_ptr<const Handle_targets>> m_targets;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_HANDLE_SET_H

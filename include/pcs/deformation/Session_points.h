// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of an editing session, and points around them, in the current shape.

#ifndef PCS_DEFORMATION_SESSION_POINTS_H
#define PCS_DEFORMATION_SESSION_POINTS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/Session_state.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/upsampling/Point_carrier.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/deformation/upsampling/read_maps.h>

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

/// Whether a handle has targets in the current shape.
template <class Tag>
bool has_shape_targets(const Session_state<Tag>& s, std::size_t handle)
{
  return handle < s.shape_targets.size() && s.shape_targets[handle] != nullptr;
}

// ---- points of the session

template <class Tag>
const std::vector<char>& find_written_handles(Session_state<Tag>& s)
{
  const auto has_targets = [&](std::size_t h) { return has_shape_targets(s, h); };
  return s.dirty_handles.find(s.local_transforms,
                              has_targets,
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
          s.local_transforms.empty() ? Upsampling::Fades() : s.fades.of_blocks(),
          s.corrections.empty() ? nullptr : &s.corrections,
          s.body.site_of_place.data()};
}

/// Returns the gradient of a point that a handle holds in the current shape.
template <class Tag>
Eigen::Matrix3d gradient_of_handle(const Session_state<Tag>& s, Node_constraint h, std::size_t site)
{
  const Similarity& t = s.local_transforms[static_cast<std::size_t>(h)];
  Eigen::Matrix3d gradient = t.scale() * t.rotation();
  Vec3 position = Vec3::Zero(), normal = Vec3::Zero(); // not used
  s.corrections.apply(site, s.body.frame, position, normal, gradient);
  return gradient;
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
                                          s.fades.of_blocks(),
                                          s.corrections.empty() ? nullptr : &s.corrections,
                                          s.body.site_of_place.data()};
  return s.upsampling.gradient(place, s.body.rest_points, motions);
}

// ---- points outside the session

template <class Tag>
void carry_with_handle(const Session_state<Tag>& s,
                       Node_constraint h,
                       std::size_t site,
                       const Vec3& local,
                       Vec3& point,
                       Vec3& normal,
                       Eigen::Matrix3d& gradient)
{
  const Similarity& t = s.local_transforms[static_cast<std::size_t>(h)];
  if (t.is_identity() && !has_shape_targets(s, static_cast<std::size_t>(h)))
    return;
  point = s.body.frame.to_world(t(local));
  normal = t.rotation() * normal;
  gradient = t.scale() * t.rotation();
  const Vec3 step = local - s.body.rest_of_site(site);
  s.corrections.apply_near(site, step, s.body.frame, point, normal, gradient);
}

/// Returns the map of a point whose nearest site is `site`, which is free or an outlier.
template <class Tag>
Affine_map map_near_site(const Session_state<Tag>& s, std::size_t site, const Vec3& local)
{
  if (s.sites[site] == outlier_site)
    return s.outlier_maps.of_site(s.body, site);
  return s.carrier->map_at(local, site, s.maps);
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
  if (s.sites[site] != outlier_site) {
    const Vec3 step = local - s.body.rest_of_site(site);
    s.corrections.apply_near(site, step, s.body.frame, point, normal, gradient);
  }
}

template <class Tag>
std::vector<Vec3> rest_of_samples(const Session_state<Tag>& s)
{
  const std::vector<Vec3>& rest = s.body.network.rest;
  return {rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(s.body.number_of_samples())};
}

template <class Tag>
void build_carrier(Session_state<Tag>& s)
{
  std::vector<Vec3> sites(s.body.number_of_sites());
  for (std::size_t place = 0; place < s.body.number_of_points(); ++place)
    sites[s.body.site_of_place[place]] = s.body.rest_of_place(place);
  s.carrier = std::make_unique<Point_carrier>(std::move(sites),
                                              rest_of_samples(s),
                                              s.body.sample_of_site,
                                              uncut_surface(s.body.network, s.cut),
                                              s.body.options.number_of_sample_neighbors,
                                              s.body.options.sample_weights);
}

} // namespace internal

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SESSION_POINTS_H

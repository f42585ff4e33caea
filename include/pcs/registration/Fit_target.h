// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The target of a registration, and evenly spread subsets of clouds.

#ifndef PCS_REGISTRATION_FIT_TARGET_H
#define PCS_REGISTRATION_FIT_TARGET_H

#include <pcs/deformation/body/octree_samples.h>
#include <pcs/neighborhood/spatial_order.h>
#include <pcs/registration/Surface_points.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace registration {

/// Number of points of each cloud that are compared in the soft stages. [count]
constexpr std::size_t number_of_soft_points = 800;

/// Returns the indices of about `count` points that are spread evenly, without points at the place
/// of another one. O(n log n).
template <class ConcurrencyTag>
std::vector<std::uint32_t> spread_points(const std::vector<Vec3>& points, std::size_t count)
{
  std::vector<Vec3> ordered;
  std::vector<std::uint32_t> kept;
  for (const std::uint32_t i : neighborhood::spatial_order<ConcurrencyTag>(points))
    if (ordered.empty() || ordered.back() != points[i]) {
      ordered.push_back(points[i]);
      kept.push_back(i);
    }
  if (count >= kept.size())
    return kept;
  std::vector<std::uint32_t> result;
  for (const auto s : deformation::octree_samples(ordered, count))
    result.push_back(kept[s]);
  return result;
}

/// The target in the local coordinates of the source.
struct Fit_target
{
  Surface_points all;               ///< without points at the place of another one
  std::vector<std::uint32_t> input; ///< index of each of them in the caller's range
  std::vector<Vec3> soft;           ///< positions for the soft stages
  std::vector<Vec3> fine;           ///< positions that look for source points in the last stage
  std::vector<Vec3> fine_normals;   ///< their normals

  /// \param normals one for each point, or empty
  /// \param number_of_fine_points largest size of `fine`
  template <class ConcurrencyTag>
  void build(const std::vector<Vec3>& points,
             const std::vector<Vec3>& normals,
             std::size_t number_of_fine_points)
  {
    keep<ConcurrencyTag>(spread_points<ConcurrencyTag>(points, points.size()), points, normals);
    const std::vector<std::uint32_t> of_surface = all.template points_of_surface<ConcurrencyTag>();
    constexpr double least_share = 0.5; // otherwise, the cloud is no surface
    if (of_surface.size() < all.size() &&
        static_cast<double>(of_surface.size()) >= least_share * static_cast<double>(all.size())) {
      std::vector<std::uint32_t> kept;
      for (const auto i : of_surface)
        kept.push_back(input[i]);
      keep<ConcurrencyTag>(std::move(kept), points, normals);
    }
    for (const auto i : spread_points<ConcurrencyTag>(all.points(), number_of_soft_points))
      soft.push_back(all.points()[i]);
    for (const auto i : spread_points<ConcurrencyTag>(all.points(), number_of_fine_points)) {
      fine.push_back(all.points()[i]);
      fine_normals.push_back(all.normals()[i]);
    }
  }

private:
  template <class ConcurrencyTag>
  void keep(std::vector<std::uint32_t> indices,
            const std::vector<Vec3>& points,
            const std::vector<Vec3>& normals)
  {
    input = std::move(indices);
    std::vector<Vec3> kept, kept_normals;
    for (const auto i : input) {
      kept.push_back(points[i]);
      if (!normals.empty())
        kept_normals.push_back(normals[i]);
    }
    all.template build<ConcurrencyTag>(std::move(kept), std::move(kept_normals));
  }
};

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_FIT_TARGET_H

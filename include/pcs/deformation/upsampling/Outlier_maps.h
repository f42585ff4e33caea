// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Maps of outliers: similarities that follow the sample an outlier is attached to.

#ifndef PCS_DEFORMATION_UPSAMPLING_OUTLIER_MAPS_H
#define PCS_DEFORMATION_UPSAMPLING_OUTLIER_MAPS_H

#include <pcs/core/rotations.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// Map of each outlier: the similarity nearest to the map of the sample to which it is attached. A
/// stretch would move distant outliers too far.
class Outlier_maps
{
public:
  template <class ConcurrencyTag>
  void read(const Sampled_body<ConcurrencyTag>& body, const std::vector<Affine_map>& maps)
  {
    if (!body.is_sampled)
      return;
    m_maps.resize(body.outliers.size());
    pcs::internal::for_each_index<ConcurrencyTag>(m_maps.size(), [&](std::size_t o) {
      const std::size_t s = body.sample_of_site[body.outliers[o].point];
      if (s == no_sample)
        return;
      const Affine_map& map = maps[s];
      const Eigen::Matrix3d a = Eigen::Map<const Row_major_matrix>(map.a);
      const Vec3 center = body.network.rest[s];
      const Eigen::Matrix3d similarity = std::cbrt(std::abs(a.determinant())) * nearest_rotation(a);
      Eigen::Map<Row_major_matrix>(m_maps[o].a) = similarity;
      Eigen::Map<Vec3>(m_maps[o].t) =
          a * center + Eigen::Map<const Vec3>(map.t) - similarity * center;
    });
  }

  /// Returns the map of a site that is an outlier of the body.
  template <class ConcurrencyTag>
  const Affine_map& of_site(const Sampled_body<ConcurrencyTag>& body, std::size_t site) const
  {
    const auto o =
        std::lower_bound(body.outliers.begin(),
                         body.outliers.end(),
                         site,
                         [](const neighborhood::Outlier& a, std::size_t s) { return a.point < s; });
    return m_maps[static_cast<std::size_t>(o - body.outliers.begin())];
  }

private:
  std::vector<Affine_map> m_maps;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_OUTLIER_MAPS_H

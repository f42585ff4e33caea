// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The affine maps of the samples, from the solved network, and of the handles.

#ifndef PCS_DEFORMATION_READ_MAPS_H
#define PCS_DEFORMATION_READ_MAPS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/Elastic_state.h>
#include <pcs/deformation/affine_maps.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// The deformation gradient of every sample, which carries stretch as well, about its new position. The samples are the
/// first nodes of the network.
/// \param transforms of the handles, in the coordinates of the network
/// \param rest of the samples [L]
/// \param maps one for each sample
/// \param are_finite room to work in
/// \return whether all of them are finite
template <class ConcurrencyTag>
bool read_maps(const Elastic_state& state,
               const std::vector<Similarity>& transforms,
               const std::vector<Vec3>& rest,
               std::vector<Affine_map>& maps,
               std::vector<int>& are_finite)
{
  const int is_finite = pcs::internal::blocked_reduce<ConcurrencyTag>(
      maps.size(),
      1,
      [&](std::size_t s) {
        const Node_constraint h = state.constraints.handle_of_node[s];
        if (h == unreached_node) {
          maps[s] = identity_map();
          return 1;
        }
        const bool is_rigid = state.constraints.is_prescribed(s);
        const Eigen::Matrix3d a = is_rigid ? state.frame[s] : state.deformation_gradient(s);
        // A prescribed map is the handle's own, to the last bit.
        const Vec3 t = is_rigid ? transforms[static_cast<std::size_t>(h)].translation()
                                : Vec3(state.position[s] - a * rest[s]);
        Eigen::Map<Row_major_matrix>(maps[s].a) = a;
        Eigen::Map<Vec3>(maps[s].t) = t;
        return a.allFinite() && t.allFinite() ? 1 : 0;
      },
      [](int one, int other) { return one & other; },
      512,
      are_finite);
  return is_finite == 1;
}

/// Of the handles, in the coordinates of their transformations.
inline void read_handle_maps(const std::vector<Similarity>& transforms,
                             std::vector<Handle_map>& maps)
{
  maps.resize(transforms.size());
  for (std::size_t h = 0; h < transforms.size(); ++h) {
    const Eigen::Matrix3d turn = transforms[h].rotation();
    Eigen::Map<Row_major_matrix>(maps[h].turn) = turn;
    Eigen::Map<Row_major_matrix>(maps[h].map.a) = transforms[h].scale() * turn;
    Eigen::Map<Vec3>(maps[h].map.t) = transforms[h].translation();
  }
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_READ_MAPS_H

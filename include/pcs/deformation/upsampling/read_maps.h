// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Affine maps of samples from the solved network, and of handles.

#ifndef PCS_DEFORMATION_UPSAMPLING_READ_MAPS_H
#define PCS_DEFORMATION_UPSAMPLING_READ_MAPS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/solver/Elastic_state.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/// Whether a sample has another sample as a neighbour. Nodes on the borders of handles may be too
/// near to measure a stretch from them alone. The samples are the first nodes.
inline bool
has_sample_beside(const Weighted_graph& graph, std::size_t sample, std::size_t number_of_samples)
{
  return std::any_of(graph.begin(sample), graph.end(sample), [&](std::uint32_t other) {
    return other < number_of_samples;
  });
}

/// Computes the affine map of every sample from its deformation gradient, which includes stretch,
/// and its new position. For samples without adjacent samples, the frame replaces the gradient. The
/// samples are the first nodes of the network.
/// \param transforms of the handles, in the coordinates of the network
/// \param targets offsets of the nodes of handles with targets; may be empty
/// \param rest of the nodes [L]
/// \param count of the samples
/// \param maps one for each sample, or empty before the call
/// \param next memory for as many maps, or empty to save it: then every map is computed twice
/// \param are_finite workspace
/// \return whether all maps are finite; otherwise, `maps` is unchanged
template <class ConcurrencyTag>
bool read_maps(const Elastic_state& state,
               const std::vector<Similarity>& transforms,
               const Node_targets& targets,
               const std::vector<Vec3>& rest,
               std::size_t count,
               std::vector<Affine_map>& maps,
               std::vector<Affine_map>& next,
               std::vector<int>& are_finite)
{
  const auto read = [&](std::size_t s, Affine_map& map) {
    const Node_constraint h = state.constraints.handle_of_node[s];
    if (h == unreached_node) {
      map = identity_map();
      return 1;
    }
    const bool is_rigid = state.constraints.is_prescribed(s);
    const bool is_measured = !is_rigid && has_sample_beside(state.network.surface, s, count);
    Eigen::Matrix3d a = is_measured ? state.deformation_gradient(s) : state.frame[s];
    // A prescribed map is bitwise that of the handle, unless this has targets.
    Vec3 t;
    if (is_rigid && !targets.is_offset(s))
      t = transforms[static_cast<std::size_t>(h)].translation();
    else {
      if (is_rigid)
        a = targets.linear(transforms[static_cast<std::size_t>(h)], s);
      t = state.position[s] - a * rest[s];
    }
    Eigen::Map<Row_major_matrix>(map.a) = a;
    Eigen::Map<Vec3>(map.t) = t;
    return a.allFinite() && t.allFinite() ? 1 : 0;
  };
  const int is_finite = pcs::internal::blocked_reduce<ConcurrencyTag>(
      count,
      1,
      [&](std::size_t s) {
        Affine_map map;
        return read(s, next.empty() ? map : next[s]);
      },
      [](int one, int other) { return one & other; },
      512,
      are_finite);
  if (is_finite != 1)
    return false;
  if (next.empty()) {
    maps.resize(count);
    pcs::internal::for_each_index<ConcurrencyTag>(maps.size(),
                                                  [&](std::size_t s) { read(s, maps[s]); });
  } else
    maps.swap(next);
  return true;
}

/// Writes the maps of the handles, in the coordinates of their transformations.
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

#endif // PCS_DEFORMATION_UPSAMPLING_READ_MAPS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The source cloud as a deformable shape: samples with positions and rotations that carry points.

#ifndef PCS_REGISTRATION_DEFORMABLE_SHAPE_H
#define PCS_REGISTRATION_DEFORMABLE_SHAPE_H

#include <pcs/core/rotations.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/registration/Fit_options.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace registration {

using Vec3 = Eigen::Vector3d;

/// The samples that carry a point, with weights that sum to one.
struct Carriers
{
  std::size_t count = 0;
  std::uint32_t node[carriers_of_point];
  double weight[carriers_of_point];
};

/// Positions, rotations and stretches of the samples.
struct Shape_state
{
  std::vector<Vec3> position;            ///< [L]
  std::vector<Eigen::Matrix3d> rotation; ///< from rest [-]
  std::vector<Eigen::Matrix3d> stretch;  ///< symmetric, before the rotation [-]
};

/*!
  A point `p` at rest moves to `sum_k b_k (x_k + R_k S_k (p - x0_k))` (Sumner, Schmid and Pauly
  2007), with the positions at rest `x0_k`, the positions `x_k`, the rotations `R_k` and the
  stretches `S_k` of the samples.
*/
struct Deformable_shape
{
  const deformation::Elastic_network* network = nullptr;
  double spacing = 0; ///< typical length of an edge [L]
  Shape_state state;

  void start(const deformation::Elastic_network& n)
  {
    network = &n;
    spacing = deformation::typical_edge(n.rest, n.surface);
    state.position = n.rest;
    state.rotation.assign(n.size(), Eigen::Matrix3d::Identity());
    state.stretch.assign(n.size(), Eigen::Matrix3d::Identity());
  }

  Vec3 move(const Vec3& rest, const Carriers& carriers) const
  {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < carriers.count; ++k) {
      const std::uint32_t s = carriers.node[k];
      sum +=
          carriers.weight[k] *
          (state.position[s] + state.rotation[s] * (state.stretch[s] * (rest - network->rest[s])));
    }
    return sum;
  }

  /// Returns the linear part of the map of a point. [-]
  Eigen::Matrix3d linear(const Carriers& carriers) const
  {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < carriers.count; ++k)
      sum +=
          carriers.weight[k] * (state.rotation[carriers.node[k]] * state.stretch[carriers.node[k]]);
    return sum;
  }

  /// Applies a rigid motion to the current state.
  void transform(const Eigen::Matrix3d& r, const Vec3& t)
  {
    for (Vec3& x : state.position)
      x = r * x + t;
    for (Eigen::Matrix3d& q : state.rotation)
      q = r * q;
  }
};

/// Returns the carriers of a site.
template <class ConcurrencyTag>
Carriers carriers_of_site(const deformation::Sampled_body<ConcurrencyTag>& body, std::size_t site)
{
  Carriers result;
  const auto add = [&](std::uint32_t node, double weight) {
    result.node[result.count] = node;
    result.weight[result.count++] = weight;
  };
  if (!body.is_sampled)
    add(static_cast<std::uint32_t>(site), 1);
  else {
    const auto& links = body.links_of_site;
    for (std::size_t k = 0; k < links.k && k < carriers_of_point; ++k)
      if (links.weight[site * links.k + k] > 0)
        add(links.sample[site * links.k + k],
            static_cast<double>(links.weight[site * links.k + k]));
  }
  return result;
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_DEFORMABLE_SHAPE_H

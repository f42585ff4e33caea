// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Per-node state of an elastic network: right-hand sides, energies and best maps.

#ifndef PCS_DEFORMATION_SOLVER_ELASTIC_STATE_H
#define PCS_DEFORMATION_SOLVER_ELASTIC_STATE_H

#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/solver/measure_edges.h>
#include <pcs/linear_algebra/small_symmetric.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace deformation {

/// Targets of the links between handles with targets and other nodes, by half-edge. Such a link
/// would otherwise resist the stretch of the handle, which is given.
struct Link_targets
{
  std::vector<Vec3> shift;    ///< added to the turned link; empty without targets [L]
  std::vector<double> length; ///< instead of the length at rest; negative for other links [L]
};

/// View of a network with the current positions of its nodes and the targets of its edges.
struct Elastic_state
{
  const Elastic_network& network;
  const Node_constraints& constraints;
  const std::vector<Vec3>& position; ///< [L]
  /// `R_i A_i`: the rotation after the growth. [-]
  const std::vector<Eigen::Matrix3d>& frame;
  /// The frame times the transverse stretch of the material. [-]
  const std::vector<Eigen::Matrix3d>& target;
  /// Growth of edges between scaled handles, `A_i`; empty if no handle is scaled. [-]
  const std::vector<Eigen::Matrix3d>& growth;
  const Link_targets& link_targets;
  /// Transverse stretch of the material, from which `target` was computed; empty if Poisson's ratio
  /// is zero. Links through the interior change their lengths with it. [-]
  const std::vector<Eigen::Matrix3d>& stretch;

  /// Weight of the frame in `deformation_gradient()`, relative to the spread of the edges. The
  /// frame determines the gradient along the surface normal, where there are no edges. [-]
  static constexpr double frame_share = 0.05;
  /// Shortest edges, relative to the coordinates, that are long enough against rounding to measure
  /// a gradient. [-]
  static constexpr double shortest_measured_edge = 1e-10;

  /// Computes the right-hand side of node `i` from its surface edges, and returns its degree.
  /// Scalars are faster, see `newton_turn()`.
  double sum_edges(std::size_t i, Vec3& b) const
  {
    const auto& graph = network.surface;
    const double *own = target[i].data(), *xi = network.rest[i].data();
    double degree = 0, edges[3] = {}, sum[3] = {};
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const double *other = target[j].data(), *xj = network.rest[j].data();
      const double w = graph.weight[e];
      double edge[3];
      for (int k = 0; k < 3; ++k) {
        edge[k] = w * (xi[k] - xj[k]);
        edges[k] += edge[k];
      }
      for (int k = 0; k < 3; ++k)
        sum[k] += 0.5 * (other[k] * edge[0] + other[3 + k] * edge[1] + other[6 + k] * edge[2]);
      if (constraints.is_prescribed(j))
        for (int k = 0; k < 3; ++k)
          sum[k] += w * position[j][k];
      degree += w;
    }
    for (int k = 0; k < 3; ++k)
      b[k] = sum[k] + 0.5 * (own[k] * edges[0] + own[3 + k] * edges[1] + own[6 + k] * edges[2]);
    return degree;
  }

  /// Returns the target of the link `e` from node `i` to node `j`.
  Vec3 link_target(std::size_t i, std::size_t j, std::size_t e, bool links_turn) const
  {
    if (links_turn) {
      const Vec3 edge = network.rest[i] - network.rest[j];
      const Vec3 turned = 0.5 * (target[i] * edge + target[j] * edge);
      return link_targets.shift.empty() ? turned : Vec3(turned + link_targets.shift[e]);
    }
    const Vec3 present = position[i] - position[j];
    const double length = present.norm();
    return length > 0 ? Vec3(link_length(i, j, e) / length * present) : Vec3(Vec3::Zero());
  }

  /// Input of `Measure_edges`.
  Edge_input edges() const
  {
    const auto& graph = network.surface;
    return {graph.first.data(),
            graph.neighbor.data(),
            graph.weight.data(),
            network.rest.data(),
            position.data(),
            target.data()};
  }

  double link_energy(std::size_t i) const
  {
    return link_energy(i, [](std::size_t) { return true; });
  }

  /// Returns the energy of the links from node `i` to nodes `j > i` for which `counts(j)` is true.
  template <class Counts>
  double link_energy(std::size_t i, const Counts& counts) const
  {
    const auto& links = network.links;
    double energy = 0;
    if (!links.neighbor.empty())
      for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e) {
        const std::size_t j = links.neighbor[e];
        if (j < i || !counts(j))
          continue;
        const double error = (position[i] - position[j]).norm() - link_length(i, j, e);
        energy += links.weight[e] * error * error;
      }
    return energy;
  }

  /// Returns the part of the energy that belongs to node `i` among the first `count` nodes: half of
  /// its edges and links to other such nodes, and all of its edges to further nodes.
  double energy_of_node(std::size_t i, std::size_t count) const
  {
    const auto& graph = network.surface;
    double energy = 0;
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const Vec3 edge = network.rest[j] - network.rest[i];
      const Vec3 error = position[j] - position[i] - 0.5 * (target[i] * edge + target[j] * edge);
      energy += (j < count ? 0.5 : 1) * graph.weight[e] * error.squaredNorm();
    }
    const auto& links = network.links;
    if (!links.neighbor.empty())
      for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e) {
        const std::size_t j = links.neighbor[e];
        const double error = (position[i] - position[j]).norm() - link_length(i, j, e);
        energy += 0.5 * links.weight[e] * error * error;
      }
    return energy;
  }

  /*!
    Returns the stretch at which a material with Poisson's ratio `nu` has no stress in a direction,
    if the strain across is the present one (plane stress). With the principal logarithmic strains
    `e1`, `e2` along `v1`, `v2` in the surface with the normal `n`:

        S = exp(-nu e2) v1 v1^T + exp(-nu e1) v2 v2^T + exp(-nu e) n n^T,

    where `e = (e1 + e2) / (1 - max(nu, 0))`, limited to the larger strain: the links through the
    interior would otherwise overshoot, because their compression changes `e1` and `e2`. A strain
    has no share in its own target, so that the body resists every extension.
  */
  Eigen::Matrix3d transverse_stretch(std::size_t i, double poisson_ratio) const
  {
    const Vec3 normal = surface_normal(i), u = normal.unitOrthogonal();
    Eigen::Matrix<double, 3, 2> plane;
    plane << u, normal.cross(u);
    const Eigen::Matrix3d in_rest = frame[i].inverse() * deformation_gradient(i);
    const auto eigen = linear_algebra::symmetric_eigen<2>(
        0.5 * (plane.transpose() * (in_rest + in_rest.transpose()) * plane));
    if (!(eigen.values.minCoeff() > 0) || !eigen.values.allFinite())
      return Eigen::Matrix3d::Identity();
    const auto strain = [&](int k) { // factors beyond ten indicate a torn network
      return std::log(std::min(10.0, std::max(0.1, eigen.values[k])));
    };
    const double e1 = strain(0), e2 = strain(1), largest = std::max(std::abs(e1), std::abs(e2));
    const double e = (e1 + e2) / (1 - std::max(0.0, poisson_ratio));
    const Vec3 v1 = plane * eigen.vectors.col(0), v2 = plane * eigen.vectors.col(1);
    const auto across = [&](double cause) { return std::exp(-poisson_ratio * cause); };
    return across(e2) * v1 * v1.transpose() + across(e1) * v2 * v2.transpose() +
           across(std::min(largest, std::max(-largest, e))) * normal * normal.transpose();
  }

  /// Returns the direction in which the edges at node `i` have the least spread at rest.
  Vec3 surface_normal(std::size_t i) const
  {
    const auto& graph = network.surface;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const Vec3 edge = network.rest[graph.neighbor[e]] - network.rest[i];
      spread += graph.weight[e] * edge * edge.transpose();
    }
    const double trace = spread.trace();
    if (!(trace > std::numeric_limits<double>::min()))
      return Vec3::UnitZ();
    return linear_algebra::symmetric_eigen<3>(spread / trace).vectors.col(0);
  }

  /// Returns the least-squares linear map of the edges at node `i` from rest to the current state.
  /// The frame completes it along the surface normal. [-]
  Eigen::Matrix3d deformation_gradient(std::size_t i) const
  {
    // Scalars are faster, see `newton_turn()`.
    const auto& graph = network.surface;
    const double *xi = network.rest[i].data(), *pi = position[i].data();
    double longest = 0, farthest = 0, covariance[9] = {};
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0; // the spread of the edges at rest
    for (int k = 0; k < 3; ++k)
      farthest = std::max(farthest, std::abs(pi[k]));
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const double *xj = network.rest[j].data(), *pj = position[j].data();
      double rest[3], weighted[3];
      for (int k = 0; k < 3; ++k) {
        rest[k] = xj[k] - xi[k];
        weighted[k] = graph.weight[e] * rest[k];
        longest = std::max(longest, std::abs(rest[k]));
        farthest = std::max(farthest, std::abs(pj[k]));
      }
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
          covariance[3 * c + r] += (pj[r] - pi[r]) * weighted[c];
      xx += weighted[0] * rest[0];
      yy += weighted[1] * rest[1];
      zz += weighted[2] * rest[2];
      xy += weighted[0] * rest[1];
      xz += weighted[0] * rest[2];
      yz += weighted[1] * rest[2];
    }
    const double share = frame_share * (xx + yy + zz);
    if (!(longest > shortest_measured_edge * farthest) ||
        !(share > std::numeric_limits<double>::min()))
      return frame[i];
    // Relative to the trace, so that the determinant does not vanish for short edges.
    const double unit = frame_share / share;
    xx = unit * xx + frame_share;
    yy = unit * yy + frame_share;
    zz = unit * zz + frame_share;
    xy *= unit;
    xz *= unit;
    yz *= unit;
    const double axx = yy * zz - yz * yz, axy = xz * yz - xy * zz, axz = xy * yz - xz * yy,
                 ayy = xx * zz - xz * xz, ayz = xy * xz - xx * yz, azz = xx * yy - xy * xy;
    const double inverse = 1 / (xx * axx + xy * axy + xz * axz);
    const double* own = frame[i].data();
    Eigen::Matrix3d result;
    for (int r = 0; r < 3; ++r) {
      const double x = unit * covariance[r] + frame_share * own[r],
                   y = unit * covariance[3 + r] + frame_share * own[3 + r],
                   z = unit * covariance[6 + r] + frame_share * own[6 + r];
      result(r, 0) = inverse * (x * axx + y * axy + z * axz);
      result(r, 1) = inverse * (x * axy + y * ayy + z * ayz);
      result(r, 2) = inverse * (x * axz + y * ayz + z * azz);
    }
    return result;
  }

  /// Returns the link from node `j` to node `i` at rest, after the growth. [L]
  Vec3 grown_link(std::size_t i, std::size_t j) const
  {
    const Vec3 edge = network.rest[i] - network.rest[j];
    return growth.empty() ? edge : Vec3(0.5 * (growth[i] + growth[j]) * edge);
  }

private:
  double link_length(std::size_t i, std::size_t j, std::size_t e) const
  {
    if (!link_targets.length.empty() && link_targets.length[e] >= 0)
      return link_targets.length[e];
    if (stretch.empty())
      return grown_link(i, j).norm();
    const Vec3 edge = network.rest[i] - network.rest[j];
    const Vec3 stretched = 0.5 * (stretch[i] * edge + stretch[j] * edge);
    return growth.empty() ? stretched.norm() : (0.5 * (growth[i] + growth[j]) * stretched).norm();
  }
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_ELASTIC_STATE_H

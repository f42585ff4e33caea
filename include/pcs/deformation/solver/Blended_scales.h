// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scale field: interpolated scales of the handles, and growth of edges along its gradient.

#ifndef PCS_DEFORMATION_SOLVER_BLENDED_SCALES_H
#define PCS_DEFORMATION_SOLVER_BLENDED_SCALES_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/solver/Elastic_factors.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  The logarithm of the scale is harmonic between handles. Edges perpendicular to its gradient are
  multiplied by the scale. Edges along the gradient grow by a fraction of it, as far as the
  positions of the handles permit. For example, a rod with one end scaled at a fixed position
  becomes thicker but not longer. Otherwise it would buckle. The fraction is the same for all
  bodies.
*/
template <class ConcurrencyTag>
class Blended_scales
{
public:
  /// Computes the scales for new motions of the handles, with the fraction 0.
  void begin(const Elastic_network& network,
             const Node_constraints& constraints,
             const Elastic_factors& factors,
             const std::vector<Similarity>& transforms)
  {
    const std::size_t n = network.size();
    m_growth.clear();
    m_direction.clear();
    const auto differs = [&](const Similarity& t) { return t.scale() != 1; };
    if (std::none_of(transforms.begin(), transforms.end(), differs))
      return;
    blend(network, constraints, factors, transforms);
    m_growth.resize(n);
    find_directions(network, constraints);
    set_share(0);
  }

  /// Returns the growth of the edges at every node before the rotation, a symmetric matrix; empty
  /// if no handle is scaled. [-]
  const std::vector<Eigen::Matrix3d>& growth() const { return m_growth; }

  /// Sets the fraction of the scale by which edges along its gradient grow. [-]
  void set_share(double share)
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_growth.size(),
        [&](std::size_t i) {
          const double across = std::exp(m_log_scale[i][0]);
          const double along =
              std::max(1 + share * (across - 1), least_growth * std::min(1.0, across));
          m_growth[i] = across * Eigen::Matrix3d::Identity();
          if (!m_direction[i].isZero(0))
            m_growth[i] += (along - across) * m_direction[i] * m_direction[i].transpose();
        },
        512);
  }

  /// Returns the fraction with the least energy, from the energies at 0, 1/2 and 1. The energy is
  /// quadratic in the fraction. Returns 1 if the energy is constant. [-]
  static double share_of_least_energy(double none, double half, double all)
  {
    const double curvature = 2 * (none + all) - 4 * half, slope = all - none - curvature;
    return curvature > 1e-12 * (none + all)
               ? std::min(1.0, std::max(-1.0, -0.5 * slope / curvature))
               : 1.0;
  }

private:
  using Vec1 = Eigen::Matrix<double, 1, 1>;

  /// Least difference of the logarithms of scale across an edge that defines a gradient. [-]
  static constexpr double least_difference = 1e-9;
  /// Rings of neighbours for the gradient. With one ring, its direction would scatter: bodies would
  /// become longer by a few per cent of the scale, and buckle. [count]
  static constexpr int number_of_rings = 3;
  static constexpr double normal_share = 1e-3; ///< regularises the direction of the normal [-]
  /// Least growth of an edge along the gradient, because a negative fraction could invert it. [-]
  static constexpr double least_growth = 0.25;

  /// Sums over the edges around a node.
  struct Sums
  {
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    Vec3 change = Vec3::Zero();
    double largest = 0;

    Sums& operator+=(const Sums& other)
    {
      spread += other.spread;
      change += other.change;
      largest = std::max(largest, other.largest);
      return *this;
    }
  };

  void blend(const Elastic_network& network,
             const Node_constraints& constraints,
             const Elastic_factors& factors,
             const std::vector<Similarity>& transforms)
  {
    m_log_scale.assign(network.size(), Vec1::Zero());
    const auto value = [&](std::size_t i) {
      return Vec1(
          std::log(transforms[static_cast<std::size_t>(constraints.handle_of_node[i])].scale()));
    };
    solve_harmonic<ConcurrencyTag>(
        factors.field(),
        network.surface,
        constraints,
        factors.rows(),
        value,
        [&](std::size_t i, const Vec1& u) { m_log_scale[i] = u; },
        m_work);
    for (std::size_t i = 0; i < network.size(); ++i)
      if (constraints.is_prescribed(i))
        m_log_scale[i] = value(i);
  }

  /// Finds the directions of the gradient of the logarithm of scale at rest, by least squares over
  /// rings of neighbours. A direction is null where the scale is constant.
  void find_directions(const Elastic_network& network, const Node_constraints& constraints)
  {
    const auto& graph = network.surface;
    const std::size_t n = network.size();
    m_sums.resize(n);
    pcs::internal::for_each_index<ConcurrencyTag>(
        n,
        [&](std::size_t i) {
          m_sums[i] = Sums();
          for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
            const std::size_t j = graph.neighbor[e];
            const Vec3 edge = network.rest[j] - network.rest[i];
            const double difference = m_log_scale[j][0] - m_log_scale[i][0];
            m_sums[i].spread += graph.weight[e] * edge * edge.transpose();
            m_sums[i].change += graph.weight[e] * difference * edge;
            m_sums[i].largest = std::max(m_sums[i].largest, std::abs(difference));
          }
        },
        512);
    for (int ring = 1; ring < number_of_rings; ++ring) {
      m_next_sums.resize(n);
      pcs::internal::for_each_index<ConcurrencyTag>(
          n,
          [&](std::size_t i) {
            Sums sums = m_sums[i];
            for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
              sums += m_sums[graph.neighbor[e]];
            m_next_sums[i] = sums;
          },
          512);
      m_sums.swap(m_next_sums);
    }
    m_direction.assign(n, Vec3::Zero());
    pcs::internal::for_each_index<ConcurrencyTag>(
        n,
        [&](std::size_t i) {
          const Sums& sums = m_sums[i];
          const double trace = sums.spread.trace();
          if (constraints.is_prescribed(i) || !(sums.largest > least_difference) || !(trace > 0))
            return;
          const Vec3 gradient =
              (sums.spread / trace + normal_share * Eigen::Matrix3d::Identity()).inverse() *
              (sums.change / trace);
          const double norm = gradient.norm();
          if (norm > 0 && std::isfinite(norm))
            m_direction[i] = gradient / norm;
        },
        512);
  }

  std::vector<Vec1> m_log_scale, m_work;
  std::vector<Sums> m_sums, m_next_sums;
  std::vector<Vec3> m_direction; ///< of the gradient at rest, or null
  std::vector<Eigen::Matrix3d> m_growth;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_BLENDED_SCALES_H

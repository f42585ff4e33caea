// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Smooth stretch of a shape, by which lengths at rest are corrected.

#ifndef PCS_REGISTRATION_STRETCH_FIELD_H
#define PCS_REGISTRATION_STRETCH_FIELD_H

#include <pcs/core/rotations.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/Sparse_cholesky.h>
#include <pcs/registration/Deformable_shape.h>
#include <pcs/registration/Elastic_edges.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace registration {

/*!
  Real deformations stretch: a bent body is longer outside than inside. An energy of stretch alone
  would resist this, and shift points along the surface. The stretch `S_i` of a sample is therefore
  measured, smoothed, and taken as given: the edge `e_ij` at rest becomes `(S_i + S_j)/2 e_ij`. Only
  stretches that vary quickly are resisted. The smoothed field minimises

      sum_i (|S_i - M_i|^2 + k |S_i - I|^2) + l^2 sum_{edges ij} w_ij |S_i - S_j|^2 / h^2

  for measured stretches `M_i`, a resistance `k` [-], a smoothing length `l` [L], and the typical
  edge length `h` [L].
*/
class Stretch_field
{
public:
  /// Factorises. Returns `false` if this failed.
  bool start(const Deformable_shape& shape,
             const std::vector<Elastic_edge>& edges,
             double smoothing_length,
             double resistance)
  {
    const std::size_t n = shape.network->size();
    m_resistance = resistance;
    const double c = std::pow(smoothing_length / shape.spacing, 2);
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> diagonal(n, 1 + resistance);
    for (const Elastic_edge& e : edges) {
      entries.emplace_back(static_cast<int>(e.j), static_cast<int>(e.i), -c * e.weight);
      diagonal[e.i] += c * e.weight;
      diagonal[e.j] += c * e.weight;
    }
    for (std::size_t i = 0; i < n; ++i)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), diagonal[i]);
    Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    matrix.setFromTriplets(entries.begin(), entries.end());
    return m_factor.factorize(matrix);
  }

  /// Sets the stretch of the current shape.
  template <class ConcurrencyTag>
  void update(Deformable_shape& shape)
  {
    const std::size_t n = shape.network->size();
    m_rows.resize(n);
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
      const Eigen::Matrix3d s = measure(shape, i) + m_resistance * Eigen::Matrix3d::Identity();
      m_rows[i] << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(0, 2), s(1, 2);
    });
    m_factor.template solve<ConcurrencyTag>(m_rows, m_work);
    for (std::size_t i = 0; i < n; ++i) {
      const Row& s = m_rows[i];
      shape.state.stretch[i] << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
    }
  }

private:
  using Row = Eigen::Matrix<double, 6, 1>;

  /// Weight of the present rotation where there are no edges, along the normal. [-]
  static constexpr double frame_share = 0.05;

  /// Returns the symmetric part of the deformation gradient, in coordinates at rest.
  static Eigen::Matrix3d measure(const Deformable_shape& shape, std::size_t i)
  {
    const auto& graph = shape.network->surface;
    const auto& rest = shape.network->rest;
    Eigen::Matrix3d ee = Eigen::Matrix3d::Zero(), xe = Eigen::Matrix3d::Zero();
    for (std::size_t k = graph.first[i]; k < graph.first[i + 1]; ++k) {
      const std::size_t j = graph.neighbor[k];
      const Vec3 edge = rest[j] - rest[i];
      ee += graph.weight[k] * edge * edge.transpose();
      xe +=
          graph.weight[k] * (shape.state.position[j] - shape.state.position[i]) * edge.transpose();
    }
    const double share = frame_share * ee.trace();
    if (!(share > 0))
      return Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d& r = shape.state.rotation[i];
    const Eigen::Matrix3d gradient =
        (xe + share * r) * (ee + share * Eigen::Matrix3d::Identity()).inverse();
    const Eigen::Matrix3d in_rest = r.transpose() * gradient;
    Eigen::Matrix3d s = 0.5 * (in_rest + in_rest.transpose());
    constexpr double largest = 2; // beyond, matches are wrong
    for (int k = 0; k < 9; ++k)
      s.data()[k] = std::min(largest, std::max(-largest, s.data()[k]));
    return s;
  }

  double m_resistance = 0;
  linear_algebra::Sparse_cholesky m_factor;
  std::vector<Row> m_rows, m_work;
};

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_STRETCH_FIELD_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Gauss-Newton steps on the positions and rotations of the samples.

#ifndef PCS_REGISTRATION_GAUSS_NEWTON_H
#define PCS_REGISTRATION_GAUSS_NEWTON_H

#include <pcs/core/rotations.h>
#include <pcs/linear_algebra/Sparse_cholesky.h>
#include <pcs/registration/Deformable_shape.h>
#include <pcs/registration/Elastic_edges.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace registration {

/// A point of the source that is attracted: the quadratic form `A` and the sum of `A (y - x)` over
/// its matches.
struct Attraction
{
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero(); ///< [-]
  Vec3 pull = Vec3::Zero();                    ///< [L]
};

/// A point of the source that takes part in the fit.
struct Carried_point
{
  Vec3 rest;
  Carriers carriers;
};

inline Eigen::Matrix3d cross_matrix(const Vec3& v)
{
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Weights of the terms of the energy.
struct Energy_weights
{
  double bending = 1; ///< of differences of rotations [-]
  double data = 1;    ///< of all matches [-]
  double damping = 0; ///< of changes of rotations, relative to the edges [-]
};

/*!
  Minimises, by Gauss-Newton steps on positions `x_i` and rotations `R_i` of the samples,

      E = sum_{edges ij} w_ij |(x_j - x_i) - (R_i + R_j)/2 e_ij|^2             stretching
        + bending sum_{edges ij} w_ij |(R_i - R_j)/2|^2 |e_ij|^2               bending
        + sum_{springs ij} w_ij (|x_j - x_i| - |e_ij|)^2                       volume
        + data sum_p (y_p - x_p)^T A_p (y_p - x_p)                             matches     [L^2],

  with `e_ij = (S_i + S_j)/2 (x0_j - x0_i)` and given stretches `S_i` (Stretch_field.h). The first
  and the third term are the energy of `deform_point_set()` (Elastic_solver.h). With `bending = 1`,
  the first two are those of Sorkine and Alexa 2007 with rotations as unknowns, as in Sumner, Schmid
  and Pauly 2007. Unknowns of a sample: its displacement and its rotation vector.
*/
class Gauss_newton
{
public:
  /// Chooses the sparsity pattern. The points may not change afterwards.
  void start(const Deformable_shape& shape, Elastic_edges edges, std::vector<Carried_point> points)
  {
    m_edges = std::move(edges);
    m_points = std::move(points);
    m_size = shape.network->size();
    find_blocks();
    m_gradient.assign(m_size, Vec6::Zero());
    m_is_ordered = false;
  }

  const std::vector<Carried_point>& points() const { return m_points; }

  const Elastic_edges& edges() const { return m_edges; }

  /// Makes one step. Returns the root mean square step of the samples [L], or a negative number if
  /// the matrix is singular; then nothing is changed.
  template <class ConcurrencyTag>
  double step(const std::vector<Attraction>& attractions,
              const Energy_weights& weights,
              Deformable_shape& shape)
  {
    std::fill(m_block.begin(), m_block.end(), Matrix6(Matrix6::Zero()));
    std::fill(m_gradient.begin(), m_gradient.end(), Vec6(Vec6::Zero()));
    add_edges(weights, shape);
    add_springs(shape);
    add_attractions(attractions, weights.data, shape);
    add_damping(weights.damping, shape);
    if (!solve<ConcurrencyTag>())
      return -1;
    return apply(shape);
  }

private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  using Row1 = Eigen::Matrix<double, 1, 1>;

  // ---- sparsity

  /// Blocks of the lower triangle, column by column; the diagonal block is the first of its column.
  void find_blocks()
  {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs; // column, row
    const auto add = [&](std::uint32_t i, std::uint32_t j) {
      pairs.emplace_back(std::min(i, j), std::max(i, j));
    };
    for (std::uint32_t i = 0; i < m_size; ++i)
      add(i, i);
    for (const Elastic_edge& e : m_edges.surface)
      add(e.i, e.j);
    for (const Elastic_edge& e : m_edges.springs)
      add(e.i, e.j);
    for (const Carried_point& p : m_points)
      for (std::size_t k = 0; k < p.carriers.count; ++k)
        for (std::size_t l = 0; l < k; ++l)
          add(p.carriers.node[k], p.carriers.node[l]);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    m_first.assign(m_size + 1, 0);
    m_row.clear();
    for (const auto& [column, row] : pairs) {
      ++m_first[column + 1];
      m_row.push_back(row);
    }
    for (std::size_t i = 0; i < m_size; ++i)
      m_first[i + 1] += m_first[i];
    m_block.assign(m_row.size(), Matrix6::Zero());
  }

  std::size_t block_of(std::uint32_t column, std::uint32_t row) const
  {
    const auto begin = m_row.begin() + static_cast<std::ptrdiff_t>(m_first[column]);
    const auto end = m_row.begin() + static_cast<std::ptrdiff_t>(m_first[column + 1]);
    return static_cast<std::size_t>(std::lower_bound(begin, end, row) - m_row.begin());
  }

  /// Adds `m`, the block of row `i` and column `j`.
  void add_block(std::uint32_t i, std::uint32_t j, const Matrix6& m)
  {
    if (i >= j)
      m_block[block_of(j, i)] += m;
    else
      m_block[block_of(i, j)] += m.transpose();
  }

  // ---- terms

  /// Adds the squared residual `r` with Jacobians of three rows with respect to two samples.
  void add_pair(std::uint32_t i,
                std::uint32_t j,
                const Eigen::Matrix<double, 3, 6>& ji,
                const Eigen::Matrix<double, 3, 6>& jj,
                const Vec3& r,
                double weight)
  {
    const Eigen::Matrix<double, 3, 6> wi = weight * ji, wj = weight * jj;
    m_block[m_first[i]].noalias() += ji.transpose() * wi;
    m_block[m_first[j]].noalias() += jj.transpose() * wj;
    Matrix6 m;
    m.noalias() = jj.transpose() * wi;
    add_block(j, i, m);
    m_gradient[i].noalias() -= wi.transpose() * r;
    m_gradient[j].noalias() -= wj.transpose() * r;
  }

  void add_edges(const Energy_weights& weights, const Deformable_shape& shape)
  {
    const auto& rest = shape.network->rest;
    const auto& x = shape.state.position;
    const auto& rotation = shape.state.rotation;
    const auto& stretch = shape.state.stretch;
    Eigen::Matrix<double, 3, 6> ji, jj;
    for (const Elastic_edge& e : m_edges.surface) {
      const Vec3 at_rest = rest[e.j] - rest[e.i];
      const Vec3 edge = 0.5 * (stretch[e.i] * at_rest + stretch[e.j] * at_rest);
      const Vec3 qi = 0.5 * (rotation[e.i] * edge), qj = 0.5 * (rotation[e.j] * edge);
      // d(R e) = omega x (R e) = -[R e]x omega
      ji << -Eigen::Matrix3d::Identity(), cross_matrix(qi);
      jj << Eigen::Matrix3d::Identity(), cross_matrix(qj);
      add_pair(e.i, e.j, ji, jj, x[e.j] - x[e.i] - qi - qj, e.weight);
      add_bending(e, at_rest.squaredNorm(), weights.bending, shape);
    }
  }

  /// Adds `|(R_i - R_j)/2|^2`, the Frobenius norm, whose change is that of the rotation vector from
  /// one to the other: `|R_i - R_j|_F^2 = 2 |u|^2 + O(u^4)`.
  void add_bending(const Elastic_edge& e,
                   double squared_length,
                   double bending,
                   const Deformable_shape& shape)
  {
    const Eigen::Matrix3d relative =
        shape.state.rotation[e.j] * shape.state.rotation[e.i].transpose();
    const Vec3 u = rotation_log(Quaternion(relative).normalized());
    const double w = 0.5 * bending * e.weight * squared_length;
    const Eigen::Matrix3d block = w * Eigen::Matrix3d::Identity();
    Matrix6 m = Matrix6::Zero();
    m.bottomRightCorner<3, 3>() = block;
    m_block[m_first[e.i]] += m;
    m_block[m_first[e.j]] += m;
    add_block(e.j, e.i, -m);
    m_gradient[e.i].tail<3>() += w * u;
    m_gradient[e.j].tail<3>() -= w * u;
  }

  void add_springs(const Deformable_shape& shape)
  {
    const auto& rest = shape.network->rest;
    const auto& x = shape.state.position;
    for (const Elastic_edge& e : m_edges.springs) {
      const Vec3 d = x[e.j] - x[e.i];
      const double length = d.norm(), wanted = (rest[e.j] - rest[e.i]).norm();
      if (!(length > 0))
        continue;
      const Vec3 direction = d / length;
      Matrix6 m = Matrix6::Zero();
      m.topLeftCorner<3, 3>() = e.weight * direction * direction.transpose();
      m_block[m_first[e.i]] += m;
      m_block[m_first[e.j]] += m;
      add_block(e.j, e.i, -m);
      const Vec3 pull = e.weight * (length - wanted) * direction;
      m_gradient[e.i].head<3>() += pull;
      m_gradient[e.j].head<3>() -= pull;
    }
  }

  void add_attractions(const std::vector<Attraction>& attractions,
                       double weight,
                       const Deformable_shape& shape)
  {
    for (std::size_t p = 0; p < attractions.size(); ++p)
      if (attractions[p].a.trace() > 0)
        add_attraction(m_points[p], attractions[p], weight, shape);
  }

  void add_attraction(const Carried_point& p,
                      const Attraction& attraction,
                      double weight,
                      const Deformable_shape& shape)
  {
    const Carriers& c = p.carriers;
    const Eigen::Matrix3d a = weight * attraction.a;
    const Vec3 pull = weight * attraction.pull;
    Eigen::Matrix3d q[carriers_of_point], aq[carriers_of_point];
    for (std::size_t k = 0; k < c.count; ++k) {
      const Vec3 arm = shape.state.rotation[c.node[k]] *
                       (shape.state.stretch[c.node[k]] * (p.rest - shape.network->rest[c.node[k]]));
      q[k] = cross_matrix(arm);
      aq[k].noalias() = a * q[k];
    }
    Matrix6 m;
    for (std::size_t k = 0; k < c.count; ++k) {
      for (std::size_t l = 0; l <= k; ++l) {
        const double w = c.weight[k] * c.weight[l];
        m.topLeftCorner<3, 3>() = w * a;
        m.topRightCorner<3, 3>() = -w * aq[l];
        m.bottomLeftCorner<3, 3>() = -w * aq[k].transpose(); // q a = -(a q)^T
        m.bottomRightCorner<3, 3>().noalias() = -w * q[k] * aq[l];
        add_block(c.node[k], c.node[l], m);
      }
      m_gradient[c.node[k]].head<3>() += c.weight[k] * pull;
      m_gradient[c.node[k]].tail<3>() += c.weight[k] * (q[k] * pull);
    }
  }

  /// Makes the matrix definite. Positions are damped so little that only samples without any
  /// attraction notice it.
  void add_damping(double damping, const Deformable_shape& shape)
  {
    constexpr double of_positions = 1e-7;
    const double of_rotations = damping * shape.spacing * shape.spacing;
    for (std::size_t i = 0; i < m_size; ++i) {
      Matrix6& m = m_block[m_first[i]];
      for (int k = 0; k < 3; ++k) {
        m(k, k) += of_positions * (1 + m(k, k));
        m(3 + k, 3 + k) += of_rotations;
      }
    }
  }

  // ---- solution

  template <class ConcurrencyTag>
  bool solve()
  {
    fill_matrix();
    if (!m_is_ordered) {
      m_is_ordered = m_factor.factorize(m_matrix);
      if (!m_is_ordered)
        return false;
    } else if (!m_factor.factorize(m_matrix, m_factor.pattern()))
      return false;
    m_solution.resize(6 * m_size);
    for (std::size_t i = 0; i < m_size; ++i)
      for (int k = 0; k < 6; ++k)
        m_solution[6 * i + static_cast<std::size_t>(k)][0] = m_gradient[i][k];
    m_factor.template solve<ConcurrencyTag>(m_solution, m_work);
    for (const Row1& v : m_solution)
      if (!std::isfinite(v[0]))
        return false;
    return true;
  }

  /// Writes the blocks to the scalar matrix, whose pattern is that of the first call.
  void fill_matrix()
  {
    const auto n = static_cast<Eigen::Index>(6 * m_size);
    if (m_matrix.rows() != n || !m_is_ordered) {
      m_matrix.resize(n, n);
      Eigen::VectorXi count(n);
      for (std::size_t i = 0; i < m_size; ++i)
        for (int k = 0; k < 6; ++k)
          count[static_cast<Eigen::Index>(6 * i) + k] =
              static_cast<int>(6 * (m_first[i + 1] - m_first[i])) - k;
      m_matrix.reserve(count);
      for (std::size_t i = 0; i < m_size; ++i)
        for (int k = 0; k < 6; ++k)
          for (std::size_t b = m_first[i]; b < m_first[i + 1]; ++b)
            for (int r = m_row[b] == i ? k : 0; r < 6; ++r)
              m_matrix.insert(static_cast<Eigen::Index>(6 * m_row[b]) + r,
                              static_cast<Eigen::Index>(6 * i) + k) = m_block[b](r, k);
      m_matrix.makeCompressed();
      return;
    }
    double* value = m_matrix.valuePtr();
    for (std::size_t i = 0; i < m_size; ++i)
      for (int k = 0; k < 6; ++k)
        for (std::size_t b = m_first[i]; b < m_first[i + 1]; ++b)
          for (int r = m_row[b] == i ? k : 0; r < 6; ++r)
            *value++ = m_block[b](r, k);
  }

  /// Largest turn of a sample in one step. [rad]
  static constexpr double largest_turn = 0.5;

  double apply(Deformable_shape& shape) const
  {
    double sum = 0;
    for (std::size_t i = 0; i < m_size; ++i) {
      Vec3 step, turn;
      for (int k = 0; k < 3; ++k) {
        step[k] = m_solution[6 * i + static_cast<std::size_t>(k)][0];
        turn[k] = m_solution[6 * i + 3 + static_cast<std::size_t>(k)][0];
      }
      const double angle = turn.norm();
      if (angle > largest_turn)
        turn *= largest_turn / angle;
      shape.state.position[i] += step;
      const Quaternion q = rotation_exp(turn) * Quaternion(shape.state.rotation[i]);
      shape.state.rotation[i] = q.normalized().toRotationMatrix();
      sum += step.squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, m_size)));
  }

  Elastic_edges m_edges;
  std::vector<Carried_point> m_points;
  std::size_t m_size = 0;
  std::vector<std::size_t> m_first; ///< first block of each column, and the end
  std::vector<std::uint32_t> m_row; ///< of each block, increasing within a column
  std::vector<Matrix6> m_block;
  std::vector<Vec6> m_gradient; ///< negative half gradient
  Eigen::SparseMatrix<double> m_matrix;
  linear_algebra::Sparse_cholesky m_factor;
  bool m_is_ordered = false; ///< whether `m_factor` has the pattern of the matrix
  std::vector<Row1> m_solution, m_work;
};

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_GAUSS_NEWTON_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotation field: harmonic interpolation of the rotations of the handles over the body.

#ifndef PCS_DEFORMATION_SOLVER_ROTATION_FIELD_H
#define PCS_DEFORMATION_SOLVER_ROTATION_FIELD_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/internal/parallel.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {

namespace deformation {

/*!
  Interpolates the rotations of the handles at all nodes.

  Let `q_i = p_i q_i0` be the frames, with rotations `p_i` from rest to deformed. The least-squares
  form of equation (2.1) of [Aiteanu 2022], `q_i q_ij = q_j`, is then
  `min sum_{edges ij} w_ij |p_i - p_j|^2` over the quaternions `p_i` of the free and soft nodes,
  with the surface weights `w_ij` and given `p_k` at the handles (2.3). The local frames cancel, and
  the matrix is a scalar Laplacian. The unit length is restored afterwards.
  `Rotation_field::quaternion` is this solution. Linear blending distributes a large angle unevenly
  and cannot count turns. Therefore `Rotation_field::geodesic`

  1. blends rotation vectors if all rotations have the same axis (exact for any angle);
  2. otherwise, if the handles are less than `widest_lifted_angle` apart, blends quaternions and
     follows with three steps of the harmonic map, `L s = sum w log(q_j q_i^-1)`, `q <- exp(s) q`;
  3. otherwise blends the successive rotations of the handles one after another, each as rotation
     vectors in space.
*/
template <class ConcurrencyTag>
class Rotation_field_solver
{
public:
  /// Largest angle between handles on the double cover for which linear blending is a safe start;
  /// blending fails at pi. [rad]
  static constexpr double widest_lifted_angle = 1.9;
  static constexpr int number_of_intrinsic_steps = 3;

  /// Writes the rotation of every node to `field`, the identity for unreached nodes. `work` may
  /// have any content before and after the call.
  void operator()(Rotation_field kind,
                  const linear_algebra::Sparse_cholesky& factor,
                  const Weighted_graph& graph,
                  const Node_constraints& constraints,
                  const Free_rows& rows,
                  const std::vector<Similarity>& transforms,
                  std::vector<Quaternion>& field,
                  std::vector<Vec3>& work)
  {
    m_work = &work;
    m_factor = &factor;
    m_graph = &graph;
    m_constraints = &constraints;
    m_rows = &rows;
    field.assign(graph.size(), Quaternion::Identity());
    m_lifted.clear();
    for (const Similarity& t : transforms) {
      Quaternion q = Quaternion::Identity();
      for (const auto& turn : t.turns())
        q = rotation_exp(turn) * q;
      m_lifted.push_back(q.normalized());
    }
    if (kind == Rotation_field::quaternion)
      blend_quaternions(field);
    else if (is_one_axis(transforms))
      blend_stage(transforms, 0, field);
    else if (is_narrow(transforms)) {
      blend_quaternions(field);
      for (int step = 0; step < number_of_intrinsic_steps; ++step)
        intrinsic_step(field);
    } else {
      std::size_t number_of_stages = 0;
      for (const Similarity& t : transforms)
        number_of_stages = std::max(number_of_stages, t.turns().size());
      for (std::size_t stage = 0; stage < number_of_stages; ++stage)
        blend_stage(transforms, stage, field);
    }
    for (std::size_t i = 0; i < graph.size(); ++i)
      if (constraints.is_prescribed(i))
        field[i] = m_lifted[static_cast<std::size_t>(constraints.handle_of_node[i])];
  }

private:
  using Vec4 = Eigen::Vector4d;

  static bool is_one_axis(const std::vector<Similarity>& transforms)
  {
    Vec3 axis = Vec3::Zero();
    for (const Similarity& t : transforms) {
      if (t.turns().size() > 1)
        return false;
      for (const auto& turn : t.turns()) {
        if (axis.squaredNorm() == 0)
          axis = turn;
        else if (axis.cross(turn).norm() > 1e-9 * axis.norm() * turn.norm())
          return false;
      }
    }
    return true;
  }

  /// Whether linear blending is a safe start. Handles without nodes, such as removed ones, are
  /// ignored.
  bool is_narrow(const std::vector<Similarity>& transforms)
  {
    m_has_nodes.assign(transforms.size(), 0);
    for (const auto h : m_constraints->handle_of_node)
      if (h >= 0)
        m_has_nodes[static_cast<std::size_t>(h)] = 1;
    double lowest = 1;
    for (std::size_t a = 0; a < transforms.size(); ++a) {
      if (!m_has_nodes[a])
        continue;
      if (transforms[a].total_angle() > 2 * static_cast<double>(EIGEN_PI))
        return false; // the double cover cannot count turns
      for (std::size_t b = 0; b < a; ++b)
        if (m_has_nodes[b])
          lowest = std::min(lowest, m_lifted[a].dot(m_lifted[b]));
    }
    return lowest > std::cos(widest_lifted_angle);
  }

  std::size_t handle(std::size_t node) const
  {
    return static_cast<std::size_t>(m_constraints->handle_of_node[node]);
  }

  void blend_quaternions(std::vector<Quaternion>& field)
  {
    const auto store = [&](std::size_t i, const Vec4& sum) {
      const double length = sum.norm();
      // Opposite rotations of two handles cancel somewhere between them. The field is undefined
      // there, and any rotation is valid.
      if (length > 1e-12)
        field[i].coeffs() = sum / length;
    };
    solve_harmonic<ConcurrencyTag>(
        *m_factor,
        *m_graph,
        *m_constraints,
        *m_rows,
        [&](std::size_t i) { return Vec4(m_lifted[handle(i)].coeffs()); },
        store,
        m_work4);
    if (field.size() > most_kept_nodes)
      m_work4 = std::vector<Vec4>();
  }

  void blend_stage(const std::vector<Similarity>& transforms,
                   std::size_t stage,
                   std::vector<Quaternion>& field)
  {
    solve_harmonic<ConcurrencyTag>(
        *m_factor,
        *m_graph,
        *m_constraints,
        *m_rows,
        [&](std::size_t i) {
          const auto& turns = transforms[handle(i)].turns();
          return stage < turns.size() ? turns[stage] : Vec3(Vec3::Zero());
        },
        [&](std::size_t i, const Vec3& turn) {
          field[i] = (rotation_exp(turn) * field[i]).normalized();
        },
        *m_work);
  }

  void intrinsic_step(std::vector<Quaternion>& field)
  {
    const auto rotation_at = [&](std::size_t j) {
      return m_constraints->is_prescribed(j) ? m_lifted[handle(j)] : field[j];
    };
    const auto load = [&](std::size_t r) {
      const std::size_t i = m_rows->node_of_row[r];
      const Quaternion inverse = field[i].conjugate();
      Vec3 b = Vec3::Zero();
      for (std::size_t e = m_graph->first[i]; e < m_graph->first[i + 1]; ++e)
        b += m_graph->weight[e] * rotation_log(rotation_at(m_graph->neighbor[e]) * inverse);
      if (m_constraints->is_soft(i))
        b += m_constraints->soft_weight(i, node_degree(*m_graph, i)) *
             rotation_log(m_lifted[handle(i)] * inverse);
      return b;
    };
    m_factor->solve_each<ConcurrencyTag>(
        load,
        [&](std::size_t r, const Vec3& turn) {
          Quaternion& q = field[m_rows->node_of_row[r]];
          q = (rotation_exp(turn) * q).normalized();
        },
        *m_work);
  }

  const linear_algebra::Sparse_cholesky* m_factor = nullptr;
  const Weighted_graph* m_graph = nullptr;
  const Node_constraints* m_constraints = nullptr;
  const Free_rows* m_rows = nullptr;
  std::vector<Quaternion> m_lifted;
  std::vector<char> m_has_nodes; ///< per handle
  std::vector<Vec3>* m_work = nullptr;
  std::vector<Vec4> m_work4;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_ROTATION_FIELD_H

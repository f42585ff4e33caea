// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the library's rotation field with the harmonic map and with many small turns.

#ifndef PCS_BENCHMARK_QUALITY_REFERENCE_FIELD_H
#define PCS_BENCHMARK_QUALITY_REFERENCE_FIELD_H

#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/solver/rotation_field.h>
#include <pcs/linear_algebra/Sparse_cholesky.h>
#include <pcs/linear_algebra/graph_laplacian.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <support/deformation_cases.h>

#include <CGAL/tags.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs_bench {

/// Rotation fields of one case with two handles, on its neighbour graph at full resolution.
class Field_comparison
{
public:
  explicit Field_comparison(const pcs_test::Deformation_case& c) : m_case(c)
  {
    namespace deformation = pcs::deformation;
    m_constraints.handle_of_node.assign(c.points.size(), deformation::free_node);
    m_constraints.softness_weight = {0, 0};
    for (std::size_t h = 0; h < 2; ++h)
      for (const auto i : c.handles[h])
        m_constraints.handle_of_node[i] = static_cast<deformation::Node_constraint>(h);
    m_rows = deformation::Free_rows(m_constraints);
    static_cast<pcs::neighborhood::Proximity_graph&>(m_graph) =
        pcs::neighborhood::nearest_neighbor_graph<CGAL::Sequential_tag>(c.points, 6);
    deformation::set_edge_weights<CGAL::Sequential_tag>(c.points, m_graph);
    const std::vector<const deformation::Weighted_graph*> graphs = {&m_graph};
    m_factor.factorize(pcs::linear_algebra::free_laplacian(graphs,
                                                           m_rows.row_of_node,
                                                           m_rows.node_of_row,
                                                           std::vector<double>()));
    // Harmonic weights, from 0 at the first handle to 1 at the second.
    m_share.assign(c.points.size(), Vec1::Zero());
    std::vector<Vec1> work;
    const auto value = [&](std::size_t i) { return Vec1(double(m_constraints.handle_of_node[i])); };
    deformation::solve_harmonic<CGAL::Sequential_tag>(
        m_factor,
        m_graph,
        m_constraints,
        m_rows,
        value,
        [&](std::size_t i, const Vec1& share) { m_share[i] = share; },
        work);
    for (std::size_t i = 0; i < m_share.size(); ++i)
      if (m_constraints.is_prescribed(i))
        m_share[i] = value(i);
  }

  std::vector<pcs::Quaternion> solve(pcs::Rotation_field kind) const
  {
    std::vector<pcs::Quaternion> field;
    pcs::deformation::Rotation_field_solver<CGAL::Sequential_tag> solver;
    std::vector<Vec3> work;
    solver(kind, m_factor, m_graph, m_constraints, m_rows, m_case.transforms, field, work);
    return field;
  }

  /// The harmonic map between handles less than 180 degrees apart, by intrinsic steps until
  /// convergence.
  std::vector<pcs::Quaternion> harmonic_map() const
  {
    const pcs::Quaternion a = lifted(0);
    const Vec3 difference = pcs::rotation_log(lifted(1) * a.conjugate());
    std::vector<pcs::Quaternion> field(m_share.size());
    for (std::size_t i = 0; i < field.size(); ++i)
      field[i] = pcs::rotation_exp(m_share[i][0] * difference) * a;
    std::vector<Vec3> rhs(m_rows.size()), work;
    for (int step = 0; step < 100; ++step) {
      double largest = 0;
      for (std::size_t r = 0; r < m_rows.size(); ++r) {
        const std::size_t i = m_rows.node_of_row[r];
        rhs[r].setZero();
        for (std::size_t e = m_graph.first[i]; e < m_graph.first[i + 1]; ++e)
          rhs[r] += m_graph.weight[e] *
                    pcs::rotation_log(field[m_graph.neighbor[e]] * field[i].conjugate());
      }
      m_factor.solve(rhs, work);
      for (std::size_t r = 0; r < m_rows.size(); ++r) {
        pcs::Quaternion& q = field[m_rows.node_of_row[r]];
        q = (pcs::rotation_exp(rhs[r]) * q).normalized();
        largest = std::max(largest, rhs[r].norm());
      }
      if (largest < 1e-12)
        break;
    }
    return field;
  }

  /// Keeps the first handle at rest and turns the second in small steps. Each step is extended
  /// harmonically over the current body.
  std::vector<pcs::Quaternion> many_small_turns() const
  {
    std::vector<pcs::Quaternion> field(m_share.size(), pcs::Quaternion::Identity());
    for (const Vec3& turn : m_case.transforms[1].turns()) {
      const int steps = int(std::ceil(turn.norm() * 180 / pcs_test::pi)); // steps of one degree
      for (int step = 0; step < steps; ++step)
        for (std::size_t i = 0; i < field.size(); ++i)
          field[i] = (pcs::rotation_exp(m_share[i][0] / steps * turn) * field[i]).normalized();
    }
    return field;
  }

  /// RMS angle between two fields over the free points. [deg]
  double difference(const std::vector<pcs::Quaternion>& a,
                    const std::vector<pcs::Quaternion>& b) const
  {
    double sum = 0;
    for (const std::size_t i : m_rows.node_of_row) {
      const double angle = pcs::rotation_log(a[i] * b[i].conjugate()).norm() * 180 / pcs_test::pi;
      sum += angle * angle;
    }
    return std::sqrt(sum / double(m_rows.size()));
  }

private:
  using Vec1 = Eigen::Matrix<double, 1, 1>;
  using Vec3 = Eigen::Vector3d;

  pcs::Quaternion lifted(std::size_t handle) const
  {
    pcs::Quaternion q = pcs::Quaternion::Identity();
    for (const Vec3& turn : m_case.transforms[handle].turns())
      q = pcs::rotation_exp(turn) * q;
    return q;
  }

  const pcs_test::Deformation_case& m_case;
  pcs::deformation::Node_constraints m_constraints;
  pcs::deformation::Free_rows m_rows;
  pcs::deformation::Weighted_graph m_graph;
  pcs::linear_algebra::Sparse_cholesky m_factor;
  std::vector<Vec1> m_share;
};

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_REFERENCE_FIELD_H

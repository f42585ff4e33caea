// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotations and positions of an elastic network under handles: constant factors, alternating solves.

#ifndef PCS_DEFORMATION_ELASTIC_SOLVER_H
#define PCS_DEFORMATION_ELASTIC_SOLVER_H

#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/Anderson_mixing.h>
#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Elastic_options.h>
#include <pcs/deformation/Elastic_state.h>
#include <pcs/deformation/Harmonic_system.h>
#include <pcs/deformation/rotation_field.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Alternates

  - the rotation field `B` of the handles (`Rotation_field_solver`) and a harmonic logarithm of scale,
  - positions: `L x = b`, `b_i = sum_j w_ij (G_i + G_j)/2 (x0_i - x0_j)` with `G_i = s_i R_i S_i`,
  - passes, the text's equation (2.2): best local rotations `R_fit`, their deviation from the field
    `d = log(R_fit B^-1)` smoothed by `(L + mu D) d' = mu D d`, `R = exp(d') B`, positions again.

  All matrices are constant while the constraints are; the three factors are made in `constrain()`. Of all states
  that the passes go through, the one with the least energy is kept, so more passes never make it worse.
*/
template <class ConcurrencyTag>
class Elastic_solver
{
public:
  const Elastic_network& network() const { return *m_network; }
  const Node_constraints& constraints() const { return m_constraints; }
  /// The present shape, until the next call.
  Elastic_state state() const
  {
    return {*m_network,
            m_constraints,
            m_position,
            m_frame,
            m_stretch_is_used ? m_target : m_frame,
            m_log_scale};
  }
  /// Rotation of every node relative to the field of the handles. [rad]
  const std::vector<Vec3>& deviations() const { return m_smooth; }

  /// Takes a network, which must outlive its use here, and constraints, and factorises. Returns `false` if a matrix is
  /// singular (a free part without handle).
  bool constrain(const Elastic_network& network, Node_constraints constraints, double stiffness)
  {
    m_network = &network;
    m_constraints = std::move(constraints);
    m_rows = Free_rows(m_constraints);
    m_fit_weight.resize(m_rows.size());
    std::vector<double> soft(m_rows.size(), 0), smoothing(m_rows.size(), 0);
    for (std::size_t r = 0; r < m_rows.size(); ++r) {
      const std::size_t i = m_rows.node_of_row[r];
      const double degree = node_degree(m_network->surface, i);
      if (m_constraints.is_soft(i))
        soft[r] = m_constraints.soft_weight(i, degree);
      m_fit_weight[r] = default_fit_weight / stiffness * relative_area(i) * degree;
      smoothing[r] = soft[r] + m_fit_weight[r];
    }
    const auto assemble = [&](std::vector<const Weighted_graph*> graphs,
                              const std::vector<double>& extra) {
      return linear_algebra::free_laplacian(graphs, m_rows.row_of_node, m_rows.node_of_row, extra);
    };
    const Weighted_graph* surface = &m_network->surface;
    const bool has_links = !m_network->links.neighbor.empty();
    bool field_ok = false, smoothing_ok = false, position_ok = true;
    const Eigen::SparseMatrix<double> of_field = assemble({surface}, soft);
    std::shared_ptr<const linear_algebra::Cholesky_pattern> pattern;
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] {
          pattern = std::make_shared<const linear_algebra::Cholesky_pattern>(
              of_field,
              rank_of_rows(m_network->surface_rank, m_rows));
        },
        [&] {
          if (has_links)
            position_ok = m_link_factor.factorize(assemble({surface, &m_network->links}, soft),
                                                  rank_of_rows(m_network->rank, m_rows));
        });
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] { field_ok = m_field_factor.factorize(of_field, pattern); },
        [&] {
          smoothing_ok = m_smoothing_factor.factorize(assemble({surface}, smoothing), pattern);
        });
    m_position = network.rest;
    m_frame.assign(network.size(), Eigen::Matrix3d::Identity());
    return field_ok && smoothing_ok && position_ok;
  }

  /// Solves for one transformation per handle, from the rest shape. The guess is the first state, or tried after the
  /// first pass, when that is not known to be worth it.
  Elastic_result solve(const std::vector<Similarity>& transforms,
                       const Elastic_options& options,
                       pcs::internal::Progress& progress,
                       const Deviation_guess& guess = {})
  {
    Elastic_result result;
    m_transforms = &transforms;
    m_field_solver(options.rotation_field,
                   m_field_factor,
                   m_network->surface,
                   m_constraints,
                   m_rows,
                   transforms,
                   m_field);
    m_rotation = m_field;
    blend_scales();
    m_stretch_is_used = options.poisson_ratio != 0;
    if (m_stretch_is_used)
      m_stretch.assign(m_network->size(), Eigen::Matrix3d::Identity());
    m_smooth.assign(m_network->size(), Vec3::Zero());
    m_best_smooth.assign(m_network->size(), Vec3::Zero());
    result.is_far_from_field = guess.is_far_from_field && options.maximal_number_of_passes > 0;
    if (result.is_far_from_field) {
      take(guess);
      turn_by_deviations();
    }
    update_frames();
    place_constrained_nodes();
    solve_positions(true);
    result.energy = result.initial_energy = fit_and_measure(options);
    result.status =
        options.maximal_number_of_passes == 0 ? Status::iteration_limit : Status::converged;
    if (m_rows.size() == 0)
      return result;
    m_mixing.restart();
    for (int pass = 0; pass < options.maximal_number_of_passes; ++pass) {
      if (!progress(static_cast<double>(pass) / options.maximal_number_of_passes)) {
        result.status = Status::cancelled;
        return result;
      }
      const double before = result.energy;
      const bool has_improved =
          improve(options, pass >= (result.is_far_from_field ? 1 : first_accelerated_pass), result);
      if (pass == 0 && !guess.deviations.empty() && !guess.is_far_from_field)
        result.is_far_from_field = start_from(guess, options, result);
      result.number_of_passes = pass + 1;
      result.status = Status::converged;
      if (!has_improved || before - result.energy <= options.tolerance * before)
        break;
      result.status = Status::iteration_limit;
    }
    return result;
  }

private:
  using Vec1 = Eigen::Matrix<double, 1, 1>;
  static constexpr std::size_t block = 512;

  /// The area of a node in units of the reference network's.
  double relative_area(std::size_t node) const
  {
    const double area = node < m_network->area.size() ? reference_size * m_network->area[node] : 1;
    return std::min(largest_relative_area, std::max(smallest_relative_area, area));
  }

  std::size_t handle(std::size_t node) const
  {
    return static_cast<std::size_t>(m_constraints.handle_of_node[node]);
  }

  /// The next state is written beside this one: all of it but the positions, which it starts from.
  void keep_state()
  {
    m_best_position = m_position;
    m_best_frame.resize(m_frame.size());
    m_best_frame.swap(m_frame);
    m_best_smooth.swap(m_smooth);
  }

  void swap_state()
  {
    m_position.swap(m_best_position);
    m_frame.swap(m_best_frame);
    m_smooth.swap(m_best_smooth);
  }

  /// One pass: accelerated if that lowers the energy, else plain; `false` if neither does (rounding at the optimum).
  bool improve(const Elastic_options& options, bool is_accelerated, Elastic_result& result)
  {
    keep_state();
    smooth_deviations();
    if (is_accelerated)
      m_plain = m_smooth;
    m_mixing.mix(m_best_smooth, m_smooth, is_accelerated);
    double energy = apply_deviations(options);
    if (is_accelerated && !(energy < result.energy)) {
      m_mixing.restart();
      m_smooth = m_plain;
      energy = apply_deviations(options);
    }
    if (!(energy < result.energy)) {
      swap_state();
      return false;
    }
    result.energy = energy;
    return true;
  }

  void take(const Deviation_guess& guess)
  {
    for (const auto i : m_rows.node_of_row)
      m_smooth[i] = i < guess.deviations.size() ? guess.deviations[i] : Vec3(Vec3::Zero());
  }

  /// A guess replaces the present state if it is clearly better: where the field of the handles explains the motion,
  /// it is more exact than a coarse network, and what folds up there is no shape here. Returns whether it did.
  bool
  start_from(const Deviation_guess& guess, const Elastic_options& options, Elastic_result& result)
  {
    keep_state();
    m_best_deviation = m_deviation;
    m_best_rotation = m_rotation;
    take(guess);
    const double energy = apply_deviations(options);
    if (energy < guess_advantage * result.energy) {
      result.energy = energy;
      m_mixing.restart();
      return true;
    }
    swap_state();
    m_deviation.swap(m_best_deviation);
    m_rotation.swap(m_best_rotation);
    return false;
  }

  /// Rotations `exp(d) B` from the present deviations, then positions; returns the energy.
  double apply_deviations(const Elastic_options& options)
  {
    turn_by_deviations();
    update_frames();
    solve_positions(false);
    return fit_and_measure(options);
  }

  void turn_by_deviations()
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_rows.size(),
        [&](std::size_t r) {
          const std::size_t i = m_rows.node_of_row[r];
          m_rotation[i] = (rotation_exp(m_smooth[i]) * m_field[i]).normalized();
        },
        block);
  }

  const linear_algebra::Sparse_cholesky& position_factor() const
  {
    return m_network->links.neighbor.empty() ? m_field_factor : m_link_factor;
  }

  void blend_scales()
  {
    m_log_scale.assign(m_network->size(), Vec1::Zero());
    bool any = false;
    for (const Similarity& t : *m_transforms)
      any = any || t.scale() != 1;
    if (!any)
      return;
    const auto value = [&](std::size_t i) {
      return Vec1(std::log((*m_transforms)[handle(i)].scale()));
    };
    solve_harmonic<ConcurrencyTag>(m_field_factor,
                                   m_network->surface,
                                   m_constraints,
                                   m_rows,
                                   value,
                                   m_rhs1,
                                   m_work1,
                                   m_log_scale);
    for (std::size_t i = 0; i < m_network->size(); ++i)
      if (m_constraints.is_prescribed(i))
        m_log_scale[i] = value(i);
  }

  void update_frames()
  {
    if (m_stretch_is_used)
      m_target.resize(m_network->size());
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_network->size(),
        [&](std::size_t i) {
          if (m_constraints.is_prescribed(i)) {
            const Similarity& t = (*m_transforms)[handle(i)];
            m_frame[i] = t.scale() * t.rotation();
          } else
            m_frame[i] = std::exp(m_log_scale[i][0]) * m_rotation[i].toRotationMatrix();
          if (m_stretch_is_used)
            m_target[i] = m_frame[i] * m_stretch[i];
        },
        block);
  }

  void place_constrained_nodes()
  {
    for (std::size_t i = 0; i < m_network->size(); ++i)
      if (m_constraints.is_prescribed(i))
        m_position[i] = (*m_transforms)[handle(i)](m_network->rest[i]);
      else if (m_constraints.handle_of_node[i] == unreached_node)
        m_position[i] = m_network->rest[i];
  }

  /// Links keep their turned direction at first; later they are springs of their rest length, because a link through
  /// a twisted bar must not turn with either end.
  void solve_positions(bool links_turn)
  {
    m_rhs3.resize(m_rows.size());
    const Elastic_state state = this->state();
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_rows.size(),
        [&](std::size_t r) {
          const std::size_t i = m_rows.node_of_row[r];
          Vec3 b;
          const double degree = state.sum_edges(i, b);
          const auto& links = m_network->links;
          if (!links.neighbor.empty())
            for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e) {
              const std::size_t j = links.neighbor[e];
              b += links.weight[e] * state.link_target(i, j, links_turn);
              if (m_constraints.is_prescribed(j))
                b += links.weight[e] * m_position[j];
            }
          if (m_constraints.is_soft(i))
            b += m_constraints.soft_weight(i, degree) *
                 (*m_transforms)[handle(i)](m_network->rest[i]);
          m_rhs3[r] = b;
        },
        block);
    position_factor().template solve<ConcurrencyTag>(m_rhs3, m_work3);
    pcs::internal::for_each_index<ConcurrencyTag>(m_rows.size(), [&](std::size_t r) {
      m_position[m_rows.node_of_row[r]] = m_rhs3[r];
    });
  }

  /// One sweep: the energy of the present state, and the deviation of each node's best rotation from the field.
  double fit_and_measure(const Elastic_options& options)
  {
    m_deviation.resize(m_network->size());
    const Elastic_state state = this->state();
    return pcs::internal::blocked_reduce<ConcurrencyTag>(
        m_network->size(),
        0.0,
        [&](std::size_t i) {
          if (m_constraints.handle_of_node[i] == unreached_node)
            return 0.0;
          Eigen::Matrix3d covariance;
          double energy = state.measure_edges(i, covariance);
          energy += state.link_energy(i);
          if (!m_constraints.is_prescribed(i)) {
            m_deviation[i] = fit_deviation(covariance, m_rotation[i], m_field[i], fit_damping);
            if (m_stretch_is_used)
              m_stretch[i] = state.transverse_stretch(i, options.poisson_ratio);
          }
          return energy;
        },
        [](double a, double b) { return a + b; },
        block);
  }

  /// `(L + mu D) d' = mu D d`.
  void smooth_deviations()
  {
    m_rhs3.resize(m_rows.size());
    pcs::internal::for_each_index<ConcurrencyTag>(m_rows.size(), [&](std::size_t r) {
      m_rhs3[r] = m_fit_weight[r] * m_deviation[m_rows.node_of_row[r]];
    });
    m_smoothing_factor.template solve<ConcurrencyTag>(m_rhs3, m_work3);
    pcs::internal::for_each_index<ConcurrencyTag>(m_rows.size(), [&](std::size_t r) {
      m_smooth[m_rows.node_of_row[r]] = m_rhs3[r];
    });
  }

private:
  const Elastic_network* m_network = nullptr;
  Node_constraints m_constraints;
  Free_rows m_rows;
  linear_algebra::Sparse_cholesky m_field_factor, m_link_factor, m_smoothing_factor;
  Rotation_field_solver<ConcurrencyTag> m_field_solver;
  std::vector<double> m_fit_weight; ///< of each row, its degree included
  bool m_stretch_is_used = false;

  const std::vector<Similarity>* m_transforms = nullptr;
  Anderson_mixing<ConcurrencyTag> m_mixing;
  std::vector<Quaternion> m_field, m_rotation, m_best_rotation;
  std::vector<Eigen::Matrix3d> m_frame, m_best_frame, m_stretch, m_target;
  std::vector<Vec1> m_log_scale, m_rhs1, m_work1;
  std::vector<Vec3> m_position, m_best_position, m_rhs3, m_work3;
  std::vector<Vec3> m_deviation, m_best_deviation; ///< of the best local rotations from the field
  std::vector<Vec3> m_smooth, m_best_smooth, m_plain; ///< the same, smoothed: what is used
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ELASTIC_SOLVER_H

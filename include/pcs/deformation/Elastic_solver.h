// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotations and positions of an elastic network under handles: constant factors, alternating solves.

#ifndef PCS_DEFORMATION_ELASTIC_SOLVER_H
#define PCS_DEFORMATION_ELASTIC_SOLVER_H

#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/Anderson_mixing.h>
#include <pcs/deformation/Blended_scales.h>
#include <pcs/deformation/Elastic_factors.h>
#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Elastic_options.h>
#include <pcs/deformation/Elastic_state.h>
#include <pcs/deformation/Harmonic_system.h>
#include <pcs/deformation/Position_solver.h>
#include <pcs/deformation/rotation_field.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Alternates

  - the rotation field `B` of the handles (`Rotation_field_solver`) and their scales (`Blended_scales`),
  - positions: `L x = b`, `b_i = sum_j w_ij (G_i + G_j)/2 (x0_i - x0_j)` with `G_i = R_i A_i S_i`, `A` the growth,
  - passes, the text's equation (2.2): best local rotations `R_fit`, their deviation from the field
    `d = log(R_fit B^-1)` smoothed by `(L + mu D) d' = mu D d`, `R = exp(d') B`, positions again.

  All matrices are constant while the constraints are; the three factors are made in `constrain()`. Passes are
  accelerated by Anderson mixing. Of all states that they go through, the one with the least energy is kept, so more
  passes never make it worse.
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
            m_scales.growth()};
  }
  /// Rotation of every node relative to the field of the handles. [rad]
  const std::vector<Vec3>& deviations() const { return m_smooth; }

  /// How far the interior links move the nodes: to the present positions from those that the surface alone would give
  /// with the same frames. Empty without links. One solve.
  void link_offsets(std::vector<Vec3>& offsets)
  {
    m_position_solver.link_offsets(state(), *m_transforms, m_factors, offsets);
  }

  /// Takes a network, which must outlive its use here, and constraints, and factorises. Returns `false` if a matrix is
  /// singular (a free part without handle).
  bool constrain(const Elastic_network& network, Node_constraints constraints, double stiffness)
  {
    m_network = &network;
    m_constraints = std::move(constraints);
    const bool is_regular = m_factors.factorize<ConcurrencyTag>(network, m_constraints, stiffness);
    m_position = network.rest;
    m_frame.assign(network.size(), Eigen::Matrix3d::Identity());
    return is_regular;
  }

  /// Solves for one transformation per handle, from the rest shape. The guess is the first state, or tried after the
  /// first pass, when that is not known to be worth it. Where it was found with links that this network lacks, energies do
  /// not compare: it is taken, and little is changed.
  Elastic_result solve(const std::vector<Similarity>& transforms,
                       const Elastic_options& options,
                       pcs::internal::Progress& progress,
                       const Deviation_guess& guess = {})
  {
    Elastic_result result;
    m_stretch.assign(options.poisson_ratio != 0 ? m_network->size() : 0,
                     Eigen::Matrix3d::Identity());
    begin(transforms, options);
    m_smooth.assign(m_network->size(), Vec3::Zero());
    m_best_smooth.assign(m_network->size(), Vec3::Zero());
    const bool has_passes = options.maximal_number_of_passes > 0;
    if (has_passes && !guess.link_offsets.empty() && m_network->links.neighbor.empty())
      m_link_offsets = &guess.link_offsets;
    result.is_far_from_field = m_link_offsets || (has_passes && guess.is_far_from_field);
    if (result.is_far_from_field) {
      take(guess);
      turn_by_deviations();
    }
    place(options, true, result);
    make_passes(options, progress, result.is_far_from_field ? nullptr : &guess, result);
    return result;
  }

  /*!
    The same from where the last solve under these constraints ended, as seen from the field: for handles that have moved
    little since. Returns `false` if that has more energy than `highest_energy`; the state is of no use then. Not for
    networks that lack the links of coarser ones.
  */
  bool solve_further(const std::vector<Similarity>& transforms,
                     const Elastic_options& options,
                     pcs::internal::Progress& progress,
                     double highest_energy,
                     Elastic_result& result)
  {
    result = Elastic_result();
    begin(transforms, options);
    result.is_far_from_field = true;
    turn_by_deviations();
    place(options, false, result);
    if (!(result.energy <= highest_energy))
      return false;
    make_passes(options, progress, nullptr, result);
    return true;
  }

private:
  const Free_rows& rows() const { return m_factors.rows(); }

  static constexpr std::size_t block = 512;

  std::size_t handle(std::size_t node) const
  {
    return static_cast<std::size_t>(m_constraints.handle_of_node[node]);
  }

  /// The field of the handles: what deviations refer to.
  void begin(const std::vector<Similarity>& transforms, const Elastic_options& options)
  {
    m_transforms = &transforms;
    m_field_solver(options.rotation_field,
                   m_factors.field(),
                   m_network->surface,
                   m_constraints,
                   rows(),
                   transforms,
                   m_field);
    m_rotation = m_field;
    m_stretch_is_used = options.poisson_ratio != 0;
    m_link_offsets = nullptr;
    m_mixing.restart();
    m_scales.begin(*m_network, m_constraints, m_factors, transforms);
    if (!m_scales.growth().empty())
      find_room();
  }

  /// How much bodies grow along the gradient of scale: as the field of the handles leaves room for them, so that least
  /// energy is left. That is quadratic in the share, because positions are linear in it. The present positions stay.
  void find_room()
  {
    m_best_position = m_position;
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_position);
    const double none = energy_with_share(0);
    m_ungrown = m_position;
    const double all = energy_with_share(1);
    for (const auto i : rows().node_of_row)
      m_ungrown[i] = 0.5 * (m_ungrown[i] + m_position[i]);
    m_position.swap(m_ungrown);
    const double half = energy_with_share(0.5, false);
    m_scales.set_share(m_scales.share_of_least_energy(none, half, all));
    m_position.swap(m_best_position);
  }

  double energy_with_share(double share, bool is_solved = true)
  {
    m_scales.set_share(share);
    update_frames();
    if (is_solved)
      solve_positions(true);
    const Elastic_state state = this->state();
    return pcs::internal::blocked_reduce<ConcurrencyTag>(
        m_network->size(),
        0.0,
        [&](std::size_t i) {
          Eigen::Matrix3d covariance;
          const bool is_reached = m_constraints.handle_of_node[i] != unreached_node;
          return is_reached ? state.measure_edges(i, covariance) : 0.0;
        },
        [](double a, double b) { return a + b; },
        block,
        m_energies);
  }

  /// The first positions, and their energy.
  void place(const Elastic_options& options, bool links_turn, Elastic_result& result)
  {
    update_frames();
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_position);
    solve_positions(links_turn);
    result.energy = result.initial_energy = fit_and_measure(options, true);
  }

  /// The guess, if there is one, may replace the state after the first pass.
  void make_passes(const Elastic_options& options,
                   pcs::internal::Progress& progress,
                   const Deviation_guess* guess,
                   Elastic_result& result)
  {
    result.status =
        options.maximal_number_of_passes == 0 ? Status::iteration_limit : Status::converged;
    if (rows().size() == 0)
      return;
    bool is_checking = false; // that there is no more to gain than an accelerated pass did
    for (int pass = 0; pass < options.maximal_number_of_passes; ++pass) {
      if (!progress(static_cast<double>(pass) / options.maximal_number_of_passes)) {
        result.status = Status::cancelled;
        return;
      }
      const double before = result.energy;
      const bool is_last = m_link_offsets || pass + 1 == options.maximal_number_of_passes;
      const bool is_accelerated =
          !is_checking && pass >= (result.is_far_from_field ? 1 : first_accelerated_pass);
      bool has_improved = improve(options, is_accelerated, is_last, result);
      if (pass == 0 && guess && !guess->deviations.empty()) {
        result.is_far_from_field = start_from(*guess, options, result);
        has_improved = has_improved || result.is_far_from_field;
      }
      result.number_of_passes = pass + 1;
      result.status = Status::converged;
      // Without the links, each further pass would let the body collapse.
      if (m_link_offsets || !has_improved)
        return;
      const double gain = before - result.energy;
      is_checking = is_accelerated && gain <= poor_gain * options.tolerance * before;
      if (is_checking)
        m_mixing.restart();
      else if (gain <= options.tolerance * before)
        return;
      result.status = Status::iteration_limit;
    }
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
  bool
  improve(const Elastic_options& options, bool is_accelerated, bool is_last, Elastic_result& result)
  {
    keep_state();
    smooth_deviations();
    if (is_accelerated)
      m_plain = m_smooth;
    mix(is_accelerated);
    double energy = apply_deviations(options, !is_last);
    if (is_accelerated && !(energy < result.energy)) {
      m_mixing.restart();
      m_smooth = m_plain;
      m_position = m_best_position;
      energy = apply_deviations(options, !is_last);
    }
    if (!(energy < result.energy)) {
      swap_state();
      return false;
    }
    result.energy = energy;
    return true;
  }

  /// What a pass starts from and what it makes of that: the deviations and, where there are links, the positions that give
  /// them their directions. Without these, what the links hold back would look like the answer to the deviations.
  void mix(bool is_wanted)
  {
    if (m_network->links.neighbor.empty()) {
      m_mixing.mix(m_best_smooth, m_smooth, is_wanted);
      return;
    }
    const std::size_t n = rows().size();
    m_state.resize(2 * n);
    m_image.resize(2 * n);
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t r) {
      const std::size_t i = rows().node_of_row[r];
      m_state[r] = m_best_smooth[i];
      m_state[n + r] = m_position_solver.directing()[i];
      m_image[r] = m_smooth[i];
      m_image[n + r] = m_position[i];
    });
    m_mixing.mix(m_state, m_image, is_wanted);
    if (is_wanted)
      pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t r) {
        const std::size_t i = rows().node_of_row[r];
        m_smooth[i] = m_image[r];
        m_position[i] = m_image[n + r];
      });
  }

  void take(const Deviation_guess& guess)
  {
    for (const auto i : rows().node_of_row)
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
    m_best_directing = m_position_solver.directing();
    take(guess);
    turn_by_deviations();
    update_frames();
    solve_positions(true); // the present positions know nothing of the guess
    if (!m_network->links.neighbor.empty())
      for (int i = 0; i < settling_solves; ++i)
        solve_positions(false);
    const double energy = fit_and_measure(options, true);
    if (energy < guess_advantage * result.energy) {
      result.energy = energy;
      m_mixing.restart();
      return true;
    }
    swap_state();
    m_deviation.swap(m_best_deviation);
    m_rotation.swap(m_best_rotation);
    m_position_solver.restore_directing(m_best_directing);
    return false;
  }

  /// Rotations `exp(d) B` from the present deviations, then positions; returns the energy.
  double apply_deviations(const Elastic_options& options, bool has_next)
  {
    turn_by_deviations();
    update_frames();
    solve_positions(false);
    return fit_and_measure(options, has_next);
  }

  void turn_by_deviations()
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        rows().size(),
        [&](std::size_t r) {
          const std::size_t i = rows().node_of_row[r];
          m_rotation[i] = (rotation_exp(m_smooth[i]) * m_field[i]).normalized();
        },
        block);
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
          } else {
            m_frame[i] = m_rotation[i].toRotationMatrix();
            if (!m_scales.growth().empty())
              m_frame[i] *= m_scales.growth()[i];
          }
          if (m_stretch_is_used)
            m_target[i] = m_frame[i] * m_stretch[i];
        },
        block);
  }

  void solve_positions(bool links_turn)
  {
    m_position_solver(state(), *m_transforms, m_factors, links_turn, m_position);
    if (m_link_offsets)
      for (const auto i : rows().node_of_row)
        if (i < m_link_offsets->size())
          m_position[i] += (*m_link_offsets)[i];
  }

  /// One sweep: the energy of the present state and, if there is a next pass, the deviation of each node's best rotation
  /// from the field.
  double fit_and_measure(const Elastic_options& options, bool has_next)
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
          if (has_next && !m_constraints.is_prescribed(i)) {
            if (!state.growth.empty())
              covariance *= state.growth[i];
            m_deviation[i] = fit_deviation(covariance, m_rotation[i], m_field[i], fit_damping);
            if (m_stretch_is_used)
              m_stretch[i] = state.transverse_stretch(i, options.poisson_ratio);
          }
          return energy;
        },
        [](double a, double b) { return a + b; },
        block,
        m_energies);
  }

  /// `(L + mu D) d' = mu D d`.
  void smooth_deviations()
  {
    m_rhs3.resize(rows().size());
    pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
      m_rhs3[r] = m_factors.fit_weight(r) * m_deviation[rows().node_of_row[r]];
    });
    m_factors.smoothing().template solve<ConcurrencyTag>(m_rhs3, m_work3);
    pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
      m_smooth[rows().node_of_row[r]] = m_rhs3[r];
    });
  }

private:
  const Elastic_network* m_network = nullptr;
  Node_constraints m_constraints;
  Elastic_factors m_factors;
  Rotation_field_solver<ConcurrencyTag> m_field_solver;
  Position_solver<ConcurrencyTag> m_position_solver;
  bool m_stretch_is_used = false;

  const std::vector<Similarity>* m_transforms = nullptr;
  const std::vector<Vec3>* m_link_offsets = nullptr; ///< of the first nodes; of a coarser network
  Anderson_mixing<ConcurrencyTag> m_mixing;
  Blended_scales<ConcurrencyTag> m_scales;
  std::vector<Quaternion> m_field, m_rotation, m_best_rotation;
  std::vector<Eigen::Matrix3d> m_frame, m_best_frame, m_stretch, m_target;
  std::vector<Vec3> m_position, m_best_position, m_ungrown, m_best_directing, m_rhs3, m_work3;
  std::vector<Vec3> m_deviation, m_best_deviation; ///< of the best local rotations from the field
  std::vector<Vec3> m_smooth, m_best_smooth, m_plain; ///< the same, smoothed: what is used
  std::vector<Vec3> m_state, m_image;                 ///< of a pass, for the mixing
  std::vector<double> m_energies;                     ///< of blocks of nodes
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ELASTIC_SOLVER_H

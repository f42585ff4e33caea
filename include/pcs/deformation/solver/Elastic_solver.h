// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Alternating (local-global) minimisation of the elastic energy of a network under handles.

#ifndef PCS_DEFORMATION_SOLVER_ELASTIC_SOLVER_H
#define PCS_DEFORMATION_SOLVER_ELASTIC_SOLVER_H

#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/solver/Anderson_mixing.h>
#include <pcs/deformation/solver/Elastic_state.h>
#include <pcs/deformation/solver/Elastic_step.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Reduces the elastic energy over the positions `x` and rotations `R` of the free and soft nodes:

      E(x, R) = sum_{edges ij} w_ij |(x_j - x_i) - (G_i + G_j)/2 (x0_j - x0_i)|^2  (+ links)  [L^2],

  which is the residual of equation (2.2) of [Aiteanu 2022]. `x0` are the positions at rest, `w_ij`
  are the weights of the surface edges [-], and `G_i` is `R_i` times growth and stretch
  (`Elastic_step`). Each iteration

  1. fits the rotation of every node to its edges (`fit_rotations.h`), as a deviation `d_i` from the
     rotation field of the handles (`rotation_field.h`);
  2. smooths: minimises `sum_ij w_ij |d'_i - d'_j|^2 + sum_i mu_i D_i |d'_i - d_i|^2` over `d'`,
     which is zero at the handles, with `D_i = sum_j w_ij` and `mu_i` from stiffness and area
     (`Elastic_factors::fit_weight()`); for soft nodes, a spring towards zero is added;
  3. solves for the positions with `R_i = exp(d'_i) B_i` fixed.

  The iterations are accelerated by Anderson mixing. The smoothing is a regularisation that is not
  part of `E`. The state with the lowest energy is kept, so further iterations never increase `E`.
*/
template <class ConcurrencyTag>
class Elastic_solver
{
public:
  const Elastic_network& network() const { return m_shape.network(); }
  const Node_constraints& constraints() const { return m_shape.constraints(); }
  /// Returns a view of the current shape, which is valid until the next call.
  Elastic_state state() const { return m_shape.state(); }
  /// Returns the rotation of every node relative to the rotation field of the handles [rad].
  const std::vector<Vec3>& deviations() const { return m_smooth; }

  /// See `Elastic_step`, also for `constrain()`.
  Node_targets& targets() { return m_shape.targets(); }
  const Node_targets& targets() const { return m_shape.targets(); }
  void link_offsets(std::vector<Vec3>& offsets) { m_shape.link_offsets(offsets); }
  bool constrain(const Elastic_network& network,
                 Node_constraints constraints,
                 double stiffness,
                 const pcs::internal::Go_on& go_on = {},
                 bool is_exact = true)
  {
    return m_shape.constrain(network, std::move(constraints), stiffness, go_on, is_exact);
  }

  /// Solves for one transformation per handle, starting from the rest shape. If the guess is known
  /// to be better, it is the initial state; otherwise it is compared with the state after the first
  /// iteration. If the guess was computed with links that this network lacks, energies cannot be
  /// compared. The guess is then accepted, and a single iteration follows. Large guesses are freed
  /// after their use.
  Elastic_result solve(const std::vector<Similarity>& transforms,
                       const Elastic_options& options,
                       pcs::internal::Progress& progress,
                       Deviation_guess* given = nullptr)
  {
    Deviation_guess none;
    Deviation_guess& guess = given ? *given : none;
    Elastic_result result;
    const bool has_passes = options.maximal_number_of_passes > 0;
    const bool has_offsets = has_passes && guess.link_offset && !m_shape.has_links();
    m_shape.begin(transforms, options, false, has_offsets ? &guess.link_offset : nullptr);
    m_mixing.restart();
    if (is_stopped(progress, result))
      return result;
    m_smooth.assign(network().size(), Vec3::Zero());
    m_shape.set_held_deviations(m_smooth);
    result.is_far_from_field = has_offsets || (has_passes && guess.is_far_from_field);
    if (result.is_far_from_field)
      take(guess);
    else if (!targets().empty())
      m_shape.interpolate_deviations(m_smooth);
    m_best_smooth.assign(network().size(), Vec3::Zero());
    m_shape.set_held_deviations(m_best_smooth);
    m_shape.place(m_smooth, true);
    if (is_stopped(progress, result))
      return result;
    result.energy = result.initial_energy = m_shape.fit_and_measure(m_smooth, true);
    make_passes(options, progress, result.is_far_from_field ? nullptr : &guess, result);
    finish();
    return result;
  }

  /*!
    Solves for handles that have moved little since the last solve under these constraints. The
    initial rotations are those of the new rotation field, with the deviations of the last solution.
    Returns `false` if the initial energy exceeds `highest_energy` [L^2]; the state is then not
    usable. Must not be called for networks that lack the links of coarser ones.
  */
  bool solve_further(const std::vector<Similarity>& transforms,
                     const Elastic_options& options,
                     pcs::internal::Progress& progress,
                     double highest_energy,
                     Elastic_result& result)
  {
    result = Elastic_result();
    m_shape.begin(transforms, options, true, nullptr);
    m_mixing.restart();
    m_best_smooth.assign(network().size(), Vec3::Zero());
    m_shape.set_held_deviations(m_smooth);
    m_shape.set_held_deviations(m_best_smooth);
    result.is_far_from_field = true;
    m_shape.place(m_smooth, false);
    result.energy = result.initial_energy = m_shape.fit_and_measure(m_smooth, true);
    if (!(result.energy <= highest_energy))
      return false;
    make_passes(options, progress, nullptr, result);
    finish();
    return true;
  }

  /// Frees all memory except that of the factors. Afterwards, only `constrain()` and `solve()` may
  /// be called.
  void free_state()
  {
    m_shape.free_state();
    m_mixing = Anderson_mixing<ConcurrencyTag>();
    for (std::vector<Vec3>* v : {&m_smooth, &m_best_smooth, &m_plain, &m_state, &m_image})
      *v = std::vector<Vec3>();
  }

private:
  const Free_rows& rows() const { return m_shape.rows(); }

  /// Frees the memory of a large network that only iterations need.
  void finish()
  {
    m_shape.finish();
    if (network().size() <= most_kept_nodes)
      return;
    m_mixing = Anderson_mixing<ConcurrencyTag>();
    for (std::vector<Vec3>* v : {&m_best_smooth, &m_plain, &m_state, &m_image})
      *v = std::vector<Vec3>();
    if (m_shape.has_link_offsets()) // no solve continues from here
      m_smooth = std::vector<Vec3>();
  }

  /// Asks between the steps before the first iteration, which take long for large networks.
  bool is_stopped(pcs::internal::Progress& progress, Elastic_result& result) const
  {
    if (rows().size() < least_watched_rows || progress(0))
      return false;
    result.status = Status::cancelled;
    return true;
  }

  /// Performs all iterations. The guess, if given, may replace the state after the first iteration.
  void make_passes(const Elastic_options& options,
                   pcs::internal::Progress& progress,
                   Deviation_guess* guess,
                   Elastic_result& result)
  {
    result.status =
        options.maximal_number_of_passes == 0 ? Status::iteration_limit : Status::converged;
    if (rows().size() == 0)
      return;
    bool is_checking = false; // whether the last iteration, an accelerated one, gained too little
    for (int pass = 0; pass < options.maximal_number_of_passes; ++pass) {
      if (!progress(static_cast<double>(pass) / options.maximal_number_of_passes)) {
        result.status = Status::cancelled;
        return;
      }
      const double before = result.energy;
      const bool is_last =
          m_shape.has_link_offsets() || pass + 1 == options.maximal_number_of_passes;
      const bool is_accelerated =
          !is_checking && pass >= (result.is_far_from_field ? 1 : first_accelerated_pass);
      result.status = Status::converged;
      bool has_improved = improve(is_accelerated, is_last, options.tolerance, result);
      if (pass == 0 && !result.is_far_from_field)
        result.first_pass_energy = result.energy;
      if (pass == 0 && guess && !guess->deviations.empty()) {
        result.is_far_from_field = start_from(*guess, result);
        has_improved = has_improved || result.is_far_from_field;
      }
      result.number_of_passes = pass + 1;
      // Without the links, further iterations would let the body collapse.
      if (m_shape.has_link_offsets() || !has_improved)
        return;
      result.status = Status::converged;
      const double gain = before - result.energy;
      is_checking = is_accelerated && gain <= poor_gain * options.tolerance * before;
      if (is_checking)
        m_mixing.restart();
      else if (gain <= options.tolerance * before)
        return;
      result.status = Status::iteration_limit;
    }
  }

  /// Performs one iteration, accelerated if this lowers the energy, otherwise plain. Returns
  /// `false` if neither lowers the energy. Usually, only rounding errors remain then. If the
  /// material is stretched, a clear rise of the energy is no sign of convergence, and the status
  /// says so.
  bool improve(bool is_accelerated, bool is_last, double tolerance, Elastic_result& result)
  {
    m_shape.keep();
    m_best_smooth.swap(m_smooth);
    m_shape.smooth_deviations(m_smooth);
    if (is_accelerated)
      m_plain = m_smooth;
    if (is_accelerated || !is_last) // otherwise nothing would be mixed with this iterate
      mix(is_accelerated);
    double energy = apply_deviations(!is_last);
    if (is_accelerated && !(energy < result.energy)) {
      m_mixing.restart();
      m_smooth = m_plain;
      m_shape.restart_from_kept();
      energy = apply_deviations(!is_last);
    }
    const double rise = energy - result.energy;
    if (m_shape.is_stretched())
      for (int i = 0; i < most_halvings && !(energy < result.energy); ++i)
        energy = halve_step(!is_last);
    if (!(energy < result.energy)) {
      m_smooth.swap(m_best_smooth);
      m_shape.return_to(m_smooth);
      if (m_shape.is_stretched() && !m_shape.has_link_offsets() &&
          rise > std::max(tolerance, default_tolerance) * result.energy)
        result.status = Status::iteration_limit;
      return false;
    }
    result.energy = energy;
    return true;
  }

  /// Halves the step from the stored state. A step is exact for a constant stretch of the material
  /// only, and overshoots where the links compress what they follow. Returns the energy. [L^2]
  double halve_step(bool has_next)
  {
    pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
      const std::size_t i = rows().node_of_row[r];
      m_smooth[i] = 0.5 * (m_smooth[i] + m_best_smooth[i]);
    });
    m_shape.halve_step(m_smooth);
    return m_shape.fit_and_measure(m_smooth, has_next);
  }

  /// Mixes the input and the output of an iteration: the deviations and, if there are links, the
  /// positions that define the directions of the links. Without the positions, the resistance of
  /// the links would be attributed to the deviations.
  void mix(bool is_wanted)
  {
    if (!m_shape.has_links()) {
      m_mixing.mix(m_best_smooth, m_smooth, is_wanted);
      return;
    }
    const std::size_t n = rows().size();
    m_state.resize(2 * n);
    m_image.resize(2 * n);
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t r) {
      const std::size_t i = rows().node_of_row[r];
      m_state[r] = m_best_smooth[i];
      m_state[n + r] = m_shape.directing()[i];
      m_image[r] = m_smooth[i];
      m_image[n + r] = m_shape.position()[i];
    });
    m_mixing.mix(m_state, m_image, is_wanted);
    if (is_wanted)
      pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t r) {
        const std::size_t i = rows().node_of_row[r];
        m_smooth[i] = m_image[r];
        m_shape.position()[i] = m_image[n + r];
      });
  }

  void take(Deviation_guess& guess)
  {
    for (const auto i : rows().node_of_row)
      m_smooth[i] = i < guess.deviations.size() ? guess.deviations[i] : Vec3(Vec3::Zero());
    if (guess.deviations.size() > most_kept_nodes)
      guess.deviations = std::vector<Vec3>();
  }

  /// Replaces the current state by the guess if the guess has clearly less energy. Returns whether
  /// it did. The guess may be worse: where the rotation field of the handles explains the motion,
  /// the field is more accurate than a coarse network, and a coarse network may fold where this one
  /// does not.
  bool start_from(Deviation_guess& guess, Elastic_result& result)
  {
    m_shape.keep_all();
    m_best_smooth.swap(m_smooth);
    take(guess);
    m_shape.follow(m_smooth, true); // the current positions do not depend on the guess
    if (m_shape.has_links())
      for (int i = 0; i < settling_solves; ++i)
        m_shape.solve_positions(false);
    const double energy = m_shape.fit_and_measure(m_smooth, true);
    if (energy < guess_advantage * result.energy) {
      result.energy = energy;
      m_mixing.restart();
      return true;
    }
    m_smooth.swap(m_best_smooth);
    m_shape.restore_all(m_smooth);
    return false;
  }

  /// Computes the next shape from the deviations. Returns its energy [L^2].
  double apply_deviations(bool has_next)
  {
    m_shape.follow(m_smooth, false);
    return m_shape.fit_and_measure(m_smooth, has_next);
  }

  Elastic_step<ConcurrencyTag> m_shape;
  Anderson_mixing<ConcurrencyTag> m_mixing;
  std::vector<Vec3> m_smooth, m_best_smooth, m_plain; ///< smoothed deviations
  std::vector<Vec3> m_state, m_image;                 ///< input and output of the mixing
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_ELASTIC_SOLVER_H

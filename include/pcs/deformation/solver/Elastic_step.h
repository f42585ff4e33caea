// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Local-global step of an elastic network: positions from rotations, and the reverse.

#ifndef PCS_DEFORMATION_SOLVER_ELASTIC_STEP_H
#define PCS_DEFORMATION_SOLVER_ELASTIC_STEP_H

#include <pcs/core/Similarity.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/solver/Blended_scales.h>
#include <pcs/deformation/solver/Elastic_factors.h>
#include <pcs/deformation/solver/Elastic_state.h>
#include <pcs/deformation/solver/Position_solver.h>
#include <pcs/deformation/solver/Target_loads.h>
#include <pcs/deformation/solver/fit_rotations.h>
#include <pcs/deformation/solver/measure_edges.h>
#include <pcs/deformation/solver/rotation_field.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Rotations are `R = exp(d) B`, with deviations `d` from the rotation field `B` of the handles.
  Positions are computed from rotations by `L x = b`, with
  `b_i = sum_j w_ij (G_i + G_j)/2 (x0_i - x0_j)`. Here `G_i = R_i A_i S_i` is the product of the
  rotation, the growth between handles of different scale (`Blended_scales`), and the stretch of
  the material (`Elastic_state::transverse_stretch()`). From positions, the energy and the
  deviations of the best-fitting rotations are computed.

  All matrices are constant for constant constraints; `constrain()` computes the three factors.
*/
template <class ConcurrencyTag>
class Elastic_step
{
public:
  const Elastic_network& network() const { return *m_network; }
  const Node_constraints& constraints() const { return m_constraints; }
  /// Returns the rows of the unknowns.
  const Free_rows& rows() const { return m_factors.rows(); }
  bool has_links() const { return !m_network->links.neighbor.empty(); }
  /// Whether the material has a Poisson's ratio other than zero.
  bool is_stretched() const { return m_poisson_ratio != 0; }
  /// Returns a view of the current shape, which is valid until the next call.
  Elastic_state state() const
  {
    return {*m_network,
            m_constraints,
            m_position,
            m_frame,
            is_stretched() ? m_target : m_frame,
            m_scales.growth(),
            m_loads.links(),
            m_target_stretch};
  }

  /// Factorises for the given constraints. The network must outlive its use here. Returns `false`
  /// if a matrix is singular (a free component without handle), or if `go_on` does. \param is_exact
  /// see `Elastic_factors::factorize()`
  bool constrain(const Elastic_network& network,
                 Node_constraints constraints,
                 double stiffness,
                 const pcs::internal::Go_on& go_on,
                 bool is_exact)
  {
    m_network = &network;
    m_constraints = std::move(constraints);
    m_targets.clear();
    m_loads.clear();
    const bool is_regular =
        m_factors.factorize<ConcurrencyTag>(network, m_constraints, stiffness, go_on, is_exact);
    m_position = network.rest;
    m_frame.assign(network.size(), Eigen::Matrix3d::Identity());
    return is_regular;
  }

  /// The offsets of the nodes of handles with targets, for the next `begin()`. Empty if there are
  /// none, and after `constrain()`.
  Node_targets& targets() { return m_targets; }
  const Node_targets& targets() const { return m_targets; }

  /*!
    Begins a solve for new motions of the handles, with the rotations of their field.
    \param is_further whether the stretch of the material is kept
    \param link_offset the offset of a node by links that this network lacks; may be null
  */
  void begin(const std::vector<Similarity>& transforms,
             const Elastic_options& options,
             bool is_further,
             const std::function<Vec3(std::size_t)>* link_offset)
  {
    m_transforms = &transforms;
    m_link_offset = nullptr;
    m_position.resize(m_network->size());
    m_frame.resize(m_network->size());
    m_loads.clear();
    m_poisson_ratio = options.poisson_ratio;
    if (!is_further)
      m_stretch.assign(is_stretched() ? m_network->size() : 0, Eigen::Matrix3d::Identity());
    m_target_stretch = m_stretch;
    m_field_solver(options.rotation_field,
                   m_factors.field(),
                   m_network->surface,
                   m_constraints,
                   rows(),
                   transforms,
                   m_field,
                   m_work);
    m_scales.begin(*m_network, m_constraints, m_factors, transforms);
    if (!m_scales.growth().empty())
      find_room();
    m_link_offset = link_offset;
    if (!m_targets.empty())
      find_loads();
  }

  /// Whether positions contain offsets by links of another network. If so, energies cannot be
  /// compared with those of other solutions.
  bool has_link_offsets() const { return m_link_offset != nullptr; }

  /// Sets the deviations of the nodes of handles with targets, which are constant.
  void set_held_deviations(std::vector<Vec3>& deviations) const
  {
    for (std::size_t i = 0; i < m_targets.size(); ++i)
      if (m_constraints.is_prescribed(i))
        deviations[i] = rodrigues_from_rotation(m_targets.turn(i));
  }

  /// Interpolates the deviations of the nodes of handles with targets harmonically.
  void interpolate_deviations(std::vector<Vec3>& deviations)
  {
    m_factors.field().template solve_each<ConcurrencyTag>(
        [&](std::size_t r) -> const Vec3& { return m_loads.of_rows()[r]; },
        [&](std::size_t r, const Vec3& u) { deviations[rows().node_of_row[r]] = u; },
        m_work);
  }

  /// Computes the positions of constrained nodes, then of all other nodes.
  void place(const std::vector<Vec3>& deviations, bool links_turn)
  {
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_targets, m_position);
    follow(deviations, links_turn);
  }

  /// Computes the rotations from deviations [rad], and the positions from the rotations.
  void follow(const std::vector<Vec3>& deviations, bool links_turn)
  {
    update_frames(deviations);
    solve_positions(links_turn);
  }

  /// Solves for the positions with unchanged rotations. Unless `links_turn`, links have their
  /// directions in the last positions.
  void solve_positions(bool links_turn)
  {
    m_position_solver(state(), *m_transforms, m_targets, m_factors, links_turn, m_position, m_work);
    if (m_link_offset)
      pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
        const std::size_t i = rows().node_of_row[r];
        m_position[i] += (*m_link_offset)(i);
      });
  }

  /// Returns the energy of the current state, without the constant energy inside handles with
  /// targets. The stretch of the material becomes that of the current positions, because energies
  /// with the stretch of former positions cannot be compared. If an iteration follows, also
  /// prepares `smooth_deviations()`: it computes the deviation of each node's best rotation from
  /// the field.
  /// \param deviations those of the current rotations
  double fit_and_measure(const std::vector<Vec3>& deviations, bool has_next)
  {
    const std::size_t n = m_network->size();
    if (has_next)
      m_work.resize(m_factors.smoothing().size_of_work());
    m_energies.resize((n + block - 1) / block);
    pcs::internal::for_each_block<ConcurrencyTag>(n,
                                                  block,
                                                  [&](std::size_t begin, std::size_t end) {
                                                    m_energies[begin / block] =
                                                        fit_block(deviations, begin, end, has_next);
                                                  });
    if (is_stretched())
      stretch_targets();
    const double sum =
        is_stretched() ? measure(true) : std::accumulate(m_energies.begin(), m_energies.end(), 0.0);
    const double energy = sum - m_loads.held_energy();
    return energy < 0 ? 0 : energy; // negative by rounding only
  }

  /// Smooths the deviations of the best-fitting rotations: `(L + mu D) d' = mu D d`, plus the loads
  /// of nodes that handles with targets turn. There must be no other solve since
  /// `fit_and_measure()`, which stores the right-hand side in the memory of solves. [rad]
  void smooth_deviations(std::vector<Vec3>& smooth)
  {
    const linear_algebra::Sparse_cholesky& factor = m_factors.smoothing();
    factor.template solve_placed<ConcurrencyTag>(m_work);
    pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
      smooth[rows().node_of_row[r]] = m_work[factor.place_of_row(r)];
    });
  }

  std::vector<Vec3>& position() { return m_position; }
  /// Returns the positions that defined the directions of the links. [L]
  const std::vector<Vec3>& directing() const { return m_position_solver.directing(); }

  /// Computes the displacements by the interior links: the current positions minus the positions
  /// without links for the same frames. Empty without links. One solve. [L]
  void link_offsets(std::vector<Vec3>& offsets)
  {
    m_position_solver.link_offsets(state(), *m_transforms, m_targets, m_factors, offsets, m_work);
  }

  /// Frees the memory of a large network that only iterations need.
  void finish()
  {
    if (m_network->size() <= most_kept_nodes)
      return;
    for (std::vector<Vec3>* v : {&m_work, &m_kept_position, &m_ungrown})
      *v = std::vector<Vec3>();
    m_field = std::vector<Quaternion>();
  }

  /// Frees all memory except that of the factors. The next `begin()` provides it again.
  void free_state()
  {
    for (std::vector<Vec3>* v :
         {&m_work, &m_position, &m_kept_position, &m_ungrown, &m_kept_directing})
      *v = std::vector<Vec3>();
    for (std::vector<Eigen::Matrix3d>* v : {&m_frame, &m_stretch, &m_target, &m_target_stretch})
      *v = std::vector<Eigen::Matrix3d>();
    m_field = std::vector<Quaternion>();
    m_scales = Blended_scales<ConcurrencyTag>();
    m_position_solver = Position_solver<ConcurrencyTag>();
  }

  /// \name Stored States
  /// @{

  /// Stores the positions, unless they are computed again, and the stretch that they cause.
  void keep()
  {
    if (!is_computed_again())
      m_kept_position = m_position;
    m_kept_stretch = m_stretch;
  }
  /// Returns to the stored positions. \param deviations those of the stored positions
  void return_to(const std::vector<Vec3>& deviations)
  {
    m_stretch = m_kept_stretch;
    update_frames(deviations);
    if (is_computed_again())
      solve_positions(false);
    else
      m_position.swap(m_kept_position);
  }
  /// Restores the stored positions only, from which links take their directions.
  void restart_from_kept()
  {
    if (!is_computed_again())
      m_position = m_kept_position;
    m_stretch = m_kept_stretch;
  }

  /// Moves the positions half of the way back to the stored ones. Not for positions that are
  /// computed again. \param deviations those of the new positions
  void halve_step(const std::vector<Vec3>& deviations)
  {
    pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
      const std::size_t i = rows().node_of_row[r];
      m_position[i] = 0.5 * (m_position[i] + m_kept_position[i]);
    });
    update_frames(deviations);
  }

  /// Stores the complete state from which an iteration continues.
  void keep_all()
  {
    keep();
    m_kept_directing = m_position_solver.directing();
  }
  /// Restores it, except for the rotations that fit best, which are computed again.
  /// \param deviations those of the stored positions
  void restore_all(const std::vector<Vec3>& deviations)
  {
    return_to(deviations);
    m_position_solver.restore_directing(m_kept_directing);
    fit_and_measure(deviations, true);
  }

  /// @}

private:
  static constexpr std::size_t block = 512;

  /// Whether the positions of an earlier state are computed again rather than stored. They follow
  /// from the deviations, unless there are links or a stretch.
  bool is_computed_again() const
  {
    return m_network->size() > most_kept_nodes && !has_links() && !is_stretched();
  }

  /// Returns the rotation of a node. \param deviations from the field; none if empty
  Quaternion rotation(const std::vector<Vec3>& deviations, std::size_t i) const
  {
    return deviations.empty() ? m_field[i] : rotation_from_rodrigues(deviations[i]) * m_field[i];
  }

  /// Sets the entry of a node in the right-hand side of `smooth_deviations()`.
  void set_fit(std::size_t i, const Vec3& deviation)
  {
    const std::size_t r = rows().row_of_node[i];
    Vec3& entry = m_work[m_factors.smoothing().place_of_row(r)];
    entry = m_factors.fit_weight(r) * deviation;
    if (!m_loads.of_rows().empty())
      entry += m_loads.of_rows()[r];
  }

  /// Implements `fit_and_measure()` for a block of nodes.
  double
  fit_block(const std::vector<Vec3>& deviations, std::size_t begin, std::size_t end, bool has_next)
  {
    const Elastic_state state = this->state();
    const Edge_input edges = state.edges();
    const Measure_edges measure_edges = choose_measure_edges();
    const Fit_rotations fit_rotations = choose_fit_rotations();
    Rotation_fits fits;
    std::array<std::size_t, Rotation_fits::size> node_of_fit;
    std::size_t count = 0;
    double energy = 0;
    const auto finish = [&] {
      fit_rotations(fit_damping, count, fits);
      for (std::size_t k = 0; k < count; ++k)
        set_fit(node_of_fit[k], {fits.deviation[0][k], fits.deviation[1][k], fits.deviation[2][k]});
      count = 0;
    };
    for (std::size_t i = begin; i < end; ++i) {
      if (m_constraints.handle_of_node[i] == unreached_node)
        continue;
      Eigen::Matrix3d covariance;
      energy += measure_edges(edges, i, covariance);
      energy += state.link_energy(i);
      if (m_constraints.is_prescribed(i))
        continue;
      if (is_stretched())
        m_stretch[i] = state.transverse_stretch(i, m_poisson_ratio);
      if (!has_next)
        continue;
      if (!state.growth.empty())
        covariance *= state.growth[i];
      node_of_fit[count] = i;
      fits.set(count++, covariance, rotation(deviations, i), m_field[i]);
      if (count == Rotation_fits::size)
        finish();
    }
    finish();
    return energy;
  }

  /// Finds the constant terms of targets. The positions of free nodes are unchanged.
  void find_loads()
  {
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_targets, m_position);
    m_loads.find(state(), rows(), *m_transforms, m_targets);
    if (!has_links())
      return;
    std::vector<Vec3> deviations(m_network->size(), Vec3::Zero()), with, without;
    interpolate_deviations(deviations);
    update_frames(deviations);
    m_position_solver.without_links(state(), *m_transforms, m_targets, m_factors, with, m_work);
    Node_targets targets;
    std::swap(targets, m_targets);
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_targets, m_position);
    update_frames({});
    m_position_solver.without_links(state(), *m_transforms, m_targets, m_factors, without, m_work);
    std::swap(targets, m_targets);
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_targets, m_position);
    m_loads.find_link_targets(state(), *m_transforms, m_targets, with, without);
  }

  /// Finds the growth of bodies along the gradient of scale: the fraction with the least energy
  /// under the field of the handles. The energy is quadratic in the fraction, because positions are
  /// linear in it. The current positions are unchanged.
  void find_room()
  {
    m_kept_position = m_position;
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_targets, m_position);
    const double none = energy_with_share(0);
    m_ungrown = m_position;
    const double all = energy_with_share(1);
    for (const auto i : rows().node_of_row)
      m_ungrown[i] = 0.5 * (m_ungrown[i] + m_position[i]);
    m_position.swap(m_ungrown);
    const double half = energy_with_share(0.5, false);
    m_scales.set_share(m_scales.share_of_least_energy(none, half, all));
    m_position.swap(m_kept_position);
  }

  double energy_with_share(double share, bool is_solved = true)
  {
    m_scales.set_share(share);
    update_frames({});
    if (is_solved)
      solve_positions(true);
    return measure(false);
  }

  /// Returns the energy of the edges and, if `counts_links`, of the links.
  double measure(bool counts_links)
  {
    const Elastic_state state = this->state();
    const Edge_input edges = state.edges();
    const Measure_edges measure_edges = choose_measure_edges();
    return pcs::internal::blocked_reduce<ConcurrencyTag>(
        m_network->size(),
        0.0,
        [&](std::size_t i) {
          if (m_constraints.handle_of_node[i] == unreached_node)
            return 0.0;
          Eigen::Matrix3d covariance;
          const double energy = measure_edges(edges, i, covariance);
          return counts_links ? energy + state.link_energy(i) : energy;
        },
        [](double a, double b) { return a + b; },
        block,
        m_energies);
  }

  /// \param deviations from the field; none if empty
  void update_frames(const std::vector<Vec3>& deviations)
  {
    find_frames(deviations);
    if (is_stretched())
      stretch_targets();
  }

  /// Computes the targets from the frames and the stretch of the material.
  void stretch_targets()
  {
    m_target.resize(m_network->size());
    m_target_stretch = m_stretch; // which a measurement changes while it reads the former one
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_network->size(),
        [&](std::size_t i) { m_target[i] = m_frame[i] * m_stretch[i]; },
        block);
  }

  /// Computes the frames from the rotations. Neither is stored for a later return, as frames have
  /// the largest share of the memory of a state.
  void find_frames(const std::vector<Vec3>& deviations)
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_network->size(),
        [&](std::size_t i) {
          if (m_constraints.is_prescribed(i)) {
            m_frame[i] = m_targets.frame(
                (*m_transforms)[static_cast<std::size_t>(m_constraints.handle_of_node[i])],
                i);
          } else {
            m_frame[i] = rotation(deviations, i).toRotationMatrix();
            if (!m_scales.growth().empty())
              m_frame[i] *= m_scales.growth()[i];
          }
        },
        block);
  }

  const Elastic_network* m_network = nullptr;
  Node_constraints m_constraints;
  Elastic_factors m_factors;
  Rotation_field_solver<ConcurrencyTag> m_field_solver;
  Position_solver<ConcurrencyTag> m_position_solver;
  Blended_scales<ConcurrencyTag> m_scales;

  const std::vector<Similarity>* m_transforms = nullptr;
  const std::function<Vec3(std::size_t)>* m_link_offset = nullptr;
  std::vector<Vec3> m_work; ///< of solves, and the right-hand side of `smooth_deviations()`
  Node_targets m_targets;
  Target_loads m_loads;
  double m_poisson_ratio = 0;
  std::vector<Quaternion> m_field;
  std::vector<Eigen::Matrix3d> m_frame, m_stretch, m_target, m_target_stretch, m_kept_stretch;
  std::vector<Vec3> m_position, m_kept_position, m_ungrown, m_kept_directing;
  std::vector<double> m_energies; ///< by block of nodes
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_ELASTIC_STEP_H

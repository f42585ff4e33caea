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
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Rotations are `R = exp(d) B`, with deviations `d` from the rotation field `B` of the handles.
  Positions are computed from rotations by `L x = b`, with
  `b_i = sum_j w_ij (G_i + G_j)/2 (x0_i - x0_j)`. Here `G_i = R_i A_i S_i` is the product of the
  rotation, the growth between handles of different scale (`Blended_scales`), and the transverse
  stretch of the material. From positions, the energy and the deviations of the best-fitting
  rotations are computed.

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
  /// if a matrix is singular (a free component without handle), or if `go_on` does.
  bool constrain(const Elastic_network& network,
                 Node_constraints constraints,
                 double stiffness,
                 const pcs::internal::Go_on& go_on)
  {
    m_network = &network;
    m_constraints = std::move(constraints);
    m_targets.clear();
    m_loads.clear();
    const bool is_regular =
        m_factors.factorize<ConcurrencyTag>(network, m_constraints, stiffness, go_on);
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
    \param link_offsets offsets of the first nodes by links that this network lacks; may be null
  */
  void begin(const std::vector<Similarity>& transforms,
             const Elastic_options& options,
             bool is_further,
             const std::vector<Vec3>* link_offsets)
  {
    m_transforms = &transforms;
    m_link_offsets = nullptr;
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
                   m_memory);
    m_rotation = m_field;
    m_scales.begin(*m_network, m_constraints, m_factors, transforms);
    if (!m_scales.growth().empty())
      find_room();
    m_link_offsets = link_offsets;
    if (!m_targets.empty())
      find_loads();
  }

  /// Whether positions contain offsets by links of another network. If so, energies cannot be
  /// compared with those of other solutions.
  bool has_link_offsets() const { return m_link_offsets != nullptr; }

  /// Computes the rotations from deviations. [rad]
  void turn(const std::vector<Vec3>& deviations)
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        rows().size(),
        [&](std::size_t r) {
          const std::size_t i = rows().node_of_row[r];
          m_rotation[i] = rotation_from_rodrigues(deviations[i]) * m_field[i];
        },
        block);
  }

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
    m_memory.rhs = m_loads.of_rows();
    m_factors.field().template solve<ConcurrencyTag>(m_memory.rhs, m_memory.work);
    for (std::size_t r = 0; r < rows().size(); ++r)
      deviations[rows().node_of_row[r]] = m_memory.rhs[r];
  }

  /// Computes the positions of constrained nodes, then of all other nodes.
  void place(bool links_turn)
  {
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_targets, m_position);
    follow(links_turn);
  }

  /// Computes the positions from the rotations.
  void follow(bool links_turn)
  {
    update_frames();
    solve_positions(links_turn);
  }

  /// Solves for the positions with unchanged rotations. Unless `links_turn`, links have their
  /// directions in the last positions.
  void solve_positions(bool links_turn)
  {
    m_position_solver(state(),
                      *m_transforms,
                      m_targets,
                      m_factors,
                      links_turn,
                      m_position,
                      m_memory);
    if (m_link_offsets)
      for (const auto i : rows().node_of_row)
        if (i < m_link_offsets->size())
          m_position[i] += (*m_link_offsets)[i];
  }

  /// Returns the energy of the current state, without the constant energy inside handles with
  /// targets. If a further iteration follows, also computes the deviation of each node's best
  /// rotation from the field.
  double fit_and_measure(bool has_next)
  {
    const std::size_t n = m_network->size();
    m_deviation.resize(n);
    m_energies.resize((n + block - 1) / block);
    pcs::internal::for_each_block<ConcurrencyTag>(n,
                                                  block,
                                                  [&](std::size_t begin, std::size_t end) {
                                                    m_energies[begin / block] =
                                                        fit_block(begin, end, has_next);
                                                  });
    const double sum = std::accumulate(m_energies.begin(), m_energies.end(), 0.0);
    const double energy = sum - m_loads.held_energy();
    return energy < 0 ? 0 : energy; // negative by rounding only
  }

  /// Smooths the deviations of the best-fitting rotations: `(L + mu D) d' = mu D d`, plus the loads
  /// of nodes that handles with targets turn. [rad]
  void smooth_deviations(std::vector<Vec3>& smooth)
  {
    m_memory.rhs.resize(rows().size());
    pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
      m_memory.rhs[r] = m_factors.fit_weight(r) * m_deviation[rows().node_of_row[r]];
      if (!m_loads.of_rows().empty())
        m_memory.rhs[r] += m_loads.of_rows()[r];
    });
    m_factors.smoothing().template solve<ConcurrencyTag>(m_memory.rhs, m_memory.work);
    pcs::internal::for_each_index<ConcurrencyTag>(rows().size(), [&](std::size_t r) {
      smooth[rows().node_of_row[r]] = m_memory.rhs[r];
    });
  }

  std::vector<Vec3>& position() { return m_position; }
  /// Returns the positions that defined the directions of the links. [L]
  const std::vector<Vec3>& directing() const { return m_position_solver.directing(); }

  /// Computes the displacements by the interior links: the current positions minus the positions
  /// without links for the same frames. Empty without links. One solve. [L]
  void link_offsets(std::vector<Vec3>& offsets)
  {
    m_position_solver.link_offsets(state(), *m_transforms, m_targets, m_factors, offsets, m_memory);
  }

  /// Frees the memory of a large network that only iterations need.
  void finish()
  {
    if (m_network->size() <= most_kept_nodes)
      return;
    m_memory = Solve_memory();
    for (std::vector<Vec3>* v : {&m_deviation, &m_kept_position, &m_kept_deviation, &m_ungrown})
      *v = std::vector<Vec3>();
    m_kept_rotation = decltype(m_kept_rotation)();
  }

  /// \name Stored States
  /// @{

  /// Stores the positions.
  void keep() { m_kept_position = m_position; }
  /// Restores positions and frames. \param deviations those of the stored positions
  void swap_kept(const std::vector<Vec3>& deviations)
  {
    m_position.swap(m_kept_position);
    turn(deviations);
    find_frames();
  }
  /// Restores the stored positions only.
  void restart_from_kept() { m_position = m_kept_position; }

  /// Stores the complete state from which an iteration continues.
  void keep_all()
  {
    keep();
    m_kept_deviation = m_deviation;
    m_kept_rotation = m_rotation;
    m_kept_directing = m_position_solver.directing();
  }
  void restore_all()
  {
    m_position.swap(m_kept_position);
    m_deviation.swap(m_kept_deviation);
    m_rotation.swap(m_kept_rotation);
    find_frames();
    m_position_solver.restore_directing(m_kept_directing);
  }

  /// @}

private:
  static constexpr std::size_t block = 512;

  bool is_stretched() const { return m_poisson_ratio != 0; }

  /// Implements `fit_and_measure()` for a block of nodes.
  double fit_block(std::size_t begin, std::size_t end, bool has_next)
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
        m_deviation[node_of_fit[k]] = {fits.deviation[0][k],
                                       fits.deviation[1][k],
                                       fits.deviation[2][k]};
      count = 0;
    };
    for (std::size_t i = begin; i < end; ++i) {
      if (m_constraints.handle_of_node[i] == unreached_node)
        continue;
      Eigen::Matrix3d covariance;
      energy += measure_edges(edges, i, covariance);
      energy += state.link_energy(i);
      if (!has_next || m_constraints.is_prescribed(i))
        continue;
      if (!state.growth.empty())
        covariance *= state.growth[i];
      if (is_stretched())
        m_stretch[i] = state.transverse_stretch(i, m_poisson_ratio);
      node_of_fit[count] = i;
      fits.set(count++, covariance, m_rotation[i], m_field[i]);
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
    turn(deviations);
    update_frames();
    m_position_solver.without_links(state(), *m_transforms, m_targets, m_factors, with, m_memory);
    Node_targets targets;
    std::swap(targets, m_targets);
    m_rotation = m_field;
    place_constrained_nodes(*m_network, m_constraints, *m_transforms, m_targets, m_position);
    update_frames();
    m_position_solver
        .without_links(state(), *m_transforms, m_targets, m_factors, without, m_memory);
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
    update_frames();
    if (is_solved)
      solve_positions(true);
    const Elastic_state state = this->state();
    const Edge_input edges = state.edges();
    const Measure_edges measure_edges = choose_measure_edges();
    return pcs::internal::blocked_reduce<ConcurrencyTag>(
        m_network->size(),
        0.0,
        [&](std::size_t i) {
          Eigen::Matrix3d covariance;
          const bool is_reached = m_constraints.handle_of_node[i] != unreached_node;
          return is_reached ? measure_edges(edges, i, covariance) : 0.0;
        },
        [](double a, double b) { return a + b; },
        block,
        m_energies);
  }

  void update_frames()
  {
    find_frames();
    if (!is_stretched())
      return;
    m_target.resize(m_network->size());
    m_target_stretch = m_stretch; // which the next measurement changes while links are measured
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_network->size(),
        [&](std::size_t i) { m_target[i] = m_frame[i] * m_stretch[i]; },
        block);
  }

  /// Computes the frames from the rotations. They are not stored for a later return, as they have
  /// the largest share of the memory of a state.
  void find_frames()
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_network->size(),
        [&](std::size_t i) {
          if (m_constraints.is_prescribed(i)) {
            m_frame[i] = m_targets.frame(
                (*m_transforms)[static_cast<std::size_t>(m_constraints.handle_of_node[i])],
                i);
          } else {
            m_frame[i] = m_rotation[i].toRotationMatrix();
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
  const std::vector<Vec3>* m_link_offsets = nullptr;
  Solve_memory m_memory;
  Node_targets m_targets;
  Target_loads m_loads;
  double m_poisson_ratio = 0;
  std::vector<Quaternion> m_field, m_rotation, m_kept_rotation;
  std::vector<Eigen::Matrix3d> m_frame, m_stretch, m_target, m_target_stretch;
  std::vector<Vec3> m_position, m_kept_position, m_ungrown, m_kept_directing;
  std::vector<Vec3> m_deviation, m_kept_deviation; ///< of the best local rotations from the field
  std::vector<double> m_energies;                  ///< by block of nodes
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_ELASTIC_STEP_H

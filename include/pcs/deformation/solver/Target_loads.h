// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Constant terms of the elastic iterations that follow from targets of handles.

#ifndef PCS_DEFORMATION_SOLVER_TARGET_LOADS_H
#define PCS_DEFORMATION_SOLVER_TARGET_LOADS_H

#include <pcs/core/Similarity.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/solver/Elastic_state.h>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// The energy inside handles, which would otherwise hide the gain of an iteration, and the loads of
/// the turned nodes of handles on the deviations. Zero without targets.
class Target_loads
{
public:
  double held_energy() const { return m_held_energy; } ///< [L^2]
  /// Loads of the rows in the system of the deviations; empty without targets.
  const std::vector<Vec3>& of_rows() const { return m_of_rows; }

  void clear()
  {
    m_held_energy = 0;
    m_of_rows.clear();
  }

  /// \param state with the positions of the prescribed nodes
  void find(const Elastic_state& state,
            const Free_rows& rows,
            const std::vector<Similarity>& transforms,
            const Node_targets& targets)
  {
    clear();
    add_held_energy(state, transforms, targets);
    const Node_constraints& constraints = state.constraints;
    const auto& graph = state.network.surface;
    m_of_rows.assign(rows.size(), Vec3::Zero());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::size_t i = rows.node_of_row[r];
      for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
        if (constraints.is_prescribed(graph.neighbor[e]))
          m_of_rows[r] +=
              graph.weight[e] * rodrigues_from_rotation(targets.turn(graph.neighbor[e]));
      if (constraints.is_soft(i))
        m_of_rows[r] += constraints.soft_weight(i, node_degree(graph, i)) *
                        rodrigues_from_rotation(targets.turn(i));
    }
  }

private:
  /// Adds the energy of edges and links between prescribed nodes.
  void add_held_energy(const Elastic_state& state,
                       const std::vector<Similarity>& transforms,
                       const Node_targets& targets)
  {
    const auto is_held = [&](std::size_t i) { return state.constraints.is_prescribed(i); };
    const auto frame = [&](std::size_t i) {
      return targets.frame(
          transforms[static_cast<std::size_t>(state.constraints.handle_of_node[i])],
          i);
    };
    const auto& graph = state.network.surface;
    const std::vector<Vec3>& rest = state.network.rest;
    for (std::size_t i = 0; i < state.network.size(); ++i) {
      if (!is_held(i))
        continue;
      const Eigen::Matrix3d own = frame(i);
      for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
        const std::size_t j = graph.neighbor[e];
        if (!is_held(j))
          continue;
        const Vec3 aim = 0.5 * ((own + frame(j)) * (rest[j] - rest[i]));
        m_held_energy +=
            0.5 * graph.weight[e] * (state.position[j] - state.position[i] - aim).squaredNorm();
      }
      m_held_energy += state.link_energy(i, is_held);
    }
  }

  std::vector<Vec3> m_of_rows;
  double m_held_energy = 0;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_TARGET_LOADS_H

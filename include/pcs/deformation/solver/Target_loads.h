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

  const Link_targets& links() const { return m_links; }

  void clear()
  {
    m_held_energy = 0;
    m_of_rows.clear();
    m_links.shift.clear();
    m_links.length.clear();
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

  /// Finds the targets of links between prescribed nodes and others. Their change by the targets is
  /// the one without links.
  /// \param with, without positions of all nodes without links, with and without targets
  void find_link_targets(const Elastic_state& state,
                         const std::vector<Similarity>& transforms,
                         const Node_targets& targets,
                         const std::vector<Vec3>& with,
                         const std::vector<Vec3>& without)
  {
    const Node_constraints& constraints = state.constraints;
    const auto& links = state.network.links;
    m_links.shift.assign(links.neighbor.size(), Vec3::Zero());
    m_links.length.assign(links.neighbor.size(), -1);
    for (std::size_t i = 0; i < state.network.size(); ++i)
      for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e) {
        const std::size_t j = links.neighbor[e];
        if (constraints.is_prescribed(i) == constraints.is_prescribed(j))
          continue;
        const std::size_t held = constraints.is_prescribed(i) ? i : j;
        if (!targets.is_offset(held))
          continue;
        const auto handle = static_cast<std::size_t>(constraints.handle_of_node[held]);
        m_links.shift[e] = (with[i] - with[j]) - (without[i] - without[j]);
        m_links.length[e] =
            (transforms[handle].rotation() * state.grown_link(i, j) + m_links.shift[e]).norm();
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
  Link_targets m_links;
  double m_held_energy = 0;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_TARGET_LOADS_H

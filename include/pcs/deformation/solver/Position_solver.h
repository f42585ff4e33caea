// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Positions of an elastic network under given frames: one linear solve with a constant factor.

#ifndef PCS_DEFORMATION_SOLVER_POSITION_SOLVER_H
#define PCS_DEFORMATION_SOLVER_POSITION_SOLVER_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/solver/Elastic_factors.h>
#include <pcs/deformation/solver/Elastic_state.h>
#include <pcs/internal/parallel.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// Moves the nodes of exact handles; sets nodes of components without handle to rest.
inline void place_constrained_nodes(const Elastic_network& network,
                                    const Node_constraints& constraints,
                                    const std::vector<Similarity>& transforms,
                                    const Node_targets& targets,
                                    std::vector<Vec3>& position)
{
  for (std::size_t i = 0; i < network.size(); ++i)
    if (constraints.is_prescribed(i))
      position[i] =
          targets.position(transforms[static_cast<std::size_t>(constraints.handle_of_node[i])],
                           network.rest[i],
                           i);
    else if (constraints.handle_of_node[i] == unreached_node)
      position[i] = network.rest[i];
}

/*!
  Solves `(L + L_links) x = b` in the given memory, whose content does not matter. The target of a
  surface edge is its rest edge, mapped by the mean of the frames at its ends. The target of a link
  has the rest length and a given direction.
*/
template <class ConcurrencyTag>
class Position_solver
{
public:
  /// Solves for `position`, of which \p state is a view. If `links_turn`, as in the first solve,
  /// the frames rotate the links. Otherwise links are springs in their directions in `position`,
  /// because a link through a twisted bar must not rotate with either end.
  void operator()(const Elastic_state& state,
                  const std::vector<Similarity>& transforms,
                  const Node_targets& targets,
                  const Elastic_factors& factors,
                  bool links_turn,
                  std::vector<Vec3>& position,
                  std::vector<Vec3>& work)
  {
    const auto& links = state.network.links;
    if (!links.neighbor.empty() && !links_turn)
      m_directing = position;
    const auto load = [&](std::size_t i) {
      Vec3 b = surface_load(state, transforms, targets, i);
      if (!links.neighbor.empty())
        for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e) {
          const std::size_t j = links.neighbor[e];
          b += links.weight[e] * state.link_target(i, j, e, links_turn);
          if (state.constraints.is_prescribed(j))
            b += links.weight[e] * position[j];
        }
      return b;
    };
    solve(
        factors,
        factors.position(),
        load,
        [&](std::size_t i, const Vec3& x) { position[i] = x; },
        work);
    if (!links.neighbor.empty() && links_turn)
      m_directing = position;
  }

  /// Returns the positions that defined the directions of the links in the last solve, or its
  /// result if the frames rotated the links. Undefined without links. [L]
  const std::vector<Vec3>& directing() const { return m_directing; }
  /// Restores earlier values of `directing()`; \p directing is unspecified afterwards.
  void restore_directing(std::vector<Vec3>& directing) { m_directing.swap(directing); }

  /// Computes the positions of all nodes without links, for the frames of `state`. One solve. [L]
  void without_links(const Elastic_state& state,
                     const std::vector<Similarity>& transforms,
                     const Node_targets& targets,
                     const Elastic_factors& factors,
                     std::vector<Vec3>& result,
                     std::vector<Vec3>& work)
  {
    result = state.position;
    solve(
        factors,
        factors.field(),
        [&](std::size_t i) { return surface_load(state, transforms, targets, i); },
        [&](std::size_t i, const Vec3& x) { result[i] = x; },
        work);
  }

  /// Computes the displacements by the links: the positions of `state` minus the positions without
  /// links for the same frames. Empty without links. One solve. [L]
  void link_offsets(const Elastic_state& state,
                    const std::vector<Similarity>& transforms,
                    const Node_targets& targets,
                    const Elastic_factors& factors,
                    std::vector<Vec3>& offsets,
                    std::vector<Vec3>& work)
  {
    offsets.clear();
    if (state.network.links.neighbor.empty())
      return;
    offsets.assign(state.network.size(), Vec3::Zero());
    solve(
        factors,
        factors.field(),
        [&](std::size_t i) { return surface_load(state, transforms, targets, i); },
        [&](std::size_t i, const Vec3& x) { offsets[i] = state.position[i] - x; },
        work);
  }

private:
  /// \param load, store see `Sparse_cholesky::solve_each()`, for nodes instead of rows
  template <class Load, class Store>
  static void solve(const Elastic_factors& factors,
                    const linear_algebra::Sparse_cholesky& factor,
                    const Load& load,
                    const Store& store,
                    std::vector<Vec3>& work)
  {
    const auto& node_of_row = factors.rows().node_of_row;
    factor.template solve_each<ConcurrencyTag>(
        [&](std::size_t r) { return load(node_of_row[r]); },
        [&](std::size_t r, const Vec3& x) { store(node_of_row[r], x); },
        work);
  }

  static Vec3 surface_load(const Elastic_state& state,
                           const std::vector<Similarity>& transforms,
                           const Node_targets& targets,
                           std::size_t node)
  {
    Vec3 b;
    const double degree = state.sum_edges(node, b);
    if (state.constraints.is_soft(node))
      b += state.constraints.soft_weight(node, degree) *
           targets.position(
               transforms[static_cast<std::size_t>(state.constraints.handle_of_node[node])],
               state.network.rest[node],
               node);
    return b;
  }

  std::vector<Vec3> m_directing;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_POSITION_SOLVER_H

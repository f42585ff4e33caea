// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Multigrid hierarchy of the elastic network: all coarse levels of a session.

#ifndef PCS_DEFORMATION_MULTIGRID_COARSE_LEVELS_H
#define PCS_DEFORMATION_MULTIGRID_COARSE_LEVELS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/multigrid/Coarse_level.h>
#include <pcs/internal/progress.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Networks above a certain size have no interior links. If coarser networks have links, the finest
  of these is solved to convergence; the levels between it and the session's network only
  interpolate its solution.
*/
template <class ConcurrencyTag>
class Coarse_levels
{
public:
  Coarse_levels() = default;

  /// \param finest the session's network, with nodes in spatial order
  /// \param component the component of each node of `finest`
  /// \param has_links whether closed surfaces have springs through their interior
  /// \param go_on called for large levels; if it returns `false`, the levels must not be used
  Coarse_levels(const Elastic_network& finest,
                std::vector<std::uint32_t> component,
                bool has_links,
                const pcs::internal::Go_on& go_on = {})
    : m_size_of_finest(finest.size()), m_size_of_passes(finest.size())
  {
    const Elastic_network* finer = &finest;
    const std::vector<std::uint32_t>* of_finer = &component;
    bool is_linked = !finest.links.neighbor.empty();
    while (finer->size() >= smallest_coarsened_network) {
      m_level.emplace_back(*finer, *of_finer, has_links, go_on);
      if (finer->size() >= least_watched_rows && !pcs::internal::goes_on(go_on, 1))
        return;
      finer = &m_level.back().network();
      of_finer = &m_level.back().component();
      if (!is_linked && !finer->links.neighbor.empty()) {
        is_linked = m_has_offsets = true;
        m_first = m_level.size() - 1;
        m_size_of_passes = finer->size();
      }
    }
    for (std::size_t l = m_first; l < m_level.size(); ++l) {
      m_level[l].rank();
      if (m_level[l].network().size() >= least_watched_rows && !pcs::internal::goes_on(go_on, 1))
        return;
    }
  }

  /// Transfers the constraints of the session's network to all levels and factorises. Returns
  /// `false` if a matrix is singular, or if `go_on` does.
  bool constrain(const Elastic_network& finest,
                 const Node_constraints& of_finest,
                 double stiffness,
                 const pcs::internal::Go_on& go_on)
  {
    bool is_regular = true;
    const auto count = static_cast<double>(m_level.size());
    const Elastic_network* finer = &finest;
    const Node_constraints* of_finer = &of_finest;
    for (std::size_t l = 0; l < m_level.size(); ++l) {
      const double begin = static_cast<double>(l) / count;
      if (finer->size() >= least_watched_rows && !go_on(begin))
        return false;
      m_level[l].constrain(*of_finer);
      const auto part = pcs::internal::part_of(go_on, begin, begin + 1 / count);
      if (l >= m_first)
        is_regular = m_level[l].factorize(*finer,
                                          *of_finer,
                                          stiffness,
                                          part,
                                          m_size_of_finest <= most_exact_rows) &&
                     is_regular;
      finer = &m_level[l].network();
      of_finer = &m_level[l].constraints();
    }
    return is_regular;
  }

  /// Transfers the offsets of the nodes of handles with targets from the session's network to all
  /// levels, after `constrain()`. `of_finest` are the constraints that were given there.
  void set_targets(const Node_constraints& of_finest, const Node_targets& finest)
  {
    const Node_constraints* of_finer = &of_finest;
    const Node_targets* finer = &finest;
    for (auto& level : m_level) {
      level.set_targets(*of_finer, *finer);
      of_finer = &level.constraints();
      finer = &level.targets();
    }
  }

  /// Solves from the coarsest to the finest level, unless `progress` cancels. Returns the guess for
  /// the session's network. Frees the memory of all iterations if this network is large.
  Deviation_guess& solve(const std::vector<Similarity>& transforms,
                         const Elastic_options& options,
                         pcs::internal::Progress& progress)
  {
    Deviation_guess& guess = m_guess;
    guess.deviations.clear();
    guess.link_offsets.clear();
    guess.link_offset = nullptr;
    guess.is_far_from_field = false;
    for (std::size_t l = m_level.size(); l-- > 0 && progress(0);) {
      if (l >= m_first)
        m_level[l].improve(transforms,
                           options,
                           m_size_of_passes,
                           m_has_offsets && l == m_first,
                           progress,
                           guess);
      if (l > 0)
        m_level[l].carry(guess);
      else
        m_level[l].carry_to_finest(guess);
    }
    for (std::size_t l = m_first; l < m_level.size() && m_size_of_finest > most_kept_nodes; ++l)
      m_level[l].free_state();
    return guess;
  }

  /// Frees the memory of the guess of a large network after its use.
  void forget_large_guess()
  {
    if (std::max(m_guess.deviations.size(), m_guess.link_offsets.size()) > most_kept_nodes)
      m_guess = Deviation_guess();
  }

  /// Whether a coarse level has links that the session's network lacks.
  bool has_link_offsets() const { return m_has_offsets; }

  /// Transfers the new rest shape of the session's network to all levels.
  void accept(const Elastic_network& finest)
  {
    const Elastic_network* finer = &finest;
    for (auto& level : m_level) {
      level.accept(*finer);
      finer = &level.network();
    }
  }

private:
  std::deque<Coarse_level<ConcurrencyTag>>
      m_level; ///< finest first; a deque does not move its elements
  Deviation_guess m_guess;
  std::size_t m_first = 0;          ///< finest level that is solved; finer ones only interpolate
  bool m_has_offsets = false;       ///< whether it has links that finer networks lack
  std::size_t m_size_of_finest = 0; ///< size of the session's network
  std::size_t m_size_of_passes = 0; ///< size of the finest network that is solved to convergence
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MULTIGRID_COARSE_LEVELS_H

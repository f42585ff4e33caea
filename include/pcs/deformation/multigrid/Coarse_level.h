// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One coarse level of the multigrid hierarchy of the elastic network.

#ifndef PCS_DEFORMATION_MULTIGRID_COARSE_LEVEL_H
#define PCS_DEFORMATION_MULTIGRID_COARSE_LEVEL_H

#include <pcs/core/Deformation_options.h>
#include <pcs/deformation/body/Sample_links.h>
#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/body/interior_links.h>
#include <pcs/deformation/body/octree_samples.h>
#include <pcs/deformation/handles/add_boundary_nodes.h>
#include <pcs/deformation/handles/anchor_free_components.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/solver/Elastic_solver.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// Number of nodes of the finer level per node of a level.
constexpr std::size_t coarsening_ratio = 5;
/// Networks with fewer nodes have no coarser level.
constexpr std::size_t smallest_coarsened_network = 1000;
/// Largest number of iterations on a coarse level, where each is cheap and propagates far.
constexpr int number_of_coarse_passes = 100;

/// Tolerance of a coarse level, relative to the tolerance of the finest level. It is smaller,
/// because errors that remain on a coarse level cost more expensive iterations on the finest level.
/// [-]
constexpr double coarse_share_of_tolerance = 0.5;

/*!
  Reduces the energy of `Elastic_solver` on a network with one node per `coarsening_ratio` nodes of
  the finer network, with its own weights (`sample_graph()`). Deviations are prolonged linearly,
  `d_i = sum_s w_is d_s`, over the samples `s` near a finer node with the weights of `Sample_links`.
  The result is the initial guess on the finer level. The scheme goes from coarse to fine once,
  without residual correction.

  One iteration propagates a rotation over a few edges only, but a handle that is translated without
  rotation causes rotations of the whole body. On a coarse network, a few edges span the body.
*/
template <class ConcurrencyTag>
class Coarse_level
{
public:
  /// \param finer the finer network, with nodes in spatial order
  /// \param component the component of each node of `finer`
  /// \param has_links whether closed surfaces have springs through their interior
  /// \param go_on called between the steps of large levels; if it returns `false`, the level must
  ///        not be used
  Coarse_level(const Elastic_network& finer,
               const std::vector<std::uint32_t>& component,
               bool has_links,
               const pcs::internal::Go_on& go_on = {})
    : m_node_of_sample(octree_samples(finer.rest, finer.size() / coarsening_ratio))
  {
    constexpr std::size_t number_of_sample_neighbors = 4;
    const auto is_stopped = [&] {
      return finer.size() >= least_watched_rows && !pcs::internal::goes_on(go_on, 0);
    };
    if (is_stopped())
      return;
    Sample_regions regions = grow_regions(finer.rest, finer.surface, m_node_of_sample);
    if (is_stopped())
      return;
    m_network.surface =
        sample_graph(finer.rest, finer.surface, m_node_of_sample, regions, m_weight_unit);
    m_network.surface.neighbor.shrink_to_fit();
    m_network.surface.weight.shrink_to_fit();
    m_links = link_by_regions<ConcurrencyTag>(finer.rest,
                                              m_node_of_sample,
                                              regions,
                                              m_network.surface,
                                              number_of_sample_neighbors,
                                              Sample_weights::compact);
    if (is_stopped())
      return;
    m_sample_of_node = std::move(regions.sample_of_point);
    m_border_finder = Border_finder(finer.surface);
    m_network.rest.reserve(m_node_of_sample.size());
    for (const auto node : m_node_of_sample) {
      m_network.rest.push_back(finer.rest[node]);
      m_component.push_back(component[node]);
    }
    set_areas<ConcurrencyTag>(m_component, m_network);
    if (has_links && m_network.size() <= largest_linked_network)
      m_network.links = interior_links<ConcurrencyTag>(m_network, m_component);
  }

  /// Finds the order of elimination. It saves time if `factorize()` is called repeatedly.
  void rank() { rank_nodes(m_network); }

  const Elastic_network& network() const { return m_network; }
  const std::vector<std::uint32_t>& component() const { return m_component; }
  const Node_constraints& constraints() const { return m_constraints; }

  /// Transfers the constraints of the finer level.
  void constrain(const Node_constraints& of_finer)
  {
    m_constraints = Node_constraints();
    m_constraints.softness_weight = of_finer.softness_weight;
    for (const auto node : m_node_of_sample)
      m_constraints.handle_of_node.push_back(of_finer.handle_of_node[node]);
    draw_nodes_of_soft_handles(of_finer);
    anchor_free_components([&](std::size_t node) { return m_component[node]; },
                           m_sample_of_node,
                           [&](std::size_t i) { return of_finer.handle_of_node[i]; },
                           m_constraints);
  }

  /// Prepares `improve()`. Returns `false` if a matrix is singular, or if `go_on` does. \param
  /// is_exact see `Elastic_factors::factorize()`
  bool factorize(const Elastic_network& finer,
                 const Node_constraints& of_finer,
                 double stiffness,
                 const pcs::internal::Go_on& go_on = {},
                 bool is_exact = true)
  {
    const auto handle_of_node = [&](std::size_t node) {
      return of_finer.is_prescribed(node) ? of_finer.handle_of_node[node] : free_node;
    };
    const auto position = [&](std::size_t node) { return finer.rest[node]; };
    const std::vector<Border_edge> border =
        m_border_finder.find<ConcurrencyTag>(finer.surface, [&](std::size_t node) {
          return of_finer.is_prescribed(node);
        });
    Node_constraints constraints = m_constraints;
    m_bounded = add_boundary_nodes(
        Boundary_input<decltype(handle_of_node), decltype(position)>{m_network,
                                                                     m_weight_unit,
                                                                     border,
                                                                     m_sample_of_node,
                                                                     handle_of_node,
                                                                     position},
        constraints);
    return m_solver.constrain(m_bounded, std::move(constraints), stiffness, go_on, is_exact);
  }

  /// Transfers the offsets of the nodes of handles with targets from the finer level.
  void set_targets(const Node_constraints& of_finer, const Node_targets& finer)
  {
    m_targets.clear();
    m_solver.targets().clear();
    if (finer.empty())
      return;
    m_targets.assign(m_network.size());
    for (std::size_t s = 0; s < m_network.size(); ++s) {
      const std::uint32_t node = m_node_of_sample[s];
      if (m_constraints.handle_of_node[s] >= 0 &&
          of_finer.handle_of_node[node] == m_constraints.handle_of_node[s])
        m_targets.set(s, finer[node]);
    }
    set_targets_of_drawn_nodes(of_finer, finer);
    if (m_bounded.size() == 0)
      return; // this level only interpolates
    Node_targets& targets = m_solver.targets();
    targets.assign(m_bounded.size());
    for (std::size_t s = 0; s < m_network.size(); ++s)
      targets.set(s, m_targets[s]);
    for (std::size_t s = m_network.size(); s < m_bounded.size(); ++s)
      targets.set(s, finer[m_bounded.source[s - m_network.size()]]);
  }

  const Node_targets& targets() const { return m_targets; }

  /// Iterates on this level, unless `progress` cancels. `guess` is empty or refers to the nodes of
  /// this level, before and after the call; `carry()` follows. The tolerance is proportional to the
  /// cost of an iteration relative to one with `finest_size` nodes.
  void improve(const std::vector<Similarity>& transforms,
               Elastic_options options,
               std::size_t finest_size,
               bool needs_link_offsets,
               pcs::internal::Progress& progress,
               Deviation_guess& guess)
  {
    options.maximal_number_of_passes = number_of_coarse_passes;
    options.tolerance *= coarse_share_of_tolerance * static_cast<double>(m_network.size()) /
                         static_cast<double>(finest_size);
    pcs::internal::Progress only_stops([&](double) { return progress(0); });
    const Elastic_result result = m_solver.solve(transforms, options, only_stops, &guess);
    guess.is_far_from_field =
        result.is_far_from_field || result.energy < sure_advantage * result.first_pass_energy;
    if (needs_link_offsets)
      m_solver.link_offsets(guess.link_offsets);
    guess.deviations.clear();
    if (guess.is_far_from_field || needs_link_offsets ||
        result.energy < least_advantage * result.first_pass_energy)
      guess.deviations = m_solver.deviations();
  }

  /// Frees the memory of `improve()`, except for the factors.
  void free_state() { m_solver.free_state(); }

  /// Interpolates a guess for the nodes of this level at the nodes of the finer level.
  void carry(Deviation_guess& guess)
  {
    if (!guess.deviations.empty())
      to_finer(guess.deviations);
    if (!guess.link_offsets.empty())
      to_finer(guess.link_offsets);
  }

  /// The same for the finest level, with less memory: offsets are interpolated when they are read.
  /// `guess` must not be moved or copied afterwards.
  void carry_to_finest(Deviation_guess& guess)
  {
    if (!guess.deviations.empty())
      to_finer(guess.deviations);
    if (!guess.link_offsets.empty())
      guess.link_offset = [this, &guess](std::size_t i) {
        return interpolate(guess.link_offsets, i);
      };
  }

  /// Transfers the new rest shape of the finer level.
  void accept(const Elastic_network& finer)
  {
    for (std::size_t s = 0; s < m_node_of_sample.size(); ++s)
      m_network.rest[s] = finer.rest[m_node_of_sample[s]];
  }

private:
  /// In components where a soft handle has no node, assigns it to the nodes in whose regions its
  /// points lie.
  void draw_nodes_of_soft_handles(const Node_constraints& of_finer)
  {
    auto& of_node = m_constraints.handle_of_node;
    std::set<std::pair<Node_constraint, std::uint32_t>> has_node; // handle and component
    for (std::size_t i = 0; i < of_node.size(); ++i)
      has_node.emplace(of_node[i], m_component[i]);
    for (std::size_t i = 0; i < m_sample_of_node.size(); ++i) {
      const std::uint32_t node = m_sample_of_node[i];
      if (of_finer.is_soft(i) && node != no_sample && of_node[node] == free_node &&
          has_node.count({of_finer.handle_of_node[i], m_component[node]}) == 0)
        of_node[node] = of_finer.handle_of_node[i];
    }
  }

  /// Gives nodes that a handle holds only by nodes in their regions the mean offset of these nodes.
  void set_targets_of_drawn_nodes(const Node_constraints& of_finer, const Node_targets& finer)
  {
    std::vector<double> count(m_network.size(), 0);
    std::vector<Target_offset> mean(m_network.size());
    for (std::size_t i = 0; i < m_sample_of_node.size(); ++i) {
      const std::uint32_t s = m_sample_of_node[i];
      if (s == no_sample || m_constraints.handle_of_node[s] < 0 ||
          of_finer.handle_of_node[i] != m_constraints.handle_of_node[s] ||
          of_finer.handle_of_node[m_node_of_sample[s]] == m_constraints.handle_of_node[s])
        continue;
      count[s] += 1;
      mean[s].blend(1 / count[s], finer[i]);
    }
    for (std::size_t s = 0; s < mean.size(); ++s)
      if (count[s] > 0)
        m_targets.set(s, mean[s]);
  }

  /// Interpolates values of the nodes of this level at a node of the finer level.
  Vec3 interpolate(const std::vector<Vec3>& values, std::size_t i) const
  {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = i * m_links.k; b < (i + 1) * m_links.k; ++b)
      if (m_links.sample[b] != no_sample)
        sum += static_cast<double>(m_links.weight[b]) * values[m_links.sample[b]];
    return sum;
  }

  void to_finer(std::vector<Vec3>& values)
  {
    m_fine.resize(m_sample_of_node.size());
    pcs::internal::for_each_index<ConcurrencyTag>(m_fine.size(), [&](std::size_t i) {
      m_fine[i] = interpolate(values, i);
    });
    if (m_fine.size() <= most_kept_nodes)
      values.assign(m_fine.begin(), m_fine.end()); // reuses the memory of both
    else {
      values.swap(m_fine);
      m_fine = std::vector<Vec3>();
    }
  }

  std::vector<std::uint32_t> m_node_of_sample, m_sample_of_node, m_component;
  Elastic_network m_network;     ///< over the samples
  Border_finder m_border_finder; ///< for the surface of the finer network
  double m_weight_unit = 1;
  Sample_links m_links; ///< from the finer nodes to the samples
  Node_constraints m_constraints;
  Elastic_network m_bounded; ///< with nodes on the borders of the handles
  Node_targets m_targets;    ///< of the nodes of `m_network`
  Elastic_solver<ConcurrencyTag> m_solver;
  std::vector<Vec3> m_fine; ///< values at the nodes of the finer network
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MULTIGRID_COARSE_LEVEL_H

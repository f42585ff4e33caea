// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Harmonic interpolation on a graph: Laplacian with prescribed nodes eliminated.

#ifndef PCS_DEFORMATION_MODEL_HARMONIC_SYSTEM_H
#define PCS_DEFORMATION_MODEL_HARMONIC_SYSTEM_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Node_constraints.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/Sparse_cholesky.h>
#include <pcs/linear_algebra/graph_laplacian.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/// Rows of the unknowns, which are the free and soft nodes in increasing order.
struct Free_rows
{
  std::vector<std::uint32_t> row_of_node;
  std::vector<std::uint32_t> node_of_row;

  explicit Free_rows(const Node_constraints& constraints = {})
  {
    const auto& handle = constraints.handle_of_node;
    row_of_node.assign(handle.size(), linear_algebra::not_free);
    for (std::size_t i = 0; i < handle.size(); ++i)
      if (handle[i] == free_node || constraints.is_soft(i)) {
        row_of_node[i] = static_cast<std::uint32_t>(node_of_row.size());
        node_of_row.push_back(static_cast<std::uint32_t>(i));
      }
  }

  std::size_t size() const { return node_of_row.size(); }
};

/// Finds orders of elimination of a network that apply to all constraints.
inline void rank_nodes(Elastic_network& network)
{
  Node_constraints all_free;
  all_free.handle_of_node.assign(network.size(), free_node);
  const Free_rows rows(all_free);
  const auto order = [&](std::vector<const Weighted_graph*> graphs) {
    return linear_algebra::Cholesky_pattern::minimum_degree_order(
        linear_algebra::free_laplacian(graphs, rows.row_of_node, rows.node_of_row, {}));
  };
  network.surface_rank = order({&network.surface});
  if (!network.links.neighbor.empty())
    network.rank = order({&network.surface, &network.links});
}

/// Returns the ranks of the unknowns; empty if there are no ranks of nodes.
inline std::vector<std::uint32_t> rank_of_rows(const std::vector<std::uint32_t>& rank_of_node,
                                               const Free_rows& rows)
{
  std::vector<std::uint32_t> rank;
  if (!rank_of_node.empty())
    for (const std::uint32_t i : rows.node_of_row)
      rank.push_back(i < rank_of_node.size() ? rank_of_node[i] : i);
  return rank;
}

/// Returns the sum of the edge weights at node `i`, which is the weight of its local terms. [-]
inline double node_degree(const Weighted_graph& graph, std::size_t i)
{
  double sum = 0;
  for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
    sum += graph.weight[e];
  return sum;
}

/// Memory of frames is kept for the next frame up to this number of nodes. A frame of a larger
/// network takes so long that its memory is freed. [count]
constexpr std::size_t most_kept_nodes = 65536;

/*!
  Minimises the Dirichlet energy

      sum_{edges ij} w_ij |u_i - u_j|^2 + sum_{soft i} s_i |u_i - value_i|^2

  over `u` at the free and soft nodes, for given `u` at the prescribed ones. `w_ij` are the weights
  of the graph [-], `s_i` is `Node_constraints::soft_weight()`. The normal equations are `L u = 0`
  at free nodes and `(L u)_i + s_i (u_i - value_i) = 0` at soft ones, with constraints as
  in equation (2.3) of [Aiteanu 2022]. `factor` is the factor of `L` without the prescribed nodes,
  with the `s_i` added on its diagonal. `value(node)` is called for prescribed and soft nodes, and
  then `store(node, u)` for the unknown nodes, both concurrently. `work` may have any content before
  and after the call.
*/
template <class ConcurrencyTag, class Row, class Value, class Store>
void solve_harmonic(const linear_algebra::Sparse_cholesky& factor,
                    const Weighted_graph& graph,
                    const Node_constraints& constraints,
                    const Free_rows& rows,
                    const Value& value,
                    const Store& store,
                    std::vector<Row>& work)
{
  const auto load = [&](std::size_t r) {
    const std::size_t i = rows.node_of_row[r];
    Row b = Row::Zero();
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
      if (constraints.is_prescribed(graph.neighbor[e]))
        b += graph.weight[e] * value(graph.neighbor[e]);
    if (constraints.is_soft(i))
      b += constraints.soft_weight(i, node_degree(graph, i)) * value(i);
    return b;
  };
  factor.solve_each<ConcurrencyTag>(
      load,
      [&](std::size_t r, const Row& u) { store(rows.node_of_row[r], u); },
      work);
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_HARMONIC_SYSTEM_H

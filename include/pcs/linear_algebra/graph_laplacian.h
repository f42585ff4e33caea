// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Assembles the free-free block of weighted graph Laplacians without intermediate triplets.

#ifndef PCS_LINEAR_ALGEBRA_GRAPH_LAPLACIAN_H
#define PCS_LINEAR_ALGEBRA_GRAPH_LAPLACIAN_H

#include <Eigen/SparseCore>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace linear_algebra {

/// The row index of eliminated nodes, whose values are prescribed.
constexpr std::uint32_t not_free = ~std::uint32_t(0);

/*!
  Returns the lower triangle of `L_ff + diag(extra)`: `L` is the Laplacian of the sum of the given
  weighted graphs, `f` the nodes with a row. A graph provides `first`, `neighbor` (rows increasing)
  and `weight`, as `Weighted_graph` does.
  \param row_of_node the row of each node, increasing with the node, or `not_free`
  \param node_of_row its inverse
  \param extra one value per row, or empty
*/
template <class Graph>
Eigen::SparseMatrix<double> free_laplacian(const std::vector<const Graph*>& graphs,
                                           const std::vector<std::uint32_t>& row_of_node,
                                           const std::vector<std::uint32_t>& node_of_row,
                                           const std::vector<double>& extra)
{
  const std::size_t m = node_of_row.size();
  Eigen::SparseMatrix<double> a(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(m));
  std::size_t bound = m;
  for (const Graph* g : graphs)
    bound += g->neighbor.size() / 2 + 1;
  a.reserve(static_cast<Eigen::Index>(bound));
  std::vector<std::size_t> at(graphs.size());
  for (std::size_t column = 0; column < m; ++column) {
    const std::uint32_t i = node_of_row[column];
    const auto c = static_cast<Eigen::Index>(column);
    a.startVec(c);
    double degree = extra.empty() ? 0 : extra[column];
    for (const Graph* g : graphs)
      for (std::size_t e = g->first[i]; e < g->first[i + 1]; ++e)
        degree += g->weight[e];
    a.insertBack(c, c) = degree;
    for (std::size_t k = 0; k < graphs.size(); ++k)
      at[k] = graphs[k]->first[i];
    for (;;) { // merge the rows of all graphs by increasing neighbour
      std::uint32_t next = not_free;
      for (std::size_t k = 0; k < graphs.size(); ++k)
        if (at[k] < graphs[k]->first[i + 1])
          next = std::min(next, graphs[k]->neighbor[at[k]]);
      if (next == not_free)
        break;
      double w = 0;
      for (std::size_t k = 0; k < graphs.size(); ++k)
        if (at[k] < graphs[k]->first[i + 1] && graphs[k]->neighbor[at[k]] == next)
          w += graphs[k]->weight[at[k]++];
      if (next > i && row_of_node[next] != not_free)
        a.insertBack(static_cast<Eigen::Index>(row_of_node[next]), c) = -w;
    }
  }
  a.finalize();
  return a;
}

/*!
  Returns the sums of the rows of `free_laplacian()`: `extra` and the weights of the edges to
  eliminated nodes. Sums of its entries would lose these where other weights are much larger.
*/
template <class Graph>
std::vector<double> free_row_sums(const std::vector<const Graph*>& graphs,
                                  const std::vector<std::uint32_t>& row_of_node,
                                  const std::vector<std::uint32_t>& node_of_row,
                                  const std::vector<double>& extra)
{
  std::vector<double> sums(node_of_row.size(), 0);
  for (std::size_t row = 0; row < sums.size(); ++row) {
    const std::uint32_t i = node_of_row[row];
    sums[row] = extra.empty() ? 0 : extra[row];
    for (const Graph* g : graphs)
      for (std::size_t e = g->first[i]; e < g->first[i + 1]; ++e)
        if (row_of_node[g->neighbor[e]] == not_free)
          sums[row] += g->weight[e];
  }
  return sums;
}

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_GRAPH_LAPLACIAN_H

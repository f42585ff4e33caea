// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Factors of the constant matrices of an elastic network with handles.

#ifndef PCS_DEFORMATION_SOLVER_ELASTIC_FACTORS_H
#define PCS_DEFORMATION_SOLVER_ELASTIC_FACTORS_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <Eigen/SparseCore>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcs {
namespace deformation {

/// Number of unknowns up to which all factors have double precision. Above, entries below the
/// diagonal have relative errors of 1e-13 or, for the smoothing, which is a regularisation, of
/// 1e-6; this changes positions by less than 1e-6 of the extent. [count]
constexpr std::size_t most_exact_rows = 65536;

/// Systems with fewer unknowns are factorised in milliseconds, without calls of the callback, so
/// that the number of calls does not depend on the threads. [count]
constexpr std::size_t least_watched_rows = 10000;

/// Factors for the free and soft nodes, of three systems: the field of the handles, the positions,
/// and the smoothing of deviations.
class Elastic_factors
{
public:
  const Free_rows& rows() const { return m_rows; }
  const linear_algebra::Sparse_cholesky& field() const { return m_field; }
  const linear_algebra::Sparse_cholesky& smoothing() const { return m_smoothing; }
  /// Returns the factor for the positions; without links, it is the factor for the field.
  const linear_algebra::Sparse_cholesky& position() const { return m_has_links ? m_link : m_field; }
  /// Returns `mu D` of a row, the weight of the best local rotation relative to the neighbours.
  double fit_weight(std::size_t row) const { return m_fit_weight[row]; }

  /// Returns `false` if a matrix is singular (a free component without handle), or if `go_on` does.
  /// The factors must not be used then. \param is_exact whether a small network has factors in
  /// double precision
  template <class ConcurrencyTag>
  bool factorize(const Elastic_network& network,
                 const Node_constraints& constraints,
                 double stiffness,
                 const pcs::internal::Go_on& go_on = {},
                 bool is_exact = true)
  {
    m_rows = Free_rows(constraints);
    m_is_exact = is_exact && m_rows.size() <= most_exact_rows;
    const bool is_watched = go_on && m_rows.size() >= least_watched_rows;
    const pcs::internal::Go_on asks = is_watched ? go_on : pcs::internal::Go_on();
    m_has_links = !network.links.neighbor.empty();
    std::vector<double> soft, smoothing;
    weigh_rows(network, constraints, stiffness, soft, smoothing);
    const auto assemble = [&](std::vector<const Weighted_graph*> graphs,
                              const std::vector<double>& extra) {
      return linear_algebra::free_laplacian(graphs, m_rows.row_of_node, m_rows.node_of_row, extra);
    };
    const auto row_sums = [&](std::vector<const Weighted_graph*> graphs,
                              const std::vector<double>& extra) {
      return linear_algebra::free_row_sums(graphs, m_rows.row_of_node, m_rows.node_of_row, extra);
    };
    const Weighted_graph* surface = &network.surface;
    bool position_ok = true;
    const Eigen::SparseMatrix<double> of_field = assemble({surface}, soft);
    std::shared_ptr<linear_algebra::Cholesky_pattern> pattern;
    invoke_both<ConcurrencyTag>(
        asks,
        [&] {
          pattern = std::make_shared<linear_algebra::Cholesky_pattern>(
              of_field,
              rank_of_rows(network.surface_rank, m_rows),
              pcs::internal::part_of(asks, 0, 0.2));
        },
        [&] {
          if (m_has_links)
            position_ok = factorize_links(assemble({surface, &network.links}, soft),
                                          rank_of_rows(network.rank, m_rows),
                                          row_sums({surface, &network.links}, soft),
                                          pcs::internal::part_of(asks, 0.2, 0.6));
        });
    if (!pattern->is_complete() || !position_ok)
      return false;
    const bool is_regular = factorize_surface<ConcurrencyTag>(
        of_field,
        pattern,
        [&] { return row_sums({surface}, soft); },
        [&] { return row_sums({surface}, smoothing); },
        asks);
    pattern->forget_places();
    return is_regular;
  }

private:
  /// Runs two functions, and asks `asks`, unless it is empty, while it waits.
  template <class ConcurrencyTag, class F, class G>
  static void invoke_both(const pcs::internal::Go_on& asks, const F& f, const G& g)
  {
    if (asks)
      pcs::internal::invoke_both<ConcurrencyTag>(f, g, [&] { asks(0); });
    else
      pcs::internal::invoke_both<ConcurrencyTag>(f, g);
  }

  /// Finds the weights of the springs of soft nodes, and these weights with those of the rotations.
  void weigh_rows(const Elastic_network& network,
                  const Node_constraints& constraints,
                  double stiffness,
                  std::vector<double>& soft,
                  std::vector<double>& smoothing)
  {
    m_fit_weight.resize(m_rows.size());
    soft.assign(m_rows.size(), 0);
    smoothing.assign(m_rows.size(), 0);
    for (std::size_t r = 0; r < m_rows.size(); ++r) {
      const std::size_t i = m_rows.node_of_row[r];
      const double degree = node_degree(network.surface, i);
      if (constraints.is_soft(i))
        soft[r] = constraints.soft_weight(i, degree);
      m_fit_weight[r] = default_fit_weight / stiffness * relative_area(network, i) * degree;
      smoothing[r] = soft[r] + m_fit_weight[r];
    }
  }

  /// Factorises the matrices of the field and of the smoothing, which differ in their diagonals
  /// only. \param field_sums, smoothing_sums return the sums of their rows
  template <class ConcurrencyTag, class Field_sums, class Smoothing_sums>
  bool factorize_surface(const Eigen::SparseMatrix<double>& a,
                         const std::shared_ptr<const linear_algebra::Cholesky_pattern>& pattern,
                         const Field_sums& field_sums,
                         const Smoothing_sums& smoothing_sums,
                         const pcs::internal::Go_on& asks)
  {
    bool field_ok = false, smoothing_ok = false;
    using linear_algebra::Value_size;
    invoke_both<ConcurrencyTag>(
        asks,
        [&] {
          field_ok = m_field.factorize(a,
                                       pattern,
                                       field_sums(),
                                       pcs::internal::part_of(asks, 0.6, 1),
                                       m_is_exact ? Value_size::eight : Value_size::six);
        },
        [&] {
          smoothing_ok = m_smoothing.factorize(a,
                                               pattern,
                                               smoothing_sums(),
                                               pcs::internal::part_of(asks, 0.2, 0.6),
                                               m_is_exact ? Value_size::eight : Value_size::three);
        });
    return field_ok && smoothing_ok;
  }

  bool factorize_links(const Eigen::SparseMatrix<double>& a,
                       const std::vector<std::uint32_t>& rank,
                       const std::vector<double>& row_sums,
                       const pcs::internal::Go_on& go_on)
  {
    const auto pattern = std::make_shared<linear_algebra::Cholesky_pattern>(a, rank, go_on);
    const auto value_size =
        m_is_exact ? linear_algebra::Value_size::eight : linear_algebra::Value_size::six;
    if (!pattern->is_complete() || !m_link.factorize(a, pattern, row_sums, go_on, value_size))
      return false;
    pattern->forget_places();
    return true;
  }

  /// Returns the area of a node in units of a node of the reference network.
  static double relative_area(const Elastic_network& network, std::size_t node)
  {
    const double area = node < network.area.size() ? reference_size * network.area[node] : 1;
    return std::min(largest_relative_area, std::max(smallest_relative_area, area));
  }

  Free_rows m_rows;
  linear_algebra::Sparse_cholesky m_field, m_link, m_smoothing;
  std::vector<double> m_fit_weight; ///< of each row, multiplied by its degree
  bool m_has_links = false, m_is_exact = true;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_ELASTIC_FACTORS_H

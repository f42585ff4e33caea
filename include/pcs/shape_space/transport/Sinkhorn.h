// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Entropic optimal transport (Sinkhorn) on a sparse list of arcs, in the log domain.

#ifndef PCS_SHAPE_SPACE_TRANSPORT_SINKHORN_H
#define PCS_SHAPE_SPACE_TRANSPORT_SINKHORN_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/transport/Transport_simplex.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Potentials of an entropic transport, and the plan that they define.
class Sinkhorn_potentials
{
public:
  Sinkhorn_potentials(const Transport_problem& problem, double epsilon)
    : m_problem(problem),
      m_epsilon(epsilon),
      m_f(problem.supplies.size(), 0),
      m_g(problem.demands.size(), 0)
  {
  }

  double epsilon() const { return m_epsilon; }
  void set_epsilon(double epsilon) { m_epsilon = epsilon; }

  double mass(const Transport_problem::Arc& a) const { return std::exp(logarithm(a)); }

  /// Makes the sums of all sources or of all targets exact:
  /// potential += epsilon (log weight - log sum of the plan).
  void project(bool is_source)
  {
    std::vector<double>& potential = is_source ? m_f : m_g;
    const std::vector<double>& weight = is_source ? m_problem.supplies : m_problem.demands;
    m_top.assign(potential.size(), -std::numeric_limits<double>::infinity());
    m_sum.assign(potential.size(), 0);
    for (const Transport_problem::Arc& a : m_problem.arcs) {
      double& t = m_top[is_source ? a.source : a.target];
      t = std::max(t, logarithm(a));
    }
    for (const Transport_problem::Arc& a : m_problem.arcs) {
      const std::size_t i = is_source ? a.source : a.target;
      m_sum[i] += std::exp(logarithm(a) - m_top[i]);
    }
    for (std::size_t i = 0; i < potential.size(); ++i)
      if (m_sum[i] > 0)
        potential[i] += m_epsilon * (std::log(weight[i]) - m_top[i] - std::log(m_sum[i]));
  }

  /// Returns the sum of the absolute differences of all sums from supplies and demands. [-]
  double violation() const
  {
    const std::size_t n = m_problem.supplies.size();
    std::vector<double> defect(m_problem.supplies);
    defect.insert(defect.end(), m_problem.demands.begin(), m_problem.demands.end());
    for (const Transport_problem::Arc& a : m_problem.arcs) {
      const double m = mass(a);
      defect[a.source] -= m;
      defect[n + a.target] -= m;
    }
    double total = 0;
    for (const double d : defect)
      total += std::abs(d);
    return total;
  }

private:
  double logarithm(const Transport_problem::Arc& a) const
  {
    return (m_f[a.source] + m_g[a.target] - a.cost) / m_epsilon;
  }

  const Transport_problem& m_problem;
  double m_epsilon;
  std::vector<double> m_f, m_g, m_top, m_sum;
};

/// Returns the largest cost of an arc, or 1 if no arc costs anything.
inline double unit_of_costs(const Transport_problem& problem)
{
  double largest = 0;
  for (const Transport_problem::Arc& a : problem.arcs)
    largest = std::max(largest, a.cost);
  return largest > 0 ? largest : 1;
}

} // namespace internal

/*!
  Solves an entropic optimal transport by alternating projections (M. Cuturi, 2013), as in section
  4.8 of \cite aiteanu2022. Minimises, over the masses `P_a >= 0` [-] of the arcs `a`,

      sum_a P_a c_a + epsilon sum_a P_a (ln P_a - 1)

  subject to `sum_{a from i} P_a = s_i` and `sum_{a to j} P_a = t_j`, with the costs `c_a`, [L] or
  [L^2] as given, and the supplies `s_i` and demands `t_j` [-], which both sum to one. The minimum
  is `P_a = exp((f_i + g_j - c_a) / epsilon)`. An iteration makes the sums of all sources exact,
  then the sums of all targets, by the potentials:

      f_i += epsilon ln(s_i / sum_{a from i} P_a),   g_j += epsilon ln(t_j / sum_{a to j} P_a).

  `epsilon` is halved every 20 iterations, from the largest cost to `regularization` times the
  largest cost. With the last `epsilon`, at most `iterations` iterations are made, until the sum of
  all violations of the constraints is below `tolerance`. `cost` does not include the entropy. All
  arcs have a flow, so `is_unmet` is 0 for all points. If the arcs do not admit the marginals, the
  violation stays large and is reported. O(arcs) for each iteration.
*/
inline Transport_plan sinkhorn(const Transport_problem& problem, const Sinkhorn_options& options)
{
  constexpr std::size_t passes_per_step = 20;
  const double largest = internal::unit_of_costs(problem);
  const double last = options.regularization * largest;
  internal::Sinkhorn_potentials potentials(problem, largest);
  for (;;) {
    const bool is_last = potentials.epsilon() <= last;
    const std::size_t passes = is_last ? options.iterations : passes_per_step;
    for (std::size_t i = 0; i < passes; ++i) {
      potentials.project(true);
      potentials.project(false);
      if (is_last && i % passes_per_step == passes_per_step - 1 &&
          potentials.violation() < options.tolerance)
        break;
    }
    if (is_last)
      break;
    potentials.set_epsilon(std::max(last, 0.5 * potentials.epsilon()));
  }

  Transport_plan plan;
  plan.violation = potentials.violation();
  plan.is_complete = plan.violation < options.tolerance;
  plan.is_unmet.assign(problem.supplies.size() + problem.demands.size(), 0);
  for (std::size_t k = 0; k < problem.arcs.size(); ++k) {
    const double mass = potentials.mass(problem.arcs[k]);
    plan.cost += mass * problem.arcs[k].cost;
    plan.flows.push_back({static_cast<std::uint32_t>(k), mass});
  }
  return plan;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TRANSPORT_SINKHORN_H

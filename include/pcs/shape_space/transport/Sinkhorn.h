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

/*!
  Entropic optimal transport by alternating projections (M. Cuturi, 2013), as in section 4.8 of
  \cite aiteanu2022. Minimises, over the masses `P_a >= 0` [-] of the arcs `a`,

      sum_a P_a c_a + epsilon sum_a P_a (ln P_a - 1)

  subject to `sum_{a from i} P_a = s_i` and `sum_{a to j} P_a = t_j`, with the costs `c_a`, [L] or
  [L^2] as given, and the supplies `s_i` and demands `t_j` [-], which both sum to one. The minimum
  is `P_a = exp((f_i + g_j - c_a) / epsilon)`. A pass makes the sums of all sources exact, then
  those of all targets, by the potentials:

      f_i += epsilon ln(s_i / sum_{a from i} P_a),   g_j += epsilon ln(t_j / sum_{a to j} P_a).

  `epsilon` is halved every 20 passes, from the largest cost to `regularization` times that. There,
  at most `iterations` passes are made, until the sum of all violations of the constraints is below
  `tolerance`. `cost` is without the entropy. All arcs have a flow. With arcs that do not admit the
  marginals, the violation stays large: it is reported. O(arcs) for each pass.
*/
inline Transport_plan sinkhorn(const Transport_problem& problem, const Sinkhorn_options& options)
{
  const std::size_t n = problem.supplies.size(), m = problem.demands.size();
  double largest = 0;
  for (const Transport_problem::Arc& a : problem.arcs)
    largest = std::max(largest, a.cost);
  if (!(largest > 0))
    largest = 1;
  std::vector<double> f(n, 0), g(m, 0), top, sum;
  double epsilon = largest;
  const auto logarithm = [&](const Transport_problem::Arc& a) {
    return (f[a.source] + g[a.target] - a.cost) / epsilon;
  };
  // potential += epsilon (log weight - log sum of the plan); a side at a time
  const auto project = [&](bool is_source) {
    std::vector<double>& potential = is_source ? f : g;
    const std::vector<double>& weight = is_source ? problem.supplies : problem.demands;
    top.assign(potential.size(), -std::numeric_limits<double>::infinity());
    sum.assign(potential.size(), 0);
    for (const Transport_problem::Arc& a : problem.arcs) {
      double& t = top[is_source ? a.source : a.target];
      t = std::max(t, logarithm(a));
    }
    for (const Transport_problem::Arc& a : problem.arcs) {
      const std::size_t i = is_source ? a.source : a.target;
      sum[i] += std::exp(logarithm(a) - top[i]);
    }
    for (std::size_t i = 0; i < potential.size(); ++i)
      if (sum[i] > 0)
        potential[i] += epsilon * (std::log(weight[i]) - top[i] - std::log(sum[i]));
  };
  const auto violation = [&] {
    std::vector<double> defect(problem.supplies);
    defect.insert(defect.end(), problem.demands.begin(), problem.demands.end());
    for (const Transport_problem::Arc& a : problem.arcs) {
      const double mass = std::exp(logarithm(a));
      defect[a.source] -= mass;
      defect[n + a.target] -= mass;
    }
    double total = 0;
    for (const double d : defect)
      total += std::abs(d);
    return total;
  };
  const double last = options.regularization * largest;
  for (;;) {
    const bool is_last = epsilon <= last;
    const std::size_t passes = is_last ? options.iterations : 20;
    for (std::size_t i = 0; i < passes; ++i) {
      project(true);
      project(false);
      if (is_last && i % 20 == 19 && violation() < options.tolerance)
        break;
    }
    if (is_last)
      break;
    epsilon = std::max(last, 0.5 * epsilon);
  }

  Transport_plan plan;
  plan.violation = violation();
  plan.is_complete = plan.violation < options.tolerance;
  plan.is_unmet.assign(n + m, 0);
  for (std::size_t k = 0; k < problem.arcs.size(); ++k) {
    const Transport_problem::Arc& a = problem.arcs[k];
    const double mass = std::exp(logarithm(a));
    plan.cost += mass * a.cost;
    plan.flows.push_back({static_cast<std::uint32_t>(k), mass});
  }
  return plan;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TRANSPORT_SINKHORN_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Partial optimal transport within a limited distance.

#ifndef PCS_SHAPE_SPACE_TRANSPORT_PARTIAL_TRANSPORT_H
#define PCS_SHAPE_SPACE_TRANSPORT_PARTIAL_TRANSPORT_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/transport/Sinkhorn.h>
#include <pcs/shape_space/transport/Transport_simplex.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace shape_space {

/// Solves a transport by the method that `options` select.
inline Transport_plan solve_transport(const Transport_problem& problem,
                                      const Transport_options& options)
{
  return options.method == Point_transport::sinkhorn ? sinkhorn(problem, options.sinkhorn)
                                                     : Transport_simplex()(problem);
}

/*!
  Solves a partial transport (L. Caffarelli and R. McCann, 2010): mass of either side may stay
  unmoved at the price `p > 0` per unit, in the unit of the costs. Minimises, over the masses `P_a
  >= 0` [-] of the arcs `a`,

      sum_a P_a c_a + p (sum_i (s_i - sum_{a from i} P_a) + sum_j (t_j - sum_{a to j} P_a))

  where no difference is negative, with the costs `c_a`, [L] or [L^2] as given, and the supplies
  `s_i` and demands `t_j` [-], which both sum to one. An arc `a` can reduce the sum only if
  `c_a < 2 p`; all others are left out.

  One additional source and one additional target, each of mass 1, take the mass that stays, over
  arcs of cost `p` from all sources and to all targets; the arc between them costs nothing. All
  masses are halved, so that the supplies and the demands of this complete transport sum to one; it
  is found by `solve_transport()`. `cost` does not include the price. `problem` may have no arcs;
  n + m + 1 arcs are added. With `Point_transport::sinkhorn` every arc has a flow, so `is_unmet`
  marks all points; with `exact`, it marks the points that keep mass.
*/
inline Transport_plan
solve_partially(const Transport_problem& problem, double price, const Transport_options& options)
{
  const std::size_t n = problem.supplies.size(), m = problem.demands.size();
  const auto rest_source = static_cast<std::uint32_t>(n);
  const auto rest_target = static_cast<std::uint32_t>(m);
  Transport_problem extended;
  const auto halved_and_rest = [](const std::vector<double>& weights) {
    std::vector<double> result;
    for (const double w : weights)
      result.push_back(0.5 * w);
    result.push_back(0.5);
    return result;
  };
  extended.supplies = halved_and_rest(problem.supplies);
  extended.demands = halved_and_rest(problem.demands);
  std::vector<std::uint32_t> original;
  for (std::size_t k = 0; k < problem.arcs.size(); ++k)
    if (problem.arcs[k].cost < 2 * price) {
      extended.arcs.push_back(problem.arcs[k]);
      original.push_back(static_cast<std::uint32_t>(k));
    }
  for (std::uint32_t i = 0; i < n; ++i)
    extended.arcs.push_back({i, rest_target, price});
  for (std::uint32_t j = 0; j < m; ++j)
    extended.arcs.push_back({rest_source, j, price});
  extended.arcs.push_back({rest_source, rest_target, 0});
  const Transport_plan found = solve_transport(extended, options);

  Transport_plan plan;
  plan.violation = 2 * found.violation;
  plan.is_complete = found.is_complete;
  plan.number_of_pivots = found.number_of_pivots;
  plan.is_unmet.assign(n + m, 0);
  plan.remaining = 1;
  for (const Transport_plan::Flow& f : found.flows)
    if (const Transport_problem::Arc& a = extended.arcs[f.arc]; f.arc < original.size()) {
      plan.flows.push_back({original[f.arc], 2 * f.mass});
      plan.cost += 2 * f.mass * a.cost;
      plan.remaining -= 2 * f.mass;
    } else if (a.target == rest_target && a.source != rest_source)
      plan.is_unmet[a.source] = 1;
    else if (a.source == rest_source && a.target != rest_target)
      plan.is_unmet[n + a.target] = 1;
  plan.remaining = std::max(0.0, plan.remaining);
  return plan;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TRANSPORT_PARTIAL_TRANSPORT_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random transport problems with an independent solver, and points on a cylinder.

#ifndef PCS_TEST_SUPPORT_TRANSPORT_H
#define PCS_TEST_SUPPORT_TRANSPORT_H

#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/points/point_correspondences.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace transport_test {

using namespace pcs::shape_space;

/// Random supplies, demands and costs; a fraction `density` of all arcs exists.
inline Transport_problem
random_problem(std::mt19937& random, std::size_t n, std::size_t m, double density)
{
  std::uniform_real_distribution<double> uniform(0, 1);
  Transport_problem problem;
  for (std::size_t i = 0; i < n; ++i)
    problem.supplies.push_back(0.1 + uniform(random));
  for (std::size_t j = 0; j < m; ++j)
    problem.demands.push_back(0.1 + uniform(random));
  problem.supplies = pcs::shape_space::internal::to_shares(problem.supplies);
  problem.demands = pcs::shape_space::internal::to_shares(problem.demands);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j)
      if (uniform(random) < density)
        problem.arcs.push_back({i, j, uniform(random)});
  return problem;
}

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Carried
{
  double cost = 0, mass = 0;
};

/// Successive shortest paths by Bellman and Ford, in doubles, while one is shorter than `limit`.
inline Carried least_cost(const Transport_problem& problem, double limit = infinite)
{
  const std::size_t n = problem.supplies.size(), m = problem.demands.size();
  std::vector<double> supply = problem.supplies, demand = problem.demands;
  std::vector<double> flow(problem.arcs.size(), 0);
  Carried result;
  for (;;) {
    std::vector<double> distance(n + m, infinite);
    std::vector<std::size_t> arc(n + m, none);
    for (std::size_t i = 0; i < n; ++i)
      if (supply[i] > 1e-14)
        distance[i] = 0;
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      for (std::size_t k = 0; k < problem.arcs.size(); ++k) {
        const auto& a = problem.arcs[k];
        if (distance[a.source] + a.cost < distance[n + a.target] - 1e-13) {
          distance[n + a.target] = distance[a.source] + a.cost;
          arc[n + a.target] = k;
          is_changed = true;
        }
        if (flow[k] > 1e-14 && distance[n + a.target] - a.cost < distance[a.source] - 1e-13) {
          distance[a.source] = distance[n + a.target] - a.cost;
          arc[a.source] = k;
          is_changed = true;
        }
      }
    }
    std::size_t end = none;
    for (std::size_t j = 0; j < m; ++j)
      if (demand[j] > 1e-14 && (end == none || distance[n + j] < distance[n + end]))
        end = j;
    if (end == none || !(distance[n + end] < limit))
      return result;
    double step = demand[end];
    std::size_t v = n + end;
    while (arc[v] != none) {
      const auto& a = problem.arcs[arc[v]];
      if (v >= n)
        v = a.source;
      else {
        step = std::min(step, flow[arc[v]]);
        v = n + a.target;
      }
    }
    step = std::min(step, supply[v]);
    supply[v] -= step;
    demand[end] -= step;
    result.cost += step * distance[n + end];
    result.mass += step;
    for (v = n + end; arc[v] != none;) {
      const auto& a = problem.arcs[arc[v]];
      const bool is_forward = v >= n;
      flow[arc[v]] += is_forward ? step : -step;
      v = is_forward ? std::size_t(a.source) : n + a.target;
    }
  }
}

/// Random points on a cylinder of radius 1 and height 6.
inline std::vector<Vec3> cylinder(std::mt19937& random, std::size_t n)
{
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * pcs::internal::pi * uniform(random);
    points.push_back(Vec3(std::cos(angle), std::sin(angle), 6 * uniform(random)));
  }
  return points;
}

inline pcs::Transport_options all_is_carried()
{
  pcs::Transport_options options;
  options.reach = infinite;
  return options;
}

/// Mean distance to the nearest neighbour.
inline double mean_spacing(const std::vector<Vec3>& points)
{
  const pcs::neighborhood::Nearest_neighbors search(points);
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
  double sum = 0;
  for (const Vec3& p : points) {
    search(p, 2, found);
    sum += std::sqrt(found[1].squared_distance);
  }
  return sum / static_cast<double>(points.size());
}

} // namespace transport_test

#endif // PCS_TEST_SUPPORT_TRANSPORT_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Transport between two sets of points in the same place; every point gets a partner.

#ifndef PCS_SHAPE_SPACE_MATCH_POINTS_H
#define PCS_SHAPE_SPACE_MATCH_POINTS_H

#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/Places.h>
#include <pcs/shape_space/Rooted_tree.h>
#include <pcs/shape_space/Sinkhorn.h>
#include <pcs/shape_space/Transport_options.h>
#include <pcs/shape_space/Transport_simplex.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Squared distance to the fifth neighbour, within limits: the surface that a point stands for, up to a factor. What is alone
/// beside a surface stands for next to nothing: it would draw all that are near to itself.
inline std::vector<double> area_weights(const std::vector<Vec3>& points,
                                        const neighborhood::Nearest_neighbors& search)
{
  constexpr std::size_t neighbor = 5;
  constexpr double most_of_neighbors = 4; // densities change by less between neighbours
  std::vector<double> area(points.size(), 1);
  std::vector<std::array<std::uint32_t, neighbor>> near(points.size());
  std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    search(points[i], neighbor + 1, found);
    area[i] = found.back().squared_distance;
    near[i].fill(static_cast<std::uint32_t>(i));
    for (std::size_t k = 1; k < found.size(); ++k)
      near[i][k - 1] = found[k].index;
  }
  const std::vector<double> alone(area);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<double, neighbor> others;
    for (std::size_t k = 0; k < neighbor; ++k)
      others[k] = alone[near[i][k]];
    std::nth_element(others.begin(), others.begin() + neighbor / 2, others.end());
    if (area[i] > most_of_neighbors * others[neighbor / 2])
      area[i] = 0;
  }
  std::vector<double> sorted(area);
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = *middle;
  for (double& a : area) // points that nearly coincide stand for little, outliers not for all
    a = median > 0 ? std::min(16 * median, std::max(median / 64, a)) : 1;
  return area;
}

inline std::vector<double> to_shares(std::vector<double> weights)
{
  double sum = 0;
  for (const double w : weights)
    sum += w;
  for (double& w : weights)
    w /= sum;
  return weights;
}

/// What is far from all points of the other tree, as opposite of a gap of its scan, has no partner there: with its full weight
/// it would draw all that is between. Weights, which come as areas, fall with the square of the distance, `squared` of each,
/// from 1.5 times the median on. The median is at least a quarter of the spacing: most points of two trees may be the same.
inline void lower_lonely(std::vector<double>& areas, const std::vector<double>& squared)
{
  constexpr double near = 1.5, least = 1. / 64, spacing = 1. / 4;
  const auto median = [](std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const double limit = near * near * std::max(median(squared), spacing * spacing * median(areas));
  for (std::size_t i = 0; i < areas.size(); ++i)
    if (squared[i] > limit)
      areas[i] *= std::max(least, limit / squared[i]);
}

/// Shares of the whole: as an area, all points of a place stand for one. `squared`: distance to the nearest place of the other
/// tree.
inline std::vector<double> weights_of(const Places& places,
                                      const neighborhood::Nearest_neighbors& search,
                                      const std::vector<double>& squared,
                                      Point_weights kind)
{
  if (kind == Point_weights::area) {
    std::vector<double> areas = area_weights(places.positions(), search);
    lower_lonely(areas, squared);
    return to_shares(std::move(areas));
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < places.positions().size(); ++i)
    numbers.push_back(static_cast<double>(places.size(i)));
  return to_shares(std::move(numbers));
}

} // namespace internal

/// The arcs that carry most of what leaves a source or reaches a target: every point keeps a partner, and few have two.
inline std::vector<std::uint32_t> main_arcs(const Transport_problem& problem,
                                            const Transport_plan& plan)
{
  const std::size_t n = problem.supplies.size();
  std::vector<std::size_t> best(n + problem.demands.size(), none); // index in flows
  for (std::size_t k = 0; k < plan.flows.size(); ++k) {
    const Transport_problem::Arc& a = problem.arcs[plan.flows[k].arc];
    for (const std::size_t v : {std::size_t(a.source), n + a.target})
      if (best[v] == none || plan.flows[k].mass > plan.flows[best[v]].mass)
        best[v] = k;
  }
  std::sort(best.begin(), best.end());
  best.erase(std::unique(best.begin(), best.end()), best.end());
  std::vector<std::uint32_t> arcs;
  for (const std::size_t k : best)
    if (k != none)
      arcs.push_back(plan.flows[k].arc);
  return arcs;
}

/// Transport between two sets of places where points are; every place gets a partner. Candidates are nearest neighbours both
/// ways; for places whose mass they cannot carry more are taken, until all is carried.
inline Transport_plan match_places(const Places& places_1,
                                   const Places& places_2,
                                   const Transport_options& options,
                                   Transport_problem& problem)
{
  const std::vector<Vec3>&one = places_1.positions(), &two = places_2.positions();
  const neighborhood::Nearest_neighbors search_1(one), search_2(two);
  const std::size_t n = one.size(), m = two.size();
  std::vector<double> squared_1(n), squared_2(m); // distances to the nearest of the other tree
  problem.supplies.clear();
  std::vector<std::size_t> wanted(n + m, options.number_of_neighbors);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> arcs;
  std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  Transport_plan plan;
  for (;;) {
    arcs.clear();
    for (std::size_t i = 0; i < n; ++i) {
      search_2(one[i], wanted[i], found);
      squared_1[i] = found[0].squared_distance;
      for (const auto& f : found)
        arcs.emplace_back(static_cast<std::uint32_t>(i), f.index);
    }
    for (std::size_t j = 0; j < m; ++j) {
      search_1(two[j], wanted[n + j], found);
      squared_2[j] = found[0].squared_distance;
      for (const auto& f : found)
        arcs.emplace_back(f.index, static_cast<std::uint32_t>(j));
    }
    if (problem.supplies.empty()) {
      problem.supplies = internal::weights_of(places_1, search_1, squared_1, options.weights);
      problem.demands = internal::weights_of(places_2, search_2, squared_2, options.weights);
    }
    std::sort(arcs.begin(), arcs.end());
    arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
    problem.arcs.clear();
    for (const auto& [i, j] : arcs)
      problem.arcs.push_back(
          {i, j, options.is_squared ? (one[i] - two[j]).squaredNorm() : (one[i] - two[j]).norm()});
    if (options.method == Point_transport::sinkhorn)
      return sinkhorn(problem, options.sinkhorn);
    plan = Transport_simplex()(problem);
    bool can_grow = false;
    for (std::size_t v = 0; v < n + m; ++v)
      if (plan.is_unmet[v] && wanted[v] < (v < n ? m : n)) {
        wanted[v] *= 4;
        can_grow = true;
      }
    if (!can_grow)
      return plan;
  }
}

/// Pairs of points of two sets in the same place, and how well they were found.
struct Point_matches
{
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  double violation = 0;
  bool is_complete = false;
};

/// Every point gets a partner, unless the plan is not complete.
inline Point_matches match_points(const std::vector<Vec3>& one,
                                  const std::vector<Vec3>& two,
                                  const Transport_options& options)
{
  const Places places_1(one), places_2(two);
  Transport_problem problem;
  const Transport_plan plan = match_places(places_1, places_2, options, problem);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const std::uint32_t k : main_arcs(problem, plan))
    pairs.emplace_back(problem.arcs[k].source, problem.arcs[k].target);
  return {pairs_of_points(places_1, places_2, pairs), plan.violation, plan.is_complete};
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCH_POINTS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Optimal transport between two sets of points, with a nearest-neighbour fallback.

#ifndef PCS_SHAPE_SPACE_POINTS_MATCH_POINTS_H
#define PCS_SHAPE_SPACE_POINTS_MATCH_POINTS_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/median.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/model/Rooted_tree.h>
#include <pcs/shape_space/points/Distinct_positions.h>
#include <pcs/shape_space/transport/partial_transport.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Estimates the surface area of each point, up to a factor, by the squared distance to the fifth
/// neighbour, within limits [L^2]. Isolated points beside a surface get the least weight, as they
/// would attract all points near them.
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
    if (area[i] > most_of_neighbors * pcs::internal::upper_median(others.begin(), others.end()))
      area[i] = 0;
  }
  std::vector<double> sorted(area);
  const double median = pcs::internal::upper_median(sorted);
  for (double& a : area) // limits the weights of nearly coincident points and of outliers
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

/// Returns the weights of positions, which sum to one. With areas, coincident points
/// count once. [-]
inline std::vector<double>
weights_of(const Distinct_positions& places, const std::vector<double>& areas, Point_weights kind)
{
  if (kind == Point_weights::area)
    return to_shares(areas);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < places.positions().size(); ++i)
    numbers.push_back(static_cast<double>(places.size(i)));
  return to_shares(std::move(numbers));
}

/// Returns the usual distance of corresponding points: the median distance to the nearest point of
/// the other tree, but at least a quarter of the point spacing, as most points may coincide [L].
/// Arguments are squared distances.
inline double usual_distance(std::vector<double> squared, std::vector<double> areas)
{
  constexpr double least = 1. / 4;
  return std::sqrt(std::max(pcs::internal::upper_median(squared),
                            least * least * pcs::internal::upper_median(areas)));
}

/// Returns an upper bound for the distance of any two points: the diagonal of the bounding box. [L]
inline double extent(const std::vector<Vec3>& one, const std::vector<Vec3>& two)
{
  Vec3 low = one[0], high = one[0];
  for (const std::vector<Vec3>* points : {&one, &two})
    for (const Vec3& p : *points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  return (high - low).norm();
}

/// Finds the sources that keep mass although a target within `reach` also keeps mass: an arc
/// between both would have moved mass.
inline std::vector<std::size_t> sources_that_lack_arcs(const std::vector<Vec3>& one,
                                                       const std::vector<Vec3>& two,
                                                       const Transport_plan& plan,
                                                       double reach)
{
  std::vector<std::size_t> sources;
  std::vector<Vec3> targets;
  for (std::size_t i = 0; i < one.size(); ++i)
    if (plan.is_unmet[i])
      sources.push_back(i);
  for (std::size_t j = 0; j < two.size(); ++j)
    if (plan.is_unmet[one.size() + j])
      targets.push_back(two[j]);
  if (targets.empty())
    return {};
  const neighborhood::Nearest_neighbors search(targets);
  std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  const auto is_far = [&](std::size_t i) {
    search(one[i], 1, found);
    return found[0].squared_distance >= reach * reach;
  };
  sources.erase(std::remove_if(sources.begin(), sources.end(), is_far), sources.end());
  return sources;
}

} // namespace internal

/// Returns, for each source and each target, the arc with the most mass, or the cheapest arc if
/// none has mass: every point has a corresponding point, and few have two. Arcs are sorted by
/// source, with the arc chosen for the source first.
inline std::vector<std::uint32_t> main_arcs(const Transport_problem& problem,
                                            const Transport_plan& plan)
{
  const std::size_t n = problem.supplies.size();
  struct Choice
  {
    std::size_t arc = none;
    double mass = 0;
  };
  std::vector<Choice> best(n + problem.demands.size());
  for (const Transport_plan::Flow& f : plan.flows)
    for (const std::size_t v :
         {std::size_t(problem.arcs[f.arc].source), n + problem.arcs[f.arc].target})
      if (f.mass > best[v].mass)
        best[v] = {f.arc, f.mass};
  for (std::size_t k = 0; k < problem.arcs.size(); ++k)
    for (const std::size_t v : {std::size_t(problem.arcs[k].source), n + problem.arcs[k].target})
      if (best[v].mass == 0 &&
          (best[v].arc == none || problem.arcs[k].cost < problem.arcs[best[v].arc].cost))
        best[v].arc = k;
  std::vector<std::uint32_t> arcs;
  for (const Choice& c : best)
    if (c.arc != none)
      arcs.push_back(static_cast<std::uint32_t>(c.arc));
  const auto rank = [&](std::uint32_t k) {
    const std::uint32_t source = problem.arcs[k].source;
    return std::make_tuple(source, best[source].arc != k, k);
  };
  std::sort(arcs.begin(), arcs.end(), [&](std::uint32_t a, std::uint32_t b) {
    return rank(a) < rank(b);
  });
  arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
  return arcs;
}

/// Finds the transport between two sets of distinct positions. Mass is moved no farther than the
/// reach, and the rest stays. Candidates are nearest neighbours in both directions; sources that
/// keep mass although targets that keep mass are within reach get more candidates.
inline Transport_plan match_places(const Distinct_positions& places_1,
                                   const Distinct_positions& places_2,
                                   const Transport_options& options,
                                   Transport_problem& problem)
{
  const std::vector<Vec3>&one = places_1.positions(), &two = places_2.positions();
  const neighborhood::Nearest_neighbors search_1(one), search_2(two);
  const std::size_t n = one.size(), m = two.size();
  problem = Transport_problem();
  std::vector<std::size_t> wanted(n + m, options.number_of_neighbors); // candidates of each
  std::vector<double> nearest(n + m); // squared distances to the other side
  std::vector<std::pair<std::uint32_t, std::uint32_t>> arcs;
  std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  double reach = 0;
  for (;;) {
    arcs.clear();
    for (std::size_t v = 0; v < n + m; ++v) {
      const bool is_first = v < n;
      (is_first ? search_2 : search_1)(is_first ? one[v] : two[v - n], wanted[v], found);
      nearest[v] = found.front().squared_distance;
      for (const auto& f : found)
        arcs.emplace_back(is_first ? static_cast<std::uint32_t>(v) : f.index,
                          is_first ? f.index : static_cast<std::uint32_t>(v - n));
    }
    std::sort(arcs.begin(), arcs.end());
    arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
    problem.arcs.clear();
    for (const auto& [i, j] : arcs)
      problem.arcs.push_back(
          {i, j, options.is_squared ? (one[i] - two[j]).squaredNorm() : (one[i] - two[j]).norm()});
    if (problem.supplies.empty()) {
      std::vector<double> areas = internal::area_weights(one, search_1);
      const std::vector<double> areas_2 = internal::area_weights(two, search_2);
      problem.supplies = internal::weights_of(places_1, areas, options.weights);
      problem.demands = internal::weights_of(places_2, areas_2, options.weights);
      areas.insert(areas.end(), areas_2.begin(), areas_2.end());
      reach = options.reach * internal::usual_distance(nearest, areas);
      if (!(reach < internal::extent(one, two)))
        reach = std::numeric_limits<double>::infinity();
    }
    const Transport_plan plan =
        std::isfinite(reach)
            ? solve_partially(problem, 0.5 * (options.is_squared ? reach * reach : reach), options)
            : solve_transport(problem, options);
    if (options.method == Point_transport::sinkhorn)
      return plan;
    bool can_grow = false;
    for (const std::size_t i : internal::sources_that_lack_arcs(one, two, plan, reach))
      if (wanted[i] < m) {
        wanted[i] *= 4;
        can_grow = true;
      }
    if (!can_grow)
      return plan;
  }
}

/// Pairs of corresponding points of two sets, and the accuracy of the transport.
struct Point_matches
{
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  double violation = 0;
  double remaining = 0; ///< mass without counterpart within reach, of 1
  bool is_complete = false;
};

/// Matches two sets of points; every point gets a corresponding point.
inline Point_matches match_points(const std::vector<Vec3>& one,
                                  const std::vector<Vec3>& two,
                                  const Transport_options& options)
{
  const Distinct_positions places_1(one), places_2(two);
  Transport_problem problem;
  const Transport_plan plan = match_places(places_1, places_2, options, problem);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const std::uint32_t k : main_arcs(problem, plan))
    pairs.emplace_back(problem.arcs[k].source, problem.arcs[k].target);
  return {pairs_of_points(places_1, places_2, pairs),
          plan.violation,
          plan.remaining,
          plan.is_complete};
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_MATCH_POINTS_H

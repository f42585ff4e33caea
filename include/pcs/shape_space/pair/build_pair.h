// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Correspondences of branches, edges and points of two trees.

#ifndef PCS_SHAPE_SPACE_PAIR_BUILD_PAIR_H
#define PCS_SHAPE_SPACE_PAIR_BUILD_PAIR_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/count_whorls.h>
#include <pcs/shape_space/model/Build_run.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/pair/Embedded_pair.h>
#include <pcs/shape_space/pair/embed_pair.h>
#include <pcs/shape_space/pair/match_trees.h>
#include <pcs/shape_space/pair/serialize_topology.h>
#include <pcs/shape_space/points/Point_instances.h>
#include <pcs/shape_space/points/point_correspondences.h>

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Reports the matching of the branches.
inline void describe_matching(const Matching_cost& cost, Orl_report& report)
{
  report.yaw = cost.yaw;
  report.matching_energy = cost.energy;
  report.unexplained_fraction = cost.share;
  report.is_grown_at_tips = cost.is_at_tips;
}

/// Matches the branches of both trees and aligns the second with the first. Returns `false` when
/// `progress` asks to stop.
template <class ConcurrencyTag>
bool match_branches(const std::array<const Tree_input*, 2>& inputs,
                    const Build_run& run,
                    Embedded_pair& built)
{
  const pcs::internal::Progress_stage stage(run.progress, 0, 0.4);
  if (!run.progress(0))
    return false;
  const pcs::internal::Stage_timer timer(run.report.seconds.matching);
  const Matching_cost cost = match_trees<ConcurrencyTag>({&inputs[0]->tree, &inputs[1]->tree},
                                                         run.options.weights,
                                                         run.options.alignment,
                                                         run.progress,
                                                         built.topology);
  built.rotation = rotation_exp(cost.yaw * run.options.alignment.up);
  describe_matching(cost, run.report);
  return !run.progress.is_cancelled();
}

/// Computes the coordinates of both trees on their common topology.
inline void embed_both(const std::array<const Tree_input*, 2>& inputs,
                       const Build_run& run,
                       Embedded_pair& built)
{
  const pcs::internal::Stage_timer timer(run.report.seconds.topology);
  shape_space::embed(inputs, built);
}

/// Finds the edge of each point of both scans. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool assign_both(const std::array<const Tree_input*, 2>& inputs,
                 const Build_run& run,
                 const Embedded_pair& built,
                 std::array<std::vector<std::size_t>, 2>& edges)
{
  const pcs::internal::Progress_stage stage(run.progress, 0.4, 0.6);
  pcs::internal::Stage_timer timer(run.report.seconds.assignment);
  bool is_running = run.progress(0);
  for (std::size_t t = 0; is_running && t < 2; ++t) {
    edges[t] = edges_of_points<ConcurrencyTag>(inputs, built, t, run.options.assignment);
    is_running = run.progress(0.5 * static_cast<double>(t + 1));
  }
  if (!is_running)
    timer.discard();
  return is_running;
}

/// Pairs the points on corresponding edges by transport. Returns `false` when `progress` asks to
/// stop.
template <class ConcurrencyTag>
bool pair_points(const std::array<const Tree_input*, 2>& inputs,
                 const Build_run& run,
                 const Embedded_pair& built,
                 const std::array<std::vector<std::size_t>, 2>& edges,
                 std::vector<Point_pair>& pairs)
{
  const pcs::internal::Progress_stage stage(run.progress, 0.6, 1);
  const pcs::internal::Stage_timer timer(run.report.seconds.transport);
  const std::array<std::vector<Vec3>, 2> points = {inputs[0]->points, points_of_second(inputs)};
  Point_matching<ConcurrencyTag> matching(built.layout,
                                          built.geometry,
                                          points,
                                          edges,
                                          built.is_relative);
  Transport_summary summary;
  pairs = matching.run(run.options.transport, summary, [&](double f) { return !run.progress(f); });
  if (!run.progress.is_cancelled())
    describe(summary, run.report);
  return !run.progress.is_cancelled();
}

} // namespace internal

/// Matches branches and points of two trees. `built.form` is an input; all other members of `built`
/// except the instances are computed. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool find_correspondences(const std::array<const Tree_input*, 2>& inputs,
                          const Build_run& run,
                          Embedded_pair& built,
                          std::vector<Point_pair>& pairs)
{
  if (!internal::match_branches<ConcurrencyTag>(inputs, run, built))
    return false;
  internal::embed_both(inputs, run, built);
  std::array<std::vector<std::size_t>, 2> edges;
  return internal::assign_both<ConcurrencyTag>(inputs, run, built, edges) &&
         internal::pair_points<ConcurrencyTag>(inputs, run, built, edges, pairs);
}

/// Reports the counts and the distance of a pair. Requires its instances.
inline void describe(const Embedded_pair& pair, Orl_report& report)
{
  report.number_of_common_branches = pair.topology.branches.size();
  for (const Common_branch& b : pair.topology.branches) {
    for (int t = 0; t < 2; ++t)
      report.number_of_branches[static_cast<std::size_t>(t)] += b.is_virtual(t) ? 0 : 1;
    report.number_of_matched_branches += b.is_virtual(0) || b.is_virtual(1) ? 0 : 1;
  }
  const Whorl_counts whorls = count_whorls(pair.topology);
  report.number_of_whorls = whorls.number;
  report.number_of_broken_whorls = whorls.broken;
  report.number_of_edges = pair.layout.number_of_edges();
  report.distance = distance(pair.x[0], pair.x[1], pair.weights, Orl_metric::sum);
  report.number_of_point_pairs = pair.instances.pairs().size();
  for (const Point_pair& p : pair.instances.pairs())
    report.number_of_unmatched_points += p.point[0] == no_point || p.point[1] == no_point ? 1 : 0;
}

/// Computes topology and coordinates from stored correspondences. Throws `Invalid_input`, with a
/// message that begins with `caller`, if they do not fit the inputs.
inline void embed_stored(const Orl_correspondences& stored,
                         const std::array<const Tree_input*, 2>& inputs,
                         const std::string& caller,
                         Embedded_pair& built)
{
  built.topology = restore_topology(stored, inputs, caller);
  const auto& [w, x, y, z] = stored.rotation;
  built.rotation = Quaternion(w, x, y, z);
  embed(inputs, built);
  if (!inputs[0]->points.empty() || !inputs[1]->points.empty())
    check_pairs(stored,
                built.layout.number_of_edges(),
                {inputs[0]->points.size(), inputs[1]->points.size()},
                caller);
}

/// Stores points and normals of both scans, as `restore_pair()` reads them.
inline void store_points(const std::array<const Tree_input*, 2>& inputs, Orl_space_data& stored)
{
  const std::array<std::vector<Vec3>, 2> points = {inputs[0]->points, points_of_second(inputs)};
  for (std::size_t t = 0; t < 2; ++t) {
    for (const Vec3& p : points[t])
      stored.trees[t].point.push_back(internal::to_array(p));
    for (const Vec3& v : inputs[t]->normals)
      stored.trees[t].normal.push_back(internal::to_array(v));
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PAIR_BUILD_PAIR_H

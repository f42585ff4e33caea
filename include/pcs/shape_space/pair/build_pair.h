// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Correspondences of branches, edges and points of two trees.

#ifndef PCS_SHAPE_SPACE_PAIR_BUILD_PAIR_H
#define PCS_SHAPE_SPACE_PAIR_BUILD_PAIR_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/model/Build_options.h>
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

/// Matches branches and points of two trees. Returns `false` when `progress` asks to stop. Reads
/// `built.form`, computes all but the instances.
template <class ConcurrencyTag>
bool find_correspondences(const std::array<const Tree_input*, 2>& inputs,
                          const Build_options& options,
                          pcs::internal::Progress& progress,
                          Embedded_pair& built,
                          std::vector<Point_pair>& pairs,
                          Orl_report& report)
{
  pcs::internal::Stopwatch watch;
  progress.stage(0, 0.4);
  if (!progress(0))
    return false;
  const Matching_cost cost = match_trees<ConcurrencyTag>({&inputs[0]->tree, &inputs[1]->tree},
                                                         options.weights,
                                                         options.alignment,
                                                         progress,
                                                         built.topology);
  built.rotation = rotation_exp(cost.yaw * options.alignment.up);
  report.yaw = cost.yaw;
  report.matching_energy = cost.energy;
  report.unexplained_fraction = cost.share;
  report.is_grown_at_tips = cost.is_at_tips;
  report.seconds.matching = watch.lap();
  if (progress.is_cancelled())
    return false;
  embed(inputs, built);
  report.seconds.topology = watch.lap();

  progress.stage(0.4, 0.6);
  if (!progress(0))
    return false;
  std::array<std::vector<std::size_t>, 2> edges;
  for (std::size_t t = 0; t < 2; ++t) {
    edges[t] = edges_of_points<ConcurrencyTag>(inputs, built, t, options.assignment);
    if (!progress(0.5 * static_cast<double>(t + 1)))
      return false;
  }
  report.seconds.assignment = watch.lap();

  progress.stage(0.6, 1);
  Transport_summary summary;
  pairs = Point_matching<ConcurrencyTag>(built.layout,
                                         built.geometry,
                                         {inputs[0]->points, points_of_second(inputs)},
                                         edges,
                                         built.is_relative)
              .run(options.transport, summary, [&](double f) { return !progress(f); });
  report.seconds.transport = watch.lap();
  if (progress.is_cancelled())
    return false;
  describe(summary, report);
  return true;
}

/// Reports counts and the distance of a pair with instances.
inline void describe(const Embedded_pair& pair, Orl_report& report)
{
  report.number_of_common_branches = pair.topology.branches.size();
  for (const Common_branch& b : pair.topology.branches) {
    for (int t = 0; t < 2; ++t)
      report.number_of_branches[static_cast<std::size_t>(t)] += b.is_virtual(t) ? 0 : 1;
    report.number_of_matched_branches += b.is_virtual(0) || b.is_virtual(1) ? 0 : 1;
  }
  report.number_of_edges = pair.layout.number_of_edges();
  report.distance = distance(pair.x[0], pair.x[1], pair.weights, Orl_metric::sum);
  report.number_of_point_pairs = pair.instances.pairs().size();
  for (const Point_pair& p : pair.instances.pairs())
    report.number_of_unmatched_points += p.point[0] == no_point || p.point[1] == no_point ? 1 : 0;
}

/// Computes topology and coordinates from stored correspondences. Throws `Invalid_input`, with a
/// message that begins with `caller`, if they do not fit.
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

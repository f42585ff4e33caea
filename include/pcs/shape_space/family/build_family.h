// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Construction of a family with points from any number of trees and scans.

#ifndef PCS_SHAPE_SPACE_FAMILY_BUILD_FAMILY_H
#define PCS_SHAPE_SPACE_FAMILY_BUILD_FAMILY_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/family/Family_points_impl.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/family/star_correspondences.h>
#include <pcs/shape_space/matching/find_yaw_candidates.h>
#include <pcs/shape_space/model/Build_options.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/model/Tree_family.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Finds the edge of each point of each scan. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool find_edges_of_points(const std::vector<Tree_input>& inputs,
                          const Tree_family& family,
                          const Point_assignment_options& options,
                          pcs::internal::Progress& progress,
                          std::vector<std::vector<std::size_t>>& edges)
{
  Orl_geometry geometry;
  for (std::size_t t = 0; t < inputs.size(); ++t) {
    if (!progress(static_cast<double>(t) / static_cast<double>(inputs.size())))
      return false;
    build_geometry(family.layout, family.x[t], family.orientation, geometry);
    edges.push_back(edges_of_points<ConcurrencyTag>(family, inputs[t], t, geometry, options));
  }
  return progress(1);
}

/// Copies the points of the family from the scans; they have normals if all scans have.
inline void copy_points(const std::vector<Tree_input>& inputs,
                        const std::vector<Family_source>& sources,
                        Built_family& built)
{
  built.has_normals = true;
  for (const Tree_input& input : inputs)
    built.has_normals = built.has_normals && input.normals.size() == input.points.size();
  for (const Family_source& s : sources) {
    const Tree_input& input = inputs[s.tree];
    const Vec3 p = input.points[s.point] + (input.tree.origin - built.family.origin);
    built.points.push_back({s.tree, s.point, s.edge, to_array(p), {0, 0, 0}});
    if (built.has_normals)
      built.points.back().normal = to_array(input.normals[s.point]);
  }
}

/// Counts branches and edges. Matched branches are those of the first two trees.
inline void describe_branches(const Tree_family& family, Orl_report& report)
{
  for (std::size_t b = 0; b < family.layout.branches.size(); ++b) {
    for (std::size_t t = 0; t < 2; ++t)
      report.number_of_branches[t] += family.has[t][b] ? 1 : 0;
    report.number_of_matched_branches += family.has[0][b] && family.has[1][b] ? 1 : 0;
  }
  report.number_of_common_branches = family.layout.branches.size();
  report.number_of_edges = family.layout.number_of_edges();
}

} // namespace internal

/// Builds a family with points. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool build_family(const std::vector<Tree_input>& inputs,
                  const Build_options& options,
                  pcs::internal::Progress& progress,
                  Built_family& built,
                  Orl_report& report)
{
  pcs::internal::Stopwatch watch;
  std::vector<const Rooted_tree*> trees;
  for (const Tree_input& input : inputs)
    trees.push_back(&input.tree);
  progress.stage(0, 0.7);
  Shared_topology_builder<ConcurrencyTag> topology(trees,
                                                   options.weights,
                                                   options.number_of_rounds);
  if (!topology.run(progress))
    return false;
  report.seconds.matching = watch.lap();
  built.family = make_family<ConcurrencyTag>(topology, trees, options.weights, options.form);
  report.seconds.topology = watch.lap();

  progress.stage(0.7, 0.8);
  std::vector<std::vector<std::size_t>> edges;
  const bool is_assigned = internal::find_edges_of_points<ConcurrencyTag>(inputs,
                                                                          built.family,
                                                                          options.assignment,
                                                                          progress,
                                                                          edges);
  report.seconds.assignment = watch.lap();
  if (!is_assigned)
    return false;
  const std::vector<Family_source> sources =
      choose_points(built.family.layout, edges, options.points_of);
  internal::copy_points(inputs, sources, built);

  progress.stage(0.8, 1);
  Transport_summary summary;
  built.partners = find_partners<ConcurrencyTag>(built.family,
                                                 inputs,
                                                 edges,
                                                 sources,
                                                 options.transport,
                                                 summary,
                                                 [&](double f) { return !progress(f); });
  report.seconds.transport = watch.lap();
  if (progress.is_cancelled())
    return false;
  describe(summary, report);
  internal::describe_branches(built.family, report);
  report.fraction_of_changed_matches = topology.fraction_of_changed_matches();
  return true;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_BUILD_FAMILY_H

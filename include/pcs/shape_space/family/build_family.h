// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Construction of a family with points from any number of trees and scans.

#ifndef PCS_SHAPE_SPACE_FAMILY_BUILD_FAMILY_H
#define PCS_SHAPE_SPACE_FAMILY_BUILD_FAMILY_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/family/Family_points_impl.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/family/star_correspondences.h>
#include <pcs/shape_space/matching/count_whorls.h>
#include <pcs/shape_space/matching/find_yaw_candidates.h>
#include <pcs/shape_space/model/Build_options.h>
#include <pcs/shape_space/model/Build_run.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/model/Tree_family.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Matches the branches of all trees to those of their mean tree. Returns null when `progress` asks
/// to stop.
template <class ConcurrencyTag>
std::unique_ptr<Shared_topology_builder<ConcurrencyTag>>
match_to_mean(const std::vector<const Rooted_tree*>& trees, const Build_run& run)
{
  const pcs::internal::Progress_stage stage(run.progress, 0, 0.7);
  pcs::internal::Stage_timer timer(run.report.seconds.matching);
  auto topology =
      std::make_unique<Shared_topology_builder<ConcurrencyTag>>(trees,
                                                                run.options.weights,
                                                                run.options.number_of_rounds);
  if (topology->run(run.progress))
    return topology;
  timer.discard();
  return nullptr;
}

/// Finds the topology of all trees and their coordinates on it. Returns null when `progress` asks
/// to stop.
template <class ConcurrencyTag>
std::unique_ptr<Shared_topology_builder<ConcurrencyTag>>
find_topology(const std::vector<Tree_input>& inputs, const Build_run& run, Tree_family& family)
{
  std::vector<const Rooted_tree*> trees;
  for (const Tree_input& input : inputs)
    trees.push_back(&input.tree);
  auto topology = match_to_mean<ConcurrencyTag>(trees, run);
  if (topology) {
    const pcs::internal::Stage_timer timer(run.report.seconds.topology);
    family = make_family<ConcurrencyTag>(*topology, trees, run.options.weights, run.options.form);
  }
  return topology;
}

/// Finds the edge of each point of each scan. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool assign_all(const std::vector<Tree_input>& inputs,
                const Tree_family& family,
                const Build_run& run,
                std::vector<std::vector<std::size_t>>& edges)
{
  const pcs::internal::Progress_stage stage(run.progress, 0.7, 0.8);
  const pcs::internal::Stage_timer timer(run.report.seconds.assignment);
  Orl_geometry geometry;
  for (std::size_t t = 0; t < inputs.size(); ++t) {
    if (!run.progress(static_cast<double>(t) / static_cast<double>(inputs.size())))
      return false;
    build_geometry(family.layout, family.x[t], family.orientation, geometry);
    edges.push_back(
        edges_of_points<ConcurrencyTag>(family, inputs[t], t, geometry, run.options.assignment));
  }
  return run.progress(1);
}

/// Copies the points of the family from the scans; they have normals if all scans have normals.
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

/// Chooses the scan of each branch, and copies its points to the family.
inline std::vector<Family_source> sample_family(const std::vector<Tree_input>& inputs,
                                                const std::vector<std::vector<std::size_t>>& edges,
                                                const Build_run& run,
                                                Built_family& built)
{
  const pcs::internal::Stage_timer timer(run.report.seconds.transport);
  std::vector<Family_source> sources =
      choose_points(built.family.layout, edges, run.options.points_of);
  copy_points(inputs, sources, built);
  return sources;
}

/// Finds the corresponding points in all scans by transport. Returns `false` when `progress` asks
/// to stop.
template <class ConcurrencyTag>
bool match_scans(const std::vector<Tree_input>& inputs,
                 const std::vector<std::vector<std::size_t>>& edges,
                 const std::vector<Family_source>& sources,
                 const Build_run& run,
                 Built_family& built)
{
  const pcs::internal::Progress_stage stage(run.progress, 0.8, 1);
  const pcs::internal::Stage_timer timer(run.report.seconds.transport);
  Transport_summary summary;
  built.partners = find_partners<ConcurrencyTag>(built.family,
                                                 inputs,
                                                 edges,
                                                 sources,
                                                 run.options.transport,
                                                 summary,
                                                 [&](double f) { return !run.progress(f); });
  if (!run.progress.is_cancelled())
    describe(summary, run.report);
  return !run.progress.is_cancelled();
}

/// Counts branches, edges and whorls. Branches that are matched are counted for the first two trees
/// only.
inline void describe_branches(const Tree_family& family, Orl_report& report)
{
  for (std::size_t b = 0; b < family.layout.branches.size(); ++b) {
    for (std::size_t t = 0; t < 2; ++t)
      report.number_of_branches[t] += family.has[t][b] ? 1 : 0;
    report.number_of_matched_branches += family.has[0][b] && family.has[1][b] ? 1 : 0;
  }
  report.number_of_common_branches = family.layout.branches.size();
  report.number_of_edges = family.layout.number_of_edges();
  const Whorl_counts whorls = count_whorls(family);
  report.number_of_whorls = whorls.number;
  report.number_of_broken_whorls = whorls.broken;
}

} // namespace internal

/// Builds a family with points. Returns `false` when `progress` asks to stop.
template <class ConcurrencyTag>
bool build_family(const std::vector<Tree_input>& inputs, const Build_run& run, Built_family& built)
{
  const auto topology = internal::find_topology<ConcurrencyTag>(inputs, run, built.family);
  std::vector<std::vector<std::size_t>> edges; // of the points, by tree
  if (!topology || !internal::assign_all<ConcurrencyTag>(inputs, built.family, run, edges))
    return false;
  const std::vector<Family_source> sources = internal::sample_family(inputs, edges, run, built);
  if (!internal::match_scans<ConcurrencyTag>(inputs, edges, sources, run, built))
    return false;
  internal::describe_branches(built.family, run.report);
  run.report.fraction_of_changed_matches = topology->fraction_of_changed_matches();
  return true;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_BUILD_FAMILY_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Matches the branches of the result to true branches, and checks their parents.

#ifndef PCS_BENCHMARK_QUALITY_MATCH_BRANCHES_H
#define PCS_BENCHMARK_QUALITY_MATCH_BRANCHES_H

#include "Skeleton_accuracy.h"
#include "support/Segment_tree.h"
#include "tree_axes.h"
#include <pcs/core/Tree_skeleton.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace pcs_bench {

/*
  Samples of each branch from base to tip, without those at the base that lie inside the parent. A
  branch that lies completely inside its parent has no samples. Samples must be in the order of
  `sample_axes()`: branch by branch, from base to tip.
*/
class Free_samples
{
public:
  Free_samples(const std::vector<pcs::Tree_branch>& branches,
               const std::vector<Axis_segment>& segments,
               const std::vector<Axis_sample>& samples)
    : m_samples(branches.size())
  {
    std::vector<std::vector<std::size_t>> segments_of(branches.size());
    for (std::size_t i = 0; i < segments.size(); ++i)
      segments_of[segments[i].branch].push_back(i);
    std::vector<bool> is_outside(branches.size(), false);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::size_t b = samples[i].branch, parent = branches[b].parent;
      const auto is_around = [&](std::size_t s) {
        const double t = segments[s].parameter(samples[i].point);
        const Eigen::Vector3d q = segments[s].from + t * (segments[s].to - segments[s].from);
        return (q - samples[i].point).norm() < segments[s].radius(t);
      };
      if (!is_outside[b] && parent != pcs::npos &&
          std::any_of(segments_of[parent].begin(), segments_of[parent].end(), is_around))
        continue;
      is_outside[b] = true;
      m_samples[b].push_back(i);
    }
  }

  const std::vector<std::size_t>& operator[](std::size_t branch) const { return m_samples[branch]; }

private:
  std::vector<std::vector<std::size_t>> m_samples;
};

/// View of a tree with its samples.
struct Measured_tree
{
  const std::vector<pcs::Tree_branch>& branches;
  const std::vector<Axis_segment>& segments;
  const std::vector<Axis_sample>& samples;
  const std::vector<Segment_tree::Hit>& hits; ///< nearest point on the other tree, for each sample
};

inline Order_class& class_of_order(std::vector<Order_class>& classes, int order)
{
  const auto i = static_cast<std::size_t>(std::max(order, 0));
  if (classes.size() <= i)
    classes.resize(i + 1);
  return classes[i];
}

/// For each branch of the result, the true branch that most of its length follows, or `npos` for a
/// false branch.
inline std::vector<std::size_t> owners(const Measured_tree& truth,
                                       const Measured_tree& result,
                                       const Free_samples& samples,
                                       double tolerance)
{
  std::vector<std::size_t> owner(result.branches.size(), pcs::npos);
  for (std::size_t b = 0; b < result.branches.size(); ++b) {
    std::map<std::size_t, double> lengths; // ordered: ties select the lowest branch
    double length = 0, matched = 0;
    for (const std::size_t i : samples[b]) {
      const Axis_sample& sample = result.samples[i];
      const Segment_tree::Hit& hit = result.hits[i];
      length += sample.length;
      if (!hit.is_found())
        continue;
      const Axis_segment& s = truth.segments[hit.segment];
      if (hit.distance <= std::max(tolerance, s.radius(hit.t) / 2)) {
        matched += sample.length;
        lengths[s.branch] += sample.length;
      }
    }
    if (lengths.empty() || 2 * matched < length)
      continue;
    owner[b] = std::max_element(lengths.begin(), lengths.end(), [](const auto& x, const auto& y) {
                 return x.second < y.second;
               })->first;
  }
  return owner;
}

inline std::vector<Order_class>
match_branches(const Measured_tree& truth, const Measured_tree& result, double tolerance)
{
  std::vector<Order_class> classes;
  const Free_samples true_samples(truth.branches, truth.segments, truth.samples);
  for (std::size_t b = 0; b < truth.branches.size(); ++b) {
    double seen = 0, found = 0;
    for (const std::size_t i : true_samples[b]) {
      const Axis_sample& sample = truth.samples[i];
      if (!sample.is_seen)
        continue;
      seen += sample.length;
      if (truth.hits[i].distance <= std::max(tolerance, sample.radius / 2))
        found += sample.length;
    }
    if (seen <= 0)
      continue;
    Order_class& c = class_of_order(classes, truth.branches[b].order);
    ++c.number_of_true_branches;
    c.number_of_missed_branches += 2 * found < seen ? 1 : 0;
  }

  const Free_samples samples(result.branches, result.segments, result.samples);
  const std::vector<std::size_t> owner = owners(truth, result, samples, tolerance);
  for (std::size_t b = 0; b < result.branches.size(); ++b) {
    double length = 0;
    for (const std::size_t i : samples[b])
      length += result.samples[i].length;
    if (length <= 0)
      continue;
    Order_class& own = class_of_order(classes, result.branches[b].order);
    ++own.number_of_branches;
    if (owner[b] == pcs::npos) {
      ++own.number_of_false_branches;
      continue;
    }
    const std::size_t parent = result.branches[b].parent;
    const std::size_t parent_owner = parent == pcs::npos ? pcs::npos : owner[parent];
    const std::size_t true_parent = truth.branches[owner[b]].parent;
    // A branch may be found in several pieces, each a child of the previous one.
    const bool is_correct = parent == pcs::npos
                                ? true_parent == pcs::npos
                                : parent_owner != pcs::npos &&
                                      (parent_owner == true_parent || parent_owner == owner[b]);
    Order_class& c = class_of_order(classes, truth.branches[owner[b]].order);
    ++c.number_of_matched_branches;
    c.matched_length += length;
    if (is_correct) {
      ++c.number_of_correct_parents;
      c.correct_length += length;
    }
  }
  return classes;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_MATCH_BRANCHES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Measures a skeleton against the true one.

#ifndef PCS_BENCHMARK_QUALITY_MEASURE_SKELETON_H
#define PCS_BENCHMARK_QUALITY_MEASURE_SKELETON_H

#include "Skeleton_accuracy.h"
#include "match_branches.h"
#include "support/Segment_tree.h"
#include "tree_axes.h"
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/text.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs_bench {
namespace internal {

inline std::vector<Segment_tree::Hit> nearest_axes(const std::vector<Axis_sample>& samples,
                                                   const Segment_tree& tree)
{
  std::vector<Segment_tree::Hit> hits;
  hits.reserve(samples.size());
  for (const Axis_sample& sample : samples)
    hits.push_back(tree.nearest_axis(sample.point));
  return hits;
}

/// Agreement of two trees: `limit(true radius)` is the largest distance of agreeing axes. Only
/// samples with `is_counted(radius)` are counted.
template <class Limit, class Counted>
Agreement agreement(double tolerance,
                    const Measured_tree& truth,
                    const Measured_tree& result,
                    const Limit& limit,
                    const Counted& is_counted)
{
  double total = 0, hit = 0, true_total = 0, true_hit = 0;
  for (std::size_t i = 0; i < result.samples.size(); ++i) {
    const Axis_sample& sample = result.samples[i];
    if (!is_counted(sample.radius))
      continue;
    total += sample.length;
    const Segment_tree::Hit& near = result.hits[i];
    if (near.is_found() && near.distance <= limit(truth.segments[near.segment].radius(near.t)))
      hit += sample.length;
  }
  for (std::size_t i = 0; i < truth.samples.size(); ++i) {
    const Axis_sample& sample = truth.samples[i];
    if (!sample.is_seen || !is_counted(sample.radius))
      continue;
    true_total += sample.length;
    if (truth.hits[i].distance <= limit(sample.radius))
      true_hit += sample.length;
  }
  return {tolerance, total > 0 ? hit / total : 0, true_total > 0 ? true_hit / true_total : 0};
}

inline Distances distances(const Measured_tree& tree)
{
  Weighted_values values;
  for (std::size_t i = 0; i < tree.samples.size(); ++i)
    if (tree.samples[i].is_seen)
      values.add(tree.hits[i].distance, tree.samples[i].length);
  return values.distances();
}

struct Radius_errors
{
  Weighted_values size, bias;

  void add(double radius, double true_radius, double weight)
  {
    const double error = (radius - true_radius) / true_radius;
    size.add(std::abs(error), weight);
    bias.add(error, weight);
  }
};

/// Classes of radii, and the errors of all radii.
class Size_classes
{
public:
  Size_classes(const Accuracy_rules& rules, const Measured_tree& truth, const Measured_tree& result)
  {
    double to = std::numeric_limits<double>::infinity();
    for (const double bound : rules.class_bounds) {
      classes.push_back(make_class(bound, to));
      to = bound;
    }
    classes.push_back(make_class(0, to));
    m_errors.resize(classes.size());
    add_truth(rules, truth, result);
    for (const Axis_sample& s : result.samples) {
      Size_class& c = classes[class_of(s.radius)];
      c.length += s.length;
      c.volume += s.volume;
    }
    for (std::size_t i = 0; i < classes.size(); ++i) {
      Size_class& c = classes[i];
      c.matched_share = c.seen_length > 0 ? m_errors[i].size.weight() / c.seen_length : 0;
      c.radius_error = m_errors[i].size.quantile(0.5);
      c.radius_bias = m_errors[i].bias.quantile(0.5);
      const double tolerance = rules.tolerances.empty() ? 0 : rules.tolerances.front();
      c.agreement = agreement(
          tolerance,
          truth,
          result,
          [&](double) { return tolerance; },
          [&](double r) { return r >= c.from && r < c.to; });
    }
  }

  std::vector<Size_class> classes;
  Radius_errors all;

private:
  static Size_class make_class(double from, double to)
  {
    Size_class c;
    c.from = from;
    c.to = to;
    return c;
  }

  std::size_t class_of(double radius) const
  {
    std::size_t i = 0;
    while (i + 1 < classes.size() && radius < classes[i].from)
      ++i;
    return i;
  }

  void
  add_truth(const Accuracy_rules& rules, const Measured_tree& truth, const Measured_tree& result)
  {
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
      const Axis_sample& s = truth.samples[i];
      const std::size_t index = class_of(s.radius);
      Size_class& c = classes[index];
      c.true_length += s.length;
      c.true_volume += s.volume;
      if (!s.is_seen)
        continue;
      c.seen_length += s.length;
      const Segment_tree::Hit& near = truth.hits[i];
      if (!(s.radius > 0) || near.distance > std::max(rules.radius_match, s.radius / 2))
        continue;
      const double radius = result.segments[near.segment].radius(near.t);
      m_errors[index].add(radius, s.radius, s.length);
      all.add(radius, s.radius, s.length);
    }
  }

  std::vector<Radius_errors> m_errors;
};

/// Throws if the step cuts a tree into more than a million pieces.
inline void check_step(double step, const std::vector<Axis_segment>& segments)
{
  constexpr double least = 1e-6; // of the length [-]
  double length = 0;
  for (const Axis_segment& s : segments)
    length += s.length();
  if (!(step > 0 && step >= least * length))
    throw pcs::Invalid_input("measure_skeleton(): the sampling step is " +
                             pcs::internal::to_text(step) +
                             ", expected at least a millionth of the length of each tree, " +
                             pcs::internal::to_text(least * length) + " (lengths in metres)");
}

template <class Kernel>
double extent_along_z(const pcs::Tree_skeleton<Kernel>& tree)
{
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    low = std::min(low, CGAL::to_double(tree[v].point.z()));
    high = std::max(high, CGAL::to_double(tree[v].point.z()));
  }
  return high > low ? high - low : 0;
}

} // namespace internal

/*!
  \brief measures `result` against `truth`.

  Precision is measured against all true axes, recall over those where the scan has points: axes
  without points are not required, but allowed. Where a branch begins inside its parent, both trees
  are measured to the parent's axis.

  \param hits number of points on each node of `truth`; empty: the scan has points everywhere
  \throws pcs::Invalid_input when a tree has no axis, `hits` has another size than `truth`, or the
  sampling step is not positive or below 1e-6 of the length of a tree
*/
template <class Kernel>
Skeleton_accuracy measure_skeleton(const pcs::Tree_skeleton<Kernel>& truth,
                                   const std::vector<std::size_t>& hits,
                                   const pcs::Tree_skeleton<Kernel>& result,
                                   const Accuracy_rules& rules = Accuracy_rules())
{
  if (!hits.empty() && hits.size() != num_vertices(truth))
    throw pcs::Invalid_input("measure_skeleton(): `hits` must have one value for each true node");
  const std::vector<Axis_segment> true_segments = axis_segments<Kernel>(truth, hits);
  const std::vector<Axis_segment> segments = axis_segments<Kernel>(result);
  if (true_segments.empty() || segments.empty())
    throw pcs::Invalid_input("measure_skeleton(): a tree needs an edge of positive length");
  internal::check_step(rules.sampling_step, true_segments);
  internal::check_step(rules.sampling_step, segments);
  const std::vector<Axis_sample> true_samples = sample_axes(true_segments, rules.sampling_step);
  const std::vector<Axis_sample> samples = sample_axes(segments, rules.sampling_step);
  const auto true_hits = internal::nearest_axes(true_samples, Segment_tree(segments));
  const auto result_hits = internal::nearest_axes(samples, Segment_tree(true_segments));
  const Measured_tree t{truth[boost::graph_bundle].branches,
                        true_segments,
                        true_samples,
                        true_hits};
  const Measured_tree r{result[boost::graph_bundle].branches, segments, samples, result_hits};

  Skeleton_accuracy accuracy;
  const auto all = [](double) { return true; };
  for (const double d : rules.tolerances)
    accuracy.at_distance.push_back(internal::agreement(
        d,
        t,
        r,
        [&](double) { return d; },
        all));
  for (const double f : rules.radius_fractions)
    accuracy.at_radius.push_back(internal::agreement(
        f,
        t,
        r,
        [&](double radius) { return f * radius; },
        all));
  accuracy.to_truth = internal::distances(r);
  accuracy.to_result = internal::distances(t);

  internal::Size_classes sizes(rules, t, r);
  accuracy.size_classes = sizes.classes;
  accuracy.radius_error = sizes.all.size.quantile(0.5);
  accuracy.radius_bias = sizes.all.bias.quantile(0.5);
  for (const Size_class& c : sizes.classes) {
    accuracy.true_length += c.true_length;
    accuracy.seen_length += c.seen_length;
    accuracy.length += c.length;
    accuracy.true_volume += c.true_volume;
    accuracy.volume += c.volume;
  }
  const std::size_t root = truth[boost::graph_bundle].root;
  const double breast_height = CGAL::to_double(truth[root].point.z()) + rules.breast_height;
  accuracy.true_dbh = diameter_at_height<Kernel>(truth, breast_height);
  accuracy.dbh = diameter_at_height<Kernel>(result, breast_height);
  accuracy.true_height = internal::extent_along_z<Kernel>(truth);
  accuracy.height = internal::extent_along_z<Kernel>(result);
  accuracy.order_classes = match_branches(t, r, rules.branch_match);
  return accuracy;
}

/// Distances of points to the surface of the tubes around the axes of a tree.
template <class Kernel, class PointRange>
Distances point_to_surface_distances(const pcs::Tree_skeleton<Kernel>& tree,
                                     const PointRange& points)
{
  const Segment_tree segments(axis_segments<Kernel>(tree));
  Weighted_values values;
  for (const auto& p : points)
    values.add(segments.nearest_surface(to_vector(p)).distance, 1);
  return values.distances();
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_MEASURE_SKELETON_H

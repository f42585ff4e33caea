// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Axes of a tree as segments, samples of them, and weighted statistics.

#ifndef PCS_BENCHMARK_QUALITY_TREE_AXES_H
#define PCS_BENCHMARK_QUALITY_TREE_AXES_H

#include "Skeleton_accuracy.h"
#include "support/Segment_tree.h"
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <CGAL/number_utils.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcs_bench {

template <class Point>
Eigen::Vector3d to_vector(const Point& p)
{
  return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

/*
  Returns one segment for each edge of positive length, branch by branch, from base to tip. An edge
  from a parent to the first node of a branch belongs to that branch and has its radius along the
  whole edge. A segment is seen if one of its ends has points, or if `hits` is empty.
*/
template <class Kernel>
std::vector<Axis_segment> axis_segments(const pcs::Tree_skeleton<Kernel>& tree,
                                        const std::vector<std::size_t>& hits = {})
{
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (tree[v].branch >= tree[boost::graph_bundle].branches.size())
      throw pcs::Invalid_input("the branch of node " + std::to_string(v) + " does not exist");
  std::vector<Axis_segment> segments;
  for (const std::vector<std::size_t>& nodes : pcs::nodes_by_branch<Kernel>(tree))
    for (const std::size_t v : nodes) {
      const std::size_t p = pcs::parent_node<Kernel>(v, tree);
      if (p == pcs::npos || tree[v].point == tree[p].point)
        continue;
      Axis_segment s;
      s.from = to_vector(tree[p].point);
      s.to = to_vector(tree[v].point);
      s.branch = tree[v].branch;
      s.radius_to = CGAL::to_double(tree[v].radius);
      s.radius_from = tree[p].branch == s.branch ? CGAL::to_double(tree[p].radius) : s.radius_to;
      s.is_seen = hits.empty() || hits[v] > 0 || hits[p] > 0;
      segments.push_back(s);
    }
  return segments;
}

/// The middle of a short piece of an axis.
struct Axis_sample
{
  Eigen::Vector3d point;
  double radius = 0, length = 0, volume = 0; ///< volume of the frustum
  std::size_t branch = 0;
  bool is_seen = true;
};

inline std::vector<Axis_sample> sample_axes(const std::vector<Axis_segment>& segments, double step)
{
  constexpr double pi = 3.14159265358979323846;
  std::vector<Axis_sample> samples;
  for (const Axis_segment& s : segments) {
    const double length = s.length();
    const auto n = static_cast<std::size_t>(std::max(1.0, std::ceil(length / step - 1e-9)));
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = [&](double k) { return k / static_cast<double>(n); };
      const double k = static_cast<double>(i);
      const double a = s.radius(at(k)), b = s.radius(at(k + 1));
      Axis_sample sample;
      sample.point = s.from + at(k + 0.5) * (s.to - s.from);
      sample.radius = s.radius(at(k + 0.5));
      sample.length = length / static_cast<double>(n);
      sample.volume = pi / 3 * sample.length * (a * a + a * b + b * b);
      sample.branch = s.branch;
      sample.is_seen = s.is_seen;
      samples.push_back(sample);
    }
  }
  return samples;
}

/// Values with weights.
class Weighted_values
{
public:
  void add(double value, double weight)
  {
    m_values.emplace_back(value, weight);
    m_weight += weight;
  }
  double weight() const { return m_weight; }

  double mean() const
  {
    double sum = 0;
    for (const auto& [value, weight] : m_values)
      sum += value * weight;
    return m_weight > 0 ? sum / m_weight : no_value;
  }

  double rms() const
  {
    double sum = 0;
    for (const auto& [value, weight] : m_values)
      sum += value * value * weight;
    return m_weight > 0 ? std::sqrt(sum / m_weight) : no_value;
  }

  /// The least value for which at least the fraction `q` of the weight is at or below it.
  double quantile(double q) const
  {
    if (!(m_weight > 0))
      return no_value;
    std::vector<std::pair<double, double>> sorted = m_values;
    std::sort(sorted.begin(), sorted.end());
    double sum = 0;
    for (const auto& [value, weight] : sorted) {
      sum += weight;
      if (sum >= q * m_weight * (1 - 1e-12))
        return value;
    }
    return sorted.back().first;
  }

  Distances distances() const { return {mean(), quantile(0.5), rms(), quantile(0.95)}; }

private:
  std::vector<std::pair<double, double>> m_values;
  double m_weight = 0;
};

/// Diameter of the trunk where its axis first reaches a height; `no_value` if it does not.
template <class Kernel>
double diameter_at_height(const pcs::Tree_skeleton<Kernel>& tree, double z)
{
  const std::size_t root = tree[boost::graph_bundle].root;
  if (root == pcs::npos)
    return no_value;
  const auto branches = pcs::nodes_by_branch<Kernel>(tree);
  const auto& trunk = branches[tree[root].branch];
  for (std::size_t i = 1; i < trunk.size(); ++i) {
    const auto& a = tree[trunk[i - 1]];
    const auto& b = tree[trunk[i]];
    const double z_a = CGAL::to_double(a.point.z()), z_b = CGAL::to_double(b.point.z());
    if (z_a > z || z_b < z)
      continue;
    const double t = z_b > z_a ? (z - z_a) / (z_b - z_a) : 0;
    return 2 * ((1 - t) * CGAL::to_double(a.radius) + t * CGAL::to_double(b.radius));
  }
  return no_value;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_TREE_AXES_H

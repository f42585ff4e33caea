// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tree measures of the report: height, diameters, length and volume by order and size.

#ifndef PCS_SKELETON_RESULT_REPORT_SIZES_H
#define PCS_SKELETON_RESULT_REPORT_SIZES_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/constants.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Upper bounds of the radius in the size classes of the report, in breast heights: 5, 10, 20 and
/// 50 mm for a breast height of 1.3 m [-].
constexpr double size_bounds_by_breast_height[] = {0.005 / 1.3, 0.01 / 1.3, 0.02 / 1.3, 0.05 / 1.3};

/// Half the length of the section from which the diameter at breast height is estimated, in breast
/// heights: from 1.1 to 1.5 m [-].
constexpr double half_section_by_breast_height = 0.2 / 1.3;

/*!
  Estimates the diameter of a branch on the segment that ends at node `v`, at parameter `share` in
  [0, 1]. Fits a line by least squares to the radii within `half` along the axis on both sides,
  since bark and noise vary single radii. `v` is not a base. O(nodes of the branch).
*/
inline double diameter_of_section(const Branch_tree& tree, Index v, double share, double half)
{
  const std::vector<Index>& nodes = tree.branches[tree.nodes[v].branch].nodes;
  const std::size_t place =
      static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), v) - nodes.begin());
  // integrals of 1, s, s^2, r and s r, where s is the signed arc length from this position
  double n = 0, s1 = 0, s2 = 0, r1 = 0, sr = 0;
  double least = std::numeric_limits<double>::infinity(), most = 0;
  const auto length_before = [&](std::size_t k) {
    return (tree.nodes[nodes[k]].point - tree.nodes[nodes[k - 1]].point).norm();
  };
  const auto add = [&](std::size_t k,
                       double from) { // segment before node k, which begins at `from`
    const double length = length_before(k);
    const double begin = std::max(from, -half), end = std::min(from + length, half);
    if (!(end > begin))
      return;
    const double a = tree.nodes[nodes[k - 1]].radius, b = tree.nodes[nodes[k]].radius;
    const double places[] = {begin, 0.5 * (begin + end), end}, weights[] = {1, 4, 1};
    for (int i = 0; i < 3; ++i) { // Simpson's rule, which is exact here
      const double s = places[i], r = a + (b - a) * (s - from) / length;
      const double w = (end - begin) / 6 * weights[i];
      n += w;
      s1 += w * s;
      s2 += w * s * s;
      r1 += w * r;
      sr += w * s * r;
      least = std::min(least, r);
      most = std::max(most, r);
    }
  };
  const double before = -share * length_before(place);
  double from = before;
  for (std::size_t k = place; k < nodes.size() && from < half; ++k) {
    add(k, from);
    from += length_before(k);
  }
  double to = before;
  for (std::size_t k = place; k-- > 1 && to > -half;) {
    to -= length_before(k);
    add(k, to);
  }
  const double determinant = n * s2 - s1 * s1;
  if (!(determinant > 0)) {
    const double a = tree.nodes[tree.nodes[v].parent].radius;
    return 2 * (a + share * (tree.nodes[v].radius - a));
  }
  return 2 * std::min(most, std::max(least, (s2 * r1 - s1 * sr) / determinant));
}

namespace internal {

/// A branch at breast height.
struct Stem_crossing
{
  double diameter; ///< in the unit of the input [L]
  Index branch;
};

/// Reports the diameters of the stems. Stems are branches that rise to half the height of the tree:
/// the thickest one, and those with at least 0.7 times its diameter. Without such a branch, the
/// thickest branch is used. `ground` is the height of the root.
inline void report_stems(const Branch_tree& tree,
                         const Vec3& up,
                         double ground,
                         std::vector<Stem_crossing> crossings,
                         Skeleton_report& r)
{
  constexpr double min_rise = 0.5, min_ratio = 0.7; // of the height, of the thickest stem [-]
  const auto top_of = [&](Index branch) {
    double top = 0;
    for (const Index v : tree.branches[branch].nodes)
      top = std::max(top, up.dot(tree.nodes[v].point) - ground);
    return top;
  };
  std::vector<double> tops(tree.branches.size(), 0);
  double highest = 0;
  for (Index b = 0; b < tree.branches.size(); ++b)
    highest = std::max(highest, tops[b] = top_of(b));
  std::sort(crossings.begin(), crossings.end(), [](const auto& a, const auto& b) {
    return a.diameter != b.diameter ? a.diameter > b.diameter : a.branch < b.branch;
  });
  r.stem_diameters.clear();
  for (const Stem_crossing& c : crossings)
    if (tops[c.branch] >= min_rise * highest &&
        (r.stem_diameters.empty() || c.diameter >= min_ratio * r.stem_diameters.front()))
      r.stem_diameters.push_back(c.diameter);
  if (r.stem_diameters.empty() && !crossings.empty())
    r.stem_diameters.push_back(crossings.front().diameter);
  r.diameter_at_breast_height = r.stem_diameters.empty() ? 0 : r.stem_diameters.front();
}

/*!
  The main direction of the wood: with lengths l, volumes v, unit vectors d and centers c of all
  pieces, the eigenvector e of the largest eigenvalue of

      M = sum v d d^T / sum v,    oriented by    e . (sum l c / sum l - sum v c / sum v) > 0,

  since thin wood contributes more length than volume. The largest eigenvalue of wood in all
  directions is 1/3. If the two means are close to each other, e points upwards.
*/
class Wood_direction
{
public:
  void add(const Vec3& from, const Vec3& to, double volume)
  {
    const Vec3 d = to - from, center = 0.5 * (from + to);
    const double length = d.norm();
    if (!(length > 0))
      return;
    m_length += length;
    m_volume += volume;
    m_by_length += length * center;
    m_by_volume += volume * center;
    m_directions += volume / (length * length) * d * d.transpose();
    m_square += length * center * center.transpose();
  }

  /// Returns the angle between `up` and the main direction; 0 if no direction prevails [rad].
  double angle(const Vec3& up) const
  {
    constexpr double least = 0.6; // eigenvalue of wood with a main direction [-]
    constexpr double apart = 0.3; // distance of the centers of wood with a thick and a thin end,
                                  // relative to the standard deviation of its length [-]
    if (!(m_volume > 0))
      return 0;
    const auto eigen = linear_algebra::symmetric_eigen<3>(m_directions / m_volume);
    if (!(eigen.values(2) >= least))
      return 0;
    Vec3 e = eigen.vectors.col(2);
    const double middle = e.dot(m_by_length) / m_length;
    const double offset = middle - e.dot(m_by_volume) / m_volume;
    const double deviation = std::sqrt(
        std::max(0.0, (e.transpose() * m_square * e).value() / m_length - middle * middle));
    if (std::abs(offset) >= apart * deviation ? offset < 0 : e.dot(up) < 0)
      e = -e;
    return std::acos(std::clamp(e.dot(up), -1.0, 1.0));
  }

private:
  double m_length = 0, m_volume = 0;
  Vec3 m_by_length = Vec3::Zero(), m_by_volume = Vec3::Zero();
  Eigen::Matrix3d m_directions = Eigen::Matrix3d::Zero(), m_square = Eigen::Matrix3d::Zero();
};

} // namespace internal

/// Fills in the entries that depend only on the tree, in the unit of the input. `unit` is the unit
/// of the tree, in that of the input. O(nodes).
inline void report_sizes(const Branch_tree& tree,
                         double unit,
                         const Vec3& up,
                         double breast_height,
                         Skeleton_report& r)
{
  r.breast_height = unit * breast_height;
  for (const double b : size_bounds_by_breast_height)
    r.size_bounds.push_back(unit * b * breast_height);
  r.by_size.resize(r.size_bounds.size() + 1);
  for (const Branch& b : tree.branches) {
    const std::size_t order = static_cast<std::size_t>(b.order);
    if (r.by_order.size() <= order)
      r.by_order.resize(order + 1);
    ++r.by_order[order].number_of_branches;
    ++r.total.number_of_branches;
  }
  if (tree.nodes.empty())
    return;
  const double ground = up.dot(tree.nodes[0].point);
  std::vector<internal::Stem_crossing> crossings;
  internal::Wood_direction direction; // relative to the root
  for (Index v = 0; v < tree.nodes.size(); ++v) {
    const Branch_node& node = tree.nodes[v];
    r.height = std::max(r.height, unit * (up.dot(node.point) - ground));
    r.max_root_distance =
        std::max(r.max_root_distance, unit * (node.point - tree.nodes[0].point).norm());
    if (tree.is_base(v))
      continue;
    const Branch_node& below = tree.nodes[node.parent];
    const double length = unit * (node.point - below.point).norm();
    const double a = unit * below.radius, b = unit * node.radius;
    const double volume = pcs::internal::pi / 3 * length * (a * a + a * b + b * b);
    std::size_t size = 0;
    while (size < r.size_bounds.size() && 0.5 * (a + b) > r.size_bounds[size])
      ++size;
    const std::size_t order = static_cast<std::size_t>(tree.branches[node.branch].order);
    direction.add(below.point - tree.nodes[0].point, node.point - tree.nodes[0].point, volume);
    for (Branch_totals* w : {&r.total, &r.by_order[order], &r.by_size[size]}) {
      w->length += length;
      w->volume += volume;
    }
    const double h0 = up.dot(below.point) - ground - breast_height;
    const double h1 = up.dot(node.point) - ground - breast_height;
    if (h0 > 0 || h1 <= 0)
      continue;
    const double diameter =
        unit *
        diameter_of_section(tree, v, h0 / (h0 - h1), half_section_by_breast_height * breast_height);
    crossings.push_back({diameter, node.branch});
  }
  r.inclination = direction.angle(up);
  internal::report_stems(tree, up, ground, std::move(crossings), r);
}

/// Counts the points without an axis, and the points of axes that are not part of the tree.
/// O(points).
inline void count_unexplained(const std::vector<std::uint8_t>& is_used,
                              const Axis_set& set,
                              const Branch_tree& tree,
                              Skeleton_report& r)
{
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i])
      continue;
    const bool has_node = !tree.node_of_point.empty() && tree.node_of_point[i] != none;
    const bool is_covered =
        has_node || (!set.axis_of_point.empty() && set.is_covered(static_cast<Index>(i)));
    r.number_of_unexplained_points += !is_covered;
    r.number_of_unreached_points += is_covered && !has_node;
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESULT_REPORT_SIZES_H

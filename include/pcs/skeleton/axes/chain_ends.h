// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ends of axes: extension by trial pieces, and trimming where points end or lie inside.

#ifndef PCS_SKELETON_AXES_CHAIN_ENDS_H
#define PCS_SKELETON_AXES_CHAIN_ENDS_H

#include <pcs/internal/constants.h>
#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/Chain_options.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Adds straight trial pieces at the tip and, if `do_base`, at the base; `trim()` shortens them to
/// the extent of the points.
inline void prolong(const Chain_view& view, bool do_base, Axis& axis)
{
  const auto piece = [&](bool is_tip) {
    const std::size_t n = axis.size();
    const auto node = [&](std::size_t k) -> const Axis_node& {
      return axis[is_tip ? n - 1 - k : k];
    };
    const double reach = 2 * node(0).radius + 4 * view.scan.spacing;
    std::size_t k = 1;
    while (k + 1 < n && (node(k).point - node(0).point).norm() < reach)
      ++k;
    Vec3 d = node(0).point - node(k).point;
    const double length = d.norm();
    Axis_node end = node(0);
    if (length > 0)
      end.point +=
          d / length *
          (view.rules.extension * end.radius + view.rules.extension_offset * view.scan.spacing);
    return end;
  };
  const Axis_node before = piece(false), behind = piece(true);
  if (do_base)
    axis.insert(axis.begin(), before);
  axis.push_back(behind);
}

/// Numbers of points on the surface of each segment and inside it.
struct Filling
{
  std::vector<double> on, inside;
  std::vector<double> deep; ///< deeper inside than the flutes of a stem

  Filling(const Chain_view& view, const Axis_fit& fit)
    : on(fit.axis().size(), 0), inside(on), deep(on)
  {
    for (const Axis_place& p : fit.places()) {
      if (p.share < 0 || p.share > 1)
        continue;
      const double r = radius_at(fit.axis(), p), e = p.distance - r;
      const double limit =
          std::max(view.rules.filled_noise * view.set.noise, view.rules.filled_depth * r);
      if (e <= limit)
        (e < -limit ? inside : on)[p.segment] += 1;
      if (e < -std::max(limit, view.rules.deep * r))
        deep[p.segment] += 1;
    }
  }

  /// Returns the fraction of the points of segments [begin, end) that lie inside [-]. Returns 1 if
  /// there are too few points.
  double share(std::size_t begin, std::size_t end) const
  {
    double a = 0, b = 0;
    for (std::size_t k = begin; k < end; ++k) {
      a += inside[k];
      b += on[k];
    }
    constexpr double enough = 20;
    return a + b >= enough ? a / (a + b) : 1;
  }

  /// Returns whether more than the fraction `share` of the points of segments [begin, end) lies
  /// inside.
  bool is_filled(std::size_t begin, std::size_t end, double share) const
  {
    constexpr double fewest = 6;
    double a = 0, b = 0;
    for (std::size_t k = begin; k < end; ++k) {
      a += inside[k];
      b += on[k];
    }
    return a >= fewest && a > share * (a + b);
  }
};

/*!
  Cuts a thick axis where it encloses a fork. A scan samples only the surface of wood, so a hollow
  axis encloses a fork where it begins to contain points, and is cut there. An axis that is not
  hollow anywhere is an irregular or poorly sampled stem, and is kept. An axis that is hollow again
  farther out, with more points than before, passes buttresses or a whorl, and is kept, too. Wood
  does not widen towards the tip, so an axis that widens beyond such a position counts as thick from
  a lower radius on.
*/
inline void cut_filled(const Chain_view& view, Axis_fit& fit)
{
  constexpr std::size_t window = 4;
  Axis& axis = fit.axis();
  const std::size_t n = axis.size();
  const Filling filling(view, fit);
  // number of points up to each node; a point deep inside cancels `1 / filled` points
  std::vector<double> balance(n + 1, 0);
  for (std::size_t k = 0; k < n; ++k)
    balance[k + 1] =
        balance[k] + filling.on[k] + filling.inside[k] - filling.deep[k] / view.rules.filled;
  std::vector<double> highest = balance; // of this and all later nodes
  for (std::size_t k = n; k-- > 0;)
    highest[k] = std::max(highest[k], highest[k + 1]);
  std::vector<double> thickest(n); // of this and all later nodes
  for (std::size_t k = n; k-- > 0;)
    thickest[k] = std::max(axis[k].radius, k + 1 < n ? thickest[k + 1] : 0);
  double least = 1; // least fraction of inside points of a stretch so far
  for (std::size_t k = window; k + window < n; ++k) {
    least = std::min(least, filling.share(k - window, k));
    const bool is_mostly_beyond = highest[k] - balance[k] > std::max(0.0, balance[k]);
    const bool does_widen = thickest[k] > view.rules.widening * axis[k].radius;
    const double thick = does_widen ? view.rules.thick_widening : view.rules.thick;
    if (axis[k].radius >= thick * view.scan.spacing && least < 0.5 * view.rules.filled &&
        filling.is_filled(k, k + window, view.rules.filled) && !is_mostly_beyond) {
      axis.resize(k + 1);
      fit.project();
      return;
    }
  }
}

/// Returns the largest radius that is maintained along a hollow stretch of `view.rules.steady`
/// radii; 0 if there is none [L].
inline double steady_radius(const Chain_view& view, const Axis_fit& fit)
{
  const Axis& axis = fit.axis();
  const Filling filling(view, fit);
  double thickest = 0;
  for (std::size_t k = 0; k < axis.size(); ++k) {
    if (!(axis[k].radius > std::max(thickest, view.rules.thick * view.scan.spacing)))
      continue;
    const double wanted = view.rules.steady * axis[k].radius;
    double length = 0, narrowest = axis[k].radius;
    std::size_t end = k;
    while (end + 1 < axis.size() && length < wanted && narrowest > thickest) {
      length += (axis[end + 1].point - axis[end].point).norm();
      narrowest = std::min(narrowest, axis[++end].radius);
    }
    if (length >= wanted && narrowest > thickest && filling.share(k, end) < view.rules.filled)
      thickest = narrowest;
  }
  return thickest;
}

namespace internal {

/// Projects the points onto an axis whose first `shift` segments were removed.
inline void project_after_cut(Index shift, Axis_fit& fit)
{
  std::vector<Vec3> points = fit.points();
  std::vector<Index> segments;
  segments.reserve(points.size());
  for (const Axis_place& p : fit.places())
    segments.push_back(p.segment > shift ? p.segment - shift : 0);
  fit.set_points(std::move(points), std::move(segments));
  fit.project();
}

} // namespace internal

/*!
  Removes a thin base. Wood tapers. If the base of an axis is much thinner than a hollow stretch
  farther out, the path to the axis led through another object, such as a twig in contact with it.
  The axis then begins where it is thick, and the points before that remain for other axes.
*/
inline void cut_thin_base(const Chain_view& view, Axis_fit& fit)
{
  Axis& axis = fit.axis();
  double narrowest = axis.front().radius; // early exit: most axes taper or are thin
  const bool may_be_thin = std::any_of(axis.begin(), axis.end(), [&](const Axis_node& node) {
    narrowest = std::min(narrowest, node.radius);
    return node.radius >= view.rules.thick * view.scan.spacing &&
           narrowest < view.rules.thin_base * node.radius;
  });
  if (!may_be_thin)
    return;
  const double radius = steady_radius(view, fit);
  const auto begin = std::find_if(axis.begin(), axis.end(), [&](const Axis_node& node) {
    return node.radius >= view.rules.thick_base * radius;
  });
  const bool is_thin = std::any_of(axis.begin(), begin, [&](const Axis_node& node) {
    return node.radius < view.rules.thin_base * radius;
  });
  if (!is_thin || axis.end() - begin < 2)
    return;
  const Index shift = static_cast<Index>(begin - axis.begin());
  axis.erase(axis.begin(), begin);
  internal::project_after_cut(shift, fit);
}

/// Returns the number of nodes before a tip whose radius collapses within a few radii, as where a
/// trunk continues into one of its limbs. Returns the number of all nodes if there is no such
/// collapse. The number is at least 1 unless the axis is empty.
inline std::size_t size_without_collapse(const Chain_options& rules, const Axis& axis)
{
  double widest = 0, length = 0; // of the last stretch
  for (std::size_t k = axis.size(); k-- > 0 && length <= rules.steady * widest;) {
    widest = std::max(widest, axis[k].radius);
    length += k > 0 ? (axis[k].point - axis[k - 1].point).norm() : 0;
  }
  std::size_t size = axis.size();
  if (axis.empty() || axis.back().radius >= rules.thin_base * widest)
    return size;
  while (axis[size - 1].radius < rules.thick_base * widest)
    --size;
  return size;
}

namespace internal {

/// The points near the surface of each segment of an axis.
struct Segment_coverage
{
  std::vector<double> count;           ///< number of points
  std::vector<double> lowest, highest; ///< bounds of their parameters on the segment [-]

  Segment_coverage(const Chain_view& view, const Axis_fit& fit)
    : count(fit.axis().size() - 1, 0), lowest(count.size(), 1), highest(count.size(), 0)
  {
    for (const Axis_place& p : fit.places()) {
      const double r = radius_at(fit.axis(), p);
      if (p.distance >
          r + std::max(view.rules.cover_offset * view.scan.spacing, view.rules.cover_factor * r))
        continue;
      if (p.share < 0 || p.share > 1)
        continue;
      count[p.segment] += 1;
      lowest[p.segment] = std::min(lowest[p.segment], p.share);
      highest[p.segment] = std::max(highest[p.segment], p.share);
    }
  }

  /// Returns whether segment `s` has enough of the expected points to extend the axis.
  bool is_supported(const Chain_view& view, const Axis& axis, std::size_t s) const
  {
    const double expected = 2 * pcs::internal::pi * axis[s].radius * view.set.density_at(axis, s) *
                            (axis[s + 1].point - axis[s].point).norm();
    return count[s] >= std::max(1.0, view.rules.extension_share * expected);
  }
};

/// Part of an axis. Its ends are sums of the index of a segment and a parameter in [0, 1].
struct Axis_range
{
  double begin = 0, end = 0;
};

/// Returns the part of an axis from `base` to `tip` that has points, extended outwards over
/// supported segments. Returns an empty range if there are no points.
inline Axis_range find_covered_range(const Chain_view& view,
                                     const Axis& axis,
                                     const Segment_coverage& coverage,
                                     const Vec3& base,
                                     const Vec3& tip)
{
  std::size_t from = nearest_place(axis, base).segment, to = nearest_place(axis, tip).segment;
  if (from > to)
    std::swap(from, to);
  while (from < to && coverage.count[from] == 0)
    ++from;
  while (to > from && coverage.count[to] == 0)
    --to;
  if (coverage.count[from] == 0)
    return {};
  while (from > 0 && coverage.is_supported(view, axis, from - 1))
    --from;
  while (to + 1 < coverage.count.size() && coverage.is_supported(view, axis, to + 1))
    ++to;
  return {double(from) + coverage.lowest[from], double(to) + coverage.highest[to]};
}

} // namespace internal

/// Trims both ends to the extent of the points. The axis extends outwards from the projections of
/// `base` and `tip` as far as its segments have enough points.
inline void trim(const Chain_view& view, const Vec3& base, const Vec3& tip, Axis_fit& fit)
{
  Axis& axis = fit.axis();
  const auto [begin, end] =
      internal::find_covered_range(view, axis, internal::Segment_coverage(view, fit), base, tip);
  if (!(end > begin))
    return;
  fit.estimate_errors();
  Axis result{node_at(axis, begin)};
  for (std::size_t k = static_cast<std::size_t>(begin) + 1; double(k) < end; ++k)
    result.push_back(axis[k]);
  result.push_back(node_at(axis, end));
  axis = std::move(result);
  internal::project_after_cut(static_cast<Index>(begin), fit);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_CHAIN_ENDS_H

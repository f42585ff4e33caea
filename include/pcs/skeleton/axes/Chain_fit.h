// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fit of the axis of one chain: initialization, fit, gathering of points, further fits, evaluation.

#ifndef PCS_SKELETON_AXES_CHAIN_FIT_H
#define PCS_SKELETON_AXES_CHAIN_FIT_H

#include <pcs/internal/constants.h>
#include <pcs/internal/median.h>
#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/Axis_oval.h>
#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/axes/chain_ends.h>
#include <pcs/skeleton/axes/chain_start.h>
#include <pcs/skeleton/axes/decompose_chains.h>
#include <pcs/skeleton/axes/section_counts.h>
#include <pcs/skeleton/axes/section_priors.h>
#include <pcs/skeleton/axes/section_visibility.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Fit of the axis of one chain.
class Chain_fit
{
public:
  Chain_fit(const Scan& scan, const Axis_set& set, const Chain_options& rules)
    : m_view{scan, set, rules}, m_scan(scan), m_set(set), m_rules(rules)
  {
    m_spacing = rules.node_spacing;
    m_spacing.lowest *= scan.spacing;
    m_spacing.highest *= scan.spacing;
  }

  Candidate operator()(const Layer_tree& tree, const Chain& chain) const
  {
    Candidate candidate;
    const bool is_first =
        chain.parent_node == none; // the trunk begins at the root, even if its base is thin
    const Chain_start start = start_of(m_view, tree, chain);
    candidate.number_of_own_points = start.points.size();
    if (start.points.size() < m_rules.lowest_count)
      return candidate;
    Axis_fit fit(resample(start.axis, m_spacing), Fit_model::of(m_scan.spacing, m_set.noise));
    place_own_points(start, fit);
    start_at_circles(fit);
    if (!run(fit, first_widening, chain.length))
      return candidate;
    cut_filled(m_view, fit);
    if (!is_first)
      cut_thin_base(m_view, fit);
    const Vec3 base = fit.axis().front().point, tip = fit.axis().back().point;
    prolong(m_view, true, fit.axis());
    std::vector<Index> points = gather(fit);
    if (points.size() < m_rules.lowest_count || !run(fit, 1, chain.length))
      return candidate;
    trim(m_view, base, tip, fit);
    if (follow(fit)) {
      points = gather(fit);
      if (!run(fit, 1, chain.length))
        return candidate;
    }
    cut_filled(m_view, fit);
    if (!is_first)
      cut_thin_base(m_view, fit);
    round_ovals(fit);
    judge(fit, points, candidate);
    return candidate;
  }

private:
  void place_own_points(const Chain_start& start, Axis_fit& fit) const;
  void start_at_circles(Axis_fit& fit) const;
  bool run(Axis_fit& fit, double widening, double length) const;
  std::vector<std::pair<Index, Index>> find_points_near(const Axis& axis) const;
  std::vector<Index> gather(Axis_fit& fit) const;
  Axis tail_with_piece(const Axis& axis, std::size_t first) const;
  Axis piece_ahead(const Axis& axis, std::size_t first, double skip) const;
  bool follow(Axis_fit& fit) const;
  void round_ovals(Axis_fit& fit) const;
  void judge(Axis_fit& fit, const std::vector<Index>& points, Candidate& candidate) const;

  Chain_view m_view;
  const Scan& m_scan;
  const Axis_set& m_set;
  const Chain_options& m_rules;
  Node_spacing m_spacing{};
};

inline void Chain_fit::place_own_points(const Chain_start& start, Axis_fit& fit) const
{
  // nearest segment of the resampled axis for each level-set component
  std::vector<Index> segment(start.axis.size());
  Index s = 0;
  for (std::size_t k = 0; k < start.axis.size(); ++k)
    segment[k] = s = nearest_place(fit.axis(), s, start.axis[k].point).segment;
  std::vector<Vec3> points(start.points.size());
  std::vector<Index> segments(start.points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = m_scan.points[start.points[i]];
    segments[i] = segment[start.place[i]];
  }
  fit.set_points(std::move(points), std::move(segments));
  fit.project();
}

inline void Chain_fit::start_at_circles(Axis_fit& fit) const
{
  Axis& axis = fit.axis();
  const std::size_t n = axis.size();
  std::vector<std::vector<Index>> near(n);
  for (std::size_t i = 0; i < fit.points().size(); ++i) {
    const Axis_place& p = fit.places()[i];
    near[p.segment + (p.share > 0.5 ? 1 : 0)].push_back(static_cast<Index>(i));
  }
  const double u = m_scan.spacing;
  std::vector<Circle> circles(n);
  std::vector<Vec3> e1(n), e2(n);
  std::vector<Vec2> plane;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 d = axis[std::min(n - 1, k + 1)].point - axis[k > 0 ? k - 1 : 0].point;
    const double span = d.norm();
    if (!(span > 0))
      continue;
    const Vec3 along = d / span;
    e1[k] = along.unitOrthogonal();
    e2[k] = along.cross(e1[k]);
    plane.clear();
    double length = 0;
    for (std::size_t m = k > 0 ? k - 1 : 0; m < std::min(n, k + 2); ++m) {
      for (const Index i : near[m]) {
        const Vec3 q = fit.points()[i] - axis[k].point;
        plane.emplace_back(q.dot(e1[k]), q.dot(e2[k]));
      }
      length += m + 1 < n ? (axis[m + 1].point - axis[m].point).norm() : 0;
    }
    if (plane.size() < 6)
      continue;
    const Circle c = fit_circle(plane);
    const bool is_good = c.radius > m_rules.circle_noise * m_set.noise &&
                         c.deviation < m_rules.circle_deviation * c.radius &&
                         covered_sectors(plane, c.center) >= m_rules.sectors;
    const double expected = 2 * pcs::internal::pi * c.radius * length * m_set.density_at(axis, k);
    if (is_good && double(plane.size()) >= m_rules.expected_share * expected)
      circles[k] = c;
  }
  const Section_counts counts = section_counts(m_view, fit, visible_shares(m_view, fit));
  std::vector<Vec3> shift(n, Vec3::Zero());
  for (std::size_t k = 0; k < n; ++k) {
    if (circles[k].radius > 0) {
      axis[k].point += circles[k].center.x() * e1[k] + circles[k].center.y() * e2[k];
      axis[k].radius = circles[k].radius;
    } else if (m_set.density > 0 && counts.visible_length[k] > 0) {
      const double r = counts.radius(k, m_set.density_at(fit.axis(), k));
      // so far, the radius is the deviation of the points from their mean
      const bool is_thin = std::min(axis[k].radius, r) < m_rules.thick * u;
      const Vec3 facing = is_thin ? m_set.visibility_at(fit.axis(), k) : Vec3(Vec3::Zero());
      const double spread = axis[k].radius / std::sqrt(1 - facing.squaredNorm());
      axis[k].radius = std::max(0.1 * u, std::min(spread, r));
      shift[k] = -axis[k].radius * facing;
    }
  }
  for (std::size_t k = 0; k < n; ++k)
    axis[k].point += shift[k]; // so far, the axis passed through the means of the points
  fit.project();
}

/// Iterates the fit. Returns whether it succeeded. `length` is the length over which the branch is
/// expected to taper [L]; 0 if the axis is only a piece of a branch.
inline bool Chain_fit::run(Axis_fit& fit, double widening, double length) const
{
  const std::vector<double> visible = visible_shares(m_view, fit);
  const auto use = [&](std::size_t points_per_node) {
    fit.use_every(
        std::max<std::size_t>(1, fit.points().size() / (points_per_node * fit.axis().size())));
  };
  use(m_rules.enough);
  const int ramp = widening > 1 ? m_rules.narrowing : 0, least = std::max(ramp, m_rules.fewest);
  const int full = ramp > 0 ? 0 : m_rules.full_iterations; // fits with wide weights are preliminary
  bool is_full = false;
  for (int k = 0, left = m_rules.most_iterations - full;; ++k, --left) {
    if (!is_full &&
        (left == 0 || (k >= least && fit.largest_change() < m_rules.settled * m_set.noise))) {
      is_full = true;
      left = full;
      use(m_rules.full_enough);
    }
    if (is_full && left == 0)
      break;
    if (k % 2 == 0)
      expect_sections(m_view, visible, length, fit);
    const double share = k < ramp ? double(ramp - 1 - k) / double(ramp) : 0;
    if (!fit.iterate(1 + (widening - 1) * share))
      return false;
  }
  fit.use_every(1);
  return true;
}

/// Finds the unassigned points near the axis, sorted by index. Each point is paired with the middle
/// node of a stretch of the axis near it.
inline std::vector<std::pair<Index, Index>> Chain_fit::find_points_near(const Axis& axis) const
{
  const double u = m_scan.spacing;
  // There is one query per stretch of the axis, which is at most as long as the search radius.
  // Queries at every node of a trunk would find each point about ten times.
  std::vector<std::pair<Index, Index>> found; // point, middle node of a stretch
  std::vector<Index> near;
  std::vector<double> across(axis.size());
  for (std::size_t k = 0; k < axis.size(); ++k)
    across[k] = m_rules.gather_factor * axis[k].radius + m_rules.gather_offset * u;
  for (std::size_t b = 0, e = 0; b < axis.size(); b = e) {
    double length = 0, widest = across[b];
    for (e = b + 1; e < axis.size(); ++e) {
      const double longer = length + (axis[e].point - axis[e - 1].point).norm();
      if (longer > std::max(widest, across[e]))
        break;
      length = longer;
      widest = std::max(widest, across[e]);
    }
    const std::size_t middle = b + (e - b - 1) / 2;
    double half = 0;
    for (std::size_t k = b; k < e; ++k) {
      const double before = k > 0 ? (axis[k].point - axis[k - 1].point).norm() : 0;
      const double behind = k + 1 < axis.size() ? (axis[k + 1].point - axis[k].point).norm() : 0;
      half =
          std::max(half,
                   (axis[k].point - axis[middle].point).norm() + 0.55 * std::max(before, behind));
    }
    near.clear();
    m_scan.search->append_within(axis[middle].point,
                                 std::sqrt(widest * widest + half * half),
                                 near);
    for (const Index i : near)
      if (!m_set.is_covered(i) && !m_scan.is_outlier[i])
        found.emplace_back(i, static_cast<Index>(middle));
  }
  std::sort(found.begin(), found.end());
  return found;
}

inline std::vector<Index> Chain_fit::gather(Axis_fit& fit) const
{
  fit.axis() = resample(fit.axis(), m_spacing);
  const Axis& axis = fit.axis();
  const double u = m_scan.spacing;
  const std::vector<std::pair<Index, Index>> found = find_points_near(axis);
  const std::vector<Axis_segment> lines = segments_of(axis);
  std::vector<Index> points, segments;
  std::vector<Vec3> positions;
  for (std::size_t b = 0, e = 0; b < found.size(); b = e) {
    while (e < found.size() && found[e].first == found[b].first)
      ++e;
    const Vec3& p = m_scan.points[found[b].first];
    // the nearest of the middle nodes with which this point is paired
    Index node = found[b].second;
    double best = (axis[node].point - p).squaredNorm();
    for (std::size_t k = b + 1; k < e; ++k) {
      const double d = (axis[found[k].second].point - p).squaredNorm();
      if (d < best) {
        best = d;
        node = found[k].second;
      }
    }
    const Axis_place place = nearest_place(lines, node, p);
    if (place.distance > m_rules.gather_factor * radius_at(axis, place) + m_rules.gather_offset * u)
      continue;
    points.push_back(found[b].first);
    segments.push_back(place.segment);
    positions.push_back(p);
  }
  fit.set_points(std::move(positions), std::move(segments));
  fit.project();
  return points;
}

/// Refits the last nodes of a thick axis, with an additional piece beyond its tip. Returns an empty
/// axis if the points do not support the extension.
inline Axis Chain_fit::tail_with_piece(const Axis& axis, std::size_t first) const
{
  Axis_fit fit(Axis(axis.begin() + static_cast<std::ptrdiff_t>(first), axis.end()),
               Fit_model::of(m_scan.spacing, m_set.noise));
  const double radius = axis.back().radius, tail = length_of(fit.axis());
  const Vec3 base = fit.axis().front().point, tip = fit.axis().back().point;
  prolong(m_view, false, fit.axis());
  const double wanted = (fit.axis().back().point - tip).norm();
  if (gather(fit).size() < m_rules.lowest_count || !run(fit, 1.5, 0))
    return {};
  trim(m_view, base, tip, fit);
  const Axis& longer = fit.axis();
  const std::size_t last = longer.size() - 1;
  const bool is_good =
      length_of(longer) - tail >= 0.3 * wanted && longer.back().radius >= 0.6 * radius &&
      !Filling(m_view, fit).is_filled(last - std::min<std::size_t>(last, 4), last, m_rules.filled);
  return is_good ? longer : Axis();
}

/// Fits a hollow piece of similar radius straight ahead of a thick axis, `skip` [L] beyond its tip.
/// Returns an empty axis if there is none.
inline Axis Chain_fit::piece_ahead(const Axis& axis, std::size_t first, double skip) const
{
  const double radius = axis.back().radius, length = 4 * radius + 8 * m_scan.spacing;
  const Vec3 tip = axis.back().point, along = (tip - axis[first].point).normalized();
  Axis_node base = axis.back(), end = axis.back();
  base.point = tip + skip * along;
  end.point = base.point + length * along;
  const Vec3 middle = 0.5 * (base.point + end.point);
  Axis_fit fit({base, end}, Fit_model::of(m_scan.spacing, m_set.noise));
  if (gather(fit).size() < m_rules.lowest_count || !run(fit, 1, 0))
    return {};
  trim(m_view, middle, middle, fit);
  const Axis& piece = fit.axis();
  const Vec3 d = piece.front().point - tip;
  const double before = d.dot(along), ratio = piece.front().radius / radius;
  const bool is_straight = before > 0 && (d - before * along).norm() < radius &&
                           along.dot(piece.back().point - piece.front().point) >= 0.5 * length;
  const Filling filling(m_view, fit);
  const bool is_good = is_straight && ratio > 0.6 && ratio < 1.25 &&
                       filling.share(0, piece.size() - 1) < m_rules.filled;
  return is_good ? piece : Axis();
}

/*!
  Extends a thick branch beyond its tip, piece by piece, as long as points surround it. This is
  needed because shortest paths over the surface end at occlusions or turn into a side branch. A tip
  whose radius collapses is removed first. Where points lie inside the branch, as at a whorl, its
  continuation is searched straight ahead. Returns whether the axis was extended; otherwise it is
  unchanged.
*/
inline bool Chain_fit::follow(Axis_fit& fit) const
{
  constexpr int most_pieces = 100;
  const double u = m_scan.spacing;
  Axis& axis = fit.axis();
  bool is_longer = false;
  const Axis whole = axis;
  axis.resize(size_without_collapse(m_rules, axis));
  const double thickest = 1.1 * axis.back().radius;
  for (int piece = 0; piece < most_pieces; ++piece) {
    const double radius = axis.back().radius;
    if (radius < m_rules.thick * u || axis.size() < 4)
      break;
    double tail = 0;
    std::size_t b = axis.size() - 1;
    while (b > 0 && (tail < 4 * radius + 8 * u || axis.size() - b < 4)) {
      tail += (axis[b].point - axis[b - 1].point).norm();
      --b;
    }
    Axis longer = tail_with_piece(axis, b);
    const bool is_connected = !longer.empty() && longer.back().radius <= thickest;
    if (is_connected)
      axis.resize(b + 1); // the nodes beyond it were refitted
    else
      longer.clear();
    for (int k = 1; k <= m_rules.most_skipped && longer.empty(); ++k)
      longer = piece_ahead(axis, b, k * m_rules.extension * radius);
    if (longer.empty() || longer.back().radius > thickest)
      break;
    axis.insert(axis.end(), longer.begin() + (is_connected ? 1 : 0), longer.end());
    is_longer = true;
  }
  if (!is_longer)
    axis = whole;
  return is_longer;
}

/*!
  Estimates the ovality of a thick axis with one-sided visibility, removes it from the points, and
  refits the axis. Otherwise ovality would bias centers and radii: the error of a circle fitted to
  half of an ellipse is as large as the difference of the semi-axes.
*/
inline void Chain_fit::round_ovals(Axis_fit& fit) const
{
  const Oval_options& rules = m_rules.ovals;
  std::vector<double> radii, facing;
  for (const Axis_node& node : fit.axis())
    radii.push_back(node.radius);
  if (pcs::internal::lower_median(radii) <
      std::max(rules.thickness * m_set.noise, rules.spacings * m_scan.spacing))
    return;
  const Section_visibility sides(m_view, fit);
  for (std::size_t k = 0; k < radii.size(); ++k)
    if (sides.count[k] > 0)
      facing.push_back(sides.normal[k].norm());
  if (facing.empty() || pcs::internal::lower_median(facing) < rules.one_sided)
    return;
  Axis_oval oval(fit.axis());
  const std::vector<Vec3> points = fit.points();
  for (int round = 0; round < rules.rounds; ++round) {
    const Eigen::Vector2d before = oval.coefficients();
    oval.improve(fit, m_set.noise, rules);
    if ((oval.coefficients() - before).norm() < rules.settled)
      return;
    std::vector<Index> segments;
    for (const Axis_place& p : fit.places())
      segments.push_back(p.segment);
    fit.set_points(oval.rounded(points, fit), std::move(segments));
    fit.project();
    if (!run(fit, 1, 0)) {
      fit.use_every(1);
      return;
    }
  }
}

inline void
Chain_fit::judge(Axis_fit& fit, const std::vector<Index>& points, Candidate& candidate) const
{
  const Axis& axis = fit.axis();
  const double u = m_scan.spacing, s = m_set.noise;
  const Section_counts counts = section_counts(m_view, fit, visible_shares(m_view, fit));
  // only hollow, well-sampled sections represent the surface
  const Filling filling(m_view, fit);
  std::vector<std::uint8_t> is_odd(axis.size(), 0);
  for (std::size_t k = 0; k < axis.size(); ++k)
    is_odd[k] = counts.density(k, axis[k].radius) < m_rules.typical * m_set.density ||
                filling.is_filled(k >= 2 ? k - 2 : 0, std::min(axis.size(), k + 3), m_rules.bush);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Axis_place& p = fit.places()[k];
    const double r = radius_at(axis, p);
    if (p.distance > r + std::max(m_rules.cover_offset * u, m_rules.cover_factor * r))
      continue;
    candidate.points.push_back(points[k]);
    candidate.segments.push_back(p.segment);
    const bool is_inside = p.share > 0 && p.share < 1;
    // only where noise exceeds the roughness of the bark
    if (is_inside && !is_odd[p.segment] && r > 3 * s && 0.03 * r < s &&
        candidate.deviations.size() < 2000)
      candidate.deviations.push_back(std::abs(p.distance - r));
  }
  if (candidate.points.size() < m_rules.lowest_count)
    return;
  const Section_visibility sides(m_view, fit);
  for (std::size_t k = 2; k + 2 < axis.size(); ++k)
    if (!is_odd[k] && axis[k].is_measured && axis[k].radius > 2.5 * s &&
        axis[k].radius_error < 0.15 * axis[k].radius &&
        counts.visible_length[k] > m_rules.visible * counts.length[k])
      candidate.densities.push_back({counts.density(k, axis[k].radius),
                                     axis[k].radius,
                                     axis[k].point,
                                     (axis[k + 1].point - axis[k - 1].point).normalized(),
                                     sides.normal[k]});
  candidate.axis = axis;
  for (Axis_node& node : candidate.axis) {
    const double r2 = node.radius * node.radius - m_rules.noise_share * s * s;
    // the correction for noise removes at most half of a radius
    node.radius = std::max(0.5 * node.radius, std::sqrt(std::max(0.0, r2)));
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_CHAIN_FIT_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// From a chain of layer parts to a fitted axis: start, fit, gather again, fit again, judge.

#ifndef PCS_SKELETON_CHAIN_FIT_H
#define PCS_SKELETON_CHAIN_FIT_H

#include <pcs/skeleton/Axis_fit.h>
#include <pcs/skeleton/Axis_set.h>
#include <pcs/skeleton/chains.h>
#include <pcs/skeleton/circle_fit.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Rules of the fit of one chain. Factors of the spacing unless said otherwise [-].
struct Chain_rules
{
  Node_spacing node_spacing{0.6, 2, 8}; ///< the factor is of the radius
  double gather_factor = 1.25;          ///< points within this many radii ...
  double gather_offset = 1.7;           ///< ... and this many spacings are looked at again
  double cover_factor = 0.15;     ///< points this many radii outside of the surface are explained,
  double cover_offset = 1.1;      ///< ... or this many spacings
  double explained = 0.4;         ///< share of its own points that a chain must explain
  double protrusion = 3;          ///< how far an axis must leave those that are there
  double protrusion_radius = 0.3; ///< ... and this many radii of those
  int sectors = 5;                ///< of 12, that a circle must see to be a start
  double circle_deviation = 0.25; ///< largest deviation of such a circle in radii
  double circle_noise = 2.5;      ///< smallest radius of such a circle in noise
  double expected_share =
      0.25; ///< circles with fewer points than this share of the expected straddle several twigs
  double prior_share = 0.5;   ///< standard deviation of the radius by counting, in radii ...
  double prior_offset = 0.15; ///< ... and spacings
  double noise_share = 0.2;   ///< r^2 is reduced by this many noise^2: noise inflates thin branches
  double thick = 4;           ///< branches of at least this radius are followed beyond their tips
  double swelling = 1.2;      ///< thick axes end where they are this much thicker than below ...
  double swelling_offset = 1; ///< ... and this many spacings
  double extension = 3;       ///< how far both ends are prolonged on trial, in radii ...
  double extension_offset = 4;  ///< ... and spacings
  double extension_share = 0.3; ///< share of the expected points that a prolongation needs
  std::size_t lowest_count = 4; ///< points of an axis
  int iterations = 4;           ///< of each of the two fits
};

/// An axis that is not yet accepted.
struct Candidate
{
  Axis axis;                           ///< empty: none
  std::vector<Index> points, segments; ///< what it explains, points in increasing order
  std::size_t number_of_own_points = 0;
  std::vector<double> deviations;
  std::vector<Density_sample> densities;
};

class Chain_fit
{
public:
  Chain_fit(const Scan& scan, const Axis_set& set, const Chain_rules& rules)
    : m_scan(scan), m_set(set), m_rules(rules)
  {
    m_spacing = rules.node_spacing;
    m_spacing.lowest *= scan.spacing;
    m_spacing.highest *= scan.spacing;
  }

  Candidate operator()(const Layer_tree& tree, const Chain& chain) const
  {
    Candidate candidate;
    Start start = start_of(tree, chain);
    candidate.number_of_own_points = start.points.size();
    if (start.points.size() < m_rules.lowest_count)
      return candidate;
    Axis_fit fit(resample(start.axis, m_spacing), Fit_model::of(m_scan.spacing, m_set.noise));
    place_own_points(start, fit);
    start_at_circles(fit);
    if (!run(fit, first_widening))
      return candidate;
    cut_swelling(fit);
    const Vec3 base = fit.axis().front().point, tip = fit.axis().back().point;
    prolong(fit);
    std::vector<Index> points = gather(fit);
    if (points.size() < m_rules.lowest_count || !run(fit, 1))
      return candidate;
    trim(base, tip, fit);
    if (follow(fit)) {
      points = gather(fit);
      if (!run(fit, 1))
        return candidate;
    }
    judge(fit, points, candidate);
    return candidate;
  }

private:
  struct Start
  {
    Axis axis;
    std::vector<Index> points;
    std::vector<std::size_t> place; ///< node of `axis` that a point belongs to
  };

  Start start_of(const Layer_tree& tree, const Chain& chain) const;
  void place_own_points(const Start& start, Axis_fit& fit) const;
  void start_at_circles(Axis_fit& fit) const;
  void set_priors(Axis_fit& fit) const;
  bool run(Axis_fit& fit, double widening) const;
  std::vector<Index> gather(Axis_fit& fit) const;
  void prolong(Axis_fit& fit, bool do_base = true) const;
  bool follow(Axis_fit& fit) const;
  void cut_swelling(Axis_fit& fit) const;
  void trim(const Vec3& base, const Vec3& tip, Axis_fit& fit) const;
  void judge(Axis_fit& fit, const std::vector<Index>& points, Candidate& candidate) const;
  /// Points of each node, and the length of axis they stand for, over a window of nodes.
  std::pair<std::vector<double>, std::vector<double>> counts(const Axis_fit& fit) const;

  const Scan& m_scan;
  const Axis_set& m_set;
  const Chain_rules& m_rules;
  Node_spacing m_spacing{};
};

inline Chain_fit::Start Chain_fit::start_of(const Layer_tree& tree, const Chain& chain) const
{
  Start start;
  const double u = m_scan.spacing;
  for (const Index v : chain.nodes) {
    Vec3 center = Vec3::Zero();
    const std::size_t before = start.points.size();
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
      if (!m_set.is_covered(tree.point[k])) {
        start.points.push_back(tree.point[k]);
        start.place.push_back(start.axis.size());
        center += m_scan.points[tree.point[k]];
      }
    if (start.points.size() == before)
      continue;
    Axis_node node;
    node.point = center / double(start.points.size() - before);
    start.axis.push_back(node);
  }
  if (start.points.size() < m_rules.lowest_count)
    return start;
  Axis& axis = start.axis;
  if (axis.size() == 1) { // a line through its points
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Index i : start.points) {
      const Vec3 d = m_scan.points[i] - axis[0].point;
      covariance += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    Vec3 along = solver.eigenvectors().col(2);
    const Vec3 from = chain.parent_node != none
                          ? Vec3(axis[0].point - tree.center[chain.parent_node])
                          : Vec3(Vec3::UnitZ());
    if (along.dot(from) < 0)
      along = -along;
    const double half = 0.5 * layer_thickness * u;
    Axis_node tip = axis[0];
    axis[0].point -= half * along;
    tip.point += half * along;
    axis.push_back(tip);
    std::fill(start.place.begin(), start.place.end(), 0);
  } else {
    for (int pass = 0; pass < 2; ++pass) { // the layers are ragged
      Axis smooth = axis;
      for (std::size_t k = 1; k + 1 < axis.size(); ++k)
        smooth[k].point = 0.25 * axis[k - 1].point + 0.5 * axis[k].point + 0.25 * axis[k + 1].point;
      axis = smooth;
    }
    // the centres of the outermost layers lie half a layer inside
    const auto extend = [&](Axis_node& end, const Axis_node& inner) {
      const Vec3 d = end.point - inner.point;
      const double length = d.norm();
      if (length > 0)
        end.point += 0.5 * layer_thickness * u * d / length;
    };
    const Axis_node second = axis[1], last = axis[axis.size() - 2];
    extend(axis.front(), second);
    extend(axis.back(), last);
  }
  // mean squared distance across the axis as a first radius
  std::vector<double> sum(axis.size(), 0), count(axis.size(), 0);
  for (std::size_t i = 0; i < start.points.size(); ++i) {
    const std::size_t k = start.place[i];
    const Axis_place foot = nearest_place(axis, k, m_scan.points[start.points[i]]);
    sum[k] += foot.distance * foot.distance;
    count[k] += 1;
  }
  for (std::size_t k = 0; k < axis.size(); ++k)
    axis[k].radius = count[k] > 0 ? std::max(0.2 * u, std::sqrt(sum[k] / count[k]))
                                  : (k > 0 ? axis[k - 1].radius : 0.2 * u);
  return start;
}

inline void Chain_fit::place_own_points(const Start& start, Axis_fit& fit) const
{
  // the segment of each layer, walking along the resampled axis
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

inline std::pair<std::vector<double>, std::vector<double>>
Chain_fit::counts(const Axis_fit& fit) const
{
  const Axis& axis = fit.axis();
  const std::size_t n = axis.size();
  std::vector<double> own(n, 0), length(n, 0);
  const double limit = tukey_constant * m_set.noise;
  for (const Axis_place& p : fit.places()) {
    if (p.share < 0 || p.share > 1)
      continue;
    const double r = radius_at(axis, p);
    if (std::abs(p.distance - r) > std::max(limit, tukey_constant * 0.04 * r))
      continue;
    own[p.segment] += 1 - p.share;
    own[p.segment + 1] += p.share;
  }
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const double l = 0.5 * (axis[k + 1].point - axis[k].point).norm();
    length[k] += l;
    length[k + 1] += l;
  }
  std::vector<double> count(n), window(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t begin = k >= 2 ? k - 2 : 0, end = std::min(n, k + 3);
    for (std::size_t i = begin; i < end; ++i) {
      count[k] += own[i];
      window[k] += length[i];
    }
  }
  return {std::move(count), std::move(window)};
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
    const double expected = 2 * 3.14159265358979323846 * c.radius * length * m_set.density;
    if (is_good && double(plane.size()) >= m_rules.expected_share * expected)
      circles[k] = c;
  }
  const auto priors = counts(fit);
  for (std::size_t k = 0; k < n; ++k) {
    if (circles[k].radius > 0) {
      axis[k].point += circles[k].center.x() * e1[k] + circles[k].center.y() * e2[k];
      axis[k].radius = circles[k].radius;
    } else if (m_set.density > 0 && priors.second[k] > 0) {
      const double r =
          priors.first[k] / (2 * 3.14159265358979323846 * m_set.density * priors.second[k]);
      axis[k].radius = std::max(0.1 * u, std::min(axis[k].radius, r));
    }
  }
  fit.project();
}

inline void Chain_fit::set_priors(Axis_fit& fit) const
{
  std::vector<Radius_prior> priors(fit.axis().size());
  if (m_set.density > 0) {
    const auto [count, length] = counts(fit);
    for (std::size_t k = 0; k < priors.size(); ++k)
      if (length[k] > 0) {
        priors[k].radius = count[k] / (2 * 3.14159265358979323846 * m_set.density * length[k]);
        priors[k].deviation =
            m_rules.prior_share * priors[k].radius + m_rules.prior_offset * m_scan.spacing;
      }
  }
  fit.set_priors(std::move(priors));
}

inline bool Chain_fit::run(Axis_fit& fit, double widening) const
{
  for (int k = 0; k < m_rules.iterations; ++k) {
    if (k % 2 == 0)
      set_priors(fit);
    const double share = double(m_rules.iterations - 1 - k) / double(m_rules.iterations);
    if (!fit.iterate(1 + (widening - 1) * share))
      return false;
  }
  return true;
}

inline std::vector<Index> Chain_fit::gather(Axis_fit& fit) const
{
  fit.axis() = resample(fit.axis(), m_spacing);
  const Axis& axis = fit.axis();
  const double u = m_scan.spacing;
  std::vector<std::pair<Index, Index>> found; // point, node
  std::vector<Index> near;
  for (std::size_t k = 0; k < axis.size(); ++k) {
    const double before = k > 0 ? (axis[k].point - axis[k - 1].point).norm() : 0;
    const double behind = k + 1 < axis.size() ? (axis[k + 1].point - axis[k].point).norm() : 0;
    const double across = m_rules.gather_factor * axis[k].radius + m_rules.gather_offset * u;
    const double half = 0.55 * std::max(before, behind);
    near.clear();
    m_scan.search->within(axis[k].point, std::sqrt(across * across + half * half), near);
    for (const Index i : near)
      if (!m_set.is_covered(i) && !m_scan.is_outlier[i])
        found.emplace_back(i, static_cast<Index>(k));
  }
  std::sort(found.begin(), found.end());
  std::vector<Index> points, segments;
  std::vector<Vec3> positions;
  for (std::size_t b = 0, e = 0; b < found.size(); b = e) {
    while (e < found.size() && found[e].first == found[b].first)
      ++e;
    const Vec3& p = m_scan.points[found[b].first];
    // the nearest of the nodes that found it
    Index node = found[b].second;
    double best = (axis[node].point - p).squaredNorm();
    for (std::size_t k = b + 1; k < e; ++k) {
      const double d = (axis[found[k].second].point - p).squaredNorm();
      if (d < best) {
        best = d;
        node = found[k].second;
      }
    }
    const Axis_place place = nearest_place(axis, node, p);
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

/// Adds straight pieces at both ends; the points decide later how much of them stays.
inline void Chain_fit::prolong(Axis_fit& fit, bool do_base) const
{
  Axis& axis = fit.axis();
  const auto piece = [&](bool is_tip) {
    const std::size_t n = axis.size();
    const auto node = [&](std::size_t k) -> const Axis_node& {
      return axis[is_tip ? n - 1 - k : k];
    };
    const double reach = 2 * node(0).radius + 4 * m_scan.spacing;
    std::size_t k = 1;
    while (k + 1 < n && (node(k).point - node(0).point).norm() < reach)
      ++k;
    Vec3 d = node(0).point - node(k).point;
    const double length = d.norm();
    Axis_node end = node(0);
    if (length > 0)
      end.point +=
          d / length * (m_rules.extension * end.radius + m_rules.extension_offset * m_scan.spacing);
    return end;
  };
  const Axis_node before = piece(false), behind = piece(true);
  if (do_base)
    axis.insert(axis.begin(), before);
  axis.push_back(behind);
}

/// Ends an axis that was thick where it grows much thicker: from there on it runs around a fork.
inline void Chain_fit::cut_swelling(Axis_fit& fit) const
{
  constexpr std::size_t window = 5;
  Axis& axis = fit.axis();
  double thinnest = std::numeric_limits<double>::infinity();
  std::vector<double> radii;
  for (std::size_t k = window; k < axis.size(); ++k) {
    radii.clear();
    for (std::size_t i = k - window; i < k; ++i)
      radii.push_back(axis[i].radius);
    const double before = median(radii);
    if (before >= m_rules.thick * m_scan.spacing)
      thinnest = std::min(thinnest, before);
    if (axis[k].radius > m_rules.swelling * thinnest + m_rules.swelling_offset * m_scan.spacing) {
      axis.resize(k);
      return;
    }
  }
}

/*!
  Follows a thick branch beyond its tip, piece by piece, as long as there are points around it: paths over the surface
  end at occlusions, or turn into a side branch. Returns whether the axis grew.
*/
inline bool Chain_fit::follow(Axis_fit& fit) const
{
  constexpr int most_pieces = 100;
  const double u = m_scan.spacing;
  Axis& axis = fit.axis();
  bool is_longer = false;
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
    Axis_fit tail_fit(Axis(axis.begin() + static_cast<std::ptrdiff_t>(b), axis.end()),
                      Fit_model::of(u, m_set.noise));
    const Vec3 base = tail_fit.axis().front().point, tip = tail_fit.axis().back().point;
    prolong(tail_fit, false);
    const double wanted = (tail_fit.axis().back().point - tip).norm();
    if (gather(tail_fit).size() < m_rules.lowest_count || !run(tail_fit, 1.5))
      break;
    trim(base, tip, tail_fit);
    const Axis& longer = tail_fit.axis();
    const double gained = length_of(longer) - tail;
    const double ratio = longer.back().radius / radius;
    if (gained < 0.3 * wanted || ratio < 0.6 || ratio > 1.1)
      break;
    axis.resize(b + 1);
    axis.insert(axis.end(), longer.begin() + 1, longer.end());
    is_longer = true;
  }
  return is_longer;
}

/// Cuts the ends where the points end: outwards from the places of `base` and `tip`, as far as there are enough.
inline void Chain_fit::trim(const Vec3& base, const Vec3& tip, Axis_fit& fit) const
{
  Axis& axis = fit.axis();
  const std::size_t segments_of_axis = axis.size() - 1;
  std::vector<double> count(segments_of_axis, 0), lowest(segments_of_axis, 1),
      highest(segments_of_axis, 0);
  for (const Axis_place& p : fit.places()) {
    const double r = radius_at(axis, p);
    if (p.distance > r + std::max(m_rules.cover_offset * m_scan.spacing, m_rules.cover_factor * r))
      continue;
    if (p.share < 0 || p.share > 1)
      continue;
    count[p.segment] += 1;
    lowest[p.segment] = std::min(lowest[p.segment], p.share);
    highest[p.segment] = std::max(highest[p.segment], p.share);
  }
  const auto is_supported = [&](std::size_t s) {
    const double expected = 2 * 3.14159265358979323846 * axis[s].radius * m_set.density *
                            (axis[s + 1].point - axis[s].point).norm();
    return count[s] >= std::max(1.0, m_rules.extension_share * expected);
  };
  std::size_t from = nearest_place(axis, base).segment, to = nearest_place(axis, tip).segment;
  if (from > to)
    std::swap(from, to);
  while (from < to && count[from] == 0)
    ++from;
  while (to > from && count[to] == 0)
    --to;
  if (count[from] == 0)
    return;
  while (from > 0 && is_supported(from - 1))
    --from;
  while (to + 1 < segments_of_axis && is_supported(to + 1))
    ++to;
  const double begin = double(from) + lowest[from], end = double(to) + highest[to];
  Axis result;
  const auto cut = [&](double a) {
    const std::size_t s = std::min(axis.size() - 2, static_cast<std::size_t>(a));
    Axis_node node = a - double(s) < 0.5 ? axis[s] : axis[s + 1];
    const double t = a - double(s);
    node.point = (1 - t) * axis[s].point + t * axis[s + 1].point;
    node.radius = (1 - t) * axis[s].radius + t * axis[s + 1].radius;
    return node;
  };
  if (!(end > begin))
    return;
  fit.estimate_errors();
  result.push_back(cut(begin));
  for (std::size_t k = static_cast<std::size_t>(begin) + 1; double(k) < end; ++k)
    result.push_back(axis[k]);
  result.push_back(cut(end));
  axis = std::move(result);
  std::vector<Vec3> points = fit.points();
  std::vector<Index> segments;
  segments.reserve(points.size());
  for (const Axis_place& p : fit.places()) {
    const Index shift = static_cast<Index>(begin);
    segments.push_back(p.segment > shift ? p.segment - shift : 0);
  }
  fit.set_points(std::move(points), std::move(segments));
  fit.project();
}

inline void
Chain_fit::judge(Axis_fit& fit, const std::vector<Index>& points, Candidate& candidate) const
{
  const Axis& axis = fit.axis();
  const double u = m_scan.spacing, s = m_set.noise;
  const auto [count, length] = counts(fit);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Axis_place& p = fit.places()[k];
    const double r = radius_at(axis, p);
    if (p.distance > r + std::max(m_rules.cover_offset * u, m_rules.cover_factor * r))
      continue;
    candidate.points.push_back(points[k]);
    candidate.segments.push_back(p.segment);
    const bool is_inside = p.share > 0 && p.share < 1;
    // where noise, not bark, is what one sees
    if (is_inside && r > 3 * s && 0.03 * r < s && candidate.deviations.size() < 2000)
      candidate.deviations.push_back(std::abs(p.distance - r));
  }
  if (candidate.points.size() < m_rules.lowest_count)
    return;
  for (std::size_t k = 2; k + 2 < axis.size(); ++k)
    if (axis[k].is_measured && axis[k].radius > 2.5 * s &&
        axis[k].radius_error < 0.15 * axis[k].radius)
      candidate.densities.push_back(
          {count[k] / (2 * 3.14159265358979323846 * axis[k].radius * length[k]),
           axis[k].radius,
           axis[k].point});
  candidate.axis = axis;
  for (Axis_node& node : candidate.axis) {
    const double r2 = node.radius * node.radius - m_rules.noise_share * s * s;
    // noise cannot take more than half of a radius away
    node.radius = std::max(0.5 * node.radius, std::sqrt(std::max(0.0, r2)));
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CHAIN_FIT_H

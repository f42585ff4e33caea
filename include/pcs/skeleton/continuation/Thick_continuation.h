// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trial pieces that continue a thick axis where few points are left.

#ifndef PCS_SKELETON_CONTINUATION_THICK_CONTINUATION_H
#define PCS_SKELETON_CONTINUATION_THICK_CONTINUATION_H

#include <pcs/internal/constants.h>
#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for the continuation of thick bases. Lengths are in radii of the base unless stated
/// otherwise [-].
struct Thick_end_options
{
  double thinnest = 1.5;  ///< least radius of a base, in spacings ...
  double noise = 12;      ///< ... and in noise: a hollow interior is then recognized
  double firm_base = 0.9; ///< a thin base ends at this fraction of the steady radius [-]
  double piece = 4;       ///< length of a short trial piece, and of the tail that is fitted again
  double steepest = 0.9;  ///< largest angle between a base and its continuation [rad]
  double band = 0.25;     ///< half thickness of the wall of a tube when directions are compared
  double radius_share = 0.2; ///< standard deviation of the radius of a piece, in radii [-]
  std::size_t fewest = 8;    ///< least number of points on a piece [count]
  double sectors = 0.7;      ///< least number of sectors with points, relative to random points [-]
  double filled = 0.33;      ///< largest fraction of its points inside; 0.67 for random points [-]
  double shortest = 0.4;     ///< least length of a piece, in lengths of the trial piece [-]
  double thinner = 0.6, thicker = 1.6; ///< bounds on the radius of a piece
  double widest = 3;                   ///< largest radius of the new base
  int most_pieces = 100;               ///< most successive pieces [count]
  double touch = 0.5; ///< largest gap to the surface of another axis at which a base is joined ...
  double touched = 0.6;  ///< ... if that axis has at least this radius
  double at_root = 3;    ///< distance from a point of the root at which a base is joined
  double least = 4;      ///< shorter gaps are left to `join_axes()`
  double released = 0.6; ///< axes below this radius may lose their points ...
  double small = 0.1; ///< ... and axes with fewer points, as a fraction of the continued axis [-]
  double lost = 0.5;  ///< axes that lose a larger fraction of their points are dropped [-]
  double narrowed = 0.75;   ///< bases below this fraction of the steady radius are no bases [-]
  double crest = 0.97;      ///< the thickest place has this fraction of the steady radius [-]
  double taper = 0.03;      ///< largest change of the radius per length of a branch [-]
  double corner = 3;        ///< length without nodes beside the corner of a fork
  double longest = 35;      ///< longest tube
  double widest_turn = 1.1; ///< largest angle between a base and the tube to its target [rad]
  double widest_gap = 6;    ///< longest stretch of a continuation without points
  double loose = 8;         ///< distance within which a loose base has no wood of similar thickness

  /// Returns the least radius of a thick base for a spacing and a noise [L].
  double least_radius(double spacing, double deviation) const
  {
    return std::max(thinnest * spacing, noise * deviation);
  }
};

/// Place at which a continuation may end.
struct Thick_target
{
  Vec3 point;
  double radius; ///< of the axis there [L]
};

/// How a continuation is searched.
struct Thick_trial
{
  double first, second;    ///< lengths of the pieces, in `Thick_end_options::piece` [-]
  bool does_radius_change; ///< whether other radii are tried
};

/*!
  Continues a line of nodes beyond its last node, which is the base of a thick axis of radius
  `r` [L]. The continuation consists of pieces that the points support as in scans of wood: they lie
  on a tube around a hollow interior. Neither the density nor the links of the points matter, so
  that ten points are sufficient.

  Each piece begins as the straight tube of length `L` [L] and radius `q` [L] with the largest score

      sum_i max(0, 1 - |x_i| / band) - 2 |{i : x_i < -band}|,   x_i = a_i / q - 1                [-]

  over the points at the distances `a_i` [L] from its axis, less `ring / 4` for bends and
  `2 (q / r - 1)` for changes of the radius. Directions are sampled in `rings` rings up to the angle
  `steepest`. The piece and the tail of the line are then fitted by `Axis_fit`. A piece is kept if

  - `on >= fewest` points lie within `d = max(filled_noise s, filled_depth r)` [L] of its surface
    (`Chain_options`), with the noise `s` [L];
  - at most the fraction `filled` of its points is deeper inside;
  - they cover at least the fraction `sectors` of the `12 (1 - (11 / 12)^on)` sectors that random
    points would cover;
  - length and radius are within the bounds of `Thick_end_options`.

  A tube to a target, which is a place on another axis, follows a parabola. Its radius changes
  linearly. Its score is the sum above, less `10 b` for a bend by `b` lengths of its chord. It is
  fitted and kept in the same way; in addition, no stretch longer than `widest_gap` is without
  points on the surface, up to the radius of the target. Few points per length are then sufficient
  on straight limbs.
*/
class Thick_continuation
{
public:
  Thick_continuation(const Scan& scan,
                     double noise,
                     const Chain_options& chains,
                     const Thick_end_options& rules)
    : m_scan(scan), m_noise(noise), m_chains(chains), m_rules(rules)
  {
  }

  /// Adds a piece of `length` [L] to `line` if the points `near` support it. Returns whether it was
  /// added.
  bool extend(const std::vector<Index>& near,
              double length,
              const std::vector<double>& ratios,
              Axis& line)
  {
    const Axis_node end = line.back();
    const std::size_t first = first_of_tail(line);
    const Vec3 along = (end.point - line[first].point).normalized();
    Axis trial(line.begin() + static_cast<std::ptrdiff_t>(first), line.end());
    const std::size_t seam = trial.size() - 1;
    append(best_end(end, along, length, ratios, near), length, trial);
    Axis_fit fit(trial, Fit_model::of(m_scan.spacing, m_noise));
    if (!run(near, fit))
      return false;
    const double at = supported_end(fit, seam);
    if (!(at > double(seam)))
      return false;
    Axis longer = fit.axis();
    const Axis_node last = node_at(longer, at);
    const Vec3 gained = last.point - end.point;
    if (gained.norm() < m_rules.shortest * length || !(gained.dot(along) > 0) ||
        last.radius < m_rules.thinner * end.radius || last.radius > m_rules.thicker * end.radius)
      return false;
    longer.resize(std::min(longer.size(), static_cast<std::size_t>(std::ceil(at))));
    longer.push_back(last);
    line.resize(first);
    line.insert(line.end(), longer.begin(), longer.end());
    return true;
  }

  /// Adds a tube from the end of `line` to one of the `targets` if the points `near` support it
  /// along its whole length. Returns whether it was added.
  bool connect(const std::vector<Index>& near, const std::vector<Thick_target>& targets, Axis& line)
  {
    const Axis_node end = line.back();
    const std::size_t first = first_of_tail(line);
    const Bent_tube tube = best_tube(end, targets, near);
    if (!(tube.score > 0))
      return false;
    Axis trial(line.begin() + static_cast<std::ptrdiff_t>(first), line.end());
    const std::size_t seam = trial.size() - 1;
    Axis_node last = end;
    last.point = tube.target.point;
    last.radius = tube.radius;
    append(last, (last.point - end.point).norm(), trial);
    for (std::size_t k = seam + 1; k < trial.size(); ++k) {
      const double t = double(k - seam) / double(trial.size() - 1 - seam);
      trial[k].point += 4 * t * (1 - t) * tube.bend;
      trial[k].radius = (1 - t) * end.radius + t * tube.radius;
    }
    Axis_fit fit(trial, Fit_model::of(m_scan.spacing, m_noise));
    if (!run(near, fit) || !(supported_end(fit, seam) > double(seam)))
      return false;
    const Axis& longer = fit.axis();
    if (widest_gap(fit, seam, tube.target) > m_rules.widest_gap * end.radius ||
        (longer.back().point - tube.target.point).norm() > tube.target.radius + end.radius)
      return false;
    for (std::size_t k = seam; k < longer.size(); ++k)
      if (longer[k].radius < m_rules.thinner * end.radius ||
          longer[k].radius > m_rules.widest * end.radius)
        return false;
    line.resize(first);
    line.insert(line.end(), longer.begin(), longer.end());
    return true;
  }

private:
  /// Tube along a parabola.
  struct Bent_tube
  {
    double score = 0;
    double radius = 0;        ///< at the target [L]
    Vec3 bend = Vec3::Zero(); ///< offset of its middle from the chord [L]
    Thick_target target{Vec3::Zero(), 0};
  };

  /// Returns the first node of the part of a line that is fitted again.
  std::size_t first_of_tail(const Axis& line) const
  {
    const Axis_node& end = line.back();
    std::size_t first = line.size() - 1;
    while (first > 0 && (line[first].point - end.point).norm() < m_rules.piece * end.radius)
      --first;
    return first;
  }

  /// Point beside a chord.
  struct Chord_point
  {
    Vec3 offset;  ///< from the chord [L]
    double share; ///< of the chord at which it lies [-]
  };

  /// Returns the points, relative to the end, that lie on or inside tubes of at most the radius
  /// `thickest` [L] along a chord with bends by at most `bend` lengths.
  std::vector<Chord_point> points_beside(const Vec3& chord,
                                         double thickest,
                                         double bend,
                                         const std::vector<Vec3>& near) const
  {
    constexpr double rounding = 1 + 1e-6;
    const double length = chord.norm(), width = rounding * (1 + m_rules.band) * thickest;
    const double most_bent = rounding * bend * length;
    const Vec3 d = chord / length;
    std::vector<Chord_point> result;
    for (const Vec3& v : near) {
      const double t = v.dot(d) / length;
      if (t < 0 || t > 1)
        continue;
      const Vec3 offset = v - t * chord;
      const double reach = width + 4 * t * (1 - t) * most_bent;
      if (offset.squaredNorm() < reach * reach)
        result.push_back({offset, t});
    }
    return result;
  }

  /// Returns the score of a bent tube, without the terms for bends and radii.
  double
  score_of(const Axis_node& end, const Bent_tube& tube, const std::vector<Chord_point>& near) const
  {
    double score = 0;
    for (const Chord_point& p : near) {
      const double t = p.share, r = (1 - t) * end.radius + t * tube.radius;
      const double x = ((p.offset - 4 * t * (1 - t) * tube.bend).norm() / r - 1) / m_rules.band;
      score += std::abs(x) < 1 ? 1 - std::abs(x) : x < 0 ? -2 : 0;
    }
    return score;
  }

  /// Returns the tube of the largest score. Its score is 0 if there is none.
  Bent_tube best_tube(const Axis_node& end,
                      const std::vector<Thick_target>& targets,
                      const std::vector<Index>& near) const
  {
    constexpr double widest = 1.5, most_bent = 0.15;
    std::vector<Vec3> offsets;
    for (const Index i : near)
      offsets.push_back(m_scan.points[i] - end.point);
    std::vector<Bent_tube> tubes;
    for (const Thick_target& target : targets) {
      const std::vector<Chord_point> beside =
          points_beside(target.point - end.point, widest * end.radius, 0, offsets);
      for (const double ratio : {1.0, 1.25, widest}) {
        Bent_tube tube;
        tube.target = target;
        tube.radius = ratio * end.radius;
        tube.score = score_of(end, tube, beside) - 2 * (ratio - 1);
        tubes.push_back(tube);
      }
    }
    std::stable_sort(tubes.begin(), tubes.end(), [](const Bent_tube& a, const Bent_tube& b) {
      return a.score > b.score;
    });
    constexpr std::size_t most = 16;
    tubes.resize(std::min(most, tubes.size()));
    Bent_tube best;
    for (const Bent_tube& straight : tubes) {
      if (straight.score > best.score)
        best = straight;
      const Vec3 chord = straight.target.point - end.point;
      const double length = chord.norm();
      const Vec3 e1 = chord.unitOrthogonal(), e2 = chord.cross(e1).normalized();
      const std::vector<Chord_point> beside =
          points_beside(chord, std::max(end.radius, straight.radius), most_bent, offsets);
      for (const double share : {0.03, 0.06, 0.1, most_bent})
        for (int k = 0; k < 8; ++k) {
          const double turn = 2 * pcs::internal::pi * k / 8;
          Bent_tube tube = straight;
          tube.bend = share * length * (std::cos(turn) * e1 + std::sin(turn) * e2);
          tube.score =
              score_of(end, tube, beside) - 2 * (straight.radius / end.radius - 1) - 10 * share;
          if (tube.score > best.score)
            best = tube;
        }
    }
    return best;
  }

  /// Returns the longest stretch beyond `seam` without points on the surface [L].
  double widest_gap(const Axis_fit& fit, std::size_t seam, const Thick_target& target) const
  {
    const Axis& axis = fit.axis();
    std::vector<double> at(axis.size(), 0); // lengths beyond the seam [L]
    for (std::size_t k = seam + 1; k < axis.size(); ++k)
      at[k] = at[k - 1] + (axis[k].point - axis[k - 1].point).norm();
    std::vector<double> seen{0, std::max(0.0, at.back() - target.radius)};
    for (const Axis_place& p : fit.places()) {
      if (p.segment < seam || p.share < 0 || p.share > 1)
        continue;
      const double r = radius_at(axis, p);
      if (std::abs(p.distance - r) <=
          std::max(m_chains.filled_noise * m_noise, m_chains.filled_depth * r))
        seen.push_back((1 - p.share) * at[p.segment] + p.share * at[p.segment + 1]);
    }
    std::sort(seen.begin(), seen.end());
    double widest = 0;
    for (std::size_t k = 1; k < seen.size(); ++k)
      widest = std::max(widest, seen[k] - seen[k - 1]);
    return widest;
  }

  /// Returns the score of a straight tube from `base` along `d` (see above).
  double score_of(const Vec3& base,
                  const Vec3& d,
                  double length,
                  double radius,
                  const std::vector<Index>& near) const
  {
    double score = 0;
    for (const Index i : near) {
      const Vec3 v = m_scan.points[i] - base;
      const double t = v.dot(d);
      if (t < 0 || t > length)
        continue;
      const double x = ((v - t * d).norm() / radius - 1) / m_rules.band;
      score += std::abs(x) < 1 ? 1 - std::abs(x) : x < 0 ? -2 : 0;
    }
    return score;
  }

  /// Returns the other end of the straight tube of the largest score.
  Axis_node best_end(const Axis_node& end,
                     const Vec3& along,
                     double length,
                     const std::vector<double>& ratios,
                     const std::vector<Index>& near) const
  {
    constexpr int rings = 5;
    const Vec3 e1 = along.unitOrthogonal(), e2 = along.cross(e1);
    Axis_node best = end;
    double most = std::numeric_limits<double>::lowest();
    for (int ring = 0; ring <= rings; ++ring) {
      const double angle = m_rules.steepest * ring / rings;
      const int count = std::max(1, 6 * ring);
      for (int k = 0; k < count; ++k) {
        const double turn = 2 * pcs::internal::pi * k / count;
        const Vec3 d =
            std::cos(angle) * along + std::sin(angle) * (std::cos(turn) * e1 + std::sin(turn) * e2);
        for (const double ratio : ratios) {
          const double score = score_of(end.point, d, length, ratio * end.radius, near) -
                               0.25 * ring - 2 * std::abs(ratio - 1);
          if (score > most) {
            most = score;
            best.point = end.point + length * d;
            best.radius = ratio * end.radius;
          }
        }
      }
    }
    return best;
  }

  /// Appends nodes up to `end` to the axis, with the node spacing of `Chain_options`.
  void append(const Axis_node& end, double length, Axis& axis) const
  {
    const Axis_node base = axis.back();
    Node_spacing spacing = m_chains.node_spacing;
    spacing.lowest *= m_scan.spacing;
    spacing.highest *= m_scan.spacing;
    const std::size_t steps =
        static_cast<std::size_t>(std::max(2.0, std::round(length / spacing(base.radius))));
    for (std::size_t k = 1; k <= steps; ++k) {
      Axis_node node = end;
      node.point = base.point + double(k) / double(steps) * (end.point - base.point);
      axis.push_back(node);
    }
  }

  /// Fits the axis to the points near it. Returns whether it succeeded.
  bool run(const std::vector<Index>& near, Axis_fit& fit) const
  {
    const Axis& axis = fit.axis();
    std::vector<Vec3> positions;
    std::vector<Index> segments;
    for (const Index i : near) {
      const Axis_place place = nearest_place(axis, m_scan.points[i]);
      const double reach =
          m_chains.gather_factor * radius_at(axis, place) + m_chains.gather_offset * m_scan.spacing;
      if (place.distance > reach)
        continue;
      positions.push_back(m_scan.points[i]);
      segments.push_back(place.segment);
    }
    if (positions.size() < m_rules.fewest)
      return false;
    fit.set_points(std::move(positions), std::move(segments));
    fit.project();
    std::vector<Radius_prior> priors;
    for (const Axis_node& node : axis)
      priors.push_back({node.radius, m_rules.radius_share * node.radius, 0});
    fit.set_priors(std::move(priors));
    constexpr int iterations = 12;
    for (int k = 0; k < iterations; ++k)
      if (!fit.iterate(std::max(1.0, 4.0 - 0.5 * k)))
        return false;
    fit.estimate_errors();
    return true;
  }

  /// Returns the position, as the sum of segment and parameter, up to which points around a hollow
  /// interior support the axis beyond `seam`; 0 if the support is insufficient.
  double supported_end(const Axis_fit& fit, std::size_t seam) const
  {
    const Axis& axis = fit.axis();
    const Vec3 along = (axis.back().point - axis[seam].point).normalized();
    const Vec3 e1 = along.unitOrthogonal(), e2 = along.cross(e1);
    double inside = 0, at = 0;
    std::vector<Vec2> on;
    for (std::size_t i = 0; i < fit.places().size(); ++i) {
      const Axis_place& p = fit.places()[i];
      if (p.segment < seam || p.share < 0 || p.share > 1)
        continue;
      const double r = radius_at(axis, p), e = p.distance - r;
      const double limit = std::max(m_chains.filled_noise * m_noise, m_chains.filled_depth * r);
      inside += e < -limit;
      if (std::abs(e) > limit)
        continue;
      at = std::max(at, double(p.segment) + p.share);
      const Vec3 v = fit.points()[i] - point_at(axis, p);
      on.emplace_back(v.dot(e1), v.dot(e2));
    }
    const double count = double(on.size());
    const double covered = on.empty() ? 0 : double(covered_sectors(on, Vec2(0, 0)));
    const bool is_good = on.size() >= m_rules.fewest &&
                         inside <= m_rules.filled * (count + inside) &&
                         covered >= m_rules.sectors * sectors_of_random_points(on.size());
    return is_good ? at : 0;
  }

  const Scan& m_scan;
  double m_noise;
  const Chain_options& m_chains;
  const Thick_end_options& m_rules;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_THICK_CONTINUATION_H

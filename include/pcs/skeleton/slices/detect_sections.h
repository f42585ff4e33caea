// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detection of cross-sections: slices at center candidates, ellipse fit, tilt and support.

#ifndef PCS_SKELETON_SLICES_DETECT_SECTIONS_H
#define PCS_SKELETON_SLICES_DETECT_SECTIONS_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/skeleton/slices/ellipse_fit.h>
#include <pcs/skeleton/slices/principal_curvatures.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace pcs {
namespace skeleton {

/// A detected section.
struct Found_section
{
  Vec3 center = Vec3::Zero(), along = Vec3::UnitZ(), major_axis = Vec3::UnitX();
  double major = 0, minor = 0;
  Index point = none; ///< point from which it was detected
  double radius() const { return std::sqrt(major * minor); }
};

namespace internal {

class Section_detector
{
public:
  Section_detector(const Scan& scan,
                   const std::vector<std::uint8_t>& is_used,
                   const std::vector<Surface_frame>& frames,
                   const Slice_options& rules)
    : m_scan(scan), m_is_used(is_used), m_frames(frames), m_rules(rules)
  {
  }

  /// Detects the sections. Stops early if `progress`, called between points, returns `false`.
  template <class Callback>
  std::vector<Found_section> operator()(const Callback& progress)
  {
    constexpr Index batch = 256;
    std::vector<Found_section> sections;
    std::vector<std::uint8_t> is_done(m_scan.size(), 0);
    for (Index i = 0; i < m_scan.size(); ++i) {
      if (i % batch == 0 && !progress(double(i) / double(m_scan.size())))
        break;
      if (is_done[i] || !m_is_used[i])
        continue;
      const Surface_frame& f = m_frames[i];
      if (!(std::abs(f.k1) * m_rules.largest_radius * m_scan.spacing > 1))
        continue;
      Found_section s;
      s.point = i;
      s.center = m_scan.points[i] + f.normal / f.k1;
      s.along = f.e2;
      s.major = s.minor = std::abs(1 / f.k1);
      double score = 0;
      if (!fit(i, s, score) || !adjust(i, s, score))
        continue;
      sections.push_back(s);
      if (!m_rules.do_mark_support)
        continue;
      for (const Index j : m_slice) {
        const double r = m_frames[j].k1 != 0 ? std::abs(1 / m_frames[j].k1) : 0;
        if (std::abs(r - s.radius()) < m_rules.support_radius * s.radius() &&
            std::abs(m_frames[j].e2.dot(s.along)) > m_rules.support_cosine)
          is_done[j] = 1;
      }
      is_done[i] = 1;
    }
    return sections;
  }

private:
  /// Replaces `s` by a fit to the slice at `s`. `score` is the sampling distance divided by the
  /// deviation.
  bool fit(Index i, Found_section& s, double& score)
  {
    const double spacing = m_rules.is_height_local ? m_scan.local_spacing[i] : m_scan.spacing;
    const double half = 0.5 * m_rules.height * spacing, radius = 1.3 * s.major + 2 * m_scan.spacing;
    m_near.clear();
    m_slice.clear();
    m_scan.search->within(s.center, std::hypot(half, radius), m_near);
    const Vec3 e1 = s.along.unitOrthogonal(), e2 = s.along.cross(e1);
    for (const Index j : m_near) {
      const Vec3 d = m_scan.points[j] - s.center;
      const double h = d.dot(s.along);
      if (m_is_used[j] && std::abs(h) <= half && (d - h * s.along).norm() <= radius)
        m_slice.push_back(j);
    }
    if (m_slice.size() < m_rules.lowest_count)
      return false;
    std::vector<Index> chosen = m_slice;
    if (m_rules.highest_count > 0 && chosen.size() > m_rules.highest_count) {
      std::minstd_rand random(m_rules.seed + 7919 * i + 1); // independent of threads and order
      for (std::size_t k = 0; k < m_rules.highest_count; ++k)
        std::swap(chosen[k], chosen[k + random() % (chosen.size() - k)]);
      chosen.resize(m_rules.highest_count);
    }
    std::vector<Vec2> plane;
    for (const Index j : chosen) {
      const Vec3 d = m_scan.points[j] - s.center;
      plane.emplace_back(d.dot(e1), d.dot(e2));
    }
    const Ellipse e = fit_section(plane, m_rules.fit);
    if (!(e.major > 0) || e.major > 3 * radius || e.center.norm() > 2 * radius)
      return false;
    s.center += e.center.x() * e1 + e.center.y() * e2;
    s.major = e.major;
    s.minor = e.minor;
    s.major_axis = e.direction.x() * e1 + e.direction.y() * e2;
    score = m_scan.spacing / std::max(e.deviation, 1e-9 * m_scan.spacing);
    return true;
  }

  /// Tilts an elongated slice about its minor axis while this improves the fit.
  bool adjust(Index i, Found_section& s, double& score)
  {
    for (int k = 0; k < m_rules.tilts; ++k) {
      if (s.minor / s.major >= m_rules.upright)
        return true;
      if (score > 1 && k > 0)
        return true;
      const double angle = std::acos(s.minor / s.major);
      const Vec3 minor_axis = s.along.cross(s.major_axis);
      Found_section best = s;
      double best_score = score;
      std::vector<Index> slice = m_slice;
      for (const double sign : {1.0, -1.0}) {
        Found_section tilted = s;
        tilted.along = Eigen::AngleAxisd(sign * angle, minor_axis) * s.along;
        double tilted_score = 0;
        if (fit(i, tilted, tilted_score) && tilted_score > best_score) {
          best = tilted;
          best_score = tilted_score;
          slice = m_slice;
        }
      }
      m_slice = slice;
      if (!(best_score > score))
        break;
      s = best;
      score = best_score;
    }
    return score > 1;
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  const std::vector<Surface_frame>& m_frames;
  Slice_options m_rules;
  std::vector<Index> m_near, m_slice;
};

} // namespace internal

/// Detects the sections of all points that support no earlier section. The result depends on the
/// order of the points, but not on threads. It is incomplete if `progress(fraction)` returns
/// `false`.
template <class Callback>
std::vector<Found_section> detect_sections(const Scan& scan,
                                           const std::vector<std::uint8_t>& is_used,
                                           const std::vector<Surface_frame>& frames,
                                           const Slice_options& rules,
                                           const Callback& progress)
{
  return internal::Section_detector(scan, is_used, frames, rules)(progress);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_DETECT_SECTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detection of cross-sections: slices at center candidates, ellipse fit, tilt and support.

#ifndef PCS_SKELETON_SLICES_DETECT_SECTIONS_H
#define PCS_SKELETON_SLICES_DETECT_SECTIONS_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/internal/parallel.h>
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

/// Fit of one section, with buffers that are reused for the next.
class Section_fitter
{
public:
  Section_fitter(const Scan& scan,
                 const std::vector<std::uint8_t>& is_used,
                 const std::vector<Surface_frame>& frames,
                 const Slice_options& rules)
    : m_scan(scan), m_is_used(is_used), m_frames(frames), m_rules(rules)
  {
  }

  /// Whether the center of curvature of point `i` is a candidate for the center of a section.
  bool is_candidate(Index i) const
  {
    return m_is_used[i] && std::abs(m_frames[i].k1) * m_rules.largest_radius * m_scan.spacing > 1;
  }

  /// Fits the section of a candidate. Returns `false` if there is none.
  bool operator()(Index i, Found_section& s)
  {
    const Surface_frame& f = m_frames[i];
    s.point = i;
    s.center = m_scan.points[i] + f.normal / f.k1;
    s.along = f.e2;
    s.major = s.minor = std::abs(1 / f.k1);
    double score = 0;
    return fit(i, s, score) && adjust(i, s, score);
  }

  /// Returns the points of the last slice whose curvatures agree with its section `s`.
  std::vector<Index> support(const Found_section& s) const
  {
    std::vector<Index> result;
    for (const Index j : m_slice) {
      const double r = m_frames[j].k1 != 0 ? std::abs(1 / m_frames[j].k1) : 0;
      if (std::abs(r - s.radius()) < m_rules.support_radius * s.radius() &&
          std::abs(m_frames[j].e2.dot(s.along)) > m_rules.support_cosine)
        result.push_back(j);
    }
    return result;
  }

private:
  /// Replaces `s` by a fit to the slice at `s`. `score` is the sampling distance divided by the
  /// deviation.
  bool fit(Index i, Found_section& s, double& score)
  {
    const double spacing = m_rules.is_height_local ? m_scan.local_spacing[i] : m_scan.spacing;
    const double half = 0.5 * m_rules.height * spacing;
    const double radius = m_rules.radius * s.major + m_rules.radius_offset * m_scan.spacing;
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
  const Slice_options& m_rules;
  std::vector<Index> m_near, m_slice;
};

/// A center candidate, and the result of its fit.
struct Section_candidate
{
  Found_section section;
  bool is_found = false;
  std::vector<Index> support;
};

/// Fits all candidates, whose points are set.
template <class ConcurrencyTag>
void fit_candidates(const Section_fitter& fitter,
                    bool do_find_support,
                    std::vector<Section_candidate>& candidates)
{
  constexpr std::size_t block = 16; // fits differ in their cost
  const auto fit_block = [&](std::size_t begin, std::size_t end) {
    Section_fitter fit = fitter;
    for (std::size_t k = begin; k < end; ++k) {
      Section_candidate& c = candidates[k];
      c.is_found = fit(c.section.point, c.section);
      if (c.is_found && do_find_support)
        c.support = fit.support(c.section);
    }
  };
  pcs::internal::for_each_block<ConcurrencyTag>(candidates.size(), block, fit_block);
}

} // namespace internal

/// Detects the sections of all points that support no earlier section. The candidates are fitted
/// concurrently in batches, and accepted in the order of the points: the result depends neither on
/// threads nor on the size of the batches. It is incomplete if `progress(fraction)`, called between
/// batches, returns `false`.
template <class ConcurrencyTag, class Callback>
std::vector<Found_section> detect_sections(const Scan& scan,
                                           const std::vector<std::uint8_t>& is_used,
                                           const std::vector<Surface_frame>& frames,
                                           const Slice_options& rules,
                                           const Callback& progress)
{
  constexpr std::size_t batch = 1024; // takes less than a second
  const Index n = static_cast<Index>(scan.size());
  const internal::Section_fitter fitter(scan, is_used, frames, rules);
  std::vector<Found_section> sections;
  std::vector<std::uint8_t> is_done(n, 0);
  std::vector<internal::Section_candidate> candidates;
  for (Index next = 0; next < n && progress(double(next) / double(n));) {
    candidates.clear();
    for (; next < n && candidates.size() < batch; ++next)
      if (!is_done[next] && fitter.is_candidate(next)) {
        candidates.emplace_back();
        candidates.back().section.point = next;
      }
    internal::fit_candidates<ConcurrencyTag>(fitter, rules.do_mark_support, candidates);
    for (const internal::Section_candidate& c : candidates) {
      if (!c.is_found || is_done[c.section.point])
        continue;
      sections.push_back(c.section);
      for (const Index j : c.support)
        is_done[j] = 1;
    }
  }
  return sections;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_DETECT_SECTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Data of a branch surface: sections, tubes of rings, and the mesh.

#ifndef PCS_SKELETON_SURFACE_BRANCH_SURFACE_H
#define PCS_SKELETON_SURFACE_BRANCH_SURFACE_H

#include <pcs/core/rotations.h>
#include <pcs/internal/constants.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// A cross-section of a branch.
struct Section
{
  Vec3 center = Vec3::Zero();
  double radius = 0;
  double major_radius = 0, minor_radius = 0; ///< 0: a circle
  Vec3 major_axis = Vec3::Zero();
};

/// The sections of a branch and its parent; parents come before their children.
struct Surface_branch
{
  std::size_t parent = static_cast<std::size_t>(-1); ///< none
  std::vector<Section> sections;                     ///< from base to tip
};

struct Surface_options
{
  double tolerance = 0; ///< largest distance of the mesh from the sections [L]
  bool do_join = true;  ///< otherwise, every branch is a separate closed tube
  std::size_t fewest_sides = 4, most_sides = 48;
  double margin =
      0.35; ///< distance between the border of a hole and its branch, in radii of the branch [-]
  double steepest = 0.25; ///< least sine of the angle between a branch and its parent [-]
  double widest = 1.1;    ///< largest half angle of a branch around its parent [rad]
};

/// A triangle mesh with outward orientation.
struct Branch_surface
{
  std::vector<Vec3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  std::size_t number_of_joined = 0;   ///< branches joined to a hole of their parent [count]
  std::size_t number_of_separate = 0; ///< branches that are separate closed tubes [count]
};

/// The sections of one branch as a polyline by arc length; coincident sections are merged.
class Section_line
{
public:
  explicit Section_line(const std::vector<Section>& all = {})
  {
    for (const Section& s : all) {
      const double step = m_sections.empty() ? 0 : (m_sections.back().center - s.center).norm();
      if (!m_sections.empty() && !(step > 1e-9 * s.radius))
        continue;
      m_at.push_back(m_sections.empty() ? 0 : m_at.back() + step);
      m_sections.push_back(s);
    }
  }

  std::size_t size() const { return m_sections.size(); }
  double length() const { return m_at.empty() ? 0 : m_at.back(); }
  double at(std::size_t k) const { return m_at[k]; }
  const Section& operator[](std::size_t k) const { return m_sections[k]; }

  /// Interpolates the section at an arc length.
  Section section(double s) const
  {
    const std::size_t k = segment(s);
    const double t = std::min(1.0, std::max(0.0, (s - m_at[k]) / (m_at[k + 1] - m_at[k])));
    Section result = t < 0.5 ? m_sections[k] : m_sections[k + 1];
    const double before = result.radius;
    result.center = (1 - t) * m_sections[k].center + t * m_sections[k + 1].center;
    result.radius = (1 - t) * m_sections[k].radius + t * m_sections[k + 1].radius;
    const double factor = before > 0 ? result.radius / before : 1;
    result.major_radius *= factor;
    result.minor_radius *= factor;
    return result;
  }
  Vec3 direction(double s) const
  {
    const std::size_t k = segment(s);
    return (m_sections[k + 1].center - m_sections[k].center).normalized();
  }

  /// Returns the arc length of the nearest point of the line.
  double nearest(const Vec3& p) const
  {
    double best = 0, least = -1;
    for (std::size_t k = 0; k + 1 < size(); ++k) {
      const Vec3 d = m_sections[k + 1].center - m_sections[k].center;
      const double t =
          std::min(1.0, std::max(0.0, d.dot(p - m_sections[k].center) / d.squaredNorm()));
      const double distance = (p - m_sections[k].center - t * d).squaredNorm();
      if (least < 0 || distance < least) {
        least = distance;
        best = m_at[k] + t * (m_at[k + 1] - m_at[k]);
      }
    }
    return best;
  }

  /// Returns the arc lengths of a simplification within the tolerance, including the radii (Douglas
  /// and Peucker).
  std::vector<double> simplified(double tolerance) const
  {
    std::vector<std::uint8_t> is_kept(size(), !(tolerance > 0));
    is_kept.front() = is_kept.back() = 1;
    std::vector<std::pair<std::size_t, std::size_t>> stack{{0, size() - 1}};
    while (!stack.empty() && tolerance > 0) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      const Vec3 d = m_sections[b].center - m_sections[a].center;
      const double l2 = d.squaredNorm();
      double worst = tolerance;
      std::size_t where = 0;
      for (std::size_t k = a + 1; k < b; ++k) {
        const Vec3 q = m_sections[k].center - m_sections[a].center;
        const double t = l2 > 0 ? std::min(1.0, std::max(0.0, d.dot(q) / l2)) : 0;
        const double radius = (1 - t) * m_sections[a].radius + t * m_sections[b].radius;
        const double off = (q - t * d).norm() + std::abs(m_sections[k].radius - radius);
        if (off > worst) {
          worst = off;
          where = k;
        }
      }
      if (where > 0) {
        is_kept[where] = 1;
        stack.emplace_back(a, where);
        stack.emplace_back(where, b);
      }
    }
    std::vector<double> result;
    for (std::size_t k = 0; k < size(); ++k)
      if (is_kept[k])
        result.push_back(m_at[k]);
    return result;
  }

private:
  std::size_t segment(double s) const
  {
    const auto behind = std::upper_bound(m_at.begin(), m_at.end(), s);
    const std::size_t k = static_cast<std::size_t>(behind - m_at.begin());
    return std::min(size() - 2, k > 0 ? k - 1 : 0);
  }

  std::vector<Section> m_sections;
  std::vector<double> m_at;
};

/// A tube as a grid of vertices, with `sides` vertices on each ring.
struct Surface_tube
{
  std::size_t sides = 0;
  std::vector<Section> rings;
  std::vector<double> at;            ///< arc length of each ring
  std::vector<Vec3> along, side;     ///< frame of each ring
  std::size_t first = 0;             ///< index of the first vertex
  std::vector<std::uint8_t> is_hole; ///< quads, ring by ring
  std::vector<std::size_t> base;     ///< loop joined to the first ring; empty: a cap

  std::size_t vertex(std::size_t ring, std::size_t k) const
  {
    return first + ring * sides + k % sides;
  }
  std::uint8_t& hole(std::size_t ring, std::size_t k) { return is_hole[ring * sides + k % sides]; }

  /// Computes frames without twist: each is the previous one after the smallest rotation.
  void place_frames()
  {
    const std::size_t n = rings.size();
    along.resize(n);
    side.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 d = rings[std::min(n - 1, k + 1)].center - rings[k > 0 ? k - 1 : 0].center;
      along[k] = d.norm() > 0 ? Vec3(d.normalized()) : (k > 0 ? along[k - 1] : Vec3(Vec3::UnitZ()));
      if (k == 0)
        side[k] = along[k].unitOrthogonal();
      else {
        const Vec3 s = rotation_between(along[k - 1], along[k]) * side[k - 1];
        side[k] = (s - s.dot(along[k]) * along[k]).normalized();
      }
    }
  }

  double angle(double k) const { return 2 * pcs::internal::pi * k / double(sides); }

  Vec3 point_on(std::size_t ring, std::size_t k) const
  {
    const Section& s = rings[ring];
    const double a = angle(double(k));
    const Vec3 direction = std::cos(a) * side[ring] + std::sin(a) * along[ring].cross(side[ring]);
    double radius = s.radius;
    if (s.major_radius > 0 && s.minor_radius > 0) {
      const double c = direction.dot(s.major_axis), c2 = std::min(1.0, c * c);
      radius = 1 / std::sqrt(c2 / (s.major_radius * s.major_radius) +
                             (1 - c2) / (s.minor_radius * s.minor_radius));
    }
    // the polygon has the area of the section
    return s.center + radius * std::sqrt(angle(1) / std::sin(angle(1))) * direction;
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SURFACE_BRANCH_SURFACE_H

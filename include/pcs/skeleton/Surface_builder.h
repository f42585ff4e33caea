// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The surface of a tree as one closed mesh: tubes along the branches, joined at holes in their parents.

#ifndef PCS_SKELETON_SURFACE_BUILDER_H
#define PCS_SKELETON_SURFACE_BUILDER_H

#include <pcs/skeleton/Scan.h>

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

/// A branch whose surface is wanted; parents come before their children.
struct Surface_branch
{
  std::size_t parent = static_cast<std::size_t>(-1); ///< none
  std::vector<Section> sections;                     ///< from base to tip
};

struct Surface_rules
{
  double tolerance = 0; ///< distance of the mesh from the sections [L]
  bool do_join = true;  ///< else every branch is a closed tube of its own
  std::size_t fewest_sides = 4, most_sides = 48;
};

/// A mesh of triangles that look outwards.
struct Branch_surface
{
  std::vector<Vec3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  std::size_t number_of_joined = 0;   ///< branches sewn into a hole of their parent [count]
  std::size_t number_of_separate = 0; ///< branches that are closed tubes of their own [count]
};

class Surface_builder
{
public:
  Surface_builder(std::vector<Surface_branch> branches, const Surface_rules& rules)
    : m_branches(std::move(branches)), m_rules(rules), m_tubes(m_branches.size())
  {
  }

  Branch_surface operator()()
  {
    for (std::size_t b = 0; b < m_branches.size(); ++b)
      make_tube(b);
    for (std::size_t b = 0; b < m_branches.size(); ++b)
      if (!m_tubes[b].rings.empty())
        join(b);
    for (std::size_t b = 0; b < m_branches.size(); ++b)
      close(b);
    drop_unused_points();
    return std::move(m_surface);
  }

private:
  using Loop = std::vector<std::size_t>;
  /// A grid of vertices: `sides` of them on each ring.
  struct Tube
  {
    std::size_t sides = 0;
    std::vector<Section> rings;
    std::vector<Vec3> along, side;     ///< frame of each ring
    std::size_t first = 0;             ///< number of the first vertex
    std::vector<std::uint8_t> is_hole; ///< quads, ring by ring
    bool is_joined = false;

    std::size_t vertex(std::size_t ring, std::size_t k) const
    {
      return first + ring * sides + k % sides;
    }
    std::uint8_t& hole(std::size_t ring, std::size_t k)
    {
      return is_hole[ring * sides + k % sides];
    }
  };

  std::vector<Section> simplify(const std::vector<Section>& all) const;
  void make_tube(std::size_t b);
  void place_frames(Tube& tube) const;
  Vec3 point_on(const Tube& tube, std::size_t ring, std::size_t k) const;
  void join(std::size_t b);
  bool
  find_hole(Tube& parent, const Vec3& exit, double radius, std::array<std::size_t, 4>& hole) const;
  Loop cut_hole(Tube& parent, const std::array<std::size_t, 4>& hole);
  Loop narrow(const Tube& parent, const Loop& loop, const Vec3& exit, double radius);
  void sew(const Loop& outer, const Loop& inner, const Vec3& center, const Vec3& along);
  void close(std::size_t b);
  void drop_unused_points();
  void add(std::size_t a, std::size_t b, std::size_t c)
  {
    m_surface.triangles.push_back({a, b, c});
  }

  std::vector<Surface_branch> m_branches;
  Surface_rules m_rules;
  std::vector<Tube> m_tubes;
  Branch_surface m_surface;
};

/// Keeps the sections that are needed to stay within the tolerance (Douglas and Peucker, radius included).
inline std::vector<Section> Surface_builder::simplify(const std::vector<Section>& all) const
{
  std::vector<Section> distinct;
  for (const Section& s : all)
    if (distinct.empty() || (distinct.back().center - s.center).norm() > 1e-9 * (1 + s.radius))
      distinct.push_back(s);
  if (distinct.size() < 3 || !(m_rules.tolerance > 0))
    return distinct;
  std::vector<std::uint8_t> is_kept(distinct.size(), 0);
  is_kept.front() = is_kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> stack{{0, distinct.size() - 1}};
  while (!stack.empty()) {
    const auto [a, b] = stack.back();
    stack.pop_back();
    const Vec3 d = distinct[b].center - distinct[a].center;
    double worst = m_rules.tolerance;
    std::size_t at = 0;
    for (std::size_t k = a + 1; k < b; ++k) {
      const double t =
          d.squaredNorm() > 0
              ? std::min(
                    1.0,
                    std::max(0.0, d.dot(distinct[k].center - distinct[a].center) / d.squaredNorm()))
              : 0;
      const double off =
          (distinct[k].center - distinct[a].center - t * d).norm() +
          std::abs(distinct[k].radius - (1 - t) * distinct[a].radius - t * distinct[b].radius);
      if (off > worst) {
        worst = off;
        at = k;
      }
    }
    if (at > 0) {
      is_kept[at] = 1;
      stack.emplace_back(a, at);
      stack.emplace_back(at, b);
    }
  }
  std::vector<Section> result;
  for (std::size_t k = 0; k < distinct.size(); ++k)
    if (is_kept[k])
      result.push_back(distinct[k]);
  return result;
}

/// Frames that do not twist: each is the one before, turned by the smallest rotation.
inline void Surface_builder::place_frames(Tube& tube) const
{
  const std::size_t n = tube.rings.size();
  tube.along.resize(n);
  tube.side.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 d = tube.rings[std::min(n - 1, k + 1)].center - tube.rings[k > 0 ? k - 1 : 0].center;
    tube.along[k] =
        d.norm() > 0 ? Vec3(d.normalized()) : (k > 0 ? tube.along[k - 1] : Vec3(Vec3::UnitZ()));
    if (k == 0)
      tube.side[k] = tube.along[k].unitOrthogonal();
    else {
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond::FromTwoVectors(tube.along[k - 1], tube.along[k]);
      const Vec3 s = turn * tube.side[k - 1];
      tube.side[k] = (s - s.dot(tube.along[k]) * tube.along[k]).normalized();
    }
  }
}

inline Vec3 Surface_builder::point_on(const Tube& tube, std::size_t ring, std::size_t k) const
{
  const Section& s = tube.rings[ring];
  const double angle = 2 * 3.14159265358979323846 * double(k) / double(tube.sides);
  const Vec3 direction =
      std::cos(angle) * tube.side[ring] + std::sin(angle) * tube.along[ring].cross(tube.side[ring]);
  double radius = s.radius;
  if (s.major_radius > 0 && s.minor_radius > 0) {
    const double c = direction.dot(s.major_axis), c2 = std::min(1.0, c * c);
    radius = 1 / std::sqrt(c2 / (s.major_radius * s.major_radius) +
                           (1 - c2) / (s.minor_radius * s.minor_radius));
  }
  return s.center + radius * direction;
}

inline void Surface_builder::make_tube(std::size_t b)
{
  Tube& tube = m_tubes[b];
  const Surface_branch& branch = m_branches[b];
  std::vector<Section> rings = branch.sections;
  const bool has_parent = m_rules.do_join && branch.parent < b;
  if (has_parent) { // what lies in the wood of the parent has no surface
    const std::vector<Section>& below = m_branches[branch.parent].sections;
    std::size_t near = 0;
    for (std::size_t k = 1; k < below.size(); ++k)
      if ((below[k].center - rings[0].center).norm() <
          (below[near].center - rings[0].center).norm())
        near = k;
    const Vec3 axis =
        below[std::min(below.size() - 1, near + 1)].center - below[near > 0 ? near - 1 : 0].center;
    const Vec3 along = axis.norm() > 0 ? Vec3(axis.normalized()) : Vec3(Vec3::UnitZ());
    std::size_t k = 0;
    for (; k < rings.size(); ++k) {
      const Vec3 d = rings[k].center - below[near].center;
      const double across = (d - d.dot(along) * along).norm();
      if (across > below[near].radius + 0.3 * rings[k].radius)
        break;
    }
    if (k + 1 >= rings.size())
      return; // hidden in its parent
    rings.erase(rings.begin(), rings.begin() + static_cast<std::ptrdiff_t>(k));
  }
  tube.rings = simplify(rings);
  if (tube.rings.size() < 2) {
    tube.rings.clear();
    return;
  }
  double thickest = 0;
  for (const Section& s : tube.rings)
    thickest = std::max(thickest, s.radius);
  const double t = std::min(0.9, m_rules.tolerance / std::max(thickest, 1e-300));
  const double sides =
      t > 0 ? 3.14159265358979323846 / std::acos(1 - t) : double(m_rules.most_sides);
  tube.sides =
      static_cast<std::size_t>(std::min(double(m_rules.most_sides),
                                        std::max(double(m_rules.fewest_sides), std::ceil(sides))));
  place_frames(tube);
  tube.first = m_surface.points.size();
  for (std::size_t r = 0; r < tube.rings.size(); ++r)
    for (std::size_t k = 0; k < tube.sides; ++k)
      m_surface.points.push_back(point_on(tube, r, k));
  tube.is_hole.assign((tube.rings.size() - 1) * tube.sides, 0);
}

/// A free block of quads around `exit`, as rings [h0, h1) and sides [h2, h2 + h3).
inline bool Surface_builder::find_hole(Tube& parent,
                                       const Vec3& exit,
                                       double radius,
                                       std::array<std::size_t, 4>& hole) const
{
  const std::size_t rows = parent.rings.size() - 1;
  std::size_t row = 0;
  double best = -1;
  for (std::size_t r = 0; r < rows; ++r) {
    const Vec3 a = parent.rings[r].center, d = parent.rings[r + 1].center - a;
    const double t =
        std::min(1.0, std::max(0.0, d.dot(exit - a) / std::max(d.squaredNorm(), 1e-300)));
    const double distance = (exit - a - t * d).norm();
    if (best < 0 || distance < best) {
      best = distance;
      row = r;
    }
  }
  const Vec3 a = parent.rings[row].center, e1 = parent.side[row], e2 = parent.along[row].cross(e1);
  const double angle = std::atan2((exit - a).dot(e2), (exit - a).dot(e1));
  const double turn = 2 * 3.14159265358979323846 / double(parent.sides);
  const double at = (angle < 0 ? angle + 2 * 3.14159265358979323846 : angle) / turn;
  const auto is_free = [&](std::size_t r0, std::size_t r1, std::size_t k, std::size_t count) {
    for (std::size_t r = r0; r < r1; ++r)
      for (std::size_t c = 0; c < count; ++c)
        if (parent.hole(r, k + c))
          return false;
    return true;
  };
  // as wide as the branch, but no more than half of the way around
  const double half =
      std::asin(std::min(1.0, radius / std::max(parent.rings[row].radius, radius))) / turn;
  std::size_t count = static_cast<std::size_t>(std::max(1.0, std::round(2 * half)));
  count = std::min(count, std::max<std::size_t>(1, parent.sides / 2));
  std::size_t first = static_cast<std::size_t>(std::llround(at - 0.5 * double(count)) +
                                               static_cast<long long>(parent.sides)) %
                      parent.sides;
  std::size_t r0 = row, r1 = row + 1;
  const auto height = [&](std::size_t r) {
    return (parent.rings[r].center - exit).dot(parent.along[row]);
  };
  while (r0 > 0 && height(r0) > -radius)
    --r0;
  while (r1 < rows && height(r1) < radius)
    ++r1;
  if (is_free(r0, r1, first, count)) {
    hole = {r0, r1, first, count};
    return true;
  }
  // else the free quad that is nearest
  const std::size_t column = static_cast<std::size_t>(at) % parent.sides;
  double nearest = -1;
  for (std::size_t r = row >= 3 ? row - 3 : 0; r < std::min(rows, row + 4); ++r)
    for (std::size_t c = 0; c < parent.sides; ++c) {
      if (parent.hole(r, c))
        continue;
      const Vec3 middle = 0.25 * (m_surface.points[parent.vertex(r, c)] +
                                  m_surface.points[parent.vertex(r, c + 1)] +
                                  m_surface.points[parent.vertex(r + 1, c)] +
                                  m_surface.points[parent.vertex(r + 1, c + 1)]);
      const double distance = (middle - exit).norm() + (c == column ? 0 : 1e-9);
      if (nearest < 0 || distance < nearest) {
        nearest = distance;
        hole = {r, r + 1, c, 1};
      }
    }
  return nearest >= 0;
}

/// Marks the quads and returns the vertices around them, counter-clockwise from outside.
inline Surface_builder::Loop Surface_builder::cut_hole(Tube& parent,
                                                       const std::array<std::size_t, 4>& hole)
{
  const auto [r0, r1, first, count] = hole;
  for (std::size_t r = r0; r < r1; ++r)
    for (std::size_t c = 0; c < count; ++c)
      parent.hole(r, first + c) = 1;
  Loop loop;
  for (std::size_t c = 0; c < count; ++c)
    loop.push_back(parent.vertex(r0, first + c));
  for (std::size_t r = r0; r < r1; ++r)
    loop.push_back(parent.vertex(r, first + count));
  for (std::size_t c = count; c > 0; --c)
    loop.push_back(parent.vertex(r1, first + c));
  for (std::size_t r = r1; r > r0; --r)
    loop.push_back(parent.vertex(r, first));
  return loop;
}

/// Where the hole is much wider than the branch, a smaller loop in it, on the surface.
inline Surface_builder::Loop
Surface_builder::narrow(const Tube&, const Loop& loop, const Vec3& exit, double radius)
{
  double widest = 0;
  Vec3 middle = Vec3::Zero();
  for (const std::size_t v : loop)
    middle += m_surface.points[v];
  middle /= double(loop.size());
  for (const std::size_t v : loop)
    widest = std::max(widest, (m_surface.points[v] - middle).norm());
  if (widest < 3 * radius)
    return loop;
  const double share = 1.6 * radius / widest;
  // towards the exit, but not over the border of the hole
  Vec3 target = exit;
  if ((target - middle).norm() > 0.5 * widest)
    target = middle + 0.5 * widest * (target - middle).normalized();
  Loop inner;
  for (const std::size_t v : loop) {
    inner.push_back(m_surface.points.size());
    const Vec3 p = target + share * (m_surface.points[v] - middle);
    m_surface.points.push_back(p);
  }
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::size_t l = (k + 1) % loop.size();
    add(loop[k], loop[l], inner[l]);
    add(loop[k], inner[l], inner[k]);
  }
  return inner;
}

/// Triangles between two loops that run the same way around `along`, the outer one below.
inline void
Surface_builder::sew(const Loop& outer, const Loop& inner, const Vec3& center, const Vec3& along)
{
  const Vec3 e1 = along.unitOrthogonal(), e2 = along.cross(e1);
  const auto angle = [&](std::size_t v) {
    const Vec3 d = m_surface.points[v] - center;
    return std::atan2(d.dot(e2), d.dot(e1));
  };
  // start at the pair that is nearest
  std::size_t start = 0, n = outer.size(), m = inner.size();
  double best = -1;
  for (std::size_t k = 0; k < m; ++k) {
    double d = std::abs(angle(inner[k]) - angle(outer[0]));
    d = std::min(d, 2 * 3.14159265358979323846 - d);
    if (best < 0 || d < best) {
      best = d;
      start = k;
    }
  }
  std::size_t i = 0, j = 0;
  while (i < n || j < m) {
    const std::size_t a = outer[i % n], a2 = outer[(i + 1) % n];
    const std::size_t b = inner[(start + j) % m], b2 = inner[(start + j + 1) % m];
    // in step: neither loop runs ahead
    const bool is_outer =
        j == m || (i < n && (double(i) + 0.5) / double(n) <= (double(j) + 0.5) / double(m));
    if (is_outer) {
      add(a, a2, b);
      ++i;
    } else {
      add(a, b2, b);
      ++j;
    }
  }
}

inline void Surface_builder::join(std::size_t b)
{
  Tube& tube = m_tubes[b];
  const std::size_t p = m_branches[b].parent;
  if (!m_rules.do_join || p >= b || m_tubes[p].rings.empty()) {
    if (p < b)
      ++m_surface.number_of_separate;
    return;
  }
  Tube& parent = m_tubes[p];
  std::array<std::size_t, 4> hole{};
  const Section& base = tube.rings.front();
  const Vec3 exit = base.center;
  if (!find_hole(parent, exit, base.radius, hole)) {
    ++m_surface.number_of_separate;
    return;
  }
  const Loop loop = narrow(parent, cut_hole(parent, hole), exit, base.radius);
  Loop ring;
  for (std::size_t k = 0; k < tube.sides; ++k)
    ring.push_back(tube.vertex(0, k));
  sew(loop, ring, exit, tube.along.front());
  tube.is_joined = true;
  ++m_surface.number_of_joined;
}

/// The quads that are no hole, and lids on open ends.
inline void Surface_builder::close(std::size_t b)
{
  Tube& tube = m_tubes[b];
  if (tube.rings.empty())
    return;
  const std::size_t rows = tube.rings.size() - 1;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < tube.sides; ++k) {
      if (tube.hole(r, k))
        continue;
      add(tube.vertex(r, k), tube.vertex(r, k + 1), tube.vertex(r + 1, k + 1));
      add(tube.vertex(r, k), tube.vertex(r + 1, k + 1), tube.vertex(r + 1, k));
    }
  const std::size_t tip = m_surface.points.size();
  m_surface.points.push_back(tube.rings.back().center);
  for (std::size_t k = 0; k < tube.sides; ++k)
    add(tube.vertex(rows, k), tube.vertex(rows, k + 1), tip);
  if (tube.is_joined)
    return;
  const std::size_t base = m_surface.points.size();
  m_surface.points.push_back(tube.rings.front().center);
  for (std::size_t k = 0; k < tube.sides; ++k)
    add(tube.vertex(0, k + 1), tube.vertex(0, k), base);
}

/// Inside of holes there are points of no triangle.
inline void Surface_builder::drop_unused_points()
{
  std::vector<std::size_t> number(m_surface.points.size(), 0);
  for (const auto& t : m_surface.triangles)
    for (const std::size_t v : t)
      number[v] = 1;
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < number.size(); ++v)
    if (number[v] != 0) {
      number[v] = points.size();
      points.push_back(m_surface.points[v]);
    }
  for (auto& t : m_surface.triangles)
    for (std::size_t& v : t)
      v = number[v];
  m_surface.points = std::move(points);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SURFACE_BUILDER_H

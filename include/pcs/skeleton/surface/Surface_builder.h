// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Closed mesh of a tree: tubes along the branches, joined at holes in their parents.

#ifndef PCS_SKELETON_SURFACE_SURFACE_BUILDER_H
#define PCS_SKELETON_SURFACE_SURFACE_BUILDER_H

#include <pcs/internal/constants.h>
#include <pcs/skeleton/surface/Branch_surface.h>
#include <pcs/skeleton/surface/find_branch_exit.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  Builds the surface of all branches. A branch begins where its axis leaves its parent. From there,
  its tube is extended backwards to a loop on the surface of the parent. The parent has rings just
  below and above, so that a block of its quads tightly encloses the loop. This block is removed,
  and the gap between its border and the loop is triangulated in the unrolled surface.
*/
class Surface_builder
{
public:
  Surface_builder(const std::vector<Surface_branch>& branches, const Surface_options& rules)
    : m_rules(rules), m_tubes(branches.size()), m_exits(branches.size())
  {
    for (const Surface_branch& b : branches) {
      m_parent.push_back(b.parent);
      m_lines.emplace_back(b.sections);
    }
  }

  Branch_surface operator()()
  {
    const std::size_t n = m_tubes.size();
    std::vector<std::vector<double>> rings(n);
    for (std::size_t b = 0; b < n; ++b) {
      m_exits[b] = exit_of(b);
      if (m_exits[b].is_there)
        for (const double side : {-1.0, 1.0})
          rings[m_parent[b]].push_back(m_exits[b].at + side * m_exits[b].half);
    }
    for (std::size_t b = 0; b < n; ++b)
      make_tube(b, std::move(rings[b]));
    for (std::size_t b = 0; b < n; ++b)
      if (!m_tubes[b].rings.empty() && m_parent[b] < b && !join(b))
        begin_inside(b);
    for (std::size_t b = 0; b < n; ++b)
      close(m_tubes[b]);
    drop_unused_points();
    return std::move(m_surface);
  }

private:
  using Loop = std::vector<std::size_t>;
  /// A block of quads of a parent: rings [r0, r1), sides [c0, c0 + count).
  struct Block
  {
    std::size_t r0 = 0, r1 = 0, c0 = 0, count = 0;
  };
  /// A position on the unrolled surface: sides and arc length.
  struct Place
  {
    double u = 0, s = 0;
  };
  /// The surface of a parent at the exit of a branch.
  struct Exit_frame
  {
    Place center;         ///< the exit
    Vec3 axis, around;    ///< directions of arc length and of sides
    double turn = 0;      ///< of a side [rad]
    double thickness = 0; ///< radius of the parent [L]
  };
  /// The loop of a branch on the surface of its parent, around the exit.
  struct Base_loop
  {
    std::vector<Place> places;
    double du = 0, ds = 0; ///< half extents
  };
  /// Translation and scale of a loop to the inside of a block.
  struct Loop_fit
  {
    Place center;
    double u = 1, s = 1; ///< scales
    double first = 0;    ///< first side of the block, in the period of the center
  };

  Branch_exit exit_of(std::size_t b) const;
  void make_tube(std::size_t b, std::vector<double> rings);
  bool join(std::size_t b);
  void begin_inside(std::size_t b);
  bool find_block(Surface_tube& parent, const Place& center, double du, double ds, Block& block);
  Exit_frame frame_of_exit(std::size_t b) const;
  Base_loop extend_backwards(std::size_t b, const Exit_frame& frame) const;
  Loop_fit fit_into(const Surface_tube& parent,
                    const Block& block,
                    const Base_loop& loop,
                    double scale_u,
                    Place center) const;
  void cut_hole(Surface_tube& parent,
                const Block& block,
                double first,
                Loop& border,
                std::vector<Place>& places) const;
  Vec3 on_grid(const Surface_tube& tube, const Place& place) const;
  void sew(const Loop& outer,
           const std::vector<Place>& outer_places,
           const Loop& inner,
           const std::vector<Place>& inner_places);
  void close(Surface_tube& tube);
  void drop_unused_points();
  void add(std::size_t a, std::size_t b, std::size_t c)
  {
    m_surface.triangles.push_back({a, b, c});
  }

  Surface_options m_rules;
  std::vector<std::size_t> m_parent;
  std::vector<Section_line> m_lines;
  std::vector<Surface_tube> m_tubes;
  std::vector<Branch_exit> m_exits;
  Branch_surface m_surface;
};

inline Branch_exit Surface_builder::exit_of(std::size_t b) const
{
  const bool may_join = m_rules.do_join && m_parent[b] < b && m_lines[m_parent[b]].size() >= 2;
  return find_branch_exit(m_lines[b], may_join ? &m_lines[m_parent[b]] : nullptr, m_rules);
}

inline void Surface_builder::make_tube(std::size_t b, std::vector<double> rings)
{
  Surface_tube& tube = m_tubes[b];
  const Section_line& line = m_lines[b];
  const double start = m_exits[b].start;
  if (start < 0 || line.size() < 2)
    return;
  const double last = line.length();
  for (const double s : line.simplified(m_rules.tolerance))
    rings.push_back(s);
  rings.push_back(start);
  std::sort(rings.begin(), rings.end());
  const double least = 1e-4 * (last - start);
  for (const double s : rings)
    if (s >= start && (tube.at.empty() || s - tube.at.back() > least) && s < last - least)
      tube.at.push_back(s);
  tube.at.push_back(last);
  double thickest = 0;
  for (const double s : tube.at) {
    tube.rings.push_back(line.section(s));
    thickest = std::max(thickest, tube.rings.back().radius);
  }
  const double t = std::min(0.9, m_rules.tolerance / std::max(thickest, 1e-300));
  const double sides = t > 0 ? pcs::internal::pi / std::acos(1 - t) : double(m_rules.most_sides);
  tube.sides =
      static_cast<std::size_t>(std::min(double(m_rules.most_sides),
                                        std::max(double(m_rules.fewest_sides), std::ceil(sides))));
  tube.place_frames();
  tube.first = m_surface.points.size();
  for (std::size_t r = 0; r < tube.rings.size(); ++r)
    for (std::size_t k = 0; k < tube.sides; ++k)
      m_surface.points.push_back(tube.point_on(r, k));
  tube.is_hole.assign((tube.rings.size() - 1) * tube.sides, 0);
}

/// Finds the smallest block of free quads around a position with some margin. Reduces the margin if
/// quads are occupied. Returns `false` if there is no such block.
inline bool Surface_builder::find_block(Surface_tube& parent,
                                        const Place& center,
                                        double du,
                                        double ds,
                                        Block& block)
{
  const std::size_t rows = parent.rings.size() - 1;
  for (const double share : {1.0, 0.6, 0.3, 0.0}) {
    const double low = center.s - share * ds, high = center.s + share * ds;
    constexpr double slack = 1e-9;
    std::size_t r0 = 0, r1 = 1;
    while (r0 + 1 < rows && parent.at[r0 + 1] <= low + slack * ds)
      ++r0;
    r1 = r0 + 1;
    while (r1 < rows && parent.at[r1] < high - slack * ds)
      ++r1;
    const double sides = double(parent.sides);
    double from = std::floor(center.u - share * du), to = std::ceil(center.u + share * du);
    to = std::max(to, from + 1);
    const double most = std::max(1.0, std::floor(0.5 * sides));
    if (to - from > most) {
      from = std::round(center.u - 0.5 * most);
      to = from + most;
    }
    block.r0 = r0;
    block.r1 = r1;
    block.count = static_cast<std::size_t>(to - from);
    block.c0 = static_cast<std::size_t>(std::fmod(std::fmod(from, sides) + sides, sides));
    bool is_free = true;
    for (std::size_t r = r0; r < r1 && is_free; ++r)
      for (std::size_t c = 0; c < block.count && is_free; ++c)
        is_free = !parent.hole(r, block.c0 + c);
    if (is_free)
      return true;
  }
  return false;
}

/// Returns the point of the grid at a position, by bilinear interpolation in its quad.
inline Vec3 Surface_builder::on_grid(const Surface_tube& tube, const Place& place) const
{
  const std::size_t rows = tube.rings.size() - 1;
  std::size_t r = 0;
  while (r + 1 < rows && tube.at[r + 1] <= place.s)
    ++r;
  const double t = (place.s - tube.at[r]) / (tube.at[r + 1] - tube.at[r]);
  const double sides = double(tube.sides), u = std::fmod(std::fmod(place.u, sides) + sides, sides);
  const std::size_t k = static_cast<std::size_t>(u);
  const double f = u - double(k);
  const auto& p = m_surface.points;
  return (1 - t) * ((1 - f) * p[tube.vertex(r, k)] + f * p[tube.vertex(r, k + 1)]) +
         t * ((1 - f) * p[tube.vertex(r + 1, k)] + f * p[tube.vertex(r + 1, k + 1)]);
}

/// Returns the frame of the parent at the exit of branch `b`.
inline Surface_builder::Exit_frame Surface_builder::frame_of_exit(std::size_t b) const
{
  const Surface_tube& parent = m_tubes[m_parent[b]];
  const Branch_exit& e = m_exits[b];
  std::size_t row = 0;
  while (row + 2 < parent.rings.size() && parent.at[row + 1] <= e.at)
    ++row;
  Exit_frame frame;
  frame.axis = m_lines[m_parent[b]].direction(e.at);
  frame.around = frame.axis.cross(e.normal);
  const Vec3 &e1 = parent.side[row], e2 = parent.along[row].cross(e1);
  frame.turn = parent.angle(1);
  frame.thickness = std::max(m_lines[m_parent[b]].section(e.at).radius, 1e-300);
  frame.center = {std::atan2(e.normal.dot(e2), e.normal.dot(e1)) / frame.turn, e.at};
  if (frame.center.u < 0)
    frame.center.u += double(parent.sides);
  return frame;
}

/// Extends the tube of branch `b` backwards to the surface of its parent.
inline Surface_builder::Base_loop Surface_builder::extend_backwards(std::size_t b,
                                                                    const Exit_frame& frame) const
{
  const Surface_tube& tube = m_tubes[b];
  const Branch_exit& e = m_exits[b];
  Vec3 s1 = tube.side.front() - tube.side.front().dot(e.direction) * e.direction;
  s1 = s1.norm() > 1e-9 ? Vec3(s1.normalized()) : Vec3(e.direction.unitOrthogonal());
  const Vec3 s2 = e.direction.cross(s1);
  Base_loop loop;
  for (std::size_t k = 0; k < tube.sides; ++k) {
    const double a = tube.angle(double(k));
    Vec3 o = e.radius * (std::cos(a) * s1 + std::sin(a) * s2);
    o -= o.dot(e.normal) / e.direction.dot(e.normal) * e.direction;
    const Place p{o.dot(frame.around) / frame.thickness / frame.turn, o.dot(frame.axis)};
    loop.places.push_back(p);
    loop.du = std::max(loop.du, std::abs(p.u));
    loop.ds = std::max(loop.ds, std::abs(p.s));
  }
  return loop;
}

/// Scales and translates a loop into a block, near `center`; `scale_u` is the largest scale of
/// sides.
inline Surface_builder::Loop_fit Surface_builder::fit_into(const Surface_tube& parent,
                                                           const Block& block,
                                                           const Base_loop& loop,
                                                           double scale_u,
                                                           Place center) const
{
  const double s0 = parent.at[block.r0], s1 = parent.at[block.r1];
  double c0 = double(block.c0);
  if (center.u < c0 - 1e-9 - 0.5 * double(block.count))
    c0 -= double(parent.sides);
  else if (center.u > c0 + 1.5 * double(block.count))
    c0 += double(parent.sides);
  const double c1 = c0 + double(block.count);
  const double fit_u = std::min(scale_u, 0.5 * (c1 - c0) / (1.1 * loop.du));
  const double fit_s = std::min(1.0, 0.5 * (s1 - s0) / (1.1 * loop.ds));
  center.u = std::min(c1 - 1.1 * fit_u * loop.du, std::max(c0 + 1.1 * fit_u * loop.du, center.u));
  center.s = std::min(s1 - 1.1 * fit_s * loop.ds, std::max(s0 + 1.1 * fit_s * loop.ds, center.s));
  return {center, fit_u, fit_s, c0};
}

/// Removes the quads of a block. Sets `border` to the points around it, counter-clockwise seen from
/// outside, and `places` to their positions, in which the block begins at side `first`.
inline void Surface_builder::cut_hole(Surface_tube& parent,
                                      const Block& block,
                                      double first,
                                      Loop& border,
                                      std::vector<Place>& places) const
{
  const auto pass = [&](std::size_t r, std::size_t c) {
    border.push_back(parent.vertex(r, block.c0 + c));
    places.push_back({first + double(c), parent.at[r]});
  };
  for (std::size_t r = block.r0; r < block.r1; ++r)
    for (std::size_t c = 0; c < block.count; ++c)
      parent.hole(r, block.c0 + c) = 1;
  for (std::size_t c = 0; c < block.count; ++c)
    pass(block.r0, c);
  for (std::size_t r = block.r0; r < block.r1; ++r)
    pass(r, block.count);
  for (std::size_t c = block.count; c > 0; --c)
    pass(block.r1, c);
  for (std::size_t r = block.r1; r > block.r0; --r)
    pass(r, 0);
}

/// Joins branch `b` to a hole in its parent. Returns `false` if there is no free block for it.
inline bool Surface_builder::join(std::size_t b)
{
  Surface_tube &tube = m_tubes[b], &parent = m_tubes[m_parent[b]];
  if (!m_rules.do_join || !m_exits[b].is_there || parent.rings.empty())
    return false;
  const Exit_frame frame = frame_of_exit(b);
  Base_loop loop = extend_backwards(b, frame);
  if (!(loop.du > 0) || !(loop.ds > 0))
    return false;
  const double most_u = m_rules.widest / frame.turn, scale_u = std::min(1.0, most_u / loop.du);
  const double room = 1 + m_rules.margin, from = parent.at.front(), to = parent.at.back();
  const double half = std::min(room * loop.ds, 0.5 * (to - from));
  Place center = frame.center;
  center.s = std::min(to - half, std::max(from + half, center.s));
  Block block;
  if (!find_block(parent, center, room * scale_u * loop.du, half, block))
    return false;
  const Loop_fit fit = fit_into(parent, block, loop, scale_u, center);
  for (Place& p : loop.places) {
    p = {fit.center.u + fit.u * p.u, fit.center.s + fit.s * p.s};
    tube.base.push_back(m_surface.points.size());
    m_surface.points.push_back(on_grid(parent, p));
  }
  Loop border;
  std::vector<Place> places;
  cut_hole(parent, block, fit.first, border, places);
  for (std::vector<Place>* list : {&places, &loop.places}) // scaled so that the loop is a circle
    for (Place& p : *list)
      p = {(p.u - fit.center.u) / (fit.u * loop.du), (p.s - fit.center.s) / (fit.s * loop.ds)};
  sew(border, places, tube.base, loop.places);
  ++m_surface.number_of_joined;
  return true;
}

/// Makes a branch without a free block a separate tube whose first ring lies inside its parent.
inline void Surface_builder::begin_inside(std::size_t b)
{
  ++m_surface.number_of_separate;
  Surface_tube& tube = m_tubes[b];
  const Branch_exit& e = m_exits[b];
  if (!e.is_there)
    return;
  const Vec3 back = e.point - e.radius * e.direction - tube.rings.front().center;
  tube.rings.front().center += back;
  for (std::size_t k = 0; k < tube.sides; ++k)
    m_surface.points[tube.vertex(0, k)] += back;
}

/// Triangulates the region between two nested loops with the same orientation around the origin.
/// Selects the shorter diagonal, provided that the angle between its ends is not too large.
inline void Surface_builder::sew(const Loop& outer,
                                 const std::vector<Place>& outer_places,
                                 const Loop& inner,
                                 const std::vector<Place>& inner_places)
{
  constexpr double pi = pcs::internal::pi, sight = 1.75; // just over a right angle [rad]
  const std::size_t n = outer.size(), m = inner.size();
  const auto distance = [&](std::size_t i, std::size_t j) {
    const Place &a = outer_places[i % n], &b = inner_places[j % m];
    return std::hypot(a.u - b.u, a.s - b.s);
  };
  double widest = 1;
  for (const Place& p : outer_places)
    widest = std::max(widest, std::hypot(p.u, p.s));
  const double out_of_sight = 1e3 * widest; // longer than all diagonals
  std::size_t i0 = 0, j0 = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j)
      if (distance(i, j) < distance(i0, j0)) {
        i0 = i;
        j0 = j;
      }
  const auto angle = [](const Place& p) { return std::atan2(p.s, p.u); };
  const auto difference = [&](const Place& a, const Place& b) { // from a to b, in (-pi, pi]
    const double d = angle(b) - angle(a);
    return d > pi ? d - 2 * pi : (d <= -pi ? d + 2 * pi : d);
  };
  double turned = difference(outer_places[i0], inner_places[j0]); // lead of the inner loop [rad]
  for (std::size_t i = 0, j = 0; i < n || j < m;) {
    const std::size_t a = i0 + i, b = j0 + j;
    const double outer_step = difference(outer_places[a % n], outer_places[(a + 1) % n]);
    const double inner_step = difference(inner_places[b % m], inner_places[(b + 1) % m]);
    const auto cost = [&](std::size_t x, std::size_t y, double ahead) {
      return distance(x, y) + out_of_sight * std::max(0.0, std::abs(ahead) - sight);
    };
    const bool is_outer = j == m || (i < n && cost(a + 1, b, turned - outer_step) <=
                                                  cost(a, b + 1, turned + inner_step));
    if (is_outer) {
      add(outer[a % n], outer[(a + 1) % n], inner[b % m]);
      turned -= outer_step;
      ++i;
    } else {
      add(outer[a % n], inner[(b + 1) % m], inner[b % m]);
      turned += inner_step;
      ++j;
    }
  }
}

/// Adds the quads outside holes, the connection to the parent, and caps on open ends.
inline void Surface_builder::close(Surface_tube& tube)
{
  if (tube.rings.empty())
    return;
  const std::size_t rows = tube.rings.size() - 1, n = tube.sides;
  const auto quad = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    add(a, b, c);
    add(a, c, d);
  };
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < n; ++k)
      if (!tube.hole(r, k))
        quad(tube.vertex(r, k),
             tube.vertex(r, k + 1),
             tube.vertex(r + 1, k + 1),
             tube.vertex(r + 1, k));
  for (std::size_t k = 0; k < n && !tube.base.empty(); ++k)
    quad(tube.base[k], tube.base[(k + 1) % n], tube.vertex(0, k + 1), tube.vertex(0, k));
  const std::size_t tip = m_surface.points.size();
  m_surface.points.push_back(tube.rings.back().center);
  for (std::size_t k = 0; k < n; ++k)
    add(tube.vertex(rows, k), tube.vertex(rows, k + 1), tip);
  if (!tube.base.empty())
    return;
  const std::size_t foot = m_surface.points.size();
  m_surface.points.push_back(tube.rings.front().center);
  for (std::size_t k = 0; k < n; ++k)
    add(tube.vertex(0, k + 1), tube.vertex(0, k), foot);
}

/// Removes points without triangles, which lie inside holes.
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

#endif // PCS_SKELETON_SURFACE_SURFACE_BUILDER_H

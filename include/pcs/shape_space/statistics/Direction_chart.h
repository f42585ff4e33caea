// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Chart of edge directions by slant and azimuth, for averages and random trees.

#ifndef PCS_SHAPE_SPACE_STATISTICS_DIRECTION_CHART_H
#define PCS_SHAPE_SPACE_STATISTICS_DIRECTION_CHART_H

#include <pcs/internal/constants.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Represents the direction of each edge by two coordinates, which are 0 in the mean of the trees.
  Usually they are slant and azimuth. The slant is the angle to the direction of growth. The azimuth
  is the angle about the direction of growth, relative to the parent. If a branch rotates about the
  trunk, its children therefore rotate with it. If the slant of a branch changes, the slant of its
  children changes by a fraction of this angle, because branches grow upwards by themselves. This
  fraction is estimated from the trees for each branch order. Upright edges have no azimuth; their
  coordinates are inclinations along two horizontal axes. In orders whose branches clearly rotate
  rigidly with their parents, the coordinates are inclinations relative to the parents.

  With rotations relative to the parent only, deviations would accumulate along the branches: random
  trees with rotations as large as in the inputs would not grow upwards. Frames are rotated by slant
  and azimuth only, without twist, so branches that hang down continue to do so.
*/
class Direction_chart
{
public:
  using Pair = Eigen::Vector2d;

  Direction_chart() = default;

  /// `middle[e]`: frame of edge `e` of the mean tree; `frame[t][e]`: the same for tree `t`;
  /// `has[t][b]`: whether tree `t` has branch `b`; `weight[e]`: weight of the edge in averages.
  Direction_chart(const Orl_layout& layout,
                  const Vec3& up,
                  const std::vector<Quaternion>& middle,
                  const std::vector<std::vector<Quaternion>>& frame,
                  const std::vector<std::vector<char>>& has,
                  const std::vector<double>& weight)
    : m_layout(layout), m_up(up), m_side(up.unitOrthogonal())
  {
    m_other = m_up.cross(m_side);
    for (std::size_t e = 0; e < middle.size(); ++e) {
      const std::size_t p = layout.parent_edge[e];
      m_step.push_back(p == none ? middle[e] : middle[p].conjugate() * middle[e]);
    }
    std::vector<std::vector<Vec3>> direction(frame.size());
    std::vector<std::vector<Polar>> polar(frame.size());
    for (std::size_t t = 0; t < frame.size(); ++t) {
      for (const Quaternion& q : frame[t]) {
        direction[t].push_back(q * Vec3::UnitZ());
        polar[t].push_back(polar_of(direction[t].back()));
      }
      // an initial estimate of the yaw of the tree relative to the others
      const Quaternion against = frame[t][0] * middle[0].conjugate();
      m_yaw.push_back(2 * std::atan2(against.vec().dot(up), against.w()));
    }
    find_kinds(polar, has);
    align_azimuths(polar, has, weight);
    find_middle(polar, has);
    find_following(polar, has, weight);
    m_is_rigid.assign(m_following.size(), 0);
    place_middle();
    find_rigid_orders(direction, has, weight);
    place_middle();
  }

  /// Returns the coordinates of the edges of tree `t`, one of the trees of the constructor. They
  /// are 0 for branches that the tree lacks.
  std::vector<Pair>
  log(const std::vector<Vec3>& direction, const std::vector<char>& has, std::size_t t) const
  {
    const Quaternion back(Eigen::AngleAxisd(-m_yaw[t], m_up));
    std::vector<Polar> polar;
    for (const Vec3& d : direction)
      polar.push_back(polar_of(back * d));
    std::vector<Quaternion> frame(direction.size());
    std::vector<Pair> z(direction.size(), Pair::Zero());
    visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
      if (!has[b])
        return;
      if (m_is_rigid[m_order[b]]) {
        const Quaternion start = start_of(frame, e);
        z[e] = lean_of(start, back * direction[e]);
        frame[e] = start * leaning(z[e]);
      } else {
        z[e] = chart(polar, b, e, anchor);
        frame[e] = free_frame(e, polar[e]);
      }
      frame[e].normalize();
    });
    return z;
  }

  /// Returns the frames of the edges from their coordinates. The z axis of a frame is the direction
  /// of the edge.
  std::vector<Quaternion> exp(const std::vector<Pair>& z) const
  {
    std::vector<Polar> polar(z.size());
    std::vector<Quaternion> frame(z.size());
    visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
      if (m_is_rigid[m_order[b]]) {
        frame[e] = start_of(frame, e) * leaning(z[e]);
        polar[e] = polar_of(frame[e] * Vec3::UnitZ());
      } else {
        polar[e] = unchart(z[e], polar, b, e, anchor);
        frame[e] = free_frame(e, polar[e]);
      }
      frame[e].normalize();
    });
    return frame;
  }

  /// Returns the angle by which an edge rotates per unit of its second coordinate. For the first
  /// coordinate, this factor is 1. [-]
  double reach(std::size_t b, std::size_t e) const
  {
    return m_is_upright[e] || m_is_rigid[m_order[b]] ? 1 : std::sin(m_middle[e][0]);
  }

private:
  static constexpr double pi = pcs::internal::pi;

  struct Polar
  {
    double slant, azimuth;
  };

  Polar polar_of(const Vec3& d) const
  {
    const double x = d.dot(m_side), y = d.dot(m_other);
    return {std::atan2(std::hypot(x, y), d.dot(m_up)), std::atan2(y, x)};
  }
  static double wrap(double angle) { return std::remainder(angle, 2 * pi); }
  static Pair lean(const Polar& p, double azimuth_of_parent)
  {
    return p.slant *
           Pair(std::cos(p.azimuth - azimuth_of_parent), std::sin(p.azimuth - azimuth_of_parent));
  }

  Vec3 direction_of(const Polar& p) const
  {
    return std::cos(p.slant) * m_up +
           std::sin(p.slant) * (std::cos(p.azimuth) * m_side + std::sin(p.azimuth) * m_other);
  }

  /// Returns the frame of an edge whose rotation relative to its parent edge is that of the mean
  /// tree.
  Quaternion start_of(const std::vector<Quaternion>& frame, std::size_t e) const
  {
    const std::size_t p = m_layout.parent_edge[e];
    return p == none ? m_step[e] : frame[p] * m_step[e];
  }
  static Quaternion leaning(const Pair& z)
  {
    const double f = z.norm() > pi ? pi / z.norm() : 1; // about an axis across the edge
    return rotation_exp(Vec3(-f * z[1], f * z[0], 0));
  }
  static Pair lean_of(const Quaternion& start, const Vec3& direction)
  {
    const Vec3 d = start.conjugate() * direction;
    const double across = d.head<2>().norm();
    return across > 0 ? Pair(d.head<2>() * (std::atan2(across, d.z()) / across))
                      : Pair(d.z() < 0 ? pi : 0, 0);
  }
  /// Returns the frame of the mean tree, rotated about the direction of growth to the azimuth of
  /// `p`, and upwards or downwards to its slant.
  Quaternion free_frame(std::size_t e, const Polar& p) const
  {
    const Polar& middle = m_polar[e];
    if (m_is_upright[e])
      return shortest_turn((m_frame[e] * Vec3::UnitZ()).normalized(), direction_of(p)) * m_frame[e];
    const Vec3 outwards = std::cos(middle.azimuth) * m_side + std::sin(middle.azimuth) * m_other;
    const Quaternion down(Eigen::AngleAxisd(p.slant - middle.slant, m_up.cross(outwards)));
    const Quaternion around(Eigen::AngleAxisd(p.azimuth - middle.azimuth, m_up));
    return around * down * m_frame[e];
  }

  Pair
  chart(const std::vector<Polar>& polar, std::size_t b, std::size_t e, std::size_t anchor) const
  {
    const double azimuth_of_parent = anchor == none ? 0 : polar[anchor].azimuth;
    if (m_is_upright[e])
      return lean(polar[e], azimuth_of_parent) - m_middle[e];
    double slant = polar[e].slant - m_middle[e][0];
    if (anchor != none)
      slant -= m_following[m_order[b]] * (polar[anchor].slant - m_middle[anchor][0]);
    return Pair(slant, wrap(polar[e].azimuth - azimuth_of_parent - m_middle[e][1]));
  }
  Polar unchart(const Pair& z,
                const std::vector<Polar>& polar,
                std::size_t b,
                std::size_t e,
                std::size_t anchor) const
  {
    const double azimuth_of_parent = anchor == none ? 0 : polar[anchor].azimuth;
    const Pair v = m_middle[e] + z;
    if (m_is_upright[e])
      return {std::min(pi, v.norm()), std::atan2(v[1], v[0]) + azimuth_of_parent};
    double slant = v[0];
    if (anchor != none)
      slant += m_following[m_order[b]] * (polar[anchor].slant - m_middle[anchor][0]);
    return {std::min(pi, std::max(0.0, slant)), azimuth_of_parent + v[1]};
  }

  /// Calls `f(branch, edge, anchor)`, parents first.
  template <class F>
  void visit(const F& f) const
  {
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e)
        f(b, e, m_anchor[b]);
    }
  }

  /// Finds the upright edges, and for each branch its anchor, the edge to which its azimuths are
  /// relative.
  void find_kinds(const std::vector<std::vector<Polar>>& polar,
                  const std::vector<std::vector<char>>& has)
  {
    constexpr double least_reach = 0.3;
    m_is_upright.assign(m_layout.number_of_edges(), 0);
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      const std::size_t p = branch.parent, r = branch.reference_edge;
      m_order.push_back(p == none ? 0 : m_order[p] + 1);
      m_anchor.push_back(p == none ? none : m_is_upright[r] ? m_anchor[p] : r);
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        double sum = 0, count = 0;
        for (std::size_t t = 0; t < polar.size(); ++t)
          if (has[t][b]) {
            sum += std::sin(polar[t][e].slant);
            ++count;
          }
        m_is_upright[e] = sum < least_reach * count;
      }
    }
  }

  /// Estimates the yaw of each tree, for which the azimuths of the branches on the trunks agree
  /// best. Subtracts it from the azimuths.
  void align_azimuths(std::vector<std::vector<Polar>>& polar,
                      const std::vector<std::vector<char>>& has,
                      const std::vector<double>& weight)
  {
    constexpr int number_of_passes = 10;
    std::vector<double> middle(m_layout.number_of_edges(), 0);
    for (int pass = 0; pass < number_of_passes; ++pass) {
      const auto add = [&](std::size_t t, std::size_t e, double angle, Pair& sum) {
        const double w = weight[e] * std::sin(polar[t][e].slant);
        sum += w * Pair(std::cos(angle), std::sin(angle));
      };
      visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
        Pair sum = Pair::Zero();
        for (std::size_t t = 0; t < polar.size(); ++t)
          if (anchor == none && has[t][b])
            add(t, e, polar[t][e].azimuth - m_yaw[t], sum);
        middle[e] = std::atan2(sum[1], sum[0]);
      });
      for (std::size_t t = 0; t < polar.size(); ++t) {
        Pair sum = Pair::Zero();
        visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
          if (anchor == none && has[t][b])
            add(t, e, polar[t][e].azimuth - middle[e], sum);
        });
        if (sum.norm() > 0)
          m_yaw[t] = std::atan2(sum[1], sum[0]);
      }
    }
    for (std::size_t t = 0; t < polar.size(); ++t)
      for (Polar& p : polar[t])
        p.azimuth -= m_yaw[t];
  }

  void find_middle(const std::vector<std::vector<Polar>>& polar,
                   const std::vector<std::vector<char>>& has)
  {
    m_middle.assign(m_layout.number_of_edges(), Pair::Zero());
    visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
      Pair sum = Pair::Zero(), lean_sum = Pair::Zero();
      double slant = 0, count = 0;
      for (std::size_t t = 0; t < polar.size(); ++t)
        if (has[t][b]) {
          const double azimuth_of_parent = anchor == none ? 0 : polar[t][anchor].azimuth;
          const double azimuth = polar[t][e].azimuth - azimuth_of_parent;
          sum += std::sin(polar[t][e].slant) * Pair(std::cos(azimuth), std::sin(azimuth));
          lean_sum += lean(polar[t][e], azimuth_of_parent);
          slant += polar[t][e].slant;
          ++count;
        }
      m_middle[e] = m_is_upright[e] ? Pair(lean_sum / count)
                                    : Pair(slant / count, std::atan2(sum[1], sum[0]));
    });
  }

  /// Computes the frames of the mean tree. Their twist is that of the mean frames of the
  /// constructor.
  void place_middle()
  {
    m_frame.resize(m_middle.size());
    m_polar.resize(m_middle.size());
    visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
      m_frame[e] = start_of(m_frame, e);
      if (m_is_rigid[m_order[b]])
        m_polar[e] = polar_of(m_frame[e] * Vec3::UnitZ());
      else {
        m_polar[e] = unchart(Pair::Zero(), m_polar, b, e, anchor);
        m_frame[e] =
            shortest_turn((m_frame[e] * Vec3::UnitZ()).normalized(), direction_of(m_polar[e])) *
            m_frame[e];
      }
      m_frame[e].normalize();
    });
  }

  /// Makes the mean inclinations of a rigid order 0.
  void center_order(const std::vector<std::vector<Vec3>>& direction,
                    const std::vector<std::vector<char>>& has,
                    std::size_t order)
  {
    constexpr int number_of_passes = 3;
    for (int pass = 0; pass < number_of_passes; ++pass) {
      std::vector<Pair> sum(m_step.size(), Pair::Zero());
      std::vector<double> count(m_step.size(), 0);
      for (std::size_t t = 0; t < direction.size(); ++t) {
        const std::vector<Pair> z = log(direction[t], has[t], t);
        visit([&](std::size_t b, std::size_t e, std::size_t) {
          if (has[t][b] && m_order[b] == order) {
            sum[e] += z[e];
            ++count[e];
          }
        });
      }
      for (std::size_t e = 0; e < m_step.size(); ++e)
        if (count[e] > 0)
          m_step[e] = m_step[e] * leaning(sum[e] / count[e]);
    }
  }

  /// Estimates, for each order, by which fraction of a slant change of the parent the slant of its
  /// branches changes. Least squares over all edges of the order.
  void find_following(const std::vector<std::vector<Polar>>& polar,
                      const std::vector<std::vector<char>>& has,
                      const std::vector<double>& weight)
  {
    const std::size_t orders = 1 + *std::max_element(m_order.begin(), m_order.end());
    std::vector<double> product(orders, 0), square(orders, 0);
    visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
      if (anchor == none || m_is_upright[e])
        return;
      for (std::size_t t = 0; t < polar.size(); ++t)
        if (has[t][b]) {
          const double parent = polar[t][anchor].slant - m_middle[anchor][0];
          product[m_order[b]] += weight[e] * parent * (polar[t][e].slant - m_middle[e][0]);
          square[m_order[b]] += weight[e] * parent * parent;
        }
    });
    for (std::size_t k = 0; k < orders; ++k)
      m_following.push_back(square[k] > 0 ? std::min(1.0, std::max(0.0, product[k] / square[k]))
                                          : 0);
  }

  /// Finds the orders whose branches rotate rigidly with their parents: this predicts their
  /// directions much better than slant and azimuth do. Branches on the trunk, which is upright, are
  /// excluded.
  void find_rigid_orders(const std::vector<std::vector<Vec3>>& direction,
                         const std::vector<std::vector<char>>& has,
                         const std::vector<double>& weight)
  {
    constexpr double clearly_less = 0.5;
    const std::size_t orders = m_following.size();
    for (std::size_t k = 2; k < orders; ++k) {
      double rigid = 0, free = 0; // weighted squares of angles
      m_is_rigid[k] = 1;
      center_order(direction, has, k);
      for (std::size_t t = 0; t < direction.size(); ++t) {
        const std::vector<Pair> z = log(direction[t], has[t], t);
        std::vector<Polar> polar;
        for (const Vec3& d : direction[t])
          polar.push_back(polar_of(Eigen::AngleAxisd(-m_yaw[t], m_up) * d));
        visit([&](std::size_t b, std::size_t e, std::size_t anchor) {
          if (!has[t][b] || m_order[b] != k)
            return;
          rigid += weight[e] * z[e].squaredNorm();
          const Vec3 expected = direction_of(unchart(Pair::Zero(), polar, b, e, anchor));
          free += weight[e] * lean_of(shortest_turn(Vec3::UnitZ(), expected.normalized()),
                                      direction_of(polar[e]))
                                  .squaredNorm();
        });
      }
      m_is_rigid[k] = rigid < clearly_less * free;
    }
  }

  Orl_layout m_layout;
  Vec3 m_up = Vec3::UnitZ(), m_side = Vec3::UnitX(), m_other = Vec3::UnitY();
  std::vector<Quaternion> m_step, m_frame;    // of the mean tree, per edge
  std::vector<Polar> m_polar;                 // likewise
  std::vector<char> m_is_upright;             // per edge
  std::vector<std::size_t> m_order, m_anchor; // per branch
  std::vector<double> m_yaw;                  // per tree
  std::vector<Pair> m_middle;                 // per edge
  std::vector<double> m_following;            // per order
  std::vector<char> m_is_rigid;               // per order
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_DIRECTION_CHART_H

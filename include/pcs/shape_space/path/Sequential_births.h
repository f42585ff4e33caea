// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sequential emergence of branches along a geodesic.

#ifndef PCS_SHAPE_SPACE_PATH_SEQUENTIAL_BIRTHS_H
#define PCS_SHAPE_SPACE_PATH_SEQUENTIAL_BIRTHS_H

#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Buffers of `Sequential_births`.
struct Sequential_births_buffers
{
  std::vector<double> life, length; ///< per branch
};

/*!
  Changes the lengths of branches that exist at only one end of a path.

  Tips move evenly from the birth of their branch to the end of the path. In every part of the
  path, the total length grows by the same amount as if all branches were born together. So the path
  has constant speed in `Orl_metric::sum`, where it is one of the shortest paths: no length both
  grows and decreases.
*/
class Sequential_births
{
public:
  Sequential_births(const Orl_layout& layout, Sequential_births_buffers& buffers)
    : m_layout(layout), m_buffers(buffers)
  {
  }

  /// Changes `x`, the tree at `t` in [0, 1] on the path from `a` to `b`. O(edges + steps *
  /// branches), with a few Newton steps.
  void operator()(const Orl_coordinates& a, const Orl_coordinates& b, double t, Orl_coordinates& x)
  {
    grow(a, b, t, x);
    grow(b, a, 1 - t, x); // lost branches are born on the reverse path
  }

private:
  double length_of(const Orl_coordinates& x, std::size_t b) const
  {
    const Orl_layout::Branch& branch = m_layout.branches[b];
    double sum = 0;
    for (std::size_t j = 0; j < branch.number_of_edges; ++j)
      sum += x.length[branch.first_edge + j];
    return sum;
  }

  /// Returns the distance from the base of branch `b` to a position on it. [L]
  double arc(const Orl_coordinates& x, std::size_t b, double position) const
  {
    const Orl_layout::Branch& branch = m_layout.branches[b];
    double sum = 0;
    for (std::size_t j = 0; j < branch.number_of_edges; ++j)
      sum += std::min(1.0, std::max(0.0, position - static_cast<double>(j))) *
             x.length[branch.first_edge + j];
    return sum;
  }

  void grow(const Orl_coordinates& from, const Orl_coordinates& to, double t, Orl_coordinates& x)
  {
    std::vector<double>&life = m_buffers.life, &length = m_buffers.length;
    const std::size_t n = m_layout.branches.size();
    life.assign(n, 1);
    length.assign(n, 0);
    double total = 0;
    for (std::size_t b = 0; b < n; ++b) {
      if (length_of(from, b) > 0)
        continue;
      length[b] = length_of(to, b);
      total += length[b];
      const std::size_t p = m_layout.branches[b].parent;
      if (p != none && length[p] > 0)
        life[b] = std::max(least_life, life[p] * (1 - arc(to, p, to.attachment[b]) / length[p]));
    }
    const double rest = rest_of_time(t * total, total);
    for (std::size_t b = 0; b < n; ++b) {
      if (!(length[b] > 0))
        continue;
      double reach = length[b] * std::max(0.0, 1 - rest / life[b]);
      const Orl_layout::Branch& branch = m_layout.branches[b];
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        x.length[e] = std::min(to.length[e], reach);
        reach = std::max(0.0, reach - to.length[e]);
      }
    }
  }

  /// Returns how much of the path remains when the length `wanted` has grown. The grown length
  /// is a convex, piecewise linear, decreasing function of this time, so Newton steps from 0 never
  /// overshoot and end on the right piece.
  double rest_of_time(double wanted, double total) const
  {
    const std::vector<double>&life = m_buffers.life, &length = m_buffers.length;
    double rest = 0, born = total;
    for (;;) {
      double slope = 0;
      for (std::size_t b = 0; b < life.size(); ++b)
        slope += rest < life[b] ? length[b] / life[b] : 0;
      const double next = slope > 0 ? rest + (born - wanted) / slope : rest;
      if (!(next > rest))
        return rest;
      rest = std::min(1.0, next);
      born = 0;
      for (std::size_t b = 0; b < life.size(); ++b)
        born += length[b] * std::max(0.0, 1 - rest / life[b]);
    }
  }

  static constexpr double least_life = 1e-6; // of a branch at the very tip of its parent [-]

  const Orl_layout& m_layout;
  Sequential_births_buffers& m_buffers;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PATH_SEQUENTIAL_BIRTHS_H

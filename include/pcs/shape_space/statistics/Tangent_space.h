// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tangent space of the shape space at a tree.

#ifndef PCS_SHAPE_SPACE_STATISTICS_TANGENT_SPACE_H
#define PCS_SHAPE_SPACE_STATISTICS_TANGENT_SPACE_H

#include <pcs/internal/constants.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcs {
namespace shape_space {

/*!
  The tangent space of the shape space at a tree, the base point. A tangent vector has five
  coordinates per edge: three for its rotation, one for its length and one for its radius. They are
  followed by two coordinates per branch: the radius at its base and its attachment. Each coordinate
  is the difference from the base point, multiplied by its weight in the metric. The norm of a
  tangent vector is the distance `Orl_metric::square` from the base point. It does not include the
  position of the root, which is not part of the shape.
*/
class Tangent_space
{
public:
  Tangent_space() = default;
  Tangent_space(const Orl_layout& layout, const Orl_coordinates& base, const Orl_weights& weights)
    : m_layout(&layout), m_base(base), m_weights(&weights)
  {
  }

  Eigen::Index dimension() const
  {
    return static_cast<Eigen::Index>(5 * m_layout->number_of_edges() +
                                     2 * m_layout->branches.size());
  }

  Eigen::VectorXd log(const Orl_coordinates& x) const
  {
    const std::size_t n = x.length.size(), m = x.attachment.size();
    Eigen::VectorXd z(dimension());
    Eigen::Index k = 0;
    for (std::size_t e = 0; e < n; ++e) {
      z.segment<3>(k) = m_weights->orientation[e] *
                        rotation_log(m_base.orientation[e].conjugate() * x.orientation[e]);
      z[k + 3] = m_weights->length[e] * (x.length[e] - m_base.length[e]);
      z[k + 4] = m_weights->radius[e] * (x.radius[e] - m_base.radius[e]);
      k += 5;
    }
    for (std::size_t b = 0; b < m; ++b, k += 2) {
      z[k] = m_weights->base_radius[b] * (x.base_radius[b] - m_base.base_radius[b]);
      z[k + 1] = m_weights->attachment[b] * (x.attachment[b] - m_base.attachment[b]);
    }
    return z;
  }

  /*!
    Returns the tree whose tangent vector is `z` (exponential map). Rotations are limited to pi,
    attachments to the extent of the parent, and lengths to at least 0. Lengths within rounding of 0
    become 0. On the trunk they become a hundredth of the length of the base point instead. Negative
    radii become a hundredth of the radius of the base point, or 0 if the edge or branch has no
    length.
  */
  Orl_coordinates exp(const Eigen::VectorXd& z) const
  {
    Orl_coordinates x = m_base;
    const std::size_t n = x.length.size(), m = x.attachment.size();
    const auto over = [](double value, double weight) { return weight > 0 ? value / weight : 0; };
    const std::size_t trunk_end =
        m_layout->branches.empty() ? 0 : m_layout->branches[0].number_of_edges;
    Eigen::Index k = 0;
    for (std::size_t e = 0; e < n; ++e, k += 5) {
      Vec3 u = m_weights->orientation[e] > 0 ? Vec3(z.segment<3>(k) / m_weights->orientation[e])
                                             : Vec3(Vec3::Zero());
      constexpr double pi = pcs::internal::pi;
      if (u.norm() > pi)
        u *= pi / u.norm();
      x.orientation[e] = m_base.orientation[e] * rotation_exp(u);
      x.orientation[e].normalize();
      const double length = x.length[e] + over(z[k + 3], m_weights->length[e]);
      x.length[e] = length > rounding * x.length[e] ? length
                    : e < trunk_end                 ? least_fraction * x.length[e]
                                                    : 0;
      x.radius[e] = radius_at(x.radius[e], over(z[k + 4], m_weights->radius[e]), x.length[e] > 0);
    }
    for (std::size_t b = 0; b < m; ++b, k += 2) {
      const Orl_layout::Branch& branch = m_layout->branches[b];
      const auto first = x.length.begin() + static_cast<std::ptrdiff_t>(branch.first_edge);
      const bool is_there = std::any_of(first,
                                        first + static_cast<std::ptrdiff_t>(branch.number_of_edges),
                                        [](double length) { return length > 0; });
      x.base_radius[b] =
          radius_at(x.base_radius[b], over(z[k], m_weights->base_radius[b]), is_there);
      const std::size_t p = m_layout->branches[b].parent;
      const double last =
          p == none ? 0 : static_cast<double>(m_layout->branches[p].number_of_edges);
      const double place = x.attachment[b] + over(z[k + 1], m_weights->attachment[b]);
      x.attachment[b] = std::min(last, std::max(0.0, place));
    }
    return x;
  }

private:
  static constexpr double rounding = 1e-9, least_fraction = 0.01; // of the value of the base point

  static double radius_at(double base, double step, bool is_there)
  {
    const double radius = base + step;
    if (radius >= -rounding * base) // may be 0, as in an input
      return std::max(0.0, radius);
    return is_there ? least_fraction * base : 0;
  }

  const Orl_layout* m_layout = nullptr;
  Orl_coordinates m_base;
  const Orl_weights* m_weights = nullptr;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_TANGENT_SPACE_H

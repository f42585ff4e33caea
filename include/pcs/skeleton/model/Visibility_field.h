// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Direction from which branches are seen, as a function of position.

#ifndef PCS_SKELETON_MODEL_VISIBILITY_FIELD_H
#define PCS_SKELETON_MODEL_VISIBILITY_FIELD_H

#include <pcs/internal/constants.h>
#include <pcs/skeleton/model/Density_field.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  Visible side of branches. One station sees one side of every branch, and several stations see the
  outer side of outer branches. The mean outward normal of the points of a section, perpendicular to
  the axis, is modeled as a linear function of position. The model is fitted by robust ridge
  regression to sections of reliable radius. It selects the correct side for thin sections, whose
  points fit circles on both sides.
*/
class Visibility_field
{
public:
  /// Returns whether there were enough samples.
  bool is_known() const { return m_is_known; }

  /// Fits the field. O(samples). Defined in fit_fields.h.
  void learn(const std::vector<Density_sample>& all);

  /// Returns the expected mean outward normal of the points of a branch at `place` along the unit
  /// vector `along`; short where points lie on all sides [-].
  Vec3 operator()(const Vec3& place, const Vec3& along) const
  {
    const Row r = row(place);
    Vec3 facing = Vec3::Zero();
    for (Eigen::Index a = 0; a < size; ++a)
      facing += r[a] * m_weights.segment<3>(3 * a);
    facing -= facing.dot(along) * along;
    const double length = facing.norm();
    return length > largest ? Vec3(largest / length * facing) : facing;
  }

  /// Returns the median deviation of sections from the model [-].
  double deviation() const { return m_deviation; }

private:
  static constexpr Eigen::Index size = 4;
  static constexpr double least_deviation = 0.05;
  static constexpr double largest = 0.25 * pcs::internal::pi; // of the half that one station sees
  using Row = Eigen::Vector4d;
  using Weights = Eigen::Matrix<double, 3 * size, 1>;
  using Matrix = Eigen::Matrix<double, 3 * size, 3 * size>;

  Row row(const Vec3& place) const
  {
    const Vec3 q = m_frame.within(place);
    return Row(1, q.x(), q.y(), q.z());
  }

  bool m_is_known = false;
  Sample_frame m_frame;
  Weights m_weights = Weights::Zero();
  double m_deviation = 0;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_VISIBILITY_FIELD_H

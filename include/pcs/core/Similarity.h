// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Similarity transformation (rotation, uniform scale, translation) that keeps full turns.

#ifndef PCS_CORE_SIMILARITY_H
#define PCS_CORE_SIMILARITY_H

#include <pcs/core/errors.h>
#include <pcs/core/rotations.h>
#include <pcs/internal/text.h>

#include <CGAL/double.h>
#include <CGAL/number_utils.h>

#include <boost/container/small_vector.hpp>

#include <Eigen/Core>
#include <Eigen/LU>

#include <cmath>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>

namespace pcs {

/*!
  \ingroup PkgPcsCoreRef
  \brief The map x -> s R x + t, where R is stored as a sequence of rotations about axes.

  A rotation matrix cannot distinguish 720 degrees from 0 degrees; the sequence can. Rotations about
  the same axis are added, so any number of small rotations can be multiplied. Coordinates are in
  double precision.
*/
class Similarity
{
public:
  using Vec3 = Eigen::Vector3d;

  /// One rotation about an axis through the origin: `axis * angle` [rad], for any angle.
  using Turn = Vec3;
  /// Up to four rotations need no heap memory.
  using Turns = boost::container::small_vector<Turn, 4>;

  Similarity() = default;

  /// Rotation by `axis * angle` [rad] about the origin. Throws `Invalid_input` from 1e12 rad on.
  static Similarity from_turn(const Turn& turn)
  {
    Similarity s;
    s.append(turn);
    return s;
  }

  static Similarity from_translation(const Vec3& t)
  {
    Similarity s;
    s.m_translation = t;
    return s;
  }

  static Similarity from_scale(double factor)
  {
    if (!(factor > 0) || !std::isfinite(factor))
      throw Invalid_input("pcs::Similarity: the scale factor is " + internal::to_text(factor) +
                          "; it must be finite and positive");
    Similarity s;
    s.m_scale = factor;
    return s;
  }

  /// The similarity `s` with the fixed point `center` instead of the origin.
  static Similarity about(const Similarity& s, const Vec3& center)
  {
    Similarity result = s;
    // Differences first: exact for the identity, and accurate for small turns far from the origin.
    result.m_translation = s.m_translation + (center - s.m_scale * (s.m_rotation * center));
    return result;
  }

  /// Converts a row-major 3 x 4 or 4 x 4 matrix. Throws `Invalid_input` unless it is composed of a
  /// rotation (no reflection), a uniform scale and a translation, to 1e-6. The rotation is
  /// interpreted as a rotation by at most 180 degrees.
  static Similarity from_matrix(const Eigen::Matrix<double, 3, 4>& m)
  {
    if (!m.allFinite())
      throw Invalid_input("pcs::Similarity: the matrix holds a value that is not finite");
    const Eigen::Matrix3d a = m.leftCols<3>();
    const double determinant = a.determinant();
    if (!(determinant > 0))
      throw Invalid_input("pcs::Similarity: the matrix has determinant " +
                          internal::to_text(determinant) +
                          "; a rotation with scale has a positive one");
    const double scale = std::cbrt(determinant);
    const Eigen::Matrix3d r = a / scale;
    const double error = (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(error < 1e-6))
      throw Invalid_input(
          "pcs::Similarity: the matrix is not a rotation with uniform scale (off by " +
          internal::to_text(error) + "); shear and unequal scales are not possible");
    Similarity s;
    if ((r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 0) {
      s.append(rotation_log(Quaternion(r).normalized()));
    }
    s.m_scale = scale;
    s.m_translation = m.col(3);
    return s;
  }

  const Turns& turns() const { return m_turns; }
  const Eigen::Matrix3d& rotation() const { return m_rotation; }
  double scale() const { return m_scale; }
  const Vec3& translation() const { return m_translation; }

  /// Sum of the angles of all turns. [rad]
  double total_angle() const
  {
    double sum = 0;
    for (const Turn& t : m_turns)
      sum += t.norm();
    return sum;
  }

  Vec3 operator()(const Vec3& x) const { return m_scale * (m_rotation * x) + m_translation; }

  /// Applies `b`, then `a`.
  friend Similarity operator*(const Similarity& a, const Similarity& b)
  {
    Similarity s = b;
    for (const Turn& t : a.m_turns)
      s.append(t);
    s.m_scale = a.m_scale * b.m_scale;
    s.m_translation = a.m_scale * (a.m_rotation * b.m_translation) + a.m_translation;
    return s;
  }

  /// Whether the map is exactly the identity.
  bool is_identity() const
  {
    return m_scale == 1 && m_turns.empty() && m_translation == Vec3::Zero();
  }

  bool is_finite() const
  {
    return m_rotation.allFinite() && m_translation.allFinite() && std::isfinite(m_scale);
  }

private:
  void append(const Turn& turn)
  {
    check_turn(turn);
    if (turn.squaredNorm() > 0) {
      // Rotations about the same or the opposite axis are added; if they cancel, none remains.
      const bool is_same_axis = !m_turns.empty() && turn.cross(m_turns.back()).norm() <=
                                                        1e-12 * turn.norm() * m_turns.back().norm();
      if (!is_same_axis)
        m_turns.push_back(turn);
      else {
        const double before = m_turns.back().norm();
        check_turn(m_turns.back() + turn);
        m_turns.back() += turn;
        if (m_turns.back().norm() <= 1e-15 * before)
          m_turns.pop_back();
      }
    }
    Quaternion q = Quaternion::Identity();
    for (const Turn& t : m_turns)
      q = rotation_exp(t) * q;
    m_rotation = m_turns.empty() ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                 : q.normalized().toRotationMatrix();
  }

  static void check_turn(const Turn& turn)
  {
    if (!turn.allFinite())
      throw Invalid_input("pcs::Similarity: a turn is not finite");
    const double largest = turn.cwiseAbs().maxCoeff();
    if (!(largest < largest_turn))
      throw Invalid_input("pcs::Similarity: a turn by " + internal::to_text(largest) +
                          " rad; its direction would be lost from " +
                          internal::to_text(largest_turn) + " rad on");
  }

  static constexpr double largest_turn = 1e12; ///< where a double resolves 1e-4 rad [rad]

  Turns m_turns;
  Eigen::Matrix3d m_rotation = Eigen::Matrix3d::Identity();
  Vec3 m_translation = Vec3::Zero();
  double m_scale = 1;
};

namespace internal {

template <class Triple>
Eigen::Vector3d to_eigen(const Triple& p)
{
  return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

template <class T, class = void>
struct Has_matrix_access : std::false_type
{
};
template <class T>
struct Has_matrix_access<T, std::void_t<decltype(std::declval<const T&>().m(0, 3))>>
  : std::true_type
{
};

/// Whether `T` is an `Eigen::Transform` in space, or a 4 x 4 or 3 x 4 matrix of Eigen.
template <class T, class = void>
struct Is_eigen_transformation : std::false_type
{
};
template <class T>
struct Is_eigen_transformation<T, std::void_t<decltype(std::declval<const T&>().matrix().eval())>>
{
  using Matrix = std::decay_t<decltype(std::declval<const T&>().matrix().eval())>;
  static constexpr bool value =
      int(Matrix::ColsAtCompileTime) == 4 &&
      (int(Matrix::RowsAtCompileTime) == 4 || int(Matrix::RowsAtCompileTime) == 3);
};

template <class Vector_3>
Eigen::Vector3d unit_axis(const Vector_3& axis, const char* function)
{
  const Eigen::Vector3d a = to_eigen(axis);
  const double length = a.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) {
    std::ostringstream message;
    message << function << ": the axis (" << a.transpose() << ") must be finite and not zero";
    throw Invalid_input(message.str());
  }
  return a / length;
}

} // namespace internal

/// Whether `to_similarity()` accepts `T`.
template <class T>
constexpr bool is_similarity_like_v =
    std::is_convertible_v<T, Similarity> || internal::Has_matrix_access<T>::value ||
    internal::Is_eigen_transformation<T>::value;

/*!
  \ingroup PkgPcsCoreRef
  \brief converts a `Similarity`, a `CGAL::Aff_transformation_3`, an `Eigen::Transform` such as
      `Eigen::Isometry3d`, or a 4 x 4 matrix of Eigen to a `Similarity`.
  \throws Invalid_input if the transformation reflects, shears or scales unequally, or if the last
      row of a 4 x 4 matrix is not (0, 0, 0, 1)
*/
template <class Transformation>
Similarity to_similarity(const Transformation& t)
{
  if constexpr (std::is_convertible_v<Transformation, Similarity>)
    return t;
  else if constexpr (internal::Is_eigen_transformation<Transformation>::value) {
    const auto m = t.matrix().template cast<double>().eval();
    if constexpr (decltype(m)::RowsAtCompileTime == 4)
      if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw Invalid_input("pcs::to_similarity(): the last row of the matrix is not (0, 0, 0, 1)");
    return Similarity::from_matrix(m.template topRows<3>());
  } else {
    static_assert(internal::Has_matrix_access<Transformation>::value,
                  "pcs: a transformation must be a pcs::Similarity, a CGAL::Aff_transformation_3, "
                  "or a transformation or 4 x 4 matrix of Eigen");
    Eigen::Matrix<double, 3, 4> m;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        m(row, column) = CGAL::to_double(t.m(row, column));
    return Similarity::from_matrix(m);
  }
}

/*!
  \ingroup PkgPcsCoreRef
  \brief rotation by `angle` [rad], of any sign and number of turns, about `axis` through `center`.
  \throws Invalid_input if `axis` is zero or a value is not finite
*/
template <class Vector_3, class Point_3>
Similarity rotation(const Vector_3& axis, double angle, const Point_3& center)
{
  if (!std::isfinite(angle))
    throw Invalid_input("pcs::rotation(): the angle is not finite");
  return Similarity::about(
      Similarity::from_turn(angle * internal::unit_axis(axis, "pcs::rotation()")),
      internal::to_eigen(center));
}

//! \ingroup PkgPcsCoreRef
//! \brief translation by `offset` [L].
template <class Vector_3>
Similarity translation(const Vector_3& offset)
{
  return Similarity::from_translation(internal::to_eigen(offset));
}

//! \ingroup PkgPcsCoreRef
//! \brief uniform scale by `factor` > 0 with the fixed point `center`.
template <class Point_3>
Similarity scaling(double factor, const Point_3& center)
{
  return Similarity::about(Similarity::from_scale(factor), internal::to_eigen(center));
}

} // namespace pcs

#endif // PCS_CORE_SIMILARITY_H

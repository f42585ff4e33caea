// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Transformation of a Gaussian splat by the deformation gradient at its centre.

#ifndef PCS_SPLATS_SPLAT_TRANSFORMATION_H
#define PCS_SPLATS_SPLAT_TRANSFORMATION_H

#include <pcs/core/errors.h>
#include <pcs/core/rotations.h>
#include <pcs/splats/principal_axes.h>
#include <pcs/splats/rotate_harmonics.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>

namespace pcs {
namespace splats {

/*!
  \ingroup PkgPcsDeformationRef
  \brief The shape of a Gaussian splat as files of 3D Gaussian splatting store it.
*/
struct Splat_shape
{
  Quaternion rotation = Quaternion::Identity(); //!< of any length; zero stands for the identity
  Eigen::Vector3d log_scale = Eigen::Vector3d::Zero(); //!< logarithms of the half axes

  //! returns the covariance `R S^2 R^T` [L^2]
  Eigen::Matrix3d covariance() const
  {
    const Eigen::Matrix3d axes =
        unit_rotation().toRotationMatrix() * Eigen::Vector3d(log_scale.array().exp()).asDiagonal();
    return axes * axes.transpose();
  }

  //! returns the rotation with length 1
  Quaternion unit_rotation() const
  {
    const double length = rotation.coeffs().stableNorm();
    return length > 0 ? Quaternion(Eigen::Vector4d(rotation.coeffs() / length))
                      : Quaternion::Identity();
  }

  //! whether the numbers define a covariance: a scale of 0, with the logarithm -infinity, does
  bool is_valid() const
  {
    return rotation.coeffs().allFinite() &&
           (log_scale.array() < std::numeric_limits<double>::infinity()).all();
  }
};

/*!
  \ingroup PkgPcsDeformationRef
  \brief Transforms splats by a deformation gradient.

  With the gradient `F`, the covariance `C` of a splat becomes `F C F^T` [Zwicker et al., "EWA
  splatting", 2002]. Its colours turn with the rotation `Q` that is nearest to `F`, the factor of
  the polar decomposition `F = Q P`.

  The new half axes and the new rotation follow from the singular values of `F R S`:

      Q^T F R S = R M S,  M = R^T (Q^T F) R,
      M S V = U D,  F C F^T = (Q R U) D^2 (Q R U)^T

  with the rotation `V` of Jacobi's method and the diagonal matrix `D`. `U` is the identity if
  the deformation is a similarity. Otherwise the signs of its columns are those for which it is near
  the identity, and each axis of the splat keeps its number, because every rotation in `V` is by the
  smaller of two angles.
*/
class Splat_transformation
{
public:
  /*!
    \param gradient the derivative of the new positions with respect to the old ones [-]. A
           gradient with a determinant that is not positive collapses or inverts its surroundings;
           the rotation `Q` then maximises `trace(Q^T gradient)` up to the accuracy of an iteration.
    \throws Invalid_input if the gradient is not finite
  */
  explicit Splat_transformation(const Eigen::Matrix3d& gradient)
    : m_is_identity((gradient - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= tolerance)
  {
    if (!gradient.allFinite())
      throw Invalid_input("pcs::splats::Splat_transformation: the gradient is not finite");
    if (m_is_identity)
      return;
    m_rotation = internal::polar_rotation(gradient);
    m_stretch = m_rotation.transpose() * gradient;
    m_quaternion = Quaternion(m_rotation);
  }

  //! whether the gradient is the identity up to rounding; splats then remain bitwise unchanged
  bool is_identity() const { return m_is_identity; }

  //! the rotation `Q`
  const Eigen::Matrix3d& rotation() const { return m_rotation; }

  /*!
    \brief transforms the shape of a splat; its quaternion keeps its length.

    A zero quaternion is read as the identity, as by the renderer of \cite kerbl2023, and replaced
    by one of length 1. Scales of 0 remain 0. No half axis shrinks by more than the factor 1e-15.

    \return `false` if the shape is not valid; it is left unchanged then
  */
  bool transform(Splat_shape& shape) const
  {
    if (!shape.is_valid())
      return false;
    if (m_is_identity)
      return true;
    const Quaternion unit = shape.unit_rotation();
    const Eigen::Matrix3d r = unit.toRotationMatrix();
    const internal::Principal_axes axes =
        internal::principal_axes(r.transpose() * m_stretch * r, shape.log_scale);
    const double length = shape.rotation.coeffs().stableNorm();
    Quaternion turned = m_quaternion * unit;
    if (!axes.is_aligned)
      turned = turned * Quaternion(axes.rotation);
    turned.coeffs() *= (length > 0 ? length : 1.0) / turned.norm();
    shape.rotation = turned;
    shape.log_scale = axes.log_scale;
    return true;
  }

  //! rotates the colours of a splat; see `pcs::splats::rotate_harmonics()`
  template <class FT>
  void rotate_harmonics(int degree, FT* coefficients) const
  {
    if (!m_is_identity)
      splats::rotate_harmonics(m_rotation, degree, coefficients);
  }

private:
  /// Gradients this near to the identity change no bit that matters: the numbers of files are
  /// `float`, with a precision of 6e-8.
  static constexpr double tolerance = 1e-10;

  bool m_is_identity;
  Eigen::Matrix3d m_rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d m_stretch = Eigen::Matrix3d::Identity(); ///< `Q^T F`
  Quaternion m_quaternion = Quaternion::Identity();
};

} // namespace splats
} // namespace pcs

#endif // PCS_SPLATS_SPLAT_TRANSFORMATION_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Nonrigid registration on plain coordinates: the compiled part of `Point_set_fitting`.

#ifndef PCS_REGISTRATION_FIT_SESSION_H
#define PCS_REGISTRATION_FIT_SESSION_H

#include <pcs/deformation/model/Local_frame.h>
#include <pcs/deformation/model/Sampling_options.h>
#include <pcs/internal/progress.h>
#include <pcs/registration/Fit_options.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace pcs {
namespace registration {

using Vec3 = Eigen::Vector3d;

/// A landmark in local coordinates.
struct Local_landmark
{
  std::uint32_t index; ///< of the source point
  Vec3 target;         ///< [L]
};

/// A target in local coordinates.
struct Fit_input
{
  std::vector<Vec3> points;
  std::vector<Vec3> normals; ///< unit vectors, or empty
  std::vector<Local_landmark> landmarks;
};

/// Returns the unit normal after a linear map, by its cofactors; null if it vanishes.
inline Vec3 moved_normal(const Eigen::Matrix3d& linear, const Vec3& normal)
{
  Eigen::Matrix3d cofactors;
  cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)),
      linear.col(0).cross(linear.col(1));
  const Vec3 n = cofactors * normal;
  const double length = n.norm();
  return length > 0 ? Vec3(n / length) : Vec3(Vec3::Zero());
}

template <class ConcurrencyTag>
class Fit_stages;

/// The algorithm of `Point_set_fitting`, independent of point types.
template <class ConcurrencyTag>
class Fit_session
{
public:
  Fit_session();
  ~Fit_session();

  /// Prepares the source. Returns `false` if cancelled; then only `number_of_points()` and
  /// `frame()` may be called. To be called once.
  /// \param points in the caller's coordinates
  /// \param normals one for each point, or empty: they are estimated
  bool build(std::vector<Vec3> points,
             std::vector<Vec3> normals,
             const deformation::Sampling_options& sampling,
             pcs::internal::Progress& progress);

  const deformation::Local_frame& frame() const;
  /// Diagonal of the bounding box of the source, in local coordinates. [L]
  double extent() const;
  std::size_t number_of_points() const;
  std::size_t number_of_samples() const;
  /// Position of a source point in the current shape, in the caller's coordinates. [L]
  Vec3 position(std::size_t i) const;
  /// Derivative of its position with respect to that at rest. [-]
  Eigen::Matrix3d gradient(std::size_t i) const;

  void put_at_rest();

  /*!
    Deforms the shape towards the target, calls `write()`, and completes the report. Returns the
    closest target point of each source point, or -1. If the status is `cancelled` or
    `numerical_failure`, the shape is kept, and nothing is written.
    \param is_warm whether to start from the current shape, which is near the target: the stages
           with soft matches are shorter
  */
  std::vector<std::ptrdiff_t> fit(const Fit_input& input,
                                  const Fit_options& options,
                                  bool is_warm,
                                  const std::function<void()>& write,
                                  Fit_report& report,
                                  pcs::internal::Progress& progress);

private:
  std::unique_ptr<Fit_stages<ConcurrencyTag>> m_stages;
};

} // namespace registration
} // namespace pcs

#ifndef PCS_COMPILED_DEFORMATION
#include <pcs/registration/Fit_session_impl.h>
#endif

#endif // PCS_REGISTRATION_FIT_SESSION_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options and report of `fit_point_set()`.

#ifndef PCS_REGISTRATION_FIT_OPTIONS_H
#define PCS_REGISTRATION_FIT_OPTIONS_H

#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>

#include <cstddef>
#include <ostream>

namespace pcs {

//! \ingroup PkgPcsRegistrationRef
//! a point of the source and the position that it must reach
struct Landmark
{
  std::size_t index = 0;   //!< number of the point in the source
  Similarity::Vec3 target; //!< its position on the target [L]
};

//! \ingroup PkgPcsRegistrationRef
//! statistics of `fit_point_set()`
struct Fit_report
{
  Status status = Status::nothing_to_do;

  std::size_t number_of_source_points = 0; ///< [count]
  std::size_t number_of_target_points = 0; ///< [count]
  std::size_t number_of_samples = 0;       ///< nodes of the deformation [count]
  std::size_t number_of_matched = 0;       ///< source points with a target point [count]
  std::size_t number_of_iterations = 0;    ///< of all stages [count]

  //! distance of a matched point from the target surface; NaN if none is matched [L]
  double median_residual = 0;
  double rms_residual = 0;         ///< the same, root mean square [L]
  double largest_landmark_gap = 0; ///< largest distance of a landmark from its target [L]
  double rms_displacement = 0;     ///< of all source points [L]

  //! whether at least `least_matched_share` of the source points are matched, with a median
  //! residual below `largest_plausible_residual` extents of the source
  bool is_plausible = false;
  Similarity rigid_motion; ///< of the initial alignment; the identity without it

  //! wall-clock time of each stage [s]
  struct Seconds
  {
    double preparation = 0, rigid = 0, coarse = 0, fine = 0, writing = 0;
  } seconds;

  //! fraction of the source points that are matched [-]
  double matched_share() const
  {
    return number_of_source_points > 0 ? static_cast<double>(number_of_matched) /
                                             static_cast<double>(number_of_source_points)
                                       : 0;
  }

  static constexpr double least_matched_share = 0.2;         //!< [-]
  static constexpr double largest_plausible_residual = 0.02; //!< [extents of the source]
};

inline std::ostream& operator<<(std::ostream& out, const Fit_report& r)
{
  out << "status " << r.status << (r.is_plausible ? "" : " (not plausible)") << ", "
      << r.number_of_matched << " of " << r.number_of_source_points << " source points matched to "
      << r.number_of_target_points << " target points, residual median " << r.median_residual
      << " rms " << r.rms_residual << ", displacement rms " << r.rms_displacement << ", "
      << r.number_of_samples << " samples, " << r.number_of_iterations
      << " iterations; seconds: preparation " << r.seconds.preparation << ", rigid "
      << r.seconds.rigid << ", coarse " << r.seconds.coarse << ", fine " << r.seconds.fine
      << ", writing " << r.seconds.writing;
  return out;
}

namespace registration {

//! default number of samples of the deformation [count]
constexpr std::size_t default_number_of_fit_samples = 500;
/// Largest number of samples that carry a point. [count]
constexpr std::size_t carriers_of_point = 4;
//! default of `fitting_length` [extents of the source]
constexpr double default_fitting_length = 0.02;

struct Fit_options
{
  double stiffness = 1;                           ///< bending relative to stretching [-]
  double fitting_length = default_fitting_length; ///< [extents of the source]
  double outlier_share = 0.1;                     ///< expected share of target outliers [-]
  std::size_t number_of_iterations = 60;          ///< largest number per stage [count]
  double tolerance = 1e-4;                        ///< [extents of the source]
  bool do_align = true;                           ///< whether a rigid alignment comes first
  bool is_oriented = false; ///< whether normals of both clouds point to the same side
};

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_FIT_OPTIONS_H

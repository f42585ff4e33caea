// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Statistics of a deformation: counts, energies, seconds per stage.

#ifndef PCS_CORE_DEFORMATION_REPORT_H
#define PCS_CORE_DEFORMATION_REPORT_H

#include <pcs/core/Status.h>

#include <cstddef>
#include <ostream>

namespace pcs {

//! \ingroup PkgPcsDeformationRef
//! why a deformation has its number of samples
enum class Sample_choice {
  requested,     //!< by the named parameter `number_of_samples`
  all_points,    //!< by default, because there are at most `largest_unsampled_size` points
  default_number //!< by default, because there are more points, or a published variant of the
                 //!< blending is chosen
};

inline const char* to_string(Sample_choice choice)
{
  switch (choice) {
  case Sample_choice::requested:
    return "requested";
  case Sample_choice::all_points:
    return "all points";
  case Sample_choice::default_number:
    return "default";
  }
  return "unknown";
}

inline std::ostream& operator<<(std::ostream& out, Sample_choice choice)
{
  return out << to_string(choice);
}

//! \ingroup PkgPcsDeformationRef
//! statistics of `deform_point_set()` or `Point_set_deformation::deform()`
struct Deformation_report
{
  Status status = Status::nothing_to_do;

  std::size_t number_of_points = 0;     ///< of the input [count]
  std::size_t number_of_duplicates = 0; ///< points that coincide with another point [count]
  std::size_t number_of_samples = 0;    ///< nodes of the non-linear problem [count]
  Sample_choice sample_choice = Sample_choice::requested; ///< why there are that many samples
  std::size_t number_of_interior_links = 0;               ///< springs through the interior [count]
  std::size_t number_of_short_cuts = 0; ///< links removed between separate sheets [count]
  std::size_t number_of_components = 0; ///< of the neighbour graph [count]
  std::size_t number_of_unreached_components =
      0; ///< components without handle, which keep their positions [count]
  std::size_t number_of_unreached_points = 0; ///< points of those components [count]
  std::size_t number_of_iterations = 0;       ///< iterations over rotations and positions [count]

  double initial_energy = 0; ///< of the state from which the iterations start [L^2]
  double energy = 0;         ///< of the result [L^2]

  //! wall-clock time of each stage [s]; 0 for stages that were not repeated
  struct Seconds
  {
    double neighbors = 0, sampling = 0, factorization = 0, solving = 0, upsampling = 0;
    double coarse_levels = 0; ///< part of `solving`: initial solves on coarser networks
  } seconds;
};

inline std::ostream& operator<<(std::ostream& out, const Deformation_report& r)
{
  out << "status " << r.status << ", " << r.number_of_points << " points ("
      << r.number_of_duplicates << " duplicates), " << r.number_of_samples << " samples ("
      << r.sample_choice << "), " << r.number_of_interior_links << " interior links, "
      << r.number_of_short_cuts << " short cuts dropped, " << r.number_of_components
      << " components (" << r.number_of_unreached_components << " unreached with "
      << r.number_of_unreached_points << " points), " << r.number_of_iterations
      << " iterations, energy " << r.initial_energy << " -> " << r.energy << "; seconds: neighbors "
      << r.seconds.neighbors << ", sampling " << r.seconds.sampling << ", factorization "
      << r.seconds.factorization << ", solving " << r.seconds.solving << " (coarse levels "
      << r.seconds.coarse_levels << "), upsampling " << r.seconds.upsampling;
  return out;
}

} // namespace pcs

#endif // PCS_CORE_DEFORMATION_REPORT_H

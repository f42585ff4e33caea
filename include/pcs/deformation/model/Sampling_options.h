// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of the sampling of a point cloud.

#ifndef PCS_DEFORMATION_MODEL_SAMPLING_OPTIONS_H
#define PCS_DEFORMATION_MODEL_SAMPLING_OPTIONS_H

#include <pcs/core/Deformation_options.h>

#include <cstddef>

namespace pcs {

//! \ingroup PkgPcsDeformationRef
//! default number of samples on which the non-linear problem is solved, for clouds of more than
//! `largest_unsampled_size` points [count]
constexpr std::size_t default_number_of_samples = 2000;
//! \ingroup PkgPcsDeformationRef
//! largest number of points at different positions that are all samples by default: they are solved
//! within one or two frames (0.04 s on one thread), and have springs through the interior. Measured
//! in benchmark/results/deformation.md [count]
constexpr std::size_t largest_unsampled_size = 20000;
//! \ingroup PkgPcsDeformationRef
//! default number of nearest neighbours linked to a point; 5 to 6 in \cite aiteanu2022 [count]
constexpr std::size_t default_number_of_neighbors = 6;
//! \ingroup PkgPcsDeformationRef
//! default number of nearest samples whose maps are blended at a point [count]
constexpr std::size_t default_number_of_sample_neighbors = 6;

namespace deformation {

/// Lets the number of points determine the number of samples, see `number_of_samples_by_default()`.
constexpr std::size_t automatic_number_of_samples = 0;

/// Returns the number of samples for `n` points at different positions if none is requested.
constexpr std::size_t number_of_samples_by_default(std::size_t n)
{
  return n <= largest_unsampled_size ? n : default_number_of_samples;
}

struct Sampling_options
{
  std::size_t number_of_samples = automatic_number_of_samples;
  std::size_t number_of_neighbors = default_number_of_neighbors;
  std::size_t number_of_sample_neighbors = default_number_of_sample_neighbors;
  Sample_search sample_search = Sample_search::regions;
  Sample_weights sample_weights = Sample_weights::compact;
  bool do_preserve_volume = true;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_SAMPLING_OPTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of the sampling of a point cloud.

#ifndef PCS_DEFORMATION_MODEL_SAMPLING_OPTIONS_H
#define PCS_DEFORMATION_MODEL_SAMPLING_OPTIONS_H

#include <pcs/core/Deformation_options.h>

#include <cstddef>

namespace pcs {

//! \ingroup PkgPcsDeformationRef
//! default number of samples on which the non-linear problem is solved [count]
constexpr std::size_t default_number_of_samples = 2000;
//! \ingroup PkgPcsDeformationRef
//! default number of nearest neighbours linked to a point; 5 to 6 in \cite aiteanu2022 [count]
constexpr std::size_t default_number_of_neighbors = 6;
//! \ingroup PkgPcsDeformationRef
//! default number of nearest samples whose maps are blended at a point [count]
constexpr std::size_t default_number_of_sample_neighbors = 6;

namespace deformation {

struct Sampling_options
{
  std::size_t number_of_samples = default_number_of_samples;
  std::size_t number_of_neighbors = default_number_of_neighbors;
  std::size_t number_of_sample_neighbors = default_number_of_sample_neighbors;
  Sample_search sample_search = Sample_search::regions;
  Sample_weights sample_weights = Sample_weights::compact;
  bool do_preserve_volume = true;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_SAMPLING_OPTIONS_H

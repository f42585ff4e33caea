// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One nonrigid registration of a point cloud to another one.

#ifndef PCS_REGISTRATION_FIT_POINT_SET_H
#define PCS_REGISTRATION_FIT_POINT_SET_H

#include <pcs/Named_function_parameters.h>
#include <pcs/deformation/access/Point_access.h>
#include <pcs/registration/Point_set_fitting.h>

namespace pcs {

/*!
  \ingroup PkgPcsRegistrationRef
  \brief deforms the cloud `source` onto the cloud `target`, without given correspondences.

  This is equivalent to one call of `fit()` of a `Point_set_fitting`; see there for the model, the
  named parameters, errors, cost and determinism.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \param source a model of `RandomAccessRange`, modified in place through `point_map`
  \param target a range of points, not modified [L]
  \param np named parameters of the source and of the stages, see `Point_set_fitting`
  \param target_np `point_map`, `normal_map` of the target, and `landmarks`, see
         `Point_set_fitting::fit()`
  \return a `Fit_report`: status, matches, residuals, seconds per stage
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class SourceRange,
          class TargetRange,
          class NamedParameters = parameters::Default_named_parameters,
          class TargetParameters = parameters::Default_named_parameters>
Fit_report fit_point_set(SourceRange& source,
                         const TargetRange& target,
                         const NamedParameters& np = NamedParameters(),
                         const TargetParameters& target_np = TargetParameters())
{
  using Maps = deformation::Map_parameters<NamedParameters>;
  return Point_set_fitting<SourceRange, Maps, ConcurrencyTag>(source, np).fit(target, target_np);
}

} // namespace pcs

#endif // PCS_REGISTRATION_FIT_POINT_SET_H

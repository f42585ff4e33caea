// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One non-linear deformation of a point cloud by handles.

#ifndef PCS_DEFORM_POINT_SET_H
#define PCS_DEFORM_POINT_SET_H

#include <pcs/Point_set_deformation.h>
#include <pcs/concepts.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/internal/progress.h>

#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsDeformationRef
//! points that move together, and their motion
struct Deformation_handle
{
  std::vector<std::size_t> indices; //!< numbers of the points
  Similarity transformation;        //!< motion from rest; the identity fixes the points
  double softness = 0;              //!< see `Point_set_deformation::add_handle()` [-]
  //! target of each point; if not empty, it replaces the transformation, see
  //! `Point_set_deformation::set_targets()` [L]
  std::vector<Similarity::Vec3> targets = {};
};

namespace internal {

template <class T, class = void>
struct Is_handle_range : std::false_type
{
};
template <class T>
struct Is_handle_range<T, std::enable_if_t<!std::is_void_v<typename Iterator_of<const T>::type>>>
  : std::is_convertible<decltype(*std::begin(std::declval<const T&>())), const Deformation_handle&>
{
};

template <class T, class = void>
struct Is_container : std::false_type
{
};
template <class T>
struct Is_container<T, std::void_t<typename T::allocator_type>> : std::true_type
{
};

/// Refuses temporary containers, whose deformed points would be lost.
template <class PointRange>
constexpr void check_is_kept()
{
  static_assert(std::is_lvalue_reference_v<PointRange> ||
                    !Is_container<std::decay_t<PointRange>>::value,
                "pcs::deform_point_set(): the points are a temporary container, whose deformed "
                "points would be lost; pass a variable");
}

/// Whether `T` is a range of `Deformation_handle`.
template <class T>
constexpr bool is_handle_range_v = Is_handle_range<T>::value;

/// The fraction of the progress at which the construction ends and the deformation begins.
constexpr double end_of_construction = 0.6;

/*!
  Runs one session for one edit: `edit(session)` adds and moves the handles. The progress covers
  construction and deformation.
*/
template <class ConcurrencyTag, class PointRange, class NamedParameters, class Edit>
Deformation_report deform_once(PointRange& points, const NamedParameters& np, const Edit& edit)
{
  const auto run = [&](const auto& parameters) {
    using Parameters = std::decay_t<decltype(parameters)>;
    Point_set_deformation<PointRange, Parameters, ConcurrencyTag> session(points, parameters);
    if (session.number_of_samples() > 0) // otherwise the construction was cancelled
      edit(session);
    return session;
  };
  if constexpr (is_given_v<NamedParameters, CGAL::internal_np::callback_t>) {
    std::function<bool(double)> user;
    read_callback(np, user);
    const auto progress = std::make_shared<Progress>(user);
    progress->stage(0, end_of_construction);
    const std::function<bool(double)> callback = [progress](double f) { return (*progress)(f); };
    auto session = run(np.callback(callback));
    progress->stage(end_of_construction, 1);
    return session.deform();
  } else
    return run(np).deform();
}

} // namespace internal

/*!
  \ingroup PkgPcsDeformationRef
  \brief moves `points` so that the handles reach their targets while neighbourhoods keep their
      shape.

  This is equivalent to one call of `deform()` of a `Point_set_deformation`; see there for the
  model, the named parameters, errors, cost and determinism.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \param points a model of `RandomAccessRange`, modified in place through `point_map`; it may be a
      temporary view such as `mesh.vertices()`
  \param handles range of `Deformation_handle`, at least one
  \param np named parameters of `Point_set_deformation`
  \return a `Deformation_report`: status, counts, energies, seconds per stage
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class PointRange,
          class HandleRange,
          class NamedParameters = parameters::Default_named_parameters>
Deformation_report deform_point_set(PointRange&& points,
                                    const HandleRange& handles,
                                    const NamedParameters& np = NamedParameters())
{
  internal::check_is_kept<PointRange&&>();
  constexpr bool is_ok = internal::is_handle_range_v<HandleRange>;
  static_assert(is_ok,
                "pcs::deform_point_set(): `handles` must be a range of pcs::Deformation_handle; "
                "ranges of fixed and moved points must be followed by a transformation");
  if constexpr (is_ok) {
    if (std::begin(handles) == std::end(handles))
      throw Invalid_input("pcs::deform_point_set(): there is no handle");
    return internal::deform_once<ConcurrencyTag>(points, np, [&](auto& session) {
      for (const Deformation_handle& h : handles) {
        const auto handle = session.add_handle(h.indices, h.softness);
        if (h.targets.empty())
          session.set_transformation(handle, h.transformation);
        else
          session.set_targets(handle, h.targets);
      }
    });
  } else
    return Deformation_report();
}

/*!
  \ingroup PkgPcsDeformationRef
  \brief deforms `points` with the `fixed` points at rest and the `moved` points transformed.

  Errors and cost are those of the first overload.

  \param points see the first overload
  \param fixed range of positions in `points`, or of its elements; may be empty
  \param moved range of positions in `points`, or of its elements
  \param transformation a `Similarity` (see `rotation()`, `translation()`, `scaling()`), or another
         transformation that `to_similarity()` converts
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class PointRange,
          class FixedRange,
          class MovedRange,
          class Transformation,
          class NamedParameters = parameters::Default_named_parameters>
Deformation_report deform_point_set(PointRange&& points,
                                    const FixedRange& fixed,
                                    const MovedRange& moved,
                                    const Transformation& transformation,
                                    const NamedParameters& np = NamedParameters())
{
  internal::check_is_kept<PointRange&&>();
  constexpr bool is_ok = is_similarity_like_v<Transformation>;
  static_assert(is_ok,
                "pcs::deform_point_set(): a transformation must be a pcs::Similarity, a "
                "CGAL::Aff_transformation_3, or a transformation or 4 x 4 matrix of Eigen");
  if constexpr (is_ok) {
    const Similarity motion = to_similarity(transformation);
    return internal::deform_once<ConcurrencyTag>(points, np, [&](auto& session) {
      if (std::begin(fixed) != std::end(fixed))
        session.add_handle(fixed);
      session.set_transformation(session.add_handle(moved), motion);
    });
  } else
    return Deformation_report();
}

} // namespace pcs

#endif // PCS_DEFORM_POINT_SET_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Interactive non-linear deformation of a point cloud by handles.

#ifndef PCS_POINT_SET_DEFORMATION_H
#define PCS_POINT_SET_DEFORMATION_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Deformation_options.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/deformation/Session.h>
#include <pcs/deformation/access/Handle_motion.h>
#include <pcs/deformation/access/Point_access.h>
#include <pcs/deformation/access/carry_points.h>
#include <pcs/deformation/access/check_session.h>
#include <pcs/deformation/access/read_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsDeformationRef
  \brief Interactive deformation of a point cloud by handles.

  The class implements chapter 2 of \cite aiteanu2022 (\cite adk2010). Local rotations and positions
  are computed for samples of the cloud, with matrices that are factorised once per set of handles.
  Every point is then moved by a blend of the affine maps of nearby samples. No mesh is needed.

  Results are computed on demand and reused. The constructor finds neighbours and samples. After a
  handle was added or removed, the next `deform()` (or `preprocess()`) factorises again, which takes
  milliseconds. Setting transformations costs nothing until `deform()`.

  \tparam PointRange a model of `RandomAccessRange`, to which the object keeps a reference. Points
          are read by the constructor and `accept()`, and written by `deform()`, `restore()` and
          `reset()`, all through the point map
  \tparam NamedParameters the type of a chain of named parameters that has the property maps given
          to the constructor; other parameters have no effect on the type. The default is for points
          without maps. Deduced from the arguments of the constructor
  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`. With a parallel tag, `put()` of the maps is called from
          several threads, for different elements

  \par Memory
  The object needs about 175 bytes per point with normals, 24 fewer with coordinates in single
  precision, and about 325 at the peak of the construction. If all points are samples, it needs
  750 to 1,500. After the first frames, `deform()` allocates nothing with at most 65,536 samples;
  with more, it frees part of its memory after each frame.

  \par Thread safety and determinism
  Different objects may be used concurrently, but each object only by one thread at a time. Results
  are bitwise identical for every number of threads and for the sequential tag.
*/
template <class PointRange,
          class NamedParameters = parameters::Default_named_parameters,
          class ConcurrencyTag = CGAL::Parallel_if_available_tag>
class Point_set_deformation
{
  using Access = deformation::Point_access<PointRange, NamedParameters>;
  using Session = deformation::Session<ConcurrencyTag>;
  using Motion = deformation::Handle_motion;

public:
  using Point_map = typename Access::Point_map;
  using Normal_map = typename Access::Normal_map;
  using Point = typename Access::Point;
  using Normal = typename Access::Normal;
  using Handle = std::size_t;

  /// See `snapshot()`.
  class Snapshot
  {
    friend class Point_set_deformation;
    deformation::Session_snapshot session;
    std::vector<Motion> motions;
  };

  /*!
    Reads the points, finds neighbours and samples. O(n log n).

    \param points points at two or more different positions [L]; must outlive this object
    \param np named parameters, listed below
    \npbegin
      \np{point_map} where a position is read and written
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a point type
        \npdefault `CGAL::Identity_property_map`
      \np{normal_map} where a normal is read and written; normals keep their length
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a vector type
        \npdefault none: normals are not deformed
      \np{vector_map} vectors `v`, such as tangents; the deformation gradient `G` maps them to `G v`
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a vector type
        \npdefault none
      \np{tensor_map} tensors `T`, such as covariances of splats; they are mapped to `G T G^T`
        \nptype the same, value: `Eigen::Matrix<FT, 3, 3>`
        \npdefault none
      \np{gradient_map} where the deformation gradient `G` of a point is written: the derivative of
        its new position with respect to its position at rest. Points that are not written keep
        the value that the map has.
        \nptype model of `WritablePropertyMap`, key: element of `points`, value:
            `Eigen::Matrix<FT, 3, 3>`
        \npdefault none
      \np{number_of_samples} number of samples for which the non-linear problem is solved, at most
        the number of points [count]
        \nptype integer, `> 0`
        \npdefault all points of a cloud with at most `largest_unsampled_size` points at different
            positions (20,000), otherwise `default_number_of_samples` (2000). The variants
            `Sample_search::breadth_first_hops` and `Sample_weights::inverse_square` blend samples,
            so their default is always 2000
      \np{number_of_neighbors} nearest neighbours to which a point is linked [count]
        \nptype integer, 2 to 60
        \npdefault `default_number_of_neighbors`
      \np{number_of_sample_neighbors} nearest samples whose maps are blended at a point [count]
        \nptype integer, 1 to 32
        \npdefault `default_number_of_sample_neighbors`
      \np{sample_search} how the nearest samples are found
        \nptype `Sample_search`
        \npdefault `Sample_search::regions`
      \np{sample_weights} how the nearest samples are weighted
        \nptype `Sample_weights`
        \npdefault `Sample_weights::compact`
      \np{rotation_field} how rotations are blended between handles
        \nptype `Rotation_field`
        \npdefault `Rotation_field::geodesic`
      \np{number_of_iterations} largest number of iterations of one `deform()` [count]
        \nptype integer, `>= 0`
        \npdefault `20`
      \np{tolerance} iterations end when the energy decreases by less than this fraction [-]
        \nptype floating point, `>= 0`
        \npdefault `0.05`
      \np{stiffness} bending stiffness relative to stretching stiffness [-]. Its effect does not
        depend on the number of points. With 2,000 samples or more, it does not depend on the number
        of samples either
        \nptype floating point, 0.001 to 1000
        \npdefault 1
      \np{poisson_ratio} transverse contraction relative to axial extension; 0.5: incompressible [-]
        \nptype floating point, -1 to 0.5
        \npdefault 0
      \np{do_preserve_volume} whether springs through the interior of closed surfaces preserve their
        volume. With more than 20,000 samples, only coarser levels have such springs, and finer
        levels are limited to one iteration.
        \nptype `bool`
        \npdefault `true`
      \np{region_of_interest} indices of the points that may move. All other points, and points that
        coincide with one of them, remain bitwise unchanged.
        \nptype range of integers, or of elements of `points` with `operator<`; copied unless it is
            passed by `std::cref()`
        \npdefault all points
      \np{callback} called on this thread with a value that grows from 0 to 1; `false` stops, and no
        point is written. The call with 1 comes before the points are written.
        \nptype `std::function<bool(double)>`
        \npdefault none
    \npend

    \throws Invalid_input if there are no points, a coordinate or normal is not finite, all points
            coincide, or a parameter is out of range
  */
  template <class GivenParameters = NamedParameters>
  explicit Point_set_deformation(PointRange& points, const GivenParameters& np = GivenParameters())
    : m_access(points, np)
  {
    if constexpr (Access::is_ok && Access::template has_maps_of<GivenParameters>()) {
      const char* function = "pcs::Point_set_deformation";
      const auto sampling = deformation::read_sampling_options(np, function);
      m_elastic = deformation::read_elastic_options(np, function);
      internal::read_callback(np, m_callback);
      auto coordinates = m_access.template points_of_session<ConcurrencyTag>(function);
      const auto region = deformation::read_region(np, [&](const auto& range) {
        return m_access.positions_of(range, coordinates.size(), function);
      });
      internal::Progress progress(m_callback);
      m_session = std::make_unique<Session>(std::move(coordinates),
                                            sampling,
                                            region ? &*region : nullptr,
                                            progress);
      if (m_session->is_ready())
        keep_attributes();
    }
  }

  /// A moved-from object permits only assignment, destruction and `number_of_samples()`; all other
  /// calls throw `Invalid_input`.
  Point_set_deformation(Point_set_deformation&&) = default;
  Point_set_deformation& operator=(Point_set_deformation&&) = default;

  /// \name Handles
  /// Handles are numbered from 0 in the order in which they were added; numbers are not reused, and
  /// `restore()` brings back the handles of a snapshot with their numbers.
  /// @{

  /*!
    Adds a handle, which remains at rest until a motion is set.
    \param indices the positions of its points in the range, or elements of the range, such as
           vertex descriptors with `operator<`; in any order, not necessarily connected
    \param softness 0: its points reach their targets exactly. Otherwise springs pull them to their
           targets, with the stiffness of the edges of a point divided by this value. [-]
    \throws Invalid_input if `indices` is empty, an element is not one of the range, or an index is
            out of range, belongs to another handle, or lies outside the region of interest. Nothing
            is changed then.
  */
  template <class IndexRange>
  Handle add_handle(const IndexRange& indices, double softness = 0)
  {
    const char* function = "pcs::Point_set_deformation::add_handle()";
    deformation::check_ready(m_session, function);
    deformation::check_softness(softness, function);
    const auto checked = m_access.positions_of(indices, m_session->number_of_points(), function);
    const Handle handle = m_session->add_handle(checked, softness > 0 ? 1 / softness : 0, function);
    m_motion.resize(handle + 1);
    return handle;
  }

  /// Frees the points of a handle. \throws Invalid_input if there is no such handle
  void remove_handle(Handle handle)
  {
    deformation::check_handle(m_session, handle, "pcs::Point_set_deformation::remove_handle()");
    m_session->remove_handle(handle);
    m_motion[handle] = Motion();
  }

  /// Sets the rotation from rest by `angle` [rad], of any size, about `axis` through `center`.
  template <class Vector_3, class Point_3>
  void set_rotation(Handle handle, const Vector_3& axis, double angle, const Point_3& center)
  {
    change_motion(handle, "pcs::Point_set_deformation::set_rotation()", [&](Motion& m) {
      m.rotation = rotation(axis, angle, center);
    });
  }

  /// Sets the rotation from rest by `angle` [rad] about the centroid of the handle at rest.
  template <class Vector_3>
  void set_rotation(Handle handle, const Vector_3& axis, double angle)
  {
    set_rotation(handle, axis, angle, centroid(handle));
  }

  /// Sets the translation by `offset` [L] from rest; it is applied after the rotation.
  template <class Vector_3>
  void set_translation(Handle handle, const Vector_3& offset)
  {
    change_motion(handle, "pcs::Point_set_deformation::set_translation()", [&](Motion& m) {
      m.translation = translation(offset);
    });
  }

  /// Sets the scale `factor` > 0 about the centroid of the handle at rest; it is applied before the
  /// rotation. Between handles of different scale, the thickness is interpolated, and lengths
  /// change as far as the positions of the handles permit.
  void set_scale(Handle handle, double factor)
  {
    change_motion(handle, "pcs::Point_set_deformation::set_scale()", [&](Motion& m) {
      m.scale = scaling(factor, centroid(handle));
    });
  }

  /// Sets the whole motion from rest to a `Similarity`, or to another transformation that
  /// `to_similarity()` converts. It replaces the rotation, and `set_rotation()` replaces it. A
  /// translation that is set later is applied after it, a scale before it.
  template <class Transformation>
  void set_transformation(Handle handle, const Transformation& transformation)
  {
    static_assert(is_similarity_like_v<Transformation>,
                  "pcs: a transformation must be a pcs::Similarity, a CGAL::Aff_transformation_3, "
                  "or a transformation or 4 x 4 matrix of Eigen");
    if constexpr (is_similarity_like_v<Transformation>)
      change_motion(handle, "pcs::Point_set_deformation::set_transformation()", [&](Motion& m) {
        m = {Similarity(), to_similarity(transformation), Similarity()};
      });
  }

  /*!
    Sets one target position for each point of the handle. The motion of the handle becomes the
    rigid motion with the least sum of squared distances to the targets, by at most 180 degrees. The
    targets may stretch and bend the handle in any way.

    | handle | result |
    |---|---|
    | exact | its points reach their targets with all bits of double precision, their normals and
      gradients are those of a linear map that is fitted to the targets around them, and the points
      around the handle follow |
    | soft | springs pull its points to the targets. In the region of a sample, they pull to the
      mean of the differences between the targets and the rigid motion |

    If the points do not determine the rigid motion, it is the one with the smallest rotation: one
    point translates the handle, and collinear points do not turn it about their line. The scale of
    the motion is 1. The next call that sets a motion, a rotation, a translation, a scale or targets
    of the handle replaces the targets; so do `reset()` and `accept()`. A rotation, translation or
    scale replaces one part of the rigid motion and keeps the others.

    Nothing is factorised. The call is O(points of the handle). Each `deform()` then needs about
    2.5 microseconds and 230 bytes more for each point of the handle (200,000 of a million points).

    \param targets a range of points or vectors, in the order of the points in `add_handle()` [L]
    \throws Invalid_input if there is no such handle, the number of targets is not that of the
            points, a target is not finite or too far away, or two points of the handle are at the
            same place and have different targets. Nothing is changed then.
  */
  template <class TargetRange>
  void set_targets(Handle handle, const TargetRange& targets)
  {
    const char* function = "pcs::Point_set_deformation::set_targets()";
    deformation::check_handle(m_session, handle, function);
    m_session->set_targets(handle, deformation::read_targets(targets), function);
    m_motion[handle] = {Similarity(), m_session->transform(handle), Similarity()};
  }

  /// The whole motion from rest: scale, then rotation, then translation.
  const Similarity& transformation(Handle handle) const
  {
    deformation::check_handle(m_session, handle, "pcs::Point_set_deformation::transformation()");
    return m_session->transform(handle);
  }

  /// Centroid of the points of the handle at rest.
  Point centroid(Handle handle) const
  {
    deformation::check_handle(m_session, handle, "pcs::Point_set_deformation::centroid()");
    return Access::template make<Point>(m_session->centroid(handle));
  }

  /// @}
  /// \name Deformation
  /// @{

  /// Factorises now instead of in the next `deform()`. Returns `false` if a matrix is singular, or
  /// if the callback returned `false`; the next `deform()` then factorises again.
  bool preprocess()
  {
    deformation::check_ready(m_session, "pcs::Point_set_deformation::preprocess()");
    internal::Progress progress(m_callback);
    return m_session->constrain(m_elastic.stiffness, progress) == Status::converged;
  }

  /*!
    Solves for the current motions of the handles, from rest, and writes points and normals. Points
    that are not connected to a handle, points outside the region of interest, and points of handles
    that have not moved are not written. Nothing is written if the status of the report is
    `cancelled` or `numerical_failure`. If `put()` of a map throws, the exception passes through,
    and some points are written already; the next `deform()`, `restore()` or `reset()` writes all.

    \param start `Solver_start::cold`: the result depends on the rest shape and the motions only.
           `Solver_start::warm`, for the frames of a drag: one to three iterations that continue
           from the last result suffice.

    In tests, a warm start gave at most 10 % more energy than a cold start, and only a quarter of
    the energy of cold starts that had ended early. The start is always cold after a large step,
    after a change of handles or a restored snapshot, and for more than 20,000 samples with interior
    springs.
  */
  Deformation_report deform(Solver_start start = Solver_start::cold)
  {
    const char* function = "pcs::Point_set_deformation::deform()";
    deformation::check_session(m_session, function);
    if (!m_session->is_ready())
      return m_session->report();
    deformation::check_number_of_points(m_session, m_access.size(), function);
    internal::Progress progress(m_callback);
    const Status status = m_session->solve(m_elastic, start, progress);
    if (status != Status::cancelled && status != Status::numerical_failure) {
      m_shape_motions = m_motion;
      write_points();
    }
    return m_session->report();
  }

  /*!
    Moves other points and their normals as the last `deform()` moved the points around them. This
    deforms clouds that do not fit into memory: a subset is deformed first, then all points, chunk
    by chunk. A point moves rigidly if its nearest point of this object belongs to a handle, and
    remains unchanged if that point did not move. Otherwise the maps of nearby samples are blended
    as for points of this object; if all points are samples, their maps are interpolated. Points of
    this object obtain the same result up to rounding with `Sample_search::regions`, unless a shape
    was accepted. O(n log n) once per rest shape, then O(log n) per point.

    \param points a model of `RandomAccessRange` at rest, modified in place
    \param np `point_map`, `normal_map` and `gradient_map` as in the constructor, for `points`
    \throws Invalid_input if a point or normal is not finite, or if the matrices were factorised for
            other handles since the last `deform()`; nothing is changed then
  */
  template <class OtherRange, class OtherParameters = parameters::Default_named_parameters>
  void apply(OtherRange& points, const OtherParameters& np = OtherParameters())
  {
    const char* function = "pcs::Point_set_deformation::apply()";
    deformation::check_ready(m_session, function);
    deformation::carry_points<ConcurrencyTag>(*m_session, points, np, function);
  }

  /// Returns the deformation gradient of a point in the current shape: the derivative of its
  /// position with respect to its position at rest, as `gradient_map` receives it. Nothing is
  /// written. O(1), about the time of eight points of `deform()`. [-]
  /// \param i the position of the point in the range
  /// \throws Invalid_input if there is no such point, or if the matrices were factorised for other
  ///         handles since the last `deform()`
  Eigen::Matrix3d deformation_gradient(std::size_t i) const
  {
    check_gradient(i, "pcs::Point_set_deformation::deformation_gradient()");
    return m_session->gradient(i);
  }

  /// Returns the local rotation of a point from rest: the rotation nearest to its deformation
  /// gradient (polar decomposition), or the identity if the determinant of the gradient is not
  /// positive. O(1). Throws like `deformation_gradient()`. [-]
  Eigen::Matrix3d local_rotation(std::size_t i) const
  {
    check_gradient(i, "pcs::Point_set_deformation::local_rotation()");
    return m_session->local_rotation(i);
  }

  /// Returns the affine map of a point in the current shape. Its linear part is
  /// `deformation_gradient(i)`, and it maps the position at rest to the position in the range.
  /// O(1). Throws like `deformation_gradient()`.
  Eigen::Affine3d local_map(std::size_t i) const
  {
    const char* function = "pcs::Point_set_deformation::local_map()";
    check_gradient(i, function);
    deformation::check_number_of_points(m_session, m_access.size(), function);
    Eigen::Affine3d map = Eigen::Affine3d::Identity();
    map.linear() = m_session->gradient(i);
    if constexpr (Access::is_ok)
      map.translation() = m_access.point(i) - map.linear() * m_session->rest_position(i);
    return map;
  }

  /*!
    Returns the parts of the energy that belong to the samples: where the body is strained.
    Their sum is `Deformation_report::energy`, unless a handle has targets. For display, the value
    of sample `k` belongs to the point `point_of_sample(k)`. O(samples).
    \return `number_of_samples()` values; zero at rest [L^2]
    \throws Invalid_input if the current shape is not the result of the last `deform()`: after
            `restore()`, or if handles were added or removed since then
  */
  std::vector<double> energies_of_samples() const
  {
    const char* function = "pcs::Point_set_deformation::energies_of_samples()";
    deformation::check_ready(m_session, function);
    internal::check(m_session->has_energies(),
                    function,
                    "the shape is not the result of the last deform(); call it first");
    std::vector<double> energies(m_session->number_of_samples());
    for (std::size_t k = 0; k < energies.size(); ++k)
      energies[k] = m_session->energy_of_sample(k);
    return energies;
  }

  /// Returns the position in the range of the point at sample `k`.
  /// \throws Invalid_input if there is no such sample
  std::size_t point_of_sample(std::size_t k) const
  {
    const char* function = "pcs::Point_set_deformation::point_of_sample()";
    deformation::check_ready(m_session, function);
    internal::check(k < m_session->number_of_samples(), function, "there is no such sample");
    return m_session->point_of_sample(k);
  }

  /// Returns the current shape, its handles and their motions. The snapshot stores data of the
  /// samples, and shares the lists of the points of handles with this object.
  /// \throws Invalid_input if handles were added or removed since the last `deform()`
  Snapshot snapshot() const
  {
    const char* function = "pcs::Point_set_deformation::snapshot()";
    deformation::check_ready(m_session, function);
    internal::check(m_session->has_shape_of_handles(),
                    function,
                    "handles were added or removed since the last deform(); call it first");
    Snapshot result;
    result.session = m_session->snapshot();
    result.motions = m_shape_motions;
    return result;
  }

  /*!
    Restores the points, handles and motions of a snapshot. All points have the bits that they had
    when it was taken, and the next cold `deform()` has the same result as it had then. Handles that
    were removed since then exist again, with their numbers, and those that were added since then do
    not. Their numbers are given to no other handle, and become valid again if a later snapshot with
    these handles is restored.

    If the handles differ from those of the last factorisation, the matrices are factorised again,
    as by `preprocess()`; otherwise the cost is that of writing the points.
    \throws Invalid_input unless the snapshot was taken from this object with the same rest shape;
            nothing is changed then
  */
  void restore(const Snapshot& snapshot)
  {
    const char* function = "pcs::Point_set_deformation::restore()";
    check_points(function);
    internal::check(m_session->is_of_rest_shape(snapshot.session),
                    function,
                    "the snapshot is of another object, or was taken before accept() of this one; "
                    "restore a snapshot that was taken from this object after accept()");
    m_session->restore(snapshot.session);
    m_motion = snapshot.motions;
    m_motion.resize(m_session->number_of_handles()); // those added in the rest shape are at rest
    m_shape_motions = m_motion;
    write_points();
  }

  /// Restores the rest shape, with all bits of its positions; handles remain, and their motions are
  /// reset.
  void reset()
  {
    check_points("pcs::Point_set_deformation::reset()");
    m_session->reset();
    end_motions();
    write_points();
  }

  /// Makes the current shape, as read through the point map, the rest shape. Motions are reset,
  /// handles and samples remain, and the next `deform()` factorises again. \throws Invalid_input if
  /// a point, normal, vector or tensor is not finite; nothing is changed then
  void accept()
  {
    const char* function = "pcs::Point_set_deformation::accept()";
    check_points(function);
    if constexpr (Access::is_ok) {
      const auto present = m_access.template points_of_session<ConcurrencyTag>(function);
      m_session->accept([&](std::size_t i) { return present[i]; });
      keep_attributes();
    }
    end_motions();
  }

  /// @}

  std::size_t number_of_samples() const { return m_session ? m_session->number_of_samples() : 0; }

private:
  /// Calls `change(motion)` for the motion of a handle; nothing is changed if it throws.
  template <class Change>
  void change_motion(Handle handle, const char* function, const Change& change)
  {
    deformation::check_handle(m_session, handle, function);
    Motion motion = m_motion[handle];
    change(motion);
    m_session->set_transform(handle, motion.whole());
    m_motion[handle] = motion;
  }

  void check_gradient(std::size_t i, const char* function) const
  {
    deformation::check_ready(m_session, function);
    deformation::check_point(m_session, i, function);
    internal::check(!m_session->is_ahead_of_shape(),
                    function,
                    "handles were added or removed since the last deform(); call it first");
  }

  void check_points(const char* function) const
  {
    deformation::check_ready(m_session, function);
    deformation::check_number_of_points(m_session, m_access.size(), function);
  }

  void end_motions()
  {
    m_motion.assign(m_motion.size(), Motion());
    m_shape_motions = m_motion;
  }

  /// Stores the normals, vectors and tensors of the rest shape.
  void keep_attributes()
  {
    if constexpr (Access::has_normals)
      m_session->set_normals([this](std::size_t i) { return m_access.normal(i); });
    m_access.keep_rest_attributes();
  }

  void write_points()
  {
    if constexpr (Access::is_ok)
      m_session->template write<Access::has_gradients>(m_access);
  }

  Access m_access;
  deformation::Elastic_options m_elastic;
  std::function<bool(double)> m_callback;
  std::unique_ptr<Session> m_session;
  std::vector<Motion> m_motion, m_shape_motions; ///< as set, and of the current shape
};

template <class PointRange>
Point_set_deformation(PointRange&) -> Point_set_deformation<PointRange>;
template <class PointRange, class NamedParameters>
Point_set_deformation(PointRange&, const NamedParameters&)
    -> Point_set_deformation<PointRange, deformation::Map_parameters<NamedParameters>>;

} // namespace pcs

#endif // PCS_POINT_SET_DEFORMATION_H

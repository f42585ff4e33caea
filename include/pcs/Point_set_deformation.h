// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A session of non-linear deformation of a point cloud: handles come and go, the sampling and the factors stay.

#ifndef PCS_POINT_SET_DEFORMATION_H
#define PCS_POINT_SET_DEFORMATION_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>
#include <pcs/deformation/Session.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/internal/text.h>

#include <CGAL/number_utils.h>
#include <CGAL/property_map.h>

#include <boost/concept_check.hpp>
#include <boost/property_map/property_map.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsDeformationRef
//! samples on which the non-linear problem is solved, unless the caller says otherwise [count]
constexpr std::size_t default_number_of_samples = 2000;
//! \ingroup PkgPcsDeformationRef
//! nearest neighbours that a point is linked to; the dissertation's 5 to 6 [count]
constexpr std::size_t default_number_of_neighbors = 6;
//! \ingroup PkgPcsDeformationRef
//! nearest samples that move a point [count]
constexpr std::size_t default_number_of_sample_neighbors = 6;

namespace internal {

struct No_map
{
};

/// The types that a point range and a chain of named parameters stand for.
template <class PointRange, class NamedParameters>
struct Deformation_types
{
  using Element = Element_reference<PointRange>;
  using Value = std::decay_t<Element>;
  using Point_map =
      std::decay_t<decltype(choose(std::declval<const NamedParameters&>(),
                                   CGAL::internal_np::point_map,
                                   std::declval<CGAL::Identity_property_map<Value>>()))>;
  using Normal_map = std::decay_t<decltype(choose(std::declval<const NamedParameters&>(),
                                                  CGAL::internal_np::normal_map,
                                                  std::declval<No_map>()))>;
  using Point = pcs::Map_value<Point_map>;
  using Normal =
      std::conditional_t<std::is_same_v<Normal_map, No_map>, Point, pcs::Map_value<Normal_map>>;
  static constexpr bool has_normals = !std::is_same_v<Normal_map, No_map>;
  using Vector_map = std::decay_t<decltype(choose(std::declval<const NamedParameters&>(),
                                                  internal_np::vector_map,
                                                  std::declval<No_map>()))>;
  using Tensor_map = std::decay_t<decltype(choose(std::declval<const NamedParameters&>(),
                                                  internal_np::tensor_map,
                                                  std::declval<No_map>()))>;
  static constexpr bool has_vectors = !std::is_same_v<Vector_map, No_map>;
  static constexpr bool has_tensors = !std::is_same_v<Tensor_map, No_map>;
};

template <class Value>
Value checked(const char* function, const char* name, Value value, bool is_valid, const char* rule)
{
  if (!is_valid)
    throw Invalid_input(std::string(function) + ": " + name + " is " + std::to_string(value) +
                        "; it must be " + rule);
  return value;
}

/// Reads a count that may have been given as any integer type; negative ones must not wrap around.
template <class NamedParameters, class Tag>
std::size_t count_parameter(const char* function,
                            const char* name,
                            const NamedParameters& np,
                            Tag tag,
                            std::size_t fallback,
                            std::size_t lowest,
                            std::size_t highest)
{
  const auto value = choose(np, tag, fallback);
  static_assert(std::is_integral_v<std::decay_t<decltype(value)>>,
                "pcs: number_of_samples, number_of_neighbors, number_of_sample_neighbors and "
                "number_of_iterations must be integers");
  const bool is_valid = !(value < 0) && static_cast<std::size_t>(value) >= lowest &&
                        static_cast<std::size_t>(value) <= highest;
  const std::string rule = "between " + std::to_string(lowest) + " and " + std::to_string(highest);
  return static_cast<std::size_t>(checked(function, name, value, is_valid, rule.c_str()));
}

/// Indices as 32 bit numbers, each checked against the number of points.
template <class IndexRange>
std::vector<std::uint32_t>
checked_indices(const char* function, const IndexRange& indices, std::size_t n)
{
  static_assert(is_index_range_v<IndexRange>,
                "pcs: a handle or a region of interest must be a range of integers, the numbers of "
                "its points");
  std::vector<std::uint32_t> result;
  if constexpr (is_index_range_v<IndexRange>)
    for (const auto& i : indices) {
      if (i < 0 || static_cast<std::size_t>(i) >= n)
        throw Invalid_input(std::string(function) + ": index " + std::to_string(i) +
                            " is out of range; there are " + std::to_string(n) + " points");
      result.push_back(static_cast<std::uint32_t>(i));
    }
  return result;
}

} // namespace internal

/*!
  \ingroup PkgPcsDeformationRef
  \brief deforms a point cloud again and again while handles are dragged.

  Implements chapter 2 of \cite aiteanu2022 (\cite adk2010): local rotations and positions are solved on samples of the
  cloud with matrices that are factorised once per set of handles, and carried to all points by blended affine maps.
  Neighbours come from the points alone; no mesh is needed.

  Work is done as late as possible and never twice: the constructor finds neighbours and samples; adding or removing a
  handle makes the next `deform()` (or `preprocess()`) factorise again, which takes milliseconds; setting
  transformations costs nothing until `deform()`.

  \tparam PointRange a model of `RandomAccessRange`. The points stay the caller's: the class keeps a reference, writes
          through the point map in `deform()`, `restore()` and `reset()`, and reads it again only in `accept()`
  \tparam NamedParameters the type of the chain given to the constructor (deduced)
  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or `CGAL::Parallel_if_available_tag`. With a
          parallel tag, `put()` of the maps is called from several threads, for different elements

  \par Memory
  About 150 bytes per point with normals, and some 300 at the peak of the construction.

  \par Thread safety
  Different objects may be used at the same time. One object may be used by one thread at a time.

  \par Determinism
  Same bits for every number of threads and for the sequential tag.
*/
template <class PointRange,
          class NamedParameters = parameters::Default_named_parameters,
          class ConcurrencyTag = CGAL::Parallel_if_available_tag>
class Point_set_deformation
{
  using Types = internal::Deformation_types<PointRange, NamedParameters>;

public:
  using Point_map = typename Types::Point_map;
  using Normal_map = typename Types::Normal_map;
  using Point = typename Types::Point;
  using Normal = typename Types::Normal;
  using Handle = std::size_t;
  using Snapshot = deformation::Session_snapshot;

private:
  static constexpr bool is_range_ok = is_random_access_range_v<PointRange>;
  static_assert(is_range_ok,
                "pcs::Point_set_deformation: the points must be a random access range, for example "
                "a std::vector");
  static constexpr bool is_point_ok = is_point_or_vector_v<Point>;
  static_assert(is_point_ok,
                "pcs::Point_set_deformation: `point_map` must be a property map that stores points "
                "with x(), y(), "
                "z() and a constructor from three coordinates, like Kernel::Point_3");
  static constexpr bool is_point_map_ok =
      is_read_write_map_v<Point_map, typename Types::Element, Point>;
  static_assert(!is_point_ok || is_point_map_ok,
                "pcs::Point_set_deformation: named parameter `point_map` must be readable and "
                "writable and accept "
                "an element of `points` as key");
  static constexpr bool is_normal_map_ok =
      !Types::has_normals || (is_point_or_vector_v<Normal> &&
                              is_read_write_map_v<Normal_map, typename Types::Element, Normal>);
  static_assert(is_normal_map_ok,
                "pcs::Point_set_deformation: named parameter `normal_map` must be readable and "
                "writable, accept an "
                "element of `points` as key, and store vectors like Kernel::Vector_3");
  static constexpr bool is_vector_map_ok =
      !Types::has_vectors || (is_point_or_vector_v<Map_value<typename Types::Vector_map>> &&
                              is_read_write_map_v<typename Types::Vector_map,
                                                  typename Types::Element,
                                                  Map_value<typename Types::Vector_map>>);
  static_assert(is_vector_map_ok,
                "pcs::Point_set_deformation: named parameter `vector_map` must be readable and "
                "writable, accept an element of `points` as key, and store vectors like "
                "Kernel::Vector_3");
  static constexpr bool is_tensor_map_ok =
      !Types::has_tensors || (is_matrix_3_v<Map_value<typename Types::Tensor_map>> &&
                              is_read_write_map_v<typename Types::Tensor_map,
                                                  typename Types::Element,
                                                  Map_value<typename Types::Tensor_map>>);
  static_assert(
      is_tensor_map_ok,
      "pcs::Point_set_deformation: named parameter `tensor_map` must be readable and "
      "writable, accept an element of `points` as key, and store 3 x 3 matrices of Eigen");
  static constexpr bool has_gradients = Types::has_vectors || Types::has_tensors;
  static constexpr bool is_ok = is_vector_map_ok && is_tensor_map_ok && is_range_ok &&
                                is_point_ok && is_point_map_ok && is_normal_map_ok;

public:
  /*!
    Reads the points, finds neighbours and samples. O(n log n).

    \param points at least one place different from the others; must outlive this object
    \param np
    \npbegin
      \np{point_map} where a position is read and written
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a point type
        \npdefault `CGAL::Identity_property_map`
      \np{normal_map} where a normal is read and written; normals keep their length
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a vector type
        \npdefault none: normals are not deformed
      \np{vector_map} vectors that are carried by the local deformation `G`: `G v`, like tangents
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a vector type
        \npdefault none
      \np{tensor_map} tensors that are carried by it: `G T G^T`, like the covariances of splats
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: `Eigen::Matrix<FT, 3, 3>`
        \npdefault none
      \np{number_of_samples} nodes of the non-linear problem [count]; as many as points, or more: no sampling
        \nptype integer, `> 0`
        \npdefault `default_number_of_samples`
      \np{number_of_neighbors} nearest neighbours that a point is linked to [count]
        \nptype integer, 2 to 60
        \npdefault `default_number_of_neighbors`
      \np{number_of_sample_neighbors} nearest samples that move a point [count]
        \nptype integer, 1 to 32
        \npdefault `default_number_of_sample_neighbors`
      \np{sample_search} how these are found
        \nptype `Sample_search`
        \npdefault `Sample_search::regions`
      \np{sample_weights} how they are weighted
        \nptype `Sample_weights`
        \npdefault `Sample_weights::compact`
      \np{rotation_field} how rotations are blended between handles
        \nptype `Rotation_field`
        \npdefault `Rotation_field::geodesic`
      \np{number_of_iterations} largest number of passes of one `deform()` [count]
        \nptype integer, `>= 0`
        \npdefault `deformation::default_maximal_number_of_passes`
      \np{tolerance} passes end when the energy falls by less than this share [-]
        \nptype floating point, `>= 0`
        \npdefault `deformation::default_tolerance`
      \np{stiffness} resistance against bending relative to stretching; the same for any number of points, and of
        samples from 2,000 on [-]
        \nptype floating point, 0.001 to 1000
        \npdefault 1
      \np{poisson_ratio} transverse contraction under stretch [-]: 0.5 like rubber, 0 like cork, negative auxetic
        \nptype floating point, -1 to 0.5
        \npdefault 0
      \np{do_preserve_volume} whether closed surfaces get springs through their inside; with more than 20,000 samples
          only their coarser levels do, and the finer ones make a single pass from there
        \nptype `bool`
        \npdefault `true`
      \np{region_of_interest} numbers of the points that may move; all others stay bit for bit
        \nptype range of integers (copied; use `std::cref` for large ones)
        \npdefault all points
      \np{callback} called on this thread with a value that grows from 0 to 1; `false` stops
        \nptype `std::function<bool(double)>`
        \npdefault none
    \npend

    \throws Invalid_input if there are no points, a coordinate or normal is not finite, all points coincide, or a
            parameter is out of range
  */
  explicit Point_set_deformation(PointRange& points, const NamedParameters& np = NamedParameters())
    : m_points(&points)
  {
    if constexpr (is_ok) {
      read_parameters(np);
      std::vector<deformation::Vec3> coordinates = read_points();
      std::vector<std::uint32_t> region;
      constexpr bool has_region =
          internal::is_given_v<NamedParameters, internal_np::region_of_interest_t>;
      if constexpr (has_region) {
        const auto& given =
            CGAL::parameters::get_parameter_reference(np, internal_np::region_of_interest);
        region = internal::checked_indices("pcs::Point_set_deformation", given, coordinates.size());
      }
      check_normals();
      internal::Progress progress(m_callback);
      m_session = std::make_unique<Session>(std::move(coordinates),
                                            m_sampling,
                                            has_region ? &region : nullptr,
                                            progress);
      if (m_session->is_ready())
        read_attributes();
    }
  }

  Point_set_deformation(Point_set_deformation&&) = default;
  Point_set_deformation& operator=(Point_set_deformation&&) = default;

  /// \name Handles
  /// Handles are numbered from 0 in the order in which they were added; numbers are not used again.
  /// @{

  /*!
    Adds a handle, which stays where it is until told otherwise.
    \param indices the numbers of its points, in any order, not necessarily connected
    \param softness 0: its points reach their targets exactly; otherwise they are drawn to them by springs, the weaker
           the larger the value (1: as strong as the neighbours of a point) [-]
    \throws Invalid_input if there is no index, one is out of range, belongs to another handle, or lies outside the
            region of interest; nothing is changed then
  */
  template <class IndexRange>
  Handle add_handle(const IndexRange& indices, double softness = 0)
  {
    const char* function = "pcs::Point_set_deformation::add_handle()";
    require_ready(function);
    internal::checked(function,
                      "softness",
                      softness,
                      softness >= 0 && std::isfinite(softness),
                      "finite and not negative");
    const auto checked =
        internal::checked_indices(function, indices, m_session->number_of_points());
    const Handle handle = m_session->add_handle(checked, softness > 0 ? 1 / softness : 0, function);
    m_motion.emplace_back();
    return handle;
  }

  /// Frees the points of a handle. \throws Invalid_input if there is no such handle
  void remove_handle(Handle handle)
  {
    require_handle("pcs::Point_set_deformation::remove_handle()", handle);
    m_session->remove_handle(handle);
    m_motion[handle] = Motion();
  }

  /// Sets the rotation by `angle` [rad] about `axis` through `center`, from rest. Any number of turns.
  template <class Vector_3, class Point_3>
  void set_rotation(Handle handle, const Vector_3& axis, double angle, const Point_3& center)
  {
    require_handle("pcs::Point_set_deformation::set_rotation()", handle);
    Motion motion = m_motion[handle];
    motion.rotation = rotation(axis, angle, center);
    set_motion(handle, motion);
  }

  /// The same about the centroid of the handle at rest.
  template <class Vector_3>
  void set_rotation(Handle handle, const Vector_3& axis, double angle)
  {
    set_rotation(handle, axis, angle, centroid(handle));
  }

  /// Sets the translation by `offset` [L], from rest; it follows the rotation.
  template <class Vector_3>
  void set_translation(Handle handle, const Vector_3& offset)
  {
    require_handle("pcs::Point_set_deformation::set_translation()", handle);
    Motion motion = m_motion[handle];
    motion.translation = translation(offset);
    set_motion(handle, motion);
  }

  /// Sets the scale `factor` > 0 about the centroid of the handle at rest; it precedes the rotation.
  void set_scale(Handle handle, double factor)
  {
    require_handle("pcs::Point_set_deformation::set_scale()", handle);
    Motion motion = m_motion[handle];
    motion.scale = scaling(factor, centroid(handle));
    set_motion(handle, motion);
  }

  /// Sets the whole motion from rest: a `Similarity`, or a `CGAL::Aff_transformation_3` that is one.
  template <class Transformation>
  void set_transformation(Handle handle, const Transformation& transformation)
  {
    require_handle("pcs::Point_set_deformation::set_transformation()", handle);
    Motion motion;
    motion.rotation = to_similarity(transformation);
    set_motion(handle, motion);
  }

  /// The whole motion from rest: scale, then rotation, then translation.
  const Similarity& transformation(Handle handle) const
  {
    require_handle("pcs::Point_set_deformation::transformation()", handle);
    return m_session->transform(handle);
  }

  /// Centroid of the points of the handle at rest.
  Point centroid(Handle handle) const
  {
    require_handle("pcs::Point_set_deformation::centroid()", handle);
    return make<Point>(m_session->centroid(handle));
  }

  /// @}
  /// \name Deformation
  /// @{

  /// Factorises now instead of in the next `deform()`. Returns `false` if a matrix is singular.
  bool preprocess()
  {
    require_ready("pcs::Point_set_deformation::preprocess()");
    return m_session->constrain(m_elastic.stiffness);
  }

  /*!
    Solves for the present motions of the handles, from rest, and writes points and normals. Points that no handle
    reaches, those outside the region of interest, and those of handles that have not moved are not written.

    If the report says `cancelled` or `numerical_failure`, nothing was written.

    \param start `Start::cold`: the result depends on the rest shape and the motions only, not on what was done before.
    `Start::warm`: for the frames of a drag. The passes go on from the last result, so that one to three are enough; the
    energy was at most a tenth above that of cold starts, and a quarter of it where these end early. A large step, new
    handles, a snapshot that was restored, and full resolution of more than 20,000 points with interior springs begin
    cold in any case.
  */
  Deformation_report deform(Start start = Start::cold)
  {
    if (!m_session || !m_session->is_ready()) {
      Deformation_report report;
      report.status = Status::cancelled;
      return report;
    }
    internal::Progress progress(m_callback);
    const Deformation_report report = m_session->solve(m_elastic, start, progress);
    if (report.status == Status::cancelled || report.status == Status::numerical_failure)
      return report;
    write_points();
    progress.finish();
    return m_session->report();
  }

  /*!
    Moves other points, and their normals, as the last `deform()` moved the points around them: a cloud that does not fit
    into memory is deformed through a sample of it, then chunk by chunk. Each point follows its nearest point of this
    object: rigidly if that is in a handle, not at all if that stays; between them it is blended from the samples like
    a point of this object (the same to rounding if it is one).

    \param points a model of `RandomAccessRange` at rest, modified in place
    \param np `point_map` and `normal_map` as in the constructor, for `points`
    \throws Invalid_input if a point or normal is not finite; nothing is changed then
    \par Complexity
    O(n log n) once per rest shape, then O(log n) per point.
  */
  template <class OtherRange, class OtherParameters = parameters::Default_named_parameters>
  void apply(OtherRange& points, const OtherParameters& np = OtherParameters())
  {
    require_ready("pcs::Point_set_deformation::apply()");
    using Other = Point_set_deformation<OtherRange, OtherParameters, ConcurrencyTag>;
    if constexpr (Other::is_ok) {
      Other other(points, np, typename Other::Access_only());
      m_session->prepare_carrying();
      internal::for_each_index<ConcurrencyTag>(
          other.size(),
          [&](std::size_t i) {
            deformation::Vec3 p = other.point_of(i), normal = other.normal_of(i);
            const deformation::Vec3 before = p;
            m_session->carry(p, normal);
            if (p != before)
              other.write(i, p, normal, Eigen::Matrix3d::Identity());
          },
          256);
    }
  }

  /// The present state, at the cost of the samples only.
  Snapshot snapshot() const
  {
    require_ready("pcs::Point_set_deformation::snapshot()");
    return m_session->snapshot();
  }

  /// Brings back the points of a snapshot of this object, taken with the same handles, and the motions.
  void restore(const Snapshot& snapshot)
  {
    require_ready("pcs::Point_set_deformation::restore()");
    if (snapshot.maps.size() != m_session->number_of_samples())
      throw Invalid_input(
          "pcs::Point_set_deformation::restore(): the snapshot is of another point set");
    m_session->restore(snapshot);
    for (Handle h = 0; h < m_motion.size(); ++h) {
      m_motion[h] = Motion();
      m_motion[h].rotation = m_session->transform(h);
    }
    write_points();
  }

  /// Back to the rest shape; handles stay, their motions end.
  void reset()
  {
    require_ready("pcs::Point_set_deformation::reset()");
    m_session->reset();
    m_motion.assign(m_motion.size(), Motion());
    write_points();
  }

  /// The present shape, as the point map gives it, becomes the rest shape; motions end, handles, samples and factors
  /// stay.
  void accept()
  {
    require_ready("pcs::Point_set_deformation::accept()");
    if constexpr (is_ok) {
      const std::vector<deformation::Vec3> present = read_points();
      m_session->accept([&](std::size_t i) { return present[i]; });
      read_attributes();
    }
    m_motion.assign(m_motion.size(), Motion());
  }

  /// @}

  std::size_t number_of_samples() const { return m_session ? m_session->number_of_samples() : 0; }

private:
  template <class, class, class>
  friend class Point_set_deformation;

  using Session = deformation::Session<ConcurrencyTag>;

  /// Reads and writes points without a session.
  struct Access_only
  {
  };
  Point_set_deformation(PointRange& points, const NamedParameters& np, Access_only)
    : m_points(&points)
  {
    static_assert(!has_gradients,
                  "pcs::Point_set_deformation::apply(): `vector_map` and `tensor_map` are for the "
                  "points of the object itself");
    read_parameters(np);
    for (std::size_t i = 0; i < size(); ++i)
      if (!point_of(i).allFinite())
        throw Invalid_input("pcs::Point_set_deformation::apply(): point " + std::to_string(i) +
                            " is not finite");
    check_normals();
  }

  struct Motion
  {
    Similarity scale, rotation, translation;
  };

  template <class Triple>
  static Triple make(const deformation::Vec3& v)
  {
    using FT = std::decay_t<decltype(std::declval<const Triple&>().x())>;
    return Triple(static_cast<FT>(v.x()), static_cast<FT>(v.y()), static_cast<FT>(v.z()));
  }

  /// Calls `f` with element `i`, which may live in its iterator.
  template <class F>
  decltype(auto) with_element(std::size_t i, const F& f) const
  {
    using Iterator = decltype(std::begin(*m_points));
    const Iterator it = std::begin(*m_points) +
                        static_cast<typename std::iterator_traits<Iterator>::difference_type>(i);
    return f(*it);
  }

  deformation::Vec3 point_of(std::size_t i) const
  {
    return with_element(i,
                        [this](auto&& key) { return internal::to_eigen(get(*m_point_map, key)); });
  }

  void require_ready(const char* function) const
  {
    if (!m_session || !m_session->is_ready())
      throw Invalid_input(std::string(function) +
                          ": the construction of this object was cancelled");
  }

  void require_handle(const char* function, Handle handle) const
  {
    require_ready(function);
    if (!m_session->is_handle(handle))
      throw Invalid_input(std::string(function) + ": there is no handle " + std::to_string(handle));
  }

  void set_motion(Handle handle, const Motion& motion)
  {
    m_session->set_transform(handle, motion.translation * motion.rotation * motion.scale);
    m_motion[handle] = motion;
  }

  void read_parameters(const NamedParameters& np)
  {
    const char* function = "pcs::Point_set_deformation";
    constexpr std::size_t many = std::numeric_limits<std::uint32_t>::max();
    if constexpr (internal::is_given_v<NamedParameters, CGAL::internal_np::point_t>)
      m_point_map = std::make_unique<Point_map>(
          CGAL::parameters::get_parameter(np, CGAL::internal_np::point_map));
    else
      m_point_map = std::make_unique<Point_map>();
    if constexpr (Types::has_normals)
      m_normal_map = std::make_unique<Normal_map>(
          CGAL::parameters::get_parameter(np, CGAL::internal_np::normal_map));
    if constexpr (Types::has_vectors)
      m_vector_map = std::make_unique<typename Types::Vector_map>(
          CGAL::parameters::get_parameter(np, internal_np::vector_map));
    if constexpr (Types::has_tensors)
      m_tensor_map = std::make_unique<typename Types::Tensor_map>(
          CGAL::parameters::get_parameter(np, internal_np::tensor_map));
    m_sampling.number_of_samples = internal::count_parameter(function,
                                                             "number_of_samples",
                                                             np,
                                                             internal_np::number_of_samples,
                                                             default_number_of_samples,
                                                             1,
                                                             many);
    m_sampling.number_of_neighbors =
        internal::count_parameter(function,
                                  "number_of_neighbors",
                                  np,
                                  internal_np::number_of_neighbors,
                                  default_number_of_neighbors,
                                  2,
                                  neighborhood::maximal_number_of_neighbors);
    m_sampling.number_of_sample_neighbors =
        internal::count_parameter(function,
                                  "number_of_sample_neighbors",
                                  np,
                                  internal_np::number_of_sample_neighbors,
                                  default_number_of_sample_neighbors,
                                  1,
                                  32);
    m_sampling.sample_search =
        internal::choose(np, internal_np::sample_search, m_sampling.sample_search);
    m_sampling.sample_weights =
        internal::choose(np, internal_np::sample_weights, m_sampling.sample_weights);
    m_sampling.do_preserve_volume =
        internal::choose(np, internal_np::do_preserve_volume, m_sampling.do_preserve_volume);
    m_elastic.rotation_field =
        internal::choose(np, internal_np::rotation_field, m_elastic.rotation_field);
    m_elastic.maximal_number_of_passes = static_cast<int>(
        internal::count_parameter(function,
                                  "number_of_iterations",
                                  np,
                                  CGAL::internal_np::number_of_iterations,
                                  static_cast<std::size_t>(m_elastic.maximal_number_of_passes),
                                  0,
                                  1000000));
    m_elastic.tolerance = internal::choose(np, internal_np::tolerance, m_elastic.tolerance);
    internal::checked(function,
                      "tolerance",
                      m_elastic.tolerance,
                      m_elastic.tolerance >= 0 && std::isfinite(m_elastic.tolerance),
                      "finite and not negative");
    m_elastic.stiffness = internal::choose(np, internal_np::stiffness, m_elastic.stiffness);
    internal::checked(function,
                      "stiffness",
                      m_elastic.stiffness,
                      m_elastic.stiffness >= 1e-3 && m_elastic.stiffness <= 1e3,
                      "between 0.001 and 1000");
    m_elastic.poisson_ratio =
        internal::choose(np, internal_np::poisson_ratio, m_elastic.poisson_ratio);
    internal::checked(function,
                      "poisson_ratio",
                      m_elastic.poisson_ratio,
                      m_elastic.poisson_ratio >= -1 && m_elastic.poisson_ratio <= 0.5,
                      "between -1 and 0.5");
    if constexpr (internal::is_given_v<NamedParameters, CGAL::internal_np::callback_t>)
      m_callback = CGAL::parameters::get_parameter(np, CGAL::internal_np::callback);
  }

  std::vector<deformation::Vec3> read_points() const
  {
    const auto n =
        static_cast<std::size_t>(std::distance(std::begin(*m_points), std::end(*m_points)));
    if (n == 0)
      throw Invalid_input("pcs::Point_set_deformation: there are no points");
    if (n >= std::numeric_limits<std::uint32_t>::max() / 64)
      throw Invalid_input(
          "pcs::Point_set_deformation: " + std::to_string(n) +
          " points are too many for 32 bit indices of their links; deform a sample of them");
    std::vector<deformation::Vec3> points(n);
    internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) { points[i] = point_of(i); });
    for (std::size_t i = 0; i < n; ++i)
      if (!points[i].allFinite())
        throw Invalid_input("pcs::Point_set_deformation: point " + std::to_string(i) +
                            " is not finite");
    return points;
  }

  deformation::Vec3 normal_of(std::size_t i) const
  {
    if constexpr (Types::has_normals)
      return with_element(i, [this](auto&& key) {
        return internal::to_eigen(get(*m_normal_map, key));
      });
    else
      return deformation::Vec3::Zero();
  }

  void check_normals() const
  {
    const auto is_finite = [&](std::size_t i) {
      bool result = true;
      if constexpr (Types::has_normals)
        result = normal_of(i).allFinite();
      if constexpr (Types::has_vectors)
        result = result && internal::to_eigen(attribute(m_vector_map, i)).allFinite();
      if constexpr (Types::has_tensors)
        result = result && attribute(m_tensor_map, i).allFinite();
      return result;
    };
    if constexpr (Types::has_normals || has_gradients)
      for (std::size_t i = 0; i < size(); ++i)
        if (!is_finite(i))
          throw Invalid_input("pcs::Point_set_deformation: the normal, vector or tensor of point " +
                              std::to_string(i) + " is not finite");
  }

  template <class Map>
  auto attribute(const std::unique_ptr<Map>& map, std::size_t i) const
  {
    return with_element(i, [&](auto&& key) -> pcs::Map_value<Map> { return get(*map, key); });
  }

  /// Takes the normals, vectors and tensors of the rest shape.
  void read_attributes()
  {
    if constexpr (Types::has_normals)
      m_session->set_normals([this](std::size_t i) { return normal_of(i); });
    m_rest_vectors.resize(Types::has_vectors ? size() : 0);
    m_rest_tensors.resize(Types::has_tensors ? size() : 0);
    for (std::size_t i = 0; i < m_rest_vectors.size(); ++i)
      if constexpr (Types::has_vectors)
        m_rest_vectors[i] = internal::to_eigen(attribute(m_vector_map, i));
    for (std::size_t i = 0; i < m_rest_tensors.size(); ++i)
      if constexpr (Types::has_tensors)
        m_rest_tensors[i] = attribute(m_tensor_map, i).template cast<double>();
  }

  void write_points()
  {
    if constexpr (is_ok)
      m_session->template write<has_gradients>(
          [this](std::size_t i,
                 const deformation::Vec3& p,
                 const deformation::Vec3& normal,
                 const Eigen::Matrix3d& gradient)
              PCS_LAMBDA_INLINE { write(i, p, normal, gradient); },
          [this](std::size_t i) PCS_LAMBDA_INLINE { prefetch(i); });
  }

  /// Asks for the memory that `write()` will touch.
  void prefetch(std::size_t i) const
  {
    with_element(i, [this](auto&& key) PCS_LAMBDA_INLINE {
      prefetch_value(*m_point_map, key);
      if constexpr (Types::has_normals)
        prefetch_value(*m_normal_map, key);
    });
  }
  template <class Map, class Key>
  static PCS_ALWAYS_INLINE void prefetch_value(const Map& map, Key&& key)
  {
    if constexpr (std::is_lvalue_reference_v<decltype(get(map, key))>)
      pcs::internal::prefetch(std::addressof(get(map, key)), 1);
  }

  void write(std::size_t i,
             const deformation::Vec3& p,
             [[maybe_unused]] const deformation::Vec3& normal,
             [[maybe_unused]] const Eigen::Matrix3d& gradient)
  {
    with_element(i, [&](auto&& key) {
      put(*m_point_map, key, make<Point>(p));
      if constexpr (Types::has_normals)
        put(*m_normal_map, key, make<Normal>(normal));
      if constexpr (Types::has_vectors)
        put(*m_vector_map,
            key,
            make<pcs::Map_value<typename Types::Vector_map>>(gradient * m_rest_vectors[i]));
      if constexpr (Types::has_tensors) {
        using Tensor = pcs::Map_value<typename Types::Tensor_map>;
        const Eigen::Matrix3d tensor = gradient * m_rest_tensors[i] * gradient.transpose();
        put(*m_tensor_map, key, Tensor(tensor.template cast<typename Tensor::Scalar>()));
      }
    });
  }

  std::size_t size() const
  {
    return static_cast<std::size_t>(std::distance(std::begin(*m_points), std::end(*m_points)));
  }

  PointRange* m_points;
  std::unique_ptr<Point_map>
      m_point_map; // maps need be neither assignable nor default constructible
  std::unique_ptr<Normal_map> m_normal_map;
  std::unique_ptr<typename Types::Vector_map> m_vector_map;
  std::unique_ptr<typename Types::Tensor_map> m_tensor_map;
  std::vector<deformation::Vec3> m_rest_vectors;
  std::vector<Eigen::Matrix3d> m_rest_tensors;
  deformation::Sampling_options m_sampling{default_number_of_samples,
                                           default_number_of_neighbors,
                                           default_number_of_sample_neighbors,
                                           Sample_search::regions,
                                           Sample_weights::compact,
                                           true};
  deformation::Elastic_options m_elastic;
  std::function<bool(double)> m_callback;
  std::unique_ptr<Session> m_session;
  std::vector<Motion> m_motion;
};

template <class PointRange>
Point_set_deformation(PointRange&) -> Point_set_deformation<PointRange>;
template <class PointRange, class NamedParameters>
Point_set_deformation(PointRange&, const NamedParameters&)
    -> Point_set_deformation<PointRange, NamedParameters>;

} // namespace pcs

#endif // PCS_POINT_SET_DEFORMATION_H

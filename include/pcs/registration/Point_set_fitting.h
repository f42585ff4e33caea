// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Nonrigid registration of a point cloud to one or several targets.

#ifndef PCS_REGISTRATION_POINT_SET_FITTING_H
#define PCS_REGISTRATION_POINT_SET_FITTING_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Deformation_options.h>
#include <pcs/core/Status.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/deformation/access/Point_access.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/registration/Fit_options.h>
#include <pcs/registration/Fit_session.h>
#include <pcs/registration/read_fit_input.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsRegistrationRef
  \brief Nonrigid registration: deforms a source cloud onto target clouds without given
      correspondences.

  The object keeps the source at rest, so that a template can be fitted to a sequence of clouds
  without accumulating errors. The model, with its equations, is described on the page
  `fit_point_set` of the user manual. In short: samples of the source have positions and rotations,
  and carry its points (\cite sssp2007). Gauss-Newton steps minimise the elastic energy of
  `Point_set_deformation`, with lengths at rest that adapt to a smooth stretch, and the distances of
  matches. There are three stages: rigid alignment and a coarse deformation by soft matches
  (\cite ms2010), then closest points with compatible normals in both directions, with robust
  point-to-plane distances and decreasing stiffness (\cite arv2007, \cite lsp2008). Points beside a
  border of the other cloud have no match and follow elastically.

  All lengths are relative to the extent of the source, the diagonal of its bounding box: scaled
  input gives a scaled result.

  \tparam PointRange a model of `RandomAccessRange`, to which the object keeps a reference. Points
          are read by the constructor and written by `fit()` and `reset()`, through the point map
  \tparam NamedParameters the type of a chain of named parameters with the property maps that are
          given to the constructor; deduced from its arguments
  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`

  \par Memory
  About 650 bytes per point of the source at the peak, if the target has as many points.

  \par Determinism
  Results are bitwise identical for every number of threads and for the sequential tag.
*/
template <class PointRange,
          class NamedParameters = parameters::Default_named_parameters,
          class ConcurrencyTag = CGAL::Parallel_if_available_tag>
class Point_set_fitting
{
  using Access = deformation::Point_access<PointRange, NamedParameters>;
  using Session = registration::Fit_session<ConcurrencyTag>;
  using Vec3 = Eigen::Vector3d;
  using Match_writer = std::function<void(const std::vector<std::ptrdiff_t>&)>;

public:
  /*!
    Reads the points, finds neighbours and samples. O(n log n).

    \param points at least 4 points at two or more different positions [L]; must outlive this object
    \param np named parameters, listed below
    \npbegin
      \np{point_map} where a position is read and written
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a point type
        \npdefault `CGAL::Identity_property_map`
      \np{normal_map} where a normal is read and written; normals keep their length. If the target
        has normals, too, they must point to the same side of the surface in both clouds, and only
        points whose normals agree are matched.
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a vector type
        \npdefault none: normals are estimated, and both sides are equivalent
      \np{vector_map} vectors that the deformation gradient maps, see `Point_set_deformation`
        \nptype model of `ReadWritePropertyMap`, key: element of `points`, value: a vector type
        \npdefault none
      \np{tensor_map} tensors `T`, mapped to `G T G^T` by the deformation gradient `G`
        \nptype the same, value: `Eigen::Matrix<FT, 3, 3>`
        \npdefault none
      \np{gradient_map} where the deformation gradient of a point is written
        \nptype model of `WritablePropertyMap`, key: element of `points`, value:
            `Eigen::Matrix<FT, 3, 3>`
        \npdefault none
      \np{number_of_samples} number of samples that carry the points [count]
        \nptype integer, 2 to 100,000
        \npdefault 500
      \np{number_of_neighbors} nearest neighbours to which a point is linked [count]
        \nptype integer, 2 to 60
        \npdefault `default_number_of_neighbors`
      \np{do_preserve_volume} whether springs through the interior of closed surfaces resist changes
        of thickness. Two shapes often differ in thickness, therefore it is off.
        \nptype `bool`
        \npdefault `false`
      \np{stiffness} bending stiffness relative to stretching stiffness [-]
        \nptype floating point, 0.001 to 1000
        \npdefault 1
      \np{fitting_length} length of the smallest features that the deformation follows; smaller
        values fit more closely, and follow noise [extents of the source]
        \nptype floating point, 0.001 to 1
        \npdefault 0.02
      \np{outlier_share} expected fraction of target points that belong to nothing in the source [-]
        \nptype floating point, 0 to 0.9
        \npdefault 0.1
      \np{do_align} whether a rigid alignment comes first. It finds turns of up to about 60 degrees;
        three or more landmarks at different places determine it instead. Without it, landmarks
        only act like springs.
        \nptype `bool`
        \npdefault `true`
      \np{number_of_iterations} largest number of iterations of each of the three stages [count]
        \nptype integer, `> 0`
        \npdefault 60
      \np{tolerance} the last stage ends when the root mean square step of the samples is smaller
        [extents of the source]
        \nptype floating point, `>= 0`
        \npdefault 1e-4
      \np{point_is_matched_map} written by `fit()` after the points: whether a point has a
        match. Points without match lie where the target has a hole, or are not part of it.
        \nptype model of `WritablePropertyMap`, key: element of `points`, value: `bool`
        \npdefault none
      \np{point_match_map} written by `fit()` after the points: the position of the closest
        target point in its range, or -1 without match
        \nptype model of `WritablePropertyMap`, key: element of `points`, value: a signed integer
        \npdefault none
      \np{callback} called on this thread with a value that grows from 0 to 1; `false` stops, and no
        point is written
        \nptype `std::function<bool(double)>`
        \npdefault none
    \npend

    \throws Invalid_input if there are fewer than 4 points, a coordinate or normal is not finite,
            all points coincide, or a parameter is out of range
  */
  template <class GivenParameters = NamedParameters>
  explicit Point_set_fitting(PointRange& points, const GivenParameters& np = GivenParameters())
    : m_access(points, np)
  {
    if constexpr (Access::is_ok && Access::template has_maps_of<GivenParameters>()) {
      const char* function = "pcs::fit_point_set()";
      check_names(np);
      const auto sampling = registration::read_fit_sampling(np, function);
      m_options = registration::read_fit_options(np, function);
      internal::read_callback(np, m_callback);
      registration::check_number_of_points(m_access.size(), "source", function);
      auto coordinates = m_access.template points_of_session<ConcurrencyTag>(function);
      m_rest = coordinates;
      for (std::size_t i = 0; Access::has_normals && i < coordinates.size(); ++i)
        m_normals.push_back(m_access.normal(i));
      auto unit_normals = m_normals;
      registration::normalize(unit_normals);
      m_session = std::make_unique<Session>();
      const internal::Stage_timer timer(m_seconds_of_construction);
      internal::Progress progress(m_callback);
      const internal::Progress_stage stage(progress, 0, 0.1);
      m_access.keep_rest_attributes();
      m_is_ready =
          m_session->build(std::move(coordinates), std::move(unit_normals), sampling, progress);
      keep_maps(points, np);
    }
  }

  /*!
    Deforms the source onto `target` and writes points, normals and the other maps. Nothing is
    written if the status is `cancelled` or `numerical_failure`, or if an exception is thrown.

    \param target at least 4 points [L]
    \param np `point_map` and `normal_map` of the target, and
    \npbegin
      \np{landmarks} points of the source with known positions on the target. Three or more at
        different places determine the initial pose, unless `do_align` is `false`. They act like
        stiff springs; `largest_landmark_gap` of the report is the largest distance that remains.
        \nptype `std::vector<Landmark>`
        \npdefault none
    \npend
    \param start `Solver_start::cold`: from the source at rest. `Solver_start::warm`, for the next
           cloud of a sequence: from the last result, without rigid alignment
    \return a `Fit_report`. Check `is_plausible`: it is false if less than a fifth of the source
            points is matched, or if the residual is large
    \throws Invalid_input if the target has fewer than 4 points, all of its points coincide, one is
            not finite or more than a million extents away, or a landmark is out of range, not
            finite, or contradicts another one; nothing is changed then
    \par Complexity
    O((n + m) log m) for `n` source and `m` target points, and per iteration the factorisation of a
    matrix of 6 rows per sample and about 6,000 closest points in both directions.
  */
  template <class TargetRange, class TargetParameters = parameters::Default_named_parameters>
  Fit_report fit(const TargetRange& target,
                 const TargetParameters& np = TargetParameters(),
                 Solver_start start = Solver_start::cold)
  {
    const char* function = "pcs::fit_point_set()";
    internal::check(m_session != nullptr, function, "the object was moved from");
    internal::check_names<internal_np::landmarks_t>(np);
    Fit_report report;
    report.seconds.preparation = m_seconds_of_construction;
    m_seconds_of_construction = 0;
    report.number_of_source_points = m_access.size();
    report.status = Status::cancelled;
    if (!m_is_ready)
      return report;
    internal::check(m_access.size() == m_session->number_of_points(),
                    function,
                    "the number of source points has changed since the construction");
    registration::Fit_input input = registration::read_target(target, np, function);
    registration::localize(m_session->frame(), m_session->extent(), function, input.points);
    std::vector<Landmark> given;
    using Tag = internal_np::landmarks_t;
    static_assert(internal::is_parameter_v<std::vector<Landmark>, TargetParameters, Tag>,
                  "pcs::fit_point_set(): `landmarks` must be a std::vector<pcs::Landmark>");
    internal::read_parameter(np, Tag(), given);
    input.landmarks = registration::local_landmarks(given, *m_session, function);
    return run(input, start, report);
  }

  /// Restores the source at rest, with all bits of its positions.
  void reset()
  {
    const char* function = "pcs::fit_point_set()";
    internal::check(m_session != nullptr, function, "the object was moved from");
    internal::check(m_is_ready, function, "the construction was cancelled");
    m_session->put_at_rest();
    m_has_shape = false;
    internal::for_each_index<ConcurrencyTag>(m_session->number_of_points(), [&](std::size_t i) {
      m_access.write(i,
                     m_rest[i],
                     Access::has_normals ? m_normals[i] : Vec3(Vec3::Zero()),
                     Eigen::Matrix3d::Identity());
    });
  }

  std::size_t number_of_samples() const { return m_session ? m_session->number_of_samples() : 0; }

private:
  template <class GivenParameters>
  static void check_names(const GivenParameters& np)
  {
    namespace tags = internal_np;
    internal::check_names<CGAL::internal_np::callback_t,
                          CGAL::internal_np::number_of_iterations_t,
                          tags::vector_map_t,
                          tags::tensor_map_t,
                          tags::gradient_map_t,
                          tags::number_of_samples_t,
                          tags::number_of_neighbors_t,
                          tags::do_preserve_volume_t,
                          tags::stiffness_t,
                          tags::fitting_length_t,
                          tags::outlier_share_t,
                          tags::do_align_t,
                          tags::tolerance_t,
                          tags::point_is_matched_map_t,
                          tags::point_match_map_t>(np);
  }

  /// Stores functions that write the maps of matches.
  template <class GivenParameters>
  void keep_maps([[maybe_unused]] PointRange& points, [[maybe_unused]] const GivenParameters& np)
  {
    using Is_matched = internal_np::point_is_matched_map_t;
    using Match = internal_np::point_match_map_t;
    if constexpr (internal::is_given_v<GivenParameters, Is_matched>)
      m_put_is_matched = writer<bool>(points, CGAL::parameters::get_parameter(np, Is_matched()));
    if constexpr (internal::is_given_v<GivenParameters, Match>)
      m_put_match = writer<std::ptrdiff_t>(points, CGAL::parameters::get_parameter(np, Match()));
  }

  /// Returns a function that writes a value for each point, computed from its match or -1.
  template <class Value, class Map>
  static Match_writer writer(PointRange& points, Map map)
  {
    constexpr bool is_ok = is_map_for_v<Map, Element_reference<PointRange>, Value>;
    static_assert(is_ok,
                  "pcs::fit_point_set(): point_is_matched_map and point_match_map must be writable "
                  "property maps of the elements of `points`, with values of bool and of a signed "
                  "integer");
    return [&points, map](const std::vector<std::ptrdiff_t>& matches) {
      if constexpr (is_ok) {
        std::size_t i = 0;
        for (auto&& key : points) {
          const std::ptrdiff_t match = matches[i++];
          if constexpr (std::is_same_v<Value, bool>)
            put(map, key, static_cast<Map_value<Map>>(match >= 0));
          else
            put(map, key, static_cast<Map_value<Map>>(match));
        }
      }
    };
  }

  Fit_report run(registration::Fit_input& input, Solver_start start, Fit_report report)
  {
    internal::Progress progress(m_callback);
    // Only normals of both clouds have comparable sides.
    m_options.is_oriented = Access::has_normals && !input.normals.empty();
    registration::normalize(input.normals);
    report.number_of_target_points = input.points.size();
    const bool is_warm = start == Solver_start::warm && m_has_shape;
    const auto write = [this] {
      m_has_shape = true;
      write_points();
    };
    const auto matches = m_session->fit(input, m_options, is_warm, write, report, progress);
    const internal::Stage_timer timer(report.seconds.writing);
    for (const Match_writer* put_matches : {&m_put_is_matched, &m_put_match})
      if (*put_matches && !matches.empty())
        (*put_matches)(matches);
    return report;
  }

  void write_points()
  {
    internal::for_each_index<ConcurrencyTag>(
        m_session->number_of_points(),
        [&](std::size_t i) {
          const Eigen::Matrix3d gradient = m_session->gradient(i);
          Vec3 normal = Vec3::Zero();
          if constexpr (Access::has_normals)
            normal = m_normals[i].norm() * registration::moved_normal(gradient, m_normals[i]);
          m_access.write(i, m_session->position(i), normal, gradient);
        },
        256);
  }

  Access m_access;
  registration::Fit_options m_options;
  std::function<bool(double)> m_callback;
  Match_writer m_put_is_matched, m_put_match;
  std::vector<Vec3> m_rest;    ///< as given
  std::vector<Vec3> m_normals; ///< as given, at rest; empty without `normal_map`
  std::unique_ptr<Session> m_session;
  double m_seconds_of_construction = 0;
  bool m_is_ready = false;  ///< whether the construction was completed
  bool m_has_shape = false; ///< whether `fit()` has succeeded
};

template <class PointRange>
Point_set_fitting(PointRange&) -> Point_set_fitting<PointRange>;
template <class PointRange, class NamedParameters>
Point_set_fitting(PointRange&, const NamedParameters&)
    -> Point_set_fitting<PointRange, deformation::Map_parameters<NamedParameters>>;

} // namespace pcs

#endif // PCS_REGISTRATION_POINT_SET_FITTING_H

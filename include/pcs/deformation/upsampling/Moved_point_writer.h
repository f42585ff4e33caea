// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Output of upsampled points, and of points that are not upsampled.

#ifndef PCS_DEFORMATION_UPSAMPLING_MOVED_POINT_WRITER_H
#define PCS_DEFORMATION_UPSAMPLING_MOVED_POINT_WRITER_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Site_constraints.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/upsampling/Dirty_handles.h>
#include <pcs/deformation/upsampling/Outlier_maps.h>
#include <pcs/deformation/upsampling/Rest_positions.h>
#include <pcs/deformation/upsampling/Target_corrections.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/internal/instruction_set.h>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// The input of a `Moved_point_writer`.
template <class ConcurrencyTag>
struct Moved_points
{
  const Sampled_body<ConcurrencyTag>& body;
  Upsampling& upsampling;              ///< not const, because it stores its own maps
  const std::vector<Affine_map>& maps; ///< of the samples
  const Outlier_maps& outlier_maps;
  const Site_constraints& sites;
  const Target_corrections& corrections;
  const std::vector<Similarity>& transforms; ///< of the handles, in local coordinates
  const std::vector<char>& is_written;       ///< of each handle, from `Dirty_handles::find()`
  const Rest_positions& rest_positions;      ///< in the caller's coordinates
  bool is_at_rest;                           ///< whether all maps and transforms are identities
  Upsampling::Block_motions motions;         ///< if the body is sampled
  double& seconds;                           ///< time of writing in the report [s]
};

/*!
  The `Writer` of `Upsampling::apply()`, whose functions receive upsampling indices. An `Output`
  writes the caller's points by input index, with `write(i, position, normal, gradient)`. Its
  further functions `prefetch(i)`, `can_stream()` and `stream(i, positions, normals)` correspond to
  `expect()`, `does_stream()` and `stream()` of `Writer`.
*/
template <class ConcurrencyTag, class Output>
class Moved_point_writer
{
public:
  Moved_point_writer(const Moved_points<ConcurrencyTag>& moved, Output& output)
    : m_body(moved.body),
      m_sites(moved.sites),
      m_outlier_maps(moved.outlier_maps),
      m_corrections(moved.corrections),
      m_rest_positions(moved.rest_positions),
      m_transforms(moved.transforms),
      m_is_written(moved.is_written),
      m_output(output),
      m_does_stream(moved.body.is_in_callers_order && output.can_stream())
  {
  }

  /// Writes a point in the caller's coordinates.
  PCS_ALWAYS_INLINE void
  write(std::size_t place, const Vec3& p, const Vec3& normal, const Eigen::Matrix3d& gradient) const
  {
    m_output.write(m_body.input_of_place[place], p, normal, gradient);
  }

  PCS_ALWAYS_INLINE void expect(std::size_t place) const
  {
    m_output.prefetch(m_body.input_of_place[place]);
  }

  bool does_stream() const { return m_does_stream; }

  PCS_ALWAYS_INLINE bool stream(std::size_t first_place, const Block_output& out) const
  {
    return m_output.stream(first_place, out.position, out.normal);
  }

  /// Writes a point that is not blended from samples.
  void write_other(std::size_t place) const
  {
    const std::size_t site = m_body.site_of_place[place];
    const Node_constraint h = m_sites[site];
    if (h >= 0 && m_is_written[static_cast<std::size_t>(h)] == points_moved)
      write_rigid(place, m_transforms[static_cast<std::size_t>(h)]);
    else if (h == outlier_site)
      write_mapped(place, m_outlier_maps.of_site(m_body, site));
    else
      write_unmoved(place);
  }

  /// Writes the position at rest, with all its bits, unless the point has never left it.
  void write_unmoved(std::size_t place) const
  {
    const Node_constraint h = m_sites[m_body.site_of_place[place]];
    if (h == unreached_node ||
        (h >= 0 && m_is_written[static_cast<std::size_t>(h)] == points_unwritten))
      return;
    Vec3 normal = Vec3::Zero();
    if (m_body.rest_points.has_normals())
      normal = m_body.rest_points.normal(place);
    const Vec3 position = m_rest_positions(m_body.input_of_place[place], [&] {
      return m_body.frame.to_world(m_body.rest_of_place(place));
    });
    write(place, position, normal, Eigen::Matrix3d::Identity());
  }

  void write_mapped(std::size_t place, const Affine_map& map) const
  {
    const Eigen::Matrix3d a = Eigen::Map<const Row_major_matrix>(map.a);
    Vec3 normal = Vec3::Zero();
    if (m_body.rest_points.has_normals())
      normal = turn_normal(a, m_body.rest_points.normal(place));
    write(place,
          m_body.frame.to_world(a * m_body.rest_of_place(place) + Eigen::Map<const Vec3>(map.t)),
          normal,
          a);
  }

private:
  void write_rigid(std::size_t place, const Similarity& t) const
  {
    Vec3 normal = Vec3::Zero();
    if (m_body.rest_points.has_normals())
      normal = t.rotation() * m_body.rest_points.normal(place);
    Vec3 position = m_body.frame.to_world(t(m_body.rest_of_place(place)));
    Eigen::Matrix3d gradient = t.scale() * t.rotation();
    m_corrections.apply(m_body.site_of_place[place], m_body.frame, position, normal, gradient);
    write(place, position, normal, gradient);
  }

  const Sampled_body<ConcurrencyTag>& m_body;
  const Site_constraints& m_sites;
  const Outlier_maps& m_outlier_maps;
  const Target_corrections& m_corrections;
  const Rest_positions& m_rest_positions;
  const std::vector<Similarity>& m_transforms;
  const std::vector<char>& m_is_written;
  Output& m_output;
  bool m_does_stream;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_MOVED_POINT_WRITER_H

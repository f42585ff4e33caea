// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Editing session on plain coordinates: the compiled part of `Point_set_deformation`.

#ifndef PCS_DEFORMATION_SESSION_H
#define PCS_DEFORMATION_SESSION_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Elastic_options.h>
#include <pcs/deformation/model/Sampling_options.h>
#include <pcs/deformation/upsampling/write_points.h>
#include <pcs/internal/progress.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace pcs {
namespace deformation {

struct Handle_points;
struct Handle_targets;

/// State of the samples and handles, from which the positions of all points can be restored.
struct Session_snapshot
{
  std::vector<Similarity> transforms;                         ///< of the handles
  std::vector<std::shared_ptr<const Handle_points>> handles;  ///< shared with the session
  std::vector<std::shared_ptr<const Handle_targets>> targets; ///< shared with the session
  std::vector<Vec3> centroids;                                ///< of the handles
  std::vector<Affine_map> maps;                               ///< of the samples
  std::uint64_t rest_setting = 0;                             ///< identifies session and rest shape
  std::uint64_t setting = 0;                                  ///< identifies the handles, too
  bool is_at_rest = true;
};

template <class ConcurrencyTag>
struct Session_state;

/*!
  The algorithm of `Point_set_deformation`, independent of point types. Indices refer to the
  caller's points. Transformations are in the caller's coordinates. Errors are thrown before
  anything changes.
*/
template <class ConcurrencyTag>
class Session
{
public:
  /// \param region indices of the region of interest, or null for all points
  Session(std::vector<Vec3> points,
          const Sampling_options& options,
          const std::vector<std::uint32_t>* region,
          pcs::internal::Progress& progress);
  ~Session();

  /// Whether the construction was completed. If the callback cancelled it, no other function may be
  /// called.
  bool is_ready() const;
  std::size_t number_of_points() const;
  const Similarity& transform(std::size_t handle) const;
  std::size_t number_of_samples() const;

  /// Adds a handle at rest. \param weight 0: exact; positive: soft, see
  /// `Node_constraints`
  std::size_t
  add_handle(const std::vector<std::uint32_t>& indices, double weight, const char* function);

  /// Frees the points of a handle. Its number is not used again.
  void remove_handle(std::size_t handle);

  bool is_handle(std::size_t handle) const;
  /// Returns the smallest number that is larger than those of all handles.
  std::size_t number_of_handles() const;

  /// Centroid of the handle's points at rest, in the caller's coordinates.
  const Vec3& centroid(std::size_t handle) const;

  /// Throws `Invalid_input` if double precision cannot represent the motion and the cloud together.
  void set_transform(std::size_t handle, const Similarity& transform);

  /// Sets one target for each point of the handle, in the order of `add_handle()`, in the caller's
  /// coordinates, and the rigid motion that fits them best. The next motion replaces them.
  void set_targets(std::size_t handle, const std::vector<Vec3>& targets, const char* function);

  /// Factorises if handles changed since the last factorisation. Returns `converged`,
  /// `numerical_failure` if a matrix is singular, or `cancelled`. If it is cancelled or throws, the
  /// current shape is kept, and the next call factorises again.
  Status constrain(double stiffness, pcs::internal::Progress& progress);

  /// Solves for the current transformations. The points are not written, see `write()`. The last
  /// shape is kept if the status is `cancelled` or `numerical_failure`.
  Status
  solve(const Elastic_options& options, Solver_start start, pcs::internal::Progress& progress);

  /// Whether the current shape was solved with the current handles, or is the rest shape.
  bool has_shape_of_handles() const;
  /// Whether the handles of the factorised matrices differ from those of the current shape.
  bool is_ahead_of_shape() const;
  /// Whether a snapshot was taken from this session with its current rest shape.
  bool is_of_rest_shape(const Session_snapshot& s) const;

  /// Returns the last shape that was solved or restored, with its motions.
  Session_snapshot snapshot() const;

  /// Restores shape, handles and motions. Factorises if the handles differ from those of the last
  /// factorisation.
  void restore(const Session_snapshot& s);

  /// Restores the rest shape and sets all handles to rest.
  void reset();

  /*!
    Writes, concurrently, all points that the deformation may move. It omits points outside the
    region of interest, points that are not connected to a handle, and points of handles that have
    not moved. If `output` throws, the next call writes all points of this one again. `output` is an
    `Output` of `Moved_point_writer`. Positions are in the caller's coordinates. If `HasGradients`,
    the gradient is the linear part of the map of the point.
  */
  template <bool HasGradients, class Output>
  void write(Output& output)
  {
    write_points<HasGradients>(moved_points(), output);
    finish_writing();
  }

  /*!
    Moves any point and its normal like the points around it. The point remains bitwise unchanged if
    its nearest point does not move. `gradient`, the identity before the call, becomes the linear
    part of the map of the point. `prepare_carrying()` must be called before.
  */
  void carry(Vec3& point, Vec3& normal, Eigen::Matrix3d& gradient) const;

  /// Returns the linear part of the map of a point in the current shape, as `write()` writes it. It
  /// must not be called if `is_ahead_of_shape()`. O(1).
  Eigen::Matrix3d gradient(std::size_t i) const;
  /// Returns the rotation nearest to `gradient(i)`, or the identity if the determinant is not
  /// positive.
  Eigen::Matrix3d local_rotation(std::size_t i) const;

  /// Returns the position at rest of a point, in the caller's coordinates. [L]
  Vec3 rest_position(std::size_t i) const;
  /// Returns the index of the point at a sample.
  std::size_t point_of_sample(std::size_t sample) const;
  /// Whether the current shape is the rest shape, or was solved last and not restored.
  bool has_energies() const;
  /// Returns the part of the energy that belongs to a sample; `has_energies()` must be true. [L^2]
  double energy_of_sample(std::size_t sample) const;

  /// Builds the search trees of `carry()` unless they exist. O(n log n).
  void prepare_carrying();

  const Deformation_report& report() const;

  /// Sets the normals at rest from `normal(input index)`. [-]
  void set_normals(const std::function<Vec3(std::size_t)>& normal);

  /// Makes the current shape the rest shape. `position(input index)` returns its positions in the
  /// caller's coordinates.
  void accept(const std::function<Vec3(std::size_t)>& position);

private:
  Moved_points<ConcurrencyTag> moved_points();
  void finish_writing();

  std::unique_ptr<Session_state<ConcurrencyTag>> m_state;
};

} // namespace deformation
} // namespace pcs

#ifndef PCS_COMPILED_DEFORMATION
#include <pcs/deformation/Session_impl.h>
#endif

#endif // PCS_DEFORMATION_SESSION_H

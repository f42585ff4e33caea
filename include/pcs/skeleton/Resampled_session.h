// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A skeletonization whose result is compared with the skeletons of resampled copies of the scan.

#ifndef PCS_SKELETON_RESAMPLED_SESSION_H
#define PCS_SKELETON_RESAMPLED_SESSION_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/resampling/Copy_descriptors.h>
#include <pcs/skeleton/resampling/resample_scan.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  The skeletonization of a scan and of random subsets of it.

  The deviations among the subsets, called copies, are the basis of `standard_errors()`. If the
  copies have at least half of the points, the medians of all skeletons are the estimates of the
  report, the majority of the scan and the copies decides whether there are leaves, and a skeleton
  that is far from the medians of the copies is replaced by a more typical one. There are more
  skeletons of small scans if their medians are uncertain.
  Cancelled calls may be repeated; they continue with the interrupted skeleton.
*/
template <class ConcurrencyTag>
class Resampled_session
{
public:
  using Session = skeleton::Session<ConcurrencyTag>;

  /// `scan` is finite, with at least two different points. Stations and normals are read from
  /// `scan`, not from `hints`.
  Resampled_session(Scan_points scan, Session_hints hints, std::size_t number_of_resamples);

  /// Returns the session of the scan. Another one may replace it in `complete()`.
  Session& session() { return *m_session; }
  const Session& session() const { return *m_session; }

  /// Returns a callback for the stages of `session()`, whose progress ends where that of the copies
  /// begins.
  std::function<bool(double)> callback_of_stages(const std::function<bool(double)>& callback) const;

  /// Runs the remaining stages, extracts the skeletons of the copies, and chooses the skeleton.
  /// Returns `false` if the callback stopped it.
  bool complete(const std::function<bool(double)>& callback);

  /// Returns the report of the session with the deviations among the copies.
  Skeleton_report report() const;

private:
  /// A skeleton of a copy or of displaced points.
  struct Variant
  {
    std::unique_ptr<Session> session; ///< while it is in work, or if it is kept
    bool is_complete = false;
    Skeleton_report report;
    Vec3 root = Vec3::Zero();
  };

  bool has_copies() const { return m_number_of_copies > 0; }
  std::unique_ptr<Session> make_session(Scan_points points) const;
  template <class Make, class Complete>
  bool extract_variants(const Make& make,
                        const Complete& complete,
                        const std::function<bool(double)>& callback);
  bool extract_copies(pcs::internal::Progress& progress);
  bool needs_more_copies();
  std::size_t number_of_copies_at_most() const;
  void vote_on_leaves();
  bool choose_typical_skeleton(pcs::internal::Progress& progress);
  bool are_comparable() const;
  double distance_from_copies(const Skeleton_report& report, const Vec3& root) const;

  Scan_points m_scan;          ///< empty without copies
  Session_hints m_hints;       ///< without stations and normals; the method of the scan, once known
  double m_blade_fraction = 0; ///< by which the method was chosen [-]
  std::size_t m_number_of_wanted_copies = 0; ///< `number_of_resamples`
  std::size_t m_number_of_copies = 0;        ///< more, if those differ too much
  std::size_t m_number_of_completed_copies = 0;
  Copy_descriptors m_copies;
  Copy_descriptors m_skeletons; ///< of the copies, the scan and displaced points; may be empty
  std::unique_ptr<Session> m_session;
  std::vector<Variant> m_variants;    ///< in work
  std::size_t m_number_of_trials = 0; ///< see `choose_typical_skeleton()`
  double m_coordinate_step = 0;       ///< of the scan before displacement, like the next [L]
  bool m_is_single_precision = false;
  bool m_has_voted = false, m_is_leaf_removal_changed = false, m_is_displaced = false;
};

} // namespace skeleton
} // namespace pcs

#ifndef PCS_COMPILED_SKELETON
#include <pcs/skeleton/Resampled_session_impl.h>
#endif

#endif // PCS_SKELETON_RESAMPLED_SESSION_H

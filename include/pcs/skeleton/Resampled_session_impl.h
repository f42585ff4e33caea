// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Resampled_session.h.

#ifndef PCS_SKELETON_RESAMPLED_SESSION_IMPL_H
#define PCS_SKELETON_RESAMPLED_SESSION_IMPL_H

#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Resampled_session.h>
#include <pcs/skeleton/Session_impl.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Fractions of the progress at which the stages, the copies and the vote on leaves end, if there
/// are copies.
constexpr double end_of_stages = 0.5, end_of_copies = 0.8, end_of_vote = 0.9;

/// Copies with a smaller fraction of the points are not compared with the scan [-].
constexpr double least_comparable_fraction = 0.5;

/// Largest standard error of a median for which there are enough skeletons, in tolerances [-].
constexpr double settled_error = 0.5;

/// Returns the root in the coordinates of the input, the origin without a tree.
template <class Tag>
Vec3 root_of(const Session<Tag>& session)
{
  const Branch_tree& tree = session.tree();
  if (tree.branches.empty())
    return Vec3::Zero();
  return session.scan().frame.to_input(tree.nodes[tree.branches.front().nodes.front()].point);
}

} // namespace internal

template <class ConcurrencyTag>
Resampled_session<ConcurrencyTag>::Resampled_session(Scan_points scan,
                                                     Session_hints hints,
                                                     std::size_t number_of_resamples)
  : m_hints(std::move(hints))
{
  if (scan.positions.size() >= least_resampled_points)
    m_number_of_copies = m_number_of_wanted_copies = number_of_resamples;
  if (has_copies())
    m_scan = scan;
  m_session = make_session(std::move(scan));
}

template <class ConcurrencyTag>
std::function<bool(double)> Resampled_session<ConcurrencyTag>::callback_of_stages(
    const std::function<bool(double)>& callback) const
{
  if (!callback || m_number_of_completed_copies == m_number_of_copies)
    return callback;
  return [callback](double f) { return callback(internal::end_of_stages * f); };
}

template <class ConcurrencyTag>
bool Resampled_session<ConcurrencyTag>::complete(const std::function<bool(double)>& callback)
{
  pcs::internal::Progress stages(callback_of_stages(callback));
  if (!m_session->join(stages))
    return false;
  if (!has_copies() || m_session->report().status != Status::converged)
    return true;
  m_hints.method = m_session->report().method;
  m_blade_fraction = m_session->report().blade_fraction;
  pcs::internal::Progress progress(callback);
  progress.stage(internal::end_of_stages, internal::end_of_copies);
  if (!extract_copies(progress))
    return false;
  vote_on_leaves();
  progress.stage(internal::end_of_copies, internal::end_of_vote);
  if (!m_session->join(progress))
    return false;
  progress.stage(internal::end_of_vote, 1);
  return choose_typical_skeleton(progress);
}

template <class ConcurrencyTag>
Skeleton_report Resampled_session<ConcurrencyTag>::report() const
{
  Skeleton_report report = m_session->report();
  Copy_descriptors all = m_copies;
  if (m_copies.size() > 0 && report.status == Status::converged && are_comparable())
    all.add(report, internal::root_of(*m_session));
  report.spread = all.spread();
  if (m_skeletons.size() > 0)
    report.estimates = m_skeletons.estimates();
  report.spread.number_of_copies = m_copies.size();
  report.spread.number_of_leafy_copies = m_copies.number_of_leafy_copies;
  report.spread.number_of_empty_copies = m_number_of_completed_copies - m_copies.size();
  report.spread.is_leaf_removal_changed = m_is_leaf_removal_changed;
  report.spread.is_displaced = m_is_displaced;
  report.blade_fraction = std::max(report.blade_fraction, m_blade_fraction);
  if (m_is_displaced) { // displaced coordinates are not rounded
    report.coordinate_step = m_coordinate_step;
    report.is_single_precision = m_is_single_precision;
  }
  if (report.spread.number_of_copies > 0)
    report.spread.fraction = resampled_fraction(report.number_of_points);
  return report;
}

template <class ConcurrencyTag>
std::unique_ptr<Session<ConcurrencyTag>>
Resampled_session<ConcurrencyTag>::make_session(Scan_points points) const
{
  Session_hints hints = m_hints;
  hints.stations = std::move(points.stations);
  hints.normals = std::move(points.normals);
  return std::make_unique<Session>(std::move(points.positions),
                                   std::move(points.is_wood),
                                   std::move(hints));
}

/*!
  Extracts the skeletons of `m_variants`, several at a time if the tag allows it. `make(k)` returns
  the points of the variant `k`. `complete(k)` is called when its skeleton is complete, for one
  variant at a time, in any order. The callback receives the completed fraction of them, in the
  calling thread. Returns `false` if it stopped the work.
*/
template <class ConcurrencyTag>
template <class Make, class Complete>
bool Resampled_session<ConcurrencyTag>::extract_variants(
    const Make& make,
    const Complete& complete,
    const std::function<bool(double)>& callback)
{
  std::vector<std::atomic<double>> fractions(m_variants.size());
  for (std::size_t k = 0; k < m_variants.size(); ++k)
    fractions[k] = m_variants[k].is_complete ? 1 : 0;
  pcs::internal::Progress all(callback);
  pcs::internal::Shared_progress shared(all);
  const auto report_all = [&] {
    return shared(std::accumulate(fractions.begin(), fractions.end(), 0.0) /
                  double(fractions.size()));
  };
  std::mutex completion;
  pcs::internal::for_each_long_task<ConcurrencyTag>(
      m_variants.size(),
      [&](std::size_t k) {
        Variant& variant = m_variants[k];
        if (variant.is_complete || !report_all())
          return;
        if (!variant.session)
          variant.session = make_session(make(k));
        pcs::internal::Progress part([&](double f) {
          fractions[k] = f;
          return report_all();
        });
        if (!variant.session->join(part))
          return;
        variant.report = variant.session->report();
        variant.root = internal::root_of(*variant.session);
        const std::lock_guard<std::mutex> lock(completion);
        variant.is_complete = true;
        fractions[k] = 1;
        complete(k);
      },
      report_all);
  return !all.is_cancelled() && std::all_of(m_variants.begin(),
                                            m_variants.end(),
                                            [](const Variant& v) { return v.is_complete; });
}

/// Extracts the remaining skeletons of the copies, and of more copies while their medians are
/// uncertain.
template <class ConcurrencyTag>
bool Resampled_session<ConcurrencyTag>::extract_copies(pcs::internal::Progress& progress)
{
  do {
    const std::size_t first = m_number_of_completed_copies;
    m_variants.resize(m_number_of_copies - first);
    const bool is_complete =
        extract_variants([&](std::size_t k) { return resample_scan(m_scan, first + k); },
                         [&](std::size_t k) { m_variants[k].session.reset(); },
                         [&](double f) { // half of it until the wanted copies are done
                           const double done = double(first) + f * double(m_variants.size());
                           return progress(done / (done + double(m_number_of_wanted_copies)));
                         });
    if (!is_complete)
      return false;
    for (const Variant& copy : m_variants)
      if (copy.report.status == Status::converged)
        m_copies.add(copy.report, copy.root);
    m_number_of_completed_copies = m_number_of_copies;
    m_variants.clear();
  } while (needs_more_copies());
  return true;
}

/// Doubles the number of copies if their medians are uncertain. Returns whether it did.
template <class ConcurrencyTag>
bool Resampled_session<ConcurrencyTag>::needs_more_copies()
{
  const std::size_t most = number_of_copies_at_most();
  if (m_number_of_copies >= most ||
      m_copies.error_of_medians(m_session->report()) <= internal::settled_error)
    return false;
  m_number_of_copies = std::min(most, 2 * m_number_of_copies);
  return true;
}

template <class ConcurrencyTag>
std::size_t Resampled_session<ConcurrencyTag>::number_of_copies_at_most() const
{
  return are_comparable()
             ? largest_number_of_copies(m_scan.positions.size(), m_number_of_wanted_copies)
             : m_number_of_wanted_copies;
}

/// If the scan and its copies outvote the scan on whether there are leaves, starts the session
/// again with their decision.
template <class ConcurrencyTag>
void Resampled_session<ConcurrencyTag>::vote_on_leaves()
{
  if (m_has_voted || m_hints.leaf_removal != Leaf_removal::where_found || !are_comparable())
    return;
  m_has_voted = true;
  const Leaf_removal vote = majority_on_leaves(m_copies.size(),
                                               m_copies.number_of_leafy_copies,
                                               m_session->report().number_of_leaf_points > 0);
  if (vote == Leaf_removal::where_found)
    return;
  m_is_leaf_removal_changed = true;
  m_hints.leaf_removal = vote;
  m_session = make_session(m_scan);
}

/*!
  If the skeleton of the scan is far from the medians of the copies, or the medians of all skeletons
  are uncertain, extracts skeletons of the scan whose coordinates are displaced by at most a
  thousandth of the spacing: as many as the caller wanted copies, and again until neither is so or
  there are as many as copies. A skeleton that is too far is replaced by the closest one. Decisions
  that depend on chance are thus made as in most copies.
*/
template <class ConcurrencyTag>
bool Resampled_session<ConcurrencyTag>::choose_typical_skeleton(pcs::internal::Progress& progress)
{
  constexpr double displacement = 0.001; // spacings
  if (!m_is_displaced) {
    m_coordinate_step = m_session->report().coordinate_step;
    m_is_single_precision = m_session->report().is_single_precision;
  }
  if (m_skeletons.size() == 0 && are_comparable() &&
      m_session->report().status == Status::converged) {
    m_skeletons = m_copies;
    m_skeletons.add(m_session->report(), internal::root_of(*m_session));
  }
  double least = distance_from_copies(m_session->report(), internal::root_of(*m_session));
  const auto is_settled = [&] {
    return least <= 1 &&
           m_skeletons.error_of_medians(m_session->report()) <= internal::settled_error;
  };
  while (m_number_of_trials < m_number_of_copies && !is_settled()) {
    m_variants.resize(std::min(m_number_of_wanted_copies, m_number_of_copies - m_number_of_trials));
    const auto displaced = [&](std::size_t k) {
      Scan_points points = m_scan;
      displace_points(points.positions,
                      displacement * m_session->report().spacing,
                      m_number_of_trials + k + 1);
      return points;
    };
    const auto distance = [&](const Variant& v) { return distance_from_copies(v.report, v.root); };
    const auto keep_closest = [&](std::size_t k) { // to save memory
      for (std::size_t j = 0; j < m_variants.size(); ++j)
        if (j != k && m_variants[j].is_complete && m_variants[j].session) {
          const bool is_closer = std::make_pair(distance(m_variants[j]), j) <
                                 std::make_pair(distance(m_variants[k]), k);
          m_variants[is_closer ? k : j].session.reset();
        }
    };
    if (!extract_variants(displaced, keep_closest, [&](double f) {
          const double done = double(m_number_of_trials) + f * double(m_variants.size());
          return progress(done / double(m_number_of_copies));
        }))
      return false;
    m_number_of_trials += m_variants.size();
    for (Variant& trial : m_variants) {
      if (trial.report.status == Status::converged)
        m_skeletons.add(trial.report, trial.root);
      if (trial.session && least > 1 && distance(trial) < least) {
        least = distance(trial);
        m_session = std::move(trial.session);
        m_is_displaced = true;
      }
    }
    m_variants.clear();
  }
  return true;
}

/// Returns whether the copies have enough points to be compared with the scan. Leaves, for example,
/// are not recognized in thinned scans.
template <class ConcurrencyTag>
bool Resampled_session<ConcurrencyTag>::are_comparable() const
{
  return resampled_fraction(m_scan.positions.size()) >= internal::least_comparable_fraction;
}

/// Returns the distance of a skeleton from the medians of the copies, see `Copy_descriptors`; above
/// 1, it is too large [-]. Infinite without a tree, 0 if the copies are not comparable.
template <class ConcurrencyTag>
double Resampled_session<ConcurrencyTag>::distance_from_copies(const Skeleton_report& r,
                                                               const Vec3& root) const
{
  if (r.status != Status::converged)
    return std::numeric_limits<double>::infinity();
  return are_comparable() ? m_copies.distance_from_medians(r, root) : 0;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESAMPLED_SESSION_IMPL_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Spread of the descriptors of a skeleton among resampled copies of its scan.

#ifndef PCS_SKELETON_ESTIMATE_SPREAD_H
#define PCS_SKELETON_ESTIMATE_SPREAD_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/median.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// A subset of the points of a scan, with their attributes.
struct Scan_copy
{
  std::vector<Vec3> points;
  std::vector<std::uint8_t> is_wood; ///< empty: unknown
  std::vector<long long> stations;   ///< empty: unknown
  std::vector<Vec3> normals;         ///< empty: unknown
};

/// Returns the probability that a copy of a scan of `n` points keeps a point [-].
inline double resampled_fraction(std::size_t n)
{
  constexpr double max_fraction = 0.9;
  constexpr double max_points = 40000; // enough for trunk and limbs, and fast
  return std::min(max_fraction, max_points / double(std::max<std::size_t>(n, 1)));
}

/*!
  Returns copies of a scan. Each copy keeps each point independently with the probability
  `resampled_fraction(n)`; the choice depends only on the indices of copy and point. Fewer than 100
  points give no copies. O(n) per copy.
*/
inline std::vector<Scan_copy> resample_scan(const std::vector<Vec3>& points,
                                            const std::vector<std::uint8_t>& is_wood,
                                            const std::vector<long long>& stations,
                                            std::size_t number_of_copies,
                                            const std::vector<Vec3>& normals = {})
{
  constexpr std::size_t min_points = 100;
  std::vector<Scan_copy> copies(points.size() < min_points ? 0 : number_of_copies);
  const double fraction = resampled_fraction(points.size());
  for (std::size_t k = 0; k < copies.size(); ++k)
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!(pcs::internal::Random_stream(k, i).uniform() < fraction))
        continue;
      copies[k].points.push_back(points[i]);
      if (!is_wood.empty())
        copies[k].is_wood.push_back(is_wood[i]);
      if (!stations.empty())
        copies[k].stations.push_back(stations[i]);
      if (!normals.empty())
        copies[k].normals.push_back(normals[i]);
    }
  return copies;
}

/// Displaces each coordinate by at most `largest` [L]. The displacements depend only on `seed` and
/// the indices of the points. O(n).
inline void displace_points(std::vector<Vec3>& points, double largest, std::uint64_t seed)
{
  for (std::size_t i = 0; i < points.size(); ++i) {
    pcs::internal::Random_stream random(seed, i);
    for (int k = 0; k < 3; ++k)
      points[i][k] += largest * (2 * random.uniform() - 1);
  }
}

namespace internal {

/// Returns the sample standard deviation.
inline double deviation(const std::vector<double>& values)
{
  const auto n = double(values.size());
  double mean = 0, square = 0;
  for (const double v : values)
    mean += v / n;
  for (const double v : values)
    square += (v - mean) * (v - mean);
  return n > 1 ? std::sqrt(square / (n - 1)) : 0;
}

/// The descriptors of the copies that have a tree.
struct Copied_figures
{
  std::vector<double> height, diameter, trunk, length, volume, trunk_volume;
  std::vector<std::vector<double>> by_size;
  std::vector<double> root[3];
  std::size_t number_of_leafy_copies = 0;

  void add(const Skeleton_report& r, const Vec3& root_position)
  {
    number_of_leafy_copies += r.number_of_leaf_points > 0;
    height.push_back(r.height);
    diameter.push_back(r.diameter_at_breast_height);
    trunk.push_back(r.by_order.empty() ? 0 : r.by_order.front().length);
    length.push_back(r.total.length);
    volume.push_back(r.total.volume);
    trunk_volume.push_back(r.by_order.empty() ? 0 : r.by_order.front().volume);
    by_size.resize(r.by_size.size());
    for (std::size_t k = 0; k < by_size.size(); ++k)
      by_size[k].push_back(r.by_size[k].volume);
    for (int k = 0; k < 3; ++k)
      root[k].push_back(root_position[k]);
  }

  /*!
    Returns how far the descriptors of a skeleton are from the medians of the copies and this
    skeleton: the largest difference in units of 1 % of the height, 2 % of the diameter at breast
    height, 5 % of the length of the trunk, 5 % of the volume, or 4 % of the breast height for the
    position of the root [-]. 0 without copies.
  */
  double distance_from_medians(const Skeleton_report& r, const Vec3& root_position) const
  {
    if (height.empty())
      return 0;
    double largest = 0;
    const auto compare = [&](std::vector<double> values, double value, double unit) {
      values.push_back(value);
      const double difference = std::abs(value - pcs::internal::lower_median(values));
      if (difference > 0)
        largest = std::max(largest, difference / unit);
    };
    const double trunk_length = r.by_order.empty() ? 0 : r.by_order.front().length;
    compare(height, r.height, 0.01 * r.height);
    compare(diameter, r.diameter_at_breast_height, 0.02 * r.diameter_at_breast_height);
    compare(trunk, trunk_length, 0.05 * trunk_length);
    compare(volume, r.total.volume, 0.05 * r.total.volume);
    for (int k = 0; k < 3; ++k)
      compare(root[k], root_position[k], 0.04 * r.breast_height);
    return largest;
  }

  Skeleton_spread spread() const
  {
    Skeleton_spread result;
    result.number_of_copies = height.size();
    result.number_of_leafy_copies = number_of_leafy_copies;
    result.height = deviation(height);
    result.diameter_at_breast_height = deviation(diameter);
    result.trunk_length = deviation(trunk);
    result.length = deviation(length);
    result.volume = deviation(volume);
    result.trunk_volume = deviation(trunk_volume);
    for (const std::vector<double>& volumes : by_size)
      result.volume_by_size.push_back(deviation(volumes));
    result.root = std::hypot(deviation(root[0]), deviation(root[1]), deviation(root[2]));
    return result;
  }
};

} // namespace internal

/*!
  Returns how leaves are to be treated according to a vote of a scan and its copies: `always` or
  `never` if the majority contradicts the scan, otherwise `where_found`.
  \param has_leaves whether leaves were found in the scan
*/
inline Leaf_removal majority_on_leaves(std::size_t number_of_copies,
                                       std::size_t number_of_leafy_copies,
                                       bool has_leaves)
{
  const std::size_t opposed =
      has_leaves ? number_of_copies - number_of_leafy_copies : number_of_leafy_copies;
  if (2 * opposed <= number_of_copies + 1)
    return Leaf_removal::where_found;
  return has_leaves ? Leaf_removal::never : Leaf_removal::always;
}

/// Skeletons of resampled copies of a scan. A cancelled call continues with the same copy.
template <class ConcurrencyTag>
class Spread_estimator
{
public:
  Spread_estimator() = default;
  Spread_estimator(std::vector<Scan_copy> copies, Session_hints hints)
    : m_copies(std::move(copies)), m_hints(std::move(hints)), m_count(m_copies.size())
  {
    m_hints.stations.clear(); // set for each copy, like the normals
    m_hints.normals.clear();
  }

  bool is_done() const { return m_copies.empty(); }

  /// Extracts the remaining skeletons. Returns `false` if `progress` stopped it.
  bool run(pcs::internal::Progress& progress)
  {
    for (; !m_copies.empty(); m_copies.pop_back()) {
      const double begin = double(m_count - m_copies.size());
      pcs::internal::Progress part(
          [&](double f) { return progress((begin + f) / double(m_count)); });
      Session_hints hints = m_hints;
      hints.stations = m_copies.back().stations;
      hints.normals = m_copies.back().normals;
      Session<ConcurrencyTag> session(m_copies.back().points, m_copies.back().is_wood, hints);
      if (!session.join(part))
        return false;
      if (session.report().status == Status::converged)
        m_figures.add(session.report(), root_of(session));
    }
    return true;
  }

  /// Returns how untypical a skeleton is of the copies: the largest difference from the medians, 1
  /// if the difference is just tolerable [-]. 0 if the copies are thinned, hence not comparable.
  double distance_from_copies(const Session<ConcurrencyTag>& session) const
  {
    const Skeleton_report& r = session.report();
    if (r.status != Status::converged)
      return std::numeric_limits<double>::infinity();
    if (resampled_fraction(r.number_of_points) < least_comparable_fraction)
      return 0;
    return m_figures.distance_from_medians(r, root_of(session));
  }

  /// Returns the vote of the scan and its copies on leaves, see `majority_on_leaves()`. Copies vote
  /// only if they have most of the points, since leaves are not recognized in thinned scans.
  Leaf_removal vote_on_leaves(bool has_leaves, std::size_t number_of_points) const
  {
    if (m_hints.leaf_removal != Leaf_removal::where_found ||
        resampled_fraction(number_of_points) < least_comparable_fraction)
      return Leaf_removal::where_found;
    return majority_on_leaves(m_figures.height.size(),
                              m_figures.number_of_leafy_copies,
                              has_leaves);
  }

  /// Returns the deviations among the completed copies.
  Skeleton_spread spread() const
  {
    Skeleton_spread result = m_figures.spread();
    result.number_of_empty_copies = m_count - m_copies.size() - result.number_of_copies;
    return result;
  }

private:
  /// Copies with a smaller fraction of the points are not compared with the scan [-].
  static constexpr double least_comparable_fraction = 0.5;

  /// Returns the root in the coordinates of the input.
  static Vec3 root_of(const Session<ConcurrencyTag>& session)
  {
    const Branch_tree& tree = session.tree();
    return session.scan().frame.to_input(tree.nodes[tree.branches.front().nodes.front()].point);
  }

  std::vector<Scan_copy> m_copies;
  Session_hints m_hints;
  std::size_t m_count = 0;
  internal::Copied_figures m_figures;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_ESTIMATE_SPREAD_H

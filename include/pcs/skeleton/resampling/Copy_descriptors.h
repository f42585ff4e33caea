// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Descriptors of the skeletons of resampled copies: deviations, medians, estimates, and the vote on
// leaves.

#ifndef PCS_SKELETON_RESAMPLING_COPY_DESCRIPTORS_H
#define PCS_SKELETON_RESAMPLING_COPY_DESCRIPTORS_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

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
struct Copy_descriptors
{
  std::vector<double> height, diameter, trunk, length, volume, trunk_volume;
  std::vector<std::vector<double>> by_size;
  std::vector<double> root[3];
  std::size_t number_of_leafy_copies = 0;

  std::size_t size() const { return height.size(); }

  void add(const Skeleton_report& r, const Vec3& root_position)
  {
    const Tree_values values = pcs::internal::values_of_skeleton(r);
    number_of_leafy_copies += r.number_of_leaf_points > 0;
    height.push_back(values.height);
    diameter.push_back(values.diameter_at_breast_height);
    trunk.push_back(values.trunk_length);
    length.push_back(values.length);
    volume.push_back(values.volume);
    trunk_volume.push_back(values.trunk_volume);
    by_size.resize(values.volume_by_size.size());
    for (std::size_t k = 0; k < by_size.size(); ++k)
      by_size[k].push_back(values.volume_by_size[k]);
    for (int k = 0; k < 3; ++k)
      root[k].push_back(root_position[k]);
  }

  /// Returns the medians of the values. For an even number of skeletons, a median is the mean of
  /// the two middle values.
  Tree_values estimates() const
  {
    const auto median = [](std::vector<double> values) {
      return pcs::internal::mean_median(values);
    };
    Tree_values v;
    v.height = median(height);
    v.diameter_at_breast_height = median(diameter);
    v.trunk_length = median(trunk);
    v.length = median(length);
    v.volume = median(volume);
    v.trunk_volume = median(trunk_volume);
    for (const std::vector<double>& volumes : by_size)
      v.volume_by_size.push_back(median(volumes));
    return v;
  }

  /*!
    Returns how far the descriptors of a skeleton are from the medians of the copies and this
    skeleton: the largest difference, in tolerances [-]. 0 without copies.
  */
  double distance_from_medians(const Skeleton_report& r, const Vec3& root_position) const
  {
    double largest = 0;
    for_each_tolerance(r,
                       root_position,
                       [&](std::vector<double> values, double value, double tolerance) {
                         values.push_back(value);
                         const double difference =
                             std::abs(value - pcs::internal::lower_median(values));
                         if (difference > 0)
                           largest = std::max(largest, difference / tolerance);
                       });
    return largest;
  }

  /*!
    Returns the largest standard error of the median of a descriptor, in tolerances [-]. It is
    `sqrt(pi / 2) s / sqrt(n)` for `n` copies with the standard deviation `s`. 0 without copies.
  */
  double error_of_medians(const Skeleton_report& r) const
  {
    double largest = 0;
    for_each_tolerance(r,
                       Vec3::Zero(),
                       [&](const std::vector<double>& values, double, double tolerance) {
                         const double s = deviation(values);
                         if (s > 0)
                           largest = std::max(largest,
                                              s / (tolerance * std::sqrt(double(values.size()))));
                       });
    return std::sqrt(pcs::internal::pi / 2) * largest;
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

private:
  /*!
    Calls `use(values of the copies, value of r, tolerance)` for each descriptor that is compared.
    The tolerances are 1 % of the height, 2 % of the diameter at breast height, 5 % of the length of
    the trunk and of the volume, and 4 % of the breast height for each coordinate of the root.
  */
  template <class Function>
  void
  for_each_tolerance(const Skeleton_report& r, const Vec3& root_position, const Function& use) const
  {
    if (height.empty())
      return;
    const double trunk_length = r.by_order.empty() ? 0 : r.by_order.front().length;
    use(height, r.height, 0.01 * r.height);
    use(diameter, r.diameter_at_breast_height, 0.02 * r.diameter_at_breast_height);
    use(trunk, trunk_length, 0.05 * trunk_length);
    use(volume, r.total.volume, 0.05 * r.total.volume);
    for (int k = 0; k < 3; ++k)
      use(root[k], root_position[k], 0.04 * r.breast_height);
  }
};

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

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESAMPLING_COPY_DESCRIPTORS_H

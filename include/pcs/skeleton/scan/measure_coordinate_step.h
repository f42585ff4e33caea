// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rounding of coordinates: the step of the lattice that all values of one axis lie on.

#ifndef PCS_SKELETON_SCAN_MEASURE_COORDINATE_STEP_H
#define PCS_SKELETON_SCAN_MEASURE_COORDINATE_STEP_H

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Rounding of the coordinates of a scan.
struct Coordinate_step
{
  double step = 0; ///< largest of the three axes; 0: no axis is rounded [L]
  //! whether the step is the resolution of 32-bit numbers at this distance from the origin
  bool is_single_precision = false;
};

namespace internal {

/*!
  Returns the step `s` of sorted values whose differences are all multiples of `s`, or 0.

  The smallest gap between different values is the candidate. It is the step if nearly all gaps are
  multiples of it, and if these multiples are small. Exact coordinates fail the second condition:
  the smallest gap of `m` uniform values is about `1 / m` of the mean gap.
*/
inline double step_of_sorted(const std::vector<double>& values)
{
  constexpr double tolerance = 0.02;    // of the step: rounding of the coordinates themselves [-]
  constexpr double min_fraction = 0.98; // of the gaps that are multiples [-]
  constexpr double max_mean_multiple = 50; // of the gaps, in steps; more are due to chance [-]
  // with fewer gaps, values must repeat more often than by chance [count]
  constexpr std::size_t min_gaps = 30, min_repeats = 100;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] > values[i - 1])
      gaps.push_back(values[i] - values[i - 1]);
  if (gaps.empty() || (gaps.size() < min_gaps && values.size() < min_repeats * (gaps.size() + 1)))
    return 0;
  const double step = *std::min_element(gaps.begin(), gaps.end());
  std::size_t count = 0;
  double sum = 0;
  for (const double gap : gaps) {
    const double multiple = gap / step;
    sum += multiple;
    count += std::abs(multiple - std::round(multiple)) <= tolerance;
  }
  const bool is_lattice = double(count) >= min_fraction * double(gaps.size()) &&
                          sum <= max_mean_multiple * double(gaps.size());
  return is_lattice ? step : 0;
}

} // namespace internal

/*!
  Measures the step to which the coordinates are rounded, from a sample of the points. `points` are
  in the coordinates of the input, since the resolution of 32-bit numbers depends on their size.
  O(m log m) for `m` sampled points.
*/
inline Coordinate_step measure_coordinate_step(const std::vector<Eigen::Vector3d>& points)
{
  constexpr std::size_t sample_size = 20000; // evenly spread over the input [count]
  constexpr double float_digits = 0x1p-24;   // unit in the last place, of the largest value [-]
  Coordinate_step result;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / sample_size);
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < points.size(); i += stride)
      values.push_back(points[i][axis]);
    std::sort(values.begin(), values.end());
    const double step = internal::step_of_sorted(values);
    if (!(step > result.step))
      continue;
    result.step = step;
    const double largest = std::max(std::abs(values.front()), std::abs(values.back()));
    const bool is_power_of_two = std::exp2(std::round(std::log2(step))) == step;
    result.is_single_precision = is_power_of_two && step >= largest * float_digits;
  }
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_MEASURE_COORDINATE_STEP_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Measures of the agreement of a skeleton with the true one, and the parameters of measuring.

#ifndef PCS_BENCHMARK_QUALITY_SKELETON_ACCURACY_H
#define PCS_BENCHMARK_QUALITY_SKELETON_ACCURACY_H

#include <cstddef>
#include <limits>
#include <vector>

namespace pcs_bench {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Lengths are in the unit of the trees; the default values assume metres.
struct Accuracy_rules
{
  double sampling_step = 0.01;                    ///< axes are cut into pieces of this length
  std::vector<double> tolerances = {0.01, 0.025}; ///< for precision and recall
  std::vector<double> radius_fractions = {0.25, 0.5, 1}; ///< as fractions of the true radius
  /// Radii are compared where the axes are nearer than max(`radius_match`, true radius / 2).
  double radius_match = 0.01;
  /// Lower bounds of the classes of radii, in decreasing order; smaller radii form the last class.
  std::vector<double> class_bounds = {0.05, 0.02, 0.01, 0.005};
  /// Branches match where their axes are nearer than max(`branch_match`, true radius / 2).
  double branch_match = 0.025;
  double breast_height = 1.3; ///< above the root of the true tree, along z
};

/// Fraction of the length of one tree that is within a distance of the other tree.
struct Agreement
{
  double tolerance = 0; ///< a length, or a fraction of the true radius
  double precision = 0; ///< fraction of the result that is near a true axis
  double recall = 0;    ///< fraction of the true axes with points that is near the result

  double f1() const
  {
    return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
  }
};

/// Distances of samples, weighted by length.
struct Distances
{
  double mean = no_value, median = no_value, rms = no_value, quantile_95 = no_value;
};

/// A class of radii. True axes are classified by the true radius, the result by its own radius.
struct Size_class
{
  double from = 0, to = 0;            ///< radii of the class [L]
  double true_length = 0, length = 0; ///< [L]
  double true_volume = 0, volume = 0; ///< sums of frusta [L^3]
  double seen_length = 0;             ///< part of `true_length` where the scan has points
  double matched_share = 0;           ///< fraction of `seen_length` where radii are compared
  double radius_error = no_value;     ///< median of |r - true r| / true r, where compared
  double radius_bias = no_value;      ///< median of (r - true r) / true r, where compared
  Agreement agreement;                ///< at the first tolerance
};

/// Branches of one order; the parts of a branch inside its parent are not counted.
struct Order_class
{
  std::size_t number_of_true_branches = 0;    ///< with points outside their parent
  std::size_t number_of_missed_branches = 0;  ///< of these, less than half found
  std::size_t number_of_branches = 0;         ///< of the result, by its own orders
  std::size_t number_of_false_branches = 0;   ///< of these, more than half without true axis
  std::size_t number_of_matched_branches = 0; ///< of the result, by the order of their true branch
  std::size_t number_of_correct_parents = 0;  ///< of `number_of_matched_branches`
  double matched_length = 0;                  ///< of `number_of_matched_branches` [L]
  double correct_length = 0;                  ///< of `number_of_correct_parents` [L]
};

struct Skeleton_accuracy
{
  std::vector<Agreement> at_distance; ///< one for each of `Accuracy_rules::tolerances`
  std::vector<Agreement> at_radius;   ///< one for each of `Accuracy_rules::radius_fractions`
  Distances to_truth;                 ///< from the result to the true axes [L]
  Distances to_result;                ///< from the true axes with points to the result [L]
  std::vector<Size_class> size_classes;
  std::vector<Order_class> order_classes; ///< by order, from 0

  double true_length = 0, seen_length = 0, length = 0;    ///< [L]
  double true_volume = 0, volume = 0;                     ///< sums of frusta [L^3]
  double true_dbh = no_value, dbh = no_value;             ///< diameters at breast height [L]
  double true_height = 0, height = 0;                     ///< extents along z [L]
  double radius_error = no_value, radius_bias = no_value; ///< as in `Size_class`, over all

  Distances point_to_surface; ///< from the given points to the result's surface [L]

  double length_error() const { return (length - true_length) / true_length; }
  double volume_error() const { return (volume - true_volume) / true_volume; }
  double dbh_error() const { return dbh - true_dbh; }
  /// Fraction of the matched branches that are children of the true parent or its continuation.
  double correct_parent_share() const
  {
    std::size_t matched = 0, correct = 0;
    for (const Order_class& c : order_classes) {
      matched += c.number_of_matched_branches;
      correct += c.number_of_correct_parents;
    }
    return matched > 0 ? static_cast<double>(correct) / static_cast<double>(matched) : no_value;
  }
};

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_SKELETON_ACCURACY_H

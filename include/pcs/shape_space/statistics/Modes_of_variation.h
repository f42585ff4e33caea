// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Modes of variation of a family, and scores of its trees.

#ifndef PCS_SHAPE_SPACE_STATISTICS_MODES_OF_VARIATION_H
#define PCS_SHAPE_SPACE_STATISTICS_MODES_OF_VARIATION_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/median.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

/// The space of modes in features of trees.
struct Mode_features
{
  Mode_inner_product measure = Mode_inner_product::branches;
  Eigen::VectorXd mean;                 ///< [L]
  Eigen::MatrixXd directions;           ///< per standard deviation of each mode (column) [L]
  std::vector<double> weight, variance; ///< per block, see `Tree_covariance`
  double least_deviation = 0;           ///< smaller deviations are rounding [L]
};

/// Coordinates of a tree in the space of the modes.
struct Mode_coordinates
{
  Eigen::VectorXd scores; ///< in standard deviations [-]
  /// Distance from the space of the modes: root of the mean square over the branches of the tree,
  /// each in units of its standard deviation; the inputs have the distance 1 from their mean. [-]
  double distance = 0;
};

/// Directions in which trees differ most, at their mean.
struct Modes_of_variation
{
  Orl_coordinates mean;       ///< least squares
  Eigen::MatrixXd directions; ///< tangent vectors at the mean, one column per mode, of unit length
  Eigen::VectorXd deviations; ///< change of a tree by one standard deviation of each mode [L]
  Eigen::VectorXd shares;     ///< fractions of the variance, largest first [-]
  Eigen::MatrixXd scores;     ///< of each tree (row) for each mode, in standard deviations [-]
  Eigen::VectorXd center; ///< mean of the tangent vectors; 0 up to rounding if the mean is exact
  Mode_features features;
  /// Distance of each tree from the space of k modes of all others; empty for fewer than three
  /// trees. [-]
  std::vector<std::vector<double>> left_out;

  std::size_t size() const { return static_cast<std::size_t>(deviations.size()); }
  /// Returns the fraction of the variance that the first `k` modes explain. [-]
  double share(std::size_t k) const
  {
    return size() > 0 ? shares.head(static_cast<Eigen::Index>(std::min(k, size()))).sum() : 1;
  }
  /// Returns the root of the mean square of the left-out distances for `k` modes of the others; NaN
  /// for fewer than three trees, of which none can be left out. [-]
  double left_out_error(std::size_t k) const
  {
    double sum = 0;
    for (const auto& d : left_out)
      sum += d[std::min(k, d.size() - 1)] * d[std::min(k, d.size() - 1)];
    return left_out.empty() ? std::numeric_limits<double>::quiet_NaN()
                            : std::sqrt(sum / static_cast<double>(left_out.size()));
  }
};

/*!
  Returns the dissimilarity of a tree to the trees of the modes: the root of the mean of two
  squares. The first is the mean square of the scores, the second the squared distance from the
  space of the modes in units of the median left-out distance. The dissimilarity is about 1 for a
  tree of the same kind. Without modes or spread, it is 0 for the mean and infinite for all other
  trees. [-]
*/
inline double outlier_score(const Modes_of_variation& modes, const Mode_coordinates& at)
{
  const double inside =
      at.scores.size() > 0 ? at.scores.squaredNorm() / static_cast<double>(at.scores.size()) : 0;
  if (at.distance <= 1e-9) // rounding
    return std::sqrt(0.5 * inside);
  std::vector<double> usual;
  for (const auto& d : modes.left_out)
    usual.push_back(d[std::min(modes.size(), d.size() - 1)]);
  const double scale = usual.empty() ? 1 : pcs::internal::upper_median(usual);
  const double outside = at.distance / scale; // infinite without spread
  return std::sqrt(0.5 * (inside + outside * outside));
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_MODES_OF_VARIATION_H

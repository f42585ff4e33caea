// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How trees differ from their mean: principal directions in the tangent space there.

#ifndef PCS_SHAPE_SPACE_MODES_OF_VARIATION_H
#define PCS_SHAPE_SPACE_MODES_OF_VARIATION_H

#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/shape_space/Orl_coordinates.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  The tangent space at a tree. A vector has three coordinates per edge for its turn, one for its length and one for its
  radius, then per branch the radius at the base and the attachment, each times its weight in the metric: its length is
  the distance `Orl_metric::square` from the base, but for the root, which has no part: where a tree stands is not its
  shape.
*/
class Tangent_space
{
public:
  Tangent_space() = default;
  Tangent_space(const Orl_layout& layout, const Orl_coordinates& base, const Orl_weights& weights)
    : m_layout(&layout), m_base(base), m_weights(&weights)
  {
  }

  const Orl_coordinates& base() const { return m_base; }
  Eigen::Index dimension() const
  {
    return static_cast<Eigen::Index>(5 * m_layout->number_of_edges() +
                                     2 * m_layout->branches.size());
  }

  Eigen::VectorXd log(const Orl_coordinates& x) const
  {
    const std::size_t n = x.length.size(), m = x.attachment.size();
    Eigen::VectorXd z(dimension());
    Eigen::Index k = 0;
    for (std::size_t e = 0; e < n; ++e) {
      z.segment<3>(k) = m_weights->orientation[e] *
                        rotation_log(m_base.orientation[e].conjugate() * x.orientation[e]);
      z[k + 3] = m_weights->length[e] * (x.length[e] - m_base.length[e]);
      z[k + 4] = m_weights->radius[e] * (x.radius[e] - m_base.radius[e]);
      k += 5;
    }
    for (std::size_t b = 0; b < m; ++b, k += 2) {
      z[k] = m_weights->base_radius[b] * (x.base_radius[b] - m_base.base_radius[b]);
      z[k + 1] = m_weights->attachment[b] * (x.attachment[b] - m_base.attachment[b]);
    }
    return z;
  }

  /// The tree at the end of a tangent vector. Lengths and radii end at 0, turns at pi, attachments on the parent.
  Orl_coordinates exp(const Eigen::VectorXd& z) const
  {
    Orl_coordinates x = m_base;
    const std::size_t n = x.length.size(), m = x.attachment.size();
    const auto over = [](double value, double weight) { return weight > 0 ? value / weight : 0; };
    Eigen::Index k = 0;
    for (std::size_t e = 0; e < n; ++e, k += 5) {
      Vec3 u = m_weights->orientation[e] > 0 ? Vec3(z.segment<3>(k) / m_weights->orientation[e])
                                             : Vec3(Vec3::Zero());
      constexpr double pi = static_cast<double>(EIGEN_PI);
      if (u.norm() > pi)
        u *= pi / u.norm();
      x.orientation[e] = m_base.orientation[e] * rotation_exp(u);
      x.orientation[e].normalize();
      x.length[e] = std::max(0.0, x.length[e] + over(z[k + 3], m_weights->length[e]));
      x.radius[e] = std::max(0.0, x.radius[e] + over(z[k + 4], m_weights->radius[e]));
    }
    for (std::size_t b = 0; b < m; ++b, k += 2) {
      x.base_radius[b] = std::max(0.0, x.base_radius[b] + over(z[k], m_weights->base_radius[b]));
      const std::size_t p = m_layout->branches[b].parent;
      const double last =
          p == none ? 0 : static_cast<double>(m_layout->branches[p].number_of_edges);
      const double place = x.attachment[b] + over(z[k + 1], m_weights->attachment[b]);
      x.attachment[b] = std::min(last, std::max(0.0, place));
    }
    return x;
  }

private:
  const Orl_layout* m_layout = nullptr;
  Orl_coordinates m_base;
  const Orl_weights* m_weights = nullptr;
};

/// Eigenvectors of the centred products of `n` vectors that belong to eigenvalues above rounding and `least`, largest
/// first.
struct Gram_modes
{
  Eigen::MatrixXd vectors; ///< n x k, of unit length
  Eigen::VectorXd values;  ///< k, eigenvalues
};

inline Gram_modes gram_modes(const Eigen::MatrixXd& gram, std::size_t most, double least = 0)
{
  const Eigen::Index n = gram.rows();
  const Eigen::MatrixXd center =
      Eigen::MatrixXd::Identity(n, n) - Eigen::MatrixXd::Constant(n, n, 1 / static_cast<double>(n));
  const auto eigen = linear_algebra::symmetric_eigen<Eigen::Dynamic>(center * gram * center);
  Gram_modes result;
  const double largest = n > 0 ? std::max(0.0, eigen.values[n - 1]) : 0;
  Eigen::Index k = 0;
  while (k < n - 1 && k < static_cast<Eigen::Index>(most) && largest > 0 &&
         eigen.values[n - 1 - k] > std::max(least, 1e-12 * largest))
    ++k;
  result.vectors = eigen.vectors.rightCols(k).rowwise().reverse();
  result.values = eigen.values.tail(k).reverse();
  return result;
}

/*!
  Distances of trees from the space of `k` modes of all others, for k = 0, 1, ...; each is left out in turn. `gram` has the
  products of the tangent vectors of all trees. Element `[i][k]`. [L]
*/
inline std::vector<std::vector<double>> left_out_distances(const Eigen::MatrixXd& gram,
                                                           std::size_t most)
{
  const Eigen::Index n = gram.rows();
  std::vector<std::vector<double>> result;
  for (Eigen::Index i = 0; i < n; ++i) {
    std::vector<Eigen::Index> others;
    for (Eigen::Index j = 0; j < n; ++j)
      if (j != i)
        others.push_back(j);
    const Eigen::Index m = n - 1;
    Eigen::MatrixXd sub(m, m);
    Eigen::VectorXd cross(m);
    for (Eigen::Index a = 0; a < m; ++a) {
      cross[a] = gram(i, others[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < m; ++b)
        sub(a, b) = gram(others[static_cast<std::size_t>(a)], others[static_cast<std::size_t>(b)]);
    }
    const Gram_modes modes = gram_modes(sub, most);
    // products of (z_i - mean of the others) with (z_j - mean)
    const Eigen::VectorXd to_mean = sub.rowwise().mean();
    const double mean_mean = to_mean.mean();
    const Eigen::VectorXd product = cross.array() - cross.mean() - to_mean.array() + mean_mean;
    double rest = gram(i, i) - 2 * cross.mean() + mean_mean;
    std::vector<double> distances{std::sqrt(std::max(0.0, rest))};
    for (Eigen::Index k = 0; k < modes.values.size(); ++k) {
      const double c = modes.vectors.col(k).dot(product);
      rest -= c * c / modes.values[k];
      distances.push_back(std::sqrt(std::max(0.0, rest)));
    }
    result.push_back(std::move(distances));
  }
  return result;
}

/// Directions in which trees differ most, at their mean.
struct Modes_of_variation
{
  Orl_coordinates mean;       ///< least squares
  Eigen::MatrixXd directions; ///< one column per mode, of unit length
  Eigen::VectorXd deviations; ///< standard deviation of each mode, largest first [L]
  Eigen::MatrixXd scores;     ///< of each tree (row) for each mode, in standard deviations [-]
  Eigen::VectorXd center;     ///< mean of the tangent vectors; rounding if the mean is exact
  double total_variance = 0;  ///< of all modes, also of those that were not asked for [L^2]
  std::vector<std::vector<double>>
      left_out; ///< distance of each tree from the space of k modes of all others [L]

  std::size_t size() const { return static_cast<std::size_t>(deviations.size()); }
  /// Share of the variance that the first `k` modes have. [-]
  double share(std::size_t k) const
  {
    return total_variance > 0
               ? deviations.head(static_cast<Eigen::Index>(k)).squaredNorm() / total_variance
               : 1;
  }
  /// Root of the mean square of the left-out distances for `k` modes of the others. [L]
  double left_out_error(std::size_t k) const
  {
    double sum = 0;
    for (const auto& d : left_out)
      sum += d[std::min(k, d.size() - 1)] * d[std::min(k, d.size() - 1)];
    return left_out.empty() ? 0 : std::sqrt(sum / static_cast<double>(left_out.size()));
  }
};

/// At most `most` modes; fewer if the trees do not have so many. The sign of a mode is such that its largest coordinate is
/// positive.
template <class ConcurrencyTag>
Modes_of_variation find_modes(const Orl_layout& layout,
                              const std::vector<const Orl_coordinates*>& trees,
                              const Orl_weights& weights,
                              const Orl_coordinates& mean,
                              std::size_t most)
{
  const Tangent_space tangent(layout, mean, weights);
  const auto n = static_cast<Eigen::Index>(trees.size());
  Eigen::MatrixXd z(tangent.dimension(), n);
  pcs::internal::for_each_index<ConcurrencyTag>(
      trees.size(),
      [&](std::size_t i) { z.col(static_cast<Eigen::Index>(i)) = tangent.log(*trees[i]); },
      1);
  Modes_of_variation result;
  result.mean = mean;
  result.center = z.rowwise().mean();
  z.colwise() -= result.center;
  const Eigen::MatrixXd gram = z.transpose() * z;
  double size = 0;
  for (const double length : mean.length)
    size += length;
  const Gram_modes modes = gram_modes(gram, most, std::pow(1e-9 * size, 2)); // equal trees
  const double divisor = std::max(1.0, static_cast<double>(n - 1));
  result.total_variance = gram.trace() / divisor;
  result.directions.resize(tangent.dimension(), modes.values.size());
  result.deviations = (modes.values / divisor).cwiseSqrt();
  result.scores.resize(n, modes.values.size());
  for (Eigen::Index k = 0; k < modes.values.size(); ++k) {
    Eigen::VectorXd u = z * modes.vectors.col(k);
    u.normalize();
    Eigen::Index largest = 0;
    u.cwiseAbs().maxCoeff(&largest);
    if (u[largest] < 0)
      u = -u;
    result.directions.col(k) = u;
    result.scores.col(k) = z.transpose() * u / result.deviations[k];
  }
  if (n > 2)
    result.left_out = left_out_distances(gram, most);
  return result;
}

/// Where a tree lies in the space of the modes.
struct Mode_coordinates
{
  Eigen::VectorXd scores; ///< in standard deviations [-]
  double distance = 0;    ///< from the space of the modes [L]
};

inline Mode_coordinates project_on_modes(const Orl_layout& layout,
                                         const Orl_weights& weights,
                                         const Modes_of_variation& modes,
                                         const Orl_coordinates& x)
{
  const Tangent_space tangent(layout, modes.mean, weights);
  const Eigen::VectorXd z = tangent.log(x) - modes.center;
  const Eigen::VectorXd c = modes.directions.transpose() * z;
  Mode_coordinates result;
  result.distance = (z - modes.directions * c).norm();
  result.scores = c.cwiseQuotient(modes.deviations);
  return result;
}

/// The tree with given scores; missing ones are 0.
inline Orl_coordinates tree_of_modes(const Orl_layout& layout,
                                     const Orl_weights& weights,
                                     const Modes_of_variation& modes,
                                     const std::vector<double>& scores)
{
  const Tangent_space tangent(layout, modes.mean, weights);
  Eigen::VectorXd z = modes.center;
  for (std::size_t k = 0; k < scores.size() && k < modes.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    z += scores[k] * modes.deviations[i] * modes.directions.col(i);
  }
  return tangent.exp(z);
}

/*!
  How unlike the trees of the modes a tree is: the root of the mean of two squares, of its scores and of its distance from
  the space of the modes, over the middle one of the trees themselves when left out. About 1 for a tree of the same
  kind; without modes or spread, 0 for the mean and infinite for all others. [-]
*/
inline double outlier_score(const Modes_of_variation& modes, const Mode_coordinates& at)
{
  const double inside =
      at.scores.size() > 0 ? at.scores.squaredNorm() / static_cast<double>(at.scores.size()) : 0;
  std::vector<double> usual;
  for (const auto& d : modes.left_out)
    usual.push_back(d[std::min(modes.size(), d.size() - 1)]);
  std::sort(usual.begin(), usual.end());
  const double scale = usual.empty() ? std::sqrt(modes.total_variance) : usual[usual.size() / 2];
  double size = 0;
  for (const double length : modes.mean.length)
    size += length;
  if (at.distance <= 1e-9 * size) // rounding
    return std::sqrt(0.5 * inside);
  const double outside = at.distance / scale; // infinite without spread
  return std::sqrt(0.5 * (inside + outside * outside));
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODES_OF_VARIATION_H

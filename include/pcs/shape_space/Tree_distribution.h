// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A distribution of trees, learned from a few, and new trees drawn from it.

#ifndef PCS_SHAPE_SPACE_TREE_DISTRIBUTION_H
#define PCS_SHAPE_SPACE_TREE_DISTRIBUTION_H

#include <pcs/internal/Random_stream.h>
#include <pcs/shape_space/mean_tree.h>
#include <pcs/shape_space/modes_of_variation.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// How new trees are drawn.
struct Sampling_options
{
  double truncation = 2.5; ///< no score is further from 0, in standard deviations [-]
  double spread = 1;       ///< factor of all standard deviations; 0 gives middle trees only [-]
  /// share of the variance that is drawn for each branch by itself, and not in the modes of the inputs, in [0, 1];
  /// negative: as estimated from the inputs
  double shrinkage = -1;
  bool do_draw_presence = true; ///< else all trees have the branches that most of the inputs have
  bool do_keep_in_range =
      true; ///< whether trees beyond the inputs in one of their figures are drawn again
  std::size_t number_of_trials = 100; ///< for that
  bool do_limit_radii = false;        ///< no branch thicker than where it grows from
  double pipe_exponent =
      0; ///< > 0: radii to this power do not add up to more than that of the parent; 2 to 2.5 in nature
};

/*!
  A Gaussian in a tangent space where lengths and radii are logarithms, so that they stay positive, and a chance for each
  branch to be there if its parent is. Values of branches that an input lacks are unknown, not 0: they count as those of
  the mean, and the deviations of the others are scaled up for it. For few trees the covariance is shrunk towards one where
  branches vary by themselves (O. Ledoit, M. Wolf 2003; J. Schaefer, K. Strimmer 2005); variances of branches that few
  trees have are drawn to those of all branches of their order.
*/
class Tree_distribution
{
public:
  /// `has[t][b]`: whether tree `t` has branch `b`.
  template <class ConcurrencyTag>
  Tree_distribution(const Orl_layout& layout,
                    const std::vector<const Orl_coordinates*>& trees,
                    const std::vector<std::vector<char>>& has,
                    ConcurrencyTag)
    : m_layout(layout), m_has(has)
  {
    const std::size_t m = layout.branches.size();
    m_count.assign(m, 0);
    m_order.assign(m, 0);
    for (std::size_t b = 0; b < m; ++b) {
      for (std::size_t t = 0; t < trees.size(); ++t)
        m_count[b] += has[t][b] ? 1 : 0;
      if (layout.branches[b].parent != none)
        m_order[b] = m_order[layout.branches[b].parent] + 1;
    }
    find_middle<ConcurrencyTag>(trees);
    find_covariance(trees);
  }

  double shrinkage() const { return m_shrinkage; }

  /// The tree number `index` of a family: the same for the same seed, whatever else is drawn.
  Orl_coordinates draw(std::uint64_t seed, std::uint64_t index, const Sampling_options& o) const
  {
    pcs::internal::Random_stream random(seed, index);
    const auto normal = [&] {
      double x = random.normal();
      for (int i = 0; i < 1000 && std::abs(x) > o.truncation; ++i)
        x = random.normal();
      return std::min(o.truncation, std::max(-o.truncation, x));
    };
    const double shrinkage = o.shrinkage < 0 ? m_shrinkage : o.shrinkage;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(m_scale.size());
    for (Eigen::Index k = 0; k < m_modes.cols(); ++k)
      z += normal() * m_modes.col(k);
    z = std::sqrt(1 - shrinkage) * z.cwiseProduct(m_scale);
    const double own = std::sqrt(shrinkage);
    Orl_coordinates x = m_middle;
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      // lengths and radii of a branch vary together: its edges are no things of their own
      const double length_score = own * normal(), radius_score = own * normal();
      const std::size_t parent = branch.parent;
      const double base_z = z[base(b)] + radius_score * m_own[base(b)];
      const double place_z = z[base(b) + 1] + own * normal() * m_own[base(b) + 1];
      const double chance = parent == none ? 1 : m_count[b] / m_count[parent];
      const bool is_usual = 2 * m_count[b] > static_cast<double>(m_has.size());
      const bool is_there =
          parent == none || (o.do_draw_presence ? random.uniform() < chance : is_usual);
      double total = 0;
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        const Eigen::Index k = 5 * static_cast<Eigen::Index>(e);
        Vec3 u;
        for (Eigen::Index i = 0; i < 3; ++i)
          u[i] = o.spread * (z[k + i] + own * normal() * m_own[k + i]);
        constexpr double pi = static_cast<double>(EIGEN_PI);
        if (u.norm() > pi)
          u *= pi / u.norm();
        x.orientation[e] = m_middle.orientation[e] * rotation_exp(u);
        x.orientation[e].normalize();
        const bool is_kept = is_there && (parent == none || is_drawn_there(x, parent));
        x.length[e] = is_kept ? m_middle.length[e] *
                                    std::exp(o.spread * (z[k + 3] + length_score * m_own[k + 3]))
                              : 0;
        x.radius[e] = is_kept ? m_middle.radius[e] *
                                    std::exp(o.spread * (z[k + 4] + radius_score * m_own[k + 4]))
                              : 0;
        total += x.length[e];
      }
      x.base_radius[b] = total > 0 ? m_middle.base_radius[b] * std::exp(o.spread * base_z) : 0;
      if (parent != none) {
        const auto last = static_cast<double>(m_layout.branches[parent].number_of_edges);
        x.attachment[b] =
            std::min(last, std::max(0.0, m_middle.attachment[b] + o.spread * place_z));
      }
    }
    return x;
  }

private:
  Eigen::Index base(std::size_t b) const
  {
    return static_cast<Eigen::Index>(5 * m_layout.number_of_edges() + 2 * b);
  }
  bool is_drawn_there(const Orl_coordinates& x, std::size_t b) const
  {
    return x.length[m_layout.branches[b].first_edge] > 0;
  }

  /// Radii that are not known are 0, and stay so.
  static double log_ratio(double value, double middle)
  {
    constexpr double least = 1e-6;
    return middle > 0 ? std::log(std::max(value, least * middle) / middle) : 0;
  }

  /// Middle of the trees that have each branch: geometric means, Frechet means of orientations.
  template <class ConcurrencyTag>
  void find_middle(const std::vector<const Orl_coordinates*>& trees)
  {
    std::vector<double> ones(trees.size(), 1);
    m_middle = mean_tree<ConcurrencyTag>(m_layout, trees, ones, Tree_mean::least_squares);
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_layout.branches.size(),
        [&](std::size_t b) {
          std::vector<const Orl_coordinates*> members;
          for (std::size_t t = 0; t < trees.size(); ++t)
            if (m_has[t][b])
              members.push_back(trees[t]);
          const auto n = static_cast<double>(members.size());
          const auto geometric = [&](const auto& get) {
            double sum = 0;
            for (const Orl_coordinates* x : members) {
              if (!(get(*x) > 0))
                return 0.0;
              sum += std::log(get(*x));
            }
            return std::exp(sum / n);
          };
          m_middle.base_radius[b] = geometric([&](const auto& x) { return x.base_radius[b]; });
          m_middle.attachment[b] = 0;
          for (const Orl_coordinates* x : members)
            m_middle.attachment[b] += x->attachment[b] / n;
          const Orl_layout::Branch& branch = m_layout.branches[b];
          std::vector<Quaternion> q(members.size());
          for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges;
               ++e) {
            m_middle.length[e] = geometric([&](const auto& x) { return x.length[e]; });
            m_middle.radius[e] = geometric([&](const auto& x) { return x.radius[e]; });
            for (std::size_t i = 0; i < members.size(); ++i)
              q[i] = members[i]->orientation[e];
            m_middle.orientation[e] = l2_mean_rotation(q, std::vector<double>(q.size(), 1));
          }
        },
        8);
  }

  Eigen::VectorXd log(const Orl_coordinates& x, const std::vector<char>& has) const
  {
    Eigen::VectorXd z = Eigen::VectorXd::Zero(base(m_layout.branches.size()));
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      if (!has[b])
        continue;
      const Orl_layout::Branch& branch = m_layout.branches[b];
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        const Eigen::Index k = 5 * static_cast<Eigen::Index>(e);
        z.segment<3>(k) = rotation_log(m_middle.orientation[e].conjugate() * x.orientation[e]);
        z[k + 3] = log_ratio(x.length[e], m_middle.length[e]);
        z[k + 4] = log_ratio(x.radius[e], m_middle.radius[e]);
      }
      z[base(b)] = log_ratio(x.base_radius[b], m_middle.base_radius[b]);
      z[base(b) + 1] = x.attachment[b] - m_middle.attachment[b];
    }
    return z;
  }

  void find_covariance(const std::vector<const Orl_coordinates*>& trees)
  {
    const auto n = static_cast<Eigen::Index>(trees.size());
    const Eigen::Index d = base(m_layout.branches.size());
    Eigen::MatrixXd z(d, n);
    for (Eigen::Index i = 0; i < n; ++i)
      z.col(i) = log(*trees[static_cast<std::size_t>(i)], m_has[static_cast<std::size_t>(i)]);
    // coordinates that few trees have vary too little: unknown values are 0
    m_scale.resize(d);
    std::vector<double> count(static_cast<std::size_t>(d));
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      const double f = std::sqrt((static_cast<double>(n) - 1) / std::max(1.0, m_count[b] - 1));
      const auto set = [&](Eigen::Index k) {
        m_scale[k] = f;
        count[static_cast<std::size_t>(k)] = m_count[b];
      };
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e)
        for (Eigen::Index i = 0; i < 5; ++i)
          set(5 * static_cast<Eigen::Index>(e) + i);
      set(base(b));
      set(base(b) + 1);
    }
    const double divisor = std::max(1.0, static_cast<double>(n - 1));
    const Eigen::VectorXd variance = z.rowwise().squaredNorm() / divisor;
    m_own = (variance.array() * m_scale.array().square()).matrix();
    pool_variances(count);
    m_own = m_own.cwiseSqrt();
    // units: a turn counts with the length it carries, a logarithm with the length or radius itself
    Eigen::VectorXd unit = Eigen::VectorXd::Ones(d);
    for (std::size_t e = 0; e < m_layout.number_of_edges(); ++e) {
      const Eigen::Index k = 5 * static_cast<Eigen::Index>(e);
      unit.segment<4>(k).setConstant(m_middle.length[e]);
      unit[k + 4] = m_middle.radius[e];
    }
    const double typical = std::max(1e-300, unit.head(d - unit_tail()).mean());
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      unit[base(b)] = m_middle.base_radius[b];
      unit[base(b) + 1] = typical;
    }
    const Eigen::MatrixXd weighted = unit.asDiagonal() * z;
    const Eigen::MatrixXd gram = weighted.transpose() * weighted;
    m_shrinkage = n > 2 ? estimate_shrinkage(weighted, gram) : 0.5;
    const Gram_modes modes = gram_modes(gram, trees.size());
    // column k: the mode times its standard deviation, in coordinates without units
    m_modes = z * modes.vectors / std::sqrt(divisor);
    const Eigen::VectorXd mean = z.rowwise().mean();
    for (Eigen::Index k = 0; k < m_modes.cols(); ++k)
      m_modes.col(k) -= mean * modes.vectors.col(k).sum() / std::sqrt(divisor);
  }

  Eigen::Index unit_tail() const { return 2 * static_cast<Eigen::Index>(m_layout.branches.size()); }

  /// Variances as if each branch had two more members that vary like all branches of its order.
  void pool_variances(const std::vector<double>& count)
  {
    constexpr double prior = 2;
    using Pool =
        Eigen::Matrix<double, 12, 1>; // first edges, which turn the branch; other edges; branches
    std::vector<Pool> sum, weight;
    const auto visit = [&](const auto& f) {
      for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
        const Orl_layout::Branch& branch = m_layout.branches[b];
        for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e)
          for (Eigen::Index i = 0; i < 5; ++i)
            f(b, 5 * static_cast<Eigen::Index>(e) + i, e == branch.first_edge ? i : i + 5);
        f(b, base(b), 10);
        f(b, base(b) + 1, 11);
      }
    };
    const std::size_t orders = 1 + *std::max_element(m_order.begin(), m_order.end());
    sum.assign(orders, Pool::Zero());
    weight = sum;
    visit([&](std::size_t b, Eigen::Index k, Eigen::Index i) {
      const double w = count[static_cast<std::size_t>(k)] - 1;
      sum[m_order[b]][i] += w * m_own[k];
      weight[m_order[b]][i] += w;
    });
    visit([&](std::size_t b, Eigen::Index k, Eigen::Index i) {
      const double w = count[static_cast<std::size_t>(k)] - 1, all = weight[m_order[b]][i];
      if (all > 0)
        m_own[k] = (w * m_own[k] + prior * sum[m_order[b]][i] / all) / (w + prior);
    });
  }

  /// The share that makes the expected error of the covariance least, from products of the data only.
  static double estimate_shrinkage(const Eigen::MatrixXd& z, const Eigen::MatrixXd& gram)
  {
    const auto n = static_cast<double>(z.cols());
    const double all = gram.squaredNorm() / (n * n); // sum of squares of the mean products
    double fourth = 0;
    for (Eigen::Index k = 0; k < z.cols(); ++k)
      fourth += gram(k, k) * gram(k, k);
    const double diagonal_fourth = z.array().pow(4).sum();
    double diagonal = 0;
    for (Eigen::Index i = 0; i < z.rows(); ++i) {
      const double mean_square = z.row(i).squaredNorm() / n;
      diagonal += mean_square * mean_square;
    }
    // sums over pairs of different coordinates
    const double squares = all - diagonal;
    const double noise = ((fourth - diagonal_fourth) / n - squares) / (n - 1);
    return squares > 0 ? std::min(1.0, std::max(0.0, noise / squares)) : 0;
  }

  Orl_layout m_layout;
  std::vector<std::vector<char>> m_has;
  std::vector<double> m_count; // trees that have each branch
  std::vector<std::size_t> m_order;
  Orl_coordinates m_middle;
  Eigen::MatrixXd m_modes;
  Eigen::VectorXd m_scale, m_own;
  double m_shrinkage = 0;
};

/// Makes radii fit at forks: those of branches, to a power, do not add up to more than that of the parent below them.
inline void limit_pipes(const Orl_layout& layout, double exponent, Orl_coordinates& x)
{
  std::vector<std::vector<std::size_t>> children(layout.branches.size());
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    if (layout.branches[b].parent != none)
      children[layout.branches[b].parent].push_back(b);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    std::vector<std::size_t> order = children[b];
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t c) {
      return x.attachment[a] != x.attachment[c] ? x.attachment[a] < x.attachment[c] : a < c;
    });
    // from the base to the tip: what is left of the pipe, and of that the share of each branch
    std::size_t next = 0;
    for (std::size_t k = 0; k < branch.number_of_edges; ++k) {
      const double before = k == 0 ? x.base_radius[b] : x.radius[branch.first_edge + k - 1];
      double& after = x.radius[branch.first_edge + k];
      after = std::min(after, before);
      const std::size_t begin = next;
      double taken = std::pow(after, exponent);
      while (next < order.size() && (x.attachment[order[next]] <= static_cast<double>(k + 1) ||
                                     k + 1 == branch.number_of_edges))
        taken += std::pow(x.base_radius[order[next++]], exponent);
      const double available = std::pow(before, exponent);
      if (next == begin || !(taken > available))
        continue;
      const double f = std::pow(available / taken, 1 / exponent);
      after *= f;
      for (std::size_t i = begin; i < next; ++i) {
        x.base_radius[order[i]] *= f;
        for (std::size_t j = 0; j < layout.branches[order[i]].number_of_edges; ++j)
          x.radius[layout.branches[order[i]].first_edge + j] *= f;
      }
    }
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TREE_DISTRIBUTION_H

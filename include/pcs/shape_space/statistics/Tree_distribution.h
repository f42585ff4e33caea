// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Distribution of trees, estimated from a family, and random trees drawn from it.

#ifndef PCS_SHAPE_SPACE_STATISTICS_TREE_DISTRIBUTION_H
#define PCS_SHAPE_SPACE_STATISTICS_TREE_DISTRIBUTION_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/shape_space/statistics/Direction_chart.h>
#include <pcs/shape_space/statistics/mean_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  A Gaussian distribution of trees. Each branch has a probability to exist if its parent exists.
  Lengths and radii are represented by logarithms, so that they remain positive. Directions are
  represented by a `Direction_chart`, so that the slants of random branches vary as in the inputs.

  The coordinates of an edge are two angles of direction [rad] and the logarithms of length and
  radius relative to the mean tree [-]. The coordinates of a branch are the logarithm of the radius
  at its base [-] and the difference of its attachment [edges of the parent], also relative to the
  mean tree. `D_tb` is the vector of the coordinates of branch `b` and its edges in tree `t` of `n`;
  it is zero if the tree lacks the branch. `m_b` is the number of trees with branch `b`. With
  independent normal random numbers `g`, `h`, `k` of unit variance, the coordinates of branch `b` of
  a random tree are

      z_b = sqrt((1 - a) / (m_b - 1)) sum_t g_t D_tb
          + sqrt(a / (m_b + 1)) (sum_t h_tb D_tb + sqrt(2) sum_{i=1..6} k_ib P_i)

  There are six kinds of coordinates: four of edges and two of branches. `P_i` changes kind `i` of a
  whole branch by the standard deviation of this kind over the branches of the same order. In the
  first denominator, `m_b - 1` is replaced by 1 if it is 0. With
  `S_b = sum_t D_tb D_tb^T / (m_b - 1)` and `P = sum_i P_i P_i^T`, the covariances are

      (1 - a) S_b + a ((m_b - 1) S_b + 2 P) / (m_b + 1)               within a branch,
      (1 - a) sum_t D_tb D_tc^T / sqrt((m_b - 1) (m_c - 1))           between two branches.

  These covariances do not include the truncation of the normal numbers and the factor `spread` of
  `z`, which `draw()` applies.

  The shrinkage `a` [-] minimises the expected squared error of the covariances between branches (O.
  Ledoit, M. Wolf 2003; J. Schaefer, K. Strimmer 2005). The target of the shrinkage is
  block-diagonal, with one block per branch. The sums are over all pairs `i`, `j` of coordinates of
  different branches, converted to lengths [L]:

      a = sum V_ij / sum s_ij^2,   s_ij = sum_t z_ti z_tj / n,                         in [0, 1]
      V_ij = (sum_t (z_ti z_tj)^2 / n - s_ij^2) / (n - 1).

  For fewer than three trees, `a` is 0.5. Branch `b` with the parent `p` exists with the probability
  `m_b / m_p` if `p` exists. Time: O(n^2) times the number of coordinates. Each random tree takes
  O(n) times the number of coordinates.
*/
class Tree_distribution
{
public:
  /// `has[t][b]`: whether tree `t` has branch `b`; `up`: direction of growth, of unit length.
  template <class ConcurrencyTag>
  Tree_distribution(const Orl_layout& layout,
                    const std::vector<const Orl_coordinates*>& trees,
                    const std::vector<std::vector<char>>& has,
                    Orl_orientation orientation,
                    const Vec3& up,
                    ConcurrencyTag)
    : m_layout(layout), m_has(has), m_orientation(orientation)
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
    find_counts();
    find_attachments(trees);
    find_middle<ConcurrencyTag>(trees);
    find_deviations(trees, up);
    pool_variances();
    if (trees.size() > 2)
      estimate_shrinkage();
  }

  /// Returns whether the trees have the given branches and edges; `has[t][b]` as above.
  bool is_of(const Orl_layout& layout, const std::vector<std::vector<char>>& has) const
  {
    return m_has == has && m_layout.edge_before == layout.edge_before &&
           m_layout.parent_edge == layout.parent_edge &&
           std::equal(m_layout.branches.begin(),
                      m_layout.branches.end(),
                      layout.branches.begin(),
                      layout.branches.end(),
                      [](const auto& a, const auto& b) { return a.first_edge == b.first_edge; });
  }

  /// Draws tree `index` of a sequence of random trees. The result depends only on the seed, the
  /// index and the options.
  Orl_coordinates
  draw(std::uint64_t seed, std::uint64_t index, const Tree_sampling_options& o) const
  {
    pcs::internal::Random_stream random(seed, index);
    const auto normal = [&] {
      double x = random.normal();
      for (int i = 0; i < 1000 && std::abs(x) > o.truncation; ++i)
        x = random.normal();
      return std::min(o.truncation, std::max(-o.truncation, x));
    };
    const double shrinkage = o.shrinkage < 0 ? m_shrinkage : o.shrinkage;
    const Eigen::VectorXd z = draw_deviations(shrinkage, normal);
    const std::vector<char> presence = draw_presence(o, [&] { return random.uniform(); });
    Orl_coordinates x = m_middle;
    std::vector<Direction_chart::Pair> turns(m_layout.number_of_edges());
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = m_layout.branches[b];
      const std::size_t parent = branch.parent;
      const bool is_there = presence[b] != 0;
      Eigen::Index k = first(b);
      double total = 0;
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges;
           ++e, k += 4) {
        turns[e] = o.spread * z.segment<2>(k);
        x.length[e] = is_there ? m_middle.length[e] * std::exp(o.spread * z[k + 2]) : 0;
        x.radius[e] = is_there ? m_middle.radius[e] * std::exp(o.spread * z[k + 3]) : 0;
        total += x.length[e];
      }
      x.base_radius[b] = total > 0 ? m_middle.base_radius[b] * std::exp(o.spread * z[k]) : 0;
      if (parent != none) {
        const double last = static_cast<double>(m_layout.branches[parent].number_of_edges);
        const double low = o.do_keep_in_range ? m_lowest_attachment[parent] : 0,
                     high = o.do_keep_in_range ? m_highest_attachment[parent] : last;
        x.attachment[b] =
            std::min(high, std::max(low, m_middle.attachment[b] + o.spread * z[k + 1]));
      }
    }
    const std::vector<Quaternion> frame = m_chart.exp(turns);
    for (std::size_t e = 0; e < frame.size(); ++e) {
      const std::size_t p = m_layout.parent_edge[e];
      x.orientation[e] = p == none ? frame[e] : relative(m_orientation, frame[p], frame[e]);
    }
    return x;
  }

  /// Returns the shrinkage: the weight of the covariance without correlations of branches. [-]
  double shrinkage() const { return m_shrinkage; }

private:
  /// Returns the index of the first coordinate of a branch. The four coordinates of each of its
  /// edges are followed by its own two.
  Eigen::Index first(std::size_t b) const
  {
    return static_cast<Eigen::Index>(4 * m_layout.branches[b].first_edge + 2 * b);
  }
  Eigen::Index size(std::size_t b) const
  {
    return static_cast<Eigen::Index>(4 * m_layout.branches[b].number_of_edges + 2);
  }

  /// Draws which branches exist, order by order. If the number of branches of an order is outside
  /// its range in the inputs, it is moved to this range. Branches with log-odds nearest to 0 are
  /// then added or removed.
  template <class Uniform>
  std::vector<char> draw_presence(const Tree_sampling_options& o, const Uniform& uniform) const
  {
    const std::size_t m = m_layout.branches.size();
    std::vector<char> result(m, 1);
    std::vector<double> odds(m,
                             0); // log-odds of the probability minus those of a uniform number
    for (std::size_t b = 0; b < m; ++b)
      if (const std::size_t parent = m_layout.branches[b].parent; parent != none) {
        const double chance = m_count[b] / m_count[parent], drawn = uniform();
        odds[b] = o.do_draw_presence
                      ? std::log(chance / (1 - chance)) - std::log(drawn / (1 - drawn))
                      : m_count[b] - 0.5 * static_cast<double>(m_has.size());
      }
    std::vector<std::size_t> open;
    for (std::size_t k = 1; k < m_fewest.size(); ++k) {
      open.clear();
      for (std::size_t b = 0; b < m; ++b)
        if (m_order[b] == k) {
          result[b] = 0;
          if (result[m_layout.branches[b].parent])
            open.push_back(b);
        }
      std::stable_sort(open.begin(), open.end(), [&](std::size_t a, std::size_t b) {
        return odds[a] > odds[b];
      });
      std::size_t count = 0;
      while (count < open.size() && odds[open[count]] > 0)
        ++count;
      if (o.do_draw_presence && o.do_keep_in_range)
        count = std::min({open.size(), m_most[k], std::max(count, m_fewest[k])});
      for (std::size_t i = 0; i < count; ++i)
        result[open[i]] = 1;
    }
    return result;
  }

  template <class Normal>
  Eigen::VectorXd draw_deviations(double shrinkage, const Normal& normal) const
  {
    const auto n = static_cast<std::size_t>(m_deviations.cols());
    const double divisor = std::sqrt(std::max(1.0, static_cast<double>(n) - 1));
    Eigen::VectorXd z = Eigen::VectorXd::Zero(m_deviations.rows());
    for (Eigen::Index t = 0; t < m_deviations.cols(); ++t)
      z += normal() / divisor * m_deviations.col(t);
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const double members = m_count[b] - 1;
      // correlated part; trees without the branch contribute 0, which the factor compensates
      z.segment(first(b), size(b)) *=
          std::sqrt((1 - shrinkage)) * divisor / std::sqrt(std::max(1.0, members));
      // independent part
      const double own = std::sqrt(shrinkage / (members + prior));
      for (std::size_t t = 0; t < n; ++t)
        if (m_has[t][b] && members > 0)
          z.segment(first(b), size(b)) +=
              own * normal() *
              m_deviations.col(static_cast<Eigen::Index>(t)).segment(first(b), size(b));
      Pool score;
      for (Eigen::Index i = 0; i < score.size(); ++i)
        score[i] = own * std::sqrt(prior) * normal() * m_pool[m_order[b]][i];
      for (Eigen::Index k = first(b); k < first(b) + size(b) - 2; k += 4)
        z.segment<4>(k) += score.head<4>();
      z.segment<2>(first(b) + size(b) - 2) += score.tail<2>();
    }
    return z;
  }

  /// Returns the logarithm of a ratio, which is limited to at least 1e-6. If `middle` is 0 (unknown
  /// radius), returns 0. [-]
  static double log_ratio(double value, double middle)
  {
    constexpr double least = 1e-6;
    return middle > 0 ? std::log(std::max(value, least * middle) / middle) : 0;
  }

  /// Finds the least and largest number of branches of each order in the inputs.
  void find_counts()
  {
    const std::size_t orders = 1 + *std::max_element(m_order.begin(), m_order.end());
    m_fewest.assign(orders, m_order.size());
    m_most.assign(orders, 0);
    for (const std::vector<char>& has : m_has) {
      std::vector<std::size_t> count(orders, 0);
      for (std::size_t b = 0; b < m_order.size(); ++b)
        count[m_order[b]] += has[b] ? 1 : 0;
      for (std::size_t k = 0; k < orders; ++k) {
        m_fewest[k] = std::min(m_fewest[k], count[k]);
        m_most[k] = std::max(m_most[k], count[k]);
      }
    }
  }

  /// Finds the lowest and highest attachment of the children of each branch in the inputs.
  void find_attachments(const std::vector<const Orl_coordinates*>& trees)
  {
    m_lowest_attachment.assign(m_order.size(), std::numeric_limits<double>::infinity());
    m_highest_attachment.assign(m_order.size(), 0);
    for (std::size_t b = 0; b < m_order.size(); ++b)
      for (std::size_t t = 0; t < trees.size(); ++t)
        if (const std::size_t parent = m_layout.branches[b].parent; parent != none && m_has[t][b]) {
          m_lowest_attachment[parent] =
              std::min(m_lowest_attachment[parent], trees[t]->attachment[b]);
          m_highest_attachment[parent] =
              std::max(m_highest_attachment[parent], trees[t]->attachment[b]);
        }
  }

  /// Computes the mean of each branch over the trees that have it: geometric means of lengths and
  /// radii, the arithmetic mean of attachments, and Frechet means of orientations.
  template <class ConcurrencyTag>
  void find_middle(const std::vector<const Orl_coordinates*>& trees)
  {
    std::vector<double> ones(trees.size(), 1);
    m_middle = mean_tree<ConcurrencyTag>(m_layout, trees, ones, Tree_mean::frechet);
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

  /// Computes the matrix of deviations from the mean tree. Column `t` belongs to tree `t`; it is 0
  /// for branches that the tree lacks.
  void find_deviations(const std::vector<const Orl_coordinates*>& trees, const Vec3& up)
  {
    const std::size_t n = trees.size();
    std::vector<std::vector<Quaternion>> frame(n);
    Orl_geometry geometry;
    build_geometry(m_layout, m_middle, m_orientation, geometry);
    const std::vector<Quaternion> middle = geometry.frame;
    for (std::size_t t = 0; t < n; ++t) {
      build_geometry(m_layout, *trees[t], m_orientation, geometry);
      frame[t] = geometry.frame;
    }
    m_chart = Direction_chart(m_layout, up, middle, frame, m_has, m_middle.length);
    m_deviations.setZero(
        static_cast<Eigen::Index>(4 * m_layout.number_of_edges() + 2 * m_layout.branches.size()),
        static_cast<Eigen::Index>(n));
    for (std::size_t t = 0; t < n; ++t) {
      std::vector<Vec3> direction;
      for (const Quaternion& q : frame[t])
        direction.push_back(q * Vec3::UnitZ());
      const std::vector<Direction_chart::Pair> turns = m_chart.log(direction, m_has[t], t);
      auto z = m_deviations.col(static_cast<Eigen::Index>(t));
      for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
        if (!m_has[t][b])
          continue;
        const Orl_layout::Branch& branch = m_layout.branches[b];
        Eigen::Index k = first(b);
        for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges;
             ++e, k += 4) {
          z.segment<2>(k) = turns[e];
          z[k + 2] = log_ratio(trees[t]->length[e], m_middle.length[e]);
          z[k + 3] = log_ratio(trees[t]->radius[e], m_middle.radius[e]);
        }
        z[k] = log_ratio(trees[t]->base_radius[b], m_middle.base_radius[b]);
        z[k + 1] = trees[t]->attachment[b] - m_middle.attachment[b];
      }
    }
  }

  /// Estimates for each order the standard deviations of the means of branches over their edges.
  void pool_variances()
  {
    const std::size_t orders = 1 + *std::max_element(m_order.begin(), m_order.end());
    m_pool.assign(orders, Pool::Zero());
    std::vector<double> weight(orders, 0);
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      const auto edges = static_cast<double>(m_layout.branches[b].number_of_edges);
      for (Eigen::Index t = 0; t < m_deviations.cols(); ++t) {
        Pool whole = Pool::Zero();
        for (Eigen::Index k = first(b); k < first(b) + size(b) - 2; k += 4)
          whole.head<4>() += m_deviations.col(t).segment<4>(k) / edges;
        whole.tail<2>() = m_deviations.col(t).segment<2>(first(b) + size(b) - 2);
        m_pool[m_order[b]] += whole.cwiseAbs2();
      }
      weight[m_order[b]] += m_count[b] - 1;
    }
    for (std::size_t k = 0; k < orders; ++k)
      m_pool[k] = (m_pool[k] / std::max(1.0, weight[k])).cwiseSqrt();
  }

  /// Estimates the shrinkage that minimises the expected error of the covariance. Uses only `n x n`
  /// matrices of products of trees, not the covariance itself.
  void estimate_shrinkage()
  {
    // conversion to lengths: angles are multiplied by the length of the edge, logarithms by the
    // mean length or radius, and attachments by the mean edge length
    const Eigen::Index trees = m_deviations.cols();
    const auto n = static_cast<double>(trees);
    double typical = 0;
    for (const double length : m_middle.length)
      typical += length / static_cast<double>(m_middle.length.size());
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(trees, trees);
    double own_squares = 0, own_fourth = 0; // sums over pairs of coordinates of the same branch
    for (std::size_t b = 0; b < m_layout.branches.size(); ++b) {
      Eigen::MatrixXd z = m_deviations.middleRows(first(b), size(b));
      const Orl_layout::Branch& branch = m_layout.branches[b];
      Eigen::Index k = 0;
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges;
           ++e, k += 4) {
        z.middleRows<3>(k) *= m_middle.length[e];
        z.row(k + 1) *= m_chart.reach(b, e);
        z.row(k + 3) *= m_middle.radius[e];
      }
      z.row(k) *= m_middle.base_radius[b];
      z.row(k + 1) *= typical;
      const Eigen::MatrixXd own = z.transpose() * z;
      own_squares += own.squaredNorm() / (n * n);
      own_fourth += own.diagonal().squaredNorm();
      gram += own;
    }
    // sums over pairs of coordinates of different branches
    const double squares = gram.squaredNorm() / (n * n) - own_squares;
    const double noise = ((gram.diagonal().squaredNorm() - own_fourth) / n - squares) / (n - 1);
    m_shrinkage = squares > 0 ? std::min(1.0, std::max(0.0, noise / squares)) : 0;
  }

  static constexpr double prior = 2; // additional trees with each branch; they vary like its order
  // per edge: two of direction, logarithms of length and radius; per branch: logarithm of the base
  // radius, attachment
  using Pool = Eigen::Matrix<double, 6, 1>;

  Orl_layout m_layout;
  std::vector<std::vector<char>> m_has;
  Orl_orientation m_orientation;
  std::vector<double> m_count; // trees that have each branch
  std::vector<std::size_t> m_order;
  std::vector<std::size_t> m_fewest, m_most; // branches of each order in an input
  std::vector<double> m_lowest_attachment, m_highest_attachment; // on each branch
  Orl_coordinates m_middle;
  Direction_chart m_chart;
  Eigen::MatrixXd m_deviations;
  std::vector<Pool> m_pool; // by order
  double m_shrinkage = 0.5; // cannot be estimated from two trees
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_TREE_DISTRIBUTION_H

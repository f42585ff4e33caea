// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Energy of a pair of branches: bending, stretching, rotation, attachment, and unmatched subtrees.

#ifndef PCS_SHAPE_SPACE_MATCHING_MATCHING_ENERGY_H
#define PCS_SHAPE_SPACE_MATCHING_MATCHING_ENERGY_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/rotations.h>
#include <pcs/internal/constants.h>
#include <pcs/shape_space/matching/Path_curves.h>
#include <pcs/shape_space/matching/align_vectors.h>
#include <pcs/shape_space/matching/elastic_curves.h>
#include <pcs/shape_space/matching/linear_assignment.h>
#include <pcs/shape_space/model/Branch_paths.h>
#include <pcs/shape_space/model/Matched_branch.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  All terms of the energy of a matching of two trees, for any of their decompositions into branches.
  All lengths are in units of the longest path of each tree, or of both trees where growth is at
  tips [-]; factors are those of `Matching_weights`.

  Two branches of lengths `L1` and `L2`, with their subtrees, cost

      C = curve 2 L (1 - M(g) + rotation (1 - cos(alpha))) + length unmatched |L1 - L2|
          + sum_{(i, j) in A} (C_ij + P_ij) + unmatched sum_{i not in A} w_i,
      P_ij = position (l_i + l_j) / 2 d / (1 + d / half_cost_distance),   d = |s_i - s_j|,

  with `L = sqrt(L1 L2)`. `M` is the agreement of curve 1 with curve 2, rotated by `R`, under the
  correspondence `g` (`Elastic_matcher`). `alpha` is the angle between `R` and the rotation `R_p` of
  the parents. `A` is the one-to-one assignment of the children of both. A child has the longest
  path `l`, the total length `w`, and the attachment `s` in [0, 1] along curve 1.

  `Branch_matching` minimises `C` over paths and assignments; `g` maximises `M` for `R_p`, and `R`
  maximises `tr(R^T B)` (Wahba's problem) for

      B = L mean_k(u1_k u2(g)_k^T) + inherited_rotation L R_p
          + children sum_{(i, j)} sqrt(w_i w_j) v_i v_j^T

  with the unit tangents `u` and mean directions `v`. The pairs of the last sum are assigned by
  quick costs, for which a subtree is one straight branch of length `w`; by default, it has no
  weight, since wrong pairs spoil the rotation. Without this sum and `sqrt(g')`, and for
  `inherited_rotation = rotation / 2`, `R` minimises the first term of `C`.

  - Growth at tips: `min(l_i, l_j)` replaces the mean. The longer branch is compared up to the
    length of the shorter one; the length of its remainder, with the children there, is unmatched.
  - Without `is_rotation_inherited`: `R = R_p`, the terms of `rotation` and `length` vanish, and the
    elastic energy is `L1 + L2 - 2 L M` instead of `2 L (1 - M)`.
  - `is_published` (after section 4.7 of \cite aiteanu2022): the same, with `unmatched = 1` and
    `P_ij = L1 d^2`.

  A pair of curves of n samples costs O(n^2), an assignment of k children O(k^3).
*/
class Matching_energy : public Path_curves
{
public:
  static constexpr std::size_t most_children = 256; ///< in quick costs; the heaviest are used

  /// Two matched curves.
  struct Trial
  {
    std::size_t path_1, path_2;
    std::array<std::size_t, 2>
        last; ///< nodes at which the curves end; with growth at tips, not always tips
    double cost;
    std::vector<double> gamma;
  };

  /// Children of a branch; attachments `s` are fractions of the first curve. [-]
  struct Children
  {
    std::vector<double> s, weight;
    std::vector<double> length; ///< of the longest path
    std::vector<Vec3> direction;
    std::vector<std::size_t> start;
  };
  /// Dual prices of the children of tree 2 in similar assignments, by their first node. [-]
  using Child_cost_cache = std::unordered_map<std::size_t, double>;

  template <class ConcurrencyTag>
  Matching_energy(const Rooted_tree& tree_1,
                  const Rooted_tree& tree_2,
                  const Matching_weights& weights,
                  std::array<Branch_paths, 2> paths,
                  bool grows_at_tips,
                  ConcurrencyTag tag)
    : Path_curves(tree_1, tree_2, std::move(paths), grows_at_tips, tag), m_weights(weights)
  {
  }

  const Matching_weights& weights() const { return m_weights; }
  /// Returns the cost of the remainders beyond the last nodes, which are unmatched. [-]
  double rest_cost(std::size_t p1, std::size_t p2, const std::array<std::size_t, 2>& last) const
  {
    double length = 0;
    for (int t = 0; t < 2; ++t) {
      const Branch_path& whole = path(t, t == 0 ? p1 : p2);
      const std::size_t end = last[static_cast<std::size_t>(t)];
      length += (whole.length() - whole.arc[end]) / unit(t);
      for (const Branch_path::Child& c : whole.children)
        length += c.position > end ? weight(t, c.start) : 0;
    }
    return single_term(length);
  }

  /// Bounds the elastic energy from below: two tangents differ at least by the angle between the
  /// cones of tangents around both mean directions.
  double least_energy(std::size_t p1, std::size_t p2, const Eigen::Matrix3d& rotation) const
  {
    return least_energy_at(p1, p2, rotation * curves(1)[p2].direction);
  }

  /// Bounds the cost of two subtrees from below: the excess length of one of them is stretched or
  /// unmatched.
  double least_cost(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t p1 : paths(0).paths_of[start_1])
      for (const std::size_t p2 : paths(1).paths_of[start_2])
        least = std::min(least, least_energy(p1, p2, rotation));
    return m_weights.curve * least + least_difference(start_1, start_2);
  }

  /// Calls `take(r, c, cost)` with `least_cost()` of all pairs of the first nodes `starts_1` and
  /// `starts_2`.
  template <class Take>
  void least_costs(const std::vector<std::size_t>& starts_1,
                   const std::vector<std::size_t>& starts_2,
                   const Eigen::Matrix3d& rotation,
                   const Take& take) const
  {
    std::vector<std::pair<std::size_t, Vec3>> turned; // paths of tree 2 and their directions
    for (std::size_t c = 0; c < starts_2.size(); ++c) {
      turned.clear();
      for (const std::size_t p2 : paths(1).paths_of[starts_2[c]])
        turned.emplace_back(p2, rotation * curves(1)[p2].direction);
      for (std::size_t r = 0; r < starts_1.size(); ++r) {
        double least = std::numeric_limits<double>::infinity();
        for (const std::size_t p1 : paths(0).paths_of[starts_1[r]])
          for (const auto& [p2, direction] : turned)
            least = std::min(least, least_energy_at(p1, p2, direction));
        take(r, c, m_weights.curve * least + least_difference(starts_1[r], starts_2[c]));
      }
    }
  }

  double least_difference(std::size_t start_1, std::size_t start_2) const
  {
    return is_turned() ? m_weights.unmatched * std::min(1.0, m_weights.length) *
                             std::abs(weight(0, start_1) - weight(1, start_2)) * (1 - 1e-12)
                       : 0;
  }

  /// Returns the energy of two branches that are rotated by `rotation` and their parents by
  /// `inherited`. [-]
  double turned_energy(const Trial& trial,
                       const Eigen::Matrix3d& inherited,
                       const Eigen::Matrix3d& rotation) const
  {
    const std::size_t n = trial.gamma.size();
    std::array<Sampled_curve, 2> cut;
    const Sampled_curve &one = curve(0, trial.path_1, n, trial.last[0], cut[0]),
                        &two = curve(1, trial.path_2, n, trial.last[1], cut[1]);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double x = trial.gamma[i] * static_cast<double>(n - 1);
      const auto j = static_cast<Eigen::Index>(std::min(n - 1, static_cast<std::size_t>(x + 0.5)));
      const double slope = (trial.gamma[i + 1] - trial.gamma[i]) * static_cast<double>(n - 1);
      sum += std::sqrt(slope) *
             one.tangents.col(static_cast<Eigen::Index>(i)).dot(rotation * two.tangents.col(j));
    }
    const double cosine = 0.5 * ((inherited.transpose() * rotation).trace() - 1);
    const double length = std::sqrt(one.length * two.length);
    return m_weights.curve * elastic_energy(one.length,
                                            two.length,
                                            std::max(0.0, sum / static_cast<double>(n - 1))) +
           m_weights.curve * m_weights.rotation * 2 * length * (1 - cosine) +
           length_term(one.length, two.length);
  }

  double position_term(double w1, double w2, double s1, double s2, double parent_length) const
  {
    const double d = std::abs(s1 - s2);
    if (m_weights.is_published)
      return parent_length * d * d;
    // bounded, so that positions alone do not leave branches of different species unmatched
    const double w = grows_at_tips() ? std::min(w1, w2) : 0.5 * (w1 + w2);
    return m_weights.position * w * d / (1 + d / m_weights.half_cost_distance);
  }

  /// Returns indices by decreasing weight.
  static std::vector<std::size_t> by_weight(const std::vector<double>& weight)
  {
    std::vector<std::size_t> order(weight.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      return weight[i] > weight[j];
    });
    return order;
  }

  bool is_turned() const { return m_weights.is_rotation_inherited && !m_weights.is_published; }

  double single_term(double w) const
  {
    return (m_weights.is_published ? 1 : m_weights.unmatched) * w;
  }

  /// Collects the children up to the node `last`.
  Children children_of(int t,
                       const Branch_path& path,
                       std::size_t last,
                       const std::vector<double>* gamma) const
  {
    Children result;
    for (const Branch_path::Child& c : path.children) {
      if (c.position > last)
        break;
      const double s = path.arc[c.position] / path.arc[last];
      result.s.push_back(gamma ? inverse_at(*gamma, s) : s);
      result.weight.push_back(weight(t, c.start));
      result.start.push_back(c.start);
      result.length.push_back(curves(t)[paths(t).paths_of[c.start].front()].length);
      result.direction.push_back(curves(t)[paths(t).paths_of[c.start].front()].direction);
    }
    return result;
  }

  /// Assigns children by quick costs.
  std::vector<std::size_t> quick_assignment(const Children& a,
                                            const Children& b,
                                            const Eigen::Matrix3d& rotation,
                                            double parent_length) const
  {
    return assign_rows(a.s.size(), b.s.size(), quick_gains(a, b, rotation, parent_length));
  }

  /// Estimates the cost of two paths without the subtrees of their children; infinity as soon as it
  /// is known to exceed `most`. Of each branch, the `number` heaviest children are assigned.
  double quick_cost_of_paths(std::size_t p1,
                             std::size_t p2,
                             const Eigen::Matrix3d& rotation,
                             double most,
                             Child_cost_cache& prices,
                             std::size_t number = most_children) const
  {
    const Trial trial = match_curves(p1, p2, rotation, few_samples);
    const Children a = children_of(0, path(0, p1), trial.last[0], nullptr);
    const Children b = children_of(1, path(1, p2), trial.last[1], &trial.gamma);
    const Eigen::Matrix3d turned = turn(trial, a, b, rotation, 0, 0);
    double cost = is_turned() ? turned_energy(trial, rotation, turned) : trial.cost;
    cost += rest_cost(p1, p2, trial.last);
    return cost + quick_cost_of_children(a, b, turned, length(0, p1), most - cost, prices, number);
  }

  /// Estimates the rotation that aligns two paths and their children, without their subtrees. The
  /// directions of children count as much as the curves, whatever their weight in the energy.
  Eigen::Matrix3d
  quick_turn(std::size_t p1, std::size_t p2, const Eigen::Matrix3d& rotation, int passes) const
  {
    const Trial trial = match_curves(p1, p2, rotation, few_samples);
    return turn(trial,
                children_of(0, path(0, p1), trial.last[0], nullptr),
                children_of(1, path(1, p2), trial.last[1], &trial.gamma),
                rotation,
                passes,
                1);
  }

  /// Returns the least cost of an assignment of children by quick costs; infinity as soon as it is
  /// known to exceed `most`. Of very many children, only the heaviest are assigned; the difference
  /// between the total weights of the others counts as unmatched.
  double quick_cost_of_children(const Children& all_1,
                                const Children& all_2,
                                const Eigen::Matrix3d& rotation,
                                double parent_length,
                                double most,
                                Child_cost_cache& prices,
                                std::size_t number = most_children) const
  {
    constexpr double slack = 1e-9; // rounding must not decide
    std::array<Children, 2> few;
    std::array<double, 2> light = {0, 0};
    const Children &a = heaviest(all_1, number, few[0], light[0]),
                   &b = heaviest(all_2, number, few[1], light[1]);
    const std::size_t n = a.s.size(), m = b.s.size();
    double total = single_term(std::abs(light[0] - light[1]));
    for (const double w : a.weight)
      total += single_term(w);
    for (const double w : b.weight)
      total += single_term(w);
    const std::vector<double> gain = quick_gains(a, b, rotation, parent_length);
    std::vector<double> known(m, 0);
    for (std::size_t j = 0; j < m; ++j)
      if (const auto it = prices.find(b.start[j]); it != prices.end())
        known[j] = it->second;
    Assignment assignment(n, m, gain, known);
    const bool is_solved = assignment.solve(most - total * (1 - slack));
    for (std::size_t j = 0; j < m; ++j)
      prices[b.start[j]] = assignment.prices()[j];
    if (!is_solved)
      return std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i)
      if (const std::size_t j = assignment.columns()[i]; j != none)
        total += gain[i * m + j];
    return total;
  }

  /// Returns the rotation that aligns branch 2 with branch 1, from the curves, the rotation
  /// `inherited` from the parents, and the directions of the children with the weight `children`.
  Eigen::Matrix3d turn(const Trial& trial,
                       const Children& all_1,
                       const Children& all_2,
                       const Eigen::Matrix3d& inherited,
                       int passes,
                       double children) const
  {
    if (!m_weights.is_rotation_inherited || m_weights.is_published)
      return inherited;
    std::array<Children, 2> few;
    std::array<double, 2> light;
    const Children &a = heaviest(all_1, most_children, few[0], light[0]),
                   &b = heaviest(all_2, most_children, few[1], light[1]);
    const std::vector<double>& gamma = trial.gamma;
    const std::size_t n = gamma.size();
    std::array<Sampled_curve, 2> cut;
    const Sampled_curve &one = curve(0, trial.path_1, n, trial.last[0], cut[0]),
                        &two = curve(1, trial.path_2, n, trial.last[1], cut[1]);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const double x = gamma[i] * static_cast<double>(n - 1);
      const auto j = static_cast<Eigen::Index>(std::min(n - 1, static_cast<std::size_t>(x + 0.5)));
      covariance +=
          one.tangents.col(static_cast<Eigen::Index>(i)) * two.tangents.col(j).transpose();
    }
    const double length = std::sqrt(one.length * two.length);
    covariance *= length / static_cast<double>(n);
    covariance += m_weights.inherited_rotation * length * inherited;
    Quaternion q = align_vectors(covariance, Quaternion(inherited));
    if (children <= 0 || a.s.empty() || b.s.empty())
      return q.toRotationMatrix();
    for (int pass = 0; pass < passes; ++pass) {
      const Eigen::Matrix3d rotation = q.toRotationMatrix();
      const std::vector<std::size_t> partner = quick_assignment(a, b, rotation, one.length);
      Eigen::Matrix3d all = covariance;
      for (std::size_t i = 0; i < partner.size(); ++i)
        if (partner[i] != none)
          all += children * std::sqrt(a.weight[i] * b.weight[partner[i]]) * a.direction[i] *
                 b.direction[partner[i]].transpose();
      q = align_vectors(all, q);
    }
    return q.toRotationMatrix();
  }

  /// Computes the elastic energy and the reparametrisation of two paths.
  Trial match_curves(std::size_t p1,
                     std::size_t p2,
                     const Eigen::Matrix3d& rotation,
                     std::size_t samples = number_of_samples) const
  {
    thread_local Elastic_matcher fine(number_of_samples, 3), coarse(few_samples, 3);
    Elastic_matcher& matcher = samples == number_of_samples ? fine : coarse;
    const std::array<std::size_t, 2> last = last_nodes(p1, p2);
    std::array<Sampled_curve, 2> cut;
    const Sampled_curve &one = curve(0, p1, samples, last[0], cut[0]),
                        &two = curve(1, p2, samples, last[1], cut[1]);
    const double energy = elastic_energy(one.length, two.length, matcher(one, two, rotation));
    return {p1, p2, last, m_weights.curve * energy, matcher.gamma()};
  }

private:
  /// Bounds the elastic energy from below, where `direction` is the rotated mean direction of
  /// path 2.
  double least_energy_at(std::size_t p1, std::size_t p2, const Vec3& direction) const
  {
    const Sampled_curve &a = curves(0)[p1], &b = curves(1)[p2];
    double length_1 = a.length, length_2 = b.length;
    if (is_cut(length_1, length_2)) // the beginning of a curve is in nearly the same cone
      length_1 = length_2 = std::min(length_1, length_2);
    const double cosine = least_angle_cosine(a, b, a.direction.dot(direction));
    if (m_weights.is_published || !m_weights.is_rotation_inherited)
      return elastic_energy(length_1, length_2, std::max(0.0, cosine) * (1 + 1e-12));
    // a rotation of the branch may compensate for part of the angle
    const double t = m_weights.rotation;
    const double gain = std::sqrt(1 + t * t + 2 * t * cosine) - t;
    return elastic_energy(length_1, length_2, gain * (1 + 1e-12));
  }

  /// Returns the cosine of the angle between the cones of tangents of two curves, whose mean
  /// directions have the cosine `dot`.
  static double least_angle_cosine(const Sampled_curve& a, const Sampled_curve& b, double dot)
  {
    const double x = std::min(1.0, std::max(-1.0, dot));
    const double cosine = a.cosine * b.cosine - a.sine * b.sine; // of the sum of both spreads
    if (a.spread + b.spread >= pcs::internal::pi || x >= cosine)
      return 1;
    const double sine = a.sine * b.cosine + a.cosine * b.sine;
    return x * cosine + std::sqrt(1 - x * x) * sine;
  }

  /// Returns the elastic energy of curves whose tangents agree by `agreement`. If there is a
  /// separate term for lengths, the elastic energy excludes their difference: otherwise a branch
  /// that grew to four times its length would stay unmatched even if nothing else had changed.
  double elastic_energy(double a, double b, double agreement) const
  {
    const double mean = 2 * std::sqrt(a * b);
    return std::max(0.0, (is_turned() ? mean : a + b) - mean * agreement);
  }

  double length_term(double a, double b) const
  {
    return m_weights.length * m_weights.unmatched * std::abs(a - b);
  }

  /// Returns all children if they are not more than `number`, else the heaviest in the same order,
  /// stored in `few`; `light` is the weight of the others.
  static const Children&
  heaviest(const Children& all, std::size_t number, Children& few, double& light)
  {
    light = 0;
    const std::size_t n = all.s.size();
    if (n <= number)
      return all;
    std::vector<std::size_t> order = by_weight(all.weight);
    for (std::size_t k = number; k < n; ++k)
      light += all.weight[order[k]];
    order.resize(number);
    std::sort(order.begin(), order.end());
    for (const std::size_t i : order) {
      few.s.push_back(all.s[i]);
      few.weight.push_back(all.weight[i]);
      few.length.push_back(all.length[i]);
      few.direction.push_back(all.direction[i]);
      few.start.push_back(all.start[i]);
    }
    return few;
  }

  /// Returns the quick costs of pairs of children minus their costs when unmatched. [-]
  std::vector<double> quick_gains(const Children& a,
                                  const Children& b,
                                  const Eigen::Matrix3d& rotation,
                                  double parent_length) const
  {
    const std::size_t n = a.s.size(), m = b.s.size();
    std::vector<double> gain(n * m);
    std::vector<Vec3> turned;
    for (const Vec3& direction : b.direction)
      turned.push_back(rotation * direction);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < m; ++j)
        gain[i * m + j] =
            m_weights.curve * quick_cost(a.weight[i], b.weight[j], a.direction[i].dot(turned[j])) +
            position_term(a.length[i], b.length[j], a.s[i], b.s[j], parent_length) -
            single_term(a.weight[i]) - single_term(b.weight[j]);
    return gain;
  }

  /// Returns the cost of two subtrees of given weights as if each were one straight branch, at an
  /// angle of given cosine.
  double quick_cost(double weight_1, double weight_2, double dot) const
  {
    double cosine = std::max(0.0, dot);
    if (is_turned()) {
      const double t = m_weights.rotation;
      cosine = std::sqrt(1 + t * t + 2 * t * dot) - t;
    }
    if (grows_at_tips())
      return 2 * std::min(weight_1, weight_2) * (1 - cosine) + length_term(weight_1, weight_2);
    return elastic_energy(weight_1, weight_2, cosine) + length_term(weight_1, weight_2);
  }

  Matching_weights m_weights;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_MATCHING_ENERGY_H

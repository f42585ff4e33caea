// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Which branch of one tree is which of another, level by level below matched parents.

#ifndef PCS_SHAPE_SPACE_BRANCH_MATCHING_H
#define PCS_SHAPE_SPACE_BRANCH_MATCHING_H

#include <pcs/core/rotations.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/Branch_paths.h>
#include <pcs/shape_space/Matched_branch.h>
#include <pcs/shape_space/best_turn.h>
#include <pcs/shape_space/canonical_frame.h>
#include <pcs/shape_space/elastic_curves.h>
#include <pcs/shape_space/linear_assignment.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

template <class ConcurrencyTag>
class Branch_matching
{
public:
  static constexpr std::size_t number_of_samples = 25;

  Branch_matching(const Rooted_tree& tree_1,
                  const Rooted_tree& tree_2,
                  const Matching_weights& weights)
    : Branch_matching(tree_1, tree_2, weights, find_paths(tree_1, weights))
  {
  }

  /// The same where tree 1 may be taken apart in the given way only.
  Branch_matching(const Rooted_tree& tree_1,
                  const Rooted_tree& tree_2,
                  const Matching_weights& weights,
                  Branch_paths paths_1)
    : m_weights(weights), m_trees{&tree_1, &tree_2}
  {
    m_paths[0] = std::move(paths_1);
    m_paths[1] = find_paths(tree_2, weights);
    for (int t = 0; t < 2; ++t) {
      m_curves[t].resize(m_paths[t].paths.size());
      pcs::internal::for_each_index<ConcurrencyTag>(
          m_curves[t].size(),
          [&](std::size_t i) {
            m_curves[t][i] = sample_curve(*m_trees[t], m_paths[t].paths[i], number_of_samples);
            m_curves[t][i].length /= m_trees[t]->heights[0];
            turn_curve(m_curves[t][i]);
          },
          16);
    }
  }

  static Branch_paths find_paths(const Rooted_tree& tree, const Matching_weights& weights)
  {
    return find_branch_paths(tree,
                             weights.fork_ratio,
                             weights.is_published ? 1 : weights.number_of_paths);
  }

  const Branch_paths& paths(int t) const { return m_paths[t]; }

  /// Pairs of trunks that are matched with all their children; less than the default saves most of the time.
  void set_number_of_trunk_trials(std::size_t n) { m_most_trunk_trials = n; }
  /// The trunk of tree 2 is known: a path of `paths(1)`.
  void set_second_trunk(std::size_t path) { m_paths[1].paths_of[0] = {path}; }

  /// Null when `progress` asks to stop.
  std::shared_ptr<const Matched_branch> run(pcs::internal::Progress& progress)
  {
    Result result = compute_match(0,
                                  0,
                                  Eigen::Matrix3d::Identity(),
                                  std::numeric_limits<double>::infinity(),
                                  &progress);
    for (Shard& shard : m_known)
      shard.results.clear();
    return result;
  }

private:
  using Result = std::shared_ptr<const Matched_branch>;

  /// Two curves, matched; what `match_children()` needs.
  struct Trial
  {
    std::size_t path_1, path_2;
    double cost;
    std::vector<double> gamma;
  };

  /// Two branches below any parents: the same question comes up for each way to continue the parents. Turns are rounded
  /// before use, so that it is the same question, and so that it does not matter who asks first.
  struct Question
  {
    std::size_t start_1, start_2;
    std::array<int, 3> turn;
    bool operator==(const Question& q) const
    {
      return start_1 == q.start_1 && start_2 == q.start_2 && turn == q.turn;
    }
  };
  struct Hash
  {
    std::size_t operator()(const Question& q) const
    {
      std::size_t h = q.start_1 * 0x9e3779b97f4a7c15u + q.start_2;
      for (const int t : q.turn)
        h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9u + static_cast<std::size_t>(t + 1000);
      return h ^ (h >> 32);
    }
  };
  struct Shard
  {
    std::mutex mutex;
    std::unordered_map<Question, Result, Hash> results;
  };
  static constexpr double turn_step = 0.25;   // [rad]
  static constexpr int number_of_passes = 3;  // of a turn by curve and children
  static constexpr double rematch_turn = 0.4; // Frobenius norm: a turn by about 0.3 rad

  Result match(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation)
  {
    const Vec3 u = rotation_log(Quaternion(rotation));
    Question question{start_1, start_2, {}};
    Vec3 rounded;
    for (int i = 0; i < 3; ++i) {
      question.turn[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(u[i] / turn_step));
      rounded[i] = turn_step * question.turn[static_cast<std::size_t>(i)];
    }
    Shard& shard = m_known[Hash()(question) % m_known.size()];
    {
      const std::lock_guard<std::mutex> lock(shard.mutex);
      const auto it = shard.results.find(question);
      if (it != shard.results.end())
        return it->second;
    }
    const double limit = single_term(weight(0, start_1)) + single_term(weight(1, start_2));
    Result result =
        compute_match(start_1, start_2, rotation_exp(rounded).toRotationMatrix(), limit, nullptr);
    const std::lock_guard<std::mutex> lock(shard.mutex);
    shard.results.emplace(question, result);
    return result;
  }

  const Branch_path& path(int t, std::size_t i) const { return m_paths[t].paths[i]; }

  /// To the axes of tree 1: turns are rounded in these, so that it does not matter how the trees stand.
  void turn_curve(Sampled_curve& curve) const
  {
    curve.tangents = (m_frame.transpose() * curve.tangents).eval();
    curve.direction = (m_frame.transpose() * curve.direction).eval();
  }

  /// Total length of what begins with the edge to `start`.
  double weight(int t, std::size_t start) const
  {
    const Rooted_tree& tree = *m_trees[t];
    return (tree.weights[start] + (tree.parents[start] == none ? 0 : tree.edge_length(start))) /
           tree.heights[0];
  }

  /// A bound for the elastic energy: no pair of tangents is closer than the cones around the mean directions allow.
  double least_energy(std::size_t p1, std::size_t p2, const Eigen::Matrix3d& rotation) const
  {
    const Sampled_curve &a = m_curves[0][p1], &b = m_curves[1][p2];
    const double cosine = std::min(1.0, std::max(-1.0, a.direction.dot(rotation * b.direction)));
    const double angle = std::max(0.0, std::acos(cosine) - a.spread - b.spread);
    if (m_weights.is_published || !m_weights.is_carried)
      return a.length + b.length -
             2 * std::sqrt(a.length * b.length) * std::max(0.0, std::cos(angle)) * (1 + 1e-12);
    // the branch may turn by a part of the angle
    const double t = m_weights.turn;
    const double gain = std::sqrt(1 + t * t + 2 * t * std::cos(angle)) - t;
    return a.length + b.length - 2 * std::sqrt(a.length * b.length) * gain * (1 + 1e-12);
  }

  /// All that two subtrees cost at least: what one of them has more is stretched or single.
  double least_cost(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t p1 : m_paths[0].paths_of[start_1])
      for (const std::size_t p2 : m_paths[1].paths_of[start_2])
        least = std::min(least, least_energy(p1, p2, rotation));
    return m_weights.curve * least + least_difference(start_1, start_2);
  }

  double least_difference(std::size_t start_1, std::size_t start_2) const
  {
    return is_turned() ? m_weights.single * std::min(1.0, m_weights.length) *
                             std::abs(weight(0, start_1) - weight(1, start_2)) * (1 - 1e-12)
                       : 0;
  }

  double length_term(double a, double b) const
  {
    return m_weights.length * m_weights.single * std::abs(a - b);
  }

  /// The energy of two branches that turn with their parents by `carried`, and by themselves to `rotation`.
  double turned_energy(const Trial& trial,
                       const Eigen::Matrix3d& carried,
                       const Eigen::Matrix3d& rotation) const
  {
    const Sampled_curve &one = m_curves[0][trial.path_1], &two = m_curves[1][trial.path_2];
    const std::size_t n = number_of_samples;
    double sum = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double x = trial.gamma[i] * static_cast<double>(n - 1);
      const auto j = static_cast<Eigen::Index>(std::min(n - 1, static_cast<std::size_t>(x + 0.5)));
      const double slope = (trial.gamma[i + 1] - trial.gamma[i]) * static_cast<double>(n - 1);
      sum += std::sqrt(slope) *
             one.tangents.col(static_cast<Eigen::Index>(i)).dot(rotation * two.tangents.col(j));
    }
    const double cosine = 0.5 * ((carried.transpose() * rotation).trace() - 1);
    const double length = std::sqrt(one.length * two.length);
    return m_weights.curve *
               std::max(0.0,
                        one.length + two.length -
                            2 * length * std::max(0.0, sum / static_cast<double>(n - 1))) +
           m_weights.curve * m_weights.turn * 2 * length * (1 - cosine) +
           length_term(one.length, two.length);
  }

  double position_term(double w1, double w2, double s1, double s2, double parent_length) const
  {
    const double d = std::abs(s1 - s2);
    if (m_weights.is_published)
      return m_weights.position * parent_length * d * d;
    // far is far: branches of other species are not single for their place alone
    return m_weights.position * 0.5 * (w1 + w2) * d / (1 + d / m_weights.far);
  }

  bool is_turned() const { return m_weights.is_carried && !m_weights.is_published; }

  double single_term(double w) const { return (m_weights.is_published ? 1 : m_weights.single) * w; }

  /// Attachments of the children, as shares of the first curve.
  struct Children
  {
    std::vector<double> s, weight;
    std::vector<double> length; ///< of the longest path
    std::vector<Vec3> direction;
  };

  Children children_of(int t, const Branch_path& path, const std::vector<double>* gamma) const
  {
    Children result;
    for (const Branch_path::Child& c : path.children) {
      const double s = path.arc[c.position] / path.length();
      result.s.push_back(gamma ? inverse_at(*gamma, s) : s);
      result.weight.push_back(weight(t, c.start));
      result.length.push_back(m_curves[t][m_paths[t].paths_of[c.start].front()].length);
      result.direction.push_back(m_curves[t][m_paths[t].paths_of[c.start].front()].direction);
    }
    return result;
  }

  /// Cost of two subtrees as if each were one straight branch.
  double quick_cost(const Children& a,
                    std::size_t i,
                    const Children& b,
                    std::size_t j,
                    const Eigen::Matrix3d& rotation) const
  {
    double cosine = std::max(0.0, a.direction[i].dot(rotation * b.direction[j]));
    if (is_turned()) {
      const double t = m_weights.turn;
      cosine = std::sqrt(1 + t * t + 2 * t * a.direction[i].dot(rotation * b.direction[j])) - t;
    }
    return a.weight[i] + b.weight[j] - 2 * std::sqrt(a.weight[i] * b.weight[j]) * cosine +
           length_term(a.weight[i], b.weight[j]);
  }

  /// The assignment of children by quick costs; `cost` is what it leaves.
  std::vector<std::size_t> quick_assignment(const Children& a,
                                            const Children& b,
                                            const Eigen::Matrix3d& rotation,
                                            double parent_length,
                                            double* cost) const
  {
    const std::size_t n = a.s.size(), m = b.s.size();
    std::vector<double> gain(n * m);
    double total = 0;
    for (const double w : a.weight)
      total += single_term(w);
    for (const double w : b.weight)
      total += single_term(w);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < m; ++j)
        gain[i * m + j] = m_weights.curve * quick_cost(a, i, b, j, rotation) +
                          position_term(a.length[i], b.length[j], a.s[i], b.s[j], parent_length) -
                          single_term(a.weight[i]) - single_term(b.weight[j]);
    std::vector<std::size_t> partner = assign_rows(n, m, gain);
    for (std::size_t i = 0; i < n; ++i)
      if (partner[i] != none)
        total += gain[i * m + partner[i]];
    if (cost)
      *cost = total;
    return partner;
  }

  /// The turn that carries branch 2 to branch 1, from the curves, the children, and what the parents say.
  Eigen::Matrix3d turn(std::size_t p1,
                       std::size_t p2,
                       const std::vector<double>& gamma,
                       const Children& a,
                       const Children& b,
                       const Eigen::Matrix3d& carried,
                       int passes) const
  {
    if (!m_weights.is_carried || m_weights.is_published)
      return carried;
    const Sampled_curve &one = m_curves[0][p1], &two = m_curves[1][p2];
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    const std::size_t n = number_of_samples;
    for (std::size_t i = 0; i < n; ++i) {
      const double x = gamma[i] * static_cast<double>(n - 1);
      const auto j = static_cast<Eigen::Index>(std::min(n - 1, static_cast<std::size_t>(x + 0.5)));
      covariance +=
          one.tangents.col(static_cast<Eigen::Index>(i)) * two.tangents.col(j).transpose();
    }
    const double length = std::sqrt(one.length * two.length);
    covariance *= length / static_cast<double>(n);
    covariance += m_weights.carried * length * carried;
    Quaternion q = best_turn(covariance, Quaternion(carried));
    if (m_weights.children <= 0 || a.s.empty() || b.s.empty())
      return q.toRotationMatrix();
    for (int pass = 0; pass < passes; ++pass) {
      const Eigen::Matrix3d rotation = q.toRotationMatrix();
      const std::vector<std::size_t> partner =
          quick_assignment(a, b, rotation, one.length, nullptr);
      Eigen::Matrix3d all = covariance;
      for (std::size_t i = 0; i < partner.size(); ++i)
        if (partner[i] != none)
          all += m_weights.children * std::sqrt(a.weight[i] * b.weight[partner[i]]) *
                 a.direction[i] * b.direction[partner[i]].transpose();
      q = best_turn(all, q);
    }
    return q.toRotationMatrix();
  }

  /// Energy and reparametrisation of two paths.
  Trial match_curves(std::size_t p1, std::size_t p2, const Eigen::Matrix3d& rotation) const
  {
    thread_local Elastic_matcher matcher(number_of_samples, 3);
    const Sampled_curve &one = m_curves[0][p1], &two = m_curves[1][p2];
    const double m = matcher(one, two, rotation);
    const double energy = one.length + two.length - 2 * std::sqrt(one.length * two.length) * m;
    return {p1, p2, m_weights.curve * std::max(0.0, energy), matcher.gamma()};
  }

  /// Pairs of paths that may continue two branches, the most promising first, judged without looking below their
  /// children; those that cost at least `limit` by themselves are left out.
  std::vector<Trial> find_trials(std::size_t start_1,
                                 std::size_t start_2,
                                 const Eigen::Matrix3d& rotation,
                                 double limit) const
  {
    const auto &paths_1 = m_paths[0].paths_of[start_1], &paths_2 = m_paths[1].paths_of[start_2];
    const double difference = least_difference(start_1, start_2);
    std::vector<Trial> all;
    std::vector<std::pair<double, std::size_t>> order;
    for (const std::size_t p1 : paths_1)
      for (const std::size_t p2 : paths_2) {
        if (m_weights.curve * least_energy(p1, p2, rotation) + difference >= limit)
          continue;
        Trial trial = match_curves(p1, p2, rotation);
        if (!is_turned() && trial.cost >= limit)
          continue;
        all.push_back(std::move(trial));
        double cost = 0;
        if (paths_1.size() * paths_2.size() > 1) {
          const Children a = children_of(0, path(0, p1), nullptr);
          const Children b = children_of(1, path(1, p2), &all.back().gamma);
          const Eigen::Matrix3d turned = turn(p1, p2, all.back().gamma, a, b, rotation, 0);
          quick_assignment(a, b, turned, m_curves[0][p1].length, &cost);
          if (is_turned())
            all.back().cost = turned_energy(all.back(), rotation, turned);
        }
        order.emplace_back(cost + all.back().cost, all.size() - 1);
      }
    std::sort(order.begin(), order.end());
    std::vector<Trial> chosen;
    const std::size_t most =
        start_1 == 0 && start_2 == 0 ? m_most_trunk_trials : m_weights.number_of_trials;
    for (std::size_t k = 0; k < order.size() && k < most; ++k)
      chosen.push_back(std::move(all[order[k].second]));
    return chosen;
  }

  /// Everything that begins with two edges, null if it costs at least `limit`. `rotation` carries tree 2 to tree 1, as far as the parents tell.
  Result compute_match(std::size_t start_1,
                       std::size_t start_2,
                       const Eigen::Matrix3d& rotation,
                       double limit,
                       pcs::internal::Progress* progress)
  {
    Result best;
    const std::vector<Trial> trials = find_trials(start_1, start_2, rotation, limit);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      if (progress && !(*progress)(static_cast<double>(k) / static_cast<double>(trials.size())))
        return nullptr;
      if (Result result = match_children(trials[k], rotation, limit)) {
        limit = result->cost;
        best = std::move(result);
      }
    }
    return best;
  }

  /// Null as soon as it is known that the cost is not below `limit`.
  Result match_children(Trial trial, const Eigen::Matrix3d& rotation, double limit)
  {
    if (!is_turned() && trial.cost >= limit)
      return nullptr;
    const Branch_path &path_1 = path(0, trial.path_1), &path_2 = path(1, trial.path_2);
    const Children a = children_of(0, path_1, nullptr);
    Children b = children_of(1, path_2, &trial.gamma);
    auto result = std::make_shared<Matched_branch>();
    result->path_1 = trial.path_1;
    result->path_2 = trial.path_2;
    result->cost = trial.cost;
    Eigen::Matrix3d turned =
        turn(trial.path_1, trial.path_2, trial.gamma, a, b, rotation, number_of_passes);
    if (is_turned()) {
      if ((turned - rotation).norm() > rematch_turn) {
        // what runs along what is seen better now
        trial = match_curves(trial.path_1, trial.path_2, turned);
        b = children_of(1, path_2, &trial.gamma);
        turned = turn(trial.path_1, trial.path_2, trial.gamma, a, b, rotation, number_of_passes);
      }
      result->cost = turned_energy(trial, rotation, turned);
    }
    result->rotation = m_frame * turned * m_frame.transpose();
    if (result->cost >= limit)
      return nullptr;
    const std::size_t n = a.s.size(), m = b.s.size();
    for (const double w : a.weight)
      result->cost += single_term(w);
    for (const double w : b.weight)
      result->cost += single_term(w);
    if (n == 0 || m == 0)
      return result->cost < limit ? result : nullptr;

    // Bounds first; what the assignment asks for is made exact until it asks for nothing more.
    std::vector<double> gain(n * m);
    std::vector<Result> exact(n * m);
    const auto rest = [&](std::size_t i, std::size_t j) {
      return position_term(a.length[i],
                           b.length[j],
                           a.s[i],
                           b.s[j],
                           m_curves[0][trial.path_1].length) -
             single_term(a.weight[i]) - single_term(b.weight[j]);
    };
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < m; ++j)
        gain[i * m + j] =
            least_cost(path_1.children[i].start, path_2.children[j].start, turned) + rest(i, j);
    std::vector<std::size_t> partner, wanted;
    for (;;) {
      partner = assign_rows(n, m, gain);
      wanted.clear();
      double bound = result->cost;
      for (std::size_t i = 0; i < n; ++i)
        if (partner[i] != none) {
          bound += gain[i * m + partner[i]];
          if (!exact[i * m + partner[i]])
            wanted.push_back(i);
        }
      if (bound >= limit)
        return nullptr;
      if (wanted.empty())
        break;
      pcs::internal::for_each_index<ConcurrencyTag>(
          wanted.size(),
          [&](std::size_t k) {
            const std::size_t i = wanted[k], j = partner[i];
            exact[i * m + j] = match(path_1.children[i].start, path_2.children[j].start, turned);
            gain[i * m + j] = exact[i * m + j] ? exact[i * m + j]->cost + rest(i, j) : 0;
          },
          1);
    }
    for (std::size_t i = 0; i < n; ++i)
      if (partner[i] != none) {
        result->cost += gain[i * m + partner[i]];
        result->pairs.push_back({i, partner[i], exact[i * m + partner[i]]});
      }
    return result;
  }

  Matching_weights m_weights;
  std::size_t m_most_trunk_trials = trunk_factor * m_weights.number_of_trials;
  const Rooted_tree* m_trees[2];
  Eigen::Matrix3d m_frame = canonical_frame(*m_trees[0]);
  Branch_paths m_paths[2];
  std::vector<Sampled_curve> m_curves[2];
  std::array<Shard, 64> m_known;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_BRANCH_MATCHING_H

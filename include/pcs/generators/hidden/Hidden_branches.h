// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Branches that the scanner cannot have shown, grown on measured axes by a habit.

#ifndef PCS_GENERATORS_HIDDEN_HIDDEN_BRANCHES_H
#define PCS_GENERATORS_HIDDEN_HIDDEN_BRANCHES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/Habit_parameters.h>
#include <pcs/generators/habit/Habit_simulation.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/hidden/Beam_visibility.h>
#include <pcs/generators/internal/Tree_growth.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/constants.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace generators {
namespace hidden {

/// An inferred branch. `parent`: a measured axis, or after those, an inferred branch; `place`: the
/// point of the parent.
struct Inferred_branch
{
  std::size_t parent = npos, place = 0;
  int order = 0;
  std::vector<Vector3> points;
  std::vector<double> radii;
};

inline double frustum_volume(double length, double a, double b)
{
  return pcs::internal::pi / 3 * length * (a * a + a * b + b * b);
}

inline double volume_of(const Inferred_branch& branch)
{
  double sum = 0;
  for (std::size_t i = 1; i < branch.points.size(); ++i)
    sum += frustum_volume((branch.points[i] - branch.points[i - 1]).norm(),
                          branch.radii[i - 1],
                          branch.radii[i]);
  return sum;
}

/*
  The share of the volume of a branch that a skeleton contains, for the share v of its volume that
  the scanner sees, and n beams towards it: (1 - (1 - v)^e) (1 - exp(-n v / m)), where e grows with
  n: of a thick branch, a few visible parts suffice. Fitted to the branches of 45 virtual scans, see
  doc/design/skeletons/hidden_wood.md.
*/
inline double found_share(double visible, double beams)
{
  constexpr double fewest_returns = 3;
  const double exponent = std::clamp(1.3 + 0.37 * std::log(std::max(beams, 1e-9) / 15), 1.0, 3.0);
  return (1 - std::pow(1 - visible, exponent)) * -std::expm1(-beams * visible / fewest_returns);
}

/*
  Branches grow on all measured axes by the habit, as if none had been measured. The scanner would
  have shown the share c of a branch, by its place in the visibility of the scan; of a branch with
  the volume V, V c may be part of the skeleton and V (1 - c) is hidden. The density of branches is
  scaled so that the sum of V c equals the measured volume, separately for branches on stems, on
  branches, and on twigs. Each branch is then hidden with the probability 1 - c.
*/
class Hidden_branches
{
public:
  static constexpr std::size_t rows = 3;
  using Rows = std::array<double, rows>;

  Hidden_branches(const habit::Tree_sample& tree,
                  const Tree_habit& habit,
                  const Beam_visibility& visibility)
    : m_tree(tree), m_habit(habit), m_visibility(visibility)
  {
    for (const habit::Axis& a : tree.axes) {
      internal::Tree_growth::Given_axis given;
      given.points = a.points;
      given.at = a.at;
      given.radii = a.radius;
      given.order = a.order;
      given.is_stem = a.kind == habit::Axis_kind::stem;
      given.parent_axis = a.parent;
      m_first_node.push_back(m_number_of_nodes);
      m_number_of_nodes += a.points.size();
      if (a.parent != npos) {
        given.parent_node = m_first_node[a.parent] + a.place;
        if (a.kind == habit::Axis_kind::branch) {
          const double volume = volume_of_axis(a);
          m_measured[tree.axes[a.parent].row()] += volume;
          m_sum += volume;
          m_sum_of_squares += volume * volume;
        }
      }
      m_given.push_back(given);
    }
  }

  /// The relative standard error of the density: 1 / sqrt(n) for n measured branches that were
  /// equally large; few large branches count for more than many small ones.
  double density_error() const { return m_sum > 0 ? std::sqrt(m_sum_of_squares) / m_sum : 0; }

  /// Sets the density of branches by a few simulations; returns the factors by row.
  Rows scale_density(std::uint64_t seed)
  {
    constexpr int number_of_rounds = 2, number_of_trees = 8;
    constexpr double most = 3;
    Rows factors = {1, 1, 1};
    for (int round = 0; round < number_of_rounds; ++round) {
      Rows found{};
      for (int k = 0; k < number_of_trees; ++k)
        for (const Candidate& c : candidates(stream_seed(seed, round, k)))
          if (c.is_on_measured)
            found[c.row] += c.volume * c.found / number_of_trees;
      for (std::size_t i = 0; i < rows; ++i)
        if (found[i] > 0) {
          const double factor = std::clamp(m_measured[i] / found[i], 1 / most, most);
          factors[i] *= factor;
          m_habit.spacing[i] /= factor;
        }
    }
    return factors;
  }

  /// Grows hidden branches; parents precede their branches.
  std::vector<Inferred_branch> grow(std::uint64_t seed) const
  {
    pcs::internal::Random_stream random(seed, 3);
    std::vector<Inferred_branch> result;
    std::vector<std::size_t> name(m_given.size());
    for (std::size_t i = 0; i < name.size(); ++i)
      name[i] = i;
    for (Candidate& c : candidates(seed)) {
      const bool is_hidden = name[c.branch.parent] != npos && random.uniform() >= c.found;
      name.push_back(is_hidden ? m_given.size() + result.size() : npos);
      if (is_hidden) {
        c.branch.parent = name[c.branch.parent];
        result.push_back(std::move(c.branch));
      }
    }
    return result;
  }

private:
  struct Candidate
  {
    Inferred_branch branch; ///< `parent`: a number in the grown tree
    std::size_t row;
    bool is_on_measured;
    double volume, found;
  };

  static std::uint64_t stream_seed(std::uint64_t seed, int round, int k)
  {
    return pcs::internal::Random_stream(seed, 2, round, k).bits();
  }

  static double volume_of_axis(const habit::Axis& a)
  {
    double sum = frustum_volume(a.at.front(), a.radius.front(), a.radius.front());
    for (std::size_t i = 1; i < a.at.size(); ++i)
      sum += frustum_volume(a.at[i] - a.at[i - 1], a.radius[i - 1], a.radius[i]);
    return sum;
  }

  /// All branches that grow on the measured axes, with the share that the scan would show.
  std::vector<Candidate> candidates(std::uint64_t seed) const
  {
    internal::Tree_growth growth(m_habit, seed);
    growth.grow_on(m_given);
    const auto tree = growth.skeleton<habit::Double_kernel>();
    const auto& branches = tree[boost::graph_bundle].branches;
    const auto point = [&](std::size_t v) {
      return Vector3(tree[v].point.x(), tree[v].point.y(), tree[v].point.z());
    };
    std::vector<Candidate> result(branches.size() - m_given.size());
    std::vector<std::size_t> index(num_vertices(tree), 0); // in the branch
    for (std::size_t i = 0; i < m_given.size(); ++i)
      for (std::size_t k = 0; k < m_given[i].points.size(); ++k)
        index[m_first_node[i] + k] = k;
    for (std::size_t v = m_number_of_nodes; v < num_vertices(tree); ++v) {
      Candidate& c = result[tree[v].branch - m_given.size()];
      index[v] = c.branch.points.size();
      if (c.branch.points.empty()) {
        const std::size_t carrier = parent_node<habit::Double_kernel>(v, tree);
        c.branch.parent = tree[carrier].branch;
        c.branch.place = index[carrier];
        c.branch.order = branches[tree[v].branch].order;
        c.is_on_measured = c.branch.parent < m_given.size();
        c.row = c.is_on_measured ? m_tree.axes[c.branch.parent].row()
                                 : static_cast<std::size_t>(std::min(c.branch.order - 1, 2));
      }
      c.branch.points.push_back(point(v));
      c.branch.radii.push_back(tree[v].radius);
    }
    for (Candidate& c : result)
      measure(c);
    return result;
  }

  void measure(Candidate& c) const
  {
    double beams = 0, visible = 0;
    c.volume = 0;
    for (std::size_t i = 1; i < c.branch.points.size(); ++i) {
      const Vector3 a = c.branch.points[i - 1], d = c.branch.points[i] - a, p = a + d / 2;
      const double length = d.norm(), r = (c.branch.radii[i - 1] + c.branch.radii[i]) / 2;
      const double volume = frustum_volume(length, c.branch.radii[i - 1], c.branch.radii[i]);
      beams += m_visibility.number_of_beams(p, d / std::max(length, 1e-300), length, r);
      visible += volume * m_visibility.visible_share(p, r);
      c.volume += volume;
    }
    c.found = c.volume > 0 ? found_share(visible / c.volume, beams) : 1;
  }

  const habit::Tree_sample& m_tree;
  Tree_habit m_habit;
  const Beam_visibility& m_visibility;
  std::vector<internal::Tree_growth::Given_axis> m_given;
  std::vector<std::size_t> m_first_node; // of each given axis
  std::size_t m_number_of_nodes = 0;
  Rows m_measured{}; // volume of branches, by the row of the parent
  double m_sum = 0, m_sum_of_squares = 0;
};

} // namespace hidden
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HIDDEN_HIDDEN_BRANCHES_H

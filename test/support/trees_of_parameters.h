// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Virtual trees of one kind with two known parameters and small individual variations.

#ifndef PCS_TEST_SUPPORT_TREES_OF_PARAMETERS_H
#define PCS_TEST_SUPPORT_TREES_OF_PARAMETERS_H

#include <pcs/generators/edit_branches.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/tree_at_age.h>

#include <CGAL/Simple_cartesian.h>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <vector>

namespace orl_test {

/// The second parameter, besides the age.
enum class Second_parameter {
  crown_angle, ///< between branches and their parents: +-0.3 rad
  tropism      ///< upward bending of branches: +-0.04 per `Tree_habit::bend_length`
};

struct Trees_of_parameters
{
  std::vector<pcs::Tree_skeleton<CGAL::Simple_cartesian<double>>> trees;
  Eigen::MatrixXd known; ///< per tree: age as a fraction of the height, and the other parameter
};

/// In each tree, 5 % of the branches are removed. The others are rotated by 0.05 rad about each
/// axis, and their lengths vary by 5 %.
inline Trees_of_parameters
grow_trees(pcs::Tree_habit habit, Second_parameter second, std::uint64_t seed, int n)
{
  using Vector = CGAL::Simple_cartesian<double>::Vector_3;
  Trees_of_parameters result;
  pcs::internal::Random_stream random(seed);
  result.known.resize(n, 2);
  for (int i = 0; i < n; ++i) {
    const double size = random.uniform(0.8, 1), other = random.uniform(-1, 1);
    const double age = 1 - std::sqrt(1 - size); // growth slows down
    result.known.row(i) << size, other;
    pcs::Tree_habit own = habit;
    if (second == Second_parameter::crown_angle)
      for (pcs::Value_range& range : own.insertion) {
        range.least += 0.3 * other;
        range.largest += 0.3 * other;
      }
    else
      for (const std::size_t k : {1u, 2u})
        own.tropism[k] += 0.04 * other;
    pcs::Tree_skeleton<CGAL::Simple_cartesian<double>> tree;
    pcs::grow_tree(tree, own, pcs::parameters::random_seed(seed));
    tree = pcs::tree_at_age(tree, age);
    std::vector<std::size_t> ids;
    for (const pcs::Tree_branch& b : tree[boost::graph_bundle].branches)
      if (b.parent != pcs::npos)
        ids.push_back(b.id);
    for (const std::size_t id : ids) {
      const Vector turn(random.normal(), random.normal(), random.normal());
      const double stretch = std::exp(0.05 * random.normal());
      const bool is_lost = random.uniform() < 0.05;
      bool is_there = false;
      for (const pcs::Tree_branch& b : tree[boost::graph_bundle].branches)
        is_there = is_there || b.id == id;
      if (!is_there)
        continue;
      if (is_lost) {
        tree = pcs::prune_branch(tree, id);
        continue;
      }
      pcs::turn_branch(tree, id, turn, 0.05 * std::sqrt(turn.squared_length()));
      pcs::lengthen_branch(tree, id, stretch);
    }
    result.trees.push_back(tree);
  }
  return result;
}

/// Multiple correlation of a parameter with uncorrelated scores of unit variance.
inline double correlation(const Eigen::MatrixXd& scores, const Eigen::VectorXd& parameter)
{
  const Eigen::VectorXd truth = parameter.array() - parameter.mean();
  const Eigen::VectorXd fit =
      scores * (scores.transpose() * truth) / static_cast<double>(scores.rows() - 1);
  return fit.dot(truth) / (fit.norm() * truth.norm());
}

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_TREES_OF_PARAMETERS_H

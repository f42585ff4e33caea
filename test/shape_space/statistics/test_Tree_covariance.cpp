// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Covariance of trees: known covariances are found, blocks have equal weights, and missing
// coordinates are predicted from the other trees.

#include <pcs/shape_space/statistics/Tree_covariance.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_Tree_covariance {

using namespace pcs::shape_space;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index block_size = 7; ///< number of coordinates of a branch of one edge

/// Trees with given coordinates, one column per tree.
struct Sample
{
  Orl_layout layout;
  Orl_weights weights;
  Orl_coordinates mean;
  Tree_features features;
  MatrixXd values;
  std::vector<std::vector<char>> has; ///< per tree and block

  explicit Sample(const MatrixXd& numbers)
    : layout(layout_of(std::size_t(numbers.rows() / block_size))),
      features(layout,
               weights,
               pcs::Orl_orientation::gauge_fixed,
               mean,
               pcs::Mode_inner_product::branches),
      values(numbers),
      has(std::size_t(numbers.cols()), std::vector<char>(layout.branches.size(), 1))
  {
    BOOST_TEST_REQUIRE(features.dimension() == numbers.rows());
  }
  Sample(const Sample&) = delete; // the features refer to the layout
  Sample& operator=(const Sample&) = delete;

  Tree_covariance covariance() const
  {
    return Tree_covariance(features, values, has, 1e-9, MatrixXd(), CGAL::Sequential_tag());
  }
  auto block(std::size_t b) { return values.middleRows(features.first(b), block_size); }

private:
  static Orl_layout layout_of(std::size_t blocks)
  {
    Orl_layout result;
    for (std::size_t b = 0; b < blocks; ++b) {
      Orl_layout::Branch branch;
      branch.first_edge = b;
      branch.number_of_edges = 1;
      result.branches.push_back(branch);
      result.edge_before.push_back(none);
    }
    return result;
  }
};

MatrixXd random_matrix(Index rows, Index columns, unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MatrixXd result(rows, columns);
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i)
      result(i, j) = normal(random);
  return result;
}

/// Trees on a line: all coordinates depend on one score each.
MatrixXd on_a_line(const VectorXd& score)
{
  constexpr Index size = 40 * block_size;
  const VectorXd way = random_matrix(size, 1, 1), from = random_matrix(size, 1, 2);
  return (way * score.transpose()).colwise() + from;
}

/// Trees of random coordinates with a given covariance.
MatrixXd random_numbers(Index blocks, const MatrixXd& root_of_covariance)
{
  return random_matrix(blocks * block_size, root_of_covariance.cols(), 3) *
         root_of_covariance.transpose();
}

/// Deviations from the mean of all trees, with trace n.
MatrixXd centered(const MatrixXd& covariance)
{
  const Index n = covariance.rows();
  const MatrixXd center = MatrixXd::Identity(n, n) - MatrixXd::Constant(n, n, 1 / double(n));
  const MatrixXd result = center * covariance * center;
  return result * (double(n) / result.trace());
}

const VectorXd scores = (VectorXd(5) << -2, -0.5, 0.2, 1, 2.5).finished();
const VectorXd deviation = scores.array() - scores.mean();

} // namespace

BOOST_AUTO_TEST_SUITE(covariance_of_trees)

BOOST_AUTO_TEST_CASE(known_covariances_are_found)
{
  // Trees on a line.
  Sample line(on_a_line(scores));
  const Tree_covariance found = line.covariance();
  BOOST_TEST((found.covariance() - centered(deviation * deviation.transpose())).norm() < 1e-3);
  BOOST_TEST((found.mean() - line.values.rowwise().mean()).norm() < 1e-9);
  BOOST_TEST((found.deviations() - (line.values.colwise() - found.mean())).norm() < 1e-9);
  for (std::size_t b = 0; b < 40; ++b) {
    const MatrixXd z = found.deviations().middleRows(line.features.first(b), block_size);
    BOOST_TEST(std::abs(found.variance(b) - z.squaredNorm() / 4) < 1e-9 * z.squaredNorm());
  }
  // Trees, two of which are similar.
  MatrixXd root = MatrixXd::Identity(5, 5);
  root(1, 0) = 1;
  const MatrixXd expected = centered(root * root.transpose());
  const MatrixXd of_random = Sample(random_numbers(1500, root)).covariance().covariance();
  BOOST_TEST((of_random - expected).norm() < 0.1 * expected.norm());
}

BOOST_AUTO_TEST_CASE(one_block_has_one_vote)
{
  Sample sample(random_numbers(30, random_matrix(6, 6, 4)));
  const Tree_covariance before = sample.covariance();
  const MatrixXd& a = before.covariance();
  BOOST_TEST(std::abs(a.trace() - 6) < 1e-9);
  BOOST_TEST((a - a.transpose()).norm() < 1e-9);
  BOOST_TEST(Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues()(0) > -1e-9);
  sample.block(7) *= 1000; // independent of its variance
  const Tree_covariance after = sample.covariance();
  BOOST_TEST((after.covariance() - a).norm() < 1e-9);
  BOOST_TEST(std::abs(after.variance(7) / before.variance(7) - 1e6) < 1);
  BOOST_TEST(std::abs(after.weight(7) / before.weight(7) - 1e-6) < 1e-12);
  BOOST_TEST(std::abs(after.weight(8) / before.weight(8) - 1) < 1e-9);
}

BOOST_AUTO_TEST_CASE(numbers_of_trees_are_but_names)
{
  Sample sample(random_numbers(30, random_matrix(4, 4, 5)));
  for (std::size_t b = 0; b < 30; b += 3)
    sample.has[b % 4][b] = 0;
  const Tree_covariance first = sample.covariance();
  const MatrixXd values = sample.values;
  const std::vector<std::vector<char>> has = sample.has;
  const auto other = [](Index t) { return (t + 1) % 4; };
  for (Index t = 0; t < 4; ++t) {
    sample.values.col(other(t)) = values.col(t);
    sample.has[std::size_t(other(t))] = has[std::size_t(t)];
  }
  const Tree_covariance second = sample.covariance();
  for (Index t = 0; t < 4; ++t) {
    BOOST_TEST((first.deviations().col(t) - second.deviations().col(other(t))).norm() < 1e-9);
    for (Index u = 0; u < 4; ++u)
      BOOST_TEST(std::abs(first.covariance()(t, u) - second.covariance()(other(t), other(u))) <
                 1e-9);
  }
  BOOST_TEST((first.mean() - second.mean()).norm() < 1e-9);
}

BOOST_AUTO_TEST_CASE(a_branch_that_a_tree_lacks_is_what_the_others_let_expect)
{
  Sample sample(on_a_line(scores));
  const MatrixXd all = sample.values;
  for (std::size_t b = 0; b < 40; b += 2)
    sample.has[b / 2 % 5][b] = 0;
  const auto hide = [&](double value) {
    for (std::size_t b = 0; b < 40; b += 2)
      sample.block(b).col(Index(b / 2 % 5)).setConstant(value);
    return sample.covariance();
  };
  const Tree_covariance found = hide(0);
  const MatrixXd wanted = all.colwise() - VectorXd(all.rowwise().mean());
  BOOST_TEST((found.deviations() - wanted).norm() < 0.01 * wanted.norm());
  BOOST_TEST((found.mean() - all.rowwise().mean()).norm() < 0.01 * wanted.norm());
  BOOST_TEST((found.covariance() - centered(deviation * deviation.transpose())).norm() < 0.05);
  // The values of missing branches have no effect.
  const Tree_covariance other = hide(1e6);
  BOOST_TEST((other.covariance() == found.covariance()));
  BOOST_TEST((other.deviations() == found.deviations()));
  BOOST_TEST((other.mean() == found.mean()));
}

BOOST_AUTO_TEST_CASE(equal_trees_and_branches_of_one_tree_do_not_vary)
{
  Sample sample(on_a_line(VectorXd::Constant(3, 0.5)));
  const Tree_covariance equal = sample.covariance();
  BOOST_TEST(equal.covariance().norm() == 0);
  BOOST_TEST(equal.deviations().norm() == 0);
  BOOST_TEST((equal.mean() - sample.values.col(0)).norm() < 1e-12);
  sample.block(2) += random_matrix(block_size, 3, 6);
  sample.block(5) += random_matrix(block_size, 3, 7);
  sample.has[0][5] = sample.has[2][5] = 0; // only one tree has it
  const Tree_covariance found = sample.covariance();
  for (std::size_t b = 0; b < 40; ++b)
    BOOST_TEST((found.variance(b) > 0) == (b == 2));
  BOOST_TEST(std::abs(found.covariance().trace() - 3) < 1e-9);
  BOOST_TEST(found.deviations().middleRows(sample.features.first(5), block_size).norm() == 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Tree_covariance

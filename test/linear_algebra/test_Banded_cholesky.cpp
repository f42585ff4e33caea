// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares banded systems with a dense solver.

#include <pcs/linear_algebra/Banded_cholesky.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Dense>

#include <cstddef>
#include <random>
#include <vector>

namespace test_Banded_cholesky {

BOOST_AUTO_TEST_SUITE(Banded_cholesky)

BOOST_AUTO_TEST_CASE(it_solves_what_a_dense_solver_solves)
{
  constexpr std::size_t width = 3;
  const std::size_t n = 12;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-1, 1);
  pcs::linear_algebra::Banded_cholesky<width> banded;
  banded.reset(n);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i > width ? i - width : 0; j <= i; ++j) {
      const double x = i == j ? 8 : value(random);
      banded(i, j) = x;
      dense(Eigen::Index(i), Eigen::Index(j)) = dense(Eigen::Index(j), Eigen::Index(i)) = x;
    }
  std::vector<double> x(n);
  for (double& v : x)
    v = value(random);
  const Eigen::VectorXd expected =
      dense.ldlt().solve(Eigen::Map<Eigen::VectorXd>(x.data(), Eigen::Index(n)));
  BOOST_REQUIRE(banded.factorize());
  banded.solve(x);
  for (std::size_t i = 0; i < n; ++i)
    BOOST_CHECK_SMALL(x[i] - expected(Eigen::Index(i)), 1e-12);
  const Eigen::MatrixXd inverse = dense.inverse();
  const std::vector<double> diagonal = banded.inverse_diagonal();
  for (std::size_t i = 0; i < n; ++i)
    BOOST_CHECK_SMALL(diagonal[i] - inverse(Eigen::Index(i), Eigen::Index(i)), 1e-12);
}

BOOST_AUTO_TEST_CASE(it_refuses_what_is_not_definite)
{
  pcs::linear_algebra::Banded_cholesky<1> matrix;
  matrix.reset(2);
  matrix(0, 0) = 1;
  matrix(1, 0) = 2;
  matrix(1, 1) = 1;
  BOOST_CHECK(!matrix.factorize());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Banded_cholesky

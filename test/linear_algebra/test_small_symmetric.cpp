// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests small symmetric matrices: residuals of eigenvectors, singular systems, non-finite matrices.

#include <pcs/linear_algebra/small_symmetric.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>
#include <random>

namespace test_small_symmetric {

namespace {

template <int N>
Eigen::Matrix<double, N, N> random_symmetric(std::mt19937& random, Eigen::Index n)
{
  Eigen::Matrix<double, N, N> a(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      a(i, j) = a(j, i) = pcs_test::uniform(random);
  return a;
}

template <int N>
void check_eigen(const Eigen::Matrix<double, N, N>& a)
{
  const auto eigen = pcs::linear_algebra::symmetric_eigen<N>(a);
  const Eigen::Index n = a.rows();
  const double size = std::max(a.norm(), std::numeric_limits<double>::min());
  BOOST_TEST(
      (eigen.vectors.transpose() * eigen.vectors - Eigen::Matrix<double, N, N>::Identity(n, n))
          .norm() <= 1e-14 * double(n));
  BOOST_TEST((a * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm() <=
             1e-14 * size * double(n));
  for (Eigen::Index i = 1; i < n; ++i)
    BOOST_TEST(eigen.values[i - 1] <= eigen.values[i]);
}

} // namespace

BOOST_AUTO_TEST_SUITE(small_symmetric)

BOOST_AUTO_TEST_CASE(eigenvectors_of_random_matrices)
{
  std::mt19937 random(1);
  for (int k = 0; k < 300; ++k) {
    check_eigen<2>(random_symmetric<2>(random, 2));
    check_eigen<3>(random_symmetric<3>(random, 3));
    check_eigen<4>(random_symmetric<4>(random, 4));
  }
  check_eigen<Eigen::Dynamic>(random_symmetric<Eigen::Dynamic>(random, 40));
}

BOOST_AUTO_TEST_CASE(eigenvectors_of_special_matrices)
{
  check_eigen<3>(Eigen::Matrix3d::Zero());
  check_eigen<3>(Eigen::Matrix3d::Identity());
  check_eigen<3>(Eigen::Matrix3d::Constant(1));
  check_eigen<3>(1e-300 * Eigen::Matrix3d::Constant(1));
  check_eigen<3>(1e150 * Eigen::Matrix3d::Constant(1));
  const Eigen::Vector3d v(1, 2, -3);
  check_eigen<3>(v * v.transpose());
  check_eigen<Eigen::Dynamic>(Eigen::MatrixXd(0, 0));
  Eigen::Matrix3d mixed = Eigen::Vector3d(1e12, 1, 1e-12).asDiagonal();
  mixed(0, 1) = mixed(1, 0) = 1e3;
  check_eigen<3>(mixed);
}

BOOST_AUTO_TEST_CASE(what_is_not_finite_stays_so)
{
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Identity();
    a(0, 1) = a(1, 0) = bad;
    BOOST_TEST(!pcs::linear_algebra::symmetric_eigen<3>(a).values.allFinite());
    Eigen::Vector3d x;
    BOOST_TEST(!pcs::linear_algebra::solve_symmetric<3>(a, Eigen::Vector3d(1, 1, 1), x));
    BOOST_TEST(x.norm() == 0);
  }
}

BOOST_AUTO_TEST_CASE(solves_definite_and_singular_systems)
{
  using Matrix = Eigen::Matrix<double, 5, 5>;
  using Vector = Eigen::Matrix<double, 5, 1>;
  std::mt19937 random(2);
  for (int k = 0; k < 200; ++k) {
    const Matrix root = random_symmetric<5>(random, 5);
    Matrix a = root * root;
    const bool is_singular = k % 2 == 1;
    if (is_singular) { // the last unknown has zero coefficients
      a.row(4).setZero();
      a.col(4).setZero();
    }
    const Vector b = a * Vector::LinSpaced(1, 5);
    Vector x;
    BOOST_TEST((pcs::linear_algebra::solve_symmetric<5, 1>(a, b, x)));
    BOOST_TEST((a * x - b).norm() < 1e-12 * (1 + b.norm()));
    if (is_singular)
      BOOST_TEST(x[4] == 0);
  }
}

BOOST_AUTO_TEST_CASE(refuses_what_is_not_semi_definite)
{
  const Eigen::Matrix3d a = Eigen::Vector3d(2, -1, 1).asDiagonal();
  Eigen::Vector3d x;
  BOOST_TEST(!pcs::linear_algebra::solve_symmetric<3>(a, Eigen::Vector3d(1, 1, 1), x));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_small_symmetric

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Short vectors as plain arrays, for compilers without vector types, and the kernels that use them.

#define PCS_NO_VECTOR_EXTENSIONS
#define PCS_NO_RUNTIME_DISPATCH

#include <pcs/deformation/solver/fit_rotations.h>
#include <pcs/deformation/solver/measure_edges.h>
#include <pcs/deformation/upsampling/blend_block.h>
#include <pcs/internal/lanes.h>
#include <pcs/linear_algebra/Sparse_cholesky.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Cholesky>

#include <cmath>

using pcs::internal::Double4;

BOOST_AUTO_TEST_SUITE(plain_lanes)

BOOST_AUTO_TEST_CASE(operators_work_lane_by_lane)
{
  Double4 a, b;
  pcs::internal::fill(3.0, a);
  pcs::internal::fill(-0.5, b);
  a[2] = 8;
  const Double4 sum = a + b, difference = 1.0 - a, product = a * 2.0, quotient = a / b;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = i == 2 ? 8 : 3;
    BOOST_TEST(sum[i] == x - 0.5);
    BOOST_TEST(difference[i] == 1 - x);
    BOOST_TEST(product[i] == 2 * x);
    BOOST_TEST(quotient[i] == x / -0.5);
    BOOST_TEST((-a)[i] == -x);
  }
  a[0] = -0.5;
  Double4 selected;
  pcs::internal::select_less(b, a, sum, product, selected);
  for (std::size_t i = 0; i < 4; ++i)
    BOOST_TEST(selected[i] == (i == 0 ? product[i] : sum[i]));
}

BOOST_AUTO_TEST_CASE(reciprocal_roots_are_exact_to_a_few_units_in_the_last_place)
{
  double largest = 0;
  std::mt19937 random(1);
  for (int e = -280; e <= 280; ++e)
    for (int repetition = 0; repetition < 50; ++repetition) {
      Double4 x, y;
      for (std::size_t i = 0; i < 4; ++i)
        x[i] = (5.5 + 4.5 * pcs_test::uniform(random)) * std::pow(10.0, e);
      pcs::internal::reciprocal_root<pcs::internal::Portable_arithmetic>(x, y);
      for (std::size_t i = 0; i < 4; ++i)
        largest = std::max(largest, std::abs(y[i] * std::sqrt(x[i]) - 1));
    }
  BOOST_TEST(largest < 1e-15);
}

BOOST_AUTO_TEST_CASE(points_and_normals_are_blended)
{
  using namespace pcs::deformation;
  std::mt19937 random(2);
  Affine_map base, other;
  for (int k = 0; k < 9; ++k) {
    base.a[k] = (k % 4 == 0) + 0.2 * pcs_test::uniform(random);
    other.a[k] = (k % 4 == 0) + 0.2 * pcs_test::uniform(random);
  }
  for (int k = 0; k < 3; ++k) {
    base.t[k] = pcs_test::uniform(random);
    other.t[k] = pcs_test::uniform(random);
  }
  const double origin[3] = {0.1, 0.2, 0.3}, frame_origin[3] = {5, 6, 7};
  const Base_map around_origin = base_map(base, origin);
  const Map_difference difference = map_difference(base, other, origin);
  Block_entry entry{0, {}};
  Lane_vectors rest, normal;
  for (std::size_t l = 0; l < lanes; ++l) {
    entry.weight[l] = static_cast<std::uint16_t>(8000 * l);
    for (int c = 0; c < 3; ++c) {
      rest.value[c][l] = pcs_test::uniform(random);
      normal.value[c][l] = pcs_test::uniform(random);
    }
  }
  const Block_input in{&around_origin,
                       &difference,
                       &entry,
                       &entry + 1,
                       &rest,
                       &normal,
                       2,
                       frame_origin,
                       nullptr,
                       nullptr,
                       nullptr,
                       nullptr};
  Block_output out{};
  choose_blend_block<Blend_outputs::normals>()(in, out);
  using Row_major = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  for (std::size_t l = 0; l < lanes; ++l) {
    const double w = 8000 * double(l) / weight_steps;
    const Eigen::Matrix3d a =
        (1 - w) * Eigen::Map<const Row_major>(base.a) + w * Eigen::Map<const Row_major>(other.a);
    const Eigen::Vector3d t = (1 - w) * Eigen::Map<const Eigen::Vector3d>(base.t) +
                              w * Eigen::Map<const Eigen::Vector3d>(other.t);
    const auto at = [&](const Lane_vectors& v) {
      return Eigen::Vector3d(v.value[0][l], v.value[1][l], v.value[2][l]);
    };
    const Eigen::Vector3d expected = 2 * (a * at(rest) + t) + Eigen::Vector3d(5, 6, 7);
    BOOST_TEST((at(out.position) - expected).norm() < 1e-14);
    const Eigen::Vector3d turned = a.determinant() * a.inverse().transpose() * at(normal);
    BOOST_TEST((at(out.normal) - at(normal).norm() * turned.normalized()).norm() < 1e-14);
  }
}

BOOST_AUTO_TEST_CASE(rotations_are_fitted_to_edges)
{
  using namespace pcs::deformation;
  // Edges that fit a rotation exactly give it within a few steps, from another initial rotation.
  const pcs::Quaternion r = pcs::rotation_exp({.2, -.3, .4});
  const Eigen::Vector3d rest[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 1, 3}};
  Eigen::Vector3d position[4];
  Eigen::Matrix3d target[4], covariance;
  for (int i = 0; i < 4; ++i) {
    position[i] = r * rest[i];
    target[i] = r.toRotationMatrix();
  }
  const std::uint32_t first[] = {0, 3}, neighbor[] = {1, 2, 3};
  const double weight[] = {1, .5, 2};
  const double energy =
      choose_measure_edges()({first, neighbor, weight, rest, position, target}, 0, covariance);
  BOOST_TEST(energy < 1e-28);
  pcs::Quaternion present = pcs::Quaternion::Identity();
  for (int step = 0; step < 6; ++step) {
    Rotation_fits fits;
    fits.set(0, covariance, present, pcs::Quaternion::Identity());
    choose_fit_rotations()(0, 1, fits);
    present = pcs::rotation_from_rodrigues(
        {fits.deviation[0][0], fits.deviation[1][0], fits.deviation[2][0]});
  }
  BOOST_TEST((present.coeffs() - r.coeffs()).norm() < 1e-12);
}

BOOST_AUTO_TEST_CASE(sparse_systems_are_solved)
{
  const Eigen::Index n = 30;
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i + 5 < n; ++i) {
    a(i, i) += 2;
    a(i + 5, i + 5) += 2;
    a(i, i + 5) = a(i + 5, i) = -1;
    a(i, i + 1) = a(i + 1, i) = -0.4;
  }
  pcs::linear_algebra::Sparse_cholesky factor;
  BOOST_REQUIRE(factor.factorize(Eigen::MatrixXd(a.triangularView<Eigen::Lower>()).sparseView()));
  std::vector<Eigen::Vector3d> b(static_cast<std::size_t>(n)), work;
  Eigen::MatrixXd rhs(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    rhs.row(i) = b[static_cast<std::size_t>(i)] = Eigen::Vector3d(double(i), 1, -double(i % 3));
  factor.solve(b, work);
  const Eigen::MatrixXd x = a.llt().solve(rhs);
  for (Eigen::Index i = 0; i < n; ++i)
    BOOST_TEST((x.row(i).transpose() - b[static_cast<std::size_t>(i)]).norm() < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

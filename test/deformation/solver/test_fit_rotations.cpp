// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the kernels for edge energies, edge covariances and best-fit rotations with the
// formulas.

#include <pcs/core/rotations.h>
#include <pcs/deformation/solver/fit_rotations.h>
#include <pcs/deformation/solver/measure_edges.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace test_fit_rotations {

namespace {

using namespace pcs::deformation;
using pcs::Quaternion;
using pcs_test::Vec3;
using Matrix = Eigen::Matrix3d;

std::vector<Fit_rotations> all_fits()
{
  std::vector<Fit_rotations> kernels = {&internal::fit_rotations_default, choose_fit_rotations()};
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx2())
    kernels.push_back(&internal::fit_rotations_avx2);
#endif
  return kernels;
}

std::vector<Measure_edges> all_measures()
{
  return {&internal::measure_edges_default, choose_measure_edges()};
}

Matrix random_matrix(std::mt19937& random)
{
  Matrix m;
  for (int c = 0; c < 3; ++c)
    m.col(c) = pcs_test::random_vector(random);
  return m;
}

Quaternion random_rotation(std::mt19937& random, double size)
{
  return pcs::rotation_exp(size * pcs_test::random_vector(random));
}

struct Fit
{
  Matrix covariance;
  Quaternion present, field;

  Vec3 expected(double damping) const
  {
    const Vec3 u =
        pcs::newton_turn(covariance * present.toRotationMatrix().transpose(), damping) / 2;
    const Quaternion q(1, u.x(), u.y(), u.z());
    return pcs::rodrigues_from_rotation(q * (present * field.conjugate()));
  }
};

/// A graph of `n` nodes, each linked to a few others, in memory of exactly its size.
struct Random_graph
{
  std::size_t n;
  std::unique_ptr<Vec3[]> rest, position;
  std::unique_ptr<Matrix[]> target;
  std::vector<std::uint32_t> first, neighbor;
  std::vector<double> weight;

  Random_graph(std::size_t count, std::mt19937& random)
    : n(count),
      rest(new Vec3[count]),
      position(new Vec3[count]),
      target(new Matrix[count]),
      first{0}
  {
    for (std::size_t i = 0; i < n; ++i) {
      rest[i] = pcs_test::random_vector(random);
      position[i] = pcs_test::random_vector(random);
      target[i] = random_matrix(random);
      for (std::size_t k = 0; k < i % 5; ++k) {
        neighbor.push_back(static_cast<std::uint32_t>(k % 2 ? n - 1 - k : (i + k + 1) % n));
        weight.push_back(1.5 + pcs_test::uniform(random));
      }
      first.push_back(static_cast<std::uint32_t>(neighbor.size()));
    }
  }

  Edge_input edges() const
  {
    return {first.data(), neighbor.data(), weight.data(), rest.get(), position.get(), target.get()};
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(fit_rotations)

BOOST_AUTO_TEST_CASE(edges_give_their_energy_and_covariance)
{
  std::mt19937 random(1);
  const Random_graph graph(23, random);
  for (std::size_t i = 0; i < graph.n; ++i) {
    double energy = 0;
    Matrix covariance = Matrix::Zero();
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const Vec3 edge = graph.rest[j] - graph.rest[i], now = graph.position[j] - graph.position[i];
      const Vec3 aim = 0.5 * (graph.target[i] + graph.target[j]) * edge;
      energy += 0.5 * graph.weight[e] * (now - aim).squaredNorm();
      covariance += graph.weight[e] * now * edge.transpose();
    }
    std::vector<Matrix> found;
    std::vector<double> energies;
    for (const Measure_edges measure : all_measures()) {
      found.emplace_back();
      energies.push_back(measure(graph.edges(), i, found.back()));
    }
    BOOST_TEST(std::abs(energies[0] - energy) <= 1e-14 * energy);
    BOOST_TEST((found[0] - covariance).norm() <= 1e-14 * covariance.norm());
    BOOST_TEST(energies[0] == energies[1]);
    BOOST_TEST((found[0] == found[1]));
  }
}

BOOST_AUTO_TEST_CASE(fits_are_steps_of_newton)
{
  std::mt19937 random(2);
  std::vector<Fit> fits;
  for (std::size_t k = 0; k < Rotation_fits::size; ++k) {
    const Quaternion present = random_rotation(random, 3);
    // Near a rotation, far from a rotation, and nearly zero.
    const Matrix noise = random_matrix(random);
    const Matrix exact =
        present.toRotationMatrix() * Vec3(3, 2, k % 4 == 1 ? 0 : 1).asDiagonal().toDenseMatrix();
    const double size = k % 3 == 0 ? 1e-60 : k % 3 == 1 ? 1e40 : 1;
    fits.push_back({size * (k % 2 == 0 ? noise : Matrix(exact + 0.2 * noise)),
                    present,
                    random_rotation(random, 2)});
  }
  fits[5].covariance.setZero();
  fits[6].covariance = -fits[6].present.toRotationMatrix(); // reflected
  // A saddle whose Hessian has a positive determinant, where a Newton step is invalid.
  Matrix saddle = Vec3(-3, 2, 1).asDiagonal();
  saddle(2, 1) = 0.3;
  saddle(1, 2) = -0.3;
  fits[7].covariance = saddle * fits[7].present.toRotationMatrix();
  const double damping = 0.2;
  std::vector<Rotation_fits> results;
  for (const Fit_rotations fit : all_fits()) {
    results.emplace_back();
    for (std::size_t k = 0; k < fits.size(); ++k)
      results.back().set(k, fits[k].covariance, fits[k].present, fits[k].field);
    fit(damping, fits.size(), results.back());
  }
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const Vec3 expected = fits[k].expected(damping);
    const auto at = [k](const Rotation_fits& r) {
      return Vec3(r.deviation[0][k], r.deviation[1][k], r.deviation[2][k]);
    };
    // At half a turn either sign is valid.
    const double difference =
        std::min((at(results[0]) - expected).norm(), (at(results[0]) + expected).norm());
    BOOST_TEST(difference < 1e-12);
    if (expected.norm() < 3.9)
      BOOST_TEST((at(results[0]) - expected).norm() < 1e-12);
    for (const Rotation_fits& other : results)
      BOOST_TEST((at(other) == at(results[0])));
  }
}

// The model of a rotation by `a` about a coordinate axis has its maximum at `tan(a)`, beyond the
// bound of 1.
BOOST_AUTO_TEST_CASE(steps_about_every_axis_are_bounded)
{
  constexpr double angle = 1.2;
  for (int axis = 0; axis < 3; ++axis) {
    const Fit turned{pcs::rotation_exp(angle * Vec3::Unit(axis)).toRotationMatrix(),
                     Quaternion::Identity(),
                     Quaternion::Identity()};
    const Vec3 expected = turned.expected(0);
    BOOST_TEST(expected[axis] > 0.1);
    BOOST_TEST(expected[axis] < 1.5); // 2.0 without the bound
    for (const Fit_rotations fit : all_fits()) {
      Rotation_fits result;
      result.set(0, turned.covariance, turned.present, turned.field);
      fit(0, 1, result);
      for (int k = 0; k < 3; ++k)
        BOOST_TEST(std::abs(result.deviation[k][0] - expected[k]) < 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(fits_beyond_the_count_do_not_matter)
{
  std::mt19937 random(3);
  Rotation_fits few, many;
  for (std::size_t k = 0; k < Rotation_fits::size; ++k) {
    const Fit fit{random_matrix(random), random_rotation(random, 1), random_rotation(random, 1)};
    many.set(k, fit.covariance, fit.present, fit.field);
    if (k < 9)
      few.set(k, fit.covariance, fit.present, fit.field);
  }
  for (const Fit_rotations fit : all_fits()) {
    fit(0.1, 9, few);
    fit(0.1, Rotation_fits::size, many);
    for (std::size_t k = 0; k < 9; ++k)
      for (int i = 0; i < 3; ++i)
        BOOST_TEST(few.deviation[i][k] == many.deviation[i][k]);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_rotations

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of rotation vectors, quaternions, and the best-fit rotation of a set of vectors.

#include <pcs/core/rotations.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/SVD>

namespace test_rotations {

namespace {

using pcs::Quaternion;
using pcs_test::Vec3;
constexpr double pi = 3.14159265358979323846;

double distance_on_cover(const Quaternion& a, const Quaternion& b)
{
  return (a.coeffs() - b.coeffs()).norm();
}

/// The best-fit rotation by singular value decomposition.
Eigen::Matrix3d polar(const Eigen::Matrix3d& m)
{
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0)
    u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

bool is_rotation(const Quaternion& q)
{
  return q.coeffs().allFinite() && std::abs(q.norm() - 1) < 1e-12;
}

} // namespace

BOOST_AUTO_TEST_SUITE(rotations)

BOOST_AUTO_TEST_CASE(exp_is_the_rotation_about_the_axis)
{
  std::mt19937 random(1);
  for (const double angle : {0.0, 1e-200, 1e-9, 9.9e-5, 1.01e-4, 0.5, 3.0, 3.2, 6.3, 12.0, -2.0}) {
    const Vec3 axis = pcs_test::random_direction(random);
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const Eigen::Matrix3d found = pcs::rotation_exp(angle * axis).toRotationMatrix();
    BOOST_TEST((found - expected).norm() < 1e-14);
  }
}

BOOST_AUTO_TEST_CASE(the_smallest_rotation_between_two_directions)
{
  std::mt19937 random(2);
  for (const double angle :
       {0.0, 1e-12, 1e-3, 2.0, pi - 1e-4, pi - 1e-6, pi - 1e-8, pi - 1e-11, pi}) {
    const Vec3 from = pcs_test::random_direction(random), axis = from.unitOrthogonal();
    const Vec3 to = Eigen::AngleAxisd(angle, axis) * from;
    const Quaternion q = pcs::rotation_between(3 * from, 0.5 * to);
    BOOST_TEST_CONTEXT("angle " << angle)
    {
      BOOST_TEST(std::abs(q.norm() - 1) < 1e-7);
      BOOST_TEST((q * from - to).norm() < 1e-7);
      BOOST_TEST(std::abs(q.vec().dot(from)) < 1e-7); // otherwise the angle would be larger
      BOOST_TEST(std::abs(pcs::rotation_log(q).norm() - angle) < 1e-7);
    }
  }
}

BOOST_AUTO_TEST_CASE(exp_has_period_4_pi_on_the_double_cover)
{
  const Vec3 axis = Vec3(1, 2, 3).normalized();
  BOOST_TEST(distance_on_cover(pcs::rotation_exp(2 * pi * axis), Quaternion(-1, 0, 0, 0)) < 1e-14);
  BOOST_TEST(distance_on_cover(pcs::rotation_exp(4 * pi * axis), Quaternion(1, 0, 0, 0)) < 1e-14);
}

BOOST_AUTO_TEST_CASE(log_inverts_exp_up_to_half_a_turn)
{
  std::mt19937 random(2);
  for (const double angle : {0.0, 1e-12, 1e-8, 9.9e-5, 1.01e-4, 1e-3, 1.0, 2.0, 3.0, pi - 1e-3})
    for (int repetition = 0; repetition < 10; ++repetition) {
      const Vec3 u = angle * pcs_test::random_direction(random);
      BOOST_TEST((pcs::rotation_log(pcs::rotation_exp(u)) - u).norm() <= 1e-14 + 1e-14 * angle);
      // The shorter rotation, for both signs of the quaternion.
      const Quaternion q = pcs::rotation_exp(u);
      const Quaternion minus(-q.w(), -q.x(), -q.y(), -q.z());
      BOOST_TEST((pcs::rotation_log(minus) - u).norm() <= 1e-14 + 1e-14 * angle);
    }
}

BOOST_AUTO_TEST_CASE(log_near_half_a_turn_is_one_of_the_two_answers)
{
  std::mt19937 random(3);
  for (const double angle : {pi - 1e-9, pi - 1e-15, pi, pi + 1e-15, pi + 1e-9}) {
    const Vec3 axis = pcs_test::random_direction(random);
    const Vec3 u = pcs::rotation_log(pcs::rotation_exp(angle * axis));
    BOOST_TEST(u.norm() <= pi + 1e-12);
    BOOST_TEST(std::min((u - pi * axis).norm(), (u + pi * axis).norm()) < 1e-8);
  }
}

BOOST_AUTO_TEST_CASE(lifted_log_inverts_exp_on_the_double_cover)
{
  std::mt19937 random(4);
  for (const double angle : {0.0,
                             1e-9,
                             1.0,
                             pi - 1e-9,
                             pi,
                             pi + 1e-9,
                             5.0,
                             2 * pi - 1e-3,
                             2 * pi - 1e-4,
                             2 * pi - 1e-6,
                             2 * pi - 1e-12,
                             2 * pi}) {
    const Vec3 axis = pcs_test::random_direction(random);
    const Quaternion q = pcs::rotation_exp(angle * axis);
    const Vec3 u = pcs::lifted_rotation_log(q);
    BOOST_TEST_CONTEXT("angle " << angle)
    {
      BOOST_TEST(u.norm() <= 2 * pi + 1e-12);
      BOOST_TEST(distance_on_cover(pcs::rotation_exp(u), q) < 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(lifted_log_beyond_one_turn_goes_round_the_other_way)
{
  const Vec3 axis = Vec3(-1, 2, .5).normalized();
  for (const double angle : {2.5 * pi, 3 * pi, 4 * pi - 1e-3}) {
    const Vec3 u = pcs::lifted_rotation_log(pcs::rotation_exp(angle * axis));
    BOOST_TEST((u + (4 * pi - angle) * axis).norm() < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(rodrigues_parameters_are_rotation_vectors_but_for_the_tangent)
{
  std::mt19937 random(8);
  for (const double angle : {0.0, 1e-200, 1e-9, 1e-4, 0.3, 1.0, 3.0, 3.1415}) {
    const Vec3 axis = pcs_test::random_direction(random);
    const Quaternion q = pcs::rotation_exp(angle * axis);
    for (const double length :
         {1.0, -1.0, 1e-100, -7.0}) { // of the quaternion, on both halves of the cover
      const Vec3 u = pcs::rodrigues_from_rotation(Quaternion(length * q.coeffs()));
      BOOST_TEST((u - 4 * std::tan(angle / 4) * axis).norm() <= 1e-14 * angle + 1e-300);
      BOOST_TEST(distance_on_cover(pcs::rotation_from_rodrigues(u), q) < 1e-15);
    }
  }
  BOOST_TEST(std::abs(pcs::rodrigues_from_rotation(Quaternion(0, 0, 2, 0)).norm() - 4) < 1e-15);
  for (const double length : {4.1, 20.0, 1e9, 1e100})
    BOOST_TEST(is_rotation(pcs::rotation_from_rodrigues(length * Vec3(.6, 0, -.8))));
}

BOOST_AUTO_TEST_CASE(improve_rotation_converges_to_the_polar_factor)
{
  std::mt19937 random(5);
  for (int repetition = 0; repetition < 50; ++repetition) {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    const Eigen::Matrix3d r =
        pcs::rotation_exp(2 * pcs_test::random_vector(random)).toRotationMatrix();
    for (int k = 0; k < 8; ++k) {
      const Vec3 rest = pcs_test::random_vector(random);
      covariance += (r * rest + 0.1 * pcs_test::random_vector(random)) * rest.transpose();
    }
    const Quaternion q = pcs::improve_rotation(covariance, Quaternion::Identity(), 200);
    BOOST_TEST((q.toRotationMatrix() - polar(covariance)).norm() < 1e-8);
  }
}

BOOST_AUTO_TEST_CASE(improve_rotation_does_not_depend_on_the_size_of_the_bundle)
{
  const Vec3 rest(1, 2, 3), deformed(3, -1, 2);
  const Eigen::Matrix3d m = deformed * rest.transpose() + Eigen::Matrix3d::Identity();
  const Quaternion one = pcs::improve_rotation(m, Quaternion::Identity(), 5);
  for (const double size : {1e-60, 1e-9, 1e9, 1e60})
    BOOST_TEST(distance_on_cover(pcs::improve_rotation(size * m, Quaternion::Identity(), 5), one) <
               1e-9);
}

BOOST_AUTO_TEST_CASE(an_empty_bundle_leaves_the_rotation_as_it_is)
{
  const Quaternion q = pcs::rotation_exp(Vec3(.1, .2, .3));
  BOOST_TEST(distance_on_cover(pcs::improve_rotation(Eigen::Matrix3d::Zero(), q, 10), q) < 1e-15);
}

BOOST_AUTO_TEST_CASE(a_line_is_turned_onto_its_image_and_not_about_itself)
{
  const Vec3 rest(0, 0, 1), deformed(std::sin(1.2), 0, std::cos(1.2));
  for (const int count : {1, 2}) { // one vector, and two parallel ones
    const Eigen::Matrix3d m = count * deformed * rest.transpose();
    const Quaternion q = pcs::improve_rotation(m, Quaternion::Identity(), 100);
    BOOST_TEST((q * rest - deformed).norm() < 1e-9);
    BOOST_TEST((pcs::rotation_log(q) - Vec3(0, 1.2, 0)).norm() < 1e-8);
  }
}

BOOST_AUTO_TEST_CASE(a_planar_bundle_determines_the_rotation)
{
  const Quaternion expected = pcs::rotation_exp(Vec3(.3, -.7, .5));
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (const Vec3& rest : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 1, 0)})
    m += (expected * rest) * rest.transpose();
  const Quaternion q = pcs::improve_rotation(m, Quaternion::Identity(), 100);
  BOOST_TEST(distance_on_cover(q, expected) < 1e-9);
}

BOOST_AUTO_TEST_CASE(every_bundle_gives_a_rotation)
{
  std::mt19937 random(6);
  const auto check = [](const Eigen::Matrix3d& m) {
    for (int iterations = 0; iterations < 4; ++iterations)
      BOOST_TEST(is_rotation(pcs::improve_rotation(m, Quaternion::Identity(), iterations)));
  };
  check(-Eigen::Matrix3d::Identity());              // point reflection
  check(Vec3(1, -1, -1).asDiagonal());              // half a turn: no torque
  check(Vec3(1, 1, -1).asDiagonal());               // a reflection
  check(Vec3(1, 0, 0) * Vec3(0, 1, 0).transpose()); // perpendicular: no stiffness
  check(1e-300 * Eigen::Matrix3d::Random().eval()); // nearly zero
  check(Vec3(1, 1e-160, 1e-300).asDiagonal());
  for (int repetition = 0; repetition < 1000; ++repetition) {
    const Vec3 a = pcs_test::random_vector(random), b = pcs_test::random_vector(random);
    check(a * b.transpose() - b * a.transpose());
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_rotations

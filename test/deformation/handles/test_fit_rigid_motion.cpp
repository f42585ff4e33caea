// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The rigid motion with the least squared distances to targets.

#include <pcs/deformation/handles/fit_rigid_motion.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

namespace test_fit_rigid_motion {

namespace {

using pcs::deformation::fit_rigid_motion;
using pcs_test::Points;
using pcs_test::Vec3;

double sum_of_squares(const pcs::Similarity& t, const Points& rest, const Points& target)
{
  double sum = 0;
  for (std::size_t i = 0; i < rest.size(); ++i)
    sum += (t(rest[i]) - target[i]).squaredNorm();
  return sum;
}

} // namespace

BOOST_AUTO_TEST_SUITE(fit_rigid_motion)

BOOST_AUTO_TEST_CASE(a_rigid_motion_is_found)
{
  std::mt19937 random(1);
  for (const double angle : {0., 1e-9, .7, 3.1, 3.14159265358979}) {
    const auto motion = pcs::translation(pcs_test::random_vector(random)) *
                        pcs::rotation(pcs_test::random_direction(random), angle, Vec3(1, 2, 3));
    for (const bool is_flat : {false, true}) {
      Points rest = pcs_test::random_points(20, 9), target;
      for (Vec3& p : rest) {
        p.z() *= is_flat ? 0 : 1;
        target.push_back(motion(p));
      }
      const auto found = pcs::deformation::fit_rigid_motion(rest, target);
      BOOST_TEST((found.rotation() - motion.rotation()).norm() < 1e-12);
      BOOST_TEST(std::sqrt(sum_of_squares(found, rest, target)) < 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(no_near_motion_is_better)
{
  std::mt19937 random(2);
  for (int attempt = 0; attempt < 20; ++attempt) {
    const Points rest = pcs_test::random_points(7, 30 + unsigned(attempt));
    const Points target = pcs_test::random_points(7, 60 + unsigned(attempt)); // no relation
    const auto best = pcs::deformation::fit_rigid_motion(rest, target);
    const double least = sum_of_squares(best, rest, target);
    for (int k = 0; k < 50; ++k) {
      const auto other = pcs::translation(.1 * pcs_test::random_vector(random)) *
                         pcs::rotation(pcs_test::random_direction(random), .2, Vec3(0, 0, 0)) *
                         best;
      BOOST_TEST(sum_of_squares(other, rest, target) > least);
    }
  }
}

BOOST_AUTO_TEST_CASE(collinear_points_turn_by_the_angle_between_the_lines)
{
  std::mt19937 random(3);
  for (int attempt = 0; attempt < 20; ++attempt) {
    const Vec3 from = pcs_test::random_direction(random), to = pcs_test::random_direction(random);
    Points rest, target;
    for (const double s : {0., 1., 1.5, 4.}) {
      rest.push_back(Vec3(3, 1, 2) + s * from);
      target.push_back(Vec3(0, -5, 1) + s * to);
    }
    const auto found = pcs::deformation::fit_rigid_motion(rest, target);
    BOOST_TEST(found.total_angle() == std::acos(from.dot(to)), boost::test_tools::tolerance(1e-6));
    BOOST_TEST(std::sqrt(sum_of_squares(found, rest, target)) < 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(the_smallest_rotation_turns_one_direction_to_the_other)
{
  std::mt19937 random(4);
  for (int attempt = 0; attempt < 20; ++attempt) {
    const Vec3 from = pcs_test::random_direction(random);
    const Vec3 near = (from + 1e-9 * pcs_test::random_vector(random)).normalized();
    for (const Vec3& to :
         {pcs_test::random_direction(random), from, near, Vec3(-near), Vec3(-from)}) {
      const auto q = pcs::deformation::smallest_rotation(from, to);
      BOOST_TEST((q * from - to).norm() < 1e-9);
      BOOST_TEST(std::abs(q.norm() - 1) < 1e-12);
      BOOST_TEST(pcs::rotation_log(q).norm() <=
                 std::acos(std::clamp(from.dot(to), -1., 1.)) + 1e-6);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_rigid_motion

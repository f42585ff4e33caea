// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Means and medians of rotations and numbers.

#include <pcs/core/rotations.h>
#include <pcs/shape_space/embedding/mean_rotation.h>
#include <support/drawn.h>

#include <boost/test/unit_test.hpp>

#include <random>
#include <vector>

namespace test_mean_rotation {

using namespace pcs::shape_space;
using pcs::Quaternion;

BOOST_AUTO_TEST_SUITE(mean_rotations)

BOOST_AUTO_TEST_CASE(gross_outliers_do_not_move_an_L1_rotation)
{
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Quaternion center =
        pcs::rotation_exp(pcs_test::drawn<Vec3>([&] { return normal(random); }));
    std::vector<Quaternion> q;
    for (int k = 0; k < 10; ++k) {
      const Vec3 u = k < 7
                         ? 0.05 * pcs_test::drawn<Vec3>([&] { return normal(random); })
                         : 1.4 * pcs_test::drawn<Vec3>([&] { return normal(random); }).normalized();
      q.push_back(center * pcs::rotation_exp(u));
      if (k % 2)
        q.back().coeffs() = -q.back().coeffs();
    }
    const std::vector<double> w(q.size(), 1);
    BOOST_TEST(angle_between(l1_mean_rotation(q, w), center) < 0.1);
  }
}

BOOST_AUTO_TEST_CASE(an_L1_rotation_may_be_a_data_point_or_the_middle_of_an_arc)
{
  const auto turn = [](double angle) { return pcs::rotation_exp(Vec3(0, 0, angle)); };
  const auto mean = [](const std::vector<Quaternion>& q, const std::vector<double>& w) {
    return l1_mean_rotation(q, w);
  };
  BOOST_TEST(angle_between(mean({turn(0), turn(0.2), turn(1)}, {1, 1, 1}), turn(0.2)) < 1e-12);
  BOOST_TEST(angle_between(mean({turn(0), turn(0.2), turn(0.4), turn(1)}, {1, 1, 1, 1}),
                           turn(0.3)) < 1e-9);
  BOOST_TEST(angle_between(mean({turn(0), turn(1)}, {1, 1}), turn(0.5)) < 1e-9);
  BOOST_TEST(angle_between(mean({turn(0), turn(1)}, {1, 3}), turn(1)) < 1e-9);
  BOOST_TEST(angle_between(mean({turn(0.3)}, {1}), turn(0.3)) < 1e-12);
  // The weight exceeds the pull of all others, which are not symmetric.
  const Quaternion a = pcs::rotation_exp(Vec3(0.5, 0, 0)), b = pcs::rotation_exp(Vec3(0, 0.6, 0));
  BOOST_TEST(angle_between(mean({a, b, turn(0.1)}, {1, 1, 2.1}), turn(0.1)) < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_mean_rotation

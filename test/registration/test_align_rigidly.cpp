// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rigid alignment by pairs and by soft correspondences.

#include <pcs/registration/align_rigidly.h>
#include <support/fitted_clouds.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace test_align_rigidly {

namespace {

namespace reg = pcs::registration;
using pcs_test::Points;
using reg::Vec3;
using Tag = CGAL::Parallel_if_available_tag;

} // namespace

BOOST_AUTO_TEST_SUITE(align_rigidly)

BOOST_AUTO_TEST_CASE(pairs_give_the_motion_and_weights_exclude_wrong_pairs)
{
  const Points source = pcs_test::star(20, 0);
  const Eigen::Matrix3d r = pcs::rotation_exp(Vec3(1.5, -1, 0.7)).toRotationMatrix();
  Points target;
  std::vector<double> weight;
  for (const Vec3& p : source) {
    target.push_back(r * p + Vec3(3, 4, 5));
    weight.push_back(1);
  }
  target[3] += Vec3(10, 0, 0);
  weight[3] = 0;
  const reg::Rigid_motion m = reg::fit_motion(source, target, weight);
  BOOST_TEST((m.r - r).norm() < 1e-9);
  BOOST_TEST((m.t - Vec3(3, 4, 5)).norm() < 1e-9);
}

BOOST_AUTO_TEST_CASE(another_sampling_far_away_is_aligned)
{
  const Eigen::Matrix3d r = pcs::rotation_exp(Vec3(0.2, 0.4, -0.5)).toRotationMatrix();
  Points source = pcs_test::star(700, 0), target = pcs_test::star(700, 1);
  for (Vec3& p : target)
    p = r * p + Vec3(20, -30, 5);
  const reg::Rigid_motion m =
      reg::align_rigidly<Tag>(source, target, {0.2, 1e-4, 0.1, 100}, [](std::size_t) {
        return true;
      });
  BOOST_TEST((m.r - r).norm() < 0.02);
  BOOST_TEST((m(Vec3(0, 0, 0)) - Vec3(20, -30, 5)).norm() < 0.1);
}

BOOST_AUTO_TEST_CASE(probabilities_sum_to_the_number_of_target_points_without_outliers)
{
  const Points source = pcs_test::star(50, 0), target = pcs_test::star(70, 1);
  reg::Soft_matches matches;
  reg::find_soft_matches<Tag>(source, target, 0.1, 0, 1, matches);
  BOOST_TEST(matches.total == 70, boost::test_tools::tolerance(1e-9));
  reg::find_soft_matches<Tag>(source, target, 0.1, 0.5, 1, matches);
  BOOST_TEST(matches.total < 69);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_align_rigidly

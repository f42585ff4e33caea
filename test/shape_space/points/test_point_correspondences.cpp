// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Recovery of a known correspondence of points.

#include <pcs/shape_space/points/point_correspondences.h>
#include <support/drawn.h>
#include <support/transport.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace test_point_correspondences {

using pcs::Point_transport;
using pcs::Point_weights;
using pcs::Transport_options;

using namespace pcs::shape_space;
using namespace transport_test;

BOOST_AUTO_TEST_SUITE(point_recovery)

BOOST_AUTO_TEST_CASE(the_correspondence_survives_rotation_and_anisotropic_scale)
{
  // The same points about an edge that is rotated and stretched; noise is in mean spacings.
  for (const std::size_t n : {std::size_t(500), std::size_t(3000)})
    for (const auto& [noise, share] :
         {std::make_pair(0.0, 1.0), std::make_pair(0.1, 0.98), std::make_pair(0.3, 0.78)}) {
      std::mt19937 random(4);
      std::normal_distribution<double> normal;
      const std::vector<Vec3> local = cylinder(random, n);
      const double spacing = mean_spacing(local);
      const Eigen::Matrix3d r = Eigen::AngleAxisd(2, Vec3(1, 1, 2).normalized()).toRotationMatrix();
      const Edge_cone one{Vec3::Zero(), Eigen::Matrix3d::Identity(), 6, 1, 1};
      const Edge_cone two{Vec3(3, 4, 5), r, 6 * 0.6, 1.7, 1.7};
      std::vector<Vec3> aligned, target;
      for (const Vec3& p : local) {
        aligned.push_back(point_of(two, tube_coordinates(one, p, true), true));
        const double s = noise * spacing;
        const Vec3 q = p + s * pcs_test::drawn<Vec3>([&] { return normal(random); });
        target.push_back(two.from + r * Vec3(1.7 * q.x(), 1.7 * q.y(), 0.6 * q.z()));
      }
      Transport_options options;
      options.weights = Point_weights::equal;
      Transport_problem problem;
      const Transport_plan plan =
          match_places(Distinct_positions(aligned), Distinct_positions(target), options, problem);
      BOOST_TEST(plan.is_complete);
      std::size_t right = 0;
      for (const std::uint32_t k : main_arcs(problem, plan))
        right += problem.arcs[k].source == problem.arcs[k].target ? 1 : 0;
      BOOST_TEST_MESSAGE("n " << n << ", noise " << noise << ": " << right << " right");
      BOOST_TEST_CONTEXT("n " << n << " noise " << noise)
      BOOST_TEST(static_cast<double>(right) >= share * static_cast<double>(n));
    }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_point_correspondences

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Assigns points on forks of two tubes with known branches.

#include <pcs/shape_space/points/assign_points.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <random>

namespace test_assign_points {

using pcs::Point_assignment_options;

using namespace pcs::shape_space;

namespace {

double distance_from_axis(const Tube& t, const Vec3& p)
{
  const Vec3 axis = t.to - t.from;
  const double s = std::min(1.0, std::max(0.0, (p - t.from).dot(axis) / axis.squaredNorm()));
  return (p - t.from - s * axis).norm();
}

} // namespace

BOOST_AUTO_TEST_SUITE(assign_points)

BOOST_AUTO_TEST_CASE(points_at_forks_go_to_the_branch_they_lie_on)
{
  constexpr double trunk_radius = 0.2, branch_radius = 0.12, pi = CGAL_PI;
  for (const double degrees : {20., 40., 60., 90.}) {
    const double angle = degrees * pi / 180;
    const Vec3 side(std::sin(angle), 0, std::cos(angle));
    const std::vector<Tube> tubes = {
        {Vec3(0, 0, 0), Vec3(0, 0, 2), trunk_radius, trunk_radius, 0},
        {Vec3(0, 0, 2), Vec3(0, 0, 4), trunk_radius, trunk_radius, 0},
        {Vec3(0, 0, 2), Vec3(0, 0, 2) + 2 * side, branch_radius, branch_radius, 1}};
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    std::vector<Vec3> points;
    std::vector<std::size_t> label;
    std::vector<char> is_near;
    while (points.size() < 20000) {
      const std::size_t k = random() % 3;
      const Tube& t = tubes[k];
      const Vec3 axis = t.to - t.from, e1 = axis.unitOrthogonal(), e2 = axis.normalized().cross(e1);
      const double a = 2 * pi * uniform(random), s = uniform(random);
      if (uniform(random) > t.from_radius / trunk_radius)
        continue; // equal density on all tubes
      const Vec3 radial = std::cos(a) * e1 + std::sin(a) * e2;
      const Vec3 p = t.from + s * axis + t.from_radius * radial;
      bool is_inside = false;
      for (const Tube& other : tubes)
        is_inside = is_inside ||
                    (other.branch != t.branch && distance_from_axis(other, p) < other.from_radius);
      if (is_inside)
        continue;
      points.push_back(p + 0.02 * t.from_radius * normal(random) * radial);
      label.push_back(t.branch);
      // two radii of the trunk from the intersection of the surfaces
      const double reach = trunk_radius / std::sin(angle);
      is_near.push_back((p - Vec3(0, 0, 2) - reach * side).norm() < 2 * trunk_radius);
    }
    const auto tube =
        pcs::shape_space::assign_points<CGAL::Sequential_tag>(points,
                                                              {},
                                                              tubes,
                                                              4,
                                                              Point_assignment_options());
    double right = 0, near = 0, right_near = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_right = tubes[tube[i]].branch == label[i];
      right += is_right;
      near += is_near[i];
      right_near += is_right && is_near[i];
    }
    BOOST_TEST_MESSAGE(degrees << " degrees: " << right / 20000. << ", near the fork "
                               << right_near / near);
    BOOST_TEST(right >= 0.995 * 20000);
    BOOST_TEST(right_near >= 0.95 * near);
  }
}

BOOST_AUTO_TEST_CASE(without_radii_the_nearest_axis_is_taken)
{
  const std::vector<Tube> tubes = {{Vec3(0, 0, 0), Vec3(0, 0, 1), 0, 0, 0},
                                   {Vec3(1, 0, 0), Vec3(1, 0, 1), 0, 0, 1}};
  const std::vector<Vec3> points = {Vec3(0.2, 0, 0.5), Vec3(0.7, 0, 0.5), Vec3(5, 0, 0)};
  const auto tube =
      pcs::shape_space::assign_points<CGAL::Sequential_tag>(points,
                                                            {},
                                                            tubes,
                                                            1,
                                                            Point_assignment_options());
  BOOST_TEST((tube == std::vector<std::size_t>{0, 1, 1}));
  BOOST_TEST(pcs::shape_space::assign_points<CGAL::Sequential_tag>({},
                                                                   {},
                                                                   tubes,
                                                                   1,
                                                                   Point_assignment_options())
                 .empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_assign_points

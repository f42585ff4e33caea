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

BOOST_AUTO_TEST_CASE(the_published_rule_takes_the_least_angle_in_the_plane_of_both_branches)
{
  // a trunk along z, and a branch along x of the same radius
  const std::vector<Tube> tubes = {{Vec3(0, 0, -1), Vec3(0, 0, 1), 0.1, 0.1, 0},
                                   {Vec3(0, 0, 0), Vec3(1, 0, 0), 0.1, 0.1, 1}};
  const auto branch_of = [&](const Vec3& p, const Vec3& normal, pcs::Point_assignment rule) {
    Point_assignment_options options;
    options.rule = rule;
    const auto tube =
        pcs::shape_space::assign_points<CGAL::Sequential_tag>({p}, {normal}, tubes, 2, options);
    return tubes[tube[0]].branch;
  };
  const auto published = [&](const Vec3& p, const Vec3& normal) {
    return branch_of(p, normal, pcs::Point_assignment::by_normal);
  };
  constexpr double pi = CGAL_PI;
  // In the plane, the normals of the trunk and of the branch are x and z. The part of the normal
  // out of the plane, and its sign, have no effect.
  const Vec3 both(0.105, 0, 0.08); // 1.05 radii from the trunk, within the branch
  for (const double sign : {-1., 1.})
    for (const double out : {0., 0.9, 5.})
      for (const double degrees : {0., 30., 44., 46., 60., 90.}) {
        const double a = degrees * pi / 180; // from x
        const Vec3 normal = sign * Vec3(std::cos(a), out, std::sin(a)).normalized();
        BOOST_TEST_CONTEXT(degrees << " degrees, out of the plane " << out)
        BOOST_TEST(published(both, normal) == (degrees < 45 ? 0u : 1u));
      }
  // Beyond 1.1 radii of the trunk, there is one candidate: normals have no effect.
  BOOST_TEST(published(Vec3(0.1101, 0, 0.08), Vec3::UnitX()) == 1u);
  BOOST_TEST(published(Vec3(0.1099, 0, 0.08), Vec3::UnitX()) == 0u);
  BOOST_TEST(published(Vec3(0.15, 0, 0.1099), Vec3::UnitX()) == 1u);
  // Without a candidate, the nearest surface; a normal across the plane, the nearer branch.
  BOOST_TEST(published(Vec3(0.5, 0, 0.3), Vec3::UnitX()) == 1u);
  BOOST_TEST(published(Vec3(-0.3, 0, 0.3), Vec3::UnitZ()) == 0u);
  BOOST_TEST(published(Vec3(0.08, 0, 0.09), Vec3::UnitY()) == 0u);
  // The default also counts distances: this point is on the surface of the branch, and one noise
  // away from that of the trunk, but its normal is a little nearer to that of the trunk.
  const double a = 43.5 * pi / 180;
  const Vec3 on_branch(0.1095, 0, 0.1), normal(std::cos(a), 0, std::sin(a));
  BOOST_TEST(published(on_branch, normal) == 0u);
  BOOST_TEST(branch_of(on_branch, normal, pcs::Point_assignment::by_distance_and_normal) == 1u);
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
  Point_assignment_options published;
  published.rule = pcs::Point_assignment::by_normal;
  BOOST_TEST(
      (pcs::shape_space::assign_points<CGAL::Sequential_tag>(points, {}, tubes, 1, published) ==
       tube));
  BOOST_TEST(pcs::shape_space::assign_points<CGAL::Sequential_tag>({},
                                                                   {},
                                                                   tubes,
                                                                   1,
                                                                   Point_assignment_options())
                 .empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_assign_points

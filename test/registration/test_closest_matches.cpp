// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Which closest points are accepted as matches.

#include <pcs/registration/Fit_target.h>
#include <pcs/registration/closest_matches.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_closest_matches {

namespace {

namespace reg = pcs::registration;
using reg::Vec3;
using Tag = CGAL::Sequential_tag;

/// A square of 20 x 20 points with the side 1 in the plane z = 0.
std::vector<Vec3> square()
{
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      points.emplace_back(i / 19.0, j / 19.0, 0);
  return points;
}

reg::Match_limits limits(double distance, bool is_oriented = false)
{
  reg::Match_limits result;
  result.distance = distance;
  result.is_oriented = is_oriented;
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(closest_matches)

BOOST_AUTO_TEST_CASE(normals_of_a_plane_are_its_normal_and_of_a_line_are_null)
{
  reg::Surface_points plane, line;
  plane.build<Tag>(square(), {});
  for (const Vec3& n : plane.normals())
    BOOST_TEST(std::abs(n.z()) == 1, boost::test_tools::tolerance(1e-12));
  std::vector<Vec3> points;
  for (int i = 0; i < 30; ++i)
    points.emplace_back(i, 2 * i, 3 * i);
  line.build<Tag>(points, {});
  for (const Vec3& n : line.normals())
    BOOST_TEST(n == Vec3(0, 0, 0));
}

BOOST_AUTO_TEST_CASE(a_query_above_the_surface_is_matched_and_one_beside_its_border_is_not)
{
  reg::Surface_points cloud;
  cloud.build<Tag>(square(), {});
  const Vec3 n(0, 0, 1);
  const auto above = reg::find_closest(cloud, Vec3(0.5, 0.5, 0.3), n, limits(1));
  BOOST_TEST(above.weight > 0.99);
  BOOST_TEST(std::abs(above.plane_distance) == 0.3, boost::test_tools::tolerance(1e-9));
  const Vec3 foot(10 / 19.0, 9 / 19.0, 0);
  const auto straight = reg::find_closest(cloud, foot + 0.3 * n, n, limits(1));
  BOOST_TEST((cloud.points()[straight.index] == foot));
  BOOST_TEST(straight.squared_distance == 0.09, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(reg::find_closest(cloud, Vec3(1.3, 0.5, 0.1), n, limits(1)).weight == 0);
  BOOST_TEST(reg::find_closest(cloud, Vec3(0.5, 0.5, 0.3), n, limits(0.2)).weight == 0);
}

BOOST_AUTO_TEST_CASE(normals_must_agree_and_their_side_counts_only_if_it_is_known)
{
  reg::Surface_points cloud;
  cloud.build<Tag>(square(), std::vector<Vec3>(400, Vec3(0, 0, 1)));
  const Vec3 query(0.5, 0.5, 0.1);
  BOOST_TEST(reg::find_closest(cloud, query, Vec3(1, 0, 0), limits(1)).weight == 0);
  BOOST_TEST(reg::find_closest(cloud, query, Vec3(0, 0, -1), limits(1)).weight == 1);
  BOOST_TEST(reg::find_closest(cloud, query, Vec3(0, 0, -1), limits(1, true)).weight == 0);
  BOOST_TEST(reg::find_closest(cloud, query, Vec3(0, 0, 1), limits(1, true)).weight == 1);
}

BOOST_AUTO_TEST_CASE(duplicates_of_a_target_are_dropped_and_indices_are_those_of_the_caller)
{
  std::vector<Vec3> points = square();
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    points.insert(points.begin(), points.back()); // the same point many times
  reg::Fit_target target;
  target.build<Tag>(points, {}, 1000);
  BOOST_TEST(target.all.size() == n);
  for (std::size_t k = 0; k < n; ++k)
    BOOST_TEST(points[target.input[k]] == target.all.points()[k]);
  BOOST_TEST(target.fine.size() > 1u);
  BOOST_TEST_REQUIRE(target.fine_normals.size() == target.fine.size());
  for (const Vec3& normal : target.fine_normals)
    BOOST_TEST(std::abs(normal.z()) == 1, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(isolated_points_are_dropped_and_a_step_of_the_density_is_not)
{
  std::vector<Vec3> points = square();
  for (int i = 0; i < 10; ++i) // the other half with a quarter of the density
    for (int j = 0; j < 10; ++j)
      points.emplace_back(1.1 + i / 9.5, j / 9.5, 0);
  const std::size_t n = points.size();
  for (int k = 0; k < 5; ++k)
    points.emplace_back(0.2 * k, 0.5, 0.5 + 0.1 * k);
  reg::Fit_target target;
  target.build<Tag>(points, {}, 1000);
  BOOST_TEST(target.all.size() == n);
  for (const Vec3& p : target.all.points())
    BOOST_TEST(p.z() == 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_closest_matches

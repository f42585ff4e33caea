// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Walls and roofs are removed with attached objects; the ground and round objects remain.

#include <pcs/skeleton/clutter/mark_walls.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace test_mark_walls {

using namespace pcs::skeleton;

namespace {

/// Objects of several points each, with queries about the remaining points.
class Yard
{
public:
  Scan scan;
  std::vector<std::uint8_t> is_used;

  /// Adds a rectangle from a corner along two sides; returns the index of the object.
  int add_face(const Vec3& corner, const Vec3& a, const Vec3& b)
  {
    std::normal_distribution<double> normal(0, 0.002);
    const Vec3 n = a.cross(b).normalized();
    const int count = static_cast<int>(a.cross(b).norm() / (step * step));
    for (int k = 0; k < count; ++k) {
      const double s = share(), t = share();
      m_points.push_back(corner + s * a + t * b + normal(m_random) * n);
    }
    return finish();
  }
  int add_stem(const Vec3& base, double radius, double height)
  {
    const int count = static_cast<int>(2 * CGAL_PI * radius * height / (step * step));
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * CGAL_PI * share(), z = height * share();
      m_points.push_back(base + Vec3(radius * std::cos(angle), radius * std::sin(angle), z));
    }
    return finish();
  }
  /// Random points in a ball.
  int add_crown(const Vec3& middle, double radius)
  {
    for (int k = 0; k < 8000; ++k) {
      const double z = 2 * share() - 1, y = 2 * share() - 1, x = 2 * share() - 1;
      if (const Vec3 p(x, y, z); p.norm() < 1)
        m_points.push_back(middle + radius * p);
    }
    return finish();
  }

  void prepare()
  {
    prepare_scan<CGAL::Sequential_tag>(m_points, Vec3::UnitZ(), scan);
    is_used.assign(scan.size(), 1);
  }
  std::vector<Flat_face> faces() const { return flat_faces(scan, Wall_options(), is_used); }
  std::vector<Flat_face> walls() const
  {
    return walls_and_roofs(scan, faces(), Vec3::UnitZ(), Wall_options(), is_used);
  }

  /// Fraction of the points of an object that are still used.
  double used(int thing) const
  {
    const std::size_t begin = thing > 0 ? m_end[std::size_t(thing) - 1] : 0;
    const std::size_t end = m_end[std::size_t(thing)];
    double count = 0;
    for (std::size_t i = begin; i < end; ++i)
      count += is_used[scan.point_of_input[i]];
    return count / double(end - begin);
  }
  std::size_t number_of_used() const
  {
    return static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), 1));
  }

private:
  static constexpr double step = 0.03;

  double share() { return std::uniform_real_distribution<double>(0, 1)(m_random); }
  int finish()
  {
    m_end.push_back(m_points.size());
    return static_cast<int>(m_end.size()) - 1;
  }

  std::mt19937 m_random{11};
  std::vector<Vec3> m_points;
  std::vector<std::size_t> m_end; ///< of each object
};

} // namespace

BOOST_AUTO_TEST_SUITE(walls_and_roofs_of_scans)

BOOST_AUTO_TEST_CASE(a_wall_goes_and_the_stem_before_it_stays)
{
  for (const double turn : {0.0, 0.3, 1.9}) {
    const Vec3 along(std::cos(turn), std::sin(turn), 0), normal(-std::sin(turn), std::cos(turn), 0);
    Yard yard;
    const int wall = yard.add_face(-2 * along, 4 * along, Vec3(0, 0, 3));
    const int stem = yard.add_stem(1.5 * normal, 0.15, 3.5);
    yard.prepare();
    const std::vector<Flat_face> faces = yard.faces();
    BOOST_TEST_REQUIRE(!faces.empty());
    for (const Flat_face& face : faces)
      BOOST_TEST(std::abs(yard.scan.frame.direction_to_input(face.plane.normal).dot(normal)) >
                 0.999);
    const std::size_t before = yard.number_of_used();
    const std::size_t marked = mark_faces(yard.scan, faces, yard.is_used);
    BOOST_TEST(marked == before - yard.number_of_used());
    BOOST_TEST(yard.used(wall) < 0.01);
    BOOST_TEST(yard.used(stem) == 1);
    BOOST_TEST(mark_faces(yard.scan, faces, yard.is_used) == 0u); // already removed
  }
}

BOOST_AUTO_TEST_CASE(what_is_round_or_has_no_order_has_no_faces)
{
  for (const double radius : {0.1, 0.3, 0.6}) {
    Yard yard;
    yard.add_stem(Vec3::Zero(), radius, 6);
    yard.prepare();
    BOOST_TEST(yard.faces().empty());
  }
  Yard yard;
  yard.add_crown(Vec3::Zero(), 2);
  yard.prepare();
  BOOST_TEST(yard.faces().empty());
}

BOOST_AUTO_TEST_CASE(a_roof_beside_walls_goes_and_the_ground_stays)
{
  for (const bool has_wall : {true, false}) {
    Yard yard;
    const int ground = yard.add_face(Vec3(-2, -2, 0), Vec3(4, 0, 0), Vec3(0, 4, 0));
    const int roof = yard.add_face(Vec3(-2, 0, 3), Vec3(4, 0, 0), Vec3(0, 2, 0.6));
    const int wall =
        has_wall ? yard.add_face(Vec3(-2, 0, 0.1), Vec3(4, 0, 0), Vec3(0, 0, 2.8)) : -1;
    yard.prepare();
    BOOST_TEST(yard.faces().size() >= (has_wall ? 3u : 2u));
    mark_faces(yard.scan, yard.walls(), yard.is_used);
    BOOST_TEST(yard.used(ground) > 0.97);
    if (has_wall) {
      BOOST_TEST(yard.used(wall) < 0.01);
      BOOST_TEST(yard.used(roof) < 0.01);
    } else // horizontal faces may be slopes
      BOOST_TEST(yard.used(roof) == 1);
  }
}

BOOST_AUTO_TEST_CASE(a_post_beside_a_wall_goes_with_it_and_a_stem_farther_away_stays)
{
  Yard yard;
  const int wall = yard.add_face(Vec3(-2, 0, 0), Vec3(4, 0, 0), Vec3(0, 0, 3));
  const int post = yard.add_stem(Vec3(0.5, 0.12, 0), 0.04, 3);
  const int stem = yard.add_stem(Vec3(0, 1.5, 0), 0.15, 3.5);
  yard.prepare();
  const std::vector<Flat_face> walls = yard.walls();
  mark_faces(yard.scan, walls, yard.is_used);
  BOOST_TEST(yard.used(wall) < 0.01);
  BOOST_TEST(yard.used(post) > 0.9);
  const pcs::skeleton::Compact_links links(CGAL::Sequential_tag(), yard.scan, yard.is_used, {});
  const auto mark = [&](const std::vector<Flat_face>& faces) {
    return mark_beside_faces(yard.scan, faces, links, Wall_options(), yard.is_used);
  };
  BOOST_TEST(mark({}) == 0u);
  const std::size_t before = yard.number_of_used(), marked = mark(walls);
  BOOST_TEST(marked == before - yard.number_of_used());
  BOOST_TEST(yard.used(post) < 0.01);
  BOOST_TEST(yard.used(stem) == 1);
}

BOOST_AUTO_TEST_CASE(points_that_are_not_used_make_no_faces)
{
  Yard yard;
  yard.add_face(Vec3(-2, 0, 0), Vec3(4, 0, 0), Vec3(0, 0, 3));
  yard.prepare();
  BOOST_TEST(!yard.faces().empty());
  for (std::size_t i = 20; i < yard.is_used.size(); ++i) // too few points remain for a wall
    yard.is_used[i] = 0;
  BOOST_TEST(yard.faces().empty());
  std::fill(yard.is_used.begin(), yard.is_used.end(), 0);
  BOOST_TEST(yard.faces().empty());
  BOOST_TEST(yard.walls().empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_mark_walls

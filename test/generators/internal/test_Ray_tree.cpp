// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the first hits of rays with a test of all triangles.

#include <pcs/generators/internal/Ray_tree.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace test_Ray_tree {

using namespace pcs::generators::internal;
using Eigen::Vector3d;

namespace {

Vector3f draw(std::mt19937& random)
{
  std::uniform_real_distribution<float> uniform(-1, 1);
  const float x = uniform(random), y = uniform(random);
  return Vector3f(x, y, uniform(random));
}

std::vector<Triangle> random_triangles(std::mt19937& random, std::size_t n, float size)
{
  std::vector<Triangle> result;
  for (std::size_t k = 0; k < n; ++k) {
    const Vector3f corner = draw(random), edge = size * draw(random);
    result.push_back({corner, edge, size * draw(random)});
  }
  return result;
}

struct Hit
{
  double range = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = no_triangle;
  bool is_sure = true; ///< the ray passes through no edge
};

/// The first hit by linear systems, in doubles.
Hit first_hit(const std::vector<Triangle>& triangles, const Vector3f& from, const Vector3f& along)
{
  Hit hit;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    Eigen::Matrix3d m;
    m << triangles[k].edge_1.cast<double>(), triangles[k].edge_2.cast<double>(),
        -along.cast<double>();
    const Vector3d x =
        m.fullPivLu().solve((from - triangles[k].corner).cast<double>()); // u, v and the range
    const double inside = std::min({x[0], x[1], 1 - x[0] - x[1]});
    if (!(x[2] > 0) || !(inside > -1e-3))
      continue;
    if (inside < 1e-3)
      hit.is_sure = false;
    else if (x[2] < hit.range) {
      hit.range = x[2];
      hit.triangle = static_cast<std::uint32_t>(k);
    }
  }
  return hit;
}

Beam beam_at(const Vector3f& origin, const Vector3f& along)
{
  Beam beam;
  beam.origin = origin;
  for (std::size_t lane = 0; lane < beam.direction.size(); ++lane)
    beam.direction[lane] = (along + 0.02F * Vector3f(0, float(lane), -float(lane))).normalized();
  return beam;
}

} // namespace

BOOST_AUTO_TEST_SUITE(ray_tree)

BOOST_AUTO_TEST_CASE(it_finds_the_first_of_all_triangles)
{
  std::mt19937 random(3);
  const std::vector<Triangle> triangles = random_triangles(random, 600, 0.2F);
  Ray_tree tree;
  tree.build<CGAL::Sequential_tag>(triangles);
  std::size_t number_of_hits = 0, number_of_misses = 0;
  for (int k = 0; k < 300; ++k) {
    const Vector3f origin = 1.5F * draw(random); // within the triangles or outside of them
    const Beam beam = beam_at(origin, draw(random).normalized());
    const Beam_hits found = tree.first_hits(beam);
    for (std::size_t lane = 0; lane < beam.direction.size(); ++lane) {
      const Hit hit = first_hit(triangles, origin, beam.direction[lane]);
      if (!hit.is_sure)
        continue;
      BOOST_TEST(found.triangle[lane] == hit.triangle);
      if (hit.triangle == no_triangle) {
        ++number_of_misses;
        BOOST_TEST(std::isinf(found.range[lane]));
      } else {
        ++number_of_hits;
        BOOST_TEST(std::abs(double(found.range[lane]) / hit.range - 1) < 1e-3);
      }
    }
  }
  BOOST_TEST(number_of_hits > 200u);
  BOOST_TEST(number_of_misses > 200u);
}

BOOST_AUTO_TEST_CASE(of_coincident_triangles_the_one_with_the_lower_number_is_hit)
{
  std::mt19937 random(4);
  std::vector<Triangle> triangles = random_triangles(random, 100, 0.1F);
  const Triangle wall{Vector3f(-9, -9, 2), Vector3f(40, 0, 0), Vector3f(0, 40, 0)};
  triangles[70] = triangles[30] = triangles[95] = wall;
  Ray_tree tree;
  tree.build<CGAL::Sequential_tag>(triangles);
  const Beam_hits hits = tree.first_hits(beam_at(Vector3f(0, 0, 3), Vector3f(0, 0, -1)));
  for (const std::uint32_t t : hits.triangle)
    BOOST_TEST(t == 30u);
}

BOOST_AUTO_TEST_CASE(a_flat_grid_has_no_holes)
{
  // Rays through the common edges and corners of triangles in one plane.
  std::vector<Triangle> triangles;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      const Vector3f a(float(i), float(j), 0), x(1, 0, 0), y(0, 1, 0);
      triangles.push_back({a, x, y});
      triangles.push_back({a + x + y, -x, -y});
    }
  Ray_tree tree;
  tree.build<CGAL::Sequential_tag>(triangles);
  for (int i = 1; i < 20; ++i)
    for (int j = 1; j < 20; ++j) {
      Beam beam;
      beam.origin = Vector3f(10, 10, 7);
      for (std::size_t lane = 0; lane < beam.direction.size(); ++lane)
        beam.direction[lane] =
            (Vector3f(float(i), float(j) + 0.25F * float(lane), 0) - beam.origin).normalized();
      for (const std::uint32_t t : tree.first_hits(beam).triangle)
        BOOST_TEST(t != no_triangle);
    }
}

BOOST_AUTO_TEST_CASE(without_triangles_nothing_is_hit)
{
  Ray_tree tree;
  tree.build<CGAL::Sequential_tag>({});
  const Beam_hits hits = tree.first_hits(beam_at(Vector3f::Zero(), Vector3f::UnitX()));
  BOOST_TEST(hits.triangle[0] == no_triangle);
  BOOST_TEST(std::isinf(hits.range[0]));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Ray_tree

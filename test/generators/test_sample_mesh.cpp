// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests Poisson-disk sampling of meshes: least distance, density, area and normals.

#include <pcs/core/errors.h>
#include <pcs/generators/sample_mesh.h>
#include <support/exceptions.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

namespace test_sample_mesh {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Samples = std::vector<std::pair<Point, Kernel::Vector_3>>;
using Faces = std::vector<std::vector<int>>;
namespace np = pcs::parameters;

/// A box of sides 1, 2 and 0.5 with outward normals, far from the origin.
const std::vector<Point> corners = {{700000, 0, 0},
                                    {700001, 0, 0},
                                    {700001, 2, 0},
                                    {700000, 2, 0},
                                    {700000, 0, 0.5},
                                    {700001, 0, 0.5},
                                    {700001, 2, 0.5},
                                    {700000, 2, 0.5}};
const Faces box =
    {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

Samples sample(const Faces& faces, double spacing, unsigned seed = 0)
{
  Samples samples;
  pcs::sample_mesh(corners, faces, spacing, std::back_inserter(samples), np::random_seed(seed));
  return samples;
}

} // namespace

BOOST_AUTO_TEST_SUITE(sample_mesh)

BOOST_AUTO_TEST_CASE(no_two_points_are_too_near_and_no_gap_is_wide)
{
  const double spacing = 0.08;
  const Samples samples = sample(box, spacing);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, CGAL::squared_distance(samples[i].first, samples[j].first));
  BOOST_TEST(std::sqrt(least) >= spacing * (1 - 1e-9));
  double widest = 0; // distance from a place of the upper face to its nearest point
  for (double x = 0; x <= 1; x += 0.02)
    for (double y = 0; y <= 2; y += 0.02) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& s : samples)
        nearest = std::min(nearest, CGAL::squared_distance(s.first, Point(700000 + x, y, 0.5)));
      widest = std::max(widest, std::sqrt(nearest));
    }
  BOOST_TEST_MESSAGE(samples.size() << " points, widest gap " << widest / spacing);
  BOOST_TEST(widest < 1.5 * spacing);
}

BOOST_AUTO_TEST_CASE(the_number_of_points_is_that_of_the_area)
{
  const double area = 2 * (2 + 0.5 + 1), spacing = 0.01;
  const Samples samples = sample(box, spacing);
  BOOST_TEST(std::abs(double(samples.size()) * spacing * spacing / area - 0.61) < 0.02);
  std::size_t above = 0; // by the area of the face
  for (const auto& s : samples)
    above += s.first.z() > 0.5 - 1e-9;
  BOOST_TEST(std::abs(double(above) / double(samples.size()) - 2 / area) < 0.01);
}

BOOST_AUTO_TEST_CASE(points_lie_on_faces_and_normals_point_outwards)
{
  for (const auto& [p, n] : sample(box, 0.05)) {
    const std::array<double, 3> far = {p.x() - 700000.5, p.y() - 1, p.z() - 0.25};
    const std::array<double, 3> half = {0.5, 1, 0.25};
    int number_of_faces = 0;
    for (int k = 0; k < 3; ++k) {
      BOOST_TEST(std::abs(far[std::size_t(k)]) <= half[std::size_t(k)] + 1e-9);
      if (std::abs(n[k]) > 0.5) {
        ++number_of_faces;
        const double side = n[k] > 0 ? 1 : -1;
        BOOST_TEST(std::abs(far[std::size_t(k)] - side * half[std::size_t(k)]) < 1e-9);
      }
    }
    BOOST_TEST(number_of_faces == 1);
    BOOST_TEST(std::abs(n.squared_length() - 1) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(the_seed_alone_determines_the_points)
{
  BOOST_TEST((sample(box, 0.1, 5) == sample(box, 0.1, 5)));
  BOOST_TEST((sample(box, 0.1, 5) != sample(box, 0.1, 6)));
}

BOOST_AUTO_TEST_CASE(faces_without_area_get_no_points)
{
  Faces faces = box;
  faces.push_back({0, 1, 1});
  BOOST_TEST((sample(faces, 0.1) == sample(box, 0.1)));
  for (const double spacing : {100., 1e200, 1e300})
    BOOST_TEST(sample({{0, 1, 2}}, spacing).size() == 1u); // at least one point
}

BOOST_AUTO_TEST_CASE(polygons_are_divided_around_their_first_corner_or_refused)
{
  const std::vector<Point> places = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 1, 0}, {2, 1e-9, 0}};
  const auto sample_face = [&](const std::vector<int>& face) {
    Samples samples;
    pcs::sample_mesh(places, Faces{face}, 0.1, std::back_inserter(samples));
    return samples;
  };
  // a concave corner comes first: its triangles cover the face
  const Samples samples = sample_face({3, 0, 1, 2});
  BOOST_TEST(std::abs(double(samples.size()) * 0.01 / 4 - 0.65) < 0.1);
  for (const auto& [p, n] : samples)
    BOOST_TEST(std::min(3 * p.y() - p.x(), p.y() - 3 * p.x() + 8) <= 1e-9);
  for (const std::vector<int>& face : {std::vector<int>{0, 1, 2, 3}, {0, 2, 1, 3}, {1, 3, 2, 0}})
    BOOST_CHECK_EXCEPTION(sample_face(face),
                          pcs::Invalid_input,
                          pcs_test::message_has("face 0 is not convex"));
  BOOST_TEST(!sample_face({0, 4, 1, 2}).empty()); // inverted by rounding only
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double spacing : {0., -1., nan, std::numeric_limits<double>::infinity()})
    BOOST_CHECK_EXCEPTION(sample(box, spacing),
                          pcs::Invalid_input,
                          pcs_test::message_has("must be a positive"));
  BOOST_CHECK_EXCEPTION(sample(box, 1e-7),
                        pcs::Invalid_input,
                        pcs_test::message_has("expected more than 4.1833e-05"));
  BOOST_CHECK_EXCEPTION(sample({{0, 1}}, 1),
                        pcs::Invalid_input,
                        pcs_test::message_has("face 0 has 2 corners"));
  BOOST_CHECK_EXCEPTION(sample({{0, 1, 8}}, 1),
                        pcs::Invalid_input,
                        pcs_test::message_has("has the corner 8"));
  BOOST_CHECK_EXCEPTION(sample({{0, 1, -1}}, 1),
                        pcs::Invalid_input,
                        pcs_test::message_has("has the corner -1"));
  BOOST_CHECK_EXCEPTION(sample({}, 1), pcs::Invalid_input, pcs_test::message_has("no area"));
  BOOST_CHECK_EXCEPTION(sample({{0, 0, 1}}, 1),
                        pcs::Invalid_input,
                        pcs_test::message_has("no area"));
  std::vector<Point> points = corners;
  points[2] = Point(nan, 0, 0);
  Samples samples;
  BOOST_CHECK_EXCEPTION(pcs::sample_mesh(points, box, 0.1, std::back_inserter(samples)),
                        pcs::Invalid_input,
                        pcs_test::message_has("point 2 of face 0 is not finite"));
  BOOST_TEST(samples.empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_sample_mesh

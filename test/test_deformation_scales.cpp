// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scaled handles: bodies between them become thicker, and longer where the handles leave room.

#include <pcs/core/Similarity.h>
#include <support/deform_cloud.h>
#include <support/deformation_cases.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <random>

namespace test_deformation_scales {

namespace {

using pcs_test::deform;
using pcs_test::Handles;
using pcs_test::Options;
using pcs_test::Points;
using pcs_test::Vec3;

/// Random points on a tube along z, or on one side of it if `half` is set.
Points tube(double length, double radius, bool is_half = false)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  Points points;
  for (int i = 0; i < 6000; ++i) {
    const double z = length * share(random),
                 angle = (is_half ? 1 : 2) * pcs_test::pi * share(random);
    points.push_back(Vec3(radius * std::cos(angle), radius * std::sin(angle), z));
  }
  return points;
}

Handles ends(const Points& points, double length, const pcs::Similarity& of_upper)
{
  return pcs_test::two_handles(
      points,
      [&](const Vec3& p) { return p.z() < .05 * length; },
      [&](const Vec3& p) { return p.z() > .95 * length; },
      of_upper);
}

/// Mean distance from the z axis between two heights at rest.
double mean_radius(const Points& rest, const Points& now, double low, double high)
{
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (rest[i].z() >= low && rest[i].z() < high) {
      sum += std::hypot(now[i].x(), now[i].y());
      ++count;
    }
  return sum / count;
}

/// Largest distance of the section centers from the z axis.
double largest_bow(const Points& rest, const Points& now, double length)
{
  double largest = 0;
  for (int k = 0; k < 20; ++k) {
    Vec3 middle = Vec3::Zero(), before = Vec3::Zero();
    double count = 0;
    for (std::size_t i = 0; i < rest.size(); ++i)
      if (rest[i].z() >= k * length / 20 && rest[i].z() < (k + 1) * length / 20) {
        middle += now[i];
        before += rest[i];
        ++count;
      }
    const Vec3 offset = (middle - before) / count;
    largest = std::max(largest, std::hypot(offset.x(), offset.y()));
  }
  return largest;
}

} // namespace

BOOST_AUTO_TEST_SUITE(deformation_scales)

BOOST_AUTO_TEST_CASE(a_scaled_end_makes_a_rod_thicker_and_no_longer)
{
  // A rod that became longer as well would buckle between its ends.
  const double length = 6, radius = .1;
  const Points points = tube(length, radius);
  for (const double factor : {2.0, 0.5})
    for (const bool is_converged : {false, true}) {
      Options options;
      if (is_converged) {
        options.number_of_iterations = 300;
        options.tolerance = 1e-5;
      }
      const auto handles = ends(points, length, pcs::scaling(factor, Vec3(0, 0, .975 * length)));
      const auto result = deform(points, handles, options);
      const double bow = largest_bow(points, result.points, length);
      const double middle = mean_radius(points, result.points, .45 * length, .55 * length);
      BOOST_TEST_MESSAGE("scale " << factor << ": bow " << bow << ", radius in the middle "
                                  << middle / radius << " times, "
                                  << result.report.number_of_iterations << " passes");
      BOOST_TEST(bow < .03 * length);
      if (!is_converged)
        BOOST_TEST(std::abs(middle / radius - std::sqrt(factor)) < .15 * std::sqrt(factor));
    }
}

BOOST_AUTO_TEST_CASE(a_body_with_room_grows_in_length)
{
  // Scaling about the other end gives a cone whose lengths grow with its radii.
  const double length = 4;
  const Points points = tube(length, .5);
  const auto handles = ends(points, length, pcs::scaling(2, Vec3::Zero()));
  const auto result = deform(points, handles);
  BOOST_TEST(largest_bow(points, result.points, length) < .02 * length);
  // With scale 2^(z / length), z is mapped to length (2^(z / length) - 1) / log 2, and the whole
  // length nearly to 2 length.
  double previous = 0;
  for (int k = 1; k < 9; ++k) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::abs(points[i].z() - k * length / 10) < .02 * length) {
        sum += result.points[i].z();
        ++count;
      }
    const double step = sum / count - previous;
    BOOST_TEST(step > (k == 1 ? 0 : .9 * length / 10));
    previous = sum / count;
  }
  BOOST_TEST(previous > 1.2 * .8 * length);
}

BOOST_AUTO_TEST_CASE(nearly_the_same_scale_everywhere_is_nearly_a_similarity)
{
  const double length = 4;
  const Points points = tube(length, .5, true);
  const auto similarity = pcs::scaling(2, Vec3::Zero());
  for (const double share : {0.0, 1e-7, 1e-3}) {
    auto handles = ends(points, length, pcs::scaling(2 * (1 + share), Vec3::Zero()));
    handles.front().transformation = similarity;
    const auto result = deform(points, handles);
    double largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      largest = std::max(largest, (result.points[i] - similarity(points[i])).norm());
    BOOST_TEST_MESSAGE("share " << share << ": " << largest / length);
    BOOST_TEST(largest < (3 * share + 1e-9) * length * 2);
  }
}

BOOST_AUTO_TEST_CASE(an_open_shell_does_not_buckle_at_once)
{
  const double length = 4;
  const Points points = tube(length, .5, true);
  const auto handles = ends(points, length, pcs::scaling(2, Vec3(0, .3, .975 * length)));
  const auto result = deform(points, handles);
  double largest = 0; // for a scaling about an axis, points remain in planes that contain it
  for (std::size_t i = 0; i < points.size(); ++i)
    largest = std::max(largest, std::abs(result.points[i].z() - points[i].z()));
  BOOST_TEST(largest < .1 * length);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deformation_scales

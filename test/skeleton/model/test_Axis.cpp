// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Resampling of an axis, and the nearest position on it.

#include <pcs/skeleton/model/Axis.h>

#include <boost/test/unit_test.hpp>

#include <vector>

namespace test_Axis {

using pcs::skeleton::Vec3;

BOOST_AUTO_TEST_SUITE(Axis)

BOOST_AUTO_TEST_CASE(resampling_keeps_ends_and_length)
{
  pcs::skeleton::Axis axis(3);
  axis[1].point = Vec3(1, 0, 0);
  axis[2].point = Vec3(1, 2, 0);
  for (auto& node : axis)
    node.radius = 0.1;
  const auto result = pcs::skeleton::resample(axis, {1, 0.01, 1});
  BOOST_CHECK_EQUAL(result.size(), 31u);
  BOOST_CHECK(result.front().point == axis.front().point);
  BOOST_CHECK(result.back().point == axis.back().point);
  BOOST_CHECK_CLOSE(pcs::skeleton::length_of(result), 3.0, 1.0);
}

BOOST_AUTO_TEST_CASE(resampling_interpolates_radii)
{
  pcs::skeleton::Axis axis(2);
  axis[1].point = Vec3(0, 0, 1);
  axis[0].radius = 0.1;
  axis[1].radius = 0.3;
  const auto result = pcs::skeleton::resample(axis, {1, 0.01, 0.1});
  BOOST_REQUIRE_EQUAL(result.size(), 11u);
  for (const auto& node : result)
    BOOST_CHECK_CLOSE(node.radius, 0.1 + 0.2 * node.point.z(), 1e-9);
}

BOOST_AUTO_TEST_CASE(a_place_beyond_an_end_says_so)
{
  pcs::skeleton::Axis axis(2);
  axis[1].point = Vec3(0, 0, 1);
  const auto before = pcs::skeleton::nearest_place(axis, 0, Vec3(0, 0, -1));
  BOOST_CHECK_LT(before.share, 0);
  BOOST_CHECK_CLOSE(before.distance, 1.0, 1e-9);
  BOOST_CHECK_CLOSE(pcs::skeleton::nearest_place(axis, 0, Vec3(3, 0, 0.25)).share, 0.25, 1e-9);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Axis

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Circles of arcs and lines.

#include <pcs/skeleton/model/circle_fit.h>
#include <support/sections.h>

#include <boost/test/unit_test.hpp>

#include <vector>

namespace test_circle_fit {

using pcs::skeleton::Vec2;
using pcs_test::arc;
constexpr double pi = 3.14159265358979323846;

BOOST_AUTO_TEST_SUITE(circle_fit)

BOOST_AUTO_TEST_CASE(short_arcs_are_not_biased)
{
  for (const double turn : {2 * pi, pi, pi / 2}) {
    const auto circle = pcs::skeleton::fit_circle(arc(2, 2, turn, 400, 0.02));
    BOOST_CHECK_CLOSE(circle.radius, 2.0, 2.0);
    BOOST_CHECK_SMALL((circle.center - Vec2(5, -3)).norm(), 0.04);
  }
}

BOOST_AUTO_TEST_CASE(points_on_a_line_have_no_circle)
{
  std::vector<Vec2> points;
  for (int i = 0; i < 10; ++i)
    points.emplace_back(i, 2 * i);
  BOOST_CHECK_EQUAL(pcs::skeleton::fit_circle(points).radius, 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_circle_fit

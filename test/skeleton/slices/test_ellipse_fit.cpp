// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ellipses of whole turns and arcs.

#include <pcs/skeleton/slices/ellipse_fit.h>
#include <support/sections.h>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace test_ellipse_fit {

using pcs::skeleton::Vec2;
using pcs_test::arc;
constexpr double pi = 3.14159265358979323846;

BOOST_AUTO_TEST_SUITE(ellipse_fit)

BOOST_AUTO_TEST_CASE(all_ways_find_an_exact_ellipse)
{
  using pcs::Section_fit;
  for (const Section_fit how : {Section_fit::conic, Section_fit::ellipse, Section_fit::by_arc}) {
    const auto e = pcs::skeleton::fit_section(arc(2, 1.5, 2 * pi, 40, 0), how);
    BOOST_CHECK_CLOSE(e.major, 2.0, 1e-6);
    BOOST_CHECK_CLOSE(e.minor, 1.5, 1e-6);
    BOOST_CHECK_SMALL((e.center - Vec2(5, -3)).norm(), 1e-8);
    BOOST_CHECK_SMALL(std::abs(e.direction.dot(Vec2(std::cos(0.5), std::sin(0.5)))) - 1, 1e-8);
    BOOST_CHECK_SMALL(e.deviation, 1e-7);
  }
}

// Semi-axes 2 and 1, the major one along (0.6, 0.8).
BOOST_AUTO_TEST_CASE(a_conic_away_from_the_origin_is_that_ellipse)
{
  const auto e = pcs::skeleton::internal::ellipse_of_conic(0.73, -0.72, 0.52, -5.82, 4.24, 11.97);
  BOOST_CHECK_CLOSE(e.major, 2.0, 1e-9);
  BOOST_CHECK_CLOSE(e.minor, 1.0, 1e-9);
  BOOST_CHECK_SMALL((e.center - Vec2(3, -2)).norm(), 1e-12);
  BOOST_CHECK_SMALL(std::abs(e.direction.dot(Vec2(0.6, 0.8))) - 1, 1e-12);
}

BOOST_AUTO_TEST_CASE(the_direct_fit_needs_no_centred_points)
{
  const auto e = pcs::skeleton::internal::fit_direct(arc(2, 1.5, 1.2 * pi, 40, 0));
  BOOST_CHECK_CLOSE(e.major, 2.0, 1e-3);
  BOOST_CHECK_CLOSE(e.minor, 1.5, 1e-3);
  BOOST_CHECK_SMALL((e.center - Vec2(5, -3)).norm(), 1e-5);
}

BOOST_AUTO_TEST_CASE(on_a_half_turn_only_the_circle_keeps_the_radius)
{
  using pcs::Section_fit;
  const auto points = arc(1, 1, pi, 20, 0.03);
  BOOST_CHECK_CLOSE(pcs::skeleton::fit_section(points, Section_fit::circle).major, 1.0, 10.0);
  BOOST_CHECK_CLOSE(pcs::skeleton::fit_section(points, Section_fit::by_arc).major, 1.0, 10.0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_ellipse_fit

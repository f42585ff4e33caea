// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ends of axes: wood does not thicken towards the tip or thin abruptly.

#include <pcs/skeleton/axes/chain_ends.h>
#include <support/axes.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_chain_ends {

using namespace pcs::skeleton;

namespace {

constexpr double radius = 0.1, height = 2;

/// An axis along z from -0.5 to `height`, with the radius `base` below 0, and a stem around the
/// rest.
struct Stem
{
  Scan scan;
  Axis_set set;
  Chain_options rules;
  Axis_fit fit;

  Stem(double base, double filling) : fit(axis(base), Fit_model::of(0.01, 0.001))
  {
    scan.spacing = 0.01;
    set.noise = 0.001;
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < 2000; ++k) {
      const double angle = 2.4 * double(k), z = height * double(k) / 2000;
      const double r = double(k % 100) < 100 * filling ? 0.3 * radius : radius;
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
    const std::vector<Index> segments(points.size(), 0);
    fit.set_points(points, segments);
    fit.project();
  }
  static Axis axis(double base)
  {
    Axis axis = pcs_test::straight_axis(Vec3(0, 0, -0.5), Vec3(0, 0, -0.1), 4, base, base);
    const Axis rest =
        pcs_test::straight_axis(Vec3(0, 0, 0), Vec3(0, 0, height), 20, radius, 0.7 * radius);
    axis.insert(axis.end(), rest.begin(), rest.end());
    return axis;
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(chain_ends)

BOOST_AUTO_TEST_CASE(an_axis_begins_where_it_is_thick)
{
  Stem stem(0.1 * radius, 0);
  BOOST_TEST(steady_radius({stem.scan, stem.set, stem.rules}, stem.fit) > 0.9 * radius);
  cut_thin_base({stem.scan, stem.set, stem.rules}, stem.fit);
  BOOST_TEST(stem.fit.axis().size() == 21u);
  BOOST_TEST(stem.fit.axis().front().point.z() == 0);
  BOOST_REQUIRE(stem.fit.places().size() == stem.fit.points().size());
  for (std::size_t i = 0; i < stem.fit.points().size(); ++i) {
    const double z = stem.fit.points()[i].z();
    const Axis_place& place = stem.fit.places()[i];
    BOOST_TEST(std::abs(height / 20 * (double(place.segment) + place.share) - z) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(axes_that_taper_and_bushes_begin_where_they_did)
{
  Stem taper(1.5 * radius, 0), weak(0.6 * radius, 0), bush(0.1 * radius, 0.3);
  for (Stem* stem : {&taper, &weak, &bush}) {
    cut_thin_base({stem->scan, stem->set, stem->rules}, stem->fit);
    BOOST_TEST(stem->fit.axis().size() == 26u);
  }
}

BOOST_AUTO_TEST_CASE(only_a_tip_that_collapses_is_left_out)
{
  const Chain_options rules;
  Axis axis = pcs_test::straight_axis(Vec3(0, 0, 0), Vec3(0, 0, 2), 20, radius, 0.7 * radius);
  const std::size_t trunk = axis.size();
  BOOST_TEST(size_without_collapse(rules, axis) == trunk);
  BOOST_TEST(size_without_collapse(rules, {}) == 0u);
  // The chain continues into a limb beside it: from 7 cm to 2 cm in 15 cm.
  const Axis limb = pcs_test::straight_axis(Vec3(0.02, 0, 2),
                                            Vec3(0.17, 0, 2.02),
                                            10,
                                            0.65 * radius,
                                            0.2 * radius);
  Axis turned = axis;
  turned.insert(turned.end(), limb.begin(), limb.end());
  const std::size_t left = size_without_collapse(rules, turned);
  BOOST_TEST(left >= trunk);
  BOOST_TEST(left <= trunk + 3);
  // Wood that tapers over a longer distance remains.
  const Axis taper =
      pcs_test::straight_axis(Vec3(0, 0, 2.1), Vec3(0, 0, 4), 20, 0.68 * radius, 0.1 * radius);
  axis.insert(axis.end(), taper.begin(), taper.end());
  BOOST_TEST(size_without_collapse(rules, axis) == axis.size());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_chain_ends

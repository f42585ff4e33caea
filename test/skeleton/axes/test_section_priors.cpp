// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Radii from point counts: correct under full visibility, increased for occluded axes, never
// overconfident.

#include <pcs/skeleton/axes/section_priors.h>
#include <support/axes.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_expect_sections {

using namespace pcs::skeleton;

namespace {

constexpr double pi = 3.14159265358979323846, spacing = 0.01, length = 1;
constexpr std::size_t number_of_nodes = 41;

/// A cylinder along z of radius `radius`, with the fraction `share` of the number of points
/// expected from the density.
struct Cylinder
{
  Scan scan;
  Axis_set set;
  Chain_options rules;
  Axis_fit fit;

  Cylinder(double radius, double share, std::size_t nodes = number_of_nodes)
    : fit(pcs_test::straight_axis(Vec3::Zero(), Vec3(0, 0, length), nodes - 1, radius, radius),
          Fit_model::of(spacing, 0.1 * spacing))
  {
    scan.spacing = spacing;
    set.noise = 0.1 * spacing;
    set.density = 1e5;
    const double count = share * set.density * 2 * pi * radius * length;
    std::vector<Vec3> points;
    for (std::size_t k = 0; double(k) < count; ++k) {
      const double angle = 2.4 * double(k), z = length * double(k) / count;
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    const std::vector<Index> segments(points.size(), static_cast<Index>(nodes / 2));
    fit.set_points(points, segments);
    fit.project();
  }
  Chain_view view() const { return {scan, set, rules}; }
  std::vector<Radius_prior> priors(double visible = 1) const
  {
    return counted_priors(view(), std::vector<double>(fit.axis().size(), visible), fit);
  }
};

constexpr double thin = 0.3 * spacing, thick = 2 * spacing; // 3 and 20 times the noise

} // namespace

BOOST_AUTO_TEST_SUITE(section_priors)

BOOST_AUTO_TEST_CASE(counts_of_all_points_give_the_radius)
{
  for (const double radius : {thin, thick}) {
    const Cylinder cylinder(radius, 1);
    const std::vector<Radius_prior> priors = cylinder.priors();
    BOOST_REQUIRE(priors.size() == number_of_nodes);
    for (std::size_t k = 3; k + 3 < priors.size(); ++k) {
      BOOST_TEST(std::abs(priors[k].radius - radius) < 0.15 * radius);
      BOOST_TEST(std::abs(priors[k].deviation - (0.5 * radius + 0.2 * spacing)) < 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(what_cannot_be_seen_is_not_counted_and_without_a_density_nothing_is)
{
  Cylinder cylinder(thick, 1);
  for (const Radius_prior& p : cylinder.priors(0.4))
    BOOST_TEST(p.deviation == 0);
  const double half = cylinder.priors(1)[20].radius;
  BOOST_TEST(std::abs(cylinder.priors(0.5 + 1e-9)[20].radius - 2 * half) < 1e-6 * half);
  cylinder.set.density = 0;
  for (const Radius_prior& p : cylinder.priors())
    BOOST_TEST(p.deviation == 0);
}

BOOST_AUTO_TEST_CASE(counts_of_a_thin_axis_that_is_hidden_are_raised)
{
  const double n = double(number_of_nodes), believed = n / (n + 20);
  const double half = Cylinder(thin, 0.5).priors()[20].radius;
  BOOST_TEST(std::abs(half / thin - 0.5 * std::pow(2, believed)) < 0.1);
  const double fifth = Cylinder(thin, 0.2).priors()[20].radius;
  BOOST_TEST(std::abs(fifth / thin - 0.4) < 0.05); // at most twice
  const double few = Cylinder(thin, 0.5, 5).priors()[2].radius;
  BOOST_TEST(std::abs(few / thin - 0.5 * std::pow(2, 0.2)) < 0.1);
}

BOOST_AUTO_TEST_CASE(counts_are_not_lowered_nor_raised_where_the_shape_is_seen)
{
  BOOST_TEST(std::abs(Cylinder(thin, 2).priors()[20].radius / thin - 2) < 0.2);
  BOOST_TEST(std::abs(Cylinder(thick, 0.5).priors()[20].radius / thick - 0.5) < 0.05);
}

BOOST_AUTO_TEST_CASE(an_axis_between_twigs_is_not_sure_of_its_radius)
{
  const Cylinder cylinder(thin, 1);
  const auto deviation = [&](double counted, double found) {
    const Radius_prior p = counted_prior(cylinder.view(), counted, found);
    BOOST_TEST(p.radius == counted);
    return p.deviation - 0.2 * spacing;
  };
  for (const double r : {thin, thick}) {
    BOOST_TEST(std::abs(deviation(r, 0.5 * r) - 0.25 * r) < 1e-12);
    BOOST_TEST(std::abs(deviation(r, 2.5 * r) - 1.25 * r) < 1e-12);
    BOOST_TEST(std::abs(deviation(r, 5 * r) - 0.625 * r) < 1e-12);
    BOOST_TEST(std::abs(deviation(r, 100 * r) - 0.5 * r) < 1e-12); // strong prior
  }
}

// Expects a linear taper from the radius of the lower third to half of it. The prior is weaker
// where more points are available.
BOOST_AUTO_TEST_CASE(axes_are_expected_to_taper_until_points_can_be_counted)
{
  for (const double share : {0.005, 1.0}) {
    Cylinder cylinder(thick, share);
    cylinder.set.density = 0;
    Axis& axis = cylinder.fit.axis();
    for (std::size_t k = 20; k < 30; ++k)
      axis[k].radius = 0.1 * thick; // thinner than the line: unknown
    const std::vector<double> visible(axis.size(), 1);
    for (const double whole : {length, 2 * length}) { // the complete path, or its lower half
      const std::vector<Radius_prior> priors =
          taper_priors(cylinder.view(), visible, cylinder.fit, whole);
      for (std::size_t k = 0; k < axis.size(); ++k) {
        const double place = double(k) / double(number_of_nodes - 1) * length / whole;
        if (place <= 1.0 / 3 || (k >= 20 && k < 30)) {
          BOOST_TEST(priors[k].deviation == 0);
          continue;
        }
        BOOST_TEST(std::abs(priors[k].radius - thick * (1 - 0.5 * place)) < 1e-9);
        const double few = 0.25 * thick;
        if (share < 1)
          BOOST_TEST(std::abs(priors[k].deviation - few) < 1e-9);
        else if (k > 32 && k < 38)
          BOOST_TEST(priors[k].deviation > 20 * few);
      }
    }
  }
  Cylinder cylinder(4.1 * spacing, 0.005);
  cylinder.set.density = 0;
  const std::vector<double> visible(number_of_nodes, 1);
  for (const Radius_prior& p : taper_priors(cylinder.view(), visible, cylinder.fit, length))
    BOOST_TEST(p.deviation == 0); // it is thick
}

BOOST_AUTO_TEST_CASE(sections_are_drawn_to_a_taper_by_a_length_and_without_a_density_only)
{
  for (const bool has_length : {true, false})
    for (const double density : {0.0, 1e5}) {
      Cylinder cylinder(thick, 0.02);
      cylinder.set.density = density;
      const std::vector<double> visible(number_of_nodes, 1);
      expect_sections(cylinder.view(), visible, has_length ? length : 0, cylinder.fit);
      const double before = cylinder.fit.axis()[38].radius;
      BOOST_REQUIRE(cylinder.fit.iterate(1));
      const double change = cylinder.fit.axis()[38].radius - before;
      if (density > 0)
        BOOST_TEST(change < -0.03 * thick); // counts are too low
      else if (has_length)
        BOOST_TEST(change < -0.001 * thick);
      else
        BOOST_TEST(change > -0.001 * thick);
    }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_expect_sections

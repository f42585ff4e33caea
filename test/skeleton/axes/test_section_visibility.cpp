// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Radii from the width of points on one side of a thin branch.

#include <pcs/skeleton/axes/section_visibility.h>
#include <support/axes.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_section_sides {

using namespace pcs::skeleton;

namespace {

constexpr double pi = 3.14159265358979323846, spacing = 0.006, noise = 0.002, radius = 0.006;

/// A twig along z, seen by one station in the direction of x, with range noise.
struct Seen_twig
{
  Scan scan;
  Axis_set set;
  Chain_options rules;
  std::vector<Vec3> points;
  std::size_t number_of_segments = 30;

  /// `is_round`: the twig is seen from all sides.
  explicit Seen_twig(bool is_round, std::size_t count = 400)
  {
    scan.spacing = spacing;
    set.noise = noise;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-1, 1), height(0, length());
    std::normal_distribution<double> range(0, noise);
    for (std::size_t i = 0; i < count; ++i) {
      const double y = radius * place(random), z = height(random), error = range(random);
      const double x = std::sqrt(radius * radius - y * y);
      points.push_back(Vec3(is_round && i % 2 == 1 ? -x - error : x + error, y, z));
    }
  }

  double length() const { return double(number_of_segments) * 2 * spacing; }

  /// Fits the points with an axis of another radius; the points are on its front side.
  Axis_fit fit(double other) const { return fit(other, other); }

  /// Same, with a linearly changing radius.
  Axis_fit fit(double other, double last) const
  {
    const double behind = other > radius ? radius - other : 0;
    const Vec3 base(behind, 0, 0), tip(behind, 0, length());
    Axis_fit fit(pcs_test::straight_axis(base, tip, number_of_segments, other, last),
                 Fit_model::of(spacing, noise));
    fit.set_points(points,
                   std::vector<Index>(points.size(), static_cast<Index>(number_of_segments / 2)));
    fit.project();
    return fit;
  }

  std::vector<Radius_prior> priors(const Axis_fit& fit, const Radius_prior& before) const
  {
    std::vector<Radius_prior> priors(fit.axis().size(), before);
    const Chain_view view{scan, set, rules};
    add_width_priors(view, fit.axis(), Section_visibility(view, fit), priors);
    return priors;
  }

  /// The middle radius after iterations with a prior from a density that is three times too low.
  double fitted_radius(bool has_width) const
  {
    Axis_fit fit = this->fit(3 * radius);
    for (int k = 0; k < 60; ++k) {
      const Radius_prior counted{3 * radius, 1.5 * radius, 0};
      fit.set_priors(has_width ? priors(fit, counted)
                               : std::vector<Radius_prior>(fit.axis().size(), counted));
      BOOST_REQUIRE(fit.iterate(1));
    }
    return fit.axis()[number_of_segments / 2].radius;
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(section_visibility)

BOOST_AUTO_TEST_CASE(half_a_twig_is_as_wide_as_all_of_it)
{
  const Seen_twig twig(false, 4000);
  const Axis_fit fit = twig.fit(radius);
  const std::vector<Radius_prior> priors = twig.priors(fit, {});
  for (std::size_t k = 3; k + 3 < priors.size(); ++k) {
    BOOST_TEST(std::abs(priors[k].radius - radius) < 0.1 * radius);
    BOOST_TEST(priors[k].measured * priors[k].deviation * priors[k].deviation == 1,
               boost::test_tools::tolerance(1e-12));
  }
  const Section_visibility sides(Chain_view{twig.scan, twig.set, twig.rules}, fit);
  BOOST_TEST((sides.normal[15] - pi / 4 * Vec3::UnitX()).norm() < 0.1);
}

BOOST_AUTO_TEST_CASE(a_twig_that_is_seen_all_around_has_no_such_radius)
{
  const Seen_twig twig(true, 4000);
  for (const Radius_prior& p : twig.priors(twig.fit(radius), {}))
    BOOST_TEST(p.deviation == 0);
}

BOOST_AUTO_TEST_CASE(few_points_and_thick_axes_have_no_such_radius)
{
  Seen_twig twig(false, 30); // about five in a window
  for (const Radius_prior& p : twig.priors(twig.fit(radius), {}))
    BOOST_TEST((p.deviation == 0 || p.radius > 0));
  twig.rules.width_count = 1000;
  for (const Radius_prior& p : twig.priors(twig.fit(radius), {}))
    BOOST_TEST(p.deviation == 0);
  twig.rules = Chain_options();
  twig.rules.width_radius = 0.5 * radius / spacing;
  for (const Radius_prior& p : twig.priors(twig.fit(radius), {}))
    BOOST_TEST(p.deviation == 0);
}

BOOST_AUTO_TEST_CASE(thin_nodes_beside_thick_ones_are_as_wide_as_others)
{
  Seen_twig twig(false, 4000);
  twig.rules.width_radius = radius / spacing; // halfway along the axis
  const std::vector<Radius_prior> priors = twig.priors(twig.fit(1.02 * radius, 0.98 * radius), {});
  const std::size_t middle = twig.number_of_segments / 2;
  for (std::size_t k = 0; k < middle; ++k)
    BOOST_TEST(priors[k].deviation == 0);
  for (std::size_t k = middle + 1; k + 3 < priors.size(); ++k)
    BOOST_TEST(std::abs(priors[k].radius - radius) < 0.1 * radius);
}

BOOST_AUTO_TEST_CASE(width_tells_what_neither_noise_nor_density_does)
{
  const Seen_twig twig(false, 100);
  BOOST_TEST(std::abs(twig.fitted_radius(true) - radius) < 0.25 * radius);
  BOOST_TEST(twig.fitted_radius(false) > 1.5 * radius);
}

BOOST_AUTO_TEST_CASE(two_expectations_are_joined_by_their_variances)
{
  const Radius_prior both = joined({1, 2, 0}, {4, 1, 1});
  BOOST_TEST(both.radius == (0.25 * 1 + 4) / 1.25);
  BOOST_TEST(both.deviation == 1 / std::sqrt(1.25));
  BOOST_TEST(both.measured == 1);
  BOOST_TEST(joined({}, {4, 1, 1}).radius == 4);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_section_sides

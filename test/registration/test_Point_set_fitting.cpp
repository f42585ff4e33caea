// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sequences of targets, cancelling, and the rest shape.

#include <pcs/registration/Point_set_fitting.h>
#include <support/fitted_clouds.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <utility>
#include <vector>

namespace test_Point_set_fitting {

namespace {

using pcs_test::Points;
using pcs_test::Vec3;
namespace P = pcs::parameters;

constexpr double extent = 10;

} // namespace

BOOST_AUTO_TEST_SUITE(Point_set_fitting)

BOOST_AUTO_TEST_CASE(a_template_follows_a_sequence_and_returns)
{
  const Points rest = pcs_test::star(2000, 0);
  Points source = rest;
  pcs::Point_set_fitting session(source);
  for (const double curvature : {0.04, 0.08, 0.12, 0.08, 0.04, 0.0}) {
    const Points target = pcs_test::bend(pcs_test::star(2000, 1 + 10 * curvature), curvature);
    session.fit(target, P::default_values(), pcs::Solver_start::warm);
    BOOST_TEST(pcs_test::rms_distance(source, pcs_test::bend(rest, curvature)) < 0.01 * extent);
  }
  session.reset();
  BOOST_TEST((source == rest));
}

BOOST_AUTO_TEST_CASE(an_object_that_was_moved_from_says_so)
{
  const Points target = pcs_test::star(100, 1);
  Points source = pcs_test::star(100, 0);
  pcs::Point_set_fitting session(source);
  auto taken = std::move(session);
  BOOST_CHECK_THROW(session.fit(target), pcs::Invalid_input);
  BOOST_CHECK_THROW(session.reset(), pcs::Invalid_input);
  BOOST_CHECK_NO_THROW(taken.reset());
}

BOOST_AUTO_TEST_CASE(a_cold_fit_does_not_depend_on_earlier_ones)
{
  const Points rest = pcs_test::star(1000, 0);
  const Points a = pcs_test::bend(pcs_test::star(1000, 1), 0.1);
  const Points b = pcs_test::bend(pcs_test::star(1000, 2), -0.1);
  Points source = rest;
  pcs::Point_set_fitting session(source, P::number_of_iterations(10));
  session.fit(a);
  const Points once = source;
  session.fit(b);
  BOOST_TEST((source != once));
  session.fit(a);
  BOOST_TEST((source == once));
}

BOOST_AUTO_TEST_CASE(a_warm_start_differs_from_a_cold_one_and_needs_no_alignment)
{
  const Points rest = pcs_test::star(1000, 0);
  const Points target = pcs_test::bend(pcs_test::star(1000, 1), 0.1);
  Points source = rest;
  pcs::Point_set_fitting session(source);
  const auto cold = session.fit(target);
  const auto warm = session.fit(target, P::default_values(), pcs::Solver_start::warm);
  BOOST_TEST(warm.number_of_iterations < cold.number_of_iterations);
  BOOST_TEST(pcs_test::rms_distance(source, pcs_test::bend(rest, 0.1)) < 0.01 * extent);
}

BOOST_AUTO_TEST_CASE(cancelling_leaves_the_points_and_progress_grows_to_one)
{
  const Points rest = pcs_test::star(800, 0);
  const Points target = pcs_test::bend(pcs_test::star(800, 1), 0.1);
  std::vector<double> values;
  {
    Points source = rest;
    pcs::Point_set_fitting session(source, P::callback([&](double f) {
                                     values.push_back(f);
                                     return true;
                                   }));
    session.fit(target);
    BOOST_TEST((source != rest));
  }
  BOOST_TEST(values.back() == 1);
  for (std::size_t i = 1; i < values.size(); ++i)
    BOOST_TEST_REQUIRE(values[i] >= values[i - 1]);
  for (std::size_t stop = 1; stop <= values.size(); stop += values.size() / 12) {
    Points source = rest;
    std::size_t calls = 0;
    pcs::Point_set_fitting session(source, P::callback([&](double) { return ++calls < stop; }));
    const auto report = session.fit(target);
    BOOST_TEST(report.status == pcs::Status::cancelled);
    BOOST_TEST((source == rest));
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Point_set_fitting

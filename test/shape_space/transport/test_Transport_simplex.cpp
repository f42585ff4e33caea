// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares transport with an independent solver.

#include <pcs/shape_space/transport/Sinkhorn.h>
#include <pcs/shape_space/transport/Transport_simplex.h>
#include <support/transport.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

namespace test_Transport_simplex {

using pcs::Sinkhorn_options;

using namespace pcs::shape_space;
using namespace transport_test;

BOOST_AUTO_TEST_SUITE(Transport_simplex)

BOOST_AUTO_TEST_CASE(it_costs_as_little_as_another_solver_says)
{
  std::mt19937 random(1);
  for (int repetition = 0; repetition < 50; ++repetition) {
    const std::size_t n = 2 + random() % 12, m = 2 + random() % 12;
    const Transport_problem problem = random_problem(random, n, m, 1);
    const Transport_plan plan = pcs::shape_space::Transport_simplex()(problem);
    BOOST_TEST(plan.is_complete);
    BOOST_TEST(plan.violation <= 1e-9);
    BOOST_TEST(plan.flows.size() <= n + m - 1);
    BOOST_TEST(std::abs(plan.cost - least_cost(problem).cost) <= 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(equal_masses_and_costs_come_to_an_end)
{
  Transport_problem problem; // completely degenerate
  const std::size_t n = 60;
  for (std::uint32_t i = 0; i < n; ++i) {
    problem.supplies.push_back(1.0 / n);
    problem.demands.push_back(1.0 / n);
    for (std::uint32_t j = 0; j < n; ++j)
      problem.arcs.push_back({i, j, i == j ? 0.0 : 1.0});
  }
  const Transport_plan plan = pcs::shape_space::Transport_simplex()(problem);
  BOOST_TEST(plan.is_complete);
  BOOST_TEST(std::abs(plan.cost) < 1e-12);
}

BOOST_AUTO_TEST_CASE(mass_without_arcs_is_reported_and_not_hidden)
{
  Transport_problem problem;
  problem.supplies = {0.5, 0.5};
  problem.demands = {0.25, 0.75};
  problem.arcs = {{0, 0, 1.0}, {1, 1, 1.0}};
  const Transport_plan plan = pcs::shape_space::Transport_simplex()(problem);
  BOOST_TEST(!plan.is_complete);
  BOOST_TEST(std::abs(plan.violation - 0.5) < 1e-12);
  BOOST_TEST(plan.is_unmet[0]);
  BOOST_TEST(plan.is_unmet[3]);
  const Transport_plan regularised = sinkhorn(problem, Sinkhorn_options());
  BOOST_TEST(!regularised.is_complete);
  BOOST_TEST(regularised.violation > 0.1);
}

BOOST_AUTO_TEST_CASE(regularised_transport_approaches_the_exact_cost_from_above)
{
  std::mt19937 random(3);
  const Transport_problem problem = random_problem(random, 30, 40, 1);
  const double exact = pcs::shape_space::Transport_simplex()(problem).cost;
  Sinkhorn_options options;
  double last = std::numeric_limits<double>::infinity();
  for (const double epsilon : {0.2, 0.05, 0.01}) {
    options.regularization = epsilon;
    options.iterations = 5000;
    const Transport_plan plan = sinkhorn(problem, options);
    BOOST_TEST(plan.violation < 1e-3);
    BOOST_TEST(plan.cost > exact - 1e-3);
    BOOST_TEST(plan.cost < last);
    last = plan.cost;
  }
  BOOST_TEST(last < 1.1 * exact);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Transport_simplex

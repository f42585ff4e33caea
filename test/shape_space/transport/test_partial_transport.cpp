// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares partial transport with an independent solver.

#include <pcs/shape_space/transport/partial_transport.h>
#include <support/transport.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <random>

namespace test_partial_transport {

using pcs::Transport_options;

using namespace pcs::shape_space;
using namespace transport_test;

BOOST_AUTO_TEST_SUITE(partial_transport)

BOOST_AUTO_TEST_CASE(it_costs_as_little_as_another_solver_says)
{
  std::mt19937 random(11);
  for (int repetition = 0; repetition < 50; ++repetition) {
    const std::size_t n = 2 + random() % 12, m = 2 + random() % 12;
    const Transport_problem problem = random_problem(random, n, m, 0.5);
    const double price = 0.02 + 0.01 * (repetition % 20);
    const Transport_plan plan = solve_partially(problem, price, Transport_options());
    const Carried other = least_cost(problem, 2 * price);
    BOOST_TEST(plan.is_complete);
    BOOST_TEST(plan.violation <= 1e-9);
    BOOST_TEST(plan.flows.size() <= n + m - 1);
    BOOST_TEST(std::abs(plan.cost - other.cost) <= 1e-9);
    BOOST_TEST(std::abs(plan.remaining - (1 - other.mass)) <= 1e-9);
    for (const auto& f : plan.flows)
      BOOST_TEST(problem.arcs[f.arc].cost < 2 * price);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_partial_transport

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the assignment with all permutations.

#include <pcs/shape_space/matching/linear_assignment.h>

#include <boost/test/unit_test.hpp>

#include <functional>
#include <random>

namespace test_linear_assignment {

namespace {

double least_cost(std::size_t n, std::size_t m, const std::vector<double>& gain)
{
  std::vector<char> is_used(m, 0);
  const std::function<double(std::size_t)> best = [&](std::size_t row) {
    if (row == n)
      return 0.0;
    double least = best(row + 1);
    for (std::size_t j = 0; j < m; ++j)
      if (!is_used[j]) {
        is_used[j] = 1;
        least = std::min(least, gain[row * m + j] + best(row + 1));
        is_used[j] = 0;
      }
    return least;
  };
  return best(0);
}

} // namespace

BOOST_AUTO_TEST_SUITE(linear_assignment)

BOOST_AUTO_TEST_CASE(it_costs_as_little_as_any_assignment)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 0.5);
  for (int repetition = 0; repetition < 300; ++repetition) {
    const std::size_t n = 1 + random() % 5, m = 1 + random() % 5;
    std::vector<double> gain(n * m);
    for (double& g : gain)
      g = uniform(random);
    const auto column = pcs::shape_space::assign_rows(n, m, gain);
    double cost = 0;
    std::vector<int> uses(m, 0);
    for (std::size_t i = 0; i < n; ++i)
      if (column[i] != pcs::shape_space::none) {
        cost += gain[i * m + column[i]];
        ++uses[column[i]];
      }
    BOOST_TEST(*std::max_element(uses.begin(), uses.end()) <= 1);
    BOOST_TEST(std::abs(cost - least_cost(n, m, gain)) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(it_is_kept_up_to_date_when_entries_grow)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 0.3);
  for (int repetition = 0; repetition < 300; ++repetition) {
    const std::size_t n = 1 + random() % 5, m = 1 + random() % 5;
    std::vector<double> gain(n * m), prices(m);
    for (double& g : gain)
      g = uniform(random);
    for (double& p : prices)
      p = std::min(0.0, uniform(random));
    pcs::shape_space::Assignment assignment(n, m, gain, prices);
    BOOST_TEST(assignment.bound() <= least_cost(n, m, gain) + 1e-12);
    BOOST_TEST(assignment.solve());
    BOOST_TEST(std::abs(assignment.bound() - least_cost(n, m, gain)) < 1e-12);
    for (int round = 0; round < 6; ++round) {
      const auto& column = assignment.columns();
      double cost = 0;
      std::vector<int> uses(m, 0);
      std::vector<std::size_t> rows;
      for (std::size_t i = 0; i < n; ++i)
        if (column[i] != pcs::shape_space::none) {
          cost += gain[i * m + column[i]];
          ++uses[column[i]];
          if (random() % 2 == 0)
            rows.push_back(i);
        }
      BOOST_TEST(*std::max_element(uses.begin(), uses.end()) <= 1);
      BOOST_TEST(std::abs(cost - least_cost(n, m, gain)) < 1e-12);
      for (const std::size_t i : rows)
        gain[i * m + column[i]] += 0.2 + 0.5 * std::abs(uniform(random));
      assignment.raise(rows);
    }
  }
}

BOOST_AUTO_TEST_CASE(it_stops_when_it_is_known_to_cost_too_much)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 0.3);
  std::vector<double> gain(6 * 6);
  for (int repetition = 0; repetition < 300; ++repetition) {
    for (double& g : gain)
      g = uniform(random);
    const double least = least_cost(6, 6, gain);
    pcs::shape_space::Assignment dear(6, 6, gain), cheap(6, 6, gain);
    BOOST_TEST(!dear.solve(least - 1e-9));
    BOOST_TEST(dear.bound() <= least + 1e-12);
    BOOST_TEST(cheap.solve(least + 1e-9));
    // The dual prices are valid start values for other problems.
    pcs::shape_space::Assignment again(6, 6, gain, dear.prices());
    BOOST_TEST(again.solve());
    BOOST_TEST(std::abs(again.bound() - least) < 1e-12);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_linear_assignment

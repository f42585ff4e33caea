// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests which branches form whorls, and compares assignments that keep whorls with all of them.

#include <pcs/shape_space/matching/assign_whorls.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <random>
#include <vector>

namespace test_assign_whorls {

namespace {

using namespace pcs::shape_space;

/// The least cost of rows whose partners are members of whorls, by trying all of them.
double least_cost(const Whorls& rows, const Whorls& columns, const std::vector<double>& gain)
{
  std::size_t m = 0;
  for (const auto& whorl : columns)
    m += whorl.size();
  const auto within = [&](std::size_t g, std::size_t h) {
    std::vector<char> is_used(columns[h].size(), 0);
    const std::function<double(std::size_t)> best = [&](std::size_t k) {
      if (k == rows[g].size())
        return 0.0;
      double least = best(k + 1);
      for (std::size_t l = 0; l < columns[h].size(); ++l)
        if (!is_used[l]) {
          is_used[l] = 1;
          least = std::min(least, gain[rows[g][k] * m + columns[h][l]] + best(k + 1));
          is_used[l] = 0;
        }
      return least;
    };
    return best(0);
  };
  std::vector<char> is_used(columns.size(), 0);
  const std::function<double(std::size_t)> best = [&](std::size_t g) {
    if (g == rows.size())
      return 0.0;
    double least = best(g + 1);
    for (std::size_t h = 0; h < columns.size(); ++h)
      if (!is_used[h]) {
        is_used[h] = 1;
        least = std::min(least, within(g, h) + best(g + 1));
        is_used[h] = 0;
      }
    return least;
  };
  return best(0);
}

std::vector<std::size_t> sizes_of(const Whorls& whorls)
{
  std::vector<std::size_t> sizes;
  for (const auto& whorl : whorls)
    sizes.push_back(whorl.size());
  return sizes;
}

} // namespace

BOOST_AUTO_TEST_SUITE(whorls)

BOOST_AUTO_TEST_CASE(pairs_and_whorls_are_found_in_any_order)
{
  using Sizes = std::vector<std::size_t>;
  BOOST_TEST((sizes_of(find_whorls({0.1, 0.1, 0.3, 0.3, 0.5, 0.5, 0.7, 0.7})) == Sizes(4, 2)));
  const Whorls mixed = find_whorls({0.7, 0.1, 0.52, 0.3, 0.11, 0.5, 0.72, 0.32, 0.9});
  BOOST_TEST((sizes_of(mixed) == Sizes{2, 2, 2, 2, 1}));
  BOOST_TEST((mixed[0] == std::vector<std::size_t>{1, 4}));
  // whorls of three that are spread over a quarter of their distance
  std::vector<double> s;
  for (int k = 0; k < 5; ++k)
    s.insert(s.end(), {0.2 * k, 0.2 * k + 0.025, 0.2 * k + 0.05});
  BOOST_TEST((sizes_of(find_whorls(s)) == Sizes(5, 3)));
}

BOOST_AUTO_TEST_CASE(alternate_and_few_branches_have_no_whorls)
{
  std::vector<double> s;
  for (int k = 0; k < 20; ++k)
    s.push_back(0.05 * k);
  BOOST_TEST(find_whorls(s).empty());
  BOOST_TEST(find_whorls({}).empty());
  BOOST_TEST(find_whorls({0.1, 0.1, 0.5, 0.5, 0.9, 0.9}).empty());
  BOOST_TEST(find_whorls(std::vector<double>(12, 0.5)).empty()); // all in one place
}

BOOST_AUTO_TEST_CASE(random_attachments_rarely_have_whorls)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 1);
  for (const std::size_t n : {8u, 12u, 40u}) {
    int number = 0;
    for (int k = 0; k < 1000; ++k) {
      std::vector<double> s(n);
      for (double& x : s)
        x = place(random);
      number += find_whorls(s).empty() ? 0 : 1;
    }
    BOOST_TEST_MESSAGE(n << " branches: whorls in " << number << " of 1000");
    BOOST_TEST(number < 50);
  }
}

BOOST_AUTO_TEST_CASE(an_assignment_costs_as_little_as_any_that_keeps_whorls)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> gain_of(-1, 0.3);
  const Whorls rows = {{0, 3}, {1, 2}, {4}, {5, 6, 7}}, columns = {{1, 0}, {2}, {3, 4, 5}};
  for (int k = 0; k < 200; ++k) {
    std::vector<double> gain(8 * 6);
    for (double& g : gain)
      g = gain_of(random);
    Whorl_assignment assignment(rows, columns, gain);
    const auto cost = [&] {
      double sum = 0;
      for (std::size_t r = 0; r < 8; ++r)
        if (const std::size_t c = assignment.columns()[r]; c != none)
          sum += gain[r * 6 + c];
      return sum;
    };
    BOOST_TEST(std::abs(cost() - least_cost(rows, columns, gain)) < 1e-12);
    // the entries of all pairs grow
    std::vector<std::size_t> raised;
    for (std::size_t r = 0; r < 8; ++r)
      if (const std::size_t c = assignment.columns()[r]; c != none) {
        gain[r * 6 + c] += 0.4;
        raised.push_back(r);
      }
    assignment.raise(raised);
    BOOST_TEST(std::abs(cost() - least_cost(rows, columns, gain)) < 1e-12);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_assign_whorls

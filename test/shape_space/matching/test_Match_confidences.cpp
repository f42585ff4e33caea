// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The confidence of a match compares its energy with that of the best alternative.

#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/Match_confidences.h>
#include <support/rooted_trees.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <vector>

namespace test_Match_confidences {

using namespace pcs::shape_space;
using pcs::Matching_weights;
using pcs_test::rooted;
using pcs_test::Stick;

namespace {

using Matching = Branch_matching<CGAL::Sequential_tag>;
using Result = std::shared_ptr<const Matched_branch>;
using Confidences = std::unordered_map<std::size_t, double>;

constexpr double infinite = std::numeric_limits<double>::infinity();

Matching matching_of(const Rooted_tree& one, const Rooted_tree& two)
{
  const Matching_weights weights;
  return Matching(one,
                  two,
                  weights,
                  {Matching::find_paths(one, weights), Matching::find_paths(two, weights)});
}

Result run(Matching& matching)
{
  pcs::internal::Progress progress;
  Result result = matching.run(progress);
  BOOST_TEST_REQUIRE(bool(result));
  return result;
}

const Stick trunk{pcs::npos, 0, Vec3(0, 0, 4), 8};

/// Sticks on a trunk, at random heights and in random directions.
Rooted_tree brush(unsigned seed, int number_of_sticks)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Stick> sticks{trunk};
  for (int i = 0; i < number_of_sticks; ++i) {
    const double azimuth = 6.28 * uniform(random), length = 0.3 + 0.7 * uniform(random);
    sticks.push_back({0,
                      1 + static_cast<std::size_t>(random() % 7),
                      length * Vec3(std::cos(azimuth), std::sin(azimuth), uniform(random))});
  }
  return rooted(sticks);
}

/// The least energy of all assignments of children without the pair (i, j), minus the least
/// energy of all, by trying all of them; `cost`: of the pair.
double brute_force(Matching& matching,
                   const Matched_branch& match,
                   const Matched_branch::Pair& pair,
                   double& cost)
{
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Compared_branches both =
      compare_branches(matching.energy(),
                       first_trial(matching.energy(), match.path_1, match.path_2, identity),
                       identity);
  const auto &a = both.children[0], &b = both.children[1];
  const std::size_t n = a.s.size(), m = b.s.size();
  const Matching_energy& energy = matching.energy();
  const auto gain = [&](std::size_t i, std::size_t j) {
    return matching.quick_match(a.start[i], b.start[j], both.rotation) +
           energy.position_term(a.length[i],
                                b.length[j],
                                a.s[i],
                                b.s[j],
                                energy.length(0, match.path_1)) -
           energy.single_term(a.weight[i]) - energy.single_term(b.weight[j]);
  };
  cost = gain(pair.child_1, pair.child_2) + energy.single_term(a.weight[pair.child_1]) +
         energy.single_term(b.weight[pair.child_2]);
  std::vector<std::size_t> order(n + m); // partners of the rows; at least m: none
  std::iota(order.begin(), order.end(), std::size_t(0));
  double least = infinite, least_without = infinite;
  std::vector<double> table(n * m);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j)
      table[i * m + j] = gain(i, j);
  do {
    double sum = 0;
    bool has_pair = false;
    for (std::size_t i = 0; i < n; ++i)
      if (order[i] < m) {
        sum += table[i * m + order[i]];
        has_pair = has_pair || (i == pair.child_1 && order[i] == pair.child_2);
      }
    least = std::min(least, sum);
    if (!has_pair)
      least_without = std::min(least_without, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return least_without - least;
}

} // namespace

BOOST_AUTO_TEST_SUITE(confidences_of_matches)

BOOST_AUTO_TEST_CASE(a_match_is_compared_with_all_other_assignments)
{
  for (unsigned seed = 1; seed < 7; ++seed) {
    const Rooted_tree one = brush(seed, 4), two = brush(seed + 50, 4);
    Matching matching = matching_of(one, two);
    const Result match = run(matching);
    const Confidences found = Match_confidences<CGAL::Sequential_tag>(matching).run(*match);
    BOOST_TEST(found.size() == 1 + match->pairs.size());
    for (const Matched_branch::Pair& pair : match->pairs) {
      double cost = 0;
      const double more = brute_force(matching, *match, pair, cost);
      const Branch_path& path = matching.energy().path(0, match->path_1);
      const double confidence = found.at(path.children[pair.child_1].start);
      BOOST_TEST(std::abs(confidence - more / (more + cost)) < 1e-9);
      BOOST_TEST((confidence >= 0 && confidence <= 1));
    }
  }
}

BOOST_AUTO_TEST_CASE(copies_are_certain_and_exchangeable_branches_are_not)
{
  // A single branch, and two equal branches in one place.
  const Stick single{0, 2, Vec3(1, 0, 0.5)}, twin{0, 6, Vec3(0, 0.8, 0.3)};
  const Rooted_tree tree = rooted({trunk, single, twin, twin});
  Matching matching = matching_of(tree, tree);
  const Result match = run(matching);
  const Confidences found = Match_confidences<CGAL::Sequential_tag>(matching).run(*match);
  BOOST_TEST_REQUIRE(match->pairs.size() == 3u);
  const Branch_path& path = matching.energy().path(0, match->path_1);
  std::vector<double> sorted;
  for (const Matched_branch::Pair& pair : match->pairs)
    sorted.push_back(found.at(path.children[pair.child_1].start));
  std::sort(sorted.begin(), sorted.end());
  BOOST_TEST(found.at(0) == 1);
  BOOST_TEST(sorted[0] < 1e-6);
  BOOST_TEST(sorted[1] < 1e-6);
  BOOST_TEST(sorted[2] > 1 - 1e-6);
}

BOOST_AUTO_TEST_CASE(confidence_does_not_increase_towards_the_tips)
{
  const Rooted_tree one = rooted(orl_test::random_tree(1)), two = rooted(orl_test::random_tree(2));
  Matching matching = matching_of(one, two);
  const Result match = run(matching);
  const Confidences found = Match_confidences<CGAL::Sequential_tag>(matching).run(*match);
  std::size_t number = 0, number_below = 0;
  const auto visit = [&](const auto& self, const Matched_branch& pair, double confidence) -> void {
    ++number;
    for (const Matched_branch::Pair& child : pair.pairs) {
      const double own =
          found.at(matching.energy().path(0, pair.path_1).children[child.child_1].start);
      BOOST_TEST(own <= confidence);
      number_below += own < confidence ? 1 : 0;
      self(self, *child.branch, own);
    }
  };
  visit(visit, *match, 1);
  BOOST_TEST(number == found.size());
  BOOST_TEST(number_below > 0u);
}

BOOST_AUTO_TEST_CASE(more_than_512_children_have_confidences)
{
  const Rooted_tree one = brush(1, 700), two = brush(2, 650);
  Matching matching = matching_of(one, two);
  const Result match = run(matching);
  const Confidences found = Match_confidences<CGAL::Sequential_tag>(matching).run(*match);
  BOOST_TEST(match->pairs.size() > 600u);
  BOOST_TEST(found.size() == 1 + match->pairs.size());
  for (const auto& [start, confidence] : found)
    BOOST_TEST((confidence >= 0 && confidence <= 1));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Match_confidences

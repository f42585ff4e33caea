// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Matches of points of two scans: densities, outliers, coincident points, gaps, the reach.

#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/points/match_points.h>
#include <support/transport.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace test_match_points {

using pcs::Point_transport;
using pcs::Point_weights;
using pcs::Transport_options;

using namespace pcs::shape_space;
using namespace transport_test;

BOOST_AUTO_TEST_SUITE(matches_of_points)

BOOST_AUTO_TEST_CASE(skewed_densities_are_carried_with_area_weights)
{
  std::mt19937 random(2);
  const std::vector<Vec3> one = cylinder(random, 600);
  std::vector<Vec3> two = cylinder(random, 900);
  for (Vec3& p : two) // four times as dense at one end
    p.z() = 6 * (std::sqrt(1 + 15 * p.z() / 6) - 1) / 3;
  Transport_problem problem;
  const Transport_plan plan =
      match_places(Distinct_positions(one), Distinct_positions(two), all_is_carried(), problem);
  BOOST_TEST(plan.is_complete);
  BOOST_TEST(plan.remaining == 0);
  BOOST_TEST(plan.violation <= 1e-9);
  std::vector<char> has_partner(one.size() + two.size(), 0);
  const auto arcs = main_arcs(problem, plan);
  for (const std::uint32_t k : arcs)
    has_partner[problem.arcs[k].source] = has_partner[one.size() + problem.arcs[k].target] = 1;
  BOOST_TEST(std::count(has_partner.begin(), has_partner.end(), 0) == 0);
  BOOST_TEST(arcs.size() <= one.size() + two.size() - 1);
}

BOOST_AUTO_TEST_CASE(points_beside_the_surface_do_not_draw_it_to_themselves)
{
  std::mt19937 random(5);
  std::vector<Vec3> one = cylinder(random, 600), two = cylinder(random, 600);
  constexpr std::size_t number_of_outliers = 6;
  for (std::size_t k = 0; k < number_of_outliers; ++k)
    one.emplace_back(k % 2 == 0 ? 4 : -4, 0, static_cast<double>(k)); // four radii from the axis
  Transport_problem problem;
  const Transport_plan plan =
      match_places(Distinct_positions(one), Distinct_positions(two), all_is_carried(), problem);
  BOOST_TEST(plan.is_complete);
  std::vector<std::size_t> partners(one.size(), 0);
  for (const std::uint32_t k : main_arcs(problem, plan))
    ++partners[problem.arcs[k].source];
  for (std::size_t i = 600; i < one.size(); ++i) {
    BOOST_TEST(partners[i] >= 1u);
    BOOST_TEST(partners[i] <= 2u); // 10 to 16 with the weight of their surroundings
  }
}

BOOST_AUTO_TEST_CASE(points_in_one_place_cost_no_more_pivots_than_one)
{
  std::mt19937 random(7);
  std::vector<Vec3> one = cylinder(random, 300), two = cylinder(random, 400);
  const auto pivots = [&] {
    Transport_problem problem;
    const Distinct_positions places_1(one), places_2(two);
    const Transport_plan plan = match_places(places_1, places_2, Transport_options(), problem);
    BOOST_TEST(plan.is_complete);
    BOOST_TEST(problem.arcs.size() <= 16 * (301 + 401)); // not more neighbours than requested
    return plan.number_of_pivots;
  };
  one.push_back(Vec3(1, 0, 3));
  two.push_back(Vec3(1, 0, 3.01));
  const std::size_t alone = pivots();
  for (int k = 1; k < 5000; ++k) {
    one.insert(one.begin() + (k % 300), one.back());
    two.insert(two.begin() + (k % 400), two.back());
  }
  BOOST_TEST(alone > 0u);
  BOOST_TEST(pivots() <= 2 * alone); // the order of the positions differs
}

BOOST_AUTO_TEST_CASE(points_in_one_place_share_its_partners)
{
  std::mt19937 random(8);
  for (const auto& [kind, reach] : {std::make_pair(Point_weights::area, 3.),
                                    std::make_pair(Point_weights::area, infinite),
                                    std::make_pair(Point_weights::equal, infinite)}) {
    std::vector<Vec3> one = cylinder(random, 300), two = cylinder(random, 400);
    one.insert(one.end(), 200, Vec3(1, 0, 3));
    two.insert(two.end(), 50, Vec3(1, 0, 3.01));
    Transport_options options;
    options.weights = kind;
    options.reach = reach;
    const Point_matches found = match_points(one, two, options);
    BOOST_TEST(found.is_complete);
    BOOST_TEST(found.violation <= 1e-9);
    std::vector<std::size_t> partners_1(one.size(), 0), partners_2(two.size(), 0);
    for (const auto& [i, j] : found.pairs) {
      ++partners_1[i];
      ++partners_2[j];
    }
    BOOST_TEST(std::count(partners_1.begin(), partners_1.end(), 0) == 0);
    BOOST_TEST(std::count(partners_2.begin(), partners_2.end(), 0) == 0);
    BOOST_TEST(found.pairs.size() <= one.size() + two.size() - 1);
    // As one surface element, the 200 points attract no others. With equal weights they do, but
    // each has few partners.
    const auto most = *std::max_element(partners_1.begin() + 300, partners_1.end());
    BOOST_TEST(most <= 3u);
  }
}

BOOST_AUTO_TEST_CASE(without_points_in_one_place_nothing_is_shared)
{
  std::mt19937 random(9);
  const std::vector<Vec3> one = cylinder(random, 200), two = cylinder(random, 300);
  Transport_problem problem;
  const Transport_plan plan =
      match_places(Distinct_positions(one), Distinct_positions(two), Transport_options(), problem);
  const Point_matches found = match_points(one, two, Transport_options());
  const auto arcs = main_arcs(problem, plan);
  BOOST_TEST_REQUIRE(found.pairs.size() == arcs.size());
  for (std::size_t k = 0; k < arcs.size(); ++k) {
    BOOST_TEST(found.pairs[k].first == problem.arcs[arcs[k]].source);
    BOOST_TEST(found.pairs[k].second == problem.arcs[arcs[k]].target);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(partial_matches)

BOOST_AUTO_TEST_CASE(regularised_it_is_nearly_the_same)
{
  std::mt19937 random(12);
  const std::vector<Vec3> one = cylinder(random, 150), two = cylinder(random, 200);
  Transport_options options;
  Transport_problem problem;
  const Transport_plan exact =
      match_places(Distinct_positions(one), Distinct_positions(two), options, problem);
  options.method = Point_transport::sinkhorn;
  options.sinkhorn.regularization = 0.005;
  options.sinkhorn.iterations = 5000;
  const Transport_plan regularised =
      match_places(Distinct_positions(one), Distinct_positions(two), options, problem);
  BOOST_TEST(exact.remaining > 0.01);
  BOOST_TEST(exact.remaining < 0.3);
  BOOST_TEST(regularised.violation < 1e-3);
  std::size_t number_alike = 0;
  const auto arcs = main_arcs(problem, exact);
  auto others = main_arcs(problem, regularised);
  std::sort(others.begin(), others.end());
  for (const std::uint32_t k : arcs)
    number_alike += std::binary_search(others.begin(), others.end(), k) ? 1 : 0;
  BOOST_TEST_MESSAGE(number_alike << " of " << arcs.size() << " partners alike");
  BOOST_TEST(static_cast<double>(number_alike) > 0.8 * static_cast<double>(arcs.size()));
}

BOOST_AUTO_TEST_CASE(a_gap_of_one_scan_does_not_shift_what_is_around_it)
{
  std::mt19937 random(6);
  const std::vector<Vec3> one = cylinder(random, 1200);
  std::vector<Vec3> two = cylinder(random, 1200);
  two.erase(std::remove_if(two.begin(), two.end(), [](const Vec3& p) { return p.x() > 0.5; }),
            two.end());
  const double spacing = mean_spacing(one);
  const auto mean_distance = [&](const Transport_options& options) { // on the side without a gap
    Transport_problem problem;
    const Transport_plan plan =
        match_places(Distinct_positions(one), Distinct_positions(two), options, problem);
    BOOST_TEST(plan.is_complete);
    BOOST_TEST(plan.violation <= 1e-9);
    if (std::isfinite(options.reach)) {
      BOOST_TEST(plan.remaining > 0.15); // a third of the circle
      BOOST_TEST(plan.remaining < 0.4);
    }
    double sum = 0, number = 0;
    for (const std::uint32_t k : main_arcs(problem, plan))
      if (one[problem.arcs[k].source].x() < 0) {
        sum += std::sqrt(problem.arcs[k].cost);
        number += 1;
      }
    return sum / (number * spacing);
  };
  const double partial = mean_distance(Transport_options()), full = mean_distance(all_is_carried());
  BOOST_TEST_MESSAGE("a gap: " << partial << ", all carried " << full << " spacings");
  BOOST_TEST(partial < 1.3);
  BOOST_TEST(full > 2);
}

BOOST_AUTO_TEST_CASE(the_partner_with_most_mass_comes_first)
{
  std::mt19937 random(17);
  const std::vector<Vec3> one = cylinder(random, 200), two = cylinder(random, 500);
  Transport_problem problem;
  const Transport_plan plan =
      match_places(Distinct_positions(one), Distinct_positions(two), Transport_options(), problem);
  std::vector<double> mass(problem.arcs.size(), 0), most(one.size(), 0);
  for (const auto& flow : plan.flows) {
    mass[flow.arc] = flow.mass;
    double& m = most[problem.arcs[flow.arc].source];
    m = std::max(m, flow.mass);
  }
  std::size_t last = none, number_of_others = 0;
  for (const std::uint32_t k : main_arcs(problem, plan)) {
    const std::size_t source = problem.arcs[k].source;
    BOOST_TEST((last == none || source >= last));
    if (source != last)
      BOOST_TEST(mass[k] == most[source]);
    else
      ++number_of_others;
    last = source;
  }
  BOOST_TEST(number_of_others > 100u);
}

BOOST_AUTO_TEST_CASE(nothing_goes_beyond_the_reach)
{
  std::mt19937 random(14);
  const std::vector<Vec3> one = cylinder(random, 500), two = cylinder(random, 400);
  std::vector<double> nearest; // in both directions
  using Clouds = std::pair<const std::vector<Vec3>*, const std::vector<Vec3>*>;
  const Clouds directions[] = {{&one, &two}, {&two, &one}};
  for (const auto& [from, to] : directions) {
    const pcs::neighborhood::Nearest_neighbors search(*to);
    std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
    for (const Vec3& p : *from) {
      search(p, 1, found);
      nearest.push_back(std::sqrt(found[0].squared_distance));
    }
  }
  std::sort(nearest.begin(), nearest.end());
  for (const bool is_squared : {true, false})
    for (const double reach : {1.5, 4.}) {
      Transport_options options;
      options.is_squared = is_squared;
      options.reach = reach;
      Transport_problem problem;
      const Transport_plan plan =
          match_places(Distinct_positions(one), Distinct_positions(two), options, problem);
      double farthest = 0;
      for (const auto& flow : plan.flows) {
        const auto& arc = problem.arcs[flow.arc];
        farthest = std::max(farthest, (one[arc.source] - two[arc.target]).norm());
      }
      BOOST_TEST(farthest <= reach * nearest[nearest.size() / 2]);
      BOOST_TEST(farthest >= 0.8 * reach * nearest[nearest.size() / 2]);
    }
}

BOOST_AUTO_TEST_CASE(opposite_of_a_gap_the_nearest_point_is_the_partner)
{
  std::mt19937 random(13);
  const std::vector<Vec3> one = cylinder(random, 600);
  std::vector<Vec3> two = cylinder(random, 600);
  two.erase(std::remove_if(two.begin(), two.end(), [](const Vec3& p) { return p.z() > 3; }),
            two.end());
  const Point_matches found = match_points(one, two, Transport_options());
  BOOST_TEST(found.is_complete);
  BOOST_TEST(found.pairs.size() <= one.size() + two.size() - 1);
  const pcs::neighborhood::Nearest_neighbors search(two);
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> nearest;
  std::size_t number_far = 0;
  for (const auto& [i, j] : found.pairs)
    if (one[i].z() > 4) {
      search(one[i], 1, nearest);
      BOOST_TEST(j == nearest[0].index);
      ++number_far;
    }
  BOOST_TEST(number_far > 150u);
}

BOOST_AUTO_TEST_CASE(a_reach_beyond_all_points_carries_all)
{
  std::mt19937 random(15);
  const std::vector<Vec3> one = cylinder(random, 300);
  std::vector<Vec3> two = cylinder(random, 300);
  two.erase(std::remove_if(two.begin(), two.end(), [](const Vec3& p) { return p.z() > 3; }),
            two.end());
  Transport_problem problem;
  const Transport_plan all =
      match_places(Distinct_positions(one), Distinct_positions(two), all_is_carried(), problem);
  const auto arcs = main_arcs(problem, all);
  for (const double reach : {1e3, 1e12, 1e300}) {
    Transport_options options;
    options.reach = reach;
    const Transport_plan plan =
        match_places(Distinct_positions(one), Distinct_positions(two), options, problem);
    BOOST_TEST(plan.is_complete);
    BOOST_TEST(plan.remaining == 0);
    BOOST_TEST(main_arcs(problem, plan) == arcs);
  }
}

BOOST_AUTO_TEST_CASE(few_candidates_do_not_leave_what_could_be_carried)
{
  std::mt19937 random(16);
  const std::vector<Vec3> one = cylinder(random, 300), two = cylinder(random, 400);
  const auto remaining = [&](std::size_t number_of_neighbors) {
    Transport_options options;
    options.reach = 8;
    options.number_of_neighbors = number_of_neighbors;
    Transport_problem problem;
    return match_places(Distinct_positions(one), Distinct_positions(two), options, problem)
        .remaining;
  };
  const double of_all = remaining(400), of_few = remaining(2);
  BOOST_TEST_MESSAGE("remaining of all candidates " << of_all << ", of two " << of_few);
  BOOST_TEST(of_few < of_all + 0.04); // 0.066 more without arcs between the remaining points
}

BOOST_AUTO_TEST_CASE(the_usual_distance_has_the_spacing_as_a_limit)
{
  const std::vector<double> areas(10, 2);
  std::vector<double> squared(10, 0); // most distances are zero
  squared[8] = 0.28;
  squared[9] = 1.125;
  BOOST_TEST(pcs::shape_space::internal::usual_distance(squared, areas) == std::sqrt(2. / 16));
  std::fill(squared.begin() + 3, squared.end(), 9);
  BOOST_TEST(pcs::shape_space::internal::usual_distance(squared, areas) == 3);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_match_points

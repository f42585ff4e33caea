// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the neighbour graph with a brute-force search, and tests its components.

#include <pcs/neighborhood/Proximity_graph.h>
#include <support/point_clouds.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <numeric>
#include <set>

namespace test_Proximity_graph {

namespace {

using pcs::neighborhood::nearest_neighbor_graph;
using pcs::neighborhood::Proximity_graph;
using pcs_test::Points;
using pcs_test::Vec3;
using Any_tag = CGAL::Parallel_if_available_tag;

bool holds(const Proximity_graph& g, std::size_t i, std::size_t j)
{
  return std::binary_search(g.begin(i), g.end(i), static_cast<std::uint32_t>(j));
}

void check_shape(const Proximity_graph& g, std::size_t n)
{
  BOOST_REQUIRE(g.size() == n);
  BOOST_REQUIRE(g.first.back() == g.neighbor.size());
  std::size_t faults = 0;
  for (std::size_t i = 0; i < n; ++i) {
    faults += std::is_sorted(g.begin(i), g.end(i)) ? 0 : 1;
    faults += std::adjacent_find(g.begin(i), g.end(i)) == g.end(i) ? 0 : 1;
    for (auto j = g.begin(i); j != g.end(i); ++j)
      faults += *j < n && *j != i && holds(g, *j, i) ? 0 : 1;
  }
  BOOST_TEST(faults == 0u, "rows increase, hold no loops, and every edge is there twice");
}

/// Squared distances of all other points to point i, sorted.
std::vector<std::pair<double, std::size_t>> others(const Points& points, std::size_t i)
{
  std::vector<std::pair<double, std::size_t>> result;
  for (std::size_t j = 0; j < points.size(); ++j)
    if (j != i)
      result.emplace_back((points[j] - points[i]).squaredNorm(), j);
  std::sort(result.begin(), result.end());
  return result;
}

/// Checks that every edge is selected by one of its ends, and that all selected edges exist. With
/// `ties` the choice among points at equal distances is free, but points strictly nearer than the
/// k-th are required.
void check_against_brute_force(const Points& points, std::size_t k)
{
  const auto g = nearest_neighbor_graph<Any_tag>(points, k);
  check_shape(g, points.size());
  const double tie = 1.01 * 1.01;
  std::size_t missing = 0, unwanted = 0, too_few = 0;
  std::vector<double> reach(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto near = others(points, i);
    const std::size_t count = std::min(k, near.size());
    reach[i] = count > 0 ? tie * near[count - 1].first * (1 + 1e-12) : 0;
    too_few += g.degree(i) < count ? 1 : 0;
    std::size_t number_of_ties = 0;
    for (const auto& [d, j] : near)
      number_of_ties += d <= reach[i] ? 1 : 0;
    for (const auto& [d, j] : near) {
      const bool is_nearer = d < near[count - 1].first * (1 - 1e-12);
      const bool is_tie = d <= reach[i] && number_of_ties <= k + 4;
      missing += (is_nearer || is_tie) && !holds(g, i, j) ? 1 : 0;
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    for (auto j = g.begin(i); j != g.end(i); ++j)
      unwanted += (points[*j] - points[i]).squaredNorm() > std::max(reach[i], reach[*j]) ? 1 : 0;
  BOOST_TEST(missing == 0u);
  BOOST_TEST(unwanted == 0u);
  BOOST_TEST(too_few == 0u);
}

} // namespace

BOOST_AUTO_TEST_SUITE(Proximity_graph)

BOOST_AUTO_TEST_CASE(rows_hold_the_k_nearest_of_random_points)
{
  for (const std::size_t k : {2u, 6u, 20u, 60u})
    check_against_brute_force(pcs_test::random_points(300, 1), k);
}

BOOST_AUTO_TEST_CASE(rows_hold_all_equals_on_grids)
{
  const auto g = nearest_neighbor_graph<Any_tag>(pcs_test::plate(12, 12, 0.1), 6);
  check_shape(g, 169);
  // The six nearest points of a grid point: four at h and two of the four at sqrt(2) h. With ties,
  // all eight.
  BOOST_TEST(g.degree(6 * 13 + 6) == 8u);
  check_against_brute_force(pcs_test::plate(12, 12, 0.1), 6);
  check_against_brute_force(pcs_test::box(5, 5, 9, 1. / 3), 6);
}

BOOST_AUTO_TEST_CASE(graphs_of_few_points_are_complete)
{
  for (const std::size_t n : {0u, 1u, 2u, 3u, 6u, 7u}) {
    const auto g = nearest_neighbor_graph<Any_tag>(pcs_test::random_points(n, 2), 6);
    check_shape(g, n);
    BOOST_TEST(g.neighbor.size() == (n < 2 ? 0 : n * (n - 1)));
  }
}

BOOST_AUTO_TEST_CASE(the_largest_k_works)
{
  check_against_brute_force(pcs_test::random_points(200, 3),
                            pcs::neighborhood::maximal_number_of_neighbors);
  check_against_brute_force(pcs_test::plate(14, 14, 1),
                            pcs::neighborhood::maximal_number_of_neighbors);
}

BOOST_AUTO_TEST_CASE(an_outlier_is_linked_and_links_back)
{
  Points points = pcs_test::random_points(200, 4);
  points.push_back(Vec3(1e9, 0, 0));
  const auto g = nearest_neighbor_graph<Any_tag>(points, 6);
  check_shape(g, points.size());
  BOOST_TEST(g.degree(200) >= 6u);
}

BOOST_AUTO_TEST_CASE(a_hub_may_have_more_links_back_than_k)
{
  // 30 rays from one center, which is a nearest point of the inner point of every ray.
  Points points{Vec3(0, 0, 0)};
  for (const Vec3& p : pcs_test::sphere(30))
    for (const double radius : {1.0, 3.0, 5.5})
      points.push_back(radius * p);
  check_against_brute_force(points, 2);
}

BOOST_AUTO_TEST_CASE(a_shift_by_5e6_changes_nothing)
{
  // Coordinates are multiples of 2^-20: the shift is exact.
  Points points = pcs_test::random_points(1000, 5), shifted;
  for (Vec3& p : points) {
    p = (p * 1048576).array().round() / 1048576;
    shifted.push_back(p + Vec3(5e6, -5e6, 5e6));
  }
  const auto a = nearest_neighbor_graph<Any_tag>(points, 6),
             b = nearest_neighbor_graph<Any_tag>(shifted, 6);
  BOOST_TEST((a.first == b.first && a.neighbor == b.neighbor));
}

BOOST_AUTO_TEST_CASE(the_graph_is_the_same_for_every_number_of_threads)
{
  const Points points = pcs_test::random_points(20000, 6);
  const auto sequential = nearest_neighbor_graph<CGAL::Sequential_tag>(points, 6);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      const auto g = nearest_neighbor_graph<Any_tag>(points, 6);
      BOOST_TEST((g.first == sequential.first && g.neighbor == sequential.neighbor));
    });
}

BOOST_AUTO_TEST_CASE(graph_from_edges_drops_loops_and_repetitions)
{
  const auto g = pcs::neighborhood::graph_from_edges(4, {{0, 1}, {1, 0}, {2, 2}, {3, 1}, {0, 1}});
  check_shape(g, 4);
  BOOST_TEST(g.neighbor.size() == 4u);
  BOOST_TEST((holds(g, 0, 1) && holds(g, 1, 3)));
  BOOST_TEST(g.degree(2) == 0u);
  check_shape(pcs::neighborhood::graph_from_edges(3, {}), 3);
}

BOOST_AUTO_TEST_CASE(components_are_those_of_repeated_merging)
{
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const std::size_t n = 60;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (int e = 0; e < 45; ++e)
      edges.emplace_back(random() % n, random() % n);
    std::vector<std::uint32_t> expected(n);
    std::iota(expected.begin(), expected.end(), 0u);
    for (std::size_t round = 0; round < n; ++round)
      for (const auto& [a, b] : edges)
        expected[a] = expected[b] = std::min(expected[a], expected[b]);
    std::size_t count = 0;
    const auto component =
        connected_components(pcs::neighborhood::graph_from_edges(n, edges), count);
    BOOST_TEST(count == std::set<std::uint32_t>(expected.begin(), expected.end()).size());
    // Components are numbered by their smallest vertex.
    std::vector<std::uint32_t> roots(expected);
    std::sort(roots.begin(), roots.end());
    roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
    for (std::size_t i = 0; i < n; ++i)
      BOOST_TEST(roots[component[i]] == expected[i]);
  }
}

BOOST_AUTO_TEST_CASE(components_extend_over_all_blocks_of_vertices)
{
  // Chains of vertices with the same remainder, each linked to the next in a random order.
  constexpr std::uint32_t n = 100000, number_of_chains = 7;
  std::mt19937 random(1);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t chain = 0; chain < number_of_chains; ++chain) {
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t v = chain; v < n; v += number_of_chains)
      vertices.push_back(v);
    std::shuffle(vertices.begin(), vertices.end(), random);
    for (std::size_t v = 1; v < vertices.size(); ++v)
      edges.emplace_back(vertices[v - 1], vertices[v]);
  }
  const auto graph = pcs::neighborhood::graph_from_edges(n, edges);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      std::size_t count = 0;
      const auto component = pcs::neighborhood::connected_components<Any_tag>(graph, count);
      BOOST_TEST(count == number_of_chains);
      std::size_t faults = 0;
      for (std::uint32_t v = 0; v < n; ++v)
        faults += component[v] == v % number_of_chains ? 0 : 1;
      BOOST_TEST(faults == 0u);
    });
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Proximity_graph

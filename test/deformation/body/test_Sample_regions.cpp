// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares sample regions with Dijkstra's algorithm, and tests the graph of the samples.

#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/body/octree_samples.h>
#include <pcs/neighborhood/drop_short_cuts.h>
#include <support/networks.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <queue>

namespace test_Sample_regions {

namespace {

using pcs::neighborhood::Proximity_graph;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Sequential_tag;

/// Documented length of an edge in integer steps: its length in 64ths of the mean, from 1 to 4096.
std::uint64_t steps(double length, double scale)
{
  return static_cast<std::uint64_t>(std::min(4096.0, std::max(1.0, std::round(scale * length))));
}

std::vector<std::uint64_t>
distances_from(std::size_t source, const Points& points, const Proximity_graph& graph, double scale)
{
  std::vector<std::uint64_t> distance(points.size(), ~std::uint64_t(0));
  using Entry = std::pair<std::uint64_t, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  queue.emplace(distance[source] = 0, source);
  while (!queue.empty()) {
    const auto [d, i] = queue.top();
    queue.pop();
    if (d > distance[i])
      continue;
    for (auto j = graph.begin(i); j != graph.end(i); ++j) {
      const auto through = d + steps((points[*j] - points[i]).norm(), scale);
      if (through < distance[*j])
        queue.emplace(distance[*j] = through, *j);
    }
  }
  return distance;
}

void check_against_dijkstra(const Points& unordered, std::size_t count)
{
  const Points points = pcs_test::in_spatial_order(unordered);
  const auto graph = pcs::neighborhood::nearest_neighbor_graph<Tag>(points, 6);
  const auto samples = pcs::deformation::octree_samples(points, count);
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      sum += (points[*j] - points[i]).norm();
  static_cast<void>(sum);
  const double scale = 64 / pcs::deformation::typical_edge(points, graph);
  std::vector<std::uint64_t> best(points.size(), ~std::uint64_t(0));
  std::vector<std::uint32_t> expected(points.size(), pcs::deformation::no_sample);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const auto distance = distances_from(samples[s], points, graph, scale);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (distance[i] < best[i]) { // ties select the smaller index
        best[i] = distance[i];
        expected[i] = static_cast<std::uint32_t>(s);
      }
  }
  const auto found = pcs::deformation::grow_regions(points, graph, samples).sample_of_point;
  std::size_t different = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    different += found[i] != expected[i] ? 1 : 0;
  BOOST_TEST(different == 0u);
}

struct Sampled
{
  Points points;
  Proximity_graph graph;
  std::size_t number_of_short_cuts;
  std::vector<std::uint32_t> samples;
  pcs::deformation::Sample_regions regions;
  double weight_unit = 0;
  pcs::deformation::Weighted_graph links;

  Sampled(const Points& unordered, std::size_t count)
    : points(pcs_test::in_spatial_order(unordered)),
      graph(pcs::neighborhood::nearest_neighbor_graph<Tag>(points, 6)),
      number_of_short_cuts(pcs::neighborhood::drop_short_cuts<Tag>(points, graph)),
      samples(pcs::deformation::octree_samples(points, count)),
      regions(pcs::deformation::grow_regions(points, graph, samples)),
      links(pcs::deformation::sample_graph(points, graph, samples, regions, weight_unit))
  {
  }
  const Vec3& sample(std::size_t s) const { return points[samples[s]]; }
};

/// The number of links between samples below and above the middle of the gap, beyond `x`.
std::size_t cross_links(const Sampled& s, double gap, double x)
{
  std::size_t count = 0;
  for (std::size_t a = 0; a < s.samples.size(); ++a)
    for (auto b = s.links.begin(a); b != s.links.end(a); ++b)
      if ((s.sample(a).z() < gap / 2) != (s.sample(*b).z() < gap / 2) &&
          std::min(s.sample(a).x(), s.sample(*b).x()) > x)
        ++count;
  return count;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Sample_regions)

BOOST_AUTO_TEST_CASE(regions_of_several_blocks_are_those_of_dijkstra)
{
  check_against_dijkstra(pcs_test::sphere(40000), 5);
  Points snake; // paths cross the blocks many times
  for (int i = 0; i < 40000; ++i)
    snake.push_back(Vec3(i % 2000, 3.0 * (i / 2000), std::sin(0.01 * i)));
  check_against_dijkstra(snake, 3);
}

BOOST_AUTO_TEST_CASE(regions_are_the_same_for_every_number_of_threads)
{
  const Points points = pcs_test::in_spatial_order(pcs_test::sphere(60000));
  const auto graph = pcs::neighborhood::nearest_neighbor_graph<Tag>(points, 6);
  const auto samples = pcs::deformation::octree_samples(points, 300);
  const auto expected = pcs::deformation::grow_regions(points, graph, samples).sample_of_point;
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      using Any_tag = CGAL::Parallel_if_available_tag;
      const auto found = pcs::deformation::grow_regions<Any_tag>(points, graph, samples);
      BOOST_TEST((found.sample_of_point == expected));
    });
}

BOOST_AUTO_TEST_CASE(regions_are_those_of_dijkstra)
{
  check_against_dijkstra(pcs_test::random_points(1500, 1), 40);
  check_against_dijkstra(pcs_test::plate(40, 40, 0.1), 60); // many ties
  check_against_dijkstra(pcs_test::sheets(30, 20, 5, true), 50);
}

BOOST_AUTO_TEST_CASE(edges_longer_than_the_largest_step_still_lead_on)
{
  Points points = pcs_test::random_points(1000, 2);
  for (int i = 1; i < 10; ++i) // increasing distances: thousands of mean edges
    points.push_back(Vec3(10.0 * i * i * i, 0, 0));
  check_against_dijkstra(points, 20);
}

BOOST_AUTO_TEST_CASE(parts_without_sample_have_no_region)
{
  Points points = pcs_test::plate(10, 10, 1);
  const auto graph = pcs::neighborhood::graph_from_edges(points.size(), {{0, 1}, {1, 2}, {4, 5}});
  const auto regions = pcs::deformation::grow_regions(points, graph, {1}).sample_of_point;
  for (std::size_t i = 0; i < points.size(); ++i)
    BOOST_TEST((regions[i] == (i < 3 ? 0 : pcs::deformation::no_sample)));
}

BOOST_AUTO_TEST_CASE(the_graph_of_the_samples_is_symmetric_with_mean_weight_one)
{
  const Sampled s(pcs_test::sphere(3000), 100);
  double sum = 0;
  for (std::size_t a = 0; a < 100; ++a)
    for (std::size_t e = s.links.first[a]; e < s.links.first[a + 1]; ++e) {
      const std::uint32_t b = s.links.neighbor[e];
      const auto back =
          std::lower_bound(s.links.begin(b), s.links.end(b), static_cast<std::uint32_t>(a));
      BOOST_REQUIRE((back != s.links.end(b) && *back == a));
      BOOST_REQUIRE(s.links.weight[std::size_t(back - s.links.neighbor.data())] ==
                    s.links.weight[e]);
      BOOST_REQUIRE(s.links.weight[e] > 0);
      sum += s.links.weight[e];
    }
  BOOST_TEST(sum / double(s.links.weight.size()) == 1, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(weights_are_border_over_distance)
{
  const Sampled s(pcs_test::random_points(500, 3), 12);
  const auto& label = s.regions.sample_of_point;
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::size_t e = s.links.first[a]; e < s.links.first[a + 1]; ++e) {
      const std::uint32_t b = s.links.neighbor[e];
      double border = 0;
      for (std::size_t i = 0; i < s.points.size(); ++i)
        for (auto j = s.graph.begin(i); j != s.graph.end(i); ++j)
          if (label[i] == a && label[*j] == b)
            border += pcs::deformation::crossing_length(s.points, s.graph, i, *j);
      const double expected = s.weight_unit * border / (s.sample(a) - s.sample(b)).norm();
      BOOST_TEST(s.links.weight[e] == expected, boost::test_tools::tolerance(1e-12));
    }
}

BOOST_AUTO_TEST_CASE(parallel_sheets_are_not_linked)
{
  for (const double gap : {1.5, 5.0}) {
    const Sampled separate(pcs_test::sheets(40, 20, gap, false), 150);
    BOOST_TEST(cross_links(separate, gap, -1) == 0u);
    const Sampled folded(pcs_test::sheets(40, 20, gap, true), 150);
    BOOST_TEST(cross_links(folded, gap, 5) == 0u);
    BOOST_TEST(cross_links(folded, gap, -100) > 0u); // across the fold
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Sample_regions

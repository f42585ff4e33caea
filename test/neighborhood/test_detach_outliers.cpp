// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Outliers are connected to the rest by one point; points of sparse or dense bodies are not
// outliers.

#include <pcs/neighborhood/detach_outliers.h>
#include <support/point_clouds.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <random>

namespace test_detach_outliers {

namespace {

using pcs::neighborhood::detach_outliers;
using pcs::neighborhood::nearest_neighbor_graph;
using pcs::neighborhood::Outlier;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Parallel_if_available_tag;

} // namespace

BOOST_AUTO_TEST_SUITE(outliers)

BOOST_AUTO_TEST_CASE(bodies_have_none)
{
  Points gradient = pcs_test::random_points(2000, 2);
  for (Vec3& p : gradient) // seven times denser at one end
    p = Vec3(std::pow(p.x() + 1.4, 2), 4 * p.y(), 0);
  for (const Points& points :
       {pcs_test::plate(20, 20, 1), pcs_test::random_points(1000, 1), gradient}) {
    auto graph = nearest_neighbor_graph<Tag>(points, 6);
    const auto before = graph.neighbor;
    BOOST_TEST(detach_outliers<Tag>(points, graph).empty());
    BOOST_TEST((graph.neighbor == before));
  }
}

BOOST_AUTO_TEST_CASE(each_is_found_and_keeps_its_shortest_link)
{
  Points points = pcs_test::plate(30, 30, 1);
  const auto n = static_cast<std::uint32_t>(points.size());
  std::vector<std::uint32_t> host;
  for (const double distance : {5.0, 10.0, 1e3, 1e9}) {
    const auto h = static_cast<std::uint32_t>(31 * host.size() + 40);
    points.push_back(points[h] + Vec3(0, 0, host.size() % 2 ? distance : -distance));
    host.push_back(h);
  }
  auto graph = nearest_neighbor_graph<Tag>(points, 6);
  const auto found = detach_outliers<Tag>(points, graph);
  BOOST_REQUIRE(found.size() == host.size());
  for (std::uint32_t o = 0; o < host.size(); ++o) {
    BOOST_TEST(found[o].point == n + o);
    BOOST_REQUIRE(graph.degree(n + o) == 1u);
    BOOST_TEST(*graph.begin(n + o) == found[o].host);
    if (o < 3) // at 1e9, the nearest point of the plate is below the rounding error
      BOOST_TEST(found[o].host == host[o]);
  }
  std::size_t count = 0;
  connected_components(graph, count);
  BOOST_TEST(count == 1u);
}

BOOST_AUTO_TEST_CASE(few_points_are_not_judged)
{
  for (std::size_t n = 1; n <= 4; ++n) {
    Points points;
    for (std::size_t i = 0; i < n; ++i)
      points.push_back(Vec3(std::pow(1e3, double(i)), 0, 0));
    auto graph = nearest_neighbor_graph<Tag>(points, 6);
    detach_outliers<Tag>(points, graph);
    std::size_t count = 0;
    connected_components(graph, count);
    BOOST_TEST(count == 1u);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_detach_outliers

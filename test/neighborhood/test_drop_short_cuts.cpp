// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Links between sheets are removed; links of volumes, lines and groups of outliers remain.

#include <pcs/neighborhood/drop_short_cuts.h>
#include <support/point_clouds.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

namespace test_drop_short_cuts {

namespace {

using pcs::neighborhood::connected_components;
using pcs::neighborhood::drop_short_cuts;
using pcs::neighborhood::nearest_neighbor_graph;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Parallel_if_available_tag;

std::size_t number_of_components(const pcs::neighborhood::Proximity_graph& graph)
{
  std::size_t count = 0;
  connected_components(graph, count);
  return count;
}

} // namespace

BOOST_AUTO_TEST_SUITE(short_cuts)

BOOST_AUTO_TEST_CASE(two_sheets_become_two_components)
{
  const Points points = pcs_test::sheets(40, 20, 1.2, false);
  auto graph = nearest_neighbor_graph<Tag>(points, 6);
  BOOST_TEST(number_of_components(graph) == 1u);
  BOOST_TEST(drop_short_cuts<Tag>(points, graph) > 0u);
  BOOST_TEST(number_of_components(graph) == 2u);
}

BOOST_AUTO_TEST_CASE(volumes_and_lines_keep_their_links)
{
  Points line;
  for (int i = 0; i < 50; ++i)
    line.push_back(Vec3(i, 2 * i, 0));
  for (const Points& points : {pcs_test::random_points(500, 1), line}) {
    auto graph = nearest_neighbor_graph<Tag>(points, 6);
    const auto before = graph.neighbor.size();
    const auto dropped = drop_short_cuts<Tag>(points, graph);
    BOOST_TEST(double(dropped) < 0.1 * double(before));
    BOOST_TEST(number_of_components(graph) == 1u);
  }
}

BOOST_AUTO_TEST_CASE(a_clump_of_outliers_keeps_a_link)
{
  Points points = pcs_test::plate(30, 30, 1);
  for (const Vec3& d : {Vec3(0, 0, 0), Vec3(.4, .1, .2), Vec3(-.1, .5, .1), Vec3(.2, .3, .6)})
    points.push_back(Vec3(14.3, 15.2, 3) + d);
  auto graph = nearest_neighbor_graph<Tag>(points, 6);
  BOOST_TEST(number_of_components(graph) == 1u);
  drop_short_cuts<Tag>(points, graph);
  BOOST_TEST(number_of_components(graph) == 1u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_drop_short_cuts

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the weights of surface edges.

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

namespace test_Elastic_network {

BOOST_AUTO_TEST_SUITE(Elastic_network)

BOOST_AUTO_TEST_CASE(weights_are_symmetric_have_mean_one_and_fall_with_the_square)
{
  const auto network = pcs_test::network_of(pcs_test::random_points(300, 1));
  const auto& g = network.surface;
  std::vector<double> spacing(g.size());
  for (std::size_t i = 0; i < g.size(); ++i)
    spacing[i] = pcs::deformation::local_spacing(network.rest, g, i);
  double sum = 0, unit = 0;
  for (std::size_t i = 0; i < g.size(); ++i)
    for (std::size_t e = g.first[i]; e < g.first[i + 1]; ++e) {
      const std::size_t j = g.neighbor[e];
      const auto back = std::lower_bound(g.begin(j), g.end(j), static_cast<std::uint32_t>(i));
      BOOST_REQUIRE(g.weight[std::size_t(back - g.neighbor.data())] == g.weight[e]);
      const double smaller = std::min(spacing[i], spacing[j]);
      const double larger = std::min(std::max(spacing[i], spacing[j]), 2 * smaller);
      const double area = 0.5 * (smaller * smaller + larger * larger);
      const double expected =
          area / std::max(0.04 * area, (network.rest[j] - network.rest[i]).squaredNorm());
      if (unit == 0)
        unit = g.weight[e] / expected;
      BOOST_REQUIRE(std::abs(g.weight[e] - unit * expected) < 1e-12 * g.weight[e]);
      sum += g.weight[e];
    }
  BOOST_TEST(sum / double(g.weight.size()) == 1, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(two_points_that_nearly_coincide_do_not_outweigh_all_others)
{
  auto points = pcs_test::plate(10, 10, 1);
  points.push_back(points[50] + pcs_test::Vec3(1e-12, 0, 0));
  const auto network = pcs_test::network_of(points);
  for (const double w : network.surface.weight)
    BOOST_REQUIRE((std::isfinite(w) && w > 0 && w < 30));
}

BOOST_AUTO_TEST_CASE(the_spacing_of_small_groups_is_that_of_their_points)
{
  for (const int size : {3, 4, 5, 6})
    for (const double distance : {1e5, 1e9}) {
      const auto network = pcs_test::network_of(pcs_test::small_groups(size, distance, 1));
      for (std::size_t i = 0; i < network.size(); ++i) {
        const double spacing = pcs::deformation::local_spacing(network.rest, network.surface, i);
        BOOST_TEST(spacing < std::max(3.5, 1e-5 * distance));
        BOOST_TEST(spacing > 1e-3);
      }
    }
}

BOOST_AUTO_TEST_CASE(one_point_that_nearly_coincides_with_another_has_the_spacing_of_all)
{
  auto points = pcs_test::plate(10, 10, 1);
  points.push_back(points[50] + pcs_test::Vec3(1e-7, 0, 0));
  const auto network = pcs_test::network_of(points);
  for (std::size_t i = 0; i < network.size(); ++i)
    BOOST_TEST(pcs::deformation::local_spacing(network.rest, network.surface, i) > 0.9);
}

BOOST_AUTO_TEST_CASE(two_points_that_nearly_coincide_resist_rotations_like_one)
{
  auto points = pcs_test::plate(10, 10, 1);
  const std::size_t one = 55, other = points.size();
  const auto weight_of_fit = [&](const pcs::deformation::Elastic_network& network, std::size_t i) {
    return network.area[i] * pcs::deformation::node_degree(network.surface, i);
  };
  auto network = pcs_test::network_of(points);
  pcs::deformation::set_areas<CGAL::Sequential_tag>(std::vector<std::uint32_t>(other, 0), network);
  const double alone = weight_of_fit(network, one);
  points.push_back(points[one] + pcs_test::Vec3(1e-4, 0, 0));
  auto with_pair = pcs_test::network_of(points);
  // as heavy as the edge of two Voronoi cells
  auto& surface = with_pair.surface;
  for (const std::size_t i : {one, other})
    for (std::size_t e = surface.first[i]; e < surface.first[i + 1]; ++e)
      if (surface.neighbor[e] == one || surface.neighbor[e] == other)
        surface.weight[e] = 1e4;
  pcs::deformation::set_areas<CGAL::Sequential_tag>(std::vector<std::uint32_t>(other + 1, 0),
                                                    with_pair);
  for (const std::size_t i : {one, other}) {
    BOOST_TEST(weight_of_fit(with_pair, i) > 0.1 * alone);
    BOOST_TEST(weight_of_fit(with_pair, i) < 2 * alone);
  }
}

BOOST_AUTO_TEST_CASE(a_graph_without_edges_has_no_weights)
{
  pcs::deformation::Weighted_graph graph;
  graph.first.assign(4, 0);
  pcs::deformation::set_edge_weights<CGAL::Sequential_tag>(pcs_test::random_points(3, 3), graph);
  BOOST_TEST(graph.weight.empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Elastic_network

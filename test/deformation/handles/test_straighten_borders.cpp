// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Borders of handles are unchanged on grids, and follow the outermost points on irregular
// samplings.

#include <pcs/deformation/body/voronoi_graph.h>
#include <pcs/deformation/handles/straighten_borders.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace test_straighten_borders {

namespace {

using pcs::deformation::Cut_edges;
using pcs::deformation::Elastic_network;
using pcs::deformation::Node_constraints;
using pcs_test::Points;
using pcs_test::Vec3;

/// A handle of all points with `x <= border`.
Node_constraints hold(const Points& points, double border, bool is_soft = false)
{
  Node_constraints constraints;
  constraints.softness_weight = {is_soft ? 1.0 : 0.0};
  for (const Vec3& p : points)
    constraints.handle_of_node.push_back(p.x() <= border ? 0 : pcs::deformation::free_node);
  return constraints;
}

Elastic_network jittered_plate(double jitter)
{
  Points points;
  for (int x = 0; x < 30; ++x)
    for (int y = 0; y < 30; ++y)
      points.emplace_back(x, y, 0);
  std::mt19937 random(3);
  for (Vec3& p : points)
    for (int c = 0; c < 2; ++c)
      p[c] += jitter * (2 * pcs_test::uniform(random) - 1);
  Elastic_network network = pcs_test::network_of(points);
  network.surface =
      pcs::deformation::voronoi_graph<CGAL::Sequential_tag>(network.rest, network.surface);
  return network;
}

} // namespace

BOOST_AUTO_TEST_SUITE(straighten_borders)

BOOST_AUTO_TEST_CASE(on_a_grid_the_border_stays)
{
  const Elastic_network network = jittered_plate(0);
  Node_constraints constraints = hold(network.rest, 10);
  Elastic_network result = network;
  Cut_edges cut;
  pcs::deformation::straighten_borders(result, constraints, cut);
  for (std::size_t b = network.size(); b < result.size(); ++b) // only at the ends of the plate
    BOOST_TEST((result.rest[b].y() < 1.5 || result.rest[b].y() > 27.5));
  constraints = hold(network.rest, 100);
  Elastic_network untouched = network;
  Cut_edges none;
  BOOST_TEST(!pcs::deformation::straighten_borders(untouched, constraints, none));
  BOOST_TEST(none.empty());
  BOOST_TEST((untouched.surface.neighbor == network.surface.neighbor));
  BOOST_TEST(constraints.handle_of_node.size() == network.size());
  BOOST_TEST(untouched.size() == network.size());
}

BOOST_AUTO_TEST_CASE(soft_handles_have_no_border)
{
  Elastic_network network = jittered_plate(0.4);
  Node_constraints constraints = hold(network.rest, 10.5, true);
  Cut_edges cut;
  BOOST_TEST(!pcs::deformation::straighten_borders(network, constraints, cut));
}

BOOST_AUTO_TEST_CASE(the_border_runs_along_the_outermost_points)
{
  const Elastic_network network = jittered_plate(0.4);
  const double limit = 10.2;
  Node_constraints constraints = hold(network.rest, limit);
  const Node_constraints before = constraints;
  Elastic_network result = network;
  Cut_edges cut;
  BOOST_TEST_REQUIRE(pcs::deformation::straighten_borders(result, constraints, cut));
  const std::size_t n = network.size();
  BOOST_TEST_REQUIRE(result.size() > n);
  BOOST_TEST_REQUIRE(constraints.handle_of_node.size() == result.size());

  // Mean position of the prescribed border: the new nodes are nearer to the limit than the handle's
  // points.
  double held = 0, count = 0, straight = 0, straight_count = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (before.is_prescribed(i) || network.rest[i].y() < 4 || network.rest[i].y() > 25)
      continue;
    for (auto j = network.surface.begin(i); j != network.surface.end(i); ++j)
      if (before.is_prescribed(*j)) {
        held += network.rest[*j].x();
        count += 1;
      }
    for (auto j = result.surface.begin(i); j != result.surface.end(i); ++j)
      if (constraints.is_prescribed(*j)) {
        straight += result.rest[*j].x();
        straight_count += 1;
      }
  }
  BOOST_TEST_MESSAGE("held at " << held / count << ", now " << straight / straight_count);
  BOOST_TEST(std::abs(straight / straight_count - limit) < 0.6 * std::abs(held / count - limit));
}

BOOST_AUTO_TEST_CASE(edges_keep_their_slope_and_stay_symmetric)
{
  const Elastic_network network = jittered_plate(0.4);
  Node_constraints constraints = hold(network.rest, 10.2);
  Elastic_network result = network;
  Cut_edges cut;
  BOOST_TEST_REQUIRE(pcs::deformation::straighten_borders(result, constraints, cut));
  for (std::uint32_t i = 0; i < result.size(); ++i)
    for (std::size_t e = result.surface.first[i]; e < result.surface.first[i + 1]; ++e) {
      const std::uint32_t j = result.surface.neighbor[e];
      const auto back = std::lower_bound(result.surface.begin(j), result.surface.end(j), i);
      BOOST_TEST_REQUIRE((back != result.surface.end(j) && *back == i));
      BOOST_TEST_REQUIRE(
          result.surface.weight[std::size_t(back - result.surface.neighbor.data())] ==
          result.surface.weight[e]);
    }
  // A new node lies on an edge to its handle. It has the weight of this edge for the remaining
  // length.
  for (std::size_t b = network.size(); b < result.size(); ++b) {
    BOOST_TEST_REQUIRE(result.surface.degree(b) == 1u);
    const std::uint32_t i = *result.surface.begin(b);
    bool is_found = false;
    for (std::size_t e = network.surface.first[i]; e < network.surface.first[i + 1]; ++e) {
      const Vec3 edge = network.rest[network.surface.neighbor[e]] - network.rest[i];
      const Vec3 rest = result.rest[b] - network.rest[i];
      const double share = rest.norm() / edge.norm();
      is_found = is_found || ((rest - share * edge).norm() < 1e-12 && share > 0.199 &&
                              std::abs(result.surface.weight[result.surface.first[b]] * share /
                                           network.surface.weight[e] -
                                       1) < 1e-9);
    }
    BOOST_TEST(is_found);
  }
}

BOOST_AUTO_TEST_CASE(cuts_are_reversed)
{
  const Elastic_network network = jittered_plate(0.4);
  Elastic_network result = network;
  Cut_edges cut;
  for (const double limit : {10.2, 15.3, 28.4}) {
    Node_constraints constraints = hold(network.rest, limit);
    for (std::size_t i = 0; i < network.size(); ++i)
      if (network.rest[i].y() > limit)
        constraints.handle_of_node[i] = 0;
    BOOST_TEST_REQUIRE(pcs::deformation::straighten_borders(result, constraints, cut));
    BOOST_TEST(!cut.empty());
    BOOST_TEST(result.source.size() == result.size() - network.size());
    BOOST_TEST(result.surface.neighbor.size() == network.surface.neighbor.size());
    const auto uncut = pcs::deformation::uncut_surface(result, cut);
    pcs::deformation::restore_borders(result, cut);
    BOOST_TEST(cut.empty());
    const pcs::deformation::Weighted_graph* const surfaces[] = {&uncut, &result.surface};
    for (const auto* surface : surfaces) {
      BOOST_TEST((surface->first == network.surface.first));
      BOOST_TEST((surface->neighbor == network.surface.neighbor));
      BOOST_TEST((surface->weight == network.surface.weight));
    }
    BOOST_TEST((result.rest == network.rest));
    BOOST_TEST(result.source.empty());
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_straighten_borders

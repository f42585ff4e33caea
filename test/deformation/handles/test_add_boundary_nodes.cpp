// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Nodes on the borders of handles are prescribed, symmetric, and at the true border.

#include <pcs/deformation/body/octree_samples.h>
#include <pcs/deformation/handles/add_boundary_nodes.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

namespace test_handle_boundary {

namespace {

using namespace pcs::deformation;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Sequential_tag;

/// A plate with two handles at its ends, and samples.
struct Plate
{
  Points sites;
  pcs::neighborhood::Proximity_graph graph;
  std::vector<std::uint32_t> samples, sample_of_site;
  Elastic_network network;
  double weight_unit = 1;
  Node_constraints constraints;

  static Node_constraint handle_at(const Vec3& p)
  {
    return p.x() < 3.5 ? 0 : p.x() > 36.5 ? 1 : free_node;
  }

  explicit Plate(std::size_t count)
    : sites(pcs_test::in_spatial_order(pcs_test::plate(40, 20, 1))),
      graph(pcs::neighborhood::nearest_neighbor_graph<Tag>(sites, 6)),
      samples(octree_samples(sites, count))
  {
    const auto regions = grow_regions(sites, graph, samples);
    network.surface = sample_graph(sites, graph, samples, regions, weight_unit);
    sample_of_site = regions.sample_of_point;
    constraints.softness_weight = {0, 0};
    for (const auto s : samples) {
      network.rest.push_back(sites[s]);
      constraints.handle_of_node.push_back(handle_at(sites[s]));
    }
  }

  Elastic_network with_boundary(Node_constraints& extended) const
  {
    const auto handle_of_site = [&](std::size_t site) { return handle_at(sites[site]); };
    const auto position = [&](std::size_t site) { return sites[site]; };
    const auto border = Border_finder(graph).find<Tag>(graph, [&](std::size_t site) {
      return handle_of_site(site) >= 0;
    });
    return add_boundary_nodes(
        Boundary_input<decltype(handle_of_site), decltype(position)>{network,
                                                                     weight_unit,
                                                                     border,
                                                                     sample_of_site,
                                                                     handle_of_site,
                                                                     position},
        extended);
  }
};

/// Largest error of the harmonic x-coordinate at the free nodes, relative to the length.
double linear_error(const Elastic_network& network, const Node_constraints& constraints)
{
  const pcs_test::Harmonic system(network.surface, constraints);
  BOOST_REQUIRE(system.is_ok);
  using Row = Eigen::Matrix<double, 1, 1>;
  std::vector<Row> work, u(network.size(), Row::Zero());
  solve_harmonic<CGAL::Sequential_tag>(
      system.factor,
      network.surface,
      constraints,
      system.rows,
      [&](std::size_t i) { return Row(constraints.handle_of_node[i] == 0 ? 3 : 37); },
      [&](std::size_t i, const Row& value) { u[i] = value; },
      work);
  double largest = 0;
  for (const auto i : system.rows.node_of_row)
    largest = std::max(largest, std::abs(u[i][0] - network.rest[i].x()));
  return largest / 40;
}

} // namespace

BOOST_AUTO_TEST_SUITE(boundary_nodes)

BOOST_AUTO_TEST_CASE(boundary_nodes_are_points_of_their_handle_and_prescribed)
{
  const Plate plate(60);
  Node_constraints extended = plate.constraints;
  const auto network = plate.with_boundary(extended);
  BOOST_REQUIRE(network.size() > plate.network.size());
  BOOST_REQUIRE(extended.handle_of_node.size() == network.size());
  BOOST_REQUIRE(network.surface.size() == network.size());
  for (std::size_t i = plate.network.size(); i < network.size(); ++i) {
    BOOST_TEST(extended.is_prescribed(i));
    BOOST_TEST(Plate::handle_at(network.rest[i]) == extended.handle_of_node[i]);
    BOOST_TEST(network.surface.degree(i) == 1u);
  }
  for (std::size_t s = 0; s < plate.network.size(); ++s)
    BOOST_TEST((network.rest[s] == plate.network.rest[s]));
}

BOOST_AUTO_TEST_CASE(rows_increase_and_weights_are_symmetric)
{
  for (const std::size_t count : {5u, 20u, 60u, 200u}) {
    const Plate plate(count);
    Node_constraints extended = plate.constraints;
    const auto g = plate.with_boundary(extended).surface;
    for (std::size_t i = 0; i < g.size(); ++i) {
      BOOST_TEST((std::adjacent_find(g.begin(i), g.end(i), std::greater_equal<>()) == g.end(i)));
      for (std::size_t e = g.first[i]; e < g.first[i + 1]; ++e) {
        const std::uint32_t j = g.neighbor[e];
        const auto back = std::lower_bound(g.begin(j), g.end(j), static_cast<std::uint32_t>(i));
        BOOST_REQUIRE((back != g.end(j) && *back == i));
        BOOST_REQUIRE(g.weight[std::size_t(back - g.neighbor.data())] == g.weight[e]);
        BOOST_REQUIRE((g.weight[e] > 0 && std::isfinite(g.weight[e])));
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(a_linear_field_comes_out_better_than_without)
{
  const Plate plate(60);
  Node_constraints extended = plate.constraints;
  const auto network = plate.with_boundary(extended);
  const double without = linear_error(plate.network, plate.constraints);
  const double with = linear_error(network, extended);
  BOOST_TEST_MESSAGE("error of a linear field: " << without << " without, " << with << " with");
  BOOST_TEST(with < without);
  BOOST_TEST(with < 0.05);
}

BOOST_AUTO_TEST_CASE(without_handle_nothing_is_added)
{
  const Plate plate(60);
  Node_constraints extended;
  extended.handle_of_node.assign(60, free_node);
  const std::vector<Node_constraint> handles(plate.sites.size(), free_node);
  const auto none = [&](std::size_t site) { return handles[site]; };
  const auto position = [&](std::size_t site) { return plate.sites[site]; };
  const auto network =
      add_boundary_nodes(Boundary_input<decltype(none), decltype(position)>{plate.network,
                                                                            plate.weight_unit,
                                                                            {},
                                                                            plate.sample_of_site,
                                                                            none,
                                                                            position},
                         extended);
  BOOST_TEST(network.size() == 60u);
  BOOST_TEST((network.surface.neighbor == plate.network.surface.neighbor));
  BOOST_TEST((network.surface.weight == plate.network.surface.weight));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_handle_boundary

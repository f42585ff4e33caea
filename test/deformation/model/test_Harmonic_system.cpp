// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares harmonic functions with closed forms and dense algebra.

#include <pcs/deformation/model/Harmonic_system.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/LU>

#include <algorithm>

namespace test_Harmonic_system {

namespace {

using pcs::deformation::free_node;
using pcs::deformation::Node_constraints;
using pcs::deformation::unreached_node;
using pcs_test::Vec3;

std::vector<Vec3> solve(const pcs::deformation::Weighted_graph& graph,
                        const Node_constraints& constraints,
                        const std::vector<Vec3>& value_of_handle)
{
  const pcs_test::Harmonic system(graph, constraints);
  BOOST_REQUIRE(system.is_ok);
  std::vector<Vec3> work, result(graph.size(), Vec3::Zero());
  pcs::deformation::solve_harmonic<CGAL::Sequential_tag>(
      system.factor,
      graph,
      constraints,
      system.rows,
      [&](std::size_t i) {
        return value_of_handle[static_cast<std::size_t>(constraints.handle_of_node[i])];
      },
      [&](std::size_t i, const Vec3& u) { result[i] = u; },
      work);
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Harmonic_system)

BOOST_AUTO_TEST_CASE(rows_are_the_free_and_the_soft_nodes)
{
  Node_constraints c;
  c.softness_weight = {0, 2};
  c.handle_of_node = {0, free_node, 1, unreached_node, free_node};
  const pcs::deformation::Free_rows rows(c);
  BOOST_TEST((rows.node_of_row == std::vector<std::uint32_t>{1, 2, 4}));
  BOOST_TEST((c.is_prescribed(0) && !c.is_prescribed(2) && c.is_soft(2) && !c.is_soft(1)));
}

BOOST_AUTO_TEST_CASE(ranks_of_the_nodes_order_any_choice_of_rows)
{
  pcs::deformation::Elastic_network network;
  network.surface = pcs_test::path_graph(30);
  network.rest.assign(30, Vec3::Zero());
  pcs::deformation::rank_nodes(network);
  BOOST_REQUIRE(network.surface_rank.size() == 30u);
  BOOST_TEST(network.rank.empty());
  Node_constraints c;
  c.softness_weight = {0};
  c.handle_of_node.assign(32, free_node); // two nodes were added later
  c.handle_of_node[4] = 0;
  const pcs::deformation::Free_rows rows(c);
  auto rank = pcs::deformation::rank_of_rows(network.surface_rank, rows);
  BOOST_TEST(rank.size() == 31u);
  std::sort(rank.begin(), rank.end());
  BOOST_TEST((std::unique(rank.begin(), rank.end()) == rank.end()));
  BOOST_TEST(pcs::deformation::rank_of_rows({}, rows).empty());
}

BOOST_AUTO_TEST_CASE(on_a_path_the_solution_is_linear)
{
  const auto graph = pcs_test::path_graph(11);
  Node_constraints c;
  c.softness_weight = {0, 0};
  c.handle_of_node.assign(11, free_node);
  c.handle_of_node[0] = 0;
  c.handle_of_node[10] = 1;
  const Vec3 a(1, 2, 3), b(5, -2, 0);
  const auto u = solve(graph, c, {a, b});
  for (std::size_t i = 1; i < 10; ++i)
    BOOST_TEST((u[i] - (a + (b - a) * double(i) / 10)).norm() < 1e-13);
}

BOOST_AUTO_TEST_CASE(soft_handles_lie_between_free_and_exact)
{
  const auto graph = pcs_test::path_graph(11);
  double before = 0;
  for (const double weight : {1e-6, 0.1, 1.0, 10.0, 1e6}) {
    Node_constraints c;
    c.softness_weight = {0, weight};
    c.handle_of_node.assign(11, free_node);
    c.handle_of_node[0] = 0;
    c.handle_of_node[10] = 1;
    const double end = solve(graph, c, {Vec3::Zero(), Vec3::Ones()})[10].x();
    // A chain of ten unit springs in series with one of the weight, on a node of degree one.
    BOOST_TEST(end == weight / (weight + 0.1), boost::test_tools::tolerance(1e-9));
    BOOST_TEST(end > before);
    before = end;
  }
}

BOOST_AUTO_TEST_CASE(the_solution_is_that_of_the_dense_system)
{
  const auto network = pcs_test::network_of(pcs_test::random_points(150, 1));
  const auto& g = network.surface;
  std::mt19937 random(2);
  Node_constraints c;
  c.softness_weight = {0, 0, 0.5};
  for (std::size_t i = 0; i < g.size(); ++i) {
    const auto die = random() % 10;
    c.handle_of_node.push_back(die < 3 ? static_cast<int>(die) : free_node);
  }
  const std::vector<Vec3> values{Vec3(1, 0, 2), Vec3(-1, 3, 0), Vec3(4, 4, -4)};
  const auto n = static_cast<Eigen::Index>(g.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n), b = Eigen::MatrixXd::Zero(n, 3);
  for (Eigen::Index r = 0; r < n; ++r) {
    const auto i = static_cast<std::size_t>(r);
    if (c.is_prescribed(i)) {
      a(r, r) = 1;
      b.row(r) = values[static_cast<std::size_t>(c.handle_of_node[i])].transpose();
      continue;
    }
    const double degree = pcs::deformation::node_degree(g, i);
    a(r, r) = degree;
    for (std::size_t e = g.first[i]; e < g.first[i + 1]; ++e)
      a(r, static_cast<Eigen::Index>(g.neighbor[e])) -= g.weight[e];
    if (c.is_soft(i)) {
      a(r, r) += 0.5 * degree;
      b.row(r) += 0.5 * degree * values[2].transpose();
    }
  }
  const Eigen::MatrixXd expected = a.partialPivLu().solve(b);
  const auto found = solve(g, c, values);
  for (std::size_t i = 0; i < g.size(); ++i)
    if (!c.is_prescribed(i))
      BOOST_REQUIRE((found[i].transpose() - expected.row(static_cast<Eigen::Index>(i))).norm() <
                    1e-11);
}

BOOST_AUTO_TEST_CASE(values_lie_between_those_of_the_handles)
{
  const auto network = pcs_test::network_of(pcs_test::sphere(500));
  Node_constraints c;
  c.softness_weight = {0, 0};
  for (const Vec3& p : network.rest)
    c.handle_of_node.push_back(p.z() < -.8 ? 0 : p.z() > .8 ? 1 : free_node);
  const auto u = solve(network.surface, c, {Vec3(-1, 0, 0), Vec3(1, 0, 0)});
  for (std::size_t i = 0; i < u.size(); ++i)
    BOOST_REQUIRE(std::abs(u[i].x()) <= 1);
}

BOOST_AUTO_TEST_CASE(without_free_node_nothing_is_solved)
{
  const auto graph = pcs_test::path_graph(3);
  Node_constraints c;
  c.softness_weight = {0};
  c.handle_of_node.assign(3, 0);
  const auto u = solve(graph, c, {Vec3::Ones()});
  BOOST_TEST((u[1] == Vec3::Zero())); // not written
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Harmonic_system

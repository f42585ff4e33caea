// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the assembled Laplacian with a dense sum.

#include <pcs/linear_algebra/graph_laplacian.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace test_graph_laplacian {

namespace {

struct Graph
{
  std::vector<std::uint32_t> first, neighbor;
  std::vector<double> weight;
};

using Dense = Eigen::MatrixXd;

Dense random_weights(Eigen::Index n, double density, unsigned seed)
{
  std::mt19937 random(seed);
  Dense w = Dense::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (0.5 * (1 + pcs_test::uniform(random)) < density)
        w(i, j) = w(j, i) = 1.5 + pcs_test::uniform(random);
  return w;
}

Graph graph_of(const Dense& w)
{
  Graph g;
  g.first.push_back(0);
  for (Eigen::Index i = 0; i < w.rows(); ++i) {
    for (Eigen::Index j = 0; j < w.cols(); ++j)
      if (w(i, j) != 0) {
        g.neighbor.push_back(static_cast<std::uint32_t>(j));
        g.weight.push_back(w(i, j));
      }
    g.first.push_back(static_cast<std::uint32_t>(g.neighbor.size()));
  }
  return g;
}

Dense laplacian(const Dense& w)
{
  Dense l = -w;
  l.diagonal() += w.rowwise().sum();
  return l;
}

double error(const Eigen::SparseMatrix<double>& found, const Dense& full)
{
  const Dense expected = full.triangularView<Eigen::Lower>();
  return (Dense(found) - expected).norm();
}

std::vector<std::uint32_t> all_nodes(std::size_t n)
{
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < n; ++i)
    rows.push_back(static_cast<std::uint32_t>(i));
  return rows;
}

} // namespace

BOOST_AUTO_TEST_SUITE(graph_laplacian)

BOOST_AUTO_TEST_CASE(all_nodes_free_gives_the_whole_laplacian)
{
  const Dense w = random_weights(30, 0.2, 1);
  const Graph g = graph_of(w);
  const auto rows = all_nodes(30);
  const auto found = pcs::linear_algebra::free_laplacian<Graph>({&g}, rows, rows, {});
  BOOST_TEST(error(found, laplacian(w)) < 1e-12);
}

BOOST_AUTO_TEST_CASE(prescribed_nodes_are_eliminated_and_several_graphs_add_up)
{
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Eigen::Index n = 25;
    const Dense a = random_weights(n, 0.2, seed), b = random_weights(n, 0.1, seed + 100),
                c = random_weights(n, 0.5, seed + 200);
    const Graph ga = graph_of(a), gb = graph_of(b), gc = graph_of(c);
    std::mt19937 random(seed);
    std::vector<std::uint32_t> row_of_node, node_of_row;
    std::vector<double> extra;
    for (Eigen::Index i = 0; i < n; ++i)
      if (random() % 3 == 0)
        row_of_node.push_back(pcs::linear_algebra::not_free);
      else {
        row_of_node.push_back(static_cast<std::uint32_t>(node_of_row.size()));
        node_of_row.push_back(static_cast<std::uint32_t>(i));
        extra.push_back(1 + pcs_test::uniform(random));
      }
    const auto found = pcs::linear_algebra::free_laplacian<Graph>({&ga, &gb, &gc},
                                                                  row_of_node,
                                                                  node_of_row,
                                                                  extra);
    const Dense whole = laplacian(a + b + c);
    const auto m = static_cast<Eigen::Index>(node_of_row.size());
    Dense expected(m, m);
    for (Eigen::Index r = 0; r < m; ++r)
      for (Eigen::Index s = 0; s < m; ++s)
        expected(r, s) = whole(node_of_row[static_cast<std::size_t>(r)],
                               node_of_row[static_cast<std::size_t>(s)]) +
                         (r == s ? extra[static_cast<std::size_t>(r)] : 0);
    BOOST_TEST(error(found, expected) < 1e-12);
    const std::vector<double> sums =
        pcs::linear_algebra::free_row_sums<Graph>({&ga, &gb, &gc}, row_of_node, node_of_row, extra);
    const Eigen::VectorXd expected_sums = expected.rowwise().sum();
    BOOST_REQUIRE(sums.size() == node_of_row.size());
    for (Eigen::Index r = 0; r < m; ++r)
      BOOST_TEST(std::abs(sums[std::size_t(r)] - expected_sums[r]) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(no_free_node_gives_an_empty_matrix)
{
  const Graph g = graph_of(random_weights(5, 0.5, 3));
  const std::vector<std::uint32_t> none(5, pcs::linear_algebra::not_free);
  const auto found = pcs::linear_algebra::free_laplacian<Graph>({&g}, none, {}, {});
  BOOST_TEST(found.rows() == 0);
  BOOST_TEST(found.cols() == 0);
}

BOOST_AUTO_TEST_CASE(a_node_without_edges_has_only_its_extra_weight)
{
  const Graph g = graph_of(Dense::Zero(2, 2));
  const auto rows = all_nodes(2);
  const auto found = pcs::linear_algebra::free_laplacian<Graph>({&g}, rows, rows, {3, 4});
  BOOST_TEST(error(found, Eigen::Vector2d(3, 4).asDiagonal()) == 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_graph_laplacian

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Links between sheets are removed; links of volumes, lines and groups of outliers remain.

#include <pcs/neighborhood/drop_short_cuts.h>
#include <support/point_clouds.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <random>

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

BOOST_AUTO_TEST_CASE(normals_are_the_eigenvectors_of_the_moments)
{
  using namespace pcs::neighborhood::internal;
  std::mt19937 random(2);
  for (int trial = 0; trial < 500; ++trial) {
    // eight clouds, from flat ones to balls, lines and single points
    Block_moments moments;
    Eigen::Matrix3d matrix[Block_moments::size];
    for (std::size_t l = 0; l < Block_moments::size; ++l) {
      const double thickness = trial % 4 == 0 ? 0 : pcs_test::uniform(random);
      const Vec3 u = pcs_test::random_direction(random), v = pcs_test::random_vector(random);
      Ring_moments m;
      for (int p = 0; p < 20; ++p) {
        const Vec3 d = pcs_test::random_vector(random);
        Vec3 e = d - (1 - thickness) * u.dot(d) * u;
        if (trial % 10 == 9)
          e = l % 2 == 0 ? Vec3(d[0] * v) : Vec3(Vec3::Zero());
        m.add_point(scaled_edge(Vec3::Zero(), e, 1, 1));
      }
      for (std::size_t k = 0; k < 4; ++k)
        moments.sum[k][l] = m.sum[k];
      for (std::size_t k = 0; k < 3; ++k) {
        moments.squares[k][l] = m.squares[k];
        moments.products[k][l] = m.products[k];
      }
      const double xx = m.squares[0], yy = m.squares[1], zz = m.squares[2];
      const double xy = m.products[0], yz = m.products[1], zx = m.products[2];
      const Vec3 sum(m.sum[0], m.sum[1], m.sum[2]);
      matrix[l] << xx, xy, zx, xy, yy, yz, zx, yz, zz;
      matrix[l] -= sum * sum.transpose() / double(m.sum[3]);
    }
    Surface_normal found[Block_moments::size], plain[Block_moments::size];
    choose_find_normals()(moments, found);
    find_normals_plain(moments, plain);
    for (std::size_t l = 0; l < Block_moments::size; ++l) {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(matrix[l]);
      const Vec3 values = eigen.eigenvalues(), n(found[l][0], found[l][1], found[l][2]);
      const bool is_wide = values[1] > pcs::neighborhood::smallest_width * values[2];
      const double confidence =
          is_wide
              ? std::max(0.0, 1 - values[0] / (pcs::neighborhood::largest_thickness * values[1]))
              : 0;
      BOOST_TEST(std::abs(double(found[l][3]) - confidence) < 1e-5);
      if (confidence > 0.05)
        BOOST_TEST(std::abs(n.dot(eigen.eigenvectors().col(0))) > 1 - 1e-6);
      for (std::size_t k = 0; k < 4; ++k)
        BOOST_TEST(float(found[l][k]) == float(plain[l][k]));
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_drop_short_cuts

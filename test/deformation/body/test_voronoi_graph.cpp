// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Voronoi weights: linear functions are harmonic, components are preserved, edges are symmetric.

#include <pcs/deformation/body/voronoi_graph.h>
#include <support/networks.h>
#include <support/point_clouds.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace test_voronoi_graph {

namespace {

using pcs::deformation::Weighted_graph;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Sequential_tag;

Weighted_graph proximity(const Points& points)
{
  Weighted_graph graph;
  static_cast<pcs::neighborhood::Proximity_graph&>(graph) =
      pcs::neighborhood::nearest_neighbor_graph<Tag>(points, 6);
  pcs::deformation::set_edge_weights<Tag>(points, graph);
  return graph;
}

Weighted_graph weights(const Points& points)
{
  return pcs::deformation::voronoi_graph<Tag>(points, proximity(points));
}

/// Uniform random points on a square of side `size`, one per unit of area, or on a cylinder of
/// radius `radius` if this is positive.
Points random_sheet(double size, double radius = 0, unsigned seed = 1)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, size);
  Points points;
  for (double n = 0; n < size * size; n += 1) {
    const double u = uniform(random), v = uniform(random);
    points.push_back(radius > 0
                         ? Vec3(radius * std::cos(u / radius), radius * std::sin(u / radius), v)
                         : Vec3(u, v, 0));
  }
  return points;
}

/// Root mean square over inner points of `|sum w (x_j - x_i)| / sum w |x_j - x_i|`, along z or in
/// the plane.
double imbalance(const Points& points,
                 const Weighted_graph& graph,
                 double margin,
                 double size,
                 bool is_flat)
{
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    const auto is_inner = [&](double x) { return x > margin && x < size - margin; };
    if (!is_inner(is_flat ? p.y() : p.z()) || (is_flat && !is_inner(p.x())))
      continue;
    Vec3 total = Vec3::Zero();
    double length = 0;
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const Vec3 edge = points[graph.neighbor[e]] - p;
      total += graph.weight[e] * (is_flat ? edge : Vec3(0, 0, edge.z()));
      length += graph.weight[e] * (is_flat ? edge.norm() : std::abs(edge.z()));
    }
    sum += (total / length).squaredNorm();
    count += 1;
  }
  return std::sqrt(sum / count);
}

/// Checks the weights of both half-edges of all edges, and their mean.
void check_halves(const Points& points)
{
  const Weighted_graph graph = weights(points);
  double sum = 0;
  for (std::uint32_t i = 0; i < graph.size(); ++i)
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::uint32_t j = graph.neighbor[e];
      BOOST_TEST_REQUIRE(j != i);
      const auto back = std::lower_bound(graph.begin(j), graph.end(j), i);
      BOOST_TEST_REQUIRE((back != graph.end(j) && *back == i));
      BOOST_TEST_REQUIRE(graph.weight[std::size_t(back - graph.neighbor.data())] ==
                         graph.weight[e]);
      BOOST_TEST_REQUIRE((graph.weight[e] > 0 && std::isfinite(graph.weight[e])));
      sum += graph.weight[e];
    }
  BOOST_TEST(std::abs(sum / double(graph.size()) - pcs::deformation::mean_degree) < 1e-9);
}

} // namespace

BOOST_AUTO_TEST_SUITE(voronoi_graph)

BOOST_AUTO_TEST_CASE(linear_functions_are_harmonic)
{
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Points flat = random_sheet(40, 0, seed);
    const Weighted_graph near = proximity(flat);
    const double before = imbalance(flat, near, 4, 40, true);
    const double now = imbalance(flat, weights(flat), 4, 40, true);
    BOOST_TEST_MESSAGE("imbalance " << before << " -> " << now);
    BOOST_TEST(before > 0.2);
    BOOST_TEST(now < 0.04);
  }
}

BOOST_AUTO_TEST_CASE(a_grid_has_the_four_point_stencil)
{
  Points points;
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y)
      points.emplace_back(x, y, 0);
  const Weighted_graph graph = weights(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].x() < 2 || points[i].x() > 17 || points[i].y() < 2 || points[i].y() > 17)
      continue;
    BOOST_TEST(graph.degree(i) == 4u);
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
      BOOST_TEST(std::abs(graph.weight[e] / graph.weight[graph.first[i]] - 1) < 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(curved_sheets_are_nearly_as_good)
{
  const double size = 40, radius = size / (2 * std::acos(-1.0));
  const Points points = random_sheet(size, radius);
  const Weighted_graph near = proximity(points);
  const double before = imbalance(points, near, 4, size, false);
  const double now = imbalance(points, weights(points), 4, size, false);
  BOOST_TEST_MESSAGE("imbalance " << before << " -> " << now);
  BOOST_TEST(now < 0.3 * before);
}

BOOST_AUTO_TEST_CASE(components_stay)
{
  // Two sheets, a wire, a pair of points, and a wire of points at halving distances.
  Points points = random_sheet(15);
  for (const Vec3& p : random_sheet(15, 0, 7))
    points.push_back(p + Vec3(0, 0, 100));
  for (int k = 0; k < 30; ++k)
    points.emplace_back(200 + k, 0, 0);
  points.emplace_back(0, 500, 0);
  points.emplace_back(0, 501, 0);
  for (int k = 0; k < 60; ++k)
    points.emplace_back(-1000 - std::ldexp(1.0, -k), 0, 0);
  const Weighted_graph near = proximity(points), graph = weights(points);
  std::size_t before = 0, now = 0;
  const auto old_component = pcs::neighborhood::connected_components(near, before);
  const auto component = pcs::neighborhood::connected_components(graph, now);
  BOOST_TEST(before == now);
  BOOST_TEST(old_component == component, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(halves_of_an_edge_agree)
{
  check_halves(random_sheet(20));
}

BOOST_AUTO_TEST_CASE(halves_of_an_edge_agree_in_long_and_thin_cells)
{
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const int size : {2, 3, 4, 6})
      check_halves(pcs_test::small_groups(size, 1e6, seed));
}

BOOST_AUTO_TEST_CASE(gaps_are_not_bridged)
{
  // A sheet with a slit, joined at one end. No link crosses the slit far from that end.
  Points points;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  for (int x = 0; x < 30; ++x)
    for (int y = 0; y < 21; ++y)
      if (x < 5 || std::abs(y - 10) > 2) // the slit is six spacings wide
        points.emplace_back(x + jitter(random), y + jitter(random), 0);
  const Weighted_graph graph = weights(points);
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      BOOST_TEST((std::min(points[i].x(), points[*j].x()) < 6.5 ||
                  (points[i].y() > 10) == (points[*j].y() > 10)));
}

BOOST_AUTO_TEST_CASE(threads_do_not_matter)
{
  const Points points = random_sheet(60);
  const Weighted_graph near = proximity(points);
  const Weighted_graph one = weights(points);
  for (const int count : pcs_test::thread_counts)
    pcs_test::with_threads(count, [&] {
      const Weighted_graph other =
          pcs::deformation::voronoi_graph<CGAL::Parallel_if_available_tag>(points, near);
      BOOST_TEST((one.first == other.first && one.neighbor == other.neighbor &&
                  one.weight == other.weight));
    });
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_voronoi_graph

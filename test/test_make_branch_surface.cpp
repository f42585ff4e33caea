// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// make_branch_surface(): closed, outward, of the volume of the wood.

#include <pcs/make_branch_surface.h>
#include <support/tree_clouds.h>

#include <CGAL/determinant.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>
#include <vector>

using pcs_test::small_scan;
using pcs_test::Tree;
using Kernel = pcs_test::Tree_kernel;
using Point = pcs_test::Tree_point;

BOOST_AUTO_TEST_SUITE(make_branch_surface)

namespace {

/// Every edge once in each direction.
void check_is_closed(const std::vector<std::array<std::size_t, 3>>& triangles)
{
  std::map<std::pair<std::size_t, std::size_t>, int> edges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[{t[k], t[(k + 1) % 3]}];
  std::size_t wrong = 0;
  for (const auto& [edge, count] : edges)
    wrong += count != 1 || edges.count({edge.second, edge.first}) == 0;
  BOOST_CHECK_EQUAL(wrong, 0u);
}

double volume_of(const std::vector<Point>& points,
                 const std::vector<std::array<std::size_t, 3>>& triangles)
{
  double sum = 0;
  for (const auto& t : triangles)
    sum += CGAL::determinant(points[t[0]] - CGAL::ORIGIN,
                             points[t[1]] - CGAL::ORIGIN,
                             points[t[2]] - CGAL::ORIGIN);
  return sum / 6;
}

} // namespace

BOOST_AUTO_TEST_CASE(the_surface_is_closed_and_has_the_volume_of_the_wood)
{
  const Tree& tree = small_scan().truth;
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto report = pcs::make_branch_surface(tree, points, triangles);
  BOOST_CHECK_GT(report.number_of_joined, 50u);
  check_is_closed(triangles);
  double wood = 0;
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const auto& a = tree[source(e, tree)];
    const auto& b = tree[target(e, tree)];
    if (a.branch == b.branch)
      wood += CGAL_PI / 3 * std::sqrt((a.point - b.point).squared_length()) *
              (a.radius * a.radius + a.radius * b.radius + b.radius * b.radius);
  }
  BOOST_CHECK_CLOSE(volume_of(points, triangles), wood, 10.0);
}

BOOST_AUTO_TEST_CASE(a_coarser_surface_has_fewer_triangles)
{
  const Tree& tree = small_scan().truth;
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const double tolerance : {0.0005, 0.002, 0.01}) {
    std::vector<Point> points;
    std::vector<std::array<std::size_t, 3>> triangles;
    pcs::make_branch_surface(tree, points, triangles, pcs::parameters::tolerance(tolerance));
    check_is_closed(triangles);
    BOOST_CHECK_LT(triangles.size(), last);
    last = triangles.size();
  }
}

BOOST_AUTO_TEST_CASE(branches_may_be_tubes_of_their_own)
{
  const Tree& tree = small_scan().truth;
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto report =
      pcs::make_branch_surface(tree, points, triangles, pcs::parameters::do_join(false));
  BOOST_CHECK_EQUAL(report.number_of_joined, 0u);
  check_is_closed(triangles);
}

BOOST_AUTO_TEST_CASE(an_empty_tree_has_no_surface)
{
  std::vector<Point> points(3);
  std::vector<std::array<std::size_t, 3>> triangles(1);
  pcs::make_branch_surface(Tree(), points, triangles);
  BOOST_CHECK(points.empty() && triangles.empty());
}

BOOST_AUTO_TEST_SUITE_END()

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Branch surfaces are closed, oriented outward, and have the volume of the wood.

#include <pcs/core/Tree_measures.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/tree_fixtures.h>
#include <pcs/make_branch_surface.h>
#include <pcs/make_leaf_surface.h>
#include <support/tree_clouds.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/determinant.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace test_make_branch_surface {

using pcs_test::small_scan;
using pcs_test::Tree;
using Kernel = pcs_test::Tree_kernel;
using Point = pcs_test::Tree_point;

BOOST_AUTO_TEST_SUITE(make_branch_surface)

namespace {

/// Checks that every edge exists once in each direction.
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

namespace {

using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact_tree = pcs::Tree_skeleton<Exact>;
namespace PMP = CGAL::Polygon_mesh_processing;

struct Judged_surface
{
  pcs::Branch_surface_report report;
  double volume = 0, crossing_share = 0; ///< fraction of triangles that intersect others
};

/// Checks that a surface bounds a volume, is oriented outward, and is a manifold.
Judged_surface judge(const Exact_tree& tree)
{
  std::vector<Exact::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  Judged_surface result;
  result.report = pcs::make_branch_surface(tree, points, triangles);
  BOOST_REQUIRE(PMP::is_polygon_soup_a_polygon_mesh(triangles));
  CGAL::Surface_mesh<Exact::Point_3> mesh;
  PMP::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  BOOST_REQUIRE(CGAL::is_closed(mesh));
  BOOST_TEST(PMP::is_outward_oriented(mesh));
  result.volume = PMP::volume(mesh);
  using Face = boost::graph_traits<CGAL::Surface_mesh<Exact::Point_3>>::face_descriptor;
  std::vector<std::pair<Face, Face>> pairs;
  PMP::self_intersections(mesh, std::back_inserter(pairs));
  std::set<Face> faces;
  for (const auto& [a, b] : pairs) {
    faces.insert(a);
    faces.insert(b);
  }
  result.crossing_share = double(faces.size()) / double(triangles.size());
  return result;
}

} // namespace

BOOST_AUTO_TEST_CASE(single_branches_do_not_run_through_themselves)
{
  for (const Exact_tree& tree : {pcs::make_cone_tree<Exact>(2, 0.1, 0.02),
                                 pcs::make_torus_arc_tree<Exact>(1, 0.1, 2),
                                 pcs::make_oblique_ellipse_tree<Exact>(2, 0.1, 0.5, 0.7)}) {
    const Judged_surface surface = judge(tree);
    const std::size_t branches = tree[boost::graph_bundle].branches.size();
    BOOST_TEST(surface.crossing_share == 0);
    BOOST_TEST(surface.report.number_of_joined == branches - 1);
    BOOST_CHECK_CLOSE(surface.volume, pcs::measure_tree(tree).union_volume, 4.0);
  }
}

// Stems with a kink at the fork and branches as thick as their parents are solid. Rings near a kink
// intersect each other, and necks are narrower than the wood.
BOOST_AUTO_TEST_CASE(forks_are_one_solid)
{
  for (const Exact_tree& tree : {pcs::make_fork_tree<Exact>(1, 0.1, 0.04, 1.0),
                                 pcs::make_fork_tree<Exact>(1, 0.1, 0.08, 1.2),
                                 pcs::make_fork_tree<Exact>(1, 0.1, 0.1, 1.4),
                                 pcs::make_parallel_twigs_tree<Exact>(1, 0.02, 0.06),
                                 pcs::make_crossing_branches_tree<Exact>(1, 0.02, 0.01)}) {
    const Judged_surface surface = judge(tree);
    BOOST_TEST(surface.crossing_share < 0.2);
    BOOST_TEST(surface.report.number_of_joined == tree[boost::graph_bundle].branches.size() - 1);
    BOOST_CHECK_CLOSE(surface.volume, pcs::measure_tree(tree).union_volume, 14.0);
  }
}

BOOST_AUTO_TEST_CASE(grown_trees_are_one_solid)
{
  for (const auto& [name, habit] : pcs::tree_habits()) {
    if (name == "conifer") // 20 m: takes too long
      continue;
    Exact_tree tree;
    pcs::grow_tree(tree, habit, pcs::parameters::random_seed(3));
    const Judged_surface surface = judge(tree);
    BOOST_TEST_CONTEXT(name)
    {
      BOOST_TEST(surface.crossing_share < 0.06); // crowns intersect themselves
      BOOST_CHECK_CLOSE(surface.volume, pcs::measure_tree(tree).union_volume, 4.0);
      BOOST_TEST(double(surface.report.number_of_separate) <
                 0.03 * double(surface.report.number_of_joined));
    }
  }
}

BOOST_AUTO_TEST_CASE(a_surface_mesh_takes_the_surface)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(3));
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  pcs::make_branch_surface(tree, points, triangles, pcs::parameters::tolerance(0.01));
  using Other_kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Surface_mesh<Other_kernel::Point_3> mesh;
  mesh.add_vertex(Other_kernel::Point_3(9, 9, 9)); // remains
  const auto report = pcs::make_branch_surface(tree, mesh, pcs::parameters::tolerance(0.01));
  BOOST_TEST(report.number_of_triangles == triangles.size());
  BOOST_TEST(mesh.number_of_faces() == triangles.size());
  BOOST_TEST(mesh.number_of_vertices() == points.size() + 1);
  BOOST_TEST(mesh.is_valid());
  BOOST_TEST(CGAL::is_closed(mesh));
  BOOST_CHECK_CLOSE(CGAL::Polygon_mesh_processing::volume(mesh),
                    volume_of(points, triangles),
                    1e-6);
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

// The quad of the post at the base of a twig is thousands of times as long as the twig is wide.
BOOST_AUTO_TEST_CASE(hair_on_a_thick_post_is_sewn_in)
{
  for (int k = 0; k < 24; ++k) {
    const double a = 0.26 * k, rise = 0.1 * (k % 7), r = 3e-4;
    Tree tree(4);
    tree[0].point = Point(0, 0, 0);
    tree[1].point = Point(0, 0, 10);
    tree[2].point = Point(0, 0, 3 + 0.1 * k);
    tree[3].point = tree[2].point + pcs_test::Tree_vector(std::cos(a), std::sin(a), rise);
    for (std::size_t v = 0; v < 4; ++v) {
      tree[v].radius = v < 2 ? 0.15 : r;
      tree[v].branch = v / 2;
    }
    add_edge(0, 1, tree);
    add_edge(0, 2, tree);
    add_edge(2, 3, tree);
    tree[boost::graph_bundle].root = 0;
    tree[boost::graph_bundle].branches = {{pcs::npos, 0, 0}, {0, 1, 1}};
    for (const double tolerance : {0.15, 0.015, 0.0015}) {
      std::vector<Point> points;
      std::vector<std::array<std::size_t, 3>> triangles;
      const auto report =
          pcs::make_branch_surface(tree, points, triangles, pcs::parameters::tolerance(tolerance));
      BOOST_CHECK_EQUAL(report.number_of_joined, 1u);
      check_is_closed(triangles);
    }
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

BOOST_AUTO_TEST_CASE(leaves_begin_on_the_bark)
{
  // A thin branch along z, whose root is not the first vertex.
  Tree tree;
  for (const double z : {0.5, 1.0, 0.0}) {
    const auto v = add_vertex(tree);
    tree[v].point = Point(0, 0, z);
    tree[v].radius = 0.1;
    tree[v].branch = 0;
  }
  add_edge(2, 0, tree);
  add_edge(0, 1, tree);
  tree[boost::graph_bundle].root = 2;
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  const std::size_t count = pcs::make_leaf_surface(tree, points, triangles);
  BOOST_TEST_REQUIRE(count > 0u);
  const double length = pcs::default_leaf_share * 1.0; // the farthest node is 1 from the root
  for (std::size_t k = 0; k < count; ++k) {
    const Point& base = points[4 * k];
    BOOST_CHECK_CLOSE(std::hypot(base.x(), base.y()), 0.1, 1e-6);
    BOOST_CHECK_CLOSE(CGAL::squared_distance(points[4 * k + 2], base), length * length, 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(leaves_grow_on_fine_branches)
{
  const Tree& tree = small_scan().truth;
  std::vector<Point> points, others;
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto np =
      pcs::parameters::leaf_length(0.05).leaves_per_length(10.0).leaf_branch_radius(0.004);
  const std::size_t count = pcs::make_leaf_surface(tree, points, triangles, np);
  double fine = 0;
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const auto &a = tree[source(e, tree)], &b = tree[target(e, tree)];
    if (a.branch == b.branch && b.radius <= 0.004)
      fine += std::sqrt((a.point - b.point).squared_length());
  }
  BOOST_CHECK_CLOSE(double(count), 10 * fine, 10.0);
  BOOST_TEST(points.size() == 4 * count);
  BOOST_TEST(triangles.size() == 2 * count);
  for (std::size_t k = 0; k < count; ++k)
    BOOST_CHECK_CLOSE((points[4 * k + 2] - points[4 * k]).squared_length(), 0.05 * 0.05, 1e-6);
  pcs::make_leaf_surface(tree, others, triangles, np);
  BOOST_TEST((others == points)); // equal seeds
  pcs::make_leaf_surface(tree, others, triangles, np.random_seed(4));
  BOOST_TEST((others != points));
  BOOST_TEST(pcs::make_leaf_surface(Tree(), others, triangles) == 0u);
  BOOST_CHECK_THROW(
      pcs::make_leaf_surface(tree, others, triangles, pcs::parameters::leaf_length(0.0)),
      pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(an_empty_tree_has_no_surface)
{
  std::vector<Point> points(3);
  std::vector<std::array<std::size_t, 3>> triangles(1);
  pcs::make_branch_surface(Tree(), points, triangles);
  BOOST_CHECK(points.empty() && triangles.empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_make_branch_surface

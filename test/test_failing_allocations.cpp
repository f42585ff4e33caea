// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// If an allocation fails, std::bad_alloc reaches the caller, outputs are as before, and the next
// call gives the same result as ever. Sequential, since oneTBB does not survive such failures.

#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/crowns/measure_crown.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/make_branch_surface.h>
#include <pcs/registration/fit_point_set.h>
#include <pcs/segment_trees.h>
#include <support/allocations.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/tags.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <new>
#include <numeric>
#include <string>
#include <unistd.h>
#include <vector>

namespace test_failing_allocations {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Points = std::vector<Point>;
using Tree = pcs::Tree_skeleton<Kernel>;

/// A tube along a line, its points on a spiral.
void add_tube(const Point& a, const Point& b, double radius, std::size_t count, Points& points)
{
  const Kernel::Vector_3 d = b - a, e(d.z(), 0, -d.x());
  const Kernel::Vector_3 across = e / std::sqrt(e.squared_length());
  Kernel::Vector_3 third = CGAL::cross_product(d, across);
  third = third / std::sqrt(third.squared_length());
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.39996 * double(i);
    points.push_back(a + double(i) / double(count) * d +
                     radius * (std::cos(angle) * across + std::sin(angle) * third));
  }
}

/// A trunk with a branch, 600 points.
Points small_tree(double x = 0)
{
  Points points;
  add_tube(Point(x, 0, 0), Point(x, 0, 4), 0.1, 400, points);
  add_tube(Point(x, 0, 2), Point(x + 1, 0, 3), 0.05, 200, points);
  return points;
}

Tree small_skeleton(double length)
{
  Tree tree(4);
  const std::array<Point, 4> places{Point(0, 0, 0),
                                    Point(0, 0, 1),
                                    Point(0, 0, 2),
                                    Point(length, 0, 1.5)};
  for (std::size_t i = 0; i < 4; ++i) {
    tree[i].point = places[i];
    tree[i].radius = 0.1 / double(i + 1);
  }
  add_edge(0, 1, tree);
  add_edge(1, 2, tree);
  add_edge(1, 3, tree);
  return tree;
}

/*!
  Calls `work()` while one allocation fails: each of the first 200, then every `step`-th one, at
  least 10 of them. `is_untouched()` must hold after each failure; `is_right()` after a call that
  needs no more than it gets. Returns the number of failures.
*/
template <class Work, class Is_untouched, class Is_right>
int fail_everywhere(long step,
                    const Work& work,
                    const Is_untouched& is_untouched,
                    const Is_right& is_right)
{
  int failures = 0;
  for (long i = 0;; i += i < 200 ? 1 : step) {
    pcs_test::has_failed = false;
    pcs_test::allocations_left = i;
    bool has_thrown = false;
    try {
      work();
    } catch (const std::bad_alloc&) {
      has_thrown = true;
    }
    pcs_test::allocations_left = -1;
    if (has_thrown)
      BOOST_REQUIRE(is_untouched());
    else
      BOOST_REQUIRE(is_right());
    if (!pcs_test::has_failed)
      return failures;
    ++failures;
  }
}

std::size_t size_of(const Tree& tree)
{
  return num_vertices(tree);
}

} // namespace

BOOST_AUTO_TEST_SUITE(failing_allocations)

BOOST_AUTO_TEST_CASE(a_skeleton_is_complete_or_empty_or_as_before)
{
  const Points points = small_tree();
  const auto extract = [&](Tree& tree) {
    pcs::extract_tree_skeleton<CGAL::Sequential_tag>(points,
                                                     tree,
                                                     pcs::parameters::number_of_resamples(0));
  };
  Tree expected, tree(1);
  extract(expected);
  BOOST_TEST_REQUIRE(size_of(expected) > 3u);
  const int failures = fail_everywhere(
      50,
      [&] {
        tree = Tree(1);
        extract(tree);
      },
      [&] { return size_of(tree) <= 1 || size_of(tree) == size_of(expected); },
      [&] { return size_of(tree) == size_of(expected); });
  BOOST_TEST_MESSAGE(failures << " failures");
  BOOST_TEST(failures > 200);
}

BOOST_AUTO_TEST_CASE(labels_of_a_stand_are_complete_or_as_before)
{
  Points points = small_tree();
  const Points other = small_tree(5);
  points.insert(points.end(), other.begin(), other.end());
  std::vector<std::size_t> indices(points.size()), trees(points.size());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  const boost::typed_identity_property_map<std::size_t> identity;
  const auto segment = [&] {
    trees.assign(points.size(), 7); // without an allocation
    pcs::segment_trees<CGAL::Sequential_tag>(
        indices,
        boost::make_iterator_property_map(trees.begin(), identity),
        pcs::parameters::point_map(boost::make_iterator_property_map(points.begin(), identity)));
  };
  segment();
  const std::vector<std::size_t> expected = trees, before(points.size(), 7);
  BOOST_TEST_REQUIRE((expected != before));
  const int failures = fail_everywhere(
      200,
      segment,
      [&] { return trees == before; },
      [&] { return trees == expected; });
  BOOST_TEST_MESSAGE(failures << " failures");
  BOOST_TEST(failures > 200);
}

BOOST_AUTO_TEST_CASE(a_surface_is_complete_or_none)
{
  Tree tree;
  pcs::extract_tree_skeleton<CGAL::Sequential_tag>(small_tree(),
                                                   tree,
                                                   pcs::parameters::number_of_resamples(0));
  Points vertices;
  std::vector<std::array<std::size_t, 3>> triangles;
  pcs::make_branch_surface(tree, vertices, triangles);
  const std::size_t expected = triangles.size();
  BOOST_TEST_REQUIRE(expected > 10u);
  const int failures = fail_everywhere(
      50,
      [&] {
        vertices = Points();
        triangles.clear();
        pcs::make_branch_surface(tree, vertices, triangles);
      },
      [] { return true; }, // the next call is right
      [&] { return triangles.size() == expected; });
  BOOST_TEST(failures > 50);
}

BOOST_AUTO_TEST_CASE(a_space_is_built_or_throws)
{
  const Tree first = small_skeleton(1), second = small_skeleton(2);
  double distance = 0;
  const auto build = [&] {
    distance = -1;
    pcs::Orl_shape_space<Kernel, CGAL::Sequential_tag> space;
    const auto a = space.add_skeleton(first), b = space.add_skeleton(second);
    space.build();
    distance = space.distance(a, b);
  };
  build();
  const double expected = distance;
  BOOST_TEST_REQUIRE(expected > 0);
  const int failures = fail_everywhere(
      50,
      build,
      [&] { return distance == -1; },
      [&] { return distance == expected; });
  BOOST_TEST_MESSAGE(failures << " failures");
  BOOST_TEST(failures > 200);
}

BOOST_AUTO_TEST_CASE(a_fit_is_complete_or_leaves_the_points)
{
  const Points rest = small_tree();
  Points target;
  for (const Point& p : rest)
    target.emplace_back(p.x() + 0.02 * p.z() * p.z(), p.y(), p.z());
  Points points = rest;
  const auto fit = [&] {
    points.assign(rest.begin(), rest.end());
    pcs::fit_point_set<CGAL::Sequential_tag>(points, target);
  };
  fit();
  const Points expected = points;
  BOOST_TEST_REQUIRE((expected != rest));
  const int failures = fail_everywhere(
      5000,
      fit,
      [&] { return points == rest; },
      [&] { return points == expected; });
  BOOST_TEST_MESSAGE(failures << " failures");
  BOOST_TEST(failures > 200);
}

BOOST_AUTO_TEST_CASE(a_crown_is_measured_or_throws)
{
  const Points points = small_tree();
  double volume = 0;
  const auto measure = [&] {
    volume = -1;
    volume = pcs::crowns::measure_crown(points, 0.5).volume;
  };
  measure();
  const double expected = volume;
  BOOST_TEST_REQUIRE(expected > 0);
  fail_everywhere(
      50,
      measure,
      [&] { return volume == -1; },
      [&] { return volume == expected; });
}

BOOST_AUTO_TEST_CASE(a_file_is_complete_or_as_before)
{
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("pcs_allocations_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const char* name : {"a.ply", "a.las", "a.csv", "a.obj"}) {
    const std::string path = (folder / name).string();
    const Points points = small_tree();
    const Points one{Point(1, 2, 3)};
    Points read;
    const auto number = [&] { return pcs::IO::read_points(path).number_of_points(); };
    pcs::IO::write_points(path, one);
    fail_everywhere(
        50,
        [&] { pcs::IO::write_points(path, points); },
        [&] { return number() == 1; },
        [&] {
          const bool is_complete = number() == points.size();
          pcs::IO::write_points(path, one);
          return is_complete;
        });
    std::size_t found = 0;
    fail_everywhere(
        50,
        [&] {
          found = 0;
          found = number();
        },
        [&] { return found == 0; },
        [&] { return found == 1; });
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      files += entry.exists();
    BOOST_TEST(files == 1u, name << ": a file was left behind");
    std::filesystem::remove(path);
  }
  std::filesystem::remove_all(folder);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_failing_allocations

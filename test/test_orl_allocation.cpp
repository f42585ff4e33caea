// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Repeated evaluation of a tree of the space and its points does not allocate memory.

#include <pcs/Orl_shape_space.h>
#include <support/allocations.h>
#include <support/orl_trees.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <vector>

BOOST_AUTO_TEST_SUITE(orl_allocation)

BOOST_AUTO_TEST_CASE(trees_and_points_are_written_without_allocation)
{
  using namespace orl_test;
  const Tree a = random_tree(41), b = random_tree(42);
  // Sequential, since a thread scheduler allocates memory as well.
  pcs::Orl_shape_space<Kernel, CGAL::Sequential_tag> space;
  space.add(a, tube_points(a, 5000, 1));
  space.add(b, tube_points(b, 7000, 2));
  space.build();
  pcs::Orl_tree tree;
  std::vector<Point> points;
  points.reserve(space.geodesic(0, 1, 0.5).number_of_points()); // the ends have fewer points
  space.geodesic(0, 1, 1.5, tree);                              // also beyond the ends
  const auto in_order = pcs::parameters::branch_emergence(pcs::Branch_emergence::sequential);
  space.geodesic(0, 1, 0.5, tree, in_order);
  space.points(tree, points);
  const long before = pcs_test::number_of_allocations;
  BOOST_TEST(before > 0); // allocations are counted
  for (const double lambda : {0.25, 0., -0.5, 0.75, 1., 1.5, 0.5}) {
    space.geodesic(0, 1, lambda, tree, in_order);
    space.geodesic(0, 1, lambda, tree);
    space.points(tree, points);
  }
  const long after = pcs_test::number_of_allocations;
  BOOST_TEST(after == before);
  BOOST_TEST(points.size() == tree.number_of_points());
}

BOOST_AUTO_TEST_SUITE_END()

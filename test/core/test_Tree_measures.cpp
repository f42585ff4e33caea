// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of length and volume.

#include <pcs/core/Tree_measures.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace test_Tree_measures {

using Kernel = CGAL::Simple_cartesian<double>;

namespace {

constexpr double pi = 3.14159265358979323846;

} // namespace

BOOST_AUTO_TEST_SUITE(Tree_measures, *boost::unit_test::tolerance(1e-12))

BOOST_AUTO_TEST_CASE(a_cone_has_the_volume_of_a_cone)
{
  const auto m = pcs::measure_tree(
      pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.3}, {0, 0, 0, 0, 2, 0}}));
  BOOST_TEST(m.length == 2.0);
  BOOST_TEST(m.volume == pi * 0.09 * 2 / 3);
  BOOST_TEST(m.union_volume == m.volume);
}

BOOST_AUTO_TEST_CASE(the_base_of_a_branch_inside_its_parent_counts_once)
{
  // A branch perpendicular to a trunk of radius 0.25: a quarter of its length is inside.
  const auto m = pcs::measure_tree(pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.25},
                                                                {0, 0, 0, 0, 1, 0.25},
                                                                {1, 0, 0, 0, 2, 0.25},
                                                                {1, 1, 0, 0, 1, 0.1},
                                                                {3, 1, 1, 0, 1, 0.1}}));
  BOOST_TEST(m.length == 3.0);
  BOOST_TEST(m.volume == pi * (0.0625 * 2 + 0.01));
  BOOST_TEST(m.union_volume == pi * (0.0625 * 2 + 0.01 * 0.75));
}

BOOST_AUTO_TEST_CASE(the_edge_to_a_branch_has_the_radius_of_the_branch)
{
  // Without a separate node at the joint.
  const auto m = pcs::measure_tree(pcs_test::make_tree<Kernel>(
      {{pcs::npos, 0, 0, 0, 0, 0.25}, {0, 0, 0, 0, 1, 0.25}, {0, 1, 1, 0, 0, 0.1}}));
  BOOST_TEST(m.volume == pi * (0.0625 + 0.01));
  BOOST_TEST(m.union_volume == pi * (0.0625 + 0.0075));
}

BOOST_AUTO_TEST_CASE(a_slanted_branch_leaves_its_parent_at_the_surface)
{
  // A branch at 45 degrees leaves the axis u of a trunk of radius 0.5 after 0.71, hence 3 of the 16
  // pieces of its length 4 are inside; u = (2, 3, 6) / 7, and w = (3, -6, 2) / 7 is normal to it.
  const double f = 4 / (7 * std::sqrt(2.0)), x = 5 * f, y = -3 * f, z = 8 * f;
  const auto m = pcs::measure_tree(pcs_test::make_tree<Kernel>({{pcs::npos, 0, 1, 2, 3, 0.5},
                                                                {0, 0, 3, 5, 9, 0.5},
                                                                {1, 0, 5, 8, 15, 0.5},
                                                                {1, 1, 3, 5, 9, 0.1},
                                                                {3, 1, 3 + x, 5 + y, 9 + z, 0.1}}));
  BOOST_TEST(m.length == 18.0);
  BOOST_TEST(m.union_volume == pi * (0.25 * 14 + 0.01 * 3.25));
}

BOOST_AUTO_TEST_CASE(nothing_measures_nothing)
{
  const auto m = pcs::measure_tree(pcs::Tree_skeleton<Kernel>());
  BOOST_TEST(m.length == 0.0);
  BOOST_TEST(m.union_volume == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Tree_measures

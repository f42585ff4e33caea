// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeletons of trees of a space: absent branches, and parts of branches without length.

#include <pcs/shape_space/input/write_skeleton.h>
#include <support/layouts.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_write_skeleton {

using namespace pcs::shape_space;

namespace {

using Tree = pcs::Tree_skeleton<CGAL::Simple_cartesian<double>>;

/// A trunk of two edges; a branch of three edges on it; a twig of one edge on the branch.
const Orl_layout layout = orl_test::layout_of({{none, 2, none}, {0, 3, 0}, {1, 1, 2}});

/// The tree whose edges have these lengths. Edges without length have the radius 0.
Orl_coordinates tree_of(const std::vector<double>& lengths)
{
  Orl_coordinates x = orl_test::upright_tree(layout);
  x.length = lengths;
  for (std::size_t e = 0; e < lengths.size(); ++e)
    x.radius[e] = lengths[e] > 0 ? 0.01 * static_cast<double>(e + 1) : 0;
  x.base_radius = {0.2, 0.1, 0.05};
  x.attachment = {0, 1, 2};
  return x;
}

Tree written(const Orl_coordinates& x, bool do_keep)
{
  Orl_geometry geometry;
  build_geometry(layout, x, pcs::Orl_orientation::gauge_fixed, geometry);
  Tree tree;
  write_skeleton(layout,
                 x,
                 geometry,
                 Vec3::Zero(),
                 do_keep ? -1 : pcs::shape_space::internal::least_length(geometry),
                 tree);
  return tree;
}

/// Number of edges without length, except those to the first node of a branch.
std::size_t number_of_joints(const Tree& tree)
{
  std::size_t n = 0;
  for (const auto e : boost::make_iterator_range(edges(tree)))
    n += tree[source(e, tree)].branch == tree[target(e, tree)].branch &&
                 tree[source(e, tree)].point == tree[target(e, tree)].point
             ? 1
             : 0;
  return n;
}

std::size_t number_without_radius(const Tree& tree)
{
  std::size_t n = 0;
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    n += tree[v].radius > 0 ? 0 : 1;
  return n;
}

} // namespace

BOOST_AUTO_TEST_SUITE(written_skeletons)

BOOST_AUTO_TEST_CASE(parts_of_a_branch_without_length_have_no_nodes)
{
  const Orl_coordinates x = tree_of({1, 1, 0, 0.5, 0, 0.25});
  const Tree tree = written(x, false);
  // trunk 3, branch 2, twig 2
  BOOST_TEST(num_vertices(tree) == 7u);
  BOOST_TEST(number_of_joints(tree) == 0u);
  BOOST_TEST(number_without_radius(tree) == 0u);
  BOOST_TEST(tree[boost::graph_bundle].branches.size() == 3u);
  // the twig is on the node of the branch at which its second edge ends
  double top = 0;
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    top = std::max(top, tree[v].point.z());
  BOOST_TEST(std::abs(top - 2) < 1e-12);
  for (const auto e : boost::make_iterator_range(edges(tree)))
    if (tree[target(e, tree)].branch == 2 && tree[source(e, tree)].branch == 1) {
      BOOST_TEST(std::abs(tree[source(e, tree)].point.z() - 1.5) < 1e-12);
      BOOST_TEST(tree[target(e, tree)].radius == 0.05);
    }

  // on request, all nodes are written
  const Tree all = written(x, true);
  BOOST_TEST(num_vertices(all) == 9u);
  BOOST_TEST(number_of_joints(all) == 2u);
  BOOST_TEST(number_without_radius(all) == 2u);
}

BOOST_AUTO_TEST_CASE(absent_branches_are_left_out_with_their_twigs)
{
  for (const double length : {0.0, 1e-11}) {
    const Orl_coordinates x = tree_of({1, 1, length, length, length, 0.25});
    const Tree tree = written(x, false);
    BOOST_TEST(num_vertices(tree) == 3u);
    BOOST_TEST(tree[boost::graph_bundle].branches.size() == 1u);
    const Tree all = written(x, true);
    BOOST_TEST(num_vertices(all) == 9u);
    BOOST_TEST(all[boost::graph_bundle].branches.size() == 3u);
    BOOST_TEST(all[boost::graph_bundle].branches[2].order == 2);
  }
  // short branches are present
  BOOST_TEST(num_vertices(written(tree_of({1, 1, 1e-6, 1e-6, 1e-6, 0.25}), false)) == 9u);
}

BOOST_AUTO_TEST_CASE(bases_in_one_place_are_one_node)
{
  Orl_coordinates x = tree_of({1, 1, 0.5, 0.5, 0.5, 0.25});
  x.attachment[1] = 1 - 1e-10;
  BOOST_TEST(num_vertices(written(x, false)) == 9u);
  x.attachment[1] = 1 - 1e-8; // 1e-8 of the extent: a node of its own
  BOOST_TEST(num_vertices(written(x, false)) == 10u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_write_skeleton

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arcs of one cross-section are merged to one node; separate sections are not merged.

#include <pcs/skeleton/layers/merge_ring_arcs.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_merge_ring_arcs {

using namespace pcs::skeleton;

namespace {

constexpr double spacing = 0.01, pi = CGAL_PI;

/// Level sets constructed explicitly, one above the other.
struct Layers
{
  Scan scan;
  Layer_tree tree;

  Layers() { scan.spacing = spacing; }

  /// Adds an arc of a circle in a level set, from one angle to another; returns its node.
  Index add_arc(Index parent, int layer, const Vec3& center, double radius, double from, double to)
  {
    const auto node = static_cast<Index>(tree.parent.size());
    tree.parent.push_back(parent);
    const int around = static_cast<int>(std::ceil((to - from) * radius / spacing));
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < around; ++k) {
        const double angle = from + (to - from) * (k + 0.5) / around;
        const double z = spacing * (layer_thickness * layer + row);
        scan.points.push_back(center + Vec3(radius * std::cos(angle), radius * std::sin(angle), z));
        tree.node_of_point.push_back(node);
      }
    return node;
  }

  /// Adds complete rings above the node `below`, or as a root; returns the last one.
  Index add_stem(Index below, int first, int last, const Vec3& center, double radius)
  {
    for (int layer = first; layer < last; ++layer)
      below = add_arc(below, layer, center, radius, 0, 2 * pi);
    return below;
  }

  /// Adds level sets of a stem that is seen from two sides, with slits between the arcs.
  void add_halves(Index below, int first, int last, double radius)
  {
    Index left = below, right = below;
    for (int layer = first; layer < last; ++layer) {
      left = add_arc(left, layer, Vec3::Zero(), radius, 0.2, pi - 0.2);
      right = add_arc(right, layer, Vec3::Zero(), radius, pi + 0.2, 2 * pi - 0.2);
    }
  }

  void merge()
  {
    pcs::skeleton::internal::collect_nodes<CGAL::Sequential_tag>(scan, tree);
    tree.next_in_ring.assign(tree.size(), none);
    merge_ring_arcs<CGAL::Sequential_tag>(scan, Ring_arc_options(), tree);
  }

  void check_is_a_tree_of_all_points() const
  {
    BOOST_TEST_REQUIRE(tree.first.size() == tree.size() + 1);
    BOOST_TEST(tree.point.size() == scan.size());
    for (Index v = 0; v < tree.size(); ++v) {
      BOOST_TEST((tree.parent[v] == none || tree.parent[v] < v));
      BOOST_TEST(tree.count(v) > 0u);
      for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
        BOOST_TEST(tree.node_of_point[tree.point[k]] == v);
    }
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(arcs_of_rings)

BOOST_AUTO_TEST_CASE(two_arcs_of_one_ring_become_one_node)
{
  Layers stem;
  stem.add_halves(stem.add_stem(none, 0, 6, Vec3::Zero(), 0.1), 6, 12, 0.1);
  BOOST_TEST(stem.tree.size() == 18u);
  stem.merge();
  stem.check_is_a_tree_of_all_points();
  BOOST_TEST_REQUIRE(stem.tree.size() == 12u);
  for (Index v = 0; v < 12; ++v) {
    BOOST_TEST(stem.tree.parent[v] == (v == 0 ? none : v - 1));
    BOOST_TEST(std::hypot(stem.tree.center[v].x(), stem.tree.center[v].y()) < 0.1 * spacing);
  }
}

BOOST_AUTO_TEST_CASE(two_stems_stay_two)
{
  Layers fork; // of a stem
  const Index top = fork.add_stem(none, 0, 6, Vec3::Zero(), 0.1);
  fork.add_stem(top, 6, 12, Vec3(0.06, 0, 0), 0.05);
  fork.add_stem(top, 6, 12, Vec3(-0.06, 0, 0), 0.05);
  const std::vector<Index> node = fork.tree.node_of_point;
  fork.merge();
  fork.check_is_a_tree_of_all_points();
  BOOST_TEST(fork.tree.size() == 18u);
  BOOST_TEST(fork.tree.node_of_point == node, boost::test_tools::per_element());

  Layers neighbors; // touching stems, each with a separate foot
  neighbors.add_stem(none, 0, 12, Vec3(0.1, 0, 0), 0.1);
  neighbors.add_stem(none, 0, 12, Vec3(-0.1, 0, 0), 0.1);
  neighbors.merge();
  neighbors.check_is_a_tree_of_all_points();
  BOOST_TEST(neighbors.tree.size() == 24u);
}

BOOST_AUTO_TEST_CASE(a_branch_beside_its_stem_stays_a_branch)
{
  Layers stem;
  const Index fork = stem.add_stem(none, 0, 6, Vec3::Zero(), 0.1);
  stem.add_halves(fork, 6, 12, 0.1);
  const std::size_t first = stem.scan.size();
  Index branch = fork;
  for (int k = 0; k < 6; ++k)
    branch = stem.add_arc(branch, 6 + k, Vec3(0.15 + 0.03 * k, 0, 0), 0.02, 0, 2 * pi);
  stem.merge();
  stem.check_is_a_tree_of_all_points();
  BOOST_TEST(stem.tree.size() == 18u);
  std::vector<Index> of_stem(stem.tree.node_of_point.begin(),
                             stem.tree.node_of_point.begin() + std::ptrdiff_t(first));
  for (std::size_t i = first; i < stem.scan.size(); ++i)
    BOOST_TEST(std::count(of_stem.begin(), of_stem.end(), stem.tree.node_of_point[i]) == 0);
}

BOOST_AUTO_TEST_CASE(thick_rings_are_followed_to_their_end_and_thin_twigs_are_no_rings)
{
  Layers thick;
  thick.add_stem(none, 0, 12, Vec3::Zero(), 0.1);
  thick.merge();
  BOOST_TEST_REQUIRE(thick.tree.size() == 12u);
  for (Index v = 0; v < 12; ++v) // it ends with the last one
    BOOST_TEST(thick.tree.next_in_ring[v] == (v < 11 ? v + 1 : v));

  Layers thin;
  thin.add_halves(thin.add_stem(none, 0, 6, Vec3::Zero(), 0.02), 6, 12, 0.02);
  thin.merge();
  BOOST_TEST(thin.tree.size() == 18u);
  for (const Index next : thin.tree.next_in_ring)
    BOOST_TEST(next == none);
}

BOOST_AUTO_TEST_CASE(no_layers_stay_none)
{
  Layers empty;
  empty.scan.points.push_back(Vec3::Zero()); // without any path to it
  empty.tree.node_of_point.push_back(none);
  empty.merge();
  BOOST_TEST(empty.tree.size() == 0u);
  BOOST_TEST(empty.tree.point.empty());
  BOOST_TEST(empty.tree.node_of_point.front() == none);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_merge_ring_arcs

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the foot of a tree, and the geodesic level sets above it.

#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/layers/cut_layers.h>
#include <pcs/skeleton/layers/find_root.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

namespace test_layers {

namespace {

using pcs::skeleton::Index;
using pcs::skeleton::Vec3;

/// Random points on an upright cylinder with a mean spacing of `spacing`.
void add_stem(const Vec3& base,
              double radius,
              double height,
              double spacing,
              std::mt19937& random,
              std::vector<Vec3>& points)
{
  std::uniform_real_distribution<double> shift(-0.2, 0.2);
  const int around = static_cast<int>(std::ceil(2 * CGAL_PI * radius / spacing));
  const int rows = static_cast<int>(std::ceil(height / spacing));
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < around; ++k) {
      const double turn = 2 * CGAL_PI * (k + 0.5 * (row % 2) + shift(random)) / around;
      points.push_back(base + Vec3(radius * std::cos(turn),
                                   radius * std::sin(turn),
                                   spacing * (row + shift(random))));
    }
}

struct Linked_scan
{
  pcs::skeleton::Scan scan;
  std::vector<std::uint8_t> is_used;
  std::optional<pcs::skeleton::Compact_links> links;
  pcs::skeleton::Point_parts parts;
  std::vector<Index> root;

  explicit Linked_scan(const std::vector<Vec3>& points)
  {
    pcs::skeleton::prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
    is_used.assign(scan.size(), 1);
    links.emplace(CGAL::Sequential_tag(), scan, is_used, pcs::skeleton::Link_rule());
    parts = pcs::skeleton::connected_parts<CGAL::Sequential_tag>(is_used, *links);
    root = pcs::skeleton::find_root<CGAL::Sequential_tag>(scan,
                                                          is_used,
                                                          *links,
                                                          parts,
                                                          Vec3::UnitZ(),
                                                          {});
  }
  pcs::skeleton::Layer_tree layers() const
  {
    const auto graph = pcs::skeleton::graph_of(scan.size(), *links);
    return pcs::skeleton::layer_tree<CGAL::Sequential_tag>(scan,
                                                           *links,
                                                           shortest_paths(scan, graph, root));
  }
  Vec3 place(Index i) const { return scan.frame.to_input(scan.points[i]); }
};

} // namespace

BOOST_AUTO_TEST_SUITE(layers_of_paths)

BOOST_AUTO_TEST_CASE(the_root_is_what_most_points_stand_on)
{
  std::mt19937 random(1);
  std::vector<Vec3> points;
  add_stem(Vec3(0, 0, 0), 0.1, 4, 0.015, random, points);
  for (int k = 0; k < 60; ++k) // a shrub with adjacent stems
    add_stem(Vec3(0.3 + 0.03 * (k % 10), 0.03 * (k / 10), 0), 0.012, 0.7, 0.012, random, points);
  for (int k = 0; k < 20; ++k) // one of its twigs touches the trunk
    points.push_back(Vec3(0.1 + 0.01 * k, 0, 0.6));
  const Linked_scan s(points);
  BOOST_TEST(s.root.size() > 20u);
  BOOST_TEST(std::all_of(s.root.begin(), s.root.end(), [&](Index i) {
    return std::hypot(s.place(i).x(), s.place(i).y()) < 0.12;
  }));
}

BOOST_AUTO_TEST_CASE(a_twig_that_hangs_below_the_foot_is_no_root)
{
  for (const double depth : {0.3, 0.7}) { // below the foot
    std::mt19937 random(4);
    std::vector<Vec3> points;
    add_stem(Vec3(0, 0, 0), 0.1, 4, 0.015, random, points);
    for (int k = 0; k < 200; ++k) // a branch to one side at the top of the stem
      points.push_back(Vec3(0.1 + 0.005 * k, 0, 3.95));
    for (int k = 0; k < 800; ++k) // a twig that hangs down from it
      points.push_back(Vec3(1.1, 0.0002 * (k % 20), 3.95 - (3.95 + depth) / 800 * k));
    const Linked_scan s(points);
    BOOST_TEST(s.root.size() > 20u);
    BOOST_TEST(std::all_of(s.root.begin(), s.root.end(), [&](Index i) {
      return std::hypot(s.place(i).x(), s.place(i).y()) < 0.12 && s.place(i).z() < 0.1;
    }));
  }
}

BOOST_AUTO_TEST_CASE(low_branches_of_a_thin_stem_are_no_root)
{
  std::mt19937 random(4);
  std::vector<Vec3> points;
  for (int k = 0; k < 800; ++k) // the stem
    points.push_back(Vec3(0, 0.0002 * (k % 20), 0.005 * k));
  for (int k = 0; k < 700; ++k) // a branch with most of the wood, hanging from the tip
    points.push_back(Vec3(0.9 / 700 * k, 0.0002 * (k % 20), 4 - 0.005 * k));
  add_stem(Vec3(0.2, 0, 2.9), 0.05, 0.6, 0.01, random, points);
  for (int k = 0; k < 4; ++k) // dense tuft of twigs, as wide as a trunk
    add_stem(Vec3(0.9 + 0.05 * k, 0, 0.5), 0.004, 0.3, 0.005, random, points);
  for (int k = 0; k < 60; ++k)
    points.push_back(Vec3(0.9 + 0.0025 * k, 0, 0.5));
  const Linked_scan s(points);
  BOOST_TEST(std::all_of(s.root.begin(), s.root.end(), [&](Index i) {
    return std::hypot(s.place(i).x(), s.place(i).y()) < 0.02 && s.place(i).z() < 0.1;
  }));
}

BOOST_AUTO_TEST_CASE(a_foot_that_is_cut_off_is_the_root_and_no_twig_that_hangs_beside_it)
{
  std::mt19937 random(5);
  std::vector<Vec3> points, ring;
  add_stem(Vec3(0, 0, 0), 0.1, 1, 0.015, random, ring);
  add_stem(Vec3(0, 0, 1.4), 0.09, 3, 0.015, random, ring); // the part between them is occluded
  for (const Vec3& p : ring)
    if (p.x() > 0) // one station sees half of it
      points.push_back(p);
  for (int k = 0; k < 200; ++k) // a branch of the upper part
    points.push_back(Vec3(0.09 + 0.004 * k, 0, 2));
  for (int k = 0; k < 200; ++k) // a twig that hangs down from it, as low as the foot
    points.push_back(Vec3(0.89, 0.0002 * (k % 20), 2 - 0.0098 * k));
  for (int k = 0; k < 20; ++k) // a branch of this twig
    points.push_back(Vec3(0.89 + 0.01 * k, 0, 0.1));
  const Linked_scan s(points);
  BOOST_TEST(s.root.size() > 10u);
  BOOST_TEST(std::all_of(s.root.begin(), s.root.end(), [&](Index i) {
    return std::hypot(s.place(i).x(), s.place(i).y()) < 0.12;
  }));
}

BOOST_AUTO_TEST_CASE(a_gap_is_closed_where_it_is_narrowest)
{
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<Vec3> points;
    add_stem(Vec3(0, 0, 0), 0.1, 1, 0.015, random, points);
    add_stem(Vec3(0, 0, 1.2), 0.1, 0.5, 0.015, random, points);
    const Linked_scan s(points);
    const auto gaps =
        pcs::skeleton::links_across_gaps<CGAL::Sequential_tag>(s.scan, s.is_used, {}, s.parts);
    BOOST_REQUIRE(gaps.size() == 1u);
    double narrowest = 1;
    for (Index i = 0; i < s.scan.size(); ++i)
      for (Index j = 0; j < s.scan.size(); ++j)
        if (s.place(i).z() < 1.1 && s.place(j).z() > 1.1)
          narrowest = std::min(narrowest, (s.place(i) - s.place(j)).norm());
    BOOST_CHECK_CLOSE((s.place(gaps[0].first) - s.place(gaps[0].second)).norm(), narrowest, 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(layers_of_a_sparse_stem_hang_together)
{
  std::mt19937 random(2);
  std::vector<Vec3> points;
  add_stem(Vec3(0, 0, 0), 0.15, 1, 0.008, random, points);
  add_stem(Vec3(0, 0, 1.01), 0.15, 2, 0.03, random, points);
  const Linked_scan s(points);
  const pcs::skeleton::Layer_tree tree = s.layers();
  std::size_t upper = 0, in_rings = 0;
  for (Index i = 0; i < s.scan.size(); ++i)
    if (s.place(i).z() > 1.2 && s.place(i).z() < 2.8) {
      ++upper;
      in_rings += tree.node_of_point[i] != pcs::skeleton::none &&
                  tree.count(tree.node_of_point[i]) >= 20; // of the 31 of a row
    }
  BOOST_TEST(upper > 1000u);
  BOOST_TEST(double(in_rings) > 0.9 * double(upper));
  for (Index v = 0; v < tree.size(); ++v)
    BOOST_TEST((tree.parent[v] == pcs::skeleton::none || tree.parent[v] < v));
}

BOOST_AUTO_TEST_CASE(joined_layers_and_thin_ones_are_one_tree)
{
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    std::vector<Vec3> both, points;
    add_stem(Vec3(0, 0, 0), 0.15, 1, 0.008, random, points);
    add_stem(Vec3(0, 0, 1), 0.15, 1, 0.008, random, both); // dense points on one side
    for (const Vec3& p : both)
      if (p.x() < 0)
        points.push_back(p);
    both.clear();
    add_stem(Vec3(0, 0, 1), 0.15, 1, 0.03, random, both); // sparse points on the other side
    for (const Vec3& p : both)
      if (p.x() >= 0)
        points.push_back(p);
    const pcs::skeleton::Layer_tree tree = Linked_scan(points).layers();
    BOOST_REQUIRE(tree.size() > 0u);
    for (Index v = 1; v < tree.size(); ++v)
      BOOST_TEST(tree.parent[v] < v); // parents have smaller indices
  }
}

BOOST_AUTO_TEST_CASE(layers_of_a_sparse_twig_stay_thin)
{
  std::mt19937 random(3);
  std::vector<Vec3> points;
  add_stem(Vec3(0, 0, 0), 0.15, 1, 0.008, random, points);
  for (int k = 0; k < 40; ++k)
    points.push_back(Vec3(0.15 + 0.03 * k, 0, 0.9 + 0.01 * k));
  const Linked_scan s(points);
  const pcs::skeleton::Layer_tree tree = s.layers();
  for (Index i = 0; i < s.scan.size(); ++i)
    if (s.place(i).x() > 0.25)
      BOOST_TEST(tree.count(tree.node_of_point[i]) <= 2u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_layers

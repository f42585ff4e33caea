// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the continuation of stems down to the ground.

#include <pcs/skeleton/forest/Found_stem.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_Found_stem {

namespace {

using pcs::skeleton::Axis_set;
using pcs::skeleton::Index;
using pcs::skeleton::Link;
using pcs::skeleton::Links;
using pcs::skeleton::none;
using pcs::skeleton::Scan;
using pcs::skeleton::Stand_options;
using pcs::skeleton::Vec3;
using pcs::skeleton::internal::Found_stem;
using pcs::skeleton::internal::Stem_continuation;

constexpr Index crown = 0, trunk = 1, shrub = 2;
constexpr double breast_height = 1.3;

/// A crown above a trunk that begins at the ground, as a chain of points 0.1 apart: the trunk up to
/// 1.5, then the crown. A shrub beside the trunk is linked to its base.
struct Sparse_tree
{
  Scan scan;
  Axis_set axes;
  Links links;

  /// `points_of_trunk`: from the crown downwards.
  explicit Sparse_tree(int points_of_trunk, bool has_shrub = false)
  {
    for (int k = 15 - points_of_trunk; k < 30; ++k)
      add(Vec3(k < 15 ? 0 : 0.1, 0, 0.1 * k), k < 15 ? trunk : crown, scan.points.size());
    Index before = 0;
    for (int k = 1; has_shrub && k < 40; ++k)
      before = add(Vec3(0.1 * k, 0, 0), shrub, before + 1);
  }

  Index add(const Vec3& p, Index axis, std::size_t before)
  {
    const Index i = static_cast<Index>(scan.points.size());
    scan.points.push_back(p);
    axes.axis_of_point.push_back(axis);
    if (before > 0)
      links.push_back({static_cast<Index>(before - 1), i});
    return i;
  }

  Index lowest_axis(const Vec3& foot) const
  {
    const auto graph = pcs::skeleton::graph_of(scan.size(), links);
    std::vector<Index> points;
    for (Index i = 0; i < scan.size(); ++i)
      if (axes.axis_of_point[i] == crown)
        points.push_back(i);
    const Found_stem stem{crown, none, foot, 0.15, 0, 0};
    return Stem_continuation(scan, graph, axes, breast_height, rules).lowest_axis(stem, points);
  }

  Stand_options rules;
};

} // namespace

BOOST_AUTO_TEST_SUITE(found_stem)

BOOST_AUTO_TEST_CASE(a_stem_that_begins_in_the_crown_continues_down_its_trunk)
{
  BOOST_TEST(Sparse_tree(15).lowest_axis(Vec3(0.1, 0, 1.5)) == trunk);
}

BOOST_AUTO_TEST_CASE(a_stem_without_points_below_keeps_its_axis)
{
  BOOST_TEST(Sparse_tree(0).lowest_axis(Vec3(0.1, 0, 1.5)) == crown);
  BOOST_TEST(Sparse_tree(2).lowest_axis(Vec3(0.1, 0, 1.5)) == crown); // as near as a foot is
}

BOOST_AUTO_TEST_CASE(points_without_links_are_no_part_of_a_stem)
{
  Sparse_tree tree(15);
  tree.links.erase(tree.links.begin() + 7);
  BOOST_TEST(tree.lowest_axis(Vec3(0.1, 0, 1.5)) == trunk); // its upper part is linked
  tree.links.erase(tree.links.begin() + 11, tree.links.begin() + 16);
  BOOST_TEST(tree.lowest_axis(Vec3(0.1, 0, 1.5)) == crown);
}

BOOST_AUTO_TEST_CASE(points_beside_a_stem_are_no_part_of_it)
{
  // the shrub has more points than the trunk, most of them out of reach
  BOOST_TEST(Sparse_tree(15, true).lowest_axis(Vec3(0.1, 0, 1.5)) == trunk);
}

BOOST_AUTO_TEST_CASE(the_foot_lies_on_the_ground_if_that_is_near)
{
  Found_stem stem{trunk, none, Vec3(1, 2, 3), 0.15, 0, 0};
  for (const double above : {0.3, -0.2, 1.3}) {
    stem.above_ground = above;
    BOOST_TEST((stem.foot_on_ground(breast_height) - Vec3(1, 2, 3 - above)).norm() < 1e-12);
  }
  stem.above_ground = 1.4;
  BOOST_TEST((stem.foot_on_ground(breast_height) == stem.foot));
}

// Breast height is 1.3 above the ground, which is 0.2 below the base of the axis.
BOOST_AUTO_TEST_CASE(another_axis_may_continue_a_stem_up_to_breast_height)
{
  const auto axis = [](const Vec3& base, double length, double radius) {
    pcs::skeleton::Fitted_axis result;
    for (const double t : {0.0, 0.5, 1.0})
      result.axis.push_back({base + t * length * Vec3::UnitZ(), radius * (1 - 0.1 * t)});
    return result;
  };
  const auto radius_of = [&](const std::vector<pcs::skeleton::Fitted_axis>& list) {
    Axis_set axes;
    axes.axes = list;
    Found_stem stem{0, none, Vec3::Zero(), 0.1, 0, 0};
    stem.above_ground = 0.2;
    return pcs::skeleton::internal::radius_at_breast(stem, axes, breast_height, Stand_options());
  };
  const auto whole = axis(Vec3::Zero(), 2, 0.1), lower = axis(Vec3::Zero(), 1, 0.1),
             upper = axis(Vec3(0.05, 0, 1), 2, 0.09), thick = axis(Vec3(0.05, 0, 1), 2, 0.2),
             far = axis(Vec3(0.6, 0, 1), 2, 0.09);
  BOOST_TEST(std::abs(radius_of({whole, upper}) - 0.1 * (1 - 0.1 * 1.1 / 2)) < 1e-12);
  BOOST_TEST(std::abs(radius_of({lower, upper}) - 0.09 * (1 - 0.1 * 0.1 / 2)) < 1e-12);
  BOOST_TEST(radius_of({lower, thick, far}) == 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Found_stem

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A stored family is restored bit for bit, and every kind of inconsistent number has its message.

#include <pcs/core/Orl_space_data.h>
#include <pcs/core/errors.h>
#include <pcs/shape_space/family/serialize_family.h>
#include <support/exceptions.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <limits>
#include <utility>

namespace test_serialize_family {

using pcs::Orl_space_data;
using pcs_test::message_has;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Orl_space_data data_of(std::size_t number_of_trees, bool has_points)
{
  orl_test::Space space;
  for (const orl_test::Tree& tree : orl_test::relatives(number_of_trees, 51))
    if (has_points)
      space.add(tree, orl_test::rings(tree));
    else
      space.add_skeleton(tree);
  space.build();
  return space.data();
}

template <class Spoil>
void is_refused(const Orl_space_data& good, const char* message, const Spoil& spoil)
{
  Orl_space_data bad = good;
  spoil(bad);
  orl_test::Space space;
  BOOST_CHECK_EXCEPTION(space.restore(bad),
                        pcs::Invalid_input,
                        message_has("restore(): ", message));
}

} // namespace

BOOST_AUTO_TEST_SUITE(stored_families)

BOOST_AUTO_TEST_CASE(storing_what_was_restored_gives_the_same_numbers)
{
  const Orl_space_data data = data_of(4, false);
  const Orl_space_data again =
      pcs::shape_space::store_family(pcs::shape_space::restore_family(data, "test"));
  BOOST_REQUIRE(again.trees.size() == data.trees.size());
  for (std::size_t t = 0; t < data.trees.size(); ++t) {
    BOOST_TEST((again.trees[t].orientation == data.trees[t].orientation));
    BOOST_TEST((again.trees[t].length == data.trees[t].length));
    BOOST_TEST((again.trees[t].radius == data.trees[t].radius));
    BOOST_TEST((again.trees[t].base_radius == data.trees[t].base_radius));
    BOOST_TEST((again.trees[t].attachment == data.trees[t].attachment));
    BOOST_TEST((again.trees[t].tip == data.trees[t].tip));
    BOOST_TEST((again.trees[t].has == data.trees[t].has));
    BOOST_TEST((again.trees[t].root == data.trees[t].root));
  }
  BOOST_TEST((again.reference.length == data.reference.length));
  BOOST_TEST((again.weights.orientation == data.weights.orientation));
  BOOST_TEST((again.weights.attachment == data.weights.attachment));
  BOOST_TEST((again.matching == data.matching));
  BOOST_TEST((again.origin == data.origin));
  BOOST_TEST(again.orientation == data.orientation);
}

BOOST_AUTO_TEST_CASE(a_topology_with_errors_is_refused)
{
  const Orl_space_data good = data_of(4, false);
  const auto refused = [&](const char* message, const auto& spoil) {
    is_refused(good, message, spoil);
  };
  refused("no such orientation", [](auto& d) { d.orientation = 3; });
  refused("no such orientation", [](auto& d) { d.orientation = -1; });
  refused("the origin is not finite", [](auto& d) { d.origin[1] = infinity; });
  refused("there are not two trees", [](auto& d) { d.trees.resize(1); });
  refused("there are not two trees", [](auto& d) { d.branches.clear(); });
  refused("a branch comes before its parent", [](auto& d) { d.branches[0].parent = 0; });
  refused("a branch comes before its parent", [](auto& d) { d.branches[0].reference_edge = 0; });
  refused("a branch comes before its parent", [](auto& d) { d.branches[1].parent = 1; });
  refused("a branch has no edge", [](auto& d) { d.branches[1].number_of_edges = 0; });
  for (const std::size_t n : {std::size_t(1000), std::numeric_limits<std::size_t>::max()})
    refused("more edges than the reference", [n](auto& d) { d.branches[1].number_of_edges = n; });
  refused("an edge that is not of its parent",
          [](auto& d) { d.branches[1].reference_edge = d.branches[0].number_of_edges; });
  refused("one that is not before it", [](auto& d) { d.references.push_back({1, 1}); });
  refused("one that is not before it", [](auto& d) { d.references.push_back({1u << 30, 1}); });
}

BOOST_AUTO_TEST_CASE(a_tree_with_errors_is_refused)
{
  const Orl_space_data good = data_of(4, false);
  const auto refused = [&](const char* message, const auto& spoil) {
    is_refused(good, message, spoil);
  };
  const char* const size = "another number of edges or branches than the topology";
  refused(size, [](auto& d) { d.trees[0].orientation.pop_back(); });
  refused(size, [](auto& d) { d.trees[1].length.pop_back(); });
  refused(size, [](auto& d) { d.trees[2].radius.push_back(1); });
  refused(size, [](auto& d) { d.trees[3].base_radius.pop_back(); });
  refused(size, [](auto& d) { d.reference.attachment.pop_back(); });
  refused("a root is not finite", [](auto& d) { d.trees[0].root[0] = 1e101; });
  refused("not of unit length", [](auto& d) { d.trees[0].orientation[2] = {0, 0, 0, 1.1}; });
  const char* const range = "a length, radius or attachment is not from 0 to 1e100";
  refused(range, [](auto& d) { d.trees[0].length[0] = -1e-9; });
  refused(range, [](auto& d) { d.trees[0].radius[0] = infinity; });
  refused(range, [](auto& d) { d.trees[0].base_radius[0] = 1e101; });
  refused(range, [](auto& d) { d.trees[0].attachment[1] = -1; });
  refused("a branch is attached beyond its parent", [](auto& d) {
    d.trees[0].attachment[1] = static_cast<double>(d.branches[0].number_of_edges) + 0.01;
  });
  refused("a tree has no trunk", [](auto& d) { d.trees[0].has[0] = 0; });
  refused("a tree has no trunk", [](auto& d) { d.trees[0].has.pop_back(); });
  refused("a tree has no trunk", [](auto& d) { d.trees[0].tip.pop_back(); });
  std::size_t child = 0;
  while (child < good.branches.size() && (child == 0 || good.branches[child].parent == 0))
    ++child;
  BOOST_REQUIRE(child < good.branches.size());
  refused("a tree has a branch without its parent", [&](auto& d) {
    d.trees[0].has[child] = 1;
    d.trees[0].has[d.branches[child].parent] = 0;
  });
}

BOOST_AUTO_TEST_CASE(weights_with_errors_are_refused)
{
  const Orl_space_data good = data_of(3, false);
  const auto refused = [&](const char* message, const auto& spoil) {
    is_refused(good, message, spoil);
  };
  refused("the weights do not fit", [](auto& d) { d.weights.orientation.pop_back(); });
  refused("the weights do not fit", [](auto& d) { d.weights.base_radius.pop_back(); });
  refused("the weights do not fit", [](auto& d) { d.weights.root = -1; });
  refused("a weight is not from 0", [](auto& d) { d.weights.length[0] = -1; });
  refused("a weight is not from 0", [](auto& d) { d.weights.attachment[0] = infinity; });
  refused("a weight of the matching", [](auto& d) { d.matching[0] = -1; });
  refused("a weight of the matching", [](auto& d) { d.matching[13] = infinity; });
  refused("a number of paths or trials", [](auto& d) { d.matching[8] = 0; });
  refused("a number of paths or trials", [](auto& d) { d.matching[9] = 1e16; });
}

BOOST_AUTO_TEST_CASE(points_with_errors_are_refused)
{
  const Orl_space_data good = data_of(3, true);
  const auto refused = [&](const char* message, const auto& spoil) {
    is_refused(good, message, spoil);
  };
  BOOST_REQUIRE(good.points.size() > 10u);
  BOOST_REQUIRE(good.partners.size() > 10u);
  const char* const point = "a point is not finite, on no edge, or out of order";
  refused(point, [](auto& d) { d.points[3].position[0] = infinity; });
  refused(point, [](auto& d) { d.points[3].normal[2] = infinity; });
  refused(point, [](auto& d) { d.points[3].tree = 3; });
  refused(point, [](auto& d) { d.points.back().edge = 1u << 30; });
  refused(point, [](auto& d) { std::swap(d.points.front().edge, d.points.back().edge); });
  const char* const partner = "a partner of a point is not finite, of no scan, or out of order";
  refused(partner, [](auto& d) { d.partners[3].position[1] = infinity; });
  refused(partner, [](auto& d) { d.partners[3].normal[1] = infinity; });
  refused(partner, [](auto& d) { d.partners[3].tree = 3; });
  refused(partner, [](auto& d) { d.partners[3].tree = d.points[d.partners[3].point].tree; });
  refused(partner, [](auto& d) { d.partners[3].point = 1u << 30; });
  refused(partner, [](auto& d) { std::swap(d.partners.front(), d.partners.back()); });
  refused(partner, [](auto& d) { d.partners[1] = d.partners[0]; });
}

BOOST_AUTO_TEST_CASE(pairs_of_two_trees_with_errors_are_refused)
{
  const Orl_space_data good = data_of(2, true);
  const auto refused = [&](const char* message, const auto& spoil) {
    is_refused(good, message, spoil);
  };
  BOOST_REQUIRE(good.pairs.size() > 10u);
  refused("a point or normal is not finite", [](auto& d) { d.trees[1].point[5][0] = 1e101; });
  refused("more points than normals, or less", [](auto& d) {
    d.trees[0].normal.assign(d.trees[0].point.size() + 1, {0, 0, 1});
  });
  const char* const pair = "a pair of points names what does not exist, or is out of order";
  refused(pair, [](auto& d) { d.pairs.back().edge = 1u << 30; });
  refused(pair, [](auto& d) { std::swap(d.pairs.front().edge, d.pairs.back().edge); });
  refused(pair, [](auto& d) { d.pairs[2].point.fill(pcs::Orl_correspondences::no_point); });
  refused(pair, [](auto& d) { d.pairs[2].point[0] = 1u << 30; });
  refused(pair, [](auto& d) { d.pairs[2].point[1] = 1u << 30; });
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_serialize_family

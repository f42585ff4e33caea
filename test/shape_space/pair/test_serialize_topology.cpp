// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Every kind of error in stored correspondences of two trees has its message.

#include <pcs/Orl_shape_space.h>
#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/errors.h>
#include <support/exceptions.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <vector>

namespace test_serialize_topology {

using pcs::Orl_correspondences;
using pcs_test::message_has;

namespace {

/// Two trees, of which each lacks branches of the other one, with their correspondences.
struct Fixture
{
  std::vector<orl_test::Tree> trees = orl_test::relatives(2, 51, 0.15, 0.3);
  Orl_correspondences good;
  std::size_t common = 0;  ///< a branch that both trees have, with inner nodes, not the trunk
  std::size_t lacking = 0; ///< a branch that tree `without` lacks
  std::size_t without = 0;

  Fixture()
  {
    orl_test::Space space;
    add_to(space);
    space.build();
    good = space.correspondences();
    for (std::size_t b = 1; b < good.branches.size(); ++b) {
      const Orl_correspondences::Branch& branch = good.branches[b];
      const bool is_in_both =
          branch.tip[0] != Orl_correspondences::none && branch.tip[1] != Orl_correspondences::none;
      if (is_in_both && branch.nodes[0].size() > 2)
        common = b;
      if (!is_in_both && lacking == 0) {
        lacking = b;
        without = branch.tip[0] == Orl_correspondences::none ? 0 : 1;
      }
    }
    BOOST_REQUIRE(common > 0);
    BOOST_REQUIRE(lacking > 0);
  }

  void add_to(orl_test::Space& space) const
  {
    for (const orl_test::Tree& tree : trees)
      space.add_skeleton(tree);
  }

  template <class Spoil>
  void refused(const char* message, const Spoil& spoil) const
  {
    Orl_correspondences bad = good;
    spoil(bad);
    orl_test::Space space;
    add_to(space);
    BOOST_CHECK_EXCEPTION(space.build_from(bad),
                          pcs::Invalid_input,
                          message_has("build_from(): ", message));
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(stored_topologies, Fixture)

BOOST_AUTO_TEST_CASE(stored_correspondences_give_the_same_distance)
{
  orl_test::Space space, again;
  add_to(space);
  add_to(again);
  space.build();
  again.build_from(good);
  BOOST_TEST(again.distance(0, 1) == space.distance(0, 1));
  BOOST_TEST(space.distance(0, 1) > 0);
}

BOOST_AUTO_TEST_CASE(errors_of_the_whole_are_refused)
{
  refused("other trees", [](auto& d) { ++d.fingerprint[1]; });
  refused("the turn is no rotation", [](auto& d) { d.rotation = {1, 0.1, 0, 0}; });
  refused("there are no branches", [](auto& d) { d.branches.clear(); });
}

BOOST_AUTO_TEST_CASE(errors_of_the_hierarchy_are_refused)
{
  refused("a branch comes before its parent", [](auto& d) { d.branches[0].parent = 0; });
  refused("a branch comes before its parent", [&](auto& d) { d.branches[common].parent = common; });
  refused("a branch is in neither tree", [&](auto& d) {
    const std::size_t other = 1 - without;
    d.branches[lacking].tip[other] = Orl_correspondences::none;
    d.branches[lacking].nodes[other].clear();
  });
  refused("a branch that a tree lacks has nodes there", [&](auto& d) {
    d.branches[lacking].nodes[without] = {0, 1};
  });
  refused("a branch that a tree lacks has nodes there", [&](auto& d) {
    d.branches[0].tip[0] = Orl_correspondences::none;
    d.branches[0].nodes[0].clear();
  });
  refused("a tree has a branch without its parent", [&](auto& d) {
    Orl_correspondences::Branch child = d.branches[common];
    child.parent = lacking;
    d.branches.push_back(child);
  });
}

BOOST_AUTO_TEST_CASE(errors_of_paths_are_refused)
{
  refused("there is no such node", [&](auto& d) { d.branches[common].tip[0] = 1000000; });
  refused("there is no such node", [&](auto& d) { d.branches[common].first[1] = 1000000; });
  refused("a branch begins with the root", [&](auto& d) { d.branches[common].first[0] = 0; });
  refused("a branch begins with the root", [](auto& d) { d.branches[0].first[0] = 1; });
  refused("a branch has no edge", [](auto& d) { d.branches[0].tip[1] = 0; });
  refused("a branch does not lead to its tip", [&](auto& d) {
    d.branches[common].first[0] = d.branches[0].tip[0]; // no way leads past another tip
  });
  const char* const continued = "a branch that continues its parent does not begin at its tip";
  refused(continued, [](auto& d) { d.branches[0].is_continued[0] = true; });
  refused(continued, [&](auto& d) { d.branches[common].is_continued[1] = true; });
}

BOOST_AUTO_TEST_CASE(errors_of_positions_are_refused)
{
  refused("a branch does not go from 0 to 1",
          [&](auto& d) { d.branches[common].nodes[0].clear(); });
  refused("a branch does not go from 0 to 1",
          [&](auto& d) { d.branches[common].nodes[0].back() = 0.99; });
  refused("a branch does not go from 0 to 1",
          [&](auto& d) { d.branches[common].nodes[1].front() = 0.01; });
  refused("the nodes of a branch do not increase",
          [&](auto& d) { d.branches[common].nodes[1][1] = 0; });
  refused("different numbers of nodes", [&](auto& d) {
    std::vector<double>& nodes = d.branches[common].nodes[0];
    nodes.insert(nodes.begin() + 1, nodes[1] / 2);
  });
  refused("a branch is attached beyond its parent",
          [&](auto& d) { d.branches[common].attachment[0] = 1000000; });
  refused("a branch is attached beyond its parent",
          [&](auto& d) { d.branches[common].attachment[1] = -0.01; });
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_serialize_topology

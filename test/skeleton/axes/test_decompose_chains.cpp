// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Chains of level-set components: straight children continue, gaps and rings end a chain.

#include <pcs/skeleton/axes/decompose_chains.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_decompose_chains {

using namespace pcs::skeleton;

namespace {

/// Level sets of one point each, in a scan of spacing 1.
struct Layers
{
  Scan scan;
  Layer_tree tree;

  Layers()
  {
    scan.spacing = 1;
    tree.first.push_back(0);
  }

  Index add(Index parent, const Vec3& center, double spread = 0.5)
  {
    const auto node = static_cast<Index>(tree.size());
    tree.parent.push_back(parent);
    tree.center.push_back(center);
    tree.spread.push_back(spread);
    tree.next_in_ring.push_back(none);
    tree.point.push_back(node);
    tree.first.push_back(node + 1);
    return node;
  }

  /// Adds `n` nodes beyond `parent`, at distances of one level set; returns the first one.
  Index add_row(Index parent, const Vec3& direction, std::size_t n, double spread = 0.5)
  {
    const auto first = static_cast<Index>(tree.size());
    for (std::size_t k = 0; k < n; ++k)
      parent = add(parent, tree.center[parent] + layer_thickness * direction, spread);
    return first;
  }

  std::vector<Chain> chains() const { return decompose_chains(scan, tree); }
};

/// Unit vector at an angle to the vertical.
Vec3 slanted(double angle)
{
  return Vec3(std::sin(angle), 0, std::cos(angle));
}

std::size_t chain_of(const std::vector<Chain>& chains, Index node)
{
  for (std::size_t c = 0; c < chains.size(); ++c)
    if (std::count(chains[c].nodes.begin(), chains[c].nodes.end(), node) > 0)
      return c;
  return chains.size();
}

} // namespace

BOOST_AUTO_TEST_SUITE(chains_of_layers)

BOOST_AUTO_TEST_CASE(at_equal_angles_the_child_with_more_points_beyond_continues)
{
  // both children have the same height and spread; the second one carries twenty short branches
  Layers layers;
  layers.add(none, Vec3(0, 0, 0));
  const Index fork = layers.add_row(0, Vec3::UnitZ(), 8) + 7;
  const Index bare = layers.add_row(fork, slanted(-0.3), 30);
  const Index crowned = layers.add_row(fork, slanted(0.3), 30);
  for (Index k = 0; k < 20; ++k)
    layers.add_row(crowned + 5 + k, Vec3::UnitX(), 3);
  const std::vector<Chain> chains = layers.chains();
  BOOST_TEST(chain_of(chains, crowned) == chain_of(chains, fork));
  BOOST_TEST(chain_of(chains, bare) != chain_of(chains, fork));
}

BOOST_AUTO_TEST_CASE(a_straight_child_continues_the_chain_unless_another_is_much_thicker)
{
  for (const bool is_thick : {false, true}) {
    Layers layers;
    const Index root = layers.add(none, Vec3::Zero());
    layers.add_row(root, Vec3::UnitZ(), 8);
    const Index fork = 8;
    const Index straight = layers.add_row(fork, Vec3::UnitZ(), 5);
    const Index slant = layers.add_row(fork, slanted(1), 10, is_thick ? 12 : 0.5); // twice as long
    const std::vector<Chain> chains = layers.chains();
    BOOST_TEST_REQUIRE(chains.size() == 2u);
    BOOST_TEST(chain_of(chains, straight) == (is_thick ? 1u : 0u));
    BOOST_TEST(chain_of(chains, slant) == (is_thick ? 0u : 1u));
    BOOST_TEST(chains[0].nodes.front() == root);
    BOOST_TEST(chains[1].parent_node == fork);
    BOOST_TEST(std::abs(chains[1].length - layer_thickness * (is_thick ? 4 : 9)) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(the_first_chain_begins_at_a_source_and_the_others_are_sorted_by_length)
{
  Layers layers;
  const Index root = layers.add(none, Vec3::Zero());
  layers.add_row(root, Vec3::UnitZ(), 6);
  layers.add_row(3, slanted(1.5), 5);
  layers.add_row(4, slanted(-1.5), 14); // longer than the chain of the source
  const Index other = layers.add(none, Vec3(100, 0, 0));
  layers.add_row(other, Vec3::UnitZ(), 3);
  const std::vector<Chain> chains = layers.chains();
  BOOST_TEST_REQUIRE(chains.size() == 4u);
  BOOST_TEST(chains[0].nodes.front() == root);
  BOOST_TEST(chains[1].nodes.size() == 14u);
  BOOST_TEST(chains[2].nodes.size() == 5u);
  BOOST_TEST(chains[3].nodes.front() == other);
  std::vector<Index> nodes;
  for (const Chain& c : chains)
    nodes.insert(nodes.end(), c.nodes.begin(), c.nodes.end());
  std::sort(nodes.begin(), nodes.end());
  BOOST_TEST_REQUIRE(nodes.size() == layers.tree.size());
  for (std::size_t v = 0; v < nodes.size(); ++v)
    BOOST_TEST(nodes[v] == v); // each in one chain
}

BOOST_AUTO_TEST_CASE(a_chain_crosses_a_gap_only_straight_ahead)
{
  for (const double angle : {0.0, 1.0}) {
    Layers layers;
    const Index root = layers.add(none, Vec3::Zero());
    layers.add_row(root, Vec3::UnitZ(), 8);
    const Index beyond = layers.add(8, layers.tree.center[8] + 20 * slanted(angle));
    layers.add_row(beyond, slanted(angle), 4);
    BOOST_TEST(layers.chains().size() == (angle == 0 ? 1u : 2u));
  }
}

BOOST_AUTO_TEST_CASE(rings_determine_the_continuation)
{
  Layers layers;
  const Index root = layers.add(none, Vec3::Zero());
  layers.add_row(root, Vec3::UnitZ(), 8);
  const Index straight = layers.add_row(8, Vec3::UnitZ(), 5);
  const Index slant = layers.add_row(8, slanted(1), 5);
  layers.tree.next_in_ring[8] = slant;
  BOOST_TEST(chain_of(layers.chains(), slant) == chain_of(layers.chains(), root));
  layers.tree.next_in_ring[8] = 8; // the ring ends
  const std::vector<Chain> chains = layers.chains();
  BOOST_TEST(chains.size() == 3u);
  BOOST_TEST(chain_of(chains, straight) != chain_of(chains, root));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_decompose_chains

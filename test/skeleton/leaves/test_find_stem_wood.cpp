// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stem wood is identified from the number of points that it supports.

#include <pcs/skeleton/leaves/find_stem_wood.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace test_find_stem_wood {

using pcs::skeleton::Index;
using pcs::skeleton::none;

/// A stem of two components of two points each, below two crowns of eight points each. The last
/// point is unreached.
pcs::skeleton::Layer_tree forked_tree()
{
  pcs::skeleton::Layer_tree tree;
  tree.parent = {none, 0, 1, 1};
  tree.first = {0, 2, 4, 12, 20};
  for (Index v = 0; v < 4; ++v)
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k) {
      tree.point.push_back(k);
      tree.node_of_point.push_back(v);
    }
  tree.node_of_point.push_back(none);
  return tree;
}

BOOST_AUTO_TEST_SUITE(wood_of_stems)

BOOST_AUTO_TEST_CASE(the_stem_supports_most_points)
{
  const std::vector<float> sure(21, 3);
  const std::vector<std::uint8_t> is_stem =
      pcs::skeleton::points_of_stem(forked_tree(), sure, {0.8, 2});
  for (std::size_t i = 0; i < 21; ++i)
    BOOST_TEST(bool(is_stem[i]) == (i < 4), "point " << i);
  // Each crown supports 8 of 20 points.
  const std::vector<std::uint8_t> more =
      pcs::skeleton::points_of_stem(forked_tree(), sure, {0.4, 2});
  for (std::size_t i = 0; i < 21; ++i)
    BOOST_TEST(bool(more[i]) == (i < 20), "point " << i);
  // The component of the fork supports 18 of 20 points.
  const std::vector<std::uint8_t> root =
      pcs::skeleton::points_of_stem(forked_tree(), sure, {0.95, 2});
  for (std::size_t i = 0; i < 21; ++i)
    BOOST_TEST(bool(root[i]) == (i < 2), "point " << i);
}

BOOST_AUTO_TEST_CASE(doubtful_points_are_no_stem)
{
  std::vector<float> score(21, 3);
  score[1] = 1.9f;
  const std::vector<std::uint8_t> is_stem =
      pcs::skeleton::points_of_stem(forked_tree(), score, {0.8, 2});
  BOOST_TEST(bool(is_stem[0]));
  BOOST_TEST(!is_stem[1]);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_find_stem_wood

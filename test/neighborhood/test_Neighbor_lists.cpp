// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares neighbour lists with a brute-force search, and tests the box tree and the kernels.

#include <pcs/neighborhood/Neighbor_lists.h>
#include <support/networks.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <random>

namespace test_Neighbor_lists {

namespace {

using pcs::neighborhood::Box_tree;
using pcs::neighborhood::internal::find_neighbor_lists;
using pcs_test::Points;
using pcs_test::Vec3;
using Any_tag = CGAL::Parallel_if_available_tag;

/// The documented neighbours of point i: the k nearest, and up to 4 ties within 1 % of the
/// distance. Coordinates decide among equal distances.
std::vector<std::uint32_t> expected_row(const Points& points, std::size_t i, std::size_t k)
{
  struct Other
  {
    double squared;
    std::uint32_t index;
  };
  std::vector<Other> others;
  for (std::size_t j = 0; j < points.size(); ++j)
    if (j != i) {
      const Vec3 e = points[j] - points[i];
      others.push_back({e.x() * e.x() + e.y() * e.y() + e.z() * e.z(), std::uint32_t(j)});
    }
  std::sort(others.begin(), others.end(), [&](const Other& a, const Other& b) {
    const Vec3 &p = points[a.index], &q = points[b.index];
    return std::make_tuple(a.squared, p.x(), p.y(), p.z()) <
           std::make_tuple(b.squared, q.x(), q.y(), q.z());
  });
  std::size_t count = std::min(k, others.size());
  const double limit = count > 0 ? 1.01 * 1.01 * others[count - 1].squared : 0;
  while (count < std::min(k + 4, others.size()) && others[count].squared <= limit)
    ++count;
  std::vector<std::uint32_t> row;
  for (std::size_t b = 0; b < count; ++b)
    row.push_back(others[b].index);
  std::sort(row.begin(), row.end());
  return row;
}

void check(const Points& points, std::size_t k)
{
  for (const bool is_ordered : {true, false}) {
    const Points given = is_ordered ? pcs_test::in_spatial_order(points) : points;
    const auto lists = find_neighbor_lists<Any_tag>(given, k);
    BOOST_TEST_REQUIRE(lists.length.size() == given.size());
    std::size_t faults = 0;
    for (std::size_t i = 0; i < given.size(); ++i) {
      std::vector<std::uint32_t> row;
      for (std::size_t b = 0; b < lists.length[i]; ++b)
        row.push_back(lists.at(i, b));
      std::sort(row.begin(), row.end());
      faults += row == expected_row(given, i, k) ? 0 : 1;
    }
    BOOST_TEST(faults == 0u, faults << " rows of " << given.size() << " differ, k = " << k);
  }
}

/// Clusters whose points are 1, 1e-5, 1e-10 ... apart, and points far from all others.
Points clusters_and_outliers()
{
  Points points;
  double scale = 1;
  for (unsigned seed = 1; seed <= 3; ++seed, scale *= 1e-5)
    for (const Vec3& p : pcs_test::random_points(250, seed))
      points.push_back(scale * p + Vec3(3.0 * seed, 0, 0));
  for (int i = 0; i < 12; ++i)
    points.push_back(Vec3(40.0 * i, 30.0 * i * i, -7.0 * i));
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Neighbor_lists)

BOOST_AUTO_TEST_CASE(rows_are_those_of_the_documented_rule)
{
  for (const std::size_t k : {1u, 2u, 6u, 7u, 20u, 60u}) {
    check(pcs_test::random_points(700, 1), k);
    check(clusters_and_outliers(), k);
  }
}

BOOST_AUTO_TEST_CASE(coordinates_decide_among_many_equal_distances)
{
  check(pcs_test::plate(25, 25, 0.1), 6);
  check(pcs_test::box(8, 8, 8, 1. / 3), 7); // more than four ties
  Points ball = pcs_test::sphere(60);       // of which the centre takes ten
  ball.push_back(Vec3::Zero());
  check(ball, 6);
}

BOOST_AUTO_TEST_CASE(scales_of_the_cloud_are_arbitrary)
{
  for (const double scale : {1e-90, 1e-30, 1e30, 1e90}) {
    Points points = pcs_test::random_points(300, 5);
    for (Vec3& p : points)
      p *= scale;
    check(points, 6);
  }
}

BOOST_AUTO_TEST_CASE(small_clouds_have_all_neighbors)
{
  for (const std::size_t n : {0u, 1u, 2u, 5u, 7u, 8u, 17u, 33u})
    check(pcs_test::random_points(n, 6), 6);
}

BOOST_AUTO_TEST_CASE(points_on_a_line_or_in_one_octant_are_found)
{
  Points line, steps;
  for (int i = 0; i < 500; ++i)
    line.push_back(Vec3(1.0 / (1 + i), 0, 0));
  for (int i = 0; i < 60; ++i) // doubles next to each other
    steps.push_back(Vec3(1 + i * 2.220446049250313e-16, 1, 1));
  check(line, 6);
  check(steps, 6);
}

BOOST_AUTO_TEST_CASE(boxes_of_the_tree_contain_their_points)
{
  const Points points = pcs_test::in_spatial_order(pcs_test::random_points(30000, 7));
  Box_tree tree;
  BOOST_TEST(tree.build<Any_tag>(points));
  std::size_t faults = 0, next = 0;
  for (const auto& node : tree.nodes())
    for (std::size_t i = node.begin; i < node.end; ++i)
      faults += node.box.contains(points[i]) ? 0 : 1;
  BOOST_TEST(faults == 0u);
  for (const auto g : tree.groups()) { // consecutive, without gaps
    BOOST_TEST_REQUIRE(tree.nodes()[g].begin == next);
    next = tree.nodes()[g].end;
    BOOST_TEST_REQUIRE(tree.nodes()[g].end - tree.nodes()[g].begin <= Box_tree::largest_group);
  }
  BOOST_TEST(next == points.size());
  std::size_t visited = 0;
  tree.visit_leaves(tree.nodes().front().box,
                    [&](const Box_tree::Node& leaf) { visited += leaf.end - leaf.begin; });
  BOOST_TEST(visited == points.size());
}

BOOST_AUTO_TEST_CASE(the_tree_rejects_points_in_another_order)
{
  const Points points = pcs_test::random_points(2000, 8);
  Box_tree tree;
  BOOST_TEST(!tree.build<Any_tag>(points));
}

BOOST_AUTO_TEST_CASE(kernels_keep_the_smallest_distances_of_each_lane)
{
  using namespace pcs::neighborhood::internal;
  std::mt19937 random(9);
  const auto value = [&] { return static_cast<float>(pcs_test::uniform(random)); };
  constexpr std::size_t n = 150;
  for (const std::size_t count : {1u, 7u, 12u}) {
    float query[24];
    std::generate(std::begin(query), std::end(query), value);
    std::vector<float> candidate[3], smallest(8 * count, 1e30f), all(8 * n);
    for (auto& axis : candidate) {
      axis.resize(n);
      std::generate(axis.begin(), axis.end(), value);
    }
    for (const auto& [begin, end] : {std::make_pair(0, 40), std::make_pair(40, int(n))})
      lane_kernels().measure({query,
                              {candidate[0].data(), candidate[1].data(), candidate[2].data()},
                              std::size_t(begin),
                              std::size_t(end),
                              count,
                              smallest.data(),
                              all.data()});
    float limit[8];
    std::vector<std::uint32_t> index(n);
    for (std::uint32_t j = 0; j < n; ++j)
      index[j] = 1000 + j;
    std::copy_n(smallest.data() + 8 * (count - 1), 8, limit);
    Lane_hits hits;
    hits.find(all.data(), n, limit, index.data());
    for (std::size_t l = 0; l < 8; ++l) {
      std::vector<float> expected;
      for (std::size_t j = 0; j < n; ++j) {
        float sum = 0;
        for (std::size_t c = 0; c < 3; ++c)
          sum += (query[8 * c + l] - candidate[c][j]) * (query[8 * c + l] - candidate[c][j]);
        expected.push_back(sum);
      }
      std::vector<std::uint32_t> nearest;
      std::vector<float> sorted = expected;
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t b = 0; b < count; ++b)
        BOOST_TEST(smallest[8 * b + l] == sorted[b], boost::test_tools::tolerance(1e-6f));
      for (std::uint32_t j = 0; j < n; ++j)
        if (expected[j] < sorted[count - 1] * 1.00001f)
          nearest.push_back(1000 + j);
      BOOST_TEST(std::vector<std::uint32_t>(hits.of_query(l), hits.of_query(l) + hits.count(l)) ==
                     nearest,
                 boost::test_tools::per_element());
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Neighbor_lists

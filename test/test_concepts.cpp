// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the public traits.

#include <pcs/concepts.h>

#include <CGAL/Point_set_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <deque>
#include <functional>
#include <list>
#include <set>
#include <utility>

namespace test_concepts {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Pair = std::pair<Point, Vector>;

struct Nothing
{
};

/// A read-only property map.
struct Const_map
{
  using key_type = Point;
  using value_type = Point;
  using reference = Point;
  using category = boost::readable_property_map_tag;
  [[maybe_unused]] friend Point get(const Const_map&, const Point& p) { return p; }
};

} // namespace

BOOST_AUTO_TEST_SUITE(concepts)

BOOST_AUTO_TEST_CASE(random_access_ranges_are_recognised)
{
  static_assert(pcs::is_random_access_range_v<std::vector<Point>>);
  static_assert(pcs::is_random_access_range_v<const std::vector<Point>>);
  static_assert(pcs::is_random_access_range_v<std::deque<Point>>);
  static_assert(pcs::is_random_access_range_v<std::array<Point, 3>>);
  static_assert(pcs::is_random_access_range_v<Point[3]>);
  static_assert(pcs::is_random_access_range_v<CGAL::Point_set_3<Point>>);
  static_assert(!pcs::is_random_access_range_v<std::list<Point>>);
  static_assert(!pcs::is_random_access_range_v<std::set<int>>);
  static_assert(!pcs::is_random_access_range_v<int>);
  static_assert(!pcs::is_random_access_range_v<Nothing>);
  BOOST_TEST(true, "checked by the compiler");
}

BOOST_AUTO_TEST_CASE(callbacks_graphs_and_point_maps_are_recognised)
{
  using Tree = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;
  using Undirected = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS>;
  static_assert(pcs::is_progress_callback_v<std::function<bool(double)>>);
  static_assert(!pcs::is_progress_callback_v<int> && !pcs::is_progress_callback_v<Nothing>);
  static_assert(pcs::is_tree_graph_v<Tree> && !pcs::is_tree_graph_v<Undirected>);
  static_assert(!pcs::is_tree_graph_v<int> && !pcs::is_tree_graph_v<Nothing>);
  static_assert(pcs::is_readable_point_map_v<Const_map, Point>);
  static_assert(!pcs::is_read_write_point_map_v<Const_map, Point>);
  static_assert(!pcs::is_read_write_tensor_map_v<Const_map, Point>);
  BOOST_TEST(true, "checked by the compiler");
}

BOOST_AUTO_TEST_CASE(points_vectors_and_matrices_are_recognised)
{
  static_assert(pcs::is_point_or_vector_v<Point> && pcs::is_point_or_vector_v<Vector>);
  static_assert(pcs::is_point_or_vector_v<CGAL::Simple_cartesian<float>::Point_3>);
  static_assert(pcs::is_point_or_vector_v<Eigen::Vector3d> &&
                pcs::is_point_or_vector_v<Eigen::Vector3f>);
  static_assert(!pcs::is_point_or_vector_v<Kernel::Point_2>);
  static_assert(!pcs::is_point_or_vector_v<Pair> && !pcs::is_point_or_vector_v<double> &&
                !pcs::is_point_or_vector_v<void>);
  static_assert(pcs::is_matrix_3_v<Eigen::Matrix3d> && pcs::is_matrix_3_v<Eigen::Matrix3f>);
  static_assert(!pcs::is_matrix_3_v<Eigen::Matrix2d> && !pcs::is_matrix_3_v<Eigen::Vector3d> &&
                !pcs::is_matrix_3_v<int>);
  BOOST_TEST(true, "checked by the compiler");
}

BOOST_AUTO_TEST_CASE(maps_are_recognised)
{
  using First = CGAL::First_of_pair_property_map<Pair>;
  static_assert(pcs::is_read_write_map_v<First, Pair&, Point>);
  static_assert(pcs::is_readable_map_v<First, const Pair&, Point>);
  static_assert(!pcs::is_read_write_map_v<First, Pair&, Vector>);
  static_assert(pcs::is_read_write_map_v<CGAL::Identity_property_map<Point>, Point&, Point>);
  static_assert(pcs::is_readable_map_v<Const_map, Point&, Point>);
  static_assert(!pcs::is_read_write_map_v<Const_map, Point&, Point>);
  static_assert(!pcs::is_readable_map_v<Nothing, Point&, Point>);
  static_assert(std::is_void_v<pcs::Map_value<Nothing>>);
  BOOST_TEST(true, "checked by the compiler");
}

BOOST_AUTO_TEST_CASE(index_ranges_are_recognised)
{
  static_assert(pcs::is_index_range_v<std::vector<int>> &&
                pcs::is_index_range_v<std::set<std::size_t>> && pcs::is_index_range_v<int[3]> &&
                pcs::is_index_range_v<std::array<std::uint32_t, 2>>);
  static_assert(!pcs::is_index_range_v<std::vector<double>> &&
                !pcs::is_index_range_v<std::vector<Point>> && !pcs::is_index_range_v<int>);
  BOOST_TEST(true, "checked by the compiler");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_concepts

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Streaming stores write the values of `write()` where the memory permits, and nothing elsewhere.

#include <pcs/Named_function_parameters.h>
#include <pcs/deformation/access/Point_access.h>
#include <pcs/deformation/access/stream_block.h>

#include <CGAL/Point_set_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <array>
#include <deque>
#include <tuple>
#include <utility>
#include <vector>

namespace test_stream_block {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Pair = std::pair<Point, Vector>;
using pcs::deformation::Lane_vectors;
using pcs::deformation::lanes;
using pcs::deformation::Point_access;
namespace parameters = CGAL::parameters;

constexpr std::size_t n = 3 * lanes;
const Pair zeros(Point(0, 0, 0), Vector(0, 0, 0));
constexpr double first_number = 1000, first_of_normals = 2000;

Lane_vectors numbers(double first)
{
  Lane_vectors v;
  for (std::size_t l = 0; l < lanes; ++l)
    for (std::size_t c = 0; c < 3; ++c)
      v.value[c][l] = first + double(3 * l + c);
  return v;
}

/// Expected value of element `i` after the second block of zeros has been written.
template <class Triple>
Triple expected(std::size_t i, double first)
{
  if (i / lanes != 1)
    return Triple(0.0, 0.0, 0.0);
  const double x = first + 3 * double(i - lanes);
  return Triple(x, x + 1, x + 2);
}

template <class Range, class Parameters>
bool stream_second_block(Range& range, const Parameters& np)
{
  const Point_access<Range, Parameters> access(range, np);
  const bool was_streamed = access.stream(lanes, numbers(first_number), numbers(first_of_normals));
  pcs::internal::end_stream();
  return was_streamed;
}

template <class Range>
bool stream_pairs(Range& range)
{
  return stream_second_block(range,
                             parameters::point_map(CGAL::First_of_pair_property_map<Pair>())
                                 .normal_map(CGAL::Second_of_pair_property_map<Pair>()));
}

using Coloured = std::tuple<Point, Vector, int>;
const auto coloured_maps = parameters::point_map(CGAL::Nth_of_tuple_property_map<0, Coloured>())
                               .normal_map(CGAL::Nth_of_tuple_property_map<1, Coloured>());

template <class Range, class Parameters>
bool can_stream(Range& range, const Parameters& np)
{
  return Point_access<Range, Parameters>(range, np).can_stream();
}

/// Property map that counts its calls of put(), which streaming must not bypass.
struct Counting_map
{
  using key_type = Point;
  using value_type = Point;
  using reference = const Point&;
  using category = boost::read_write_property_map_tag;
  friend reference get(const Counting_map&, const Point& p) { return p; }
  friend void put(const Counting_map& map, Point& p, const Point& q)
  {
    p = q;
    ++*map.count;
  }
  int* count;
};

} // namespace

BOOST_AUTO_TEST_SUITE(stream_block)

#if PCS_HAS_STREAMING_STORES

BOOST_AUTO_TEST_CASE(pairs_of_points_and_normals_are_streamed)
{
  std::vector<Pair> pairs(n, zeros);
  BOOST_REQUIRE(stream_pairs(pairs));
  for (std::size_t i = 0; i < n; ++i) {
    BOOST_TEST((pairs[i].first == expected<Point>(i, first_number)));
    BOOST_TEST((pairs[i].second == expected<Vector>(i, first_of_normals)));
  }
}

BOOST_AUTO_TEST_CASE(arrays_of_points_and_of_normals_are_streamed)
{
  CGAL::Point_set_3<Point> points(true);
  for (std::size_t i = 0; i < n; ++i)
    points.insert(Point(0, 0, 0), Vector(0, 0, 0));
  BOOST_REQUIRE(stream_second_block(
      points,
      parameters::point_map(points.point_map()).normal_map(points.normal_map())));
  for (std::size_t i = 0; i < n; ++i) {
    const auto index = *(points.begin() + static_cast<std::ptrdiff_t>(i));
    BOOST_TEST((points.point(index) == expected<Point>(i, first_number)));
    BOOST_TEST((points.normal(index) == expected<Vector>(i, first_of_normals)));
  }
}

BOOST_AUTO_TEST_CASE(points_without_normals_are_streamed)
{
  std::vector<Point> points(n, Point(0, 0, 0));
  BOOST_REQUIRE(stream_second_block(points, parameters::all_default()));
  for (std::size_t i = 0; i < n; ++i)
    BOOST_TEST((points[i] == expected<Point>(i, first_number)));
}

#endif

BOOST_AUTO_TEST_CASE(what_does_not_lie_in_a_row_is_left_alone)
{
  std::vector<Coloured> coloured(n, Coloured(zeros.first, zeros.second, 0));
  BOOST_TEST(!stream_second_block(coloured, coloured_maps));
  for (const auto& c : coloured)
    BOOST_TEST((std::get<0>(c) == Point(0, 0, 0) && std::get<1>(c) == Vector(0, 0, 0)));

  std::deque<Pair> chunks(n, zeros); // of fewer than two blocks
  BOOST_TEST(!stream_pairs(chunks));
  for (const Pair& p : chunks)
    BOOST_TEST((p == zeros));

  // Misaligned by eight bytes for the instruction.
  std::vector<Point> points(n + 1, Point(0, 0, 0));
  auto odd = boost::make_iterator_range(points.begin() + 1, points.end());
  BOOST_TEST(!stream_second_block(odd, parameters::all_default()));
  for (const Point& p : points)
    BOOST_TEST((p == Point(0, 0, 0)));
}

BOOST_AUTO_TEST_CASE(what_are_not_three_doubles_in_memory_is_left_alone)
{
  using Float_point = CGAL::Simple_cartesian<float>::Point_3;
  std::vector<Float_point> floats(n, Float_point(0, 0, 0));
  BOOST_TEST(!stream_second_block(floats, parameters::all_default()));
  std::vector<Eigen::Vector3d> vectors(n,
                                       Eigen::Vector3d::Zero()); // has its own copy function
  BOOST_TEST(!stream_second_block(vectors, parameters::all_default()));
  std::vector<Point> points(n, Point(0, 0, 0));
  int count = 0;
  BOOST_TEST(!stream_second_block(points, parameters::point_map(Counting_map{&count})));
  BOOST_TEST((points == std::vector<Point>(n, Point(0, 0, 0))));
}

BOOST_AUTO_TEST_CASE(only_what_no_cache_keeps_is_streamed)
{
  constexpr std::size_t size = pcs::deformation::smallest_stream / sizeof(Point);
  std::vector<Point> points(size - 1, zeros.first);
  BOOST_TEST(!can_stream(points, parameters::all_default()));
  points.resize(size + 1, zeros.first);
  BOOST_TEST(can_stream(points, parameters::all_default()) == pcs::internal::has_streaming_stores);
  // A range that rejects every block must report that it cannot stream.
  std::vector<Coloured> coloured(size, Coloured(zeros.first, zeros.second, 0));
  BOOST_TEST(!can_stream(coloured, coloured_maps));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_stream_block

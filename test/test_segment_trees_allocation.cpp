// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Memory of the segmentation of a stand.

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/segment_trees.h>
#include <support/allocations.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/tags.h>

#include <boost/iterator/counting_iterator.hpp>
#include <boost/property_map/property_map.hpp>
#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace test_segment_trees_allocation {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

/// Two trees 3 m apart. Beams are so far apart that voxels keep most points.
std::vector<Point> two_trees()
{
  std::vector<Point> points;
  for (const std::uint64_t seed : {1u, 2u}) {
    pcs::Tree_skeleton<Kernel> tree;
    pcs::grow_tree(tree, pcs::broadleaf_habit(), pcs::parameters::random_seed(seed));
    pcs::Virtual_scanner scanner;
    scanner.number_of_stations = 3;
    scanner.distance = 10;
    scanner.angular_step = 0.2 * CGAL_PI / 180;
    scanner.range_noise = 0.004;
    pcs::Virtual_scan<Kernel> scan;
    pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(seed));
    const Kernel::Vector_3 move(3. * double(seed), 0, 0);
    for (const Point& p : scan.points)
      points.push_back(p + move);
  }
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(stand_allocation)

BOOST_AUTO_TEST_CASE(memory_of_a_stand)
{
  const std::vector<Point> points = two_trees();
  const std::size_t n = points.size();
  BOOST_TEST_REQUIRE(n > 30000u);
  std::vector<std::int32_t> tree_of_point(n, -1);
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  const auto indices = boost::make_iterator_range(boost::counting_iterator<std::size_t>(0),
                                                  boost::counting_iterator<std::size_t>(n));
  const long before = pcs_test::allocated_bytes;
  BOOST_TEST(before >= static_cast<long>(n * sizeof(Point))); // bytes are counted
  pcs_test::peak_of_bytes = before;
  // Sequential, since a thread scheduler allocates memory as well.
  const pcs::Segmentation_report report = pcs::segment_trees<CGAL::Sequential_tag>(
      indices,
      boost::make_iterator_property_map(tree_of_point.begin(), identity),
      pcs::parameters::point_map(boost::make_iterator_property_map(points.begin(), identity)));
  BOOST_TEST(report.trees.size() == 2u);
  const double peak = double(pcs_test::peak_of_bytes - before) / double(n);
  BOOST_TEST_MESSAGE("peak: " << peak << " bytes per point");
  BOOST_TEST(peak <= 250);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_segment_trees_allocation

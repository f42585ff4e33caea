// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Leaf blades select the method of level sets; trees, logs and rounded points do not.

#include <pcs/core/Skeleton_report.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <support/blade_plant.h>
#include <support/threads.h>
#include <support/tree_clouds.h>

#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace test_find_leaf_blades {

using pcs_test::Blade_point;
using pcs_test::plant;
using pcs_test::Tree;
namespace np = pcs::parameters;

namespace {

template <class NamedParameters>
pcs::Skeleton_report report_of(const std::vector<Blade_point>& points, const NamedParameters& np)
{
  Tree tree;
  return pcs::extract_tree_skeleton(points, tree, np);
}

pcs::Skeleton_report report_of(const std::vector<Blade_point>& points)
{
  return report_of(points, np::default_values());
}

/// The part of the surface of a bent log that is seen from one side.
std::vector<Blade_point> log_from_one_side(double length, double radius, double bend)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> noise(0, 0.002);
  std::vector<Blade_point> points;
  for (int i = 0; i < 20000; ++i) {
    const double a = 0.8 * CGAL_PI * uniform(random), t = uniform(random);
    const double r = radius + noise(random);
    points.emplace_back(r * std::cos(a) + bend * t * t, r * std::sin(a), length * t);
  }
  return points;
}

std::vector<double> values_of(const Tree& tree)
{
  std::vector<double> values;
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    values.insert(values.end(),
                  {tree[v].point.x(), tree[v].point.y(), tree[v].point.z(), tree[v].radius});
  return values;
}

bool has_warning_of_blades(const pcs::Skeleton_report& report)
{
  for (const std::string& sentence : pcs::warnings(report))
    if (sentence.find("leaf blades are") != std::string::npos)
      return true;
  return false;
}

} // namespace

BOOST_AUTO_TEST_SUITE(leaf_blades)

BOOST_AUTO_TEST_CASE(a_plant_with_blades_is_extracted_by_level_sets)
{
  for (const std::size_t blades : {3u, 7u}) {
    Tree tree, expected;
    const auto report = pcs::extract_tree_skeleton(plant(blades), tree);
    BOOST_TEST((report.method == pcs::Skeleton_method::level_sets));
    BOOST_TEST(report.blade_fraction > 0.1);
    BOOST_TEST(has_warning_of_blades(report));
    pcs::extract_tree_skeleton(plant(blades),
                               expected,
                               np::skeleton_method(pcs::Skeleton_method::level_sets));
    BOOST_TEST(values_of(tree) == values_of(expected));
  }
}

BOOST_AUTO_TEST_CASE(resampled_copies_use_the_method_of_the_scan)
{
  const auto report = report_of(plant(3), np::number_of_resamples(2));
  BOOST_TEST((report.method == pcs::Skeleton_method::level_sets));
  BOOST_TEST(report.blade_fraction > 0.1);
  BOOST_TEST(report.spread.number_of_copies == 2);
  BOOST_TEST(report.spread.height < 0.05 * report.height);
}

BOOST_AUTO_TEST_CASE(trees_with_and_without_leaves_have_no_blades)
{
  for (const double leaves : {0.0, 30.0}) {
    Tree truth;
    pcs::grow_tree(truth, pcs::fruit_habit(), np::random_seed(4));
    pcs::Virtual_scan<pcs_test::Tree_kernel> scan;
    pcs::Virtual_scanner scanner;
    scanner.angular_step = 0.1 * CGAL_PI / 180;
    scanner.leaves_per_length = leaves;
    pcs::scan_tree(truth, scan, scanner, np::random_seed(4));
    const auto report = report_of(scan.points);
    BOOST_TEST((report.method == pcs::Skeleton_method::chains), leaves << " leaves per metre");
    BOOST_TEST(report.blade_fraction == 0);
    BOOST_TEST(!has_warning_of_blades(report));
  }
}

BOOST_AUTO_TEST_CASE(the_bark_of_a_log_is_no_blade)
{
  const auto report = report_of(log_from_one_side(2, 0.2, 0.1));
  BOOST_TEST((report.method == pcs::Skeleton_method::chains));
  BOOST_TEST(report.diameter_at_breast_height > 0.38);
  BOOST_TEST(report.diameter_at_breast_height < 0.42);
}

BOOST_AUTO_TEST_CASE(a_vaulted_object_beside_a_tree_is_no_blade)
{
  std::vector<Blade_point> points = pcs_test::small_scan().scan.points;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> noise(0, 0.002);
  for (int i = 0; i < 6000; ++i) { // a part of a sphere, like the hood of a car
    const double x = 0.6 * uniform(random), y = 0.6 * uniform(random);
    const double z = std::sqrt(1.5 * 1.5 - x * x - y * y) - 1 + noise(random);
    points.emplace_back(2.5 + x, y, z);
  }
  const auto report = report_of(points);
  BOOST_TEST((report.method == pcs::Skeleton_method::chains));
  BOOST_TEST(report.blade_fraction == 0);
}

// Points that are rounded more coarsely than the cells lie in planes.
BOOST_AUTO_TEST_CASE(no_blades_are_searched_among_rounded_points)
{
  std::vector<Blade_point> points = plant(3);
  for (Blade_point& p : points)
    p = Blade_point(p.x(), p.y(), 0.006 * std::round(p.z() / 0.006));
  const auto report = report_of(points);
  BOOST_TEST(std::abs(report.coordinate_step - 0.006) < 1e-6);
  BOOST_TEST((report.method == pcs::Skeleton_method::chains));
}

BOOST_AUTO_TEST_CASE(options_for_wood_exclude_blades)
{
  const std::vector<Blade_point> points = plant(3);
  BOOST_TEST(
      (report_of(points, np::do_remove_leaves(false)).method == pcs::Skeleton_method::chains));
  BOOST_TEST(
      (report_of(points, np::do_remove_ground(false)).method == pcs::Skeleton_method::chains));
  BOOST_TEST((report_of(points, np::skeleton_method(pcs::Skeleton_method::chains)).method ==
              pcs::Skeleton_method::chains));
}

BOOST_AUTO_TEST_CASE(the_result_is_the_same_for_all_numbers_of_threads)
{
  const std::vector<Blade_point> points = plant(4);
  const auto result = [&](auto tag) {
    Tree tree;
    pcs::extract_tree_skeleton<decltype(tag)>(points, tree);
    return values_of(tree);
  };
  const std::vector<double> expected = result(CGAL::Sequential_tag());
  BOOST_TEST_REQUIRE(!expected.empty());
  for (const int count : pcs_test::thread_counts)
    pcs_test::with_threads(count, [&] {
      BOOST_TEST(result(CGAL::Parallel_if_available_tag()) == expected);
    });
}

BOOST_AUTO_TEST_CASE(an_extraction_can_be_cancelled_while_the_method_is_chosen)
{
  const std::vector<Blade_point> points = plant(3);
  for (const int last : {1, 4, 8, 12, 16, 20}) {
    int calls = 0;
    const std::function<bool(double)> callback = [&](double) { return ++calls < last; };
    Tree tree;
    const auto report = pcs::extract_tree_skeleton(points, tree, np::callback(callback));
    BOOST_TEST((report.status == pcs::Status::cancelled || calls < last), "call " << last);
    BOOST_TEST((report.method != pcs::Skeleton_method::automatic), "call " << last);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_find_leaf_blades

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Spread of the descriptors of a skeleton among resampled copies of its scan.

#include <pcs/extract_tree_skeleton.h>
#include <support/exceptions.h>
#include <support/tree_clouds.h>

#include <CGAL/tags.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

namespace test_skeleton_spread {

using pcs_test::append;
using pcs_test::cylinder;
using pcs_test::Tree;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using Cloud = std::vector<Point>;
namespace np = pcs::parameters;

// A densely sampled stem with a branch.
Cloud clear_tree()
{
  Cloud points = cylinder(6000, 0.1, 3);
  append(points, cylinder(1500, 0.03, 1, Point(0.1, 0, 1.8), Vector(1, 0, 0)));
  return points;
}

BOOST_AUTO_TEST_SUITE(tree_skeleton_spread)

BOOST_AUTO_TEST_CASE(there_is_no_spread_unless_it_is_wanted)
{
  Tree tree;
  const pcs::Skeleton_report report = pcs::extract_tree_skeleton(clear_tree(), tree);
  BOOST_TEST(report.spread.number_of_copies == 0u);
  BOOST_TEST(report.spread.volume == 0);
  BOOST_TEST(report.estimates.volume == report.total.volume);
  BOOST_TEST(report.estimates.trunk_volume == report.by_order.front().volume);
}

BOOST_AUTO_TEST_CASE(copies_do_not_change_the_tree)
{
  Tree plain, tree;
  const pcs::Skeleton_report a = pcs::extract_tree_skeleton(clear_tree(), plain);
  const pcs::Skeleton_report b =
      pcs::extract_tree_skeleton(clear_tree(), tree, np::number_of_resamples(2));
  BOOST_TEST(b.spread.number_of_copies == 2u);
  BOOST_TEST(a.total.volume == b.total.volume);
  BOOST_TEST(num_vertices(plain) == num_vertices(tree));
  BOOST_TEST(!b.spread.is_displaced);
}

BOOST_AUTO_TEST_CASE(a_clear_tree_has_a_small_spread_and_no_warning)
{
  Tree tree;
  const pcs::Skeleton_report report =
      pcs::extract_tree_skeleton(clear_tree(), tree, np::number_of_resamples(4));
  BOOST_TEST(report.spread.number_of_copies == 4u);
  BOOST_TEST(report.spread.number_of_empty_copies == 0u);
  BOOST_TEST(report.spread.height > 0);
  BOOST_TEST(report.spread.height < 0.02 * report.height);
  BOOST_TEST(report.spread.diameter_at_breast_height < 0.01 * report.diameter_at_breast_height);
  BOOST_TEST(report.spread.volume < 0.05 * report.total.volume);
  BOOST_TEST(report.spread.root < 0.03);
  for (const std::string& sentence : pcs::warnings(report))
    BOOST_TEST(sentence.find("resampled") == std::string::npos, sentence);
}

BOOST_AUTO_TEST_CASE(most_copies_decide_whether_there_are_leaves)
{
  using pcs::Leaf_removal;
  using pcs::skeleton::majority_on_leaves;
  for (const bool has_leaves : {false, true}) {
    const Leaf_removal opposite = has_leaves ? Leaf_removal::never : Leaf_removal::always;
    for (std::size_t opposed = 0; opposed <= 4; ++opposed) {
      // 4 copies and the scan vote
      const Leaf_removal expected = opposed >= 3 ? opposite : Leaf_removal::where_found;
      BOOST_TEST(
          (majority_on_leaves(4, has_leaves ? 4 - opposed : opposed, has_leaves) == expected));
    }
    BOOST_TEST((majority_on_leaves(0, 0, has_leaves) == Leaf_removal::where_found));
    // a tie of one copy and the scan leaves the decision to the scan
    BOOST_TEST(
        (majority_on_leaves(1, has_leaves ? 0 : 1, has_leaves) == Leaf_removal::where_found));
  }
}

BOOST_AUTO_TEST_CASE(a_changed_decision_on_leaves_is_a_warning)
{
  Tree tree;
  pcs::Skeleton_report report =
      pcs::extract_tree_skeleton(clear_tree(), tree, np::number_of_resamples(2));
  BOOST_TEST(!report.spread.is_leaf_removal_changed);
  BOOST_TEST(report.spread.number_of_leafy_copies == 0u);
  const std::size_t count = pcs::warnings(report).size();
  report.spread.is_leaf_removal_changed = true;
  report.spread.number_of_leafy_copies = 2;
  const std::vector<std::string> sentences = pcs::warnings(report);
  BOOST_TEST_REQUIRE(sentences.size() == count + 1);
  BOOST_TEST(sentences.back().find("2 of 2 resampled copies have leaves") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(figures_that_depend_on_chance_are_named)
{
  // Two equal stems: the choice of the tree depends on single points.
  Cloud points = cylinder(500, 0.1, 3);
  append(points, cylinder(500, 0.1, 3, Point(3, 0, 0), Vector(0, 0, 1)));
  Tree tree;
  const pcs::Skeleton_report report =
      pcs::extract_tree_skeleton(points, tree, np::number_of_resamples(6));
  BOOST_TEST_REQUIRE(report.spread.root > 1);
  std::string all;
  for (const std::string& sentence : pcs::warnings(report))
    all += sentence + '\n';
  BOOST_TEST(all.find("position of the root +- ") != std::string::npos, all);
}

BOOST_AUTO_TEST_CASE(standard_errors_have_a_part_by_chance_and_a_shared_part)
{
  pcs::Skeleton_report report;
  report.by_order.push_back({1, 3, 0.03});
  report.estimates.volume_by_size = {0, 0, 0, 0, 2};
  report.estimates.height = 10;
  BOOST_TEST(pcs::standard_errors(report).height == 0); // no copies
  report.spread.number_of_copies = 4;
  report.spread.fraction = 0.9;
  report.spread.volume_by_size = {0, 0, 0, 0, 0.1};
  const pcs::Tree_values shared = pcs::standard_errors(report);
  BOOST_TEST(shared.height > 0.05);
  BOOST_TEST(shared.height < 0.2);
  report.spread.height = 1;
  const double by_chance =
      std::sqrt(std::pow(pcs::standard_errors(report).height, 2) - std::pow(shared.height, 2));
  BOOST_TEST(by_chance == 3, boost::test_tools::tolerance(1e-9)); // sqrt(0.9 / 0.1)
  BOOST_TEST_REQUIRE(shared.volume_by_size.size() == 5u);
  BOOST_TEST(shared.volume_by_size[4] > 0.3);
  report.spread.fraction = 0.04; // thinned copies vary more than the scan, but not randomly
  const double thinned =
      std::sqrt(std::pow(pcs::standard_errors(report).height, 2) - std::pow(shared.height, 2));
  BOOST_TEST(thinned == 1, boost::test_tools::tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(a_tree_has_standard_errors)
{
  Tree tree;
  const pcs::Skeleton_report report =
      pcs::extract_tree_skeleton(clear_tree(), tree, np::number_of_resamples(4));
  const pcs::Tree_values errors = pcs::standard_errors(report);
  BOOST_TEST(report.spread.fraction == 0.9);
  BOOST_TEST(errors.height >= 3 * report.spread.height);
  BOOST_TEST(errors.trunk_volume > 0);
  BOOST_TEST(errors.trunk_volume <= errors.volume);
  BOOST_TEST(errors.volume_by_size.size() == report.by_size.size());
}

BOOST_AUTO_TEST_CASE(copies_without_a_tree_are_named)
{
  pcs::Skeleton_report report;
  report.status = pcs::Status::converged;
  report.by_order.push_back({1, 3, 0.03});
  report.height = 3;
  report.spread.number_of_empty_copies = 4;
  std::string all;
  for (const std::string& sentence : pcs::warnings(report))
    all += sentence + '\n';
  BOOST_TEST(all.find("4 resampled copies of this scan show no tree") != std::string::npos, all);
}

BOOST_AUTO_TEST_CASE(values_that_may_differ_by_more_than_the_goals_are_named)
{
  pcs::Skeleton_report report;
  report.status = pcs::Status::converged;
  report.by_order.push_back({1, 10, 0.1});
  report.total = report.by_order.front();
  report.height = 10;
  report.estimates.volume = report.total.volume;
  report.spread.number_of_copies = 4;
  const auto names_volume = [&report](double deviation) {
    report.spread.volume = deviation * report.total.volume;
    std::string all;
    for (const std::string& sentence : pcs::warnings(report))
      all += sentence + '\n';
    return all.find("different values (one standard deviation): volume") != std::string::npos;
  };
  BOOST_TEST(!names_volume(0.012)); // 3.93 times the deviation is 4.7 %
  BOOST_TEST(names_volume(0.013));  // 5.1 %
}

BOOST_AUTO_TEST_CASE(the_spread_does_not_depend_on_threads)
{
  const Cloud points = clear_tree();
  Tree tree;
  const pcs::Skeleton_spread a =
      pcs::extract_tree_skeleton<CGAL::Sequential_tag>(points, tree, np::number_of_resamples(2))
          .spread;
  const pcs::Skeleton_spread b =
      pcs::extract_tree_skeleton(points, tree, np::number_of_resamples(2)).spread;
  BOOST_TEST(a.volume == b.volume);
  BOOST_TEST(a.diameter_at_breast_height == b.diameter_at_breast_height);
  BOOST_TEST(a.root == b.root);
}

BOOST_AUTO_TEST_CASE(a_cancelled_estimate_continues)
{
  const Cloud points = clear_tree();
  Tree tree;
  const pcs::Skeleton_report expected =
      pcs::extract_tree_skeleton(points, tree, np::number_of_resamples(3));
  double limit = 0.6, last = 0; // while copies are extracted
  const auto callback = [&](double f) {
    BOOST_TEST(f >= last);
    last = f;
    return f < limit;
  };
  const auto parameters = np::number_of_resamples(3).callback(callback);
  pcs::Tree_skeletonization<Cloud, std::decay_t<decltype(parameters)>> work(points, parameters);
  BOOST_CHECK(work.extract(tree).status == pcs::Status::cancelled);
  limit = 2;
  last = 0;
  const pcs::Skeleton_report report = work.extract(tree);
  BOOST_TEST(report.spread.number_of_copies == 3u);
  BOOST_TEST(report.spread.volume == expected.spread.volume);
  BOOST_TEST(report.estimates.volume == expected.estimates.volume);
}

BOOST_AUTO_TEST_CASE(copies_keep_nine_tenths_of_small_scans_and_thin_large_ones)
{
  using pcs::skeleton::resample_scan;
  using pcs::skeleton::Vec3;
  const pcs::skeleton::Scan_points small{std::vector<Vec3>(1000, Vec3::Zero()),
                                         std::vector<std::uint8_t>(1000, 1),
                                         {},
                                         {}};
  const auto first = resample_scan(small, 0), second = resample_scan(small, 1);
  BOOST_TEST(first.positions.size() > 850u);
  BOOST_TEST(first.positions.size() < 950u);
  BOOST_TEST(first.positions.size() == first.is_wood.size());
  BOOST_TEST(first.positions.size() != second.positions.size());
  BOOST_TEST(first.stations.empty());
  const pcs::skeleton::Scan_points large{std::vector<Vec3>(400000, Vec3::Zero()), {}, {}, {}};
  const auto thinned = resample_scan(large, 0);
  BOOST_TEST(thinned.positions.size() > 39000u);
  BOOST_TEST(thinned.positions.size() < 41000u);
}

BOOST_AUTO_TEST_CASE(a_scan_of_few_points_has_no_copies)
{
  const Cloud points = cylinder(99, 0.1, 1);
  Tree tree;
  const pcs::Skeleton_report report =
      pcs::extract_tree_skeleton(points, tree, np::number_of_resamples(5));
  BOOST_CHECK(report.status == pcs::Status::converged);
  BOOST_TEST(report.spread.number_of_copies == 0u);
  BOOST_TEST(report.spread.number_of_empty_copies == 0u);
}

BOOST_AUTO_TEST_CASE(a_negative_number_of_copies_is_refused)
{
  Tree tree;
  BOOST_CHECK_EXCEPTION(pcs::extract_tree_skeleton(clear_tree(), tree, np::number_of_resamples(-1)),
                        pcs::Invalid_input,
                        pcs_test::message_has("number_of_resamples is -1"));
}

BOOST_AUTO_TEST_CASE(the_distance_from_the_copies_is_in_tolerances)
{
  pcs::Skeleton_report report;
  report.height = 10;
  report.diameter_at_breast_height = 0.2;
  report.by_order = {{1, 9, 0.3}};
  report.total = {10, 50, 0.5};
  report.breast_height = 1.3;
  const pcs::skeleton::Vec3 root(0, 0, 0);
  pcs::skeleton::Copy_descriptors figures;
  BOOST_TEST(figures.distance_from_medians(report, root) == 0);
  for (int k = 0; k < 4; ++k)
    figures.add(report, root);
  BOOST_TEST(figures.distance_from_medians(report, root) == 0);
  pcs::Skeleton_report other = report;
  other.by_order.front().length = 6; // 3 m of 6 m are 50 %, the tolerance is 5 %
  BOOST_CHECK_CLOSE(figures.distance_from_medians(other, root), 10, 1e-6);
  other = report;
  other.height = 10.2;
  BOOST_CHECK_CLOSE(figures.distance_from_medians(other, root), 0.2 / 0.102, 1e-6);
  BOOST_CHECK_CLOSE(figures.distance_from_medians(report, pcs::skeleton::Vec3(0, 0.13, 0)),
                    0.13 / 0.052,
                    1e-6);
  other = report; // one copy that differs has no influence
  other.total.volume = 5;
  pcs::skeleton::Copy_descriptors mixed;
  mixed.add(other, root);
  for (int k = 0; k < 3; ++k)
    mixed.add(report, root);
  BOOST_TEST(mixed.distance_from_medians(report, root) == 0);
}

BOOST_AUTO_TEST_CASE(displacements_are_bounded_and_depend_on_the_seed)
{
  std::vector<pcs::skeleton::Vec3> points;
  for (int i = 0; i < 50; ++i)
    points.emplace_back(i, 2, 3);
  auto a = points, b = points, c = points;
  pcs::skeleton::displace_points(a, 0.01, 1);
  pcs::skeleton::displace_points(b, 0.01, 1);
  pcs::skeleton::displace_points(c, 0.01, 2);
  BOOST_TEST((a == b));
  BOOST_TEST((a != c));
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, (a[i] - points[i]).cwiseAbs().maxCoeff());
  BOOST_TEST(largest <= 0.01);
  BOOST_TEST(largest > 0.005);
}

BOOST_AUTO_TEST_CASE(equal_points_are_displaced_equally)
{
  std::vector<pcs::skeleton::Vec3> points = {{0, 1, 2}, {-0.0, 1, 2}, {0, 1, 2}, {2, 1, 0}};
  pcs::skeleton::displace_points(points, 0.01, 1);
  BOOST_TEST((points[0] == points[1]));
  BOOST_TEST((points[0] == points[2]));
  BOOST_TEST(
      (points[0] - pcs::skeleton::Vec3(0, 1, 2) != points[3] - pcs::skeleton::Vec3(2, 1, 0)));
}

BOOST_AUTO_TEST_CASE(a_displaced_scan_has_the_rounding_and_duplicates_of_the_input)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  Cloud points;
  const auto rounded = [&](double scale) { return std::round(64 * scale * uniform(random)) / 64; };
  for (int i = 0; i < 1500; ++i) {
    const double x = rounded(1), y = rounded(1), z = rounded(4);
    points.emplace_back(x, y, z);
  }
  points.insert(points.end(), points.begin(), points.begin() + 100);
  Tree tree;
  const auto plain = pcs::extract_tree_skeleton(points, tree);
  const auto report = pcs::extract_tree_skeleton(points, tree, np::number_of_resamples(2));
  BOOST_TEST_REQUIRE(report.spread.is_displaced);
  BOOST_TEST(plain.coordinate_step == 1.0 / 64);
  BOOST_TEST(report.coordinate_step == plain.coordinate_step);
  BOOST_TEST(report.number_of_duplicates == plain.number_of_duplicates);
}

// Random points have random skeletons, which differ much from those of most copies.
Cloud random_points(unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Cloud points;
  for (int i = 0; i < 1500; ++i) {
    const double x = uniform(random), y = uniform(random), z = 4 * uniform(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

BOOST_AUTO_TEST_CASE(uncertain_medians_need_more_copies_which_give_estimates)
{
  const Cloud points = random_points(1);
  Tree tree;
  const auto report = pcs::extract_tree_skeleton(points, tree, np::number_of_resamples(2));
  BOOST_TEST(report.spread.number_of_copies + report.spread.number_of_empty_copies == 8u);
  // They and displaced points give the estimates.
  BOOST_TEST(report.estimates.volume != report.total.volume);
  BOOST_TEST(report.estimates.volume_by_size.size() == report.by_size.size());
  // among values with the standard deviation of the spread
  BOOST_TEST(std::abs(report.estimates.volume - report.total.volume) < 3 * report.spread.volume);
}

BOOST_AUTO_TEST_CASE(estimates_are_medians)
{
  pcs::Skeleton_report report;
  report.by_order.resize(1);
  report.by_size.resize(2);
  pcs::skeleton::Copy_descriptors skeletons;
  for (const double value : {1, 9, 2, 3, 1}) {
    report.height = report.diameter_at_breast_height = value;
    report.total.length = report.total.volume = value;
    report.by_order[0].length = report.by_order[0].volume = value;
    report.by_size[1].volume = value;
    skeletons.add(report, pcs::skeleton::Vec3::Zero());
  }
  const pcs::Tree_values e = skeletons.estimates();
  for (const double value : {e.height,
                             e.diameter_at_breast_height,
                             e.trunk_length,
                             e.length,
                             e.volume,
                             e.trunk_volume,
                             e.volume_by_size.at(1)})
    BOOST_TEST(value == 2);
  BOOST_TEST(e.volume_by_size.at(0) == 0);
}

BOOST_AUTO_TEST_CASE(estimates_of_large_scans_are_the_values_of_the_skeleton)
{
  Tree tree;
  const Cloud points = cylinder(82000, 0.1, 3); // copies have less than half of the points
  const auto report = pcs::extract_tree_skeleton(points, tree, np::number_of_resamples(1));
  BOOST_TEST(report.spread.number_of_copies == 1u);
  BOOST_TEST(report.estimates.volume == report.total.volume);
}

BOOST_AUTO_TEST_CASE(large_scans_have_fewer_additional_copies)
{
  using pcs::skeleton::largest_number_of_copies;
  BOOST_TEST(largest_number_of_copies(0, 4) == 16u);
  BOOST_TEST(largest_number_of_copies(10000, 4) == 16u);
  BOOST_TEST(largest_number_of_copies(30000, 4) == 7u);
  BOOST_TEST(largest_number_of_copies(1000000, 4) == 5u);
  BOOST_TEST(largest_number_of_copies(1000000, 10) == 10u);
  BOOST_TEST(largest_number_of_copies(1000, 0) == 0u);
}

BOOST_AUTO_TEST_CASE(medians_of_more_copies_are_more_certain)
{
  pcs::Skeleton_report report;
  report.breast_height = 1.3;
  pcs::skeleton::Copy_descriptors copies;
  BOOST_TEST(copies.error_of_medians(report) == 0);
  const auto add = [&](double height) {
    report.height = height;
    copies.add(report, pcs::skeleton::Vec3::Zero());
  };
  for (int k = 0; k < 2; ++k) {
    add(9.9);
    add(10.1);
  }
  report.height = 10;
  const double error = copies.error_of_medians(report); // of a tolerance of 0.1
  BOOST_TEST(error == 0.5 * std::sqrt(std::acos(-1.0) / 2) * std::sqrt(4.0 / 3),
             boost::test_tools::tolerance(1e-9));
  for (int k = 0; k < 6; ++k) {
    add(9.9);
    add(10.1);
  }
  report.height = 10;
  BOOST_TEST(copies.error_of_medians(report) < 0.5 * error);
}

BOOST_AUTO_TEST_CASE(an_untypical_skeleton_is_replaced)
{
  Cloud points;
  Tree plain, tree;
  std::size_t calls = 0;
  pcs::Skeleton_report report;
  for (unsigned seed = 1; seed <= 12 && !report.spread.is_displaced; ++seed) {
    points = random_points(seed); // not all displaced scans are more typical
    calls = 0;
    const auto np = np::number_of_resamples(2).callback([&](double) {
      ++calls;
      return true;
    });
    report = pcs::extract_tree_skeleton(points, tree, np);
  }
  BOOST_TEST_REQUIRE(report.spread.is_displaced);
  pcs::extract_tree_skeleton(points, plain);
  BOOST_TEST(num_vertices(tree) != num_vertices(plain));

  // stopped in each part of the work, the calls together give the same tree
  std::size_t allowed = 0;
  pcs::Tree_skeletonization stages(points, np::number_of_resamples(2).callback([&](double) {
    return allowed-- > 0;
  }));
  Tree stopped;
  std::size_t stops = 0;
  do {
    allowed = calls / 7;
    ++stops;
  } while (stages.extract(stopped).status == pcs::Status::cancelled && stops < 100);
  BOOST_TEST(stops > 2u);
  BOOST_TEST_REQUIRE(num_vertices(stopped) == num_vertices(tree));
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    BOOST_TEST((stopped[v].point == tree[v].point));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_skeleton_spread

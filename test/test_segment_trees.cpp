// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests segment_trees() on stands of virtual trees with touching crowns, with and without ground,
// and on clouds without a stem.

#include <pcs/core/errors.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/segment_trees.h>
#include <support/exceptions.h>
#include <support/threads.h>
#include <support/tree_clouds.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace test_segment_trees {

using pcs_test::append;
using pcs_test::cylinder;
using pcs_test::Jitter;
using pcs_test::small_scan;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using Cloud = std::vector<Point>;
using Labels = std::vector<std::size_t>;

namespace {

constexpr std::size_t no_tree = 1000; // true label of the ground

/// Touching trees, on a level floor or on a slope.
struct Stand
{
  Cloud points;
  Labels truth;
  std::vector<Point> feet;

  Stand(const std::vector<Vector>& places, double slope)
  {
    const auto& scan = small_scan();
    for (std::size_t t = 0; t < places.size(); ++t) {
      const double c = std::cos(2.1 * double(t)), s = std::sin(2.1 * double(t));
      const Vector place = places[t] + Vector(0, 0, slope * places[t].x());
      feet.push_back(CGAL::ORIGIN + place);
      for (std::size_t i = 0; i < scan.scan.points.size(); ++i) {
        if (scan.scan.node[i] < 0)
          continue;
        const Point& p = scan.scan.points[i];
        points.push_back(Point(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()) + place);
        truth.push_back(t);
      }
    }
  }

  void add_ground(double slope)
  {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> side(-4, 6);
    std::normal_distribution<double> noise(0, 0.005);
    for (int i = 0; i < 60000; ++i) {
      const double x = side(random), y = side(random);
      points.emplace_back(x, y, slope * x + noise(random));
      truth.push_back(no_tree);
    }
  }
};

Stand three_trees(double slope = 0)
{
  return Stand({Vector(0, 0, 0), Vector(1.7, 0.3, 0), Vector(0.5, 1.9, 0)}, slope);
}

template <class ConcurrencyTag = CGAL::Parallel_if_available_tag>
pcs::Segmentation_report
segment(const Cloud& points, Labels& trees, double breast_height = pcs::default_breast_height)
{
  trees.assign(points.size(), no_tree);
  std::vector<std::size_t> indices(points.size());
  std::iota(indices.begin(), indices.end(), 0);
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  return pcs::segment_trees<ConcurrencyTag>(
      indices,
      boost::make_iterator_property_map(trees.begin(), identity),
      pcs::parameters::point_map(boost::make_iterator_property_map(points.begin(), identity))
          .breast_height(breast_height));
}

/// The tree of the report with the nearest foot.
std::size_t
nearest_tree(const pcs::Segmentation_report& report, const Point& foot, double& distance)
{
  std::size_t best = no_tree;
  distance = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < report.trees.size(); ++t) {
    const std::array<double, 3>& f = report.trees[t].foot;
    const double d = std::sqrt(CGAL::squared_distance(Point(f[0], f[1], f[2]), foot));
    if (d < distance) {
      distance = d;
      best = t;
    }
  }
  return best;
}

/// Fractions of the tree points that are assigned to their tree, and of the other points that are
/// assigned to a tree.
std::pair<double, double>
shares(const Stand& stand, const Labels& trees, const pcs::Segmentation_report& report)
{
  Labels found;
  for (const Point& foot : stand.feet) {
    double distance = 0;
    found.push_back(nearest_tree(report, foot, distance));
  }
  std::array<double, 2> right{}, all{};
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const bool is_ground = stand.truth[i] == no_tree;
    all[is_ground] += 1;
    right[is_ground] += is_ground ? trees[i] != pcs::npos : trees[i] == found[stand.truth[i]];
  }
  return {right[0] / all[0], all[1] > 0 ? right[1] / all[1] : 0};
}

/// A pole with its base at `height`; `top` is the ratio of the radii at the top and at the base.
Cloud pole(double height, double length = 3, double top = 0.7)
{
  Cloud points = cylinder(6000, 0.05, length);
  for (Point& p : points) {
    const double taper = 1 - (1 - top) * p.z() / length;
    p = Point(taper * p.x(), taper * p.y(), height + p.z());
  }
  return Jitter(0.001)(points);
}

Cloud level_floor()
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(-3, 3);
  std::normal_distribution<double> noise(0, 0.001);
  Cloud points;
  for (int i = 0; i < 3000; ++i)
    points.emplace_back(side(random), side(random), noise(random));
  return points;
}

/// A pole that bends over at its top and hangs down again.
Cloud crook()
{
  const double length = 5, straight = 2, bend = 0.4;
  Cloud points = pole(0, length, 0.3);
  for (Point& p : points) {
    const double angle = std::min(std::max(p.z() - straight, 0.0) / bend, CGAL_PI);
    const double x = bend * (1 - std::cos(angle)),
                 z = std::min(p.z(), straight) + bend * std::sin(angle) -
                     std::max(0.0, p.z() - straight - CGAL_PI * bend);
    p = Point(x + p.x() * std::cos(angle), p.y(), z - p.x() * std::sin(angle));
  }
  return points;
}

/// Fraction of the tree points near the feet that are assigned to a tree.
double share_of_feet(const Stand& stand, const Labels& trees)
{
  std::size_t all = 0, given = 0;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    if (stand.truth[i] == no_tree)
      continue;
    const Vector d = stand.points[i] - stand.feet[stand.truth[i]];
    if (d.z() > 0.3 || std::hypot(d.x(), d.y()) > 0.3)
      continue;
    ++all;
    given += trees[i] != pcs::npos;
  }
  return double(given) / double(all);
}

void check_counts(const pcs::Segmentation_report& report, const Labels& trees)
{
  BOOST_TEST(report.number_of_points == trees.size());
  BOOST_TEST(report.number_of_unassigned_points ==
             std::size_t(std::count(trees.begin(), trees.end(), pcs::npos)));
  for (std::size_t t = 0; t < report.trees.size(); ++t)
    BOOST_TEST(report.trees[t].number_of_points ==
               std::size_t(std::count(trees.begin(), trees.end(), t)));
}

} // namespace

BOOST_AUTO_TEST_SUITE(segment_trees)

BOOST_AUTO_TEST_CASE(implausible_trees_are_named)
{
  pcs::Segmentation_report report;
  report.breast_height = 1.3;
  report.trees.resize(3);
  for (pcs::Segmented_tree& tree : report.trees) {
    tree.radius = 0.2;
    tree.height = 15;
  }
  BOOST_TEST(pcs::warnings(report).empty());
  report.trees[1].radius = 4.7;
  report.trees[2].height = 0.9;
  const std::vector<std::string> sentences = pcs::warnings(report);
  BOOST_REQUIRE(sentences.size() == 2u);
  BOOST_TEST(sentences[0].find("1 tree(s) lower than breast height") == 0u);
  BOOST_TEST(sentences[0].find("number 2") != std::string::npos);
  BOOST_TEST(sentences[1].find("too thick for the height") != std::string::npos);
  BOOST_TEST(sentences[1].find("number 1") != std::string::npos);
  report.trees[0].diameter_at_breast_height = 1.8; // of a tree of 15 m
  BOOST_TEST(pcs::warnings(report)[1].find("number 0, 1") != std::string::npos);
  const auto reasons = pcs::warnings_of_trees(report);
  BOOST_TEST_REQUIRE(reasons.size() == 3u);
  for (std::size_t t = 0; t < 3; ++t) {
    BOOST_TEST_REQUIRE(reasons[t].size() == 1u);
    BOOST_TEST((reasons[t][0].find("too thick") != std::string::npos) == (t < 2));
  }
}

BOOST_AUTO_TEST_CASE(feet_far_above_the_ground_are_named)
{
  pcs::Segmentation_report report;
  report.breast_height = 1.3;
  report.trees.resize(2);
  for (pcs::Segmented_tree& tree : report.trees) {
    tree.radius = 0.1;
    tree.height = 10;
    tree.foot_above_ground = 0.3;
  }
  BOOST_TEST(pcs::warnings(report).empty());
  report.trees[1].foot_above_ground = 1.5;
  const std::vector<std::string> sentences = pcs::warnings(report);
  BOOST_TEST_REQUIRE(sentences.size() == 1u);
  BOOST_TEST(sentences[0].find("1 tree(s) with a stem that begins far above the ground") == 0u);
  BOOST_TEST(sentences[0].find("number 1") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(posts_and_walls_are_named)
{
  pcs::Segmentation_report report;
  report.breast_height = 1.3;
  for (const std::array<double, 3>& deviations :
       {std::array<double, 3>{0.6, 0.8, 2.0}, {0.07, 0.08, 0.9}, {0.02, 1.1, 2.0}}) {
    pcs::Segmented_tree tree;
    tree.height = 8;
    tree.radius = 0.1;
    tree.deviations = deviations;
    report.trees.push_back(tree);
  }
  const auto reasons = pcs::warnings_of_trees(report);
  BOOST_TEST_REQUIRE(reasons.size() == 3u);
  BOOST_TEST(reasons[0].empty());
  BOOST_TEST_REQUIRE(reasons[1].size() == 1u);
  BOOST_TEST(reasons[1][0].find("posts") != std::string::npos);
  BOOST_TEST_REQUIRE(reasons[2].size() == 1u);
  BOOST_TEST(reasons[2][0].find("walls") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_post_is_a_tree_without_a_crown)
{
  // a post of 3 m, and a tree with two horizontal branches
  Cloud points = cylinder(3000, 0.1, 3);
  append(points, cylinder(3000, 0.1, 3, Point(6, 0, 0), Vector(0, 0, 1)));
  append(points, cylinder(2000, 0.04, 2, Point(6, 0, 2.5), Vector(1, 0.2, 0.3)));
  append(points, cylinder(2000, 0.04, 2, Point(6, 0, 2.5), Vector(-0.2, -1, 0.3)));
  Labels trees;
  const auto report = segment(points, trees);
  BOOST_TEST_REQUIRE(report.trees.size() == 2u);
  const auto reasons = pcs::warnings_of_trees(report);
  for (std::size_t t = 0; t < 2; ++t)
    BOOST_TEST(reasons[t].size() == (report.trees[t].foot[0] < 3 ? 1u : 0u));
}

BOOST_AUTO_TEST_CASE(trees_too_thin_for_their_height_are_named)
{
  pcs::Segmentation_report report;
  report.breast_height = 1.3;
  for (const double diameter : {0.06, 0.02, 0.0}) { // 0: not known
    pcs::Segmented_tree tree;
    tree.height = 8;
    tree.radius = 0.05;
    tree.diameter_at_breast_height = diameter;
    report.trees.push_back(tree);
  }
  const auto reasons = pcs::warnings_of_trees(report);
  BOOST_TEST(reasons[0].empty());
  BOOST_REQUIRE(reasons[1].size() == 1u);
  BOOST_TEST(reasons[1][0].find("with a diameter at breast height too small") == 0u);
  BOOST_TEST(reasons[2].empty());
}

BOOST_AUTO_TEST_CASE(trees_thicker_than_others_of_the_same_height_are_named)
{
  pcs::Segmentation_report report;
  report.breast_height = 1.3;
  report.trees.resize(5);
  for (pcs::Segmented_tree& tree : report.trees) {
    tree.radius = 0.2;
    tree.height = 25;
    tree.diameter_at_breast_height = 0.4;
  }
  BOOST_TEST(pcs::warnings(report).empty());
  report.trees[3].diameter_at_breast_height = 1.3; // of 25 m: shrubs around the stem
  const std::vector<std::string> sentences = pcs::warnings(report);
  BOOST_TEST_REQUIRE(sentences.size() == 1u);
  BOOST_TEST(sentences[0].find("1 tree(s) thicker at breast height") == 0u);
  BOOST_TEST(sentences[0].find("number 3") != std::string::npos);
  for (pcs::Segmented_tree& tree : report.trees)
    tree.diameter_at_breast_height = 1.3; // a stand of stout trees
  BOOST_TEST(pcs::warnings(report).empty());
}

BOOST_AUTO_TEST_CASE(trees_that_end_far_below_others_are_named)
{
  pcs::Segmentation_report report;
  report.breast_height = 1.3;
  report.trees.resize(5);
  for (std::size_t t = 0; t < 5; ++t) {
    report.trees[t].radius = 0.2 - 0.01 * double(t);
    report.trees[t].height = 15 - double(t);
  }
  BOOST_TEST(pcs::warnings(report).empty());
  report.trees[1].height = 7; // the top is missing
  const std::vector<std::string> sentences = pcs::warnings(report);
  BOOST_TEST_REQUIRE(sentences.size() == 1u);
  BOOST_TEST(sentences[0].find("1 tree(s) much lower than others") == 0u);
  BOOST_TEST(sentences[0].find("number 1") != std::string::npos);
  report.trees[1].radius = 0.1; // a young tree
  BOOST_TEST(pcs::warnings(report).empty());
}

BOOST_AUTO_TEST_CASE(touching_trees_are_told_apart)
{
  for (const double slope : {0.0, 0.4}) {
    const Stand stand = three_trees(slope);
    Labels trees;
    const auto report = segment(stand.points, trees);
    BOOST_TEST((report.status == pcs::Status::converged));
    BOOST_TEST_REQUIRE(report.trees.size() == 3u);
    check_counts(report, trees);
    for (const Point& foot : stand.feet) {
      double distance = 0;
      nearest_tree(report, foot, distance);
      BOOST_TEST(distance < 0.25, "a foot is " << distance << " away");
    }
    const double right = shares(stand, trees, report).first;
    BOOST_TEST(right > 0.97, "slope " << slope << ": " << right);
  }
}

BOOST_AUTO_TEST_CASE(ground_is_no_trees)
{
  for (const double slope : {0.0, 0.4}) {
    Stand stand = three_trees(slope);
    stand.add_ground(slope);
    Labels trees;
    const auto report = segment(stand.points, trees);
    BOOST_TEST_REQUIRE(report.trees.size() == 3u);
    const auto [right, ground] = shares(stand, trees, report);
    BOOST_TEST(right > 0.96, "slope " << slope << ": " << right);
    BOOST_TEST(ground < 0.01, "slope " << slope << ": " << ground);
    const double feet = share_of_feet(stand, trees);
    BOOST_TEST(feet > 0.93, "slope " << slope << ": " << feet);
  }
}

BOOST_AUTO_TEST_CASE(a_tree_alone_keeps_its_points)
{
  const Stand stand({Vector(0, 0, 0)}, 0);
  Labels trees;
  const auto report = segment(stand.points, trees);
  BOOST_TEST_REQUIRE(report.trees.size() == 1u);
  BOOST_TEST(report.trees[0].number_of_points > 0.99 * double(stand.points.size()));
  BOOST_TEST(std::abs(report.trees[0].radius - small_scan().truth[0].radius) <
             0.5 * small_scan().truth[0].radius);
}

BOOST_AUTO_TEST_CASE(a_segmented_tree_has_the_skeleton_of_the_tree_alone)
{
  const Stand stand = three_trees();
  Labels trees;
  const auto report = segment(stand.points, trees);
  double distance = 0;
  const std::size_t tree = nearest_tree(report, stand.feet[0], distance);
  Cloud own, alone;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    if (trees[i] == tree)
      own.push_back(stand.points[i]);
    if (stand.truth[i] == 0)
      alone.push_back(stand.points[i]);
  }
  pcs_test::Tree of_own, of_alone;
  const auto found = pcs::extract_tree_skeleton(own, of_own);
  const auto wanted = pcs::extract_tree_skeleton(alone, of_alone);
  BOOST_TEST(found.total.length == wanted.total.length, boost::test_tools::tolerance(0.05));
  BOOST_TEST(found.total.volume == wanted.total.volume, boost::test_tools::tolerance(0.05));
}

BOOST_AUTO_TEST_CASE(neither_threads_nor_order_change_anything)
{
  const Stand stand = three_trees();
  Labels expected;
  const auto report = segment<CGAL::Sequential_tag>(stand.points, expected);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      Labels trees;
      const auto other = segment(stand.points, trees);
      BOOST_TEST((trees == expected));
      BOOST_TEST((other.trees[0].foot == report.trees[0].foot));
    });

  std::vector<std::size_t> order(stand.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  Cloud shuffled;
  for (const std::size_t i : order)
    shuffled.push_back(stand.points[i]);
  Labels trees;
  segment(shuffled, trees);
  std::size_t different = 0;
  for (std::size_t k = 0; k < order.size(); ++k)
    different += trees[k] != expected[order[k]];
  BOOST_TEST(different == 0u);
}

BOOST_AUTO_TEST_CASE(calls_in_two_threads_give_the_bits_of_calls_alone)
{
  const Stand stand = three_trees();
  Cloud inputs[2] = {{}, pole(0)};
  for (std::size_t i = 0; i < stand.points.size(); i += 8)
    inputs[0].push_back(stand.points[i]);
  Labels alone[2];
  pcs::Segmentation_report expected[2];
  for (int k = 0; k < 2; ++k)
    expected[k] = segment(inputs[k], alone[k]);
  BOOST_TEST(expected[0].trees.size() == 3u);
  for (const bool is_same_input : {false, true}) {
    Labels trees[2];
    pcs::Segmentation_report reports[2];
    pcs_test::in_two_threads(
        [&](int k) { reports[k] = segment(inputs[is_same_input ? 0 : k], trees[k]); });
    for (int k = 0; k < 2; ++k) {
      const int of = is_same_input ? 0 : k;
      BOOST_TEST((trees[k] == alone[of]));
      BOOST_TEST_REQUIRE(reports[k].trees.size() == expected[of].trees.size());
      for (std::size_t t = 0; t < reports[k].trees.size(); ++t)
        BOOST_TEST((reports[k].trees[t].foot == expected[of].trees[t].foot));
    }
  }
}

BOOST_AUTO_TEST_CASE(copies_of_points_have_the_tree_of_the_points)
{
  const Stand stand = three_trees();
  Cloud points;
  for (std::size_t i = 0; i < stand.points.size(); i += 8)
    points.push_back(stand.points[i]);
  const std::size_t n = points.size();
  Labels once, twice;
  const auto report = segment(points, once);
  BOOST_TEST_REQUIRE(report.trees.size() == 3u);
  append(points, Cloud(points));
  BOOST_TEST(segment(points, twice).trees.size() == 3u);
  BOOST_TEST((Labels(twice.begin(), twice.begin() + std::ptrdiff_t(n)) == once));
  BOOST_TEST((Labels(twice.begin() + std::ptrdiff_t(n), twice.end()) == once));
}

BOOST_AUTO_TEST_CASE(units_and_far_coordinates_do_not_matter)
{
  const Stand stand = three_trees();
  Labels expected;
  const auto report = segment(stand.points, expected);
  const Vector far(5e5, 5e6, 300);
  Stand other = stand;
  for (Point& p : other.points)
    p = CGAL::ORIGIN + 1000 * (p - CGAL::ORIGIN) + far;
  for (Point& p : other.feet)
    p = CGAL::ORIGIN + 1000 * (p - CGAL::ORIGIN) + far;
  Labels trees;
  const auto scaled = segment(other.points, trees, 1300);
  BOOST_TEST_REQUIRE(scaled.trees.size() == report.trees.size());
  BOOST_TEST(shares(other, trees, scaled).first > 0.97);
}

BOOST_AUTO_TEST_CASE(up_may_be_another_axis)
{
  Stand stand = three_trees();
  for (Point& p : stand.points)
    p = Point(p.z(), p.x(), p.y());
  for (Point& p : stand.feet)
    p = Point(p.z(), p.x(), p.y());
  Labels trees(stand.points.size());
  std::vector<std::size_t> indices(stand.points.size());
  std::iota(indices.begin(), indices.end(), 0);
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  const auto report = pcs::segment_trees(
      indices,
      boost::make_iterator_property_map(trees.begin(), identity),
      pcs::parameters::point_map(boost::make_iterator_property_map(stand.points.begin(), identity))
          .up_direction(Vector(2, 0, 0)));
  BOOST_TEST_REQUIRE(report.trees.size() == 3u);
  BOOST_TEST(shares(stand, trees, report).first > 0.97);
}

BOOST_AUTO_TEST_CASE(clouds_without_a_stem_have_no_trees)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-1, 1);
  Cloud floor, dust, tiny, hanging;
  for (int i = 0; i < 3000; ++i) {
    floor.emplace_back(3 * share(random), 3 * share(random), 0.001 * share(random));
    dust.emplace_back(0.3 * share(random), 0.3 * share(random), 0.3 * share(random));
    tiny.emplace_back(1e-4 * share(random), 1e-4 * share(random), 1e-4 * share(random));
  }
  append(hanging, pole(3)); // three metres above the floor
  append(hanging, floor);
  for (const Cloud* cloud : {&floor, &dust, &tiny, &hanging}) {
    Labels trees;
    const auto report = segment(*cloud, trees);
    BOOST_TEST((report.status == pcs::Status::nothing_to_do));
    BOOST_TEST(report.trees.size() == 0u);
    BOOST_TEST(report.number_of_unassigned_points == cloud->size());
    BOOST_TEST(std::count(trees.begin(), trees.end(), pcs::npos) == std::ptrdiff_t(cloud->size()));
  }
}

BOOST_AUTO_TEST_CASE(a_stem_begins_near_the_ground)
{
  for (const auto& [height, number] :
       {std::pair(0.0, 1u), std::pair(0.3, 1u), std::pair(1.5, 0u)}) {
    Cloud points = pole(height);
    append(points, level_floor());
    Labels trees;
    BOOST_TEST(segment(points, trees).trees.size() == number, "a pole " << height << " m above");
  }
}

BOOST_AUTO_TEST_CASE(a_stem_rises)
{
  const auto count = [](const Cloud& points) {
    Labels trees;
    return segment(points, trees).trees.size();
  };
  BOOST_TEST(count(pole(0, 1.2)) == 1u);
  BOOST_TEST(count(pole(0, 0.5)) == 0u);
  BOOST_TEST(count(pole(0, 3, 1.1)) == 1u);
  BOOST_TEST(count(pole(0, 3, 3)) == 0u); // the tip of a branch that hangs to the ground
  BOOST_TEST(count(crook()) == 1u);
  Cloud rod = cylinder(6000, 0.008, 3);
  BOOST_TEST(count(Jitter(0.0005)(rod)) == 0u); // a twig
}

BOOST_AUTO_TEST_CASE(poles_side_by_side_are_trees_of_their_own_and_a_stool_is_one)
{
  const auto count = [](double distance) {
    Cloud points = Jitter(0.001)(cylinder(6000, 0.06, 3));
    append(points, Jitter(0.001, 2)(cylinder(6000, 0.06, 3, Point(distance, 0, 0))));
    Labels trees;
    return segment(points, trees).trees.size();
  };
  BOOST_TEST(count(1.0) == 2u);
  BOOST_TEST(count(0.2) == 1u);

  // The branch of a shrub begins above the ground, far from the foot.
  const auto count_leaning = [](double distance) {
    Cloud points = level_floor();
    append(points, pole(0));
    for (const Point& p : pole(0.4, 2))
      points.push_back(p + Vector(distance + 0.5 * (p.z() - 0.4), 0, 0));
    Labels trees;
    return segment(points, trees).trees.size();
  };
  BOOST_TEST(count_leaning(0.5) == 1u);
  BOOST_TEST(count_leaning(1.2) == 2u);
}

BOOST_AUTO_TEST_CASE(a_tree_of_few_points_is_found_among_dense_ones)
{
  struct Sparse_pole
  {
    std::size_t number_of_points;
    double radius;
  };
  for (const Sparse_pole& sparse : {Sparse_pole{1200, 0.15}, {400, 0.1}, {300, 0.15}}) {
    Cloud points;
    for (const double x : {0.0, 2.0, 4.0})
      for (const Point& p : pole(0))
        points.push_back(p + Vector(x, 0, 0));
    const std::size_t number_of_dense = points.size();
    for (const Point& p : Jitter(0.001)(cylinder(sparse.number_of_points, sparse.radius, 3)))
      points.push_back(p + Vector(1, 1.5, 0));
    Labels trees;
    const pcs::Segmentation_report report = segment(points, trees);
    BOOST_TEST_CONTEXT(sparse.number_of_points << " points")
    {
      BOOST_TEST_REQUIRE(report.trees.size() == 4u);
      BOOST_TEST(std::abs(report.trees[0].radius - sparse.radius) < 0.1 * sparse.radius);
      BOOST_TEST(std::abs(report.trees[0].diameter_at_breast_height - 2 * sparse.radius) <
                 0.2 * sparse.radius);
      for (std::size_t t = 0; t < 3; ++t)
        BOOST_TEST(report.trees[t].radius >= report.trees[t + 1].radius);
      const auto first = trees.begin() + static_cast<std::ptrdiff_t>(number_of_dense);
      BOOST_TEST(std::count(trees.begin(), first, 0u) == 0);
      BOOST_TEST(std::size_t(std::count(first, trees.end(), 0u)) == sparse.number_of_points);
      check_counts(report, trees);
    }
  }
}

BOOST_AUTO_TEST_CASE(plants_below_breast_height_are_no_trees_beside_a_tree)
{
  Cloud points = pole(0, 1);
  Labels trees;
  pcs::Segmentation_report report = segment(points, trees);
  BOOST_TEST(report.trees.size() == 1u); // seedlings only
  BOOST_TEST(report.number_of_low_plants == 0u);
  BOOST_TEST(report.trees.at(0).diameter_at_breast_height == 0);

  const std::size_t number_of_low_points = points.size();
  for (const Point& p : pole(0, 3))
    points.push_back(p + Vector(3, 0, 0));
  report = segment(points, trees);
  BOOST_TEST_REQUIRE(report.trees.size() == 1u);
  BOOST_TEST(report.number_of_low_plants == 1u);
  BOOST_TEST(report.trees[0].foot[0] > 2.9);
  BOOST_TEST(std::abs(report.trees[0].diameter_at_breast_height - 0.087) < 0.005);
  BOOST_TEST(report.number_of_unassigned_points >= number_of_low_points);
  check_counts(report, trees);
}

BOOST_AUTO_TEST_CASE(dense_points_keep_their_tree)
{
  Cloud points = pole(0);
  // Its arm touches the sparse pole.
  for (const Point& p : Jitter(0.001)(cylinder(4000, 0.03, 0.9)))
    points.emplace_back(p.z(), p.x(), 1.5 + p.y());
  const std::size_t number_of_dense = points.size();
  for (const Point& p : Jitter(0.001)(cylinder(500, 0.1, 3)))
    points.push_back(p + Vector(0.9, 0.13, 0));
  Labels trees;
  const pcs::Segmentation_report report = segment(points, trees);
  const auto first = trees.begin() + static_cast<std::ptrdiff_t>(number_of_dense);
  BOOST_TEST_REQUIRE(report.trees.size() == 2u);
  BOOST_TEST(std::size_t(std::count(trees.begin(), first, 1u)) == number_of_dense);
  BOOST_TEST(std::count(first, trees.end(), 0u) > 450);
}

BOOST_AUTO_TEST_CASE(an_outlier_far_below_hides_no_tree)
{
  Stand stand = three_trees();
  stand.points.emplace_back(0.4, 0.4, -30);
  stand.points.emplace_back(900, 0.4, 2);
  stand.truth.insert(stand.truth.end(), 2, no_tree);
  Labels trees;
  const auto report = segment(stand.points, trees);
  BOOST_TEST(report.trees.size() == 3u);
  BOOST_TEST(trees.back() == pcs::npos);
}

BOOST_AUTO_TEST_CASE(stray_points_below_the_ground_hide_no_tree)
{
  for (const double share : {0.1, 0.2}) { // of the other points
    Stand stand = three_trees(0.4);
    stand.add_ground(0.4);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> side(-4, 6), depth(0.05, 3);
    for (double i = share * double(stand.points.size()); i > 0; --i) {
      const double x = side(random), y = side(random);
      stand.points.emplace_back(x, y, 0.4 * x - depth(random));
      stand.truth.push_back(no_tree);
    }
    Labels trees;
    const auto report = segment(stand.points, trees);
    BOOST_TEST(report.trees.size() == 3u);
    const auto [right, wrong] = shares(stand, trees, report);
    BOOST_TEST(right > 0.9);
    BOOST_TEST(wrong < 0.1);
  }
}

// Poles on ground that rises by 14 m. Feet and breast heights are measured from the ground.
BOOST_AUTO_TEST_CASE(trees_on_a_steep_slope_are_found)
{
  constexpr double slope = 0.8;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(-2, 16), across(-3, 3), noise(-0.05, 0.05);
  Cloud points;
  for (int i = 0; i < 2000; ++i) {
    const double x = along(random);
    points.emplace_back(x, across(random), slope * x + noise(random));
  }
  for (int k = 0; k < 6; ++k) {
    Cloud tree = pole(0, 4);
    for (Point& p : tree)
      p = p + Vector(2.8 * k, 0, slope * 2.8 * k);
    append(points, tree);
  }
  Labels trees;
  const auto report = segment(points, trees);
  BOOST_REQUIRE(report.trees.size() == 6u);
  for (int k = 0; k < 6; ++k) {
    const Point foot(2.8 * k, 0, slope * 2.8 * k);
    double distance = 0;
    const pcs::Segmented_tree& tree = report.trees[nearest_tree(report, foot, distance)];
    BOOST_TEST(distance < 0.1);
    BOOST_TEST(std::abs(tree.height - 4) < 0.1);
    BOOST_TEST(std::abs(tree.diameter_at_breast_height - 0.09) < 0.01);
  }
}

BOOST_AUTO_TEST_CASE(shrubs_on_thin_ground_do_not_hide_the_feet_of_trees)
{
  Stand stand = three_trees(0.3);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> side(-4, 6), unit(0, 1);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 3000; ++i) {
    const double x = side(random), y = side(random);
    stand.points.emplace_back(x, y, 0.3 * x);
    stand.truth.push_back(no_tree);
  }
  for (int shrub = 0; shrub < 120; ++shrub) {
    const double x = side(random), y = side(random), radius = 0.2 + 0.4 * unit(random);
    for (int i = 0; i < 400; ++i) {
      Vector d(gauss(random), gauss(random), gauss(random));
      d = d * (radius * std::cbrt(unit(random)) / std::sqrt(d.squared_length()));
      stand.points.emplace_back(x + d.x(), y + d.y(), 0.3 * x + 0.8 * radius + d.z());
      stand.truth.push_back(no_tree);
    }
  }
  Labels trees;
  const auto report = segment(stand.points, trees);
  for (const Point& foot : stand.feet) {
    double distance = 0;
    nearest_tree(report, foot, distance);
    BOOST_TEST(distance < 0.6);
  }
  BOOST_TEST(shares(stand, trees, report).first > 0.9);
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused)
{
  Labels trees;
  BOOST_CHECK_THROW(segment({}, trees), pcs::Invalid_input);
  BOOST_CHECK_THROW(segment(Cloud(50, Point(1, 2, 3)), trees), pcs::Invalid_input);
  Cloud points = cylinder(100, 0.1, 2);
  for (const double height : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    BOOST_CHECK_THROW(segment(points, trees, height), pcs::Invalid_input);
  points[7] = Point(0, std::numeric_limits<double>::infinity(), 0);
  BOOST_CHECK_EXCEPTION(segment(points, trees),
                        pcs::Invalid_input,
                        pcs_test::message_has("point 7", "not finite"));
}

BOOST_AUTO_TEST_CASE(cancelled_work_leaves_the_map_alone)
{
  const Stand stand = three_trees();
  std::vector<std::size_t> indices(stand.points.size());
  std::iota(indices.begin(), indices.end(), 0);
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  double last = 0;
  int calls = 0;
  bool is_growing = true;
  const auto run = [&](int limit) {
    Labels trees(stand.points.size(), no_tree);
    calls = 0;
    last = 0;
    const auto report =
        pcs::segment_trees(indices,
                           boost::make_iterator_property_map(trees.begin(), identity),
                           pcs::parameters::point_map(
                               boost::make_iterator_property_map(stand.points.begin(), identity))
                               .callback(std::function<bool(double)>([&](double f) {
                                 is_growing = is_growing && f >= last && f <= 1;
                                 last = f;
                                 return ++calls <= limit;
                               })));
    const bool is_untouched =
        std::count(trees.begin(), trees.end(), no_tree) == std::ptrdiff_t(trees.size());
    BOOST_TEST(is_untouched == (report.status == pcs::Status::cancelled));
    return report.status;
  };
  BOOST_TEST((run(1 << 20) == pcs::Status::converged));
  const int all = calls;
  BOOST_TEST(is_growing);
  BOOST_TEST(all > 5);
  for (const int limit : {0, 2, all / 2, all - 1})
    BOOST_TEST((run(limit) == pcs::Status::cancelled));
}

BOOST_AUTO_TEST_CASE(an_exception_of_the_callback_leaves_the_map_alone)
{
  const Cloud points = pole(0);
  std::vector<std::size_t> indices(points.size());
  std::iota(indices.begin(), indices.end(), 0);
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  int calls = 0;
  const auto run = [&](int stop) {
    Labels trees(points.size(), no_tree);
    calls = 0;
    const std::function<bool(double)> fail = [&](double) -> bool {
      if (++calls == stop)
        throw std::range_error("enough");
      return true;
    };
    const auto segment_all = [&] {
      pcs::segment_trees(
          indices,
          boost::make_iterator_property_map(trees.begin(), identity),
          pcs::parameters::point_map(boost::make_iterator_property_map(points.begin(), identity))
              .callback(fail));
    };
    if (stop == 0) {
      segment_all();
      return;
    }
    BOOST_CHECK_THROW(segment_all(), std::range_error);
    BOOST_TEST(std::count(trees.begin(), trees.end(), no_tree) == std::ptrdiff_t(trees.size()));
  };
  run(0);
  const int all = calls;
  BOOST_TEST(all > 5);
  for (int stop = all; stop > 0; stop -= 1 + all / 8) // also the last one
    run(stop);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_segment_trees

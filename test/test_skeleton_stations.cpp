// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Registration errors of stations are corrected in the skeleton.

#include <pcs/Tree_skeletonization.h>
#include <pcs/core/Tree_measures.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <support/tree_clouds.h>

#include <CGAL/number_utils.h>
#include <CGAL/property_map.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

namespace test_skeleton_stations {

using Vec3 = Eigen::Vector3d;
using pcs_test::Tree;
using Kernel = pcs_test::Tree_kernel;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using pcs::parameters::do_register_stations;

namespace {

/// A point, and the index of its station.
using Element = std::pair<Point, int>;

using Point_map = CGAL::First_of_pair_property_map<Element>;
using Station_map = CGAL::Second_of_pair_property_map<Element>;

std::vector<Element> elements(const pcs::Virtual_scan<Kernel>& scan)
{
  std::vector<Element> result;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    result.emplace_back(scan.points[i], scan.station[i]);
  return result;
}

const std::vector<Vector>& shifts()
{
  static const std::vector<Vector> shifts = {{0.006, -0.002, 0.003},
                                             {-0.004, 0.004, -0.006},
                                             {0.001, 0.005, 0.004},
                                             {-0.003, -0.006, -0.002}};
  return shifts;
}

const Tree& truth()
{
  static const Tree tree = [] {
    Tree result;
    pcs::grow_tree(result, pcs::fruit_habit(), pcs::parameters::random_seed(5));
    return result;
  }();
  return tree;
}

const pcs::Virtual_scan<Kernel>& exact_scan()
{
  static const pcs::Virtual_scan<Kernel> scan = [] {
    pcs::Virtual_scanner scanner;
    scanner.angular_step = 0.08 * CGAL_PI / 180;
    scanner.registration_error = 0;
    pcs::Virtual_scan<Kernel> result;
    pcs::scan_tree(truth(), result, scanner, pcs::parameters::random_seed(6));
    return result;
  }();
  return scan;
}

/// The scan with known errors of the stations. A jitter [m] of all coordinates removes the beam
/// grid.
std::vector<Element> shifted_scan(double jitter)
{
  std::vector<Element> points = elements(exact_scan());
  pcs_test::Jitter move(jitter);
  for (Element& e : points) {
    e.first = e.first + shifts()[std::size_t(e.second)];
    if (jitter > 0)
      e.first = move(e.first);
  }
  return points;
}

/// The largest error of the station shifts [m]; `number_of` has the indices of the stations in the
/// true shifts. The mean is arbitrary.
double error_of(const std::vector<pcs::Scan_station>& stations,
                const std::vector<std::size_t>& number_of)
{
  std::vector<Vec3> left;
  Vec3 middle = Vec3::Zero();
  double total = 0, worst = 0;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Vector& s = shifts()[number_of[k]];
    const double count = double(stations[k].number_of_points);
    left.push_back(stations[k].shift + Vec3(s.x(), s.y(), s.z()));
    middle += count * left.back();
    total += count;
  }
  for (const Vec3& l : left)
    worst = std::max(worst, (l - middle / total).norm());
  return worst;
}

const std::vector<std::size_t> in_order = {0, 1, 2, 3};

template <class NamedParameters>
pcs::Skeleton_report
extract(const std::vector<Element>& points, Tree& tree, const NamedParameters& np)
{
  return pcs::extract_tree_skeleton(points, tree, np.point_map(Point_map()));
}

double true_volume()
{
  return pcs::measure_tree<Kernel>(truth()).volume;
}

bool are_equal(const Tree& a, const Tree& b)
{
  if (num_vertices(a) != num_vertices(b))
    return false;
  for (std::size_t v = 0; v < num_vertices(a); ++v)
    if (a[v].point != b[v].point || a[v].radius != b[v].radius)
      return false;
  return true;
}

} // namespace

BOOST_AUTO_TEST_SUITE(tree_skeleton_stations)

BOOST_AUTO_TEST_CASE(stations_that_are_found_are_put_onto_the_same_branches)
{
  const std::vector<Element> points = shifted_scan(0);
  Tree before, after;
  const auto kept = extract(points, before, do_register_stations(false));
  const auto report = extract(points, after, do_register_stations(true));
  BOOST_CHECK(kept.stations.empty());
  BOOST_REQUIRE_EQUAL(report.stations.size(), 4u);
  pcs_test::check_is_a_tree(after);
  std::vector<std::size_t> number_of;
  std::size_t total = 0;
  for (const pcs::Scan_station& found : report.stations) {
    total += found.number_of_points;
    BOOST_CHECK_CLOSE(found.azimuth_step, 0.08 * CGAL_PI / 180, 0.1);
    BOOST_CHECK_CLOSE(found.elevation_step, 0.08 * CGAL_PI / 180, 0.1);
    double best = 1;
    std::size_t number = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Point p = exact_scan().stations[k] + shifts()[k];
      const double away = (found.position - Vec3(p.x(), p.y(), p.z())).norm();
      if (away < best) {
        best = away;
        number = k;
      }
    }
    BOOST_CHECK_LT(best, 0.03);
    number_of.push_back(number);
  }
  BOOST_CHECK_GT(double(total), 0.97 * double(points.size()));
  BOOST_CHECK_LT(error_of(report.stations, number_of), 0.001);
  const double truth = true_volume();
  BOOST_CHECK_LT(std::abs(report.total.volume - truth), 0.5 * std::abs(kept.total.volume - truth));
  BOOST_CHECK_LT(report.noise, 0.7 * kept.noise);
}

BOOST_AUTO_TEST_CASE(stations_of_the_caller_need_no_beams)
{
  const std::vector<Element> points = shifted_scan(0.002);
  Tree tree;
  const auto np = pcs::parameters::station_map(Station_map());
  BOOST_CHECK(extract(points, tree, do_register_stations(true)).stations.empty());
  BOOST_CHECK(extract(points, tree, np.do_register_stations(false)).stations.empty());
  const auto report = extract(points, tree, np);
  BOOST_REQUIRE_EQUAL(report.stations.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    BOOST_CHECK_EQUAL(report.stations[k].label, static_cast<long long>(k));
    BOOST_CHECK_EQUAL(report.stations[k].azimuth_step, 0); // not computed
  }
  BOOST_CHECK_LT(error_of(report.stations, in_order), 0.0015);
}

BOOST_AUTO_TEST_CASE(points_whose_station_is_not_known_stay)
{
  std::vector<Element> points = shifted_scan(0.002);
  for (std::size_t i = 0; i < points.size(); i += 5)
    points[i].second = -7;
  Tree tree;
  const auto report = extract(points, tree, pcs::parameters::station_map(Station_map()));
  BOOST_REQUIRE_EQUAL(report.stations.size(), 4u);
  std::size_t total = 0;
  for (const pcs::Scan_station& station : report.stations)
    total += station.number_of_points;
  BOOST_CHECK_EQUAL(total, points.size() - (points.size() + 4) / 5);
  BOOST_CHECK_LT(error_of(report.stations, in_order), 0.002);
}

BOOST_AUTO_TEST_CASE(stations_without_errors_stay_where_they_are)
{
  const std::vector<Element> points = elements(exact_scan());
  Tree tree;
  const auto np = pcs::parameters::station_map(Station_map());
  for (const pcs::Scan_station& station : extract(points, tree, np).stations)
    BOOST_CHECK_LT(station.shift.norm(), 0.0007);
}

BOOST_AUTO_TEST_CASE(one_station_has_no_others_to_agree_with)
{
  std::vector<Element> points = shifted_scan(0.002);
  for (Element& e : points)
    e.second = 3;
  Tree before, after;
  extract(points, before, do_register_stations(false));
  const auto np = pcs::parameters::station_map(Station_map());
  BOOST_CHECK(extract(points, after, np).stations.empty());
  BOOST_CHECK(are_equal(before, after));
}

BOOST_AUTO_TEST_CASE(labels_without_meaning_move_nothing)
{
  std::vector<Element> points = elements(exact_scan());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].second = static_cast<int>(i % 20);
  Tree after;
  const auto report = extract(points, after, pcs::parameters::station_map(Station_map()));
  for (const pcs::Scan_station& station : report.stations)
    BOOST_CHECK_LT(station.shift.norm(), 0.001);
  pcs_test::check_is_a_tree(after);
}

BOOST_AUTO_TEST_CASE(labels_of_a_thousand_values_are_no_stations)
{
  std::vector<Element> points = shifted_scan(0);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].second = static_cast<int>(i % 1000);
  Tree tree;
  const auto report = extract(points, tree, pcs::parameters::station_map(Station_map()));
  BOOST_REQUIRE_EQUAL(report.stations.size(), 4u); // from the beam grids
  BOOST_CHECK_GT(report.stations[0].azimuth_step, 0);
}

BOOST_AUTO_TEST_CASE(all_threads_give_the_same_bits)
{
  const std::vector<Element> points = shifted_scan(0);
  Tree one, two;
  const auto np = pcs::parameters::point_map(Point_map());
  pcs::extract_tree_skeleton<CGAL::Sequential_tag>(points, one, np);
  pcs::extract_tree_skeleton<CGAL::Parallel_if_available_tag>(points, two, np);
  BOOST_CHECK(are_equal(one, two));
}

BOOST_AUTO_TEST_CASE(the_search_for_stations_can_be_stopped_and_started_again)
{
  const std::vector<Element> points = shifted_scan(0);
  Tree expected;
  extract(points, expected, do_register_stations(true));
  for (const int most : {0, 1, 2, 4}) {
    int calls = 0;
    bool is_stopping = true;
    const std::function<bool(double)> callback = [&](double) {
      return !is_stopping || ++calls <= most;
    };
    const auto np = pcs::parameters::point_map(Point_map()).callback(callback);
    pcs::Tree_skeletonization<std::vector<Element>, std::decay_t<decltype(np)>> session(points, np);
    BOOST_CHECK(!session.find_neighbors());
    is_stopping = false;
    Tree tree;
    BOOST_CHECK_EQUAL(session.extract(tree).stations.size(), 4u);
    BOOST_CHECK(are_equal(tree, expected));
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_skeleton_stations

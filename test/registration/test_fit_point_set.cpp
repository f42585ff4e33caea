// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Registration of whole clouds: accuracy against the truth, laws, and errors.

#include <pcs/registration/fit_point_set.h>
#include <support/exceptions.h>
#include <support/fitted_clouds.h>
#include <support/threads.h>

#include <CGAL/property_map.h>
#include <CGAL/tags.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace test_fit_point_set {

namespace {

using pcs_test::message_has;
using pcs_test::Points;
using pcs_test::Vec3;
namespace P = pcs::parameters;

constexpr double extent = 10, curvature = 0.1;

/// Writes `(*values)[i]` for the element number `i` of `points`.
template <class Value>
struct Flag_map
{
  using key_type = Vec3;
  using value_type = Value;
  using reference = void;
  using category = boost::writable_property_map_tag;
  const Points* points;
  std::vector<int>* values;
  friend void put(const Flag_map& map, const Vec3& key, Value v)
  {
    (*map.values)[static_cast<std::size_t>(&key - map.points->data())] = static_cast<int>(v);
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(fit_point_set)

BOOST_AUTO_TEST_CASE(a_bent_body_is_fitted_to_another_sampling_of_it)
{
  Points source = pcs_test::star(3000, 0);
  const Points truth = pcs_test::bend(source, curvature);
  const Points target = pcs_test::bend(pcs_test::star(2500, 1), curvature);
  BOOST_TEST(pcs_test::rms_distance(source, truth) > 0.015 * extent);
  const pcs::Fit_report report = pcs::fit_point_set(source, target);
  BOOST_TEST(report.is_plausible);
  BOOST_TEST(pcs_test::rms_distance(source, truth) < 0.006 * extent);
  BOOST_TEST(report.matched_share() > 0.98);
  BOOST_TEST(report.median_residual < 0.002 * extent);
  BOOST_TEST(report.number_of_source_points == 3000);
  BOOST_TEST(report.number_of_target_points == 2500);
}

BOOST_AUTO_TEST_CASE(a_part_without_target_follows_and_has_no_match)
{
  const Points rest = pcs_test::star(3000, 0);
  Points source = rest, target;
  for (const Vec3& p : pcs_test::star(3000, 1))
    if (p.z() < 3)
      target.push_back(pcs_test::bend(p, curvature));
  const Points truth = pcs_test::bend(rest, curvature);
  std::vector<int> is_matched(rest.size(), -1), match(rest.size(), -2);
  const auto report =
      pcs::fit_point_set(source,
                         target,
                         P::point_is_matched_map(Flag_map<bool>{&source, &is_matched})
                             .point_match_map(Flag_map<int>{&source, &match}));
  BOOST_TEST(pcs_test::rms_distance(source, truth) < 0.01 * extent);
  std::size_t wrong = 0, matched = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    matched += is_matched[i] == 1 ? 1 : 0;
    if (std::abs(rest[i].z() - 3) > 0.5)
      wrong += is_matched[i] == (rest[i].z() < 3 ? 1 : 0) ? 0 : 1;
    BOOST_TEST_REQUIRE((match[i] >= 0) == (is_matched[i] == 1));
    if (match[i] >= 0)
      BOOST_TEST_REQUIRE((target[static_cast<std::size_t>(match[i])] - source[i]).norm() < 0.5);
  }
  BOOST_TEST(wrong < 0.03 * double(rest.size()));
  BOOST_TEST(matched == report.number_of_matched);
}

BOOST_AUTO_TEST_CASE(noise_and_outliers_are_tolerated)
{
  Points source = pcs_test::star(3000, 0);
  const Points truth = pcs_test::bend(source, curvature);
  Points target = pcs_test::bend(pcs_test::star(3000, 1), curvature);
  for (std::size_t i = 0; i < target.size(); ++i) {
    const double t = double(i);
    target[i] += 0.003 * extent * Vec3(std::sin(91.7 * t), std::sin(57.3 * t), std::sin(33.1 * t));
    if (i % 20 == 0)
      target[i] = 3 * Vec3(std::sin(7.7 * t), std::sin(5.3 * t), std::sin(3.1 * t));
  }
  pcs::fit_point_set(source, target);
  BOOST_TEST(pcs_test::rms_distance(source, truth) < 0.01 * extent);
}

BOOST_AUTO_TEST_CASE(landmarks_determine_the_pose_and_are_reached)
{
  // turned by 180 degrees, which the alignment by soft matches cannot find
  const Points rest = pcs_test::star(2000, 0);
  const auto move = [](const Vec3& p) {
    const Vec3 q = pcs_test::bend(p, curvature);
    return Vec3(-q.x() + 10, q.y(), -q.z());
  };
  Points source = rest, truth, target;
  for (const Vec3& p : rest)
    truth.push_back(move(p));
  for (const Vec3& p : pcs_test::star(2000, 1))
    target.push_back(move(p));
  pcs::fit_point_set(source, target);
  BOOST_TEST(pcs_test::rms_distance(source, truth) > 0.2 * extent);
  source = rest;
  std::vector<pcs::Landmark> landmarks;
  for (const std::size_t i : {0u, 500u, 1200u, 1999u})
    landmarks.push_back({i, truth[i]});
  const auto report =
      pcs::fit_point_set(source, target, P::default_values(), P::landmarks(landmarks));
  BOOST_TEST(pcs_test::rms_distance(source, truth) < 0.008 * extent);
  BOOST_TEST(report.largest_landmark_gap < 0.003 * extent);
  BOOST_TEST(report.largest_landmark_gap > 0);
}

BOOST_AUTO_TEST_CASE(landmarks_determine_the_pose_only_if_wanted_and_at_three_places)
{
  const Points rest = pcs_test::star(1000, 0);
  Points target;
  for (const Vec3& p : pcs_test::star(1000, 1))
    target.push_back(p + Vec3(1, 0, 0));
  const auto motion = [&](const std::vector<std::size_t>& points, bool do_align) {
    Points source = rest;
    source.push_back(rest[0]);
    source.push_back(rest[0]);
    std::vector<pcs::Landmark> landmarks;
    for (const std::size_t i : points)
      landmarks.push_back({i, Vec3(source[i] + Vec3(3, 0, 0))});
    const auto report = pcs::fit_point_set(source,
                                           target,
                                           P::do_align(do_align).number_of_iterations(5),
                                           P::landmarks(landmarks));
    return report.rigid_motion(Vec3(0, 0, 0)).x();
  };
  const std::vector<std::size_t> spread{0, 400, 800}, same{0, 1000, 1001};
  BOOST_TEST(std::abs(motion(spread, true) - 3) < 1e-9);
  BOOST_TEST(motion(spread, false) == 0);
  BOOST_TEST(motion(same, true) < 2); // by soft matches
}

BOOST_AUTO_TEST_CASE(identical_clouds_stay_where_they_are)
{
  const Points rest = pcs_test::star(1500, 0);
  Points source = rest;
  const auto report = pcs::fit_point_set(source, rest);
  BOOST_TEST(report.status == pcs::Status::converged);
  BOOST_TEST(pcs_test::rms_distance(source, rest) < 1e-3 * extent);
}

BOOST_AUTO_TEST_CASE(scaled_and_shifted_input_gives_the_scaled_and_shifted_result)
{
  Points source = pcs_test::star(1500, 0);
  Points target = pcs_test::bend(pcs_test::star(1500, 1), curvature);
  Points large = source, large_target = target;
  const double size = 1024; // a power of two: exact up to the shift
  for (Points* points : {&large, &large_target})
    for (Vec3& p : *points)
      p = size * p + Vec3(4096, -8192, 16384);
  pcs::fit_point_set(source, target);
  pcs::fit_point_set(large, large_target);
  for (Vec3& p : large)
    p = (p - Vec3(4096, -8192, 16384)) / size;
  BOOST_TEST(pcs_test::rms_distance(source, large) < 1e-4 * extent);
}

BOOST_AUTO_TEST_CASE(results_are_bitwise_equal_for_all_numbers_of_threads)
{
  const Points rest = pcs_test::star(2500, 0);
  const Points target = pcs_test::bend(pcs_test::star(2500, 1), curvature);
  Points sequential = rest;
  pcs::fit_point_set<CGAL::Sequential_tag>(sequential, target, P::number_of_iterations(15));
  for (const int n : pcs_test::thread_counts)
    pcs_test::with_threads(n, [&] {
      Points source = rest;
      pcs::fit_point_set(source, target, P::number_of_iterations(15));
      BOOST_TEST((source == sequential));
    });
}

BOOST_AUTO_TEST_CASE(calls_in_two_threads_give_the_bits_of_calls_alone)
{
  const Points rest[2] = {pcs_test::star(600, 0), pcs_test::star(800, 2)};
  const Points target = pcs_test::bend(pcs_test::star(700, 1), curvature);
  const auto fit = [&](int k) {
    Points source = rest[k];
    pcs::fit_point_set(source, target, P::number_of_iterations(3));
    return source;
  };
  const Points alone[2] = {fit(0), fit(1)};
  for (const bool is_same_input : {false, true}) {
    Points found[2];
    pcs_test::in_two_threads([&](int k) { found[k] = fit(is_same_input ? 0 : k); });
    for (int k = 0; k < 2; ++k)
      BOOST_TEST((found[k] == alone[is_same_input ? 0 : k]));
  }
}

BOOST_AUTO_TEST_CASE(normals_follow_and_keep_their_length)
{
  Points points = pcs_test::star(2000, 0);
  std::vector<std::pair<Vec3, Vec3>> source;
  for (const Vec3& p : points)
    source.emplace_back(p, 2 * p.normalized());
  Points target;
  const Eigen::Matrix3d r = pcs::rotation_exp(Vec3(0, 0.5, 0.2)).toRotationMatrix();
  for (const Vec3& p : pcs_test::star(2000, 1))
    target.push_back(r * p);
  pcs::fit_point_set(source,
                     target,
                     P::point_map(CGAL::First_of_pair_property_map<std::pair<Vec3, Vec3>>())
                         .normal_map(CGAL::Second_of_pair_property_map<std::pair<Vec3, Vec3>>()));
  double worst = 1, sum = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    BOOST_TEST_REQUIRE(source[i].second.norm() == 2, boost::test_tools::tolerance(1e-9));
    const double c = 0.5 * source[i].second.dot(r * points[i].normalized());
    worst = std::min(worst, c);
    sum += c;
  }
  BOOST_TEST(worst > 0.9);
  BOOST_TEST(sum / double(source.size()) > 0.999);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(fit_point_set_clouds)

BOOST_AUTO_TEST_CASE(a_plane_is_lifted_to_a_plane)
{
  Points source, target;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 20; ++j) {
      source.emplace_back(i, j, 0);
      target.emplace_back(i + 0.3, j - 0.2, 2);
    }
  const auto report = pcs::fit_point_set(source, target);
  BOOST_TEST(report.is_plausible);
  for (const Vec3& p : source)
    BOOST_TEST_REQUIRE(std::abs(p.z() - 2) < 0.05);
}

BOOST_AUTO_TEST_CASE(a_line_is_fitted_to_an_arc)
{
  Points source, target;
  for (int i = 0; i < 200; ++i) {
    source.emplace_back(i, 0, 0);
    target.emplace_back(150 * std::sin(i / 150.0), 150 * (1 - std::cos(i / 150.0)), 0);
  }
  const auto report = pcs::fit_point_set(source, target);
  BOOST_TEST(report.status != pcs::Status::numerical_failure);
  BOOST_TEST(pcs_test::rms_distance(source, target) < 8); // it was 60
}

BOOST_AUTO_TEST_CASE(tiny_clouds_give_finite_results)
{
  for (const std::size_t n : {4u, 5u, 8u, 20u}) {
    Points source = pcs_test::star(n, 0);
    const auto report = pcs::fit_point_set(source, pcs_test::star(n, 1));
    BOOST_TEST(report.number_of_source_points == n);
    for (const Vec3& p : source)
      BOOST_TEST_REQUIRE(p.allFinite());
  }
}

BOOST_AUTO_TEST_CASE(another_shape_far_away_is_not_plausible_without_alignment)
{
  Points source = pcs_test::star(1000, 0), target = source;
  for (Vec3& p : target)
    p += Vec3(100, 0, 0);
  const auto report = pcs::fit_point_set(source, target, P::do_align(false));
  BOOST_TEST(!report.is_plausible);
  BOOST_TEST(report.number_of_matched == 0u);
  BOOST_TEST(std::isnan(report.median_residual));
  BOOST_TEST(std::isnan(report.rms_residual));
  source = pcs_test::star(1000, 0);
  BOOST_TEST(pcs::fit_point_set(source, target).is_plausible);
  BOOST_TEST(pcs_test::rms_distance(source, target) < 0.01 * extent);
}

BOOST_AUTO_TEST_CASE(duplicates_and_components_are_possible)
{
  Points source = pcs_test::star(1000, 0), other = pcs_test::star(500, 0.3);
  for (const Vec3& p : other)
    source.push_back(p + Vec3(8, 0, 0));
  source.insert(source.end(), source.begin(), source.begin() + 100);
  Points target;
  for (const Vec3& p : source)
    target.push_back(p + Vec3(0.3, 0.15, 0));
  pcs::fit_point_set(source, target);
  BOOST_TEST(pcs_test::rms_distance(source, target) < 0.05);
  for (std::size_t i = 0; i < 100; ++i)
    BOOST_TEST_REQUIRE(source[i] == source[source.size() - 100 + i]);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(fit_point_set_errors)

/// Checks that the call throws with the words, and leaves the source as it is.
#define CHECK_REFUSED(source, call, ...)                                                           \
  do {                                                                                             \
    const Points before = source;                                                                  \
    BOOST_CHECK_EXCEPTION(call, pcs::Invalid_input, message_has(__VA_ARGS__));                     \
    BOOST_TEST((source == before));                                                                \
  } while (false)

BOOST_AUTO_TEST_CASE(too_few_or_coincident_points_are_refused)
{
  Points none, three = pcs_test::star(3, 0), some = pcs_test::star(50, 0);
  Points same(10, Vec3(1, 2, 3));
  CHECK_REFUSED(none, pcs::fit_point_set(none, some), "the source has 0 points", "at least 4");
  CHECK_REFUSED(three, pcs::fit_point_set(three, some), "the source has 3 points");
  CHECK_REFUSED(some, pcs::fit_point_set(some, none), "the target has 0 points");
  CHECK_REFUSED(same, pcs::fit_point_set(same, some), "points coincide");
  CHECK_REFUSED(some, pcs::fit_point_set(some, same), "points of the target coincide");
}

BOOST_AUTO_TEST_CASE(values_that_are_not_finite_and_distant_targets_are_refused)
{
  Points good = pcs_test::star(50, 0), bad = good, far = good;
  bad[7].y() = std::numeric_limits<double>::quiet_NaN();
  BOOST_CHECK_EXCEPTION(pcs::fit_point_set(bad, good),
                        pcs::Invalid_input,
                        message_has("point 7", "not finite"));
  CHECK_REFUSED(good, pcs::fit_point_set(good, bad), "point 7 of the target", "not finite");
  far[3] = Vec3(1e9, 0, 0);
  CHECK_REFUSED(good, pcs::fit_point_set(good, far), "point 3 of the target", "units and origins");
}

BOOST_AUTO_TEST_CASE(wrong_landmarks_are_refused)
{
  Points source = pcs_test::star(50, 0), target = source;
  const auto fit = [&](const std::vector<pcs::Landmark>& landmarks) {
    return pcs::fit_point_set(source, target, P::default_values(), P::landmarks(landmarks));
  };
  CHECK_REFUSED(source, fit({{50, Vec3(0, 0, 0)}}), "landmark 0", "source point 50");
  CHECK_REFUSED(source,
                fit({{0, Vec3(0, 0, 0)}, {1, Vec3(NAN, 0, 0)}}),
                "landmark 1",
                "not finite");
  CHECK_REFUSED(source,
                fit({{4, Vec3(0, 0, 0)}, {9, Vec3(0, 0, 0)}, {4, Vec3(1, 0, 0)}}),
                "landmarks 0 and 2",
                "two different targets");
}

BOOST_AUTO_TEST_CASE(parameters_out_of_range_are_refused)
{
  Points source = pcs_test::star(50, 0);
  const Points target = source;
  CHECK_REFUSED(source, pcs::fit_point_set(source, target, P::stiffness(0.0)), "stiffness is 0");
  CHECK_REFUSED(source,
                pcs::fit_point_set(source, target, P::fitting_length(2.0)),
                "fitting_length is 2");
  CHECK_REFUSED(source,
                pcs::fit_point_set(source, target, P::outlier_share(1.0)),
                "outlier_share is 1");
  CHECK_REFUSED(source,
                pcs::fit_point_set(source, target, P::number_of_iterations(0)),
                "number_of_iterations is 0");
  CHECK_REFUSED(source,
                pcs::fit_point_set(source, target, P::number_of_samples(-1)),
                "number_of_samples is -1");
  CHECK_REFUSED(source,
                pcs::fit_point_set(source, target, P::number_of_samples(1)),
                "number_of_samples is 1");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_point_set

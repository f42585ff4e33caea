// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Degenerate clouds, handles and parameters: a defined result or an error that names the cause,
// never a NaN.

#include <support/deform_cloud.h>
#include <support/exceptions.h>
#include <support/random_edits.h>

#include <boost/test/unit_test.hpp>

#include <chrono>
#include <limits>
#include <stdexcept>
#include <thread>

namespace test_deformation_robustness {

namespace {

using pcs::Invalid_input;
using pcs::Similarity;
using pcs::Status;
using pcs_test::Bar_edit;
using pcs_test::deform;
using pcs_test::Handles;
using pcs_test::is_finite;
using pcs_test::is_untouched;
using pcs_test::message_has;
using pcs_test::Options;
using pcs_test::Points;
using pcs_test::Vec3;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Similarity some_motion()
{
  return pcs::translation(Vec3(.1, .2, .3)) * pcs::rotation(Vec3(1, 2, 3), 1.0, Vec3(0, 0, 0));
}

std::vector<std::size_t> all_of(const Points& points)
{
  return pcs_test::select(points, [](const Vec3&) { return true; });
}

/// Handles at the first and the last point; the last one is moved.
Handles at_both_ends(const Points& points, const Similarity& motion)
{
  return {{{0}, {}, 0}, {{points.size() - 1}, motion, 0}};
}

Options with_samples(long long count)
{
  Options options;
  options.number_of_samples = count;
  return options;
}

/// Checks that the handles reach their targets and all points are finite.
void check(const Points& points, const Handles& handles, const Options& options)
{
  const auto result = deform(points, handles, options);
  BOOST_TEST(is_finite(result));
  BOOST_TEST(result.report.status != Status::numerical_failure);
  BOOST_TEST(std::isfinite(result.report.energy));
  const double size = pcs_test::diagonal(points);
  for (const auto& handle : handles)
    if (handle.softness == 0)
      for (const auto i : handle.indices)
        BOOST_TEST((result.points[i] - handle.transformation(points[i])).norm() <=
                   1e-9 * (size + points[i].norm()));
}

void check_at_all_resolutions(const Points& points, const Handles& handles)
{
  for (const long long samples : {1, 2, 3, 10, 100, 1000000})
    BOOST_TEST_CONTEXT(samples << " samples")
  check(points, handles, with_samples(samples));
}

} // namespace

BOOST_AUTO_TEST_SUITE(deformation_clouds)

BOOST_AUTO_TEST_CASE(no_points_are_refused)
{
  BOOST_CHECK_EXCEPTION(deform({}, {{{0}, {}, 0}}), Invalid_input, message_has("no points"));
}

BOOST_AUTO_TEST_CASE(one_place_is_refused)
{
  for (const std::size_t n : {1u, 2u, 100u})
    BOOST_CHECK_EXCEPTION(deform(Points(n, Vec3(1, 2, 3)), {{{0}, {}, 0}}),
                          Invalid_input,
                          message_has("coincide"));
}

BOOST_AUTO_TEST_CASE(tiny_clouds_are_deformed)
{
  for (const std::size_t n : {2u, 3u, 4u, 5u, 7u, 8u, 9u, 17u}) {
    const Points points = pcs_test::random_points(n, static_cast<unsigned>(n));
    check_at_all_resolutions(points, at_both_ends(points, some_motion()));
    check_at_all_resolutions(points, {{{0}, some_motion(), 0}});
    check_at_all_resolutions(points, {{all_of(points), some_motion(), 0}});
  }
}

BOOST_AUTO_TEST_CASE(collinear_points_are_deformed)
{
  Points points;
  for (int i = 0; i < 200; ++i)
    points.push_back(i * Vec3(.1, .2, .3));
  check_at_all_resolutions(points, at_both_ends(points, some_motion()));
  // The points do not determine a rotation about the line, but it must be harmless.
  const auto about_itself = pcs::rotation(Vec3(.1, .2, .3), 2.0, Vec3(0, 0, 0));
  const auto result = deform(points, at_both_ends(points, about_itself));
  BOOST_TEST(pcs_test::largest_distance(result.points, points) < 1e-9);
}

BOOST_AUTO_TEST_CASE(coplanar_points_are_deformed)
{
  const Points points = pcs_test::plate(20, 20, 1. / 3);
  check_at_all_resolutions(points, at_both_ends(points, some_motion()));
}

BOOST_AUTO_TEST_CASE(geometric_sequences_are_deformed)
{
  Points points;
  for (int i = 0; i < 300; ++i)
    points.push_back(Vec3(std::ldexp(1.0, -i), 0, 0));
  check_at_all_resolutions(points, at_both_ends(points, some_motion()));
}

BOOST_AUTO_TEST_CASE(half_of_the_points_may_be_duplicates)
{
  const Bar_edit edit;
  Points doubled = edit.points;
  doubled.insert(doubled.end(), edit.points.begin(), edit.points.end());
  for (const long long samples : {150, 1000000}) {
    const auto single = deform(edit.points, edit.handles, with_samples(samples));
    const auto result = deform(doubled, edit.handles, with_samples(samples));
    BOOST_TEST(result.report.number_of_duplicates == edit.points.size());
    const std::size_t n = edit.points.size();
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      largest = std::max(largest, (result.points[i] - single.points[i]).norm());
      BOOST_REQUIRE((result.points[i] == result.points[n + i])); // duplicates remain equal
    }
    // With samples, duplicates change the blocks of eight points that are blended in single
    // precision.
    BOOST_TEST(largest < (samples == 150 ? 1e-6 : 1e-12));
  }
}

BOOST_AUTO_TEST_CASE(forty_thousand_zeros_do_no_harm)
{
  Bar_edit edit;
  edit.points.insert(edit.points.end(), 40000, Vec3(0, 0, 0)); // a corner of the fixed end
  for (const long long samples : {150, 1000000}) {
    const auto result = deform(edit.points, edit.handles, with_samples(samples));
    BOOST_TEST(is_finite(result));
    BOOST_TEST(result.report.number_of_duplicates == 40000u);
  }
}

BOOST_AUTO_TEST_CASE(a_far_outlier_does_not_spoil_the_rest)
{
  const Bar_edit edit;
  for (const long long samples : {150, 1000000}) {
    const auto expected = deform(edit.points, edit.handles, with_samples(samples));
    for (const double distance : {10.0, 1e3, 1e6, 1e9}) {
      Points points = edit.points;
      points.push_back(Vec3(distance, distance, 0));
      auto result = deform(points, edit.handles, with_samples(samples));
      BOOST_TEST(is_finite(result));
      result.points.pop_back();
      // The outlier is linked to a corner of the bar. A spacing is 1/6, and double precision
      // resolves 1e-7 at 1e9.
      BOOST_TEST(pcs_test::largest_distance(result.points, expected.points) < 0.1,
                 "outlier at " << distance << ", " << samples << " samples: "
                               << pcs_test::largest_distance(result.points, expected.points));
    }
  }
}

BOOST_AUTO_TEST_CASE(small_groups_far_apart_stay_whole)
{
  // Fewer points than neighbours: all groups are connected, by links up to 1e9 times as long.
  for (const int size : {3, 4, 6})
    for (const double distance : {1e4, 1e6, 1e9})
      for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(1e8, -1e8, 1e8)})
        for (unsigned seed = 0; seed < 3; ++seed)
          BOOST_TEST_CONTEXT("groups of " << size << ", distance " << distance << ", origin "
                                          << origin.transpose() << ", seed " << seed)
          {
            Points points = pcs_test::small_groups(size, distance, seed);
            for (Vec3& p : points)
              p += origin;
            const std::size_t n = points.size(), group = static_cast<std::size_t>(size);
            Handles handles(2);
            for (std::size_t i = 0; i < group; ++i) {
              handles[0].indices.push_back(i);
              handles[1].indices.push_back(n - 1 - i);
            }
            handles[1].transformation = pcs::rotation(Vec3(1, 2, 3), 0.5, origin);
            const auto bent = deform(points, handles);
            BOOST_TEST(bent.report.status == Status::converged);
            BOOST_TEST(bent.report.number_of_components == 1u);
            const double rounding = 1e-15 * (pcs_test::diagonal(points) + origin.norm());
            for (std::size_t i = 0; i < n; ++i)
              for (std::size_t j = i / group * group; j < i; ++j) {
                const double length = (points[j] - points[i]).norm();
                const double change = (bent.points[j] - bent.points[i]).norm() - length;
                BOOST_TEST(std::abs(change) < 0.1 * length + 10 * rounding);
              }
            handles[0].transformation = handles[1].transformation;
            const auto moved = deform(points, handles);
            for (std::size_t i = 0; i < n; ++i)
              BOOST_TEST((moved.points[i] - handles[0].transformation(points[i])).norm() <
                         1e-14 * distance * distance + 10 * rounding);
          }
}

BOOST_AUTO_TEST_CASE(points_that_are_not_finite_are_named)
{
  Bar_edit edit;
  for (const double bad : {not_a_number, infinity, -infinity})
    for (const std::size_t i : {0u, 123u}) {
      Points points = edit.points;
      points[i].y() = bad;
      BOOST_CHECK_EXCEPTION(deform(points, edit.handles),
                            Invalid_input,
                            message_has("point " + std::to_string(i), "not finite"));
      Points normals = pcs_test::arbitrary_normals(points.size());
      normals[i].z() = bad;
      BOOST_CHECK_EXCEPTION(deform(edit.points, edit.handles, {}, normals),
                            Invalid_input,
                            message_has("normal", "point " + std::to_string(i), "not finite"));
    }
}

BOOST_AUTO_TEST_CASE(zero_normals_stay_zero)
{
  const Bar_edit edit;
  for (const long long samples : {150, 1000000}) {
    const auto result = deform(edit.points,
                               edit.handles,
                               with_samples(samples),
                               Points(edit.points.size(), Vec3::Zero()));
    for (const Vec3& v : result.normals)
      BOOST_REQUIRE((v == Vec3::Zero()));
  }
}

BOOST_AUTO_TEST_CASE(extents_beyond_the_representable_are_refused)
{
  for (const double size : {1e-120, 1e150, 1e300})
    BOOST_CHECK_EXCEPTION(
        deform(Points{Vec3(0, 0, 0), Vec3(size, 0, 0), Vec3(0, size, 0)}, {{{0}, {}, 0}}),
        Invalid_input,
        message_has("extent"));
  // The difference of two finite numbers may overflow.
  BOOST_CHECK_THROW(deform(Points{Vec3(-1.5e308, 0, 0), Vec3(1.5e308, 0, 0)}, {{{0}, {}, 0}}),
                    Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(deformation_handles)

BOOST_AUTO_TEST_CASE(no_handle_is_refused)
{
  BOOST_CHECK_EXCEPTION(deform(Bar_edit().points, {}), Invalid_input, message_has("no handle"));
  BOOST_CHECK_EXCEPTION(deform(Bar_edit().points, {{{}, {}, 0}}),
                        Invalid_input,
                        message_has("at least one point"));
}

BOOST_AUTO_TEST_CASE(indices_out_of_range_are_named)
{
  const Bar_edit edit;
  const std::size_t n = edit.points.size();
  for (const std::size_t bad : {n, n + 1, std::size_t(1) << 32, ~std::size_t(0)})
    BOOST_CHECK_EXCEPTION(deform(edit.points, {{{0, bad}, {}, 0}}),
                          Invalid_input,
                          message_has(std::to_string(bad), "out of range", std::to_string(n)));
}

BOOST_AUTO_TEST_CASE(a_point_in_two_handles_is_named)
{
  const Bar_edit edit;
  BOOST_CHECK_EXCEPTION(deform(edit.points, {{{3, 5}, {}, 0}, {{7, 5}, some_motion(), 0}}),
                        Invalid_input,
                        message_has("point 5", "handle 0"));
  Points points = edit.points;
  points.push_back(points[5]); // or a coincident point
  BOOST_CHECK_EXCEPTION(deform(points, {{{3, 5}, {}, 0}, {{points.size() - 1}, some_motion(), 0}}),
                        Invalid_input,
                        message_has("same place"));
}

BOOST_AUTO_TEST_CASE(an_index_may_be_given_twice_in_one_handle)
{
  const Bar_edit edit;
  Handles handles = edit.handles;
  handles[1].indices.push_back(handles[1].indices.front());
  const auto a = deform(edit.points, edit.handles), b = deform(edit.points, handles);
  BOOST_TEST(pcs_test::largest_distance(a.points, b.points) < 1e-12);
}

BOOST_AUTO_TEST_CASE(a_handle_outside_the_region_is_refused)
{
  const Bar_edit edit;
  Options options;
  options.region_of_interest =
      pcs_test::select(edit.points, [](const Vec3& p) { return p.z() > 2; });
  BOOST_CHECK_EXCEPTION(deform(edit.points, edit.handles, options),
                        Invalid_input,
                        message_has("region of interest"));
  options.region_of_interest = std::vector<std::size_t>{edit.points.size()};
  BOOST_CHECK_EXCEPTION(deform(edit.points, edit.handles, options),
                        Invalid_input,
                        message_has("out of range"));
  options.region_of_interest = std::vector<std::size_t>();
  BOOST_CHECK_THROW(deform(edit.points, edit.handles, options), Invalid_input);
}

BOOST_AUTO_TEST_CASE(motions_that_are_not_finite_are_refused)
{
  const Bar_edit edit;
  for (const double bad : {not_a_number, infinity, 1e300}) {
    Handles handles = edit.handles;
    handles[1].transformation = pcs::translation(Vec3(bad, 0, 0));
    BOOST_CHECK_THROW(deform(edit.points, handles), Invalid_input);
  }
  const auto turn = [](double angle) { return pcs::Similarity::from_turn(Vec3(0, 0, angle)); };
  for (const double bad : {not_a_number, infinity, 1e300, -1e12})
    BOOST_CHECK_EXCEPTION(turn(bad), Invalid_input, message_has("turn"));
  const pcs::Similarity large = turn(0.9e12);
  BOOST_CHECK_EXCEPTION(large * large, Invalid_input, message_has("1.8e+12 rad"));
}

BOOST_AUTO_TEST_CASE(softness_out_of_range_is_refused)
{
  const Bar_edit edit;
  for (const double bad : {-1.0, not_a_number, infinity}) {
    Handles handles = edit.handles;
    handles[1].softness = bad;
    BOOST_CHECK_EXCEPTION(deform(edit.points, handles), Invalid_input, message_has("softness"));
  }
}

BOOST_AUTO_TEST_CASE(every_softness_gives_a_finite_result)
{
  const Bar_edit edit;
  for (const double softness : {1e-9, 1.0, 1e9})
    for (const long long samples : {150, 1000000}) {
      Handles handles = edit.handles;
      handles[1].softness = softness;
      const auto result = deform(edit.points, handles, with_samples(samples));
      BOOST_TEST(is_finite(result), "softness " << softness);
      for (auto& handle : handles) // no exact handles
        handle.softness = softness;
      BOOST_TEST(is_finite(deform(edit.points, handles, with_samples(samples))),
                 "softness " << softness << " of all handles");
    }
  for (const double softness : {-1.0, 1e-300, 1e16, 1e300}) {
    Handles handles = edit.handles;
    handles[1].softness = softness;
    BOOST_CHECK_EXCEPTION(deform(edit.points, handles, with_samples(150)),
                          pcs::Invalid_input,
                          message_has("between 1e-9 and 1e9"));
  }
}

BOOST_AUTO_TEST_CASE(a_small_soft_handle_is_held_on_every_level)
{
  // For 1000 samples or more, the handle contains no node of the coarser networks.
  const Points points = pcs_test::box(20, 20, 40, 0.1);
  for (const std::size_t i : {0u, 77u, 301u})
    for (const long long samples : {1000, 1000000}) {
      const Vec3 shift(1, 2, 3);
      const auto result =
          deform(points, {{{i}, pcs::translation(shift), 1}}, with_samples(samples));
      BOOST_TEST(result.report.status != Status::numerical_failure);
      for (std::size_t k = 0; k < points.size(); ++k)
        BOOST_REQUIRE((result.points[k] - (points[k] + shift)).norm() < 1e-6);
    }
}

BOOST_AUTO_TEST_CASE(small_exact_handles_are_held_on_every_level)
{
  // Same with exact handles, which contain no nodes but have some on their border.
  const Points points = pcs_test::box(20, 20, 40, 0.1);
  const Vec3 shift(1, 2, 3);
  for (const std::size_t i : {0u, 77u, 301u})
    for (const std::size_t n : {1u, 3u, 30u})
      for (const long long samples : {1000, 1300, 1000000}) {
        std::vector<std::size_t> indices;
        for (std::size_t k = 0; k < n; ++k)
          indices.push_back(i + k);
        const auto result =
            deform(points, {{indices, pcs::translation(shift)}}, with_samples(samples));
        BOOST_TEST(result.report.status == Status::converged,
                   i << ", " << n << " points, " << samples << " samples");
        for (std::size_t k = 0; k < points.size(); ++k)
          BOOST_REQUIRE((result.points[k] - (points[k] + shift)).norm() < 1e-6);
      }
}

BOOST_AUTO_TEST_CASE(two_small_exact_handles_are_both_where_they_should_be)
{
  const Points points = pcs_test::box(20, 20, 40, 0.1);
  const Vec3 shift(0.1, 0, 0.1);
  for (const long long samples : {1000, 1300, 1000000}) {
    const auto result = deform(
        points,
        {{{77}, pcs::translation(Vec3::Zero())}, {{points.size() - 20}, pcs::translation(shift)}},
        with_samples(samples));
    BOOST_TEST(result.report.status != Status::numerical_failure);
    BOOST_TEST((result.points[77] - points[77]).norm() < 1e-9);
    const std::size_t moved = points.size() - 20;
    BOOST_TEST((result.points[moved] - (points[moved] + shift)).norm() < 1e-9);
    for (std::size_t k = 0; k < points.size(); ++k)
      BOOST_REQUIRE((result.points[k] - points[k]).norm() < 1);
  }
}

BOOST_AUTO_TEST_CASE(soft_handles_lie_between_free_and_exact)
{
  const Bar_edit edit;
  const auto shift = pcs::translation(Vec3(0, 0, 1));
  for (const long long samples : {150, 1000000}) {
    double before = 1e9;
    for (const double softness : {0.0, 0.01, 1.0, 100.0, 1e4}) {
      Handles handles = edit.handles;
      handles[1].transformation = shift;
      handles[1].softness = softness;
      const auto result = deform(edit.points, handles, with_samples(samples));
      double mean = 0;
      for (const auto i : handles[1].indices)
        mean += (result.points[i] - edit.points[i]).z() / double(handles[1].indices.size());
      BOOST_TEST_MESSAGE("softness " << softness << ", " << samples << " samples: " << mean);
      BOOST_TEST(mean <= 1 + 1e-9);
      BOOST_TEST(mean >= -1e-9);
      BOOST_TEST(mean < before + 1e-9);
      if (softness == 0)
        BOOST_TEST(std::abs(mean - 1) < 1e-12);
      before = mean;
    }
    BOOST_TEST(before < 0.2);
  }
}

BOOST_AUTO_TEST_CASE(a_handle_of_everything_moves_everything)
{
  const Points points = pcs_test::random_points(500, 1);
  for (const long long samples : {50, 1000000}) {
    const auto motion = some_motion() * pcs::scaling(2, Vec3(0, 0, 0));
    const auto result = deform(points, {{all_of(points), motion, 0}}, with_samples(samples));
    for (std::size_t i = 0; i < points.size(); ++i)
      BOOST_REQUIRE((result.points[i] - motion(points[i])).norm() < 1e-13);
  }
}

BOOST_AUTO_TEST_CASE(one_handle_of_one_point_moves_everything_rigidly)
{
  const Bar_edit edit;
  for (const long long samples : {50, 1000000})
    for (const std::size_t i : {std::size_t(0), std::size_t(321)}) {
      const auto result = deform(edit.points, {{{i}, some_motion(), 0}}, with_samples(samples));
      double largest = 0;
      for (std::size_t j = 0; j < edit.points.size(); ++j)
        largest = std::max(largest, (result.points[j] - some_motion()(edit.points[j])).norm());
      BOOST_TEST(largest < 1e-9);
    }
}

BOOST_AUTO_TEST_CASE(handles_need_not_be_contiguous)
{
  const Bar_edit edit;
  // One handle contains both ends, the second a ring in the middle, the third a single point.
  Handles handles(3);
  for (std::size_t i = 0; i < edit.points.size(); ++i) {
    const double z = edit.points[i].z();
    if (z < .2 || z > 3.8)
      handles[0].indices.push_back(i);
    else if (z > 1.9 && z < 2.1)
      handles[1].indices.push_back(i);
  }
  handles[2].indices = {
      pcs_test::select(edit.points, [](const Vec3& p) { return p.z() > .9 && p.z() < 1.1; })[0]};
  handles[1].transformation = pcs::translation(Vec3(.5, 0, 0));
  handles[2].transformation = pcs::translation(Vec3(.2, .1, 0));
  check_at_all_resolutions(edit.points, handles);
}

BOOST_AUTO_TEST_CASE(scaled_handles_swell_what_lies_between)
{
  const Bar_edit edit;
  Handles handles = edit.handles;
  handles[0].transformation = Similarity();
  handles[1].transformation = pcs::scaling(2, Vec3(.5, .5, 4));
  for (const long long samples : {150, 1000000}) {
    const auto result = deform(edit.points, handles, with_samples(samples));
    const auto width_at = [&](double z) {
      Eigen::AlignedBox3d box;
      for (std::size_t i = 0; i < edit.points.size(); ++i)
        if (std::abs(edit.points[i].z() - z) < 1e-9)
          box.extend(result.points[i]);
      return box.sizes().x();
    };
    BOOST_TEST(width_at(0) == 1, boost::test_tools::tolerance(1e-9));
    BOOST_TEST(width_at(1) < width_at(2));
    BOOST_TEST(width_at(2) == std::sqrt(2.0), boost::test_tools::tolerance(0.1));
    BOOST_TEST(width_at(2) < width_at(3));
    BOOST_TEST(width_at(4) == 2, boost::test_tools::tolerance(1e-9));
  }
}

BOOST_AUTO_TEST_CASE(huge_and_tiny_motions_give_finite_results)
{
  const Bar_edit edit;
  for (const double factor : {1e-11, 1e-6, 1e6, 1e11})
    for (const long long samples : {150, 1000000}) {
      Handles handles = edit.handles;
      handles[1].transformation = pcs::scaling(factor, Vec3(.5, .5, 4));
      BOOST_TEST(is_finite(deform(edit.points, handles, with_samples(samples))),
                 "scale " << factor);
      handles[1].transformation = pcs::translation(Vec3(factor, 0, factor));
      BOOST_TEST(is_finite(deform(edit.points, handles, with_samples(samples))),
                 "shift " << factor);
    }
}

BOOST_AUTO_TEST_CASE(half_a_turn_and_more_is_finite_in_any_direction)
{
  const Bar_edit edit;
  std::mt19937 random(5);
  for (int repetition = 0; repetition < 20; ++repetition) {
    Handles handles = edit.handles;
    for (auto& handle : handles)
      handle.transformation = pcs::rotation(pcs_test::random_direction(random),
                                            20 * pcs_test::uniform(random),
                                            pcs_test::random_vector(random)) *
                              pcs::rotation(pcs_test::random_direction(random), 3.0, Vec3(0, 0, 0));
    for (const long long samples : {150, 1000000})
      BOOST_TEST(is_finite(deform(edit.points, handles, with_samples(samples))));
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(deformation_parameters)

namespace {

template <class Change>
void check_refused(const char* name, const Change& change)
{
  const Bar_edit edit;
  Options options;
  change(options);
  BOOST_CHECK_EXCEPTION(deform(edit.points, edit.handles, options),
                        Invalid_input,
                        message_has(name));
}

} // namespace

BOOST_AUTO_TEST_CASE(counts_out_of_range_are_refused)
{
  const long long far = std::numeric_limits<long long>::max();
  for (const long long bad : {0ll, -1ll, far, -far})
    check_refused("number_of_samples", [=](Options& o) { o.number_of_samples = bad; });
  for (const long long bad : {0ll, 1ll, 61ll, -6ll, far})
    check_refused("number_of_neighbors", [=](Options& o) { o.number_of_neighbors = bad; });
  for (const long long bad : {0ll, 33ll, -1ll, far})
    check_refused("number_of_sample_neighbors",
                  [=](Options& o) { o.number_of_sample_neighbors = bad; });
  for (const long long bad : {-1ll, far})
    check_refused("number_of_iterations", [=](Options& o) { o.number_of_iterations = bad; });
}

BOOST_AUTO_TEST_CASE(quantities_out_of_range_are_refused)
{
  for (const double bad : {-1e-9, not_a_number, infinity})
    check_refused("tolerance", [=](Options& o) { o.tolerance = bad; });
  for (const double bad : {0.0, -1.0, 1e-4, 1e4, not_a_number, infinity})
    check_refused("stiffness", [=](Options& o) { o.stiffness = bad; });
  for (const double bad : {-1.01, 0.51, not_a_number, infinity})
    check_refused("poisson_ratio", [=](Options& o) { o.poisson_ratio = bad; });
}

BOOST_AUTO_TEST_CASE(the_ends_of_the_ranges_are_accepted)
{
  const Bar_edit edit;
  const auto check_accepted = [&](const auto& change) {
    Options options;
    options.number_of_samples = 200;
    change(options);
    check(edit.points, edit.handles, options);
  };
  check_accepted([](Options& o) { o.number_of_samples = 1; });
  check_accepted([](Options& o) { o.number_of_samples = 4294967295; });
  check_accepted([](Options& o) { o.number_of_neighbors = 2; });
  check_accepted([](Options& o) { o.number_of_neighbors = 60; });
  check_accepted([](Options& o) { o.number_of_sample_neighbors = 1; });
  check_accepted([](Options& o) { o.number_of_sample_neighbors = 32; });
  check_accepted([](Options& o) { o.number_of_iterations = 0; });
  check_accepted([](Options& o) { o.tolerance = 0; });
  check_accepted([](Options& o) { o.stiffness = 1e-3; });
  check_accepted([](Options& o) { o.stiffness = 1e3; });
  check_accepted([](Options& o) { o.poisson_ratio = -1; });
  check_accepted([](Options& o) { o.poisson_ratio = 0.5; });
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(deformation_callback)

BOOST_AUTO_TEST_CASE(values_grow_from_0_to_1)
{
  const Bar_edit edit;
  for (const long long samples : {150, 1000000}) {
    std::vector<double> values;
    std::vector<std::thread::id> threads;
    Options options = with_samples(samples);
    options.callback = [&](double f) {
      values.push_back(f);
      threads.push_back(std::this_thread::get_id());
      return true;
    };
    BOOST_TEST((deform(edit.points, edit.handles, options).report.status == Status::converged));
    BOOST_REQUIRE(values.size() >= 4u);
    for (std::size_t i = 0; i < values.size(); ++i) {
      BOOST_TEST((values[i] >= 0 && values[i] <= 1));
      BOOST_TEST((i == 0 || values[i] >= values[i - 1]), "value " << values[i]);
      BOOST_TEST((threads[i] == std::this_thread::get_id()));
    }
    BOOST_TEST(values.back() == 1, boost::test_tools::tolerance(1e-12));
  }
}

BOOST_AUTO_TEST_CASE(cancelling_at_any_time_leaves_every_bit)
{
  const Bar_edit edit;
  for (const long long samples : {150, 1000000}) {
    int total = 0;
    Options options = with_samples(samples);
    options.callback = [&](double) { return ++total > 0; };
    deform(edit.points, edit.handles, options);
    for (int stop = 1; stop <= total; ++stop) { // the last call comes before points are written
      int calls = 0;
      options.callback = [&](double) { return ++calls < stop; };
      const auto result = deform(edit.points, edit.handles, options);
      BOOST_TEST(result.report.status == Status::cancelled, "stopped at call " << stop);
      BOOST_TEST(is_untouched(result, edit.points));
      BOOST_TEST(calls == stop, "no call after the answer false");
    }
  }
}

BOOST_AUTO_TEST_CASE(an_exception_of_the_callback_passes_through)
{
  const Bar_edit edit;
  for (const long long samples : {150, 1000000}) {
    int total = 0;
    Options options = with_samples(samples);
    options.callback = [&](double) { return ++total > 0; };
    deform(edit.points, edit.handles, options);
    for (int stop = 1; stop <= total; ++stop) {
      int calls = 0;
      options.callback = [&](double) -> bool {
        if (++calls == stop)
          throw std::range_error("enough");
        return true;
      };
      // deform() of the tests checks that the points are unchanged.
      BOOST_CHECK_THROW(deform(edit.points, edit.handles, options), std::range_error);
    }
  }
}

/// Writes points, and throws instead of writing the last one that it may write.
struct Failing_map
{
  using key_type = Vec3;
  using value_type = Vec3;
  using reference = const Vec3&;
  using category = boost::lvalue_property_map_tag;

  long* number_of_writes; ///< that remain; there is no limit if it is negative

  friend const Vec3& get(const Failing_map&, const Vec3& p) { return p; }
  friend void put(const Failing_map& map, Vec3& p, const Vec3& value)
  {
    if (--*map.number_of_writes == 0)
      throw std::range_error("the map is full");
    p = value;
  }
};

BOOST_AUTO_TEST_CASE(reset_restores_all_points_after_an_exception_of_a_map)
{
  const Bar_edit edit;
  for (const long long samples : {150, 1000000})
    for (const long limit : {1, 10, 400}) {
      Points points = edit.points;
      long left = -1;
      const auto np = pcs::parameters::point_map(Failing_map{&left}).number_of_samples(samples);
      pcs::Point_set_deformation<Points, decltype(np), CGAL::Sequential_tag> session(points, np);
      for (const auto& handle : edit.handles)
        session.add_handle(handle.indices);
      const auto move = [&] { session.set_translation(1, Vec3(.1, .2, .3)); };
      const auto largest_distance = [&] {
        double result = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
          result = std::max(result, (points[i] - edit.points[i]).norm());
        return result;
      };
      BOOST_TEST_CONTEXT(samples << " samples, write " << limit << " fails")
      {
        move();
        left = limit;
        BOOST_CHECK_THROW(session.deform(), std::range_error);
        left = -1;
        session.reset();
        BOOST_TEST(largest_distance() < 1e-12);
        move();
        session.deform();
        BOOST_TEST(largest_distance() > .3);
        left = limit;
        BOOST_CHECK_THROW(session.reset(), std::range_error);
        left = -1;
        session.reset();
        BOOST_TEST(largest_distance() < 1e-12);
      }
    }
}

BOOST_AUTO_TEST_CASE(an_empty_callback_is_none)
{
  const Bar_edit edit;
  Points points = edit.points;
  const auto report =
      pcs::deform_point_set(points,
                            edit.handles,
                            pcs::parameters::callback(std::function<bool(double)>()));
  BOOST_TEST(report.status == Status::converged);
}

BOOST_AUTO_TEST_CASE(the_callback_is_asked_during_a_long_solve)
{
  const Bar_edit edit(10, 40);
  Options options;
  options.number_of_iterations = 50;
  options.tolerance = 0;
  int calls = 0;
  options.callback = [&](double) { return ++calls > 0; };
  const auto report = deform(edit.points, edit.handles, options).report;
  BOOST_TEST(calls >= static_cast<int>(report.number_of_iterations));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(deformation_random)

BOOST_AUTO_TEST_CASE(random_edits_have_defined_results)
{
  for (unsigned seed = 1; seed <= 3000; ++seed) {
    const std::string fault = pcs_test::fault_of(pcs_test::random_edit(seed));
    BOOST_TEST(fault.empty(), "seed " << seed << ": " << fault);
  }
}

BOOST_AUTO_TEST_CASE(a_soft_handle_holds_a_body_of_one_sample)
{
  const Bar_edit edit;
  const auto shift = pcs::translation(Vec3(1, 2, 3));
  const auto result = deform(edit.points, {{all_of(edit.points), shift, 0.5}}, with_samples(1));
  BOOST_TEST(result.report.status != Status::numerical_failure);
  BOOST_TEST((result.points[0] - shift(edit.points[0])).norm() < 1e-9);
}

// The border of an exact handle may lie next to the only sample, which a stiff spring attracts.
BOOST_AUTO_TEST_CASE(few_samples_throw_no_point_away)
{
  const Bar_edit edit;
  const double size = pcs_test::diagonal(edit.points);
  for (const int samples : {1, 2, 3})
    for (std::size_t exact = 0; exact < edit.points.size(); exact += 11) {
      const std::size_t drawn = (exact + 1) % edit.points.size();
      const auto shift = pcs::translation(Vec3(0, size, 0));
      const auto result = deform(edit.points,
                                 {{{exact}, pcs::Similarity(), 0}, {{drawn}, shift, 1e-9}},
                                 with_samples(samples));
      BOOST_TEST(pcs_test::largest_distance(result.points, edit.points) < 2.5 * size);
    }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deformation_robustness

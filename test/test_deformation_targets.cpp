// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One target per point of a handle: exact points reach them, soft ones are pulled, others follow.

#include <pcs/Point_set_deformation.h>
#include <pcs/deform_point_set.h>
#include <support/deform_cloud.h>
#include <support/exceptions.h>
#include <support/threads.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace test_deformation_targets {

namespace {

using pcs::Invalid_input;
using pcs_test::message_has;
using pcs_test::Points;
using pcs_test::Vec3;
using Indices = std::vector<std::size_t>;

constexpr double pi = 3.14159265358979323846;
/// All points are samples, with and without coarse levels; sampled, with and without coarse levels.
const int all_resolutions[] = {1000000, 1200, 300};
const double all_softnesses[] = {0, .1};

auto parameters(int samples)
{
  return pcs::parameters::number_of_samples(samples);
}
template <class Tag>
using Session_of = pcs::Point_set_deformation<Points, decltype(parameters(0)), Tag>;
using Session = Session_of<CGAL::Parallel_if_available_tag>;

/// A bar of 0.8 x 0.8 x 6, whose lower end is fixed. Coordinates have all bits.
struct Bar
{
  Points rest, points; ///< the session writes `points`
  Indices low, high;
  Session session;
  std::size_t handle;

  explicit Bar(int samples, double softness = 0)
    : rest(make()),
      points(rest),
      low(pcs_test::select(rest, [](const Vec3& p) { return p.z() < .35; })),
      high(pcs_test::select(rest, [](const Vec3& p) { return p.z() > 4.95; })),
      session(points, parameters(samples))
  {
    session.add_handle(low);
    handle = session.add_handle(high, softness);
  }

  static Points make()
  {
    Points result = pcs_test::box(8, 8, 60, .1);
    for (Vec3& p : result)
      p += Vec3(1e-9, -2e-9, 3e-9);
    return result;
  }

  template <class Map>
  Points targets(const Map& map) const
  {
    Points result;
    for (const auto i : high)
      result.push_back(map(rest[i]));
    return result;
  }

  /// Sets the targets, deforms, and returns the largest distance of a point from its target.
  template <class Map>
  double deform(const Map& map)
  {
    const Points target = targets(map);
    session.set_targets(handle, target);
    session.deform();
    double result = 0;
    for (std::size_t k = 0; k < high.size(); ++k)
      result = std::max(result, (points[high[k]] - target[k]).norm());
    return result;
  }
};

pcs::Similarity motion()
{
  return pcs::translation(Vec3(.5, 0, -.3)) * pcs::rotation(Vec3(0, 1, .3), 1.1, Vec3(0, 0, 4));
}

/// Bends the bar above z = 5 into an arc of curvature 1.2 in the direction x.
Vec3 bend(const Vec3& p)
{
  const double radius = 1 / 1.2, angle = (p.z() - 5) / radius, from = radius - (p.x() - .4);
  return {.4 + radius - from * std::cos(angle), p.y(), 5 + from * std::sin(angle)};
}

/// Shears the bar above z = 5 so that its axis becomes a parabola with the slope 1 at the end.
Vec3 lean(const Vec3& p)
{
  const double height = p.z() - 5;
  return {p.x() + .5 * height * height, p.y(), p.z()};
}

Vec3 widen(const Vec3& p)
{
  return {.4 + 1.5 * (p.x() - .4), .4 + 1.5 * (p.y() - .4), p.z()};
}

double largest_difference(const Points& a, const Points& b)
{
  double result = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    result = std::max(result, (a[i] - b[i]).norm());
  return result;
}

/// A function that gives the same value for points of the same height.
template <class Value>
std::map<int, double> largest_by_layer(const Points& rest, const Value& value)
{
  std::map<int, double> result;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    double& largest = result[static_cast<int>(std::lround(10 * rest[i].z()))];
    largest = std::max(largest, value(i));
  }
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(deformation_targets)

BOOST_AUTO_TEST_CASE(targets_of_a_rigid_motion_have_the_result_of_the_motion)
{
  for (const int samples : all_resolutions)
    for (const double softness : all_softnesses) {
      Bar moved(samples, softness), aimed(samples, softness);
      moved.session.set_transformation(moved.handle, motion());
      const auto moved_report = moved.session.deform();
      aimed.session.set_targets(aimed.handle, aimed.targets(motion()));
      const auto aimed_report = aimed.session.deform();
      BOOST_TEST(largest_difference(moved.points, aimed.points) < 1e-9);
      BOOST_TEST(aimed_report.energy == moved_report.energy, boost::test_tools::tolerance(1e-6));
      const auto& fit = aimed.session.transformation(aimed.handle);
      BOOST_TEST((fit.rotation() - motion().rotation()).norm() < 1e-12);
      BOOST_TEST(fit.scale() == 1);
      for (const std::size_t i : {aimed.high[7], aimed.rest.size() / 2})
        BOOST_TEST(
            (aimed.session.deformation_gradient(i) - moved.session.deformation_gradient(i)).norm() <
            1e-8);
    }
}

BOOST_AUTO_TEST_CASE(points_of_an_exact_handle_reach_their_targets_with_all_bits)
{
  std::mt19937 random(5);
  const auto perturb = [&](const Vec3& p) {
    return Vec3(motion()(p) + .02 * pcs_test::random_vector(random));
  };
  for (const int samples : all_resolutions) {
    Bar bar(samples);
    BOOST_TEST(bar.deform(bend) == 0);
    BOOST_TEST(bar.deform(widen) == 0);
    BOOST_TEST(bar.deform(perturb) == 0);
    BOOST_TEST(pcs_test::is_finite(bar.points));
  }
}

BOOST_AUTO_TEST_CASE(soft_springs_pull_points_to_their_targets)
{
  for (const int samples : all_resolutions) {
    double last = 0;
    for (const double softness : {1e-4, .1, 10.}) {
      const double distance = Bar(samples, softness).deform(widen);
      BOOST_TEST(distance > last);
      last = distance;
    }
    BOOST_TEST(last < .4); // the motion without the targets of the points misses them by 0.28
  }
  BOOST_TEST(Bar(1000000, 1e-4).deform(widen) < 1e-4);
}

BOOST_AUTO_TEST_CASE(the_width_between_handles_is_monotone)
{
  for (const int samples : all_resolutions)
    for (const double softness : {0., 1e-3}) {
      Bar bar(samples, softness);
      bar.deform(widen);
      const auto width = largest_by_layer(bar.rest, [&](std::size_t i) {
        return std::abs(bar.points[i].x() - .4);
      });
      double before = 0;
      for (const auto& [layer, half] : width) {
        if (layer > 49)
          break;
        BOOST_TEST(half > before - .03); // of 0.2
        BOOST_TEST(half < .6 + .015);
        before = half;
      }
      BOOST_TEST(before > .44);
    }
}

BOOST_AUTO_TEST_CASE(the_border_of_a_bent_handle_has_neither_gap_nor_kink)
{
  for (const int samples : {800, 200}) {
    const Points rest = pcs_test::box(16, 16, 120, .05);
    Points points = rest;
    Session session(points, parameters(samples));
    session.add_handle(pcs_test::select(rest, [](const Vec3& p) { return p.z() < .3; }));
    const Indices high = pcs_test::select(rest, [](const Vec3& p) { return p.z() > 4.98; });
    const auto handle = session.add_handle(high);
    Points targets;
    for (const auto i : high)
      targets.push_back(lean(rest[i]));
    session.set_targets(handle, targets);
    session.deform();
    const double tilt = session.transformation(handle).total_angle();
    BOOST_TEST(tilt > .25);
    double slope = 0;
    for (std::size_t i = 1; i < rest.size(); ++i)
      if (std::abs(rest[i].z() - 5) < 1e-6 && std::abs(rest[i - 1].z() - 4.95) < 1e-6)
        slope = std::max(slope, (points[i] - points[i - 1] - Vec3(0, 0, .05)).norm() / .05);
    BOOST_TEST(slope < .5 * tilt);
  }
}

BOOST_AUTO_TEST_CASE(gradients_and_rotations_of_a_handle_are_those_of_its_targets)
{
  for (const int samples : all_resolutions) {
    Bar bar(samples);
    bar.deform(lean);
    double largest = 0;
    for (const auto i : bar.high)
      if (bar.rest[i].z() < 5.9) {
        const Vec3& p = bar.rest[i];
        const bool is_side = p.x() < 1e-6 || p.x() > .8 - 1e-6;
        const Vec3 tangent = is_side ? Vec3(0, 1, 1) : Vec3(1, 0, 0);
        const double step = 1e-5;
        const Vec3 expected = (lean(p + step * tangent) - lean(p - step * tangent)) / (2 * step);
        largest = std::max(largest,
                           (bar.session.deformation_gradient(i) * tangent - expected).norm() /
                               tangent.norm());
      }
    BOOST_TEST(largest < (samples > 1000 ? .1 : .2)); // the rigid fit differs by 0.5
  }
}

BOOST_AUTO_TEST_CASE(normals_of_a_handle_are_those_of_the_surface_through_the_targets)
{
  using Element = std::pair<Vec3, Vec3>;
  const Points sphere = pcs_test::sphere(3000);
  const Vec3 axes(1, 1.6, .8);
  std::vector<Element> elements;
  Indices upper, lower;
  for (const Vec3& p : sphere) {
    (p.z() > .3 ? upper : lower).push_back(elements.size());
    elements.emplace_back(p, p);
  }
  lower.erase(std::remove_if(lower.begin(),
                             lower.end(),
                             [&](std::size_t i) { return sphere[i].z() > -.8; }),
              lower.end());
  for (const int samples : {10000, 500}) {
    std::vector<Element> points = elements;
    pcs::Point_set_deformation session(
        points,
        pcs::parameters::point_map(CGAL::First_of_pair_property_map<Element>())
            .normal_map(CGAL::Second_of_pair_property_map<Element>())
            .number_of_samples(samples));
    session.add_handle(lower);
    Points targets;
    for (const auto i : upper)
      targets.push_back(axes.cwiseProduct(sphere[i]));
    session.set_targets(session.add_handle(upper), targets);
    session.deform();
    double largest = 0;
    for (const auto i : upper) {
      if (sphere[i].z() < .4)
        continue;
      const Vec3 expected = sphere[i].cwiseQuotient(axes).normalized();
      largest = std::max(largest, (points[i].second - expected).norm());
      BOOST_TEST(std::abs(points[i].second.norm() - 1) < 1e-12);
    }
    BOOST_TEST(largest < .1); // normals that do not turn differ by 0.48
  }
}

BOOST_AUTO_TEST_CASE(wrong_targets_change_nothing)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const int samples : {1000000, 300}) {
    Bar bar(samples);
    bar.deform(bend);
    const Points before = bar.points;
    Points few = bar.targets(widen), broken = few, far = few;
    few.pop_back();
    broken[17].y() = nan;
    far[3].x() = 1e300;
    const auto refuses = [&](const Points& targets, const auto&... words) {
      BOOST_CHECK_EXCEPTION(bar.session.set_targets(bar.handle, targets),
                            Invalid_input,
                            message_has("set_targets()", words...));
    };
    refuses(few,
            "handle 1 has " + std::to_string(bar.high.size()) + " points",
            std::to_string(bar.high.size() - 1) + " targets");
    refuses({}, "but 0 targets are given", "one for each point");
    refuses(broken, "handle 1: target 17 is not finite");
    refuses(far, "handle 1: target 3 is", "extents of the cloud away");
    BOOST_CHECK_EXCEPTION(bar.session.set_targets(7, few),
                          Invalid_input,
                          message_has("there is no handle 7"));
    bar.session.deform();
    BOOST_TEST((bar.points == before));
  }
}

BOOST_AUTO_TEST_CASE(points_at_the_same_place_have_one_target)
{
  for (const int samples : {1000000, 300}) {
    Bar plain(samples);
    plain.deform(bend);
    Points rest = plain.rest;
    Indices high = plain.high;
    rest.push_back(rest[high[4]]);
    high.push_back(rest.size() - 1);
    Points points = rest;
    Session session(points, parameters(samples));
    session.add_handle(plain.low);
    const auto handle = session.add_handle(high);
    Points targets = plain.targets(bend);
    targets.push_back(targets[4] + Vec3(0, 0, .1));
    BOOST_CHECK_EXCEPTION(
        session.set_targets(handle, targets),
        Invalid_input,
        message_has("targets 4 and " + std::to_string(targets.size() - 1), "at the same place"));
    targets.back() = targets[4];
    session.set_targets(handle, targets);
    session.deform();
    for (std::size_t k = 0; k < high.size(); ++k)
      BOOST_TEST((points[high[k]] == targets[k]));
  }
}

BOOST_AUTO_TEST_CASE(a_degenerate_handle_turns_as_little_as_possible)
{
  const auto fit = [](const Points& places, const Points& targets) {
    Points points = pcs_test::box(4, 4, 20, .25);
    Indices indices;
    for (const Vec3& p : places)
      for (std::size_t i = 0; i < points.size(); ++i)
        if ((points[i] - p).norm() < 1e-9)
          indices.push_back(i);
    BOOST_TEST(indices.size() == places.size());
    Session session(points, parameters(1000));
    const auto handle = session.add_handle(indices);
    session.set_targets(handle, targets);
    session.deform();
    BOOST_TEST(pcs_test::is_finite(points));
    for (std::size_t k = 0; k < indices.size(); ++k)
      BOOST_TEST((points[indices[k]] == targets[k]));
    return session.transformation(handle);
  };
  const Vec3 a(0, 0, 0), b(0, 0, 1), c(0, 0, 2.5), d(.25, 0, 5), e(.5, 0, 5);
  { // one point
    const auto t = fit({a}, {Vec3(1, 2, 3)});
    BOOST_TEST(t.turns().empty());
    BOOST_TEST((t(a) - Vec3(1, 2, 3)).norm() < 1e-12);
  }
  { // two points: the mean is kept, the direction turns about the shortest arc
    const auto t = fit({a, b}, {Vec3(1, 0, 0), Vec3(4, 0, 0)});
    BOOST_TEST(t.total_angle() == pi / 2, boost::test_tools::tolerance(1e-9));
    BOOST_TEST((t(.5 * (a + b)) - Vec3(2.5, 0, 0)).norm() < 1e-12);
    BOOST_TEST((t.rotation() * Vec3(0, 0, 1) - Vec3(1, 0, 0)).norm() < 1e-12);
    BOOST_TEST((t.rotation() * Vec3(0, 1, 0) - Vec3(0, 1, 0)).norm() < 1e-12);
  }
  { // collinear points, reversed
    const auto t = fit({a, b, c}, {c, Vec3(0, 0, 1.5), a});
    BOOST_TEST(t.total_angle() == pi, boost::test_tools::tolerance(1e-9));
    BOOST_TEST((t.rotation() * Vec3(0, 0, 1) - Vec3(0, 0, -1)).norm() < 1e-9);
  }
  { // collinear points that only move along their line
    const auto t = fit({a, b, c}, {Vec3(0, 0, 1), Vec3(0, 0, 3), Vec3(0, 0, 5)});
    BOOST_TEST(t.total_angle() < 1e-9);
  }
  { // one place for all points
    const auto t = fit({a, b, d, e}, Points(4, Vec3(.1, 3, .1)));
    BOOST_TEST(t.total_angle() == 0);
  }
  { // a mirror image is no rotation: the fit is a proper one
    const auto t = fit({a, b, d, e, Vec3(0, .5, 2)}, {a, b, Vec3(-.25, 0, 5), Vec3(-.5, 0, 5), c});
    BOOST_TEST(t.rotation().determinant() == 1, boost::test_tools::tolerance(1e-9));
  }
}

BOOST_AUTO_TEST_CASE(targets_at_rest_move_nothing)
{
  for (const int samples : {1000000, 300}) {
    Bar bar(samples);
    bar.deform([](const Vec3& p) { return p; });
    BOOST_TEST(largest_difference(bar.points, bar.rest) < 1e-12);
    for (const auto i : bar.high)
      BOOST_TEST((bar.points[i] == bar.rest[i]));
    BOOST_TEST(bar.session.transformation(bar.handle).is_identity());
    bar.deform(bend);
    BOOST_TEST((bar.points != bar.rest));
    bar.deform([](const Vec3& p) { return p; });
    BOOST_TEST((bar.points[bar.high[3]] == bar.rest[bar.high[3]]));
  }
}

BOOST_AUTO_TEST_CASE(targets_whose_rigid_fit_is_the_identity_move_points)
{
  const auto stretch = [](const Vec3& p) { return Vec3(p.x(), p.y(), 5.5 + 1.25 * (p.z() - 5.5)); };
  for (const int samples : {1000000, 300}) {
    Points rest = pcs_test::box(8, 8, 60, .125), points = rest;
    const Indices middle =
        pcs_test::select(rest, [](const Vec3& p) { return p.z() > 4.9 && p.z() < 6.1; });
    Session session(points, parameters(samples));
    const auto handle = session.add_handle(middle);
    Points targets;
    for (const auto i : middle)
      targets.push_back(stretch(rest[i]));
    session.set_targets(handle, targets);
    session.deform();
    BOOST_TEST(session.transformation(handle).translation().norm() < 1e-12);
    BOOST_TEST((points[middle[0]] == targets[0]));
    session.set_transformation(handle, pcs::Similarity());
    session.deform();
    BOOST_TEST((points[middle[0]] == rest[middle[0]]));
  }
}

BOOST_AUTO_TEST_CASE(the_next_motion_replaces_the_targets)
{
  for (const int samples : {1000000, 300}) {
    Bar plain(samples), bar(samples);
    plain.session.set_transformation(plain.handle, motion());
    plain.session.deform();
    bar.deform(bend);
    bar.session.set_transformation(bar.handle, motion());
    bar.session.deform();
    BOOST_TEST((bar.points == plain.points));
    BOOST_TEST(bar.deform(widen) == 0);
    Bar wide(samples);
    wide.deform(widen);
    BOOST_TEST((bar.points == wide.points));
    bar.session.set_translation(bar.handle, Vec3(0, 0, .5));
    const auto& t = bar.session.transformation(bar.handle);
    BOOST_TEST((t.translation() - Vec3(0, 0, .5)).norm() < 1e-8); // the fit of `widen` is at rest
    bar.session.deform();
    BOOST_TEST((bar.points[bar.high[0]] - bar.rest[bar.high[0]] - Vec3(0, 0, .5)).norm() < 1e-8);
  }
}

BOOST_AUTO_TEST_CASE(snapshots_keep_targets)
{
  for (const int samples : all_resolutions) {
    Bar bar(samples);
    bar.deform(bend);
    const Points bent = bar.points;
    const auto snapshot = bar.session.snapshot();
    bar.deform(widen);
    const Points wide = bar.points;
    const auto later = bar.session.snapshot();
    bar.session.restore(snapshot);
    BOOST_TEST((bar.points == bent));
    bar.session.deform();
    BOOST_TEST((bar.points == bent));
    const Eigen::Matrix3d gradient = bar.session.deformation_gradient(bar.high[9]);

    bar.session.remove_handle(bar.handle); // undone with its targets
    bar.session.set_translation(bar.session.add_handle(Indices{bar.high[0]}), Vec3(0, 0, .1));
    bar.session.deform();
    BOOST_TEST((bar.points != bent));
    bar.session.restore(snapshot);
    BOOST_TEST((bar.points == bent));
    BOOST_TEST((bar.session.deformation_gradient(bar.high[9]) == gradient));
    bar.session.deform();
    BOOST_TEST((bar.points == bent));
    bar.session.restore(later);
    BOOST_TEST((bar.points == wide));

    bar.session.reset();
    BOOST_TEST((bar.points == bar.rest));
    bar.session.deform();
    BOOST_TEST(largest_difference(bar.points, bar.rest) < 1e-12);
    bar.session.restore(snapshot);
    BOOST_TEST((bar.points == bent));
  }
}

BOOST_AUTO_TEST_CASE(a_cancelled_solve_keeps_the_targets_of_the_shape)
{
  Points points = Bar::make();
  const Points rest = points;
  bool does_continue = true;
  const std::function<bool(double)> callback = [&](double) { return does_continue; };
  pcs::Point_set_deformation session(points,
                                     pcs::parameters::number_of_samples(300).callback(callback));
  const Bar bar(300);
  session.add_handle(bar.low);
  const auto handle = session.add_handle(bar.high);
  session.set_targets(handle, bar.targets(bend));
  session.deform();
  const Points bent = points;
  const auto snapshot = session.snapshot();
  const Eigen::Matrix3d gradient = session.deformation_gradient(bar.high[9]);
  session.set_targets(handle, bar.targets(widen));
  does_continue = false;
  BOOST_TEST(session.deform().status == pcs::Status::cancelled);
  BOOST_TEST((points == bent));
  BOOST_TEST((session.deformation_gradient(bar.high[9]) == gradient));
  session.restore(snapshot);
  BOOST_TEST((points == bent));
}

BOOST_AUTO_TEST_CASE(an_accepted_shape_has_no_targets)
{
  for (const int samples : {1000000, 300}) {
    Bar bar(samples);
    bar.deform(bend);
    const Points bent = bar.points;
    bar.session.accept();
    bar.session.deform();
    BOOST_TEST(largest_difference(bar.points, bent) < 1e-12);
    bar.session.set_targets(bar.handle, bar.targets([](const Vec3& p) {
      return Vec3(bend(p) + Vec3(0, 0, .1));
    }));
    BOOST_TEST((bar.session.transformation(bar.handle).translation() - Vec3(0, 0, .1)).norm() <
               1e-9);
  }
}

BOOST_AUTO_TEST_CASE(points_outside_the_session_follow_the_targets)
{
  for (const int samples : all_resolutions) {
    Bar bar(samples);
    bar.deform(bend);
    Points same = bar.rest;
    bar.session.apply(same);
    BOOST_TEST(largest_difference(same, bar.points) < 1e-9);
    for (const auto i : bar.high)
      BOOST_TEST((same[i] == bar.points[i]));
    Points between; // on the sides x = const of the handle, between its points
    for (const auto i : bar.high)
      if (bar.rest[i].x() < .01 && bar.rest[i].z() < 5.85 && bar.rest[i].y() < .75)
        between.push_back(bar.rest[i] + Vec3(0, .03, .04));
    Points moved = between;
    bar.session.apply(moved);
    for (std::size_t i = 0; i < between.size(); ++i)
      BOOST_TEST((moved[i] - bend(between[i])).norm() < .01);
  }
}

BOOST_AUTO_TEST_CASE(a_moved_scene_has_a_moved_result)
{
  const auto frame = pcs::translation(Vec3(300, -40, 7)) *
                     pcs::rotation(Vec3(1, 2, 3), 2., Vec3(0, 0, 0)) *
                     pcs::scaling(4, Vec3(0, 0, 0));
  for (const int samples : {1000000, 300}) {
    Bar bar(samples);
    std::mt19937 random(8);
    for (Vec3& p : bar.rest) // without ties of distances
      p += .02 * pcs_test::random_vector(random);
    bar.points = bar.rest;
    bar.session = Session(bar.points, parameters(samples));
    bar.session.add_handle(bar.low);
    bar.handle = bar.session.add_handle(bar.high);
    bar.deform(bend);
    Points moved;
    for (const Vec3& p : bar.rest)
      moved.push_back(frame(p));
    Session session(moved, parameters(samples));
    session.add_handle(bar.low);
    const auto handle = session.add_handle(bar.high);
    session.set_targets(handle, bar.targets([&](const Vec3& p) { return frame(bend(p)); }));
    session.deform();
    double worst = 0;
    for (std::size_t i = 0; i < moved.size(); ++i)
      worst = std::max(worst, (moved[i] - frame(bar.points[i])).norm());
    BOOST_TEST(worst <
               (samples > 1000 ? .1 : .5)); // of a length of 24; other samples, other rounding
  }
}

BOOST_AUTO_TEST_CASE(the_result_does_not_depend_on_threads_or_on_the_way)
{
  for (const int samples : all_resolutions) {
    Bar first(samples);
    first.deform(bend);
    for (const int threads : pcs_test::thread_counts)
      pcs_test::with_threads(threads, [&] {
        Bar bar(samples);
        bar.deform(widen);
        bar.deform(bend);
        BOOST_TEST((bar.points == first.points));
      });
    Points points = first.rest;
    Session_of<CGAL::Sequential_tag> session(points, parameters(samples));
    session.add_handle(first.low);
    session.set_targets(session.add_handle(first.high), first.targets(bend));
    session.deform();
    BOOST_TEST((points == first.points));
  }
}

BOOST_AUTO_TEST_CASE(the_order_of_targets_is_that_of_the_handle)
{
  Bar forward(300), backward(300);
  forward.deform(bend);
  std::reverse(backward.high.begin(), backward.high.end());
  backward.session.remove_handle(backward.handle);
  backward.handle = backward.session.add_handle(backward.high);
  BOOST_TEST(backward.deform(bend) == 0);
  BOOST_TEST(largest_difference(backward.points, forward.points) < 1e-6);
}

BOOST_AUTO_TEST_CASE(a_drag_of_targets_converges_to_the_result_of_a_cold_start)
{
  for (const int samples : {1000000, 300}) {
    Bar bar(samples);
    for (int frame = 1; frame <= 10; ++frame) {
      bar.session.set_targets(bar.handle, bar.targets([&](const Vec3& p) {
        return Vec3(p + .1 * frame * (bend(p) - p));
      }));
      bar.session.deform(pcs::Solver_start::warm);
    }
    for (const auto i : bar.high)
      BOOST_TEST((bar.points[i] - bend(bar.rest[i])).norm() < 1e-12);
    for (int frame = 0; frame < 5; ++frame)
      bar.session.deform(pcs::Solver_start::warm);
    const double warm = bar.session.deform(pcs::Solver_start::warm).energy;
    const double cold = bar.session.deform().energy;
    BOOST_TEST(warm < 1.1 * cold + 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(points_of_a_fragment_follow_the_targets_of_their_handle)
{
  Bar bar(300);
  std::mt19937 random(3);
  Points rest = bar.rest;
  Indices speck;
  for (int k = 0; k < 10; ++k) { // not linked to the bar, and too small for a sample
    speck.push_back(rest.size());
    rest.push_back(Vec3(1.3, .3, 5.5) + .005 * pcs_test::random_vector(random));
  }
  Points points = rest;
  Session session(points, parameters(20));
  session.add_handle(bar.low);
  Indices high = bar.high;
  high.push_back(speck[0]);
  high.push_back(speck[1]);
  const auto handle = session.add_handle(high);
  Points targets = bar.targets([](const Vec3& p) { return p; });
  targets.push_back(rest[speck[0]] + Vec3(0, 2, 0));
  targets.push_back(rest[speck[1]] + Vec3(0, 2, 0));
  session.set_targets(handle, targets);
  session.deform();
  BOOST_TEST((points[speck[0]] == targets[targets.size() - 2]));
  for (const auto i : speck)
    BOOST_TEST((points[i] - rest[i] - Vec3(0, 2, 0)).norm() < .001);
}

BOOST_AUTO_TEST_CASE(points_outside_the_region_of_interest_keep_their_bits)
{
  for (const int samples : {1000000, 300}) {
    const Bar bar(samples);
    const Indices region = pcs_test::select(bar.rest, [](const Vec3& p) { return p.z() > 3.45; });
    Points points = bar.rest;
    pcs::Point_set_deformation session(
        points,
        pcs::parameters::number_of_samples(samples).region_of_interest(std::cref(region)));
    const auto handle = session.add_handle(bar.high);
    const Points targets = bar.targets(bend);
    session.set_targets(handle, targets);
    session.deform();
    double largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (bar.rest[i].z() < 3.45)
        BOOST_TEST((points[i] == bar.rest[i]));
      else
        largest = std::max(largest, (points[i] - bar.rest[i]).norm());
    BOOST_TEST(largest > .4);
    for (std::size_t k = 0; k < targets.size(); ++k)
      BOOST_TEST((points[bar.high[k]] == targets[k]));
  }
}

BOOST_AUTO_TEST_CASE(a_bend_that_begins_at_the_border_leaves_the_rest_at_rest)
{
  for (const int samples : all_resolutions) {
    Bar bar(samples);
    bar.deform(lean);
    BOOST_TEST(bar.session.transformation(bar.handle).total_angle() > .25);
    double worst = 0;
    for (std::size_t i = 0; i < bar.points.size(); ++i)
      if (bar.rest[i].z() < 5)
        worst = std::max(worst, (bar.points[i] - bar.rest[i]).norm());
    BOOST_TEST(worst < (samples > 1000 ? .02 : .09));
  }
}

BOOST_AUTO_TEST_CASE(noise_of_the_targets_hardly_changes_gradients)
{
  for (const int samples : {1000000, 300}) {
    Bar bar(samples);
    std::mt19937 random(4);
    bar.deform([&](const Vec3& p) { return Vec3(p + .02 * pcs_test::random_vector(random)); });
    double sum = 0;
    for (const auto i : bar.high)
      sum += (bar.session.deformation_gradient(i) - Eigen::Matrix3d::Identity()).squaredNorm();
    // The noise of a difference between neighbours is 0.28 of their distance.
    BOOST_TEST(std::sqrt(sum / double(bar.high.size())) < .15);
  }
}

BOOST_AUTO_TEST_CASE(a_stretched_handle_hardly_changes_the_energy_of_an_edit)
{
  for (const int samples : all_resolutions) {
    // The upper half of the handle is stretched, which the points below it hardly notice.
    const auto stretch = [](const Vec3& p) {
      return Vec3(p.x(), p.y(), p.z() + std::max(0., p.z() - 5.5));
    };
    Bar plain(samples), bar(samples);
    plain.session.set_transformation(plain.handle, motion());
    const auto expected = plain.session.deform();
    bar.session.set_targets(bar.handle,
                            bar.targets([&](const Vec3& p) { return motion()(stretch(p)); }));
    const auto report = bar.session.deform();
    BOOST_TEST(report.energy < 1.1 * expected.energy);
    double worst = 0;
    for (std::size_t i = 0; i < bar.points.size(); ++i)
      if (bar.rest[i].z() < 5)
        worst = std::max(worst, (bar.points[i] - plain.points[i]).norm());
    BOOST_TEST(worst < .03);
  }
}

BOOST_AUTO_TEST_CASE(targets_are_points_of_any_kernel)
{
  using Point = CGAL::Simple_cartesian<float>::Point_3;
  Points points = pcs_test::box(4, 4, 20, .25);
  const Points rest = points;
  const Indices top = pcs_test::select(rest, [](const Vec3& p) { return p.z() > 4.8; });
  std::vector<Point> targets;
  for (const auto i : top)
    targets.emplace_back(float(rest[i].x()), float(rest[i].y()), 6.f);
  const Indices bottom = pcs_test::select(rest, [](const Vec3& p) { return p.z() < .3; });
  Session session(points, parameters(300));
  session.add_handle(bottom);
  session.set_targets(session.add_handle(top), targets);
  session.deform();
  for (const auto i : top)
    BOOST_TEST((points[i] == Vec3(rest[i].x(), rest[i].y(), 6)));

  Points once = rest;
  Points same;
  for (const Point& p : targets)
    same.emplace_back(p.x(), p.y(), p.z());
  const std::vector<pcs::Deformation_handle> handles = {{bottom, pcs::Similarity(), 0, {}},
                                                        {top, pcs::Similarity(), 0, same}};
  pcs::deform_point_set(once, handles, parameters(300));
  BOOST_TEST((once == points));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deformation_targets

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Oval cross-sections of axes: found from half of the sections, transported along bends, small
// where data are missing.

#include <pcs/extract_tree_skeleton.h>
#include <pcs/skeleton/axes/Axis_oval.h>
#include <support/axes.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_axis_oval {

using namespace pcs::skeleton;
using Vec2 = Eigen::Vector2d;

namespace {

constexpr double pi = 3.14159265358979323846, radius = 0.1, noise = 0.002;

/// Points of a pipe with the oval cross-section `coefficients`, within the angle `arc` of one side.
/// A bent pipe has a radius of curvature of 3 in the x-z plane.
struct Oval_pipe
{
  Axis axis;
  std::vector<Vec3> points;

  Oval_pipe(const Vec2& coefficients, double arc, bool is_bent, std::size_t count = 4000)
  {
    constexpr double length = 3, bend = 3;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share;
    std::normal_distribution<double> error(0, noise);
    const auto frame = [&](double s, Vec3& center, Vec3& across) {
      const double turn = is_bent ? s / bend : 0;
      center =
          is_bent ? Vec3(bend * (1 - std::cos(turn)), 0, bend * std::sin(turn)) : Vec3(0, 0, s);
      across = Vec3(std::cos(turn), 0, -std::sin(turn));
    };
    Vec3 center, across;
    for (std::size_t k = 0; k < count; ++k) {
      frame(length * share(random), center, across);
      const double a = arc * (share(random) - 0.5);
      const double r =
          radius * (1 + coefficients.x() * std::cos(2 * a) + coefficients.y() * std::sin(2 * a)) +
          error(random);
      points.push_back(center + r * (std::cos(a) * across + std::sin(a) * Vec3::UnitY()));
    }
    for (double s = 0; s <= length + 1e-9; s += 0.06) {
      frame(s, center, across);
      Axis_node node;
      node.point = center;
      node.radius = radius;
      axis.push_back(node);
    }
  }

  /// Fits circles, then refits in each of `rounds` with the oval estimated so far.
  Axis_fit fit(Axis_oval& oval, int rounds, const Oval_options& rules = {}) const
  {
    Axis_fit fit(axis, Fit_model::of(0.02, noise));
    std::vector<Index> segments;
    for (const Vec3& p : points)
      segments.push_back(nearest_place(axis, p).segment);
    fit.set_points(points, segments);
    fit.project();
    for (int round = 0; round <= rounds; ++round) {
      if (round > 0) {
        oval.improve(fit, noise, rules);
        fit.set_points(oval.rounded(points, fit), segments);
        fit.project();
      }
      for (int k = 0; k < 20; ++k)
        BOOST_REQUIRE(fit.iterate(1));
    }
    return fit;
  }
};

/// Mean radius of an axis without its ends.
double mean_radius(const Axis& axis)
{
  double sum = 0;
  for (std::size_t k = 3; k + 3 < axis.size(); ++k)
    sum += axis[k].radius;
  return sum / double(axis.size() - 6);
}

} // namespace

BOOST_AUTO_TEST_SUITE(oval_axes)

BOOST_AUTO_TEST_CASE(half_of_the_sections_tells_the_oval_and_the_radius)
{
  for (const bool is_bent : {false, true})
    for (const Vec2& truth : {Vec2(0.05, 0), Vec2(-0.05, 0), Vec2(0, 0.05), Vec2(0.02, -0.04)}) {
      const Oval_pipe pipe(truth, pi, is_bent);
      Axis_oval unknown(pipe.axis), oval(pipe.axis);
      const double round = mean_radius(pipe.fit(unknown, 0).axis());
      const double known = mean_radius(pipe.fit(oval, 3).axis());
      BOOST_TEST(oval.coefficients().norm() > 0.75 * truth.norm());
      BOOST_TEST(oval.coefficients().norm() < 1.25 * truth.norm());
      BOOST_TEST(std::abs(known / radius - 1) < 0.016, truth.transpose() << ": " << known);
      BOOST_TEST(std::abs(known - radius) < std::abs(round - radius) + 0.002 * radius);
      if (truth.x() != 0 && truth.y() == 0)
        BOOST_TEST(std::abs(round / radius - 1) > 0.05, truth.transpose() << ": " << round);
    }
}

BOOST_AUTO_TEST_CASE(a_pipe_is_no_oval)
{
  for (const double arc : {0.8 * pi, pi, 2 * pi}) {
    const Oval_pipe pipe(Vec2(0, 0), arc, false);
    Axis_oval oval(pipe.axis);
    const double found = mean_radius(pipe.fit(oval, 3).axis());
    BOOST_TEST(oval.coefficients().norm() < 0.01);
    BOOST_TEST(std::abs(found / radius - 1) < 0.015);
  }
}

BOOST_AUTO_TEST_CASE(few_points_and_narrow_arcs_tell_nothing)
{
  const Oval_pipe few(Vec2(0.05, 0), pi, false, 5), narrow(Vec2(0.05, 0), 0.2 * pi, false, 500);
  for (const Oval_pipe& pipe : {few, narrow}) {
    Axis_oval oval(pipe.axis);
    Axis_fit fit(pipe.axis, Fit_model::of(0.02, noise));
    fit.set_points(pipe.points, std::vector<Index>(pipe.points.size(), 20));
    fit.project();
    oval.improve(fit, noise, {});
    BOOST_TEST(oval.coefficients().norm() < 0.02);
  }
}

// Poorly constrained ovals do not accumulate over many rounds.
BOOST_AUTO_TEST_CASE(what_is_usual_counts_in_every_round)
{
  const Oval_pipe pipe(Vec2(0, 0), 0.3 * pi, false, 300);
  Axis_oval oval(pipe.axis);
  pipe.fit(oval, 30);
  BOOST_TEST(oval.coefficients().norm() < 0.04, oval.coefficients().transpose());
}

BOOST_AUTO_TEST_CASE(ovals_are_bounded_and_stay_as_they_are_if_they_are_right)
{
  const Oval_pipe pipe(Vec2(0.05, 0), 2 * pi, false);
  Oval_options rules;
  rules.largest = 0.03;
  Axis_oval small(pipe.axis), oval(pipe.axis);
  pipe.fit(small, 1, rules);
  BOOST_TEST(std::abs(small.coefficients().norm() - 0.03) < 1e-9);
  pipe.fit(oval, 3);
  const Vec2 before = oval.coefficients();
  pipe.fit(oval, 3);
  BOOST_TEST((oval.coefficients() - before).norm() < 0.002);
}

BOOST_AUTO_TEST_SUITE_END()

// The trunk is seen from one side along its whole length: circles would be 6 % too large or too
// small.
BOOST_AUTO_TEST_SUITE(oval_trunks)

BOOST_AUTO_TEST_CASE(a_trunk_that_is_seen_from_one_side_has_its_diameter)
{
  using Kernel = CGAL::Simple_cartesian<double>;
  for (const double side : {0.0, 0.5 * pi}) {
    std::vector<Kernel::Point_3> points;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> share;
    std::normal_distribution<double> error(0, noise);
    while (points.size() < 6000) {
      const double a = side + pi * (share(random) - 0.5), z = 3 * share(random);
      const double r = radius * (1 - 0.05 * z) * (1 + 0.05 * std::cos(2 * a)) + error(random);
      points.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
    pcs::Tree_skeleton<Kernel> tree;
    const auto report = pcs::extract_tree_skeleton(points, tree);
    BOOST_TEST(std::abs(report.diameter_at_breast_height - 0.2 * (1 - 0.05 * 1.3)) < 0.02 * 0.2);
    BOOST_TEST(pcs::warnings(report).empty());
    // The sections are ellipses as scanned: 10 % longer along x than along y.
    std::size_t number_of_nodes = 0;
    for (const auto v : boost::make_iterator_range(vertices(tree))) {
      const auto& node = tree[v];
      if (node.branch != 0 || !node.is_measured || node.point.z() < 0.3 || node.point.z() > 2.7)
        continue;
      ++number_of_nodes;
      BOOST_TEST(std::abs(node.major_radius / node.minor_radius - 1.05 / 0.95) < 0.04);
      BOOST_TEST(std::abs(node.major_axis.x()) > 0.98);
      BOOST_CHECK_CLOSE(node.major_radius * node.minor_radius, node.radius * node.radius, 1e-6);
    }
    BOOST_TEST(number_of_nodes > 5u);
  }
}

BOOST_AUTO_TEST_CASE(a_round_trunk_that_is_seen_from_one_side_remains_round)
{
  using Kernel = CGAL::Simple_cartesian<double>;
  for (const unsigned seed : {3u, 4u, 5u}) {
    std::vector<Kernel::Point_3> points;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share;
    std::normal_distribution<double> error(0, noise);
    while (points.size() < 6000) {
      const double a = pi * (share(random) - 0.5), z = 3 * share(random);
      const double r = radius * (1 - 0.05 * z) + error(random);
      points.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
    pcs::Tree_skeleton<Kernel> tree;
    pcs::extract_tree_skeleton(points, tree);
    for (const auto v : boost::make_iterator_range(vertices(tree)))
      BOOST_TEST(tree[v].major_radius <= 1.02 * tree[v].minor_radius, "at " << tree[v].point.z());
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_axis_oval

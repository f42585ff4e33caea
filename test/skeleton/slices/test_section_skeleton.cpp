// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Components of a slice skeleton: banded systems, circles and ellipses, curvatures, axes and their
// fit.

#include <pcs/Tree_skeletonization.h>
#include <pcs/linear_algebra/Banded_cholesky.h>
#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/section_counts.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <pcs/skeleton/slices/ellipse_fit.h>
#include <pcs/skeleton/slices/principal_curvatures.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Dense>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_sections {

namespace {

using pcs::skeleton::Vec2;
using pcs::skeleton::Vec3;
constexpr double pi = 3.14159265358979323846;

/// Points on an arc of an ellipse, rotated by 0.5 rad and shifted.
std::vector<Vec2> arc(double a, double b, double turn, std::size_t n, double noise)
{
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, noise);
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = turn * (double(i) + 0.5) / double(n);
    const Vec2 p((a + normal(random)) * std::cos(t), (b + normal(random)) * std::sin(t));
    points.emplace_back(5 + std::cos(0.5) * p.x() - std::sin(0.5) * p.y(),
                        -3 + std::sin(0.5) * p.x() + std::cos(0.5) * p.y());
  }
  return points;
}

std::vector<Vec3> tube(double radius, double height, std::size_t n)
{
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.39996322972865332 * double(i);
    points.emplace_back(radius * std::cos(angle),
                        radius * std::sin(angle),
                        height * (double(i) + 0.5) / double(n));
  }
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Banded_cholesky)

BOOST_AUTO_TEST_CASE(it_solves_what_a_dense_solver_solves)
{
  constexpr std::size_t width = 3;
  const std::size_t n = 12;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-1, 1);
  pcs::linear_algebra::Banded_cholesky<width> banded;
  banded.reset(n);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i > width ? i - width : 0; j <= i; ++j) {
      const double x = i == j ? 8 : value(random);
      banded(i, j) = x;
      dense(Eigen::Index(i), Eigen::Index(j)) = dense(Eigen::Index(j), Eigen::Index(i)) = x;
    }
  std::vector<double> x(n);
  for (double& v : x)
    v = value(random);
  const Eigen::VectorXd expected =
      dense.ldlt().solve(Eigen::Map<Eigen::VectorXd>(x.data(), Eigen::Index(n)));
  BOOST_REQUIRE(banded.factorize());
  banded.solve(x);
  for (std::size_t i = 0; i < n; ++i)
    BOOST_CHECK_SMALL(x[i] - expected(Eigen::Index(i)), 1e-12);
  const Eigen::MatrixXd inverse = dense.inverse();
  const std::vector<double> diagonal = banded.inverse_diagonal();
  for (std::size_t i = 0; i < n; ++i)
    BOOST_CHECK_SMALL(diagonal[i] - inverse(Eigen::Index(i), Eigen::Index(i)), 1e-12);
}

BOOST_AUTO_TEST_CASE(it_refuses_what_is_not_definite)
{
  pcs::linear_algebra::Banded_cholesky<1> matrix;
  matrix.reset(2);
  matrix(0, 0) = 1;
  matrix(1, 0) = 2;
  matrix(1, 1) = 1;
  BOOST_CHECK(!matrix.factorize());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(circle_fit)

BOOST_AUTO_TEST_CASE(short_arcs_are_not_biased)
{
  for (const double turn : {2 * pi, pi, pi / 2}) {
    const auto circle = pcs::skeleton::fit_circle(arc(2, 2, turn, 400, 0.02));
    BOOST_CHECK_CLOSE(circle.radius, 2.0, 2.0);
    BOOST_CHECK_SMALL((circle.center - Vec2(5, -3)).norm(), 0.04);
  }
}

BOOST_AUTO_TEST_CASE(points_on_a_line_have_no_circle)
{
  std::vector<Vec2> points;
  for (int i = 0; i < 10; ++i)
    points.emplace_back(i, 2 * i);
  BOOST_CHECK_EQUAL(pcs::skeleton::fit_circle(points).radius, 0);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(ellipse_fit)

BOOST_AUTO_TEST_CASE(all_ways_find_an_exact_ellipse)
{
  using pcs::Section_fit;
  for (const Section_fit how : {Section_fit::conic, Section_fit::ellipse, Section_fit::by_arc}) {
    const auto e = pcs::skeleton::fit_section(arc(2, 1.5, 2 * pi, 40, 0), how);
    BOOST_CHECK_CLOSE(e.major, 2.0, 1e-6);
    BOOST_CHECK_CLOSE(e.minor, 1.5, 1e-6);
    BOOST_CHECK_SMALL((e.center - Vec2(5, -3)).norm(), 1e-8);
    BOOST_CHECK_SMALL(std::abs(e.direction.dot(Vec2(std::cos(0.5), std::sin(0.5)))) - 1, 1e-8);
    BOOST_CHECK_SMALL(e.deviation, 1e-7);
  }
}

BOOST_AUTO_TEST_CASE(on_a_half_turn_only_the_circle_keeps_the_radius)
{
  using pcs::Section_fit;
  const auto points = arc(1, 1, pi, 20, 0.03);
  BOOST_CHECK_CLOSE(pcs::skeleton::fit_section(points, Section_fit::circle).major, 1.0, 10.0);
  BOOST_CHECK_CLOSE(pcs::skeleton::fit_section(points, Section_fit::by_arc).major, 1.0, 10.0);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(principal_curvatures)

BOOST_AUTO_TEST_CASE(the_center_candidates_of_a_tube_lie_on_its_axis)
{
  pcs::skeleton::Scan scan;
  pcs::skeleton::prepare_scan<CGAL::Sequential_tag>(tube(0.1, 1, 6000), Vec3::UnitZ(), scan);
  const auto frames = pcs::skeleton::principal_curvatures<CGAL::Sequential_tag>(scan);
  std::size_t good = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Vec3 center = scan.frame.to_input(scan.points[i] + frames[i].normal / frames[i].k1);
    good += std::hypot(center.x(), center.y()) < 0.01 && std::abs(frames[i].e2.z()) > 0.98;
  }
  BOOST_CHECK_GT(good, scan.size() * 9 / 10);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(Axis)

BOOST_AUTO_TEST_CASE(resampling_keeps_ends_and_length)
{
  pcs::skeleton::Axis axis(3);
  axis[1].point = Vec3(1, 0, 0);
  axis[2].point = Vec3(1, 2, 0);
  for (auto& node : axis)
    node.radius = 0.1;
  const auto result = pcs::skeleton::resample(axis, {1, 0.01, 1});
  BOOST_CHECK_EQUAL(result.size(), 31u);
  BOOST_CHECK(result.front().point == axis.front().point);
  BOOST_CHECK(result.back().point == axis.back().point);
  BOOST_CHECK_CLOSE(pcs::skeleton::length_of(result), 3.0, 1.0);
}

BOOST_AUTO_TEST_CASE(a_place_beyond_an_end_says_so)
{
  pcs::skeleton::Axis axis(2);
  axis[1].point = Vec3(0, 0, 1);
  const auto before = pcs::skeleton::nearest_place(axis, 0, Vec3(0, 0, -1));
  BOOST_CHECK_LT(before.share, 0);
  BOOST_CHECK_CLOSE(before.distance, 1.0, 1e-9);
  BOOST_CHECK_CLOSE(pcs::skeleton::nearest_place(axis, 0, Vec3(3, 0, 0.25)).share, 0.25, 1e-9);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(Axis_fit)

BOOST_AUTO_TEST_CASE(a_wrong_start_finds_the_axis_of_half_a_tube)
{
  std::vector<Vec3> points;
  for (const Vec3& p : tube(0.1, 1, 4000))
    if (p.x() > 0)
      points.push_back(p);
  pcs::skeleton::Axis axis;
  for (int k = 0; k <= 10; ++k) {
    pcs::skeleton::Axis_node node;
    node.point = Vec3(0.04, 0.01, 0.1 * k);
    node.radius = 0.08;
    axis.push_back(node);
  }
  pcs::skeleton::Axis_fit fit(axis, pcs::skeleton::Fit_model::of(0.01, 0.002));
  fit.set_points(points, std::vector<pcs::skeleton::Index>(points.size(), 0));
  fit.project();
  for (int k = 0; k < 12; ++k)
    BOOST_REQUIRE(fit.iterate(k < 6 ? 4 : 1));
  for (const auto& node : fit.axis()) {
    BOOST_CHECK_CLOSE(node.radius, 0.1, 2.0);
    BOOST_CHECK_SMALL(std::hypot(node.point.x(), node.point.y()), 0.002);
  }
}

// Seven points of a twig that is much thinner than the noise. Without the curvature of the
// distances, the steps oscillate between the sides of the points.
BOOST_AUTO_TEST_CASE(fits_of_thin_twigs_settle)
{
  constexpr double noise = 0.003;
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0, noise);
  for (int repetition = 0; repetition < 50; ++repetition) {
    std::vector<Vec3> points;
    for (int i = 0; i < 7; ++i) {
      const double x = normal(random), y = normal(random);
      points.emplace_back(x, y, 0.02 + 0.01 * i);
    }
    pcs::skeleton::Axis axis(11);
    for (std::size_t k = 0; k < axis.size(); ++k) {
      axis[k].point = Vec3(0, 0, 0.01 * double(k));
      axis[k].radius = 0.001;
    }
    pcs::skeleton::Axis_fit fit(axis, pcs::skeleton::Fit_model::of(0.01, noise));
    fit.set_points(points, std::vector<pcs::skeleton::Index>(points.size(), 3));
    fit.set_priors(std::vector<pcs::skeleton::Radius_prior>(axis.size(), {1e-4, 1e-3}));
    fit.project();
    for (int k = 0; k < 15; ++k)
      BOOST_REQUIRE(fit.iterate(1));
    BOOST_CHECK_LT(fit.largest_change(), 0.3 * noise);
  }
}

// The front of a twig. An axis in the middle of its points remains there unless the fit has the
// side on which the points lie.
BOOST_AUTO_TEST_CASE(the_side_of_the_points_finds_the_axis_behind_them)
{
  namespace sk = pcs::skeleton;
  constexpr double radius = 0.004, noise = 0.003, facing = 0.25 * pi;
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, noise);
  std::vector<Vec3> points;
  for (const Vec3& p : tube(radius, 0.3, 240))
    if (p.x() > 0)
      points.emplace_back(p.x() + normal(random), p.y(), p.z());
  const auto depth = [&](bool does_know) {
    sk::Axis axis(16);
    for (std::size_t k = 0; k < axis.size(); ++k) {
      axis[k].point = Vec3(facing * radius, 0, 0.02 * double(k));
      axis[k].radius = 0.003;
    }
    sk::Axis_fit fit(axis, sk::Fit_model::of(0.01, noise));
    fit.set_points(points, std::vector<sk::Index>(points.size(), 8));
    fit.set_priors(std::vector<sk::Radius_prior>(axis.size(), {radius, 0.5 * radius}));
    fit.project();
    for (int k = 0; k < 15; ++k) {
      std::vector<sk::Center_prior> priors;
      for (const sk::Axis_node& node : fit.axis())
        priors.push_back({Vec3(facing * radius, 0, node.point.z()), Vec3(facing, 0, 0), 0.002});
      if (does_know)
        fit.set_priors(priors);
      BOOST_REQUIRE(fit.iterate(1));
    }
    return fit.axis()[8].point.x();
  };
  BOOST_CHECK_GT(depth(false), 0.45 * radius);
  BOOST_CHECK_SMALL(depth(true), 0.35 * radius);
}

BOOST_AUTO_TEST_CASE(a_radius_at_its_lowest_value_does_not_change)
{
  constexpr double spacing = 0.1, noise = 0.003;
  pcs::skeleton::Axis axis(6);
  for (std::size_t k = 0; k < axis.size(); ++k) {
    axis[k].point = Vec3(0, 0, spacing * double(k));
    axis[k].radius = 0.01;
  }
  pcs::skeleton::Axis_fit fit(axis, pcs::skeleton::Fit_model::of(spacing, noise));
  const std::vector<Vec3> points = tube(1e-4, 0.5, 200); // thinner than the minimum radius of axes
  fit.set_points(points, std::vector<pcs::skeleton::Index>(points.size(), 0));
  fit.project();
  for (int k = 0; k < 10; ++k)
    BOOST_REQUIRE(fit.iterate(1));
  BOOST_CHECK_CLOSE(fit.axis()[2].radius, 0.05 * spacing, 1e-9);
  BOOST_CHECK_LT(fit.largest_change(), 0.01 * noise);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(section_counts)

// A branch of radius 0.03 from the axis of a stem of radius 0.1. Points on the stem belong to the
// stem.
BOOST_AUTO_TEST_CASE(radii_are_counted_where_the_parent_hides_a_part)
{
  namespace sk = pcs::skeleton;
  constexpr double thick = 0.1, thin = 0.03, reach = 0.5;
  std::vector<Vec3> points = tube(thick, 1, 4000);
  const double density = double(points.size()) / (2 * pi * thick);
  std::vector<Vec3> branch;
  for (const Vec3& p : tube(thin, reach, std::size_t(2 * pi * thin * reach * density))) {
    const Vec3 q(p.z(), p.x(), 0.5 + p.y());
    if (std::hypot(q.x(), q.y()) > thick + 0.01)
      branch.push_back(q);
  }
  points.insert(points.end(), branch.begin(), branch.end());
  sk::Scan scan;
  sk::prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
  const double unit = scan.frame.unit;
  for (Vec3& p : branch)
    p = scan.frame.to_local(p);

  sk::Axis_set set;
  set.noise = 0.002 / unit;
  set.density = density * unit * unit;
  set.axis_of_point.assign(scan.size(), sk::none);
  set.segment_of_point.assign(scan.size(), 0);
  sk::Axis stem(2), axis;
  stem[0].point = scan.frame.to_local(Vec3::Zero());
  stem[1].point = scan.frame.to_local(Vec3(0, 0, 1));
  stem[0].radius = stem[1].radius = thick / unit;
  set.axes.push_back({stem, sk::none, 4000, 1});
  for (std::size_t i = 0; i < 4000; ++i)
    set.axis_of_point[scan.point_of_input[i]] = 0;
  for (int k = 0; k <= 25; ++k) {
    sk::Axis_node node;
    node.point = scan.frame.to_local(Vec3(0.02 * k, 0, 0.5));
    node.radius = thin / unit;
    axis.push_back(node);
  }
  const sk::Chain_options rules;
  const sk::Chain_view view{scan, set, rules};
  sk::Axis_fit fit(axis, sk::Fit_model::of(scan.spacing, set.noise));
  fit.set_points(branch, std::vector<sk::Index>(branch.size(), 0));
  fit.project();

  const std::vector<double> visible = sk::visible_shares(view, fit);
  BOOST_CHECK_EQUAL(visible[2], 0);
  BOOST_CHECK_EQUAL(visible[20], 1);
  const sk::Section_counts all = sk::section_counts(view, fit, std::vector<double>(axis.size(), 1));
  const sk::Section_counts outside = sk::section_counts(view, fit, visible);
  constexpr std::size_t base = 6; // 2 cm outside of the stem; the window reaches into it
  BOOST_CHECK_LT(unit * all.radius(base, set.density), 0.8 * thin);
  BOOST_CHECK_CLOSE(unit * outside.radius(base, set.density), thin, 15.0);
  BOOST_CHECK_CLOSE(unit * outside.radius(20, set.density), thin, 10.0);
  BOOST_CHECK_EQUAL(outside.length[base], all.visible_length[base]);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(section_skeleton)

BOOST_AUTO_TEST_CASE(the_way_of_the_dissertation_runs_from_end_to_end)
{
  using Kernel = CGAL::Simple_cartesian<double>;
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : tube(0.1, 2, 8000))
    points.emplace_back(p.x(), p.y(), p.z());
  for (int i = 0; i < 40; ++i) // a twig that is too thin for slices
    points.emplace_back(0.11 + 0.015 * i, 0, 1 + 0.015 * i);
  pcs::Tree_skeleton<Kernel> tree;
  pcs::Tree_skeletonization stages(
      points,
      pcs::parameters::skeleton_method(pcs::Skeleton_method::sections));
  const auto report = stages.extract(tree);
  BOOST_CHECK_EQUAL(report.status, pcs::Status::converged);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.2, 5.0);
  BOOST_CHECK_EQUAL(num_edges(tree) + 1, num_vertices(tree));
  double farthest = 0, thinnest = 1;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    farthest = std::max(farthest, tree[v].point.x());
    thinnest = std::min(thinnest, tree[v].radius);
  }
  BOOST_CHECK_GT(farthest, 0.5); // the sparse part is included
  BOOST_CHECK_LT(thinnest, 0.05);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_sections

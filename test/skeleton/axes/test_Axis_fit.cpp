// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fit of an axis: wrong initial axes, thin twigs, one-sided points, bounds of radii.

#include <pcs/skeleton/axes/Axis_fit.h>
#include <support/sections.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

namespace test_Axis_fit {

using pcs::skeleton::Vec3;
using pcs_test::tube;
constexpr double pi = 3.14159265358979323846;

namespace {

namespace sk = pcs::skeleton;

/// The system of a Gauss-Newton step by dense algebra: unknowns are four numbers per node.
struct Dense_system
{
  Eigen::MatrixXd matrix;
  Eigen::VectorXd slope;

  explicit Dense_system(std::size_t number_of_nodes)
    : matrix(Eigen::MatrixXd::Zero(size_of(number_of_nodes), size_of(number_of_nodes))),
      slope(Eigen::VectorXd::Zero(size_of(number_of_nodes)))
  {
  }
  static Eigen::Index size_of(std::size_t number_of_nodes)
  {
    return static_cast<Eigen::Index>(4 * number_of_nodes);
  }

  /// Derivatives of `rows` residuals, all 0.
  Eigen::MatrixXd derivatives(Eigen::Index rows) const
  {
    return Eigen::MatrixXd::Zero(rows, slope.size());
  }
  /// Adds half of the weighted square of a residual.
  void add(double weight, const Eigen::MatrixXd& derivatives, const Eigen::VectorXd& residual)
  {
    matrix += weight * derivatives.transpose() * derivatives;
    slope -= weight * derivatives.transpose() * residual;
  }
};

/// Input of a fit.
struct Fit_case
{
  sk::Axis axis;
  sk::Fit_model model;
  std::vector<Vec3> points;
  std::vector<sk::Radius_prior> radii;
  std::vector<sk::Center_prior> centers;
  std::size_t stride = 1;
  double widening = 1;

  sk::Axis_fit fit() const
  {
    sk::Axis_fit result(axis, model);
    result.set_points(points, std::vector<sk::Index>(points.size(), 0));
    result.use_every(stride);
    result.set_priors(radii);
    result.set_priors(centers);
    result.project();
    return result;
  }

  /// Calls `f` with the point, place, residual and weight of each point that counts.
  template <class F>
  void for_each_point(const F& f) const
  {
    for (std::size_t i = 0; i < points.size(); i += stride) {
      const sk::Axis_place place = sk::nearest_place(axis, points[i]);
      if (place.share < 0 || place.share > 1)
        continue;
      const double radius = sk::radius_at(axis, place), e = place.distance - radius;
      const double deviation = std::max(model.noise, model.bark * radius);
      const double x = e / (4.7 * widening * deviation);
      if (std::abs(x) < 1)
        f(points[i], place, e, double(stride) * std::pow((1 - x * x) / deviation, 2));
    }
  }

  /// Weights of the points, divided between the nodes of their segments.
  std::vector<double> weights_of_nodes() const
  {
    std::vector<double> result(axis.size(), 0);
    for_each_point([&](const Vec3&, const sk::Axis_place& place, double, double weight) {
      result[place.segment] += (1 - place.share) * weight;
      result[place.segment + 1] += place.share * weight;
    });
    return result;
  }

  void add_points(Dense_system& system) const
  {
    for_each_point([&](const Vec3& p, const sk::Axis_place& place, double e, double weight) {
      const Vec3 n = (p - sk::point_at(axis, place)).normalized();
      Eigen::MatrixXd d = system.derivatives(1), center = system.derivatives(3);
      for (Eigen::Index k = 0; k < 2; ++k) {
        const double share = k == 0 ? 1 - place.share : place.share;
        const Eigen::Index at = 4 * (static_cast<Eigen::Index>(place.segment) + k);
        center.block(0, at, 3, 3) = share * Eigen::Matrix3d::Identity();
        d.block(0, at, 1, 3) = -share * n.transpose();
        d(0, at + 3) = -share;
      }
      system.add(weight, d, Eigen::VectorXd::Constant(1, e));
      if (e > 0) // second derivative of the distance times e
        system.matrix += weight * e / place.distance * center.transpose() *
                         (Eigen::Matrix3d::Identity() - n * n.transpose()) * center;
    });
  }

  void add_smoothness(Dense_system& system) const
  {
    for (std::size_t k = 1; k + 1 < axis.size(); ++k) {
      const double a = (axis[k].point - axis[k - 1].point).norm();
      const double b = (axis[k + 1].point - axis[k].point).norm(), h = 0.5 * (a + b);
      for (Eigen::Index i = 0; i < 4; ++i) {
        const auto value = [&](std::size_t m) { return i < 3 ? axis[m].point[i] : axis[m].radius; };
        const double r = axis[k].radius;
        const double deviation =
            i < 3 ? std::min(model.axis_bend, model.thick_bend / r)
                  : (model.taper_offset + r) / (model.taper_scale * model.taper_scale);
        Eigen::MatrixXd d = system.derivatives(1);
        const auto at = 4 * static_cast<Eigen::Index>(k) + i;
        d(0, at - 4) = 1 / (a * h);
        d(0, at) = -(1 / a + 1 / b) / h;
        d(0, at + 4) = 1 / (b * h);
        const double bend = ((value(k + 1) - value(k)) / b - (value(k) - value(k - 1)) / a) / h;
        system.add(h / model.correlation / (deviation * deviation),
                   d,
                   Eigen::VectorXd::Constant(1, bend));
      }
    }
  }

  void add_priors(Dense_system& system) const
  {
    for (std::size_t k = 0; k < radii.size(); ++k)
      if (radii[k].deviation > 0) {
        Eigen::MatrixXd d = system.derivatives(1);
        d(0, 4 * static_cast<Eigen::Index>(k) + 3) = 1;
        system.add(std::pow(radii[k].deviation, -2),
                   d,
                   Eigen::VectorXd::Constant(1, axis[k].radius - radii[k].radius));
      }
    for (std::size_t k = 0; k < centers.size(); ++k)
      if (centers[k].deviation > 0) {
        Eigen::MatrixXd d = system.derivatives(3);
        d.block(0, 4 * static_cast<Eigen::Index>(k), 3, 3) = -Eigen::Matrix3d::Identity();
        d.col(4 * static_cast<Eigen::Index>(k) + 3) = -centers[k].facing;
        const Vec3 e = centers[k].middle - axis[k].point - axis[k].radius * centers[k].facing;
        system.add(std::pow(centers[k].deviation, -2), d, e);
      }
  }

  void add_damping(Dense_system& system) const
  {
    const double unit = 1 / (model.noise * model.noise);
    system.matrix.diagonal().array() += 0.005 * unit;
    for (std::size_t k = 0; k < axis.size(); ++k) {
      const Vec3 t = (axis[std::min(axis.size() - 1, k + 1)].point -
                      axis[std::max<std::size_t>(k, 1) - 1].point)
                         .normalized();
      const Eigen::Index at = 4 * static_cast<Eigen::Index>(k);
      system.matrix.block(at, at, 3, 3) += 100 * unit * t * t.transpose();
    }
  }

  Dense_system system() const
  {
    Dense_system system(axis.size());
    add_points(system);
    add_smoothness(system);
    add_priors(system);
    add_damping(system);
    return system;
  }

  /// The axis after a step: steps are bounded, and the end segments keep their lengths.
  sk::Axis next() const
  {
    const Dense_system s = system();
    const Eigen::VectorXd step = s.matrix.ldlt().solve(s.slope);
    sk::Axis result = axis;
    for (std::size_t k = 0; k < axis.size(); ++k) {
      const Eigen::Index at = 4 * static_cast<Eigen::Index>(k);
      const double most = axis[k].radius / 2 + model.noise;
      const Vec3 move = step.segment<3>(at);
      result[k].point += std::min(1.0, most / move.norm()) * move;
      result[k].radius =
          std::max(model.lowest_radius, axis[k].radius + std::clamp(step[at + 3], -most, most));
    }
    const std::size_t last = axis.size() - 1;
    if (last > 1)
      for (const auto& [end, inner] :
           {std::pair(std::size_t(0), std::size_t(1)), std::pair(last, last - 1)}) {
        const double length = (axis[end].point - axis[inner].point).norm();
        result[end].point =
            result[inner].point + length * (result[end].point - result[inner].point).normalized();
      }
    return result;
  }
};

/// Points on a bent, tapering tube with noise and outliers, and an axis beside its middle with
/// unequal steps, which ends before the points do.
Fit_case bent_tube(std::size_t number_of_nodes, double offset)
{
  Fit_case result;
  result.model = sk::Fit_model::of(0.01, 0.002);
  const auto middle = [](double z) { return Vec3(0.3 * z * z, -0.1 * z * z, z); };
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 0.002);
  for (const Vec3& p : tube(1, 1.2, 600)) {
    const double z = p.z() - 0.1, radius = 0.06 - 0.02 * z + normal(random);
    result.points.push_back(middle(z) + Vec3(radius * p.x(), radius * p.y(), 0));
  }
  for (std::size_t i = 0; i < result.points.size(); i += 17)
    result.points[i].x() += 0.05;
  result.axis.resize(number_of_nodes);
  for (std::size_t k = 0; k < number_of_nodes; ++k) {
    const double s = double(k) / double(number_of_nodes - 1), z = s * (0.4 + 0.6 * s);
    result.axis[k].point = middle(z) + Vec3(offset, -0.5 * offset * s, 0);
    result.axis[k].radius = 0.055 - 0.01 * s;
  }
  result.radii.resize(number_of_nodes);
  result.radii.front() = {0.07, 0.004, 1e4};
  result.radii.back() = {0.03, 0.002, 0};
  result.centers.resize(number_of_nodes);
  const Vec3 facing(0.6, 0.3, 0.1);
  result.centers[0] = {result.axis[0].point + 0.05 * facing, facing, 0.003};
  result.centers[1] = {result.axis[1].point + 0.06 * facing - Vec3(2 * offset, 0, 0), facing, 4e-4};
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Axis_fit)

BOOST_AUTO_TEST_CASE(a_step_solves_the_system_of_the_stated_sum)
{
  std::size_t number_of_bounded_steps = 0;
  for (const std::size_t number_of_nodes : {2u, 3u, 4u, 9u})
    for (const double offset : {0.001, 0.01, 0.04})
      for (const double widening : {1.0, 2.5})
        for (const std::size_t stride : {1u, 3u}) {
          Fit_case c = bent_tube(number_of_nodes, offset);
          c.widening = widening;
          c.stride = stride;
          sk::Axis_fit fit = c.fit();
          BOOST_TEST_REQUIRE(fit.iterate(widening));
          const sk::Axis expected = c.next();
          double change = 0, error = 0;
          for (std::size_t k = 0; k < number_of_nodes; ++k) {
            const sk::Axis_node &node = fit.axis()[k], &other = expected[k];
            change = std::max(change, (node.point - c.axis[k].point).norm());
            error = std::max(
                {error, (node.point - other.point).norm(), std::abs(node.radius - other.radius)});
          }
          BOOST_TEST(change > 0.1 * c.model.noise);
          number_of_bounded_steps += change > 0.5 * c.axis[1].radius ? 1 : 0;
          BOOST_TEST(error < 1e-9 * change,
                     error << " of " << change << " with " << number_of_nodes << " nodes, "
                           << offset << ", " << widening << ", " << stride);
        }
  BOOST_TEST(number_of_bounded_steps > 0u);
}

BOOST_AUTO_TEST_CASE(errors_of_radii_are_those_of_the_inverse_of_the_system)
{
  const Fit_case c = bent_tube(9, 0.001);
  sk::Axis_fit fit = c.fit();
  BOOST_TEST_REQUIRE(fit.iterate(1));
  fit.estimate_errors();
  const Eigen::MatrixXd matrix = c.system().matrix;
  const Eigen::MatrixXd inverse =
      matrix.ldlt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  for (std::size_t k = 0; k < c.axis.size(); ++k) {
    const Eigen::Index at = 4 * static_cast<Eigen::Index>(k) + 3;
    BOOST_TEST(fit.axis()[k].radius_error == std::sqrt(inverse(at, at)),
               boost::test_tools::tolerance(1e-9));
  }
}

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

BOOST_AUTO_TEST_CASE(radii_are_measured_where_the_points_outweigh_the_prior)
{
  Fit_case c = bent_tube(9, 0.001);
  c.points.erase(std::remove_if(c.points.begin(),
                                c.points.end(),
                                [&](const Vec3& p) {
                                  return p.z() > c.axis[5].point.z() - 0.05 &&
                                         p.z() < c.axis[7].point.z() + 0.05;
                                }),
                 c.points.end());
  const std::vector<double> weight = c.weights_of_nodes();
  BOOST_TEST(weight[6] == 0);
  const auto prior = [&](std::size_t k, double precision, double measured) {
    c.radii[k] = {0.05, 1 / std::sqrt(precision * weight[k]), measured * precision * weight[k]};
  };
  c.radii.assign(5, {});
  prior(0, 0.8, 0);
  prior(1, 1.25, 0);
  prior(2, 1.25, 0.2); // 1 + 0.25 by points, 1 by others
  prior(3, 1.25, 0.05);
  sk::Axis_fit fit = c.fit();
  BOOST_TEST_REQUIRE(fit.iterate(1));
  fit.estimate_errors();
  const std::vector<bool> expected = {true, false, true, false, true, true, false, true, true};
  for (std::size_t k = 0; k < expected.size(); ++k)
    BOOST_TEST(fit.axis()[k].is_measured == expected[k], "node " << k);
}

BOOST_AUTO_TEST_CASE(points_in_use_again_have_places_on_the_current_axis)
{
  const Fit_case c = bent_tube(9, 0.01);
  sk::Axis_fit fit = c.fit();
  const auto number_of_wrong_places = [&] {
    std::size_t count = 0;
    for (std::size_t i = 0; i < c.points.size(); ++i)
      if (std::abs(fit.places()[i].distance - nearest_place(fit.axis(), c.points[i]).distance) >
          1e-12)
        ++count;
    return count;
  };
  for (const std::size_t stride : {2u, 3u}) {
    fit.use_every(stride);
    BOOST_TEST_REQUIRE(fit.iterate(1));
    BOOST_TEST(number_of_wrong_places() > c.points.size() / 3);
    fit.use_every(1);
    BOOST_TEST(number_of_wrong_places() == 0u);
  }
  fit.use_every(3);
  fit.set_points(c.points, std::vector<sk::Index>(c.points.size(), 0));
  BOOST_TEST(fit.stride() == 1u);
}

BOOST_AUTO_TEST_CASE(a_scaled_scan_has_the_scaled_axis)
{
  constexpr double scale = 1024; // a power of two: no rounding
  const Fit_case c = bent_tube(9, 0.01);
  Fit_case large = c;
  large.model = sk::Fit_model::of(0.01 * scale, 0.002 * scale);
  for (Vec3& p : large.points)
    p *= scale;
  for (sk::Axis_node& node : large.axis) {
    node.point *= scale;
    node.radius *= scale;
  }
  for (auto& prior : large.radii)
    prior = {prior.radius * scale, prior.deviation * scale, prior.measured / (scale * scale)};
  for (auto& prior : large.centers)
    prior = {prior.middle * scale, prior.facing, prior.deviation * scale};
  sk::Axis_fit fit = c.fit(), large_fit = large.fit();
  for (int step = 0; step < 5; ++step)
    BOOST_TEST_REQUIRE((fit.iterate(1) && large_fit.iterate(1)));
  for (std::size_t k = 0; k < c.axis.size(); ++k) {
    const Vec3 difference = large_fit.axis()[k].point - scale * fit.axis()[k].point;
    BOOST_TEST(difference.norm() < 1e-9 * scale);
    BOOST_TEST(std::abs(large_fit.axis()[k].radius - scale * fit.axis()[k].radius) < 1e-9 * scale);
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

} // namespace test_Axis_fit

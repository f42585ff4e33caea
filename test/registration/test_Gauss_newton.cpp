// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Laws of the Gauss-Newton steps of a registration.

#include <pcs/registration/Gauss_newton.h>
#include <pcs/registration/Stretch_field.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace test_Gauss_newton {

namespace {

namespace reg = pcs::registration;
using reg::Vec3;
using Tag = CGAL::Sequential_tag;

/// A square grid of nodes that carry one point each.
struct Grid
{
  static constexpr std::uint32_t width = 6;
  pcs::deformation::Elastic_network network;
  reg::Deformable_shape shape;
  reg::Gauss_newton solver;
  std::vector<reg::Attraction> attractions;

  Grid()
  {
    auto& surface = network.surface;
    surface.first = {0};
    for (std::uint32_t i = 0; i < width * width; ++i) {
      const std::uint32_t x = i % width, y = i / width;
      network.rest.emplace_back(x, y, 0);
      for (std::uint32_t j = 0; j < width * width; ++j) {
        const std::uint32_t u = j % width, v = j / width;
        if (i != j && u + 1 >= x && u <= x + 1 && v + 1 >= y && v <= y + 1)
          surface.neighbor.push_back(j);
      }
      surface.first.push_back(static_cast<std::uint32_t>(surface.neighbor.size()));
    }
    surface.weight.assign(surface.neighbor.size(), 1);
    shape.start(network);
    std::vector<reg::Carried_point> points;
    for (std::uint32_t i = 0; i < network.size(); ++i) {
      reg::Carried_point p{network.rest[i], {}};
      p.carriers.count = 1;
      p.carriers.node[0] = i;
      p.carriers.weight[0] = 1;
      points.push_back(p);
    }
    const std::vector<std::uint32_t> component(network.size(), 0);
    solver.start(shape, reg::collect_edges(network, component), points);
    attractions.assign(network.size(), reg::Attraction());
  }

  void attract(std::uint32_t i, const Vec3& target, double weight = 1)
  {
    attractions[i].a = weight * Eigen::Matrix3d::Identity();
    attractions[i].pull = weight * (target - shape.state.position[i]);
  }

  void attract_along(std::uint32_t i, const Vec3& target, const Vec3& n)
  {
    attractions[i].a = n * n.transpose();
    attractions[i].pull = attractions[i].a * (target - shape.state.position[i]);
  }

  double step() { return solver.step<Tag>(attractions, {1, 1, 1e-3}, shape); }
};

} // namespace

BOOST_AUTO_TEST_SUITE(Gauss_newton)

BOOST_AUTO_TEST_CASE(a_shape_at_its_targets_does_not_move)
{
  Grid grid;
  for (std::uint32_t i = 0; i < grid.network.size(); ++i)
    grid.attract(i, grid.network.rest[i]);
  BOOST_TEST(grid.step() < 1e-14);
}

BOOST_AUTO_TEST_CASE(four_corners_turn_the_whole_shape_rigidly)
{
  Grid grid;
  const Eigen::Matrix3d r = pcs::rotation_exp(Vec3(0.3, -0.8, 1.2)).toRotationMatrix();
  const Vec3 t(3, -2, 5);
  const std::uint32_t w = Grid::width;
  for (int k = 0; k < 40; ++k) {
    for (const std::uint32_t i : {0u, w - 1, w * (w - 1), w * w - 1})
      grid.attract(i, r * grid.network.rest[i] + t);
    grid.step();
  }
  for (std::uint32_t i = 0; i < grid.network.size(); ++i) {
    BOOST_TEST((grid.shape.state.position[i] - (r * grid.network.rest[i] + t)).norm() < 1e-6);
    BOOST_TEST((grid.shape.state.rotation[i] - r).norm() < 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(an_attraction_along_a_normal_permits_sliding)
{
  Grid grid;
  for (int k = 0; k < 20; ++k) {
    for (std::uint32_t i = 0; i < grid.network.size(); ++i)
      grid.attract_along(i, Vec3(100, 50, 2), Vec3(0, 0, 1));
    grid.step();
  }
  for (std::uint32_t i = 0; i < grid.network.size(); ++i)
    BOOST_TEST((grid.shape.state.position[i] - (grid.network.rest[i] + Vec3(0, 0, 2))).norm() <
               1e-4);
}

BOOST_AUTO_TEST_CASE(a_spring_keeps_its_length)
{
  // Two nodes without an edge: only the spring resists the attractions.
  pcs::deformation::Elastic_network network;
  network.rest = {Vec3(0, 0, 0), Vec3(0, 0, 2)};
  network.surface.first = {0, 0, 0};
  reg::Deformable_shape shape;
  shape.start(network);
  shape.spacing = 1;
  std::vector<reg::Carried_point> points(2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    points[i].rest = network.rest[i];
    points[i].carriers.count = 1;
    points[i].carriers.node[0] = i;
    points[i].carriers.weight[0] = 1;
  }
  reg::Elastic_edges edges;
  edges.springs.push_back({0, 1, 1000});
  reg::Gauss_newton solver;
  solver.start(shape, edges, points);
  for (int k = 0; k < 20; ++k) {
    std::vector<reg::Attraction> attractions(2);
    for (std::size_t i = 0; i < 2; ++i) {
      attractions[i].a = Eigen::Matrix3d::Identity();
      attractions[i].pull = Vec3(0, 0, i == 0 ? 0 : 1) - shape.state.position[i];
    }
    solver.step<Tag>(attractions, {1, 1, 1e-3}, shape);
  }
  // equilibrium: the length is 2 - 1/2001 of the way to 1 (springs in series)
  const double length = (shape.state.position[1] - shape.state.position[0]).norm();
  BOOST_TEST(length == 2 - 1.0 / 2001, boost::test_tools::tolerance(1e-4));
}

BOOST_AUTO_TEST_CASE(a_uniform_stretch_is_measured_and_then_costs_nothing)
{
  Grid grid;
  const Eigen::Matrix3d r = pcs::rotation_exp(Vec3(0.1, 0.4, -0.2)).toRotationMatrix();
  const Eigen::Matrix3d stretch = Eigen::DiagonalMatrix<double, 3>(1.3, 0.9, 1);
  for (std::uint32_t i = 0; i < grid.network.size(); ++i) {
    grid.shape.state.position[i] = r * stretch * grid.network.rest[i];
    grid.shape.state.rotation[i] = r;
  }
  reg::Stretch_field field;
  BOOST_TEST(field.start(grid.shape, grid.solver.edges().surface, 3, 0));
  for (int k = 0; k < 200; ++k) // the present rotation has a small share in each measurement
    field.update<Tag>(grid.shape);
  for (std::uint32_t i = 0; i < grid.network.size(); ++i) {
    BOOST_TEST((grid.shape.state.stretch[i] - stretch).norm() < 0.06);
    grid.attract(i, grid.shape.state.position[i]);
  }
  const auto before = grid.shape.state.position;
  for (auto& s : grid.shape.state.stretch)
    s = stretch;
  BOOST_TEST(grid.step() < 1e-12);
}

BOOST_AUTO_TEST_CASE(a_component_without_attraction_follows_its_neighbour)
{
  // a second grid beside the first one, connected by bridges only
  pcs::deformation::Elastic_network network;
  std::vector<std::uint32_t> component;
  network.surface.first = {0};
  for (std::uint32_t c = 0; c < 2; ++c)
    for (std::uint32_t i = 0; i < 4; ++i) {
      network.rest.emplace_back(i % 2 + 3 * c, i / 2, 0);
      component.push_back(c);
      for (std::uint32_t j = 0; j < 4; ++j)
        if (j != i)
          network.surface.neighbor.push_back(4 * c + j);
      network.surface.first.push_back(static_cast<std::uint32_t>(network.surface.neighbor.size()));
    }
  network.surface.weight.assign(network.surface.neighbor.size(), 1);
  const reg::Elastic_edges edges = reg::collect_edges(network, component);
  BOOST_TEST(edges.surface.size() > 12);
  reg::Deformable_shape shape;
  shape.start(network);
  std::vector<reg::Carried_point> points(4);
  for (std::uint32_t i = 0; i < 4; ++i) {
    points[i].rest = network.rest[i];
    points[i].carriers.count = 1;
    points[i].carriers.node[0] = i;
    points[i].carriers.weight[0] = 1;
  }
  reg::Gauss_newton solver;
  solver.start(shape, edges, points);
  for (int k = 0; k < 30; ++k) {
    std::vector<reg::Attraction> attractions(4);
    for (std::size_t i = 0; i < 4; ++i) {
      attractions[i].a = Eigen::Matrix3d::Identity();
      attractions[i].pull = network.rest[i] + Vec3(1, 2, 3) - shape.state.position[i];
    }
    solver.step<Tag>(attractions, {1, 1, 1e-3}, shape);
  }
  for (std::size_t i = 0; i < 8; ++i)
    BOOST_TEST((shape.state.position[i] - network.rest[i] - Vec3(1, 2, 3)).norm() < 1e-2);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Gauss_newton

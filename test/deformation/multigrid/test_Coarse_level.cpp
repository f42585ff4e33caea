// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A coarse level samples the finer one, takes over its handles, and interpolates values to it.

#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/multigrid/Coarse_level.h>
#include <support/networks.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace test_Coarse_level {

using namespace pcs::deformation;
using Level = Coarse_level<CGAL::Sequential_tag>;

namespace {

constexpr std::size_t size = 3000;

/// A network on a sphere of radius 1, and its coarse level.
struct Sphere
{
  Elastic_network finer = pcs_test::network_of(pcs_test::sphere(size));
  Level level{finer, std::vector<std::uint32_t>(size, 0), false};

  std::size_t finer_node_at(const Vec3& p) const
  {
    const auto it = std::find(finer.rest.begin(), finer.rest.end(), p);
    return static_cast<std::size_t>(it - finer.rest.begin());
  }
  Node_constraints free_nodes(const std::vector<double>& softness) const
  {
    Node_constraints result;
    result.handle_of_node.assign(size, free_node);
    result.softness_weight = softness;
    return result;
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(coarse_level)

BOOST_AUTO_TEST_CASE(a_fifth_of_the_nodes_is_left_all_over_the_surface)
{
  const Sphere sphere;
  const std::vector<Vec3>& nodes = sphere.level.network().rest;
  BOOST_TEST(nodes.size() > 0.8 * size / coarsening_ratio);
  BOOST_TEST(nodes.size() < 1.2 * size / coarsening_ratio);
  double area = 0;
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    BOOST_TEST_REQUIRE(sphere.finer_node_at(nodes[s]) < size);
    area += sphere.level.network().area[s];
  }
  BOOST_TEST(std::abs(area - 1) < 1e-9);
  for (const Vec3& p : sphere.finer.rest) {
    double nearest = 4;
    for (const Vec3& q : nodes)
      nearest = std::min(nearest, (p - q).squaredNorm());
    // the mean spacing of the nodes is sqrt(4 pi / 600) = 0.14
    BOOST_TEST(nearest < 0.25 * 0.25);
  }
}

BOOST_AUTO_TEST_CASE(interpolation_reproduces_constants_and_follows_smooth_values)
{
  Sphere sphere;
  const std::vector<Vec3>& nodes = sphere.level.network().rest;
  Deviation_guess guess;
  const Vec3 constant(0.3, -2, 1);
  guess.deviations.assign(nodes.size(), constant);
  guess.link_offsets = nodes; // the identity as a function of the position
  sphere.level.carry(guess);
  BOOST_TEST_REQUIRE(guess.deviations.size() == size);
  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < size; ++i) {
    BOOST_TEST((guess.deviations[i] - constant).norm() < 1e-5);
    const double error = (guess.link_offsets[i] - sphere.finer.rest[i]).norm();
    largest = std::max(largest, error);
    sum += error / double(size);
  }
  BOOST_TEST(sum < 0.07); // half of the spacing
  BOOST_TEST(largest < 0.2);
}

BOOST_AUTO_TEST_CASE(nodes_have_the_handle_of_their_point)
{
  Sphere sphere;
  Node_constraints constraints = sphere.free_nodes({0, 0, 0.5});
  for (std::size_t i = 0; i < size; ++i) {
    const double z = sphere.finer.rest[i].z();
    constraints.handle_of_node[i] = z > 0.8 ? 0 : z < -0.8 ? 1 : free_node;
  }
  sphere.level.constrain(constraints);
  const Node_constraints& found = sphere.level.constraints();
  BOOST_TEST(found.softness_weight == constraints.softness_weight);
  BOOST_TEST_REQUIRE(found.handle_of_node.size() == sphere.level.network().size());
  for (std::size_t s = 0; s < found.handle_of_node.size(); ++s) {
    const double z = sphere.level.network().rest[s].z();
    BOOST_TEST(found.handle_of_node[s] == (z > 0.8 ? 0 : z < -0.8 ? 1 : free_node));
  }
  BOOST_TEST(std::count(found.handle_of_node.begin(), found.handle_of_node.end(), 1) > 20);
}

BOOST_AUTO_TEST_CASE(a_soft_handle_of_one_point_has_the_node_of_its_region)
{
  Sphere sphere;
  const std::vector<Vec3> nodes = sphere.level.network().rest;
  std::size_t point = 0;
  while (std::find(nodes.begin(), nodes.end(), sphere.finer.rest[point]) != nodes.end())
    ++point; // no node of the level
  Node_constraints constraints = sphere.free_nodes({0, 0.5});
  for (std::size_t i = 0; i < size; ++i)
    if (sphere.finer.rest[i].dot(sphere.finer.rest[point]) < -0.8)
      constraints.handle_of_node[i] = 0;
  constraints.handle_of_node[point] = 1;
  sphere.level.constrain(constraints);
  const auto& found = sphere.level.constraints().handle_of_node;
  BOOST_TEST_REQUIRE(std::count(found.begin(), found.end(), 1) == 1);
  const auto s = static_cast<std::size_t>(std::find(found.begin(), found.end(), 1) - found.begin());
  BOOST_TEST((nodes[s] - sphere.finer.rest[point]).norm() < 0.25);
}

BOOST_AUTO_TEST_CASE(nodes_have_the_offset_of_their_point)
{
  Sphere sphere;
  Node_constraints constraints = sphere.free_nodes({0, 0});
  Node_targets targets;
  targets.assign(size);
  const Eigen::Matrix3d turn = pcs::rotation_exp(Vec3(0.1, 0.2, 0.3)).toRotationMatrix();
  for (std::size_t i = 0; i < size; ++i) {
    const Vec3& p = sphere.finer.rest[i];
    constraints.handle_of_node[i] = p.z() > 0.8 ? 0 : p.z() < -0.8 ? 1 : free_node;
    if (p.z() > 0.8)
      targets.set(i, {0.5 * p, turn});
  }
  sphere.level.constrain(constraints);
  sphere.level.set_targets(constraints, targets);
  const Node_targets& found = sphere.level.targets();
  BOOST_TEST_REQUIRE(found.size() == sphere.level.network().size());
  for (std::size_t s = 0; s < found.size(); ++s) {
    const Vec3& p = sphere.level.network().rest[s];
    BOOST_TEST(found[s].offset == (p.z() > 0.8 ? Vec3(0.5 * p) : Vec3(0, 0, 0)));
    BOOST_TEST(found.is_offset(s) == (p.z() > 0.8));
  }
  sphere.level.set_targets(constraints, Node_targets());
  BOOST_TEST(sphere.level.targets().empty());
}

BOOST_AUTO_TEST_CASE(a_node_without_a_point_of_its_handle_has_the_mean_offset_of_its_region)
{
  Sphere sphere;
  Node_constraints constraints = sphere.free_nodes({0.5});
  Node_targets targets;
  targets.assign(size);
  for (std::size_t i = 0; i < size; ++i) // a point that is no node
    if (std::count(sphere.level.network().rest.begin(),
                   sphere.level.network().rest.end(),
                   sphere.finer.rest[i]) == 0) {
      constraints.handle_of_node[i] = 0;
      targets.set(i, {Vec3(1, 2, 3), Eigen::Matrix3d::Identity()});
      break;
    }
  sphere.level.constrain(constraints);
  sphere.level.set_targets(constraints, targets);
  std::size_t count = 0;
  for (std::size_t s = 0; s < sphere.level.network().size(); ++s)
    if (sphere.level.targets().is_offset(s)) {
      BOOST_TEST((sphere.level.targets()[s].offset - Vec3(1, 2, 3)).norm() < 1e-12);
      BOOST_TEST(sphere.level.constraints().handle_of_node[s] == 0);
      ++count;
    }
  BOOST_TEST(count == 1u);
}

BOOST_AUTO_TEST_CASE(a_new_rest_shape_moves_the_nodes)
{
  Sphere sphere;
  const std::vector<Vec3> before = sphere.level.network().rest;
  Elastic_network moved = sphere.finer;
  for (Vec3& p : moved.rest)
    p = 2 * p + Vec3(1, 0, 0);
  sphere.level.accept(moved);
  for (std::size_t s = 0; s < before.size(); ++s)
    BOOST_TEST((sphere.level.network().rest[s] - 2 * before[s] - Vec3(1, 0, 0)).norm() < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Coarse_level

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the rotation field: the published system [Aiteanu 2022], uniform steps along a path, turns
// beyond 180 degrees.

#include <pcs/deformation/solver/rotation_field.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/QR>

namespace test_rotation_field {

namespace {

using pcs::Quaternion;
using pcs::Rotation_field;
using pcs::Similarity;
using pcs::deformation::free_node;
using pcs::deformation::Node_constraints;
using pcs::deformation::Weighted_graph;
using pcs_test::Vec3;

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;

std::vector<Quaternion> field(Rotation_field kind,
                              const Weighted_graph& graph,
                              const Node_constraints& constraints,
                              const std::vector<Similarity>& transforms)
{
  const pcs_test::Harmonic system(graph, constraints);
  BOOST_REQUIRE(system.is_ok);
  std::vector<Quaternion> result;
  std::vector<Vec3> work;
  pcs::deformation::Rotation_field_solver<CGAL::Sequential_tag>()(kind,
                                                                  system.factor,
                                                                  graph,
                                                                  constraints,
                                                                  system.rows,
                                                                  transforms,
                                                                  result,
                                                                  work);
  for (const auto& q : result)
    BOOST_REQUIRE(std::abs(q.norm() - 1) < 1e-12);
  return result;
}

double angle_between(const Quaternion& a, const Quaternion& b)
{
  return pcs::rotation_log(a * b.conjugate()).norm();
}

Similarity turn(const Vec3& u)
{
  return Similarity::from_turn(u);
}

Node_constraints path_constraints(std::size_t n)
{
  Node_constraints c;
  c.softness_weight = {0, 0};
  c.handle_of_node.assign(n, free_node);
  c.handle_of_node.front() = 0;
  c.handle_of_node.back() = 1;
  return c;
}

/// Matrix of `q -> q * r`, on (x, y, z, w).
Eigen::Matrix4d right_product(const Quaternion& r)
{
  Eigen::Matrix4d m;
  for (int c = 0; c < 4; ++c) {
    Quaternion unit;
    unit.coeffs() = Eigen::Vector4d::Unit(c);
    m.col(c) = (unit * r).coeffs();
  }
  return m;
}

/// Literal form of equation (2.1): minimises sum w_ij |q_i q_ij - q_j|^2 over the free frames, with
/// given handles.
std::vector<Quaternion> solve_frames(const Weighted_graph& graph,
                                     const Node_constraints& constraints,
                                     const std::vector<Quaternion>& rest,
                                     const std::vector<Similarity>& transforms)
{
  const pcs::deformation::Free_rows rows(constraints);
  const auto handle_frame = [&](std::size_t i) {
    const auto h = static_cast<std::size_t>(constraints.handle_of_node[i]);
    return Eigen::Vector4d(
        (pcs::rotation_exp(transforms[h].turns().empty() ? Vec3(Vec3::Zero())
                                                         : transforms[h].turns()[0]) *
         rest[i])
            .coeffs());
  };
  const auto m = static_cast<Eigen::Index>(4 * graph.neighbor.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(m, static_cast<Eigen::Index>(4 * rows.size()));
  Eigen::VectorXd b = Eigen::VectorXd::Zero(m);
  Eigen::Index equation = 0;
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e, equation += 4) {
      const std::size_t j = graph.neighbor[e];
      const double s = std::sqrt(graph.weight[e]);
      const Eigen::Matrix4d q_ij = s * right_product(rest[i].conjugate() * rest[j]);
      const auto add = [&](std::size_t node, const Eigen::Matrix4d& block) {
        if (constraints.is_prescribed(node))
          b.segment<4>(equation) -= block * handle_frame(node);
        else
          a.block<4, 4>(equation, 4 * static_cast<Eigen::Index>(rows.row_of_node[node])) += block;
      };
      add(i, q_ij);
      add(j, -s * Eigen::Matrix4d::Identity());
    }
  const Eigen::VectorXd x = a.colPivHouseholderQr().solve(b);
  std::vector<Quaternion> frames(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i)
    frames[i].coeffs() =
        constraints.is_prescribed(i)
            ? handle_frame(i)
            : Eigen::Vector4d(x.segment<4>(4 * static_cast<Eigen::Index>(rows.row_of_node[i])));
  return frames;
}

} // namespace

BOOST_AUTO_TEST_SUITE(rotation_field)

BOOST_AUTO_TEST_CASE(the_quaternion_field_is_the_literal_system_of_the_dissertation)
{
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    const auto network = pcs_test::network_of(pcs_test::random_points(70 + 10 * seed, seed));
    Node_constraints c;
    c.softness_weight = {0, 0, 0};
    std::vector<Quaternion> rest_frame;
    for (const Vec3& p : network.rest) {
      c.handle_of_node.push_back(p.x() < -.7 ? 0 : p.x() > .7 ? 1 : p.y() > .8 ? 2 : free_node);
      rest_frame.push_back(pcs::rotation_exp(3 * pcs_test::random_vector(random)));
    }
    const std::vector<Similarity> transforms{turn(Vec3(.2, 0, 0)),
                                             turn(1.5 * pcs_test::random_vector(random)),
                                             Similarity()};
    const auto p = field(Rotation_field::quaternion, network.surface, c, transforms);
    const auto q = solve_frames(network.surface, c, rest_frame, transforms);
    for (std::size_t i = 0; i < p.size(); ++i)
      BOOST_REQUIRE((q[i].normalized().coeffs() - (p[i] * rest_frame[i]).coeffs()).norm() < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(about_one_axis_the_angle_is_linear_along_a_path_for_any_number_of_turns)
{
  const auto graph = pcs_test::path_graph(73);
  const Vec3 axis = Vec3(1, -2, 2) / 3;
  for (const double angle : {0.3, 2.0, pi, 5.0, 4 * pi, 20 * pi}) {
    const auto q = field(Rotation_field::geodesic,
                         graph,
                         path_constraints(73),
                         {turn(-0.1 * angle * axis), turn(0.9 * angle * axis)});
    for (std::size_t i = 0; i < 73; ++i)
      BOOST_TEST(angle_between(q[i], pcs::rotation_exp(angle * (double(i) / 72 - 0.1) * axis)) <
                 1e-10);
  }
}

BOOST_AUTO_TEST_CASE(about_two_axes_the_field_follows_the_geodesic)
{
  // The geodesic between two rotations is that of their difference.
  const auto graph = pcs_test::path_graph(41);
  const Vec3 a = Vec3(40, 0, 0) * degree, b = Vec3(0, 50, 20) * degree;
  const auto q = field(Rotation_field::geodesic, graph, path_constraints(41), {turn(a), turn(b)});
  const Quaternion start = pcs::rotation_exp(a);
  const Vec3 difference = pcs::rotation_log(pcs::rotation_exp(b) * start.conjugate());
  for (std::size_t i = 0; i < 41; ++i)
    BOOST_TEST(angle_between(q[i], pcs::rotation_exp(difference * double(i) / 40) * start) <
               0.05 * degree);
}

BOOST_AUTO_TEST_CASE(several_large_turns_one_after_another_change_evenly)
{
  // 400 degrees about z, then 90 about x: each step along the path has nearly the same angle.
  const auto graph = pcs_test::path_graph(101);
  const Similarity both = turn(Vec3(90 * degree, 0, 0)) * turn(Vec3(0, 0, 400 * degree));
  const auto q =
      field(Rotation_field::geodesic, graph, path_constraints(101), {Similarity(), both});
  double total = 0, largest = 0;
  for (std::size_t i = 1; i < 101; ++i) {
    const double step = angle_between(q[i], q[i - 1]) / degree;
    total += step;
    largest = std::max(largest, step);
  }
  BOOST_TEST(total > 380);
  BOOST_TEST(largest < 6);
  BOOST_TEST((q.back().toRotationMatrix() - both.rotation()).norm() < 1e-12);
}

BOOST_AUTO_TEST_CASE(identity_handles_give_the_exact_identity)
{
  const auto graph = pcs_test::path_graph(11);
  for (const auto kind : {Rotation_field::geodesic, Rotation_field::quaternion})
    for (const auto& q : field(kind, graph, path_constraints(11), {Similarity(), Similarity()}))
      BOOST_TEST((q.vec().norm() == 0 && q.w() == 1));
}

BOOST_AUTO_TEST_CASE(opposite_handles_still_give_rotations)
{
  const auto graph = pcs_test::path_graph(11);
  for (const auto kind : {Rotation_field::geodesic, Rotation_field::quaternion})
    for (const Vec3& u : {Vec3(0, 0, 2 * pi), Vec3(0, 0, pi), Vec3(0, 0, -2 * pi)})
      for (const auto& q : field(kind, graph, path_constraints(11), {Similarity(), turn(u)}))
        BOOST_TEST(q.coeffs().allFinite());
}

BOOST_AUTO_TEST_CASE(unreached_nodes_keep_the_identity)
{
  auto graph = pcs_test::path_graph(6);
  auto c = path_constraints(6);
  c.handle_of_node = {0, free_node, 1, 0, pcs::deformation::unreached_node, 1};
  const auto q = field(Rotation_field::geodesic, graph, c, {turn(Vec3(1, 0, 0)), Similarity()});
  BOOST_TEST((q[4].coeffs() == Quaternion::Identity().coeffs()));
}

BOOST_AUTO_TEST_CASE(a_soft_handle_turns_its_node_part_of_the_way)
{
  const auto graph = pcs_test::path_graph(11);
  for (const auto& transforms :
       {std::vector<Similarity>{Similarity(), turn(Vec3(0, 0, 1))},              // one axis
        std::vector<Similarity>{turn(Vec3(1e-3, 0, 0)), turn(Vec3(0, 0, 1))}}) { // two axes
    auto c = path_constraints(11);
    c.softness_weight = {0, 0.1};
    const auto q = field(Rotation_field::geodesic, graph, c, transforms);
    // Ten unit springs and a weight of a tenth of the degree 1: half of the rotation.
    BOOST_TEST(angle_between(q[10], q[0]) == 0.5, boost::test_tools::tolerance(0.02));
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_rotation_field

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Coordinates of edge directions: inverse functions, means, yaw, rigid and free branches.

#include <pcs/core/rotations.h>
#include <pcs/shape_space/statistics/Direction_chart.h>
#include <support/layouts.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_Direction_chart {

using namespace pcs::shape_space;
using pcs::Quaternion;

namespace {

constexpr std::size_t number_of_branches = 4; ///< on the trunk, each with one branch on it

Quaternion frame_of(double slant, double azimuth)
{
  return Quaternion(Eigen::AngleAxisd(azimuth, Vec3::UnitZ()) *
                    Eigen::AngleAxisd(slant, Vec3::UnitY()));
}

/// Trees of a trunk, branches and branches of these, one edge each. Branches have random slants
/// and azimuths. Those on them either keep their angle to the parent, or grow upwards.
struct Trees
{
  Orl_layout layout;
  std::vector<Quaternion> middle;
  std::vector<std::vector<Quaternion>> frame;
  std::vector<std::vector<char>> has;

  Trees(std::size_t n, double deviation, bool is_rigid)
  {
    std::vector<orl_test::Layout_branch> branches{{none, 1, none}};
    for (std::size_t b = 0; b < number_of_branches; ++b)
      branches.push_back({0, 1, 0});
    for (std::size_t b = 0; b < number_of_branches; ++b)
      branches.push_back({1 + b, 1, 1 + b});
    layout = orl_test::layout_of(branches);
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const auto near = [&](double slant, double azimuth, double size_1, double size_2) {
      const double s = slant + size_1 * normal(random);
      return frame_of(s, azimuth + size_2 * normal(random));
    };
    const auto make = [&](double size) {
      std::vector<Quaternion> result{frame_of(0.1 * size * std::abs(normal(random)), 1)};
      for (std::size_t b = 0; b < number_of_branches; ++b)
        result.push_back(near(0.9, 1.6 * double(b), size, size));
      for (std::size_t b = 0; b < number_of_branches; ++b)
        result.push_back(is_rigid ? result[1 + b] * frame_of(0.7, 2)
                                  : near(0.6, 1.6 * double(b), 0.1 * size, 0.3 * size));
      return result;
    };
    middle = make(0);
    for (std::size_t t = 0; t < n; ++t)
      frame.push_back(make(deviation));
    has.assign(n, std::vector<char>(layout.branches.size(), 1));
  }

  Direction_chart chart() const
  {
    return Direction_chart(layout,
                           Vec3::UnitZ(),
                           middle,
                           frame,
                           has,
                           std::vector<double>(layout.number_of_edges(), 1));
  }
};

std::vector<Vec3> directions_of(const std::vector<Quaternion>& frames)
{
  std::vector<Vec3> result;
  for (const Quaternion& q : frames)
    result.push_back(q * Vec3::UnitZ());
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(direction_charts)

BOOST_AUTO_TEST_CASE(directions_are_given_back_up_to_the_yaw_of_the_tree)
{
  for (const bool is_rigid : {false, true}) {
    const Trees trees(6, 0.2, is_rigid);
    const Direction_chart chart = trees.chart();
    for (std::size_t t = 0; t < trees.frame.size(); ++t) {
      const std::vector<Vec3> d = directions_of(trees.frame[t]);
      const std::vector<Vec3> back = directions_of(chart.exp(chart.log(d, trees.has[t], t)));
      for (std::size_t i = 0; i < d.size(); ++i) {
        BOOST_TEST(std::abs(back[i].z() - d[i].z()) < 1e-9);
        for (std::size_t j = 0; j < i; ++j)
          BOOST_TEST(std::abs(back[i].dot(back[j]) - d[i].dot(d[j])) < 1e-9);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(trees_that_differ_by_a_yaw_have_the_coordinates_of_the_mean)
{
  Trees trees(5, 0, false);
  for (std::size_t t = 0; t < trees.frame.size(); ++t)
    for (Quaternion& q : trees.frame[t])
      q = Quaternion(Eigen::AngleAxisd(0.4 * double(t), Vec3::UnitZ())) * q;
  const Direction_chart chart = trees.chart();
  for (std::size_t t = 0; t < trees.frame.size(); ++t)
    for (const auto& z : chart.log(directions_of(trees.frame[t]), trees.has[t], t))
      BOOST_TEST(z.norm() < 1e-7);
}

BOOST_AUTO_TEST_CASE(coordinates_are_zero_on_average)
{
  const Trees trees(8, 0.1, false);
  const Direction_chart chart = trees.chart();
  std::vector<Direction_chart::Pair> mean(trees.layout.number_of_edges(),
                                          Direction_chart::Pair::Zero());
  double spread = 0;
  for (std::size_t t = 0; t < trees.frame.size(); ++t) {
    const auto z = chart.log(directions_of(trees.frame[t]), trees.has[t], t);
    for (std::size_t e = 0; e < z.size(); ++e) {
      mean[e] += z[e] / double(trees.frame.size());
      spread += z[e].norm();
    }
  }
  BOOST_TEST(spread > 1);
  for (const Direction_chart::Pair& m : mean) {
    BOOST_TEST(std::abs(m[0]) < 1e-9); // slants
    BOOST_TEST(std::abs(m[1]) < 0.01); // azimuths: circular means
  }
}

BOOST_AUTO_TEST_CASE(children_of_a_steeper_branch_follow_it_where_those_of_the_trees_do)
{
  for (const bool is_rigid : {false, true}) {
    const Trees trees(12, 0.25, is_rigid);
    const Direction_chart chart = trees.chart();
    std::vector<Direction_chart::Pair> z(trees.layout.number_of_edges(),
                                         Direction_chart::Pair::Zero());
    const std::vector<Vec3> before = directions_of(chart.exp(z));
    z[1][0] += 0.3; // slant of the first branch
    const std::vector<Vec3> after = directions_of(chart.exp(z));
    constexpr std::size_t child = 1 + number_of_branches;
    BOOST_TEST(std::abs(std::acos(after[1].z()) - std::acos(before[1].z()) - 0.3) < 1e-9);
    const double angle_to_parent =
        std::abs(std::acos(after[child].dot(after[1])) - std::acos(before[child].dot(before[1])));
    const double angle_to_vertical =
        std::abs(std::acos(after[child].z()) - std::acos(before[child].z()));
    if (is_rigid)
      BOOST_TEST(angle_to_parent < 1e-9);
    else {
      BOOST_TEST(angle_to_vertical < 0.05);
      BOOST_TEST(angle_to_parent > 0.2);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_azimuth_of_children_is_relative_to_their_parent)
{
  const Direction_chart chart = Trees(8, 0.1, false).chart();
  std::vector<Direction_chart::Pair> z(1 + 2 * number_of_branches, Direction_chart::Pair::Zero());
  const std::vector<Vec3> before = directions_of(chart.exp(z));
  z[2][1] += 0.5;
  const std::vector<Vec3> after = directions_of(chart.exp(z));
  const Eigen::AngleAxisd turn(0.5, Vec3::UnitZ());
  for (std::size_t e = 0; e < z.size(); ++e)
    BOOST_TEST(
        (after[e] - (e == 2 || e == 2 + number_of_branches ? turn * before[e] : before[e])).norm() <
        1e-9);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Direction_chart

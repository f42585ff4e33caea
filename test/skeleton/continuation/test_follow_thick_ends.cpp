// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A thick limb with few points near its base is continued to the trunk, or counted as open.

#include <pcs/core/Skeleton_report.h>
#include <pcs/skeleton/continuation/Held_axes.h>
#include <pcs/skeleton/continuation/follow_thick_ends.h>
#include <pcs/skeleton/result/skeleton_warnings.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/axes.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace test_follow_thick_ends {

using namespace pcs::skeleton;

namespace {

constexpr double pi = 3.14159265358979323846, trunk_radius = 0.1, limb_radius = 0.04;
constexpr double inner = 0.8, outer = 1.6; ///< ends of the sparse part and of the limb
constexpr std::size_t number_of_twigs = 6;
constexpr double twig_radius = 0.002;

/// A trunk and a limb. The axis of the limb begins at `inner`, where its points become dense.
class Limb
{
public:
  Scan scan;
  Axis_set set;
  std::vector<Index> root; ///< lowest points

  /// `number_of_points` is the number on the inner part of the limb. They lie up to `depth` radii
  /// below its surface. If `is_forked`, a second limb begins where the points become dense. Six
  /// twigs with axes run along the surface if each has points.
  Limb(std::size_t number_of_points,
       double depth,
       bool is_forked = false,
       std::size_t points_of_twig = 0)
  {
    const Vec3 fork = inner * m_along + m_seat, tip = fork + (outer - inner) * Vec3(0.6, 0, 0.8);
    add_tube(0, Vec3::Zero(), Vec3(0, 0, 2), trunk_radius);
    add_tube(1, fork, outer * m_along + m_seat, limb_radius);
    if (is_forked)
      add_tube(2, fork, tip, limb_radius);
    add_few(number_of_points, depth);
    const Index first_twig = is_forked ? 3 : 2;
    for (std::size_t k = 0; k < number_of_twigs; ++k)
      add_twig(first_twig + static_cast<Index>(k), k, points_of_twig);
    prepare_scan<CGAL::Sequential_tag>(m_points, Vec3::UnitZ(), scan);
    std::fill(scan.is_outlier.begin(), scan.is_outlier.end(), std::uint8_t(0));
    set.noise = 0.001 / scan.frame.unit;
    add_axis(Vec3::Zero(), Vec3(0, 0, 2), trunk_radius);
    add_axis(fork, outer * m_along + m_seat, limb_radius);
    if (is_forked)
      add_axis(fork, tip, limb_radius);
    for (std::size_t k = 0; k < number_of_twigs && points_of_twig > 0; ++k)
      add_axis(on_surface(k, trunk_radius), on_surface(k, inner), twig_radius);
    pcs_test::assign_points(scan, m_axis, set);
    for (std::size_t k = 0; k < m_points.size(); ++k)
      if (m_points[k].z() < 0.02)
        root.push_back(scan.point_of_input[k]);
  }

  Followed_ends follow()
  {
    return follow_thick_ends(scan,
                             std::vector<std::uint8_t>(scan.size(), 1),
                             Chain_options(),
                             Thick_end_options(),
                             root,
                             {},
                             Coarse_axis_options(),
                             {},
                             set);
  }
  /// Makes one axis of both limbs, which narrows to both tips.
  void join_branches()
  {
    Axis& axis = set.axes[1].axis;
    Axis& other = set.axes[2].axis;
    const std::size_t shift = other.size() - 1;
    for (Axis* branch : {&axis, &other})
      for (std::size_t k = 0; k < branch->size(); ++k)
        (*branch)[k].radius *= 1 - 0.4 * double(k) / double(branch->size());
    for (std::size_t i = 0; i < scan.size(); ++i)
      if (set.axis_of_point[i] == 1)
        set.segment_of_point[i] += static_cast<Index>(shift);
      else if (set.axis_of_point[i] == 2) {
        set.axis_of_point[i] = 1;
        set.segment_of_point[i] = static_cast<Index>(shift - 1) - set.segment_of_point[i];
      }
    axis.insert(axis.begin(), other.rbegin(), other.rend() - 1);
    set.axes[1].number_of_points += set.axes[2].number_of_points;
    set.axes.pop_back();
  }
  Vec3 seat() const { return scan.frame.to_local(m_seat); }

private:
  void add(Index axis, const Vec3& p)
  {
    m_points.push_back(p);
    m_axis.push_back(axis);
  }
  void add_tube(Index axis, const Vec3& a, const Vec3& b, double r)
  {
    constexpr double spacing = 0.01;
    const Vec3 along = (b - a).normalized(), e1 = along.unitOrthogonal(), e2 = along.cross(e1);
    for (double z = 0; z < (b - a).norm(); z += spacing)
      for (double t = 0; t < 2 * pi; t += spacing / r)
        add(axis, a + z * along + r * (std::cos(t) * e1 + std::sin(t) * e2));
  }
  void add_few(std::size_t count, double depth)
  {
    constexpr double golden = 2.39996323; // [rad]
    const Vec3 e1 = m_along.unitOrthogonal(), e2 = m_along.cross(e1);
    for (std::size_t k = 0; k < count; ++k) {
      const double z = trunk_radius + (inner - trunk_radius) * (double(k) + 0.5) / double(count);
      const double r = limb_radius * (1 - depth * double(k % 4) / 3), t = golden * double(k);
      add(none, m_seat + z * m_along + r * (std::cos(t) * e1 + std::sin(t) * e2));
    }
  }
  /// Returns a place on the surface of the limb.
  Vec3 on_surface(std::size_t twig, double z) const
  {
    const double t = 2 * pi * double(twig) / double(number_of_twigs);
    const Vec3 e1 = m_along.unitOrthogonal(), e2 = m_along.cross(e1);
    return m_seat + z * m_along + limb_radius * (std::cos(t) * e1 + std::sin(t) * e2);
  }
  void add_twig(Index axis, std::size_t twig, std::size_t count)
  {
    for (std::size_t k = 0; k < count; ++k)
      add(axis,
          on_surface(twig,
                     trunk_radius + (inner - trunk_radius) * (double(k) + 0.5) / double(count)));
  }
  void add_axis(const Vec3& a, const Vec3& b, double r)
  {
    const double radius = r / scan.frame.unit;
    set.axes.emplace_back();
    set.axes.back().axis =
        pcs_test::straight_axis(scan.frame.to_local(a), scan.frame.to_local(b), 40, radius, radius);
  }

  Vec3 m_seat = Vec3(0, 0, 1), m_along = Vec3(0.8, 0, 0.6);
  std::vector<Vec3> m_points;
  std::vector<Index> m_axis;
};

} // namespace

BOOST_AUTO_TEST_SUITE(thick_ends)

BOOST_AUTO_TEST_CASE(a_thick_limb_with_few_points_is_continued_to_its_trunk)
{
  // 400 points per square metre, five centimetres apart, on a radius of four.
  Limb limb(70, 0);
  const Followed_ends found = limb.follow();
  BOOST_TEST(found.number_of_ends == 1u);
  BOOST_TEST(found.number_of_unexplained_points == 0u);
  BOOST_REQUIRE(limb.set.axes.size() == 2u);
  const double unit = limb.scan.frame.unit;
  const Axis& axis = limb.set.axes[1].axis;
  BOOST_TEST((axis.front().point - limb.seat()).norm() * unit < trunk_radius + limb_radius);
  for (const Axis_node& node : axis) {
    const Vec3 d = node.point - limb.seat();
    const Vec3 along(0.8, 0, 0.6);
    BOOST_TEST((d - d.dot(along) * along).norm() * unit < 0.1 * limb_radius);
    BOOST_TEST(std::abs(node.radius * unit / limb_radius - 1) < 0.1);
  }
  const auto open = std::count(limb.set.axis_of_point.begin(), limb.set.axis_of_point.end(), none);
  BOOST_TEST(open <= 7); // beside the trunk
}

BOOST_AUTO_TEST_CASE(a_straight_limb_needs_few_points)
{
  // 100 points per square metre: pieces of eight radii have six points, too few for a piece.
  Limb limb(18, 0);
  const Followed_ends found = limb.follow();
  BOOST_TEST(found.number_of_ends == 1u);
  BOOST_TEST(found.number_of_unexplained_points == 0u);
  const Axis& axis = limb.set.axes[1].axis;
  const double unit = limb.scan.frame.unit;
  BOOST_TEST((axis.front().point - limb.seat()).norm() * unit < trunk_radius + limb_radius);
}

BOOST_AUTO_TEST_CASE(two_loose_branches_do_not_hold_each_other)
{
  Limb limb(70, 0, true);
  const Followed_ends found = limb.follow();
  BOOST_TEST(found.number_of_ends == 1u); // the other branch lies on the continued one
  BOOST_TEST(found.number_of_unexplained_points == 0u);
  BOOST_REQUIRE(limb.set.axes.size() == 3u);
  const double unit = limb.scan.frame.unit;
  const auto gap = [&](std::size_t a) {
    return (limb.set.axes[a].axis.front().point - limb.seat()).norm() * unit;
  };
  BOOST_TEST(std::min(gap(1), gap(2)) < trunk_radius + limb_radius);
  Limb open(140, 1, true); // no hollow interior
  BOOST_TEST(open.follow().number_of_unexplained_points > 30u);
}

BOOST_AUTO_TEST_CASE(an_axis_across_a_fork_is_continued_from_its_lowest_place)
{
  Limb limb(70, 0, true);
  limb.join_branches();
  const Followed_ends found = limb.follow();
  BOOST_TEST(found.number_of_ends == 1u);
  BOOST_TEST(found.number_of_unexplained_points == 0u);
  BOOST_REQUIRE(limb.set.axes.size() == 3u);
  const double unit = limb.scan.frame.unit;
  const Vec3 seat = limb.seat(), base = limb.set.axes[1].axis.front().point;
  BOOST_TEST((base - seat).norm() * unit < trunk_radius + limb_radius);
  BOOST_TEST((limb.set.axes[2].axis.front().point - seat).norm() * unit < inner + 4 * limb_radius);
  BOOST_TEST(limb.set.axes[2].number_of_points > 100u);
}

BOOST_AUTO_TEST_CASE(held_thick_axes_keep_their_points)
{
  Limb limb(70, 0);
  const Chain_options chains;
  const Thick_end_options rules;
  const std::vector<std::uint8_t> is_free(limb.scan.size(), 1);
  Held_axes axes(limb.scan, is_free, chains, rules, limb.root, limb.set);
  BOOST_TEST_REQUIRE(axes.is_held(0));
  const std::size_t count = limb.set.axes[0].number_of_points;
  Axis fat = limb.set.axes[0].axis; // encloses the trunk
  for (Axis_node& node : fat)
    node.radius *= 2;
  axes.replace(1, fat, 0);
  BOOST_TEST(limb.set.axes[0].number_of_points == count);
}

BOOST_AUTO_TEST_CASE(dense_twigs_do_not_continue_a_limb)
{
  Limb strands(0, 0, false, 12), twigs(0, 0, false, 120); // 17 and 170 points per metre
  BOOST_TEST(strands.follow().number_of_ends == 1u);
  BOOST_TEST(twigs.follow().number_of_ends == 0u);
}

BOOST_AUTO_TEST_CASE(points_inside_are_no_wood_and_are_counted)
{
  Limb limb(140, 1);
  const Axis before = limb.set.axes[1].axis;
  const Followed_ends found = limb.follow();
  BOOST_TEST(found.number_of_ends == 0u);
  BOOST_TEST(found.number_of_unexplained_points > 30u);
  BOOST_TEST(limb.set.axes[1].axis.size() == before.size());
}

BOOST_AUTO_TEST_CASE(unexplained_points_of_thick_wood_give_a_warning)
{
  pcs::Skeleton_report report;
  BOOST_TEST(pcs::warnings(report).empty());
  report.number_of_unexplained_thick_points = 42;
  const std::vector<std::string> sentences = pcs::warnings(report);
  BOOST_REQUIRE(sentences.size() == 1u);
  BOOST_TEST(sentences.front().find("42 points") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_follow_thick_ends

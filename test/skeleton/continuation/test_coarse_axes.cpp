// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A thick limb with few points is found in the thinned scan; bundles of twigs and stems that are
// seen from one side are not mistaken for one.

#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/Session_impl.h>
#include <pcs/skeleton/continuation/add_coarse_pieces.h>
#include <pcs/skeleton/continuation/find_coarse_axes.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/axes.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace test_coarse_axes {

using namespace pcs::skeleton;

namespace {

constexpr double pi = 3.14159265358979323846, golden = 2.39996323; // [rad]
constexpr double trunk_radius = 0.1, limb_radius = 0.05, limb_length = 1.5;
constexpr double dense = 0.01; ///< spacing on the trunk

/// A trunk with an axis, and points of a limb that thin axes along its surface explain.
class Sparse_limb
{
public:
  Scan scan;
  Axis_set set;

  /// The limb has `count` points, over `turn` radians of its circumference, at most `depth` radii
  /// below its surface. They belong to `strands` axes.
  Sparse_limb(std::size_t count, double turn, double depth, std::size_t strands)
  {
    for (double z = 0; z < 2; z += dense)
      for (double t = 0; t < 2 * pi; t += dense / trunk_radius)
        add(0, Vec3(trunk_radius * std::cos(t), trunk_radius * std::sin(t), z));
    for (std::size_t k = 0; k < count; ++k) {
      const double t = std::fmod(golden * double(k), turn);
      const double z = trunk_radius + limb_length * (double(k) + 0.5) / double(count);
      const double r = limb_radius * (1 - depth * double(k % 5) / 4);
      const auto strand = static_cast<Index>(t / turn * double(strands));
      add(strands > 0 ? 1 + strand : none, place(z, r, t));
    }
    prepare_scan<CGAL::Sequential_tag>(m_points, Vec3::UnitZ(), scan);
    std::fill(scan.is_outlier.begin(), scan.is_outlier.end(), std::uint8_t(0));
    set.noise = 0.001 / scan.frame.unit;
    add_axis(Vec3::Zero(), Vec3(0, 0, 2), trunk_radius);
    for (std::size_t k = 0; k < strands; ++k) {
      const double t = turn * (double(k) + 0.5) / double(strands);
      add_axis(place(trunk_radius, limb_radius, t),
               place(trunk_radius + limb_length, limb_radius, t),
               0.002);
    }
    pcs_test::assign_points(scan, m_axis, set);
    for (std::size_t k = 0; k < m_points.size(); ++k)
      if (m_points[k].z() < 0.02)
        m_root.push_back(scan.point_of_input[k]);
  }

  std::vector<Coarse_axis> find() const
  {
    return find_coarse_axes<CGAL::Sequential_tag>(scan,
                                                  used(),
                                                  m_root,
                                                  set,
                                                  thick(),
                                                  Axis_options(),
                                                  Layer_options(),
                                                  Coarse_axis_options(),
                                                  [](double) { return true; });
  }
  const std::vector<Vec3>& points() const { return m_points; }
  /// Returns the axis of the limb as a coarse axis.
  Coarse_axis true_axis() const
  {
    const double radius = limb_radius / scan.frame.unit;
    const Vec3 base = scan.frame.to_local(place(trunk_radius, 0, 0));
    const Vec3 tip = scan.frame.to_local(place(trunk_radius + limb_length, 0, 0));
    return {pcs_test::straight_axis(base, tip, 40, radius, radius), 0.5 * radius};
  }
  /// Adds the pieces of coarse axes. Returns their number.
  std::size_t add_pieces(const std::vector<Coarse_axis>& coarse)
  {
    const std::vector<std::uint8_t> is_used = used();
    const Chain_options chains;
    const Thick_end_options rules;
    Held_axes axes(scan, is_used, chains, rules, m_root, set);
    std::size_t count = 0;
    for (const Coarse_axis& axis : coarse)
      count +=
          add_coarse_pieces(scan, is_used, axis, set.noise, chains, Coarse_axis_options(), axes);
    axes.drop_lost();
    return count;
  }

  /// Returns the distance of a node from the axis of the limb, and its radius [m].
  std::pair<double, double> compare(const Axis_node& node) const
  {
    const Vec3 d = scan.frame.to_input(node.point) - m_seat;
    return {(d - d.dot(m_along) * m_along).norm(), node.radius * scan.frame.unit};
  }
  /// Returns the fraction of the points that lie on an axis of the radius of the limb.
  double found_share() const
  {
    double found = 0, all = 0;
    for (std::size_t k = 0; k < m_points.size(); ++k) {
      const Index i = scan.point_of_input[k];
      if (m_axis[k] == 0)
        continue;
      ++all;
      if (set.is_covered(i)) {
        const Axis& axis = set.axes[set.axis_of_point[i]].axis;
        const double r = axis[set.segment_of_point[i]].radius * scan.frame.unit;
        found += std::abs(r / limb_radius - 1) < 0.1;
      }
    }
    return found / all;
  }

private:
  std::vector<std::uint8_t> used() const { return std::vector<std::uint8_t>(scan.size(), 1); }
  double thick() const { return Thick_end_options().least_radius(scan.spacing, set.noise); }

  Vec3 place(double along, double radius, double turn) const
  {
    const Vec3 e1 = m_along.unitOrthogonal(), e2 = m_along.cross(e1);
    return m_seat + along * m_along + radius * (std::cos(turn) * e1 + std::sin(turn) * e2);
  }
  void add(Index axis, const Vec3& p)
  {
    m_points.push_back(p);
    m_axis.push_back(axis);
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
  std::vector<Index> m_axis, m_root;
};

} // namespace

BOOST_AUTO_TEST_SUITE(coarse_axes)

BOOST_AUTO_TEST_CASE(a_limb_with_few_points_has_a_coarse_axis)
{
  // 640 points per square metre, four centimetres apart; one centimetre apart on the trunk.
  Sparse_limb limb(300, 2 * pi, 0, 0);
  std::size_t nodes = 0;
  for (const Coarse_axis& coarse : limb.find())
    for (const Axis_node& node : coarse.axis) {
      const auto [offset, radius] = limb.compare(node);
      nodes += offset < 0.2 * limb_radius && std::abs(radius / limb_radius - 1) < 0.2;
    }
  BOOST_TEST(nodes > 10u);
  BOOST_TEST(limb.add_pieces(limb.find()) >= 1u);
  BOOST_TEST(limb.found_share() > 0.8);
}

BOOST_AUTO_TEST_CASE(it_replaces_strands_along_the_surface)
{
  Sparse_limb limb(300, 2 * pi, 0, 6);
  BOOST_TEST(limb.found_share() == 0);
  BOOST_TEST(limb.add_pieces(limb.find()) >= 1u);
  BOOST_TEST(limb.found_share() > 0.8);
  BOOST_TEST(limb.set.axes.size() < 5u); // most strands lost their points
}

BOOST_AUTO_TEST_CASE(nearly_all_points_lie_on_the_surface_of_a_limb)
{
  // One of five points is as deep as this; the surface is 0.15 radii thick on both sides.
  Sparse_limb even(300, 2 * pi, 0.14, 0), rough(300, 2 * pi, 0.19, 0);
  BOOST_TEST(even.add_pieces({even.true_axis()}) == 1u);
  BOOST_TEST(rough.add_pieces({rough.true_axis()}) == 0u);
}

BOOST_AUTO_TEST_CASE(points_inside_a_tube_are_no_limb)
{
  Sparse_limb limb(300, 2 * pi, 1, 0);
  BOOST_TEST(limb.add_pieces(limb.find()) == 0u);
}

BOOST_AUTO_TEST_CASE(a_third_of_a_tube_is_no_evidence)
{
  Sparse_limb limb(150, 2 * pi / 3, 0, 0);
  BOOST_TEST(limb.add_pieces(limb.find()) == 0u);
}

BOOST_AUTO_TEST_CASE(wood_with_an_axis_is_left_alone)
{
  Sparse_limb limb(0, 2 * pi, 0, 0);
  BOOST_TEST(limb.add_pieces(limb.find()) == 0u);
  BOOST_TEST(limb.set.axes.size() == 1u);
}

BOOST_AUTO_TEST_CASE(dense_twigs_are_left_out)
{
  const Sparse_limb limb(300, 2 * pi, 0, 6);
  const std::vector<std::uint8_t> used(limb.scan.size(), 1);
  const auto count = [&](double thick) {
    const std::vector<std::uint8_t> left =
        points_of_sparse_wood(limb.scan, used, Coarse_axis_options(), thick, limb.set);
    return static_cast<std::size_t>(std::count(left.begin(), left.end(), 1));
  };
  BOOST_TEST(count(0) == limb.scan.size());
  BOOST_TEST(count(1) == 300u); // the trunk has many points per length, the strands have few
}

BOOST_AUTO_TEST_CASE(the_search_can_be_stopped)
{
  const Sparse_limb limb(300, 2 * pi, 0, 0);
  int calls = 0;
  const std::vector<Coarse_axis> none_found =
      find_coarse_axes<CGAL::Sequential_tag>(limb.scan,
                                             std::vector<std::uint8_t>(limb.scan.size(), 1),
                                             {0},
                                             limb.set,
                                             0.01,
                                             Axis_options(),
                                             Layer_options(),
                                             Coarse_axis_options(),
                                             [&](double) { return ++calls < 2; });
  BOOST_TEST(calls == 2);
  BOOST_TEST(none_found.empty());
}

BOOST_AUTO_TEST_CASE(a_session_that_is_stopped_at_coarse_axes_goes_on)
{
  using Session = pcs::skeleton::Session<CGAL::Sequential_tag>;
  const Sparse_limb limb(300, 2 * pi, 0, 0);
  Session_options options{Session_hints()};
  std::size_t calls = 0;
  pcs::internal::Progress count([&](double) { return ++calls > 0; });
  Session full(limb.points(), {}, options);
  BOOST_TEST_REQUIRE(full.join(count));
  const std::size_t with_coarse_axes = std::exchange(calls, 0);
  options.coarse_axes.factors.clear();
  Session without(limb.points(), {}, options);
  BOOST_TEST_REQUIRE(without.join(count));
  // They change the skeleton, and their search asks whether to go on.
  BOOST_TEST(full.report().total.volume > 1.1 * without.report().total.volume);
  BOOST_TEST(with_coarse_axes > calls);

  std::size_t stops = 0;
  Session stopped(limb.points(), {}, Session_options(Session_hints()));
  for (std::size_t limit = 1; limit < with_coarse_axes; ++limit) {
    std::size_t left = limit;
    pcs::internal::Progress stop([&](double) { return left-- > 0; });
    if (stopped.join(stop))
      break;
    ++stops;
  }
  BOOST_TEST(stops > 10u);
  BOOST_TEST_REQUIRE(stopped.tree().nodes.size() == full.tree().nodes.size());
  for (std::size_t v = 0; v < full.tree().nodes.size(); ++v) {
    BOOST_TEST((stopped.tree().nodes[v].point == full.tree().nodes[v].point));
    BOOST_TEST(stopped.tree().nodes[v].radius == full.tree().nodes[v].radius);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_coarse_axes

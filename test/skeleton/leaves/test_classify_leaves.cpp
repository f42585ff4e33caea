// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Thin wood is linear, thick wood is a hollow section, and leaves are neither.

#include <pcs/skeleton/axes/reassign_points.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/leaves/classify_leaves.h>
#include <pcs/skeleton/leaves/wood_score_of_axes.h>
#include <pcs/skeleton/leaves/wood_score_of_paths.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/axes.h>
#include <support/drawn.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace test_find_leaves {

using namespace pcs::skeleton;

namespace {

using Points = std::vector<Vec3>;
using Flags = std::vector<std::uint8_t>;
using Any_tag = CGAL::Parallel_if_available_tag;

/// A twig of 1 m along z, seen from all sides.
void add_twig(Points& points, const Vec3& base, std::size_t count, std::mt19937& random)
{
  std::uniform_real_distribution<double> share(0, 1), turn(0, 2 * 3.14159265358979323846);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = turn(random);
    points.push_back(base + Vec3(0.004 * std::cos(angle), 0.004 * std::sin(angle), share(random)));
  }
}

/// Random leaves of 6 cm in a box of 1 m.
void add_leaves(Points& points, std::size_t count, std::mt19937& random)
{
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  std::normal_distribution<double> any;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 middle(share(random), share(random), 0.5 + share(random));
    const Vec3 a = pcs_test::drawn<Vec3>([&] { return any(random); }).normalized();
    const Vec3 b = a.cross(pcs_test::drawn<Vec3>([&] { return any(random); })).normalized();
    for (int i = 0; i < 30; ++i)
      points.push_back(middle + 0.06 * (share(random) * a + share(random) * b));
  }
}

/// A scan of points, and the index of each point in it.
struct Prepared
{
  Scan scan;
  Flags is_used, is_twig;
  Axis_set set;         ///< without axes
  Shortest_paths paths; ///< from the lowest point

  /// The first `number_of_wood` points are wood.
  Prepared(const Points& points, std::size_t number_of_wood)
  {
    prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
    is_used.assign(scan.size(), 1);
    is_twig.assign(scan.size(), 0);
    for (std::size_t i = 0; i < number_of_wood; ++i)
      is_twig[scan.point_of_input[i]] = 1;
    set.axis_of_point.assign(scan.size(), none);
    set.segment_of_point.assign(scan.size(), none);
    const Links links = neighbor_links<CGAL::Sequential_tag>(scan, is_used, {});
    const auto lowest =
        std::min_element(scan.points.begin(), scan.points.end(), [](const Vec3& a, const Vec3& b) {
          return a.z() < b.z();
        });
    paths = shortest_paths(scan,
                           graph_of(scan.size(), links),
                           {static_cast<Index>(lowest - scan.points.begin())});
  }

  /// Fractions of the twig points and of the other points for which a flag is set.
  std::pair<double, double> shares(const Flags& flags) const
  {
    double twig[2] = {0, 0}, other[2] = {0, 0};
    for (std::size_t i = 0; i < flags.size(); ++i)
      ++(is_twig[i] ? twig : other)[flags[i] != 0];
    return {twig[1] / (twig[0] + twig[1]), other[1] / std::max(1.0, other[0] + other[1])};
  }
};

Prepared twigs_in_leaves()
{
  std::mt19937 random(1);
  Points points;
  for (int k = 0; k < 4; ++k)
    add_twig(points, Vec3(0.2 * k - 0.3, 0.1 * k - 0.2, 0), 100, random);
  const std::size_t wood = points.size();
  add_leaves(points, 120, random);
  return Prepared(points, wood);
}

/// Same, with leaves attached to the twigs.
Prepared twigs_with_leaves()
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> any;
  Points points;
  std::vector<Vec3> bases;
  for (int k = 0; k < 5; ++k) {
    bases.emplace_back(0.1 * k, 0.02 * k, 0);
    add_twig(points, bases.back(), 200, random);
  }
  const std::size_t wood = points.size();
  for (const Vec3& base : bases)
    for (int k = 0; k < 25; ++k) {
      const Vec3 foot = base + Vec3(0, 0, 0.1 + 0.9 * share(random));
      const Vec3 a = pcs_test::drawn<Vec3>([&] { return any(random); }).normalized();
      const Vec3 b = a.cross(pcs_test::drawn<Vec3>([&] { return any(random); })).normalized();
      for (int i = 0; i < 25; ++i)
        points.push_back(foot + 0.06 * (share(random) * a + (share(random) - 0.5) * b));
    }
  return Prepared(points, wood);
}

/// An axis along z from 0 to 1 that explains all points.
Axis_set one_axis(const Scan& scan, double radius, double density, double x = 0)
{
  Axis_set set;
  set.axes.push_back({pcs_test::straight_axis(scan.frame.to_local(Vec3(x, 0, 0)),
                                              scan.frame.to_local(Vec3(x, 0, 1)),
                                              20,
                                              radius,
                                              radius),
                      none,
                      scan.size(),
                      1});
  set.density = density;
  set.axis_of_point.assign(scan.size(), 0);
  set.segment_of_point.resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
    set.segment_of_point[i] = nearest_place(set.axes[0].axis, scan.points[i]).segment;
  return set;
}

/// Points at distances of `from` to `to` from the z-axis.
Points pipe(std::size_t count, double from, double to)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1), turn(0, 2 * 3.14159265358979323846);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const double r = std::sqrt(from * from + (to * to - from * from) * share(random));
    const double angle = turn(random);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), share(random));
  }
  return points;
}

/// Moves points along z into rings of a given width.
Points in_rings(Points points, double distance, double width)
{
  for (Vec3& p : points) {
    const double ring = distance * std::round(p.z() / distance);
    p.z() = ring + width / distance * (p.z() - ring);
  }
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(leaf_wood_separation)

BOOST_AUTO_TEST_CASE(twigs_are_lines_and_leaves_around_them_are_not)
{
  const Prepared p = twigs_in_leaves();
  const Flags none_is_sure(p.scan.size(), 0);
  const auto [twigs, leaves] =
      p.shares(points_on_lines<CGAL::Sequential_tag>(p.scan, p.is_used, none_is_sure, {}));
  BOOST_CHECK_GT(twigs, 0.6);
  BOOST_CHECK_LT(leaves, 0.35);
  // Points of known class are not classified, but support others.
  const Flags all_are_sure(p.scan.size(), 1);
  BOOST_CHECK_EQUAL(
      p.shares(points_on_lines<CGAL::Sequential_tag>(p.scan, p.is_used, all_are_sure, {})).first,
      0.0);
}

BOOST_AUTO_TEST_CASE(surroundings_tell_twigs_from_leaves)
{
  const Prepared p = twigs_in_leaves();
  Flags is_likely(p.scan.size(), 0);
  std::size_t visits = 0;
  points_on_lines<CGAL::Sequential_tag>(
      p.scan,
      p.is_used,
      Flags(p.scan.size(), 0),
      {},
      [&](std::size_t i, const internal::Line_search& search, float score) {
        const double wood_score = wood_probability(search.surroundings(score));
        BOOST_CHECK(std::isfinite(wood_score));
        is_likely[i] = wood_score > 0;
        ++visits;
      });
  BOOST_CHECK_EQUAL(visits, p.scan.size());
  BOOST_CHECK_GT(p.shares(is_likely).first, 0.8);
  BOOST_CHECK_LT(p.shares(is_likely).second, 0.2);
}

BOOST_AUTO_TEST_CASE(paths_carry_those_that_lead_through_them)
{
  // A path of four points with a corner, a second tip at its corner, and a point without a path.
  Scan scan;
  scan.points =
      {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, 2), Vec3(1, 0, 2), Vec3(0, 1, 2), Vec3(9, 9, 9)};
  Shortest_paths paths;
  paths.predecessor = {0, 0, 1, 2, 2, 5};
  paths.distance = {0, 1, 2, 3, 3, std::numeric_limits<double>::infinity()};
  const std::vector<float> score = {3, 2, 1, -1, -2, -4};
  const double reach = 2, share = std::exp(-1 / reach);
  const std::vector<Path_context> found = path_contexts(scan, paths, score, reach);
  BOOST_REQUIRE_EQUAL(found.size(), score.size());
  const double carried[] = {5, 4, 3, 1, 1, 1};
  for (std::size_t i = 0; i < found.size(); ++i)
    BOOST_CHECK_EQUAL(found[i].carried, carried[i]);
  BOOST_CHECK_EQUAL(found[0].upstream, 3);
  BOOST_CHECK_CLOSE(found[1].upstream, (2 + share * 3) / (1 + share), 1e-6);
  BOOST_CHECK_CLOSE(found[2].upstream,
                    (1 + share * 2 + share * share * 3) / (1 + share + share * share),
                    1e-6);
  BOOST_CHECK_EQUAL(found[3].downstream, 0);
  BOOST_CHECK_CLOSE(found[2].downstream, -1.5, 1e-6);
  BOOST_CHECK_CLOSE(found[1].downstream, (1 + share * -3) / (1 + 2 * share), 1e-6);
  // Steps along z, then a step along x, which dominates.
  BOOST_CHECK_EQUAL(found[0].straightness, 1);
  BOOST_CHECK_CLOSE(found[2].straightness, 1, 1e-9);
  const double along_z = share * (1 + share);
  BOOST_CHECK_CLOSE(found[3].straightness, std::hypot(1, along_z) / (1 + along_z), 1e-6);
  BOOST_CHECK_EQUAL(found[5].upstream, -4);
  BOOST_CHECK_EQUAL(found[5].downstream, 0);
  BOOST_CHECK_EQUAL(found[5].straightness, 1);
  BOOST_CHECK(path_contexts(Scan(), Shortest_paths(), {}, 1).empty());
}

BOOST_AUTO_TEST_CASE(evidence_of_a_point)
{
  Scan scan;
  scan.spacing = 2;
  scan.points = {Vec3(1, 0, 0), Vec3(5, 0, 0), Vec3(1, 2, 0), Vec3(1, 0, 9)};
  std::vector<Path_context> path(4);
  const double carried[] = {1, 2, 5, 100};
  for (std::size_t i = 0; i < 4; ++i)
    path[i].carried = carried[i];
  path[0].upstream = 0.5;
  const std::vector<float> score = {-1, 2, 0.5F, 4};
  const Wood_evidence e = evidence_of_point(scan, {1, 1, 1, 0}, score, path, 0, {3, 2, 1, 0});
  BOOST_CHECK_EQUAL(e.score, -1);
  BOOST_CHECK_EQUAL(e.path.upstream, 0.5);
  BOOST_CHECK_EQUAL(e.count, 3);
  BOOST_CHECK_CLOSE(e.mean_score, 0.5, 1e-9);
  BOOST_CHECK_EQUAL(e.largest_score, 2);
  BOOST_CHECK_EQUAL(e.most_carried, 5);
  BOOST_CHECK_SMALL((e.mean - Vec3(2, 1, 0) / 3).norm(), 1e-12);
  BOOST_CHECK_SMALL((e.mean_of_paths - Vec3(4, 5, 0) / 8).norm(), 1e-12);
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  expected(0, 0) = 2 * 4 / 8.0 - 0.25;
  expected(1, 1) = 5 * 1 / 8.0 - 25 / 64.0;
  expected(0, 1) = expected(1, 0) = -0.5 * 0.625;
  BOOST_CHECK_SMALL((e.covariance_of_paths - expected).norm(), 1e-12);
}

BOOST_AUTO_TEST_CASE(paths_tell_twigs_from_leaves_better)
{
  const Prepared p = twigs_with_leaves();
  const Flags none_is_thick(p.scan.size(), 0);
  std::vector<float> wood_score(p.scan.size());
  points_on_lines<CGAL::Sequential_tag>(
      p.scan,
      p.is_used,
      none_is_thick,
      {},
      [&](std::size_t i, const internal::Line_search& search, float score) {
        wood_score[i] = static_cast<float>(wood_probability(search.surroundings(score)));
      });
  const std::vector<float> by_paths = wood_score_of_paths<CGAL::Sequential_tag>(p.scan,
                                                                                p.is_used,
                                                                                none_is_thick,
                                                                                p.paths,
                                                                                wood_score);
  BOOST_CHECK(by_paths ==
              wood_score_of_paths<Any_tag>(p.scan, p.is_used, none_is_thick, p.paths, wood_score));
  // Fraction of twig points found at the same fraction of false leaf points.
  const auto found_at = [&](const std::vector<float>& values, double leaves) {
    std::vector<float> others;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!p.is_twig[i])
        others.push_back(values[i]);
    std::sort(others.rbegin(), others.rend());
    const float limit = others[static_cast<std::size_t>(leaves * double(others.size()))];
    Flags is_wood(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      is_wood[i] = values[i] > limit;
    return p.shares(is_wood).first;
  };
  BOOST_CHECK(
      std::all_of(by_paths.begin(), by_paths.end(), [](float l) { return std::isfinite(l); }));
  for (const double leaves : {0.02, 0.1})
    BOOST_CHECK_GT(found_at(by_paths, leaves), found_at(wood_score, leaves) + 0.1);
}

BOOST_AUTO_TEST_CASE(what_is_sure_or_not_used_is_not_judged_by_paths)
{
  const Prepared p = twigs_in_leaves();
  Flags is_used(p.scan.size(), 0);
  for (std::size_t i = 0; i < is_used.size(); ++i)
    is_used[i] = i % 3 != 0;
  const Flags& is_thick = p.is_twig;
  const std::vector<float> wood_score(p.scan.size(), std::numeric_limits<float>::quiet_NaN());
  std::vector<float> of_used = wood_score;
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i] && !is_thick[i])
      of_used[i] = -1;
  const std::vector<float> found =
      wood_score_of_paths<CGAL::Sequential_tag>(p.scan, is_used, is_thick, p.paths, of_used);
  for (std::size_t i = 0; i < found.size(); ++i) {
    BOOST_REQUIRE(std::isfinite(found[i]));
    if (!is_used[i])
      BOOST_CHECK_EQUAL(found[i], 0);
    else if (is_thick[i])
      BOOST_CHECK_GT(found[i], 0);
  }
}

BOOST_AUTO_TEST_CASE(a_spread_is_that_of_the_points)
{
  Spread one, box;
  one.add(Vec3(3, 4, 0));
  const auto of_one = one.features();
  BOOST_CHECK_CLOSE(of_one[0], std::log(2.0), 1e-9);
  BOOST_CHECK_SMALL(of_one[1], 1e-6);
  BOOST_CHECK_CLOSE(of_one[4], 5.0, 1e-9);
  for (const double x : {-3.0, 3.0})
    for (const double y : {-2.0, 2.0})
      for (const double z : {0.0, 2.0})
        box.add(Vec3(x, y, z));
  const auto of_box = box.features();
  const double expected[] = {std::log(9.0), 3, 2, 1, 1};
  for (std::size_t k = 0; k < 5; ++k)
    BOOST_CHECK_CLOSE(of_box[k], expected[k], 1e-6);
}

BOOST_AUTO_TEST_CASE(evidence_of_an_axis)
{
  // Two axes end to end along z, one with points beside it; every fourth point is unused.
  Points points;
  for (int k = 0; k < 40; ++k)
    points.emplace_back(0.01 * (k % 2 == 0 ? 1 : -1), 0, 0.025 * k);
  Prepared p(points, 0);
  const double unit = p.scan.frame.unit;
  Axis_set set = one_axis(p.scan, 0.015 / unit, 1);
  set.axes.push_back(set.axes[0]);
  for (auto& node : set.axes[1].axis)
    node.point += p.scan.frame.to_local(Vec3(0, 0, 1)) - p.scan.frame.to_local(Vec3(0, 0, 0));
  set.axes[1].parent = 0;
  std::vector<float> wood_score(p.scan.size());
  std::vector<std::size_t> place(p.scan.size());
  for (std::size_t q = 0; q < points.size(); ++q) {
    place[p.scan.point_of_input[q]] = q;
    wood_score[p.scan.point_of_input[q]] = q < 10 ? 9 : -1;
  }
  for (std::size_t i = 0; i < p.scan.size(); ++i) {
    p.is_used[i] = place[i] % 4 != 3;
    if (!p.is_used[i])
      set.axis_of_point[i] = none;
  }
  const auto found =
      evidence_of_axes<Any_tag>(p.scan, set, p.is_used, p.paths, wood_score, 2 / unit);
  BOOST_REQUIRE_EQUAL(found.size(), 2);
  const Axis_evidence& e = found[0];
  const double spacing = p.scan.spacing * unit;
  BOOST_CHECK_CLOSE(e.length, 1 / spacing, 1e-6);
  BOOST_CHECK_CLOSE(e.length_in_breast_heights, 0.5, 1e-6);
  BOOST_CHECK_CLOSE(e.residual, 0.005 / spacing, 1e-3);
  BOOST_CHECK_CLOSE(e.mean_likeness, (8 * 6 - 22 * 1) / 30.0, 1e-6); // scores are limited to 6
  BOOST_CHECK_EQUAL(e.high_likeness, 9);
  BOOST_CHECK_EQUAL(e.parent_length, 0);
  BOOST_CHECK_EQUAL(e.carried, double(points.size()));
  BOOST_CHECK_GT(e.leaves, 0.15);
  BOOST_CHECK_LT(e.leaves, 0.35);
  BOOST_CHECK_SMALL(e.depth, 1e-6);
  BOOST_CHECK_GT(e.width, 0.02);
  BOOST_CHECK_LT(e.width, 0.05);
  BOOST_CHECK_GT(e.seen, 0.85);
  // without points
  BOOST_CHECK_CLOSE(found[1].parent_length, e.length, 1e-6);
  BOOST_CHECK_EQUAL(found[1].seen, 0);
  BOOST_CHECK(std::isfinite(wood_probability(found[1])));
  BOOST_CHECK(
      evidence_of_axes<Any_tag>(p.scan, Axis_set(), p.is_used, p.paths, wood_score, 1).empty());
}

BOOST_AUTO_TEST_CASE(axes_of_twigs_are_of_wood_and_stubs_in_leaves_are_not)
{
  std::mt19937 random(8);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  // A trunk, a twig on it, and a leaf on each side of the twig. The second leaf supports a twig.
  Points points = pipe(600, 0.05, 0.05);
  std::vector<std::size_t> first = {0, points.size()};
  const auto turned = [](const Vec3& p) { return Vec3(0.05 + p.z(), p.x(), 0.5 + p.y()); };
  Points twig;
  add_twig(twig, Vec3(0, 0, 0), 200, random);
  for (const Vec3& p : twig)
    points.push_back(turned(p));
  first.push_back(points.size());
  const Vec3 leaves[] = {Vec3(0.5, 0.03, 0.5), Vec3(0.7, -0.03, 0.5)};
  for (const Vec3& middle : leaves) {
    for (int i = 0; i < 40; ++i)
      points.push_back(middle + 0.05 * Vec3(share(random), share(random), 0));
    first.push_back(points.size());
  }
  for (const Vec3& p : twig)
    points.push_back(Vec3(0.7, -0.055 - p.z(), 0.5) + Vec3(p.x(), 0, p.y()));
  first.push_back(points.size());
  const Prepared p(points, 0);
  const double unit = p.scan.frame.unit;
  const auto axis_from = [&](const Vec3& from, const Vec3& to, double radius, Index parent) {
    return Fitted_axis{pcs_test::straight_axis(p.scan.frame.to_local(from),
                                               p.scan.frame.to_local(to),
                                               20,
                                               radius / unit,
                                               radius / unit),
                       parent,
                       40,
                       1};
  };
  Axis_set set;
  set.axes = {axis_from(Vec3(0, 0, 0), Vec3(0, 0, 1), 0.05, none),
              axis_from(Vec3(0.05, 0, 0.5), Vec3(1.05, 0, 0.5), 0.004, 0),
              axis_from(Vec3(0.5, 0.01, 0.5), Vec3(0.5, 0.05, 0.5), 0.012, 1),
              axis_from(Vec3(0.7, -0.01, 0.5), Vec3(0.7, -0.05, 0.5), 0.012, 1),
              axis_from(Vec3(0.7, -0.055, 0.5), Vec3(0.7, -1.055, 0.5), 0.004, 3)};
  set.axis_of_point.resize(p.scan.size());
  set.segment_of_point.resize(p.scan.size());
  std::vector<float> wood_score(p.scan.size());
  for (std::size_t a = 0; a < set.axes.size(); ++a)
    for (std::size_t q = first[a]; q < first[a + 1]; ++q) {
      const Index i = p.scan.point_of_input[q];
      set.axis_of_point[i] = static_cast<Index>(a);
      set.segment_of_point[i] = nearest_place(set.axes[a].axis, p.scan.points[i]).segment;
      wood_score[i] = a == 0 ? 3 : 0; // unknown, except for the trunk
    }
  const auto evidence =
      evidence_of_axes<Any_tag>(p.scan, set, p.is_used, p.paths, wood_score, 1.3 / unit);
  const double least = Leaf_options().axis_likeness;
  const bool expected[] = {true, true, false, false, true};
  for (std::size_t a = 0; a < set.axes.size(); ++a)
    BOOST_CHECK_EQUAL(wood_probability(evidence[a]) >= least, expected[a]);
  const auto wood_at = [&](double limit, double limit_of_point) {
    return wood_of_scored_axes<CGAL::Sequential_tag>(p.scan,
                                                     set,
                                                     p.is_used,
                                                     p.paths,
                                                     wood_score,
                                                     1.3 / unit,
                                                     limit,
                                                     limit_of_point);
  };
  const double infinity = std::numeric_limits<double>::infinity();
  // The second leaf supports a twig.
  const Flags found = wood_at(least, infinity);
  for (std::size_t i = 0; i < p.scan.size(); ++i)
    BOOST_CHECK_EQUAL(found[i] != 0, set.axis_of_point[i] != 2);
  // The first axis is always wood.
  const Flags one = wood_at(1e9, infinity);
  for (std::size_t i = 0; i < p.scan.size(); ++i)
    BOOST_CHECK_EQUAL(one[i] != 0, set.axis_of_point[i] == 0);
  // Points that no axis explains are classified by their own evidence.
  for (std::size_t i = 0; i < p.scan.size(); ++i)
    if (set.axis_of_point[i] == 0) {
      set.axis_of_point[i] = none;
      wood_score[i] = i % 2 == 0 ? 1.0f : 0.9f;
    }
  const Flags points_too = wood_at(-1e9, 1), points_not = wood_at(-1e9, infinity);
  for (std::size_t i = 0; i < p.scan.size(); ++i) {
    const bool has_axis = set.axis_of_point[i] != none;
    BOOST_CHECK_EQUAL(points_too[i] != 0, has_axis || i % 2 == 0);
    BOOST_CHECK_EQUAL(points_not[i] != 0, has_axis);
  }
}

BOOST_AUTO_TEST_CASE(nothing_strays_beside_the_trunk)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> share(-1, 1);
  Points points;
  for (int i = 0; i < 500; ++i)
    points.push_back(pcs_test::drawn<Vec3>([&] { return share(random); }));
  const Prepared p(points, 0);
  const double unit = p.scan.frame.unit;
  const Axis axis = pcs_test::straight_axis(p.scan.frame.to_local(Vec3(0, 0, -1)),
                                            p.scan.frame.to_local(Vec3(0, 0, 1)),
                                            400,
                                            0.3 / unit,
                                            0.1 / unit);
  Flags is_used(p.scan.size(), 1), is_wood(p.scan.size());
  const Index unused = 3, already = 5;
  is_used[unused] = 0;
  is_wood[already] = 1;
  keep_around<Any_tag>(p.scan, axis, 2.5, is_used, is_wood);
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Index i = p.scan.point_of_input[q];
    const Vec3& x = points[q];
    const double radius = 0.2 - 0.1 * x.z(), reach = x.head<2>().norm() / radius;
    if (i == unused || i == already)
      BOOST_CHECK_EQUAL(is_wood[i] != 0, i == already);
    else if (std::abs(reach - 2.5) > 0.2)
      BOOST_CHECK_EQUAL(is_wood[i] != 0, reach < 2.5);
  }
}

BOOST_AUTO_TEST_CASE(thick_wood_is_hollow)
{
  const std::size_t count = 3000;
  for (const bool is_hollow : {true, false}) {
    const Points points = pipe(count, is_hollow ? 0.1 : 0, 0.1);
    const Prepared p(points, count);
    const double unit = p.scan.frame.unit;
    const Axis_set set = one_axis(p.scan, 0.1 / unit, double(count) / 0.628 * unit * unit);
    const double share =
        p.shares(points_on_hollow_sections<CGAL::Sequential_tag>(p.scan, set, {})).first;
    BOOST_CHECK_EQUAL(share, is_hollow ? 1.0 : 0.0);
  }
}

BOOST_AUTO_TEST_CASE(leaves_are_left_out_only_where_there_are_many)
{
  std::mt19937 random(2);
  Points points = pipe(600, 0.1, 0.1); // 2 m beside the others
  for (Vec3& p : points)
    p.x() += 2;
  const std::size_t trunk = points.size();
  for (int k = 0; k < 6; ++k)
    add_twig(points, Vec3(0.15 * k - 0.4, 0.1 * k - 0.2, 0), 100, random);
  const std::size_t wood = points.size();
  const auto find = [&](const Prepared& p, const Axis_set& set, bool is_sure) {
    return classify_wood_points<CGAL::Sequential_tag>(p.scan, set, p.is_used, p.paths, is_sure, {});
  };
  const auto axes_of = [&](const Prepared& p) {
    const double unit = p.scan.frame.unit;
    Axis_set set = one_axis(p.scan, 0.1 / unit, double(trunk) / 0.628 * unit * unit, 2);
    for (std::size_t i = trunk; i < points.size(); ++i)
      set.axis_of_point[p.scan.point_of_input[i]] = none;
    return set;
  };
  const Prepared bare(points, wood);
  const Found_wood of_bare = find(bare, axes_of(bare), false);
  BOOST_CHECK(of_bare.is_wood.empty());
  // The appearance of points is still classified.
  BOOST_REQUIRE_EQUAL(of_bare.wood_score.size(), bare.scan.size());
  Flags looks_like_wood(bare.scan.size());
  for (std::size_t i = 0; i < bare.scan.size(); ++i)
    looks_like_wood[i] = of_bare.wood_score[i] > 0;
  BOOST_CHECK_GT(bare.shares(looks_like_wood).first, 0.9);
  BOOST_CHECK_GT(bare.shares(find(bare, axes_of(bare), true).is_wood).first, 0.9);
  add_leaves(points, 120, random);
  const Prepared leafy(points, wood);
  const Flags found = find(leafy, axes_of(leafy), false).is_wood;
  BOOST_REQUIRE(!found.empty());
  BOOST_CHECK_GT(leafy.shares(found).first, 2 * leafy.shares(found).second);
  // Without a stem it is not a tree.
  BOOST_CHECK(find(leafy, leafy.set, false).is_wood.empty());
  BOOST_CHECK(find(leafy, leafy.set, false).wood_score.empty());
  // Nothing is searched if axes explain all points.
  Axis_set all = axes_of(leafy);
  all.axis_of_point.assign(leafy.scan.size(), 0);
  BOOST_CHECK(find(leafy, all, false).is_wood.empty());
  BOOST_CHECK(find(leafy, all, false).wood_score.empty());
}

BOOST_AUTO_TEST_CASE(a_crown_is_noticed_beside_a_stem_that_most_points_lie_on)
{
  std::mt19937 random(4);
  std::normal_distribution<double> place(0, 0.15);
  Points points = pipe(5000, 0.1, 0.1);
  const std::size_t trunk = points.size();
  const auto find = [&](std::size_t crown) {
    Points all = points;
    for (std::size_t k = 0; k < crown; ++k) // a cloud without lines or patches
      all.emplace_back(1 + place(random), place(random), 0.5 + place(random));
    const Prepared p(all, trunk);
    const double unit = p.scan.frame.unit;
    Axis_set set = one_axis(p.scan, 0.1 / unit, double(trunk) / 0.628 * unit * unit);
    for (std::size_t i = trunk; i < all.size(); ++i)
      set.axis_of_point[p.scan.point_of_input[i]] = none;
    return classify_wood_points<CGAL::Sequential_tag>(p.scan, set, p.is_used, p.paths, false, {})
        .is_wood;
  };
  BOOST_CHECK(!find(2500).empty());
  BOOST_CHECK(find(400).empty());
}

BOOST_AUTO_TEST_CASE(a_few_leaves_are_noticed_on_much_wood)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  Points points = pipe(1500, 0.1, 0.1);
  const std::size_t trunk = points.size();
  for (int k = 0; k < 6; ++k)
    add_twig(points, Vec3(0.2 * k + 1, 0.1 * k, 0), 100, random);
  const std::size_t wood = points.size();
  for (const bool is_flat : {true, false}) {
    points.resize(wood);
    for (int k = 0; k < 6; ++k) // one on each twig, or the same number of pieces of bark
      for (int i = 0; i < 30; ++i) {
        const double x = 0.06 * share(random), z = 0.06 * share(random);
        points.push_back(
            Vec3(0.2 * k + 1.04 + x, 0.1 * k + (is_flat ? 0 : share(random) * 0.06), 0.5 + z));
      }
    const Prepared p(points, wood);
    const double unit = p.scan.frame.unit;
    Axis_set set = one_axis(p.scan, 0.1 / unit, double(trunk) / 0.628 * unit * unit);
    for (std::size_t i = trunk; i < points.size(); ++i)
      set.axis_of_point[p.scan.point_of_input[i]] = none;
    const Flags found =
        classify_wood_points<CGAL::Sequential_tag>(p.scan, set, p.is_used, p.paths, false, {})
            .is_wood;
    BOOST_CHECK_EQUAL(found.empty(), !is_flat);
  }
}

BOOST_AUTO_TEST_CASE(points_of_surfaces_have_dimension_two_and_rows_one)
{
  const auto dimension_of = [](const Points& points) {
    const Prepared p(points, 0);
    return sampling_dimension(p.scan, p.is_used);
  };
  const Points even = pipe(3000, 0.1, 0.1);
  BOOST_CHECK_CLOSE(dimension_of(even), 2.0, 5.0);
  BOOST_CHECK_GT(dimension_of(pipe(3000, 0, 0.1)), 2.5);
  BOOST_CHECK_CLOSE(dimension_of(in_rings(even, 0.2, 0)), 1.0, 5.0);
  // Rings as wide as their gaps have the dimension of surfaces.
  BOOST_CHECK_GT(dimension_of(in_rings(pipe(30000, 0.1, 0.1), 0.1, 0.05)), 1.9);
  // Each component alone, and an empty selection.
  Points both = even;
  for (const Vec3& p : in_rings(even, 0.2, 0))
    both.push_back(p + Vec3(1, 0, 0));
  const Prepared p(both, even.size());
  BOOST_CHECK_CLOSE(sampling_dimension(p.scan, p.is_twig), 2.0, 5.0);
  BOOST_CHECK(std::isinf(sampling_dimension(p.scan, Flags(p.scan.size(), 0))));
}

BOOST_AUTO_TEST_CASE(in_rows_leaves_are_not_told_from_wood)
{
  std::mt19937 random(6);
  const Points surface = pipe(3000, 0.1, 0.1);
  for (const bool is_in_rows : {false, true}) {
    Points points = is_in_rows ? in_rings(surface, 0.1, 0) : surface;
    const std::size_t trunk = points.size();
    add_leaves(points, 120, random);
    for (std::size_t i = trunk; i < points.size(); ++i)
      points[i].x() += 2;
    const Prepared p(points, trunk);
    const double unit = p.scan.frame.unit;
    Axis_set set = one_axis(p.scan, 0.1 / unit, double(trunk) / 0.628 * unit * unit);
    for (std::size_t i = trunk; i < points.size(); ++i)
      set.axis_of_point[p.scan.point_of_input[i]] = none;
    const auto find = [&](bool is_sure) {
      return classify_wood_points<CGAL::Sequential_tag>(p.scan,
                                                        set,
                                                        p.is_used,
                                                        p.paths,
                                                        is_sure,
                                                        {});
    };
    BOOST_CHECK_EQUAL(find(false).is_in_rows, is_in_rows);
    BOOST_CHECK_EQUAL(find(false).is_wood.empty(), is_in_rows);
    // The option of the caller takes precedence.
    BOOST_CHECK(!find(true).is_in_rows);
    BOOST_CHECK(!find(true).is_wood.empty());
  }
}

BOOST_AUTO_TEST_CASE(patches_are_flat_and_wide_and_away_from_thick_wood)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> share(0, 1);
  const auto count_in = [&](double width, double depth, bool is_on_wood) {
    Points points;
    for (int i = 0; i < 40; ++i)
      points.emplace_back(0.1 * share(random), width * share(random), depth * share(random));
    const Prepared p(points, 0);
    Flags is_open(p.scan.size(), 1), is_thick(p.scan.size(), 0);
    if (is_on_wood) {
      is_open[0] = 0;
      is_thick[0] = 1;
    }
    Planar_patch_options rules;
    rules.link = 8;
    return count_patch_points(p.scan, is_open, is_thick, rules);
  };
  BOOST_CHECK_EQUAL(count_in(0.1, 0.005, false), 40);
  BOOST_CHECK_EQUAL(count_in(0.1, 0.005, true), 0);
  BOOST_CHECK_EQUAL(count_in(0.1, 0.1, false), 0);     // a lump
  BOOST_CHECK_EQUAL(count_in(0.005, 0.005, false), 0); // a twig
}

BOOST_AUTO_TEST_CASE(leaves_on_a_surface_are_no_leaves)
{
  Points points = pipe(3000, 0.1, 0.1);
  const std::size_t wood = points.size();
  for (const Vec3& p : pipe(300, 0.3, 0.3))
    points.push_back(p);
  const Prepared p(points, wood);
  Axis_set set = one_axis(p.scan, 0.1 / p.scan.frame.unit, 1);
  Flags is_leaf(p.scan.size(), 0);
  std::size_t count = 0; // a tenth of the surface, and all points far from it
  for (std::size_t i = 0; i < p.scan.size(); ++i) {
    is_leaf[i] = !p.is_twig[i] || i % 10 == 0;
    count += p.is_twig[i] && i % 10 == 0;
    if (is_leaf[i])
      set.axis_of_point[i] = none;
  }
  BOOST_CHECK_EQUAL(reassign_points<CGAL::Sequential_tag>(p.scan, {}, is_leaf, set), count);
  const auto [surface, away] = p.shares(is_leaf);
  BOOST_CHECK_EQUAL(surface, 0.0);
  BOOST_CHECK_EQUAL(away, 1.0);
  for (std::size_t i = 0; i < p.scan.size(); ++i)
    BOOST_CHECK_EQUAL(set.is_covered(static_cast<Index>(i)), p.is_twig[i] != 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_find_leaves

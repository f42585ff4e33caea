// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trunks that are not cylindrical: buttresses at the foot, whorls of limbs. Nearly equal clouds
// result in nearly equal trunks.

#include <pcs/extract_tree_skeleton.h>
#include <pcs/skeleton/branching/root_axis.h>
#include <pcs/skeleton/radii/bound_radii.h>
#include <pcs/skeleton/radii/rebuild_trunk_base.h>
#include <support/axes.h>
#include <support/tree_clouds.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

namespace test_trunk_foot {

using pcs_test::append;
using pcs_test::check_is_a_tree;
using pcs_test::cylinder;
using pcs_test::Jitter;
using pcs_test::Tree;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using Cloud = std::vector<Point>;

namespace {

constexpr double pi = 3.14159265358979323846;

/// A tapered trunk with buttresses below `top`.
struct Buttressed_trunk
{
  double height = 14, radius = 0.3, top = 2.6, reach = 0.7;
  std::vector<double> walls{0.3, 1.5, 2.5, 4.1, 5.2}; ///< directions [rad]

  double distance(double z, double angle) const
  {
    const double round = radius * (1 - 0.8 * z / height);
    const double share = std::max(0.0, 1 - z / top);
    double wall = 0;
    for (const double w : walls) {
      const double turn = std::remainder(angle - w, 2 * pi);
      wall += std::exp(-0.5 * turn * turn / (0.13 * 0.13));
    }
    return round * (1 - 0.25 * share) + reach * share * share * wall;
  }
  double equal_area_diameter(double z) const
  {
    constexpr int n = 3600;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      sum += std::pow(distance(z, 2 * pi * i / n), 2) / n;
    return 2 * std::sqrt(sum);
  }

  double volume() const
  {
    constexpr int n = 700;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      sum += 0.25 * pi * std::pow(equal_area_diameter(height * (i + 0.5) / n), 2) * height / n;
    return sum;
  }

  /// Points with a spacing of about `step`.
  Cloud points(double step, double noise) const
  {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> shift(0, step);
    Cloud cloud;
    for (double z = 0; z < height; z += step) {
      double gone = shift(random);
      constexpr int n = 4000;
      Point before(distance(z, 0), 0, z);
      for (int i = 1; i <= n; ++i) {
        const double angle = 2 * pi * i / n, r = distance(z, angle);
        const Point p(r * std::cos(angle), r * std::sin(angle), z);
        gone += std::sqrt((p - before).squared_length());
        before = p;
        if (gone < step)
          continue;
        gone -= step;
        cloud.push_back(p + Vector(0, 0, shift(random)));
      }
    }
    return Jitter(noise)(std::move(cloud));
  }
};

/// Tubes that rise from the axis of a trunk, sampled outside of it.
void add_limbs(int count,
               double z,
               double inner,
               double radius,
               double length,
               double density,
               double rise,
               Cloud& cloud)
{
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * pi * (i + 0.15 * (i % 3)) / count;
    const Vector along(std::cos(angle), std::sin(angle), rise);
    const Point base = Point(0, 0, z) + inner * Vector(along.x(), along.y(), 0);
    const double n = 2 * pi * radius * length * density;
    append(cloud, cylinder(static_cast<std::size_t>(n), radius, length, base, along));
  }
}

struct Trunk
{
  double dbh = 0, volume = 0, top = 0;
};

Trunk trunk_of(const Cloud& cloud)
{
  Tree tree;
  const pcs::Skeleton_report report = pcs::extract_tree_skeleton(cloud, tree);
  check_is_a_tree(tree);
  Trunk trunk;
  trunk.dbh = report.diameter_at_breast_height;
  trunk.volume = report.by_order.front().volume;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (tree[v].branch == 0)
      trunk.top = std::max(trunk.top, tree[v].point.z());
  return trunk;
}

/// The trunks of a cloud and of copies that differ by a hundredth of a millimetre.
std::vector<Trunk> trunks_of_copies(const Cloud& cloud, unsigned copies)
{
  std::vector<Trunk> trunks{trunk_of(cloud)};
  for (unsigned c = 1; c <= copies; ++c)
    trunks.push_back(trunk_of(Jitter(1e-5, c)(cloud)));
  return trunks;
}

/// One upward branch of `n` measured nodes.
template <class Radius, class Error>
pcs::skeleton::Branch_tree
standing_branch(pcs::skeleton::Index n, double step, const Radius& radius_at, const Error& error_at)
{
  using namespace pcs::skeleton;
  Branch_tree tree;
  tree.branches.emplace_back();
  for (Index k = 0; k < n; ++k) {
    Branch_node node;
    node.point = step * double(k) * Vec3::UnitZ();
    node.radius = radius_at(k);
    node.radius_error = error_at(k);
    node.is_measured = true;
    node.parent = k > 0 ? k - 1 : none;
    node.branch = 0;
    tree.nodes.push_back(node);
    tree.branches[0].nodes.push_back(k);
  }
  return tree;
}

} // namespace

BOOST_AUTO_TEST_SUITE(trunk_base)

// Spurious pieces of a foot contain all root points.
BOOST_AUTO_TEST_CASE(the_root_is_of_the_trunk_and_not_of_a_piece_beside_it)
{
  using namespace pcs::skeleton;
  Axis_set set = pcs_test::set_of(
      {pcs_test::straight_axis(Vec3(0, 0, 0.5), Vec3(0, 0, 8), 400, 0.2, 0.1),
       pcs_test::straight_axis(Vec3(-0.3, 0, 0), Vec3(0.3, 0, 0.4), 10, 0.05, 0.05)});
  Scan scan;
  for (Index i = 0; i < set.axis_of_point.size(); ++i)
    scan.points.push_back(set.axes[set.axis_of_point[i]].axis[set.segment_of_point[i]].point);
  const std::vector<Index> root = {400, 401, 402};
  BOOST_CHECK_EQUAL(root_axis(scan, set, root, std::nullopt), 0u);
  BOOST_CHECK_EQUAL(root_axis(scan, set, root, Vec3(0, 0, 0.5)), 0u);
  BOOST_CHECK_EQUAL(root_axis(scan, set, root, Vec3(-1.5, 0, 0)), 1u); // beside the trunk
  for (Axis_node& node : set.axes[0].axis)
    node.point.x() += 2; // another tree
  BOOST_CHECK_EQUAL(root_axis(scan, set, root, std::nullopt), 1u);
}

// Fits of a shaded lower stem are kept if the trunk bends above it.
BOOST_AUTO_TEST_CASE(a_bent_trunk_with_few_points_below_keeps_its_base)
{
  constexpr double radius = 0.056, bend = 1;
  const auto count = [](double length, double density) {
    return static_cast<std::size_t>(2 * pi * radius * length * density);
  };
  Cloud cloud = cylinder(count(bend, 700), radius, bend);
  append(cloud, cylinder(count(5, 4000), radius, 5, Point(0, 0, bend), Vector(-0.15, 0.05, 1)));
  Tree tree;
  pcs::extract_tree_skeleton(Jitter(0.002)(cloud), tree);
  check_is_a_tree(tree);
  int number_below = 0;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (tree[v].branch == 0 && tree[v].point.z() < 0.9 * bend) {
      ++number_below;
      BOOST_TEST(std::hypot(tree[v].point.x(), tree[v].point.y()) < 0.3 * radius);
    }
  BOOST_TEST(number_below > 5);
}

BOOST_AUTO_TEST_CASE(buttresses_do_not_hide_the_trunk)
{
  const Buttressed_trunk shape;
  Cloud cloud = shape.points(0.022, 0.004);
  add_limbs(4, 9, 0.12, 0.05, 2.5, 2000, 0.8, cloud);
  const double expected = shape.equal_area_diameter(1.3), volume = shape.volume();
  for (const Trunk& trunk : trunks_of_copies(cloud, 4)) {
    BOOST_TEST(std::abs(trunk.dbh - expected) < 0.12 * expected);
    BOOST_TEST(std::abs(trunk.volume - volume) < 0.1 * volume);
    BOOST_TEST(trunk.top > 0.9 * shape.height);
  }
}

BOOST_AUTO_TEST_CASE(a_trunk_goes_on_above_a_whorl)
{
  const double radius = 0.05, height = 4;
  Cloud cloud = cylinder(30000, radius, height);
  add_limbs(7, 0.8, 0.7 * radius, 0.4 * radius, 0.8, 24000, 0.9, cloud);
  add_limbs(7, 0.95, 0.7 * radius, 0.4 * radius, 0.8, 24000, 0.9, cloud);
  for (const Trunk& trunk : trunks_of_copies(Jitter(0.001)(cloud), 3)) {
    BOOST_TEST(std::abs(trunk.dbh - 2 * radius) < 0.04 * radius);
    BOOST_TEST(trunk.top > 0.95 * height);
  }
}

BOOST_AUTO_TEST_CASE(a_filled_foot_does_not_bound_what_is_proven_above)
{
  using namespace pcs::skeleton;
  constexpr double step = 0.1, radius = 0.1, density = 1000;
  const auto bounded = [&](Index end_of_filling, double error) { // behind a thin base
    Branch_tree tree = standing_branch(
        60,
        step,
        [&](Index k) { return k < 4 ? 0.3 * radius : radius; },
        [&](Index k) { return (k < 4 ? 0.01 : error) * radius; });
    Section_support support(tree);
    for (Index k = 0; k < 60; ++k) {
      support.on[k] = 2 * pi * radius * step * density;
      support.inside[k] = k >= 4 && k < end_of_filling ? support.on[k] : 0;
    }
    Scan scan;
    scan.spacing = 0.1 * radius;
    Support_options rules;
    rules.pipes.slack = 0; // without this limit
    bound_radii(scan, support, density, rules, tree);
    return tree;
  };
  const Branch_tree foot = bounded(12, 0.01), bush = bounded(60, 0.01);
  for (Index k = 4; k < 60; ++k) {
    BOOST_TEST(foot.nodes[k].radius == radius);
    BOOST_TEST(bush.nodes[k].radius < 0.5 * radius);
  }
  // Few thin sections do not bound a hollow trunk without proven sections.
  const Branch_tree hollow = bounded(0, 0.2);
  for (Index k = 4; k < 60; ++k)
    BOOST_TEST(hollow.nodes[k].radius == radius);
}

BOOST_AUTO_TEST_CASE(half_a_trunk_that_is_hidden_is_proven_by_precise_radii)
{
  using namespace pcs::skeleton;
  constexpr double step = 0.1, radius = 0.1, density = 1000;
  // Radius of a limb behind a thin piece of a trunk, with a third of the points.
  const auto limb_radius = [&](double trunk, double error) {
    const auto radius_at = [&](Index k) { return k < 20 ? trunk : k < 40 ? 0.1 * radius : radius; };
    Branch_tree tree = standing_branch(60, step, radius_at, [&](Index k) {
      return (k < 40 ? 0.01 : error) * radius_at(k);
    });
    Section_support support(tree);
    for (Index k = 0; k < 60; ++k)
      support.on[k] = 2 * pi * tree.nodes[k].radius * step * density / (k < 40 ? 1 : 3);
    Scan scan;
    scan.spacing = 0.1 * radius;
    Support_options rules;
    rules.pipes.slack = 0;
    bound_radii(scan, support, density, rules, tree);
    return tree.nodes.back().radius;
  };
  BOOST_TEST(limb_radius(1.2 * radius, 0.02) == radius);
  BOOST_TEST(limb_radius(1.2 * radius, 0.06) < 0.5 * radius);
  BOOST_TEST(limb_radius(0.5 * radius, 0.02) < 0.5 * radius); // no section below is as thick
}

BOOST_AUTO_TEST_CASE(an_outline_has_the_area_of_its_circle)
{
  pcs::skeleton::internal::Outline outline;
  for (int i = 0; i < 700; ++i) { // a quarter is occluded
    const double angle = 1.5 * pi * i / 700;
    outline.add(2 * std::cos(angle), 2 * std::sin(angle));
  }
  BOOST_TEST(outline.number_of_seen_sectors() == 18);
  BOOST_TEST(std::abs(outline.radius() - 2) < 1e-9);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_trunk_foot

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Chains beside a fitted axis: unexplained points along a trunk are not a second trunk.

#include <pcs/skeleton/axes/fit_axes.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace test_fit_axes {

using namespace pcs::skeleton;
using pcs::skeleton::internal::open_stretches;

namespace {

constexpr double pi = 3.14159265358979323846, spacing = 0.01, radius = 0.1;
constexpr Index number_of_layers = 60, layers_between_limbs = 12;

/// Prepares a scan of points with the nodes given by `tree` in input order, and completes `tree`.
void scan_of(const std::vector<Vec3>& points, Scan& scan, Layer_tree& tree)
{
  prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
  std::vector<Index> node(scan.size()); // the scan has its own order
  for (std::size_t i = 0; i < points.size(); ++i)
    node[scan.point_of_input[i]] = tree.node_of_point[i];
  tree.node_of_point = std::move(node);
  tree.next_in_ring.assign(tree.size(), none);
  internal::collect_nodes<CGAL::Sequential_tag>(scan, tree);
}

/// A trunk in level sets of two arcs each, as a result of paths on both sides, with limbs at the
/// smaller arc.
struct Two_arcs
{
  Scan scan;
  Layer_tree tree;

  Two_arcs()
  {
    const double thickness = layer_thickness * spacing;
    std::vector<Vec3> points;
    for (Index layer = 0; layer < number_of_layers; ++layer) {
      for (const Index arc : {0u, 1u}) {
        tree.parent.push_back(layer > 0 ? 2 * (layer - 1) + arc : arc == 0 ? none : 0);
        const double from = arc == 0 ? 0 : 4.2, to = arc == 0 ? 4.2 : 2 * pi;
        for (double z = thickness * layer + spacing / 2; z < thickness * (layer + 1); z += spacing)
          for (double a = from; a < to; a += spacing / radius)
            add(points, Vec3(radius * std::cos(a), radius * std::sin(a), z));
      }
      if (layer % layers_between_limbs == layers_between_limbs - 1)
        add_limb(points, thickness * (layer + 0.5), (layer / layers_between_limbs) % 2 ? 4.6 : 5.8);
    }
    scan_of(points, scan, tree);
  }

private:
  /// Adds a point to the last node.
  void add(std::vector<Vec3>& points, const Vec3& p)
  {
    points.push_back(p);
    tree.node_of_point.push_back(static_cast<Index>(tree.parent.size() - 1));
  }

  void add_limb(std::vector<Vec3>& points, double z, double angle)
  {
    constexpr double thin = 0.015, length = 0.1;
    const Vec3 out(std::cos(angle), std::sin(angle), 0), side(-out.y(), out.x(), 0);
    for (double x = 1.2 * radius; x < radius + length; x += spacing)
      for (double a = 0; a < 2 * pi; a += spacing / thin)
        add(points,
            x * out + thin * (std::cos(a) * side + std::sin(a) * Vec3::UnitZ()) +
                z * Vec3::UnitZ());
  }
};

/// Tubes with known level sets.
class Layered_tubes
{
public:
  /// Adds an arc of a tube from angle `a0` to `a1`, with its level sets above `below`. Returns the
  /// last of these.
  Index add(Index below, const Vec3& base, const Vec3& step, double r, double a0, double a1)
  {
    const double length = step.norm(), thickness = layer_thickness * spacing;
    const Vec3 along = step / length, e1 = along.unitOrthogonal(), e2 = along.cross(e1);
    for (int layer = 0; layer < int(length / thickness); ++layer) {
      m_tree.parent.push_back(below);
      below = static_cast<Index>(m_tree.parent.size() - 1);
      for (double z = thickness * layer + spacing / 2; z < thickness * (layer + 1); z += spacing)
        for (double a = a0; a < a1; a += spacing / r) {
          const double rough =
              r + m_noise * std::sin(37.0 * double(m_points.size())) * std::sqrt(2.0);
          m_points.push_back(base + z * along + rough * (std::cos(a) * e1 + std::sin(a) * e2));
          m_tree.node_of_point.push_back(below);
        }
    }
    return below;
  }
  /// Prepares the scan of the added points, and moves their level sets to `tree`.
  void finish(Scan& scan, Layer_tree& tree)
  {
    tree = std::move(m_tree);
    scan_of(m_points, scan, tree);
  }
  /// Sets the standard deviation of the distances from the axes of points added later [L].
  void set_noise(double noise) { m_noise = noise; }

private:
  std::vector<Vec3> m_points;
  Layer_tree m_tree;
  double m_noise = 0;
};

Axis_set
axes_of(const Scan& scan, const Layer_tree& tree, const Axis_options& rules = Axis_options())
{
  return fit_axes<CGAL::Sequential_tag>(scan, tree, rules, [](double) { return true; });
}

} // namespace

BOOST_AUTO_TEST_SUITE(axes_of_chains)

// Paths run along two sides of a limb, each into a separate twig. Both chains are fitted
// independently.
BOOST_AUTO_TEST_CASE(two_chains_of_one_wave_do_not_keep_the_same_wood)
{
  Layered_tubes tubes;
  const Index foot = tubes.add(none, Vec3::Zero(), Vec3(0, 0, 1), radius, 0, 2 * pi);
  tubes.add(foot, Vec3(0, 0, 1), Vec3(0, 0, 1), radius, 0, 2 * pi);
  constexpr double limb = 0.4, twig = 0.5;
  const Vec3 seat(1.1 * radius, 0, 1), fork(1.1 * radius + limb, 0, 1);
  const Index left = tubes.add(foot, seat, Vec3(limb, 0, 0), 0.04, 0, pi);
  const Index right = tubes.add(foot, seat, Vec3(limb, 0, 0), 0.04, pi, 2 * pi);
  tubes.add(left, fork + Vec3(0, 0.03, 0), twig * Vec3(0.8, 0.6, 0), 0.02, 0, 2 * pi);
  tubes.add(right, fork - Vec3(0, 0.03, 0), 0.95 * twig * Vec3(0.8, -0.6, 0), 0.02, 0, 2 * pi);
  Scan scan;
  Layer_tree tree;
  tubes.finish(scan, tree);
  const Axis_set set = axes_of(scan, tree);
  double length = 0;
  for (std::size_t a = 1; a < set.axes.size(); ++a)
    length += length_of(set.axes[a].axis) * scan.frame.unit;
  BOOST_TEST(set.axes.size() == 3u);
  BOOST_TEST(std::abs(length - (limb + 1.95 * twig)) < 0.1);
  Axis_options keeping;
  keeping.most_lost = 1;
  double kept = 0;
  const Axis_set doubled = axes_of(scan, tree, keeping);
  for (std::size_t a = 1; a < doubled.axes.size(); ++a)
    kept += length_of(doubled.axes[a].axis) * scan.frame.unit;
  BOOST_TEST_MESSAGE("length " << length << " of " << limb + 1.95 * twig << ", kept " << kept);
  BOOST_TEST(kept > length + 0.5 * limb);
}

// The initial estimate of the noise is 0.3 spacings.
BOOST_AUTO_TEST_CASE(the_first_axis_is_fitted_with_the_noise_that_it_shows)
{
  constexpr double thin = 0.9 * spacing;
  Layered_tubes tubes;
  tubes.set_noise(0.05 * spacing);
  tubes.add(none, Vec3::Zero(), Vec3(0, 0, 2), thin, 0, 1.2 * pi);
  Scan scan;
  Layer_tree tree;
  tubes.finish(scan, tree);
  const auto error = [&](double first_guess) {
    Axis_options rules;
    rules.first_guess = first_guess;
    const Axis_set set = axes_of(scan, tree, rules);
    BOOST_REQUIRE(!set.axes.empty());
    const Axis& axis = set.axes.front().axis;
    double sum = 0;
    for (const Axis_node& node : axis)
      sum += std::abs(node.radius * scan.frame.unit / thin - 1);
    BOOST_TEST_MESSAGE("noise " << set.noise / scan.spacing << " spacings, error "
                                << sum / double(axis.size()));
    return sum / double(axis.size());
  };
  BOOST_TEST(error(0.7) < 0.5 * error(0));
}

// A thick axis bends within a few of its radii, so the bound in spacings holds there.
BOOST_AUTO_TEST_CASE(distances_of_nodes_are_bounded_in_spacings)
{
  constexpr double thick = 2 * radius;
  const Chain_options rules;
  BOOST_REQUIRE(rules.node_spacing.factor * thick > 1.3 * rules.node_spacing.highest * spacing);
  Layered_tubes tubes;
  tubes.add(none, Vec3::Zero(), Vec3(0, 0, 1), thick, 0, 2 * pi);
  Scan scan;
  Layer_tree tree;
  tubes.finish(scan, tree);
  const Axis_set set = axes_of(scan, tree);
  BOOST_REQUIRE(set.axes.size() == 1u);
  const Axis& axis = set.axes.front().axis;
  BOOST_REQUIRE(axis.size() > 2u);
  const double mean = length_of(axis) / double(axis.size() - 1);
  BOOST_TEST_MESSAGE("mean distance " << mean / scan.spacing << " spacings");
  BOOST_TEST(mean < 1.1 * rules.node_spacing.highest * scan.spacing);
  BOOST_TEST(mean > 0.8 * rules.node_spacing.highest * scan.spacing);
}

BOOST_AUTO_TEST_CASE(limbs_on_an_arc_of_a_trunk_are_no_second_trunk)
{
  const Two_arcs shape;
  const Axis_set set =
      fit_axes<CGAL::Sequential_tag>(shape.scan, shape.tree, Axis_options(), [](double) {
        return true;
      });
  const double height = layer_thickness * spacing * number_of_layers / shape.scan.frame.unit;
  BOOST_REQUIRE(set.axes.size() == 1 + number_of_layers / layers_between_limbs);
  BOOST_TEST(length_of(set.axes.front().axis) > 0.9 * height);
  for (std::size_t a = 1; a < set.axes.size(); ++a)
    BOOST_TEST(length_of(set.axes[a].axis) < 0.1 * height);
}

// Paths over a scan cross from branch to branch where these touch.
BOOST_AUTO_TEST_CASE(a_chain_goes_straight_on_rather_than_to_the_longer_branch)
{
  Scan scan;
  scan.spacing = spacing;
  Layer_tree tree;
  const auto add = [&](Index parent, const Vec3& step) {
    tree.parent.push_back(parent);
    tree.center.push_back((parent == none ? Vec3(Vec3::Zero()) : tree.center[parent]) + step);
    return static_cast<Index>(tree.parent.size() - 1);
  };
  const auto add_row = [&](Index from, const Vec3& direction, int count) {
    for (int k = 0; k < count; ++k)
      from = add(from, layer_thickness * spacing * direction);
    return from;
  };
  const Index fork = add_row(none, Vec3::UnitZ(), 12);
  const Index crooked = add_row(fork, Vec3(0.8, 0, 0.6), 40);
  const Index straight = add_row(fork, Vec3::UnitZ(), 12);
  tree.spread.assign(tree.size(), spacing);
  tree.next_in_ring.assign(tree.size(), none);
  for (Index v = 0; v <= tree.size(); ++v) // one point each
    tree.first.push_back(v);
  const std::vector<Chain> chains = decompose_chains(scan, tree);
  BOOST_REQUIRE(chains.size() == 2u);
  BOOST_TEST(chains[0].nodes.front() == 0u);
  BOOST_TEST(chains[0].nodes.back() == straight);
  BOOST_TEST(chains[1].parent_node == fork);
  BOOST_TEST(chains[1].nodes.back() == crooked);
}

BOOST_AUTO_TEST_CASE(a_chain_is_left_where_most_points_of_its_layers_have_no_axis)
{
  const Two_arcs shape;
  Axis_set set;
  set.axis_of_point.assign(shape.scan.size(), none);
  const std::vector<Chain> chains = decompose_chains(shape.scan, shape.tree);
  BOOST_REQUIRE(chains.size() == 2u);
  const Chain& chain = chains.back();
  BOOST_REQUIRE(chain.nodes.size() == number_of_layers);
  const auto explain = [&](std::size_t layer, double share) {
    const Index v = chain.nodes[layer];
    for (Index k = 0; k < share * double(shape.tree.count(v)); ++k)
      set.axis_of_point[shape.tree.point[shape.tree.first[v] + k]] = 0;
  };
  const auto stretches = [&](std::size_t fewest) {
    return open_stretches(shape.tree, set, chain, fewest);
  };
  BOOST_TEST((stretches(1).size() == 1 && stretches(1).front().nodes == chain.nodes));
  BOOST_TEST(std::abs(stretches(1).front().length - chain.length) < 1e-9 * chain.length);
  explain(0, 0.4);
  for (const std::size_t layer : {2u, 3u, 20u})
    explain(layer, 0.6);
  const std::vector<Chain> found = stretches(1);
  BOOST_REQUIRE(found.size() == 3u);
  const std::size_t sizes[] = {2, 16, number_of_layers - 21};
  for (std::size_t k = 0; k < 3; ++k)
    BOOST_TEST(found[k].nodes.size() == sizes[k]);
  BOOST_TEST(found[0].parent_node == chain.parent_node);
  BOOST_TEST(found[1].parent_node == chain.nodes[3]);
  BOOST_TEST(found[2].parent_node == chain.nodes[20]);
  BOOST_TEST(stretches(3).size() == 2u);
}

// A scan has the surface of wood only, so a tube around a second one is no branch.
BOOST_AUTO_TEST_CASE(an_axis_that_encloses_other_wood_is_refused)
{
  for (const bool has_inner : {false, true}) {
    std::vector<Vec3> points;
    for (const double r : {radius, 0.5 * radius})
      if (r == radius || has_inner)
        for (double z = 0; z < 1; z += spacing)
          for (double a = 0; a < 2 * pi; a += spacing / r)
            points.emplace_back(r * std::cos(a), r * std::sin(a), z);
    Scan scan;
    prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
    Axis_set set;
    set.axis_of_point.assign(scan.size(), none);
    set.segment_of_point.assign(scan.size(), none);
    set.noise = 0.1 * scan.spacing;
    Candidate candidate;
    for (const double z : {0.0, 0.5, 1.0}) {
      Axis_node node;
      node.point = scan.frame.to_local(Vec3(0, 0, z));
      node.radius = radius / scan.frame.unit;
      candidate.axis.push_back(node);
    }
    for (Index i = 0; i < scan.size(); ++i) {
      candidate.points.push_back(i);
      candidate.segments.push_back(nearest_place(candidate.axis, scan.points[i]).segment);
    }
    candidate.number_of_own_points = scan.size();
    const double share = internal::enclosed_share(scan, Chain_options(), set.noise, candidate.axis);
    BOOST_TEST(std::abs(share - (has_inner ? 1.0 / 3 : 0)) < 0.02);
    const auto is_accepted = [&](bool is_first) {
      Axis_set trial = set;
      if (!is_first)
        trial.axes.emplace_back();
      Candidate copy = candidate;
      Noise_and_density_model statistics(set.noise);
      return internal::accept(scan, Chain_options(), copy, none, trial, statistics);
    };
    BOOST_TEST(is_accepted(true));
    BOOST_TEST(is_accepted(false) == !has_inner);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_axes

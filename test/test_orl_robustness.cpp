// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees and scans of degenerate shapes: long, wide, flat, without radii, coincident.

#include <pcs/orl_geodesic.h>
#include <support/archetypes.h>
#include <support/drawn.h>
#include <support/exceptions.h>
#include <support/graph_archetypes.h>
#include <support/orl_spaces.h>
#include <support/orl_trees.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_orl_robustness {

using namespace orl_test;
using pcs_test::message_has;

namespace {

std::size_t add_node(Tree& tree, std::size_t parent, const Vec3& p, double radius)
{
  pcs::Tree_node<Kernel> node;
  node.point = to_cgal(p);
  node.radius = radius;
  const std::size_t v = add_vertex(node, tree);
  if (parent != pcs::npos)
    add_edge(parent, v, tree);
  return v;
}

/// A trunk of `n` nodes, with a bend.
Tree path(std::size_t n, double bend)
{
  Tree tree;
  std::size_t last = pcs::npos;
  for (std::size_t k = 0; k < n; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(n - 1);
    last = add_node(tree, last, Vec3(bend * t * t, 0, 5 * t), 0.1);
  }
  return tree;
}

/// `n` branches at the middle of a trunk.
Tree star(std::size_t n, double turn)
{
  Tree tree = path(3, 0);
  for (std::size_t k = 0; k < n; ++k) {
    const double angle = 2.399963 * static_cast<double>(k) + turn;
    const double z = static_cast<double>(k) / static_cast<double>(n);
    const std::size_t v =
        add_node(tree, 1, Vec3(0.5 * std::cos(angle), 0.5 * std::sin(angle), 2.5 + z), 0.02);
    add_node(tree, v, Vec3(std::cos(angle), std::sin(angle), 2.5 + 2 * z), 0.01);
  }
  return tree;
}

/// A tube of six edges, each bent by `bend` relative to the previous one.
Tree bent_tube(double bend, double radius)
{
  Tree tree;
  Vec3 p = Vec3::Zero();
  std::size_t last = add_node(tree, pcs::npos, p, radius);
  for (int k = 0; k < 6; ++k) {
    p += Vec3(std::sin(bend * k), 0, std::cos(bend * k));
    last = add_node(tree, last, p, radius);
  }
  return tree;
}

/// A trunk with a side branch near its end; `rest` and `side` are the lengths beyond the fork.
Tree forked_end(double rest, double side)
{
  Tree tree = path(2, 0);
  const std::size_t fork = add_node(tree, 1, Vec3(0, 0, 10), 0.1);
  add_node(tree, fork, Vec3(0, 0, 10 + rest), 0.05);
  add_node(tree, fork, Vec3(side, 0, 10), 0.05);
  for (int k = 1; k < 4; ++k)
    add_node(tree, 1, Vec3(k == 1, k == 2, 5 + (k == 3)), 0.02);
  return tree;
}

/// Builds a space, and evaluates a few trees on the path.
pcs::Orl_report morph(const Tree& a,
                      const std::vector<Point>& scan_a,
                      const Tree& b,
                      const std::vector<Point>& scan_b)
{
  pcs::Orl_shape_space<Kernel> space;
  space.add(a, scan_a);
  space.add(b, scan_b);
  const auto report = space.build();
  BOOST_TEST((report.status == pcs::Status::converged));
  for (const double lambda : {-0.5, 0., 0.5, 1., 1.5}) {
    const auto tree = space.geodesic(0, 1, lambda);
    std::vector<Point> points;
    space.points(tree, points);
    bool is_finite = true;
    for (const Point& p : points)
      is_finite = is_finite && to_eigen(p).allFinite();
    Tree skeleton;
    space.skeleton(tree, skeleton);
    for (std::size_t v = 0; v < num_vertices(skeleton); ++v)
      is_finite = is_finite && to_eigen(skeleton[v].point).allFinite() &&
                  std::isfinite(skeleton[v].radius) && skeleton[v].radius >= 0;
    BOOST_TEST(is_finite);
    if (lambda == 0)
      BOOST_TEST(points.size() >= scan_a.size());
  }
  return report;
}

/// A branch that leaves the trunk horizontally and bends up at each of its edges. Its outer part
/// supports a twig.
Tree curled(double bend)
{
  Tree tree;
  const std::size_t root = add_node(tree, pcs::npos, Vec3(0, 0, 0), 0.2);
  const std::size_t fork = add_node(tree, root, Vec3(0, 0, 2), 0.2);
  add_node(tree, add_node(tree, fork, Vec3(0, 0, 6), 0.15), Vec3(0, 0.1, 12), 0.1);
  std::size_t last = fork;
  Vec3 p(0, 0, 2);
  for (int k = 0; k < 12; ++k) {
    p += 0.4 * Vec3(std::cos(bend * k), 0, std::sin(bend * k));
    last = add_node(tree, last, p, 0.05);
    if (k == 6)
      add_node(tree, last, p + Vec3(0, 0.8, 0), 0.03);
  }
  return tree;
}

/// A trunk, a branch, a twig and a twig of second order, each rotated by `turn` relative to its
/// parent about one axis.
Tree chained(double turn)
{
  Tree tree;
  Vec3 p(0, 0, 4);
  std::size_t fork = add_node(tree, add_node(tree, pcs::npos, Vec3(0, 0, 0), 0.2), p, 0.2);
  add_node(tree, add_node(tree, fork, Vec3(0, 0, 12), 0.15), Vec3(0, 0, 20), 0.1);
  double length = 6, angle = 0, side = 0.7;
  for (int level = 0; level < 3; ++level, length *= 0.6, side = -side) {
    angle += side + turn;
    const Vec3 along = length * Vec3(std::sin(angle), 0, std::cos(angle));
    fork = add_node(tree, fork, p + 0.3 * along, 0.05);
    add_node(tree, fork, p + along, 0.03);
    p += 0.3 * along;
  }
  return tree;
}

/// A stem without radii, and a blade that is rotated about its axis and lies beside it.
Tree with_blade(double turn, double width, double beside, unsigned seed, std::vector<Point>& scan)
{
  Tree tree;
  const std::size_t root = add_node(tree, pcs::npos, Vec3::Zero(), 0);
  const std::size_t fork = add_node(tree, root, Vec3(0, 0, 2), 0);
  add_node(tree, fork, Vec3(0, 0, 8), 0);
  add_node(tree, add_node(tree, fork, Vec3(2, 0, 2), 0), Vec3(4, 0, 2), 0);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 600; ++k) {
    const double z = 4 + 4 * uniform(random), angle = CGAL_PI * uniform(random);
    scan.emplace_back(0.05 * std::cos(angle), 0.05 * std::sin(angle), z);
  }
  const Vec3 along(0, std::cos(turn), std::sin(turn)), across(0, -std::sin(turn), std::cos(turn));
  for (int k = 0; k < 3000; ++k) {
    const Vec3 axis(2.6 + 1.4 * uniform(random), 0, 2); // far from the stem
    const double u = width * uniform(random), v = beside + 0.01 * uniform(random);
    scan.push_back(to_cgal(axis + u * along + v * across));
  }
  return tree;
}

/// A slightly leaning trunk, with another direction for each `seed` and a twig near its top. If
/// `is_folded`, it reverses by a twentieth of an edge after every fourth node.
Tree leaning(unsigned seed, bool is_folded)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.02);
  Tree tree;
  std::size_t last = add_node(tree, pcs::npos, Vec3::Zero(), 0.2);
  for (int k = 1; k <= 24; ++k) {
    const Vec3 p(noise(random), noise(random), 0.5 * k);
    last = add_node(tree, last, p, 0.2);
    if (k == 22)
      add_node(tree, last, p + Vec3(2, 0, 1), 0.05);
    if (is_folded && k % 4 == 0 && k < 24)
      last = add_node(tree, last, p + Vec3(0.2 * noise(random), 0.2 * noise(random), -0.025), 0.2);
  }
  return tree;
}

using pcs::shape_space::Orl_coordinates;
using pcs::shape_space::Orl_geometry;

Orl_geometry in_space(const Space& space, const Orl_coordinates& x)
{
  Orl_geometry result;
  build_geometry(space.family().layout, x, pcs::Orl_orientation::gauge_fixed, result);
  return result;
}

/// Height of the lowest node above the root, in the direction of growth.
double depth(const Space& space, const Orl_coordinates& x)
{
  double least = 0;
  for (const Vec3& p : in_space(space, x).node)
    least = std::min(least, space.family().up.dot(p - x.root));
  return least;
}

} // namespace

BOOST_AUTO_TEST_SUITE(orl_beyond_ends)

BOOST_AUTO_TEST_CASE(turns_do_not_add_up_along_branches)
{
  const auto farthest = [](const Orl_geometry& a, const Orl_geometry& b) {
    double worst = 0;
    for (std::size_t e = 0; e < a.frame.size(); ++e)
      worst = std::max(worst, pcs::shape_space::angle_between(a.frame[e], b.frame[e]));
    return worst;
  };
  for (const Space& space :
       {make_space(curled(0), curled(0.15)), make_space(chained(0), chained(0.5))}) {
    const Orl_coordinates x = space.tree(0).coordinates(), y = space.tree(1).coordinates();
    for (const double most : {0.2, 0.25 * CGAL_PI, 2.0, 3.5})
      for (const double lambda : {-1.5, -0.5, 1.5, 2.5}) {
        const auto tree =
            space.geodesic(0, 1, lambda, pcs::parameters::max_extrapolation_angle(most));
        const double worst =
            farthest(in_space(space, tree.coordinates()), in_space(space, lambda < 0 ? x : y));
        BOOST_TEST(worst <= most + 1e-9);
        BOOST_TEST(worst > 0.15); // edges rotate
      }
  }
  // Control: three consecutive branches, each of which rotates within its limit.
  const Space space = make_space(chained(0), chained(0.5));
  const Orl_coordinates x = space.tree(0).coordinates(), y = space.tree(1).coordinates();
  for (const double lambda : {-1.5, 2.5}) {
    constexpr double most = 0.8;
    Orl_coordinates alone;
    coordinates_at(space.family().layout, x, y, lambda, most, alone);
    const Orl_geometry sum = in_space(space, alone), end = in_space(space, lambda < 0 ? x : y);
    BOOST_TEST(std::abs(farthest(sum, end) - 3 * 1.5 * 0.5) < 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(nothing_grows_into_the_ground)
{
  int number_below = 0;
  for (unsigned seed = 70; seed < 94; ++seed) {
    const Space space = seed == 70 ? make_space(curled(0), curled(0.15))
                                   : make_space(random_tree(seed), random_tree(seed + 100));
    const Orl_coordinates x = space.tree(0).coordinates(), y = space.tree(1).coordinates();
    const double floor = std::min(depth(space, x), depth(space, y));
    for (const double lambda : {-2., -0.5, -0.2, 1.2, 1.5, 3.}) {
      const auto tree = space.geodesic(0, 1, lambda);
      const Orl_coordinates& z = tree.coordinates();
      BOOST_TEST(depth(space, z) >= floor - 1e-9);
      Orl_coordinates alone;
      coordinates_at(space.family().layout, x, y, lambda, 0.25 * CGAL_PI, alone);
      number_below += depth(space, alone) < floor - 1e-3 ? 1 : 0;
      // A branch exists if it exists at the end, and branches are connected.
      const Orl_coordinates& end = lambda < 0 ? x : y;
      bool is_there = true;
      for (std::size_t e = 0; e < z.length.size(); ++e)
        is_there =
            is_there && (end.length[e] > 0) == (z.length[e] > 0) && std::isfinite(z.length[e]);
      BOOST_TEST(is_there);
    }
  }
  BOOST_TEST(number_below > 3); // control
}

BOOST_AUTO_TEST_CASE(the_path_goes_on_without_jumps_and_is_unchanged_between_the_ends)
{
  for (unsigned seed = 90; seed < 96; ++seed) {
    const Space space = seed == 90 ? make_space(curled(0), curled(0.15))
                                   : make_space(random_tree(seed), random_tree(seed + 100));
    const Orl_coordinates x = space.tree(0).coordinates(), y = space.tree(1).coordinates();
    const auto step_at = [&](double lambda, double step) {
      const Orl_geometry p = in_space(space, space.geodesic(0, 1, lambda).coordinates()),
                         q = in_space(space, space.geodesic(0, 1, lambda + step).coordinates());
      double worst = 0;
      for (std::size_t v = 0; v < p.node.size(); ++v)
        worst = std::max(worst, (p.node[v] - q.node[v]).norm());
      return worst;
    };
    double fastest = 0;
    for (double lambda = -1; lambda < 2; lambda += 0.01)
      fastest = std::max(fastest, step_at(lambda, 1e-6));
    BOOST_TEST(fastest < 1e-3); // trees are 10 high
    BOOST_TEST(step_at(-1e-6, 1e-6) < 1e-3);
    BOOST_TEST(step_at(1, 1e-6) < 1e-3);
    for (const double lambda : {0.1, 0.5, 0.9}) {
      Orl_coordinates plain;
      coordinates_at(space.family().layout, x, y, lambda, 1, plain);
      const auto tree = space.geodesic(0, 1, lambda);
      const Orl_coordinates& z = tree.coordinates();
      bool is_same = plain.length == z.length && plain.attachment == z.attachment;
      for (std::size_t e = 0; e < z.length.size(); ++e)
        is_same = is_same && plain.orientation[e].coeffs() == z.orientation[e].coeffs();
      BOOST_TEST(is_same);
    }
  }
}

BOOST_AUTO_TEST_CASE(sections_keep_their_area_and_branches_hang_together)
{
  const Tree a = random_tree(97, 3, 2), b = random_tree(98, 3, 2);
  Space space;
  space.add(a, tube_points(a, 20000, 1));
  space.add(b, tube_points(b, 20000, 2));
  space.build();
  const auto& layout = space.family().layout;
  // Squared distances from the axis over squared radii, as sorted area fractions of sections.
  const auto areas_at = [&](double lambda) {
    const auto tree = space.geodesic(0, 1, lambda);
    std::vector<Point> points;
    space.points(tree, points);
    const Orl_geometry g = in_space(space, tree.coordinates());
    std::vector<double> areas;
    for (const Point& point : points) {
      double best = 1e300;
      for (std::size_t k = 0; k < layout.branches.size(); ++k)
        for (std::size_t j = 0; j < layout.branches[k].number_of_edges; ++j) {
          const std::size_t v = layout.first_node(k) + j;
          const Vec3 d = g.node[v + 1] - g.node[v], p = to_eigen(point) - g.node[v];
          if (!(d.squaredNorm() > 0))
            continue;
          const double t = std::min(1.0, std::max(0.0, p.dot(d) / d.squaredNorm()));
          const double area =
              (p - t * d).squaredNorm() / std::pow((1 - t) * g.radius[v] + t * g.radius[v + 1], 2);
          if (std::abs(area - 1) < std::abs(best - 1))
            best = area;
        }
      areas.push_back(best);
    }
    std::sort(areas.begin(), areas.end());
    return areas;
  };
  for (const double lambda : {-0.5, 0., 0.25, 0.5, 0.75, 1., 1.5}) {
    const std::vector<double> areas = areas_at(lambda);
    BOOST_TEST(areas[areas.size() / 50] > 0.95);
    BOOST_TEST(areas[areas.size() - areas.size() / 50] < 1.05);
    // The first node of every branch lies on its parent.
    const auto tree = space.geodesic(0, 1, lambda);
    Tree skeleton;
    space.skeleton(tree, skeleton);
    double worst = 0;
    for (const auto e : boost::make_iterator_range(edges(skeleton))) {
      const auto u = source(e, skeleton), v = target(e, skeleton);
      if (skeleton[u].branch == skeleton[v].branch)
        continue;
      double least = 1e300;
      for (const auto f : boost::make_iterator_range(edges(skeleton))) {
        const auto s = source(f, skeleton), t = target(f, skeleton);
        if (skeleton[s].branch != skeleton[u].branch || skeleton[t].branch != skeleton[u].branch)
          continue;
        const Vec3 p = to_eigen(skeleton[s].point), d = to_eigen(skeleton[t].point) - p;
        const double share =
            std::min(1.0,
                     std::max(0.0, (to_eigen(skeleton[v].point) - p).dot(d) / d.squaredNorm()));
        least = std::min(least, (to_eigen(skeleton[v].point) - p - share * d).norm());
      }
      worst = std::max(worst, least);
    }
    BOOST_TEST(worst < 1e-9);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_robustness)

BOOST_AUTO_TEST_CASE(a_path_of_fifty_thousand_nodes)
{
  const Tree a = path(50000, 1), b = path(20000, 2);
  const auto report = morph(a, tube_points(a, 2000, 1), b, tube_points(b, 2000, 2));
  BOOST_TEST(report.number_of_matched_branches == 1u);
}

BOOST_AUTO_TEST_CASE(a_branch_on_every_node_of_a_chain_of_branches)
{
  // Every branch leaves its parent after the first edge, so that the number of orders is the number
  // of branches.
  const auto chain = [](std::size_t n) {
    Tree tree;
    std::size_t last = add_node(tree, pcs::npos, Vec3(0, 0, 0), 0.1);
    Vec3 p = Vec3::Zero();
    double length = 1;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 side(k % 2 == 0 ? 1 : 0, k % 2 == 0 ? 0 : 1, 0.2);
      const std::size_t v = add_node(tree, last, p + length * side, 0.05);
      add_node(tree, v, p + 3 * length * side, 0.02);
      p += length * side;
      length *= 0.99;
      last = v;
    }
    return tree;
  };
  morph(chain(300), {}, chain(250), {});
}

/// Every branch leaves its parent after the first edge, and is longer than its own branch.
Tree nested(std::size_t n)
{
  Tree tree;
  std::size_t last = add_node(tree, pcs::npos, Vec3(0, 0, 0), 0.1);
  Vec3 p = Vec3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 side(k % 2 == 0 ? 1 : 0, k % 2 == 0 ? 0 : 1, 0.1);
    const std::size_t v = add_node(tree, last, p + side, 0.05);
    add_node(tree, v, p + 2 * static_cast<double>(n - k + 1) * side, 0.02);
    p += side;
    last = v;
  }
  return tree;
}

BOOST_AUTO_TEST_CASE(branches_that_hang_on_branches_250_times)
{
  const Space space = make_space(nested(250), nested(220));
  std::size_t number_matched = 0;
  for (const auto& m : space.matches())
    number_matched += m.tip[0] != pcs::npos && m.tip[1] != pcs::npos ? 1 : 0;
  BOOST_TEST(number_matched > 190u);
  Space other;
  BOOST_CHECK_EXCEPTION(other.add_skeleton(nested(260)),
                        pcs::Invalid_input,
                        message_has("at most 250"));
}

BOOST_AUTO_TEST_CASE(a_star_of_five_hundred_branches)
{
  const Tree a = star(500, 0), b = star(480, 0.05);
  const auto report = morph(a, tube_points(a, 5000, 1), b, tube_points(b, 5000, 2));
  BOOST_TEST(report.number_of_matched_branches > 400u);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_large)

BOOST_AUTO_TEST_CASE(a_star_of_thirteen_hundred_branches)
{
  // More branches than one assignment supports, all with similar weights.
  const Tree a = star(1300, 0), b = star(1200, 0.05);
  const Space space = make_space(a, b);
  std::size_t number_matched = 0, number_near = 0;
  for (const auto& m : space.matches())
    if (m.tip[0] != pcs::npos && m.tip[1] != pcs::npos && m.parent != pcs::npos) {
      ++number_matched;
      const Vec3 apart = to_eigen(a[m.tip[0]].point) - to_eigen(b[m.tip[1]].point);
      number_near += apart.norm() < 0.2 ? 1 : 0; // on a ring of radius 1
    }
  BOOST_TEST(number_matched > 1150u);
  BOOST_TEST(number_near > 9 * number_matched / 10);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_robustness)

BOOST_AUTO_TEST_CASE(a_chain_of_a_hundred_thousand_nodes_and_a_tree_a_million_times_smaller)
{
  const Tree a = path(100000, 1);
  const Tree b = moved(random_tree(61, 3, 2), Eigen::Matrix3d::Identity(), Vec3::Zero(), 1e-6);
  morph(a, tube_points(a, 1000, 1), b, tube_points(b, 1000, 2));
}

BOOST_AUTO_TEST_CASE(equal_trees_are_in_one_place)
{
  const Tree a = random_tree(51);
  const auto scan = tube_points(a, 2000, 1);
  const auto report = morph(a, scan, a, scan);
  BOOST_TEST(report.distance < 1e-9);
  BOOST_TEST(report.number_of_matched_branches == report.number_of_branches[0]);
  BOOST_TEST(report.number_of_unmatched_points == 0u);
}

BOOST_AUTO_TEST_CASE(thousands_of_points_in_one_place)
{
  const Tree a = random_tree(52, 3, 2), b = random_tree(53, 3, 2);
  std::vector<Point> same(5000, tube_points(a, 1, 1)[0]);
  morph(a, same, b, tube_points(b, 1000, 2));
  morph(a, same, b, std::vector<Point>(3000, tube_points(b, 1, 2)[0]));
}

BOOST_AUTO_TEST_CASE(all_points_of_a_large_scan_on_one_branch)
{
  const Tree a = path(2, 0), b = random_tree(54, 3, 2);
  const auto report = morph(a, tube_points(a, 200000, 1), b, tube_points(b, 10000, 2));
  BOOST_TEST(report.number_of_points[0] == 200000u);
  BOOST_TEST(report.worst_marginal_violation < 1e-9);
}

BOOST_AUTO_TEST_CASE(points_that_one_scan_lacks_have_no_partners_far_away)
{
  const Tree tree =
      path(2,
           0); // 5 high; the second scan contains the lowest twentieth, and optionally the highest
  const std::vector<Point> scan = tube_points(tree, 20000, 1);
  for (const bool is_top_seen : {false, true}) {
    std::vector<Point> low;
    for (const Point& p : tube_points(tree, 20000, 2))
      if (p.z() < 0.25 || (is_top_seen && p.z() > 4.75))
        low.push_back(p);
    pcs::Orl_shape_space<Kernel> space;
    space.add(tree, scan);
    space.add(tree, low);
    const auto report = space.build();
    BOOST_TEST(report.number_of_unmatched_points > 15000u);
    std::vector<double> distance(report.number_of_point_pairs, 0);
    space.for_each_point(space.tree(0),
                         [&](std::size_t i, std::size_t first, std::size_t second, double) {
                           if (first != pcs::npos && second != pcs::npos)
                             distance[i] = std::abs(scan[first].z() - low[second].z());
                         });
    // A window of 2,000 points has half this height.
    BOOST_TEST(*std::max_element(distance.begin(), distance.end()) < 0.6);
  }
}

BOOST_AUTO_TEST_CASE(trees_without_radii)
{
  Tree a = random_tree(55, 3, 2), b = random_tree(56, 3, 2);
  const auto scan_a = tube_points(a, 2000, 1), scan_b = tube_points(b, 2000, 2);
  for (Tree* tree : {&a, &b})
    for (std::size_t v = 0; v < num_vertices(*tree); ++v)
      (*tree)[v].radius = 0;
  morph(a, scan_a, b, scan_b);
}

BOOST_AUTO_TEST_CASE(edges_without_length_change_nothing)
{
  const Tree a = random_tree(57, 3, 2), b = random_tree(58, 3, 2);
  // Duplicates every node; the second one follows the first.
  Tree doubled(2 * num_vertices(a));
  for (std::size_t v = 0; v < num_vertices(a); ++v) {
    doubled[2 * v] = doubled[2 * v + 1] = a[v];
    add_edge(2 * v, 2 * v + 1, doubled);
  }
  for (const auto e : boost::make_iterator_range(edges(a)))
    add_edge(2 * source(e, a) + 1, 2 * target(e, a), doubled);
  const auto one = morph(a, {}, b, {}), two = morph(doubled, {}, b, {});
  BOOST_TEST(one.number_of_matched_branches == two.number_of_matched_branches);
  BOOST_TEST(std::abs(one.distance - two.distance) < 1e-9 * one.distance);
}

BOOST_AUTO_TEST_CASE(nodes_that_stand_twice_say_nothing_of_the_branches_there)
{
  // A thick trunk with thin branches. Duplicate nodes of the trunk do not give its radius to the
  // bases of the branches.
  const auto tree = [](bool is_doubled) {
    Tree result;
    const auto add = [&](const Point& p, double radius, std::size_t parent) {
      pcs::Tree_node<Kernel> node;
      node.point = p;
      node.radius = radius;
      std::size_t v = parent;
      for (int k = 0; k < (is_doubled ? 2 : 1); ++k) {
        const std::size_t w = add_vertex(node, result);
        if (v != pcs::npos)
          add_edge(v, w, result);
        v = w;
      }
      return v;
    };
    std::size_t stem = pcs::npos;
    for (int k = 0; k < 5; ++k) {
      stem = add(Point(0, 0, k), 0.5, stem);
      if (k > 0 && k < 4)
        add(Point(1.5, k, k + 0.5), 0.1, stem);
    }
    return result;
  };
  const auto report = morph(tree(false), {}, tree(true), {});
  BOOST_TEST(report.number_of_matched_branches == 4u);
  BOOST_TEST(report.distance < 1e-9);
}

BOOST_AUTO_TEST_CASE(a_cycle_beside_the_root_is_refused)
{
  Tree tree(5);
  add_edge(0, 1, tree);
  add_edge(2, 3, tree);
  add_edge(3, 4, tree);
  add_edge(4, 2, tree);
  for (std::size_t v = 0; v < 5; ++v)
    tree[v].point = Point(0, 0, static_cast<double>(v));
  pcs::Orl_shape_space<Kernel> space;
  BOOST_CHECK_EXCEPTION(space.add_skeleton(tree), pcs::Invalid_input, message_has("cycle"));
}

BOOST_AUTO_TEST_CASE(numbers_of_vertices_that_are_none_are_refused)
{
  const Tree tree = path(4, 1);
  pcs::Orl_shape_space<Kernel> space;
  const auto add = [&](std::vector<int> numbers) {
    space.add_skeleton(
        tree,
        pcs::parameters::node_index_map(
            boost::make_iterator_property_map(numbers.begin(), get(boost::vertex_index, tree))));
  };
  BOOST_CHECK_EXCEPTION(add({0, 1, 2, 4}), pcs::Invalid_input, message_has("index 4"));
  BOOST_CHECK_EXCEPTION(add({0, 1, 2, 1000000}), pcs::Invalid_input, message_has("1000000"));
  BOOST_CHECK_THROW(add({0, 1, 2, -1}), pcs::Invalid_input);
  BOOST_CHECK_EXCEPTION(add({0, 1, 2, 0}), pcs::Invalid_input, message_has("two vertices"));
  add({3, 2, 1, 0});
}

BOOST_AUTO_TEST_CASE(a_place_on_the_path_that_is_no_number_is_refused_and_a_far_one_is_not)
{
  const Tree a = random_tree(62, 3, 2), b = random_tree(63, 3, 2);
  const Space space = make_space(a, b);
  for (const double lambda : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    BOOST_CHECK_EXCEPTION(space.geodesic(0, 1, lambda),
                          pcs::Invalid_input,
                          message_has("not finite"));
  for (const double lambda : {-1e6, 1e6})
    BOOST_TEST(in_space(space, space.geodesic(0, 1, lambda).coordinates()).node[3].allFinite());
  // Overflow of coordinates is reported.
  for (const double lambda : {-1e308, -1e300, 1e300, 1e308})
    try {
      for (const Vec3& p : in_space(space, space.geodesic(0, 1, lambda).coordinates()).node)
        BOOST_TEST(p.allFinite());
    } catch (const pcs::Invalid_input& error) {
      BOOST_TEST(message_has("not finite")(error));
    }
  Tree result = a;
  std::vector<Point> points(7);
  BOOST_CHECK_THROW(pcs::orl_geodesic(a, points, b, points, std::nan(""), result, points),
                    pcs::Invalid_input);
  BOOST_TEST(points.size() == 7u);
  BOOST_TEST(num_vertices(result) == num_vertices(a));
}

BOOST_AUTO_TEST_CASE(archetypes_of_graph_maps_range_and_key)
{
  using Triple = pcs_test::Triple_archetype<double>;
  const auto triples = [](const std::vector<Point>& points) {
    std::vector<Triple> result;
    for (const Point& p : points)
      result.emplace_back(p.x(), p.y(), p.z());
    return result;
  };
  const Tree trees[] = {random_tree(59, 3, 2), random_tree(60, 3, 2)};
  const std::vector<Point> scans[] = {tube_points(trees[0], 500, 1), tube_points(trees[1], 600, 2)};
  pcs::Orl_shape_space<Kernel> space, plain;
  std::vector<Triple> normals;
  for (int t = 0; t < 2; ++t) {
    const Tree& tree = trees[t];
    std::vector<std::pair<std::size_t, std::size_t>> list;
    for (const auto e : boost::make_iterator_range(edges(tree)))
      list.emplace_back(source(e, tree), target(e, tree));
    std::vector<Point> node_points;
    std::vector<float> radii; // same precision as the input
    std::vector<std::size_t> indices;
    Tree rounded = tree;
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      node_points.push_back(tree[v].point);
      radii.push_back(static_cast<float>(tree[v].radius));
      rounded[v].radius = static_cast<double>(radii.back());
      indices.push_back(v);
    }
    const std::vector<Triple> nodes = triples(node_points);
    std::vector<Triple> points = triples(scans[t]);
    normals.assign(points.size(), Triple(0, 0, 1));
    space.add(pcs_test::Tree_archetype(indices.size(), list),
              pcs_test::Range_archetype(points.size()),
              pcs::parameters::node_point_map(pcs_test::Vertex_map_archetype<Triple>(nodes))
                  .node_radius_map(pcs_test::Vertex_map_archetype<float>(radii))
                  .node_index_map(pcs_test::Vertex_map_archetype<std::size_t>(indices))
                  .point_map(pcs_test::Map_archetype<Triple>(points))
                  .normal_map(pcs_test::Map_archetype<Triple>(normals)));
    std::vector<std::pair<Point, Kernel::Vector_3>> oriented;
    for (const Point& p : scans[t])
      oriented.emplace_back(p, Kernel::Vector_3(0, 0, 1));
    using Oriented = std::pair<Point, Kernel::Vector_3>;
    plain.add(rounded,
              oriented,
              pcs::parameters::point_map(CGAL::First_of_pair_property_map<Oriented>())
                  .normal_map(CGAL::Second_of_pair_property_map<Oriented>()));
  }
  space.build();
  plain.build();
  const auto tree = space.geodesic(0, 1, 0.3);
  std::vector<Triple> out(tree.number_of_points(), Triple(7, 7, 7));
  normals = out;
  pcs_test::Range_archetype range(out.size());
  const auto maps = pcs::parameters::point_map(pcs_test::Map_archetype<Triple>(out))
                        .normal_map(pcs_test::Map_archetype<Triple>(normals));
  BOOST_TEST(space.points(tree, range, maps) == out.size());
  std::vector<Point> expected;
  plain.points(plain.geodesic(0, 1, 0.3), expected);
  BOOST_TEST_REQUIRE(expected.size() == out.size());
  bool is_same = true;
  for (std::size_t i = 0; i < out.size(); ++i)
    is_same = is_same && Point(out[i].x(), out[i].y(), out[i].z()) == expected[i];
  BOOST_TEST(is_same);
  // The same through the function.
  std::vector<std::size_t> order[2];
  std::vector<Triple> nodes[2], places[2];
  std::vector<float> radii[2];
  const auto maps_of = [&](std::size_t t) {
    for (std::size_t v = 0; v < num_vertices(trees[t]); ++v) {
      order[t].push_back(v);
      radii[t].push_back(static_cast<float>(trees[t][v].radius));
      const Point& p = trees[t][v].point;
      nodes[t].emplace_back(p.x(), p.y(), p.z());
    }
    places[t] = triples(scans[t]);
    return pcs::parameters::node_point_map(pcs_test::Vertex_map_archetype<Triple>(nodes[t]))
        .node_radius_map(pcs_test::Vertex_map_archetype<float>(radii[t]))
        .node_index_map(pcs_test::Vertex_map_archetype<std::size_t>(order[t]))
        .point_map(pcs_test::Map_archetype<Triple>(places[t]));
  };
  const auto maps_a = maps_of(0), maps_b = maps_of(1);
  const auto graph_of = [](const Tree& graph) {
    std::vector<std::pair<std::size_t, std::size_t>> list;
    for (const auto e : boost::make_iterator_range(edges(graph)))
      list.emplace_back(source(e, graph), target(e, graph));
    return pcs_test::Tree_archetype(num_vertices(graph), list);
  };
  Tree middle;
  std::vector<Point> points;
  pcs::orl_geodesic(graph_of(trees[0]),
                    pcs_test::Range_archetype(scans[0].size()),
                    graph_of(trees[1]),
                    pcs_test::Range_archetype(scans[1].size()),
                    0.3,
                    middle,
                    points,
                    pcs::parameters::number_of_rounds(1),
                    maps_a,
                    maps_b);
  BOOST_TEST(num_vertices(middle) > 2u);
  BOOST_TEST(points.size() >= scans[1].size());

  pcs_test::Range_archetype small(out.size() - 1);
  BOOST_CHECK_THROW(space.points(tree, small, maps), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(blades_of_leaves_stay_thin)
{
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const double turn = 0.4 * seed - 1, more = 0.9;
    std::vector<Point> scan_a, scan_b, points;
    const Tree a = with_blade(turn, 0.5, 0.15, seed, scan_a),
               b = with_blade(turn + more, 0.8, -0.15, 10 + seed, scan_b);
    Space space;
    space.add(a, scan_a);
    space.add(b, scan_b);
    space.build();
    space.points(space.geodesic(0, 1, 0.5), points);
    double widest = 0, off = 0, n = 0;
    const double middle = turn + 0.5 * more;
    for (const Point& p : points)
      if (p.x() > 1) {
        widest = std::max(widest, std::hypot(p.y(), p.z() - 2));
        const double across = -std::sin(middle) * p.y() + std::cos(middle) * (p.z() - 2);
        off += across * across;
        ++n;
      }
    BOOST_TEST(n > 2000);
    BOOST_TEST(std::sqrt(off / n) < 0.04);
    BOOST_TEST(widest > 0.9 * 0.65 * std::cos(0.5 * more)); // linear within sections
    BOOST_TEST(widest < 0.7);
  }
}

BOOST_AUTO_TEST_CASE(what_is_behind_a_fold_stays_where_it_is)
{
  // Parts with equal positions in both trees, except for noise and folds, keep their position along
  // the whole path.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Space space = make_space(leaning(2 * seed, seed % 2 == 0), leaning(2 * seed + 1, true));
    const Orl_geometry a = in_space(space, space.geodesic(0, 1, 0).coordinates()),
                       m = in_space(space, space.geodesic(0, 1, 0.5).coordinates()),
                       b = in_space(space, space.geodesic(0, 1, 1).coordinates());
    double farthest = 0;
    for (std::size_t v = 0; v < m.node.size(); ++v)
      farthest = std::max(farthest, (m.node[v] - 0.5 * (a.node[v] + b.node[v])).norm());
    BOOST_TEST(farthest < 0.5); // of a height of 12
  }
}

BOOST_AUTO_TEST_CASE(the_end_of_a_trunk_is_the_end_whatever_twig_is_longest)
{
  pcs::Orl_shape_space<Kernel> space;
  const Tree a = forked_end(0.5, 0.3), b = forked_end(0.3, 0.5);
  space.add_skeleton(a);
  space.add_skeleton(b);
  space.build();
  int number_found = 0;
  for (const pcs::Branch_match& m : space.matches())
    if (m.tip[0] == 3 || m.tip[1] == 3) { // the node straight above the fork
      BOOST_TEST(m.tip[0] == m.tip[1]);
      ++number_found;
    }
  BOOST_TEST(number_found == 1);
}

// A node of one tree may coincide with a node of the other up to rounding. The edge between them
// has no direction.
BOOST_AUTO_TEST_CASE(nodes_in_one_place_of_the_other_tree_are_no_harm)
{
  const Tree one = star(1, 0), two = star(1, 0.3);
  Space space;
  space.add_skeleton(one);
  space.add_skeleton(two);
  space.build();
  pcs::Orl_correspondences correspondences = space.correspondences();
  BOOST_REQUIRE(correspondences.branches.size() == 2u);
  for (auto& branch : correspondences.branches) {
    const std::vector<double> own = branch.nodes[0];
    BOOST_REQUIRE(own.size() == 3u);
    branch.nodes = {{{0, 1e-16, own[1], std::nextafter(own[1], 1), 1}, {0, 0.1, own[1], 0.8, 1}}};
    branch.attachment = {branch.attachment[0] * 2, branch.attachment[1] * 2}; // of old nodes
  }
  const auto report = space.build_from(correspondences);
  BOOST_TEST(std::isfinite(report.distance));
  Tree tree;
  for (const double lambda : {0.0, 0.5, 1.0}) {
    space.skeleton(space.geodesic(0, 1, lambda), tree);
    Vec3 high = Vec3::Zero();
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      BOOST_TEST(to_eigen(tree[v].point).allFinite());
      BOOST_TEST((v < 5 || std::abs(tree[v].point.z() - 2.5) < 0.01)); // both are horizontal
      high = high.cwiseMax(to_eigen(tree[v].point));
    }
    BOOST_TEST(high.z() == 5, boost::test_tools::tolerance(1e-6));
  }
}

BOOST_AUTO_TEST_CASE(surfaces_do_not_tear_where_bends_grow)
{
  const double radius = 0.3, bend = 0.5;
  const Tree straight = bent_tube(0, radius), bent = bent_tube(bend, radius);
  pcs::Orl_shape_space<Kernel> space;
  space.add(straight, whole_tube_points(straight, 20000, 1));
  space.add(bent, whole_tube_points(bent, 20000, 2));
  space.build();
  const double spacing = std::sqrt(2 * CGAL_PI * radius * 6 / 20000);
  for (double lambda = -0.5; lambda <= 1.5; lambda += 0.25) {
    const pcs::Orl_tree tree = space.geodesic(0, 1, lambda);
    std::vector<Point> points;
    space.points(tree, points);
    Tree skeleton;
    space.skeleton(tree, skeleton);
    std::vector<Vec3> axis{to_eigen(skeleton[skeleton[boost::graph_bundle].root].point)};
    for (std::size_t v = skeleton[boost::graph_bundle].root; out_degree(v, skeleton) > 0;) {
      v = target(*out_edges(v, skeleton).first, skeleton);
      axis.push_back(to_eigen(skeleton[v].point));
    }
    BOOST_TEST_REQUIRE(axis.size() >= 7u);
    // Sections keep their size: the distance from the line of the nearest edge is about the radius.
    double worst = 0;
    for (const Point& p : points) {
      double least = 1;
      for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
        const Vec3 d = (axis[k + 1] - axis[k]).normalized();
        least = std::min(least, std::abs((to_eigen(p) - axis[k]).cross(d).norm() - radius));
      }
      worst = std::max(worst, least);
    }
    BOOST_TEST(worst < 0.1 * radius);
    // No gap on the outer side of bends between the two tubes.
    for (std::size_t k = 1; k + 1 < axis.size(); ++k) {
      const Vec3 d = (axis[k] - axis[k - 1]).normalized(), e = (axis[k + 1] - axis[k]).normalized();
      if ((d - e).norm() < 0.1)
        continue;
      const Vec3 outermost =
          axis[k] + radius / std::sqrt(0.5 * (1 + d.dot(e))) * (d - e).normalized();
      double nearest = 1;
      for (const Point& p : points)
        nearest = std::min(nearest, (to_eigen(p) - outermost).norm());
      BOOST_TEST(nearest < 3 * spacing);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_robustness

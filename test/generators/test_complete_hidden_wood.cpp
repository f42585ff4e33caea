// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of inferred wood: what a curtain hides is completed, and what beams pass stays empty.

#include <pcs/core/Tree_measures.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/complete_hidden_wood.h>
#include <pcs/generators/edit_branches.h>
#include <pcs/generators/grow_tree.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>
#include <CGAL/tags.h>

#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace test_complete_hidden_wood {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point = Kernel::Point_3;
namespace np = pcs::parameters;

namespace {

constexpr double step = 0.002; // [rad]
const Point station(15, 0, 1.5);

Tree grown(const pcs::Tree_habit& habit, int seed)
{
  Tree tree;
  pcs::grow_tree(tree, habit, np::random_seed(seed));
  return tree;
}

/// A habit that is known, without fitting it to a tree.
pcs::Tree_habit_fit known(const pcs::Tree_habit& habit)
{
  pcs::Tree_habit_fit fit;
  fit.habit = habit;
  fit.allometry.height = habit.height;
  return fit;
}

/// The returns of beams that meet a vertical curtain at `x`, from `low` upwards.
std::vector<Point> curtain(double x, double low = -1)
{
  std::vector<Point> points;
  for (double azimuth = -0.5; azimuth < 0.5; azimuth += step)
    for (double elevation = -0.2; elevation < 0.8; elevation += step) {
      const double range = station.x() - x, across = std::tan(azimuth);
      const double z = station.z() + range * std::hypot(1, across) * std::tan(elevation);
      if (z > low)
        points.emplace_back(x, range * across, z);
    }
  return points;
}

/// The tree without the branches of its trunk that are behind `limit` from a fifth of their length
/// on: what is hidden of the others is thin.
Tree without_back(const Tree& whole, double limit)
{
  Tree tree = whole;
  const auto nodes = pcs::nodes_by_branch<Kernel>(whole);
  const auto& branches = whole[boost::graph_bundle].branches;
  for (std::size_t b = 0; b < branches.size(); ++b)
    if (branches[b].order == 1 && whole[nodes[b][nodes[b].size() / 5]].point.x() < limit)
      tree = pcs::prune_branch(tree, branches[b].id);
  return tree;
}

double volume(const Tree& tree)
{
  return pcs::measure_tree(tree).volume;
}

pcs::Hidden_wood<Kernel>
complete(const Tree& tree, const std::vector<Point>& points, const pcs::Tree_habit& habit)
{
  return pcs::complete_hidden_wood(tree,
                                   points,
                                   known(habit),
                                   np::scanner_positions(std::vector<Point>{station})
                                       .angular_step(step)
                                       .number_of_simulations(20));
}

void check_message(const pcs::Invalid_input& e, const std::string& word)
{
  const std::string message = e.what();
  BOOST_TEST(message.find("pcs::complete_hidden_wood()") == 0u, message);
  BOOST_TEST(message.find(word) != std::string::npos, word << " in " << message);
}

} // namespace

BOOST_AUTO_TEST_SUITE(complete_hidden_wood)

BOOST_AUTO_TEST_CASE(beams_end_at_returns)
{
  namespace hidden = pcs::generators::hidden;
  std::vector<hidden::Vector3> points;
  for (const Point& p : curtain(0, 2))
    points.emplace_back(p.x(), p.y(), p.z());
  const hidden::Vector3 position(station.x(), station.y(), station.z());
  const hidden::Beam_distances distances = hidden::distances_of_beams(position, points);
  BOOST_TEST(std::abs(distances.step() - step) < 1e-6);
  const hidden::Station_view view(position, points, step);
  BOOST_TEST(view.visible_share({-2, 0.5, 4}, 0.01) < 0.25); // behind the curtain
  BOOST_TEST(view.visible_share({2, 0.5, 4}, 0.01) == 1);    // before it
  BOOST_TEST(view.visible_share({-2, 0.5, 1}, 0.01) == 1);   // below it
  BOOST_TEST(view.visible_share({17, 0.5, 4}, 0.01) == 1);   // on the other side of the station
  BOOST_TEST(view.blocked_share({-2, 0.5, 4}, 0.01) > 0.75);
  BOOST_TEST(view.blocked_share({-2, 0.5, 1}, 0.01) == 0);
  // returns of the surface itself do not hide a branch; a place before returns may be blocked
  BOOST_TEST(view.visible_share({-0.05, 0.5, 4}, 0.01) == 1);
  BOOST_TEST(view.blocked_share({0.05, 0.5, 4}, 0.2) > 0.75);
  BOOST_TEST(view.blocked_share({0.5, 0.5, 4}, 0.2) == 0);
  // a rod of 1 m and 2 cm across the beams, at a distance of 15 m
  const double beams = view.number_of_beams({0, 0, 1.5}, {0, 1, 0}, 1, 0.01);
  BOOST_TEST(std::abs(beams - 0.02 / std::pow(15 * step, 2)) < 1e-9);
  BOOST_TEST(view.number_of_beams({0, 0, 1.5}, {1, 0, 0}, 1, 0.01) < 1e-9); // along a beam
}

BOOST_AUTO_TEST_CASE(only_the_station_of_a_scan_sees_a_grid)
{
  namespace hidden = pcs::generators::hidden;
  std::vector<hidden::Vector3> points, thinned;
  for (const Point& p : curtain(0)) {
    points.emplace_back(p.x(), p.y(), p.z());
    if (points.size() % 17 % 5 == 0 && points.size() % 3 == 0)
      thinned.push_back(points.back());
  }
  const auto share = [](const hidden::Vector3& from, const std::vector<hidden::Vector3>& seen) {
    const hidden::Beam_distances distances = hidden::distances_of_beams(from, seen);
    return distances.share_at(distances.step());
  };
  const hidden::Vector3 position(station.x(), station.y(), station.z());
  BOOST_TEST(share(position, points) > 0.95);
  BOOST_TEST(share(position, thinned) < 0.5);
  BOOST_TEST(share({3, 6, 1}, points) < 0.5);
  BOOST_TEST(share({0, 0, 3}, points) < 0.5);
  BOOST_TEST(share(position, {}) == 0);
  BOOST_TEST(share(position, {points[0]}) == 0);
  BOOST_TEST(hidden::Station_view(position, points, step).crowded_share() == 0);
  BOOST_TEST(hidden::Station_view(position, points, 3 * step).crowded_share() > 0.9);
  const hidden::Station_view view(position, points, step);
  BOOST_TEST(view.has_return({0, 0.5, 4}, 0.01));
  BOOST_TEST(view.has_return({-0.1, 0.5, 4}, 0.1));
  BOOST_TEST(!view.has_return({-1, 0.5, 4}, 0.01));
  BOOST_TEST(!view.has_return({1, 0.5, 4}, 0.01));
}

BOOST_AUTO_TEST_CASE(the_result_tells_whether_the_scan_has_the_tree)
{
  const Tree tree = grown(pcs::fruit_habit(), 6);
  const auto other = complete(tree, curtain(-20), pcs::fruit_habit());
  BOOST_TEST(other.scanned_share < 0.01);
  BOOST_TEST(other.grid_share > 0.95);
  std::vector<Point> points;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    points.push_back(tree[v].point);
  const auto own = complete(tree, points, pcs::fruit_habit());
  BOOST_TEST(own.scanned_share > 0.6);
  BOOST_TEST(own.grid_share < 0.5);
}

BOOST_AUTO_TEST_CASE(the_share_that_is_found_grows_with_visibility_and_beams)
{
  using pcs::generators::hidden::found_share;
  BOOST_TEST(found_share(0, 1000) == 0);
  BOOST_TEST(found_share(1, 1000) > 0.999);
  for (const double beams : {1., 10., 100., 1000.})
    for (double v = 0; v < 0.95; v += 0.1) {
      BOOST_TEST(found_share(v, beams) < found_share(v + 0.1, beams));
      if (v > 0)
        BOOST_TEST(found_share(v, beams) < found_share(v, 3 * beams));
    }
}

BOOST_AUTO_TEST_CASE(thin_hidden_axes_gain_volume)
{
  using pcs::generators::hidden::volume_ratio;
  BOOST_TEST(volume_ratio(0.5, 0.2, false) > 2);
  BOOST_TEST(volume_ratio(0.5, 1, false) == 1);
  BOOST_TEST(volume_ratio(20, 0.2, false) < 1.001);
  BOOST_TEST(volume_ratio(20, 1, true) < 1); // circles on one side
  BOOST_TEST(volume_ratio(0.1, 1, true) > volume_ratio(0.3, 1, true));
}

BOOST_AUTO_TEST_CASE(what_a_curtain_hides_is_completed)
{
  constexpr double limit = 0.2;
  double removed = 0, inferred = 0, behind = 0, all = 0;
  for (const int seed : {11, 12, 13}) {
    const Tree whole = grown(pcs::broadleaf_habit(), seed), seen = without_back(whole, limit);
    const auto wood = complete(seen, curtain(limit), pcs::broadleaf_habit());
    removed += volume(whole) - volume(seen);
    inferred += wood.hidden_branches.value;
    BOOST_TEST(wood.measured_volume == volume(seen));
    BOOST_TEST(wood.hidden_crown_share > 0.05);
    BOOST_TEST(wood.hidden_crown_share < 0.7);
    BOOST_TEST(num_vertices(wood.branches) > 100u);
    for (const auto e : boost::make_iterator_range(edges(wood.branches))) {
      const auto& from = wood.branches[source(e, wood.branches)];
      const auto& to = wood.branches[target(e, wood.branches)];
      const double piece =
          std::sqrt(CGAL::squared_distance(from.point, to.point)) * to.radius * to.radius;
      all += piece;
      behind += to.point.x() < limit ? piece : 0;
    }
  }
  BOOST_TEST(behind > 0.7 * all);
  BOOST_TEST(removed > 0.1);
  BOOST_TEST(inferred > 0.4 * removed); // the skeleton would show a part of it
  BOOST_TEST(inferred < 1.3 * removed);
}

BOOST_AUTO_TEST_CASE(nothing_is_inferred_where_beams_pass)
{
  const Tree tree = grown(pcs::fruit_habit(), 3);
  const auto wood =
      pcs::complete_hidden_wood(tree,
                                curtain(-20), // far behind
                                known(pcs::fruit_habit()),
                                np::scanner_positions(std::vector<Point>{Point(4, 0, 1.5)})
                                    .angular_step(0.0002)
                                    .number_of_simulations(20));
  BOOST_TEST(num_vertices(wood.branches) == 0u);
  BOOST_TEST(wood.attached_to.empty());
  BOOST_TEST(wood.hidden_branches.value < 0.001 * wood.measured_volume);
  BOOST_TEST(wood.missing_stems.value == 0);
  BOOST_TEST(wood.hidden_crown_share == 0);
  BOOST_TEST(wood.total_volume.least < wood.measured_volume);
  BOOST_TEST(wood.total_volume.largest > wood.measured_volume);
}

BOOST_AUTO_TEST_CASE(inferred_branches_begin_on_measured_nodes_or_on_each_other)
{
  const Tree seen = without_back(grown(pcs::broadleaf_habit(), 11), -0.3);
  const auto wood = complete(seen, curtain(-0.3), pcs::broadleaf_habit());
  const auto& branches = wood.branches[boost::graph_bundle].branches;
  BOOST_TEST_REQUIRE(wood.attached_to.size() == num_vertices(wood.branches));
  std::size_t on_measured = 0;
  for (std::size_t v = 0; v < num_vertices(wood.branches); ++v) {
    const auto& node = wood.branches[v];
    BOOST_TEST(!node.is_measured);
    BOOST_TEST(node.radius > 0);
    BOOST_TEST_REQUIRE(node.branch < branches.size());
    const std::size_t parent = pcs::parent_node<Kernel>(v, wood.branches);
    const std::size_t carrier = wood.attached_to[v];
    BOOST_TEST_REQUIRE((parent == pcs::npos) == (carrier != pcs::npos));
    if (carrier != pcs::npos) {
      ++on_measured;
      BOOST_TEST_REQUIRE(carrier < num_vertices(seen));
      BOOST_TEST(CGAL::squared_distance(node.point, seen[carrier].point) < 1e-12);
      BOOST_TEST(branches[node.branch].parent == pcs::npos);
    } else if (wood.branches[parent].branch != node.branch) {
      BOOST_TEST(CGAL::squared_distance(node.point, wood.branches[parent].point) < 1e-12);
      BOOST_TEST(branches[node.branch].parent == wood.branches[parent].branch);
    }
  }
  BOOST_TEST(on_measured > 5u);
}

BOOST_AUTO_TEST_CASE(a_lost_trunk_is_continued_only_behind_returns)
{
  // the trunk ends at half of its height, as do all of its branches above
  const Tree whole = grown(pcs::broadleaf_habit(), 21);
  Tree seen = whole;
  for (const auto& branch : whole[boost::graph_bundle].branches)
    if (branch.order == 1) {
      const auto nodes = pcs::nodes_by_branch<Kernel>(whole);
      if (whole[nodes[branch.id].front()].point.z() > 5.5)
        seen = pcs::prune_branch(seen, branch.id);
    }
  Tree cut;
  std::vector<std::size_t> kept(num_vertices(seen), pcs::npos);
  double lost = 0;
  for (std::size_t v = 0; v < num_vertices(seen); ++v) {
    const std::size_t parent = pcs::parent_node<Kernel>(v, seen);
    if (seen[v].branch == 0 && seen[v].point.z() > 6) {
      const double a = seen[parent].radius, b = seen[v].radius;
      const double length = std::sqrt(CGAL::squared_distance(seen[parent].point, seen[v].point));
      lost += CGAL_PI / 3 * length * (a * a + a * b + b * b);
      continue;
    }
    kept[v] = add_vertex(seen[v], cut);
    if (parent != pcs::npos)
      add_edge(kept[parent], kept[v], cut);
  }
  cut[boost::graph_bundle] = seen[boost::graph_bundle];
  // a measured twig shows how high the tree is
  const auto top = std::max_element(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) {
    return (a == pcs::npos ? -1 : cut[a].point.z()) < (b == pcs::npos ? -1 : cut[b].point.z());
  });
  cut[*top].point = Point(cut[*top].point.x(), cut[*top].point.y(), 11.5);

  const auto hidden = complete(cut, curtain(1), pcs::broadleaf_habit());
  BOOST_TEST(hidden.number_of_stems == 1u);
  BOOST_TEST(hidden.missing_stems.least < lost);
  BOOST_TEST(hidden.missing_stems.largest > lost);
  BOOST_TEST(hidden.missing_stems.value > lost / 2);
  const auto empty = complete(cut, curtain(1, 12), pcs::broadleaf_habit());
  BOOST_TEST(empty.number_of_stems == 0u);
  BOOST_TEST(empty.missing_stems.value == 0);
}

BOOST_AUTO_TEST_CASE(volumes_add_up_and_intervals_contain_them)
{
  const Tree seen = without_back(grown(pcs::broadleaf_habit(), 12), -0.3);
  const auto w = complete(seen, curtain(-0.3), pcs::broadleaf_habit());
  const double sum = w.hidden_branches.value + w.missing_stems.value + w.radius_correction.value;
  BOOST_TEST(std::abs(w.inferred_volume.value - sum) < 1e-12);
  BOOST_TEST(std::abs(w.total_volume.value - w.measured_volume - sum) < 1e-12);
  for (const auto* v : {&w.hidden_branches, &w.inferred_volume, &w.total_volume}) {
    BOOST_TEST(v->least < v->value);
    BOOST_TEST(v->largest > v->value);
  }
  BOOST_TEST(w.total_volume.standard_error > w.inferred_volume.standard_error);
  BOOST_TEST(std::abs(w.angular_step - step) < 1e-12);
}

BOOST_AUTO_TEST_CASE(inferred_wood_is_negative_only_where_axes_may_be_too_thick)
{
  pcs::generators::hidden::Hidden_estimate e;
  e.hidden_branches = {1, 2, 0, 5};
  pcs::Inferred_volume inferred, total;
  sum_up(e, 10, inferred, total);
  BOOST_TEST(inferred.value == 1);
  BOOST_TEST(inferred.least == 0);
  BOOST_TEST(inferred.largest == 5);
  e.radius_correction = {-3, 0.5, -4, -2};
  sum_up(e, 10, inferred, total);
  BOOST_TEST(inferred.value == -2);
  BOOST_TEST(inferred.least == -4);
  BOOST_TEST(total.value == 8);
}

BOOST_AUTO_TEST_CASE(lengths_scale)
{
  constexpr double scale = 10;
  const pcs::Tree_habit habit = pcs::fruit_habit();
  const Tree tree = without_back(grown(habit, 5), -0.1);
  Tree large = tree;
  std::vector<Point> points = curtain(-0.1), large_points;
  for (const Point& p : points)
    large_points.emplace_back(scale * p.x(), scale * p.y(), scale * p.z());
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    const Point& p = tree[v].point;
    large[v].point = Point(scale * p.x(), scale * p.y(), scale * p.z());
    large[v].radius *= scale;
  }
  const auto small_wood = complete(tree, points, habit);
  const auto large_wood = pcs::complete_hidden_wood(
      large,
      large_points,
      known(habit.scaled(scale)),
      np::scanner_positions(std::vector<Point>{Point(scale * 15, 0, scale * 1.5)})
          .angular_step(step)
          .number_of_simulations(20));
  BOOST_TEST(small_wood.hidden_branches.value > 0);
  BOOST_TEST(std::abs(large_wood.hidden_branches.value / small_wood.hidden_branches.value /
                          std::pow(scale, 3) -
                      1) < 0.02);
}

BOOST_AUTO_TEST_CASE(results_do_not_depend_on_threads)
{
  const Tree seen = without_back(grown(pcs::fruit_habit(), 4), -0.1);
  const auto points = curtain(-0.1);
  const auto parameters = np::scanner_positions(std::vector<Point>{station})
                              .angular_step(step)
                              .number_of_simulations(20);
  const auto fit = known(pcs::fruit_habit());
  const auto a = pcs::complete_hidden_wood<CGAL::Sequential_tag>(seen, points, fit, parameters);
  const auto b =
      pcs::complete_hidden_wood<CGAL::Parallel_if_available_tag>(seen, points, fit, parameters);
  const auto other = pcs::complete_hidden_wood(seen, points, fit, parameters.random_seed(1));
  BOOST_TEST(a.hidden_branches.value == b.hidden_branches.value);
  BOOST_TEST(a.total_volume.standard_error == b.total_volume.standard_error);
  BOOST_TEST(num_vertices(a.branches) == num_vertices(b.branches));
  BOOST_TEST(a.hidden_branches.value != other.hidden_branches.value);
}

BOOST_AUTO_TEST_CASE(a_second_station_shows_the_back)
{
  const Tree tree = grown(pcs::fruit_habit(), 6);
  using Labelled = std::pair<Point, int>;
  std::vector<Labelled> points;
  for (const Point& p : curtain(1)) {
    points.emplace_back(p, 0);
    points.emplace_back(Point(-20 - p.x(), p.y(), p.z()), 1); // behind the other station
  }
  points.emplace_back(Point(0, 0, 0), -1); // of an unknown station
  const auto parameters = np::point_map(CGAL::First_of_pair_property_map<Labelled>())
                              .station_map(CGAL::Second_of_pair_property_map<Labelled>())
                              .number_of_simulations(20)
                              .angular_step(0.0005);
  const auto both = pcs::complete_hidden_wood(
      tree,
      points,
      known(pcs::fruit_habit()),
      parameters.scanner_positions(std::vector<Point>{station, Point(-4, 0, 1.5)}));
  BOOST_TEST(both.hidden_crown_share < 0.01);
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused)
{
  const Tree tree = grown(pcs::fruit_habit(), 6);
  const auto fit = known(pcs::fruit_habit());
  const std::vector<Point> points = curtain(0), one{station}, two{station, Point(-4, 0, 1)};
  const auto refuses = [&](const std::string& word, const Tree& t, const auto& cloud, auto p) {
    BOOST_CHECK_EXCEPTION(pcs::complete_hidden_wood(t, cloud, fit, p),
                          pcs::Invalid_input,
                          [&](const pcs::Invalid_input& e) {
                            check_message(e, word);
                            return true;
                          });
  };
  refuses("pass scanner_positions()", tree, points, np::random_seed(1));
  refuses("pass scanner_positions()", tree, points, np::scanner_positions(std::vector<Point>()));
  refuses("pass station_map()", tree, points, np::scanner_positions(two));
  refuses("pass the scan", tree, std::vector<Point>(), np::scanner_positions(one));
  refuses("pass angular_step()",
          tree,
          std::vector<Point>{Point(0, 0, 0)},
          np::scanner_positions(one));
  refuses("angular_step", tree, points, np::scanner_positions(one).angular_step(-1.0));
  refuses("angular_step() is too large",
          tree,
          points,
          np::scanner_positions(one).angular_step(4 * step));
  refuses("found 5e-08", tree, points, np::scanner_positions(one).angular_step(5e-8));
  refuses("not on a grid of directions; check that the position of station 0",
          tree,
          points,
          np::scanner_positions(std::vector<Point>{Point(0, 0, 3)}));
  Tree millimetres = tree;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    const Point& p = tree[v].point;
    millimetres[v].point = Point(1000 * p.x(), 1000 * p.y(), 1000 * p.z());
    millimetres[v].radius *= 1000;
  }
  refuses("use one unit of length", millimetres, points, np::scanner_positions(one));
  refuses("number_of_simulations",
          tree,
          points,
          np::scanner_positions(one).number_of_simulations(3));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses("points must be finite",
          tree,
          std::vector<Point>{Point(0, nan, 0)},
          np::scanner_positions(one));
  refuses("scanner_positions must be finite",
          tree,
          points,
          np::scanner_positions(std::vector<Point>{Point(nan, 0, 0)}));
  pcs::Tree_habit bare = pcs::fruit_habit();
  bare.number_of_orders = 1;
  refuses("at least 4 branches", grown(bare, 1), points, np::scanner_positions(one));
  refuses("no nodes", Tree(), points, np::scanner_positions(one));

  using Labelled = std::pair<Point, int>;
  const std::vector<Labelled> labelled{{Point(0, 0, 0), 5}};
  refuses("has the station 5",
          tree,
          labelled,
          np::scanner_positions(one)
              .point_map(CGAL::First_of_pair_property_map<Labelled>())
              .station_map(CGAL::Second_of_pair_property_map<Labelled>()));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_complete_hidden_wood

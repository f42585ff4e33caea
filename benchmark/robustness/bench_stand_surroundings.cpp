// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Segmentation of random virtual stands with slopes, sparse ground, shrubs, stray points, thinning
// and objects: how often a tree is right, and how often a wrong or false tree has a warning.

#include "support/Labelled_point.h"
#include "support/Table.h"
#include "support/virtual_objects.h"
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/range/iterator_range.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Tree = pcs::Tree_skeleton<Kernel>;
using pcs_bench::Found_map;
using pcs_bench::Labelled_point;
using pcs_bench::Position_map;
using pcs_bench::Random;
using pcs_bench::uniform;
namespace np = pcs::parameters;

namespace {

constexpr double breast_height = 1.3; // [m]
constexpr std::size_t max_points = 600000;

/// How a stand is made. Lengths in metres.
struct Site
{
  double slope = 0;          ///< height / horizontal distance [-]
  double ground_density = 0; ///< points of the ground per square metre
  double roughness = 0;      ///< largest distance of a point from the ground
  double shrub_density = 0;  ///< shrubs per square metre
  double strays = 0;         ///< stray points below the ground / other points [-]
  double voxel = 0;          ///< one point is kept per cube of this side; 0: all
  double leaves = 0;         ///< per metre of twig
  double height = 0;         ///< typical height of the trees, except fruit trees
  double distance = 0;       ///< of neighbouring trees
  double angular_step = 0;   ///< of the beams [rad]
  double coarseness = 1;     ///< factor of the distance of points on objects [-]
  std::size_t stations = 0, trees_per_side = 0, objects = 0;
  bool is_mixed = false;  ///< each tree has its own habit
  std::size_t habit = 0;  ///< index of the habit of all trees, if not mixed
  std::uint64_t seed = 0; ///< of the trees and scans

  double low() const { return -0.25 * distance - margin(); }
  double high() const { return (double(trees_per_side) - 0.75) * distance + margin(); }
  double area() const { return (high() - low()) * (high() - low()); }
  /// Height of the ground, which has undulations of 0.15 m.
  double ground(double x, double y) const
  {
    return slope * x + 0.15 * std::sin(0.7 * x) * std::cos(0.9 * y);
  }

private:
  /// Width of the ground beyond the outermost place of a tree.
  double margin() const { return std::min(0.75 * distance, 3.0); }
};

Site random_site(std::uint64_t seed, Random& random)
{
  constexpr double max_ground_points = 300000;
  const auto one_of = [&](const std::vector<double>& list) { return list[random() % list.size()]; };
  const auto habits = pcs::tree_habits();
  Site site;
  site.seed = seed;
  site.slope = one_of({0, 0.2, 0.4, 0.7});
  site.ground_density = one_of({0, 3, 10, 50, 300});
  site.roughness = one_of({0.02, 0.05, 0.1});
  site.shrub_density = one_of({0, 0, 0.1});
  site.strays = one_of({0, 0, 0.002});
  site.voxel = one_of({0, 0, 0.02, 0.04});
  site.leaves = one_of({0, 0, 8});
  site.height = uniform(random, 6, 22);
  site.angular_step = one_of({0.1, 0.15, 0.25}) * CGAL_PI / 180;
  site.stations = static_cast<std::size_t>(one_of({1, 2, 3, 4}));
  site.trees_per_side = static_cast<std::size_t>(one_of({2, 3}));
  site.objects = static_cast<std::size_t>(one_of({0, 0, 0, 0, 1, 2}));
  site.is_mixed = random() % 2 == 1;
  site.habit = random() % habits.size();
  const bool is_orchard = !site.is_mixed && habits[site.habit].first == "fruit";
  site.distance = std::max(1.5, uniform(random, 0.3, 0.6) * (is_orchard ? 5 : site.height));
  if (site.ground_density * site.area() > max_ground_points)
    site.trees_per_side = 2;
  return site;
}

struct Planted_tree
{
  std::string habit;
  Point foot;
  double diameter = 0; ///< at breast height [m]
  double height = 0;   ///< [m]
};

struct Virtual_stand
{
  std::vector<Planted_tree> trees;
  std::vector<Labelled_point> points;
  std::vector<Point> stations; ///< of the first tree
};

Planted_tree planted(const std::string& habit, const Point& foot, const Tree& tree)
{
  Planted_tree result{habit, foot};
  const double low = tree[0].point.z();
  for (const auto node : boost::make_iterator_range(vertices(tree)))
    result.height = std::max(result.height, tree[node].point.z() - low);
  for (const auto edge : boost::make_iterator_range(edges(tree))) {
    const auto &a = tree[source(edge, tree)], &b = tree[target(edge, tree)];
    const double from = a.point.z() - low, to = b.point.z() - low;
    if (b.branch == 0 && from <= breast_height && breast_height < to)
      result.diameter =
          2 * (a.radius + (b.radius - a.radius) * (breast_height - from) / (to - from));
  }
  return result;
}

/// Adds the tree of row `i` and column `j`, scanned from its own stations.
void add_tree(const Site& site, std::size_t i, std::size_t j, Random& random, Virtual_stand& stand)
{
  const auto habits = pcs::tree_habits();
  const double x = site.distance * (double(i) + uniform(random, -0.25, 0.25)),
               y = site.distance * (double(j) + uniform(random, -0.25, 0.25));
  const auto& [name, typical] = habits[site.is_mixed ? random() % habits.size() : site.habit];
  const double size = uniform(random, 0.7, 1.3);
  Tree tree;
  pcs::grow_tree(tree,
                 typical.scaled(name == "fruit" ? size : size * site.height / typical.height),
                 np::random_seed(100 * site.seed + 10 * i + j));
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = site.stations;
  scanner.distance = uniform(random, 5, 15);
  scanner.first_azimuth = uniform(random, 0, 2 * CGAL_PI);
  scanner.angular_step = site.angular_step;
  scanner.range_noise = 0.003;
  scanner.leaves_per_length = site.leaves;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner, np::random_seed(site.seed));
  const Point foot(x, y, site.ground(x, y));
  const Vector move = foot - tree[0].point;
  for (const Point& p : scan.points)
    stand.points.push_back({p + move, static_cast<int>(stand.trees.size())});
  if (stand.trees.empty())
    for (const Point& p : scan.stations)
      stand.stations.push_back(p + move);
  stand.trees.push_back(planted(name, foot, tree));
}

/// Adds a random object beside a random tree, turned about the tree, on the ground.
void add_object(const Site& site, Random& random, Virtual_stand& stand)
{
  const double spacing = 0.015 * site.coarseness; // of its points [m]
  const auto objects = pcs_bench::objects();
  const Point foot = stand.trees[random() % stand.trees.size()].foot;
  const double turn = uniform(random, 0, 2 * CGAL_PI), c = std::cos(turn), s = std::sin(turn);
  std::vector<Point> points;
  pcs_bench::Scene scene(random, stand.stations, spacing, points);
  objects[random() % objects.size()].second(scene);
  for (const Point& p : points) {
    const double x = foot.x() + c * p.x() - s * p.y(), y = foot.y() + s * p.x() + c * p.y();
    stand.points.push_back({Point(x, y, site.ground(x, y) + p.z())});
  }
}

/// Keeps the first point in each cube of side `size`.
void thin(double size, std::vector<Labelled_point>& points)
{
  std::set<std::array<long, 3>> cubes;
  const auto is_removed = [&](const Labelled_point& p) {
    std::array<long, 3> cube;
    for (int k = 0; k < 3; ++k)
      cube[static_cast<std::size_t>(k)] = static_cast<long>(std::floor(p.point[k] / size));
    return !cubes.insert(cube).second;
  };
  std::vector<Labelled_point> kept;
  for (const Labelled_point& p : points)
    if (!is_removed(p))
      kept.push_back(p);
  points.swap(kept);
}

Virtual_stand make_stand(const Site& site, Random random)
{
  Virtual_stand stand;
  for (std::size_t i = 0; i < site.trees_per_side; ++i)
    for (std::size_t j = 0; j < site.trees_per_side; ++j)
      add_tree(site, i, j, random, stand);
  const auto place = [&] { return uniform(random, site.low(), site.high()); };
  const auto number = [&](double density) {
    return static_cast<std::size_t>(density * site.area());
  };
  for (std::size_t k = 0; k < number(site.ground_density); ++k) {
    const double x = place(), y = place();
    const double z = site.ground(x, y) + uniform(random, -site.roughness, site.roughness);
    stand.points.push_back({Point(x, y, z)});
  }
  for (std::size_t k = 0; k < site.objects; ++k)
    add_object(site, random, stand);
  for (std::size_t k = 0; k < number(site.shrub_density); ++k) {
    const double x = place(), y = place(), size = uniform(random, 0.3, 1.2);
    for (int n = 0; n < 400; ++n) {
      const double u = x + size * uniform(random, -0.5, 0.5),
                   v = y + size * uniform(random, -0.5, 0.5);
      stand.points.push_back({Point(u, v, site.ground(u, v) + size * uniform(random, 0, 1))});
    }
  }
  for (double k = site.strays * double(stand.points.size()); k >= 1; --k) {
    const double x = place(), y = place();
    stand.points.push_back({Point(x, y, site.ground(x, y) - uniform(random, 0.05, 3))});
  }
  if (site.voxel > 0)
    thin(site.voxel, stand.points);
  return stand;
}

/// Trees of the stands of one kind [count].
struct Counts
{
  std::size_t stands = 0, trees = 0, found = 0, wrong = 0, wrong_with_warning = 0, false_trees = 0,
              false_with_warning = 0;

  void add(const Counts& other)
  {
    for (const auto member : {&Counts::stands,
                              &Counts::trees,
                              &Counts::found,
                              &Counts::wrong,
                              &Counts::wrong_with_warning,
                              &Counts::false_trees,
                              &Counts::false_with_warning})
      this->*member += other.*member;
  }
  std::vector<std::string> row(const std::string& name) const
  {
    std::vector<std::string> cells = {name};
    for (const std::size_t count :
         {stands, trees, found, wrong, wrong_with_warning, false_trees, false_with_warning})
      cells.push_back(std::to_string(count));
    return cells;
  }
};

/// Returns what is wrong with a segment that was found for a tree, or an empty text. `share` is the
/// fraction of the points of the tree in the segment.
std::string faults(const Planted_tree& truth, const pcs::Segmented_tree& result, double share)
{
  const double diameter = std::abs(result.diameter_at_breast_height - truth.diameter),
               height = std::abs(result.height - truth.height),
               foot = std::hypot(result.foot[0] - truth.foot.x(), result.foot[1] - truth.foot.y());
  std::string list;
  if (diameter > 0.1 * truth.diameter && diameter > 0.015)
    list += " diameter";
  if (height > 0.08 * truth.height)
    list += " height";
  if (foot > std::max(0.3, 0.6 * truth.diameter))
    list += " foot";
  if (share < 0.9)
    list += " points";
  return list;
}

/// Segments a stand and compares it with the truth. Lists wrong and false trees if `is_listed`.
Counts evaluate(const Site& site, Virtual_stand stand, bool is_listed)
{
  const pcs::Segmentation_report report =
      pcs::segment_trees(stand.points, Found_map(), np::point_map(Position_map()));
  const auto warnings = pcs::warnings_of_trees(report);
  // numbers of the points of each tree in each segment, and of each segment in each tree
  std::vector<std::map<std::size_t, std::size_t>> segments(stand.trees.size());
  std::vector<std::map<int, std::size_t>> contents(report.trees.size());
  for (const Labelled_point& p : stand.points) {
    if (p.truth >= 0)
      ++segments[static_cast<std::size_t>(p.truth)][p.found];
    if (p.truth >= 0 && p.found != pcs::npos)
      ++contents[p.found][p.truth];
  }
  const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto list =
      [&](const std::string& text, const pcs::Segmented_tree* tree, bool has_warning) {
        if (!is_listed)
          return;
        std::cerr << "seed " << site.seed << ": " << text;
        if (tree)
          std::cerr << "; segment: height " << tree->height << ", diameter "
                    << tree->diameter_at_breast_height << ", foot " << tree->foot[0] << ' '
                    << tree->foot[1] << ' ' << tree->foot[2] << ", " << tree->number_of_points
                    << " points" << (has_warning ? ", with a warning" : "");
        std::cerr << "; slope " << site.slope << ", ground " << site.ground_density
                  << ", roughness " << site.roughness << ", shrubs " << site.shrub_density
                  << ", strays " << site.strays << ", voxel " << site.voxel << ", leaves "
                  << site.leaves << ", distance " << site.distance << ", stations " << site.stations
                  << ", objects " << site.objects << ", " << stand.points.size() << " points\n";
      };
  Counts counts;
  counts.stands = 1;
  counts.trees = stand.trees.size();
  std::vector<char> is_true(report.trees.size(), 0);
  for (std::size_t t = 0; t < stand.trees.size(); ++t) {
    const Planted_tree& truth = stand.trees[t];
    std::size_t all = 0;
    for (const auto& [segment, count] : segments[t])
      all += count;
    segments[t].erase(pcs::npos);
    const auto best = std::max_element(segments[t].begin(), segments[t].end(), less);
    const std::string name =
        truth.habit + " of height " + pcs_bench::number(truth.height) + ", diameter " +
        pcs_bench::number(truth.diameter) + ", foot " + pcs_bench::number(truth.foot.x()) + ' ' +
        pcs_bench::number(truth.foot.y()) + ' ' + pcs_bench::number(truth.foot.z());
    // a segment stands for the tree with most of its points
    if (best == segments[t].end() ||
        std::max_element(contents[best->first].begin(), contents[best->first].end(), less)->first !=
            static_cast<int>(t)) {
      list("not found, " + name, nullptr, false);
      continue;
    }
    const auto [segment, count] = *best;
    is_true[segment] = 1;
    ++counts.found;
    const std::string wrong =
        faults(truth, report.trees[segment], double(count) / static_cast<double>(all));
    if (wrong.empty())
      continue;
    const bool has_warning = !warnings[segment].empty();
    ++counts.wrong;
    counts.wrong_with_warning += has_warning;
    list("wrong" + wrong + ", " + name, &report.trees[segment], has_warning);
  }
  for (std::size_t s = 0; s < report.trees.size(); ++s) {
    if (is_true[s])
      continue;
    const bool has_warning = !warnings[s].empty();
    ++counts.false_trees;
    counts.false_with_warning += has_warning;
    list("false tree", &report.trees[s], has_warning);
  }
  return counts;
}

/// Makes the stand of a seed, with coarser beams and objects while it has too many points.
Counts try_stand(Site site, const Random& random, bool is_listed)
{
  constexpr double coarser = 1.3;
  Virtual_stand stand = make_stand(site, random);
  while (stand.points.size() > max_points) {
    site.angular_step *= coarser;
    site.coarseness *= coarser;
    stand = make_stand(site, random);
  }
  return evaluate(site, std::move(stand), is_listed);
}

void print(const std::string& kind, const std::map<double, Counts>& counts)
{
  pcs_bench::Table table({kind,
                          "stands",
                          "trees",
                          "found",
                          "wrong",
                          "of these with a warning",
                          "false trees",
                          "of these with a warning"});
  Counts all;
  for (const auto& [value, c] : counts) {
    table.add(c.row(pcs_bench::number(value)));
    all.add(c);
  }
  table.add(all.row("all"));
  table.print(std::cout);
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Segments random virtual stands and compares the trees with the truth. A tree that "
               "was found is wrong if the error of the diameter at breast height is above 10 % and "
               "1.5 cm, that of the height above 8 %, that of the foot above 0.3 m and 0.6 "
               "diameters, or if the segment has fewer than 90 % of its points.");
  std::uint64_t first = 1;
  std::size_t count = 10;
  bool is_listed = false;
  app.add_option("--first-seed", first, "seed of the first stand")->capture_default_str();
  app.add_option("--stands", count, "number of stands")->capture_default_str();
  app.add_flag("--list", is_listed, "prints each wrong or false tree to standard error");
  CLI11_PARSE(app, argc, argv);
  try {
    std::map<double, Counts> by_slope, by_density;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
      Random random(seed);
      const Site site = random_site(seed, random);
      const Counts counts = try_stand(site, random, is_listed);
      by_slope[site.slope].add(counts);
      by_density[site.ground_density].add(counts);
    }
    print("slope", by_slope);
    print("ground / m2", by_density);
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "bench_stand_surroundings: " << e.what() << '\n';
    return 1;
  }
}

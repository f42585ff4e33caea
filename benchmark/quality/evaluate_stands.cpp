// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Segmentation of virtual stands on slopes, with sparse ground and shrubs, against the truth.

#include "support/Labelled_point.h"
#include "support/Table.h"
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/range/iterator_range.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <random>
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
namespace np = pcs::parameters;

namespace {

constexpr double breast_height = 1.3;

/// How a stand is made. Lengths in metres.
struct Site
{
  double slope = 0;          ///< height / horizontal distance [-]
  double ground_density = 0; ///< points of the ground per square metre
  double shrub_density = 0;  ///< shrubs per square metre
  double strays = 0;         ///< stray points below the ground / other points [-]
  std::size_t trees_per_side = 3;
  double distance = 4.5; ///< of trees
};

struct Planted_tree
{
  Point foot;
  double diameter = 0; ///< at breast height [m]
};

struct Virtual_stand
{
  std::vector<Planted_tree> trees;
  std::vector<Labelled_point> points;
};

double diameter_of(const Tree& tree)
{
  const double height = tree[0].point.z() + breast_height;
  for (const auto edge : boost::make_iterator_range(edges(tree))) {
    const auto &a = tree[source(edge, tree)], &b = tree[target(edge, tree)];
    if (b.branch == 0 && a.point.z() <= height && height < b.point.z())
      return 2 * (a.radius +
                  (b.radius - a.radius) * (height - a.point.z()) / (b.point.z() - a.point.z()));
  }
  return 0;
}

void add_tree(const Point& foot, std::uint64_t seed, Virtual_stand& stand)
{
  const std::vector<pcs::Tree_habit> habits = {pcs::broadleaf_habit(),
                                               pcs::conifer_habit(),
                                               pcs::forked_habit()};
  Tree tree;
  pcs::grow_tree(tree, habits[seed % habits.size()], np::random_seed(seed));
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = 3;
  scanner.distance = 10;
  scanner.angular_step = 0.15 * CGAL_PI / 180;
  scanner.range_noise = 0.004;
  scanner.leaves_per_length = seed % 2 == 0 ? 8 : 0;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner, np::random_seed(seed));
  const Vector move = foot - tree[0].point;
  for (const Point& p : scan.points)
    stand.points.push_back({p + move, static_cast<int>(stand.trees.size())});
  stand.trees.push_back({foot, diameter_of(tree)});
}

Virtual_stand make_stand(const Site& site, std::uint64_t seed)
{
  Virtual_stand stand;
  std::mt19937_64 random(seed);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) / 9007199254740992.0;
  };
  const auto ground = [&](double x, double y) { // with undulations of 0.15 m
    return site.slope * x + 0.15 * std::sin(0.7 * x) * std::cos(0.9 * y);
  };
  for (std::size_t i = 0; i < site.trees_per_side; ++i)
    for (std::size_t j = 0; j < site.trees_per_side; ++j) {
      const double x = site.distance * (static_cast<double>(i) + uniform(-.2, .2)),
                   y = site.distance * (static_cast<double>(j) + uniform(-.2, .2));
      add_tree(Point(x, y, ground(x, y)), 100 * seed + 10 * i + j, stand);
    }
  const double low = -site.distance,
               high = site.distance * static_cast<double>(site.trees_per_side),
               area = (high - low) * (high - low);
  const auto number = [&](double density) { return static_cast<std::size_t>(density * area); };
  for (std::size_t k = 0; k < number(site.ground_density); ++k) {
    const double x = uniform(low, high), y = uniform(low, high);
    stand.points.push_back({Point(x, y, ground(x, y) + uniform(-.02, .02))});
  }
  for (std::size_t k = 0; k < number(site.shrub_density); ++k) {
    const double x = uniform(low, high), y = uniform(low, high), size = uniform(.4, 1.2);
    for (int n = 0; n < 400; ++n) {
      const Point p(x + size * uniform(-.5, .5), y + size * uniform(-.5, .5), 0);
      stand.points.push_back({Point(p.x(), p.y(), ground(p.x(), p.y()) + size * uniform(0, 1))});
    }
  }
  for (double k = site.strays * double(stand.points.size()); k >= 1; --k) {
    const double x = uniform(low, high), y = uniform(low, high);
    stand.points.push_back({Point(x, y, ground(x, y) - uniform(0.05, 3.05))});
  }
  return stand;
}

/// Values of one stand, or of several.
struct Result
{
  std::size_t trees = 0, found = 0, false_trees = 0;
  std::size_t number_of_points = 0, points_of_trees = 0, right = 0;
  std::size_t others = 0, others_in_trees = 0; ///< points of ground and shrubs
  std::vector<double> diameter_errors;         ///< relative
  std::size_t warnings = 0;
};

void evaluate(Virtual_stand stand, Result& result)
{
  const pcs::Segmentation_report report =
      pcs::segment_trees(stand.points, Found_map(), np::point_map(Position_map()));
  // for each true tree the number of its points in each segment
  std::vector<std::map<std::size_t, std::size_t>> shared(stand.trees.size());
  std::vector<std::map<int, std::size_t>> contents(report.trees.size());
  for (const Labelled_point& p : stand.points) {
    if (p.truth >= 0)
      ++shared[static_cast<std::size_t>(p.truth)][p.found];
    else {
      ++result.others;
      result.others_in_trees += p.found != pcs::npos;
    }
    if (p.found != pcs::npos)
      ++contents[p.found][p.truth];
  }
  result.number_of_points += stand.points.size();
  result.warnings += warnings(report).size();
  std::vector<char> is_true(report.trees.size(), 0);
  for (std::size_t t = 0; t < stand.trees.size(); ++t) {
    std::size_t best = pcs::npos, most = 0;
    for (const auto& [segment, count] : shared[t]) {
      result.points_of_trees += count;
      if (segment != pcs::npos && count > most) {
        most = count;
        best = segment;
      }
    }
    ++result.trees;
    if (best == pcs::npos)
      continue;
    result.right += most;
    // a segment stands for the tree with most of its points
    int owner = -1;
    std::size_t largest = 0;
    for (const auto& [tree, count] : contents[best])
      if (count > largest) {
        largest = count;
        owner = tree;
      }
    if (owner != static_cast<int>(t))
      continue;
    is_true[best] = 1;
    ++result.found;
    result.diameter_errors.push_back(
        std::abs(report.trees[best].diameter_at_breast_height / stand.trees[t].diameter - 1));
  }
  result.false_trees +=
      static_cast<std::size_t>(std::count(is_true.begin(), is_true.end(), char(0)));
}

std::string percent(std::size_t part, std::size_t whole)
{
  return pcs_bench::number(100.0 * static_cast<double>(part) / static_cast<double>(whole), 4) +
         " %";
}

int run(std::uint64_t seed, std::size_t count, double strays)
{
  pcs_bench::Table table({"slope",
                          "ground / m2",
                          "shrubs / m2",
                          "points",
                          "found / true",
                          "false",
                          "right",
                          "others in trees",
                          "diameter, median",
                          "diameter, largest",
                          "warnings"});
  for (const double slope : {0.0, 0.3, 0.6})
    for (const double density : {3.0, 7.0, 50.0})
      for (const double shrubs : {0.0, 0.3}) {
        Result r;
        for (std::size_t k = 0; k < count; ++k)
          evaluate(make_stand({slope, density, shrubs, strays}, seed + k), r);
        std::sort(r.diameter_errors.begin(), r.diameter_errors.end());
        const auto& e = r.diameter_errors;
        table.add({pcs_bench::number(slope, 2),
                   pcs_bench::number(density, 2),
                   pcs_bench::number(shrubs, 2),
                   std::to_string(r.number_of_points),
                   std::to_string(r.found) + " / " + std::to_string(r.trees),
                   std::to_string(r.false_trees),
                   percent(r.right, r.points_of_trees),
                   percent(r.others_in_trees, r.others),
                   e.empty() ? "-" : pcs_bench::number(100 * e[e.size() / 2], 2) + " %",
                   e.empty() ? "-" : pcs_bench::number(100 * e.back(), 2) + " %",
                   std::to_string(r.warnings)});
      }
  table.print(std::cout);
  return 0;
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Segments virtual stands on slopes, and compares the trees with the truth.");
  std::uint64_t seed = 1;
  std::size_t count = 2;
  double strays = 0;
  app.add_option("--seed", seed, "seed of the first stand of each kind")->capture_default_str();
  app.add_option("--stands", count, "number of stands of each kind")->capture_default_str();
  app.add_option("--strays", strays, "points down to 3 m below the ground, relative to all others")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return run(seed, count, strays);
  } catch (const std::exception& e) {
    std::cerr << "evaluate_stands: " << e.what() << '\n';
    return 1;
  }
}

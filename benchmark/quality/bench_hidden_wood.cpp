// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Error of the volume of virtual trees that are scanned from few stations, before and after hidden
// wood is completed, and the share of the intervals that contain the true volume.

#include "support/Table.h"
#include <pcs/core/Tree_measures.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/complete_hidden_wood.h>
#include <pcs/generators/fit_tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/internal/Random_stream.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
namespace np = pcs::parameters;

namespace {

using Labelled_point = std::pair<Kernel::Point_3, int>;
using Point_of = CGAL::First_of_pair_property_map<Labelled_point>;
using Station_of = CGAL::Second_of_pair_property_map<Labelled_point>;

struct Run
{
  std::string preset, leaves;
  double truth = 0;
  pcs::Hidden_wood<Kernel> wood;

  double before() const { return wood.measured_volume / truth - 1; }
  double after() const { return wood.total_volume.value / truth - 1; }
  bool is_covered() const
  {
    return wood.total_volume.least <= truth && truth <= wood.total_volume.largest;
  }
};

/// The scanner of a seed; a fruit tree is scanned from a smaller distance.
pcs::Virtual_scanner
scanner_of(std::uint64_t seed, const std::string& preset, std::size_t stations, double leaves)
{
  pcs::internal::Random_stream random(seed, 100);
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = stations;
  scanner.distance = random.uniform(7, 11) * (preset == "fruit" ? 0.6 : 1);
  scanner.angular_step = random.uniform(0.06, 0.1) * CGAL_PI / 180;
  scanner.first_azimuth = random.uniform(0, 2 * CGAL_PI);
  scanner.leaves_per_length = leaves;
  return scanner;
}

/// Every third group of five trees has leaves.
Run run(std::uint64_t first, std::size_t k, std::size_t stations)
{
  constexpr double smallest_radius = 0.004, radius_error = 0.05;
  const auto habits = pcs::tree_habits();
  const auto& [preset, habit] = habits[k % habits.size()];
  const double leaves = (k / habits.size()) % 3 == 2 ? 10 : 0;
  const std::uint64_t seed = first + k;
  Tree truth, tree;
  pcs::grow_tree(truth, habit, np::random_seed(seed));
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(truth, scan, scanner_of(seed, preset, stations, leaves), np::random_seed(seed));
  pcs::extract_tree_skeleton(scan.points, tree);
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].radius_error = radius_error * tree[v].radius;
  const auto fit =
      pcs::fit_tree_habit(std::vector<Tree>{tree},
                          np::smallest_radius(smallest_radius).number_of_simulations(20));
  std::vector<Labelled_point> points;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    points.emplace_back(scan.points[i], scan.station[i]);
  return {
      preset,
      leaves > 0 ? "yes" : "no",
      pcs::measure_tree(truth).volume,
      pcs::complete_hidden_wood(
          tree,
          points,
          fit,
          np::scanner_positions(scan.stations).point_map(Point_of()).station_map(Station_of()))};
}

std::string percent(double value)
{
  return (value > 0 ? "+" : "") + pcs_bench::number(100 * value, 2);
}

void print(const std::vector<Run>& runs, std::uint64_t first)
{
  pcs_bench::Table table({"seed",
                          "preset",
                          "leaves",
                          "before [%]",
                          "hidden branches [%]",
                          "stems [%]",
                          "radii [%]",
                          "after [%]",
                          "95 % interval [%]",
                          "holds"});
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Run& r = runs[k];
    table.add({std::to_string(first + k),
               r.preset,
               r.leaves,
               percent(r.before()),
               percent(r.wood.hidden_branches.value / r.truth),
               percent(r.wood.missing_stems.value / r.truth),
               percent(r.wood.radius_correction.value / r.truth),
               percent(r.after()),
               percent(r.wood.total_volume.least / r.truth - 1) + " to " +
                   percent(r.wood.total_volume.largest / r.truth - 1),
               r.is_covered() ? "yes" : "no"});
  }
  table.print(std::cout);
}

/// One line for each kind of tree, and for all.
void print_means(const std::vector<Run>& runs)
{
  pcs_bench::Table table({"trees",
                          "number",
                          "mean before [%]",
                          "mean after [%]",
                          "mean absolute before [%]",
                          "mean absolute after [%]",
                          "intervals that hold [%]"});
  const auto add = [&](const std::string& name, const auto& is_counted) {
    double n = 0, before = 0, after = 0, size_before = 0, size_after = 0, covered = 0;
    for (const Run& r : runs)
      if (is_counted(r)) {
        n += 1;
        before += r.before();
        after += r.after();
        size_before += std::abs(r.before());
        size_after += std::abs(r.after());
        covered += r.is_covered() ? 1 : 0;
      }
    if (n > 0)
      table.add({name,
                 std::to_string(static_cast<int>(n)),
                 percent(before / n),
                 percent(after / n),
                 pcs_bench::number(100 * size_before / n, 2),
                 pcs_bench::number(100 * size_after / n, 2),
                 pcs_bench::number(100 * covered / n, 3)});
  };
  for (const auto& [preset, habit] : pcs::tree_habits())
    add(preset, [name = preset](const Run& r) { return r.preset == name; });
  add("with leaves", [](const Run& r) { return r.leaves == "yes"; });
  add("all", [](const Run&) { return true; });
  table.print(std::cout);
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Prints errors of the volume of virtual trees before and after hidden wood is "
               "completed.");
  std::uint64_t first = 85000001;
  std::size_t count = 30, stations = 1;
  app.add_option("--first-seed", first, "seed of the first tree")->capture_default_str();
  app.add_option("--trees", count, "number of trees")->capture_default_str();
  app.add_option("--stations", stations, "stations around each tree")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    std::vector<Run> runs;
    for (std::size_t k = 0; k < count; ++k)
      runs.push_back(run(first, k, stations));
    print(runs, first);
    std::cout << '\n';
    print_means(runs);
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "bench_hidden_wood: " << e.what() << '\n';
    return 1;
  }
}

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeletons of virtual scans with objects near the tree: how often height, diameter and volume are
// right, and how often a wrong value has a warning.

#include "support/Table.h"
#include "support/virtual_objects.h"
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/range/iterator_range.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Tree = pcs::Tree_skeleton<Kernel>;
using pcs_bench::Random;
using pcs_bench::Scene;
using pcs_bench::uniform;
namespace np = pcs::parameters;

namespace {

/// Height, diameter at breast height and volume of a tree.
struct Values
{
  double height = 0, diameter = 0, volume = 0;
};

Values true_values(const Tree& tree)
{
  constexpr double breast_height = 1.3;
  Values v;
  const double foot = tree[0].point.z();
  for (const auto node : boost::make_iterator_range(vertices(tree)))
    v.height = std::max(v.height, tree[node].point.z() - foot);
  for (const auto edge : boost::make_iterator_range(edges(tree))) {
    const auto s = source(edge, tree), t = target(edge, tree);
    const double b = tree[t].radius, a = tree[s].branch == tree[t].branch ? tree[s].radius : b;
    const double low = tree[s].point.z() - foot, high = tree[t].point.z() - foot;
    if (tree[t].branch == 0 && low <= breast_height && breast_height < high)
      v.diameter = 2 * (a + (b - a) * (breast_height - low) / (high - low));
    v.volume += CGAL_PI / 3 * std::sqrt(CGAL::squared_distance(tree[s].point, tree[t].point)) *
                (a * a + a * b + b * b);
  }
  return v;
}

/// Scanner, leaves and ground of a scene.
pcs::Virtual_scanner scanner_of(Random& random)
{
  const auto one_of = [&](const std::vector<double>& list) { return list[random() % list.size()]; };
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = static_cast<std::size_t>(one_of({1, 2, 3, 4}));
  scanner.distance = one_of({6, 10, 14});
  scanner.first_azimuth = uniform(random, 0, 2 * CGAL_PI);
  scanner.angular_step = one_of({0.08, 0.12, 0.16}) * CGAL_PI / 180;
  scanner.range_noise = one_of({0.001, 0.002, 0.004});
  scanner.leaves_per_length = one_of({0, 0, 0, 10});
  scanner.ground_radius = std::min(one_of({0, 3, 5, 8}), scanner.distance - 2); // no station on it
  scanner.ground_roughness = one_of({0.01, 0.03, 0.06});
  return scanner;
}

/// Results for the scenes of one kind [count].
struct Counts
{
  std::size_t scenes = 0, right = 0, right_with_warning = 0, wrong_with_warning = 0, silent = 0;

  void add(bool is_right, bool has_warning)
  {
    ++scenes;
    right += is_right;
    right_with_warning += is_right && has_warning;
    wrong_with_warning += !is_right && has_warning;
    silent += !is_right && !has_warning;
  }
  std::vector<std::string> row(const std::string& name) const
  {
    return {name,
            std::to_string(scenes),
            std::to_string(right),
            std::to_string(right_with_warning),
            std::to_string(wrong_with_warning),
            std::to_string(silent)};
  }
};

/// Extracts the tree of a scene. Lists it if `is_listed`.
void try_scene(const std::string& name,
               const std::function<void(Scene&)>& place,
               std::uint64_t seed,
               std::size_t number_of_resamples,
               bool is_listed,
               Counts& counts)
{
  const auto habits = pcs::tree_habits();
  Random random(seed);
  Tree tree;
  pcs::grow_tree(tree, habits[seed % habits.size()].second, np::random_seed(seed));
  const pcs::Virtual_scanner scanner = scanner_of(random);
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner, np::random_seed(seed));
  std::vector<Point> objects;
  Scene scene(random, scan.stations, scanner.distance * scanner.angular_step, objects);
  place(scene);
  for (const Point& p : objects)
    scan.points.push_back(p + (tree[0].point - CGAL::ORIGIN));
  Tree result;
  const pcs::Skeleton_report report =
      pcs::extract_tree_skeleton(scan.points, result, np::number_of_resamples(number_of_resamples));
  const Values truth = true_values(tree);
  const double height = report.height / truth.height - 1,
               diameter = report.diameter_at_breast_height / truth.diameter - 1,
               volume = report.total.volume / truth.volume - 1;
  const bool is_right =
      std::abs(height) < 0.06 && std::abs(diameter) < 0.1 && volume > -0.35 && volume < 0.3;
  const std::vector<std::string> warnings = pcs::warnings(report);
  counts.add(is_right, !warnings.empty());
  if (!is_listed)
    return;
  std::cerr << name << ", seed " << seed << (is_right ? ": right" : ": wrong")
            << "; errors of height " << 100 * height << ", diameter " << 100 * diameter
            << ", volume " << 100 * volume << " %; " << scan.points.size() << " points, "
            << objects.size() << " of objects; ground " << scanner.ground_radius << " m\n";
  for (const std::string& warning : warnings)
    std::cerr << "    " << warning << '\n';
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app(
      "Extracts the skeletons of virtual trees with objects beside them. A result is right "
      "if the errors of the height and of the diameter at breast height are below 6 and "
      "10 %, and that of the volume is between -35 and +30 %.");
  std::uint64_t first = 52000;
  std::size_t count = 5, number_of_resamples = 4;
  std::vector<std::string> only;
  bool is_listed = false;
  app.add_option("--first-seed", first, "seed of the first scene")->capture_default_str();
  app.add_option("--scenes", count, "number of scenes with each object")->capture_default_str();
  app.add_option("--resamples", number_of_resamples, "resampled copies of each scan")
      ->capture_default_str();
  app.add_option("--only", only, "names of the objects that are tried, such as fence");
  app.add_flag("--list", is_listed, "prints each scene to standard error");
  CLI11_PARSE(app, argc, argv);
  try {
    pcs_bench::Table table({"object",
                            "scenes",
                            "right",
                            "of these with a warning",
                            "wrong with a warning",
                            "wrong without a warning"});
    Counts all;
    for (const auto& [name, place] : pcs_bench::objects()) {
      if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end())
        continue;
      Counts counts;
      for (std::size_t k = 0; k < count; ++k)
        try_scene(name, place, first + k, number_of_resamples, is_listed, counts);
      table.add(counts.row(name));
      for (const auto member : {&Counts::scenes,
                                &Counts::right,
                                &Counts::right_with_warning,
                                &Counts::wrong_with_warning,
                                &Counts::silent})
        all.*member += counts.*member;
    }
    table.add(all.row("all"));
    table.print(std::cout);
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "bench_skeleton_surroundings: " << e.what() << '\n';
    return 1;
  }
}

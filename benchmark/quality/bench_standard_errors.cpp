// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Calibration of the standard errors of skeletons: fraction of virtual trees whose true value lies
// within two standard errors. Each seed gives another tree, scanner and number of leaves. For real
// scans, whose true values are unknown, random halves of a scan are compared with the whole scan.

#include "support/Table.h"
#include <pcs/IO/read_points.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/internal/Random_stream.h>

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
#include <random>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
namespace np = pcs::parameters;

namespace {

constexpr std::size_t number_of_classes = 5, number_of_values = 6 + number_of_classes;
const std::array<const char*, number_of_values> names = {"height",
                                                         "diameter at breast height",
                                                         "length of the trunk",
                                                         "length, scanned branches",
                                                         "volume",
                                                         "volume of the trunk",
                                                         "volume, radius below 5 mm",
                                                         "volume, 5 to 10 mm",
                                                         "volume, 1 to 2 cm",
                                                         "volume, 2 to 5 cm",
                                                         "volume, above 5 cm"};
using Values = std::array<double, number_of_values>;

/// Known values of a virtual tree.
Values true_values(const Tree& tree, const std::vector<std::size_t>& hits)
{
  constexpr std::array<double, number_of_classes - 1> bounds = {0.005, 0.01, 0.02, 0.05};
  constexpr double breast_height = 1.3;
  Values v{};
  const double foot = tree[0].point.z();
  for (const auto node : boost::make_iterator_range(vertices(tree)))
    v[0] = std::max(v[0], tree[node].point.z() - foot);
  for (const auto edge : boost::make_iterator_range(edges(tree))) {
    const auto s = source(edge, tree), t = target(edge, tree);
    const bool is_trunk = tree[t].branch == 0;
    const double b = tree[t].radius, a = tree[s].branch == tree[t].branch ? tree[s].radius : b;
    const double length = std::sqrt(CGAL::squared_distance(tree[s].point, tree[t].point));
    const double volume = CGAL_PI * length * (a * a + a * b + b * b) / 3;
    const double low = tree[s].point.z() - foot, high = tree[t].point.z() - foot;
    if (is_trunk && low <= breast_height && breast_height < high)
      v[1] = 2 * (a + (b - a) * (breast_height - low) / (high - low));
    v[2] += is_trunk ? length : 0;
    v[3] += hits[t] > 0 ? length : 0;
    v[4] += volume;
    v[5] += is_trunk ? volume : 0;
    const auto size = std::upper_bound(bounds.begin(), bounds.end(), 0.5 * (a + b));
    v[6 + static_cast<std::size_t>(size - bounds.begin())] += volume;
  }
  return v;
}

/// Estimates or standard errors.
Values values_of(const pcs::Tree_values& e)
{
  Values v =
      {e.height, e.diameter_at_breast_height, e.trunk_length, e.length, e.volume, e.trunk_volume};
  for (std::size_t k = 0; k < std::min(number_of_classes, e.volume_by_size.size()); ++k)
    v[6 + k] = e.volume_by_size[k];
  return v;
}

/// Scanner and leaves of a seed.
pcs::Virtual_scanner scanner_of(std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  const auto one_of = [&](const std::vector<double>& list) { return list[random() % list.size()]; };
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = static_cast<std::size_t>(one_of({1, 2, 3, 4, 6}));
  scanner.distance = one_of({6, 10, 14});
  scanner.angular_step = one_of({0.1, 0.15, 0.2}) * CGAL_PI / 180;
  scanner.range_noise = one_of({0.001, 0.002, 0.004});
  scanner.leaves_per_length = one_of({0, 0, 8, 20});
  scanner.azimuth_range = one_of({1, 2 * 3.14159, 2 * 3.14159});
  return scanner;
}

struct Coverage
{
  std::size_t number_of_trees = 0, number_within = 0;
  std::vector<double> relative_errors; ///< standard errors / values
};

/// Adds the values of a skeleton, and the reference values.
void add(const pcs::Skeleton_report& report,
         const Values& reference,
         std::array<Coverage, number_of_values>& coverage)
{
  const Values found = values_of(report.estimates),
               errors = values_of(pcs::standard_errors(report));
  for (std::size_t k = 0; k < number_of_values; ++k) {
    if (!(reference[k] > 0) || !(found[k] > 0))
      continue;
    ++coverage[k].number_of_trees;
    coverage[k].number_within += std::abs(found[k] - reference[k]) <= 2 * errors[k];
    coverage[k].relative_errors.push_back(errors[k] / found[k]);
  }
}

pcs::Skeleton_report extract(const std::vector<Kernel::Point_3>& points)
{
  Tree result;
  return pcs::extract_tree_skeleton(points, result, np::number_of_resamples(4));
}

/// Adds the tree of a seed.
void add_virtual_tree(std::uint64_t seed, std::array<Coverage, number_of_values>& coverage)
{
  const auto habits = pcs::tree_habits();
  Tree tree;
  pcs::grow_tree(tree, habits[seed % habits.size()].second, np::random_seed(seed));
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner_of(seed), np::random_seed(seed));
  const pcs::Skeleton_report report = extract(scan.points);
  if (report.spread.number_of_copies < 2)
    std::cerr << "seed " << seed << ": no tree\n";
  else
    add(report, true_values(tree, scan.hits), coverage);
}

/// Adds four random halves of a scan; the values of the whole scan are the reference.
void add_halves(const std::string& file, std::array<Coverage, number_of_values>& coverage)
{
  const std::vector<Kernel::Point_3> points = pcs::IO::read_points(file).points();
  const pcs::Skeleton_report whole = extract(points);
  if (whole.spread.number_of_copies < 2) {
    std::cerr << file << ": no tree\n";
    return;
  }
  for (std::uint64_t half = 0; half < 4; ++half) {
    std::vector<Kernel::Point_3> kept;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (pcs::internal::Random_stream(1000 + half, i).uniform() < 0.5)
        kept.push_back(points[i]);
    const pcs::Skeleton_report report = extract(kept);
    if (report.spread.number_of_copies >= 2)
      add(report, values_of(whole.estimates), coverage);
  }
}

void print(std::array<Coverage, number_of_values>& coverage)
{
  pcs_bench::Table table({"value", "trees", "within 2 standard errors", "median standard error"});
  for (std::size_t k = 0; k < number_of_values; ++k) {
    Coverage& c = coverage[k];
    if (c.number_of_trees == 0)
      continue;
    std::sort(c.relative_errors.begin(), c.relative_errors.end());
    const double median = c.relative_errors[c.relative_errors.size() / 2];
    table.add({names[k],
               std::to_string(c.number_of_trees),
               std::to_string(100 * c.number_within / c.number_of_trees) + " %",
               pcs_bench::number(100 * median, 2) + " %"});
  }
  table.print(std::cout);
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Prints how often the true values of virtual trees lie within two standard errors. "
               "With scans: how often the values of a scan lie within two standard errors of those "
               "of its random halves.");
  std::uint64_t first = 20000;
  std::size_t count = 100;
  std::vector<std::string> files;
  app.add_option("--first-seed", first, "seed of the first tree")->capture_default_str();
  app.add_option("--trees", count, "number of trees")->capture_default_str();
  app.add_option("scans", files, "scans of single trees, z up, in metres; no virtual trees");
  CLI11_PARSE(app, argc, argv);
  try {
    std::array<Coverage, number_of_values> coverage;
    for (const std::string& file : files)
      add_halves(file, coverage);
    for (std::size_t k = 0; k < count && files.empty(); ++k)
      add_virtual_tree(first + k, coverage);
    print(coverage);
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "bench_standard_errors: " << e.what() << '\n';
    return 1;
  }
}

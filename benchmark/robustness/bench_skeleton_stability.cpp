// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stability of skeletons: spread of height, diameter, length and volume over nearly identical
// copies of each scan.

#include "support/Table.h"
#include <pcs/IO/read_points.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/internal/Random_stream.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Points = std::vector<Kernel::Point_3>;
namespace np = pcs::parameters;

namespace {

/// Estimates of a tree, and values of its skeleton.
struct Measures
{
  double height = 0, diameter = 0, trunk = 0, length = 0, volume = 0;
  double skeleton_volume = 0, leaves = 0;
  Kernel::Point_3 root{0, 0, 0}; ///< in the frame of the original scan
  std::size_t number_of_warnings = 0;
  bool has_root = false;
};

/// A copy of a scan, and its rotation about the z-axis [rad].
struct Copy
{
  std::string name;
  Points points;
  double angle = 0;
};

/// Uniform in [0, 1); independent of the order of calls.
double uniform(std::uint64_t seed, std::uint64_t i)
{
  return double(pcs::internal::mix_bits(seed * 0x9e3779b97f4a7c15ull + i) >> 11) * 0x1p-53;
}

Points displaced(const Points& points, double largest, std::uint64_t seed)
{
  Points result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto d = [&](std::uint64_t k) { return largest * (2 * uniform(seed, 3 * i + k) - 1); };
    const double x = d(0), y = d(1), z = d(2);
    result.emplace_back(points[i].x() + x, points[i].y() + y, points[i].z() + z);
  }
  return result;
}

Points thinned(const Points& points, double kept, std::uint64_t seed)
{
  Points result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (uniform(seed, i) < kept)
      result.push_back(points[i]);
  return result;
}

Kernel::Point_3 rotated(const Kernel::Point_3& p, double angle)
{
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()};
}

/// The scan and its copies; displacements are in metres.
std::vector<Copy> copies_of(const Points& points)
{
  std::vector<Copy> result{{"as it is", points}};
  Points floats;
  for (const auto& p : points)
    floats.emplace_back(double(float(p.x())), double(float(p.y())), double(float(p.z())));
  result.push_back({"32-bit floats", floats});
  result.push_back({"10 um", displaced(points, 1e-5, 1)});
  result.push_back({"50 um", displaced(points, 5e-5, 2)});
  result.push_back({"0.5 mm", displaced(points, 5e-4, 3)});
  const double angle = 40 * CGAL_PI / 180;
  Points turned;
  for (const auto& p : points)
    turned.push_back(rotated(p, angle));
  result.push_back({"turned by 40 degrees", turned, angle});
  result.push_back({"99 %", thinned(points, 0.99, 4)});
  result.push_back({"95 %", thinned(points, 0.95, 5)});
  return result;
}

Measures measure(const Copy& copy, std::size_t number_of_resamples)
{
  pcs::Tree_skeleton<Kernel> tree;
  const pcs::Skeleton_report report =
      pcs::extract_tree_skeleton(copy.points, tree, np::number_of_resamples(number_of_resamples));
  Measures m;
  m.height = report.estimates.height;
  m.diameter = report.estimates.diameter_at_breast_height;
  m.trunk = report.estimates.trunk_length;
  m.length = report.estimates.length;
  m.volume = report.estimates.volume;
  m.skeleton_volume = report.total.volume;
  m.leaves = double(report.number_of_leaf_points) / double(copy.points.size());
  m.number_of_warnings = pcs::warnings(report).size();
  m.has_root = num_vertices(tree) > 0;
  if (m.has_root)
    m.root = rotated(tree[0].point, -copy.angle);
  return m;
}

/// Largest difference of a copy from the unmodified scan, as a fraction of the value of the latter.
/// The copy with 95 % of the points is excluded.
double spread(const std::vector<Measures>& all, double Measures::*member)
{
  double largest = 0;
  for (std::size_t c = 1; c + 1 < all.size(); ++c)
    largest = std::max(largest, std::abs(all[c].*member - all[0].*member));
  return all[0].*member > 0 ? largest / all[0].*member : largest;
}

} // namespace

int main(int argc, char** argv)
{
  std::vector<std::string> files;
  std::size_t number_of_resamples = 4;
  bool is_detailed = false;
  CLI::App app("Extracts the skeleton of each scan and of nearly identical copies: 32-bit floats, "
               "moved by at most 10 um, "
               "50 um and 0.5 mm, turned by 40 degrees, 99 % and 95 % of the points. Prints the "
               "largest difference from "
               "the scan as it is, without the copy of 95 %.",
               "bench_skeleton_stability");
  app.add_option("scans", files, "scans of single trees, z up, in metres")->required();
  app.add_option("--resamples",
                 number_of_resamples,
                 "resampled copies of each scan, as of the "
                 "program extract_tree_skeleton")
      ->capture_default_str();
  app.add_flag("--all", is_detailed, "print the measures of each copy, too");
  CLI11_PARSE(app, argc, argv);
  pcs_bench::Table table({"scan",
                          "DBH m",
                          "spread m",
                          "height",
                          "trunk",
                          "length",
                          "volume",
                          "of skeleton",
                          "leaves",
                          "root m",
                          "warnings"});
  pcs_bench::Table details({"scan",
                            "copy",
                            "height m",
                            "DBH m",
                            "trunk m",
                            "length m",
                            "volume m3",
                            "of skeleton",
                            "leaves %",
                            "root z",
                            "warnings"});
  try {
    for (const std::string& file : files) {
      const std::string name = std::filesystem::path(file).stem().string();
      std::vector<Measures> all;
      for (const Copy& copy : copies_of(pcs::IO::read_points(file).points())) {
        all.push_back(measure(copy, number_of_resamples));
        const Measures& m = all.back();
        details.add({name,
                     copy.name,
                     pcs_bench::number(m.height, 4),
                     pcs_bench::number(m.diameter),
                     pcs_bench::number(m.trunk),
                     pcs_bench::number(m.length),
                     pcs_bench::number(m.volume),
                     pcs_bench::number(m.skeleton_volume),
                     pcs_bench::number(100 * m.leaves),
                     pcs_bench::number(m.root.z(), 4),
                     std::to_string(m.number_of_warnings)});
      }
      double moved = 0;
      for (std::size_t c = 1; c + 1 < all.size(); ++c)
        moved = std::max(moved, std::sqrt(CGAL::squared_distance(all[c].root, all[0].root)));
      const auto percent = [&](double Measures::*member) {
        return pcs_bench::number(100 * spread(all, member), 2) + " %";
      };
      table.add({name,
                 pcs_bench::number(all[0].diameter),
                 pcs_bench::number(all[0].diameter * spread(all, &Measures::diameter), 2),
                 percent(&Measures::height),
                 percent(&Measures::trunk),
                 percent(&Measures::length),
                 percent(&Measures::volume),
                 percent(&Measures::skeleton_volume),
                 percent(&Measures::leaves),
                 pcs_bench::number(moved, 2),
                 std::to_string(all[0].number_of_warnings)});
    }
  } catch (const std::exception& error) {
    std::cerr << "bench_skeleton_stability: " << error.what() << '\n';
    return 1;
  }
  table.print(std::cout);
  if (is_detailed)
    details.print(std::cout);
}

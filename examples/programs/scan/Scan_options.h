// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The command line of the program virtual_scan.

#ifndef PCS_EXAMPLES_PROGRAMS_SCAN_SCAN_OPTIONS_H
#define PCS_EXAMPLES_PROGRAMS_SCAN_SCAN_OPTIONS_H

#include "common/Distinct_files.h"
#include "common/is_seed.h"
#include <pcs/core/errors.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Virtual_scanner.h>

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace program {

struct Scan_options
{
  std::string output, truth, swc, report, tree;
  std::string preset = "broadleaf";
  std::int64_t stations = 4, seed = 0;
  std::optional<double> height;
  std::size_t root_number = 1; ///< of the tree in the file of `tree`
  double age = 1;
  double step_degrees = 0.05, arc_degrees = 360, first_degrees = 0, beam_milliradians = 0.4;
  pcs::Virtual_scanner scanner;
  bool has_post = false, is_quiet = false;
  std::vector<std::size_t> pruned;
  std::vector<double> turned_numbers, lengthened_numbers; // id, value, id, value, ...
  std::vector<std::pair<std::size_t, double>> turned, lengthened;
};

inline const char* scan_help()
{
  return R"(scan.ply has the properties `int node`, the index of the node of the tree that the
point lies on (-1: ghost or outlier, -2: ground, -3: leaf, -4: post), and `int station`.
truth.csv has one row for each node: id,parent,branch,order,x,y,z,r,a,b,hits; r is the radius
of the circle with the area of the section, a and b its half axes, hits the number of points.

Lengths are in metres, or in the unit of the tree of --tree. Every seed gives another tree and
another scan, the same on every run. Ages, pruned, turned and lengthened branches keep the ids
of branches, so two scans of one preset and seed have a known correspondence. For example:
  virtual_scan --preset fruit --seed 7 --age 0.8 --output young.ply --truth young.csv
  virtual_scan --preset fruit --seed 7 --prune 3 --turn 5 30 --output old.ply --truth old.csv

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)";
}

inline void declare(CLI::App& app, Scan_options& o)
{
  const CLI::Range share(0.0, 1.0);
  std::string presets;
  for (const auto& [name, habit] : pcs::tree_habits())
    presets += (presets.empty() ? "" : ", ") + name;
  pcs::Virtual_scanner& s = o.scanner;

  app.footer(scan_help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--output", o.output, "labelled points (PLY, LAS or text)")->required();
  app.add_option("--truth", o.truth, "write the true tree here (CSV)");
  app.add_option("--swc", o.swc, "write the true tree here (SWC)");
  app.add_option("--report",
                 o.report,
                 "write counts, totals and seconds here (JSON); -: standard output");
  app.add_flag("--quiet", o.is_quiet, "print errors only");

  const char* tree = "The tree";
  CLI::Option* preset =
      app.add_option("--preset", o.preset, presets)->capture_default_str()->group(tree);
  app.add_option("--tree",
                 o.tree,
                 "scan this tree instead (SWC, CSV, a table of cylinders, or .txtskl)")
      ->excludes(preset)
      ->group(tree);
  app.add_option("--root-number",
                 o.root_number,
                 "which tree of a file with several trees is scanned, 1: the one with the most "
                 "nodes")
      ->check(CLI::Range(std::size_t(1), std::size_t(1) << 52))
      ->needs("--tree")
      ->group(tree);
  app.add_option("--seed", o.seed, "random seed of the tree and of the scan")
      ->check(is_seed)
      ->capture_default_str()
      ->group(tree);
  app.add_option("--height", o.height, "length of the trunk; the whole tree is scaled")
      ->group(tree);
  app.add_option("--age", o.age, "fraction of its final age, up to 1")
      ->capture_default_str()
      ->group(tree);
  app.add_option("--prune", o.pruned, "ids of branches to remove")
      ->check(CLI::Range(std::int64_t(0), std::int64_t(1) << 53))
      ->group(tree);
  app.add_option("--turn", o.turned_numbers, "id of a branch and its yaw in degrees")->group(tree);
  app.add_option("--lengthen", o.lengthened_numbers, "id of a branch and the factor of its length")
      ->group(tree);

  const char* scanner = "The scanner";
  app.add_option("--stations", o.stations, "number of stations")
      ->check(CLI::Range(std::int64_t(1), std::int64_t(10000)))
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--distance",
                 s.distance,
                 "distance of the stations from the trunk, +-15 %, in the unit of the tree")
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--arc-degrees",
                 o.arc_degrees,
                 "arc over which stations are spread; 60: one-sided")
      ->check(CLI::Range(0.0, 360.0))
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--first-degrees", o.first_degrees, "azimuth at which the arc begins")
      ->group(scanner);
  app.add_option("--step-degrees", o.step_degrees, "angle between beams")
      ->check(CLI::Range(6e-5, 57.0)) // those of `Virtual_scanner`, like the next
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--beam-milliradians", o.beam_milliradians, "beam divergence")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--noise", s.range_noise, "standard deviation of ranges")
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--registration",
                 s.registration_error,
                 "standard deviation of the shift of stations")
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--outliers", s.outlier_share, "fraction of outliers")
      ->check(share)
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--ghosts",
                 s.ghost_share,
                 "fraction of split beams that give a ghost point between two surfaces")
      ->check(share)
      ->capture_default_str()
      ->group(scanner);
  app.add_option("--voxel", s.voxel_size, "voxel size: one point is kept per voxel")
      ->group(scanner);

  const char* around = "Surroundings";
  app.add_option("--wind", s.wind, "largest displacement of twigs between stations")->group(around);
  app.add_option("--leaves", s.leaves_per_length, "leaves per metre of twig")->group(around);
  app.add_option("--ground", s.ground_radius, "radius of a patch of ground")->group(around);
  app.add_flag("--post", o.has_post, "add a lamp post beside the tree")->group(around);
}

/// Converts a list to pairs of an id and a number. Throws `pcs::Invalid_input`.
inline std::vector<std::pair<std::size_t, double>> id_pairs(const std::vector<double>& numbers,
                                                            const std::string& option)
{
  std::vector<std::pair<std::size_t, double>> pairs;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
    if (!(numbers[i] >= 0 && numbers[i] < 1e15) || numbers[i] != std::floor(numbers[i]))
      throw pcs::Invalid_input(option + ": the id of a branch must be an integer, 0 or more");
    pairs.emplace_back(static_cast<std::size_t>(numbers[i]), numbers[i + 1]);
  }
  if (numbers.size() % 2 != 0)
    throw pcs::Invalid_input(option + " takes pairs: the id of a branch and a number");
  return pairs;
}

/// Checks the options further than CLI11 can; completes the scanner. Throws `pcs::Invalid_input`.
inline void complete(Scan_options& o)
{
  constexpr double degree = 0.017453292519943295;
  o.scanner.number_of_stations = static_cast<std::size_t>(o.stations);
  o.scanner.angular_step = o.step_degrees * degree;
  o.scanner.azimuth_range = o.arc_degrees * degree;
  o.scanner.first_azimuth = o.first_degrees * degree;
  o.scanner.beam_width = o.beam_milliradians / 1000;
  o.turned = id_pairs(o.turned_numbers, "--turn");
  o.lengthened = id_pairs(o.lengthened_numbers, "--lengthen");
  if (o.height && (!(*o.height > 0) || !std::isfinite(*o.height) || !o.tree.empty()))
    throw pcs::Invalid_input("--height must be positive, and cannot be used with --tree");

  namespace fs = std::filesystem;
  Distinct_files distinct;
  distinct.add_input(o.tree);
  for (const std::string& path : {o.output, o.truth, o.swc, o.report}) {
    std::error_code error;
    const fs::path folder = fs::path(path).parent_path();
    if (!path.empty() && !folder.empty() && !fs::is_directory(folder, error))
      throw pcs::IO_error(path, "there is no such folder");
    if (!path.empty() && fs::is_directory(path, error))
      throw pcs::IO_error(path, "is a directory, expected a file name");
    distinct.add_output(path);
  }
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SCAN_SCAN_OPTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The command line of the program fit_tree_habit.

#ifndef PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_OPTIONS_H
#define PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_OPTIONS_H

#include "common/Distinct_files.h"
#include "common/is_seed.h"
#include "common/up_direction.h"
#include <pcs/core/errors.h>

#include <CLI/CLI.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace program {

struct Habit_options
{
  std::vector<std::string> input, score;
  std::string habit, output, report;
  std::string unit = "m", up = "z";
  double smallest_radius = 0, radius_error = 0;
  std::int64_t simulations = 100, seed = 0, grow = 0;
  double height = 0, height_spread = -1, distance = -1;
  std::vector<double> age = {1};
  std::string complete, scan, inferred, stations = "station";
  std::vector<double> scanners;
  double step_degrees = 0;
  bool is_quiet = false;
};

inline const char* habit_help()
{
  return R"(With --input, the growth parameters of the trees are found and written to --habit.
Without it, --habit is read. Skeletons are SWC, CSV, tables of cylinders, or .txtskl. --up is the
up direction of all files with coordinates: skeletons, the scan, and the trees that are written. A
warning tells when a trunk is far from it.

The habit is a JSON file: all parameters with standard errors and 95 % intervals, whether the
trees determine them, power laws of the sizes, and the quantiles of lengths, radii, angles and
numbers of branches by order, for L-systems of other programs.

--smallest-radius is the resolution of the skeletons: thinner parts are left out, because scans
show them incompletely. Skeleton files have no standard errors; --radius-error states them.

--grow N writes N trees that grow by the habit as SWC: forest.swc gives forest_1.swc, ... .
They stand apart. --score tells for each tree how far it is from trees of its height that grow
by the habit: the distance is about 1 for a similar tree; the share of grown trees that are as
far is small for an outlier.

--complete infers the wood of one tree that no beam of the scanner reached. It needs the skeleton,
the scan with all returns (also of leaves), and the positions of the scanners, in the coordinates of
the scan; the report of virtual_scan has them. Branches grow by the habit in hidden places, as
densely as where the scan shows them. The measured wood is not changed. --inferred writes the
inferred branches (SWC; branches that begin on measured wood have no parent). The report has their
volumes with 95 % intervals, as `inferred_...`, beside the measured volume. If there are several
scanners, each point needs the number of its station (--stations). A warning tells when the
skeleton, the scan and the positions seem not to belong together.

For example:
  fit_tree_habit --input oak_1.swc oak_2.swc --smallest-radius 0.01 --habit oak.json
  fit_tree_habit --habit oak.json --grow 20 --output forest.swc --age 0.5 1
  fit_tree_habit --habit oak.json --score unknown.swc
  fit_tree_habit --input tree.swc --habit tree.json --smallest-radius 0.004 --radius-error 0.05
    --complete tree.swc --scan scan.ply --scanner 8 3 1.6 --inferred hidden.swc --report r.json

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)";
}

inline void declare(CLI::App& app, Habit_options& o)
{
  app.footer(habit_help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--habit", o.habit, "the habit (JSON), written with --input, otherwise read")
      ->required();
  app.add_option("--seed", o.seed, "random seed")->check(is_seed)->capture_default_str();
  app.add_option("--simulations", o.simulations, "grown trees for intervals and scores")
      ->check(CLI::Range(std::int64_t(20), std::int64_t(100000)))
      ->capture_default_str();
  add_up(app, o.up, "up direction of all skeletons and scans")->capture_default_str();
  app.add_option("--report", o.report, "write counts, warnings, trees and scores here (JSON)");
  app.add_flag("--quiet", o.is_quiet, "print warnings and errors only");

  const char* fit = "Fit";
  app.add_option("--input", o.input, "skeletons of trees of one habit")->group(fit);
  app.add_option("--smallest-radius", o.smallest_radius, "thinner parts are left out")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->needs("--input")
      ->group(fit);
  app.add_option("--radius-error", o.radius_error, "relative standard error of the radii")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(fit);
  app.add_option("--unit", o.unit, "name of the unit of length, for the file")
      ->capture_default_str()
      ->needs("--input")
      ->group(fit);

  const char* grow = "Growth";
  app.add_option("--grow", o.grow, "number of trees")
      ->check(CLI::Range(std::int64_t(1), std::int64_t(100000)))
      ->group(grow);
  app.add_option("-o,--output", o.output, "the grown trees (SWC), see below")->group(grow);
  app.add_option("--height", o.height, "mean length of the trunks; 0: as measured")
      ->check(CLI::NonNegativeNumber)
      ->needs("--grow")
      ->group(grow);
  app.add_option("--height-spread", o.height_spread, "standard deviation of ln(height)")
      ->check(CLI::Range(0.0, 1.0))
      ->needs("--grow")
      ->group(grow);
  app.add_option("--age", o.age, "fraction of the final age, or a range")
      ->expected(1, 2)
      ->needs("--grow")
      ->group(grow);
  app.add_option("--distance", o.distance, "least distance of trunks; 0: all at the origin")
      ->check(CLI::NonNegativeNumber)
      ->needs("--grow")
      ->group(grow);

  const char* hidden = "Hidden wood";
  app.add_option("--complete", o.complete, "skeleton whose hidden wood is inferred")->group(hidden);
  app.add_option("--scan", o.scan, "its scan: all returns, with the leaves")->group(hidden);
  app.add_option("--scanner", o.scanners, "x y z of a scanner; for several: x y z x y z ...")
      ->group(hidden);
  app.add_option("--stations", o.stations, "property with the station of each point, from 0")
      ->capture_default_str()
      ->needs("--complete")
      ->group(hidden);
  app.add_option("--step-degrees", o.step_degrees, "angle between beams; 0: estimated")
      ->check(CLI::NonNegativeNumber)
      ->needs("--complete")
      ->group(hidden);
  app.add_option("--inferred", o.inferred, "write the inferred branches here (SWC)")->group(hidden);

  app.add_option("--score", o.score, "skeletons that are compared with the habit");
}

/// Returns the name of grown tree `i`, counted from 0, of `number`.
inline std::string output_name(const std::string& path, std::size_t i, std::size_t number)
{
  if (number == 1)
    return path;
  const std::filesystem::path p(path);
  const std::string name = p.stem().string() + "_" + std::to_string(i + 1) + p.extension().string();
  return (p.parent_path() / name).string();
}

/// Checks the options of hidden wood.
inline void check_hidden_wood(const Habit_options& o)
{
  if (o.complete.empty() && (!o.scan.empty() || !o.scanners.empty() || !o.inferred.empty()))
    throw pcs::Invalid_input("--scan, --scanner and --inferred belong to --complete");
  if (o.complete.empty())
    return;
  if (o.scan.empty())
    throw pcs::Invalid_input("--complete needs the scan of the skeleton; give --scan");
  if (o.scanners.empty())
    throw pcs::Invalid_input("no station is known; give --scanner x y z, in the coordinates of the "
                             "scan");
  if (o.scanners.size() % 3 != 0)
    throw pcs::Invalid_input("--scanner takes three coordinates for each scanner, found " +
                             std::to_string(o.scanners.size()) + " numbers");
  if (o.inferred.empty() && o.report.empty())
    throw pcs::Invalid_input("--complete gives no result without --inferred or --report");
}

/// Checks the options further than CLI11 can. Throws `pcs::Invalid_input` or `pcs::IO_error`.
inline void check(const Habit_options& o)
{
  if ((o.grow > 0) != !o.output.empty())
    throw pcs::Invalid_input("--grow and --output belong together");
  check_hidden_wood(o);
  if (o.input.empty() && o.grow == 0 && o.score.empty() && o.complete.empty())
    throw pcs::Invalid_input("nothing to do; give --input, --grow, --score or --complete");
  namespace fs = std::filesystem;
  Distinct_files distinct;
  for (const std::string& path : o.input)
    distinct.add_input(path);
  for (const std::string& path : o.score)
    distinct.add_input(path);
  distinct.add_input(o.complete);
  distinct.add_input(o.scan);
  std::vector<std::string> written = {o.report, o.inferred};
  if (o.input.empty())
    distinct.add_input(o.habit);
  else
    written.push_back(o.habit);
  const auto number = static_cast<std::size_t>(o.grow);
  for (std::size_t i = 0; i < number; ++i)
    written.push_back(output_name(o.output, i, number));
  for (const std::string& path : written) {
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

#endif // PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_OPTIONS_H

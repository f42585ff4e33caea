// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The command line of extract_tree_skeleton.

#ifndef PCS_EXAMPLES_PROGRAMS_SKELETON_SKELETON_OPTIONS_H
#define PCS_EXAMPLES_PROGRAMS_SKELETON_SKELETON_OPTIONS_H

#include "common/Distinct_files.h"
#include "common/up_direction.h"
#include <pcs/IO/internal/extensions.h>
#include <pcs/IO/write_mesh.h>
#include <pcs/core/Skeleton_options.h>
#include <pcs/core/errors.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace program {

struct Skeleton_options
{
  std::vector<std::string> inputs, also;
  std::string swc, mesh, leaves, cylinders, branches, tree_table, edges, points, report, folder;
  std::string up = "z", method = "automatic", fit, wood, stations,
              given; // no fit: the default of the library
  std::vector<double> root, scanners, wood_values;
  double beam_milliradians = -1; // < 0: the default of the library
  double tolerance = -1;         // < 0: the default of the library
  double breast_height = 1.3;
  pcs::Slice_options slices;              ///< the numbers of `slice_numbers()`
  std::vector<std::string> given_numbers; ///< the options of those that are given
  std::size_t root_number = 1;            ///< of the tree in the file of the given skeleton
  int number_of_resamples = 4;
  bool do_keep_stations = false, do_keep_ground = false, do_keep_trunk = false,
       do_remove_leaves = false, do_keep_leaves = false, do_separate = false, do_use_all = false,
       do_fit_all = false, do_estimate_normals = false, is_quiet = false;

  bool has_mesh() const
  {
    return !mesh.empty() || std::find(also.begin(), also.end(), "mesh") != also.end();
  }
};

/// A numerical option of the method `sections`.
struct Slice_number
{
  const char* option;
  double pcs::Slice_options::*value;
  const char* help;
};

inline const std::array<Slice_number, 6>& slice_numbers()
{
  using Options = pcs::Slice_options;
  static const std::array<Slice_number, 6> numbers = {
      {{"--slice-radius", &Options::radius, "radius of a slice, in radii of curvature"},
       {"--slice-offset", &Options::radius_offset, "addition to this radius, in spacings"},
       {"--turn-cost", &Options::turn_cost, "relative cost of a joint across the axes"},
       {"--dense-radius",
        &Options::dense_radius,
        "largest distance of dense points from a branch, in radii ..."},
       {"--dense-offset", &Options::dense_offset, "... and an addition to it, in spacings"},
       {"--allometry",
        &Options::allometry,
        "exponent of the radii of sparse branches, as a function of the length beyond"}}};
  return numbers;
}

/// Returns the options on which results depend, without those of a single scan.
inline nlohmann::ordered_json to_json(const Skeleton_options& o)
{
  nlohmann::ordered_json json = {{"up", o.up},
                                 {"method", o.method},
                                 {"wood", o.wood},
                                 {"stations", o.do_keep_stations ? "keep" : o.stations},
                                 {"keep_ground", o.do_keep_ground},
                                 {"keep_trunk", o.do_keep_trunk},
                                 {"leaves",
                                  o.do_keep_leaves     ? "keep"
                                  : o.do_remove_leaves ? "remove"
                                                       : "automatic"},
                                 {"breast_height", o.breast_height},
                                 {"resamples", o.number_of_resamples}};
  if (!o.wood_values.empty())
    json["wood_values"] = o.wood_values;
  if (o.method == "sections") {
    json["fit"] = o.fit;
    json["all_points"] = o.do_use_all;
    json["no_support"] = o.do_fit_all;
    json["estimate_normals"] = o.do_estimate_normals;
    for (const Slice_number& number : slice_numbers())
      json[std::string(number.option).substr(2)] = o.slices.*number.value;
  }
  if (o.has_mesh()) {
    json["tolerance"] = o.tolerance;
    json["separate"] = o.do_separate;
  }
  return json;
}

inline const char* skeleton_help()
{
  return R"(Scans: PLY, LAS (LAZ if built with LASzip), PCD, PTX, OFF, OBJ, or text (xyz, txt, csv,
asc, pts, pwn), also compressed by gzip (.gz) if built with zlib. A property `wood`
(1: wood, 0: leaf) is used if it exists, and `station` as the station of a point, whose
registration is corrected (--stations point_source_id for terrestrial LAS files). Rays without
return (alpha 0 in ray clouds, which have `time` and `alpha`) are left out, with a warning. Lengths
are in the unit of the scan, and positions in its coordinates.

Wood labels of other programs: --wood names the property, --wood-value the values of wood, for
example --wood label --wood-value 4. Labels other than 0 and 1 need it.

SWC rows: id, type, x, y, z, radius, parent (-1 for the root); type is 5 + the order of the branch.
Cylinders: the columns of TreeQSM, and the standard error of the radius. Branches: order, parent (a
row number, 0: none), volume [litres], area [m^2], length [m], angle to the parent [degrees], height
of the base [m], azimuth and zenith [degrees], diameter [m]. Tree table: one row with the names of
TreeQSM's treedata, in the same units. The units assume a scan in metres.
Points: the scan with `branch` (-1: none), `dense` (1: the section was measured there), `residual`,
`leaf` (1: removed as a leaf), and outward normals nx, ny, nz.

Several scans with --folder DIR: each gives DIR/NAME.swc, the results of --also (DIR/NAME_mesh.ply,
DIR/NAME_cylinders.csv, DIR/NAME_branches.csv, DIR/NAME_tree.csv, DIR/NAME_edges.ply,
DIR/NAME_points.ply), and a line of JSON in DIR/batch.jsonl. A failed scan gets a line with its
error, and the batch continues. When it is started again, the batch skips scans that have succeeded;
it replaces the results of scans or options that have changed.

Exit codes: 0 success, 1 bad input or usage, or a scan of several failed, 2 internal error.)";
}

inline void declare(CLI::App& app, Skeleton_options& options)
{
  app.footer(skeleton_help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--input", options.inputs, "one or more scans of trees")->required();
  app.add_option("--swc", options.swc, "the skeleton");
  app.add_option("--mesh", options.mesh, "the closed surface, PLY, OBJ or glTF (.glb)");
  app.add_option("--leaves",
                 options.leaves,
                 "placeholder leaves on fine branches, PLY, OBJ or glTF (.glb)");
  app.add_option("--cylinders",
                 options.cylinders,
                 "table of cylinders, CSV; branches are numbered from 1");
  app.add_option("--branches", options.branches, "table of branches with TreeQSM's columns, CSV");
  app.add_option("--tree-table",
                 options.tree_table,
                 "sizes of the tree with TreeQSM's names, CSV of one row");
  app.add_option("--edges", options.edges, "the skeleton as vertices and edges, PLY");
  app.add_option("--points",
                 options.points,
                 "the scan with branch, residual and outward normal of every point");
  app.add_option("--report",
                 options.report,
                 "counts, sizes and seconds (JSON); -: standard output");
  app.add_option("--folder", options.folder, "folder for the results of several scans");
  app.add_option("--also",
                 options.also,
                 "with --folder: mesh, cylinders, branches, tree-table, edges, points")
      ->check(CLI::IsMember({"mesh", "cylinders", "branches", "tree-table", "edges", "points"}))
      ->delimiter(',');
  add_up(app, options.up, "up direction")->capture_default_str();
  app.add_option("--root",
                 options.root,
                 "x y z of the foot of the trunk; default: the foot that "
                 "segment_trees wrote to the file, or detected")
      ->expected(3);
  app.add_option("--scanner", options.scanners, "x y z of a scanner; for several: x y z x y z ...");
  app.add_option("--beam-milliradians",
                 options.beam_milliradians,
                 "beam divergence, which makes thin branches too thick; with --scanner")
      ->check(CLI::Range(0.0, 100.0))
      ->needs("--scanner");
  app.add_option(
      "--wood",
      options.wood,
      "property that is 1 for wood and 0 for leaves; PROPERTY=VALUE if wood has another value");
  app.add_option("--wood-value",
                 options.wood_values,
                 "values of that property (default: `wood`) that denote wood, separated by commas "
                 "or repeated")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--stations",
                 options.stations,
                 "property with the station of each point; otherwise stations are found by "
                 "their scan grids");
  app.add_flag("--keep-stations",
               options.do_keep_stations,
               "do not correct the registration of stations")
      ->excludes("--stations");
  app.add_option(
         "--skeleton",
         options.given,
         "measure radii along this skeleton, whose positions are kept: SWC, CSV, a table of "
         "cylinders (.csv, .txt), or .txtskl")
      ->excludes("--root");
  app.add_option("--root-number",
                 options.root_number,
                 "which tree of a skeleton file with several trees is used, 1: the one with the "
                 "most nodes")
      ->check(CLI::Range(std::size_t(1), std::size_t(1) << 52))
      ->needs("--skeleton");
  app.add_option(
         "--resamples",
         options.number_of_resamples,
         "number of random subsamples of the scan, whose skeletons give the standard errors in "
         "the report; up to four times as many if they differ; 0: none")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  app.add_option("--breast-height", options.breast_height, "height of the diameter in the report")
      ->capture_default_str();
  app.add_option("--tolerance", options.tolerance, "maximal distance of the mesh from the sections")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--method",
                 options.method,
                 "how branches are found; `automatic`: `level_sets` if the plant has leaf blades, "
                 "such as maize, otherwise `chains`; `sections` is the published method [Aiteanu "
                 "2022]")
      ->check(CLI::IsMember({"automatic", "chains", "sections", "level_sets"}))
      ->capture_default_str();
  app.add_option("--fit",
                 options.fit,
                 "method `sections`: how a section is fitted; default `conic`")
      ->check(CLI::IsMember({"conic", "ellipse", "circle", "by_arc"}));
  app.add_flag("--all-points",
               options.do_use_all,
               "method `sections`: use all points of a slice, not a random sample of 20");
  app.add_flag("--no-support", options.do_fit_all, "method `sections`: cut a slice at every point");
  app.add_flag("--estimate-normals",
               options.do_estimate_normals,
               "method `sections`: estimate normals even if the scan has them");
  for (const Slice_number& number : slice_numbers())
    app.add_option(number.option,
                   options.slices.*number.value,
                   std::string("method `sections`: ") + number.help)
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str()
        ->each([&options, number](const std::string&) {
          options.given_numbers.emplace_back(number.option);
        });
  app.add_flag("--keep-ground", options.do_keep_ground, "keep ground points");
  app.add_flag("--keep-trunk",
               options.do_keep_trunk,
               "do not continue a trunk that leaves hide to the top of the tree");
  app.add_flag("--remove-leaves",
               options.do_remove_leaves,
               "remove leaves even without evidence of many leaves");
  app.add_flag("--keep-leaves", options.do_keep_leaves, "keep leaf points")
      ->excludes("--remove-leaves");
  app.add_flag("--separate", options.do_separate, "mesh: a separate closed tube per branch");
  app.add_flag("--quiet", options.is_quiet, "print errors only");
}

/// Checks that the folder of a result exists and that the path is not a folder. Throws
/// `pcs::IO_error`.
inline void check_folder_of(const std::string& path)
{
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, error))
    throw pcs::IO_error(path, "there is no such folder");
  if (std::filesystem::is_directory(path, error))
    throw pcs::IO_error(path, "is a directory, expected a file name");
}

inline void check_single(const Skeleton_options& options)
{
  if (options.inputs.size() > 1)
    throw pcs::Invalid_input("several scans need --folder");
  if (options.swc.empty())
    throw pcs::Invalid_input("--swc is required");
  if (!options.also.empty())
    throw pcs::Invalid_input("--also needs --folder");
  Distinct_files files;
  files.add_input(options.inputs.front());
  files.add_input(options.given);
  for (const std::string* path : {&options.swc,
                                  &options.mesh,
                                  &options.leaves,
                                  &options.cylinders,
                                  &options.branches,
                                  &options.tree_table,
                                  &options.edges,
                                  &options.points,
                                  &options.report}) {
    if (path->empty())
      continue;
    if (*path == "-" && path != &options.report)
      throw pcs::Invalid_input("only --report can be written to standard output (-); name a file "
                               "for the other results");
    check_folder_of(*path);
    files.add_output(*path);
  }
  for (const std::string* path : {&options.mesh, &options.leaves})
    if (!path->empty())
      pcs::IO::internal::mesh_extension(*path);
}

/// Returns the name of the results of one scan of a batch: `a` for `a.ply` and `a.ply.gz`.
inline std::string name_of_scan(const std::string& input)
{
  return std::filesystem::path(pcs::IO::internal::without_gz(input)).stem().string();
}

/// Returns the common beginning of the paths of the results of one scan of a batch.
inline std::string name_of_results(const std::string& input, const std::string& folder)
{
  return (std::filesystem::path(folder) / name_of_scan(input)).string();
}

/// Returns the options for one scan of a batch, with the paths of its results.
inline Skeleton_options options_of_one(const std::string& input, const Skeleton_options& options)
{
  Skeleton_options one = options;
  const std::string name = name_of_results(input, options.folder);
  one.swc = name + ".swc";
  for (const std::string& kind : options.also)
    if (kind == "mesh")
      one.mesh = name + "_mesh.ply";
    else if (kind == "cylinders")
      one.cylinders = name + "_cylinders.csv";
    else if (kind == "branches")
      one.branches = name + "_branches.csv";
    else if (kind == "tree-table")
      one.tree_table = name + "_tree.csv";
    else if (kind == "edges")
      one.edges = name + "_edges.ply";
    else
      one.points = name + "_points.ply";
  return one;
}

/// Returns the paths of all results of one scan of a batch; those that are not made are empty.
inline std::array<const std::string*, 7> results_of(const Skeleton_options& one)
{
  return {&one.swc,
          &one.mesh,
          &one.cylinders,
          &one.branches,
          &one.tree_table,
          &one.edges,
          &one.points};
}

inline void check_batch(const Skeleton_options& options)
{
  const std::pair<const char*, const std::string*> paths[] = {{"--swc", &options.swc},
                                                              {"--mesh", &options.mesh},
                                                              {"--leaves", &options.leaves},
                                                              {"--cylinders", &options.cylinders},
                                                              {"--branches", &options.branches},
                                                              {"--tree-table", &options.tree_table},
                                                              {"--edges", &options.edges},
                                                              {"--points", &options.points},
                                                              {"--report", &options.report}};
  for (const auto& [name, path] : paths)
    if (!path->empty())
      throw pcs::Invalid_input("with --folder the results have the names of the scans, and reports "
                               "are lines of batch.jsonl; leave out " +
                               std::string(name) + " " + *path);
  if (!options.given.empty() || !options.root.empty() || !options.scanners.empty())
    throw pcs::Invalid_input("--skeleton, --root and --scanner belong to one scan, not to several");
  std::map<std::string, std::string> names;
  for (const std::string& input : options.inputs) {
    const auto [at, is_new] = names.emplace(name_of_scan(input), input);
    if (!is_new)
      throw pcs::Invalid_input("the results of " + at->second + " and " + input +
                               " would have the same name; rename one of them, or use another "
                               "--folder for it");
  }
  Distinct_files files;
  for (const std::string& input : options.inputs)
    files.add_input(input);
  for (const std::string& input : options.inputs) {
    const Skeleton_options one = options_of_one(input, options);
    for (const std::string* path : results_of(one))
      files.add_output(*path);
  }
}

/// Checks the options further than CLI11 can. Throws `pcs::Invalid_input` or `pcs::IO_error`.
inline void check(const Skeleton_options& options)
{
  if (options.scanners.size() % 3 != 0)
    throw pcs::Invalid_input("--scanner takes three coordinates for each scanner, found " +
                             std::to_string(options.scanners.size()) + " numbers");
  if (!std::isfinite(options.tolerance)) // CLI11 accepts NaN in every range
    throw pcs::Invalid_input("--tolerance must be a finite number");
  for (const double value : options.wood_values)
    if (!std::isfinite(value))
      throw pcs::Invalid_input("--wood-value must be finite numbers");
  const auto refuse = [](bool is_given, const char* name, const char* lacking) {
    if (is_given)
      throw pcs::Invalid_input(std::string(name) + " has no effect without " + lacking);
  };
  const bool has_sections = options.method == "sections";
  refuse(!options.fit.empty() && !has_sections, "--fit", "--method sections");
  refuse(options.do_use_all && !has_sections, "--all-points", "--method sections");
  refuse(options.do_fit_all && !has_sections, "--no-support", "--method sections");
  refuse(options.do_estimate_normals && !has_sections, "--estimate-normals", "--method sections");
  const bool has_chains = options.method == "chains" || options.method == "automatic";
  refuse(options.do_remove_leaves && !has_chains, "--remove-leaves", "--method chains");
  refuse(options.do_keep_leaves && !has_chains, "--keep-leaves", "--method chains");
  refuse(options.do_keep_trunk && !has_chains, "--keep-trunk", "--method chains");
  if (options.do_keep_trunk && !options.given.empty())
    throw pcs::Invalid_input("--keep-trunk has no effect with --skeleton, whose trunk is kept");
  for (const std::string& option : options.given_numbers)
    refuse(!has_sections, option.c_str(), "--method sections");
  refuse(options.tolerance >= 0 && !options.has_mesh(), "--tolerance", "a mesh");
  refuse(options.do_separate && !options.has_mesh(), "--separate", "a mesh");
  if (options.folder.empty())
    check_single(options);
  else
    check_batch(options);
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SKELETON_SKELETON_OPTIONS_H

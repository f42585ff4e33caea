// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The command line of extract_tree_skeleton.

#ifndef PCS_EXAMPLES_PROGRAM_SKELETON_OPTIONS_H
#define PCS_EXAMPLES_PROGRAM_SKELETON_OPTIONS_H

#include <pcs/core/errors.h>

#include <CLI/CLI.hpp>

#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace program {

struct Skeleton_options
{
  std::vector<std::string> inputs;
  std::string swc, mesh, cylinders, edges, points, report, folder, up = "z", method = "chains",
                                                                   fit = "conic";
  std::vector<double> root;
  double tolerance = -1; // < 0: the default of the library
  double breast_height = 1.3;
  bool do_keep_ground = false, do_separate = false, do_use_all = false, do_fit_all = false,
       is_quiet = false;
};

inline const char* skeleton_help()
{
  return R"(Scans: PLY, LAS, OFF, or text (xyz, txt, csv, asc, pts, pwn). A property `wood` (1: wood,
0: leaf) is used if there is one. Lengths of all results are in the unit of the scan.

SWC rows: id, type, x, y, z, radius, parent (-1 for the root); type is 5 + the order of the branch.
Cylinders: the columns of TreeQSM, and the standard error of the radius.
Points: the scan with `branch` (-1: none), `dense` (1: the section was measured there) and `residual`.

Several scans, with --folder DIR: for each one DIR/NAME.swc, and a line in DIR/batch.jsonl. What has
a line there already is not done again; a scan that fails gets a line with its error.

Exit codes: 0 success, 1 bad input or usage, or a scan of several failed, 2 internal error.)";
}

inline void declare(CLI::App& app, Skeleton_options& options)
{
  app.footer(skeleton_help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--input", options.inputs, "the scan of a tree, or several")->required();
  app.add_option("--swc", options.swc, "the skeleton");
  app.add_option("--mesh", options.mesh, "the closed surface, PLY or OBJ");
  app.add_option("--cylinders", options.cylinders, "one row per piece of branch, CSV");
  app.add_option("--edges", options.edges, "the skeleton as vertices and edges, PLY");
  app.add_option("--points", options.points, "the scan with the branch of every point");
  app.add_option("--report", options.report, "counts, sizes and seconds, JSON");
  app.add_option("--folder", options.folder, "for the results of several scans");
  app.add_option("--up", options.up, "where the tree grows to: x, y, z, -x, -y or -z")
      ->check(CLI::IsMember({"x", "y", "z", "-x", "-y", "-z"}))
      ->capture_default_str();
  app.add_option("--root", options.root, "x y z of the foot of the trunk")->expected(3);
  app.add_option("--breast-height", options.breast_height, "height of the diameter in the report")
      ->capture_default_str();
  app.add_option("--tolerance",
                 options.tolerance,
                 "largest distance of the mesh from the sections");
  app.add_option("--method",
                 options.method,
                 "how branches are found; `sections` is the dissertation's way")
      ->check(CLI::IsMember({"chains", "sections"}))
      ->capture_default_str();
  app.add_option("--fit", options.fit, "of the method `sections`: how a section is fitted")
      ->check(CLI::IsMember({"conic", "ellipse", "circle", "by_arc"}))
      ->capture_default_str();
  app.add_flag("--all-points",
               options.do_use_all,
               "of the method `sections`: not 20 points drawn at random");
  app.add_flag("--no-support",
               options.do_fit_all,
               "of the method `sections`: a slice for every point");
  app.add_flag("--keep-ground", options.do_keep_ground, "do not look for ground");
  app.add_flag("--separate", options.do_separate, "mesh: every branch a closed tube of its own");
  app.add_flag("--quiet", options.is_quiet, "print nothing but errors");
}

/// Checks what CLI11 cannot. Throws `pcs::Invalid_input`.
inline void check(const Skeleton_options& options)
{
  const bool is_batch = !options.folder.empty();
  if (!is_batch && options.inputs.size() > 1)
    throw pcs::Invalid_input("several scans need --folder");
  if (!is_batch && options.swc.empty())
    throw pcs::Invalid_input("--swc is required");
  std::set<std::string> names;
  for (const std::string* path : {&options.swc,
                                  &options.mesh,
                                  &options.cylinders,
                                  &options.edges,
                                  &options.points,
                                  &options.report}) {
    if (path->empty())
      continue;
    if (is_batch)
      throw pcs::Invalid_input("with --folder the results have the names of the scans; leave " +
                               *path + " out");
    const std::string name = std::filesystem::path(*path).lexically_normal().string();
    if (!names.insert(name).second ||
        name == std::filesystem::path(options.inputs.front()).lexically_normal().string())
      throw pcs::Invalid_input("two files have the same name: " + *path);
  }
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAM_SKELETON_OPTIONS_H

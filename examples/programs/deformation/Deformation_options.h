// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The command line of the program.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_DEFORMATION_OPTIONS_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_DEFORMATION_OPTIONS_H

#include "common/Distinct_files.h"
#include "deformation/Model_options.h"
#include <pcs/core/errors.h>
#include <pcs/deform_point_set.h>

#include <CLI/CLI.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

namespace program {

struct Options
{
  std::string input, edit, output, report;
  std::string region; // file; empty: all points may move
  Model_options model;
  // signed, because CLI11 would convert -5 to a large unsigned number
  std::int64_t number_of_samples = 0; // not given
  std::int64_t number_of_neighbors = pcs::default_number_of_neighbors;
  std::int64_t number_of_kept_points = 1000000; // with --stream
  std::int64_t chunk_size = 262144;             // with --stream [count]
  bool is_default_edit = false, is_streamed = false, is_points_only = false, is_quiet = false;
};

inline const char* edit_help()
{
  return R"(The edit is a JSON file:
  {"handles": [
    {"select": {"box": [[x, y, z], [x, y, z]]}, "fixed": true},
    {"select": {"sphere": {"center": [x, y, z], "radius": r}},
     "rotate": {"axis": [x, y, z], "degrees": d, "center": [x, y, z]},
     "translate": [x, y, z], "scale": s},
    {"select": {"property": "status", "equals": 2}, "matrix": [16 numbers, row by row]},
    {"select": {"indices": [0, 1, 2]}, "fixed": true, "softness": 1},
    {"select": {"indices": [7, 5]}, "targets": [[x, y, z], [x, y, z]]}
  ]}
Scale comes first, then rotation, then translation. The center is the fixed point of
rotation and scale; without it that is the centroid of the selected points. The matrix
must be made of a rotation, one scale and a translation. Bounds are inclusive. Targets are the
new positions of the points in the order of indices; they exclude --stream.

The region is a JSON file with a selection like those of handles, {"select": {...}}. All other
points keep every bit. The points of handles must be in the region.

Files: PLY, LAS (LAZ if built with LASzip), OFF, OBJ, or text (xyz, txt, csv, asc, pts, pwn). The
input may also be PCD, PTX, or compressed by gzip (.gz) if built with zlib. Order and properties of
the points are kept, normals nx, ny, nz are rotated. PLY is written in binary, with
coordinates in double precision.
Gaussian splats (PLY with rot_0 to rot_3, scale_0 to scale_2 and f_rest_0, ...) are recognised:
their shapes and colours follow, and coordinates keep their type.
The faces of a mesh in PLY, OFF or OBJ are kept in these formats; PLY to PLY also keeps lists
and other elements. The output may also be binary glTF (glb), with normals and colours only.
Colours of faces in OFF, and normals, textures and groups in OBJ are not kept. With --stream,
faces are held in memory.

With --stream the input may be larger than memory. It is read twice (text: three times;
LAS output: once more). At most --stream-points points, spread over the file, are kept and
deformed; the other points follow them, and points of handles move exactly. A file with no
more points gives the same output, byte for byte, as without --stream; otherwise each
kept point is linked to at least 10 neighbours, and --samples is 2000 by default. For example:
  generate_points large.ply 50000000 --float
  deform_point_set --stream --input large.ply --default-edit --output out.ply

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)";
}

inline void declare(CLI::App& app, Options& options)
{
  app.footer(edit_help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--input", options.input, "points to deform")->required();
  app.add_option("--edit", options.edit, "handles and their motions (JSON), see below");
  app.add_flag(
      "--default-edit",
      options.is_default_edit,
      "instead of --edit: hold the lowest 20 % along the longest axis, rotate the highest 15 % by "
      "40 degrees about it and move them sideways");
  app.add_option("--output", options.output, "deformed points; may be the input")->required();
  app.add_option("--samples",
                 options.number_of_samples,
                 "number of samples on which the deformation is solved; by default all points of a "
                 "cloud with at most " +
                     std::to_string(pcs::largest_unsampled_size) + " points, otherwise " +
                     std::to_string(pcs::default_number_of_samples) +
                     "; with --as-published weights or hops always the latter")
      ->check(CLI::Range(std::int64_t(1), std::int64_t(std::numeric_limits<std::uint32_t>::max())));
  app.add_option("--neighbors",
                 options.number_of_neighbors,
                 "number of nearest neighbours of the neighbour graph")
      ->check(
          CLI::Range(std::int64_t(2), std::int64_t(pcs::neighborhood::maximal_number_of_neighbors)))
      ->capture_default_str();
  app.add_option("--region",
                 options.region,
                 "only the points that this JSON file selects may move, see below");
  declare(app, options.model);
  CLI::Option* stream =
      app.add_flag("--stream", options.is_streamed, "process files larger than memory; see below");
  app.add_option("--stream-points",
                 options.number_of_kept_points,
                 "points that --stream keeps in memory, some 400 bytes each")
      ->check(CLI::Range(std::int64_t(100), std::int64_t(1) << 26))
      ->needs(stream)
      ->capture_default_str();
  app.add_option("--chunk-points", options.chunk_size, "points of a chunk; the output is the same")
      ->check(CLI::Range(std::int64_t(1), std::int64_t(1) << 26))
      ->needs(stream)
      ->group("Advanced");
  app.add_flag("--points-only",
               options.is_points_only,
               "read the vertices of a mesh only, without faces, lists and other elements");
  app.add_option("--report",
                 options.report,
                 "write counts, seconds and energies here (JSON); -: standard output");
  app.add_flag("--quiet", options.is_quiet, "print warnings and errors only");
}

/// Checks the options further than CLI11 can. Throws `pcs::Invalid_input`.
inline void check(const Options& options)
{
  if (options.edit.empty() != options.is_default_edit)
    throw pcs::Invalid_input("expected exactly one of --edit and --default-edit");
  // The input may be the output; other equal paths would overwrite a file that is needed.
  using Named_path = std::pair<const char*, const std::string*>;
  const std::array<std::pair<Named_path, Named_path>, 6> pairs = {
      {{{"--output", &options.output}, {"--edit", &options.edit}},
       {{"--output", &options.output}, {"--region", &options.region}},
       {{"--report", &options.report}, {"--input", &options.input}},
       {{"--report", &options.report}, {"--edit", &options.edit}},
       {{"--report", &options.report}, {"--region", &options.region}},
       {{"--report", &options.report}, {"--output", &options.output}}}};
  for (const auto& [a, b] : pairs) {
    std::error_code error;
    const bool are_equal = !a.second->empty() && !b.second->empty() &&
                           (std::filesystem::equivalent(*a.second, *b.second, error) ||
                            Distinct_files::real(*a.second) == Distinct_files::real(*b.second));
    if (are_equal)
      throw pcs::Invalid_input(std::string(a.first) + " and " + b.first +
                               " are the same file: " + *a.second);
  }
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_DEFORMATION_OPTIONS_H

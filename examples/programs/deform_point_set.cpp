// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: deforms a point file by the handles and motions of a JSON file, and keeps all
// properties, and the faces of a mesh.

#include "common/Progress_line.h"
#include "common/Report_file.h"
#include "common/check_output.h"
#include "common/run_program.h"
#include "deformation/Deformation_options.h"
#include "deformation/Edit.h"
#include "deformation/Normals.h"
#include "deformation/Run_report.h"
#include "deformation/Splats.h"
#include "deformation/Streamed_deformation.h"
#include "deformation/adapt_faces.h"
#include "deformation/apply_edit.h"
#include "deformation/default_edit.h"
#include "deformation/read_edit.h"
#include "deformation/run_session.h"
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/core/Similarity.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace program {

/// Deforms the points of the table, and its normals if they are valid.
void deform_table(pcs::IO::Point_table& table,
                  const Edit& edit,
                  const Edit* region_of_interest,
                  const Options& options,
                  const std::optional<Splat_properties>& splats,
                  Run_report& run)
{
  Edit_scan scan(edit, table);
  const std::vector<std::uint32_t> handles = scan.add(table);
  const std::vector<pcs::Similarity> motions = scan.motions();
  run.points_of_handles.assign(edit.handles.size(), 0);
  for (const std::uint32_t h : handles)
    if (h != no_handle)
      ++run.points_of_handles[h];

  const Region region(region_of_interest, table);
  const std::vector<char> is_inside = region.in(table, 0, handles, &edit);
  run.number_of_inside_points = region.is_given()
                                    ? std::count(is_inside.begin(), is_inside.end(), char(1))
                                    : static_cast<std::int64_t>(table.number_of_points());
  region.check(table.number_of_points(), static_cast<std::uint64_t>(run.number_of_inside_points));

  Normal_vectors normals;
  if (table.has_normals()) {
    normals = table.normals();
    const std::optional<std::size_t> invalid = first_invalid(normals);
    run.normals = invalid ? "unchanged" : "deformed";
    if (invalid)
      run.warnings.push_back(invalid_normal_warning(*invalid));
  }
  const bool do_normals = run.normals == "deformed";

  std::vector<pcs::IO::Point_table::Point_3> rest;
  if (splats)
    rest = table.points();
  Gradients gradients(splats ? table.number_of_points() : 0, Eigen::Matrix3d::Identity());
  Progress_line progress(!options.is_quiet);
  run.deformation = run_session({edit,
                                 motions,
                                 handles,
                                 table.points(),
                                 do_normals ? &normals : nullptr,
                                 splats ? &gradients : nullptr,
                                 "",
                                 is_inside},
                                options,
                                progress,
                                [](const Move_others&) {});
  run.samples_reason = reason_of(run.deformation);
  if (do_normals)
    store_normals(table, normals);
  if (splats) {
    keep_resting_coordinates(rest, scan.largest_coordinate(), table.points());
    transform_splats(table, *splats, gradients, run);
  }
  check_range(edit, table, 0);
}

void run_in_memory(const Options& options,
                   std::optional<Edit> edit,
                   const Edit* region,
                   Run_report& run)
{
  const Stopwatch reading;
  std::shared_ptr<pcs::IO::Mesh_faces> faces;
  pcs::IO::Point_table table = options.is_points_only ? pcs::IO::read_points(options.input)
                                                      : pcs::IO::read_points(options.input, faces);
  run.seconds_read = reading.seconds();
  run.number_of_points = table.number_of_points();
  run.warnings = table.schema().warnings;
  warn_of_unknown_normals(table.schema(), run.warnings);
  const std::optional<Splat_properties> splats = find_splats(table.schema(), run.warnings);
  if (splats)
    note_splats(*splats, run);
  run.number_of_neighbors = options.number_of_neighbors;
  check_output(options.output, table.schema());
  adapt_faces(faces, options.output, run.warnings);
  run.number_of_faces = faces ? faces->number_of_faces() : 0;
  if (!edit)
    edit = default_edit(table.points());
  run.edit = edit->source;
  deform_table(table, *edit, region, options, splats, run);

  const Stopwatch writing;
  pcs::IO::Write_options write_options;
  write_options.faces = faces;
  write_options.keep_coordinate_types = splats.has_value();
  pcs::IO::write_points(options.output, table, write_options);
  run.seconds_write = writing.seconds();
}

void run(const Options& options)
{
  const Stopwatch total;
  Run_report run;
  check(options);
  std::optional<Edit> edit;
  if (!options.is_default_edit)
    edit = read_edit(options.edit);
  std::optional<Edit> region;
  if (!options.region.empty())
    region = read_region(options.region);
  const Edit* region_or_null = region ? &*region : nullptr;
  const std::optional<Edit> motions = edit; // `edit` is moved
  std::optional<Report_file> report_file;
  if (!options.report.empty())
    report_file.emplace(options.report);

  try {
    if (options.is_streamed)
      Streamed_deformation(options, region_or_null, run).run(std::move(edit));
    else
      run_in_memory(options, std::move(edit), region_or_null, run);
  } catch (const pcs::Invalid_input& e) {
    throw pcs::IO_error(options.input, e.what());
  }
  warn_of_unreached_points(run);
  warn_of_invalid_splats(run);
  warn_of_unused_variants(run, options.model);
  if (motions)
    warn_of_lost_turns(run, options.model, *motions);
  for (const std::string& warning : run.warnings)
    std::cerr << "deform_point_set: warning: " << options.input << ": " << warning << '\n';
  run.seconds_total = total.seconds();
  if (report_file)
    report_file->commit(to_json(run, options));
  if (!options.is_quiet)
    print_summary(std::cout, run, options);
}

} // namespace program

int main(int argc, char** argv)
{
  program::Options options;
  CLI::App app("Deforms a point cloud by handles; the other points follow as rigidly as possible.",
               "deform_point_set");
  program::declare(app, options);
  return program::run_program(app,
                              argc,
                              argv,
                              "--input cloud.ply --default-edit --output deformed.ply",
                              [&] {
                                program::run(options);
                                return true;
                              });
}

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A program that deforms a point file: handles and motions come from a JSON file, all properties are kept.

#include "program/Edit.h"
#include "program/Normals.h"
#include "program/Options.h"
#include "program/Progress_line.h"
#include "program/Report_file.h"
#include "program/Run_report.h"
#include "program/apply_edit.h"
#include "program/default_edit.h"
#include "program/read_edit.h"
#include <pcs/IO/Point_table.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/Point_set_deformation.h>
#include <pcs/core/errors.h>
#include <pcs/deform_point_set.h>

#include <boost/property_map/property_map.hpp>

#include <CLI/CLI.hpp>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace program {

//! [index_map]
/// Reads and writes `(*values)[i]` for a point number `i`. What is kept is read only.
template <class Value>
struct Index_map
{
  using key_type = std::size_t;
  using value_type = Value;
  using reference = const Value&;
  using category = boost::read_write_property_map_tag;

  friend const Value& get(const Index_map& map, std::size_t i) { return (*map.values)[i]; }
  friend void put(const Index_map& map, std::size_t i, const Value& value)
  {
    if (!(*map.is_kept)[i])
      (*map.values)[i] = value;
  }

  std::vector<Value>* values = nullptr;
  const std::vector<char>* is_kept = nullptr;
};
//! [index_map]

/// The points of fixed handles: the library returns them up to rounding, the program bit for bit.
std::vector<char>
kept_points(const Edit& edit, const std::vector<pcs::Deformation_handle>& handles, std::size_t n)
{
  std::vector<char> is_kept(n, 0);
  for (std::size_t h = 0; h < handles.size(); ++h)
    if (edit.handles[h].motion.is_fixed() && handles[h].softness == 0)
      for (const std::size_t i : handles[h].indices)
        is_kept[i] = 1;
  return is_kept;
}

/// Finds out before the long work whether the format can hold the data and the folder be written to.
void check_output(const std::string& path, const pcs::IO::Point_schema& schema)
{
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
      !std::filesystem::is_directory(status))
    return; // to open a pipe would be to write to it
  pcs::IO::Write_options options;
  options.number_of_points = 0;
  options.las_scale = {1, 1, 1};
  options.las_offset = {0, 0, 0};
  const pcs::IO::Point_writer writer(path, schema, options); // never committed
}

template <class PointRange, class NamedParameters>
pcs::Deformation_report deform(PointRange& points,
                               const Edit& edit,
                               const std::vector<pcs::Deformation_handle>& handles,
                               Progress_line& progress,
                               const NamedParameters& np)
{
  const char* stage = "preparing";
  const auto show = [&](double fraction) {
    progress.show(stage, fraction);
    return true;
  };
  pcs::Point_set_deformation session(points, np.callback(show));
  for (std::size_t h = 0; h < handles.size(); ++h)
    try {
      const auto handle = session.add_handle(handles[h].indices, handles[h].softness);
      session.set_transformation(handle, handles[h].transformation);
    } catch (const pcs::Invalid_input& e) {
      throw pcs::IO_error(edit.source, edit.handles[h].pointer + ": " + e.what());
    }
  stage = "deforming";
  return session.deform();
}

/// Deforms the points of the table, and its normals if they are valid.
void deform_table(pcs::IO::Point_table& table,
                  const Edit& edit,
                  const Options& options,
                  Run_report& run)
{
  const std::vector<pcs::Deformation_handle> handles = apply_edit(edit, table);
  for (const pcs::Deformation_handle& handle : handles)
    run.points_of_handles.push_back(handle.indices.size());

  Normal_vectors normals;
  if (table.has_normals()) {
    normals = table.normals();
    const std::optional<std::size_t> invalid = first_invalid(normals);
    run.normals = invalid ? "unchanged" : "deformed";
    if (invalid)
      run.warnings.push_back("the normal of point " + std::to_string(*invalid) +
                             " is not finite: all normals are left as they are");
  }

  Progress_line progress(!options.is_quiet);
  const std::vector<char> is_kept = kept_points(edit, handles, table.number_of_points());
  std::vector<std::size_t> indices(table.number_of_points());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  using Table = pcs::IO::Point_table;
  const auto np = pcs::parameters::point_map(Index_map<Table::Point_3>{&table.points(), &is_kept})
                      .number_of_samples(options.number_of_samples)
                      .number_of_neighbors(options.number_of_neighbors);
  if (run.normals == "deformed") {
    const Index_map<Table::Vector_3> normal_map{&normals, &is_kept};
    run.deformation = deform(indices, edit, handles, progress, np.normal_map(normal_map));
    store_normals(table, normals);
  } else
    run.deformation = deform(indices, edit, handles, progress, np);

  for (std::size_t i = 0; i < table.number_of_points(); ++i)
    if (!to_vec3(table.points()[i]).allFinite())
      throw pcs::IO_error(edit.source,
                          "the edit moves point " + std::to_string(i) +
                              " out of the range of numbers");
}

void run(const Options& options)
{
  const Stopwatch total;
  Run_report run;
  check(options);
  std::optional<Edit> edit;
  if (!options.is_default_edit)
    edit = read_edit(options.edit);
  std::optional<Report_file> report_file;
  if (!options.report.empty())
    report_file.emplace(options.report);

  const Stopwatch reading;
  pcs::IO::Point_table table = pcs::IO::read_points(options.input);
  run.seconds_read = reading.seconds();
  check_output(options.output, table.schema());
  if (!edit)
    edit = default_edit(table);
  run.edit = edit->source;

  deform_table(table, *edit, options, run);
  for (const std::string& warning : run.warnings)
    std::cerr << "deform_point_set: warning: " << options.input << ": " << warning << '\n';
  if (run.deformation.status == pcs::Status::numerical_failure)
    throw std::runtime_error("a matrix could not be factorised; nothing was written");

  const Stopwatch writing;
  pcs::IO::write_points(options.output, table);
  run.seconds_write = writing.seconds();
  run.seconds_total = total.seconds();
  if (report_file)
    report_file->commit(to_json(run, options));
  if (!options.is_quiet)
    print_summary(std::cout, run, options);
}

int fail(int exit_code, const std::string& what)
{
  std::cerr << "deform_point_set: " << what << '\n';
  return exit_code;
}

} // namespace program

int main(int argc, char** argv)
{
  constexpr int bad_input = 1, internal_error = 2;
  program::Options options;
  CLI::App app(
      "Moves a few handles of a point cloud; the other points follow and keep their shape.",
      "deform_point_set");
  program::declare(app, options);
  try {
    app.parse(argc, argv);
    program::run(options);
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0)
      return app.exit(e); // --help, --version
    return program::fail(bad_input,
                         std::string(e.what()) + "\nRun with --help for more information.");
  } catch (const pcs::IO_error& e) {
    return program::fail(bad_input, e.what());
  } catch (const pcs::Invalid_input& e) {
    return program::fail(bad_input, e.what());
  } catch (const std::bad_alloc&) {
    return program::fail(internal_error, "not enough memory");
  } catch (const std::exception& e) {
    return program::fail(internal_error, std::string("internal error: ") + e.what());
  }
}

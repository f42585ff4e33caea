// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: deforms a point file onto another one (nonrigid registration), and fills the holes of
// the target.

#include "common/Distinct_files.h"
#include "common/Progress_line.h"
#include "common/Report_file.h"
#include "common/check_output.h"
#include "common/run_program.h"
#include "deformation/Normals.h"
#include "deformation/adapt_faces.h"
#include "fitting/read_landmarks.h"
#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/registration/Point_set_fitting.h>

#include <boost/property_map/property_map.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace program {

namespace {

struct Options
{
  std::string source, target, output, landmarks, filled, report;
  std::int64_t number_of_samples =
      static_cast<std::int64_t>(pcs::registration::default_number_of_fit_samples);
  std::int64_t number_of_iterations = 60;
  double stiffness = 1;
  double fitting_length = pcs::registration::default_fitting_length;
  double outlier_share = 0.1;
  bool has_no_alignment = false, is_quiet = false;
};

const char* help()
{
  return R"(The source keeps its points, their order and properties. The faces of a mesh in PLY,
OFF or OBJ are kept in these formats. Normals nx, ny, nz follow. Of Gaussian splats, only
positions and normals follow. The lengths of options are fractions of the extent of the source, the
diagonal of its bounding box; a warning says if a few stray points determine it. The summary and the
report have lengths (residuals, displacement, landmark gap) in the unit of the coordinates.

Landmarks are known pairs of a source point, counted from 0, and its position on the target. Three
or more at different places determine the initial pose, unless --no-alignment is given. JSON:
[{"point": 12, "target": [x, y, z]}, ...]. All other files are tables with lines point,x,y,z.

--filled writes the fitted source points that have no match: they lie where the target has a hole.
Together with the target, they form a cloud without these holes.

A warning says that the result is not plausible: fewer than a fifth of the points are matched, or
their median distance from the target exceeds 0.02 extents. Another one says that the extents of
source and target differ by more than a factor of 3.

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)";
}

void declare(CLI::App& app, Options& options)
{
  app.footer(help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--source", options.source, "points to deform")->required();
  app.add_option("--target", options.target, "points to reach")->required();
  app.add_option("--output", options.output, "the deformed source")->required();
  app.add_option("--landmarks", options.landmarks, "known pairs of points, see below");
  app.add_option("--filled", options.filled, "the deformed source points in holes of the target");
  app.add_option("--report",
                 options.report,
                 "counts, residuals and seconds (JSON); -: standard output");
  app.add_option("--samples", options.number_of_samples, "samples that carry the points")
      ->capture_default_str();
  app.add_option("--iterations", options.number_of_iterations, "largest number in each stage")
      ->capture_default_str();
  app.add_option("--stiffness", options.stiffness, "bending relative to stretching")
      ->capture_default_str();
  app.add_option("--fitting-length",
                 options.fitting_length,
                 "smallest features that are followed [extents]")
      ->capture_default_str();
  app.add_option("--outliers", options.outlier_share, "expected share of the target")
      ->capture_default_str();
  app.add_flag("--no-alignment",
               options.has_no_alignment,
               "the clouds are in their common coordinates already");
  app.add_flag("--quiet", options.is_quiet, "print nothing but warnings and errors");
}

/// Reads and writes `(*values)[i]` for a point number `i`.
template <class Value>
struct Value_map
{
  using key_type = std::size_t;
  using value_type = Value;
  using reference = const Value&;
  using category = boost::read_write_property_map_tag;

  friend const Value& get(const Value_map& map, std::size_t i) { return (*map.values)[i]; }
  friend void put(const Value_map& map, std::size_t i, const Value& v) { (*map.values)[i] = v; }

  std::vector<Value>* values;
};

/// Writes the number of the matched target point, or -1.
struct Match_map
{
  using key_type = std::size_t;
  using value_type = std::ptrdiff_t;
  using reference = void;
  using category = boost::writable_property_map_tag;

  friend void put(const Match_map& map, std::size_t i, std::ptrdiff_t v) { (*map.values)[i] = v; }

  std::vector<std::ptrdiff_t>* values;
};

/// Deforms the points of the table, and its normals if they are valid; otherwise adds a warning.
pcs::Fit_report fit_table(pcs::IO::Point_table& source,
                          const pcs::IO::Point_table& target,
                          const std::vector<pcs::Landmark>& landmarks,
                          const Options& options,
                          std::vector<std::ptrdiff_t>& matches,
                          std::vector<std::string>& warnings)
{
  using Point = pcs::IO::Point_table::Point_3;
  using Vector = pcs::IO::Point_table::Vector_3;
  std::vector<std::size_t> indices(source.number_of_points());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  matches.assign(indices.size(), -1);
  Progress_line progress(!options.is_quiet);
  Normal_vectors normals;
  if (source.has_normals())
    normals = source.normals();
  const std::optional<std::size_t> invalid = first_invalid(normals);
  if (invalid)
    warnings.push_back(invalid_normal_warning(*invalid));
  const bool do_normals = !normals.empty() && !invalid;
  const auto np = pcs::parameters::point_map(Value_map<Point>{&source.points()})
                      .number_of_samples(options.number_of_samples)
                      .number_of_iterations(options.number_of_iterations)
                      .stiffness(options.stiffness)
                      .fitting_length(options.fitting_length)
                      .outlier_share(options.outlier_share)
                      .do_align(!options.has_no_alignment)
                      .point_match_map(Match_map{&matches})
                      .callback([&](double fraction) {
                        progress.show("fitting", fraction);
                        return true;
                      });
  const auto fit = [&](const auto& parameters) {
    pcs::Point_set_fitting session(indices, parameters);
    return session.fit(target.points(), pcs::parameters::landmarks(landmarks));
  };
  if (!do_normals)
    return fit(np);
  const pcs::Fit_report report = fit(np.normal_map(Value_map<Vector>{&normals}));
  store_normals(source, normals);
  return report;
}

nlohmann::ordered_json to_json(const pcs::Fit_report& r, const Options& options)
{
  nlohmann::ordered_json json;
  json["program"] = "fit_point_set";
  json["version"] = PCS_PROGRAM_VERSION;
  json["source"] = options.source;
  json["target"] = options.target;
  json["output"] = options.output;
  json["status"] = pcs::to_string(r.status);
  json["plausible"] = r.is_plausible;
  json["source_points"] = r.number_of_source_points;
  json["target_points"] = r.number_of_target_points;
  json["matched_points"] = r.number_of_matched;
  json["samples"] = r.number_of_samples;
  json["iterations"] = r.number_of_iterations;
  json["unit_of_lengths"] = "coordinates of the source";
  json["median_residual"] = r.median_residual;
  json["rms_residual"] = r.rms_residual;
  json["rms_displacement"] = r.rms_displacement;
  json["largest_landmark_gap"] = r.largest_landmark_gap;
  json["seconds"] = {{"preparation", r.seconds.preparation},
                     {"rigid", r.seconds.rigid},
                     {"coarse", r.seconds.coarse},
                     {"fine", r.seconds.fine},
                     {"writing", r.seconds.writing}};
  return json;
}

void print_summary(const pcs::Fit_report& r)
{
  std::cout << "points      " << r.number_of_source_points << ", target "
            << r.number_of_target_points << '\n'
            << "matched     " << r.number_of_matched << '\n'
            << "residual    ";
  if (r.number_of_matched > 0)
    std::cout << "median " << r.median_residual << ", rms " << r.rms_residual
              << " (unit of the coordinates)\n";
  else
    std::cout << "none\n";
  std::cout << "moved       rms " << r.rms_displacement << '\n'
            << "iterations  " << r.number_of_iterations << '\n'
            << "status      " << r.status << '\n';
}

/// Returns the table of the points without match.
pcs::IO::Point_table unmatched(const pcs::IO::Point_table& table,
                               const std::vector<std::ptrdiff_t>& matches)
{
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < matches.size(); ++i)
    if (matches[i] < 0)
      indices.push_back(i);
  return table.select(indices);
}

/// Returns what of the source is not kept or does not follow; removes faces that the output cannot
/// hold.
std::vector<std::string> adapt_source(const pcs::IO::Point_schema& schema,
                                      std::shared_ptr<pcs::IO::Mesh_faces>& faces,
                                      const std::string& output)
{
  std::vector<std::string> warnings = schema.warnings;
  if (schema.has("rot_0") && schema.has("scale_0"))
    warnings.push_back("the rotations, scales and colours of Gaussian splats are left as they are; "
                       "only positions and normals are fitted");
  warn_of_unknown_normals(schema, warnings);
  adapt_faces(faces, output, warnings);
  return warnings;
}

/// Diagonals of the bounding box of all points, and of all without the outermost ones. [L]
struct Extents
{
  double all = 0, inner = 0;
};

Extents extents_of(const std::vector<pcs::IO::Point_table::Point_3>& points)
{
  constexpr double share_of_strays = 0.01; // on each side of an axis
  if (points.empty())
    return {};
  Extents extents;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [&](const auto& p) {
      return p[axis];
    });
    std::sort(values.begin(), values.end());
    const auto cut = static_cast<std::size_t>(share_of_strays * static_cast<double>(values.size()));
    extents.all = std::hypot(extents.all, values.back() - values.front());
    extents.inner = std::hypot(extents.inner, values[values.size() - 1 - cut] - values[cut]);
  }
  return extents;
}

/// Adds warnings if a few points are so far away that they determine the extent of the source, by
/// which all lengths are measured, and if the sizes of both clouds suggest different units. A
/// source that is much too small finds matches everywhere on the target, and looks plausible.
void warn_of_extents(const Extents& source,
                     const Extents& target,
                     std::vector<std::string>& warnings)
{
  constexpr double least_ratio = 0.05, largest_ratio = 3;
  std::ostringstream text;
  if (source.inner < least_ratio * source.all) {
    text << "a few points lie far away from all others and make the extent " << source.all
         << " instead of " << source.inner << ": lengths are fractions of it; remove these points";
    warnings.push_back(text.str());
  } else if (std::max(source.inner, target.inner) >
             largest_ratio * std::min(source.inner, target.inner)) {
    text << "the extent is " << source.inner << ", and " << target.inner
         << " that of the target: sizes are not adapted; convert the units if they differ";
    warnings.push_back(text.str());
  }
}

void warn(const std::string& file, const std::vector<std::string>& warnings)
{
  for (const std::string& warning : warnings)
    std::cerr << "fit_point_set: warning: " << file << ": " << warning << '\n';
}

std::string plausibility_warning(const pcs::Fit_report& r, bool has_landmarks)
{
  std::ostringstream text;
  text << "not plausible, " << r.number_of_matched << " of " << r.number_of_source_points
       << " points are matched";
  if (r.number_of_matched > 0)
    text << " with a median residual of " << r.median_residual;
  text << "; check the units and origins of both clouds"
       << (has_landmarks ? " and the landmarks" : "; landmarks may help");
  return text.str();
}

/// Writes the points in holes. If there are none, glTF cannot hold the file.
void write_filled(const Options& options, const pcs::IO::Point_table& filled)
{
  if (filled.number_of_points() == 0 &&
      pcs::IO::internal::format_by_extension(options.filled) == pcs::IO::File_format::glb)
    warn(options.filled, {"is not written: the target has no holes, and glTF needs points"});
  else
    pcs::IO::write_points(options.filled, filled);
}

void run(const Options& options)
{
  Distinct_files files;
  for (const std::string& input : {options.source, options.target, options.landmarks})
    files.add_input(input);
  for (const std::string& output : {options.output, options.filled, options.report})
    files.add_output(output);
  std::optional<Report_file> report_file;
  if (!options.report.empty())
    report_file.emplace(options.report);
  std::vector<pcs::Landmark> landmarks;
  if (!options.landmarks.empty())
    landmarks = read_landmarks(options.landmarks);
  std::shared_ptr<pcs::IO::Mesh_faces> faces;
  pcs::IO::Point_table source = pcs::IO::read_points(options.source, faces);
  const pcs::IO::Point_table target = pcs::IO::read_points(options.target);
  check_output(options.output, source.schema());
  if (!options.filled.empty())
    check_output(options.filled, source.schema());
  std::vector<std::string> warnings = adapt_source(source.schema(), faces, options.output);
  warn_of_extents(extents_of(source.points()), extents_of(target.points()), warnings);

  std::vector<std::ptrdiff_t> matches;
  const pcs::Fit_report report = fit_table(source, target, landmarks, options, matches, warnings);
  warn(options.source, warnings);
  if (report.status == pcs::Status::numerical_failure)
    throw pcs::Invalid_input(options.source + ": a matrix could not be factorised; more --samples, "
                                              "or another --stiffness, may help, or a source "
                                              "without points far away from all others");
  if (!report.is_plausible)
    warn(options.output, {plausibility_warning(report, !landmarks.empty())});
  pcs::IO::Write_options write_options;
  write_options.faces = faces;
  pcs::IO::write_points(options.output, source, write_options);
  if (!options.filled.empty())
    write_filled(options, unmatched(source, matches));
  if (report_file)
    report_file->commit(to_json(report, options));
  if (!options.is_quiet)
    print_summary(report);
}

} // namespace

} // namespace program

int main(int argc, char** argv)
{
  program::Options options;
  CLI::App app("Deforms a point cloud onto another one without given correspondences.",
               "fit_point_set");
  program::declare(app, options);
  return program::run_program(app,
                              argc,
                              argv,
                              "--source a.ply --target b.ply --output fitted.ply",
                              [&] {
                                program::run(options);
                                return true;
                              });
}

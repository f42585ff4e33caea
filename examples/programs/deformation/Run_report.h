// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The report of a run, as JSON and as a summary.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_RUN_REPORT_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_RUN_REPORT_H

#include "deformation/Deformation_options.h"
#include "deformation/Edit.h"
#include <pcs/core/Deformation_report.h>

#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace program {

class Stopwatch
{
public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - m_start).count(); }

private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point m_start = Clock::now();
};

/// Returns the peak memory of this process, rounded to a tenth. [10^6 byte]
inline double peak_memory()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  constexpr double unit = 1e-6;
#else
  constexpr double unit = 1024e-6; // the system counts in KiB
#endif
  return std::round(10 * unit * static_cast<double>(usage.ru_maxrss)) / 10;
}

struct Run_report
{
  pcs::Deformation_report deformation;
  std::string edit;
  std::uint64_t number_of_points = 0; ///< points of the input; `deformation` counts those in memory
  std::int64_t number_of_inside_points = 0; ///< points that may move
  std::uint64_t number_of_faces = 0;        ///< faces of the output
  std::int64_t number_of_neighbors = 0;
  std::string samples_reason;         ///< why there are that many samples
  std::uint64_t number_of_chunks = 0; ///< 0 unless streamed
  std::vector<std::uint64_t> points_of_handles;
  std::string normals = "none";        ///< none, deformed, or unchanged
  std::optional<int> degree_of_splats; ///< empty: the points are no splats
  std::uint64_t number_of_invalid_splats = 0;
  std::vector<std::string> warnings;
  double seconds_read = 0, seconds_write = 0, seconds_total = 0;
};

/// Adds a warning if parts of the input are not connected to any handle.
inline void warn_of_unreached_points(Run_report& run)
{
  const pcs::Deformation_report& r = run.deformation;
  if (r.number_of_unreached_points > 0)
    run.warnings.push_back(std::to_string(r.number_of_unreached_points) + " points in " +
                           std::to_string(r.number_of_unreached_components) +
                           " part(s) are not connected to any handle and stay unchanged; more "
                           "--neighbors connect parts that touch");
}

/// Says why a run has its number of samples, if that did not depend on the points that are kept.
inline std::string reason_of(const pcs::Deformation_report& report)
{
  const std::string limit = std::to_string(pcs::largest_unsampled_size);
  switch (report.sample_choice) {
  case pcs::Sample_choice::all_points:
    return "all points, there are at most " + limit;
  case pcs::Sample_choice::default_number:
    return report.number_of_points - report.number_of_duplicates > pcs::largest_unsampled_size
               ? "default for more than " + limit + " points"
               : "default of --as-published weights and hops";
  default:
    return "--samples";
  }
}

/// Returns the names of the published variants that are used.
inline std::vector<std::string> published_variants(const Model_options& model)
{
  std::vector<std::string> names;
  for (const char* name : {"weights", "hops", "rotations"})
    if (model.is_published(name))
      names.emplace_back(name);
  return names;
}

/// Adds a warning if published variants of the blending have no effect.
inline void warn_of_unused_variants(Run_report& run, const Model_options& model)
{
  const pcs::Deformation_report& r = run.deformation;
  const bool is_blending_published = model.is_published("weights") || model.is_published("hops");
  if (is_blending_published && r.number_of_samples + r.number_of_duplicates >= r.number_of_points)
    run.warnings.push_back("--as-published weights and hops have no effect, because all points are "
                           "samples; choose fewer --samples");
}

/// Adds a warning if a motion exceeds the limit of the published blending of rotations.
inline void warn_of_lost_turns(Run_report& run, const Model_options& model, const Edit& edit)
{
  constexpr double full_turn = 360; // [degrees]
  if (!model.is_published("rotations"))
    return;
  for (const Handle& handle : edit.handles)
    if (handle.motion.rotation && std::abs(handle.motion.rotation->degrees) > full_turn) {
      std::ostringstream degrees;
      degrees << handle.motion.rotation->degrees;
      run.warnings.push_back("the handle " + handle.pointer + " turns by " + degrees.str() +
                             " degrees; --as-published rotations loses full turns, because "
                             "quaternions represent up to 360 degrees; omit the option");
    }
}

inline nlohmann::ordered_json to_json(const Run_report& run, const Options& options)
{
  const pcs::Deformation_report& r = run.deformation;
  nlohmann::ordered_json json;
  json["program"] = "deform_point_set";
  json["version"] = PCS_PROGRAM_VERSION;
  json["input"] = options.input;
  json["edit"] = run.edit;
  json["output"] = options.output;
  json["status"] = pcs::to_string(r.status);
  json["points"] = run.number_of_points;
  json["points_of_region"] = run.number_of_inside_points;
  json["faces"] = run.number_of_faces;
  json["streamed"] = options.is_streamed;
  if (options.is_streamed) {
    json["kept_points"] = r.number_of_points;
    json["chunks"] = run.number_of_chunks;
    json["points_per_second"] = static_cast<double>(run.number_of_points) / run.seconds_total;
  }
  json["duplicates"] = r.number_of_duplicates;
  json["components"] = r.number_of_components;
  json["unreached_components"] = r.number_of_unreached_components;
  json["unreached_points"] = r.number_of_unreached_points;
  json["points_of_handles"] = run.points_of_handles;
  json["neighbors"] = run.number_of_neighbors;
  json["material"] = {{"poisson_ratio", options.model.poisson_ratio},
                      {"stiffness", options.model.stiffness},
                      {"keeps_volume", !options.model.is_volume_ignored}};
  json["as_published"] = published_variants(options.model);
  json["samples"] = r.number_of_samples;
  json["samples_reason"] = run.samples_reason;
  json["interior_links"] = r.number_of_interior_links;
  json["iterations"] = r.number_of_iterations;
  json["initial_energy"] = r.initial_energy;
  json["energy"] = r.energy;
  json["normals"] = run.normals;
  json["splats"] = run.degree_of_splats ? "deformed" : "none";
  if (run.degree_of_splats) {
    json["splat_degree"] = *run.degree_of_splats;
    json["invalid_splats"] = run.number_of_invalid_splats;
  }
  json["seconds"] = {{"read", run.seconds_read},
                     {"neighbors", r.seconds.neighbors},
                     {"sampling", r.seconds.sampling},
                     {"factorization", r.seconds.factorization},
                     {"solving", r.seconds.solving},
                     {"coarse_levels", r.seconds.coarse_levels}, // of "solving"
                     {"upsampling", r.seconds.upsampling},
                     {"write", run.seconds_write},
                     {"total", run.seconds_total}};
  json["peak_memory_MB"] = peak_memory();
  json["warnings"] = run.warnings;
  return json;
}

inline void print_summary(std::ostream& out, const Run_report& run, const Options& options)
{
  const pcs::Deformation_report& r = run.deformation;
  const auto seconds = [&](const char* stage, double value) {
    char text[64];
    std::snprintf(text, sizeof text, "%s %.3f", stage, value);
    out << text;
  };
  out << "points      " << run.number_of_points << '\n';
  if (options.is_streamed)
    out << "            " << r.number_of_points << " of them kept, in " << run.number_of_chunks
        << " chunks\n";
  if (run.number_of_faces > 0)
    out << "faces       " << run.number_of_faces << '\n';
  if (run.degree_of_splats)
    out << "splats      of degree " << *run.degree_of_splats << ": shapes and colours follow\n";
  out << "samples     " << r.number_of_samples << " (" << run.samples_reason << ")\n"
      << "iterations  " << r.number_of_iterations << '\n'
      << "status      " << r.status << '\n';
  seconds("seconds     read", run.seconds_read);
  seconds(", neighbors", r.seconds.neighbors);
  seconds(", sampling", r.seconds.sampling);
  seconds(", factorization", r.seconds.factorization);
  seconds(",\n            solving", r.seconds.solving);
  seconds(", upsampling", r.seconds.upsampling);
  seconds(", write", run.seconds_write);
  seconds(", total", run.seconds_total);
  out << "\nwritten     " << options.output;
  if (!options.report.empty())
    out << ", " << options.report;
  out << std::endl;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_RUN_REPORT_H

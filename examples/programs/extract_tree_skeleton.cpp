// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: extracts a skeleton with radii, a mesh and tables from the scan of a tree.

#include "common/Progress_line.h"
#include "common/Report_file.h"
#include "common/check_output.h"
#include "common/read_skeleton.h"
#include "common/run_program.h"
#include "common/up_direction.h"
#include "scan/rays_without_return.h"
#include "scan/scan_height.h"
#include "scan/tree_foot.h"
#include "skeleton/Batch_log.h"
#include "skeleton/Skeleton_options.h"
#include "skeleton/point_attributes.h"
#include "skeleton/skeleton_report.h"
#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_mesh.h>
#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/IO/write_tree_tables.h>
#include <pcs/core/errors.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/make_branch_surface.h>
#include <pcs/make_leaf_surface.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/iterator/counting_iterator.hpp>
#include <boost/property_map/function_property_map.hpp>
#include <boost/property_map/property_map.hpp>
#include <boost/range/iterator_range.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace program {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

pcs::Section_fit section_fit(const std::string& name)
{
  using pcs::Section_fit;
  if (name == "ellipse")
    return Section_fit::ellipse;
  if (name == "circle")
    return Section_fit::circle;
  return name == "by_arc" ? Section_fit::by_arc : Section_fit::conic;
}

pcs::Leaf_removal leaf_removal(const Skeleton_options& options, bool is_labelled)
{
  using pcs::Leaf_removal;
  if (is_labelled || options.do_keep_leaves)
    return Leaf_removal::never;
  return options.do_remove_leaves ? Leaf_removal::always : Leaf_removal::where_found;
}

/// Labels of the points.
struct Labels
{
  std::vector<std::size_t> branch;
  std::vector<double> residual;
  std::vector<std::uint8_t> dense, leaf;
  std::vector<Kernel::Vector_3> normal; ///< of the input, then null for points without a branch
};

/// Extracts the skeleton; labels are computed only if they are written, or if the normals of the
/// input are given in them.
template <class Range, class NamedParameters>
pcs::Skeleton_report extract_with_labels(const Range& indices,
                                         const Skeleton_options& options,
                                         Tree& tree,
                                         Labels& labels,
                                         const NamedParameters& np)
{
  if (options.points.empty() && labels.normal.empty())
    return pcs::extract_tree_skeleton(indices, tree, np);
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  const auto map = [&](auto& values) {
    values.resize(indices.size());
    return boost::make_iterator_property_map(values.begin(), identity);
  };
  return pcs::extract_tree_skeleton(indices,
                                    tree,
                                    np.point_is_leaf_map(map(labels.leaf))
                                        .point_branch_map(map(labels.branch))
                                        .point_residual_map(map(labels.residual))
                                        .point_is_dense_map(map(labels.dense))
                                        .normal_map(map(labels.normal)));
}

/// Returns the given root, or the foot that segment_trees wrote to the file.
std::optional<std::array<double, 3>> foot_of(const pcs::IO::Point_table& table,
                                             const Skeleton_options& options)
{
  if (options.root.empty())
    return read_foot(table);
  return std::array<double, 3>{options.root[0], options.root[1], options.root[2]};
}

/// Reads the given skeleton. Returns a warning if trees of its file were left out.
std::string read_given(const Skeleton_options& options, Tree& given)
{
  std::vector<std::int64_t> ids;
  const pcs::IO::Tree_selection selection =
      read_skeleton<Kernel>(options.given, given, ids, options.root_number);
  const std::string warning = warning_of_selection(selection, "--root-number");
  if (num_vertices(given) < 2)
    throw pcs::Invalid_input(options.given + ": the skeleton has fewer than two nodes" +
                             (warning.empty() ? "" : "; " + warning));
  return warning.empty() ? warning : options.given + ": " + warning;
}

pcs::Skeleton_report extract(const std::string& input,
                             const pcs::IO::Point_table& table,
                             const Skeleton_options& options,
                             Tree& tree,
                             Labels& labels,
                             std::vector<std::string>& warnings)
{
  const std::size_t n = table.number_of_points();
  std::string warning_of_wood;
  const std::vector<std::uint8_t> wood =
      wood_of_points(table, options.wood, options.wood_values, warning_of_wood);
  if (!warning_of_wood.empty())
    warnings.push_back(warning_of_wood);
  if (!wood.empty() && !options.is_quiet && (options.do_keep_leaves || options.do_remove_leaves))
    std::cerr << "extract_tree_skeleton: warning: " << input
              << ": the wood labels of the points are used; --keep-leaves and --remove-leaves are "
                 "ignored\n";
  // points are represented by indices, and their attributes by property maps
  const auto indices = boost::make_iterator_range(boost::counting_iterator<std::size_t>(0),
                                                  boost::counting_iterator<std::size_t>(n));
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  const auto points = boost::make_iterator_property_map(table.points().begin(), identity);
  const auto is_wood = boost::make_function_property_map<std::size_t, bool>(
      [&](std::size_t i) { return wood.empty() || wood[i] != 0; });
  const std::vector<long long> stations = stations_of_points(table, options.stations);
  const auto station = boost::make_function_property_map<std::size_t, long long>(
      [&](std::size_t i) { return stations.empty() ? -1 : stations[i]; });
  std::vector<Kernel::Point_3> scanners;
  for (std::size_t k = 0; k + 2 < options.scanners.size(); k += 3)
    scanners.emplace_back(options.scanners[k], options.scanners[k + 1], options.scanners[k + 2]);
  Progress_line line(!options.is_quiet);
  const std::function<bool(double)> callback = [&](double f) {
    line.show("skeleton", f);
    return true;
  };
  pcs::Slice_options slices = options.slices;
  slices.has_normals =
      options.method == "sections" && !options.do_estimate_normals && table.has_normals();
  if (slices.has_normals)
    labels.normal = table.normals();
  slices.fit = section_fit(options.fit);
  slices.do_mark_support = !options.do_fit_all;
  if (options.do_use_all)
    slices.highest_count = 0;
  const auto method = options.method == "automatic"  ? pcs::Skeleton_method::automatic
                      : options.method == "chains"   ? pcs::Skeleton_method::chains
                      : options.method == "sections" ? pcs::Skeleton_method::sections
                                                     : pcs::Skeleton_method::level_sets;
  const auto np = pcs::parameters::point_map(points)
                      .skeleton_method(method)
                      .slice_options(slices)
                      .up_direction(up_direction<Kernel>(options.up))
                      .breast_height(options.breast_height)
                      .number_of_resamples(options.number_of_resamples)
                      .do_register_stations(!options.do_keep_stations)
                      .station_map(station)
                      .do_remove_ground(!options.do_keep_ground)
                      .wood_map(is_wood)
                      .do_continue_trunk(!options.do_keep_trunk)
                      .do_remove_leaves(leaf_removal(options, !wood.empty()))
                      .scanner_positions(scanners)
                      .beam_width(options.beam_milliradians < 0 ? pcs::default_beam_width
                                                                : options.beam_milliradians / 1000)
                      .callback(callback);
  if (!options.given.empty()) {
    Tree given;
    const std::string warning = read_given(options, given);
    if (!warning.empty())
      warnings.push_back(warning);
    return extract_with_labels(indices, options, tree, labels, np.given_skeleton(std::cref(given)));
  }
  const std::optional<std::array<double, 3>> foot = foot_of(table, options);
  if (!foot)
    return extract_with_labels(indices, options, tree, labels, np);
  const Kernel::Point_3 root((*foot)[0], (*foot)[1], (*foot)[2]);
  return extract_with_labels(indices, options, tree, labels, np.root_position(root));
}

nlohmann::ordered_json
write_mesh(const std::string& path, const Skeleton_options& options, const Tree& tree)
{
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto np = pcs::parameters::do_join(!options.do_separate);
  const pcs::Branch_surface_report report =
      options.tolerance >= 0
          ? pcs::make_branch_surface(tree, points, triangles, np.tolerance(options.tolerance))
          : pcs::make_branch_surface(tree, points, triangles, np);
  pcs::IO::write_mesh(path, points, triangles);
  return {{"vertices", report.number_of_points},
          {"triangles", report.number_of_triangles},
          {"joined_branches", report.number_of_joined},
          {"separate_branches", report.number_of_separate}};
}

std::size_t write_leaves(const std::string& path, const Tree& tree)
{
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  const std::size_t count = pcs::make_leaf_surface(tree, points, triangles);
  pcs::IO::write_mesh(path, points, triangles);
  return count;
}

/// Writes the points; if `do_commit` is false, only checks that the file can be written.
void write_points_to(const std::string& path,
                     pcs::IO::Point_table table,
                     const Labels& labels,
                     bool do_commit)
{
  std::vector<std::int32_t> branch;
  for (const std::size_t b : labels.branch)
    branch.push_back(b == pcs::npos ? -1 : static_cast<std::int32_t>(b));
  for (const char* name : {"branch", "dense", "residual", "leaf"})
    if (table.has_property(name))
      table.remove_property(name);
  table.add_property("branch", branch);
  table.add_property("dense", labels.dense);
  table.add_property("residual",
                     std::vector<float>(labels.residual.begin(), labels.residual.end()));
  table.add_property("leaf", labels.leaf);
  table.set_normals(labels.normal);
  if (do_commit)
    pcs::IO::write_points(path, table);
  else
    check_output(path, table.schema());
}

void write_tables(const Skeleton_options& options, const Tree& tree, const pcs::Tree_values& errors)
{
  const Kernel::Vector_3 up = up_direction<Kernel>(options.up);
  if (!options.cylinders.empty())
    pcs::IO::write_cylinders(options.cylinders, tree);
  if (!options.branches.empty())
    pcs::IO::write_branches(options.branches, tree, up);
  if (!options.tree_table.empty())
    pcs::IO::write_tree_table(options.tree_table, tree, up, options.breast_height, errors);
  if (!options.edges.empty())
    pcs::IO::write_ply_edges(options.edges, tree);
}

nlohmann::ordered_json work_on(const std::string& input, const Skeleton_options& options)
{
  for (const std::string* path : {&options.swc,
                                  &options.mesh,
                                  &options.leaves,
                                  &options.cylinders,
                                  &options.branches,
                                  &options.tree_table,
                                  &options.edges,
                                  &options.points})
    if (!path->empty())
      const pcs::IO::internal::Output_file probe(*path); // is not committed
  pcs::internal::Stopwatch watch;
  pcs::IO::Point_table table = pcs::IO::read_points(input);
  const std::size_t number_of_empty_rays = remove_rays_without_return(table);
  if (!options.points.empty()) {
    pcs::IO::Point_table labelled(table.schema());
    write_points_to(options.points, std::move(labelled), Labels(), false);
  }
  const double reading = watch.lap();
  Tree tree;
  Labels labels;
  std::vector<std::string> warnings; // of the input
  const pcs::Skeleton_report report = extract(input, table, options, tree, labels, warnings);
  if (report.status != pcs::Status::converged)
    throw pcs::Invalid_input(
        "there is no tree in this scan (" + std::to_string(report.number_of_points) + " points); " +
        advice_of_height(scan_height(table, options.up), options.breast_height));
  nlohmann::ordered_json json = to_json(input, report);
  for (const std::string& sentence : table.schema().warnings)
    json["warnings"].push_back(sentence);
  if (number_of_empty_rays > 0)
    warnings.push_back(warning_of_rays(number_of_empty_rays));
  for (const std::string& sentence : warnings)
    json["warnings"].push_back(sentence);
  if (!options.is_quiet)
    for (const std::string sentence : json["warnings"])
      std::cerr << "extract_tree_skeleton: warning: " << input << ": " << sentence << '\n';
  watch.lap();
  if (!options.mesh.empty())
    json["mesh"] = write_mesh(options.mesh, options, tree);
  if (!options.leaves.empty())
    json["leaves"] = write_leaves(options.leaves, tree);
  const double meshing = watch.lap();
  write_tables(options, tree, pcs::standard_errors(report));
  if (!options.points.empty())
    write_points_to(options.points, std::move(table), labels, true);
  pcs::IO::write_swc(options.swc, tree);
  json["seconds"]["reading"] = reading;
  json["seconds"]["mesh"] = meshing;
  json["seconds"]["writing"] = watch.lap();
  return json;
}

/// Processes one scan. Throws if it contains no tree, or beforehand if a result cannot be written.
nlohmann::ordered_json run_one(const std::string& input, const Skeleton_options& options)
{
  try {
    return work_on(input, options);
  } catch (const pcs::Invalid_input& e) {
    throw pcs::Invalid_input(input + ": " + in_options(e.what()));
  }
}

/// Returns an estimate of the report with its standard error, if known.
std::string estimate(const nlohmann::ordered_json& report, const char* key)
{
  if (report[key].is_null())
    return "none";
  const auto digits = [](const nlohmann::ordered_json& value, int count) {
    std::ostringstream text;
    text << std::setprecision(count) << value.get<double>();
    return text.str();
  };
  const std::string value = digits(report[key], 4);
  return report.count("standard_errors") > 0
             ? value + " +- " + digits(report["standard_errors"][key], 2)
             : value;
}

void run_single(const Skeleton_options& options)
{
  std::unique_ptr<Report_file> file;
  if (!options.report.empty())
    file = std::make_unique<Report_file>(options.report);
  const nlohmann::ordered_json json = run_one(options.inputs.front(), options);
  if (file)
    file->commit(json);
  if (!options.is_quiet)
    std::cout << "branches " << json["branches"] << ", nodes " << json["nodes"] << ", height "
              << estimate(json, "height") << ", diameter at breast height "
              << estimate(json, "diameter_at_breast_height") << ", length "
              << estimate(json, "length") << ", volume " << estimate(json, "volume") << '\n';
}

/// Processes several scans. Returns whether all have a skeleton.
bool run_batch(const Skeleton_options& options)
{
  Batch_log log(options.folder);
  std::size_t done_before = 0, done_now = 0;
  for (const std::string& input : options.inputs) {
    const Skeleton_options one = options_of_one(input, options);
    const nlohmann::ordered_json origin = origin_of(input, one);
    nlohmann::ordered_json json;
    bool is_ours = false;
    try {
      log.check_owner(one, origin);
      is_ours = true;
      if (log.is_done(one, origin)) {
        ++done_before;
        continue;
      }
      json = run_one(input, one);
    } catch (const std::exception& e) { // the batch continues after a failed scan
      const std::string what = e.what(),
                        scan = what.find(input) == std::string::npos ? input + ": " : "";
      std::cerr << "extract_tree_skeleton: " << scan << what << '\n';
      if (is_ours)
        log.remove_outdated(one, origin);
      log.add_failure(input, scan + what);
      continue;
    }
    log.add_success(one, origin, json);
    ++done_now;
  }
  if (!options.is_quiet)
    std::cout << done_before + done_now << " of " << options.inputs.size()
              << " scans have a skeleton, " << done_before << " of them from previous runs; see "
              << log.path().string() << '\n';
  return done_before + done_now == options.inputs.size();
}

} // namespace program

int main(int argc, char** argv)
{
  program::Skeleton_options options;
  CLI::App app("Finds the branches of a tree in a scan: their axes, radii and connection.",
               "extract_tree_skeleton");
  program::declare(app, options);
  return program::run_program(app,
                              argc,
                              argv,
                              "--input tree.ply --swc tree.swc --mesh mesh.ply",
                              [&] {
                                program::check(options);
                                if (!options.folder.empty())
                                  return program::run_batch(options);
                                program::run_single(options);
                                return true;
                              });
}

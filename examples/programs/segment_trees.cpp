// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: segments the scan of a stand into individual trees.

#include "common/Distinct_files.h"
#include "common/Progress_line.h"
#include "common/Report_file.h"
#include "common/check_output.h"
#include "common/run_program.h"
#include "common/up_direction.h"
#include "scan/Files_of_trees.h"
#include "scan/rays_without_return.h"
#include "scan/scan_height.h"
#include "scan/tree_foot.h"
#include "tiling/Tile_result.h"
#include "tiling/Tile_segmentation.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/core/errors.h>
#include <pcs/internal/unit_of_height.h>
#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/iterator/counting_iterator.hpp>
#include <boost/property_map/property_map.hpp>
#include <boost/range/iterator_range.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace program {

struct Options
{
  std::string input, folder, points, report, tile_results;
  std::optional<std::string> up;
  double breast_height = pcs::default_breast_height;
  std::size_t min_points = 1000;
  bool do_keep_ground = false, is_quiet = false;
};

const char* help()
{
  return R"(Scans: PLY, LAS (LAZ if built with LASzip), PCD, PTX, OFF, OBJ, or text (xyz, txt, csv,
asc, pts, pwn), also compressed by gzip (.gz) if built with zlib.
Folder: DIR/SCAN_1.ply, DIR/SCAN_2.ply, ..., trees with the thickest stems first, with all
properties of their points and the foot of the tree as a comment. extract_tree_skeleton reads the
foot, and processes all files with its own --folder. Files of trees of an earlier run are replaced,
but no other files.
Points: the scan with the property `tree` (-1: ground, or not part of a tree).
Tile results: for a tile of tile_points, in the folder of its tiles.json. DIR/NAME.ply has the
points of the core with all properties and `tree`, DIR/NAME.json the trees with their feet, and
whether they touch the outer rim of the buffer. A tile without trees is a result, too. merge_tiles
merges the results of all tiles.
Ray clouds (PLY with `time` and `alpha`): rays without return, whose alpha is 0, are left out.

Exit codes: 0 success, 1 bad input, bad usage or no tree (except in a tile), 2 internal error.)";
}

void declare(CLI::App& app, Options& options)
{
  app.footer(help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--input", options.input, "the scan of a stand")->required();
  app.add_option("--folder", options.folder, "folder for one file per tree");
  app.add_option("--points", options.points, "the scan with the tree label of every point");
  app.add_option("--tile-results",
                 options.tile_results,
                 "folder for the results of a tile, which merge_tiles reads");
  app.add_option("--report",
                 options.report,
                 "trees, counts and seconds (JSON); -: standard output");
  app.add_option("--min-points", options.min_points, "trees with fewer points get no file")
      ->check(CLI::Range(std::int64_t(0), std::int64_t(1) << 53))
      ->capture_default_str();
  add_up(app, options.up, "up direction", "; default: that of the tile results, else z");
  app.add_option("--breast-height",
                 options.breast_height,
                 "height of the diameter of stems, which scales all size limits")
      ->capture_default_str();
  app.add_flag("--keep-ground", options.do_keep_ground, "keep ground points");
  app.add_flag("--quiet", options.is_quiet, "print errors only");
}

void make_folder(const std::string& folder)
{
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder))
    throw pcs::IO_error(folder, "is not a directory and cannot be made one");
}

/// Returns which trees get a file.
std::vector<bool> trees_with_file(const Options& options, const pcs::Segmentation_report& r)
{
  std::vector<bool> result;
  for (const pcs::Segmented_tree& tree : r.trees)
    result.push_back(!options.folder.empty() && tree.number_of_points >= options.min_points);
  return result;
}

/// Returns warnings about the files of trees.
std::vector<std::string> warnings_of_files(const Options& options,
                                           const pcs::Segmentation_report& r)
{
  std::vector<std::string> sentences;
  if (options.folder.empty())
    return sentences;
  const std::vector<bool> has_file = trees_with_file(options, r);
  const auto small = std::count(has_file.begin(), has_file.end(), false);
  if (small > 0)
    sentences.push_back(std::to_string(small) + " of " + std::to_string(has_file.size()) +
                        " trees have fewer than --min-points " +
                        std::to_string(options.min_points) + " points and get no file");
  const std::size_t others =
      Files_of_trees(options.input, options.folder).number_of_others(has_file);
  if (others > 0)
    sentences.push_back(options.folder + " has " + std::to_string(others) +
                        " files of trees of another run of this scan; remove them");
  return sentences;
}

nlohmann::ordered_json to_json(const Options& options, const pcs::Segmentation_report& r)
{
  const std::vector<bool> has_file = trees_with_file(options, r);
  nlohmann::ordered_json trees = nlohmann::ordered_json::array();
  for (std::size_t t = 0; t < r.trees.size(); ++t) {
    const pcs::Segmented_tree& tree = r.trees[t];
    nlohmann::ordered_json row = {{"tree", t},
                                  {"foot", tree.foot},
                                  {"radius", tree.radius},
                                  {"diameter_at_breast_height", tree.diameter_at_breast_height},
                                  {"height", tree.height},
                                  {"foot_above_ground", tree.foot_above_ground},
                                  {"deviations", tree.deviations},
                                  {"points", tree.number_of_points}};
    if (has_file[t])
      row["file"] = Files_of_trees(options.input, options.folder).path_of(t);
    trees.push_back(row);
  }
  return {{"input", options.input},
          {"status", to_string(r.status)},
          {"points", r.number_of_points},
          {"unassigned_points", r.number_of_unassigned_points},
          {"low_plants", r.number_of_low_plants},
          {"trees", trees},
          {"warnings", pcs::warnings(r)},
          {"seconds", r.seconds}};
}

/// Writes the tree of each point as a 32-bit number, -1 for none.
struct Label_map
{
  using key_type = std::size_t;
  using value_type = std::size_t;
  using reference = std::size_t;
  using category = boost::writable_property_map_tag;

  std::int32_t* labels;

  friend void put(const Label_map& map, std::size_t point, std::size_t tree)
  {
    map.labels[point] = tree == pcs::npos ? -1 : static_cast<std::int32_t>(tree);
  }
};

pcs::Segmentation_report
segment(const pcs::IO::Point_table& table, const Options& options, std::vector<std::int32_t>& trees)
{
  const std::size_t n = table.number_of_points();
  trees.assign(n, -1);
  // points are represented by indices, and their attributes by property maps
  const auto indices = boost::make_iterator_range(boost::counting_iterator<std::size_t>(0),
                                                  boost::counting_iterator<std::size_t>(n));
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  Progress_line line(!options.is_quiet);
  const std::function<bool(double)> callback = [&](double f) {
    line.show("trees", f);
    return true;
  };
  const pcs::Segmentation_report report = pcs::segment_trees(
      indices,
      Label_map{trees.data()},
      pcs::parameters::point_map(
          boost::make_iterator_property_map(table.points().begin(), identity))
          .up_direction(up_direction<pcs::IO::Point_table::Kernel>(options.up.value_or("z")))
          .breast_height(options.breast_height)
          .do_remove_ground(!options.do_keep_ground)
          .callback(callback));
  line.clear();
  return report;
}

void write_trees(const pcs::IO::Point_table& table,
                 const Options& options,
                 const pcs::Segmentation_report& report,
                 const std::vector<std::int32_t>& trees)
{
  // the points of all trees, grouped by tree
  std::vector<std::size_t> first(report.trees.size() + 1, 0);
  for (std::size_t t = 0; t < report.trees.size(); ++t)
    first[t + 1] = first[t] + report.trees[t].number_of_points;
  std::vector<std::uint32_t> points(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < trees.size(); ++i)
    if (trees[i] >= 0)
      points[next[static_cast<std::size_t>(trees[i])]++] = static_cast<std::uint32_t>(i);
  const Files_of_trees files(options.input, options.folder);
  const std::vector<bool> has_file = trees_with_file(options, report);
  for (std::size_t t = 0; t < report.trees.size(); ++t)
    if (has_file[t]) {
      const auto begin = points.begin();
      const std::vector<std::size_t> chosen(begin + static_cast<std::ptrdiff_t>(first[t]),
                                            begin + static_cast<std::ptrdiff_t>(first[t + 1]));
      pcs::IO::Point_table tree = table.select(chosen);
      write_foot(report.trees[t].foot, tree);
      pcs::IO::write_points(files.path_of(t), tree);
    }
}

/// Prepares the results of a tile; null if they are not wanted. Sets the up direction.
std::unique_ptr<Tile_segmentation> open_tile(Options& options, Distinct_files& files)
{
  if (options.tile_results.empty())
    return nullptr;
  const std::string name = std::filesystem::path(options.input).filename().string();
  files.add_output(points_of_result(options.tile_results, name));
  files.add_output(trees_of_result(options.tile_results, name));
  make_folder(options.tile_results);
  auto tile = std::make_unique<Tile_segmentation>(options.input, options.tile_results);
  if (options.up.value_or(tile->up()) != tile->up())
    throw pcs::Invalid_input("--up is " + *options.up + ", but the tiles were made with " +
                             tile->up() + "; leave out --up");
  options.up = tile->up();
  return tile;
}

/// Segments the points. If there are too few points for a tree, a tile has none.
pcs::Segmentation_report segment_scan(const pcs::IO::Point_table& table,
                                      const Options& options,
                                      std::vector<std::int32_t>& trees)
{
  std::set<pcs::IO::Point_table::Point_3> places;
  for (const auto& p : table.points())
    if (places.size() < pcs::lowest_number_of_scan_points)
      places.insert(p);
  if (options.tile_results.empty() || places.size() == pcs::lowest_number_of_scan_points)
    return segment(table, options, trees);
  pcs::Segmentation_report report;
  report.number_of_points = report.number_of_unassigned_points = table.number_of_points();
  report.breast_height = options.breast_height;
  trees.assign(table.number_of_points(), -1);
  return report;
}

/// Writes the results of a tile. Returns warnings.
std::vector<std::string> write_tile(const Tile_segmentation& tile,
                                    const pcs::IO::Point_table& table,
                                    const std::vector<std::int32_t>& trees,
                                    const pcs::Segmentation_report& report)
{
  Report_file file(tile.path_of_trees());
  const Tile_result result = tile.write_points(table, trees, report);
  const std::vector<std::string> warnings = Tile_segmentation::warnings(result);
  nlohmann::ordered_json json = to_json(result);
  json["warnings"] = warnings;
  file.commit(json);
  return warnings;
}

/// Checks that the results can be written.
void check_outputs(const Options& options, const pcs::IO::Point_table& table)
{
  if (!options.folder.empty()) {
    make_folder(options.folder);
    check_output(Files_of_trees(options.input, options.folder).path_of(0), table.schema());
  }
  if (!options.points.empty()) {
    pcs::IO::Point_table labelled(table.schema());
    labelled.add_property("tree", std::vector<std::int32_t>());
    check_output(options.points, labelled.schema());
  }
}

/// Warns before the work, which takes long if the scan has another unit than breast height.
void warn_of_height(const Options& options, double height)
{
  std::vector<std::string> sentences;
  pcs::internal::warn_of_unit("the scan", height, options.breast_height, sentences);
  for (const std::string& sentence : sentences)
    if (!options.is_quiet)
      std::cerr << "segment_trees: warning: " << options.input << ": " << sentence << std::endl;
}

void run(Options& options)
{
  if (options.folder.empty() && options.points.empty() && options.report.empty() &&
      options.tile_results.empty())
    throw pcs::Invalid_input("one of --folder, --points, --report and --tile-results is required");
  const Files_of_trees files_of_trees(options.input, options.folder);
  if (!options.folder.empty())
    for (const std::string& path : {options.points, options.report})
      files_of_trees.check_result(path);
  Distinct_files files;
  files.add_input(options.input);
  files.add_output(options.points);
  files.add_output(options.report);
  const std::unique_ptr<Tile_segmentation> tile = open_tile(options, files);
  std::unique_ptr<Report_file> report_file;
  if (!options.report.empty())
    report_file = std::make_unique<Report_file>(options.report);
  pcs::IO::Point_table table = pcs::IO::read_points(options.input);
  const std::size_t number_of_empty_rays = remove_rays_without_return(table);
  if (table.has_property("tree"))
    table.remove_property("tree");
  check_outputs(options, table);
  const double height = scan_height(table, options.up.value_or("z"));
  warn_of_height(options, height);

  std::vector<std::int32_t> trees;
  const pcs::Segmentation_report report = segment_scan(table, options, trees);
  if (report.status != pcs::Status::converged && !tile)
    throw pcs::Invalid_input(options.input + ": no stem was found in this scan (" +
                             std::to_string(report.number_of_points) +
                             " points); fallen trees and stumps are no stems; " +
                             advice_of_height(height, options.breast_height));
  if (!options.folder.empty())
    files_of_trees.check_replaced(trees_with_file(options, report));
  nlohmann::ordered_json json = to_json(options, report);
  for (const std::string& warning : warnings_of_files(options, report))
    json["warnings"].push_back(warning);
  if (tile)
    for (const std::string& warning : write_tile(*tile, table, trees, report))
      json["warnings"].push_back(warning);
  if (!options.folder.empty())
    write_trees(table, options, report, trees);
  if (!options.points.empty()) {
    table.add_property("tree", std::move(trees));
    pcs::IO::write_points(options.points, table);
  }
  for (const std::string& warning : table.schema().warnings)
    json["warnings"].push_back(warning);
  if (number_of_empty_rays > 0)
    json["warnings"].push_back(warning_of_rays(number_of_empty_rays));
  if (report_file)
    report_file->commit(json);
  for (const std::string warning : json["warnings"])
    if (!options.is_quiet)
      std::cerr << "segment_trees: warning: " << options.input << ": " << warning << '\n';
  if (!options.is_quiet)
    std::cout << "trees " << report.trees.size() << ", unassigned points "
              << report.number_of_unassigned_points << " of " << report.number_of_points
              << ", seconds " << report.seconds << '\n';
}

} // namespace program

int main(int argc, char** argv)
{
  program::Options options;
  CLI::App app("Segments the scan of a stand into individual trees.", "segment_trees");
  program::declare(app, options);
  return program::run_program(app, argc, argv, "--input stand.ply --folder trees", [&] {
    program::run(options);
    return true;
  });
}

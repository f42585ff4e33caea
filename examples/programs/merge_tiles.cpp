// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: merges the segmented tiles of a plot.

#include "common/Distinct_files.h"
#include "common/Report_file.h"
#include "common/check_output.h"
#include "common/run_program.h"
#include "crowns/Plot_crowns.h"
#include "tiling/Labelled_blocks.h"
#include "tiling/Labelled_tiles.h"
#include "tiling/Ordered_points.h"
#include "tiling/Plot_trees.h"
#include "tiling/Tile_manifest.h"
#include "tiling/Tile_result.h"
#include "tiling/Tree_files.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>
#include <pcs/internal/Stopwatch.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace program {

using Ordered_json = nlohmann::ordered_json;

/// The tolerance of feet in breast heights: feet of one tree in two tiles differ by centimetres,
/// stems of two trees by more [-].
constexpr double tolerance_by_breast_height = 0.25;

struct Options
{
  std::string tiles, results, table, points, folder, crowns, report;
  std::optional<double> tolerance, crown_base;
  std::int64_t min_points = 1000;
  std::int64_t open_files = 100;
  bool is_quiet = false;
};

const char* help()
{
  return R"(Tiles: tiles.json of tile_points, beside the tiles.
Results: the folder of segment_trees --tile-results, the same for all tiles.
Trees: a tree belongs to the tile whose core holds its foot. A tree of another tile is the tree of
that tile with the nearest foot, by horizontal distance, at most --tolerance away, or else the one
with the nearest foot in any other tile. A tree without such a foot is unmatched: its points have no
tree, and the report lists it. Trees of two tiles with feet within --tolerance on both sides of a
border are one tree of the tile listed first if they share more than half of their points (by
samples of segment_trees). Trees are numbered from 0 by descending radius, so the numbers do not
depend on the order in which tiles were segmented.
Table: one row per tree (CSV): tree, x, y, z (of the foot), radius, diameter_at_breast_height,
height, points, tile, parts (tiles whose cores have points of it), is_at_rim (it touches the outer
rim of the buffer of its tile), cut_parts (other tiles where it does), file, crown_area (of the
convex hull, in the plan, of the points at least --crown-base above the foot), crown_volume (sum of
the areas of the convex hulls of layers, times their height: 0.5 / 1.3 of the breast height, that is
half a metre), warnings (of segment_trees about this tree, as in the report and in the outlines of
the crowns).
Crowns: the convex hulls in the plan (GeoJSON polygons in the coordinates of the scan). There are no
standard errors of crowns: how far single points lie outside a crown is not known.
Points: all points of the plot in the order of `index`, with the property `tree` (-1: none). If the
tiles were thinned by --voxel, these are the points before thinning, and each has the tree of the
kept point of its voxel. The table and the files of trees count and have the kept points.
Folder: DIR/tree_000000.ply, ..., one file per tree with the foot as a comment, for
extract_tree_skeleton.
A missing or damaged result is named, and the other tiles are merged. The points of its core are
taken from the tile, without a tree.
Memory: the trees of all tiles, and some 500,000 points; 60 MB for crowns. With --points after
--voxel, 12 bytes per kept point of the tiles that overlap one block.

For example:
  tile_points --input plot_a.laz plot_b.laz --folder tiles
  segment_trees --input tiles/tile_0001.ply --tile-results segmented
  (the same for all other tiles)
  merge_tiles --tiles tiles/tiles.json --results segmented --table trees.csv --folder trees

Exit codes: 0 success, 1 bad input or usage, or a result is missing or damaged, 2 internal error.)";
}

void declare(CLI::App& app, Options& options)
{
  app.footer(help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--tiles", options.tiles, "tiles.json of the plot")->required();
  app.add_option("--results", options.results, "folder of the results of all tiles")->required();
  app.add_option("--table", options.table, "the trees of the plot (CSV)");
  app.add_option("--points", options.points, "all points with their tree");
  app.add_option("--folder", options.folder, "folder for one file per tree");
  app.add_option("--crowns", options.crowns, "outlines of the crowns (GeoJSON)");
  app.add_option("--crown-base",
                 options.crown_base,
                 "height above the foot where crowns begin; default: breast height");
  app.add_option("--report",
                 options.report,
                 "counts, missing tiles, unmatched trees (JSON); -: standard output");
  app.add_option("--tolerance",
                 options.tolerance,
                 "largest distance of feet of one tree; default: a quarter of the breast height");
  app.add_option("--min-points", options.min_points, "trees with fewer points get no file")
      ->check(CLI::Range(std::int64_t(0), std::int64_t(1) << 53))
      ->capture_default_str();
  app.add_option("--open-files", options.open_files, "files that are open at the same time")
      ->check(CLI::Range(std::int64_t(2), std::int64_t(10000)))
      ->capture_default_str();
  app.add_flag("--quiet", options.is_quiet, "print errors only");
}

/// Checks the options further than CLI11 can. Throws `pcs::Invalid_input`.
void check(const Options& options)
{
  if (options.table.empty() && options.points.empty() && options.folder.empty() &&
      options.crowns.empty() && options.report.empty())
    throw pcs::Invalid_input("one of --table, --points, --folder, --crowns and --report is "
                             "required");
  if (options.crown_base && !(*options.crown_base >= 0 && std::isfinite(*options.crown_base)))
    throw pcs::Invalid_input("--crown-base is " + std::to_string(*options.crown_base) +
                             ", expected a length of 0 or more");
  if (options.crown_base && options.table.empty() && options.crowns.empty())
    throw pcs::Invalid_input("--crown-base has no effect without --table or --crowns");
  if (options.tolerance && !(*options.tolerance >= 0 && std::isfinite(*options.tolerance)))
    throw pcs::Invalid_input("--tolerance is " + std::to_string(*options.tolerance) +
                             ", expected a length of 0 or more");
  if (!std::filesystem::is_directory(options.results))
    throw pcs::IO_error(options.results, "is not a directory, expected the results of the tiles");
}

/// Returns whether a path is that of a file of a tree in a folder.
bool is_tree_file(const std::string& path, const std::string& folder)
{
  const auto real = [](const std::filesystem::path& p) {
    std::error_code error;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(p), error);
  };
  const std::filesystem::path file(path);
  return !path.empty() && Tree_files::is_name(file.filename().string()) &&
         real(file).parent_path() == real(std::filesystem::path(folder) / "x").parent_path();
}

/// Checks that the points can be written, before anything is computed.
void check_points(const std::string& path)
{
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".las" || extension == ".laz")
    throw pcs::Invalid_input(
        "--points " + path +
        " is LAS or LAZ, which cannot be merged from tiles; write PLY or text, "
        "and convert it");
  check_output(path, pcs::IO::Point_schema());
}

/// Refuses results that would replace inputs, or each other.
void check_files(const Options& options, const Tile_manifest& manifest)
{
  Distinct_files distinct;
  distinct.add_input(options.tiles);
  for (std::size_t b = 0; b < manifest.blocks().size(); ++b)
    distinct.add_input(manifest.path_of_block(b));
  for (std::size_t t = 0; t < manifest.tiles().size(); ++t) {
    const std::string& name = manifest.tiles()[t].file;
    distinct.add_input(manifest.path_of(t));
    distinct.add_input(points_of_result(options.results, name));
    distinct.add_input(trees_of_result(options.results, name));
  }
  for (const std::string& path : {options.table, options.points, options.crowns, options.report}) {
    distinct.add_output(path);
    if (!options.folder.empty() && is_tree_file(path, options.folder))
      throw pcs::Invalid_input(path + " has the name of a file of a tree in --folder; choose "
                                      "another name");
  }
}

void make_folder(const std::string& folder)
{
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder))
    throw pcs::IO_error(folder, "is not a directory and cannot be made one");
}

std::string number(double value)
{
  return Ordered_json(value).dump(); // the shortest text that is read back as the same number
}

/// A tile whose result, or a block whose points could not be used.
struct Failure
{
  std::string tile, reason;
};

/// The merged plot, and its description.
struct Merged_plot
{
  Merged_plot(const Tile_manifest& manifest, const Options& options)
    : tiles(manifest, options.results, [&](std::size_t t, const std::string& reason) {
        failures.push_back({manifest.tiles()[t].file, reason});
      })
  {
    breast_height = common_breast_height(manifest);
    if (!(breast_height > 0))
      throw pcs::IO_error(options.results,
                          "has no result of a tile of " + options.tiles + "; " +
                              failures.front().tile + ": " + failures.front().reason);
    tolerance = options.tolerance.value_or(tolerance_by_breast_height * breast_height);
    trees = std::make_unique<Plot_trees>(manifest, tiles.results(), tolerance);
    count_points(manifest);
    if (!options.table.empty() || !options.crowns.empty()) {
      const double base = options.crown_base.value_or(breast_height);
      const Plot_crowns found(manifest, tiles, *trees, base, breast_height);
      crowns = found.measures();
      for (std::size_t p = 0; p < crowns.size(); ++p)
        if (found.is_too_high()[p])
          trees_without_crown.push_back(std::to_string(p));
    }
    if (!options.points.empty() && !manifest.blocks().empty())
      blocks = std::make_unique<Labelled_blocks>(
          manifest,
          tiles,
          *trees,
          options.points,
          [&](std::size_t b, const std::string& reason) {
            failed_blocks.push_back({manifest.blocks()[b].file, reason});
          });
  }

  std::vector<Failure> failures; ///< filled while the tiles are read
  Labelled_tiles tiles;
  double breast_height = 0, tolerance = 0; ///< tolerance of feet [L]
  std::unique_ptr<Plot_trees> trees;
  std::unique_ptr<Labelled_blocks> blocks; ///< if all points of a thinned plot are wanted
  std::vector<Failure> failed_blocks;
  std::vector<pcs::crowns::Crown_measures> crowns; ///< of each tree, if they are wanted
  std::vector<std::string> trees_without_crown;    ///< because of a point too far above the foot
  std::vector<std::uint64_t> points;               ///< of each tree
  std::vector<double> heights;                     ///< of each tree [L]
  std::uint64_t number_of_points = 0, unassigned_points = 0, unmatched_points = 0;
  std::size_t number_of_results = 0; ///< tiles with a result

private:
  /// Returns the breast height of all results; 0 without results. Throws if they differ.
  double common_breast_height(const Tile_manifest& manifest) const
  {
    double height = 0;
    std::size_t first = 0; // tile with a result
    for (std::size_t t = 0; t < manifest.tiles().size(); ++t) {
      const auto& result = tiles.results()[t];
      if (result && height > 0 && result->breast_height != height)
        throw pcs::Invalid_input(
            manifest.tiles()[first].file + " was segmented with --breast-height " + number(height) +
            ", but " + manifest.tiles()[t].file + " with " + number(result->breast_height) +
            "; segment all tiles with the same breast height");
      if (result && height == 0) {
        height = result->breast_height;
        first = t;
      }
    }
    return height;
  }

  void count_points(const Tile_manifest& manifest)
  {
    const double sign = manifest.up().front() == '-' ? -1 : 1;
    points.assign(trees->trees().size(), 0);
    heights.assign(trees->trees().size(), 0);
    std::uint64_t assigned = 0;
    for (std::size_t t = 0; t < manifest.tiles().size(); ++t) {
      if (tiles.source(t) != Labelled_tiles::Source::none)
        number_of_points += manifest.tiles()[t].number_of_core_points;
      number_of_results += tiles.source(t) == Labelled_tiles::Source::result;
      for (std::size_t k = 0; k < tiles.parts(t).size(); ++k) {
        const Part_of_core& part = tiles.parts(t)[k];
        if (trees->trees_of_tile(t)[k] == Plot_trees::no_tree) {
          unmatched_points += part.number_of_points;
          continue;
        }
        const auto p = static_cast<std::size_t>(trees->trees_of_tile(t)[k]);
        const double foot = sign * trees->trees()[p].foot[manifest.axis_up()];
        assigned += part.number_of_points;
        points[p] += part.number_of_points;
        heights[p] = std::max(heights[p], part.highest - foot);
      }
    }
    unassigned_points = number_of_points - assigned;
  }
};

/// Returns up to eight numbers as a list.
std::string list(const std::vector<std::string>& items)
{
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, items.size()); ++i)
    text += (i == 0 ? "" : ", ") + items[i];
  return text + (items.size() > most ? ", ..." : "");
}

/// Returns the warnings of the segmentation about a tree of the plot.
std::string warnings_of_tree(const Merged_plot& plot, std::size_t tree)
{
  const Plot_tree& own = plot.trees->trees()[tree];
  std::string text;
  for (const std::string& warning :
       plot.tiles.results()[own.tile]->trees[own.tree_of_tile].warnings)
    text += (text.empty() ? "" : "; ") + warning;
  return text;
}

/// Returns a text as a field of a CSV file.
std::string quoted(const std::string& text)
{
  if (text.find_first_of(",\"\r\n") == std::string::npos)
    return text;
  std::string field = "\"";
  for (const char c : text)
    field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

/// Returns whether a tree gets a file.
bool has_file(const Options& options, std::uint64_t number_of_points)
{
  return !options.folder.empty() &&
         number_of_points >= static_cast<std::uint64_t>(options.min_points);
}

/// Adds warnings about the files of trees.
void warn_of_files(const Options& options,
                   const Merged_plot& plot,
                   std::vector<std::string>& warnings)
{
  if (options.folder.empty())
    return;
  const auto small = std::count_if(plot.points.begin(), plot.points.end(), [&](std::uint64_t n) {
    return !has_file(options, n);
  });
  if (small > 0)
    warnings.push_back(std::to_string(small) + " of " + std::to_string(plot.points.size()) +
                       " trees have fewer than --min-points " + std::to_string(options.min_points) +
                       " points and get no file");
  std::size_t others = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(options.folder, error)) {
    const std::string name = entry.path().filename().string();
    others += Tree_files::is_name(name) && name >= Tree_files::name_of(plot.points.size());
  }
  if (others > 0)
    warnings.push_back(options.folder + " has " + std::to_string(others) +
                       " files of trees of another run; remove them");
}

std::vector<std::string>
all_warnings(const Tile_manifest& manifest, const Options& options, const Merged_plot& plot)
{
  std::vector<std::string> warnings;
  for (const std::string& scan : manifest.skipped())
    warnings.push_back("the plot is incomplete: tile_points left out the damaged scan " + scan);
  for (const Failure& failure : plot.failures)
    warnings.push_back(failure.tile + " has no result: " + failure.reason);
  for (const Failure& failure : plot.failed_blocks)
    warnings.push_back("the points of " + failure.tile + " are missing in " + options.points +
                       ": " + failure.reason);
  const std::string tolerance = number(plot.tolerance);
  std::vector<std::string> items;
  for (const auto& [t, k] : plot.trees->unmatched())
    items.push_back(std::to_string(k) + " of " + manifest.tiles()[t].file);
  if (!items.empty())
    warnings.push_back(std::to_string(items.size()) + " tree(s) of tiles with " +
                       std::to_string(plot.unmatched_points) + " points match no foot within " +
                       tolerance + ": " + list(items) +
                       "; their points have no tree; use a larger --buffer or --tolerance");
  items.clear();
  for (const auto& [t, k] : plot.trees->missed()) {
    const Position_2 p = plot.trees->position(plot.tiles.results()[t]->trees[k].foot);
    items.push_back("(" + number(p[0]) + ", " + number(p[1]) + ")");
  }
  if (!items.empty())
    warnings.push_back(std::to_string(items.size()) +
                       " tree(s) are found in the buffer of a tile, but not by the tile whose core "
                       "has the foot; there, the tree is missing or part of another: " +
                       list(items) + "; look at them");
  std::map<std::string, std::vector<std::string>> doubtful; // trees by reason
  for (std::size_t p = 0; p < plot.points.size(); ++p) {
    const std::string reason = warnings_of_tree(plot, p);
    if (!reason.empty())
      doubtful[reason].push_back(std::to_string(p));
  }
  for (const auto& [reason, trees] : doubtful)
    warnings.push_back(std::to_string(trees.size()) + " tree(s) " + reason + ": number " +
                       list(trees));
  if (!plot.trees_without_crown.empty())
    warnings.push_back(
        std::to_string(plot.trees_without_crown.size()) + " tree(s) have points more than " +
        number(Plot_crowns::most_layers * Plot_crowns::layer_height(plot.breast_height)) +
        " above the foot, so their crowns are not measured: " + list(plot.trees_without_crown) +
        "; remove these points from the scans");
  items.clear();
  for (const auto& [a, b] : plot.trees->twins())
    items.push_back(std::to_string(a) + " and " + std::to_string(b));
  if (!items.empty())
    warnings.push_back(std::to_string(items.size()) +
                       " pair(s) of trees of different tiles have feet within " + tolerance +
                       ", but do not share their points: " + list(items) +
                       "; look at them, perhaps they are one tree at a border");
  items.clear();
  for (std::size_t p = 0; p < plot.trees->trees().size(); ++p)
    if (plot.trees->trees()[p].is_at_rim)
      items.push_back(std::to_string(p));
  if (!items.empty())
    warnings.push_back(
        std::to_string(items.size()) +
        " tree(s) touch the outer rim of the buffer of their tile, and may be cut: " + list(items) +
        "; segment these tiles again with a larger --buffer of tile_points");
  warn_of_files(options, plot, warnings);
  return warnings;
}

std::string table_of(const Tile_manifest& manifest, const Options& options, const Merged_plot& plot)
{
  std::string text = "tree,x,y,z,radius,diameter_at_breast_height,height,points,tile,parts,"
                     "is_at_rim,cut_parts,file,crown_area,crown_volume,warnings\n";
  for (std::size_t p = 0; p < plot.points.size(); ++p) {
    const Plot_tree& tree = plot.trees->trees()[p];
    text += std::to_string(p);
    for (const double x : tree.foot)
      text += "," + number(x);
    text += "," + number(tree.radius) + "," + number(tree.diameter_at_breast_height) + "," +
            number(plot.heights[p]) + "," + std::to_string(plot.points[p]) + "," +
            manifest.tiles()[tree.tile].file + "," + std::to_string(tree.number_of_parts) + "," +
            (tree.is_at_rim ? "1" : "0") + "," + std::to_string(tree.number_of_cut_parts) + "," +
            (has_file(options, plot.points[p]) ? Tree_files::name_of(p) : "") + "," +
            number(plot.crowns[p].area) + "," + number(plot.crowns[p].volume) + "," +
            quoted(warnings_of_tree(plot, p)) + "\n";
  }
  return text;
}

Ordered_json to_json(const Tile_manifest& manifest, const Options& options, const Merged_plot& plot)
{
  Ordered_json failures = Ordered_json::array(), unmatched = Ordered_json::array();
  for (const Failure& failure : plot.failures)
    failures.push_back({{"tile", failure.tile}, {"reason", failure.reason}});
  for (const auto& [t, k] : plot.trees->unmatched())
    unmatched.push_back({{"tile", manifest.tiles()[t].file},
                         {"tree", k},
                         {"foot", plot.tiles.results()[t]->trees[k].foot},
                         {"points", plot.tiles.parts(t)[k].number_of_points}});
  Ordered_json missed = Ordered_json::array();
  for (const auto& [t, k] : plot.trees->missed())
    missed.push_back({{"tile", manifest.tiles()[t].file},
                      {"tree", k},
                      {"foot", plot.tiles.results()[t]->trees[k].foot}});
  Ordered_json joined = Ordered_json::array();
  for (const Plot_trees::Joined_tree& tree : plot.trees->joined())
    joined.push_back({{"tree", tree.tree},
                      {"tile", manifest.tiles()[tree.tile].file},
                      {"tree_of_tile", tree.tree_of_tile}});
  return {{"tiles", manifest.tiles().size()},
          {"skipped_scans", manifest.skipped()},
          {"failed_tiles", failures},
          {"points", plot.number_of_points},
          {"missing_points", manifest.number_of_points() - plot.number_of_points},
          {"unassigned_points", plot.unassigned_points},
          {"trees", plot.points.size()},
          {"tolerance", plot.tolerance},
          {"unmatched_points", plot.unmatched_points},
          {"unmatched_trees", unmatched},
          {"missed_trees", missed},
          {"joined_trees", joined},
          {"close_feet", plot.trees->twins()},
          {"warnings", all_warnings(manifest, options, plot)}};
}

/// Returns the outlines of the crowns, with the warnings of the trees.
Ordered_json outlines_of(const Merged_plot& plot)
{
  Ordered_json json = to_json(plot.crowns);
  for (std::size_t p = 0; p < plot.crowns.size(); ++p)
    json["features"][p]["properties"]["warnings"] = warnings_of_tree(plot, p);
  return json;
}

/// Writes all points in the order of their indices.
void write_points(const Tile_manifest& manifest, const Options& options, const Merged_plot& plot)
{
  const auto open_files = static_cast<std::size_t>(options.open_files);
  if (plot.blocks) {
    if (plot.blocks->sources().empty())
      throw pcs::IO_error(options.tiles, "no block can be read; " + plot.failed_blocks[0].reason);
    check_output(options.points, plot.blocks->schema());
    Ordered_points::write(plot.blocks->sources(),
                          plot.blocks->schema(),
                          open_files,
                          options.points);
    return;
  }
  check_output(options.points, plot.tiles.schema());
  std::vector<Ordered_points::Source> sources;
  for (std::size_t t = 0; t < manifest.tiles().size(); ++t) {
    if (plot.tiles.source(t) == Labelled_tiles::Source::none)
      continue;
    sources.push_back({plot.tiles.path_of(t), [&plot, t](pcs::IO::Point_table& chunk) {
                         plot.tiles.make_core(t, chunk);
                         for (std::int32_t& tree : chunk.property<std::int32_t>("tree"))
                           if (tree >= 0)
                             tree = plot.trees->trees_of_tile(t)[static_cast<std::size_t>(tree)];
                       }});
  }
  Ordered_points::write(std::move(sources), plot.tiles.schema(), open_files, options.points);
}

void write_trees(const Options& options, const Merged_plot& plot)
{
  std::vector<std::size_t> wanted;
  for (std::size_t p = 0; p < plot.points.size(); ++p)
    if (has_file(options, plot.points[p]))
      wanted.push_back(p);
  Tree_files(plot.tiles, *plot.trees, options.folder)
      .write(wanted, static_cast<std::size_t>(options.open_files));
}

/// Returns whether all tiles have results.
bool run(const Options& options)
{
  check(options);
  pcs::internal::Stopwatch watch;
  const Tile_manifest manifest(options.tiles);
  check_files(options, manifest);
  if (!options.points.empty())
    check_points(options.points);
  std::unique_ptr<Report_file> table, crowns, report;
  if (!options.table.empty())
    table = std::make_unique<Report_file>(options.table);
  if (!options.crowns.empty())
    crowns = std::make_unique<Report_file>(options.crowns);
  if (!options.report.empty())
    report = std::make_unique<Report_file>(options.report);
  if (!options.folder.empty())
    make_folder(options.folder);

  const Merged_plot plot(manifest, options);
  if (!options.points.empty())
    write_points(manifest, options, plot);
  if (!options.folder.empty())
    write_trees(options, plot);
  Ordered_json json = to_json(manifest, options, plot);
  if (plot.blocks) {
    json["all_points"] = plot.blocks->number_of_points();
    json["all_unassigned_points"] = plot.blocks->number_of_unassigned_points();
  }
  if (table)
    table->commit(table_of(manifest, options, plot));
  if (crowns)
    crowns->commit(outlines_of(plot));
  json["seconds"] = watch.lap();
  if (report)
    report->commit(json);
  const std::size_t important = // the first ones
      manifest.skipped().size() + plot.failures.size() + plot.failed_blocks.size();
  for (std::size_t w = 0; w < json["warnings"].size(); ++w)
    if (!options.is_quiet || w < important)
      std::cerr << "merge_tiles: warning: " << json["warnings"][w].get<std::string>() << '\n';
  if (!options.is_quiet)
    std::cout << "trees " << plot.points.size() << ", unassigned points " << plot.unassigned_points
              << " of " << plot.number_of_points << ", tiles " << plot.number_of_results << " of "
              << manifest.tiles().size() << ", seconds " << json["seconds"] << '\n';
  return plot.number_of_results == manifest.tiles().size() && plot.failed_blocks.empty();
}

} // namespace program

int main(int argc, char** argv)
{
  program::Options options;
  CLI::App app("Merges the segmented tiles of a plot.", "merge_tiles");
  program::declare(app, options);
  return program::run_program(app,
                              argc,
                              argv,
                              "--tiles tiles/tiles.json --results results --table trees.csv",
                              [&] { return program::run(options); });
}

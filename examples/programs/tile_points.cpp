// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: cuts the scan of a plot with any number of points into overlapping tiles.

#include "common/Distinct_files.h"
#include "common/Report_file.h"
#include "common/run_program.h"
#include "common/up_direction.h"
#include "tiling/Count_grid.h"
#include "tiling/Point_files.h"
#include "tiling/Tile_files.h"
#include "tiling/Tile_tree.h"
#include "tiling/Voxel_thinning.h"
#include "tiling/horizontal.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>
#include <pcs/internal/Stopwatch.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace program {

using Ordered_json = nlohmann::ordered_json;

/// The smallest buffer that is derived from the heights [L].
constexpr double least_buffer = 5;

/// The derived buffer as a fraction of the height within cells: the crown radius of broad trees.
constexpr double buffer_per_height = 1.0 / 3;

/// Cells in memory. With their copies during splitting, they need some 150 MB.
constexpr std::size_t max_cells = std::size_t(1) << 20;

constexpr std::size_t max_tiles = 10000;

/// The exit code if inputs were left out.
constexpr int incomplete_plot = 3;

struct Options
{
  std::vector<std::string> inputs;
  std::string folder, report, up = "z";
  std::int64_t tile_points = 5000000, open_files = 100;
  std::optional<double> buffer, voxel;
  double cell = 1;
  bool do_skip_damaged = false, is_quiet = false;
};

const char* help()
{
  return R"(Scans: PLY, LAS (LAZ if built with LASzip), PCD, PTX, OFF, OBJ, or text (xyz, txt, csv,
asc, pts, pwn), also compressed by gzip (.gz) if built with zlib. Several files are one plot.
Tiles: DIR/tile_0001.ply, ..., with the properties that all files have in common. A tile has the
points of its core and those up to the buffer around it. `is_core` is 1 in the core, else 0. Every
point is in the core of exactly one tile. `index` is its number in all files, from 0.
Manifest: DIR/tiles.json has the boxes and counts of the tiles. It is written last: without it, the
tiles are incomplete. A folder that has tiles already is refused.
Buffer: by default a third of the height of the trees, but at least 5. The height is the difference
of the highest and lowest points of a cell; 99 % of the points are in cells with at most this one.
Thinning: with --voxel, a tile has one point per voxel: the one nearest to its center, on a grid
that is aligned with the origin. DIR/block_0001.ply, ... have all points, and `kept_index`, the
`index` of the point that is kept in their voxel. merge_tiles gives all points the tree of their
kept point.
--tile-points counts kept points. --cell is enlarged to a multiple of the voxel size.
Memory: at most 1,048,576 cells (150 MB), a chunk of 262,144 points, and 0.5 MB per open file. If
more cells have points, the cell size is doubled until they are fewer. With --voxel, 120 bytes per
kept point of a block, which has at most --tile-points points before thinning.
Files are read twice, and once more for every further --open-files tiles.
Damaged scans: by default they end the run, and no tile remains. With --skip-damaged, a scan that
cannot be read to its end is named on stderr and in tiles.json, all its points are left out, and
the exit code is 3.

For example:
  tile_points --input plot_a.laz plot_b.laz --folder tiles
  segment_trees --input tiles/tile_0001.ply --tile-results segmented
  (the same for all other tiles)
  merge_tiles --tiles tiles/tiles.json --results segmented --table trees.csv

Exit codes: 0 success, 1 bad input or usage, 2 internal error, 3 tiles without damaged scans.)";
}

void declare(CLI::App& app, Options& options)
{
  app.footer(help());
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--input", options.inputs, "one or more scans of one plot")->required();
  app.add_option("--folder", options.folder, "folder for the tiles and tiles.json")->required();
  app.add_option("--report",
                 options.report,
                 "the manifest with seconds of each stage (JSON); -: standard output");
  app.add_option("--tile-points", options.tile_points, "most points in the core of a tile")
      ->check(CLI::Range(std::int64_t(1), std::int64_t(1) << 40))
      ->capture_default_str();
  app.add_option("--buffer", options.buffer, "width around the core; default: by the heights");
  app.add_option("--cell", options.cell, "smallest side of a tile: tiles consist of such cells")
      ->capture_default_str();
  app.add_option("--voxel", options.voxel, "voxel size for thinning; default: all points are kept");
  add_up(app, options.up, "up direction")->capture_default_str();
  app.add_option("--open-files", options.open_files, "tiles that are written in one pass")
      ->check(CLI::Range(std::int64_t(1), std::int64_t(max_tiles)))
      ->capture_default_str();
  app.add_flag("--skip-damaged", options.do_skip_damaged, "leave out scans that cannot be read");
  app.add_flag("--quiet", options.is_quiet, "print errors only");
}

/// Checks the numbers further than CLI11 can, which accepts NaN. Throws `pcs::Invalid_input`.
void check(const Options& options)
{
  constexpr double largest = 1e9;
  if (options.buffer && !(*options.buffer >= 0 && *options.buffer <= largest))
    throw pcs::Invalid_input("--buffer is " + std::to_string(*options.buffer) +
                             ", expected a length between 0 and 1e9");
  if (!(options.cell >= 1 / largest && options.cell <= largest))
    throw pcs::Invalid_input("--cell is " + std::to_string(options.cell) +
                             ", expected a length between 1e-9 and 1e9");
  if (options.voxel && !(*options.voxel >= options.cell / 1e6 && *options.voxel <= largest))
    throw pcs::Invalid_input("--voxel is " + std::to_string(*options.voxel) +
                             ", expected a length between a millionth of --cell and 1e9");
  std::set<std::string> paths;
  for (const std::string& input : options.inputs) {
    std::error_code error;
    const std::string path = std::filesystem::weakly_canonical(input, error).string();
    if (!paths.insert(error ? input : path).second)
      throw pcs::Invalid_input(input +
                               " is an input twice; its points would be in the tiles twice");
  }
}

/// Makes the folder. Throws if it cannot be made, or has the tiles of another run, which would be
/// mixed with the new ones.
void make_folder(const std::string& folder)
{
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder))
    throw pcs::IO_error(folder, "is not a directory and cannot be made one");
  fs::directory_iterator entries(folder, error);
  if (error)
    throw pcs::IO_error(folder, "cannot be listed: " + error.message());
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    const bool is_tile = (name.rfind("tile_", 0) == 0 || name.rfind("block_", 0) == 0) &&
                         entry.path().extension() == ".ply";
    if (is_tile || name == "tiles.json")
      throw pcs::IO_error(folder,
                          "has a file of another run, " + name +
                              "; remove tiles.json, tile_*.ply and block_*.ply, or use another "
                              "folder");
  }
}

/// What the first pass finds.
struct Survey
{
  Count_grid grid;
  std::vector<Grid_cell> cells;
  double lowest = 0, highest = 0; ///< heights [L]
  double height = 0;              ///< within cells [L]
};

/// Returns the grid of cells. With voxels, a cell consists of whole voxels.
Count_grid make_grid(const Options& options)
{
  if (!options.voxel)
    return Count_grid(options.cell, max_cells);
  const double multiple = std::ceil(options.cell / *options.voxel * (1 - 1e-12)); // 1 / 0.1 is 10
  return Count_grid(*options.voxel, max_cells, static_cast<std::int64_t>(std::max(1.0, multiple)));
}

/// Counts the points of all files. Returns whether none was left out.
bool count(Point_files& files, const Options& options, std::size_t axis_up, Survey& result)
{
  bool is_first = true;
  return files.count([&](const pcs::IO::Point_table& chunk, std::uint64_t first, const auto& file) {
    for (std::size_t i = 0; i < chunk.number_of_points(); ++i) {
      const auto& p = chunk.points()[i];
      for (int axis = 0; axis < 3; ++axis)
        if (std::abs(p[axis]) > result.grid.largest_coordinate())
          throw pcs::IO_error(file.path,
                              "point " + std::to_string(first + i) +
                                  " of all inputs: " + char('x' + axis) +
                                  " exceeds 1e15 cells; remove the point, or raise " +
                                  (options.voxel ? "--voxel" : "--cell"));
      const double height = p[static_cast<int>(axis_up)];
      result.lowest = is_first ? height : std::min(result.lowest, height);
      result.highest = is_first ? height : std::max(result.highest, height);
      is_first = false;
      result.grid.add(horizontal(p, axis_up), height);
    }
  });
}

Survey survey(Point_files& files, const Options& options, std::size_t axis_up)
{
  Survey result{make_grid(options), {}};
  while (!count(files, options, axis_up, result))
    result = {make_grid(options), {}};
  if (files.number_of_points() == 0)
    throw pcs::Invalid_input("the inputs have no points");
  result.cells = result.grid.take();
  result.height = height_within_cells(result.cells);
  return result;
}

/// Returns a warning about tiles with too many points; empty if there are none.
std::string warning_of_large_tiles(const Tile_tree& tree, const Options& options, double cell)
{
  std::size_t count = 0;
  std::uint64_t most = 0;
  for (const Tile& tile : tree.tiles())
    if (tile.number_of_core_points > static_cast<std::uint64_t>(options.tile_points)) {
      ++count;
      most = std::max(most, tile.number_of_core_points);
    }
  if (count == 0)
    return {};
  Ordered_json size = cell;
  return std::to_string(count) + " tiles of a single cell of " + size.dump() +
         " have more points than --tile-points, up to " + std::to_string(most) +
         (cell > make_grid(options).cell_size()
              ? "; the cell was enlarged because the plot is large"
              : "; reduce --cell, or thin the scan by --voxel");
}

Ordered_json to_json(const Point_files& files)
{
  Ordered_json inputs = Ordered_json::array();
  for (const Point_files::File& file : files.files())
    inputs.push_back({{"file", file.path}, {"points", file.number_of_points}});
  Ordered_json skipped = Ordered_json::array();
  for (const Point_files::Skipped& file : files.skipped())
    skipped.push_back({{"file", file.path}, {"reason", file.reason}});
  return {{"inputs", inputs}, {"skipped", skipped}, {"points", files.number_of_points()}};
}

/// `counts`: the number of points of each tile.
Ordered_json to_json(const Tile_tree& tree, const std::vector<std::uint64_t>& counts)
{
  Ordered_json tiles = Ordered_json::array();
  for (std::size_t t = 0; t < counts.size(); ++t) {
    const Tile& tile = tree.tiles()[t];
    tiles.push_back({{"file", Tile_files::name_of_file(t)},
                     {"core", to_json(tile.core)},
                     {"buffered", to_json(tile.buffered)},
                     {"points", counts[t]},
                     {"core_points", tile.number_of_core_points}});
  }
  return tiles;
}

/// Returns all warnings of a run.
std::vector<std::string>
all_warnings(const Point_files& files, const Tile_tree& tree, const Options& options, double cell)
{
  std::vector<std::string> warnings;
  for (const Point_files::Skipped& file : files.skipped())
    warnings.push_back("a damaged scan is left out: " + file.reason);
  warnings.insert(warnings.end(), files.warnings().begin(), files.warnings().end());
  for (const char* name : {"index", "is_core", "kept_index"})
    if (files.shared().has(name) && (options.voxel || name != std::string("kept_index")))
      warnings.push_back("the property '" + std::string(name) + "' of the input is replaced");
  const std::string large = warning_of_large_tiles(tree, options, cell);
  if (!large.empty())
    warnings.push_back(large);
  return warnings;
}

/// Returns the blocks with all points.
Ordered_json to_json(const Tile_tree& blocks)
{
  Ordered_json result = Ordered_json::array();
  for (std::size_t b = 0; b < blocks.tiles().size(); ++b)
    result.push_back({{"file", Voxel_thinning::name_of_file(b)},
                      {"core", to_json(blocks.tiles()[b].core)},
                      {"points", blocks.tiles()[b].number_of_core_points}});
  return result;
}

/// Returns the manifest without the tiles.
Ordered_json make_manifest(const Point_files& files,
                           const Survey& found,
                           const Options& options,
                           std::size_t axis_up,
                           double buffer)
{
  std::vector<std::string> axes = {"x", "y", "z"};
  axes.erase(axes.begin() + static_cast<std::ptrdiff_t>(axis_up));
  Ordered_json manifest = to_json(files);
  manifest["up"] = options.up;
  manifest["axes"] = axes;
  manifest["heights"] = {found.lowest, found.highest};
  manifest["height_within_cells"] = found.height;
  manifest["buffer"] = buffer;
  manifest["cell"] = found.grid.cell_size();
  manifest["tile_points"] = options.tile_points;
  return manifest;
}

/// Splits the plot. Throws `pcs::Invalid_input` if there are too many tiles.
Tile_tree make_tiles(Survey& found, const Options& options, double buffer)
{
  Tile_tree tree(std::move(found.cells),
                 found.grid,
                 static_cast<std::uint64_t>(options.tile_points),
                 buffer);
  if (tree.tiles().size() > max_tiles)
    throw pcs::Invalid_input(std::to_string(tree.tiles().size()) + " tiles are needed, at most " +
                             std::to_string(max_tiles) + " are written; raise --tile-points");
  return tree;
}

/// The plot that is cut into tiles: all points of the inputs, or the kept points.
struct Plot
{
  const Point_files* files = nullptr;
  Survey found;
  std::unique_ptr<Voxel_thinning> thinning = nullptr; ///< removes its files after `kept` is closed
  std::unique_ptr<Point_files> kept = nullptr;
  std::unique_ptr<Tile_tree> blocks = nullptr;
};

/// Counts the points, and thins them if this is wanted.
Plot prepare(Point_files& files, const Options& options, std::size_t axis_up)
{
  Plot plot{&files, survey(files, options, axis_up)};
  if (!options.voxel)
    return plot;
  plot.thinning = std::make_unique<Voxel_thinning>(options.folder,
                                                   *options.voxel,
                                                   files.shared(),
                                                   files.number_of_points());
  plot.blocks = std::make_unique<Tile_tree>(make_tiles(plot.found, options, 0));
  const std::string kept = plot.thinning->thin(files,
                                               *plot.blocks,
                                               axis_up,
                                               static_cast<std::size_t>(options.open_files));
  plot.kept = std::make_unique<Point_files>(std::vector<std::string>{kept}, options.is_quiet);
  plot.files = plot.kept.get();
  plot.found = survey(*plot.kept, options, axis_up);
  return plot;
}

/// Adds what belongs to thinning to the manifest.
void add_thinning(const Plot& plot,
                  const Point_files& files,
                  const Options& options,
                  Ordered_json& manifest)
{
  if (!plot.thinning)
    return;
  manifest["points"] = plot.files->number_of_points();
  manifest["voxel"] = *options.voxel;
  manifest["all_points"] = files.number_of_points();
  manifest["blocks"] = to_json(*plot.blocks);
}

/// Returns the exit code.
int run(const Options& options)
{
  check(options);
  pcs::internal::Stopwatch all, stage;
  const auto axis_up = static_cast<std::size_t>(options.up.back() - 'x');
  const std::string manifest_path = (std::filesystem::path(options.folder) / "tiles.json").string();
  Distinct_files distinct;
  for (const std::string& input : options.inputs)
    distinct.add_input(input);
  distinct.add_output(options.report);
  distinct.add_output(manifest_path);

  Point_files files(options.inputs, options.is_quiet, options.do_skip_damaged);
  make_folder(options.folder);
  Tile_files(options.folder, files.shared(), 0).check_writable();
  Report_file manifest_file(manifest_path);
  std::unique_ptr<Report_file> report_file;
  if (!options.report.empty())
    report_file = std::make_unique<Report_file>(options.report);

  Plot plot = prepare(files, options, axis_up);
  Survey& found = plot.found;
  const double buffer =
      options.buffer.value_or(std::max(least_buffer, buffer_per_height * found.height));
  const Tile_tree tree = make_tiles(found, options, buffer);
  Tile_files tiles(options.folder,
                   plot.files->shared(),
                   files.number_of_points(),
                   plot.thinning != nullptr);
  for (std::size_t t = 0; t < tree.tiles().size(); ++t)
    distinct.add_output(tiles.path_of(t));
  if (plot.thinning)
    for (std::size_t b = 0; b < plot.blocks->tiles().size(); ++b)
      distinct.add_output(
          (std::filesystem::path(options.folder) / Voxel_thinning::name_of_file(b)).string());
  tiles.check_space(tree.estimated_points());
  const double seconds_count = stage.lap();

  const std::vector<std::uint64_t> counts =
      tiles.write(*plot.files, tree, axis_up, static_cast<std::size_t>(options.open_files));
  const std::vector<std::string> warnings =
      all_warnings(files, tree, options, found.grid.cell_size());
  Ordered_json manifest = make_manifest(files, found, options, axis_up, buffer);
  add_thinning(plot, files, options, manifest);
  manifest["warnings"] = warnings;
  manifest["seconds"] = all.lap();
  manifest["tiles"] = to_json(tree, counts);
  if (report_file) {
    Ordered_json report = manifest;
    report["seconds_count"] = seconds_count;
    report["seconds_write"] = stage.lap();
    report_file->commit(report);
  }
  manifest_file.commit(manifest);
  tiles.keep();
  if (plot.thinning)
    plot.thinning->keep();

  const std::size_t number_of_skipped = files.skipped().size(); // the first warnings
  for (std::size_t w = 0; w < warnings.size(); ++w)
    if (!options.is_quiet || w < number_of_skipped)
      std::cerr << "tile_points: warning: " << warnings[w] << '\n';
  if (!options.is_quiet)
    std::cout << "tiles " << tree.tiles().size() << ", points " << manifest["points"] << ", buffer "
              << buffer << ", seconds " << manifest["seconds"] << '\n';
  return number_of_skipped > 0 ? incomplete_plot : 0;
}

} // namespace program

int main(int argc, char** argv)
{
  program::Options options;
  CLI::App app("Cuts the scan of a plot of any size into tiles with buffers.", "tile_points");
  program::declare(app, options);
  return program::run_program(app, argc, argv, "--input plot.laz --folder tiles", [&] {
    return program::run(options);
  });
}

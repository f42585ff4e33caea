// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program merge_tiles: trees of the plot, order of the points, independence of the order
// of trees and files, and missing or damaged tiles.

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/crowns/measure_crown.h>

#include <boost/test/unit_test.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <examples/Program_run.h>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <scan/tree_foot.h>
#include <sstream>
#include <string>
#include <tiling/Index_sample.h>
#include <tiling/Tile_manifest.h>
#include <tiling/Tile_result.h>
#include <vector>

namespace test_merge_tiles {

namespace {

constexpr std::size_t number_of_points = 6000, number_of_trees = 12;
constexpr double x0 = 500000, y0 = 5400000;

/// A plot of 40 m x 30 m in UTM coordinates. A point belongs to the tree with the nearest foot if
/// this is within 5 m. The radius of the trees decreases with their number.
struct Merge_run : Program_run
{
  Merge_run() : Program_run("tile_points")
  {
    for (std::size_t t = 0; t < number_of_trees; ++t)
      feet.push_back({x0 + 5 + 10 * double(t % 4) + random(2),
                      y0 + 5 + 10 * double(t / 4) + random(2),
                      300 + random(3)});
    std::vector<Table::Point_3> points;
    std::vector<float> intensity;
    for (std::size_t i = 0; i < number_of_points; ++i) {
      points.emplace_back(x0 + random(40), y0 + random(30), 300 + random(15));
      intensity.push_back(float(random(1)));
      trees.push_back(tree_of(points.back()));
    }
    plot = Table(points);
    plot.add_property("intensity", intensity);
    pcs::IO::write_points(path("plot.ply"), plot);
    BOOST_TEST_REQUIRE(run("--input plot.ply --folder tiles --tile-points 500 --buffer 8") == 0,
                       err);
    manifest = Json::parse(content("tiles/tiles.json"));
    program = PCS_TEST_PROGRAMS "/merge_tiles";
  }

  double random(double size) { return size * (double(engine()) / 4294967296.0); }

  std::int32_t tree_of(const Table::Point_3& p) const
  {
    std::int32_t best = -1;
    double least = 5;
    for (std::size_t t = 0; t < feet.size(); ++t) {
      const double d = std::hypot(p.x() - feet[t][0], p.y() - feet[t][1]);
      if (d < least) {
        least = d;
        best = std::int32_t(t);
      }
    }
    return best;
  }

  std::string name_of(std::size_t tile) const { return manifest["tiles"][tile]["file"]; }

  bool has_core_foot(std::size_t tile, std::size_t tree) const
  {
    const Json& core = manifest["tiles"][tile]["core"];
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (core["low"][axis] > feet[tree][axis] || feet[tree][axis] >= core["high"][axis])
        return false;
    return true;
  }

  std::size_t owner_of(std::size_t tree) const
  {
    std::size_t tile = 0;
    while (!has_core_foot(tile, tree))
      ++tile;
    return tile;
  }

  /// Writes the results of all tiles. Trees have an order of their own in each tile, and feet that
  /// differ by at most `shift` from those of the owner.
  void write_results(const std::string& where, unsigned seed, double shift = 0.1)
  {
    engine.seed(seed);
    std::filesystem::create_directories(path(where));
    for (std::size_t tile = 0; tile < manifest["tiles"].size(); ++tile)
      write_result(where, tile, shift);
  }

  void write_result(const std::string& where, std::size_t tile, double shift)
  {
    const Json& row = manifest["tiles"][tile];
    std::vector<std::size_t> order(number_of_trees);
    std::iota(order.begin(), order.end(), 0);
    if (hidden && has_core_foot(tile, *hidden))
      order.erase(order.begin() + std::ptrdiff_t(*hidden));
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[engine() % i]);
    const Table all = pcs::IO::read_points(path(tile_folder + "/" + name_of(tile)));
    const auto& index = all.property<std::uint32_t>("index");
    const auto& is_core = all.property<std::uint8_t>("is_core");
    std::vector<std::size_t> rows;
    std::vector<std::int32_t> tree;
    program::Tile_result result;
    for (std::size_t k = 0; k < order.size(); ++k) {
      program::Tree_of_tile found;
      found.foot = feet[order[k]];
      if (!has_core_foot(tile, order[k]))
        found.foot[0] += shift * (engine() % 2 == 0 ? 1 : -1);
      found.is_foot_in_core = has_core_foot(tile, order[k]);
      if (order[k] == 0 && first_foot_in.count(tile) > 0) {
        found.foot = first_foot_in.at(tile);
        found.is_foot_in_core = true;
      }
      found.radius = 1 - 0.05 * double(order[k]);
      found.diameter_at_breast_height = found.radius / 3;
      found.is_at_rim = order[k] == 7;
      if (order[k] == doubtful)
        found.warnings = {"too thick, or \"two\" stems", "lower than others"};
      result.trees.push_back(found);
    }
    if (has_samples)
      for (std::size_t k = 0; k < order.size(); ++k) {
        program::Index_sample sample;
        for (const std::uint32_t i : index)
          if (trees[i] == std::int32_t(order[k]))
            sample.add(i);
        result.trees[k].sample = sample.indices();
      }
    for (std::size_t i = 0; i < index.size(); ++i) {
      if (is_core[i] == 0)
        continue;
      rows.push_back(i);
      const std::int32_t t = trees[index[i]];
      tree.push_back(t < 0 || std::count(order.begin(), order.end(), std::size_t(t)) == 0
                         ? -1
                         : std::int32_t(std::find(order.begin(), order.end(), std::size_t(t)) -
                                        order.begin()));
      if (tree.back() >= 0)
        ++result.trees[std::size_t(tree.back())].number_of_core_points;
    }
    for (const char* corner : {"low", "high"})
      for (std::size_t axis = 0; axis < 2; ++axis) {
        (corner[0] == 'l' ? result.core.low : result.core.high)[axis] = row["core"][corner][axis];
        (corner[0] == 'l' ? result.buffered.low : result.buffered.high)[axis] =
            row["buffered"][corner][axis];
      }
    result.number_of_core_points = rows.size();
    result.breast_height = breast_height;
    Table core = all.select(rows);
    core.remove_property("is_core");
    core.add_property("tree", tree);
    pcs::IO::write_points(program::points_of_result(path(where), name_of(tile)), core);
    write(program::trees_of_result(where, name_of(tile)), program::to_json(result).dump());
  }

  std::vector<std::vector<std::string>> table(const std::string& name) const
  {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(content(name));
    for (std::string line; std::getline(lines, line);) {
      rows.emplace_back();
      std::istringstream cells(line + ",");
      for (std::string cell; std::getline(cells, cell, ',');)
        rows.back().push_back(cell);
    }
    return rows;
  }

  std::mt19937 engine{7};
  std::vector<std::array<double, 3>> feet;
  std::map<std::size_t, std::array<double, 3>> first_foot_in; ///< foot of tree 0, by tile
  bool has_samples = false;
  double breast_height = 1.3;          ///< of the results
  std::optional<std::size_t> hidden;   ///< a tree that its owner does not find
  std::optional<std::size_t> doubtful; ///< a tree with warnings
  std::string tile_folder = "tiles";
  std::vector<std::int32_t> trees; ///< of the points of the plot
  Table plot;
  Json manifest;
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(merge_tiles_program, Merge_run)

BOOST_AUTO_TEST_CASE(points_table_and_files_have_the_trees_of_the_plot)
{
  write_results("results", 1);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --table trees.csv "
                         "--points out.ply --folder trees --min-points 300 --report r.json "
                         "--crowns crowns.json") == 0,
                     err);
  const Json crowns = Json::parse(content("crowns.json"));
  BOOST_TEST_REQUIRE(crowns["features"].size() == number_of_trees);
  const Table points = pcs::IO::read_points(path("out.ply"));
  BOOST_TEST((points.points() == plot.points()));
  BOOST_TEST((points.property_values("intensity") == plot.property_values("intensity")));
  BOOST_TEST((points.property<std::int32_t>("tree") == trees));
  const auto& index = points.property<std::uint32_t>("index");
  for (std::size_t i = 0; i < index.size(); ++i)
    BOOST_REQUIRE(index[i] == i);

  const auto rows = table("trees.csv");
  BOOST_TEST_REQUIRE(rows.size() == number_of_trees + 1);
  for (std::size_t t = 0; t < number_of_trees; ++t) {
    const std::vector<std::string>& row = rows[t + 1];
    BOOST_TEST_REQUIRE(row.size() == rows[0].size());
    BOOST_TEST(row[0] == std::to_string(t));
    for (std::size_t axis = 0; axis < 3; ++axis)
      BOOST_TEST(std::stod(row[1 + axis]) == feet[t][axis]);
    double height = 0;
    std::vector<std::size_t> own;
    std::vector<bool> has_part(manifest["tiles"].size(), false);
    for (std::size_t i = 0; i < trees.size(); ++i)
      if (trees[i] == std::int32_t(t)) {
        own.push_back(i);
        height = std::max(height, plot.points()[i].z() - feet[t][2]);
        for (std::size_t k = 0; k < has_part.size(); ++k) {
          const Json& core = manifest["tiles"][k]["core"];
          const auto& p = plot.points()[i];
          has_part[k] = has_part[k] || (core["low"][0] <= p.x() && p.x() < core["high"][0] &&
                                        core["low"][1] <= p.y() && p.y() < core["high"][1]);
        }
      }
    const auto parts = std::count(has_part.begin(), has_part.end(), true);
    BOOST_TEST(std::stod(row[6]) == height);
    BOOST_TEST(row[7] == std::to_string(own.size()));
    BOOST_TEST(row[8] == name_of(owner_of(t)));
    BOOST_TEST(row[9] == std::to_string(parts));
    BOOST_TEST(row[10] == (t == 7 ? "1" : "0"));
    BOOST_TEST(row[11] == std::to_string(t == 7 ? parts - has_part[owner_of(t)] : 0));
    const std::string name =
        "tree_0000" + std::string(t < 10 ? "0" : "") + std::to_string(t) + ".ply";
    std::vector<Table::Point_3> of_tree;
    for (const std::size_t i : own)
      of_tree.push_back(plot.points()[i]);
    const auto crown = pcs::crowns::measure_crown(of_tree, feet[t][2] + 1.3); // breast height
    BOOST_TEST(crown.area > 0);
    BOOST_TEST(std::stod(row[13]) == crown.area);
    BOOST_TEST(std::stod(row[14]) == crown.volume);
    const Json& outline = crowns["features"][t]["geometry"]["coordinates"][0];
    BOOST_TEST_REQUIRE(outline.size() == crown.outline.size() + 1);
    for (std::size_t i = 0; i < outline.size(); ++i)
      BOOST_TEST((outline[i] == Json(crown.outline[i % crown.outline.size()])));
    BOOST_TEST(exists("trees/" + name) == (own.size() >= 300));
    BOOST_TEST(row[12] == (own.size() >= 300 ? name : ""));
    if (own.size() < 300)
      continue;
    const Table tree = pcs::IO::read_points(path("trees/" + name));
    BOOST_TEST((*program::read_foot(tree) == feet[t]));
    std::vector<std::size_t> found;
    for (const std::uint32_t i : tree.property<std::uint32_t>("index"))
      found.push_back(i);
    BOOST_TEST((tree.points() == plot.select(found).points()));
    std::sort(found.begin(), found.end());
    BOOST_TEST((found == own));
    BOOST_TEST(!tree.has_property("tree"));
  }
  report = Json::parse(content("r.json"));
  BOOST_TEST(report["points"] == number_of_points);
  BOOST_TEST(report["unassigned_points"] == std::count(trees.begin(), trees.end(), -1));
  BOOST_TEST(report["unmatched_trees"].empty());
  BOOST_TEST(report["close_feet"].empty());
  BOOST_TEST(err.find("1 tree(s) touch the outer rim") != std::string::npos, err);
}

BOOST_AUTO_TEST_CASE(warnings_about_a_tree_reach_table_outlines_and_report)
{
  doubtful = 4;
  write_results("results", 1);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --table trees.csv "
                         "--report r.json --crowns crowns.json") == 0,
                     err);
  const std::string expected = "too thick, or \"two\" stems; lower than others";
  const Json crowns = Json::parse(content("crowns.json"));
  std::istringstream lines(content("trees.csv"));
  std::string line;
  std::getline(lines, line);
  BOOST_TEST(line.find(",warnings") == line.size() - 9);
  for (std::size_t t = 0; t < number_of_trees; ++t) {
    std::getline(lines, line);
    const std::string field =
        t == 4 ? ",\"too thick, or \"\"two\"\" stems; lower than others\"" : ",";
    BOOST_TEST(line.substr(line.size() - field.size()) == field);
    BOOST_TEST(crowns["features"][t]["properties"]["warnings"] == (t == 4 ? expected : ""));
  }
  const std::string warning = "1 tree(s) " + expected + ": number 4";
  BOOST_TEST(err.find(warning) != std::string::npos, err);
  report = Json::parse(content("r.json"));
  BOOST_TEST(std::count(report["warnings"].begin(), report["warnings"].end(), Json(warning)) == 1);
}

BOOST_AUTO_TEST_CASE(bytes_do_not_depend_on_the_order_of_trees_and_the_number_of_open_files)
{
  write_results("a", 1);
  write_results("b", 2);
  const std::string tiles = "--tiles tiles/tiles.json --min-points 1 --quiet ";
  BOOST_TEST_REQUIRE(run(tiles + "--results a --table a.csv --points a.ply --folder trees_a") == 0,
                     err);
  BOOST_TEST(out.empty());
  BOOST_TEST_REQUIRE(run(tiles + "--results b --table b.csv --points b.ply --folder trees_b "
                                 "--open-files 2") == 0,
                     err);
  BOOST_TEST((content("a.csv") == content("b.csv")));
  BOOST_TEST((content("a.ply") == content("b.ply")));
  for (std::size_t t = 0; t < number_of_trees; ++t) {
    const std::string name =
        "/tree_0000" + std::string(t < 10 ? "0" : "") + std::to_string(t) + ".ply";
    BOOST_TEST((content("trees_a" + name) == content("trees_b" + name)));
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    BOOST_TEST(entry.path().filename().string().find("unfinished") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(missing_and_damaged_tiles_do_not_end_the_run)
{
  write_results("results", 1);
  BOOST_TEST_REQUIRE(manifest["tiles"].size() >= 9u);
  const auto result = [&](std::size_t tile, const std::string& extension) {
    return "results/" + std::filesystem::path(name_of(tile)).stem().string() + extension;
  };
  const std::string whole = content(result(1, ".ply"));
  std::filesystem::remove(path(result(0, ".json")));
  write(result(1, ".ply"), whole.substr(0, whole.size() - 3));
  write(result(2, ".json"), "{");
  std::filesystem::copy_file(path(result(4, ".ply")),
                             path(result(3, ".ply")),
                             std::filesystem::copy_options::overwrite_existing);
  Table wrong = pcs::IO::read_points(path(result(5, ".ply")));
  wrong.property<std::int32_t>("tree")[4] = 99;
  pcs::IO::write_points(path(result(5, ".ply")), wrong);
  wrong = pcs::IO::read_points(path(result(6, ".ply")));
  std::swap(wrong.property<std::uint32_t>("index")[3], wrong.property<std::uint32_t>("index")[4]);
  pcs::IO::write_points(path(result(6, ".ply")), wrong);
  std::filesystem::remove(path(result(7, ".ply")));
  std::filesystem::remove(path("tiles/" + name_of(7)));
  BOOST_TEST(run("--tiles tiles/tiles.json --results results --table trees.csv --points out.ply "
                 "--report r.json --folder trees --min-points 1") == 1);
  for (std::size_t tile = 0; tile < manifest["tiles"].size(); ++tile)
    BOOST_TEST((err.find(name_of(tile) + " has no result") != std::string::npos) ==
                   (tile < 8 && tile != 4),
               name_of(tile) << " in " << err);
  report = Json::parse(content("r.json"));
  BOOST_TEST(report["failed_tiles"].size() == 8u); // the last one twice: result and tile
  BOOST_TEST(report["missed_trees"].empty());
  BOOST_TEST(report["missing_points"] == manifest["tiles"][7]["core_points"]);
  const Table points = pcs::IO::read_points(path("out.ply"));
  BOOST_TEST(points.number_of_points() ==
             number_of_points - manifest["tiles"][7]["core_points"].get<std::size_t>());
  const auto& index = points.property<std::uint32_t>("index");
  const auto& tree = points.property<std::int32_t>("tree");
  const auto rows = table("trees.csv");
  std::vector<std::array<double, 3>> found;
  for (std::size_t r = 1; r < rows.size(); ++r)
    found.push_back({std::stod(rows[r][1]), std::stod(rows[r][2]), std::stod(rows[r][3])});
  std::vector<std::array<double, 3>> expected;
  for (std::size_t t = 0; t < number_of_trees; ++t)
    if (owner_of(t) >= 8 || owner_of(t) == 4)
      expected.push_back(feet[t]);
  BOOST_TEST((found == expected));
  std::size_t number_of_labels = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    BOOST_REQUIRE(points.points()[i] == plot.points()[index[i]]);
    BOOST_REQUIRE((i == 0 || index[i] > index[i - 1]));
    if (tree[i] >= 0)
      BOOST_REQUIRE(found[std::size_t(tree[i])] == feet[std::size_t(trees[index[i]])]);
    number_of_labels += tree[i] >= 0;
  }
  BOOST_TEST(number_of_labels > 1000u);
}

BOOST_AUTO_TEST_CASE(feet_beyond_the_tolerance_are_counted)
{
  write_results("results", 1, 0.3);
  const std::string tiles = "--tiles tiles/tiles.json --results results --report r.json ";
  BOOST_TEST_REQUIRE(run(tiles) == 0, err);
  BOOST_TEST(Json::parse(content("r.json"))["unmatched_trees"].empty());
  BOOST_TEST_REQUIRE(run(tiles + "--points out.ply --tolerance 0.29") == 0, err);
  report = Json::parse(content("r.json"));
  std::size_t unmatched = 0;
  for (const Json& tree : report["unmatched_trees"])
    unmatched += tree["points"].get<std::size_t>();
  BOOST_TEST(unmatched > 0u);
  BOOST_TEST(report["unmatched_points"] == unmatched);
  BOOST_TEST(err.find("match no foot within 0.29") != std::string::npos, err);
  const auto tree = pcs::IO::read_points(path("out.ply")).property<std::int32_t>("tree");
  BOOST_TEST(std::size_t(std::count(tree.begin(), tree.end(), -1)) ==
             unmatched + std::size_t(std::count(trees.begin(), trees.end(), -1)));
}

BOOST_AUTO_TEST_CASE(feet_of_different_tiles_that_are_near_are_listed)
{
  // tree 1 stands beside tree 0, across the border of their tiles
  const Json& core = manifest["tiles"][owner_of(0)]["core"];
  feet[0][0] = core["high"][0].get<double>() - 0.1;
  feet[1] = feet[0];
  feet[1][0] += 0.2;
  BOOST_TEST_REQUIRE(owner_of(0) != owner_of(1));
  has_samples = true;
  write_results("results", 1, 0);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --report r.json") == 0, err);
  BOOST_TEST(Json::parse(content("r.json"))["close_feet"] == Json::parse("[[0, 1]]"));
  BOOST_TEST(err.find("do not share their points: 0 and 1") != std::string::npos, err);
}

BOOST_AUTO_TEST_CASE(a_tree_that_only_other_tiles_find_is_named)
{
  hidden = 5;
  write_results("results", 1, 0);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --report r.json") == 0, err);
  report = Json::parse(content("r.json"));
  BOOST_TEST(report["trees"] == number_of_trees - 1);
  BOOST_TEST_REQUIRE(report["missed_trees"].size() == 1u); // several tiles see it, at one place
  BOOST_TEST((report["missed_trees"][0]["foot"] == Json(feet[5])));
  BOOST_TEST(err.find("not by the tile whose core has the foot") != std::string::npos, err);
  hidden.reset();
  write_results("results", 1, 0);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --report r.json") == 0, err);
  BOOST_TEST(Json::parse(content("r.json"))["missed_trees"].empty());
}

BOOST_AUTO_TEST_CASE(a_tree_that_a_third_tile_sees_beyond_a_border_is_not_missing)
{
  const std::size_t one = owner_of(0);
  const double border = manifest["tiles"][one]["core"]["high"][0];
  feet[0][0] = border + 0.05;
  const std::size_t other = owner_of(0);
  std::size_t third = 0;
  while (third == one || third == other)
    ++third;
  first_foot_in[third] = feet[0];
  feet[0][0] = border - 0.05; // in all other tiles
  BOOST_TEST_REQUIRE(owner_of(0) == one);
  write_results("results", 1, 0);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --report r.json") == 0, err);
  report = Json::parse(content("r.json"));
  BOOST_TEST(report["trees"] == number_of_trees);
  BOOST_TEST(report["missed_trees"].empty());
  BOOST_TEST(report["unmatched_trees"].empty());
}

BOOST_AUTO_TEST_CASE(a_tree_that_is_found_on_both_sides_of_a_border_is_one_tree)
{
  // each of two tiles finds tree 0 in its own core
  const std::size_t one = owner_of(0);
  const double border = manifest["tiles"][one]["core"]["high"][0];
  feet[0][0] = border + 0.1;
  const std::size_t other = owner_of(0);
  BOOST_TEST_REQUIRE(one < other);
  first_foot_in[other] = feet[0];
  feet[0][0] = border - 0.1;
  first_foot_in[one] = feet[0];
  const std::string tiles = "--tiles tiles/tiles.json --report r.json --points out.ply ";
  const auto labels = [this] {
    return pcs::IO::read_points(path("out.ply")).property<std::int32_t>("tree");
  };
  write_results("without", 1);
  BOOST_TEST_REQUIRE(run(tiles + "--results without --table without.csv") == 0, err);
  BOOST_TEST(table("without.csv").size() == number_of_trees + 2); // nothing is known about points
  BOOST_TEST(Json::parse(content("r.json"))["close_feet"].size() == 1u);
  BOOST_TEST((labels() != trees));

  has_samples = true;
  for (unsigned seed = 1; seed < 3; ++seed) {
    const std::string where = "with_" + std::to_string(seed);
    write_results(where, seed);
    BOOST_TEST_REQUIRE(run(tiles + "--results " + where + " --table " + where + ".csv") == 0, err);
    report = Json::parse(content("r.json"));
    BOOST_TEST(report["close_feet"].empty());
    BOOST_TEST_REQUIRE(report["joined_trees"].size() == 1u);
    BOOST_TEST(report["joined_trees"][0]["tree"] == 0);
    BOOST_TEST(report["joined_trees"][0]["tile"] == name_of(other));
    BOOST_TEST((labels() == trees));
  }
  const auto rows = table("with_1.csv");
  BOOST_TEST_REQUIRE(rows.size() == number_of_trees + 1);
  BOOST_TEST(std::stod(rows[1][1]) == feet[0][0]);
  BOOST_TEST(rows[1][8] == name_of(one));
  BOOST_TEST((content("with_1.csv") == content("with_2.csv")));
}

BOOST_AUTO_TEST_CASE(overlaps_are_estimated_from_samples)
{
  // [0, b) and [a, a + size): the overlap relative to the smaller set is known
  const auto sample = [](std::uint64_t first, std::uint64_t end) {
    program::Index_sample result;
    for (std::uint64_t i = end; i > first; --i)
      result.add(i - 1);
    return result.indices();
  };
  const auto overlap = [](const auto& a, const auto& b) {
    return program::Index_sample::overlap(a, b);
  };
  const auto all = sample(0, 100000);
  BOOST_TEST(all.size() == program::Index_sample::size);
  BOOST_TEST(overlap(all, all) == 1);
  BOOST_TEST(overlap(all, sample(100000, 200000)) == 0);
  BOOST_TEST(std::abs(overlap(all, sample(20000, 120000)) - 0.8) < 0.2);
  BOOST_TEST(std::abs(overlap(all, sample(80000, 180000)) - 0.2) < 0.2);
  BOOST_TEST(overlap(sample(0, 10), sample(5, 15)) == 0.5);
  BOOST_TEST(overlap(all, sample(0, 0)) == 0);
}

BOOST_AUTO_TEST_CASE(all_points_have_the_tree_of_their_voxel)
{
  const auto cut = [this](const std::string& where, const std::string& options) {
    program = PCS_TEST_PROGRAMS "/tile_points";
    BOOST_TEST_REQUIRE(run("--input plot.ply --buffer 8 --voxel 2 --folder " + where + options) ==
                           0,
                       err);
    program = PCS_TEST_PROGRAMS "/merge_tiles";
    tile_folder = where;
    manifest = Json::parse(content(where + "/tiles.json"));
  };
  cut("thin", " --tile-points 200");
  BOOST_TEST_REQUIRE(manifest["points"].get<std::size_t>() < number_of_points / 2);
  std::vector<std::int32_t> expected(number_of_points, -2);
  std::vector<std::size_t> kept(number_of_trees, 0);
  for (const Json& row : manifest["blocks"]) {
    const Table block = pcs::IO::read_points(path("thin/" + row["file"].get<std::string>()));
    const auto& index = block.property<std::uint32_t>("index");
    for (std::size_t i = 0; i < index.size(); ++i) {
      const std::uint32_t k = block.property<std::uint32_t>("kept_index")[i];
      expected[index[i]] = trees[k];
      if (k == index[i] && trees[k] >= 0)
        ++kept[std::size_t(trees[k])];
    }
  }
  write_results("results", 1);
  const std::string options = "--results results --points out.ply --table t.csv --report r.json ";
  BOOST_TEST_REQUIRE(run("--tiles thin/tiles.json " + options) == 0, err);
  const Table points = pcs::IO::read_points(path("out.ply"));
  BOOST_TEST((points.points() == plot.points()));
  BOOST_TEST((points.property_values("intensity") == plot.property_values("intensity")));
  BOOST_TEST((points.property<std::int32_t>("tree") == expected));
  BOOST_TEST(!points.has_property("kept_index"));
  report = Json::parse(content("r.json"));
  BOOST_TEST(report["points"] == manifest["points"]);
  BOOST_TEST(report["all_points"] == number_of_points);
  BOOST_TEST(report["all_unassigned_points"] == std::count(expected.begin(), expected.end(), -1));
  const auto rows = table("t.csv");
  for (std::size_t t = 0; t < number_of_trees; ++t)
    BOOST_TEST(rows[t + 1][7] == std::to_string(kept[t]));

  // other tiles, and few open files: the same bytes
  const std::string bytes = content("out.ply");
  cut("other", " --tile-points 500");
  write_results("others", 2);
  BOOST_TEST_REQUIRE(run("--tiles other/tiles.json --results others --points out.ply "
                         "--open-files 2") == 0,
                     err);
  BOOST_TEST((content("out.ply") == bytes));

  // a damaged block is named, and the others remain
  const std::string name = manifest["blocks"][1]["file"];
  const std::string block = content("other/" + name);
  write("other/" + name, block.substr(0, block.size() - 5));
  BOOST_TEST(run("--tiles other/tiles.json --results others --points out.ply") == 1);
  BOOST_TEST(err.find(name) != std::string::npos, err);
  BOOST_TEST(pcs::IO::read_points(path("out.ply")).number_of_points() ==
             number_of_points - manifest["blocks"][1]["points"].get<std::size_t>());
  // blocks of another run
  std::filesystem::copy_file(path("thin/" + name),
                             path("other/" + name),
                             std::filesystem::copy_options::overwrite_existing);
  BOOST_TEST(run("--tiles other/tiles.json --results others --points out.ply") == 1);
  BOOST_TEST(err.find(name) != std::string::npos, err);
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    BOOST_TEST(entry.path().filename().string().find("unfinished") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(crowns_begin_at_the_given_height)
{
  write_results("results", 1);
  BOOST_TEST_REQUIRE(
      run("--tiles tiles/tiles.json --results results --table t.csv --crown-base 6") == 0,
      err);
  const auto rows = table("t.csv");
  std::vector<Table::Point_3> of_tree;
  for (std::size_t i = 0; i < trees.size(); ++i)
    if (trees[i] == 3)
      of_tree.push_back(plot.points()[i]);
  BOOST_TEST(std::stod(rows[4][14]) == pcs::crowns::measure_crown(of_tree, feet[3][2] + 6).volume);
}

BOOST_AUTO_TEST_CASE(layers_of_crowns_have_the_unit_of_the_breast_height)
{
  breast_height = 2.6;
  write_results("results", 1);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --table t.csv") == 0, err);
  const auto rows = table("t.csv");
  std::vector<Table::Point_3> of_tree;
  for (std::size_t i = 0; i < trees.size(); ++i)
    if (trees[i] == 3)
      of_tree.push_back(plot.points()[i]);
  const auto crown = pcs::crowns::measure_crown(of_tree, feet[3][2] + 2.6, 1.0);
  BOOST_TEST(std::stod(rows[4][14]) == crown.volume);
}

BOOST_AUTO_TEST_CASE(tiles_with_different_breast_heights_are_refused)
{
  write_results("results", 1);
  breast_height = 0.4;
  write_result("results", 1, 0.1);
  BOOST_TEST(run("--tiles tiles/tiles.json --results results --table t.csv") == 1);
  BOOST_TEST(err.find(name_of(0) + " was segmented with --breast-height 1.3, but " + name_of(1) +
                      " with 0.4") != std::string::npos,
             err);
  BOOST_TEST(!exists("t.csv"));
}

BOOST_AUTO_TEST_CASE(trees_without_a_file_are_counted)
{
  write_results("results", 1);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --folder trees "
                         "--min-points 100000") == 0,
                     err);
  BOOST_TEST(err.find("12 of 12 trees have fewer than --min-points 100000 points") !=
                 std::string::npos,
             err);
}

BOOST_AUTO_TEST_CASE(a_point_far_above_a_tree_leaves_only_this_crown_out)
{
  write_results("results", 1);
  const std::string file = path("results/" + name_of(0));
  Table result = pcs::IO::read_points(file);
  const auto& tree = result.property<std::int32_t>("tree");
  const auto i = static_cast<std::size_t>(
      std::find_if(tree.begin(), tree.end(), [](std::int32_t t) { return t >= 0; }) - tree.begin());
  BOOST_TEST_REQUIRE(i < tree.size());
  const Table::Point_3 p = result.points()[i];
  result.points()[i] = Table::Point_3(p.x(), p.y(), 1e10);
  pcs::IO::write_points(file, result);
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --table t.csv") == 0, err);
  BOOST_TEST(err.find("crowns are not measured: ") != std::string::npos, err);
  std::size_t empty = 0;
  for (const auto& row : table("t.csv"))
    empty += row[13] == "0.0" || row[13] == "0";
  BOOST_TEST(empty == 1u);
}

BOOST_AUTO_TEST_CASE(damaged_scans_that_were_left_out_are_named)
{
  write_results("results", 1);
  Json incomplete = manifest;
  incomplete["skipped"] = {{{"file", "station_3.laz"}, {"reason", "is cut"}}};
  write("tiles/tiles.json", incomplete.dump());
  BOOST_TEST_REQUIRE(run("--tiles tiles/tiles.json --results results --report r.json --quiet") == 0,
                     err);
  BOOST_TEST(err.find("incomplete") != std::string::npos, err);
  BOOST_TEST(err.find("station_3.laz") != std::string::npos, err);
  report = Json::parse(content("r.json"));
  BOOST_TEST(report["skipped_scans"] == Json::parse("[\"station_3.laz\"]"));
}

BOOST_AUTO_TEST_CASE(a_foot_outside_the_plot_belongs_to_the_nearest_core)
{
  const program::Tile_manifest plot_of_tiles(path("tiles/tiles.json"));
  for (std::size_t t = 0; t < plot_of_tiles.tiles().size(); ++t) {
    const program::Box_2& core = plot_of_tiles.tiles()[t].core;
    BOOST_TEST(plot_of_tiles.owner_of(core.low) == t);
    if (core.low[0] == x0)
      BOOST_TEST(plot_of_tiles.owner_of({x0 - 1, core.low[1]}) == t);
    if (core.high[0] == x0 + 40)
      BOOST_TEST(plot_of_tiles.owner_of({x0 + 41, core.low[1]}) == t);
  }
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused)
{
  write_results("results", 1);
  std::filesystem::create_directories(path("empty"));
  write("file", "a file");
  const std::string before = content("tiles/tiles.json");
  const std::string tile = content("tiles/" + name_of(0));
  const auto refuses = [&](const std::string& arguments, const std::string& word) {
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    BOOST_TEST(!exists("t.csv"), arguments);
  };
  const std::string inputs = "--tiles tiles/tiles.json --results results ";
  refuses(inputs, "--table");
  refuses("--results results --table t.csv", "--tiles");
  refuses("--tiles missing.json --results results --table t.csv", "missing.json");
  refuses("--tiles plot.ply --results results --table t.csv", "not valid JSON");
  refuses("--tiles tiles/tiles.json --results missing --table t.csv", "missing");
  refuses("--tiles tiles/tiles.json --results empty --table t.csv", "no result");
  refuses(inputs + "--table t.csv --tolerance nan", "--tolerance");
  refuses(inputs + "--table t.csv --tolerance -1", "--tolerance");
  refuses(inputs + "--table t.csv --crown-base -1", "--crown-base");
  refuses(inputs + "--table t.csv --crown-base nan", "--crown-base");
  refuses(inputs + "--points p.ply --crown-base 2", "--crown-base has no effect");
  refuses(inputs + "--table t.csv --crowns t.csv", "same file");
  refuses(inputs + "--table t.csv --open-files 1", "--open-files");
  refuses(inputs + "--table t.csv --folder file", "directory");
  refuses(inputs + "--table tiles/tiles.json", "same file");
  refuses(inputs + "--table t.csv --points tiles/" + name_of(0), "same file");
  refuses(inputs + "--table t.csv --points results/" + name_of(0), "same file");
  refuses(inputs + "--table t.csv --report t.csv", "same file");
  refuses(inputs + "--table t.csv --report ./t.csv", "same file");
  refuses(inputs + "--table t.csv --folder trees --points trees/tree_000000.ply", "--folder");
  refuses(inputs + "--folder trees --min-points -1", "--min-points");
  refuses(inputs + "--points p.las", "LAS");
  refuses(inputs + "--points missing/p.ply", "missing/p.ply");
  Json damaged = manifest;
  damaged["tiles"][0].erase("core");
  write("tiles/damaged.json", damaged.dump());
  refuses("--tiles tiles/damaged.json --results results --table t.csv", "/tiles/0");
  damaged = manifest;
  damaged["tiles"][0]["file"] = "../tile_0001.ply";
  write("tiles/damaged.json", damaged.dump());
  refuses("--tiles tiles/damaged.json --results results --table t.csv", "/tiles/0/file");
  damaged = manifest;
  damaged["points"] = 3;
  write("tiles/damaged.json", damaged.dump());
  refuses("--tiles tiles/damaged.json --results results --table t.csv", "6000");
  BOOST_TEST(content("tiles/tiles.json") == before);
  BOOST_TEST((content("tiles/" + name_of(0)) == tile));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_merge_tiles

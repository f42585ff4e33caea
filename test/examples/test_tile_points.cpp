// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program tile_points: cores, buffers and properties of tiles, equal results, and
// rejection of invalid input.

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>

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
#include <random>
#include <set>
#include <string>
#include <tiling/Count_grid.h>
#include <tiling/Tile_tree.h>
#include <tuple>
#include <utility>
#include <vector>

namespace test_tile_points {

namespace {

/// A plot of 40 m x 25 m in UTM coordinates. Half of the points are in a dense corner, and some
/// lie on borders of cells.
Table make_plot(std::size_t n, unsigned seed)
{
  std::mt19937 engine(seed);
  const auto random = [&engine](double size) { return size * (double(engine()) / 4294967296.0); };
  std::vector<Table::Point_3> points;
  std::vector<std::uint16_t> intensity;
  std::vector<double> time;
  std::vector<std::int64_t> large;
  for (std::size_t i = 0; i < n; ++i) {
    const double part = i % 2 == 0 ? 1 : 0.2;
    double x = 500000 + random(40 * part), y = 5400000 + random(25 * part);
    if (i % 10 == 0) {
      x = std::floor(x);
      y = std::floor(y);
    }
    points.emplace_back(x, y, 300 + random(12));
    intensity.push_back(std::uint16_t(engine()));
    time.push_back(random(1e9));
    large.push_back(std::numeric_limits<std::int64_t>::max() - std::int64_t(i));
  }
  Table table(points);
  table.add_property("intensity", intensity);
  table.add_property("time", time);
  table.add_property("large", large);
  return table;
}

struct Tile_run : Program_run
{
  Tile_run() : Program_run("tile_points") {}

  Json manifest(const std::string& tiles) const
  {
    return Json::parse(content(tiles + "/tiles.json"));
  }

  static bool is_within(const Json& box, const Table::Point_3& p, int a, int b, bool is_closed)
  {
    const auto is_below = [is_closed](double v, double high) {
      return is_closed ? v <= high : v < high;
    };
    return box["low"][0].get<double>() <= p[a] && box["low"][1].get<double>() <= p[b] &&
           is_below(p[a], box["high"][0].get<double>()) &&
           is_below(p[b], box["high"][1].get<double>());
  }

  /// Compares the tiles with all points of the inputs. `a`, `b`: the horizontal axes. Returns the
  /// manifest.
  Json check_tiles(const std::string& tiles, const Table& all, int a = 0, int b = 1) const
  {
    const Json m = manifest(tiles);
    std::vector<int> cores(all.number_of_points(), 0);
    for (const Json& row : m["tiles"]) {
      const Table tile = pcs::IO::read_points(path(tiles + "/" + row["file"].get<std::string>()));
      const auto& index = tile.property<std::uint32_t>("index");
      const auto& is_core = tile.property<std::uint8_t>("is_core");
      std::vector<std::uint32_t> expected;
      for (std::size_t i = 0; i < all.number_of_points(); ++i)
        if (is_within(row["buffered"], all.points()[i], a, b, true))
          expected.push_back(std::uint32_t(i));
      BOOST_TEST((index == expected), row["file"] << " has other points than its box");
      std::size_t number_of_core_points = 0;
      for (std::size_t k = 0; k < index.size(); ++k) {
        BOOST_REQUIRE(tile.points()[k] == all.points()[index[k]]);
        BOOST_REQUIRE(bool(is_core[k]) == is_within(row["core"], tile.points()[k], a, b, false));
        number_of_core_points += is_core[k];
        cores[index[k]] += is_core[k];
      }
      BOOST_TEST(row["points"] == index.size());
      BOOST_TEST(row["core_points"] == number_of_core_points);
      check_properties(tile, all, index);
    }
    BOOST_TEST(std::count(cores.begin(), cores.end(), 1) == std::ptrdiff_t(cores.size()));
    BOOST_TEST(m["points"] == all.number_of_points());
    return m;
  }

  static void
  check_properties(const Table& tile, const Table& all, const std::vector<std::uint32_t>& index)
  {
    const std::vector<std::size_t> rows(index.begin(), index.end());
    const Table expected = all.select(rows);
    std::vector<std::string> names = all.property_names();
    for (const std::string& name : names)
      BOOST_TEST((tile.property_values(name) == expected.property_values(name)), name);
    names.push_back("index");
    names.push_back("is_core");
    BOOST_TEST(tile.property_names() == names);
  }

  /// Returns the contents of all tiles by name.
  std::map<std::string, std::string> bytes_of_tiles(const std::string& tiles) const
  {
    std::map<std::string, std::string> result;
    const Json m = manifest(tiles);
    for (const Json& row : m["tiles"]) {
      const std::string name = row["file"];
      result[name] = content(tiles + "/" + name);
    }
    return result;
  }

  bool has_tiles(const std::string& tiles) const
  {
    return exists(tiles) && !std::filesystem::is_empty(folder / tiles);
  }
};

/// A plot in two files in which points lie on borders of voxels, have the same distance from the
/// center of their voxel, or are the same.
struct Voxel_run : Tile_run
{
  Voxel_run()
  {
    plot = make_plot(4000, 8);
    std::vector<Table::Point_3>& points = plot.points();
    for (std::size_t i = 0; i < 900; ++i) {
      const Table::Point_3& p = points[i];
      const double x = std::floor(p.x()), y = std::floor(p.y()), z = std::floor(p.z());
      points[i + 1000] = {x + 0.125, y + 0.25, z + 0.25};
      points[i + 2000] = {x + 0.375, y + 0.25, z + 0.25}; // as near
      if (i % 2 == 0)
        points[i + 3000] = points[i + 1000];
    }
    // equal points have equal properties, so the file does not matter
    auto& intensity = plot.property<std::uint16_t>("intensity");
    for (std::size_t i = 0; i < points.size(); ++i)
      intensity[i] = std::uint16_t(std::int64_t(points[i].x() * 16) + int(points[i].z() * 256));
    std::vector<std::size_t> first, last;
    for (std::size_t i = 0; i < plot.number_of_points(); ++i)
      (i < 1700 ? first : last).push_back(i);
    pcs::IO::write_points(path("a.ply"), plot.select(first));
    pcs::IO::write_points(path("b.ply"), plot.select(last));
  }

  /// Returns the kept point of each point. \pre `size` is a power of 2
  static std::vector<std::size_t> kept_points(const Table& table, double size)
  {
    using Order = std::tuple<double, double, double, double, std::size_t>;
    std::map<std::array<double, 3>, Order> best;
    const auto voxel_of = [size](const Table::Point_3& p) {
      return std::array<double, 3>{std::floor(p.x() / size),
                                   std::floor(p.y() / size),
                                   std::floor(p.z() / size)};
    };
    for (std::size_t i = 0; i < table.number_of_points(); ++i) {
      const Table::Point_3& p = table.points()[i];
      const auto v = voxel_of(p);
      const Table::Point_3 center((v[0] + 0.5) * size, (v[1] + 0.5) * size, (v[2] + 0.5) * size);
      const Order order(CGAL::squared_distance(p, center), p.x(), p.y(), p.z(), i);
      const auto [at, is_new] = best.emplace(v, order);
      if (!is_new)
        at->second = std::min(at->second, order);
    }
    std::vector<std::size_t> kept;
    for (const Table::Point_3& p : table.points())
      kept.push_back(std::get<4>(best.at(voxel_of(p))));
    return kept;
  }

  static constexpr double voxel = 0.5;
  Table plot;
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(tile_points_program, Tile_run)

BOOST_AUTO_TEST_CASE(tiles_have_all_points_of_their_boxes)
{
  Table all = make_plot(3000, 1);
  const Table more = make_plot(2000, 2);
  pcs::IO::write_points(path("a.ply"), all);
  pcs::IO::write_points(path("b.ply"), more);
  all.append(more);
  BOOST_TEST_REQUIRE(run("--input a.ply b.ply --folder tiles --tile-points 300 --buffer 2.5 "
                         "--report report.json") == 0,
                     err);
  BOOST_TEST(err.empty(), err);
  const Json m = check_tiles("tiles", all);
  BOOST_TEST(m["tiles"].size() >= 17u);
  BOOST_TEST(m["tiles"].size() <= 34u);
  double area = 0;
  for (const Json& row : m["tiles"]) {
    BOOST_TEST(row["core_points"] <= 300);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double low = row["core"]["low"][axis], high = row["core"]["high"][axis];
      BOOST_TEST(row["buffered"]["low"][axis] == low - 2.5);
      BOOST_TEST(row["buffered"]["high"][axis] == high + 2.5);
    }
    area += (row["core"]["high"][0].get<double>() - row["core"]["low"][0].get<double>()) *
            (row["core"]["high"][1].get<double>() - row["core"]["low"][1].get<double>());
  }
  BOOST_TEST(area == 40 * 25); // no gaps between the cores
  BOOST_TEST(m["inputs"][0]["points"] == 3000);
  BOOST_TEST(m["inputs"][1]["file"] == "b.ply");
  BOOST_TEST(m["buffer"] == 2.5);
  BOOST_TEST(m["axes"] == Json({"x", "y"}));
  report = Json::parse(content("report.json"));
  BOOST_TEST(report["tiles"] == m["tiles"]);
  BOOST_TEST(report["seconds_write"].get<double>() > 0);
}

BOOST_AUTO_TEST_CASE(results_do_not_depend_on_the_number_of_passes)
{
  pcs::IO::write_points(path("a.ply"), make_plot(3000, 3));
  const std::string arguments = "--input a.ply --tile-points 200 --buffer 3 --quiet ";
  BOOST_TEST_REQUIRE(run(arguments + "--folder one") == 0, err);
  BOOST_TEST(out.empty());
  BOOST_TEST_REQUIRE(run(arguments + "--folder again") == 0, err);
  BOOST_TEST_REQUIRE(run(arguments + "--folder many --open-files 4") == 0, err);
  BOOST_TEST(bytes_of_tiles("one").size() > 8u);
  BOOST_TEST((bytes_of_tiles("one") == bytes_of_tiles("again")));
  BOOST_TEST((bytes_of_tiles("one") == bytes_of_tiles("many")));
  Json one = manifest("one"), many = manifest("many");
  one.erase("seconds");
  many.erase("seconds");
  BOOST_TEST(one == many);
}

BOOST_AUTO_TEST_CASE(cores_do_not_depend_on_the_order_of_files)
{
  pcs::IO::write_points(path("a.ply"), make_plot(1000, 4));
  pcs::IO::write_points(path("b.ply"), make_plot(2000, 5));
  BOOST_TEST_REQUIRE(run("--input a.ply b.ply --folder ab --tile-points 150") == 0, err);
  BOOST_TEST_REQUIRE(run("--input b.ply a.ply --folder ba --tile-points 150") == 0, err);
  BOOST_TEST(manifest("ab")["tiles"] == manifest("ba")["tiles"]);
}

BOOST_AUTO_TEST_CASE(other_up_directions_and_formats)
{
  pcs::IO::write_points(path("plot.las"), make_plot(1000, 6));
  const Table plot = pcs::IO::read_points(path("plot.las"));
  BOOST_TEST_REQUIRE(run("--input plot.las --folder las --tile-points 100 --buffer 1") == 0, err);
  check_tiles("las", plot);
  BOOST_TEST_REQUIRE(
      run("--input in.ply --folder x --tile-points 300 --buffer 0.5 --cell 0.25 --up=-x") == 0,
      err);
  const Json m = check_tiles("x", pcs::IO::read_points(path("in.ply")), 1, 2);
  BOOST_TEST(m["tiles"].size() > 4u);
  BOOST_TEST(m["axes"] == Json({"y", "z"}));
}

BOOST_AUTO_TEST_CASE(one_point_and_one_place)
{
  write("one.xyz", "-7 4 2\n");
  BOOST_TEST_REQUIRE(run("--input one.xyz --folder one") == 0, err);
  BOOST_TEST(err.empty(), err);
  const Json one = check_tiles("one", pcs::IO::read_points(path("one.xyz")));
  BOOST_TEST(one["tiles"].size() == 1u);
  BOOST_TEST(one["tiles"][0]["core"] == Json({{"low", {-7, 4}}, {"high", {-6, 5}}}));

  std::string text;
  for (int i = 0; i < 50; ++i)
    text += "-7.5 4.25 2\n";
  write("place.xyz", text);
  BOOST_TEST_REQUIRE(run("--input place.xyz --folder place --tile-points 10") == 0, err);
  BOOST_TEST(err.find("up to 50") != std::string::npos, err);
  const Json place = check_tiles("place", pcs::IO::read_points(path("place.xyz")));
  BOOST_TEST(place["tiles"].size() == 1u);
}

BOOST_AUTO_TEST_CASE(the_buffer_follows_the_heights)
{
  std::vector<Table::Point_3> points;
  for (int i = 0; i < 2000; ++i) // trees of 30 m on a slope of 2000 m
    points.emplace_back(i / 10, 0.5, i / 10 * 10 + (i % 2) * 30);
  points.emplace_back(0.5, 0.5, 900); // a bird
  pcs::IO::write_points(path("high.ply"), Table(points));
  BOOST_TEST_REQUIRE(run("--input high.ply --folder high") == 0, err);
  const Json m = manifest("high");
  BOOST_TEST(m["height_within_cells"] == 30);
  BOOST_TEST(m["buffer"] == 10);
  BOOST_TEST(m["heights"] == Json({0, 2020}));
  pcs::IO::write_points(path("plot.ply"), make_plot(1000, 7));
  BOOST_TEST_REQUIRE(run("--input plot.ply --folder low") == 0, err);
  BOOST_TEST(manifest("low")["buffer"] == 5); // 12 m high
}

BOOST_AUTO_TEST_CASE(properties_that_a_file_lacks_are_left_out)
{
  Table a = make_plot(300, 8), b = make_plot(200, 9);
  a.remove_property("time");
  b.replace_property("intensity", std::vector<float>(200, 1));
  b.add_property("index", std::vector<double>(200, 1));
  a.add_property("index", std::vector<double>(300, 1));
  pcs::IO::write_points(path("a.ply"), a);
  pcs::IO::write_points(path("b.ply"), b);
  BOOST_TEST_REQUIRE(run("--input a.ply b.ply --folder tiles --tile-points 50 --buffer 1") == 0,
                     err);
  for (const char* words : {"'time' is left out, because it is float64 in b.ply and missing in a",
                            "'intensity' is left out, because it is uint16 in a.ply and float32",
                            "'index' of the input is replaced"})
    BOOST_TEST(err.find(words) != std::string::npos, words << " in " << err);
  for (Table* table : {&a, &b})
    for (const std::string& name : table->property_names())
      if (name != "large")
        table->remove_property(name);
  a.append(b);
  BOOST_TEST(check_tiles("tiles", a)["warnings"].size() == 3u);
}

BOOST_AUTO_TEST_CASE(cells_are_enlarged_if_there_are_too_many)
{
  std::mt19937 engine(10);
  std::vector<program::Position_2> points;
  for (int i = 0; i < 3000; ++i)
    points.push_back({double(engine() % 1000) - 300, (double(engine() % 1000) - 700) / 8});
  const auto cells_of = [](const std::vector<program::Position_2>& from, double& size) {
    program::Count_grid grid(0.5, 100);
    for (const program::Position_2& p : from)
      grid.add(p, p[0]);
    size = grid.cell_size();
    return grid.take();
  };
  double size = 0, reversed_size = 0;
  const auto cells = cells_of(points, size);
  const auto count = [&](double side) {
    std::map<std::pair<double, double>, std::uint64_t> counts;
    for (const program::Position_2& p : points)
      ++counts[{std::floor(p[0] / side), std::floor(p[1] / side)}];
    return counts;
  };
  BOOST_TEST(count(size).size() <= 100u);
  BOOST_TEST(count(size / 2).size() > 100u);
  BOOST_TEST_REQUIRE(cells.size() == count(size).size());
  for (const program::Grid_cell& cell : cells)
    BOOST_TEST(cell.points.number_of_points ==
               count(size)[std::make_pair(double(cell.index[0]), double(cell.index[1]))]);
  std::reverse(points.begin(), points.end());
  const auto reversed = cells_of(points, reversed_size);
  BOOST_TEST(size == reversed_size);
  BOOST_TEST_REQUIRE(cells.size() == reversed.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    BOOST_TEST((cells[c].index == reversed[c].index));
    BOOST_TEST(cells[c].points.number_of_points == reversed[c].points.number_of_points);
    BOOST_TEST(cells[c].points.lowest == reversed[c].points.lowest);
    BOOST_TEST(cells[c].points.highest == reversed[c].points.highest);
  }
}

BOOST_AUTO_TEST_CASE(borders_of_cells_are_exact)
{
  program::Count_grid grid(0.1, 1000000); // 0.3 / 0.1 is less than 3 in binary
  for (int i = -5000; i < 5000; ++i)
    grid.add({i * 0.1, 0}, 0);
  for (const program::Grid_cell& cell : grid.take())
    BOOST_TEST(cell.points.number_of_points == 1u);
}

BOOST_AUTO_TEST_CASE(points_of_tiles_are_estimated)
{
  const Table plot = make_plot(20000, 11);
  program::Count_grid grid(0.5, 1000000);
  for (const Table::Point_3& p : plot.points())
    grid.add({p.x(), p.y()}, p.z());
  const program::Tile_tree tree(grid.take(), grid, 2000, 3);
  std::size_t count = 0;
  for (const Table::Point_3& p : plot.points())
    tree.for_each_tile({p.x(), p.y()}, 0, tree.tiles().size(), [&](std::size_t) { ++count; });
  BOOST_TEST(count > 30000u);
  BOOST_TEST(std::abs(tree.estimated_points() / double(count) - 1) < 0.05);
}

BOOST_AUTO_TEST_CASE(no_tile_remains_if_one_cannot_be_written)
{
  std::string text = "0.5 0.5 0\n";
  for (int i = 0; i < 3000; ++i)
    text += "9.5 0.5 " + std::to_string(i) + "\n";
  write("plot.xyz", text);
  // the second tile has 87 kB, more than the limit of 80 blocks of 512 or 1024 bytes
  write("limited.sh", "#!/bin/sh\nulimit -f 80\nexec '" + program + "' \"$@\"\n");
  std::filesystem::permissions(folder / "limited.sh", std::filesystem::perms::owner_all);
  program = path("limited.sh");
  const int code =
      run("--input plot.xyz --folder tiles --tile-points 10 --buffer 0 --open-files 1");
  BOOST_TEST(code == 1);
  BOOST_TEST(err.find("tile_0002.ply") != std::string::npos, err);
  BOOST_TEST(exists("tiles"));
  BOOST_TEST(!has_tiles("tiles"));
}

BOOST_FIXTURE_TEST_CASE(one_point_per_voxel_is_kept, Voxel_run)
{
  const std::vector<std::size_t> expected = kept_points(plot, voxel);
  const std::size_t number_of_kept = std::set<std::size_t>(expected.begin(), expected.end()).size();
  BOOST_TEST_REQUIRE(number_of_kept < plot.number_of_points() * 3 / 4);
  BOOST_TEST_REQUIRE(
      run("--input a.ply b.ply --folder thin --tile-points 400 --buffer 2.3 --voxel 0.5") == 0,
      err);
  const Json m = manifest("thin");
  BOOST_TEST(m["voxel"] == 0.5);
  BOOST_TEST(m["points"] == number_of_kept);
  BOOST_TEST(m["all_points"] == plot.number_of_points());
  BOOST_TEST(m["tiles"].size() > 3u);
  BOOST_TEST(m["blocks"].size() > m["tiles"].size());

  std::vector<int> count(plot.number_of_points(), 0);
  for (const Json& row : m["blocks"]) {
    const Table block = pcs::IO::read_points(path("thin/" + row["file"].get<std::string>()));
    const auto& index = block.property<std::uint32_t>("index");
    const auto& kept = block.property<std::uint32_t>("kept_index");
    BOOST_TEST(row["points"] == index.size());
    BOOST_TEST(std::is_sorted(index.begin(), index.end()));
    for (std::size_t i = 0; i < index.size(); ++i) {
      ++count[index[i]];
      BOOST_REQUIRE(kept[i] == expected[index[i]]);
      BOOST_REQUIRE(block.points()[i] == plot.points()[index[i]]);
      BOOST_REQUIRE(is_within(row["core"], block.points()[i], 0, 1, false));
      BOOST_REQUIRE(block.property<double>("time")[i] == plot.property<double>("time")[index[i]]);
    }
  }
  BOOST_TEST(std::count(count.begin(), count.end(), 1) == std::ptrdiff_t(count.size()));

  for (const Json& row : m["tiles"]) { // each has all kept points of its box
    const Table tile = pcs::IO::read_points(path("thin/" + row["file"].get<std::string>()));
    BOOST_TEST(row["core_points"].get<std::size_t>() <= 400u);
    std::vector<std::uint32_t> inside;
    for (std::size_t i = 0; i < plot.number_of_points(); ++i)
      if (expected[i] == i && is_within(row["buffered"], plot.points()[i], 0, 1, true))
        inside.push_back(std::uint32_t(i));
    BOOST_TEST((tile.property<std::uint32_t>("index") == inside), row["file"]);
    check_properties(tile, plot, inside);
  }
  for (const auto& entry : std::filesystem::directory_iterator(path("thin")))
    BOOST_TEST(entry.path().filename().string().find("unfinished") == std::string::npos);
}

BOOST_FIXTURE_TEST_CASE(kept_points_depend_neither_on_tiles_nor_on_the_order_of_files, Voxel_run)
{
  const auto kept = [this](const std::string& tiles) {
    std::set<std::pair<std::array<double, 3>, std::uint16_t>> result;
    const Json m = manifest(tiles);
    for (const Json& row : m["tiles"]) {
      const Table tile = pcs::IO::read_points(path(tiles + "/" + row["file"].get<std::string>()));
      const auto& is_core = tile.property<std::uint8_t>("is_core");
      for (std::size_t i = 0; i < is_core.size(); ++i)
        if (is_core[i] == 1) {
          const auto& p = tile.points()[i];
          result.insert({{p.x(), p.y(), p.z()}, tile.property<std::uint16_t>("intensity")[i]});
        }
    }
    BOOST_TEST(result.size() == m["points"].get<std::size_t>());
    return result;
  };
  // 0.3 does not divide the cell, and is not a binary fraction; of 0.5, points are equally near
  for (const std::string size : {"0.3", "0.5"}) {
    const auto cut =
        [&](const std::string& files, const std::string& size_of_tiles, const std::string& to) {
          BOOST_TEST_REQUIRE(run("--input " + files + " --folder " + to + size + " --voxel " +
                                 size + " --buffer 1 --quiet --tile-points " + size_of_tiles) == 0,
                             err);
          return kept(to + size);
        };
    const auto first = cut("a.ply b.ply", "300", "one");
    BOOST_TEST(first.size() < plot.number_of_points());
    BOOST_TEST((first == cut("a.ply b.ply", "900 --open-files 1", "two")));
    BOOST_TEST((first == cut("a.ply b.ply", "300 --cell 3", "three")));
    BOOST_TEST((first == cut("b.ply a.ply", "300", "four")));
    BOOST_TEST(manifest("one" + size)["tiles"].size() > manifest("two" + size)["tiles"].size());
  }
  BOOST_TEST(std::abs(manifest("one0.3")["cell"].get<double>() - 1.2) < 1e-12);
}

BOOST_FIXTURE_TEST_CASE(nothing_remains_of_thinning_that_fails, Voxel_run)
{
  write("limited.sh", "#!/bin/sh\nulimit -f 40\nexec '" + program + "' \"$@\"\n");
  std::filesystem::permissions(folder / "limited.sh", std::filesystem::perms::owner_all);
  program = path("limited.sh");
  BOOST_TEST(run("--input a.ply b.ply --folder tiles --voxel 0.5 --tile-points 400") == 1);
  BOOST_TEST(exists("tiles"));
  BOOST_TEST(!has_tiles("tiles"));
  for (const char* size : {"0", "-1", "nan", "inf", "1e-9"}) {
    BOOST_TEST(run("--input a.ply --folder tiles --voxel " + std::string(size)) == 1);
    BOOST_TEST(err.find("--voxel") != std::string::npos, err);
  }
}

BOOST_AUTO_TEST_CASE(damaged_scans_are_left_out_if_wanted)
{
  const Table all = make_plot(3000, 5);
  std::vector<std::size_t> first, last;
  for (std::size_t i = 0; i < all.number_of_points(); ++i)
    (i < 1000 ? first : last).push_back(i);
  pcs::IO::write_points(path("a.ply"), all.select(first));
  pcs::IO::write_points(path("b.ply"), all.select(last));
  const std::string whole = content("b.ply");
  write("cut.ply", whole.substr(0, whole.size() - 5));
  write("far.xyz", "0 0 0\n1e300 0 0\n");
  write("no.ply", "ply\n");
  const std::string options = " --tile-points 400 --buffer 2 --quiet";
  BOOST_TEST_REQUIRE(run("--input a.ply b.ply --folder whole" + options) == 0, err);
  BOOST_TEST(manifest("whole")["skipped"].empty());
  BOOST_TEST_REQUIRE(
      run("--input a.ply cut.ply no.ply b.ply far.xyz missing.ply --folder part --skip-damaged" +
          options) == 3,
      err);
  const Json m = manifest("part");
  BOOST_TEST_REQUIRE(m["skipped"].size() == 4u);
  for (const char* name : {"cut.ply", "no.ply", "far.xyz", "missing.ply"}) {
    BOOST_TEST(err.find(name) != std::string::npos, name << " in " << err);
    BOOST_TEST(std::count_if(m["skipped"].begin(),
                             m["skipped"].end(),
                             [&](const Json& scan) {
                               return scan["file"] == name &&
                                      !scan["reason"].get<std::string>().empty();
                             }) == 1,
               name);
  }
  // the points that were read before the damage do not remain
  BOOST_TEST((bytes_of_tiles("part") == bytes_of_tiles("whole")));
  check_tiles("part", all);
  BOOST_TEST(run("--input cut.ply far.xyz --folder none --skip-damaged") == 1);
  BOOST_TEST(err.find("none of the 2 inputs") != std::string::npos, err);
  BOOST_TEST(!has_tiles("none"));
}

BOOST_AUTO_TEST_CASE(tiles_of_another_run_are_refused)
{
  BOOST_TEST_REQUIRE(run("--input in.ply --folder tiles") == 0, err);
  const auto before = bytes_of_tiles("tiles");
  const std::string manifest_before = content("tiles/tiles.json");
  BOOST_TEST(run("--input tiles/tile_0001.ply --folder tiles") == 1);
  BOOST_TEST(err.find("another run") != std::string::npos, err);
  BOOST_TEST((bytes_of_tiles("tiles") == before));
  BOOST_TEST(content("tiles/tiles.json") == manifest_before);
  std::filesystem::remove(path("tiles/tiles.json")); // as if the run had been killed
  BOOST_TEST(run("--input in.ply --folder tiles") == 1);
  BOOST_TEST(err.find("tile_0001.ply") != std::string::npos, err);
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused)
{
  write("file", "a file");
  write("empty.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n");
  write("far.xyz", "0 0 0\n1e300 0 0\n");
  write("damaged.xyz", "0 0 0\n1 1 1\n2 2 two\n");
  const std::string whole = content("in.ply");
  write("cut.ply", whole.substr(0, whole.size() - 5));
  const auto refuses = [&](const std::string& arguments, const std::string& word) {
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    BOOST_TEST(!has_tiles("tiles"), arguments);
  };
  refuses("--input in.ply", "--folder");
  refuses("--input missing.ply --folder tiles", "missing.ply");
  refuses("--input in.ply missing.ply --folder tiles", "missing.ply");
  refuses("--input empty.ply --folder tiles", "no points");
  refuses("--input far.xyz --folder tiles", "remove the point, or raise --cell");
  refuses("--input far.xyz --folder tiles --voxel 0.1", "point 1 of all inputs: x exceeds");
  refuses("--input far.xyz --folder tiles --voxel 0.1", "raise --voxel");
  refuses("--input in.ply damaged.xyz --folder tiles", "damaged.xyz");
  refuses("--input in.ply cut.ply --folder tiles", "cut.ply");
  refuses("--input in.ply --folder file", "directory");
  refuses("--input in.ply ./in.ply --folder tiles", "twice");
  refuses("--input in.ply --folder tiles --report in.ply", "in.ply");
  refuses("--input in.ply --folder tiles --report tiles/tile_0001.ply", "tile_0001.ply");
  refuses("--input in.ply --folder tiles --report tiles/tiles.json", "tiles.json");
  refuses("--input in.ply --folder tiles --buffer nan", "--buffer");
  refuses("--input in.ply --folder tiles --buffer -1", "--buffer");
  refuses("--input in.ply --folder tiles --cell 0", "--cell");
  refuses("--input in.ply --folder tiles --cell inf", "--cell");
  refuses("--input in.ply --folder tiles --tile-points 0", "--tile-points");
  refuses("--input in.ply --folder tiles --open-files 0", "--open-files");
  refuses("--input in.ply --folder tiles --up w", "--up");
  BOOST_TEST(content("in.ply") == whole);
  BOOST_TEST(content("file") == "a file");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_tile_points

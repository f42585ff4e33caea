// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program segment_trees: consistent tree files, labels and report, and rejection of
// invalid input.

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <examples/Program_run.h>
#include <filesystem>
#include <optional>
#include <scan/tree_foot.h>
#include <string>
#include <tiling/Index_sample.h>
#include <vector>

namespace test_segment_trees_program {

using Kernel = CGAL::Simple_cartesian<double>;

namespace {

/// Two adjacent trees, with a property of the points.
struct Stand_run : Program_run
{
  Stand_run() : Program_run("segment_trees")
  {
    pcs::Tree_skeleton<Kernel> tree;
    pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(5));
    pcs::Virtual_scanner scanner;
    scanner.angular_step = 0.2 * CGAL_PI / 180;
    pcs::Virtual_scan<Kernel> scan;
    pcs::scan_tree(tree, scan, scanner);
    std::vector<Kernel::Point_3> points = scan.points;
    for (const Kernel::Point_3& p : scan.points)
      points.push_back(p + Kernel::Vector_3(2.5, 0, 0));
    std::vector<std::int32_t> number;
    for (std::size_t i = 0; i < points.size(); ++i)
      number.push_back(static_cast<std::int32_t>(i));
    pcs::IO::Point_table table(points);
    table.add_property("number", number);
    pcs::IO::write_points(path("stand.ply"), table);
  }

  /// Runs another program in the folder.
  int run_other(const std::string& name, const std::string& arguments)
  {
    const std::string own = program;
    program = PCS_TEST_PROGRAMS "/" + name;
    const int code = run(arguments);
    program = own;
    return code;
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(segment_trees_program, Stand_run)

BOOST_AUTO_TEST_CASE(files_labels_and_report_agree)
{
  const int code =
      run("--input stand.ply --folder trees --points labelled.ply --report report.json");
  BOOST_TEST_REQUIRE(code == 0, err);
  const auto json = nlohmann::json::parse(content("report.json"));
  const auto labelled = pcs::IO::read_points(path("labelled.ply"));
  const auto& tree = labelled.property<std::int32_t>("tree");
  BOOST_TEST_REQUIRE(json["trees"].size() == 2u);
  std::size_t assigned = 0;
  for (std::int32_t t = 0; t < 2; ++t) {
    const auto& row = json["trees"][static_cast<std::size_t>(t)];
    const auto count = static_cast<std::size_t>(std::count(tree.begin(), tree.end(), t));
    BOOST_TEST(row["points"] == count);
    const auto own = pcs::IO::read_points(path("trees/stand_" + std::to_string(t + 1) + ".ply"));
    BOOST_TEST_REQUIRE(own.number_of_points() == count);
    const std::optional<std::array<double, 3>> foot = program::read_foot(own);
    BOOST_TEST_REQUIRE(bool(foot));
    BOOST_TEST((row["foot"] == nlohmann::json(*foot)));
    const auto& number = own.property<std::int32_t>("number");
    for (std::size_t k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(number[k]);
      BOOST_REQUIRE(tree[i] == t);
      BOOST_REQUIRE(own.points()[k] == labelled.points()[i]);
    }
    assigned += count;
  }
  BOOST_TEST(json["points"] == tree.size());
  BOOST_TEST(json["unassigned_points"] == tree.size() - assigned);
  BOOST_TEST(double(assigned) > 0.98 * double(tree.size()));
}

BOOST_AUTO_TEST_CASE(the_foot_of_a_moved_file_is_ignored)
{
  pcs::IO::Point_table table = pcs::IO::read_points(path("stand.ply"));
  program::write_foot({0.5, 0.25, 0.125}, table);
  program::write_foot({0.25, 0.5, 0.1}, table); // replaces the first
  BOOST_TEST(table.comments().size() == 1u);
  pcs::IO::write_points(path("foot.ply"), table);
  const auto foot = program::read_foot(pcs::IO::read_points(path("foot.ply")));
  BOOST_TEST_REQUIRE(bool(foot));
  BOOST_TEST((*foot == std::array<double, 3>{0.25, 0.5, 0.1}));
  for (Kernel::Point_3& p : table.points())
    p = p + Kernel::Vector_3(500, 0, 0);
  BOOST_TEST(!program::read_foot(table));
}

BOOST_AUTO_TEST_CASE(trees_have_heights_and_a_wrong_unit_is_noticed)
{
  BOOST_TEST_REQUIRE(run("--input stand.ply --report report.json --quiet") == 0, err);
  BOOST_TEST(err.empty(), err);
  const auto json = nlohmann::json::parse(content("report.json"));
  const auto points = pcs::IO::read_points(path("stand.ply")).points();
  double highest = 0;
  for (const auto& p : points)
    highest = std::max(highest, CGAL::to_double(p.z()));
  for (const auto& tree : json["trees"])
    BOOST_TEST(std::abs(tree["height"].get<double>() - highest) < 0.1);
  BOOST_TEST(json["warnings"].empty());
  std::vector<Kernel::Point_3> in_millimetres;
  for (const auto& p : points)
    in_millimetres.emplace_back(1000 * p.x(), 1000 * p.y(), 1000 * p.z());
  pcs::IO::write_points(path("millimetres.ply"), in_millimetres);
  if (run("--input millimetres.ply --report report.json") != 0)
    BOOST_TEST(err.find("check the unit of --breast-height") != std::string::npos, err);
  BOOST_TEST(err.find("the scan is ") != std::string::npos, err); // before the work
  BOOST_TEST(err.find("another unit") != std::string::npos, err);
}

BOOST_AUTO_TEST_CASE(names_of_files_need_not_be_utf_8)
{
  std::filesystem::copy_file(path("stand.ply"),
                             path("B\xfc"
                                  "che.ply"));
  BOOST_TEST_REQUIRE(run("--input B\xfc"
                         "che.ply --report report.json") == 0,
                     err);
  BOOST_TEST(nlohmann::json::parse(content("report.json"))["trees"].size() == 2u);
}

BOOST_AUTO_TEST_CASE(rays_without_return_are_left_out)
{
  pcs::IO::Point_table table = pcs::IO::read_points(path("stand.ply"));
  const std::size_t n = table.number_of_points();
  table.add_property("time", std::vector<double>(n, 1));
  std::vector<std::uint8_t> alpha(n, 255);
  for (std::size_t i = 0; i < n; i += 100) { // these rays end high above the trees
    table.points()[i] = Kernel::Point_3(table.points()[i].x(), table.points()[i].y(), 99);
    alpha[i] = 0;
  }
  table.add_property("alpha", alpha);
  pcs::IO::write_points(path("rays.ply"), table);
  BOOST_TEST_REQUIRE(run("--input rays.ply --points p.ply --report report.json") == 0, err);
  const std::string warning = std::to_string((n + 99) / 100) + " rays without return";
  BOOST_TEST(err.find(warning) != std::string::npos, err);
  const auto json = nlohmann::json::parse(content("report.json"));
  BOOST_TEST(json["warnings"].dump().find(warning) != std::string::npos);
  BOOST_TEST(json["trees"].size() == 2u);
  for (const auto& tree : json["trees"])
    BOOST_TEST(tree["height"].get<double>() < 90);
  BOOST_TEST(pcs::IO::read_points(path("p.ply")).number_of_points() == n - (n + 99) / 100);
}

BOOST_AUTO_TEST_CASE(a_tile_gives_the_trees_of_its_core)
{
  BOOST_TEST_REQUIRE(
      run_other("tile_points", "--input stand.ply --folder tiles --tile-points 2500 --buffer 1") ==
          0,
      err);
  const auto manifest = nlohmann::json::parse(content("tiles/tiles.json"));
  BOOST_TEST_REQUIRE(manifest["tiles"].size() > 1u);
  std::size_t number_of_own_feet = 0, number_of_cut_trees = 0, number_of_samples = 0;
  for (const auto& row : manifest["tiles"]) {
    const std::string name = row["file"];
    BOOST_TEST_REQUIRE(run("--input tiles/" + name +
                           " --tile-results segmented --points all.ply --report report.json") == 0,
                       err);
    const auto all = pcs::IO::read_points(path("all.ply"));
    const auto core = pcs::IO::read_points(path("segmented/" + name));
    const auto json =
        nlohmann::json::parse(content("segmented/" + name.substr(0, name.size() - 4) + ".json"));
    const auto whole = nlohmann::json::parse(content("report.json"));
    const auto& is_core = all.property<std::uint8_t>("is_core");
    const auto& tree = all.property<std::int32_t>("tree");
    std::vector<std::size_t> rows;
    std::vector<std::size_t> core_points(whole["trees"].size(), 0);
    std::vector<bool> is_at_rim(whole["trees"].size(), false);
    for (std::size_t i = 0; i < is_core.size(); ++i) {
      if (is_core[i] == 1)
        rows.push_back(i);
      if (tree[i] < 0)
        continue;
      const auto t = static_cast<std::size_t>(tree[i]);
      core_points[t] += is_core[i];
      for (int axis = 0; axis < 2; ++axis) {
        const double low = row["buffered"]["low"][std::size_t(axis)],
                     high = row["buffered"]["high"][std::size_t(axis)];
        double plot_low = low, plot_high = high;
        for (const auto& other : manifest["tiles"]) {
          plot_low = std::min(plot_low, other["core"]["low"][std::size_t(axis)].get<double>());
          plot_high = std::max(plot_high, other["core"]["high"][std::size_t(axis)].get<double>());
        }
        const double x = all.points()[i][axis];
        if ((plot_low < low && x < low + 0.13) || (plot_high > high && x > high - 0.13))
          is_at_rim[t] = true;
      }
    }
    const auto expected = all.select(rows);
    BOOST_TEST((core.points() == expected.points()));
    for (const char* property : {"number", "index", "tree"})
      BOOST_TEST((core.property_values(property) == expected.property_values(property)), property);
    BOOST_TEST(!core.has_property("is_core"));
    BOOST_TEST(json["core"] == row["core"]);
    BOOST_TEST(json["core_points"] == row["core_points"]);
    BOOST_TEST_REQUIRE(json["trees"].size() == whole["trees"].size());
    for (std::size_t t = 0; t < core_points.size(); ++t) {
      const auto& found = json["trees"][t];
      BOOST_TEST(found["foot"] == whole["trees"][t]["foot"]);
      BOOST_TEST(found["core_points"] == core_points[t]);
      BOOST_TEST(found["is_at_rim"] == bool(is_at_rim[t]));
      bool is_own = true;
      for (std::size_t axis = 0; axis < 2; ++axis)
        is_own = is_own && row["core"]["low"][axis] <= found["foot"][axis] &&
                 found["foot"][axis] < row["core"]["high"][axis];
      BOOST_TEST(found["is_foot_in_core"] == is_own);
      bool is_near_border = false;
      for (std::size_t axis = 0; axis < 2; ++axis)
        is_near_border =
            is_near_border ||
            found["foot"][axis].get<double>() < row["core"]["low"][axis].get<double>() + 1.3 ||
            found["foot"][axis].get<double>() > row["core"]["high"][axis].get<double>() - 1.3;
      BOOST_TEST(found.contains("sample") == (is_own && is_near_border));
      if (found.contains("sample")) {
        program::Index_sample sample; // of the points in core and buffer
        for (std::size_t i = 0; i < tree.size(); ++i)
          if (tree[i] == std::int32_t(t))
            sample.add(all.property<std::uint32_t>("index")[i]);
        BOOST_TEST((found["sample"].get<std::vector<std::uint64_t>>() == sample.indices()));
        ++number_of_samples;
      }
      number_of_own_feet += is_own;
      number_of_cut_trees += is_at_rim[t] && core_points[t] > 0;
      if (is_at_rim[t] && core_points[t] > 0)
        BOOST_TEST(err.find("larger --buffer") != std::string::npos, err);
    }
  }
  BOOST_TEST(number_of_own_feet >= 2u);
  BOOST_TEST(number_of_cut_trees > 0u);
  BOOST_TEST(number_of_samples > 0u);
}

BOOST_AUTO_TEST_CASE(a_tile_without_trees_is_a_result)
{
  write("few.xyz", "0 0 0\n1 0 0\n1 0 0\n0 1 0\n");
  BOOST_TEST_REQUIRE(run_other("tile_points", "--input few.xyz --folder few --buffer 1") == 0, err);
  BOOST_TEST_REQUIRE(run("--input few/tile_0001.ply --tile-results results") == 0, err);
  const auto labelled = pcs::IO::read_points(path("results/tile_0001.ply"));
  BOOST_TEST((labelled.property<std::int32_t>("tree") == std::vector<std::int32_t>(4, -1)));
  BOOST_TEST(nlohmann::json::parse(content("results/tile_0001.json"))["trees"].empty());
}

BOOST_AUTO_TEST_CASE(what_is_no_tile_is_refused)
{
  const auto refuses = [&](const std::string& arguments, const std::string& word) {
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
  };
  refuses("--input stand.ply --tile-results results", "tiles.json");
  BOOST_TEST_REQUIRE(
      run_other("tile_points", "--input stand.ply --folder tiles --tile-points 2500 --buffer 1") ==
          0,
      err);
  const std::string tile = content("tiles/tile_0001.ply");
  refuses("--input tiles/tile_0001.ply --tile-results tiles", "same file");
  refuses("--input tiles/tile_0001.ply --tile-results results --up x", "--up");
  refuses("--input tiles/tile_0001.ply --tile-results stand.ply", "directory");
  std::filesystem::copy_file(path("stand.ply"), path("tiles/other.ply"));
  refuses("--input tiles/other.ply --tile-results results", "no tile other.ply");
  std::filesystem::copy_file(path("tiles/tile_0002.ply"),
                             path("tiles/tile_0001.ply"),
                             std::filesystem::copy_options::overwrite_existing);
  refuses("--input tiles/tile_0001.ply --tile-results results", "make the tiles again");
  std::filesystem::copy_file(path("stand.ply"),
                             path("tiles/tile_0001.ply"),
                             std::filesystem::copy_options::overwrite_existing);
  refuses("--input tiles/tile_0001.ply --tile-results results", "it is no tile");
  write("tiles/tile_0001.ply", tile);
  write("tiles/tiles.json", "{\"points\": 3}");
  refuses("--input tiles/tile_0001.ply --tile-results results", "tiles.json: top level");
  BOOST_TEST(!exists("results/tile_0001.ply"));
  BOOST_TEST(!exists("results/tile_0001.json"));
}

BOOST_AUTO_TEST_CASE(small_trees_get_no_file)
{
  const int code = run("--input stand.ply --folder trees --min-points 100000000");
  BOOST_TEST_REQUIRE(code == 0, err);
  BOOST_TEST(!exists("trees/stand_1.ply"));
  BOOST_TEST(err.find("2 of 2 trees have fewer than --min-points 100000000 points") !=
                 std::string::npos,
             err);
}

BOOST_AUTO_TEST_CASE(only_files_of_trees_are_replaced)
{
  const std::string call = "--input stand.ply --folder trees";
  BOOST_TEST_REQUIRE(run(call) == 0, err);
  BOOST_TEST(err.empty(), err);
  std::filesystem::copy_file(path("trees/stand_1.ply"), path("trees/stand_3.ply"));
  std::filesystem::copy_file(path("stand.ply"), path("trees/stand_2026.ply")); // another scan
  BOOST_TEST_REQUIRE(run(call) == 0, err); // replaces the first two
  BOOST_TEST(err.find("trees has 1 files of trees of another run") != std::string::npos, err);
  BOOST_TEST((content("trees/stand_2026.ply") == content("stand.ply")));
  for (const char* option : {" --points ", " --report "}) {
    BOOST_TEST(run(call + option + "trees/../trees/stand_7.ply") == 1, option);
    BOOST_TEST(err.find("name of a file of a tree") != std::string::npos, err);
  }
  const std::string first = content("trees/stand_1.ply");
  write("trees/stand_2.ply", content("stand.ply"));
  BOOST_TEST(run(call + " --points p.ply --report r.json") == 1);
  BOOST_TEST(err.find("stand_2.ply exists and is no file of a tree") != std::string::npos, err);
  BOOST_TEST((content("trees/stand_2.ply") == content("stand.ply")));
  BOOST_TEST((content("trees/stand_1.ply") == first));
  BOOST_TEST(!exists("p.ply"));
  BOOST_TEST(!exists("r.json"));
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused)
{
  write("empty.ply", "");
  write("floor.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n2 2 0\n3 2 0\n3 1 0\n1 3 0\n2 3 0\n");
  write("file", "a file");
  const auto refuses = [&](const std::string& arguments, const std::string& word) {
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
  };
  refuses("--input stand.ply", "--folder");
  refuses("--input stand.ply --folder out --min-points -1", "--min-points");
  refuses("--input stand.ply --folder out --min-points 1e99", "--min-points");
  refuses("--input missing.ply --folder trees", "missing.ply");
  refuses("--input empty.ply --folder trees", "empty.ply");
  refuses("--input floor.xyz --folder trees", "no stem");
  refuses("--input floor.xyz --folder trees", "0 times breast height; check the unit");
  refuses("--input stand.ply --folder file", "directory");
  refuses("--input stand.ply --points stand.ply", "stand.ply");
  refuses("--input stand.ply --folder trees --breast-height 0", "breast_height");
  BOOST_TEST(!exists("trees/stand_1.ply"));
  BOOST_TEST(content("file") == "a file");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_segment_trees_program

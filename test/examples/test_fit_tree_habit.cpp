// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program fit_tree_habit: files of habits, grown trees, scores, and invalid input.

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_swc.h>
#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/generators/grow_tree.h>

#include <CGAL/Origin.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <examples/Program_run.h>
#include <string>
#include <utility>
#include <vector>

namespace test_fit_tree_habit_program {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

namespace {

struct Habit_run : Program_run
{
  Habit_run() : Program_run("fit_tree_habit")
  {
    Tree tree;
    for (const int seed : {1, 2}) {
      pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(seed));
      pcs::IO::write_swc(path("tree_" + std::to_string(seed) + ".swc"), tree);
    }
    pcs::grow_tree(tree, pcs::weeping_habit().scaled(0.45));
    pcs::IO::write_swc(path("other.swc"), tree);
  }

  /// Writes the returns of a wall at x = 0 that a scanner at (6, 0, 1.5) sees, twice with stations.
  void scan()
  {
    constexpr double step = 0.01;
    std::vector<Kernel::Point_3> points;
    for (double azimuth = -0.6; azimuth < 0.6; azimuth += step)
      for (double elevation = -0.3; elevation < 0.6; elevation += step) {
        const double across = std::tan(azimuth);
        points.emplace_back(0, 6 * across, 1.5 + 6 * std::hypot(1, across) * std::tan(elevation));
      }
    const std::size_t n = points.size();
    pcs::IO::Point_table table(std::move(points));
    table.add_property("station", std::vector<int>(n, 1));
    pcs::IO::write_points(path("scan.ply"), table);
  }

  /// Writes the habit of the first two trees, which the first call computes.
  void fit()
  {
    static std::string habit;
    if (habit.empty()) {
      const int code = run("--input tree_1.swc tree_2.swc --habit habit.json --simulations 20");
      BOOST_TEST_REQUIRE(code == 0, err);
      habit = content("habit.json");
    }
    write("habit.json", habit);
  }

  void refuses(const std::string& arguments, const std::string& word)
  {
    const std::size_t files = number_of_files();
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    BOOST_TEST(number_of_files() == files, arguments);
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(fit_tree_habit_program, Habit_run)

BOOST_AUTO_TEST_CASE(the_file_has_values_units_and_distributions)
{
  fit();
  const Json habit = Json::parse(content("habit.json"));
  BOOST_TEST(habit["format"] == "pcs_tree_habit");
  BOOST_TEST(habit["version"] == 1);
  BOOST_TEST(habit["length_unit"] == "m");
  BOOST_TEST(habit["number_of_trees"] == 2);
  BOOST_TEST(std::abs(habit["habit"]["height"].get<double>() - 3.2) < 1e-6);
  BOOST_TEST(habit["habit"]["crown"] == "vase");
  std::size_t found = 0;
  for (const Json& v : habit["values"])
    if (v["name"] == "spacing[1]") {
      ++found;
      BOOST_TEST(v["unit"] == "m");
      BOOST_TEST(v["value"] == habit["habit"]["spacing"][1]);
      BOOST_TEST(v["interval_95"][0] <= v["value"]);
      BOOST_TEST(v["interval_95"][1] >= v["value"]);
    }
  BOOST_TEST(found == 1u);
  BOOST_TEST(habit["distributions"].size() == 4u);
  BOOST_TEST(habit["distributions"][1]["insertion"].size() == habit["quantiles"].size());
}

BOOST_AUTO_TEST_CASE(a_habit_that_was_read_grows_the_same_trees)
{
  BOOST_TEST_REQUIRE(run("--input tree_1.swc tree_2.swc --habit habit.json --simulations 20 "
                         "--grow 2 -o at_once.swc") == 0,
                     err);
  BOOST_TEST_REQUIRE(run("--habit habit.json --grow 2 -o later.swc --report report.json --quiet") ==
                         0,
                     err);
  BOOST_TEST(out == "");
  for (const std::string number : {"1", "2"}) {
    BOOST_TEST(content("at_once_" + number + ".swc") == content("later_" + number + ".swc"));
    Tree tree;
    pcs::IO::read_swc<Kernel>(path("later_" + number + ".swc"), tree);
    BOOST_TEST(tree[boost::graph_bundle].branches.size() > 50u);
  }
  report = Json::parse(content("report.json"));
  BOOST_TEST(report["trees"].size() == 2u);
  BOOST_TEST(report["trees"][1]["volume"].get<double>() > 0);
  BOOST_TEST_REQUIRE(run("--habit habit.json --grow 1 -o one.swc --age 0.5 --seed 4") == 0, err);
  BOOST_TEST(content("one.swc").size() > 1000u);
}

BOOST_AUTO_TEST_CASE(another_kind_of_tree_is_an_outlier)
{
  fit();
  BOOST_TEST_REQUIRE(run("--habit habit.json --score tree_1.swc other.swc --report report.json") ==
                         0,
                     err);
  report = Json::parse(content("report.json"));
  BOOST_TEST(report["scores"][0]["share"].get<double>() > 0.02);
  BOOST_TEST(report["scores"][1]["share"].get<double>() < 0.02);
  BOOST_TEST(out.find("largest deviations") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(any_axis_may_be_up)
{
  const std::string options =
      "--simulations 20 --quiet --grow 1 --distance 0 --report report.json ";
  BOOST_TEST_REQUIRE(run("--input tree_1.swc --habit z.json -o z.swc " + options) == 0, err);
  BOOST_TEST(err.find("tilted") == std::string::npos, err);
  const Json expected = Json::parse(content("z.json"))["values"];
  Tree tree, grown, other;
  pcs::IO::read_swc<Kernel>(path("tree_1.swc"), tree);
  pcs::IO::read_swc<Kernel>(path("z.swc"), grown);
  // each rotation moves z to the axis, and keeps the handedness
  const std::vector<std::pair<std::string, Kernel::Point_3 (*)(const Kernel::Point_3&)>> axes = {
      {"x", [](const Kernel::Point_3& p) { return Kernel::Point_3(p.z(), p.x(), p.y()); }},
      {"y", [](const Kernel::Point_3& p) { return Kernel::Point_3(p.y(), p.z(), p.x()); }},
      {"-x", [](const Kernel::Point_3& p) { return Kernel::Point_3(-p.z(), p.y(), p.x()); }},
      {"-y", [](const Kernel::Point_3& p) { return Kernel::Point_3(p.x(), -p.z(), p.y()); }},
      {"-z", [](const Kernel::Point_3& p) { return Kernel::Point_3(p.x(), -p.y(), -p.z()); }}};
  for (const auto& [name, rotated] : axes) {
    Tree lying = tree;
    for (std::size_t v = 0; v < num_vertices(tree); ++v)
      lying[v].point = rotated(tree[v].point);
    pcs::IO::write_swc(path("lying.swc"), lying);
    const std::string arguments = "--input lying.swc --habit up.json -o up.swc --up " + name + " ";
    BOOST_TEST_REQUIRE(run(arguments + options) == 0, err);
    BOOST_TEST(Json::parse(content("up.json"))["values"] == expected, name);
    pcs::IO::read_swc<Kernel>(path("up.swc"), other);
    BOOST_TEST_REQUIRE(num_vertices(other) == num_vertices(grown));
    for (std::size_t v = 0; v < num_vertices(grown); ++v)
      BOOST_TEST_REQUIRE((other[v].point == rotated(grown[v].point)), name << " " << v);
  }
  // without the option, the trunk seems to be far from the vertical
  const std::string tilted = "lying.swc: the trunk is tilted by ";
  BOOST_TEST_REQUIRE(run("--input lying.swc --habit up.json -o up.swc " + options) == 0, err);
  BOOST_TEST(err.find(tilted) != std::string::npos, err);
  BOOST_TEST(err.find("from the vertical, which is --up z") != std::string::npos, err);
  BOOST_TEST(content("report.json").find(tilted) != std::string::npos);
  BOOST_TEST_REQUIRE(run("--habit z.json --score lying.swc --quiet --simulations 20") == 0, err);
  BOOST_TEST(err.find(tilted) != std::string::npos, err);
  refuses("--habit z.json --score lying.swc --up w", "--up");
}

BOOST_AUTO_TEST_CASE(other_units_are_noticed)
{
  fit();
  Tree tree;
  pcs::IO::read_swc<Kernel>(path("tree_1.swc"), tree);
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    tree[v].point = CGAL::ORIGIN + 1000 * (tree[v].point - CGAL::ORIGIN);
    tree[v].radius *= 1000;
  }
  pcs::IO::write_swc(path("mm.swc"), tree);
  BOOST_TEST_REQUIRE(run("--input tree_2.swc mm.swc --habit both.json --simulations 20 --quiet "
                         "--report report.json") == 0,
                     err);
  const std::string warning = "tree_2.swc and mm.swc: the extents are ";
  BOOST_TEST(err.find(warning) != std::string::npos, err);
  BOOST_TEST(content("report.json").find(warning) != std::string::npos);
  refuses("--habit habit.json --score mm.swc", "mm.swc: pcs::score_tree(): the trunk has the");
  refuses("--habit habit.json --grow 1 -o a.swc --height 3200", "--height 3200 (the habit has 3.2");
  refuses("--habit habit.json --grow 1 -o a.swc --height 3200", "branches are 0.1");
}

BOOST_AUTO_TEST_CASE(the_report_counts_what_was_found)
{
  const std::string arguments =
      "--input tree_1.swc tree_2.swc --habit habit.json --simulations 20 ";
  BOOST_TEST_REQUIRE(run(arguments + "--report report.json") == 0, err);
  report = Json::parse(content("report.json"));
  const Json habit = Json::parse(content("habit.json"));
  std::size_t identified = 0;
  for (const Json& v : habit["values"])
    identified += v["is_identified"] == true ? 1 : 0;
  BOOST_TEST(report["program"] == "fit_tree_habit");
  BOOST_TEST(report["version"].get<std::string>().size() >= 5u);
  BOOST_TEST(report["number_of_trees"] == 2);
  BOOST_TEST(report["number_of_branches"] == habit["number_of_branches"]);
  BOOST_TEST(report["number_of_parameters"] == habit["values"].size());
  BOOST_TEST(report["number_of_identified_parameters"] == identified);
  BOOST_TEST(report["warnings"].is_array());
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused_and_touches_no_file)
{
  fit();
  const std::string good = content("habit.json");
  refuses("--input tree_1.swc", "--habit");
  refuses("--habit habit.json", "nothing to do");
  refuses("--habit habit.json --grow 2", "--grow and --output belong together");
  refuses("--habit habit.json --grow 1 -o tree_1.swc --score tree_1.swc", "named twice");
  refuses("--habit habit.json --grow 1 -o habit.json", "named twice");
  for (const char* option : {"--smallest-radius 0.2", "--unit mm"})
    refuses("--habit habit.json --score other.swc " + std::string(option), "requires --input");
  for (const char* option : {"--height 5", "--height-spread 0.1", "--age 0.2", "--distance 9"})
    refuses("--habit habit.json --score other.swc " + std::string(option), "requires --grow");
  for (const char* option : {"--stations foo", "--step-degrees 3"})
    refuses("--habit habit.json --score other.swc " + std::string(option), "requires --complete");
  refuses("--habit new.json --input missing.swc", "missing.swc");
  refuses("--habit habit.json --grow 1 -o a.swc --age 2", "age");
  refuses("--habit none.json --grow 1 -o a.swc", "none.json: cannot be opened");
  write("stem.swc", "1 0 0 0 0 0.1 -1\n2 0 0 0 2 0.05 1\n");
  refuses("--habit new.json --input stem.swc", "a habit needs a trunk and at least 4 branches");

  const auto refuses_file =
      [&](const std::string& from, const std::string& to, const std::string& word) {
        std::string text = good;
        const std::size_t at = text.find(from);
        BOOST_TEST_REQUIRE(at != std::string::npos, from);
        text.replace(at, from.size(), to);
        write("bad.json", text);
        refuses("--habit bad.json --grow 1 -o a.swc", word);
        refuses("--habit bad.json --grow 1 -o a.swc", "bad.json");
      };
  refuses_file("\"version\": 1", "\"version\": 2", "/version: expected version 1, found 2");
  refuses_file("pcs_tree_habit", "other", "/format");
  refuses_file("\"flare\":", "\"glare\":", "the key \"flare\" is missing");
  refuses_file("\"crown\": \"vase\"", "\"crown\": \"ball\"", "/habit/crown");
  refuses_file("\"whorl\": 1", "\"whorl\": -1", "/habit/whorl");
  refuses_file("\"whorl\": 1", "\"whorl\": 1000", "whorl");
  BOOST_TEST(content("habit.json") == good);
}

BOOST_AUTO_TEST_CASE(hidden_wood_is_written_as_inferred)
{
  fit();
  scan();
  const std::string arguments =
      "--habit habit.json --complete tree_1.swc --scan scan.ply --simulations 20 ";
  const int code =
      run(arguments + "--scanner 6 0 1.5 --inferred inferred.swc --report report.json");
  BOOST_TEST_REQUIRE(code == 0, err);
  const Json wood = Json::parse(content("report.json"))["hidden_wood"];
  const double measured = wood["measured_volume"], inferred = wood["inferred_volume"]["value"];
  const Json total = wood["measured_and_inferred_volume"];
  BOOST_TEST(measured > 0);
  BOOST_TEST(std::abs(total["value"].get<double>() - measured - inferred) < 1e-9);
  BOOST_TEST(wood["inferred_volume"]["interval_95"][0].get<double>() >=
             std::min(0.0, wood["inferred_radius_correction"]["interval_95"][0].get<double>()));
  BOOST_TEST(total["interval_95"][0] < total["value"]);
  BOOST_TEST(total["interval_95"][1] > total["value"]);
  BOOST_TEST(std::abs(wood["angular_step"].get<double>() - 0.01) < 1e-5);
  BOOST_TEST(wood["hidden_crown_share"] > 0.1);
  const std::string swc = content("inferred.swc");
  BOOST_TEST(swc.find("# inferred hidden wood, not measured") == 0u);
  BOOST_TEST(wood["inferred_branches"] > 0);
  std::size_t bases = 0;
  for (std::size_t at = swc.find(" -1\n"); at != std::string::npos; at = swc.find(" -1\n", at + 1))
    ++bases;
  BOOST_TEST(bases > 0u);
  BOOST_TEST(bases <= wood["inferred_branches"].get<std::size_t>());

  // of two stations, the labels say that the second one saw the wall
  const int both = run(arguments + "--scanner 0 6 1.5 6 0 1.5 --report both.json");
  BOOST_TEST_REQUIRE(both == 0, err);
  BOOST_TEST(Json::parse(content("both.json"))["hidden_wood"] == wood);

  // in other coordinates, y is up: the same wood
  const auto rotated = [](const Kernel::Point_3& p) {
    return Kernel::Point_3(p.y(), p.z(), p.x());
  };
  Tree tree, upright, lying;
  pcs::IO::read_swc<Kernel>(path("tree_1.swc"), tree);
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].point = rotated(tree[v].point);
  pcs::IO::write_swc(path("lying.swc"), tree);
  pcs::IO::Point_table table = pcs::IO::read_points(path("scan.ply"));
  for (Kernel::Point_3& p : table.points())
    p = rotated(p);
  pcs::IO::write_points(path("lying.ply"), table);
  BOOST_TEST_REQUIRE(run("--habit habit.json --complete lying.swc --scan lying.ply --up y "
                         "--scanner 0 1.5 6 --simulations 20 --inferred back.swc "
                         "--report lying.json") == 0,
                     err);
  BOOST_TEST(Json::parse(content("lying.json"))["hidden_wood"] == wood);
  pcs::IO::read_swc<Kernel>(path("inferred.swc"), upright);
  pcs::IO::read_swc<Kernel>(path("back.swc"), lying);
  BOOST_TEST_REQUIRE(num_vertices(lying) == num_vertices(upright));
  for (std::size_t v = 0; v < num_vertices(lying); ++v)
    BOOST_TEST_REQUIRE((lying[v].point == rotated(upright[v].point)));
}

BOOST_AUTO_TEST_CASE(options_of_hidden_wood_are_checked)
{
  fit();
  scan();
  const std::string known = "--habit habit.json --simulations 20 ", tree = "--complete tree_1.swc ";
  refuses(known + tree + "--scan scan.ply --report r.json", "give --scanner");
  refuses(known + tree + "--scanner 6 0 1.5 --report r.json", "give --scan");
  refuses(known + tree + "--scan scan.ply --scanner 6 0 --report r.json", "three coordinates");
  refuses(known + tree + "--scan scan.ply --scanner 6 0 1.5", "--inferred or --report");
  refuses(known + "--scan scan.ply --grow 1 --output o.swc", "belong to --complete");
  refuses(known + tree + "--scan scan.ply --scanner 6 0 1.5 --inferred scan.ply", "scan.ply");
  refuses(known + tree + "--scan scan.ply --scanner 6 0 1.5 1 1 1 --stations s --inferred i.swc",
          "no property 's'");
  refuses(known + tree + "--scan scan.ply --scanner 6 0 1.5 --step-degrees 60 --inferred i.swc",
          "angular_step");
  refuses(known + tree + "--scan scan.ply --scanner 6 4 1.5 --inferred i.swc",
          "not on a grid of directions");
  const auto refuses_stations = [&](const std::vector<double>& stations,
                                    const std::string& scanner,
                                    const std::string& word) {
    pcs::IO::Point_table table(std::vector<Kernel::Point_3>(stations.size(), {0, 0, 1}));
    table.add_property("station", stations);
    pcs::IO::write_points(path("labels.ply"), table);
    refuses(known + tree + "--scan labels.ply --inferred i.swc --scanner " + scanner, word);
  };
  refuses_stations({0, 0, 1}, "6 0 1.5", "--scanner names one station");
  refuses_stations({0, 0.5}, "6 0 1.5 0 6 1.5", "point 1: property 'station' must be the number");
  refuses_stations({0, 1e300}, "6 0 1.5 0 6 1.5", "point 1: property 'station' must be the number");
  refuses_stations({1, 2}, "6 0 1.5 0 6 1.5", "has the station 2, counted from 0");
}

BOOST_AUTO_TEST_CASE(doubtful_hidden_wood_is_reported)
{
  fit();
  scan();
  const std::string arguments =
      "--habit habit.json --complete tree_1.swc --scan scan.ply --simulations 20 --quiet "
      "--scanner 6 0 1.5 --report report.json ";
  BOOST_TEST_REQUIRE(run(arguments + "--step-degrees 0.1") == 0, err);
  const Json wood = Json::parse(content("report.json"))["hidden_wood"];
  BOOST_TEST(wood["grid_share"] < 0.01);
  BOOST_TEST(wood["scanned_share"] < 0.5);
  BOOST_TEST(err.find("% of the length of the skeleton; check that") != std::string::npos, err);
  BOOST_TEST(err.find("% of the returns; check --scanner") != std::string::npos, err);
  BOOST_TEST_REQUIRE(run(arguments) == 0, err);
  BOOST_TEST(Json::parse(content("report.json"))["hidden_wood"]["grid_share"] > 0.95);
  BOOST_TEST(err.find("of the returns") == std::string::npos, err);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_tree_habit_program

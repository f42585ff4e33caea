// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program extract_tree_skeleton: consistent output files, rejection of invalid input,
// continuation of a batch.

#include <pcs/IO/read_swc.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <examples/Program_run.h>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace test_skeleton_program {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

namespace {

/// Far from the origin, similar to map coordinates: only doubles resolve millimetres there.
constexpr double far_x = 5e5, far_y = 5e6;

/// A stem of radius 0.1 and height 2.5 with a branch of radius 0.03 to the side, as text with 17
/// digits.
std::string fork_text(double scale = 1)
{
  std::string text;
  char line[128];
  const auto add = [&](double x, double y, double z) {
    std::snprintf(line,
                  sizeof line,
                  "%.17g %.17g %.17g\n",
                  far_x + scale * x,
                  far_y + scale * y,
                  scale * z);
    text += line;
  };
  for (int i = 0; i < 6000; ++i) {
    const double a = 2.39996322972865332 * i;
    add(0.1 * std::cos(a), 0.1 * std::sin(a), 2.5 * (i + 0.5) / 6000);
    if (i < 1500)
      add(0.1 + 1.2 * (i + 0.5) / 1500, 0.03 * std::cos(a), 1.5 + 0.03 * std::sin(a));
  }
  return text;
}

struct Row
{
  long id, type, parent;
  double x, y, z, radius;
};

std::vector<Row> rows_of(const std::string& swc)
{
  std::vector<Row> rows;
  std::istringstream in(swc);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#')
      continue;
    Row r{};
    std::istringstream words(line);
    words >> r.id >> r.type >> r.x >> r.y >> r.z >> r.radius >> r.parent;
    BOOST_REQUIRE(!words.fail());
    rows.push_back(r);
  }
  return rows;
}

std::size_t count_lines(const std::string& text)
{
  return std::size_t(std::count(text.begin(), text.end(), '\n'));
}

struct Skeleton_run : Program_run
{
  Skeleton_run() : Program_run("extract_tree_skeleton") { write("tree.xyz", fork_text()); }

  /// Runs without resampled copies, which take several times as long, unless the arguments contain
  /// them.
  int run(const std::string& arguments)
  {
    const bool has_copies = arguments.find("--resamples") != std::string::npos;
    return Program_run::run(has_copies ? arguments : "--resamples 0 " + arguments);
  }

  std::vector<Json> log() const
  {
    std::vector<Json> lines;
    std::istringstream in(content("out/batch.jsonl"));
    for (std::string line; std::getline(in, line);)
      lines.push_back(Json::parse(line));
    return lines;
  }

  void refuses(const std::string& arguments, const std::string& word)
  {
    write("old.swc", "an old file");
    const std::size_t files = number_of_files();
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    BOOST_TEST((count_lines(err) == 1 || count_lines(err) == 2), arguments << ": " << err);
    BOOST_TEST(out == "");
    BOOST_TEST(content("old.swc") == "an old file");
    BOOST_TEST(number_of_files() == files, arguments);
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(skeleton_program, Skeleton_run)

BOOST_AUTO_TEST_CASE(the_report_has_the_spread_of_resampled_copies)
{
  BOOST_TEST_REQUIRE(run("--input tree.xyz --swc a.swc --report a.json") == 0);
  BOOST_TEST_REQUIRE(run("--input tree.xyz --swc b.swc --report b.json --resamples 2") == 0);
  BOOST_TEST(content("a.swc") == content("b.swc"));
  const Json without = Json::parse(content("a.json")), with = Json::parse(content("b.json"));
  BOOST_TEST(without.count("spread") == 0u);
  BOOST_TEST(with["spread"]["copies"] == 2);
  BOOST_TEST(with["spread"]["volume"].get<double>() > 0);
  BOOST_TEST(with["spread"]["volume"].get<double>() < 0.05 * with["total"]["volume"].get<double>());
  // Without copies, the estimates are the values of the skeleton. Standard errors are printed.
  BOOST_TEST(without["volume"] == without["total"]["volume"]);
  BOOST_TEST(without["height"] == without["skeleton"]["height"]);
  BOOST_TEST(without["trunk_volume"] == without["by_order"][0]["volume"]);
  BOOST_TEST(with["volume"] != with["total"]["volume"]);
  for (const char* value :
       {"height", "diameter_at_breast_height", "trunk_length", "length", "volume", "trunk_volume"})
    BOOST_TEST(std::abs(with[value].get<double>() - without[value].get<double>()) <
               with["standard_errors"][value].get<double>());
  BOOST_TEST(out.find("volume 0.0") != std::string::npos, out);
  BOOST_TEST(out.find(" +- ") != std::string::npos, out);
}

BOOST_AUTO_TEST_CASE(all_results_agree)
{
  const int code = run("--input tree.xyz --swc t.swc --mesh m.ply --cylinders c.csv --edges e.ply "
                       "--branches b.csv --tree-table s.csv --points p.ply --leaves l.ply "
                       "--report r.json");
  BOOST_TEST_REQUIRE(code == 0, err);
  const Json json = Json::parse(content("r.json"));
  BOOST_TEST(json["status"] == "converged");
  BOOST_TEST(json["branches"] == 2);
  BOOST_TEST(std::abs(json["diameter_at_breast_height"].get<double>() - 0.2) < 0.004);
  BOOST_TEST(std::abs(json["height"].get<double>() - 2.5) < 0.05);
  BOOST_TEST(json["by_order"].size() == 2u);
  double length = 0, volume = 0;
  for (const Json& size : json["by_size"])
    length += size["length"].get<double>(), volume += size["volume"].get<double>();
  BOOST_TEST(std::abs(length - json["total"]["length"].get<double>()) < 1e-9);
  BOOST_TEST(std::abs(volume - json["total"]["volume"].get<double>()) < 1e-9);
  for (const char* stage :
       {"reading", "neighbors", "paths", "axes", "joints", "sections", "mesh", "writing"})
    BOOST_TEST(json["seconds"][stage].get<double>() >= 0);

  // SWC: ids from 1, parents first, one root, original coordinates without loss.
  const std::vector<Row> rows = rows_of(content("t.swc"));
  BOOST_TEST_REQUIRE(rows.size() == json["nodes"].get<std::size_t>());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    BOOST_TEST(rows[k].id == long(k) + 1);
    BOOST_TEST(
        (k == 0 ? rows[k].parent == -1 : rows[k].parent >= 1 && rows[k].parent < rows[k].id));
    BOOST_TEST((rows[k].type == 5 || rows[k].type == 6));
    BOOST_TEST(std::abs(rows[k].x - far_x) < 1.4);
    BOOST_TEST(std::abs(rows[k].y - far_y) < (rows[k].type == 5 ? 0.003 : 0.01));
    BOOST_TEST(std::abs(rows[k].radius - (rows[k].type == 5 ? 0.1 : 0.03)) < 0.006);
  }
  Tree tree;
  pcs::IO::read_swc<Kernel>(path("t.swc"), tree);
  BOOST_TEST(num_vertices(tree) == rows.size());

  // Cylinders: lengths and volumes are those of the report.
  std::istringstream table(content("c.csv"));
  std::string line;
  std::getline(table, line);
  BOOST_TEST(line.rfind("sx,sy,sz,ax,ay,az,length,radius,parent,branch,order", 0) == 0u);
  double total = 0;
  long row = 0;
  while (std::getline(table, line)) {
    ++row;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    double v[13];
    for (double& value : v)
      BOOST_TEST_REQUIRE(bool(words >> value));
    total += v[6];
    BOOST_TEST(std::abs(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] - 1) < 1e-9);
    BOOST_TEST((v[8] >= 0 && v[8] < double(row)));
    BOOST_TEST(std::abs(v[1] - far_y) < 0.2);
  }
  BOOST_TEST(std::abs(total - length) < 1e-9 * length);

  // Tables of branches and of the tree, in litres and metres.
  std::istringstream sizes(content("s.csv"));
  std::getline(sizes, line);
  BOOST_TEST(line.rfind("TotalVolume,TrunkVolume,BranchVolume,TreeHeight", 0) == 0u);
  double litres = 0;
  BOOST_TEST_REQUIRE(bool(sizes >> litres));
  BOOST_TEST(std::abs(litres - 1000 * volume) < 1e-6 * litres);
  const std::string branches = content("b.csv");
  BOOST_TEST(branches.rfind("order,parent,volume,area,length,angle", 0) == 0u);
  BOOST_TEST(std::count(branches.begin(), branches.end(), '\n') == 3);

  // The points keep their order, and have the ids of existing branches.
  const Table points = pcs::IO::read_points(path("p.ply"));
  const Table scan = pcs::IO::read_points(path("tree.xyz"));
  BOOST_TEST_REQUIRE(points.number_of_points() == scan.number_of_points());
  BOOST_TEST((points.points() == scan.points()));
  std::size_t explained = 0;
  for (const std::int32_t b : points.property<std::int32_t>("branch")) {
    BOOST_TEST((b >= -1 && b < 2));
    explained += b >= 0;
  }
  BOOST_TEST(explained > 7000u);
  BOOST_TEST(points.has_property("dense"));
  BOOST_TEST(points.has_property("residual"));

  // Mesh and edges: the numbers in the headers, and the coordinates.
  const std::string mesh = content("m.ply"), edges = content("e.ply");
  BOOST_TEST(mesh.find("element vertex " + std::to_string(json["mesh"]["vertices"].get<long>())) !=
             std::string::npos);
  BOOST_TEST(mesh.find("element face " + std::to_string(json["mesh"]["triangles"].get<long>())) !=
             std::string::npos);
  BOOST_TEST(json["leaves"].get<long>() > 0);
  BOOST_TEST(
      content("l.ply").find("element vertex " + std::to_string(4 * json["leaves"].get<long>())) !=
      std::string::npos);
  double first[3];
  std::memcpy(first, mesh.data() + mesh.find("end_header\n") + 11, sizeof first);
  BOOST_TEST(std::abs(first[1] - far_y) < 0.2);
  BOOST_TEST(edges.find("element vertex " + std::to_string(rows.size())) != std::string::npos);
  BOOST_TEST(edges.find("element edge " + std::to_string(rows.size() - 1)) != std::string::npos);

  // The other mesh format has the same triangles.
  BOOST_TEST_REQUIRE(run("--quiet --input tree.xyz --swc t2.swc --mesh m.obj") == 0);
  BOOST_TEST(out == "");
  BOOST_TEST(content("t2.swc") == content("t.swc"));
  const std::string obj = content("m.obj");
  std::size_t faces = 0;
  std::istringstream in(obj);
  while (std::getline(in, line))
    faces += line.rfind("f ", 0) == 0;
  BOOST_TEST(faces == json["mesh"]["triangles"].get<std::size_t>());
}

BOOST_AUTO_TEST_CASE(options_change_what_they_say)
{
  const std::string base = "--quiet --input tree.xyz --report r.json ";
  const auto report_of = [&](const std::string& more) {
    const int code = run(base + more);
    BOOST_TEST_REQUIRE(code == 0, more << ": " << err);
    return Json::parse(content("r.json"));
  };
  const Json plain = report_of("--swc a.swc --mesh m.ply");
  const Json coarse = report_of("--swc b.swc --mesh m.ply --tolerance 0.02");
  BOOST_TEST(coarse["mesh"]["triangles"].get<long>() < plain["mesh"]["triangles"].get<long>());
  const Json tubes = report_of("--swc b.swc --mesh m.ply --separate");
  BOOST_TEST(tubes["mesh"]["joined_branches"] == 0);
  BOOST_TEST(plain["mesh"]["joined_branches"] == 1);
  const Json low = report_of("--swc b.swc --breast-height 3");
  BOOST_TEST(low["diameter_at_breast_height"].is_null());
  const Json sections = report_of("--swc b.swc --method sections");
  BOOST_TEST(content("b.swc") != content("a.swc"));
  BOOST_TEST(std::abs(sections["diameter_at_breast_height"].get<double>() - 0.2) < 0.03);
  report_of("--swc b.swc --up -z");
  BOOST_TEST(rows_of(content("b.swc"))[0].z > 2.3); // the root is at the other end
  report_of("--swc b.swc --root 500001.3 5000000 1.5");
  BOOST_TEST(rows_of(content("b.swc"))[0].x > far_x + 1.1);
  const Json beam = report_of("--swc b.swc --scanner 500010 5000000 1 --beam-milliradians 5");
  BOOST_TEST(beam["total"]["volume"].get<double>() < 0.99 * plain["total"]["volume"].get<double>());

  // Along a given skeleton: its nodes, and the radii of the scan.
  write("given.swc",
        "1 0 500000 5000000 0 9 -1\n2 0 500000 5000000 1.5 9 1\n3 0 500000 5000000 2.5 9 2\n"
        "4 0 500001.3 5000000 1.5 9 2\n");
  const Json given = report_of("--swc b.swc --skeleton given.swc");
  BOOST_TEST(given["branches"] == 2);
  BOOST_TEST(std::abs(given["diameter_at_breast_height"].get<double>() - 0.2) < 0.004);
  BOOST_TEST(std::abs(given["total"]["length"].get<double>() - 3.8) < 1e-6);
  // The largest of two trees, and the same tree as a table of cylinders.
  write("two.swc", "9 0 0 0 0 1 -1 # another tree\n" + content("given.swc"));
  const Json largest = report_of("--swc c.swc --skeleton two.swc");
  BOOST_TEST(content("c.swc") == content("b.swc"));
  BOOST_TEST(largest["warnings"].dump().find("two.swc: the file has 2 trees: 1 of 5 nodes") !=
             std::string::npos);
  refuses("--input tree.xyz --swc old.swc --skeleton two.swc --root-number 3",
          "there is no tree 3: the file has 2 trees");
  write("given.txt",
        "radius\tlength\tstart_point\taxis_direction\tparent\n"
        "9\t1.5\t500000\t5000000\t0\t0\t0\t1\t0\n9\t1\t500000\t5000000\t1.5\t0\t0\t1\t1\n"
        "8\t1.3\t500000\t5000000\t1.5\t1\t0\t0\t1\n");
  const Json table = report_of("--swc c.swc --skeleton given.txt");
  BOOST_TEST(table["branches"] == 2);
  BOOST_TEST(std::abs(table["total"]["length"].get<double>() - 3.8) < 1e-6);

  // A property that classifies wood.
  std::istringstream in(fork_text());
  std::ostringstream labelled;
  labelled << "x y z is_branch\n";
  std::size_t k = 0;
  for (std::string line; std::getline(in, line); ++k)
    labelled << line << ' ' << (k < 3000 && k % 2 == 1 ? 0 : 1) << '\n';
  write("labelled.csv", labelled.str());
  const int code = run("--quiet --input labelled.csv --wood is_branch --swc b.swc --report r.json");
  BOOST_TEST_REQUIRE(code == 0, err);
  const Json wood = Json::parse(content("r.json"));
  BOOST_TEST(wood["branches"] == 1);
  BOOST_TEST(wood["points"]["leaves"] == 1500);
}

/// The points of the fork with additional columns `names` and their values `values(is_branch)`.
template <class Values>
std::string fork_table(const std::string& names, Values values)
{
  std::string table = "x,y,z," + names + "\n";
  std::istringstream in(fork_text());
  std::string line;
  for (int i = 0; std::getline(in, line); ++i) {
    std::replace(line.begin(), line.end(), ' ', ',');
    table += line + ',' + values(i < 3000 && i % 2 == 1) + '\n';
  }
  return table;
}

BOOST_AUTO_TEST_CASE(wood_labels_of_other_programs_need_a_value)
{
  write("labels.csv", fork_table("label", [](bool is_branch) { return is_branch ? "2" : "4"; }));
  refuses("--input labels.csv --swc old.swc --wood label", "--wood label --wood-value 4");
  refuses("--input labels.csv --swc old.swc --wood label", "2 (1500 points), 4 (6000 points)");
  refuses("--input labels.csv --swc old.swc --wood label=3", "no point is wood");
  refuses("--input labels.csv --swc old.swc --wood label=stem", "PROPERTY=VALUE");
  refuses("--input labels.csv --swc old.swc --wood label=4 --wood-value 4", "given twice");
  refuses("--input labels.csv --swc old.swc --wood label --wood-value 3,5", "no point is wood");
  refuses("--input labels.csv --swc old.swc --wood-value 4", "no property 'wood'");
  const int code = run("--quiet --input labels.csv --wood label=4 --swc a.swc --report a.json");
  BOOST_REQUIRE_MESSAGE(code == 0, err);
  BOOST_TEST(Json::parse(content("a.json"))["points"]["leaves"] == 1500);
  for (const std::string values :
       {"--wood-value 4", "--wood-value 3,4", "--wood-value 3 --wood-value 4"}) {
    const int same = run("--quiet --input labels.csv --wood label --swc b.swc " + values);
    BOOST_REQUIRE_MESSAGE(same == 0, err);
    BOOST_TEST(content("b.swc") == content("a.swc"));
  }
  const int all = run("--input labels.csv --wood label --wood-value 2,4 --swc b.swc");
  BOOST_REQUIRE_MESSAGE(all == 0, err);
  BOOST_TEST(err.find("warning: labels.csv: all points are wood") != std::string::npos, err);
  // The default property has the same checks.
  write("wood.csv", fork_table("wood", [](bool is_branch) { return is_branch ? "1" : "2"; }));
  refuses("--input wood.csv --swc old.swc", "1 (1500 points), 2 (6000 points)");
}

BOOST_AUTO_TEST_CASE(rays_without_return_are_left_out)
{
  const auto cloud = [](const std::string& alpha,
                        const std::string& alpha_of_rays,
                        const std::string& time = "time") {
    std::string table = fork_table("alpha," + time, [&](bool) { return alpha + ",3"; });
    for (int i = 0; i < 50; ++i) // ends of rays without a return, far above
      table +=
          std::to_string(far_x + i) + ',' + std::to_string(far_y) + ",40," + alpha_of_rays + ",3\n";
    return table;
  };
  write("rays.csv", cloud("255", "0"));
  int code = run("--input rays.csv --swc a.swc --report a.json");
  BOOST_REQUIRE_MESSAGE(code == 0, err);
  BOOST_TEST(err.find("50 rays without return") != std::string::npos, err);
  const Json without = Json::parse(content("a.json"));
  BOOST_TEST(without["points"]["all"] == 7500);
  code = run("--quiet --input tree.xyz --swc b.swc");
  BOOST_REQUIRE_MESSAGE(code == 0, err);
  BOOST_TEST(content("a.swc") == content("b.swc"));
  // A constant alpha of 0 contains no information about rays.
  write("colours.csv", cloud("0", "0"));
  code = run("--quiet --input colours.csv --swc c.swc --report c.json");
  BOOST_REQUIRE_MESSAGE(code == 0, err);
  BOOST_TEST(Json::parse(content("c.json"))["points"]["all"] == 7550);
  // Colours with transparent points, but without times, are not a ray cloud.
  write("clear.csv", cloud("255", "0", "intensity"));
  code = run("--quiet --input clear.csv --swc c.swc --report c.json");
  BOOST_REQUIRE_MESSAGE(code == 0, err);
  BOOST_TEST(Json::parse(content("c.json"))["points"]["all"] == 7550);
}

BOOST_AUTO_TEST_CASE(flight_lines_are_no_stations)
{
  // The line alternates from point to point. As stations, the halves of each branch would be
  // registered.
  auto lines = [k = 0](bool) mutable { return k++ % 2 ? "7" : "8"; };
  write("lines.csv", fork_table("point_source_id", lines));
  int code = run("--quiet --input lines.csv --swc a.swc --report a.json");
  BOOST_REQUIRE_MESSAGE(code == 0, err);
  BOOST_TEST(Json::parse(content("a.json"))["stations"].empty());
  code = run("--quiet --input tree.xyz --swc b.swc");
  BOOST_REQUIRE_MESSAGE(code == 0, err);
  BOOST_TEST(content("a.swc") == content("b.swc"));
}

BOOST_AUTO_TEST_CASE(lengths_are_in_the_unit_of_the_input)
{
  write("mm.xyz", fork_text(1000));
  BOOST_TEST_REQUIRE(
      run("--quiet --input mm.xyz --swc t.swc --breast-height 1300 --report r.json") == 0);
  const Json json = Json::parse(content("r.json"));
  BOOST_TEST(std::abs(json["diameter_at_breast_height"].get<double>() - 200) < 4);
  const std::vector<Row> rows = rows_of(content("t.swc"));
  BOOST_TEST(std::abs(rows[rows.size() / 3].radius - 100) < 5);
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused_and_touches_no_file)
{
  write("empty.ply", "");
  write("torn.ply", content("in.ply").substr(0, 900));
  write("one.xyz", "1 2 3\n");
  write("nan.xyz", fork_text() + "nan 0 0\n");
  write("words.xyz", "this is no point\n");
  std::string flat;
  for (int i = 0; i < 2500; ++i)
    flat += std::to_string(0.02 * (i % 50)) + " " + std::to_string(0.02 * (i / 50)) + " 0\n";
  write("flat.xyz", flat);
  write("forest.swc", "1 0 0 0 0 1 -1\n2 0 0 0 0 1 -1\n");
  write("dot.swc", "1 0 0 0 0 1 -1\n2 0 0 0 0 1 1\n");
  write("far.swc", "1 0 900 0 0 1 -1\n2 0 900 0 1 1 1\n");
  std::string huge;
  for (int i = 0; i < 2000; ++i)
    huge += std::to_string(i % 7) + "e149 " + std::to_string(i % 11) + "e149 " + std::to_string(i) +
            "e149\n";
  write("huge.xyz", huge);
  std::filesystem::create_directory(path("folder"));
  refuses("", "--input");
  refuses("--input tree.xyz", "--swc is required");
  refuses("--input missing.ply --swc old.swc", "missing.ply");
  refuses("--input empty.ply --swc old.swc", "empty");
  refuses("--input torn.ply --swc old.swc", "torn.ply");
  refuses("--input one.xyz --swc old.swc", "only 1 different");
  refuses("--input nan.xyz --swc old.swc", "finite");
  refuses("--input huge.xyz --swc old.swc", "beyond 1e50");
  refuses("--input words.xyz --swc old.swc", "words.xyz");
  refuses("--input flat.xyz --swc old.swc", "there is no tree");
  refuses("--input flat.xyz --swc old.swc", "0 times breast height; check the unit of");
  refuses("--input tree.xyz --swc old.swc --mesh no/m.ply", "there is no such folder");
  refuses("--input tree.xyz --swc old.swc --mesh m.stl", "must be .ply, .obj or .glb");
  refuses("--input tree.xyz --swc old.swc --points p.e57", "p.e57");
  refuses("--input tree.xyz --swc old.swc --report folder", "is a directory");
  refuses("--input tree.xyz --swc folder", "is a directory");
  refuses("--input tree.xyz --swc old.swc --cylinders old.swc", "the same file");
  refuses("--input tree.xyz --swc tree.xyz", "the same file");
  refuses("--input tree.xyz in.ply --swc old.swc", "--folder");
  refuses("--input tree.xyz --swc old.swc --also mesh", "--folder");
  refuses("--input tree.xyz --swc old.swc --up w", "--up");
  refuses("--input tree.xyz --swc old.swc --breast-height -1", "breast_height");
  refuses("--input tree.xyz --swc old.swc --tolerance -1", "--tolerance");
  refuses("--input tree.xyz --swc old.swc --mesh m.ply --tolerance nan", "--tolerance");
  refuses("--input tree.xyz --swc old.swc --mesh m.ply --tolerance inf", "--tolerance");
  refuses("--input tree.xyz --swc old.swc --root 1 2", "--root");
  refuses("--input tree.xyz --swc old.swc --root 900 0 0", "--root is ");
  refuses("--input tree.xyz --swc old.swc --root 900 0 0", "in the coordinates and unit of");
  refuses("--input tree.xyz --swc old.swc --root nan 0 0", "--root must be a number");
  refuses("--input tree.xyz --swc old.swc --scanner 1 2 3 4", "three coordinates");
  refuses("--input tree.xyz --swc old.swc --wood bark", "no property 'bark'");
  refuses("--input in.ply --swc old.swc --wood bark", "--wood: it has x, y, z, nx, status, ny,");
  refuses("--input tree.xyz --swc old.swc --stations place", "no property 'place'");
  refuses("--input tree.xyz --swc old.swc --stations place", "--stations: it has x, y, z");
  refuses("--input tree.xyz --swc old.swc --stations x --keep-stations", "--stations");
  refuses("--input tree.xyz --swc old.swc --skeleton forest.swc", "forest.swc");
  refuses("--input tree.xyz --swc old.swc --skeleton dot.swc", "coincide");
  refuses("--input tree.xyz --swc old.swc --skeleton far.swc", "--skeleton is ");
  refuses("--input tree.xyz --swc old.swc --skeleton dot.swc --root 0 0 0", "--root");
  refuses("--input tree.xyz --swc old.swc --method magic", "--method");
  for (const std::string option : {"--fit circle",
                                   "--all-points",
                                   "--no-support",
                                   "--estimate-normals",
                                   "--slice-radius 1",
                                   "--slice-offset 2",
                                   "--turn-cost 1",
                                   "--dense-radius 0.2",
                                   "--dense-offset 2",
                                   "--allometry 0.4"})
    refuses("--input tree.xyz --swc old.swc " + option, "--method sections");
  refuses("--input tree.xyz --swc old.swc --method sections --allometry -1", "--allometry");
  refuses("--input tree.xyz --swc old.swc --method sections --slice-radius 0", "`radius`");
  refuses("--input tree.xyz --swc old.swc --method chains --fit circle", "--method sections");
  refuses("--input tree.xyz --swc old.swc --tolerance 0.1", "--tolerance has no effect");
  refuses("--input tree.xyz --swc old.swc --separate", "--separate has no effect");
  refuses("--input tree.xyz --swc old.swc --beam-milliradians 1", "--scanner");
  refuses("--input tree.xyz --swc old.swc --scanner 5e5 5e6 9 --beam-milliradians 1e9",
          "--beam-milliradians");
  for (const std::string method : {"sections", "level_sets"})
    for (const std::string option : {"--keep-leaves", "--keep-trunk"})
      refuses("--input tree.xyz --swc old.swc " + option + " --method " + method,
              option + " has no effect without --method chains");
  refuses("--input tree.xyz --swc old.swc --keep-trunk --skeleton far.swc",
          "--keep-trunk has no effect with --skeleton");
  refuses("--input tree.xyz --swc -", "only --report can be written to standard output");
  refuses("--input tree.xyz --swc old.swc --mesh ''", "--mesh has an empty value");
  refuses("--input tree.xyz --folder out --swc old.swc", "leave out --swc old.swc");
  refuses("--input tree.xyz --folder out --report -", "leave out --report -");
  refuses("--input tree.xyz folder/tree.ply --folder out", "would have the same name; rename");
  // Different spellings of one file, or an output of another scan of the batch.
  refuses("--input tree.xyz --swc old.swc --points folder/../tree.xyz", "the same file");
  std::filesystem::create_symlink("tree.xyz", path("link.xyz"));
  refuses("--input link.xyz --swc old.swc --points tree.xyz", "the same file");
  std::filesystem::create_hard_link(path("tree.xyz"), path("hard.xyz"));
  refuses("--input hard.xyz --swc old.swc --report tree.xyz", "the same file");
  write("in_points.ply", content("in.ply"));
  refuses("--input in.ply in_points.ply --folder . --also points", "the same file");
}

#ifdef PCS_WITH_ZLIB
BOOST_AUTO_TEST_CASE(packed_files_are_read_as_their_contents)
{
  write("given.swc", "1 0 500000 5000000 0 9 -1\n2 0 500000 5000000 2.5 9 1\n");
  BOOST_TEST_REQUIRE(run("--quiet --input tree.xyz --swc a.swc --skeleton given.swc") == 0, err);
  BOOST_TEST_REQUIRE(std::system(("gzip " + path("tree.xyz") + " " + path("given.swc")).c_str()) ==
                     0);
  BOOST_TEST_REQUIRE(run("--quiet --input tree.xyz.gz --swc b.swc --skeleton given.swc.gz") == 0,
                     err);
  BOOST_TEST(content("b.swc") == content("a.swc"));
  // the results of a batch have the name without both extensions
  BOOST_TEST(run("--quiet --input tree.xyz.gz --folder out") == 0, err);
  BOOST_TEST(exists("out/tree.swc"));
  refuses("--input tree.xyz.gz --swc old.swc --points a.ply.gz", "gzip FILE");
}
#endif

BOOST_AUTO_TEST_CASE(a_batch_goes_on_and_resumes)
{
  write("good.xyz", fork_text());
  write("bad.xyz", "1 2 3\n");
  const std::string batch = "--quiet --input tree.xyz bad.xyz missing.ply good.xyz --folder out ";
  BOOST_TEST(run(batch + "--also mesh,cylinders edges points") == 1);
  BOOST_TEST(count_lines(err) == 2u);
  std::vector<Json> lines = log();
  BOOST_TEST_REQUIRE(lines.size() == 4u);
  BOOST_TEST(lines[0]["status"] == "converged");
  BOOST_TEST(lines[0]["branches"] == 2);
  BOOST_TEST(lines[1]["status"] == "failed");
  BOOST_TEST(lines[1]["error"].get<std::string>().find("different points") != std::string::npos);
  BOOST_TEST(lines[2]["status"] == "failed");
  BOOST_TEST(lines[3]["status"] == "converged");
  for (const char* name : {"tree.swc",
                           "tree_mesh.ply",
                           "tree_cylinders.csv",
                           "tree_edges.ply",
                           "tree_points.ply",
                           "good.swc"})
    BOOST_TEST(exists(std::string("out/") + name), name);
  BOOST_TEST(!exists("out/bad.swc"));
  BOOST_TEST(!exists("out/bad_mesh.ply"));
  BOOST_TEST(content("out/good.swc") == content("out/tree.swc"));

  // Second run: only the failed scans. One of them is repaired, and the last line is truncated.
  write("bad.xyz", fork_text());
  write("out/batch.jsonl", content("out/batch.jsonl") + "{\"input\": \"half");
  const auto time = std::filesystem::last_write_time(path("out/tree.swc"));
  BOOST_TEST(run(batch) == 1);
  BOOST_TEST((std::filesystem::last_write_time(path("out/tree.swc")) == time));
  BOOST_TEST(exists("out/bad.swc"));
  std::istringstream in(content("out/batch.jsonl"));
  std::size_t whole = 0, torn = 0;
  for (std::string line; std::getline(in, line);)
    ++(Json::accept(line) ? whole : torn);
  BOOST_TEST(whole == 6u);
  BOOST_TEST(torn == 1u);

  // A missing result is computed again.
  std::filesystem::remove(path("out/good.swc"));
  std::filesystem::remove(path("missing.ply"));
  write("missing.xyz", fork_text());
  BOOST_TEST(run("--quiet --input tree.xyz bad.xyz good.xyz --folder out") == 0, err);
  BOOST_TEST(exists("out/good.swc"));

  // The same holds for new results, and for results older than their scan.
  BOOST_TEST(run("--quiet --input good.xyz --folder out --also edges") == 0, err);
  BOOST_TEST(exists("out/good_edges.ply"));
  std::filesystem::last_write_time(path("good.xyz"),
                                   std::filesystem::last_write_time(path("out/good.swc")) +
                                       std::chrono::hours(1));
  const auto before = std::filesystem::last_write_time(path("out/good.swc"));
  BOOST_TEST(run("--quiet --input good.xyz --folder out") == 0, err);
  BOOST_TEST((std::filesystem::last_write_time(path("out/good.swc")) != before));
  BOOST_TEST(run("--quiet --input tree.xyz bad.xyz good.xyz --folder out") == 0, err);
}

BOOST_AUTO_TEST_CASE(a_batch_replaces_what_is_out_of_date)
{
  const std::string batch = "--input tree.xyz --folder out ";
  BOOST_TEST_REQUIRE(run("--quiet " + batch + "--also mesh") == 0, err);
  const std::string swc = content("out/tree.swc"), mesh = content("out/tree_mesh.ply");
  BOOST_TEST(run(batch) == 0, err);
  BOOST_TEST(log().size() == 1u); // all exist
  BOOST_TEST(out.find("1 of 1 scans have a skeleton, 1 of them from previous runs") !=
             std::string::npos);

  // Other options of the mesh and of the tree.
  BOOST_TEST(run(batch + "--also mesh --separate") == 0, err);
  BOOST_TEST(log().size() == 2u);
  BOOST_TEST(content("out/tree_mesh.ply") != mesh);
  BOOST_TEST(run(batch + "--breast-height 1") == 0, err);
  BOOST_TEST_REQUIRE(log().size() == 3u);
  BOOST_TEST(log()[2]["breast_height"] == 1.0);
  BOOST_TEST(!exists("out/tree_mesh.ply"));
  BOOST_TEST(run(batch + "--breast-height 1") == 0, err);
  BOOST_TEST(log().size() == 3u);

  // Stopped between a result and its line.
  write("out/tree.swc", swc + "# of other options\n");
  BOOST_TEST(run(batch + "--breast-height 1") == 0, err);
  BOOST_TEST(log().size() == 4u);
  BOOST_TEST(content("out/tree.swc") == swc);

  // Another scan with the same name.
  std::filesystem::create_directory(path("other"));
  write("other/tree.xyz", "1 2 3\n");
  BOOST_TEST(run("--input other/tree.xyz --folder out") == 1);
  BOOST_TEST(err.find("another folder") != std::string::npos, err);
  BOOST_TEST(content("out/tree.swc") == swc);
  BOOST_TEST(log().size() == 5u);

  // The scan was replaced by an older one, and then by one without a tree.
  const auto now = std::filesystem::last_write_time(path("tree.xyz"));
  write("tree.xyz", fork_text() + "0.1 0 0.2\n");
  std::filesystem::last_write_time(path("tree.xyz"), now - std::chrono::hours(1));
  BOOST_TEST(run(batch + "--breast-height 1") == 0, err);
  BOOST_TEST(log().size() == 6u);
  write("tree.xyz", "1 2 3\n");
  BOOST_TEST(run(batch + "--breast-height 1") == 1);
  BOOST_TEST(!exists("out/tree.swc"));

  // Results are kept if the scan is missing.
  write("tree.xyz", fork_text());
  BOOST_TEST(run(batch) == 0, err);
  std::filesystem::remove(path("tree.xyz"));
  BOOST_TEST(run(batch) == 1);
  BOOST_TEST(content("out/tree.swc") == swc);

  // Invalid lines are skipped.
  write("tree.xyz", fork_text());
  write("out/batch.jsonl",
        "[]\n{\"status\": 3}\n{\"status\": \"converged\", \"input\": \"tree.xyz\"}\n"
        "{\"status\": \"converged\", \"input\": \"tree.xyz\", \"made_from\": {\"file\": \"t\", "
        "\"options\": {}}, \"files\": {\"../tree.xyz\": 5}}\n");
  BOOST_TEST(run(batch) == 0, err);
  BOOST_TEST(exists("tree.xyz"));
}

BOOST_AUTO_TEST_CASE(what_is_not_there_is_no_number)
{
  BOOST_TEST_REQUIRE(run("--input tree.xyz --swc t.swc --breast-height 50 --report r.json") == 0,
                     err);
  BOOST_TEST(Json::parse(content("r.json"))["diameter_at_breast_height"].is_null());
  BOOST_TEST(out.find("none") != std::string::npos, out);
  BOOST_TEST_REQUIRE(run("--input tree.xyz --swc t.swc --breast-height 0.001") == 0, err);
  BOOST_TEST(err.find("--breast-height, which may be in another unit") != std::string::npos, err);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_skeleton_program

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program virtual_scan: consistent output files, and rejection of invalid input.

#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_tree_csv.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <examples/Program_run.h>
#include <set>
#include <string>
#include <vector>

namespace test_virtual_scan {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

namespace {

struct Scan_run : Program_run
{
  Scan_run() : Program_run("virtual_scan") {}
};

const std::string fruit = "--preset fruit --seed 7 --step-degrees 0.2 --output scan.ply ";

Tree truth(const Program_run& program, const std::string& name, std::vector<std::size_t>& hits)
{
  Tree tree;
  pcs::IO::read_tree_csv<Kernel>(program.path(name), tree, hits);
  return tree;
}

std::set<std::size_t> ids(const Tree& tree)
{
  std::set<std::size_t> result;
  for (const auto& branch : tree[boost::graph_bundle].branches)
    result.insert(branch.id);
  return result;
}

void refuses(Program_run& program, const std::string& arguments, const std::string& word)
{
  program.write("scan.ply", "an old file");
  const std::size_t files = program.number_of_files();
  const int code = program.run(arguments);
  BOOST_TEST(code == 1, arguments << ": exit code " << code);
  BOOST_TEST(program.err.find(word) != std::string::npos, word << " in " << program.err);
  const auto lines = std::count(program.err.begin(), program.err.end(), '\n');
  BOOST_TEST((lines == 1 || lines == 2), arguments << ": " << program.err);
  BOOST_TEST(program.out == "");
  BOOST_TEST(program.content("scan.ply") == "an old file");
  BOOST_TEST(program.number_of_files() == files, arguments);
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(virtual_scan, Scan_run)

BOOST_AUTO_TEST_CASE(scan_truth_swc_and_report_agree)
{
  const int code = run(fruit + "--truth truth.csv --swc truth.swc --report report.json");
  BOOST_TEST_REQUIRE(code == 0, err);
  const Table scan = pcs::IO::read_points(path("scan.ply"));
  const auto& node = scan.property<std::int32_t>("node");
  const auto& station = scan.property<std::int32_t>("station");
  std::vector<std::size_t> hits;
  const Tree tree = truth(*this, "truth.csv", hits);
  std::vector<std::size_t> counted(hits.size(), 0);
  for (const std::int32_t label : node)
    if (label >= 0)
      ++counted[std::size_t(label)];
  BOOST_TEST(counted == hits);
  BOOST_TEST(*std::max_element(station.begin(), station.end()) == 3);

  Tree swc;
  pcs::IO::read_swc<Kernel>(path("truth.swc"), swc);
  BOOST_TEST_REQUIRE(num_vertices(swc) == num_vertices(tree));
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    BOOST_TEST((swc[v].point == tree[v].point && swc[v].radius == tree[v].radius));
  report = Json::parse(content("report.json"));
  BOOST_TEST(report["points"].get<std::size_t>() == node.size());
  BOOST_TEST(report["nodes"].get<std::size_t>() == hits.size());
  BOOST_TEST(report["union_volume"].get<double>() < report["volume"].get<double>());
  BOOST_TEST_REQUIRE(report["stations"].size() == 4u);
  for (const Json& p : report["stations"]) {
    const double distance = std::hypot(p[0].get<double>(), p[1].get<double>());
    BOOST_TEST((distance > 1 && distance < 100), p);
  }
  BOOST_TEST(report["stations"][0] != report["stations"][1]);
}

BOOST_AUTO_TEST_CASE(a_seed_reproduces_every_byte)
{
  BOOST_TEST_REQUIRE(run(fruit + "--truth a.csv --quiet") == 0);
  BOOST_TEST(out == "");
  const std::string scan = content("scan.ply"), csv = content("a.csv");
  BOOST_TEST_REQUIRE(run(fruit + "--truth a.csv") == 0);
  BOOST_TEST((content("scan.ply") == scan && content("a.csv") == csv));
  BOOST_TEST_REQUIRE(run(fruit + "--truth a.csv --seed 8") == 1); // given twice
  BOOST_TEST_REQUIRE(
      run("--preset fruit --seed 8 --step-degrees 0.2 --output scan.ply --truth a.csv") == 0);
  BOOST_TEST(content("a.csv") != csv);
}

BOOST_AUTO_TEST_CASE(ages_and_edits_keep_ids)
{
  std::vector<std::size_t> hits;
  BOOST_TEST_REQUIRE(run(fruit + "--truth old.csv") == 0);
  BOOST_TEST_REQUIRE(run(fruit + "--truth young.csv --age 0.7") == 0);
  BOOST_TEST_REQUIRE(
      run(fruit + "--truth edited.csv --prune 3 4 --turn 5 30 6 -20 --lengthen 6 1.4") == 0);
  const auto all = ids(truth(*this, "old.csv", hits));
  const auto young = ids(truth(*this, "young.csv", hits));
  const auto edited = ids(truth(*this, "edited.csv", hits));
  BOOST_TEST(young.size() < all.size());
  BOOST_TEST(std::includes(all.begin(), all.end(), young.begin(), young.end()));
  BOOST_TEST(std::includes(all.begin(), all.end(), edited.begin(), edited.end()));
  BOOST_TEST((edited.count(3) == 0 && edited.count(4) == 0 && edited.count(5) == 1));
}

BOOST_AUTO_TEST_CASE(a_tree_from_a_file_can_be_scanned)
{
  write("stem.swc", "1 0 100 200 0 0.1 -1\n2 0 100 200 2 0.05 1\n");
  BOOST_TEST_REQUIRE(
      run("--tree stem.swc --output scan.xyz --step-degrees 0.2 --ground 2 --post --leaves 5") == 0,
      err);
  const Table scan = pcs::IO::read_points(path("scan.xyz"));
  BOOST_TEST(scan.number_of_points() > 200u);
  BOOST_TEST(scan.points()[0].x() > 90);
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused_and_touches_no_file)
{
  refuses(*this, "--seed 1", "--output");
  refuses(*this, "--output scan.ply --preset oak", "unknown preset 'oak'");
  refuses(*this, "--output scan.ply --step-degrees 0", "--step-degrees");
  refuses(*this, "--output scan.ply --step-degrees abc", "--step-degrees");
  refuses(*this, "--output scan.ply --stations 0", "--stations");
  refuses(*this, "--output scan.ply --age 2", "age");
  refuses(*this, "--output scan.ply --turn 3", "--turn takes pairs");
  refuses(*this, "--output scan.ply --turn 3.5 1", "must be an integer");
  refuses(*this, "--output scan.ply --lengthen 3 0", "factor");
  refuses(*this, "--output scan.ply --prune 999999", "no branch with the id 999999");
  refuses(*this, "--output scan.ply --prune 0", "the trunk cannot be pruned");
  refuses(*this, "--output scan.ply --prune -1", "--prune");
  refuses(*this, "--output scan.ply --leaves 1e18", "more than 1e7 leaves");
  refuses(*this, "--output scan.ply --tree missing.swc", "missing.swc: there is no such file");
  refuses(*this, "--output scan.ply --tree in.ply", "in.ply: line 1");
  write("mm.swc", "1 0 0 0 0 70 -1\n2 0 0 0 3000 20 1\n"); // 10 is inside the trunk
  refuses(*this, "--output scan.ply --tree mm.swc", "station 0 is inside the trunk; `distance`");
  refuses(*this, "--output scan.ply --distance 1e6", "lower --step-degrees or --distance");
  refuses(*this, "--output scan.ply --truth scan.ply", "the same file");
  refuses(*this, "--output scan.ply --truth ./scan.ply", "the same file");
  refuses(*this, "--output a.ply --tree scan.ply --swc scan.ply", "the same file");
  refuses(*this, "--output scan.ply --truth no/a.csv", "there is no such folder");
  refuses(*this, "--output no/scan.ply", "no/scan.ply");
  refuses(*this, "--output scan.off --preset fruit", "scan.off");
  refuses(*this, "--output scan.ply --height -3", "--height");
  refuses(*this, "--output scan.ply --height 0", "--height must be positive");
  refuses(*this, "--output scan.ply --seed 99999999999999999999", "at most 64 bits");
  refuses(*this, "--output scan.ply --seed 1.5", "at most 64 bits");
  refuses(*this, "--output scan.ply --noise nan", "--noise must be a number");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_virtual_scan

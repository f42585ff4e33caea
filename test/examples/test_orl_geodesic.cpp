// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program orl_geodesic: consistent output files, and rejection of invalid input.

#include <pcs/IO/read_swc.h>
#include <pcs/IO/write_swc.h>
#include <pcs/core/rotations.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/tree_at_age.h>
#include <support/orl_trees.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <csignal>
#include <cstddef>
#include <examples/Program_run.h>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <utility>
#include <vector>

namespace test_orl_geodesic {

namespace {

struct Two_trees : Program_run
{
  Two_trees() : Program_run("orl_geodesic")
  {
    using namespace orl_test;
    const orl_test::Tree a = random_tree(61, 4, 2), b = random_tree(62, 4, 2);
    pcs::IO::write_swc(path("a.swc"), a);
    pcs::IO::write_swc(path("b.swc"), b);
    pcs::IO::write_points(path("a.ply"), tube_points(a, 2000, 1));
    pcs::IO::write_points(path("b.ply"), tube_points(b, 3000, 2));
  }
  const std::string trees = "--tree a.ply --skeleton a.swc --tree b.ply --skeleton b.swc ";

  void succeeds(const std::string& arguments)
  {
    const int code = run(arguments);
    BOOST_TEST_REQUIRE(code == 0, arguments << ": exit code " << code << ": " << err);
  }
  void refuses(const std::string& arguments, const std::string& word)
  {
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    const auto lines = std::count(err.begin(), err.end(), '\n');
    BOOST_TEST((lines == 1 || lines == 2), arguments << ": " << err);
    BOOST_TEST(out == "");
  }
  std::size_t number_in(const std::string& name) const
  {
    return exists(name) ? static_cast<std::size_t>(
                              std::distance(std::filesystem::directory_iterator(folder / name), {}))
                        : 0;
  }
  orl_test::Tree swc(const std::string& name) const
  {
    orl_test::Tree tree;
    pcs::IO::read_swc<orl_test::Kernel>(path(name), tree);
    return tree;
  }
};

const std::string txtskl = "2\nLayer 0\n1\n-1 -1\n3\n0 0 0 0.1\n0 1 0 0.1\n0 2 0 0.05\n"
                           "Layer 1\n1\n0 1\n2\n0 1 0 0.05\n1 1.5 0 0.02\n";

} // namespace

BOOST_FIXTURE_TEST_SUITE(orl_geodesic, Two_trees)

BOOST_AUTO_TEST_CASE(axes_are_drawn_out_to_the_points_on_request)
{
  const auto length = [](const orl_test::Tree& tree) {
    double sum = 0;
    for (const auto e : boost::make_iterator_range(edges(tree)))
      sum += std::sqrt(CGAL::squared_distance(tree[source(e, tree)].point, //
                                              tree[target(e, tree)].point));
    return sum;
  };
  orl_test::Tree tree = swc("a.swc");
  const double whole = length(tree);
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (out_degree(v, tree) == 0) {
      const auto& from = tree[pcs::parent_node<orl_test::Kernel>(v, tree)].point;
      tree[v].point = from + 0.3 * (tree[v].point - from);
    }
  pcs::IO::write_swc(path("short.swc"), tree);
  pcs::IO::write_points(path("dense.ply"), orl_test::tube_points(swc("a.swc"), 20000, 1));
  const std::string of_short =
      "--tree dense.ply --skeleton short.swc --tree b.ply --skeleton b.swc ";
  succeeds(of_short + "--lambda 0 --output plain");
  succeeds(of_short + "--lambda 0 --output long --extend-axes");
  const double missing = whole - length(swc("plain/lambda_0.000.swc"));
  BOOST_TEST(missing > 0.03 * whole);
  BOOST_TEST(std::abs(whole - length(swc("long/lambda_0.000.swc"))) < 0.4 * missing);
}

BOOST_AUTO_TEST_CASE(one_tree_of_a_skeleton_file_is_used)
{
  // A copy of the first tree between two smaller ones.
  const std::string forest = "900001 0 5 0 0 0.1 -1\n900002 0 5 0 1 0.1 900001\n" +
                             content("a.swc") + "900003 0 9 0 0 0.1 -1\n";
  write("forest.swc", forest);
  const auto pair = [](const std::string& first) {
    return "--skeleton " + first + " --skeleton b.swc --lambda 0.5 --output " + first + ".out ";
  };
  succeeds(pair("a.swc"));
  succeeds(pair("forest.swc"));
  BOOST_TEST(err.find("warning: forest.swc: the file has 3 trees: 3 of ") != std::string::npos,
             err);
  BOOST_TEST(content("a.swc.out/lambda_0.500.swc") == content("forest.swc.out/lambda_0.500.swc"));
  succeeds(pair("forest.swc") + "--quiet");
  BOOST_TEST(err == "");
  // b.swc has a single tree, so the number refers to the other file; or each file has a number.
  write("stick.swc", "1 0 5 0 0 0.1 -1\n2 0 5 0 1 0.1 1\n");
  succeeds(pair("stick.swc"));
  for (const std::string numbers : {"--root-number 2", "--root-number 2,1"}) {
    succeeds(pair("forest.swc") + numbers);
    BOOST_TEST(content("stick.swc.out/lambda_0.500.swc") ==
               content("forest.swc.out/lambda_0.500.swc"));
  }
  refuses(pair("forest.swc") + "--root-number 4", "there is no tree 4");
  write("cylinders.txt", "0.1\t1\t0\t0\t0\t0\t0\t1\t0\t0\t1\t0\t1\t0\t0.1\n");
  refuses(pair("cylinders.txt"), "needs the names of its columns");
  refuses(pair("forest.swc") + "--root-number 1,2", "there is no tree 2: the file has 1 tree");
  refuses(pair("forest.swc") + "--root-number 0", "--root-number");
  refuses(pair("forest.swc") + "--root-number 1,1,1", "has 3 numbers for 2 skeletons");
  refuses("--tree a.ply --tree b.ply --output o --root-number 1", "without --skeleton");
  refuses(pair("a.swc") + "--root-number 2", "no file of --skeleton has more than one tree");
}

BOOST_AUTO_TEST_CASE(every_place_on_the_path_has_points_and_a_skeleton)
{
  succeeds(trees + "--lambda 0,0.25,1.5,-0.5 --output out --matches m.csv --report r.json");
  for (const std::string place : {"0.000", "0.250", "1.500", "-0.500"}) {
    BOOST_TEST(pcs::IO::read_points(path("out/lambda_" + place + ".ply")).number_of_points() > 0u);
    BOOST_TEST(num_vertices(swc("out/lambda_" + place + ".swc")) > 2u);
  }
  BOOST_TEST(number_in("out") == 8u);

  // Ids of tips in the skeleton files.
  std::istringstream lines(content("m.csv"));
  std::string line;
  std::getline(lines, line);
  BOOST_TEST(line == "tip_a,tip_b,confidence");
  const orl_test::Tree a = swc("a.swc"), b = swc("b.swc");
  std::size_t both = 0, single = 0;
  while (std::getline(lines, line)) {
    const auto comma = line.find(',');
    const long tip_a = std::stol(line.substr(0, comma)), tip_b = std::stol(line.substr(comma + 1));
    BOOST_TEST((tip_a > 0 || tip_b > 0));
    const std::pair<long, const orl_test::Tree*> tips[] = {{tip_a, &a}, {tip_b, &b}};
    for (const auto& [tip, tree] : tips)
      if (tip != -1) {
        BOOST_TEST_REQUIRE((tip >= 1 && static_cast<std::size_t>(tip) <= num_vertices(*tree)));
        BOOST_TEST(out_degree(static_cast<std::size_t>(tip) - 1, *tree) == 0u);
      }
    ++(tip_a > 0 && tip_b > 0 ? both : single);
    const std::string confidence = line.substr(line.rfind(',') + 1);
    BOOST_TEST(confidence.empty() == (tip_a < 0 || tip_b < 0));
    if (!confidence.empty())
      BOOST_TEST((std::stod(confidence) >= 0 && std::stod(confidence) <= 1));
  }
  const Json r = Json::parse(content("r.json"));
  BOOST_TEST(r["number_of_matched_branches"].get<std::size_t>() == both);
  BOOST_TEST(r["number_of_branches"][0].get<std::size_t>() +
                 r["number_of_branches"][1].get<std::size_t>() ==
             2 * both + single);
  BOOST_TEST(r["number_of_points"][0].get<std::size_t>() == 2000u);
  BOOST_TEST(r["marginal_violation"]["worst"].get<double>() < 1e-9);
  for (const std::string kind : {"sum", "square", "cone"})
    BOOST_TEST(r["distance"][kind].get<double>() > 0);
  for (const std::string stage :
       {"matching", "topology", "assignment", "transport", "instances", "correspondences"})
    BOOST_TEST(r["seconds"][stage].get<double>() >= 0);
}

BOOST_AUTO_TEST_CASE(values_that_are_no_numbers_have_no_part_in_the_points_between)
{
  using Table = pcs::IO::Point_table;
  const auto with_values = [&](const std::string& name, float value, double label) {
    Table table = pcs::IO::read_points(path(name + ".ply"));
    const std::size_t n = table.number_of_points();
    table.add_property("value", std::vector<float>(n, value));
    table.add_property("label", std::vector<double>(n, label));
    pcs::IO::write_points(path(name + "_values.ply"), table);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  with_values("a", 3, 1e300);
  with_values("b", nan, 1e300);
  succeeds("--tree a_values.ply --skeleton a.swc --tree b_values.ply --skeleton b.swc --lambda "
           "0,0.5 --output out");
  for (const std::string place : {"0.000", "0.500"}) {
    const Table points = pcs::IO::read_points(path("out/lambda_" + place + ".ply"));
    std::size_t from_first = 0;
    for (const double v : points.property_as_double("value")) {
      BOOST_TEST((v == 3 || std::isnan(v))); // for points of the second scan only
      from_first += v == 3 ? 1 : 0;
    }
    BOOST_TEST(from_first >= 2000u);
    for (const double v : points.property_as_double("label"))
      BOOST_TEST(v == 1e300, boost::test_tools::tolerance(1e-12));
  }
}

BOOST_AUTO_TEST_CASE(properties_have_a_type_that_holds_the_values_of_both)
{
  using Table = pcs::IO::Point_table;
  const auto with_values = [&](const std::string& name, auto intensity, auto time, auto label) {
    Table table = pcs::IO::read_points(path(name + ".ply"));
    const std::size_t n = table.number_of_points();
    table.add_property("intensity", std::vector<decltype(intensity)>(n, intensity));
    table.add_property("time", std::vector<decltype(time)>(n, time));
    table.add_property("label", std::vector<decltype(label)>(n, label));
    pcs::IO::write_points(path(name + "_values.ply"), table);
  };
  with_values("a", std::uint8_t(200), 0.f, std::int8_t(-3));
  with_values("b", std::uint16_t(1000), 1234567890.123, std::uint8_t(200));
  succeeds("--tree a_values.ply --skeleton a.swc --tree b_values.ply --skeleton b.swc --lambda "
           "0,1 --output out");
  using Type = pcs::IO::Scalar_type;
  for (const bool is_second : {false, true}) {
    const Table points =
        pcs::IO::read_points(path(is_second ? "out/lambda_1.000.ply" : "out/lambda_0.000.ply"));
    BOOST_TEST((points.property_type("intensity") == Type::uint16));
    BOOST_TEST((points.property_type("time") == Type::float64));
    BOOST_TEST((points.property_type("label") == Type::int16));
    const auto has = [&](const std::string& name, double value) {
      const std::vector<double> values = points.property_as_double(name);
      return std::count(values.begin(), values.end(), value);
    };
    BOOST_TEST(has("intensity", is_second ? 1000 : 200) >= 2000);
    BOOST_TEST(has("time", is_second ? 1234567890.123 : 0) >= 2000);
    BOOST_TEST(has("label", is_second ? 200 : -3) >= 2000);
  }
}

BOOST_AUTO_TEST_CASE(skeletons_alone_give_skeletons_alone)
{
  write("a.txtskl", txtskl);
  succeeds("--skeleton a.txtskl --skeleton b.swc --output out --quiet");
  BOOST_TEST(number_in("out") == 5u);
  BOOST_TEST(exists("out/lambda_0.500.swc"));
  BOOST_TEST(out == "");
}

BOOST_AUTO_TEST_CASE(skeletons_may_be_tables)
{
  // A byte order mark, columns in another order, ids that differ from row numbers.
  write("a.CSV",
        "\xEF\xBB\xBF"
        "parent,id,branch,order,x,y,z,r,a,b\n-1,7,0,0,0,0,0,0.2,0.2,0.2\n"
        "7,9,0,0,0,0,1,0.2,0.2,0.2\n9,20,0,0,0,0,2,0.1,0.1,0.1\n9,30,1,1,1,0,1.5,0.1,0.1,0.1\n");
  write("a.txtskl", txtskl);
  succeeds("--skeleton a.CSV --skeleton a.txtskl --up y --output out --lambda 0 --matches m.csv");
  BOOST_TEST(num_vertices(swc("out/lambda_0.000.swc")) >= 4u);
  const std::string matches = content("m.csv");
  BOOST_TEST(matches.find("\n20,") != std::string::npos);
  BOOST_TEST(matches.find("\n30,") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(points_in_other_coordinates_than_the_skeleton_are_refused)
{
  std::vector<orl_test::Point> far = pcs::IO::read_points(path("a.ply")).points(), some = far;
  for (auto& p : far)
    p = p + orl_test::Kernel::Vector_3(5e6, 0, 0);
  pcs::IO::write_points(path("far.ply"), far);
  refuses("--tree far.ply --skeleton a.swc --tree b.ply --skeleton b.swc --output out",
          "same coordinates");
  BOOST_TEST(err.find("far.ply") != std::string::npos);
  BOOST_TEST(!exists("out"));
  // Outliers do not count.
  std::copy(far.begin(), far.begin() + 500, some.begin());
  pcs::IO::write_points(path("some.ply"), some);
  succeeds("--tree some.ply --skeleton a.swc --tree b.ply --skeleton b.swc --output out");
}

BOOST_AUTO_TEST_CASE(skeletons_are_extracted_where_none_are_given)
{
  for (const double x : {0.8, 1.2}) { // a trunk with a branch to each side
    std::vector<orl_test::Branch> branches(3);
    for (int k = 0; k <= 8; ++k)
      branches[0].points.push_back(orl_test::Vec3(0, 0, 0.5 * k));
    for (const int side : {1, 2}) {
      branches[static_cast<std::size_t>(side)].parent = 0;
      branches[static_cast<std::size_t>(side)].at = static_cast<std::size_t>(2 + 2 * side);
      for (int k = 0; k <= 6; ++k)
        branches[static_cast<std::size_t>(side)].points.push_back(
            0.25 * k * orl_test::Vec3(side == 1 ? x : -x, 0, 1));
    }
    for (auto& b : branches)
      b.radii.assign(b.points.size(), b.parent == pcs::npos ? 0.15 : 0.08);
    pcs::IO::write_points(path(x < 1 ? "one.ply" : "two.ply"),
                          orl_test::tube_points(orl_test::make_tree(branches), 20000, 1));
  }
  succeeds("--tree one.ply --tree two.ply --lambda 0,0.5 --output out --matches m.csv "
           "--report r.json");
  BOOST_TEST(number_in("out") == 4u);
  const Json r = Json::parse(content("r.json"));
  for (const std::size_t t : {0u, 1u}) {
    BOOST_TEST(r["number_of_branches"][t].get<std::size_t>() >= 3u);
    BOOST_TEST(r["number_of_points"][t].get<std::size_t>() == 20000u);
  }
  BOOST_TEST(r["number_of_matched_branches"].get<std::size_t>() >= 3u);
  pcs::IO::write_points(path("few.ply"), std::vector<orl_test::Point>(3, orl_test::Point(1, 2, 3)));
  refuses("--tree one.ply --tree few.ply --output three", "few.ply");
  BOOST_TEST(number_in("three") == 0u);
}

BOOST_AUTO_TEST_CASE(a_normal_that_is_zero_is_named)
{
  const auto write_normals = [&](const std::string& name, std::size_t zero) {
    const auto points = orl_test::tube_points(swc(name + ".swc"), 2000, 1);
    std::string text = "ply\nformat ascii 1.0\nelement vertex 2000\n";
    for (const std::string column : {"x", "y", "z", "nx", "ny", "nz"})
      text += "property double " + column + '\n';
    std::ostringstream rows;
    for (std::size_t i = 0; i < points.size(); ++i)
      rows << points[i] << " 0 0 " << (i == zero ? 0 : 1) << '\n';
    write(name + ".ply", text + "end_header\n" + rows.str());
  };
  write_normals("a", pcs::npos);
  write_normals("b", pcs::npos);
  succeeds(trees + "--lambda 0.5 --output all");
  const std::string of_scans = content("all/lambda_0.500.ply");
  BOOST_TEST(of_scans.find("nx") != std::string::npos);
  BOOST_TEST(err == "");
  succeeds(trees + "--lambda 0.5 --normals scans --output all");
  BOOST_TEST(content("all/lambda_0.500.ply") == of_scans);
  succeeds(trees + "--lambda 0.5 --normals across --output across");
  const std::string across = content("across/lambda_0.500.ply");
  BOOST_TEST(across.find("nx") != std::string::npos);
  BOOST_TEST(across != of_scans);
  write_normals("b", 7);
  succeeds(trees + "--lambda 0.5 --normals scans --output none");
  BOOST_TEST(content("none/lambda_0.500.ply").find("nx") == std::string::npos);
  BOOST_TEST(err.find("b.ply: 1 of 2000 normals are zero") != std::string::npos, err);
  BOOST_TEST(err.find("so no normals are written") != std::string::npos, err);
  succeeds(trees + "--lambda 0.5 --output some");
  BOOST_TEST(content("some/lambda_0.500.ply").find("nx") != std::string::npos);
  BOOST_TEST(err.find("are orthogonal to the branches") != std::string::npos, err);
  succeeds(trees + "--lambda 0.5 --normals across --output across");
  BOOST_TEST(content("some/lambda_0.500.ply") == content("across/lambda_0.500.ply"));
  BOOST_TEST(err == "");
}

BOOST_AUTO_TEST_CASE(scans_without_normals_give_normals)
{
  const auto text = [&](const std::string& name) { return content(name + "/lambda_0.500.ply"); };
  succeeds(trees + "--lambda 0.5 --output all");
  succeeds(trees + "--lambda 0.5 --normals across --output across");
  succeeds(trees + "--lambda 0.5 --normals scans --output none");
  BOOST_TEST(text("all").find("nx") != std::string::npos);
  BOOST_TEST(text("all") == text("across"));
  BOOST_TEST(text("none").find("nx") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(stored_matches_keep_their_confidence)
{
  const std::string stored = trees + "--lambda 0.5 --correspondences c.txt ";
  succeeds(stored + "--matches one.csv --output one");
  succeeds(stored + "--matches two.csv --output two");
  BOOST_TEST(content("one.csv") == content("two.csv"));
}

BOOST_AUTO_TEST_CASE(options_change_the_result)
{
  succeeds(trees + "--lambda 0.5 --output plain");
  const std::string plain = content("plain/lambda_0.500.ply");
  for (const std::string option : {"--transport sinkhorn",
                                   "--orientation world-axes",
                                   "--point-assignment by-normal",
                                   "--point-weights equal",
                                   "--transport-cost distance",
                                   "--reach inf",
                                   "--point-path virtual-edges",
                                   "--normals scans"}) {
    succeeds(trees + "--lambda 0.5 --output other " + option);
    BOOST_TEST(content("other/lambda_0.500.ply") != plain, option);
  }
  const std::string regularised = "--transport sinkhorn --sinkhorn-epsilon ";
  succeeds(trees + "--lambda 0.5 --output other " + regularised + "0.02");
  succeeds(trees + "--lambda 0.5 --output wide " + regularised + "0.5");
  BOOST_TEST(content("other/lambda_0.500.ply") != content("wide/lambda_0.500.ply"));
  succeeds(trees + "--lambda 1.5 --output plain");
  succeeds(trees + "--lambda 1.5 --output other --extrapolation linear");
  BOOST_TEST(content("other/lambda_1.500.swc") != content("plain/lambda_1.500.swc"));
  succeeds(trees + "--lambda 1.5 --output plain --max-extrapolation-degrees 90");
  succeeds(trees + "--lambda 1.5 --output other --max-extrapolation-degrees 0 --limit-radii");
  BOOST_TEST(content("other/lambda_1.500.ply") != content("plain/lambda_1.500.ply"));
  // A trunk that supports all branches.
  auto branches = orl_test::random_branches(61, 4, 2);
  branches.resize(1);
  pcs::IO::write_swc(path("trunk.swc"), orl_test::make_tree(branches));
  const std::string grown = "--skeleton trunk.swc --skeleton a.swc --lambda 0.5 ";
  succeeds(grown + "--output plain");
  succeeds(grown + "--output other --virtual-direction along-parent");
  BOOST_TEST(content("other/lambda_0.500.swc") != content("plain/lambda_0.500.swc"));
  succeeds(grown + "--output other --sequential-emergence");
  BOOST_TEST(content("other/lambda_0.500.swc") != content("plain/lambda_0.500.swc"));
  succeeds(grown + "--output other --simultaneous-emergence");
  BOOST_TEST(content("other/lambda_0.500.swc") == content("plain/lambda_0.500.swc"));
  refuses(grown + "--output other --simultaneous-emergence --sequential-emergence", "excludes");
  succeeds(trees + "--lambda 0.5 --output other --published-energy --orientation transported");
}

BOOST_AUTO_TEST_CASE(the_published_distance_ignores_the_position)
{
  orl_test::Tree moved = orl_test::random_tree(61, 4, 2);
  for (std::size_t v = 0; v < num_vertices(moved); ++v)
    moved[v].point = moved[v].point + orl_test::Kernel::Vector_3(1, 0, 0);
  pcs::IO::write_swc(path("moved.swc"), moved);
  const std::string pair = "--skeleton a.swc --skeleton moved.swc --output out --distances d.csv ";
  const auto distance = [&] { return std::stod(content("d.csv").substr(2)); }; // 0,d
  succeeds(pair);
  BOOST_TEST(std::abs(distance() - 1) < 1e-6);
  succeeds(pair + "--metric published --report r.json");
  BOOST_TEST(distance() < 1e-6);
  BOOST_TEST(Json::parse(content("r.json"))["distance"]["published"].get<double>() == distance());
}

BOOST_AUTO_TEST_CASE(a_limit_of_the_size_of_files_is_an_error)
{
  rlimit before;
  BOOST_TEST_REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const rlimit few{8192, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &few);
  const auto ignore = std::signal(SIGXFSZ, SIG_DFL);
  const int code = run(trees + "--lambda 0.5 --output limited --report limited.json --quiet");
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, ignore);
  BOOST_TEST(code == 1);
  BOOST_TEST(err.find("limited/lambda_0.500.ply: cannot be written") != std::string::npos, err);
  BOOST_TEST(number_in("limited") == 1u); // the skeleton, which is smaller
  BOOST_TEST(exists("limited/lambda_0.500.swc"));
  BOOST_TEST(!exists("limited.json"));
}

BOOST_AUTO_TEST_CASE(branches_of_trees_that_grew_at_their_tips_are_born_in_order)
{
  orl_test::Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(3));
  pcs::IO::write_swc(path("old.swc"), tree);
  pcs::IO::write_swc(path("young.swc"), pcs::tree_at_age<orl_test::Kernel>(tree, 0.5));
  const std::string grown =
      "--skeleton young.swc --skeleton old.swc --lambda 0.5 --correspondences grown.txt --output ";
  for (const std::string run : {"first", "again"}) { // as computed, and as stored
    succeeds(grown + run);
    succeeds(grown + run + "_in_order --sequential-emergence");
    succeeds(grown + run + "_together --simultaneous-emergence");
    const std::string name = "/lambda_0.500.swc";
    BOOST_TEST(content(run + name) == content(run + "_in_order" + name));
    BOOST_TEST(content(run + name) != content(run + "_together" + name));
  }
}

BOOST_AUTO_TEST_CASE(a_tree_that_stands_turned_is_found)
{
  const orl_test::Tree a = swc("a.swc");
  for (const bool is_y_up : {false, true}) {
    const orl_test::Vec3 up = is_y_up ? orl_test::Vec3::UnitY() : orl_test::Vec3::UnitZ();
    const Eigen::Matrix3d upright =
        pcs::rotation_between(orl_test::Vec3::UnitZ(), up).toRotationMatrix();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(CGAL_PI / 2, up).toRotationMatrix();
    pcs::IO::write_swc(path("one.swc"), orl_test::moved(a, upright, {0, 0, 0}));
    pcs::IO::write_swc(path("two.swc"), orl_test::moved(a, turn * upright, {0, 0, 0}));
    const std::string both = "--skeleton one.swc --skeleton two.swc --lambda 1 --report r.json ";
    const auto degrees = [&](const std::string& arguments) {
      succeeds(both + arguments);
      return Json::parse(content("r.json"))["yaw_degrees"].get<double>();
    };
    const std::string up_option = is_y_up ? " --up y" : "";
    BOOST_TEST(std::abs(degrees("--output turned" + up_option) + 90) < 1e-3);
    BOOST_TEST(degrees("--output still --align none") == 0);
    BOOST_TEST(num_vertices(swc("turned/lambda_1.000.swc")) >= num_vertices(a));
  }
  refuses("--skeleton one.swc --skeleton two.swc --output out --align sideways", "--align");
  refuses("--skeleton one.swc --skeleton two.swc --output out --up w", "--up");
  refuses("--skeleton one.swc --skeleton two.swc --output out --align none --up x",
          "--up has no effect on skeletons");
  refuses("--skeleton one.swc --skeleton two.swc --skeleton a.swc --output out --mean --up x",
          "--up has no effect on skeletons");
}

BOOST_AUTO_TEST_CASE(other_units_and_origins_are_reported)
{
  const orl_test::Tree a = swc("a.swc");
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  pcs::IO::write_swc(path("mm.swc"), orl_test::moved(a, same, {0, 0, 0}, 1000));
  pcs::IO::write_swc(path("map.swc"), orl_test::moved(a, same, {5e5, 5e6, 0}));
  const auto warning = [&](const std::string& other) {
    succeeds("--skeleton a.swc --skeleton " + other + " --lambda 0.5 --output places");
    return err;
  };
  BOOST_TEST(warning("mm.swc").find("a.swc and mm.swc: the extents are") != std::string::npos, err);
  BOOST_TEST(warning("map.swc").find("a.swc and map.swc: the roots are") != std::string::npos, err);
  BOOST_TEST(warning("b.swc").find("check the") == std::string::npos, err);
}

BOOST_AUTO_TEST_CASE(correspondences_are_kept)
{
  succeeds(trees + "--lambda 0.3 --output one --correspondences c.txt --report fresh.json");
  const std::string kept = content("c.txt");
  BOOST_TEST(!kept.empty());
  succeeds(trees + "--lambda 0.3 --output two --correspondences c.txt");
  BOOST_TEST(content("one/lambda_0.300.ply") == content("two/lambda_0.300.ply"));
  BOOST_TEST(content("c.txt") == kept);
  // A stored matching has no matching report, and needs no matching options.
  succeeds(trees + "--output two --correspondences c.txt --report stored.json");
  const Json stored = Json::parse(content("stored.json"));
  BOOST_TEST(!stored.contains("matching_energy"));
  BOOST_TEST(stored["number_of_points"] == Json::parse(content("fresh.json"))["number_of_points"]);
  BOOST_TEST(stored["distance"] == Json::parse(content("fresh.json"))["distance"]);
  // The same options are accepted again, other options are not.
  succeeds(trees + "--lambda 0.3 --output two --correspondences c.txt --align yaw --up z "
                   "--transport exact --reach 2 --point-weights area");
  BOOST_TEST(content("one/lambda_0.300.ply") == content("two/lambda_0.300.ply"));
  for (const std::string option : {"--published-energy",
                                   "--transport sinkhorn",
                                   "--point-assignment by-normal",
                                   "--reach 3",
                                   "--align none",
                                   "--up y"})
    refuses(trees + "--output three --correspondences c.txt " + option, "than " + option);
  BOOST_TEST(err.find("c.txt") != std::string::npos);
  succeeds(trees + "--output two --correspondences d.txt --align none --published-energy");
  succeeds(trees + "--output two --correspondences d.txt --published-energy");
  // Points may be omitted or have other properties, but must not be different.
  succeeds("--skeleton a.swc --skeleton b.swc --lambda 0.3 --output bare --correspondences c.txt");
  BOOST_TEST(content("one/lambda_0.300.swc") == content("bare/lambda_0.300.swc"));
  BOOST_TEST(number_in("bare") == 1u);
  pcs::IO::Point_table table = pcs::IO::read_points(path("a.ply"));
  table.add_property("value", std::vector<float>(table.number_of_points(), 1));
  pcs::IO::write_points(path("value.ply"), table);
  succeeds("--tree value.ply --skeleton a.swc --tree b.ply --skeleton b.swc --lambda 0.3 "
           "--output two --correspondences c.txt");
  BOOST_TEST((pcs::IO::read_points(path("one/lambda_0.300.ply")).points() ==
              pcs::IO::read_points(path("two/lambda_0.300.ply")).points()));
  refuses("--tree b.ply --skeleton a.swc --tree b.ply --skeleton b.swc --output three "
          "--correspondences c.txt",
          "other points");
  refuses("--tree a.ply --tree b.ply --output three --extend-axes", "without --skeleton");
  refuses("--tree b.ply --skeleton b.swc --tree a.ply --skeleton a.swc --output three "
          "--correspondences c.txt",
          "other trees");
  // A truncated file, or a modified one.
  for (std::size_t k = 1; k < 20; ++k) {
    write("c.txt", kept.substr(0, kept.size() * k / 20));
    BOOST_TEST(run(trees + "--output three --correspondences c.txt") == 1);
    std::string changed = kept;
    changed[kept.size() * k / 20] = 'x';
    write("c.txt", changed);
    BOOST_TEST(run(trees + "--output three --correspondences c.txt") == 1);
  }
  BOOST_TEST(number_in("three") == 0u);
}

BOOST_AUTO_TEST_CASE(results_that_cannot_be_written_are_found_before_the_work)
{
  // The trees are not read: the second is not a skeleton.
  const std::string no_trees = "--skeleton a.swc --skeleton b.ply --output ";
  write("file", "old");
  refuses(no_trees + "file", "file: is a file, expected a folder");
  refuses(no_trees + "file/out", "file/out: cannot be made a folder: Not a directory");
  refuses(no_trees + "''", "--output has an empty value");
  refuses(no_trees + "/proc", "/proc: no files can be written in this folder");
  std::filesystem::create_directories(folder / "taken" / "lambda_0.500.swc");
  refuses(no_trees + "taken", "lambda_0.500.swc: is a directory, expected a file name");
  for (const std::string option :
       {"--matches", "--report", "--changes", "--distances", "--save-space", "--correspondences"}) {
    const std::string of_file = no_trees + "new/out " + option;
    refuses(of_file + " missing/x",
            "missing/x: cannot be opened for writing: No such file or directory");
    refuses(of_file + " ''", option + " has an empty value");
    if (option != "--correspondences") // a folder is read in this case
      refuses(of_file + " taken", "taken: is a directory, expected a file name");
  }
  refuses(no_trees + "out --mean --report out/mean.swc", "out/mean.swc is named twice");
  refuses(no_trees + "out --matches - --report -", "name a file for one of them");
  refuses("--skeleton a.swc --skeleton '' --output out", "--skeleton has an empty value");
  refuses("--tree a.ply --tree '' --output out", "--tree has an empty value");
  BOOST_TEST(!exists("new"));
  BOOST_TEST(!exists("out"));
  BOOST_TEST(content("file") == "old");
  succeeds("--skeleton a.swc --skeleton b.swc --output new/out --report new/out/r.json");
  BOOST_TEST(number_in("new/out") == 6u);
}

BOOST_AUTO_TEST_CASE(all_files_are_read_before_skeletons_are_extracted)
{
  write("no_tree.xyz", "0 0 0\n"); // cannot be extracted
  refuses("--tree no_tree.xyz --tree missing.ply --output out", "missing.ply");
  write("c.txt", "no correspondences");
  refuses("--tree no_tree.xyz --tree no_tree.xyz --correspondences c.txt --output out", "c.txt");
  BOOST_TEST(!exists("out"));
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused_with_a_sentence)
{
  refuses("--output out", "--skeleton");
  refuses(trees, "--output");
  refuses("--skeleton a.swc --output out", "expected at least 2");
  refuses(trees + "--skeleton a.swc --output out", "expected as many");
  refuses("--skeleton a.swc --skeleton missing.swc --output out", "missing.swc");
  refuses("--skeleton a.swc --skeleton a.ply --output out", "a.ply");
  refuses(trees + "--lambda nan --output out", "lambda");
  for (const std::string list : {"0,x", "0,,1", "0,1,", ",0", "'0;1'", "''", "0.5.5", "1e"})
    refuses(trees + "--lambda " + list + " --output out", "separated by commas");
  refuses(trees + "--lambda 0.5,0.5001 --output out", "lambda_0.500");
  refuses(trees + "--transport fast --output out", "transport");
  refuses(trees + "--sinkhorn-epsilon 0.1 --output out", "without --transport sinkhorn");
  refuses(trees + "--metric published --output out", "without --distances");
  refuses(trees + "--reach nan --output out", "--reach must be a number, found nan");
  refuses(trees + "--reach 0 --output out", "--reach: Value 0 not in range");
  refuses(trees + "--max-extrapolation-degrees nan --output out",
          "--max-extrapolation-degrees must be a number, found nan");
  refuses(trees + trees + "--mean --point-path virtual-edges --output out", "--point-path");
  refuses("--skeleton a.swc --skeleton b.swc --normals across --output out", "without points");
  refuses(trees + "--distances d.csv --normals across --output out", "--normals has no effect");
  refuses(trees + "--distances d.csv --point-path virtual-edges --output out", "--point-path has");
  write("file", "");
  refuses(trees + "--output file", "file");
  refuses(trees + "--output out --report missing/r.json", "missing/r.json");
  const std::string before = content("a.swc");
  for (const std::string option : {"--report", "--matches", "--changes", "--save-space"})
    refuses("--skeleton a.swc --skeleton b.swc --output out " + option + " ./a.swc",
            "the same file");
  refuses("--skeleton a.swc --skeleton b.swc --output out --report r.json --matches r.json",
          "the same file");
  write("lambda_0.500.swc", before);
  refuses("--skeleton lambda_0.500.swc --skeleton b.swc --output . --lambda 0.5", "the same file");
  write("mean.swc", before);
  refuses("--skeleton mean.swc --skeleton b.swc --output . --mean", "mean.swc");
  BOOST_TEST(content("a.swc") == before);
  for (std::size_t k = 1; k < 10; ++k) {
    write("cut.txtskl", txtskl.substr(0, txtskl.size() * k / 10));
    BOOST_TEST(run("--skeleton cut.txtskl --skeleton b.swc --output out") == 1);
  }
  write("one.swc", "1 1 0 0 0 1 -1\n");
  refuses("--skeleton a.swc --skeleton one.swc --output out", "one.swc");
  write("far.swc", "1 1 0 0 0 1 -1\n2 1 0 0 1e200 1 1\n");
  refuses("--skeleton far.swc --skeleton a.swc --output out", "far.swc");
  write("thick.swc", "1 1 0 0 0 1 -1\n2 1 0 0 1 1e200 1\n");
  refuses("--skeleton thick.swc --skeleton a.swc --output out", "radius of node 1");
  write("far.xyz", "0 0 0\n0 0 1e300\n");
  for (const std::string more : {"", "--extend-axes "})
    refuses("--tree far.xyz --skeleton a.swc --tree b.ply --skeleton b.swc --output out " + more,
            "point 1");
  write("same.swc", "1 1 1 1 1 1 -1\n2 1 1 1 1 1 1\n3 1 1 1 1 1 2\n");
  refuses("--skeleton same.swc --skeleton a.swc --output out", "same.swc");
  write("cycle.swc", "1 1 0 0 0 1 2\n2 1 0 0 1 1 1\n");
  BOOST_TEST(run("--skeleton cycle.swc --skeleton b.swc --output out") == 1);
  BOOST_TEST(number_in("out") == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_geodesic

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program write_gallery: data in the page are those of the files, and invalid input is
// rejected.

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>

#include <boost/test/unit_test.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <examples/Program_run.h>
#include <limits>
#include <string>
#include <vector>

namespace test_gallery_program {

namespace {

std::vector<unsigned char> bytes_of_base64(const std::string& text)
{
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  std::uint32_t bits = 0;
  int number_of_bits = 0;
  for (const char c : text) {
    if (c == '=')
      break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    number_of_bits += 6;
    if (number_of_bits >= 8) {
      number_of_bits -= 8;
      bytes.push_back(static_cast<unsigned char>(bits >> number_of_bits & 255));
    }
  }
  return bytes;
}

struct Gallery_run : Program_run
{
  Gallery_run() : Program_run("write_gallery") {}

  std::string arguments(const std::string& views) const
  {
    return "--page '" PCS_TEST_PAGE "' --output page.html " + views;
  }
  void refuses(const std::string& views, const std::string& word)
  {
    const int code = run(arguments(views));
    BOOST_TEST(code == 1, views << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    BOOST_TEST(!exists("page.html"));
  }

  /// The text of an element of the page.
  std::string element(const std::string& page, const std::string& id) const
  {
    const std::string mark = "id=\"" + id + "\">";
    const std::size_t at = page.find(mark);
    BOOST_TEST_REQUIRE(at != std::string::npos, id);
    const std::size_t begin = at + mark.size();
    return page.substr(begin, page.find("</script>", begin) - begin);
  }
  std::vector<unsigned char> array(const std::string& page, const Json& description) const
  {
    return bytes_of_base64(
        element(page, "array" + std::to_string(description["array"].get<int>())));
  }
  /// The largest difference of points in the page and points of a table.
  double difference(const std::string& page, const Json& description, const Table& table) const
  {
    const auto bytes = array(page, description);
    BOOST_TEST_REQUIRE(bytes.size() == 6 * table.number_of_points());
    double most = 0;
    for (std::size_t i = 0; i < 3 * table.number_of_points(); ++i) {
      const double number = bytes[2 * i] + 256.0 * bytes[2 * i + 1];
      const double value =
          description["offset"][i % 3].get<double>() + description["scale"].get<double>() * number;
      most = std::max(most, std::abs(value - table.points()[i / 3][int(i % 3)]));
    }
    return most;
  }
};

const std::string cylinder_names =
    "sx,sy,sz,ax,ay,az,length,radius,parent,branch,order,radius_error,is_measured\n";

} // namespace

BOOST_FIXTURE_TEST_SUITE(gallery_program, Gallery_run)

BOOST_AUTO_TEST_CASE(points_in_the_page_are_those_of_the_files)
{
  Table moved = input;
  for (auto& p : moved.points())
    p = Table::Point_3(p.x() + 2, 2 * p.y(), p.z());
  pcs::IO::write_points(path("moved.ply"), moved);
  write("edit.json",
        R"({"handles": [{"select": {"property": "</script>", "equals": 1}, "fixed": true}]})");
  write("editor.js", "var an_editor;");
  BOOST_TEST_REQUIRE(run(arguments("--rest in.ply --deformed moved.ply --edit edit.json "
                                   "--model-up y --editor editor.js")) == 0,
                     err);
  BOOST_TEST(err.find("1 views") != std::string::npos, err);
  const std::string page = content("page.html");
  BOOST_TEST(page.find("{{") == std::string::npos); // all marks of the template are replaced
  BOOST_TEST(page.find("var an_editor;") != std::string::npos);
  const Json views = Json::parse(element(page, "views"));
  BOOST_TEST_REQUIRE(views.size() == 1u);
  BOOST_TEST(views[0]["up"] == "y");
  const Json& select = views[0]["edit"]["handles"][0]["select"];
  BOOST_TEST(select["property"] == "</script>"); // did not end the element
  BOOST_TEST(difference(page, views[0]["rest"], input) < 200 / 65535.);
  BOOST_TEST(difference(page, views[0]["deformed"], moved) < 200 / 65535.);
}

BOOST_AUTO_TEST_CASE(large_models_are_thinned_in_the_same_way_at_rest_and_deformed)
{
  Table moved = input;
  for (auto& p : moved.points())
    p = Table::Point_3(p.x(), p.y(), p.z() + 1);
  pcs::IO::write_points(path("moved.ply"), moved);
  BOOST_TEST_REQUIRE(run(arguments("--rest in.ply --deformed moved.ply --model-points 1000")) == 0,
                     err);
  const std::string page = content("page.html");
  const Json view = Json::parse(element(page, "views"))[0];
  BOOST_TEST(view["number_in_file"].get<std::size_t>() == input.number_of_points());
  const auto rest = array(page, view["rest"]), deformed = array(page, view["deformed"]);
  BOOST_TEST_REQUIRE(rest.size() == 6 * 1000u);
  const double scale = view["rest"]["scale"];
  for (std::size_t i = 0; i < 3000; ++i) {
    const double step =
        deformed[2 * i] + 256.0 * deformed[2 * i + 1] - (rest[2 * i] + 256.0 * rest[2 * i + 1]);
    BOOST_TEST_REQUIRE(std::abs(step * scale - (i % 3 == 2 ? 1 : 0)) < 2 * scale);
  }
}

BOOST_AUTO_TEST_CASE(points_have_the_nearest_cylinder_of_their_branch)
{
  std::vector<Table::Point_3> points = {{0.1, 0, 0.5}, {0.1, 0, 1.5}, {0.1, 0, 1.5}, {5, 5, 5}};
  Table scan(points);
  scan.add_property("branch", std::vector<std::int32_t>{0, 0, 1, -1});
  pcs::IO::write_points(path("scan.ply"), scan);
  write("c.csv",
        cylinder_names + "0,0,0,0,0,1,1,0.1,0,1,0,0.01,1\n0,0,1,0,0,1,1,0.1,1,1,0,0.02,1\n"
                         "0,0,1.5,1,0,0,1,0.05,2,2,1,0,0\n"
                         "0,0,9,1,0,0,1,0.05,2,1000000000,1,0,0\n");
  BOOST_TEST_REQUIRE(run(arguments("--scan scan.ply --cylinders c.csv")) == 0, err);
  const std::string page = content("page.html");
  const Json view = Json::parse(element(page, "views"))[0];
  const auto of_point = array(page, view["cylinder_of_point"]);
  BOOST_TEST((of_point == std::vector<unsigned char>{0, 0, 1, 0, 2, 0, 4, 0}));
  BOOST_TEST((array(page, view["cylinders"]["order"]) == std::vector<unsigned char>{0, 0, 1, 1}));
  const auto errors = array(page, view["cylinders"]["radius_error"]);
  float second = 0;
  std::memcpy(&second, errors.data() + 4, 4);
  BOOST_TEST(second == 0.02f);
}

BOOST_AUTO_TEST_CASE(a_tree_below_breast_height_and_line_ends_of_windows_are_accepted)
{
  Table scan(std::vector<Table::Point_3>{{0, 0, 0}});
  scan.add_property("branch", std::vector<std::int32_t>{0});
  pcs::IO::write_points(path("scan.ply"), scan);
  std::string table = cylinder_names + "0,0,0,0,0,1,1,0.1,0,1,0,0.01,1\n";
  for (std::size_t at = 0; (at = table.find('\n', at)) != std::string::npos; at += 2)
    table.insert(at, "\r");
  write("c.csv", "\xEF\xBB\xBF" + table);
  write("r.json",
        R"({"total": {"branches": 1, "length": 1, "volume": 0.1}, "by_order": [], "height": 1,)"
        R"( "volume": 0.1,)"
        R"( "diameter_at_breast_height": null, "name": "</script><!--<script>"})");
  BOOST_TEST_REQUIRE(run(arguments("--scan scan.ply --cylinders c.csv --scan-report r.json")) == 0,
                     err);
  const Json view = Json::parse(element(content("page.html"), "views"))[0];
  BOOST_TEST(view["report"]["height"] == 1);
  BOOST_TEST(view["report"]["name"] == "</script><!--<script>");
  BOOST_TEST(content("page.html").find("<!--<script>") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(invalid_input_is_refused)
{
  refuses("--rest missing.ply --deformed in.ply", "missing.ply");
  refuses("--rest in.ply", "--deformed");
  write("few.xyz", "1 2 3\n");
  refuses("--rest in.ply --deformed few.xyz", "has 1 points");
  refuses("--scan in.ply --cylinders c.csv", "no property `branch`");
  refuses("--stand in.ply", "no property `tree`");
  Table scan(std::vector<Table::Point_3>{{0, 0, 0}});
  scan.add_property("branch", std::vector<std::int32_t>{0});
  pcs::IO::write_points(path("scan.ply"), scan);
  refuses("--scan scan.ply --cylinders c.csv", "c.csv");
  write("c.csv", "sx,sy\n");
  refuses("--scan scan.ply --cylinders c.csv", "no column `sz`");
  write("c.csv", cylinder_names + "0,0,0,0,0,1,1,-0.1,0,1,0,0.01,1\n");
  refuses("--scan scan.ply --cylinders c.csv", "line 2: expected a radius of 0 or more");
  write("c.csv", cylinder_names + "0,0,0,0,0,1e308,1e308,0.1,0,1,0,0.01,1\n");
  refuses("--scan scan.ply --cylinders c.csv", "line 2: expected a radius of 0 or more, and coor");
  for (const double tree : {0.5, 1e18, std::numeric_limits<double>::quiet_NaN()}) {
    Table stand(std::vector<Table::Point_3>{{0, 0, 0}, {0, 0, 1}});
    stand.add_property("tree", std::vector<double>{-1, tree});
    pcs::IO::write_points(path("labels.ply"), stand);
    refuses("--stand labels.ply", "labels.ply: point 1: expected a whole number");
  }
  write("c.csv", cylinder_names + "0,0,0,0,0,1,1,0.1,0,1,0,0.01,1\n0,0,x\n");
  refuses("--scan scan.ply --cylinders c.csv", "line 3: expected a number, found 'x'");
  write("c.csv", cylinder_names + "0,0,0,0,0,1,1,0.1,0,0,0,0.01,1\n");
  refuses("--scan scan.ply --cylinders c.csv", "line 2: expected a branch from 1");
  write("c.csv", cylinder_names + "0,0,0,0,0,1,1,0.1,0,1,0,0.01,1\n");
  const std::string with_report = "--scan scan.ply --cylinders c.csv --scan-report r.json";
  write("r.json", "[]");
  refuses(with_report, "r.json: top level: the key total is missing");
  write("r.json", R"({"total": {"branches": 1, "length": "2", "volume": 3}})");
  refuses(with_report, "r.json: /total/length: expected a number, found \"2\"");
  scan.add_property("tree", std::vector<std::int32_t>{0});
  pcs::IO::write_points(path("stand.ply"), scan);
  write("r.json", R"({"trees": [{"tree": 0, "height": null}]})");
  refuses("--stand stand.ply --stand-report r.json", "r.json: /trees/0/height: expected a number");
  refuses("--morph .", "lambda_");
  refuses("--family .", "scores_");
  refuses("--family missing", "missing");
  write("edit.json", "{");
  refuses("--rest in.ply --deformed in.ply --edit edit.json", "not valid JSON");
  refuses("--rest in.ply --deformed in.ply --edit .", "cannot be read");
  write("edit.json", R"({"handles": [{"select": {"box": [0, 1]}}]})");
  refuses("--rest in.ply --deformed in.ply --edit edit.json", "/handles/0/select/box/0: expected");
  write("empty.js", "");
  refuses("--rest in.ply --deformed in.ply --editor empty.js", "empty.js: the file is empty");
  refuses("", "the page would be empty");
  BOOST_TEST(run("--page . --output in.ply --rest in.ply --deformed in.ply") == 1);
  BOOST_TEST(err.find("a result would destroy it") != std::string::npos, err);
  BOOST_TEST(run("--page . --output page.html --rest in.ply --deformed in.ply") == 1);
  BOOST_TEST(err.find("index.html") != std::string::npos, err);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_gallery_program

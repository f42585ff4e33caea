// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program deform_point_set with valid input: motions, selections, files, reports.

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <examples/Program_run.h>
#include <limits>
#include <string>
#include <vector>

namespace test_program {

namespace {

using Vec3 = Eigen::Vector3d;

Vec3 position(const Table& table, std::size_t i)
{
  const auto& p = table.points()[i];
  return {p.x(), p.y(), p.z()};
}

Vec3 normal(const Table& table, std::size_t i)
{
  return {double(table.property<float>("nx")[i]),
          double(table.property<float>("ny")[i]),
          double(table.property<float>("nz")[i])};
}

const std::string warning_of_far_points =
    "deform_point_set: warning: in.ply: 100 points in 1 part(s) are not connected to any handle "
    "and "
    "stay unchanged; more --neighbors connect parts that touch\n";

/// Points whose tenth of the height is `status`.
std::vector<std::size_t> with_status(const Table& table, int status)
{
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < table.number_of_points(); ++i)
    if (table.property<std::uint8_t>("status")[i] == status)
      result.push_back(i);
  return result;
}

Vec3 centroid(const Table& table, const std::vector<std::size_t>& indices)
{
  Vec3 sum = Vec3::Zero();
  for (const std::size_t i : indices)
    sum += position(table, i);
  return sum / double(indices.size());
}

/// Largest distance of the points from their positions under `motion`.
template <class Motion>
double error_of(const Table& before,
                const Table& after,
                const std::vector<std::size_t>& indices,
                const Motion& motion)
{
  BOOST_TEST_REQUIRE(!indices.empty());
  double error = 0;
  for (const std::size_t i : indices)
    error = std::max(error, (position(after, i) - motion(position(before, i))).norm());
  return error;
}

double
largest_motion(const Table& before, const Table& after, const std::vector<std::size_t>& indices)
{
  return error_of(before, after, indices, [](const Vec3& p) { return p; });
}

Eigen::Matrix3d turn(const Vec3& axis, double degrees)
{
  return Eigen::AngleAxisd(degrees * std::acos(-1.0) / 180, axis.normalized()).toRotationMatrix();
}

const Json fixed_foot = parse(R"({"select": {"property": "status", "equals": 0}, "fixed": true})");
constexpr double rounding = 1e-9; // coordinates of 1e3 in double precision, with a margin

/// Number of points of the last handle in the report, for the selection `select`.
std::size_t selected(Deform_run& program, const std::string& select)
{
  program.deform(edit_of({{{"select", parse(select)}, {"fixed", true}}}));
  return program.report["points_of_handles"].back().get<std::size_t>();
}

} // namespace

BOOST_AUTO_TEST_SUITE(motions)

BOOST_FIXTURE_TEST_CASE(every_selector_and_every_motion_reaches_its_target, Deform_run)
{
  const Table result = deform(parse(R"({"handles": [
    {"select": {"box": [[990, -30, 6.7], [1010, -10, 0]]}, "fixed": true},
    {"select": {"sphere": {"center": [1000.1, -20.3, 15.7], "radius": 1.5}},
     "rotate": {"axis": [0, 2, 1], "degrees": 50, "center": [1001, -20, 12]},
"translate": [0.5, 1, -0.25],
     "scale": 1.25},
    {"select": {"property": "status", "equals": 5},
"matrix": [0, -1, 0, 980, 1, 0, 0, -1020, 0, 0, 1, 0.5,
                                                               0, 0, 0, 1]},
    {"select": {"indices": [700, 701, 702, 703, 703, 700]}, "translate": [0, 0.25, 0]}]})"));
  std::vector<std::size_t> box, sphere;
  for (std::size_t i = 0; i < number_of_pillar_points; ++i) {
    const Vec3 p = position(input, i);
    if (p.z() <= 6.7)
      box.push_back(i);
    if ((p - Vec3(1000.1, -20.3, 15.7)).norm() <= 1.5)
      sphere.push_back(i);
  }
  BOOST_TEST(report["points_of_handles"] == Json({box.size(), sphere.size(), 200, 4}));
  for (const std::size_t i : box)
    BOOST_TEST(result.points()[i] == input.points()[i]);
  const Vec3 c(1001, -20, 12), t(0.5, 1, -0.25);
  const Eigen::Matrix3d r = turn({0, 2, 1}, 50);
  BOOST_TEST(error_of(input, result, sphere, [&](const Vec3& p) -> Vec3 {
               return r * (1.25 * (p - c)) + c + t;
             }) < rounding);
  for (const std::size_t i : sphere)
    BOOST_TEST((normal(result, i) - r * normal(input, i)).norm() < 1e-6); // float
  BOOST_TEST(error_of(input, result, with_status(input, 5), [](const Vec3& p) {
               return Vec3(-p.y() + 980, p.x() - 1020, p.z() + 0.5);
             }) < rounding);
  BOOST_TEST(error_of(input, result, {700, 701, 702, 703}, [](const Vec3& p) {
               return Vec3(p + Vec3(0, 0.25, 0));
             }) < rounding);
  BOOST_TEST(largest_motion(input, result, with_status(input, 3)) > 0.01); // the others follow
}

BOOST_FIXTURE_TEST_CASE(targets_are_reached_in_the_order_of_the_indices, Deform_run)
{
  const std::vector<std::size_t> points = {1990, 1950, 1999, 1970, 1980};
  Json targets = Json::array();
  for (const std::size_t i : points) {
    const Vec3 p = position(input, i);
    targets.push_back({p.x() + .25 * double(i % 7), p.y() - .5, p.z() + 1});
  }
  Json handle = {{"select", {{"indices", points}}}, {"targets", targets}};
  const Table result = deform(edit_of({fixed_foot, handle}));
  for (std::size_t k = 0; k < points.size(); ++k)
    for (int c = 0; c < 3; ++c)
      BOOST_TEST(position(result, points[k])[c] == targets[k][std::size_t(c)].get<double>());
  BOOST_TEST(largest_motion(input, result, with_status(input, 8)) > .1);
  handle["softness"] = 1;
  BOOST_TEST(largest_motion(result, deform(edit_of({fixed_foot, handle})), points) > 1e-4);
}

BOOST_FIXTURE_TEST_CASE(center_defaults_to_the_centroid, Deform_run)
{
  const std::vector<std::size_t> head = with_status(input, 9);
  const Vec3 c = centroid(input, head);
  Json handle = parse(R"({"select": {"property": "status", "equals": 9},
                          "rotate": {"axis": [1, 0, 0], "degrees": 30}, "scale": 0.5})");
  const Eigen::Matrix3d r = turn({1, 0, 0}, 30);
  BOOST_TEST(error_of(input, deform(edit_of({fixed_foot, handle})), head, [&](const Vec3& p) {
               return Vec3(c + 0.5 * r * (p - c));
             }) < rounding);
  handle.erase("rotate");
  BOOST_TEST(error_of(input, deform(edit_of({fixed_foot, handle})), head, [&](const Vec3& p) {
               return Vec3(c + 0.5 * (p - c));
             }) < rounding);
}

BOOST_FIXTURE_TEST_CASE(two_full_turns_twist_what_lies_between, Deform_run)
{
  const Table result =
      deform(edit_of({fixed_foot, parse(R"({"select": {"property": "status", "equals": 9},
    "rotate": {"axis": [0, 0, 1], "degrees": 720}})")}));
  BOOST_TEST(largest_motion(input, result, with_status(input, 9)) < rounding);
  // A quarter of the rotation is half a turn, which moves a point to the other side.
  BOOST_TEST(largest_motion(input, result, with_status(input, 3)) > 1.5);
}

BOOST_FIXTURE_TEST_CASE(a_soft_handle_stays_behind_a_hard_one, Deform_run)
{
  Json head = parse(R"({"select": {"property": "status", "equals": 9}, "translate": [2, 0, 0]})");
  const Vec3 before = centroid(input, with_status(input, 9));
  double reached[2];
  for (int k = 0; k < 2; ++k) {
    head["softness"] = 200 * k;
    reached[k] =
        (centroid(deform(edit_of({fixed_foot, head})), with_status(input, 9)) - before).norm();
  }
  BOOST_TEST(reached[0] > 2 - rounding);
  BOOST_TEST(reached[1] < 1.99);
}

BOOST_FIXTURE_TEST_CASE(fixed_and_unreached_points_keep_every_bit, Deform_run)
{
  const Table result =
      deform(edit_of({fixed_foot, parse(R"({"select": {"property": "status", "equals": 9},
    "translate": [3, 0, 1]})")}));
  for (const int status : {0, 10})
    for (const std::size_t i : with_status(input, status)) {
      BOOST_TEST(result.points()[i] == input.points()[i]);
      BOOST_TEST(normal(result, i) == normal(input, i));
    }
  BOOST_TEST(report["unreached_points"] == number_of_far_points);
  BOOST_TEST(report["unreached_components"] == 1);
  BOOST_TEST(err == warning_of_far_points);
}

BOOST_FIXTURE_TEST_CASE(the_default_edit_holds_the_foot_and_turns_the_head, Deform_run)
{
  Table pillar(std::vector<Table::Point_3>(input.points().begin(),
                                           input.points().begin() + number_of_pillar_points));
  pillar.points().emplace_back(0, 0, -1e4); // an outlier must not determine the foot
  pcs::IO::write_points(path("pillar.xyz"), pillar);
  BOOST_TEST_REQUIRE(
      run("--input pillar.xyz --default-edit --output out.xyz --report report.json") == 0);
  const Table result = pcs::IO::read_points(path("out.xyz"));
  const std::size_t foot = 300, middle = 1000, head = 1990;
  BOOST_TEST(result.points()[foot] == pillar.points()[foot]);
  BOOST_TEST((position(result, middle) - position(pillar, middle)).norm() > 0.1);
  const Vec3 moved = position(result, head) - position(pillar, head);
  BOOST_TEST(std::abs(moved.z()) < rounding);
  BOOST_TEST(std::hypot(moved.x(), moved.y()) > 0.2);
  report = Json::parse(content("report.json"));
  BOOST_TEST(report["edit"] == "default edit");
  BOOST_TEST(std::abs(report["points_of_handles"][0].get<double>() / 2000 - 0.2) < 0.02);
  BOOST_TEST(std::abs(report["points_of_handles"][1].get<double>() / 2000 - 0.15) < 0.02);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(selections)

BOOST_FIXTURE_TEST_CASE(bounds_are_inclusive_and_corners_come_in_any_order, Deform_run)
{
  std::vector<Table::Point_3> grid;
  for (int i = 0; i < 1000; ++i)
    grid.emplace_back(i % 10, i / 10 % 10, i / 100);
  pcs::IO::write_points(path("in.ply"), Table(grid));
  BOOST_TEST(selected(*this, R"({"box": [[2, 3, 4], [4, 5, 6]]})") == 27);
  BOOST_TEST(selected(*this, R"({"box": [[4, 3, 6], [2, 5, 4]]})") == 27);
  BOOST_TEST(selected(*this, R"({"sphere": {"center": [5, 5, 5], "radius": 1}})") == 7);
  BOOST_TEST(selected(*this, R"({"sphere": {"center": [5, 5, 5], "radius": 1e308}})") == 1000);
  BOOST_TEST(selected(*this, R"({"box": [[-1e308, -1e308, -1e308], [1e308, 1e308, 1e308]]})") ==
             1000);
}

BOOST_FIXTURE_TEST_CASE(properties_are_compared_in_their_own_type, Deform_run)
{
  BOOST_TEST(selected(*this, R"({"property": "status", "equals": 2})") == 200);
  BOOST_TEST(selected(*this, R"({"property": "status", "equals": 2.0})") == 200);
  BOOST_TEST(selected(*this, R"({"property": "tenth", "equals": 0.3})") == 200); // 0.3: not a float
  BOOST_TEST(selected(*this, R"({"property": "signed_id", "equals": -7})") == 1);
  // Adjacent 64-bit integers that are equal as doubles.
  BOOST_TEST(selected(*this, R"({"property": "large", "equals": 9223372036854775800})") == 1);
  BOOST_TEST(selected(*this, R"({"property": "time", "equals": 1000000000})") == 1);
  for (const char* none : {R"("status", "equals": 2.5)",
                           R"("status", "equals": -1)",
                           R"("signed_id", "equals": 18446744073709551615)",
                           R"("tenth", "equals": 1e300)",
                           R"("large", "equals": -1)"}) {
    write("edit.json",
          edit_of(
              {{{"select", parse(std::string(R"({"property": )") + none + "}")}, {"fixed", true}}})
              .dump());
    BOOST_TEST(run("--input in.ply --edit edit.json --output out.ply") == 1, none);
    BOOST_TEST(err.find("/handles/0/select: selects none of the 2100 points") != std::string::npos,
               err);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(files)

BOOST_FIXTURE_TEST_CASE(order_and_properties_are_kept_with_their_types, Deform_run)
{
  const Table result =
      deform(edit_of({fixed_foot, parse(R"({"select": {"property": "status", "equals": 9},
    "rotate": {"axis": [1, 0, 0], "degrees": 90}})")}));
  BOOST_TEST_REQUIRE(result.number_of_points() == input.number_of_points());
  BOOST_TEST((result.schema().properties == input.schema().properties));
  for (const char* name : {"status", "tenth", "signed_id", "large", "time"})
    BOOST_TEST((result.property_values(name) == input.property_values(name)), name);
  BOOST_TEST(number_of_files() == 4); // in, edit, out, report: no temporary files
}

BOOST_FIXTURE_TEST_CASE(the_output_may_be_the_input, Deform_run)
{
  write("edit.json",
        edit_of({fixed_foot, parse(R"({"select": {"indices": [1999]}, "translate": [1, 0, 0]})")})
            .dump());
  BOOST_TEST(run("--input in.ply --edit edit.json --output in.ply") == 0, err);
  const Table result = pcs::IO::read_points(path("in.ply"));
  BOOST_TEST((position(result, 1999) - position(input, 1999) - Vec3(1, 0, 0)).norm() < rounding);
}

BOOST_FIXTURE_TEST_CASE(every_format_is_read_and_written, Deform_run)
{
  write("edit.json",
        R"({"handles": [{"select": {"indices": [0, 1]}, "fixed": true},
                        {"select": {"indices": [1999]}, "translate": [1, 0, 0]}]})");
  pcs::IO::write_points(path("in.off"), input.points()); // OFF has no properties
  std::string last = "in.ply";
  for (const std::string next : {"1.csv", "2.txt", "3.las", "4.ply"}) {
    BOOST_TEST_REQUIRE(run("--input " + last + " --edit edit.json --output " + next) == 0, err);
    last = next;
  }
  const Table result = pcs::IO::read_points(path("4.ply"));
  BOOST_TEST((position(result, 1999) - position(input, 1999) - Vec3(4, 0, 0)).norm() <
             1e-3); // the coordinate step of LAS
  BOOST_TEST(result.has_property("status"));
  BOOST_TEST_REQUIRE(run("--input in.off --edit edit.json --output out.off") == 0, err);
  BOOST_TEST(pcs::IO::read_points(path("out.off")).points()[0] == input.points()[0]);
}

BOOST_FIXTURE_TEST_CASE(normals_keep_integer_types_and_zeros, Deform_run)
{
  std::vector<std::int8_t> components[3];
  for (std::size_t i = 0; i < input.number_of_points(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      components[axis].push_back(i % 2 ? std::int8_t(std::lround(127 * normal(input, i)[axis]))
                                       : std::int8_t(0));
  input.replace_property("nx", components[0]);
  input.replace_property("ny", components[1]);
  input.replace_property("nz", components[2]);
  pcs::IO::write_points(path("in.ply"), input);
  const Table result =
      deform(edit_of({fixed_foot, parse(R"({"select": {"property": "status", "equals": 9},
    "rotate": {"axis": [0, 0, 1], "degrees": 90}})")}));
  for (const std::size_t i : with_status(input, 9)) {
    BOOST_TEST(result.property<std::int8_t>("nx")[i] == -components[1][i]);
    BOOST_TEST(result.property<std::int8_t>("ny")[i] == components[0][i]);
  }
  for (std::size_t i = 0; i < number_of_pillar_points; i += 2)
    BOOST_TEST(result.property<std::int8_t>("nx")[i] == 0);
}

BOOST_FIXTURE_TEST_CASE(an_invalid_normal_leaves_all_normals_and_warns, Deform_run)
{
  input.property<float>("ny")[17] = std::numeric_limits<float>::infinity();
  pcs::IO::write_points(path("in.ply"), input);
  const Table result =
      deform(edit_of({fixed_foot, parse(R"({"select": {"property": "status", "equals": 9},
    "rotate": {"axis": [1, 0, 0], "degrees": 90}})")}));
  for (const char* name : {"nx", "ny", "nz"})
    BOOST_TEST((result.property_values(name) == input.property_values(name)), name);
  BOOST_TEST(largest_motion(input, result, with_status(input, 9)) > 0.1);
  BOOST_TEST(err.find("the normal of point 17 is not finite") != std::string::npos, err);
  BOOST_TEST(std::count(err.begin(), err.end(), '\n') == 2); // also of points without a handle
  BOOST_TEST(report["normals"] == "unchanged");
  BOOST_TEST(report["warnings"].size() == 2);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(reports)

BOOST_FIXTURE_TEST_CASE(normals_with_other_names_are_left_with_a_warning, Deform_run)
{
  const Json edit =
      edit_of({parse(R"({"select": {"property": "status", "equals": 0}, "fixed": true})"),
               parse(R"({"select": {"property": "status", "equals": 9},
                                       "translate": [1, 0, 0]})")});
  deform(edit);
  BOOST_TEST(err.find("are left as they are") == std::string::npos, err);
  Table other(input.points());
  other.add_property("status", input.property<std::uint8_t>("status"));
  other.add_property("normal_x", input.property<float>("nx"));
  other.add_property("ny", input.property<float>("ny"));
  pcs::IO::write_points(path("in.ply"), other);
  for (const char* more : {"", "--stream"}) {
    deform(edit, more);
    BOOST_TEST(report["normals"] == "none");
    BOOST_TEST(err.find("the properties normal_x, ny are left as they are") != std::string::npos,
               err);
  }
}

BOOST_FIXTURE_TEST_CASE(the_report_has_every_number, Deform_run)
{
  deform(edit_of(
             {fixed_foot,
              parse(R"({"select": {"property": "status", "equals": 9}, "translate": [1, 0, 0]})")}),
         "--samples 300 --neighbors 8");
  for (const char* key : {"duplicates",
                          "components",
                          "interior_links",
                          "iterations",
                          "initial_energy",
                          "energy",
                          "peak_memory_MB"})
    BOOST_TEST(report[key].is_number(), key << " is " << report[key]);
  for (const char* stage : {"read",
                            "neighbors",
                            "sampling",
                            "factorization",
                            "solving",
                            "coarse_levels",
                            "upsampling",
                            "write",
                            "total"})
    BOOST_TEST((report["seconds"][stage].is_number() && report["seconds"][stage] >= 0), stage);
  BOOST_TEST(report["program"] == "deform_point_set");
  BOOST_TEST(report["version"].is_string());
  BOOST_TEST(report["input"] == "in.ply");
  BOOST_TEST(report["output"] == "out.ply");
  BOOST_TEST(report["edit"] == "edit.json");
  BOOST_TEST((report["status"] == "converged" || report["status"] == "iteration_limit"));
  BOOST_TEST(report["points"] == input.number_of_points());
  BOOST_TEST(report["neighbors"] == 8);
  BOOST_TEST(std::abs(report["samples"].get<int>() - 300) < 60);
  BOOST_TEST(report["normals"] == "deformed");
  BOOST_TEST(report["warnings"].size() == 1); // of points without a handle
  BOOST_TEST(report["energy"] <= report["initial_energy"]);
}

BOOST_FIXTURE_TEST_CASE(the_summary_names_counts_and_files_and_quiet_prints_nothing, Deform_run)
{
  deform(edit_of({fixed_foot}));
  for (const char* word : {"points      2100",
                           "samples",
                           "iterations",
                           "status",
                           "read ",
                           "write ",
                           "out.ply",
                           "report.json"})
    BOOST_TEST(out.find(word) != std::string::npos, word << " is missing in\n" << out);
  BOOST_TEST(err == warning_of_far_points); // no progress without a terminal
  deform(edit_of({fixed_foot}), "--quiet");
  BOOST_TEST(out == "");
  BOOST_TEST(err == warning_of_far_points);
}

BOOST_FIXTURE_TEST_CASE(names_that_are_not_utf8_do_not_break_the_report, Deform_run)
{
  write("edit.json", edit_of({fixed_foot}).dump());
  BOOST_TEST(run("--input in.ply --edit edit.json --output \"$(printf 'a\\377.ply')\" --report "
                 "report.json") == 0,
             err);
  BOOST_TEST(Json::accept(content("report.json")));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_program

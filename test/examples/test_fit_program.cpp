// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program fit_point_set: fitted points and their properties, filled holes, landmarks, and
// rejection of invalid input.

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <examples/Program_run.h>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace test_fit_program {

namespace {

/// The pillar of `Program_run` without the lump as the source, and a shifted pillar with a hole as
/// the target.
struct Fit_run : Program_run
{
  std::size_t number_in_hole = 0;

  Fit_run() : Program_run("fit_point_set")
  {
    std::vector<std::size_t> pillar(number_of_pillar_points);
    for (std::size_t i = 0; i < pillar.size(); ++i)
      pillar[i] = i;
    source = input.select(pillar);
    pcs::IO::write_points(path("source.ply"), source);
    std::vector<Table::Point_3> points;
    for (std::size_t i = 0; i < 3000; ++i) {
      const double angle = 2.399963229728653 * double(i) + 1, height = 10 * double(i) / 3000;
      if (std::cos(angle) > 0.3 && height > 3 && height < 6)
        ++number_in_hole;
      else
        points.emplace_back(1000.4 + std::cos(angle), -20.4 + std::sin(angle), 5.7 + height);
    }
    pcs::IO::write_points(path("target.ply"), Table(points));
  }

  Table source;
};

const std::string files = "--source source.ply --target target.ply --output out.ply ";

void refuses(Fit_run& program, const std::string& arguments, const std::string& word)
{
  program.write("out.ply", "an old file");
  const int code = program.run(arguments);
  BOOST_TEST(code == 1, arguments << ": exit code " << code);
  BOOST_TEST(program.err.find(word) != std::string::npos, word << " in " << program.err);
  BOOST_TEST(program.content("out.ply") == "an old file");
}

/// Returns an OFF file with a triangle of the first three points.
std::string mesh_of(const std::vector<Table::Point_3>& points)
{
  std::ostringstream text;
  text.precision(17);
  text << "OFF\n" << points.size() << " 1 0\n";
  for (const auto& p : points)
    text << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  text << "3 0 1 2\n";
  return text.str();
}

} // namespace

BOOST_AUTO_TEST_SUITE(fit_program)

BOOST_AUTO_TEST_CASE(points_move_properties_stay_and_holes_are_filled)
{
  Fit_run program;
  const int code = program.run(files + "--filled filled.ply --report report.json");
  BOOST_TEST_REQUIRE(code == 0, program.err);
  const Table out = pcs::IO::read_points(program.path("out.ply"));
  BOOST_TEST_REQUIRE(out.number_of_points() == number_of_pillar_points);
  double distance = 0; // from the axis of the target, less the radius
  for (const auto& p : out.points())
    distance += std::abs(std::hypot(p.x() - 1000.4, p.y() + 20.4) - 1);
  BOOST_TEST(distance / double(number_of_pillar_points) < 0.02);
  BOOST_TEST((out.property<double>("time") == program.source.property<double>("time")));
  const Table filled = pcs::IO::read_points(program.path("filled.ply"));
  const double expected = double(program.number_in_hole) * 2 / 3;
  BOOST_TEST(std::abs(double(filled.number_of_points()) - expected) < 0.5 * expected);
  const Json report = Json::parse(program.content("report.json"));
  BOOST_TEST(report["plausible"] == true);
  BOOST_TEST(report["matched_points"] == number_of_pillar_points - filled.number_of_points());
}

BOOST_AUTO_TEST_CASE(the_report_can_be_written_to_standard_output)
{
  Fit_run program;
  BOOST_TEST_REQUIRE(program.run(files + "--report -") == 0, program.err);
  BOOST_TEST(Json::parse(program.out)["program"] == "fit_point_set"); // and nothing else
  BOOST_TEST(program.err.find("converged") != std::string::npos);     // the summary
  BOOST_TEST(!program.exists("-"));
}

BOOST_AUTO_TEST_CASE(a_target_without_holes_fills_nothing)
{
  Fit_run program;
  const std::string same = "--source target.ply --target target.ply --output out.ply --filled ";
  BOOST_TEST_REQUIRE(program.run(same + "filled.glb") == 0, program.err);
  BOOST_TEST(program.err.find("filled.glb: is not written") != std::string::npos, program.err);
  BOOST_TEST(program.exists("out.ply"));
  BOOST_TEST(!program.exists("filled.glb"));
  BOOST_TEST_REQUIRE(program.run(same + "filled.ply") == 0, program.err);
  BOOST_TEST(pcs::IO::read_points(program.path("filled.ply")).number_of_points() == 0u);
}

BOOST_AUTO_TEST_CASE(landmarks_are_read_from_json_and_from_a_table)
{
  Fit_run program;
  program.write("a.json", R"([{"point": 5, "target": [1001.1, -20.3, 5.8]}])");
  program.write("a.csv", "point,x,y,z\n5,1001.1,-20.3,5.8\n");
  BOOST_TEST(program.run(files + "--landmarks a.json") == 0, program.err);
  const std::string from_json = program.content("out.ply");
  BOOST_TEST(program.run(files + "--landmarks a.csv") == 0, program.err);
  BOOST_TEST((program.content("out.ply") == from_json));
  program.write("a.csv", "point, x, y, z\n# the foot\n5, 1001.1, -20.3, 5.8\n");
  BOOST_TEST(program.run(files + "--landmarks a.csv") == 0, program.err);
  BOOST_TEST((program.content("out.ply") == from_json));
  BOOST_TEST(program.run(files) == 0, program.err);
  BOOST_TEST((program.content("out.ply") != from_json));
}

BOOST_AUTO_TEST_CASE(invalid_input_is_refused_and_writes_nothing)
{
  Fit_run program;
  refuses(program, "--source missing.ply --target target.ply --output out.ply", "missing.ply");
  refuses(program, files + "--filled target.ply", "same file");
  refuses(program, files + "--stiffness 0", "stiffness is 0");
  refuses(program, files + "--samples -3", "number_of_samples is -3");
  program.write("bad.csv", "1,2,3,4\n1,2,x,4\n");
  refuses(program, files + "--landmarks bad.csv", "line 2");
  program.write("bad.csv", "1;2;3;4\n");
  refuses(program, files + "--landmarks bad.csv", "separated by commas, found 1;2;3;4");
  program.write("bad.json", R"([{"point": -1, "target": [1, 2, 3]}])");
  refuses(program, files + "--landmarks bad.json", "/0/point");
  program.write("far.csv", "99999,1,2,3\n");
  refuses(program, files + "--landmarks far.csv", "source point 99999");
  refuses(program, files + "--landmarks .", "cannot be opened");
  refuses(program, files + "--filled /dev/null", "a name without extension");
  program.write("tiny.xyz", "0 0 0\n1e-200 0 0\n0 1e-200 0\n0 0 1e-200\n");
  refuses(program,
          "--source tiny.xyz --target target.ply --output out.ply",
          "extend over 1.73205e-200");
  refuses(program, "--source source.ply --target tiny.xyz --output out.ply", "Check the units");
}

BOOST_AUTO_TEST_CASE(byte_order_marks_and_extensions_in_capitals_are_read)
{
  Fit_run program;
  program.write("a.csv", "\xEF\xBB\xBFpoint,x,y,z\n5,1001.1,-20.3,5.8\n");
  BOOST_TEST(program.run(files + "--landmarks a.csv") == 0, program.err);
  program.write("a.JSON", R"([{"point": 5, "target": [1001.1, -20.3, 5.8]}])");
  BOOST_TEST(program.run(files + "--landmarks a.JSON") == 0, program.err);
}

BOOST_AUTO_TEST_CASE(what_does_not_follow_is_reported)
{
  Fit_run program;
  const auto warns = [&](const std::string& arguments, const std::string& words) {
    const int code = program.run(arguments);
    BOOST_TEST(code == 0, arguments << ": " << program.err);
    BOOST_TEST(program.err.find(words) != std::string::npos, words << " in " << program.err);
  };
  const std::string out = " --target target.ply --samples 50 --iterations 5 --output ";
  program.write("mesh.off", mesh_of(program.source.points()));
  warns("--source mesh.off" + out + "out.xyz", "mesh.off: the 1 faces of the mesh are left out");
  BOOST_TEST(pcs::IO::read_points(program.path("out.xyz")).number_of_points() ==
             number_of_pillar_points);

  Table splats(program.source.points());
  const std::vector<float> values(splats.number_of_points(), 1);
  for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3", "scale_0", "scale_1", "scale_2"})
    splats.add_property(name, values);
  pcs::IO::write_points(program.path("splats.ply"), splats);
  warns("--source splats.ply" + out + "out.ply", "of Gaussian splats are left as they are");

  std::vector<float> normals(values);
  normals[7] = std::numeric_limits<float>::quiet_NaN();
  Table invalid(program.source.points());
  for (const char* name : {"nx", "ny", "nz"})
    invalid.add_property(name, normals);
  pcs::IO::write_points(program.path("normals.ply"), invalid);
  warns("--source normals.ply" + out + "out.ply", "the normal of point 7 is not finite");
}

BOOST_AUTO_TEST_CASE(points_that_spoil_the_extent_are_reported)
{
  Fit_run program;
  const std::string words = "a few points lie far away from all others";
  BOOST_TEST(program.run(files + "--iterations 5") == 0, program.err);
  BOOST_TEST(program.err.find(words) == std::string::npos, program.err);
  std::vector<Table::Point_3> points = program.source.points();
  points.emplace_back(1e4, 0, 0);
  pcs::IO::write_points(program.path("stray.ply"), Table(points));
  const std::string arguments = "--source stray.ply --target target.ply --output out.ply ";
  BOOST_TEST(program.run(arguments + "--iterations 5") == 0, program.err);
  BOOST_TEST(program.err.find(words) != std::string::npos, program.err);
}

BOOST_AUTO_TEST_CASE(clouds_of_different_sizes_are_reported)
{
  Fit_run program;
  const std::string words = "sizes are not adapted; convert the units if they differ";
  const auto has_warning = [&](double size) {
    std::vector<Table::Point_3> points;
    for (const auto& p : program.source.points())
      points.emplace_back(size * p.x(), size * p.y(), size * p.z());
    pcs::IO::write_points(program.path("other.ply"), Table(points));
    const int code =
        program.run("--source source.ply --target other.ply --output out.ply --iterations 5");
    BOOST_TEST(code == 0, program.err);
    return program.err.find(words) != std::string::npos;
  };
  BOOST_TEST(has_warning(10));
  BOOST_TEST(has_warning(0.1));
  BOOST_TEST(!has_warning(2));
}

BOOST_AUTO_TEST_CASE(advice_names_units_and_given_landmarks)
{
  Fit_run program;
  std::vector<Table::Point_3> millimetres;
  for (const auto& p : program.source.points())
    millimetres.emplace_back(1000 * p.x(), 1000 * p.y(), 1000 * p.z());
  pcs::IO::write_points(program.path("mm.ply"), Table(millimetres));
  const std::string other = "--source mm.ply --target target.ply --output out.ply ";
  BOOST_TEST(program.run(other + "--report r.json") == 0, program.err);
  BOOST_TEST(Json::parse(program.content("r.json"))["median_residual"].is_null()); // no match
  BOOST_TEST(program.err.find("points are matched; check") != std::string::npos, program.err);
  BOOST_TEST(program.err.find("check the units and origins of both clouds; landmarks may help") !=
                 std::string::npos,
             program.err);
  program.write("a.csv", "0,1001,-20,6\n");
  BOOST_TEST(program.run(other + "--landmarks a.csv") == 0, program.err);
  BOOST_TEST(program.err.find("both clouds and the landmarks") != std::string::npos, program.err);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_program

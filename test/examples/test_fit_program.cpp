// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program fit_point_set: fitted points and their properties, filled holes, landmarks, and
// rejection of invalid input.

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <examples/Program_run.h>
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

BOOST_AUTO_TEST_CASE(landmarks_are_read_from_json_and_from_a_table)
{
  Fit_run program;
  program.write("a.json", R"([{"point": 5, "target": [1001.1, -20.3, 5.8]}])");
  program.write("a.csv", "point,x,y,z\n5,1001.1,-20.3,5.8\n");
  BOOST_TEST(program.run(files + "--landmarks a.json") == 0, program.err);
  const std::string from_json = program.content("out.ply");
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
  program.write("bad.json", R"([{"point": -1, "target": [1, 2, 3]}])");
  refuses(program, files + "--landmarks bad.json", "/0/point");
  program.write("far.csv", "99999,1,2,3\n");
  refuses(program, files + "--landmarks far.csv", "source point 99999");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_program

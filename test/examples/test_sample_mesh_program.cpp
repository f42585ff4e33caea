// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program sample_mesh: points of the mesh with normals, and rejection of invalid input.

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <examples/Program_run.h>
#include <string>

namespace test_sample_mesh_program {

namespace {

struct Sample_run : Program_run
{
  Sample_run() : Program_run("sample_mesh")
  {
    write("square.obj", "v 5 0 1\nv 7 0 1\nv 7 2 1\nv 5 2 1\nf 1 2 3 4\n");
  }
  void refuses(const std::string& arguments, const std::string& word)
  {
    write("out.ply", "an old file");
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    BOOST_TEST(content("out.ply") == "an old file");
  }
};

const std::string files = "--input square.obj --output out.ply ";

} // namespace

BOOST_FIXTURE_TEST_SUITE(sample_mesh_program, Sample_run)

BOOST_AUTO_TEST_CASE(points_of_a_square_have_its_normal)
{
  BOOST_TEST_REQUIRE(run(files + "--spacing 0.05") == 0, err);
  const Table table = pcs::IO::read_points(path("out.ply"));
  BOOST_TEST(std::abs(double(table.number_of_points()) * 0.05 * 0.05 / 4 - 0.62) < 0.03);
  for (const auto& p : table.points()) {
    BOOST_TEST(std::max(std::abs(p.x() - 6), std::abs(p.y() - 1)) <= 1);
    BOOST_TEST(std::abs(p.z() - 1) < 1e-12);
  }
  for (const auto& n : table.normals())
    BOOST_TEST(n.z() == 1);
  const std::string first = content("out.ply");
  BOOST_TEST_REQUIRE(run(files + "--spacing 0.05 --seed 0") == 0, err);
  BOOST_TEST(content("out.ply") == first);
  BOOST_TEST_REQUIRE(run(files + "--spacing 0.05 --seed 1") == 0, err);
  BOOST_TEST(content("out.ply") != first);
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused_and_touches_no_file)
{
  refuses(files + "--spacing 0", "--spacing must be a finite number, more than 0");
  refuses(files + "--spacing inf", "--spacing must be a finite number");
  refuses(files + "--spacing nan", "--spacing must be a number");
  refuses(files + "--spacing 1e-9", "too small");
  refuses("--input square.obj --output out.ply", "--spacing");
  write("cloud.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  refuses("--input cloud.xyz --output out.ply --spacing 1", "cloud.xyz: has no faces");
  write("flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
  refuses("--input flat.off --output out.ply --spacing 1", "no area");
  write("arrow.off", "OFF\n4 1 0\n0 0 0\n4 0 0\n4 4 0\n3 1 0\n4 0 1 2 3\n");
  refuses("--input arrow.off --output out.ply --spacing 1",
          "arrow.off: pcs::sample_mesh(): face 0");
  refuses("--input square.obj --output ./square.obj --spacing 1", "would destroy it");
  refuses(files + "--spacing 1 --seed 1.5", "seed");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_sample_mesh_program

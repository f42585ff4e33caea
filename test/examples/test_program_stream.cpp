// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program deform_point_set from file to file: results equal or close to those in memory.

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <examples/Program_run.h>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace test_program_stream {

namespace {

const std::string edit_text = R"({"handles": [
  {"select": {"property": "status", "equals": 0}, "fixed": true},
  {"select": {"property": "status", "equals": 9}, "rotate": {"axis": [1, 0, 1], "degrees": 40},
   "translate": [1, 0, 0]}]})";

/// Runs the edit on a file in memory and as a stream, and compares the outputs byte by byte.
void is_same_as_in_memory(Deform_run& program,
                          const std::string& in,
                          const std::string& out,
                          const std::string& edit = "--edit edit.json")
{
  const std::string arguments = "--quiet --input " + in + " " + edit + " --output ";
  BOOST_TEST_REQUIRE(program.run(arguments + "memory_" + out) == 0, program.err);
  for (const char* chunk : {"", " --chunk-points 1", " --chunk-points 777"}) {
    BOOST_TEST_REQUIRE(program.run(arguments + out + " --stream" + chunk) == 0, program.err);
    BOOST_TEST((program.content(out) == program.content("memory_" + out)),
               in << " to " << out << chunk);
  }
}

constexpr std::size_t number_of_large_points = 60000;
constexpr double object_size = 10; // the height [L]

/// The pillar of `Program_run` with more points, whose order does not follow the height.
Table large_cloud()
{
  const std::size_t n = number_of_large_points;
  std::vector<Table::Point_3> points;
  std::vector<float> nx, ny, nz;
  std::vector<std::uint8_t> status;
  std::vector<std::int64_t> id;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = k * 7919 % n; // 7919 is prime and does not divide n
    const double angle = 2.399963229728653 * double(i), height = 10 * double(i) / double(n);
    points.emplace_back(1000.1 + std::cos(angle), -20.3 + std::sin(angle), 5.7 + height);
    nx.push_back(float(std::cos(angle)));
    ny.push_back(float(std::sin(angle)));
    nz.push_back(0);
    status.push_back(std::uint8_t(height));
    id.push_back(std::numeric_limits<std::int64_t>::max() - std::int64_t(k));
  }
  Table table(points);
  table.add_property("nx", nx);
  table.add_property("status", status);
  table.add_property("ny", ny);
  table.add_property("nz", nz);
  table.add_property("id", id);
  return table;
}

double distance(const Table& a, const Table& b, std::size_t i)
{
  return std::sqrt((a.points()[i] - b.points()[i]).squared_length());
}

struct Large_run : Deform_run
{
  Large_run()
  {
    input = large_cloud();
    pcs::IO::write_points(path("in.ply"), input);
  }
  Table stream(const std::string& edit, const std::string& more = "")
  {
    return deform(parse(edit), "--stream --stream-points 20000 --chunk-points 10007 " + more);
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(streams)

BOOST_FIXTURE_TEST_CASE(a_small_file_gives_the_bytes_of_the_memory_mode, Deform_run)
{
  write("edit.json", edit_text);
  for (const char* target : {"out.ply", "out.csv", "out.xyz", "out.las"})
    is_same_as_in_memory(*this, "in.ply", target);
  pcs::IO::write_points(path("in.csv"), input);
  pcs::IO::write_points(path("in.las"), input);
  for (const char* in : {"in.csv", "in.las"})
    for (const char* target : {"out.ply", "out.las"})
      is_same_as_in_memory(*this, in, target);
  pcs::IO::write_points(path("in.off"), input.points());
  write("indices.json", R"({"handles": [{"select": {"indices": [7, 0, 1, 7]}, "fixed": true},
    {"select": {"sphere": {"center": [1000.1, -20.3, 15.7], "radius": 1.5}}, "scale": 1.5,
     "softness": 2}]})");
  is_same_as_in_memory(*this, "in.off", "out.off", "--edit indices.json");
  is_same_as_in_memory(*this, "in.off", "out.off", "--default-edit");
}

BOOST_FIXTURE_TEST_CASE(a_las_grid_that_no_longer_fits_is_renewed_in_the_same_way, Deform_run)
{
  pcs::IO::write_points(path("in.las"), input);
  write("far.json", R"({"handles": [{"select": {"property": "status", "equals": 9},
                                     "translate": [3000, 0, 0]}]})");
  is_same_as_in_memory(*this, "in.las", "out.las", "--edit far.json");
}

BOOST_FIXTURE_TEST_CASE(a_stream_writes_what_it_reads, Deform_run)
{
  write("edit.json", edit_text);
  BOOST_TEST_REQUIRE(run("--input in.ply --edit edit.json --output out.ply") == 0, err);
  const std::string arguments = "--input in.ply --edit edit.json --output in.ply --stream";
  BOOST_TEST_REQUIRE(run(arguments + " --chunk-points 100") == 0, err);
  BOOST_TEST((content("in.ply") == content("out.ply")));
  BOOST_TEST(number_of_files() == 3); // in, edit, out: no temporary files
}

BOOST_FIXTURE_TEST_CASE(an_invalid_normal_leaves_all_normals_in_a_stream, Deform_run)
{
  input.property<float>("ny")[1700] = std::numeric_limits<float>::quiet_NaN();
  pcs::IO::write_points(path("in.ply"), input);
  write("edit.json", edit_text);
  is_same_as_in_memory(*this, "in.ply", "out.ply");
  BOOST_TEST(err.find("the normal of point 1700 is not finite") != std::string::npos, err);
  BOOST_TEST(std::count(err.begin(), err.end(), '\n') == 2); // also of points without a handle
}

BOOST_FIXTURE_TEST_CASE(a_large_file_is_close_to_the_memory_mode, Large_run)
{
  const Table memory = deform(parse(edit_text));
  const Json memory_report = report;
  const Table result = stream(edit_text);
  BOOST_TEST_REQUIRE(result.number_of_points() == number_of_large_points);
  BOOST_TEST((result.schema().properties == input.schema().properties));
  for (const char* name : {"status", "id"})
    BOOST_TEST((result.property_values(name) == input.property_values(name)), name);

  double handle_error = 0, error = 0, normal_error = 0, squared_normal_error = 0;
  std::size_t number_of_changed_fixed_points = 0;
  for (std::size_t i = 0; i < number_of_large_points; ++i) {
    const int status = input.property<std::uint8_t>("status")[i];
    number_of_changed_fixed_points +=
        status == 0 && (result.points()[i] != input.points()[i] ||
                        result.property<float>("nx")[i] != input.property<float>("nx")[i]);
    double& largest = status == 0 || status == 9 ? handle_error : error;
    largest = std::max(largest, distance(result, memory, i));
    for (const char* name : {"nx", "ny", "nz"}) {
      const double e =
          double(std::abs(result.property<float>(name)[i] - memory.property<float>(name)[i]));
      normal_error = std::max(normal_error, e);
      squared_normal_error += e * e / double(number_of_large_points);
    }
  }
  BOOST_TEST(number_of_changed_fixed_points == 0);
  BOOST_TEST(handle_error < 1e-9); // coordinates of 1e3 in double precision, with a margin
  BOOST_TEST_MESSAGE("largest distance " << error << ", of normals " << normal_error << ", mean "
                                         << std::sqrt(squared_normal_error));
  BOOST_TEST(error < 0.012 * object_size);
  // The crease at the rotated handle has different samples: a few hundred normals there differ by
  // more than 0.1.
  BOOST_TEST(normal_error < 0.3);
  BOOST_TEST(squared_normal_error < 0.04 * 0.04);

  BOOST_TEST(memory_report["streamed"] == false);
  BOOST_TEST(report["streamed"] == true);
  BOOST_TEST(report["points"] == number_of_large_points);
  BOOST_TEST(report["kept_points"].get<std::size_t>() <= 20000);
  BOOST_TEST(report["kept_points"].get<std::size_t>() > 19800);
  BOOST_TEST(report["neighbors"] == 10);
  BOOST_TEST(report["chunks"] == 6);
  BOOST_TEST(report["points_per_second"].get<double>() > 0);
  BOOST_TEST(report["points_of_handles"] == memory_report["points_of_handles"]);
}

BOOST_FIXTURE_TEST_CASE(chunk_borders_do_not_show, Large_run)
{
  const std::string arguments =
      "--input in.ply --stream --stream-points 20000 --output out.ply --quiet ";
  write("edit.json", edit_text);
  for (const std::string edit : {"--edit edit.json", "--default-edit"}) {
    std::string bytes;
    for (const char* chunk : {" --chunk-points 997", " --chunk-points 20000", ""}) {
      BOOST_TEST_REQUIRE(run(arguments + edit + chunk) == 0, err);
      if (bytes.empty())
        bytes = content("out.ply");
      BOOST_TEST((content("out.ply") == bytes), edit << chunk);
    }
  }
}

BOOST_FIXTURE_TEST_CASE(small_handles_are_not_lost_in_a_large_file, Large_run)
{
  const Table result = stream(
      R"({"handles": [{"select": {"indices": [59999, 1, 2, 3]}, "translate": [0, 0.25, 0]},
                      {"select": {"property": "status", "equals": 0}, "fixed": true}]})",
      "--samples 500");
  for (const std::size_t i : {std::size_t(59999), std::size_t(1), std::size_t(2), std::size_t(3)}) {
    const auto target = input.points()[i] + Table::Vector_3(0, 0.25, 0);
    BOOST_TEST(std::sqrt((result.points()[i] - target).squared_length()) < 1e-9);
  }
  BOOST_TEST(report["points_of_handles"][0] == 4);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(stream_errors)

/// Checks that messages are independent of the mode, and that files are unchanged.
BOOST_FIXTURE_TEST_CASE(errors_are_those_of_the_memory_mode, Deform_run)
{
  write("out.ply", "an old file");
  pcs::IO::write_points(path("in.csv"), input);
  for (const std::string select : {R"({"box": [[0, 0, 0], [1, 1, 1]]})",
                                   R"({"sphere": {"center": [0, 0, 0], "radius": 1}})",
                                   R"({"property": "class", "equals": 2})",
                                   R"({"property": "status", "equals": 99})",
                                   R"({"indices": [4, 2100]})",
                                   R"({"indices": [150, 199, 200, 300]})",
                                   R"({"indices": []})"})
    for (const std::string in : {"in.ply", "in.csv"}) {
      write("edit.json",
            R"({"handles": [{"select": {"property": "status", "equals": 0}, "fixed": true},
               {"select": )" +
                select + R"(, "scale": 2}]})");
      const std::string arguments = "--input " + in + " --edit edit.json --output out.ply";
      BOOST_TEST(run(arguments) == 1, select);
      const std::string expected = err;
      BOOST_TEST(run(arguments + " --stream --chunk-points 100") == 1, select);
      BOOST_TEST(err == expected);
    }
  BOOST_TEST(content("out.ply") == "an old file");
  BOOST_TEST(number_of_files() == 4); // in.ply, in.csv, edit, out
}

BOOST_FIXTURE_TEST_CASE(files_and_numbers_are_checked, Deform_run)
{
  const auto refuses = [&](const std::string& arguments, const std::string& word) {
    write("out.ply", "an old file");
    const std::size_t before = number_of_files();
    BOOST_TEST(run(arguments + " --default-edit") == 1, arguments);
    BOOST_TEST(err.find(word) != std::string::npos, arguments << ": " << err);
    BOOST_TEST(content("out.ply") == "an old file");
    BOOST_TEST(number_of_files() == before);
  };
  const std::string files = "--input in.ply --output out.ply ";
  refuses(files + "--stream-points 1000", "--stream");
  refuses(files + "--chunk-points 1000", "--stream");
  for (const char* number : {"0", "99", "-5", "1.5", "99999999999999999999"})
    refuses(files + "--stream --stream-points " + number, "--stream-points");
  refuses(files + "--stream --chunk-points 0", "--chunk-points");
  refuses("--input no.ply --output out.ply --stream", "no.ply");
  refuses("--input . --output out.ply --stream", ".");
  refuses("--input in.ply --output no/out.ply --stream", "no/out.ply: cannot be opened");
  refuses("--input in.ply --output out.off --stream", "OFF cannot store the property");
  BOOST_TEST(std::system(("mkfifo '" + path("pipe") + "'").c_str()) == 0);
  refuses("--input pipe --output out.ply --stream", "no regular file");
  write("in.xyz", "1 2 3\n2 2 3\nnan 2 3\n");
  refuses("--input in.xyz --output out.ply --stream --chunk-points 1", "in.xyz");
  write("in.xyz", "# nothing\n");
  refuses("--input in.xyz --output out.ply --stream", "");
  std::filesystem::resize_file(path("in.ply"), 1000); // shorter than in its header
  refuses(files + "--stream", "in.ply");
}

BOOST_FIXTURE_TEST_CASE(one_place_in_two_handles_is_refused_in_a_stream, Deform_run)
{
  input.points()[1999] = input.points()[0];
  pcs::IO::write_points(path("in.ply"), input);
  write("edit.json", R"({"handles": [{"select": {"indices": [0]}, "fixed": true},
                                     {"select": {"indices": [1999]}, "scale": 2}]})");
  const std::string arguments = "--input in.ply --edit edit.json --output out.ply --stream";
  BOOST_TEST(run(arguments) == 1);
  BOOST_TEST(err.find("point 1999") != std::string::npos, err);
  BOOST_TEST(run(arguments + " --stream-points 1000") == 1);
  BOOST_TEST(err.find("numbers count the points that --stream keeps") != std::string::npos, err);
  BOOST_TEST(!exists("out.ply"));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_program_stream

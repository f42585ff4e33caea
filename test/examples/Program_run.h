// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Runs the program deform_point_set on the files of one test case, in a folder that is removed at
// its end.

#ifndef PCS_TEST_EXAMPLES_PROGRAM_RUN_H
#define PCS_TEST_EXAMPLES_PROGRAM_RUN_H

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>

#include <boost/test/unit_test.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

using Json = nlohmann::json;
using Table = pcs::IO::Point_table;

constexpr std::size_t number_of_pillar_points = 2000, number_of_far_points = 100;

/// A pillar of radius 1 and height 10 with its foot at (1000.1, -20.3, 5.7), followed by a
/// disconnected lump. `status` is the tenth of the height, 0 to 9, and 10 in the lump.
inline Table make_cloud()
{
  std::vector<Table::Point_3> points;
  std::vector<Table::Vector_3> normals;
  std::vector<float> nx, ny, nz, tenth;
  std::vector<std::uint8_t> status;
  std::vector<std::int16_t> signed_id;
  std::vector<std::int64_t> large;
  std::vector<double> time;
  for (std::size_t i = 0; i < number_of_pillar_points + number_of_far_points; ++i) {
    const bool is_far = i >= number_of_pillar_points;
    const double angle = 2.399963229728653 * double(i);
    const double height = 10 * double(i) / double(number_of_pillar_points);
    points.emplace_back(1000.1 + std::cos(angle) + (is_far ? 100 : 0),
                        -20.3 + std::sin(angle),
                        5.7 + height);
    nx.push_back(float(std::cos(angle)));
    ny.push_back(float(std::sin(angle)));
    nz.push_back(0);
    status.push_back(is_far ? std::uint8_t(10) : std::uint8_t(height));
    tenth.push_back(float(int(height)) / 10);
    signed_id.push_back(std::int16_t(int(i) - 1000));
    large.push_back(std::numeric_limits<std::int64_t>::max() - std::int64_t(i));
    time.push_back(1e9 + 1e-7 * double(i));
  }
  Table table(points);
  table.add_property("nx", nx);
  table.add_property("status", status); // intentionally between the normals
  table.add_property("ny", ny);
  table.add_property("nz", nz);
  table.add_property("tenth", tenth);
  table.add_property("signed_id", signed_id);
  table.add_property("large", large);
  table.add_property("time", time);
  return table;
}

struct Program_run
{
  explicit Program_run(const std::string& name) : program(PCS_TEST_PROGRAMS "/" + name)
  {
    static int number = 0;
    folder = std::filesystem::temp_directory_path() /
             ("pcs_test_program_" + std::to_string(::getpid()) + "_" + std::to_string(++number));
    std::filesystem::create_directories(folder);
    input = make_cloud();
    pcs::IO::write_points(path("in.ply"), input);
  }
  ~Program_run()
  {
    std::error_code error;
    std::filesystem::remove_all(folder, error);
  }
  Program_run(const Program_run&) = delete;
  Program_run& operator=(const Program_run&) = delete;

  std::string path(const std::string& name) const { return (folder / name).string(); }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder / name); }

  void write(const std::string& name, const std::string& text) const
  {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  std::string content(const std::string& name) const
  {
    std::ifstream in(path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }
  std::size_t number_of_files() const
  {
    return std::size_t(std::distance(std::filesystem::directory_iterator(folder), {}));
  }

  /// Runs in the folder. Returns the exit code, or 1000 + the signal that terminated it.
  int run(const std::string& arguments)
  {
    const std::string command = "cd '" + folder.string() + "' && '" + program + "' " + arguments +
                                " > stdout.txt 2> stderr.txt < /dev/null";
    const int status = std::system(command.c_str());
    out = content("stdout.txt");
    err = content("stderr.txt");
    std::filesystem::remove(folder / "stdout.txt");
    std::filesystem::remove(folder / "stderr.txt");
    if (!WIFEXITED(status))
      return 1000 + WTERMSIG(status);
    const int code = WEXITSTATUS(status); // the shell reports a signal as 128 + its number
    return code > 128 ? 1000 + code - 128 : code;
  }

  /// Runs an edit on in.ply that must succeed. Returns the output and keeps the report.
  Table deform(const Json& edit, const std::string& more = "")
  {
    write("edit.json", edit.dump());
    const int code =
        run("--input in.ply --edit edit.json --output out.ply --report report.json " + more);
    BOOST_TEST_REQUIRE(code == 0, "exit code " << code << ": " << err);
    report = Json::parse(content("report.json"));
    return pcs::IO::read_points(path("out.ply"));
  }

  std::string program;
  std::filesystem::path folder;
  Table input;
  Json report;
  std::string out, err;
};

/// A run of deform_point_set.
struct Deform_run : Program_run
{
  Deform_run() : Program_run("deform_point_set") {}
};

/// Handles as JSON, similar to edit files.
inline Json edit_of(const std::vector<Json>& handles)
{
  return Json{{"handles", handles}};
}
inline Json parse(const std::string& text)
{
  return Json::parse(text);
}

#endif // PCS_TEST_EXAMPLES_PROGRAM_RUN_H

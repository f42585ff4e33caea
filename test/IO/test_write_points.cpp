// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of writing PLY, text and OFF, and of the files that remain after a failure.

#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <support/exceptions.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <csignal>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <limits>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace test_write_points {

using pcs::Invalid_input;
using pcs::IO_error;
using pcs::IO::Ply_encoding;
using pcs::IO::Point_reader;
using pcs::IO::Point_table;
using pcs::IO::Point_writer;
using pcs::IO::Scalar_type;
using pcs::IO::Write_options;
using pcs_test::message_has;
using Point_3 = Point_table::Point_3;

namespace {

template <class T>
void add_extremes(Point_table& table, const std::string& name)
{
  using Limits = std::numeric_limits<T>;
  table.add_property<T>(name, {Limits::lowest(), Limits::max(), Limits::min()});
}

Point_table all_types()
{
  Point_table table(std::vector<Point_3>{Point_3(500000.123, 5000000.456, 0.1),
                                         Point_3(1e-310, -0.0, 1e300),
                                         Point_3(1.0 / 3, 2, 3)});
  add_extremes<std::int8_t>(table, "a");
  add_extremes<std::uint8_t>(table, "b");
  add_extremes<std::int16_t>(table, "c");
  add_extremes<std::uint16_t>(table, "d");
  add_extremes<std::int32_t>(table, "e");
  add_extremes<std::uint32_t>(table, "f");
  add_extremes<std::int64_t>(table, "g");
  add_extremes<std::uint64_t>(table, "h");
  add_extremes<float>(table, "i");
  add_extremes<double>(table, "j");
  return table;
}

Point_table one_point()
{
  return Point_table(std::vector<Point_3>{Point_3(1, 2, 3)});
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(write_points, Temporary_files)

BOOST_AUTO_TEST_CASE(ply_gives_back_every_bit_in_every_encoding)
{
  const Point_table table = all_types();
  for (const Ply_encoding encoding :
       {Ply_encoding::ascii, Ply_encoding::binary_little_endian, Ply_encoding::binary_big_endian}) {
    Write_options options;
    options.ply_encoding = encoding;
    pcs::IO::write_points(path("a.ply"), table, options);
    const Point_table again = pcs::IO::read_points(path("a.ply"));
    BOOST_TEST(are_equal(again, table));
    BOOST_TEST((again.schema().properties == table.schema().properties));
    BOOST_TEST(std::signbit(again.points()[1].y()));
  }
}

BOOST_AUTO_TEST_CASE(ply_keeps_order_comments_and_values_that_are_not_finite)
{
  const std::string text = "ply\nformat ascii 1.0\ncomment one\ncomment\nobj_info two  words\n"
                           "element vertex 2\nproperty uchar label\nproperty double z\n"
                           "property double y\nproperty double x\nproperty float w\nend_header\n"
                           "7 1 2.5 3 nan\n8 -0.1 1e+30 6 inf\n";
  const Point_table table = read("a.ply", text);
  Write_options options;
  options.ply_encoding = Ply_encoding::ascii;
  pcs::IO::write_points(path("b.ply"), table, options);
  BOOST_TEST(content("b.ply") == text);
}

BOOST_AUTO_TEST_CASE(coordinates_become_double_unless_asked_otherwise)
{
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                             "property int y\nproperty double z\nend_header\n";
  Point_table table = read("a.ply", header + "0.1 2 3\n");
  pcs::IO::write_points(path("b.ply"), table);
  BOOST_TEST(
      (pcs::IO::read_points(path("b.ply")).schema().properties[0].type == Scalar_type::float64));
  Write_options options;
  options.keep_coordinate_types = true;
  options.ply_encoding = Ply_encoding::ascii;
  pcs::IO::write_points(path("b.ply"), table, options);
  BOOST_TEST(content("b.ply") == header + "0.1 2 3\n");
  table.points()[0] = Point_3(0, 2.5, 3); // not an integer
  BOOST_CHECK_THROW(pcs::IO::write_points(path("b.ply"), table, options), Invalid_input);
  table.points()[0] = Point_3(1e300, 2, 3); // exceeds the range of a float
  BOOST_CHECK_THROW(pcs::IO::write_points(path("b.ply"), table, options), Invalid_input);
}

BOOST_AUTO_TEST_CASE(text_gives_back_positions_and_names)
{
  Point_table table = all_types();
  table.remove_property("g"); // a double does not represent all 64 bits
  table.remove_property("h");
  table.remove_property("i"); // the shortest text of a float is a different double
  for (const char* name : {"a.csv", "a.xyz", "a.txt"}) {
    pcs::IO::write_points(path(name), table);
    const Point_table again = pcs::IO::read_points(path(name));
    BOOST_TEST((again.points() == table.points()));
    BOOST_TEST((again.property_names() == table.property_names()));
    BOOST_TEST((again.property<double>("e") == table.property_as_double("e")));
    BOOST_TEST((again.property<double>("j") == table.property<double>("j")));
  }
}

BOOST_AUTO_TEST_CASE(text_has_a_header_only_where_names_would_be_lost)
{
  Point_table table = one_point();
  pcs::IO::write_points(path("a.xyz"), table);
  BOOST_TEST(content("a.xyz") == "1 2 3\n");
  pcs::IO::write_points(path("a.csv"), table);
  BOOST_TEST(content("a.csv") == "x,y,z\n1,2,3\n");
  table.add_property<float>("column_4", {0.1f});
  pcs::IO::write_points(path("a.xyz"), table);
  BOOST_TEST(content("a.xyz") == "1 2 3 0.1\n");
  table.add_property<int>("label", {-4});
  Write_options options;
  options.text_separator = ';';
  pcs::IO::write_points(path("a.xyz"), table, options);
  BOOST_TEST(content("a.xyz") == "x;y;z;column_4;label\n1;2;3;0.1;-4\n");
  options.text_header = pcs::IO::Text_header::never;
  pcs::IO::write_points(path("a.xyz"), table, options);
  BOOST_TEST(content("a.xyz") == "1;2;3;0.1;-4\n");
}

BOOST_AUTO_TEST_CASE(off_gives_back_normals_and_colors)
{
  Point_table table = one_point();
  pcs::IO::write_points(path("a.off"), table);
  BOOST_TEST(content("a.off") == "OFF\n1 0 0\n1.0 2.0 3.0\n");
  table.add_property<std::uint8_t>("red", {255});
  table.add_property<std::uint8_t>("green", {0});
  table.add_property<std::uint8_t>("blue", {7});
  table.set_normals({Point_table::Vector_3(0, 0, 1)});
  pcs::IO::write_points(path("a.off"), table);
  BOOST_TEST(content("a.off") == "CNOFF\n1 0 0\n1.0 2.0 3.0 0.0 0.0 1.0 255 0 7\n");
  const Point_table again = pcs::IO::read_points(path("a.off"));
  BOOST_TEST(again.has_normals());
  BOOST_TEST(int(again.property<std::uint8_t>("blue")[0]) == 7);
  table.add_property<int>("label", {1});
  BOOST_CHECK_THROW(pcs::IO::write_points(path("a.off"), table), IO_error);
}

BOOST_AUTO_TEST_CASE(the_header_gets_the_count_of_chunks)
{
  for (const char* name : {"a.ply", "a.off", "a.xyz"}) {
    Point_writer writer(path(name), one_point().schema());
    for (int i = 0; i < 12; ++i)
      writer.append(one_point());
    writer.commit();
    BOOST_TEST(pcs::IO::read_points(path(name)).number_of_points() == 12u);
  }
}

BOOST_AUTO_TEST_CASE(another_count_than_announced_is_refused)
{
  Write_options options;
  options.number_of_points = 2;
  Point_writer few(path("a.ply"), one_point().schema(), options);
  few.append(one_point());
  BOOST_CHECK_THROW(few.commit(), Invalid_input);
  Point_writer many(path("a.ply"), one_point().schema(), options);
  many.append(one_point());
  many.append(one_point());
  BOOST_CHECK_THROW(many.append(one_point()), Invalid_input);
  BOOST_CHECK_THROW(many.commit(), Invalid_input);
}

BOOST_AUTO_TEST_CASE(chunks_must_have_the_properties_of_the_schema)
{
  Point_table other = one_point();
  other.add_property<int>("label", {1});
  Point_writer writer(path("a.ply"), one_point().schema());
  BOOST_CHECK_THROW(writer.append(other), Invalid_input);
  Point_writer labels(path("b.ply"), other.schema());
  BOOST_CHECK_THROW(labels.append(one_point()), Invalid_input);
  other.replace_property<float>("label", {1});
  Point_writer types(path("c.ply"), Point_table(other).schema());
  other.replace_property<int>("label", {1});
  BOOST_CHECK_THROW(types.append(other), Invalid_input);
}

BOOST_AUTO_TEST_CASE(points_that_a_reader_would_refuse_are_not_written)
{
  Point_table table = one_point();
  table.points()[0] = Point_3(0, std::numeric_limits<double>::quiet_NaN(), 0);
  BOOST_CHECK_THROW(pcs::IO::write_points(path("a.xyz"), table), Invalid_input);
  table = one_point();
  table.add_property<int>("label", {1});
  table.points().push_back(Point_3(1, 2, 3)); // without a label
  BOOST_CHECK_THROW(pcs::IO::write_points(path("a.xyz"), table), Invalid_input);
  table = one_point();
  table.add_property<int>("two words", {1});
  BOOST_CHECK_THROW(pcs::IO::write_points(path("a.ply"), table), IO_error);
  BOOST_CHECK_THROW(pcs::IO::write_points(path("a.csv"), table), IO_error);
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_CASE(without_commit_nothing_is_left_behind)
{
  file("a.ply", "old");
  {
    Point_writer writer(path("a.ply"), one_point().schema());
    writer.append(one_point());
    BOOST_TEST(number_of_files() <= 2u);
  }
  BOOST_TEST(content("a.ply") == "old");
  BOOST_TEST(number_of_files() == 1u);
}

#if defined(O_TMPFILE)
BOOST_AUTO_TEST_CASE(a_program_that_is_killed_leaves_nothing_behind)
{
  const int nameless = ::open(folder.c_str(), O_TMPFILE | O_WRONLY, 0666);
  if (nameless < 0)
    return; // not supported by the file system
  ::close(nameless);
  const pid_t child = ::fork();
  if (child == 0) {
    Point_writer writer(path("a.ply"), one_point().schema());
    writer.append(one_point());
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  BOOST_TEST(::waitpid(child, &status, 0) == child);
  BOOST_TEST(WIFSIGNALED(status));
  BOOST_TEST(number_of_files() == 0u);
}
#endif

BOOST_AUTO_TEST_CASE(files_have_the_usual_permissions)
{
  using std::filesystem::perms;
  const mode_t before = ::umask(027);
  pcs::IO::write_points(path("a.xyz"), one_point());
  ::umask(before);
  const auto mode = [&] { return std::filesystem::status(path("a.xyz")).permissions(); };
  BOOST_TEST((mode() == perms(0640)));
  std::filesystem::permissions(path("a.xyz"), perms(0604));
  pcs::IO::write_points(path("a.xyz"), one_point()); // a replaced file keeps its permissions
  BOOST_TEST((mode() == perms(0604)));
}

BOOST_AUTO_TEST_CASE(leftovers_of_others_are_no_hindrance)
{
  for (const int i : {0, 1, 3})
    file(".pcs_unfinished_" + std::to_string(i) + ".tmp", "theirs");
  pcs::IO::write_points(path("a.xyz"), one_point());
  BOOST_TEST(content("a.xyz") == "1 2 3\n");
  BOOST_TEST(content(".pcs_unfinished_1.tmp") == "theirs");
  BOOST_TEST(number_of_files() == 4u);
}

BOOST_AUTO_TEST_CASE(a_full_disk_is_an_error)
{
  if (!std::filesystem::exists("/dev/full"))
    return;
  for (const auto format : {pcs::IO::File_format::ply,
                            pcs::IO::File_format::text,
                            pcs::IO::File_format::off,
                            pcs::IO::File_format::glb,
                            pcs::IO::File_format::las}) {
    Write_options options;
    options.format = format;
    BOOST_CHECK_THROW(pcs::IO::write_points("/dev/full", one_point(), options), IO_error);
  }
  BOOST_TEST(!std::filesystem::is_regular_file("/dev/full"));
}

BOOST_AUTO_TEST_CASE(bad_targets_are_errors)
{
  BOOST_CHECK_THROW(pcs::IO::write_points(path("absent/a.ply"), one_point()), IO_error);
  BOOST_CHECK_THROW(pcs::IO::write_points(folder.string(), one_point()), IO_error);
  BOOST_CHECK_THROW(pcs::IO::write_points(path("a.pcd"), one_point()), IO_error);
  BOOST_CHECK_THROW(pcs::IO::write_points(path("a.unknown"), one_point()), IO_error);
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_CASE(the_output_may_be_the_input)
{
  std::string text;
  for (int i = 0; i < 100000; ++i) // far more than the buffer size
    text += std::to_string(i) + " 2 3\n";
  Point_reader reader(file("a.xyz", text));
  Point_writer writer(path("a.xyz"), reader.schema());
  Point_table chunk;
  while (reader.read(chunk, 1000))
    writer.append(chunk);
  writer.commit();
  BOOST_TEST((content("a.xyz") == text));
  BOOST_TEST(number_of_files() == 1u);
}

BOOST_AUTO_TEST_CASE(a_symbolic_link_stays_a_link)
{
  file("real.xyz", "old");
  std::filesystem::create_symlink(path("real.xyz"), path("link.xyz"));
  pcs::IO::write_points(path("link.xyz"), one_point());
  BOOST_TEST(std::filesystem::is_symlink(path("link.xyz")));
  BOOST_TEST(content("real.xyz") == "1 2 3\n");
}

BOOST_AUTO_TEST_CASE(ranges_of_points_are_written)
{
  using Epick = CGAL::Exact_predicates_inexact_constructions_kernel;
  const std::vector<Epick::Point_3> points = {{0.1, 0.2, 0.3}, {4, 5, 6}};
  pcs::IO::write_points(path("a.ply"), points);
  std::vector<Epick::Point_3> again;
  pcs::IO::read_points(path("a.ply"), again);
  BOOST_TEST((again == points));
  pcs::IO::write_points(path("a.ply"), std::vector<Epick::Point_3>());
  BOOST_TEST(pcs::IO::read_points(path("a.ply")).number_of_points() == 0u);
}

BOOST_AUTO_TEST_CASE(names_that_a_header_cannot_hold_are_refused)
{
  for (const char* name : {"#a", "//a", "%a", "1", "a b", "a,b"}) {
    Point_table table(std::vector<Point_3>{{1, 2, 3}});
    table.add_property(name, std::vector<float>{4});
    BOOST_CHECK_THROW(pcs::IO::write_points(path("a.txt"), table), IO_error);
    BOOST_TEST(!std::filesystem::exists(path("a.txt")));
  }
}

BOOST_AUTO_TEST_CASE(options_and_remarks_that_a_format_cannot_hold_are_refused)
{
  Write_options options;
  options.text_separator = 'x';
  BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("a.txt"), one_point(), options),
                        Invalid_input,
                        message_has("text_separator must be a blank, a tab, a comma"));
  for (const char* line : {"two\nlines", "two\rlines"}) {
    Point_table table = one_point();
    table.comments() = {line};
    BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("a.ply"), table),
                          IO_error,
                          message_has("a PLY comment must be a single line"));
    table.comments().clear();
    table.obj_info() = {line};
    BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("a.ply"), table),
                          IO_error,
                          message_has("a PLY obj_info must be a single line"));
  }
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_CASE(off_keeps_transparency_and_refuses_other_types_of_colours)
{
  Point_table table = one_point();
  for (const char* name : {"red", "green", "blue", "alpha"})
    table.add_property<std::uint8_t>(name, {static_cast<std::uint8_t>(name[0])});
  pcs::IO::write_points(path("a.off"), table);
  const Point_table again = pcs::IO::read_points(path("a.off"));
  for (const char* name : {"red", "green", "blue", "alpha"})
    BOOST_TEST(int(again.property<std::uint8_t>(name)[0]) == int(name[0]));

  Point_table wide = one_point();
  for (const char* name : {"red", "green", "blue"})
    wide.add_property<std::uint16_t>(name, {1000});
  BOOST_CHECK_EXCEPTION(
      pcs::IO::write_points(path("b.off"), wide),
      IO_error,
      message_has("OFF stores colours as uint8 or floating point numbers", "red"));
  BOOST_TEST(!std::filesystem::exists(path("b.off")));
}

BOOST_AUTO_TEST_CASE(missing_files_and_folders_are_no_inputs)
{
  BOOST_CHECK_EXCEPTION(pcs::IO::read_points(path("missing.xyz")),
                        IO_error,
                        message_has("missing.xyz", "there is no such file"));
  std::filesystem::create_directory(path("folder.xyz"));
  BOOST_CHECK_EXCEPTION(pcs::IO::read_points(path("folder.xyz")),
                        IO_error,
                        message_has("folder.xyz", "expected a regular file"));
}

BOOST_AUTO_TEST_CASE(a_schema_needs_each_coordinate_and_no_name_twice)
{
  pcs::IO::Point_schema schema = one_point().schema();
  schema.properties.push_back(schema.properties[0]);
  BOOST_CHECK_EXCEPTION(Point_writer(path("a.ply"), schema),
                        Invalid_input,
                        message_has("the schema has the property 'x' twice"));
  schema = one_point().schema();
  schema.properties.erase(schema.properties.begin() + 1);
  BOOST_CHECK_EXCEPTION(Point_writer(path("a.ply"), schema),
                        Invalid_input,
                        message_has("the schema has no property 'y'"));
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_CASE(a_folder_with_the_name_of_the_output_stays)
{
  std::filesystem::create_directory(path("a.ply"));
  BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("a.ply"), one_point()),
                        IO_error,
                        message_has("a.ply", "is a directory, expected a file name"));
  BOOST_TEST(std::filesystem::is_directory(path("a.ply")));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_write_points

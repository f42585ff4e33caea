// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of writing LAS files.

#include "las_file.h"
#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <support/exceptions.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace test_write_las {

using pcs::Invalid_input;
using pcs::IO_error;
using pcs::IO::Point_reader;
using pcs::IO::Point_table;
using pcs::IO::Point_writer;
using pcs::IO::Write_options;
using Point_3 = Point_table::Point_3;

namespace {

Las_file rich_file(unsigned format)
{
  Las_file las;
  las.format = format;
  las.minor = format < 4 ? 2 : format < 6 ? 3 : 4;
  las.number_of_extra_bytes = 7;
  las.add_vlr("LASF_Projection", 2112, "somewhere");
  las.add_vlr("LASF_Spec", 4, extra_bytes_descriptor("tree_id", 5));
  if (las.minor == 4)
    las.add_evlr("someone", 9, "appendix");
  return las;
}

double largest_distance(const Point_table& a, const Point_table& b)
{
  double result = 0;
  for (std::size_t i = 0; i < a.number_of_points(); ++i)
    result = std::max(result, CGAL::squared_distance(a.points()[i], b.points()[i]));
  return std::sqrt(result);
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(write_las, Temporary_files)

BOOST_AUTO_TEST_CASE(everything_but_the_renewed_header_fields_survives)
{
  for (unsigned format = 0; format <= 10; ++format) {
    const std::string before = rich_file(format).bytes();
    pcs::IO::write_points(path("b.las"), read("a.las", before));
    std::string after = content("b.las");
    BOOST_REQUIRE(after.size() == before.size());
    // The constructed file has no counts by return and no bounding box.
    const auto clear = [&](std::size_t from, std::size_t to) {
      after.replace(from, to - from, before, from, to - from);
    };
    clear(111, 131);
    clear(179, 227);
    if (format >= 6)
      clear(255, 375);
    BOOST_TEST((after == before), "point format " << format);
  }
}

BOOST_AUTO_TEST_CASE(the_header_describes_the_points)
{
  Las_file las;
  std::string bytes = las.bytes();
  bytes[227 + 14] = bytes[227 + 20 + 14] = 1; // two first returns
  bytes[227 + 40 + 14] = 2;                   // and one second return
  pcs::IO::write_points(path("b.las"), read("a.las", bytes));
  const std::string after = content("b.las");
  const auto* data = reinterpret_cast<const unsigned char*>(after.data());
  BOOST_TEST(pcs::IO::internal::load<std::uint32_t>(data + 111, false) == 2u);
  BOOST_TEST(pcs::IO::internal::load<std::uint32_t>(data + 115, false) == 1u);
  BOOST_TEST(pcs::IO::internal::load<double>(data + 179, false) == 125 * 0.001 + 500000.0);
  BOOST_TEST(pcs::IO::internal::load<double>(data + 187, false) == 123 * 0.001 + 500000.0);
}

BOOST_AUTO_TEST_CASE(records_behind_the_points_move_with_their_number)
{
  const Point_table table = read("a.las", rich_file(6).bytes());
  pcs::IO::write_points(path("b.las"), table.select({2}));
  const Point_table again = pcs::IO::read_points(path("b.las"));
  BOOST_TEST((again.points()[0] == table.points()[2]));
  BOOST_TEST((again.schema().las->tail == table.schema().las->tail));
  BOOST_TEST((again.schema().las->vlrs == table.schema().las->vlrs));
}

BOOST_AUTO_TEST_CASE(new_properties_become_described_extra_bytes)
{
  Point_table table = read("a.las", rich_file(3).bytes());
  table.add_property<double>("radius", {0.5, 1.5, 2.5});
  table.add_property<std::int8_t>("branch", {-1, 0, 1});
  pcs::IO::write_points(path("b.las"), table);
  BOOST_TEST(are_equal(pcs::IO::read_points(path("b.las")), table));
  table.remove_property("tree_id"); // its bytes remain and are zero
  pcs::IO::write_points(path("b.las"), table);
  const Point_table again = pcs::IO::read_points(path("b.las"));
  BOOST_TEST(again.property<std::uint32_t>("tree_id")[1] == 0u);
  BOOST_TEST((again.property<double>("radius") == table.property<double>("radius")));
}

BOOST_AUTO_TEST_CASE(a_file_without_extra_bytes_gets_a_descriptor_in_front_of_its_records)
{
  Las_file las;
  las.add_vlr("someone", 1, "abc");
  Point_table table = read("a.las", las.bytes());
  table.add_property<float>("radius", {0.5f, 1.5f, 2.5f});
  pcs::IO::write_points(path("b.las"), table);
  BOOST_TEST(are_equal(pcs::IO::read_points(path("b.las")), table));
}

BOOST_AUTO_TEST_CASE(other_points_get_a_fine_grid)
{
  for (const double size : {0.01, 1.0, 37.5, 1e9}) {
    const std::vector<Point_3> points = {{500000.123, 5000000.456, 0.1},
                                         {500000.123 + size, 5000000.456, -size},
                                         {500000.123 + size / 3, 5000000.456 + size / 7, 0}};
    Point_table table(points);
    table.add_property<std::uint16_t>("intensity", {1, 2, 3});
    table.add_property<std::uint8_t>("red", {1, 2, 3});
    pcs::IO::write_points(path("a.las"), table);
    const Point_table again = pcs::IO::read_points(path("a.las"));
    BOOST_TEST(largest_distance(again, table) <= 1e-6 * size);
    BOOST_TEST((again.property<std::uint16_t>("intensity") == std::vector<std::uint16_t>{1, 2, 3}));
    BOOST_TEST((again.property<std::uint8_t>("red") == std::vector<std::uint8_t>{1, 2, 3}));
  }
}

BOOST_AUTO_TEST_CASE(colors_of_16_bits_choose_the_point_format_with_colors)
{
  Point_table table(std::vector<Point_3>{Point_3(1, 2, 3)});
  for (const char* name : {"red", "green", "blue"})
    table.add_property<std::uint16_t>(name, {65535});
  pcs::IO::write_points(path("a.las"), table);
  BOOST_TEST(int(content("a.las")[104]) == 7);
}

BOOST_AUTO_TEST_CASE(the_grid_moves_when_points_leave_it)
{
  Point_table table = read("a.las", Las_file().bytes());
  for (Point_3& p : table.points())
    p = Point_3(p.x() + 1e9, p.y(), p.z());
  pcs::IO::write_points(path("b.las"), table);
  const Point_table again = pcs::IO::read_points(path("b.las"));
  BOOST_TEST(again.schema().las->scale[0] == 0.001);
  BOOST_TEST(largest_distance(again, table) <= 0.001);
  table.points()[0] = Point_3(-1e9, 0, 0); // too far from the others for 0.001
  BOOST_CHECK_THROW(pcs::IO::write_points(path("c.las"), table), IO_error);
  BOOST_TEST(!std::filesystem::exists(path("c.las")));
}

BOOST_AUTO_TEST_CASE(chunks_of_other_points_need_a_grid)
{
  const Point_table table(std::vector<Point_3>{Point_3(1, 2, 3)});
  BOOST_CHECK_THROW(Point_writer(path("a.las"), table.schema()), Invalid_input);
  Write_options options;
  options.las_scale = {0.01, 0.01, 0.01};
  options.las_offset = {0, 0, 0};
  Point_writer writer(path("a.las"), table.schema(), options);
  writer.append(table);
  writer.append(table);
  writer.commit();
  BOOST_TEST((pcs::IO::read_points(path("a.las")).points()[1] == Point_3(1, 2, 3)));
  Point_writer far(path("b.las"), table.schema(), options);
  BOOST_CHECK_THROW(far.append(Point_table(std::vector<Point_3>{Point_3(1e9, 0, 0)})),
                    Invalid_input);
}

BOOST_AUTO_TEST_CASE(values_that_do_not_fit_their_bits_are_refused)
{
  Point_table table = read("a.las", Las_file().bytes());
  table.replace_property<std::uint8_t>("return_number", {1, 2, 8});
  BOOST_CHECK_THROW(pcs::IO::write_points(path("b.las"), table), Invalid_input);
  table.replace_property<double>("return_number", {1, 2, 3}); // other types are valid, too
  pcs::IO::write_points(path("b.las"), table);
  BOOST_TEST(int(pcs::IO::read_points(path("b.las")).property<std::uint8_t>("return_number")[2]) ==
             3);
}

BOOST_AUTO_TEST_CASE(las_survives_a_detour_through_ply)
{
  const Point_table table = read("a.las", rich_file(10).bytes());
  pcs::IO::write_points(path("a.ply"), table);
  BOOST_TEST(are_equal(pcs::IO::read_points(path("a.ply")), table));
}

BOOST_AUTO_TEST_CASE(zero_points_are_written)
{
  pcs::IO::write_points(path("a.las"), Point_table());
  BOOST_TEST(pcs::IO::read_points(path("a.las")).number_of_points() == 0u);
}

BOOST_AUTO_TEST_CASE(a_grid_that_is_not_finite_is_refused)
{
  const Point_table table(std::vector<Point_3>{Point_3(1, 2, 3)});
  const double infinity = std::numeric_limits<double>::infinity();
  Write_options options;
  options.las_offset = {0, 0, 0};
  for (const double scale : {0., infinity, std::nan("")}) {
    options.las_scale = {0.01, 0.01, scale};
    BOOST_CHECK_EXCEPTION(Point_writer(path("a.las"), table.schema(), options),
                          Invalid_input,
                          pcs_test::message_has("las_scale must be finite and not zero"));
  }
  options.las_scale = {0.01, 0.01, 0.01};
  options.las_offset = {0, infinity, 0};
  BOOST_CHECK_EXCEPTION(Point_writer(path("a.las"), table.schema(), options),
                        Invalid_input,
                        pcs_test::message_has("las_offset must be finite"));
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_CASE(properties_that_las_cannot_describe_are_refused)
{
  Point_table table(std::vector<Point_3>{Point_3(1, 2, 3)});
  table.add_property<float>(std::string(32, 'a'), {1});
  pcs::IO::write_points(path("a.las"), table);
  BOOST_TEST(pcs::IO::read_points(path("a.las")).has_property(std::string(32, 'a')));
  table.add_property<float>(std::string(33, 'a'), {1});
  BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("b.las"), table),
                        IO_error,
                        pcs_test::message_has("of more than 32 characters"));

  Point_table many(std::vector<Point_3>{Point_3(1, 2, 3)});
  for (int i = 0; i < 342; ++i) // a descriptor has 192 bytes, and all of them at most 65535
    many.add_property<std::uint8_t>("p" + std::to_string(i), {1});
  BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("b.las"), many),
                        IO_error,
                        pcs_test::message_has("there are too many properties for LAS"));

  Las_file las;
  las.number_of_extra_bytes = 1;
  las.add_vlr("LASF_Spec", 4, extra_bytes_descriptor("tree_id", 5)); // four bytes
  Point_table wrong = read("c.las", las.bytes());
  wrong.add_property<float>("score", {1, 2, 3});
  BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("b.las"), wrong),
                        IO_error,
                        pcs_test::message_has("described wrongly, 'score' cannot be added"));
  BOOST_TEST(!std::filesystem::exists(path("b.las")));
}

BOOST_AUTO_TEST_CASE(points_farther_apart_than_numbers_reach_are_refused)
{
  const double far = std::numeric_limits<double>::max();
  const Point_table table(std::vector<Point_3>{Point_3(far, 0, 0), Point_3(-far, 0, 0)});
  BOOST_CHECK_EXCEPTION(pcs::IO::write_points(path("a.las"), table),
                        IO_error,
                        pcs_test::message_has("the points are too far apart for LAS"));
  BOOST_TEST(!std::filesystem::exists(path("a.las")));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_write_las

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading PLY files.

#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/read_points.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace test_read_ply {

using pcs::IO::Point_table;
using pcs::IO::Scalar_type;
using Point_3 = Point_table::Point_3;

namespace {

std::string header(const std::string& body, const std::string& storage = "ascii")
{
  return "ply\nformat " + storage + " 1.0\n" + body + "end_header\n";
}

const std::string xyz = "property double x\nproperty double y\nproperty double z\n";
const std::string one_vertex = "element vertex 1\n" + xyz;

//! One vertex with a value of each type, including lists, after a face element.
std::string binary_file(bool is_big)
{
  std::string bytes = header("element face 2\nproperty list uchar int vertex_indices\n"
                             "element vertex 2\nproperty int8 a\nproperty uchar b\n"
                             "property short c\nproperty uint16 d\nproperty list int16 double w\n"
                             "property int x\nproperty float y\nproperty float64 z\n"
                             "property uint e\nproperty int64 f\nproperty uint64 g\n"
                             "element edge 1\nproperty int from\nproperty int to\n",
                             is_big ? "binary_big_endian" : "binary_little_endian");
  for (int face = 0; face < 2; ++face) {
    put<std::uint8_t>(bytes, 3, is_big);
    for (std::int32_t i = 0; i < 3; ++i)
      put(bytes, i, is_big);
  }
  for (int vertex = 0; vertex < 2; ++vertex) {
    put<std::int8_t>(bytes, -128, is_big);
    put<std::uint8_t>(bytes, 255, is_big);
    put<std::int16_t>(bytes, -32768, is_big);
    put<std::uint16_t>(bytes, 65535, is_big);
    put<std::int16_t>(bytes, static_cast<std::int16_t>(vertex), is_big);
    for (int i = 0; i < vertex; ++i)
      put(bytes, 0.5, is_big);
    put<std::int32_t>(bytes, -7, is_big);
    put(bytes, 0.5f, is_big);
    put(bytes, 5000000.456, is_big);
    put<std::uint32_t>(bytes, 4294967295u, is_big);
    put<std::int64_t>(bytes, std::numeric_limits<std::int64_t>::min(), is_big);
    put<std::uint64_t>(bytes, std::numeric_limits<std::uint64_t>::max(), is_big);
  }
  put<std::int32_t>(bytes, 0, is_big);
  put<std::int32_t>(bytes, 1, is_big);
  return bytes;
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(read_ply, Temporary_files)

BOOST_AUTO_TEST_CASE(all_types_are_read_in_both_byte_orders)
{
  for (const bool is_big : {false, true}) {
    const Point_table table = read("a.ply", binary_file(is_big));
    BOOST_REQUIRE(table.number_of_points() == 2u);
    BOOST_TEST((table.points()[1] == Point_3(-7, 0.5, 5000000.456)));
    BOOST_TEST(
        (table.property_names() == std::vector<std::string>{"a", "b", "c", "d", "e", "f", "g"}));
    BOOST_TEST(int(table.property<std::int8_t>("a")[0]) == -128);
    BOOST_TEST(int(table.property<std::uint8_t>("b")[1]) == 255);
    BOOST_TEST(table.property<std::int16_t>("c")[1] == -32768);
    BOOST_TEST(table.property<std::uint16_t>("d")[1] == 65535);
    BOOST_TEST(table.property<std::uint32_t>("e")[1] == 4294967295u);
    BOOST_TEST(table.property<std::int64_t>("f")[1] == std::numeric_limits<std::int64_t>::min());
    BOOST_TEST(table.property<std::uint64_t>("g")[1] == std::numeric_limits<std::uint64_t>::max());
  }
}

BOOST_AUTO_TEST_CASE(every_truncated_binary_file_is_refused)
{
  const std::string whole = binary_file(false);
  for (std::size_t n = 0; n < whole.size(); ++n)
    BOOST_TEST(error("a.ply", whole.substr(0, n)) != "no error", "cut to " << n << " bytes");
}

BOOST_AUTO_TEST_CASE(every_truncated_ascii_file_is_refused)
{
  const std::string whole =
      header(one_vertex + "element face 1\nproperty list uchar int i\n") + "1 2.5 3\n3 0 1 2\n";
  BOOST_TEST(read("a.ply", whole.substr(0, whole.size() - 1)).number_of_points() == 1u);
  for (std::size_t n = 0; n + 1 < whole.size(); ++n)
    BOOST_TEST(error("a.ply", whole.substr(0, n)) != "no error", "cut to " << n << " bytes");
}

BOOST_AUTO_TEST_CASE(the_file_must_end_where_its_header_says)
{
  refuses("a.ply", binary_file(false) + "x", "expected the end of the file");
  refuses("a.ply", header(one_vertex) + "1 2 3\n4 5 6\n", "line 9: expected the end of the file");
  BOOST_TEST(read("a.ply", header(one_vertex) + "1 2 3\n \n\n").number_of_points() == 1u);
}

BOOST_AUTO_TEST_CASE(faces_and_lists_may_stand_in_front_of_the_points)
{
  const Point_table table =
      read("a.ply",
           header("element face 1\nproperty list uchar int i\nelement vertex 2\n"
                  "property list uchar float w\n" +
                  xyz + "property uchar label\n") +
               "3 0 1 0\n2 0.5 0.5 1 2 3 9\n0 4 5 6 8\n");
  BOOST_TEST((table.points()[1] == Point_3(4, 5, 6)));
  BOOST_TEST((table.property<std::uint8_t>("label") == std::vector<std::uint8_t>{9, 8}));
  BOOST_TEST((table.schema().warnings ==
              std::vector<std::string>{
                  "the list 'w' of the vertices is left out",
                  "the vertices of the mesh are read as points, its 1 faces are left out"}));
}

BOOST_AUTO_TEST_CASE(other_elements_are_named)
{
  const Point_table table =
      read("a.ply",
           header(one_vertex + "element camera 1\nproperty float f\nelement face 0\n"
                               "property list uchar int i\n") +
               "1 2 3\n35\n");
  BOOST_TEST((table.schema().warnings ==
              std::vector<std::string>{"the element 'camera' with 1 rows is left out"}));
  BOOST_TEST(read("b.ply", header(one_vertex) + "1 2 3\n").schema().warnings.empty());
}

BOOST_AUTO_TEST_CASE(windows_line_ends_are_legal)
{
  std::string text = header("comment a b\nobj_info c\n" + one_vertex) + "1 2 3\n";
  std::string crlf;
  for (const char c : text)
    crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  Point_table table = read("a.ply", crlf);
  BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2, 3)}));
  BOOST_TEST((table.comments() == std::vector<std::string>{"a b"}));
  BOOST_TEST((table.obj_info() == std::vector<std::string>{"c"}));
}

BOOST_AUTO_TEST_CASE(coordinates_of_mixed_and_integer_types_are_legal)
{
  const Point_table table =
      read("a.ply",
           header("element vertex 1\nproperty uchar z\nproperty int y\nproperty float x\n") +
               "1 -2 0.5\n");
  BOOST_TEST((table.points()[0] == Point_3(0.5, -2, 1)));
  BOOST_TEST(
      (table.schema().properties[0] == pcs::IO::Property_description{"z", Scalar_type::uint8}));
}

BOOST_AUTO_TEST_CASE(map_coordinates_are_exact)
{
  const Point_table table = read("a.ply", header(one_vertex) + "500000.123 5000000.456 100.001\n");
  BOOST_TEST((table.points()[0] == Point_3(500000.123, 5000000.456, 100.001)));
}

BOOST_AUTO_TEST_CASE(zero_points_are_legal)
{
  BOOST_TEST(read("a.ply", header("element vertex 0\n" + xyz)).number_of_points() == 0u);
}

BOOST_AUTO_TEST_CASE(counts_beyond_the_size_of_the_file_are_refused)
{
  for (const char* storage : {"ascii", "binary_little_endian", "binary_big_endian"})
    for (const char* count : {"4000000000", "18446744073709551615"})
      refuses("a.ply",
              header(std::string("element vertex ") + count + "\n" + xyz, storage),
              "line 7: element 'vertex' declares " + std::string(count) + " rows");
  refuses("a.ply",
          header("element vertex -5\n" + xyz),
          "line 3: expected 'element <name> <count>'");
  refuses("a.ply", header("element vertex 99999999999999999999\n" + xyz), "line 3");
}

BOOST_AUTO_TEST_CASE(lists_beyond_the_size_of_the_file_are_refused)
{
  const std::string body = one_vertex + "property list uint int w\n";
  std::string bytes = header(body, "binary_little_endian");
  bytes += std::string(24, '\0') + "\xff\xff\xff\xff";
  refuses("a.ply", bytes, "the list 'w'");
  refuses("a.ply", header(body) + "1 2 3 4294967295 1\n", "line 9");
  std::string negative = header(one_vertex + "property list int int w\n", "binary_little_endian");
  refuses("a.ply", negative + std::string(24, '\0') + "\xff\xff\xff\xff", "negative length");
}

BOOST_AUTO_TEST_CASE(coordinates_that_are_not_finite_are_refused)
{
  refuses("a.ply", header(one_vertex) + "1 nan 3\n", "line 8: point 0: expected a finite number");
  refuses("a.ply", header(one_vertex) + "1 2 -inf\n", "coordinate z");
  refuses("a.ply", header(one_vertex) + "1e400 2 3\n", "line 8");
  std::string bytes = header(one_vertex, "binary_little_endian");
  const std::size_t start = bytes.size();
  put(bytes, 1.0);
  put(bytes, std::numeric_limits<double>::quiet_NaN());
  put(bytes, 1.0);
  refuses("a.ply", bytes, "byte " + std::to_string(start) + ": point 0");
}

BOOST_AUTO_TEST_CASE(other_properties_may_be_not_finite)
{
  const Point_table table =
      read("a.ply", header(one_vertex + "property float w\n") + "1 2 3 nan\n");
  BOOST_TEST(std::isnan(table.property<float>("w")[0]));
}

BOOST_AUTO_TEST_CASE(malformed_headers_are_refused_with_their_line)
{
  refuses("a.ply", "", "the file is empty");
  refuses("a.ply", "solid\n", "line 1: expected 'ply'");
  refuses("a.ply", "ply\nformat ascii 1.0\n", "no 'end_header'");
  refuses("a.ply", "ply\n" + one_vertex + "end_header\n1 2 3\n", "expected a 'format' line");
  refuses("a.ply", header(one_vertex, "text") + "1 2 3\n", "line 2: expected 'ascii'");
  refuses("a.ply", "ply\nformat ascii 2.0\nend_header\n", "line 2: expected format version");
  refuses("a.ply", header("property float x\n"), "line 3: expected an 'element' line");
  refuses("a.ply", header("element face 0\n"), "expected an element 'vertex'");
  refuses("a.ply",
          header("element vertex 1\nproperty float128 x\n"),
          "line 4: expected a PLY type");
  refuses("a.ply",
          header("element vertex 1\nproperty list float int x\n"),
          "line 4: expected an integer");
  refuses("a.ply", header("element vertex 1\nproperty float\n"), "line 4: expected the name");
  refuses("a.ply",
          header(one_vertex + "property float x\n") + "1 2 3 4\n",
          "line 7: property 'x' is declared twice");
  refuses("a.ply", header("element vertex 0\nelement vertex 0\n"), "line 4");
  refuses("a.ply", header("element vertex\n"), "line 3");
  refuses("a.ply", header("elephant vertex 1\n"), "line 3: expected 'format'");
}

BOOST_AUTO_TEST_CASE(missing_coordinates_are_refused)
{
  refuses("a.ply",
          header("element vertex 1\nproperty float x\nproperty float y\n") + "1 2\n",
          "no scalar property 'z'");
  refuses("a.ply",
          header("element vertex 1\nproperty float q\n") + "1\n",
          "no scalar property 'x'");
  refuses("a.ply",
          header("element vertex 1\nproperty list uchar int x\nproperty float y\n"
                 "property float z\n") +
              "1 2 3 4\n",
          "no scalar property 'x'");
}

BOOST_AUTO_TEST_CASE(malformed_rows_are_refused_with_their_line)
{
  const std::string body = header(one_vertex + "property uchar label\n");
  refuses("a.ply", body + "1 2 3 256\n", "line 9: expected a number of type uint8 for 'label'");
  refuses("a.ply", body + "1 2 3 -1\n", "line 9");
  refuses("a.ply", body + "1 2 3 1.5\n", "line 9");
  refuses("a.ply", body + "1 2 3      \n", "line 9");
  refuses("a.ply", body + "1 2 3 4 5\n", "line 9: expected the end of the line");
  refuses("a.ply", body + "1,5 2 3 4\n", "decimal comma");
  refuses("a.ply", body + "0x10 2 3 4\n", "line 9");
  BOOST_TEST(int(read("a.ply", body + "+1 2. .5 4.0\n").property<std::uint8_t>("label")[0]) == 4);
}

BOOST_AUTO_TEST_CASE(the_content_decides_on_the_format)
{
  BOOST_TEST(read("a.txt", header(one_vertex) + "1 2 3\n").number_of_points() == 1u);
}

BOOST_AUTO_TEST_CASE(repeated_and_longer_header_lines_are_refused)
{
  refuses("a.ply",
          "ply\nformat ascii 1.0\nformat ascii 1.0\nend_header\n",
          "line 3: expected one 'format' line in front of all elements");
  refuses("a.ply",
          "ply\nformat ascii 1.0 now\nend_header\n",
          "line 2: expected the end of the line, found 'now'");
  refuses("a.ply",
          header("element vertex 1 2\n"),
          "line 3: expected the end of the line, found '2'");
  refuses("a.ply",
          header("element vertex 1\nproperty float x y\n"),
          "line 4: expected the end of the line, found 'y'");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_read_ply

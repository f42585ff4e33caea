// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading PCD, PTX and OBJ files.

#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/internal/scans/lzf.h>
#include <pcs/IO/write_points.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace test_read_scans {

using pcs::IO::Point_table;
using Point_3 = Point_table::Point_3;
using Points = std::vector<Point_3>;

BOOST_FIXTURE_TEST_SUITE(read_scans, Temporary_files)

// ---- PCD

//! The header of a file of `n` points with x, y, z, an integer and a packed colour.
std::string pcd_header(const std::string& encoding, int n)
{
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z id rgb\n"
         "SIZE 4 4 4 2 4\nTYPE F F F U F\nCOUNT 1 1 1 1 1\nWIDTH " +
         std::to_string(n) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(n) +
         "\nDATA " + encoding + "\n";
}

//! The bytes of two points, point by point or field by field.
std::string pcd_points(bool is_by_field, float first_x = 1)
{
  std::string bytes;
  const auto position = [&](int point, int axis) {
    put(bytes, point == 0 && axis == 0 ? first_x : static_cast<float>(3 * point + axis + 1));
  };
  const auto id = [&](int point) { put(bytes, static_cast<std::uint16_t>(7 + point)); };
  const auto color = [&](int) { put<std::uint32_t>(bytes, 0x00102030); };
  if (is_by_field) {
    for (int axis = 0; axis < 3; ++axis)
      for (int point = 0; point < 2; ++point)
        position(point, axis);
    for (int point = 0; point < 2; ++point)
      id(point);
    for (int point = 0; point < 2; ++point)
      color(point);
    return bytes;
  }
  for (int point = 0; point < 2; ++point) {
    for (int axis = 0; axis < 3; ++axis)
      position(point, axis);
    id(point);
    color(point);
  }
  return bytes;
}

//! LZF data without repetitions.
std::string lzf(const std::string& bytes)
{
  std::string result;
  for (std::size_t i = 0; i < bytes.size(); i += 32) {
    const std::string run = bytes.substr(i, 32);
    result += static_cast<char>(run.size() - 1);
    result += run;
  }
  return result;
}

std::string compressed_pcd(const std::string& data, std::size_t size)
{
  std::string bytes = pcd_header("binary_compressed", 2);
  put(bytes, static_cast<std::uint32_t>(data.size()));
  put(bytes, static_cast<std::uint32_t>(size));
  return bytes + data;
}

BOOST_AUTO_TEST_CASE(all_encodings_of_pcd_give_the_same_points)
{
  const std::string by_field = pcd_points(true);
  for (const std::string& bytes :
       {pcd_header("ascii", 2) + "1 2 3 7 1056816\n4 5 6 8 1.480915e-39\n",
        pcd_header("binary", 2) + pcd_points(false),
        compressed_pcd(lzf(by_field), by_field.size())}) {
    const Point_table table = read("a.pcd", bytes);
    BOOST_TEST((table.points() == Points{Point_3(1, 2, 3), Point_3(4, 5, 6)}));
    BOOST_TEST((table.property<std::uint16_t>("id") == std::vector<std::uint16_t>{7, 8}));
    BOOST_TEST(int(table.property<std::uint8_t>("red")[0]) == 0x10);
    BOOST_TEST(int(table.property<std::uint8_t>("green")[0]) == 0x20);
    BOOST_TEST(int(table.property<std::uint8_t>("blue")[0]) == 0x30);
    BOOST_TEST(are_equal(read("a.txt", bytes), table)); // identified by its first bytes
  }
}

BOOST_AUTO_TEST_CASE(pcd_points_without_return_are_left_out)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Point_table table = read("a.pcd", pcd_header("binary", 2) + pcd_points(false, nan));
  BOOST_TEST((table.points() == Points{Point_3(4, 5, 6)}));
  BOOST_TEST((table.property<std::uint16_t>("id") == std::vector<std::uint16_t>{8}));
  std::string many = pcd_header("ascii", 5001);
  for (int i = 0; i < 5000; ++i)
    many += "nan nan nan 0 0\n";
  BOOST_TEST((read("a.pcd", many + "1 2 3 4 0\n").points() == Points{Point_3(1, 2, 3)}));
  const float infinity = std::numeric_limits<float>::infinity();
  refuses("a.pcd", pcd_header("binary", 2) + pcd_points(false, infinity), "expected a finite");
}

BOOST_AUTO_TEST_CASE(pcd_fields_of_several_values_and_padding_are_read)
{
  const Point_table table = read("a.pcd",
                                 "FIELDS normal_x _ z y x f\nSIZE 4 1 8 8 8 4\nTYPE F U F F F I\n"
                                 "COUNT 1 3 1 1 1 2\nWIDTH 1\nHEIGHT 1\nDATA ascii\n"
                                 "0.5 9 9 9 3 2 1 -7 8\n");
  BOOST_TEST((table.points() == Points{Point_3(1, 2, 3)}));
  BOOST_TEST((table.property_names() == std::vector<std::string>{"nx", "f_0", "f_1"}));
  BOOST_TEST(table.property<std::int32_t>("f_0")[0] == -7);
}

BOOST_AUTO_TEST_CASE(damaged_pcd_files_are_refused)
{
  const std::string binary = pcd_header("binary", 2) + pcd_points(false);
  for (std::size_t n = 1; n < binary.size(); ++n)
    BOOST_TEST(error("a.pcd", binary.substr(0, n)) != "no error", "cut to " << n << " bytes");
  const std::string by_field = pcd_points(true);
  const std::string compressed = compressed_pcd(lzf(by_field), by_field.size());
  for (std::size_t n = 1; n < compressed.size(); ++n)
    BOOST_TEST(error("a.pcd", compressed.substr(0, n)) != "no error", "cut to " << n << " bytes");
  refuses("a.pcd", binary + "x", "expected the end of the file, found 1 more bytes");
  refuses("a.pcd", compressed_pcd(lzf(by_field), 1), "expected 2 points of 18 bytes");
  std::string short_data = lzf(by_field);
  short_data.back() = '\0';
  short_data.pop_back();
  refuses("a.pcd", compressed_pcd(short_data, by_field.size()), "the compressed data are damaged");
  refuses("a.pcd", pcd_header("ascii", 1) + "1.5 2.5 3.5 4\n", "line 12: expected a number");
  refuses("a.pcd", pcd_header("ascii", 1) + "1 2 3 4 5 6\n", "line 12: expected the end of the");
  refuses("a.pcd", pcd_header("ascii", 1) + "1 2 3 70000 5\n", "which is out of range");
  refuses("a.pcd", pcd_header("ascii", 2000000000) + "1 2 3 4 5\n", "too small for 2000000000");
  refuses("a.pcd", pcd_header("text", 1), "expected the encoding ascii, binary or");
  refuses("a.pcd", "FIELDS x y\nSIZE 4 4\nTYPE F F\nWIDTH 0\nDATA ascii\n", "'z' is missing");
  refuses("a.pcd", "FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nWIDTH 0\nDATA ascii\n", "unknown type");
  refuses("a.pcd",
          "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 3\nHEIGHT 2\nPOINTS 5\nDATA ascii\n",
          "differs from width times height");
}

BOOST_AUTO_TEST_CASE(lzf_repetitions_are_bounded)
{
  using Bytes = std::vector<unsigned char>;
  const auto decompresses = [](const Bytes& from, const Bytes& expected) {
    Bytes to(expected.size());
    return pcs::IO::internal::decompress_lzf(from, to) && to == expected;
  };
  BOOST_TEST(decompresses({0, 'a', 1 << 5, 0}, Bytes(4, 'a')));        // overlapping
  BOOST_TEST(decompresses({0, 'a', 7 << 5, 255, 0}, Bytes(265, 'a'))); // the longest repetition
  BOOST_TEST(decompresses({1, 'a', 'b', 1 << 5, 1}, {'a', 'b', 'a', 'b', 'a'}));
  BOOST_TEST(!decompresses({0, 'a', 1 << 5, 1}, Bytes(4, 'a'))); // before the beginning
  BOOST_TEST(!decompresses({0, 'a', 2 << 5, 0}, Bytes(4, 'a'))); // too long
  BOOST_TEST(!decompresses({0, 'a'}, Bytes(2, 'a')));            // too short
  BOOST_TEST(!decompresses({1, 'a'}, Bytes(2, 'a')));            // truncated within a run
  BOOST_TEST(!decompresses({0, 'a', 1 << 5}, Bytes(4, 'a')));    // truncated within a repetition
  BOOST_TEST(!decompresses({0, 'a', 7 << 5}, Bytes(10, 'a')));
}

// ---- PTX

std::string ptx_header(int columns, int rows, const std::string& matrix)
{
  return std::to_string(columns) + "\n" + std::to_string(rows) + "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" +
         matrix;
}

const char* const identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
// x to y, y to -x, and a translation
const char* const rotation = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";

BOOST_AUTO_TEST_CASE(the_matrix_of_every_ptx_scan_is_applied)
{
  const std::string bytes = ptx_header(2, 1, identity) + "1 2 3 0.5\n0 0 0 0.5\n" +
                            ptx_header(0, 7, identity) + ptx_header(1, 2, rotation) +
                            "1 2 3 0.25\n4 5 6 1\n";
  const Point_table table = read("a.ptx", bytes);
  BOOST_TEST((table.points() == Points{Point_3(1, 2, 3), Point_3(8, 21, 33), Point_3(5, 24, 36)}));
  BOOST_TEST((table.property<double>("intensity") == std::vector<double>{0.5, 0.25, 1}));
  BOOST_TEST((table.property<std::int32_t>("scan") == std::vector<std::int32_t>{0, 2, 2}));
  pcs::IO::Point_reader reader(path("a.ptx"));
  Point_table chunk;
  Points points;
  while (reader.read(chunk, 1))
    points.insert(points.end(), chunk.points().begin(), chunk.points().end());
  BOOST_TEST((points == table.points()));
}

BOOST_AUTO_TEST_CASE(ptx_colors_are_read)
{
  const Point_table table = read("a.ptx", ptx_header(1, 1, identity) + "1 2 3 0.5 255 128 0\n");
  BOOST_TEST(int(table.property<std::uint8_t>("red")[0]) == 255);
  BOOST_TEST(int(table.property<std::uint8_t>("green")[0]) == 128);
}

BOOST_AUTO_TEST_CASE(damaged_ptx_files_are_refused)
{
  const std::string head = ptx_header(1, 2, identity);
  refuses("a.ptx", head + "1 2 3 4\n", "too small for a scan of 1 columns and 2 rows");
  refuses("a.ptx", head + "1 2 3 0.5000000\n", "more data was expected");
  refuses("a.ptx", head + "1 2 3 4\n1 2 3 4 5\n", "line 12: expected 4 columns, found 5");
  refuses("a.ptx", head + "1 2 3 4\n1 2 3 4\n1 2 3 4\n", "expected the number of columns");
  refuses("a.ptx", head + "1 2 3 4\n1 nan 3 4\n", "line 12: point 1: expected a finite number");
  refuses("a.ptx", head + "1 2 3 4\n1 2 3 4\n5\n", "more data was expected");
  refuses("a.ptx",
          ptx_header(1, 1, "1 0 0 5\n0 1 0 5\n0 0 1 5\n0 0 0 1\n") + "1 2 3 4\n",
          "the last column 0 0 0 1");
  refuses("a.ptx", ptx_header(2000000000, 2000000000, identity) + "1 2 3 4\n", "too small");
  refuses("a.ptx", "1 2 3\n4 5 6\n", "line 1: expected the number of columns of a scan");
}

// ---- OBJ

BOOST_AUTO_TEST_CASE(obj_vertices_are_read_and_faces_are_counted)
{
  const Point_table table = read("a.obj",
                                 "# mesh\nmtllib a.mtl\nv 1 2 3 # a\nvn 0 0 1\nv\t4 5 6#b\nvt 0 0\n"
                                 "f 1 2 1\nf 1//1 2//1 1//1\n");
  BOOST_TEST((table.points() == Points{Point_3(1, 2, 3), Point_3(4, 5, 6)}));
  BOOST_TEST(table.property_names().empty());
  BOOST_TEST((table.schema().warnings ==
              std::vector<std::string>{
                  "the vertices of the mesh are read as points, its 2 faces are left out"}));
  const Point_table colors = read("a.obj", "v 1 2 3 0.5 0.25 1\n");
  BOOST_TEST(colors.property<double>("green")[0] == 0.25);
  BOOST_TEST(colors.schema().warnings.empty());
  BOOST_TEST(read("a.obj", "v 1 2 3 0.5\n").property<double>("weight")[0] == 0.5);
}

BOOST_AUTO_TEST_CASE(damaged_obj_files_are_refused)
{
  refuses("a.obj", "# nothing\n", "expected vertices");
  refuses("a.obj", "v 1 2\n", "line 1: expected v x y z");
  refuses("a.obj", "v 1 2 3\nv 1 2\n", "line 2: expected a number");
  refuses("a.obj", "v 1 2 3\nv 1 2 3 4\n", "line 2: expected 3 numbers as in the first vertex");
  refuses("a.obj", "v 1 2 nan\n", "line 1: point 0: expected a finite number");
}

BOOST_AUTO_TEST_CASE(these_formats_are_not_written)
{
  const Point_table table = read("a.xyz", "1 2 3\n");
  for (const char* name : {"b.pcd", "b.ptx"})
    BOOST_CHECK_THROW(pcs::IO::write_points(path(name), table), pcs::IO_error);
  BOOST_TEST(number_of_files() == 1u);
}

BOOST_AUTO_TEST_CASE(all_integer_types_of_pcd_are_read)
{
  const Point_table table = read("a.pcd",
                                 "FIELDS x y z a b c d\nSIZE 4 4 4 1 1 8 8\nTYPE F F F I U I U\n"
                                 "WIDTH 1\nHEIGHT 1\nDATA ascii\n"
                                 "1 2 3 -128 255 -9007199254740993 18446744073709551615\n");
  BOOST_TEST(int(table.property<std::int8_t>("a")[0]) == -128);
  BOOST_TEST(int(table.property<std::uint8_t>("b")[0]) == 255);
  BOOST_TEST(table.property<std::int64_t>("c")[0] == -9007199254740993);
  BOOST_TEST(table.property<std::uint64_t>("d")[0] == std::numeric_limits<std::uint64_t>::max());
}

BOOST_AUTO_TEST_CASE(inconsistent_pcd_headers_are_refused)
{
  refuses("a.pcd",
          "FIELDS x y z x\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 0\nDATA ascii\n",
          "the field 'x' is there twice");
  refuses("a.pcd", "VERSION 0.7\nWIDTH 0\nDATA ascii\n", "expected the line FIELDS before DATA");
  for (const char* lines :
       {"SIZE 4 4\nTYPE F F F\n", "SIZE 4 4 4\nTYPE F F\n", "SIZE 4 4 4\nTYPE F F F\nCOUNT 1 1\n"})
    refuses("a.pcd",
            std::string("FIELDS x y z\n") + lines + "WIDTH 0\nDATA ascii\n",
            "as many words in the lines SIZE, TYPE and COUNT as in FIELDS");
  for (const char* lines : {"SIZE 4 4 2\nTYPE F F F\n", "SIZE 4 4 4\nTYPE F F X\n"})
    refuses("a.pcd",
            std::string("FIELDS x y z\n") + lines + "WIDTH 0\nDATA ascii\n",
            "unknown type");
  refuses("a.pcd", pcd_header("ascii", 2) + "1 2 3 4 5\n          \n", "more data was expected");
}

BOOST_AUTO_TEST_CASE(malformed_ptx_lines_are_refused_with_their_line)
{
  refuses("a.ptx", "2\n1\n0 0 0\n", "more data was expected");
  refuses("a.ptx", "2\n1\n0 0\n", "line 3: expected 3 numbers, the position of the scanner");
  refuses("a.ptx", "2\n1\n0 0 0 7\n", "line 3: expected the end of the line, found '7'");
  refuses("a.ptx", "2\n1\n0 0 0\n1 0 inf\n", "line 4: expected 3 numbers, an axis of the scanner");
  refuses("a.ptx",
          ptx_header(1, 1, "1 0 0 x\n0 1 0 0\n0 0 1 0\n0 0 0 1\n") + "1 2 3 4\n",
          "line 7: expected 4 numbers, a row of the matrix");
  refuses("a.ptx", ptx_header(1, 1, identity) + "1.5 2.5\n", "colours, found 2 columns");
  refuses("a.ptx", ptx_header(1, 1, identity) + "1 2 3 much\n", "line 11: expected a number");
  refuses("a.ptx", ptx_header(1, 1, identity) + "      \n", "more data was expected");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_read_scans

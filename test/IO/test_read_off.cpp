// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading OFF files.

#include "temporary_files.h"

#include <boost/test/unit_test.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace test_read_off {

using pcs::IO::Point_table;
using pcs::IO::Scalar_type;
using Point_3 = Point_table::Point_3;

BOOST_FIXTURE_TEST_SUITE(read_off, Temporary_files)

BOOST_AUTO_TEST_CASE(points_are_read_and_faces_are_skipped)
{
  for (const char* text : {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1.5 0\n3 0 1 2\n",
                           "OFF 3 1 0\r\n\r\n0 0 0\r\n1 0 0\r\n0 1.5 0\r\n3 0 1 2 255 0 0\r\n",
                           "off\n3 1\n0 0 0\n1 0 0\n0 1.5 0\n3 0 1 2\n", // without the edges
                           "# comment\nOFF\n# more\n3 1 0\n0 0 0 # a\n1 0 0\n0 1.5 0\n3 0 1 2"}) {
    const Point_table table = read("a.off", text);
    BOOST_REQUIRE(table.number_of_points() == 3u);
    BOOST_TEST((table.points()[2] == Point_3(0, 1.5, 0)));
    BOOST_TEST(table.schema().warnings.size() == 1u);
  }
  BOOST_TEST(read("a.off", "OFF\n1 0 0\n1 2 3\n").schema().warnings.empty());
}

BOOST_AUTO_TEST_CASE(normals_and_colors_become_properties)
{
  const Point_table normals = read("a.off", "NOFF\n1 0 0\n1 2 3 0 0 1\n");
  BOOST_TEST((normals.normals()[0] == Point_table::Vector_3(0, 0, 1)));
  const Point_table bytes = read("a.off", "COFF\n1 0 0\n1 2 3 255 128 0\n");
  BOOST_TEST(int(bytes.property<std::uint8_t>("green")[0]) == 128);
  const Point_table reals = read("a.off", "CNOFF\n1 0 0\n1 2 3 0 0 1 0.5 1.0 0.0 1.0\n");
  BOOST_TEST(reals.property<double>("red")[0] == 0.5);
  BOOST_TEST(reals.property<double>("alpha")[0] == 1);
  BOOST_TEST(reals.has_normals());
}

BOOST_AUTO_TEST_CASE(other_kinds_are_refused_by_name)
{
  for (const char* keyword : {"STOFF", "4OFF", "nOFF", "STCNOFF", "4nOFF"})
    refuses("a.off",
            std::string(keyword) + "\n1 0 0\n1 2 3 4 5\n",
            "found '" + std::string(keyword) + "', which is not supported");
  refuses("a.off", "OFF BINARY\n", "line 1");
  refuses("a.off", "FFO\n1 0 0\n1 2 3\n", "expected 'OFF'");
}

BOOST_AUTO_TEST_CASE(counts_are_checked)
{
  refuses("a.off", "OFF\n4000000000 0 0\n1 2 3\n", "line 2: the file is too small");
  refuses("a.off", "OFF\n18446744073709551615 0 0\n1 2 3\n", "line 2");
  refuses("a.off", "OFF\n1 4000000000 0\n1 2 3\n", "line 2");
  refuses("a.off", "OFF\n-3 0 0\n1 2 3\n", "line 2: expected the numbers");
  refuses("a.off", "OFF\n1\n1 2 3\n", "line 2");
  refuses("a.off", "OFF\n1 0 0\n1 2 3\n4 5 6\n", "line 4: expected the end of the file");
}

BOOST_AUTO_TEST_CASE(malformed_lines_are_refused)
{
  refuses("a.off", "OFF\n1 0 0\n1 2     \n", "line 3");
  refuses("a.off", "OFF\n1 0 0\n1 2 3 4\n", "line 3: expected the end of the line");
  refuses("a.off", "OFF\n1 0 0\n1 2 nan\n", "line 3: point 0");
  refuses("a.off", "OFF\n3 1 0\n1 2 3\n1 2 3\n1 2 3\n3 0 1 3\n", "line 6: expected the index");
  refuses("a.off", "OFF\n3 1 0\n1 2 3\n1 2 3\n1 2 3\n9 0 1 2\n", "line 6");
  refuses("a.off", "COFF\n2 0 0\n1 2 3 0 0 0\n1 2 3 256 0 0\n", "line 4");
  refuses("a.off",
          "COFF\n2 0 0\n1 2 3 1 1 1\n1 2 3 0.5 0 0\n",
          "found '0.5'; write the colours of the first vertex with decimal points");
}

BOOST_AUTO_TEST_CASE(every_truncated_file_is_refused)
{
  const std::string whole = "NOFF\n2 1 0\n1 2 3 0 0 1\n4 5 6 0 0 1\n3 0 1 0\n";
  BOOST_TEST(read("a.off", whole.substr(0, whole.size() - 1)).number_of_points() == 2u);
  for (std::size_t n = 0; n + 1 < whole.size(); ++n)
    BOOST_TEST(error("a.off", whole.substr(0, n)) != "no error", "cut to " << n << " bytes");
}

BOOST_AUTO_TEST_CASE(zero_points_are_legal)
{
  for (const char* keyword : {"OFF", "NOFF", "COFF"})
    BOOST_TEST(read("a.off", std::string(keyword) + "\n0 0 0\n").number_of_points() == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_read_off

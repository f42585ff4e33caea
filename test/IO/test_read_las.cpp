// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading LAS files.

#include "las_file.h"
#include "temporary_files.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace test_read_las {

using pcs::IO::Point_table;
using Point_3 = Point_table::Point_3;

BOOST_FIXTURE_TEST_SUITE(read_las, Temporary_files)

BOOST_AUTO_TEST_CASE(all_point_formats_are_read)
{
  for (unsigned format = 0; format <= 10; ++format) {
    Las_file las;
    las.format = format;
    las.minor = format < 4 ? 2 : format < 6 ? 3 : 4;
    const Point_table table = read("a.las", las.bytes());
    BOOST_REQUIRE(table.number_of_points() == 3u);
    BOOST_TEST((table.points()[1] ==
                Point_3(124 * 0.001 + 500000.0, 457 * 0.001 + 5000000.0, -788 * 0.001 + 500000.0)));
    BOOST_TEST(table.property<std::uint16_t>("intensity")[0] == 0x0201);
    BOOST_TEST(table.has_property("gps_time") == (format != 0 && format != 2));
    BOOST_TEST(table.has_property("near_infrared") == (format == 8 || format == 10));
    BOOST_TEST(table.has_property("wave_x_t") ==
               (format == 4 || format == 5 || format == 9 || format == 10));
  }
}

BOOST_AUTO_TEST_CASE(bits_are_where_the_specification_puts_them)
{
  Las_file las;
  std::string bytes = las.bytes();
  bytes[227 + 14] = static_cast<char>(0b10'101'011); // edge, direction, returns, return
  bytes[227 + 15] = static_cast<char>(0b101'00110);  // withheld, key point, synthetic, class
  const Point_table old_table = read("a.las", bytes);
  const auto value = [](const Point_table& table, const char* name) {
    return int(table.property<std::uint8_t>(name)[0]);
  };
  BOOST_TEST(value(old_table, "return_number") == 3);
  BOOST_TEST(value(old_table, "number_of_returns") == 5);
  BOOST_TEST(value(old_table, "scan_direction_flag") == 0);
  BOOST_TEST(value(old_table, "edge_of_flight_line") == 1);
  BOOST_TEST(value(old_table, "classification") == 6);
  BOOST_TEST(value(old_table, "synthetic") == 1);
  BOOST_TEST(value(old_table, "key_point") == 0);
  BOOST_TEST(value(old_table, "withheld") == 1);

  las.format = 7;
  las.minor = 4;
  bytes = las.bytes();
  bytes[375 + 14] = static_cast<char>(0xA7);
  bytes[375 + 15] = static_cast<char>(0b0110'1010);
  patch<std::int16_t>(bytes, 375 + 18, -15000);
  patch(bytes, 375 + 22, 1.25e9);
  patch<std::uint16_t>(bytes, 375 + 34, 65535);
  const Point_table table = read("a.las", bytes);
  BOOST_TEST(value(table, "return_number") == 7);
  BOOST_TEST(value(table, "number_of_returns") == 10);
  BOOST_TEST(value(table, "key_point") == 1);
  BOOST_TEST(value(table, "overlap") == 1);
  BOOST_TEST(value(table, "scanner_channel") == 2);
  BOOST_TEST(value(table, "scan_direction_flag") == 1);
  BOOST_TEST(value(table, "edge_of_flight_line") == 0);
  BOOST_TEST(table.property<std::int16_t>("scan_angle")[0] == -15000);
  BOOST_TEST(table.property<double>("gps_time")[0] == 1.25e9);
  BOOST_TEST(table.property<std::uint16_t>("blue")[0] == 65535);
}

BOOST_AUTO_TEST_CASE(extra_bytes_are_named_where_they_are_described)
{
  Las_file las;
  las.number_of_extra_bytes = 9;
  las.add_vlr("LASF_Spec",
              4,
              extra_bytes_descriptor("tree id", 3) + extra_bytes_descriptor("", 0, 2) +
                  extra_bytes_descriptor("height", 9));
  const Point_table table = read("a.las", las.bytes());
  BOOST_TEST(table.property<std::uint16_t>("tree_id")[0] == 0x0A09); // bytes 9 and 10
  BOOST_TEST(int(table.property<std::uint8_t>("extra_byte_2")[0]) == 11);
  BOOST_TEST(int(table.property<std::uint8_t>("extra_byte_8")[0]) == 17);
  BOOST_TEST((table.property_type("height") == pcs::IO::Scalar_type::float32));
}

BOOST_AUTO_TEST_CASE(extra_bytes_without_description_are_kept)
{
  Las_file las;
  las.number_of_extra_bytes = 3;
  const Point_table table = read("a.las", las.bytes());
  BOOST_TEST(int(table.property<std::uint8_t>("extra_byte_2")[1]) == 22);
}

BOOST_AUTO_TEST_CASE(every_truncated_file_is_refused)
{
  Las_file las;
  las.format = 6;
  las.minor = 4;
  las.add_vlr("someone", 1, "abc");
  las.add_evlr("someone", 2, "defg");
  const std::string whole = las.bytes();
  BOOST_TEST(read("a.las", whole).number_of_points() == 3u);
  for (std::size_t n = 0; n < whole.size(); ++n)
    BOOST_TEST(error("a.las", whole.substr(0, n)) != "no error", "cut to " << n << " bytes");
}

BOOST_AUTO_TEST_CASE(malformed_headers_are_refused_with_their_byte)
{
  const auto broken = [](std::size_t at, auto value) {
    std::string bytes = Las_file().bytes();
    patch(bytes, at, value);
    return bytes;
  };
  refuses("a.las", broken(25, std::uint8_t(5)), "byte 24: expected LAS version");
  refuses("a.las", broken(94, std::uint16_t(100)), "byte 94");
  refuses("a.las", broken(96, std::uint32_t(100)), "byte 96");
  refuses("a.las", broken(96, std::uint32_t(4000000000u)), "byte 96");
  refuses("a.las", broken(100, std::uint32_t(1)), "variable length record 0 of 1");
  refuses("a.las", broken(104, std::uint8_t(11)), "byte 104: expected a point format");
  refuses("a.las", broken(105, std::uint16_t(19)), "byte 105: expected point records");
  refuses("a.las", broken(107, std::uint32_t(4294967295u)), "byte 107: the file is too small");
  refuses("a.las", broken(107, std::uint32_t(2)), "expected the end of the file, found 20 more");
  refuses("a.las", broken(131, 0.0), "byte 131: expected a scale factor");
  refuses("a.las", broken(139, std::numeric_limits<double>::quiet_NaN()), "byte 139");
  refuses("a.las", broken(155, HUGE_VAL), "byte 155: expected a finite offset");
  refuses("a.las", broken(131, 1e308), "point 0: expected a finite number");
  refuses("a.las", "1 2 3\n", "expected 'LASF'");
}

BOOST_AUTO_TEST_CASE(long_counts_and_records_are_checked)
{
  Las_file las;
  las.format = 6;
  las.minor = 4;
  std::string bytes = las.bytes();
  patch<std::uint64_t>(bytes, 247, std::numeric_limits<std::uint64_t>::max());
  refuses("a.las", bytes, "byte 247: the file is too small");
  bytes = las.bytes();
  patch<std::uint32_t>(bytes, 107, 2);
  refuses("a.las", bytes, "the two numbers of points differ");
  las.add_evlr("someone", 1, "abc");
  bytes = las.bytes();
  patch<std::uint64_t>(bytes, bytes.size() - 63 + 20, 1u << 31);
  refuses("a.las", bytes, "longer than the file");
  bytes = las.bytes();
  patch<std::uint64_t>(bytes, 235, 1);
  refuses("a.las", bytes, "after the points");
}

BOOST_AUTO_TEST_CASE(waveforms_lie_after_the_points_and_inside_the_file)
{
  Las_file las;
  las.format = 4;
  las.minor = 3;
  std::string bytes = las.bytes();
  BOOST_TEST(read("a.las", bytes).number_of_points() == 3u);
  const std::string waves = bytes + "waves";
  patch<std::uint64_t>(bytes, 227, 1);
  refuses("a.las", bytes, "byte 227: expected the waveforms after the points and inside the file");
  patch<std::uint64_t>(bytes, 227, bytes.size() + 1);
  refuses("a.las", bytes, "byte 227: expected the waveforms after the points and inside the file");
  refuses("a.las", waves, "expected the end of the file, found 5 more bytes");
  std::string whole = waves;
  patch<std::uint64_t>(whole, 227, bytes.size());
  BOOST_TEST(read("a.las", whole).number_of_points() == 3u);
}

BOOST_AUTO_TEST_CASE(headers_shorter_than_their_version_are_refused)
{
  for (const unsigned minor : {3u, 4u}) {
    Las_file las;
    las.minor = minor;
    std::string bytes = las.bytes();
    patch<std::uint16_t>(bytes, 94, 227);
    refuses("a.las",
            bytes,
            "byte 94: expected a header of at least " + std::to_string(las.header_size()) +
                " bytes, found 227");
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_read_las

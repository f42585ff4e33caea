// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading LAZ files, with and without LASzip.

#include "las_file.h"
#include "temporary_files.h"
#include <pcs/IO/internal/las/laszip_point.h>
#include <pcs/IO/write_points.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <string>

namespace test_read_laz {

BOOST_FIXTURE_TEST_SUITE(read_laz, Temporary_files)

#ifdef PCS_WITH_LASZIP

//! Compresses a LAS file of three points with LASzip.
void compress(const std::string& from, const std::string& to)
{
  laszip_POINTER reader = nullptr, writer = nullptr;
  laszip_BOOL is_compressed = 0;
  laszip_header_struct* header = nullptr;
  laszip_point_struct* point = nullptr;
  BOOST_REQUIRE(laszip_create(&reader) == 0);
  BOOST_REQUIRE(laszip_create(&writer) == 0);
  BOOST_REQUIRE(laszip_open_reader(reader, from.c_str(), &is_compressed) == 0);
  BOOST_REQUIRE(laszip_get_header_pointer(reader, &header) == 0);
  BOOST_REQUIRE(laszip_get_point_pointer(reader, &point) == 0);
  BOOST_REQUIRE(laszip_request_native_extension(writer, 1) == 0);
  BOOST_REQUIRE(laszip_set_header(writer, header) == 0);
  BOOST_REQUIRE(laszip_open_writer(writer, to.c_str(), 1) == 0);
  for (int i = 0; i < 3; ++i) {
    BOOST_REQUIRE(laszip_read_point(reader) == 0);
    BOOST_REQUIRE(laszip_set_point(writer, point) == 0);
    BOOST_REQUIRE(laszip_write_point(writer) == 0);
  }
  BOOST_REQUIRE(laszip_close_writer(writer) == 0);
  BOOST_REQUIRE(laszip_close_reader(reader) == 0);
  laszip_destroy(writer);
  laszip_destroy(reader);
}

Las_file las_file(unsigned format)
{
  Las_file las;
  las.format = format;
  las.minor = format < 4 ? 2 : format < 6 ? 3 : 4;
  return las;
}

BOOST_AUTO_TEST_CASE(all_point_formats_have_the_values_of_the_las_file)
{
  for (unsigned format = 0; format <= 10; ++format)
    for (const std::size_t number_of_extra_bytes : {0u, 3u}) {
      Las_file las = las_file(format);
      las.number_of_extra_bytes = number_of_extra_bytes;
      if (number_of_extra_bytes > 0)
        las.add_vlr("LASF_Spec",
                    4,
                    extra_bytes_descriptor("id", 3) + extra_bytes_descriptor("b", 1));
      const pcs::IO::Point_table expected = read("a.las", las.bytes());
      compress(path("a.las"), path("a.laz"));
      const pcs::IO::Point_table table = pcs::IO::read_points(path("a.laz"));
      BOOST_TEST(are_equal(table, expected), "point format " << format);
      BOOST_TEST(table.has_property("id") == (number_of_extra_bytes > 0));
      // Without the record that describes the compression.
      pcs::IO::write_points(path("b.las"), table);
      BOOST_TEST(are_equal(pcs::IO::read_points(path("b.las")), expected));
      BOOST_TEST(content("b.las").find("laszip encoded") == std::string::npos);
    }
}

BOOST_AUTO_TEST_CASE(damaged_files_are_refused)
{
  file("a.las", las_file(1).bytes());
  compress(path("a.las"), path("a.laz"));
  const std::string bytes = content("a.laz");
  std::string more = bytes;
  patch<std::uint32_t>(more, 107, 4000000000u);
  refuses("a.laz", more, "cannot be decompressed");
  refuses("a.laz", bytes.substr(0, bytes.size() - 40), "cannot be decompressed");
  std::string unmarked = bytes;
  unmarked.replace(unmarked.find("laszip encoded"), 6, "notzip");
  refuses("a.laz", unmarked, "there is no record of LASzip");
}

#else

BOOST_AUTO_TEST_CASE(without_laszip_the_message_names_programs_that_convert)
{
  std::string bytes = Las_file().bytes();
  patch<std::uint8_t>(bytes, 104, 128 + 1);
  for (const char* name : {"a.las", "a.laz"}) {
    refuses(name, bytes, "the points are compressed (LAZ)");
    refuses(name, bytes, "liblaszip-dev");
    refuses(name, bytes, "laszip -i a.laz -o a.las");
    refuses(name, bytes, "pdal translate a.laz a.las");
  }
}

#endif

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_read_laz

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading whole files and chunks, in all formats.

#include "las_file.h"
#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <list>
#include <string>
#include <vector>

namespace test_read_points {

using pcs::IO::Point_reader;
using pcs::IO::Point_table;
using Point_3 = Point_table::Point_3;

namespace {

Point_table many_points(std::size_t n)
{
  std::vector<Point_3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const auto t = static_cast<double>(i);
    points.emplace_back(500000 + t / 7, 5000000 - t / 3, t * t);
  }
  Point_table table(points);
  table.set_normals(std::vector<Point_table::Vector_3>(n, {0, 0, 1}));
  return table;
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(read_points, Temporary_files)

BOOST_AUTO_TEST_CASE(chunks_together_are_the_whole_file)
{
  const Point_table table = many_points(10007);
  for (const char* name : {"a.ply", "a.csv", "a.off", "a.las"}) {
    pcs::IO::write_points(path(name), table);
    const Point_table whole = pcs::IO::read_points(path(name));
    for (const std::size_t size : {1000u, 10006u, 10007u, 20000u}) {
      Point_reader reader(path(name));
      Point_table all(reader.schema()), chunk;
      while (reader.read(chunk, size)) {
        BOOST_TEST(chunk.number_of_points() <= size);
        all.append(chunk);
      }
      BOOST_TEST(chunk.number_of_points() == 0u);
      BOOST_TEST(!reader.read(chunk, size));
      BOOST_TEST(are_equal(all, whole), name << " in chunks of " << size);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_number_of_points_is_known_up_front_except_for_text)
{
  const Point_table table = many_points(10);
  for (const char* name : {"a.ply", "a.off", "a.las"}) {
    pcs::IO::write_points(path(name), table);
    BOOST_TEST(Point_reader(path(name)).number_of_points().value() == 10u);
  }
  BOOST_TEST(!Point_reader(file("a.xyz", "1 2 3\n")).number_of_points().has_value());
}

BOOST_AUTO_TEST_CASE(the_end_of_the_file_is_checked_with_the_last_point)
{
  Point_reader reader(file("a.off", "OFF\n2 0 0\n1 2 3\n4 5 6\nmore\n"));
  Point_table chunk;
  BOOST_TEST(reader.read(chunk, 1));
  BOOST_CHECK_THROW(reader.read(chunk, 1), pcs::IO_error);
  BOOST_TEST(chunk.number_of_points() == 0u);
  BOOST_CHECK_THROW(reader.read(chunk, 1), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(a_chunk_of_no_points_is_refused)
{
  Point_reader reader(file("a.xyz", "1 2 3\n"));
  Point_table chunk;
  BOOST_CHECK_THROW(reader.read(chunk, 0), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(points_of_any_kernel_are_appended)
{
  const std::string name = file("a.xyz", "0.1 2 3\n4 5 6\n");
  std::vector<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3> epick(1);
  pcs::IO::read_points(name, epick);
  BOOST_TEST(epick.size() == 3u);
  BOOST_TEST(epick[1].x() == 0.1);
  std::list<CGAL::Simple_cartesian<float>::Point_3> floats;
  pcs::IO::read_points(name, floats);
  BOOST_TEST(floats.front().x() == 0.1f);
}

BOOST_AUTO_TEST_CASE(a_bad_file_leaves_the_points_untouched)
{
  std::string text;
  for (int i = 0; i < 70000; ++i) // more than one chunk
    text += "1 2 3\n";
  std::vector<Point_3> points(2, Point_3(7, 8, 9));
  BOOST_CHECK_THROW(pcs::IO::read_points(file("a.xyz", text + "1 2\n"), points), pcs::IO_error);
  BOOST_TEST((points == std::vector<Point_3>(2, Point_3(7, 8, 9))));
}

BOOST_AUTO_TEST_CASE(coordinates_too_large_for_float_are_refused)
{
  std::vector<CGAL::Simple_cartesian<float>::Point_3> points;
  BOOST_CHECK_THROW(pcs::IO::read_points(file("a.xyz", "1 2 1e300\n"), points), pcs::IO_error);
  BOOST_TEST(points.empty());
}

BOOST_AUTO_TEST_CASE(missing_files_and_folders_are_refused)
{
  BOOST_CHECK_THROW(pcs::IO::read_points(path("absent.ply")), pcs::IO_error);
  BOOST_CHECK_THROW(pcs::IO::read_points(folder.string()), pcs::IO_error);
  BOOST_CHECK_THROW(pcs::IO::read_points("/dev/zero"), pcs::IO_error);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_read_points

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of writing LAZ files, with and without LASzip.

#include "las_file.h"
#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>

#include <boost/test/unit_test.hpp>

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace test_write_laz {

using pcs::IO_error;
using pcs::IO::Point_reader;
using pcs::IO::Point_table;
using pcs::IO::Point_writer;
using Point_3 = Point_table::Point_3;

namespace {

//! A scan with the properties that the programs add; more points than LASzip has in a chunk.
[[maybe_unused]] Point_table labelled_scan(std::size_t n = 70000)
{
  std::mt19937 random(7);
  std::vector<Point_3> points;
  std::vector<std::int32_t> branch, tree;
  std::vector<std::uint8_t> leaf;
  std::vector<float> residual;
  std::vector<double> nx;
  std::vector<std::uint16_t> intensity;
  for (std::size_t i = 0; i < n; ++i) {
    const auto number = [&] { return static_cast<double>(random() % 100000) / 1000; };
    points.emplace_back(500000 + number(), 5000000 + number(), number());
    branch.push_back(static_cast<std::int32_t>(random() % 1000) - 1);
    tree.push_back(static_cast<std::int32_t>(random()));
    leaf.push_back(static_cast<std::uint8_t>(random() % 2));
    residual.push_back(static_cast<float>(number()));
    nx.push_back(number() / 3);
    intensity.push_back(static_cast<std::uint16_t>(random()));
  }
  Point_table table(std::move(points));
  table.add_property("branch", branch);
  table.add_property("tree", tree);
  table.add_property("leaf", leaf);
  table.add_property("residual", residual);
  table.add_property("nx", nx);
  table.add_property("intensity", intensity);
  return table;
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(write_laz, Temporary_files)

#ifdef PCS_WITH_LASZIP

BOOST_AUTO_TEST_CASE(las_survives_a_detour_through_laz_byte_by_byte)
{
  for (unsigned format = 0; format <= 10; ++format)
    for (const std::size_t number_of_extra_bytes : {0u, 7u}) {
      Las_file las;
      las.format = format;
      las.minor = format < 4 ? 2 : format < 6 ? 3 : 4;
      las.number_of_extra_bytes = number_of_extra_bytes;
      las.add_vlr("LASF_Projection", 2112, "somewhere");
      if (number_of_extra_bytes > 0)
        las.add_vlr("LASF_Spec", 4, extra_bytes_descriptor("tree_id", 5));
      las.vlrs += "padding before the points";
      if (las.minor == 4)
        las.add_evlr("someone", 9, "appendix");
      const Point_table table = read("a.las", las.bytes());
      pcs::IO::write_points(path("b.las"), table);
      pcs::IO::write_points(path("b.laz"), table);
      const Point_table again = pcs::IO::read_points(path("b.laz"));
      BOOST_TEST(are_equal(again, table), "point format " << format);
      BOOST_TEST(content("b.laz").find("laszip encoded") != std::string::npos);
      pcs::IO::write_points(path("c.las"), again);
      BOOST_TEST((content("c.las") == content("b.las")), "point format " << format);
    }
}

BOOST_AUTO_TEST_CASE(labels_of_other_points_are_extra_bytes)
{
  const Point_table table = labelled_scan();
  pcs::IO::write_points(path("a.las"), table);
  pcs::IO::write_points(path("a.laz"), table);
  const Point_table las = pcs::IO::read_points(path("a.las"));
  const Point_table laz = pcs::IO::read_points(path("a.laz"));
  BOOST_TEST(are_equal(laz, las));
  BOOST_TEST((laz.property<std::int32_t>("branch") == table.property<std::int32_t>("branch")));
  BOOST_TEST((laz.property<double>("nx") == table.property<double>("nx")));
  BOOST_TEST(laz.schema().las->scale == las.schema().las->scale);
  BOOST_TEST(laz.schema().las->offset == las.schema().las->offset);
  BOOST_TEST(content("a.laz").size() < content("a.las").size());
}

BOOST_AUTO_TEST_CASE(chunks_and_files_without_points_are_written)
{
  pcs::IO::write_points(path("a.las"), labelled_scan());
  Point_reader reader(path("a.las"));
  Point_writer writer(path("a.laz"), reader.schema());
  for (Point_table chunk; reader.read(chunk, 999);)
    writer.append(chunk);
  BOOST_TEST(!std::filesystem::exists(path("a.laz")));
  writer.commit();
  const Point_table las = pcs::IO::read_points(path("a.las"));
  BOOST_TEST(are_equal(pcs::IO::read_points(path("a.laz")), las));
  pcs::IO::write_points(path("a.laz"), las.select({}));
  BOOST_TEST(pcs::IO::read_points(path("a.laz")).number_of_points() == 0u);
  BOOST_TEST(number_of_files() == 2u);
}

BOOST_AUTO_TEST_CASE(without_commit_nothing_is_left_behind)
{
  pcs::IO::write_points(path("a.las"), labelled_scan(100));
  const Point_table table = pcs::IO::read_points(path("a.las"));
  file("b.laz", "old");
  {
    Point_writer writer(path("b.laz"), table.schema());
    writer.append(table);
  }
  BOOST_TEST(content("b.laz") == "old");
  BOOST_TEST(number_of_files() == 2u);
}

BOOST_AUTO_TEST_CASE(a_full_disk_is_an_error_and_leaves_nothing_behind)
{
  const Point_table table = labelled_scan();
  pcs::IO::write_points(path("a.laz"), table);
  const std::string whole = content("a.laz");
  std::filesystem::remove(path("a.laz"));
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  BOOST_REQUIRE(getrlimit(RLIMIT_FSIZE, &old) == 0);
  // within the head, within the points, before the last bytes
  for (const std::size_t size : {std::size_t(100), whole.size() / 2, whole.size() - 1}) {
    const rlimit small{static_cast<rlim_t>(size), old.rlim_max};
    std::string message;
    BOOST_REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    try {
      pcs::IO::write_points(path("a.laz"), table);
    } catch (const IO_error& e) {
      message = e.what();
    }
    BOOST_REQUIRE(setrlimit(RLIMIT_FSIZE, &old) == 0);
    BOOST_TEST(message.find("a.laz: cannot be written: File too large") != std::string::npos,
               "limit " << size << ": " << message);
    BOOST_TEST(number_of_files() == 0u);
  }
  std::signal(SIGXFSZ, before);
  pcs::IO::write_points(path("a.laz"), table);
  BOOST_TEST((content("a.laz") == whole)); // the same bytes each time
}

BOOST_AUTO_TEST_CASE(cut_files_are_refused)
{
  pcs::IO::write_points(path("a.laz"), labelled_scan(1000));
  const std::string whole = content("a.laz");
  for (std::size_t n = 0; n + 1 < whole.size(); n += n < 1000 ? 1 : 997)
    BOOST_TEST(error("b.laz", whole.substr(0, n)) != "no error", "cut to " << n << " bytes");
}

#else

BOOST_AUTO_TEST_CASE(without_laszip_the_message_names_programs_that_convert)
{
  const Point_table table = read("a.las", Las_file().bytes());
  try {
    pcs::IO::write_points(path("b.laz"), table);
    BOOST_TEST(false);
  } catch (const IO_error& e) {
    const std::string message = e.what();
    for (const char* part :
         {"liblaszip-dev", "laszip -i a.las -o a.laz", "pdal translate a.las a.laz"})
      BOOST_TEST(message.find(part) != std::string::npos, part);
  }
  BOOST_TEST(number_of_files() == 1u);
}

#endif

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_write_laz

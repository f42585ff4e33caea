// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading files that are compressed by gzip, with and without zlib.

#include "las_file.h"
#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/read_cylinders.h>
#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_tree_csv.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/IO/write_tree_csv.h>
#include <pcs/IO/write_tree_tables.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#ifdef PCS_WITH_ZLIB
#include <zlib.h>
#endif

namespace test_gzip {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point_3 = pcs::IO::Point_table::Point_3;
using Files = std::vector<std::pair<std::string, std::string>>; // name and content

BOOST_FIXTURE_TEST_SUITE(gzip, Temporary_files)

#ifdef PCS_WITH_ZLIB

//! Compresses bytes to a gzip file of one member.
std::string packed(const std::string& bytes)
{
  z_stream stream{};
  BOOST_REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string result(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  std::string input = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  BOOST_REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

std::string small_ply(const std::string& count = "3")
{
  return "ply\nformat ascii 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar label\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "1 2 3 4\n5 6 7 8\n9 10 11 12\n3 0 1 2\n";
}

//! LAS with VLRs before and EVLRs behind the points, which are read in three steps.
std::string las_bytes()
{
  Las_file las;
  las.format = 6;
  las.minor = 4;
  las.add_vlr("LASF_Projection", 2112, "some coordinate system");
  las.add_evlr("LASF_Projection", 2112, std::string(300000, 'w'));
  return las.bytes();
}

Files point_files(const Temporary_files& files)
{
  const pcs::IO::Point_table table =
      files.read("in.ply", small_ply()); // also as binary PLY of both byte orders
  Files result = {{"a.ply", small_ply()},
                  {"a.las", las_bytes()},
                  {"a.off", "OFF\n3 1 0\n1 2 3\n4 5 6\n7 8 9\n3 0 1 2\n"},
                  {"a.obj", "v 1 2 3\nv 4 5 6\nv 7 8 9\nf 1 2 3\n"},
                  {"a.xyz", "1 2 3\n4 5 6\n"},
                  {"a.csv", "label,x,y,z\n1,2,3,4\n5,6,7,8\n"},
                  {"a.pts", "2\n1 2 3 9\n4 5 6 8\n"},
                  {"a.pcd",
                   "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                   "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n"},
                  {"a.ptx",
                   "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
                   "1 2 3 0.5\n4 5 6 0.5\n"}};
  for (const auto encoding :
       {pcs::IO::Ply_encoding::binary_little_endian, pcs::IO::Ply_encoding::binary_big_endian}) {
    pcs::IO::Write_options options;
    options.ply_encoding = encoding;
    pcs::IO::write_points(files.path("binary.ply"), table, options);
    result.emplace_back("binary_" + std::to_string(result.size()) + ".ply",
                        files.content("binary.ply"));
  }
  return result;
}

//! The nodes of a tree as text, to compare trees.
std::string swc_of(const Temporary_files& files, const Tree& tree)
{
  pcs::IO::write_swc(files.path("tree.swc"), tree);
  return files.content("tree.swc");
}

BOOST_AUTO_TEST_CASE(every_point_file_has_the_same_points_packed)
{
  for (const auto& [name, bytes] : point_files(*this)) {
    const pcs::IO::Point_table expected = read(name, bytes);
    std::shared_ptr<pcs::IO::Mesh_faces> faces, packed_faces;
    pcs::IO::read_points(path(name), faces);
    const std::size_t n = number_of_files();
    const pcs::IO::Point_table table = read(name + ".gz", packed(bytes));
    BOOST_TEST(number_of_files() == n + 1u, name); // nothing is unpacked to a file
    BOOST_TEST(expected.number_of_points() > 1u, name);
    BOOST_TEST(are_equal(table, expected), name);
    pcs::IO::read_points(path(name + ".gz"), packed_faces);
    BOOST_TEST((faces == nullptr) == (packed_faces == nullptr), name);
    if (faces && packed_faces)
      BOOST_TEST(faces->vertices == packed_faces->vertices, name);
    if (expected.schema().las) {
      BOOST_TEST(table.schema().las->vlrs == expected.schema().las->vlrs);
      BOOST_TEST(table.schema().las->tail == expected.schema().las->tail);
    }
    BOOST_TEST(are_equal(read("unnamed_" + name, packed(bytes)), expected), name); // by content
  }
}

BOOST_AUTO_TEST_CASE(every_skeleton_file_has_the_same_tree_packed)
{
  const Tree tree = pcs_test::make_small_tree<Kernel>();
  const std::string expected = swc_of(*this, tree);
  Tree copy;
  pcs::IO::read_swc<Kernel>(file("a.swc.gz", packed(expected)), copy);
  BOOST_TEST(swc_of(*this, copy) == expected);

  pcs::IO::write_tree_csv<Kernel>(path("a.csv"), tree, std::vector<std::size_t>(8, 1));
  std::vector<std::size_t> hits;
  pcs::IO::read_tree_csv<Kernel>(file("a.csv.gz", packed(content("a.csv"))), copy, hits);
  BOOST_TEST(swc_of(*this, copy) == expected);

  Tree plain;
  pcs::IO::write_cylinders(path("c.csv"), tree);
  pcs::IO::read_cylinders<Kernel>(path("c.csv"), plain);
  const std::string name = file("c.csv.gz", packed(content("c.csv")));
  BOOST_TEST(pcs::IO::is_cylinder_table(name));
  pcs::IO::read_cylinders<Kernel>(name, copy);
  BOOST_TEST(swc_of(*this, copy) == swc_of(*this, plain));

  pcs::IO::read_txtskl<Kernel>(
      file("a.txtskl.gz", packed("1\nLayer 0\n1\n-1 -1\n2\n0 0 0 0.1\n0 1 0 0.1\n")),
      copy);
  BOOST_TEST(num_vertices(copy) == 2u);
}

BOOST_AUTO_TEST_CASE(members_follow_each_other)
{
  const std::string two = packed("1 2 3\n4 5") + packed("") + packed(" 6\n7 8 9\n");
  BOOST_TEST(read("a.xyz.gz", two).points()[1] == Point_3(4, 5, 6));
  BOOST_TEST(read("a.xyz.gz", two).number_of_points() == 3u);
  BOOST_TEST(read("a.xyz.gz", two + std::string(1000, '\0')).number_of_points() == 3u);
  refuses("a.xyz.gz", two + "more", "expected the end of the file or further gzip data");
  refuses("a.xyz.gz", two + '\0' + packed("1 2 3\n"), "expected the end of the file");
  refuses("a.xyz.gz", two + packed("1 2 3\n").substr(0, 12), "the file may be incomplete");
}

BOOST_AUTO_TEST_CASE(cut_files_are_refused)
{
  for (const auto& [name, bytes] : point_files(*this)) {
    const std::string whole = packed(bytes);
    for (std::size_t n = 0; n < whole.size(); ++n)
      BOOST_TEST(error(name + ".gz", whole.substr(0, n)) != "no error",
                 name << " cut to " << n << " bytes");
    refuses(name + ".gz",
            whole.substr(0, whole.size() - 1),
            "the data end before they are complete; the file may be incomplete, copy it again");
  }
}

BOOST_AUTO_TEST_CASE(damaged_files_are_refused)
{
  const std::string plain = "1.25 2.5 3.75\n4 5 6\n7 8 9\n", whole = packed(plain);
  const pcs::IO::Point_table expected = read("a.xyz", plain);
  std::size_t number_of_readable = 0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      try {
        // The content does not depend on all bits: the header has a time, the end has padding.
        BOOST_TEST(are_equal(read("a.xyz.gz", damaged), expected), "bit " << bit << " of " << i);
        ++number_of_readable;
      } catch (const pcs::IO_error&) {
      }
    }
  BOOST_TEST(number_of_readable < 64u);
  std::string sum = whole;
  sum[whole.size() - 8] = static_cast<char>(sum[whole.size() - 8] ^ 1);
  refuses("a.xyz.gz", sum, "(incorrect data check); copy the file again, gzip -t FILE checks it");
  sum = whole;
  sum[whole.size() - 1] = static_cast<char>(sum[whole.size() - 1] ^ 1);
  refuses("a.xyz.gz", sum, "(incorrect length check)");
}

BOOST_AUTO_TEST_CASE(counts_are_compared_with_the_unpacked_size)
{
  refuses("a.ply.gz",
          packed(small_ply("4000000000")),
          "declares 4000000000 rows, more than the 35 bytes");
  refuses("a.pts.gz", packed("4000000000\n1 2 3\n"), "line 1: the file is too small");
  refuses("a.off.gz", packed("OFF\n4000000000 1 0\n"), "the file is too small");
  std::string las = Las_file().bytes();
  patch<std::uint32_t>(las, 107, 4000000000u);
  refuses("a.las.gz", packed(las), "byte 107 of the unpacked file: the file is too small");
  // 64 MB of one line in 64 KB
  const std::string bomb = packed(std::string(std::size_t(1) << 26, '1'));
  BOOST_TEST(bomb.size() < 100000u);
  refuses("a.xyz.gz", bomb, "is longer than");
}

BOOST_AUTO_TEST_CASE(large_files_are_read_in_chunks)
{
  std::string text; // far more than all buffers
  for (int i = 0; i < 200000; ++i)
    text += std::to_string(i * 7919 % 100003) + " 2 " + std::to_string(i) + "\n";
  const pcs::IO::Point_table expected = read("a.xyz", text);
  pcs::IO::write_points(path("a.ply"), expected);
  pcs::IO::write_points(path("a.las"), expected);
  for (const char* name : {"a.xyz", "a.ply", "a.las"}) {
    const pcs::IO::Point_table whole = pcs::IO::read_points(path(name));
    pcs::IO::Point_reader reader(file("p.gz." + std::string(name), packed(content(name))));
    pcs::IO::Point_table chunk;
    std::size_t n = 0, number_of_errors = 0;
    for (; reader.read(chunk, 7777); n += chunk.number_of_points())
      for (std::size_t i = 0; i < chunk.number_of_points(); ++i)
        number_of_errors += chunk.points()[i] == whole.points()[n + i] ? 0 : 1;
    BOOST_TEST(n == 200000u);
    BOOST_TEST(number_of_errors == 0u);
  }
}

BOOST_AUTO_TEST_CASE(the_format_is_that_of_the_content_or_of_the_name_without_gz)
{
  BOOST_TEST(read("a.XYZ.GZ", packed("1 2 3\n")).number_of_points() == 1u);
  BOOST_TEST(read("scan.gz", packed(small_ply())).number_of_points() == 3u);
  BOOST_TEST(read("a.ply.gz", small_ply()).number_of_points() == 3u); // is not packed
  refuses("scan.gz", packed("1 2 3\n"), "a name without extension");
  refuses("a.e57.gz", packed("ASTM-E57"), "pdal translate a.e57 a.las");
  refuses("a.xyz.gz", packed(""), "the file is empty");
  refuses("a.xyz.gz", packed(packed("1 2 3\n")), "line 1");
}

BOOST_AUTO_TEST_CASE(packed_laz_is_refused)
{
  std::string bytes = Las_file().bytes();
  patch<std::uint8_t>(bytes, 104, 128 + 1);
  refuses("a.laz.gz",
          packed(bytes),
          "a LAZ file inside a gzip file is not read; unpack the file: gunzip -k FILE");
}

BOOST_AUTO_TEST_CASE(commands_in_messages_unpack_the_file)
{
  std::string rows = "x y z kind\n";
  for (int i = 0; i < 1001; ++i)
    rows += "1 2 3 4\n";
  refuses("a.txt.gz", packed(rows + "1 2 3 wood\n"), "}1' <(gunzip -c FILE) > NEW_FILE");
  refuses("a.txt.gz", packed("1 2 3\nnan 2 3\n"), "<(gunzip -c FILE) > NEW_FILE");
}

#else

BOOST_AUTO_TEST_CASE(without_zlib_the_message_names_how_to_unpack)
{
  const std::string bytes = "\x1f\x8b\x08 and more";
  for (const char* name : {"a.xyz.gz", "a.ply", "a"}) {
    refuses(name, bytes, "zlib1g-dev");
    refuses(name, bytes, "gunzip -k FILE");
  }
}

#endif

BOOST_AUTO_TEST_CASE(packed_files_are_not_written)
{
  const Tree tree = pcs_test::make_small_tree<Kernel>();
  const pcs::IO::Point_table table(std::vector<Point_3>{Point_3(1, 2, 3)});
  pcs::IO::Write_options ply;
  ply.format = pcs::IO::File_format::ply;
  const auto refuses_output = [&](const auto& write) {
    try {
      write();
      BOOST_TEST(false);
    } catch (const pcs::IO_error& e) {
      BOOST_TEST(std::string(e.what()).find("compress it: gzip FILE") != std::string::npos);
    }
  };
  refuses_output([&] { pcs::IO::write_points(path("a.ply.gz"), table); });
  refuses_output([&] { pcs::IO::write_points(path("a.gz"), table, ply); });
  refuses_output([&] { pcs::IO::write_swc(path("a.swc.GZ"), tree); });
  refuses_output([&] { pcs::IO::write_cylinders(path("a.csv.gz"), tree); });
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_gzip

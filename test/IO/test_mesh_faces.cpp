// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading and writing faces of meshes, and of lists and other elements of PLY files.

#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace test_mesh_faces {

using pcs::Invalid_input;
using pcs::IO_error;
using pcs::IO::Element_rows;
using pcs::IO::Mesh_faces;
using pcs::IO::Ply_encoding;
using pcs::IO::Point_reader;
using pcs::IO::Point_table;
using pcs::IO::Point_writer;
using pcs::IO::Scalar_type;
using pcs::IO::Write_options;

using Ends = std::vector<std::uint64_t>;
using Indices = std::vector<std::uint32_t>;
using Texts = std::vector<std::string>;

namespace {

// a triangle and a quadrangle
const std::string off_mesh = "OFF\n4 2 0\n0.5 0 0\n1 0 0\n1 1 0\n0 1 0.25\n3 0 1 2\n4 3 2 1 0\n";

// lists of the vertices, further values of the faces, and other elements on both sides
const std::string ply_mesh = "ply\nformat ascii 1.0\nelement camera 2\nproperty float f\n"
                             "property list uchar short q\nelement face 2\nproperty uchar red\n"
                             "property list uchar int vertex_index\n"
                             "property list uchar float texcoord\nelement vertex 4\n"
                             "property float x\nproperty list uchar int w\nproperty float y\n"
                             "property float z\nproperty uchar label\nelement edge 1\n"
                             "property int vertex1\nproperty int vertex2\nend_header\n"
                             "1.5 2 7 -8\n2 0\n9 3 0 1 2 6 0 0 1 0 0 1\n8 4 3 2 1 0 0\n"
                             "0.5 1 5 0 0 7\n1 0 0 0 8\n1 2 1 2 1 0 9\n0 0 1 0.25 6\n0 3\n";

struct Mesh
{
  Point_table points;
  std::shared_ptr<Mesh_faces> faces;
};

struct Mesh_files : Temporary_files
{
  Mesh read_mesh(const std::string& name) const
  {
    Mesh mesh;
    mesh.points = pcs::IO::read_points(path(name), mesh.faces);
    return mesh;
  }
  Mesh read_mesh(const std::string& name, const std::string& content) const
  {
    file(name, content);
    return read_mesh(name);
  }
  void write_mesh(const std::string& name,
                  const Mesh& mesh,
                  Ply_encoding encoding = Ply_encoding::binary_little_endian) const
  {
    Write_options options;
    options.faces = mesh.faces;
    options.ply_encoding = encoding;
    pcs::IO::write_points(path(name), mesh.points, options);
  }
  void refuses_mesh(const std::string& name,
                    const std::string& content,
                    const std::string& expected) const
  {
    std::string message = "no error";
    try {
      read_mesh(name, content);
    } catch (const IO_error& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(expected) != std::string::npos,
               "expected '" << expected << "' in '" << message << "'");
  }
};

void check_two_faces(const Mesh& mesh)
{
  BOOST_REQUIRE(mesh.faces != nullptr);
  BOOST_TEST(mesh.points.number_of_points() == 4u);
  BOOST_TEST(mesh.faces->number_of_vertices == 4u);
  BOOST_TEST((mesh.faces->ends == Ends{3, 7}));
  BOOST_TEST((mesh.faces->vertices == Indices{0, 1, 2, 3, 2, 1, 0}));
}

std::string ply_faces(const std::string& type, const std::string& rows, std::size_t n = 1)
{
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face " +
         std::to_string(n) + "\nproperty list uchar " + type +
         " vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n" + rows;
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(mesh_faces, Mesh_files)

// ---- the same mesh

BOOST_AUTO_TEST_CASE(faces_are_the_same_in_all_formats)
{
  const Mesh mesh = read_mesh("a.off", off_mesh);
  check_two_faces(mesh);
  BOOST_TEST(mesh.points.schema().warnings.empty());
  write_mesh("a.ply", mesh);
  write_mesh("a.obj", read_mesh("a.ply"));
  write_mesh("b.ply", read_mesh("a.obj"), Ply_encoding::ascii);
  write_mesh("c.ply", read_mesh("b.ply"), Ply_encoding::binary_big_endian);
  for (const char* name : {"a.ply", "a.obj", "b.ply", "c.ply"}) {
    check_two_faces(read_mesh(name));
    BOOST_TEST((read_mesh(name).points.points() == mesh.points.points()), name);
  }
  BOOST_TEST(content("a.obj") == "v 0.5 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.25\nf 1 2 3\nf 4 3 2 1\n");
  write_mesh("b.off", read_mesh("c.ply"));
  BOOST_TEST(content("b.off") == "OFF\n4 2 0\n0.5 0.0 0.0\n1.0 0.0 0.0\n1.0 1.0 0.0\n"
                                 "0.0 1.0 0.25\n3 0 1 2\n4 3 2 1 0\n");
}

BOOST_AUTO_TEST_CASE(ply_keeps_lists_and_other_elements_in_every_encoding)
{
  const Mesh mesh = read_mesh("a.ply", ply_mesh);
  check_two_faces(mesh);
  BOOST_TEST(mesh.points.schema().warnings.empty());
  BOOST_TEST(mesh.faces->elements.size() == 4u);
  std::string last = "a.ply";
  for (const Ply_encoding encoding :
       {Ply_encoding::binary_little_endian, Ply_encoding::binary_big_endian, Ply_encoding::ascii}) {
    const std::string next = "a" + std::to_string(int(encoding)) + ".ply";
    write_mesh(next, read_mesh(last), encoding);
    last = next;
  }
  BOOST_TEST(content(last) ==
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
             "property double z\nproperty uchar label\nproperty list uchar int w\n"
             "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\n"
             "property list uchar float texcoord\nelement camera 2\nproperty float f\n"
             "property list uchar short q\nelement edge 1\nproperty int vertex1\n"
             "property int vertex2\nend_header\n"
             "0.5 0 0 7 1 5\n1 0 0 8 0\n1 1 0 9 2 1 2\n0 1 0.25 6 0\n"
             "3 0 1 2 9 6 0 0 1 0 0 1\n4 3 2 1 0 8 0\n1.5 2 7 -8\n2 0\n0 3\n");
}

BOOST_AUTO_TEST_CASE(a_face_element_without_corners_is_kept_as_it_is)
{
  const std::string text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\n"
                           "property double y\nproperty double z\nelement face 2\n"
                           "property list uchar int strip\nend_header\n1 2 3\n2 0 -1\n0\n";
  const Mesh mesh = read_mesh("a.ply", text);
  BOOST_TEST(mesh.faces->number_of_faces() == 0u);
  write_mesh("b.ply", mesh, Ply_encoding::ascii);
  BOOST_TEST(content("b.ply") == text);
}

BOOST_AUTO_TEST_CASE(polygons_may_have_more_corners_than_a_byte_counts)
{
  std::string text = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n300";
  for (int i = 0; i < 300; ++i)
    text += " " + std::to_string(i % 3);
  write_mesh("a.ply", read_mesh("a.off", text));
  const Mesh mesh = read_mesh("a.ply");
  BOOST_TEST((mesh.faces->ends == Ends{300}));
  BOOST_TEST((mesh.faces->vertices == read_mesh("a.off").faces->vertices));
}

BOOST_AUTO_TEST_CASE(files_without_faces_have_none)
{
  BOOST_TEST(!read_mesh("a.off", "OFF\n1 0 0\n1 2 3\n").faces);
  BOOST_TEST(!read_mesh("a.obj", "v 1 2 3\n").faces);
  BOOST_TEST(!read_mesh("a.xyz", "1 2 3\n").faces);
  BOOST_TEST(!read_mesh("a.off", "OFF\n0 0 0\n").faces);
  check_two_faces(read_mesh("b.off", off_mesh)); // the former faces do not remain
}

BOOST_AUTO_TEST_CASE(what_is_left_out_is_named)
{
  const Mesh off = read_mesh("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255 0 0\n");
  BOOST_TEST((off.faces->warnings == Texts{"the colours of the faces are left out"}));
  const Mesh obj = read_mesh("a.obj", "o a\nv 0 0 0\nv 1 0 0\nvt 0 0\nv 1 1 0\nf 1/1 2/1 3/1\n");
  BOOST_TEST(
      (obj.points.schema().warnings == Texts{"the lines of the mesh with vt, o are left out"}));
}

BOOST_AUTO_TEST_CASE(obj_faces_have_all_their_forms)
{
  const Mesh mesh = read_mesh("a.obj",
                              "f 1 2/7 4//9 # before the vertices\nv 0 0 0\nv 1 0 0\nv 1 1 0\n"
                              "f -3/1/1 -2/-1 -1//2\r\nv 0 1 0\nf 1 2 \\\n 3 -1/5\nf -4 +2 3\n");
  BOOST_TEST((mesh.faces->ends == Ends{3, 6, 10, 13}));
  BOOST_TEST((mesh.faces->vertices == Indices{0, 1, 3, 0, 1, 2, 0, 1, 2, 3, 0, 1, 2}));
}

BOOST_AUTO_TEST_CASE(chunks_give_the_same_faces)
{
  for (const std::string name : {"a.ply", "a.off", "a.obj"}) {
    write_mesh(name, read_mesh("in.off", off_mesh));
    Point_reader reader(path(name), true);
    Point_table chunk;
    Mesh mesh;
    while (reader.read(chunk, 1))
      mesh.points.append(chunk);
    mesh.faces = reader.faces();
    check_two_faces(mesh);
    Write_options options;
    options.faces = mesh.faces;
    Point_writer writer(path("b" + name), mesh.points.schema(), options);
    for (std::size_t i = 0; i < 4; ++i)
      writer.append(mesh.points.select({i}));
    writer.commit();
    check_two_faces(read_mesh("b" + name));
  }
}

BOOST_AUTO_TEST_CASE(obj_stores_weights_and_colors)
{
  const std::string colors = "v 1 2 3 0.5 0.25 1\nv 4 5 6 0 0 0\n";
  pcs::IO::write_points(path("b.obj"), read("a.obj", colors));
  BOOST_TEST(content("b.obj") == colors);
  pcs::IO::write_points(path("b.obj"), read("a.obj", "v 1 2 3 0.5\n"));
  BOOST_TEST(content("b.obj") == "v 1 2 3 0.5\n");
  BOOST_CHECK_THROW(
      pcs::IO::write_points(path("b.obj"), read("a.off", "COFF\n1 0 0\n1 2 3 9 9 9\n")),
      IO_error);
  BOOST_CHECK_THROW(
      pcs::IO::write_points(path("b.obj"), read("a.off", "NOFF\n1 0 0\n1 2 3 0 0 1\n")),
      IO_error);
  BOOST_TEST(content("b.obj") == "v 1 2 3 0.5\n");
}

// ---- invalid faces

BOOST_AUTO_TEST_CASE(faces_of_less_than_three_vertices_are_refused)
{
  const std::string few =
      "face 0 has 2 vertices, expected 3 or more; remove it, or read the points";
  refuses_mesh("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n2 0 1\n", "line 6: " + few);
  refuses_mesh("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3: " + few);
  refuses_mesh("a.ply", ply_faces("int", "2 0 1\n"), "line 13: " + few);
  refuses_mesh("a.ply", ply_faces("int", "3 0 1 2\n0\n", 2), "line 14: face 1 has 0 vertices");
  BOOST_TEST(read("a.off", "OFF\n2 1 0\n0 0 0\n1 0 0\n2 0 1\n").number_of_points() == 2u);
}

BOOST_AUTO_TEST_CASE(indices_that_are_no_vertices_are_refused)
{
  const std::string vertices = "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n";
  for (const std::string face : {"3 0 1 3",
                                 "3 0 1 -1",
                                 "3 0 1 4000000000",
                                 "3 0 1",
                                 "3 0 1 x",
                                 "4000000000 0 1 2",
                                 "18446744073709551615 0 1 2"})
    refuses_mesh("a.off", vertices + face, "line 6: expected the index of a vertex");
  for (const std::string index : {"3", "-1", "2147483647"})
    refuses_mesh("a.ply",
                 ply_faces("int", "3 0 1 2\n3 0 1 " + index + "\n", 2),
                 "line 14: face 1: expected the index of a vertex, from 0, in a mesh of 3 "
                 "vertices, found " +
                     index);
  refuses_mesh("a.ply", ply_faces("int", "4000000000 0 1 2\n"), "line 13: expected a number");
  for (const std::string word : {"0", "4", "-4", "1/2/3/4", "1/a", "/1", "9999999999999999999999"})
    refuses_mesh("a.obj",
                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 " + word + "\n",
                 "line 4: face 0: expected the index of a vertex, from 1 to 3 or from -1 to -3, "
                 "found '" +
                     word + "'");
  refuses_mesh("a.obj", "f -1 1 1\nv 0 0 0\n", "line 1: face 0: expected the index of a vertex");
}

BOOST_AUTO_TEST_CASE(binary_faces_are_checked)
{
  const auto faces = [](auto length, std::vector<std::uint32_t> indices, const std::string& type) {
    std::string text = "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty char x\n"
                       "property char y\nproperty char z\nelement face 1\nproperty list " +
                       type + " uint vertex_indices\nend_header\nabc";
    put(text, length, true);
    for (const std::uint32_t i : indices)
      put(text, i, true);
    return text;
  };
  BOOST_TEST((read_mesh("a.ply", faces(std::uint8_t(3), {0, 0, 0}, "uchar")).faces->vertices ==
              Indices{0, 0, 0}));
  refuses_mesh("a.ply", faces(std::uint8_t(3), {0, 1, 0}, "uchar"), "found 1");
  refuses_mesh("a.ply", faces(std::uint8_t(3), {0, 4294967295u, 0}, "uchar"), "found 4294967295");
  refuses_mesh("a.ply", faces(std::uint8_t(2), {0, 0}, "uchar"), "face 0 has 2 vertices");
  refuses_mesh("a.ply", faces(std::uint32_t(4000000000u), {0, 0, 0}, "uint"), "the list");
  refuses_mesh("a.ply", faces(std::int32_t(-3), {0, 0, 0}, "int"), "negative length");
}

BOOST_AUTO_TEST_CASE(every_truncated_mesh_is_refused)
{
  const Mesh mesh = read_mesh("a.ply", ply_mesh);
  write_mesh("b.ply", mesh, Ply_encoding::binary_little_endian);
  for (const std::string& whole : {content("b.ply"), ply_mesh.substr(0, ply_mesh.size() - 1)})
    for (std::size_t n = 0; n < whole.size(); ++n) {
      file("c.ply", whole.substr(0, n));
      BOOST_CHECK_THROW(read_mesh("c.ply"), IO_error);
    }
  for (std::size_t n = 0; n + 1 < off_mesh.size(); ++n) {
    file("c.off", off_mesh.substr(0, n));
    BOOST_CHECK_THROW(read_mesh("c.off"), IO_error);
  }
}

BOOST_AUTO_TEST_CASE(lists_too_long_for_their_type_are_refused)
{
  std::string text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                     "property float z\nproperty list uchar int w\nend_header\n0 0 0 300";
  for (int i = 0; i < 300; ++i)
    text += " 1";
  refuses_mesh("a.ply",
               text,
               "line 9: the list 'w' has 300 entries, more than its type uint8 can count");
}

BOOST_AUTO_TEST_CASE(faces_that_do_not_fit_the_points_are_not_written)
{
  Mesh mesh = read_mesh("a.off", off_mesh);
  const Mesh valid{mesh.points, std::make_shared<Mesh_faces>(*mesh.faces)};
  for (const char* name : {"b.ply", "b.off", "b.obj"}) {
    Mesh other = valid;
    other.points = valid.points.select({0, 1, 2});
    BOOST_CHECK_THROW(write_mesh(name, other), Invalid_input);
    other.points = valid.points.select({0, 1, 2, 3, 3});
    BOOST_CHECK_THROW(write_mesh(name, other), Invalid_input);
    mesh.faces->vertices[6] = 4;
    BOOST_CHECK_THROW(write_mesh(name, mesh), Invalid_input);
    mesh.faces->vertices[6] = 0;
    for (const Ends& ends : {Ends{2, 7}, Ends{3, 8}, Ends{3, 6}, Ends{7, 3}, Ends{3}}) {
      mesh.faces->ends = ends;
      BOOST_CHECK_THROW(write_mesh(name, mesh), Invalid_input);
    }
    mesh.faces->ends = valid.faces->ends;
  }
  for (const char* name : {"b.xyz", "b.las"})
    BOOST_CHECK_THROW(write_mesh(name, valid), IO_error);
  BOOST_TEST(number_of_files() == 1u);
}

BOOST_AUTO_TEST_CASE(elements_that_do_not_fit_are_not_written)
{
  const Mesh mesh = read_mesh("a.off", off_mesh);
  const Element_rows valid{"camera", 1, {{"w", Scalar_type::uint8, Scalar_type::int16}}, {1, 0, 7}};
  mesh.faces->elements = {valid};
  write_mesh("b.ply", mesh);
  BOOST_CHECK_THROW(write_mesh("b.off", mesh), IO_error); // only PLY can hold it
  for (const std::vector<unsigned char>& bytes :
       std::vector<std::vector<unsigned char>>{{},
                                               {1},
                                               {1, 0},
                                               {1, 0, 7, 8},
                                               {2, 0, 7},
                                               {0, 128}}) {
    mesh.faces->elements[0].bytes = bytes;
    BOOST_CHECK_THROW(write_mesh("c.ply", mesh), Invalid_input);
  }
  for (const char* name : {"vertex", "face"}) { // expected one row per vertex and face
    mesh.faces->elements = {valid};
    mesh.faces->elements[0].name = name;
    BOOST_CHECK_THROW(write_mesh("c.ply", mesh), Invalid_input);
  }
  mesh.faces->elements = {Element_rows{"empty", std::numeric_limits<std::uint64_t>::max(), {}, {}}};
  BOOST_CHECK_THROW(write_mesh("c.ply", mesh), Invalid_input);
  BOOST_TEST(number_of_files() == 2u);
}

BOOST_AUTO_TEST_CASE(rows_of_faces_begin_with_a_number_of_corners)
{
  refuses("a.off",
          "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\nx 0 1 2\n",
          "line 6: expected the number of vertices of a face");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_mesh_faces

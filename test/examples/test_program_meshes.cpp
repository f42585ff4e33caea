// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests that the program deform_point_set keeps the faces of meshes.

#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Write_options.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <examples/Program_run.h>
#include <memory>
#include <string>
#include <vector>

namespace test_program_meshes {

using pcs::IO::Mesh_faces;
using pcs::IO::Ply_encoding;
using pcs::IO::Scalar_type;
using pcs::IO::Write_options;

namespace {

constexpr std::size_t rings = 30, sides = 12;

/// A tube of quadrangles with one triangle, which is bent by `edit`.
struct Mesh_run : Deform_run
{
  Mesh_run() : faces(std::make_shared<Mesh_faces>())
  {
    std::vector<Table::Point_3> points;
    for (std::size_t i = 0; i < rings * sides; ++i) {
      const double angle = 2 * 3.141592653589793 * double(i % sides) / double(sides);
      points.emplace_back(std::cos(angle), std::sin(angle), 0.5 * double(i / sides));
    }
    input = Table(points);
    faces->number_of_vertices = points.size();
    for (std::size_t i = 0; i + sides < points.size(); ++i) {
      const std::size_t next = i % sides + 1 < sides ? i + 1 : i + 1 - sides;
      for (const std::size_t v : {i, next, next + sides, i + sides})
        faces->vertices.push_back(std::uint32_t(v));
      faces->ends.push_back(faces->vertices.size());
    }
    faces->vertices.insert(faces->vertices.end(), {0, 4, 8});
    faces->ends.push_back(faces->vertices.size());
    write("edit.json",
          R"({"handles": [{"select": {"box": [[-2, -2, 0], [2, 2, 1]]}, "fixed": true},
                          {"select": {"box": [[-2, -2, 13.5], [2, 2, 15]]},
                           "rotate": {"axis": [1, 0, 0], "degrees": 40}}]})");
  }

  void write_mesh(const std::string& name,
                  Ply_encoding encoding = Ply_encoding::binary_little_endian) const
  {
    Write_options options;
    options.faces = faces;
    options.ply_encoding = encoding;
    pcs::IO::write_points(path(name), input, options);
  }

  /// Deforms `in` to `out`, which must succeed, and returns the points of `out`.
  Table
  deform_mesh(const std::string& in, const std::string& out_name, const std::string& more = "")
  {
    const int code = run("--input " + in + " --edit edit.json --output " + out_name +
                         " --report report.json " + more);
    BOOST_TEST_REQUIRE(code == 0, in << ": exit code " << code << ": " << err);
    report = Json::parse(content("report.json"));
    output_faces = nullptr;
    return pcs::IO::read_points(path(out_name), output_faces);
  }

  void check_same_faces(const std::string& what) const
  {
    BOOST_TEST_REQUIRE((output_faces != nullptr), what);
    BOOST_TEST((output_faces->ends == faces->ends), what);
    BOOST_TEST((output_faces->vertices == faces->vertices), what);
  }

  bool warns(const std::string& words) const { return err.find(words) != std::string::npos; }

  std::shared_ptr<Mesh_faces> faces, output_faces;
};

} // namespace

BOOST_AUTO_TEST_SUITE(meshes)

BOOST_FIXTURE_TEST_CASE(a_deformed_mesh_has_the_same_faces, Mesh_run)
{
  write_mesh("in.off");
  write_mesh("in.obj");
  write_mesh("in.ply");
  write_mesh("ascii.ply", Ply_encoding::ascii);
  const Table expected = deform_mesh("in.ply", "points.ply", "--points-only");
  BOOST_TEST(!output_faces);
  BOOST_TEST(report["faces"] == 0);
  BOOST_TEST((expected.points() != input.points()));
  for (const std::string in : {"in.off", "in.obj", "in.ply", "ascii.ply"})
    for (const std::string target : {"out.off", "out.obj", "out.ply"}) {
      const std::string what = in + " to " + target;
      const Table result = deform_mesh(in, target);
      check_same_faces(what);
      BOOST_TEST((result.points() == expected.points()), what); // same order, same values
      BOOST_TEST(err == "", what);
      BOOST_TEST(report["faces"] == faces->number_of_faces(), what);
      BOOST_TEST(out.find("faces       349") != std::string::npos, what << ": " << out);
    }
}

BOOST_FIXTURE_TEST_CASE(a_deformed_mesh_may_be_written_as_gltf, Mesh_run)
{
  write_mesh("in.ply");
  for (const std::string more : {"", " --stream"}) {
    const int code = run("--input in.ply --edit edit.json --output out.glb" + more);
    BOOST_TEST_REQUIRE(code == 0, err);
    const std::string file = content("out.glb");
    BOOST_TEST(file.substr(0, 4) == "glTF");
    const Json json = Json::parse(file.substr(20, file.find("BIN") - 4 - 20));
    BOOST_TEST(json["accessors"][0]["count"] == rings * sides);
    // two triangles for each of the quadrangles, and one triangle
    BOOST_TEST(json["accessors"][1]["count"] == 3 * (2 * (rings - 1) * sides + 1));
  }
}

BOOST_FIXTURE_TEST_CASE(a_mesh_may_be_replaced_by_its_deformation, Mesh_run)
{
  for (const std::string name : {"a.off", "a.obj", "a.ply"}) {
    write_mesh(name);
    deform_mesh(name, name);
    check_same_faces(name);
  }
}

BOOST_FIXTURE_TEST_CASE(normals_of_a_mesh_are_rotated, Mesh_run)
{
  std::vector<Table::Vector_3> normals;
  for (const Table::Point_3& p : input.points())
    normals.emplace_back(p.x(), p.y(), 0);
  input.set_normals(normals);
  for (const std::string name : {"in.off", "in.ply"}) {
    write_mesh(name);
    const Table result = deform_mesh(name, "out.ply");
    check_same_faces(name);
    BOOST_TEST(report["normals"] == "deformed");
    const Table::Vector_3 turned = result.normals().back();
    const Table::Vector_3 n = normals.back();
    const double a = 40 * 3.141592653589793 / 180; // about the x axis
    BOOST_TEST(std::abs(turned.y() - std::cos(a) * n.y()) < 1e-6, turned);
    BOOST_TEST(std::abs(turned.z() - std::sin(a) * n.y()) < 1e-6, turned);
  }
}

BOOST_FIXTURE_TEST_CASE(a_streamed_mesh_has_the_bytes_of_the_memory_mode, Mesh_run)
{
  for (const std::string name : {"a.off", "a.obj", "a.ply"}) {
    write_mesh(name);
    deform_mesh(name, "out_" + name);
    const std::string expected = content("out_" + name);
    deform_mesh(name, "out_" + name, "--stream --chunk-points 50");
    BOOST_TEST((content("out_" + name) == expected), name);
    deform_mesh(name, "out_" + name, "--stream --stream-points 100 --chunk-points 50");
    check_same_faces(name);
  }
}

BOOST_FIXTURE_TEST_CASE(ply_keeps_other_elements_and_other_formats_name_them, Mesh_run)
{
  faces->elements = {{"camera", 1, {{"f", Scalar_type::uint8, {}}}, {7}},
                     {"face",
                      faces->number_of_faces(),
                      {{"red", Scalar_type::uint8, {}}},
                      std::vector<unsigned char>(faces->number_of_faces(), 9)},
                     {"vertex",
                      faces->number_of_vertices,
                      {{"w", Scalar_type::uint8, Scalar_type::uint8}},
                      std::vector<unsigned char>(faces->number_of_vertices, 0)}};
  write_mesh("in.ply");
  for (const std::string more : {"", "--stream --chunk-points 50"}) {
    deform_mesh("in.ply", "out.ply", more);
    check_same_faces("ply");
    for (const auto& element : faces->elements) {
      BOOST_TEST_REQUIRE(output_faces->find(element.name), element.name);
      BOOST_TEST((output_faces->find(element.name)->bytes == element.bytes), element.name);
    }
    BOOST_TEST(err == "");
    for (const std::string target : {"out.off", "out.obj", "out.xyz"}) {
      deform_mesh("in.ply", target, more);
      for (const char* words :
           {"the element 'camera' with 1 rows is left out; write PLY to keep it",
            "the property 'red' of the faces is left out",
            "the list 'w' of the vertices is left out"})
        BOOST_TEST(warns(words), target << ": " << err);
      if (target != "out.xyz")
        check_same_faces(target);
    }
  }
}

BOOST_FIXTURE_TEST_CASE(formats_without_faces_leave_them_out_with_a_warning, Mesh_run)
{
  write_mesh("in.off");
  for (const std::string target : {"out.las", "out.xyz"})
    for (const std::string more : {"", "--stream"}) {
      deform_mesh("in.off", target, more);
      BOOST_TEST(err ==
                 "deform_point_set: warning: in.off: the 349 faces of the mesh are left out; "
                 "write PLY, OFF, OBJ or glTF to keep them\n");
      BOOST_TEST(report["faces"] == 0);
      BOOST_TEST(report["warnings"].size() == 1);
    }
  deform_mesh("in.off", "out.off", "--points-only");
  BOOST_TEST(warns("its 349 faces are left out"), err);
}

BOOST_FIXTURE_TEST_CASE(colors_of_faces_and_textures_are_named, Mesh_run)
{
  write_mesh("in.off");
  std::string text = content("in.off");
  text.insert(text.size() - 1, " 255 0 0");
  write("in.off", text);
  write_mesh("in.obj");
  write("in.obj", "mtllib a.mtl\nvt 0 0\n" + content("in.obj"));
  for (const std::string more : {"", "--stream"}) {
    deform_mesh("in.off", "out.off", more);
    check_same_faces("off");
    BOOST_TEST(warns("the colours of the faces are left out"), err);
    deform_mesh("in.obj", "out.obj", more);
    check_same_faces("obj");
    BOOST_TEST(warns("the lines of the mesh with vt, mtllib are left out"), err);
  }
}

BOOST_FIXTURE_TEST_CASE(invalid_faces_are_refused_and_nothing_is_written, Mesh_run)
{
  struct Case
  {
    std::string name, last_face, message;
  };
  write("out.ply", "an old file");
  for (const Case& c : std::vector<Case>{
           {"a.off", "3 0 1 360", "line 711: expected the index of a vertex"},
           {"a.off", "2 0 1", "line 711: face 348 has 2 vertices, expected 3 or more"},
           {"a.off", "4000000000 0 1 2", "line 711: expected the index of a vertex"},
           {"a.obj", "f 1 2 361", "line 709: face 348: expected the index of a vertex, from 1 to"},
           {"a.obj", "f 1 2 -361", "line 709: face 348: expected the index of a vertex, from 1 to"},
           {"a.obj", "f 1/1 2/2", "line 709: face 348 has 2 vertices"},
           {"a.ply", "3 0 1 360", "face 348: expected the index of a vertex, from 0, in a mesh"},
           {"a.ply", "3 0 1 -1", "face 348: expected the index of a vertex, from 0, in a mesh"},
           {"a.ply", "3 0 1", "expected a number"}}) {
    write_mesh(c.name, Ply_encoding::ascii);
    std::string text = content(c.name);
    text.erase(text.rfind('\n', text.size() - 2) + 1);
    write(c.name, text + c.last_face + "\n");
    for (const std::string more : {"", "--stream --chunk-points 50"}) {
      const std::string arguments = "--edit edit.json --output out.ply " + more;
      BOOST_TEST(run("--input " + c.name + " " + arguments) == 1, c.name << ": " << c.last_face);
      BOOST_TEST(warns(c.message), c.message << " is missing in " << err);
      BOOST_TEST(std::count(err.begin(), err.end(), '\n') == 1, err);
      BOOST_TEST(content("out.ply") == "an old file");
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_program_meshes

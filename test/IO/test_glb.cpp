// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of writing meshes and points as binary glTF, and of the limits of meshes.

#define BOOST_BIND_GLOBAL_PLACEHOLDERS // silences a note of the JSON parser of Boost

#include "temporary_files.h"
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_mesh.h>
#include <pcs/IO/write_points.h>

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace test_glb {

using pcs::Invalid_input;
using pcs::IO_error;
using pcs::IO::Mesh_faces;
using pcs::IO::Point_table;
using pcs::IO::Point_writer;
using pcs::IO::Write_options;
using Point_3 = Point_table::Point_3;
using Json = boost::property_tree::ptree;
using Triangles = std::vector<std::array<std::size_t, 3>>;

namespace {

//! A GLB file, parsed and checked as the specification of glTF 2.0 demands.
struct Glb
{
  explicit Glb(const std::string& content) : file(content)
  {
    BOOST_REQUIRE(file.size() > 28u);
    BOOST_TEST(file.substr(0, 4) == "glTF");
    BOOST_TEST(get<std::uint32_t>(4) == 2u);
    BOOST_TEST(get<std::uint32_t>(8) == file.size());
    const std::size_t json_size = get<std::uint32_t>(12);
    BOOST_TEST(json_size % 4 == 0u);
    BOOST_TEST(file.substr(16, 4) == "JSON");
    std::istringstream text(file.substr(20, json_size));
    boost::property_tree::read_json(text, json);
    const std::size_t binary = 20 + json_size;
    const std::size_t size = get<std::uint32_t>(binary);
    BOOST_TEST(file.substr(binary + 4, 4) == std::string("BIN\0", 4));
    BOOST_TEST(size % 4 == 0u);
    data = binary + 8;
    BOOST_TEST(data + size == file.size());
    BOOST_TEST(json.get<std::string>("asset.version") == "2.0");
    const auto length = item("buffers", 0).get<std::size_t>("byteLength");
    BOOST_TEST(length <= size);
    BOOST_TEST(size - length < 4u);
    for (const auto& view : json.get_child("bufferViews")) {
      const auto offset = view.second.get<std::size_t>("byteOffset", 0);
      BOOST_TEST(offset % 4 == 0u);
      BOOST_TEST(offset + view.second.get<std::size_t>("byteLength") <= length);
    }
    primitive = item("meshes", 0).get_child("primitives").front().second;
  }

  template <class T>
  T get(std::size_t at) const
  {
    return pcs::IO::internal::load<T>(reinterpret_cast<const unsigned char*>(file.data()) + at,
                                      pcs::IO::internal::is_big_endian_machine());
  }

  const Json& item(const char* list, std::size_t i) const
  {
    auto at = json.get_child(list).begin();
    std::advance(at, static_cast<std::ptrdiff_t>(i));
    return at->second;
  }

  static std::vector<double> numbers(const Json& list)
  {
    std::vector<double> result;
    for (const auto& value : list)
      result.push_back(value.second.get_value<double>());
    return result;
  }

  //! Returns the values of an accessor, one after the other.
  template <class T>
  std::vector<T> values(std::size_t i, const std::string& type, int component) const
  {
    const Json& accessor = item("accessors", i);
    BOOST_TEST(accessor.get<std::string>("type") == type);
    BOOST_TEST(accessor.get<int>("componentType") == component);
    const Json& view = item("bufferViews", accessor.get<std::size_t>("bufferView"));
    const std::size_t n = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4;
    const auto stride = view.get<std::size_t>("byteStride", n * sizeof(T));
    const auto begin = view.get<std::size_t>("byteOffset", 0);
    const auto offset = accessor.get<std::size_t>("byteOffset", 0);
    const auto count = accessor.get<std::size_t>("count");
    BOOST_TEST(offset % sizeof(T) == 0u);
    BOOST_TEST(stride % 4 == 0u);
    BOOST_REQUIRE(count > 0u);
    BOOST_REQUIRE(offset + stride * (count - 1) + n * sizeof(T) <=
                  view.get<std::size_t>("byteLength"));
    std::vector<T> result;
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t c = 0; c < n; ++c)
        result.push_back(get<T>(data + begin + offset + k * stride + c * sizeof(T)));
    return result;
  }

  std::size_t attribute(const char* name) const
  {
    return primitive.get<std::size_t>(std::string("attributes.") + name);
  }
  bool has(const char* name) const
  {
    return primitive.count("attributes") > 0 && primitive.get_child("attributes").count(name) > 0;
  }

  std::vector<float> positions() const
  {
    const std::size_t i = attribute("POSITION");
    const std::vector<float> result = values<float>(i, "VEC3", 5126);
    const auto low = numbers(item("accessors", i).get_child("min"));
    const auto high = numbers(item("accessors", i).get_child("max"));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      float least = result[axis], most = result[axis];
      for (std::size_t k = axis; k < result.size(); k += 3) {
        least = std::min(least, result[k]);
        most = std::max(most, result[k]);
      }
      BOOST_TEST(low.at(axis) == double(least)); // bounds are required to be exact
      BOOST_TEST(high.at(axis) == double(most));
    }
    return result;
  }

  //! Returns a vector rotated by the unit quaternion of the node.
  std::array<double, 3> rotated(const std::array<double, 3>& v) const
  {
    const auto q = numbers(item("nodes", 0).get_child("rotation"));
    BOOST_TEST(std::abs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 1e-12);
    const auto cross = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
      return std::array<double, 3>{a[1] * b[2] - a[2] * b[1],
                                   a[2] * b[0] - a[0] * b[2],
                                   a[0] * b[1] - a[1] * b[0]};
    };
    const std::array<double, 3> u = {q[0], q[1], q[2]};
    const auto t = cross(u, v), s = cross(u, t);
    std::array<double, 3> result = v;
    for (std::size_t k = 0; k < 3; ++k)
      result[k] += 2 * (q[3] * t[k] + s[k]);
    return result;
  }

  //! Returns the largest distance of the scene from the points in the axes of glTF.
  double largest_distance(const std::vector<Point_3>& points) const
  {
    const std::vector<float> stored = positions();
    BOOST_REQUIRE(stored.size() == 3 * points.size());
    const auto translation = numbers(item("nodes", 0).get_child("translation"));
    double result = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto r = rotated({stored[3 * i], stored[3 * i + 1], stored[3 * i + 2]});
      const Point_3& p = points[i];
      const std::array<double, 3> expected = {p.x(), p.z(), -p.y()};
      for (std::size_t k = 0; k < 3; ++k)
        result = std::max(result, std::abs(r[k] + translation[k] - expected[k]));
    }
    return result;
  }

  std::string file;
  Json json, primitive;
  std::size_t data = 0; // first byte of the binary chunk
};

const std::vector<Point_3> corners = {{500000.125, 5000000.5, 100},
                                      {500001, 5000000, 101.0625},
                                      {500000, 5000003, 99},
                                      {500007, 5000001, 102}};
const Triangles two = {{0, 1, 2}, {2, 1, 3}};

std::shared_ptr<Mesh_faces> quad()
{
  auto faces = std::make_shared<Mesh_faces>();
  faces->number_of_vertices = 4;
  faces->vertices = {0, 1, 3, 2, 0, 1, 2};
  faces->ends = {4, 7};
  return faces;
}

struct Glb_files : Temporary_files
{
  template <class Error, class Write>
  void refuses(const Write& write, const std::string& expected) const
  {
    const std::size_t n = number_of_files();
    std::string message = "no error";
    try {
      write();
    } catch (const Error& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(expected) != std::string::npos,
               "expected '" << expected << "' in '" << message << "'");
    BOOST_TEST(number_of_files() == n); // nothing is left behind
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(glb, Glb_files)

BOOST_AUTO_TEST_CASE(a_mesh_has_its_triangles_and_its_place_in_the_axes_of_gltf)
{
  pcs::IO::write_mesh(path("a.glb"), corners, two);
  const Glb glb(content("a.glb"));
  // a quarter of a micrometre at coordinates of which float keeps half a metre
  BOOST_TEST(glb.largest_distance(corners) < 2.5e-7);
  BOOST_TEST(glb.primitive.get<int>("mode") == 4);
  BOOST_TEST(!glb.has("NORMAL"));
  BOOST_TEST(!glb.has("COLOR_0"));
  const auto indices =
      glb.values<std::uint32_t>(glb.primitive.get<std::size_t>("indices"), "SCALAR", 5125);
  BOOST_TEST(indices == (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3}),
             boost::test_tools::per_element());
  const auto up = glb.rotated({0, 0, 1});
  BOOST_TEST(std::abs(up[1] - 1) < 1e-12); // y is up in glTF
}

BOOST_AUTO_TEST_CASE(points_with_faces_keep_normals_and_colors)
{
  Point_table table(corners);
  table.set_normals({{0, 0, 2}, {3, 0, 4}, {0, -1, 0}, {1, 0, 0}});
  table.add_property<std::uint8_t>("red", {0, 255, 188, 10});
  table.add_property<std::uint8_t>("green", {255, 0, 1, 10});
  table.add_property<std::uint8_t>("blue", {1, 2, 3, 10});
  Write_options options;
  options.faces = quad();
  pcs::IO::write_points(path("a.glb"), table, options);
  const Glb glb(content("a.glb"));
  BOOST_TEST(glb.largest_distance(corners) < 2.5e-7);
  const auto normals = glb.values<float>(glb.attribute("NORMAL"), "VEC3", 5126);
  const std::vector<float> expected = {0, 0, 1, 0.6f, 0, 0.8f, 0, -1, 0, 1, 0, 0};
  BOOST_TEST(normals == expected, boost::test_tools::per_element());
  const auto colors = glb.values<std::uint16_t>(glb.attribute("COLOR_0"), "VEC4", 5123);
  BOOST_TEST(glb.item("accessors", glb.attribute("COLOR_0")).get<bool>("normalized"));
  BOOST_TEST(colors[0] == 0u);
  BOOST_TEST(colors[1] == 65535u);
  BOOST_TEST(colors[3] == 65535u);                           // without alpha: opaque
  BOOST_TEST(std::abs(colors[8] / 65535.0 - 0.5029) < 1e-4); // the sRGB value 188 is half as bright
  // the square becomes two triangles
  const auto indices =
      glb.values<std::uint32_t>(glb.primitive.get<std::size_t>("indices"), "SCALAR", 5125);
  BOOST_TEST(indices == (std::vector<std::uint32_t>{0, 1, 3, 0, 3, 2, 0, 1, 2}),
             boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(other_types_of_colors_have_the_same_values)
{
  const auto colors = [&](Point_table table) {
    pcs::IO::write_points(path("a.glb"), table);
    const Glb glb(content("a.glb"));
    return glb.values<std::uint16_t>(glb.attribute("COLOR_0"), "VEC4", 5123);
  };
  Point_table bytes({{1, 2, 3}}), words = bytes, numbers = bytes;
  for (const char* name : {"red", "green", "blue", "alpha"}) {
    bytes.add_property<std::uint8_t>(name, {51});
    words.add_property<std::uint16_t>(name, {13107});
    numbers.add_property<double>(name, {0.2});
  }
  const auto expected = colors(bytes);
  BOOST_TEST(expected[3] == 13107u); // alpha is linear
  BOOST_TEST(colors(words) == expected, boost::test_tools::per_element());
  BOOST_TEST(colors(numbers) == expected, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(points_without_faces_are_points)
{
  Point_writer writer(path("a.glb"), Point_table(corners).schema());
  for (const Point_3& p : corners)
    writer.append(Point_table({p}));
  writer.commit();
  const Glb glb(content("a.glb"));
  BOOST_TEST(glb.primitive.get<int>("mode") == 0);
  BOOST_TEST(glb.primitive.count("indices") == 0u);
  BOOST_TEST(glb.largest_distance(corners) < 5e-7);
}

BOOST_AUTO_TEST_CASE(an_empty_mesh_is_an_empty_scene)
{
  pcs::IO::write_mesh(path("a.glb"), std::vector<Point_3>(), {});
  const std::string file = content("a.glb");
  const auto number = [&](std::size_t at) {
    return pcs::IO::internal::load<std::uint32_t>(
        reinterpret_cast<const unsigned char*>(file.data()) + at,
        pcs::IO::internal::is_big_endian_machine());
  };
  BOOST_TEST_REQUIRE(file.size() > 20u);
  BOOST_TEST(file.substr(0, 4) == "glTF");
  BOOST_TEST(number(8) == file.size());
  BOOST_TEST(number(12) == file.size() - 20);
  BOOST_TEST(file.size() % 4 == 0u);
  BOOST_TEST(file.substr(16, 4) == "JSON");
  std::istringstream text(file.substr(20));
  Json json;
  boost::property_tree::read_json(text, json);
  BOOST_TEST(json.get<std::string>("asset.version") == "2.0");
  BOOST_TEST(json.get_child("scenes").size() == 1u);
  BOOST_TEST(json.count("meshes") == 0u);
}

BOOST_AUTO_TEST_CASE(vertices_without_triangles_are_refused)
{
  refuses<IO_error>([&] { pcs::IO::write_mesh(path("a.glb"), corners, {}); }, "write PLY or OBJ");
  refuses<IO_error>([&] { pcs::IO::write_points(path("a.glb"), Point_table()); }, "write PLY");
  Write_options options;
  auto faces = std::make_shared<Mesh_faces>();
  faces->number_of_vertices = corners.size();
  options.faces = faces;
  refuses<IO_error>([&] { pcs::IO::write_points(path("a.glb"), corners, options); },
                    "a mesh without faces");
}

BOOST_AUTO_TEST_CASE(indices_and_coordinates_are_checked_in_every_format)
{
  for (const char* name : {"a.glb", "a.ply", "a.obj"}) {
    refuses<Invalid_input>(
        [&] {
          pcs::IO::write_mesh(path(name), corners, {{0, 1, 2}, {0, 1, 4}});
        },
        "triangle 1 has the vertex 4, the mesh has 4 vertices");
    // is 0 if it is cut to 32 bits
    refuses<Invalid_input>(
        [&] {
          pcs::IO::write_mesh(path(name), corners, {{0, 1, std::size_t(1) << 32}});
        },
        "triangle 0 has the vertex 4294967296");
    std::vector<Point_3> bad = corners;
    bad[2] = Point_3(0, std::numeric_limits<double>::infinity(), 0);
    refuses<Invalid_input>([&] { pcs::IO::write_mesh(path(name), bad, two); },
                           "point 2 is not finite");
  }
  refuses<IO_error>([&] { pcs::IO::write_mesh(path("a.stl"), corners, two); },
                    "must be .ply, .obj or .glb");
  refuses<IO_error>([&] { pcs::IO::write_mesh(path("a.ply.gz"), corners, two); }, "gzip FILE");
  const std::vector<Point_3> far = {{-1e300, 0, 0}, {1e300, 0, 0}, {0, 1, 0}};
  refuses<IO_error>([&] { pcs::IO::write_mesh(path("a.glb"), far, {{0, 1, 2}}); }, "too far apart");
}

BOOST_AUTO_TEST_CASE(meshes_that_a_format_cannot_hold_are_refused)
{
  using pcs::IO::internal::check_mesh_size;
  const std::uint64_t limit = std::uint64_t(1) << 32;
  check_mesh_size("a.ply", limit, 1);
  check_mesh_size("a.obj", limit + 1, 1);
  refuses<IO_error>([&] { check_mesh_size("a.ply", limit + 1, 1); },
                    "4294967297 vertices, PLY can hold 4294967296; write OBJ");
  // 12 bytes for each vertex and each triangle
  check_mesh_size("a.glb", 178000000, 179000000);
  refuses<IO_error>([&] { check_mesh_size("a.glb", 179000000, 179000000); },
                    "exceeds the 4 GiB of binary glTF; write PLY");
}

BOOST_AUTO_TEST_CASE(properties_that_gltf_cannot_hold_are_refused)
{
  const auto refuses_table = [&](const Point_table& table, const std::string& expected) {
    refuses<IO_error>([&] { pcs::IO::write_points(path("a.glb"), table); }, expected);
  };
  Point_table table({{1, 2, 3}});
  Point_table other = table;
  other.add_property<int>("label", {1});
  refuses_table(other, "glTF cannot store the property 'label'; remove it first");
  other = table;
  other.set_normals({{0, 0, 0}});
  refuses_table(other, "the normal of point 0 is zero or not finite");
  for (const double red : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    other = table;
    other.add_property<double>("red", {red});
    other.add_property<double>("green", {0});
    other.add_property<double>("blue", {0});
    refuses_table(other, "a colour of point 0 is not between 0 and 1");
  }
  other = table;
  for (const char* name : {"red", "green", "blue"})
    other.add_property<std::int32_t>(name, {1});
  refuses_table(other, "'red' is of type int32");
}

BOOST_AUTO_TEST_CASE(gltf_is_not_read)
{
  pcs::IO::write_mesh(path("a.glb"), corners, two);
  refuses<IO_error>([&] { pcs::IO::read_points(path("a.glb")); },
                    "glTF can only be written; export the mesh as PLY or OBJ");
}

BOOST_AUTO_TEST_CASE(the_other_formats_of_meshes_are_read_back)
{
  for (const char* name : {"a.ply", "a.obj", "a.PLY"}) {
    pcs::IO::write_mesh(path(name), corners, two);
    std::shared_ptr<Mesh_faces> faces;
    BOOST_TEST((pcs::IO::read_points(path(name), faces).points() == corners));
    BOOST_REQUIRE(faces != nullptr);
    BOOST_TEST(faces->vertices == (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3}),
               boost::test_tools::per_element());
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_glb

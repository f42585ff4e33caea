// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The parts of a binary glTF file: head, vertices and indices.

#ifndef PCS_IO_INTERNAL_GLTF_GLB_FILE_H
#define PCS_IO_INTERNAL_GLTF_GLB_FILE_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/numbers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

struct Glb_attributes
{
  bool has_normals = false, has_colors = false, has_alpha = false;

  //! returns the number of bytes of a vertex, a multiple of 4 as glTF requires
  std::size_t vertex_size() const { return 12 + (has_normals ? 12 : 0) + (has_colors ? 8 : 0); }
};

struct Glb_vertex
{
  std::array<double, 3> position{};
  std::array<float, 3> normal{};        // of length 1
  std::array<std::uint16_t, 4> color{}; // linear, from 0 to 65535
};

//! returns the linear value of 16 bits that glTF stores for an sRGB value from 0 to 1
inline std::uint16_t linear_color(double srgb)
{
  const double linear = srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535 * linear));
}

/*
  glTF 2.0 in one file (GLB): a head with a chunk of JSON, then a chunk with the vertices, whose
  attributes follow each other, and the indices of the triangles. Without triangles, the vertices
  are points. The JSON contains counts and bounds, which are known at the end only, hence its size
  is fixed. Positions are stored as float relative to an origin. A node moves them to the origin and
  rotates them, because glTF is y-up and scans are z-up: (x, y, z) becomes (x, z, -y).
*/
class Glb_file
{
public:
  Glb_file(Output_file& file, const Glb_attributes& attributes, const std::array<double, 3>& origin)
    : m_file(file), m_attributes(attributes), m_origin(origin)
  {
    const std::string head(head_size, ' ');
    m_file.write(head);
  }

  //! returns the number of bytes of a file; glTF allows at most `largest_size`
  static double size_of_file(const Glb_attributes& attributes,
                             std::uint64_t number_of_vertices,
                             std::uint64_t number_of_triangles)
  {
    return double(head_size) + double(attributes.vertex_size()) * double(number_of_vertices) +
           12.0 * double(number_of_triangles);
  }
  static constexpr std::uint64_t largest_size = std::numeric_limits<std::uint32_t>::max();

  //! writes a vertex; all vertices precede the indices
  void add_vertex(const Glb_vertex& vertex)
  {
    std::array<unsigned char, 32> bytes{};
    std::size_t at = 0;
    const auto put = [&](auto value) {
      store_little(bytes, at, value);
      at += sizeof value;
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double value = vertex.position[axis] - m_origin[axis];
      if (!(std::abs(value) <= double(std::numeric_limits<float>::max())))
        m_file.fail("the points are too far apart for glTF, which stores float; write PLY");
      const auto stored = static_cast<float>(value);
      m_low[axis] = std::min(m_low[axis], stored);
      m_high[axis] = std::max(m_high[axis], stored);
      put(stored);
    }
    if (m_attributes.has_normals)
      for (const float value : vertex.normal)
        put(value);
    if (m_attributes.has_colors)
      for (const std::uint16_t value : vertex.color)
        put(value);
    write(bytes.data(), at);
    ++m_number_of_vertices;
  }

  //! writes the index of a corner of a triangle
  void add_index(std::uint32_t vertex)
  {
    std::array<unsigned char, 4> bytes{};
    store_little(bytes, 0, vertex);
    write(bytes.data(), bytes.size());
    ++m_number_of_indices;
  }

  //! completes the head
  void finish()
  {
    const std::size_t size = m_file.position();
    std::string json = text();
    if (json.size() > json_size)
      m_file.fail("the head of the glTF file is too long");
    json.resize(json_size, ' ');
    std::vector<unsigned char> head(head_size);
    const auto put = [&](std::size_t at, std::size_t value) {
      store_little(head, at, static_cast<std::uint32_t>(value));
    };
    std::copy_n("glTF", 4, head.begin());
    put(4, 2); // version
    put(8, size);
    put(12, json_size);
    std::copy_n("JSON", 4, head.begin() + 16);
    std::copy(json.begin(), json.end(), head.begin() + 20);
    put(20 + json_size, size - head_size);
    std::copy_n("BIN\0", 4, head.begin() + 24 + static_cast<std::ptrdiff_t>(json_size));
    m_file.patch(0, head.data(), head.size());
  }

private:
  static constexpr std::size_t head_size = 2048; // a multiple of 4
  static constexpr std::size_t json_size = head_size - 28;

  void write(const unsigned char* bytes, std::size_t n)
  {
    if (m_file.position() + n > largest_size)
      m_file.fail("the data exceed the 4 GiB of binary glTF; write PLY");
    m_file.write(bytes, n);
  }

  template <class T, std::size_t N>
  static std::string list(const std::array<T, N>& values)
  {
    std::string text = "[";
    for (const T value : values) {
      text += text.size() > 1 ? "," : "";
      append_number(text, static_cast<double>(value));
    }
    return text + "]";
  }

  std::string accessor(const char* type, const char* component, std::size_t offset) const
  {
    return std::string("{\"bufferView\":0,\"byteOffset\":") + std::to_string(offset) +
           ",\"componentType\":" + component +
           ",\"count\":" + std::to_string(m_number_of_vertices) + ",\"type\":\"" + type + "\"";
  }

  std::string text() const
  {
    const bool is_mesh = m_number_of_indices > 0;
    const std::size_t vertices = m_number_of_vertices * m_attributes.vertex_size();
    const double half = std::sqrt(0.5); // a rotation by -90 degrees about the x axis
    std::string attributes = "\"POSITION\":0";
    std::string accessors =
        accessor("VEC3", "5126", 0) + ",\"min\":" + list(m_low) + ",\"max\":" + list(m_high) + "}";
    std::size_t number_of_accessors = 1, offset = 12;
    const auto add = [&](const char* name, const std::string& text) {
      attributes += std::string(",\"") + name + "\":" + std::to_string(number_of_accessors++);
      accessors += "," + text;
    };
    if (m_attributes.has_normals) {
      add("NORMAL", accessor("VEC3", "5126", offset) + "}");
      offset += 12;
    }
    if (m_attributes.has_colors)
      add("COLOR_0", accessor("VEC4", "5123", offset) + ",\"normalized\":true}");
    std::string views = "{\"buffer\":0,\"byteLength\":" + std::to_string(vertices) +
                        ",\"byteStride\":" + std::to_string(m_attributes.vertex_size()) +
                        ",\"target\":34962}";
    if (is_mesh) {
      accessors += ",{\"bufferView\":1,\"componentType\":5125,\"count\":" +
                   std::to_string(m_number_of_indices) + ",\"type\":\"SCALAR\"}";
      views += ",{\"buffer\":0,\"byteOffset\":" + std::to_string(vertices) +
               ",\"byteLength\":" + std::to_string(4 * m_number_of_indices) + ",\"target\":34963}";
    }
    return "{\"asset\":{\"version\":\"2.0\",\"generator\":\"pcs\"},\"scene\":0,"
           "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":" +
           list(std::array<double, 3>{m_origin[0], m_origin[2], -m_origin[1]}) +
           ",\"rotation\":" + list(std::array<double, 4>{-half, 0, 0, half}) +
           "}],\"meshes\":[{\"primitives\":[{\"attributes\":{" + attributes + "}," +
           (is_mesh ? "\"indices\":" + std::to_string(number_of_accessors) + "," : std::string()) +
           "\"mode\":" + (is_mesh ? "4" : "0") +
           ",\"material\":0}]}],\"materials\":[{\"doubleSided\":true," +
           (m_attributes.has_alpha ? "\"alphaMode\":\"BLEND\"," : "") +
           "\"pbrMetallicRoughness\":{\"metallicFactor\":0}}],\"accessors\":[" + accessors +
           "],\"bufferViews\":[" + views +
           "],\"buffers\":[{\"byteLength\":" + std::to_string(vertices + 4 * m_number_of_indices) +
           "}]}";
  }

  Output_file& m_file;
  Glb_attributes m_attributes;
  std::array<double, 3> m_origin; // [L]
  std::uint64_t m_number_of_vertices = 0, m_number_of_indices = 0;
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> m_low = {infinity, infinity, infinity};
  std::array<float, 3> m_high = {-infinity, -infinity, -infinity};
};

//! writes a glTF file with an empty scene, since meshes of glTF have at least one vertex
inline void write_empty_glb(Output_file& file)
{
  std::string json = "{\"asset\":{\"version\":\"2.0\",\"generator\":\"pcs\"},\"scene\":0,"
                     "\"scenes\":[{\"name\":\"empty\"}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::array<unsigned char, 20> head{'g', 'l', 'T', 'F', 2, 0, 0, 0};
  store_little(head, 8, static_cast<std::uint32_t>(head.size() + json.size()));
  store_little(head, 12, static_cast<std::uint32_t>(json.size()));
  std::copy_n("JSON", 4, head.begin() + 16);
  file.write(head.data(), head.size());
  file.write(json);
}

//! returns the center of the bounding box of positions, which has the coordinates `get(i, axis)`
template <class Get>
std::array<double, 3> center_of_box(std::size_t n, const Get& get)
{
  std::array<double, 3> center{};
  for (std::size_t axis = 0; axis < 3 && n > 0; ++axis) {
    double low = get(0, axis), high = low;
    for (std::size_t i = 1; i < n; ++i) {
      low = std::min(low, get(i, axis));
      high = std::max(high, get(i, axis));
    }
    center[axis] = 0.5 * low + 0.5 * high;
  }
  return center;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_GLTF_GLB_FILE_H

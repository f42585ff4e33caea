// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Collects the faces, lists and other elements of a PLY file while it is read.

#ifndef PCS_IO_INTERNAL_PLY_PLY_MESH_H
#define PCS_IO_INTERNAL_PLY_PLY_MESH_H

#include <pcs/IO/internal/Row_block.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/ply/ply_header.h>
#include <pcs/IO/points/Mesh_faces.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/*
  The integers of the list `vertex_indices` or `vertex_index` of the element `face` are the corners
  of the faces. All other values except the scalars of the vertices are kept as they are. Values are
  passed in file order, in native byte order; `p` is a property of the header.
*/
class Ply_mesh
{
public:
  Ply_mesh(const std::vector<Ply_element>& elements, std::shared_ptr<Mesh_faces> faces)
    : m_faces(std::move(faces)), m_begin(elements.data()), m_rows(elements.size())
  {
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const Ply_element& element = elements[e];
      m_rows[e].name = element.name;
      m_rows[e].number_of_rows = element.count;
      for (const Ply_property& p : element.properties)
        if (m_corners == nullptr && element.name == "face" && p.count_type &&
            !is_floating_point(p.type) && (p.name == "vertex_indices" || p.name == "vertex_index"))
          m_corners = &p;
        else if (element.name != "vertex" || p.count_type)
          m_rows[e].properties.push_back(p);
    }
  }

  //! whether the entries of the list are the corners of a face
  bool is_corner_list(const Ply_property& p) const { return &p == m_corners; }

  //! adds the length of a list other than the corners; returns whether its type can represent it
  bool add_length(const Ply_element& element, const Ply_property& p, std::uint64_t length)
  {
    return dispatch(*p.count_type, [&](auto tag) {
      typename decltype(tag)::type count{};
      std::array<unsigned char, 8> bytes{};
      const bool is_exact = convert(length, count);
      store(count, bytes.data(), false);
      add_value(element, *p.count_type, bytes.data());
      return is_exact;
    });
  }

  //! adds a scalar, or an entry of a list other than the corners
  void add_value(const Ply_element& element, Scalar_type type, const unsigned char* value)
  {
    std::vector<unsigned char>& bytes = m_rows[static_cast<std::size_t>(&element - m_begin)].bytes;
    bytes.insert(bytes.end(), value, value + size_of(type));
  }

  //! adds a corner of the current face; returns whether it is the index of a vertex
  bool add_corner(Scalar_type type, const unsigned char* value)
  {
    return dispatch(type, [&](auto tag) {
      const auto vertex = load<typename decltype(tag)::type>(value, false);
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= m_faces->number_of_vertices)
        return false;
      m_faces->vertices.push_back(static_cast<std::uint32_t>(vertex));
      return true;
    });
  }

  void end_face() { m_faces->ends.push_back(m_faces->vertices.size()); }

  const Mesh_faces& faces() const { return *m_faces; }

  //! passes the elements with values to the faces
  void finish()
  {
    for (Element_rows& rows : m_rows)
      if (!rows.bytes.empty())
        m_faces->elements.push_back(std::move(rows));
  }

private:
  std::shared_ptr<Mesh_faces> m_faces;
  const Ply_element* m_begin;
  const Ply_property* m_corners = nullptr;
  std::vector<Element_rows> m_rows; // one per element of the header
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_PLY_PLY_MESH_H

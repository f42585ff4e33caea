// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Faces of a mesh whose vertices are the points of a table, and further values of PLY files.

#ifndef PCS_IO_POINTS_MESH_FACES_H
#define PCS_IO_POINTS_MESH_FACES_H

#include <pcs/IO/points/Scalar_type.h>
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief A property of a PLY element: a scalar, or a list if `count_type` is set.
*/
struct Element_property
{
  std::string name;
  Scalar_type type = Scalar_type::float64;
  std::optional<Scalar_type> count_type; //!< type of the length of a list
};

/*!
  \ingroup PkgPcsIORef
  \brief Values of a PLY element, row by row.

  The values of a row follow each other without gaps, in native byte order and in the order of
  `properties`. The length precedes the entries of a list.
*/
struct Element_rows
{
  std::string name;
  std::uint64_t number_of_rows = 0; //!< [count]
  std::vector<Element_property> properties;
  std::vector<unsigned char> bytes;
};

/*!
  \ingroup PkgPcsIORef
  \brief Polygons whose corners are points of a table.

  Face `i` has the corners `vertices[j]` for `ends[i - 1] <= j < ends[i]`, with `ends[-1] = 0`. The
  indices refer to the points in file order, from 0. They remain valid while no point is added,
  removed or moved to another index.
*/
struct Mesh_faces
{
  std::uint64_t number_of_vertices = 0; //!< number of points to which the indices refer [count]
  std::vector<std::uint64_t> ends;
  std::vector<std::uint32_t> vertices;

  //! Other values of a PLY file, which only PLY can hold: `vertex` has the lists of the vertices,
  //! `face` the properties of the faces without their corners. If there are no polygons, `face` is
  //! an element as any other.
  std::vector<Element_rows> elements;

  //! sentences on what of the mesh was not read
  std::vector<std::string> warnings;

  std::size_t number_of_faces() const { return ends.size(); }
  bool is_empty() const { return ends.empty() && elements.empty(); }

  //! returns the element of that name, or null
  const Element_rows* find(const std::string& name) const
  {
    for (const Element_rows& element : elements)
      if (element.name == name)
        return &element;
    return nullptr;
  }

  //! throws `pcs::Invalid_input` unless all indices, ends and elements are valid
  void check() const;
};

namespace internal {

//! calls `use(type, bytes)` for the values of the row at `begin`; returns the end of the row
template <class Use>
std::optional<std::size_t>
for_each_value(const Element_rows& rows, std::size_t begin, const Use& use)
{
  const auto fits = [&](std::uint64_t n, Scalar_type type) {
    return n <= (rows.bytes.size() - begin) / size_of(type);
  };
  for (const Element_property& p : rows.properties) {
    std::uint64_t n = 1;
    if (p.count_type) {
      if (!fits(1, *p.count_type))
        return std::nullopt;
      n = dispatch(*p.count_type, [&](auto tag) {
        typename decltype(tag)::type count;
        std::memcpy(&count, rows.bytes.data() + begin, sizeof count);
        return count < 0 ? std::numeric_limits<std::uint64_t>::max()
                         : static_cast<std::uint64_t>(count);
      });
      use(*p.count_type, rows.bytes.data() + begin);
      begin += size_of(*p.count_type);
    }
    if (!fits(n, p.type))
      return std::nullopt;
    for (std::uint64_t i = 0; i < n; ++i, begin += size_of(p.type))
      use(p.type, rows.bytes.data() + begin);
  }
  return begin;
}

inline void check_rows(const Element_rows& rows)
{
  if (rows.properties.empty())
    throw Invalid_input("pcs::IO::Mesh_faces: the element '" + rows.name + "' has no properties");
  std::optional<std::size_t> end = 0;
  for (std::uint64_t i = 0; i < rows.number_of_rows && end; ++i)
    end = for_each_value(rows, *end, [](Scalar_type, const unsigned char*) {});
  if (!end || *end != rows.bytes.size())
    throw Invalid_input("pcs::IO::Mesh_faces: the element '" + rows.name +
                        "' has more or fewer bytes than its " +
                        std::to_string(rows.number_of_rows) + " rows");
}

} // namespace internal

inline void Mesh_faces::check() const
{
  std::uint64_t begin = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i] > vertices.size() || ends[i] < begin || ends[i] - begin < 3)
      throw Invalid_input("pcs::IO::Mesh_faces: face " + std::to_string(i) + " ends at " +
                          std::to_string(ends[i]) + ", expected 3 or more vertices");
    for (; begin < ends[i]; ++begin)
      if (vertices[begin] >= number_of_vertices)
        throw Invalid_input("pcs::IO::Mesh_faces: face " + std::to_string(i) + " has the vertex " +
                            std::to_string(vertices[begin]) + " of " +
                            std::to_string(number_of_vertices) + " vertices");
  }
  if (begin != vertices.size())
    throw Invalid_input("pcs::IO::Mesh_faces: there are vertices after the last face");
  for (const Element_rows& rows : elements) {
    internal::check_rows(rows);
    const bool is_of_faces = rows.name == "face" && !ends.empty();
    if ((is_of_faces && rows.number_of_rows != ends.size()) ||
        (rows.name == "vertex" && rows.number_of_rows != number_of_vertices))
      throw Invalid_input("pcs::IO::Mesh_faces: the element '" + rows.name + "' has " +
                          std::to_string(rows.number_of_rows) + " rows, expected one per " +
                          rows.name);
  }
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_POINTS_MESH_FACES_H

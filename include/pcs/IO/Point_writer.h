// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a point file in chunks; the file appears only when it is complete.

#ifndef PCS_IO_POINT_WRITER_H
#define PCS_IO_POINT_WRITER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/internal/open_format.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief Writes a point file in chunks.

  The data are written to a temporary file in the same folder, which `commit()` renames. Until then
  an existing file of that name is unchanged and may be read at the same time. Without `commit()`
  the destructor removes the temporary file. Devices and pipes are written directly.

  Properties are written in the order and type of the schema; coordinates are doubles unless
  `Write_options::keep_coordinate_types` is set. Faces are written if they are passed in
  `Write_options::faces`, to PLY, OFF, OBJ and glTF. Text is read back as `float64` columns. OFF,
  OBJ and glTF reject properties that they cannot store. LAS and LAZ round coordinates to their grid
  and store properties that their point format lacks as extra bytes. LAZ needs LASzip (CMake option
  `PCS_WITH_LASZIP`).

  Errors of the file system and of the format throw `pcs::IO_error`, data that do not match the
  schema throw `pcs::Invalid_input`. After either, `commit()` is not possible.
*/
class Point_writer
{
public:
  //! opens the temporary file and writes the header
  Point_writer(const std::string& path,
               const Point_schema& schema,
               const Write_options& options = Write_options())
    : m_schema(schema), m_expected(options.number_of_points)
  {
    check_schema();
    if (options.faces) {
      options.faces->check();
      m_number_of_vertices = options.faces->number_of_vertices;
    }
    m_format = open(path, options);
  }

  /*!
    \brief writes the points of `chunk`.

    \pre `chunk` has the properties of the schema, in any order, and no others; its coordinates
         are finite
  */
  void append(const Point_table& chunk)
  {
    check_usable("append");
    m_is_usable = false;
    check_chunk(chunk);
    m_format->append(chunk);
    m_count += chunk.number_of_points();
    m_is_usable = true;
  }

  //! returns the number of points written so far
  std::uint64_t number_of_points() const { return m_count; }

  //! completes the file and renames it to its final name; `append()` is not possible afterwards
  void commit()
  {
    check_usable("commit");
    m_is_usable = false;
    if (m_expected && m_count != *m_expected)
      throw Invalid_input("pcs::IO::Point_writer::commit(): " + std::to_string(m_count) +
                          " points were appended, " + std::to_string(*m_expected) +
                          " were announced");
    if (m_number_of_vertices && m_count != *m_number_of_vertices)
      throw Invalid_input("pcs::IO::Point_writer::commit(): " + std::to_string(m_count) +
                          " points were appended, the faces belong to a mesh of " +
                          std::to_string(*m_number_of_vertices) + " vertices");
    m_format->commit(m_count);
  }

private:
  void check_schema() const
  {
    for (const char* name : {"x", "y", "z"})
      if (!m_schema.has(name))
        throw Invalid_input("pcs::IO::Point_writer: the schema has no property '" +
                            std::string(name) + "'");
    const std::string twice = internal::first_duplicate(m_schema);
    if (!twice.empty())
      throw Invalid_input("pcs::IO::Point_writer: the schema has the property '" + twice +
                          "' twice");
  }

  std::unique_ptr<internal::Format_writer> open(const std::string& path,
                                                const Write_options& options) const
  {
    const File_format format = options.format != File_format::automatic
                                   ? options.format
                                   : internal::format_by_extension(path);
    if (options.faces && (format == File_format::las || format == File_format::text))
      throw IO_error(
          path,
          "this format cannot hold faces; write ply, off, obj or glb, or the points only");
    switch (format) {
    case File_format::las:
      return internal::open_writer<File_format::las>(path, m_schema, options);
    case File_format::off:
      return internal::open_writer<File_format::off>(path, m_schema, options);
    case File_format::text:
      return internal::open_writer<File_format::text>(path, m_schema, options);
    case File_format::obj:
      return internal::open_writer<File_format::obj>(path, m_schema, options);
    case File_format::glb:
      return internal::open_writer<File_format::glb>(path, m_schema, options);
    case File_format::pcd:
    case File_format::ptx:
      throw IO_error(path,
                     "this format can only be read; write ply, las, off, obj, glb, xyz, txt or "
                     "csv");
    case File_format::ply:
    case File_format::automatic:
      break;
    }
    return internal::open_writer<File_format::ply>(path, m_schema, options);
  }

  void check_usable(const std::string& caller) const
  {
    if (!m_is_usable)
      throw Invalid_input("pcs::IO::Point_writer::" + caller +
                          "(): an earlier call failed, or the file is committed");
  }

  void check_chunk(const Point_table& chunk) const
  {
    chunk.check_sizes("points()");
    for (const Property_description& p : m_schema.properties) {
      const std::size_t i = chunk.schema().find(p.name);
      const bool is_there =
          i < chunk.schema().properties.size() &&
          (is_coordinate_name(p.name) || chunk.schema().properties[i].type == p.type);
      if (!is_there)
        throw Invalid_input("pcs::IO::Point_writer::append(): the chunk has no property '" +
                            p.name + "' of type " + name_of(p.type));
    }
    if (chunk.schema().properties.size() != m_schema.properties.size())
      throw Invalid_input("pcs::IO::Point_writer::append(): the chunk has properties that are not "
                          "in the schema");
    if (m_expected && chunk.number_of_points() > *m_expected - m_count)
      throw Invalid_input("pcs::IO::Point_writer::append(): more points than the announced " +
                          std::to_string(*m_expected));
    if (m_number_of_vertices && chunk.number_of_points() > *m_number_of_vertices - m_count)
      throw Invalid_input("pcs::IO::Point_writer::append(): more points than the " +
                          std::to_string(*m_number_of_vertices) + " vertices of the faces");
    internal::check_finite(chunk);
  }

  Point_schema m_schema;
  std::optional<std::uint64_t> m_expected;
  std::optional<std::uint64_t> m_number_of_vertices; // of the mesh to which faces belong
  std::unique_ptr<internal::Format_writer> m_format;
  std::uint64_t m_count = 0;
  bool m_is_usable = true;
};

} // namespace IO
} // namespace pcs

#endif // PCS_IO_POINT_WRITER_H

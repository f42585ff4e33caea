// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Interface of the readers of all formats, which read in chunks.

#ifndef PCS_IO_INTERNAL_FORMAT_READER_H
#define PCS_IO_INTERNAL_FORMAT_READER_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/Row_block.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>

namespace pcs {
namespace IO {
namespace internal {

class Format_reader
{
public:
  virtual ~Format_reader() = default;

  /*!
    Replaces the block by at most `max_rows` next rows; no rows indicate the end. The data after
    the points are checked before the last rows are returned, so that a file whose points have all
    been returned is valid.
  */
  virtual void read_rows(Row_block& block, std::size_t max_rows) = 0;

  //! throws the error for a row of the current block
  [[noreturn]] virtual void fail_at(std::uint64_t location, const std::string& what) const = 0;

  /*!
    Appends the rows of the current block to a table with the properties of the schema. `first` is
    the index of the first row in the file, for the error of a coordinate that is not finite.
  */
  virtual void append_rows(const Row_block& block, std::uint64_t first, Point_table& table) const
  {
    internal::append_rows(block, m_layout, table, [&](std::size_t row, const std::string& what) {
      fail_at(block.locations[row], "point " + std::to_string(first + row) + ": " + what);
    });
  }

  const Point_schema& schema() const { return m_schema; }
  const Row_layout& layout() const { return m_layout; }
  std::optional<std::uint64_t> number_of_points() const { return m_number_of_points; }
  //! returns a number of points that the size of the file makes plausible, to reserve memory
  virtual std::uint64_t largest_plausible_count() const { return m_number_of_points.value_or(0); }
  //! returns the faces, complete after the last rows; null if they are not kept
  const std::shared_ptr<Mesh_faces>& faces() const { return m_faces; }

protected:
  void add_property(const std::string& name, Scalar_type type)
  {
    m_layout.push_back(name, type);
    m_schema.properties.push_back({name, type});
  }
  //! keeps the faces, unless there are more vertices than 32-bit indices
  void keep_faces(std::uint64_t number_of_vertices)
  {
    if (number_of_vertices > std::uint64_t(std::numeric_limits<std::uint32_t>::max()) + 1)
      return;
    m_faces = std::make_shared<Mesh_faces>();
    m_faces->number_of_vertices = number_of_vertices;
  }
  //! adds a warning if the file is a mesh of which only the vertices are read
  void warn_of_faces(std::uint64_t number_of_faces)
  {
    if (number_of_faces > 0 && !m_faces)
      m_schema.warnings.push_back("the vertices of the mesh are read as points, its " +
                                  std::to_string(number_of_faces) + " faces are left out");
  }
  //! resizes the block to at most `max_rows` rows
  void start_block(Row_block& block, std::size_t max_rows) const
  {
    block.bytes.resize(max_rows * m_layout.row_size);
    block.locations.clear();
    block.number_of_rows = 0;
  }

  Point_schema m_schema;
  Row_layout m_layout;
  std::optional<std::uint64_t> m_number_of_points;
  std::shared_ptr<Mesh_faces> m_faces; // null: faces are not kept
};

//! returns the message for the next face of a mesh if it is no polygon
inline std::string polygon_expected(const Mesh_faces& faces, std::uint64_t number_of_vertices)
{
  return "face " + std::to_string(faces.number_of_faces()) + " has " +
         std::to_string(number_of_vertices) +
         " vertices, expected 3 or more; remove it, or read the points only";
}

//! returns the message for an index, counted from 0, that is not below the number of vertices
inline std::string vertex_expected(const std::string& found, std::uint64_t number_of_vertices)
{
  return "expected the index of a vertex, from 0, in a mesh of " +
         std::to_string(number_of_vertices) + " vertices, found " + found;
}

//! returns the first name that occurs twice, or an empty string
inline std::string first_duplicate(const Point_schema& schema)
{
  std::unordered_set<std::string> names;
  for (const Property_description& p : schema.properties)
    if (!names.insert(p.name).second)
      return p.name;
  return {};
}

//! returns the message for a word that is not a number of the expected type
inline std::string number_expected(std::string_view word,
                                   const std::string& name,
                                   Scalar_type type,
                                   Parse_result result)
{
  std::string text = "expected a number of type " + std::string(name_of(type)) + " for '" + name +
                     "', found " + in_quotes(word);
  if (result == Parse_result::out_of_range)
    text += ", which is out of range";
  else if (word.find(',') != std::string_view::npos)
    text += "; a decimal comma is not supported, write decimals with a point";
  return text;
}

//! checks that only blank lines follow
inline void expect_end_of_text(Input_file& file)
{
  std::string_view line;
  while (file.read_line(line))
    if (!trim(line).empty())
      file.fail_at_line("expected the end of the file, found " + in_quotes(trim(line)));
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_FORMAT_READER_H

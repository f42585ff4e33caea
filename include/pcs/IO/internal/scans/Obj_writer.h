// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes points as the vertices of an OBJ file, with the faces of a mesh.

#ifndef PCS_IO_INTERNAL_SCANS_OBJ_WRITER_H
#define PCS_IO_INTERNAL_SCANS_OBJ_WRITER_H

#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/points/Write_options.h>

#include <cstdint>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

/*
  Vertices of OBJ files have a weight or three colours from 0 to 1, or neither. Data with other
  properties are rejected rather than written without them.
*/
class Obj_writer : public Format_writer
{
public:
  Obj_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
    : Format_writer(path, options.faces)
  {
    for (const char* name : {"x", "y", "z"})
      m_layout.push_back(name, Scalar_type::float64);
    if (schema.has("weight"))
      add_number(schema, "weight");
    else if (schema.has("red") && schema.has("green") && schema.has("blue"))
      for (const char* name : {"red", "green", "blue"})
        add_number(schema, name);
    check_all_written(schema, "OBJ");
  }

private:
  void add_number(const Point_schema& schema, const char* name)
  {
    const Scalar_type type = schema.properties[schema.find(name)].type;
    if (!is_floating_point(type))
      m_file.fail(std::string("OBJ stores weights and colours from 0 to 1 as floating point "
                              "numbers, '") +
                  name + "' is of type " + name_of(type) + "; write PLY instead");
    m_layout.push_back(name, type);
  }

  void write_rows(const Row_block& block) override { write_rows_as_text(block, ' ', false, "v "); }

  void finish(std::uint64_t) override
  {
    write_faces_as_text([](std::string& text, std::uint64_t) { text += "f"; }, 1);
  }
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_SCANS_OBJ_WRITER_H

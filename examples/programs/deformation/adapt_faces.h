// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reduces the faces of a mesh to what the format of the output can hold.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_ADAPT_FACES_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_ADAPT_FACES_H

#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_schema.h>

#include <memory>
#include <string>
#include <vector>

namespace program {

/// Adds a warning for each value that only PLY can hold.
inline void warn_of_elements(const pcs::IO::Mesh_faces& faces, std::vector<std::string>& warnings)
{
  for (const pcs::IO::Element_rows& rows : faces.elements) {
    const bool is_of_faces = rows.name == "face" && faces.number_of_faces() > 0;
    if (is_of_faces || rows.name == "vertex")
      for (const pcs::IO::Element_property& p : rows.properties)
        warnings.push_back((p.count_type ? "the list '" : "the property '") + p.name + "' of the " +
                           (is_of_faces ? "faces" : "vertices") +
                           " is left out; write PLY to keep it");
    else
      warnings.push_back("the element '" + rows.name + "' with " +
                         std::to_string(rows.number_of_rows) +
                         " rows is left out; write PLY to keep it");
  }
}

/// Removes from `faces`, which may be null, what the output cannot hold, with warnings.
inline void adapt_faces(std::shared_ptr<pcs::IO::Mesh_faces>& faces,
                        const std::string& output,
                        std::vector<std::string>& warnings)
{
  using pcs::IO::File_format;
  if (!faces)
    return;
  warnings.insert(warnings.end(), faces->warnings.begin(), faces->warnings.end());
  const File_format format = pcs::IO::internal::format_by_extension(output);
  if (format != File_format::ply) {
    warn_of_elements(*faces, warnings);
    faces->elements.clear();
  }
  const bool is_mesh_format = format == File_format::ply || format == File_format::off ||
                              format == File_format::obj || format == File_format::glb;
  if (!is_mesh_format && faces->number_of_faces() > 0)
    warnings.push_back("the " + std::to_string(faces->number_of_faces()) +
                       " faces of the mesh are left out; write PLY, OFF, OBJ or glTF to keep "
                       "them");
  if (!is_mesh_format || faces->is_empty())
    faces = nullptr;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_ADAPT_FACES_H

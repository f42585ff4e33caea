// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options for writing a point file.

#ifndef PCS_IO_POINTS_WRITE_OPTIONS_H
#define PCS_IO_POINTS_WRITE_OPTIONS_H

#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_schema.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

namespace pcs {
namespace IO {

//! the representation of numbers in a PLY file
enum class Ply_encoding { binary_little_endian, binary_big_endian, ascii };

//! whether a text file begins with the names of its columns
enum class Text_header {
  automatic, //!< in csv files, and if a name would be lost otherwise
  always,
  never
};

/*!
  \ingroup PkgPcsIORef
  \brief Options for writing a point file; the defaults are lossless.
*/
struct Write_options
{
  //! `automatic`: by the extension of the file
  File_format format = File_format::automatic;

  Ply_encoding ply_encoding = Ply_encoding::binary_little_endian;

  //! PLY: write coordinates in the type of `Point_schema` instead of `double`. A `float` has
  //! 7 digits, too few for millimetres in most map projections.
  bool keep_coordinate_types = false;

  //! the total number, checked by `Point_writer::commit()`; permits pipes, and headers without
  //! padding
  std::optional<std::uint64_t> number_of_points;

  //! text: one of blank, tab, comma, semicolon; by default a comma in csv files, otherwise a blank
  std::optional<char> text_separator;
  Text_header text_header = Text_header::automatic;

  //! LAS and LAZ: length of one step of the stored integers [L], and the coordinate of the integer
  //! 0 [L]. By default those of the LAS file that was read; `write_points()` computes them
  //! otherwise.
  std::optional<std::array<double, 3>> las_scale;
  std::optional<std::array<double, 3>> las_offset;

  //! PLY, OFF, OBJ, glTF: faces whose indices refer to the points in the order in which they are
  //! written
  std::shared_ptr<const Mesh_faces> faces;
};

} // namespace IO
} // namespace pcs

#endif // PCS_IO_POINTS_WRITE_OPTIONS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a point file in chunks, so that files larger than memory can be handled.

#ifndef PCS_IO_POINT_READER_H
#define PCS_IO_POINT_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Row_block.h>
#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/internal/open_format.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief Reads a point file in chunks.

  The format is recognised by its first bytes (`ply`, `LASF`, `# .PCD`, `OFF` and its variants). A
  file without them is read by its extension: pcd, ptx, obj, or text if it is xyz, txt, csv, asc,
  pts or pwn.

  A file that is compressed by gzip is unpacked while it is read, where zlib is available (CMake
  option `PCS_WITH_ZLIB`); the extension `.gz` is skipped. Formats that state counts (PLY, OFF, LAS,
  PCD, PTX) are unpacked twice, to compare the counts with the unpacked size, and LAS files with
  data after the points up to four times. LAZ inside gzip is refused.

  The reader checks its input. Counts are compared with the size of the file before memory is
  allocated. Coordinates must be finite, other properties need not be. The file must end where its
  header states. A violation throws `pcs::IO_error` with the file, the line or byte, and the
  expected content.

  - PLY: ascii and binary of both byte orders. Scalar properties of `vertex` are read in their own
    type (`int64` and `uint64` are an extension). Lists and other elements, such as faces, are
    checked, and discarded unless `do_keep_faces` is set.
  - Text: columns separated by blanks, tabs, commas or semicolons, all read as `float64`. Lines
    that begin with `#`, `%` or `//` are comments. The columns are named by a line without numbers
    or by the comment before the first row; coordinates may have names such as `Easting`,
    `y_coord`, `Height`. Otherwise the columns are `x`, `y`, `z`, `column_4`, `column_5`, ...
    Missing values (`NA`, `nan`, nothing) are NaN, but not in coordinates. Columns of text are left
    out, with a warning in `Point_schema::warnings`. Decimal commas are read unless commas separate
    columns.
  - OFF, NOFF, COFF, CNOFF: `nx`, `ny`, `nz` and `red`, `green`, `blue`, `alpha`; faces are
    checked, and discarded unless `do_keep_faces` is set.
  - LAS 1.0 to 1.4, point formats 0 to 10, and LAZ where LASzip is available (CMake option
    `PCS_WITH_LASZIP`): every dimension is a property. Extra bytes are properties with the name in
    the file if it describes them, otherwise `extra_byte_0`, ...
    Header, VLRs and EVLRs are stored in `Point_schema::las`, in memory.
  - PCD: ascii, binary and binary_compressed, the last in memory. Fields are read in their own type;
    `rgb` is `red`, `green`, `blue`. Points with NaN coordinates are beams without return. They
    are left out.
  - PTX: the matrix of each scan is applied; `scan` is its index. Points at 0 0 0 are beams without
    return. They are left out.
  - OBJ: vertices, with a weight or colours, and on request faces. Normals, textures and groups are
    discarded.

  \par Memory
  One chunk, the faces if they are kept, and buffers of less than 1 MB; a line of text may require
  up to 16 MB more.
*/
class Point_reader
{
public:
  /*!
    \brief opens the file and reads its header; throws `pcs::IO_error`.

    With `do_keep_faces`, the faces of PLY, OFF and OBJ files, and the lists and other elements of
    PLY files, are kept in memory.
  */
  explicit Point_reader(const std::string& path, bool do_keep_faces = false)
    : m_format(open(path, do_keep_faces))
  {
  }

  //! returns the number of points if it is known, as for all formats except text, PCD and PTX
  std::optional<std::uint64_t> number_of_points() const { return m_format->number_of_points(); }

  //! returns the properties of the points
  const Point_schema& schema() const { return m_format->schema(); }

  /*!
    \brief returns the faces of the mesh.

    They are complete after the last points were read. Null unless `do_keep_faces` was set and the
    file is PLY, OFF or OBJ with at most 2^32 vertices.
  */
  const std::shared_ptr<Mesh_faces>& faces() const { return m_format->faces(); }

  /*!
    \brief replaces `chunk` by the next points, at most `max_points` of them.

    \return whether points were read; after the last points the file was checked up to its end
    \pre `max_points > 0`, else `pcs::Invalid_input`

    If it throws, `chunk` is empty and the reader can only be destroyed.
  */
  bool read(Point_table& chunk, std::size_t max_points)
  {
    if (max_points == 0)
      throw Invalid_input("pcs::IO::Point_reader::read(): max_points is 0, expected 1 or more");
    if (m_has_failed)
      throw Invalid_input("pcs::IO::Point_reader::read(): an earlier call failed");
    prepare(chunk);
    m_has_failed = true;
    try {
      fill(chunk, max_points);
    } catch (...) {
      chunk.clear();
      throw;
    }
    m_has_failed = false;
    return chunk.number_of_points() > 0;
  }

private:
  static std::unique_ptr<internal::Format_reader> open(const std::string& path, bool do_keep_faces)
  {
    switch (internal::format_by_content(path)) {
    case File_format::ply:
      return internal::open_reader<File_format::ply>(path, do_keep_faces);
    case File_format::las:
      return internal::open_reader<File_format::las>(path, do_keep_faces);
    case File_format::off:
      return internal::open_reader<File_format::off>(path, do_keep_faces);
    case File_format::pcd:
      return internal::open_reader<File_format::pcd>(path, do_keep_faces);
    case File_format::ptx:
      return internal::open_reader<File_format::ptx>(path, do_keep_faces);
    case File_format::obj:
      return internal::open_reader<File_format::obj>(path, do_keep_faces);
    case File_format::glb:
      throw IO_error(path,
                     "glTF can only be written; export the mesh as PLY or OBJ, with Blender for "
                     "example");
    case File_format::text:
    case File_format::automatic:
      break;
    }
    return internal::open_reader<File_format::text>(path, do_keep_faces);
  }

  //! prepares a chunk and reuses its memory
  void prepare(Point_table& chunk) const
  {
    if (chunk.schema().properties == schema().properties && chunk.schema().las == schema().las &&
        chunk.schema().format == schema().format && chunk.schema().comments == schema().comments &&
        chunk.schema().obj_info == schema().obj_info &&
        chunk.schema().warnings == schema().warnings)
      chunk.clear();
    else
      chunk = Point_table(schema());
  }

  void fill(Point_table& chunk, std::size_t max_points)
  {
    const std::size_t rows_per_block = internal::rows_per_block(m_format->layout());
    if (points_left())
      chunk.points().reserve(static_cast<std::size_t>(std::min(
          {std::uint64_t(max_points), *points_left(), m_format->largest_plausible_count()})));
    while (chunk.number_of_points() < max_points) {
      m_format->read_rows(m_block, std::min(rows_per_block, max_points - chunk.number_of_points()));
      if (m_block.number_of_rows == 0)
        break;
      m_format->append_rows(m_block, m_points_read, chunk);
      m_points_read += m_block.number_of_rows;
    }
  }

  std::optional<std::uint64_t> points_left() const
  {
    if (!number_of_points())
      return std::nullopt;
    return *number_of_points() - m_points_read;
  }

  std::unique_ptr<internal::Format_reader> m_format;
  internal::Row_block m_block;
  std::uint64_t m_points_read = 0;
  bool m_has_failed = false;
};

} // namespace IO
} // namespace pcs

#endif // PCS_IO_POINT_READER_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a whole point file.

#ifndef PCS_IO_READ_POINTS_H
#define PCS_IO_READ_POINTS_H

#include <pcs/IO/Point_reader.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <CGAL/Kernel_traits.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief reads all points of a file with all their properties.

  Formats and rules are those of `Point_reader`. Faces and other elements are discarded.

  \param path name of the file
  \return the points in the order of the file, with positions in its unit [L]; an empty table for a
          file that declares zero points
  \throws pcs::IO_error with the name of the file, the line or byte, and the expected content
  \par Complexity
  Linear in the size of the file.
  \par Determinism
  The result for a file is bitwise identical in every locale and on every machine.
*/
inline Point_table read_points(const std::string& path)
{
  Point_reader reader(path);
  Point_table table;
  reader.read(table, std::numeric_limits<std::size_t>::max());
  return table;
}

/*!
  \ingroup PkgPcsIORef
  \brief reads all points of a file as the first overload, and also the faces of a mesh.

  \param path name of the file
  \param faces is replaced by the faces, and the lists and other elements of a PLY file; null if the
         file has none of them. `Write_options::faces` writes them. Unchanged when an exception is
         thrown
  \return the points as of the first overload
  \throws pcs::IO_error as the first overload
*/
inline Point_table read_points(const std::string& path, std::shared_ptr<Mesh_faces>& faces)
{
  Point_reader reader(path, true);
  Point_table table;
  reader.read(table, std::numeric_limits<std::size_t>::max());
  faces = reader.faces() && !reader.faces()->is_empty() ? reader.faces() : nullptr;
  return table;
}

/*!
  \ingroup PkgPcsIORef
  \brief appends the positions of all points of a file to `points`.

  \tparam PointRange a container with `insert(end, first, last)`; its value type is the `Point_3`
          of a CGAL kernel
  \param path name of the file
  \param points receives the positions [L] at its end; unchanged when an exception is thrown
  \throws pcs::IO_error as the first overload, and if a coordinate is out of the range of the
          coordinate type of `points`
  \par Complexity
  Linear in the size of the file. Other properties of the points are held for 65,536 points at most.
*/
template <class PointRange>
void read_points(const std::string& path, PointRange& points)
{
  using Point = typename PointRange::value_type;
  using FT = typename CGAL::Kernel_traits<Point>::Kernel::FT;
  constexpr std::size_t chunk_size = 65536; // a few MB
  Point_reader reader(path);
  Point_table chunk;
  std::vector<Point> result;
  while (reader.read(chunk, chunk_size))
    for (const Point_table::Point_3& p : chunk.points()) {
      if constexpr (std::is_same_v<FT, float>)
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs(p[axis]) > double(std::numeric_limits<float>::max()))
            throw IO_error(path,
                           "point " + std::to_string(result.size()) +
                               ": the coordinate is out of the range of float");
      result.emplace_back(static_cast<FT>(p.x()), static_cast<FT>(p.y()), static_cast<FT>(p.z()));
    }
  points.insert(points.end(),
                std::make_move_iterator(result.begin()),
                std::make_move_iterator(result.end()));
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_POINTS_H

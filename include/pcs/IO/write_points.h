// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a whole point file.

#ifndef PCS_IO_WRITE_POINTS_H
#define PCS_IO_WRITE_POINTS_H

#include <pcs/IO/Point_writer.h>
#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/internal/las/las_metadata.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>

#include <CGAL/number_utils.h>

#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief writes a table with all its properties.

  The conditions are those of `Point_writer`. The file is written completely or not at all, so the
  table may be written to the file from which it was read.

  In LAS and LAZ files, points from a LAS file keep their scale and offset. If their coordinates
  cannot be represented with this offset, it is replaced. For other points, the scale is the
  smallest power of ten for which the longest side of the bounding box has at most 5e8 steps.

  \param path name of the file; its extension determines the format unless `options.format` is set
  \param table the points
  \param options options for writing; `number_of_points` is ignored. `faces` belong to the points in
         the order of the table.
  \throws pcs::IO_error when the file cannot be written, or the format cannot hold the data
  \throws pcs::Invalid_input when a coordinate is not finite or a property has the wrong size
  \par Complexity
  Linear in the number of points and properties.
*/
inline void write_points(const std::string& path,
                         const Point_table& table,
                         Write_options options = Write_options())
{
  table.check_sizes("points()");
  internal::check_finite(table);
  if (options.format == File_format::automatic)
    options.format = internal::format_by_extension(path);
  if (options.format == File_format::las)
    internal::choose_las_grid(path, table, options);
  options.number_of_points = table.number_of_points();
  Point_writer writer(path, table.schema(), options);
  writer.append(table);
  writer.commit();
}

/*!
  \ingroup PkgPcsIORef
  \brief writes the positions of a range of points.

  Errors and cost are those of the first overload.

  \tparam PointRange a range of `Point_3` of a CGAL kernel
  \param path name of the file
  \param points the points, in the order of the file [L]
  \param options options for writing
*/
template <class PointRange>
void write_points(const std::string& path,
                  const PointRange& points,
                  const Write_options& options = Write_options())
{
  std::vector<Point_table::Point_3> positions;
  for (const auto& p : points)
    positions.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
  write_points(path, Point_table(std::move(positions)), options);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_POINTS_H

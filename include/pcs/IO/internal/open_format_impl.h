// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The readers and writers of all formats.

#ifndef PCS_IO_INTERNAL_OPEN_FORMAT_IMPL_H
#define PCS_IO_INTERNAL_OPEN_FORMAT_IMPL_H

#include <pcs/IO/internal/Off_reader.h>
#include <pcs/IO/internal/Off_writer.h>
#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/internal/gltf/Glb_writer.h>
#include <pcs/IO/internal/las/Las_reader.h>
#include <pcs/IO/internal/las/Las_writer.h>
#include <pcs/IO/internal/las/Laz_reader.h>
#include <pcs/IO/internal/las/Laz_writer.h>
#include <pcs/IO/internal/open_format.h>
#include <pcs/IO/internal/ply/Ply_reader.h>
#include <pcs/IO/internal/ply/Ply_writer.h>
#include <pcs/IO/internal/scans/Obj_reader.h>
#include <pcs/IO/internal/scans/Obj_writer.h>
#include <pcs/IO/internal/scans/Pcd_reader.h>
#include <pcs/IO/internal/scans/Ptx_reader.h>
#include <pcs/IO/internal/text/Text_reader.h>
#include <pcs/IO/internal/text/Text_writer.h>
#include <pcs/core/errors.h>

#include <memory>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

inline std::unique_ptr<Format_reader> open_las_reader(const std::string& path)
{
  if (!has_compressed_points(path))
    return std::make_unique<Las_reader>(path);
#ifdef PCS_WITH_LASZIP
  return std::make_unique<Laz_reader>(path);
#else
  throw IO_error(path,
                 "the points are compressed (LAZ), and this program was built without LASzip; " +
                     laz_conversions());
#endif
}

inline std::unique_ptr<Format_writer>
open_las_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
{
  if (extension_of(path) != "laz")
    return std::make_unique<Las_writer>(path, schema, options);
#ifdef PCS_WITH_LASZIP
  return std::make_unique<Laz_writer>(path, schema, options);
#else
  throw IO_error(path,
                 "LAZ is written with LASzip only, and this program was built without it; build "
                 "pcs with LASzip (package liblaszip-dev where there is one, CMake variable "
                 "PCS_WITH_LASZIP), or write a file with the extension las and compress it: laszip "
                 "-i a.las -o a.laz, or pdal translate a.las a.laz");
#endif
}

template <File_format format>
std::unique_ptr<Format_reader> open_reader(const std::string& path,
                                           [[maybe_unused]] bool do_keep_faces)
{
  if constexpr (format == File_format::las)
    return open_las_reader(path);
  else if constexpr (format == File_format::off)
    return std::make_unique<Off_reader>(path, do_keep_faces);
  else if constexpr (format == File_format::ply)
    return std::make_unique<Ply_reader>(path, do_keep_faces);
  else if constexpr (format == File_format::pcd)
    return std::make_unique<Pcd_reader>(path);
  else if constexpr (format == File_format::ptx)
    return std::make_unique<Ptx_reader>(path);
  else if constexpr (format == File_format::obj)
    return std::make_unique<Obj_reader>(path, do_keep_faces);
  else
    return std::make_unique<Text_reader>(path);
}

template <File_format format>
std::unique_ptr<Format_writer>
open_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
{
  if constexpr (format == File_format::las)
    return open_las_writer(path, schema, options);
  else if constexpr (format == File_format::off)
    return std::make_unique<Off_writer>(path, schema, options);
  else if constexpr (format == File_format::ply)
    return std::make_unique<Ply_writer>(path, schema, options);
  else if constexpr (format == File_format::obj)
    return std::make_unique<Obj_writer>(path, schema, options);
  else if constexpr (format == File_format::glb)
    return std::make_unique<Glb_writer>(path, schema, options);
  else
    return std::make_unique<Text_writer>(path, schema, options);
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_OPEN_FORMAT_IMPL_H

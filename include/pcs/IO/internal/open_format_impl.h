// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The readers and writers of all formats.

#ifndef PCS_IO_INTERNAL_OPEN_FORMAT_IMPL_H
#define PCS_IO_INTERNAL_OPEN_FORMAT_IMPL_H

#include <pcs/IO/internal/Off_reader.h>
#include <pcs/IO/internal/Off_writer.h>
#include <pcs/IO/internal/text/Text_reader.h>
#include <pcs/IO/internal/text/Text_writer.h>
#include <pcs/IO/internal/las/Las_reader.h>
#include <pcs/IO/internal/las/Las_writer.h>
#include <pcs/IO/internal/open_format.h>
#include <pcs/IO/internal/ply/Ply_reader.h>
#include <pcs/IO/internal/ply/Ply_writer.h>

#include <memory>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

template <File_format format>
std::unique_ptr<Format_reader> open_reader(const std::string& path)
{
  if constexpr (format == File_format::las)
    return std::make_unique<Las_reader>(path);
  else if constexpr (format == File_format::off)
    return std::make_unique<Off_reader>(path);
  else if constexpr (format == File_format::ply)
    return std::make_unique<Ply_reader>(path);
  else
    return std::make_unique<Text_reader>(path);
}

template <File_format format>
std::unique_ptr<Format_writer>
open_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
{
  if constexpr (format == File_format::las)
    return std::make_unique<Las_writer>(path, schema, options);
  else if constexpr (format == File_format::off)
    return std::make_unique<Off_writer>(path, schema, options);
  else if constexpr (format == File_format::ply)
    return std::make_unique<Ply_writer>(path, schema, options);
  else
    return std::make_unique<Text_writer>(path, schema, options);
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_OPEN_FORMAT_IMPL_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Opens the reader or the writer of a format. The bodies may be compiled separately.

#ifndef PCS_IO_INTERNAL_OPEN_FORMAT_H
#define PCS_IO_INTERNAL_OPEN_FORMAT_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Write_options.h>

#include <memory>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

//! opens a file of this format and reads its header; `do_keep_faces` affects meshes only
template <File_format format>
std::unique_ptr<Format_reader> open_reader(const std::string& path, bool do_keep_faces);

//! opens a temporary file of this format and writes its header
template <File_format format>
std::unique_ptr<Format_writer>
open_writer(const std::string& path, const Point_schema& schema, const Write_options& options);

} // namespace internal
} // namespace IO
} // namespace pcs

#ifndef PCS_COMPILED_IO
#include <pcs/IO/internal/open_format_impl.h>
#endif

#endif // PCS_IO_INTERNAL_OPEN_FORMAT_H

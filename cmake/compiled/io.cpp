// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compiled once: the readers and writers of all formats of point files.

#include <pcs/IO/internal/open_format_impl.h>

namespace pcs {
namespace IO {
namespace internal {

#define PCS_INSTANTIATE(format)                                                                    \
  template std::unique_ptr<Format_reader> open_reader<format>(const std::string&, bool);           \
  template std::unique_ptr<Format_writer> open_writer<format>(const std::string&,                  \
                                                              const Point_schema&,                 \
                                                              const Write_options&);

PCS_INSTANTIATE(File_format::las)
PCS_INSTANTIATE(File_format::obj)
PCS_INSTANTIATE(File_format::off)
PCS_INSTANTIATE(File_format::ply)
PCS_INSTANTIATE(File_format::text)

#undef PCS_INSTANTIATE

template std::unique_ptr<Format_reader> open_reader<File_format::pcd>(const std::string&, bool);
template std::unique_ptr<Format_reader> open_reader<File_format::ptx>(const std::string&, bool);
template std::unique_ptr<Format_writer>
open_writer<File_format::glb>(const std::string&, const Point_schema&, const Write_options&);

} // namespace internal
} // namespace IO
} // namespace pcs

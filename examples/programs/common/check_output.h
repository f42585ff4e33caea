// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks that an output can be written before anything is computed.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_CHECK_OUTPUT_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_CHECK_OUTPUT_H

#include <pcs/IO/Point_writer.h>
#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Write_options.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace program {

/// Checks that the format can hold the data and that the folder is writable.
inline void check_output(const std::string& path, const pcs::IO::Point_schema& schema)
{
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
      !std::filesystem::is_directory(status)) {
    pcs::IO::internal::format_by_extension(path); // throws if there is none
    return;                                       // opening a pipe would write to it
  }
  pcs::IO::Write_options options;
  options.number_of_points = 0;
  options.las_scale = {1, 1, 1};
  options.las_offset = {0, 0, 0};
  const pcs::IO::Point_writer writer(path, schema, options); // is not committed
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_CHECK_OUTPUT_H

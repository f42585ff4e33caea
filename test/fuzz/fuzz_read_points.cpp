// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary bytes are a valid point file or an IO_error. The first byte selects the extension. A
// valid file is unchanged by writing and reading.

#include "Fuzz_file.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace {

using pcs_fuzz::check;

std::optional<pcs::IO::Point_table> read_whole(const std::string& path)
{
  try {
    return pcs::IO::read_points(path);
  } catch (const pcs::IO_error&) {
    return std::nullopt;
  }
}

std::optional<pcs::IO::Point_table> read_in_chunks(const std::string& path)
{
  try {
    pcs::IO::Point_reader reader(path);
    pcs::IO::Point_table all(reader.schema()), chunk;
    while (reader.read(chunk, 3))
      all.append(chunk);
    return all;
  } catch (const pcs::IO_error&) {
    return std::nullopt;
  }
}

// The format may reject the data. A written file must contain the same points.
void check_written(const pcs::IO::Point_table& table, const std::string& path)
{
  try {
    pcs::IO::write_points(path, table);
  } catch (const pcs::IO_error&) {
    return;
  } catch (const pcs::Invalid_input&) {
    return;
  }
  const std::optional<pcs::IO::Point_table> again = read_whole(path);
  check(again && again->number_of_points() == table.number_of_points());
  if (path.substr(path.size() - 3) != "las")
    check(again->points() == table.points());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  if (size == 0)
    return 0;
  const char* const names[] = {"i.xyz", "i.ply", "i.las", "i.pcd", "i.ptx", "i.obj", "i.off"};
  const std::string input = pcs_fuzz::write_file(names[data[0] % 7], data + 1, size - 1);
  const std::optional<pcs::IO::Point_table> whole = read_whole(input);
  const std::optional<pcs::IO::Point_table> parts = read_in_chunks(input);
  check(whole.has_value() == parts.has_value());
  if (!whole)
    return 0;
  check(whole->points() == parts->points());
  for (const char* name : {"/output.ply", "/output.csv", "/output.off", "/output.las"})
    check_written(*whole, pcs_fuzz::folder() + name);
  return 0;
}

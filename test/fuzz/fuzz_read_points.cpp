// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary bytes are a valid point file or an IO_error. A valid file is unchanged by writing and
// reading.

#include <pcs/IO/Point_reader.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <unistd.h>

namespace {

std::string folder()
{
  // A folder in memory is much faster than one on a disk.
  const std::filesystem::path base = std::filesystem::is_directory("/dev/shm")
                                         ? std::filesystem::path("/dev/shm")
                                         : std::filesystem::temp_directory_path();
  const std::filesystem::path path = base / ("pcs_fuzz_" + std::to_string(::getpid()));
  std::filesystem::create_directories(path);
  return path.string();
}

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

void check(bool ok)
{
  if (!ok)
    std::abort();
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
  static const std::string path = folder();
  const std::string input = path + "/input.xyz"; // data without a magic word is text
  std::ofstream(input, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const std::optional<pcs::IO::Point_table> whole = read_whole(input);
  const std::optional<pcs::IO::Point_table> parts = read_in_chunks(input);
  check(whole.has_value() == parts.has_value());
  if (!whole)
    return 0;
  check(whole->points() == parts->points());
  for (const char* name : {"/output.ply", "/output.csv", "/output.off", "/output.las"})
    check_written(*whole, path + name);
  return 0;
}

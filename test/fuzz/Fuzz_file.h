// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Files for the readers, and bytes as numbers for the algorithms.

#ifndef PCS_TEST_FUZZ_FUZZ_FILE_H
#define PCS_TEST_FUZZ_FUZZ_FILE_H

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <unistd.h>

namespace pcs_fuzz {

/// A folder that is removed at the end of the process.
class Folder
{
public:
  Folder()
  {
    // A folder in memory is much faster than one on a disk.
    const std::filesystem::path base = std::filesystem::is_directory("/dev/shm")
                                           ? std::filesystem::path("/dev/shm")
                                           : std::filesystem::temp_directory_path();
    m_path = base / ("pcs_fuzz_" + std::to_string(::getpid()));
    std::filesystem::create_directories(m_path);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(m_path, ignored);
  }

  std::string path() const { return m_path.string(); }

private:
  std::filesystem::path m_path;
};

inline std::string folder()
{
  static const Folder result;
  return result.path();
}

/// Writes the bytes to a file of this name, and returns its path.
inline std::string write_file(const std::string& name, const std::uint8_t* data, std::size_t size)
{
  const std::string path = folder() + "/" + name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return path;
}

inline void check(bool is_right)
{
  if (!is_right)
    std::abort();
}

/// Numbers from bytes; zeros after the last byte.
class Bytes
{
public:
  Bytes(const std::uint8_t* data, std::size_t size) : m_data(data), m_end(data + size) {}

  bool is_empty() const { return m_data == m_end; }
  std::uint8_t byte() { return is_empty() ? 0 : *m_data++; }

  /// A number from `low` to `high`, in steps of a 255th of their difference.
  double between(double low, double high) { return low + (high - low) * byte() / 255; }
  std::size_t count(std::size_t least, std::size_t most)
  {
    return least + (byte() + 256 * byte()) % (most - least + 1);
  }

  /// A coordinate: mostly a multiple of 1/64 in [0, 1024), but any bits of a double after a byte
  /// 255, so that values that are huge, tiny, infinite or NaN occur, too.
  double coordinate()
  {
    const std::uint8_t first = byte();
    if (first != 255)
      return (first + 256 * byte()) / 64.0;
    std::uint64_t bits = 0;
    for (int k = 0; k < 8; ++k)
      bits = 256 * bits + byte();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

private:
  const std::uint8_t* m_data;
  const std::uint8_t* m_end;
};

} // namespace pcs_fuzz

#endif // PCS_TEST_FUZZ_FUZZ_FILE_H

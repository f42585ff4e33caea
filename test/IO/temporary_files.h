// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Files for one test case, in a folder that is removed at its end, and checks of error messages.

#ifndef PCS_TEST_IO_TEMPORARY_FILES_H
#define PCS_TEST_IO_TEMPORARY_FILES_H

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/core/errors.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <unistd.h>

struct Temporary_files
{
  Temporary_files()
  {
    static int number = 0;
    folder = std::filesystem::temp_directory_path() /
             ("pcs_test_io_" + std::to_string(::getpid()) + "_" + std::to_string(++number));
    std::filesystem::create_directories(folder);
  }
  ~Temporary_files()
  {
    std::error_code error;
    std::filesystem::remove_all(folder, error);
  }

  std::string path(const std::string& name) const { return (folder / name).string(); }

  //! Writes a file with this content and returns its path.
  std::string file(const std::string& name, const std::string& content) const
  {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

  std::string content(const std::string& name) const
  {
    std::ifstream in(path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }

  std::size_t number_of_files() const
  {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
  }

  pcs::IO::Point_table read(const std::string& name, const std::string& content) const
  {
    return pcs::IO::read_points(file(name, content));
  }

  //! Returns the message of the expected read error, or a text that reports its absence.
  std::string error(const std::string& name, const std::string& content) const
  {
    const std::string path = file(name, content);
    try {
      pcs::IO::read_points(path);
    } catch (const pcs::IO_error& e) {
      BOOST_TEST(e.file_name() == path);
      return e.what();
    }
    return "no error";
  }

  //! Checks that reading fails with a message that contains `expected`.
  void
  refuses(const std::string& name, const std::string& content, const std::string& expected) const
  {
    const std::string message = error(name, content);
    BOOST_TEST(message.find(expected) != std::string::npos,
               "expected '" << expected << "' in '" << message << "'");
  }

  std::filesystem::path folder;
};

//! Appends the bytes of a value, little endian unless `is_big_endian`.
template <class T>
void put(std::string& bytes, T value, bool is_big_endian = false)
{
  pcs::IO::internal::store(
      value,
      reinterpret_cast<unsigned char*>(
          (bytes.resize(bytes.size() + sizeof value), bytes.data() + bytes.size() - sizeof value)),
      is_big_endian != pcs::IO::internal::is_big_endian_machine());
}

//! Overwrites bytes by a little endian value.
template <class T>
void patch(std::string& bytes, std::size_t at, T value)
{
  pcs::IO::internal::store(value,
                           reinterpret_cast<unsigned char*>(bytes.data()) + at,
                           pcs::IO::internal::is_big_endian_machine());
}

//! Checks whether two tables have bit-identical properties, values and positions.
inline bool are_equal(const pcs::IO::Point_table& a, const pcs::IO::Point_table& b)
{
  if (a.points() != b.points() || a.property_names() != b.property_names())
    return false;
  for (const std::string& name : a.property_names())
    if (a.property_values(name) != b.property_values(name))
      return false;
  return true;
}

#endif // PCS_TEST_IO_TEMPORARY_FILES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A text file that is checked to be writable before the work, and that appears only when it is
// complete; or standard output.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_REPORT_FILE_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_REPORT_FILE_H

#include <pcs/IO/internal/extensions.h>
#include <pcs/core/errors.h>

#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <ostream>
#include <streambuf>
#include <string>
#include <system_error>
#include <unistd.h>

namespace program {

/// The path `-` is standard output: what the program prints goes to standard error instead, so that
/// standard output holds the report alone.
class Report_file
{
public:
  explicit Report_file(const std::string& path) : m_path(path), m_target(path)
  {
    namespace fs = std::filesystem;
    if (path == "-") {
      m_standard_output = std::cout.rdbuf(std::cerr.rdbuf());
      return;
    }
    pcs::IO::internal::refuse_gz(path);
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_directory(status))
      throw pcs::IO_error(path, "is a directory, expected a file name");
    if (fs::exists(status) && !fs::is_regular_file(status))
      m_out.open(path); // a device or a pipe, which renaming would replace
    else {
      if (fs::exists(status))
        m_target = fs::canonical(path, error); // a symbolic link is kept
      static int number = 0;                   // distinguishes reports that are open in one folder
      m_temporary = m_target.parent_path() / (".unfinished_report_" + std::to_string(getpid()) +
                                              "_" + std::to_string(++number) + ".tmp");
      m_out.open(m_temporary);
    }
    if (!m_out)
      throw pcs::IO_error(path,
                          std::string("cannot be opened for writing: ") + std::strerror(errno));
    remove_temporary(); // exists only while it is written, because the work may be interrupted
  }

  Report_file(const Report_file&) = delete;
  Report_file& operator=(const Report_file&) = delete;

  ~Report_file()
  {
    remove_temporary();
    if (m_standard_output != nullptr)
      std::cout.rdbuf(m_standard_output);
  }

  /// Writes the report. Invalid UTF-8 in file names is replaced.
  void commit(const nlohmann::ordered_json& json)
  {
    commit(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  }

  void commit(const std::string& text)
  {
    if (m_standard_output != nullptr) {
      std::ostream out(m_standard_output);
      if (!(out << text << std::flush))
        throw pcs::IO_error("standard output", "the report cannot be written");
      return;
    }
    if (!m_temporary.empty())
      m_out.open(m_temporary);
    m_out << text;
    m_out.close();
    std::error_code error;
    if (m_out && !m_temporary.empty())
      std::filesystem::rename(m_temporary, m_target, error);
    if (!m_out || error)
      throw pcs::IO_error(m_path,
                          "cannot be written: " + (error ? error.message() : std::strerror(errno)));
    m_temporary.clear();
  }

private:
  void remove_temporary()
  {
    if (m_temporary.empty())
      return;
    m_out.close();
    std::error_code error;
    std::filesystem::remove(m_temporary, error);
  }

  std::string m_path;
  std::filesystem::path m_target;
  std::filesystem::path m_temporary; // empty if there is none
  std::ofstream m_out;
  std::streambuf* m_standard_output = nullptr; // of std::cout, if the report is written there
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_REPORT_FILE_H

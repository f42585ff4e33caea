// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A file that appears under its name only when it is complete.

#ifndef PCS_IO_INTERNAL_OUTPUT_FILE_H
#define PCS_IO_INTERNAL_OUTPUT_FILE_H

#include <pcs/IO/internal/extensions.h>
#include <pcs/core/errors.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#if defined(__linux__)
#include <fcntl.h>
#include <unistd.h>
#endif

namespace pcs {
namespace IO {
namespace internal {

/*
  Writes to a temporary file in the folder of the target; `commit()` renames it to the target. On
  systems that support it, the temporary file has no name until then. If the program is killed, no
  file remains. An existing target that is not a regular file, such as a device or a pipe, is
  written directly, because renaming would replace the device itself. Names with the extension
  `.gz` are refused, because nothing is compressed.
*/
class Output_file
{
public:
  explicit Output_file(const std::string& path) : m_path(path)
  {
    namespace fs = std::filesystem;
    refuse_gz(path);
    m_buffer.reserve(buffer_size); // first: nothing may throw once the file is open
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_directory(status))
      throw IO_error(path, "is a directory, expected a file name");
    m_target = path;
    if (fs::exists(status)) {
      // a symbolic link is kept: the file to which it refers is replaced
      const fs::path real = fs::canonical(path, error);
      if (!error)
        m_target = real;
    }
    if (fs::exists(status) && !fs::is_regular_file(status))
      m_file = std::fopen(path.c_str(), "wb");
    else if (!open_nameless())
      open_temporary();
    if (m_file == nullptr)
      throw IO_error(path, std::string("cannot be opened for writing: ") + std::strerror(errno));
  }

  Output_file(const Output_file&) = delete;
  Output_file& operator=(const Output_file&) = delete;

  ~Output_file()
  {
    if (m_file != nullptr)
      std::fclose(m_file);
    remove_temporary();
  }

  const std::string& path() const { return m_path; }

  void write(const void* data, std::size_t n)
  {
    const auto* bytes = static_cast<const char*>(data);
    if (m_buffer.size() + n > buffer_size)
      flush();
    if (n >= buffer_size)
      write_through(bytes, n);
    else
      m_buffer.insert(m_buffer.end(), bytes, bytes + n);
    m_position += n;
  }
  void write(std::string_view text) { write(text.data(), text.size()); }

  //! returns the number of bytes written so far
  std::size_t position() const { return m_position; }

  //! overwrites `n` bytes that were written before, from position `at`
  void patch(std::size_t at, const void* data, std::size_t n)
  {
    flush();
    if (std::fseek(m_file, static_cast<long>(at), SEEK_SET) != 0)
      fail();
    write_through(static_cast<const char*>(data), n);
    if (std::fseek(m_file, 0, SEEK_END) != 0)
      fail();
  }

  //! closes the file and renames it to its final name
  void commit()
  {
    flush();
    if (m_is_nameless)
      give_name();
    std::FILE* file = m_file;
    m_file = nullptr;
    if (std::fclose(file) != 0)
      fail();
    if (m_temporary.empty())
      return;
    std::error_code error;
    const auto status = std::filesystem::status(m_target, error);
    if (std::filesystem::exists(status))
      std::filesystem::permissions(m_temporary, status.permissions(), error);
    std::filesystem::rename(m_temporary, m_target, error);
    if (error)
      throw IO_error(m_path, "cannot be replaced: " + error.message());
    m_temporary.clear();
  }

  [[noreturn]] void fail(const std::string& what) const { throw IO_error(m_path, what); }

private:
  static constexpr std::size_t buffer_size = std::size_t(1) << 18;
  static constexpr int most_names = 1000;

  /// Does not contain the name of the target, which may already have the largest possible length.
  std::filesystem::path temporary_name(int i) const
  {
    return m_target.parent_path() / (".pcs_unfinished_" + std::to_string(i) + ".tmp");
  }

  void open_temporary()
  {
    for (int i = 0; i < most_names && m_file == nullptr; ++i) {
      m_temporary = temporary_name(i);
      m_file = std::fopen(m_temporary.string().c_str(), "wbx");
      if (m_file == nullptr && errno != EEXIST)
        break;
    }
    if (m_file == nullptr)
      m_temporary.clear(); // not created here, so it must not be removed
    else
      std::setvbuf(m_file, nullptr, _IONBF, 0);
  }

#if defined(__linux__) && defined(O_TMPFILE)
  /// Does not allocate memory.
  static std::array<char, 32> link_to(int file)
  {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "/proc/self/fd/%d", file);
    return name;
  }

  /// Returns `false` if the file system does not support files without a name, or cannot name
  /// them later.
  bool open_nameless()
  {
    const std::filesystem::path folder = m_target.parent_path();
    const int file =
        ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (file < 0)
      return false;
    if (::access(link_to(file).data(), F_OK) == 0)
      m_file = ::fdopen(file, "wb");
    if (m_file == nullptr) {
      ::close(file);
      return false;
    }
    std::setvbuf(m_file, nullptr, _IONBF, 0);
    return m_is_nameless = true;
  }

  void give_name()
  {
    const auto link = link_to(::fileno(m_file));
    for (int i = 0; i < most_names && m_temporary.empty(); ++i) {
      std::filesystem::path name = temporary_name(i); // before the file has this name
      if (::linkat(AT_FDCWD, link.data(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0)
        m_temporary.swap(name);
      else if (errno != EEXIST)
        break;
    }
    if (m_temporary.empty())
      fail();
  }
#else
  bool open_nameless()
  {
    return false;
  }
  void give_name() {}
#endif

  void remove_temporary()
  {
    std::error_code error;
    if (!m_temporary.empty())
      std::filesystem::remove(m_temporary, error);
    m_temporary.clear();
  }

  void flush()
  {
    write_through(m_buffer.data(), m_buffer.size());
    m_buffer.clear();
  }

  void write_through(const char* data, std::size_t n)
  {
    if (n > 0 && std::fwrite(data, 1, n, m_file) != n)
      fail();
    if (std::fflush(m_file) != 0)
      fail();
  }

  [[noreturn]] void fail() const
  {
    throw IO_error(m_path, std::string("cannot be written: ") + std::strerror(errno));
  }

  std::string m_path;
  std::filesystem::path m_target;
  std::filesystem::path m_temporary; // empty if there is none, or if it has no name yet
  bool m_is_nameless = false;
  std::FILE* m_file = nullptr;
  std::vector<char> m_buffer;
  std::size_t m_position = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_OUTPUT_FILE_H

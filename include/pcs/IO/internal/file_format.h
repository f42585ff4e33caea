// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detects the format of a file from its first bytes or its extension.

#ifndef PCS_IO_INTERNAL_FILE_FORMAT_H
#define PCS_IO_INTERNAL_FILE_FORMAT_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/Off_reader.h>
#include <pcs/IO/internal/extensions.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/core/errors.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace pcs {
namespace IO {
namespace internal {

//! returns an instruction for converting unsupported files with this extension; empty: none
inline std::string conversion_of(const std::string& extension)
{
  struct Conversion
  {
    const char* extension;
    const char* sentence;
  };
  constexpr std::array<Conversion, 13> conversions = {{
      {"e57", "convert the file to LAS: pdal translate a.e57 a.las, or CloudCompare"},
      {"bin", "convert the file to PLY or LAS with CloudCompare"},
      {"rcp", "export the project as PTS with Autodesk ReCap"},
      {"rcs", "export the scan as PTS with Autodesk ReCap"},
      {"fls", "export the scan as PTX, PTS or LAS with FARO SCENE"},
      {"fws", "export the scans as PTX, PTS or LAS with FARO SCENE"},
      {"zfs", "export the scan as PTX, PTS or LAS with Z+F LaserControl"},
      {"rxp", "export the scan as LAS with RiSCAN PRO"},
      {"rdbx", "export the scan as LAS with RiSCAN PRO"},
      {"ptg", "export the scan as PTX or PTS with Leica Cyclone"},
      {"bz2", "unpack the file: bunzip2 -k FILE"},
      {"zip", "unpack the file: unzip FILE"},
      {"7z", "unpack the file: 7z x FILE"},
  }};
  for (const Conversion& c : conversions)
    if (extension == c.extension)
      return c.sentence;
  return {};
}

//! returns the format with this extension; throws if it is unknown
inline File_format format_of_extension(const std::string& path, const std::string& extension)
{
  if (extension == "ply")
    return File_format::ply;
  if (extension == "off")
    return File_format::off;
  if (extension == "las" || extension == "laz")
    return File_format::las;
  if (extension == "pcd")
    return File_format::pcd;
  if (extension == "ptx")
    return File_format::ptx;
  if (extension == "obj")
    return File_format::obj;
  if (extension == "glb")
    return File_format::glb;
  for (const char* text : {"xyz", "txt", "csv", "asc", "pts", "pwn"})
    if (extension == text)
      return File_format::text;
  const std::string conversion = conversion_of(extension);
  if (!conversion.empty())
    throw IO_error(path, "files of type " + extension + " are not supported; " + conversion);
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw IO_error(path, "is a directory, expected a file name");
  throw IO_error(path,
                 (extension.empty() ? std::string("a name without extension")
                                    : "unknown format '" + extension + "'") +
                     ", expected ply, las, laz, off, obj, xyz, txt, csv, asc, pts or pwn, or for "
                     "input also pcd or ptx, or for output also glb");
}

//! returns the format that the extension of a file to be written indicates; throws if it is
//! unknown
inline File_format format_by_extension(const std::string& path)
{
  refuse_gz(path);
  return format_of_extension(path, extension_of(path));
}

//! returns the format that the first bytes of a file indicate, otherwise that of its extension;
//! the bytes are those of the unpacked file, and the extension `.gz` is skipped
inline File_format format_by_content(const std::string& path)
{
  Input_file file(path);
  if (file.is_at_end())
    throw IO_error(path, "the file is empty");
  std::array<char, 8> bytes{};
  file.read_at_most(bytes.data(), bytes.size());
  const std::string_view text(bytes.data(), bytes.size());
  const std::string_view word =
      text.substr(0, text.find_first_of(std::string_view(" \t\r\n\0", 5)));
  if (word == "ply")
    return File_format::ply;
  // the last bytes are flags, whose high byte is reserved; a column of text may be named LASF, too
  if (text.substr(0, 4) == "LASF" && text[7] == '\0')
    return File_format::las;
  if (text.substr(0, 6) == "# .PCD")
    return File_format::pcd;
  if (is_off_keyword(word))
    return File_format::off;
  // the reader of that format reports missing data
  return format_of_extension(path, extension_of(without_gz(path)));
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_FILE_FORMAT_H

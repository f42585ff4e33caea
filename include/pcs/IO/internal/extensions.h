// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The extension of a file name, in lower case and without that of a compression.

#ifndef PCS_IO_INTERNAL_EXTENSIONS_H
#define PCS_IO_INTERNAL_EXTENSIONS_H

#include <pcs/core/errors.h>

#include <filesystem>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

//! returns the extension in lower case and without its dot
inline std::string extension_of(const std::string& path)
{
  std::string text = std::filesystem::path(path).extension().string();
  if (!text.empty())
    text.erase(0, 1);
  for (char& c : text)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return text;
}

//! returns the name of an input without the extension `.gz`: `a.ply` for `a.ply.gz` and `a.ply`
inline std::string without_gz(const std::string& path)
{
  return extension_of(path) == "gz" ? std::filesystem::path(path).replace_extension().string()
                                    : path;
}

//! throws for the name of an output with the extension `.gz`
inline void refuse_gz(const std::string& path)
{
  if (extension_of(path) == "gz")
    throw IO_error(path,
                   "compressed files are only read; write the file without the extension gz, then "
                   "compress it: gzip FILE");
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_EXTENSIONS_H

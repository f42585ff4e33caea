// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Refuses to write a result over an input or over another result, whatever the spelling of the
// paths.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_DISTINCT_FILES_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_DISTINCT_FILES_H

#include <pcs/core/errors.h>

#include <filesystem>
#include <map>
#include <string>
#include <system_error>

namespace program {

class Distinct_files
{
public:
  /// Returns the canonical absolute path, which makes spellings comparable. The part that does not
  /// exist yet is normalised.
  static std::string real(const std::string& path)
  {
    std::error_code error;
    const auto absolute = std::filesystem::absolute(path);
    const auto canonical = std::filesystem::weakly_canonical(absolute, error);
    return (error ? absolute.lexically_normal() : canonical).string();
  }

  /// Adds an input. The same file may be an input twice; empty paths are ignored.
  void add_input(const std::string& path) { add(path, false); }

  /// Adds a result. Throws `pcs::Invalid_input` if `path` is an input or a previous result.
  void add_output(const std::string& path) { add(path, true); }

private:
  struct Use
  {
    std::string path;
    bool is_written;
  };

  void add(const std::string& path, bool is_written)
  {
    if (path.empty())
      return;
    const auto [at, is_new] = m_uses.emplace(real(path), Use{path, is_written});
    bool is_same = !is_new && (is_written || at->second.is_written);
    std::string other = at->second.path;
    std::error_code error;
    const auto links = std::filesystem::hard_link_count(path, error);
    if (is_new && !error && links > 1) // several names refer to the same file
      for (const auto& [name, use] : m_uses)
        if (name != at->first && (is_written || use.is_written) &&
            std::filesystem::equivalent(name, at->first, error)) {
          is_same = true;
          other = use.path;
        }
    if (is_same && path == "-" && other == path)
      throw pcs::Invalid_input("two results are to be written to standard output (-); "
                               "name a file for one of them");
    if (is_same && path == other)
      throw pcs::Invalid_input(path + " is named twice, they are the same file; a result would "
                                      "destroy it");
    if (is_same)
      throw pcs::Invalid_input(path + " and " + other +
                               " are the same file; a result would destroy it");
  }

  std::map<std::string, Use> m_uses; ///< by canonical path
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_DISTINCT_FILES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads landmarks from a JSON file or a table of text.

#ifndef PCS_EXAMPLES_PROGRAMS_FITTING_READ_LANDMARKS_H
#define PCS_EXAMPLES_PROGRAMS_FITTING_READ_LANDMARKS_H

#include "common/Json_value.h"
#include <pcs/IO/internal/extensions.h>
#include <pcs/core/errors.h>
#include <pcs/registration/Fit_options.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace program {

/// `[{"point": 12, "target": [x, y, z]}, ...]`
inline std::vector<pcs::Landmark> read_landmarks_json(const std::string& path)
{
  const Json json = read_json(path, "a list of landmarks");
  const Json_value root(json, path);
  if (!json.is_array())
    root.fail_expected("a list of {\"point\": number, \"target\": [x, y, z]}");
  std::vector<pcs::Landmark> result;
  for (std::size_t i = 0; i < root.size(); ++i) {
    const Json_value entry = root[i];
    entry.object({"point", "target"});
    if (!entry.has("point") || !entry.has("target"))
      entry.fail("`point` and `target` are needed");
    if (!entry["point"].json().is_number_unsigned())
      entry["point"].fail_expected("the number of a point, counted from 0");
    result.push_back({entry["point"].json().get<std::size_t>(), entry["target"].vector_3()});
  }
  return result;
}

/// Lines `point,x,y,z`, after an optional header with these names. Blanks are skipped.
inline std::vector<pcs::Landmark> read_landmarks_csv(const std::string& path)
{
  std::ifstream in(path);
  if (!in || std::filesystem::is_directory(path))
    throw pcs::IO_error(path, "cannot be opened for reading");
  std::vector<pcs::Landmark> result;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r')
      line.pop_back();
    if (number == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) // byte order mark
      line.erase(0, 3);
    std::string names = line;
    names.erase(std::remove_if(names.begin(),
                               names.end(),
                               [](char ch) { return ch == ' ' || ch == '\t' || ch == '"'; }),
                names.end());
    if (names.empty() || names[0] == '#' || (result.empty() && names == "point,x,y,z"))
      continue;
    std::istringstream text(line);
    std::int64_t point = -1;
    char a = 0, b = 0, c = 0, rest = 0;
    double x = 0, y = 0, z = 0;
    text >> point >> a >> x >> b >> y >> c >> z;
    if (!text || a != ',' || b != ',' || c != ',' || text >> rest || point < 0)
      throw pcs::IO_error(path,
                          "line " + std::to_string(number) +
                              ": expected point,x,y,z separated by commas, found " +
                              line.substr(0, 60));
    result.push_back({static_cast<std::size_t>(point), pcs::Similarity::Vec3(x, y, z)});
  }
  return result;
}

inline std::vector<pcs::Landmark> read_landmarks(const std::string& path)
{
  const bool is_json = pcs::IO::internal::extension_of(path) == "json";
  const auto result = is_json ? read_landmarks_json(path) : read_landmarks_csv(path);
  if (result.empty())
    throw pcs::IO_error(path, "there are no landmarks");
  return result;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_FITTING_READ_LANDMARKS_H

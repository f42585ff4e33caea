// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A page in one file: a template with scripts and styles, arrays of numbers, and their description.

#ifndef PCS_EXAMPLES_GALLERY_PAGE_H
#define PCS_EXAMPLES_GALLERY_PAGE_H

#include <pcs/core/errors.h>

#include <CGAL/Simple_cartesian.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace gallery {

using Json = nlohmann::ordered_json;
using Point = CGAL::Simple_cartesian<double>::Point_3;

/// Returns the contents of a text file.
inline std::string text_of_file(const std::string& path)
{
  if (std::filesystem::is_directory(path))
    throw pcs::IO_error(path, "is a folder, expected a file");
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in)
    throw pcs::IO_error(path, "cannot be read");
  return text;
}

inline std::string base64(const std::vector<unsigned char>& bytes)
{
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= n ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/*!
  Arrays are stored as base64 in little-endian byte order. Positions and radii are quantised to 16
  bits of the extent of the array: `offset + scale * number`.
*/
class Page
{
public:
  Json views = Json::array(); ///< what the scripts show

  /// Adds integers or single-precision numbers. Returns the description of the array.
  template <class T>
  Json add_numbers(const std::vector<T>& numbers)
  {
    static_assert(std::is_same_v<T, float> || std::is_unsigned_v<T>);
    std::vector<unsigned char> bytes;
    bytes.reserve(numbers.size() * sizeof(T));
    for (const T& number : numbers) {
      std::conditional_t<std::is_same_v<T, float>, std::uint32_t, T> bits;
      static_assert(sizeof(bits) == sizeof(T));
      std::copy_n(reinterpret_cast<const unsigned char*>(&number),
                  sizeof(T),
                  reinterpret_cast<unsigned char*>(&bits));
      for (std::size_t k = 0; k < sizeof(T); ++k)
        bytes.push_back(static_cast<unsigned char>(bits >> (8 * k) & 255));
    }
    m_arrays.push_back(base64(bytes));
    const char* const type = std::is_same_v<T, float> ? "f32"
                             : sizeof(T) == 1         ? "u8"
                             : sizeof(T) == 2         ? "u16"
                                                      : "u32";
    return {{"array", m_arrays.size() - 1}, {"type", type}};
  }

  /// Adds indices with as few bytes as they need; `most` is the largest index.
  Json add_indices(const std::vector<std::size_t>& indices, std::size_t most)
  {
    if (most <= std::numeric_limits<std::uint16_t>::max())
      return add_numbers(std::vector<std::uint16_t>(indices.begin(), indices.end()));
    return add_numbers(std::vector<std::uint32_t>(indices.begin(), indices.end()));
  }

  /// Adds positions of frames in one box, so that they can be interpolated.
  std::vector<Json> add_points(const std::vector<std::vector<Point>>& frames)
  {
    double low[3], high[3];
    for (int c = 0; c < 3; ++c) {
      low[c] = std::numeric_limits<double>::infinity();
      high[c] = -low[c];
      for (const std::vector<Point>& frame : frames)
        for (const Point& p : frame) {
          low[c] = std::min(low[c], p[c]);
          high[c] = std::max(high[c], p[c]);
        }
    }
    const double extent =
        std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], smallest_extent});
    std::vector<Json> result;
    for (const std::vector<Point>& frame : frames) {
      std::vector<std::uint16_t> numbers;
      numbers.reserve(3 * frame.size());
      for (const Point& p : frame)
        for (int c = 0; c < 3; ++c)
          numbers.push_back(quantised((p[c] - low[c]) / extent));
      Json description = add_numbers(numbers);
      description["scale"] = extent / steps;
      description["offset"] = {low[0], low[1], low[2]};
      result.push_back(std::move(description));
    }
    return result;
  }
  Json add_points(const std::vector<Point>& points)
  {
    return add_points(std::vector<std::vector<Point>>{points}).front();
  }

  /// Adds lengths of at least 0, such as radii.
  Json add_lengths(const std::vector<double>& lengths)
  {
    double most = smallest_extent;
    for (const double length : lengths)
      most = std::max(most, length);
    std::vector<std::uint16_t> numbers;
    for (const double length : lengths)
      numbers.push_back(quantised(length / most));
    Json description = add_numbers(numbers);
    description["scale"] = most / steps;
    return description;
  }

  /// Returns the page: `folder` has the template `index.html`, the styles and the scripts that it
  /// names. The text of `editor` is the compiled editor, or empty.
  std::string html(const std::string& folder, const std::string& editor) const
  {
    std::string page = text_of_file(folder + "/index.html");
    for (const char* const name : {"style.css",
                                   "renderer.js",
                                   "read_points.js",
                                   "data.js",
                                   "views.js",
                                   "live_editor.js",
                                   "main.js"})
      replace(page, std::string("{{") + name + "}}", text_of_file(folder + "/" + name), folder);
    replace(page, "{{editor}}", editor, folder);
    std::string text = views.dump(-1, ' ', true, Json::error_handler_t::replace);
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;)
      text.replace(at, 1, "\\u003c"); // "</script" and "<!--" have a meaning in the element
    std::string data = "<script type=\"application/json\" id=\"views\">" + text + "</script>\n";
    for (std::size_t i = 0; i < m_arrays.size(); ++i)
      data += "<script type=\"text/plain\" id=\"array" + std::to_string(i) + "\">" + m_arrays[i] +
              "</script>\n";
    replace(page, "{{data}}", data, folder);
    return page;
  }

private:
  static constexpr double steps = 65535, smallest_extent = 1e-9;

  static std::uint16_t quantised(double fraction)
  {
    return static_cast<std::uint16_t>(std::lround(steps * std::clamp(fraction, 0.0, 1.0)));
  }

  static void replace(std::string& page,
                      const std::string& mark,
                      const std::string& text,
                      const std::string& folder)
  {
    const std::size_t at = page.find(mark);
    if (at == std::string::npos)
      throw pcs::IO_error(folder + "/index.html", "has no " + mark + ", expected it once");
    page.replace(at, mark.size(), text);
  }

  std::vector<std::string> m_arrays;
};

} // namespace gallery

#endif // PCS_EXAMPLES_GALLERY_PAGE_H

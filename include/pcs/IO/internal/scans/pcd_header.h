// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The header of a PCD file: its fields, the number of points and the encoding.

#ifndef PCS_IO_INTERNAL_SCANS_PCD_HEADER_H
#define PCS_IO_INTERNAL_SCANS_PCD_HEADER_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Scalar_type.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

enum class Pcd_encoding { ascii, binary, compressed };

struct Pcd_field
{
  std::string name;
  Scalar_type type = Scalar_type::float32;
  std::size_t count = 1; // values per point

  std::size_t size() const { return size_of(type) * count; }
};

struct Pcd_header
{
  std::vector<Pcd_field> fields;
  std::uint64_t number_of_points = 0;
  Pcd_encoding encoding = Pcd_encoding::ascii;
};

//! returns the type of a letter (F, I or U) and a number of bytes
inline std::optional<Scalar_type> pcd_type(std::string_view letter, std::uint64_t size)
{
  if (letter == "F")
    return size == 4   ? std::optional(Scalar_type::float32)
           : size == 8 ? std::optional(Scalar_type::float64)
                       : std::nullopt;
  if (letter != "I" && letter != "U")
    return std::nullopt;
  const bool is_signed = letter == "I";
  switch (size) {
  case 1:
    return is_signed ? Scalar_type::int8 : Scalar_type::uint8;
  case 2:
    return is_signed ? Scalar_type::int16 : Scalar_type::uint16;
  case 4:
    return is_signed ? Scalar_type::int32 : Scalar_type::uint32;
  case 8:
    return is_signed ? Scalar_type::int64 : Scalar_type::uint64;
  default:
    return std::nullopt;
  }
}

//! reads the lines up to DATA, in any order
class Pcd_header_reader
{
public:
  explicit Pcd_header_reader(Input_file& file) : m_file(file) {}

  Pcd_header read()
  {
    std::string_view line;
    while (m_file.read_line(line)) {
      line = trim(line);
      if (line.empty() || line[0] == '#')
        continue;
      const std::string keyword(next_word(line));
      if (keyword == "DATA") {
        read_encoding(trim(line));
        finish();
        return m_header;
      }
      read_line(keyword, line);
    }
    m_file.fail_at_end();
  }

private:
  static std::vector<std::string> words_of(std::string_view line)
  {
    std::vector<std::string> words;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
      words.emplace_back(word);
    return words;
  }

  void read_line(const std::string& keyword, std::string_view line)
  {
    if (keyword == "FIELDS" || keyword == "COLUMNS")
      m_names = words_of(line);
    else if (keyword == "SIZE")
      m_sizes = words_of(line);
    else if (keyword == "TYPE")
      m_types = words_of(line);
    else if (keyword == "COUNT")
      m_counts = words_of(line);
    else if (keyword == "WIDTH")
      m_width = number(trim(line));
    else if (keyword == "HEIGHT")
      m_height = number(trim(line));
    else if (keyword == "POINTS")
      m_points = number(trim(line));
    else if (keyword != "VERSION" && keyword != "VIEWPOINT")
      m_file.fail_at_line("expected a line of a PCD header, found " + in_quotes(keyword));
  }

  std::uint64_t number(std::string_view word) const
  {
    std::uint64_t value = 0;
    if (parse_plain(word, value) != Parse_result::ok)
      m_file.fail_at_line("expected an integer, found " + in_quotes(word));
    return value;
  }

  void read_encoding(std::string_view word)
  {
    if (word == "binary")
      m_header.encoding = Pcd_encoding::binary;
    else if (word == "binary_compressed")
      m_header.encoding = Pcd_encoding::compressed;
    else if (word != "ascii")
      m_file.fail_at_line("expected the encoding ascii, binary or binary_compressed, found " +
                          in_quotes(word));
  }

  void finish()
  {
    if (m_names.empty())
      m_file.fail_at_line("expected the line FIELDS before DATA");
    if (m_counts.empty())
      m_counts.assign(m_names.size(), "1");
    if (m_sizes.size() != m_names.size() || m_types.size() != m_names.size() ||
        m_counts.size() != m_names.size())
      m_file.fail_at_line("expected as many words in the lines SIZE, TYPE and COUNT as in FIELDS");
    for (std::size_t i = 0; i < m_names.size(); ++i) {
      const std::optional<Scalar_type> type = pcd_type(m_types[i], number(m_sizes[i]));
      const std::uint64_t count = number(m_counts[i]);
      constexpr std::uint64_t largest_count = 4096; // descriptors of features have up to 1980
      if (!type || count == 0 || count > largest_count)
        m_file.fail_at_line("the field " + in_quotes(m_names[i]) + " has the unknown type " +
                            in_quotes(m_types[i]) + ", size " + m_sizes[i] + ", count " +
                            m_counts[i]);
      m_header.fields.push_back({m_names[i], *type, static_cast<std::size_t>(count)});
    }
    const bool is_large = m_width > 0 && m_height > UINT64_MAX / m_width;
    if (is_large || (m_points && m_width * m_height != *m_points))
      m_file.fail_at_line("the number of points differs from width times height");
    m_header.number_of_points = m_width * m_height;
  }

  Input_file& m_file;
  Pcd_header m_header;
  std::vector<std::string> m_names, m_sizes, m_types, m_counts;
  std::uint64_t m_width = 0, m_height = 1;
  std::optional<std::uint64_t> m_points;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_SCANS_PCD_HEADER_H

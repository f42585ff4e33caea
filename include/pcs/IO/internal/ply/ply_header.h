// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The header of a PLY file.

#ifndef PCS_IO_INTERNAL_PLY_PLY_HEADER_H
#define PCS_IO_INTERNAL_PLY_PLY_HEADER_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Scalar_type.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

enum class Ply_storage { ascii, little_endian, big_endian };

using Ply_property = Element_property;

struct Ply_element
{
  std::string name;
  std::uint64_t count = 0;
  std::vector<Ply_property> properties;

  //! returns the smallest possible number of bytes of a row
  std::uint64_t smallest_row(Ply_storage storage) const
  {
    std::uint64_t size = 0;
    for (const Ply_property& p : properties)
      size += storage == Ply_storage::ascii ? 2 : size_of(p.count_type.value_or(p.type));
    return size;
  }
  bool has_lists() const
  {
    for (const Ply_property& p : properties)
      if (p.count_type)
        return true;
    return false;
  }
};

struct Ply_header
{
  Ply_storage storage = Ply_storage::ascii;
  std::vector<Ply_element> elements;
  std::vector<std::string> comments, obj_info;
};

//! returns the type with the given PLY name; the 64 bit integers are an extension
inline std::optional<Scalar_type> ply_type(std::string_view name)
{
  struct Entry
  {
    std::string_view old_name, new_name;
    Scalar_type type;
  };
  static constexpr Entry entries[] = {{"char", "int8", Scalar_type::int8},
                                      {"uchar", "uint8", Scalar_type::uint8},
                                      {"short", "int16", Scalar_type::int16},
                                      {"ushort", "uint16", Scalar_type::uint16},
                                      {"int", "int32", Scalar_type::int32},
                                      {"uint", "uint32", Scalar_type::uint32},
                                      {"int64", "int64", Scalar_type::int64},
                                      {"uint64", "uint64", Scalar_type::uint64},
                                      {"float", "float32", Scalar_type::float32},
                                      {"double", "float64", Scalar_type::float64}};
  for (const Entry& entry : entries)
    if (name == entry.old_name || name == entry.new_name)
      return entry.type;
  return std::nullopt;
}

//! returns the name that is known to all PLY readers
inline const char* ply_name(Scalar_type type)
{
  constexpr const char* names[] =
      {"char", "uchar", "short", "ushort", "int", "uint", "int64", "uint64", "float", "double"};
  return names[static_cast<std::size_t>(type)];
}

class Ply_header_parser
{
public:
  explicit Ply_header_parser(Input_file& file) : m_file(file) {}

  Ply_header parse()
  {
    std::string_view line = next_line();
    if (line != "ply")
      m_file.fail_at_line("expected 'ply', found " + in_quotes(line));
    for (;;) {
      line = next_line();
      const std::string_view keyword = next_word(line);
      if (keyword == "end_header")
        break;
      parse_line(keyword, line);
    }
    expect_no_more(line);
    if (!m_has_format)
      m_file.fail_at_line("expected a 'format' line before 'end_header'");
    return std::move(m_header);
  }

private:
  static constexpr std::uint64_t longest_header = std::uint64_t(1) << 20;

  std::string_view next_line()
  {
    std::string_view line;
    if (m_file.position() > longest_header || !m_file.read_line(line))
      m_file.fail_at_line("the PLY header has no 'end_header'");
    return line;
  }

  void parse_line(std::string_view keyword, std::string_view rest)
  {
    if (keyword == "comment")
      m_header.comments.emplace_back(rest.empty() ? rest : rest.substr(1));
    else if (keyword == "obj_info")
      m_header.obj_info.emplace_back(rest.empty() ? rest : rest.substr(1));
    else if (keyword == "format")
      parse_format(rest);
    else if (keyword == "element")
      parse_element(rest);
    else if (keyword == "property")
      parse_property(rest);
    else
      m_file.fail_at_line("expected 'format', 'comment', 'obj_info', 'element', 'property' or "
                          "'end_header', found " +
                          in_quotes(keyword));
  }

  void parse_format(std::string_view rest)
  {
    const std::string_view storage = next_word(rest);
    const std::string_view version = next_word(rest);
    if (m_has_format || !m_header.elements.empty())
      m_file.fail_at_line("expected one 'format' line in front of all elements");
    if (storage == "ascii")
      m_header.storage = Ply_storage::ascii;
    else if (storage == "binary_little_endian")
      m_header.storage = Ply_storage::little_endian;
    else if (storage == "binary_big_endian")
      m_header.storage = Ply_storage::big_endian;
    else
      m_file.fail_at_line(
          "expected 'ascii', 'binary_little_endian' or 'binary_big_endian', found " +
          in_quotes(storage));
    if (version != "1.0")
      m_file.fail_at_line("expected format version '1.0', found " + in_quotes(version));
    expect_no_more(rest);
    m_has_format = true;
  }

  void parse_element(std::string_view rest)
  {
    Ply_element element;
    element.name = next_word(rest);
    const std::string_view count = next_word(rest);
    if (element.name.empty() || parse_plain(without_plus(count), element.count) != Parse_result::ok)
      m_file.fail_at_line(
          "expected 'element <name> <count>' with a count of 0 or more, found count " +
          in_quotes(count));
    expect_no_more(rest);
    for (const Ply_element& other : m_header.elements)
      if (other.name == element.name)
        m_file.fail_at_line("element " + in_quotes(element.name) + " is declared twice");
    m_header.elements.push_back(std::move(element));
    m_names.clear();
  }

  void parse_property(std::string_view rest)
  {
    if (m_header.elements.empty())
      m_file.fail_at_line("expected an 'element' line before the first 'property'");
    Ply_property property;
    std::string_view type = next_word(rest);
    if (type == "list") {
      property.count_type = parse_type(next_word(rest));
      if (is_floating_point(*property.count_type))
        m_file.fail_at_line("expected an integer type for the length of a list");
      type = next_word(rest);
    }
    property.type = parse_type(type);
    property.name = next_word(rest);
    if (property.name.empty())
      m_file.fail_at_line("expected the name of the property");
    expect_no_more(rest);
    if (!m_names.insert(property.name).second)
      m_file.fail_at_line("property " + in_quotes(property.name) + " is declared twice");
    m_header.elements.back().properties.push_back(std::move(property));
  }

  Scalar_type parse_type(std::string_view word) const
  {
    const std::optional<Scalar_type> type = ply_type(word);
    if (!type)
      m_file.fail_at_line("expected a PLY type such as 'float' or 'uint8', found " +
                          in_quotes(word));
    return *type;
  }

  void expect_no_more(std::string_view rest) const
  {
    if (!trim(rest).empty())
      m_file.fail_at_line("expected the end of the line, found " + in_quotes(trim(rest)));
  }

  Input_file& m_file;
  Ply_header m_header;
  bool m_has_format = false;
  std::unordered_set<std::string> m_names; // names of the properties of the last element
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_PLY_PLY_HEADER_H

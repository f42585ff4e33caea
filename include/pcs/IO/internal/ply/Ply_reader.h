// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the vertices of a PLY file, and on request its faces, lists and other elements.

#ifndef PCS_IO_INTERNAL_PLY_PLY_READER_H
#define PCS_IO_INTERNAL_PLY_PLY_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/ply/Ply_mesh.h>
#include <pcs/IO/internal/ply/ply_header.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace pcs {
namespace IO {
namespace internal {

/*
  Scalar properties of the element `vertex` become columns. List properties and other elements are
  kept on request, otherwise skipped. In both cases, the file must contain them completely.
*/
class Ply_reader : public Format_reader
{
public:
  explicit Ply_reader(const std::string& path, bool do_keep_faces = false)
    : m_file(path), m_header(Ply_header_parser(m_file).parse())
  {
    while (m_vertex < m_header.elements.size() && m_header.elements[m_vertex].name != "vertex")
      ++m_vertex;
    if (m_vertex == m_header.elements.size())
      m_file.fail_at_line("expected an element 'vertex' in the header");
    if (do_keep_faces)
      keep_faces(vertex().count);
    if (m_faces)
      m_mesh.emplace(m_header.elements, m_faces);
    make_schema();
    check_sizes();
    for (std::size_t e = 0; e < m_vertex; ++e)
      read_element(m_header.elements[e]);
    m_rows_left = vertex().count;
    m_number_of_points = vertex().count;
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(max_rows, m_rows_left));
    start_block(block, n);
    if (is_ascii())
      read_ascii_rows(block, n);
    else if (vertex().has_lists())
      read_binary_rows_with_lists(block, n);
    else
      read_binary_rows(block, n);
    block.number_of_rows = n;
    m_rows_left -= n;
    if (m_rows_left == 0 && !std::exchange(m_is_end_checked, true))
      check_end();
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(),
                   (is_ascii() ? "line " : "byte ") + std::to_string(location) + ": " + what);
  }

private:
  bool is_ascii() const { return m_header.storage == Ply_storage::ascii; }
  const Ply_element& vertex() const { return m_header.elements[m_vertex]; }

  void make_schema()
  {
    m_schema.format = File_format::ply;
    m_schema.comments = m_header.comments;
    m_schema.obj_info = m_header.obj_info;
    m_schema.properties.clear();
    for (const Ply_property& p : vertex().properties)
      if (!p.count_type)
        add_property(p.name, p.type);
    for (const char* name : {"x", "y", "z"})
      if (!m_schema.has(name))
        m_file.fail_at_line("the element 'vertex' has no scalar property '" + std::string(name) +
                            "'");
    warn_of_omissions();
    // values parsed from text have the native byte order
    if (!is_ascii())
      m_layout.is_big_endian = m_header.storage == Ply_storage::big_endian;
  }

  //! warns of the lists and elements that are left out
  void warn_of_omissions()
  {
    if (m_faces)
      return;
    for (const Ply_property& p : vertex().properties)
      if (p.count_type && vertex().count > 0)
        m_schema.warnings.push_back("the list " + in_quotes(p.name) +
                                    " of the vertices is left out");
    for (const Ply_element& element : m_header.elements)
      if (element.name == "face")
        warn_of_faces(element.count);
      else if (element.name != "vertex" && element.count > 0)
        m_schema.warnings.push_back("the element " + in_quotes(element.name) + " with " +
                                    std::to_string(element.count) + " rows is left out");
  }

  //! checks before memory is allocated that the file can hold the declared number of rows
  void check_sizes() const
  {
    // the last line of a text file may lack a line break
    std::uint64_t left = m_file.remaining() + (is_ascii() ? 1 : 0);
    for (const Ply_element& element : m_header.elements) {
      const std::uint64_t row = element.smallest_row(m_header.storage);
      if (row == 0)
        continue;
      if (element.count > left / row)
        m_file.fail_at_line("element " + in_quotes(element.name) + " declares " +
                            std::to_string(element.count) + " rows, more than the " +
                            std::to_string(m_file.remaining()) +
                            " bytes after the header can hold");
      left -= element.count * row;
    }
  }

  void check_end()
  {
    for (std::size_t e = m_vertex + 1; e < m_header.elements.size(); ++e)
      read_element(m_header.elements[e]);
    if (m_mesh)
      m_mesh->finish();
    if (is_ascii())
      expect_end_of_text(m_file);
    else if (m_file.remaining() > 0)
      m_file.fail_at_byte(m_file.position(),
                          "expected the end of the file, found " +
                              std::to_string(m_file.remaining()) + " more bytes");
  }

  // ---- binary ----

  void read_binary_rows(Row_block& block, std::size_t n)
  {
    for (std::size_t i = 0; i < n; ++i)
      block.locations.push_back(m_file.position() + i * m_layout.row_size);
    m_file.read(block.bytes.data(), n * m_layout.row_size);
  }

  void read_binary_rows_with_lists(Row_block& block, std::size_t n)
  {
    unsigned char* to = block.bytes.data();
    for (std::size_t i = 0; i < n; ++i) {
      block.locations.push_back(m_file.position());
      for (const Ply_property& p : vertex().properties)
        if (p.count_type) {
          read_binary_list(vertex(), p);
        } else {
          m_file.read(to, size_of(p.type));
          to += size_of(p.type);
        }
    }
  }

  bool do_swap() const
  {
    return (m_header.storage == Ply_storage::big_endian) != is_big_endian_machine();
  }

  void read_binary_list(const Ply_element& element, const Ply_property& p)
  {
    const std::uint64_t start = m_file.position();
    std::array<unsigned char, 8> bytes{};
    m_file.read(bytes.data(), size_of(*p.count_type));
    const std::uint64_t count = dispatch(*p.count_type, [&](auto tag) {
      const auto value = load<typename decltype(tag)::type>(bytes.data(), do_swap());
      if (value < 0)
        fail_list(start, p);
      return static_cast<std::uint64_t>(value);
    });
    if (count > m_file.remaining() / size_of(p.type))
      fail_list(start, p);
    if (!m_mesh) {
      m_file.skip(count * size_of(p.type));
      return;
    }
    begin_list(element, p, count, start);
    for (std::uint64_t i = 0; i < count; ++i)
      read_entry(element, p, start);
    end_list(p);
  }

  //! reads a scalar or an entry of a list that is kept; errors name the byte `start`
  void read_entry(const Ply_element& element, const Ply_property& p, std::uint64_t start)
  {
    std::array<unsigned char, 8> bytes{};
    m_file.read(bytes.data(), size_of(p.type));
    if (do_swap())
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size_of(p.type)));
    keep_value(element, p, bytes.data(), start);
  }

  [[noreturn]] void fail_list(std::uint64_t start, const Ply_property& p) const
  {
    m_file.fail_at_byte(start,
                        "the list '" + p.name +
                            "' has a negative length or more entries than the file can hold");
  }

  //! reads an element other than the vertices
  void read_element(const Ply_element& element)
  {
    const std::uint64_t row = element.smallest_row(m_header.storage);
    if (row == 0)
      return;
    if (!is_ascii() && !element.has_lists() && !m_mesh) {
      if (element.count > m_file.remaining() / row)
        m_file.fail_at_end();
      m_file.skip(element.count * row);
      return;
    }
    for (std::uint64_t i = 0; i < element.count; ++i)
      if (is_ascii())
        parse_row(element, nullptr);
      else
        for (const Ply_property& p : element.properties)
          if (p.count_type)
            read_binary_list(element, p);
          else if (m_mesh)
            read_entry(element, p, m_file.position());
          else
            m_file.skip(size_of(p.type));
  }

  // ---- faces, lists and other elements, if they are kept ----

  //! adds the length of a list, which begins at the byte or line `location`
  void begin_list(const Ply_element& element,
                  const Ply_property& p,
                  std::uint64_t length,
                  std::uint64_t location)
  {
    if (m_mesh->is_corner_list(p)) {
      if (length < 3)
        fail_at(location, polygon_expected(m_mesh->faces(), length));
    } else if (!m_mesh->add_length(element, p, length))
      fail_at(location,
              "the list " + in_quotes(p.name) + " has " + std::to_string(length) +
                  " entries, more than its type " + name_of(*p.count_type) + " can count");
  }

  void keep_value(const Ply_element& element,
                  const Ply_property& p,
                  const unsigned char* value,
                  std::uint64_t location)
  {
    if (!m_mesh->is_corner_list(p))
      m_mesh->add_value(element, p.type, value);
    else if (!m_mesh->add_corner(p.type, value))
      fail_at(location,
              "face " + std::to_string(m_mesh->faces().number_of_faces()) + ": " +
                  vertex_expected(dispatch(p.type,
                                           [&](auto tag) {
                                             return std::to_string(
                                                 load<typename decltype(tag)::type>(value, false));
                                           }),
                                  vertex().count));
  }

  void end_list(const Ply_property& p)
  {
    if (m_mesh->is_corner_list(p))
      m_mesh->end_face();
  }

  // ---- ascii ----

  void read_ascii_rows(Row_block& block, std::size_t n)
  {
    for (std::size_t i = 0; i < n; ++i) {
      parse_row(vertex(), block.bytes.data() + i * m_layout.row_size);
      block.locations.push_back(m_file.line_number());
    }
  }

  //! reads one line; stores the scalars at `to` unless it is null
  void parse_row(const Ply_element& element, unsigned char* to)
  {
    std::string_view line;
    do {
      if (!m_file.read_line(line))
        m_file.fail_at_end();
    } while (trim(line).empty());
    std::array<unsigned char, 8> value{};
    for (const Ply_property& p : element.properties)
      if (p.count_type) {
        parse_list(line, element, p);
      } else if (to != nullptr) {
        parse_word(next_word(line), p.name, p.type, to);
        to += size_of(p.type);
      } else {
        parse_word(next_word(line), p.name, p.type, value.data());
        if (m_mesh)
          m_mesh->add_value(element, p.type, value.data());
      }
    if (!trim(line).empty())
      m_file.fail_at_line("expected the end of the line, found " + in_quotes(trim(line)));
  }

  void parse_list(std::string_view& line, const Ply_element& element, const Ply_property& p)
  {
    std::uint64_t count = 0;
    parse_word(next_word(line),
               p.name,
               Scalar_type::uint64,
               reinterpret_cast<unsigned char*>(&count));
    if (m_mesh)
      begin_list(element, p, count, m_file.line_number());
    std::array<unsigned char, 8> value{};
    for (std::uint64_t i = 0; i < count; ++i) {
      parse_word(next_word(line), p.name, p.type, value.data());
      if (m_mesh)
        keep_value(element, p, value.data(), m_file.line_number());
    }
    if (m_mesh)
      end_list(p);
  }

  void parse_word(std::string_view word,
                  const std::string& name,
                  Scalar_type type,
                  unsigned char* to) const
  {
    const Parse_result result = parse_to_bytes(word, type, to);
    if (result != Parse_result::ok)
      m_file.fail_at_line(number_expected(word, name, type, result));
  }

  Input_file m_file;
  Ply_header m_header;
  std::size_t m_vertex = 0;       // index of the element `vertex`
  std::optional<Ply_mesh> m_mesh; // set if faces are kept; refers to the header
  std::uint64_t m_rows_left = 0;
  bool m_is_end_checked = false;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_PLY_PLY_READER_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes points as text, one per line.

#ifndef PCS_IO_INTERNAL_TEXT_TEXT_WRITER_H
#define PCS_IO_INTERNAL_TEXT_TEXT_WRITER_H

#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/internal/file_format.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Write_options.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

class Text_writer : public Format_writer
{
public:
  Text_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
    : Format_writer(path)
  {
    const bool is_csv = extension_of(path) == "csv";
    m_separator = options.text_separator.value_or(is_csv ? ',' : ' ');
    if (std::string(" \t,;").find(m_separator) == std::string::npos)
      throw Invalid_input("pcs::IO::Write_options: text_separator must be a blank, a tab, a comma "
                          "or a semicolon");
    bool are_default_names = true;
    for (const Property_description& p : schema.properties) {
      const std::size_t i = m_layout.fields.size();
      are_default_names =
          are_default_names && p.name == (i < 3 ? std::string(1, static_cast<char>('x' + i))
                                                : "column_" + std::to_string(i + 1));
      m_layout.push_back(p.name, is_coordinate_name(p.name) ? Scalar_type::float64 : p.type);
    }
    if (options.text_header == Text_header::always ||
        (options.text_header == Text_header::automatic && (is_csv || !are_default_names)))
      write_names();
  }

private:
  void write_names()
  {
    std::string line;
    for (const Field& field : m_layout.fields) {
      double value = 0;
      const bool is_number = parse_number(field.name, value) != Parse_result::not_a_number;
      if (is_number || field.name.find_first_of(" \t\r\n,;\"#") != std::string::npos ||
          field.name[0] == '%' || field.name.substr(0, 2) == "//")
        m_file.fail("the header of a text file cannot hold the property name '" + field.name + "'");
      line += field.name + m_separator;
    }
    line.back() = '\n';
    m_file.write(line);
  }

  void write_rows(const Row_block& block) override { write_rows_as_text(block, m_separator); }
  void finish(std::uint64_t) override {}

  char m_separator = ' ';
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_TEXT_TEXT_WRITER_H

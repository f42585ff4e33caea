// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Interface of the writers of all formats, which write in chunks; conversion of rows to text.

#ifndef PCS_IO_INTERNAL_FORMAT_WRITER_H
#define PCS_IO_INTERNAL_FORMAT_WRITER_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/Row_block.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Point_table.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

class Format_writer
{
public:
  explicit Format_writer(const std::string& path) : m_file(path) {}
  virtual ~Format_writer() = default;

  //! writes the points of a table that has the properties of the schema
  virtual void append(const Point_table& table)
  {
    const std::vector<std::size_t> columns = find_columns(table.schema(), m_layout);
    const std::size_t rows = rows_per_block(m_layout);
    for (std::size_t first = 0; first < table.number_of_points(); first += rows) {
      const std::size_t n = std::min(rows, table.number_of_points() - first);
      pack_rows(table, columns, first, n, m_layout, m_block);
      write_rows(m_block);
    }
  }

  //! completes the file, which contains `number_of_points` points, and renames it to its final name
  virtual void commit(std::uint64_t number_of_points)
  {
    finish(number_of_points);
    m_file.commit();
  }

protected:
  virtual void write_rows(const Row_block& block) = 0;
  virtual void finish(std::uint64_t number_of_points) = 0;

  //! writes a line per row; `do_mark_floats` distinguishes 1.0 from the integer 1
  void write_rows_as_text(const Row_block& block, char separator, bool do_mark_floats = false)
  {
    m_text.clear();
    const unsigned char* row = block.bytes.data();
    for (std::size_t i = 0; i < block.number_of_rows; ++i, row += m_layout.row_size) {
      for (const Field& field : m_layout.fields) {
        dispatch(field.type, [&](auto tag) {
          using T = typename decltype(tag)::type;
          const std::size_t begin = m_text.size();
          append_number(m_text, load<T>(row + field.offset, false));
          if (std::is_floating_point_v<T> && do_mark_floats &&
              m_text.find_first_not_of("-0123456789", begin) == std::string::npos)
            m_text += ".0";
        });
        m_text += separator;
      }
      m_text.back() = '\n';
    }
    m_file.write(m_text);
  }

  Output_file m_file;
  Row_layout m_layout;

private:
  Row_block m_block;
  std::string m_text;
};

//! formats a count of a header, padded to the length of the largest count unless it is final
inline std::string count_in_header(std::uint64_t count, bool is_final)
{
  std::string text = std::to_string(count);
  constexpr std::size_t most_digits = 20;
  return is_final ? text : std::string(most_digits - text.size(), ' ') + text;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_FORMAT_WRITER_H

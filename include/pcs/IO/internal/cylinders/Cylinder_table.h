// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the rows of a table of cylinders. Columns are identified by their names.

#ifndef PCS_IO_INTERNAL_CYLINDERS_CYLINDER_TABLE_H
#define PCS_IO_INTERNAL_CYLINDERS_CYLINDER_TABLE_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/text/table_words.h>
#include <pcs/core/Tree_skeleton.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/// Columns of a table of cylinders. The three columns of a vector are consecutive.
enum Cylinder_column : std::size_t {
  column_start,
  column_axis = column_start + 3,
  column_end = column_axis + 3,
  column_length = column_end + 3,
  column_radius,
  column_parent,
  column_id,
  column_branch,
  number_of_cylinder_columns
};

constexpr std::array<const char*, number_of_cylinder_columns> cylinder_columns = {"startX",
                                                                                  "startY",
                                                                                  "startZ",
                                                                                  "axisX",
                                                                                  "axisY",
                                                                                  "axisZ",
                                                                                  "endX",
                                                                                  "endY",
                                                                                  "endZ",
                                                                                  "length",
                                                                                  "radius",
                                                                                  "parent",
                                                                                  "id",
                                                                                  "branch"};

//! returns the letters and digits of a column name in lower case, without a unit in parentheses
inline std::string plain_column_name(std::string_view name)
{
  std::string plain;
  for (const char c : name.substr(0, name.find('(')))
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return plain;
}

//! returns the first column that a name denotes, and the number of its columns; 0: unknown name
inline std::pair<std::size_t, std::size_t> columns_of_name(std::string_view name)
{
  const std::string plain = plain_column_name(name);
  for (const auto& [prefix, first] : {std::make_pair("start", column_start),
                                      std::make_pair("startpoint", column_start),
                                      std::make_pair("s", column_start),
                                      std::make_pair("axis", column_axis),
                                      std::make_pair("axisdirection", column_axis),
                                      std::make_pair("a", column_axis),
                                      std::make_pair("end", column_end)})
    for (std::size_t k = 0; k < 3; ++k)
      if (plain == std::string(prefix) + "xyz"[k] ||
          (prefix[1] != '\0' && plain == std::string(prefix) + "123"[k])) // not s1, a1
        return {first + k, 1};
  for (const auto& [synonym, first, number] :
       {std::make_tuple("startpoint", column_start, 3), // in TreeQSM, one name for three columns
        std::make_tuple("axisdirection", column_axis, 3),
        std::make_tuple("length", column_length, 1),
        std::make_tuple("radius", column_radius, 1),
        std::make_tuple("radiuscyl", column_radius, 1),
        std::make_tuple("parent", column_parent, 1),
        std::make_tuple("parentid", column_parent, 1),
        std::make_tuple("id", column_id, 1),
        std::make_tuple("cylid", column_id, 1),
        std::make_tuple("branch", column_branch, 1),
        std::make_tuple("branchid", column_branch, 1),
        std::make_tuple("axisid", column_branch, 1)})
    if (plain == synonym)
      return {first, static_cast<std::size_t>(number)};
  return {0, 0};
}

//! returns the separator of a header: a tab, semicolon or comma, otherwise a blank
inline char separator_of(std::string_view header)
{
  for (const char c : {'\t', ';', ','})
    if (header.find(c) != std::string_view::npos)
      return c;
  return ' ';
}

inline std::vector<std::string_view> split_at(char separator, std::string_view line)
{
  std::vector<std::string_view> words;
  if (separator == ' ') {
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
      words.push_back(without_quotes(word));
    return words;
  }
  for (;;) {
    const std::size_t end = line.find(separator);
    words.push_back(without_quotes(line.substr(0, end)));
    if (end == std::string_view::npos)
      return words;
    line.remove_prefix(end + 1);
  }
}

//! reads the next line that is neither blank nor a comment; `false` at the end of the file
inline bool read_table_line(Input_file& file, std::string_view& line)
{
  while (file.read_line(line)) {
    if (file.line_number() == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") // byte order mark
      line.remove_prefix(3);
    if (const std::string_view text = trim(line); !text.empty() && text.front() != '#')
      return true;
  }
  return false;
}

/// The header of a table of cylinders, and the words of a line by column.
class Cylinder_header
{
public:
  Cylinder_header(const Input_file& file, std::string_view header)
    : m_file(file), m_separator(separator_of(header))
  {
    m_index.fill(npos);
    for (const std::string_view name : split_at(m_separator, header)) {
      const auto [first, number] = columns_of_name(name);
      for (std::size_t k = 0; k < number; ++k) {
        if (m_index[first + k] != npos)
          file.fail_at_line(std::string("the column '") + cylinder_columns[first + k] +
                            "' is named twice, the second time as " + in_quotes(name) +
                            "; remove one of them");
        m_index[first + k] = m_number_of_columns + k;
      }
      m_number_of_columns += std::max<std::size_t>(number, 1);
    }
  }

  bool has(std::size_t column) const { return m_index[column] != npos; }
  bool has_vector(std::size_t column) const
  {
    return has(column) && has(column + 1) && has(column + 2);
  }

  void check() const
  {
    for (const std::size_t c : {column_start + 0, column_start + 1, column_start + 2})
      require(c);
    require(column_radius);
    require(column_parent);
    if (!has_vector(column_end) && !(has_vector(column_axis) && has(column_length)))
      m_file.fail_at_line(
          "the ends of the cylinders are missing, expected the columns endX, endY, endZ, "
          "or axisX, axisY, axisZ and length");
  }

  void set_line(std::string_view line)
  {
    m_words = split_at(m_separator, line);
    if (m_words.size() != m_number_of_columns)
      m_file.fail_at_line(
          "expected " + std::to_string(m_number_of_columns) + " columns as in the header, found " +
          std::to_string(m_words.size()) +
          (m_words.size() == m_number_of_columns + 1 ? "; write the table without row names" : ""));
  }

  std::string_view word(std::size_t column) const { return m_words[m_index[column]]; }
  double number(std::size_t column) const
  {
    return required_number<double>(m_file, word(column), cylinder_columns[column]);
  }
  double length(std::size_t column) const
  {
    return required_length(m_file, word(column), cylinder_columns[column]);
  }
  std::int64_t integer(std::size_t column) const
  {
    return required_number<std::int64_t>(m_file, word(column), cylinder_columns[column]);
  }
  std::array<double, 3> vector(std::size_t column) const
  {
    return {number(column), number(column + 1), number(column + 2)};
  }

private:
  void require(std::size_t column) const
  {
    if (!has(column))
      m_file.fail_at_line(std::string("there is no column '") + cylinder_columns[column] +
                          "', expected the start, radius and parent of the cylinders, and either "
                          "their end or their axis and length");
  }

  const Input_file& m_file;
  char m_separator;
  std::array<std::size_t, number_of_cylinder_columns> m_index{};
  std::size_t m_number_of_columns = 0;
  std::vector<std::string_view> m_words;
};

/// One row of the table.
struct Cylinder
{
  std::array<double, 3> start{}, end{}; ///< [L]
  double radius = 0;                    ///< [L]
  std::int64_t branch = 0;              ///< id, 0 without a column of branches
};

/// All rows of the table.
struct Cylinder_rows
{
  std::vector<Tree_row> rows; ///< ids of each cylinder and its parent
  std::vector<Cylinder> cylinders;
  bool has_branches = false; ///< whether there is a column of branches
};

inline double squared_distance(const std::array<double, 3>& a, const std::array<double, 3>& b)
{
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k)
    sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

inline Cylinder cylinder_of_line(const Input_file& file, const Cylinder_header& header)
{
  Cylinder c;
  c.start = header.vector(column_start);
  c.radius = header.length(column_radius);
  if (header.has(column_branch))
    c.branch = header.integer(column_branch);
  if (header.has_vector(column_end)) {
    c.end = header.vector(column_end);
    return c;
  }
  const std::array<double, 3> axis = header.vector(column_axis);
  const double length = header.length(column_length), norm = std::hypot(axis[0], axis[1], axis[2]);
  if (length > 0 && !(norm > 0))
    file.fail_at_line("the axis of a cylinder is null, expected a direction");
  for (std::size_t k = 0; k < 3; ++k) {
    c.end[k] = c.start[k] + (length > 0 ? length * (axis[k] / norm) : 0);
    if (!std::isfinite(c.end[k]))
      file.fail_at_line("the end of the cylinder is out of range");
  }
  return c;
}

/*
  Replaces the parent 0 by `no_parent`, unless a cylinder has the id 0. Without a column of ids,
  cylinders are numbered from 1.
*/
inline void mark_roots(Cylinder_rows& table)
{
  bool has_zero = false;
  for (const Tree_row& row : table.rows)
    has_zero = has_zero || row.id == 0;
  for (Tree_row& row : table.rows)
    if (row.parent == 0 && !has_zero)
      row.parent = no_parent;
}

/*
  Makes a root cylinder a child of the first one if the distance of their starts is at most the
  radius of the first. In some tables, branches at the root have no parent.
*/
inline void join_roots(Cylinder_rows& table)
{
  std::size_t first = npos;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.rows[i].parent != no_parent)
      continue;
    if (first == npos) {
      first = i;
      continue;
    }
    const Cylinder& root = table.cylinders[first];
    if (squared_distance(root.start, table.cylinders[i].start) <= root.radius * root.radius)
      table.rows[i].parent = table.rows[first].id;
  }
}

inline Cylinder_rows read_cylinder_rows(const std::string& path)
{
  Input_file file(path);
  std::string_view line;
  if (!read_table_line(file, line))
    throw IO_error(path, "the file is empty, expected the names of the columns");
  Cylinder_header header(file, line);
  header.check();
  Cylinder_rows table;
  table.has_branches = header.has(column_branch);
  while (read_table_line(file, line)) {
    header.set_line(line);
    table.cylinders.push_back(cylinder_of_line(file, header));
    Tree_row row;
    row.line = file.line_number();
    row.id = header.has(column_id) ? header.integer(column_id)
                                   : static_cast<std::int64_t>(table.rows.size()) + 1;
    row.parent = header.word(column_parent) == "NA" ? no_parent : header.integer(column_parent);
    if (row.id < 0)
      file.fail_at_line("an id must not be negative, found " + std::to_string(row.id));
    table.rows.push_back(row);
  }
  mark_roots(table);
  join_roots(table);
  return table;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_CYLINDERS_CYLINDER_TABLE_H

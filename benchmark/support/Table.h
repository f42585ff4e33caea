// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Table of text, printed as aligned Markdown or written to a CSV file.

#ifndef PCS_BENCHMARK_SUPPORT_TABLE_H
#define PCS_BENCHMARK_SUPPORT_TABLE_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace pcs_bench {

/// `value` with `digits` significant digits; "-" for a missing value.
inline std::string number(double value, int digits = 3)
{
  if (!std::isfinite(value))
    return "-";
  if (value == 0)
    return "0";
  const int magnitude = int(std::floor(std::log10(std::abs(value))));
  char text[64];
  if (magnitude < -6)
    std::snprintf(text, sizeof text, "%.*e", digits - 1, value);
  else
    std::snprintf(text, sizeof text, "%.*f", std::max(0, digits - 1 - magnitude), value);
  return text;
}

class Table
{
public:
  explicit Table(std::vector<std::string> header) : m_rows{std::move(header)} {}

  void add(std::vector<std::string> row) { m_rows.push_back(std::move(row)); }

  void print(std::ostream& out) const
  {
    std::vector<std::size_t> width(m_rows.front().size(), 3);
    for (const auto& row : m_rows)
      for (std::size_t c = 0; c < row.size(); ++c)
        width[c] = std::max(width[c], row[c].size());
    for (std::size_t r = 0; r < m_rows.size(); ++r) {
      for (std::size_t c = 0; c < width.size(); ++c)
        out << "| " << m_rows[r][c] << std::string(width[c] - m_rows[r][c].size() + 1, ' ');
      out << "|\n";
      if (r > 0)
        continue;
      for (const std::size_t w : width)
        out << '|' << std::string(w + 2, '-');
      out << "|\n";
    }
    out << std::endl;
  }

  void write_csv(const std::string& path) const
  {
    std::ofstream out(path);
    for (const auto& row : m_rows)
      for (std::size_t c = 0; c < row.size(); ++c)
        out << quoted(row[c]) << (c + 1 < row.size() ? ',' : '\n');
    if (!out.flush())
      throw std::runtime_error("cannot write " + path);
  }

private:
  /// Cells contain no quotation marks.
  static std::string quoted(const std::string& cell)
  {
    return cell.find(',') == std::string::npos ? cell : '"' + cell + '"';
  }

  std::vector<std::vector<std::string>> m_rows;
};

} // namespace pcs_bench

#endif // PCS_BENCHMARK_SUPPORT_TABLE_H

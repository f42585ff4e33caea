// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A progress line on a terminal; nothing is printed elsewhere.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_PROGRESS_LINE_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_PROGRESS_LINE_H

#include <cstdio>
#include <string>
#include <unistd.h>

namespace program {

class Progress_line
{
public:
  explicit Progress_line(bool is_wanted) : m_is_shown(is_wanted && isatty(STDERR_FILENO)) {}
  Progress_line(const Progress_line&) = delete;
  Progress_line& operator=(const Progress_line&) = delete;
  ~Progress_line() { clear(); }

  void show(const std::string& stage, double fraction)
  {
    const std::string text = stage + " " + std::to_string(static_cast<int>(100 * fraction)) + " %";
    if (m_is_shown && text != m_text)
      std::fprintf(stderr, "\r\033[K%s", text.c_str());
    m_text = text;
  }

  void clear()
  {
    if (m_is_shown && !m_text.empty())
      std::fputs("\r\033[K", stderr);
    m_text.clear();
  }

private:
  bool m_is_shown;
  std::string m_text;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_PROGRESS_LINE_H

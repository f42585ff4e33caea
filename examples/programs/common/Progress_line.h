// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A progress line on a terminal; nothing is printed elsewhere. After two seconds, it estimates the
// time that is left: elapsed * (1 - fraction) / fraction.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_PROGRESS_LINE_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_PROGRESS_LINE_H

#include <chrono>
#include <cmath>
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
    if (stage != m_stage) {
      m_stage = stage;
      m_start = Clock::now();
    }
    const std::chrono::duration<double> elapsed = Clock::now() - m_start;
    const std::string text = stage + " " + std::to_string(static_cast<int>(100 * fraction)) + " %" +
                             time_left(elapsed.count(), fraction);
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
  using Clock = std::chrono::steady_clock;

  /// Returns ", about 12 s left", or an empty string if that cannot be estimated.
  static std::string time_left(double elapsed, double fraction)
  {
    if (elapsed < 2 || fraction < 0.05 || fraction >= 1)
      return {};
    const double left = elapsed * (1 - fraction) / fraction;
    const bool is_short = left < 90;
    const int number = static_cast<int>(std::ceil(is_short ? left : left / 60));
    return ", about " + std::to_string(number) + (is_short ? " s left" : " min left");
  }

  bool m_is_shown;
  std::string m_text, m_stage;
  Clock::time_point m_start = Clock::now(); ///< of the stage
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_PROGRESS_LINE_H

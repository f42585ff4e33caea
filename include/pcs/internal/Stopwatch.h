// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Wall-clock seconds of one stage, for the reports.

#ifndef PCS_INTERNAL_STOPWATCH_H
#define PCS_INTERNAL_STOPWATCH_H

#include <chrono>

namespace pcs {
namespace internal {

class Stopwatch
{
public:
  /// Returns the seconds since construction or the previous call.
  double lap()
  {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> elapsed = now - m_start;
    m_start = now;
    return elapsed.count();
  }

private:
  std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
};

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_STOPWATCH_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Wall-clock time of a stage, added to a report when the stage ends.

#ifndef PCS_INTERNAL_STAGE_TIMER_H
#define PCS_INTERNAL_STAGE_TIMER_H

#include <pcs/internal/Stopwatch.h>

namespace pcs {
namespace internal {

/// Adds the seconds between construction and destruction to `seconds`.
class Stage_timer
{
public:
  explicit Stage_timer(double& seconds) : m_seconds(seconds) {}
  ~Stage_timer()
  {
    if (m_is_counted)
      m_seconds += m_watch.lap();
  }

  Stage_timer(const Stage_timer&) = delete;
  Stage_timer& operator=(const Stage_timer&) = delete;

  /// Leaves `seconds` unchanged when the stage ends.
  void discard() { m_is_counted = false; }

private:
  double& m_seconds;
  bool m_is_counted = true;
  Stopwatch m_watch;
};

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_STAGE_TIMER_H

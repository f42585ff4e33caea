// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reports progress of staged work through the user's callback and remembers a request to stop.
// Steps that run in several threads ask whether to go on.

#ifndef PCS_INTERNAL_PROGRESS_H
#define PCS_INTERNAL_PROGRESS_H

#include <algorithm>
#include <atomic>
#include <functional>
#include <thread>
#include <utility>

namespace pcs {
namespace internal {

/// Reports progress to a callback on the caller's thread between stages. The values never decrease;
/// the callback returns `false` to stop the work.
class Progress
{
public:
  Progress() = default;
  explicit Progress(std::function<bool(double)> callback) : m_callback(std::move(callback)) {}

  /// Begins a stage that covers the interval `[from, to]` of the total work, as fractions of it.
  void stage(double from, double to)
  {
    m_from = from;
    m_to = to;
  }

  /// Reports the fraction `f` in `[0, 1]` of the current stage. Returns `false` if the work must
  /// stop.
  bool operator()(double f)
  {
    if (m_is_cancelled)
      return false;
    m_value = std::max(m_value, m_from + (m_to - m_from) * std::min(1.0, std::max(0.0, f)));
    if (m_callback && !m_callback(m_value))
      m_is_cancelled = true;
    return !m_is_cancelled;
  }

  /// Reports completion; the callback cannot stop the work here.
  void finish()
  {
    if (m_callback && !m_is_cancelled)
      m_callback(m_to);
  }

  bool is_cancelled() const { return m_is_cancelled; }

private:
  friend class Progress_stage;

  std::function<bool(double)> m_callback;
  double m_from = 0, m_to = 1, m_value = 0;
  bool m_is_cancelled = false;
};

/// A stage that ends with its scope; then the interval of the enclosing stage applies again.
class Progress_stage
{
public:
  /// Begins a stage that covers the interval `[from, to]` of the total work, as fractions of it.
  Progress_stage(Progress& progress, double from, double to)
    : m_progress(progress), m_outer_from(progress.m_from), m_outer_to(progress.m_to)
  {
    m_progress.stage(from, to);
  }
  ~Progress_stage() { m_progress.stage(m_outer_from, m_outer_to); }

  Progress_stage(const Progress_stage&) = delete;
  Progress_stage& operator=(const Progress_stage&) = delete;

private:
  Progress& m_progress;
  double m_outer_from, m_outer_to;
};

/// Called by a step with the completed fraction of its work, in any thread. Returns `false` if the
/// step must stop. A step calls nothing if the function is empty.
using Go_on = std::function<bool(double)>;

/// Whether to go on, after a fraction of the work.
inline bool goes_on(const Go_on& go_on, double fraction)
{
  return !go_on || go_on(fraction);
}

/// Returns the function for a part of a step, from one fraction of the step to another.
inline Go_on part_of(const Go_on& go_on, double from, double to)
{
  if (!go_on)
    return {};
  return [&go_on, from, to](double f) { return go_on(from + (to - from) * f); };
}

/// Lets all threads of a stage ask whether to go on. The callback is called in the thread that made
/// this object. Other threads obtain its last answer.
class Shared_progress
{
public:
  explicit Shared_progress(Progress& progress)
    : m_progress(progress), m_caller(std::this_thread::get_id())
  {
  }

  /// Reports the completed fraction of the current stage. Returns `false` if the work must stop. If
  /// the callback throws, the other threads stop.
  bool operator()(double f)
  {
    if (std::this_thread::get_id() == m_caller && !m_is_stopped)
      try {
        m_is_stopped = !m_progress(f);
      } catch (...) {
        m_is_stopped = true;
        throw;
      }
    return !m_is_stopped;
  }

private:
  Progress& m_progress;
  std::thread::id m_caller;
  std::atomic<bool> m_is_stopped{false};
};

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_PROGRESS_H

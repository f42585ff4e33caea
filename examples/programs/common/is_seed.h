// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Check of a random seed on the command line.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_IS_SEED_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_IS_SEED_H

#include <charconv>
#include <cstdint>
#include <string>
#include <system_error>

namespace program {

/// A check for CLI11, which silently clamps numbers that are too large.
inline std::string is_seed(const std::string& text)
{
  std::int64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error == std::errc() && end == text.data() + text.size())
    return "";
  return "a seed is an integer of at most 64 bits, found " + text;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_IS_SEED_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Seeded random numbers, independent of the standard library and of thread scheduling.

#ifndef PCS_INTERNAL_RANDOM_STREAM_H
#define PCS_INTERNAL_RANDOM_STREAM_H

#include <pcs/internal/constants.h>

#include <cmath>
#include <cstdint>

namespace pcs {
namespace internal {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection whose output bits appear
/// independent.
inline std::uint64_t mix_bits(std::uint64_t x)
{
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/*
  SplitMix64, started from a seed and any number of keys, so that the stream of a task does not
  depend on other tasks. The distributions are implemented here, because standard libraries
  implement them differently.
*/
class Random_stream
{
public:
  template <class... Keys>
  explicit Random_stream(std::uint64_t seed, Keys... keys) : m_state(mix_bits(seed))
  {
    ((m_state = mix_bits(m_state ^ mix_bits(static_cast<std::uint64_t>(keys)))), ...);
  }

  std::uint64_t bits()
  {
    const std::uint64_t result = mix_bits(m_state);
    m_state += 0x9e3779b97f4a7c15u;
    return result;
  }

  /// A uniform random number in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  double uniform(double from, double to) { return from + (to - from) * uniform(); }

  /// A normal random number with mean 0 and standard deviation 1, by Box and Muller.
  double normal()
  {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * pi * uniform());
  }

private:
  std::uint64_t m_state;
};

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_RANDOM_STREAM_H

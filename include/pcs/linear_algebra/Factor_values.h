// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Entries of a factor below its diagonal, also in fewer bytes than double precision has.

#ifndef PCS_LINEAR_ALGEBRA_FACTOR_VALUES_H
#define PCS_LINEAR_ALGEBRA_FACTOR_VALUES_H

#include <pcs/internal/progress.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pcs {
namespace linear_algebra {

/// Bytes per entry of a factor. Fewer than eight are for factors of Laplacians with row sums, whose
/// entries lie in [-1, 0]: they have no bit for the sign and few for the exponent.
enum class Value_size {
  eight, ///< double precision
  six,   ///< relative error below 2^-43 = 1.2e-13 down to 2^-63
  three  ///< relative error below 2^-20 = 1e-6 down to 2^-31
};

namespace internal {

/// Entries in [-1, 0] as the high and the low bits of floating-point numbers with `Exponent` bits
/// for the exponent, from `-(2^Exponent - 1)` to 0, and the other bits for the fraction. Smaller
/// entries become `-2^-(2^Exponent - 1)`.
template <class High, class Low, int Exponent>
class Short_values
{
public:
  class Column
  {
  public:
    Column(const High* high, const Low* low) : m_high(high), m_low(low) {}
    double operator[](std::size_t i) const
    {
      const std::uint64_t bits = std::uint64_t(m_high[i]) << low_bits | m_low[i];
      const std::uint64_t all = (bits << shift) + offset;
      double value;
      std::memcpy(&value, &all, sizeof value);
      return value;
    }

  private:
    const High* m_high;
    const Low* m_low;
  };

  Column column(std::size_t index) const { return {m_high.data() + index, m_low.data() + index}; }
  std::size_t size() const { return m_low.size(); }

  void resize(std::size_t size)
  {
    m_high.resize(size);
    m_low.resize(size);
  }

  void reserve(std::size_t size)
  {
    m_high.reserve(size);
    m_low.reserve(size);
  }

  void set(std::size_t index, const double* from, std::size_t count)
  {
    for (std::size_t i = 0; i < count; ++i) {
      const double magnitude = std::max(-from[i], smallest);
      std::uint64_t all;
      std::memcpy(&all, &magnitude, sizeof all);
      all += std::uint64_t(1) << (shift - 1); // to round
      const std::uint64_t bits = (all - (offset & ~sign)) >> shift;
      m_high[index + i] = static_cast<High>(bits >> low_bits);
      m_low[index + i] = static_cast<Low>(bits);
    }
  }

private:
  static constexpr int low_bits = 8 * sizeof(Low);
  static constexpr int fraction_bits = 8 * sizeof(High) + low_bits - Exponent;
  static constexpr int shift = 52 - fraction_bits;
  static constexpr int lowest_exponent = 1 - (1 << Exponent);
  static constexpr std::uint64_t sign = std::uint64_t(1) << 63;
  /// Added to the bits of an entry: its sign, and the difference of the offsets of the exponents.
  static constexpr std::uint64_t offset = sign + (std::uint64_t(1023 + lowest_exponent) << 52);
  static constexpr double smallest =
      1.0 / static_cast<double>(std::uint64_t(1) << -lowest_exponent);

  std::vector<High> m_high;
  std::vector<Low> m_low;
};

} // namespace internal

/// The entries of a factor below its diagonal, in one of the sizes above.
class Factor_values
{
public:
  std::size_t size() const
  {
    return std::max({m_eight.values.size(), m_six.size(), m_three.size()});
  }

  /// Provides memory for `size` entries. Returns `false`, with fewer of them, if `go_on` does.
  bool resize(std::size_t size, Value_size value_size, const pcs::internal::Go_on& go_on)
  {
    *this = Factor_values();
    m_value_size = value_size;
    return use(*this, [&](auto& values) {
      values.reserve(size);
      while (values.size() < size) { // in parts, since new memory takes time
        values.resize(std::min(size, values.size() + values_between_calls));
        if (!pcs::internal::goes_on(go_on, 0))
          return false;
      }
      return true;
    });
  }

  /// Stores `count` entries from `index` on.
  void set(std::size_t index, const double* from, std::size_t count)
  {
    use(*this, [&](auto& values) {
      values.set(index, from, count);
      return true;
    });
  }

  /// Calls `f` with an object whose `column(index)[i]` is the entry `index + i`.
  template <class F>
  void visit(const F& f) const
  {
    use(*this, [&](const auto& values) {
      f(values);
      return true;
    });
  }

private:
  /// Number of entries for which memory is provided between two calls of `go_on`. [count]
  static constexpr std::size_t values_between_calls = 10000000;

  struct Doubles
  {
    const double* column(std::size_t index) const { return values.data() + index; }
    std::size_t size() const { return values.size(); }
    void reserve(std::size_t size) { values.reserve(size); }
    void resize(std::size_t size) { values.resize(size); }
    void set(std::size_t index, const double* from, std::size_t count)
    {
      std::copy_n(from, count, values.begin() + static_cast<std::ptrdiff_t>(index));
    }
    std::vector<double> values;
  };

  template <class Self, class F>
  static bool use(Self& self, const F& f)
  {
    switch (self.m_value_size) {
    case Value_size::six:
      return f(self.m_six);
    case Value_size::three:
      return f(self.m_three);
    default:
      return f(self.m_eight);
    }
  }

  Value_size m_value_size = Value_size::eight;
  Doubles m_eight;
  internal::Short_values<std::uint32_t, std::uint16_t, 6> m_six;
  internal::Short_values<std::uint16_t, std::uint8_t, 5> m_three;
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_FACTOR_VALUES_H

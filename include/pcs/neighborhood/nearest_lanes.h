// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Exclusion of candidates that are not among the nearest ones of eight points at a time.

#ifndef PCS_NEIGHBORHOOD_NEAREST_LANES_H
#define PCS_NEIGHBORHOOD_NEAREST_LANES_H

#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

namespace pcs {
namespace neighborhood {
namespace internal {

using pcs::internal::Float8;

/// Squared distances of candidates to eight queries.
struct Lane_search
{
  const float* query;        ///< eight coordinates x, then y, then z
  const float* candidate[3]; ///< coordinates x, y and z
  std::size_t begin, end;    ///< candidates to be measured
  std::size_t count;         ///< number of smallest distances
  float* smallest;           ///< `count` times eight distances, sorted in each lane
  float* all;                ///< eight distances of each candidate
};

PCS_ALWAYS_INLINE void
measure_candidate(const Float8* q, const Lane_search& s, std::size_t j, Float8& squared)
{
  const Float8 x = q[0] - s.candidate[0][j];
  const Float8 y = q[1] - s.candidate[1][j];
  const Float8 z = q[2] - s.candidate[2][j];
  squared = x * x + y * y + z * z;
  pcs::internal::store(squared, s.all + 8 * j);
}

/// Exchanges lanes so that those of `smaller` are not larger than those of `larger`.
PCS_ALWAYS_INLINE void sort_lanes(Float8& smaller, Float8& larger)
{
  Float8 least;
  pcs::internal::select_less(larger, smaller, larger, smaller, least);
  pcs::internal::select_less(larger, smaller, smaller, larger, larger);
  smaller = least;
}

PCS_ALWAYS_INLINE void load_query(const Lane_search& s, Float8* q)
{
  for (std::size_t c = 0; c < 3; ++c)
    pcs::internal::load(s.query + 8 * c, q[c]);
}

/// Number of smallest distances that stay in registers: six neighbours and the point itself.
constexpr std::size_t count_in_registers = 7;

PCS_ALWAYS_INLINE void measure_in_registers(const Lane_search& s)
{
  Float8 q[3], smallest[count_in_registers], squared;
  load_query(s, q);
  pcs::internal::unroll<count_in_registers>(
      [&](auto b) PCS_LAMBDA_INLINE { pcs::internal::load(s.smallest + 8 * b, smallest[b]); });
  for (std::size_t j = s.begin; j < s.end; ++j) {
    measure_candidate(q, s, j, squared);
    pcs::internal::unroll<count_in_registers>(
        [&](auto b) PCS_LAMBDA_INLINE { sort_lanes(smallest[b], squared); });
  }
  pcs::internal::unroll<count_in_registers>(
      [&](auto b) PCS_LAMBDA_INLINE { pcs::internal::store(smallest[b], s.smallest + 8 * b); });
}

PCS_ALWAYS_INLINE void measure_in_memory(const Lane_search& s)
{
  Float8 q[3], smallest, squared;
  load_query(s, q);
  for (std::size_t j = s.begin; j < s.end; ++j) {
    measure_candidate(q, s, j, squared);
    for (std::size_t b = 0; b < s.count; ++b) {
      pcs::internal::load(s.smallest + 8 * b, smallest);
      sort_lanes(smallest, squared);
      pcs::internal::store(smallest, s.smallest + 8 * b);
    }
  }
}

PCS_ALWAYS_INLINE void measure_lanes(const Lane_search& s)
{
  if (s.count == count_in_registers)
    measure_in_registers(s);
  else
    measure_in_memory(s);
}

inline void measure_lanes_plain(const Lane_search& s)
{
  measure_lanes(s);
}
inline void
mark_lanes_plain(const float* all, std::size_t n, const float* limit, std::uint8_t* mask)
{
  for (std::size_t j = 0; j < n; ++j) {
    unsigned bits = 0;
    for (unsigned l = 0; l < 8; ++l)
      bits |= (all[8 * j + l] <= limit[l] ? 1u : 0u) << l;
    mask[j] = static_cast<std::uint8_t>(bits);
  }
}

#if PCS_HAS_RUNTIME_DISPATCH && !defined(PCS_NO_VECTOR_EXTENSIONS)
PCS_TARGET_AVX2 inline void measure_lanes_avx2(const Lane_search& s)
{
  measure_lanes(s);
}
PCS_TARGET_AVX2 inline void
mark_lanes_avx2(const float* all, std::size_t n, const float* limit, std::uint8_t* mask)
{
  Float8 most, distance;
  pcs::internal::load(limit, most);
  for (std::size_t j = 0; j < n; ++j) {
    pcs::internal::load(all + 8 * j, distance);
    mask[j] = static_cast<std::uint8_t>(
        __builtin_ia32_movmskps256(reinterpret_cast<Float8>(distance <= most)));
  }
}
#endif

/// The kernels for this machine. Their bits affect no result.
struct Lane_kernels
{
  void (*measure)(const Lane_search&) = &measure_lanes_plain;
  /// Sets bit `l` of `mask[j]` if the distance of candidate `j` to query `l` is at most `limit[l]`.
  void (*mark)(const float* all,
               std::size_t n,
               const float* limit,
               std::uint8_t* mask) = &mark_lanes_plain;

  Lane_kernels()
  {
#if PCS_HAS_RUNTIME_DISPATCH && !defined(PCS_NO_VECTOR_EXTENSIONS)
    if (pcs::internal::has_avx2()) {
      measure = &measure_lanes_avx2;
      mark = &mark_lanes_avx2;
    }
#endif
  }
};

inline const Lane_kernels& lane_kernels()
{
  static const Lane_kernels kernels;
  return kernels;
}

/// Transposes 8 x 8 bits, of which each byte is a row [Warren, Hacker's Delight, section 7-3].
inline std::uint64_t transpose_bits(std::uint64_t x)
{
  std::uint64_t t = (x ^ x >> 7) & 0x00aa00aa00aa00aa;
  x ^= t ^ t << 7;
  t = (x ^ x >> 14) & 0x0000cccc0000cccc;
  x ^= t ^ t << 14;
  t = (x ^ x >> 28) & 0x00000000f0f0f0f0;
  return x ^ t ^ t << 28;
}

/// Returns the number of the lowest bit of `bits`, which is not 0.
inline unsigned lowest_bit(std::uint64_t bits)
{
#if defined(__GNUC__) || defined(__clang__)
  return static_cast<unsigned>(__builtin_ctzll(bits));
#else
  unsigned b = 0;
  for (; !(bits >> b & 1); ++b) {
  }
  return b;
#endif
}

/// The candidates within the limits of eight queries.
class Lane_hits
{
public:
  /// \param all eight squared distances of each of `n` candidates
  /// \param limit the largest squared distance of each query
  /// \param index the numbers by which hits are listed
  void find(const float* all, std::size_t n, const float* limit, const std::uint32_t* index)
  {
    if (n > m_capacity) {
      m_capacity = 2 * n;
      m_hits.resize(8 * m_capacity);
      m_mask.resize(2 * n + 64);
    }
    lane_kernels().mark(all, n, limit, m_mask.data());
    std::fill_n(m_mask.begin() + static_cast<std::ptrdiff_t>(n),
                63 - (n + 63) % 64,
                std::uint8_t(0));
    std::fill(std::begin(m_count), std::end(m_count), std::size_t(0));
    for (std::size_t first = 0; first < n; first += 64)
      list(first, std::min<std::size_t>(n - first, 64), index);
  }

  std::size_t count(std::size_t query) const { return m_count[query]; }
  /// Returns the hits of a query, in the order of the candidates.
  const std::uint32_t* of_query(std::size_t query) const
  {
    return m_hits.data() + query * m_capacity;
  }

private:
  /// Lists the marked ones of up to 64 candidates.
  void list(std::size_t first, std::size_t count_of_marks, const std::uint32_t* index)
  {
    std::uint64_t marks[8] = {};
    for (std::size_t byte = 0; 8 * byte < count_of_marks; ++byte) {
      std::uint64_t rows = 0; // of a candidate each
      for (std::size_t j = 0; j < 8; ++j)
        rows |= std::uint64_t(m_mask[first + 8 * byte + j]) << 8 * j;
      rows = transpose_bits(rows);
      for (std::size_t l = 0; l < 8; ++l)
        marks[l] |= (rows >> 8 * l & 0xff) << 8 * byte;
    }
    for (std::size_t l = 0; l < 8; ++l) {
      std::uint32_t* hits = m_hits.data() + l * m_capacity;
      std::size_t count = m_count[l];
      for (std::uint64_t bits = marks[l]; bits != 0; bits &= bits - 1)
        hits[count++] = index[first + lowest_bit(bits)];
      m_count[l] = count;
    }
  }

  std::size_t m_capacity = 0, m_count[8] = {};
  std::vector<std::uint8_t> m_mask; ///< one bit for each query
  std::vector<std::uint32_t> m_hits;
};

} // namespace internal
} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_NEAREST_LANES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Non-temporal stores of a block of vectors.

#ifndef PCS_DEFORMATION_ACCESS_STREAM_BLOCK_H
#define PCS_DEFORMATION_ACCESS_STREAM_BLOCK_H

#include <pcs/concepts.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/streaming_stores.h>

#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>

namespace pcs {
namespace deformation {

/// Smallest output for which the caches are bypassed; smaller outputs fit into the last-level
/// cache. [byte]
constexpr std::size_t smallest_stream = std::size_t(32) << 20;

/// Whether a `Triple` has the size of three doubles; `is_triple()` checks that these are its
/// coordinates in order.
template <class Triple>
constexpr bool has_size_of_triple()
{
  return std::is_trivially_copyable_v<Triple> && sizeof(Triple) == 3 * sizeof(double) &&
         std::is_same_v<std::decay_t<decltype(std::declval<const Triple&>().x())>, double>;
}

template <class Triple>
bool is_triple()
{
  const Triple probe(1.0, 2.0, 3.0);
  double value[3];
  std::memcpy(value, &probe, sizeof(value));
  return value[0] == 1 && value[1] == 2 && value[2] == 3;
}

/// Whether `get()` of the map returns the memory that `put()` writes, and this memory does not
/// belong to the key: elements of a range may be temporary objects of its iterators.
template <class Map, class ElementReference>
constexpr bool is_memory_map()
{
  using Value = Map_value<Map>;
  using Returned = decltype(get(std::declval<const Map&>(), std::declval<ElementReference>()));
  return std::is_convertible_v<typename boost::property_traits<Map>::category,
                               boost::lvalue_property_map_tag> &&
         std::is_lvalue_reference_v<Returned> && std::is_same_v<std::decay_t<Returned>, Value> &&
         (std::is_lvalue_reference_v<ElementReference> ||
          sizeof(std::decay_t<ElementReference>) < sizeof(Value));
}

/// Returns the address of `value(0)` if, for all points `l` of a block, the address of `value(l)`
/// is `l * stride` doubles after it; otherwise null.
template <class Value>
PCS_ALWAYS_INLINE double* find_run(const Value& value, std::size_t stride)
{
  const auto address = [&](std::size_t l) PCS_LAMBDA_INLINE {
    return reinterpret_cast<std::uintptr_t>(std::addressof(value(l)));
  };
  const std::uintptr_t begin = address(0);
  bool is_run = true;
  pcs::internal::unroll<lanes>([&](auto l) PCS_LAMBDA_INLINE {
    is_run = is_run && address(l) == begin + l * stride * sizeof(double);
  });
  return is_run ? reinterpret_cast<double*>(begin) : nullptr;
}

PCS_ALWAYS_INLINE bool is_streamable(const double* to)
{
  return to && reinterpret_cast<std::uintptr_t>(to) % pcs::internal::stream_alignment == 0;
}

/// Streams eight vectors to `to`.
PCS_ALWAYS_INLINE void stream_block(double* to, const Lane_vectors& v)
{
  pcs::internal::unroll<lanes / 2>([&](auto pair) PCS_LAMBDA_INLINE {
    using namespace pcs::internal;
    constexpr std::size_t l = 2 * decltype(pair)::value;
    const Double_pair x = load_pair(v.value[0] + l);
    const Double_pair y = load_pair(v.value[1] + l);
    const Double_pair z = load_pair(v.value[2] + l);
    double* const at = to + 3 * l;
    stream(first_of(x, y), at);
    stream(across(z, x), at + 2);
    stream(second_of(y, z), at + 4);
  });
}

/// Streams eight pairs of vectors to `to`.
PCS_ALWAYS_INLINE void stream_block(double* to, const Lane_vectors& u, const Lane_vectors& v)
{
  pcs::internal::unroll<lanes / 2>([&](auto pair) PCS_LAMBDA_INLINE {
    using namespace pcs::internal;
    constexpr std::size_t l = 2 * decltype(pair)::value;
    const Double_pair a = load_pair(u.value[0] + l), b = load_pair(u.value[1] + l);
    const Double_pair c = load_pair(u.value[2] + l), d = load_pair(v.value[0] + l);
    const Double_pair e = load_pair(v.value[1] + l), f = load_pair(v.value[2] + l);
    double* const at = to + 6 * l;
    stream(first_of(a, b), at);
    stream(first_of(c, d), at + 2);
    stream(first_of(e, f), at + 4);
    stream(second_of(a, b), at + 6);
    stream(second_of(c, d), at + 8);
    stream(second_of(e, f), at + 10);
  });
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_STREAM_BLOCK_H

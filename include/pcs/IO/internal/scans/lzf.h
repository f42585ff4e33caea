// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Decompresses data of the LZF algorithm, as in PCD files.

#ifndef PCS_IO_INTERNAL_SCANS_LZF_H
#define PCS_IO_INTERNAL_SCANS_LZF_H

#include <cstddef>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

//! the largest number of bytes that one byte of LZF data can represent: 264 from 3 bytes
constexpr std::size_t largest_lzf_ratio = 88;

/*!
  Fills `to` with the decompressed data. Returns `false` if the data are damaged: if they refer to
  bytes before the beginning, or do not represent exactly as many bytes as `to` has.

  A control byte below 32 precedes that number of bytes, plus one, which are copied. Otherwise, its
  upper three bits are the length of a repetition minus two (7: the next byte is added), and its
  lower five bits with the following byte are the distance to the repeated bytes minus one.
*/
inline bool decompress_lzf(const std::vector<unsigned char>& from, std::vector<unsigned char>& to)
{
  std::size_t in = 0, out = 0;
  while (in < from.size()) {
    const std::size_t control = from[in++];
    if (control < 32) {
      const std::size_t n = control + 1;
      if (n > from.size() - in || n > to.size() - out)
        return false;
      for (std::size_t i = 0; i < n; ++i)
        to[out++] = from[in++];
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (in == from.size())
        return false;
      length += from[in++];
    }
    length += 2;
    if (in == from.size())
      return false;
    const std::size_t distance = ((control & 31) << 8) + from[in++] + 1;
    if (distance > out || length > to.size() - out)
      return false;
    for (std::size_t i = 0; i < length; ++i, ++out) // the regions may overlap
      to[out] = to[out - distance];
  }
  return out == to.size();
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_SCANS_LZF_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Numbers in messages, short at every magnitude.

#ifndef PCS_INTERNAL_TEXT_H
#define PCS_INTERNAL_TEXT_H

#include <sstream>
#include <string>

namespace pcs {
namespace internal {

/// Formats `value` with six significant digits; `std::to_string` prints 1e300 with 300 digits.
template <class T>
std::string to_text(const T& value)
{
  std::ostringstream out;
  out << value;
  return out.str();
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_TEXT_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Warning about a height that indicates different units of the coordinates and the breast height.

#ifndef PCS_INTERNAL_UNIT_OF_HEIGHT_H
#define PCS_INTERNAL_UNIT_OF_HEIGHT_H

#include <sstream>
#include <string>
#include <vector>

namespace pcs {
namespace internal {

/// Appends a sentence that begins with `subject` if `height` is implausible for a tree. Both values
/// should have the same unit.
inline void warn_of_unit(const std::string& subject,
                         double height,
                         double breast_height,
                         std::vector<std::string>& sentences)
{
  // in units of the breast height; the tallest tree is 116 m high, plants that are scanned are
  // higher than 3 cm [-]
  constexpr double tallest = 100, lowest = 0.02;
  const bool is_implausible =
      height > tallest * breast_height || (height > 0 && height < lowest * breast_height);
  if (!(breast_height > 0 && is_implausible))
    return;
  std::ostringstream sentence;
  sentence.precision(3);
  sentence << subject << " is " << height / breast_height
           << " times as high as breast height, which may be in another unit than the scan";
  sentences.push_back(sentence.str());
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_UNIT_OF_HEIGHT_H

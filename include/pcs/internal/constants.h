// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Mathematical constants.

#ifndef PCS_INTERNAL_CONSTANTS_H
#define PCS_INTERNAL_CONSTANTS_H

namespace pcs {
namespace internal {

constexpr double pi = 3.141592653589793238462643383279502884;

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_CONSTANTS_H

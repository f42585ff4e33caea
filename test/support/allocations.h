// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Counts the allocations of a test executable with support/allocations.cpp, and lets one of them
// fail.

#ifndef PCS_TEST_SUPPORT_ALLOCATIONS_H
#define PCS_TEST_SUPPORT_ALLOCATIONS_H

#include <atomic>

namespace pcs_test {

// shared between threads
inline std::atomic<long> number_of_allocations{0};
inline std::atomic<long> allocations_left{-1}; ///< before one fails; negative: none fails
inline std::atomic<bool> has_failed{false};

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_ALLOCATIONS_H

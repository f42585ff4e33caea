// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Counts the allocations of a test executable with support/allocations.cpp and their bytes, and
// lets one of them fail. Memory of malloc() is not counted.

#ifndef PCS_TEST_SUPPORT_ALLOCATIONS_H
#define PCS_TEST_SUPPORT_ALLOCATIONS_H

#include <atomic>

namespace pcs_test {

// shared between threads
inline std::atomic<long> number_of_allocations{0};
inline std::atomic<long> allocations_left{-1}; ///< before one fails; negative: none fails
inline std::atomic<bool> has_failed{false};
inline std::atomic<long> allocated_bytes{0};
inline std::atomic<long> peak_of_bytes{0}; ///< largest number of allocated bytes

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_ALLOCATIONS_H

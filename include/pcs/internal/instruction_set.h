// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compiles a kernel for the build's own instruction set and for AVX2, and picks one at run time.

#ifndef PCS_INTERNAL_INSTRUCTION_SET_H
#define PCS_INTERNAL_INSTRUCTION_SET_H

// AVX2 without FMA: a fused multiply-add rounds once instead of twice, and results must not depend on the machine.
#if (defined(__GNUC__) || defined(__clang__)) && defined(__x86_64__) &&                            \
    !defined(PCS_NO_RUNTIME_DISPATCH)
#define PCS_HAS_RUNTIME_DISPATCH 1
#define PCS_TARGET_AVX2 __attribute__((target("avx2")))
#define PCS_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define PCS_HAS_RUNTIME_DISPATCH 0
#define PCS_ALWAYS_INLINE inline
#endif

// A lambda in a kernel must become part of it: alone it would be compiled for another instruction set.
#if defined(__GNUC__) || defined(__clang__)
#define PCS_LAMBDA_INLINE __attribute__((always_inline))
#else
#define PCS_LAMBDA_INLINE
#endif

namespace pcs {
namespace internal {

inline bool has_avx2()
{
#if PCS_HAS_RUNTIME_DISPATCH
  static const bool answer = __builtin_cpu_supports("avx2") != 0;
  return answer;
#else
  return false;
#endif
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_INSTRUCTION_SET_H

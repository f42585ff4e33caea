// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Run-time selection of kernels compiled for the default instruction set, AVX2 and AVX-512.

#ifndef PCS_INTERNAL_INSTRUCTION_SET_H
#define PCS_INTERNAL_INSTRUCTION_SET_H

// Kernels fuse multiply-adds explicitly, so all machines give the same bits. Machines without this
// instruction are slow.
#if (defined(__GNUC__) || defined(__clang__)) && defined(__x86_64__) &&                            \
    !defined(PCS_NO_RUNTIME_DISPATCH)
#define PCS_HAS_RUNTIME_DISPATCH 1
#define PCS_TARGET_AVX2 __attribute__((target("avx2,fma")))
// For kernels without explicit fusion: compilers would fuse multiply-adds if they could.
#define PCS_TARGET_AVX2_UNFUSED __attribute__((target("avx2")))
#define PCS_ALWAYS_INLINE inline __attribute__((always_inline))
// Clang needs the instruction set only at functions with assembly.
#if defined(__clang__)
#define PCS_TARGET_AVX512                                                                          \
  __attribute__((target("avx512f,avx512vl,avx512dq,fma"), min_vector_width(512)))
#else
#define PCS_TARGET_AVX512 __attribute__((target("avx512f,avx512vl,avx512dq,fma")))
#define PCS_HAS_AVX_ASSEMBLY 1
#endif
#else
#define PCS_HAS_RUNTIME_DISPATCH 0
#define PCS_ALWAYS_INLINE inline
#endif

// A lambda in a kernel must be inlined: a separate function would be compiled for another
// instruction set.
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
  static const bool answer =
      __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  return answer;
#else
  return false;
#endif
}

/// Whether to use full AVX-512 registers. The extensions required here exclude processors that slow
/// down when these registers are used.
inline bool has_avx512()
{
#if PCS_HAS_RUNTIME_DISPATCH
  static const bool answer =
      __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
      __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vnni") != 0;
  return answer;
#else
  return false;
#endif
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_INSTRUCTION_SET_H

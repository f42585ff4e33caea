// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Memory setting for large clouds: freed memory stays with the process, on huge pages.

#ifndef PCS_CORE_KEEP_MEMORY_H
#define PCS_CORE_KEEP_MEMORY_H

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>

#ifdef __linux__
#include <malloc.h>
#include <sys/mman.h>
#endif

namespace pcs {

/*!
  \ingroup PkgPcsCoreRef
  asks the C library to keep memory that is freed for what is allocated next, and Linux to put the
  first gigabyte of it on pages of 2 MB. Every stage on a large cloud allocates and frees arrays of
  tens of megabytes; as it comes, glibc hands each one back to the system, which clears it again
  page by page: a quarter to a third of the time of a skeleton on virtual machines, less on real
  ones.

  For programs, not for libraries: it concerns the whole process. Call it once, before anything
  large is allocated. Nothing is reserved, and results stay the same; the process keeps the most
  that it ever used. Where the C library is not glibc, or with another allocator, it does nothing.
  Returns whether it did something. O(1).
*/
inline bool keep_memory()
{
#if defined(__linux__) && defined(__GLIBC__) && defined(MADV_HUGEPAGE)
  constexpr int never =
      std::numeric_limits<int>::max(); // bytes that are free at the end of the heap, not given back
  if (mallopt(M_MMAP_MAX, 0) != 1 || mallopt(M_TRIM_THRESHOLD, never) != 1)
    return false;
  constexpr std::size_t reach = std::size_t(1) << 30, page = std::size_t(1) << 21;
  void* const memory = std::malloc(reach); // addresses only; they stay when it is freed
  if (memory == nullptr)
    return true; // a limit; pages stay small
  const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (begin + page - 1) / page * page;
  const std::uintptr_t last = (begin + reach) / page * page;
  madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE); // a wish: it may be refused
  std::free(memory);
  return true;
#else
  return false;
#endif
}

} // namespace pcs

#endif // PCS_CORE_KEEP_MEMORY_H

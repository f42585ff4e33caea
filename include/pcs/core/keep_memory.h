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
  asks the C library to reuse freed memory, and Linux to use pages of 2 MB for the first gigabyte of
  the heap.
  Every stage on a large cloud allocates and frees arrays of tens of megabytes. By default, glibc
  returns each of them to the system, which clears the pages again: this takes a quarter to a third
  of the time of a skeleton on virtual machines, and less on physical ones.

  Meant for programs, not for libraries, because it affects the whole process. Call it once, before
  the first large allocation. It reserves no memory and does not change results, but the process
  keeps its peak memory. It has no effect if the C library is not glibc or another allocator is in
  use. Returns whether it had an effect. O(1).
*/
inline bool keep_memory()
{
#if defined(__linux__) && defined(__GLIBC__) && defined(MADV_HUGEPAGE)
  constexpr int never =
      std::numeric_limits<int>::max(); // free bytes at the end of the heap that are not returned
  if (mallopt(M_MMAP_MAX, 0) != 1 || mallopt(M_TRIM_THRESHOLD, never) != 1)
    return false;
  constexpr std::size_t reach = std::size_t(1) << 30, page = std::size_t(1) << 21;
  void* const memory = std::malloc(reach); // reserves addresses only; they remain when it is freed
  if (memory == nullptr)
    return true; // a memory limit applies; pages stay small
  const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (begin + page - 1) / page * page;
  const std::uintptr_t last = (begin + reach) / page * page;
  madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE); // may be refused
  std::free(memory);
  return true;
#else
  return false;
#endif
}

} // namespace pcs

#endif // PCS_CORE_KEEP_MEMORY_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0

#include <support/allocations.h>

#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__GNUC__) && !defined(__clang__)
// GCC 12 treats an inlined operator delete as a call of free() on memory of the replaced operator
// new.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
#endif

namespace {

void* allocate(std::size_t size, std::size_t alignment)
{
  using namespace pcs_test;
  ++number_of_allocations;
  if (allocations_left.load() >= 0 && allocations_left.fetch_sub(1) == 0) {
    allocations_left = -1;
    has_failed = true;
    throw std::bad_alloc();
  }
  const std::size_t rounded = (size + alignment) / alignment * alignment; // at least one byte
  void* result = std::aligned_alloc(alignment, rounded);
  if (!result)
    throw std::bad_alloc();
  return result;
}

} // namespace

void* operator new(std::size_t size)
{
  return allocate(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment)
{
  return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
  try {
    return allocate(size, alignof(std::max_align_t));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* p) noexcept
{
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept
{
  std::free(p);
}
void operator delete(void* p, const std::nothrow_t&) noexcept
{
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept
{
  std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept
{
  std::free(p);
}

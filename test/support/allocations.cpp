// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0

#include <support/allocations.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>

#if defined(__GNUC__) && !defined(__clang__)
// GCC 12 treats an inlined operator delete as a call of free() on memory of the replaced operator
// new.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
#endif

namespace {

/// Bytes before an allocated block, which store its size.
std::size_t front_of(std::size_t alignment)
{
  return std::max(alignment, sizeof(std::size_t));
}

void* allocate(std::size_t size, std::size_t alignment)
{
  using namespace pcs_test;
  ++number_of_allocations;
  if (allocations_left.load() >= 0 && allocations_left.fetch_sub(1) == 0) {
    allocations_left = -1;
    has_failed = true;
    throw std::bad_alloc();
  }
  const std::size_t front = front_of(alignment);
  const std::size_t rounded = (front + size + alignment) / alignment * alignment;
  void* const memory = std::aligned_alloc(alignment, rounded);
  if (!memory)
    throw std::bad_alloc();
  std::memcpy(memory, &size, sizeof size);
  const long now = allocated_bytes += static_cast<long>(size);
  long peak = peak_of_bytes;
  while (now > peak && !peak_of_bytes.compare_exchange_weak(peak, now)) {
  }
  return static_cast<char*>(memory) + front;
}

void release(void* p, std::size_t alignment) noexcept
{
  if (p == nullptr)
    return;
  void* const memory = static_cast<char*>(p) - front_of(alignment);
  std::size_t size = 0;
  std::memcpy(&size, memory, sizeof size);
  pcs_test::allocated_bytes -= static_cast<long>(size);
  std::free(memory);
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
  release(p, alignof(std::max_align_t));
}
void operator delete(void* p, std::size_t) noexcept
{
  release(p, alignof(std::max_align_t));
}
void operator delete(void* p, const std::nothrow_t&) noexcept
{
  release(p, alignof(std::max_align_t));
}
void operator delete(void* p, std::align_val_t alignment) noexcept
{
  release(p, static_cast<std::size_t>(alignment));
}
void operator delete(void* p, std::size_t, std::align_val_t alignment) noexcept
{
  release(p, static_cast<std::size_t>(alignment));
}

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes one number from all tasks of a loop, or from two tasks. The thread sanitizer must report
// it.

#include <pcs/internal/parallel.h>

#include <cstddef>
#include <cstdio>
#include <cstring>

int main(int argc, char** argv)
{
  long sum = 0;
  if (argc == 2 && std::strcmp(argv[1], "loop") == 0)
    pcs::internal::for_each_index<CGAL::Parallel_tag>(100000, [&](std::size_t i) {
      if (i % 5000 == 0)
        ++sum;
    });
  else
    pcs::internal::invoke_both<CGAL::Parallel_tag>([&] { ++sum; }, [&] { ++sum; });
  std::printf("%ld\n", sum);
}

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Freed memory is reused without new page requests to the system.

#include <pcs/core/keep_memory.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <vector>

#if __has_include(<sys/resource.h>)
#include <sys/resource.h>
#endif

namespace test_keep_memory {

BOOST_AUTO_TEST_SUITE(keep_memory)

BOOST_AUTO_TEST_CASE(pages_are_used_again)
{
#if defined(__SANITIZE_THREAD__)
  BOOST_TEST_MESSAGE("skipped: the thread sanitizer has an allocator of its own");
#elif __has_include(<sys/resource.h>)
  constexpr std::size_t size = std::size_t(64) << 20;
  const auto faults_of_an_array = [] {
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    std::vector<char> array(size, 1);
    getrusage(RUSAGE_SELF, &after);
    BOOST_TEST(array[size / 2] == 1);
    return after.ru_minflt - before.ru_minflt;
  };
  if (!pcs::keep_memory()) {
    BOOST_TEST_MESSAGE("skipped: not with this C library");
    return;
  }
  faults_of_an_array();
  BOOST_TEST(faults_of_an_array() < 100); // of 16384 pages
#endif
}

BOOST_AUTO_TEST_CASE(it_may_be_said_again)
{
  const bool first = pcs::keep_memory();
  BOOST_TEST(pcs::keep_memory() == first);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_keep_memory

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compressed rows contain every entry once, sorted by row, in the order of the entries.

#include <pcs/internal/Random_stream.h>
#include <pcs/internal/compress_rows.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace test_compress_rows {

namespace {

/// The rows of entries with the row indices `row_of`.
struct Rows
{
  std::vector<std::size_t> sizes; ///< arguments of `resize`
  std::vector<std::size_t> entry; ///< indices of the entries, by position
  std::vector<std::uint32_t> first;

  Rows(std::size_t number_of_rows, const std::vector<std::size_t>& row_of)
    : first(pcs::internal::compress_rows<std::uint32_t>(
          number_of_rows,
          row_of.size(),
          [&](std::size_t k) { return row_of[k]; },
          [&](std::size_t n) {
            sizes.push_back(n);
            entry.assign(n, row_of.size());
          },
          [&](std::size_t k, std::size_t position) { entry.at(position) = k; }))
  {
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(compressed_rows)

BOOST_AUTO_TEST_CASE(entries_of_a_row_keep_their_order)
{
  const Rows rows(4, {2, 0, 2, 3, 0, 2});
  const std::vector<std::uint32_t> first{0, 2, 2, 5, 6};
  const std::vector<std::size_t> entry{1, 4, 0, 2, 5, 3};
  BOOST_TEST(rows.first == first, boost::test_tools::per_element());
  BOOST_TEST(rows.entry == entry, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(entries_without_a_row_are_omitted)
{
  const Rows rows(2, {1, 2, 0, 7, 1});
  const std::vector<std::uint32_t> first{0, 1, 3};
  const std::vector<std::size_t> entry{2, 0, 4};
  BOOST_TEST(rows.first == first, boost::test_tools::per_element());
  BOOST_TEST(rows.entry == entry, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(memory_is_requested_once_for_the_remaining_entries)
{
  BOOST_TEST(Rows(2, {1, 2, 0}).sizes == std::vector<std::size_t>{2},
             boost::test_tools::per_element());
  BOOST_TEST(Rows(2, {}).sizes == std::vector<std::size_t>{0}, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(rows_may_be_empty_or_absent)
{
  BOOST_TEST(Rows(3, {}).first == std::vector<std::uint32_t>(4, 0),
             boost::test_tools::per_element());
  const Rows none(0, {0, 1});
  BOOST_TEST(none.first == std::vector<std::uint32_t>{0}, boost::test_tools::per_element());
  BOOST_TEST(none.entry.empty());
}

BOOST_AUTO_TEST_CASE(random_rows_contain_every_entry_once_in_increasing_order)
{
  constexpr std::size_t number_of_rows = 50;
  pcs::internal::Random_stream random(1);
  std::vector<std::size_t> row_of(1000);
  for (std::size_t& r : row_of)
    r = random.bits() % number_of_rows;
  const Rows rows(number_of_rows, row_of);
  BOOST_TEST_REQUIRE(rows.entry.size() == row_of.size());
  BOOST_TEST(rows.first.front() == 0u);
  BOOST_TEST(rows.first.back() == row_of.size());
  for (std::size_t r = 0; r < number_of_rows; ++r)
    for (std::size_t k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      BOOST_TEST(row_of[rows.entry[k]] == r);
      BOOST_TEST((k == rows.first[r] || rows.entry[k - 1] < rows.entry[k]));
    }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_compress_rows

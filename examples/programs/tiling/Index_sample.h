// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Samples of sets of points by which the overlap of two sets is estimated.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_INDEX_SAMPLE_H
#define PCS_EXAMPLES_PROGRAMS_TILING_INDEX_SAMPLE_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

namespace program {

/*!
  The points with the smallest hash values of their indices, at most `size` of them. The values are
  the same in all tiles, so the samples of two sets have the same points of their intersection up to
  the smaller of their largest hash values (bottom-k sketch: Broder, On the resemblance and
  containment of documents, 1997).
*/
class Index_sample
{
public:
  static constexpr std::size_t size = 64;

  void add(std::uint64_t index)
  {
    const Entry entry(hash(index), index);
    if (m_entries.size() == size && !(entry < *m_entries.rbegin()))
      return;
    m_entries.insert(entry);
    if (m_entries.size() > size)
      m_entries.erase(std::prev(m_entries.end()));
  }

  /// Returns the indices in ascending order of their hash values.
  std::vector<std::uint64_t> indices() const
  {
    std::vector<std::uint64_t> result;
    for (const Entry& entry : m_entries)
      result.push_back(entry.second);
    return result;
  }

  /// Estimates the size of the intersection of two sets relative to the smaller one [-] from their
  /// samples. The standard error is below 0.1 for sets with more than `size` points. 0 for an empty
  /// set.
  static double overlap(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b)
  {
    if (a.empty() || b.empty())
      return 0;
    const std::vector<Entry> p = entries(a), q = entries(b);
    const auto limit = [](const std::vector<Entry>& set) { // a small set is complete
      return set.size() < size ? Entry(~std::uint64_t(0), ~std::uint64_t(0)) : set.back();
    };
    const Entry end = std::min(limit(p), limit(q));
    const auto count = [&end](const std::vector<Entry>& set) {
      return std::upper_bound(set.begin(), set.end(), end) - set.begin();
    };
    std::vector<Entry> common;
    std::set_intersection(p.begin(),
                          p.begin() + count(p),
                          q.begin(),
                          q.begin() + count(q),
                          std::back_inserter(common));
    const auto smaller = std::min(count(p), count(q));
    return smaller == 0 ? 0 : static_cast<double>(common.size()) / static_cast<double>(smaller);
  }

private:
  using Entry = std::pair<std::uint64_t, std::uint64_t>; ///< hash value and index

  /// The finaliser of SplitMix64 (Steele et al. 2014).
  static std::uint64_t hash(std::uint64_t x)
  {
    x += 0x9e3779b97f4a7c15;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
  }

  static std::vector<Entry> entries(const std::vector<std::uint64_t>& indices)
  {
    std::vector<Entry> result;
    for (const std::uint64_t i : indices)
      result.emplace_back(hash(i), i);
    std::sort(result.begin(), result.end());
    return result;
  }

  std::set<Entry> m_entries;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_INDEX_SAMPLE_H

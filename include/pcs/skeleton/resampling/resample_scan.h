// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random subsets of a scan, and randomly displaced points.

#ifndef PCS_SKELETON_RESAMPLING_RESAMPLE_SCAN_H
#define PCS_SKELETON_RESAMPLING_RESAMPLE_SCAN_H

#include <pcs/internal/Random_stream.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pcs {
namespace skeleton {

/// Input points of a scan with their attributes.
struct Scan_points
{
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> is_wood; ///< empty: unknown
  std::vector<long long> stations;   ///< empty: unknown
  std::vector<Vec3> normals;         ///< empty: unknown
};

/// Scans with fewer points are not resampled [count].
constexpr std::size_t least_resampled_points = 100;

/// Returns the probability that a copy of a scan of `n` points keeps a point [-].
inline double resampled_fraction(std::size_t n)
{
  constexpr double max_fraction = 0.9;
  constexpr double max_points = 40000; // enough for the trunk and thick branches, and fast
  return std::min(max_fraction, max_points / double(std::max<std::size_t>(n, 1)));
}

/*!
  Returns the largest number of copies of a scan of `n` points, if `wanted` copies differ too much:
  up to four times as many, as long as they have at most 200,000 points together.
*/
inline std::size_t largest_number_of_copies(std::size_t n, std::size_t wanted)
{
  constexpr double max_points = 200000;
  const double points = resampled_fraction(n) * double(std::max<std::size_t>(n, 1));
  return std::max(wanted, std::min(4 * wanted, static_cast<std::size_t>(max_points / points)));
}

/*!
  Returns a random subset of a scan of n points. Each point is kept independently with the
  probability `resampled_fraction(n)`; the choice depends only on `seed` and the indices of the
  points. O(n).
*/
inline Scan_points resample_scan(const Scan_points& scan, std::uint64_t seed)
{
  Scan_points copy;
  const double fraction = resampled_fraction(scan.positions.size());
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    if (!(pcs::internal::Random_stream(seed, i).uniform() < fraction))
      continue;
    copy.positions.push_back(scan.positions[i]);
    if (!scan.is_wood.empty())
      copy.is_wood.push_back(scan.is_wood[i]);
    if (!scan.stations.empty())
      copy.stations.push_back(scan.stations[i]);
    if (!scan.normals.empty())
      copy.normals.push_back(scan.normals[i]);
  }
  return copy;
}

/// Displaces each coordinate by at most `largest` [L]. The displacement of a point depends only on
/// `seed` and its position, so equal points remain equal. O(n).
inline void displace_points(std::vector<Vec3>& points, double largest, std::uint64_t seed)
{
  for (Vec3& p : points) {
    std::array<std::uint64_t, 3> bits{};
    static_assert(sizeof bits == sizeof p);
    p += Vec3::Zero(); // -0 becomes 0, which is equal
    std::memcpy(bits.data(), p.data(), sizeof bits);
    pcs::internal::Random_stream random(seed, bits[0], bits[1], bits[2]);
    for (int k = 0; k < 3; ++k)
      p[k] += largest * (2 * random.uniform() - 1);
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESAMPLING_RESAMPLE_SCAN_H

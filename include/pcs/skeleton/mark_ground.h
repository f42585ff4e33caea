// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Recognises a slice of ground below a tree, so that it is not taken for roots.

#ifndef PCS_SKELETON_MARK_GROUND_H
#define PCS_SKELETON_MARK_GROUND_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/Neighbor_graph.h>
#include <pcs/skeleton/Scan.h>
#include <pcs/skeleton/find_root.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// When low points are ground: a filled sheet, much wider than the stem above it.
struct Ground_rules
{
  double bin = 0.01;   ///< height of a bin relative to the extent upwards, at least 4 spacings [-]
  int bins = 12;       ///< that are looked at from below
  double width = 3;    ///< of the sheet relative to the stem [-]
  double keep = 2;     ///< what lies this many stem widths around the stem is kept [-]
  double filled = 0.4; ///< share of the cells of the sheet that hold points [-]
  int cells = 20;      ///< along the radius of the sheet
  double steepest = 0.5; ///< slope up to which the sheet is followed above the bins,
  double most = 0.2;  ///< ... if it has this share of the points; the feet of stems have less [-]
  double thin = 0.1;  ///< of a cloud that is nothing else: deviation across it by that along it,
  double full = 0.7;  ///< ... share of its cells that hold points,
  double longest = 8; ///< ... and its length by its width [-]
  double standing = 0.99;  ///< quantile of distances from its plane that tells what stands on it,
  double tall = 0.2;       ///< ... which is this high, by the deviation along the sheet,
  double outstanding = 10; ///< ... and by the median distance [-]
};

namespace internal {

/// Horizontal centre and root mean square width of one bin.
struct Bin_extent
{
  Vec3 center = Vec3::Zero();
  double width = 0;
  std::size_t count = 0;
};

/// Whether points fill an ellipse around `center`: a disc along `e1` and `e2`, of which the shorter one has length 1.
inline bool is_filled_sheet(const Scan& scan,
                            const std::vector<Index>& points,
                            const Vec3& center,
                            const Vec3& e1,
                            const Vec3& e2,
                            const Ground_rules& rules)
{
  if (points.size() < 100)
    return false;
  std::vector<double> distance;
  for (const Index i : points) {
    const Vec3 d = scan.points[i] - center;
    distance.push_back(std::hypot(d.dot(e1), d.dot(e2)));
  }
  std::vector<double> sorted = distance;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.9 * double(sorted.size()));
  std::nth_element(sorted.begin(), at, sorted.end());
  const double radius = *at, longest = std::max(e1.norm(), e2.norm());
  const double cell = std::max(radius / rules.cells, 3 * scan.spacing * longest);
  std::vector<std::pair<long, long>> cells;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (distance[k] <= radius) {
      const Vec3 d = scan.points[points[k]] - center;
      cells.emplace_back(std::lround(d.dot(e1) / cell), std::lround(d.dot(e2) / cell));
    }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const double all = 3.14159265358979323846 * radius * radius / (cell * cell);
  return all > 12 && double(cells.size()) >= rules.filled * all;
}

/// The low points of a scan in bins of equal height, from below.
struct Low_bins
{
  double low = 0, high = 0, height = 0;    ///< nearly all points lie between `low` and `high`
  std::vector<Index> bin;                  ///< of a point; `none`: too high, or not used
  std::vector<std::vector<Index>> members; ///< points by bin

  Low_bins(const Scan& scan,
           const Vec3& up,
           const Ground_rules& rules,
           const std::vector<std::uint8_t>& is_used)
    : bin(scan.size(), none), members(static_cast<std::size_t>(rules.bins))
  {
    const Index n = static_cast<Index>(scan.size());
    std::vector<float> heights;
    for (Index i = 0; i < n; ++i)
      if (is_used[i])
        heights.push_back(static_cast<float>(up.dot(scan.points[i])));
    if (heights.empty())
      return;
    const auto quantile = [&](std::size_t k) {
      const auto at = heights.begin() + static_cast<std::ptrdiff_t>(k);
      std::nth_element(heights.begin(), at, heights.end());
      return double(*at);
    };
    low = quantile(heights.size() / 1000);
    high = quantile(heights.size() - 1 - heights.size() / 1000);
    height = std::max(rules.bin * (high - low), 4 * scan.spacing);
    for (Index i = 0; i < n; ++i) {
      const double b = (up.dot(scan.points[i]) - low) / height;
      if (is_used[i] && b < double(rules.bins)) {
        bin[i] = static_cast<Index>(std::max(0.0, b));
        members[bin[i]].push_back(i);
      }
    }
  }
};

/// What of each bin belongs to the stem of the tallest thing above the bins: followed downwards from part to part.
inline std::vector<std::vector<Index>> stem_in_bins(const Scan& scan,
                                                    const std::vector<Link>& links,
                                                    const Vec3& up,
                                                    const std::vector<std::uint8_t>& is_used,
                                                    const Low_bins& bins)
{
  const Index n = static_cast<Index>(scan.size());
  const std::size_t count = bins.members.size();
  Point_sets above(n), sets(n); // parts above all bins, and in each of them
  std::vector<Link> across;
  for (const Link& l : links) {
    const Index a = bins.bin[l.first], b = bins.bin[l.second];
    if (a == b)
      (a == none ? above : sets).unite(l.first, l.second);
    else
      across.push_back(l);
  }
  std::vector<Index> size(n, 0);
  std::vector<double> top(n, bins.low);
  for (Index i = 0; i < n; ++i)
    if (is_used[i]) {
      ++size[bins.bin[i] == none ? above.find(i) : sets.find(i)];
      if (bins.bin[i] == none)
        top[above.find(i)] = std::max(top[above.find(i)], up.dot(scan.points[i]));
    }
  Index tallest = none;
  const auto score = [&](Index i) { return double(size[i]) * (top[i] - bins.low); };
  for (Index i = 0; i < n; ++i)
    if (is_used[i] && bins.bin[i] == none &&
        (tallest == none || score(above.find(i)) > score(tallest)))
      tallest = above.find(i);
  std::vector<std::vector<Index>> stem(count);
  std::vector<std::uint8_t> is_stem(n, 0);
  for (Index i = 0; i < n && tallest != none; ++i)
    is_stem[i] = is_used[i] && bins.bin[i] == none && above.find(i) == tallest;
  for (std::size_t b = count; b-- > 0;) {
    Index part = none;
    const auto offer = [&](Index i) {
      const Index s = sets.find(i);
      if (part == none || size[s] > size[part] || (size[s] == size[part] && s < part))
        part = s;
    };
    for (const Link& l : across) {
      if (bins.bin[l.first] == b && is_stem[l.second] && bins.bin[l.second] > b)
        offer(l.first);
      if (bins.bin[l.second] == b && is_stem[l.first] && bins.bin[l.first] > b)
        offer(l.second);
    }
    if (part == none) // a gap: the thickest part
      for (const Index i : bins.members[b])
        offer(i);
    for (const Index i : bins.members[b])
      if (sets.find(i) == part) {
        stem[b].push_back(i);
        is_stem[i] = 1;
      }
  }
  return stem;
}

inline Bin_extent extent_of(const Scan& scan, const std::vector<Index>& points, const Vec3& up)
{
  Bin_extent e;
  e.count = points.size();
  for (const Index i : points)
    e.center += scan.points[i];
  if (e.count > 0)
    e.center /= double(e.count);
  double sum = 0;
  for (const Index i : points) {
    const Vec3 d = scan.points[i] - e.center;
    sum += (d - up.dot(d) * up).squaredNorm();
  }
  e.width = e.count > 0 ? std::sqrt(sum / double(e.count)) : 0;
  return e;
}

/// The height of the lowest points of a scan over a level grid, and which cells of it are ground.
class Ground_grid
{
public:
  Ground_grid(const Scan& scan,
              const Vec3& up,
              const Vec3& origin,
              double cell,
              const std::vector<std::uint8_t>& is_used)
    : m_cell_of_point(scan.size(), none)
  {
    const Vec3 e1 = up.unitOrthogonal(), e2 = up.cross(e1);
    struct Entry
    {
      Key key;
      double height;
      Index point;
      bool operator<(const Entry& e) const
      {
        return std::tie(key, height, point) < std::tie(e.key, e.height, e.point);
      }
    };
    std::vector<Entry> order;
    for (Index i = 0; i < scan.size(); ++i)
      if (is_used[i]) {
        const Vec3 d = (scan.points[i] - origin) / cell;
        order.push_back(
            {{std::floor(d.dot(e1)), std::floor(d.dot(e2))}, up.dot(scan.points[i]), i});
      }
    std::sort(order.begin(), order.end());
    for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
      for (; to < order.size() && order[to].key == order[from].key; ++to)
        m_cell_of_point[order[to].point] = static_cast<Index>(m_keys.size());
      m_keys.push_back(order[from].key);
      m_low.push_back(
          order[from + std::min<std::size_t>(2, (to - from) / 20)].height); // a few may lie below
    }
    m_rise.assign(m_keys.size(), -1);
  }

  /// Follows the ground from the cells of `seeds` as long as it rises or falls by less than `steepest` from cell to cell.
  void grow(const std::vector<Index>& seeds, double steepest)
  {
    std::vector<Index> stack;
    const auto reach = [&](Index c) {
      if (m_rise[c] >= 0)
        return;
      m_rise[c] = 0;
      stack.push_back(c);
    };
    for (const Index i : seeds)
      reach(m_cell_of_point[i]);
    while (!stack.empty()) {
      const Index c = stack.back();
      stack.pop_back();
      for (const Key& step : {Key{1, 0}, Key{-1, 0}, Key{0, 1}, Key{0, -1}}) {
        const Key key{m_keys[c][0] + step[0], m_keys[c][1] + step[1]};
        const auto at = std::lower_bound(m_keys.begin(), m_keys.end(), key);
        if (at == m_keys.end() || *at != key)
          continue;
        const Index next = static_cast<Index>(at - m_keys.begin());
        const double rise = std::abs(m_low[next] - m_low[c]);
        if (rise > steepest)
          continue;
        m_rise[c] = std::max(m_rise[c], rise);
        reach(next);
      }
    }
  }

  /// Whether a used point lies at most `thickness` above the ground of its cell, which may slope.
  bool is_ground(Index i, double height, double thickness) const
  {
    const Index c = m_cell_of_point[i];
    return m_rise[c] >= 0 && height <= m_low[c] + m_rise[c] + thickness;
  }

private:
  using Key = std::array<double, 2>; ///< integers
  std::vector<Index> m_cell_of_point;
  std::vector<Key> m_keys; ///< sorted
  std::vector<double> m_low,
      m_rise; ///< height of the lowest points; to the next ground, -1: no ground
};

} // namespace internal

/*!
  Takes ground out of `is_used`: points of the lowest bins, far from the stem, if they fill a sheet that is much wider than
  the stem above, and where this sheet goes on above the bins, on slopes. Returns their number. `links` are those between
  neighbours.
*/
inline std::size_t mark_ground(const Scan& scan,
                               const std::vector<Link>& links,
                               const Vec3& up,
                               const Ground_rules& rules,
                               std::vector<std::uint8_t>& is_used)
{
  const Index n = static_cast<Index>(scan.size());
  if (std::count(is_used.begin(), is_used.end(), 1) < 200)
    return 0;
  const internal::Low_bins bins(scan, up, rules, is_used);
  std::vector<internal::Bin_extent> extent;
  std::vector<double> widths;
  for (const auto& points : internal::stem_in_bins(scan, links, up, is_used, bins)) {
    extent.push_back(internal::extent_of(scan, points, up));
    if (extent.back().count >= 6)
      widths.push_back(extent.back().width);
  }
  if (widths.size() < 4)
    return 0;
  std::sort(widths.begin(), widths.end());
  const double stem = widths[widths.size() / 4];
  std::size_t first = 0; // the lowest bin that is the stem alone
  while (first < extent.size() && !(extent[first].count >= 6 && extent[first].width <= 1.5 * stem))
    ++first;
  if (first == extent.size())
    return 0;
  const Vec3 center = extent[first].center;
  const auto across = [&](Index i) {
    const Vec3 d = scan.points[i] - center;
    return (d - up.dot(d) * up).norm();
  };
  std::vector<Index> far;
  const double keep = rules.keep * stem + 4 * scan.spacing;
  bool is_wide = false;
  for (Index i = 0; i < n; ++i) {
    if (bins.bin[i] >= first) // `none` is the largest number
      continue;
    is_wide = is_wide || across(i) > rules.width * stem;
    if (across(i) > keep)
      far.push_back(i);
  }
  const Vec3 e1 = up.unitOrthogonal(), e2 = up.cross(e1);
  if (!is_wide || !internal::is_filled_sheet(scan, far, center, e1, e2, rules))
    return 0;
  const auto used = std::count(is_used.begin(), is_used.end(), 1);
  std::vector<Index> above;
  if (double(far.size()) > rules.most * double(used)) {
    double sum = 0;
    for (const Index i : far)
      sum += across(i) * across(i);
    const double cell =
        std::max(2 * bins.height, std::sqrt(sum / double(far.size())) / rules.cells);
    internal::Ground_grid grid(scan, up, center, cell, is_used);
    grid.grow(far, rules.steepest * cell);
    for (Index i = 0; i < n; ++i)
      if (is_used[i] && grid.is_ground(i, up.dot(scan.points[i]), bins.height) && across(i) > keep)
        above.push_back(i);
  }
  for (const std::vector<Index>* points : {&far, &above})
    for (const Index i : *points)
      is_used[i] = 0;
  return static_cast<std::size_t>(used - std::count(is_used.begin(), is_used.end(), 1));
}

namespace internal {

/// Whether a tree stands on a sheet of a deviation `spread` along it: few points, but high ones.
inline bool carries_a_tree(const Scan& scan,
                           const std::vector<Index>& points,
                           const Vec3& normal,
                           double spread,
                           const Ground_rules& rules)
{
  std::vector<double> heights;
  for (const Index i : points)
    heights.push_back(normal.dot(scan.points[i]));
  const double level = median(heights);
  for (double& h : heights)
    h = std::abs(h - level);
  const double usual = median(heights);
  const auto at =
      heights.begin() + static_cast<std::ptrdiff_t>(rules.standing * double(heights.size()));
  std::nth_element(heights.begin(), at, heights.end());
  return *at > rules.tall * spread && *at > rules.outstanding * usual;
}

} // namespace internal

/// Whether all points together are one thin filled sheet, such as ground alone, or a wall; longer ones than
/// `rules.longest` may be boards or rows of anything.
inline bool
is_one_sheet(const Scan& scan, const std::vector<std::uint8_t>& is_used, const Ground_rules& rules)
{
  std::vector<Index> points;
  Vec3 mean = Vec3::Zero();
  for (Index i = 0; i < scan.size(); ++i)
    if (is_used[i]) {
      points.push_back(i);
      mean += scan.points[i];
    }
  if (points.empty())
    return false;
  mean /= double(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Index i : points)
    covariance += (scan.points[i] - mean) * (scan.points[i] - mean).transpose();
  const auto eigen = linear_algebra::symmetric_eigen<3>(covariance / double(points.size()));
  const Vec3 spread = eigen.values.cwiseMax(0).cwiseSqrt();
  Ground_rules full = rules;
  full.filled = rules.full;
  if (!(spread(0) < rules.thin * spread(1)) || !(spread(2) < rules.longest * spread(1)))
    return false;
  if (internal::carries_a_tree(scan, points, eigen.vectors.col(0), spread(1), rules))
    return false;
  const Vec3 across = spread(2) / spread(1) * eigen.vectors.col(1), along = eigen.vectors.col(2);
  return internal::is_filled_sheet(scan, points, mean, along, across, full);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MARK_GROUND_H

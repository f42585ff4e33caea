// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Linearity of points: detection of thin wood among leaves.

#ifndef PCS_SKELETON_LEAVES_DETECT_LINEAR_POINTS_H
#define PCS_SKELETON_LEAVES_DETECT_LINEAR_POINTS_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/leaves/wood_probability.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for points on a line. Lengths are in radii of a tube along it [-].
struct Linear_point_options
{
  double radius = 1.3; ///< radius of the tube, in spacings
  float around = 2.2F; ///< outer radius of the ring around the tube
  float reach = 8;     ///< half length of the tube
  float crowd = 0.35F; ///< penalty of a point in the ring, in points of the tube
  float least = 5.5F;  ///< least score: number of pieces with points only in the tube
  int directions = 12; ///< tested at a point [count]
};

namespace internal {

/// Finds the best line through one point.
class Line_search
{
public:
  static constexpr int number_of_pieces = 10;

  Line_search(const Scan& scan,
              const std::vector<std::uint8_t>& is_used,
              const Linear_point_options& rules)
    : m_scan(scan), m_is_used(is_used), m_rules(rules)
  {
  }

  /// Returns the score of the best line through a point.
  float operator()(Index i)
  {
    gather(i);
    m_far.clear();
    for (std::size_t k = 0; k < m_x.size(); ++k)
      if (m_square[k] > nearest_target * nearest_target)
        m_far.push_back(k);
    const std::size_t step =
        std::max<std::size_t>(1, m_far.size() / static_cast<std::size_t>(m_rules.directions));
    float best = -float(number_of_pieces);
    for (std::size_t f = 0; f < m_far.size(); f += step) {
      const std::size_t k = m_far[f];
      const float length = std::sqrt(m_square[k]);
      const std::array<float, 3> along = {m_x[k] / length, m_y[k] / length, m_z[k] / length};
      project(along);
      const float found = score();
      if (found > best) {
        best = found;
        m_best = along;
        m_is_good = m_is_line;
      }
    }
    return best;
  }

  /// Returns the surroundings of the last tested point. `score` is the score of this point. Lengths
  /// are in radii of the tube.
  Surroundings surroundings(float score) const
  {
    Surroundings result;
    result.line = double(score);
    auto& spread = result.spread;
    spread[0].add(Vec3::Zero()); // the point
    for (std::size_t k = 0; k < m_x.size(); ++k) {
      const auto shell = std::find_if(squared_reaches.begin(), squared_reaches.end(), [&](float r) {
        return m_square[k] <= r * m_rules.reach * m_rules.reach;
      });
      spread[static_cast<std::size_t>(shell - squared_reaches.begin())].add(
          Vec3(double(m_x[k]), double(m_y[k]), double(m_z[k])));
    }
    for (std::size_t s = 1; s < spread.size(); ++s)
      spread[s].add(spread[s - 1]);
    return result;
  }

  /// Calls `visit` for the points of the last best line in pieces with a positive score.
  template <class Visit>
  void visit_line(const Visit& visit)
  {
    project(m_best);
    for (std::size_t k = 0; k < m_x.size(); ++k)
      if (m_off[k] <= 1 && m_is_good[piece_of(m_at[k])])
        visit(m_index[k]);
  }

private:
  void gather(Index i)
  {
    const double unit = m_rules.radius * m_scan.spacing;
    const Vec3& p = m_scan.points[i];
    m_near.clear();
    m_scan.search->append_within(p, double(m_rules.reach) * unit, m_near);
    m_index.clear();
    m_x.clear();
    m_y.clear();
    m_z.clear();
    for (const Index j : m_near)
      if (j != i && m_is_used[j]) {
        const Vec3 d = (m_scan.points[j] - p) / unit;
        m_index.push_back(j);
        m_x.push_back(float(d.x()));
        m_y.push_back(float(d.y()));
        m_z.push_back(float(d.z()));
      }
    const std::size_t n = m_x.size();
    m_square.resize(n);
    m_at.resize(n);
    m_off.resize(n);
    for (std::size_t k = 0; k < n; ++k)
      m_square[k] = m_x[k] * m_x[k] + m_y[k] * m_y[k] + m_z[k] * m_z[k];
  }

  /// Computes the positions along a line, and the squared distances from it.
  void project(const std::array<float, 3>& along)
  {
    const std::size_t n = m_x.size();
    for (std::size_t k = 0; k < n; ++k) {
      m_at[k] = m_x[k] * along[0] + m_y[k] * along[1] + m_z[k] * along[2];
      m_off[k] = m_square[k] - m_at[k] * m_at[k];
    }
  }

  std::size_t piece_of(float at) const
  {
    const float place = (at + m_rules.reach) / (2 * m_rules.reach) * float(number_of_pieces);
    return static_cast<std::size_t>(
        std::min(float(number_of_pieces - 1), std::max(0.0F, std::floor(place))));
  }

  float score()
  {
    // an empty piece is a gap; a piece with points only beside the line is evidence against it
    constexpr float empty = -0.2F, beside = -0.5F;
    std::array<float, number_of_pieces> in{}, out{};
    const float widest = m_rules.around * m_rules.around;
    for (std::size_t k = 0; k < m_x.size(); ++k)
      if (m_off[k] <= widest)
        (m_off[k] <= 1 ? in : out)[piece_of(m_at[k])] += 1;
    float sum = 0;
    for (std::size_t b = 0; b < in.size(); ++b) {
      const float value = in[b] > 0    ? std::max(-1.0F, 1 - m_rules.crowd * out[b] / in[b])
                          : out[b] > 0 ? beside
                                       : empty;
      m_is_line[b] = value > 0;
      sum += value;
    }
    return sum;
  }

  static constexpr float nearest_target = 2; ///< least distance of a target point
  /// Squared radii of all surroundings but the last, as fractions of the squared reach.
  static constexpr std::array<float, Surroundings::number_of_spreads - 1> squared_reaches = {
      0.0832F,
      0.333F};

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  const Linear_point_options& m_rules;
  std::vector<Index> m_near, m_index;
  std::vector<float> m_x, m_y, m_z, m_square; ///< relative to the point, in radii of the tube
  std::vector<float> m_at, m_off;
  std::vector<std::size_t> m_far;
  std::array<float, 3> m_best{};
  std::array<std::uint8_t, number_of_pieces> m_is_line{}, m_is_good{};
};

} // namespace internal

struct Ignore_line_search
{
  void operator()(std::size_t, const internal::Line_search&, float) const {}
};

/*!
  Marks the points on lines. Tests tubes in several directions around used points that are not yet
  `is_sure`. A tube is a line if most of its pieces have points and the ring around them has few;
  then its points are marked. In leaves, a tube is as dense as its surroundings. Calls `visit(i,
  search, score)` for each tested point, in any order and from any thread. O(open points *
  neighbours in reach * directions).
*/
template <class ConcurrencyTag, class Visit = Ignore_line_search>
std::vector<std::uint8_t> points_on_lines(const Scan& scan,
                                          const std::vector<std::uint8_t>& is_used,
                                          const std::vector<std::uint8_t>& is_sure,
                                          const Linear_point_options& rules,
                                          const Visit& visit = {})
{
  std::vector<std::atomic<std::uint8_t>> is_marked(scan.size());
  pcs::internal::for_each_block<ConcurrencyTag>(
      scan.size(),
      256,
      [&](std::size_t begin, std::size_t end) {
        internal::Line_search line(scan, is_used, rules);
        for (std::size_t i = begin; i < end; ++i) {
          if (!is_used[i] || is_sure[i])
            continue;
          const float score = line(static_cast<Index>(i));
          visit(i, line, score);
          if (score < rules.least)
            continue;
          // the order of writes does not matter: all write the same
          is_marked[i].store(1, std::memory_order_relaxed);
          line.visit_line([&](Index j) { is_marked[j].store(1, std::memory_order_relaxed); });
        }
      });
  std::vector<std::uint8_t> result(scan.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = is_marked[i].load(std::memory_order_relaxed);
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_DETECT_LINEAR_POINTS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fusion of collinear axes that are pieces of one branch.

#ifndef PCS_SKELETON_BRANCHING_FUSE_AXES_H
#define PCS_SKELETON_BRANCHING_FUSE_AXES_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for two ends of one branch. Lengths are in spacings unless stated otherwise [-].
struct Fusion_options
{
  double limit = 8;  ///< largest cost, a sum of squares of unit variance; 0: no axes are fused
  double reach = 24; ///< widest gap ...
  double length_share = 1;    ///< ... and in lengths of the longer piece [-]
  double end_length = 10;     ///< length from which the direction of an end is computed
  double end_radii = 4;       ///< ... and in radii [-]
  double offset = 0.7;        ///< standard deviation of an end from its fitted line
  double direction = 0.12;    ///< standard deviation of the direction of a long piece [rad]
  double raggedness = 1;      ///< product of this deviation and the length, for a short piece
  double bend = 0.25;         ///< standard deviation of the angle between two ends [rad]
  double radius = 0.35;       ///< standard deviation of the radius, in radii [-] ...
  double radius_offset = 0.2; ///< ... and in spacings
  double gap = 10;            ///< standard deviation of the gap
  double against = 3;         ///< cost of joining two bases or two tips [-]
  double inside = 0.5;        ///< least distance of a gap from a third axis, in its radii [-]
};

namespace internal {

/// One end of an axis, with its outward direction.
struct Loose_end
{
  Vec3 point, outward;
  double radius = 0, angle_error = 0, length = 0;
};

inline Loose_end
loose_end(const Axis& axis, bool is_tip, double spacing, const Fusion_options& rules)
{
  const std::size_t n = axis.size();
  const auto node = [&](std::size_t k) -> const Axis_node& { return axis[is_tip ? n - 1 - k : k]; };
  const double wanted = rules.end_length * spacing + rules.end_radii * node(0).radius;
  Loose_end end;
  end.point = node(0).point;
  double gone = 0, radius = 0;
  std::size_t k = 1;
  // line through the segments, weighted by their lengths
  Vec3 mean = Vec3::Zero(), moment = Vec3::Zero();
  double weight = 0;
  for (; k < n && (gone < wanted || k < 2); ++k) {
    const Vec3 step = node(k).point - node(k - 1).point;
    const double l = step.norm();
    const Vec3 middle = node(k - 1).point + 0.5 * step - end.point;
    const double at = gone + 0.5 * l;
    mean += l * middle;
    moment += l * at * middle;
    weight += l;
    radius += l * 0.5 * (node(k).radius + node(k - 1).radius);
    moment += l * l * l / 12 * (l > 0 ? Vec3(step / l) : Vec3(Vec3::Zero()));
    gone += l;
  }
  end.length = gone;
  if (!(weight > 0)) {
    end.outward = Vec3::UnitZ();
    return end;
  }
  end.radius = radius / weight;
  const double middle = 0.5 * gone; // mean of `at`
  const Vec3 slope = moment - middle * mean;
  const double norm = slope.norm();
  end.outward = norm > 0 ? Vec3(-slope / norm) : Vec3(Vec3::UnitZ());
  end.angle_error = rules.direction + rules.raggedness * spacing / std::max(gone, spacing);
  return end;
}

class Axis_fuser
{
public:
  Axis_fuser(const Axis_set& set, double spacing, const Fusion_options& rules)
    : m_set(set), m_spacing(spacing), m_rules(rules), m_size(set.axes.size())
  {
    for (const Fitted_axis& a : set.axes) {
      m_length.push_back(length_of(a.axis));
      for (const bool is_tip : {false, true})
        m_ends.push_back(loose_end(a.axis, is_tip, spacing, rules));
    }
    for (Index a = 0; a < m_size; ++a)
      for (Index k = 0; k < set.axes[a].axis.size(); ++k) {
        m_nodes.push_back(set.axes[a].axis[k].point);
        m_place_of_node.emplace_back(a, k);
        m_thickest = std::max(m_thickest, set.axes[a].axis[k].radius);
      }
  }

  /// Returns for every end (two per axis, the base first) the end with which it is paired, or
  /// `none` for a free end.
  template <class ConcurrencyTag>
  std::vector<Index> partners() const
  {
    struct Pair
    {
      double cost;
      Index first, second;
    };
    std::vector<Vec3> places;
    for (const Loose_end& e : m_ends)
      places.push_back(e.point);
    const neighborhood::Nearest_neighbors near_ends(places), near_nodes(m_nodes);
    std::vector<std::vector<Pair>> found(m_ends.size());
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_ends.size(),
        [&](std::size_t i) {
          std::vector<Index> near;
          near_ends.within(places[i], m_rules.reach * m_spacing, near);
          for (const Index j : near) {
            if (j <= i || j / 2 == i / 2)
              continue;
            const double c = cost(static_cast<Index>(i), j);
            if (c < m_rules.limit && !is_through_wood(static_cast<Index>(i), j, near_nodes))
              found[i].push_back({c, static_cast<Index>(i), j});
          }
        },
        16);
    std::vector<Pair> pairs;
    for (const auto& f : found)
      pairs.insert(pairs.end(), f.begin(), f.end());
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
      return x.cost < y.cost;
    });
    std::vector<Index> partner(m_ends.size(), none), chain(m_size);
    for (Index a = 0; a < m_size; ++a)
      chain[a] = a;
    const auto find = [&](Index a) {
      while (chain[a] != a)
        a = chain[a] = chain[chain[a]];
      return a;
    };
    for (const Pair& p : pairs) {
      if (partner[p.first] != none || partner[p.second] != none ||
          find(p.first / 2) == find(p.second / 2))
        continue;
      partner[p.first] = p.second;
      partner[p.second] = p.first;
      chain[find(p.first / 2)] = find(p.second / 2);
    }
    return partner;
  }

private:
  double cost(Index i, Index j) const
  {
    const Loose_end &a = m_ends[i], &b = m_ends[j];
    const double u = m_spacing;
    const Vec3 g = b.point - a.point;
    const double ahead = g.dot(a.outward), behind = -g.dot(b.outward);
    const double thickest = std::max(a.radius, b.radius), overlap = 2 * u + thickest;
    if (ahead < -overlap || behind < -overlap ||
        g.norm() > m_rules.length_share * std::max(m_length[i / 2], m_length[j / 2]))
      return m_rules.limit;
    const double cosine = -a.outward.dot(b.outward);
    if (cosine < 0.5)
      return m_rules.limit;
    const auto squared = [](double x) { return x * x; };
    const double offset = m_rules.offset * u + 0.25 * thickest;
    double sum = i % 2 == j % 2 ? m_rules.against : 0;
    sum += squared((g - ahead * a.outward).norm()) /
           (squared(offset) + squared(ahead * a.angle_error));
    sum += squared((g - behind * -b.outward).norm()) /
           (squared(offset) + squared(behind * b.angle_error));
    sum += squared(std::acos(std::min(1.0, cosine))) /
           (squared(m_rules.bend) + squared(a.angle_error) + squared(b.angle_error));
    sum += squared((a.radius - b.radius) / (m_rules.radius * thickest + m_rules.radius_offset * u));
    sum += squared(g.norm() / (m_rules.gap * u));
    return sum;
  }

  /// Returns whether the straight line between two ends passes through the interior of another
  /// axis.
  bool is_through_wood(Index i, Index j, const neighborhood::Nearest_neighbors& near_nodes) const
  {
    const Vec3 a = m_ends[i].point, g = m_ends[j].point - a;
    const double length = g.norm(), radius = std::max(m_ends[i].radius, m_ends[j].radius);
    std::vector<Index> near;
    near_nodes.within(a + 0.5 * g, 0.5 * length + m_thickest + 8 * m_spacing, near);
    for (const Index k : near) {
      const auto [c, node] = m_place_of_node[k];
      if (c == i / 2 || c == j / 2)
        continue;
      const Axis& axis = m_set.axes[c].axis;
      if (axis[node].radius < 1.5 * radius || axis[node].radius < m_spacing)
        continue;
      for (int step = 1; step < 6; ++step) {
        const Vec3 p = a + g * (step / 6.0);
        const Axis_place place = nearest_place(axis, node, p);
        if (place.share >= 0 && place.share <= 1 &&
            place.distance < m_rules.inside * radius_at(axis, place))
          return true;
      }
    }
    return false;
  }

  const Axis_set& m_set;
  double m_spacing, m_thickest = 0;
  Fusion_options m_rules;
  std::size_t m_size;
  std::vector<double> m_length;
  std::vector<Loose_end> m_ends;
  std::vector<Vec3> m_nodes;
  std::vector<std::pair<Index, Index>> m_place_of_node;
};

/// The position of a previous axis on its fused axis.
struct Fused_piece
{
  Index axis = none;        ///< the new axis
  Index first = 0;          ///< index of its first segment there
  bool is_reversed = false; ///< whether its direction is reversed there
};

/// Returns the pieces that are fused with axis `a`, each given by its first end. Their order is the
/// direction of most of their length. `forward` is the length of the pieces that are traversed from
/// base to tip when starting at a free end; `total` is the length of all pieces.
inline std::vector<Index> row_of_pieces(const Axis_set& set,
                                        const std::vector<Index>& partner,
                                        Index a,
                                        double& forward,
                                        double& total)
{
  Index start = 2 * a;
  while (partner[start] != none) // back to a free end
    start = partner[start] ^ 1u;
  std::vector<Index> entries;
  forward = total = 0;
  for (Index e = start; e != none; e = partner[e ^ 1u]) {
    entries.push_back(e);
    const double length = length_of(set.axes[e / 2].axis);
    forward += e % 2 == 0 ? length : 0;
    total += length;
  }
  if (2 * forward < total) {
    std::reverse(entries.begin(), entries.end());
    for (Index& e : entries)
      e ^= 1u;
  }
  return entries;
}

/// Concatenates the pieces to the axis with index `number`, and records their positions.
inline Fitted_axis fuse_pieces(const std::vector<Index>& entries,
                               Index number,
                               Axis_set& set,
                               std::vector<Fused_piece>& pieces)
{
  Fitted_axis row;
  row.parent = set.axes[entries.front() / 2].parent;
  bool is_reversed = false; // whether the previous piece is
  for (const Index e : entries) {
    Fitted_axis& piece = set.axes[e / 2];
    pieces[e / 2] = {number, static_cast<Index>(row.axis.size()), e % 2 == 1};
    if (e % 2 == 1) {
      std::reverse(piece.axis.begin(), piece.axis.end());
      piece.meeting = piece.meeting > 0 ? piece.axis.size() - piece.meeting : 0;
    }
    if (piece.meeting > 0)
      row.meeting = row.axis.size() + piece.meeting;
    else if (is_reversed && e % 2 == 0)
      row.meeting = row.axis.size();
    is_reversed = e % 2 == 1;
    row.axis.insert(row.axis.end(), piece.axis.begin(), piece.axis.end());
    row.number_of_points += piece.number_of_points;
  }
  return row;
}

/// Reassigns the points of all axes to the fused axes.
inline void move_points(const std::vector<Fused_piece>& pieces, Axis_set& set)
{
  const std::size_t n = set.axes.size();
  std::vector<Index> last_segment(n);
  for (Index a = 0; a < n; ++a)
    last_segment[a] = static_cast<Index>(set.axes[a].axis.size() - 2);
  for (std::size_t i = 0; i < set.axis_of_point.size(); ++i) {
    const Index a = set.axis_of_point[i];
    if (a == none)
      continue;
    Index& s = set.segment_of_point[i];
    s = pieces[a].first +
        (pieces[a].is_reversed ? last_segment[a] - std::min(s, last_segment[a]) : s);
    set.axis_of_point[i] = pieces[a].axis;
  }
}

} // namespace internal

/*!
  Fuses axes that continue each other. Pairs their ends in ascending order of cost. The cost depends
  on the distance of each end from the line of the other, on the bend, on the change of the radius,
  and on the gap. Returns by how much the number of axes decreased. O(axes log axes).
*/
template <class ConcurrencyTag>
std::size_t fuse_axes(double spacing, const Fusion_options& options, Axis_set& set)
{
  const std::size_t n = set.axes.size();
  if (n < 2 || !(options.limit > 0))
    return 0;
  const std::vector<Index> partner =
      internal::Axis_fuser(set, spacing, options).partners<ConcurrencyTag>();
  std::vector<internal::Fused_piece> pieces(n);
  std::vector<Fitted_axis> fused;
  for (Index a = 0; a < n; ++a) {
    if (pieces[a].axis != none)
      continue;
    double forward, total;
    const std::vector<Index> entries = internal::row_of_pieces(set, partner, a, forward, total);
    fused.push_back(internal::fuse_pieces(entries, static_cast<Index>(fused.size()), set, pieces));
    fused.back().direction = total > 0 ? std::abs(2 * forward / total - 1) : 1;
  }
  internal::move_points(pieces, set);
  for (Index k = 0; k < fused.size(); ++k)
    if (fused[k].parent != none) {
      const Index parent = pieces[fused[k].parent].axis;
      fused[k].parent = parent != k ? parent : none; // the parent was a piece of the same axis
    }
  const std::size_t fewer = n - fused.size();
  set.axes = std::move(fused);
  return fewer;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_FUSE_AXES_H

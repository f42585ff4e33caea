// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trunk base with buttresses and root flare: cross-sections from their outlines.

#ifndef PCS_SKELETON_RADII_REBUILD_TRUNK_BASE_H
#define PCS_SKELETON_RADII_REBUILD_TRUNK_BASE_H

#include <pcs/internal/constants.h>
#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/radii/bound_radii.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options for the reconstruction of the trunk base.
struct Trunk_base_options
{
  double sound = 8;      ///< trunk length that defines the direction of the foot, in radii [-] ...
  double proven = 0.8;   ///< ... and least fraction of this length with point support [-]
  double shortest = 2;   ///< height below which a foot remains unchanged, in radii [-]
  double highest = 0.25; ///< largest height of a foot, as a fraction of the tree height [-]
  double steep = 0.7;    ///< least rise per length of the trunk above [-]
  double reach = 2.5;    ///< largest distance of points of the foot, in radii [-]
  double slab = 0.25;    ///< half thickness of a section, in radii ...
  double slab_spacings = 2; ///< ... and in spacings, whichever is larger [-]
  int sectors = 8;          ///< least number of sectors, of 24, with points [count]
  //! fraction of the points of the foot on fitted sections, above which these are kept [-]
  double explained = 0.7;
};

namespace internal {

/// The outline of a section, as distances from its centre by sector.
class Outline
{
public:
  static constexpr std::size_t number_of_sectors = 24;

  void add(double x, double y)
  {
    const double turn = std::atan2(y, x) / (2 * pcs::internal::pi) + 0.5;
    const std::size_t s = static_cast<std::size_t>(turn * double(number_of_sectors));
    m_distances[s % number_of_sectors].push_back(std::hypot(x, y));
  }
  int number_of_seen_sectors() const
  {
    return static_cast<int>(std::count_if(m_distances.begin(),
                                          m_distances.end(),
                                          [](const auto& d) { return !d.empty(); }));
  }
  /// Returns the radius of the circle with the area of the outline. Empty sectors are interpolated
  /// between their neighbours. Requires at least one point.
  double radius()
  {
    constexpr std::size_t n = number_of_sectors;
    std::array<double, n> middle{};
    for (std::size_t s = 0; s < n; ++s)
      middle[s] = pcs::internal::lower_median(m_distances[s]);
    double sum = 0;
    for (std::size_t s = 0; s < n; ++s) {
      std::size_t left = 0, right = 0;
      while (!(middle[(s + n - left) % n] > 0) && left < n)
        ++left;
      while (!(middle[(s + right) % n] > 0) && right < n)
        ++right;
      const double a = middle[(s + n - left) % n], b = middle[(s + right) % n];
      const double r =
          left + right > 0 ? (a * double(right) + b * double(left)) / double(left + right) : a;
      sum += r * r;
    }
    return std::sqrt(sum / double(n));
  }

private:
  std::array<std::vector<double>, number_of_sectors> m_distances;
};

/// Returns the first node of the trunk above which points support the cross-sections, or the number
/// of nodes if there is none.
inline std::size_t first_sound_node(const Branch_tree& tree,
                                    const Section_support& support,
                                    double density,
                                    const Support_options& proof,
                                    const Trunk_base_options& rules)
{
  const std::vector<Index>& nodes = tree.branches[0].nodes;
  const Branch_support sections(support, tree.branches[0], tree, density, proof);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (!sections.is_proven[k] || !tree.nodes[nodes[k]].is_measured)
      continue;
    double length = 0, proven = 0;
    const double wanted = rules.sound * tree.nodes[nodes[k]].radius;
    for (std::size_t j = k + 1; j < nodes.size() && length < wanted; ++j) {
      const double step = (tree.nodes[nodes[j]].point - tree.nodes[nodes[j - 1]].point).norm();
      length += step;
      proven += sections.is_proven[j] ? step : 0;
    }
    if (length >= wanted && proven >= rules.proven * length)
      return k;
  }
  return nodes.size();
}

/// Returns the fraction of `points` on the sections fitted to the trunk below node `end` [-].
inline double explained_share(const Scan& scan,
                              const std::vector<Index>& points,
                              const Branch_tree& tree,
                              std::size_t end)
{
  constexpr double tolerance = 0.15; // in radii [-]
  const std::vector<Index>& nodes = tree.branches[0].nodes;
  Axis axis;
  for (std::size_t k = 0; k <= end; ++k) {
    const Branch_node& node = tree.nodes[nodes[k]];
    axis.push_back({node.point, node.radius, node.radius_error, node.is_measured});
  }
  std::size_t count = 0;
  for (const Index i : points) {
    const Axis_place place = nearest_place(axis, scan.points[i]);
    const double radius = radius_at(axis, place);
    count += std::abs(place.distance - radius) <= tolerance * radius;
  }
  return points.empty() ? 0 : double(count) / double(points.size());
}

} // namespace internal

/*!
  Rebuilds the trunk below the lowest part with supported round cross-sections, since fits farther
  below follow single buttresses. The axis is extended straight downwards. The radii are those of
  circles with the area of the outline around the axis. If most points of the foot lie on the
  fitted sections, these are kept, since the trunk is bent but round. z points upwards. Returns the
  number of moved nodes. O(points + nodes).
*/
inline std::size_t rebuild_trunk_base(const Scan& scan,
                                      const std::vector<std::uint8_t>& is_used,
                                      const Section_support& support,
                                      double density,
                                      const Support_options& proof,
                                      const Trunk_base_options& rules,
                                      Branch_tree& tree)
{
  if (tree.nodes.empty())
    return 0;
  const std::vector<Index>& nodes = tree.branches[0].nodes;
  const std::size_t sound = internal::first_sound_node(tree, support, density, proof, rules);
  if (sound == nodes.size())
    return 0;
  const Branch_node first = tree.nodes[nodes[sound]];
  std::size_t last = sound;
  while (last + 1 < nodes.size() &&
         (tree.nodes[nodes[last]].point - first.point).norm() < rules.sound * first.radius)
    ++last;
  const Vec3 along = (tree.nodes[nodes[last]].point - first.point).normalized();
  const double foot = tree.nodes[nodes[0]].point.z(), rise = first.point.z() - foot;
  double top = foot;
  for (const Branch_node& node : tree.nodes)
    top = std::max(top, node.point.z());
  if (rise < rules.shortest * first.radius || rise > rules.highest * (top - foot) ||
      along.z() < rules.steep)
    return 0;
  const Vec3 e1 = along.unitOrthogonal(), e2 = along.cross(e1);
  const double half = std::max(rules.slab * first.radius, rules.slab_spacings * scan.spacing);
  const double reach = rules.reach * first.radius;
  std::vector<Index> near; // points of the foot
  for (Index i = 0; i < scan.size(); ++i) {
    const Vec3 d = scan.points[i] - first.point;
    const double t = d.dot(along);
    if (is_used[i] && t < half && (d - t * along).squaredNorm() < reach * reach)
      near.push_back(i);
  }
  if (internal::explained_share(scan, near, tree, sound) >= rules.explained)
    return 0; // a round trunk that bends
  for (std::size_t k = 0; k < sound; ++k) {
    Branch_node& node = tree.nodes[nodes[k]];
    const double below = std::min(0.0, node.point.z() - first.point.z()) / along.z();
    internal::Outline outline;
    for (const Index i : near) {
      const Vec3 d = scan.points[i] - first.point;
      if (std::abs(d.dot(along) - below) < half)
        outline.add(d.dot(e1), d.dot(e2));
    }
    node.point = first.point + below * along;
    node.is_measured = outline.number_of_seen_sectors() >= rules.sectors;
    node.radius = node.is_measured ? outline.radius() : first.radius;
    node.radius_error = node.is_measured ? proof.proof_error * node.radius : node.radius;
  }
  for (Branch& branch : tree.branches) { // child branches move with the axis
    Branch_node& base = tree.nodes[branch.nodes.front()];
    if (base.parent != none && tree.nodes[base.parent].branch == 0)
      base.point = tree.nodes[base.parent].point;
  }
  return sound;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_REBUILD_TRUNK_BASE_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of two scans of a virtual tree at two ages: compares the branches and the wood of
// corresponding points.

#ifndef PCS_TEST_SUPPORT_MATERIAL_PLACES_H
#define PCS_TEST_SUPPORT_MATERIAL_PLACES_H

#include <pcs/Orl_shape_space.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_at_age.h>
#include <support/orl_trees.h>

#include <map>

namespace orl_test {

/// Points on wood, with the nodes at which they were measured.
struct Labelled_scan
{
  std::vector<Point> points;
  std::vector<std::size_t> node;
};

inline Labelled_scan scan_wood(const Tree& tree, int seed, double coarser)
{
  pcs::Virtual_scanner scanner;
  scanner.angular_step *= coarser;
  pcs::Virtual_scan<Kernel> all;
  pcs::scan_tree(tree, all, scanner, pcs::parameters::random_seed(seed));
  Labelled_scan result;
  for (std::size_t i = 0; i < all.points.size(); ++i)
    if (all.node[i] >= 0) {
      result.points.push_back(all.points[i]);
      result.node.push_back(static_cast<std::size_t>(all.node[i]));
    }
  return result;
}

/// Positions along the axes of branches.
class Branch_places
{
public:
  explicit Branch_places(const Tree& tree)
    : m_tree(tree),
      m_arc(num_vertices(tree), 0),
      m_length(num_vertices(tree), 0),
      m_next(num_vertices(tree), pcs::npos),
      m_previous(num_vertices(tree), pcs::npos)
  {
    for (const auto& nodes : pcs::nodes_by_branch<Kernel>(tree)) {
      double arc = 0;
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        if (k > 0) {
          arc += (at(nodes[k]) - at(nodes[k - 1])).norm();
          m_next[nodes[k - 1]] = nodes[k];
          m_previous[nodes[k]] = nodes[k - 1];
        }
        m_arc[nodes[k]] = arc;
      }
      for (const std::size_t v : nodes)
        m_length[v] = arc;
    }
  }

  /// Distance along the axis from the base of the branch, of a point measured at node `v`. [L]
  double arc(std::size_t v, const Point& p) const
  {
    double best = m_arc[v], least = (to_eigen(p) - at(v)).norm();
    for (const auto& [a, b] : {std::make_pair(m_previous[v], v), std::make_pair(v, m_next[v])})
      if (a != pcs::npos && b != pcs::npos && at(a) != at(b)) {
        const Vec3 axis = at(b) - at(a);
        const double t = std::clamp((to_eigen(p) - at(a)).dot(axis) / axis.squaredNorm(), 0., 1.);
        const double d = (to_eigen(p) - at(a) - t * axis).norm();
        if (d < least) {
          least = d;
          best = m_arc[a] + t * axis.norm();
        }
      }
    return best;
  }
  /// of the branch of a node [L]
  double length(std::size_t v) const { return m_length[v]; }

private:
  Vec3 at(std::size_t v) const { return to_eigen(m_tree[v].point); }

  const Tree& m_tree;
  std::vector<double> m_arc, m_length;
  std::vector<std::size_t> m_next, m_previous;
};

/// Fractions of the points of the young tree. Its wood keeps its position, so the true position is
/// the distance from the base of the branch. For uniform stretching, the fraction of the length
/// would be preserved instead.
struct Material_accuracy
{
  std::size_t number_of_points = 0;
  double right_branch = 0; ///< [-]
  double same_wood =
      0; ///< on the correct branch, and at most one radius along it from the same wood [-]
  double attainable =
      0; ///< the old tree has a point there; the point spacing may exceed twig radii [-]
  double same_share = 0; ///< same, at equal fractions of the length [-]
  double mean_radii =
      0; ///< mean distance along the correct branch from the same wood, in radii [-]
  double seconds = 0;
};

template <class NamedParameters>
Material_accuracy
measure_ages(const Tree& old_tree, double age, int seed, double coarser, const NamedParameters& np)
{
  std::vector<std::size_t> old_nodes;
  const Tree young_tree = pcs::tree_at_age(old_tree, age, old_nodes);
  const Labelled_scan one = scan_wood(young_tree, 2 * seed, coarser),
                      two = scan_wood(old_tree, 2 * seed + 1, coarser);
  pcs::Orl_shape_space<Kernel> space;
  space.add(young_tree, one.points);
  space.add(old_tree, two.points);
  Material_accuracy result;
  result.seconds = space.build(np).seconds.total();
  const Branch_places places_1(young_tree), places_2(old_tree);
  const auto& branches_1 = young_tree[boost::graph_bundle].branches;
  const auto& branches_2 = old_tree[boost::graph_bundle].branches;
  // Each point has one or more partners; the first one is used.
  std::vector<std::size_t> partner(one.points.size(), pcs::npos);
  for (const auto& pair : space.correspondences().pairs)
    if (pair.point[0] != pcs::Orl_correspondences::no_point &&
        pair.point[1] != pcs::Orl_correspondences::no_point && partner[pair.point[0]] == pcs::npos)
      partner[pair.point[0]] = pair.point[1];
  result.number_of_points = partner.size();
  std::map<std::size_t, std::vector<double>>
      seen; // positions of the points of the old tree, by branch
  for (std::size_t j = 0; j < two.points.size(); ++j)
    seen[branches_2[old_tree[two.node[j]].branch].id].push_back(
        places_2.arc(two.node[j], two.points[j]));
  for (auto& arcs : seen)
    std::sort(arcs.second.begin(), arcs.second.end());
  double off_sum = 0;
  for (std::size_t i = 0; i < partner.size(); ++i) {
    const std::size_t a = one.node[i];
    const double arc_1 = places_1.arc(a, one.points[i]);
    if (const std::size_t old_node = old_nodes[a]; old_node != pcs::npos) {
      const double r = old_tree[old_node].radius;
      const std::vector<double>& arcs = seen[branches_1[young_tree[a].branch].id];
      const auto it = std::lower_bound(arcs.begin(), arcs.end(), arc_1 - r);
      result.attainable += it != arcs.end() && *it <= arc_1 + r ? 1 : 0;
    } else
      result.attainable += 1; // a growing tip, whose radius in the old tree is unknown
    if (partner[i] == pcs::npos)
      continue;
    const std::size_t b = two.node[partner[i]];
    if (branches_1[young_tree[a].branch].id != branches_2[old_tree[b].branch].id)
      continue;
    result.right_branch += 1;
    const double arc_2 = places_2.arc(b, two.points[partner[i]]);
    // Old radius at the position of the wood: of the node of the old tree, or of the partner's
    // node.
    const double radius = old_tree[old_nodes[a] != pcs::npos ? old_nodes[a] : b].radius;
    const double share = places_1.length(a) > 0 ? arc_1 / places_1.length(a) : 0;
    result.same_wood += std::abs(arc_1 - arc_2) <= radius ? 1 : 0;
    result.same_share += std::abs(share * places_2.length(b) - arc_2) <= radius ? 1 : 0;
    off_sum += std::abs(arc_1 - arc_2) / radius;
  }
  const auto n = static_cast<double>(partner.size());
  result.mean_radii = result.right_branch > 0 ? off_sum / result.right_branch : 0;
  result.right_branch /= n;
  result.same_wood /= n;
  result.attainable /= n;
  result.same_share /= n;
  return result;
}

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_MATERIAL_PLACES_H

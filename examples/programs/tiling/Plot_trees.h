// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Identifies the trees of tiles with the trees of a plot by their feet.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_PLOT_TREES_H
#define PCS_EXAMPLES_PROGRAMS_TILING_PLOT_TREES_H

#include "tiling/Tile_manifest.h"
#include "tiling/Tile_result.h"
#include "tiling/horizontal.h"
#include <pcs/IO/points/Point_table.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace program {

/// A tree of a plot: a tree of the tile whose core holds its foot.
struct Plot_tree
{
  std::size_t tile = 0, tree_of_tile = 0;
  std::array<double, 3> foot{};
  double radius = 0, diameter_at_breast_height = 0; ///< [L]
  bool is_at_rim = false;                           ///< in its own tile
  std::size_t number_of_parts = 0;                  ///< tiles whose cores have points of it
  std::size_t number_of_cut_parts = 0; ///< of them, other tiles in which it is at the rim
};

/*!
  A tree of a tile whose foot is in another core is the tree of that tile with the nearest foot, by
  horizontal distance. Without such a foot within the tolerance it is unmatched. The trees are in
  descending order of radius, and of equal radius in the order of their feet, so they do not depend
  on the order of the tiles.
*/
class Plot_trees
{
public:
  using Results = std::vector<std::optional<Tile_result>>; ///< by tile; empty: missing
  /// No tree of the plot.
  static constexpr std::int32_t no_tree = -1;

  /// `tolerance`: largest distance of feet of the same tree [L].
  Plot_trees(const Tile_manifest& manifest, const Results& results, double tolerance)
    : m_axis_up(manifest.axis_up()), m_tree_of(results.size())
  {
    std::vector<std::vector<std::size_t>> owner(results.size()); // by tile and tree of the tile
    for (std::size_t t = 0; t < results.size(); ++t) {
      if (!results[t])
        continue;
      for (std::size_t k = 0; k < results[t]->trees.size(); ++k) {
        const Tree_of_tile& tree = results[t]->trees[k];
        owner[t].push_back(manifest.owner_of(position(tree.foot)));
        if (owner[t].back() == t)
          m_trees.push_back(
              {t, k, tree.foot, tree.radius, tree.diameter_at_breast_height, tree.is_at_rim});
      }
      m_tree_of[t].assign(results[t]->trees.size(), no_tree);
    }
    std::sort(m_trees.begin(), m_trees.end(), [](const Plot_tree& a, const Plot_tree& b) {
      return std::tie(b.radius, a.foot, a.tile, a.tree_of_tile) <
             std::tie(a.radius, b.foot, b.tile, b.tree_of_tile);
    });
    std::vector<std::vector<std::size_t>> own(results.size());
    for (std::size_t p = 0; p < m_trees.size(); ++p) {
      own[m_trees[p].tile].push_back(p);
      m_tree_of[m_trees[p].tile][m_trees[p].tree_of_tile] = static_cast<std::int32_t>(p);
    }
    for (std::size_t t = 0; t < results.size(); ++t)
      for (std::size_t k = 0; k < owner[t].size(); ++k) {
        const Tree_of_tile& tree = results[t]->trees[k];
        if (owner[t][k] != t)
          m_tree_of[t][k] = nearest(own[owner[t][k]], tree.foot, tolerance);
        add_part(t, k, tree);
      }
    find_twins(tolerance);
  }

  const std::vector<Plot_tree>& trees() const { return m_trees; }

  /// Returns the tree of the plot for each tree of a tile, or `no_tree`.
  const std::vector<std::int32_t>& trees_of_tile(std::size_t tile) const { return m_tree_of[tile]; }

  /// Returns tile and tree of all trees with points in the core that match no tree of the plot.
  const std::vector<std::pair<std::size_t, std::size_t>>& unmatched() const { return m_unmatched; }

  /// Returns pairs of trees of different tiles whose feet are within the tolerance: perhaps one
  /// tree whose foot is near a border of cores.
  const std::vector<std::pair<std::size_t, std::size_t>>& twins() const { return m_twins; }

private:
  Position_2 position(const std::array<double, 3>& foot) const
  {
    return horizontal(pcs::IO::Point_table::Point_3(foot[0], foot[1], foot[2]), m_axis_up);
  }

  double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) const
  {
    const Position_2 p = position(a), q = position(b);
    return std::hypot(p[0] - q[0], p[1] - q[1]);
  }

  std::int32_t nearest(const std::vector<std::size_t>& among,
                       const std::array<double, 3>& foot,
                       double tolerance) const
  {
    std::int32_t best = no_tree;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t p : among) {
      const double d = distance(m_trees[p].foot, foot);
      if (d <= tolerance && d < least) {
        least = d;
        best = static_cast<std::int32_t>(p);
      }
    }
    return best;
  }

  void add_part(std::size_t t, std::size_t k, const Tree_of_tile& tree)
  {
    if (tree.number_of_core_points == 0)
      return;
    if (m_tree_of[t][k] == no_tree) {
      m_unmatched.emplace_back(t, k);
      return;
    }
    Plot_tree& own = m_trees[static_cast<std::size_t>(m_tree_of[t][k])];
    ++own.number_of_parts;
    own.number_of_cut_parts += tree.is_at_rim && own.tile != t;
  }

  void find_twins(double tolerance)
  {
    std::vector<std::size_t> order(m_trees.size());
    for (std::size_t p = 0; p < order.size(); ++p)
      order[p] = p;
    const auto x = [this](std::size_t p) { return position(m_trees[p].foot)[0]; };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return x(a) < x(b);
    });
    for (std::size_t i = 0; i < order.size(); ++i)
      for (std::size_t j = i + 1; j < order.size() && x(order[j]) - x(order[i]) <= tolerance; ++j) {
        const auto [a, b] = std::minmax(order[i], order[j]);
        if (m_trees[a].tile != m_trees[b].tile &&
            distance(m_trees[a].foot, m_trees[b].foot) <= tolerance)
          m_twins.emplace_back(a, b);
      }
    std::sort(m_twins.begin(), m_twins.end());
  }

  std::size_t m_axis_up;
  std::vector<Plot_tree> m_trees;
  std::vector<std::vector<std::int32_t>> m_tree_of;
  std::vector<std::pair<std::size_t, std::size_t>> m_unmatched, m_twins;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_PLOT_TREES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Identifies the trees of tiles with the trees of a plot by their feet.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_PLOT_TREES_H
#define PCS_EXAMPLES_PROGRAMS_TILING_PLOT_TREES_H

#include "tiling/Index_sample.h"
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
#include <numeric>
#include <optional>
#include <set>
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
  horizontal distance. Without such a foot within the tolerance, it is the tree with the nearest
  foot in any other tile: near a border of cores, feet that differ by centimetres have different
  owners. Without such a foot either, it is unmatched. A tree whose foot
  is at a border of cores may be found on both sides: trees of two tiles whose feet are within the
  tolerance, and which share most of their points, are one tree of the tile with the smaller number.
  The trees are in descending order of radius, and of equal radius in the order of their feet, so
  they do not depend on the order in which the tiles were segmented.
*/
class Plot_trees
{
public:
  using Results = std::vector<std::optional<Tile_result>>; ///< by tile; empty: missing
  /// No tree of the plot.
  static constexpr std::int32_t no_tree = -1;
  /// Trees of two tiles with a larger overlap are the same [-]: the overlap of the points of two
  /// trees is close to 0, that of one tree in two tiles close to 1.
  static constexpr double same_overlap = 0.5;

  /// A tree of a tile that is also a tree of a tile with a smaller number.
  struct Joined_tree
  {
    std::size_t tree = 0, tile = 0, tree_of_tile = 0;
  };

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
        if (owner[t][k] == t)
          continue;
        const Tree_of_tile& tree = results[t]->trees[k];
        m_tree_of[t][k] = nearest(own[owner[t][k]], tree.foot, tolerance);
        if (m_tree_of[t][k] == no_tree)
          m_tree_of[t][k] = nearest(of_other_tiles(t), tree.foot, tolerance);
      }
    join_twins(results, find_twins(tolerance));
    m_twins = find_twins(tolerance);
    for (std::size_t t = 0; t < results.size(); ++t)
      add_parts(t, results, owner[t], tolerance);
  }

  const std::vector<Plot_tree>& trees() const { return m_trees; }

  /// Returns the tree of the plot for each tree of a tile, or `no_tree`.
  const std::vector<std::int32_t>& trees_of_tile(std::size_t tile) const { return m_tree_of[tile]; }

  /// Returns tile and tree of all trees with points in the core that match no tree of the plot.
  const std::vector<std::pair<std::size_t, std::size_t>>& unmatched() const { return m_unmatched; }

  /// Returns tile and tree of trees that a tile has in its buffer only, and the owner of their
  /// place has not found; one for each place.
  const std::vector<std::pair<std::size_t, std::size_t>>& missed() const { return m_missed; }

  /// Returns pairs of trees of different tiles whose feet are within the tolerance, although they
  /// do not share their points.
  const std::vector<std::pair<std::size_t, std::size_t>>& twins() const { return m_twins; }

  /// Returns the trees that are not counted again, in the order of the trees of the plot.
  const std::vector<Joined_tree>& joined() const { return m_joined; }

  /// Returns the horizontal coordinates of a foot.
  Position_2 position(const std::array<double, 3>& foot) const
  {
    return horizontal(pcs::IO::Point_table::Point_3(foot[0], foot[1], foot[2]), m_axis_up);
  }

private:
  double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) const
  {
    const Position_2 p = position(a), q = position(b);
    return std::hypot(p[0] - q[0], p[1] - q[1]);
  }

  std::vector<std::size_t> of_other_tiles(std::size_t tile) const
  {
    std::vector<std::size_t> others;
    for (std::size_t p = 0; p < m_trees.size(); ++p)
      if (m_trees[p].tile != tile)
        others.push_back(p);
    return others;
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

  /// Adds the parts of the trees in the core of a tile.
  void add_parts(std::size_t t,
                 const Results& results,
                 const std::vector<std::size_t>& owner,
                 double tolerance)
  {
    std::set<std::int32_t> parts, cut_parts; // several trees of a tile may be one of the plot
    for (std::size_t k = 0; k < m_tree_of[t].size(); ++k) {
      const Tree_of_tile& tree = results[t]->trees[k];
      if (m_tree_of[t][k] == no_tree) {
        if (tree.number_of_core_points > 0)
          m_unmatched.emplace_back(t, k);
        else if (results[owner[k]]) // else the tile has failed, which is known
          add_missed(t, k, tree.foot, tolerance);
        continue;
      }
      if (tree.number_of_core_points == 0)
        continue;
      parts.insert(m_tree_of[t][k]);
      if (tree.is_at_rim)
        cut_parts.insert(m_tree_of[t][k]);
    }
    for (const std::int32_t p : parts)
      ++m_trees[static_cast<std::size_t>(p)].number_of_parts;
    for (const std::int32_t p : cut_parts) {
      Plot_tree& own = m_trees[static_cast<std::size_t>(p)];
      own.number_of_cut_parts += own.tile != t;
    }
  }

  void add_missed(std::size_t t, std::size_t k, const std::array<double, 3>& foot, double tolerance)
  {
    for (const std::array<double, 3>& place : m_missed_feet)
      if (distance(place, foot) <= tolerance)
        return;
    m_missed_feet.push_back(foot);
    m_missed.emplace_back(t, k);
  }

  /// Makes one tree of twins that share most of their points.
  void join_twins(const Results& results,
                  const std::vector<std::pair<std::size_t, std::size_t>>& twins)
  {
    std::vector<std::size_t> kept(m_trees.size()); // the tree that each tree is a part of
    std::iota(kept.begin(), kept.end(), std::size_t(0));
    const auto root = [&kept](std::size_t p) {
      while (kept[p] != p)
        p = kept[p];
      return p;
    };
    const auto sample = [&](std::size_t p) -> const std::vector<std::uint64_t>& {
      return results[m_trees[p].tile]->trees[m_trees[p].tree_of_tile].sample;
    };
    for (const auto& [a, b] : twins) {
      if (Index_sample::overlap(sample(a), sample(b)) <= same_overlap)
        continue;
      std::size_t p = root(a), q = root(b);
      if (m_trees[q].tile < m_trees[p].tile)
        std::swap(p, q);
      kept[q] = p;
    }
    std::vector<Plot_tree> trees;
    std::vector<std::int32_t> number(m_trees.size(), no_tree);
    for (std::size_t p = 0; p < m_trees.size(); ++p)
      if (kept[p] == p) {
        number[p] = static_cast<std::int32_t>(trees.size());
        trees.push_back(m_trees[p]);
      }
    for (std::size_t p = 0; p < m_trees.size(); ++p)
      if (kept[p] != p) {
        number[p] = number[root(p)];
        m_joined.push_back(
            {static_cast<std::size_t>(number[p]), m_trees[p].tile, m_trees[p].tree_of_tile});
      }
    for (std::vector<std::int32_t>& trees_of_tile : m_tree_of)
      for (std::int32_t& p : trees_of_tile)
        p = p == no_tree ? no_tree : number[static_cast<std::size_t>(p)];
    m_trees = std::move(trees);
    std::sort(m_joined.begin(), m_joined.end(), [](const Joined_tree& a, const Joined_tree& b) {
      return std::tie(a.tree, a.tile, a.tree_of_tile) < std::tie(b.tree, b.tile, b.tree_of_tile);
    });
  }

  /// Returns pairs of trees of different tiles whose feet are within the tolerance.
  std::vector<std::pair<std::size_t, std::size_t>> find_twins(double tolerance) const
  {
    std::vector<std::pair<std::size_t, std::size_t>> twins;
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
          twins.emplace_back(a, b);
      }
    std::sort(twins.begin(), twins.end());
    return twins;
  }

  std::size_t m_axis_up;
  std::vector<Plot_tree> m_trees;
  std::vector<std::vector<std::int32_t>> m_tree_of;
  std::vector<std::pair<std::size_t, std::size_t>> m_unmatched, m_missed, m_twins;
  std::vector<std::array<double, 3>> m_missed_feet;
  std::vector<Joined_tree> m_joined;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_PLOT_TREES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Measures the crowns of all trees of a plot with bounded memory.

#ifndef PCS_EXAMPLES_PROGRAMS_CROWNS_PLOT_CROWNS_H
#define PCS_EXAMPLES_PROGRAMS_CROWNS_PLOT_CROWNS_H

#include "tiling/Labelled_tiles.h"
#include "tiling/Plot_trees.h"
#include "tiling/Tile_manifest.h"
#include "tiling/horizontal.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/Skeleton_options.h>
#include <pcs/crowns/Crown_layers.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace program {

/*!
  The crown of a tree consists of its points at or above a height above the foot. A tree with a
  point too far above its foot, which is no point of a tree, has no crown. The height of layers
  scales with breast height, so that volumes do not depend on the unit. Trees are measured in
  groups in the order of their tiles, and only the tiles with points of a group are read for it.
*/
class Plot_crowns
{
public:
  /// Trees that are measured at a time; a tree needs some 60 kB.
  static constexpr std::size_t group_size = 1000;
  /// Largest height above the base of a crown, in heights of a layer [-].
  static constexpr double most_layers = 1e6;

  /// `base`: height above the foot [L]; `breast_height`: of the results [L].
  Plot_crowns(const Tile_manifest& manifest,
              const Labelled_tiles& tiles,
              const Plot_trees& trees,
              double base,
              double breast_height)
    : m_manifest(manifest),
      m_tiles(tiles),
      m_trees(trees),
      m_sign(manifest.up().front() == '-' ? -1 : 1),
      m_base(base),
      m_layer_height(layer_height(breast_height)),
      m_measures(trees.trees().size()),
      m_is_too_high(m_measures.size(), false)
  {
    std::vector<std::size_t> order(m_measures.size());
    for (std::size_t p = 0; p < order.size(); ++p)
      order[p] = p;
    std::stable_sort(order.begin(), order.end(), [&trees](std::size_t a, std::size_t b) {
      return trees.trees()[a].tile < trees.trees()[b].tile;
    });
    for (std::size_t first = 0; first < order.size(); first += group_size)
      measure(order, first, std::min(order.size(), first + group_size));
  }

  /// Returns the height of a layer: half a metre if breast height is the default in metres [L].
  static double layer_height(double breast_height)
  {
    return breast_height * pcs::crowns::default_layer_height / pcs::default_breast_height;
  }

  /// Returns the crowns of the trees of the plot.
  const std::vector<pcs::crowns::Crown_measures>& measures() const { return m_measures; }

  /// Returns whether a tree of the plot has no crown because of a point too far above its foot.
  const std::vector<bool>& is_too_high() const { return m_is_too_high; }

private:
  void measure(const std::vector<std::size_t>& order, std::size_t first, std::size_t end)
  {
    std::vector<pcs::crowns::Crown_layers> layers;
    std::vector<std::size_t> place(m_measures.size(), end); // of each tree in `order`
    for (std::size_t w = first; w < end; ++w) {
      place[order[w]] = w;
      layers.emplace_back(base_of(order[w]), m_layer_height);
    }
    for (std::size_t t = 0; t < m_tiles.results().size(); ++t) {
      const std::vector<std::size_t> place_of = places_in_group(m_tiles, m_trees, t, place, end);
      if (!place_of.empty())
        add_tile(t, order, place_of, first, end, layers);
    }
    for (std::size_t w = first; w < end; ++w)
      if (!m_is_too_high[order[w]])
        m_measures[order[w]] = layers[w - first].measures();
  }

  double base_of(std::size_t tree) const
  {
    return m_sign * m_trees.trees()[tree].foot[m_manifest.axis_up()] + m_base;
  }

  void add_tile(std::size_t tile,
                const std::vector<std::size_t>& order,
                const std::vector<std::size_t>& place_of,
                std::size_t first,
                std::size_t end,
                std::vector<pcs::crowns::Crown_layers>& layers)
  {
    const std::size_t axis_up = m_manifest.axis_up();
    pcs::IO::Point_reader reader(m_tiles.path_of(tile));
    pcs::IO::Point_table chunk;
    while (reader.read(chunk, Labelled_tiles::chunk_size)) {
      const auto& trees = chunk.property<std::int32_t>("tree");
      for (std::size_t i = 0; i < trees.size(); ++i) {
        if (trees[i] < 0 || place_of[static_cast<std::size_t>(trees[i])] == end)
          continue;
        const auto& p = chunk.points()[i];
        const std::size_t place = place_of[static_cast<std::size_t>(trees[i])];
        const std::size_t tree = order[place];
        const double height = m_sign * p[static_cast<int>(axis_up)];
        if (!(height - base_of(tree) <= most_layers * m_layer_height))
          m_is_too_high[tree] = true;
        if (!m_is_too_high[tree])
          layers[place - first].add(horizontal(p, axis_up), height);
      }
    }
  }

  const Tile_manifest& m_manifest;
  const Labelled_tiles& m_tiles;
  const Plot_trees& m_trees;
  double m_sign, m_base, m_layer_height;
  std::vector<pcs::crowns::Crown_measures> m_measures;
  std::vector<bool> m_is_too_high; ///< by tree of the plot
};

/// Returns the outlines as GeoJSON, in the horizontal coordinates of the scan. A crown on one line
/// has no geometry.
inline nlohmann::ordered_json to_json(const std::vector<pcs::crowns::Crown_measures>& crowns)
{
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  for (std::size_t t = 0; t < crowns.size(); ++t) {
    nlohmann::ordered_json geometry;
    if (crowns[t].outline.size() >= 3) {
      nlohmann::ordered_json ring = crowns[t].outline;
      ring.push_back(crowns[t].outline.front()); // rings are closed
      geometry = {{"type", "Polygon"}, {"coordinates", nlohmann::ordered_json::array({ring})}};
    }
    features.push_back(
        {{"type", "Feature"},
         {"id", t},
         {"geometry", geometry},
         {"properties",
          {{"tree", t}, {"crown_area", crowns[t].area}, {"crown_volume", crowns[t].volume}}}});
  }
  return {{"type", "FeatureCollection"}, {"features", features}};
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_CROWNS_PLOT_CROWNS_H

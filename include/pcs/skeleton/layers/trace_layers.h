// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Root, shortest paths from the root, and the geodesic level sets along them.

#ifndef PCS_SKELETON_LAYERS_TRACE_LAYERS_H
#define PCS_SKELETON_LAYERS_TRACE_LAYERS_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/layers/cut_layers.h>
#include <pcs/skeleton/layers/find_root.h>
#include <pcs/skeleton/layers/merge_ring_arcs.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the root search and of the level sets.
struct Layer_options
{
  Root_options roots;
  Ring_arc_options rings;
  double thickness = layer_thickness; ///< of a level set, in spacings [-]
};

/// Returns the points of the root: those of `find_root_near()` for a `hint` (in coordinates of the
/// scan), those of `find_root_at()` for a `foot`, otherwise those of `find_root()`.
template <class ConcurrencyTag>
std::vector<Index> points_of_root(const Scan& scan,
                                  const std::vector<std::uint8_t>& is_used,
                                  const Compact_links& links,
                                  const Point_parts& parts,
                                  const std::optional<Vec3>& hint,
                                  const std::optional<Stem_foot>& foot,
                                  const Vec3& up,
                                  const Layer_options& options)
{
  const Root_options& rules = options.roots;
  if (hint)
    return find_root_near<ConcurrencyTag>(*hint, scan, is_used, links, parts, up, rules);
  if (foot)
    return find_root_at<ConcurrencyTag>(*foot, scan, is_used, links, parts, up, rules);
  return find_root<ConcurrencyTag>(scan, is_used, links, parts, up, rules);
}

/*!
  Builds the neighbour graph of the used points from `links` and from links that close gaps between
  connected components. Calls `find_root(parts)` with the components concurrently.
*/
template <class ConcurrencyTag, class FindRoot>
void link_parts(const Scan& scan,
                const std::vector<std::uint8_t>& is_used,
                const Compact_links& links,
                const Link_rule& rule,
                const FindRoot& find_root,
                Linked_parts& linked)
{
  linked.graph.reset(); // large
  const Point_parts parts = connected_parts<ConcurrencyTag>(is_used, links);
  pcs::internal::invoke_both<ConcurrencyTag>(
      [&] { find_root(parts); },
      [&] {
        linked.gaps = links_across_gaps<ConcurrencyTag>(scan, is_used, rule, parts);
        linked.graph = graph_of(scan.size(), links, linked.gaps);
      });
}

/// Computes the shortest paths from `root`, and the tree of their level sets. Releases the graph,
/// and appends the links that close gaps to `links`.
template <class ConcurrencyTag>
Shortest_paths trace_layers(const Scan& scan,
                            const std::vector<Index>& root,
                            const Layer_options& options,
                            Compact_links& links,
                            Linked_parts& linked,
                            Layer_tree& layers)
{
  Shortest_paths paths = shortest_paths(scan, *linked.graph, root);
  linked.graph.reset();
  links.append(linked.gaps);
  layers = layer_tree<ConcurrencyTag>(scan, links, paths, options.thickness);
  merge_ring_arcs<ConcurrencyTag>(scan, options.rings, layers);
  return paths;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LAYERS_TRACE_LAYERS_H

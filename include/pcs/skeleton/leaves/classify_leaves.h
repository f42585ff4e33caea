// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Leaf-wood classification of points by lines, surfaces and paths.

#ifndef PCS_SKELETON_LEAVES_CLASSIFY_LEAVES_H
#define PCS_SKELETON_LEAVES_CLASSIFY_LEAVES_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/leaves/detect_linear_points.h>
#include <pcs/skeleton/leaves/detect_planar_patches.h>
#include <pcs/skeleton/leaves/find_stem_wood.h>
#include <pcs/skeleton/leaves/find_surface_wood.h>
#include <pcs/skeleton/leaves/sampling_dimension.h>
#include <pcs/skeleton/leaves/wood_score_of_paths.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the leaf-wood separation.
struct Leaf_options
{
  //! least fraction of points without an axis; with fewer, the separation is skipped [-]
  double unexplained = 0.025;
  double thick = 0.05; ///< least fraction of thick wood in a tree [-]
  //! least sampling dimension of thick wood; lower values indicate rows, which resemble twigs [-]
  double dimension = 1.9;
  double leafy = 0.16;        ///< least fraction of points deep in leaves; fewer may be chance [-]
  std::size_t neighbors = 10; ///< neighbours in leaves of a point deep in leaves [count]
  //! alternatively: least fraction of the points outside thick wood that lie in planar patches [-]
  double patchy = 0.035;
  double wood_score = -0.8;    ///< least log-odds of wood for a point [-]
  double axis_likeness = -0.4; ///< the same for an axis [-]
  //! least log-odds in leafless trees: for an axis, and for a point without an axis [-]
  double bare_axis_likeness = -2, bare_point_likeness = 1;
  double bare_reach = 2.5; ///< distance from the trunk axis that is always wood, in radii [-]
  int rounds = 3;          ///< rounds of removal: points first, then axes twice [count]
  double pipe_slack = 1.5; ///< `Pipe_model_options::slack` of trees with leaves [-]
  Surface_wood_options hollow;
  Stem_wood_options stem;
  Linear_point_options lines;
  Wood_path_options paths;
  Planar_patch_options patches;
};

/// Returns whether there are enough points without an axis to require a leaf-wood separation.
inline bool may_have_leaves(const Axis_set& set,
                            const std::vector<std::uint8_t>& is_used,
                            const Leaf_options& rules)
{
  std::size_t used = 0, open = 0;
  for (Index i = 0; i < is_used.size(); ++i)
    if (is_used[i]) {
      ++used;
      open += !set.is_covered(i);
    }
  return double(open) >= rules.unexplained * double(used);
}

/// Returns whether the fraction of thick wood is large enough for a tree. O(points).
inline bool has_thick_wood(const std::vector<std::uint8_t>& is_used,
                           const std::vector<std::uint8_t>& is_thick,
                           const Leaf_options& rules)
{
  std::size_t used = 0, thick = 0;
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    used += is_used[i];
    thick += is_used[i] && is_thick[i];
  }
  return double(thick) >= rules.thick * double(used);
}

/*!
  Returns whether the points outside thick wood and lines are leaves. Barely resolved twigs form no
  lines either, but they are mixed with well resolved twigs and form no planar patches. O(points).
*/
inline bool are_leaves(const Scan& scan,
                       const std::vector<std::uint8_t>& is_used,
                       const std::vector<std::uint8_t>& is_thick,
                       const std::vector<std::uint8_t>& is_wood,
                       const Leaf_options& rules)
{
  std::vector<std::uint8_t> is_open(scan.size());
  std::size_t used = 0, thin = 0, deep = 0; // all, outside thick wood, deep in leaves
  for (std::size_t i = 0; i < scan.size(); ++i) {
    used += is_used[i];
    thin += is_used[i] && !is_thick[i];
    is_open[i] = is_used[i] && !is_wood[i];
  }
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::size_t count = 0;
    for (const Index j : scan.neighbors[i])
      count += j != none && is_open[j];
    deep += is_open[i] && count >= rules.neighbors;
  }
  return double(deep) >= rules.leafy * double(used) ||
         double(count_patch_points(scan, is_open, is_thick, rules.patches)) >=
             rules.patchy * double(thin);
}

/// The classification of the used points.
struct Found_wood
{
  std::vector<std::uint8_t> is_wood; ///< empty: no leaves were detected
  //! log-odds of wood, by point; empty: unknown
  std::vector<float> wood_score;
  bool is_in_rows = false; ///< no classification, because the points lie in rows
};

/*!
  Classifies points as wood or leaves. Thick wood has hollow sections; thin wood is recognized by
  its surroundings and by the shortest paths through it. `paths` connect all used points. `is_sure`
  indicates that the tree has leaves. Otherwise, all points are wood if the points outside thick
  wood and lines do not resemble leaves. The same applies if the points of thick wood lie in rows:
  each row is a line, and its surroundings resemble neither a twig nor a leaf.
*/
template <class ConcurrencyTag>
Found_wood classify_wood_points(const Scan& scan,
                                const Axis_set& set,
                                const std::vector<std::uint8_t>& is_used,
                                const Shortest_paths& paths,
                                bool is_sure,
                                const Leaf_options& rules)
{
  Found_wood result;
  if (!is_sure && !may_have_leaves(set, is_used, rules))
    return result;
  const std::vector<std::uint8_t> is_thick =
      points_on_hollow_sections<ConcurrencyTag>(scan, set, rules.hollow);
  if (!is_sure && !has_thick_wood(is_used, is_thick, rules))
    return result;
  if (!is_sure && sampling_dimension(scan, is_thick) < rules.dimension) {
    result.is_in_rows = true;
    return result;
  }
  std::vector<float> wood_score(scan.size());
  std::vector<std::uint8_t> is_line = points_on_lines<ConcurrencyTag>(
      scan,
      is_used,
      is_thick,
      rules.lines,
      [&](std::size_t i, const internal::Line_search& search, float score) {
        wood_score[i] = static_cast<float>(wood_probability(search.surroundings(score)));
      });
  for (std::size_t i = 0; i < scan.size(); ++i)
    is_line[i] = is_used[i] && (is_thick[i] || is_line[i]);
  result.wood_score =
      wood_score_of_paths<ConcurrencyTag>(scan, is_used, is_thick, paths, wood_score, rules.paths);
  if (!is_sure && !are_leaves(scan, is_used, is_thick, is_line, rules))
    return result;
  result.is_wood.resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
    result.is_wood[i] =
        is_used[i] && (is_thick[i] || double(result.wood_score[i]) >= rules.wood_score);
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_CLASSIFY_LEAVES_H

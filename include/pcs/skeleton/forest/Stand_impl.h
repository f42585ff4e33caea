// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Stand.h.

#ifndef PCS_SKELETON_FOREST_STAND_IMPL_H
#define PCS_SKELETON_FOREST_STAND_IMPL_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/internal/median.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/forest/Sparse_ground.h>
#include <pcs/skeleton/forest/Stand.h>
#include <pcs/skeleton/forest/Stand_options.h>
#include <pcs/skeleton/forest/Stem_detector.h>
#include <pcs/skeleton/forest/Thinned_points.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/Scan_frame.h>
#include <pcs/skeleton/scan/leave_out_strays.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// The trees detected at one voxel size.
struct Stand_state
{
  Scan_frame frame;
  std::vector<Found_stem> stems;     ///< grouped by tree; in coordinates of `frame`
  std::vector<Index> point_of_input; ///< point of the thinned scan of each input point
  std::vector<Index> tree_of_point;  ///< of these points; empty if nothing was assigned
  //! of these points, relative to the median of the points of trees [-]; empty as above
  std::vector<float> spacing_of_point;

  Index tree_of_input(std::size_t i) const
  {
    return tree_of_point.empty() ? none : tree_of_point[point_of_input[i]];
  }
  double spacing_of_input(std::size_t i) const
  {
    return double(spacing_of_point[point_of_input[i]]);
  }
};

/// Points of a scan: those above the ground, and those that may show ground.
struct Ground_view
{
  std::vector<std::uint8_t> is_above, may_be_ground;
  std::optional<Sparse_ground> ground; ///< its surface, if enough of it is seen
};

/*!
  Returns the points that are left after the removal of clutter. If no ground was found, the points
  of a sparse ground are removed, too; otherwise, stray points far below the ground. Stray points
  may not show ground if more points lie on it without them: they hide it below.
*/
template <class ConcurrencyTag>
Ground_view view_ground(const Session<ConcurrencyTag>& session, double breast_height)
{
  const Scan& scan = session.scan();
  const std::vector<std::uint8_t> all(scan.size(), 1);
  Ground_view view{session.used_points(), all, std::nullopt};
  const bool has_ground = session.report().number_of_ground_points > 0;
  const std::vector<std::uint8_t>& is_used = has_ground ? all : view.is_above;
  const Sparse_ground_options rules;
  const double height = breast_height / scan.frame.unit;
  const Sparse_ground of_all(scan, height, rules, is_used);
  const Sparse_ground without_strays(scan,
                                     height,
                                     rules,
                                     leave_out_strays<ConcurrencyTag>(scan, is_used));
  const auto number_on = [&](const Sparse_ground& ground) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < scan.size(); ++i)
      count += is_used[i] && std::abs(ground.height(scan.points[i])) <= ground.thickness();
    return count;
  };
  const bool has_strays = number_on(without_strays) > number_on(of_all);
  if (has_strays)
    view.may_be_ground = leave_out_strays<ConcurrencyTag>(scan, all);
  const Sparse_ground& ground = has_strays ? without_strays : of_all;
  if (!ground.is_found())
    return view;
  view.ground = ground;
  constexpr double deep = 0.5; // of stray points below the ground, in breast heights [-]
  const double top = has_ground ? -deep * height : ground.thickness();
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (ground.height(scan.points[i]) <= top)
      view.is_above[i] = 0;
  return view;
}

/// Returns the spacing of each point relative to the median of the points of trees [-].
inline std::vector<float> relative_spacings(const Scan& scan,
                                            const std::vector<Index>& tree_of_point)
{
  std::vector<double> spacings; // without the ground, whose spacing may differ
  for (Index i = 0; i < scan.size(); ++i)
    if (tree_of_point[i] != none)
      spacings.push_back(scan.local_spacing[i]);
  if (spacings.empty())
    spacings = scan.local_spacing;
  const double spacing = pcs::internal::lower_median(spacings);
  std::vector<float> result(scan.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = static_cast<float>(scan.local_spacing[i] / spacing);
  return result;
}

/// Detects the stems. Assigns points to trees only if `are_wanted(stand, stem_of_point)` holds for
/// these stems and the stems of the points of the thinned scan.
/// Returns `false` if the work was cancelled.
template <class ConcurrencyTag, class Are_wanted>
bool find_stand(const Read_input& read_input,
                double side,
                const Session_hints& hints,
                const Stand_options& rules,
                pcs::internal::Progress& progress,
                const Are_wanted& are_wanted,
                Stand_state& stand)
{
  Thinned_points thinned = thin_by_voxels<ConcurrencyTag>(read_input(), side);
  stand.point_of_input = std::move(thinned.of_input);
  if (thinned.points.size() < rules.solid_part) // much smaller than a tree
    return progress(1);
  Session_options options(hints);
  options.axes.chains.enclosed = 1; // few points from the air are on the surface of a stem
  options.leaf_removal = Leaf_removal::never;
  options.do_trace_paths = false;
  options.do_thin = false;
  options.clutter.ground.thickest = rules.foot * hints.breast_height; // feet remain
  options.clutter.ground.do_accept_areas = false;   // sparse ground of stands would be too thick
  options.clutter.ground.objects.do_remove = false; // they may be trees
  options.clutter.ground.stem.do_compare_links = false; // crowns link many stems
  Session<ConcurrencyTag> session(std::move(thinned.points), {}, options);
  if (!session.find_paths(progress))
    return false;
  const Scan& scan = session.scan();
  stand.frame = scan.frame;
  for (Index& point : stand.point_of_input)
    point = scan.point_of_input[point];
  const Ground_view view = view_ground(session, hints.breast_height);
  Stem_detector<ConcurrencyTag> finder(scan,
                                       view.is_above,
                                       view.may_be_ground,
                                       view.ground,
                                       hints.breast_height / scan.frame.unit,
                                       options,
                                       rules);
  if (!finder.find(progress))
    return false;
  stand.stems = finder.stems();
  if (!are_wanted(stand, finder.stem_of_point()))
    return progress(1);
  if (!finder.label(progress, [&] { session.release_neighbors(); }))
    return false;
  stand.tree_of_point = finder.tree_of_point();
  stand.spacing_of_point = relative_spacings(scan, stand.tree_of_point);
  return true;
}

/// Returns which stems of `coarse` are sparsely sampled in `stand`: all if it has no stem.
/// `stem_of_point` is that of the points of `coarse`. O(points).
inline std::vector<bool> sparse_stems(const Stand_state& coarse,
                                      const std::vector<Index>& stem_of_point,
                                      const Stand_options& rules,
                                      const Stand_state& stand)
{
  std::vector<bool> result(coarse.stems.size(), stand.stems.empty());
  if (stand.stems.empty() || coarse.stems.empty() || stand.spacing_of_point.empty())
    return result;
  std::vector<std::vector<float>> spacings(coarse.stems.size());
  for (std::size_t i = 0; i < coarse.point_of_input.size(); ++i) {
    const Index stem = stem_of_point[coarse.point_of_input[i]];
    if (stem != none)
      spacings[stem].push_back(stand.spacing_of_point[stand.point_of_input[i]]);
  }
  for (std::size_t s = 0; s < result.size(); ++s)
    result[s] = double(pcs::internal::lower_median(spacings[s])) >= rules.sparse;
  return result;
}

/*!
  Adds the trees of sparsely sampled stems of `coarse`, which are disconnected at the finer voxel
  size. Assigns to these trees their points that are sparse or unassigned. Returns the tree of each
  input point. O(points + stems^2).
*/
inline std::vector<Index> add_sparse_trees(const Stand_state& coarse,
                                           const std::vector<bool>& is_sparse,
                                           double breast_height,
                                           const Stand_options& rules,
                                           Stand_state& stand)
{
  std::vector<Index> tree_of_input(stand.point_of_input.size());
  for (std::size_t i = 0; i < tree_of_input.size(); ++i)
    tree_of_input[i] = stand.tree_of_input(i);
  if (coarse.stems.empty())
    return tree_of_input;
  Index number_of_trees = stand.stems.empty() ? 0 : stand.stems.back().tree + 1;
  std::vector<Index> tree_of_coarse(coarse.stems.back().tree + 1, none);
  for (std::size_t s = 0; s < coarse.stems.size(); ++s) {
    Found_stem stem = coarse.stems[s];
    Index& tree = tree_of_coarse[stem.tree];
    if (tree != none || !is_sparse[s])
      continue;
    stem.foot = stand.frame.to_local(coarse.frame.to_input(stem.foot));
    stem.radius *= coarse.frame.unit / stand.frame.unit;
    stem.radius_at_breast *= coarse.frame.unit / stand.frame.unit;
    stem.height *= coarse.frame.unit / stand.frame.unit;
    stem.above_ground *= coarse.frame.unit / stand.frame.unit;
    const auto own = std::find_if(stand.stems.begin(), stand.stems.end(), [&](const Found_stem& o) {
      const bool is_thicker = o.radius >= stem.radius;
      return are_of_one_tree(is_thicker ? stem : o,
                             is_thicker ? o : stem,
                             breast_height / stand.frame.unit,
                             rules);
    });
    tree = own == stand.stems.end() ? number_of_trees++ : own->tree;
    if (own == stand.stems.end()) {
      stem.tree = tree;
      stand.stems.push_back(stem);
    }
  }
  for (std::size_t i = 0; i < tree_of_input.size(); ++i) {
    const Index c = coarse.tree_of_input(i);
    if (c != none && tree_of_coarse[c] != none &&
        (tree_of_input[i] == none || stand.spacing_of_input(i) >= rules.sparse))
      tree_of_input[i] = tree_of_coarse[c];
  }
  return tree_of_input;
}

/*!
  Removes the trees that are lower than breast height, such as shrubs, and counts them. All trees
  remain if none is higher, as in a stand of seedlings. O(points).
*/
inline void remove_low_plants(const std::vector<Vec3>& input,
                              const Vec3& up,
                              double breast_height,
                              Stand& stand)
{
  std::vector<double> height(stand.trees.size(), 0);
  for (std::size_t i = 0; i < input.size(); ++i) {
    const Index tree = stand.tree_of_input[i];
    if (tree != none)
      height[tree] = std::max(height[tree], up.dot(input[i] - stand.trees[tree].foot));
  }
  std::vector<Detected_tree> trees;
  std::vector<Index> number(stand.trees.size(), none);
  for (std::size_t t = 0; t < height.size(); ++t)
    if (height[t] >= breast_height) {
      number[t] = static_cast<Index>(trees.size());
      trees.push_back(stand.trees[t]);
    }
  if (trees.empty())
    return;
  stand.number_of_low_plants = stand.trees.size() - trees.size();
  stand.trees = std::move(trees);
  for (Index& tree : stand.tree_of_input)
    tree = tree == none ? none : number[tree];
}

} // namespace internal

template <class ConcurrencyTag>
bool find_trees(const Read_input& read_input,
                const Session_hints& hints,
                pcs::internal::Progress& progress,
                Stand& forest)
{
  const Stand_options rules;
  const double side = rules.cell * hints.breast_height;
  internal::Stand_state stand, coarse;
  progress.stage(0, 0.75);
  const auto always = [](const auto&, const auto&) { return true; };
  if (!internal::find_stand<ConcurrencyTag>(read_input,
                                            side,
                                            hints,
                                            rules,
                                            progress,
                                            always,
                                            stand))
    return false;
  std::vector<bool> is_sparse;
  const auto has_sparse_stems = [&](const internal::Stand_state& other,
                                    const std::vector<Index>& stem_of_point) {
    is_sparse = internal::sparse_stems(other, stem_of_point, rules, stand);
    return std::find(is_sparse.begin(), is_sparse.end(), true) != is_sparse.end();
  };
  progress.stage(0.75, 1);
  if (!internal::find_stand<ConcurrencyTag>(read_input,
                                            rules.coarser * side,
                                            hints,
                                            rules,
                                            progress,
                                            has_sparse_stems,
                                            coarse))
    return false;
  std::vector<Index> tree_of_input =
      internal::add_sparse_trees(coarse, is_sparse, hints.breast_height, rules, stand);
  coarse = internal::Stand_state();

  std::vector<internal::Found_stem> thickest; // of each tree, in descending order of radius
  for (const internal::Found_stem& stem : stand.stems)
    if (stem.tree == thickest.size())
      thickest.push_back(stem);
  std::stable_sort(thickest.begin(), thickest.end(), [](const auto& a, const auto& b) {
    return a.radius > b.radius;
  });
  Stand result;
  std::vector<Index> place(thickest.size());
  for (const internal::Found_stem& stem : thickest) {
    place[stem.tree] = static_cast<Index>(result.trees.size());
    const Vec3 foot = stem.foot_on_ground(hints.breast_height / stand.frame.unit);
    result.trees.push_back({stand.frame.to_input(foot),
                            stand.frame.unit * stem.radius,
                            stand.frame.unit * stem.radius_at_breast,
                            stand.frame.unit * stem.above_ground});
  }
  for (Index& tree : tree_of_input)
    tree = tree == none ? none : place[tree];
  result.tree_of_input = std::move(tree_of_input);
  internal::remove_low_plants(read_input(), hints.up, hints.breast_height, result);
  forest = std::move(result);
  return true;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_STAND_IMPL_H

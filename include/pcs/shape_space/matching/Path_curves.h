// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Branch paths of two trees as curves in common units and frames.

#ifndef PCS_SHAPE_SPACE_MATCHING_PATH_CURVES_H
#define PCS_SHAPE_SPACE_MATCHING_PATH_CURVES_H

#include <pcs/internal/parallel.h>
#include <pcs/shape_space/matching/canonical_frame.h>
#include <pcs/shape_space/matching/elastic_curves.h>
#include <pcs/shape_space/model/Branch_paths.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// All paths of two trees, sampled. Lengths are in units of the longest path of each tree; with
/// growth at tips, in units of the longest path of both trees.
class Path_curves
{
public:
  static constexpr std::size_t number_of_samples = 25; ///< of a curve
  static constexpr std::size_t few_samples = 13;       ///< every other sample, for quick costs

  template <class ConcurrencyTag>
  Path_curves(const Rooted_tree& tree_1,
              const Rooted_tree& tree_2,
              std::array<Branch_paths, 2> paths,
              bool grows_at_tips,
              ConcurrencyTag)
    : m_trees{&tree_1, &tree_2},
      m_grows_at_tips(grows_at_tips),
      m_unit{tree_1.heights[0], tree_2.heights[0]},
      m_paths(std::move(paths))
  {
    if (grows_at_tips)
      m_unit[0] = m_unit[1] = std::max(m_unit[0], m_unit[1]);
    for (std::size_t t = 0; t < 2; ++t) {
      m_curves[t].resize(m_paths[t].paths.size());
      m_coarse[t].resize(m_paths[t].paths.size());
      pcs::internal::for_each_index<ConcurrencyTag>(
          m_curves[t].size(),
          [&](std::size_t i) {
            Sampled_curve& curve = m_curves[t][i];
            curve = sample_curve(*m_trees[t], m_paths[t].paths[i], number_of_samples);
            curve.length /= m_unit[t];
            rotate_curve(curve);
            m_coarse[t][i] = curve;
            for (std::size_t k = 0; k < few_samples; ++k)
              m_coarse[t][i].tangents.col(static_cast<Eigen::Index>(k)) =
                  curve.tangents.col(static_cast<Eigen::Index>(2 * k));
            m_coarse[t][i].tangents.conservativeResize(3, few_samples);
          },
          16);
    }
  }

  const Branch_paths& paths(int t) const { return m_paths[static_cast<std::size_t>(t)]; }
  const Branch_path& path(int t, std::size_t i) const { return paths(t).paths[i]; }
  /// Returns the length of a path, in units of the longest path of the tree. [-]
  double length(int t, std::size_t path) const { return curves(t)[path].length; }
  /// Restricts the trunks of tree 2 to this path.
  void set_second_trunk(std::size_t path) { m_paths[1].paths_of[0] = {path}; }
  /// Swaps the trunks with the other trunks.
  void swap_trunks()
  {
    for (Branch_paths& paths : m_paths)
      paths.paths_of[0].swap(paths.other_trunks);
  }
  /// Swaps the paths of limbs with their paths for the second search.
  void swap_limbs()
  {
    for (Branch_paths& paths : m_paths)
      for (auto& [start, more] : paths.limbs)
        paths.paths_of[start].swap(more);
  }
  /// Returns the axes of tree 1, to which all rotations refer, in the axes of the caller.
  const Eigen::Matrix3d& frame() const { return m_frame; }

  /// Returns the total length of the subtree that begins with the edge to `start`. [-]
  double weight(int t, std::size_t start) const
  {
    const Rooted_tree& tree = *m_trees[static_cast<std::size_t>(t)];
    return (tree.weights[start] + (tree.parents[start] == none ? 0 : tree.edge_length(start))) /
           m_unit[static_cast<std::size_t>(t)];
  }

  /// Returns whether a branch is a limb: its subtree has more than `limb_share` of its tree.
  bool is_limb(int t, std::size_t start) const
  {
    return start != 0 && weight(t, start) > limb_share * weight(t, 0);
  }

  /// Returns the nodes at which two matched branches end: their tips; or with growth at tips, the
  /// tip of the shorter branch and the node of the longer branch nearest to that length.
  std::array<std::size_t, 2> last_nodes(std::size_t p1, std::size_t p2) const
  {
    std::array<std::size_t, 2> last = {path(0, p1).nodes.size() - 1, path(1, p2).nodes.size() - 1};
    if (!is_cut(path(0, p1).length(), path(1, p2).length()))
      return last;
    const std::size_t t = path(0, p1).length() > path(1, p2).length() ? 0 : 1;
    const Branch_path &more = t == 0 ? path(0, p1) : path(1, p2),
                      &less = t == 0 ? path(1, p2) : path(0, p1);
    const auto it = std::lower_bound(more.arc.begin() + 1, more.arc.end() - 1, less.length());
    auto k = static_cast<std::size_t>(it - more.arc.begin());
    if (k > 1 && less.length() - more.arc[k - 1] < nearer * (more.arc[k] - less.length()))
      --k;
    last[t] = k;
    return last;
  }

protected:
  bool grows_at_tips() const { return m_grows_at_tips; }
  /// Returns the unit of length of a tree. [L]
  double unit(int t) const { return m_unit[static_cast<std::size_t>(t)]; }
  bool is_cut(double length_1, double length_2) const
  {
    return m_grows_at_tips &&
           std::min(length_1, length_2) < longest_cut * std::max(length_1, length_2);
  }

  const std::vector<Sampled_curve>& curves(int t) const
  {
    return m_curves[static_cast<std::size_t>(t)];
  }
  /// Returns the curve up to the node `last`, stored in `cut` if that is not the tip.
  const Sampled_curve&
  curve(int t, std::size_t path, std::size_t samples, std::size_t last, Sampled_curve& cut) const
  {
    const auto i = static_cast<std::size_t>(t);
    const Branch_path& whole = m_paths[i].paths[path];
    if (last + 1 < whole.nodes.size()) {
      cut = sample_curve(*m_trees[i], whole, samples, last);
      cut.length /= m_unit[i];
      rotate_curve(cut);
      return cut;
    }
    return samples == number_of_samples ? m_curves[i][path] : m_coarse[i][path];
  }

private:
  // not round, as lengths of synthetic trees often are
  static constexpr double longest_cut =
      0.950001;                              // above this ratio of lengths, branches end together
  static constexpr double nearer = 0.999999; // of two nodes about equally near, the farther node

  /// Transforms a curve to the axes of tree 1. Rotations are rounded in these axes, so that the
  /// poses of the trees do not matter.
  void rotate_curve(Sampled_curve& curve) const
  {
    curve.tangents = (m_frame.transpose() * curve.tangents).eval();
    curve.direction = (m_frame.transpose() * curve.direction).eval();
  }

  std::array<const Rooted_tree*, 2> m_trees;
  bool m_grows_at_tips;
  std::array<double, 2> m_unit; // of length
  Eigen::Matrix3d m_frame = canonical_frame(*m_trees[0]);
  std::array<Branch_paths, 2> m_paths;
  std::array<std::vector<Sampled_curve>, 2> m_curves, m_coarse;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_PATH_CURVES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Decompositions of a tree into branch paths: longest continuations and alternatives.

#ifndef PCS_SHAPE_SPACE_MODEL_BRANCH_PATHS_H
#define PCS_SHAPE_SPACE_MODEL_BRANCH_PATHS_H

#include <pcs/shape_space/model/Rooted_tree.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// A child may also continue a branch if this shortens the branch by at most this fraction of its
/// length [-]. The choice of the twig at the end of a branch is arbitrary, but determines which
/// other twigs are children of the branch.
constexpr double tip_share = 0.05;

/// Factor by which the number of candidates is larger for the trunk, since the matching of all
/// branches depends on it. [-]
constexpr std::size_t trunk_factor = 6;

/// A limb has more than this fraction of the length of its tree. [-]
constexpr double limb_share = 0.01;

/// Factors of the fork ratio and of the number of candidates of limbs in a second search: all
/// branches of a limb are lost if it follows another child at a fork. [-]
constexpr double limb_ratio = 0.625;
constexpr std::size_t limb_factor = 2;

/// Branches of deeper levels have a single candidate. Each candidate of a branch begins
/// other branches, so the number of pairs to match would grow as the square of the number of
/// levels. [count]
constexpr std::size_t levels_of_choice = 24;

/// A path of a branch. The node at the end of its first edge identifies its beginning; several
/// paths may have the same beginning.
struct Branch_path
{
  std::vector<std::size_t> nodes; ///< from the node on the parent branch to the tip
  std::vector<double> arc;        ///< length from the beginning to each node [L]
  struct Child
  {
    std::size_t start;    ///< node at the end of the first edge
    std::size_t position; ///< index in `nodes`
  };
  std::vector<Child> children; ///< by position, then longest first
  bool is_continued = false;   ///< whether it continues a cut branch, with its radius
  bool is_trunk = false;       ///< whether it begins at the root, without a previous edge
  double length() const { return arc.back(); }
  std::size_t tip() const { return nodes.back(); }
};

/// All candidate paths of a matching. `paths_of[v]`: paths that begin with the edge to `v`, longest
/// first; for the root, the trunks.
struct Branch_paths
{
  std::vector<Branch_path> paths;
  std::vector<std::vector<std::size_t>> paths_of;
  std::vector<std::size_t> other_trunks; ///< for a second search, including much shorter trunks
  /// For a second search: the paths of each limb by its beginning, with more candidates.
  std::vector<std::pair<std::size_t, std::vector<std::size_t>>> limbs;
};

namespace internal {

/// Follows the longest continuation from the last of `nodes`.
inline void follow_longest(const Rooted_tree& tree, std::vector<std::size_t>& nodes)
{
  for (std::size_t v = nodes.back(); tree.first_child[v] < tree.first_child[v + 1];) {
    v = tree.children[tree.first_child[v]];
    nodes.push_back(v);
  }
}

inline Branch_path make_path(const Rooted_tree& tree, std::vector<std::size_t> nodes, bool is_trunk)
{
  Branch_path path;
  path.is_trunk = is_trunk;
  path.nodes = std::move(nodes);
  path.arc.push_back(0);
  for (std::size_t k = 1; k < path.nodes.size(); ++k)
    path.arc.push_back(path.arc.back() + tree.edge_length(path.nodes[k]));
  // other children of the first node belong to the parent branch, unless there is none
  for (std::size_t k = is_trunk ? 0 : 1; k < path.nodes.size(); ++k)
    for (std::size_t c = tree.first_child[path.nodes[k]]; c < tree.first_child[path.nodes[k] + 1];
         ++c)
      if (k + 1 == path.nodes.size() || tree.children[c] != path.nodes[k + 1])
        path.children.push_back({tree.children[c], k});
  return path;
}

/// Returns the longest path from `start`, and others that leave it at forks with nearly equal
/// continuations.
inline std::vector<std::vector<std::size_t>> candidate_paths(const Rooted_tree& tree,
                                                             std::size_t start,
                                                             double fork_ratio,
                                                             std::size_t maximal_number)
{
  std::vector<std::size_t> longest;
  if (tree.parents[start] != none)
    longest.push_back(tree.parents[start]);
  longest.push_back(start);
  follow_longest(tree, longest);
  std::vector<std::pair<double, std::vector<std::size_t>>> others; // lost length, path
  double total = 0;
  for (std::size_t k = 1; k < longest.size(); ++k)
    total += tree.edge_length(longest[k]);
  for (std::size_t k = 0; k + 1 < longest.size() && maximal_number > 1; ++k) {
    const std::size_t v = longest[k];
    if (v != start && k == 0)
      continue; // the node on the parent branch
    const double rest = tree.heights[v];
    const double most_lost = std::max((1 - fork_ratio) * rest, tip_share * total);
    for (std::size_t c = tree.first_child[v] + 1; c < tree.first_child[v + 1]; ++c) {
      const std::size_t w = tree.children[c];
      const double length = tree.edge_length(w) + tree.heights[w];
      if (rest - length > most_lost)
        break;
      std::vector<std::size_t> path(longest.begin(),
                                    longest.begin() + static_cast<std::ptrdiff_t>(k + 1));
      path.push_back(w);
      follow_longest(tree, path);
      others.emplace_back(rest - length, std::move(path));
    }
  }
  std::stable_sort(others.begin(), others.end(), [](const auto& a, const auto& b) {
    return a.first < b.first;
  });
  std::vector<std::vector<std::size_t>> result{longest};
  for (std::size_t i = 0; i < others.size() && result.size() < maximal_number; ++i)
    result.push_back(std::move(others[i].second));
  return result;
}

} // namespace internal

/// Finds at most `maximal_number` candidate paths per branch (`trunk_factor` times as many for the
/// trunk); 1 gives the longest paths only. The fork ratio of the trunk is `fork_ratio` or
/// `trunk_ratio`, whichever is smaller [-]. If `other_ratio` is smaller than both [-],
/// `other_trunks` are the trunks with this fork ratio. There are no `limbs` if `fork_ratio` or
/// `maximal_number` is 1.
inline Branch_paths find_branch_paths(const Rooted_tree& tree,
                                      double fork_ratio,
                                      std::size_t maximal_number,
                                      double trunk_ratio,
                                      double other_ratio = 1)
{
  Branch_paths result;
  result.paths_of.resize(tree.size());
  const std::vector<std::size_t> level = internal::levels_of_branches(tree);
  std::vector<std::size_t> starts{0};
  std::vector<char> is_found(tree.size(), 0);
  is_found[0] = 1;
  while (!starts.empty()) {
    const std::size_t start = starts.back();
    starts.pop_back();
    const std::size_t most = level[start] > levels_of_choice    ? 1
                             : maximal_number > 1 && start == 0 ? trunk_factor * maximal_number
                                                                : maximal_number;
    const double ratio = start == 0 ? std::min(trunk_ratio, fork_ratio) : fork_ratio;
    const auto add = [&](std::vector<std::size_t>&& nodes) {
      result.paths.push_back(internal::make_path(tree, std::move(nodes), start == 0));
      for (const Branch_path::Child& child : result.paths.back().children)
        if (!is_found[child.start]) {
          is_found[child.start] = 1;
          starts.push_back(child.start);
        }
      return result.paths.size() - 1;
    };
    std::vector<std::size_t>& paths = result.paths_of[start];
    for (auto& nodes : internal::candidate_paths(tree, start, ratio, most))
      paths.push_back(add(std::move(nodes)));
    const auto add_new = [&](std::vector<std::size_t>&& nodes) {
      const auto& known = result.paths_of[start];
      const auto same = std::find_if(known.begin(), known.end(), [&](std::size_t p) {
        return result.paths[p].nodes == nodes;
      });
      return same == known.end() ? add(std::move(nodes)) : *same;
    };
    if (start == 0 && maximal_number > 1 && other_ratio < ratio)
      for (auto& nodes : internal::candidate_paths(tree, start, other_ratio, most))
        result.other_trunks.push_back(add_new(std::move(nodes)));
    if (start != 0 && most > 1 && ratio < 1 &&
        tree.weights[start] + tree.edge_length(start) > limb_share * tree.weights[0]) {
      std::vector<std::size_t> more;
      for (auto& nodes :
           internal::candidate_paths(tree, start, limb_ratio * ratio, limb_factor * most))
        more.push_back(add_new(std::move(nodes)));
      result.limbs.emplace_back(start, std::move(more));
    }
  }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_BRANCH_PATHS_H

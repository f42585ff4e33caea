// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Common topology of any number of trees, by repeated matching to a reference tree.

#ifndef PCS_SHAPE_SPACE_FAMILY_SHARED_TOPOLOGY_BUILDER_H
#define PCS_SHAPE_SPACE_FAMILY_SHARED_TOPOLOGY_BUILDER_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/family/Shared_topology.h>
#include <pcs/shape_space/family/canonical_order.h>
#include <pcs/shape_space/matching/build_topology.h>
#include <pcs/shape_space/model/Common_topology.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {
/*!
  Builds the topology of any number of trees by matching them to a reference tree. The first round
  begins with the branches of the most ordinary tree. Each further tree is matched to the mean of
  the previous trees and adds its unmatched branches. In further rounds, all trees are matched to
  the median tree of the previous round. The order of input has no influence: trees are taken in a
  canonical order.
*/
template <class ConcurrencyTag>
class Shared_topology_builder
{
public:
  Shared_topology_builder(std::vector<const Rooted_tree*> trees,
                          const Matching_weights& weights,
                          std::size_t number_of_rounds)
    : m_trees(std::move(trees)), m_weights(weights), m_number_of_rounds(number_of_rounds)
  {
    for (const Rooted_tree* tree : m_trees)
      m_paths.push_back(Branch_matching<ConcurrencyTag>::find_paths(*tree, weights));
  }

  /// Returns `false` when `progress` asks to stop.
  bool run(pcs::internal::Progress& progress)
  {
    const std::vector<std::size_t> order = internal::canonical_order(m_trees);
    const auto total = static_cast<double>(m_number_of_rounds * m_trees.size());
    double done = 0;
    for (std::size_t round = 0; round < m_number_of_rounds; ++round) {
      if (round > 0)
        begin_round();
      const std::size_t step = round > 0 ? batch : 1;
      for (std::size_t first = 0; first < order.size(); first += step) {
        const std::size_t n = std::min(step, order.size() - first);
        std::vector<std::shared_ptr<const Matched_branch>> trunks(n);
        for (std::size_t begin = 0; begin < n; begin += at_once) {
          if (!progress((done + static_cast<double>(begin)) / total))
            return false;
          if (!m_branches.empty())
            pcs::internal::for_each_index<ConcurrencyTag>(
                std::min(at_once, n - begin),
                [&](std::size_t k) {
                  trunks[begin + k] = match(order[first + begin + k], round > 0);
                },
                1);
        }
        for (std::size_t k = 0; k < n; ++k)
          add_tree(order[first + k], trunks[k].get(), round == 0);
        done += static_cast<double>(n);
      }
      end_round();
    }
    return !progress.is_cancelled();
  }

  /// Matches one more tree to a given reference tree; unmatched branches of the tree are left out.
  /// Returns the fraction of the length of the tree that is represented. [-]
  double project(const Rooted_tree& tree,
                 const Reference_tree& reference,
                 std::vector<Shared_branch>& branches,
                 Branch_paths& paths)
  {
    m_trees.assign(1, &tree);
    m_reference = reference;
    m_paths.assign(1, Branch_matching<ConcurrencyTag>::find_paths(tree, m_weights));
    const auto trunk = match(0, false);
    m_branches = branches;
    for (Shared_branch& b : m_branches)
      clear(b);
    m_do_extend = false;
    add_match(*trunk, 0, 0);
    branches = std::move(m_branches);
    paths = m_paths[0];
    double length = 0;
    for (const Shared_branch& b : branches)
      if (b.has(0))
        length += paths.paths[b.path[0]].length();
    return length / tree.weights[0];
  }

  std::vector<Shared_branch>& branches() { return m_branches; }
  std::vector<Branch_paths>& paths() { return m_paths; }
  const Orl_coordinates& reference() const { return m_x; }
  /// Returns the fraction of the branches of all trees whose match differs between the last two
  /// rounds. [-]
  double fraction_of_changed_matches() const { return m_fraction_of_changed_matches; }

private:
  void clear(Shared_branch& b) const
  {
    b.path.assign(m_trees.size(), none);
    b.node.assign(m_trees.size(), {});
    b.attachment.assign(m_trees.size(), 0);
  }

  /// Sets the number of edges of each branch to the largest that a member needs, and resamples the
  /// reference tree.
  void begin_round()
  {
    const Reference_tree old = make_reference(make_layout(m_branches), m_x);
    std::vector<Shared_branch> as_tree = m_branches; // the reference tree as the only member
    for (std::size_t b = 0; b < m_branches.size(); ++b) {
      Shared_branch& branch = m_branches[b];
      branch.number_of_edges = 1;
      for (std::size_t t = 0; t < m_trees.size(); ++t)
        if (branch.has(t))
          branch.number_of_edges =
              std::max(branch.number_of_edges,
                       number_of_straight_edges(*m_trees[t], m_paths[t].paths[branch.path[t]]));
      Shared_branch& own = as_tree[b];
      own.number_of_edges = branch.number_of_edges;
      own.path = {b};
      own.node = {uniform(branch.number_of_edges)};
      own.attachment = {0};
    }
    for (const Branch_path& path : old.paths.paths)
      for (const Branch_path::Child& child : path.children) {
        const std::size_t b = static_cast<std::size_t>(&path - old.paths.paths.data());
        const std::size_t c = old.paths.paths_of[child.start].front();
        as_tree[c].attachment[0] =
            node_number(as_tree[b].node[0], path.arc[child.position] / path.length());
        as_tree[c].reference_edge = m_branches[c].reference_edge =
            edge_before(as_tree[c].attachment[0], m_branches[b].number_of_edges);
      }
    const Orl_layout layout = make_layout(m_branches);
    internal::Embedding x = internal::embed(layout, as_tree, old.tree, old.paths, 0, Vec3::Zero());
    internal::set_frames(layout, Quaternion::Identity(), x);
    internal::set_own_orientations(layout, Orl_orientation::gauge_fixed, x);
    m_x = std::move(x.x);
    m_last_members = m_branches;
    m_reference = make_reference(layout, m_x);
    for (Shared_branch& b : m_branches)
      clear(b);
  }

  static std::size_t edge_before(double attachment, std::size_t n)
  {
    return internal::edge_before(attachment, n);
  }
  static double node_number(const std::vector<double>& node, double s)
  {
    return internal::node_number(node, s);
  }

  static std::vector<double> uniform(std::size_t n)
  {
    std::vector<double> result(n + 1);
    for (std::size_t k = 0; k <= n; ++k)
      result[k] = static_cast<double>(k) / static_cast<double>(n);
    return result;
  }

  static constexpr std::size_t batch = 16;  // trees per update of the topology
  static constexpr std::size_t at_once = 4; // trees per call of the callback

  /// Number of pairs of trunks to match [count]. With the number for two trees, these pairs would
  /// take most of the time.
  static constexpr std::size_t number_of_trunk_trials = 4;

  /// Matches tree `t`. The result is never null, as the trunks are always matched.
  /// `is_trunk_known`: the trunk of the last round is kept.
  std::shared_ptr<const Matched_branch> match(std::size_t t, bool is_trunk_known) const
  {
    pcs::internal::Progress none_wanted;
    using Matching = Branch_matching<ConcurrencyTag>;
    Matching matching(m_reference.tree,
                      *m_trees[t],
                      m_weights,
                      {m_reference.paths, Matching::find_paths(*m_trees[t], m_weights)});
    matching.set_number_of_trunk_trials(number_of_trunk_trials);
    if (is_trunk_known && m_last_members[0].has(t))
      matching.set_second_trunk(m_last_members[0].path[t]);
    return matching.run(none_wanted);
  }

  void add_tree(std::size_t t, const Matched_branch* trunk, bool is_first_round)
  {
    const std::size_t before = m_branches.size();
    std::vector<std::size_t> counts;
    for (const Shared_branch& b : m_branches)
      counts.push_back(b.number_of_members());
    if (trunk)
      add_match(*trunk, t, 0);
    else
      add_single(t, 0, none, 0);
    if (!is_first_round && m_branches.size() == before)
      return;
    // updates the reference tree: running means in the first round, later only new branches
    const Orl_layout layout = make_layout(m_branches);
    internal::Embedding tree =
        internal::embed(layout, m_branches, *m_trees[t], m_paths[t], t, Vec3::Zero());
    if (before == 0)
      internal::set_frames(layout, Quaternion::Identity(), tree);
    else {
      const std::vector<Shared_branch> known(m_branches.begin(),
                                             m_branches.begin() +
                                                 static_cast<std::ptrdiff_t>(before));
      internal::Embedding middle = internal::as_embedding(make_layout(known), m_x);
      middle.x.length.resize(layout.number_of_edges(), 0);
      middle.frame.resize(layout.number_of_edges(), Quaternion::Identity());
      middle.direction.resize(layout.number_of_edges(), Vec3::Zero());
      internal::turn_frames(layout, middle, Quaternion::Identity(), tree);
    }
    internal::set_own_orientations(layout, Orl_orientation::gauge_fixed, tree);
    if (before == 0)
      m_x = tree.x;
    else
      blend(layout, tree.x, t, counts, is_first_round);
    if (is_first_round)
      m_reference = make_reference(layout, m_x);
  }

  void blend(const Orl_layout& layout,
             const Orl_coordinates& tree,
             std::size_t t,
             const std::vector<std::size_t>& counts,
             bool is_mean)
  {
    const std::size_t n = layout.number_of_edges(), m = m_branches.size();
    m_x.orientation.resize(n);
    m_x.length.resize(n);
    m_x.radius.resize(n);
    m_x.base_radius.resize(m);
    m_x.attachment.resize(m);
    for (std::size_t b = 0; b < m; ++b) {
      const std::size_t count = b < counts.size() ? counts[b] : 0;
      if (!m_branches[b].has(t) || (b < counts.size() && !is_mean))
        continue;
      const double f = 1 / static_cast<double>(count + 1);
      const auto mix = [&](double& a, double x) { a = count == 0 ? x : (1 - f) * a + f * x; };
      mix(m_x.base_radius[b], tree.base_radius[b]);
      mix(m_x.attachment[b], tree.attachment[b]);
      const std::size_t first = layout.branches[b].first_edge;
      for (std::size_t e = first; e < first + layout.branches[b].number_of_edges; ++e) {
        mix(m_x.length[e], tree.length[e]);
        mix(m_x.radius[e], tree.radius[e]);
        m_x.orientation[e] = count == 0
                                 ? tree.orientation[e]
                                 : orientation_at(m_x.orientation[e], tree.orientation[e], f, 0.0);
      }
    }
  }

  void end_round()
  {
    count_changes();
    // removes branches without members; their subtrees have none either
    std::vector<std::size_t> number(m_branches.size(), none);
    std::vector<Shared_branch> kept;
    const Orl_layout old = make_layout(m_branches);
    Orl_coordinates x;
    x.root = m_x.root;
    for (std::size_t b = 0; b < m_branches.size(); ++b) {
      if (m_branches[b].number_of_members() == 0)
        continue;
      number[b] = kept.size();
      kept.push_back(m_branches[b]);
      if (kept.back().parent != none)
        kept.back().parent = number[kept.back().parent];
      x.base_radius.push_back(m_x.base_radius[b]);
      x.attachment.push_back(m_x.attachment[b]);
      const std::size_t first = old.branches[b].first_edge;
      for (std::size_t e = first; e < first + m_branches[b].number_of_edges; ++e) {
        x.orientation.push_back(m_x.orientation[e]);
        x.length.push_back(m_x.length[e]);
        x.radius.push_back(m_x.radius[e]);
      }
    }
    m_branches = std::move(kept);
    m_last_members.clear();
    m_x = embed_trees<ConcurrencyTag>(make_layout(m_branches),
                                      m_branches,
                                      m_trees,
                                      m_paths,
                                      x,
                                      Orl_orientation::gauge_fixed,
                                      Virtual_direction::of_partner)
              .reference;
  }

  void count_changes()
  {
    if (m_last_members.empty())
      return;
    double changed = 0, all = 0;
    for (std::size_t b = 0; b < m_branches.size(); ++b)
      for (std::size_t t = 0; t < m_trees.size(); ++t)
        if (m_branches[b].has(t)) {
          ++all;
          changed += b < m_last_members.size() && m_last_members[b].path[t] == m_branches[b].path[t]
                         ? 0
                         : 1;
        }
    m_fraction_of_changed_matches = changed / std::max(1.0, all);
  }

  /// Adds a branch of the reference tree and one of tree `t` as a pair, with their subtrees.
  void add_match(const Matched_branch& match, std::size_t t, double attachment)
  {
    const std::size_t b = match.path_1;
    const Branch_path& middle = m_reference.paths.paths[b];
    const Branch_path& own = m_paths[t].paths[match.path_2];
    const std::size_t n = m_matcher.number_of_samples();
    m_matcher(sample_curve(m_reference.tree, middle, n),
              sample_curve(*m_trees[t], own, n),
              match.rotation);
    const std::vector<double> gamma = m_matcher.gamma();
    std::vector<std::pair<internal::Place_pair, double>> forks;
    for (const Matched_branch::Pair& pair : match.pairs) {
      const double x = middle.arc[middle.children[pair.child_1].position] / middle.length();
      const double y = own.arc[own.children[pair.child_2].position] / own.length();
      const Branch_path& c = m_reference.paths.paths[pair.branch->path_1];
      const Branch_path& d = m_paths[t].paths[pair.branch->path_2];
      if (std::abs(value_at(gamma, x) - y) < fork_tolerance)
        forks.push_back({{x, y}, std::min(c.length(), d.length())});
    }
    const internal::Warp warp(gamma, internal::heaviest_chain(std::move(forks)));
    {
      Shared_branch& branch = m_branches[b];
      branch.path[t] = match.path_2;
      branch.attachment[t] = attachment;
      std::vector<double> node;
      for (const double s : m_reference.share[b])
        node.push_back(warp.forward(s));
      make_increasing(node);
      branch.node[t] = std::move(node);
    }
    const std::vector<double> node = m_branches[b].node[t]; // a copy: branches may move
    const auto place = [&](std::size_t child) {
      return node_number(node, own.arc[own.children[child].position] / own.length());
    };
    std::vector<char> is_matched(own.children.size(), 0);
    for (const Matched_branch::Pair& pair : match.pairs) {
      is_matched[pair.child_2] = 1;
      add_match(*pair.branch, t, place(pair.child_2));
    }
    for (std::size_t c = 0; m_do_extend && c < own.children.size(); ++c)
      if (!is_matched[c])
        add_single(t, own.children[c].start, b, place(c));
  }

  /// Makes the positions increase from 0 to 1: rounding must not fold the branch.
  static void make_increasing(std::vector<double>& node)
  {
    const std::size_t n = node.size() - 1;
    constexpr double least = 1e-6;
    node[0] = 0;
    node[n] = 1;
    for (std::size_t k = 1; k < n; ++k)
      node[k] = std::max(node[k], node[k - 1] + least);
    for (std::size_t k = n; k-- > 1;)
      node[k] = std::min(node[k], node[k + 1] - least);
  }

  /// Adds an unmatched branch with its subtree.
  void add_single(std::size_t t, std::size_t start, std::size_t parent, double attachment)
  {
    const std::size_t id = m_branches.size();
    const std::size_t p = m_paths[t].paths_of[start].front();
    const Branch_path& own = m_paths[t].paths[p];
    Shared_branch branch;
    clear(branch);
    branch.parent = parent;
    branch.number_of_edges = number_of_straight_edges(*m_trees[t], own);
    if (parent != none)
      branch.reference_edge = edge_before(attachment, m_branches[parent].number_of_edges);
    branch.path[t] = p;
    branch.node[t] = uniform(branch.number_of_edges);
    branch.attachment[t] = attachment;
    const std::vector<double> node = branch.node[t];
    m_branches.push_back(std::move(branch));
    for (const Branch_path::Child& child : own.children)
      add_single(t, child.start, id, node_number(node, own.arc[child.position] / own.length()));
  }

  std::vector<const Rooted_tree*> m_trees;
  Matching_weights m_weights;
  std::size_t m_number_of_rounds;
  std::vector<Branch_paths> m_paths;
  std::vector<Shared_branch> m_branches, m_last_members;
  Orl_coordinates m_x; // of the reference tree
  Reference_tree m_reference;
  Elastic_matcher m_matcher{65, 6};
  bool m_do_extend = true;
  double m_fraction_of_changed_matches = 0;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_SHARED_TOPOLOGY_BUILDER_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Common topology of two trees from matched branches.

#ifndef PCS_SHAPE_SPACE_MATCHING_BUILD_TOPOLOGY_H
#define PCS_SHAPE_SPACE_MATCHING_BUILD_TOPOLOGY_H

#include <pcs/shape_space/matching/Branch_matching.h>
#include <pcs/shape_space/model/Common_topology.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Nodes of the two trees closer than this fraction of a branch are merged. This and the
/// following numbers are not round, so that rounding does not decide in trees with round
/// coordinates. [-]
constexpr double node_tolerance = 0.010001;
/// Corresponding forks may shift the elastic correspondence of their parents by at most this
/// fraction of the branch. [-]
constexpr double fork_tolerance = 0.100001;
/// Largest ratio of the relative distances of two such forks on the two branches. [-]
constexpr double steepest_forks = 5.00001;

namespace internal {

/// Corresponding positions on two branches, from (0, 0) to (1, 1). [-]
struct Place_pair
{
  double a, b;
};

/// Returns the heaviest chain of pairs that increases in both positions, with slopes up to
/// `steepest_forks`.
inline std::vector<Place_pair> heaviest_chain(std::vector<std::pair<Place_pair, double>> pairs)
{
  std::sort(pairs.begin(), pairs.end(), [](const auto& x, const auto& y) {
    return x.first.a != y.first.a ? x.first.a < y.first.a : x.first.b < y.first.b;
  });
  const auto fits = [](const Place_pair& x, const Place_pair& y) {
    const double da = y.a - x.a, db = y.b - x.b;
    return da > 1e-6 && db > 1e-6 && da < steepest_forks * db && db < steepest_forks * da;
  };
  const std::size_t n = pairs.size();
  std::vector<double> best(n, -1);
  std::vector<std::size_t> previous(n, none);
  std::size_t last = none;
  for (std::size_t i = 0; i < n; ++i) {
    if (!fits({0, 0}, pairs[i].first) || !fits(pairs[i].first, {1, 1}))
      continue;
    best[i] = pairs[i].second;
    for (std::size_t j = 0; j < i; ++j)
      if (best[j] >= 0 && fits(pairs[j].first, pairs[i].first) &&
          best[j] + pairs[i].second > best[i]) {
        best[i] = best[j] + pairs[i].second;
        previous[i] = j;
      }
    if (last == none || best[i] > best[last])
      last = i;
  }
  std::vector<Place_pair> chain{{1, 1}};
  for (; last != none; last = previous[last])
    chain.push_back(pairs[last].first);
  chain.push_back({0, 0});
  std::reverse(chain.begin(), chain.end());
  return chain;
}

/// The elastic correspondence, adjusted to pass through the anchors.
class Warp
{
public:
  Warp(std::vector<double> gamma, std::vector<Place_pair> anchors)
    : m_gamma(std::move(gamma)), m_anchors(std::move(anchors))
  {
  }

  double forward(double a) const
  {
    const std::size_t k = piece(a, [](const Place_pair& p) { return p.a; });
    const Place_pair &p = m_anchors[k], &q = m_anchors[k + 1];
    const double g0 = value_at(m_gamma, p.a), g1 = value_at(m_gamma, q.a);
    return p.b + (q.b - p.b) * (value_at(m_gamma, a) - g0) / (g1 - g0);
  }
  double backward(double b) const
  {
    const std::size_t k = piece(b, [](const Place_pair& p) { return p.b; });
    const Place_pair &p = m_anchors[k], &q = m_anchors[k + 1];
    const double g0 = value_at(m_gamma, p.a), g1 = value_at(m_gamma, q.a);
    const double a = inverse_at(m_gamma, g0 + (g1 - g0) * (b - p.b) / (q.b - p.b));
    return std::min(q.a, std::max(p.a, a));
  }
  const std::vector<Place_pair>& anchors() const { return m_anchors; }

private:
  template <class Get>
  std::size_t piece(double x, const Get& get) const
  {
    std::size_t k = 0;
    while (k + 2 < m_anchors.size() && get(m_anchors[k + 1]) < x)
      ++k;
    return k;
  }
  std::vector<double> m_gamma;
  std::vector<Place_pair> m_anchors;
};

/// Collects all nodes of both branches and the anchors, with their corresponding positions; close
/// nodes of different trees are merged.
inline std::vector<Place_pair>
common_nodes(const Branch_path& one, const Branch_path& two, const Warp& warp)
{
  struct Candidate
  {
    Place_pair place;
    int kind; // 0, 1: node of that tree; 2: anchor
  };
  std::vector<Candidate> all;
  for (const Place_pair& p : warp.anchors())
    all.push_back({p, 2});
  const auto is_anchor = [&](double x, bool is_first) {
    for (const Place_pair& p : warp.anchors())
      if (std::abs((is_first ? p.a : p.b) - x) < 1e-9)
        return true;
    return false;
  };
  for (const double arc : one.arc)
    if (const double a = arc / one.length(); !is_anchor(a, true))
      all.push_back({{a, warp.forward(a)}, 0});
  for (const double arc : two.arc)
    if (const double b = arc / two.length(); !is_anchor(b, false))
      all.push_back({{warp.backward(b), b}, 1});
  std::sort(all.begin(), all.end(), [](const Candidate& x, const Candidate& y) {
    return x.place.a + x.place.b != y.place.a + y.place.b
               ? x.place.a + x.place.b < y.place.a + y.place.b
               : x.kind < y.kind;
  });
  std::vector<Place_pair> nodes;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Place_pair p = all[i].place;
    if (i + 1 < all.size() && all[i].kind + all[i + 1].kind == 1 &&
        std::max(all[i + 1].place.a - p.a, all[i + 1].place.b - p.b) < node_tolerance) {
      p = all[i].kind == 0 ? Place_pair{p.a, all[i + 1].place.b}
                           : Place_pair{all[i + 1].place.a, p.b};
      ++i;
    }
    // rounding must not fold the branch
    if (!nodes.empty() && (p.a <= nodes.back().a || p.b <= nodes.back().b)) {
      const bool is_end = all[i].kind == 2 && all[i].place.a == 1;
      if (is_end)
        nodes.back() = p;
      continue;
    }
    nodes.push_back(p);
  }
  return nodes;
}

/// Returns the number of the node before `s`, plus the fraction of the next edge.
inline double node_number(const std::vector<double>& node, double s)
{
  const auto it = std::upper_bound(node.begin(), node.end(), s);
  const auto k = static_cast<std::size_t>(
      std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(node.size()) - 2,
                               std::max<std::ptrdiff_t>(0, it - node.begin() - 1)));
  const double f = std::min(1.0, std::max(0.0, (s - node[k]) / (node[k + 1] - node[k])));
  const double t = static_cast<double>(k) + f;
  const double rounded = std::round(t);
  return std::abs(t - rounded) < 1e-9 ? rounded : t;
}

/// Returns whether no sibling has a longer path to a tip.
inline bool is_longest_child(const Rooted_tree& tree, std::size_t v)
{
  return tree.children[tree.first_child[tree.parents[v]]] == v;
}

class Topology_builder
{
public:
  Topology_builder(const Rooted_tree& tree_1,
                   const Rooted_tree& tree_2,
                   std::array<Branch_paths, 2>& paths)
    : m_trees{&tree_1, &tree_2}, m_paths(paths)
  {
  }

  /// `confidences`: of the matched branches, by their first node in tree 1.
  std::vector<Common_branch> run(const Matched_branch& trunk,
                                 const std::unordered_map<std::size_t, double>& confidences = {})
  {
    m_confidences = &confidences;
    add_pair(trunk, none, 0, 0);
    return std::move(m_branches);
  }

private:
  const Branch_path& path(int t, std::size_t i) const
  {
    return m_paths[static_cast<std::size_t>(t)].paths[i];
  }

  /// Cuts a path at its node `last` and returns the first part; the rest becomes a branch that
  /// begins at the end of the first part.
  std::size_t cut(std::size_t t, std::size_t p, std::size_t last)
  {
    Branch_path head = m_paths[t].paths[p];
    if (last + 1 >= head.nodes.size())
      return p;
    const std::size_t next = head.nodes[last + 1];
    // the longest continuation: paths that differ only beyond the end have the same cost
    std::vector<std::size_t> rest{head.nodes[last], next};
    follow_longest(*m_trees[t], rest);
    head.nodes.resize(last + 1);
    head.arc.resize(last + 1);
    while (!head.children.empty() && head.children.back().position > last)
      head.children.pop_back();
    head.children.push_back({next, last});
    std::vector<std::size_t>& of_rest = m_paths[t].paths_of[next];
    of_rest.insert(of_rest.begin(), m_paths[t].paths.size());
    m_paths[t].paths.push_back(make_path(*m_trees[t], std::move(rest), false));
    m_paths[t].paths.back().is_continued = is_longest_child(*m_trees[t], next);
    m_paths[t].paths.push_back(std::move(head));
    return m_paths[t].paths.size() - 1;
  }

  void add_pair(const Matched_branch& match, std::size_t parent, double attach_1, double attach_2)
  {
    const std::array<std::size_t, 2> paths = {cut(0, match.path_1, match.last[0]),
                                              cut(1, match.path_2, match.last[1])};
    const Branch_path one = path(0, paths[0]), two = path(1, paths[1]); // copies: paths grow
    const std::size_t n = m_matcher.number_of_samples();
    m_matcher(sample_curve(*m_trees[0], one, n), sample_curve(*m_trees[1], two, n), match.rotation);
    const std::vector<double> gamma = m_matcher.gamma();
    std::vector<std::pair<Place_pair, double>> forks;
    for (const Matched_branch::Pair& pair : match.pairs) {
      const double a = one.arc[one.children[pair.child_1].position] / one.length();
      const double b = two.arc[two.children[pair.child_2].position] / two.length();
      const Branch_path& c = path(0, pair.branch->path_1);
      const Branch_path& d = path(1, pair.branch->path_2);
      if (std::abs(value_at(gamma, a) - b) < fork_tolerance)
        forks.push_back({{a, b}, std::min(c.length(), d.length())});
    }
    const Warp warp(gamma, heaviest_chain(std::move(forks)));
    Common_branch branch;
    branch.parent = parent;
    branch.path = paths;
    branch.attachment = {attach_1, attach_2};
    for (const Place_pair& p : common_nodes(one, two, warp)) {
      branch.node[0].push_back(p.a);
      branch.node[1].push_back(p.b);
    }
    if (const auto it = m_confidences->find(one.nodes[parent == none ? 0 : 1]);
        it != m_confidences->end())
      branch.confidence = it->second;
    const std::size_t id = m_branches.size();
    m_branches.push_back(branch);

    std::array<std::vector<char>, 2> is_matched{std::vector<char>(one.children.size(), 0),
                                                std::vector<char>(two.children.size(), 0)};
    for (const Matched_branch::Pair& pair : match.pairs) {
      is_matched[0][pair.child_1] = is_matched[1][pair.child_2] = 1;
      add_pair(*pair.branch,
               id,
               attachment(branch, 0, one, pair.child_1),
               attachment(branch, 1, two, pair.child_2));
    }
    for (int t = 0; t < 2; ++t) {
      const Branch_path& own = t == 0 ? one : two;
      for (std::size_t c = 0; c < own.children.size(); ++c)
        if (!is_matched[static_cast<std::size_t>(t)][c])
          add_single(t, own.children[c].start, id, attachment(branch, t, own, c));
    }
  }

  /// Adds an unmatched branch with its subtree.
  void add_single(int t, std::size_t start, std::size_t parent, double attach)
  {
    const auto i = static_cast<std::size_t>(t);
    const std::size_t id = m_branches.size();
    Common_branch branch;
    branch.parent = parent;
    branch.path[i] = m_paths[i].paths_of[start].front();
    branch.attachment = {attach, attach};
    const Branch_path own = path(t, branch.path[i]);
    for (const double arc : own.arc)
      branch.node[i].push_back(arc / own.length());
    m_branches.push_back(branch);
    for (std::size_t c = 0; c < own.children.size(); ++c)
      add_single(t, own.children[c].start, id, attachment(branch, t, own, c));
  }

  static double
  attachment(const Common_branch& branch, int t, const Branch_path& own, std::size_t c)
  {
    return node_number(branch.node[static_cast<std::size_t>(t)],
                       own.arc[own.children[c].position] / own.length());
  }

  std::array<const Rooted_tree*, 2> m_trees;
  std::array<Branch_paths, 2>& m_paths;
  const std::unordered_map<std::size_t, double>* m_confidences = nullptr;
  Elastic_matcher m_matcher{65, 6};
  std::vector<Common_branch> m_branches;
};

} // namespace internal

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_BUILD_TOPOLOGY_H

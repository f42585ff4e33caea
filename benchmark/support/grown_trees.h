// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Splits a tree into its branches, modifies them to imitate growth, and assembles them again.
// Branches keep their names.

#ifndef PCS_BENCHMARK_SUPPORT_GROWN_TREES_H
#define PCS_BENCHMARK_SUPPORT_GROWN_TREES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/shape_space/model/Branch_paths.h>
#include <support/drawn.h>

#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <set>
#include <vector>

namespace orl_bench {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Vec3 = Eigen::Vector3d;

/// A branch of the decomposition by longest paths.
struct Branch
{
  std::size_t parent = pcs::npos;
  double attachment = 0;    ///< parameter in [0, 1] on the parent
  std::vector<Vec3> points; ///< first and last are base and tip
  std::vector<double> radii;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity(); ///< about the base, relative to the parent's
  double scale = 1;
  bool is_kept = true;
};

inline std::vector<Branch> take_apart(const Tree& graph)
{
  using namespace pcs::shape_space;
  const Rooted_tree tree = make_rooted_tree(graph,
                                            get(&pcs::Tree_node<Kernel>::point, graph),
                                            get(&pcs::Tree_node<Kernel>::radius, graph),
                                            get(boost::vertex_index, graph),
                                            "take_apart()");
  const Branch_paths paths = find_branch_paths(tree, 1, 1, 1);
  std::vector<Branch> result;
  struct Open
  {
    std::size_t path, parent;
    double attachment;
  };
  std::vector<Open> open{{paths.paths_of[0][0], pcs::npos, 0}};
  for (std::size_t k = 0; k < open.size(); ++k) {
    const Open o = open[k];
    const Branch_path& path = paths.paths[o.path];
    Branch branch;
    branch.parent = o.parent;
    branch.attachment = o.attachment;
    for (const std::size_t v : path.nodes) {
      branch.points.push_back(tree.points[v]);
      branch.radii.push_back(tree.radii[v]);
    }
    result.push_back(branch);
    for (const auto& c : path.children)
      open.push_back(
          {paths.paths_of[c.start][0], result.size() - 1, path.arc[c.position] / path.length()});
  }
  return result;
}

struct Growth
{
  double turn;    ///< standard deviation of the angle of turns about random axes [rad]
  double noise;   ///< standard deviation of attachments
  double stretch; ///< standard deviation of the logarithm of lengths
  double pruned;  ///< probability that a branch and its descendants are cut
  double prune;   ///< share of the branches of each order that is cut with its descendants
  double scale;   ///< largest relative change of lengths, all as likely
};

/// Cuts this share of the branches of each order that are left, with their descendants.
template <class Random>
void prune(std::vector<Branch>& branches, double share, Random& random)
{
  std::vector<std::size_t> order(branches.size(), 0);
  std::vector<std::vector<std::size_t>> of_order;
  for (std::size_t b = 1; b < branches.size(); ++b) {
    order[b] = order[branches[b].parent] + 1;
    of_order.resize(std::max(of_order.size(), order[b]));
    of_order[order[b] - 1].push_back(b);
  }
  for (const std::vector<std::size_t>& all : of_order) {
    std::vector<std::size_t> left;
    for (const std::size_t b : all)
      if (branches[branches[b].parent].is_kept && branches[b].is_kept)
        left.push_back(b);
      else
        branches[b].is_kept = false;
    const auto cut = static_cast<std::size_t>(share * static_cast<double>(left.size()) + 0.5);
    for (std::size_t k = 0; k < cut; ++k) {
      // a uniform choice, the same with every standard library
      const std::size_t other = k + static_cast<std::size_t>(random() % (left.size() - k));
      std::swap(left[k], left[other]);
      branches[left[k]].is_kept = false;
    }
  }
}

inline std::vector<Branch> grow(std::vector<Branch> branches, const Growth& growth, unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t b = 1; b < branches.size(); ++b) {
    const Vec3 axis = pcs_test::drawn<Vec3>([&] { return normal(random); });
    Branch& branch = branches[b];
    branch.turn =
        Eigen::AngleAxisd(growth.turn * normal(random), axis.normalized()).toRotationMatrix();
    branch.scale = std::exp(growth.stretch * normal(random));
    branch.attachment =
        std::min(1.0, std::max(0.0, branch.attachment + growth.noise * normal(random)));
    branch.is_kept = branches[branch.parent].is_kept && uniform(random) >= growth.pruned;
  }
  if (growth.scale > 0)
    for (std::size_t b = 1; b < branches.size(); ++b)
      branches[b].scale *= 1 + growth.scale * (2 * uniform(random) - 1);
  if (growth.prune > 0)
    prune(branches, growth.prune, random);
  return branches;
}

/// Assembles the graph; `names[v]` is the branch of vertex v.
inline Tree put_together(const std::vector<Branch>& branches, std::vector<std::size_t>& names)
{
  struct Placed
  {
    double share;
    Vec3 point;
    double radius;
    std::size_t vertex;
  };
  const std::size_t n = branches.size();
  std::vector<std::vector<Placed>> placed(n);
  std::vector<Eigen::Matrix3d> turn(n);
  Tree tree;
  names.clear();
  const auto at = [&](std::size_t b, double share) {
    const auto& line = placed[b];
    std::size_t k = 1;
    while (k + 1 < line.size() && line[k].share < share)
      ++k;
    const double width = line[k].share - line[k - 1].share;
    const double f =
        width > 0 ? std::min(1.0, std::max(0.0, (share - line[k - 1].share) / width)) : 0;
    return Placed{share,
                  (1 - f) * line[k - 1].point + f * line[k].point,
                  (1 - f) * line[k - 1].radius + f * line[k].radius,
                  pcs::npos};
  };
  // Positions first, then a vertex for each position and each attachment.
  for (std::size_t b = 0; b < n; ++b) {
    const Branch& branch = branches[b];
    if (!branch.is_kept)
      continue;
    const Placed base =
        b == 0 ? Placed{0, branch.points[0], 0, 0} : at(branch.parent, branch.attachment);
    turn[b] = b == 0 ? branch.turn : Eigen::Matrix3d(turn[branch.parent] * branch.turn);
    double length = 0;
    for (std::size_t k = 0; k < branch.points.size(); ++k) {
      length += k > 0 ? (branch.points[k] - branch.points[k - 1]).norm() : 0;
      placed[b].push_back(
          {length,
           base.point + branch.scale * (turn[b] * (branch.points[k] - branch.points[0])),
           branch.radii[k],
           pcs::npos});
    }
    for (Placed& p : placed[b])
      p.share /= length;
  }
  for (std::size_t b = 1; b < n; ++b)
    if (branches[b].is_kept) {
      auto& line = placed[branches[b].parent];
      const double share = branches[b].attachment;
      const bool is_there = std::any_of(line.begin(), line.end(), [&](const Placed& p) {
        return std::abs(p.share - share) < 1e-9;
      });
      if (!is_there) {
        const Placed p = at(branches[b].parent, share);
        line.insert(std::upper_bound(line.begin(),
                                     line.end(),
                                     share,
                                     [](double s, const Placed& q) { return s < q.share; }),
                    p);
      }
    }
  for (std::size_t b = 0; b < n; ++b) {
    std::size_t last = pcs::npos;
    if (b > 0 && branches[b].is_kept)
      for (const Placed& p : placed[branches[b].parent])
        if (std::abs(p.share - branches[b].attachment) < 1e-9)
          last = p.vertex;
    for (std::size_t k = 0; k < placed[b].size(); ++k) {
      Placed& p = placed[b][k];
      if (k == 0 && b > 0) {
        p.vertex = last; // the node of the parent
        continue;
      }
      pcs::Tree_node<Kernel> node;
      node.point = Kernel::Point_3(p.point.x(), p.point.y(), p.point.z());
      node.radius = p.radius;
      p.vertex = add_vertex(node, tree);
      names.push_back(b);
      if (last != pcs::npos)
        add_edge(last, p.vertex, tree);
      last = p.vertex;
    }
  }
  tree[boost::graph_bundle].root = 0;
  return tree;
}

inline double number_of_names(const std::vector<std::size_t>& names)
{
  return static_cast<double>(std::set<std::size_t>(names.begin(), names.end()).size());
}

} // namespace orl_bench

#endif // PCS_BENCHMARK_SUPPORT_GROWN_TREES_H

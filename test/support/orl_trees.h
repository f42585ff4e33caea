// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random trees of curved branches with known names, their growth, and points on their tubes.

#ifndef PCS_TEST_SUPPORT_ORL_TREES_H
#define PCS_TEST_SUPPORT_ORL_TREES_H

#include <pcs/core/Tree_skeleton.h>
#include <support/drawn.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/range/iterator_range.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace orl_test {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point = Kernel::Point_3;
using Vec3 = Eigen::Vector3d;

inline Vec3 to_eigen(const Point& p)
{
  return Vec3(p.x(), p.y(), p.z());
}
inline Point to_cgal(const Vec3& p)
{
  return Point(p.x(), p.y(), p.z());
}

/// A branch relative to its base; `at` is its node of the parent.
struct Branch
{
  std::size_t parent = pcs::npos, at = 0;
  std::vector<Vec3> points;
  std::vector<double> radii;
};

/// Branch 0 is the trunk. Lengths decrease from order to order, so that the trunk remains the
/// trunk.
inline std::vector<Branch> random_branches(unsigned seed, int children = 6, int orders = 3)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Branch> result;
  const auto make = [&](const Vec3& direction, double length, double radius) {
    Branch b;
    const int n = 10;
    Vec3 d = direction.normalized(), p = Vec3::Zero();
    for (int k = 0; k <= n; ++k) {
      b.points.push_back(p);
      b.radii.push_back(radius * (1 - 0.8 * k / n));
      d = (d + 0.12 * pcs_test::drawn<Vec3>([&] { return normal(random); })).normalized();
      p += length / n * d;
    }
    return b;
  };
  result.push_back(make(Vec3(0, 0, 1), 10, 0.3));
  struct Open
  {
    std::size_t branch;
    double length, radius;
    int order;
  };
  std::vector<Open> open{{0, 10, 0.3, 0}};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Open parent = open[i];
    if (parent.order + 1 >= orders)
      continue;
    for (int c = 0; c < children; ++c) {
      const std::size_t at = static_cast<std::size_t>(2 + c * 7 / children);
      const double azimuth = 2.4 * c + 0.3 * uniform(random);
      const Vec3 axis =
          (result[parent.branch].points[at] - result[parent.branch].points[at - 1]).normalized();
      const Vec3 side = Eigen::AngleAxisd(azimuth, axis) * axis.unitOrthogonal();
      const double share = 1 - static_cast<double>(at) / 10;
      const double length = parent.length * share * (0.45 + 0.3 * uniform(random));
      const double radius = 0.5 * parent.radius * (1 - 0.08 * static_cast<double>(at));
      Branch b = make(axis + side, length, radius);
      b.parent = parent.branch;
      b.at = at;
      result.push_back(b);
      open.push_back({result.size() - 1, length, radius, parent.order + 1});
    }
  }
  return result;
}

/// Rotation of each branch about its base, in the rotated axes of its parent.
using Turns = std::vector<Eigen::Matrix3d>;

/// Assembles the graph; `tip[b]` is the vertex at the tip of branch b, `npos` if it was cut.
inline Tree make_tree(const std::vector<Branch>& branches,
                      const Turns& turns,
                      const std::vector<char>& is_kept,
                      std::vector<std::size_t>& tip,
                      std::vector<std::vector<std::size_t>>* nodes_of = nullptr)
{
  Tree tree;
  std::vector<std::vector<std::size_t>> node(branches.size());
  std::vector<Eigen::Matrix3d> total(branches.size());
  tip.assign(branches.size(), pcs::npos);
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const Branch& branch = branches[b];
    if (!is_kept[b] || (b > 0 && tip[branch.parent] == pcs::npos))
      continue;
    total[b] = b > 0 ? Eigen::Matrix3d(total[branch.parent] * turns[b]) : turns[b];
    std::size_t last = b > 0 ? node[branch.parent][branch.at] : pcs::npos;
    const Vec3 base = b > 0 ? to_eigen(tree[last].point) : Vec3(0, 0, 0);
    for (std::size_t k = 0; k < branch.points.size(); ++k) {
      pcs::Tree_node<Kernel> v;
      v.point = to_cgal(base + total[b] * branch.points[k]);
      v.radius = branch.radii[k];
      const std::size_t id = add_vertex(v, tree);
      if (last != pcs::npos)
        add_edge(last, id, tree);
      last = id;
      node[b].push_back(id);
    }
    tip[b] = last;
  }
  tree[boost::graph_bundle].root = 0;
  if (nodes_of)
    *nodes_of = node;
  return tree;
}

inline Tree make_tree(const std::vector<Branch>& branches)
{
  std::vector<std::size_t> tip;
  return make_tree(branches,
                   Turns(branches.size(), Eigen::Matrix3d::Identity()),
                   std::vector<char>(branches.size(), 1),
                   tip);
}

inline Tree random_tree(unsigned seed, int children = 6, int orders = 3)
{
  return make_tree(random_branches(seed, children, orders));
}

/// Samples points uniformly over the tubes of all edges with a positive length. Calls `place(u, v,
/// s, off)` for random parameters `s` along edges, at `off` from their axes.
template <class Place>
std::vector<Point> sample_tubes(const Tree& tree, std::size_t n, unsigned seed, const Place& place)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> sum;
  std::vector<std::pair<std::size_t, std::size_t>> ends;
  double total = 0;
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const std::size_t u = source(e, tree), v = target(e, tree);
    const double length = (to_eigen(tree[v].point) - to_eigen(tree[u].point)).norm();
    if (length <= 0)
      continue;
    total += length * (tree[u].radius + tree[v].radius);
    sum.push_back(total);
    ends.emplace_back(u, v);
  }
  std::vector<Point> result;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = (static_cast<double>(i) + uniform(random)) / static_cast<double>(n) * total;
    const auto k = std::min<std::size_t>(
        ends.size() - 1,
        static_cast<std::size_t>(std::lower_bound(sum.begin(), sum.end(), x) - sum.begin()));
    const auto &a = tree[ends[k].first], &b = tree[ends[k].second];
    const Vec3 axis = to_eigen(b.point) - to_eigen(a.point);
    const Vec3 e1 = axis.unitOrthogonal(), e2 = axis.normalized().cross(e1);
    const double s = uniform(random), angle = 2 * CGAL_PI * uniform(random);
    const double r = (1 - s) * a.radius + s * b.radius;
    const Vec3 off = r * (std::cos(angle) * e1 + std::sin(angle) * e2);
    result.push_back(to_cgal(place(ends[k].first, ends[k].second, s, off)));
  }
  return result;
}

/// Samples tubes that are as long as their edges.
inline std::vector<Point> tube_points(const Tree& tree, std::size_t n, unsigned seed)
{
  return sample_tubes(tree, n, seed, [&](std::size_t u, std::size_t v, double s, const Vec3& off) {
    const Vec3 from = to_eigen(tree[u].point), axis = to_eigen(tree[v].point) - from;
    return Vec3(from + s * axis + off);
  });
}

/// Samples tubes that end at the bisecting plane of consecutive edges. The surface is closed on the
/// outer side of bends, and overlaps on the inner side.
inline std::vector<Point> whole_tube_points(const Tree& tree, std::size_t n, unsigned seed)
{
  std::vector<std::vector<Vec3>> into(num_vertices(tree)), out_of(num_vertices(tree));
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const std::size_t u = source(e, tree), v = target(e, tree);
    const Vec3 axis = to_eigen(tree[v].point) - to_eigen(tree[u].point);
    if (axis.norm() > 0) {
      into[v].push_back(axis.normalized());
      out_of[u].push_back(into[v].back());
    }
  }
  // Extension of the tube beyond an end of its edge, at `off` from the axis.
  const auto reach = [&](std::size_t v, const Vec3& direction, const Vec3& off) {
    if (into[v].size() != 1 || out_of[v].size() != 1)
      return 0.0;
    const Vec3 normal = into[v][0] + out_of[v][0];
    const double up = normal.dot(direction);
    return up > 0.4 ? -normal.dot(off) / up : 0.0;
  };
  return sample_tubes(tree, n, seed, [&](std::size_t u, std::size_t v, double s, const Vec3& off) {
    const Vec3 from = to_eigen(tree[u].point), axis = to_eigen(tree[v].point) - from;
    const Vec3 direction = axis.normalized();
    const double begin = std::min(0.0, reach(u, direction, off));
    const double end = std::max(0.0, reach(v, direction, off)) + axis.norm();
    return Vec3(from + (begin + s * (end - begin)) * direction + off);
  });
}

/// The rotated and shifted tree.
inline Tree moved(const Tree& tree, const Eigen::Matrix3d& r, const Vec3& shift, double scale = 1)
{
  Tree result = tree;
  for (const auto v : boost::make_iterator_range(vertices(tree))) {
    result[v].point = to_cgal(scale * (r * to_eigen(tree[v].point)) + shift);
    result[v].radius = scale * tree[v].radius;
  }
  return result;
}

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_ORL_TREES_H

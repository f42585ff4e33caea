// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Clouds for tests of tree skeletons, and the invariants of every skeleton.

#ifndef PCS_TEST_SUPPORT_TREE_CLOUDS_H
#define PCS_TEST_SUPPORT_TREE_CLOUDS_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/number_utils.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace pcs_test {

using Tree_kernel = CGAL::Simple_cartesian<double>;
using Tree_point = Tree_kernel::Point_3;
using Tree_vector = Tree_kernel::Vector_3;
using Tree = pcs::Tree_skeleton<Tree_kernel>;

/// A small tree, scanned from four sides: some 10,000 points.
struct Small_scan
{
  Tree truth;
  pcs::Virtual_scan<Tree_kernel> scan;

  Small_scan()
  {
    pcs::grow_tree(truth, pcs::fruit_habit(), pcs::parameters::random_seed(5));
    pcs::Virtual_scanner scanner;
    scanner.angular_step = 0.1 * CGAL_PI / 180;
    pcs::scan_tree(truth, scan, scanner, pcs::parameters::random_seed(6));
  }
};

inline const Small_scan& small_scan()
{
  static const Small_scan scan;
  return scan;
}

/// `n` points uniform over a cylinder without caps.
inline std::vector<Tree_point> cylinder(std::size_t n,
                                        double radius,
                                        double height,
                                        const Tree_point& base = Tree_point(0, 0, 0),
                                        const Tree_vector& along = Tree_vector(0, 0, 1))
{
  const Tree_vector e3 = along / std::sqrt(along.squared_length());
  const Tree_vector other = std::abs(e3.x()) < 0.9 ? Tree_vector(1, 0, 0) : Tree_vector(0, 1, 0);
  Tree_vector e1 = other - (other * e3) * e3;
  e1 = e1 / std::sqrt(e1.squared_length());
  const Tree_vector e2 = CGAL::cross_product(e3, e1);
  std::vector<Tree_point> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.39996322972865332 * double(i);
    points.push_back(base + radius * std::cos(angle) * e1 + radius * std::sin(angle) * e2 +
                     height * (double(i) + 0.5) / double(n) * e3);
  }
  return points;
}

inline void append(std::vector<Tree_point>& points, const std::vector<Tree_point>& others)
{
  points.insert(points.end(), others.begin(), others.end());
}

/// Adds a normally distributed displacement with a standard deviation of `deviation` per axis.
class Jitter
{
public:
  explicit Jitter(double deviation, unsigned seed = 1) : m_random(seed), m_normal(0, deviation) {}
  Tree_point operator()(const Tree_point& p)
  {
    const double x = m_normal(m_random), y = m_normal(m_random), z = m_normal(m_random);
    return p + Tree_vector(x, y, z);
  }
  std::vector<Tree_point> operator()(std::vector<Tree_point> points)
  {
    for (Tree_point& p : points)
      p = (*this)(p);
    return points;
  }

private:
  std::mt19937 m_random;
  std::normal_distribution<double> m_normal;
};

/// `n` points of a rectangle that is upright on the middle of its lower side, or horizontal if `up`
/// is horizontal.
inline std::vector<Tree_point>
sheet(std::size_t n, double width, const Tree_vector& across, const Tree_vector& up, double noise)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  std::vector<Tree_point> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = share(random), b = share(random);
    points.push_back(CGAL::ORIGIN + width * a * across + width * b * up);
  }
  return Jitter(noise)(points);
}

/// Describes the violated invariant of a skeleton; empty if it is valid. Checks one root, one
/// parent of all other nodes, finite numbers, and branches that contain every node once.
inline std::string fault_of(const Tree& tree)
{
  const pcs::Tree_bundle& bundle = tree[boost::graph_bundle];
  if (num_vertices(tree) == 0)
    return "there are no nodes";
  if (bundle.root != 0)
    return "the root is not the first node";
  if (num_edges(tree) + 1 != num_vertices(tree))
    return "the numbers of edges and nodes do not fit";
  std::size_t reached = 0;
  for (const auto& nodes : pcs::nodes_by_branch<Tree_kernel>(tree))
    reached += nodes.size();
  if (reached != num_vertices(tree))
    return "a node is on no branch";
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    const std::string name = "node " + std::to_string(v);
    const auto& node = tree[v];
    if (in_degree(v, tree) != (v == 0 ? 0u : 1u))
      return name + " has another number of parents than one";
    if (!std::isfinite(node.point.x()) || !std::isfinite(node.point.y()) ||
        !std::isfinite(node.point.z()))
      return name + " has no finite position";
    if (!std::isfinite(node.radius) || !(node.radius > 0))
      return name + " has no positive radius";
    if (!std::isfinite(node.radius_error) || node.radius_error < 0)
      return name + " has no finite error";
    if (!(node.major_radius >= node.minor_radius) || !std::isfinite(node.major_radius))
      return name + " has wrong half axes";
    if (node.branch >= bundle.branches.size())
      return name + " is on no branch";
  }
  for (std::size_t b = 0; b < bundle.branches.size(); ++b) {
    const auto& branch = bundle.branches[b];
    if ((branch.parent == pcs::npos) != (b == 0))
      return "branch " + std::to_string(b) + " has a wrong parent";
    if (b > 0 && branch.order != bundle.branches[branch.parent].order + 1)
      return "branch " + std::to_string(b) + " has a wrong order";
  }
  return "";
}

inline void check_is_a_tree(const Tree& tree)
{
  BOOST_TEST(fault_of(tree) == "");
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_TREE_CLOUDS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Length and volume of a tree.

#ifndef PCS_CORE_TREE_MEASURES_H
#define PCS_CORE_TREE_MEASURES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/internal/constants.h>

#include <CGAL/number_utils.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsCoreRef
//! the result of `measure_tree()`
struct Tree_measures
{
  double length = 0; //!< sum over all axes, measured from the axes of their parents [L]
  //! sum of the frusta between nodes; the bases of branches inside their parents count twice [L^3]
  double volume = 0;
  //! sum of the frusta without the bases inside the parents [L^3]
  double union_volume = 0;
};

namespace internal {

/// Measures the edges of a tree, branch by branch.
template <class Kernel>
class Edge_measurer
{
public:
  explicit Edge_measurer(const Tree_skeleton<Kernel>& tree)
    : m_tree(tree), m_nodes(nodes_by_branch<Kernel>(tree))
  {
  }

  Tree_measures operator()()
  {
    for (const std::vector<std::size_t>& branch : m_nodes) {
      bool is_outside = branch.empty() || parent_node<Kernel>(branch[0], m_tree) == npos;
      for (const std::size_t v : branch)
        if (parent_node<Kernel>(v, m_tree) != npos)
          add_edge(v, branch[0], is_outside);
    }
    return m_result;
  }

private:
  struct Vector
  {
    double x, y, z;
    Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
    double operator*(const Vector& o) const { return x * o.x + y * o.y + z * o.z; }
  };

  Vector position(std::size_t v) const
  {
    return {CGAL::to_double(m_tree[v].point.x()),
            CGAL::to_double(m_tree[v].point.y()),
            CGAL::to_double(m_tree[v].point.z())};
  }
  double radius(std::size_t v) const { return CGAL::to_double(m_tree[v].radius); }

  bool is_inside(const Vector& p, const std::vector<std::size_t>& branch) const
  {
    for (std::size_t i = 1; i < branch.size(); ++i) {
      const Vector a = position(branch[i - 1]), d = position(branch[i]) - a, q = p - a;
      const double t = d * d > 0 ? std::clamp(q * d / (d * d), 0.0, 1.0) : 0;
      const Vector across = q - Vector{t * d.x, t * d.y, t * d.z};
      const double r = (1 - t) * radius(branch[i - 1]) + t * radius(branch[i]);
      if (across * across < r * r)
        return true;
    }
    return false;
  }

  /// Adds the edge that ends at node `v`; `base` is the first node of its branch. `is_outside`:
  /// whether the branch has left its parent.
  void add_edge(std::size_t v, std::size_t base, bool& is_outside)
  {
    constexpr int number_of_pieces = 16; // of an edge that crosses the surface of the parent
    const std::size_t p = parent_node<Kernel>(v, m_tree);
    const Vector a = position(p), d = position(v) - a;
    const double to = radius(v), from = m_tree[p].branch == m_tree[v].branch ? radius(p) : to;
    const double length = std::sqrt(d * d);
    const auto frustum = [&](double s, double t) {
      const double r = from + s * (to - from), q = from + t * (to - from);
      return pi / 3 * (t - s) * length * (r * r + r * q + q * q);
    };
    m_result.length += length;
    m_result.volume += frustum(0, 1);
    if (is_outside) {
      m_result.union_volume += frustum(0, 1);
      return;
    }
    const std::size_t parent = m_tree[parent_node<Kernel>(base, m_tree)].branch;
    for (int k = 0; k < number_of_pieces; ++k) {
      const double s = double(k) / number_of_pieces, t = double(k + 1) / number_of_pieces;
      const double m = (s + t) / 2;
      is_outside =
          is_outside || !is_inside({a.x + m * d.x, a.y + m * d.y, a.z + m * d.z}, m_nodes[parent]);
      if (is_outside)
        m_result.union_volume += frustum(s, t);
    }
  }

  const Tree_skeleton<Kernel>& m_tree;
  const std::vector<std::vector<std::size_t>> m_nodes; // by branch
  Tree_measures m_result;
};

} // namespace internal

/*!
  \ingroup PkgPcsCoreRef
  \brief measures the length and the volume of a tree.

  The edge to the first node of a branch is a cylinder with the radius of that branch. A branch
  leaves its parent where the distance between their axes exceeds the radius of the parent.

  \tparam Kernel a kernel of CGAL
  \param tree a tree with branches
  \par Complexity
  Linear in the number of nodes; each base adds a search over the nodes of its parent.
*/
template <class Kernel>
Tree_measures measure_tree(const Tree_skeleton<Kernel>& tree)
{
  return internal::Edge_measurer<Kernel>(tree)();
}

} // namespace pcs

#endif // PCS_CORE_TREE_MEASURES_H

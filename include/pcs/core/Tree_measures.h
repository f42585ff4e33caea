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
  //! sum of the frusta without those bases [L^3]
  double union_volume = 0;
};

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
  struct Vector
  {
    double x, y, z;
    Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
    double operator*(const Vector& o) const { return x * o.x + y * o.y + z * o.z; }
  };
  const auto position = [&](std::size_t v) {
    return Vector{CGAL::to_double(tree[v].point.x()),
                  CGAL::to_double(tree[v].point.y()),
                  CGAL::to_double(tree[v].point.z())};
  };
  const auto radius = [&](std::size_t v) { return CGAL::to_double(tree[v].radius); };
  const auto nodes = nodes_by_branch<Kernel>(tree);

  // whether a point lies inside a branch
  const auto is_inside = [&](const Vector& p, const std::vector<std::size_t>& branch) {
    for (std::size_t i = 1; i < branch.size(); ++i) {
      const Vector a = position(branch[i - 1]), d = position(branch[i]) - a, q = p - a;
      const double t = d * d > 0 ? std::clamp(q * d / (d * d), 0.0, 1.0) : 0;
      const Vector across = q - Vector{t * d.x, t * d.y, t * d.z};
      const double r = (1 - t) * radius(branch[i - 1]) + t * radius(branch[i]);
      if (across * across < r * r)
        return true;
    }
    return false;
  };

  constexpr int number_of_pieces = 16; // of an edge that crosses the surface of the parent
  Tree_measures result;
  for (const std::vector<std::size_t>& branch : nodes) {
    bool is_outside = branch.empty() || parent_node<Kernel>(branch[0], tree) == npos;
    for (const std::size_t v : branch) {
      const std::size_t p = parent_node<Kernel>(v, tree);
      if (p == npos)
        continue;
      const std::size_t carrier = parent_node<Kernel>(branch[0], tree);
      const Vector a = position(p), d = position(v) - a;
      const double from = tree[p].branch == tree[v].branch ? radius(p) : radius(v), to = radius(v);
      const double length = std::sqrt(d * d);
      const auto frustum = [&](double s, double t) {
        const double r = from + s * (to - from), q = from + t * (to - from);
        return pcs::internal::pi / 3 * (t - s) * length * (r * r + r * q + q * q);
      };
      result.length += length;
      result.volume += frustum(0, 1);
      if (is_outside) {
        result.union_volume += frustum(0, 1);
        continue;
      }
      for (int k = 0; k < number_of_pieces; ++k) {
        const double s = double(k) / number_of_pieces, t = double(k + 1) / number_of_pieces;
        const double m = (s + t) / 2;
        is_outside = is_outside || !is_inside({a.x + m * d.x, a.y + m * d.y, a.z + m * d.z},
                                              nodes[tree[carrier].branch]);
        if (is_outside)
          result.union_volume += frustum(s, t);
      }
    }
  }
  return result;
}

} // namespace pcs

#endif // PCS_CORE_TREE_MEASURES_H

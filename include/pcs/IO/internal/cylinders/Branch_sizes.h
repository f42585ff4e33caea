// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sizes and directions of the branches of a tree, in the unit of the tree.

#ifndef PCS_IO_INTERNAL_CYLINDERS_BRANCH_SIZES_H
#define PCS_IO_INTERNAL_CYLINDERS_BRANCH_SIZES_H

#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/constants.h>

#include <CGAL/number_utils.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

struct Branch_size
{
  int order = 0;
  std::size_t parent = npos; ///< index of the parent branch; `npos` for the trunk
  bool is_empty = true;      ///< no node of the tree belongs to the branch
  double diameter = 0;       ///< mean over the first piece [L]
  double volume = 0;         ///< of the frusta between the nodes [L^3]
  double area = 0;           ///< lateral area of the cylinders between the nodes [L^2]
  double length = 0;         ///< [L]
  double height = 0;         ///< of the base above the root [L]
  double angle = 0;          ///< between the first piece and the parent branch [rad]
  double azimuth = 0;        ///< of the first piece, in (-pi, pi] [rad]
  double zenith = 0;         ///< between the first piece and the up direction [rad]
};

/*
  Measures the branches of a tree. A piece is an edge between two nodes of the same branch. The edge
  from the parent branch to the first node of a branch belongs to neither, as in the table of
  cylinders. Azimuths are angles about the up direction, counter-clockwise as seen from above. The
  azimuth of the x axis is 0; if up is nearly parallel to x, that of the y axis is 0. Linear in the
  number of nodes.
*/
template <class Kernel>
class Branch_measurer
{
public:
  using Vector = std::array<double, 3>;

  Branch_measurer(const Tree_skeleton<Kernel>& tree, const Vector& up, const char* caller)
    : m_tree(tree), m_up(up)
  {
    const double norm = length(up);
    if (!(norm > 0) || !std::isfinite(norm))
      throw Invalid_input(std::string("pcs::IO::") + caller +
                          "(): the up direction must be a finite vector, not null");
    for (double& x : m_up)
      x /= norm;
    writing_order(tree, tree[boost::graph_bundle].root, caller); // throws unless it is a tree
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      for (const double x : position(v))
        finite_value(x, "a coordinate", v, caller);
      finite_value(tree[v].radius, "the radius", v, caller);
      if (tree[v].branch >= tree[boost::graph_bundle].branches.size())
        throw Invalid_input(std::string("pcs::IO::") + caller + "(): node " + std::to_string(v) +
                            " belongs to no branch; use assign_branches()");
    }
    m_nodes = nodes_by_branch<Kernel>(tree);
  }

  std::vector<Branch_size> operator()() const
  {
    std::vector<Branch_size> sizes;
    for (std::size_t b = 0; b < m_nodes.size(); ++b)
      sizes.push_back(measure(b));
    return sizes;
  }

  const std::vector<std::size_t>& nodes(std::size_t branch) const { return m_nodes[branch]; }

  double radius(std::size_t v) const { return CGAL::to_double(m_tree[v].radius); }
  //! returns the vector from node `v` to node `w`
  Vector between(std::size_t v, std::size_t w) const
  {
    const Vector a = position(v), b = position(w);
    return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  }
  //! returns the coordinate of a node along the up direction
  double height(std::size_t v) const { return dot(m_up, position(v)); }
  static double length(const Vector& d) { return std::hypot(d[0], d[1], d[2]); }

private:
  Vector position(std::size_t v) const
  {
    const auto& p = m_tree[v].point;
    return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
  }

  static double dot(const Vector& a, const Vector& b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  static double angle(const Vector& a, const Vector& b)
  {
    return std::acos(std::clamp(dot(a, b) / (length(a) * length(b)), -1.0, 1.0));
  }

  double azimuth(const Vector& d) const
  {
    Vector from = std::abs(m_up[0]) < 0.9 ? Vector{1, 0, 0} : Vector{0, 1, 0};
    const double along = dot(from, m_up);
    for (std::size_t k = 0; k < 3; ++k)
      from[k] -= along * m_up[k];
    const Vector left = {m_up[1] * from[2] - m_up[2] * from[1],
                         m_up[2] * from[0] - m_up[0] * from[2],
                         m_up[0] * from[1] - m_up[1] * from[0]};
    return std::atan2(dot(d, left), dot(d, from));
  }

  //! returns the index in `nodes` at which the first piece of positive length ends; 0: none
  std::size_t end_of_first_piece(const std::vector<std::size_t>& nodes) const
  {
    for (std::size_t i = 1; i < nodes.size(); ++i)
      if (length(between(nodes[i - 1], nodes[i])) > 0)
        return i;
    return 0;
  }

  //! returns the direction of a branch at node `v`; null vector if the branch has no length
  Vector direction_at(std::size_t v) const
  {
    const std::size_t branch = m_tree[v].branch;
    for (std::size_t p = parent_node<Kernel>(v, m_tree); p != npos && m_tree[p].branch == branch;
         v = p, p = parent_node<Kernel>(v, m_tree))
      if (const Vector d = between(p, v); length(d) > 0)
        return d;
    const std::vector<std::size_t>& nodes = m_nodes[branch];
    const std::size_t i = end_of_first_piece(nodes);
    return i > 0 ? between(nodes[i - 1], nodes[i]) : Vector{0, 0, 0};
  }

  Branch_size measure(std::size_t b) const
  {
    const Tree_bundle& bundle = m_tree[boost::graph_bundle];
    const std::vector<std::size_t>& nodes = m_nodes[b];
    Branch_size size;
    size.order = bundle.branches[b].order;
    size.parent = bundle.branches[b].parent;
    size.is_empty = nodes.empty();
    if (nodes.empty())
      return size;
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      const double l = length(between(nodes[i - 1], nodes[i]));
      const double r = radius(nodes[i - 1]), q = radius(nodes[i]);
      size.length += l;
      size.area += pcs::internal::pi * l * (r + q);
      size.volume += pcs::internal::pi / 3 * l * (r * r + r * q + q * q);
    }
    size.diameter = 2 * radius(nodes.front());
    size.height = height(nodes.front()) - height(bundle.root);
    const std::size_t i = end_of_first_piece(nodes);
    if (i == 0)
      return size;
    const Vector axis = between(nodes[i - 1], nodes[i]);
    size.diameter = radius(nodes[i - 1]) + radius(nodes[i]);
    size.azimuth = azimuth(axis);
    size.zenith = angle(axis, m_up);
    const std::size_t parent = parent_node<Kernel>(nodes.front(), m_tree);
    if (parent == npos)
      return size;
    if (const Vector d = direction_at(parent); length(d) > 0)
      size.angle = angle(axis, d);
    return size;
  }

  const Tree_skeleton<Kernel>& m_tree;
  Vector m_up;
  std::vector<std::vector<std::size_t>> m_nodes; // by branch
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_CYLINDERS_BRANCH_SIZES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shapes of a tree at younger ages.

#ifndef PCS_GENERATORS_TREE_AT_AGE_H
#define PCS_GENERATORS_TREE_AT_AGE_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/text.h>

#include <CGAL/number_utils.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

//! Grows the branches of a tree up to an age. A branch begins when the tip of its parent passes the
//! base of the branch.
template <class Kernel>
class Younger_tree
{
public:
  Younger_tree(const Tree_skeleton<Kernel>& tree, double age)
    : m_tree(tree), m_age(age), m_birth(num_vertices(tree), 1), m_copy(num_vertices(tree), npos)
  {
  }

  Tree_skeleton<Kernel> run(std::vector<std::size_t>& old_nodes)
  {
    const auto& bundle = m_tree[boost::graph_bundle];
    const auto nodes = nodes_by_branch<Kernel>(m_tree);
    for (const auto& of_branch : nodes)
      m_tips.push_back(of_branch.empty() ? typename Kernel::FT(0)
                                         : m_tree[of_branch.back()].radius);
    std::vector<std::vector<std::size_t>> children(nodes.size());
    for (std::size_t b = 0; b < nodes.size(); ++b)
      if (!nodes[b].empty()) {
        const std::size_t carrier = parent_node<Kernel>(nodes[b].front(), m_tree);
        if (carrier != npos)
          children[m_tree[carrier].branch].push_back(b);
      }
    std::vector<std::size_t> order; // parents before their branches
    if (bundle.root != npos)
      order.push_back(m_tree[bundle.root].branch);
    m_new_branch.assign(nodes.size(), npos);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::size_t branch = order[i];
      grow(branch, nodes[branch]);
      for (const std::size_t child : children[branch])
        order.push_back(child);
    }
    m_result[boost::graph_bundle].root = num_vertices(m_result) > 0 ? 0 : npos;
    old_nodes = std::move(m_old);
    return m_result;
  }

private:
  void grow(std::size_t b, const std::vector<std::size_t>& nodes)
  {
    if (nodes.empty())
      return;
    const std::size_t carrier = parent_node<Kernel>(nodes.front(), m_tree);
    const double birth = carrier == npos ? 0 : m_birth[carrier];
    std::vector<double> at(nodes.size(), 0);
    for (std::size_t i = 1; i < nodes.size(); ++i)
      at[i] = at[i - 1] + distance(nodes[i - 1], nodes[i]);
    const double length = at.back();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      m_birth[nodes[i]] = birth + (1 - birth) * time_of_length(length > 0 ? at[i] / length : 0);
    if (birth >= m_age || (carrier != npos && m_copy[carrier] == npos))
      return; // not yet begun, or its base does not exist yet

    Tree_branch branch = m_tree[boost::graph_bundle].branches[b];
    branch.parent = carrier == npos ? npos : m_new_branch[m_tree[carrier].branch];
    m_new_branch[b] = m_result[boost::graph_bundle].branches.size();
    m_result[boost::graph_bundle].branches.push_back(branch);

    std::size_t parent = carrier == npos ? npos : m_copy[carrier];
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (m_birth[nodes[i]] <= m_age) {
        parent = add(m_tree[nodes[i]], m_birth[nodes[i]], b, parent);
        m_copy[nodes[i]] = parent;
        m_old.push_back(nodes[i]);
        continue;
      }
      // the tip lies between the last node and this one
      const double now = length * length_at_time((m_age - birth) / (1 - birth));
      const double t = std::min(1.0, (now - at[i - 1]) / (at[i] - at[i - 1]));
      if (t > 1e-9) {
        add(between(m_tree[nodes[i - 1]], m_tree[nodes[i]], t), m_age, b, parent);
        m_old.push_back(npos);
      }
      return;
    }
  }

  // Growth decelerates uniformly to 0: the length after the fraction `t` of a life is
  // 1 - (1 - t)^2.
  static double length_at_time(double t) { return t * (2 - t); }
  static double time_of_length(double s) { return 1 - std::sqrt(std::max(0.0, 1 - s)); }

  double distance(std::size_t v, std::size_t w) const
  {
    const auto &p = m_tree[v].point, &q = m_tree[w].point;
    return std::hypot(CGAL::to_double(q.x() - p.x()),
                      CGAL::to_double(q.y() - p.y()),
                      CGAL::to_double(q.z() - p.z()));
  }

  static Tree_node<Kernel> between(const Tree_node<Kernel>& a, const Tree_node<Kernel>& b, double t)
  {
    using FT = typename Kernel::FT;
    const FT s(t), rest(1 - t);
    Tree_node<Kernel> node = a;
    node.point = typename Kernel::Point_3(rest * a.point.x() + s * b.point.x(),
                                          rest * a.point.y() + s * b.point.y(),
                                          rest * a.point.z() + s * b.point.z());
    node.radius = rest * a.radius + s * b.radius;
    node.major_radius = rest * a.major_radius + s * b.major_radius;
    node.minor_radius = rest * a.minor_radius + s * b.minor_radius;
    return node;
  }

  std::size_t add(Tree_node<Kernel> node, double birth, std::size_t b, std::size_t parent)
  {
    using FT = typename Kernel::FT;
    // a radius grows after the passage of the tip, from the radius of the tip in the old tree
    const double grown = birth < 1 ? (m_age - birth) / (1 - birth) : 1;
    const double tip = CGAL::to_double(m_tips[b]);
    const double radius = CGAL::to_double(node.radius);
    if (radius > tip) {
      const FT scale((tip + grown * (radius - tip)) / radius);
      node.radius = node.radius * scale;
      node.major_radius = node.major_radius * scale;
      node.minor_radius = node.minor_radius * scale;
    }
    node.branch = m_new_branch[b];
    const std::size_t v = add_vertex(node, m_result);
    if (parent != npos)
      add_edge(parent, v, m_result);
    return v;
  }

  const Tree_skeleton<Kernel>& m_tree;
  double m_age;
  std::vector<double> m_birth;     // of each node: the time of the passage of the tip
  std::vector<std::size_t> m_copy; // for each node of the old tree its node in the young tree
  std::vector<std::size_t> m_old;  // for each node of the young tree its node in the old tree
  std::vector<std::size_t> m_new_branch;
  std::vector<typename Kernel::FT> m_tips;
  Tree_skeleton<Kernel> m_result;
};

} // namespace internal
} // namespace generators

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief returns the shape of a tree when it was younger.

  The given tree has the age 1. The trunk grows with decreasing speed until this age. A
  branch begins when the tip of its parent passes the base of the branch; it also grows with
  decreasing speed until the age 1. Radii grow linearly from the radius of the tip of the branch.
  The wood does not move, so an axis of the young tree is the beginning of the old axis: this is the
  ground truth for correspondences.

  \tparam Kernel a class with `FT`, `Point_3` and `Vector_3`, such as a kernel of CGAL
  \param tree a tree with branches, of any origin
  \param age fraction of the life of the tree, in (0, 1]
  \param old_nodes is replaced: for each node of the result the same node of `tree`; `npos` for tips
         that lie between two nodes
  \return a tree with fewer branches, which keep their `id`
  \throws pcs::Invalid_input when `age` is out of range
  \par Complexity
  Linear in the number of nodes.
*/
template <class Kernel>
Tree_skeleton<Kernel>
tree_at_age(const Tree_skeleton<Kernel>& tree, double age, std::vector<std::size_t>& old_nodes)
{
  if (!(age > 0 && age <= 1))
    throw Invalid_input("pcs::tree_at_age(): `age` must be in (0, 1], found " +
                        internal::to_text(age));
  return generators::internal::Younger_tree<Kernel>(tree, age).run(old_nodes);
}

//! \ingroup PkgPcsGeneratorsRef
//! overload without the correspondence of nodes
template <class Kernel>
Tree_skeleton<Kernel> tree_at_age(const Tree_skeleton<Kernel>& tree, double age)
{
  std::vector<std::size_t> old_nodes;
  return tree_at_age<Kernel>(tree, age, old_nodes);
}

} // namespace pcs

#endif // PCS_GENERATORS_TREE_AT_AGE_H

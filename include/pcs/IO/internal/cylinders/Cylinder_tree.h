// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Conversion of the cylinders of a tree to a skeleton.

#ifndef PCS_IO_INTERNAL_CYLINDERS_CYLINDER_TREE_H
#define PCS_IO_INTERNAL_CYLINDERS_CYLINDER_TREE_H

#include <pcs/IO/internal/cylinders/Cylinder_table.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/assign_branches.h>

#include <array>
#include <cstddef>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/*
  Returns the next cylinder on the branch of each cylinder, `npos` for the last one. The branches
  are those of the table. Without branches in the table, or if these are not chains,
  `assign_branches()` determines them.
*/
template <class Kernel>
std::vector<std::size_t> continuing_cylinders(const std::vector<Cylinder>& cylinders,
                                              const std::vector<std::size_t>& parents,
                                              bool has_branches)
{
  std::vector<std::size_t> next(cylinders.size(), npos);
  for (std::size_t i = 0; i < cylinders.size() && has_branches; ++i) {
    const std::size_t p = parents[i];
    if (p == npos || cylinders[p].branch != cylinders[i].branch)
      continue;
    has_branches = next[p] == npos;
    next[p] = i;
  }
  if (has_branches)
    return next;
  Tree_skeleton<Kernel> ends(cylinders.size());
  for (std::size_t i = 0; i < cylinders.size(); ++i) {
    const auto& c = cylinders[i];
    using FT = typename Kernel::FT;
    ends[i].point = typename Kernel::Point_3(FT(c.end[0]), FT(c.end[1]), FT(c.end[2]));
    ends[i].radius = FT(c.radius);
    if (parents[i] == npos)
      ends[boost::graph_bundle].root = i;
    else
      add_edge(parents[i], i, ends);
  }
  assign_branches<Kernel>(ends);
  next.assign(cylinders.size(), npos);
  for (std::size_t i = 0; i < cylinders.size(); ++i)
    if (parents[i] != npos && ends[i].branch == ends[parents[i]].branch)
      next[parents[i]] = i;
  return next;
}

/// Makes a skeleton from the cylinders of one tree.
template <class Kernel>
class Cylinder_tree
{
public:
  Cylinder_tree(const std::vector<Cylinder>& cylinders,
                const std::vector<std::size_t>& parents,
                bool has_branches)
    : m_cylinders(cylinders),
      m_parents(parents),
      m_next(continuing_cylinders<Kernel>(cylinders, parents, has_branches)),
      m_start(cylinders.size(), npos),
      m_end(cylinders.size(), npos)
  {
    for (const std::size_t c : order())
      add(c);
    pcs::internal::assign_branches<Kernel>(m_tree, [&](std::size_t v) { return m_behind[v]; });
  }

  const Tree_skeleton<Kernel>& tree() const { return m_tree; }
  //! returns the cylinder that ends at each node, `npos` for the first nodes of branches
  const std::vector<std::size_t>& cylinder_of_node() const { return m_cylinder_of_node; }

private:
  using FT = typename Kernel::FT;

  //! returns the indices of all cylinders, parents before their children
  std::vector<std::size_t> order() const
  {
    std::vector<std::vector<std::size_t>> children(m_cylinders.size());
    std::vector<std::size_t> result;
    for (std::size_t c = 0; c < m_cylinders.size(); ++c)
      if (m_parents[c] == npos)
        result.push_back(c);
      else
        children[m_parents[c]].push_back(c);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const std::vector<std::size_t>& more = children[result[i]];
      result.insert(result.end(), more.begin(), more.end());
    }
    return result;
  }

  void add(std::size_t c)
  {
    const std::size_t p = m_parents[c];
    const Cylinder& cylinder = m_cylinders[c];
    if (p == npos)
      m_tree[boost::graph_bundle].root = m_start[c] = add_node(cylinder.start, cylinder, npos);
    else if (m_next[p] == c) {
      m_start[c] = m_end[p];
      set_radius(m_end[p], 0.5 * (m_cylinders[p].radius + cylinder.radius));
    } else {
      const bool is_at_start = squared_distance(cylinder.start, m_cylinders[p].start) <
                               squared_distance(cylinder.start, m_cylinders[p].end);
      m_start[c] = add_node(cylinder.start, cylinder, npos);
      add_edge(is_at_start ? m_start[p] : m_end[p], m_start[c], m_tree);
    }
    m_end[c] = add_node(cylinder.end, cylinder, c);
    add_edge(m_start[c], m_end[c], m_tree);
    m_behind[m_start[c]] = m_end[c];
  }

  std::size_t add_node(const std::array<double, 3>& at, const Cylinder& cylinder, std::size_t end)
  {
    Tree_node<Kernel> node;
    node.point = typename Kernel::Point_3(FT(at[0]), FT(at[1]), FT(at[2]));
    const std::size_t v = add_vertex(node, m_tree);
    m_behind.push_back(npos);
    m_cylinder_of_node.push_back(end);
    set_radius(v, cylinder.radius);
    return v;
  }

  void set_radius(std::size_t v, double radius)
  {
    m_tree[v].radius = m_tree[v].major_radius = m_tree[v].minor_radius = FT(radius);
  }

  const std::vector<Cylinder>& m_cylinders;
  const std::vector<std::size_t>& m_parents;
  std::vector<std::size_t> m_next;         // next cylinder on the branch of each cylinder
  std::vector<std::size_t> m_start, m_end; // nodes of each cylinder
  std::vector<std::size_t> m_behind;       // next node on the branch of each node
  std::vector<std::size_t> m_cylinder_of_node;
  Tree_skeleton<Kernel> m_tree;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_CYLINDERS_CYLINDER_TREE_H

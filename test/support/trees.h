// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Small tree skeletons for tests, given as rows.

#ifndef PCS_TEST_SUPPORT_TREES_H
#define PCS_TEST_SUPPORT_TREES_H

#include <pcs/core/Tree_skeleton.h>

#include <cstddef>
#include <vector>

namespace pcs_test {

/// A minimal kernel: points, vectors and numbers, without predicates and constructions.
struct Kernel_archetype
{
  using FT = double;
  class Vector_3
  {
  public:
    Vector_3(FT x, FT y, FT z) : m_x(x), m_y(y), m_z(z) {}
    FT x() const { return m_x; }
    FT y() const { return m_y; }
    FT z() const { return m_z; }

  private:
    FT m_x, m_y, m_z;
  };
  class Point_3
  {
  public:
    Point_3(FT x, FT y, FT z) : m_x(x), m_y(y), m_z(z) {}
    FT x() const { return m_x; }
    FT y() const { return m_y; }
    FT z() const { return m_z; }

  private:
    FT m_x, m_y, m_z;
  };
};

/// Node as a table row: its parent (`npos`: root), branch, position and radius.
struct Row
{
  std::size_t parent, branch;
  double x, y, z, radius;
};

/// The tree of these rows, with circular sections. Orders and parents of the branches are derived
/// from the rows.
template <class Kernel>
pcs::Tree_skeleton<Kernel> make_tree(const std::vector<Row>& rows)
{
  using FT = typename Kernel::FT;
  pcs::Tree_skeleton<Kernel> tree(rows.size());
  auto& bundle = tree[boost::graph_bundle];
  for (std::size_t v = 0; v < rows.size(); ++v) {
    const Row& row = rows[v];
    tree[v].point = typename Kernel::Point_3(FT(row.x), FT(row.y), FT(row.z));
    tree[v].radius = tree[v].major_radius = tree[v].minor_radius = FT(row.radius);
    tree[v].branch = row.branch;
    if (row.branch >= bundle.branches.size())
      bundle.branches.resize(row.branch + 1);
    auto& branch = bundle.branches[row.branch];
    branch.id = row.branch;
    if (row.parent == pcs::npos) {
      bundle.root = v;
      continue;
    }
    add_edge(row.parent, v, tree);
    const std::size_t parent_branch = rows[row.parent].branch;
    if (parent_branch != row.branch) {
      branch.parent = parent_branch;
      branch.order = bundle.branches[parent_branch].order + 1;
    }
  }
  return tree;
}

/// A trunk of 3 nodes with a branch of 3 nodes at its middle, and a twig of 2 nodes at the middle
/// of that branch.
template <class Kernel>
pcs::Tree_skeleton<Kernel> make_small_tree()
{
  return make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.2},
                            {0, 0, 0, 0, 1, 0.15},
                            {1, 0, 0, 0, 2, 0.1},
                            {1, 1, 0, 0, 1, 0.05},
                            {3, 1, 0.5, 0, 1.25, 0.04},
                            {4, 1, 1, 0, 1.5, 0.03},
                            {4, 2, 0.5, 0, 1.25, 0.02},
                            {6, 2, 0.5, 0.4, 1.25, 0.01}});
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_TREES_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Prunes, turns and lengthens single branches of a tree; all others keep their ids.

#ifndef PCS_GENERATORS_EDIT_BRANCHES_H
#define PCS_GENERATORS_EDIT_BRANCHES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/text.h>

#include <CGAL/number_utils.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

//! returns the index of the branch with an id; throws if there is none
template <class Kernel>
std::size_t
branch_of_id(const Tree_skeleton<Kernel>& tree, std::size_t branch_id, const char* caller)
{
  const auto& branches = tree[boost::graph_bundle].branches;
  for (std::size_t b = 0; b < branches.size(); ++b)
    if (branches[b].id == branch_id && branch_id != npos)
      return b;
  throw Invalid_input(std::string("pcs::") + caller + "(): there is no branch with the id " +
                      std::to_string(branch_id));
}

//! returns for each branch whether it is `branch` or one of its descendants
template <class Kernel>
std::vector<bool> subtree(const Tree_skeleton<Kernel>& tree, std::size_t branch)
{
  const auto& branches = tree[boost::graph_bundle].branches;
  std::vector<bool> is_in(branches.size(), false);
  for (std::size_t b = 0; b < branches.size(); ++b) {
    std::size_t up = b;
    for (std::size_t steps = 0; up != npos && up != branch && steps < branches.size(); ++steps)
      up = branches[up].parent;
    is_in[b] = up == branch;
  }
  return is_in;
}

template <class Kernel>
Eigen::Vector3d vector_of(const Tree_node<Kernel>& node)
{
  return {CGAL::to_double(node.point.x()),
          CGAL::to_double(node.point.y()),
          CGAL::to_double(node.point.z())};
}

template <class Kernel>
void move_to(const Eigen::Vector3d& p, Tree_node<Kernel>& node)
{
  using FT = typename Kernel::FT;
  node.point = typename Kernel::Point_3(FT(p.x()), FT(p.y()), FT(p.z()));
}

} // namespace internal
} // namespace generators

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief returns the tree without one of its branches and the descendants of this branch.

  The other nodes and branches keep their order. Branches keep their `id`. O(n + b d) for n nodes
  and b branches of order d or less.

  \param branch_id `Tree_branch::id` of the branch
  \throws pcs::Invalid_input when there is no such branch, or it is the trunk
*/
template <class Kernel>
Tree_skeleton<Kernel> prune_branch(const Tree_skeleton<Kernel>& tree, std::size_t branch_id)
{
  const std::size_t branch =
      generators::internal::branch_of_id<Kernel>(tree, branch_id, "prune_branch");
  const auto& bundle = tree[boost::graph_bundle];
  if (bundle.branches[branch].parent == npos)
    throw Invalid_input("pcs::prune_branch(): the trunk cannot be pruned");
  const std::vector<bool> is_pruned = generators::internal::subtree<Kernel>(tree, branch);
  std::vector<std::size_t> new_branch(bundle.branches.size(), npos);
  std::vector<std::size_t> new_node(num_vertices(tree), npos);
  Tree_skeleton<Kernel> result;
  auto& branches = result[boost::graph_bundle].branches;
  for (std::size_t b = 0; b < bundle.branches.size(); ++b)
    if (!is_pruned[b]) {
      new_branch[b] = branches.size();
      branches.push_back(bundle.branches[b]);
    }
  for (Tree_branch& b : branches)
    b.parent = b.parent == npos ? npos : new_branch[b.parent];
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (!is_pruned[tree[v].branch]) {
      new_node[v] = add_vertex(tree[v], result);
      result[new_node[v]].branch = new_branch[tree[v].branch];
    }
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    const std::size_t p = parent_node<Kernel>(v, tree);
    if (new_node[v] != npos && p != npos)
      add_edge(new_node[p], new_node[v], result);
  }
  result[boost::graph_bundle].root = new_node[bundle.root];
  return result;
}

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief rotates a branch and its descendants about the base of the branch.

  O(n + b d) for n nodes and b branches of order d or less.

  \param tree nodes and branches keep their numbers
  \param branch_id `Tree_branch::id` of the branch
  \param axis direction of the axis through the base; any length but 0
  \param angle counterclockwise [rad]
  \throws pcs::Invalid_input when there is no such branch, or `axis` or `angle` are not finite
*/
template <class Kernel>
void turn_branch(Tree_skeleton<Kernel>& tree,
                 std::size_t branch_id,
                 const typename Kernel::Vector_3& axis,
                 double angle)
{
  using FT = typename Kernel::FT;
  const std::size_t branch =
      generators::internal::branch_of_id<Kernel>(tree, branch_id, "turn_branch");
  const Eigen::Vector3d a(CGAL::to_double(axis.x()),
                          CGAL::to_double(axis.y()),
                          CGAL::to_double(axis.z()));
  if (!a.allFinite() || !(a.norm() > 0) || !std::isfinite(angle))
    throw Invalid_input("pcs::turn_branch(): `axis` must have a direction and `angle` be finite");
  const auto nodes = nodes_by_branch<Kernel>(tree);
  if (nodes[branch].empty())
    return;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, a.normalized()).toRotationMatrix();
  const Eigen::Vector3d base = generators::internal::vector_of<Kernel>(tree[nodes[branch][0]]);
  const std::vector<bool> is_in = generators::internal::subtree<Kernel>(tree, branch);
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    Tree_node<Kernel>& node = tree[v];
    if (!is_in[node.branch])
      continue;
    const Eigen::Vector3d p = generators::internal::vector_of<Kernel>(node);
    generators::internal::move_to<Kernel>(base + turn * (p - base), node);
    const Eigen::Vector3d m = turn * Eigen::Vector3d(CGAL::to_double(node.major_axis.x()),
                                                     CGAL::to_double(node.major_axis.y()),
                                                     CGAL::to_double(node.major_axis.z()));
    node.major_axis = typename Kernel::Vector_3(FT(m.x()), FT(m.y()), FT(m.z()));
  }
}

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief changes the length of a branch; its descendants are translated without deformation.

  The axis of the branch is scaled about its base. Radii are unchanged. Linear in the number of
  nodes.

  \param tree nodes and branches keep their numbers
  \param branch_id `Tree_branch::id` of the branch
  \param factor of the length, positive
  \throws pcs::Invalid_input when there is no such branch, or `factor` is not positive
*/
template <class Kernel>
void lengthen_branch(Tree_skeleton<Kernel>& tree, std::size_t branch_id, double factor)
{
  const std::size_t branch =
      generators::internal::branch_of_id<Kernel>(tree, branch_id, "lengthen_branch");
  if (!(factor > 0) || !std::isfinite(factor))
    throw Invalid_input("pcs::lengthen_branch(): `factor` must be positive, found " +
                        internal::to_text(factor));
  const auto nodes = nodes_by_branch<Kernel>(tree);
  if (nodes[branch].empty())
    return;
  const Eigen::Vector3d base = generators::internal::vector_of<Kernel>(tree[nodes[branch][0]]);
  std::vector<Eigen::Vector3d> shift(num_vertices(tree), Eigen::Vector3d::Zero());
  for (const std::size_t v : nodes[branch])
    shift[v] = (factor - 1) * (generators::internal::vector_of<Kernel>(tree[v]) - base);
  // nodes pass their displacement on to the branches attached to them
  std::vector<std::size_t> stack = nodes[branch];
  while (!stack.empty()) {
    const std::size_t v = stack.back();
    stack.pop_back();
    for (const auto e : boost::make_iterator_range(out_edges(v, tree))) {
      const std::size_t w = target(e, tree);
      if (tree[w].branch == branch)
        continue;
      shift[w] = shift[v];
      stack.push_back(w);
    }
  }
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    if (!shift[v].isZero(0))
      generators::internal::move_to<Kernel>(generators::internal::vector_of<Kernel>(tree[v]) +
                                                shift[v],
                                            tree[v]);
}

} // namespace pcs

#endif // PCS_GENERATORS_EDIT_BRANCHES_H

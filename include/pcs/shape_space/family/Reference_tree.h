// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The reference tree of a space, to which other trees are matched.

#ifndef PCS_SHAPE_SPACE_FAMILY_REFERENCE_TREE_H
#define PCS_SHAPE_SPACE_FAMILY_REFERENCE_TREE_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/model/Branch_paths.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// The reference tree of a space, to which other trees are matched. `paths.paths[b]` is branch `b`
/// of the topology, and its only candidate path.
struct Reference_tree
{
  Rooted_tree tree;
  Branch_paths paths;
  std::vector<std::vector<double>> share; ///< by branch: parameter in [0, 1] of each layout node
};

namespace internal {

class Reference_builder
{
public:
  Reference_builder(const Orl_layout& layout, const Orl_coordinates& x)
    : m_layout(layout), m_x(x), m_children(layout.branches.size()), m_base(layout.branches.size())
  {
    build_geometry(layout, x, Orl_orientation::gauge_fixed, m_geometry);
    for (std::size_t b = 0; b < layout.branches.size(); ++b)
      if (layout.branches[b].parent != none)
        m_children[layout.branches[b].parent].push_back(b);
  }

  Reference_tree run()
  {
    const std::size_t m = m_layout.branches.size();
    m_result.paths.paths.resize(m);
    m_result.share.resize(m);
    for (std::size_t b = 0; b < m; ++b)
      add_branch(b);
    Rooted_tree& tree = m_result.tree;
    m_result.paths.paths_of.resize(tree.size());
    for (std::size_t b = 0; b < m; ++b) {
      const Branch_path& path = m_result.paths.paths[b];
      m_result.paths.paths_of[path.nodes[path.is_trunk ? 0 : 1]] = {b};
      for (Branch_path::Child& c : m_result.paths.paths[b].children)
        c.start = m_result.paths.paths[c.start].nodes[1]; // replaces the index of the branch
    }
    Vec3 low = tree.points[0], high = low;
    for (const Vec3& p : tree.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    tree.extent = (high - low).norm();
    connect(tree);
    return std::move(m_result);
  }

private:
  std::size_t add_node(std::size_t b, double t, std::size_t parent)
  {
    Rooted_tree& tree = m_result.tree;
    const std::size_t first = m_layout.first_node(b), n = m_layout.branches[b].number_of_edges;
    const auto k = std::min(n - 1, static_cast<std::size_t>(t));
    const double f = t - static_cast<double>(k);
    tree.points.push_back(place_on_branch(m_layout, m_geometry, b, t));
    tree.radii.push_back((1 - f) * m_geometry.radius[first + k] +
                         f * m_geometry.radius[first + k + 1]);
    tree.parents.push_back(parent);
    tree.sources.push_back(none);
    tree.base_radii.push_back(parent == none ? tree.radii.back()
                                             : std::numeric_limits<double>::quiet_NaN());
    return tree.size() - 1;
  }

  void add_branch(std::size_t b)
  {
    Branch_path path;
    path.is_trunk = m_layout.branches[b].parent == none;
    path.nodes.push_back(path.is_trunk ? add_node(b, 0, none) : m_base[b]);
    path.arc.push_back(0);
    const std::size_t n = m_layout.branches[b].number_of_edges;
    // nodes of the branch in the layout, and positions where children begin
    std::vector<std::pair<double, std::size_t>> stops; // position, child
    for (std::size_t k = 0; k <= n; ++k)
      stops.emplace_back(static_cast<double>(k), none);
    for (const std::size_t c : m_children[b])
      stops.emplace_back(std::min(static_cast<double>(n), std::max(0.0, m_x.attachment[c])), c);
    std::stable_sort(stops.begin(), stops.end(), [](const auto& x, const auto& y) {
      return x.first != y.first ? x.first < y.first : x.second > y.second;
    });
    double last = 0;
    for (const auto& [t, child] : stops) {
      if (t - last > 1e-6) {
        const std::size_t v = add_node(b, t, path.nodes.back());
        if (path.nodes.size() == 1)
          m_result.tree.base_radii[v] = m_x.base_radius[b];
        // arc lengths must increase, whatever the coordinates
        const double step = m_result.tree.edge_length(v);
        path.arc.push_back(path.arc.back() + std::max(step, 1e-300));
        path.nodes.push_back(v);
        last = t;
      }
      if (child == none)
        m_result.share[b].push_back(path.arc.back());
      else {
        m_base[child] = path.nodes.back();
        path.children.push_back({child, path.nodes.size() - 1});
      }
    }
    for (double& s : m_result.share[b])
      s /= path.length();
    m_result.paths.paths[b] = std::move(path);
  }

  const Orl_layout& m_layout;
  const Orl_coordinates& m_x;
  Orl_geometry m_geometry;
  std::vector<std::vector<std::size_t>> m_children;
  std::vector<std::size_t> m_base; // node at which a branch begins
  Reference_tree m_result;
};

} // namespace internal

inline Reference_tree make_reference(const Orl_layout& layout, const Orl_coordinates& x)
{
  return internal::Reference_builder(layout, x).run();
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_REFERENCE_TREE_H

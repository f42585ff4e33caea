// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Leaves on the fine branches of a tree skeleton.

#ifndef PCS_MAKE_LEAF_SURFACE_H
#define PCS_MAKE_LEAF_SURFACE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/text.h>

#include <CGAL/number_utils.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! default length of a leaf, in distances from the root to the farthest node [-]
constexpr double default_leaf_share = 0.008;

namespace internal {

/// The nodes of a tree as `make_leaf_surface()` needs them.
struct Leaf_nodes
{
  std::vector<Eigen::Vector3d> position;
  double extent = 0;     ///< largest distance of a node from the root [L]
  double tip_radius = 0; ///< median radius of the tips [L]
};

template <class Kernel>
Leaf_nodes read_leaf_nodes(const Tree_skeleton<Kernel>& tree)
{
  const std::size_t n = num_vertices(tree);
  Leaf_nodes nodes;
  nodes.position.resize(n);
  std::vector<double> tips;
  for (std::size_t v = 0; v < n; ++v) {
    const auto& p = tree[v].point;
    Eigen::Vector3d& position = nodes.position[v];
    position = {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
    const double radius = CGAL::to_double(tree[v].radius);
    if (!position.allFinite() || !std::isfinite(radius) || radius < 0)
      throw Invalid_input("pcs::make_leaf_surface(): position or radius of node " +
                          std::to_string(v) + " is not finite, or the radius is negative");
    nodes.extent = std::max(nodes.extent, (position - nodes.position[0]).norm());
    if (out_degree(v, tree) == 0)
      tips.push_back(radius);
  }
  const auto middle = tips.begin() + static_cast<std::ptrdiff_t>(tips.size() / 2);
  std::nth_element(tips.begin(), middle, tips.end());
  nodes.tip_radius = tips.empty() ? 0 : *middle;
  return nodes;
}

/// The named parameters of `make_leaf_surface()`.
struct Leaf_surface_options
{
  double length;        ///< of a leaf [L]
  double density;       ///< leaves per length of branch [1/L]
  double branch_radius; ///< of the thickest branch with leaves [L]
  std::uint64_t seed;
};

template <class NamedParameters>
Leaf_surface_options read_leaf_surface_options(const NamedParameters& np, const Leaf_nodes& nodes)
{
  const auto choose = [&](auto tag, double otherwise, bool is_zero_fine, const char* name) {
    const double value = static_cast<double>(internal::choose(np, tag, otherwise));
    if (!std::isfinite(value) || value < 0 || (value == 0 && !is_zero_fine))
      throw Invalid_input(std::string("pcs::make_leaf_surface(): ") + name + " is " +
                          internal::to_text(value) + "; it must " +
                          (is_zero_fine ? "not be negative" : "be positive"));
    return value;
  };
  Leaf_surface_options o;
  const double one = nodes.extent > 0 ? default_leaf_share * nodes.extent : 1;
  o.length = choose(internal_np::leaf_length, one, false, "leaf_length");
  o.density = choose(internal_np::leaves_per_length, 2 / o.length, true, "leaves_per_length");
  o.branch_radius =
      choose(internal_np::leaf_branch_radius, 2 * nodes.tip_radius, true, "leaf_branch_radius");
  o.seed = static_cast<std::uint64_t>(internal::choose(np, CGAL::internal_np::random_seed, 0));
  return o;
}

} // namespace internal

/*!
  \ingroup PkgPcsSkeletonRef
  \brief makes leaves, which the scan does not show one by one, with random orientations on the fine
      branches.

  The last step of chapter 3 of \cite aiteanu2022: for the eye only. A leaf is a rhombus of two
  triangles, half as wide as long, that begins on the bark. Nothing else of pcs makes leaves, so a
  tree has none unless this function is called.

  \param tree a tree; positions and radii are finite
  \param points replaced by the vertices, four for each leaf
  \param triangles replaced by triples of indices into `points`, two for each leaf
  \param np
  \npbegin
    \np{leaf_length} length of a leaf [L]
      \nptype floating point, `> 0`
      \npdefault `default_leaf_share` times the distance of the farthest node from the root
    \np{leaves_per_length} along fine branches [1/L]
      \nptype floating point, `>= 0`
      \npdefault two for each `leaf_length`
    \np{leaf_branch_radius} branches up to this radius have leaves [L]
      \nptype floating point, `>= 0`
      \npdefault twice the median radius of the tips
    \np{random_seed} every seed gives other leaves
      \nptype integer
      \npdefault 0
  \npend
  \return the number of leaves
  \throws Invalid_input if a position or radius is not finite, or a parameter is out of range
  \par Complexity
  O(nodes + leaves).
  \par Determinism
  Same bits for the same seed.
*/
template <class Kernel, class NamedParameters = parameters::Default_named_parameters>
std::size_t make_leaf_surface(const Tree_skeleton<Kernel>& tree,
                              std::vector<typename Kernel::Point_3>& points,
                              std::vector<std::array<std::size_t, 3>>& triangles,
                              const NamedParameters& np = NamedParameters())
{
  using FT = typename Kernel::FT;
  using Vec3 = Eigen::Vector3d;
  const internal::Leaf_nodes nodes = internal::read_leaf_nodes(tree);
  const internal::Leaf_surface_options o = internal::read_leaf_surface_options(np, nodes);
  std::mt19937_64 random(o.seed);
  const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
  const auto direction = [&] {
    const double z = 2 * uniform() - 1, angle = 6.283185307179586 * uniform();
    const double across = std::sqrt(std::max(0.0, 1 - z * z));
    return Vec3(across * std::cos(angle), across * std::sin(angle), z);
  };
  std::vector<typename Kernel::Point_3> vertices;
  std::vector<std::array<std::size_t, 3>> faces;
  const auto add = [&](const Vec3& p) { vertices.emplace_back(FT(p.x()), FT(p.y()), FT(p.z())); };
  for (std::size_t v = 0; v < nodes.position.size(); ++v) {
    const std::size_t p = parent_node<Kernel>(v, tree);
    const double radius = CGAL::to_double(tree[v].radius);
    if (p == npos || tree[p].branch != tree[v].branch || radius > o.branch_radius)
      continue;
    const Vec3 d = nodes.position[v] - nodes.position[p];
    const double expected = o.density * d.norm(), whole = std::floor(expected);
    const double count = whole + (uniform() < expected - whole ? 1 : 0);
    for (double k = 0; k < count; ++k) {
      const Vec3 along = direction();
      Vec3 side = along.cross(direction());
      side = side.norm() > 1e-6 ? Vec3(side.normalized()) : Vec3(along.unitOrthogonal());
      const Vec3 base = nodes.position[p] + uniform() * d + radius * along;
      const std::size_t first = vertices.size();
      add(base);
      add(base + 0.5 * o.length * along + 0.25 * o.length * side);
      add(base + o.length * along);
      add(base + 0.5 * o.length * along - 0.25 * o.length * side);
      faces.push_back({first, first + 1, first + 2});
      faces.push_back({first, first + 2, first + 3});
    }
  }
  points = std::move(vertices);
  triangles = std::move(faces);
  return points.size() / 4;
}

} // namespace pcs

#endif // PCS_MAKE_LEAF_SURFACE_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Leaves on the fine branches of a tree skeleton.

#ifndef PCS_MAKE_LEAF_SURFACE_H
#define PCS_MAKE_LEAF_SURFACE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/skeleton/input/caller_types.h>

#include <CGAL/number_utils.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! default length of a leaf, as a fraction of the distance from the root to the farthest node [-]
constexpr double default_leaf_share = 0.008;

namespace internal {

/// The properties of the nodes of a tree that `make_leaf_surface()` uses.
struct Leaf_nodes
{
  std::vector<Eigen::Vector3d> position;
  double extent = 0;     ///< largest distance of a node from the root [L]
  double tip_radius = 0; ///< median radius of the tips [L]
};

template <class Kernel>
Leaf_nodes read_leaf_nodes(const Tree_skeleton<Kernel>& tree, const std::string& caller)
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
    check(position.allFinite() && std::isfinite(radius) && radius >= 0,
          caller,
          "position or radius of node " + std::to_string(v) +
              " is not finite, or the radius is negative");
    if (out_degree(v, tree) == 0)
      tips.push_back(radius);
  }
  const std::size_t root = tree[boost::graph_bundle].root;
  for (const Eigen::Vector3d& position : nodes.position)
    nodes.extent = std::max(nodes.extent, (position - nodes.position[root < n ? root : 0]).norm());
  const auto middle = tips.begin() + static_cast<std::ptrdiff_t>(tips.size() / 2);
  std::nth_element(tips.begin(), middle, tips.end());
  nodes.tip_radius = tips.empty() ? 0 : *middle;
  return nodes;
}

/// The named parameters of `make_leaf_surface()`.
struct Leaf_surface_options
{
  std::optional<double> length;        ///< of a leaf [L]
  std::optional<double> density;       ///< leaves per length of branch [1/L]
  std::optional<double> branch_radius; ///< of the thickest branch with leaves [L]
  std::uint64_t seed = 0;
};

/// Throws `Invalid_input` with a message that begins with `caller` if a value is out of range.
template <class NamedParameters>
Leaf_surface_options read_leaf_surface_options(const NamedParameters& np, const std::string& caller)
{
  check_names<CGAL::internal_np::random_seed_t,
              internal_np::leaf_length_t,
              internal_np::leaves_per_length_t,
              internal_np::leaf_branch_radius_t>(np);
  static_assert(is_parameter_v<double, NamedParameters, internal_np::leaf_length_t>,
                "pcs::make_leaf_surface(): named parameter `leaf_length` must be a number");
  static_assert(is_parameter_v<double, NamedParameters, internal_np::leaves_per_length_t>,
                "pcs::make_leaf_surface(): named parameter `leaves_per_length` must be a number");
  static_assert(is_parameter_v<double, NamedParameters, internal_np::leaf_branch_radius_t>,
                "pcs::make_leaf_surface(): named parameter `leaf_branch_radius` must be a number");
  static_assert(is_integer_parameter_v<NamedParameters, CGAL::internal_np::random_seed_t>,
                "pcs::make_leaf_surface(): named parameter `random_seed` must be an integer");
  Leaf_surface_options options;
  read_parameter(np, internal_np::leaf_length, options.length);
  if (options.length)
    check_positive(caller, "leaf_length", *options.length);
  read_parameter(np, internal_np::leaves_per_length, options.density);
  if (options.density)
    check_at_least(caller, "leaves_per_length", *options.density, 0);
  read_parameter(np, internal_np::leaf_branch_radius, options.branch_radius);
  if (options.branch_radius)
    check_at_least(caller, "leaf_branch_radius", *options.branch_radius, 0);
  options.seed = read_random_seed(np);
  return options;
}

} // namespace internal

/*!
  \ingroup PkgPcsSkeletonRef
  \brief makes leaves with random positions and orientations on the fine branches.

  This is the last step of chapter 3 of \cite aiteanu2022. It is meant for visualisation only, since
  scans do not resolve individual leaves. A leaf is a rhombus of two triangles, half as wide as
  long, that begins on the bark.

  \param tree a tree; positions and radii are finite
  \param points replaced by the vertices, four for each leaf
  \param triangles replaced by triples of indices into `points`, two for each leaf
  \param np
  \npbegin
    \np{leaf_length} length of a leaf [L]
      \nptype floating point, `> 0`
      \npdefault `default_leaf_share` times the distance of the farthest node from the root
    \np{leaves_per_length} number of leaves per length of fine branches [1/L]
      \nptype floating point, `>= 0`
      \npdefault two for each `leaf_length`
    \np{leaf_branch_radius} branches up to this radius have leaves [L]
      \nptype floating point, `>= 0`
      \npdefault twice the median radius of the tips
    \np{random_seed} seed of the random positions and orientations
      \nptype integer
      \npdefault 0
  \npend
  \return the number of leaves
  \throws Invalid_input if a position or radius is not finite, or a parameter is out of range
  \par Complexity
  O(nodes + leaves).
  \par Determinism
  Results are bitwise identical for the same seed.
*/
template <class Kernel, class NamedParameters = parameters::Default_named_parameters>
std::size_t make_leaf_surface(const Tree_skeleton<Kernel>& tree,
                              std::vector<typename Kernel::Point_3>& points,
                              std::vector<std::array<std::size_t, 3>>& triangles,
                              const NamedParameters& np = NamedParameters())
{
  using FT = typename Kernel::FT;
  using Vec3 = Eigen::Vector3d;
  const std::string caller = "pcs::make_leaf_surface()";
  const internal::Leaf_surface_options options = internal::read_leaf_surface_options(np, caller);
  const internal::Leaf_nodes nodes = internal::read_leaf_nodes(tree, caller);
  const double length =
      options.length.value_or(nodes.extent > 0 ? default_leaf_share * nodes.extent : 1);
  const double density = options.density.value_or(2 / length);
  const double branch_radius = options.branch_radius.value_or(2 * nodes.tip_radius);
  std::mt19937_64 random(options.seed);
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
    if (p == npos || tree[p].branch != tree[v].branch || radius > branch_radius)
      continue;
    const Vec3 d = nodes.position[v] - nodes.position[p];
    const double expected = density * d.norm(), whole = std::floor(expected);
    const double count = whole + (uniform() < expected - whole ? 1 : 0);
    for (double k = 0; k < count; ++k) {
      const Vec3 along = direction();
      Vec3 side = along.cross(direction());
      side = side.norm() > 1e-6 ? Vec3(side.normalized()) : Vec3(along.unitOrthogonal());
      const Vec3 across = d.cross(along).cross(d);
      const Vec3 normal = across.norm() > 1e-9 * d.squaredNorm() ? Vec3(across.normalized())
                                                                 : Vec3(d.unitOrthogonal());
      const Vec3 base = nodes.position[p] + uniform() * d + radius * normal;
      const std::size_t first = vertices.size();
      add(base);
      add(base + 0.5 * length * along + 0.25 * length * side);
      add(base + length * along);
      add(base + 0.5 * length * along - 0.25 * length * side);
      faces.push_back({first, first + 1, first + 2});
      faces.push_back({first, first + 2, first + 3});
    }
  }
  points = std::move(vertices);
  triangles = std::move(faces);
  return points.size() / 4;
}

/// \cond
template <class Graph,
          class Points,
          class Triangles,
          class NamedParameters = parameters::Default_named_parameters>
std::enable_if_t<!skeleton::internal::is_tree_skeleton_v<Graph>, std::size_t>
make_leaf_surface(const Graph&, Points&, Triangles&, const NamedParameters& = NamedParameters())
{
  static_assert(skeleton::internal::is_tree_skeleton_v<Graph>,
                "pcs::make_leaf_surface(): the tree must be a pcs::Tree_skeleton<Kernel>");
  return 0;
}
/// \endcond

} // namespace pcs

#endif // PCS_MAKE_LEAF_SURFACE_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The surface of a tree skeleton as a triangle mesh.

#ifndef PCS_MAKE_BRANCH_SURFACE_H
#define PCS_MAKE_BRANCH_SURFACE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/surface/Surface_builder.h>

#include <CGAL/assertions.h>
#include <CGAL/boost/graph/Euler_operations.h>
#include <CGAL/boost/graph/properties.h>
#include <CGAL/number_utils.h>

#include <boost/graph/graph_traits.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! default tolerance of the mesh, as a fraction of the largest radius of the tree [-]
constexpr double default_surface_tolerance = 0.01;

//! \ingroup PkgPcsSkeletonRef
//! statistics of `make_branch_surface()`
struct Branch_surface_report
{
  std::size_t number_of_points = 0;    ///< [count]
  std::size_t number_of_triangles = 0; ///< [count]
  std::size_t number_of_joined = 0;    ///< branches sewn into a hole of their parent [count]
  std::size_t number_of_separate =
      0; ///< branches left as closed tubes because their parent has no room for a hole [count]
};

namespace internal {

/// The cross-sections of all branches relative to the root, parents first.
struct Surface_input
{
  skeleton::Vec3 origin = skeleton::Vec3::Zero();
  std::vector<skeleton::Surface_branch> branches;
  double max_radius = 0; ///< [L]
};

/// Throws `Invalid_input` if a position or radius is not finite, or a radius is negative.
template <class Kernel>
skeleton::Section read_section(const Tree_skeleton<Kernel>& tree,
                               std::size_t v,
                               const skeleton::Vec3& origin,
                               const std::string& caller)
{
  using skeleton::Vec3;
  const Tree_node<Kernel>& node = tree[v];
  skeleton::Section s;
  s.center = Vec3(CGAL::to_double(node.point.x()),
                  CGAL::to_double(node.point.y()),
                  CGAL::to_double(node.point.z())) -
             origin;
  s.radius = CGAL::to_double(node.radius);
  check(s.center.allFinite() && std::isfinite(s.radius) && s.radius >= 0,
        caller,
        "position or radius of node " + std::to_string(v) +
            " is not finite, or the radius is negative");
  s.major_radius = CGAL::to_double(node.major_radius);
  s.minor_radius = CGAL::to_double(node.minor_radius);
  s.major_axis = Vec3(CGAL::to_double(node.major_axis.x()),
                      CGAL::to_double(node.major_axis.y()),
                      CGAL::to_double(node.major_axis.z()));
  if (!(s.major_axis.squaredNorm() > 0))
    s.major_radius = s.minor_radius = 0;
  return s;
}

template <class Kernel>
Surface_input read_surface_input(const Tree_skeleton<Kernel>& tree, const std::string& caller)
{
  const auto lists = nodes_by_branch<Kernel>(tree);
  const Tree_bundle& bundle = tree[boost::graph_bundle];
  Surface_input input;
  if (bundle.root != npos) {
    const auto& p = tree[bundle.root].point;
    input.origin = {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
  }
  std::vector<std::size_t> order(lists.size()), number(lists.size());
  for (std::size_t b = 0; b < lists.size(); ++b)
    order[b] = b;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return bundle.branches[a].order < bundle.branches[b].order;
  });
  for (std::size_t k = 0; k < order.size(); ++k)
    number[order[k]] = k;
  input.branches.resize(lists.size());
  for (std::size_t b = 0; b < lists.size(); ++b) {
    skeleton::Surface_branch& branch = input.branches[number[b]];
    if (bundle.branches[b].parent != npos)
      branch.parent = number[bundle.branches[b].parent];
    for (const std::size_t v : lists[b]) {
      branch.sections.push_back(read_section(tree, v, input.origin, caller));
      input.max_radius = std::max(input.max_radius, branch.sections.back().radius);
    }
  }
  return input;
}

/// The named parameters of `make_branch_surface()`.
struct Branch_surface_options
{
  std::optional<double> tolerance; ///< [L]
  bool do_join = true;
};

/// Throws `Invalid_input` with a message that begins with `caller` if a value is out of range.
template <class NamedParameters>
Branch_surface_options read_branch_surface_options(const NamedParameters& np,
                                                   const std::string& caller)
{
  check_names<internal_np::tolerance_t, internal_np::do_join_t>(np);
  static_assert(is_parameter_v<double, NamedParameters, internal_np::tolerance_t>,
                "pcs::make_branch_surface(): named parameter `tolerance` must be a number");
  static_assert(is_parameter_v<bool, NamedParameters, internal_np::do_join_t>,
                "pcs::make_branch_surface(): named parameter `do_join` must be a bool");
  Branch_surface_options options;
  read_parameter(np, internal_np::tolerance, options.tolerance);
  if (options.tolerance)
    check_at_least(caller, "tolerance", *options.tolerance, 0);
  read_parameter(np, internal_np::do_join, options.do_join);
  return options;
}

} // namespace internal

/*!
  \ingroup PkgPcsSkeletonRef
  \brief makes the surface of a tree: generalized cylinders along the branches, joined to one closed
      mesh.

  Every branch becomes a tube through its cross-sections, with twist-free frames and a lid at the
  tip. The polygon of each ring has the area of its cross-section. Where the axis of a branch leaves
  its parent, the tube is extended backwards to a loop on the parent's surface and sewn into a hole
  there, so that the mesh has no internal walls. Every edge belongs to two triangles, which
  traverse it in opposite directions. Branches that remain inside their parent have no surface. If
  siblings leave no room for a hole, a branch is a closed tube that begins inside its parent. Thin
  tubes that touch or bend sharply may intersect themselves or each other.

  \param tree a tree; positions and radii are finite
  \param points replaced by the vertices
  \param triangles replaced by triples of indices into `points`, counter-clockwise seen from outside
  \param np
  \npbegin
    \np{tolerance} largest distance of the mesh from the cross-sections [L]; larger values give
        fewer triangles
      \nptype floating point, `>= 0`
      \npdefault `default_surface_tolerance` times the largest radius
    \np{do_join} whether branches are joined to their parents; otherwise each is a closed tube that
        begins inside its parent
      \nptype `bool`
      \npdefault `true`
  \npend
  \throws Invalid_input if a position or radius is not finite, or `tolerance` is out of range
  \par Complexity
  O(nodes log nodes + triangles).
*/
template <class Kernel, class NamedParameters = parameters::Default_named_parameters>
Branch_surface_report make_branch_surface(const Tree_skeleton<Kernel>& tree,
                                          std::vector<typename Kernel::Point_3>& points,
                                          std::vector<std::array<std::size_t, 3>>& triangles,
                                          const NamedParameters& np = NamedParameters())
{
  using FT = typename Kernel::FT;
  const std::string caller = "pcs::make_branch_surface()";
  const internal::Branch_surface_options options =
      internal::read_branch_surface_options(np, caller);
  const internal::Surface_input input = internal::read_surface_input(tree, caller);
  skeleton::Surface_options rules;
  rules.do_join = options.do_join;
  rules.tolerance = options.tolerance.value_or(default_surface_tolerance * input.max_radius);
  skeleton::Branch_surface surface = skeleton::Surface_builder(input.branches, rules)();
  std::vector<typename Kernel::Point_3> result;
  result.reserve(surface.points.size());
  for (const skeleton::Vec3& q : surface.points) {
    const skeleton::Vec3 p = q + input.origin;
    result.emplace_back(FT(p.x()), FT(p.y()), FT(p.z()));
  }
  points = std::move(result);
  triangles = std::move(surface.triangles);
  return {points.size(), triangles.size(), surface.number_of_joined, surface.number_of_separate};
}

/*!
  \ingroup PkgPcsSkeletonRef
  \brief makes the surface of a tree as a mesh of CGAL.

  \param tree a tree; positions and radii are finite
  \param mesh a model of `MutableFaceGraph` with an internal property map for `CGAL::vertex_point`,
      such as `CGAL::Surface_mesh`. The surface is added to it; it is unchanged if the function
      throws an `Invalid_input`
  \param np the named parameters of the function for points and triangles
  \throws Invalid_input if a position or radius is not finite, or `tolerance` is out of range
  \par Complexity
  O(nodes log nodes + triangles).
*/
template <class Kernel,
          class FaceGraph,
          class NamedParameters = parameters::Default_named_parameters>
Branch_surface_report make_branch_surface(const Tree_skeleton<Kernel>& tree,
                                          FaceGraph& mesh,
                                          const NamedParameters& np = NamedParameters())
{
  std::vector<typename Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  const Branch_surface_report report = make_branch_surface(tree, points, triangles, np);
  const auto point_map = get(CGAL::vertex_point, mesh);
  using Vertex = typename boost::graph_traits<FaceGraph>::vertex_descriptor;
  using Point = typename boost::property_traits<std::decay_t<decltype(point_map)>>::value_type;
  std::vector<Vertex> vertices;
  vertices.reserve(points.size());
  for (const auto& p : points) {
    vertices.push_back(add_vertex(mesh));
    put(point_map, vertices.back(), Point(p.x(), p.y(), p.z()));
  }
  for (const auto& t : triangles) {
    const std::array<Vertex, 3> corners = {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    const auto face = CGAL::Euler::add_face(corners, mesh);
    CGAL_assertion(face != boost::graph_traits<FaceGraph>::null_face()); // a closed 2-manifold
    static_cast<void>(face);
  }
  return report;
}

/// \cond
template <class Graph,
          class Points,
          class Triangles,
          class NamedParameters = parameters::Default_named_parameters>
std::enable_if_t<!skeleton::internal::is_tree_skeleton_v<Graph>, Branch_surface_report>
make_branch_surface(const Graph&, Points&, Triangles&, const NamedParameters& = NamedParameters())
{
  static_assert(skeleton::internal::is_tree_skeleton_v<Graph>,
                "pcs::make_branch_surface(): the tree must be a pcs::Tree_skeleton<Kernel>");
  return {};
}
/// \endcond

} // namespace pcs

#endif // PCS_MAKE_BRANCH_SURFACE_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes the caller's property maps of points: branches, residuals, leaves, normals, fitted
// sections.

#ifndef PCS_SKELETON_RESULT_WRITE_POINTS_H
#define PCS_SKELETON_RESULT_WRITE_POINTS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {
namespace internal {

/// Calls `f(i)` for every input point that is assigned to a branch, concurrently if the tag is
/// parallel.
template <class ConcurrencyTag, class F>
void for_each_explained(const Session<ConcurrencyTag>& session, const F& f)
{
  if (session.tree().nodes.empty())
    return;
  pcs::internal::for_each_index<ConcurrencyTag>(session.report().number_of_points,
                                                [&](std::size_t i) {
                                                  if (session.node_of_input(i) != none)
                                                    f(i);
                                                });
}

/// Calls `f(key, i, node)` for every input point in order; `node` is `none` for points that are
/// not assigned to a branch.
template <class ConcurrencyTag, class PointRange, class F>
void for_each_point(const Session<ConcurrencyTag>& session, const PointRange& points, const F& f)
{
  const bool has_tree = !session.tree().nodes.empty();
  std::size_t i = 0;
  for (auto it = std::begin(points); it != std::end(points); ++it, ++i)
    f(*it, i, has_tree ? session.node_of_input(i) : none);
}

template <class ConcurrencyTag, class PointRange, class NamedParameters>
void write_branches(const Session<ConcurrencyTag>& session,
                    const PointRange& points,
                    const NamedParameters& np)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, internal_np::point_branch_map_t>) {
    using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
    const auto map = CGAL::parameters::get_parameter(np, internal_np::point_branch_map);
    using Map = std::decay_t<decltype(map)>;
    constexpr bool is_map_ok = is_index_map_v<Map, Element>;
    static_assert(is_map_ok,
                  "pcs::extract_tree_skeleton(): named parameter `point_branch_map` must be "
                  "writable, accept an element of `points` as key, and store an integer type");
    if constexpr (is_map_ok)
      for_each_point(session, points, [&](auto&& key, std::size_t, Index v) {
        const std::size_t branch = v == none ? npos : std::size_t(session.tree().nodes[v].branch);
        put(map, key, static_cast<pcs::Map_value<Map>>(branch));
      });
  }
}

template <class ConcurrencyTag, class PointRange, class NamedParameters>
void write_residuals(const Session<ConcurrencyTag>& session,
                     const PointRange& points,
                     const NamedParameters& np)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, internal_np::point_residual_map_t>) {
    using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
    const auto map = CGAL::parameters::get_parameter(np, internal_np::point_residual_map);
    using Map = std::decay_t<decltype(map)>;
    constexpr bool is_map_ok = is_length_map_v<Map, Element>;
    static_assert(is_map_ok,
                  "pcs::extract_tree_skeleton(): named parameter `point_residual_map` must be "
                  "writable, accept an element of `points` as key, and store floating point "
                  "numbers");
    if constexpr (is_map_ok) {
      std::vector<double> residuals(session.report().number_of_points, 0);
      for_each_explained(session,
                         [&](std::size_t i) { residuals[i] = session.residual_of_input(i); });
      for_each_point(session, points, [&](auto&& key, std::size_t i, Index) {
        put(map, key, pcs::Map_value<Map>(residuals[i]));
      });
    }
  }
}

template <class ConcurrencyTag, class PointRange, class NamedParameters>
void write_leaves(const Session<ConcurrencyTag>& session,
                  const PointRange& points,
                  const NamedParameters& np)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, internal_np::point_is_leaf_map_t>) {
    using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
    const auto map = CGAL::parameters::get_parameter(np, internal_np::point_is_leaf_map);
    constexpr bool is_map_ok = is_map_for_v<std::decay_t<decltype(map)>, Element, bool>;
    static_assert(is_map_ok,
                  "pcs::extract_tree_skeleton(): named parameter `point_is_leaf_map` must be "
                  "writable, accept an element of `points` as key, and store bool");
    if constexpr (is_map_ok)
      for_each_point(session, points, [&](auto&& key, std::size_t i, Index) {
        put(map, key, session.is_leaf_of_input(i));
      });
  }
}

template <class ConcurrencyTag, class PointRange, class NamedParameters>
void write_normals(const Session<ConcurrencyTag>& session,
                   const PointRange& points,
                   const NamedParameters& np)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>) {
    using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
    const auto map = CGAL::parameters::get_parameter(np, CGAL::internal_np::normal_map);
    using Map = std::decay_t<decltype(map)>;
    constexpr bool is_map_ok = is_vector_map_v<Map, Element>;
    static_assert(is_map_ok,
                  "pcs::extract_tree_skeleton(): named parameter `normal_map` must be writable, "
                  "accept an element of `points` as key, and store vectors with x(), y(), z() "
                  "and a constructor from three coordinates");
    if constexpr (is_map_ok) {
      using V = pcs::Map_value<Map>;
      using FT = std::decay_t<decltype(std::declval<const V&>().x())>;
      std::vector<Vec3> normals(session.report().number_of_points, Vec3::Zero());
      for_each_explained(session, [&](std::size_t i) { normals[i] = session.normal_of_input(i); });
      for_each_point(session, points, [&](auto&& key, std::size_t i, Index) {
        const Vec3& n = normals[i];
        put(map, key, V(FT(n.x()), FT(n.y()), FT(n.z())));
      });
    }
  }
}

template <class ConcurrencyTag, class PointRange, class NamedParameters>
void write_densities(const Session<ConcurrencyTag>& session,
                     const PointRange& points,
                     const NamedParameters& np)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, internal_np::point_is_dense_map_t>) {
    using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
    const auto map = CGAL::parameters::get_parameter(np, internal_np::point_is_dense_map);
    constexpr bool is_map_ok = is_map_for_v<std::decay_t<decltype(map)>, Element, bool>;
    static_assert(is_map_ok,
                  "pcs::extract_tree_skeleton(): named parameter `point_is_dense_map` must be "
                  "writable, accept an element of `points` as key, and store bool");
    if constexpr (is_map_ok)
      for_each_point(session, points, [&](auto&& key, std::size_t, Index v) {
        put(map, key, v != none && session.tree().nodes[v].is_measured);
      });
  }
}

} // namespace internal

/// Writes the property maps of points that are given in `np`, on the calling thread. O(n) for n
/// points.
template <class ConcurrencyTag, class PointRange, class NamedParameters>
void write_points(const Session<ConcurrencyTag>& session,
                  const PointRange& points,
                  const NamedParameters& np)
{
  internal::write_branches(session, points, np);
  internal::write_residuals(session, points, np);
  internal::write_leaves(session, points, np);
  internal::write_normals(session, points, np);
  internal::write_densities(session, points, np);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESULT_WRITE_POINTS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees on the paths between trees of a shape space and beyond, with skeletons and points.

#ifndef PCS_ORL_TREE_PATHS_H
#define PCS_ORL_TREE_PATHS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_tree.h>
#include <pcs/Orl_tree_family.h>
#include <pcs/concepts.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/text.h>
#include <pcs/shape_space/Space_engine.h>
#include <pcs/shape_space/family/Family_points.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/input/write_skeleton.h>
#include <pcs/shape_space/pair/Embedded_pair.h>
#include <pcs/shape_space/path/Sequential_births.h>
#include <pcs/shape_space/points/Point_instances.h>

#include <CGAL/property_map.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief The trees of an `Orl_shape_space`, as points: paths between them, and what trees on these
      look like.

  The base of `Orl_shape_space`; everything here needs a space that was built, and throws
  `pcs::Invalid_input` otherwise.

  \par Determinism
  Same bits for every number of threads. Of a built space nothing changes: all functions may run
  concurrently.
*/
template <class ConcurrencyTag>
class Orl_tree_paths : public Orl_tree_family<ConcurrencyTag>
{
  using Family = Orl_tree_family<ConcurrencyTag>;

public:
  using Handle = typename Family::Handle;

  /*!
    \brief returns the tree at `lambda` on the geodesic from `a` (0) to `b` (1), or beyond its ends.

    Beyond the ends lengths and radii stay positive, and edges turn by at most `maximal_turn`:
    against what they grow from, and in space. Nothing grows below the base, against the direction
    of growth, unless it does at one of the ends: where it would, branches stay closer to what they
    are at the end.

    \npbegin
      \np{maximal_turn} how far an edge turns beyond an end of the path [rad]
        \nptype `double`, `>= 0`; from pi on there is no limit
        \npdefault `pi / 4`
      \np{do_limit_radii} whether branches are made no thicker than where they grow from
        \nptype `bool`
        \npdefault `false`: real trees break that rule
      \np{birth_order} how branches that only one of the trees has come into being
        \nptype `Branch_emergence`
        \npdefault `simultaneous`: coordinates are linear. `sequential` for trees that grow at their
            tips: it predicts the tree
        between better, and is as short in `Orl_metric::sum`, with constant speed there
    \npend
    \throws pcs::Invalid_input when `lambda` is not finite, or so large that coordinates are not, or
        a handle is wrong
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree
  geodesic(Handle a, Handle b, double lambda, const NamedParameters& np = NamedParameters()) const
  {
    Orl_tree result;
    geodesic(a, b, lambda, result, np);
    return result;
  }

  //! the same into `result`, whose memory is used again
  template <class NamedParameters = parameters::Default_named_parameters>
  void geodesic(Handle a,
                Handle b,
                double lambda,
                Orl_tree& result,
                const NamedParameters& np = NamedParameters()) const
  {
    check_built("geodesic");
    this->check_handle(std::max(a, b), "geodesic");
    if (a == b && std::isfinite(lambda))
      lambda = 0;
    // one direction only, so that the path back is the same
    const double t = a <= b ? lambda : 1 - lambda;
    if (!is_pair()) {
      result.m_share.assign(this->number_of_trees(), 0);
      const double share = std::min(1.0, std::max(0.0, a == b ? 0.0 : lambda));
      result.m_share[a] += 1 - share;
      result.m_share[b] += share;
    }
    make_tree(this->m_family.x[std::min(a, b)],
              this->m_family.x[std::max(a, b)],
              t,
              a == b ? (a == 1 ? 1 : 0) : t,
              np,
              result);
  }

  //! the same between trees of the space
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree geodesic(const Orl_tree& a,
                    const Orl_tree& b,
                    double lambda,
                    const NamedParameters& np = NamedParameters()) const
  {
    check_built("geodesic");
    this->check_tree(a, "geodesic");
    this->check_tree(b, "geodesic");
    Orl_tree result;
    this->mix_shares(
        {&a, &b},
        {1 - std::min(1.0, std::max(0.0, lambda)), std::min(1.0, std::max(0.0, lambda))},
        result);
    make_tree(a.m_x, b.m_x, lambda, (1 - lambda) * a.m_lambda + lambda * b.m_lambda, np, result);
    return result;
  }

  /*!
    \brief writes a tree of the space as a skeleton; branches of length 0 are left out.

    Every branch begins with a node of its own on the axis of its parent.
    \param result is replaced
  */
  template <class OutKernel>
  void skeleton(const Orl_tree& t, Tree_skeleton<OutKernel>& result) const
  {
    check_built("skeleton");
    this->check_tree(t, "skeleton");
    shape_space::write_skeleton(this->m_family.layout,
                                t.m_x,
                                t.m_geometry,
                                this->m_family.origin,
                                result);
  }

  /*!
    \brief writes the points of a tree of the space.

    Pairs come by edge; at `lambda` 0 and 1 the points are those of the scans, as often as they have
    partners, and points of branches that the tree lacks are left out. Where a branch of both trees
    has points in one scan only, these are there all along the path.

    \param result a random access range; a container with `resize()` gets the size
           `t.number_of_points()`, which allocates nothing if its capacity suffices; another range
           must have that size at least
    \npbegin
      \np{point_map} where a position is written
        \nptype model of `WritablePropertyMap`, key: element of `result`, value: `Kernel::Point_3`
        \npdefault `CGAL::Identity_property_map`
      \np{normal_map} where a normal is written, if both scans have normals
        \nptype model of `WritablePropertyMap`, value: `Kernel::Vector_3`
        \npdefault none
      \np{point_path} how the points of a pair are joined
        \nptype `Point_path`
        \npdefault `cylindrical`; `virtual_edges` is the text's
    \npend
    \return the number of points
    \par Complexity
    Linear in the number of points; no allocation.
  */
  template <class PointRange, class NamedParameters = parameters::Default_named_parameters>
  std::size_t
  points(const Orl_tree& t, PointRange& result, const NamedParameters& np = NamedParameters()) const
  {
    check_built("points");
    this->check_tree(t, "points");
    const std::size_t n = t.number_of_points();
    shape_space::internal::resize_range(result, n, "pcs::Orl_shape_space::points()");
    const auto point_map = pcs::internal::choose(
        np,
        CGAL::internal_np::point_map,
        CGAL::Identity_property_map<std::decay_t<decltype(*std::begin(result))>>());
    constexpr bool has_normals =
        pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>;
    const auto normal_map = pcs::internal::choose(np, CGAL::internal_np::normal_map, 0);
    if (has_normals && !(is_pair() ? m_built.instances.has_normals() : m_points.has_normals()))
      throw Invalid_input(
          "pcs::Orl_shape_space::points(): `normal_map` needs trees that were added with normals");
    using Point = Map_value<std::decay_t<decltype(point_map)>>;
    const shape_space::Vec3 origin = this->m_family.origin;
    const auto begin = std::begin(result);
    const auto put_point = [&, origin](std::size_t i,
                                       const shape_space::Vec3& p,
                                       const shape_space::Vec3& normal,
                                       std::size_t) {
      using Number = std::decay_t<decltype(std::declval<const Point&>().x())>;
      const shape_space::Vec3 q = p + origin;
      auto&& key = *(begin + static_cast<std::ptrdiff_t>(i));
      put(point_map,
          key,
          Point(static_cast<Number>(q.x()),
                static_cast<Number>(q.y()),
                static_cast<Number>(q.z())));
      if constexpr (has_normals) {
        using Vector = Map_value<std::decay_t<decltype(normal_map)>>;
        put(normal_map,
            key,
            Vector(static_cast<Number>(normal.x()),
                   static_cast<Number>(normal.y()),
                   static_cast<Number>(normal.z())));
      } else
        static_cast<void>(normal);
    };
    if (!is_pair()) {
      m_points.write(this->m_family.layout,
                     t.m_x,
                     t.m_geometry,
                     t.m_offset,
                     t.m_share,
                     put_point,
                     ConcurrencyTag());
      return n;
    }
    m_built.instances.write(
        this->m_family.layout,
        t.m_x,
        t.m_geometry,
        t.m_lambda,
        pcs::internal::choose(np, pcs::internal_np::point_path, Point_path::cylindrical),
        t.m_offset,
        put_point,
        ConcurrencyTag());
    return n;
  }

  /*!
    \brief calls `f(i, a, b, w)` for every point of a tree of the space: `a` and `b` are the numbers
        of the points it comes
    from in the two scans, `npos` where there is none, `w` is the share of the second, in [0, 1].

    Attributes are blended with it: `result[i] = (1 - w) * one[a] + w * two[b]`. `f` may be called
    concurrently.
  */
  template <class F>
  void for_each_point(const Orl_tree& t, const F& f) const
  {
    check_built("for_each_point");
    check_two("for_each_point");
    this->check_tree(t, "for_each_point");
    const double share = std::min(1.0, std::max(0.0, t.m_lambda));
    m_built.instances.for_each_pair(
        t.m_x,
        t.m_offset,
        [&](std::size_t i, const shape_space::Point_pair& pair) {
          const bool has_a = pair.point[0] != shape_space::no_point;
          const bool has_b = pair.point[1] != shape_space::no_point;
          f(i,
            has_a ? std::size_t(pair.point[0]) : npos,
            has_b ? std::size_t(pair.point[1]) : npos,
            has_a ? (has_b ? share : 0.0) : 1.0);
        },
        ConcurrencyTag());
  }

  /*!
    \brief calls `f(i, h, k, w)` for every point of a tree of a space of more than two trees and
        every point it is made
    from: point `k` of the scan of tree `h`, with a weight `w` in (0, 1]; weights of a point add up
    to 1.

    Attributes are blended with it: `result[i] += w * scan[h][k]`. `f` may be called concurrently,
    but not for one `i`.
  */
  template <class F>
  void for_each_source(const Orl_tree& t, const F& f) const
  {
    check_built("for_each_source");
    this->check_tree(t, "for_each_source");
    if (is_pair())
      throw Invalid_input(
          "pcs::Orl_shape_space::for_each_source(): points of two trees come from both; use "
          "for_each_point()");
    const std::vector<std::size_t>& first = m_points.first();
    pcs::internal::for_each_index<ConcurrencyTag>(
        t.m_x.length.size(),
        [&](std::size_t e) {
          if (t.m_x.length[e] > 0)
            for (std::size_t k = first[e]; k < first[e + 1]; ++k)
              m_points.for_each_source(k,
                                       t.m_share,
                                       [&](std::size_t h, std::size_t point, double w) {
                                         f(t.m_offset[e] + k - first[e], h, point, w);
                                       });
        },
        64);
  }

  //! whether trees of the space have points; \pre it was built
  bool has_points() const
  {
    return !this->m_family.first_point.empty() && this->m_family.first_point.back() > 0;
  }
  //! whether these have normals; \pre it was built
  bool has_normals() const
  {
    return is_pair() ? m_built.instances.has_normals() : m_points.has_normals();
  }

protected:
  bool is_pair() const { return this->number_of_trees() == 2; }

  void check_two(const char* caller) const
  {
    if (!is_pair())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): for two trees only, there are " +
                          std::to_string(this->number_of_trees()));
  }
  void check_built(const char* caller) const
  {
    if (!m_is_built || this->m_family.x.empty()) // empty: moved from
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): call build() first");
  }

  template <class NamedParameters>
  void make_tree(const shape_space::Orl_coordinates& a,
                 const shape_space::Orl_coordinates& b,
                 double t,
                 double lambda,
                 const NamedParameters& np,
                 Orl_tree& result) const
  {
    shape_space::Path_options options;
    options.maximal_turn = pcs::internal::choose(np,
                                                 pcs::internal_np::maximal_turn,
                                                 0.25 * static_cast<double>(EIGEN_PI));
    options.do_limit_radii = pcs::internal::choose(np, pcs::internal_np::do_limit_radii, false);
    options.births = pcs::internal::choose(np,
                                           pcs::internal_np::branch_emergence,
                                           Branch_emergence::simultaneous);
    if (!std::isfinite(t))
      throw Invalid_input("pcs::Orl_shape_space::geodesic(): `lambda` is not finite");
    if (!(options.maximal_turn >= 0))
      throw Invalid_input("pcs::Orl_shape_space::geodesic(): `maximal_turn` is " +
                          pcs::internal::to_text(options.maximal_turn) + ", expected at least 0");
    Family::Engine::tree_at(this->m_family,
                            a,
                            b,
                            t,
                            options,
                            result.m_buffers,
                            result.m_births,
                            result.m_x,
                            result.m_geometry);
    result.m_lambda = lambda;
    for (const shape_space::Vec3& p : result.m_geometry.node)
      if (!p.allFinite())
        throw Invalid_input("pcs::Orl_shape_space::geodesic(): `lambda` is " +
                            pcs::internal::to_text(t) + ", lengths there are no finite numbers");
    this->m_family.find_offsets(result.m_x, result.m_offset);
  }

  shape_space::Embedded_pair m_built;  // of two trees
  shape_space::Family_points m_points; // of more
  bool m_is_built = false;
};

} // namespace pcs

#endif // PCS_ORL_TREE_PATHS_H

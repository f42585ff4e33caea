// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Access to the caller's points, normals, vectors and tensors through property maps.

#ifndef PCS_DEFORMATION_ACCESS_POINT_ACCESS_H
#define PCS_DEFORMATION_ACCESS_POINT_ACCESS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/deformation/access/Element_positions.h>
#include <pcs/deformation/access/read_options.h>
#include <pcs/deformation/access/stream_block.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/parallel.h>

#include <CGAL/property_map.h>

#include <boost/property_map/property_map.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

struct No_map
{
};

} // namespace internal

/// The chain of named parameters if it has property maps, otherwise an empty chain.
template <class NamedParameters>
using Map_parameters = std::conditional_t<
    pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::point_t> ||
        pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t> ||
        pcs::internal::is_given_v<NamedParameters, pcs::internal_np::vector_map_t> ||
        pcs::internal::is_given_v<NamedParameters, pcs::internal_np::tensor_map_t> ||
        pcs::internal::is_given_v<NamedParameters, pcs::internal_np::gradient_map_t>,
    NamedParameters,
    parameters::Default_named_parameters>;

template <class PointRange,
          class PointMap,
          class NormalMap,
          class VectorMap,
          class TensorMap,
          class GradientMap>
class Map_access;

namespace internal {

/// The map that is given for `Tag`, or `Fallback`.
template <class NamedParameters, class Tag, class Fallback = No_map>
using Given_map =
    std::decay_t<decltype(pcs::internal::choose(std::declval<const NamedParameters&>(),
                                                std::declval<Tag>(),
                                                std::declval<Fallback>()))>;

} // namespace internal

/// The access through the maps of a chain of named parameters. Chains with the same maps share it,
/// and what is compiled for it.
template <class PointRange, class NamedParameters>
using Point_access =
    Map_access<PointRange,
               internal::Given_map<
                   NamedParameters,
                   CGAL::internal_np::point_t,
                   CGAL::Identity_property_map<std::decay_t<pcs::Element_reference<PointRange>>>>,
               internal::Given_map<NamedParameters, CGAL::internal_np::normal_t>,
               internal::Given_map<NamedParameters, pcs::internal_np::vector_map_t>,
               internal::Given_map<NamedParameters, pcs::internal_np::tensor_map_t>,
               internal::Given_map<NamedParameters, pcs::internal_np::gradient_map_t>>;

/*!
  Reads and writes the points of a range through property maps; `internal::No_map` stands for a map
  that is not given. Checks the concepts of range and maps. If `is_ok` is false, a `static_assert`
  has failed, and no member should be instantiated.
*/
template <class PointRange,
          class PointMap,
          class NormalMap,
          class VectorMap,
          class TensorMap,
          class GradientMap>
class Map_access
{
  using Element = pcs::Element_reference<PointRange>;
  using Value = std::decay_t<Element>;

public:
  using Point_map = PointMap;
  using Normal_map = NormalMap;
  using Vector_map = VectorMap;
  using Tensor_map = TensorMap;
  using Gradient_map = GradientMap;

  static constexpr bool has_normals = !std::is_same_v<Normal_map, internal::No_map>;
  static constexpr bool has_vectors = !std::is_same_v<Vector_map, internal::No_map>;
  static constexpr bool has_tensors = !std::is_same_v<Tensor_map, internal::No_map>;
  static constexpr bool has_gradient_map = !std::is_same_v<Gradient_map, internal::No_map>;
  static constexpr bool has_gradients = has_vectors || has_tensors || has_gradient_map;

  using Point = Map_value<Point_map>;
  using Normal = std::conditional_t<has_normals, Map_value<Normal_map>, Point>;

private:
  static constexpr bool is_range_ok = is_random_access_range_v<PointRange>;
  static_assert(is_range_ok,
                "pcs::Point_set_deformation: the points must be a random access range, for example "
                "a std::vector");
  static constexpr bool is_point_ok = is_point_or_vector_v<Point>;
  static_assert(is_point_ok,
                "pcs::Point_set_deformation: `point_map` must be a property map that stores points "
                "with x(), y(), z(), which are no integers, and a constructor from three "
                "coordinates, like Kernel::Point_3");
  static constexpr bool is_point_map_ok = is_read_write_map_v<Point_map, Element, Point>;
  static_assert(!is_point_ok || is_point_map_ok,
                "pcs::Point_set_deformation: named parameter `point_map` must be readable and "
                "writable and accept "
                "an element of `points` as key");
  static constexpr bool is_normal_map_ok =
      !has_normals ||
      (is_point_or_vector_v<Normal> && is_read_write_map_v<Normal_map, Element, Normal>);
  static_assert(is_normal_map_ok,
                "pcs::Point_set_deformation: named parameter `normal_map` must be readable and "
                "writable, accept an "
                "element of `points` as key, and store vectors like Kernel::Vector_3");
  static constexpr bool is_vector_map_ok =
      !has_vectors || (is_point_or_vector_v<Map_value<Vector_map>> &&
                       is_read_write_map_v<Vector_map, Element, Map_value<Vector_map>>);
  static_assert(is_vector_map_ok,
                "pcs::Point_set_deformation: named parameter `vector_map` must be readable and "
                "writable, accept an element of `points` as key, and store vectors like "
                "Kernel::Vector_3");
  static constexpr bool is_tensor_map_ok =
      !has_tensors || (is_matrix_3_v<Map_value<Tensor_map>> &&
                       is_read_write_map_v<Tensor_map, Element, Map_value<Tensor_map>>);
  static_assert(
      is_tensor_map_ok,
      "pcs::Point_set_deformation: named parameter `tensor_map` must be readable and "
      "writable, accept an element of `points` as key, and store 3 x 3 matrices of Eigen");
  static constexpr bool is_gradient_map_ok =
      !has_gradient_map || (is_matrix_3_v<Map_value<Gradient_map>> &&
                            is_map_for_v<Gradient_map, Element, Map_value<Gradient_map>>);
  static_assert(is_gradient_map_ok,
                "pcs::Point_set_deformation: named parameter `gradient_map` must be writable, "
                "accept an element of `points` as key, and take 3 x 3 matrices of Eigen");

public:
  static constexpr bool is_ok = is_vector_map_ok && is_tensor_map_ok && is_gradient_map_ok &&
                                is_range_ok && is_point_ok && is_point_map_ok && is_normal_map_ok;

  /// Whether elements of the range, such as vertex descriptors, can name the points of handles.
  static constexpr bool has_keys = !std::is_same_v<Value, Point> && !std::is_integral_v<Value> &&
                                   internal::Is_ordered<Value>::value;

  /// Whether small keys are copied, since the iterators of a mesh with removed elements need O(n)
  /// for a step.
  static constexpr bool has_copied_keys = [] {
    if constexpr (!is_ok || !has_keys || !std::is_trivially_copyable_v<Value>)
      return false;
    else // a map that writes into the element does not accept a constant one
      return sizeof(Value) <= sizeof(void*) && is_read_write_map_v<Point_map, const Value&, Point>;
  }();

  /// Whether only coordinates in memory are written.
  static constexpr bool is_memory = [] {
    if constexpr (!is_ok || has_copied_keys || has_gradients ||
                  !pcs::internal::has_streaming_stores)
      return false;
    else if constexpr (!has_size_of_triple<Point>() || !has_size_of_triple<Normal>())
      return false;
    else if constexpr (has_normals)
      return is_memory_map<Point_map, Element>() && is_memory_map<Normal_map, Element>();
    else
      return is_memory_map<Point_map, Element>();
  }();

  /// Whether a chain of named parameters has maps of these types.
  template <class NamedParameters>
  static constexpr bool has_maps_of()
  {
    return std::is_same_v<Map_access, Point_access<PointRange, NamedParameters>>;
  }

  /// Keeps a reference to `points`, and copies of the maps of `np`.
  template <class GivenParameters>
  Map_access(PointRange& points, const GivenParameters& np) : m_points(&points)
  {
    static_assert(has_maps_of<GivenParameters>(),
                  "pcs::Point_set_deformation: the second template argument must be a chain of "
                  "named parameters with the maps that are given to the constructor, such as "
                  "decltype(pcs::parameters::point_map(map)); it may be omitted if none is given");
    if constexpr (has_maps_of<GivenParameters>())
      keep_maps(np);
  }

  std::size_t size() const
  {
    return static_cast<std::size_t>(std::distance(std::begin(*m_points), std::end(*m_points)));
  }

  /// Returns the points that a handle or a region names by their positions or by elements of the
  /// range, among the first `n` points. Throws like `read_indices()`, and if an element is not
  /// found.
  template <class Range>
  std::vector<std::uint32_t>
  positions_of(const Range& range, [[maybe_unused]] std::size_t n, const std::string& caller)
  {
    if constexpr (has_keys && internal::Is_range_of<Range, Value>::value) {
      if (!m_positions)
        m_positions = std::make_unique<Element_positions<Value>>(*m_points);
      return m_positions->find(range, caller);
    } else
      return read_indices(range, n, caller);
  }

  Vec3 point(std::size_t i) const
  {
    return with_element(i, [this](auto&& key) {
      return pcs::internal::to_eigen(get(*m_point_map, key));
    });
  }

  /// Returns the normal of point `i`, or the null vector without normals.
  Vec3 normal(std::size_t i) const
  {
    if constexpr (has_normals)
      return with_element(i, [this](auto&& key) {
        return pcs::internal::to_eigen(get(*m_normal_map, key));
      });
    else
      return Vec3::Zero();
  }

  /// Returns all points. Throws `Invalid_input`, with a message that begins with `function`, if a
  /// point is not finite.
  template <class ConcurrencyTag>
  std::vector<Vec3> points(const char* function) const
  {
    std::vector<Vec3> points(size());
    pcs::internal::for_each_index<ConcurrencyTag>(points.size(),
                                                  [&](std::size_t i) { points[i] = point(i); });
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!points[i].allFinite())
        throw Invalid_input(std::string(function) + ": point " + std::to_string(i) +
                            " is not finite");
    return points;
  }

  /// Returns all points of a session. Throws like `points()`. It also throws if there are no points
  /// or too many, or a normal, vector or tensor is not finite.
  template <class ConcurrencyTag>
  std::vector<Vec3> points_of_session(const char* function) const
  {
    const std::size_t n = size();
    pcs::internal::check(n > 0, function, "there are no points");
    if (n >= std::numeric_limits<std::uint32_t>::max() / 64)
      throw Invalid_input(std::string(function) + ": " + std::to_string(n) +
                          " points are too many for 32 bit indices of their links; deform a "
                          "sample of them");
    std::vector<Vec3> result = points<ConcurrencyTag>(function);
    check_attributes(function);
    return result;
  }

  /// Throws like `points()` if a normal, vector or tensor is not finite.
  void check_attributes(const char* function) const
  {
    const auto is_finite = [&](std::size_t i) {
      bool result = true;
      if constexpr (has_normals)
        result = normal(i).allFinite();
      if constexpr (has_vectors)
        result = result && pcs::internal::to_eigen(attribute(*m_vector_map, i)).allFinite();
      if constexpr (has_tensors)
        result = result && attribute(*m_tensor_map, i).allFinite();
      return result;
    };
    if constexpr (has_normals || has_vectors || has_tensors)
      for (std::size_t i = 0, n = size(); i < n; ++i)
        if (!is_finite(i))
          throw Invalid_input(std::string(function) + ": the normal, vector or tensor of point " +
                              std::to_string(i) + " is not finite");
  }

  /// Makes the current vectors and tensors those of the rest shape.
  void keep_rest_attributes()
  {
    m_rest_vectors.resize(has_vectors ? size() : 0);
    m_rest_tensors.resize(has_tensors ? size() : 0);
    for (std::size_t i = 0; i < m_rest_vectors.size(); ++i)
      if constexpr (has_vectors)
        m_rest_vectors[i] = pcs::internal::to_eigen(attribute(*m_vector_map, i));
    for (std::size_t i = 0; i < m_rest_tensors.size(); ++i)
      if constexpr (has_tensors)
        m_rest_tensors[i] = attribute(*m_tensor_map, i).template cast<double>();
  }

  /// Prefetches the memory that `write()` will change.
  PCS_ALWAYS_INLINE void prefetch(std::size_t i) const
  {
    with_element(i, [this](auto&& key) PCS_LAMBDA_INLINE {
      prefetch_value(*m_point_map, key);
      if constexpr (has_normals)
        prefetch_value(*m_normal_map, key);
    });
  }

  /// Writes point `i` and its deformation gradient, which maps its vectors and tensors at rest.
  PCS_ALWAYS_INLINE void write(std::size_t i,
                               const Vec3& p,
                               [[maybe_unused]] const Vec3& normal,
                               [[maybe_unused]] const Eigen::Matrix3d& gradient)
  {
    with_element(i, [&](auto&& key) PCS_LAMBDA_INLINE {
      put(*m_point_map, key, make<Point>(p));
      if constexpr (has_normals)
        put(*m_normal_map, key, make<Normal>(normal));
      if constexpr (has_vectors)
        put(*m_vector_map, key, make<Map_value<Vector_map>>(gradient * m_rest_vectors[i]));
      if constexpr (has_tensors) {
        using Tensor = Map_value<Tensor_map>;
        const Eigen::Matrix3d tensor = gradient * m_rest_tensors[i] * gradient.transpose();
        put(*m_tensor_map, key, Tensor(tensor.template cast<typename Tensor::Scalar>()));
      }
      if constexpr (has_gradient_map) {
        using Gradient = Map_value<Gradient_map>;
        put(*m_gradient_map, key, Gradient(gradient.template cast<typename Gradient::Scalar>()));
      }
    });
  }

  /// Whether `stream()` may succeed and pays for the size of the output.
  bool can_stream() const
  {
    if constexpr (is_memory)
      return size() * (sizeof(Point) + (has_normals ? sizeof(Normal) : 0)) >= smallest_stream &&
             is_triple<Point>() && is_triple<Normal>() && find_rows(0).point;
    else
      return false;
  }

  /// Writes the elements of a block from `first` on like `write()`, but bypasses the caches. If
  /// their coordinates are not consecutive in memory, writes nothing and returns `false`.
  PCS_ALWAYS_INLINE bool stream([[maybe_unused]] std::size_t first,
                                [[maybe_unused]] const Lane_vectors& positions,
                                [[maybe_unused]] const Lane_vectors& normals) const
  {
    if constexpr (!is_memory)
      return false;
    else {
      const Rows to = find_rows(first);
      if (!to.point)
        return false;
      if (to.normal && !to.are_pairs)
        stream_block(to.normal, normals);
      if (to.are_pairs)
        stream_block(to.point, positions, normals);
      else
        stream_block(to.point, positions);
      return true;
    }
  }

  /// Converts to a point or vector of the caller's type.
  template <class Triple>
  static PCS_ALWAYS_INLINE Triple make(const Vec3& v)
  {
    using FT = std::decay_t<decltype(std::declval<const Triple&>().x())>;
    return Triple(static_cast<FT>(v.x()), static_cast<FT>(v.y()), static_cast<FT>(v.z()));
  }

private:
  template <class GivenParameters>
  void keep_maps(const GivenParameters& np)
  {
    if constexpr (has_copied_keys)
      m_keys.assign(std::begin(*m_points), std::end(*m_points));
    if constexpr (pcs::internal::is_given_v<GivenParameters, CGAL::internal_np::point_t>)
      m_point_map = std::make_unique<Point_map>(
          CGAL::parameters::get_parameter(np, CGAL::internal_np::point_map));
    else
      m_point_map = std::make_unique<Point_map>();
    if constexpr (has_normals)
      m_normal_map = std::make_unique<Normal_map>(
          CGAL::parameters::get_parameter(np, CGAL::internal_np::normal_map));
    if constexpr (has_vectors)
      m_vector_map = std::make_unique<Vector_map>(
          CGAL::parameters::get_parameter(np, pcs::internal_np::vector_map));
    if constexpr (has_tensors)
      m_tensor_map = std::make_unique<Tensor_map>(
          CGAL::parameters::get_parameter(np, pcs::internal_np::tensor_map));
    if constexpr (has_gradient_map)
      m_gradient_map = std::make_unique<Gradient_map>(
          CGAL::parameters::get_parameter(np, pcs::internal_np::gradient_map));
  }

  PCS_ALWAYS_INLINE auto iterator(std::size_t i) const
  {
    using Iterator = decltype(std::begin(*m_points));
    return std::begin(*m_points) +
           static_cast<typename std::iterator_traits<Iterator>::difference_type>(i);
  }

  /// Calls `f` with element `i`, which may be stored in its iterator.
  template <class F>
  PCS_ALWAYS_INLINE decltype(auto) with_element(std::size_t i, const F& f) const
  {
    if constexpr (has_copied_keys)
      return f(m_keys[i]);
    else {
      const auto it = iterator(i);
      return f(*it);
    }
  }

  template <class Map>
  auto attribute(const Map& map, std::size_t i) const
  {
    return with_element(i, [&](auto&& key) -> Map_value<Map> { return get(map, key); });
  }

  /// Addresses of the coordinates of a block if these are consecutive in memory, otherwise null.
  struct Rows
  {
    double *point = nullptr, *normal = nullptr;
    bool are_pairs = false; ///< whether each point is followed by its normal
  };

  PCS_ALWAYS_INLINE Rows find_rows(std::size_t first) const
  {
    const auto element = iterator(first);
    if constexpr (has_normals) {
      double* const pairs = run(*m_point_map, element, 6);
      if (is_streamable(pairs) && run(*m_normal_map, element, 6) == pairs + 3)
        return {pairs, pairs + 3, true};
      double* const point = run(*m_point_map, element, 3);
      double* const normal = run(*m_normal_map, element, 3);
      if (is_streamable(point) && is_streamable(normal))
        return {point, normal, false};
    } else {
      double* const point = run(*m_point_map, element, 3);
      if (is_streamable(point))
        return {point, nullptr, false};
    }
    return {};
  }

  /// Returns the address of the values of the block that begins at `first` if their addresses are
  /// `stride` doubles apart, otherwise null.
  template <class Map, class Iterator>
  static PCS_ALWAYS_INLINE double* run(const Map& map, const Iterator& first, std::size_t stride)
  {
    using Difference = typename std::iterator_traits<Iterator>::difference_type;
    return find_run(
        [&](std::size_t l) PCS_LAMBDA_INLINE -> const Map_value<Map>& {
          return get(map, *(first + static_cast<Difference>(l)));
        },
        stride);
  }

  template <class Map, class Key>
  static PCS_ALWAYS_INLINE void prefetch_value(const Map& map, Key&& key)
  {
    if constexpr (std::is_lvalue_reference_v<decltype(get(map, key))>)
      pcs::internal::prefetch(std::addressof(get(map, key)), 1);
  }

  /// Replaces the sorted elements if `has_keys` is false.
  struct Nothing
  {
  };

  PointRange* m_points;
  std::vector<std::conditional_t<has_copied_keys, Value, Nothing>> m_keys;
  std::unique_ptr<std::conditional_t<has_keys, Element_positions<Value>, Nothing>> m_positions;
  // pointers, because maps may be neither assignable nor default constructible
  std::unique_ptr<Point_map> m_point_map;
  std::unique_ptr<Normal_map> m_normal_map;
  std::unique_ptr<Vector_map> m_vector_map;
  std::unique_ptr<Tensor_map> m_tensor_map;
  std::unique_ptr<Gradient_map> m_gradient_map;
  std::vector<Vec3> m_rest_vectors;
  std::vector<Eigen::Matrix3d> m_rest_tensors;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_POINT_ACCESS_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Concept traits for ranges, property maps, callbacks and graphs; public functions check them.

#ifndef PCS_CONCEPTS_H
#define PCS_CONCEPTS_H

#include <boost/graph/graph_traits.hpp>
#include <boost/property_map/property_map.hpp>

#include <iterator>
#include <type_traits>
#include <utility>

namespace pcs {
namespace internal {

template <class T, class = void>
struct Iterator_of
{
  using type = void;
};
template <class T>
struct Iterator_of<
    T,
    std::void_t<decltype(std::begin(std::declval<T&>())), decltype(std::end(std::declval<T&>()))>>
{
  using type = decltype(std::begin(std::declval<T&>()));
};

template <class Iterator, class Category, class = void>
struct Has_category : std::false_type
{
};
template <class Iterator, class Category>
struct Has_category<Iterator,
                    Category,
                    std::void_t<typename std::iterator_traits<Iterator>::iterator_category>>
  : std::is_convertible<typename std::iterator_traits<Iterator>::iterator_category, Category>
{
};

template <class T, class = void>
struct Is_point : std::false_type
{
};
template <class T>
struct Is_point<T,
                std::void_t<decltype(std::declval<const T&>().x()),
                            decltype(std::declval<const T&>().y()),
                            decltype(std::declval<const T&>().z())>>
{
  using FT = std::decay_t<decltype(std::declval<const T&>().x())>;
  // integers cannot hold the computed coordinates
  static constexpr bool value = !std::is_integral_v<FT> && std::is_constructible_v<T, FT, FT, FT>;
};

template <class T, class = void>
struct Is_coordinate_triple : std::false_type
{
};
template <class T>
struct Is_coordinate_triple<T,
                            std::void_t<decltype(std::declval<const T&>().x()),
                                        decltype(std::declval<const T&>().y()),
                                        decltype(std::declval<const T&>().z())>> : std::true_type
{
};

template <class T, class = void>
struct Is_matrix_3 : std::false_type
{
};
template <class T>
struct Is_matrix_3<T, std::void_t<decltype(T::RowsAtCompileTime), typename T::Scalar>>
  : std::bool_constant<T::RowsAtCompileTime == 3 && T::ColsAtCompileTime == 3>
{
};

template <class Map, class = void>
struct Map_value
{
  using type = void;
};
template <class Map>
struct Map_value<Map, std::void_t<typename boost::property_traits<Map>::value_type>>
{
  using type = typename boost::property_traits<Map>::value_type;
};

template <class Map, class Key, class Value, class = void>
struct Is_readable_map : std::false_type
{
};
template <class Map, class Key, class Value>
struct Is_readable_map<Map,
                       Key,
                       Value,
                       std::void_t<decltype(get(std::declval<const Map&>(), std::declval<Key>()))>>
  : std::is_same<typename Map_value<Map>::type, Value>
{
};

template <class Map, class Key, class Value, class = void>
struct Is_writable_map : std::false_type
{
};
template <class Map, class Key, class Value>
struct Is_writable_map<Map,
                       Key,
                       Value,
                       std::void_t<decltype(put(std::declval<const Map&>(),
                                                std::declval<Key>(),
                                                std::declval<const Value&>()))>>
  : std::is_same<typename Map_value<Map>::type, Value>
{
};

} // namespace internal

//! whether `T` is a range with random access iterators
template <class T>
constexpr bool is_random_access_range_v =
    internal::Has_category<typename internal::Iterator_of<T>::type,
                           std::random_access_iterator_tag>::value;

//! the type of `*begin(range)`, which is the key of property maps of the elements
template <class Range>
using Element_reference = decltype(*std::begin(std::declval<Range&>()));

//! whether `T` has `x()`, `y()`, `z()`, which are no integers, and a constructor from three such
//! values: any `Point_3` or `Vector_3` of CGAL, `Eigen::Vector3d`, or a user-defined type
template <class T>
constexpr bool is_point_or_vector_v = internal::Is_point<T>::value;

//! whether `T` has `x()`, `y()`, `z()`; a constructor is not required of types that are only read
template <class T>
constexpr bool is_coordinate_triple_v = internal::Is_coordinate_triple<T>::value;

//! whether `T` is a 3 x 3 matrix of Eigen
template <class T>
constexpr bool is_matrix_3_v = internal::Is_matrix_3<T>::value;

//! the value type of a property map; `void` if `Map` is not a property map
template <class Map>
using Map_value = typename internal::Map_value<Map>::type;

//! whether `get(map, key)` gives a `Value`
template <class Map, class Key, class Value>
constexpr bool is_readable_map_v = internal::Is_readable_map<Map, Key, Value>::value;

//! whether `put(map, key, value)` accepts values that are converted from `Value`
template <class Map, class Key, class Value>
constexpr bool is_map_for_v = internal::Is_writable_map<Map, Key, Map_value<Map>>::value&&
    std::is_convertible<Value, Map_value<Map>>::value;

//! whether `get(map, key)` gives a `Value` and `put(map, key, value)` takes one
template <class Map, class Key, class Value>
constexpr bool is_read_write_map_v =
    is_readable_map_v<Map, Key, Value>&& internal::Is_writable_map<Map, Key, Value>::value;

namespace internal {

template <class T, class = void>
struct Is_index_range : std::false_type
{
};
template <class T>
struct Is_index_range<T, std::enable_if_t<!std::is_void_v<typename Iterator_of<const T>::type>>>
  : std::is_integral<std::decay_t<decltype(*std::begin(std::declval<const T&>()))>>
{
};

template <class T, class = void>
struct Is_point_range : std::false_type
{
};
template <class T>
struct Is_point_range<T, std::enable_if_t<!std::is_void_v<typename Iterator_of<const T>::type>>>
  : Is_point<std::decay_t<decltype(*std::begin(std::declval<const T&>()))>>
{
};

template <class Graph, class = void>
struct Is_rooted_tree_graph : std::false_type
{
};
template <class Graph>
struct Is_rooted_tree_graph<
    Graph,
    std::void_t<
        decltype(num_vertices(std::declval<const Graph&>())),
        decltype(vertices(std::declval<const Graph&>())),
        // instantiated after the checks above, because graph_traits of other types is a hard error
        typename boost::graph_traits<Graph>::vertex_descriptor,
        decltype(out_edges(std::declval<typename boost::graph_traits<Graph>::vertex_descriptor>(),
                           std::declval<const Graph&>())),
        decltype(target(std::declval<typename boost::graph_traits<Graph>::edge_descriptor>(),
                        std::declval<const Graph&>()))>>
  : std::is_convertible<typename boost::graph_traits<Graph>::directed_category, boost::directed_tag>
{
};

} // namespace internal

//! whether `T` is a range of integers: the indices of points
template <class T>
constexpr bool is_index_range_v = internal::Is_index_range<T>::value;

//! whether `T` is a range of points or vectors
template <class T>
constexpr bool is_point_range_v = internal::Is_point_range<T>::value;

//! whether `T` can be called with the completed fraction of the work and returns whether to
//! continue
template <class T>
constexpr bool is_progress_callback_v = std::is_invocable_r_v<bool, T&, double>;

//! whether `Map` is readable and its values have three coordinates
template <class Map, class Key>
constexpr bool is_readable_point_map_v =
    is_point_or_vector_v<Map_value<Map>>&& is_readable_map_v<Map, Key, Map_value<Map>>;

//! whether `Map` is writable and its values can be constructed from three coordinates
template <class Map, class Key>
constexpr bool is_writable_point_map_v = is_point_or_vector_v<Map_value<Map>>&&
    internal::Is_writable_map<Map, Key, Map_value<Map>>::value;

//! whether `Map` is readable and writable and its values have three coordinates
template <class Map, class Key>
constexpr bool is_read_write_point_map_v =
    is_point_or_vector_v<Map_value<Map>>&& is_read_write_map_v<Map, Key, Map_value<Map>>;

//! whether `Map` is readable and writable and its values are 3 x 3 matrices
template <class Map, class Key>
constexpr bool is_read_write_tensor_map_v =
    is_matrix_3_v<Map_value<Map>>&& is_read_write_map_v<Map, Key, Map_value<Map>>;

//! whether `Graph` is a directed graph whose vertices and out-edges can be listed
template <class Graph>
constexpr bool is_tree_graph_v = internal::Is_rooted_tree_graph<Graph>::value;

} // namespace pcs

#endif // PCS_CONCEPTS_H

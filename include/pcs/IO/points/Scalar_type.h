// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scalar types of point properties, and the container of one property.

#ifndef PCS_IO_POINTS_SCALAR_TYPE_H
#define PCS_IO_POINTS_SCALAR_TYPE_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief The type of one property of a point, as stored in a file.
*/
enum class Scalar_type : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64
};

/*!
  \ingroup PkgPcsIORef
  \brief The values of one property, one per point, in the type of the file.

  The alternatives are in the order of `Scalar_type`.
*/
using Property_values = std::variant<std::vector<std::int8_t>,
                                     std::vector<std::uint8_t>,
                                     std::vector<std::int16_t>,
                                     std::vector<std::uint16_t>,
                                     std::vector<std::int32_t>,
                                     std::vector<std::uint32_t>,
                                     std::vector<std::int64_t>,
                                     std::vector<std::uint64_t>,
                                     std::vector<float>,
                                     std::vector<double>>;

//! an object that represents the type `T`; `dispatch()` passes it
template <class T>
struct Type_tag
{
  using type = T;
};

namespace internal {

template <class T, std::size_t... I>
constexpr std::size_t index_of_scalar(std::index_sequence<I...>)
{
  std::size_t index = sizeof...(I);
  ((std::is_same_v<std::vector<T>, std::variant_alternative_t<I, Property_values>> ? void(index = I)
                                                                                   : void()),
   ...);
  return index;
}

template <class T>
constexpr std::size_t scalar_index =
    index_of_scalar<T>(std::make_index_sequence<std::variant_size_v<Property_values>>());

} // namespace internal

//! whether `T` is one of the ten types a property can have
template <class T>
constexpr bool is_scalar_type_v = internal::scalar_index<T> < std::variant_size_v<Property_values>;

//! returns the enumerator of `T`
template <class T>
constexpr Scalar_type scalar_type_of()
{
  static_assert(is_scalar_type_v<T>,
                "pcs::IO: a property must be of a fixed-size integer type (8 to 64 bits), "
                "`float` or `double`");
  return static_cast<Scalar_type>(internal::scalar_index<T>);
}

//! returns `f(Type_tag<T>())` for the type `T` that `type` denotes
template <class Function>
decltype(auto) dispatch(Scalar_type type, Function&& f)
{
  switch (type) {
  case Scalar_type::int8:
    return f(Type_tag<std::int8_t>());
  case Scalar_type::uint8:
    return f(Type_tag<std::uint8_t>());
  case Scalar_type::int16:
    return f(Type_tag<std::int16_t>());
  case Scalar_type::uint16:
    return f(Type_tag<std::uint16_t>());
  case Scalar_type::int32:
    return f(Type_tag<std::int32_t>());
  case Scalar_type::uint32:
    return f(Type_tag<std::uint32_t>());
  case Scalar_type::int64:
    return f(Type_tag<std::int64_t>());
  case Scalar_type::uint64:
    return f(Type_tag<std::uint64_t>());
  case Scalar_type::float32:
    return f(Type_tag<float>());
  case Scalar_type::float64:
    break;
  }
  return f(Type_tag<double>());
}

//! returns the number of bytes of one value [count]
inline std::size_t size_of(Scalar_type type)
{
  return dispatch(type, [](auto tag) { return sizeof(typename decltype(tag)::type); });
}

//! returns the name used in messages, for example `uint16`
inline const char* name_of(Scalar_type type)
{
  constexpr std::array<const char*, 10> names = {"int8",
                                                 "uint8",
                                                 "int16",
                                                 "uint16",
                                                 "int32",
                                                 "uint32",
                                                 "int64",
                                                 "uint64",
                                                 "float32",
                                                 "float64"};
  return names[static_cast<std::size_t>(type)];
}

//! whether the type is `float32` or `float64`
inline bool is_floating_point(Scalar_type type)
{
  return type == Scalar_type::float32 || type == Scalar_type::float64;
}

//! returns `n` zeros of the given type
inline Property_values make_values(Scalar_type type, std::size_t n = 0)
{
  return dispatch(type, [n](auto tag) {
    return Property_values(std::vector<typename decltype(tag)::type>(n));
  });
}

//! returns the number of values
inline std::size_t number_of_values(const Property_values& values)
{
  return std::visit([](const auto& v) { return v.size(); }, values);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_POINTS_SCALAR_TYPE_H

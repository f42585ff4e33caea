// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Properties of points that both files have, for the points between them.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_BLEND_PROPERTIES_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_BLEND_PROPERTIES_H

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Scalar_type.h>
#include <pcs/Orl_shape_space.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace orl_program {

using Table = pcs::IO::Point_table;

inline bool is_color(const std::string& name)
{
  return name == "red" || name == "green" || name == "blue" || name == "alpha";
}
inline bool is_normal(const std::string& name)
{
  return name == "nx" || name == "ny" || name == "nz";
}

/// Returns the nearest number of a type.
template <class T>
T to_type(double value)
{
  using limits = std::numeric_limits<T>;
  if (std::isnan(value))
    return std::is_floating_point_v<T> ? limits::quiet_NaN() : T(0);
  if (value <= static_cast<double>(limits::lowest()))
    return limits::lowest();
  return value >= static_cast<double>(limits::max()) ? limits::max() : static_cast<T>(value);
}

namespace internal {

/// The range of a type of columns.
struct Type_range
{
  bool is_floating, is_signed;
  int digits;

  explicit Type_range(pcs::IO::Scalar_type type)
  {
    pcs::IO::dispatch(type, [&](auto tag) {
      using Limits = std::numeric_limits<typename decltype(tag)::type>;
      is_floating = !Limits::is_integer;
      is_signed = Limits::is_signed;
      digits = Limits::digits;
    });
  }
  bool holds(const Type_range& o) const
  {
    return is_floating >= o.is_floating && is_signed >= o.is_signed && digits >= o.digits;
  }
};

} // namespace internal

/// Returns the smallest type of columns that represents the values of both types. Integers have at
/// most four bytes, the limit of PLY.
inline pcs::IO::Scalar_type wider_type(pcs::IO::Scalar_type a, pcs::IO::Scalar_type b)
{
  using Type = pcs::IO::Scalar_type;
  if (a == b)
    return a;
  for (const Type type : {Type::uint8,
                          Type::int8,
                          Type::uint16,
                          Type::int16,
                          Type::uint32,
                          Type::int32,
                          Type::float32})
    if (const internal::Type_range range(type);
        range.holds(internal::Type_range(a)) && range.holds(internal::Type_range(b)))
      return type;
  return Type::float64;
}

/// Adds a property; values are clamped to the range of the type.
inline void add_property(const std::string& name,
                         pcs::IO::Scalar_type type,
                         const std::vector<double>& values,
                         Table& out)
{
  pcs::IO::dispatch(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    std::vector<T> converted;
    for (const double value : values)
      converted.push_back(to_type<T>(value));
    out.add_property(name, std::move(converted));
  });
}

/*!
  Combines the values of many points with weights that sum to 1. Numbers with fractions are
  averaged. Colours are averaged as light intensities, which are powers of their sRGB codes. Other
  whole numbers are labels, of which the one with the largest weight is selected. Values that are
  not finite are ignored.
*/
class Mixed_value
{
public:
  Mixed_value(pcs::IO::Scalar_type type, const std::string& name)
    : m_is_whole(!pcs::IO::is_floating_point(type)), m_has_color(is_color(name))
  {
  }

  void add(double value, double w)
  {
    if (!(w > 0))
      return;
    if (!std::isfinite(value)) {
      m_left_out += w;
      return;
    }
    m_sum += w * value;
    m_light += w * std::pow(std::max(0.0, value), gamma);
    if (w > m_most) {
      m_most = w;
      m_main = value;
    }
  }
  double get() const
  {
    if (!(m_most > 0))
      return std::numeric_limits<double>::quiet_NaN();
    const double all = m_left_out > 0 ? 1 - m_left_out : 1;
    if (!m_is_whole)
      return m_sum / all;
    return m_has_color ? std::round(std::pow(m_light / all, 1 / gamma)) : m_main;
  }

private:
  static constexpr double gamma = 2.2;
  bool m_is_whole, m_has_color;
  double m_sum = 0, m_light = 0, m_most = 0, m_main = 0, m_left_out = 0;
};

/// Adds every property that both tables have to `out`, the points of `tree`, in a type that
/// represents the values of both.
template <class Space>
void blend_properties(const Space& space,
                      const pcs::Orl_tree& tree,
                      const Table& one,
                      const Table& two,
                      Table& out)
{
  for (const std::string& name : one.property_names()) {
    if (is_normal(name) || !two.has_property(name))
      continue;
    const std::vector<double> a = one.property_as_double(name), b = two.property_as_double(name);
    const pcs::IO::Scalar_type type = wider_type(one.property_type(name), two.property_type(name));
    std::vector<double> values(out.number_of_points());
    space.for_each_point(tree, [&](std::size_t i, std::size_t k, std::size_t l, double w) {
      Mixed_value mixed(type, name);
      if (l != pcs::npos)
        mixed.add(b[l], w);
      if (k != pcs::npos)
        mixed.add(a[k], 1 - w);
      values[i] = mixed.get();
    });
    add_property(name, type, values, out);
  }
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_BLEND_PROPERTIES_H

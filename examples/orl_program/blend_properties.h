// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Properties of points that both files have, for the points between them.

#ifndef PCS_EXAMPLES_ORL_PROGRAM_BLEND_PROPERTIES_H
#define PCS_EXAMPLES_ORL_PROGRAM_BLEND_PROPERTIES_H

#include <pcs/IO/Point_table.h>
#include <pcs/Orl_shape_space.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
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

/// The nearest number of a type.
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

/*!
  A value from many points with weights that add up to 1. Numbers with fractions are mixed, colours too, and of these light,
  not its code: the codes of sRGB follow a power of it. Whole numbers are labels, those of the greatest share are taken.
  What is no finite number has no part in it.
*/
template <class T>
class Mixed_value
{
public:
  explicit Mixed_value(bool has_color) : m_has_color(has_color) {}

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
  T get() const
  {
    if (!(m_most > 0))
      return to_type<T>(std::numeric_limits<double>::quiet_NaN());
    const double all = m_left_out > 0 ? 1 - m_left_out : 1;
    if (std::is_floating_point_v<T>)
      return to_type<T>(m_sum / all);
    return to_type<T>(m_has_color ? std::round(std::pow(m_light / all, 1 / gamma)) : m_main);
  }

private:
  static constexpr double gamma = 2.2;
  bool m_has_color;
  double m_sum = 0, m_light = 0, m_most = 0, m_main = 0, m_left_out = 0;
};

/// Adds every property that both tables have to `out`, the points of `tree`, in the type of the first table.
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
    const std::vector<double> b = two.property_as_double(name);
    std::visit(
        [&](const auto& a) {
          using T = typename std::decay_t<decltype(a)>::value_type;
          std::vector<T> values(out.number_of_points());
          space.for_each_point(tree, [&](std::size_t i, std::size_t k, std::size_t l, double w) {
            Mixed_value<T> mixed(is_color(name));
            if (l != pcs::npos)
              mixed.add(b[l], w);
            if (k != pcs::npos)
              mixed.add(static_cast<double>(a[k]), 1 - w);
            values[i] = mixed.get();
          });
          out.add_property(name, std::move(values));
        },
        one.property_values(name));
  }
}

} // namespace orl_program

#endif // PCS_EXAMPLES_ORL_PROGRAM_BLEND_PROPERTIES_H

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

/// Light, not its code, is mixed: the codes of sRGB follow a power of it.
inline double mix_colors(double a, double b, double w)
{
  constexpr double gamma = 2.2;
  return std::pow((1 - w) * std::pow(a, gamma) + w * std::pow(b, gamma), 1 / gamma);
}

/// Numbers with fractions are mixed, colours too; whole numbers are labels, those of the nearer tree are taken.
template <class T>
T mix_values(double a, double b, double w, bool has_color)
{
  if (std::is_floating_point_v<T>)
    return static_cast<T>((1 - w) * a + w * b);
  if (has_color)
    return static_cast<T>(std::lround(mix_colors(a, b, w)));
  return static_cast<T>(w < 0.5 ? a : b);
}

/// A value from many points with weights that add up to 1, in the same way.
template <class T>
class Mixed_value
{
public:
  explicit Mixed_value(bool has_color) : m_has_color(has_color) {}

  void add(double value, double w)
  {
    m_sum += w * value;
    m_light += w * std::pow(std::max(0.0, value), gamma);
    if (w > m_most) {
      m_most = w;
      m_main = value;
    }
  }
  T get() const
  {
    if (std::is_floating_point_v<T>)
      return static_cast<T>(m_sum);
    return static_cast<T>(
        m_has_color ? static_cast<double>(std::lround(std::pow(m_light, 1 / gamma))) : m_main);
  }

private:
  static constexpr double gamma = 2.2;
  bool m_has_color;
  double m_sum = 0, m_light = 0, m_most = 0, m_main = 0;
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
            if (k == pcs::npos)
              values[i] = static_cast<T>(b[l]);
            else if (l == pcs::npos)
              values[i] = a[k];
            else
              values[i] = mix_values<T>(static_cast<double>(a[k]), b[l], w, is_color(name));
          });
          out.add_property(name, std::move(values));
        },
        one.property_values(name));
  }
}

} // namespace orl_program

#endif // PCS_EXAMPLES_ORL_PROGRAM_BLEND_PROPERTIES_H

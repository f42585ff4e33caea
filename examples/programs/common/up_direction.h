// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option --up: its values, its direction, and the rotation of the direction to z.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_UP_DIRECTION_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_UP_DIRECTION_H

#include <CLI/CLI.hpp>

#include <array>
#include <cstddef>
#include <string>

namespace program {

/// Adds the option `--up`. `what`, `more`: first and last words of its description.
template <class Name>
CLI::Option*
add_up(CLI::App& app, Name& name, const std::string& what, const std::string& more = "")
{
  return app.add_option("--up", name, what + ": x, y, z, -x, -y or -z" + more)
      ->check(CLI::IsMember({"x", "y", "z", "-x", "-y", "-z"}));
}

/// Returns the unit vector of x, y, z, -x, -y or -z.
template <class Kernel>
typename Kernel::Vector_3 up_direction(const std::string& name)
{
  const double sign = name.front() == '-' ? -1 : 1;
  const char axis = name.back();
  return {axis == 'x' ? sign : 0, axis == 'y' ? sign : 0, axis == 'z' ? sign : 0};
}

/// The rotation about the origin that makes the direction of `--up` the z axis. It exchanges
/// coordinates, so that there are no rounding errors.
class Up_rotation
{
public:
  explicit Up_rotation(const std::string& name)
  {
    if (name == "x")
      m_axis = {1, 2, 0};
    else if (name == "y")
      m_axis = {2, 0, 1};
    else if (name == "-x")
      m_axis = {2, 1, 0};
    else if (name == "-y")
      m_axis = {0, 2, 1};
    if (name.front() == '-')
      m_sign = {1, name == "-z" ? -1 : 1, -1};
  }

  /// Rotates from the coordinates of the files, so that z is up.
  template <class Point>
  Point operator()(const Point& p) const
  {
    return Point(signed_value(0, p[m_axis[0]]),
                 signed_value(1, p[m_axis[1]]),
                 signed_value(2, p[m_axis[2]]));
  }

  /// Rotates back to the coordinates of the files.
  template <class Point>
  Point back(const Point& p) const
  {
    std::array<double, 3> q{};
    for (std::size_t i = 0; i < 3; ++i)
      q[static_cast<std::size_t>(m_axis[i])] = signed_value(i, p[static_cast<int>(i)]);
    return Point(q[0], q[1], q[2]);
  }

private:
  double signed_value(std::size_t i, double value) const
  {
    return m_sign[i] < 0 ? 0 - value : value; // never -0
  }

  std::array<int, 3> m_axis = {0, 1, 2}; // the z axis is up without rotation
  std::array<int, 3> m_sign = {1, 1, 1};
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_UP_DIRECTION_H

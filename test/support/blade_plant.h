// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of a virtual plant with leaf blades, like maize.

#ifndef PCS_TEST_SUPPORT_BLADE_PLANT_H
#define PCS_TEST_SUPPORT_BLADE_PLANT_H

#include <CGAL/Simple_cartesian.h>
#include <CGAL/number_utils.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace pcs_test {

using Blade_point = CGAL::Simple_cartesian<double>::Point_3;

inline constexpr double stem_height = 1, stem_radius = 0.012, blade_length = 0.7,
                        blade_width = 0.06;

/// Position on the midrib of a blade at the arc length `s`, which rises and then bends down.
inline Blade_point midrib(double azimuth, double foot, double s)
{
  const double out = 0.75 * s, up = 0.6 * s - 0.7 * s * s;
  return {out * std::cos(azimuth), out * std::sin(azimuth), foot + up};
}

/// A stem of 1 m with alternating blades of 70 cm length and 6 cm width, in metres.
inline std::vector<Blade_point> plant(std::size_t number_of_blades)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> noise(0, 0.0005);
  std::vector<Blade_point> points;
  const auto add = [&](double x, double y, double z) {
    points.emplace_back(x + noise(random), y + noise(random), z + noise(random));
  };
  for (int i = 0; i < 6000; ++i) {
    const double a = 2 * CGAL_PI * uniform(random);
    add(stem_radius * std::cos(a), stem_radius * std::sin(a), stem_height * uniform(random));
  }
  for (std::size_t b = 0; b < number_of_blades; ++b) {
    const double azimuth = CGAL_PI * double(b) + 0.3 * double(b);
    const double foot = 0.2 + 0.1 * double(b);
    for (int i = 0; i < 4000; ++i) {
      const double s = blade_length * uniform(random);
      const double half = 0.5 * blade_width * std::min(1.0, 0.3 + 3 * s) *
                          std::min(1.0, 4 * (1 - s / blade_length));
      const double across = half * (2 * uniform(random) - 1);
      const Blade_point p = midrib(azimuth, foot, s);
      add(p.x() - across * std::sin(azimuth), p.y() + across * std::cos(azimuth), p.z());
    }
  }
  return points;
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_BLADE_PLANT_H

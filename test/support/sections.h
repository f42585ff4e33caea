// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points on sections and tubes, for tests of the stages of the skeleton.

#ifndef PCS_TEST_SUPPORT_SECTIONS_H
#define PCS_TEST_SUPPORT_SECTIONS_H

#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace pcs_test {

/// Points on an arc of an ellipse, rotated by 0.5 rad and shifted.
inline std::vector<pcs::skeleton::Vec2>
arc(double a, double b, double turn, std::size_t n, double noise)
{
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, noise);
  std::vector<pcs::skeleton::Vec2> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = turn * (double(i) + 0.5) / double(n);
    const pcs::skeleton::Vec2 p((a + normal(random)) * std::cos(t),
                                (b + normal(random)) * std::sin(t));
    points.emplace_back(5 + std::cos(0.5) * p.x() - std::sin(0.5) * p.y(),
                        -3 + std::sin(0.5) * p.x() + std::cos(0.5) * p.y());
  }
  return points;
}

/// Points on a vertical tube about the z axis.
inline std::vector<pcs::skeleton::Vec3> tube(double radius, double height, std::size_t n)
{
  std::vector<pcs::skeleton::Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.39996322972865332 * double(i);
    points.emplace_back(radius * std::cos(angle),
                        radius * std::sin(angle),
                        height * (double(i) + 0.5) / double(n));
  }
  return points;
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_SECTIONS_H

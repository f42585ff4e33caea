// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random virtual objects beside trees: posts, fences, walls, cars, shrubs.

#ifndef PCS_BENCHMARK_SUPPORT_VIRTUAL_OBJECTS_H
#define PCS_BENCHMARK_SUPPORT_VIRTUAL_OBJECTS_H

#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace pcs_bench {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Vector = CGAL::Simple_cartesian<double>::Vector_3;
using Random = std::mt19937_64;

/// Uniform in [low, high); the same on every platform.
inline double uniform(Random& random, double low, double high)
{
  return low + (high - low) * (double(random() >> 11) * 0x1p-53);
}

/// Adds points on surfaces beside the tree that face a station; `spacing` is their distance [m].
class Scene
{
public:
  Scene(Random& random,
        const std::vector<Point>& stations,
        double spacing,
        std::vector<Point>& points)
    : m_random(random), m_stations(stations), m_spacing(spacing), m_points(points)
  {
  }

  double between(double low, double high) { return uniform(m_random, low, high); }

  void rectangle(const Point& corner, const Vector& a, const Vector& b)
  {
    const Vector normal = CGAL::cross_product(a, b);
    const double area = std::sqrt(normal.squared_length());
    const auto count = static_cast<std::size_t>(area / (m_spacing * m_spacing));
    for (std::size_t k = 0; k < count; ++k)
      add(corner + between(0, 1) * a + between(0, 1) * b, normal, true);
  }

  void box(const Point& corner, double x, double y, double z)
  {
    const Vector a(x, 0, 0), b(0, y, 0), c(0, 0, z);
    for (const auto& [u, v, w] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}) {
      rectangle(corner, u, v);
      rectangle(corner + w, u, v);
    }
  }

  void cylinder(const Point& base, const Vector& axis, double radius)
  {
    const Vector unit = axis / std::sqrt(axis.squared_length());
    const Vector across = std::abs(unit.z()) < 0.9 ? Vector(0, 0, 1) : Vector(1, 0, 0);
    Vector e1 = CGAL::cross_product(unit, across);
    e1 = e1 / std::sqrt(e1.squared_length());
    const Vector e2 = CGAL::cross_product(unit, e1);
    const double area = 2 * CGAL_PI * radius * std::sqrt(axis.squared_length());
    const auto count = static_cast<std::size_t>(area / (m_spacing * m_spacing));
    for (std::size_t k = 0; k < count; ++k) {
      const double t = between(0, 2 * CGAL_PI);
      const Vector normal = std::cos(t) * e1 + std::sin(t) * e2;
      add(base + between(0, 1) * axis + radius * normal, normal, false);
    }
  }

  /// Points inside an ellipsoid, as leaves of a shrub.
  void shrub(const Point& center, double radius, double height)
  {
    const auto count = static_cast<std::size_t>(radius * height / (m_spacing * m_spacing));
    for (std::size_t k = 0; k < count;) {
      const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
      if (x * x + y * y + z * z > 1)
        continue;
      m_points.push_back(center + Vector(radius * x, radius * y, 0.5 * height * (1 + z)));
      ++k;
    }
  }

private:
  void add(const Point& p, const Vector& normal, bool has_two_sides)
  {
    const double noise = 0.001 * (between(-1, 1) + between(-1, 1) + between(-1, 1));
    const double length = std::sqrt(normal.squared_length());
    double cosine = 0; // of the incidence of the beam that is most nearly orthogonal
    for (const Point& s : m_stations) {
      const double c = normal * (s - p) / (length * std::sqrt((s - p).squared_length()));
      cosine = std::max(cosine, has_two_sides ? std::abs(c) : c);
    }
    if (between(0, 1) < cosine)
      m_points.push_back(p + noise / length * normal);
  }

  Random& m_random;
  const std::vector<Point>& m_stations;
  double m_spacing;
  std::vector<Point>& m_points;
};

using Object = std::pair<std::string, std::function<void(Scene&)>>;

/// Objects on the ground z = 0 at a random place near a tree at the origin, in metres.
inline std::vector<Object> objects()
{
  return {{"nothing", [](Scene&) {}},
          {"lamp post",
           [](Scene& s) {
             const double x = s.between(0.6, 2);
             s.cylinder(Point(x, 0, 0), Vector(0, 0, s.between(3, 8)), s.between(0.04, 0.09));
           }},
          {"sign",
           [](Scene& s) {
             const double x = s.between(0.5, 1.5);
             s.cylinder(Point(x, 0, 0), Vector(0, 0, 2.3), 0.03);
             s.rectangle(Point(x - 0.3, 0.03, 1.7), Vector(0.6, 0, 0), Vector(0, 0, 0.6));
           }},
          {"stakes",
           [](Scene& s) {
             const double r = s.between(0.3, 0.6);
             for (int k = 0; k < 3; ++k)
               s.cylinder(Point(r * std::cos(2.1 * k), r * std::sin(2.1 * k), 0),
                          Vector(0, 0, 2),
                          0.04);
           }},
          {"fence",
           [](Scene& s) {
             const double y = s.between(0.5, 1.5);
             for (double x = -6; x <= 6; x += 2)
               s.cylinder(Point(x, y, 0), Vector(0, 0, 1.4), 0.04);
             for (const double z : {0.4, 0.8, 1.2})
               s.rectangle(Point(-6, y, z), Vector(12, 0, 0), Vector(0, 0, 0.1));
           }},
          {"wire mesh",
           [](Scene& s) {
             const double y = s.between(0.5, 1.5);
             for (double x = -6; x <= 6; x += 2)
               s.cylinder(Point(x, y, 0), Vector(0, 0, 1.4), 0.03);
             for (double z = 0.1; z < 1.3; z += 0.1)
               s.cylinder(Point(-6, y, z), Vector(12, 0, 0), 0.002);
           }},
          {"wall",
           [](Scene& s) {
             const double y = s.between(0.5, 2);
             s.box(Point(-6, y, 0), 12, 0.25, s.between(0.6, 3));
           }},
          {"house",
           [](Scene& s) {
             const double y = s.between(1.5, 3.5);
             s.box(Point(-5, y, 0), 10, 8, 6);
             s.rectangle(Point(-5, y, 6), Vector(10, 0, 0), Vector(0, 4, 3));
           }},
          {"car",
           [](Scene& s) {
             const double x = s.between(0.7, 2);
             s.box(Point(x, -2.1, 0.25), 1.8, 4.2, 0.6);
             s.box(Point(x + 0.1, -1, 0.85), 1.6, 2, 0.55);
             for (const double y : {-1.3, 1.3})
               s.cylinder(Point(x, y, 0.3), Vector(1.8, 0, 0), 0.3);
           }},
          {"hedge",
           [](Scene& s) {
             const double y = s.between(0.8, 1.6), h = s.between(0.6, 1.6);
             for (double x = -5; x <= 5; x += 0.4)
               s.shrub(Point(x, y, 0), 0.35, h);
           }},
          {"shrub",
           [](Scene& s) {
             const double t = s.between(0, 6.28), r = s.between(0.2, 1.2);
             s.shrub(Point(r * std::cos(t), r * std::sin(t), 0),
                     s.between(0.2, 0.6),
                     s.between(0.4, 1.5));
           }},
          {"person",
           [](Scene& s) {
             const double x = s.between(0.6, 1.5);
             for (const double y : {-0.1, 0.1})
               s.cylinder(Point(x, y, 0), Vector(0, 0, 0.85), 0.08);
             s.cylinder(Point(x, 0, 0.85), Vector(0, 0, 0.65), 0.19);
             s.cylinder(Point(x, 0, 1.5), Vector(0, 0, 0.25), 0.1);
           }},
          {"bench",
           [](Scene& s) {
             const double x = s.between(0.4, 1.2);
             s.rectangle(Point(x, -0.9, 0.45), Vector(0.4, 0, 0), Vector(0, 1.8, 0));
             s.rectangle(Point(x + 0.4, -0.9, 0.45), Vector(0, 1.8, 0), Vector(0.1, 0, 0.4));
             for (const double y : {-0.8, 0.8})
               s.box(Point(x, y, 0), 0.4, 0.05, 0.45);
           }},
          {"kerb",
           [](Scene& s) { s.box(Point(-8, s.between(0.4, 1), 0), 16, 3, s.between(0.1, 0.2)); }},
          {"wires",
           [](Scene& s) {
             const double y = s.between(-0.6, 0.6), z = s.between(4, 6);
             for (const double dz : {0.0, 0.3, 0.6})
               s.cylinder(Point(-12, y, z + dz), Vector(24, 0, 0), 0.01);
           }},
          {"stem beside",
           [](Scene& s) {
             const double x = s.between(1, 2.5);
             s.cylinder(Point(x, 0, 0), Vector(0.1, 0.1, s.between(3, 7)), s.between(0.05, 0.15));
           }},
          {"rocks",
           [](Scene& s) {
             for (int k = 0; k < 4; ++k) {
               const double t = s.between(0, 6.28), r = s.between(0.5, 2), d = s.between(0.1, 0.35);
               s.cylinder(Point(r * std::cos(t), r * std::sin(t), 0), Vector(0, 0, d), d);
               s.rectangle(Point(r * std::cos(t) - d, r * std::sin(t) - d, d),
                           Vector(2 * d, 0, 0),
                           Vector(0, 2 * d, 0));
             }
           }},
          {"log", [](Scene& s) {
             const double x = s.between(0.4, 1.5), r = s.between(0.08, 0.2);
             s.cylinder(Point(x, -2, r), Vector(0.3, 4, 0), r);
           }}};
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_SUPPORT_VIRTUAL_OBJECTS_H

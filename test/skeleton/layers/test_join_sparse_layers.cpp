// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sparse level sets of thick stems are joined to rings; rows of points and dense stems are not
// changed.

#include <pcs/skeleton/layers/join_sparse_layers.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

namespace test_join_sparse_layers {

using namespace pcs::skeleton;

namespace {

constexpr double thickness = 3; ///< of a level set, in spacings of 1

/// Points with their level sets by height. Points nearer than 1.7 local spacings are linked.
struct Layers
{
  Scan scan;
  std::vector<double> distance;
  std::vector<Index> layer;
  Links links;

  Layers(const std::vector<Vec3>& points, double local_spacing)
  {
    scan.points = points;
    scan.spacing = 1;
    scan.local_spacing.assign(points.size(), local_spacing);
    scan.neighbors.resize(points.size());
    for (Index i = 0; i < points.size(); ++i) {
      scan.neighbors[i].fill(none);
      scan.neighbors[i][0] = i > 0 ? i - 1 : 1;
      distance.push_back(points[i].z());
      layer.push_back(static_cast<Index>(points[i].z() / thickness));
      for (Index j = 0; j < i; ++j)
        if ((points[i] - points[j]).norm() < 1.7 * local_spacing)
          links.push_back({j, i});
    }
  }

  /// Joins the level sets; returns the sets.
  Point_sets joined() const
  {
    Point_sets sets = connected();
    join_sparse_layers<CGAL::Sequential_tag>(scan,
                                             links,
                                             distance,
                                             layer,
                                             thickness,
                                             Sparse_layer_options(),
                                             sets);
    return sets;
  }
  Point_sets connected() const
  {
    Point_sets sets(scan.size());
    for (const Link& l : links)
      if (layer[l.first] == layer[l.second])
        sets.unite(l.first, l.second);
    return sets;
  }
  std::size_t count(Point_sets sets) const
  {
    std::set<Index> roots;
    for (Index i = 0; i < scan.size(); ++i)
      roots.insert(sets.find(i));
    return roots.size();
  }
};

/// Points at equal distances on a cylinder, in staggered rings.
std::vector<Vec3> cylinder(double radius, double height, double spacing)
{
  const double pi = 3.14159265358979323846;
  const int around = static_cast<int>(2 * pi * radius / spacing);
  std::vector<Vec3> points;
  for (int ring = 0; ring * spacing < height; ++ring)
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * pi * (k + 0.5 * (ring % 2)) / around;
      const double z = ring * spacing + (k % 2 == 0 ? 0 : 0.55 * spacing); // zigzag
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(sparse_layers)

BOOST_AUTO_TEST_CASE(level_sets_of_a_sparse_stem_become_rings)
{
  const Layers layers(cylinder(40, 96, 6), 6);
  Point_sets sets = layers.joined();
  // 1.3 * 6 * 6 / 2.5 = 18.7 spacings: three doublings of the thickness, 24 spacings
  BOOST_TEST(layers.count(layers.connected()) > 100u);
  BOOST_TEST(layers.count(sets) == 4u);
  for (Index i = 0; i < layers.scan.size(); ++i)
    for (Index j = 0; j < i; ++j)
      if (sets.find(i) == sets.find(j))
        BOOST_TEST((layers.layer[i] >> 3) == (layers.layer[j] >> 3));
}

BOOST_AUTO_TEST_CASE(dense_stems_and_sparse_rows_do_not_change)
{
  std::vector<Vec3> row;
  for (int k = 0; k < 60; ++k)
    row.emplace_back(0.3 * (k % 3), 0.2 * (k % 2), 3 * k);
  for (const Layers& layers : {Layers(cylinder(10, 24, 1), 1), Layers(row, 6)})
    BOOST_TEST(layers.count(layers.joined()) == layers.count(layers.connected()));
}

BOOST_AUTO_TEST_CASE(a_part_of_a_circle_is_no_ring)
{
  std::vector<Vec3> arc; // four of twelve sectors
  for (const Vec3& p : cylinder(40, 96, 6))
    if (p.x() > 0 && std::abs(p.y()) < 0.8 * p.x())
      arc.push_back(p);
  const Layers layers(arc, 6);
  BOOST_TEST(layers.count(layers.joined()) == layers.count(layers.connected()));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_join_sparse_layers

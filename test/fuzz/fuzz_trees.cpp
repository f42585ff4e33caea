// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary points have a skeleton with finite nodes and a closed surface, and are segmented into
// trees, or are refused.

#include "Fuzz_file.h"
#include <pcs/core/errors.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/make_branch_surface.h>
#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

namespace {

/// Points on tubes: few bytes give the shape of a branch. Some are anywhere.
std::vector<Point> points_of(pcs_fuzz::Bytes& bytes)
{
  std::vector<Point> points;
  while (!bytes.is_empty() && points.size() < 2000) {
    if (bytes.byte() < 64) {
      const double x = bytes.coordinate(), y = bytes.coordinate(), z = bytes.coordinate();
      points.emplace_back(x, y, z);
      continue;
    }
    std::array<double, 6> ends{};
    for (double& value : ends)
      value = bytes.between(0, 10);
    const double radius = bytes.between(0, 0.5);
    const std::size_t count = bytes.count(2, 400);
    for (std::size_t i = 0; i < count; ++i) {
      const double t = double(i) / double(count), angle = 2.39996 * double(i);
      points.emplace_back(ends[0] + t * (ends[3] - ends[0]) + radius * std::cos(angle),
                          ends[1] + t * (ends[4] - ends[1]) + radius * std::sin(angle),
                          ends[2] + t * (ends[5] - ends[2]));
    }
  }
  return points;
}

void extract(const std::vector<Point>& points)
{
  pcs::Tree_skeleton<Kernel> tree;
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::number_of_resamples(0));
  for (const auto v : CGAL::make_range(vertices(tree))) {
    const auto& node = tree[v];
    pcs_fuzz::check(std::isfinite(node.point.x() + node.point.y() + node.point.z()));
    pcs_fuzz::check(node.radius >= 0 && std::isfinite(node.radius));
  }
  std::vector<Point> corners;
  std::vector<std::array<std::size_t, 3>> triangles;
  pcs::make_branch_surface(tree, corners, triangles);
  for (const auto& triangle : triangles)
    for (const std::size_t corner : triangle)
      pcs_fuzz::check(corner < corners.size());
}

void segment(const std::vector<Point>& points)
{
  std::vector<std::size_t> indices(points.size()), trees(points.size());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  const boost::typed_identity_property_map<std::size_t> identity;
  const auto report = pcs::segment_trees(
      indices,
      boost::make_iterator_property_map(trees.begin(), identity),
      pcs::parameters::point_map(boost::make_iterator_property_map(points.begin(), identity)));
  for (const std::size_t tree : trees)
    pcs_fuzz::check(tree == pcs::npos || tree < report.trees.size());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  pcs_fuzz::Bytes bytes(data, size);
  const bool is_stand = bytes.byte() % 2 == 1;
  const std::vector<Point> points = points_of(bytes);
  try {
    if (is_stand)
      segment(points);
    else
      extract(points);
  } catch (const pcs::Invalid_input&) {
  }
  return 0;
}

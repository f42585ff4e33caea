// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Results of skeletons, stands, surfaces and crowns.

#include "Results.h"
#include <pcs/core/Tree_measures.h>
#include <pcs/crowns/measure_crown.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/make_branch_surface.h>
#include <pcs/make_leaf_surface.h>
#include <pcs/segment_trees.h>

#include <CGAL/property_map.h>

#include <functional>
#include <numeric>

namespace pcs_test {
namespace skeletons {

namespace np = pcs::parameters;

std::vector<Point> scan(std::uint64_t seed, double leaves, double ground, double shift)
{
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = 3;
  scanner.angular_step = 0.002;
  scanner.leaves_per_length = leaves;
  scanner.ground_radius = ground;
  pcs::Virtual_scan<Kernel> result;
  pcs::scan_tree(small_tree(seed), result, scanner, np::random_seed(seed));
  for (Point& p : result.points)
    p = p + Vector(shift, 0, 0);
  return std::move(result.points);
}

template <class Tag, class Change>
void extract(const char* name,
             const std::vector<Point>& points,
             const Change& change,
             Results& results)
{
  const std::size_t n = points.size();
  std::vector<std::size_t> indices(n), branches(n);
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  std::vector<double> residuals(n);
  std::vector<char> is_leaf(n);
  std::vector<Vector> normals(n, Vector(0, 0, 0));
  Tree tree;
  const auto report = pcs::extract_tree_skeleton<Tag>(
      indices,
      tree,
      change(np::point_map(CGAL::make_property_map(points))
                 .point_branch_map(CGAL::make_property_map(branches))
                 .point_residual_map(CGAL::make_property_map(residuals))
                 .normal_map(CGAL::make_property_map(normals))));
  results(name) << report.number_of_outliers << report.number_of_leaf_points
                << report.number_of_ground_points << report.number_of_unexplained_points
                << report.spacing << report.noise << report.residual << report.height
                << report.diameter_at_breast_height << report.stem_diameters << report.total.length
                << report.total.volume << report.spread.length << report.spread.volume << tree
                << branches << residuals << normals;
}

template <class Tag>
void segment(Results& results)
{
  std::vector<Point> stand;
  for (const std::uint64_t k : {0u, 1u, 2u})
    for (const Point& p : scan(k, 0, 1.5, 1.5 * double(k)))
      stand.push_back(p);
  std::vector<std::size_t> indices(stand.size()), trees(stand.size());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  const auto report = pcs::segment_trees<Tag>(indices,
                                              CGAL::make_property_map(trees),
                                              np::point_map(CGAL::make_property_map(stand)));
  results("segment_trees") << report.number_of_unassigned_points << report.number_of_low_plants
                           << trees;
  for (const pcs::Segmented_tree& tree : report.trees)
    results << tree.foot << tree.radius << tree.diameter_at_breast_height << tree.height;
}

void make_surfaces(Results& results)
{
  const Tree tree = small_tree(7);
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  pcs::make_branch_surface(tree, points, triangles);
  results("make_branch_surface") << points << triangles;
  pcs::make_leaf_surface(tree, points, triangles);
  results("make_leaf_surface") << points << triangles;
  const auto crown = pcs::crowns::measure_crown(points, 0.5);
  results("crowns::measure_crown") << crown.area << crown.volume << crown.outline.size();
  for (const auto& corner : crown.outline)
    results << corner;
  const pcs::Tree_measures size = pcs::measure_tree(tree);
  results("measure_tree") << size.length << size.volume << size.union_volume;
}

template <class Tag>
void record(Results& results)
{
  const std::vector<Point> bare = scan(7, 0, 0, 0), leafy = scan(8, 40, 2, 0);
  extract<Tag>(
      "extract_tree_skeleton",
      bare,
      [](auto p) { return p; },
      results);
  extract<Tag>(
      "extract_tree_skeleton, leaves and ground",
      leafy,
      [](auto p) { return p; },
      results);
  extract<Tag>(
      "extract_tree_skeleton, sections",
      bare,
      [](auto p) { return p.skeleton_method(pcs::Skeleton_method::sections); },
      results);
  extract<Tag>(
      "extract_tree_skeleton, level sets",
      bare,
      [](auto p) { return p.skeleton_method(pcs::Skeleton_method::level_sets); },
      results);
  extract<Tag>(
      "extract_tree_skeleton, resampled",
      bare,
      [](auto p) { return p.number_of_resamples(3); },
      results);
  const Tree truth = small_tree(7);
  extract<Tag>(
      "extract_tree_skeleton, given skeleton",
      bare,
      [&](auto p) { return p.given_skeleton(std::cref(truth)); },
      results);
  segment<Tag>(results);
  make_surfaces(results);
}

} // namespace skeletons

void record_skeletons(bool is_sequential, Results& results)
{
  if (is_sequential)
    skeletons::record<Sequential>(results);
  else
    skeletons::record<CGAL::Parallel_if_available_tag>(results);
}

} // namespace pcs_test

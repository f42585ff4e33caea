// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Growth of the time of each algorithm with the number of points. Every row also has the time of a
// query for the 6 or 25 nearest neighbours of the same points, on one thread in the same process.

#include <pcs/Point_set_deformation.h>
#include <pcs/core/keep_memory.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/orl_geodesic.h>
#include <pcs/segment_trees.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/models.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstddef>
#include <exception>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Points = std::vector<Point>;
using Tree = pcs::Tree_skeleton<Kernel>;
using pcs_bench::number;

namespace {

struct Row_writer
{
  pcs_bench::Table table{{"algorithm", "points", "seconds", "kNN [s]", "/ kNN"}};

  void add(const std::string& algorithm, std::size_t points, double seconds, double query)
  {
    table.add({algorithm,
               std::to_string(points),
               number(seconds),
               number(query),
               number(seconds / query)});
    std::cerr << algorithm << ", " << points << " points: " << number(seconds) << " s\n";
  }
};

double query_seconds(const Points& points, std::size_t neighbors)
{
  std::vector<Eigen::Vector3d> local;
  for (const Point& p : points)
    local.emplace_back(p.x() - points[0].x(), p.y() - points[0].y(), p.z() - points[0].z());
  const pcs_bench::Timer timer;
  pcs_bench::query_neighbors(local, neighbors);
  return timer.seconds();
}

/// Prepares a cloud of `n` points for handles at both ends, and computes one frame.
void measure_deformation(std::size_t n, Row_writer& rows)
{
  Points points;
  for (const Eigen::Vector3d& p : pcs_bench::make_bumpy_figure(n))
    points.emplace_back(p.x(), p.y(), p.z());
  const double query = query_seconds(points, 6);
  const std::size_t end = n / 20; // the points are sorted along y
  std::vector<std::size_t> top(end), bottom(end);
  std::iota(top.begin(), top.end(), std::size_t(0));
  std::iota(bottom.begin(), bottom.end(), n - end);
  const pcs_bench::Timer timer;
  pcs::Point_set_deformation<Points> session(points);
  const double ready = timer.seconds();
  const auto moved = session.add_handle(top);
  session.add_handle(bottom);
  session.deform(); // factorises
  double angle = 0;
  const pcs_bench::Timings frames = pcs_bench::repeat(5, [&] {
    angle += 0.02;
    session.set_rotation(moved, Kernel::Vector_3(0, 1, 0), angle);
    session.deform();
  });
  rows.add("deformation: ready for handles", n, ready, query);
  rows.add("deformation: one frame", n, frames.best(), query);
}

pcs::Virtual_scan<Kernel> scan_of(const Tree& tree, double degrees)
{
  pcs::Virtual_scanner scanner;
  scanner.angular_step = degrees * CGAL_PI / 180;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(12));
  return scan;
}

/// A step of the beams that gives about `n` points of a tree; 0.08 degrees give `at_008`.
double step_for(std::size_t n, std::size_t at_008)
{
  return 0.08 * std::sqrt(double(at_008) / double(n));
}

void measure_skeleton(const Tree& tree, double degrees, Row_writer& rows)
{
  const Points points = scan_of(tree, degrees).points;
  const double query = query_seconds(points, 25);
  const pcs_bench::Timer timer;
  Tree skeleton;
  pcs::extract_tree_skeleton(points, skeleton);
  rows.add("skeleton of a tree", points.size(), timer.seconds(), query);
}

/// Stands of copies of one scan, 6 m apart.
void measure_stand(const Tree& tree, double degrees, std::size_t side, Row_writer& rows)
{
  const Points one = scan_of(tree, degrees).points;
  Points points;
  for (std::size_t k = 0; k < side * side; ++k)
    for (const Point& p : one)
      points.emplace_back(p.x() + 6 * double(k / side), p.y() + 6 * double(k % side), p.z());
  const double query = query_seconds(points, 25);
  std::vector<std::size_t> indices(points.size()), trees(points.size());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  const boost::typed_identity_property_map<std::size_t> identity;
  const pcs_bench::Timer timer;
  pcs::segment_trees(
      indices,
      boost::make_iterator_property_map(trees.begin(), identity),
      pcs::parameters::point_map(boost::make_iterator_property_map(points.begin(), identity)));
  rows.add("trees of a stand", points.size(), timer.seconds(), query);
}

} // namespace

int main(int argc, char** argv)
{
  pcs::keep_memory();
  std::size_t most = 1000000;
  std::string csv;
  CLI::App app("Growth of the time of each algorithm with the number of points.", "bench_scaling");
  app.add_option("--most", most, "largest number of points")->capture_default_str();
  app.add_option("--csv", csv, "write the rows to this CSV file");
  try {
    app.parse(argc, argv);
    Row_writer rows;
    for (double n = 1e4; n <= 1.001 * double(most); n *= std::sqrt(10.0))
      measure_deformation(static_cast<std::size_t>(std::lround(n)), rows);
    Tree tree;
    pcs::grow_tree(tree, pcs::broadleaf_habit(), pcs::parameters::random_seed(11));
    const std::size_t at_008 = scan_of(tree, 0.08).points.size();
    for (double n = 1e4; n <= 1.001 * double(most); n *= std::sqrt(10.0))
      measure_skeleton(tree, step_for(static_cast<std::size_t>(n), at_008), rows);
    std::size_t side = 2; // trees along each side
    for (double n = 1e5; n <= 1.001 * double(most); n *= std::sqrt(10.0), side *= 2)
      measure_stand(tree,
                    step_for(static_cast<std::size_t>(n / double(side * side)), at_008),
                    side,
                    rows);
    rows.table.print(std::cout);
    if (!csv.empty())
      rows.table.write_csv(csv);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::cerr << "bench_scaling: " << e.what() << '\n';
    return 1;
  }
}

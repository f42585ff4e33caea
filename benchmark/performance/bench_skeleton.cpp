// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the seconds of the stages of a skeleton and of its mesh with those of a query for the 25
// nearest neighbours of every point.

#include <pcs/IO/read_points.h>
#include <pcs/core/keep_memory.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/make_branch_surface.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/threads.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <iostream>
#include <random>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Points = std::vector<Point>;
using Tree = pcs::Tree_skeleton<Kernel>;
using pcs_bench::number;

namespace {

Points virtual_scan(double degrees)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::broadleaf_habit(), pcs::parameters::random_seed(11));
  pcs::Virtual_scanner scanner;
  scanner.angular_step = degrees * CGAL_PI / 180;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(12));
  return std::move(scan.points);
}

/// Adds the fraction `share` of uniform outliers in a box twice as large as that of the points.
Points with_outliers(Points points, double share)
{
  std::array<double, 3> low{}, high{};
  for (int d = 0; d < 3; ++d) {
    const auto [a, b] = std::minmax_element(points.begin(), points.end(), [d](auto& p, auto& q) {
      return p[d] < q[d];
    });
    low[std::size_t(d)] = 1.5 * (*a)[d] - 0.5 * (*b)[d];
    high[std::size_t(d)] = 1.5 * (*b)[d] - 0.5 * (*a)[d];
  }
  std::mt19937_64 random(13);
  const auto along = [&](std::size_t d) {
    return std::uniform_real_distribution<double>(low[d], high[d])(random);
  };
  const std::size_t count = static_cast<std::size_t>(share * double(points.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const double x = along(0), y = along(1), z = along(2);
    points.emplace_back(x, y, z);
  }
  return points;
}

/// Time of building nanoflann's tree and querying the 25 nearest neighbours of all points, on one
/// thread.
double query_seconds(const Points& points)
{
  std::vector<Eigen::Vector3d> local;
  for (const Point& p : points)
    local.emplace_back(p.x() - points[0].x(), p.y() - points[0].y(), p.z() - points[0].z());
  const pcs_bench::Timer timer;
  pcs_bench::query_neighbors(local, 25);
  return timer.seconds();
}

void add_rows(const std::string& name,
              const Points& points,
              int repetitions,
              pcs_bench::Table& table)
{
  const double query = query_seconds(points);
  for (const int threads : {1, 2}) {
    std::vector<double> best;
    for (int r = 0; r < repetitions; ++r)
      pcs_test::with_threads(threads, [&] {
        const pcs_bench::Timer timer;
        Tree tree;
        const pcs::Skeleton_report report = pcs::extract_tree_skeleton(points, tree);
        const double skeleton = timer.seconds();
        Points vertices;
        std::vector<std::array<std::size_t, 3>> triangles;
        pcs::make_branch_surface(tree, vertices, triangles);
        const double all = timer.seconds();
        const auto& s = report.seconds;
        const std::vector<double> row{s.neighbors,
                                      s.paths,
                                      s.axes,
                                      s.joints + s.sections,
                                      all - skeleton,
                                      all};
        if (best.empty() || all < best.back())
          best = row;
      });
    std::vector<std::string> row{name, std::to_string(points.size()), std::to_string(threads)};
    for (const double seconds : best)
      row.push_back(number(seconds, 2));
    row.push_back(number(query, 2));
    row.push_back(number(best.back() / query, 2));
    table.add(row);
  }
}

} // namespace

int main(int argc, char** argv)
{
  pcs::keep_memory();
  std::vector<std::string> files;
  std::string csv;
  double degrees = 0.08;
  int repetitions = 2;
  std::vector<double> outliers{0, 0.001, 0.01};
  CLI::App app("Seconds of the stages of a skeleton, on one thread and on two.", "bench_skeleton");
  app.add_option("--input", files, "scans; none: a virtual one");
  app.add_option("--step-degrees", degrees, "of the virtual scan")->capture_default_str();
  app.add_option("--outliers", outliers, "fractions of uniform outliers")->capture_default_str();
  app.add_option("--repetitions", repetitions, "number of runs; the minimum is reported")
      ->capture_default_str();
  app.add_option("--csv", csv, "write the rows to this CSV file");
  try {
    app.parse(argc, argv);
    pcs_bench::Table table({"scan",
                            "points",
                            "threads",
                            "neighbors",
                            "paths",
                            "axes",
                            "joints",
                            "mesh",
                            "all",
                            "kNN 25",
                            "all / kNN 25"});
    const auto measure = [&](const std::string& name, const Points& points) {
      for (const double share : outliers)
        add_rows(share > 0 ? name + " + " + number(100 * share, 2) + " %" : name,
                 with_outliers(points, share),
                 repetitions,
                 table);
    };
    for (const std::string& file : files)
      measure(std::filesystem::path(file).stem().string(), pcs::IO::read_points(file).points());
    if (files.empty())
      measure("broadleaf", virtual_scan(degrees));
    table.print(std::cout);
    if (!csv.empty())
      table.write_csv(csv);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::cerr << "bench_skeleton: " << e.what() << '\n';
    return 1;
  }
}

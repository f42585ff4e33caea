// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the seconds of virtual scans with those of plain ray casts, on one thread and on all.

#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/threads.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
namespace stage = pcs::generators::internal;

namespace {

struct Case
{
  std::string name;
  pcs::Tree_habit habit;
  double step_degrees;
};

/// A dense crown over 15 m, similar to a beech without leaves.
pcs::Tree_habit beech()
{
  pcs::Tree_habit h = pcs::broadleaf_habit();
  h.height = 15;
  h.trunk_radius = 0.22;
  h.spacing = {0.24, 0.17, 0.1};
  h.crown_radius = 3.6;
  return h;
}

/// Casts the beams of all stations through the bounding volume hierarchy, without noise, labels or
/// points.
double bare_casts(const Tree& tree, const pcs::Virtual_scanner& scanner, std::size_t beams)
{
  Eigen::Vector3d origin;
  const stage::Scan_wood wood = stage::scan_wood<Kernel>(tree, origin);
  stage::Scene scene(scanner, 0);
  scene.add_wood(wood);
  stage::Ray_tree rays;
  rays.build<CGAL::Parallel_if_available_tag>(scene.triangles);
  double low = 0, high = 0, side = 0;
  for (const auto& node : wood.nodes) {
    low = std::min(low, node.point.z());
    high = std::max(high, node.point.z());
    side = std::max({side, std::abs(node.point.x()), std::abs(node.point.y())});
  }
  // As many beams as the scan has, uniformly over the tree.
  const double area = 2 * side * (high - low);
  const double per_station = double(beams) / double(scanner.number_of_stations);
  const double spacing = std::sqrt(area / per_station);
  const auto rows = static_cast<std::size_t>((high - low) / spacing);
  const auto columns = static_cast<std::size_t>(2 * side / spacing);
  const Eigen::Vector3f from(float(-scanner.distance), 0, float(scanner.station_height));
  std::vector<double> sums(rows, 0);
  const pcs_bench::Timer timer;
  for (std::size_t s = 0; s < scanner.number_of_stations; ++s)
    pcs::internal::for_each_index<CGAL::Parallel_if_available_tag>(
        rows,
        [&](std::size_t r) {
          stage::Beam beam;
          beam.origin = from;
          for (std::size_t c = 0; c < columns; ++c) {
            const Eigen::Vector3d to(0,
                                     -side + spacing * double(c),
                                     low + spacing * (double(r) + 0.25 * double(s)));
            const Eigen::Vector3d d = (to - from.cast<double>()).normalized();
            const Eigen::Vector3d w(0, 0.0002, 0);
            beam.direction = {d.cast<float>(),
                              (d + w).cast<float>(),
                              (d - w).cast<float>(),
                              d.cast<float>()};
            const stage::Beam_hits hits = rays.first_hits(beam);
            sums[r] += hits.triangle[0] == stage::no_triangle ? 0 : hits.range[0];
          }
        },
        1);
  const double seconds = timer.seconds();
  for (const double sum : sums)
    pcs_bench::keep(sum);
  return seconds;
}

} // namespace

int main(int argc, char** argv)
{
  int repetitions = 3;
  std::string csv;
  CLI::App app("Seconds of virtual scans.", "bench_scan_tree");
  app.add_option("--repetitions", repetitions, "the best one counts")->capture_default_str();
  app.add_option("--csv", csv, "write the table here");
  CLI11_PARSE(app, argc, argv);

  pcs_bench::Table table({"tree",
                          "nodes",
                          "triangles",
                          "beams",
                          "points",
                          "threads",
                          "surface [s]",
                          "boxes [s]",
                          "beams [s]",
                          "total [s]",
                          "bare casts [s]",
                          "beams / bare"});
  const int all = static_cast<int>(std::max(2u, std::thread::hardware_concurrency()));
  for (const Case& c : {Case{"fruit, unit tests", pcs::fruit_habit(), 0.07},
                        Case{"broadleaf", pcs::broadleaf_habit(), 0.05},
                        Case{"beech", beech(), 0.05},
                        Case{"beech, dense", beech(), 0.036}})
    for (const int threads : {1, all})
      pcs_test::with_threads(threads, [&] {
        Tree tree;
        pcs::grow_tree(tree, c.habit, pcs::parameters::random_seed(7));
        pcs::Virtual_scanner scanner;
        scanner.angular_step = c.step_degrees * CGAL_PI / 180;
        pcs::Virtual_scan<Kernel> scan;
        pcs::Scan_report report;
        pcs_bench::Timings total, surface, boxes, beams, bare;
        for (int r = 0; r < repetitions; ++r) {
          const pcs_bench::Timer timer;
          report = pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(7));
          total.add(timer.seconds());
          surface.add(report.seconds.surface);
          boxes.add(report.seconds.tree);
          beams.add(report.seconds.beams);
          bare.add(bare_casts(tree, scanner, report.number_of_beams));
        }
        using pcs_bench::number;
        table.add({c.name,
                   std::to_string(num_vertices(tree)),
                   std::to_string(report.number_of_triangles),
                   std::to_string(report.number_of_beams),
                   std::to_string(report.number_of_points),
                   std::to_string(threads),
                   number(surface.best()),
                   number(boxes.best()),
                   number(beams.best()),
                   number(total.best()),
                   number(bare.best()),
                   number(beams.best() / bare.best())});
      });
  table.print(std::cout);
  std::cout << "peak memory " << pcs_bench::number(pcs_bench::peak_megabytes()) << " MB\n";
  if (!csv.empty())
    table.write_csv(csv);
  return 0;
}

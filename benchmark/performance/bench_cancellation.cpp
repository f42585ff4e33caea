// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Cancelled runs: the time from the answer `false` of the callback until the function returns, and
// the longest time between two calls of the callback, in which nobody can cancel.

#include <pcs/Point_set_deformation.h>
#include <pcs/core/keep_memory.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/orl_geodesic.h>
#include <pcs/registration/fit_point_set.h>
#include <pcs/segment_trees.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/models.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Points = std::vector<Point>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Callback = std::function<bool(double)>;
using pcs_bench::number;

namespace {

struct Row_writer
{
  pcs_bench::Table table{{"algorithm",
                          "points",
                          "calls",
                          "whole run [s]",
                          "longest wait for a call [s]",
                          "at progress",
                          "slowest return [s]",
                          "after progress"}};

  /// Runs `work(callback)` to its end, and then once for each of `n` calls at which it is
  /// cancelled.
  void add(const std::string& algorithm,
           std::size_t points,
           std::size_t n,
           const std::function<void(const Callback&)>& work)
  {
    std::vector<double> time, progress;
    const pcs_bench::Timer timer;
    work([&](double f) {
      time.push_back(timer.seconds());
      progress.push_back(f);
      return true;
    });
    const double whole = timer.seconds();
    double wait = 0, wait_at = 0;
    for (std::size_t k = 1; k < time.size(); ++k)
      if (time[k] - time[k - 1] > wait) {
        wait = time[k] - time[k - 1];
        wait_at = progress[k - 1];
      }
    double slowest = 0, slowest_after = 0;
    for (std::size_t i = 0; i < n && !time.empty(); ++i) {
      const double wanted = (static_cast<double>(i) + 0.5) / static_cast<double>(n) * whole;
      const pcs_bench::Timer run;
      double answered = -1, after = 0;
      work([&](double f) {
        if (answered < 0 && run.seconds() >= wanted) {
          answered = run.seconds();
          after = f;
        }
        return answered < 0;
      });
      if (answered >= 0 && run.seconds() - answered > slowest) {
        slowest = run.seconds() - answered;
        slowest_after = after;
      }
    }
    table.add({algorithm,
               std::to_string(points),
               std::to_string(time.size()),
               number(whole),
               number(wait),
               number(wait_at),
               number(slowest),
               number(slowest_after)});
    std::cerr << algorithm << ": longest wait " << number(wait) << " s at " << number(wait_at)
              << ", slowest return " << number(slowest) << " s\n";
  }
};

Points figure(std::size_t n)
{
  Points points;
  for (const Eigen::Vector3d& p : pcs_bench::make_bumpy_figure(n))
    points.emplace_back(p.x(), p.y(), p.z());
  return points;
}

void measure_deformation(std::size_t n, std::size_t stops, Row_writer& rows)
{
  Points points = figure(n);
  std::vector<std::size_t> top(n / 20), bottom(n / 20); // the points are sorted along y
  std::iota(top.begin(), top.end(), std::size_t(0));
  std::iota(bottom.begin(), bottom.end(), n - bottom.size());
  rows.add("deformation: construction", n, stops, [&](const Callback& callback) {
    const auto np = pcs::parameters::callback(callback);
    const pcs::Point_set_deformation session(points, np);
  });
  rows.add("deformation: all points are samples", n / 10, stops, [&](const Callback& callback) {
    Points part = figure(n / 10);
    const auto np = pcs::parameters::callback(callback).number_of_samples(part.size());
    pcs::Point_set_deformation session(part, np);
    if (session.number_of_samples() == 0)
      return; // cancelled
    std::vector<std::size_t> first(top.begin(), top.begin() + std::ptrdiff_t(n / 200));
    session.set_rotation(session.add_handle(first), Kernel::Vector_3(0, 1, 0), 0.5);
    session.deform();
  });
}

Points scan_of(const Tree& tree, std::size_t n)
{
  const auto scan_with = [&](double degrees) {
    pcs::Virtual_scanner scanner;
    scanner.angular_step = degrees * CGAL_PI / 180;
    pcs::Virtual_scan<Kernel> scan;
    pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(12));
    return scan.points;
  };
  const double coarse = 0.08;
  return scan_with(coarse * std::sqrt(double(scan_with(coarse).size()) / double(n)));
}

void measure_trees(std::size_t n, std::size_t stops, Row_writer& rows)
{
  Tree tree, other;
  pcs::grow_tree(tree, pcs::broadleaf_habit(), pcs::parameters::random_seed(11));
  pcs::grow_tree(other, pcs::broadleaf_habit(), pcs::parameters::random_seed(12));
  const Points scan = scan_of(tree, n);
  rows.add("skeleton of a tree", scan.size(), stops, [&](const Callback& callback) {
    Tree skeleton;
    pcs::extract_tree_skeleton(scan, skeleton, pcs::parameters::callback(callback));
  });
  const Points one = scan_of(tree, n / 4);
  Points stand;
  for (std::size_t k = 0; k < 4; ++k)
    for (const Point& p : one)
      stand.emplace_back(p.x() + 6 * double(k / 2), p.y() + 6 * double(k % 2), p.z());
  std::vector<std::size_t> indices(stand.size()), trees(stand.size());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  const boost::typed_identity_property_map<std::size_t> identity;
  rows.add("trees of a stand", stand.size(), stops, [&](const Callback& callback) {
    pcs::segment_trees(
        indices,
        boost::make_iterator_property_map(trees.begin(), identity),
        pcs::parameters::point_map(boost::make_iterator_property_map(stand.begin(), identity))
            .callback(callback));
  });
  const Points second = scan_of(other, n / 10), first = scan_of(tree, n / 10);
  rows.add("geodesic", first.size() + second.size(), stops, [&](const Callback& callback) {
    Tree between;
    Points points;
    pcs::orl_geodesic(tree,
                      first,
                      other,
                      second,
                      0.5,
                      between,
                      points,
                      pcs::parameters::callback(callback));
  });
}

void measure_registration(std::size_t n, std::size_t stops, Row_writer& rows)
{
  const Points rest = figure(n);
  Points target;
  for (const Point& p : rest)
    target.emplace_back(p.x() + 0.02 * p.y() * p.y(), p.y(), p.z());
  rows.add("registration", n, stops, [&](const Callback& callback) {
    Points points = rest;
    pcs::fit_point_set(points, target, pcs::parameters::callback(callback));
  });
}

} // namespace

int main(int argc, char** argv)
{
  pcs::keep_memory();
  std::size_t n = 1000000, stops = 10;
  std::string csv;
  CLI::App app("Time until cancelled functions return.", "bench_cancellation");
  app.add_option("--points",
                 n,
                 "number of points; a tenth of it for geodesics, registration and "
                 "clouds without sampling")
      ->check(CLI::Range(std::size_t(10000), std::size_t(100000000)))
      ->capture_default_str();
  app.add_option("--stops", stops, "runs that are cancelled, at equal distances in time")
      ->capture_default_str();
  app.add_option("--csv", csv, "write the rows to this CSV file");
  try {
    app.parse(argc, argv);
    Row_writer rows;
    measure_deformation(n, stops, rows);
    measure_registration(n / 10, stops, rows);
    measure_trees(n, stops, rows);
    rows.table.print(std::cout);
    if (!csv.empty())
      rows.table.write_csv(csv);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::cerr << "bench_cancellation: " << e.what() << '\n';
    return 1;
  }
}

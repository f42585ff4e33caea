// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares each step of the skeleton extraction with the published step [Aiteanu 2022] on the same
// virtual scans.

#include "measure_skeleton.h"
#include "support/Table.h"
#include "support/measuring.h"
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_impl.h>
#include <pcs/skeleton/result/write_result.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using pcs::Section_fit;
using pcs::Skeleton_method;
using pcs::skeleton::Session_options;
using pcs::skeleton::Vec3;

struct Variant
{
  std::string name;
  std::optional<pcs::Slice_options> published; ///< of the public function; none: see the next
  Session_options options = {};
};

/// Variants of the method as published [Aiteanu 2022], by its public options.
std::vector<Variant> published_variants()
{
  using Options = pcs::Slice_options;
  std::vector<Variant> result;
  const auto add = [&](const char* name, const auto& change) {
    Options o;
    change(o);
    result.push_back({name, o});
  };
  add("published: all steps", [](Options&) {});
  add("published, direct ellipse", [](Options& o) { o.fit = Section_fit::ellipse; });
  add("published, circle", [](Options& o) { o.fit = Section_fit::circle; });
  add("published, ellipse or circle by arc", [](Options& o) { o.fit = Section_fit::by_arc; });
  add("published, wider slices", [](Options& o) {
    o.radius = 1.3;
    o.radius_offset = 2;
  });
  add("published, all points of a slice", [](Options& o) { o.highest_count = 0; });
  add("published, height by local spacing", [](Options& o) { o.is_height_local = true; });
  add("published, no tilting", [](Options& o) { o.tilts = 0; });
  add("published, no support marking", [](Options& o) { o.do_mark_support = false; });
  add("published, cost of turns", [](Options& o) { o.turn_cost = 1; });
  add("published, square-root radii", [](Options& o) { o.allometry = 0.5; });
  add("published, spanning tree alone",
      [](Options& o) { o.lowest_count = std::numeric_limits<std::size_t>::max(); });
  add("published, four steps of pcs", [](Options& o) {
    o.fit = Section_fit::by_arc;
    o.highest_count = 0;
    o.is_height_local = true;
    o.turn_cost = 1;
  });
  return result;
}

std::vector<Variant> variants()
{
  std::vector<Variant> result = published_variants();
  const auto add = [&](const char* name, Session_options o, const auto& change) {
    change(o);
    result.push_back({name, std::nullopt, std::move(o)});
  };
  const auto nothing = [](Session_options&) {};
  add("pcs: whole chains", Session_options(), nothing);
  add("pcs, one pass", Session_options(), [](auto& o) { o.axes.passes = 1; });
  add("pcs, arcs not joined to rings", Session_options(), [](auto& o) {
    o.layers.rings.smallest = 1e9;
  });
  add("pcs, gaps not closed", Session_options(), [](auto& o) { o.axes.links.gap = 0; });
  add("pcs, no noise correction", Session_options(), [](auto& o) {
    o.axes.chains.noise_share = 0;
  });
  add("pcs, no prior by counting", Session_options(), [](auto& o) {
    o.axes.chains.prior_share = 1e6;
  });
  add("pcs, no radii by width", Session_options(), [](auto& o) {
    o.axes.chains.width_count = std::numeric_limits<double>::infinity();
  });
  add("pcs, radii not bounded", Session_options(), [](auto& o) {
    pcs::skeleton::Support_options& r = o.radii.support;
    r.filled = r.branch_filled = r.thicker = std::numeric_limits<double>::infinity();
    r.fewest = r.expected = r.pipes.slack = 0;
    r.slack = std::numeric_limits<double>::infinity();
  });
  return result;
}

struct Scene
{
  Tree truth;
  pcs::Virtual_scan<Kernel> scan;
  double query_seconds = 0; ///< tree and 25 nearest neighbours of all points, one thread
};

Scene make_scene(const std::string& preset, unsigned seed, std::size_t stations, double degrees)
{
  Scene scene;
  for (const auto& [name, habit] : pcs::tree_habits())
    if (name == preset)
      pcs::grow_tree(scene.truth, habit, pcs::parameters::random_seed(seed));
  if (num_vertices(scene.truth) == 0)
    throw pcs::Invalid_input("there is no preset " + preset);
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = stations;
  scanner.angular_step = degrees * CGAL_PI / 180;
  pcs::scan_tree(scene.truth, scene.scan, scanner, pcs::parameters::random_seed(seed));
  std::vector<Vec3> points;
  for (const auto& p : scene.scan.points)
    points.emplace_back(p.x(), p.y(), p.z());
  const pcs_bench::Timer timer;
  pcs_bench::query_neighbors(points, 25);
  scene.query_seconds = timer.seconds();
  return scene;
}

/// A skeleton, and the number of its branches.
struct Extracted
{
  Tree tree;
  std::size_t number_of_branches = 0;
};

/// Extracts the skeleton by the public function, or by a session if its stages have other options.
Extracted extract(const Scene& scene, const Variant& variant)
{
  Extracted result;
  if (variant.published) {
    const auto np = pcs::parameters::do_register_stations(false) // as in the other rows
                        .skeleton_method(Skeleton_method::sections)
                        .slice_options(*variant.published);
    result.number_of_branches =
        pcs::extract_tree_skeleton(scene.scan.points, result.tree, np).number_of_branches;
    return result;
  }
  std::vector<Vec3> points;
  for (const auto& p : scene.scan.points)
    points.emplace_back(p.x(), p.y(), p.z());
  pcs::skeleton::Session<CGAL::Parallel_if_available_tag> session(std::move(points),
                                                                  {},
                                                                  variant.options);
  pcs::internal::Progress progress{std::function<bool(double)>()};
  session.join(progress);
  if (session.tree().nodes.size() > 1)
    pcs::skeleton::write_ready_made(session.tree(), session.scan().frame, result.tree);
  result.number_of_branches = session.report().number_of_branches;
  return result;
}

std::vector<std::string> row_of(const Scene& scene, const Variant& variant)
{
  const pcs_bench::Timer timer;
  const Extracted result = extract(scene, variant);
  const double seconds = timer.seconds();
  using pcs_bench::number;
  std::vector<std::string> row{variant.name};
  if (num_vertices(result.tree) < 2) {
    row.insert(row.end(), 10, "-");
    return row;
  }
  const auto a = pcs_bench::measure_skeleton<Kernel>(scene.truth, scene.scan.hits, result.tree);
  row.push_back(number(100 * a.at_distance.at(1).f1()));
  row.push_back(number(100 * a.at_distance.at(0).f1()));
  for (std::size_t k = 0; k < 4; ++k)
    row.push_back(number(100 * a.size_classes.at(k).radius_error, 2));
  row.push_back(number(100 * a.volume_error()));
  row.push_back(std::to_string(result.number_of_branches));
  row.push_back(number(seconds, 2));
  row.push_back(number(seconds / scene.query_seconds, 2));
  return row;
}

} // namespace

int main(int argc, char** argv)
{
  std::vector<std::string> presets{"fruit", "broadleaf"};
  std::vector<unsigned> seeds{41};
  std::size_t stations = 4;
  double degrees = 0.12;
  std::string only, csv;
  CLI::App app(
      "Compares each step of the skeleton extraction with the published step [Aiteanu 2022] on "
      "virtual scans.",
      "bench_skeleton_ablation");
  app.add_option("--preset", presets, "presets of the virtual trees")->capture_default_str();
  app.add_option("--seed", seeds, "seeds of trees and scans")->capture_default_str();
  app.add_option("--stations", stations, "number of scanner stations")->capture_default_str();
  app.add_option("--step-degrees", degrees, "angle between beams")->capture_default_str();
  app.add_option("--only", only, "only rows whose name contains this text");
  app.add_option("--csv", csv, "write the rows to this file (CSV)");
  try {
    app.parse(argc, argv);
    const std::vector<std::string> header{"scan",
                                          "variant",
                                          "F1 2.5 cm",
                                          "1 cm",
                                          "r > 5 [%]",
                                          "2-5",
                                          "1-2",
                                          "0.5-1 cm",
                                          "volume [%]",
                                          "branches",
                                          "seconds",
                                          "/ kNN 25"};
    pcs_bench::Table all(header);
    for (const std::string& preset : presets)
      for (const unsigned seed : seeds) {
        const Scene scene = make_scene(preset, seed, stations, degrees);
        const std::string name = preset + " " + std::to_string(seed);
        std::cout << name << ": " << scene.scan.points.size() << " points, "
                  << scene.truth[boost::graph_bundle].branches.size() << " branches\n\n";
        pcs_bench::Table table(std::vector<std::string>(header.begin() + 1, header.end()));
        for (const Variant& variant : variants()) {
          if (variant.name.find(only) == std::string::npos)
            continue;
          std::cerr << name << ": " << variant.name << '\n';
          std::vector<std::string> row = row_of(scene, variant);
          table.add(row);
          row.insert(row.begin(), name);
          all.add(row);
        }
        table.print(std::cout);
      }
    if (!csv.empty())
      all.write_csv(csv);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::cerr << "bench_skeleton_ablation: " << e.what() << '\n';
    return 1;
  }
}

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: grows or reads a virtual tree and scans it; writes labelled points and the ground truth.

#include "common/Progress_line.h"
#include "common/Report_file.h"
#include "common/check_output.h"
#include "common/read_skeleton.h"
#include "common/run_program.h"
#include "scan/Scan_options.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/IO/write_tree_csv.h>
#include <pcs/core/Tree_measures.h>
#include <pcs/core/errors.h>
#include <pcs/generators/edit_branches.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_at_age.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace program {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Scan = pcs::Virtual_scan<Kernel>;

pcs::Tree_habit habit_of(const Scan_options& options)
{
  std::string names;
  for (const auto& [name, habit] : pcs::tree_habits()) {
    if (name == options.preset)
      return options.height ? habit.scaled(*options.height / habit.height) : habit;
    names += (names.empty() ? "" : ", ") + name;
  }
  throw pcs::Invalid_input("unknown preset '" + options.preset + "', expected one of " + names);
}

Tree make_tree(const Scan_options& options)
{
  Tree tree;
  if (options.tree.empty())
    pcs::grow_tree(tree, habit_of(options), pcs::parameters::random_seed(options.seed));
  else {
    std::vector<std::int64_t> ids;
    const std::string warning =
        warning_of_selection(read_skeleton<Kernel>(options.tree, tree, ids, options.root_number),
                             "--root-number");
    if (!warning.empty() && !options.is_quiet)
      std::cerr << "virtual_scan: warning: " << options.tree << ": " << warning << '\n';
  }

  for (const auto& [id, factor] : options.lengthened)
    pcs::lengthen_branch(tree, id, factor);
  for (const auto& [id, degrees] : options.turned)
    pcs::turn_branch(tree, id, Kernel::Vector_3(0, 0, 1), degrees * CGAL_PI / 180);
  for (const std::size_t id : options.pruned)
    tree = pcs::prune_branch(tree, id);
  return options.age == 1 ? tree : pcs::tree_at_age(tree, options.age);
}

/// Returns the table to be written.
pcs::IO::Point_table table_of(Scan& scan)
{
  pcs::IO::Point_table table(std::move(scan.points));
  table.add_property("node", std::vector<std::int32_t>(scan.node.begin(), scan.node.end()));
  table.add_property("station",
                     std::vector<std::int32_t>(scan.station.begin(), scan.station.end()));
  table.comments().push_back(
      "virtual scan; node: id in the truth, -1 ghost or outlier, -2 ground, -3 leaf, -4 post");
  return table;
}

nlohmann::ordered_json report_of(const Scan_options& options,
                                 const Tree& tree,
                                 const Scan& scan,
                                 const pcs::Scan_report& r)
{
  const pcs::Tree_measures m = pcs::measure_tree(tree);
  nlohmann::ordered_json stations = nlohmann::ordered_json::array();
  for (const auto& p : scan.stations)
    stations.push_back({p.x(), p.y(), p.z()});
  return {{"tree", options.tree.empty() ? options.preset : options.tree},
          {"seed", options.seed},
          {"nodes", num_vertices(tree)},
          {"branches", tree[boost::graph_bundle].branches.size()},
          {"length", m.length},
          {"volume", m.volume},
          {"union_volume", m.union_volume},
          {"stations", stations},
          {"beams", r.number_of_beams},
          {"points", r.number_of_points},
          {"wood_points", r.number_of_wood_points},
          {"ground_points", r.number_of_ground_points},
          {"leaf_points", r.number_of_leaf_points},
          {"post_points", r.number_of_post_points},
          {"ghosts", r.number_of_ghosts},
          {"outliers", r.number_of_outliers},
          {"hidden_nodes", r.number_of_hidden_nodes},
          {"triangles", r.number_of_triangles},
          {"seconds",
           {{"surface", r.seconds.surface},
            {"tree", r.seconds.tree},
            {"beams", r.seconds.beams},
            {"output", r.seconds.output}}}};
}

void run(Scan_options& options)
{
  complete(options);
  std::optional<Report_file> report_file;
  if (!options.report.empty())
    report_file.emplace(options.report);
  pcs::IO::Point_table empty;
  empty.add_property("node", std::vector<std::int32_t>());
  empty.add_property("station", std::vector<std::int32_t>());
  check_output(options.output, empty.schema());

  const Tree tree = make_tree(options);
  if (options.has_post) {
    const double d = 0.35 * options.scanner.distance;
    options.scanner.posts.push_back({d, d / 2, 0.01 * d, d});
  }
  Progress_line progress(!options.is_quiet);
  Scan scan;
  const pcs::Scan_report report =
      pcs::scan_tree(tree,
                     scan,
                     options.scanner,
                     pcs::parameters::random_seed(options.seed).callback([&](double fraction) {
                       progress.show("scanning", fraction);
                       return true;
                     }));
  progress.clear();
  if (report.status != pcs::Status::converged)
    throw pcs::Invalid_input("no beam met the tree, nothing was written; lower --step-degrees or "
                             "--distance");

  const nlohmann::ordered_json json = report_of(options, tree, scan, report);
  pcs::IO::write_points(options.output, table_of(scan));
  if (!options.truth.empty())
    pcs::IO::write_tree_csv(options.truth, tree, scan.hits);
  if (!options.swc.empty())
    pcs::IO::write_swc(options.swc, tree);
  if (report_file)
    report_file->commit(json);
  if (!options.is_quiet)
    std::cout << json["nodes"] << " nodes, " << json["branches"] << " branches, length "
              << json["length"] << ", volume " << json["volume"] << " (without doubled bases "
              << json["union_volume"] << ")\n"
              << report << '\n';
}

} // namespace program

int main(int argc, char** argv)
{
  program::Scan_options options;
  CLI::App app("Grows and scans a virtual tree; writes labelled points and the ground truth.",
               "virtual_scan");
  program::declare(app, options);
  return program::run_program(app, argc, argv, "--output scan.ply --swc truth.swc", [&] {
    program::run(options);
    return true;
  });
}

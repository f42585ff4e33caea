// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: finds the growth parameters of skeletons, grows trees by them, compares trees with them,
// and infers hidden wood.

#include "common/Report_file.h"
#include "common/read_skeleton.h"
#include "common/run_program.h"
#include "habit/Habit_options.h"
#include "habit/complete_wood.h"
#include "habit/habit_json.h"
#include <pcs/IO/write_swc.h>
#include <pcs/core/Tree_measures.h>
#include <pcs/core/errors.h>
#include <pcs/generators/fit_tree_habit.h>
#include <pcs/generators/grow_forest.h>
#include <pcs/generators/score_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace program {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Json_report = nlohmann::ordered_json;

Tree read_tree(const std::string& path, const Habit_options& options)
{
  Tree tree;
  std::vector<std::int64_t> ids;
  for (const std::string& sentence : warnings(read_skeleton<Kernel>(path, tree, ids)))
    std::cerr << "fit_tree_habit: warning: " << path << ": "
              << sentence.substr(0, sentence.find(" (")) << "; split the file\n";
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].radius_error = options.radius_error * tree[v].radius;
  return tree;
}

void print(const pcs::Tree_habit_fit& fit)
{
  std::size_t identified = 0;
  for (const pcs::Habit_value& v : fit.values)
    identified += v.is_identified ? 1 : 0;
  std::cout << fit.number_of_trees << " trees, " << fit.number_of_branches << " branches; "
            << identified << " of " << fit.values.size() << " parameters are identified\n";
  for (const pcs::Habit_value& v : fit.values)
    if (v.is_identified)
      std::cout << v.name << ": " << v.value << "  [" << v.least << ", " << v.largest << "]\n";
}

pcs::Tree_habit_fit fit_trees(const Habit_options& options)
{
  std::vector<Tree> trees;
  for (const std::string& path : options.input)
    trees.push_back(read_tree(path, options));
  const pcs::Tree_habit_fit fit =
      pcs::fit_tree_habit(trees,
                          pcs::parameters::random_seed(options.seed)
                              .number_of_simulations(options.simulations)
                              .smallest_radius(options.smallest_radius));
  if (fit.crown_margin < 2)
    std::cerr << "fit_tree_habit: warning: the lengths of branches fit several shapes of crowns; "
                 "more trees may tell them apart\n";
  if (!options.is_quiet)
    print(fit);
  return fit;
}

Json_report grow_trees(const pcs::Tree_habit_fit& fit, const Habit_options& options)
{
  pcs::Forest_options forest_options;
  forest_options.number_of_trees = static_cast<std::size_t>(options.grow);
  forest_options.height = options.height;
  forest_options.height_spread = options.height_spread;
  forest_options.age = {options.age.front(), options.age.back()};
  forest_options.stem_distance = options.distance;
  forest_options.random_seed = static_cast<std::uint64_t>(options.seed);
  const auto forest = pcs::grow_forest<Kernel>(fit, forest_options);
  Json_report report = Json_report::array();
  for (std::size_t i = 0; i < forest.size(); ++i) {
    const auto& [tree, height, age] = forest[i];
    const std::string path = output_name(options.output, i, forest.size());
    pcs::IO::write_swc(path, tree);
    const auto& root = tree[tree[boost::graph_bundle].root].point;
    const pcs::Tree_measures m = pcs::measure_tree(tree);
    report.push_back({{"file", path},
                      {"x", root.x()},
                      {"y", root.y()},
                      {"height", height},
                      {"age", age},
                      {"branches", tree[boost::graph_bundle].branches.size()},
                      {"length", m.length},
                      {"volume", m.union_volume}});
  }
  if (!options.is_quiet)
    std::cout << forest.size() << " trees grown\n";
  return report;
}

Json_report score_trees(const pcs::Tree_habit_fit& fit, const Habit_options& options)
{
  Json_report report = Json_report::array();
  for (const std::string& path : options.score) {
    const pcs::Tree_score score = pcs::score_tree(
        read_tree(path, options),
        fit,
        pcs::parameters::random_seed(options.seed).number_of_simulations(options.simulations));
    Json_report deviations;
    for (const pcs::Tree_deviation& d : score.deviations)
      deviations[d.name] = d.deviation;
    report.push_back({{"file", path},
                      {"distance", score.distance},
                      {"share", score.share},
                      {"deviations", deviations}});
    if (options.is_quiet)
      continue;
    std::cout << path << ": distance " << score.distance << ", share " << score.share
              << "; largest deviations:";
    for (std::size_t k = 0; k < std::min<std::size_t>(3, score.deviations.size()); ++k)
      std::cout << (k > 0 ? ", " : " ") << score.deviations[k].name << " "
                << score.deviations[k].deviation;
    std::cout << '\n';
  }
  return report;
}

/// Infers the hidden wood of one tree; writes its branches, and returns the figures.
Json_report complete_tree(const pcs::Tree_habit_fit& fit,
                          const Habit_options& options,
                          Report_file* branch_file)
{
  const auto wood = complete_wood(read_tree(options.complete, options), fit, options);
  for (const std::string& sentence : warnings(wood))
    std::cerr << "fit_tree_habit: warning: " << options.complete << ": " << sentence << '\n';
  if (branch_file != nullptr)
    branch_file->commit(swc_of(wood));
  if (!options.is_quiet)
    std::cout << options.complete << ": measured volume " << wood.measured_volume
              << ", inferred volume " << wood.inferred_volume.value << " in ["
              << wood.inferred_volume.least << ", " << wood.inferred_volume.largest
              << "], measured and inferred " << wood.total_volume.value << " in ["
              << wood.total_volume.least << ", " << wood.total_volume.largest << "]; "
              << 100 * wood.hidden_crown_share << " % of the crown hidden\n";
  return json_of(wood);
}

void run(const Habit_options& options)
{
  check(options);
  std::optional<Report_file> habit_file, report_file, branch_file;
  if (!options.input.empty())
    habit_file.emplace(options.habit);
  if (!options.report.empty())
    report_file.emplace(options.report);
  if (!options.inferred.empty())
    branch_file.emplace(options.inferred);
  std::string unit = options.unit;
  pcs::Tree_habit_fit fit;
  if (habit_file) {
    fit = fit_trees(options);
    habit_file->commit(json_of(fit, unit, options.input));
  } else
    fit = read_habit(options.habit, unit);
  Json_report report = {{"habit", options.habit}, {"length_unit", unit}};
  if (options.grow > 0)
    report["trees"] = grow_trees(fit, options);
  if (!options.score.empty())
    report["scores"] = score_trees(fit, options);
  if (!options.complete.empty())
    report["hidden_wood"] = complete_tree(fit, options, branch_file ? &*branch_file : nullptr);
  if (report_file)
    report_file->commit(report);
}

} // namespace

} // namespace program

int main(int argc, char** argv)
{
  program::Habit_options options;
  CLI::App app("Finds the growth parameters of tree skeletons, and grows similar trees.",
               "fit_tree_habit");
  program::declare(app, options);
  return program::run_program(app, argc, argv, "--input tree.swc --habit habit.json", [&] {
    program::run(options);
    return true;
  });
}

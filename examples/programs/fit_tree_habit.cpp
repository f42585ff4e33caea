// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: finds the growth parameters of skeletons, grows trees by them, compares trees with them,
// and infers hidden wood.

#include "common/Report_file.h"
#include "common/run_program.h"
#include "common/unit_warning.h"
#include "habit/Habit_options.h"
#include "habit/Habit_run.h"
#include "habit/complete_wood.h"
#include "habit/habit_json.h"
#include <pcs/IO/write_swc.h>
#include <pcs/core/Tree_measures.h>
#include <pcs/core/errors.h>
#include <pcs/generators/fit_tree_habit.h>
#include <pcs/generators/grow_forest.h>
#include <pcs/generators/habit/check_tree.h>
#include <pcs/generators/score_tree.h>
#include <pcs/internal/text.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace program {

namespace {

using Json_report = nlohmann::ordered_json;

std::size_t number_of_identified(const pcs::Tree_habit_fit& fit)
{
  return static_cast<std::size_t>(
      std::count_if(fit.values.begin(), fit.values.end(), [](const pcs::Habit_value& v) {
        return v.is_identified;
      }));
}

void print(const pcs::Tree_habit_fit& fit)
{
  std::cout << fit.number_of_trees << " trees, " << fit.number_of_branches << " branches; "
            << number_of_identified(fit) << " of " << fit.values.size()
            << " parameters are identified\n";
  for (const pcs::Habit_value& v : fit.values)
    if (v.is_identified)
      std::cout << v.name << ": " << v.value << "  [" << v.least << ", " << v.largest << "]\n";
}

pcs::Tree_habit_fit fit_trees(Habit_run& run)
{
  const Habit_options& options = run.options;
  std::vector<Habit_tree> trees;
  for (const std::string& path : options.input) {
    trees.push_back(run.read_tree(path));
    pcs::generators::habit::checked_sample(trees.back(), options.smallest_radius, path);
    const std::string sentence = unit_warning(extent(trees.front()), extent(trees.back()));
    if (!sentence.empty())
      run.warn(options.input.front() + " and " + path + ": " + sentence);
  }
  const pcs::Tree_habit_fit fit = name_refusals("--input", [&] {
    return pcs::fit_tree_habit(trees,
                               pcs::parameters::random_seed(options.seed)
                                   .number_of_simulations(options.simulations)
                                   .smallest_radius(options.smallest_radius));
  });
  for (const std::string& sentence : pcs::warnings(fit, options.input))
    run.warn_of_library(sentence);
  if (!options.is_quiet)
    print(fit);
  return fit;
}

Json_report grow_trees(const pcs::Tree_habit_fit& fit, const Habit_run& run)
{
  const Habit_options& options = run.options;
  pcs::Forest_options forest_options;
  forest_options.number_of_trees = static_cast<std::size_t>(options.grow);
  forest_options.height = options.height;
  forest_options.height_spread = options.height_spread;
  forest_options.age = {options.age.front(), options.age.back()};
  forest_options.stem_distance = options.distance;
  forest_options.random_seed = static_cast<std::uint64_t>(options.seed);
  const std::string cause =
      options.height > 0 ? "--height " + pcs::internal::to_text(options.height) +
                               " (the habit has " + pcs::internal::to_text(fit.habit.height) + ")"
                         : options.habit;
  auto forest =
      name_refusals(cause, [&] { return pcs::grow_forest<Habit_kernel>(fit, forest_options); });
  Json_report report = Json_report::array();
  for (std::size_t i = 0; i < forest.size(); ++i) {
    auto& [tree, height, age] = forest[i];
    for (std::size_t v = 0; v < num_vertices(tree); ++v)
      tree[v].point = run.upright.back(tree[v].point);
    const std::string path = output_name(options.output, i, forest.size());
    pcs::IO::write_swc(path, tree);
    const auto& root = tree[tree[boost::graph_bundle].root].point;
    const pcs::Tree_measures m = pcs::measure_tree(tree);
    report.push_back({{"file", path},
                      {"x", root.x()},
                      {"y", root.y()},
                      {"z", root.z()},
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

Json_report score_trees(const pcs::Tree_habit_fit& fit, Habit_run& run)
{
  const Habit_options& options = run.options;
  Json_report report = Json_report::array();
  for (const std::string& path : options.score) {
    const Habit_tree tree = run.read_other_tree(path, fit.smallest_radius);
    const pcs::Tree_score score = name_refusals(path, [&] {
      return pcs::score_tree(
          tree,
          fit,
          pcs::parameters::random_seed(options.seed).number_of_simulations(options.simulations));
    });
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
Json_report complete_tree(const pcs::Tree_habit_fit& fit, Habit_run& run, Report_file* branch_file)
{
  const Habit_options& options = run.options;
  const auto wood =
      complete_wood(run.read_other_tree(options.complete, fit.smallest_radius), fit, run);
  for (const std::string& sentence : warnings(wood))
    run.warn(options.complete + ": " + sentence);
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
  Habit_run run(options);
  std::string unit = options.unit;
  pcs::Tree_habit_fit fit;
  Json_report report = {{"program", "fit_tree_habit"},
                        {"version", PCS_PROGRAM_VERSION},
                        {"habit", options.habit}};
  if (habit_file) {
    fit = fit_trees(run);
    habit_file->commit(json_of(fit, unit, options.input));
    report["number_of_trees"] = fit.number_of_trees;
    report["number_of_branches"] = fit.number_of_branches;
    report["number_of_parameters"] = fit.values.size();
    report["number_of_identified_parameters"] = number_of_identified(fit);
  } else
    fit = read_habit(options.habit, unit);
  report["length_unit"] = unit;
  if (options.grow > 0)
    report["trees"] = grow_trees(fit, run);
  if (!options.score.empty())
    report["scores"] = score_trees(fit, run);
  if (!options.complete.empty())
    report["hidden_wood"] = complete_tree(fit, run, branch_file ? &*branch_file : nullptr);
  report["warnings"] = run.warnings;
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

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Accuracy of fit_tree_habit(): virtual trees of random known habits. Counts, for each parameter,
// the estimates within 10 % and the true values within the intervals.

#include "support/Table.h"
#include <pcs/core/Tree_skeleton.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/fit_tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/habit/Habit_parameters.h>
#include <pcs/generators/habit/Habit_simulation.h>
#include <pcs/internal/Random_stream.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
namespace np = pcs::parameters;
namespace habits = pcs::generators::habit;

namespace {

struct Options
{
  std::size_t number = 50, trees_per_habit = 1, simulations = 100;
  double radius_error = 0.05, smallest_radius = 0;
  std::uint64_t seed = 1;
  std::string csv;
};

/// A preset whose continuous parameters are changed at random, by up to a quarter each.
pcs::Tree_habit random_habit(std::uint64_t seed, std::size_t number)
{
  const auto presets = pcs::tree_habits();
  pcs::Tree_habit h = presets[number % presets.size()].second;
  pcs::internal::Random_stream random(seed, number);
  const auto vary = [&](auto&... values) { ((values *= random.uniform(0.75, 1.25)), ...); };
  const auto vary_range = [&](pcs::Value_range& range, double most) {
    const double factor = random.uniform(0.8, 1.2);
    range = {range.least * factor, std::min(most, range.largest * factor)};
  };
  vary(h.height, h.trunk_radius, h.flare, h.flare_height, h.lean, h.bend_renewal, h.sag);
  for (std::size_t i = 0; i < 3; ++i)
    vary(h.bend[i], h.tropism[i], h.spacing[i], h.bare[i]);
  for (std::size_t i = 0; i < 2; ++i) {
    vary(h.taper[i], h.tip_share[i]);
    vary_range(h.insertion[i], 3);
    vary_range(h.child_radius[i], 0.68);
  }
  vary(h.tip_radius, h.largest_branch, h.crown_radius, h.fork);
  vary_range(h.slenderness, 1000);
  h.smallest_branch *= random.uniform(1, 1.5);
  h.flattest_section = random.uniform(0.8, 0.95);
  return h;
}

/// The true value of a parameter, in the unit of the fitted habit.
double
true_value(const habits::Habit_parameter& p, pcs::Tree_habit h, const pcs::Tree_habit& fitted)
{
  const double per_length = fitted.bend_length / h.bend_length;
  for (std::size_t i = 0; i < 3; ++i) {
    h.bend[i] *= per_length;
    h.tropism[i] *= per_length;
  }
  h.sag *= per_length;
  return p.read(h);
}

struct Score
{
  std::size_t number = 0, unknown = 0, near = 0, inside = 0, either = 0;
  std::vector<double> errors; ///< relative; absolute where the true value is 0
};

void add(const pcs::Habit_value& value, double truth, Score& score)
{
  if (!value.is_identified) {
    ++score.unknown;
    return;
  }
  const double error = std::abs(value.value - truth) / (truth == 0 ? 1 : std::abs(truth));
  const bool is_near = error <= 0.1, is_inside = value.least <= truth && truth <= value.largest;
  ++score.number;
  score.near += is_near ? 1 : 0;
  score.inside += is_inside ? 1 : 0;
  score.either += is_near || is_inside ? 1 : 0;
  score.errors.push_back(error);
}

std::string percent(std::size_t part, std::size_t all)
{
  return all == 0 ? "-"
                  : pcs_bench::number(100.0 * static_cast<double>(part) / static_cast<double>(all));
}

void run(const Options& options)
{
  std::vector<Score> scores(habits::number_of_parameters);
  std::size_t crowns = 0, sure = 0, sure_crowns = 0, counts = 0;
  double seconds = 0;
  for (std::size_t k = 0; k < options.number; ++k) {
    const pcs::Tree_habit truth = random_habit(options.seed, k);
    std::vector<Tree> trees(options.trees_per_habit);
    for (std::size_t i = 0; i < trees.size(); ++i) {
      const std::uint64_t seed = pcs::internal::Random_stream(options.seed, k, i).bits();
      pcs::grow_tree(trees[i], truth, np::random_seed(seed));
      const double e = options.radius_error;
      habits::add_radius_errors(trees[i], {e, e, e}, seed + 1);
    }
    const auto start = std::chrono::steady_clock::now();
    const pcs::Tree_habit_fit fit =
        pcs::fit_tree_habit(trees,
                            np::random_seed(k)
                                .number_of_simulations(static_cast<int>(options.simulations))
                                .smallest_radius(options.smallest_radius));
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const bool is_right = fit.habit.crown == truth.crown, is_sure = fit.crown_margin >= 2;
    crowns += is_right ? 1 : 0;
    sure += is_sure ? 1 : 0;
    sure_crowns += is_right && is_sure ? 1 : 0;
    counts += fit.habit.whorl == truth.whorl &&
                      fit.habit.number_of_leaders == truth.number_of_leaders &&
                      fit.habit.number_of_orders == truth.number_of_orders &&
                      fit.habit.number_of_stubs == truth.number_of_stubs
                  ? 1
                  : 0;
    for (std::size_t i = 0; i < scores.size(); ++i)
      add(fit.values[i], true_value(habits::habit_parameters()[i], truth, fit.habit), scores[i]);
  }

  pcs_bench::Table table({"parameter",
                          "not identified",
                          "median error [%]",
                          "within 10 % [%]",
                          "in its interval [%]",
                          "either [%]"});
  Score all;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    Score& s = scores[i];
    all.number += s.number;
    all.either += s.either;
    all.inside += s.inside;
    all.near += s.near;
    all.unknown += s.unknown;
    const double median = habits::quantile(s.errors, 0.5);
    table.add({habits::habit_parameters()[i].name,
               std::to_string(s.unknown),
               pcs_bench::number(100 * median, 2),
               percent(s.near, s.number),
               percent(s.inside, s.number),
               percent(s.either, s.number)});
  }
  table.add({"all",
             std::to_string(all.unknown),
             "",
             percent(all.near, all.number),
             percent(all.inside, all.number),
             percent(all.either, all.number)});
  table.print(std::cout);
  if (!options.csv.empty())
    table.write_csv(options.csv);
  std::cout << "crown shapes right: " << crowns << " of " << options.number
            << "; with a margin of 2: " << sure_crowns << " of " << sure
            << "\nall counts right: " << counts << " of " << options.number
            << "\nseconds per fit: " << seconds / static_cast<double>(options.number) << '\n';
}

} // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app("Accuracy of fit_tree_habit() on virtual trees of known habits", "bench_tree_habit");
  app.add_option("--habits", options.number, "random habits")->capture_default_str();
  app.add_option("--trees", options.trees_per_habit, "trees of each habit")->capture_default_str();
  app.add_option("--simulations", options.simulations, "trees for the intervals")
      ->capture_default_str();
  app.add_option("--radius-error", options.radius_error, "relative, common to a branch")
      ->capture_default_str();
  app.add_option("--smallest-radius", options.smallest_radius, "thinner parts are not seen [m]")
      ->capture_default_str();
  app.add_option("--seed", options.seed)->capture_default_str();
  app.add_option("--csv", options.csv, "the table");
  CLI11_PARSE(app, argc, argv);
  run(options);
}

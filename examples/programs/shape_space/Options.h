// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The command line of the program for spaces of trees.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_OPTIONS_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_OPTIONS_H

#include "Method_options.h"
#include "common/is_seed.h"
#include "common/up_direction.h"
#include <pcs/core/errors.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace orl_program {

struct Options
{
  std::vector<std::string> trees, skeletons;
  std::vector<std::size_t> root_numbers; ///< one for all skeletons, or one for each
  std::set<std::string> given;           ///< names of all options of the command line
  std::vector<double> lambda = {0, 0.25, 0.5, 0.75, 1};
  std::string output, matches, report, correspondences;
  std::string align = "yaw", up = "z";
  Method_options method;
  double max_extrapolation_angle = 45;
  bool do_extend_axes = false, do_limit_radii = false, do_order_births = false,
       do_join_births = false, is_quiet = false;

  // families
  bool do_mean = false, do_growth = false, do_mesh = false, do_keep_absent_branches = false;
  bool is_monotone = false, may_leave_range = false;
  std::string mean_kind = "median", mode_inner_product = "branches", load, save, changes, distances;
  std::size_t number_of_modes = 0, number_of_samples = 0, number_of_frames = 11;
  std::int64_t seed = 1; // signed, because CLI11 would convert -1 to a large unsigned number
  std::vector<double> weights, times;
  std::vector<std::vector<double>> scores; ///< of one tree each
  double pipe_exponent = 0;

  bool is_given(const std::string& name) const { return given.count(name) > 0; }
  std::size_t number_of_trees() const { return std::max(trees.size(), skeletons.size()); }
  /// Whether trees are rotated about the vertical to match others.
  bool does_search_yaw() const
  {
    return align == "yaw" && (number_of_trees() == 2 || is_given("--align"));
  }
  bool is_family() const
  {
    return do_mean || do_growth || number_of_modes > 0 || number_of_samples > 0 ||
           !weights.empty() || !save.empty() || !changes.empty() || !distances.empty();
  }
  /// Whether trees are written, with their points if there are any.
  bool has_results() const
  {
    return has_places() || do_mean || do_growth || number_of_modes > 0 || number_of_samples > 0 ||
           !weights.empty();
  }
  /// Whether trees are made at the positions of `lambda`.
  bool has_places() const { return is_given("--lambda") || (!is_family() && load.empty()); }
};

/// Appends numbers separated by commas. CLI11 would read an empty string as 0, and omit empty
/// numbers between two commas.
inline void
append_numbers(const std::string& name, const std::string& list, std::vector<double>& values)
{
  std::istringstream words(list + ',');
  for (std::string word; std::getline(words, word, ',');) {
    double value = 0;
    if (!CLI::detail::lexical_cast(CLI::detail::trim_copy(word), value) ||
        CLI::detail::trim_copy(word).empty())
      throw CLI::ValidationError(name,
                                 "expected numbers separated by commas, found '" + list + "'");
    values.push_back(value);
  }
}

/// Adds an option for numbers separated by commas.
inline CLI::Option* add_numbers(CLI::App& app,
                                const std::string& name,
                                std::vector<double>& values,
                                const std::string& what)
{
  const auto read = [name, &values](const std::vector<std::string>& lists) {
    values.clear();
    for (const std::string& list : lists)
      append_numbers(name, list, values);
  };
  return app.add_option_function<std::vector<std::string>>(name, read, what)
      ->type_name("FLOAT,...");
}

/// Returns the file name of a position on the path.
inline std::string name_of(double lambda)
{
  char text[64];
  std::snprintf(text, sizeof(text), "lambda_%.3f", lambda == 0 ? 0.0 : lambda);
  return text;
}

inline void declare_family(CLI::App& app, Options& o)
{
  const char* const group = "Families of trees";
  app.add_flag("--mean", o.do_mean, "the mean of all trees: mean.swc, mean.ply")->group(group);
  app.add_option("--mean-kind",
                 o.mean_kind,
                 "minimizes the sum of distances (median) or of squared distances (frechet)")
      ->check(CLI::IsMember({"median", "frechet"}))
      ->capture_default_str()
      ->group(group);
  app.add_option("--modes",
                 o.number_of_modes,
                 "number of modes of variation; trees at minus and plus two standard deviations: "
                 "mode_1_minus.swc, mode_1_plus.swc, ..., and modes.json")
      ->check(CLI::Range(0, 10000))
      ->group(group);
  app.add_option("--mode-inner-product",
                 o.mode_inner_product,
                 "inner product of the variance: branches compared among the trees that have "
                 "them, or the metric, for trees that differ in the presence of branches")
      ->check(CLI::IsMember({"branches", "metric"}))
      ->capture_default_str()
      ->group(group);
  app.add_option_function<std::vector<std::string>>(
         "--scores",
         [&o](const std::vector<std::string>& lists) {
           for (const std::string& list : lists)
             append_numbers("--scores", list, o.scores.emplace_back());
         },
         "scores of a tree on the modes, in standard deviations; once for each tree: "
         "scores_0000.swc, ...")
      ->type_name("FLOAT,...")
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--sample", o.number_of_samples, "number of random trees: sample_0000.swc, ...")
      ->check(CLI::Range(0, 10000))
      ->group(group);
  app.add_option("--seed", o.seed, "seed of the random trees")
      ->check(program::is_seed)
      ->check(CLI::Range(std::int64_t(0), std::numeric_limits<std::int64_t>::max()))
      ->capture_default_str()
      ->group(group);
  app.add_flag("--any-range",
               o.may_leave_range,
               "random trees may be larger or smaller than all inputs")
      ->group(group);
  app.add_option("--pipe-model",
                 o.pipe_exponent,
                 "exponent of the pipe model for random trees: the sum of the children's radii to "
                 "this power is at most that of the parent; 2 to 2.5")
      ->check(CLI::Range(0.0, 10.0))
      ->group(group);
  add_numbers(app, "--weights", o.weights, "one per tree: the weighted mean, weighted_mean.swc")
      ->group(group);
  app.add_flag("--growth", o.do_growth, "a smooth path through all trees: growth_0000.swc, ...")
      ->group(group);
  add_numbers(app,
              "--times",
              o.times,
              "times of the trees for --growth, increasing; default: 0,1,2,...")
      ->group(group);
  app.add_option("--frames", o.number_of_frames, "number of trees on the path of --growth")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str()
      ->group(group);
  app.add_flag("--monotone", o.is_monotone, "lengths and radii never decrease on the path")
      ->group(group);
  app.add_option("--changes", o.changes, "write the changes of each branch here (CSV, two trees)")
      ->group(group);
  app.add_option("--distances", o.distances, "write the distances of all pairs here (CSV)")
      ->group(group);
  app.add_flag("--mesh", o.do_mesh, "write surfaces as well: NAME_surface.ply")->group(group);
  app.add_option("--save-space", o.save, "write the space here")->group(group);
  app.add_option("--load-space", o.load, "read a space from here, instead of trees")->group(group);
}

inline void declare(CLI::App& app, Options& o)
{
  app.footer(
      R"(Give --tree and --skeleton once for each tree, at least twice. Points: PLY, LAS, OFF, PCD,
PTX, OBJ or text. Skeletons: SWC; CSV; tables of cylinders (.csv or .txt, of
extract_tree_skeleton, TreeQSM, SimpleForest, aRchi, rTwig); .txtskl with layers of branches. Both
may be compressed by gzip (.gz) if built with zlib.
Without --skeleton, skeletons are extracted from the points; without --tree, only skeletons are
made.

SWC rows: id, type, x, y, z, radius, parent (-1: a root). Further columns and comments after #
are ignored. Of a file with several roots, the tree with the most nodes is read, with a warning, or
the one of --root-number.

The files lambda_0.250.ply and lambda_0.250.swc are written to DIR for each parameter of the path
between the first two trees: 0 is the first, 1 the second; parameters below 0 and above 1 are
allowed. Properties that all point files have are kept. The options for families of trees replace
the path; with --lambda, it is written as well.

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)");
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--tree", o.trees, "points of a tree, once for each")->allow_extra_args(false);
  app.add_option("--skeleton", o.skeletons, "skeleton of a tree, once for each")
      ->allow_extra_args(false);
  app.add_option("--root-number",
                 o.root_numbers,
                 "which tree of a skeleton file with several trees is read, 1: the one with the "
                 "most nodes; once for all such files, or once for each --skeleton")
      ->check(CLI::Range(std::size_t(1), std::size_t(1) << 52))
      ->delimiter(',')
      ->allow_extra_args(false);
  add_numbers(app, "--lambda", o.lambda, "parameters on the path, separated by commas")
      ->default_str("0,0.25,0.5,0.75,1");
  app.add_option("--output", o.output, "folder for the results; created if missing")->required();
  app.add_option("--matches",
                 o.matches,
                 "write the ids of the tips of matched branches, and the confidence of each match, "
                 "here (CSV)");
  app.add_option("--report",
                 o.report,
                 "write distances, counts and seconds here (JSON); -: standard output");
  app.add_option("--correspondences",
                 o.correspondences,
                 "read correspondences from this file, or write them if it does not exist");
  app.add_option(
         "--align",
         o.align,
         "whether the second of two trees may be rotated about the vertical, for example in a "
         "pot that was moved; more than two trees: if given, each is rotated to match "
         "the previous one")
      ->check(CLI::IsMember({"none", "yaw"}))
      ->capture_default_str();
  program::add_up(app, o.up, "up direction")->capture_default_str();
  app.add_option("--max-extrapolation-degrees",
                 o.max_extrapolation_angle,
                 "largest rotation of an edge beyond an end of the path [degrees]")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  app.add_flag("--extend-axes",
               o.do_extend_axes,
               "extend the axes of given skeletons to the end of the points");
  CLI::Option* const in_order =
      app.add_flag("--sequential-emergence",
                   o.do_order_births,
                   "new branches begin when the tip of their parent passes their base; default for "
                   "two trees that were found to have grown at their tips");
  app.add_flag("--simultaneous-emergence",
               o.do_join_births,
               "all new branches begin at once; default for all other trees and with --load-space")
      ->excludes(in_order);
  app.add_flag("--limit-radii",
               o.do_limit_radii,
               "no branch is thicker than its parent at its base");
  app.add_flag("--keep-absent-branches",
               o.do_keep_absent_branches,
               "skeletons also contain the branches that a tree lacks, as nodes in one place");
  app.add_flag("--quiet", o.is_quiet, "print errors only");
  declare_method(app, o.method);
  declare_family(app, o);
  app.parse_complete_callback([&app, &o] {
    for (const CLI::Option* const option : app.get_options())
      if (option->count() > 0)
        o.given.insert(option->get_name());
  });
}

/// Rejects options without effect.
inline void check_effects(const Options& o)
{
  const auto refuse =
      [&](bool is_in_vain, std::initializer_list<const char*> names, const std::string& why) {
        for (const char* const name : names)
          if (is_in_vain && o.is_given(name))
            throw pcs::Invalid_input(name + (" has no effect " + why));
      };
  refuse(!o.load.empty(),
         {"--orientation",
          "--virtual-direction",
          "--extend-axes",
          "--align",
          "--up",
          "--published-energy",
          "--transport",
          "--point-assignment",
          "--point-weights",
          "--transport-cost",
          "--reach",
          "--sinkhorn-epsilon"},
         "with --load-space: the trees of " + o.load + " are already matched");
  refuse(o.load.empty() && o.trees.empty(),
         {"--extend-axes",
          "--transport",
          "--point-assignment",
          "--point-weights",
          "--transport-cost",
          "--reach",
          "--sinkhorn-epsilon",
          "--point-path",
          "--normals"},
         "without points (--tree)");
  refuse(o.method.transport != "sinkhorn",
         {"--sinkhorn-epsilon"},
         "without --transport sinkhorn: exact transport has no regularization");
  refuse(o.distances.empty(), {"--metric"}, "without --distances");
  refuse(o.skeletons.empty(), {"--root-number"}, "without --skeleton");
  refuse(!o.skeletons.empty() && !o.does_search_yaw(),
         {"--up"},
         "on skeletons that are not rotated about the vertical; with more than two trees, give "
         "--align yaw");
  refuse(o.load.empty() && o.skeletons.empty(),
         {"--extend-axes"},
         "without --skeleton: extracted axes already extend to the end of the points");
  refuse(!o.has_places(),
         {"--max-extrapolation-degrees",
          "--extrapolation",
          "--sequential-emergence",
          "--simultaneous-emergence"},
         "without --lambda");
  refuse(!o.has_places() && o.number_of_samples == 0,
         {"--limit-radii"},
         "without --lambda or --sample");
  refuse(!o.has_results(),
         {"--point-path", "--normals", "--mesh", "--keep-absent-branches"},
         "without an option that writes trees, such as --lambda or --mean");
  refuse(!o.do_mean, {"--mean-kind"}, "without --mean");
  refuse(o.number_of_modes == 0, {"--mode-inner-product", "--scores"}, "without --modes");
  refuse(o.number_of_samples == 0,
         {"--seed", "--any-range", "--pipe-model"},
         "without --sample: no random trees are drawn");
  refuse(!o.do_growth, {"--times", "--frames", "--monotone"}, "without --growth");
}

/// Rejects options for the points of the results, if the space that was read has none.
inline void check_points(const Options& o, bool has_points)
{
  for (const char* const name : {"--point-path", "--normals"})
    if (!has_points && o.is_given(name))
      throw pcs::Invalid_input(std::string(name) + " has no effect: the space of " + o.load +
                               " has no points");
}

/// Checks lists with a number for each tree, and other numbers that are checked after reading.
inline void check_numbers(const Options& o, std::size_t number_of_trees)
{
  const auto check_list = [&](const char* name, const std::vector<double>& list) {
    if (!list.empty() && list.size() != number_of_trees)
      throw pcs::Invalid_input(std::string(name) + " has " + std::to_string(list.size()) +
                               " numbers for " + std::to_string(number_of_trees) + " trees");
    for (const double x : list)
      if (!std::isfinite(x))
        throw pcs::Invalid_input(std::string(name) + " must be finite numbers");
  };
  check_list("--weights", o.weights);
  check_list("--times", o.times);
  const double sum = std::accumulate(o.weights.begin(), o.weights.end(), 0.0);
  if (!o.weights.empty() && !(sum > 0 && std::isfinite(sum)))
    throw pcs::Invalid_input("--weights must add up to a finite number, more than 0");
  for (std::size_t k = 1; k < o.times.size(); ++k)
    if (!(o.times[k] > o.times[k - 1]))
      throw pcs::Invalid_input("--times must increase");
  for (const std::vector<double>& scores : o.scores)
    for (const double x : scores)
      if (!std::isfinite(x) || std::abs(x) > 100)
        throw pcs::Invalid_input("--scores must be numbers between -100 and 100");
  if (o.method.point_path != "cylindrical" && number_of_trees > 2)
    throw pcs::Invalid_input("--point-path is for two trees, there are " +
                             std::to_string(number_of_trees) +
                             "; points of more trees move in cylindrical coordinates");
  if (!o.changes.empty() && number_of_trees != 2)
    throw pcs::Invalid_input("--changes is for two trees, there are " +
                             std::to_string(number_of_trees));
}

inline void check(const Options& o)
{
  const auto fail = [](const std::string& what) { throw pcs::Invalid_input(what); };
  if (!o.load.empty() && !(o.trees.empty() && o.skeletons.empty()))
    fail("--load-space is given with trees, expected only one of them");
  if (o.load.empty()) {
    if (o.trees.empty() && o.skeletons.empty())
      fail("expected --tree or --skeleton, twice");
    const std::pair<const char*, const std::vector<std::string>*> lists[] = {
        {"--tree", &o.trees},
        {"--skeleton", &o.skeletons}};
    for (const auto& [name, files] : lists)
      if (files->size() == 1)
        fail(std::string(name) + " is given once, expected at least 2 times");
    if (!o.trees.empty() && !o.skeletons.empty() && o.trees.size() != o.skeletons.size())
      fail("--tree is given " + std::to_string(o.trees.size()) + " times, --skeleton " +
           std::to_string(o.skeletons.size()) + " times, expected as many");
    const std::size_t n = o.number_of_trees();
    if (o.root_numbers.size() > 1 && o.root_numbers.size() != o.skeletons.size())
      fail("--root-number has " + std::to_string(o.root_numbers.size()) + " numbers for " +
           std::to_string(o.skeletons.size()) + " skeletons, expected one, or one for each");
    if (n > 2 && !o.is_family() && !o.is_given("--lambda"))
      fail("for " + std::to_string(n) +
           " trees, expected one of --mean, --modes, --sample, --weights, --growth, "
           "--save-space or --lambda");
    if (n > 2 && (!o.correspondences.empty() || !o.matches.empty()))
      fail("--correspondences and --matches are for two trees; use --save-space");
    check_numbers(o, n);
  } else if (!o.correspondences.empty() || !o.matches.empty())
    fail("--correspondences and --matches need the trees, not --load-space");
  else if (!o.is_family() && !o.is_given("--lambda"))
    fail("with --load-space, expected one of --lambda, --mean, --modes, --sample, --weights, "
         "--growth, --changes, --distances or --save-space");
  for (const double l : o.lambda)
    if (!std::isfinite(l) || std::abs(l) > 1000)
      fail("--lambda must be finite numbers between -1000 and 1000");
  std::map<std::string, double> names;
  for (const double l : o.lambda)
    if (const auto [it, is_new] = names.emplace(name_of(l), l); !is_new && it->second != l)
      fail("--lambda has two numbers whose files have the same name: " + it->first);
  check_effects(o);
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_OPTIONS_H

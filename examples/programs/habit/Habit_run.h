// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What all steps of the program fit_tree_habit share: options, warnings, and reading of skeletons.

#ifndef PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_RUN_H
#define PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_RUN_H

#include "Habit_options.h"
#include "common/read_skeleton.h"
#include "common/up_direction.h"
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/habit/check_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

namespace program {

using Habit_kernel = CGAL::Simple_cartesian<double>;
using Habit_tree = pcs::Tree_skeleton<Habit_kernel>;

class Habit_run
{
public:
  explicit Habit_run(const Habit_options& o) : options(o), upright(o.up) {}

  /// Prints a warning, and keeps it for the report.
  void warn(const std::string& sentence)
  {
    std::cerr << "fit_tree_habit: warning: " << sentence << '\n';
    warnings.push_back(sentence);
  }

  /// Prints a warning of the library, with the option of the program.
  void warn_of_library(std::string sentence)
  {
    const std::string rule = "which must be z";
    if (const std::size_t at = sentence.find(rule); at != std::string::npos)
      sentence.replace(at, rule.size(), "which is --up " + options.up);
    warn(sentence);
  }

  /// Reads a skeleton, and rotates it so that z is up.
  Habit_tree read_tree(const std::string& path)
  {
    Habit_tree tree;
    std::vector<std::int64_t> ids;
    for (const std::string& sentence :
         pcs::IO::warnings(read_skeleton<Habit_kernel>(path, tree, ids)))
      warn(path + ": " + sentence.substr(0, sentence.find(" (")) + "; split the file");
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      tree[v].radius_error = options.radius_error * tree[v].radius;
      tree[v].point = upright(tree[v].point);
    }
    return tree;
  }

  /// Reads a tree that is compared with a habit of the resolution `smallest_radius`.
  Habit_tree read_other_tree(const std::string& path, double smallest_radius)
  {
    namespace habit = pcs::generators::habit;
    Habit_tree tree = read_tree(path);
    const double tilt = habit::trunk_tilt(habit::checked_sample(tree, smallest_radius, path));
    const std::string sentence = pcs::internal::tilt_warning(path, tilt);
    if (!sentence.empty())
      warn_of_library(sentence);
    return tree;
  }

  const Habit_options& options;
  const Up_rotation upright;
  std::vector<std::string> warnings;
};

/// Calls `work()`; refusals name the file or option `where`.
template <class Work>
auto name_refusals(const std::string& where, const Work& work)
{
  try {
    return work();
  } catch (const pcs::Invalid_input& refusal) {
    throw pcs::Invalid_input(where + ": " + refusal.what());
  }
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_RUN_H

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Virtual trees of two ages, scanned independently: fractions of points assigned to the correct
// branch and to the correct position on it.

#include <support/material_places.h>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <map>
#include <string>

using namespace orl_test;

int main(int argc, char** argv)
{
  int trees = 3, first_seed = 1;
  double coarser = 2;
  CLI::App app("Correspondences of virtual trees of two ages, scanned independently.");
  app.add_option("--trees", trees, "per habit and age")->capture_default_str();
  app.add_option("--first-seed", first_seed, "of the trees")->capture_default_str();
  app.add_option("--coarser", coarser, "steps of the scanner, times the usual ones")
      ->capture_default_str();
  pcs::Matching_weights weights;
  const std::map<std::string, pcs::Branch_growth> growths = {
      {"any", pcs::Branch_growth::any},
      {"along_branches", pcs::Branch_growth::along_branches},
      {"at_tips", pcs::Branch_growth::at_tips}};
  app.add_option("--growth", weights.growth, "how branches become longer")
      ->transform(CLI::CheckedTransformer(growths));
  CLI11_PARSE(app, argc, argv);
  std::printf("| habit | age | points | correct branch [%%] | same wood, within one radius [%%] | "
              "attainable [%%] | same "
              "fraction, within one radius [%%] | from the same wood [radii] | seconds |\n"
              "|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string habit : {"broadleaf", "fruit"})
    for (const double age : {0.9, 0.7, 0.5}) {
      Material_accuracy sum;
      for (int seed = first_seed; seed < first_seed + trees; ++seed) {
        Tree old_tree;
        pcs::grow_tree(old_tree,
                       habit == "fruit" ? pcs::fruit_habit() : pcs::broadleaf_habit(),
                       pcs::parameters::random_seed(seed));
        const Material_accuracy m =
            measure_ages(old_tree, age, seed, coarser, pcs::parameters::matching_weights(weights));
        sum.number_of_points += m.number_of_points;
        sum.right_branch += m.right_branch / trees;
        sum.same_wood += m.same_wood / trees;
        sum.attainable += m.attainable / trees;
        sum.same_share += m.same_share / trees;
        sum.mean_radii += m.mean_radii / trees;
        sum.seconds += m.seconds / trees;
      }
      std::printf("| %s | %.1f | %zu | %.1f | %.1f | %.1f | %.1f | %.2f | %.1f |\n",
                  habit.c_str(),
                  age,
                  sum.number_of_points / static_cast<std::size_t>(trees),
                  100 * sum.right_branch,
                  100 * sum.same_wood,
                  100 * sum.attainable,
                  100 * sum.same_share,
                  sum.mean_radii,
                  sum.seconds);
      std::fflush(stdout);
    }
  return 0;
}

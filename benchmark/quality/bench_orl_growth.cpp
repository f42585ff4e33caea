// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Growth of the same tree: fraction of branches that are matched to themselves after pruning,
// turning and shifting.

#include <pcs/IO/read_txtskl.h>
#include <pcs/Orl_shape_space.h>
#include <support/grown_trees.h>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <string>
#include <vector>

int main(int argc, char** argv)
{
  std::vector<std::string> files;
  int seeds = 2;
  double noise = 0.02, stretch = 0, pruned = 0.3;
  CLI::App app(
      "Fraction of the branches of a tree that are matched to themselves after simulated growth.");
  app.add_option("skeletons", files, "skeletons, .txtskl")->required();
  app.add_option("--seeds", seeds, "repetitions")->capture_default_str();
  app.add_option("--noise", noise, "noise of attachments, as a fraction of the parent's length")
      ->capture_default_str();
  app.add_option("--stretch", stretch, "deviation of the logarithm of lengths")
      ->capture_default_str();
  app.add_option("--pruned", pruned, "probability that a branch is cut")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  namespace np = pcs::parameters;
  const double sigmas[] = {0.1, 0.3, 0.5};
  double mean[2][3] = {};
  std::printf("| tree | 0.1 rad | 0.3 rad | 0.5 rad | published 0.1 | 0.3 | 0.5 "
              "|\n|---|---|---|---|---|---|---|\n");
  for (const std::string& file : files) {
    orl_bench::Tree original;
    pcs::IO::read_txtskl<orl_bench::Kernel>(file, original);
    const std::vector<orl_bench::Branch> branches = orl_bench::take_apart(original);
    double share[2][3] = {};
    for (int s = 0; s < 3; ++s)
      for (int seed = 0; seed < seeds; ++seed) {
        std::vector<std::size_t> names_a, names_b;
        const auto a = orl_bench::put_together(branches, names_a);
        const auto b =
            orl_bench::put_together(orl_bench::grow(branches,
                                                    {sigmas[s], noise, stretch, pruned},
                                                    static_cast<unsigned>(100 * seed + s)),
                                    names_b);
        for (int published = 0; published < 2; ++published) {
          pcs::Orl_shape_space<orl_bench::Kernel> space;
          space.add_skeleton(a);
          space.add_skeleton(b);
          pcs::Matching_weights weights;
          weights.is_published = published == 1;
          space.build(np::matching_weights(weights));
          double right = 0;
          for (const pcs::Branch_match& m : space.matches())
            if (m.tip[0] != pcs::npos && m.tip[1] != pcs::npos)
              right += names_a[m.tip[0]] == names_b[m.tip[1]] ? 1 : 0;
          share[published][s] += 100 * right / orl_bench::number_of_names(names_b) / seeds;
        }
      }
    std::printf("| %s |", file.substr(file.rfind('/') + 1).c_str());
    for (int published = 0; published < 2; ++published)
      for (int s = 0; s < 3; ++s) {
        std::printf(" %.1f |", share[published][s]);
        mean[published][s] += share[published][s] / static_cast<double>(files.size());
      }
    std::printf("\n");
    std::fflush(stdout);
  }
  std::printf("| mean | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f |\n",
              mean[0][0],
              mean[0][1],
              mean[0][2],
              mean[1][0],
              mean[1][1],
              mean[1][2]);
  return 0;
}

// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Growth of the same tree: fraction of branches that are matched to themselves after pruning,
// turning, shifting, stretching and scaling, also by the confidence of their matches.

#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/Orl_shape_space.h>
#include <support/grown_trees.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace {

const std::array<double, 3> turns = {0.1, 0.3, 0.5};

struct Options
{
  std::vector<std::string> files;
  int seeds = 2, first_seed = 0;
  orl_bench::Growth growth = {0, 0.02, 0, 0.3, 0, 0};
  bool is_pcs_only = false;
};

/// Percentages of branches that are matched to themselves for each of `turns`.
using Shares = std::array<double, 3>;

/// Numbers of correct and of all matches with confidences in one interval.
class Confidence_table
{
public:
  void add(double confidence, bool is_right)
  {
    std::size_t k = 0;
    while (k + 1 < m_begin.size() && confidence >= m_begin[k + 1])
      ++k;
    ++m_all[k];
    m_right[k] += is_right ? 1 : 0;
  }
  void print() const
  {
    std::printf("\n| confidence | matches | correct [%%] |\n|---|---|---|\n");
    for (std::size_t k = 0; k < m_begin.size(); ++k)
      if (m_all[k] > 0)
        std::printf("| %.2f to %.2f | %zu | %.1f |\n",
                    m_begin[k],
                    k + 1 < m_begin.size() ? m_begin[k + 1] : 1.0,
                    m_all[k],
                    100 * double(m_right[k]) / double(m_all[k]));
  }

private:
  static constexpr std::array<double, 6> m_begin = {0, 0.05, 0.1, 0.2, 0.4, 0.7};
  std::array<std::size_t, 6> m_all = {}, m_right = {};
};

/// Returns the percentage of the branches of `b` that are matched to themselves.
double share(const orl_bench::Tree& a,
             const std::vector<std::size_t>& names_a,
             const orl_bench::Tree& b,
             const std::vector<std::size_t>& names_b,
             bool is_published,
             Confidence_table& confidences)
{
  namespace np = pcs::parameters;
  pcs::Orl_shape_space<orl_bench::Kernel> space;
  space.add_skeleton(a);
  space.add_skeleton(b);
  pcs::Matching_weights weights;
  weights.is_published = is_published;
  space.build(np::matching_weights(weights));
  double right = 0;
  for (const pcs::Branch_match& m : space.matches())
    if (m.tip[0] != pcs::npos && m.tip[1] != pcs::npos) {
      const bool is_right = names_a[m.tip[0]] == names_b[m.tip[1]];
      right += is_right ? 1 : 0;
      if (!is_published && m.parent != pcs::npos)
        confidences.add(m.confidence, is_right);
    }
  return 100 * right / orl_bench::number_of_names(names_b);
}

/// Returns the mean percentages of a tree, with the energies of pcs and as published.
std::array<Shares, 2>
measure(const std::string& file, const Options& o, Confidence_table& confidences)
{
  orl_bench::Tree original;
  if (file.size() > 4 && file.substr(file.size() - 4) == ".swc")
    pcs::IO::read_swc<orl_bench::Kernel>(file, original);
  else
    pcs::IO::read_txtskl<orl_bench::Kernel>(file, original);
  const std::vector<orl_bench::Branch> branches = orl_bench::take_apart(original);
  std::array<Shares, 2> result = {};
  for (std::size_t s = 0; s < turns.size(); ++s)
    for (int k = 0; k < o.seeds; ++k) {
      orl_bench::Growth growth = o.growth;
      growth.turn = turns[s];
      const auto seed = static_cast<unsigned>(100 * (o.first_seed + k)) + static_cast<unsigned>(s);
      std::vector<std::size_t> names_a, names_b;
      const auto a = orl_bench::put_together(branches, names_a);
      const auto b = orl_bench::put_together(orl_bench::grow(branches, growth, seed), names_b);
      for (std::size_t published = 0; published < (o.is_pcs_only ? 1 : 2); ++published)
        result[published][s] +=
            share(a, names_a, b, names_b, published == 1, confidences) / o.seeds;
    }
  return result;
}

void print(const std::string& name, const std::array<Shares, 2>& shares, bool is_pcs_only)
{
  std::printf("| %s |", name.c_str());
  for (std::size_t published = 0; published < (is_pcs_only ? 1 : 2); ++published)
    for (const double x : shares[published])
      std::printf(" %.1f |", x);
  std::printf("\n");
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
  Options o;
  CLI::App app(
      "Fraction of the branches of a tree that are matched to themselves after simulated growth.");
  app.add_option("skeletons", o.files, "skeletons, .txtskl or .swc")->required();
  app.add_option("--seeds", o.seeds, "repetitions")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--first-seed", o.first_seed, "number of the first repetition")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  app.add_option("--noise",
                 o.growth.noise,
                 "noise of attachments, as a fraction of the parent's length")
      ->capture_default_str();
  app.add_option("--stretch", o.growth.stretch, "deviation of the logarithm of lengths")
      ->capture_default_str();
  app.add_option("--scale", o.growth.scale, "0.2: every length is multiplied by 0.8 to 1.2")
      ->check(CLI::Range(0.0, 0.99))
      ->capture_default_str();
  CLI::Option* const pruned =
      app.add_option("--pruned", o.growth.pruned, "probability that a branch is cut")
          ->check(CLI::Range(0.0, 1.0))
          ->capture_default_str();
  CLI::Option* const prune =
      app.add_option("--prune",
                     o.growth.prune,
                     "share of the branches of each order that is cut with its descendants; "
                     "replaces --pruned")
          ->check(CLI::Range(0.0, 1.0))
          ->excludes(pruned);
  app.add_flag("--pcs-only", o.is_pcs_only, "without the published energy");
  CLI11_PARSE(app, argc, argv);
  if (prune->count() > 0)
    o.growth.pruned = 0;

  std::printf(o.is_pcs_only ? "| tree | 0.1 rad | 0.3 rad | 0.5 rad |\n|---|---|---|---|\n"
                            : "| tree | 0.1 rad | 0.3 rad | 0.5 rad | published 0.1 | 0.3 | 0.5 |\n"
                              "|---|---|---|---|---|---|---|\n");
  Confidence_table confidences; // with the energy of pcs, without trunks
  std::array<Shares, 2> mean = {}, worst = {};
  for (std::size_t i = 0; i < o.files.size(); ++i) {
    const std::string& file = o.files[i];
    const std::array<Shares, 2> shares = measure(file, o, confidences);
    print(file.substr(file.rfind('/') + 1), shares, o.is_pcs_only);
    for (std::size_t p = 0; p < 2; ++p)
      for (std::size_t s = 0; s < turns.size(); ++s) {
        mean[p][s] += shares[p][s] / static_cast<double>(o.files.size());
        worst[p][s] = i == 0 ? shares[p][s] : std::min(worst[p][s], shares[p][s]);
      }
  }
  print("mean", mean, o.is_pcs_only);
  print("worst", worst, o.is_pcs_only);
  confidences.print();
  return 0;
}
